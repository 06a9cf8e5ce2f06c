//! `plans`: what the planner looked at in a flight, and what it chose.

use anyhow::{Context, ensure};
use serde::Serialize;

use alula_report::plans::{Choice, choices, figure};
use alula_report::{Page, Table, fixed};
use alula_sim::scene::Scene;
use alula_sim::simulate::{Step, fly};

use super::output::Output;
use super::settings::Settings;

/// The plans of a flight: candidates, costs and choices of the guidance's planner
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment or a TOML file
    #[arg(default_value = "round-trip")]
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    /// From when [s] [default: the beginning]
    #[arg(long, value_name = "T")]
    from_s: Option<f64>,
    /// To when [s] [default: the end]
    #[arg(long, value_name = "T")]
    to_s: Option<f64>,
    #[command(flatten)]
    output: Output,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary {
    experiment: String,
    choices: Vec<Choice>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    let experiment = &document.checked()?;
    let out = args.output.folder(&format!("plans-{}", document.name))?;
    let record = fly(experiment).with_context(|| document.name.clone())?;
    let from = args.from_s.unwrap_or(0.0);
    let to = args.to_s.unwrap_or(experiment.duration_s);
    let within = |step: &Step| (from..=to).contains(&step.t);
    let record: Vec<Step> = record.into_iter().filter(within).collect();
    let scene = Scene::of(experiment, &record);
    ensure!(
        !scene.plans.is_empty(),
        "{}: no plan from {from} to {to} s: the guidance makes them in flight, a law none",
        document.name
    );
    let choices = choices(&scene);
    let angle = |angle: Option<f64>| angle.map_or("–".to_owned(), |angle| fixed(angle, 0));
    let table = Table::of(
        "Plans adopted in place of those in force",
        &choices,
        &[
            ("at [s]", &|one: &Choice| fixed(one.t_s, 2)),
            ("turn to θ [°]", &|one| angle(one.theta_deg)),
            ("α there [°]", &|one| angle(one.alpha_deg)),
            ("push-over [s]", &|one| fixed(one.push_over_s, 2)),
            ("cost [s]", &|one| fixed(one.cost_s, 2)),
            ("in force [s]", &|one| fixed(one.in_force_s, 2)),
            ("looked at", &|one| one.looked_at.to_string()),
        ],
    );
    let page = Page {
        title: format!("Plans of {}", document.name),
        lead: format!(
            "{}; from {from} to {to} s",
            experiment.description.trim_end_matches('.')
        ),
        figure: figure(experiment, &record, &scene),
        tables: vec![table],
        notes: "Each candidate is flown ahead by the believed vehicle; docs/guidance.md says what it costs. A turn without an angle leaves all to the servo. \
                What costs more than the best so far is cut short: its cost is not known."
            .to_owned(),
        ..Page::default()
    };
    let summary = Summary {
        experiment: document.name.clone(),
        choices,
    };
    args.output.leave(&out, &page, &summary)
}
