//! One place where a quantity may be logged.

use super::in_force::Topics;
use super::{CEASED, Missing, Series, attitude};
use crate::{Column, Topic};
use std::fmt;

/// Columns that together are a quantity.
#[derive(Clone, Copy)]
pub(super) struct Source {
    /// (topic, column) of each component. A topic without a name is the first that has the column.
    columns: &'static [(&'static str, &'static str)],
    form: Form,
    /// A column for each in the same topic, that is 0 where it is not valid; logs without them have valid ones alone.
    valid: &'static [&'static str],
    /// Whether it is there if some of the columns are: the others are NaN.
    partly: bool,
}

/// What the columns hold.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// A number.
    Scalar,
    /// North, east, down.
    Vector,
    /// North, east; down is 0.
    Horizontal,
    /// w, x, y, z.
    Quaternion,
    /// Roll, pitch, yaw, in degrees unless their unit is radians.
    Angles,
    /// Speed over ground, course [deg], velocity down.
    Course,
    /// Latitude [deg], longitude [deg], altitude [m]; becomes metres from the first row.
    Geodetic,
}

type Columns = &'static [(&'static str, &'static str)];

impl Source {
    pub(super) const fn scalar(columns: Columns) -> Self {
        Self {
            columns,
            form: Form::Scalar,
            valid: &[],
            partly: false,
        }
    }

    pub(super) const fn vector(columns: Columns) -> Self {
        Self {
            columns,
            form: Form::Vector,
            valid: &[],
            partly: false,
        }
    }

    pub(super) const fn horizontal(columns: Columns) -> Self {
        Self {
            columns,
            form: Form::Horizontal,
            valid: &[],
            partly: false,
        }
    }

    pub(super) const fn quaternion(columns: Columns) -> Self {
        Self {
            columns,
            form: Form::Quaternion,
            valid: &[],
            partly: false,
        }
    }

    pub(super) const fn angles(columns: Columns) -> Self {
        Self {
            columns,
            form: Form::Angles,
            valid: &[],
            partly: false,
        }
    }

    pub(super) const fn course(columns: Columns) -> Self {
        Self {
            columns,
            form: Form::Course,
            valid: &[],
            partly: false,
        }
    }

    pub(super) const fn geodetic(columns: Columns) -> Self {
        Self {
            columns,
            form: Form::Geodetic,
            valid: &[],
            partly: false,
        }
    }

    /// The same, with the columns that say where it is valid.
    pub(super) const fn valid(self, valid: &'static [&'static str]) -> Self {
        Self { valid, ..self }
    }

    /// The same, of which some columns are enough.
    pub(super) const fn partly(self) -> Self {
        Self {
            partly: true,
            ..self
        }
    }

    /// The names of its columns.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        self.columns.iter().map(|(_, column)| *column)
    }

    /// The names of its columns that are of the topic `topic`.
    pub(super) fn names_in(&self, topic: &str) -> impl Iterator<Item = &'static str> {
        let own = move |(of, _): &&(&str, &str)| *of == topic;
        self.columns.iter().filter(own).map(|(_, column)| *column)
    }

    /// The names of its columns that the log has and of those that it has not.
    pub(super) fn parts(&self, topics: &Topics) -> [Vec<&'static str>; 2] {
        [true, false].map(|there| {
            let columns = self.columns.iter();
            let columns = columns.filter(|column| self.column(topics, column).is_some() == there);
            columns.map(|(_, name)| *name).collect()
        })
    }

    /// One of its columns in the log.
    fn column<'a>(
        &self,
        topics: &'a Topics,
        &(topic, column): &(&str, &str),
    ) -> Option<(&'a Topic, &'a Column)> {
        let topic = match topic {
            "" => (topics.log.topics.iter()).find(|t| t.column(column).is_some())?,
            _ => topics.get(topic)?,
        };
        Some((topic, topic.column(column)?))
    }

    /// The columns in the log, if all are there, or some and some are enough.
    pub(super) fn find<'a>(&self, topics: &'a Topics) -> Option<Found<'a>> {
        let columns = self.columns.iter();
        let columns: Vec<_> = columns.map(|column| self.column(topics, column)).collect();
        let present = columns.iter().flatten().count();
        let enough = present == columns.len() || self.partly && present > 0;
        enough.then_some(Found {
            source: *self,
            columns,
        })
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (topic, column)) in self.columns.iter().enumerate() {
            let (blank, point) = (
                if i > 0 { " " } else { "" },
                if topic.is_empty() { "" } else { "." },
            );
            write!(f, "{blank}{topic}{point}{column}")?;
        }
        Ok(())
    }
}

/// A source that a log has.
pub(super) struct Found<'a> {
    source: Source,
    /// None where some are enough and this one is not there.
    columns: Vec<Option<(&'a Topic, &'a Column)>>,
}

