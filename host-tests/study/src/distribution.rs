//! The distributions that numbers are drawn from.

use rand::{Rng, RngExt};
use rand_distr::{Distribution as _, StandardNormal};
use serde::Deserialize;

use alula_sim::experiment::FieldError;

/// A distribution.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Distribution {
    /// Uniform in [least, most].
    Uniform([f64; 2]),
    /// Uniform in the logarithm, in [least, most]: every doubling is as likely.
    LogUniform([f64; 2]),
    /// Normal, drawn anew until it is within so many deviations.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation, before the truncation.
        deviation: f64,
        /// Truncated at mean ± `within` · deviation.
        within: f64,
    },
    /// One of these, with equal chances.
    OneOf(Vec<f64>),
}

impl Distribution {
    pub(super) fn validate(&self, field: &str) -> Result<(), FieldError> {
        let error = |problem: &str| Err(FieldError::new(field, problem));
        let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
        match self {
            Self::Uniform([least, most]) if !(finite(&[*least, *most]) && least <= most) => {
                error("uniform must be [least, most]")
            }
            Self::LogUniform([least, most])
                if !(finite(&[*least, *most]) && 0.0 < *least && least <= most) =>
            {
                error("log-uniform must be [least, most], and positive")
            }
            Self::Normal {
                mean,
                deviation,
                within,
            } if !(finite(&[*mean, *deviation]) && *deviation >= 0.0 && *within >= 0.5) => {
                error("normal needs a mean, a deviation that is not negative, and within ≥ 0.5")
            }
            Self::OneOf(values) if values.is_empty() || !finite(values) => {
                error("one-of needs finite numbers")
            }
            _ => Ok(()),
        }
    }

    /// A number that none drawn is below.
    pub(super) fn least(&self) -> f64 {
        match self {
            Self::Uniform([least, _]) | Self::LogUniform([least, _]) => *least,
            Self::Normal {
                mean,
                deviation,
                within,
            } => mean - deviation * within,
            Self::OneOf(values) => values.iter().copied().fold(f64::INFINITY, f64::min),
        }
    }

    /// A number drawn.
    pub(super) fn draw(&self, random: &mut impl Rng) -> f64 {
        match self {
            Self::Uniform([least, most]) => {
                let part: f64 = random.random();
                least + part * (most - least)
            }
            Self::LogUniform([least, most]) => {
                let part: f64 = random.random();
                least * (most / least).powf(part)
            }
            Self::Normal {
                mean,
                deviation,
                within,
            } => loop {
                let normal: f64 = StandardNormal.sample(random);
                if normal.abs() <= *within {
                    break mean + deviation * normal;
                }
            },
            Self::OneOf(values) => values[random.random_range(0..values.len())],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    struct Moments {
        mean: f64,
        deviation: f64,
        least: f64,
        most: f64,
    }

    fn moments(distribution: &Distribution) -> Moments {
        let random = &mut ChaCha8Rng::seed_from_u64(5);
        let n = 40_000;
        let values: Vec<f64> = (0..n).map(|_| distribution.draw(random)).collect();
        let mean = values.iter().sum::<f64>() / f64::from(n);
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n);
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Moments {
            mean,
            deviation: variance.sqrt(),
            least,
            most,
        }
    }

    /// Mean and deviation to four standard errors; the normal's deviation, truncated at ±2, is 0.8796 of the whole one's.
    #[test]
    fn moments_and_bounds_are_the_textbooks() {
        let m = moments(&Distribution::Uniform([-1.0, 3.0]));
        assert!((m.mean - 1.0).abs() < 0.025 && (m.deviation - 4.0 / 12_f64.sqrt()).abs() < 0.02);
        assert!((-1.0..-0.99).contains(&m.least) && m.most <= 3.0 && m.most > 2.99);
        let normal = Distribution::Normal {
            mean: 5.0,
            deviation: 0.5,
            within: 2.0,
        };
        let m = moments(&normal);
        assert!((m.mean - 5.0).abs() < 0.01 && (m.deviation - 0.5 * 0.8796).abs() < 0.008);
        assert!((4.0..4.01).contains(&m.least) && m.most <= 6.0 && m.most > 5.99);
        // The mean of a decade is 9/ln 10, and half of it is below √10.
        let decade = Distribution::LogUniform([1.0, 10.0]);
        let m = moments(&decade);
        assert!((m.mean - 9.0 / 10.0_f64.ln()).abs() < 0.04);
        assert!((1.0..1.01).contains(&m.least) && m.most <= 10.0 && m.most > 9.99);
        let m = moments(&Distribution::OneOf(vec![0.0, 3.0]));
        assert!((m.mean - 1.5).abs() < 0.03);
    }

    #[test]
    fn nonsense_is_refused() {
        let refused = |text: &str| {
            let table: std::collections::BTreeMap<String, Distribution> =
                toml::from_str(text).unwrap();
            table["d"].validate("d").is_err()
        };
        assert!(refused("d.uniform = [1, 0]"));
        assert!(refused("d.uniform = [nan, 0]"));
        assert!(refused(
            "d.normal = { mean = 0, deviation = -1, within = 3 }"
        ));
        assert!(refused(
            "d.normal = { mean = 0, deviation = 1, within = 0 }"
        ));
        assert!(refused("d.one-of = []"));
        assert!(refused("d.log-uniform = [0, 1]"));
        assert!(!refused("d.uniform = [1, 1]"));
    }
}
