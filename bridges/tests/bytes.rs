//! No bytes from the network make anything panic: random ones, and messages that were damaged.
//!
//! `cargo test -p alula-bridges --test bytes` reads 200,000 inputs of each kind;
//! `cargo test --release -p alula-bridges --test bytes -- --ignored` reads ten million.
#![cfg(not(target_os = "none"))]

use alula::ned::Ned;
use alula_bridges::companion::{
    Autopilot, Body, BodyState, Command, Companion, End, Kind, MavHeader, Pilot, Settings, Stage,
    Sticks, Told, wire,
};
use alula_bridges::sitl::client::{Client, parse};
use alula_bridges::sitl::{ActuatorState, Actuators, Flow, Lockstep, Packet, Physics, Sample};

const FEW: u32 = 200_000;
const MANY: u32 = 10_000_000;

/// Marsaglia's xorshift64*: the same inputs every time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, bound: usize) -> usize {
        ((self.next() >> 32) as usize) % bound.max(1)
    }

    fn bytes(&mut self, most: usize) -> Vec<u8> {
        (0..self.below(most)).map(|_| self.next() as u8).collect()
    }

    /// `seed` with up to four changes, or random bytes.
    fn damaged(&mut self, seed: &[u8]) -> Vec<u8> {
        if self.below(8) == 0 {
            return self.bytes(300);
        }
        let mut bytes = seed.to_vec();
        for _ in 0..self.below(5) {
            if bytes.is_empty() {
                break;
            }
            let at = self.below(bytes.len());
            match self.below(5) {
                0 => bytes[at] ^= 1 << self.below(8),
                1 => bytes[at] = self.next() as u8,
                2 => bytes.truncate(at),
                3 => bytes.insert(at, self.next() as u8),
                _ => {
                    let piece = self.bytes(8);
                    bytes.splice(at..at, piece);
                }
            }
        }
        bytes
    }
}

/// Physics that moves, by what it is told.
#[derive(Default)]
struct Plant {
    thrust: ActuatorState,
    steps: u64,
}

impl Physics for Plant {
    fn step(&mut self, packet: &Packet) -> Sample {
        self.steps += 1;
        let actuators = Actuators::default();
        self.thrust = actuators.thrust(packet, 100.0);
        let wrench = actuators.wrench(packet, self.thrust, (5.0, 0.3), &Flow::default());
        assert!(
            (0.0..=100.0).contains(&wrench.thrust) && wrench.torque.iter().all(|t| t.is_finite())
        );
        Sample {
            timestamp: self.steps as f64,
            gyro: wrench.torque,
            ..Sample::default()
        }
    }

    fn restart(&mut self) {
        self.steps = 0;
    }
}

fn servo_packets(inputs: u32) {
    let mut random = Random(7);
    let (mut lockstep, mut plant) = (Lockstep::default(), Plant::default());
    let mut count = 0;
    for n in 0..inputs {
        let widths: Vec<u16> = (0..if n % 2 == 0 { 16 } else { 32 })
            .map(|_| random.next() as u16)
            .collect();
        count += random.below(3) as u32;
        let bytes = random.damaged(&Packet::new(400, count, &widths).bytes());
        let answer = lockstep.receive(&bytes, &mut plant);
        assert!(answer.is_none() || Packet::parse(&bytes).is_ok());
        if let Some(answer) = answer {
            assert!(parse(&answer[1..answer.len() - 1]).is_some());
        }
    }
    let counts = lockstep.counts();
    let all = counts.steps + counts.repeated + counts.late + counts.malformed;
    assert_eq!(all, u64::from(inputs));
    assert!(
        counts.steps > 10_000 && counts.malformed > 10_000,
        "{counts:?}"
    );
}

fn answers(inputs: u32) {
    let mut random = Random(8);
    let mut client = Client::default();
    let sample = Sample {
        airspeed: Some(1.5),
        velocity_wind: Some([1.0, -2.0, 3.0]),
        ..Sample::default()
    };
    let seed = sample.text().into_bytes();
    let mut read = 0;
    for _ in 0..inputs {
        read += u32::from(client.receive(&random.damaged(&seed)).is_some());
    }
    assert!(read > 10_000, "{read}");
}

/// A body that stays.
struct Still;

impl Body for Still {
    fn step(&mut self, thrust: f64, rates: [f64; 3], _: f64) {
        assert!((0.0..=1.0).contains(&thrust) && rates.iter().all(|r| r.is_finite()));
    }

    fn state(&self) -> BodyState {
        BodyState {
            quaternion: [1.0, 0.0, 0.0, 0.0],
            ..BodyState::default()
        }
    }

