//! From a policy's setpoint to the command: attitude P, and the same limits as the guidance's.

use serde::Deserialize;

use super::{Phase, Setpoint};
use crate::controllers::{Answer, Report};
use crate::experiment::table::ordered;
use crate::experiment::{Experiment, FieldError, positive};
use crate::reference::wrap;

/// `[….limits]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitSpec {
    /// Least and most thrust \[N\]; what the motors give if left out.
    pub thrust_n: Option<[f64; 2]>,
    /// Largest rate \[rad/s\].
    pub rate_rad_s: f64,
    /// Largest change of the rate \[rad/s²\].
    pub slew_rad_s2: f64,
}

impl Default for LimitSpec {
    fn default() -> Self {
        Self {
            thrust_n: None,
            rate_rad_s: 2.8,
            slew_rad_s2: 30.0,
        }
    }
}

impl LimitSpec {
    /// Least and most thrust \[N\] in `experiment`.
    pub fn thrust(&self, experiment: &Experiment) -> [f64; 2] {
        experiment.thrust_limits(self.thrust_n, experiment.weight())
    }
}

/// The last stage of a policy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    thrust_limits: [f64; 2],
    limits: LimitSpec,
    /// Thrust commanded last \[N\].
    thrust: f32,
    /// Rate commanded last \[rad/s\].
    rate: f32,
}

impl Output {
    /// The stage with these limits, at `thrust` \[N\] (least, most).
    pub fn new(limits: &LimitSpec, thrust: [f64; 2]) -> Result<Self, FieldError> {
        ordered("limits.thrust_n", thrust)?;
        positive("limits.rate_rad_s", limits.rate_rad_s)?;
        positive("limits.slew_rad_s2", limits.slew_rad_s2)?;
        Ok(Self {
            thrust_limits: thrust,
            limits: *limits,
            thrust: 0.0,
            rate: 0.0,
        })
    }

    /// Thrust commanded last \[N\].
    pub fn thrust(&self) -> f64 {
        self.thrust.into()
    }

    /// The command that turns the vehicle at `theta` \[rad\] to the setpoint.
    pub fn answer(&mut self, setpoint: Setpoint, theta: f64, phase: Phase, dt: f64) -> Answer {
        let [least, most] = self.thrust_limits;
        let (limit, step) = (self.limits.rate_rad_s, self.limits.slew_rad_s2 * dt);
        let rate = setpoint.gain * wrap(setpoint.theta - theta);
        let last = f64::from(self.rate);
        self.rate = rate.clamp(-limit, limit).clamp(last - step, last + step) as f32;
        self.thrust = setpoint.thrust.clamp(least, most) as f32;
        self.again(phase)
    }

    /// The last command again: velocity, attitude or reference was not finite.
    pub fn again(&self, phase: Phase) -> Answer {
        Answer {
            thrust: self.thrust,
            rate: self.rate,
            report: Report::Switching(phase),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_the_attitude_error_times_the_gain_within_the_limits() {
        let setpoint = |theta| Setpoint {
            theta,
            gain: 2.0,
            thrust: 250.0,
        };
        let mut output = Output::new(&LimitSpec::default(), [0.0, 196.2]).unwrap();
        let answer = output.answer(setpoint(0.1), 0.0, Phase::Hover, 0.1);
        assert!((answer.rate - 0.2).abs() < 1e-6);
        assert!((answer.thrust - 196.2).abs() < 1e-4);
        // Through ±180° the short way: from 170° to −170° is +20°.
        let (from, to) = (170_f64.to_radians(), (-170_f64).to_radians());
        let answer = output.answer(setpoint(to), from, Phase::Hover, 1.0);
        assert!((answer.rate - 40_f32.to_radians()).abs() < 1e-6);
        let answer = output.answer(setpoint(-1.5), 1.0, Phase::Hover, 0.01);
        assert!((answer.rate - (40_f32.to_radians() - 0.3)).abs() < 1e-6);
        assert_eq!(output.again(Phase::Hover).rate, answer.rate);
    }
}
