//! The vehicle behind ArduPilot's physics interface, flown from the autopilot's side.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read};
use std::net::UdpSocket;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use alula_bridges::sitl::client::Client;
use alula_bridges::sitl::{Lockstep, Physics, Sample};
use alula_sil::ardupilot::Vehicle;
use alula_sim::experiment::{Document, Experiment};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

type V3 = Vector3<f64>;

/// Time of the flight \[s\], and the rate of its steps \[Hz\]: those of the round trip.
const DURATION: f64 = 60.0;
const RATE: f64 = 500.0;
/// Throttle that holds the vehicle of the round trip, of twice its weight.
const HOVER: f64 = 0.5;

fn experiment(settings: &[&str]) -> Experiment {
    let mut document = Document::load("round-trip").unwrap();
    for setting in settings {
        document.assign(setting).unwrap();
    }
    document.checked().unwrap()
}

/// What a simple autopilot puts out at `state`: on the ground for 2 s, then a hover at 20 m, with 10 s pitched 20° forward in between.
/// An attitude and an altitude loop; elevons on channels 1 and 2, throttles on 3 and 4.
fn outputs(state: &Sample) -> [u16; 4] {
    let t = state.timestamp;
    if t < 2.0 {
        return [1500, 1500, 1000, 1000];
    }
    let [w, x, y, z] = state.quaternion;
    let attitude = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    let pitch: f64 = if (20.0..30.0).contains(&t) {
        70.0
    } else {
        90.0
    };
    let wanted = UnitQuaternion::from_axis_angle(&V3::y_axis(), pitch.to_radians());
    let error = (attitude.inverse() * wanted).scaled_axis();
    let turn = error * 4.0 - V3::from(state.gyro);
    // Over full deflection: 0.4 kg m² · 5 /s over 8 N m and so on.
    let [roll, pitch, yaw] = [0.25 * turn.x, 0.12 * turn.y, 0.2 * turn.z];
    let climb = 0.5 * (-20.0 - state.position[2]).clamp(-4.0, 4.0) - state.velocity[2];
    let throttle = HOVER - 0.1 * climb;
    let surface = |x: f64| (1500.0 + 500.0 * x.clamp(-1.0, 1.0)) as u16;
    let motor = |x: f64| (1000.0 + 1000.0 * x.clamp(0.0, 1.0)) as u16;
    [
        surface(pitch - roll),
        surface(pitch + roll),
        motor(throttle + 0.5 * yaw),
        motor(throttle - 0.5 * yaw),
    ]
}

/// Widths of all channels: 16 of them before 30 s, 32 after.
fn widths(state: &Sample) -> Vec<u16> {
    let mut widths = outputs(state).to_vec();
    widths.resize(if state.timestamp < 30.0 { 16 } else { 32 }, 0);
    widths
}

/// The flight, each answer from `exchange`, which is given the client and a packet; the states.
fn fly(mut exchange: impl FnMut(&mut Client, &[u8]) -> Sample) -> Vec<Sample> {
    let mut client = Client::default();
    let mut states: Vec<Sample> = Vec::new();
    let mut state = Sample {
        quaternion: [1.0, 0.0, 0.0, 0.0],
        ..Sample::default()
    };
    for _ in 0..(DURATION * RATE) as usize {
        let packet = client.packet(RATE as u16, &widths(&state));
        state = exchange(&mut client, &packet);
        states.push(state);
    }
    states
}

/// The flight over a link that repeats packets, loses answers, cuts them in two, and lets garbage and packets of long ago in between.
fn fly_over_a_bad_link(vehicle: &mut Vehicle) -> (Vec<Sample>, Lockstep) {
    let mut lockstep = Lockstep::default();
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut sent: VecDeque<Vec<u8>> = VecDeque::new();
    let states = fly(|client, packet| {
        sent.push_back(packet.to_vec());
        if sent.len() > 8 {
            sent.pop_front();
        }
        loop {
            let answer = lockstep.receive(packet, vehicle).unwrap().to_vec();
            match random.random_range(0..100) {
                0 => continue,
                1 => {
                    assert_eq!(lockstep.receive(packet, vehicle), Some(&answer[..]));
                }
                2 => {
                    let garbage: Vec<u8> = (0..random.random_range(0..90))
                        .map(|_| random.random())
                        .collect();
                    assert_eq!(lockstep.receive(&garbage, vehicle), None);
                }
                3 => {
                    let (a, b) = answer.split_at(random.random_range(1..answer.len()));
                    assert_eq!(client.receive(a), None);
                    return client.receive(b).unwrap();
                }
                // Time does not run backwards.
                4 if sent.len() == 8 => {
                    let old = random.random_range(0..7);
                    assert_eq!(lockstep.receive(&sent[old], vehicle), None);
                }
                _ => {}
            }
            return client.receive(&answer).unwrap();
        }
    });
    (states, lockstep)
}

