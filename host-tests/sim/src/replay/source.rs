//! What is replayed: a trace, or an autopilot's log.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use alula_logs::states::{self, States};
use anyhow::{Context, anyhow};

use super::steps::{self, Times};
use super::{log, rejected, trace};
use crate::experiment::Experiment;
use crate::kind::{Kind, expect_recorded};
use crate::named::{hint, text_of};
use crate::polar::holds_polar;
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
        expect_recorded(file)?;
        let mut head = Vec::new();
        let opened = File::open(file).with_context(|| origin.clone())?;
        let read = opened.take(1 << 16).read_to_end(&mut head);
        read.with_context(|| origin.clone())?;
        alula_logs::refused(&origin, &head)?;
        let mut factor = None;
        let log = match map {
            Some(map) => {
                let name = map.display().to_string();
                let text = text_of(map)?;
                let map = alula_logs::csv::Map::parse(&name, &text)?;
                known(&name, &text, &map)?;
                factor = Some(map.time.scale);
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
                    let cause = [format!("no {}", missing.what)].into_iter();
                    let all = cause.chain(log.notes.iter().cloned());
                    let all = all.chain([held(&log)]).chain(missing.looked_for());
                    anyhow!("{origin}: {}", all.collect::<Vec<_>>().join("; "))
                })?;
                states.notes.splice(0..0, log.notes);
                let header = first_name(&head);
                let said = match factor {
                    Some(factor) => Times::Map(factor),
                    None if is_plain(&head) => Times::Header(&header),
                    None => Times::Own,
                };
                steps::check(&states.time, &said).with_context(|| origin.clone())?;
                Content::Log(Box::new(states))
            }
            None => {
                if holds_polar(&String::from_utf8_lossy(&head)) {
                    return Err(Kind::Polar.refused("a trace or a log", &origin));
                }
                let times = trace::times(File::open(file).with_context(|| origin.clone())?);
                steps::check(&times, &Times::Trace).with_context(|| origin.clone())?;
                Content::Trace(File::open(file).with_context(|| origin.clone())?)
            }
        };
        Ok(Self { origin, content })
    }

    /// Runs the controller of `experiment` over it: each step, and what had to be assumed.
    pub fn replay(self, experiment: &Experiment) -> anyhow::Result<(Record, Vec<String>)> {
        let (record, mut said) = match self.content {
            Content::Trace(file) => trace::replay(&self.origin, file, experiment)?,
            Content::Log(states) => log::replay(&states, experiment).context(self.origin)?,
        };
        said.extend(rejected::notes(&record));
        if experiment.mission.is_some() {
            said.push(MISSION.to_owned());
        }
        Ok((record, said))
    }
}

/// What the replay of a mission is not.
const MISSION: &str = "the experiment flies a mission, which does not ask the guidance on the ground; a replay asks it in every row, and its commands are not those that were flown";

/// The name of the first column of a CSV that begins with `head`, without a unit.
fn first_name(head: &[u8]) -> String {
    let end = head.iter().position(|byte| b",\r\n".contains(byte));
    let text = String::from_utf8_lossy(&head[..end.unwrap_or(head.len())]);
    let name = text.split(['[', '(']).next().unwrap_or_default();
    name.trim().trim_matches('"').to_owned()
}

/// Whether a CSV that begins with `head` has its attitude in the columns that a plain table of states has, their units in brackets or not.
fn is_plain(head: &[u8]) -> bool {
    let line = head
        .split(|byte| b"\r\n".contains(byte))
        .next()
        .unwrap_or_default();
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Opens a CSV of five rows, `step` apart, under this header, with a map or without.
    fn open(header: &str, step: f64, map: Option<&str>) -> anyhow::Result<Source> {
        let folder = tempfile::tempdir().unwrap();
        let (file, map_file) = (folder.path().join("x.csv"), folder.path().join("map.toml"));
        // Level in pitch 90°, at rest; columns beyond are 0.
        let rest = ",0".repeat(header.matches(',').count() - 2);
        let row = |n: u32| format!("{},0,90{rest}\n", 10.0 + f64::from(n) * step);
        let rows: String = (0..5).map(row).collect();
        std::fs::write(&file, format!("{header}\n{rows}")).unwrap();
        let map = map.map(|map| {
            std::fs::write(&map_file, map).unwrap();
            map_file
        });
        Source::open(&file, map.as_ref())
    }

    /// What stands last between the signs of code in an error.
    fn advised(source: anyhow::Result<Source>) -> String {
        let error = format!("{:#}", source.err().expect("an error"));
        let code = error.split('`').rev().nth(1);
        code.unwrap_or_else(|| panic!("{error}")).to_owned()
    }

    /// A map without one of the three angles: that is said first, before what the log holds and what was looked for.
    #[test]
    fn an_angle_that_is_missing_is_named_first() {
        let map = "time = { from = \"T\" }\n[columns]\nroll = { from = \"a\" }\npitch = { from = \"b\" }\n";
        let source = open("T,a,b,c", 0.02, Some(map));
        let error = format!("{:#}", source.err().expect("an error"));
        let (_, cause) = error.split_once(": ").unwrap();
        assert!(
            cause.starts_with("no yaw beside roll pitch: no attitude; "),
            "{error}"
        );
    }

    /// Times in another unit, of few rows, too: what the error advises is followed to the letter, and the log is read with the right times.
    #[test]
    fn the_advice_on_the_unit_of_time_can_be_followed() {
        for per_second in [1e3, 1e6, 1e9, 1.0 / 60.0, 1.0 / 3600.0] {
            let apart = if per_second < 1.0 { 0.003 } else { 0.1 };
            let step = apart * per_second;
            let right = |source: anyhow::Result<Source>| {
                let Content::Log(states) = source.unwrap().content else {
                    panic!("not a log of states");
                };
                let times = states.time;
                assert!((times[1] - times[0] - apart).abs() < 1e-6, "{times:?}");
            };
            let columns = "roll [deg],pitch [deg],yaw [deg],vn,ve,vd";
            let header = advised(open(&format!("Time,{columns}"), step, None));
            right(open(&format!("{header},{columns}"), step, None));

            let map = |scale: &str| {
                let names = ["roll", "pitch", "yaw", "vn", "ve", "vd"];
                let unit = |name: &str| if name.len() > 2 { "deg" } else { "m/s" };
                let columns: String = names
                    .iter()
                    .map(|n| format!("{n} = {{ from = \"{n}\", unit = \"{}\" }}\n", unit(n)))
                    .collect();
                format!("time = {{ from = \"T\"{scale} }}\n[columns]\n{columns}")
            };
            let header = "T,roll,pitch,yaw,vn,ve,vd";
            let scale = advised(open(header, step, Some(&map(""))));
            right(open(header, step, Some(&map(&format!(", {scale}")))));
        }
        let trace = trace::REQUIRED.join(",");
        let error = format!("{:#}", open(&trace, 1e5, None).err().unwrap());
        assert!(error.ends_with("multiply it by 1e-6"), "{error}");
    }
}
