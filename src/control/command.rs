//! What goes into a control step and what comes out of it.

use core::fmt;

use crate::frame::{Attitude, Body, Inertial};
use crate::reference::{MAX_ACCELERATION, MAX_SPEED, Reference};

/// Attitude pairs with |cos² + sin² − 1| above this are refused: they are no attitude.
const MAX_ATTITUDE_DEFECT: f32 = 1e-3;
/// Thrusts \[N\] and rates [rad/s] above this are refused: the law has no answer there.
const MAX_OUTPUT: f32 = 1e9;

/// State of the vehicle and of the air.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// Velocity v over ground [m/s].
    pub velocity: Inertial,
    /// Attitude θ.
    pub attitude: Attitude,
    /// Wind velocity v_w over ground [m/s].
    pub wind: Inertial,
}

/// What the feed-forward F_δ needs (`Fdelta`). γ̇ follows from the air velocity and its derivative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FeedForward {
    /// Derivative of the air velocity, ẍ_a = v̇ − v̇_w [m/s²].
    pub air_acceleration: Inertial,
    /// Reference jerk j_r [m/s³].
    pub jerk: Inertial,
}

/// Command of one step. The default is the safe command: no thrust, no rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Command {
    /// Thrust T \[N\] along −i. Not limited: it may be negative.
    pub thrust: f32,
    /// Angular rate ω = θ̇ [rad/s]; negative from hover towards cruise.
    pub rate: f32,
    /// How the command came about.
    pub diagnostics: Diagnostics,
}

/// What a flight log wants to know of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Diagnostics {
    /// Angle of attack α \[rad\], in [−π, π].
    pub alpha: f32,
    /// F_p \[N\] in body components.
    pub f_p: Body,
    /// |F_p| \[N\]: how far the law is from losing its equilibrium.
    pub f_p_norm: f32,
    /// T_p = T + λ k_a |v_a|² \[N\] (`eq:Tp`).
    pub t_p: f32,
    /// μ_τ(|F_p| + F̄_p1), which weighs the alignment term; 1 in the full law.
    pub guard_alignment: f32,
    /// μ_τ(|F_p|), which weighs the feed-forward; 1 in the full law, and 0 where there is no feed-forward.
    pub guard_feed_forward: f32,
    /// The gain k of the full law (`eq:kv`); 1 in the robust law.
    pub k: f32,
}

impl Diagnostics {
    /// θ̃ \[rad\], in (−π, π]: angle from the thrust line to F_p. 0 at the equilibria that the law stabilises.
    pub fn theta_tilde(&self) -> f32 {
        libm::atan2f(self.f_p.j(), self.f_p.i())
    }
}

/// Why a step gives no command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Fault {
    /// The velocity is not finite, or longer than [`MAX_SPEED`].
    Velocity,
    /// The wind is not finite, or longer than [`MAX_SPEED`].
    Wind,
    /// The attitude is not a unit pair.
    Attitude,
    /// The reference velocity is not finite, or longer than [`MAX_SPEED`].
    ReferenceVelocity,
    /// The reference acceleration is not finite, or longer than [`MAX_ACCELERATION`].
    ReferenceAcceleration,
    /// The air acceleration of the feed-forward is not finite, or longer than [`MAX_ACCELERATION`].
    AirAcceleration,
    /// The reference jerk of the feed-forward is not finite, or longer than [`MAX_ACCELERATION`].
    Jerk,
    /// The law has no finite answer: the full law at F_p = 0, θ̃ = π or 1/k = 0, or parameters so extreme that
    /// the arithmetic overflows.
    Undefined,
}

