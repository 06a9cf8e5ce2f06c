//! The companion against the simulated autopilot, over UDP on loopback. Time is simulated: a datagram is sent when the link lets it
//! through, and received before time goes on.

use std::net::UdpSocket;
use std::time::Duration;

use alula_bridges::companion::{
    Autopilot, Companion, End, HOLD, MavHeader, MavMessage, OFFBOARD, Stage, Wanted, wire,
};
use alula_sil::companion::{Controlled, Craft, keep, plan, settings};
use alula_sil::experiment::{Document, Experiment};
use alula_sil::figures::Figures;
use alula_sil::simulate::{Record, fly};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// One way of the link: a socket's bytes to another one, delayed and lost.
struct Way {
    from: UdpSocket,
    to: UdpSocket,
    random: ChaCha8Rng,
    quality: Quality,
    /// Time of arrival \[s\], and the bytes.
    pending: Vec<(f64, Vec<u8>)>,
    sequence: u8,
}

/// What a link does to messages.
#[derive(Clone, Copy)]
struct Quality {
    /// Each is this late \[s\],
    latency: f64,
    /// and by up to this more, so that some overtake others;
    jitter: f64,
    /// this share is late by 0.1 s more;
    late: f64,
    /// this share is lost;
    lost: f64,
    /// this share is followed by bytes that are no message.
    garbage: f64,
}

const GOOD: Quality = Quality {
    latency: 0.0,
    jitter: 0.0,
    late: 0.0,
    lost: 0.0,
    garbage: 0.0,
};

/// 20 ms of latency in the mean, each way, and 2 % lost; late and reordered ones, and garbage.
const BAD: Quality = Quality {
    latency: 0.015,
    jitter: 0.01,
    late: 0.01,
    lost: 0.02,
    garbage: 0.01,
};

impl Way {
    fn new(quality: Quality, seed: u64) -> Self {
        let bound = || UdpSocket::bind("127.0.0.1:0").unwrap();
        let (from, to) = (bound(), bound());
        from.connect(to.local_addr().unwrap()).unwrap();
        to.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        Self {
            from,
            to,
            random: ChaCha8Rng::seed_from_u64(seed),
            quality,
            pending: Vec::new(),
            sequence: 0,
        }
    }

    fn send(&mut self, now: f64, header: MavHeader, message: &MavMessage) {
        self.sequence = self.sequence.wrapping_add(1);
        let header = MavHeader {
            sequence: self.sequence,
            ..header
        };
        let q = self.quality;
        let mut chance = || self.random.random::<f64>();
        let mut at = now + q.latency + q.jitter * chance();
        if chance() < q.late {
            at += 0.1;
        }
        if chance() >= q.lost {
            self.pending.push((at, wire::bytes(header, message)));
        }
        if chance() < q.garbage {
            let bytes = (0..30).map(|_| self.random.random()).collect();
            self.pending.push((at, bytes));
        }
    }

    /// The messages that arrive up to `now`.
    fn receive(&mut self, now: f64) -> Vec<(MavHeader, MavMessage)> {
        let mut due: Vec<_> = Vec::new();
        self.pending.retain(|(at, bytes)| {
            let is_due = *at <= now + 1e-9;
            if is_due {
                due.push((*at, bytes.clone()));
            }
            !is_due
        });
        due.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut messages = Vec::new();
        for (_, bytes) in due {
            self.from.send(&bytes).unwrap();
            let mut buffer = [0; 512];
            let size = self.to.recv(&mut buffer).unwrap();
            messages.extend(wire::parse(&buffer[..size]).0);
        }
        messages
    }
}

/// Rate of the companion's steps \[Hz\], and of the vehicle's.
const RATE: u32 = 50;
const PLANT: u32 = 500;

/// How a flight went.
struct Flight {
    stage: Stage,
    /// Of the vehicle itself, over the reference \[m\]: least and most altitude, least and most forward, most across.
    altitude: [f64; 2],
    forward: [f64; 2],
    across: f64,
    record: Record,
    losses: u32,
    mode: (u8, u8),
    dropped: u64,
    /// Set-points sent after the end.
    after: usize,
}