#[test]
fn a_bad_link_changes_nothing_of_the_flight() {
    let experiment = experiment(&[]);
    let mut vehicle = Vehicle::new(&experiment).unwrap();
    let mut lockstep = Lockstep::default();
    let clean = fly(|client, packet| {
        let answer = lockstep.receive(packet, &mut vehicle).unwrap();
        client.receive(answer).unwrap()
    });
    let record = vehicle.record().clone();
    let mut vehicle = Vehicle::new(&experiment).unwrap();
    let (states, lockstep) = fly_over_a_bad_link(&mut vehicle);
    assert_eq!(states, clean);
    assert_eq!(vehicle.record(), &record);
    let counts = lockstep.counts();
    assert_eq!(counts.steps, 30_000);
    assert!(
        counts.repeated > 400 && counts.malformed > 200,
        "{counts:?}"
    );
    assert!(counts.late > 200, "{counts:?}");
    assert_eq!((counts.lost, counts.restarts), (0, 0));

    // It stands, lifts off, hovers at 20 m, flies north, comes to rest again.
    for (row, state) in clean.iter().enumerate() {
        // Microseconds are written.
        assert!((state.timestamp - (row + 1) as f64 / RATE).abs() < 1e-6);
    }
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let standing = &clean[900];
    assert_eq!(standing.accel_body, [9.81, 0.0, 0.0]);
    assert_eq!((standing.position, standing.gyro), ([0.0; 3], [0.0; 3]));
    let upright = standing.quaternion.iter().zip([half, 0.0, half, 0.0]);
    assert!(
        upright.clone().all(|(a, b)| (a - b).abs() < 1e-8),
        "{standing:?}"
    );
    let at = |t: f64| &clean[(t * RATE) as usize - 1];
    // 0.1 m and 1 %: the loops have settled after 15 s.
    assert!((at(19.0).position[2] + 20.0).abs() < 0.1, "{:?}", at(19.0));
    assert!((at(19.0).accel_body[0] - 9.81).abs() < 0.1);
    assert!(at(30.0).velocity[0] > 5.0, "{:?}", at(30.0));
    let last = at(60.0);
    assert!(
        last.velocity[0].abs() < 1.5 && last.position[0] > 40.0,
        "{last:?}"
    );
    assert!((last.position[2] + 20.0).abs() < 0.5, "{last:?}");
    assert!(last.position[1].abs() < 1e-6 && record[100].answer.thrust > 0.0);
    // The record begins with the lift-off.
    assert!((record[0].truth.position.norm()) < 0.01);
    assert!(
        (DURATION - record.len() as f64 / 100.0 - 2.0).abs() < 1.0,
        "{}",
        record.len()
    );
}

/// Positions are the second integral of what the simulated accelerometer says: what ArduPilot's filter reckons with.
#[test]
fn accelerometer_attitude_and_velocity_agree() {
    let experiment = experiment(&["weather.steady_m_s=[-3,0,0]"]);
    let mut vehicle = Vehicle::new(&experiment).unwrap();
    let mut lockstep = Lockstep::default();
    let states = fly(|client, packet| {
        let answer = lockstep.receive(packet, &mut vehicle).unwrap();
        client.receive(answer).unwrap()
    });
    let world = |s: &Sample| {
        let [w, x, y, z] = s.quaternion;
        let q = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        q * V3::from(s.accel_body) + V3::new(0.0, 0.0, 9.81)
    };
    let (from, to) = (10 * 500, 50 * 500);
    let mut velocity = V3::from(states[from].velocity);
    let mut worst: f64 = 0.0;
    for pair in states[from..to].windows(2) {
        velocity += 0.5 / RATE * (world(&pair[0]) + world(&pair[1]));
        worst = worst.max((velocity - V3::from(pair[1].velocity)).norm());
    }
    // The trapezoidal rule over 40 s, with a kink at each change of the outputs: half a step of 10 m/s² at worst.
    assert!(worst < 0.02, "{worst}");
    let hover = &states[9_000];
    assert_eq!(hover.velocity_wind, Some([-3.0, 0.0, 0.0]));
    // Nose up in a wind from the north the air comes from the belly's side, not along the nose.
    assert!(hover.airspeed.unwrap().abs() < 1.0, "{hover:?}");
}

