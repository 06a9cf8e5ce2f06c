//! The rows of a trace, or of any CSV that has its columns, by their names.

use std::io::{Read, Write};

use alula::guidance::Air;
use alula::{Attitude, Body, FeedForward, Inertial, PlanarGuidanceInput, Reference};
use anyhow::{anyhow, bail};
use csv::StringRecord;

use super::Commands;
use super::unknown::Unknown;
use crate::controllers::Input;
use crate::experiment::Experiment;
use crate::simulate::Step;

/// Columns that a log must have.
const REQUIRED: [&str; 10] = [
    "t_s",
    "v_down_m_s",
    "v_forward_m_s",
    "theta_rad",
    "wind_down_m_s",
    "wind_forward_m_s",
    "vr_down_m_s",
    "vr_forward_m_s",
    "ar_down_m_s2",
    "ar_forward_m_s2",
];

/// Columns that it must have if the controller is flown with feed-forward.
const FEED_FORWARD: [&str; 4] = [
    "aa_down_m_s2",
    "aa_forward_m_s2",
    "jr_down_m_s3",
    "jr_forward_m_s3",
];

/// Where the columns of a log are.
struct Log<'a> {
    origin: &'a str,
    header: StringRecord,
}

impl Log<'_> {
    /// A header that says what each column is, once.
    fn check_header(&self) -> anyhow::Result<()> {
        let origin = self.origin;
        if self.header.iter().all(str::is_empty) {
            bail!("{origin}:1: no header: the first line must name the columns");
        }
        for (mark, name) in [(';', "semicolons"), ('\t', "tabulators")] {
            if self.header.len() == 1 && self.header[0].contains(mark) {
                bail!("{origin}:1: the cells are separated by {name}; they must be by commas");
            }
        }
        for (i, name) in self.header.iter().enumerate() {
            if self.header.iter().take(i).any(|earlier| earlier == name) {
                bail!("{origin}:1: two columns {name}");
            }
        }
        Ok(())
    }

    /// The time of a row \[s\], after that of the `last`. It may stand still, as where a log repeats a row, but not run backwards.
    fn time(&self, record: &StringRecord, last: Option<f64>) -> anyhow::Result<f64> {
        self.number(record, "t_s")?;
        let cell = self.text(record, "t_s").unwrap_or_default();
        let t: f64 = cell.parse().unwrap_or(f64::NAN);
        let problem = match last {
            _ if !t.is_finite() => "is not a finite time".to_owned(),
            Some(last) if t < last => format!("comes after {last}: time must not run backwards"),
            _ => return Ok(t),
        };
        let line = record.position().map_or(0, csv::Position::line);
        bail!("{}:{line}: t_s: {cell} {problem}", self.origin)
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|cell| cell == name)
    }

    /// The cell under `name`.
    fn text<'r>(&self, record: &'r StringRecord, name: &str) -> Option<&'r str> {
        record.get(self.place(name)?)
    }

    /// The number under `name`. A value that is not finite is a log's reality; a cell that is not a number is an error.
    fn number(&self, record: &StringRecord, name: &str) -> anyhow::Result<Option<f32>> {
        let Some(cell) = self.text(record, name) else {
            return Ok(None);
        };
        let line = record.position().map_or(0, csv::Position::line);
        let parsed = cell.parse().map(Some);
        parsed.map_err(|_| anyhow!("{}:{line}: {name}: {cell:?} is not a number", self.origin))
    }

    /// The vector under both names; a component that is not there is NaN.
    fn vector(&self, record: &StringRecord, names: [&str; 2]) -> anyhow::Result<Inertial> {
        let [down, forward] = names.map(|name| self.number(record, name));
        let or_nan = |value: Option<f32>| value.unwrap_or(f32::NAN);
        Ok(Inertial::new(or_nan(down?), or_nan(forward?)))
    }

    /// What a row tells. Controllers that are told more than the bare laws have columns of their own, which need not be there: without
    /// them the air is known by its wind, the position is not known, and nothing is old.
    fn input(&self, record: &StringRecord, feed_forward: bool) -> anyhow::Result<Input> {
        let number = |name| Ok::<f32, anyhow::Error>(self.number(record, name)?.unwrap_or(0.0));
        let number_or_none = |name| self.number(record, name);
        let theta = number("theta_rad")?;
        let wind = self.vector(record, ["wind_down_m_s", "wind_forward_m_s"])?;
        let known_position = self.place("xe_down_m").is_some();
        let position_error = self.vector(record, ["xe_down_m", "xe_forward_m"])?;
        let forward = FeedForward {
            air_acceleration: self.vector(record, ["aa_down_m_s2", "aa_forward_m_s2"])?,
            jerk: self.vector(record, ["jr_down_m_s3", "jr_forward_m_s3"])?,
        };
        Ok(Input {
            theta,
            sample: PlanarGuidanceInput {
                velocity: self.vector(record, ["v_down_m_s", "v_forward_m_s"])?,
                attitude: Attitude::from_angle(theta),
                state_age: number("state_age_s")?,
                air: match self.text(record, "air_told") {
                    Some("velocity") => {
                        Air::Velocity(self.vector(record, ["va_down_m_s", "va_forward_m_s"])?)
                    }
                    Some("unknown") => Air::Unknown,
                    Some("wind" | "") | None => Air::Wind(wind),
                    Some(other) => bail!(
                        "{}:{}: air_told: {other:?} is neither velocity nor wind nor unknown",
                        self.origin,
                        record.position().map_or(0, csv::Position::line)
                    ),
                },
                specific_force: match (number_or_none("f_i_m_s2")?, number_or_none("f_j_m_s2")?) {
                    (Some(i), Some(j)) => Some(Body::new(i, j)),
                    _ => None,
                },
                position_error: known_position.then_some(position_error),
                reference: Reference {
                    velocity: self.vector(record, ["vr_down_m_s", "vr_forward_m_s"])?,
                    acceleration: self.vector(record, ["ar_down_m_s2", "ar_forward_m_s2"])?,
                },
                reference_age: number("reference_age_s")?,
                ..PlanarGuidanceInput::default()
            },
            feed_forward: feed_forward.then_some(forward),
        })
    }
}

