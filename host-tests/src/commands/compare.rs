//! `compare`: flights against each other.

use std::path::Path;

use anyhow::{bail, ensure};
use serde::Serialize;

use alula_report::comparison::page;
use alula_report::viewer::Flight;
use alula_sim::kind::Kind;
use alula_sim::simulate::fly;
use alula_study::{Plan, Results, Source};

use super::fly::progress_bar;
use super::output::{Output, leave_view};
use super::settings::{Settings, expect_name};

/// Fly experiments against each other, or the variants of a comparison under its conditions
#[derive(clap::Args)]
pub struct Args {
    /// Experiments, two or more (built-in or TOML files); or one comparison: laws, missions, or a TOML file
    #[arg(value_name = "EXPERIMENT", default_value = "laws")]
    names: Vec<String>,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    output: Output,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary<'a> {
    comparison: &'a str,
    out: &'a Path,
    cells: &'a Results,
}

impl Args {
    fn source(&self) -> anyhow::Result<Source> {
        match &self.names[..] {
            [one] if self.settings.is_empty() => {
                let words = "a comparison, or a second experiment,";
                expect_name(&[Kind::Comparison], words, one)?;
                Source::load(one)
            }
            [_] => bail!("--set changes experiments; a comparison sets fields in its file"),
            several => {
                let load = |name: &String| Ok((name.clone(), self.settings.document(name)?));
                let named: anyhow::Result<Vec<_>> = several.iter().map(load).collect();
                Source::experiments(&named?)
            }
        }
    }
}

/// The flights of the conditions that have charts, of the first seed; not those that diverge.
fn charted(plan: &Plan) -> Vec<Flight> {
    let comparison = &plan.comparison;
    let conditions = comparison.conditions.iter().zip(&plan.experiments);
    let drawn = conditions.filter(|(condition, _)| comparison.charts.contains(&condition.name));
    let all = drawn.flat_map(|(condition, variants)| {
        let variants = comparison.variants.iter().zip(variants);
        variants.filter_map(move |(variant, seeds)| {
            let name = format!("{}, {}", condition.name, variant.name);
            let experiment = seeds.first()?;
            let flight = Flight::of(&name, experiment, &fly(experiment).ok()?);
            Some(Flight {
                lead: format!("{}. {}", condition.title, variant.title),
                ..flight
            })
        })
    });
    all.collect()
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let source = args.source()?;
    let out = args.output.folder(&format!("compare-{}", source.name))?;

    let bar = progress_bar(source.plan.flights());
    let results = Results::of(&source.plan, None, || {
        bar.inc(1);
        Ok(())
    })?;
    bar.finish_and_clear();

    let summary = Summary {
        comparison: &source.name,
        out: &out,
        cells: &results,
    };
    let mut page = page(&source.name, &source.plan.comparison, &results);
    let title = page.title.clone();
    leave_view(&mut page, &out, &title, &charted(&source.plan))?;
    args.output.leave(&out, &page, &summary)?;
    let diverged = results.diverged();
    ensure!(
        diverged == 0,
        "{}: {diverged} flights diverged",
        source.name
    );
    Ok(())
}
