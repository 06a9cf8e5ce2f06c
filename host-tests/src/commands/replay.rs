//! `replay`: a controller over a flight log.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};

use alula_sil::experiment::{DEFAULT, Document, Experiment};
use alula_sil::files::leave;
use alula_sil::page::Page;
use alula_sil::page::replay::{page, page_in_space};
use alula_sil::replay::{self, Source};
use alula_sil::space;

use super::settings::Settings;

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
    /// Heading of the vertical plane of the flight [°] [default: the plane that the wing is square to]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    heading: Option<f64>,
    /// Leave commands.csv, replay.svg and replay.html in this folder, and nothing on standard output
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    let source = Source::open(&args.file, args.map.as_ref(), args.heading)?;
    if document.get("path").is_some() {
        return args.in_space(source, &document);
    }
    let experiment = document.checked()?;
    let Some(out) = &args.out else {
        let stdout = std::io::stdout().lock();
        tell(&source.replay(stdout, &experiment, |_| ())?);
        return Ok(());
    };
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    args.leave(source, out, &document, &experiment)
}

impl Args {
    /// Leaves commands and page in `out`.
    fn leave(
        &self,
        source: Source,
        out: &Path,
        document: &Document,
        experiment: &Experiment,
    ) -> anyhow::Result<()> {
        let mut record = Vec::new();
        let mut said = Vec::new();
        leave(&out.join("commands.csv"), |file| {
            said = source.replay(file, experiment, |step| record.push(step))?;
            Ok(())
        })?;
        let page = page(&self.name(), document, experiment, &record, &said);
        show(&page, out)
    }

    /// The guidance of an experiment with a path.
    fn in_space(&self, source: Source, document: &Document) -> anyhow::Result<()> {
        ensure!(
            self.heading.is_none(),
            "--heading: the guidance in space needs no plane"
        );
        let experiment = space::Experiment::of(document)?;
        let (record, said) = replay::space::replay(&source.states()?, &experiment)?;
        let Some(out) = &self.out else {
            tell(&said);
            return Ok(replay::space::write(
                &experiment,
                &record,
                std::io::stdout().lock(),
            )?);
        };
        std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
        leave(&out.join("commands.csv"), |file| {
            Ok(replay::space::write(&experiment, &record, file)?)
        })?;
        let page = page_in_space(&self.name(), document, &experiment, &record, &said);
        show(&page, out)
    }

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
    page.leave(out, ["replay.svg", "replay.html"])?;
    let mut stdout = std::io::stdout().lock();
    writeln!(stdout, "{}", page.text())?;
    let files = "commands.csv, replay.html and replay.svg";
    writeln!(stdout, "{files} are in {}", out.display())?;
    Ok(())
}
