//! How fast the thrust follows the throttle: the motors' speed is behind the throttle's root by a lag of first order.
//!
//! f = c_1 n² + c_2 n v + c_3, n = √u behind the lag, in hover
//!
//! Gusts and noise are in the force, and who flies answers them with the throttle. So the residuals are told from their own past, and what is left of that is what
//! the lag is fitted to (generalised least squares; Ljung, *System Identification*, chapter 7).

use nalgebra::{DMatrix, DVector};

use super::lag::{Even, behind};
use super::regression::{Fit, Measured, least_squares};

/// Lags that are tried first \[s\], how often the best is refined, and the residuals told anew.
const TRIED: [f64; 8] = [0.01, 0.02, 0.035, 0.06, 0.1, 0.17, 0.28, 0.45];
const REFINED: usize = 6;
const TOLD: usize = 4;
/// Rows of their past from which residuals are told.
const PAST: usize = 10;
/// Time over which residuals hang together \[s\].
const BLOCK: f64 = 2.0;
/// Unknowns: of thrust, of the air along the nose, a constant, and what the lag lacks, times the first.
const UNKNOWNS: usize = 4;

/// A throttle and what was had of it at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Time \[s\].
    pub(super) t: f64,
    /// u.
    pub(super) throttle: f64,
    /// Air velocity along the nose [m/s].
    pub(super) along: f64,
    /// Specific force along the nose [m/s²].
    pub(super) force: f64,
}

/// Samples, and those of them whose past is known.
struct Samples<'a> {
    all: &'a [Sample],
    even: Even,
}

impl Samples<'_> {
    fn rows(&self, lag: f64) -> Vec<[f64; UNKNOWNS]> {
        let root = |sample: &Sample| [sample.t, sample.throttle.max(0.0).sqrt()];
        let speeds = behind(self.all.iter().map(root), lag);
        let of = speeds.iter().zip(self.all);
        of.map(|(n, sample)| {
            [
                n.value * n.value,
                n.value * sample.along,
                1.0,
                2.0 * n.value * n.by_lag,
            ]
        })
        .collect()
    }

    /// The regression at a lag, with residuals that are told from their past so.
    fn fit(&self, lag: f64, past: &[f64]) -> Option<Fit> {
        let rows = self.rows(lag);
        let told = |value: &dyn Fn(usize) -> f64, n: usize| {
            let past = past.iter().enumerate();
            value(n) - past.map(|(i, share)| share * value(n - 1 - i)).sum::<f64>()
        };
        let known = &self.even.known;
        let x = DMatrix::from_fn(known.len(), UNKNOWNS, |i, j| {
            told(&|n| rows[n][j], known[i])
        });
        let y = DVector::from_fn(known.len(), |i, _| told(&|n| self.all[n].force, known[i]));
        let blocks = known.iter().map(|n| (self.all[*n].t / BLOCK) as usize);
        let blocks: Vec<usize> = blocks.collect();
        // A throttle that rests is behind no lag.
        let moves = x.column(UNKNOWNS - 1).norm() > 1e-9;
        moves.then(|| least_squares(&x, &x, &y, &blocks))?
    }

    /// How residuals are told from their past.
    fn past(&self, lag: f64, fit: &Fit) -> Option<Vec<f64>> {
        let rows = self.rows(lag);
        let guess = |row: &[f64; UNKNOWNS]| -> f64 {
            row.iter().zip(&fit.estimate).map(|(x, e)| x * e).sum()
        };
        let left = rows.iter().zip(self.all);
        let left: Vec<f64> = left.map(|(row, of)| of.force - guess(row)).collect();
        let known = &self.even.known;
        let x = DMatrix::from_fn(known.len(), PAST, |i, j| left[known[i] - 1 - j]);
        let y = DVector::from_fn(known.len(), |i, _| left[known[i]]);
        let blocks = vec![0; y.len()];
        Some(
            least_squares(&x, &x, &y, &blocks)?
                .estimate
                .as_slice()
                .to_vec(),
        )
    }
}

/// The lag \[s\]; none where there are too few samples, or the throttle rests. Where it moves too little, its interval says so.
pub(super) fn thrust_lag(all: &[Sample]) -> Option<Measured> {
    let times: Vec<f64> = all.iter().map(|sample| sample.t).collect();
    let even = Even::of(&times, PAST)?;
    let samples = Samples { all, even };
    if samples.even.known.len() < 10 * PAST {
        return None;
    }
    let tried = TRIED
        .iter()
        .filter_map(|lag| Some((*lag, samples.fit(*lag, &[])?)));
    let (mut lag, mut best) = tried.min_by(|(_, a), (_, b)| a.squares.total_cmp(&b.squares))?;
    let [least, .., most] = TRIED;
    for _ in 0..TOLD {
        let past = samples.past(lag, &best)?;
        for _ in 0..REFINED {
            best = samples.fit(lag, &past)?;
            lag = (lag + best.estimate[3] / best.estimate[0]).clamp(0.5 * least, most);
        }
        best = samples.fit(lag, &past)?;
    }
    let measured = best.function(|e| lag + e[3] / e[0]);
    Some(samples.even.within_a_row(measured))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of the throttle there and back, in gusts that last and that are answered with the throttle: the lag is found, and in its interval. A throttle that rests
    /// tells nothing.
    #[test]
    fn the_lag_of_steps_is_found_in_gusts() {
        let noise = |n: usize, by: usize| f64::from((n * by % 1009) as u32) / 504.5 - 1.0;
        let (mut n, mut gust, mut force) = (0.7_f64, 0.0, 9.8);
        let samples: Vec<Sample> = (0..6000)
            .map(|k| {
                gust += 0.02 * (3.0 * noise(k, 7919) - gust);
                let step = if k / 100 % 2 == 0 { 0.04 } else { -0.04 };
                // The answer is to what was measured.
                let throttle = 0.49 + step - 0.01 * (force - 9.8);
                force = 20.0 * n * n + 5.0 * gust + 0.3 * noise(k, 577);
                let sample = Sample {
                    t: 0.01 * k as f64,
                    throttle,
                    along: 0.0,
                    force,
                };
                n += (1.0 - (-0.01_f64 / 0.07).exp()) * (throttle.sqrt() - n);
                sample
            })
            .collect();
        let lag = thrust_lag(&samples).unwrap();
        assert!((lag.value - 0.07).abs() < lag.within.min(0.004), "{lag:?}");
        let rests = |sample: &Sample| Sample {
            throttle: 0.5,
            ..*sample
        };
        assert_eq!(
            thrust_lag(&samples.iter().map(rests).collect::<Vec<_>>()),
            None
        );
    }
}
