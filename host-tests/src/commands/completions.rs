//! `completions`: what a shell has to know to complete the command line.

use std::io::Write;

use clap::CommandFactory;
use clap_complete::{Shell, generate};

use super::Cli;

/// The program's name.
const NAME: &str = "alula-sil";

/// Print the completion script of a shell
#[derive(clap::Args)]
pub struct Args {
    shell: Shell,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut command = Cli::command();
    // Into memory first: the generator panics where a pipe is closed.
    let mut script = Vec::new();
    generate(args.shell, &mut command, NAME, &mut script);
    let mut script = String::from_utf8(script)?;
    // clap_complete 4.6 looks for the cases of subcommands under a name in which it has taken the hyphen for a space.
    if let (Shell::Bash, Some((first, rest))) = (args.shell, NAME.split_once('-')) {
        script = script.replace(
            &format!("{first}__subcmd__{rest}"),
            &format!("{first}__{rest}"),
        );
    }
    Ok(std::io::stdout().write_all(script.as_bytes())?)
}
