//! How fast the pitch rate follows its set-point: when 63 % of a step is there, of the step response of a regression of the rate on its own past and that of the
//! set-point.
//!
//! ω_k = Σ a_i ω_{k−i} + Σ b_i ω*_{k−i} + c
//!
//! The loop is of no order that is known, and its set-point answers the rate: who flies corrects what a gust has turned. With the rate's own past in the regression
//! gusts do not pass for an answer of the loop (Ljung, *System Identification*, chapters 4 and 13).

use nalgebra::{DMatrix, DVector};

use super::lag::Even;
use super::regression::{Measured, least_squares};

/// Rows of the past.
const PAST: usize = 4;
/// Part of the step, as of a lag of first order, and time \[s\] in which a rate loop has made it.
const PART: f64 = 0.632;
const SOON: f64 = 1.0;
/// Least mean square of a set-point that moves [rad/s].
const MOVES: f64 = 0.03;
/// Time over which residuals hang together \[s\].
const BLOCK: f64 = 2.0;
/// Least rows.
const ROWS: usize = 400;

/// A pitch rate, asked for and had, at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Time \[s\].
    pub(super) t: f64,
    /// ω* [rad/s].
    pub(super) asked: f64,
    /// ω [rad/s].
    pub(super) rate: f64,
    /// Whether it counts: else it is of the past of others alone.
    pub(super) counts: bool,
}

/// Rows until the response of the coefficients `of` to a step of 1 has made [`PART`] of it, of at most so many; NaN if it never has.
fn rows(of: &DVector<f64>, most: usize) -> f64 {
    let mut response = vec![0.0_f64];
    for k in 1..most {
        let before = |i: usize| k.checked_sub(1 + i).map_or(0.0, |n| response[n]);
        let own: f64 = (0..PAST).map(|i| of[i] * before(i)).sum();
        let asked: f64 = (0..PAST.min(k)).map(|i| of[PAST + i]).sum();
        let (last, next) = (before(0), own + asked);
        if next >= PART {
            return (k - 1) as f64 + (PART - last) / (next - last);
        }
        response.push(next);
    }
    f64::NAN
}

/// The lag \[s\]; none where there are too few rows, too little is asked, or it is not followed.
pub(super) fn rate_lag(all: &[Sample]) -> Option<Measured> {
    let times: Vec<f64> = all.iter().map(|sample| sample.t).collect();
    let even = Even::of(&times, PAST)?;
    let known: Vec<usize> = even
        .known
        .iter()
        .copied()
        .filter(|n| all[*n].counts)
        .collect();
    let squares = known.iter().map(|n| all[*n].asked.powi(2)).sum::<f64>();
    if known.len() < ROWS || (squares / known.len() as f64).sqrt() < MOVES {
        return None;
    }
    let x = DMatrix::from_fn(known.len(), 2 * PAST + 1, |row, j| match j {
        j if j < PAST => all[known[row] - 1 - j].rate,
        j if j < 2 * PAST => all[known[row] - 1 - (j - PAST)].asked,
        _ => 1.0,
    });
    let y = DVector::from_fn(known.len(), |row, _| all[known[row]].rate);
    let blocks = known.iter().map(|n| (all[*n].t / BLOCK) as usize);
    let fit = least_squares(&x, &x, &y, &blocks.collect::<Vec<_>>())?;
    let most = (SOON / even.spacing) as usize;
    let lag = fit.function(|of| even.spacing * rows(of, most));
    let found = lag.value.is_finite() && lag.within.is_finite();
    found.then(|| even.within_a_row(lag))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A loop of servo and integral, of which no lag of first order is the model, that gusts turn and that is asked to turn back: its 63 % are found, and in the
    /// interval. A set-point that rests tells nothing.
    #[test]
    fn a_loop_that_is_no_lag_is_found_in_gusts() {
        const PARTS: u32 = 10;
        let (servo, gain, dt) = (0.04, 14.0, 0.01);
        let part = dt / f64::from(PARTS);
        // One part of a row.
        let advance = |[turn, rate]: [f64; 2], asked: f64, gust: f64| {
            let next = turn + part / servo * (gain * (asked - rate) - turn);
            [next, rate + part * (turn + gust)]
        };
        let mut state = [0.0; 2];
        let parts = (1..1000).find(|_| {
            state = advance(state, 1.0, 0.0);
            state[1] >= PART
        });
        let truth = part * f64::from(parts.unwrap());
        let (mut state, mut gust, mut attitude, mut seed) = ([0.0; 2], 0.0, 0.0, 1_u32);
        let samples: Vec<Sample> = (0..4000)
            .map(|k| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                gust += 0.1 * (8.0 * (f64::from(seed) / f64::from(u32::MAX) - 0.5) - gust);
                let asked = if k / 80 % 2 == 0 { 0.1 } else { -0.1 } - 2.0 * attitude;
                let sample = Sample {
                    t: dt * k as f64,
                    asked,
                    rate: state[1],
                    counts: true,
                };
                for _ in 0..PARTS {
                    state = advance(state, asked, gust);
                }
                attitude += dt * state[1];
                sample
            })
            .collect();
        let lag = rate_lag(&samples).unwrap();
        assert!(
            (lag.value - truth).abs() < lag.within.min(dt),
            "{lag:?} of {truth}"
        );
        let rests = |sample: &Sample| Sample {
            asked: 0.0,
            ..*sample
        };
        assert_eq!(
            rate_lag(&samples.iter().map(rests).collect::<Vec<_>>()),
            None
        );
    }
}
