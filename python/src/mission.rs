//! Missions: from take-off to landing, at airspeeds, in wind.

use std::path::{Path, PathBuf};

use ::alula::mission::{
    Gate, MissionInput, MissionOutput as Output, MissionState, Missions, Troubles,
};
use ::alula::ned::BodyRates;
use alula_sim::experiment::plan::plan;
use alula_sim::experiment::{Document, FieldError, MissionSpec, read};
use alula_sim::named::text_of;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use toml::{Table, Value};

use crate::arguments::{Numbers, table, value, vector, vector_or_zero};
use crate::error;
use crate::goals::asked;
use crate::guidance::{body_axes, ned, orientation};
use crate::vehicle::Vehicle;

/// A list of things to fly, checked against a vehicle, and how far it has come.
///
/// `items` are those of a mission's file: dictionaries like {"take-off": {"height_m": 30}}, {"waypoint": {"north_m": 300, "east_m": 0,
/// "height_m": 60}}, {"loiter": …}, {"speed": …}, {"height": …}, {"land": {}}, and "return". `responses` says what is done when something
/// fails, as {"link": "return"}; parameters by keyword, `alula.parameters()["Mission"]`: `cruise_speed_m_s` must be given. What cannot
/// be flown is refused by item and field.
#[pyclass(module = "alula")]
pub struct Mission {
    missions: Missions,
    mission: ::alula::mission::Mission,
    /// The items as files have them.
    items: Value,
    state: MissionState,
}

/// What a step of a mission says.
#[pyclass(frozen, get_all, module = "alula")]
pub struct MissionOutput {
    /// What the guidance is asked for: a dictionary of keywords for `Guidance.update`.
    asked: Py<PyDict>,
    /// What of the guidance's command reaches the motors: "off", on the ground, where the guidance is not asked; "at-most" a thrust, while it
    /// takes off and lands; or "open".
    gate: &'static str,
    /// What is done: "grounded", "spooling", "rising", "flying", "hovering", "descending" or "touched".
    activity: &'static str,
    /// Item, counted from 0; the number of items when all are done.
    item: usize,
    /// What cannot be done as asked, as "drifting" or "too_windy", or None.
    remark: Option<&'static str>,
    /// What has failed: of "link", "air", "position", "battery", "follow" and "abort".
    troubles: Vec<String>,
    /// What is done about it: "continue", "loiter", "return" or "land".
    response: &'static str,
    /// Way to the end of the item [m].
    distance_to_go_m: f32,
    /// Time that it takes [s].
    time_to_go_s: f32,
    /// Airspeed asked for [m/s]; 0 in hover.
    airspeed_m_s: f32,
    /// How far the vehicle is to the right of its path [m].
    right_m: f32,
    /// Energy that the propellers have given the air, by momentum theory [J].
    energy_j: f32,
    /// The greatest thrust that passes [N]; None where all does.
    most_thrust_n: Option<f32>,
}

impl MissionOutput {
    fn new(py: Python<'_>, step: &Output) -> PyResult<Self> {
        let (gate, most) = match step.gate {
            Gate::Off => ("off", Some(0.0)),
            Gate::AtMost(most) => ("at-most", Some(most)),
            Gate::Open => ("open", None),
        };
        let troubles = step.troubles.iter_names();
        Ok(Self {
            asked: asked(
                py,
                &step.reference,
                step.position_error,
                &step.planner_options,
            )?
            .unbind(),
            gate,
            activity: step.activity.name(),
            item: step.progress.item.into(),
            remark: step.remark.map(|remark| remark.name()),
            troubles: troubles.map(|(name, _)| name.to_lowercase()).collect(),
            response: step.response.name(),
            distance_to_go_m: step.progress.distance_to_go,
            time_to_go_s: step.progress.time_to_go,
            airspeed_m_s: step.progress.airspeed,
            right_m: step.progress.right,
            energy_j: step.progress.energy,
            most_thrust_n: most,
        })
    }
}

#[pymethods]
impl MissionOutput {
    /// What reaches the motors of the guidance's thrust [N] and body rates [rad/s], about any axes: both, as a pair.
    fn passed(&self, thrust_n: f32, rates_rad_s: [f32; 3]) -> (f32, [f32; 3]) {
        let gate = match (self.gate, self.most_thrust_n) {
            ("off", _) => Gate::Off,
            (_, Some(most)) => Gate::AtMost(most),
            _ => Gate::Open,
        };
        let [x, y, z] = rates_rad_s;
        let (thrust, rates) = gate.pass(thrust_n, BodyRates::new(x, y, z));
        (thrust, [rates.roll, rates.pitch, rates.yaw])
    }

    fn __repr__(&self) -> String {
        let remark = self
            .remark
            .map_or(String::new(), |remark| format!(", {remark}"));
        format!(
            "<alula.MissionOutput item {}: {}, {:.0} m to go{remark}>",
            self.item, self.activity, self.distance_to_go_m
        )
    }
}

impl Mission {
    /// The mission that `fields` say, as `[mission]` has them.
    fn of(vehicle: &Vehicle, fields: Table) -> PyResult<Self> {
        let make = || {
            let items = fields.get("items").cloned();
            let spec: MissionSpec = read(Value::Table(fields.clone()))?;
            let vehicle = vehicle.spec.limited(vehicle.thrust)?;
            let (missions, mission) = spec.missions(&vehicle)?;
            Ok(Self {
                missions,
                mission,
                items: items.unwrap_or(Value::Array(Vec::new())),
                state: MissionState::default(),
            })
        };
        make().map_err(error::of_field)
    }
}