impl Fault {
    /// Name for logs, in snake case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Wind => "wind",
            Self::Attitude => "attitude",
            Self::ReferenceVelocity => "reference_velocity",
            Self::ReferenceAcceleration => "reference_acceleration",
            Self::AirAcceleration => "air_acceleration",
            Self::Jerk => "jerk",
            Self::Undefined => "undefined",
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Velocity => "velocity is not finite or absurdly large",
            Self::Wind => "wind is not finite or absurdly large",
            Self::Attitude => "attitude is not a unit (cos, sin) pair",
            Self::ReferenceVelocity => "reference velocity is not finite or absurdly large",
            Self::ReferenceAcceleration => "reference acceleration is not finite or absurdly large",
            Self::AirAcceleration => "air acceleration is not finite or absurdly large",
            Self::Jerk => "reference jerk is not finite or absurdly large",
            Self::Undefined => "the law is undefined here",
        })
    }
}

impl core::error::Error for Fault {}

/// Refuses inputs that are not finite or absurd.
///
/// One sum decides for all: NaN and infinity fail its comparison too. Only when it fails is each input looked at.
#[inline(always)]
pub(crate) fn check_input(state: &State, reference: &Reference) -> Result<(), Fault> {
    // Brings the attitude's defect to the scale of the squared speeds.
    const WEIGHT: f32 = MAX_SPEED / MAX_ATTITUDE_DEFECT;
    let defect = WEIGHT * attitude_defect(&state.attitude);
    let sum = state.velocity.norm_squared()
        + state.wind.norm_squared()
        + reference.velocity.norm_squared()
        + reference.acceleration.norm_squared()
        + defect * defect;
    if sum < MAX_SPEED * MAX_SPEED {
        Ok(())
    } else {
        name_input(state, reference)
    }
}

#[inline(always)]
fn attitude_defect(attitude: &Attitude) -> f32 {
    attitude.cos * attitude.cos + attitude.sin * attitude.sin - 1.0
}

#[cold]
#[inline(never)]
fn name_input(state: &State, reference: &Reference) -> Result<(), Fault> {
    let ok = |v: Inertial, max: f32| v.norm_squared() <= max * max;
    if !ok(state.velocity, MAX_SPEED) {
        Err(Fault::Velocity)
    } else if !ok(state.wind, MAX_SPEED) {
        Err(Fault::Wind)
    } else if !matches!(attitude_defect(&state.attitude).abs(), d if d <= MAX_ATTITUDE_DEFECT) {
        Err(Fault::Attitude)
    } else if !ok(reference.velocity, MAX_SPEED) {
        Err(Fault::ReferenceVelocity)
    } else if !ok(reference.acceleration, MAX_ACCELERATION) {
        Err(Fault::ReferenceAcceleration)
    } else {
        Ok(())
    }
}

/// Refuses a feed-forward that is not finite or absurd.
#[inline(always)]
pub(crate) fn check_feed_forward(ff: &FeedForward) -> Result<(), Fault> {
    let ok = |v: Inertial| v.norm_squared() <= MAX_ACCELERATION * MAX_ACCELERATION;
    if !ok(ff.air_acceleration) {
        Err(Fault::AirAcceleration)
    } else if !ok(ff.jerk) {
        Err(Fault::Jerk)
    } else {
        Ok(())
    }
}