#[test]
fn a_restarted_autopilot_finds_the_vehicle_on_the_ground_and_time_at_its_beginning() {
    let experiment =
        experiment(&["weather.turbulence={ wind_at_20_ft_m_s = 15.4, height_m = 50 }"]);
    let mut vehicle = Vehicle::new(&experiment).unwrap();
    let mut lockstep = Lockstep::default();
    let mut first = None;
    fly(|client, packet| {
        let state = client
            .receive(lockstep.receive(packet, &mut vehicle).unwrap())
            .unwrap();
        first.get_or_insert(state.velocity_wind);
        state
    });
    let steps = vehicle.record().len();
    let mut client = Client::default();
    let packet = client.packet(500, &[1500, 1500, 1000, 1000]);
    // It might be late. An autopilot waits for its answer and sends it again.
    assert_eq!(lockstep.receive(&packet, &mut vehicle), None);
    let answer = lockstep.receive(&packet, &mut vehicle).unwrap();
    let state = client.receive(answer).unwrap();
    assert_eq!((state.timestamp, state.position), (1.0 / RATE, [0.0; 3]));
    assert_eq!(lockstep.counts().restarts, 1);
    // The weather begins anew too.
    assert!(first.flatten().is_some_and(|wind| wind != [0.0; 3]));
    assert_eq!(Some(state.velocity_wind), first);
    // The record is that of the last flight until there is another one.
    assert_eq!(vehicle.record().len(), steps);
}

/// Full throttle for a second, then none: it rises, falls, and stands again, upright, on the ground.
#[test]
fn it_lands_and_stands() {
    let experiment = experiment(&["ardupilot.mark_channel=9"]);
    let mut vehicle = Vehicle::new(&experiment).unwrap();
    let mut send = |count: u32, throttle: u16, mark: u16| {
        let widths = [1510, 1500, throttle, throttle, 0, 0, 0, 0, mark];
        vehicle.step(&alula_bridges::sitl::Packet::new(500, count, &widths))
    };
    let mut highest: f64 = 0.0;
    for count in 0..4000 {
        let throttle = if count < 500 { 2000 } else { 1000 };
        highest =
            highest.min(send(count, throttle, if count < 600 { 1000 } else { 1900 }).position[2]);
    }
    let state = send(4000, 1000, 1900);
    assert!(highest < -3.0, "{highest}");
    assert_eq!((state.position[2], state.velocity), (0.0, [0.0; 3]));
    assert_eq!(state.accel_body, [9.81, 0.0, 0.0]);
    let [(speed, angle)] = vehicle.landings() else {
        panic!("{:?}", vehicle.landings());
    };
    assert!(*speed > 5.0 && *angle > 0.0);
    // The clock began with the mark, 1.2 s after the first step, at 100 steps a second.
    assert!(
        (vehicle.record().len() as i64 - 680).abs() <= 1,
        "{}",
        vehicle.record().len()
    );
}

/// A tail-sitter as it is stands on its tail, and its servos and motors turn it as ArduPilot means them: without an inner loop of ours.
#[test]
fn a_tail_sitter_flies_under_the_outputs() {
    let mut document = Document::load("tail-sitter-hover").unwrap();
    document.assign("sensors={}").unwrap();
    let experiment = document.checked().unwrap();
    let flown = |widths: [u16; 4]| {
        let mut vehicle = Vehicle::new(&experiment).unwrap();
        let mut send = |count: u32, widths: [u16; 4]| {
            vehicle.step(&alula_bridges::sitl::Packet::new(100, count, &widths))
        };
        // At 100 Hz, and 0.4 s of full throttle: nobody steadies it.
        let stands = (0..500)
            .map(|count| send(count, [1500, 1500, 1000, 1000]))
            .last()
            .unwrap();
        let flies = (500..540).map(|count| send(count, widths)).last().unwrap();
        (stands, flies, vehicle.record().len())
    };
    let (stands, straight, steps) = flown([1500, 1500, 2000, 2000]);
    // The tail gives way by 2 cm under the weight.
    assert!(stands.position[2].abs() < 0.02, "{stands:?}");
    assert!((stands.accel_body[0] - 9.81).abs() < 0.01, "{stands:?}");
    assert!(
        straight.position[2] < -0.05 && steps > 10,
        "{straight:?} {steps}"
    );
    for (axis, widths) in [
        (1, [1600, 1600, 2000, 2000]),
        (0, [1400, 1600, 2000, 2000]),
        (2, [1500, 1500, 2000, 1900]),
    ] {
        let (_, turned, _) = flown(widths);
        let by = turned.gyro[axis] - straight.gyro[axis];
        assert!(by > 0.1, "{axis}: {by}, {turned:?} {straight:?}");
    }
}