/// Flies `experiment` until 10 s after the end of the reference. `event` may act at each step of the vehicle.
fn companion_flies(
    experiment: &Experiment,
    quality: Quality,
    hover_thrust: f64,
    mut event: impl FnMut(f64, &mut Autopilot<Craft>, &mut Way),
) -> Flight {
    let mut settings = settings(experiment, Some(hover_thrust)).unwrap();
    settings.engage = true;
    let plan = plan(experiment);
    let mut companion = Companion::new(settings, Wanted::Plan(&plan));
    let mut pilot = Controlled::new(experiment).unwrap();
    let mut autopilot = Autopilot::new(Craft::new(experiment));
    let (mut down, mut up) = (Way::new(quality, 1), Way::new(quality, 2));
    let mut flight = Flight {
        stage: Stage::Waiting,
        altitude: [0.0; 2],
        forward: [0.0; 2],
        across: 0.0,
        record: Record::new(),
        losses: 0,
        mode: HOLD,
        dropped: 0,
        after: 0,
    };
    let mut origin = None;
    let steps = ((experiment.duration_s + 10.0) * f64::from(PLANT)) as u32;
    for step in 0..steps {
        let now = f64::from(step) / f64::from(PLANT);
        event(now, &mut autopilot, &mut down);
        for message in autopilot.send(now) {
            down.send(now, Autopilot::<Craft>::HEADER, &message);
        }
        for (header, message) in down.receive(now) {
            companion.receive(now, &header, &message);
        }
        if step % (PLANT / RATE) == 0 {
            let ended = matches!(companion.stage(), Stage::Ended(_));
            let (messages, commanded) = companion.step(now, &mut pilot);
            if ended {
                flight.after += messages.len();
            }
            for message in messages {
                up.send(now, Companion::HEADER, &message);
            }
            if let Some(commanded) = commanded {
                keep(&mut flight.record, &pilot, experiment, &commanded);
            }
            if let Stage::Flying(since) = companion.stage() {
                let state = autopilot.body().spatial();
                let from = *origin.get_or_insert(state.position);
                let wanted = experiment.reference.position(now - since);
                let x = state.position - from;
                let extend = |[least, most]: [f64; 2], v: f64| [least.min(v), most.max(v)];
                flight.altitude = extend(flight.altitude, wanted.x - x.z);
                flight.forward = extend(flight.forward, x.x - wanted.y);
                flight.across = flight.across.max(x.y.abs());
            }
        }
        for (_, message) in up.receive(now) {
            autopilot.receive(now, &message);
        }
        autopilot.advance(now, 1.0 / f64::from(PLANT));
    }
    flight.stage = companion.stage();
    flight.losses = autopilot.losses();
    flight.mode = autopilot.mode();
    flight.dropped = companion.inbox().counts.dropped;
    flight
}

fn nothing(_: f64, _: &mut Autopilot<Craft>, _: &mut Way) {}

fn experiment(settings: &[&str]) -> Experiment {
    let mut document = Document::load("round-trip").unwrap();
    for setting in settings {
        document.assign(setting).unwrap();
    }
    document.checked().unwrap()
}

/// 1.5 times the altitude figures of the flight in process, of the same experiment.
fn assert_within_one_and_a_half(flight: &Flight, experiment: &Experiment) {
    let record = fly(experiment).unwrap();
    let figures = Figures::of(experiment, &record);
    let (least, most) = (
        figures.get("altitude_least_m"),
        figures.get("altitude_most_m"),
    );
    let [low, high] = flight.altitude;
    println!(
        "altitude {low:.2}…{high:.2} m, in process {least:.2}…{most:.2} m; forward {:?}, across {:.3} m",
        flight.forward, flight.across
    );
    assert!(
        low > 1.5 * least && high < 1.5 * most,
        "{low} {high}, in process {least} {most}"
    );
}

#[test]
fn the_round_trip_over_a_good_link_is_that_in_process() {
    let experiment = experiment(&[]);
    let flight = companion_flies(&experiment, GOOD, 0.5, nothing);
    assert_eq!(flight.stage, Stage::Ended(End::Finished));
    assert_eq!((flight.mode, flight.losses), (HOLD, 0));
    assert_within_one_and_a_half(&flight, &experiment);
    // In the plane nothing pushes across it.
    assert!(flight.across < 0.01);
    assert_eq!(flight.after, 0);
}

