//! Flying on all cores.

use std::num::NonZero;
use std::ops::Range;
use std::str::FromStr;

use anyhow::{anyhow, bail};
use rayon::prelude::*;

use super::{CampaignFlight, CampaignSource, FlightResult, Frame};

/// Number of threads; one per core if none is given.
pub type Threads = Option<NonZero<usize>>;

/// What `work` makes of every one of `items`, in their order. The first error ends it.
pub fn each<T: Sync, R: Send>(
    items: &[T],
    threads: Threads,
    work: impl Fn(&T) -> anyhow::Result<R> + Sync + Send,
) -> anyhow::Result<Vec<R>> {
    let pool = rayon::ThreadPoolBuilder::new()
        // More threads than flights have nothing to do, and each takes time to begin.
        .num_threads(threads.map_or(0, |n| n.get().min(items.len().max(1))))
        .build()?;
    pool.install(|| items.par_iter().with_max_len(1).map(work).collect())
}

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

/// Flies of a campaign's chunks those flights that are asked for of each: what `keep` makes of flights and samples, in their order. `after_each`
/// is called once per flight; an error of its own ends the campaign there. What a chunk has flown until an error is kept, too.
pub fn fly<R: Send>(
    source: &CampaignSource,
    chunks: &[(u64, Range<u64>)],
    threads: Threads,
    after_each: impl Fn() -> anyhow::Result<()> + Sync + Send,
    keep: impl Fn(u64, Frame, Frame) -> anyhow::Result<R> + Sync + Send,
) -> anyhow::Result<Vec<R>> {
    let campaign = &source.campaign;
    each(chunks, threads, |(chunk, numbers)| {
        let mut flights: Vec<CampaignFlight> = Vec::new();
        let ended = numbers.clone().try_for_each(|number| {
            let drawn = campaign.draw(&source.base, number);
            let drawn =
                drawn.map_err(|e| anyhow!("{}: flight {number}: {e}", source.texts.name))?;
            let result = FlightResult::fly(&drawn, &campaign.faults)?;
            flights.push(CampaignFlight {
                number,
                drawn,
                result,
            });
            after_each()
        });
        let (flights, samples) = campaign.frames(&flights);
        let kept = keep(*chunk, flights, samples)?;
        ended.map(|()| kept)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_done_once_in_order_whatever_the_threads() {
        let items: Vec<usize> = (0..100).collect();
        for threads in [1, 3, 200] {
            let done = each(&items, NonZero::new(threads), |&item| Ok(2 * item)).unwrap();
            assert!(done.iter().enumerate().all(|(i, &twice)| twice == 2 * i));
        }
        let failed = each(&items, None, |&item| match item {
            50 => bail!("fifty"),
            _ => Ok(()),
        });
        assert_eq!(failed.unwrap_err().to_string(), "fifty");
    }

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
