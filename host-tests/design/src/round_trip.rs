//! The round trip of a vehicle, flown and judged, and the one that it is to fly.

use anyhow::Context;

use super::{Design, Outcome, Performance, Trip, Verdict};
use alula_sim::experiment::{Document, Experiment};
use alula_sim::figures::Figures;
use alula_sim::simulate::{Record, fly};

/// A round trip, flown and judged.
pub(super) struct RoundTrip {
    pub experiment: Experiment,
    pub record: Record,
    pub figures: Figures,
    /// What the vehicle can do, but for the stop that is not flown.
    pub performance: Performance,
    pub verdict: Verdict,
}

impl RoundTrip {
    /// Of the vehicle of `design`, flown as `document` says.
    pub fn of(design: &Design, document: &Document) -> anyhow::Result<Self> {
        let experiment = document.checked()?;
        let name = &document.name;
        let record = fly(&experiment).with_context(|| format!("{name}: THE FIRST FLIGHT FAILS"))?;
        let figures = Figures::of(&experiment, &record);
        let facts = &design.facts;
        let performance = Performance::of(
            &experiment.vehicle,
            design.wing.stall_deg(),
            facts.thrust(),
            facts.cruise_m_s,
            design.parameters.max_lateral_acceleration.into(),
        );
        Ok(Self {
            verdict: Verdict::of(facts, &performance, &figures),
            experiment,
            record,
            figures,
            performance,
        })
    }
}

impl Design {
    /// What comes of its round trip.
    pub(super) fn tried(&self) -> anyhow::Result<Verdict> {
        Ok(RoundTrip::of(self, &self.document("trial")?)?.verdict)
    }

    /// The same with a round trip that it can fly: level if that does what is asked, else the first one that does, else the one that comes nearest.
    pub fn as_it_brakes(self) -> anyhow::Result<Self> {
        let mut nearest = (f64::INFINITY, Trip::LEVEL);
        for trip in [Trip::LEVEL].into_iter().chain(Trip::OTHERS) {
            let design = Self {
                trip,
                ..self.clone()
            };
            // One that comes to no number is not near.
            match design.tried() {
                Ok(verdict) if verdict.outcome == Outcome::AsAsked => return Ok(design),
                Ok(verdict) if verdict.worst < nearest.0 => nearest = (verdict.worst, trip),
                _ => {}
            }
        }
        Ok(Self {
            trip: nearest.1,
            ..self
        })
    }
}
