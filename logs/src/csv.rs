//! Comma-separated values: one table per file.
//!
//! Without a [`Map`] the first column is the time \[s\] and every other column is read under its own name; a header cell
//! `name [unit]` names the unit. With a map, only what the map names is read. An empty cell is NaN.

mod map;

pub use map::{Map, Source};

use crate::error::output;
use crate::{Column, Error, Log, Topic};
use std::io::Write;

/// Reads the text `bytes` of the file called `file` in errors.
///
/// # Errors
/// [`Error::Csv`], with file, line and column: not UTF-8; separated by semicolons; a column twice or not there; a row of
/// another width; a cell that is no number; no rows; a time that is empty, not finite or runs backwards.
/// [`Error::Map`]: the map names no columns, or a factor is zero or not finite.
pub fn read(file: &str, bytes: &[u8], map: Option<&Map>) -> Result<Log, Error> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let read = bytes.get(..e.valid_up_to()).unwrap_or_default();
        let line = 1 + read.iter().filter(|b| **b == b'\n').count() as u64;
        fail(file, line, None, "not UTF-8 text")
    })?;
    let mut reader = ::csv::ReaderBuilder::new()
        .trim(::csv::Trim::All)
        .from_reader(text.as_bytes());
    let headers = reader.headers().map_err(|e| refused(file, text, &e))?;
    let headers: Vec<String> = headers.iter().map(Into::into).collect();
    check(file, text, &headers)?;

    let (topic, time_source, wanted) = match map {
        Some(map) => {
            let problem = |problem| Error::Map {
                file: file.into(),
                line: None,
                problem,
            };
            map.check().map_err(problem)?;
            let columns = map.columns.clone().into_iter().collect();
            (map.topic.as_str(), map.time.clone(), columns)
        }
        None => {
            let (time, columns) = map::identity(&headers);
            ("csv", time, columns)
        }
    };
    let place = |source: &Source| {
        let there = || format!("not in the header, which has `{}`", headers.join("`, `"));
        let place = headers.iter().position(|h| *h == source.from);
        place.ok_or_else(|| fail(file, 1, Some(&source.from), there()))
    };
    let time_place = place(&time_source)?;
    let mut columns = Vec::new();
    for (name, source) in &wanted {
        let column = Column::new(name, &source.unit, Vec::new());
        columns.push((place(source)?, source, column));
    }

    let mut time: Vec<f64> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| refused(file, text, &e))?;
        let fail = |place: usize, problem: String| {
            let line = record.position().map_or(1, |p| line(text, p));
            fail(file, line, headers.get(place).map(String::as_str), problem)
        };
        let number = |place: usize| match record.get(place).unwrap_or_default() {
            "" => Ok(f64::NAN),
            cell => cell
                .parse()
                .map_err(|_| fail(place, format!("`{cell}` is no number"))),
        };
        let t = time_source.apply(number(time_place)?);
        let last = time.last().copied().unwrap_or(f64::NEG_INFINITY);
        if !t.is_finite() {
            return Err(fail(time_place, format!("the time is {t}")));
        }
        if t < last {
            let problem = format!("time runs backwards: {t} s after {last} s");
            return Err(fail(time_place, problem));
        }
        time.push(t);
        for (place, source, column) in &mut columns {
            column.values.push(source.apply(number(*place)?));
        }
    }
    if time.is_empty() {
        return Err(fail(file, 1, None, "no rows below the header"));
    }
    let columns = columns.into_iter().map(|(_, _, column)| column).collect();
    let topics = vec![Topic::new(topic, 0, time, columns)?];
    Ok(Log {
        topics,
        notes: Vec::new(),
    })
}

/// Refuses a header that names no table.
fn check(file: &str, text: &str, headers: &[String]) -> Result<(), Error> {
    let first = text.lines().next().unwrap_or_default();
    let (semicolons, commas) = (first.matches(';').count(), first.matches(',').count());
    if semicolons > 0 && semicolons >= commas {
        let problem = "separated by semicolons; commas are read, with a point in numbers";
        return Err(fail(file, 1, None, problem));
    }
    if let Some(name) = crate::fields::twice(headers.iter().map(String::as_str)) {
        let problem = "the header names this column twice";
        return Err(fail(file, 1, Some(name), problem));
    }
    if headers.len() < 2 {
        let problem = "the header names fewer than two columns";
        return Err(fail(file, 1, None, problem));
    }
    Ok(())
}

fn fail(file: &str, line: u64, column: Option<&str>, problem: impl Into<String>) -> Error {
    let (file, column, problem) = (file.into(), column.map(Into::into), problem.into());
    Error::Csv {
        file,
        line,
        column,
        problem,
    }
}

/// What the reader of records refused, in our words.
fn refused(file: &str, text: &str, error: &::csv::Error) -> Error {
    let line = error.position().map_or(1, |p| line(text, p));
    let problem = match error.kind() {
        ::csv::ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => {
            format!("{len} cells, where the header has {expected_len}")
        }
        _ => error.to_string(),
    };
    fail(file, line, None, problem)
}

