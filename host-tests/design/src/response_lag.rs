//! What follows a command, and how fast: a lag of first order, by regression on the command behind it.

use nalgebra::{DMatrix, DVector};

use super::regression::{Fit, Measured, least_squares};

/// Lags that are tried first \[s\], and how often the best is refined.
const TRIED: [f64; 8] = [0.01, 0.02, 0.035, 0.06, 0.1, 0.17, 0.28, 0.45];
const REFINED: usize = 8;
/// Time over which residuals hang together \[s\].
const BLOCK: f64 = 2.0;
/// A gap \[s\] after which a response begins anew, and how long what was before is in it.
const GAP: f64 = 0.5;

/// A command and its response at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time \[s\].
    pub t: f64,
    /// The command.
    pub asked: f64,
    /// What was had of it.
    pub had: f64,
    /// What else that goes with.
    pub besides: f64,
}

/// The regression at a lag; the last unknown is what the lag lacks, times the share.
fn fit(samples: &[Sample], lag: f64) -> Option<Fit> {
    let (mut x, mut y, mut blocks) = (Vec::new(), Vec::new(), Vec::new());
    // The command behind the lag, and its derivative by it.
    let (mut behind, mut slope) = (0.0, 0.0);
    let mut begin = f64::NEG_INFINITY;
    let mut held = (f64::NEG_INFINITY, 0.0);
    for sample in samples {
        let dt = sample.t - held.0;
        if dt > GAP {
            (behind, slope) = (sample.asked, 0.0);
            begin = sample.t;
        } else {
            let rest = (-dt / lag).exp();
            slope = rest * (slope + (behind - held.1) * dt / (lag * lag));
            behind = held.1 + rest * (behind - held.1);
        }
        held = (sample.t, sample.asked);
        if sample.t - begin > GAP {
            x.extend([behind, sample.besides, 1.0, slope]);
            y.push(sample.had);
            blocks.push((sample.t / BLOCK) as usize);
        }
    }
    let x = DMatrix::from_row_iterator(y.len(), 4, x);
    let y = DVector::from_vec(y);
    // A command that rests is behind no lag.
    let moves = x.column(3).norm() > 1e-9;
    (y.len() > 40 && moves).then(|| least_squares(&x, &x, &y, &blocks))?
}

/// The lag \[s\]; none where there are too few samples, or the command rests. Where too little is asked, its interval says so.
pub fn response_lag(samples: &[Sample]) -> Option<Measured> {
    let tried = TRIED
        .iter()
        .filter_map(|lag| Some((*lag, fit(samples, *lag)?)));
    let (mut lag, mut best) = tried.min_by(|(_, a), (_, b)| a.squares.total_cmp(&b.squares))?;
    let [least, .., most] = TRIED;
    for _ in 0..REFINED {
        lag = (lag + best.estimate[3] / best.estimate[0]).clamp(0.5 * least, most);
        best = fit(samples, lag)?;
    }
    Some(best.function(|e| lag + e[3] / e[0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps there and back behind a lag: it is found, and in its interval; a command that rests tells nothing.
    #[test]
    fn the_lag_of_steps_is_found() {
        let noise = |n: usize| 0.05 * (f64::from((n * 7919 % 1009) as u32) / 504.5 - 1.0);
        let mut behind = 0.0;
        let samples: Vec<Sample> = (0..6000)
            .map(|n| {
                let asked = if n / 100 % 2 == 0 { 1.0 } else { -1.0 };
                let sample = Sample {
                    t: 0.01 * n as f64,
                    asked,
                    had: 0.8 * behind + 0.3 * (0.003 * n as f64).sin() + noise(n),
                    besides: (0.003 * n as f64).sin(),
                };
                behind += (1.0 - (-0.01_f64 / 0.07).exp()) * (asked - behind);
                sample
            })
            .collect();
        let lag = response_lag(&samples).unwrap();
        assert!((lag.value - 0.07).abs() < lag.within.min(0.003), "{lag:?}");
        let still: Vec<Sample> = samples
            .iter()
            .map(|sample| Sample {
                asked: 0.5,
                ..*sample
            })
            .collect();
        assert_eq!(response_lag(&still), None);
    }
}
