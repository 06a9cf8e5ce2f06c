//! `list`: what can be flown by name.

use std::io::Write;

use alula_sim::experiment::{BUILT_IN, Document};
use alula_sim::named::Named;

use super::settings::expect_experiment;

/// List the built-in experiments and vehicles, or print the TOML of one
#[derive(clap::Args)]
pub struct Args {
    /// The experiment to print
    name: Option<String>,
    /// Print it with its bases, as one text
    #[arg(long, requires = "name")]
    whole: bool,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut stdout = std::io::stdout().lock();
    if let Some(name) = &args.name {
        expect_experiment(name)?;
        let text = match args.whole {
            true => Document::load(name)?.text(),
            false => Named::find("experiment", BUILT_IN, name)?.text,
        };
        write!(stdout, "{text}")?;
        return Ok(());
    }
    for (name, _) in BUILT_IN {
        let document = Document::load(name)?;
        let description = document.get("description").and_then(|text| text.as_str());
        let kind = match document.data() {
            Ok(experiment) if experiment.in_plane() => "",
            Ok(_) => "in space: ",
            Err(_) => "vehicle: ",
        };
        let description = description.unwrap_or_default();
        writeln!(stdout, "{name:<18} {kind}{description}")?;
    }
    Ok(())
}
