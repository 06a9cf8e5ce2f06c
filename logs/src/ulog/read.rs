//! The reader.

use super::format::{Field, Kind, Layout, Number};
use super::{MAGIC, SYNC, UNITS};
use crate::{Column, Error, Log, Topic};
use std::collections::HashMap;
use std::rc::Rc;

/// Reads the ULog file `bytes`, called `file` in errors.
///
/// Each subscription that has data becomes a topic, each number of it a column named as PX4's own tools name it
/// (`q[0]`, `esc[1].rpm`). Text (`char`), logged strings and parameters are left out. Appended data belongs to
/// the rest. A message that is damaged is left out, and reading goes on where it can.
///
/// # Errors
/// [`Error::Format`]: no ULog header, flags that forbid reading, or no row of data.
pub fn read(file: &str, bytes: &[u8]) -> Result<Log, Error> {
    let fail = |offset, problem: &str| Error::Format {
        file: file.into(),
        offset,
        problem: problem.into(),
    };
    let (Some(header), true) = (bytes.get(..16), super::is_ulog(bytes)) else {
        return Err(fail(0, "not a ULog file"));
    };
    let mut reader = Reader::default();
    if header[MAGIC.len()] > 1 {
        reader.notes.push(format!(
            "version {} of the format; read as version 1",
            header[MAGIC.len()]
        ));
    }

    let mut ends = vec![bytes.len()];
    if let Some(Message {
        kind: b'B',
        payload: flags,
        ..
    }) = message(bytes, 16)
    {
        let incompatible = flags.get(8..16).unwrap_or(&[0; 8]);
        if incompatible[0] & !1 != 0 || incompatible[1..].iter().any(|&b| b != 0) {
            return Err(fail(19, "flags of a later format, which forbid reading"));
        }
        if incompatible[0] & 1 != 0 {
            let offsets = flags.get(16..40).unwrap_or_default().chunks_exact(8);
            let offset = |c: &[u8]| c.try_into().map_or(0, u64::from_le_bytes);
            ends.extend(
                offsets
                    .filter_map(|c| usize::try_from(offset(c)).ok())
                    .filter(|&o| o != 0),
            );
            ends.sort_unstable();
            if ends.last() != Some(&bytes.len()) {
                reader
                    .notes
                    .push("appended data beyond the end of the file".into());
            }
        }
    }
    let mut start = 16;
    for end in ends {
        let end = end.min(bytes.len());
        reader.section(bytes.get(..end).unwrap_or_default(), start);
        start = start.max(end);
    }
    reader.finish().not_empty(file)
}

/// A message as it lies in a file.
struct Message<'a> {
    /// Its type, a letter.
    kind: u8,
    payload: &'a [u8],
    /// Where the next one begins.
    next: usize,
}

/// The message at `at`. None if `bytes` end before.
fn message(bytes: &[u8], at: usize) -> Option<Message<'_>> {
    let header = bytes.get(at..at.checked_add(3)?)?;
    let next = at + 3 + usize::from(u16::from_le_bytes([header[0], header[1]]));
    Some(Message {
        kind: header[2],
        payload: bytes.get(at + 3..next)?,
        next,
    })
}

#[derive(Default)]
struct Reader {
    formats: HashMap<String, Vec<Field>>,
    layouts: HashMap<String, Option<Rc<Layout>>>,
    subscriptions: HashMap<u16, Subscription>,
    /// Subscriptions with data, in the order of their first data.
    order: Vec<u16>,
    /// (topic, column) → unit.
    units: HashMap<(String, String), String>,
    notes: Vec<String>,
    damaged: usize,
}

