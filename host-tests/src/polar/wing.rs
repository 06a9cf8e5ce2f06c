//! From a section to a wing of finite span: Prandtl's lifting line up to stall, Viterna and Corrigan from there on.
//!
//! At the section's c_L the wing meets the air at α + c_L/(π AR e) and has the drag c_D + c_L²/(π AR e) (L. Prandtl, *Applications of
//! Modern Hydrodynamics to Aeronautics*, NACA TR 116, 1921), with a span efficiency e of 0.9, that of a plain wing. From the greatest lift on
//! the table follows [`viterna`](super::viterna) with the wing's c_Dmax.

use std::f64::consts::PI;

use super::viterna::{Seam, extended};

/// Span efficiency e.
pub const SPAN_EFFICIENCY: f64 = 0.9;

/// The rows of a wing of `aspect_ratio` with the section `rows` \[°, c_L, c_D\], from 0 or from below.
pub fn of_section(rows: &[[f64; 3]], aspect_ratio: f64) -> Result<(Vec<[f64; 3]>, Seam), String> {
    let induced = 1.0 / (PI * aspect_ratio * SPAN_EFFICIENCY);
    let attached = attached(rows);
    let wing: Vec<[f64; 3]> = attached
        .iter()
        .map(|&[degrees, lift, drag]| {
            [
                degrees + (lift * induced).to_degrees(),
                lift,
                drag + lift * lift * induced,
            ]
        })
        .collect();
    extended(&wing, Some(aspect_ratio))
}

/// The rows from the least lift below to the greatest above, next to 0.
fn attached(rows: &[[f64; 3]]) -> &[[f64; 3]] {
    let zero = rows.partition_point(|row| row[0] < -1e-9);
    let above = (zero + 1..rows.len()).find(|&i| rows[i][1] <= rows[i - 1][1]);
    let below = (1..=zero.min(rows.len() - 1))
        .rev()
        .find(|&i| rows[i - 1][1] >= rows[i][1]);
    &rows[below.unwrap_or(0)..above.unwrap_or(rows.len())]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polar::Polar;

    /// The lift slope of a thin section, 2π, becomes 2π/(1 + 2/(AR e)); and drag grows by the square of lift.
    #[test]
    fn the_lift_slope_is_prandtls() {
        let slope = 2.0 * PI;
        let rows: Vec<[f64; 3]> = (0..=10)
            .map(f64::from)
            .map(|a: f64| [a, slope * a.to_radians(), 0.01])
            .collect();
        let (wing, seam) = of_section(&rows, 6.0).unwrap();
        let [degrees, lift, drag] = wing[5];
        let want = slope / (1.0 + 2.0 / (6.0 * SPAN_EFFICIENCY));
        assert!((lift / degrees.to_radians() / want - 1.0).abs() < 1e-12);
        assert!((drag - 0.01 - lift * lift / (PI * 6.0 * SPAN_EFFICIENCY)).abs() < 1e-12);
        assert!((seam.most_drag - 1.218).abs() < 1e-12);
    }

    #[test]
    fn the_presets_become_wings() {
        for (name, _) in crate::polar::BUILT_IN {
            let section = Polar::load(name).unwrap();
            let (rows, seam) = of_section(&section.degrees(), 5.0).unwrap();
            // The greatest lift stays; what lies behind it is made.
            let most = rows
                .iter()
                .fold(0.0, |most: f64, row| match row[0] <= seam.given_deg[1] {
                    true => most.max(row[1]),
                    false => most,
                });
            assert!(
                most > 0.7 && Polar::from_rows("x", &[], &rows).is_ok(),
                "{name}"
            );
        }
    }
}
