//! A flight of a campaign, in numbers: its figures, and samples of its course.

use super::{Drawn, Expected, FaultDraw};
use alula_sim::columns::declared;
use alula_sim::controllers::Answer;
use alula_sim::figures::{self, Tally};
use alula_sim::simulate::{End, Step, simulate};

/// Columns that are sampled over a flight.
pub const SAMPLED: [&str; 9] = [
    "altitude_m",
    "forward_m",
    "position_error_m",
    "velocity_error_m_s",
    "airspeed_m_s",
    "pitch_rad",
    "bank_rad",
    "load_factor",
    "thrust_to_weight",
];

/// Intervals between the samples of a flight's course.
const SAMPLES: usize = 100;

/// Time \[s\], and the values of [`SAMPLED`].
pub type Sample = (f32, [f32; SAMPLED.len()]);

/// A flight of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightResult {
    /// In the order of [`figures::FIGURES`].
    pub figures: Vec<f64>,
    /// Samples, equally spaced.
    pub samples: Vec<Sample>,
    /// Whether the fault ended in its stated states; true without a fault.
    pub fault_as_stated: bool,
    /// Whether the simulation diverged: then the figures say nothing.
    pub diverged: bool,
}

/// A fault, and when its states are looked at.
#[derive(Clone, Copy)]
struct Stated<'a> {
    fault: &'a FaultDraw,
    /// The number of its last step; none if it lasts beyond the flight.
    last: Option<usize>,
    /// The number of the flight's last step.
    end: usize,
}

/// What is asked at the steps of a flight: samples, and the stated states of a fault.
struct Asked<'a> {
    /// Seconds between samples.
    spacing: f64,
    samples: Vec<Sample>,
    stated: Option<Stated<'a>>,
    as_stated: bool,
    number: usize,
}

impl<'a> Asked<'a> {
    fn new(drawn: &Drawn, faults: &'a [FaultDraw], duration: f64) -> Self {
        let steps = drawn.experiment.steps();
        let stated = drawn.fault.map(|fault| Stated {
            fault: &faults[fault.index],
            last: fault.last_step(&drawn.experiment),
            end: steps,
        });
        Self {
            spacing: duration / SAMPLES as f64,
            samples: Vec::with_capacity(SAMPLES + 1),
            stated,
            as_stated: true,
            number: 0,
        }
    }

    /// A step, its sample if one is due, and the guidance's state.
    fn step(&mut self, step: &Step, sample: impl Fn() -> [f32; SAMPLED.len()]) {
        // A rounding error early rather than a step late.
        if step.t >= self.samples.len() as f64 * self.spacing - 1e-9 {
            self.samples.push((step.t as f32, sample()));
        }
        if let Some(Stated { fault, last, end }) = self.stated {
            if Some(self.number) == last {
                self.as_stated &= fault.during.holds(&step.answer);
            }
            if self.number == end {
                self.as_stated &= fault.after.holds(&step.answer);
            }
        }
        self.number += 1;
    }
}

/// A flight of a campaign.
#[derive(Clone, Debug)]
pub struct CampaignFlight {
    /// From 0 on.
    pub number: u64,
    /// What was drawn for it.
    pub drawn: Drawn,
    /// What came of it.
    pub result: FlightResult,
}

impl FlightResult {
    /// Flies `drawn`, of a campaign with these `faults`.
    pub fn fly(drawn: &Drawn, faults: &[FaultDraw]) -> anyhow::Result<Self> {
        let experiment = &drawn.experiment;
        let sampled = SAMPLED.map(declared);
        let mut tally = Tally::new(experiment);
        let mut asked = Asked::new(drawn, faults, experiment.duration_s);
        let end = simulate(experiment, experiment.controller()?.as_mut(), |step| {
            tally.add(step);
            asked.step(step, || {
                sampled.map(|column| column.number(experiment, step) as f32)
            });
            true
        })?;
        let mut result = Self {
            figures: tally.figures().values,
            samples: asked.samples,
            fault_as_stated: asked.as_stated,
            diverged: matches!(end, End::Diverged(_)),
        };
        let most = asked.stated.and_then(|stated| stated.fault.sinks_m);
        let sunk = -result.figure("altitude_least_m");
        result.fault_as_stated &= most.is_none_or(|most| sunk <= most);
        Ok(result)
    }

    /// The figure of this name, which must be one.
    pub fn figure(&self, name: &str) -> f64 {
        self.figures[figures::index(name).expect("a figure")]
    }
}

impl Expected {
    /// Whether the guidance is in the stated state; any other controller is in none.
    fn holds(&self, answer: &Answer) -> bool {
        let Some(guided) = answer.guided() else {
            return false;
        };
        let is = |expected: &Option<String>, name: &str| {
            expected.as_deref().is_none_or(|expected| expected == name)
        };
        let status = guided.status.to_string();
        let set = |flag: &String| status.split('|').any(|name| name == flag);
        is(&self.mode, guided.mode.name())
            && is(&self.air, guided.air.name())
            && self.status.iter().all(set)
            && !self.not_status.iter().any(set)
    }
}
