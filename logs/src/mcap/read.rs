//! Reading MCAP with JSON messages. By own code: the crate that writes it (`mcap` 0.26) panics on damaged files.

mod chunk;
mod clock;

use super::named;
use crate::{Column, Error, Log, Topic};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};

/// What every MCAP file begins with.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Whether a file that begins with `head` is MCAP.
#[must_use]
pub fn is_mcap(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

/// The rows of one channel as they are read.
struct Rows {
    /// When each was logged \[s\].
    logged: Vec<f64>,
    /// What its `timestamp` says, in a unit of its own; NaN if it has none.
    stamps: Vec<f64>,
    columns: Vec<Column>,
    /// Name → place among the columns.
    places: BTreeMap<String, usize>,
}

/// Most columns of a channel: a message whose fields would make more is left out.
const COLUMNS: usize = 4096;

/// The numbers of a message by their columns' names; those of an array are `name[0]`, `name[1]`, …
fn numbers(fields: &Map<String, Value>) -> Vec<(String, f64)> {
    let number = |value: &Value| match value {
        Value::Bool(is) => f64::from(u8::from(*is)),
        value => value.as_f64().unwrap_or(f64::NAN),
    };
    let mut numbers = Vec::new();
    for (name, value) in fields.iter().filter(|(name, _)| *name != "timestamp") {
        match value {
            Value::Array(values) => {
                let elements = values.iter().enumerate();
                numbers.extend(elements.map(|(i, v)| (format!("{name}[{i}]"), number(v))));
            }
            value => numbers.push((name.clone(), number(value))),
        }
    }
    numbers
}

/// The value in the text of a message. Python and C++ write `NaN` and `Infinity`, which JSON has not: they are null.
fn value(data: &[u8]) -> Option<Value> {
    serde_json::from_slice(data)
        .or_else(|_| serde_json::from_slice(&without_tokens(data)))
        .ok()
}

/// The text with null in place of what is no number of JSON, outside of strings.
fn without_tokens(data: &[u8]) -> Vec<u8> {
    const TOKENS: [&[u8]; 8] = [
        b"NaN",
        b"nan",
        b"-NaN",
        b"-nan",
        b"Infinity",
        b"-Infinity",
        b"inf",
        b"-inf",
    ];
    let mut text = Vec::with_capacity(data.len());
    let (mut rest, mut quoted) = (data, false);
    while let [first, more @ ..] = rest {
        let token = TOKENS
            .iter()
            .filter(|token| !quoted && rest.starts_with(token));
        if let Some(token) = token.max_by_key(|token| token.len()) {
            text.extend_from_slice(b"null");
            rest = &rest[token.len()..];
            continue;
        }
        text.push(*first);
        rest = more;
        match first {
            b'"' => quoted = !quoted,
            b'\\' if quoted => {
                text.extend(rest.first());
                rest = rest.get(1..).unwrap_or_default();
            }
            _ => {}
        }
    }
    text
}

impl Rows {
    fn new() -> Self {
        Self {
            logged: Vec::new(),
            stamps: Vec::new(),
            columns: Vec::new(),
            places: BTreeMap::new(),
        }
    }

    /// Adds a row, and the columns that no row before it had; whether there is room for them.
    fn add(
        &mut self,
        logged: f64,
        stamp: f64,
        numbers: &[(String, f64)],
        units: &BTreeMap<String, String>,
    ) -> bool {
        let unknown = numbers
            .iter()
            .filter(|(name, _)| !self.places.contains_key(name));
        if self.columns.len() + unknown.count() > COLUMNS {
            return false;
        }
        let row = self.logged.len();
        self.logged.push(logged);
        self.stamps.push(stamp);
        for (name, value) in numbers {
            let columns = &mut self.columns;
            let place = *self.places.entry(name.clone()).or_insert_with(|| {
                let field = name.split('[').next().unwrap_or_default();
                let unit = units.get(field).map_or("", String::as_str);
                columns.push(Column::new(name, unit, Vec::new()));
                columns.len() - 1
            });
            if let Some(column) = columns.get_mut(place) {
                column.values.resize(row, f64::NAN);
                column.values.push(*value);
            }
        }
        true
    }

    /// Its columns, NaN where a row has none. A field that is null where it is no array is that array.
    fn columns(self) -> Vec<Column> {
        let rows = self.logged.len();
        let places = self.places;
        let mut columns = self.columns;
        for column in &mut columns {
            column.values.resize(rows, f64::NAN);
        }
        columns.retain(|column| {
            let array = places.contains_key(&format!("{}[0]", column.name));
            !array || column.values.iter().any(|v| !v.is_nan())
        });
        columns
    }
}

/// Bytes yet to be read.
#[derive(Clone, Copy)]
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (first, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(first)
    }

    /// An unsigned number of this many bytes, the lowest first.
    fn number(&mut self, bytes: usize) -> Option<u64> {
        let taken = self.take(bytes)?;
        let shifted = |sum: u64, (i, byte): (usize, &u8)| sum | u64::from(*byte) << (8 * i);
        Some(taken.iter().enumerate().fold(0, shifted))
    }

    /// What has its length, of this many bytes, before it.
    fn part(&mut self, bytes: usize) -> Option<&'a [u8]> {
        let length = self.number(bytes)?;
        self.take(length.try_into().ok()?)
    }

    fn text(&mut self) -> Option<String> {
        Some(String::from_utf8_lossy(self.part(4)?).into_owned())
    }
}

