//! What a campaign found. The parts pass by one after the other, in order: memory does not grow with the flights.

use anyhow::Context;
use serde::Serialize;
use sketches_ddsketch::{Config, DDSketch};

use super::{CampaignSource, Frame, MapResult, SAMPLED};
use alula_sim::figures::FIGURES;

/// The percentiles that are given of every figure.
pub const PERCENTILES: [f64; 9] = [0.0, 1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0, 100.0];

/// Flights listed of each limit.
const WORST: usize = 5;

/// What a campaign found.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Flights.
    pub flights: u64,
    /// Flights that keep every limit.
    pub passed: u64,
    /// Flights that departed.
    pub departed: u64,
    /// Flights whose simulation diverged.
    pub diverged: u64,
    /// Flights that keep every limit and yet were lost: what is asked of them does not say how far they may sink.
    pub passed_yet_lost: u64,
    /// By limit.
    pub limits: Vec<LimitResult>,
    /// By fault of the campaign.
    pub faults: Vec<FaultFound>,
    /// By figure.
    pub figures: Vec<FigureFound>,
    /// By dispersed field.
    pub dispersions: Vec<DispersionFound>,
    /// The campaign's maps.
    pub maps: Vec<MapResult>,
    /// By sampled column.
    #[serde(skip)]
    pub fans: Vec<Fan>,
}

/// How a limit was kept.
#[derive(Clone, Debug, Serialize)]
pub struct LimitResult {
    /// Its figure.
    pub figure: &'static str,
    /// Its bounds.
    pub least: Option<f64>,
    /// Its bounds.
    pub most: Option<f64>,
    /// Share of the flights that must be inside.
    pub share_required: f64,
    /// Share of the flights that are.
    pub share: f64,
    /// Whether these are enough.
    pub kept: bool,
    /// Whether a flight outside has departed.
    pub departure: bool,
    /// The flights farthest out, or nearest to be.
    pub worst: Vec<Worst>,
}

/// A flight to look at.
#[derive(Clone, Debug, Serialize)]
pub struct Worst {
    /// Its number.
    pub flight: i64,
    /// Its figure.
    pub value: f64,
    /// The command that flies it again.
    pub command: String,
    #[serde(skip)]
    excess: f64,
}

/// How a fault ended.
#[derive(Clone, Debug, Serialize)]
pub struct FaultFound {
    /// What failed.
    pub kind: alula_sim::experiment::FaultKind,
    /// The state at its end that is stated.
    pub during: String,
    /// Flights that drew it.
    pub flights: u64,
    /// Of these, those that were in the stated states.
    pub as_stated: u64,
    /// Least altitude over the reference of them all \[m\].
    pub least_m: f64,
    /// The first of the others.
    pub others: Vec<i64>,
}

/// A figure over all flights.
#[derive(Clone, Debug, Serialize)]
pub struct FigureFound {
    /// Its name.
    pub figure: &'static str,
    /// At [`PERCENTILES`], to half a percent; the extremes are exact.
    pub percentiles: [f64; PERCENTILES.len()],
    /// Flights in which it is not finite, and left out above.
    pub not_finite: u64,
}

/// A dispersed field over all flights.
#[derive(Clone, Debug, Serialize)]
pub struct DispersionFound {
    /// Its dotted path.
    pub field: String,
    /// Least value drawn.
    pub least: f64,
    /// Greatest value drawn.
    pub most: f64,
    /// Linear correlation with the figure of each limit, in their order.
    pub correlations: Vec<f64>,
}

/// Percentiles of a sampled column over time.
#[derive(Clone, Debug)]
pub struct Fan {
    /// The column.
    pub column: &'static str,
    /// Time \[s\], and the values at [`PERCENTILES`].
    pub points: Vec<(f64, [f64; PERCENTILES.len()])>,
}

/// Relative accuracy of percentiles, and the value under which all is zero.
const ACCURACY: (f64, f64) = (0.005, 1e-3);

