//! Limits of the actuators: thrust, angular rate, and how fast the rate may change.

use super::status::Status;
use crate::error::{ParameterError, Problem, in_range, positive};
use crate::math;

/// Parameters of the limits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LimitParameters {
    /// Smallest thrust \[N\].
    pub thrust_min: f32,
    /// Largest thrust \[N\].
    pub thrust_max: f32,
    /// Largest angular rate [rad/s], in both directions.
    pub rate: f32,
    /// Largest change of the angular rate [rad/s²], in both directions.
    pub slew: f32,
}

/// The limits of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits {
    thrust_min: f32,
    thrust_max: f32,
    rate: f32,
    slew: f32,
}

/// What the limits remember.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LimitState {
    /// The last angular rate commanded [rad/s].
    pub rate: f32,
}

impl Limits {
    /// The limits with these parameters.
    ///
    /// # Errors
    /// `thrust_min` outside [−1e6, 1e6] N, `thrust_max` above 1e6 N or not above `thrust_min`, `rate` outside
    /// [1e-3, 1e3] rad/s, `slew` outside [1e-3, 1e6] rad/s²; or any not finite.
    pub fn new(p: LimitParameters) -> Result<Self, ParameterError> {
        let thrust_min = in_range("thrust_min", p.thrust_min, -1e6, 1e6)?;
        let thrust_max = in_range("thrust_max", p.thrust_max, -1e6, 1e6)?;
        if thrust_max <= thrust_min {
            return Err(ParameterError {
                parameter: "thrust_max",
                problem: Problem::OutOfRange,
            });
        }
        Ok(Self {
            thrust_min,
            thrust_max,
            rate: positive("rate", p.rate, 1e-3, 1e3)?,
            slew: positive("slew", p.slew, 1e-3, 1e6)?,
        })
    }

    /// `thrust` \[N\] and `rate` [rad/s] brought inside the limits after `dt` \[s\], and which limit was met.
    #[inline(always)]
    pub fn apply(
        &self,
        state: &mut LimitState,
        thrust: f32,
        rate: f32,
        dt: f32,
    ) -> (f32, f32, Status) {
        let bounded = math::clamp(rate, -self.rate, self.rate);
        let step = self.slew * dt;
        let slewed = math::clamp(bounded, state.rate - step, state.rate + step);
        state.rate = slewed;
        let status = Status::THRUST_LOW.when(thrust < self.thrust_min)
            | Status::THRUST_HIGH.when(thrust > self.thrust_max)
            | Status::RATE.when(bounded != rate)
            | Status::SLEW.when(slewed != bounded);
        (
            math::clamp(thrust, self.thrust_min, self.thrust_max),
            slewed,
            status,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: LimitParameters = LimitParameters {
        thrust_min: 1.0,
        thrust_max: 100.0,
        rate: 2.0,
        slew: 16.0,
    };

    #[test]
    fn what_is_inside_passes_unchanged() {
        let mut state = LimitState { rate: 0.4 };
        let out = Limits::new(GOOD)
            .unwrap()
            .apply(&mut state, 50.0, 0.5, 0.01);
        assert_eq!(out, (50.0, 0.5, Status::NONE));
        assert_eq!(state.rate, 0.5);
    }

    #[test]
    fn each_limit_is_kept_and_told() {
        let limits = Limits::new(GOOD).unwrap();
        let apply = |from, thrust, rate| {
            limits.apply(&mut LimitState { rate: from }, thrust, rate, 1.0 / 128.0)
        };
        assert_eq!(apply(0.0, 0.0, 0.0), (1.0, 0.0, Status::THRUST_LOW));
        assert_eq!(apply(0.0, 101.0, 0.0), (100.0, 0.0, Status::THRUST_HIGH));
        assert_eq!(apply(-1.95, 50.0, -9.0), (50.0, -2.0, Status::RATE));
        assert_eq!(apply(0.0, 50.0, 0.5), (50.0, 0.125, Status::SLEW));
        assert_eq!(
            apply(0.0, 50.0, -3.0),
            (50.0, -0.125, Status::RATE | Status::SLEW)
        );
    }

    #[test]
    fn bad_parameters_are_named() {
        let name = |p| Limits::new(p).unwrap_err().parameter;
        assert_eq!(
            name(LimitParameters {
                thrust_max: 1.0,
                ..GOOD
            }),
            "thrust_max"
        );
        assert_eq!(
            name(LimitParameters {
                thrust_min: f32::NAN,
                ..GOOD
            }),
            "thrust_min"
        );
        assert_eq!(name(LimitParameters { rate: 0.0, ..GOOD }), "rate");
        assert_eq!(name(LimitParameters { slew: -1.0, ..GOOD }), "slew");
    }
}
