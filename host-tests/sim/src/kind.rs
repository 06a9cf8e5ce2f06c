//! What a file looks like: who gives a command a file of another kind is told what it is, and which command takes it.

use std::io::Read;
use std::path::Path;

use anyhow::{Context, anyhow, bail};

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An experiment, or a vehicle of one.
    Experiment,
    /// A campaign.
    Campaign,
    /// A comparison.
    Comparison,
    /// What constants are searched by.
    Search,
    /// What is known of a vehicle.
    Known,
    /// A vehicle as it is, of the plant `tail-sitter`.
    TailSitter,
    /// Coefficients over the angle of attack.
    Polar,
    /// A mission of a ground station.
    Plan,
    /// The trace of a flight, or states in a table.
    Trace,
    /// An autopilot's log.
    Log,
    /// The flights of a campaign.
    Flights,
    /// A page or a picture.
    Page,
    /// A program.
    Code,
}

/// How logs begin: ULog, DataFlash, MCAP.
const LOGS: [&[u8]; 3] = [b"ULog\x01\x12\x35", b"\xa3\x95\x80", b"\x89MCAP"];
/// As much of a file as says what it is.
const HEAD: u64 = 1 << 16;

/// The kind of a document with a field of this name at its top. The first that is there decides.
const FIELDS: [(&str, Kind); 15] = [
    ("trials", Kind::Search),
    ("disperse", Kind::Campaign),
    ("limits", Kind::Campaign),
    ("flights", Kind::Campaign),
    ("variants", Kind::Comparison),
    ("conditions", Kind::Comparison),
    ("inertia_kg_m2", Kind::TailSitter),
    ("cruise_speed_m_s", Kind::TailSitter),
    ("mass_kg", Kind::Known),
    ("thrust_to_weight", Kind::Known),
    ("turn_rad_s2", Kind::Known),
    ("vehicle", Kind::Experiment),
    ("base", Kind::Experiment),
    ("reference", Kind::Experiment),
    ("duration_s", Kind::Experiment),
];

impl Kind {
    /// The kind of a file that begins with `bytes`, if it shows.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        if LOGS.iter().any(|mark| bytes.starts_with(mark)) {
            return Some(Self::Log);
        }
        if bytes.starts_with(b"PAR1") {
            return Some(Self::Flights);
        }
        let text = String::from_utf8_lossy(bytes);
        let text = text.trim_start_matches('\u{feff}').trim_start();
        let first = text.lines().next().unwrap_or_default();
        let cells: Vec<&str> = first.split(',').map(|cell| cell.trim()).collect();
        let begins = |marks: &[&str]| marks.iter().any(|mark| text.starts_with(mark));
        let lower = first.to_lowercase();
        if lower.starts_with("<!doctype html") || lower.starts_with("<html") || begins(&["<svg"]) {
            Some(Self::Page)
        } else if begins(&["//", "/*", "#include", "#ifndef", "#pragma", "#!"]) {
            Some(Self::Code)
        } else if text.starts_with('{') && text.contains("\"fileType\"") && text.contains("Plan") {
            Some(Self::Plan)
        } else if cells.len() > 3 && cells[0] == "t_s" {
            Some(Self::Trace)
        } else {
            let table = text.parse::<toml::Table>().ok()?;
            let found = FIELDS.iter().find(|(field, _)| table.contains_key(*field));
            found.map(|(_, kind)| *kind)
        }
    }

    /// What it is, and what takes it.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Experiment => (
                "an experiment or a vehicle",
                "`alula-sil fly` flies an experiment; `view`, `sweep`, `code` take one, too; `margins` and `equilibria` take a vehicle as well",
            ),
            Self::Campaign => ("a campaign", "`alula-sil campaign` flies it"),
            Self::Comparison => ("a comparison", "`alula-sil compare` flies it"),
            Self::Search => (
                "what constants are searched by",
                "`alula-sil tune` takes it",
            ),
            Self::Known => (
                "what is known of a vehicle",
                "`alula-sil new --from` makes a vehicle of it, and an experiment that flies it",
            ),
            Self::TailSitter => (
                "a vehicle as it is",
                "an experiment names it, `[plant] kind = \"tail-sitter\"`, `vehicle = \"…\"`",
            ),
            Self::Polar => (
                "a polar",
                "`alula-sil fit` takes it, `new --section`, and a vehicle's file, `[vehicle.aerodynamics.table] polar = \"…\"`",
            ),
            Self::Plan => (
                "a mission of a ground station",
                "`alula-sil fly FILE --vehicle EXPERIMENT` flies it",
            ),
            Self::Trace => (
                "the trace of a flight",
                "`alula-sil replay` and `view` take it",
            ),
            Self::Log => (
                "an autopilot's log",
                "`alula-sil replay`, `view` and `identify` take it",
            ),
            Self::Flights => (
                "the flights of a campaign",
                "what reads Parquet takes it, as pandas; a page of it lies beside it",
            ),
            Self::Page => (
                "a page or a picture",
                "a browser shows it; what it was made of lies beside it",
            ),
            Self::Code => ("a program", "a compiler takes it"),
        }
    }

    /// The refusal of this kind in place of what is called `words`; `origin` stands for it.
    pub fn refused(self, words: &str, origin: &str) -> anyhow::Error {
        let (what, taken) = self.words();
        anyhow!("{origin}: {what}, where {words} is wanted: {taken}")
    }

    /// Refuses a text that is clearly of another kind; `origin` stands for it in errors.
    pub fn expect(self, origin: &str, text: &[u8]) -> anyhow::Result<()> {
        expect(&[self], self.words().0, origin, text)
    }

    /// Refuses a folder, and a file that is clearly of another kind.
    pub fn expect_file(self, path: &Path) -> anyhow::Result<()> {
        self.expect(&path.display().to_string(), &head(path)?)
    }
}