/// Kinds of records.
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;
const END_OF_DATA: u8 = 0x0f;

/// A channel of JSON, or of something else.
struct Channel {
    topic: String,
    encoding: String,
    /// Field → unit.
    units: BTreeMap<String, String>,
    /// None before the first message.
    rows: Option<Rows>,
    /// Messages left out.
    others: usize,
}

impl Channel {
    /// Its number, and what a record says of it.
    fn of(mut record: Bytes) -> Option<(u64, Self)> {
        let id = record.number(2)?;
        record.number(2)?;
        let (topic, encoding) = (record.text()?, record.text()?);
        let mut metadata = Bytes(record.part(4)?);
        let mut units = BTreeMap::new();
        while let (Some(field), Some(unit)) = (metadata.text(), metadata.text()) {
            units.insert(field, unit);
        }
        let channel = Self {
            topic,
            encoding,
            units,
            rows: None,
            others: 0,
        };
        Some((id, channel))
    }

    /// Takes the `data` of a message logged at `logged` \[s\].
    fn take(&mut self, logged: f64, data: &[u8]) {
        let json = self.encoding == "json";
        let object = json.then(|| value(data));
        let Some(Value::Object(fields)) = object.flatten() else {
            self.others += 1;
            return;
        };
        let numbers = numbers(&fields);
        let stamp = fields.get("timestamp").and_then(Value::as_f64);
        let rows = self.rows.get_or_insert_with(Rows::new);
        let stamp = stamp.unwrap_or(f64::NAN);
        self.others += usize::from(!rows.add(logged, stamp, &numbers, &self.units));
    }
}

/// Whether `checksum` is there and is not that of `bytes`.
fn is_wrong(checksum: u64, bytes: &[u8]) -> bool {
    checksum != 0 && checksum != u64::from(crc32fast::hash(bytes))
}

/// What was read so far.
#[derive(Default)]
struct Reading {
    channels: BTreeMap<u64, Channel>,
    /// Chunks left out, by the reason.
    left_out: BTreeMap<String, usize>,
    /// Where the data end: the bytes from there on, and the checksum of those before; 0 if there is none.
    end: Option<(usize, u64)>,
}

