//! The controller of an experiment in a vertical plane, as a companion's pilot.

use alula::{FeedForward, Inertial, PlanarGuidanceInput};
use alula_bridges::companion::{HoldParameters, InPlane, Planar, Settings, Wanted};

use alula_sim::controllers::{Answer, Controller, Input, inertial, vector};
use alula_sim::experiment::{Experiment, State, angle};
use alula_sim::simulate::{Record, Step};

/// Settings for flying `experiment`, of whose belief `hover_thrust` is the autopilot's thrust in hover.
pub fn settings(experiment: &Experiment, hover_thrust: Option<f64>) -> anyhow::Result<Settings> {
    let spec = experiment.spec()?;
    if spec.feed_forward() {
        anyhow::bail!(
            "the controller wants the air acceleration and the reference's jerk, which MAVLink does not tell"
        );
    }
    let weight = spec.belief().unwrap_or(&experiment.vehicle).weight();
    let most = experiment.thrust_limits(None, weight)[1];
    super::settings(weight, most, hover_thrust, experiment.duration_s)
}

/// The plan of an experiment: velocity, acceleration and position at each time \[s\].
pub fn plan(experiment: &Experiment) -> impl Fn(f64) -> [Inertial; 3] {
    |t| {
        let (velocity, acceleration) = experiment.reference.at(t);
        let position = experiment.reference.position(t);
        [velocity, acceleration, position].map(inertial)
    }
}

/// The controller of an experiment, and what it answered last.
pub struct Controlled {
    controller: Box<dyn Controller>,
    last: Option<(Input, Answer)>,
}

/// The pilot of `experiment`, along what is `wanted`, in the plane of `heading` \[rad\] or of the vehicle's at the start.
pub fn pilot<'a>(
    experiment: &Experiment,
    wanted: Wanted<'a>,
    heading: Option<f32>,
) -> anyhow::Result<InPlane<'a, Controlled>> {
    if let Some(heading) = heading {
        angle("heading", heading.to_degrees().into())?;
    }
    let controlled = Controlled {
        controller: experiment.controller()?,
        last: None,
    };
    Ok(InPlane::new(
        controlled,
        wanted,
        HoldParameters::default(),
        heading,
    ))
}

impl Planar for Controlled {
    fn answer(&mut self, sample: &PlanarGuidanceInput, dt: f32) -> Option<(f32, f32)> {
        let input = Input {
            theta: sample.attitude.angle(),
            sample: *sample,
            feed_forward: None::<FeedForward>,
        };
        let answer = self.controller.answer(&input, dt).ok()?;
        self.last = Some((input, answer));
        Some((answer.thrust, answer.rate))
    }
}

/// The step that was commanded last. Of the truth nothing is known but what the autopilot says.
fn step(pilot: &InPlane<Controlled>) -> Option<Step> {
    let flown = pilot.flown()?;
    let (input, answer) = pilot.controller().last?;
    let reference = flown.input.reference;
    // Where no position is held it is the vehicle's own.
    let position_error = flown.input.position_error.unwrap_or_default();
    Some(Step {
        t: flown.t,
        truth: State {
            velocity: vector(flown.input.velocity),
            position: vector(flown.position),
            theta: input.theta.into(),
            rate: answer.rate.into(),
            thrust: answer.thrust.into(),
        },
        wind: vector(flown.wind),
        reference_velocity: vector(reference.velocity),
        reference_acceleration: vector(reference.acceleration),
        reference_position: vector(flown.position - position_error),
        input,
        answer,
    })
}

/// Adds the step that was commanded last to the record.
pub fn keep(record: &mut Record, pilot: &InPlane<Controlled>) {
    let step = step(pilot);
    let later = |step: &Step| record.last().is_none_or(|last| step.t > last.t);
    let step = step.filter(later);
    record.extend(step);
}
