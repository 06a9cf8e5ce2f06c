//! A slope from waves: pulls and pushes, or swings of the course, that set-points ask for, and no gust does.
//!
//! The angle to the air that an estimator tells lacks the gusts, and who flies answers them: a regression on it finds too small a slope, in waves too. So it is
//! taken as far as it goes with the acceleration that was asked for, at four delays (two-stage least squares). Force, angle and what was asked for are looked
//! at within seconds: the errors of a drifting attitude, and of the gusts of level flight, are longer than that.

use nalgebra::{DMatrix, DVector, Vector3};

use super::flown::{RATE, Row};
use super::lag::GAP;
use super::regression::{Measured, least_squares};

/// Time within which a change is looked at, and of blocks whose residuals hang together \[s\].
const WITHIN: f64 = 1.0;
const BLOCK: f64 = 5.0;
/// Delays \[s\] of the vehicle behind what is asked for, and the time over which that is averaged.
const DELAYS: [f64; 4] = [0.0, 0.2, 0.4, 0.6];
const AVERAGED: f64 = 0.2;
/// Least root mean square of an acceleration asked for that makes waves [m/s²], within [`WITHIN`].
const MOVES: f64 = 0.5;
/// Rows in a time \[s\].
const fn rows_in(time: f64) -> usize {
    (time * RATE + 0.5) as usize
}

/// A row on the wing: a force as a sum of unknowns.
pub(super) struct Sample<const N: usize> {
    /// Its place among the rows.
    pub(super) place: usize,
    /// The force [m/s²].
    pub(super) force: f64,
    /// What the unknowns are multiplied by, the slope last [m/s²].
    pub(super) by: [f64; N],
}

/// The acceleration that was asked for, in the mean, towards north, east and down [m/s²] at each row; zero where none was.
pub(super) fn asked(rows: &[Row]) -> Vec<Vector3<f64>> {
    let half = rows_in(0.5 * AVERAGED).max(1);
    let asked = (0..rows.len()).map(|n| {
        let (from, to) = (n.saturating_sub(half), (n + half).min(rows.len() - 1));
        let (from, to) = (&rows[from], &rows[to]);
        let time = to.t - from.t;
        let near = time < GAP;
        let change = (to.wanted - from.wanted) / time.max(1e-6);
        change.map(|change| {
            if near && change.is_finite() {
                change
            } else {
                0.0
            }
        })
    });
    asked.collect()
}

/// What of a column of rows that follow each other is not older than [`WITHIN`].
fn recent(column: impl Iterator<Item = f64>) -> Vec<f64> {
    let rest = (-1.0 / (RATE * WITHIN)).exp();
    let (mut last, mut recent) = (None, 0.0);
    let next = column.map(|x| {
        recent = rest * recent + x - last.unwrap_or(x);
        last = Some(x);
        recent
    });
    next.collect()
}

/// Speed, one over it, and what was asked for at its delays.
const INSTRUMENTS: usize = 2 + DELAYS.len();

/// The instruments of a row: all over the speed, so that gusts are as great in each, as force and regressors are.
fn instruments(rows: &[Row], asked: &[f64], place: usize) -> [f64; INSTRUMENTS] {
    let speed = rows[place].speed();
    let mut instruments = [0.0; INSTRUMENTS];
    instruments[0] = speed;
    instruments[1] = 1.0 / speed;
    for (instrument, delay) in instruments[2..].iter_mut().zip(DELAYS) {
        let before = place.checked_sub(rows_in(delay));
        *instrument = before.map_or(0.0, |n| asked[n]) / speed;
    }
    instruments
}

