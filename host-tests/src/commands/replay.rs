//! `replay`: a controller over a flight log.

use std::fs::File;
use std::path::PathBuf;

use anyhow::Context;

use alula_sil::experiment::DEFAULT;
use alula_sil::replay::replay;

use super::settings::Settings;

/// Run a controller open loop over a logged flight; write its commands as CSV on standard output
#[derive(clap::Args)]
pub struct Args {
    /// The log: a CSV file such as a flight's trace.csv
    file: PathBuf,
    /// The experiment whose controller is run: a built-in or a TOML file
    #[arg(long, default_value = DEFAULT)]
    experiment: String,
    #[command(flatten)]
    settings: Settings,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let experiment = args.settings.document(&args.experiment)?.checked()?;
    let origin = args.file.display().to_string();
    let log = File::open(&args.file).with_context(|| origin.clone())?;
    replay(&origin, log, std::io::stdout().lock(), &experiment)
}