/// The line of a record, counted from 1. The reader counts the empty lines before a record to it.
fn line(text: &str, position: &::csv::Position) -> u64 {
    let from = usize::try_from(position.byte()).unwrap_or(usize::MAX);
    let rest = text.as_bytes().get(from..).unwrap_or_default();
    let empty = rest
        .iter()
        .take_while(|b| b"\r\n".contains(b))
        .filter(|b| **b == b'\n');
    position.line() + empty.count() as u64
}

/// Writes `topic`: a header `time [s],name [unit],…`, then its rows in the shortest decimals that read back as the same
/// numbers. NaN is an empty cell.
///
/// # Errors
/// `out` refuses.
pub fn write(topic: &Topic, out: impl Write) -> Result<(), Error> {
    let mut writer = ::csv::Writer::from_writer(out);
    let failed = |e: ::csv::Error| output(std::io::Error::other(e));
    let header = |c: &Column| match c.unit.as_str() {
        "" => c.name.clone(),
        unit => format!("{} [{unit}]", c.name),
    };
    writer.write_field("time [s]").map_err(failed)?;
    writer
        .write_record(topic.columns().iter().map(header))
        .map_err(failed)?;
    for (row, time) in topic.time().iter().enumerate() {
        writer.write_field(time.to_string()).map_err(failed)?;
        let cell = |c: &Column| {
            if c.values[row].is_nan() {
                String::new()
            } else {
                c.values[row].to_string()
            }
        };
        writer
            .write_record(topic.columns().iter().map(cell))
            .map_err(failed)?;
    }
    writer.flush().map_err(output)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        read("f.csv", text.as_bytes(), None)
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn refusals_name_file_line_and_column() {
        let cases = [
            ("t;x\n0;1\n", "f.csv: line 1: separated by semicolons"),
            ("t;x, m\n0;1\n", "f.csv: line 1: separated by semicolons"),
            (
                "t,x,x\n0,1,2\n",
                "f.csv: line 1, column `x`: the header names this column twice",
            ),
            ("t,x\n", "f.csv: line 1: no rows"),
            ("", "f.csv: line 1: the header names fewer than two columns"),
            (
                "t,x\n0,1\n,2\n",
                "f.csv: line 3, column `t`: the time is NaN",
            ),
            (
                "t,x\n0,1\ninf,2\n",
                "f.csv: line 3, column `t`: the time is inf",
            ),
            (
                "t,x\n1,1\n\n0.5,2\n",
                "f.csv: line 4, column `t`: time runs backwards: 0.5 s after 1 s",
            ),
            (
                "t,x\n0,1\n1,up\n",
                "f.csv: line 3, column `x`: `up` is no number",
            ),
            (
                "t,x\n0,1\n1\n",
                "f.csv: line 3: 1 cells, where the header has 2",
            ),
        ];
        // A quoted cell may hold lines; the refusal is of one.
        let message = refusal("t,\"x\ny\"\n0,\"1\n2\"\n");
        assert_eq!(
            message,
            r"f.csv: line 3, column `x\ny`: `1\n2` is no number"
        );
        for (text, expected) in cases {
            let message = refusal(text);
            assert!(message.starts_with(expected), "{message}\nfor {text:?}");
        }
        let message = read("f.csv", b"t,x\n0,\xff\n", None)
            .unwrap_err()
            .to_string();
        assert_eq!(message, "f.csv: line 2: not UTF-8 text");
    }

    #[test]
    fn a_map_renames_scales_and_leaves_out() {
        let map = "topic = 'flight'\n\
                   time = { from = 'ms', scale = 1e-3 }\n\
                   [columns]\n\
                   speed = { from = 'kmh', scale = 0.25, offset = 1.0, unit = 'm/s' }\n";
        let map = Map::parse("m.toml", map).unwrap();
        let text = "note,kmh,ms\nstart,8,500\n,,1500\n";
        let log = read("f.csv", text.as_bytes(), Some(&map)).unwrap();
        let topic = log.topic("flight").unwrap();
        assert_eq!(topic.time(), [0.5, 1.5]);
        assert_eq!(topic.columns().len(), 1);
        let speed = log.column("flight", "speed").unwrap();
        assert_eq!((speed.unit.as_str(), speed.values[0]), ("m/s", 3.0));
        assert!(speed.values[1].is_nan());

        let missing = read("f.csv", b"ms,v\n0,1\n", Some(&map))
            .unwrap_err()
            .to_string();
        assert_eq!(
            missing,
            "f.csv: line 1, column `kmh`: not in the header, which has `ms`, `v`"
        );
    }

    #[test]
    fn what_is_written_reads_back_as_the_same_numbers() {
        let x = Column::new("x", "m/s", vec![1.0 / 3.0, -1e-300, f64::MAX]);
        let y = Column::new("y", "", vec![0.1, f64::NAN, f64::NEG_INFINITY]);
        let topic = Topic::new("csv", 0, vec![-1.0, 0.1, 0.1], vec![x, y]).unwrap();
        let mut text = Vec::new();
        write(&topic, &mut text).unwrap();
        let log = read("f.csv", &text, None).unwrap();
        // NaN is not equal to itself, so the two tables are compared as text.
        assert_eq!(format!("{:?}", log.topics), format!("{:?}", [topic]));
    }
}
