//! Maps: the worst value of a figure over two fields, in bins, to see where in their space flights strain.

use serde::{Deserialize, Serialize};

use super::Frame;
use alula_sim::experiment::{FieldError, finite, require};
use alula_sim::figures::{named_now, unknown};

/// A map that a campaign asks for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Map {
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// One of those of the place that is flown in.
    pub figure: String,
    /// Values of the figure at which the colour changes, from good to bad: if they rise, a great value is bad.
    pub levels: Vec<f64>,
}

/// An axis of a map.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// A column of the flights: a dispersed field, a figure, or what is drawn of a reference.
    pub field: String,
    /// What its values are divided by: where a belief is shown over what is true.
    #[serde(default = "one")]
    pub over: f64,
    /// What is written beside the axis in place of the field.
    pub label: Option<String>,
    /// Lower end.
    pub from: f64,
    /// Upper end. What is beyond either end goes into the outermost bin.
    pub to: f64,
    /// Number of bins.
    #[serde(default = "twelve")]
    pub bins: usize,
}

fn one() -> f64 {
    1.0
}

fn twelve() -> usize {
    12
}

/// A map of the flights.
#[derive(Clone, Debug, Serialize)]
pub struct MapResult {
    /// Its axes.
    pub x: Axis,
    /// Its axes.
    pub y: Axis,
    /// Its figure.
    pub figure: String,
    /// The map's.
    pub levels: Vec<f64>,
    /// The worst value of each bin, row by row from below; none where nothing flew. A flight that came to no number is infinitely bad.
    pub worst: Vec<Option<f64>>,
    /// Flights of each bin.
    pub flights: Vec<u64>,
}

impl Axis {
    fn validate(&self, field: &str) -> Result<(), FieldError> {
        finite(&format!("{field}.from"), self.from)?;
        finite(&format!("{field}.to"), self.to)?;
        finite(&format!("{field}.over"), self.over)?;
        require(self.over != 0.0, format!("{field}.over"), "must not be 0")?;
        let drawn = self.from < self.to && (1..=100).contains(&self.bins);
        require(drawn, field, "needs from < to, and 1 to 100 bins")
    }

    /// The bin of `value`.
    fn bin(&self, value: f64) -> usize {
        let part = (value / self.over - self.from) / (self.to - self.from);
        // The cast saturates; NaN becomes 0.
        ((part * self.bins as f64) as usize).min(self.bins - 1)
    }

    /// What is written beside it.
    pub fn text(&self) -> &str {
        self.label.as_deref().unwrap_or(&self.field)
    }

    /// The ends of bin `i`.
    pub fn ends(&self, i: usize) -> (f64, f64) {
        let at = |i: usize| self.from + (self.to - self.from) * i as f64 / self.bins as f64;
        (at(i), at(i + 1))
    }
}

impl Map {
    /// `known` says whether the flights have a column, `is_figure` whether that is a figure.
    pub(super) fn validate(
        &self,
        field: &str,
        known: impl Fn(&str) -> bool,
        is_figure: impl Fn(&str) -> bool,
    ) -> Result<(), FieldError> {
        for (part, axis) in [("x", &self.x), ("y", &self.y)] {
            let field = format!("{field}.{part}");
            axis.validate(&field)?;
            let now = named_now(&axis.field);
            let problem = format_args!("{} is no column of the flights{now}", axis.field);
            require(known(&axis.field), format!("{field}.field"), problem)?;
        }
        let problem = unknown(&self.figure);
        require(is_figure(&self.figure), format!("{field}.figure"), problem)?;
        let rising = self.levels.windows(2).all(|pair| pair[0] < pair[1]);
        let falling = self.levels.windows(2).all(|pair| pair[0] > pair[1]);
        let finite = self.levels.iter().all(|level| level.is_finite());
        let classes = (2..=6).contains(&self.levels.len()) && finite && (rising || falling);
        let problem = "needs 2 to 6 numbers that rise, or fall";
        require(classes, format!("{field}.levels"), problem)
    }
}

impl MapResult {
    /// Nothing has flown.
    pub(super) fn new(map: &Map) -> Self {
        let Map {
            x,
            y,
            figure,
            levels,
        } = map.clone();
        let bins = x.bins * y.bins;
        Self {
            x,
            y,
            figure,
            levels,
            worst: vec![None; bins],
            flights: vec![0; bins],
        }
    }

    /// Whether a great value is bad.
    fn rising(&self) -> bool {
        self.levels.first() < self.levels.last()
    }