fn sketch() -> DDSketch {
    DDSketch::new(Config::new(ACCURACY.0, 2048, ACCURACY.1))
}

fn percentiles(sketch: &DDSketch) -> [f64; PERCENTILES.len()] {
    PERCENTILES.map(|p| {
        let quantile = sketch.quantile(p / 100.0).expect("from 0 to 1");
        // Within a bin, but not beyond what was seen.
        let range = (sketch.min(), sketch.max());
        match (quantile, range) {
            (Some(q), (Some(min), Some(max))) => q.clamp(min, max),
            _ => f64::NAN,
        }
    })
}

/// Running linear correlation of pairs (Welford's updates).
#[derive(Clone, Copy, Default)]
struct Correlation {
    n: f64,
    mean: [f64; 2],
    squares: [f64; 2],
    product: f64,
}

impl Correlation {
    fn add(&mut self, x: f64, y: f64) {
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        self.n += 1.0;
        let before = [x - self.mean[0], y - self.mean[1]];
        self.mean[0] += before[0] / self.n;
        self.mean[1] += before[1] / self.n;
        let after = [x - self.mean[0], y - self.mean[1]];
        self.squares[0] += before[0] * after[0];
        self.squares[1] += before[1] * after[1];
        self.product += before[0] * after[1];
    }

    fn value(&self) -> f64 {
        let scale = (self.squares[0] * self.squares[1]).sqrt();
        if scale > 0.0 {
            self.product / scale
        } else {
            0.0
        }
    }
}

impl Summary {
    /// What the `parts` of a campaign say: flights and samples of each chunk, in their order.
    pub fn of_parts(
        source: &CampaignSource,
        parts: impl Iterator<Item = anyhow::Result<(Frame, Frame)>>,
    ) -> anyhow::Result<Self> {
        let mut gathered = Gathered::new(source);
        for (chunk, part) in (0..).zip(parts) {
            let (flights, samples) = part?;
            let range = source.campaign.chunk(chunk);
            let expected: Vec<i64> = range.map(|n| n as i64).collect();
            anyhow::ensure!(
                flights.integer("flight")? == expected,
                "part {chunk} holds other flights"
            );
            gathered.flights(&flights)?;
            gathered.samples(&samples)?;
        }
        Ok(gathered.finish())
    }

    /// Whether every limit is kept, no flight departed or diverged, and every fault ended as stated.
    pub fn verdict(&self) -> bool {
        self.departed == 0
            && self.diverged == 0
            && self.limits.iter().all(|limit| limit.kept)
            && self.faults.iter().all(|f| f.as_stated == f.flights)
    }
}

struct Gathered<'a> {
    source: &'a CampaignSource,
    summary: Summary,
    figures: Vec<DDSketch>,
    inside: Vec<u64>,
    correlations: Vec<Vec<Correlation>>,
    /// By time, and sampled column.
    fans: Vec<(f64, Vec<DDSketch>)>,
}

