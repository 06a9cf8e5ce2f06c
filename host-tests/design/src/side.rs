//! The side force over the sideslip, from swings of the course that set-points ask for: `waves`.
//!
//! f_y = −V k_a/m c_Y v_y, with v_y the air velocity towards the right wing, V with it: as the core has it (`aerodynamic_force`). What is not the same to either side
//! does not change within a second.

use nalgebra::Vector3;

use super::flown::{Row, SLOW};
use super::regression::Measured;
use super::waves::{self, Sample};

/// The acceleration asked for to the right of the level velocity that was asked for [m/s²]; zero where that is slow.
fn across(wanted: Vector3<f64>, asked: Vector3<f64>) -> f64 {
    let level = wanted.x.hypot(wanted.y);
    match level > SLOW {
        true => (wanted.x * asked.y - wanted.y * asked.x) / level,
        false => 0.0,
    }
}

/// c_Y of what is flown on the wing; `k` is k_a/m. None where no swings were asked for.
pub(super) fn c_y(rows: &[Row], k: f64) -> Option<Measured> {
    let wing = rows.iter().enumerate();
    let wing = wing.filter(|(_, row)| row.attached() && row.speed() > 2.0 * SLOW);
    let samples = wing.map(|(place, row)| Sample {
        place,
        force: row.side,
        by: [-k * row.air.norm() * row.air.y],
    });
    let asked = waves::asked(rows);
    let both = rows.iter().zip(asked);
    let asked: Vec<f64> = both.map(|(row, asked)| across(row.wanted, asked)).collect();
    waves::slope(rows, &asked, &samples.collect::<Vec<_>>()).filter(|c_y| c_y.value > 0.0)
}

#[cfg(test)]
mod tests {
    use super::super::flown::RATE;
    use super::super::regression::least_squares;
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// 100 s of swings of a course to the north-west, in gusts from the side that the vehicle moves with and that are not told, with a heading that is off by 2° and a
    /// vehicle that pushes to one side: what was asked for shows c_Y, and the sideslip as it is told one that is far too small. Without swings nothing is shown.
    #[test]
    fn the_side_force_is_that_of_swings() {
        let (speed, k, truth) = (18.0, 0.1, 0.4);
        let flown = |most: f64| -> Vec<Row> {
            let (mut gust, mut seed) = (0.0, 1_u32);
            let rows = (0..2500).map(|n| {
                let t = f64::from(n) / RATE;
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let step = f64::from(seed) / f64::from(u32::MAX) - 0.5;
                gust = 0.96 * gust + 0.25 * step;
                // The sideslip is behind the acceleration to the right, and to the other side.
                let acceleration = |t: f64| most * (2.0 * t).sin();
                let told = -0.25 * acceleration(t - 0.3) - 0.8 * gust;
                let right = -0.5 * most * (2.0 * t).cos();
                let ahead = Vector3::new(speed, -speed, 0.0).normalize();
                Row {
                    t,
                    air: Vector3::new(speed, told + 0.035 * speed, 0.0),
                    wanted: speed * ahead + right * Vector3::new(1.0, 1.0, 0.0).normalize(),
                    side: -k * speed * truth * (told + gust) + 0.2,
                    ..Row::default()
                }
            });
            rows.collect()
        };
        let rows = flown(3.0);
        let found = c_y(&rows, k).unwrap();
        assert!((found.value - truth).abs() < found.within, "{found:?}");
        assert!(found.within < 0.1 * truth, "{found:?}");
        let x = DMatrix::from_fn(rows.len(), 2, |i, j| [1.0, -k * speed * rows[i].air.y][j]);
        let y = DVector::from_fn(rows.len(), |i, _| rows[i].side);
        let plain = least_squares(&x, &x, &y, &vec![0; rows.len()]).unwrap();
        assert!(plain.estimate[1] < 0.9 * truth, "{}", plain.estimate[1]);
        assert_eq!(c_y(&flown(0.0), k), None);
    }
}
