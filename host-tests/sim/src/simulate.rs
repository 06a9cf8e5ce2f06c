//! The loop of an experiment: the plant in double precision, its controller at a fixed rate.

use std::collections::VecDeque;

use alula::guidance::Air;
use alula::{Attitude, FeedForward, Inertial, PlanarGuidanceInput, Reference};

use crate::controllers::{Answer, Controller, Input, inertial};
use crate::experiment::{Experiment, FaultKind, Faults, Measured, Plant, State, Weather, stream};
use crate::reference::{Vector, wrap};

/// One control step of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Time \[s\].
    pub t: f64,
    /// The plant's state when the controller was asked.
    pub truth: State,
    /// The wind there \[m/s\].
    pub wind: Vector,
    /// Reference velocity \[m/s\].
    pub reference_velocity: Vector,
    /// Reference acceleration \[m/s²\].
    pub reference_acceleration: Vector,
    /// Reference position \[m\]: the reference velocity's integral.
    pub reference_position: Vector,
    /// What the controller was told.
    pub input: Input,
    /// What it answered.
    pub answer: Answer,
}

impl Step {
    /// v − v_r \[m/s\].
    pub fn velocity_error(&self) -> Vector {
        self.truth.velocity - self.reference_velocity
    }

    /// x − x_r \[m\]. Its first component is the loss of altitude.
    pub fn position_error(&self) -> Vector {
        self.truth.position - self.reference_position
    }
}

/// How a simulation ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At the end of the flight.
    Flown,
    /// `visit` ended it.
    Left,
    /// At this time \[s\]: the plant's state was not finite, or its speed beyond that of any aircraft.
    Diverged(f64),
}

/// Speed \[m/s\] from which a simulation has diverged: ten minutes of free fall do not reach it.
const DIVERGED: f64 = 1e4;

/// Whether the state is one of an aircraft.
fn is_sound(state: &State) -> bool {
    let State {
        theta,
        rate,
        thrust,
        ..
    } = *state;
    let finite = [theta, rate, thrust].iter().all(|x| x.is_finite());
    finite && state.position.iter().all(|x| x.is_finite()) && state.velocity.norm() < DIVERGED
}

/// A flight: one row per control step, the last at its end.
pub type Record = Vec<Step>;

/// Flies `experiment` under its own controller.
pub fn fly(experiment: &Experiment) -> anyhow::Result<Record> {
    let mut controller = experiment.controller()?;
    let mut record = Record::with_capacity(experiment.steps() + 1);
    simulate(experiment, controller.as_mut(), |step| {
        record.push(*step);
        true
    })?;
    Ok(record)
}

