//! A controller run open loop over logged states, row by row.

use std::io::{Read, Write};

use alula::{FeedForward, Inertial, Reference};
use anyhow::anyhow;

use crate::flight::{Controller, Input};
use crate::trace::{FEED_FORWARD, INPUTS, OUTPUTS, outputs};

/// Runs `controller` over the log `from` and writes its commands `to`, holding one row at a time.
/// `origin` stands for the log in errors, which name line and column. The feed-forward columns are
/// read if `feed_forward`, and then they must be there; all others are ignored.
///
/// A value that is not finite is a flight log's reality and yields a fault's status; a cell that is
/// not a number is an error.
pub fn replay(
    origin: &str,
    from: impl Read,
    to: impl Write,
    controller: &mut dyn Controller,
    feed_forward: bool,
) -> anyhow::Result<()> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(from);
    let at = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        match error.kind() {
            csv::ErrorKind::UnequalLengths {
                expected_len, len, ..
            } => anyhow!("{origin}:{line}: {len} cells under {expected_len} columns"),
            csv::ErrorKind::Utf8 { .. } => anyhow!("{origin}:{line}: not UTF-8"),
            _ => anyhow!(error).context(format!("{origin}:{line}")),
        }
    };
    let header = reader.headers().map_err(at)?.clone();
    let column = |name: &'static str| {
        let found = header.iter().position(|cell| cell == name);
        let index = found.ok_or_else(|| anyhow!("{origin}:1: no column {name}"))?;
        Ok((name, index))
    };
    let columns = INPUTS
        .iter()
        .chain(FEED_FORWARD.iter().filter(|_| feed_forward))
        .map(|&name| column(name))
        .collect::<anyhow::Result<Vec<_>>>()?;

    let mut writer = csv::Writer::from_writer(to);
    writer.write_record(std::iter::once("t_s").chain(OUTPUTS))?;
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(at)? {
        let line = record.position().map_or(0, csv::Position::line);
        let mut values = [0.0_f32; INPUTS.len() + FEED_FORWARD.len()];
        for (value, &(name, index)) in values.iter_mut().zip(&columns) {
            let cell = record.get(index).unwrap_or_default();
            *value = cell
                .parse()
                .map_err(|_| anyhow!("{origin}:{line}: {name}: {cell:?} is not a number"))?;
        }
        let v = |from: usize| Inertial::new(values[from], values[from + 1]);
        let reference = Reference {
            velocity: v(6),
            acceleration: v(8),
        };
        let forward = feed_forward.then(|| FeedForward {
            air_acceleration: v(10),
            jerk: v(12),
        });
        let answer = controller.answer(&Input::new(values[3], v(1), v(4), reference, forward))?;
        let time = record.get(columns[0].1).unwrap_or_default();
        writer.write_field(time)?;
        writer.write_record(outputs(&answer))?;
    }
    writer.flush()?;
    Ok(())
}
