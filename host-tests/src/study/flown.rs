//! A flight of a campaign, in numbers: its figures, and samples of its course.

use super::{Drawn, Expected, FaultDraw};
use crate::columns::{self, column};
use crate::experiment::Experiment;
use crate::figures::Tally;
use crate::simulate::{End, Step, simulate};

/// The columns of the record whose course is sampled.
pub const SAMPLED: [&str; 6] = [
    "altitude_m",
    "forward_m",
    "true_v_forward_m_s",
    "velocity_error_m_s",
    "true_theta_rad",
    "thrust_to_weight",
];

/// Intervals between the samples of a flight's course.
const SAMPLES: usize = 100;

/// Time \[s\], and the values of [`SAMPLED`].
pub type Sample = (f32, [f32; SAMPLED.len()]);

/// A flight of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Flown {
    /// In the order of [`crate::figures::FIGURES`].
    pub figures: Vec<f64>,
    /// Samples, equally spaced.
    pub samples: Vec<Sample>,
    /// Whether the fault ended in its stated states; true without a fault.
    pub fault_as_stated: bool,
    /// Whether the simulation diverged: then the figures say nothing.
    pub diverged: bool,
}

impl Flown {
    /// Flies what was drawn; `faults` are the campaign's.
    pub fn fly(drawn: &Drawn, faults: &[FaultDraw]) -> anyhow::Result<Self> {
        let experiment = &drawn.experiment;
        let steps = experiment.steps();
        let spacing = experiment.duration_s / SAMPLES as f64;
        let fault_ends = drawn.fault.and_then(|fault| fault.last_step(experiment));
        let sampled = SAMPLED.map(|name| column(name).expect("a column"));
        let mut tally = Tally::new(experiment);
        let mut samples = Vec::with_capacity(SAMPLES + 1);
        let mut fault_as_stated = true;
        let mut number = 0;
        let end = simulate(experiment, experiment.controller()?.as_mut(), |step| {
            tally.add(step);
            // A rounding error early rather than a step late.
            if step.t >= samples.len() as f64 * spacing - 1e-9 {
                samples.push((step.t as f32, sample(experiment, step, &sampled)));
            }
            if let Some(fault) = drawn.fault {
                let stated = &faults[fault.index];
                if Some(number) == fault_ends {
                    fault_as_stated &= stated.during.holds(step);
                }
                if number == steps {
                    fault_as_stated &= stated.after.holds(step);
                }
            }
            number += 1;
            true
        })?;
        let figures = tally.figures();
        let sunk = -figures.get("altitude_least_m");
        let stated = drawn.fault.and_then(|fault| faults[fault.index].sinks_m);
        fault_as_stated &= stated.is_none_or(|most| sunk <= most);
        Ok(Self {
            figures: figures.values,
            samples,
            fault_as_stated,
            diverged: matches!(end, End::Diverged(_)),
        })
    }
}

fn sample<const N: usize>(
    experiment: &Experiment,
    step: &Step,
    columns: &[&columns::Column; N],
) -> [f32; N] {
    columns.map(|column| column.number(experiment, step) as f32)
}

impl Expected {
    /// Whether the guidance that flew `step` was in this state.
    fn holds(&self, step: &Step) -> bool {
        let Some(guided) = step.answer.guided() else {
            return false;
        };
        let is = |expected: &Option<String>, name: Option<&str>| {
            expected.is_none() || expected.as_deref() == name
        };
        let flags = guided.status.to_string();
        let set = |flag: &String| flags.split('|').any(|name| name == flag);
        is(&self.mode, step.answer.mode())
            && is(&self.air, step.answer.air())
            && self.status.iter().all(set)
            && !self.not_status.iter().any(set)
    }
}
