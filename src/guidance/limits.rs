//! Limits of the actuators: thrust, angular rate, and how fast the rate may change.

use super::parameters::GuidanceParameters;
use super::status::Status;
use crate::aero::Aerodynamics;
use crate::math;
use crate::vehicle::Vehicle;

/// The limits of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits {
    thrust_min: f32,
    thrust_max: f32,
    rate: f32,
    slew: f32,
}

/// The last command inside the limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LimitState {
    /// The last angular rate commanded [rad/s].
    pub rate: f32,
    /// The last thrust commanded \[N\].
    pub thrust: f32,
}

impl Limits {
    /// The limits of `vehicle` and of these parameters, which have been checked.
    pub fn new<A: Aerodynamics>(p: &GuidanceParameters, vehicle: &Vehicle<A>) -> Self {
        Self {
            thrust_min: vehicle.thrust_min(),
            thrust_max: vehicle.thrust_max(),
            rate: p.max_rate,
            slew: p.max_slew,
        }
    }

    /// Whether the last rate and the last thrust are ones that these limits let pass. NaN is not.
    #[inline(always)]
    pub fn is_sound(&self, state: &LimitState) -> bool {
        state.rate.abs() <= self.rate && (self.thrust_min..=self.thrust_max).contains(&state.thrust)
    }

    /// The last command where none has been given yet: no rotation, and the thrust nearest to none.
    pub fn at_rest(&self) -> LimitState {
        LimitState {
            rate: 0.0,
            thrust: math::clamp(0.0, self.thrust_min, self.thrust_max),
        }
    }

    /// `thrust` \[N\] and `rate` [rad/s] brought inside the limits after `dt` \[s\], and what saturated.
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
        let bounded_thrust = math::clamp(thrust, self.thrust_min, self.thrust_max);
        *state = LimitState {
            rate: slewed,
            thrust: bounded_thrust,
        };
        let status = Status::THRUST_LOW.when(thrust < self.thrust_min)
            | Status::THRUST_HIGH.when(thrust > self.thrust_max)
            | Status::RATE.when(bounded != rate)
            | Status::SLEW.when(slewed != bounded);
        (bounded_thrust, slewed, status)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{LargeAngle, LargeAngleParameters};
    use crate::vehicle::VehicleParameters;

    fn limits() -> Limits {
        let vehicle = VehicleParameters {
            thrust_min: 1.0,
            thrust_max: 100.0,
            ..VehicleParameters::PAPER
        };
        let model = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        let p = GuidanceParameters {
            max_rate: 2.0,
            max_slew: 16.0,
            ..GuidanceParameters::default()
        };
        Limits::new(&p, &Vehicle::new(vehicle, model).unwrap())
    }

    fn last(rate: f32) -> LimitState {
        LimitState { rate, thrust: 1.0 }
    }

    #[test]
    fn what_is_inside_passes_unchanged() {
        let mut state = last(0.4);
        let out = limits().apply(&mut state, 50.0, 0.5, 0.01);
        assert_eq!(out, (50.0, 0.5, Status::empty()));
        assert_eq!((state.rate, state.thrust), (0.5, 50.0));
    }

    #[test]
    fn each_limit_is_kept_and_told() {
        let apply = |from, thrust, rate| limits().apply(&mut last(from), thrust, rate, 1.0 / 128.0);
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
    fn a_last_command_that_the_limits_do_not_let_pass_is_not_sound() {
        let limits = limits();
        assert!(limits.is_sound(&limits.at_rest()) && limits.is_sound(&last(-2.0)));
        for bad in [f32::NAN, f32::INFINITY, 2.1, -1e30] {
            assert!(!limits.is_sound(&last(bad)));
        }
        for thrust in [f32::NAN, 0.9, 1e30] {
            assert!(!limits.is_sound(&LimitState { rate: 0.0, thrust }));
        }
    }
}
