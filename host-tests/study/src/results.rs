//! What a comparison gave.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{Comparison, Plan, Threads, each};
use alula_sim::columns::declared;
use alula_sim::experiment::Experiment;
use alula_sim::figures::{FIGURES, Figure, Figures, Tally, index};
use alula_sim::simulate::{End, simulate};

/// A mean velocity error above this over the last 5 s is a departure \[m/s\].
pub const ASTRAY: f64 = 3.0;
/// Ending further than this from the reference altitude, without a departure, is straying \[m\].
pub const FAR: f64 = 10.0;
/// Root mean square of ω above which late steady flight oscillates \[rad/s\].
pub const OSCILLATION: f64 = 0.6;

/// The figures of a table, after the outcome.
pub const COLUMNS: [&str; 10] = [
    "max_loss_out_m",
    "max_gain_out_m",
    "max_loss_back_m",
    "max_gain_back_m",
    "cruise_after_s",
    "max_cruise_error_m_s",
    "max_late_velocity_error_m_s",
    "oscillation_rms_rad_s",
    "max_true_rate_rad_s",
    "max_ahead_m",
];

/// The columns of the record that are drawn.
const DRAWN: [&str; 4] = ["t_s", "altitude_m", "v_north_m_s", "path_v_north_m_s"];

/// Every how many control steps a flight is sampled for the charts.
const SAMPLING: usize = 10;

/// How a flight went, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Flown to the end.
    Flies,
    /// Oscillates in steady flight: ω above 0.6 rad/s root mean square in the last 5 s of cruise or of the flight.
    Oscillates,
    /// Ends more than 10 m from the reference altitude.
    Strays,
    /// Sinks by more than 50 m below the reference, or ends with a mean velocity error of more than 3 m/s.
    Departs,
    /// Comes to no number.
    Diverges,
}

impl Outcome {
    /// How the flight that came to `end` with these figures went.
    fn of(end: End, figures: &Figures) -> Self {
        let within = |name: &str, most: f64| figures.get(name).abs() <= most;
        if end.sound().is_err() {
            Self::Diverges
        } else if figures.get("lost") != 0.0 || !within("late_mean_velocity_error_m_s", ASTRAY) {
            Self::Departs
        } else if !within("final_altitude_m", FAR) {
            Self::Strays
        } else if !within("oscillation_rms_rad_s", OSCILLATION) {
            Self::Oscillates
        } else {
            Self::Flies
        }
    }

    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Self::Flies => "flies",
            Self::Oscillates => "oscillates",
            Self::Strays => "strays",
            Self::Departs => "departs",
            Self::Diverges => "diverges",
        }
    }

    /// Whether nothing was kept: then figures mean nothing.
    fn is_lost(self) -> bool {
        self >= Self::Departs
    }
}

/// A flight of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flight {
    /// Seed of the experiment.
    pub seed: u64,
    /// How it went.
    pub outcome: Outcome,
    /// Its figures.
    #[serde(flatten)]
    pub figures: Figures,
}

/// What is drawn of a flight: a line of points by column.
type Samples = BTreeMap<&'static str, Vec<f64>>;

impl Flight {
    /// Flies `experiment`: its figures, and samples of it.
    pub fn of(experiment: &Experiment) -> anyhow::Result<(Self, Samples)> {
        let mut tally = Tally::new(experiment);
        let drawn = DRAWN.map(declared);
        let mut samples = Samples::new();
        let mut number = 0;
        let end = simulate(experiment, experiment.controller()?.as_mut(), |step| {
            tally.add(step);
            if number % SAMPLING == 0 {
                for column in drawn {
                    let line = samples.entry(column.name).or_default();
                    line.push(column.number(experiment, step));
                }
            }
            number += 1;
            // A fall of 1 km, or a position that is not finite, is lost whatever follows.
            step.position_error().z < 1000.0
        })?;
        let figures = tally.figures();
        let flight = Self {
            seed: experiment.seed,
            outcome: Outcome::of(end, &figures),
            figures,
        };
        Ok((flight, samples))
    }

