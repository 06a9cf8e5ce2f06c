//! The rows of a trace, or of any CSV that has its columns, by their names.

use std::io::Read;

use alula::GuidanceInput;
use alula::guidance::Air;
use alula::ned::{Frd, Ned};
use alula::spatial::{FeedForward, Heading, Reference};
use anyhow::{anyhow, bail};
use csv::StringRecord;
use nalgebra::Quaternion;

use super::unknown::Unknown;
use super::{Logged, OpenLoop};
use crate::columns::expect_todays;
use crate::controllers::Input;
use crate::experiment::{Experiment, Target, V3, double, ned, orientation};
use crate::simulate::Record;

/// Columns that a log must have.
pub(super) const REQUIRED: [&str; 17] = [
    "t_s",
    "told_v_north_m_s",
    "told_v_east_m_s",
    "told_v_down_m_s",
    "told_attitude_w",
    "told_attitude_x",
    "told_attitude_y",
    "told_attitude_z",
    "told_wind_north_m_s",
    "told_wind_east_m_s",
    "told_wind_down_m_s",
    "told_vr_north_m_s",
    "told_vr_east_m_s",
    "told_vr_down_m_s",
    "told_ar_north_m_s2",
    "told_ar_east_m_s2",
    "told_ar_down_m_s2",
];

/// A column that it must have if the controller is flown with feed-forward.
const FEED_FORWARD: &str = "told_aa_north_m_s2";

