//! `sweep`: the equilibria along an experiment's reference, and what stands against flying it.

use anyhow::{Context, anyhow};
use serde::Serialize;

use alula_design::sweep::{Cause, Findings, Span, findings, least_fp, sweep};
use alula_report::sweep::figure;
use alula_report::viewer::Flight;
use alula_report::{Page, Table, fixed};
use alula_sim::simulate::fly;

use super::output::{Output, leave_view};
use super::settings::Settings;

/// Check a planned flight: where its equilibrium jumps, where the apparent force is too small, where it needs negative thrust
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment or a TOML file
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    /// Least apparent force |F_p| to allow [N] [default: τ of the experiment's controller]
    #[arg(long, value_name = "N")]
    min_fp: Option<f64>,
    #[command(flatten)]
    output: Output,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary {
    experiment: String,
    min_fp_n: f64,
    /// Who flies it.
    verdict: &'static str,
    #[serde(flatten)]
    findings: Findings,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    let experiment = &document.checked()?;
    let least_fp = match args.min_fp {
        Some(least) => least,
        None => least_fp(experiment)?,
    };
    if !least_fp.is_finite() || least_fp < 0.0 {
        return Err(anyhow!(
            "--min-fp: must be a finite number and not negative"
        ));
    }
    let out = args.output.folder(&format!("sweep-{}", document.name))?;
    let instants = sweep(experiment)?;
    let findings = findings(&instants, least_fp);
    let verdict = verdict(&findings, &experiment.controller.kind);
    let record = fly(experiment).with_context(|| document.name.clone())?;
    let mut page = Page {
        title: format!("Sweep of {}", document.name),
        lead: format!(
            "{}; {}",
            experiment.description.trim_end_matches('.'),
            verdict
        ),
        figure: figure(experiment, &instants, &record, &findings, least_fp),
        tables: tables(&findings, least_fp),
        notes: "Grey dots: the equilibria of the true vehicle at each moment of the reference. Blue: the one that a law follows (θ̃ = 0, the nearest to the one before). \
                Orange: the orientation as flown. Where blue jumps, no orientation between holds the reference: whatever flies it turns through and is off the reference meanwhile, \
                by as much as the way it takes. Where the apparent force is small, its direction, by which a law steers, turns fast."
            .to_owned(),
        ..Page::default()
    };
    let title = page.title.clone();
    let flight = Flight::of(&document.name, experiment, &record);
    leave_view(&mut page, &out, &title, &[flight])?;
    let summary = Summary {
        experiment: document.name.clone(),
        min_fp_n: least_fp,
        verdict,
        findings,
    };
    args.output.leave(&out, &page, &summary)
}

/// What the findings come to for a controller of this kind.
fn verdict(findings: &Findings, controller: &str) -> &'static str {
    match (findings.admissible, controller) {
        (true, _) => "nothing stands against it",
        (false, "guidance") => {
            "the guidance crosses what is listed on purpose, `fly` says how closely; a law alone would lose its equilibrium there"
        }
        (false, _) => {
            "the law of this experiment loses its equilibrium where listed, and catches up behind. The guidance crosses such places on purpose: `new` makes it for a vehicle, `fly round-trip` flies one"
        }
    }
}

fn tables(findings: &Findings, least_fp: f64) -> Vec<Table> {
    let because = |cause: Cause| match cause {
        Cause::Fold => "fold",
        Cause::Corner => "corner of the reference",
    };
    let spans = |title: &str, value, spans: &[Span]| {
        Table::of(
            title,
            spans,
            &[
                ("from [s]", &|s| fixed(s.from_s, 3)),
                ("to [s]", &|s| fixed(s.to_s, 3)),
                (value, &|s| fixed(s.least, 3)),
            ],
        )
    };
    let low = format!("Apparent force |F_p| below {least_fp:.2} N");
    let tables = [
        Table::of(
            "Jumps of the equilibrium",
            &findings.jumps,
            &[
                ("at [s]", &|j| fixed(j.t_s, 3)),
                ("θ from [°]", &|j| fixed(j.from_theta_deg, 2)),
                ("to", &|j| fixed(j.to_theta_deg, 2)),
                ("α from [°]", &|j| fixed(j.from_alpha_deg, 2)),
                ("to", &|j| fixed(j.to_alpha_deg, 2)),
                ("because", &|j| because(j.cause).to_owned()),
            ],
        ),
        spans(&low, "least [N]", &findings.low_fp),
        spans("Negative thrust", "least [N]", &findings.negative_thrust),
        spans("No equilibrium with θ̃ = 0", "others", &findings.none),
    ];
    tables.into_iter().filter(|t| !t.rows.is_empty()).collect()
}
