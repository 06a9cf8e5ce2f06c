//! Goals: to hover somewhere, to stop, to fly at a velocity.

use ::alula::guidance::{Goal, GoalState, PlannerOptions, Preferences};
use ::alula::ned::Ned;
use ::alula::spatial::Reference;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{Numbers, vector};
use crate::error;
use crate::guidance::{components, ned};

/// Makes, step by step, the reference that the guidance takes, of something that is to be reached: `hover`, `stop` or `fly`.
///
/// speed_m_s and climb_m_s: horizontal and vertical speed on the way to a place. acceleration_m_s2: the greatest of the
/// reference. Each is from 0.01 to 1000. braking_climb_m: the greatest climb that a braking may take, 0 for a level one; it takes 0.085 s²/m V².
/// altitude_band_m, nose_below_vertical: what the plans are to mind, as in
/// `Guidance.update`; 0 leaves the band to the guidance's parameter. At first the goal is to stop.
#[pyclass(module = "alula")]
pub struct Goals {
    goals: ::alula::guidance::Goals,
    preferences: Preferences,
    goal: Goal,
    state: GoalState,
}

/// What `Guidance.update` takes by keyword: a reference, the error of the position, and what the plans are to mind.
pub fn asked<'py>(
    py: Python<'py>,
    reference: &Reference,
    position_error: Ned,
    options: &PlannerOptions,
) -> PyResult<Bound<'py, PyDict>> {
    let asked = PyDict::new(py);
    asked.set_item("reference_velocity", components(reference.velocity))?;
    asked.set_item("reference_acceleration", components(reference.acceleration))?;
    asked.set_item("heading", reference.heading.angle())?;
    asked.set_item("position_error", components(position_error))?;
    asked.set_item("altitude_band", options.altitude_band)?;
    asked.set_item("nose_below_vertical", options.nose_below_vertical)?;
    asked.set_item("hold_altitude_only", options.hold_altitude_only)?;
    Ok(asked)
}

/// A place or velocity of which every component is a number.
fn finite(field: &str, value: &Numbers) -> PyResult<Ned> {
    let given = vector(field, value)?;
    match given.iter().all(|x| x.is_finite()) {
        true => Ok(ned(given)),
        false => Err(error::field(field, "must be finite")),
    }
}

#[pymethods]
impl Goals {
    #[new]
    #[pyo3(signature = (speed_m_s=20.0, climb_m_s=3.0, acceleration_m_s2=2.0, *, braking_climb_m=0.0, altitude_band_m=0.0, nose_below_vertical=false))]
    fn new(
        speed_m_s: f32,
        climb_m_s: f32,
        acceleration_m_s2: f32,
        braking_climb_m: f32,
        altitude_band_m: f32,
        nose_below_vertical: bool,
    ) -> PyResult<Self> {
        let planner_options = PlannerOptions::default()
            .altitude_band(altitude_band_m)
            .nose_below_vertical(nose_below_vertical);
        let preferences = Preferences::default()
            .speed(speed_m_s)
            .climb(climb_m_s)
            .acceleration(acceleration_m_s2)
            .braking_climb(braking_climb_m)
            .planner_options(planner_options);
        let refused = |e: ::alula::ParameterError| {
            let field = match e.parameter {
                "speed" => "speed_m_s",
                "climb" => "climb_m_s",
                "acceleration" => "acceleration_m_s2",
                "braking_climb" => "braking_climb_m",
                _ => "altitude_band_m",
            };
            error::field(field, e.to_string())
        };
        Ok(Self {
            goals: ::alula::guidance::Goals::new(preferences).map_err(refused)?,
            preferences,
            goal: Goal::Stop,
            state: GoalState::default(),
        })
    }

    /// From now on: to hover at `place`, (north, east, down) [m].
    fn hover(&mut self, place: Numbers<'_>) -> PyResult<()> {
        self.goal = Goal::Hover(finite("place", &place)?);
        Ok(())
    }

    /// From now on: to stop as soon as possible at the present altitude, or in the climb that is allowed, and to hover where that ends.
    fn stop(&mut self) {
        self.goal = Goal::Stop;
    }

    /// From now on: to fly at `velocity` over ground, (north, east, down) [m/s].
    fn fly(&mut self, velocity: Numbers<'_>) -> PyResult<()> {
        self.goal = Goal::Velocity(finite("velocity", &velocity)?);
        Ok(())
    }

    /// Whether a place is reached, or a stop is over.
    #[getter]
    fn reached(&self) -> bool {
        self.state.is_reached()
    }

    /// Forgets how far the goal has come, as after a time without steps.
    fn reset(&mut self) {
        self.state = GoalState::default();
    }

    /// What the guidance is asked for, `dt` [s] after the last step: a dictionary of keywords for `Guidance.update`. position: (north,
    /// east, down) [m], velocity: over ground [m/s].
    #[pyo3(signature = (dt, *, position, velocity))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        dt: f32,
        position: Numbers<'_>,
        velocity: Numbers<'_>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let position = ned(vector("position", &position)?);
        let velocity = ned(vector("velocity", &velocity)?);
        let step = self
            .goals
            .step(&mut self.state, &self.goal, position, velocity, dt);
        asked(
            py,
            &step.reference,
            step.position_error,
            &step.planner_options,
        )
    }

    fn __repr__(&self) -> String {
        let goal = match self.goal {
            Goal::Hover(place) => format!("hover at {:?} m", components(place)),
            Goal::Velocity(velocity) => format!("fly at {:?} m/s", components(velocity)),
            _ => "stop".to_owned(),
        };
        let Preferences {
            speed,
            climb,
            acceleration,
            ..
        } = self.preferences;
        format!("<alula.Goals {goal}: {speed} m/s, climb {climb} m/s, {acceleration} m/s²>")
    }
}
