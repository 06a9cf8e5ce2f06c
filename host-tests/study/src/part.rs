//! A part of a campaign's results: a Parquet file that says in its metadata which campaign and which flights it is of, with a checksum of
//! all of its bytes.
//!
//! A part is complete or not there, but a disk may change it afterwards, and a hand may put it beside another campaign's. Either would
//! go into the results unseen.

use std::path::Path;

use anyhow::{Context, bail};

use super::Frame;
use super::frame_file::{self, FrameWriter};
use crate::files::leave_all;

/// What a part is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Seal {
    /// [`checksum`] of the campaign's texts.
    pub identity: u64,
    /// `flights` or `samples`.
    pub kind: &'static str,
    /// Number of the part.
    pub chunk: u64,
}

/// The metadata's key.
const KEY: &str = "alula.part";
/// What stands before the checksum's digits.
const BEFORE: &str = " checksum ";
/// Hexadecimal digits of a checksum.
const DIGITS: usize = 16;

/// FNV-1a of 64 bits. Every step is invertible in what was before it, so that one changed byte always changes the result.
pub(super) fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

impl Seal {
    /// The metadata's text, with the `checksum`.
    fn text(&self, checksum: u64) -> String {
        let Self {
            identity,
            kind,
            chunk,
        } = self;
        format!("campaign {identity:016x} {kind} {chunk}{BEFORE}{checksum:016x}")
    }

    /// Leaves `frame` as the part at `path`.
    pub fn write(&self, path: &Path, frame: &Frame) -> anyhow::Result<()> {
        let mut bytes = Vec::new();
        // The checksum is of the file with the checksum's digits at 0.
        let mut writer = FrameWriter::with_metadata(&mut bytes, KEY, self.text(0));
        writer.write(frame)?;
        writer.close()?;
        let place = digits(&bytes).context("the metadata were not written")?;
        let sum = format!("{:016x}", checksum(&bytes));
        bytes[place].copy_from_slice(sum.as_bytes());
        leave_all(path, bytes)
    }

    /// The bytes of the part at `path`. One that has changed since it was written, or is another's, is an error that says what to delete.
    pub fn bytes(&self, path: &Path) -> anyhow::Result<Vec<u8>> {
        let read = || {
            let bytes = std::fs::read(path)?;
            self.check(&bytes)?;
            anyhow::Ok(bytes)
        };
        read().with_context(|| path.display().to_string())
    }

    /// The frame of the part at `path`, checked as by [`Self::bytes`].
    pub fn read(&self, path: &Path) -> anyhow::Result<Frame> {
        self.bytes(path)?;
        frame_file::read(path)
    }

    fn check(&self, bytes: &[u8]) -> anyhow::Result<()> {
        let damaged =
            "has changed since it was written; delete it, and the same command flies it again";
        let Some(place) = digits(bytes) else {
            bail!("{damaged}");
        };
        let mut zeroed = bytes.to_vec();
        zeroed[place.clone()].fill(b'0');
        let sum = format!("{:016x}", checksum(&zeroed));
        if bytes[place.clone()] != *sum.as_bytes() {
            bail!("{damaged}");
        }
        let (own, rest) = (self.text(0), DIGITS);
        let own = &own.as_bytes()[..own.len() - rest];
        if !zeroed[..place.start].ends_with(own) {
            bail!(
                "belongs to another campaign, or to another place in this one; delete it, and the same command flies it again"
            );
        }
        Ok(())
    }
}

/// Where the checksum's digits are.
fn digits(bytes: &[u8]) -> Option<std::ops::Range<usize>> {
    let before = BEFORE.as_bytes();
    let place = bytes.windows(before.len()).rposition(|w| w == before)?;
    let start = place + before.len();
    (start + DIGITS <= bytes.len()).then_some(start..start + DIGITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Column;
    use crate::refusals::says;

    const SEAL: Seal = Seal {
        identity: 0x1234,
        kind: "flights",
        chunk: 7,
    };

    fn frame() -> Frame {
        let mut frame = Frame::default();
        frame.push("flight", Column::Integer((0..5).collect()));
        frame.push("x", Column::Real(vec![0.5; 5]));
        frame
    }

    /// Every byte of the file, one after the other: each is found, and the error says what to do.
    #[test]
    fn any_changed_byte_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("000007.parquet");
        SEAL.write(&path, &frame()).unwrap();
        assert_eq!(SEAL.read(&path).unwrap(), frame());
        let bytes = std::fs::read(&path).unwrap();
        for i in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[i] ^= 1 << (i % 8);
            assert!(SEAL.check(&changed).is_err(), "byte {i}");
        }
        assert!(SEAL.check(&bytes[..bytes.len() / 2]).is_err());
        assert!(SEAL.check(&[]).is_err());
        std::fs::write(&path, &bytes[..20]).unwrap();
        let error = format!("{:#}", SEAL.read(&path).unwrap_err());
        says(&error, &["000007.parquet: has changed since"]);
        assert!(error.contains("delete it"), "{error}");
    }

    #[test]
    fn another_campaigns_part_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.parquet");
        SEAL.write(&path, &frame()).unwrap();
        let others = [
            Seal {
                identity: 1,
                ..SEAL
            },
            Seal {
                kind: "samples",
                ..SEAL
            },
            Seal { chunk: 17, ..SEAL },
        ];
        for other in others {
            let error = format!("{:#}", other.read(&path).unwrap_err());
            assert!(error.contains("belongs to another campaign"), "{error}");
        }
    }
}
