//! The slope of c_L from waves: pulls and pushes that set-points ask for, and no gust does.
//!
//! The angle of attack that an estimator tells lacks the gusts, and who flies answers them: a regression on it finds too small a slope, in waves too. So it is
//! taken as far as it goes with the acceleration that was asked for, at four delays (two-stage least squares). Force, angle and what was asked for are looked
//! at within seconds: the errors of a drifting attitude, and of the gusts of level flight, are longer than that.

use nalgebra::{DMatrix, DVector};

use super::flown::{RATE, Row};
use super::lag::GAP;
use super::regression::{Measured, least_squares};

/// Time within which a change is looked at, and of blocks whose residuals hang together \[s\].
const WITHIN: f64 = 1.0;
const BLOCK: f64 = 5.0;
/// Delays \[s\] of the vehicle behind what is asked for, and the time over which that is averaged.
const DELAYS: [f64; 4] = [0.0, 0.2, 0.4, 0.6];
const AVERAGED: f64 = 0.2;
/// Rows in a time \[s\].
const fn rows_in(time: f64) -> usize {
    (time * RATE + 0.5) as usize
}

/// A row on the wing.
pub(super) struct Sample {
    /// Its place among the rows.
    pub(super) place: usize,
    /// Pressure over the load of the wing, k_a/m V² [m/s²], and by what share that in the slipstream is greater.
    pub(super) pressure: f64,
    pub(super) blown: f64,
    /// Force of the wing across the path [m/s²].
    pub(super) lift: f64,
}

/// The acceleration down that was asked for, in the mean, at each row; zero where nothing was.
pub(super) fn asked(rows: &[Row]) -> Vec<f64> {
    let half = rows_in(0.5 * AVERAGED).max(1);
    let asked = (0..rows.len()).map(|n| {
        let (from, to) = (n.saturating_sub(half), (n + half).min(rows.len() - 1));
        let (from, to) = (&rows[from], &rows[to]);
        let change = (to.sinks - from.sinks) / (to.t - from.t).max(1e-6);
        let near = to.t - from.t < GAP;
        if near && change.is_finite() {
            change
        } else {
            0.0
        }
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

/// Lift, the unknowns' regressors and the instruments of a row: all over the speed, so that gusts are as great in each.
fn columns(rows: &[Row], asked: &[f64], sample: &Sample) -> [f64; COLUMNS] {
    let row = &rows[sample.place];
    let (speed, load) = (row.speed(), sample.pressure / row.speed());
    let mut columns = [0.0; COLUMNS];
    columns[0] = sample.lift / speed;
    columns[1] = load * (1.0 + sample.blown);
    columns[2] = load * (1.0 + 0.5 * sample.blown) * row.alpha();
    columns[3] = speed;
    columns[4] = 1.0 / speed;
    for (column, delay) in columns[5..].iter_mut().zip(DELAYS) {
        let before = sample.place.checked_sub(rows_in(delay));
        *column = before.map_or(0.0, |n| asked[n]) / speed;
    }
    columns
}

const COLUMNS: usize = 5 + DELAYS.len();

/// The slope [1/rad] of what is flown in `rows`, of which `samples` are on the wing; none where no waves were asked for.
pub(super) fn slope(rows: &[Row], samples: &[Sample]) -> Option<Measured> {
    let asked = asked(rows);
    let mut all: [Vec<f64>; COLUMNS] = Default::default();
    let mut blocks = Vec::new();
    for run in samples.chunk_by(|a, b| rows[b.place].t - rows[a.place].t <= GAP) {
        if run.len() <= rows_in(WITHIN) {
            continue;
        }
        let of_run: Vec<_> = run
            .iter()
            .map(|sample| columns(rows, &asked, sample))
            .collect();
        for (n, all) in all.iter_mut().enumerate() {
            all.extend(recent(of_run.iter().map(|columns| columns[n])));
        }
        let since = |sample: &Sample| rows[sample.place].t - rows[0].t;
        blocks.extend(run.iter().map(|sample| (since(sample) / BLOCK) as usize));
    }
    let matrix = |of: &[Vec<f64>]| DMatrix::from_fn(blocks.len(), of.len(), |i, j| of[j][i]);
    let (told, asked) = (matrix(&all[1..3]), matrix(&all[3..]));
    let seen = asked
        .tr_mul(&asked)
        .svd(true, true)
        .solve(&asked.tr_mul(&told), 1e-12);
    let seen = &asked * seen.ok()?;
    let lift = DVector::from_column_slice(&all[0]);
    Some(least_squares(&seen, &told, &lift, &blocks)?.measured(1)).filter(Measured::is_known)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

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
                    held_alpha: 0.0,
                    force: [0.0; 2],
                    throttle: 0.5,
                    asked: 0.0,
                    rate: 0.0,
                    turn: 0.0,
                    climb: 0.0,
                    torque: 0.0,
                    short: false,
                    // Its change is the acceleration down.
                    sinks: 0.5 * most * (2.0 * t).cos(),
                };
                let sample = Sample {
                    place: n as usize,
                    pressure,
                    blown: 0.0,
                    lift: pressure * (zero + slope * (told + gust)),
                };
                (row, sample)
            });
            both.unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let (rows, samples) = flown(5.0);
        let seen = super::slope(&rows, &samples).unwrap();
        assert!((seen.value / slope - 1.0).abs() < 0.05, "{seen:?}");
        assert!((seen.value - slope).abs() < seen.within && seen.within < 0.1 * slope);
        let x = DMatrix::from_fn(rows.len(), 2, |i, j| [1.0, rows[i].alpha()][j]);
        let y = DVector::from_fn(rows.len(), |i, _| samples[i].lift / pressure);
        let plain = least_squares(&x, &x, &y, &vec![0; rows.len()]).unwrap();
        assert!(plain.estimate[1] < 0.9 * slope, "{}", plain.estimate[1]);
        let (rows, samples) = flown(0.0);
        assert_eq!(super::slope(&rows, &samples), None);
    }
}
