//! What a comparison gave.

use serde::Serialize;

use super::{Comparison, Flight, Outcome, Sample};

/// The flights of one policy under one condition: one per seed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// The policy's name.
    pub policy: String,
    /// The condition's name.
    pub condition: String,
    /// The flights.
    pub flights: Vec<Flight>,
    /// Of the first flight, for the charts.
    #[serde(skip)]
    pub samples: Vec<Sample>,
}

/// All cells: of every condition, of every policy.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Results {
    /// The cells.
    pub cells: Vec<Cell>,
}

impl Cell {
    /// The worst outcome of its flights.
    pub fn outcome(&self) -> Outcome {
        let outcomes = self.flights.iter().map(|f| f.outcome);
        outcomes.max().unwrap_or(Outcome::Flies)
    }

    /// Median and greatest value of a figure.
    pub fn spread(&self, value: impl Fn(&Flight) -> f64) -> (f64, f64) {
        let mut values: Vec<f64> = self.flights.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        let n = values.len();
        ((values[(n - 1) / 2] + values[n / 2]) / 2.0, values[n - 1])
    }

    /// The outcome in words, with how many of several flights it was.
    pub fn outcome_text(&self) -> String {
        let worst = self.outcome();
        let name = match worst {
            Outcome::Flies => "flies",
            Outcome::Oscillates => "oscillates",
            Outcome::Strays => "strays",
            Outcome::Departs => "departs",
        };
        let n = self.flights.len();
        let count = self.flights.iter().filter(|f| f.outcome == worst).count();
        match n > 1 && worst != Outcome::Flies {
            true => format!("{name}, {count} of {n}"),
            false => name.to_owned(),
        }
    }

    /// Whether every flight departed: then figures mean nothing.
    pub fn lost(&self) -> bool {
        self.flights.iter().all(|f| f.outcome == Outcome::Departs)
    }

    /// A figure as text: of several flights the median, and the worst in brackets.
    fn text(&self, digits: usize, value: impl Fn(&Flight) -> f64) -> String {
        if self.lost() {
            return "–".to_owned();
        }
        let (median, worst) = self.spread(value);
        // Not "-0.0".
        let number = |x: f64| match format!("{x:.digits$}") {
            text if text.trim_start_matches(['-', '0', '.']).is_empty() => {
                format!("{:.digits$}", 0.0)
            }
            text => text,
        };
        match self.flights.len() {
            1 => number(median),
            _ => format!("{} ({})", number(median), number(worst)),
        }
    }

    /// The figures as text, in the order of the columns.
    pub fn texts(&self) -> [String; COLUMNS.len()] {
        let missing = self.flights.iter().any(|f| f.cruise_after_s.is_none());
        [
            self.outcome_text(),
            self.text(1, |f| -f.out_m[0]),
            self.text(1, |f| f.out_m[1]),
            self.text(1, |f| -f.back_m[0]),
            self.text(1, |f| f.back_m[1]),
            match missing {
                true => "–".to_owned(),
                false => self.text(1, |f| f.cruise_after_s.unwrap_or(f64::NAN)),
            },
            self.text(2, |f| f.cruise_error_m_s),
            self.text(2, |f| f.end_error_m_s),
            self.text(2, |f| f.late_rate_rms_rad_s),
            self.text(1, |f| f.peak_rate_rad_s),
            self.text(0, |f| f.ahead_m),
        ]
    }
}

/// What the figures of a cell are, each with its unit.
pub const COLUMNS: [&str; 11] = [
    "outcome",
    "loss out [m]",
    "gain out [m]",
    "loss back [m]",
    "gain back [m]",
    "cruise after [s]",
    "cruise error [m/s]",
    "end error [m/s]",
    "late ω [rad/s]",
    "peak ω [rad/s]",
    "ahead [m]",
];

impl Results {
    /// The cell of a policy and a condition, by their numbers in `comparison`.
    pub fn cell(&self, comparison: &Comparison, condition: usize, policy: usize) -> &Cell {
        &self.cells[condition * comparison.policies.len() + policy]
    }

    /// The cell of a policy and a condition, by their names.
    pub fn named(&self, policy: &str, condition: &str) -> Option<&Cell> {
        let mut cells = self.cells.iter();
        cells.find(|c| c.policy == policy && c.condition == condition)
    }

    /// In one word or number: the greatest distance from the reference altitude \[m\], or how the flight ended.
    pub fn verdict(cell: &Cell) -> String {
        match cell.outcome() {
            Outcome::Flies => cell.text(1, Flight::altitude_m),
            Outcome::Oscillates | Outcome::Strays => {
                let altitude = cell.text(1, Flight::altitude_m);
                format!("{altitude}, {}", cell.outcome_text())
            }
            Outcome::Departs => cell.outcome_text(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight(outcome: Outcome, low: f64) -> Flight {
        Flight {
            seed: 0,
            outcome,
            out_m: [low, 0.5],
            back_m: [0.0, 1.0],
            cruise_after_s: Some(10.0),
            cruise_error_m_s: 0.01,
            end_error_m_s: 0.0,
            late_rate_rms_rad_s: 0.0,
            peak_rate_rad_s: 2.0,
            ahead_m: 3.0,
        }
    }

    fn cell(flights: Vec<Flight>) -> Cell {
        Cell {
            policy: "p".to_owned(),
            condition: "c".to_owned(),
            flights,
            samples: Vec::new(),
        }
    }

    #[test]
    fn several_flights_give_median_and_worst() {
        let lows = [-1.0, -9.0, -2.0, -4.0];
        let cell = cell(lows.map(|low| flight(Outcome::Flies, low)).to_vec());
        assert_eq!(cell.spread(|f| -f.out_m[0]), (3.0, 9.0));
        assert_eq!(cell.texts()[1], "3.0 (9.0)");
        assert_eq!(Results::verdict(&cell), "3.0 (9.0)");
    }

    #[test]
    fn what_departed_is_said_and_its_figures_are_not() {
        let all = cell(vec![flight(Outcome::Departs, -80.0)]);
        assert_eq!(Results::verdict(&all), "departs");
        assert_eq!(&all.texts()[..2], ["departs", "–"]);
        let some = cell(vec![
            flight(Outcome::Flies, -1.0),
            flight(Outcome::Departs, -80.0),
        ]);
        assert_eq!(Results::verdict(&some), "departs, 1 of 2");
        let still = cell(vec![flight(Outcome::Flies, 0.0)]);
        assert_eq!(still.texts()[1], "0.0");
    }
}
