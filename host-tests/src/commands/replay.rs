//! `replay`: a controller over a flight log.

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use alula_logs::states::{self, States};
use anyhow::Context;

use alula_sil::experiment::{DEFAULT, Document, Experiment};
use alula_sil::files::leave;
use alula_sil::page::replay::page;
use alula_sil::replay::log::{self, Plane};
use alula_sil::replay::trace;
use alula_sil::simulate::Step;

use super::settings::Settings;

/// Run a controller open loop over a logged flight; write its commands as CSV on standard output
#[derive(clap::Args)]
pub struct Args {
    /// The log: a CSV file such as a flight's trace.csv, a PX4 ULog, or an ArduPilot DataFlash log (.bin, .log)
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

/// What is replayed.
enum Source {
    /// A CSV with the columns of a trace.
    Trace(File),
    /// Anything else.
    Log(Box<States>),
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    let experiment = document.checked()?;
    let source = args.source()?;
    let Some(out) = &args.out else {
        let stdout = std::io::stdout().lock();
        args.replay(source, stdout, &experiment, |_| ())?;
        return Ok(());
    };
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    args.leave(source, out, &document, &experiment)
}

impl Args {
    /// Runs the controller over `source`; what had to be assumed.
    fn replay(
        &self,
        source: Source,
        to: impl Write,
        experiment: &Experiment,
        visit: impl FnMut(Step),
    ) -> anyhow::Result<Vec<String>> {
        let origin = self.file.display().to_string();
        match source {
            Source::Trace(file) => {
                trace::replay(&origin, file, to, experiment, visit)?;
                Ok(Vec::new())
            }
            Source::Log(states) => {
                let plane = self.heading.map(|h| Plane::through(h.to_radians()));
                log::replay(&states, plane, to, experiment, visit).context(origin)
            }
        }
    }

    fn source(&self) -> anyhow::Result<Source> {
        let origin = self.file.display().to_string();
        let mut head = Vec::new();
        let file = File::open(&self.file).with_context(|| origin.clone())?;
        let read = file.take(1 << 16).read_to_end(&mut head);
        read.with_context(|| origin.clone())?;
        let log = match &self.map {
            Some(map) => {
                let name = map.display().to_string();
                let text = std::fs::read_to_string(map).with_context(|| name.clone())?;
                let map = alula_logs::csv::Map::parse(&name, &text)?;
                let bytes = std::fs::read(&self.file).with_context(|| origin.clone())?;
                alula_logs::csv::read(&origin, &bytes, Some(&map))?
            }
            None if alula_logs::is_autopilots(&self.file, &head) => alula_logs::read(&self.file)?,
            None => {
                let file = File::open(&self.file).with_context(|| origin.clone())?;
                return Ok(Source::Trace(file));
            }
        };
        let mut states = states::find(&log).context(origin)?;
        states.notes.splice(0..0, log.notes);
        Ok(Source::Log(Box::new(states)))
    }

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
            said = self.replay(source, file, experiment, |step| record.push(step))?;
            Ok(())
        })?;
        let name = self.file.file_name().unwrap_or(self.file.as_os_str());
        let page = page(
            &name.to_string_lossy(),
            document,
            experiment,
            &record,
            &said,
        );
        page.leave(out, ["replay.svg", "replay.html"])?;
        let mut stdout = std::io::stdout().lock();
        writeln!(stdout, "{}", page.text())?;
        let files = "commands.csv, replay.html and replay.svg";
        writeln!(stdout, "{files} are in {}", out.display())?;
        Ok(())
    }
}