impl Reading {
    /// Takes records up to the end of the data; none if they are damaged.
    fn take(&mut self, mut bytes: Bytes, nested: bool) -> Option<()> {
        while !bytes.0.is_empty() {
            let rest = bytes.0.len();
            let kind = bytes.number(1)? as u8;
            let mut record = Bytes(bytes.part(8)?);
            match kind {
                CHANNEL => {
                    let (id, channel) = Channel::of(record)?;
                    self.channels.entry(id).or_insert(channel);
                }
                MESSAGE => {
                    let id = record.number(2)?;
                    record.number(4)?;
                    let logged = record.number(8)? as f64 * 1e-9;
                    record.number(8)?;
                    self.channels.get_mut(&id)?.take(logged, record.0);
                }
                CHUNK if !nested => {
                    record.take(16)?;
                    let size = record.number(8)?;
                    let checksum = record.number(4)?;
                    let compression = record.text()?;
                    let records = chunk::records(&compression, record.part(8)?, size);
                    let records = records.and_then(|records| match is_wrong(checksum, &records) {
                        true => Err("a wrong checksum".to_owned()),
                        false => Ok(records),
                    });
                    match records {
                        Ok(records) => self.take(Bytes(&records), true)?,
                        Err(why) => *self.left_out.entry(why).or_default() += 1,
                    }
                }
                END_OF_DATA => {
                    self.end = Some((rest, record.number(4)?));
                    return Some(());
                }
                _ => {}
            }
        }
        nested.then_some(())
    }
}

/// Reads the channels of JSON messages in `bytes`, the file called `file` in errors, as [`write`](super::write) leaves them: a message's numbers
/// are columns, those of an array `name[0]`, `name[1]`, …; its time is `timestamp`, in the unit that the times at which messages were logged tell, or
/// else that time itself. What is no number, `NaN` as Python writes it too, or not in a message, is NaN. Chunks may be compressed by zstd or lz4. Messages of another encoding, and chunks whose checksum
/// is wrong are left out, and of a file that is damaged between its records what follows; all are noted, and a wrong checksum of the whole.
///
/// # Errors
/// [`Error::Format`]: not MCAP, or no message of JSON in it, and why.
pub fn read(file: &str, bytes: &[u8]) -> Result<Log, Error> {
    let Some(records) = bytes.strip_prefix(MAGIC) else {
        return Err(Error::Format {
            file: file.into(),
            offset: 0,
            problem: "no MCAP file".into(),
        });
    };
    let mut reading = Reading::default();
    let whole = reading.take(Bytes(records), false);
    let mut notes = Vec::new();
    if whole.is_none() {
        notes.push("damaged or cut off: read up to there".into());
    }
    for (why, count) in &reading.left_out {
        notes.push(format!("chunks left out for {why}: {count}"));
    }
    let checked = |&(rest, checksum): &(usize, u64)| {
        let before = bytes.get(..bytes.len().saturating_sub(rest));
        before.is_some_and(|before| is_wrong(checksum, before))
    };
    if reading.left_out.is_empty() && reading.end.as_ref().is_some_and(checked) {
        notes.push("the checksum of the data is wrong: some of them are damaged".into());
    }
    let mut channels: Vec<Channel> = reading.channels.into_values().collect();
    if channels.iter().all(|channel| channel.rows.is_none()) {
        let why = nothing(&channels, notes);
        return Err(Error::Format {
            file: file.into(),
            offset: 0,
            problem: format!("no messages of JSON, which alone are read: {why}"),
        });
    }
    let times = clock::times(
        channels
            .iter()
            .filter_map(|channel| Some((channel.topic.as_str(), channel.rows.as_ref()?))),
        &mut notes,
    );
    let mut times = times.into_iter();
    let mut topics = Vec::new();
    let mut seen = BTreeSet::new();
    for channel in channels.drain(..) {
        let (name, instance) = named(&channel.topic);
        if channel.others > 0 {
            notes.push(format!(
                "{}: {} messages left out: not of JSON, or of too many fields",
                channel.topic, channel.others
            ));
        }
        let topic = channel.rows.and_then(|rows| {
            let time = times.next().unwrap_or_else(|| rows.logged.clone());
            Topic::from_rows(name, instance, time, rows.columns(), &mut notes)
        });
        // Two channels of one name: the first.
        topics.extend(topic.filter(|t| seen.insert((t.name().to_owned(), t.instance()))));
    }
    Ok(Log { topics, notes })
}

