//! Figures of a flight in space, each declared once: for the table, `--json`, bounds and the README.
//!
//! Root mean squares and peaks leave out the entry. A NaN makes a figure NaN; that is `null` in JSON and keeps no bound.

use alula::guidance::{Mode, Phase, Status};
use serde_json::{Map, Value};

use super::{Experiment, Step};
use crate::figures::{LATE, LOST};

/// How a figure is made of the steps.
pub enum Fold {
    /// Root mean square after the entry.
    Rms(fn(&Step) -> f64),
    /// Greatest magnitude after the entry.
    Peak(fn(&Step) -> f64),
    /// Least value of the whole flight.
    Least(fn(&Step) -> f64),
    /// Greatest value of the whole flight.
    Most(fn(&Step) -> f64),
    /// Root mean square of the last 5 s.
    Late(fn(&Step) -> f64),
    /// The last value.
    Last(fn(&Step) -> f64),
    /// Time in which something holds \[s\], of the whole flight.
    Time(fn(&Step) -> bool),
    /// The same after the entry.
    TimeAfter(fn(&Step) -> bool),
    /// Whether something holds at any time.
    Ever(fn(&Step) -> bool),
}

/// A figure.
pub struct Figure {
    /// Its name, with its unit.
    pub name: &'static str,
    /// Its name in tables.
    pub label: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Digits after the point in tables.
    pub digits: usize,
    /// What it is.
    pub meaning: &'static str,
    /// How it is made.
    pub fold: Fold,
}

macro_rules! figures {
    ($($name:literal, $label:literal, $unit:literal, $digits:literal, $fold:expr, $meaning:literal;)*) => {
        /// Every figure.
        pub static FIGURES: &[Figure] = &[$(Figure {
            name: $name,
            label: $label,
            unit: $unit,
            digits: $digits,
            meaning: $meaning,
            fold: $fold,
        }),*];
    };
}

use Fold::{Ever, Last, Late, Least, Most, Peak, Rms, Time, TimeAfter};

figures! {
    "velocity_error_rms_m_s", "velocity error, rms", "m/s", 3, Rms(Step::velocity_error), "root mean square of \\|v − v_r\\|";
    "max_velocity_error_m_s", "velocity error, peak", "m/s", 3, Peak(Step::velocity_error), "largest \\|v − v_r\\|";
    "position_error_rms_m", "position error, rms", "m", 3, Rms(Step::position_error), "root mean square of \\|x − x_r\\|";
    "max_position_error_m", "position error, peak", "m", 3, Peak(Step::position_error), "largest \\|x − x_r\\|";
    "sideslip_rms_deg", "sideslip, rms", "°", 3, Rms(|s| s.sideslip().to_degrees()), "root mean square of the sideslip";
    "max_sideslip_deg", "sideslip, peak", "°", 2, Peak(|s| s.sideslip().to_degrees()), "largest sideslip, either way";
    "max_bank_deg", "bank, peak", "°", 1, Peak(|s| s.bank().to_degrees()), "largest angle of the right wing from the horizontal, either way";
    "max_load_factor", "load factor, peak", "", 2, Peak(|s| s.load_factor), "largest specific force over g";
    "rate_rms_rad_s", "body rate, rms", "rad/s", 3, Rms(|s| s.truth.rates.norm()), "root mean square of \\|ω\\|";
    "peak_rate_rad_s", "body rate, peak", "rad/s", 2, Most(|s| s.truth.rates.amax()), "largest true body rate about one axis, of the whole flight";
    "altitude_least_m", "least altitude", "m", 2, Least(Step::altitude), "least altitude over the path, of the whole flight";
    "altitude_most_m", "greatest altitude", "m", 2, Most(Step::altitude), "greatest altitude over the path, of the whole flight";
    "late_velocity_error_m_s", "end error, rms", "m/s", 3, Late(Step::velocity_error), "root mean square of \\|v − v_r\\| in the last 5 s";
    "final_velocity_error_m_s", "final velocity error", "m/s", 4, Last(Step::velocity_error), "\\|v − v_r\\| at the end";
    "final_nose_deg", "nose from upright, end", "°", 2, Last(|s| 90.0 - s.pitch().to_degrees()), "angle of the nose from upright at the end";
    "final_belly_deg", "belly from down, end", "°", 2, Last(|s| s.truth.axes()[1].z.clamp(-1.0, 1.0).acos().to_degrees()), "angle of the belly from straight down at the end: in cruise that of attack and bank";
    "crossing_s", "crossing", "s", 2, Time(|s| s.guided.progress.phase == Phase::Crossing), "time in which the guidance turns to an attitude far away, as across a fold";
    "crossing_on_path_s", "crossing after the entry", "s", 2, TimeAfter(|s| s.guided.progress.phase == Phase::Crossing), "the same after the entry";
    "thrust_low_s", "thrust at its lower limit", "s", 2, Time(|s| s.guided.status.contains(Status::THRUST_LOW)), "time with thrust at its lower limit";
    "thrust_high_s", "thrust at its upper limit", "s", 2, Time(|s| s.guided.status.contains(Status::THRUST_HIGH)), "time with thrust at its upper limit";
    "unreachable_s", "path unreachable", "s", 2, Time(|s| s.guided.progress.unreachable.is_some()), "time in which the guidance says that the path cannot be had";
    "safe_s", "safe command", "s", 2, Time(|s| s.guided.mode == Mode::Safe), "time in which the guidance gives its safe command";
    "lost", "lost", "flag", 0, Ever(|s| s.altitude().is_nan() || s.altitude() < -LOST), "whether the flight sank more than 50 m below its path, or came to no number";
}

