//! The equilibrium curve on one ray of the apparent weight.

use std::f64::consts::{FRAC_PI_2, PI};

use serde::Serialize;

use super::{Point, bisect};
use alula_sim::reference::Vehicle;

/// Steps per radian of the scans: 0.01°. Two folds closer than that are not told apart.
const STEPS: f64 = 18_000.0 / PI;

/// A fold of the curve: two equilibria meet and vanish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// α \[rad\].
    pub alpha: f64,
    /// a.
    pub a: f64,
}

/// The number of equilibria between two values of a.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Where it begins.
    pub a_min: f64,
    /// Where it ends; none for the last.
    pub a_max: Option<f64>,
    /// Equilibria on the curve.
    pub n: usize,
}

/// The curve a(α; β) from hover to infinite airspeed: from the α at which the thrust alone holds the apparent weight,
/// a = 0, down to the nearest at which a grows without bound.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a> {
    vehicle: &'a Vehicle,
    beta: f64,
    /// α where a is infinite \[rad\].
    from: f64,
    /// α where a = 0 \[rad\].
    to: f64,
}

impl<'a> Curve<'a> {
    /// The curve of `vehicle` at a climb angle, or at the angle whose tangent is a level acceleration over g, `epsilon`
    /// \[rad\]. `None` where the aerodynamic force across the thrust line opposes any airspeed at hover: there is no
    /// curve that begins there.
    pub fn new(vehicle: &'a Vehicle, epsilon: f64) -> Option<Self> {
        let beta = -FRAC_PI_2 - epsilon;
        let to = beta + PI - vehicle.delta;
        let q = |alpha: f64| Point::at(vehicle, alpha).q;
        let step = 1.0 / STEPS;
        // Just below hover sin(α+δ−β) > 0 falls away from zero: a > 0 wants q > 0.
        if q(to - step) <= 0.0 {
            return None;
        }
        let steps = (1..(PI * STEPS) as usize).find(|n| q(to - *n as f64 * step) <= 0.0);
        let from = match steps {
            Some(n) => bisect(to - n as f64 * step, to - (n - 1) as f64 * step, q),
            // Never: the curve ends where the weight turns against it.
            None => to - PI,
        };
        Some(Self {
            vehicle,
            beta,
            from,
            to,
        })
    }

    /// Where the curve lies: α from infinite airspeed to hover \[rad\].
    pub fn range(&self) -> (f64, f64) {
        (self.from, self.to)
    }

    /// a at `alpha`.
    pub fn a(&self, alpha: f64) -> f64 {
        let p = Point::at(self.vehicle, alpha);
        let (sin, cos) = self.beta.sin_cos();
        (p.sin * cos - p.cos * sin) / p.q
    }

    /// q² ∂a/∂α at `alpha`: c̄_L cos β + c̄_D sin β.
    pub fn slope(&self, alpha: f64) -> f64 {
        let p = Point::at(self.vehicle, alpha);
        let (sin, cos) = self.beta.sin_cos();
        p.c_l_bar * cos + p.c_d_bar * sin
    }

    /// Points of the curve, by increasing α: (α, a).
    pub fn points(&self) -> Vec<(f64, f64)> {
        self.alphas().map(|alpha| (alpha, self.a(alpha))).collect()
    }

    fn alphas(&self) -> impl Iterator<Item = f64> {
        let (from, span) = (self.from, self.to - self.from);
        let n = (span * STEPS).ceil() as usize;
        // Neither end: a is infinite at one, and zero at the other.
        (0..n).map(move |i| from + span * (i as f64 + 0.5) / n as f64)
    }

    /// The folds, by increasing α.
    pub fn folds(&self) -> Vec<Fold> {
        let alphas: Vec<f64> = self.alphas().collect();
        let slopes: Vec<f64> = alphas.iter().map(|alpha| self.slope(*alpha)).collect();
        (1..alphas.len())
            .filter(|&i| (slopes[i - 1] < 0.0) != (slopes[i] < 0.0))
            .map(|i| bisect(alphas[i - 1], alphas[i], |alpha| self.slope(alpha)))
            .map(|alpha| Fold {
                alpha,
                a: self.a(alpha),
            })
            .collect()
    }

    /// The equilibria at `a`, by increasing α \[rad\], on the pieces of the curve that `folds` leave.
    pub fn equilibria(&self, a: f64, folds: &[Fold]) -> Vec<f64> {
        let step = 1e-9;
        let mut ends = vec![self.from + step];
        ends.extend(folds.iter().map(|fold| fold.alpha));
        ends.push(self.to - step);
        let excess = |alpha: f64| self.a(alpha) - a;
        ends.windows(2)
            .filter(|piece| (excess(piece[0]) < 0.0) != (excess(piece[1]) < 0.0))
            .map(|piece| bisect(piece[0], piece[1], excess))
            .collect()
    }

    /// How many equilibria there are between the folds' values of a.
    pub fn counts(&self, folds: &[Fold]) -> Vec<Interval> {
        let mut levels: Vec<f64> = folds.iter().map(|fold| fold.a).collect();
        levels.sort_by(f64::total_cmp);
        let ends = levels.iter().copied().map(Some).chain([None]);
        let begins = std::iter::once(0.0).chain(levels.iter().copied());
        begins
            .zip(ends)
            .map(|(a_min, a_max)| {
                let within = a_max.map_or(2.0 * a_min + 1.0, |a_max| 0.5 * (a_min + a_max));
                Interval {
                    a_min,
                    a_max,
                    n: self.equilibria(within, folds).len(),
                }
            })
            .collect()
    }
}