/// Why a file has no message of JSON.
fn nothing(channels: &[Channel], notes: Vec<String>) -> String {
    let mut encodings: BTreeMap<&str, usize> = BTreeMap::new();
    for channel in channels.iter().filter(|channel| channel.encoding != "json") {
        *encodings.entry(&channel.encoding).or_default() += 1;
    }
    let of = |(encoding, count): (&&str, &usize)| match *encoding {
        "" => format!("channels of no stated encoding: {count}"),
        encoding => format!("channels of {encoding}: {count}"),
    };
    let all: Vec<String> = notes.into_iter().chain(encodings.iter().map(of)).collect();
    match all.is_empty() {
        true => "it has none at all".to_owned(),
        false => all.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{tests::log, write};
    use super::*;
    use std::io::Cursor;

    #[test]
    fn what_was_written_is_read_back() {
        let log = log();
        let mut out = Cursor::new(Vec::new());
        write(&log, &mut out).unwrap();
        let back = read("x", out.get_ref()).unwrap();
        assert_eq!(back.notes, [""; 0]);
        assert_eq!(back.topics[0], log.topics[0]);
        let wind = back.instance("wind", 1).unwrap();
        assert_eq!(wind.time(), [0.1, 2.0]);
        let x = wind.column("x").unwrap();
        assert!(x.unit == "m/s" && x.values[0] == -1e-7 && x.values[1].is_nan());
        // Cut off in the middle: said, and no more.
        let half = &out.get_ref()[..out.get_ref().len() / 3];
        let cut = read("x", half).unwrap_err().to_string();
        assert!(
            cut.ends_with("are read: damaged or cut off: read up to there"),
            "{cut}"
        );
        assert!(read("x", b"no log").is_err());
    }

    /// Names as ROS has them, and what is true.
    #[test]
    fn a_slash_before_a_name_and_truth_are_understood() {
        let mut out = Cursor::new(Vec::new());
        let mut writer = mcap::WriteOptions::new()
            .compression(None)
            .create(&mut out)
            .unwrap();
        let channel = writer
            .add_channel(0, "/vehicle_status", "json", &BTreeMap::new())
            .unwrap();
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: 2_000_000_000,
            publish_time: 2_000_000_000,
        };
        let text = br#"{"is_vtol_tailsitter": true, "armed": false}"#;
        writer.write_to_known_channel(&header, text).unwrap();
        writer.finish().unwrap();
        drop(writer);
        let log = read("x", out.get_ref()).unwrap();
        let value = |name| log.column("vehicle_status", name).unwrap().values[0];
        assert_eq!((value("is_vtol_tailsitter"), value("armed")), (1.0, 0.0));
    }

    /// A digit of a message changed: it is still JSON, and only the checksums know.
    #[test]
    fn what_its_checksums_do_not_hold_is_noted() {
        let mut out = Cursor::new(Vec::new());
        write(&log(), &mut out).unwrap();
        let mut file = out.into_inner();
        let text = b"\"x\":-1e-7";
        let at = file.windows(text.len()).position(|w| w == text).unwrap();
        file[at + 5] = b'3';
        let error = read("x", &file).unwrap_err().to_string();
        let why =
            "no messages of JSON, which alone are read: chunks left out for a wrong checksum: 1";
        assert!(error.contains(why), "{error}");
        // The same without the chunk's own checksum: what is there is read, and the checksum of the whole tells.
        let mut chunk = MAGIC.len();
        while file[chunk] != CHUNK {
            let length = u64::from_le_bytes(file[chunk + 1..chunk + 9].try_into().unwrap());
            chunk += 9 + length as usize;
        }
        file[chunk + 9 + 24..][..4].fill(0);
        let log = read("x", &file).unwrap();
        assert_eq!(
            log.notes,
            ["the checksum of the data is wrong: some of them are damaged"]
        );
        let wind = log.instance("wind", 1).unwrap();
        assert_eq!(wind.column("x").unwrap().values[0], -3e-7);
    }

    /// Channels of another encoding alone: that is the first thing said.
    #[test]
    fn what_is_not_read_is_said_first() {
        let mut out = Cursor::new(Vec::new());
        let mut writer = mcap::WriteOptions::new()
            .compression(None)
            .create(&mut out)
            .unwrap();
        for name in ["/a", "/b"] {
            let channel = writer
                .add_channel(0, name, "cdr", &BTreeMap::new())
                .unwrap();
            let header = mcap::records::MessageHeader {
                channel_id: channel,
                sequence: 0,
                log_time: 0,
                publish_time: 0,
            };
            writer.write_to_known_channel(&header, &[0; 4]).unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        let error = read("x", out.get_ref()).unwrap_err().to_string();
        assert_eq!(
            error,
            "x: byte 0: no messages of JSON, which alone are read: channels of cdr: 2"
        );
    }

    /// The file of these messages of one channel, 0.1 s apart from 2 s on.
    fn file(messages: &[&str]) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        let mut writer = mcap::WriteOptions::new().create(&mut out).unwrap();
        let none = BTreeMap::new();
        let channel_id = writer.add_channel(0, "x", "json", &none).unwrap();
        for (sequence, text) in (0..).zip(messages) {
            let log_time = 2_000_000_000 + u64::from(sequence) * 100_000_000;
            let header = mcap::records::MessageHeader {
                channel_id,
                sequence,
                log_time,
                publish_time: log_time,
            };
            writer
                .write_to_known_channel(&header, text.as_bytes())
                .unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        out.into_inner()
    }

    /// What Python writes for a number that is none, and what stands in a text.
    #[test]
    fn nan_and_infinity_are_read_as_none() {
        let log = read(
            "x",
            &file(&[
                r#"{"v": [1.5, NaN, -Infinity], "note": "NaN \" Infinity"}"#,
                r#"{"v": [1.5, 2.5, 3.5], "note": "NaN"}"#,
                r#"{"v": [nan, inf, -nan], "note": ""}"#,
            ]),
        )
        .unwrap();
        assert_eq!(log.notes, [""; 0]);
        let values = |name: &str| &log.column("x", name).unwrap().values;
        assert!(values("v[0]")[..2] == [1.5, 1.5] && values("v[0]")[2].is_nan());
        for (row, known) in [(0, false), (1, true), (2, false)] {
            assert_eq!(values("v[1]")[row].is_finite(), known);
            assert_eq!(values("v[2]")[row].is_finite(), known);
        }
    }

    /// A field that is null in one message and an array in another is one field; a field that is in some messages alone is known in those.
    #[test]
    fn fields_may_come_and_go() {
        let log = read(
            "x",
            &file(&[
                r#"{"a": 1, "v": null, "w": null}"#,
                r#"{"v": [1, 2], "a": 2}"#,
                r#"{"a": 3, "v": null, "later": 7}"#,
            ]),
        )
        .unwrap();
        assert_eq!(log.notes, [""; 0]);
        let names: Vec<&str> = log.topics[0].columns().iter().map(|c| &*c.name).collect();
        assert_eq!(names, ["a", "w", "v[0]", "v[1]", "later"]);
        let known = |name: &str| -> Vec<f64> {
            let values = &log.column("x", name).unwrap().values;
            values.iter().copied().filter(|v| v.is_finite()).collect()
        };
        assert_eq!(known("a"), [1.0, 2.0, 3.0]);
        assert_eq!(known("v[1]"), [2.0]);
        assert_eq!((known("later"), known("w")), (vec![7.0], vec![]));
        assert!(log.column("x", "v[0]").unwrap().values[0].is_nan());
        // More fields than a message can have.
        let many: Vec<String> = (0..=COLUMNS).map(|i| format!("\"f{i}\": 0")).collect();
        let many = format!("{{{}}}", many.join(","));
        let log = read("x", &file(&[r#"{"a": 1}"#, &many])).unwrap();
        assert!(
            log.notes[0].contains("x: 1 messages left out"),
            "{:?}",
            log.notes
        );
    }
}
