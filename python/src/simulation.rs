//! A simulation that goes on step by step, under one's own commands.

use std::sync::{Arc, Mutex, PoisonError};

use ::alula::ned::{BodyAxes, BodyRates};
use alula_sim::controllers::{Answer, Controller, Report};
use alula_sim::experiment::{self, V3, attitude_to_frd, to_frd};
use alula_sim::simulate::{Flight, Step};
use nalgebra::Vector3;
use pyo3::prelude::*;

use crate::arguments::{Numbers, vector};
use crate::error;
use crate::experiment::Experiment;

/// An experiment that is flown step by step, at its own rate, by commands of one's own or by those of its own controller.
///
/// `source` is an `Experiment`, or what `Experiment` takes; `set` changes fields. `now` is what there is; `step` goes on. Vectors are (north,
/// east, down); body axes are x along the nose, y along the right wing, z to the belly.
#[pyclass(module = "alula")]
pub struct Simulation {
    experiment: Arc<experiment::Experiment>,
    name: String,
    flown: Mutex<Flown>,
    step: Step,
}

/// What goes on.
struct Flown {
    flight: Flight<Arc<experiment::Experiment>>,
    controller: Box<dyn Controller>,
}

impl Flown {
    fn ask(&mut self) -> anyhow::Result<Step> {
        self.flight.ask(self.controller.as_mut())
    }
}

/// What there is at a step of a simulation: the vehicle as it is, what it is to fly, and what the experiment's own controller, which is told
/// what its sensors say, answers.
#[pyclass(frozen, get_all, module = "alula")]
pub struct Moment {
    /// Time [s].
    time_s: f64,
    /// Position (north, east, down) [m].
    position_m: [f64; 3],
    /// Velocity over ground [m/s].
    velocity_m_s: [f64; 3],
    /// Attitude (w, x, y, z), from the body's axes to north-east-down.
    quaternion: [f64; 4],
    /// Body rates about nose, right wing and belly [rad/s].
    rates_rad_s: [f64; 3],
    /// Thrust [N].
    thrust_n: f64,
    /// The wind there, with its gusts [m/s].
    wind_m_s: [f64; 3],
    /// Where the reference is [m].
    reference_position_m: [f64; 3],
    /// Velocity of the reference [m/s].
    reference_velocity_m_s: [f64; 3],
    /// Acceleration of the reference [m/s²].
    reference_acceleration_m_s2: [f64; 3],
    /// Thrust that the experiment's controller answers [N].
    answer_thrust_n: f32,
    /// Body rates that it answers [rad/s].
    answer_rates_rad_s: [f32; 3],
    /// The mode of the guidance, "safe", "holding" or "flying"; None of another controller.
    mode: Option<&'static str>,
}

impl Moment {
    fn of(step: &Step) -> Self {
        let vector = |v: V3| [v.x, v.y, v.z];
        let truth = &step.truth;
        let q = attitude_to_frd(&truth.attitude);
        let mode = match &step.answer.report {
            Report::Guidance(guided) => Some(guided.mode.name()),
            _ => None,
        };
        Self {
            time_s: step.t,
            position_m: vector(truth.position),
            velocity_m_s: vector(truth.velocity),
            quaternion: [q.w, q.i, q.j, q.k],
            rates_rad_s: to_frd(truth.rates),
            thrust_n: truth.thrust,
            wind_m_s: vector(step.wind),
            reference_position_m: vector(step.target.position),
            reference_velocity_m_s: vector(step.target.velocity),
            reference_acceleration_m_s2: vector(step.target.acceleration),
            answer_thrust_n: step.answer.thrust,
            answer_rates_rad_s: BodyAxes::NoseForward.components(step.answer.rates),
            mode,
        }
    }
}

#[pymethods]
impl Moment {
    fn __repr__(&self) -> String {
        let [north, east, down] = self.position_m;
        let speed = Vector3::from(self.velocity_m_s).norm();
        format!(
            "<alula.Moment {:.2} s: at ({north:.1}, {east:.1}, {down:.1}) m, {speed:.1} m/s, {:.1} N>",
            self.time_s, self.thrust_n
        )
    }
}

