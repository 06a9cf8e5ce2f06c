//! `campaign`: one experiment many times over, dispersed.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use anyhow::{bail, ensure};
use indicatif::{ProgressBar, ProgressStyle};

use alula_report::campaign::{maps, page};
use alula_report::viewer::Flight;
use alula_sim::figures::words;
use alula_sim::kind::Kind;
use alula_sim::simulate;
use alula_study::files::{leave, leave_all};
use alula_study::starts::ATTITUDES;
use alula_study::{BUILT_IN, CampaignSource, Shard, Store, Summary, run as fly_all};

use super::attitudes;
use super::fly;
use super::output::{Output, leave_view};
use super::settings::expect_name;
use super::sitl::interrupted;

/// Fly an experiment many times, with its fields drawn at random: percentiles, limits, worst flights
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Args {
    #[command(subcommand)]
    merge: Option<Merge>,
    /// A built-in campaign or a TOML file, or for --refly the folder of its results; without it, list the built-in ones
    campaign: Option<String>,
    #[command(flatten)]
    output: Output,
    /// Number of flights, in place of the campaign's own
    #[arg(long, value_name = "N")]
    flights: Option<u64>,
    /// Set a field in all flights, in place of the campaign's own `set` or of what it draws
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Fly one of n shares alone, to be merged with the others; of `attitudes` there are none
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Shard,
    /// Number of threads [default: one per core]
    #[arg(long, value_name = "N")]
    threads: Option<std::num::NonZero<usize>>,
    /// Fly this flight alone, and leave its trace and report
    #[arg(long, value_name = "FLIGHT", conflicts_with_all = ["shard", "threads"])]
    refly: Option<u64>,
    /// Print the campaign's TOML instead of flying it; `attitudes` has none
    #[arg(long)]
    print: bool,
}

#[derive(clap::Subcommand)]
enum Merge {
    /// Put the shares of a campaign together, with the result that it has when flown in one
    Merge {
        /// Folders of the shares
        #[arg(required = true, value_name = "DIR")]
        shares: Vec<PathBuf>,
        #[command(flatten)]
        output: Output,
    },
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    if let Some(Merge::Merge { shares, output }) = &args.merge {
        return merge(shares, output);
    }
    let mut stdout = std::io::stdout().lock();
    let Some(name) = &args.campaign else {
        for (name, _) in BUILT_IN {
            let campaign = CampaignSource::load(name, None)?.campaign;
            writeln!(stdout, "{name:<18} {}", campaign.description)?;
        }
        let (name, description) = ATTITUDES;
        writeln!(stdout, "{name:<18} {description}")?;
        return Ok(());
    };
    if name == ATTITUDES.0 {
        let whole = args.refly.is_none() && !args.print && args.shard.is_whole();
        ensure!(
            whole && args.set.is_empty(),
            "attitudes: has no text for --print and --set, no shares and no flights to refly; its flights are those of start-hover and start-cruise by seed: `fly start-hover --set seed=N`"
        );
        drop(stdout);
        return attitudes::attitudes(args.flights, args.threads, &args.output);
    }
    if let (Some(number), true) = (args.refly, Path::new(name).is_dir()) {
        drop(stdout);
        ensure!(
            args.flights.is_none(),
            "{name}: these results are of so many flights as were flown: leave out --flights"
        );
        return refly(&Store::existing(Path::new(name))?.1, number, args);
    }
    expect_name(&[Kind::Campaign], "a campaign", name)?;
    let source = CampaignSource::load_changed(name, args.flights, &args.set)?;
    if args.print {
        write!(stdout, "{}", source.texts.campaign)?;
        return Ok(());
    }
    if let Some(number) = args.refly {
        drop(stdout);
        return refly(&source, number, args);
    }
    let out = args.output.folder(&format!("campaign-{}", source.stem()))?;
    let store = Store::open(&out, &source)?;
    let campaign = &source.campaign;
    let chunks = || args.shard.chunks(campaign.chunks());
    let flights = campaign.flights_in(chunks());
    let there = store.flown_in(chunks());
    if there > 0 {
        let place = out.display();
        eprintln!("going on from {there} of {flights} flights in {place}");
    }
    let style = "{pos} of {len} flights {bar:40} {percent:>3} % {eta} left";
    let bar = ProgressBar::new(flights).with_position(there);
    bar.set_style(ProgressStyle::with_template(style).expect("a valid template"));
    // What was there says nothing of the time that is left.
    bar.reset_eta();
    let interrupted = interrupted()?;
    let ended = fly_all(&source, &store, args.shard, args.threads, || {
        bar.inc(1);
        ensure!(!interrupted.load(Ordering::Relaxed), "interrupted");
        Ok(())
    });
    bar.finish_and_clear();
    if ended.is_err() && interrupted.load(Ordering::Relaxed) {
        let kept = store.flown_in(chunks());
        bail!(
            "interrupted: {kept} of {flights} flights are in {}; the same command goes on from there",
            out.display()
        );
    }
    ended?;
    if !args.shard.is_whole() {
        let place = out.display();
        writeln!(
            stdout,
            "{flights} flights are in {place}, to be merged with the other shares"
        )?;
        return Ok(());
    }
    drop(stdout);
    conclude(&source, &store, &args.output)
}

