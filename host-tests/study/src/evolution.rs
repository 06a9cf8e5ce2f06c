//! Covariance matrix adaptation: a search for the least of a function that is noisy, and of which no slope is known.
//!
//! N. Hansen, *The CMA Evolution Strategy: A Tutorial*, arXiv:1604.00772, with its default constants. The crate `cmaes` is not used: it
//! brings a second nalgebra and a second rand.

use nalgebra::{DMatrix, DVector};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// The state of a search.
#[derive(Clone, Debug)]
pub struct Evolution {
    mean: DVector<f64>,
    sigma: f64,
    covariance: DMatrix<f64>,
    path: DVector<f64>,
    path_sigma: DVector<f64>,
    population: usize,
    weights: Vec<f64>,
    generation: i32,
    /// Half axes of the distribution, as columns, and their lengths.
    axes: DMatrix<f64>,
    lengths: DVector<f64>,
}

impl Evolution {
    /// A search around `mean` with a spread of `sigma`, by the usual `population` for the number of dimensions if none is given.
    pub fn new(mean: DVector<f64>, sigma: f64, population: Option<usize>) -> Self {
        let n = mean.len();
        let usual = 4 + (3.0 * (n as f64).ln()) as usize;
        let population = population.unwrap_or(usual).max(4);
        let parents = population / 2;
        let raw = (0..parents).map(|i| (parents as f64 + 0.5).ln() - (i as f64 + 1.0).ln());
        let raw: Vec<f64> = raw.collect();
        let sum: f64 = raw.iter().sum();
        Self {
            mean,
            sigma,
            covariance: DMatrix::identity(n, n),
            path: DVector::zeros(n),
            path_sigma: DVector::zeros(n),
            population,
            weights: raw.iter().map(|w| w / sum).collect(),
            generation: 0,
            axes: DMatrix::identity(n, n),
            lengths: DVector::repeat(n, 1.0),
        }
    }

    /// The middle of the distribution: the best guess so far.
    pub fn mean(&self) -> &DVector<f64> {
        &self.mean
    }

    /// The points of the next generation.
    pub fn points(&self, random: &mut impl Rng) -> Vec<DVector<f64>> {
        let n = self.mean.len();
        let point = |random: &mut _| {
            let z = DVector::from_fn(n, |_, _| StandardNormal.sample(random));
            &self.mean + self.sigma * (&self.axes * self.lengths.component_mul(&z))
        };
        (0..self.population).map(|_| point(random)).collect()
    }

    /// Goes on from the values of a generation's `points`, NaN being worst.
    pub fn learn(&mut self, points: &[DVector<f64>], values: &[f64]) {
        let n = self.mean.len() as f64;
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let mu_eff = 1.0 / self.weights.iter().map(|w| w * w).sum::<f64>();
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let damping = 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma;
        let c_c = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n);
        let c_1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let c_mu =
            (1.0 - c_1).min(2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0).powi(2) + mu_eff));
        // Length of a normal vector, in the mean.
        let chi = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));

        let steps: Vec<DVector<f64>> = order
            .iter()
            .take(self.weights.len())
            .map(|&i| (&points[i] - &self.mean) / self.sigma)
            .collect();
        let step = self.weights.iter().zip(&steps).map(|(w, y)| *w * y);
        let step: DVector<f64> = step.sum();
        self.mean += self.sigma * &step;
        self.generation += 1;

        let whitened = &self.axes * self.axes.tr_mul(&step).component_div(&self.lengths);
        self.path_sigma = (1.0 - c_sigma) * &self.path_sigma
            + (c_sigma * (2.0 - c_sigma) * mu_eff).sqrt() * whitened;
        let length = self.path_sigma.norm();
        let expected = (1.0 - (1.0 - c_sigma).powi(2 * self.generation)).sqrt();
        let stalled = if length / expected < (1.4 + 2.0 / (n + 1.0)) * chi {
            1.0
        } else {
            0.0
        };
        self.path =
            (1.0 - c_c) * &self.path + stalled * (c_c * (2.0 - c_c) * mu_eff).sqrt() * &step;
        let kept = 1.0 - c_1 - c_mu + (1.0 - stalled) * c_1 * c_c * (2.0 - c_c);
        let mut covariance = kept * &self.covariance + c_1 * &self.path * self.path.transpose();
        for (w, y) in self.weights.iter().zip(&steps) {
            covariance += c_mu * *w * y * y.transpose();
        }
        self.sigma *= ((c_sigma / damping) * (length / chi - 1.0)).exp();
        self.covariance = 0.5 * (&covariance + covariance.transpose());
        let eigen = self.covariance.clone().symmetric_eigen();
        self.axes = eigen.eigenvectors;
        self.lengths = eigen.eigenvalues.map(|x| x.max(1e-20).sqrt());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    fn least(f: impl Fn(&DVector<f64>) -> f64, start: &[f64], generations: usize) -> DVector<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut evolution = Evolution::new(DVector::from_row_slice(start), 0.3, None);
        for _ in 0..generations {
            let points = evolution.points(&mut random);
            let values: Vec<f64> = points.iter().map(&f).collect();
            evolution.learn(&points, &values);
        }
        evolution.mean().clone()
    }

    /// Rosenbrock's valley is bent: without the covariance the search stays in it for long.
    #[test]
    fn the_end_of_a_bent_valley_is_found() {
        let valley = |x: &DVector<f64>| {
            let pairs = x.as_slice().windows(2);
            pairs
                .map(|p| 100.0 * (p[1] - p[0] * p[0]).powi(2) + (1.0 - p[0]).powi(2))
                .sum()
        };
        let minimum = least(valley, &[0.5, 0.4, 0.0, 0.2, -0.3], 1000);
        assert!((minimum - DVector::repeat(5, 1.0)).norm() < 1e-3);
    }

    /// Axes of lengths from 1 to 1000, turned by none: the spread follows each.
    #[test]
    fn a_long_ellipsoid_is_no_harder_than_a_ball() {
        let ellipsoid = |x: &DVector<f64>| {
            let weighted = x.iter().enumerate();
            weighted
                .map(|(i, x)| (1000f64.powf(i as f64 / 7.0) * x).powi(2))
                .sum()
        };
        let minimum = least(ellipsoid, &[1.0; 8], 800);
        assert!(minimum.norm() < 1e-3, "{minimum}");
    }
}