/// Ends the server however the test ends.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A server at a port of its own.
struct Listening {
    server: Server,
    /// What it says after its first line.
    said: BufReader<std::process::ChildStderr>,
    port: u16,
}

fn sitl(folder: &Path, more: &[&str]) -> Listening {
    let mut child = Command::new(env!("CARGO_BIN_EXE_alula-sil"))
        .current_dir(folder)
        .args([
            "sitl",
            "ardupilot",
            "round-trip",
            "--listen",
            "127.0.0.1:0",
            "--out",
            "flown",
        ])
        .args(more)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let port = line.trim().rsplit(':').next().unwrap().parse();
    Listening {
        server: Server(child),
        said,
        port: port.unwrap_or_else(|_| panic!("{line}")),
    }
}

fn interrupt(server: &Server) {
    let id = server.0.id().to_string();
    let sent = Command::new("kill").args(["-INT", &id]).status().unwrap();
    assert!(sent.success());
}

#[test]
fn sixty_seconds_are_flown_through_the_command_and_ctrl_c_leaves_them() {
    let folder = tempfile::tempdir().unwrap();
    let Listening {
        mut server,
        mut said,
        port,
    } = sitl(folder.path(), &["--log", "ulog"]);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(("127.0.0.1", port)).unwrap();
    socket
        .set_read_timeout(Some(Duration::from_secs(20)))
        .unwrap();
    let mut sent = 0_u32;
    let states = fly(|client, packet| {
        sent += 1;
        let mut buffer = [0; 4096];
        if sent.is_multiple_of(1000) {
            socket.send(&packet[1..]).unwrap();
            socket.send(b"").unwrap();
            socket.send(packet).unwrap();
            let size = socket.recv(&mut buffer).unwrap();
            socket.send(packet).unwrap();
            let again = socket.recv(&mut [0; 4096]).unwrap();
            assert_eq!(size, again);
            return client.receive(&buffer[..size]).unwrap();
        }
        socket.send(packet).unwrap();
        let size = socket.recv(&mut buffer).unwrap();
        client.receive(&buffer[..size]).unwrap()
    });
    let last = states.last().unwrap();
    assert!((last.timestamp - DURATION).abs() < 1e-6);
    assert!((last.position[2] + 20.0).abs() < 0.5, "{last:?}");
    interrupt(&server);
    assert!(server.0.wait().unwrap().success());
    let mut rest = String::new();
    said.read_to_string(&mut rest).unwrap();
    assert!(
        rest.contains(
            "30000 steps; 30 packets came again, 0 were lost, 0 late, 60 malformed; 0 restarts"
        ),
        "{rest}"
    );
    let mut figures = String::new();
    server
        .0
        .stdout
        .take()
        .unwrap()
        .read_to_string(&mut figures)
        .unwrap();
    assert!(figures.contains("least altitude"), "{figures}");
    for file in ["trace.csv", "report.html", "report.svg", "flight.ulg"] {
        assert!(folder.path().join("flown").join(file).exists(), "{file}");
    }
}

#[test]
fn without_a_flight_ctrl_c_leaves_nothing_and_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let Listening {
        mut server,
        mut said,
        ..
    } = sitl(folder.path(), &[]);
    interrupt(&server);
    assert!(server.0.wait().unwrap().success());
    let mut rest = String::new();
    said.read_to_string(&mut rest).unwrap();
    assert!(rest.contains("no flight"), "{rest}");
    assert!(!folder.path().join("flown/trace.csv").exists());
}
