//! Least squares with intervals that are honest of errors that last.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// A number with its interval of 95 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// The estimate.
    pub value: f64,
    /// Half of the interval.
    pub within: f64,
}

impl Measured {
    /// The interval widened by what the model itself lacks, a `share` of the value.
    #[must_use]
    pub fn lacking(self, share: f64) -> Self {
        Self {
            within: self.within.hypot(share * self.value),
            ..self
        }
    }

    /// Whether the interval says something: it is less than half of the value.
    pub fn is_known(&self) -> bool {
        self.within < 0.5 * self.value.abs()
    }
}

/// What least squares give.
pub struct Fit {
    /// The estimates, in the order of the regressors.
    pub estimate: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Sum of the squared residuals.
    pub squares: f64,
    /// Blocks that say something of each estimate.
    pub blocks: Vec<usize>,
}

/// Least squares by the singular value decomposition, with a covariance that lets residuals of a block hang together. Residuals are those of
/// the regressors as they were told, `told`.
pub fn least_squares(
    x: &DMatrix<f64>,
    told: &DMatrix<f64>,
    y: &DVector<f64>,
    blocks: &[usize],
) -> Option<Fit> {
    let scale: Vec<f64> = x.column_iter().map(|c| c.norm().max(1e-12)).collect();
    let scaled = DMatrix::from_fn(x.nrows(), x.ncols(), |i, j| x[(i, j)] / scale[j]);
    let gram = scaled.tr_mul(&scaled);
    let inverse = gram.svd(true, true).pseudo_inverse(1e-9).ok()?;
    let solved = &inverse * scaled.tr_mul(y);
    let unscaled = DVector::from_fn(x.ncols(), |j, _| solved[j] / scale[j]);
    let residual = y - told * unscaled;
    let squares = (y - &scaled * &solved).norm_squared();
    let mut meat = DMatrix::zeros(x.ncols(), x.ncols());
    let mut block = DVector::zeros(x.ncols());
    let mut count = 1.0;
    let mut says = vec![0; x.ncols()];
    let mut last = vec![None; x.ncols()];
    for (i, of) in blocks.iter().enumerate() {
        if i > 0 && blocks[i - 1] != *of {
            meat += &block * block.transpose();
            block.fill(0.0);
            count += 1.0;
        }
        for j in (0..x.ncols()).filter(|j| x[(i, *j)] != 0.0) {
            if last[j].replace(of) != Some(of) {
                says[j] += 1;
            }
        }
        block += scaled.row(i).transpose() * residual[i];
    }
    meat += &block * block.transpose();
    // Few blocks say too little of what they scatter by.
    let few = count / (count - 1.0_f64).max(1.0);
    let covariance = few * &inverse * meat * &inverse;
    let unscale = |j: usize| 1.0 / scale[j];
    Some(Fit {
        estimate: DVector::from_fn(x.ncols(), |j, _| solved[j] * unscale(j)),
        covariance: DMatrix::from_fn(x.ncols(), x.ncols(), |i, j| {
            covariance[(i, j)] * unscale(i) * unscale(j)
        }),
        squares,
        blocks: says,
    })
}

/// How many deviations, estimated from so many blocks, an interval of 95 % takes to either side: Student's t with two degrees fewer, after Cornish and
/// Fisher (Abramowitz and Stegun, 26.7.5).
pub fn deviations(blocks: usize) -> f64 {
    let degrees = blocks.saturating_sub(2).max(1) as f64;
    let z = 1.96_f64;
    let [first, second, third] = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
    ];
    z + first / degrees + second / degrees.powi(2) + third / degrees.powi(3)
}

impl Fit {
    /// One of the estimates.
    pub fn measured(&self, j: usize) -> Measured {
        Measured {
            value: self.estimate[j],
            within: deviations(self.blocks[j]) * self.covariance[(j, j)].max(0.0).sqrt(),
        }
    }

    /// A function of the estimates, with its interval to first order.
    pub fn function(&self, of: impl Fn(&DVector<f64>) -> f64) -> Measured {
        let value = of(&self.estimate);
        let slope = DVector::from_fn(self.estimate.len(), |j, _| {
            let step = 1e-4 * self.estimate[j].abs().max(1e-3);
            let mut near = self.estimate.clone();
            near[j] += step;
            (of(&near) - value) / step
        });
        let of = self.blocks.iter().zip(slope.iter());
        let blocks = of.filter_map(|(blocks, slope)| (*slope != 0.0).then_some(*blocks));
        let blocks = blocks.min().unwrap_or(0);
        let variance = (slope.transpose() * &self.covariance * &slope)[(0, 0)];
        Measured {
            value,
            within: deviations(blocks) * variance.max(0.0).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::deviations;

    /// Student's t of 95 % from tables: four, ten and thirty degrees of freedom.
    #[test]
    fn few_blocks_take_more_deviations() {
        for (degrees, table) in [(4, 2.776), (10, 2.228), (30, 2.042)] {
            assert!((deviations(degrees + 2) - table).abs() < 0.01, "{degrees}");
        }
    }
}
