//! The companion's state machine.

use super::inbox::Inbox;
use super::stage::{Command, End, Pilot, Settings, Stage, Told};
use super::{Kind, MavHeader, MavMessage, OWN_SYSTEM, Setpoint, outbox};
use alula::guidance::Air;
use alula::ned::{BodyAxes, Frd, Ned};
use alula::spatial::Orientation;

/// The state machine.
pub struct Companion {
    settings: Settings,
    inbox: Inbox,
    stage: Stage,
    origin: Ned,
    last_step: f64,
    next_heartbeat: f64,
    next_request: f64,
    /// How long \[s\] the reference had been flown when the flight was over.
    elapsed: f64,
    /// How often channels are still to be given back.
    releases: u32,
    /// What was left of a per cent of throttle at the last step.
    rest: f32,
}

/// Time \[s\] between heartbeats, and between requests for a mode; time of streaming before the first.
const SECOND: f64 = 1.0;
/// Time \[s\] after which a wind is not used any more.
const OLD_WIND: f64 = 10.0;
/// Airspeed [m/s] below which it says nothing.
const LEAST_AIRSPEED: f32 = 5.0;
/// How long \[s\] a set-point is flown before the next one comes: the companion's steps are at 50 Hz. ArduPlane reads its sticks at 50 Hz, too, at
/// times of its own.
const HELD: f64 = 0.02;
const READ: f64 = 0.01;
/// How often channels are given back: of as many messages one arrives.
const RELEASES: u32 = 10;
/// Longest time \[s\] over which the state is predicted: a link, or a busy machine, holds messages up for 0.2 s now and then. Beyond, a turn says
/// little of the attitude.
const MOST_LEAD: f64 = 0.25;

/// Standard gravity [m/s²].
const GRAVITY: f32 = 9.806_65;

/// Age \[s\] of a specific force that is not used any more.
const OLD_FORCE: f64 = 0.1;

/// Time \[s\] without a set-point after which a flight that is led is over: PX4's own, `COM_OF_LOSS_T`, which does not see those that we are sent.
const UNLED: f64 = 1.0;

/// Time \[s\] without a heartbeat after which the mode is not known any more: a pilot who takes over would not be seen. They come every second.
const UNHEARD: f64 = 3.5;

/// Time \[s\] after which the autopilot is left even if it does not hold.
const LEAVE: f64 = 3.0;

