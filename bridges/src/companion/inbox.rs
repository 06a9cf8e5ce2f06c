//! What the autopilot last said.

use alula::ned::{Ned, Quaternion};

use mavlink::dialects::ardupilotmega::{
    MavAutopilot, MavCmd, MavLandedState, MavModeFlag, MavResult,
};

use super::clock::{Clock, Order};
use super::setpoint::{Setpoint, setpoint};
use super::{Kind, MavHeader, MavMessage, milliseconds};

/// What came.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Messages that were used.
    pub used: u64,
    /// Messages that came twice or after a later one of their kind, or were not of numbers, and were dropped.
    pub dropped: u64,
    /// Messages of others, or that say nothing of use here.
    pub ignored: u64,
}

/// A value with the autopilot's time stamp \[ms\] and the time of its arrival \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped<T> {
    /// The value.
    pub value: T,
    stamp: u32,
    /// When it arrived \[s\].
    pub arrived: f64,
}

/// The newest of each kind of message.
#[derive(Clone, Debug, Default)]
pub struct Inbox {
    /// System that is listened to: that of the first autopilot's heartbeat.
    pub system: Option<u32>,
    /// The kind of autopilot that is listened to.
    kind: Kind,
    /// Its mode.
    pub mode: Option<u32>,
    /// Whether it is armed.
    pub armed: bool,
    /// Whether it says that it flies.
    pub in_air: bool,
    /// The mode that was asked for and is awaited.
    pub awaited: Option<u32>,
    order: Order,
    /// Place of the last heartbeat in the order of sending.
    heartbeat: i64,
    /// When the last heartbeat came \[s\].
    pub heard: f64,
    /// Attitude and body rates [rad/s], in the axes of hover.
    pub attitude: Option<Stamped<(Quaternion, [f32; 3])>>,
    /// Position \[m\] and velocity [m/s].
    pub motion: Option<Stamped<(Ned, Ned)>>,
    /// Acceleration over the last few motions [m/s²].
    pub acceleration: Ned,
    /// Angular acceleration over the last few attitudes [rad/s²], in the axes of hover.
    pub angular_acceleration: [f32; 3],
    /// The autopilot's clock.
    pub clock: Clock,
    /// Specific force [m/s²] along hover's axes.
    pub specific_force: Option<Stamped<[f32; 3]>>,
    /// The place of its position's origin: latitude and longitude \[°\], altitude over the sea \[m\].
    pub global_origin: Option<[f64; 3]>,
    /// Wind over ground [m/s].
    pub wind: Option<Stamped<Ned>>,
    /// Airspeed [m/s].
    pub airspeed: Option<Stamped<f32>>,
    /// What is asked for over the link.
    pub setpoint: Option<Stamped<Setpoint>>,
    /// What came.
    pub counts: Counts,
}

/// The component that an autopilot is. Others, as cameras, have heartbeats and numbers of their own.
const AUTOPILOT: u8 = 1;

/// Whether a message is the heartbeat of an autopilot. A ground station's says that it is none.
pub fn is_beat(header: &MavHeader, message: &MavMessage) -> bool {
    header.component_id == AUTOPILOT
        && matches!(message, MavMessage::HEARTBEAT(m) if m.autopilot != MavAutopilot::MAV_AUTOPILOT_INVALID)
}

/// Time constants \[s\] of the filters of accelerations and of angular accelerations.
const FILTER: f32 = 0.1;
const ANGULAR_FILTER: f32 = 0.02;

/// Time \[s\] without a message of a kind after which a time stamp that went back is that of an autopilot started anew. Before that it is that of a
/// message that was late.
const SILENCE: f64 = 1.0;

/// Whether a message may bear the time stamp of the one before it.
#[derive(Clone, Copy, PartialEq)]
enum Repeats {
    /// One that does came twice, or is of an estimator that stands still.
    Dropped,
    /// Stamps of arrival, and those of senders that leave theirs at 0.
    Taken,
}

