//! `tune`: search for the constants of planner and reference model.

use std::fmt::Write as _;
use std::io::Write;
use std::num::NonZero;
use std::path::PathBuf;
use std::time::Instant;

use alula::{Parameters as _, Tuning};
use alula_sim::experiment::{file_name, file_value, from_toml};
use alula_sim::kind::Kind;
use alula_sim::named::text_of;
use alula_study::files::{leave_all, make_folder};
use alula_study::tune::{FACTORS, Objective, Trial, Tuner};
use anyhow::Context as _;

const BUILT_IN: &str = include_str!("../../tuning.toml");

/// Search for the constants of planner and reference model, from nothing
#[derive(clap::Args)]
pub struct Args {
    /// What is flown and what it costs, as TOML [default: that by which the constants were found]
    objective: Option<PathBuf>,
    /// Number of trials, in place of the objective's own
    #[arg(long, value_name = "N")]
    trials: Option<usize>,
    /// Do not search: say what each constant may be changed by
    #[arg(long)]
    sensitivity: bool,
    /// Number of threads [default: one per core]
    #[arg(long, value_name = "N")]
    threads: Option<NonZero<usize>>,
    /// Folder for tuning.toml, the constants found
    #[arg(long, value_name = "DIR", default_value = "out/tune")]
    out: PathBuf,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let (origin, text) = match &args.objective {
        Some(path) => {
            let origin = path.display().to_string();
            (origin, text_of(path)?)
        }
        None => ("tuning.toml".to_owned(), BUILT_IN.to_owned()),
    };
    Kind::Search.expect(&origin, text.as_bytes())?;
    let mut objective: Objective = from_toml(&origin, &text, |_| Ok(()))?;
    objective.trials = args.trials.unwrap_or(objective.trials);
    let mut out = std::io::stdout().lock();
    let begun = Instant::now();
    let tuner = Tuner::new(&objective, args.threads).with_context(|| origin.clone())?;
    let now = Tuning::default();
    let committed = tuner.trials(&[now])?;
    let committed = committed.first().context("one was asked for")?;
    let before = committed.objective();
    let flights = tuner.flights();
    writeln!(
        out,
        "The constants as they are: objective {before:.3}, {} of {flights} flights outside a limit of their campaign",
        committed.outside
    )?;
    if args.sensitivity {
        writeln!(
            out,
            "Objective over that, and flights outside, with one constant changed:\n"
        )?;
        let percent = FACTORS.map(|factor| format!("{:+.0} %", 100.0 * (factor - 1.0)));
        writeln!(out, "| constant | value | {} |", percent.join(" | "))?;
        writeln!(out, "|---|---:|{}", "---:|".repeat(FACTORS.len()))?;
        for (i, row) in Tuning::ROWS.iter().enumerate() {
            let trials = tuner.changed(&now, i)?;
            let cell =
                |trial: &Trial| format!("{:.2}, {}", trial.objective() / before, trial.outside);
            let cells: Vec<String> = trials.iter().map(cell).collect();
            writeln!(
                out,
                "| `{}` | {} | {} |",
                row.name,
                now.get(i),
                cells.join(" | ")
            )?;
            out.flush()?;
        }
        return Ok(());
    }
    make_folder(&args.out)?;
    let file = args.out.join("tuning.toml");
    let best = tuner.search(&objective, |trials, best| {
        let minutes = begun.elapsed().as_secs_f64() / 60.0;
        let least = best.objective();
        writeln!(
            out,
            "{trials:>6} trials  {minutes:6.1} min  best {least:.3}"
        )?;
        out.flush()?;
        // What was found before an interruption stays.
        leave_all(&file, table(best, before, trials))
    })?;
    leave_all(&file, table(&best, before, objective.trials))?;
    let (name, after) = ("mean cost of flights", best.objective());
    writeln!(out, "  {name:<20} {:>8} {:>8}", "as is", "found")?;
    let rows = tuner
        .groups()
        .iter()
        .zip(committed.costs.iter().zip(&best.costs));
    for (group, (before, after)) in rows {
        writeln!(out, "  {group:<20} {before:>8.3} {after:>8.3}")?;
    }
    let change = 100.0 * (after / before - 1.0);
    writeln!(
        out,
        "  {:<20} {before:>8.3} {after:>8.3}  ({change:+.1} %)",
        "objective"
    )?;
    writeln!(out, "left {}, a table for an experiment", file.display())?;
    Ok(())
}

/// The constants as a table of an experiment.
fn table(best: &Trial, before: f64, trials: usize) -> String {
    let after = best.objective();
    let mut text = format!(
        "# Found by alula-sil tune in {trials} trials: objective {after:.4}; with those in the library {before:.4}.\n\
         [controller.guidance.tuning]\n"
    );
    for (i, row) in Tuning::ROWS.iter().enumerate() {
        let value = file_value(row, best.tuning.get(i));
        // A string takes any text.
        let _ = writeln!(text, "{} = {value:.5}", file_name(row));
    }
    text
}
