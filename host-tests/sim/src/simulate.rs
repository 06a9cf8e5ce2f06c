//! The loop of an experiment: the plant in double precision, its controller at a fixed rate.

use std::collections::VecDeque;

use alula::GuidanceOutput;
use alula::mission::{Gate, MissionOutput};
use alula::ned::Ned;
use alula::spatial::FeedForward;
use nalgebra::UnitQuaternion;

use crate::controllers::{Answer, Controller, Input};
use crate::experiment::{Estimates, Experiment, Faults, State, Target, V3, Weather, ned, stream};
use crate::flown_mission::{asked_of, passed, target};
use crate::plant::Command;
use crate::reference::wrap;
use crate::sensor_hold::SensorHold;

/// One control step of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Time \[s\].
    pub t: f64,
    /// The plant's state when the controller was asked.
    pub truth: State,
    /// θ of that state \[rad\], counted on through full turns.
    pub theta: f64,
    /// The wind there \[m/s\].
    pub wind: V3,
    /// Specific force over g.
    pub load_factor: f64,
    /// What the plant says in columns of its own.
    pub readings: Vec<f64>,
    /// What is to be flown.
    pub target: Target,
    /// The attitude measured: from (belly, right wing, tail) to north-east-down.
    pub measured_attitude: UnitQuaternion<f64>,
    /// What the controller was told.
    pub input: Input,
    /// What it answered.
    pub answer: Answer,
    /// What the mission asks for, if one is flown.
    pub mission: Option<MissionOutput>,
}

impl Step {
    /// v − v_r \[m/s\].
    pub fn velocity_error(&self) -> V3 {
        self.truth.velocity - self.target.velocity
    }

    /// x − x_r \[m\].
    pub fn position_error(&self) -> V3 {
        self.truth.position - self.target.position
    }

    /// Altitude over the path \[m\].
    pub fn altitude(&self) -> f64 {
        -self.position_error().z
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

/// A flight: one row per control step, the last at its end.
pub type Record = Vec<Step>;

/// Flies `experiment` under its own controller.
pub fn fly(experiment: &Experiment) -> anyhow::Result<Record> {
    fly_by(experiment, experiment.controller()?.as_mut())
}

/// Flies `experiment` under `controller`. The error is a controller that cannot be reached.
pub fn fly_by(experiment: &Experiment, controller: &mut dyn Controller) -> anyhow::Result<Record> {
    let mut record = Record::with_capacity(experiment.steps() + 1);
    simulate(experiment, controller, |step| {
        record.push(step.clone());
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
    let in_plane = experiment.in_plane();
    let feed_forward = experiment.spec()?.feed_forward();
    let gravity = experiment.vehicle.gravity_m_s2;
    let [mut noise, mut gusts, mut start] = [0, 1, 2].map(|n| stream(experiment.seed, n));
    let mut weather = Weather::new(experiment.weather, in_plane, &mut gusts);
    let steady = experiment.weather.steady();
    let sensors = &experiment.sensors;
    let mut faults = Faults::new(&sensors.faults, experiment.seed, in_plane);
    let mut estimates = Estimates::new(experiment.seed);
    let mut hold = SensorHold::default();
    let mut last_answer = None;
    // How far the wind has carried the path [m].
    let mut drift = V3::zeros();
    let period = 1.0 / experiment.control_rate_hz;
    let dt = period / f64::from(experiment.substeps);
    let mut path = experiment.path.path()?;
    let mut mission = experiment.flown_mission()?;
    let start = experiment.initial.state(&path.start(), &mut start);
    let mut plant = experiment.plant(start);

    // Commands on their way: the number of the plant's step from which each acts.
    let delay = (experiment.plant.delay_s / dt).round() as usize;
    let mut pending: VecDeque<(usize, Command)> = VecDeque::new();
    let mut command = Command {
        thrust: start.thrust,
        rates: V3::zeros(),
    };
    let mut plant_step = 0;
    let mut theta = experiment.initial.theta_deg.to_radians();
    for step in 0..=experiment.steps() {
        let t = step as f64 / experiment.control_rate_hz;
        let truth = *plant.state();
        theta += wrap(truth.theta() - theta);
        let wind = weather.wind(t);
        let force = plant.specific_force(wind);
        let measured = sensors.measure(
            &truth,
            force,
            wind,
            steady,
            in_plane,
            (&mut noise, &mut estimates),
            period,
        );
        let measured = hold.state(&mut faults, t, measured);
        let asked = mission.as_mut().map(|mission| {
            let wind = ned(estimates.last_wind());
            mission.step(t, period, &measured, wind, last_answer.as_ref())
        });
        let mut target = match &asked {
            Some(asked) => target(asked, &measured),
            None => path.advance(t, period, |target| {
                let error = measured.position - drift - target.position;
                controller.pace(ned(error), ned(target.velocity)).into()
            }),
        };
        if experiment.path_in_air && asked.is_none() {
            let along = target.velocity.normalize();
            let ahead = (measured.position - drift - target.position).dot(&along);
            drift += ahead * along;
            target.position += drift;
            target.velocity += estimates.last_wind();
            drift += estimates.last_wind() * period;
        }
        let mut input = Input {
            sample: hold.input(sensors, &faults, t, &target),
            feed_forward: feed_forward.then(|| {
                let [i, j, w] = truth.axes();
                let acceleration = force.x * i + force.y * j + force.z * w + gravity * V3::z();
                FeedForward {
                    // As an accelerometer gives it; the air's own acceleration is not known to it.
                    air_acceleration: ned(acceleration),
                    // The reference is piecewise linear.
                    jerk: Ned::default(),
                }
            }),
        };
        if let Some(asked) = &asked {
            asked_of(asked, &mut input);
        }
        let gate = asked.as_ref().map_or(Gate::Open, |asked| asked.gate);
        let clock = faults.clock(t, period);
        if let Some(bit) = clock.flips {
            controller.flip(bit);
        }
        for dt in clock.steps.into_iter().flatten() {
            // On the ground nobody is asked: the state stays that of power-on.
            last_answer = Some(match gate {
                Gate::Off => passed(gate, GuidanceOutput::default().into()),
                _ => passed(gate, controller.answer(&input, dt as f32)?),
            });
        }
        let answer = last_answer.expect("asked at the first step at the latest");
        let go_on = visit(&Step {
            t,
            truth,
            theta,
            wind,
            load_factor: force.norm() / gravity,
            readings: plant.readings(),
            target,
            measured_attitude: measured.attitude,
            input,
            answer,
            mission: asked,
        });
        if !truth.is_sound() {
            return Ok(End::Diverged(t));
        }
        if !go_on {
            return Ok(End::Left);
        }

        pending.push_back((plant_step + delay, (&answer).into()));
        for _ in 0..experiment.substeps {
            while let Some(&(_, next)) = pending.front().filter(|c| c.0 <= plant_step) {
                command = next;
                pending.pop_front();
            }
            plant.step(&command, wind, dt);
            plant_step += 1;
        }
        weather.advance((plant.state().velocity - wind).norm(), period, &mut gusts);
    }
    Ok(End::Flown)
}

impl From<&Answer> for Command {
    fn from(answer: &Answer) -> Self {
        let rates = answer.rates;
        Self {
            thrust: answer.thrust.into(),
            rates: V3::new(rates.j.into(), rates.w.into(), rates.i.into()),
        }
    }
}
