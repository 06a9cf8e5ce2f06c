//! Tables in double precision: the interpolant that the core documents, by its Bernstein form.

use std::f64::consts::{PI, TAU};

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_dual::Dual3_64;

/// One row: α \[rad\], c_L, c_D.
pub type Row = [f64; 3];

/// A number with its derivatives, or by itself.
pub(super) trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + Sub<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// The constant `value`.
    fn constant(value: f64) -> Self;
    /// The value.
    fn value(self) -> f64;
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
}

impl Number for Dual3_64 {
    fn constant(value: f64) -> Self {
        Self::from_re(value)
    }
    fn value(self) -> f64 {
        self.re
    }
}

/// Measured coefficients, interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    alpha: Vec<f64>,
    lift: Vec<[f64; 6]>,
    drag: Vec<[f64; 6]>,
    symmetric: bool,
}

impl Table {
    /// The table through `rows`, which the core accepts: from 0 for a symmetric section, else from −π; to π.
    pub fn new(rows: &[Row]) -> Self {
        let symmetric = rows[0][0].abs() < 1e-5;
        let alpha: Vec<f64> = rows.iter().map(|row| row[0]).collect();
        let column = |k: usize, parity: f64| {
            let y: Vec<f64> = rows.iter().map(|row| row[k]).collect();
            bernstein(&alpha, &y, symmetric.then_some(parity))
        };
        Self {
            lift: column(1, -1.0),
            drag: column(2, 1.0),
            symmetric,
            alpha,
        }
    }

    /// c_L and c_D at `alpha` \[rad\] in [−π, π].
    pub fn lift_and_drag(&self, alpha: f64) -> [f64; 2] {
        self.at(alpha).into()
    }

    /// c_L and c_D at `alpha` \[rad\] in [−π, π].
    pub(super) fn at<D: Number>(&self, alpha: D) -> (D, D) {
        let mirrored = self.symmetric && alpha.value() < 0.0;
        let a = if mirrored { -alpha } else { alpha };
        let above = self.alpha.partition_point(|node| *node <= a.value());
        let j = above.clamp(1, self.alpha.len() - 1) - 1;
        let u = (a - self.alpha[j]) / (self.alpha[j + 1] - self.alpha[j]);
        let (lift, drag) = (casteljau(self.lift[j], u), casteljau(self.drag[j], u));
        (if mirrored { -lift } else { lift }, drag)
    }
}

/// The polynomial with these Bernstein ordinates, by de Casteljau's construction.
fn casteljau<D: Number>(ordinates: [f64; 6], u: D) -> D {
    let mut b = ordinates.map(D::constant);
    for n in (1..6).rev() {
        for i in 0..n {
            b[i] = b[i] + (b[i + 1] - b[i]) * u;
        }
    }
    b[0]
}

/// Ordinates of every interval: slope and curvature of each node from the parabola through three, limited so that the
/// ordinates are in order. `parity` is that of the continuation beyond 0 and π; without one the data repeat each turn.
fn bernstein(alpha: &[f64], y: &[f64], parity: Option<f64>) -> Vec<[f64; 6]> {
    const BEYOND: usize = 4;
    let last = y.len() - 1;
    let before = |k: usize| match parity {
        Some(p) => (-alpha[k], p * y[k]),
        None => (alpha[last - k] - TAU, y[last - k]),
    };
    let after = |k: usize| match parity {
        Some(p) => (2.0 * PI - alpha[last - k], p * y[last - k]),
        None => (alpha[k] + TAU, y[k]),
    };
    let nodes: Vec<(f64, f64)> = (1..=BEYOND)
        .rev()
        .map(before)
        .chain(alpha.iter().copied().zip(y.iter().copied()))
        .chain((1..=BEYOND).map(after))
        .collect();
    let h: Vec<f64> = nodes.windows(2).map(|n| n[1].0 - n[0].0).collect();
    let secant: Vec<f64> = nodes
        .windows(2)
        .map(|n| (n[1].1 - n[0].1) / (n[1].0 - n[0].0))
        .collect();
    let count = nodes.len();
    let mut slope = vec![0.0; count];
    for i in 1..count - 1 {
        let (l, r) = (secant[i - 1], secant[i]);
        if l * r > 0.0 {
            let parabola = (l * h[i] + r * h[i - 1]) / (h[i] + h[i - 1]);
            slope[i] = parabola.abs().min(2.0 * l.abs().min(r.abs())) * l.signum();
        }
    }
    let factor: Vec<f64> = (0..count - 1)
        .map(|j| 2.5 * secant[j].abs() / (slope[j].abs() + slope[j + 1].abs()))
        .map(|f| if f < 1.0 { f } else { 1.0 })
        .collect();
    for i in 1..count - 1 {
        slope[i] *= factor[i - 1].min(factor[i]);
    }
    // What is left of the middle step of the ordinates, shared by the curvatures at its two ends.
    let slack = |j: usize| {
        let left = secant[j].abs() - 0.4 * (slope[j].abs() + slope[j + 1].abs());
        10.0 / h[j] * left.max(0.0)
    };
    let curvature = |i: usize| {
        let mut range = (f64::NEG_INFINITY, f64::INFINITY);
        for (j, begins) in [(i - 1, false), (i, true)] {
            let steep = 4.0 * slope[i].abs() / h[j];
            let (low, high) = if begins {
                (-steep, slack(j))
            } else {
                (-slack(j), steep)
            };
            let (low, high) = match secant[j] {
                s if s > 0.0 => (low, high),
                s if s < 0.0 => (-high, -low),
                _ => (0.0, 0.0),
            };
            range = (range.0.max(low), range.1.min(high));
        }
        let parabola = 2.0 * (secant[i] - secant[i - 1]) / (h[i] + h[i - 1]);
        parabola.max(range.0).min(range.1)
    };
    (BEYOND..BEYOND + last)
        .map(|j| {
            let (y0, y1) = (nodes[j].1, nodes[j + 1].1);
            let step = h[j] / 5.0;
            let bend = h[j] * h[j] / 20.0;
            [
                y0,
                y0 + step * slope[j],
                y0 + 2.0 * step * slope[j] + bend * curvature(j),
                y1 - 2.0 * step * slope[j + 1] + bend * curvature(j + 1),
                y1 - step * slope[j + 1],
                y1,
            ]
        })
        .collect()
}
