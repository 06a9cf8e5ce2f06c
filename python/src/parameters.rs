//! Parameters by keyword: names, defaults, ranges and meanings are those of the core's table.

use ::alula::mission::MissionParameters;
use ::alula::planar::GainParameters;
use ::alula::{
    CombinedParameters, GuidanceParameters, LargeAngleParameters, Parameters, Row,
    SmallAngleParameters, VehicleParameters,
};
use alula_sim::experiment::{Fields, file_name, file_value};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use toml::Value;

use crate::arguments::table;
use crate::error;

/// The parameters that `given` says, each at its default if it is left out.
pub fn read<P: Parameters>(given: Option<&Bound<'_, PyDict>>) -> PyResult<P> {
    let table = given.map(table).transpose()?.unwrap_or_default();
    let read = || {
        let mut fields = Fields::new(Value::Table(table))?;
        let parameters = fields.parameters()?;
        fields.end().map(|()| parameters)
    };
    read().map_err(error::of_field)
}

/// The parameters as a dictionary, by the names that [`read`] knows.
pub fn dict<'py, P: Parameters>(py: Python<'py>, parameters: &P) -> PyResult<Bound<'py, PyDict>> {
    values(py, P::ROWS, |row| parameters.get(row))
}

/// The same of `rows`, whose values are `get`.
pub fn values<'py>(
    py: Python<'py>,
    rows: &[Row],
    get: impl Fn(usize) -> f32,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (i, row) in rows.iter().enumerate() {
        dict.set_item(file_name(row), file_value(row, get(i)))?;
    }
    Ok(dict)
}

fn rows<'py>(py: Python<'py>, rows: &[Row]) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for row in rows {
        let dict = PyDict::new(py);
        let unit = if row.unit == "rad" { "deg" } else { row.unit };
        let default = (!row.default.is_nan()).then(|| file_value(row, row.default));
        dict.set_item("name", file_name(row))?;
        dict.set_item("unit", unit)?;
        dict.set_item("least", file_value(row, row.min))?;
        dict.set_item("most", file_value(row, row.max))?;
        dict.set_item("default", default)?;
        dict.set_item("meaning", row.meaning)?;
        list.append(dict)?;
    }
    Ok(list)
}

/// Every parameter that is taken by keyword, by the heading it stands under: a list of dictionaries with name, unit, least and
/// greatest value, default (None if it must be given) and meaning. The unit "mg" is a multiple of the vehicle's weight.
#[pyfunction]
pub fn parameters(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    fn group<P: Parameters>() -> (&'static str, &'static [Row]) {
        (P::GROUP, P::ROWS)
    }
    let dict = PyDict::new(py);
    for (name, table) in [
        group::<VehicleParameters>(),
        group::<LargeAngleParameters>(),
        group::<SmallAngleParameters>(),
        group::<CombinedParameters>(),
        group::<GainParameters>(),
        group::<GuidanceParameters>(),
        group::<MissionParameters>(),
    ] {
        dict.set_item(name, rows(py, table)?)?;
    }
    Ok(dict)
}
