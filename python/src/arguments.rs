//! Arguments: numbers, vectors and arrays of them, and values for files.

use std::convert::Infallible;

use numpy::ndarray::{ArrayView2, Axis};
use numpy::{AllowTypeChange, PyArrayLikeDyn};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};
use toml::{Table, Value};

use ::alula::ned::Ned;
use ::alula::planar::{Body, Inertial};

use crate::error;

type Array<'py> = PyArrayLikeDyn<'py, f32, AllowTypeChange>;

/// Numbers of any shape: what NumPy makes an array of. What it does not is kept until the argument's name is known.
pub struct Numbers<'py>(Result<Array<'py>, String>);

impl<'a, 'py> FromPyObject<'a, 'py> for Numbers<'py> {
    type Error = Infallible;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> Result<Self, Infallible> {
        let array = Array::extract(given);
        Ok(Self(
            array.map_err(|error| error.value(given.py()).to_string()),
        ))
    }
}

impl<'py> Numbers<'py> {
    fn array(&self, field: &str) -> PyResult<&Array<'py>> {
        let problem = |text: &String| error::field(field, text.clone());
        self.0.as_ref().map_err(problem)
    }
}

/// `value` as a vector of `N` components.
pub fn vector<const N: usize>(field: &str, value: &Numbers) -> PyResult<[f32; N]> {
    let view = value.array(field)?.as_array();
    match view.shape() {
        [n] if *n == N => Ok(std::array::from_fn(|i| view[[i]])),
        other => Err(shape(field, &format!("({N},)"), other)),
    }
}

/// A vector that may be left out: zero.
pub fn vector_or_zero<const N: usize>(field: &str, value: Option<&Numbers>) -> PyResult<[f32; N]> {
    value.map_or(Ok([0.0; N]), |value| vector(field, value))
}

/// North, east and down, or forward, right and down, in the vertical plane to the north: the second component must be 0.
pub fn in_plane(field: &str, value: &Numbers) -> PyResult<[f32; 3]> {
    if let [2] = value.array(field)?.as_array().shape() {
        return Err(error::field(field, PAIR));
    }
    level(field, vector(field, value)?)
}

/// As [`in_plane`]; zero where it is left out.
pub fn in_plane_or_zero(field: &str, value: Option<&Numbers>) -> PyResult<[f32; 3]> {
    value.map_or(Ok([0.0; 3]), |value| in_plane(field, value))
}

/// As [`in_plane`], of every row of an argument.
pub fn all_in_plane(&Given { field, value, .. }: &Given) -> PyResult<()> {
    let array = value.array(field)?.as_array();
    if array.shape().last() == Some(&2) {
        return Err(error::field(field, PAIR));
    }
    let across = array.iter().skip(1).step_by(3);
    across.copied().try_for_each(|east| flat(field, east))
}

/// Vectors in the plane had two components once.
const PAIR: &str = "must have three components, [north, east, down] or [forward, right, down]: a pair [down, forward] is now [forward, 0, down]";

/// North, east and down, as the plane has them. What is not finite in any component is not finite there.
pub fn inertial([north, east, down]: [f32; 3]) -> Inertial {
    Ned::new(north + 0.0 * east, east, down).to_plane()
}

/// Forward, right and down, as the plane has them, likewise.
pub fn body([forward, right, down]: [f32; 3]) -> Body {
    Body::new(0.0 * right - forward, down)
}

fn level(field: &str, vector: [f32; 3]) -> PyResult<[f32; 3]> {
    flat(field, vector[1]).map(|()| vector)
}

/// What is not finite is left to who takes it.
fn flat(field: &str, east: f32) -> PyResult<()> {
    if east.is_finite() && east != 0.0 {
        let problem =
            format!("the second component must be 0, out of the vertical plane, is {east}");
        return Err(error::field(field, problem));
    }
    Ok(())
}

fn shape(field: &str, wanted: &str, shape: &[usize]) -> PyErr {
    error::field(field, format!("must be of shape {wanted}, is of {shape:?}"))
}

/// Greatest attitude or heading \[rad\], either way: a turn.
pub const TURN: f32 = std::f32::consts::TAU;
/// Greatest angle of attack \[rad\], either way, with its rounding.
pub const HALF_TURN: f32 = std::f32::consts::PI + 4e-4;

/// `value` must be an angle of at most `most` \[rad\] either way. What is not finite is left to who takes it.
pub fn angle(field: &str, value: f32, most: f32) -> PyResult<f32> {
    if value.is_finite() && value.abs() > most {
        let problem = format!(
            "{value} is not from {:.3} to {most:.3} rad: was this in degrees?",
            -most
        );
        return Err(error::field(field, problem));
    }
    Ok(value)
}

