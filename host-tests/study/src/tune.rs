//! The search for the constants of planner and reference model: [`Tuning`].
//!
//! The objective is the mean, over flights of campaigns that no report shows, of what each cost: figures over their scales. The
//! same flights are flown for every trial, so that two trials differ by their constants alone.

use alula::{Parameters as _, Tuning};
use alula_sim::experiment::{Document, file_name};
use alula_sim::figures;
use anyhow::{Context as _, ensure};
use nalgebra::DVector;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use serde::Deserialize;

use super::evolution::Evolution;
use super::{CampaignSource, Drawn, FaultDraw, FlightResult, Limit, Threads, each};

/// What is flown, and what it costs.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Objective {
    /// What it is for.
    pub description: String,
    /// Seed of the search.
    pub seed: u64,
    /// Number of trials.
    pub trials: usize,
    /// The flights.
    pub flights: Vec<Flights>,
}

/// Flights of a campaign.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flights {
    /// The campaign.
    pub campaign: String,
    /// The first flight's number: beyond those that are reported.
    pub first: u64,
    /// How many.
    pub count: u64,
    /// What each costs.
    pub costs: Vec<Cost>,
}

/// A figure that costs.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Its name.
    pub figure: String,
    /// What costs one: of this sign, and in proportion.
    pub one: f64,
    /// What it costs at most, as where the flight is lost.
    pub most: f64,
}

/// A flight that is flown for every trial.
struct Scenario {
    document: Document,
    drawn: Drawn,
    faults: Vec<FaultDraw>,
    costs: Vec<(usize, Cost)>,
    limits: Vec<Limit>,
    /// Which of the groups it is of, and its share of that.
    group: usize,
    share: f64,
}

/// The flights of an objective.
pub struct Tuner {
    scenarios: Vec<Scenario>,
    groups: Vec<String>,
    threads: Threads,
}

/// A trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The constants.
    pub tuning: Tuning,
    /// The mean cost of each group of flights.
    pub costs: Vec<f64>,
    /// Flights outside a limit of their campaign.
    pub outside: usize,
}

impl Trial {
    /// The objective: the mean of the groups.
    pub fn objective(&self) -> f64 {
        self.costs.iter().sum::<f64>() / self.costs.len() as f64
    }
}

/// By what each constant is multiplied.
pub const FACTORS: [f32; 6] = [0.5, 0.75, 0.9, 1.1, 1.25, 1.5];

impl Cost {
    /// The cost of a figure. Of one that is no number it is all.
    fn of(&self, figure: f64) -> f64 {
        let cost = figure / self.one;
        if cost.is_nan() {
            self.most
        } else {
            cost.clamp(0.0, self.most)
        }
    }
}

impl Tuner {
    /// The tuner of an `objective`.
    pub fn new(objective: &Objective, threads: Threads) -> anyhow::Result<Self> {
        let mut scenarios = Vec::new();
        for (group, flights) in objective.flights.iter().enumerate() {
            let source = CampaignSource::load(&flights.campaign, None)?;
            let costs = flights.costs.iter().map(|cost| {
                let index = figures::index(&cost.figure)
                    .with_context(|| format!("{}: no figure", cost.figure))?;
                ensure!(
                    cost.one != 0.0 && cost.most > 0.0,
                    "{}: one and most",
                    cost.figure
                );
                Ok((index, cost.clone()))
            });
            let costs: Vec<_> = costs.collect::<anyhow::Result<_>>()?;
            for number in flights.first..flights.first + flights.count {
                let drawn = source.campaign.draw(&source.base, number)?;
                scenarios.push(Scenario {
                    document: drawn.document.clone(),
                    drawn,
                    faults: source.campaign.faults.clone(),
                    costs: costs.clone(),
                    limits: source.campaign.limits.clone(),
                    group,
                    share: 1.0 / flights.count as f64,
                });
            }
        }
        let groups = objective.flights.iter();
        Ok(Self {
            scenarios,
            groups: groups.map(|flights| flights.campaign.clone()).collect(),
            threads,
        })
    }

    /// How many flights each trial has.
    pub fn flights(&self) -> usize {
        self.scenarios.len()
    }

    /// The campaigns of the groups.
    pub fn groups(&self) -> &[String] {
        &self.groups
    }

    /// What each of `tunings` costs.
    pub fn trials(&self, tunings: &[Tuning]) -> anyhow::Result<Vec<Trial>> {
        let flights: Vec<(usize, &Scenario)> = (0..tunings.len())
            .flat_map(|n| self.scenarios.iter().map(move |scenario| (n, scenario)))
            .collect();
        let flown = each(&flights, self.threads, |(n, scenario)| {
            scenario.fly(&tunings[*n])
        })?;
        let trials = tunings.iter().zip(flown.chunks(self.scenarios.len()));
        let trials = trials.map(|(tuning, flights)| {
            let mut costs = vec![0.0; self.groups.len()];
            for (scenario, (cost, _)) in self.scenarios.iter().zip(flights) {
                costs[scenario.group] += scenario.share * cost;
            }
            Trial {
                tuning: *tuning,
                costs,
                outside: flights.iter().filter(|(_, outside)| *outside).count(),
            }
        });
        Ok(trials.collect())
    }

