//! Random starts, flown many times: how many converge, and what height they lose.

use serde::Serialize;

use super::{Threads, each};
use alula_sim::experiment::{Document, Experiment, PathSpec};
use alula_sim::figures::Tally;
use alula_sim::simulate::simulate;

/// The campaign's name, and its line in the list.
pub const ATTITUDES: (&str, &str) = (
    "attitudes",
    "Random attitudes, rates and velocities, to hover and to 20 m/s, in noise and moderate turbulence",
);
/// Its experiments.
pub const BASES: [&str; 2] = ["start-hover", "start-cruise"];
/// Flights of each experiment.
pub const FLIGHTS: u64 = 10_000;
/// Share that must converge, and greatest height lost \[m\].
pub const LIMITS: (f64, f64) = (0.995, 30.0);

/// What came of one start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartResult {
    /// Seed of the experiment.
    pub seed: u64,
    /// Most altitude lost under the path \[m\].
    pub height_lost_m: f64,
    /// Root mean square of the velocity error in the last 5 s \[m/s\].
    pub late_velocity_error_rms_m_s: f64,
    /// Whether the simulation diverged.
    pub diverged: bool,
    /// Whether it ended near its velocity, and upright.
    pub converged: bool,
}

/// Velocity error \[m/s\] in the last 5 s, and angle \[°\] of the nose from upright in hover, of the belly from down else, below
/// which a flight has converged. A vehicle in cruise brakes by its drag alone, 0.4 m/s²: the updraughts of moderate turbulence
/// leave errors of up to 3 m/s along the track. In hover it leans into 9 m/s of wind by 55°.
pub const CONVERGED: (f64, f64) = (5.0, 80.0);

/// Flies the experiment `name` from the seeds 0 to `flights`; `after_each` is called after each, and an error of its own ends it.
pub fn starts(
    name: &str,
    flights: u64,
    threads: Threads,
    after_each: impl Fn() -> anyhow::Result<()> + Sync + Send,
) -> anyhow::Result<Vec<StartResult>> {
    let experiment = Document::load(name)?.checked()?;
    let seeds: Vec<u64> = (0..flights).collect();
    let upright = match experiment.path {
        PathSpec::Hover { .. } => "final_nose_deg",
        _ => "final_belly_deg",
    };
    each(&seeds, threads, |&seed| {
        let experiment = Experiment {
            seed,
            ..experiment.clone()
        };
        let mut tally = Tally::new(&experiment);
        let end = simulate(&experiment, experiment.controller()?.as_mut(), |step| {
            tally.add(step);
            true
        })?;
        let figures = tally.figures();
        let diverged = end.sound().is_err();
        after_each()?;
        let error = figures.get("late_velocity_error_rms_m_s");
        Ok(StartResult {
            seed,
            height_lost_m: -figures.get("altitude_least_m"),
            late_velocity_error_rms_m_s: error,
            diverged,
            converged: !diverged
                && error < CONVERGED.0
                && figures.get(upright) < CONVERGED.1
                && figures.get("lost") == 0.0,
        })
    })
}

/// The random starts of one experiment, summed up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Starts {
    /// The experiment.
    pub experiment: &'static str,
    /// Number of flights.
    pub flights: usize,
    /// Flights whose simulation diverged.
    pub diverged: usize,
    /// Share that converged.
    pub converged: f64,
    /// Median height lost \[m\].
    pub height_lost_50_m: f64,
    /// Height that 95 % of the flights lose at most \[m\].
    pub height_lost_95_m: f64,
    /// Height that 99 % lose at most \[m\].
    pub height_lost_99_m: f64,
    /// Greatest height lost \[m\].
    pub height_lost_most_m: f64,
    /// The flight that lost most.
    pub worst_seed: u64,
    /// Flights that did not converge.
    pub astray: Vec<u64>,
}

impl Starts {
    /// What `starts` of `experiment` come to.
    pub fn new(experiment: &'static str, starts: &[StartResult]) -> Self {
        let mut heights: Vec<f64> = starts.iter().map(|s| s.height_lost_m).collect();
        heights.sort_by(f64::total_cmp);
        let worst = starts
            .iter()
            .max_by(|a, b| a.height_lost_m.total_cmp(&b.height_lost_m));
        let astray: Vec<u64> = starts
            .iter()
            .filter(|s| !s.converged)
            .map(|s| s.seed)
            .collect();
        let at = |share| percentile(&heights, share);
        Self {
            experiment,
            flights: starts.len(),
            diverged: starts.iter().filter(|s| s.diverged).count(),
            converged: 1.0 - astray.len() as f64 / starts.len() as f64,
            height_lost_50_m: at(0.5),
            height_lost_95_m: at(0.95),
            height_lost_99_m: at(0.99),
            height_lost_most_m: at(1.0),
            worst_seed: worst.map_or(0, |start| start.seed),
            astray,
        }
    }

    /// Whether they are within [`LIMITS`], and none diverged.
    pub fn kept(&self) -> bool {
        self.diverged == 0 && self.converged >= LIMITS.0 && self.height_lost_most_m <= LIMITS.1
    }
}

/// The value that `share` of `values` lie at or below; they must be sorted.
pub fn percentile(values: &[f64], share: f64) -> f64 {
    let last = values.len().saturating_sub(1);
    values
        .get((share * last as f64).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}
