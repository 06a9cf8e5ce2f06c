//! PX4's rules of OFFBOARD, of the simulated autopilot: body rates, or attitudes, which it turns into rates as `AttitudeControl` does, but for the tilt
//! that goes before the turn about the tail.

use mavlink::dialects::ardupilotmega::{AttitudeTargetTypemask, SET_ATTITUDE_TARGET_DATA};

/// PX4 calls set-points a stream if they come at 2 Hz at least, \[s\].
const STREAM: f64 = 0.5;
/// PX4's COM_OF_LOSS_T \[s\].
const LOSS: f64 = 1.0;
/// PX4's MC_ROLL_P, MC_PITCH_P and MC_YAW_P as shipped [1/s].
const ATTITUDE: [f64; 3] = [4.0, 4.0, 2.8];
/// Largest body rate \[rad/s\] that is followed: PX4's MC_PITCHRATE_MAX of 220°/s.
const MOST_RATE: f64 = 3.84;

/// What is asked for beside the thrust.
#[derive(Clone, Copy, Debug)]
enum Turn {
    /// Body rates [rad/s].
    Rates([f64; 3]),
    /// The attitude w x y z, from body to world.
    Attitude([f64; 4]),
}

/// The stream of set-points.
#[derive(Clone, Copy, Debug)]
pub struct Offboard {
    /// Since when set-points come, when the last came \[s\], and what it says.
    stream: Option<(f64, f64)>,
    setpoint: (f64, Turn),
}

impl Default for Offboard {
    fn default() -> Self {
        Self {
            stream: None,
            setpoint: (0.0, Turn::Rates([0.0; 3])),
        }
    }
}

/// Body rates that turn an attitude into a wanted one: twice the vector of the quaternion between, along the shorter way, times the gains.
fn turning([w, x, y, z]: [f64; 4], [a, b, c, d]: [f64; 4]) -> [f64; 3] {
    let real = w * a + x * b + y * c + z * d;
    let vector = [
        w * b - x * a - y * d + z * c,
        w * c + x * d - y * a - z * b,
        w * d - x * c + y * b - z * a,
    ];
    let way = 2.0 * real.signum();
    std::array::from_fn(|i| way * ATTITUDE[i] * vector[i])
}

impl Offboard {
    /// Takes a set-point that arrived `now` \[s\].
    pub fn take(&mut self, now: f64, m: &SET_ATTITUDE_TARGET_DATA) {
        let attitude = m.q.map(f64::from);
        let rates = [m.body_roll_rate, m.body_pitch_rate, m.body_yaw_rate].map(f64::from);
        let only_rates = AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE;
        let only_attitude = AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
            | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
            | AttitudeTargetTypemask::ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE;
        let norm = attitude.iter().map(|c| c * c).sum::<f64>();
        let turn = if m.type_mask == only_rates && rates.iter().all(|r| r.is_finite()) {
            Turn::Rates(rates)
        } else if m.type_mask == only_attitude && (norm - 1.0).abs() < 0.1 {
            Turn::Attitude(attitude)
        } else {
            return;
        };
        if !(0.0..=1.0).contains(&m.thrust) {
            return;
        }
        let since = self.stream.filter(|(_, last)| now - last <= STREAM);
        self.stream = Some((since.map_or(now, |(since, _)| since), now));
        self.setpoint = (m.thrust.into(), turn);
    }

    /// Whether OFFBOARD is granted.
    pub fn streams(&self, now: f64) -> bool {
        self.stream
            .is_some_and(|(since, last)| now - last <= STREAM && now - since >= STREAM)
    }

    /// Whether it is asked for attitudes.
    pub fn is_by_attitude(&self) -> bool {
        matches!(self.setpoint, (_, Turn::Attitude(_)))
    }

    /// Share of the throttle, and rates [rad/s], of the last set-point, of a vehicle of this attitude; none if it is too old.
    pub fn command(&self, now: f64, attitude: [f64; 4]) -> Option<(f64, [f64; 3])> {
        let last = self.stream.map_or(f64::NEG_INFINITY, |(_, last)| last);
        let (thrust, turn) = self.setpoint;
        let rates = match turn {
            Turn::Rates(rates) => rates,
            Turn::Attitude(wanted) => turning(attitude, wanted),
        };
        let rates = rates.map(|r| r.clamp(-MOST_RATE, MOST_RATE));
        (now - last <= LOSS).then_some((thrust, rates))
    }
}
