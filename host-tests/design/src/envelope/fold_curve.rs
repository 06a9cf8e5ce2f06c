//! The folds of every climb angle, and the cusps where two of them vanish.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::{Point, bisect};
use alula_sim::reference::{Vehicle, wrap};

/// Steps around the circle: 0.02°.
const STEPS: usize = 18_000;

/// h smaller than this is taken for the rounding of a shape that is equivalent to a sphere there: it has no folds.
const SPHERE: f64 = 1e-6;

/// A fold at one climb angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoldPoint {
    /// α \[rad\].
    pub alpha: f64,
    /// ε \[rad\] in [−π, π).
    pub epsilon: f64,
    /// a.
    pub a: f64,
}

/// Where two folds meet and vanish.
pub type Cusp = FoldPoint;

/// The folds over all ε, by increasing α.
pub struct FoldCurve<'a> {
    vehicle: &'a Vehicle,
    samples: Vec<Sample>,
}

struct Sample {
    point: FoldPoint,
    h: f64,
    /// Whether `point` lies on an equilibrium curve from hover at a climb angle within 90° of level flight.
    reached: bool,
}

impl<'a> FoldCurve<'a> {
    /// The fold curve of `vehicle`.
    pub fn new(vehicle: &'a Vehicle) -> Self {
        let points: Vec<Point> = alphas().map(|alpha| Point::at(vehicle, alpha)).collect();
        // How far above each α, going round, q stays positive: only so far reach the curves that begin there.
        let mut clear = vec![0; STEPS];
        let mut length = 0;
        for i in (0..2 * STEPS).rev() {
            length = if points[i % STEPS].q > 0.0 {
                length + 1
            } else {
                0
            };
            clear[i % STEPS] = length;
        }
        let samples = alphas()
            .zip(points.iter().zip(clear))
            .map(|(alpha, (p, clear))| {
                let point = fold(alpha, p);
                let hover = FRAC_PI_2 - point.epsilon - vehicle.delta;
                let above = (hover - alpha).rem_euclid(TAU);
                let level = point.epsilon.abs() <= FRAC_PI_2;
                Sample {
                    point,
                    h: p.h,
                    reached: level && above < PI && above < TAU * clear as f64 / STEPS as f64,
                }
            })
            .collect();
        Self { vehicle, samples }
    }

    /// The pieces of the curve that lie on equilibrium curves from hover at climb angles within 90° of level flight.
    pub fn pieces(&self) -> Vec<Vec<FoldPoint>> {
        self.samples
            .split(|sample| !sample.reached || sample.h.abs() < SPHERE)
            .filter(|piece| !piece.is_empty())
            .map(|piece| piece.iter().map(|sample| sample.point).collect())
            .collect()
    }

    /// The cusps on those pieces: where h changes sign.
    pub fn cusps(&self) -> Vec<Cusp> {
        let at = |alpha: f64| Point::at(self.vehicle, alpha);
        self.samples
            .windows(2)
            .filter(|pair| pair.iter().all(|s| s.reached && s.h.abs() > SPHERE))
            .filter(|pair| (pair[0].h < 0.0) != (pair[1].h < 0.0))
            .map(|pair| {
                bisect(pair[0].point.alpha, pair[1].point.alpha, |alpha| {
                    at(alpha).h
                })
            })
            .map(|alpha| fold(alpha, &at(alpha)))
            .collect()
    }
}

/// The fold at `alpha`: β is the direction of (c̄_D, −c̄_L).
fn fold(alpha: f64, p: &Point) -> FoldPoint {
    let beta = (-p.c_l_bar).atan2(p.c_d_bar);
    FoldPoint {
        alpha,
        epsilon: wrap(-FRAC_PI_2 - beta),
        a: 1.0 / p.c_l_bar.hypot(p.c_d_bar),
    }
}

fn alphas() -> impl Iterator<Item = f64> {
    (0..STEPS).map(|i| PI * ((2 * i + 1) as f64 / STEPS as f64 - 1.0))
}
