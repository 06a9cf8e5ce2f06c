//! The companion's state machine.

use super::inbox::Inbox;
use super::plane::VerticalPlane;
use super::stage::{Commanded, End, Pilot, Settings, Stage, Wanted};
use super::{HOLD, Hold, MavHeader, MavMessage, OFFBOARD, OWN_SYSTEM, outbox};
use alula::guidance::Air;
use alula::ned::Ned;
use alula::{Attitude, Inertial, PlanarInput, Reference};

/// The state machine.
pub struct Companion<'a> {
    settings: Settings,
    wanted: Wanted<'a>,
    inbox: Inbox,
    stage: Stage,
    hold: Option<Hold>,
    origin: Ned,
    last_step: f64,
    next_heartbeat: f64,
    next_request: f64,
}

/// Time \[s\] between heartbeats, and between requests for a mode; time of streaming before the first.
const SECOND: f64 = 1.0;
/// Time \[s\] after which a wind is not used any more.
const OLD_WIND: f64 = 10.0;
/// Airspeed [m/s] below which it says nothing.
const LEAST_AIRSPEED: f32 = 5.0;
/// How long \[s\] a set-point is flown before the next one comes: the companion's steps are at 50 Hz.
const HELD: f64 = 0.02;
/// Longest time \[s\] over which the state is predicted.
const MOST_LEAD: f64 = 0.15;

/// `x` after `dt` at this rate.
fn moved(x: Ned, rate: Ned, dt: f32) -> Ned {
    Ned::new(
        x.north + dt * rate.north,
        x.east + dt * rate.east,
        x.down + dt * rate.down,
    )
}

/// Time \[s\] after which the autopilot is left even if it does not hold.
const LEAVE: f64 = 3.0;

impl<'a> Companion<'a> {
    /// Header of the companion's messages: the system of most autopilots, component ONBOARD_COMPUTER.
    pub const HEADER: MavHeader = MavHeader {
        system_id: OWN_SYSTEM as u32,
        component_id: 191,
        sequence: 0,
    };

    /// A companion that waits for an autopilot.
    #[must_use]
    pub fn new(settings: Settings, wanted: Wanted<'a>) -> Self {
        Self {
            settings,
            wanted,
            inbox: Inbox::default(),
            stage: Stage::Waiting,
            hold: None,
            origin: Ned::default(),
            last_step: f64::NEG_INFINITY,
            next_heartbeat: f64::NEG_INFINITY,
            next_request: 0.0,
        }
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
        if flies && self.inbox.mode.is_some_and(|mode| mode.0 != OFFBOARD) {
            self.stage = Stage::Ended(End::TakenOver);
        }
    }

    /// One step, `now` \[s\]: messages to send, and what was commanded if the reference is flown.
    pub fn step(
        &mut self,
        now: f64,
        pilot: &mut dyn Pilot,
    ) -> (Vec<MavMessage>, Option<Commanded>) {
        let mut messages = Vec::new();
        if matches!(self.stage, Stage::Ended(_)) {
            return (messages, None);
        }
        let dt = (now - self.last_step) as f32;
        self.last_step = now;
        if now >= self.next_heartbeat {
            self.next_heartbeat = now + SECOND;
            messages.extend([outbox::heartbeat(), outbox::time(now)]);
        }
        let known = self.inbox.age(now) <= self.settings.timeout;
        let offboard = self.inbox.mode.is_some_and(|mode| mode.0 == OFFBOARD);
        match self.stage {
            Stage::Waiting if known && self.inbox.mode.is_some() => {
                self.stage = Stage::Streaming(now);
                self.next_request = now + SECOND;
            }
            Stage::Streaming(_) if !known => self.stage = Stage::Waiting,
            Stage::Streaming(_) if offboard => self.start(now),
            Stage::Streaming(_) if self.settings.engage && now >= self.next_request => {
                self.next_request = now + SECOND;
                messages.push(outbox::request(self.target(), (OFFBOARD, 0)));
            }
            Stage::Flying(_) | Stage::Leaving(_) if !known => {
                self.stage = Stage::Ended(End::LinkLost);
            }
            Stage::Flying(since) if now - since > self.settings.duration => {
                self.stage = Stage::Leaving(now);
                self.next_request = now;
            }
            Stage::Leaving(since) if !offboard || now - since > LEAVE => {
                self.stage = Stage::Ended(End::Finished);
            }
            _ => {}
        }
        let commanded = match self.stage {
            Stage::Waiting | Stage::Ended(_) => return (messages, None),
            Stage::Streaming(_) => {
                messages.push(self.set_point(now, [0.0; 3], self.settings.weight));
                None
            }
            Stage::Flying(since) => self.fly(now, now - since, dt, pilot, &mut messages),
            Stage::Leaving(_) => {
                if now >= self.next_request {
                    self.next_request = now + SECOND;
                    messages.push(outbox::request(self.target(), HOLD));
                }
                self.fly(now, self.settings.duration, dt, pilot, &mut messages)
            }
        };
        (messages, commanded)
    }