/// Refuses a file that begins with `bytes` and is clearly of none of the kinds `wanted`, which are called `words`; `origin` stands for it in errors.
pub fn expect(wanted: &[Kind], words: &str, origin: &str, bytes: &[u8]) -> anyhow::Result<()> {
    match Kind::of(bytes).filter(|kind| !wanted.contains(kind)) {
        Some(kind) => Err(kind.refused(words, origin)),
        None => Ok(()),
    }
}

/// Refuses a folder in the place of a file; of one that `new` made it names the file.
pub fn expect_no_folder(path: &Path) -> anyhow::Result<()> {
    if path.is_dir() {
        let mut within = path.join(path.file_name().unwrap_or_default());
        within.as_mut_os_string().push(".toml");
        let meant = match within.is_file() {
            true => format!(": {}?", within.display()),
            false => String::new(),
        };
        bail!(
            "{}: a folder, where a file is wanted{meant}",
            path.display()
        );
    }
    Ok(())
}

/// How a file begins.
fn head(path: &Path) -> anyhow::Result<Vec<u8>> {
    expect_no_folder(path)?;
    let origin = || path.display().to_string();
    let file = std::fs::File::open(path).with_context(origin)?;
    let mut head = Vec::new();
    let read = file.take(HEAD).read_to_end(&mut head);
    read.with_context(origin)?;
    Ok(head)
}

/// Refuses a file that cannot be what is recorded of a flight: a trace or a log.
pub fn expect_recorded(path: &Path) -> anyhow::Result<()> {
    let recorded = [Kind::Trace, Kind::Log];
    let origin = path.display().to_string();
    expect(&recorded, "a trace or a log", &origin, &head(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_what_they_hold() {
        for (text, kind) in [
            ("# mine\n[vehicle]\nmass_kg = 3.0\n", Kind::Experiment),
            ("base = \"paper\"\nduration_s = 3.0\n", Kind::Experiment),
            (
                "base = \"paper\"\nflights = 3\n[[disperse]]\n",
                Kind::Campaign,
            ),
            (
                "base = \"paper\"\n[[variants]]\nname = \"x\"\n",
                Kind::Comparison,
            ),
            ("mass_kg = 3.0\n", Kind::Known),
            ("{\n \"fileType\": \"Plan\"\n}\n", Kind::Plan),
            ("t_s,north_m,east_m,down_m\n0,0,0,0\n", Kind::Trace),
            ("ULog\x01\x12\x35", Kind::Log),
            ("PAR1\x15", Kind::Flights),
            ("<!DOCTYPE html>\n<html>", Kind::Page),
            ("/* A vehicle. */\n#pragma once\n", Kind::Code),
        ] {
            assert_eq!(Kind::of(text.as_bytes()), Some(kind), "{text}");
            let refused = Kind::Polar.expect("x", text.as_bytes()).unwrap_err();
            let refused = refused.to_string();
            assert!(refused.contains(", where a polar is wanted: "), "{refused}");
            assert!(kind.expect("x", text.as_bytes()).is_ok());
        }
        // What does not show is left to who reads it.
        for text in ["", "notes of a flight", "alpha,cl,cd\n0,0,0\n", "[vehicle"] {
            assert_eq!(Kind::of(text.as_bytes()), None, "{text}");
        }
    }
}
