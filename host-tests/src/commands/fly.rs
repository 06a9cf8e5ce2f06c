//! `fly`: a flight, its figures of merit, its files.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use alula_sil::figures::Figures;
use alula_sil::files::leave;
use alula_sil::flight::{Controller, Local, Row, fly};
use alula_sil::scenario::{DEFAULT, Scenario, Source};
use alula_sil::{report, trace};

/// Fly a scenario; leave its trace and report in a folder
#[derive(clap::Args)]
pub struct Args {
    /// A built-in scenario or a TOML file
    #[arg(default_value = DEFAULT)]
    scenario: String,
    /// Folder for the results [default: out/<scenario>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of the table
    #[arg(long)]
    json: bool,
}

impl Default for Args {
    fn default() -> Self {
        Self {
            scenario: DEFAULT.to_owned(),
            out: None,
            json: false,
        }
    }
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary<'a> {
    scenario: &'a str,
    out: &'a Path,
    #[serde(flatten)]
    figures: Figures,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    with(args, "out", |scenario| {
        Ok(Box::new(
            Local::new(scenario).expect("validated when loaded"),
        ))
    })
}

/// Flies under the controller that `connect` gives; `folder` holds the results of all scenarios.
pub fn with(
    args: &Args,
    folder: &str,
    connect: impl FnOnce(&Scenario) -> anyhow::Result<Box<dyn Controller>>,
) -> anyhow::Result<()> {
    let source = Source::load(&args.scenario)?;
    let out = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new(folder).join(&source.name),
    };
    // Before the flight: a folder that cannot be written should not cost one.
    std::fs::create_dir_all(&out).with_context(|| out.display().to_string())?;

    let mut controller = connect(&source.scenario)?;
    let bar = progress_bar(source.scenario.steps());
    let rows = fly(&source.scenario, controller.as_mut(), |step| {
        bar.set_position(step as u64);
    })?;
    bar.finish_and_clear();

    let figures = Figures::of(&rows);
    leave_files(&out, &source, &rows, &figures)?;
    let mut stdout = std::io::stdout().lock();
    if args.json {
        let summary = Summary {
            scenario: &source.name,
            out: &out,
            figures,
        };
        writeln!(stdout, "{}", serde_json::to_string_pretty(&summary)?)?;
    } else {
        writeln!(stdout, "{}: {}", source.name, source.scenario.description)?;
        for [label, value, at] in figures.table() {
            let line = format!("  {label:<24} {value:>14}  {at}");
            writeln!(stdout, "{}", line.trim_end())?;
        }
        let files = "trace.csv, report.html and flight.svg";
        writeln!(stdout, "{files} are in {}", out.display())?;
    }
    Ok(())
}

/// A bar on standard error, silent where that is not a terminal.
pub(super) fn progress_bar(steps: usize) -> ProgressBar {
    let style = "flying {bar:40} {percent:>3} % {eta} left";
    let bar = ProgressBar::new(steps as u64);
    bar.set_style(ProgressStyle::with_template(style).expect("a valid template"));
    bar
}

/// Writes the flight's files into `out`.
fn leave_files(out: &Path, source: &Source, rows: &[Row], figures: &Figures) -> anyhow::Result<()> {
    let svg = report::svg(&source.scenario, rows, figures);
    let html = report::html(source, rows, figures, &svg)?;
    leave(&out.join("trace.csv"), |file| Ok(trace::write(rows, file)?))?;
    leave(&out.join("flight.svg"), |file| {
        Ok(file.write_all(svg.as_bytes())?)
    })?;
    leave(&out.join("report.html"), |file| {
        Ok(file.write_all(html.as_bytes())?)
    })
}
