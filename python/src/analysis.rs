//! What the command line's `margins`, `sweep` and `compare` find.

use std::num::NonZero;
use std::path::PathBuf;

use alula_design::sweep as plan;
use alula_sim::airframe::Airframe;
use alula_sim::experiment::{DEFAULT, PlantSpec};
use alula_sim::figures::FIGURES;
use alula_study::{self as study, Results};
use pyo3::prelude::*;

use crate::campaign::interruptible;
use crate::error;
use crate::experiment::Experiment;
use crate::frame::{Data, Frame, json};

/// How much lag and delay the loop bears in level flight at `speeds` [m/s], by default 0 to 25, with the experiment's gains and with
/// the paper's: what `alula-sil margins --json` gives as `loops`.
///
/// `source` is a built-in experiment, vehicle or polar, or a file; `set` changes fields. A list of `{"gains": "experiment" or "paper",
/// "points": [...]}`; a point has `speed_m_s`, `theta_deg`, `alpha_deg`, `fp_n`, `eigenvalues` [rad/s] as (real, imaginary), and the
/// largest stable `lag_s` and `delay_s`, None beyond 5 s. With `belief` the controller takes what it believes of the vehicle for it, with
/// `bare` the experiment's own lags and delay are left out.
#[pyfunction]
#[pyo3(signature = (source=DEFAULT.into(), set=None, *, speeds=None, belief=false, bare=false))]
pub fn margins(
    py: Python<'_>,
    source: PathBuf,
    set: Option<&Bound<'_, PyAny>>,
    speeds: Option<Vec<f64>>,
    belief: bool,
    bare: bool,
) -> PyResult<Py<PyAny>> {
    let airframe = match set {
        None => Airframe::load(&source.to_string_lossy()),
        Some(_) => Airframe::of(&Experiment::new(source, set, None)?.0),
    };
    let mut airframe = airframe.map_err(error::of)?;
    if bare {
        airframe.plant = PlantSpec::default();
    }
    let speeds = speeds.unwrap_or_default();
    let loops = py.detach(|| airframe.margins(&speeds, belief));
    json(py, &loops.map_err(error::of)?)
}

/// What stands against flying an experiment's reference, by the equilibria of the true vehicle along it: what `alula-sil sweep --json`
/// gives.
///
/// A dictionary of `admissible`, and of `jumps` of the equilibrium, spans of `low_fp` (|F_p| below `min_fp_n` [N], by default the
/// controller's tau), of `negative_thrust`, and of `none`, no equilibrium to follow.
#[pyfunction]
#[pyo3(signature = (source=DEFAULT.into(), set=None, *, min_fp_n=None))]
pub fn sweep(
    py: Python<'_>,
    source: PathBuf,
    set: Option<&Bound<'_, PyAny>>,
    min_fp_n: Option<f64>,
) -> PyResult<Py<PyAny>> {
    let experiment = Experiment::new(source, set, None)?.0.checked();
    let experiment = experiment.map_err(error::of)?;
    let least = match min_fp_n {
        Some(least) if least.is_finite() && least >= 0.0 => least,
        Some(_) => {
            let problem = "must be a finite number and not negative";
            return Err(error::field("min_fp_n", problem));
        }
        None => plan::least_fp(&experiment).map_err(error::of)?,
    };
    let findings =
        py.detach(|| plan::sweep(&experiment).map(|instants| plan::findings(&instants, least)));
    let findings = findings.map_err(error::of)?;
    json(py, &findings)
}

/// Flies the variants of a comparison under the same conditions, on all cores or on `threads`: what `alula-sil compare` flies.
///
/// `source` is the built-in comparison or a TOML file. One row per flight: `variant`, `condition`, `seed`, `outcome` ("flies",
/// "oscillates", "strays" or "departs") and the figures of the table, NaN where there is none. Ctrl-C ends it.
#[pyfunction]
#[pyo3(signature = (source="laws".into(), *, threads=None))]
pub fn compare(py: Python<'_>, source: PathBuf, threads: Option<usize>) -> PyResult<Frame> {
    let threads = threads
        .map(|n| NonZero::new(n).ok_or_else(|| error::field("threads", "must be positive")))
        .transpose()?;
    let source = study::Source::load(&source.to_string_lossy());
    let source = source.map_err(|e| error::of_argument("source", e))?;
    let results = interruptible(py, |go_on| Results::of(&source.plan, threads, go_on))?;
    let flights = || {
        let cells = results.cells.iter();
        cells.flat_map(|cell| cell.flights.iter().map(move |flight| (cell, flight)))
    };
    let words = |of: fn(&(&study::Cell, &study::Flight)) -> String| {
        Data::words(flights().map(|flight| of(&flight)))
    };
    let mut columns = vec![
        ("variant", words(|(cell, _)| cell.variant.clone())),
        ("condition", words(|(cell, _)| cell.condition.clone())),
        (
            "seed",
            Data::Integer(flights().map(|(_, f)| f.seed as i64).collect()),
        ),
        (
            "outcome",
            words(|(_, flight)| flight.outcome.text().to_owned()),
        ),
    ];
    let figures = FIGURES.iter().filter(|f| study::COLUMNS.contains(&f.name));
    columns.extend(figures.map(|figure| {
        let values = flights().map(|(_, flight)| flight.get(figure.name));
        (figure.name, Data::Real(values.collect()))
    }));
    let columns = columns
        .into_iter()
        .map(|(name, data)| (name.to_owned(), data));
    Ok(Frame::new(py, columns))
}
