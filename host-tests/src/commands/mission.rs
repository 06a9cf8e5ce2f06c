//! `mission`: the whole guidance on a real vehicle.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;

use alula_sil::files::leave;
use alula_sil::mission::{BUILT_IN, Figures, MissionSource, Row, fly, html, svg, write_trace};

use super::fly::progress_bar;

/// Fly a mission: the whole guidance, with actuators, sensors, weather and faults
#[derive(clap::Args)]
pub struct Args {
    /// A built-in mission or a TOML file; without it, list the built-in ones
    mission: Option<String>,
    /// Folder for the results [default: out/mission/<mission>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of the table
    #[arg(long)]
    json: bool,
    /// Print the mission's TOML instead of flying it
    #[arg(long)]
    print: bool,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary<'a> {
    mission: &'a str,
    out: &'a Path,
    #[serde(flatten)]
    figures: &'a Figures,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut stdout = std::io::stdout().lock();
    let Some(name) = &args.mission else {
        for (name, _) in BUILT_IN {
            let description = MissionSource::load(name)?.mission.description;
            writeln!(stdout, "{name:<18} {description}")?;
        }
        return Ok(());
    };
    let source = MissionSource::load(name)?;
    if args.print {
        write!(stdout, "{}", source.text)?;
        return Ok(());
    }
    let out = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out/mission").join(&source.name),
    };
    std::fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    drop(stdout);
    fly_and_leave(&source, &out, args.json)
}

/// Flies `source` and leaves its trace, figure and report in the folder `out`.
pub(super) fn fly_and_leave(source: &MissionSource, out: &Path, json: bool) -> anyhow::Result<()> {
    let mission = &source.mission;
    let bar = progress_bar(mission.steps());
    let mut rows: Vec<Row> = Vec::with_capacity(mission.steps() + 1);
    fly(mission, |row| {
        rows.push(*row);
        bar.set_position(rows.len() as u64);
        true
    });
    bar.finish_and_clear();

    let figures = Figures::of(mission, &rows);
    let svg = svg(mission, &rows);
    let html = html(source, &rows, &figures, &svg)?;
    leave(&out.join("trace.csv"), |file| Ok(write_trace(&rows, file)?))?;
    leave(&out.join("flight.svg"), |file| {
        Ok(file.write_all(svg.as_bytes())?)
    })?;
    leave(&out.join("report.html"), |file| {
        Ok(file.write_all(html.as_bytes())?)
    })?;
    let mut stdout = std::io::stdout().lock();
    if json {
        let summary = Summary {
            mission: &source.name,
            out,
            figures: &figures,
        };
        writeln!(stdout, "{}", serde_json::to_string_pretty(&summary)?)?;
    } else {
        writeln!(stdout, "{}: {}", source.name, mission.description)?;
        for [label, value] in figures.table() {
            writeln!(stdout, "  {label:<28} {value:>22}")?;
        }
        for segment in &figures.segments {
            writeln!(stdout, "  {}", segment.line())?;
        }
        let files = "trace.csv, report.html and flight.svg";
        writeln!(stdout, "{files} are in {}", out.display())?;
    }
    Ok(())
}
