//! `compare`: policies against each other, in the same plant.

use std::path::{Path, PathBuf};

use serde::Serialize;

use alula_sil::files::leave_all;
use alula_sil::page::comparison::page;
use alula_sil::page::markdown;
use alula_sil::study::{Results, Source};

use super::fly::progress_bar;
use super::output::Output;

/// Fly several policies under the same conditions: gains against gains, and against switching transitions
#[derive(clap::Args)]
pub struct Args {
    /// The built-in comparison, or a TOML file
    #[arg(default_value = "tail-sitter")]
    comparison: String,
    #[command(flatten)]
    output: Output,
    /// Write the results as Markdown, too
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary<'a> {
    comparison: &'a str,
    out: &'a Path,
    cells: &'a Results,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let source = Source::load(&args.comparison)?;
    let out = args.output.folder(&format!("compare-{}", source.name))?;

    let bar = progress_bar(source.plan.flights());
    let results = Results::of(&source.plan, None, || {
        bar.inc(1);
        Ok(())
    })?;
    bar.finish_and_clear();

    let comparison = &source.plan.comparison;
    if let Some(path) = &args.markdown {
        let text = markdown(&source.name, comparison, &results)?;
        // A bare file name has a folder, too.
        leave_all(&Path::new(".").join(path), text)?;
    }
    let summary = Summary {
        comparison: &source.name,
        out: &out,
        cells: &results,
    };
    let page = page(&source.name, comparison, &results);
    args.output.leave(&out, "compare", &page, &summary)
}
