//! Force error from the accelerometer: what the believed vehicle leaves out.

use super::MAX_STEP;
use super::orientation::Orientation;
use super::vector::Body;
use crate::error::{ParameterError, in_range};
use crate::math;
use crate::ned::{Frd, Ned};

/// Parameters of the force estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ForceErrorParameters {
    /// Time constant τ_d \[s\].
    pub time: f32,
    /// Time constant of the thrust behind its command \[s\].
    pub thrust_lag: f32,
    /// Largest force error that is believed \[N\].
    pub most: f32,
}

/// Estimates d̂ = m f − F̂_a + T̂ i: the force that the accelerometer feels beyond the believed aerodynamic force and
/// thrust, low-passed in world axes. W + d̂ then takes the place of W.
///
/// Use it with a law whose feed-forward leaves ∂_α f_p γ̇ out, such as
/// [`WingedControl::robust`](super::WingedControl::robust): with that term it cycles near the folds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ForceError {
    mass: f32,
    time: f32,
    thrust_lag: f32,
    most: f32,
}

/// What the estimator remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ForceErrorState {
    /// d̂ \[N\].
    pub force: Ned,
    /// T̂ \[N\]: the thrust that the commands should have given by now.
    pub thrust: f32,
}

/// What the estimator looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ForceSample {
    /// Specific force f in body components [m/s²]: what an accelerometer measures.
    pub specific_force: Frd,
    /// Attitude at the same time.
    pub orientation: Orientation,
    /// F̂_a \[N\] there: [`Diagnostics::aerodynamic`](super::Diagnostics::aerodynamic).
    pub aerodynamic: Frd,
    /// Thrust T \[N\] commanded from then on, within its limits.
    pub thrust: f32,
}

impl ForceError {
    /// The estimator for a vehicle believed to have this `mass` \[kg\].
    ///
    /// # Errors
    /// `mass` outside [1e-3, 1e6] kg, `time` or `thrust_lag` outside [1e-3, 1e3] s, `most` outside [1e-3, 1e6] N; or
    /// any not finite.
    pub fn new(p: ForceErrorParameters, mass: f32) -> Result<Self, ParameterError> {
        in_range("mass", mass, [1e-3, 1e6], "kg")?;
        in_range("time", p.time, [1e-3, 1e3], "s")?;
        in_range("thrust_lag", p.thrust_lag, [1e-3, 1e3], "s")?;
        in_range("most", p.most, [1e-3, 1e6], "N")?;
        Ok(Self::of_checked(p, mass))
    }

    /// The estimator with parameters and a mass that [`new`](Self::new) would take.
    pub(crate) fn of_checked(p: ForceErrorParameters, mass: f32) -> Self {
        Self {
            mass,
            time: p.time,
            thrust_lag: p.thrust_lag,
            most: p.most,
        }
    }

    /// One step of `dt` \[s\], after the law's. A sample that is not finite, or a `dt` that is not positive, changes nothing.
    #[inline(always)]
    pub fn update(&self, state: &mut ForceErrorState, sample: &ForceSample, dt: f32) {
        self.advance(state, sample, 1.0, dt);
    }

    /// The same, the force across the nose at this part of the `pace` along it.
    #[inline(always)]
    pub(crate) fn advance(
        &self,
        state: &mut ForceErrorState,
        sample: &ForceSample,
        pace: f32,
        dt: f32,
    ) {
        let body = Body::from(sample.specific_force) * self.mass - sample.aerodynamic.into()
            + Body::new(state.thrust, 0.0, 0.0);
        let step = sample.orientation.of_axes(body) - state.force;
        let nose = sample.orientation.i();
        let along = passed(dt, self.time);
        let across = pace * along;
        let next = state.force + step * across + nose * ((along - across) * nose.dot(step));
        let thrust = state.thrust + (sample.thrust - state.thrust) * passed(dt, self.thrust_lag);
        let square = next.norm_squared();
        let timed = dt > 0.0 && dt <= MAX_STEP;
        if timed && square + thrust * thrust < 1e18 {
            let limit = self.most * self.most;
            state.force = if square > limit {
                next * (self.most / math::sqrt(square))
            } else {
                next
            };
            state.thrust = thrust;
        } else if !(state.force.norm_squared() + state.thrust * state.thrust).is_finite() {
            *state = ForceErrorState::default();
        }
    }
}

