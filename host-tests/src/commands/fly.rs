//! `fly`: a flight, its figures of merit, its files.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, bail, ensure};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use alula_logs::Log;
use alula_report::Page;
use alula_report::flight::page;
use alula_report::viewer;
use alula_sim::columns::write_trace;
use alula_sim::controllers::Controller;
use alula_sim::experiment::plan::of_plan;
use alula_sim::experiment::{DEFAULT, Document, Experiment};
use alula_sim::figures::{Figures, Segment};
use alula_sim::flight_log::{self, Format};
use alula_sim::simulate::{Diverged, Record, Step, simulate};
use alula_study::files::{leave, leave_all};

use super::output::Output;
use super::settings::Settings;
use super::view::{LIVE, library};

/// Fly an experiment; leave its trace and report in a folder
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment, a TOML file, or a mission of a ground station (.plan)
    #[arg(default_value = DEFAULT)]
    experiment: String,
    /// The experiment whose vehicle flies the mission of a .plan file
    #[arg(long, value_name = "EXPERIMENT")]
    vehicle: Option<String>,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    logs: Logs,
}

/// The guidance's own mission.
const MISSION: &str = "mission";

/// `--log`.
#[derive(clap::Args, Default)]
pub struct Logs {
    /// Leave the flight as a log, too: ulog (flight.ulg), mcap (flight.mcap), csv (flight.csv)
    #[arg(long = "log", value_name = "KIND,…", value_delimiter = ',')]
    kinds: Vec<LogKind>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum LogKind {
    Ulog,
    Mcap,
    Csv,
}

impl Logs {
    /// Leaves `log` in `out`, in each format that is asked for; their names.
    pub fn leave(
        &self,
        log: impl FnOnce() -> Result<Log, alula_logs::Error>,
        out: &Path,
    ) -> anyhow::Result<Vec<&'static str>> {
        if self.kinds.is_empty() {
            return Ok(Vec::new());
        }
        let log = log()?;
        let left = self.kinds.iter().map(|kind| {
            let format = match kind {
                LogKind::Ulog => Format::Ulog,
                LogKind::Mcap => Format::Mcap,
                LogKind::Csv => Format::Csv,
            };
            leave(&out.join(format.file()), |file| format.write(&log, file))?;
            Ok(format.file())
        });
        left.collect()
    }
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary<'a> {
    experiment: &'a str,
    out: &'a Path,
    #[serde(flatten)]
    figures: &'a Figures,
    /// Whether every bound of the experiment is kept.
    bounds_kept: bool,
    segments: &'a [Segment],
}

/// What is flown when nothing is asked for: the paper's flight, and the guidance's own mission; and the page that flies by itself, or, of a
/// program without the library for it, the mission's. It is opened if `open`.
pub fn first(open: bool) -> anyhow::Result<()> {
    for name in [DEFAULT, MISSION] {
        let document = Document::load(name)?;
        let output = (&Output::default(), &Logs::default());
        fly(&document, name, output, |experiment| {
            Ok(experiment.controller()?)
        })?;
    }
    let output = Output::new(false, open);
    let (folder, words) = match library() {
        Ok(library) => {
            let page = output.folder(LIVE)?.join(viewer::FILE);
            leave_all(&page, viewer::live(library)?)?;
            (
                LIVE,
                "The mission, moving, and what you make of it:".to_owned(),
            )
        }
        Err(without) => (
            MISSION,
            format!("The mission, moving, but not to be steered: {without}"),
        ),
    };
    writeln!(std::io::stdout(), "\n{words}")?;
    output.show(&output.folder(folder)?.join(viewer::FILE))
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let document = args.document()?;
    let output = (&args.output, &args.logs);
    fly(&document, &document.name, output, |experiment| {
        Ok(experiment.controller()?)
    })
}

impl Args {
    /// The experiment, as changed.
    pub fn document(&self) -> anyhow::Result<Document> {
        if !self.experiment.ends_with(".plan") {
            ensure!(
                self.vehicle.is_none(),
                "--vehicle is for the mission of a .plan file: an experiment has its own vehicle"
            );
            return self.settings.document(&self.experiment);
        }
        let Some(vehicle) = &self.vehicle else {
            bail!(
                "{}: --vehicle EXPERIMENT says which vehicle flies it",
                self.experiment
            );
        };
        let (mut document, left_out) = of_plan(Path::new(&self.experiment), vehicle)?;
        for item in left_out {
            eprintln!("{}: left out: {item}", self.experiment);
        }
        self.settings.change(&mut document)?;
        Ok(document)
    }
}

