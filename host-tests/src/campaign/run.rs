//! Flying a campaign on all cores.

use std::num::NonZero;
use std::str::FromStr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{anyhow, bail};

use super::{CampaignSource, Drawn, Flown, Store};
use crate::workers::for_each;

/// One of several shares of a campaign: every `of`th chunk, from the `number`th on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: u64,
    of: u64,
}

impl Default for Shard {
    /// All of it.
    fn default() -> Self {
        Self { number: 1, of: 1 }
    }
}

/// `i/n`, with i from 1 to n.
impl FromStr for Shard {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> anyhow::Result<Self> {
        let parts = text.split_once('/');
        let parsed = parts.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parsed {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => bail!("must be i/n with i from 1 to n"),
        }
    }
}

impl Shard {
    /// The chunks of this share, of `chunks` in all.
    pub fn chunks(self, chunks: u64) -> impl Iterator<Item = u64> {
        (self.number - 1..chunks).step_by(usize::try_from(self.of).unwrap_or(usize::MAX))
    }

    /// Whether it is the whole.
    pub fn is_whole(self) -> bool {
        self.of == 1
    }
}

/// Flies what `store` lacks of `shard`, on `threads` threads. `flown` is called once per flight.
pub fn run(
    source: &CampaignSource,
    store: &Store,
    shard: Shard,
    threads: NonZero<usize>,
    flown: impl Fn() + Sync,
) -> anyhow::Result<()> {
    let campaign = &source.campaign;
    let lacks = |chunk: &u64| !store.has(*chunk);
    let missing: Vec<u64> = shard.chunks(campaign.chunks()).filter(lacks).collect();

    let stop = AtomicBool::new(false);
    let failure = Mutex::new(None);
    let fly = |chunk: u64| {
        let mut flights: Vec<(u64, Drawn, Flown)> = Vec::new();
        for number in campaign.chunk(chunk) {
            if stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let drawn = campaign.draw(&source.base, number).map_err(|e| {
                let name = &source.texts.name;
                anyhow!("{name}: flight {number}: {}: {}", e.field, e.problem)
            })?;
            let flight = Flown::fly(&drawn, &campaign.faults);
            flights.push((number, drawn, flight));
            flown();
        }
        let (flights, samples) = campaign.frames(&flights);
        store.keep(chunk, &flights, &samples)
    };
    for_each(&missing, threads, |_, &chunk| {
        let done = fly(chunk);
        let well = done.is_ok();
        if let Err(error) = done {
            // What the others are at is not waited for.
            stop.store(true, Ordering::Relaxed);
            let mut failure = failure.lock().expect("no thread panics");
            failure.get_or_insert(error);
        }
        well
    });
    match failure.into_inner().expect("no thread panics") {
        Some(error) => Err(error),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_every_chunk_once() {
        let of = |text: &str| {
            text.parse::<Shard>()
                .unwrap()
                .chunks(10)
                .collect::<Vec<_>>()
        };
        assert_eq!(of("1/3"), [0, 3, 6, 9]);
        assert_eq!(of("2/3"), [1, 4, 7]);
        assert_eq!(of("3/3"), [2, 5, 8]);
        assert_eq!(Shard::default().chunks(4).collect::<Vec<_>>(), [0, 1, 2, 3]);
        for bad in ["0/3", "4/3", "3", "a/b", "1/0", "-1/2"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }
}
