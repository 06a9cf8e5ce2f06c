//! A controller run over a log.

use std::path::PathBuf;

use alula_sim::experiment::DEFAULT;
use alula_sim::replay::Source;
use pyo3::prelude::*;

use crate::error;
use crate::experiment::Experiment;
use crate::flight::columns;
use crate::frame::Frame;

/// A controller run open loop over a logged flight.
#[pyclass(frozen, get_all, module = "alula")]
pub struct Replay {
    /// What the controller was told and what it commanded, the columns of a trace; those of the plant, which a log does not know, are NaN.
    record: Py<Frame>,
    /// What the log left out and had to be assumed.
    notes: Vec<String>,
}

#[pymethods]
impl Replay {
    fn __repr__(&self, py: Python<'_>) -> String {
        let (rows, notes) = (self.record.borrow(py).rows(), self.notes.len());
        format!("<alula.Replay: {rows} steps, {notes} notes>")
    }
}

/// Runs the controller of the experiment `source`, with the fields in `set` changed, open loop over the log `file`: a CSV such as a
/// flight's trace, a PX4 ULog, MCAP, or an ArduPilot DataFlash log (.bin, .log).
///
/// `map` is a TOML file that says which column of a foreign CSV is which.
#[pyfunction]
#[pyo3(signature = (file, source=DEFAULT.into(), set=None, *, map=None))]
pub fn replay(
    py: Python<'_>,
    file: PathBuf,
    source: PathBuf,
    set: Option<&Bound<'_, PyAny>>,
    map: Option<PathBuf>,
) -> PyResult<Replay> {
    let experiment = Experiment::new(source, set, None)?.0.checked();
    let experiment = experiment.map_err(error::of)?;
    let replayed = py.detach(|| {
        let (record, notes) = Source::open(&file, map.as_ref())?.replay(&experiment)?;
        Ok((columns(&experiment, &record), notes))
    });
    let (columns, notes) = replayed.map_err(|e| error::of_argument("file", e))?;
    Ok(Replay {
        record: Py::new(py, Frame::new(py, columns))?,
        notes,
    })
}
