//! The command line: one file per subcommand, each with its arguments and a `run`.

mod campaign;
mod compare;
mod envelope;
mod equilibria;
mod fit;
mod fly;
mod margins;
mod mission;
mod output;
mod pil;
mod replay;
mod scenarios;
mod sweep;

use clap::{Parser, Subcommand};

/// Flies alula's control laws in software. Without a subcommand: the paper's hover-to-cruise flight.
#[derive(Parser)]
#[command(name = "alula-sil", version)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    Fly(fly::Args),
    Mission(mission::Args),
    Campaign(campaign::Args),
    Margins(margins::Args),
    Compare(compare::Args),
    Pil(pil::Args),
    Replay(replay::Args),
    Scenarios(scenarios::Args),
    Envelope(envelope::Args),
    Equilibria(equilibria::Args),
    Sweep(sweep::Args),
    Fit(fit::Args),
}

impl Cli {
    /// Does what was asked.
    pub fn run(self) -> anyhow::Result<()> {
        match self.command {
            None => fly::run(&fly::Args::default()),
            Some(Command::Fly(args)) => fly::run(&args),
            Some(Command::Mission(args)) => mission::run(&args),
            Some(Command::Campaign(args)) => campaign::run(&args),
            Some(Command::Margins(args)) => margins::run(&args),
            Some(Command::Compare(args)) => compare::run(&args),
            Some(Command::Pil(args)) => pil::run(&args),
            Some(Command::Replay(args)) => replay::run(&args),
            Some(Command::Scenarios(args)) => scenarios::run(&args),
            Some(Command::Envelope(args)) => envelope::run(&args),
            Some(Command::Equilibria(args)) => equilibria::run(&args),
            Some(Command::Sweep(args)) => sweep::run(&args),
            Some(Command::Fit(args)) => fit::run(&args),
        }
    }
}
