//! The forces on a vehicle as a sum of unknowns: thrust, wing, elevons.

use nalgebra::{DMatrix, DVector};

use super::flown::{ROWS, Row, SLOW};
use super::reconstruct::GRAVITY;
use super::regression::least_squares;

/// Width of what is constant behind the stall \[rad\].
pub(super) const BIN: f64 = std::f64::consts::PI / 18.0;

/// The unknowns of the forces: their number, and the regressors of a row.
pub(super) struct Unknowns {
    /// Bins behind the stall that were visited.
    pub(super) bins: Vec<i32>,
    /// The angle of attack short of stall, by [`instruments`].
    pub(super) mean: [f64; 3],
}

pub(super) const FIXED: usize = 6;

/// C_T over its static value, per advance ratio and its square: c1/c0 and c2/c0 of small propellers.
const PROPELLER: [f64; 2] = [-0.75, -1.08];
/// Advance ratio without thrust of such a propeller.
pub(super) const NO_THRUST: f64 = 0.676;

/// Thrust over its static value at full throttle, at the throttle `u` and the speed `along` the nose, of a propeller of the speed `v1`, and its
/// derivative by `v1`.
pub(super) fn propelled(u: f64, along: f64, v1: f64) -> [f64; 2] {
    let [linear, square] = PROPELLER;
    let (root, j) = (u.max(0.0).sqrt(), along / v1);
    let thrust = u + linear * root * j + square * j * j;
    // Slower than that it idles.
    if thrust <= 0.0 {
        return [0.0; 2];
    }
    [thrust, -(linear * root * j + 2.0 * square * j * j) / v1]
}

impl Unknowns {
    pub(super) fn of(rows: &[Row], k: f64) -> Self {
        let mut counts = std::collections::BTreeMap::new();
        for row in rows.iter().filter(|row| row.speed() > SLOW) {
            if !row.attached() && is_free(row, k) {
                *counts
                    .entry((row.alpha() / BIN).floor() as i32)
                    .or_insert(0) += 1;
            }
        }
        let bins = counts.into_iter().filter(|(_, count)| *count >= ROWS);
        let attached = rows.iter().filter(|row| row.attached() && !row.turns());
        let attached: Vec<&Row> = attached.collect();
        let mut mean = [0.0; 3];
        if attached.len() > ROWS {
            let z = DMatrix::from_fn(attached.len(), 3, |i, j| instruments(attached[i])[j]);
            let alpha = DVector::from_fn(attached.len(), |i, _| attached[i].alpha());
            if let Some(fit) = least_squares(&z, &z, &alpha, &vec![0; attached.len()]) {
                mean = [0, 1, 2].map(|j| fit.estimate[j]);
            }
        }
        Self {
            bins: bins.map(|(bin, _)| bin).collect(),
            mean,
        }
    }

    pub(super) fn count(&self) -> usize {
        FIXED + 2 * self.bins.len()
    }

    /// The regressors along nose and belly, at a throttle behind its lag, for a propeller that is known so far; none where the row is in no bin that is known, turns, or is behind the stall and slower than its slipstream.
    pub(super) fn regressors(
        &self,
        row: &Row,
        throttle: f64,
        k: f64,
        Propeller {
            v1,
            static_f,
            blown,
        }: Propeller,
        in_the_mean: bool,
    ) -> Option<[Vec<f64>; 2]> {
        let mut both = [vec![0.0; self.count()], vec![0.0; self.count()]];
        let pressure = k * row.speed().powi(2);
        let attached = row.attached();
        let alpha = if attached && in_the_mean {
            self.mean_alpha(row)
        } else {
            row.alpha()
        };
        let (sin, cos) = alpha.sin_cos();
        let lift = [pressure * sin, -pressure * cos];
        let drag = [-pressure * cos, -pressure * sin];
        if attached && row.turns() {
            return None;
        }
        if row.speed() > SLOW && !attached && !is_free(row, k) {
            return None;
        }
        let bin = (row.alpha() / BIN).floor() as i32;
        let place = self.bins.iter().position(|known| *known == bin);
        let [thrust, by_v1] = propelled(throttle, row.air.x, v1);
        for axis in 0..2 {
            let x = &mut both[axis];
            if axis == 0 {
                x[0] = thrust;
                x[1] = static_f * by_v1;
            } else if row.turn.is_finite() {
                x[5] = row.turn;
            }
            if row.speed() <= SLOW {
                continue;
            }
            if attached {
                // Of a part of the wing in the slipstream the pressure is greater by the thrust's, the angle of attack smaller.
                let [whole, half] =
                    [1.0, 0.5].map(|share| 1.0 + share * blown * static_f * thrust / pressure);
                x[2] = lift[axis] * whole;
                x[3] = lift[axis] * half * alpha;
                x[4] = drag[axis];
            } else {
                let place = place?;
                x[FIXED + 2 * place] = lift[axis];
                x[FIXED + 2 * place + 1] = drag[axis];
            }
        }
        Some(both)
    }

    /// The angle of attack that the flight has in the mean at a row's airspeed and climb.
    fn mean_alpha(&self, row: &Row) -> f64 {
        instruments(row)
            .iter()
            .zip(&self.mean)
            .map(|(z, c)| z * c)
            .sum()
    }
}

/// Whether a row behind the stall tells of the air that it flies through more than of its slipstream: a c_L of 2 would carry it. `k` is k_a/m.
fn is_free(row: &Row, k: f64) -> bool {
    k * row.speed().powi(2) > 0.5 * GRAVITY
}

/// What the angle of attack depends on in the mean, and no gust does.
fn instruments(row: &Row) -> [f64; 3] {
    [1.0, 1.0 / row.speed().powi(2), row.climb]
}

/// What is held of the propellers in a fit.
#[derive(Clone, Copy)]
pub(super) struct Propeller {
    /// Their speed V_1 [m/s].
    pub(super) v1: f64,
    /// Static thrust at full throttle over the mass [m/s²].
    pub(super) static_f: f64,
    /// Area of the wing in the slipstream over that of the discs.
    pub(super) blown: f64,
}

#[cfg(test)]
mod tests {
    use super::propelled;

    /// A propeller gives its static thrust at rest, less with speed, and none, not less than none, where the air outruns it.
    #[test]
    fn a_propeller_that_idles_gives_no_thrust() {
        assert_eq!(propelled(0.5, 0.0, 40.0)[0], 0.5);
        assert!(propelled(0.5, 10.0, 40.0)[0] < 0.5);
        assert_eq!(propelled(0.01, 18.0, 40.0), [0.0; 2]);
    }
}
