//! `compare`: flights against each other.

use std::path::Path;

use anyhow::{bail, ensure};
use serde::Serialize;

use alula_report::comparison::page;
use alula_study::{Results, Source};

use super::fly::progress_bar;
use super::output::Output;
use super::settings::Settings;

/// Fly experiments against each other, or the variants of a comparison under its conditions
#[derive(clap::Args)]
pub struct Args {
    /// Experiments, two or more (built-in or TOML files); or one comparison: the built-in one, or a TOML file
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
            [one] if self.settings.is_empty() => Source::load(one),
            [_] => bail!("--set changes experiments; a comparison sets fields in its file"),
            several => {
                let load = |name: &String| Ok((name.clone(), self.settings.document(name)?));
                let named: anyhow::Result<Vec<_>> = several.iter().map(load).collect();
                Source::experiments(&named?)
            }
        }
    }
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
    let page = page(&source.name, &source.plan.comparison, &results);
    args.output.leave(&out, &page, &summary)?;
    let diverged = results.diverged();
    ensure!(
        diverged == 0,
        "{}: {diverged} flights diverged",
        source.name
    );
    Ok(())
}