/// The slope of what is flown in `rows`, of which `samples` are on the wing, as far as it goes with the acceleration `asked` for across the path; none where no
/// waves were.
pub(super) fn slope<const N: usize>(
    rows: &[Row],
    asked: &[f64],
    samples: &[Sample<N>],
) -> Option<Measured> {
    let mut force = Vec::new();
    let mut told: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    let mut wanted: [Vec<f64>; INSTRUMENTS] = Default::default();
    let (mut blocks, mut still) = (Vec::new(), 0.0);
    for run in samples.chunk_by(|a, b| rows[b.place].t - rows[a.place].t <= GAP) {
        if run.len() <= rows_in(WITHIN) {
            continue;
        }
        let speed = |sample: &Sample<N>| rows[sample.place].speed();
        force.extend(recent(run.iter().map(|of| of.force / speed(of))));
        for (n, told) in told.iter_mut().enumerate() {
            told.extend(recent(run.iter().map(|of| of.by[n] / speed(of))));
        }
        let of_run = run.iter().map(|of| instruments(rows, asked, of.place));
        let of_run: Vec<_> = of_run.collect();
        for (n, wanted) in wanted.iter_mut().enumerate() {
            wanted.extend(recent(of_run.iter().map(|of| of[n])));
        }
        still += run
            .iter()
            .map(|of| (MOVES / speed(of)).powi(2))
            .sum::<f64>();
        let since = |sample: &Sample<N>| rows[sample.place].t - rows[0].t;
        blocks.extend(run.iter().map(|sample| (since(sample) / BLOCK) as usize));
    }
    // What little goes with what was hardly asked for is chance.
    if wanted[2].iter().map(|asked| asked.powi(2)).sum::<f64>() <= still {
        return None;
    }
    let matrix = |of: &[Vec<f64>]| DMatrix::from_fn(blocks.len(), of.len(), |i, j| of[j][i]);
    let (told, wanted) = (matrix(&told), matrix(&wanted));
    let seen = wanted
        .tr_mul(&wanted)
        .svd(true, true)
        .solve(&wanted.tr_mul(&told), 1e-12);
    let seen = &wanted * seen.ok()?;
    let force = DVector::from_column_slice(&force);
    Some(least_squares(&seen, &told, &force, &blocks)?.measured(N - 1)).filter(Measured::is_known)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A minute of pulls and pushes in gusts that the vehicle moves with: what is asked for shows the slope, and the angle as it is told one that is far too
    /// small. Without pulls and pushes nothing is shown.
    #[test]
    fn the_slope_is_that_of_what_was_asked_for() {
        let (speed, k, zero, slope) = (18.0, 0.1, 0.03, 3.2);
        let pressure = k * speed * speed;
        let flown = |most: f64| {
            let (mut gust, mut seed) = (0.0, 1_u32);
            let asked = |t: f64| most * (2.0 * t).sin();
            let both = (0..1500).map(|n| {
                let t = f64::from(n) / RATE;
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let step = f64::from(seed) / f64::from(u32::MAX) - 0.5;
                gust = 0.96 * gust + 0.016 * step;
                let wanted = (9.81 + asked(t - 0.2)) / pressure;
                let told = (wanted - zero) / slope - 0.8 * gust;
                let row = Row {
                    t,
                    air: speed * Vector3::new(told.cos(), 0.0, told.sin()),
                    // Its change is the acceleration down.
                    wanted: 0.5 * most * (2.0 * t).cos() * Vector3::z(),
                    ..Row::default()
                };
                let sample = Sample {
                    place: n as usize,
                    force: pressure * (zero + slope * (told + gust)),
                    by: [pressure, pressure * told],
                };
                (row, sample)
            });
            both.unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let (rows, samples) = flown(5.0);
        let down = |rows: &[Row]| asked(rows).iter().map(|a| a.z).collect::<Vec<_>>();
        let seen = super::slope(&rows, &down(&rows), &samples).unwrap();
        assert!((seen.value / slope - 1.0).abs() < 0.05, "{seen:?}");
        assert!((seen.value - slope).abs() < seen.within && seen.within < 0.1 * slope);
        let x = DMatrix::from_fn(rows.len(), 2, |i, j| [1.0, rows[i].alpha()][j]);
        let y = DVector::from_fn(rows.len(), |i, _| samples[i].force / pressure);
        let plain = least_squares(&x, &x, &y, &vec![0; rows.len()]).unwrap();
        assert!(plain.estimate[1] < 0.9 * slope, "{}", plain.estimate[1]);
        let (rows, samples) = flown(0.0);
        assert_eq!(super::slope(&rows, &down(&rows), &samples), None);
    }
}