/// The figures of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// In the order of [`FIGURES`].
    pub values: Vec<f64>,
}

/// Root mean square of the steps from `from` \[s\] on.
fn rms(record: &[Step], from: f64, of: fn(&Step) -> f64) -> f64 {
    let part = &record[record.partition_point(|step| step.t < from)..];
    let squares = part.iter().map(|step| of(step).powi(2));
    (squares.sum::<f64>() / part.len() as f64).sqrt()
}

/// The value that is beyond the others, or NaN if one is.
fn extreme(
    record: &[Step],
    from: f64,
    of: impl Fn(&Step) -> f64,
    beyond: fn(f64, f64) -> bool,
) -> f64 {
    let part = record.iter().filter(|step| step.t >= from).map(of);
    let chosen = part.reduce(|a, b| if a.is_nan() || beyond(a, b) { a } else { b });
    chosen.unwrap_or(f64::NAN)
}

impl Figures {
    /// The figures of a record.
    pub fn of(experiment: &Experiment, record: &[Step]) -> Self {
        let entry = experiment.entry_s;
        let count = |from: f64, holds: fn(&Step) -> bool| {
            let part = record.iter().filter(|s| s.t >= from && holds(s));
            part.count() as f64
        };
        let value = |figure: &Figure| match figure.fold {
            Rms(of) => rms(record, entry, of),
            Peak(of) => extreme(record, entry, |s| of(s).abs(), |a, b| a >= b),
            Least(of) => extreme(record, 0.0, of, |a, b| a <= b),
            Most(of) => extreme(record, 0.0, of, |a, b| a >= b),
            Late(of) => rms(record, experiment.duration_s - LATE, of),
            Last(of) => record.last().map_or(f64::NAN, of),
            Time(holds) => count(0.0, holds) / experiment.control_rate_hz,
            TimeAfter(holds) => count(entry, holds) / experiment.control_rate_hz,
            Ever(holds) => f64::from(count(0.0, holds) > 0.0),
        };
        Self {
            values: FIGURES.iter().map(value).collect(),
        }
    }

    /// The figure of this name, which must be one.
    pub fn get(&self, name: &str) -> f64 {
        let i = FIGURES.iter().position(|figure| figure.name == name);
        self.values[i.expect("a figure")]
    }

    /// The bounds of `experiment` that are not kept: name, value, bound.
    pub fn beyond<'a>(&self, experiment: &'a Experiment) -> Vec<(&'a str, f64, f64)> {
        let bounds = experiment.bounds.iter();
        let all = bounds.map(|(name, &bound)| (name.as_str(), self.get(name), bound));
        // A NaN keeps no bound.
        all.filter(|(_, value, bound)| value.is_nan() || value > bound)
            .collect()
    }

    /// The figures as a JSON object.
    pub fn json(&self) -> Map<String, Value> {
        let each = FIGURES.iter().zip(&self.values).map(|(figure, &value)| {
            let json = match figure.fold {
                Ever(_) => Value::from(value != 0.0),
                _ => Value::from(value),
            };
            (figure.name.to_owned(), json)
        });
        each.collect()
    }

    /// Label, value with unit, and the bound if there is one: one line of the table each.
    pub fn table(&self, experiment: &Experiment) -> Vec<[String; 3]> {
        let mut lines = Vec::new();
        for (figure, &value) in FIGURES.iter().zip(&self.values) {
            let optional = matches!(figure.fold, Time(_) | TimeAfter(_));
            if optional && value == 0.0 {
                continue;
            }
            let text = match figure.fold {
                Ever(_) => if value == 0.0 { "no" } else { "yes" }.to_owned(),
                _ => format!("{value:.*} {}", figure.digits, figure.unit),
            };
            let bound = experiment.bounds.get(figure.name).map(|bound| {
                let kept = if value <= *bound { "" } else { ": not kept" };
                format!("at most {bound}{kept}")
            });
            lines.push([
                figure.label.to_owned(),
                text.trim_end().replace(" °", "°"),
                bound.unwrap_or_default(),
            ]);
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The README's table of figures is this one.
    #[test]
    fn every_figure_is_documented() {
        let readme = include_str!("../../../README.md");
        for (i, figure) in FIGURES.iter().enumerate() {
            assert!(FIGURES[..i].iter().all(|f| f.name != figure.name));
            let line = format!(
                "| `{}` | {} | {} |",
                figure.name, figure.unit, figure.meaning
            );
            assert!(readme.contains(&line), "README.md lacks the line {line}");
        }
    }
}
