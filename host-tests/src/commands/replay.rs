//! `replay`: a controller over a flight log.

use std::io::Write;
use std::path::{Path, PathBuf};

use alula_report::Page;
use alula_report::replay::page;
use alula_report::viewer;
use alula_sim::experiment::DEFAULT;
use alula_sim::kind::Kind;
use alula_sim::replay::{self, Source};
use alula_study::files::{leave, make_folder};

use super::output::leave_view;
use super::settings::{Settings, expect_name};

/// Run a controller open loop over a logged flight; write its commands as CSV on standard output
#[derive(clap::Args)]
pub struct Args {
    /// The log: a CSV file such as a flight's trace.csv, a PX4 ULog, MCAP, or an ArduPilot DataFlash log (.bin, .log)
    file: PathBuf,
    /// The experiment whose controller is run: a built-in or a TOML file
    #[arg(long, default_value = DEFAULT)]
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    /// A TOML file that says which column of a foreign CSV is which
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// Leave commands.csv, report.svg, report.html and view.html in this folder, and nothing on standard output
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let argument = args.file.to_string_lossy();
    expect_name(&[Kind::Trace, Kind::Log], "a trace or a log", &argument)?;
    let document = args.settings.document(&args.experiment)?;
    let source = Source::open(&args.file, args.map.as_ref())?;
    let experiment = document.checked()?;
    let (record, said) = source.replay(&experiment)?;
    let Some(out) = &args.out else {
        let stdout = std::io::stdout().lock();
        tell(&said);
        return Ok(replay::write(&experiment, &record, stdout)?);
    };
    make_folder(out)?;
    leave(&out.join("commands.csv"), |file| {
        Ok(replay::write(&experiment, &record, file)?)
    })?;
    let mut page = page(&args.name(), &document, &experiment, &record, &said);
    let flight = viewer::replayed(&args.name(), &document, &experiment, &record);
    leave_view(&mut page, out, &args.name(), &[flight])?;
    show(&page, out)
}

impl Args {
    /// The log's name.
    fn name(&self) -> String {
        let name = self.file.file_name().unwrap_or(self.file.as_os_str());
        name.to_string_lossy().into_owned()
    }
}

/// What had to be assumed, where no page says it.
fn tell(said: &[String]) {
    for line in said {
        eprintln!("note: {line}");
    }
}

/// Leaves the page in `out`, and prints it.
fn show(page: &Page, out: &Path) -> anyhow::Result<()> {
    page.leave(out)?;
    let mut stdout = std::io::stdout().lock();
    writeln!(stdout, "{}", page.text())?;
    let files = "commands.csv, report.html, view.html and report.svg";
    writeln!(stdout, "{files} are in {}", out.display())?;
    Ok(())
}
