//! `campaign attitudes`: random starts.

use std::io::Write;

use anyhow::ensure;

use alula_study::Threads;
use alula_study::files::leave;
use alula_study::starts::{BASES, FLIGHTS, LIMITS, Starts, starts};

use super::fly::progress_bar;
use super::output::Output;

/// Prints the random starts of one experiment.
fn print(starts: &Starts, to: &mut impl Write) -> std::io::Result<()> {
    writeln!(to, "{}: {} flights", starts.experiment, starts.flights)?;
    writeln!(to, "  converged        {:8.2} %", 100.0 * starts.converged)?;
    if starts.diverged > 0 {
        writeln!(to, "  {} DIVERGED", starts.diverged)?;
    }
    for (label, height) in [
        ("median", starts.height_lost_50_m),
        ("95 %", starts.height_lost_95_m),
        ("99 %", starts.height_lost_99_m),
        ("most", starts.height_lost_most_m),
    ] {
        writeln!(to, "  height lost, {label:<6} {height:6.1} m")?;
    }
    for seed in std::iter::once(&starts.worst_seed).chain(starts.astray.iter().take(5)) {
        writeln!(
            to,
            "  alula-sil fly {} --set seed={seed}",
            starts.experiment
        )?;
    }
    Ok(())
}

/// Flies the random starts, and prints share and heights.
pub fn attitudes(flights: Option<u64>, threads: Threads, output: &Output) -> anyhow::Result<()> {
    let flights = flights.unwrap_or(FLIGHTS);
    ensure!(flights > 0, "--flights: must be positive");
    let bar = progress_bar(BASES.len() * flights as usize);
    let count = || {
        bar.inc(1);
        Ok(())
    };
    let mut all = Vec::new();
    for name in BASES {
        all.push(Starts::new(name, &starts(name, flights, threads, count)?));
    }
    bar.finish_and_clear();
    let out = output.folder("campaign-attitudes")?;
    leave(&out.join("summary.json"), |file| {
        Ok(serde_json::to_writer_pretty(file, &all)?)
    })?;
    let mut stdout = std::io::stdout().lock();
    if output.json() {
        writeln!(stdout, "{}", serde_json::to_string_pretty(&all)?)?;
    } else {
        for starts in &all {
            print(starts, &mut stdout)?;
        }
        writeln!(stdout, "summary.json is in {}", out.display())?;
    }
    ensure!(
        all.iter().all(Starts::kept),
        "attitudes: less than {} % converge, more than {} m are lost, or a flight diverged",
        100.0 * LIMITS.0,
        LIMITS.1
    );
    Ok(())
}
