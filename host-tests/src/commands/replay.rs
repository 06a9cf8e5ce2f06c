//! `replay`: the law over a flight log.

use std::fs::File;
use std::path::PathBuf;

use anyhow::Context;

use alula_sil::flight::Local;
use alula_sil::replay::replay;
use alula_sil::scenario::{DEFAULT, Source};

/// Run the controller open loop over a logged flight; write its commands as CSV on standard output
#[derive(clap::Args)]
pub struct Args {
    /// The log: a CSV file such as a flight's trace.csv
    file: PathBuf,
    /// The scenario whose controller is run: a built-in or a TOML file
    #[arg(long, default_value = DEFAULT)]
    scenario: String,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let source = Source::load(&args.scenario)?;
    let mut controller = Local::new(&source.scenario).expect("validated when loaded");
    let origin = args.file.display().to_string();
    let log = File::open(&args.file).with_context(|| origin.clone())?;
    let feed_forward = source.scenario.controller.feed_forward;
    let stdout = std::io::stdout().lock();
    replay(&origin, log, stdout, &mut controller, feed_forward)
}