/// The worst flight of each limit, flown again; not those that diverge.
fn worst(source: &CampaignSource, summary: &Summary) -> anyhow::Result<Vec<Flight>> {
    let mut flights: BTreeMap<i64, Vec<String>> = BTreeMap::new();
    for limit in &summary.limits {
        if let Some(worst) = limit.worst.first() {
            let of = flights.entry(worst.flight).or_default();
            let words = words(limit.figure);
            if !of.contains(&words) {
                of.push(words);
            }
        }
    }
    let mut shown = Vec::new();
    for (number, figures) in flights {
        let drawn = source.campaign.draw(&source.base, u64::try_from(number)?);
        let drawn = drawn.map_err(|e| anyhow::anyhow!("flight {number}: {e}"))?;
        let experiment = drawn.document.checked()?;
        if let Ok(record) = simulate::fly(&experiment) {
            let lead = format!("The worst flight by {}.", figures.join(", by "));
            let name = format!("flight {number}");
            let flight = Flight::of(&name, &experiment, &record);
            shown.push(Flight { lead, ..flight });
        }
    }
    Ok(shown)
}

/// Leaves the results of a complete store.
fn conclude(source: &CampaignSource, store: &Store, output: &Output) -> anyhow::Result<()> {
    let summary = Summary::of(source, store)?;
    let folder = store.folder();
    leave(&folder.join("summary.json"), |file| {
        Ok(serde_json::to_writer_pretty(file, &summary)?)
    })?;
    if let Some(maps) = maps(&summary) {
        leave_all(&folder.join("maps.svg"), maps.svg())?;
    }
    let mut page = page(source, &summary);
    let title = page.title.clone();
    leave_view(&mut page, folder, &title, &worst(source, &summary)?)?;
    output.leave(folder, &page, &summary)?;
    ensure!(
        summary.verdict(),
        "{}: a limit is not kept, a flight diverged, or a fault ended in another state",
        source.texts.name
    );
    Ok(())
}

fn refly(source: &CampaignSource, number: u64, args: &Args) -> anyhow::Result<()> {
    ensure!(
        number < source.campaign.flights,
        "--refly: flights are numbered from 0 to {}",
        source.campaign.flights - 1
    );
    let drawn = source.campaign.draw(&source.base, number);
    let drawn = drawn.map_err(|e| anyhow::anyhow!("flight {number}: {e}"))?;
    let mut document = drawn.document;
    document.name = format!("{}-{number}", source.stem());
    let title = format!("Flight {number} of campaign {}", source.stem());
    document.set("description", title.into())?;
    let out = args.output.folder(&document.name)?;
    leave_all(&out.join("experiment.toml"), document.text())?;
    let files = (&args.output, &fly::Logs::default());
    fly::fly(&document, &document.name, files, |experiment| {
        Ok(experiment.controller()?)
    })
}

fn merge(shares: &[PathBuf], output: &Output) -> anyhow::Result<()> {
    let (_, mut source) = Store::existing(&shares[0])?;
    let out = output.folder(&format!("campaign-{}", source.stem()))?;
    let store = Store::open(&out, &source)?;
    source.is_found_in(&out);
    store.merge(shares)?;
    conclude(&source, &store, output)
}