impl<'a> Gathered<'a> {
    fn new(source: &'a CampaignSource) -> Self {
        let campaign = &source.campaign;
        let names: Vec<&str> = FIGURES.iter().map(|figure| figure.name).collect();
        let name = |limit: &super::Limit| {
            let name = names.iter().find(|name| **name == limit.figure);
            *name.expect("validated when loaded")
        };
        let limit = |limit: &super::Limit| LimitResult {
            figure: name(limit),
            least: limit.least,
            most: limit.most,
            share_required: limit.share,
            share: 0.0,
            kept: false,
            departure: limit.departure,
            worst: Vec::new(),
        };
        Self {
            source,
            summary: Summary {
                flights: campaign.flights,
                passed: 0,
                departed: 0,
                diverged: 0,
                passed_yet_lost: 0,
                limits: campaign.limits.iter().map(limit).collect(),
                faults: campaign
                    .faults
                    .iter()
                    .map(|fault| FaultFound {
                        kind: fault.kind,
                        during: fault.during.to_string(),
                        flights: 0,
                        as_stated: 0,
                        least_m: f64::INFINITY,
                        others: Vec::new(),
                    })
                    .collect(),
                figures: names
                    .iter()
                    .map(|figure| FigureFound {
                        figure,
                        percentiles: [f64::NAN; PERCENTILES.len()],
                        not_finite: 0,
                    })
                    .collect(),
                dispersions: campaign
                    .disperse
                    .iter()
                    .map(|dispersion| DispersionFound {
                        field: dispersion.field.clone(),
                        least: f64::INFINITY,
                        most: f64::NEG_INFINITY,
                        correlations: Vec::new(),
                    })
                    .collect(),
                maps: campaign.maps.iter().map(MapResult::new).collect(),
                fans: Vec::new(),
            },
            figures: vec![sketch(); names.len()],
            inside: vec![0; campaign.limits.len()],
            correlations: vec![
                vec![Correlation::default(); campaign.limits.len()];
                campaign.disperse.len()
            ],
            fans: Vec::new(),
        }
    }

    fn flights(&mut self, frame: &Frame) -> anyhow::Result<()> {
        let numbers = frame.integer("flight")?;
        let count = |flags: &[bool]| flags.iter().filter(|&&flag| flag).count() as u64;
        self.summary.passed += count(frame.flag("passed")?);
        let both = frame.flag("passed")?.iter().zip(frame.real("lost")?);
        let lost = both
            .filter(|&(&passed, &lost)| passed && lost != 0.0)
            .count();
        self.summary.passed_yet_lost += lost as u64;
        self.summary.departed += count(frame.flag("departed")?);
        self.summary.diverged += count(frame.flag("diverged")?);
        for (summary, sketch) in self.summary.figures.iter_mut().zip(&mut self.figures) {
            for &value in frame.real(summary.figure)? {
                if value.is_finite() {
                    sketch.add(value);
                } else {
                    summary.not_finite += 1;
                }
            }
        }
        let limits = &self.source.campaign.limits;
        let summaries = self.summary.limits.iter_mut().zip(&mut self.inside);
        for (limit, (summary, inside)) in limits.iter().zip(summaries) {
            for (&flight, &value) in numbers.iter().zip(frame.real(summary.figure)?) {
                let excess = limit.excess(value);
                *inside += u64::from(excess <= 0.0);
                let place = summary.worst.partition_point(|w| w.excess >= excess);
                if place < WORST {
                    let worst = Worst {
                        flight,
                        value,
                        command: self.source.refly(flight as u64),
                        excess,
                    };
                    summary.worst.insert(place, worst);
                    summary.worst.truncate(WORST);
                }
            }
        }
        let dispersions = self.summary.dispersions.iter_mut();
        for (summary, correlations) in dispersions.zip(&mut self.correlations) {
            let values = frame.real(&summary.field)?;
            summary.least = values.iter().copied().fold(summary.least, f64::min);
            summary.most = values.iter().copied().fold(summary.most, f64::max);
            for (limit, correlation) in self.summary.limits.iter().zip(correlations) {
                for (&x, &y) in values.iter().zip(frame.real(limit.figure)?) {
                    correlation.add(x, y);
                }
            }
        }
        for map in &mut self.summary.maps {
            map.add(frame)?;
        }
        if !self.summary.faults.is_empty() {
            let faults = frame.integer("fault")?.iter();
            let as_stated = frame.flag("fault_as_stated")?;
            let altitudes = frame.real("altitude_least_m")?;
            let flights = faults.zip(as_stated).zip(altitudes).zip(numbers);
            for (((&fault, &as_stated), &altitude), &flight) in flights {
                let fault = usize::try_from(fault).context("a flight without a fault")?;
                let summary = &mut self.summary.faults[fault];
                summary.flights += 1;
                summary.least_m = summary.least_m.min(altitude);
                summary.as_stated += u64::from(as_stated);
                if !as_stated && summary.others.len() < WORST {
                    summary.others.push(flight);
                }
            }
        }
        Ok(())
    }