/// Names of the axes of the world.
const AXES: [&str; 3] = ["north", "east", "down"];

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
        expect_todays(&self.header).map_err(|error| anyhow!("{origin}:1: {error}"))?;
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
    fn number(&self, record: &StringRecord, name: &str) -> anyhow::Result<Option<f64>> {
        let Some(cell) = self.text(record, name) else {
            return Ok(None);
        };
        let line = record.position().map_or(0, csv::Position::line);
        let parsed = cell.parse().map(Some);
        parsed.map_err(|_| anyhow!("{}:{line}: {name}: {cell:?} is not a number", self.origin))
    }

    /// The numbers under the names that begin with `begin` and end with `end`; one that is not there is NaN.
    fn numbers<const N: usize>(
        &self,
        record: &StringRecord,
        begin: &str,
        middle: [&str; N],
        end: &str,
    ) -> anyhow::Result<[f64; N]> {
        let mut numbers = [f64::NAN; N];
        for (number, middle) in numbers.iter_mut().zip(middle) {
            let name = format!("{begin}_{middle}{end}");
            *number = self.number(record, &name)?.unwrap_or(f64::NAN);
        }
        Ok(numbers)
    }

    /// The vector, north-east-down, under the names that begin with `told_` and `begin`.
    fn vector(&self, record: &StringRecord, begin: &str, unit: &str) -> anyhow::Result<V3> {
        let begin = format!("told_{begin}");
        let axes = ["north", "east", "down"];
        Ok(self.numbers(record, &begin, axes, unit)?.into())
    }

    /// What a row tells. What controllers are told besides the bare laws' inputs need not be there: without it the air is known by its wind,
    /// the position is not known, and nothing is old.
    fn input(&self, record: &StringRecord, feed_forward: bool) -> anyhow::Result<Input> {
        let age = |name| Ok::<f64, anyhow::Error>(self.number(record, name)?.unwrap_or(0.0));
        let velocity = |begin| self.vector(record, begin, "_m_s").map(ned);
        let acceleration = |begin| self.vector(record, begin, "_m_s2").map(ned);
        let [w, x, y, z] = self.numbers(record, "told_attitude", ["w", "x", "y", "z"], "")?;
        let force = ["forward", "right", "down"];
        let [forward, right, down] = self.numbers(record, "told_f", force, "_m_s2")?;
        let known_position = self.place("told_x_error_north_m").is_some();
        let position_error = ned(self.vector(record, "x_error", "_m")?);
        Ok(Input {
            sample: GuidanceInput::default().velocity(velocity("v")?).orientation(orientation(&Quaternion::new(w, x, y, z))).state_age(age("state_age_s")? as f32).air(match self.text(record, "told_air") {
                    Some("velocity") => Air::Velocity(velocity("va")?),
                    Some("unknown") => Air::Unknown,
                    Some("pitot") => Air::Pitot {
                        airspeed: self
                            .number(record, "told_airspeed_m_s")?
                            .map_or(f32::NAN, |v| v as f32),
                        wind: velocity("wind")?,
                    },
                    Some("wind" | "") | None => Air::Wind(velocity("wind")?),
                    Some(other) => bail!(
                        "{}:{}: told_air: {other:?} is neither velocity nor wind nor pitot nor unknown",
                        self.origin,
                        record.position().map_or(0, csv::Position::line)
                    ),
                }).specific_force((self.place("told_f_forward_m_s2").is_some() && !forward.is_nan())
                    .then(|| Frd::new(forward as f32, right as f32, down as f32))).position_error(known_position.then_some(position_error)).reference(Reference {
                    velocity: velocity("vr")?,
                    acceleration: acceleration("ar")?,
                    heading: match self.number(record, "heading_rad")? {
                        Some(heading) => Heading::from_angle(heading as f32),
                        None => Heading::FREE,
                    },
                }).reference_age(age("reference_age_s")? as f32),
            feed_forward: match feed_forward {
                true => Some(FeedForward {
                    air_acceleration: acceleration("aa")?,
                    // The reference is piecewise linear.
                    jerk: Ned::default(),
                }),
                false => None,
            },
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

/// Runs the controller of `experiment` over the log `from`: each step, and what had to be assumed. `origin` stands for the log in errors, which name line and column.
/// Columns are found by name; what is not known is ignored.
pub fn replay(
    origin: &str,
    from: impl Read,
    experiment: &Experiment,
) -> anyhow::Result<(Record, Vec<String>)> {
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
    let forward = feed_forward.then_some(&FEED_FORWARD);
    for name in REQUIRED.iter().chain(forward) {
        log.place(name)
            .ok_or_else(|| anyhow!("{origin}:1: no column {name}"))?;
    }

    let mut open_loop = OpenLoop::new(experiment)?;
    let mut last_time = None;
    let mut rows = 0;
    let mut unknown = ["velocity", "attitude", "reference velocity"].map(Unknown::of);
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(at)? {
        let input = log.input(&record, feed_forward)?;
        let t = log.time(&record, last_time)?;
        last_time = Some(t);
        rows += 1;
        let [velocity, attitude, wanted] = &mut unknown;
        let told = |v: Ned| [v.north, v.east, v.down].map(f64::from);
        velocity.count(t, AXES, told(input.sample.velocity));
        attitude.count(t, ["q"], [f64::from(input.sample.orientation.down().down)]);
        wanted.count(t, AXES, told(input.sample.reference.velocity));
        let reference = &input.sample.reference;
        let logged = Logged {
            position: V3::repeat(f64::NAN),
            wind: double(input.wind()),
            load_factor: f64::NAN,
            target: Target {
                position: V3::repeat(f64::NAN),
                velocity: double(reference.velocity),
                acceleration: double(reference.acceleration),
                heading: None,
            },
        };
        open_loop.row(t, input, logged)?;
    }
    if last_time.is_none() {
        bail!("{origin}: no rows under the header");
    }
    let said = unknown.iter().filter_map(|unknown| unknown.note(rows));
    Ok((open_loop.record, said.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::column;

    #[test]
    fn every_column_read_is_declared() {
        let optional = [
            "told_air",
            "told_va_down_m_s",
            "told_f_down_m_s2",
            "told_x_error_down_m",
            "heading_rad",
            "state_age_s",
            "reference_age_s",
            FEED_FORWARD,
        ];
        for name in [&REQUIRED[..], &optional].concat() {
            assert!(column(name).is_some(), "{name} is no column");
        }
    }
}
