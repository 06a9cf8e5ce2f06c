//! The command line: one file per subcommand, each with its arguments and a `run`.

mod attitudes;
mod autopilot;
mod campaign;
mod code;
mod companion;
mod compare;
mod completions;
mod envelope;
mod equilibria;
mod fit;
mod fly;
mod gallery;
mod identify;
mod list;
mod margins;
mod new;
mod output;
mod pil;
mod plans;
mod preflight;
mod replay;
mod schema;
mod settings;
mod sitl;
mod sweep;
mod tune;
mod view;

use clap::{Parser, Subcommand};

/// Flies alula's control laws in software. Without a subcommand: the paper's hover-to-cruise flight, and the guidance's own mission
#[derive(Parser)]
#[command(name = "alula-sil", version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// Open the page on which the mission moves, and which is steered, in the browser
    #[arg(long)]
    open: bool,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    New(new::Args),
    Code(code::Args),
    Identify(identify::Args),
    Fly(fly::Args),
    View(view::Args),
    Pil(pil::Args),
    List(list::Args),
    Gallery(gallery::Args),
    Replay(replay::Args),
    Sitl(sitl::Args),
    Preflight(preflight::Args),
    Companion(companion::Args),
    Campaign(campaign::Args),
    Compare(compare::Args),
    Margins(margins::Args),
    Envelope(envelope::Args),
    Equilibria(equilibria::Args),
    Sweep(sweep::Args),
    Plans(plans::Args),
    Tune(tune::Args),
    Fit(fit::Args),
    Schema(schema::Args),
    Completions(completions::Args),
}

impl Cli {
    /// Does what was asked. What is odd about a polar is said on standard error, where the command's own page does not.
    pub fn run(self) -> anyhow::Result<()> {
        let shown = matches!(self.command, Some(Command::New(_) | Command::Fit(_)));
        let done = self.act();
        for warning in alula_sim::polar::warnings().iter().filter(|_| !shown) {
            eprintln!("warning: {warning}");
        }
        done
    }

    fn act(self) -> anyhow::Result<()> {
        match self.command {
            None => fly::first(self.open),
            Some(Command::New(args)) => new::run(&args),
            Some(Command::Identify(args)) => identify::run(&args),
            Some(Command::Code(args)) => code::run(&args),
            Some(Command::Fly(args)) => fly::run(&args),
            Some(Command::View(args)) => view::run(&args),
            Some(Command::Pil(args)) => pil::run(&args),
            Some(Command::List(args)) => list::run(&args),
            Some(Command::Gallery(args)) => gallery::run(&args),
            Some(Command::Replay(args)) => replay::run(&args),
            Some(Command::Sitl(args)) => sitl::run(&args),
            Some(Command::Preflight(args)) => preflight::run(&args),
            Some(Command::Companion(args)) => companion::run(&args),
            Some(Command::Campaign(args)) => campaign::run(&args),
            Some(Command::Compare(args)) => compare::run(&args),
            Some(Command::Margins(args)) => margins::run(&args),
            Some(Command::Envelope(args)) => envelope::run(&args),
            Some(Command::Equilibria(args)) => equilibria::run(&args),
            Some(Command::Sweep(args)) => sweep::run(&args),
            Some(Command::Plans(args)) => plans::run(&args),
            Some(Command::Tune(args)) => tune::run(&args),
            Some(Command::Fit(args)) => fit::run(&args),
            Some(Command::Schema(args)) => schema::run(&args),
            Some(Command::Completions(args)) => completions::run(&args),
        }
    }
}
