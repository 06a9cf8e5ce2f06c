//! The loop: plant in double precision, controller in single precision at a fixed rate.

use alula::{
    Attitude, Command, Fault, FeedForward, Inertial, Model, Reference, State, VelocityControl,
};

use crate::plant::PlantState;
use crate::reference::{Vector, wrap};
use crate::scenario::{FieldError, Law, Scenario};

/// What a controller is told at one step: exactly the core's arguments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// θ \[rad\] in [−π, π), of which `state.attitude` is the cosine and sine.
    pub theta: f32,
    /// State of the vehicle.
    pub state: State,
    /// Reference.
    pub reference: Reference,
    /// Feed-forward, if the law is flown with it.
    pub feed_forward: Option<FeedForward>,
}

impl Input {
    /// The input with its attitude made from `theta` \[rad\].
    pub fn new(
        theta: f32,
        velocity: Inertial,
        wind: Inertial,
        reference: Reference,
        feed_forward: Option<FeedForward>,
    ) -> Self {
        Self {
            theta,
            state: State {
                velocity,
                attitude: Attitude::from_angle(theta),
                wind,
            },
            reference,
            feed_forward,
        }
    }
}

/// What a controller answers: a command, or the fault for which the safe command stands in.
pub type Answer = Result<Command, Fault>;

/// Whoever closes the loop: the core in this process, or the same core behind a link.
pub trait Controller {
    /// The answer to `input`. The outer error is a controller that cannot be reached.
    fn answer(&mut self, input: &Input) -> anyhow::Result<Answer>;
}

/// The core, called in this process.
pub struct Local {
    control: VelocityControl<Model>,
    law: Law,
}

impl Local {
    /// The scenario's controller.
    pub fn new(scenario: &Scenario) -> Result<Self, FieldError> {
        Ok(Self {
            control: scenario.control()?,
            law: scenario.controller.law,
        })
    }
}

impl Controller for Local {
    fn answer(&mut self, input: &Input) -> anyhow::Result<Answer> {
        let forward = input.feed_forward.as_ref();
        Ok(match self.law {
            Law::Robust => self.control.robust(&input.state, &input.reference, forward),
            Law::Full => self.control.full(&input.state, &input.reference, forward),
        })
    }
}

/// One control step of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time \[s\].
    pub t: f64,
    /// The plant's state when the controller was asked.
    pub truth: PlantState,
    /// Reference velocity \[m/s\] in double precision.
    pub reference_velocity: Vector,
    /// The plant's angle of attack \[rad\]; NaN where there is no air velocity.
    pub alpha: f64,
    /// Thrust over the plant's weight.
    pub thrust_to_weight: f64,
    /// What the controller was told.
    pub input: Input,
    /// What it answered.
    pub answer: Answer,
}

impl Row {
    /// v − v_r \[m/s\].
    pub fn velocity_error(&self) -> Vector {
        self.truth.velocity - self.reference_velocity
    }

    /// The command that was applied: the safe command after a fault.
    pub fn command(&self) -> Command {
        self.answer.unwrap_or_default()
    }
}

/// The name of an answer in the `status` columns.
pub fn status(answer: &Answer) -> &'static str {
    answer.map_or_else(Fault::name, |_| "ok")
}

/// Flies `scenario` under `controller`: one row per control step, the last at the end of the
/// flight. `progress` is told the number of steps done.
pub fn fly(
    scenario: &Scenario,
    controller: &mut dyn Controller,
    mut progress: impl FnMut(usize),
) -> anyhow::Result<Vec<Row>> {
    let plant = scenario.plant();
    let steps = scenario.steps();
    let dt = 1.0 / scenario.control_rate_hz / f64::from(scenario.substeps);
    let mut truth = scenario.initial_state();
    let mut thrust = scenario.initial.thrust_n;
    let mut rows = Vec::with_capacity(steps + 1);
    for step in 0..=steps {
        let t = step as f64 / scenario.control_rate_hz;
        let (velocity, acceleration) = scenario.reference.at(t);
        let feed_forward = scenario.controller.feed_forward.then(|| FeedForward {
            // The wind is steady, so that the air acceleration is the vehicle's.
            air_acceleration: inertial(plant.acceleration(&truth, thrust)),
            // The reference is piecewise linear.
            jerk: Inertial::ZERO,
        });
        let reference = Reference {
            velocity: inertial(velocity),
            acceleration: inertial(acceleration),
        };
        let input = Input::new(
            wrap(truth.theta) as f32,
            inertial(truth.velocity),
            inertial(plant.wind),
            reference,
            feed_forward,
        );
        let answer = controller.answer(&input)?;
        let command = answer.unwrap_or_default();
        thrust = f64::from(command.thrust);
        rows.push(Row {
            t,
            truth,
            reference_velocity: velocity,
            alpha: plant.angle_of_attack(&truth),
            thrust_to_weight: thrust / (plant.vehicle.mass * plant.vehicle.gravity),
            input,
            answer,
        });
        for _ in 0..scenario.substeps {
            truth = plant.step(&truth, thrust, f64::from(command.rate), dt);
        }
        progress(step);
    }
    Ok(rows)
}

/// `v` as the core takes it.
pub(crate) fn inertial(v: Vector) -> Inertial {
    Inertial::new(v.x as f32, v.y as f32)
}
