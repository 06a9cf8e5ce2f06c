//! A flight of a campaign, in numbers: its figures, and samples of its course.

use super::place::{Experiment, SAMPLED};
use super::{Drawn, Expected, FaultDraw, Place};
use alula_sim::columns::Flight;
use alula_sim::experiment;
use alula_sim::figures::Tally;
use alula_sim::simulate::{End, simulate};
use alula_sim::space;

/// Intervals between the samples of a flight's course.
const SAMPLES: usize = 100;

/// Time \[s\], and the values of [`Place::sampled`].
pub type Sample = (f32, [f32; SAMPLED]);

/// A flight of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Flown {
    /// Where it was flown.
    pub place: Place,
    /// In the order of [`Place::figures`].
    pub figures: Vec<f64>,
    /// Samples, equally spaced.
    pub samples: Vec<Sample>,
    /// Whether the fault ended in its stated states; true without a fault.
    pub fault_as_stated: bool,
    /// Whether the simulation diverged: then the figures say nothing.
    pub diverged: bool,
}

/// What is asked at the steps of a flight: samples, and the stated states of a fault.
struct Asked<'a> {
    /// Seconds between samples.
    spacing: f64,
    samples: Vec<Sample>,
    /// The fault, the number of its last step, and that of the flight's.
    stated: Option<(&'a FaultDraw, Option<usize>, usize)>,
    as_stated: bool,
    number: usize,
}

impl<'a> Asked<'a> {
    fn new(drawn: &Drawn, faults: &'a [FaultDraw], duration: f64) -> Self {
        let (steps, _) = drawn.experiment.steps();
        let stated = drawn.fault.map(|fault| {
            let last = fault.last_step(&drawn.experiment);
            (&faults[fault.index], last, steps)
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
    fn step(&mut self, t: f64, sample: impl Fn() -> [f32; SAMPLED], state: Option<&State>) {
        // A rounding error early rather than a step late.
        if t >= self.samples.len() as f64 * self.spacing - 1e-9 {
            self.samples.push((t as f32, sample()));
        }
        if let Some((stated, last, steps)) = self.stated {
            let holds = |expected: &Expected| state.is_some_and(|state| expected.holds(state));
            if Some(self.number) == last {
                self.as_stated &= holds(&stated.during);
            }
            if self.number == steps {
                self.as_stated &= holds(&stated.after);
            }
        }
        self.number += 1;
    }

    fn flown(self, place: Place, figures: Vec<f64>, diverged: bool) -> Flown {
        let mut flown = Flown {
            place,
            figures,
            samples: self.samples,
            fault_as_stated: self.as_stated,
            diverged,
        };
        let most = self.stated.and_then(|(stated, ..)| stated.sinks_m);
        let sunk = -flown.figure("altitude_least_m");
        flown.fault_as_stated &= most.is_none_or(|most| sunk <= most);
        flown
    }
}

/// Mode, air and flags of the guidance, by their names in a trace.
struct State {
    mode: &'static str,
    air: &'static str,
    status: String,
}

impl Flown {
    /// Flies what was drawn; `faults` are the campaign's.
    pub fn fly(drawn: &Drawn, faults: &[FaultDraw]) -> anyhow::Result<Self> {
        match &drawn.experiment {
            Experiment::Plane(experiment) => Self::in_plane(experiment, drawn, faults),
            Experiment::Space(experiment) => Self::in_space(experiment, drawn, faults),
        }
    }

    /// A figure, which must be one.
    pub fn figure(&self, name: &str) -> f64 {
        self.figures[self.place.figure(name).expect("a figure")]
    }

    fn in_plane(
        experiment: &experiment::Experiment,
        drawn: &Drawn,
        faults: &[FaultDraw],
    ) -> anyhow::Result<Self> {
        let sampled = Place::Plane.sampled().map(experiment::Experiment::declared);
        let mut tally = Tally::new(experiment);
        let mut asked = Asked::new(drawn, faults, experiment.duration_s);
        let end = simulate(experiment, experiment.controller()?.as_mut(), |step| {
            tally.add(step);
            let sample = || sampled.map(|column| column.number(experiment, step) as f32);
            let state = step.answer.guided().map(|guided| State {
                mode: guided.mode.name(),
                air: guided.air.name(),
                status: guided.status.to_string(),
            });
            asked.step(step.t, sample, state.as_ref());
            true
        })?;
        let diverged = matches!(end, End::Diverged(_));
        Ok(asked.flown(Place::Plane, tally.figures().values, diverged))
    }

    fn in_space(
        experiment: &space::Experiment,
        drawn: &Drawn,
        faults: &[FaultDraw],
    ) -> anyhow::Result<Self> {
        let sampled = Place::Space.sampled().map(space::Experiment::declared);
        let record = space::fly(experiment)?;
        let mut asked = Asked::new(drawn, faults, experiment.duration_s);
        for step in &record {
            let sample = || sampled.map(|column| column.number(experiment, step) as f32);
            let state = State {
                mode: step.guided.mode.name(),
                air: step.guided.air.name(),
                status: step.guided.status.to_string(),
            };
            asked.step(step.t, sample, Some(&state));
        }
        let figures = space::Figures::of(experiment, &record).values;
        let diverged = record
            .iter()
            .any(|step| !step.truth.velocity.norm().is_finite());
        Ok(asked.flown(Place::Space, figures, diverged))
    }
}

impl Expected {
    /// Whether the guidance was in this state.
    fn holds(&self, state: &State) -> bool {
        let is = |expected: &Option<String>, name: &str| {
            expected.as_deref().is_none_or(|expected| expected == name)
        };
        let set = |flag: &String| state.status.split('|').any(|name| name == flag);
        is(&self.mode, state.mode)
            && is(&self.air, state.air)
            && self.status.iter().all(set)
            && !self.not_status.iter().any(set)
    }
}