/// As [`angle`], of every number in `values`.
pub fn angles(field: &str, values: &Numbers, most: f32) -> PyResult<()> {
    let array = values.array(field)?.as_array();
    array
        .iter()
        .try_for_each(|x| angle(field, *x, most).map(|_| ()))
}

/// An argument of an array of rows.
pub struct Given<'a, 'py> {
    field: &'a str,
    value: &'a Numbers<'py>,
    /// Components of a row.
    width: usize,
}

impl Given<'_, '_> {
    pub fn width(&self) -> usize {
        self.width
    }
}

/// The argument `field`, with rows of `width` components.
pub fn given<'a, 'py>(field: &'a str, value: &'a Numbers<'py>, width: usize) -> Given<'a, 'py> {
    Given {
        field,
        value,
        width,
    }
}

/// The number of rows of several arguments: of those that have rows.
pub fn rows(arguments: &[Given]) -> PyResult<usize> {
    Ok(counted(None, arguments)?.unwrap_or(1))
}

/// Checks that each argument that has rows has as many as there are `vehicles`.
pub fn rows_of_each(vehicles: usize, arguments: &[Given]) -> PyResult<()> {
    counted(Some(vehicles), arguments).map(|_| ())
}

fn counted(vehicles: Option<usize>, arguments: &[Given]) -> PyResult<Option<usize>> {
    let mut length = vehicles;
    for Given {
        field,
        value,
        width: row,
    } in arguments
    {
        let value = value.array(field)?.as_array();
        let n = match (value.shape(), row) {
            ([], 1) => continue,
            ([n], 1) => *n,
            ([n], row) if n == row => continue,
            ([n, m], row) if m == row && *row > 1 => *n,
            (other, 1) => return Err(shape(field, "() or (n,)", other)),
            (other, row) => return Err(shape(field, &format!("({row},) or (n, {row})"), other)),
        };
        match length {
            Some(others) if others != n => {
                let problem = match vehicles {
                    Some(_) => format!("has {n} rows, there are {others} vehicles"),
                    None => format!("has {n} rows, arguments before it {others}"),
                };
                return Err(error::field(field, problem));
            }
            _ => length = Some(n),
        }
    }
    Ok(length)
}

/// The rows of an argument, a single one of which stands for all.
#[derive(Clone, Copy)]
pub struct Rows<'a>(ArrayView2<'a, f32>);

impl<'a> Rows<'a> {
    /// The rows of `value`, of `width` components, which [`rows`] has counted.
    pub fn new(value: &'a Numbers, width: usize) -> Self {
        let array = value.0.as_ref().expect("counted before");
        let view = array.as_array();
        let view = match (view.ndim(), width) {
            (0, _) => view.insert_axis(Axis(0)).insert_axis(Axis(0)),
            (1, 1) => view.insert_axis(Axis(1)),
            (1, _) => view.insert_axis(Axis(0)),
            _ => view,
        };
        Self(
            view.into_dimensionality()
                .expect("of two dimensions by now"),
        )
    }

    /// Row `k`.
    pub fn get<const N: usize>(&self, k: usize) -> [f32; N] {
        let k = if self.0.nrows() == 1 { 0 } else { k };
        std::array::from_fn(|i| self.0[[k, i]])
    }
}

/// A value of Python as files have it.
pub fn value(field: &str, given: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(flag) = given.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(text) = given.cast::<PyString>() {
        return Ok(Value::String(text.to_string()));
    }
    if let Ok(dict) = given.cast::<PyDict>() {
        return table(dict).map(Value::Table);
    }
    if let Ok(integer) = given.extract::<i64>() {
        return Ok(Value::Integer(integer));
    }
    if let Ok(number) = given.extract::<f64>() {
        return Ok(Value::Float(number));
    }
    if let Ok(path) = given.call_method0("__fspath__") {
        return value(field, &path);
    }
    if let Ok(items) = given.try_iter() {
        let items = items.map(|item| value(field, &item?));
        return items.collect::<PyResult<_>>().map(Value::Array);
    }
    let problem = format!(
        "{} is nothing that a file can hold",
        given.get_type().name()?
    );
    Err(error::field(field, problem))
}

/// A dictionary as files have it.
pub fn table(dict: &Bound<'_, PyDict>) -> PyResult<Table> {
    let entry = |(key, given): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key: String = key.extract()?;
        let value = value(&key, &given)?;
        Ok((key, value))
    };
    dict.iter().map(entry).collect()
}
