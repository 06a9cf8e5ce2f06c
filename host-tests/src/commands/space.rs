//! Flights in space: `fly` of an experiment with a path, and `campaign attitudes`.

use std::io::Write;
use std::path::Path;

use anyhow::ensure;
use serde::Serialize;
use serde_json::{Map, Value};

use alula_sil::experiment::Document;
use alula_sil::files::leave;
use alula_sil::space::columns::write_trace;
use alula_sil::space::starts::{Start, percentile, starts};
use alula_sil::space::{Experiment, Figures, fly as simulate, page};
use alula_sil::study::Threads;

use super::fly::progress_bar;
use super::output::Output;

/// What `--json` prints of a flight.
#[derive(Serialize)]
struct Summary<'a> {
    experiment: &'a str,
    out: &'a Path,
    #[serde(flatten)]
    figures: Map<String, Value>,
    /// Whether every bound of the experiment is kept.
    bounds_kept: bool,
}

/// Flies `document`, and leaves trace, figure and report in `out/<its name>`.
pub fn fly(document: &Document, output: &Output) -> anyhow::Result<()> {
    let experiment = &Experiment::of(document)?;
    let out = output.folder(&document.name)?;
    let record = simulate(experiment)?;
    let figures = Figures::of(experiment, &record);
    leave(&out.join("trace.csv"), |file| {
        Ok(write_trace(&record, file)?)
    })?;
    let page = page(document, experiment, &record, &figures);
    page.leave(&out, ["flight.svg", "report.html"])?;
    let mut stdout = std::io::stdout().lock();
    if output.json() {
        let summary = Summary {
            experiment: &document.name,
            out: &out,
            figures: figures.json(),
            bounds_kept: figures.beyond(experiment).is_empty(),
        };
        writeln!(stdout, "{}", serde_json::to_string_pretty(&summary)?)?;
        return Ok(());
    }
    writeln!(stdout, "{}: {}", document.name, experiment.description)?;
    for [label, value, bound] in figures.table(experiment) {
        let line = format!("  {label:<28} {value:>14}  {bound}");
        writeln!(stdout, "{}", line.trim_end())?;
    }
    let files = "trace.csv, report.html and flight.svg";
    writeln!(stdout, "{files} are in {}", out.display())?;
    Ok(())
}

/// The campaign's name, its line in the list, and its experiments.
pub const ATTITUDES: (&str, &str) = (
    "attitudes",
    "Random attitudes, rates and velocities, to hover and to 20 m/s, in noise and moderate turbulence",
);
const BASES: [&str; 2] = ["start-hover", "start-cruise"];
/// Flights of each experiment.
const FLIGHTS: u64 = 10_000;
/// Share that must converge, and greatest height lost \[m\].
const LIMITS: (f64, f64) = (0.995, 30.0);

/// What `--json` prints of the random starts of one experiment.
#[derive(Serialize)]
struct Starts {
    experiment: &'static str,
    flights: usize,
    converged: f64,
    height_lost_50_m: f64,
    height_lost_95_m: f64,
    height_lost_99_m: f64,
    height_lost_most_m: f64,
    /// The flight that lost most.
    worst_seed: u64,
    /// Flights that did not converge.
    astray: Vec<u64>,
}

impl Starts {
    fn new(experiment: &'static str, starts: &[Start]) -> Self {
        let mut heights: Vec<f64> = starts.iter().map(|s| s.height_lost_m).collect();
        heights.sort_by(f64::total_cmp);
        let worst = starts
            .iter()
            .max_by(|a, b| a.height_lost_m.total_cmp(&b.height_lost_m));
        let astray: Vec<u64> = starts
            .iter()
            .filter(|s| !s.converged)
            .map(|s| s.seed)
            .collect();
        let at = |share| percentile(&heights, share);
        Self {
            experiment,
            flights: starts.len(),
            converged: 1.0 - astray.len() as f64 / starts.len() as f64,
            height_lost_50_m: at(0.5),
            height_lost_95_m: at(0.95),
            height_lost_99_m: at(0.99),
            height_lost_most_m: at(1.0),
            worst_seed: worst.map_or(0, |start| start.seed),
            astray,
        }
    }

    fn print(&self, to: &mut impl Write) -> std::io::Result<()> {
        writeln!(to, "{}: {} flights", self.experiment, self.flights)?;
        writeln!(to, "  converged        {:8.2} %", 100.0 * self.converged)?;
        for (label, height) in [
            ("median", self.height_lost_50_m),
            ("95 %", self.height_lost_95_m),
            ("99 %", self.height_lost_99_m),
            ("most", self.height_lost_most_m),
        ] {
            writeln!(to, "  height lost, {label:<6} {height:6.1} m")?;
        }
        for seed in std::iter::once(&self.worst_seed).chain(self.astray.iter().take(5)) {
            writeln!(to, "  alula-sil fly {} --set seed={seed}", self.experiment)?;
        }
        Ok(())
    }
}

/// Flies the random starts, and prints share and heights.
pub fn attitudes(flights: Option<u64>, threads: Threads, output: &Output) -> anyhow::Result<()> {
    let flights = flights.unwrap_or(FLIGHTS);
    ensure!(flights > 0, "--flights: must be positive");
    let bar = progress_bar(2 * flights as usize);
    let mut all = Vec::new();
    for name in BASES {
        let experiment = Experiment::of(&Document::load(name)?)?;
        let flown = starts(&experiment, flights, threads, || bar.inc(1))?;
        all.push(Starts::new(name, &flown));
    }
    bar.finish_and_clear();
    let out = output.folder("campaign/attitudes")?;
    leave(&out.join("summary.json"), |file| {
        Ok(serde_json::to_writer_pretty(file, &all)?)
    })?;
    let mut stdout = std::io::stdout().lock();
    if output.json() {
        writeln!(stdout, "{}", serde_json::to_string_pretty(&all)?)?;
    } else {
        for starts in &all {
            starts.print(&mut stdout)?;
        }
        writeln!(stdout, "summary.json is in {}", out.display())?;
    }
    let kept = |s: &Starts| s.converged >= LIMITS.0 && s.height_lost_most_m <= LIMITS.1;
    ensure!(
        all.iter().all(kept),
        "attitudes: less than {} % converge, or more than {} m are lost",
        100.0 * LIMITS.0,
        LIMITS.1
    );
    Ok(())
}