/// Flies what `args` say under the controller that `connect` gives; the files are left in `out/<folder>`.
pub fn with(
    args: &Args,
    folder: &str,
    connect: impl FnOnce(&Experiment) -> anyhow::Result<Box<dyn Controller>>,
) -> anyhow::Result<()> {
    let document = args.document()?;
    fly(&document, folder, (&args.output, &args.logs), connect)
}

/// Flies `document` under the controller that `connect` gives, and leaves trace, figure and report in `out/<folder>`.
pub fn fly(
    document: &Document,
    folder: &str,
    (output, logs): (&Output, &Logs),
    connect: impl FnOnce(&Experiment) -> anyhow::Result<Box<dyn Controller>>,
) -> anyhow::Result<()> {
    let experiment = &document.checked()?;
    // Before the flight: a folder that cannot be written should not cost one.
    let out = output.folder(folder)?;
    let mut controller = connect(experiment)?;
    let bar = progress_bar(experiment.steps());
    let mut record = Record::with_capacity(experiment.steps() + 1);
    let end = simulate(experiment, controller.as_mut(), |step| {
        record.push(step.clone());
        if record.len().is_multiple_of(100) {
            bar.set_position(record.len() as u64);
        }
        true
    })?;
    bar.finish_and_clear();

    if let Err(diverged) = end.sound() {
        let trace = out.join("trace.csv");
        leave(&trace, |file| Ok(write_trace(experiment, &record, file)?))?;
        let (name, trace) = (&document.name, trace.display());
        bail!("{name}: {diverged}; {trace} ends there");
    }
    report(document, experiment, &record, &out, output, logs)
}

/// Leaves trace, figure, report and logs of a flight in `out`, and prints its figures.
pub fn report(
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
    out: &Path,
    output: &Output,
    logs: &Logs,
) -> anyhow::Result<()> {
    // A vehicle under somebody else's autopilot is no simulation that ends.
    for step in record {
        Diverged::at(step).with_context(|| document.name.clone())?;
    }
    let figures = Figures::of(experiment, record);
    let segments = Segment::of(experiment, record);
    leave_flight(document, experiment, record, out, |_| ())?;
    let logs = logs.leave(|| flight_log::log(experiment, record), out)?;
    let mut stdout = std::io::stdout().lock();
    if output.json() {
        let summary = Summary {
            experiment: &document.name,
            out,
            figures: &figures,
            bounds_kept: figures.beyond(experiment).is_empty(),
            segments: &segments,
        };
        writeln!(stdout, "{}", serde_json::to_string_pretty(&summary)?)?;
        return Ok(());
    }
    writeln!(stdout, "{}: {}", document.name, experiment.description)?;
    for [label, value, at] in figures.table(experiment) {
        let line = format!("  {label:<28} {value:>14}  {at}");
        writeln!(stdout, "{}", line.trim_end())?;
    }
    if segments.len() > 1 {
        for segment in &segments {
            writeln!(stdout, "  {}", segment.line())?;
        }
    }
    let files = [&["trace.csv", "report.html", viewer::FILE][..], &logs]
        .concat()
        .join(", ");
    writeln!(stdout, "{files} and report.svg are in {}", out.display())?;
    drop(stdout);
    output.show(&out.join("report.html"))
}

/// Leaves trace, picture, report, which `changed` may add to, and the page in three dimensions in `out`.
pub fn leave_flight(
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
    out: &Path,
    changed: impl FnOnce(&mut Page),
) -> anyhow::Result<()> {
    let figures = Figures::of(experiment, record);
    let segments = Segment::of(experiment, record);
    leave(&out.join("trace.csv"), |file| {
        Ok(write_trace(experiment, record, file)?)
    })?;
    let mut page = page(document, experiment, record, &figures, &segments);
    changed(&mut page);
    page.leave(out)?;
    leave_all(
        &out.join(viewer::FILE),
        viewer::page(document, experiment, record)?,
    )
}

/// A bar on standard error, silent where that is not a terminal.
pub fn progress_bar(steps: usize) -> ProgressBar {
    let style = "flying {bar:40} {percent:>3} % {eta} left";
    let bar = ProgressBar::new(steps as u64);
    bar.set_style(ProgressStyle::with_template(style).expect("a valid template"));
    bar
}
