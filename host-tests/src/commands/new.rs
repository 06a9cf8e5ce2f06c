//! `new`: from what a person knows of a vehicle to its files, its first flight and a page.

use std::io::{BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};

use anyhow::{bail, ensure};
use serde::Serialize;

use alula_design::{Design, Facts, Findings, FirstFlight, Known, Limits, Outcome, check_name};
use alula_report::design::{judge, page};
use alula_sim::named::in_shell;
use alula_study::files::{leave_all, make_folder};

use super::fly::leave_flight;
use super::output::Output;

/// Make a vehicle's files from what is known of it: vehicle, gains and limits with their reasons, margins, envelope, a first flight
#[derive(clap::Args)]
pub struct Args {
    /// Its name, that of its files and of their folder
    #[arg(default_value = "my-vehicle")]
    name: String,
    /// A file with what is known: `mass_kg = 3.0` and so on, names as those of the flags. What is missing is asked for, on a terminal
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    #[command(flatten)]
    known: Known,
    /// Folder for the files [default: the name]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Overwrite files that are there already
    #[arg(long)]
    force: bool,
    /// Print one JSON object instead of the tables
    #[arg(long)]
    json: bool,
    /// Open the vehicle's page in the browser
    #[arg(long)]
    open: bool,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary<'a> {
    name: &'a str,
    out: &'a Path,
    facts: &'a Facts,
    limits: Limits,
    #[serde(flatten)]
    findings: &'a Findings,
    first_flight: serde_json::Map<String, serde_json::Value>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    check_name(&args.name)?;
    let design = Design::new(known(args)?.facts()?)?;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from(&args.name));
    let name = &args.name;
    let file = out.join(format!("{name}.toml"));
    ensure!(
        args.force || !file.exists(),
        "{} is there already: --force writes it anew, or choose another name, or --out",
        file.display()
    );
    make_folder(&out)?;
    let (design, flown) = design.as_it_brakes(name);
    for (file, text) in design.files(name) {
        leave_all(&out.join(file), text)?;
    }

    let flight = FirstFlight::of(&design, flown?)?;
    let first = out.join("first-flight");
    make_folder(&first)?;
    let verdict = &flight.findings.verdict;
    leave_flight(
        &flight.document,
        &flight.experiment,
        &flight.record,
        &first,
        |page| judge(page, verdict),
    )?;
    let mut page = page(name, &design, &flight);
    // On a terminal the verdict is what stands last: of a flight that fails it is the error.
    let text = page.text();
    judge(&mut page, verdict);
    page.leave(&out)?;
    let fails = verdict.outcome == Outcome::Fails;
    let mut stdout = std::io::stdout().lock();
    if args.json {
        let summary = Summary {
            name,
            out: &out,
            facts: &design.facts,
            limits: design.limits()?,
            findings: &flight.findings,
            first_flight: flight.figures.json(),
        };
        writeln!(stdout, "{}", serde_json::to_string_pretty(&summary)?)?;
    } else {
        let what = format!(
            "{name}.toml, {name}-campaign.toml, vehicle.h, vehicle.rs, report.html, first-flight/report.html and first-flight/view.html are in {}.",
            out.display()
        );
        if fails {
            writeln!(stdout, "{text}\n{what}")?;
        } else {
            let program = program();
            let word = |path: &Path| in_shell(&path.to_string_lossy());
            let verdict = verdict.text();
            let campaign = word(&out.join(format!("{name}-campaign.toml")));
            writeln!(
                stdout,
                "{text}\n{verdict}.\n\n{what} Next:\n  {program} fly {}\n  {program} campaign {campaign}",
                word(&file)
            )?;
        }
    }
    drop(stdout);
    Output::new(args.json, args.open).show(&out.join("report.html"))?;
    if fails {
        bail!(
            "{name}: {}. The files are there to look into it",
            verdict.text()
        );
    }
    Ok(())
}

/// How this program is called: by its name where a shell finds it, or else by where it is.
fn program() -> String {
    let called = std::env::args().next().unwrap_or_default();
    match called.contains(std::path::MAIN_SEPARATOR) {
        true => in_shell(&called),
        false => "alula-sil".to_owned(),
    }
}

/// What the flags say, then the file, then who sits at the terminal.
fn known(args: &Args) -> anyhow::Result<Known> {
    let mut known = args.known.clone();
    if let Some(path) = &args.from {
        known = known.or(Known::load(path)?);
    }
    if std::io::stdin().is_terminal() {
        known.ask(|question| {
            let mut stderr = std::io::stderr();
            write!(stderr, "{question}: ")?;
            stderr.flush()?;
            let mut answer = String::new();
            let read = std::io::stdin().lock().read_line(&mut answer)?;
            ensure!(read > 0, "no answer");
            Ok(answer)
        })?;
    }
    Ok(known)
}