    pub(super) fn add(&mut self, flights: &Frame) -> anyhow::Result<()> {
        let bad = match self.rising() {
            true => f64::INFINITY,
            false => f64::NEG_INFINITY,
        };
        let (x, y) = (flights.real(&self.x.field)?, flights.real(&self.y.field)?);
        for ((&x, &y), &value) in x.iter().zip(y).zip(flights.real(&self.figure)?) {
            let bin = self.y.bin(y) * self.x.bins + self.x.bin(x);
            let value = if value.is_nan() { bad } else { value };
            let worse = |old: f64| {
                if bad > 0.0 {
                    old.max(value)
                } else {
                    old.min(value)
                }
            };
            self.worst[bin] = Some(self.worst[bin].map_or(value, worse));
            self.flights[bin] += 1;
        }
        Ok(())
    }

    /// How many levels the worst value of a bin is beyond.
    pub fn class(&self, bin: usize) -> Option<usize> {
        let worst = self.worst[bin]?;
        let beyond = |level: &&f64| match self.rising() {
            true => worst > **level,
            false => worst < **level,
        };
        Some(self.levels.iter().filter(beyond).count())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Column;

    fn axis(field: &str) -> Axis {
        Axis {
            field: field.to_owned(),
            over: 1.0,
            label: None,
            from: 0.0,
            to: 10.0,
            bins: 5,
        }
    }

    fn map(levels: &[f64]) -> Map {
        Map {
            x: axis("a"),
            y: axis("b"),
            figure: "altitude_least_m".to_owned(),
            levels: levels.to_vec(),
        }
    }

    #[test]
    fn a_bin_shows_its_worst_flight() {
        let mut frame = Frame::default();
        frame.push("a", Column::Real(vec![1.0, 1.5, 9.9, 10.0, 42.0, -3.0]));
        frame.push("b", Column::Real(vec![0.0, 1.9, 2.0, 3.9, 4.0, 10.0]));
        let altitudes = vec![-1.0, -7.0, -3.0, 0.5, f64::NAN, -0.5];
        frame.push("altitude_least_m", Column::Real(altitudes));
        let mut result = MapResult::new(&map(&[-2.0, -5.0]));
        result.add(&frame).unwrap();
        assert_eq!(result.worst[0], Some(-7.0));
        assert_eq!(result.worst[5 + 4], Some(-3.0));
        assert_eq!(result.worst[2 * 5 + 4], Some(f64::NEG_INFINITY));
        assert_eq!(result.worst[4 * 5], Some(-0.5));
        assert_eq!((result.worst[1], result.class(1)), (None, None));
        let classes = [0, 9, 14, 20].map(|bin| result.class(bin).unwrap());
        assert_eq!(classes, [2, 1, 2, 0]);
        assert_eq!(result.flights[..2], [2, 0]);
        assert_eq!(result.flights.iter().sum::<u64>(), 6);
        // Half the values are half as far along.
        let mut halved = map(&[-2.0, -5.0]);
        halved.x.over = 2.0;
        let mut halved = MapResult::new(&halved);
        halved.add(&frame).unwrap();
        assert_eq!((halved.worst[4], halved.worst[5 + 2]), (None, Some(-3.0)));
        let mut rising = MapResult::new(&map(&[-5.0, -2.0]));
        rising.add(&frame).unwrap();
        assert_eq!((rising.worst[0], rising.class(0)), (Some(-1.0), Some(2)));
    }

    #[test]
    fn a_map_of_nothing_is_refused() {
        let refused = |map: Map| {
            let known = |name: &str| ["a", "b"].contains(&name);
            map.validate("maps[0]", known, |name| name == "altitude_least_m")
                .map_err(|e| e.field)
        };
        assert!(refused(map(&[1.0, 2.0])).is_ok());
        assert_eq!(refused(map(&[1.0])).unwrap_err(), "maps[0].levels");
        assert_eq!(
            refused(map(&[1.0, 2.0, 1.5])).unwrap_err(),
            "maps[0].levels"
        );
        let mut other = map(&[1.0, 2.0]);
        other.x.field = "c".to_owned();
        assert_eq!(refused(other).unwrap_err(), "maps[0].x.field");
        let mut other = map(&[1.0, 2.0]);
        other.x.over = 0.0;
        assert_eq!(refused(other).unwrap_err(), "maps[0].x.over");
        let mut other = map(&[1.0, 2.0]);
        other.y.to = 0.0;
        assert_eq!(refused(other).unwrap_err(), "maps[0].y");
        let mut other = map(&[1.0, 2.0]);
        other.figure = "ahead_m".to_owned();
        let renamed = "ahead_m is not the name of a figure; its name is `max_ahead_m` now";
        let error = other.validate("maps[0]", |_| true, |_| false).unwrap_err();
        assert_eq!(error.problem, renamed);
        other.figure = "altitude".to_owned();
        assert_eq!(refused(other).unwrap_err(), "maps[0].figure");
    }
}
