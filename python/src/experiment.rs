//! Experiments, by name, file or text, with fields changed.

use std::path::PathBuf;

use alula_sim::experiment::plan::of_plan;
use alula_sim::experiment::{BUILT_IN, DEFAULT, Document};
use alula_sim::named::Named;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use pythonize::pythonize;

use crate::arguments::value;
use crate::error;
use crate::flight::{self, Flight};

/// A flight to be flown: vehicle, actuators, sensors, weather, reference or path, and controller, as TOML says it.
///
/// `source` is the name of a built-in experiment (`alula.experiments()`) or a file. `set` changes fields: a dictionary by dotted
/// path, `{"vehicle.mass_kg": 11, "plant.thrust_n[1]": 112.8}`, or assignments as on the command line,
/// `["vehicle.mass_kg=11"]`. `vehicle` is the experiment whose vehicle flies the mission of a ground station's `.plan`. An experiment with a `path` is flown in space, one with a `reference` in the vertical plane.
#[pyclass(frozen, module = "alula")]
pub struct Experiment(pub Document);

/// Does what `PATH=VALUE` says.
fn assign(document: &mut Document, assignment: &str) -> PyResult<()> {
    if !assignment.contains('=') {
        return Err(error::field(
            "set",
            format!("{assignment}: must be PATH=VALUE"),
        ));
    }
    let done = document.assign(assignment);
    done.map_err(|e| error::of_argument("set", e))
}

/// Changes what `set` says.
fn change(document: &mut Document, set: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    let Some(set) = set else { return Ok(()) };
    if let Ok(fields) = set.cast::<PyDict>() {
        for (path, given) in fields {
            let path: String = path.extract()?;
            let value = value(&path, &given)?;
            let done = document.change("set", &path, value);
            done.map_err(error::of)?;
        }
        return Ok(());
    }
    if let Ok(one) = set.cast::<PyString>() {
        return assign(document, &one.to_string());
    }
    for assignment in set.try_iter()? {
        let assignment: String = assignment?.extract()?;
        assign(document, &assignment)?;
    }
    Ok(())
}

#[pymethods]
impl Experiment {
    #[new]
    #[pyo3(signature = (source=DEFAULT.into(), set=None, *, vehicle=None))]
    pub fn new(
        source: PathBuf,
        set: Option<&Bound<'_, PyAny>>,
        vehicle: Option<PathBuf>,
    ) -> PyResult<Self> {
        let plan = source.extension().is_some_and(|end| end == "plan");
        let document = match (plan, vehicle) {
            (true, Some(vehicle)) => of_plan(&source, &vehicle.to_string_lossy()).map(|(d, _)| d),
            (false, None) => Document::load(&source.to_string_lossy()),
            (true, None) => {
                let problem = "is missing: the experiment whose vehicle flies the plan";
                return Err(error::field("vehicle", problem));
            }
            (false, Some(_)) => {
                let problem = "is for the mission of a .plan: an experiment has its own";
                return Err(error::field("vehicle", problem));
            }
        };
        let document = document.map_err(|e| error::of_argument("source", e))?;
        let given = Self(document);
        given.changed(set).map(Self)
    }

    /// The experiment of a TOML text, whose `base` is a built-in or a file.
    #[staticmethod]
    #[pyo3(signature = (text, name="experiment", set=None))]
    fn from_toml(text: String, name: &str, set: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let named = Named {
            name: name.to_owned(),
            origin: name.to_owned(),
            text,
            file: None,
        };
        let document = Document::new(&named);
        let mut document = document.map_err(|e| error::of_argument("text", e))?;
        change(&mut document, set)?;
        Ok(Self(document))
    }

    /// Its name: that of the file or built-in.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// The whole experiment as TOML, without a base.
    #[getter]
    fn toml(&self) -> String {
        self.0.text()
    }

    /// The value at a dotted path, as in "plant.thrust_n[1]"; None if the experiment leaves it out.
    fn get<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let value = self.0.get(path).map(|value| pythonize(py, value));
        Ok(value.transpose()?)
    }

    /// Flies it. Raises `alula.FieldError` with the field that is wrong.
    fn fly(&self, py: Python<'_>) -> PyResult<Flight> {
        flight::fly(py, &self.0)
    }

    fn __repr__(&self) -> String {
        let about = self.0.get("description").and_then(|text| text.as_str());
        let about = about.map_or(String::new(), |text| format!(": {text}"));
        format!("<alula.Experiment {}{about}>", self.0.name)
    }
}

impl Experiment {
    /// Its document with what `set` says changed.
    pub fn changed(&self, set: Option<&Bound<'_, PyAny>>) -> PyResult<Document> {
        let mut document = self.0.clone();
        change(&mut document, set)?;
        Ok(document)
    }
}

/// Flies an experiment: `Experiment(source, set).fly()`.
#[pyfunction]
#[pyo3(signature = (source=DEFAULT.into(), set=None))]
pub fn fly(py: Python<'_>, source: PathBuf, set: Option<&Bound<'_, PyAny>>) -> PyResult<Flight> {
    Experiment::new(source, set, None)?.fly(py)
}

/// Name and description of every built-in experiment; those with neither reference nor path are vehicles.
#[pyfunction]
pub fn experiments(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for (name, _) in BUILT_IN {
        let document = Document::load(name).map_err(error::of)?;
        let description = document.get("description").and_then(|text| text.as_str());
        dict.set_item(name, description.unwrap_or_default())?;
    }
    Ok(dict)
}