    /// A figure.
    pub fn get(&self, name: &str) -> f64 {
        match (name, self.outcome) {
            // Whatever was reached, it was not kept.
            ("cruise_after_s", outcome) if outcome.is_lost() => f64::NAN,
            _ => self.figures.get(name),
        }
    }

    /// Greatest distance from the reference altitude \[m\].
    pub fn altitude_m(&self) -> f64 {
        let sides = [
            "max_loss_out_m",
            "max_gain_out_m",
            "max_loss_back_m",
            "max_gain_back_m",
        ];
        sides
            .map(|name| self.get(name))
            .into_iter()
            .fold(0.0, f64::max)
    }
}

/// The flights of one variant under one condition: one per seed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// The variant's name.
    pub variant: String,
    /// The condition's name.
    pub condition: String,
    /// The flights.
    pub flights: Vec<Flight>,
    /// Of the first flight, for the charts.
    #[serde(skip)]
    pub samples: Samples,
}

/// All cells: of every condition, of every variant.
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
        let name = worst.text();
        let n = self.flights.len();
        let count = self.flights.iter().filter(|f| f.outcome == worst).count();
        match n > 1 && worst != Outcome::Flies {
            true => format!("{name}, {count} of {n}"),
            false => name.to_owned(),
        }
    }

    /// Whether every flight departed or diverged: then figures mean nothing.
    pub fn lost(&self) -> bool {
        self.flights.iter().all(|f| f.outcome.is_lost())
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

    /// The outcome and the figures as text, in the order of the columns.
    pub fn texts(&self) -> Vec<String> {
        let figure = |figure: &'static Figure| {
            let value = |flight: &Flight| flight.get(figure.name);
            match self.flights.iter().any(|flight| value(flight).is_nan()) {
                true => "–".to_owned(),
                false => self.text(figure.digits, value),
            }
        };
        let outcome = std::iter::once(self.outcome_text());
        outcome.chain(columns().map(figure)).collect()
    }
}

/// The figures of a table.
fn columns() -> impl Iterator<Item = &'static Figure> {
    let figure = |name: &&str| &FIGURES[index(name).expect("a figure")];
    COLUMNS.iter().map(figure)
}

/// The names of a table's columns, with units.
pub fn header() -> Vec<String> {
    let named = columns().map(|figure| format!("{} [{}]", figure.label, figure.unit));
    std::iter::once("outcome".to_owned()).chain(named).collect()
}

impl Results {
    /// Flies every experiment of `plan`; `visit` is asked after each flight whether to go on.
    pub fn of(
        plan: &Plan,
        threads: Threads,
        visit: impl Fn() -> anyhow::Result<()> + Sync + Send,
    ) -> anyhow::Result<Self> {
        let experiments: Vec<&Experiment> = plan.experiments.iter().flatten().flatten().collect();
        let flights = each(&experiments, threads, |experiment| {
            let flight = Flight::of(experiment)?;
            visit()?;
            Ok(flight)
        })?;
        let mut rest = flights.into_iter();
        let comparison = &plan.comparison;
        let mut cells = Vec::new();
        for (condition, experiments) in comparison.conditions.iter().zip(&plan.experiments) {
            for (variant, experiments) in comparison.variants.iter().zip(experiments) {
                let (flights, mut samples): (Vec<_>, Vec<_>) =
                    rest.by_ref().take(experiments.len()).unzip();
                cells.push(Cell {
                    variant: variant.name.clone(),
                    condition: condition.name.clone(),
                    flights,
                    samples: samples.swap_remove(0),
                });
            }
        }
        Ok(Self { cells })
    }

    /// How many flights diverged.
    pub fn diverged(&self) -> usize {
        let flights = self.cells.iter().flat_map(|cell| &cell.flights);
        flights
            .filter(|flight| flight.outcome == Outcome::Diverges)
            .count()
    }

