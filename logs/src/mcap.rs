//! MCAP with JSON messages (<https://mcap.dev/spec>): what is written opens in Foxglove and PlotJuggler, and is read back.

use crate::error::output;
use crate::fields::{Field, fields, rows_by_time, twice};
use crate::{Column, Error, Log, Topic};
use ::mcap::records::MessageHeader;
use ::mcap::{McapError, MessageStream, WriteOptions};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// What every MCAP file begins with.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Whether a file that begins with `head` is MCAP.
#[must_use]
pub fn is_mcap(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

/// The rows of one channel as they are read.
struct Rows {
    time: Vec<f64>,
    columns: Vec<Column>,
}

/// The numbers of a message by their columns' names; those of an array are `name[0]`, `name[1]`, …
fn numbers(fields: &Map<String, Value>) -> Vec<(String, f64)> {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
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

impl Rows {
    /// Rows of the columns of a first message.
    fn new(numbers: &[(String, f64)], units: &BTreeMap<String, String>) -> Self {
        let unit = |name: &str| {
            let field = name.split('[').next().unwrap_or_default();
            units.get(field).map_or("", String::as_str)
        };
        let column = |(name, _): &(String, f64)| Column::new(name, unit(name), Vec::new());
        Self {
            time: Vec::new(),
            columns: numbers.iter().map(column).collect(),
        }
    }

    /// Adds a row; whether it has the columns of the first.
    fn add(&mut self, time: f64, numbers: &[(String, f64)]) -> bool {
        let names = self.columns.iter().map(|column| &column.name);
        let same = names.eq(numbers.iter().map(|(name, _)| name));
        if same {
            self.time.push(time);
            for (column, (_, value)) in self.columns.iter_mut().zip(numbers) {
                column.values.push(*value);
            }
        }
        same
    }
}

/// Reads the channels of JSON messages in `bytes`, the file called `file` in errors, as [`write`] leaves them: a message's numbers are
/// columns, those of an array `name[0]`, `name[1]`, …; its time is `timestamp` \[s\], or else the time at which it was logged. What is no
/// number is NaN. Messages of another encoding, or with other fields than the first of their channel, are left out, and of a damaged file what
/// follows the damage; both are noted.
///
/// # Errors
/// [`Error::Format`]: not MCAP.
pub fn read(file: &str, bytes: &[u8]) -> Result<Log, Error> {
    let not = |problem: String| Error::Format {
        file: file.into(),
        offset: 0,
        problem,
    };
    if !is_mcap(bytes) {
        return Err(not("no MCAP file".into()));
    }
    let mut notes = Vec::new();
    let mut channels: BTreeMap<String, Rows> = BTreeMap::new();
    let mut others: BTreeMap<String, usize> = BTreeMap::new();
    for message in MessageStream::new(bytes).map_err(|e| not(e.to_string()))? {
        let message = match message {
            Ok(message) => message,
            Err(error) => {
                notes.push(format!("read up to a damage: {error}"));
                break;
            }
        };
        let channel = &message.channel;
        let json = channel.message_encoding == "json";
        let object = json.then(|| serde_json::from_slice(&message.data).ok());
        let Some(Value::Object(fields)) = object.flatten() else {
            *others.entry(channel.topic.clone()).or_default() += 1;
            continue;
        };
        let numbers = numbers(&fields);
        let rows = channels
            .entry(channel.topic.clone())
            .or_insert_with(|| Rows::new(&numbers, &channel.metadata));
        let logged = message.log_time as f64 * 1e-9;
        let stamp = fields.get("timestamp").and_then(Value::as_f64);
        if !rows.add(stamp.unwrap_or(logged), &numbers) {
            *others.entry(channel.topic.clone()).or_default() += 1;
        }
    }
    for (topic, count) in others {
        notes.push(format!(
            "{topic}: {count} messages left out: not of JSON, or of other fields than the first"
        ));
    }
    let topic = |(name, rows): (String, Rows)| {
        let (name, instance) = named(&name);
        Topic::from_rows(name, instance, rows.time, rows.columns, &mut notes)
    };
    let topics = channels.into_iter().filter_map(topic).collect();
    Ok(Log { topics, notes })
}

/// The topic and the instance of a channel, as [`channel`] names it.
fn named(channel: &str) -> (&str, u8) {
    let split = channel.rsplit_once('.');
    let instance = split.and_then(|(name, instance)| Some((name, instance.parse().ok()?)));
    instance.unwrap_or((channel, 0))
}

/// Writes `log` as MCAP, all topics in the order of time.
///
/// Each topic is a channel of its name, a second instance `name.1`. A message is a JSON object of `timestamp` \[s\] and the
/// columns; neighbouring columns `q[0]`, `q[1]`, … are one array. The channel's JSON Schema describes each field by its
/// unit, and the channel's metadata holds field → unit. NaN and infinities, which JSON has not, are `null`.
///
/// # Errors
/// [`Error::Write`]: a time before 0; two channels of one name; two columns whose names become one.
/// [`Error::Io`]: `out` refuses.
pub fn write(log: &Log, out: impl Write + Seek) -> Result<(), Error> {
    let names: Vec<String> = log.topics.iter().map(channel).collect();
    if let Some(name) = twice(names.iter().map(String::as_str)) {
        return problem(format!("topic `{name}` is there twice"));
    }
    let options = WriteOptions::new().compression(None).library("alula-logs");
    let mut writer = options.create(out).map_err(failed)?;
    let mut channels = Vec::new();
    for (topic, name) in log.topics.iter().zip(&names) {
        let fields = fields(topic);
        if let Some(twice) = twice(fields.iter().map(|f| f.name.as_str()).chain(["timestamp"])) {
            return problem(format!("topic `{name}` has two fields `{twice}`"));
        }
        let schema = schema(name, &fields).to_string();
        let schema = writer
            .add_schema(name, "jsonschema", schema.as_bytes())
            .map_err(failed)?;
        let units: BTreeMap<String, String> = fields
            .iter()
            .map(|f| (f.name.clone(), unit(f).into()))
            .collect();
        let id = writer
            .add_channel(schema, name, "json", &units)
            .map_err(failed)?;
        channels.push((id, fields, 0));
    }
    for (time, topic, row) in rows_by_time(&log.topics) {
        if time < 0.0 {
            return problem(format!("a row at the time {time} s"));
        }
        let (channel_id, fields, sequence) = &mut channels[topic];
        let mut message = Map::new();
        message.insert("timestamp".into(), json!(time));
        for field in fields {
            let mut values = field.columns.iter().map(|c| json!(c.values[row]));
            let value = if field.array {
                values.collect()
            } else {
                values.next().unwrap_or(Value::Null)
            };
            message.insert(field.name.clone(), value);
        }
        let nanoseconds = (time * 1e9).round() as u64;
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: *sequence,
            log_time: nanoseconds,
            publish_time: nanoseconds,
        };
        *sequence += 1;
        let text = Value::Object(message).to_string();
        writer
            .write_to_known_channel(&header, text.as_bytes())
            .map_err(failed)?;
    }
    writer.finish().map_err(failed)?;
    Ok(())
}

fn channel(topic: &Topic) -> String {
    match topic.instance() {
        0 => topic.name().into(),
        instance => format!("{}.{instance}", topic.name()),
    }
}

fn unit<'a>(field: &Field<'a>) -> &'a str {
    field.columns.first().map_or("", |c| c.unit.as_str())
}

