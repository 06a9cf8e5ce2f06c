//! A simulated autopilot, with PX4's rules of OFFBOARD.
//!
//! Until the first OFFBOARD the vehicle is held where it is. Out of OFFBOARD, later, it is given its hover thrust and no rotation: nobody
//! flies it.

use mavlink::dialects::common::{
    ATTITUDE_QUATERNION_DATA, AttitudeTargetTypemask, COMMAND_ACK_DATA, HEARTBEAT_DATA,
    HIGHRES_IMU_DATA, LOCAL_POSITION_NED_DATA, MavAutopilot, MavCmd, MavModeFlag, MavResult,
    MavState, MavType, TIMESYNC_DATA, VFR_HUD_DATA, WIND_COV_DATA,
};

use super::{HOLD, MavHeader, MavMessage, OFFBOARD, milliseconds};

/// State of a body; world vectors north-east-down, body axes those of hover.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyState {
    /// \[m\].
    pub position: [f64; 3],
    /// [m/s].
    pub velocity: [f64; 3],
    /// w x y z, from body to world.
    pub quaternion: [f64; 4],
    /// [rad/s].
    pub rates: [f64; 3],
    /// Specific force [m/s²] along body axes.
    pub specific_force: [f64; 3],
    /// Wind [m/s].
    pub wind: [f64; 3],
}

/// A vehicle with a rate loop.
pub trait Body {
    /// Lets `dt` \[s\] pass under thrust, as a share of the most, and body rates [rad/s].
    fn step(&mut self, thrust: f64, rates: [f64; 3], dt: f64);
    /// Its state.
    fn state(&self) -> BodyState;
    /// The share of the most thrust that holds its weight.
    fn hover(&self) -> f64;
}

/// Period \[s\] of attitude and position, of the air, and of the heartbeat.
const STATE: f64 = 0.02;
const AIR: f64 = 0.2;
const HEARTBEAT: f64 = 1.0;
/// PX4 calls set-points a stream if they come at 2 Hz at least, \[s\].
const STREAM: f64 = 0.5;
/// PX4's COM_OF_LOSS_T \[s\].
const LOSS: f64 = 1.0;
/// Largest body rate \[rad/s\] that is followed: PX4's MC_PITCHRATE_MAX of 220°/s.
const MOST_RATE: f64 = 3.84;

/// The autopilot around a body.
pub struct Autopilot<B> {
    body: B,
    mode: (u8, u8),
    flown: bool,
    /// Since when set-points come, when the last came \[s\], and what it says.
    stream: Option<(f64, f64)>,
    setpoint: (f64, [f64; 3]),
    answers: Vec<MavMessage>,
    next: [f64; 3],
    losses: u32,
}

impl<B: Body> Autopilot<B> {
    /// Header of its messages.
    pub const HEADER: MavHeader = MavHeader {
        system_id: 1,
        component_id: 1,
        sequence: 0,
    };

    /// An autopilot in hold.
    pub fn new(body: B) -> Self {
        let hover = body.hover();
        Self {
            body,
            mode: HOLD,
            flown: false,
            stream: None,
            setpoint: (hover, [0.0; 3]),
            answers: Vec::new(),
            next: [f64::NEG_INFINITY; 3],
            losses: 0,
        }
    }

    /// Its vehicle.
    pub fn body(&self) -> &B {
        &self.body
    }

    /// Main mode and sub-mode.
    pub fn mode(&self) -> (u8, u8) {
        self.mode
    }

    /// How often OFFBOARD was left because set-points ceased.
    pub fn losses(&self) -> u32 {
        self.losses
    }

    /// The pilot sets a mode by his transmitter.
    pub fn set_mode(&mut self, mode: (u8, u8)) {
        self.mode = mode;
        // The next heartbeat says so at once, as PX4's does.
        self.next[2] = f64::NEG_INFINITY;
    }

