//! Aerodynamic models and measured tables.

use ::alula::aero::TableProblem;
use ::alula::{Aerodynamics, AngleOfAttack, ModelParameters, Parameters};
use alula_sim::experiment::{AerodynamicsSpec, file_name, file_value, refused};
use alula_sim::polar::{BUILT_IN, Polar};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

use crate::arguments::{HALF_TURN, Numbers, Rows, angles, given, rows};
use crate::error;
use crate::frame::{Data, Frame};
use crate::parameters;

/// Lift and drag coefficients over the angle of attack: one of the paper's models, or a measured table.
///
/// Made by `Model.large_angle`, `Model.small_angle`, `Model.combined`, `Model.table` or `Model.load`.
#[pyclass(frozen, eq, from_py_object, module = "alula")]
#[derive(Clone, Copy, PartialEq)]
pub struct Model(pub AerodynamicsSpec);

impl Model {
    fn with<P: Parameters>(
        given: Option<&Bound<'_, PyDict>>,
        kind: fn(P) -> ModelParameters,
    ) -> PyResult<Self> {
        let parameters = kind(parameters::read(given)?);
        // What ranges cannot tell.
        let made = parameters.model().map_err(refused::<P>);
        made.map_err(error::of_field)?;
        Ok(Self(AerodynamicsSpec::of(parameters)))
    }

    /// The model as the core takes it.
    pub fn core(&self) -> PyResult<::alula::Model<'static>> {
        self.0.core().map_err(error::of_field)
    }
}

#[pymethods]
impl Model {
    /// A flat plate: c_L = c1 sin 2α, c_D = c0 + 2 c1 sin² α.
    ///
    /// Parameters by keyword, those left out at their defaults: `alula.parameters()["Large-angle model"]`.
    #[staticmethod]
    #[pyo3(signature = (**parameters))]
    fn large_angle(parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::with(parameters, ModelParameters::LargeAngle)
    }

    /// A wing below stall.
    ///
    /// Parameters by keyword, those left out at their defaults: `alula.parameters()["Small-angle model"]`.
    #[staticmethod]
    #[pyo3(signature = (**parameters))]
    fn small_angle(parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::with(parameters, ModelParameters::SmallAngle)
    }

    /// A wing below stall and a flat plate above, blended. By default NACA 0021 at Re = 160e3.
    ///
    /// Parameters by keyword, those left out at their defaults: `alula.parameters()["Combined model"]`.
    #[staticmethod]
    #[pyo3(signature = (**parameters))]
    fn combined(parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::with(parameters, ModelParameters::Combined)
    }

    /// Measured coefficients, interpolated with continuous second derivatives.
    ///
    /// `alpha_deg` increases from 0 to 180 for a symmetric section, from -180 to 180 for any other; `cl` and `cd` are as
    /// long, `cd` positive. A table stays in memory, 60 kB, until the interpreter ends.
    #[staticmethod]
    fn table(alpha_deg: Vec<f64>, cl: Vec<f64>, cd: Vec<f64>) -> PyResult<Self> {
        for (field, column) in [("cl", &cl), ("cd", &cd)] {
            if column.len() != alpha_deg.len() {
                let (n, rows) = (column.len(), alpha_deg.len());
                return Err(error::field(
                    field,
                    format!("has {n} rows, alpha_deg {rows}"),
                ));
            }
        }
        let rows = alpha_deg.iter().zip(&cl).zip(&cd);
        let rows: Vec<[f64; 3]> = rows.map(|((alpha, cl), cd)| [*alpha, *cl, *cd]).collect();
        let polar = Polar::new("table", &rows).map_err(|e| {
            let wrong = |column: &[f64]| column.get(e.row).is_none_or(|x| !x.is_finite());
            let field = match e.problem {
                TableProblem::NotFinite if !wrong(&alpha_deg) && wrong(&cl) => "cl",
                TableProblem::NotFinite if !wrong(&alpha_deg) => "cd",
                TableProblem::DragNotPositive => "cd",
                TableProblem::LiftOnAxis => "cl",
                TableProblem::NotPeriodic if cl.first() != cl.last() => "cl",
                TableProblem::NotPeriodic => "cd",
                TableProblem::OutOfRange => "cl, cd",
                _ => "alpha_deg",
            };
            error::field(field, format!("row {}: {}", e.row, e.problem.text()))
        })?;
        Ok(Self(AerodynamicsSpec::Table { polar }))
    }

    /// A table by name (`alula.polars()`), or from a CSV file with the columns `alpha_deg`, `cl` and `cd`.
    #[staticmethod]
    fn load(source: PathBuf) -> PyResult<Self> {
        let polar = Polar::load(&source.to_string_lossy());
        let polar = polar.map_err(|e| error::of_argument("source", e))?;
        Ok(Self(AerodynamicsSpec::Table { polar }))
    }

    /// The model's parameters by name; those of a table are None.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Ok(p) = self.0.parameters() else {
            return Ok(None);
        };
        parameters::values(py, p.rows(), |row| p.get(row)).map(Some)
    }

    fn __repr__(&self) -> String {
        let AerodynamicsSpec::Table { polar } = &self.0 else {
            let p = self.0.parameters().expect("no table");
            let rows = p.rows().iter().enumerate();
            let values =
                rows.map(|(i, row)| format!("{} {}", file_name(row), file_value(row, p.get(i))));
            let values: Vec<String> = values.collect();
            return format!("<alula.Model {}>", values.join(", "));
        };
        format!("<alula.Model {}, {} rows>", polar.name, polar.rows.len())
    }

    /// The coefficients at angles of attack [rad], a number or an array of n: columns `cl`, `cd`, and their derivatives `dcl`, `dcd`
    /// [1/rad], `ddcl`, `ddcd` [1/rad²], in single precision.
    fn coefficients(&self, py: Python<'_>, alpha_rad: Numbers<'_>) -> PyResult<Frame> {
        let n = rows(&[given("alpha_rad", &alpha_rad, 1)])?;
        angles("alpha_rad", &alpha_rad, HALF_TURN)?;
        let (alpha, model) = (Rows::new(&alpha_rad, 1), self.core()?);
        let mut columns = [const { Vec::new() }; 6];
        py.detach(|| {
            for k in 0..n {
                let [alpha] = alpha.get(k);
                let c = model.coefficients(AngleOfAttack::from_radians(alpha));
                let values = [c.c_l, c.c_d, c.dc_l, c.dc_d, c.ddc_l, c.ddc_d];
                columns
                    .iter_mut()
                    .zip(values)
                    .for_each(|(to, x)| to.push(x));
            }
        });
        let names = ["cl", "cd", "dcl", "dcd", "ddcl", "ddcd"].map(str::to_owned);
        Ok(Frame::new(
            py,
            names.into_iter().zip(columns.map(Data::Single)),
        ))
    }
}

/// The names of the tables that come with the package.
#[pyfunction]
pub fn polars() -> Vec<&'static str> {
    BUILT_IN.iter().map(|(name, _)| *name).collect()
}
