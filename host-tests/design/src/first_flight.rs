//! What a vehicle's files come to: its first flight, what it can do, its margins, and what is to be doubted.

use anyhow::Context;
use serde::Serialize;

use super::performance::stop;
use super::round_trip::RoundTrip;
use super::{Design, Performance, Trip, Verdict};
use alula_sim::experiment::{Document, Experiment};
use alula_sim::figures::Figures;
use alula_sim::margins::{Loop, Point};
use alula_sim::simulate::Record;

/// Speeds at which margins are looked at, in parts of cruise.
const MARGINS: [f64; 6] = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];

/// What a vehicle comes to.
#[derive(Clone, Debug)]
pub struct FirstFlight {
    /// The file that was flown.
    pub document: Document,
    /// The experiment that was flown.
    pub experiment: Experiment,
    /// Its steps.
    pub record: Record,
    /// Its figures.
    pub figures: Figures,
    /// What came of it, beside what else the vehicle can do.
    pub findings: Findings,
}

/// What is said of a vehicle and its first flight.
#[derive(Clone, Debug, Serialize)]
pub struct Findings {
    /// How it came about, in sentences.
    pub story: Vec<String>,
    /// What is to be doubted, in sentences.
    pub warnings: Vec<String>,
    /// What it can do.
    pub performance: Performance,
    /// Its margins in level flight, with its own lags.
    pub margins: Vec<Point>,
    /// What came of the first flight.
    pub verdict: Verdict,
}

impl FirstFlight {
    /// Of the vehicle of `design`, whose round trip came to this. What would mend it is flown, too.
    pub fn of(design: &Design, flown: RoundTrip) -> anyhow::Result<Self> {
        let RoundTrip {
            document,
            experiment,
            record,
            figures,
            mut performance,
            mut verdict,
        } = flown;
        let facts = &design.facts;
        performance.stop_m = stop(&document, facts.cruise_m_s)?;
        verdict.advice = design.remedies(verdict.outcome);
        let mut warnings = design.wing.warnings.clone();
        warnings.extend(performance.doubts(design));
        let mut story = design.wing.story.clone();
        if design.trip != Trip::LEVEL {
            story.push(format!(
                "Level braking at 2 m/s² is not as asked: the round trip goes there {}",
                design.trip.text(facts.cruise_m_s)
            ));
        }
        let findings = Findings {
            story,
            warnings,
            performance,
            margins: margins(&experiment, facts.cruise_m_s)?,
            verdict,
        };
        Ok(Self {
            document,
            experiment,
            record,
            figures,
            findings,
        })
    }
}

fn margins(experiment: &Experiment, cruise: f64) -> anyhow::Result<Vec<Point>> {
    let spec = experiment.spec()?;
    let gains = spec.gains(&experiment.vehicle).context("no gains")?;
    let vehicle = experiment.vehicle.reference();
    let of = Loop {
        vehicle,
        belief: vehicle,
        gains,
        actuators: experiment.plant,
    };
    Ok(MARGINS
        .iter()
        .flat_map(|part| of.at(part * cruise))
        .collect())
}
