//! A folder of results: what decides them, and one part per chunk of flights, each complete or not there. Of a chunk that was interrupted there is
//! a part that has begun: its first flights.

use std::fs::File;
use std::ops::Range;
use std::path::{Path, PathBuf};

use alula_sim::figures::FIGURES;
use anyhow::{Context, bail};

use super::frame_file::FrameWriter;
use super::load::Texts;
use super::part::{Seal, checksum};
use super::run::{Shard, Threads, fly};
use super::{Campaign, CampaignSource, Frame, Summary};
use crate::chunk::CHUNK;
use crate::files::{leave, leave_all};

/// Flights of a row group of `flights.parquet`: each group costs the writer memory until the end.
const GROUP: usize = 5000;

/// The folder of a campaign's results.
#[derive(Clone, Debug)]
pub struct Store {
    folder: PathBuf,
    /// Of the campaign: what its parts are sealed with.
    identity: u64,
    /// Its number of flights.
    flights: u64,
}

const IDENTITY: &str = "campaign.json";
/// The folders of parts, in the order in which those of a chunk are written.
const KINDS: [&str; 2] = ["samples", "flights"];

/// Names of the figures that are kept of a flight: parts of a program with others are another campaign's.
fn columns() -> Vec<&'static str> {
    FIGURES.iter().map(|figure| figure.name).collect()
}

/// Of a campaign whose flights have these figures.
fn identity(texts: &Texts, columns: &[&str]) -> serde_json::Result<u64> {
    Ok(checksum(&serde_json::to_vec(&(texts.flown(), columns))?))
}

impl Store {
    /// The folder for `source`'s results. It is made, or goes on where it was left: every part that is there is checked. A folder that holds
    /// another campaign is refused, and one that holds parts of it is not known which.
    pub fn open(folder: &Path, source: &CampaignSource) -> anyhow::Result<Self> {
        let store = Self::of(folder, &source.texts)?;
        let path = folder.join(IDENTITY);
        let remove = "remove it, or choose another folder with --out";
        let place = folder.display();
        if path.exists() {
            let before = Self::texts(folder)?;
            if before.flown() != source.texts.flown() {
                bail!("{place}: holds the results of another campaign; {remove}");
            }
            if before.flights != source.texts.flights {
                store.resize(before.flights, &source.texts)?;
            }
            for chunk in 0..source.campaign.chunks() {
                for kind in KINDS {
                    let seal = store.seal(kind, chunk);
                    match store.flown(chunk) {
                        _ if store.has(chunk) => seal.bytes(&store.part(kind, chunk))?,
                        0 => Vec::new(),
                        flown => seal.bytes(&store.begun(kind, chunk, flown))?,
                    };
                }
            }
        } else {
            for kind in KINDS {
                let part = folder.join(kind);
                std::fs::create_dir_all(&part).with_context(|| part.display().to_string())?;
                if std::fs::read_dir(&part)?.next().is_some() {
                    bail!(
                        "{place}: holds parts, but no {IDENTITY} that says of which campaign; {remove}"
                    );
                }
            }
            let text = serde_json::to_string_pretty(&source.texts)?;
            leave_all(&path, text)?;
        }
        Ok(store)
    }

    /// The folder of a campaign that has been flown, in part at least, and the campaign.
    pub fn existing(folder: &Path) -> anyhow::Result<(Self, CampaignSource)> {
        let texts = Self::texts(folder)?;
        let store = Self::of(folder, &texts)?;
        let origin = folder.join(IDENTITY).display().to_string();
        let source = CampaignSource::from_texts(texts, &origin)?;
        Ok((store, source))
    }

    /// The folder alone of such a campaign.
    pub(super) fn of_existing(folder: &Path) -> anyhow::Result<Self> {
        Self::of(folder, &Self::texts(folder)?)
    }

    /// Whether its parts are of the campaign that those of `other` are of.
    pub(super) fn is_of_the_campaign_of(&self, other: &Self) -> bool {
        (self.identity, self.flights) == (other.identity, other.flights)
    }

