//! The control step alone, compiled for the target so that its object can be searched for what must not be in it:
//! software double precision and panics. See `.ci/check-symbols`, which also proves that it would find them.
#![no_std]

use alula::ned::{BodyAxes, Frd, Quaternion};
use alula::planar::equilibrium::{Equilibria, EquilibriumError, FoldMap, FoldMargin};
use alula::planar::equivalency::ApparentForces;
use alula::planar::{Command, FeedForward, Inertial, Reference, State, VelocityControl};
use alula::spatial::axisymmetric::AxisymmetricControl;
use alula::spatial::{
    self, ForceError, ForceErrorState, ForceSample, Ned, Orientation, Sideslip, SideslipState,
    WingedControl,
};
use alula::{
    Combined, Fault, GainChoice, Guidance, GuidanceInput, GuidanceOutput, GuidanceState, Model,
    Vehicle,
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
) -> GuidanceOutput {
    guidance.update(state, input, dt)
}

/// A plan.
#[inline(never)]
pub fn plan(guidance: &Guidance<Model, GainChoice>, state: &mut GuidanceState) {
    guidance.plan(state);
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

/// The laws in space, robust and full, of a wing and of a body of revolution.
#[inline(never)]
pub fn in_space(
    winged: &WingedControl<Model, GainChoice>,
    axisymmetric: &AxisymmetricControl<Model, GainChoice>,
    state: &spatial::State,
    reference: &spatial::Reference,
    feed_forward: Option<&spatial::FeedForward>,
) -> [Result<spatial::Command, Fault>; 4] {
    [
        winged.robust(state, reference, feed_forward),
        winged.full(state, reference, feed_forward),
        axisymmetric.robust(state, reference, feed_forward),
        axisymmetric.full(state, reference, feed_forward),
    ]
}

/// What the laws in space are given: attitude, and the estimators' corrections.
#[inline(never)]
pub fn estimates(
    (force, force_state): (&ForceError, &mut ForceErrorState),
    (sideslip, sideslip_state): (&Sideslip, &mut SideslipState),
    sample: &ForceSample,
    v_a: Frd,
    q: &Quaternion,
    dt: f32,
) -> Result<Orientation, Fault> {
    force.update(force_state, sample, dt);
    sideslip.update(sideslip_state, v_a, sample.specific_force.right, dt);
    Orientation::from_quaternion(q, BodyAxes::NoseForward)
}

/// How fast a path may go on.
#[inline(never)]
pub fn path_time_scale(
    guidance: &Guidance<Model, GainChoice>,
    position_error: Ned,
    velocity: Ned,
) -> f32 {
    guidance.path_time_scale(position_error, velocity)
}

/// What the search must find, when it is asked to prove that it can.
#[inline(always)]
fn injected(command: Command) -> Command {
    #[cfg(inject = "double")]
    let command = {
        let mut command = command;
        command.thrust = (f64::from(command.thrust) * 1.000_000_1) as f32;
        command
    };
    #[cfg(inject = "panic")]
    assert!(command.thrust < 1e6);
    command
}
