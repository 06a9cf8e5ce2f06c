//! What is replayed: a trace, or an autopilot's log.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use alula_logs::states::{self, States};
use anyhow::{Context, anyhow};

use super::{log, steps, trace};
use crate::experiment::Experiment;
use crate::named::{hint, text_of};
use crate::simulate::Record;

/// A log, opened.
pub struct Source {
    origin: String,
    content: Content,
}

enum Content {
    /// A CSV with the columns of a trace.
    Trace(File),
    /// Anything else.
    Log(Box<States>),
}

impl Source {
    /// Opens the log `file`: a CSV such as a flight's trace, a PX4 ULog, MCAP of JSON, or an ArduPilot DataFlash log. `map` is a TOML file that says which
    /// column of a foreign CSV is which.
    pub fn open(file: &Path, map: Option<&PathBuf>) -> anyhow::Result<Self> {
        let origin = file.display().to_string();
        let mut head = Vec::new();
        let opened = File::open(file).with_context(|| origin.clone())?;
        let read = opened.take(1 << 16).read_to_end(&mut head);
        read.with_context(|| origin.clone())?;
        alula_logs::blank(&origin, &head)?;
        let log = match map {
            Some(map) => {
                let name = map.display().to_string();
                let text = text_of(map)?;
                let map = alula_logs::csv::Map::parse(&name, &text)?;
                known(&name, &text, &map)?;
                let bytes = std::fs::read(file).with_context(|| origin.clone())?;
                Some(alula_logs::csv::read(&origin, &bytes, Some(&map))?)
            }
            None if alula_logs::is_autopilots(file, &head) || is_plain(&head) => {
                Some(alula_logs::read(file)?)
            }
            None => None,
        };
        let content = match log {
            Some(log) => {
                let mut states = states::find(&log).map_err(|missing| {
                    // What the reader has left out may be what is missing: it stands before the names that were looked for.
                    let all = log.notes.iter().cloned();
                    let all = all.chain([held(&log), missing.to_string()]);
                    anyhow!("{origin}: {}", all.collect::<Vec<_>>().join("; "))
                })?;
                states.notes.splice(0..0, log.notes);
                Content::Log(Box::new(states))
            }
            None => {
                steps::check(&trace::times(
                    File::open(file).with_context(|| origin.clone())?,
                ))
                .with_context(|| origin.clone())?;
                Content::Trace(File::open(file).with_context(|| origin.clone())?)
            }
        };
        Ok(Self { origin, content })
    }

    /// Runs the controller of `experiment` over it: each step, and what had to be assumed.
    pub fn replay(self, experiment: &Experiment) -> anyhow::Result<(Record, Vec<String>)> {
        match self.content {
            Content::Trace(file) => {
                let record = trace::replay(&self.origin, file, experiment)?;
                Ok((record, Vec::new()))
            }
            Content::Log(states) => log::replay(&states, experiment).context(self.origin),
        }
    }
}

/// Whether a CSV that begins with `head` has its attitude in the columns that a plain table of states has, their units in brackets or not.
fn is_plain(head: &[u8]) -> bool {
    let line = head.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let name = |cell: &[u8]| {
        let text = String::from_utf8_lossy(cell);
        let name = text.split(" [").next().unwrap_or_default();
        name.trim().trim_matches('"').to_owned()
    };
    let names: Vec<String> = line.split(|byte| *byte == b',').map(name).collect();
    let has = |wanted: &[&str]| wanted.iter().all(|name| names.iter().any(|n| n == name));
    has(&["qw", "qx", "qy", "qz"]) || has(&["roll", "pitch", "yaw"])
}

/// What a log holds, in words.
fn held(log: &alula_logs::Log) -> String {
    /// Topics that are named.
    const NAMED: usize = 8;
    let mut names: Vec<&str> = log.topics.iter().map(|topic| topic.name()).collect();
    names.dedup();
    let more = match names.len() > NAMED {
        true => ", …",
        false => "",
    };
    match names.is_empty() {
        true => "it holds no messages of numbers".to_owned(),
        false => format!(
            "it holds {}{more}",
            names[..names.len().min(NAMED)].join(", ")
        ),
    }
}

/// Refuses a name of the map's `[columns]` that no quantity has: it would be read for nothing.
fn known(file: &str, text: &str, map: &alula_logs::csv::Map) -> anyhow::Result<()> {
    let names = states::names(&map.topic);
    let unknown = map
        .columns
        .keys()
        .find(|name| !names.contains(&name.as_str()));
    let Some(name) = unknown.filter(|_| !names.is_empty()) else {
        return Ok(());
    };
    let begins = |line: &str| {
        let key = line.trim_start().trim_start_matches(['"', '\'']);
        key.strip_prefix(name.as_str())
            .is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    };
    let line = text.lines().position(begins).map_or(1, |line| line + 1);
    anyhow::bail!(
        "{file}:{line}: columns.{name}: no quantity has this name{}; the names are {}",
        hint(name, &names),
        names.join(", ")
    )
}
