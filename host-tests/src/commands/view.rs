//! `view`: a flight in three dimensions, in a page.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};

use alula_report::viewer::{self, Flight};
use alula_sim::experiment::Document;
use alula_sim::replay::Source;
use alula_sim::scene::{NUMBERS, Scene};
use alula_sim::simulate::fly;
use alula_study::files::leave_all;

use super::output::Output;
use super::settings::Settings;

/// See a flight in three dimensions: an experiment is flown, a trace or log is shown as it was; with --live, a page that flies by itself
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment or a TOML file; or the trace.csv of a flight; or a flight log, over which the controller of --experiment runs
    #[arg(default_value = "mission")]
    flight: String,
    /// Of a trace or log: the experiment that it is of
    #[arg(long, value_name = "EXPERIMENT")]
    experiment: Option<String>,
    #[command(flatten)]
    settings: Settings,
    /// A TOML file that says which column of a foreign CSV is which
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    /// The page that flies the built-in experiments by itself, with sliders, and is steered
    #[arg(long, conflicts_with_all = ["flight", "experiment", "set", "map"])]
    live: bool,
    #[command(flatten)]
    output: Output,
}

/// The folder of the page that flies by itself.
pub const LIVE: &str = "fly";

/// The library for browsers, which the build script compiles; empty where it does not.
const LIBRARY: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/alula_web.wasm"));

/// The library for browsers.
pub fn library() -> anyhow::Result<&'static [u8]> {
    ensure!(
        !LIBRARY.is_empty(),
        "this program was built without the library for browsers: `rustup target add wasm32-unknown-unknown`, and `cargo run --release` again"
    );
    Ok(LIBRARY)
}

/// Endings of recorded flights.
const RECORDED: [&str; 5] = ["csv", "ulg", "bin", "log", "mcap"];

pub fn run(args: &Args) -> anyhow::Result<()> {
    let (folder, page) = match args.live {
        true => (LIVE.to_owned(), viewer::live(library()?)?),
        false => args.flight()?,
    };
    let out = args.output.folder(&folder)?;
    let to = out.join(viewer::FILE);
    leave_all(&to, page)?;
    let mut stdout = std::io::stdout().lock();
    if args.output.json() {
        writeln!(stdout, "{}", serde_json::json!({ "page": to }))?;
    }
    drop(stdout);
    args.output.show(&to)
}

impl Args {
    /// The folder and the page of a flight.
    fn flight(&self) -> anyhow::Result<(String, String)> {
        let path = Path::new(&self.flight);
        let ending = path.extension().and_then(|ending| ending.to_str());
        let recorded =
            ending.is_some_and(|ending| RECORDED.contains(&ending.to_lowercase().as_str()));
        if !recorded {
            let document = self.settings.document(&self.flight)?;
            let experiment = document.checked()?;
            let record = fly(&experiment).with_context(|| document.name.clone())?;
            let page = viewer::page(&document, &experiment, &record)?;
            return Ok((document.name, page));
        }
        let stem = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let title = match path.parent().and_then(Path::file_name) {
            Some(folder) => format!("{}: {}", folder.to_string_lossy(), self.flight_name()),
            None => self.flight_name(),
        };
        let document = match &self.experiment {
            Some(name) => Some(self.settings.document(name)?),
            None => None,
        };
        if is_trace(path)? {
            let file = File::open(path).with_context(|| self.flight.clone())?;
            let scene = Scene::read(file).with_context(|| self.flight.clone())?;
            let experiment = document.map(|document| document.checked()).transpose()?;
            let flight = Flight {
                name: stem.clone(),
                lead: "As recorded in the trace.".to_owned(),
                scene,
                curves: experiment.map(|experiment| viewer::curves(&experiment)),
            };
            return Ok((format!("view/{stem}"), viewer::recorded(&title, &[flight])?));
        }
        let document = match document {
            Some(document) => document,
            None => Document::load("mission")?,
        };
        let experiment = document.checked()?;
        let (record, said) = Source::open(path, self.map.as_ref())?.replay(&experiment)?;
        for line in &said {
            eprintln!("note: {line}");
        }
        let flight = viewer::replayed(&stem, &document, &experiment, &record);
        let page = viewer::recorded(&title, &[flight])?;
        Ok((format!("view/{stem}"), page))
    }

    fn flight_name(&self) -> String {
        let path = Path::new(&self.flight);
        path.file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    }
}

/// Whether a file is a trace of ours, with the vehicle's place and attitude.
fn is_trace(path: &Path) -> anyhow::Result<bool> {
    use std::io::{BufRead, BufReader};
    let file = File::open(path).with_context(|| path.display().to_string())?;
    let mut line = Vec::new();
    BufReader::new(file).read_until(b'\n', &mut line)?;
    let line = String::from_utf8_lossy(&line).into_owned();
    let names: Vec<&str> = line.trim().split(',').collect();
    Ok(NUMBERS[..11].iter().all(|name| names.contains(name)))
}