/// Puts a value into its place unless it is not sound, or late.
fn put<T>(
    place: &mut Option<Stamped<T>>,
    value: T,
    stamp: u32,
    now: f64,
    sound: bool,
    repeats: Repeats,
) -> bool {
    let late = place.as_ref().is_some_and(|old| {
        let ahead = stamp.wrapping_sub(old.stamp) as i32;
        let repeated = ahead == 0 && repeats == Repeats::Dropped;
        repeated || (ahead < 0 && now - old.arrived <= SILENCE)
    });
    let takes = sound && !late;
    if takes {
        *place = Some(Stamped {
            value,
            stamp,
            arrived: now,
        });
    }
    takes
}

/// The rate of change of what was `old`, with the step from one value with its time stamp to the next, filtered.
fn differences(
    old: [f32; 3],
    from: Option<([f32; 3], u32)>,
    (to, stamp): ([f32; 3], u32),
    filter: f32,
) -> [f32; 3] {
    let Some((from, since)) = from else {
        return [0.0; 3];
    };
    let dt = stamp.wrapping_sub(since) as f32 * 1e-3;
    if !(1e-3..0.5).contains(&dt) {
        return [0.0; 3];
    }
    let share = dt / (dt + filter);
    std::array::from_fn(|k| old[k] + share * ((to[k] - from[k]) / dt - old[k]))
}

fn finite(values: &[f32]) -> bool {
    values.iter().all(|v| v.is_finite())
}

impl Inbox {
    /// An empty one, for an autopilot of this kind.
    #[must_use]
    pub fn new(kind: Kind) -> Self {
        Self {
            kind,
            ..Self::default()
        }
    }

