//! How fast the rate about an axis follows its set-point: when 63 % of a step is there, of the step response of a regression of the rate on the past of the rates and
//! set-points about all three axes.
//!
//! ω_k = Σ a_i ω_{k−i} + Σ b_i ω*_{k−i} + others + c
//!
//! The axes turn each other: where a difference of thrust turns about the belly, the propellers turn it about the nose, too, and who flies asks for both at once. The
//! response is that about the axis alone.
//!
//! The loop is of no order that is known, and its set-point answers the rate: who flies corrects what a gust has turned. With the rate's own past in the regression
//! gusts do not pass for an answer of the loop (Ljung, *System Identification*, chapters 4 and 13).

use nalgebra::{DMatrix, DVector, Vector3};

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

/// Rates about nose, wing and belly, asked for and had, at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Time \[s\].
    pub(super) t: f64,
    /// ω* [rad/s]; zero where none is known.
    pub(super) asked: Vector3<f64>,
    /// ω [rad/s], likewise.
    pub(super) rate: Vector3<f64>,
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

/// The lag about an `axis` \[s\]; none where there are too few rows, too little is asked, or it is not followed.
pub(super) fn rate_lag(all: &[Sample], axis: usize) -> Option<Measured> {
    let times: Vec<f64> = all.iter().map(|sample| sample.t).collect();
    let even = Even::of(&times, PAST)?;
    let known: Vec<usize> = even
        .known
        .iter()
        .copied()
        .filter(|n| all[*n].counts)
        .collect();
    let squares = known
        .iter()
        .map(|n| all[*n].asked[axis].powi(2))
        .sum::<f64>();
    if known.len() < ROWS || (squares / known.len() as f64).sqrt() < MOVES {
        return None;
    }
    // Its own axis before the others.
    let columns = known.iter().flat_map(|n| {
        let before = move |i: usize| &all[n - 1 - i];
        let axes = (axis..axis + 3).map(|axis| axis % 3);
        let of = axes.flat_map(move |axis| {
            let rates = (0..PAST).map(move |i| before(i).rate[axis]);
            rates.chain((0..PAST).map(move |i| before(i).asked[axis]))
        });
        of.chain([1.0])
    });
    let x = DMatrix::from_row_iterator(known.len(), 6 * PAST + 1, columns);
    let y = DVector::from_fn(known.len(), |row, _| all[known[row]].rate[axis]);
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
    /// interval; so are those of a slower axis that the first turns along. A set-point that rests tells nothing.
    #[test]
    fn a_loop_that_is_no_lag_is_found_in_gusts() {
        const PARTS: u32 = 10;
        let (servo, gains, along, dt) = (0.04, [14.0, 9.0], 0.4, 0.01);
        let part = dt / f64::from(PARTS);
        // One part of a row: what the servos turn, and the rates.
        let advance = |state: [[f64; 2]; 2], asked: [f64; 2], gusts: [f64; 2]| {
            let turns = state.map(|[turn, _]| turn);
            let turns = [turns[0], turns[1] + along * turns[0]];
            [0, 1].map(|axis| {
                let [turn, rate] = state[axis];
                let wanted = gains[axis] * (asked[axis] - rate);
                let next = turn + part / servo * (wanted - turn);
                [next, rate + part * (turns[axis] + gusts[axis])]
            })
        };
        let truth = [0, 1].map(|axis| {
            let (mut state, mut asked) = ([[0.0; 2]; 2], [0.0; 2]);
            asked[axis] = 1.0;
            let parts = (1..1000).find(|_| {
                state = advance(state, asked, [0.0; 2]);
                state[axis][1] >= PART
            });
            part * f64::from(parts.unwrap())
        });
        let (mut state, mut gusts, mut attitude, mut seed) =
            ([[0.0; 2]; 2], [0.0; 2], [0.0; 2], 1_u32);
        let samples: Vec<Sample> = (0..4000)
            .map(|k| {
                for gust in &mut gusts {
                    seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    *gust += 0.1 * (8.0 * (f64::from(seed) / f64::from(u32::MAX) - 0.5) - *gust);
                }
                let step = if k / 80 % 2 == 0 { 0.1 } else { -0.1 };
                let other = if k / 130 % 2 == 0 { 0.1 } else { -0.1 };
                let asked = [step - 2.0 * attitude[0], other - 2.0 * attitude[1]];
                let vector = |of: [f64; 2]| Vector3::new(of[1], of[0], 0.0);
                let sample = Sample {
                    t: dt * k as f64,
                    asked: vector(asked),
                    rate: vector(state.map(|[_, rate]| rate)),
                    counts: true,
                };
                for _ in 0..PARTS {
                    state = advance(state, asked, gusts);
                }
                for (attitude, [_, rate]) in attitude.iter_mut().zip(state) {
                    *attitude += dt * rate;
                }
                sample
            })
            .collect();
        for (truth, axis) in truth.into_iter().zip([1, 0]) {
            let lag = rate_lag(&samples, axis).unwrap();
            assert!(
                (lag.value - truth).abs() < lag.within.min(dt),
                "{axis}: {lag:?} of {truth}"
            );
        }
        assert_eq!(rate_lag(&samples, 2), None);
    }
}