#[test]
fn the_round_trip_over_a_bad_link_is_within_one_and_a_half_times_that_in_process() {
    let experiment = experiment(&[]);
    let flight = companion_flies(&experiment, BAD, 0.5, nothing);
    assert_eq!(flight.stage, Stage::Ended(End::Finished));
    assert_eq!((flight.mode, flight.losses), (HOLD, 0));
    assert!(flight.dropped > 50, "late messages: {}", flight.dropped);
    assert_within_one_and_a_half(&flight, &experiment);
    assert!(flight.across < 0.01);
    // The record's steps are those of the companion; its figures are made as those of any flight.
    assert!((flight.record.len() as f64 - experiment.duration_s * f64::from(RATE)).abs() < 5.0);
    let figures = Figures::of(&experiment, &flight.record);
    assert!((figures.get("altitude_most_m") - flight.altitude[1]).abs() < 0.5);
}

#[test]
fn the_pilot_takes_over_at_once_and_nothing_is_sent_any_more() {
    let experiment = experiment(&[]);
    let flight = companion_flies(&experiment, GOOD, 0.5, |now, autopilot, _| {
        if (now - 15.0).abs() < 1e-9 {
            autopilot.set_mode((2, 0));
        }
    });
    assert_eq!(flight.stage, Stage::Ended(End::TakenOver));
    assert_eq!((flight.mode, flight.after), ((2, 0), 0));
    // The heartbeat of the change is sent at once: the record ends with it.
    let last = flight.record.last().unwrap().t;
    assert!((10.0..15.0).contains(&last), "{last}");
}

#[test]
fn a_lost_link_ends_the_flight_and_the_autopilot_holds() {
    let experiment = experiment(&[]);
    let flight = companion_flies(&experiment, GOOD, 0.5, |now, _, down| {
        if now > 15.0 {
            down.quality.lost = 1.0;
        }
    });
    assert_eq!(flight.stage, Stage::Ended(End::LinkLost));
    assert_eq!((flight.mode, flight.losses, flight.after), (HOLD, 1, 0));
    assert!(flight.record.last().unwrap().t < 15.0);
}

/// OFFBOARD is refused without a stream; with one it is granted, and left when the stream ceases.
#[test]
fn the_simulated_autopilot_keeps_px4s_rules() {
    let experiment = experiment(&[]);
    let mut autopilot = Autopilot::new(Craft::new(&experiment));
    let settings = settings(&experiment, Some(0.5)).unwrap();
    let plan = plan(&experiment);
    let mut companion = Companion::new(settings, Wanted::Plan(&plan));
    let mut pilot = Controlled::new(&experiment).unwrap();
    // Not told to engage, the companion streams and never asks.
    for step in 0..150 {
        let now = f64::from(step) / 50.0;
        for message in autopilot.send(now) {
            companion.receive(now, &Autopilot::<Craft>::HEADER, &message);
        }
        for message in companion.step(now, &mut pilot).0 {
            assert!(!matches!(message, MavMessage::COMMAND_LONG(_)));
            autopilot.receive(now, &message);
        }
        autopilot.advance(now, 0.02);
    }
    assert!(matches!(companion.stage(), Stage::Streaming(_)));
    assert_eq!(autopilot.mode(), HOLD);
    // Somebody else engages.
    autopilot.set_mode((OFFBOARD, 0));
    for message in autopilot.send(3.0) {
        companion.receive(3.0, &Autopilot::<Craft>::HEADER, &message);
    }
    let (messages, commanded) = companion.step(3.0, &mut pilot);
    assert!(matches!(companion.stage(), Stage::Flying(_)) && commanded.is_some());
    assert!(
        messages
            .iter()
            .any(|m| matches!(m, MavMessage::SET_ATTITUDE_TARGET(_)))
    );
    // The stream ceases.
    autopilot.advance(4.5, 0.02);
    assert_eq!((autopilot.mode(), autopilot.losses()), (HOLD, 1));
}

#[test]
fn study() {
    let experiment = experiment(&[]);
    for latency in [0.0, 0.01, 0.02, 0.03] {
        for hover in [0.45, 0.5] {
            let quality = Quality {
                latency,
                jitter: 0.0,
                late: 0.0,
                lost: 0.0,
                garbage: 0.0,
            };
            let f = companion_flies(&experiment, quality, hover, nothing);
            println!("{latency} {hover}: {:?} {:?}", f.altitude, f.forward);
        }
    }
    for seed in 0..3 {
        let _ = seed;
        let f = companion_flies(&experiment, BAD, 0.5, nothing);
        println!("bad: {:?} {:?}", f.altitude, f.forward);
    }
}
