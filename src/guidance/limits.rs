//! Limits of the actuators: thrust, angular rate, and how fast the rate may change.

use super::memory::memory;
use super::parameters::GuidanceParameters;
use super::status::Status;
use crate::aero::Aerodynamics;
use crate::math;
use crate::propeller::Propeller;
use crate::spatial::Body;
use crate::vehicle::Vehicle;

/// The limits of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Limits {
    thrust_min: f32,
    thrust_max: f32,
    rate: f32,
    slew: f32,
    propeller: Propeller,
}

/// The last command inside the limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct LimitState {
    /// The last body rates commanded [rad/s].
    pub rates: Body,
    /// The last thrust commanded \[N\].
    pub thrust: f32,
}

memory!(LimitState {
    rates: Body,
    thrust: f32,
});
memory!(Body {
    i: f32,
    j: f32,
    w: f32,
});

/// A command inside the limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LimitedCommand {
    /// Thrust \[N\].
    pub thrust: f32,
    /// Body rates [rad/s].
    pub rates: Body,
    /// Which limits it was brought to.
    pub saturated: Status,
}

impl Limits {
    /// The limits of `vehicle` and of these parameters, which have been checked.
    pub fn new<A: Aerodynamics>(p: &GuidanceParameters, vehicle: &Vehicle<A>) -> Self {
        Self {
            thrust_min: vehicle.thrust_min(),
            thrust_max: vehicle.thrust_max(),
            rate: p.max_rate,
            slew: p.max_slew,
            propeller: *vehicle.propeller(),
        }
    }

    /// Whether the last rates and the last thrust are ones that these limits let pass. NaN is not.
    #[inline(always)]
    pub fn is_sound(&self, state: &LimitState) -> bool {
        let Body { i, j, w } = state.rates;
        i.abs() <= self.rate
            && j.abs() <= self.rate
            && w.abs() <= self.rate
            && (self.thrust_min..=self.thrust_max).contains(&state.thrust)
    }

    /// The last command where none has been given yet: no rotation, and the thrust nearest to none.
    pub fn at_rest(&self) -> LimitState {
        LimitState {
            rates: Body::default(),
            thrust: math::clamp(0.0, self.thrust_min, self.thrust_max),
        }
    }

    /// A finite command brought inside the limits.
    pub fn within(&self, command: LimitState) -> LimitState {
        let limited = |rate: f32| math::clamp(rate, -self.rate, self.rate);
        let Body { i, j, w } = command.rates;
        LimitState {
            rates: Body::new(limited(i), limited(j), limited(w)),
            thrust: math::clamp(command.thrust, self.thrust_min, self.thrust_max),
        }
    }

    /// The last pitch rate [rad/s] if it stands at its limit, else zero.
    #[inline(always)]
    pub fn pitch_at_limit(&self, state: &LimitState) -> f32 {
        if state.rates.w.abs() >= self.rate {
            state.rates.w
        } else {
            0.0
        }
    }