/// Flies `experiment` under `controller`: `visit` is given every control step, the last at the end of the flight, and says whether to go
/// on. A step at which the plant has diverged is the last one. The error is a controller that cannot be reached.
pub fn simulate(
    experiment: &Experiment,
    controller: &mut dyn Controller,
    mut visit: impl FnMut(&Step) -> bool,
) -> anyhow::Result<End> {
    let feed_forward = experiment.spec()?.feed_forward();
    let plant = Plant::new(&experiment.vehicle.reference(), experiment.plant);
    let [mut noise, mut gusts] = [0, 1].map(|number| stream(experiment.seed, number));
    let mut weather = Weather::new(experiment.weather, &mut gusts);
    let steady = Vector::from(experiment.weather.steady_m_s);
    let mut faults = Faults::new(&experiment.sensors.faults, experiment.seed, 2);
    let mut telling = Telling::default();
    let mut last_answer = None;
    let mut reference_position = experiment.reference.positions();

    let period = 1.0 / experiment.control_rate_hz;
    let dt = period / f64::from(experiment.substeps);
    // Commands on their way: the number of the plant's step from which each acts.
    let delay = (experiment.plant.delay_s / dt).round() as usize;
    let mut pending: VecDeque<(usize, f64, f64)> = VecDeque::new();
    let (mut thrust, mut rate) = (experiment.initial.thrust_n, 0.0);
    let mut plant_step = 0;

    let initial = &experiment.initial;
    let mut truth = State {
        velocity: initial.velocity(),
        position: Vector::zeros(),
        theta: initial.theta_deg.to_radians(),
        rate: initial.rate_rad_s,
        thrust,
    };
    for step in 0..=experiment.steps() {
        let t = step as f64 / experiment.control_rate_hz;
        let wind = weather.wind(t);
        let (velocity, acceleration) = experiment.reference.at(t);
        let reference_position = reference_position(t);
        let measured = experiment.sensors.measure(
            &truth,
            plant.specific_force(&truth, wind),
            wind,
            steady,
            &mut noise,
        );
        let reference = Reference {
            velocity: inertial(velocity),
            acceleration: inertial(acceleration),
        };
        let told = (measured, reference, reference_position);
        let sample = telling.sample(experiment, &mut faults, t, told);
        let input = Input {
            theta: telling.theta,
            sample,
            feed_forward: feed_forward.then(|| FeedForward {
                // As an accelerometer gives it; the air's own acceleration is not known to it.
                air_acceleration: inertial(plant.acceleration(&truth, wind)),
                // The reference is piecewise linear.
                jerk: Inertial::ZERO,
            }),
        };
        let clock = faults.clock(t, period);
        if let Some(bit) = clock.flips {
            controller.flip(bit);
        }
        for dt in clock.steps.into_iter().flatten() {
            last_answer = Some(controller.answer(&input, dt as f32)?);
        }
        let answer = last_answer.expect("asked at the first step at the latest");
        let go_on = visit(&Step {
            t,
            truth,
            wind,
            reference_velocity: velocity,
            reference_acceleration: acceleration,
            reference_position,
            input,
            answer,
        });
        if !is_sound(&truth) {
            return Ok(End::Diverged(t));
        }
        if !go_on {
            return Ok(End::Left);
        }

        let command = (f64::from(answer.thrust), f64::from(answer.rate));
        pending.push_back((plant_step + delay, command.0, command.1));
        for _ in 0..experiment.substeps {
            while let Some(&(_, t, r)) = pending.front().filter(|c| c.0 <= plant_step) {
                (thrust, rate) = (t, r);
                pending.pop_front();
            }
            truth = plant.step(&truth, thrust, rate, wind, dt);
            plant_step += 1;
        }
        weather.advance((truth.velocity - wind).norm(), period, &mut gusts);
    }
    Ok(End::Flown)
}

/// What the controller was told last, which a fault may repeat.
#[derive(Default)]
struct Telling {
    /// θ as told last \[rad\].
    theta: f32,
    measured: Option<(f64, Measured)>,
    reference: Reference,
    /// When that was sent \[s\].
    reference_time: f64,
}

impl Telling {
    /// What the controller is told at `t`, with the faults that last then.
    fn sample(
        &mut self,
        experiment: &Experiment,
        faults: &mut Faults<Measured>,
        t: f64,
        (fresh, reference, reference_position): (Measured, Reference, Vector),
    ) -> PlanarGuidanceInput {
        let fresh = faults.distort(t, fresh);
        let fails = |kind| faults.lasts(kind, t);
        let (measured_at, mut measured) = match self.measured {
            Some(old) if fails(FaultKind::StateStale) => old,
            _ => (t, fresh),
        };
        self.measured = Some((measured_at, measured));
        if fails(FaultKind::Air) {
            measured.air = Air::Unknown;
        }
        if !fails(FaultKind::ReferenceStale) {
            (self.reference, self.reference_time) = (reference, t);
        }
        let nan = |value: f32, kind| if fails(kind) { f32::NAN } else { value };
        self.theta = nan(wrap(measured.theta) as f32, FaultKind::AttitudeNan);
        let error = inertial(measured.position - reference_position);
        PlanarGuidanceInput {
            velocity: Inertial::new(
                nan(measured.velocity.x as f32, FaultKind::VelocityNan),
                measured.velocity.y as f32,
            ),
            attitude: Attitude::from_angle(self.theta),
            state_age: (t - measured_at) as f32,
            air: measured.air,
            specific_force: measured.specific_force,
            position_error: experiment.sensors.position.told(Inertial::new(
                nan(error.down(), FaultKind::PositionNan),
                error.forward(),
            )),
            reference: self.reference,
            reference_age: (t - self.reference_time) as f32,
            ..PlanarGuidanceInput::default()
        }
    }
}
