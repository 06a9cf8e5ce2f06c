//! The controller of an experiment in a vertical plane, as a companion's pilot.

use alula::GuidanceInput;
use alula::ned::Ned;
use alula::planar::{Inertial, PlanarGuidanceInput};
use alula_bridges::companion::{HoldParameters, InPlane, Planar, Settings, Wanted};
use nalgebra::UnitQuaternion;

use alula_sim::controllers::{Answer, Controller, Input};
use alula_sim::experiment::{Experiment, State, Target, V3, angle, double, ned};
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

/// Reference velocity, acceleration and position of `experiment`, which is in a vertical plane.
pub fn plan(experiment: &Experiment) -> impl Fn(f64) -> [Inertial; 3] {
    let knots = experiment.path.knots();
    move |t| {
        let target = knots.map_or_else(Target::default, |knots| knots.target(t));
        [target.velocity, target.acceleration, target.position].map(|v| ned(v).to_plane())
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
            sample: GuidanceInput::from(sample),
            feed_forward: None,
        };
        let answer = self.controller.answer(&input, dt).ok()?;
        self.last = Some((input, answer));
        Some((answer.thrust, answer.rates.w))
    }
}

/// The step that was commanded last. Of the truth nothing is known but what the autopilot says.
fn step(pilot: &InPlane<Controlled>) -> Option<Step> {
    let told = pilot.last()?;
    let (input, answer) = pilot.controller().last?;
    let world = |v: Inertial| double(Ned::in_plane(v));
    let reference = told.input.reference;
    // Where no position is held it is the vehicle's own.
    let position_error = told.input.position_error.unwrap_or_default();
    let theta = told.input.attitude.angle().into();
    let attitude = UnitQuaternion::from_axis_angle(&V3::y_axis(), theta);
    Some(Step {
        t: told.t,
        truth: State {
            velocity: world(told.input.velocity),
            position: world(told.position),
            attitude,
            rates: V3::new(0.0, answer.rates.w.into(), 0.0),
            thrust: answer.thrust.into(),
        },
        theta,
        wind: world(told.wind),
        load_factor: f64::NAN,
        readings: Vec::new(),
        target: Target {
            position: world(told.position - position_error),
            velocity: world(reference.velocity),
            acceleration: world(reference.acceleration),
            heading: None,
        },
        measured_attitude: attitude,
        input,
        answer,
        mission: None,
        virtual_theta: None,
    })
}

/// Adds the step that was commanded last to the record.
pub fn keep(record: &mut Record, pilot: &InPlane<Controlled>) {
    let step = step(pilot);
    let later = |step: &Step| record.last().is_none_or(|last| step.t > last.t);
    let step = step.filter(later);
    record.extend(step);
}
