//! From a section to a wing of finite span: Prandtl's lifting line up to stall, Viterna and Corrigan from there on.
//!
//! At the section's c_L the wing meets the air at α + c_L/(π AR e) and has the drag c_D + c_L²/(π AR e) (L. Prandtl, *Applications of
//! Modern Hydrodynamics to Aeronautics*, NACA TR 116, 1921), with a span efficiency e of 0.9, that of a plain wing. From where lift has fallen
//! behind its greatest the table follows [`viterna`](super::viterna) with the wing's c_Dmax.

use std::f64::consts::PI;

use super::spacing::{CLOSEST, spaced};
use super::stall::Attached;
use super::viterna::{Seam, Upto, extended};

/// Span efficiency e.
pub const SPAN_EFFICIENCY: f64 = 0.9;

/// The rows of a wing of `aspect_ratio` with the section `rows` \[°, c_L, c_D\], from 0 or from below. Of a section that was extended itself,
/// the rows that were `given`, from and to, alone can be attached; they go up to the stall if it was `told`.
pub fn of_section(
    rows: &[[f64; 3]],
    given: Option<[f64; 2]>,
    told: bool,
    aspect_ratio: f64,
) -> Result<(Vec<[f64; 3]>, Seam), String> {
    let induced = 1.0 / (PI * aspect_ratio * SPAN_EFFICIENCY);
    let [from, to] = given.unwrap_or([-90.0, 90.0]);
    let (from, to) = (from - 1e-9, to + 1e-9);
    let inside: Vec<[f64; 3]> = (rows.iter().copied())
        .filter(|row| (from..=to).contains(&row[0]))
        .collect();
    let [least, low, high, most] = attached(&inside, told).ok_or("there are no rows")?;
    let of_wing = |&[degrees, lift, drag]: &[f64; 3]| {
        let alpha = degrees + (lift * induced).to_degrees();
        [alpha, lift, drag + lift * lift * induced]
    };
    // In a kink, where lift falls, rows come closer, and those of a wing of small span go back to smaller angles.
    let mut wing = spaced(inside[low..=high].iter().map(of_wing).collect());
    // Behind the stalls, those that go on.
    let mut used = [low, high];
    let places = || inside.iter().enumerate();
    for (i, row) in places().take(most + 1).skip(high + 1) {
        let row = of_wing(row);
        if wing.last().is_some_and(|last| row[0] - last[0] >= CLOSEST) {
            wing.push(row);
            used[1] = i;
        }
    }
    for (i, row) in places().take(low).skip(least).rev() {
        let row = of_wing(row);
        if wing
            .first()
            .is_some_and(|first| first[0] - row[0] >= CLOSEST)
        {
            wing.insert(0, row);
            used[0] = i;
        }
    }
    let section = used.map(|i| inside[i][0]);
    let [degrees, _] = section;
    if let Some(first) = wing.first().filter(|first| degrees < 0.0 && first[0] > 0.0) {
        return Err(format!(
            "its rows begin at {:.1}°, of the section at {degrees}°: rows below are needed, down to where it has no lift",
            first[0]
        ));
    }
    let (rows, seam) = extended(&wing, Some(aspect_ratio))?;
    let upto = Upto::Section(section);
    Ok((rows, Seam { upto, ..seam }))
}