/// 1 − e^{−dt/τ}: the share of the way that a first-order lag goes. Meaningless unless `dt` is positive.
#[inline(always)]
fn passed(dt: f32, time: f32) -> f32 {
    let exponent = math::min(core::f32::consts::LOG2_E * (dt / time), 100.0);
    1.0 - math::exp2(-exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: ForceErrorParameters = ForceErrorParameters {
        time: 0.2,
        thrust_lag: 0.05,
        most: 60.0,
    };

    fn estimator() -> ForceError {
        ForceError::new(GOOD, 9.0).unwrap()
    }

    /// Hover of 10 kg believed to be 9: the accelerometer feels T/m forward.
    fn hover() -> ForceSample {
        ForceSample {
            specific_force: Frd::new(9.81, 0.0, 0.0),
            orientation: Orientation::NOSE_UP,
            aerodynamic: Frd::default(),
            thrust: 98.1,
        }
    }

    /// d̂ = −9·9.81 + 98.1 N: the weight that the belief leaves out, downward. It has gone 1 − 1/e of the way after τ_d.
    #[test]
    fn missing_weight_is_found_downward() {
        let start = ForceErrorState {
            force: Ned::ZERO,
            thrust: 98.1,
        };
        let after = |steps: usize| {
            let mut state = start;
            for _ in 0..steps {
                estimator().update(&mut state, &hover(), 0.01);
            }
            state.force
        };
        assert!((after(500).down - 9.81).abs() < 1e-4);
        assert!((after(20).down / 9.81 - 0.632_12).abs() < 1e-4);
        assert_eq!((after(500).north, after(500).east), (0.0, 0.0));
    }

    /// Thrust is what its lag lets through: 1 − 1/e of a step after 50 ms.
    #[test]
    fn thrust_follows_its_lag() {
        let mut state = ForceErrorState::default();
        for _ in 0..5 {
            estimator().update(&mut state, &hover(), 0.01);
        }
        assert!((state.thrust / 98.1 - 0.632_12).abs() < 1e-4);
    }

    #[test]
    fn it_is_bounded_and_leaves_nonsense_out() {
        let mut state = ForceErrorState::default();
        let shove = ForceSample {
            specific_force: Frd::new(-1e3, 1e3, -1e3),
            ..hover()
        };
        for _ in 0..1000 {
            estimator().update(&mut state, &shove, 0.01);
        }
        // 60 N, rounded.
        assert!(state.force.norm_squared() < 3600.01);
        let before = state;
        for bad in [f32::NAN, f32::INFINITY, 3e38] {
            let sample = ForceSample {
                specific_force: Frd::new(bad, 0.0, 0.0),
                ..hover()
            };
            estimator().update(&mut state, &sample, 0.01);
            let sample = ForceSample {
                thrust: bad,
                ..hover()
            };
            estimator().update(&mut state, &sample, 0.01);
        }
        for dt in [0.0, -0.01, f32::NAN, 1.0] {
            estimator().update(&mut state, &hover(), dt);
        }
        assert_eq!(state, before);
        state.force.east = f32::NAN;
        estimator().update(&mut state, &hover(), 0.01);
        assert_eq!(state, ForceErrorState::default());
    }

    #[test]
    fn bad_parameters_are_named() {
        let name = |p, mass| ForceError::new(p, mass).unwrap_err().parameter;
        assert_eq!(name(GOOD, 0.0), "mass");
        assert_eq!(
            name(ForceErrorParameters { time: 0.0, ..GOOD }, 9.0),
            "time"
        );
        let lag = f32::NAN;
        assert_eq!(
            name(
                ForceErrorParameters {
                    thrust_lag: lag,
                    ..GOOD
                },
                9.0
            ),
            "thrust_lag"
        );
        assert_eq!(
            name(ForceErrorParameters { most: 1e9, ..GOOD }, 9.0),
            "most"
        );
    }
}
