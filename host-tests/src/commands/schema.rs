//! `schema`: what an editor has to know to complete and check experiments.

use std::io::Write;

use alula_sim::schema::schema;

/// Print the JSON Schema of experiment files: editors complete and check by it
#[derive(clap::Args)]
pub struct Args {}

pub fn run(_: &Args) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(&schema())? + "\n";
    Ok(std::io::stdout().write_all(text.as_bytes())?)
}
