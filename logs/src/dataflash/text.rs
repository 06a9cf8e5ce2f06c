//! The text form.

use super::format::{Field, Format};
use super::tables::{Message, Tables};

/// How much of a file is searched for the first format.
const SEARCHED: usize = 8000;

pub(super) fn begins(bytes: &[u8]) -> bool {
    let begin = bytes.get(..SEARCHED).unwrap_or(bytes);
    begin
        .split(|&b| b == b'\n')
        .any(|line| line.starts_with(b"FMT,"))
}

/// The cells of a line after the name.
struct Line<'a>(Vec<&'a str>);

impl Message for Line<'_> {
    fn number(&self, place: usize, field: &Field, element: usize) -> f64 {
        // Arrays are printed in forms that differ from program to program.
        let cell = self
            .0
            .get(place)
            .filter(|_| element == 0 && field.kind != b'a');
        cell.and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN)
    }

    fn text(&self, place: usize, _: &Field) -> String {
        self.0.get(place).copied().unwrap_or_default().into()
    }
}

/// Values in text are scaled already as their letters imply (`c` is printed in the unit, not in hundredths).
pub(super) fn read(bytes: &[u8]) -> Tables {
    let mut tables = Tables::default();
    let mut passed_over = 0;
    for line in bytes.split(|&b| b == b'\n') {
        let line = String::from_utf8_lossy(line);
        if !line.trim().is_empty() && one(&line, &mut tables).is_none() {
            passed_over += 1;
        }
    }
    if passed_over > 0 {
        tables.notes.push(format!(
            "{passed_over} lines passed over that are no message"
        ));
    }
    tables
}

fn one(line: &str, tables: &mut Tables) -> Option<()> {
    let mut cells = line.split(',').map(str::trim);
    let name = cells.next()?;
    if name == "FMT" {
        // type, length, name, format, then the labels
        let mut parts = line.splitn(6, ',').map(str::trim).skip(1);
        let kind = parts.next()?.parse().ok()?;
        let (name, kinds, labels) = (
            parts.nth(1)?,
            parts.next()?,
            parts.next().unwrap_or_default(),
        );
        tables.define(kind, Format::new(name, kinds, labels));
        return Some(());
    }
    let kind = tables.kind(name)?;
    let fields = &tables.format(kind)?.fields;
    let cells: Vec<&str> = cells.collect();
    // Text in the last field may hold commas.
    let text_is_last = fields.last().is_some_and(|field| field.numbers() == 0);
    if cells.len() != fields.len() && !(text_is_last && cells.len() > fields.len()) {
        return None;
    }
    let line = Line(cells);
    tables.take(kind, &line);
    Some(())
}

#[cfg(test)]
mod tests {
    use super::super::{is_dataflash, read};

    const LOG: &str = "\n\
        FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n\
        FMT, 2, 76, UNIT, QbZ, TimeUS,Id,Label\n\
        FMT, 4, 44, FMTU, QBNN, TimeUS,FmtType,UnitIds,MultIds\n\
        FMT, 3, 20, MULT, Qbd, TimeUS,Id,Mult\n\
        FMT, 9, 21, ATT, QcMf, TimeUS,Roll,Mode,X\n\
        FMT, 10, 75, MSG, QZ, TimeUS,Message\n\
        UNIT, 0, 100, deg\n\
        MULT, 0, 66, 0.01\n\
        FMTU, 0, 9, sd-m, FB-B\n";

    #[test]
    fn formats_without_a_message_are_refused() {
        let refusal = read("f", LOG.as_bytes()).unwrap_err();
        assert_eq!(refusal.to_string(), "f: byte 0: no row of data");
    }

    #[test]
    fn text_is_read_with_units_and_without_scaling_twice() {
        let text = format!(
            "{LOG}ATT, 1500000, -12.5, AUTO, 250\nMSG, 1, one, two\nATT, 2000000, 3, 10, nan\n"
        );
        assert!(is_dataflash(text.as_bytes()));
        let log = read("f", text.as_bytes()).unwrap();
        assert_eq!(log.notes, Vec::<String>::new());
        let att = log.topic("ATT").unwrap();
        assert_eq!(att.time(), [1.5, 2.0]);
        let roll = att.column("Roll").unwrap();
        assert_eq!(
            (roll.unit.as_str(), roll.values.as_slice()),
            ("deg", &[-12.5, 3.0][..])
        );
        // `f` has no scale of its own, so the multiplier 0.01 applies.
        assert_eq!(att.column("X").unwrap().values[0], 2.5);
        assert!(att.column("Mode").unwrap().values[0].is_nan());
    }

    /// Logs of before 2015 have milliseconds since boot in `TimeMS`, but for `GPS`, where that is the receiver's time of the week.
    #[test]
    fn the_clock_of_an_old_receiver_is_its_last_column() {
        let text = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n\
            FMT, 1, 17, ATT, Icc, TimeMS,Roll,Pitch\n\
            FMT, 130, 24, GPS, BIHLLeI, Status,TimeMS,Week,Lat,Lng,VZ,T\n\
            ATT, 121000, 1, 2\n\
            GPS, 3, 425610200, 1769, 47.1, 8.2, 0.5, 121040\n\
            GPS, 3, 425610400, 1769, 47.1, 8.2, 0.5, 121240\n";
        let log = read("f", text.as_bytes()).unwrap();
        assert_eq!(log.topic("ATT").unwrap().time(), [121.0]);
        let gps = log.topic("GPS").unwrap();
        assert_eq!(gps.time(), [121.04, 121.24]);
        assert_eq!(gps.column("TimeMS").unwrap().values[0], 425_610_200.0);
        // Later ones have the week under another name, and a clock since boot first.
        let later = text.replace("Status,TimeMS,Week", "Status,TimeMS,GWk");
        let log = read("f", later.as_bytes()).unwrap();
        assert_eq!(log.topic("GPS").unwrap().time()[0], 425_610.2);
    }

    #[test]
    fn lines_that_are_no_message_are_counted() {
        let text = format!("{LOG}ATT, 1, 2\nWHAT, 1\nATT, 1, 2, 3, 4\n");
        let log = read("f", text.as_bytes()).unwrap();
        assert_eq!(log.column("ATT", "Roll").unwrap().values, [2.0]);
        assert_eq!(log.notes, ["2 lines passed over that are no message"]);
    }
}
