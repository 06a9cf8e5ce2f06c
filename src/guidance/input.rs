//! What a guidance step is told.

use super::planner_options::PlannerOptions;
use super::supervision::Air;
use crate::ned::{Frd, Ned};
use crate::parameters::setters;
use crate::spatial::{Orientation, Reference};

/// What a guidance step is told. The default hovers where it is, nose up, and knows no more.
///
/// ```
/// use alula::prelude::*;
///
/// let input = GuidanceInput::default()
///     .velocity(Ned::new(2.0, 0.0, 0.0))
///     .air(Air::Wind(Ned::ZERO))
///     .position_error(Ned::new(0.0, 0.5, 0.0));
/// assert_eq!(input.position_error, Some(Ned::new(0.0, 0.5, 0.0)));
/// assert_eq!(input.specific_force, None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct GuidanceInput {
    /// Velocity v over ground [m/s].
    pub velocity: Ned,
    /// Attitude.
    pub orientation: Orientation,
    /// Age \[s\] of velocity and attitude, not negative.
    pub state_age: f32,
    /// What is known of the air.
    pub air: Air,
    /// Specific force [m/s²], if it is measured: what an accelerometer feels, acceleration less gravity. With
    /// it the law makes up for what is not known of mass, wing and thrust, and of the wind across.
    pub specific_force: Option<Frd>,
    /// Position less reference position, x̃ \[m\], if position is to be held.
    pub position_error: Option<Ned>,
    /// Reference.
    pub reference: Reference,
    /// Age \[s\] of the reference, not negative.
    pub reference_age: f32,
    /// What plans are to mind.
    pub planner_options: PlannerOptions,
}

setters! {
    GuidanceInput {
        velocity: Ned,
        orientation: Orientation,
        state_age: f32,
        air: Air,
        specific_force: impl Into<Option<Frd>>,
        position_error: impl Into<Option<Ned>>,
        reference: Reference,
        reference_age: f32,
        planner_options: PlannerOptions,
    }
}
