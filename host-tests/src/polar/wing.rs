//! From a section to a wing of finite span: Prandtl's lifting line up to stall, Viterna and Corrigan from there on.
//!
//! At the section's c_L the wing meets the air at α + c_L/(π AR e) and has the drag c_D + c_L²/(π AR e) (L. Prandtl, *Applications of
//! Modern Hydrodynamics to Aeronautics*, NACA TR 116, 1921), with a span efficiency e of 0.9, that of a plain wing. From the greatest lift on
//! the table follows [`viterna`](super::viterna) with the wing's c_Dmax.

use std::f64::consts::PI;

use super::stall::stall;
use super::viterna::{Seam, Upto, extended};

/// Span efficiency e.
pub const SPAN_EFFICIENCY: f64 = 0.9;
/// Farthest from 0 that a section's flow is taken for attached \[°\]: lift grows again behind the stall, up to 45°.
const FARTHEST: f64 = 30.0;

/// The rows of a wing of `aspect_ratio` with the section `rows` \[°, c_L, c_D\], from 0 or from below. Of a section that was extended itself,
/// the rows that were `given`, from and to, alone can be attached.
pub fn of_section(
    rows: &[[f64; 3]],
    given: Option<[f64; 2]>,
    aspect_ratio: f64,
) -> Result<(Vec<[f64; 3]>, Seam), String> {
    let induced = 1.0 / (PI * aspect_ratio * SPAN_EFFICIENCY);
    let [from, to] = given.unwrap_or([-FARTHEST, FARTHEST]);
    let (from, to) = (from.max(-FARTHEST) - 1e-9, to.min(FARTHEST) + 1e-9);
    let inside: Vec<[f64; 3]> = (rows.iter().copied())
        .filter(|row| (from..=to).contains(&row[0]))
        .collect();
    let attached = attached(&inside);
    let mut wing: Vec<[f64; 3]> = Vec::new();
    for &[degrees, lift, drag] in attached {
        let alpha = degrees + (lift * induced).to_degrees();
        // In a kink, where lift falls, a wing of small span would go back to smaller angles: that row is left out.
        if wing.last().is_none_or(|last| alpha > last[0] + 1e-3) {
            wing.push([alpha, lift, drag + lift * lift * induced]);
        }
    }
    let (rows, seam) = extended(&wing, Some(aspect_ratio))?;
    let section = attached.first().zip(attached.last());
    let section = section.map(|(first, last)| [first[0], last[0]]);
    let upto = section.map_or(seam.upto, Upto::Section);
    Ok((rows, Seam { upto, ..seam }))
}

/// The rows from the stall below to the stall above.
fn attached(rows: &[[f64; 3]]) -> &[[f64; 3]] {
    let zero = rows.partition_point(|row| row[0] < -1e-9);
    let (below, above) = rows.split_at(zero);
    let last = zero + greatest(above.iter().map(|row| row[1]).collect());
    let first = match zero {
        0 => 0,
        _ => zero - 1 - greatest(below.iter().rev().map(|row| -row[1]).collect()),
    };
    rows.get(first..=last).unwrap_or(rows)
}

/// Place of the stall, or of the greatest lift where nothing stalls.
fn greatest(lift: Vec<f64>) -> usize {
    let most = || {
        let all = lift.iter().enumerate();
        all.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(i, _)| i)
    };
    stall(lift.iter().copied()).unwrap_or_else(most)
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
        let (wing, seam) = of_section(&rows, None, 6.0).unwrap();
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
            let (rows, seam) = of_section(&section.degrees(), None, 5.0).unwrap();
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

    /// c_L 0.1 per degree with a round stall at 12°, and past it to 24°.
    fn section(kink: f64) -> Vec<[f64; 3]> {
        let lift = |a: f64| match a {
            5.5 => 0.5 - kink,
            a if a <= 8.0 => 0.1 * a,
            a => 1.0 - 0.2 * ((12.0 - a) / 4.0).powi(2),
        };
        let rows = (0..=48).map(|n| 0.5 * f64::from(n));
        rows.map(|a| [a, lift(a), 0.01 + 0.0002 * a * a]).collect()
    }

    /// A row that is lower by 0.005 than the one before it is not where the wing stalls, and no row goes back.
    #[test]
    fn a_kink_does_not_cut_the_wing() {
        for ratio in [0.5, 6.0, 50.0] {
            let (_, clean) = of_section(&section(-0.05), None, ratio).unwrap();
            let (rows, kinked) = of_section(&section(0.005), None, ratio).unwrap();
            assert_eq!(kinked.upto, Upto::Section([0.0, 12.0]));
            assert_eq!(clean.given_deg, kinked.given_deg);
            assert!(rows.windows(2).all(|pair| pair[1][0] > pair[0][0]));
        }
    }

    /// Of a section that ends at 9°, with little lift, the extension has more lift than its last row: it is extension all the same.
    #[test]
    fn what_was_extended_is_not_attached() {
        let given: Vec<[f64; 3]> = (0..=9)
            .map(f64::from)
            .map(|a: f64| [a, 0.09 * a - 0.0035 * a * a, 0.02])
            .collect();
        let (whole, seam) = extended(&given, None).unwrap();
        assert!(
            whole
                .iter()
                .any(|row| row[0] > 12.0 && row[1] > given[9][1])
        );
        let (_, wing) = of_section(&whole, Some(seam.given_deg), 6.0).unwrap();
        assert_eq!(wing.upto, Upto::Section([0.0, 9.0]));
    }
}
