//! The vehicle.

use std::path::PathBuf;

use ::alula::VehicleParameters;
use alula_sim::airframe::Airframe;
use alula_sim::experiment::{self, VehicleSpec};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error;
use crate::model::Model;
use crate::parameters;

/// Mass, aerodynamic constant, thrust line, thrust limits and coefficients.
///
/// Parameters by keyword, `alula.parameters()["Vehicle"]`: `mass_kg`, `k_a_kg_m` (half the air density times the reference
/// area) and `thrust_max_n` must be given. The angle `delta_deg` is from the zero-lift line to the thrust line.
#[pyclass(frozen, from_py_object, module = "alula")]
#[derive(Clone)]
pub struct Vehicle {
    /// As files have it.
    pub spec: VehicleSpec,
    /// Least and most thrust [N].
    pub thrust: [f64; 2],
    /// Its name.
    pub name: String,
}

impl Vehicle {
    /// The vehicle as guidance and analyses take it.
    pub fn core(&self) -> PyResult<experiment::Vehicle> {
        self.spec.limited(self.thrust).map_err(error::of_field)
    }
}

#[pymethods]
impl Vehicle {
    #[new]
    #[pyo3(signature = (model=None, **parameters))]
    fn new(model: Option<Model>, parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let p: VehicleParameters = parameters::read(parameters)?;
        let aerodynamics = model.map_or_else(Default::default, |model| model.0);
        let vehicle = Self {
            spec: VehicleSpec::of(&p, aerodynamics),
            thrust: [p.thrust_min.into(), p.thrust_max.into()],
            name: "vehicle".to_owned(),
        };
        vehicle.core()?;
        Ok(vehicle)
    }

    /// The vehicle that a name or a file says: a built-in experiment, vehicle or polar (the paper's vehicle with that section), an
    /// experiment's TOML, a polar's CSV. Motors without limits are taken for those of 0 to twice the weight.
    #[staticmethod]
    #[pyo3(signature = (source="paper".into()))]
    pub fn load(source: PathBuf) -> PyResult<Self> {
        let airframe = Airframe::load(&source.to_string_lossy());
        let airframe = airframe.map_err(|e| error::of_argument("source", e))?;
        Ok(Self {
            thrust: airframe.thrust_limits(),
            spec: airframe.spec,
            name: airframe.name,
        })
    }

    /// Its name: that of the file or built-in it was loaded from.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Its coefficients.
    #[getter]
    fn model(&self) -> Model {
        Model(self.spec.aerodynamics)
    }

    /// Its parameters by name.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        parameters::dict(py, &self.spec.parameters(self.thrust))
    }

    fn __repr__(&self) -> String {
        let VehicleSpec {
            mass_kg, k_a_kg_m, ..
        } = self.spec;
        format!(
            "<alula.Vehicle {}: {mass_kg} kg, k_a {k_a_kg_m} kg/m, thrust {:.1} to {:.1} N>",
            self.name, self.thrust[0], self.thrust[1]
        )
    }
}

/// A vehicle, or what `Vehicle.load` takes.
#[derive(FromPyObject)]
pub enum VehicleArgument<'py> {
    /// A vehicle.
    Vehicle(PyRef<'py, Vehicle>),
    /// A name or a file.
    Source(PathBuf),
}

impl VehicleArgument<'_> {
    /// The vehicle.
    pub fn vehicle(self) -> PyResult<Vehicle> {
        match self {
            Self::Vehicle(vehicle) => Ok(vehicle.clone()),
            Self::Source(source) => Vehicle::load(source),
        }
    }
}
