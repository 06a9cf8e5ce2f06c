//! Campaigns: an experiment flown many times over.

use std::num::NonZero;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use alula_study::starts::{ATTITUDES, BASES, FLIGHTS, StartResult, Starts, starts};
use alula_study::{self as study, BUILT_IN, CampaignSource, Summary, Threads};
use anyhow::ensure;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error;
use crate::flight::{self, Flight};
use crate::frame::{Data, Frame, json};

/// A campaign that has been flown.
#[pyclass(frozen, module = "alula")]
pub struct Campaign {
    /// The campaign's name.
    #[pyo3(get)]
    name: String,
    /// Whether every limit is kept, and no flight departed, diverged or ended a fault in another state than stated.
    #[pyo3(get)]
    passed: bool,
    /// What was found, as `alula-sil campaign --json` prints it.
    #[pyo3(get)]
    summary: Py<PyAny>,
    /// One row per flight: what was drawn, the figures, and the verdicts.
    #[pyo3(get)]
    flights: Py<Frame>,
    /// The course of every flight at 101 times; without columns for attitudes.
    #[pyo3(get)]
    samples: Py<Frame>,
    source: Option<CampaignSource>,
}

#[pymethods]
impl Campaign {
    /// Flies one of its flights again, by number. Those of attitudes are `alula.fly("start-hover", {"seed": number})`.
    fn refly(&self, py: Python<'_>, number: i64) -> PyResult<Flight> {
        // No campaign has a flight of this number.
        let number = u64::try_from(number).unwrap_or(u64::MAX);
        let Some(source) = self.source.as_ref() else {
            return Err(error::field(
                "number",
                "attitudes are flown again by alula.fly",
            ));
        };
        let flights = source.campaign.flights;
        if number >= flights {
            return Err(error::field(
                "number",
                format!("must be from 0 to {}", flights - 1),
            ));
        }
        let drawn = source.campaign.draw(&source.base, number);
        let mut document = drawn.map_err(error::of_field)?.document;
        document.name = format!("{}-{number}", source.stem());
        flight::fly(py, &document)
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let verdict = if self.passed { "passed" } else { "not passed" };
        let flights = self.flights.borrow(py).rows();
        format!(
            "<alula.Campaign {}: {flights} flights, {verdict}>",
            self.name
        )
    }
}