    /// Goes from `before` flights to those that `texts` say. The last part of either is one that has begun in the other; those beyond the end
    /// are looked at no more, until there are more flights again.
    fn resize(&self, before: u64, texts: &Texts) -> anyhow::Result<()> {
        for end in [before, texts.flights]
            .into_iter()
            .filter(|end| !end.is_multiple_of(CHUNK))
        {
            let chunk = end / CHUNK;
            let rows = CHUNK.min(before.saturating_sub(chunk * CHUNK));
            for kind in KINDS {
                let part = self.part(kind, chunk);
                if part.exists() {
                    let begun = self.begun(kind, chunk, rows);
                    std::fs::rename(&part, begun).with_context(|| part.display().to_string())?;
                }
            }
        }
        let text = serde_json::to_string_pretty(texts)?;
        leave_all(&self.folder.join(IDENTITY), text)
    }

    fn of(folder: &Path, texts: &Texts) -> anyhow::Result<Self> {
        Ok(Self {
            folder: folder.to_owned(),
            identity: identity(texts, &columns())?,
            flights: texts.flights,
        })
    }

    fn texts(folder: &Path) -> anyhow::Result<Texts> {
        let path = folder.join(IDENTITY);
        let text = std::fs::read(&path).with_context(|| path.display().to_string())?;
        let advice = "is no identity of a campaign: remove its folder, or choose another one";
        serde_json::from_slice(&text).with_context(|| format!("{}: {advice}", path.display()))
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn part(&self, kind: &str, chunk: u64) -> PathBuf {
        self.folder.join(kind).join(format!("{chunk:06}.parquet"))
    }

    /// Where the first `flown` flights of a chunk are, or their samples.
    fn begun(&self, kind: &str, chunk: u64, flown: u64) -> PathBuf {
        let name = format!("{chunk:06}-{flown}.parquet");
        self.folder.join(kind).join(name)
    }

    fn seal(&self, kind: &'static str, chunk: u64) -> Seal {
        Seal {
            identity: self.identity,
            kind,
            chunk,
        }
    }

    /// Whether `chunk` has been flown, and neither of its parts was deleted since. Its flights are written last.
    pub fn has(&self, chunk: u64) -> bool {
        KINDS.iter().all(|kind| self.part(kind, chunk).exists())
    }

    /// How many flights of `chunk`, the first ones, have been flown.
    fn flown(&self, chunk: u64) -> u64 {
        let all = CHUNK.min(self.flights.saturating_sub(chunk * CHUNK));
        if self.has(chunk) {
            return all;
        }
        let are_there = |&flown: &u64| {
            let mut parts = KINDS.iter().map(|kind| self.begun(kind, chunk, flown));
            parts.all(|part| part.exists())
        };
        (1..=all).rev().find(are_there).unwrap_or(0)
    }

    /// How many flights of `chunks` have been flown.
    pub fn flown_in(&self, chunks: impl Iterator<Item = u64>) -> u64 {
        chunks.map(|chunk| self.flown(chunk)).sum()
    }

    /// Of each of `chunks` the flights that have not been flown, if there are any.
    fn missing(
        &self,
        campaign: &Campaign,
        chunks: impl Iterator<Item = u64>,
    ) -> Vec<(u64, Range<u64>)> {
        let missing = chunks.filter(|&chunk| !self.has(chunk));
        let numbers = |chunk| {
            let Range { start, end } = campaign.chunk(chunk);
            (chunk, start + self.flown(chunk)..end)
        };
        missing.map(numbers).collect()
    }

    /// The chunks that have been flown, in their order.
    pub(super) fn chunks(&self) -> std::io::Result<Vec<u64>> {
        let mut chunks = Vec::new();
        for entry in std::fs::read_dir(self.folder.join("flights"))? {
            // What has another name is no part.
            let path = entry?.path();
            let number = path
                .file_stem()
                .and_then(|stem| stem.to_str()?.parse().ok());
            let is_part = |&chunk: &u64| path == self.part("flights", chunk) && self.has(chunk);
            chunks.extend(number.filter(is_part));
        }
        chunks.sort_unstable();
        Ok(chunks)
    }

    /// Keeps `flights` and `samples` of `chunk`, the next ones after those that have been flown.
    pub fn keep(&self, chunk: u64, flights: Frame, samples: Frame) -> anyhow::Result<()> {
        let before = self.flown(chunk);
        let flown = before + flights.rows() as u64;
        if flown == 0 {
            return Ok(());
        }
        let whole = flown == CHUNK.min(self.flights - chunk * CHUNK);
        for (kind, frame) in KINDS.into_iter().zip([samples, flights]) {
            let seal = self.seal(kind, chunk);
            let mut all = Frame::default();
            if before > 0 {
                all = seal.read(&self.begun(kind, chunk, before))?;
            }
            all.append(frame)?;
            let path = match whole {
                true => self.part(kind, chunk),
                false => self.begun(kind, chunk, flown),
            };
            seal.write(&path, &all)?;
        }
        if before > 0 && (whole || before < flown) {
            for kind in KINDS {
                let part = self.begun(kind, chunk, before);
                std::fs::remove_file(&part).with_context(|| part.display().to_string())?;
            }
        }
        Ok(())
    }

    /// The flights of `chunk`.
    pub fn flights(&self, chunk: u64) -> anyhow::Result<Frame> {
        self.read("flights", chunk)
    }

    /// The samples of `chunk`.
    pub fn samples(&self, chunk: u64) -> anyhow::Result<Frame> {
        self.read("samples", chunk)
    }

    fn read(&self, kind: &'static str, chunk: u64) -> anyhow::Result<Frame> {
        self.seal(kind, chunk).read(&self.part(kind, chunk))
    }

    /// Takes `chunk` over from another store of the same campaign, which keeps it.
    pub fn take(&self, other: &Self, chunk: u64) -> anyhow::Result<()> {
        for kind in KINDS {
            let bytes = self.seal(kind, chunk).bytes(&other.part(kind, chunk))?;
            leave_all(&self.part(kind, chunk), bytes)?;
        }
        Ok(())
    }
}

/// Flies what `store` lacks of `shard`. `after_each` is called once per flight; an error of its own ends the campaign there.
pub fn run(
    source: &CampaignSource,
    store: &Store,
    shard: Shard,
    threads: Threads,
    after_each: impl Fn() -> anyhow::Result<()> + Sync + Send,
) -> anyhow::Result<()> {
    let campaign = &source.campaign;
    let missing = store.missing(campaign, shard.chunks(campaign.chunks()));
    fly(
        source,
        &missing,
        threads,
        after_each,
        |chunk, flights, samples| store.keep(chunk, flights, samples),
    )
    .map(|_| ())
}

impl Summary {
    /// What the complete `store` of `source` says; its flights are left together in `flights.parquet`.
    pub fn of(source: &CampaignSource, store: &Store) -> anyhow::Result<Self> {
        let chunks = source.campaign.chunks();
        let missing = (0..chunks).filter(|&chunk| !store.has(chunk)).count();
        anyhow::ensure!(
            missing == 0,
            "{}: {missing} of {chunks} parts are not there yet",
            store.folder().display()
        );
        let path = store.folder().join("flights.parquet");
        let mut summary = None;
        leave(&path, |file: &mut File| {
            let mut writer = FrameWriter::new(file);
            let mut group = Frame::default();
            let parts = (0..chunks).map(|chunk| {
                let (flights, samples) = (store.flights(chunk)?, store.samples(chunk)?);
                group.append(flights.clone())?;
                if group.rows() >= GROUP || chunk + 1 == chunks {
                    writer.write(&group)?;
                    group = Frame::default();
                }
                Ok((flights, samples))
            });
            summary = Some(Self::of_parts(source, parts)?);
            writer.close()
        })?;
        summary.context("no summary")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A part that a program of other figures left is refused by its own file, whatever the texts say.
    #[test]
    fn parts_of_other_figures_are_refused() {
        let source = CampaignSource::load("envelope", Some(3)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path(), &source).unwrap();
        let mut flights = Frame::default();
        flights.push("flight", crate::frame::Column::Integer((0..3).collect()));
        let mut columns = columns();
        columns.pop();
        let before = Store {
            identity: identity(&source.texts, &columns).unwrap(),
            ..store
        };
        before.keep(0, flights, Frame::default()).unwrap();
        let error = format!("{:#}", Store::open(folder.path(), &source).unwrap_err());
        assert!(error.contains("samples/000000.parquet: belongs"), "{error}");
    }
}
