//! From a policy's setpoint to the command: attitude P, and the limits of the guidance.

use alula::control::{LimitParameters, LimitState, Limits};

use super::{Phase, Setpoint};
use crate::mission::{Answer, LimitSpec, Report};
use crate::reference::wrap;
use crate::scenario::FieldError;

/// The last stage of a baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    limits: Limits,
    state: LimitState,
    /// Thrust commanded last \[N\].
    thrust: f64,
}

impl Output {
    /// The stage with these limits; `table` is where they stand.
    pub(super) fn new(spec: &LimitSpec, table: &str) -> Result<Self, FieldError> {
        let limits = Limits::new(LimitParameters {
            thrust_min: spec.thrust_n[0] as f32,
            thrust_max: spec.thrust_n[1] as f32,
            rate: spec.rate_rad_s as f32,
            slew: spec.slew_rad_s2 as f32,
        });
        Ok(Self {
            limits: limits.map_err(|e| FieldError::new(table, e.to_string()))?,
            state: LimitState::default(),
            thrust: 0.0,
        })
    }

    /// Thrust commanded last \[N\].
    pub(super) fn thrust(&self) -> f64 {
        self.thrust
    }

    /// The command that turns the vehicle at `theta` \[rad\] to the setpoint.
    pub(super) fn answer(
        &mut self,
        setpoint: Setpoint,
        theta: f64,
        phase: Phase,
        dt: f64,
    ) -> Answer {
        let rate = setpoint.gain * wrap(setpoint.theta - theta);
        let (thrust, rate, _) = self.limits.apply(
            &mut self.state,
            setpoint.thrust as f32,
            rate as f32,
            dt as f32,
        );
        self.thrust = thrust.into();
        Answer {
            thrust: self.thrust,
            rate: rate.into(),
            report: Report::Switching(phase),
        }
    }

    /// The last command again: the input was no number.
    pub(super) fn again(&self, phase: Phase) -> Answer {
        Answer {
            thrust: self.thrust,
            rate: self.state.rate.into(),
            report: Report::Switching(phase),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) const LIMITS: LimitSpec = LimitSpec {
        thrust_n: [0.0, 196.2],
        rate_rad_s: 2.8,
        slew_rad_s2: 30.0,
    };

    #[test]
    fn the_rate_is_the_attitude_error_times_the_gain_within_the_limits() {
        let setpoint = |theta| Setpoint {
            theta,
            gain: 2.0,
            thrust: 250.0,
        };
        let mut output = Output::new(&LIMITS, "limits").unwrap();
        let answer = output.answer(setpoint(0.1), 0.0, Phase::Hover, 0.1);
        assert!((answer.rate - 0.2).abs() < 1e-6);
        assert!((answer.thrust - 196.2).abs() < 1e-4);
        // Through ±180° the short way: from 170° to −170° is +20°.
        let (from, to) = (170_f64.to_radians(), (-170_f64).to_radians());
        let answer = output.answer(setpoint(to), from, Phase::Hover, 1.0);
        assert!((answer.rate - 40_f64.to_radians()).abs() < 1e-6);
        let answer = output.answer(setpoint(-1.5), 1.0, Phase::Hover, 0.01);
        assert!((answer.rate - (40_f64.to_radians() - 0.3)).abs() < 1e-6);
        assert_eq!(output.again(Phase::Hover).rate, answer.rate);
    }
}
