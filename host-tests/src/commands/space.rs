//! Flights in space: `fly` of an experiment with a path, and `campaign attitudes`.

use std::io::Write;
use std::path::Path;

use alula::{GuidanceInput, GuidanceOutput};
use anyhow::ensure;
use indicatif::ProgressBar;
use serde::Serialize;
use serde_json::{Map, Value};

use alula_report::space::page;
use alula_sim::columns::write_trace;
use alula_sim::experiment::Document;
use alula_sim::flight_log;
use alula_sim::space::{Experiment, Figures, Pilot, Record, fly_by as simulate};
use alula_study::Threads;
use alula_study::files::leave;
use alula_study::starts::{BASES, FLIGHTS, LIMITS, Starts, starts};

use super::fly::{Logs, progress_bar};
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
pub fn fly(document: &Document, output: &Output, logs: &Logs) -> anyhow::Result<()> {
    fly_by(document, &document.name, (output, logs), |experiment| {
        Ok(Box::new(experiment.pilot()?))
    })
}

/// A pilot whose steps are counted on the terminal.
struct Counted {
    pilot: Box<dyn Pilot>,
    bar: ProgressBar,
}

impl Pilot for Counted {
    fn guided(&mut self, input: &GuidanceInput, dt: f32) -> anyhow::Result<GuidanceOutput> {
        self.bar.inc(1);
        self.pilot.guided(input, dt)
    }

    fn flip(&mut self, bit: u64) {
        self.pilot.flip(bit);
    }
}

/// Flies `document` under the pilot that `connect` gives, and leaves trace, figure and report in `out/<folder>`.
pub fn fly_by(
    document: &Document,
    folder: &str,
    (output, logs): (&Output, &Logs),
    connect: impl FnOnce(&Experiment) -> anyhow::Result<Box<dyn Pilot>>,
) -> anyhow::Result<()> {
    let experiment = &Experiment::of(document)?;
    let out = output.folder(folder)?;
    let mut pilot = Counted {
        pilot: connect(experiment)?,
        bar: progress_bar(experiment.steps()),
    };
    let record = simulate(experiment, &mut pilot)?;
    pilot.bar.finish_and_clear();
    report(document, experiment, &record, &out, (output, logs))
}

/// Leaves trace, figure and report of a flight in `out`, and prints its figures.
pub fn report(
    document: &Document,
    experiment: &Experiment,
    record: &Record,
    out: &Path,
    (output, logs): (&Output, &Logs),
) -> anyhow::Result<()> {
    let figures = Figures::of(experiment, record);
    leave(&out.join("trace.csv"), |file| {
        Ok(write_trace(experiment, record, file)?)
    })?;
    let page = page(document, experiment, record, &figures);
    page.leave(out, ["flight.svg", "report.html"])?;
    let logs = logs.leave(|| flight_log::log(experiment, record), out)?;
    let mut stdout = std::io::stdout().lock();
    if output.json() {
        let summary = Summary {
            experiment: &document.name,
            out,
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
    let files = [&["trace.csv", "report.html"][..], &logs]
        .concat()
        .join(", ");
    writeln!(stdout, "{files} and flight.svg are in {}", out.display())?;
    Ok(())
}

/// Prints the random starts of one experiment.
fn print(starts: &Starts, to: &mut impl Write) -> std::io::Result<()> {
    writeln!(to, "{}: {} flights", starts.experiment, starts.flights)?;
    writeln!(to, "  converged        {:8.2} %", 100.0 * starts.converged)?;
    for (label, height) in [
        ("median", starts.height_lost_50_m),
        ("95 %", starts.height_lost_95_m),
        ("99 %", starts.height_lost_99_m),
        ("most", starts.height_lost_most_m),
    ] {
        writeln!(to, "  height lost, {label:<6} {height:6.1} m")?;
    }
    for seed in std::iter::once(&starts.worst_seed).chain(starts.astray.iter().take(5)) {
        writeln!(
            to,
            "  alula-sil fly {} --set seed={seed}",
            starts.experiment
        )?;
    }
    Ok(())
}

/// Flies the random starts, and prints share and heights.
pub fn attitudes(flights: Option<u64>, threads: Threads, output: &Output) -> anyhow::Result<()> {
    let flights = flights.unwrap_or(FLIGHTS);
    ensure!(flights > 0, "--flights: must be positive");
    let bar = progress_bar(BASES.len() * flights as usize);
    let flown = || {
        bar.inc(1);
        Ok(())
    };
    let mut all = Vec::new();
    for name in BASES {
        all.push(Starts::new(name, &starts(name, flights, threads, flown)?));
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
            print(starts, &mut stdout)?;
        }
        writeln!(stdout, "summary.json is in {}", out.display())?;
    }
    ensure!(
        all.iter().all(Starts::kept),
        "attitudes: less than {} % converge, or more than {} m are lost",
        100.0 * LIMITS.0,
        LIMITS.1
    );
    Ok(())
}
