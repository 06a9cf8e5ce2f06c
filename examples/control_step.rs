//! The control step alone, compiled for the target so that its object can be searched for what must not be in it:
//! software double precision and panics. See `.ci/check-symbols`, which also proves that it would find them.
#![no_std]

use alula::equivalency::ApparentForces;
use alula::{
    Combined, Command, Equilibria, EquilibriumError, Fault, FeedForward, FoldMap, FoldMargin,
    GainChoice, Guidance, GuidanceInput, GuidanceState, Guided, Inertial, Model, Reference, State,
    Vehicle, VelocityControl,
};

/// The robust law on the combined model.
#[inline(never)]
pub fn robust(
    control: &VelocityControl<Combined>,
    state: &State,
    reference: &Reference,
    feed_forward: Option<&FeedForward>,
) -> Result<Command, Fault> {
    control.robust(state, reference, feed_forward).map(injected)
}

/// The full law on the combined model.
#[inline(never)]
pub fn full(
    control: &VelocityControl<Combined>,
    state: &State,
    reference: &Reference,
    feed_forward: Option<&FeedForward>,
) -> Result<Command, Fault> {
    control.full(state, reference, feed_forward)
}

/// The robust law on a model chosen at run time.
#[inline(never)]
pub fn robust_any_model(
    control: &VelocityControl<Model>,
    state: &State,
    reference: &Reference,
) -> Result<Command, Fault> {
    control.robust(state, reference, None)
}

/// A step of the guidance, everything on.
#[inline(never)]
pub fn guidance(
    guidance: &Guidance<Model, GainChoice>,
    state: &mut GuidanceState,
    input: &GuidanceInput,
    dt: f32,
) -> Guided {
    guidance.update(state, input, dt)
}

/// The equilibria of a reference.
#[inline(never)]
pub fn equilibria(
    vehicle: &Vehicle<Model>,
    reference: &Reference,
    wind: Inertial,
) -> Result<Equilibria, EquilibriumError> {
    Equilibria::find(vehicle, reference, wind)
}

/// The margin to the nearest fold.
#[inline(never)]
pub fn fold_margin(map: &FoldMap, forces: &ApparentForces) -> Option<FoldMargin> {
    map.margin(forces)
}

/// What the search must find, when it is asked to prove that it can.
#[inline(always)]
fn injected(command: Command) -> Command {
    #[cfg(inject = "double")]
    let command = Command {
        thrust: (f64::from(command.thrust) * 1.000_000_1) as f32,
        ..command
    };
    #[cfg(inject = "panic")]
    assert!(command.thrust < 1e6);
    command
}