    fn samples(&mut self, frame: &Frame) -> anyhow::Result<()> {
        let numbers = frame.integer("flight")?;
        let times = frame.single("t_s")?;
        let columns = SAMPLED.map(|name| frame.single(name));
        let mut place = 0;
        for row in 0..frame.rows() {
            place = match row {
                0 => 0,
                _ if numbers[row] != numbers[row - 1] => 0,
                _ => place + 1,
            };
            if place == self.fans.len() {
                let time = f64::from(times[row]);
                self.fans.push((time, vec![sketch(); SAMPLED.len()]));
            }
            for (values, sketch) in columns.iter().zip(&mut self.fans[place].1) {
                let value = match values {
                    Ok(values) => f64::from(values[row]),
                    Err(error) => anyhow::bail!("{error}"),
                };
                if value.is_finite() {
                    sketch.add(value);
                }
            }
        }
        Ok(())
    }

    fn finish(mut self) -> Summary {
        let flights = self.summary.flights as f64;
        for (summary, sketch) in self.summary.figures.iter_mut().zip(&self.figures) {
            summary.percentiles = percentiles(sketch);
        }
        for (summary, inside) in self.summary.limits.iter_mut().zip(&self.inside) {
            summary.share = *inside as f64 / flights;
            summary.kept = summary.share >= summary.share_required;
        }
        let dispersions = self.summary.dispersions.iter_mut();
        for (summary, correlations) in dispersions.zip(&self.correlations) {
            summary.correlations = correlations.iter().map(Correlation::value).collect();
        }
        for (i, column) in SAMPLED.into_iter().enumerate() {
            let at = |(t, sketches): &(f64, Vec<DDSketch>)| (*t, percentiles(&sketches[i]));
            // A column that applies to none of the flights has no values.
            if self
                .fans
                .iter()
                .any(|(_, sketches)| sketches[i].count() > 0)
            {
                self.summary.fans.push(Fan {
                    column,
                    points: self.fans.iter().map(at).collect(),
                });
            }
        }
        self.summary
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half a percent of relative accuracy, on both sides of zero, against the sorted values.
    #[test]
    fn percentiles_are_within_half_a_percent() {
        let value = |i: i32| (f64::from(i) / 1000.0 - 3.0).powi(3);
        let mut sketch = sketch();
        (0..=10_000).for_each(|i| sketch.add(value(i)));
        let estimates = percentiles(&sketch);
        for (p, estimate) in PERCENTILES.iter().zip(estimates) {
            let exact = value((p * 100.0) as i32);
            // One rank more or less, and the sketch's bin.
            let tolerance = 0.0051 * exact.abs() + 0.03;
            assert!(
                (estimate - exact).abs() < tolerance,
                "{p}: {estimate} {exact}"
            );
        }
        assert_eq!((estimates[0], estimates[8]), (-27.0, 343.0));
    }

    #[test]
    fn correlation_is_the_textbooks() {
        let of = |y: &dyn Fn(f64) -> f64| {
            let mut correlation = Correlation::default();
            (0..100).for_each(|i| correlation.add(f64::from(i), y(f64::from(i))));
            correlation.value()
        };
        assert!((of(&|x| 3.0 * x + 1.0) - 1.0).abs() < 1e-12);
        assert!((of(&|x| -x) + 1.0).abs() < 1e-12);
        assert_eq!(of(&|_| 2.0), 0.0);
        // x and x² over 0…99: √(15/16) but for the discreteness.
        assert!((of(&|x| x * x) - (15.0_f64 / 16.0).sqrt()).abs() < 2e-3);
    }
}
