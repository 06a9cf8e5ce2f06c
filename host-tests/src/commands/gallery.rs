//! `gallery`: the built-in experiments at a glance.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use anyhow::Context;

use alula_report::gallery::{Exhibit, page};
use alula_report::viewer::{self, Flight};
use alula_sim::experiment::{BUILT_IN, Document};
use alula_sim::simulate::fly;
use alula_study::files::leave_all;

use super::output::Output;

/// Fly every built-in experiment, and leave a page with its picture and the command that flies it
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    output: Output,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let (exhibits, flights): (Vec<_>, Vec<_>) = exhibits()?.into_iter().unzip();
    let folder = args.output.folder("gallery")?;
    let file = folder.join("report.html");
    leave_all(&file, page(&exhibits))?;
    leave_all(
        &folder.join(viewer::FILE),
        viewer::recorded("Gallery", &flights)?,
    )?;
    args.output.show(&file)
}

/// Least time between two rows of a flight \[s\].
const COARSE: f64 = 0.12;

/// Every built-in experiment, flown on all cores. Those without a path are vehicles, and left out.
fn exhibits() -> anyhow::Result<Vec<(Exhibit, Flight)>> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        for _ in 0..cores {
            scope.spawn(|| {
                while let Some((name, _)) = BUILT_IN.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let shown = exhibit(name);
                    done.lock().expect("no panic with it").push((*name, shown));
                }
            });
        }
    });
    let mut done = done.into_inner().expect("no panic with it");
    let place = |name: &str| BUILT_IN.iter().position(|(other, _)| *other == name);
    done.sort_by_key(|(name, _)| place(name));
    done.into_iter()
        .filter_map(|(_, shown)| shown.transpose())
        .collect()
}

fn exhibit(name: &str) -> anyhow::Result<Option<(Exhibit, Flight)>> {
    let document = Document::load(name)?;
    if document.data().is_err() {
        return Ok(None);
    }
    let experiment = document.checked()?;
    let record = fly(&experiment).with_context(|| name.to_owned())?;
    let mut flight = Flight::of(name, &experiment, &record);
    // So many flights in one page: fewer rows of each, and no plans.
    flight.scene.thin(COARSE);
    Ok(Some((Exhibit::of(name, &experiment, &record), flight)))
}