struct Subscription {
    name: String,
    instance: u8,
    layout: Option<Rc<Layout>>,
    time: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl Reader {
    /// The messages from `at` to the end of `bytes`.
    fn section(&mut self, bytes: &[u8], mut at: usize) {
        while at < bytes.len() {
            // Readers must pass over types that they do not know. What is no letter is no type, but damage, and so may be
            // what ends beyond the file.
            let sound = message(bytes, at).filter(|message| message.kind.is_ascii_uppercase());
            let Some(Message {
                kind,
                payload,
                next,
            }) = sound
            else {
                at = self.resume(bytes, at);
                continue;
            };
            let understood = match kind {
                b'F' => self.format(payload),
                b'M' => self.information(payload),
                b'A' => self.subscribe(payload),
                b'D' => self.data(payload),
                _ => Some(()),
            };
            if understood.is_none() {
                self.damaged += 1;
            }
            at = next;
        }
    }

    /// Where reading goes on after damage at `at`: behind the next synchronisation message, or at the end.
    fn resume(&mut self, bytes: &[u8], at: usize) -> usize {
        let rest = bytes.get(at..).unwrap_or_default();
        let sync = rest.windows(SYNC.len()).position(|window| window == SYNC);
        let to = sync.map_or(bytes.len(), |offset| at + offset + SYNC.len());
        let problem = match sync {
            None if message(bytes, at).is_none() => "the file ends within a message",
            _ => "damaged",
        };
        self.notes.push(format!(
            "byte {at}: {problem}; {} bytes passed over",
            to - at
        ));
        to
    }

    fn format(&mut self, payload: &[u8]) -> Option<()> {
        let (name, fields) = super::format::parse(std::str::from_utf8(payload).ok()?).ok()?;
        self.formats.entry(name).or_insert(fields);
        Some(())
    }

    fn information(&mut self, payload: &[u8]) -> Option<()> {
        let (_, rest) = payload.split_first()?;
        let (&length, rest) = rest.split_first()?;
        let (key, value) = rest.split_at_checked(length.into())?;
        if key.rsplit(|&b| b == b' ').next() == Some(UNITS.as_bytes()) {
            let (column, unit) = std::str::from_utf8(value).ok()?.split_once('=')?;
            let (topic, column) = column.split_once('.')?;
            self.units
                .insert((topic.into(), column.into()), unit.into());
        }
        Some(())
    }

    fn subscribe(&mut self, payload: &[u8]) -> Option<()> {
        let (head, name) = payload.split_at_checked(3)?;
        let name = std::str::from_utf8(name).ok()?;
        if !self.layouts.contains_key(name) {
            let layout = Layout::of(name, &self.formats);
            let layout = layout
                .map_err(|problem| self.notes.push(format!("{name}: {problem}")))
                .ok();
            if layout.as_ref().is_some_and(|layout| layout.time.is_none()) {
                self.notes
                    .push(format!("{name}: no `uint64_t timestamp`; left out"));
            }
            let layout = layout.filter(|layout| layout.time.is_some()).map(Rc::new);
            self.layouts.insert(name.into(), layout);
        }
        let layout = self.layouts.get(name).cloned().flatten();
        let subscription = Subscription {
            name: name.into(),
            instance: head[0],
            layout,
            time: Vec::new(),
            values: Vec::new(),
        };
        // A number must not be given twice; the first stands.
        self.subscriptions
            .entry(u16::from_le_bytes([head[1], head[2]]))
            .or_insert(subscription);
        Some(())
    }

    fn data(&mut self, payload: &[u8]) -> Option<()> {
        let (id, payload) = payload.split_at_checked(2)?;
        let id = u16::from_le_bytes([id[0], id[1]]);
        let subscription = self.subscriptions.get_mut(&id)?;
        // A topic left out was noted when it was subscribed.
        let Some(layout) = &subscription.layout else {
            return Some(());
        };
        if !(layout.least..=layout.most).contains(&payload.len()) {
            return None;
        }
        let microseconds = Kind::Unsigned(8).number(payload.get(layout.time?..)?)?;
        if subscription.time.is_empty() {
            subscription.values = vec![Vec::new(); layout.numbers.len()];
            self.order.push(id);
        }
        subscription.time.push(microseconds / 1e6);
        for (Number { kind, offset, .. }, values) in
            layout.numbers.iter().zip(&mut subscription.values)
        {
            values.push(
                payload
                    .get(*offset..)
                    .and_then(|bytes| kind.number(bytes))
                    .unwrap_or(f64::NAN),
            );
        }
        Some(())
    }

    fn finish(mut self) -> Log {
        if self.damaged > 0 {
            self.notes
                .push(format!("{} damaged messages passed over", self.damaged));
        }
        let mut topics = Vec::new();
        for id in &self.order {
            let Some(Subscription {
                name,
                instance,
                layout: Some(layout),
                time,
                values,
            }) = self.subscriptions.remove(id)
            else {
                continue;
            };
            let column = |(number, values): (&Number, Vec<f64>)| {
                let column = &number.name;
                // The unit of an array is that of its elements.
                let array = column.split('[').next().unwrap_or(column);
                let unit = |column: &str| self.units.get(&(name.clone(), column.to_owned()));
                let unit = unit(column)
                    .or_else(|| unit(array))
                    .map_or("", String::as_str);
                Column::new(column, unit, values)
            };
            let columns = layout.numbers.iter().zip(values).map(column).collect();
            topics.extend(Topic::from_rows(
                &name,
                instance,
                time,
                columns,
                &mut self.notes,
            ));
        }
        Log {
            topics,
            notes: self.notes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(kind: u8, payload: &[u8]) -> Vec<u8> {
        let size = u16::try_from(payload.len()).unwrap().to_le_bytes();
        [&size[..], &[kind], payload].concat()
    }

    fn data(id: u16, time: u64, value: f32) -> Vec<u8> {
        let payload = [
            &id.to_le_bytes()[..],
            &time.to_le_bytes(),
            &value.to_le_bytes(),
        ]
        .concat();
        message(b'D', &payload)
    }

    /// A header, then `flags`, then a format and a subscription of `x` under the number 0.
    fn head(flags: &[u8; 40]) -> Vec<u8> {
        let mut bytes = [&MAGIC[..], &[1; 1], &[0; 8]].concat();
        bytes.extend(message(b'B', flags));
        bytes.extend(message(
            b'F',
            b"x:uint64_t timestamp;float v;uint8_t[4] _padding0;",
        ));
        bytes.extend(message(b'A', &[&[0, 0, 0][..], b"x"].concat()));
        bytes
    }

    fn values(log: &Log) -> Vec<f64> {
        log.column("x", "v").unwrap().values.clone()
    }

    #[test]
    fn damage_is_passed_over_up_to_the_next_sync_message() {
        let mut bytes = head(&[0; 40]);
        bytes.extend(data(0, 1, 1.0));
        // A message of no type, within whose stated length good data lies.
        bytes.extend([200, 0, 0xff]);
        bytes.extend(data(0, 2, 2.0));
        bytes.extend(message(b'S', &SYNC));
        bytes.extend(data(0, 3, 3.0));
        bytes.extend(data(7, 4, 4.0));
        bytes.extend(&data(0, 5, 5.0)[..9]);
        let log = read("f", &bytes).unwrap();
        assert_eq!(values(&log), [1.0, 3.0]);
        assert_eq!(log.notes.len(), 3, "{:?}", log.notes);
        assert!(
            log.notes[0].contains("damaged; 31 bytes"),
            "{:?}",
            log.notes
        );
        assert!(log.notes[1].contains("ends within"), "{:?}", log.notes);
        assert!(
            log.notes[2].contains("1 damaged messages"),
            "{:?}",
            log.notes
        );
    }

    #[test]
    fn appended_data_follows_a_message_that_was_cut() {
        let mut flags = [0; 40];
        let mut bytes = head(&flags);
        bytes.extend(data(0, 1, 1.0));
        bytes.extend(&data(0, 2, 2.0)[..7]);
        flags[8] = 1;
        flags[16..24].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
        bytes[19..59].copy_from_slice(&flags);
        bytes.extend(data(0, 3, 3.0));
        let log = read("f", &bytes).unwrap();
        assert_eq!(values(&log), [1.0, 3.0]);
        assert_eq!(log.topics[0].time(), [1e-6, 3e-6]);

        bytes[27] = 2;
        assert!(
            read("f", &bytes)
                .unwrap_err()
                .to_string()
                .contains("forbid reading")
        );
    }

    #[test]
    fn padding_at_the_end_may_be_there_or_not() {
        let mut bytes = head(&[0; 40]);
        bytes.extend(data(0, 1, 1.0));
        let mut padded = data(0, 2, 2.0);
        padded.extend([0; 4]);
        padded[0] += 4;
        bytes.extend(padded);
        let mut long = data(0, 3, 3.0);
        long.extend([0; 5]);
        long[0] += 5;
        bytes.extend(long);
        let log = read("f", &bytes).unwrap();
        assert_eq!(values(&log), [1.0, 2.0]);
        assert_eq!(log.notes, ["1 damaged messages passed over"]);
    }

    #[test]
    fn other_files_are_refused() {
        for bytes in [&b""[..], b"ULog", b"time,x\n0,1\n0,1\n0,1\n"] {
            assert!(
                read("f", bytes)
                    .unwrap_err()
                    .to_string()
                    .contains("not a ULog file")
            );
        }
        let header = [&MAGIC[..], &[0; 16 - MAGIC.len()]].concat();
        let empty = read("f", &header).unwrap_err();
        assert_eq!(empty.to_string(), "f: byte 0: no row of data");
    }
}