    fn hover(&self) -> f64 {
        0.5
    }
}

/// Answers with what it is told, of whatever size.
struct Echo;

impl Pilot for Echo {
    fn begin(&mut self, _: &Told, _: f32, _: Command) {}

    fn answer(&mut self, told: &Told, _: f32) -> Result<Command, End> {
        let asked = told.asked.map_or(Ned::ZERO, |(asked, _)| asked.velocity);
        Ok(Command {
            thrust: told.velocity.north * 1e3,
            rates: [told.velocity.down, asked.east, told.position.down],
        })
    }
}

/// Both sides of the MAVLink bridge talk over a link that damages messages. What checksums let through may say anything: the payloads of
/// messages are random, too.
fn mavlink_messages(kind: Kind, inputs: u32) {
    let mut random = Random(9);
    let settings = Settings {
        kind,
        weight: 50.0,
        hover_thrust: 0.5,
        engage: true,
        led: true,
        duration: 1e9,
        timeout: 1e9,
    };
    let mut autopilot = Autopilot::new(Still, kind);
    let mut companion = Companion::new(settings);
    let (mut read, mut understood, mut commands, mut now, mut sequence) = (0, 0, 0, 0.0, 0_u8);
    while read < inputs {
        now += 0.02;
        let (up, commanded) = companion.step(now, &mut Echo);
        commands += u32::from(commanded.is_some());
        if matches!(companion.stage(), Stage::Ended(_)) {
            companion = Companion::new(Settings {
                led: random.below(2) == 0,
                ..settings
            });
        }
        for message in &up {
            let bytes = random.damaged(&wire::bytes(companion.header(), message));
            let (messages, _) = wire::parse(&bytes);
            read += 1;
            understood += messages.len();
            messages
                .iter()
                .for_each(|(h, m)| autopilot.receive(now, h, m));
        }
        autopilot.advance(now, 0.02);
        for message in autopilot.send(now) {
            sequence = sequence.wrapping_add(1);
            let header = MavHeader {
                sequence,
                ..Autopilot::<Still>::HEADER
            };
            let sound = wire::bytes(header, &message);
            let bytes = match random.below(4) {
                // A payload of random bits under a sound checksum.
                0 => reframed(&sound, &mut random),
                _ => random.damaged(&sound),
            };
            let (messages, _) = wire::parse(&bytes);
            read += 1;
            understood += messages.len();
            messages
                .iter()
                .for_each(|(h, m)| companion.receive(now, h, m));
        }
    }
    assert!(
        understood > 10_000 && commands > 100,
        "{understood} {commands}"
    );
}

/// The frame with a random payload, its checksum made anew.
fn reframed(frame: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = frame.to_vec();
    let end = bytes.len() - 2;
    bytes[10..end]
        .iter_mut()
        .for_each(|b| *b = random.next() as u8);
    // The last byte of a payload is not 0: zeros there are cut off.
    bytes[end - 1] |= 1;
    let id = u32::from_le_bytes([bytes[7], bytes[8], bytes[9], 0]);
    // Checksum seeds of the messages that are sent here, from the protocol's definition.
    let seed = match id {
        // A random mode ends the flight: rarely.
        0 if random.below(50) == 0 => 50,
        31 => 246,
        32 => 185,
        49 => 39,
        74 => 20,
        77 => 143,
        105 => 93,
        111 => 34,
        168 => 1,
        231 => 105,
        _ => return bytes,
    };
    let mut crc = 0xffff_u16;
    for byte in bytes[1..end].iter().chain([&seed]) {
        let mut t = *byte ^ (crc as u8);
        t ^= t << 4;
        crc = (crc >> 8) ^ (u16::from(t) << 8) ^ (u16::from(t) << 3) ^ (u16::from(t) >> 4);
    }
    bytes[end..].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[test]
fn few_servo_packets() {
    servo_packets(FEW);
}

#[test]
fn few_answers() {
    answers(FEW);
}

#[test]
fn few_mavlink_messages() {
    mavlink_messages(Kind::Px4, FEW);
    mavlink_messages(Kind::ArduPlane(Sticks::default()), FEW);
}

#[test]
#[ignore = "minutes"]
fn many_servo_packets() {
    servo_packets(MANY);
}

#[test]
#[ignore = "minutes"]
fn many_answers() {
    answers(MANY);
}

#[test]
#[ignore = "minutes"]
fn many_mavlink_messages() {
    mavlink_messages(Kind::Px4, MANY);
    mavlink_messages(Kind::ArduPlane(Sticks::default()), MANY);
}
