//! A vehicle of one's own, from what is known of it.

use std::path::PathBuf;

use alula_design::{Design as Made, FirstFlight, Known, check_name};
use alula_sim::experiment::{Document, FieldError, read};
use alula_study::files::leave_all;
use pyo3::exceptions::PyFileExistsError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use toml::Value;

use crate::arguments::table;
use crate::error;
use crate::experiment::Experiment;
use crate::flight::{self, Flight};
use crate::frame::json;
use crate::parameters;
use crate::vehicle::Vehicle;

/// A vehicle of one's own, made by `new`, with what its first flight came to.
#[pyclass(frozen, module = "alula")]
pub struct Design {
    made: Made,
    document: Document,
    /// Its name.
    #[pyo3(get)]
    name: String,
    /// Its first flight.
    #[pyo3(get)]
    flight: Py<Flight>,
    /// What came of that in a word: "as-asked", "outside-goals" or "fails".
    #[pyo3(get)]
    outcome: Py<PyAny>,
    /// The same in a sentence.
    #[pyo3(get)]
    verdict: String,
    /// How its wing came about, in sentences.
    #[pyo3(get)]
    story: Vec<String>,
    /// What is to be doubted, in sentences.
    #[pyo3(get)]
    warnings: Vec<String>,
    /// What it can do, as `alula-sil new --json` says it: speed of transition, cruise, turn, glide and stop.
    #[pyo3(get)]
    performance: Py<PyAny>,
    /// The largest lag and delay that its loop bears in level flight: a list of dictionaries, by speed.
    #[pyo3(get)]
    margins: Py<PyAny>,
}

#[pymethods]
impl Design {
    /// The vehicle.
    #[getter]
    fn vehicle(&self) -> Vehicle {
        Vehicle {
            spec: self.made.vehicle(),
            thrust: self.made.facts.thrust(),
            name: self.name.clone(),
        }
    }

    /// The parameters of its guidance, by the rules of the library: for `Guidance(design.vehicle, **design.parameters)`.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        parameters::dict(py, &self.made.parameters)
    }

    /// The experiment of its first flight: a round trip.
    #[getter]
    fn experiment(&self) -> Experiment {
        Experiment(self.document.clone())
    }

    /// Its files by name: the vehicle's and its campaign's TOML, the controller for C and for Rust, and the polar where it has one of its own.
    #[getter]
    fn files(&self) -> std::collections::BTreeMap<String, String> {
        self.made.files(&self.name).into_iter().collect()
    }

    /// Writes the files into a folder, which is made; with `force` over those that are there. Returns the path of the vehicle's own,
    /// which every command takes.
    #[pyo3(signature = (folder, *, force=false))]
    fn write(&self, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        let own = folder.join(format!("{}.toml", self.name));
        if own.exists() && !force {
            let text = format!(
                "{} is there already: force=True writes it anew",
                own.display()
            );
            return Err(PyFileExistsError::new_err(text));
        }
        let write = || {
            std::fs::create_dir_all(&folder)?;
            let mut files = self.made.files(&self.name).into_iter();
            files.try_for_each(|(file, text)| leave_all(&folder.join(file), text))
        };
        write().map_err(error::of)?;
        Ok(own)
    }

    fn __repr__(&self) -> String {
        let facts = &self.made.facts;
        format!(
            "<alula.Design {}: {} kg, {} m², {}, T/W {}, {} m/s. {}>",
            self.name,
            facts.mass_kg,
            facts.wing_m2,
            facts.section,
            facts.thrust_to_weight,
            facts.cruise_m_s,
            self.verdict
        )
    }
}

/// A vehicle of one's own from numbers of the kitchen scale: vehicle, guidance by rule, a first flight, and what is to be doubted; what
/// `alula-sil new` does. It flies some seconds of processor time.
///
/// By keyword, as the command's flags: `mass_kg`, `wing_m2`, `section` ("naca-0012", "flat-plate", a polar's file …), `thrust_to_weight`,
/// `thrust_lag_s`, `rate_lag_s`, `cruise_m_s`, `turn_rad_s2` and `actuators` ("elevons", "motors", "both") must be known. Numbers far outside of what flies are refused with what was probably meant.
#[pyfunction]
#[pyo3(signature = (name="my-vehicle", **known))]
pub fn new(py: Python<'_>, name: &str, known: Option<&Bound<'_, PyDict>>) -> PyResult<Design> {
    check_name(name).map_err(error::of_field)?;
    let fields = known.map(table).transpose()?.unwrap_or_default();
    let facts = read::<Known>(Value::Table(fields)).and_then(Known::facts);
    let facts = facts.map_err(|e| error::of_field(in_python(e)))?;
    let done = py.detach(|| {
        let (made, flown) = Made::new(facts)?.as_it_brakes(name);
        let first = FirstFlight::of(&made, flown?)?;
        Ok((made, first))
    });
    let (made, first) = done.map_err(error::of)?;
    let findings = &first.findings;
    let flight = flight::of(py, name, &first.experiment, &first.record, &first.figures)?;
    Ok(Design {
        name: name.to_owned(),
        flight: Py::new(py, flight)?,
        outcome: json(py, &findings.verdict.outcome)?,
        verdict: findings.verdict.text(),
        performance: json(py, &findings.performance)?,
        margins: json(py, &findings.margins)?,
        story: first.findings.story,
        warnings: first.findings.warnings,
        made,
        document: first.document,
    })
}

/// A refusal without the words about flags.
fn in_python(error: FieldError) -> FieldError {
    match error.problem.starts_with("is missing") {
        true => FieldError::new(error.field, "is missing"),
        false => error,
    }
}