impl Companion {
    /// A companion that waits for an autopilot.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            inbox: Inbox::new(settings.kind),
            stage: Stage::Waiting,
            origin: Ned::default(),
            last_step: f64::NEG_INFINITY,
            next_heartbeat: f64::NEG_INFINITY,
            next_request: 0.0,
            elapsed: 0.0,
            releases: 0,
            rest: 0.0,
        }
    }

    /// Header of its messages; the component is ONBOARD_COMPUTER.
    #[must_use]
    pub fn header(&self) -> MavHeader {
        MavHeader {
            system_id: self.settings.kind.own_system().into(),
            component_id: 191,
            sequence: 0,
        }
    }

    /// Ends the flight, if there is one.
    pub fn stop(&mut self) {
        if !matches!(self.stage, Stage::Ended(_)) {
            self.end(End::Stopped);
        }
    }

    /// Whether it has ended and has nothing more to send.
    #[must_use]
    pub fn is_done(&self) -> bool {
        matches!(self.stage, Stage::Ended(_)) && self.releases == 0
    }

    /// What it does.
    #[must_use]
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// What came.
    #[must_use]
    pub fn inbox(&self) -> &Inbox {
        &self.inbox
    }

    /// Takes a message that arrived `now` \[s\].
    pub fn receive(&mut self, now: f64, header: &MavHeader, message: &MavMessage) {
        self.inbox.take(now, header, message);
        // At once: what is on its way to the autopilot is of no effect in another mode.
        let flies = matches!(self.stage, Stage::Flying(_));
        if flies && self.inbox.mode.is_some() && !self.is_ours() {
            self.end(End::TakenOver);
        } else if flies && !self.inbox.armed {
            self.end(End::Disarmed);
        }
    }

    /// Whether what it was asked for over the link has ceased. Until something is asked for it stays.
    fn is_unled(&self, now: f64) -> bool {
        let asked = self.inbox.setpoint;
        self.settings.led && asked.is_some_and(|asked| now - asked.arrived > UNLED)
    }

    /// Whether the autopilot is in the mode that the companion flies in.
    fn is_ours(&self) -> bool {
        let mode = self.inbox.mode;
        mode.is_some_and(|mode| self.settings.kind.is_commanded(mode))
    }

    /// Whether the autopilot has a vehicle to fly: armed, and in the air. The companion does not take off.
    #[must_use]
    pub fn is_ready(&self) -> bool {
        self.inbox.armed && self.inbox.in_air
    }

    /// Ends. ArduPlane's channels, if they were taken, are given back, unless the link is lost: then ArduPlane takes them back itself.
    fn end(&mut self, end: End) {
        let took = matches!(self.stage, Stage::Flying(_) | Stage::Leaving(_));
        let sticks = matches!(self.settings.kind, Kind::ArduPlane(_));
        if took && sticks && end != End::LinkLost {
            self.releases = RELEASES;
        }
        self.stage = Stage::Ended(end);
    }

    /// One step, `now` \[s\]: messages to send, and what `pilot` commanded if it flies.
    pub fn step(&mut self, now: f64, pilot: &mut dyn Pilot) -> (Vec<MavMessage>, Option<Command>) {
        let mut messages = Vec::new();
        if matches!(self.stage, Stage::Ended(_)) {
            self.release(&mut messages);
            return (messages, None);
        }
        let dt = (now - self.last_step) as f32;
        self.last_step = now;
        if now >= self.next_heartbeat {
            self.next_heartbeat = now + SECOND;
            messages.extend([outbox::heartbeat(), outbox::time(now)]);
            // A first heartbeat says whom to ask.
            let waits = matches!(self.stage, Stage::Waiting | Stage::Streaming(_));
            if waits && self.inbox.mode.is_some() {
                messages.extend(outbox::requests_of_state(self.target()));
            }
        }
        let known = self.inbox.age_by_clock(now) <= self.settings.timeout;
        let (kind, ours) = (self.settings.kind, self.is_ours());
        match self.stage {
            Stage::Waiting if known && self.inbox.mode.is_some() => {
                self.stage = Stage::Streaming(now);
                self.next_request = now + SECOND;
            }
            Stage::Streaming(_) if !known => {
                self.inbox.awaited = None;
                self.stage = Stage::Waiting;
            }
            Stage::Streaming(_) if !self.is_ready() => {}
            Stage::Streaming(_) if ours => self.start(now, pilot),
            Stage::Streaming(_) if self.settings.engage && now >= self.next_request => {
                self.next_request = now + SECOND;
                self.inbox.awaited = Some(kind.commanded());
                messages.push(outbox::request(
                    self.target(),
                    kind.parameters(kind.commanded()),
                ));
            }
            Stage::Flying(_) | Stage::Leaving(_) if !known || now - self.inbox.heard > UNHEARD => {
                self.end(End::LinkLost);
            }
            Stage::Flying(since)
                if now - since > self.settings.duration
                    || self.is_unled(now)
                    || pilot.is_over() =>
            {
                self.stage = Stage::Leaving(now);
                self.elapsed = (now - since).min(self.settings.duration);
                self.next_request = now;
            }
            Stage::Leaving(since) if !ours || now - since > LEAVE => self.end(End::Finished),
            _ => {}
        }
        let commanded = match self.stage {
            Stage::Waiting => return (messages, None),
            Stage::Ended(_) => {
                self.release(&mut messages);
                return (messages, None);
            }
            Stage::Streaming(_) => {
                if kind == Kind::Px4 {
                    let thrust = match self.is_ready() {
                        true => self.settings.weight,
                        false => 0.0,
                    };
                    messages.push(self.set_point(now, [0.0; 3], thrust));
                }
                None
            }
            Stage::Flying(since) => self.fly(now, now - since, dt, pilot, &mut messages),
            Stage::Leaving(_) => {
                if now >= self.next_request {
                    self.next_request = now + SECOND;
                    messages.push(outbox::request(self.target(), kind.parameters(kind.hold())));
                }
                self.fly(now, self.elapsed, dt, pilot, &mut messages)
            }
        };
        (messages, commanded)
    }

    /// The flight begins where the vehicle is.
    fn start(&mut self, now: f64, pilot: &mut dyn Pilot) {
        let Some(motion) = self.inbox.motion else {
            return;
        };
        self.origin = motion.value.0;
        let Some(told) = self.told(now, 0.0) else {
            return;
        };
        let q = told.orientation.to_quaternion(BodyAxes::NoseUp);
        // The wing, y, in the world: north and east.
        let wing = (
            2.0 * (q.x * q.y - q.w * q.z),
            q.w * q.w - q.x * q.x + q.y * q.y - q.z * q.z,
        );
        self.inbox.awaited = None;
        // What is streamed before, and what holds a vehicle that hovers.
        let last = Command {
            thrust: self.settings.weight,
            rates: [0.0; 3],
        };
        pilot.begin(&told, (-wing.0).atan2(wing.1), last);
        self.stage = Stage::Flying(now);
    }

    /// What is known of the air: the wind that the autopilot estimates, or else what the airspeed says of it along the flight.
    fn air(&self, now: f64, velocity: Ned) -> Air<Ned> {
        let fresh = |arrived: f64| now - arrived < OLD_WIND;
        if let Some(wind) = self.inbox.wind.filter(|w| fresh(w.arrived)) {
            return Air::Wind(wind.value);
        }
        let airspeed = self.inbox.airspeed.filter(|a| fresh(a.arrived));
        let ground = velocity.north.hypot(velocity.east);
        match airspeed.map(|a| a.value).filter(|a| *a >= LEAST_AIRSPEED) {
            Some(airspeed) if ground >= LEAST_AIRSPEED => {
                let level = airspeed * airspeed - velocity.down * velocity.down;
                let along = (ground - level.max(0.0).sqrt()) / ground;
                Air::Wind(Ned::new(along * velocity.north, along * velocity.east, 0.0))
            }
            _ => Air::Unknown,
        }
    }

    /// One set-point of the flight.
    fn fly(
        &mut self,
        now: f64,
        t: f64,
        dt: f32,
        pilot: &mut dyn Pilot,
        messages: &mut Vec<MavMessage>,
    ) -> Option<Command> {
        let answer = match self.told(now, t) {
            Some(told) => pilot.answer(&told, dt),
            None => Err(End::Attitude),
        };
        match answer {
            Ok(command) => {
                messages.push(self.set_point(now, command.rates, command.thrust));
                Some(command)
            }
            Err(end) => {
                self.end(end);
                self.release(messages);
                None
            }
        }
    }

    /// The state when the command will act, by what is known of rates and acceleration. None if the attitude is none.
    fn told(&self, now: f64, t: f64) -> Option<Told> {
        let (attitude, motion) = (self.inbox.attitude?, self.inbox.motion?);
        let (q, rates) = attitude.value;
        let read = match self.settings.kind {
            Kind::Px4 => 0.0,
            Kind::ArduPlane(_) => READ,
        };
        let ahead = self.inbox.clock.latency() + HELD + read;
        let lead = |age: f64| (age + ahead).min(MOST_LEAD) as f32;
        let turning = lead(self.inbox.age_of(&attitude, now));
        let axes = BodyAxes::NoseUp;
        // The mean rate over a time is that at its half.
        let spin = self.inbox.angular_acceleration;
        let led = |time: f32| {
            let mean = std::array::from_fn(|k| rates[k] + 0.5 * time * spin[k]);
            let turned = q.leading(axes, axes.vector(mean), time).0;
            Orientation::from_quaternion(&turned, axes).ok()
        };
        let moving = lead(self.inbox.age_of(&motion, now));
        let (x, v) = motion.value;
        let force = self
            .inbox
            .specific_force
            .filter(|f| now - f.arrived < OLD_FORCE)
            .map(|f| axes.vector::<Frd>(f.value));
        // The force turns with the body.
        let acceleration = match force {
            Some(force) => led(0.5 * turning)?.to_world(force) + Ned::new(0.0, 0.0, GRAVITY),
            None => self.inbox.acceleration,
        };
        let velocity = v + acceleration * moving;
        let asked = self.inbox.setpoint.map(|asked| {
            let setpoint = Setpoint {
                position: asked.value.position.map(|x| x - self.origin),
                ..asked.value
            };
            (setpoint, (now - asked.arrived) as f32)
        });
        Some(Told {
            t: t + ahead,
            position: x + (v + acceleration * (0.5 * moving)) * moving - self.origin,
            start: self.origin,
            velocity,
            orientation: led(turning)?,
            rates,
            age: (self.inbox.age(now) + ahead - MOST_LEAD).max(0.0) as f32,
            air: self.air(now, velocity),
            specific_force: force,
            asked,
        })
    }

    /// The message of body rates about hover's axes and thrust \[N\].
    fn set_point(&mut self, now: f64, rates: [f32; 3], thrust: f32) -> MavMessage {
        let share = thrust / self.settings.weight * self.settings.hover_thrust;
        match self.settings.kind {
            Kind::Px4 => outbox::set_point(self.target(), now, rates, share),
            Kind::ArduPlane(sticks) => {
                // What rounding to a per cent leaves is added to the next one, so that the mean is the thrust wanted.
                let wanted = share + self.rest;
                let (pulses, sent) = sticks.pulses(rates, wanted);
                // Half a per cent at most: beyond the throttle's ends, and for what is no number, nothing is owed.
                let rest = wanted - sent;
                self.rest = if rest.abs() <= 0.005 { rest } else { 0.0 };
                outbox::sticks(self.target(), pulses)
            }
        }
    }

    /// Gives ArduPlane's channels back.
    fn release(&mut self, messages: &mut Vec<MavMessage>) {
        if self.releases > 0 {
            self.releases -= 1;
            messages.push(outbox::sticks(self.target(), [0; 4]));
        }
    }

    /// The autopilot's system.
    fn target(&self) -> u8 {
        self.inbox
            .system
            .and_then(|id| id.try_into().ok())
            .unwrap_or(OWN_SYSTEM)
    }
}