impl Simulation {
    fn begin(name: String, experiment: experiment::Experiment) -> anyhow::Result<Self> {
        let experiment = Arc::new(experiment);
        let mut flown = Flown {
            flight: Flight::new(Arc::clone(&experiment))?,
            controller: experiment.controller()?,
        };
        let step = flown.ask()?;
        Ok(Self {
            experiment,
            name,
            flown: Mutex::new(flown),
            step,
        })
    }

    fn advance(&mut self, answer: &Answer) -> anyhow::Result<Step> {
        let flown = self.flown.get_mut();
        let flown = flown.unwrap_or_else(PoisonError::into_inner);
        flown.flight.advance(answer);
        flown.ask()
    }
}

/// An experiment, or what `Experiment` takes.
#[derive(FromPyObject)]
pub enum ExperimentArgument<'py> {
    /// An experiment.
    Experiment(PyRef<'py, Experiment>),
    /// A name or a file.
    Source(std::path::PathBuf),
}

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (source, set=None))]
    fn new(source: ExperimentArgument<'_>, set: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let document = match source {
            ExperimentArgument::Experiment(given) => given.changed(set)?,
            ExperimentArgument::Source(source) => Experiment::new(source, set, None)?.0,
        };
        let experiment = document.checked().map_err(error::of)?;
        Self::begin(document.name, experiment).map_err(error::of)
    }

    /// Begins anew; `seed` takes the place of the experiment's, which its noise and its gusts are drawn from.
    #[pyo3(signature = (seed=None))]
    fn reset(&mut self, seed: Option<u64>) -> PyResult<()> {
        let mut experiment = (*self.experiment).clone();
        experiment.seed = seed.unwrap_or(experiment.seed);
        *self = Self::begin(self.name.clone(), experiment).map_err(error::of)?;
        Ok(())
    }

    /// What there is now.
    #[getter]
    fn now(&self) -> Moment {
        Moment::of(&self.step)
    }

    /// Goes on by one step, and says what there is then. thrust_n: along the nose [N]. rates_rad_s: asked of the vehicle's rate loop,
    /// about nose, right wing and belly. Either left out is what the experiment's own controller answers.
    #[pyo3(signature = (thrust_n=None, rates_rad_s=None))]
    fn step(
        &mut self,
        thrust_n: Option<f32>,
        rates_rad_s: Option<Numbers<'_>>,
    ) -> PyResult<Moment> {
        let mut answer = self.step.answer;
        if let Some(rates) = &rates_rad_s {
            let [roll, pitch, yaw] = vector("rates_rad_s", rates)?;
            answer.rates = BodyRates::new(roll, pitch, yaw);
        }
        answer.thrust = thrust_n.unwrap_or(answer.thrust);
        let BodyRates { roll, pitch, yaw } = answer.rates;
        let numbers = [roll, pitch, yaw];
        if !answer.thrust.is_finite() {
            return Err(error::field("thrust_n", "must be finite"));
        }
        if !numbers.iter().all(|x| x.is_finite()) {
            return Err(error::field("rates_rad_s", "must be finite"));
        }
        self.step = self.advance(&answer).map_err(error::of)?;
        Ok(self.now())
    }

    /// The experiment's name.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Time of a step [s].
    #[getter]
    fn period_s(&self) -> f64 {
        1.0 / self.experiment.control_rate_hz
    }

    /// How long the experiment lasts [s]; a simulation may go on.
    #[getter]
    fn duration_s(&self) -> f64 {
        self.experiment.duration_s
    }

    /// Whether the vehicle's state is that of an aircraft: finite, and slower than any fall. From a step where it is not, do not go on.
    #[getter]
    fn sound(&self) -> bool {
        self.step.truth.is_sound()
    }

    /// The vehicle's weight [N].
    #[getter]
    fn weight_n(&self) -> f64 {
        self.experiment.vehicle.weight()
    }

    /// Least and greatest thrust [N].
    #[getter]
    fn thrust_limits_n(&self) -> [f64; 2] {
        let weight = self.experiment.vehicle.weight();
        self.experiment.thrust_limits(None, weight)
    }

    fn __repr__(&self) -> String {
        format!(
            "<alula.Simulation {}: {:.2} of {} s>",
            self.name, self.step.t, self.experiment.duration_s
        )
    }
}
