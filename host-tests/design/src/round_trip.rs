//! The round trip of a vehicle, flown and judged, and the one that it is to fly.

use anyhow::Context;

use super::{Design, Outcome, Performance, Trip, Verdict};
use alula_sim::experiment::{Document, Experiment};
use alula_sim::figures::Figures;
use alula_sim::simulate::{Record, fly};

/// A round trip, flown and judged.
pub struct RoundTrip {
    pub(super) document: Document,
    pub(super) experiment: Experiment,
    pub(super) record: Record,
    pub(super) figures: Figures,
    /// What the vehicle can do, but for the stop that is not flown.
    pub(super) performance: Performance,
    pub(super) verdict: Verdict,
}

impl RoundTrip {
    /// Of the vehicle of `design`, as the file of this name flies it.
    ///
    /// # Errors
    /// A file that cannot be flown, or a flight that comes to no number.
    pub fn of(design: &Design, name: &str) -> anyhow::Result<Self> {
        let document = design.document(name)?;
        let experiment = document.checked()?;
        let record = fly(&experiment).with_context(|| format!("{name}: THE FIRST FLIGHT FAILS"))?;
        let figures = Figures::of(&experiment, &record);
        let facts = &design.facts;
        let performance = design.performance();
        Ok(Self {
            verdict: Verdict::of(facts, &performance, &figures),
            document,
            experiment,
            record,
            figures,
            performance,
        })
    }

    /// What came of it.
    pub fn outcome(&self) -> Outcome {
        self.verdict.outcome
    }
}

impl Design {
    /// What comes of its round trip.
    pub(super) fn tried(&self) -> anyhow::Result<Verdict> {
        Ok(RoundTrip::of(self, "trial")?.verdict)
    }

    /// The same with a round trip that it can fly, which is its first flight: level if that does what is asked, else the first one that does, else
    /// the one that comes nearest. Each is flown as the file of this name has it. Where none comes to a number, the flight is the error of the level one.
    pub fn as_it_brakes(self, name: &str) -> (Self, anyhow::Result<RoundTrip>) {
        let design = |trip| Self {
            trip,
            ..self.clone()
        };
        let mut nearest: Option<(f64, Trip, anyhow::Result<RoundTrip>)> = None;
        for trip in [Trip::LEVEL].into_iter().chain(Trip::OTHERS) {
            let flown = RoundTrip::of(&design(trip), name);
            let (done, worst) = match &flown {
                Ok(flown) => {
                    let verdict = &flown.verdict;
                    // One that comes to no number is not near.
                    let worst = Some(verdict.worst).filter(|worst| worst.is_finite());
                    (
                        verdict.outcome == Outcome::AsAsked,
                        worst.unwrap_or(f64::INFINITY),
                    )
                }
                Err(_) => (false, f64::INFINITY),
            };
            if done {
                return (design(trip), flown);
            }
            if nearest.as_ref().is_none_or(|(least, ..)| worst < *least) {
                nearest = Some((worst, trip, flown));
            }
        }
        let (_, trip, flown) = nearest.expect("one is tried");
        (design(trip), flown)
    }
}