/// The places in `rows` up to which they are used below, of the stalls below and above, and up to which they are used above: as long as lift has not
/// fallen behind a stall. The last is the stall if it was `told`. None without rows.
fn attached(rows: &[[f64; 3]], told: bool) -> Option<[usize; 4]> {
    let last = rows.len().checked_sub(1)?;
    let above = Attached::of(rows).filter(|_| !told);
    let [high, most] = above.map_or([last; 2], |above| [above.top, above.end]);
    let below = Attached::inverted(rows).filter(|below| rows[below.top][0] < 0.0);
    let [least, low] = below.map_or([0; 2], |below| [below.end, below.top]);
    Some([least, low.min(high), high, most])
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
        let (wing, seam) = of_section(&rows, None, false, 6.0).unwrap();
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
            let (rows, seam) = of_section(&section.degrees(), None, false, 5.0).unwrap();
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
            let (_, clean) = of_section(&section(-0.05), None, false, ratio).unwrap();
            let (rows, kinked) = of_section(&section(0.005), None, false, ratio).unwrap();
            assert_eq!(clean, kinked);
            let most = rows.iter().filter(|row| row[0] <= kinked.given_deg[1]);
            assert_eq!(most.fold(0.0, |most, row| f64::max(most, row[1])), 1.0);
            assert!(rows.windows(2).all(|pair| pair[1][0] > pair[0][0]));
        }
    }

    /// A thin section has a plateau, with its greatest lift where that begins: the wing has all of it, down to where lift falls, on both sides.
    #[test]
    fn a_plateau_stays_in_the_wing() {
        let lift = |a: f64| match a {
            a if a <= 7.0 => 0.1 * a,
            a if a <= 12.0 => 0.7 - 0.004 * (a - 7.0),
            a => 0.68 - 0.08 * (a - 12.0),
        };
        let rows = |last: i32| -> Vec<[f64; 3]> {
            let row = |a: f64| [a, lift(a.abs()).copysign(a), 0.01 + 0.0002 * a * a];
            (-last..=last).map(|n| row(0.5 * f64::from(n))).collect()
        };
        // Cut where lift has fallen by a twentieth; and at the end of a table that ends before.
        for (last, used) in [(32, 12.0), (22, 11.0)] {
            for ratio in [1.5, 6.0, 20.0] {
                let (wing, seam) = of_section(&rows(last), None, false, ratio).unwrap();
                assert_eq!(seam.upto, Upto::Section([-used, used]), "{ratio}");
                let end = wing.iter().find(|row| row[0] > seam.given_deg[1] - 1e-9);
                assert_eq!(end.unwrap()[1], lift(used), "{ratio}");
            }
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
        let (_, wing) = of_section(&whole, Some(seam.given_deg), false, 6.0).unwrap();
        assert_eq!(wing.upto, Upto::Section([0.0, 9.0]));
    }

    /// Rows every tenth of a degree, with ripples: a wing of small span has them where they are read.
    #[test]
    fn fine_rows_stay_apart() {
        for ratio in [1.0, 3.0, 6.0, 12.0] {
            let lift = |a: f64| section(0.0)[(2.0 * a) as usize][1];
            let rows: Vec<[f64; 3]> = (0..=200)
                .map(|n| 0.1 * f64::from(n))
                .map(|a| [a, lift(a) - 0.02 * (7.0 * a).sin(), 0.01])
                .collect();
            let (wing, _) = of_section(&rows, None, false, ratio).unwrap();
            let polar = Polar::from_rows("x", &[], &wing);
            assert!(polar.is_ok(), "{ratio}: {:?}", polar.err());
        }
    }

    /// Where the stall is told, no fall before it is one.
    #[test]
    fn a_stall_that_is_told_decides() {
        let rows = section(0.3);
        let (_, computed) = of_section(&rows[..23], None, false, 6.0).unwrap();
        let (_, told) = of_section(&rows[..23], None, true, 6.0).unwrap();
        assert_eq!(computed.upto, Upto::Section([0.0, 11.0]));
        assert_eq!(told.upto, Upto::Section([0.0, 11.0]));
        let (_, told) = of_section(&rows[..30], None, true, 6.0).unwrap();
        assert_eq!(told.upto, Upto::Section([0.0, 14.5]));
    }

    /// A cambered section from -2° on, with lift there: of a wing of small span it begins above 0°, and that is what is said.
    #[test]
    fn a_wing_that_begins_above_zero_says_what_is_missing() {
        let rows: Vec<[f64; 3]> = (-2..=12)
            .map(f64::from)
            .map(|a: f64| [a, 0.5 + 0.1 * a, 0.01])
            .collect();
        let error = of_section(&rows, None, false, 1.0).unwrap_err();
        assert!(error.contains("of the section at -2°"), "{error}");
        assert!(of_section(&rows, None, false, 6.0).is_ok());
    }
}