/// Roll, pitch and yaw beyond which each is of degrees by itself: a turn in radians, of pitch a quarter, and roundings. Roll and yaw may go on beyond a
/// turn in radians, too, but pitch tells them: what all is in radians is never taken for degrees.
const RADIANS: [f64; 3] = [6.3, 1.58, 6.3];
/// Greatest pitch \[°\] of Euler angles: 90°, and roundings. Roll and yaw may go on beyond a turn.
const MOST_PITCH: f64 = 90.5;

/// What one of this unit is in degrees; none if it is no unit of angles.
fn degrees(unit: &str) -> Option<f64> {
    match unit.trim().to_lowercase().as_str() {
        // The last is ArduPilot's, of a heading.
        "deg" | "degree" | "degrees" | "°" | "degheading" => Some(1.0),
        "rad" | "radian" | "radians" => Some(1_f64.to_degrees()),
        _ => None,
    }
}

/// Metres per degree of latitude, and of longitude at the equator: ArduPilot's own figure (`LOCATION_SCALING_FACTOR` of
/// AP_Math's `location.cpp`: 0.011131884502145034 m per 1e-7°), so that positions come out as it has them.
const METRES_PER_DEGREE: f64 = 111_318.845_021_450_34;

impl Found<'_> {
    /// The times of the first column's topic.
    pub(super) fn base(&self) -> &[f64] {
        let first = self.columns.iter().flatten().next();
        first.map_or(&[], |(topic, _)| topic.time())
    }

    /// What one of each column's unit is in degrees, of angles; 1 where no unit is said.
    fn degrees_each(&self) -> [f64; 3] {
        std::array::from_fn(|i| {
            let column = self.columns.get(i).copied().flatten();
            column
                .and_then(|(_, column)| degrees(&column.unit))
                .unwrap_or(1.0)
        })
    }

    /// What of the columns is not to be read: a unit that is none of theirs, angles whose unit nothing says and that may be of either, a pitch beyond
    /// 90°. None if all is well. `units` are those of its columns.
    pub(super) fn doubt(&self, units: &[&str]) -> Option<String> {
        let columns = || self.columns.iter().flatten().map(|(_, column)| *column);
        let angles = self.source.form == Form::Angles;
        let known = |unit: &str| match angles {
            true => degrees(unit).is_some(),
            false => units.contains(&unit),
        };
        let other = columns().find(|column| !column.unit.is_empty() && !known(&column.unit));
        if let Some(Column { name, unit, .. }) = other {
            let wanted = if angles { "deg or rad" } else { units.first()? };
            return Some(format!(
                "unit `{unit}` known for {name}, which is read in {wanted}: in a map convert it with `scale` and `offset`, and name the unit that it then has"
            ));
        }
        if !angles {
            return None;
        }
        let mut asked: Vec<(f64, &str)> = Vec::new();
        for (i, (most, column)) in std::iter::zip(RADIANS, &self.columns).enumerate() {
            let Some((_, column)) = column else { continue };
            let values = column.values.iter();
            let greatest = values.fold(0.0, |greatest, value| f64::max(greatest, value.abs()));
            // 0 is 0 in either, but a pitch of 0 tells nothing of the others.
            let zero = i != 1 && greatest == 0.0;
            if column.unit.is_empty() && greatest <= most && !zero {
                asked.push((most, &column.name));
            }
        }
        if let Some((_, first)) = asked.first() {
            let names: Vec<&str> = asked.iter().map(|(_, name)| *name).collect();
            let within: Vec<String> = asked
                .iter()
                .map(|(most, name)| format!("{name} within {most}"))
                .collect();
            return Some(format!(
                "unit of {}: degrees or radians? It may be either with {}. In a map say `unit = \"deg\"` or `unit = \"rad\"` with each, in a header `{first} [deg]`",
                names.join(", "),
                within.join(", "),
            ));
        }
        let pitch = self.columns.get(1).copied().flatten()?.1;
        let each = self.degrees_each()[1];
        let beyond = pitch
            .values
            .iter()
            .find(|v| (*v * each).abs() > MOST_PITCH)?;
        Some(format!(
            "attitude: the pitch in {} is {:.1}°, and none is beyond 90°: its unit, or its column, is another",
            pitch.name,
            beyond * each
        ))
    }

    /// The quantity held at the times `base`. `N` is the number of its components; those not logged are 0.
    pub(super) fn held<const N: usize>(&self, base: &[f64]) -> Series<N> {
        let mut components: Vec<Vec<f64>> = Vec::new();
        let mut age = vec![0.0; base.len()];
        for (i, column) in self.columns.iter().enumerate() {
            let Some((topic, column)) = column else {
                components.push(vec![f64::NAN; base.len()]);
                continue;
            };
            let held = topic.held_at(base);
            let mut values = held.values(column);
            let flag = self.source.valid.get(i);
            if let Some(flag) = flag.and_then(|name| topic.column(name)) {
                let flagged = std::iter::zip(&mut values, held.values(flag));
                flagged
                    .filter(|(_, flag)| *flag == 0.0)
                    .for_each(|(value, _)| *value = f64::NAN);
            }
            components.push(values);
            // The oldest component is the age of the whole.
            std::iter::zip(&mut age, held.age).for_each(|(age, own)| *age = f64::max(*age, own));
        }
        let logged = |row: usize, i: usize| components.get(i).map_or(0.0, |values| values[row]);
        let origin: Vec<f64> = self
            .columns
            .iter()
            .map(|column| column.map_or(f64::NAN, |(_, c)| first_finite(&c.values)))
            .collect();
        let each = self.degrees_each();
        let values = (0..base.len()).map(|row| {
            let three = [logged(row, 0), logged(row, 1), logged(row, 2)];
            let four = [
                logged(row, 0),
                logged(row, 1),
                logged(row, 2),
                logged(row, 3),
            ];
            let all = match self.source.form {
                Form::Scalar | Form::Vector | Form::Horizontal => four,
                Form::Quaternion => attitude::normalized(four),
                Form::Angles => attitude::from_degrees(std::array::from_fn(|i| three[i] * each[i])),
                Form::Course => {
                    let (east, north) = three[1].to_radians().sin_cos();
                    [three[0] * north, three[0] * east, three[2], 0.0]
                }
                Form::Geodetic => {
                    let north = (three[0] - origin[0]) * METRES_PER_DEGREE;
                    let east =
                        (three[1] - origin[1]) * METRES_PER_DEGREE * origin[0].to_radians().cos();
                    [north, east, origin[2] - three[2], 0.0]
                }
            };
            std::array::from_fn(|i| all.get(i).copied().unwrap_or(0.0))
        });
        Series {
            source: self.source.to_string(),
            values: values.collect(),
            age,
            interval: usual_interval(self.base()),
        }
    }
}