    /// The flight begins in the plane of the vehicle's heading, where it is.
    fn start(&mut self, now: f64) {
        let (Some(attitude), Some(motion)) = (self.inbox.attitude, self.inbox.motion) else {
            return;
        };
        let q = attitude.value.0;
        // The wing, y, in the world: north and east.
        let wing = (
            2.0 * (q.x * q.y - q.w * q.z),
            q.w * q.w - q.x * q.x + q.y * q.y - q.z * q.z,
        );
        let heading = (self.settings.heading).unwrap_or_else(|| (-wing.0).atan2(wing.1));
        let plane = VerticalPlane::from_heading(heading);
        self.origin = motion.value.0;
        self.hold = Some(Hold::new(self.settings.hold, plane, self.origin));
        self.stage = Stage::Flying(now);
    }

    /// The reference at `t`, in the plane, with its age \[s\].
    fn reference(
        &self,
        t: f64,
        now: f64,
        plane: &VerticalPlane,
    ) -> (Reference, Option<Inertial>, f64) {
        match &self.wanted {
            Wanted::Plan(at) => {
                let [velocity, acceleration, position] = at(t);
                let reference = Reference {
                    velocity,
                    acceleration,
                };
                (reference, Some(position), 0.0)
            }
            Wanted::Link => match self.inbox.setpoint {
                // Until something is asked for: stay.
                None => (Reference::default(), Some(Inertial::ZERO), 0.0),
                Some(asked) => {
                    let reference = Reference {
                        velocity: plane.project(asked.value.velocity).0,
                        acceleration: plane.project(asked.value.acceleration).0,
                    };
                    let position = asked.value.position.map(|x| self.relative(x, plane).0);
                    (reference, position, now - asked.arrived)
                }
            },
        }
    }

    fn relative(&self, x: Ned, plane: &VerticalPlane) -> (Inertial, f32) {
        let o = &self.origin;
        plane.project(Ned::new(
            x.north - o.north,
            x.east - o.east,
            x.down - o.down,
        ))
    }

    /// What is known of the air: the wind that the autopilot estimates, or else what the airspeed says of it along the flight.
    fn air(&self, now: f64, velocity: Inertial, plane: &VerticalPlane) -> Air<Inertial> {
        let fresh = |arrived: f64| now - arrived < OLD_WIND;
        if let Some(wind) = self.inbox.wind.filter(|w| fresh(w.arrived)) {
            return Air::Wind(plane.project(wind.value).0);
        }
        let airspeed = self.inbox.airspeed.filter(|a| fresh(a.arrived));
        match airspeed.map(|a| a.value).filter(|a| *a >= LEAST_AIRSPEED) {
            Some(airspeed) if velocity.forward() >= LEAST_AIRSPEED => {
                let level = airspeed * airspeed - velocity.down() * velocity.down();
                let along = velocity.forward() - level.max(0.0).sqrt();
                Air::Wind(Inertial::new(0.0, along))
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
    ) -> Option<Commanded> {
        let Some(told) = self.told(now, t) else {
            self.stage = Stage::Ended(End::Attitude);
            return None;
        };
        let Some(command) = pilot.answer(&told.input, dt) else {
            self.stage = Stage::Ended(End::Pilot);
            return None;
        };
        let (hold, attitude, motion) = (self.hold?, self.inbox.attitude?, self.inbox.motion?);
        let attitude = hold.plane().attitude(&attitude.value.0)?;
        let (x, v) = motion.value;
        let rates = hold.rates(&attitude, command.1, x, v);
        messages.push(self.set_point(now, rates, command.0));
        Some(Commanded { command, ..told })
    }

    /// What the pilot is told: the state when the command will act, by what is known of rates and acceleration. None if the attitude is
    /// none, or the nose points across the plane.
    fn told(&self, now: f64, t: f64) -> Option<Commanded> {
        let (hold, attitude, motion) = (self.hold?, self.inbox.attitude?, self.inbox.motion?);
        let plane = *hold.plane();
        let (q, rates) = attitude.value;
        let projected = plane.attitude(&q)?;
        let ahead = self.inbox.clock.latency() + HELD;
        let lead = |age: f64| (age + ahead).min(MOST_LEAD) as f32;
        let turning = lead(self.inbox.age_of(&attitude, now));
        let about_normal = std::iter::zip(projected.normal, rates).map(|(n, r)| n * r);
        let theta = projected.attitude.angle() + turning * about_normal.sum::<f32>();
        let moving = lead(self.inbox.age_of(&motion, now));
        let (x, v) = motion.value;
        let x = moved(x, v, moving);
        let v = moved(v, self.inbox.acceleration, moving);
        let t = t + ahead;
        let velocity = plane.project(v).0;
        let position = self.relative(x, &plane);
        let (reference, wanted, age) = self.reference(t, now, &plane);
        let air = self.air(now, velocity, &plane);
        Some(Commanded {
            t,
            input: PlanarInput {
                velocity,
                attitude: Attitude::from_angle(theta),
                state_age: self.inbox.age(now) as f32,
                air,
                specific_force: None,
                position_error: wanted.map(|wanted| position.0 - wanted),
                reference,
                reference_age: age as f32,
            },
            position,
            wind: match air {
                Air::Wind(wind) => wind,
                _ => Inertial::ZERO,
            },
            command: (0.0, 0.0),
        })
    }

    fn set_point(&self, now: f64, rates: [f32; 3], thrust: f32) -> MavMessage {
        let share = thrust / self.settings.weight * self.settings.hover_thrust;
        outbox::set_point(self.target(), now, rates, share)
    }

    /// The autopilot's system.
    fn target(&self) -> u8 {
        self.inbox
            .system
            .and_then(|id| id.try_into().ok())
            .unwrap_or(OWN_SYSTEM)
    }
}
