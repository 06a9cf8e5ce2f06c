//! How late the velocity of a log is behind its accelerometer: an estimator's is by some hundredths of a second. In a pull-up a velocity that is late by 50 ms
//! is off by a degree of angle of attack, and in step with the lift.
//!
//! What is told at t is v(t − τ), to first order v − τ a: over windows of a few tenths of a second Δv − ∫ a dt = −τ Δa.

use nalgebra::{DMatrix, DVector, Vector3};

use super::regression::{Measured, least_squares};

/// Length of a window, time between two, time over which the acceleration at either end is averaged, and of blocks whose residuals hang together \[s\].
const WINDOW: f64 = 0.3;
const EVERY: f64 = 0.05;
const AROUND: f64 = 0.15;
const BLOCK: f64 = 5.0;
/// Greatest lag that a first order describes \[s\].
const MOST: f64 = 0.15;

/// The acceleration in the mean of [`AROUND`] at each of the times \[s\], from its integral there.
fn smooth(times: &[f64], integral: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let last = times.len() - 1;
    let at = |t: f64| times.partition_point(|x| *x < t).min(last);
    let mean = |t: &f64| {
        let (from, to) = (at(t - 0.5 * AROUND), at(t + 0.5 * AROUND));
        (integral[to] - integral[from]) / (times[to] - times[from]).max(1e-6)
    };
    times.iter().map(mean).collect()
}

/// The velocity as it is at its times \[s\], of one that was told, and the acceleration [m/s²] that goes with it.
pub(super) fn in_time(
    times: &[f64],
    velocity: &[[f64; 3]],
    acceleration: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let told: Vec<Vector3<f64>> = velocity.iter().map(|v| Vector3::from(*v)).collect();
    if times.len() < 2 {
        return told;
    }
    let mut sum = Vector3::zeros();
    let mut integral = vec![sum];
    for (pair, a) in times.windows(2).zip(acceleration) {
        // What is not told changes nothing.
        let change = (pair[1] - pair[0]) * a;
        if change.iter().all(|x| x.is_finite()) {
            sum += change;
        }
        integral.push(sum);
    }
    let smooth = smooth(times, &integral);
    let mut rows: Vec<[f64; 2]> = Vec::new();
    let mut blocks = Vec::new();
    let mut next = f64::NEG_INFINITY;
    for (first, &t) in times.iter().enumerate() {
        let last = times.partition_point(|x| *x < t + WINDOW);
        let Some(end) = times.get(last) else { break };
        if t < next || end - t > 1.5 * WINDOW {
            continue;
        }
        next = t + EVERY;
        let left = told[last] - told[first] - (integral[last] - integral[first]);
        let change = smooth[first] - smooth[last];
        let pairs = change.iter().zip(left.iter()).map(|(x, y)| [*x, *y]);
        let pairs: Vec<[f64; 2]> = pairs.filter(|[x, y]| (x + y).is_finite()).collect();
        blocks.extend(pairs.iter().map(|_| (t / BLOCK) as usize));
        rows.extend(pairs);
    }
    let x = DMatrix::from_fn(rows.len(), 1, |i, _| rows[i][0]);
    let y = DVector::from_fn(rows.len(), |i, _| rows[i][1]);
    let fit = (!rows.is_empty()).then(|| least_squares(&x, &x, &y, &blocks));
    let lag = fit.flatten().map(|fit| fit.measured(0));
    let lag = lag.filter(Measured::is_known).map_or(0.0, |lag| lag.value);
    let lag = lag.clamp(0.0, MOST);
    let both = told.iter().zip(&smooth);
    both.map(|(v, a)| v + lag * a).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A swing of which the velocity is told 40 ms late: what comes out is not late, and of one that is in time nothing is changed.
    #[test]
    fn a_velocity_that_is_late_is_put_in_time() {
        let times: Vec<f64> = (0..6000).map(|n| 0.01 * f64::from(n)).collect();
        let v = |t: f64| 2.0 * (2.0 * t).sin() + (0.7 * t).sin();
        let a = |t: f64| 4.0 * (2.0 * t).cos() + 0.7 * (0.7 * t).cos();
        let acceleration: Vec<_> = times
            .iter()
            .map(|t| Vector3::new(0.0, 0.0, a(*t)))
            .collect();
        for late in [0.0, 0.04] {
            let told: Vec<_> = times.iter().map(|t| [0.0, 0.0, v(t - late)]).collect();
            let had = in_time(&times, &told, &acceleration);
            let off = |n: usize| (had[n].z - v(times[n])).abs();
            let most = (100..5900).map(off).fold(0.0, f64::max);
            // As told it is off by 0.19 m/s; half a row is what left sums are late by.
            assert!(most < 0.03, "{late}: {most}");
        }
    }
}