#[cfg(test)]
mod tests {
    use super::super::OFFBOARD;
    use super::super::messages::{
        ATTITUDE_QUATERNION_DATA, EXTENDED_SYS_STATE_DATA, HEARTBEAT_DATA, LOCAL_POSITION_NED_DATA,
        MavLandedState, MavModeFlag, TIMESYNC_DATA,
    };
    use super::*;

    struct Still;

    impl Pilot for Still {
        fn begin(&mut self, _: &Told, _: f32, _: Command) {}

        fn answer(&mut self, _: &Told, _: f32) -> Result<Command, End> {
            Ok(Command {
                thrust: 10.0,
                rates: [0.0; 3],
            })
        }
    }

    /// When and how a flight ends whose heartbeats come until `heard` \[s\], and whose states, at 50 Hz, tell of `late` \[s\] before. The vehicle is
    /// in the air from the heartbeat at 2 s on.
    fn ends(heard: f64, late: impl Fn(f64) -> f64) -> (f64, End) {
        ends_armed(heard, late, |_| true)
    }

    /// The same where it is `armed` at times \[s\].
    fn ends_armed(
        heard: f64,
        late: impl Fn(f64) -> f64,
        armed: impl Fn(f64) -> bool,
    ) -> (f64, End) {
        let mut companion = Companion::new(Settings {
            kind: Kind::Px4,
            weight: 10.0,
            hover_thrust: 0.5,
            engage: false,
            led: false,
            duration: 60.0,
            timeout: 0.5,
        });
        for tick in 0..500_u32 {
            let now = f64::from(tick) * 0.02;
            let header = MavHeader {
                system_id: 1,
                component_id: 1,
                sequence: (2 * tick) as u8,
            };
            let mut take = |message| companion.receive(now, &header, &message);
            if tick % 50 == 0 && now < heard {
                take(MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                    custom_mode: OFFBOARD,
                    base_mode: match armed(now) {
                        true => MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
                        false => MavModeFlag::empty(),
                    },
                    ..HEARTBEAT_DATA::default()
                }));
                take(MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
                    landed_state: match now > 1.5 {
                        true => MavLandedState::MAV_LANDED_STATE_IN_AIR,
                        false => MavLandedState::MAV_LANDED_STATE_ON_GROUND,
                    },
                    ..EXTENDED_SYS_STATE_DATA::default()
                }));
                // The clocks are the same.
                let at = (now * 1e9) as i64;
                take(MavMessage::TIMESYNC(TIMESYNC_DATA { ts1: at, tc1: at }));
            }
            let time_boot_ms = (10.0 + now - late(now)).mul_add(1e3, 0.5) as u32 - 10_000;
            take(MavMessage::ATTITUDE_QUATERNION(ATTITUDE_QUATERNION_DATA {
                time_boot_ms,
                q1: 1.0,
                ..ATTITUDE_QUATERNION_DATA::default()
            }));
            take(MavMessage::LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA {
                time_boot_ms,
                ..LOCAL_POSITION_NED_DATA::default()
            }));
            let (sent, _) = companion.step(now, &mut Still);
            // On the ground nothing is flown, and no thrust is asked for.
            let thrust = sent.iter().find_map(|message| match message {
                MavMessage::SET_ATTITUDE_TARGET(m) => Some(m.thrust),
                _ => None,
            });
            if now < 2.0 || !armed(now.floor()) {
                assert!(!matches!(companion.stage(), Stage::Flying(_)), "{now}");
                assert!(thrust.is_none_or(|thrust| thrust == 0.0), "{now}");
            } else if matches!(companion.stage(), Stage::Flying(_)) {
                assert_eq!(thrust, Some(0.5));
            }
            if let Stage::Ended(end) = companion.stage() {
                return (now, end);
            }
        }
        panic!("it flies on");
    }

    /// Attitude and motion come on, and heartbeats cease: whether the pilot has taken over would not be seen.
    #[test]
    fn without_heartbeats_the_flight_ends() {
        let (when, end) = ends(5.0, |_| 0.0);
        // The last heartbeat at 4 s.
        assert_eq!(end, End::LinkLost);
        assert!((when - 7.52).abs() < 0.03, "{when}");
    }

    /// OFFBOARD is set before the vehicle is armed, at 3 s: it flies from then on, and until it is disarmed.
    #[test]
    fn only_an_armed_vehicle_is_flown() {
        let (when, end) = ends_armed(60.0, |_| 0.0, |t| (3.0..6.0).contains(&t));
        assert_eq!((when, end), (6.0, End::Disarmed));
    }

    /// States come on at 50 Hz, and are ever older: they queue up on the link. So they do when each bears the stamp of the last one.
    #[test]
    fn states_that_are_too_old_end_the_flight_though_they_arrive() {
        for rate in [0.5, 1.0] {
            let (when, end) = ends(60.0, |now| rate * (now - 3.0).max(0.0));
            assert_eq!(end, End::LinkLost);
            assert!((when - 3.0 - 0.5 / rate).abs() < 0.05, "{when}");
        }
    }

    /// One state of 1.5 s ago among those of now is dropped: it does not make the vehicle jump back, nor the flight end.
    #[test]
    fn a_single_late_state_is_dropped() {
        let (when, _) = ends(5.0, |now| if (now - 3.0).abs() < 1e-6 { 1.5 } else { 0.0 });
        assert!((when - 7.52).abs() < 0.03, "{when}");
    }
}