/// Refuses a result that is not a number to fly.
#[inline(always)]
pub(crate) fn check_output(command: Command) -> Result<Command, Fault> {
    if command.thrust.abs() + command.rate.abs() < MAX_OUTPUT {
        Ok(command)
    } else {
        Err(Fault::Undefined)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::format;

    /// What a step is asked in the velocities, the attitude and the acceleration given.
    fn asked(
        velocity: f32,
        wind: f32,
        cos: f32,
        reference: f32,
        acceleration: f32,
    ) -> Result<(), Fault> {
        let state = State {
            velocity: Inertial::new(0.0, velocity),
            attitude: Attitude { cos, sin: 0.0 },
            wind: Inertial::new(-wind, 0.0),
        };
        let reference = Reference {
            velocity: Inertial::new(reference, 0.0),
            acceleration: Inertial::new(0.0, acceleration),
        };
        check_input(&state, &reference)
    }

    #[test]
    fn each_input_is_held_against_its_own_bound() {
        let (fast, steep) = (1.01 * MAX_SPEED, 1.01 * MAX_ACCELERATION);
        assert_eq!(asked(fast, 0.0, 1.0, 0.0, 0.0), Err(Fault::Velocity));
        assert_eq!(asked(0.0, fast, 1.0, 0.0, 0.0), Err(Fault::Wind));
        assert_eq!(
            asked(0.0, 0.0, 1.0, fast, 0.0),
            Err(Fault::ReferenceVelocity)
        );
        assert_eq!(
            asked(0.0, 0.0, 1.0, 0.0, steep),
            Err(Fault::ReferenceAcceleration)
        );
        // Large together is not too large.
        let (fast, steep) = (0.99 * MAX_SPEED, 0.99 * MAX_ACCELERATION);
        assert_eq!(asked(fast, fast, 1.0, fast, steep), Ok(()));
    }

    /// The square of an attitude may be off by [`MAX_ATTITUDE_DEFECT`], to either side, at any speed.
    #[test]
    fn an_attitude_is_a_unit_pair_to_a_thousandth() {
        for speed in [0.0, 0.9 * MAX_SPEED, 0.999 * MAX_SPEED] {
            for off in [-0.9f32, 0.9, -1.1, 1.1, 1e3, -1e3] {
                let cos = (1.0 + off * MAX_ATTITUDE_DEFECT).sqrt();
                let expected = if off.abs() < 1.0 {
                    Ok(())
                } else {
                    Err(Fault::Attitude)
                };
                assert_eq!(asked(speed, 0.0, cos, 0.0, 0.0), expected, "{speed} {off}");
            }
        }
    }

    #[test]
    fn a_feed_forward_is_held_against_its_bound() {
        let check = |air_acceleration: f32, jerk: f32| {
            check_feed_forward(&FeedForward {
                air_acceleration: Inertial::new(air_acceleration, 0.0),
                jerk: Inertial::new(0.0, jerk),
            })
        };
        let (most, beyond) = (0.99 * MAX_ACCELERATION, 1.01 * MAX_ACCELERATION);
        assert_eq!(check(most, most), Ok(()));
        assert_eq!(check(beyond, 0.0), Err(Fault::AirAcceleration));
        assert_eq!(check(0.0, -beyond), Err(Fault::Jerk));
        assert_eq!(check(f32::NAN, 0.0), Err(Fault::AirAcceleration));
        assert_eq!(check(0.0, f32::NAN), Err(Fault::Jerk));
    }

    #[test]
    fn a_result_is_held_against_its_bound() {
        let check = |thrust: f32, rate: f32| {
            let command = Command {
                thrust,
                rate,
                ..Command::default()
            };
            check_output(command).map(|c| (c.thrust, c.rate))
        };
        let (few, many) = (0.4 * MAX_OUTPUT, 1.1 * MAX_OUTPUT);
        assert_eq!(check(few, -few), Ok((few, -few)));
        let refused = [
            (many, 0.0),
            (0.0, -many),
            (-many, many),
            (f32::NAN, 0.0),
            (0.0, f32::NEG_INFINITY),
        ];
        for (thrust, rate) in refused {
            assert_eq!(check(thrust, rate), Err(Fault::Undefined));
        }
    }

    /// A name is the variant's, in snake case.
    #[test]
    fn names_are_the_variants() {
        for fault in [
            Fault::Velocity,
            Fault::Wind,
            Fault::Attitude,
            Fault::ReferenceVelocity,
            Fault::ReferenceAcceleration,
            Fault::AirAcceleration,
            Fault::Jerk,
            Fault::Undefined,
        ] {
            let mut snake = std::string::String::new();
            for c in format!("{fault:?}").chars() {
                if c.is_uppercase() && !snake.is_empty() {
                    snake.push('_');
                }
                snake.extend(c.to_lowercase());
            }
            assert_eq!(fault.name(), snake);
        }
    }
}