/// The median of the times between neighbours; 0 if there are none.
fn usual_interval(times: &[f64]) -> f64 {
    let mut between: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    between.sort_by(f64::total_cmp);
    between.get(between.len() / 2).copied().unwrap_or(0.0)
}

fn first_finite(values: &[f64]) -> f64 {
    values
        .iter()
        .copied()
        .find(|v| v.is_finite())
        .unwrap_or(f64::NAN)
}

/// The first of `sources` that the log has, held at `time`. If it has none, `what` is missing.
pub(super) fn first<const N: usize>(
    topics: &Topics,
    time: &[f64],
    what: &'static str,
    sources: &[Source],
    missing: &mut Vec<Missing>,
) -> Option<Series<N>> {
    let series = any(topics, time, sources);
    if series.is_none() {
        missing.push(Missing {
            what: what.into(),
            tried: sources.iter().map(Source::to_string).collect(),
        });
    }
    series
}

/// All of `sources` that the log has, held at `time`: each row and axis of the first that gives it there. If it has none, `what` is missing.
pub(super) fn each<const N: usize>(
    topics: &Topics,
    time: &[f64],
    what: &'static str,
    sources: &[Source],
    missing: &mut Vec<Missing>,
) -> Option<Series<N>> {
    let first = first(topics, time, what, sources, missing)?;
    let matches = sources.iter().filter_map(|source| source.find(topics));
    let all: Vec<Series<N>> = matches.map(|matches| matches.held(time)).collect();
    let known = |series: &Series<N>| series.values.iter().flatten().any(|x| x.is_finite());
    let all: Vec<Series<N>> = all.into_iter().filter(known).collect();
    let [_, _, ..] = all[..] else {
        return Some(all.into_iter().next().unwrap_or(first));
    };
    let mut merged = Series {
        source: all
            .iter()
            .map(|s| &*s.source)
            .collect::<Vec<_>>()
            .join(", or "),
        interval: all.iter().fold(0.0, |most, s| f64::max(most, s.interval)),
        ..first
    };
    for row in 0..time.len() {
        let of = std::array::from_fn::<_, N, _>(|i| {
            all.iter()
                .find(|s| s.overdue(row) <= CEASED && s.values[row][i].is_finite())
        });
        let ages = of.iter().flatten().map(|s| s.age[row]);
        let age = ages.fold(f64::NEG_INFINITY, f64::max);
        if age >= 0.0 {
            merged.values[row] =
                std::array::from_fn(|i| of[i].map_or(f64::NAN, |s| s.values[row][i]));
            merged.age[row] = age;
        } else if let Some(youngest) = all.iter().min_by(|a, b| a.age[row].total_cmp(&b.age[row])) {
            (merged.values[row], merged.age[row]) = (youngest.values[row], youngest.age[row]);
        }
    }
    Some(merged)
}

/// The first of `sources` that the log has, held at `time`.
pub(super) fn any<const N: usize>(
    topics: &Topics,
    time: &[f64],
    sources: &[Source],
) -> Option<Series<N>> {
    let first = sources.iter().find_map(|source| source.find(topics));
    first.map(|first| first.held(time))
}