/// The times of a log \[s\], as far as it has any; what is wrong with it [`replay`] says.
pub(super) fn times(from: impl Read) -> Vec<f64> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(from);
    let header = reader.headers().cloned().unwrap_or_default();
    let Some(place) = header.iter().position(|name| name == "t_s") else {
        return Vec::new();
    };
    let time = |record: csv::Result<StringRecord>| record.ok()?.get(place)?.parse().ok();
    reader.records().map_while(time).collect()
}

/// Runs the controller of `experiment` over the log `from` and writes its commands `to`, holding one row at a time; `visit` is given every
/// step. `origin` stands for the log in errors, which name line and column. Columns are found by name; what is not known is ignored. What had to be
/// assumed is said in the words returned.
pub fn replay(
    origin: &str,
    from: impl Read,
    to: impl Write,
    experiment: &Experiment,
    mut visit: impl FnMut(Step),
) -> anyhow::Result<Vec<String>> {
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
    let log = Log { origin, header };
    log.check_header()?;
    let feed_forward = experiment.spec()?.feed_forward();
    let forward = FEED_FORWARD.iter().filter(|_| feed_forward);
    for name in REQUIRED.iter().chain(forward) {
        log.place(name)
            .ok_or_else(|| anyhow!("{origin}:1: no column {name}"))?;
    }

    let mut commands = Commands::new(experiment, to)?;
    let mut last_time = None;
    let mut rows = 0;
    let mut unknown = ["velocity", "attitude", "reference velocity"].map(Unknown::of);
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(at)? {
        let input = log.input(&record, feed_forward)?;
        let time = log.text(&record, "t_s").unwrap_or_default();
        let t = log.time(&record, last_time)?;
        last_time = Some(t);
        rows += 1;
        let axes = |v: Inertial| [v.down(), v.forward()].map(f64::from);
        let [velocity, attitude, reference] = &mut unknown;
        velocity.count(t, ["down", "forward"], axes(input.sample.velocity));
        attitude.count(t, ["theta"], [f64::from(input.theta)]);
        reference.count(
            t,
            ["down", "forward"],
            axes(input.sample.reference.velocity),
        );
        visit(commands.row(time, t, input)?);
    }
    if last_time.is_none() {
        bail!("{origin}: no rows under the header");
    }
    commands.end()?;
    Ok(unknown
        .iter()
        .filter_map(|unknown| unknown.note(rows))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::column;

    #[test]
    fn every_column_read_is_declared() {
        let optional = [
            "air_told",
            "va_down_m_s",
            "xe_down_m",
            "state_age_s",
            "reference_age_s",
        ];
        for name in [&REQUIRED[..], &FEED_FORWARD, &optional].concat() {
            assert!(column(name).is_some(), "{name} is no column");
        }
    }
}
