//! PX4's rules of OFFBOARD, of the simulated autopilot.

use mavlink::dialects::ardupilotmega::{AttitudeTargetTypemask, SET_ATTITUDE_TARGET_DATA};

/// PX4 calls set-points a stream if they come at 2 Hz at least, \[s\].
const STREAM: f64 = 0.5;
/// PX4's COM_OF_LOSS_T \[s\].
const LOSS: f64 = 1.0;
/// Largest body rate \[rad/s\] that is followed: PX4's MC_PITCHRATE_MAX of 220°/s.
const MOST_RATE: f64 = 3.84;

/// The stream of set-points.
#[derive(Clone, Copy, Debug, Default)]
pub struct Offboard {
    /// Since when set-points come, when the last came \[s\], and what it says.
    stream: Option<(f64, f64)>,
    setpoint: (f64, [f64; 3]),
}

impl Offboard {
    /// Takes a set-point that arrived `now` \[s\].
    pub fn take(&mut self, now: f64, m: &SET_ATTITUDE_TARGET_DATA) {
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

    /// Whether OFFBOARD is granted.
    pub fn streams(&self, now: f64) -> bool {
        self.stream
            .is_some_and(|(since, last)| now - last <= STREAM && now - since >= STREAM)
    }

    /// Share of the throttle, and rates [rad/s], of the last set-point; none if it is too old.
    pub fn command(&self, now: f64) -> Option<(f64, [f64; 3])> {
        let last = self.stream.map_or(f64::NEG_INFINITY, |(_, last)| last);
        (now - last <= LOSS).then_some(self.setpoint)
    }
}
