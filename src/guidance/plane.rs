//! The guidance in one vertical plane: the plane to the north stands for it.
//!
//! For simulations in a plane, and for callers that know of one plane only. Nothing points out of it, so nothing turns out
//! of it; with `max_lateral_acceleration` zero no reference does that either.

use super::input::GuidanceInput;
use super::output::GuidanceOutput;
use super::planner_options::PlannerOptions;
use super::progress::Progress;
use super::state::GuidanceState;
use super::status::Status;
use super::supervision::{Air, AirUse, Mode, RejectReason};
use super::update::Guidance;
use crate::aero::Aerodynamics;
use crate::control::{Command, GainLaw, Margin};
use crate::frame::{Attitude, Body, Inertial};
use crate::ned::{Frd, Ned};
use crate::parameters::setters;
use crate::reference::Reference;
use crate::spatial::{self, Heading, Orientation};

impl Ned {
    /// The vector with these components in the vertical plane to the north.
    #[inline(always)]
    pub const fn in_plane(v: Inertial) -> Self {
        Self::new(v.forward(), 0.0, v.down())
    }

    /// Its components in the vertical plane to the north.
    #[inline(always)]
    pub const fn to_plane(&self) -> Inertial {
        Inertial::new(self.down, self.north)
    }
}

/// A [`GuidanceInput`] in one vertical plane: from the default by the method of each field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PlanarGuidanceInput {
    /// Velocity v over ground [m/s].
    pub velocity: Inertial,
    /// Attitude θ.
    pub attitude: Attitude,
    /// Age \[s\] of velocity and attitude, not negative.
    pub state_age: f32,
    /// What is known of the air.
    pub air: Air<Inertial>,
    /// Specific force in body components [m/s²], if it is measured: what an accelerometer feels, gravity not included. With
    /// it the law makes up for what is not known of mass, wing and thrust.
    pub specific_force: Option<Body>,
    /// Position less reference position, x̃ \[m\], if position is to be held.
    pub position_error: Option<Inertial>,
    /// Reference.
    pub reference: Reference,
    /// Age \[s\] of the reference, not negative.
    pub reference_age: f32,
    /// What plans are to mind.
    pub planner_options: PlannerOptions,
}

setters! {
    PlanarGuidanceInput {
        velocity: Inertial,
        attitude: Attitude,
        state_age: f32,
        air: Air<Inertial>,
        specific_force: impl Into<Option<Body>>,
        position_error: impl Into<Option<Inertial>>,
        reference: Reference,
        reference_age: f32,
        planner_options: PlannerOptions,
    }
}

/// A [`GuidanceOutput`] in one vertical plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct PlanarGuidanceOutput {
    /// The command, inside its limits. Its diagnostics are those of the law, before the limits; in
    /// [`Mode::Holding`] and [`Mode::Safe`] they are zero.
    pub command: Command,
    /// Mode.
    pub mode: Mode,
    /// What of the air was used.
    pub air: AirUse,
    /// What limited the step.
    pub status: Status,
    /// Margins of well-posedness; zero unless the law was flown.
    pub margin: Margin,
    /// The reference that the law was given.
    pub reference: Reference,
    /// What is being done, and what of the reference cannot be had.
    pub progress: Progress,
    /// Whether a plan is due: [`Guidance::plan`] is to be called.
    pub plan_due: bool,
    /// Why the frame was refused, if it was.
    pub reject_reason: Option<RejectReason>,
}

impl From<&PlanarGuidanceInput> for GuidanceInput {
    #[inline(always)]
    fn from(p: &PlanarGuidanceInput) -> Self {
        Self {
            velocity: Ned::in_plane(p.velocity),
            orientation: Orientation::in_plane(p.attitude),
            state_age: p.state_age,
            air: match p.air {
                Air::Velocity(v) => Air::Velocity(Ned::in_plane(v)),
                Air::Wind(v) => Air::Wind(Ned::in_plane(v)),
                Air::Unknown => Air::Unknown,
                Air::Pitot { airspeed, wind } => Air::Pitot {
                    airspeed,
                    wind: Ned::in_plane(wind),
                },
            },
            specific_force: p.specific_force.map(|f| Frd::new(-f.i(), 0.0, f.j())),
            position_error: p.position_error.map(Ned::in_plane),
            reference: spatial::Reference {
                velocity: Ned::in_plane(p.reference.velocity),
                acceleration: Ned::in_plane(p.reference.acceleration),
                heading: Heading::FREE,
            },
            reference_age: p.reference_age,
            planner_options: p.planner_options,
        }
    }
}

impl From<&GuidanceOutput> for PlanarGuidanceOutput {
    #[inline(always)]
    fn from(g: &GuidanceOutput) -> Self {
        Self {
            command: Command {
                thrust: g.command.thrust,
                rate: g.command.rates.pitch,
                diagnostics: g.command.diagnostics.plane,
            },
            mode: g.mode,
            air: g.air,
            status: g.status,
            margin: g.margin,
            reference: Reference {
                velocity: g.reference.velocity.to_plane(),
                acceleration: g.reference.acceleration.to_plane(),
            },
            progress: g.progress,
            plan_due: g.plan_due,
            reject_reason: g.reject_reason,
        }
    }
}

impl<A: Aerodynamics, G: GainLaw> Guidance<A, G> {
    /// [`update`](Self::update) in the vertical plane to the north.
    #[inline]
    pub fn update_in_plane(
        &self,
        state: &mut GuidanceState,
        input: &PlanarGuidanceInput,
        dt: f32,
    ) -> PlanarGuidanceOutput {
        PlanarGuidanceOutput::from(&self.update(state, &GuidanceInput::from(input), dt))
    }
}