    /// `thrust` \[N\], no less than `least`, at an airspeed `along` the nose [m/s], and body `rates` [rad/s] brought inside the limits after `dt` \[s\].
    /// The memory keeps the static thrust to command for it.
    #[inline(always)]
    pub(super) fn apply(
        &self,
        state: &mut LimitState,
        [least, thrust]: [f32; 2],
        along: f32,
        rates: Body,
        dt: f32,
    ) -> LimitedCommand {
        let step = self.slew * dt;
        let mut saturated = Status::empty();
        let mut limit = |rate: f32, last: f32| {
            let mut rate = rate;
            if rate.abs() > self.rate {
                saturated |= Status::RATE;
                rate = if rate < 0.0 { -self.rate } else { self.rate };
            }
            let change = rate - last;
            if change.abs() > step {
                saturated |= Status::SLEW;
                rate = if change < 0.0 {
                    last - step
                } else {
                    last + step
                };
            }
            rate
        };
        let rates = Body::new(
            limit(rates.i, state.rates.i),
            limit(rates.j, state.rates.j),
            limit(rates.w, state.rates.w),
        );
        let most = self.thrust_max * self.propeller.available(along);
        let least = math::min(least, most);
        let bounded_thrust = math::clamp(thrust, least, most);
        *state = LimitState {
            rates,
            thrust: math::clamp(
                self.propeller.command(bounded_thrust, along),
                self.thrust_min,
                self.thrust_max,
            ),
        };
        saturated |=
            Status::THRUST_LOW.when(thrust < least) | Status::THRUST_HIGH.when(thrust > most);
        LimitedCommand {
            thrust: bounded_thrust,
            rates,
            saturated,
        }
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

    /// The axis that is tried: each once.
    fn axis(n: usize, rate: f32) -> Body {
        match n {
            0 => Body::new(rate, 0.0, 0.0),
            1 => Body::new(0.0, rate, 0.0),
            _ => Body::new(0.0, 0.0, rate),
        }
    }

    fn last(n: usize, rate: f32) -> LimitState {
        LimitState {
            rates: axis(n, rate),
            thrust: 1.0,
        }
    }

    /// A turn may take a negative thrust: the motors then brake.
    #[test]
    fn thrust_to_turn_with_brakes() {
        let p = VehicleParameters {
            thrust_min: 0.0,
            thrust_max: 100.0,
            zero_thrust_speed: 20.0,
            ..VehicleParameters::PAPER
        };
        let model = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = Vehicle::new(p, model).unwrap();
        let limits = Limits::new(&GuidanceParameters::default(), &vehicle);
        let braked = |least: f32, thrust: f32| {
            let mut state = limits.at_rest();
            let rates = Body::default();
            let limited = limits.apply(&mut state, [least, thrust], 20.0, rates, 0.01);
            (limited.thrust, limited.saturated, state.thrust)
        };
        assert_eq!(braked(0.0, -24.5), (0.0, Status::THRUST_LOW, 0.0));
        let (thrust, saturated, command) = braked(-24.5, -24.5);
        assert_eq!((thrust, saturated), (-24.5, Status::empty()));
        // (0.3 + √(0.49 − 0.245))² of 100 N, to single precision.
        assert!((command - 63.197).abs() < 1e-2, "{command}");
    }

    #[test]
    fn what_is_inside_passes_unchanged() {
        for n in 0..3 {
            let (mut state, rates) = (last(n, 0.4), axis(n, 0.5));
            let limited = limits().apply(&mut state, [1.0, 50.0], 0.0, rates, 0.01);
            let unchanged = LimitedCommand {
                thrust: 50.0,
                rates,
                saturated: Status::empty(),
            };
            assert_eq!(limited, unchanged);
            assert_eq!((state.rates, state.thrust), (rates, 50.0));
        }
    }

    #[test]
    fn each_limit_is_kept_and_told() {
        for n in 0..3 {
            let apply = |from, thrust, rate| {
                let LimitedCommand {
                    thrust,
                    rates,
                    saturated,
                } = limits().apply(
                    &mut last(n, from),
                    [1.0, thrust],
                    0.0,
                    axis(n, rate),
                    1.0 / 128.0,
                );
                (thrust, rates.i + rates.j + rates.w, saturated)
            };
            assert_eq!(apply(0.0, 0.0, 0.0), (1.0, 0.0, Status::THRUST_LOW));
            assert_eq!(apply(0.0, 101.0, 0.0), (100.0, 0.0, Status::THRUST_HIGH));
            assert_eq!(apply(-1.95, 50.0, -9.0), (50.0, -2.0, Status::RATE));
            assert_eq!(apply(0.0, 50.0, 0.5), (50.0, 0.125, Status::SLEW));
            let both = Status::RATE | Status::SLEW;
            assert_eq!(apply(0.0, 50.0, -3.0), (50.0, -0.125, both));
        }
    }

    /// Whether pitch can still obey is a matter of pitch alone.
    #[test]
    fn pitch_stands_at_its_limit_when_it_is_there() {
        let at = |n, rate| limits().pitch_at_limit(&last(n, rate));
        assert_eq!((at(2, -2.0), at(2, 1.9), at(0, 2.0)), (-2.0, 0.0, 0.0));
    }

    #[test]
    fn a_last_command_that_the_limits_do_not_let_pass_is_not_sound() {
        let limits = limits();
        assert!(limits.is_sound(&limits.at_rest()) && limits.is_sound(&last(0, -2.0)));
        for bad in [f32::NAN, f32::INFINITY, 2.1, -1e30] {
            assert!((0..3).all(|n| !limits.is_sound(&last(n, bad))));
        }
        for thrust in [f32::NAN, 0.9, 1e30] {
            let rates = Body::default();
            assert!(!limits.is_sound(&LimitState { rates, thrust }));
        }
    }
}