    /// Takes a message that arrived `now` \[s\].
    pub fn take(&mut self, now: f64, header: &MavHeader, message: &MavMessage) {
        if self.system.is_none() && is_beat(header, message) {
            self.system = Some(header.system_id);
        }
        let from_it = header.component_id == AUTOPILOT && self.system == Some(header.system_id);
        let place = match from_it {
            true => self.order.place(now, header.sequence),
            false => 0,
        };
        let used = match message {
            // From a ground station: to the autopilot's system or to the companion's own, which may be another.
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(m) => {
                let own = self.kind.own_system().into();
                let asked = setpoint(m, &[own, self.system.unwrap_or(own)]);
                asked.is_some_and(|asked| {
                    let place = &mut self.setpoint;
                    let sound = asked.is_finite();
                    put(place, asked, m.time_boot_ms, now, sound, Repeats::Taken)
                })
            }
            _ if !from_it => {
                self.counts.ignored += 1;
                return;
            }
            MavMessage::HEARTBEAT(m) => {
                let newer = self.mode.is_none() || place > self.heartbeat;
                if newer {
                    self.heard = now;
                    (self.mode, self.heartbeat) = (Some(m.custom_mode), place);
                    self.armed = m
                        .base_mode
                        .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED);
                }
                newer
            }
            // The one mode that is asked for while it is awaited. Its heartbeat may be lost, and the next one is a second away.
            MavMessage::COMMAND_ACK(m)
                if m.command == MavCmd::MAV_CMD_DO_SET_MODE
                    && m.result == MavResult::MAV_RESULT_ACCEPTED =>
            {
                let newer = place > self.heartbeat;
                let asked = self.awaited.filter(|_| newer);
                if asked.is_some() {
                    (self.mode, self.heartbeat) = (asked, place);
                }
                asked.is_some()
            }
            MavMessage::ATTITUDE_QUATERNION(m) => {
                let q = Quaternion {
                    w: m.q1,
                    x: m.q2,
                    y: m.q3,
                    z: m.q4,
                };
                let rates = self.kind.hover([m.rollspeed, m.pitchspeed, m.yawspeed]);
                let sound = finite(&[q.w, q.x, q.y, q.z]) && finite(&rates);
                let q = self.kind.hover_attitude(q);
                let (last, stamp) = (self.attitude, m.time_boot_ms);
                let place = &mut self.attitude;
                let takes = put(place, (q, rates), stamp, now, sound, Repeats::Dropped);
                if takes {
                    let from = last.map(|last| (last.value.1, last.stamp));
                    let old = self.angular_acceleration;
                    self.angular_acceleration =
                        differences(old, from, (rates, stamp), ANGULAR_FILTER);
                }
                takes
            }
            MavMessage::LOCAL_POSITION_NED(m) => {
                let motion = (Ned::new(m.x, m.y, m.z), Ned::new(m.vx, m.vy, m.vz));
                let sound = finite(&[m.x, m.y, m.z, m.vx, m.vy, m.vz]);
                let last = self.motion;
                let stamp = m.time_boot_ms;
                let place = &mut self.motion;
                let takes = put(place, motion, stamp, now, sound, Repeats::Dropped);
                if takes {
                    // Started anew, its clock is another one.
                    if last.is_some_and(|last| (stamp.wrapping_sub(last.stamp) as i32) < 0) {
                        self.clock = Clock::default();
                    }
                    let parts = |v: Ned| [v.north, v.east, v.down];
                    let from = last.map(|last| (parts(last.value.1), last.stamp));
                    let old = parts(self.acceleration);
                    let [n, e, d] = differences(old, from, ([m.vx, m.vy, m.vz], stamp), FILTER);
                    self.acceleration = Ned::new(n, e, d);
                }
                takes
            }
            MavMessage::GPS_GLOBAL_ORIGIN(m) => {
                self.global_origin = Some([
                    f64::from(m.latitude) * 1e-7,
                    f64::from(m.longitude) * 1e-7,
                    f64::from(m.altitude) * 1e-3,
                ]);
                true
            }
            MavMessage::EXTENDED_SYS_STATE(m) => {
                self.in_air = m.landed_state == MavLandedState::MAV_LANDED_STATE_IN_AIR;
                true
            }
            // An answer to a request of this side.
            MavMessage::TIMESYNC(m) if m.tc1 != 0 => self.clock.take(now, m.ts1, m.tc1),
            MavMessage::WIND_COV(m) => {
                let wind = Ned::new(m.wind_x, m.wind_y, m.wind_z);
                let stamp = (m.time_usec / 1000) as u32;
                put(
                    &mut self.wind,
                    wind,
                    stamp,
                    now,
                    finite(&[m.wind_x, m.wind_y, m.wind_z]),
                    Repeats::Dropped,
                )
            }
            // ArduPlane's: where it comes from, and its downward part.
            MavMessage::WIND(m) => {
                let (sin, cos) = m.direction.to_radians().sin_cos();
                let level = (m.speed * m.speed - m.speed_z * m.speed_z).max(0.0).sqrt();
                let wind = Ned::new(-level * cos, -level * sin, m.speed_z);
                let sound = finite(&[m.direction, m.speed, m.speed_z]);
                // It has no time stamp: the order of arrival stands for it.
                let stamp = milliseconds(now);
                put(&mut self.wind, wind, stamp, now, sound, Repeats::Taken)
            }
            MavMessage::HIGHRES_IMU(m) => {
                let force = self.kind.hover([m.xacc, m.yacc, m.zacc]);
                let stamp = (m.time_usec / 1000) as u32;
                let place = &mut self.specific_force;
                put(place, force, stamp, now, finite(&force), Repeats::Dropped)
            }
            MavMessage::VFR_HUD(m) => {
                // It has no time stamp: the order of arrival stands for it.
                put(
                    &mut self.airspeed,
                    m.airspeed,
                    milliseconds(now),
                    now,
                    m.airspeed.is_finite(),
                    Repeats::Taken,
                )
            }
            _ => {
                self.counts.ignored += 1;
                return;
            }
        };
        match used {
            true => self.counts.used += 1,
            false => self.counts.dropped += 1,
        }
    }

    /// How old a value is \[s\], by the autopilot's clock if that is known, else by its arrival.
    #[must_use]
    pub fn age_of<T>(&self, value: &Stamped<T>, now: f64) -> f64 {
        self.age_at(now, value.arrived, value.stamp)
    }

    fn age_at(&self, now: f64, arrived: f64, stamp: u32) -> f64 {
        let arrived = now - arrived;
        match self.clock.ahead() {
            Some(offset) => {
                let behind = milliseconds(now + offset).wrapping_sub(stamp) as i32;
                (f64::from(behind) * 1e-3).max(arrived)
            }
            None => arrived,
        }
    }

    /// Time since the older of attitude and motion arrived \[s\]; infinite before both are there.
    #[must_use]
    pub fn age(&self, now: f64) -> f64 {
        self.older(|arrived, _| now - arrived)
    }

    /// How old the state is \[s\] by the autopilot's clock too: a link that lets messages queue up brings old ones that have just arrived.
    #[must_use]
    pub fn age_by_clock(&self, now: f64) -> f64 {
        self.older(|arrived, stamp| self.age_at(now, arrived, stamp))
    }

    /// The greater of the ages of attitude and motion, by `age` of arrival and stamp; infinite before both are there.
    fn older(&self, age: impl Fn(f64, u32) -> f64) -> f64 {
        match (&self.attitude, &self.motion) {
            (Some(q), Some(x)) => age(q.arrived, q.stamp).max(age(x.arrived, x.stamp)),
            _ => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::ardupilotmega::{
        ATTITUDE_QUATERNION_DATA, HEARTBEAT_DATA, LOCAL_POSITION_NED_DATA, TIMESYNC_DATA,
    };

    /// A ground station may be component 1 of its system: its heartbeat says that it is no autopilot.
    #[test]
    fn a_ground_station_is_not_the_autopilot() {
        let mut inbox = Inbox::default();
        let station = MavHeader {
            system_id: 255,
            ..FROM
        };
        let none = HEARTBEAT_DATA {
            autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
            ..HEARTBEAT_DATA::default()
        };
        inbox.take(0.0, &station, &MavMessage::HEARTBEAT(none));
        assert_eq!(inbox.system, None);
        inbox.take(
            0.1,
            &FROM,
            &MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()),
        );
        assert_eq!(inbox.system, Some(1));
    }

    const FROM: MavHeader = MavHeader {
        system_id: 1,
        component_id: 1,
        sequence: 0,
    };

    fn motion(stamp: u32, x: f32) -> MavMessage {
        MavMessage::LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA {
            time_boot_ms: stamp,
            x,
            ..LOCAL_POSITION_NED_DATA::default()
        })
    }

    #[test]
    fn late_messages_damaged_ones_and_strangers_are_dropped() {
        let mut inbox = Inbox::default();
        inbox.take(0.0, &FROM, &motion(100, 1.0));
        assert_eq!((inbox.motion, inbox.counts.ignored), (None, 1));
        inbox.take(
            0.1,
            &FROM,
            &MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()),
        );
        let mut x = |now, from: &MavHeader, message| {
            inbox.take(now, from, &message);
            inbox.motion.map(|m| (m.value.0.north, m.arrived))
        };
        assert_eq!(x(0.2, &FROM, motion(200, 2.0)), Some((2.0, 0.2)));
        assert_eq!(x(0.3, &FROM, motion(180, 3.0)), Some((2.0, 0.2)));
        assert_eq!(x(0.3, &FROM, motion(220, f32::NAN)), Some((2.0, 0.2)));
        let stranger = MavHeader {
            system_id: 2,
            ..FROM
        };
        assert_eq!(x(0.3, &stranger, motion(300, 4.0)), Some((2.0, 0.2)));
        // Started anew.
        assert_eq!(x(9.0, &FROM, motion(5000, 5.0)), Some((5.0, 9.0)));
        assert_eq!(x(10.5, &FROM, motion(10, 6.0)), Some((6.0, 10.5)));
        // Far behind is late all the same while others come, and one that comes twice is no new state.
        assert_eq!(x(10.6, &FROM, motion(2010, 7.0)), Some((7.0, 10.6)));
        assert_eq!(x(10.7, &FROM, motion(510, 8.0)), Some((7.0, 10.6)));
        assert_eq!(x(10.8, &FROM, motion(2010, 9.0)), Some((7.0, 10.6)));
        assert_eq!((inbox.counts.used, inbox.counts.dropped), (5, 4));
        assert_eq!(inbox.age(11.0), f64::INFINITY);
        let attitude = ATTITUDE_QUATERNION_DATA::default();
        inbox.take(10.75, &FROM, &MavMessage::ATTITUDE_QUATERNION(attitude));
        assert_eq!(inbox.age(11.1), 0.5);
    }

    /// The autopilot's clock is 100 s ahead, and messages take 20 ms.
    #[test]
    fn ages_are_by_the_autopilots_clock() {
        let mut inbox = Inbox::default();
        inbox.take(
            0.0,
            &FROM,
            &MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()),
        );
        let answer = |ours: f64, theirs: f64| {
            MavMessage::TIMESYNC(TIMESYNC_DATA {
                ts1: (ours * 1e9) as i64,
                tc1: (theirs * 1e9) as i64,
            })
        };
        inbox.take(1.04, &FROM, &answer(1.0, 101.02));
        // A slower one does not count, nor one of the future.
        inbox.take(2.3, &FROM, &answer(2.0, 102.02));
        inbox.take(3.0, &FROM, &answer(5.0, 105.0));
        assert!((inbox.clock.latency() - 0.02).abs() < 1e-9);
        inbox.take(4.02, &FROM, &motion(104_000, 1.0));
        let age = inbox.age_of(&inbox.motion.unwrap(), 4.05);
        // A millisecond: the resolution of the stamps.
        assert!((age - 0.05).abs() < 1.1e-3, "{age}");
        // Started anew, its clock is another one.
        inbox.take(9.0, &FROM, &motion(10, 1.0));
        assert_eq!(inbox.age_of(&inbox.motion.unwrap(), 9.5), 0.5);
    }

    #[test]
    fn the_acceleration_is_that_of_the_velocities() {
        let mut inbox = Inbox::default();
        inbox.take(
            0.0,
            &FROM,
            &MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()),
        );
        for n in 0..50_u32 {
            let message = LOCAL_POSITION_NED_DATA {
                time_boot_ms: 20 * n,
                vx: 0.02 * 3.0 * n as f32,
                ..LOCAL_POSITION_NED_DATA::default()
            };
            inbox.take(0.0, &FROM, &MavMessage::LOCAL_POSITION_NED(message));
        }
        assert!((inbox.acceleration.north - 3.0).abs() < 1e-3);
    }

    /// An answer that a mode is accepted stands for the heartbeat that says so, unless a later heartbeat came before it or nothing is awaited.
    #[test]
    fn an_accepted_mode_is_the_mode_until_a_later_heartbeat() {
        use mavlink::dialects::ardupilotmega::COMMAND_ACK_DATA;
        let mut inbox = Inbox::default();
        let mut mode = |sequence: u8, message: &MavMessage, awaited: Option<u32>| {
            inbox.awaited = awaited;
            inbox.take(0.0, &MavHeader { sequence, ..FROM }, message);
            inbox.mode
        };
        let heartbeat = |custom_mode: u32| {
            MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                custom_mode,
                ..HEARTBEAT_DATA::default()
            })
        };
        let accepted = MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
            command: MavCmd::MAV_CMD_DO_SET_MODE,
            result: MavResult::MAV_RESULT_ACCEPTED,
        });
        assert_eq!(mode(10, &heartbeat(4), None), Some(4));
        assert_eq!(mode(11, &accepted, None), Some(4), "nothing is awaited");
        assert_eq!(mode(12, &accepted, Some(6)), Some(6));
        assert_eq!(mode(14, &heartbeat(2), Some(6)), Some(2));
        assert_eq!(mode(13, &accepted, Some(6)), Some(2), "overtaken");
    }

    /// A heartbeat has no time stamp. One that was overtaken does not set the mode back, over the turn of the numbers too.
    #[test]
    fn the_mode_is_that_of_the_heartbeat_sent_last() {
        let mut inbox = Inbox::default();
        let mut mode = |now: f64, sequence: u8, main: u8| {
            let header = MavHeader { sequence, ..FROM };
            let message = HEARTBEAT_DATA {
                custom_mode: u32::from(main) << 16,
                ..HEARTBEAT_DATA::default()
            };
            inbox.take(now, &header, &MavMessage::HEARTBEAT(message));
            inbox.mode.unwrap() >> 16
        };
        assert_eq!(mode(0.0, 250, 4), 4);
        assert_eq!(mode(0.1, 3, 6), 6);
        assert_eq!(mode(0.2, 254, 4), 6);
        assert_eq!(mode(0.3, 90, 2), 2);
        // After a silence the number may be any.
        assert_eq!(mode(1.5, 80, 6), 6);
    }
}
