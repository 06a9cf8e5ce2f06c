//! Random starts, flown many times: how many converge, and what height they lose.

use super::{Experiment, fly};
use super::{Figures, PathSpec};
use crate::study::{Threads, each};

/// One start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Seed of the experiment.
    pub seed: u64,
    /// Most altitude lost under the path \[m\].
    pub height_lost_m: f64,
    /// Root mean square of the velocity error in the last 5 s \[m/s\].
    pub late_velocity_error_m_s: f64,
    /// Whether it ended near its velocity, and upright.
    pub converged: bool,
}

/// Velocity error \[m/s\] in the last 5 s, and angle \[°\] of the nose from upright in hover, of the belly from down else, below
/// which a flight has converged. A vehicle in cruise brakes by its drag alone, 0.4 m/s²: the updraughts of moderate turbulence
/// leave errors of up to 3 m/s along the track. In hover it leans into 9 m/s of wind by 55°.
pub const CONVERGED: (f64, f64) = (5.0, 80.0);

/// Flies `experiment` from the seeds 0 to `flights`; `flown` is called after each.
pub fn starts(
    experiment: &Experiment,
    flights: u64,
    threads: Threads,
    flown: impl Fn() + Sync + Send,
) -> anyhow::Result<Vec<Start>> {
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
        let figures = Figures::of(&experiment, &fly(&experiment)?);
        flown();
        let error = figures.get("late_velocity_error_m_s");
        Ok(Start {
            seed,
            height_lost_m: -figures.get("altitude_least_m"),
            late_velocity_error_m_s: error,
            converged: error < CONVERGED.0
                && figures.get(upright) < CONVERGED.1
                && figures.get("lost") == 0.0,
        })
    })
}

/// The value that `share` of `values` lie at or below; they must be sorted.
pub fn percentile(values: &[f64], share: f64) -> f64 {
    let last = values.len().saturating_sub(1);
    values
        .get((share * last as f64).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}