    /// Searches from nothing: from the middle of every range, on a logarithmic scale. `see` is told of the best trial after each generation.
    pub fn search(
        &self,
        objective: &Objective,
        mut see: impl FnMut(usize, &Trial) -> anyhow::Result<()>,
    ) -> anyhow::Result<Trial> {
        let mut random = ChaCha8Rng::seed_from_u64(objective.seed);
        let middle = DVector::repeat(Tuning::ROWS.len(), 0.5);
        let mut evolution = Evolution::new(middle, 0.25, None);
        let mut best: Option<Trial> = None;
        let mut trials_so_far = 0;
        while trials_so_far < objective.trials {
            let points = evolution.points(&mut random);
            let tunings: Vec<Tuning> = points.iter().map(tuning).collect();
            let trials = self.trials(&tunings)?;
            trials_so_far += trials.len();
            // What is out of its range is flown at the border, and costs a little more: the search stays inside.
            let values = points.iter().zip(&trials).map(|(point, trial)| {
                let beyond = point.map(|x| (x - x.clamp(0.0, 1.0)).powi(2));
                trial.objective() + beyond.sum()
            });
            evolution.learn(&points, &values.collect::<Vec<_>>());
            best = best.into_iter().chain(trials).min_by(least);
            if let Some(best) = &best {
                see(trials_so_far, best)?;
            }
        }
        // The middle of the distribution owes less to chance than the best trial.
        let middle = self.trials(&[tuning(evolution.mean())])?;
        let cheapest = best.into_iter().chain(middle).min_by(least);
        cheapest.context("trials: at least one")
    }

    /// Trials of `tuning` with the constant of a `row` times each of [`FACTORS`].
    pub fn changed(&self, tuning: &Tuning, row: usize) -> anyhow::Result<Vec<Trial>> {
        let range = Tuning::RANGES.get(row).context("a row of the table")?;
        let tunings = FACTORS.map(|factor| {
            let mut changed = *tuning;
            changed.set(row, (factor * tuning.get(row)).clamp(range.min, range.max));
            changed
        });
        self.trials(&tunings)
    }
}

fn least(a: &Trial, b: &Trial) -> std::cmp::Ordering {
    a.objective().total_cmp(&b.objective())
}

impl Scenario {
    /// What it costs with this `tuning`, and whether it is outside a limit of its campaign.
    fn fly(&self, tuning: &Tuning) -> anyhow::Result<(f64, bool)> {
        let mut document = self.document.clone();
        for (i, row) in Tuning::ROWS.iter().enumerate() {
            let value = f64::from(tuning.get(i));
            let value = if row.unit == "rad" {
                value.to_degrees()
            } else {
                value
            };
            document.assign(&format!(
                "controller.guidance.tuning.{}={value:?}",
                file_name(row)
            ))?;
        }
        let drawn = Drawn {
            experiment: document.checked()?,
            document,
            ..self.drawn.clone()
        };
        let result = FlightResult::fly(&drawn, &self.faults)?;
        let costs = self.costs.iter();
        let cost = costs.map(|(i, cost)| cost.of(result.figures[*i])).sum();
        let outside = |limit: &Limit| limit.excess(result.figure(&limit.figure)) > 0.0;
        Ok((cost, result.diverged || self.limits.iter().any(outside)))
    }
}

/// The constants at a point: 0 to 1 is each range, on a logarithmic scale.
fn tuning(point: &DVector<f64>) -> Tuning {
    let mut tuning = Tuning::default();
    for (i, (range, x)) in Tuning::RANGES.iter().zip(point).enumerate() {
        let (min, max) = (f64::from(range.min), f64::from(range.max));
        let value = min * (max / min).powf(x.clamp(0.0, 1.0));
        tuning.set(i, (value as f32).clamp(range.min, range.max));
    }
    tuning
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One flight of a campaign, which keeps its limits.
    fn tuner() -> Tuner {
        let text = "description = ''\nseed = 1\ntrials = 1\n\
                    [[flights]]\ncampaign = 'upsets'\nfirst = 1000000\ncount = 1\n\
                    costs = [{ figure = 'altitude_least_m', one = -10.0, most = 10.0 }]";
        Tuner::new(&toml::from_str(text).unwrap(), None).unwrap()
    }

    /// One constant is changed, and all others stay; what it is multiplied by stays inside its range.
    #[test]
    fn one_constant_is_changed_by_itself() {
        let (tuner, mut tuning) = (tuner(), Tuning::default());
        let row = Tuning::ROWS.iter().position(|row| row.name == "hysteresis");
        let row = row.unwrap();
        tuning.set(row, 0.6);
        let trials = tuner.changed(&tuning, row).unwrap();
        let expected = [0.3, 0.45, 0.54, 0.66, 0.7, 0.7];
        for (trial, expected) in trials.iter().zip(expected) {
            // 1e-6: single precision.
            assert!((trial.tuning.hysteresis - expected).abs() < 1e-6);
            let mut others = trial.tuning;
            others.set(row, 0.6);
            assert_eq!(others, tuning);
        }
        assert_eq!(trials.len(), expected.len());
    }

    #[test]
    fn flights_outside_a_limit_are_counted() {
        let mut tuner = tuner();
        let outside = |tuner: &Tuner| tuner.trials(&[Tuning::default()]).unwrap()[0].outside;
        assert_eq!(outside(&tuner), 0);
        for limit in &mut tuner.scenarios[0].limits {
            limit.least = Some(1e6);
        }
        assert_eq!(outside(&tuner), 1);
    }
}