    /// Takes a message that arrived `now` \[s\].
    pub fn receive(&mut self, now: f64, message: &MavMessage) {
        match message {
            MavMessage::SET_ATTITUDE_TARGET(m) => {
                let rates = [m.body_roll_rate, m.body_pitch_rate, m.body_yaw_rate].map(f64::from);
                let sound = rates.iter().all(|r| r.is_finite()) && (0.0..=1.0).contains(&m.thrust);
                let only_rates = AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE;
                if !sound || m.type_mask != only_rates {
                    return;
                }
                let since = self.stream.filter(|(_, last)| now - last <= STREAM);
                self.stream = Some((since.map_or(now, |(since, _)| since), now));
                self.setpoint = (
                    m.thrust.into(),
                    rates.map(|r| r.clamp(-MOST_RATE, MOST_RATE)),
                );
            }
            MavMessage::COMMAND_LONG(m) if m.command == MavCmd::MAV_CMD_DO_SET_MODE => {
                let mode = (m.param2 as u8, m.param3 as u8);
                let streams = self
                    .stream
                    .is_some_and(|(since, last)| now - last <= STREAM && now - since >= STREAM);
                let accepted = m.param1 == 1.0 && (mode.0 != OFFBOARD || streams);
                if accepted {
                    self.set_mode(mode);
                }
                self.answers.push(MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
                    command: m.command,
                    result: match accepted {
                        true => MavResult::MAV_RESULT_ACCEPTED,
                        false => MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
                    },
                }));
            }
            MavMessage::TIMESYNC(m) if m.tc1 == 0 => {
                self.answers.push(MavMessage::TIMESYNC(TIMESYNC_DATA {
                    tc1: (now * 1e9) as i64,
                    ts1: m.ts1,
                }));
            }
            _ => {}
        }
    }

    /// Lets `dt` \[s\] pass from `now`.
    pub fn advance(&mut self, now: f64, dt: f64) {
        let last = self.stream.map_or(f64::NEG_INFINITY, |(_, last)| last);
        if self.mode.0 == OFFBOARD && now - last > LOSS {
            self.losses += 1;
            self.set_mode(HOLD);
        }
        self.flown |= self.mode.0 == OFFBOARD;
        let (thrust, rates) = match self.mode.0 == OFFBOARD {
            true => self.setpoint,
            false => (self.body.hover(), [0.0; 3]),
        };
        if self.flown {
            self.body.step(thrust, rates, dt);
        }
    }

    /// What it sends, `now` \[s\].
    pub fn send(&mut self, now: f64) -> Vec<MavMessage> {
        let mut messages = std::mem::take(&mut self.answers);
        let mut due = |which: usize, period: f64| {
            let next = &mut self.next[which];
            // A hair early, so that rounding does not shift it by a step.
            let due = now >= *next - 1e-6;
            if due {
                *next = if next.is_finite() {
                    *next + period
                } else {
                    now + period
                };
            }
            due
        };
        let (state, air, heartbeat) = (due(0, STATE), due(1, AIR), due(2, HEARTBEAT));
        let time_boot_ms = milliseconds(now);
        let body = self.body.state();
        let single = |v: [f64; 3]| v.map(|c| c as f32);
        if heartbeat {
            messages.push(MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                custom_mode: u32::from_le_bytes([0, 0, self.mode.0, self.mode.1]),
                mavtype: MavType::MAV_TYPE_VTOL_TAILSITTER_DUOROTOR,
                autopilot: MavAutopilot::MAV_AUTOPILOT_PX4,
                base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED
                    | MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED,
                system_status: MavState::MAV_STATE_ACTIVE,
                mavlink_version: 3,
            }));
        }
        if state {
            let [q1, q2, q3, q4] = body.quaternion.map(|c| c as f32);
            let [rollspeed, pitchspeed, yawspeed] = single(body.rates);
            messages.push(MavMessage::ATTITUDE_QUATERNION(ATTITUDE_QUATERNION_DATA {
                time_boot_ms,
                q1,
                q2,
                q3,
                q4,
                rollspeed,
                pitchspeed,
                yawspeed,
            }));
            let ([x, y, z], [vx, vy, vz]) = (single(body.position), single(body.velocity));
            messages.push(MavMessage::LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA {
                time_boot_ms,
                x,
                y,
                z,
                vx,
                vy,
                vz,
            }));
            let [xacc, yacc, zacc] = single(body.specific_force);
            messages.push(MavMessage::HIGHRES_IMU(HIGHRES_IMU_DATA {
                time_usec: (now * 1e6) as u64,
                xacc,
                yacc,
                zacc,
                ..HIGHRES_IMU_DATA::default()
            }));
        }
        if air {
            let [wind_x, wind_y, wind_z] = single(body.wind);
            messages.push(MavMessage::WIND_COV(WIND_COV_DATA {
                time_usec: (now * 1e6) as u64,
                wind_x,
                wind_y,
                wind_z,
                ..WIND_COV_DATA::default()
            }));
            let square: f64 = (0..3)
                .map(|i| (body.velocity[i] - body.wind[i]).powi(2))
                .sum();
            let ground = body.velocity[0].hypot(body.velocity[1]);
            messages.push(MavMessage::VFR_HUD(VFR_HUD_DATA {
                airspeed: square.sqrt() as f32,
                groundspeed: ground as f32,
                alt: -body.position[2] as f32,
                climb: -body.velocity[2] as f32,
                ..VFR_HUD_DATA::default()
            }));
        }
        messages
    }
}
