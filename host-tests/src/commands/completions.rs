//! `completions`: what a shell has to know to complete the command line.

use clap::CommandFactory;
use clap_complete::{Shell, generate};

use super::Cli;

/// Print the completion script of a shell
#[derive(clap::Args)]
pub struct Args {
    shell: Shell,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut command = Cli::command();
    // Into memory first: the generator panics where a pipe is closed.
    let mut script = Vec::new();
    generate(args.shell, &mut command, "alula-sil", &mut script);
    Ok(std::io::Write::write_all(&mut std::io::stdout(), &script)?)
}