    /// The cell of a variant and a condition, by their numbers in `comparison`.
    pub fn cell(&self, comparison: &Comparison, condition: usize, variant: usize) -> &Cell {
        &self.cells[condition * comparison.variants.len() + variant]
    }

    /// The cell of a variant and a condition, by their names.
    pub fn named(&self, variant: &str, condition: &str) -> Option<&Cell> {
        let mut cells = self.cells.iter();
        cells.find(|c| c.variant == variant && c.condition == condition)
    }

    /// In one word or number: the greatest distance from the reference altitude \[m\], or how the flight ended.
    pub fn verdict(cell: &Cell) -> String {
        match cell.outcome() {
            Outcome::Flies => cell.text(1, Flight::altitude_m),
            Outcome::Oscillates | Outcome::Strays => {
                let altitude = cell.text(1, Flight::altitude_m);
                format!("{altitude}, {}", cell.outcome_text())
            }
            Outcome::Departs | Outcome::Diverges => cell.outcome_text(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::experiment::Document;
    use alula_sim::simulate::fly;

    /// A flight in hover, sunk by so much in its middle.
    fn flight(outcome: Outcome, low: f64) -> Flight {
        let mut document = Document::load("round-trip").unwrap();
        document.assign("duration_s=1").unwrap();
        let experiment = document.checked().unwrap();
        let mut record = fly(&experiment).unwrap();
        for step in &mut record {
            step.truth.position = step.target.position;
        }
        record[50].truth.position.z -= low;
        Flight {
            seed: 0,
            outcome,
            figures: Figures::of(&experiment, &record),
        }
    }

    fn cell(flights: Vec<Flight>) -> Cell {
        Cell {
            variant: "p".to_owned(),
            condition: "c".to_owned(),
            flights,
            samples: Samples::new(),
        }
    }

    #[test]
    fn several_flights_give_median_and_worst() {
        let lows = [-1.0, -9.0, -2.0, -4.0];
        let cell = cell(lows.map(|low| flight(Outcome::Flies, low)).to_vec());
        let (median, worst) = cell.spread(|f| f.get("max_loss_out_m"));
        assert!((median - 3.0).abs() < 0.01 && (worst - 9.0).abs() < 0.01);
        assert_eq!(cell.texts()[1], "3.0 (9.0)");
        assert_eq!(Results::verdict(&cell), "3.0 (9.0)");
    }

    #[test]
    fn departed_flights_are_counted_and_left_out_of_the_figures() {
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

    #[test]
    fn a_fall_departs_and_threads_change_nothing() {
        let text = r#"
            base = "round-trip"
            [[variants]]
            name = "a"
            title = "as it is"
            [[variants]]
            name = "b"
            title = "a law alone"
            controller.law.vehicle = "paper-belief"
            [[conditions]]
            name = "light"
            title = "light turbulence"
            seeds = 2
            set = { "weather.turbulence" = { wind_at_20_ft_m_s = 3.0, height_m = 30.0 } }
        "#;
        let named = alula_sim::named::Named::new("x", "x.toml", text);
        let plan = crate::Source::new(&named).unwrap().plan;
        let count = std::sync::atomic::AtomicUsize::new(0);
        let run = |threads| {
            let visit = || {
                count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                Ok(())
            };
            Results::of(&plan, std::num::NonZero::new(threads), visit).unwrap()
        };
        let one = run(1);
        assert_eq!(count.load(std::sync::atomic::Ordering::Relaxed), 4);
        // A NaN is not equal to itself, but its text is.
        assert_eq!(format!("{:?}", run(3)), format!("{one:?}"));
        let [with, without] = &one.cells[..] else {
            panic!("two variants")
        };
        assert_eq!(without.outcome(), Outcome::Departs);
        assert!(without.flights[0].get("cruise_after_s").is_nan());
        assert!(with.outcome() < Outcome::Strays);
        assert_ne!(with.flights[0].figures, with.flights[1].figures);
    }
}
