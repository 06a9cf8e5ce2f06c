//! The loop of a flight in space: the plant in double precision, the guidance at a fixed rate.

use std::collections::VecDeque;

use alula::GuidanceInput;
use alula::guidance::GuidanceOutput;
use alula::spatial::Body;
use nalgebra::UnitQuaternion;

use super::controller::Pilot;
use super::path::Target;
use super::plant::SpatialState;
use super::telling::Telling;
use super::weather::Weather;
use super::{Experiment, V3, ned};
use crate::experiment::{Faults, stream};

/// One control step of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Time \[s\].
    pub t: f64,
    /// The plant's state when the guidance was asked.
    pub truth: SpatialState,
    /// The wind there \[m/s\].
    pub wind: V3,
    /// Specific force over g.
    pub load_factor: f64,
    /// What is to be flown.
    pub target: Target,
    /// The attitude measured: from (belly, right wing, tail) to north-east-down.
    pub measured_attitude: UnitQuaternion<f64>,
    /// What the guidance was told.
    pub input: GuidanceInput,
    /// What it answered.
    pub guided: GuidanceOutput,
}

/// A flight: one row per control step, the last at its end.
pub type Record = Vec<Step>;

/// Flies `experiment` under its own guidance.
pub fn fly(experiment: &Experiment) -> anyhow::Result<Record> {
    fly_by(experiment, &mut experiment.pilot()?)
}

/// Flies `experiment` under `pilot`. The error is a pilot that cannot be reached.
pub fn fly_by(experiment: &Experiment, pilot: &mut dyn Pilot) -> anyhow::Result<Record> {
    // How fast the path goes on is asked of the guidance here: it has no memory for that.
    let guidance = experiment.controller.guidance(experiment)?;
    let plant = experiment.plant();
    let [mut noise, mut gusts, mut start] = [0, 1, 2].map(|n| stream(experiment.seed, n));
    let mut weather = Weather::new(experiment.weather, &mut gusts);
    let sensors = &experiment.sensors;
    let mut faults = Faults::new(&sensors.faults, experiment.seed, 3);
    let mut telling = Telling::default();
    let mut answer = None;
    let period = 1.0 / experiment.control_rate_hz;
    let dt = period / f64::from(experiment.substeps);
    let mut path = experiment.path.path()?;
    let mut truth = experiment.initial.state(&path.start(), &mut start);

    // Commands on their way: the number of the plant's step from which each acts.
    let delay = (experiment.plant.delay_s / dt).round() as usize;
    let mut pending: VecDeque<(usize, f64, V3)> = VecDeque::new();
    let (mut thrust, mut rates) = (truth.thrust, V3::zeros());
    let mut plant_step = 0;
    let mut record = Record::with_capacity(experiment.steps() + 1);
    for step in 0..=experiment.steps() {
        let t = step as f64 / experiment.control_rate_hz;
        let wind = weather.wind(t);
        let specific_force = V3::from(plant.specific_force(&truth, wind));
        let steady = experiment.weather.steady();
        let measured = sensors.measure(&truth, specific_force, wind, steady, &mut noise);
        let measured = telling.state(&mut faults, t, measured);
        let target = path.advance(period, |target| {
            let error = measured.position - target.position;
            guidance
                .path_time_scale(ned(error), ned(target.velocity))
                .into()
        });
        let input = telling.input(sensors, &faults, t, &target);
        let clock = faults.clock(t, period);
        if let Some(bit) = clock.flips {
            pilot.flip(bit);
        }
        for dt in clock.steps.into_iter().flatten() {
            answer = Some(pilot.guided(&input, dt as f32)?);
        }
        let guided = answer.expect("asked at the first step at the latest");
        record.push(Step {
            t,
            truth,
            wind,
            load_factor: specific_force.norm() / experiment.vehicle.gravity_m_s2,
            target,
            measured_attitude: measured.attitude,
            input,
            guided,
        });

        let Body { i, j, w } = guided.command.rates;
        let asked = V3::new(j.into(), w.into(), i.into());
        pending.push_back((plant_step + delay, guided.command.thrust.into(), asked));
        for _ in 0..experiment.substeps {
            while let Some(&(_, t, r)) = pending.front().filter(|c| c.0 <= plant_step) {
                (thrust, rates) = (t, r);
                pending.pop_front();
            }
            truth = plant.step(&truth, thrust, rates, wind, dt);
            plant_step += 1;
        }
        weather.advance((truth.velocity - wind).norm(), period, &mut gusts);
    }
    Ok(record)
}
