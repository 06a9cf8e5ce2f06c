//! The link, and both sides of it.

use std::net::UdpSocket;
use std::time::Duration;

use alula_bridges::companion::{
    Autopilot, Companion, Kind, MavHeader, MavMessage, Pilot, Settings, Stage, Sticks, wire,
};
use alula_sil::companion::Craft;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// One direction of the link: a socket's bytes to another one, delayed and lost.
pub struct Channel {
    from: UdpSocket,
    to: UdpSocket,
    random: ChaCha8Rng,
    pub quality: Quality,
    /// Time of arrival \[s\], and the bytes.
    pending: Vec<(f64, Vec<u8>)>,
    sequence: u8,
}

/// What a link does to messages.
#[derive(Clone, Copy)]
pub struct Quality {
    /// Each is this late \[s\],
    latency: f64,
    /// and by up to this more, so that some overtake others;
    jitter: f64,
    /// this share is late by 0.1 s more;
    late: f64,
    /// this share is lost;
    pub lost: f64,
    /// this share is followed by bytes that are no message.
    garbage: f64,
}

impl Quality {
    /// The same, but for the share that is lost.
    pub const fn losing(self, lost: f64) -> Self {
        Self { lost, ..self }
    }
}

pub const GOOD: Quality = Quality {
    latency: 0.0,
    jitter: 0.0,
    late: 0.0,
    lost: 0.0,
    garbage: 0.0,
};

/// 20 ms of latency in the mean, each way, and 2 % lost; late and reordered ones, and garbage.
pub const BAD: Quality = Quality {
    latency: 0.015,
    jitter: 0.01,
    late: 0.01,
    lost: 0.02,
    garbage: 0.01,
};

impl Channel {
    pub fn new(quality: Quality, seed: u64) -> Self {
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

    pub fn send(&mut self, now: f64, header: MavHeader, message: &MavMessage) {
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
    pub fn receive(&mut self, now: f64) -> Vec<(MavHeader, MavMessage)> {
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

/// An ArduPlane whose sticks turn it at 360, 180 and 180 °/s.
pub const ARDUPLANE: Kind = Kind::ArduPlane(Sticks {
    roll: std::f32::consts::TAU,
    pitch: std::f32::consts::PI,
    yaw: std::f32::consts::PI,
});

/// Rate of the companion's steps \[Hz\], and of the vehicle's.
pub const RATE: u32 = 50;
pub const PLANT: u32 = 500;

/// How a flight went.
#[derive(Clone, Copy)]
pub struct Ended {
    pub stage: Stage,
    pub losses: u32,
    pub mode: u32,
    pub dropped: u64,
    /// Messages sent after the end, but for those that give channels back; whether a channel is not given back.
    pub after: usize,
    pub overridden: bool,
}

/// Lets `pilot` fly `craft` over two ways of this quality, for `duration` \[s\]. `event` may act at each step of the vehicle; `flown` is
/// called after each step of the pilot, with the time since the start and the vehicle.
pub fn flies<P: Pilot>(
    pilot: &mut P,
    craft: Craft,
    settings: (Settings, f64),
    link: (Quality, u64),
    event: impl FnMut(f64, &mut Autopilot<Craft>, &mut Channel),
    observe: impl FnMut(f64, &P, &Craft),
) -> Ended {
    let autopilot = Autopilot::new(craft, settings.0.kind);
    flies_with(pilot, autopilot, settings, link, as_it_is, event, observe)
}

/// A message of the companion as it sends it.
pub fn as_it_is(message: MavMessage, _: &Craft) -> MavMessage {
    message
}

/// The same with an `autopilot` that is there already, and with messages of the companion made into others.
pub fn flies_with<P: Pilot>(
    pilot: &mut P,
    mut autopilot: Autopilot<Craft>,
    (mut settings, duration): (Settings, f64),
    (quality, seed): (Quality, u64),
    sent: impl Fn(MavMessage, &Craft) -> MavMessage,
    mut event: impl FnMut(f64, &mut Autopilot<Craft>, &mut Channel),
    mut observe: impl FnMut(f64, &P, &Craft),
) -> Ended {
    settings.engage = true;
    let mut companion = Companion::new(settings);
    let (mut down, mut up) = (
        Channel::new(quality, 2 * seed),
        Channel::new(quality, 2 * seed + 1),
    );
    let mut after = 0;
    for step in 0..(duration * f64::from(PLANT)) as u32 {
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
            let (messages, commanded) = companion.step(now, pilot);
            if ended {
                after += messages.iter().filter(|m| !gives_back(m)).count();
            }
            for message in messages {
                up.send(now, companion.header(), &sent(message, autopilot.body()));
            }
            if let (Some(_), Stage::Flying(since)) = (commanded, companion.stage()) {
                observe(now - since, pilot, autopilot.body());
            }
        }
        for (header, message) in up.receive(now) {
            autopilot.receive(now, &header, &message);
        }
        autopilot.advance(now, 1.0 / f64::from(PLANT));
    }
    Ended {
        stage: companion.stage(),
        losses: autopilot.losses(),
        mode: autopilot.mode(),
        dropped: companion.inbox().counts.dropped,
        after,
        overridden: autopilot.is_overridden(),
    }
}

/// Whether a message gives the channels back to the transmitter.
fn gives_back(message: &MavMessage) -> bool {
    let MavMessage::RC_CHANNELS_OVERRIDE(m) = message else {
        return false;
    };
    [m.chan1_raw, m.chan2_raw, m.chan3_raw, m.chan4_raw] == [0; 4]
}

pub fn nothing(_: f64, _: &mut Autopilot<Craft>, _: &mut Channel) {}
