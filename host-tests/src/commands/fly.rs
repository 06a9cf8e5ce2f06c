//! `fly`: a flight, its figures of merit, its files.

use std::io::Write;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use alula_sil::columns::write_trace;
use alula_sil::controllers::Controller;
use alula_sil::experiment::{DEFAULT, Document, Experiment};
use alula_sil::figures::{Figures, Segment};
use alula_sil::files::leave;
use alula_sil::page::flight::page;
use alula_sil::simulate::{Record, simulate};

use super::output::Output;
use super::settings::Settings;
use super::space;

/// Fly an experiment; leave its trace and report in a folder
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment or a TOML file
    #[arg(default_value = DEFAULT)]
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    output: Output,
}

impl Default for Args {
    fn default() -> Self {
        Self {
            experiment: DEFAULT.to_owned(),
            settings: Settings::default(),
            output: Output::default(),
        }
    }
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary<'a> {
    experiment: &'a str,
    out: &'a Path,
    #[serde(flatten)]
    figures: &'a Figures,
    segments: &'a [Segment],
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    if document.get("path").is_some() {
        return space::fly(&document, &args.output);
    }
    fly(&document, &document.name, &args.output, |experiment| {
        Ok(experiment.controller()?)
    })
}

/// Flies what `args` say under the controller that `connect` gives; the files are left in `out/<folder>`.
pub fn with(
    args: &Args,
    folder: &str,
    connect: impl FnOnce(&Experiment) -> anyhow::Result<Box<dyn Controller>>,
) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    fly(&document, folder, &args.output, connect)
}

/// Flies `document` under the controller that `connect` gives, and leaves trace, figure and report in `out/<folder>`.
pub fn fly(
    document: &Document,
    folder: &str,
    output: &Output,
    connect: impl FnOnce(&Experiment) -> anyhow::Result<Box<dyn Controller>>,
) -> anyhow::Result<()> {
    let experiment = &document.checked()?;
    // Before the flight: a folder that cannot be written should not cost one.
    let out = output.folder(folder)?;
    let mut controller = connect(experiment)?;
    let bar = progress_bar(experiment.steps());
    let mut record = Record::with_capacity(experiment.steps() + 1);
    simulate(experiment, controller.as_mut(), |step| {
        record.push(*step);
        if record.len().is_multiple_of(100) {
            bar.set_position(record.len() as u64);
        }
        true
    })?;
    bar.finish_and_clear();

    let figures = Figures::of(experiment, &record);
    let page = page(document, experiment, &record, &figures);
    leave(&out.join("trace.csv"), |file| {
        Ok(write_trace(experiment, &record, file)?)
    })?;
    page.leave(&out, ["flight.svg", "report.html"])?;
    let segments = Segment::of(experiment, &record);
    let mut stdout = std::io::stdout().lock();
    if output.json() {
        let summary = Summary {
            experiment: &document.name,
            out: &out,
            figures: &figures,
            segments: &segments,
        };
        writeln!(stdout, "{}", serde_json::to_string_pretty(&summary)?)?;
        return Ok(());
    }
    writeln!(stdout, "{}: {}", document.name, experiment.description)?;
    for [label, value, at] in figures.table() {
        let line = format!("  {label:<28} {value:>14}  {at}");
        writeln!(stdout, "{}", line.trim_end())?;
    }
    if segments.len() > 1 {
        for segment in &segments {
            writeln!(stdout, "  {}", segment.line())?;
        }
    }
    let files = "trace.csv, report.html and flight.svg";
    writeln!(stdout, "{files} are in {}", out.display())?;
    Ok(())
}

/// A bar on standard error, silent where that is not a terminal.
pub fn progress_bar(steps: usize) -> ProgressBar {
    let style = "flying {bar:40} {percent:>3} % {eta} left";
    let bar = ProgressBar::new(steps as u64);
    bar.set_style(ProgressStyle::with_template(style).expect("a valid template"));
    bar
}