fn schema(name: &str, fields: &[Field]) -> Value {
    let number = |unit: &str| json!({ "type": ["number", "null"], "description": unit });
    let mut properties = Map::new();
    properties.insert(
        "timestamp".into(),
        json!({ "type": "number", "description": "s" }),
    );
    for field in fields {
        let number = number(unit(field));
        let property = if field.array {
            json!({ "type": "array", "items": number })
        } else {
            number
        };
        properties.insert(field.name.clone(), property);
    }
    json!({ "title": name, "type": "object", "properties": properties })
}

fn problem<T>(problem: String) -> Result<T, Error> {
    Err(Error::Write { problem })
}

fn failed(error: McapError) -> Error {
    match error {
        McapError::Io(e) => output(e),
        e => Error::Write {
            problem: e.to_string(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Column;
    use std::io::Cursor;

    #[test]
    fn messages_carry_every_number_and_channels_their_units() {
        let q = |i: usize| Column::new(&format!("q[{i}]"), "", vec![1.0 / 3.0, i as f64]);
        let x = Column::new("x", "m/s", vec![-1e-7, f64::NAN]);
        let topics = vec![
            Topic::new("attitude", 0, vec![0.25, 1.5], vec![q(0), q(1)]).unwrap(),
            Topic::new("wind", 1, vec![0.0, 2.0], vec![x]).unwrap(),
        ];
        let mut out = Cursor::new(Vec::new());
        write(
            &Log {
                topics,
                notes: Vec::new(),
            },
            &mut out,
        )
        .unwrap();
        let messages: Vec<_> = ::mcap::MessageStream::new(out.get_ref())
            .unwrap()
            .collect::<Result<_, _>>()
            .unwrap();
        let found: Vec<(String, u64, Value)> = messages
            .iter()
            .map(|m| {
                (
                    m.channel.topic.clone(),
                    m.log_time,
                    serde_json::from_slice(&m.data).unwrap(),
                )
            })
            .collect();
        let expected = [
            ("wind.1", 0, json!({ "timestamp": 0.0, "x": -1e-7 })),
            (
                "attitude",
                250_000_000,
                json!({ "timestamp": 0.25, "q": [1.0 / 3.0, 1.0 / 3.0] }),
            ),
            (
                "attitude",
                1_500_000_000,
                json!({ "timestamp": 1.5, "q": [0.0, 1.0] }),
            ),
            (
                "wind.1",
                2_000_000_000,
                json!({ "timestamp": 2.0, "x": null }),
            ),
        ];
        let expected = expected.map(|(name, time, value)| (name.to_owned(), time, value));
        assert_eq!(found, expected);
        let channel = &messages[0].channel;
        assert_eq!(channel.metadata["x"], "m/s");
        let schema: Value = serde_json::from_slice(&channel.schema.as_ref().unwrap().data).unwrap();
        assert_eq!(schema["properties"]["x"]["description"], "m/s");
    }

    #[test]
    fn what_was_written_is_read_back() {
        let q = |i: usize| Column::new(&format!("q[{i}]"), "rad", vec![1.0 / 3.0, i as f64]);
        let x = Column::new("x", "m/s", vec![-1e-7, f64::NAN]);
        let topics = vec![
            Topic::new("attitude", 0, vec![0.25, 1.5], vec![q(0), q(1)]).unwrap(),
            Topic::new("wind", 1, vec![0.1, 2.0], vec![x]).unwrap(),
        ];
        let log = Log {
            topics,
            notes: Vec::new(),
        };
        let mut out = Cursor::new(Vec::new());
        write(&log, &mut out).unwrap();
        let back = read("x", out.get_ref()).unwrap();
        assert_eq!(back.notes, [""; 0]);
        assert_eq!(back.topics[0], log.topics[0]);
        let wind = back.instance("wind", 1).unwrap();
        assert_eq!(wind.time(), [0.1, 2.0]);
        let x = wind.column("x").unwrap();
        assert!(x.unit == "m/s" && x.values[0] == -1e-7 && x.values[1].is_nan());
        // Cut off in the middle: what is before is there, and the rest is said to be missing.
        let half = &out.get_ref()[..out.get_ref().len() / 3];
        assert_eq!(read("x", half).unwrap().notes.len(), 1);
        assert!(read("x", b"no log").is_err());
    }

    #[test]
    fn what_mcap_cannot_hold_is_refused() {
        let topic = |name: &str, instance, time, column: &str| {
            Topic::new(
                name,
                instance,
                vec![time],
                vec![Column::new(column, "", vec![0.0])],
            )
            .unwrap()
        };
        let refusal = |topics: Vec<Topic>| {
            let log = Log {
                topics,
                notes: Vec::new(),
            };
            write(&log, Cursor::new(Vec::new()))
                .unwrap_err()
                .to_string()
        };
        assert!(refusal(vec![topic("t", 0, -1.0, "x")]).contains("time -1 s"));
        assert!(
            refusal(vec![topic("t", 1, 0.0, "x"), topic("t.1", 0, 0.0, "x")])
                .contains("`t.1` is there twice")
        );
        assert!(refusal(vec![topic("t", 0, 0.0, "timestamp")]).contains("two fields `timestamp`"));
    }
}
