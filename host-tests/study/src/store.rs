//! A folder of results: what decides them, and one part per chunk of flights, each complete or not there.

use std::iter::repeat_n;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use super::load::Texts;
use super::part::{Seal, checksum};
use super::random_reference::REFERENCE;
use super::{
    Campaign, CampaignFlight, CampaignSource, Column, Drawn, DrawnReference, FlightResult, Frame,
    SAMPLED, Sample,
};
use crate::files::leave_all;
use alula_sim::figures::FIGURES;

/// Flights of a part: lost at most, per thread, if the campaign is interrupted.
pub const CHUNK: u64 = 50;

/// The folder of a campaign's results.
#[derive(Clone, Debug)]
pub struct Store {
    folder: PathBuf,
    /// Of the campaign: what its parts are sealed with.
    identity: u64,
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
            if Self::texts(folder)? != source.texts {
                bail!("{place}: holds the results of another campaign; {remove}");
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
        self.identity == other.identity
    }

    fn of(folder: &Path, texts: &Texts) -> anyhow::Result<Self> {
        Ok(Self {
            folder: folder.to_owned(),
            identity: checksum(&serde_json::to_vec(texts)?),
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

impl Campaign {
    /// Number of chunks.
    pub fn chunks(&self) -> u64 {
        self.flights.div_ceil(CHUNK)
    }

    /// The flights of `chunk`.
    pub fn chunk(&self, chunk: u64) -> std::ops::Range<u64> {
        chunk * CHUNK..((chunk + 1) * CHUNK).min(self.flights)
    }

    /// Number of flights in `chunks`.
    pub fn flights_in(&self, chunks: impl Iterator<Item = u64>) -> u64 {
        let size = |range: std::ops::Range<u64>| range.end - range.start;
        chunks.map(|chunk| size(self.chunk(chunk))).sum()
    }

    /// Flights and samples as columns.
    pub fn frames(&self, all: &[CampaignFlight]) -> (Frame, Frame) {
        let mut flights = Frame::default();
        let real = |of: &dyn Fn(&Drawn, &FlightResult) -> f64| {
            Column::Real(all.iter().map(|x| of(&x.drawn, &x.result)).collect())
        };
        let flag = |of: &dyn Fn(&FlightResult) -> bool| {
            Column::Flag(all.iter().map(|x| of(&x.result)).collect())
        };
        let numbers = all.iter().map(|x| x.number as i64);
        flights.push("flight", Column::Integer(numbers.collect()));
        for (i, dispersion) in self.disperse.iter().enumerate() {
            flights.push(&dispersion.field, real(&|d, _| d.values[i]));
        }
        let reference = |of: fn(&DrawnReference) -> f64| {
            real(&move |d, _| d.reference.as_ref().map_or(f64::NAN, of))
        };
        if self.reference.is_some() {
            flights.push(REFERENCE[0], reference(DrawnReference::speed));
            flights.push(REFERENCE[1], reference(DrawnReference::sink));
            flights.push(REFERENCE[2], reference(DrawnReference::stops));
        }
        if !self.faults.is_empty() {
            let index = |d: &Drawn| d.fault.map_or(-1, |fault| fault.index as i64);
            let indices = all.iter().map(|x| index(&x.drawn));
            flights.push("fault", Column::Integer(indices.collect()));
            let nan = f64::NAN;
            flights.push(
                "fault_from_s",
                real(&|d, _| d.fault.map_or(nan, |x| x.from_s)),
            );
            flights.push("fault_to_s", real(&|d, _| d.fault.map_or(nan, |x| x.to_s)));
        }
        for (i, figure) in FIGURES.iter().enumerate() {
            flights.push(figure.name, real(&|_, f| f.figures[i]));
        }
        flights.push("passed", flag(&|f| self.passed(f)));
        flights.push("departed", flag(&|f| self.departed(f)));
        flights.push("fault_as_stated", flag(&|f| f.fault_as_stated));
        flights.push("diverged", flag(&|f| f.diverged));

        let mut samples = Frame::default();
        let number = |x: &CampaignFlight| repeat_n(x.number as i64, x.result.samples.len());
        let numbers = all.iter().flat_map(number);
        samples.push("flight", Column::Integer(numbers.collect()));
        let single = |of: &dyn Fn(&Sample) -> f32| {
            let rows = all.iter().flat_map(|x| &x.result.samples);
            Column::Single(rows.map(of).collect())
        };
        samples.push("t_s", single(&|row| row.0));
        for (i, name) in SAMPLED.into_iter().enumerate() {
            samples.push(name, single(&|row| row.1[i]));
        }
        (flights, samples)
    }

    /// Whether `result` keeps every limit, whatever share of the flights has to.
    fn passed(&self, result: &FlightResult) -> bool {
        self.limits
            .iter()
            .all(|limit| limit.excess(limit.of(result)) <= 0.0)
    }

    fn departed(&self, result: &FlightResult) -> bool {
        let outside = |l: &super::Limit| l.departure && l.excess(l.of(result)) > 0.0;
        self.limits.iter().any(outside)
    }
}

impl super::Limit {
    fn of(&self, result: &FlightResult) -> f64 {
        result.figure(&self.figure)
    }
}
