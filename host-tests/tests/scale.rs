//! What a merge of many shares needs in memory.

use std::path::{Path, PathBuf};

use alula_study::{CHUNK, CampaignFlight, CampaignSource, Drawn, FlightResult, Store, Summary};
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// A campaign of so many shares of one part each.
fn source(shares: u64) -> CampaignSource {
    let mut source = CampaignSource::load("dispersed", Some(shares * CHUNK)).unwrap();
    let short = toml::Value::Float(0.1);
    source.base.set("duration_s", short).unwrap();
    source
}

/// Leaves the shares of `source` under `folder`, each with the first flight in place of all of its own: what is in them is not looked at.
fn shares(source: &CampaignSource, folder: &Path) -> Vec<PathBuf> {
    let drawn: Drawn = source.campaign.draw(&source.base, 0).unwrap();
    let result = FlightResult::fly(&drawn, &[]).unwrap();
    let copy = |number: u64| CampaignFlight {
        number,
        drawn: drawn.clone(),
        result: result.clone(),
    };
    let mut flights: Vec<_> = source.campaign.chunk(0).map(copy).collect();
    let share = |chunk: u64| {
        let path = folder.join(format!("shard={chunk:04}"));
        let store = Store::open(&path, source).unwrap();
        for (flight, number) in flights.iter_mut().zip(source.campaign.chunk(chunk)) {
            flight.number = number;
        }
        let (flights, samples) = source.campaign.frames(&flights);
        store.keep(chunk, flights, samples).unwrap();
        path
    };
    (0..source.campaign.chunks()).map(share).collect()
}

/// Most bytes in use while so many shares are merged and summarised, over those in use before; and the bytes of the flights' figures.
fn peak(number: u64) -> (usize, usize) {
    let folder = tempfile::tempdir().unwrap();
    let source = source(number);
    let shares = shares(&source, folder.path());
    let store = Store::open(&folder.path().join("merged"), &source).unwrap();
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    store.merge(&shares).unwrap();
    let summary = Summary::of(&source, &store).unwrap();
    let peak = MEMORY.peak_usage() - before;
    assert_eq!(summary.flights, number * CHUNK);
    let width = store.flights(0).unwrap().columns.len() * size_of::<f64>();
    (peak, width * usize::try_from(summary.flights).unwrap())
}

/// Holding the flights of 200 shares more would take 5 MB more. What grows is what the Parquet file says of its row groups at its end: one
/// group for every hundred shares, of some 40 kB. With the fewer shares the first group is full already.
#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_a_merge_of_three_times_the_shares_needs_no_more_memory() {
    let (few, flights) = peak(100);
    let (many, all_flights) = peak(300);
    let held = all_flights - flights;
    println!(
        "{few} bytes for 100 shares, {many} for 300; {held} to hold the flights of the others"
    );
    assert!(held > 4_000_000);
    assert!(many < few + held / 20, "{few} {many}");
}
