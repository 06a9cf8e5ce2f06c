//! A folder of results: what decides them, and one part per chunk of flights, each complete or not there.

use std::fs::File;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use super::frame_file::FrameWriter;
use super::load::Texts;
use super::part::{Seal, checksum};
use super::run::{Shard, Threads, fly};
use super::{CampaignSource, Frame, Summary};
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
            for chunk in (0..source.campaign.chunks()).filter(|&chunk| store.has(chunk)) {
                for kind in KINDS {
                    store.seal(kind, chunk).bytes(&store.part(kind, chunk))?;
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

    /// Goes from `before` flights to those that `texts` say. Parts that are whole in both stay, those beyond the end, too: they are looked at no
    /// more, until there are more flights again.
    fn resize(&self, before: u64, texts: &Texts) -> anyhow::Result<()> {
        for end in [before, texts.flights] {
            // The last part has some of its flights alone in one of both.
            if !end.is_multiple_of(CHUNK) {
                for kind in KINDS {
                    let part = self.part(kind, end / CHUNK);
                    if part.exists() {
                        std::fs::remove_file(&part).with_context(|| part.display().to_string())?;
                    }
                }
            }
        }
        let text = serde_json::to_string_pretty(texts)?;
        leave_all(&self.folder.join(IDENTITY), text)
    }

    fn of(folder: &Path, texts: &Texts) -> anyhow::Result<Self> {
        Ok(Self {
            folder: folder.to_owned(),
            identity: checksum(&serde_json::to_vec(&texts.flown())?),
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

    /// Keeps `flights` and `samples` of `chunk`.
    pub fn keep(&self, chunk: u64, flights: &Frame, samples: &Frame) -> anyhow::Result<()> {
        for (kind, frame) in KINDS.into_iter().zip([samples, flights]) {
            let path = self.part(kind, chunk);
            self.seal(kind, chunk).write(&path, frame)?;
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
    let lacks = |chunk: &u64| !store.has(*chunk);
    let chunks = shard.chunks(source.campaign.chunks());
    let missing: Vec<u64> = chunks.filter(lacks).collect();
    fly(
        source,
        &missing,
        threads,
        after_each,
        |chunk, flights, samples| store.keep(chunk, &flights, &samples),
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
