//! Columns for NumPy, pandas and Arrow: one buffer each, handed over as it is.

use std::collections::HashMap;

use alula_sim::columns::Cell;
use alula_study as study;
use numpy::{Element, PyArray1};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use pythonize::pythonize;
use serde::Serialize;

/// A column on its way to Python.
pub enum Data {
    /// Double precision.
    Real(Vec<f64>),
    /// Single precision.
    Single(Vec<f32>),
    /// Counts and numbers of things.
    Integer(Vec<i64>),
    /// Verdicts.
    Flag(Vec<bool>),
    /// Words: of each row the place in the list of different ones.
    Words(Vec<i32>, Vec<String>),
}

impl Data {
    /// The column with these cells; `None` if there is nothing in any.
    pub fn of(cells: impl Iterator<Item = Option<Cell>> + Clone) -> Option<Self> {
        let numbers = |cell| match cell {
            Some(Cell::Single(x)) => f64::from(x),
            Some(Cell::Double(x)) => x,
            _ => f64::NAN,
        };
        Some(match cells.clone().flatten().next()? {
            Cell::Double(_) => Self::Real(cells.map(numbers).collect()),
            Cell::Single(_) => Self::Single(cells.map(|cell| numbers(cell) as f32).collect()),
            Cell::Word(_) => Self::words(cells.map(|cell| match cell {
                Some(Cell::Word(word)) => word.into_owned(),
                _ => String::new(),
            })),
        })
    }

    /// The column of these words.
    pub fn words(words: impl Iterator<Item = String>) -> Self {
        let mut places: HashMap<String, i32> = HashMap::new();
        let mut different = Vec::new();
        let codes = words.map(|word| match places.get(&word) {
            Some(place) => *place,
            None => {
                let place = different.len() as i32;
                different.push(word.clone());
                places.insert(word, place);
                place
            }
        });
        let codes = codes.collect();
        Self::Words(codes, different)
    }
}

impl From<study::Column> for Data {
    fn from(column: study::Column) -> Self {
        match column {
            study::Column::Integer(values) => Self::Integer(values),
            study::Column::Real(values) => Self::Real(values),
            study::Column::Single(values) => Self::Single(values),
            study::Column::Flag(values) => Self::Flag(values),
        }
    }
}

/// What the command line would print as JSON, in Python: a number that is none is None.
pub fn json(py: Python<'_>, value: &impl Serialize) -> PyResult<Py<PyAny>> {
    let value = serde_json::to_value(value).map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok(pythonize(py, &value)?.unbind())
}

/// A column in Python.
enum Column {
    /// A NumPy array.
    Numbers(Py<PyAny>),
    /// Codes, a NumPy array, and the list of words that they count in.
    Words(Py<PyAny>, Vec<String>),
}

/// Columns of equal length by name, each in one buffer of memory.
///
/// `frame["thrust_n"]` is the column's NumPy array; `pandas` and `arrow` hand over the same buffers. Columns of words are
/// codes and a list of the different words: categorical in pandas, a dictionary in Arrow.
#[pyclass(frozen, module = "alula")]
pub struct Frame {
    columns: Vec<(String, Column)>,
    rows: usize,
}

fn array<T: Element>(py: Python, values: Vec<T>) -> Py<PyAny> {
    PyArray1::from_vec(py, values).into_any().unbind()
}

impl Frame {
    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The frame of these columns.
    pub fn new(py: Python, columns: impl IntoIterator<Item = (String, Data)>) -> Self {
        let mut rows = 0;
        let columns = columns.into_iter().map(|(name, data)| {
            let (n, column) = match data {
                Data::Real(v) => (v.len(), Column::Numbers(array(py, v))),
                Data::Single(v) => (v.len(), Column::Numbers(array(py, v))),
                Data::Integer(v) => (v.len(), Column::Numbers(array(py, v))),
                Data::Flag(v) => (v.len(), Column::Numbers(array(py, v))),
                Data::Words(v, words) => (v.len(), Column::Words(array(py, v), words)),
            };
            rows = n;
            (name, column)
        });
        let columns = columns.collect();
        Self { columns, rows }
    }

    /// The frame of a study.
    pub fn of_study(py: Python, frame: study::Frame) -> Self {
        let columns = frame.columns.into_iter();
        Self::new(py, columns.map(|(name, column)| (name, column.into())))
    }

    /// A dictionary of the columns, those of words as `words` makes them.
    fn dict<'py>(
        &self,
        py: Python<'py>,
        words: impl Fn(&Py<PyAny>, &[String]) -> PyResult<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, column) in &self.columns {
            match column {
                Column::Numbers(array) => dict.set_item(name, array)?,
                Column::Words(codes, list) => dict.set_item(name, words(codes, list)?)?,
            }
        }
        Ok(dict)
    }
}

/// An array of words.
fn spelled<'py>(
    py: Python<'py>,
    codes: &Py<PyAny>,
    words: &[String],
) -> PyResult<Bound<'py, PyAny>> {
    let words = py
        .import("numpy")?
        .call_method1("array", (words.to_vec(), "U"))?;
    words.call_method1("take", (codes,))
}

#[pymethods]
impl Frame {
    /// The names of the columns, in order.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.columns.iter().map(|(name, _)| &**name).collect()
    }

    fn __len__(&self) -> usize {
        self.rows
    }

    fn __contains__(&self, name: &str) -> bool {
        self.columns.iter().any(|(known, _)| known == name)
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let column = self.columns.iter().find(|(known, _)| known == name);
        match column {
            Some((_, Column::Numbers(array))) => Ok(array.bind(py).clone()),
            Some((_, Column::Words(codes, words))) => spelled(py, codes, words),
            None => Err(PyKeyError::new_err(name.to_owned())),
        }
    }

    /// A dictionary of NumPy arrays. Words are spelled out.
    fn numpy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.dict(py, |codes, words| spelled(py, codes, words))
    }

    /// A `pandas.DataFrame` on the same buffers.
    fn pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let pandas = py.import("pandas")?;
        let categorical = pandas.getattr("Categorical")?;
        let columns = self.dict(py, |codes, words| {
            categorical.call_method1("from_codes", (codes, words.to_vec()))
        })?;
        let options = PyDict::new(py);
        options.set_item("copy", false)?;
        pandas.call_method("DataFrame", (columns,), Some(&options))
    }

    /// A `pyarrow.Table` on the same buffers, but for flags, which Arrow packs into bits.
    fn arrow<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let pyarrow = py.import("pyarrow")?;
        let dictionary = pyarrow.getattr("DictionaryArray")?;
        let columns = self.dict(py, |codes, words| {
            dictionary.call_method1("from_arrays", (codes, words.to_vec()))
        })?;
        pyarrow.call_method1("table", (columns,))
    }

    fn __repr__<'py>(&self, py: Python<'py>) -> Bound<'py, PyString> {
        let text = format!(
            "<alula.Frame: {} rows, {}>",
            self.rows,
            self.names().join(", ")
        );
        PyString::new(py, &text)
    }
}