/// Does `work` while Python's signals are looked after: Ctrl-C makes `work`'s argument false, and is raised when it has ended.
pub fn interruptible<R: Send>(
    py: Python<'_>,
    work: impl FnOnce(&(dyn Fn() -> anyhow::Result<()> + Sync)) -> anyhow::Result<R> + Send,
) -> PyResult<R> {
    let stop = &AtomicBool::new(false);
    let go_on = &|| {
        ensure!(!stop.load(Ordering::Relaxed), "interrupted");
        Ok(())
    };
    thread::scope(|scope| {
        let worker = scope.spawn(|| work(go_on));
        let mut signals = Ok(());
        while !worker.is_finished() && signals.is_ok() {
            py.detach(|| thread::sleep(Duration::from_millis(10)));
            signals = py.check_signals();
        }
        stop.store(signals.is_err(), Ordering::Relaxed);
        let result = py.detach(|| worker.join());
        signals?;
        match result {
            Ok(result) => result.map_err(error::of),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// Flies a campaign on all cores, or on `threads`: an experiment many times over, with its fields drawn at random.
///
/// `source` is a built-in (`alula.campaigns()`) or a TOML file; `flights` replaces its number of flights. The results do not depend on
/// threads. They are in memory: `alula-sil campaign` is for what is to be shared, or to go on after an interruption.
#[pyfunction]
#[pyo3(signature = (source, flights=None, *, threads=None))]
pub fn campaign(
    py: Python<'_>,
    source: PathBuf,
    flights: Option<i64>,
    threads: Option<i64>,
) -> PyResult<Campaign> {
    let positive = |field, given: Option<i64>| {
        let checked = given.map(|n| {
            let n = usize::try_from(n).ok().and_then(NonZero::new);
            n.ok_or_else(|| error::field(field, "must be positive"))
        });
        checked.transpose()
    };
    let threads = positive("threads", threads)?;
    let flights = positive("flights", flights)?.map(|n| n.get() as u64);
    let name = source.to_string_lossy();
    if name == ATTITUDES.0 {
        return attitudes(py, flights.unwrap_or(FLIGHTS), threads);
    }
    let source = CampaignSource::load(&name, flights);
    let source = source.map_err(|e| error::of_argument("source", e))?;
    let (summary, flights, samples) = interruptible(py, |go_on| {
        let numbers = |chunk| (chunk, source.campaign.chunk(chunk));
        let chunks: Vec<_> = (0..source.campaign.chunks()).map(numbers).collect();
        let keep = |_, flights, samples| Ok((flights, samples));
        let parts = study::fly(&source, &chunks, threads, go_on, keep)?;
        let summary = Summary::of_parts(&source, parts.iter().cloned().map(Ok))?;
        let (mut flights, mut samples) = Default::default();
        for (of_flights, of_samples) in parts {
            study::Frame::append(&mut flights, of_flights)?;
            study::Frame::append(&mut samples, of_samples)?;
        }
        Ok((summary, flights, samples))
    })?;
    Ok(Campaign {
        name: source.stem().to_owned(),
        passed: summary.verdict(),
        summary: json(py, &summary)?,
        flights: Py::new(py, Frame::of_study(py, flights))?,
        samples: Py::new(py, Frame::of_study(py, samples))?,
        source: Some(source),
    })
}

/// Random starts in space: `flights` of each experiment.
fn attitudes(py: Python<'_>, flights: u64, threads: Threads) -> PyResult<Campaign> {
    let all_starts: Vec<(&str, Vec<StartResult>)> = interruptible(py, |go_on| {
        let fly = |name| Ok((name, starts(name, flights, threads, go_on)?));
        BASES.into_iter().map(fly).collect()
    })?;
    let summary: Vec<Starts> = all_starts
        .iter()
        .map(|(name, all)| Starts::new(name, all))
        .collect();
    let rows = || {
        all_starts
            .iter()
            .flat_map(|(name, all)| all.iter().map(move |start| (name, start)))
    };
    let columns = [
        (
            "experiment",
            Data::words(rows().map(|(name, _)| (*name).to_owned())),
        ),
        (
            "seed",
            Data::Integer(rows().map(|(_, s)| s.seed as i64).collect()),
        ),
        (
            "converged",
            Data::Flag(rows().map(|(_, s)| s.converged).collect()),
        ),
        (
            "diverged",
            Data::Flag(rows().map(|(_, s)| s.diverged).collect()),
        ),
        (
            "height_lost_m",
            Data::Real(rows().map(|(_, s)| s.height_lost_m).collect()),
        ),
        (
            "late_velocity_error_rms_m_s",
            Data::Real(rows().map(|(_, s)| s.late_velocity_error_rms_m_s).collect()),
        ),
    ];
    let columns = columns.map(|(name, data)| (name.to_owned(), data));
    Ok(Campaign {
        name: ATTITUDES.0.to_owned(),
        passed: summary.iter().all(Starts::kept),
        summary: json(py, &summary)?,
        flights: Py::new(py, Frame::new(py, columns))?,
        samples: Py::new(py, Frame::new(py, []))?,
        source: None,
    })
}

/// Name and description of every built-in campaign.
#[pyfunction]
pub fn campaigns(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for (name, _) in BUILT_IN {
        let source = CampaignSource::load(name, None).map_err(error::of)?;
        dict.set_item(name, source.campaign.description)?;
    }
    dict.set_item(ATTITUDES.0, ATTITUDES.1)?;
    Ok(dict)
}
