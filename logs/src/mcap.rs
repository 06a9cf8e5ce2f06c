//! MCAP with JSON messages (<https://mcap.dev/spec>): what is written opens in Foxglove and PlotJuggler, and is read back.

use crate::error::{output, problem};
use crate::fields::{Field, fields, rows_by_time, twice};
use crate::{Error, Log, Topic};
use ::mcap::records::MessageHeader;
use ::mcap::{McapError, WriteOptions};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::io::{Seek, Write};

mod read;

pub use read::{is_mcap, read};

/// Writes `log` as MCAP, all topics in the order of time.
///
/// Each topic is a channel of its name, a second instance `name.1`. A message is a JSON object of `timestamp` \[s\] and the
/// columns; neighbouring columns `q[0]`, `q[1]`, … are one array. The channel's JSON Schema describes each field by its
/// unit, and the channel's metadata holds field → unit. NaN and infinities, which JSON has not, are `null`.
///
/// # Errors
/// [`Error::Write`]: a time before 0, or beyond what 64 bits of nanoseconds hold (584 years); two channels of one name; two
/// columns whose names become one.
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
    for timed in rows_by_time(&log.topics, 1e9)? {
        let (channel_id, fields, sequence) = &mut channels[timed.topic];
        let mut message = Map::new();
        message.insert("timestamp".into(), json!(timed.time));
        for field in fields {
            let mut values = field.columns.iter().map(|c| json!(c.values[timed.row]));
            let value = if field.array {
                values.collect()
            } else {
                values.next().unwrap_or(Value::Null)
            };
            message.insert(field.name.clone(), value);
        }
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: *sequence,
            log_time: timed.ticks,
            publish_time: timed.ticks,
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

/// The topic and the instance of a channel of that name.
fn named(channel: &str) -> (&str, u8) {
    // As ROS has it.
    let channel = channel.strip_prefix('/').unwrap_or(channel);
    let split = channel.rsplit_once('.');
    let instance = split.and_then(|(name, instance)| Some((name, instance.parse().ok()?)));
    instance.unwrap_or((channel, 0))
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

    /// Two topics, of which one is a first instance, and a number that JSON does not have.
    pub(super) fn log() -> Log {
        let q = |i: usize| Column::new(&format!("q[{i}]"), "rad", vec![1.0 / 3.0, i as f64]);
        let x = Column::new("x", "m/s", vec![-1e-7, f64::NAN]);
        let topics = vec![
            Topic::new("attitude", 0, vec![0.25, 1.5], vec![q(0), q(1)]).unwrap(),
            Topic::new("wind", 1, vec![0.1, 2.0], vec![x]).unwrap(),
        ];
        Log {
            topics,
            notes: Vec::new(),
        }
    }

    #[test]
    fn messages_carry_every_number_and_channels_their_units() {
        let mut out = Cursor::new(Vec::new());
        write(&log(), &mut out).unwrap();
        let messages: Vec<_> = ::mcap::MessageStream::new(out.get_ref())
            .unwrap()
            .collect::<Result<_, _>>()
            .unwrap();
        let read: Vec<(String, u64, Value)> = messages
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
            (
                "wind.1",
                100_000_000,
                json!({ "timestamp": 0.1, "x": -1e-7 }),
            ),
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
        assert_eq!(read, expected);
        let channel = &messages[0].channel;
        assert_eq!(channel.metadata["x"], "m/s");
        let schema: Value = serde_json::from_slice(&channel.schema.as_ref().unwrap().data).unwrap();
        assert_eq!(schema["properties"]["x"]["description"], "m/s");
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
            refusal(vec![topic("t", 0, u64::MAX as f64 / 1e9, "x")])
                .contains("time 18446744073.709553 s")
        );
        assert!(
            refusal(vec![topic("t", 1, 0.0, "x"), topic("t.1", 0, 0.0, "x")])
                .contains("`t.1` is there twice")
        );
        assert!(refusal(vec![topic("t", 0, 0.0, "timestamp")]).contains("two fields `timestamp`"));
    }
}
