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
    for (i, of) in blocks.iter().enumerate() {
        if i > 0 && blocks[i - 1] != *of {
            meat += &block * block.transpose();
            block.fill(0.0);
            count += 1.0;
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
    })
}

/// 1.96 deviations, and what estimates of them scatter by.
pub const DEVIATIONS: f64 = 2.1;

impl Fit {
    /// One of the estimates.
    pub fn measured(&self, j: usize) -> Measured {
        Measured {
            value: self.estimate[j],
            within: DEVIATIONS * self.covariance[(j, j)].max(0.0).sqrt(),
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
        let variance = (slope.transpose() * &self.covariance * &slope)[(0, 0)];
        Measured {
            value,
            within: DEVIATIONS * variance.max(0.0).sqrt(),
        }
    }
}
