//! The binary form.

use super::format::{Field, Format};
use super::tables::{FMT, Message, Tables};

/// What each message begins with.
const HEADER: [u8; 2] = [0xa3, 0x95];

pub(super) fn begins(bytes: &[u8]) -> bool {
    bytes.starts_with(&HEADER)
}

struct Binary<'a>(&'a [u8]);

impl Message for Binary<'_> {
    fn number(&self, _: usize, field: &Field, element: usize) -> f64 {
        field.number(self.0, element).unwrap_or(f64::NAN)
    }

    fn text(&self, _: usize, field: &Field) -> String {
        field.text(self.0).unwrap_or_default()
    }
}

pub(super) fn read(bytes: &[u8]) -> Tables {
    let mut tables = Tables::default();
    let mut passed_over = 0;
    let mut at = 0;
    while let Some(rest) = bytes.get(at..).filter(|rest| !rest.is_empty()) {
        match one(rest, &mut tables) {
            Some(length) => at += length,
            None => {
                passed_over += 1;
                at += 1;
            }
        }
    }
    if passed_over > 0 {
        tables.notes.push(format!(
            "{passed_over} bytes passed over that belong to no message"
        ));
    }
    tables
}

/// Takes the message that `bytes` begin with, and says how long it is. None if they begin with none.
fn one(bytes: &[u8], tables: &mut Tables) -> Option<usize> {
    let &[a, b, kind, ref rest @ ..] = bytes else {
        return None;
    };
    if [a, b] != HEADER {
        return None;
    }
    if kind == FMT {
        // type, length, name[4], format[16], labels[64]
        let message = rest.get(..86)?;
        let text = |from: usize, to: usize| {
            let field = message.get(from..to)?.split(|&b| b == 0).next()?;
            std::str::from_utf8(field).ok().map(str::trim)
        };
        let format = Format::new(text(2, 6)?, text(6, 22)?, text(22, 86)?);
        let (kind, length) = (message[0], usize::from(message[1]));
        let agrees = |format: Format| match format.size + HEADER.len() + 1 == length {
            true => Ok(format),
            false => Err(format!(
                "{}: {length} bytes stated, {} in the fields",
                format.name,
                format.size + 3
            )),
        };
        tables.define(kind, format.and_then(agrees));
        return Some(89);
    }
    let size = tables.format(kind)?.size;
    tables.take(kind, &Binary(rest.get(..size)?));
    Some(size + 3)
}

#[cfg(test)]
mod tests {
    use super::super::read;

    fn text<const N: usize>(text: &str) -> [u8; N] {
        let mut bytes = [0; N];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        bytes
    }

    fn format(kind: u8, length: u8, name: &str, kinds: &str, labels: &str) -> Vec<u8> {
        let head = [0xa3, 0x95, 128, kind, length];
        [
            &head[..],
            &text::<4>(name),
            &text::<16>(kinds),
            &text::<64>(labels),
        ]
        .concat()
    }

    fn sample(kind: u8, time: u64, instance: u8, raw: i16) -> Vec<u8> {
        let head = [0xa3, 0x95, kind];
        [
            &head[..],
            &time.to_le_bytes(),
            &[instance],
            &raw.to_le_bytes(),
        ]
        .concat()
    }

    fn log() -> Vec<u8> {
        let unit = |id: u8, label: &str| {
            [&[0xa3, 0x95, 2][..], &[0; 8], &[id], &text::<64>(label)].concat()
        };
        let multiplier = |id: u8, value: f64| {
            [&[0xa3, 0x95, 3][..], &[0; 8], &[id], &value.to_le_bytes()].concat()
        };
        let assigned = [
            &[0xa3, 0x95, 4][..],
            &[0; 8],
            &[9],
            &text::<16>("s#n"),
            &text::<16>("F-B"),
        ]
        .concat();
        [
            format(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"),
            format(2, 76, "UNIT", "QbZ", "TimeUS,Id,Label"),
            format(3, 20, "MULT", "Qbd", "TimeUS,Id,Mult"),
            format(4, 44, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds"),
            format(9, 14, "TST", "QBh", "TimeUS,I,V"),
            unit(b'n', "m/s"),
            unit(b'#', "instance"),
            multiplier(b'B', f64::from(1e-2f32)),
            multiplier(b'-', 0.0),
            assigned,
        ]
        .concat()
    }

    #[test]
    fn units_multipliers_and_instances_are_applied() {
        let samples = [
            sample(9, 1_000_000, 0, 150),
            sample(9, 1_500_000, 1, -7),
            sample(9, 2_000_000, 0, 29),
        ];
        let log = read("f", &[log(), samples.concat()].concat()).unwrap();
        assert_eq!(log.notes, Vec::<String>::new());
        let first = log.instance("TST", 0).unwrap();
        assert_eq!(first.time(), [1.0, 2.0]);
        let v = first.column("V").unwrap();
        assert_eq!(
            (v.unit.as_str(), v.values.as_slice()),
            ("m/s", &[1.5, 0.29][..])
        );
        assert_eq!(
            log.instance("TST", 1).unwrap().column("V").unwrap().values,
            [-0.07]
        );
        assert_eq!(log.topics.len(), 2);
    }

    #[test]
    fn damage_costs_what_is_damaged() {
        let mut bytes = log();
        bytes.extend(sample(9, 1, 0, 1));
        bytes.extend([1, 2, 3, 0xa3, 0x95, 77]);
        bytes.extend(sample(9, 2, 0, 2));
        bytes.extend(format(9, 14, "TST", "QBH", "TimeUS,I,V"));
        bytes.extend(format(10, 99, "BAD", "Q", "TimeUS"));
        bytes.extend(&sample(9, 3, 0, 3)[..13]);
        let log = read("f", &bytes).unwrap();
        assert_eq!(log.column("TST", "V").unwrap().values, [0.01, 0.02]);
        assert_eq!(log.notes.len(), 3, "{:?}", log.notes);
        assert!(
            log.notes[0].contains("TST: a second, different format"),
            "{:?}",
            log.notes
        );
        assert!(
            log.notes[1].contains("BAD: 99 bytes stated, 11"),
            "{:?}",
            log.notes
        );
        assert!(
            log.notes[2].contains("19 bytes passed over"),
            "{:?}",
            log.notes
        );
    }

    #[test]
    fn what_holds_no_message_is_refused() {
        assert!(
            read("f", &[0xa3, 0x95, 1, 2, 3])
                .unwrap_err()
                .to_string()
                .contains("no DataFlash message")
        );
    }
}