/// The flags of these names.
fn flags(names: Vec<String>) -> PyResult<Troubles> {
    let flag = |name: &String| {
        let problem = "must be of link, air, position, battery, follow and abort";
        let flag = Troubles::from_name(&name.to_uppercase());
        flag.ok_or_else(|| error::field("troubles", format!("{name}: {problem}")))
    };
    names.iter().map(flag).collect()
}

#[pymethods]
impl Mission {
    #[new]
    #[pyo3(signature = (vehicle, items, *, responses=None, **parameters))]
    fn new(
        vehicle: &Vehicle,
        items: &Bound<'_, PyAny>,
        responses: Option<&Bound<'_, PyDict>>,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut fields = parameters.map(table).transpose()?.unwrap_or_default();
        fields.insert("items".to_owned(), value("items", items)?);
        if let Some(responses) = responses {
            fields.insert("responses".to_owned(), table(responses)?.into());
        }
        Self::of(vehicle, fields)
    }

    /// The mission of a ground station's `.plan`, or of an experiment with a `[mission]`, by name or file; parameters by keyword take the
    /// place of those in it.
    #[staticmethod]
    #[pyo3(signature = (source, vehicle, **parameters))]
    fn load(
        source: PathBuf,
        vehicle: &Vehicle,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut fields = table_of(&source).map_err(|e| error::of_argument("source", e))?;
        fields.extend(parameters.map(table).transpose()?.unwrap_or_default());
        Self::of(vehicle, fields)
    }

    /// Its items, as files have them.
    #[getter]
    fn items<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, &self.items)?)
    }

    /// Least and greatest airspeed of the vehicle on the wing [m/s].
    #[getter]
    fn speeds_m_s(&self) -> [f32; 2] {
        self.missions.speeds()
    }

    /// Whether all items are done.
    #[getter]
    fn done(&self) -> bool {
        self.state.item() >= self.mission.items().len()
    }

    /// Goes to an item, counted from 0. A return or a landing that was kept to is given up.
    fn go_to(&mut self, item: usize) {
        self.state.go_to(item);
    }

    /// Begins anew: the vehicle stands where the next step finds it.
    fn reset(&mut self) {
        self.state = MissionState::default();
    }

    /// What is asked for, `dt` [s] after the last step.
    ///
    /// position: (north, east, down) [m], None where it is not known. velocity: over ground [m/s]. quaternion: (w, x, y, z), from the
    /// body axes `axes` to north-east-down, as in `Guidance.update`. wind: as an autopilot estimates it [m/s]. airspeed: along the nose
    /// [m/s], None or NaN where no tube tells it. thrust_n: commanded last [N], for the energy and the touch-down. armed: whether it may take off. troubles: what has failed, of "link", "air", "battery",
    /// "abort" and so on.
    #[pyo3(signature = (
        dt, *, velocity, quaternion, position=None, wind=None, airspeed=None, thrust_n=0.0, armed=true, troubles=Vec::new(), axes="nose-forward"
    ))]
    #[expect(clippy::too_many_arguments, reason = "by keyword in Python")]
    fn step(
        &mut self,
        py: Python<'_>,
        dt: f32,
        velocity: Numbers<'_>,
        quaternion: Numbers<'_>,
        position: Option<Numbers<'_>>,
        wind: Option<Numbers<'_>>,
        airspeed: Option<f32>,
        thrust_n: f32,
        armed: bool,
        troubles: Vec<String>,
        axes: &str,
    ) -> PyResult<MissionOutput> {
        let position = position.as_ref().map(|x| vector("position", x));
        let input = MissionInput::default()
            .position(position.transpose()?.map(ned))
            .velocity(ned(vector("velocity", &velocity)?))
            .wind(ned(vector_or_zero("wind", wind.as_ref())?))
            .airspeed(airspeed)
            .orientation(orientation(&quaternion, body_axes(axes)?)?)
            .thrust(thrust_n)
            .armed(armed)
            .troubles(flags(troubles)?);
        let step = self
            .missions
            .step(&mut self.state, &self.mission, &input, dt);
        MissionOutput::new(py, step)
    }

    fn __len__(&self) -> usize {
        self.mission.items().len()
    }

    fn __repr__(&self) -> String {
        let [least, most] = self.missions.speeds();
        let name = |item: &Value| match item {
            Value::Table(table) => table.keys().next().cloned().unwrap_or_default(),
            item => item.as_str().unwrap_or_default().to_owned(),
        };
        let items = self.items.as_array().into_iter().flatten().map(name);
        let items: Vec<String> = items.collect();
        format!(
            "<alula.Mission {}; at item {}, on the wing from {least:.1} to {most:.1} m/s>",
            items.join(", "),
            self.state.item()
        )
    }
}

/// The table `[mission]` of a plan or an experiment.
fn table_of(source: &Path) -> anyhow::Result<Table> {
    if source.extension().is_some_and(|end| end == "plan") {
        return Ok(plan(&text_of(source)?)?.mission);
    }
    let document = Document::load(&source.to_string_lossy())?;
    match document.get("mission") {
        Some(Value::Table(table)) => Ok(table.clone()),
        _ => {
            let problem = format!("{} has no mission", source.display());
            Err(FieldError::new("mission", problem).into())
        }
    }
}
