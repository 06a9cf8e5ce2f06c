//! A flight that has been flown: its record and its figures.

use alula_sim::columns::COLUMNS;
use alula_sim::experiment::{Document, Experiment};
use alula_sim::figures::{Figures, Segment};
use alula_sim::simulate::{self, Diverged, Step};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error;
use crate::frame::{Data, Frame, json};

/// A figure that does not keep its bound.
#[pyclass(frozen, get_all, skip_from_py_object, module = "alula")]
#[derive(Clone)]
pub struct Beyond {
    /// The figure's name.
    figure: String,
    /// What it is.
    value: f64,
    /// The most that it may be.
    bound: f64,
}

#[pymethods]
impl Beyond {
    fn __repr__(&self) -> String {
        let Self {
            figure,
            value,
            bound,
        } = self;
        format!("Beyond(figure={figure:?}, value={value}, bound={bound})")
    }
}

/// A flight.
#[pyclass(frozen, module = "alula")]
pub struct Flight {
    /// The experiment's name.
    #[pyo3(get)]
    name: String,
    /// The figures by name, as `alula-sil fly --json` gives them. What there is none of, or is no number, is None.
    #[pyo3(get)]
    figures: Py<PyAny>,
    /// The figures along each segment of the reference; none in space.
    #[pyo3(get)]
    segments: Py<PyAny>,
    /// The record: one row per control step, the columns of the trace.
    #[pyo3(get)]
    record: Py<Frame>,
    /// The bounds of the experiment that are not kept.
    #[pyo3(get)]
    beyond: Vec<Beyond>,
    /// Label, value and note of the lines of the table.
    lines: Vec<[String; 3]>,
    /// Steps of the record, and time of the last [s].
    steps: usize,
    end_s: f64,
}

#[pymethods]
impl Flight {
    /// The table of figures that `alula-sil fly` prints.
    fn __str__(&self) -> String {
        let mut text = self.name.clone();
        for [label, value, note] in &self.lines {
            let line = format!("\n  {label:<28} {value:>14}  {note}");
            text += line.trim_end_matches(' ');
        }
        text
    }

    fn __repr__(&self) -> String {
        let beyond = self.beyond.iter().map(|beyond| {
            let Beyond {
                figure,
                value,
                bound,
            } = beyond;
            format!("; {figure} is {value:.3}, its bound {bound}")
        });
        let beyond: String = beyond.collect();
        format!(
            "<alula.Flight {}: {:.1} s, {} steps{beyond}; print() shows its figures>",
            self.name, self.end_s, self.steps
        )
    }
}

/// The columns of a record that apply to it.
pub fn columns(experiment: &Experiment, record: &[Step]) -> Vec<(String, Data)> {
    let columns = COLUMNS.iter().filter_map(|column| {
        let cells = record.iter().map(|step| (column.read)(experiment, step));
        Some((column.name.to_owned(), Data::of(cells)?))
    });
    columns.collect()
}

/// Flies what `document` says.
pub fn fly(py: Python<'_>, document: &Document) -> PyResult<Flight> {
    let experiment = document.checked().map_err(error::of)?;
    let flight = py.detach(|| {
        let record = simulate::fly(&experiment)?;
        let figures = Figures::of(&experiment, &record);
        Ok((record, figures))
    });
    let (record, figures) =
        flight.map_err(
            |refused: anyhow::Error| match refused.downcast_ref::<Diverged>() {
                Some(diverged) => PyRuntimeError::new_err(format!("{}: {diverged}", document.name)),
                None => error::of(refused),
            },
        )?;
    of(py, &document.name, &experiment, &record, &figures)
}

/// The flight of `experiment` that `record` holds.
pub fn of(
    py: Python<'_>,
    name: &str,
    experiment: &Experiment,
    record: &[Step],
    figures: &Figures,
) -> PyResult<Flight> {
    let (segments, columns) =
        py.detach(|| (Segment::of(experiment, record), columns(experiment, record)));
    let beyond = figures.beyond(experiment).into_iter();
    Ok(Flight {
        name: name.to_owned(),
        figures: json(py, figures)?,
        segments: json(py, &segments)?,
        record: Py::new(py, Frame::new(py, columns))?,
        beyond: beyond
            .map(|b| Beyond {
                figure: b.figure.to_owned(),
                value: b.value,
                bound: b.bound,
            })
            .collect(),
        lines: figures.table(experiment),
        steps: record.len(),
        end_s: record.last().map_or(0.0, |step| step.t),
    })
}
