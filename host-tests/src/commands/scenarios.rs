//! `scenarios`: what can be flown by name.

use std::io::Write;

use alula_sil::scenario::{BUILT_IN, Source};

/// List the built-in scenarios, or print the TOML of one
#[derive(clap::Args)]
pub struct Args {
    /// The scenario to print
    name: Option<String>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut stdout = std::io::stdout().lock();
    if let Some(name) = &args.name {
        write!(stdout, "{}", Source::load(name)?.text)?;
        return Ok(());
    }
    for (name, _) in BUILT_IN {
        let description = Source::load(name)?.scenario.description;
        writeln!(stdout, "{name:<18} {description}")?;
    }
    Ok(())
}
