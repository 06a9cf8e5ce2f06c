//! What goes into a control step in space and what comes out of it.

use super::heading::Heading;
use super::orientation::Orientation;
use super::vector::Body;
use crate::control::{self, Fault, MAX_ACCELERATION, MAX_SPEED};
use crate::math;
use crate::ned::{BodyRates, Frd, Ned};

/// Thrusts \[N\] and rates [rad/s] above this are refused: the law has no answer there.
const MAX_OUTPUT: f32 = 1e9;

/// State of the vehicle and of the air.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct State {
    /// Velocity v over ground [m/s].
    pub velocity: Ned,
    /// Attitude.
    pub orientation: Orientation,
    /// Wind velocity v_w over ground [m/s].
    pub wind: Ned,
    /// What estimators add.
    pub correction: Correction,
}

/// What estimators add to the forces and to the air velocity. Zero by default.
///
/// A value that exists is finite: what is not a number is left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Correction {
    force: Ned,
    sideslip: f32,
    air: f32,
}

/// Excesses of the air's force that are believed.
const EXCESS: core::ops::RangeInclusive<f32> = -0.9..=9.0;

impl Correction {
    /// A force d̂ \[N\] on the vehicle that its model leaves out ([`ForceError`](super::ForceError)), and an air
    /// velocity [m/s] along the right wing that the wind leaves out ([`Sideslip`](super::Sideslip)). Either is left out if it is
    /// not finite, or absurd: above 1e6 N, or 1e3 m/s.
    pub fn new(force: Ned, sideslip: f32) -> Self {
        Self {
            force: if force.norm_squared() <= 1e12 {
                force
            } else {
                Ned::ZERO
            },
            sideslip: if sideslip.abs() <= MAX_SPEED {
                sideslip
            } else {
                0.0
            },
            air: 0.0,
        }
    }

    /// The same, with the force of the air in the plane of symmetry 1 + `excess` times the believed one. It is left out if
    /// it is not within −0.9 and 9.
    #[must_use]
    pub fn with_air(self, excess: f32) -> Self {
        let air = if EXCESS.contains(&excess) {
            excess
        } else {
            0.0
        };
        Self { air, ..self }
    }

    /// A force \[N\] and an excess of the air's force that are known to be finite and within what is believed.
    #[inline(always)]
    pub(crate) const fn of_checked(force: Ned, excess: f32) -> Self {
        Self {
            force,
            sideslip: 0.0,
            air: excess,
        }
    }

    /// Force of the air in the plane of symmetry as a multiple of the believed one.
    #[inline(always)]
    pub fn air(&self) -> f32 {
        1.0 + self.air
    }

    /// The force d̂ \[N\].
    #[inline(always)]
    pub fn force(&self) -> Ned {
        self.force
    }

    /// The air velocity along the right wing [m/s].
    #[inline(always)]
    pub fn sideslip(&self) -> f32 {
        self.sideslip
    }
}

/// What is asked of the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reference {
    /// Reference velocity v_r over ground [m/s].
    pub velocity: Ned,
    /// Reference acceleration a_r [m/s²].
    pub acceleration: Ned,
    /// Heading.
    pub heading: Heading,
}

/// What the feed-forward needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FeedForward {
    /// Derivative of the air velocity [m/s²]: a_r − v̇_w, or v̇ − v̇_w where v̇ is known.
    pub air_acceleration: Ned,
    /// Reference jerk j_r [m/s³].
    pub jerk: Ned,
}

/// Command of one step. The default is the safe command: no thrust, no rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Command {
    /// Thrust T \[N\] along the nose. Not limited: it may be negative.
    pub thrust: f32,
    /// Body rates [rad/s]. [`BodyAxes`](crate::BodyAxes) makes those of a multicopter's axes of them.
    pub rates: BodyRates,
    /// How the command came about.
    pub diagnostics: Diagnostics,
}

/// What a flight log wants to know of a step. Vectors are forward-right-down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Diagnostics {
    /// The planar law's, in the plane of symmetry; for the axisymmetric vehicle in the plane of nose and v_a.
    pub plane: control::Diagnostics,
    /// Air velocity v_a [m/s].
    pub v_a: Frd,
    /// Aerodynamic force F̂_a \[N\] of the believed vehicle.
    pub aerodynamic: Frd,
    /// What the wing is to be normal to, F_y \[N\]; for the axisymmetric vehicle F_p.
    pub f_y: Frd,
}

impl Diagnostics {
    /// Tilt \[rad\], in (−π/2, π/2): the angle by which the wing is off the normal of F_y. It is 0 where lateral forces
    /// balance, and positive where the force asked for points to the right wing.
    pub fn tilt(&self) -> f32 {
        out_of_plane(self.f_y)
    }

    /// Sideslip β \[rad\], in [−π/2, π/2]: the angle of the air velocity out of the plane of symmetry, positive where it
    /// points to the right wing.
    pub fn sideslip(&self) -> f32 {
        out_of_plane(self.v_a)
    }
}

/// Angle from the plane of symmetry to `v`, positive towards the right wing \[rad\]. Of diagnostics alone: out of line for size.
#[inline(never)]
fn out_of_plane(v: Frd) -> f32 {
    math::atan2(v.right, math::sqrt(v.forward * v.forward + v.down * v.down))
}

/// Refuses inputs that are not finite or absurd.
///
/// One sum decides for all: NaN and infinity fail its comparison too. Only when it fails is each input looked at.
#[inline(always)]
pub(super) fn check_input(state: &State, reference: &Reference) -> Result<(), Fault> {
    let sum = (state.velocity.norm_squared() + state.wind.norm_squared())
        + (reference.velocity.norm_squared() + reference.acceleration.norm_squared());
    if sum < MAX_SPEED * MAX_SPEED {
        Ok(())
    } else {
        name_input(state, reference)
    }
}

#[cold]
#[inline(never)]
fn name_input(state: &State, reference: &Reference) -> Result<(), Fault> {
    let ok = |v: Ned, max: f32| v.norm_squared() <= max * max;
    check_velocity(state.velocity)?;
    if !ok(state.wind, MAX_SPEED) {
        Err(Fault::Wind)
    } else if !ok(reference.velocity, MAX_SPEED) {
        Err(Fault::ReferenceVelocity)
    } else if !ok(reference.acceleration, MAX_ACCELERATION) {
        Err(Fault::ReferenceAcceleration)
    } else {
        Ok(())
    }
}

/// Refuses a velocity over ground that is not finite or absurd.
#[inline(always)]
pub(crate) fn check_velocity(velocity: Ned) -> Result<(), Fault> {
    if velocity.norm_squared() <= MAX_SPEED * MAX_SPEED {
        Ok(())
    } else {
        Err(Fault::Velocity)
    }
}

/// Refuses a feed-forward that is not finite or absurd.
#[inline(always)]
pub(super) fn check_feed_forward(ff: &FeedForward) -> Result<(), Fault> {
    let ok = |v: Ned| v.norm_squared() <= MAX_ACCELERATION * MAX_ACCELERATION;
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
pub(super) fn check_output(command: Command) -> Result<Command, Fault> {
    let Body { i, j, w } = command.rates.into();
    if (command.thrust.abs() + w.abs()) + (i.abs() + j.abs()) < MAX_OUTPUT {
        Ok(command)
    } else {
        Err(Fault::Undefined)
    }
}
