//! Polars that end at stall, extended to all angles by the method of Viterna and Corrigan.
//!
//! L. A. Viterna and R. D. Corrigan, *Fixed pitch rotor performance of large horizontal axis wind turbines*, DOE/NASA Workshop on Large
//! Horizontal Axis Wind Turbines, 1981 (NASA CP-2230). From the last row (α_s, c_Ls, c_Ds) to 90°
//!
//! c_D = B_1 sin²α + B_2 cos α, c_L = (B_1/2) sin 2α + A_2 cos²α / sin α,
//!
//! with B_1 = c_Dmax = 1.11 + 0.018 AR (at most 2.01, where the aspect ratio AR is 50), and A_2 and B_2 such that the last row is met.
//!
//! Where the last row still has the suction of attached flow, that B_2 would keep it up to 90°. Separated flow has none: from 20° on the force is normal to
//! the chord, c_D = c_L tan α, which is B_2 = A_2, as J. L. Tangler and J. D. Kocurek have it (*Wind turbine post-stall airfoil performance characteristics
//! guidelines for blade-element momentum methods*, AIAA 2005-591). B_2 goes there from the last row in a straight line, over 5° at least.
//!
//! Beyond 90° as S. A. Ning's AirfoilPrep (NREL) has it: the flow comes from behind, mirrored, with 0.7 of the lift, and lift falls to
//! zero in a straight line from 180° − α_s to 180°.

/// Lift of a section that meets the air with its tail, relative to that with its nose (AirfoilPrep's `cl_adj`).
const TAIL_FIRST: f64 = 0.7;
/// Least angle \[°\] to which a table must reach: below it stands no stall that could be met.
pub const LEAST_STALL: f64 = 5.0;
/// Distance of the rows made \[°\].
const STEP: f64 = 5.0;
/// From where on the force is normal to the chord, and least angle in which it gets there \[°\].
const SEPARATED: f64 = 20.0;
const SEPARATES: f64 = 5.0;

/// What stands up to the seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Upto {
    /// The rows of the table, as they were given.
    Given,
    /// A wing made of the rows of a section between these \[°\], before its lift has fallen behind its stall below and above.
    Section([f64; 2]),
}

/// Where a table was extended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// First and last angle of the table up to the extension \[°\].
    pub given_deg: [f64; 2],
    /// What it is up to there.
    pub upto: Upto,
    /// c_Dmax.
    pub most_drag: f64,
}

impl Seam {
    /// What was done, in one sentence.
    pub fn text(&self) -> String {
        let [from, to] = self.given_deg;
        let upto = match self.upto {
            // What is symmetric has its rows from 0° on.
            Upto::Given if from > -1e-6 => format!("Given up to {to:.1}° on both sides"),
            Upto::Given => format!("Given from {from:.1}° to {to:.1}°"),
            Upto::Section([least, most]) => format!(
                "Of the section the rows from {least:.1}° to {most:.1}° are used, up to where lift falls behind its stall: of the wing they are {from:.1}° to {to:.1}°"
            ),
        };
        format!(
            "{upto}; the rest is an extension by Viterna and Corrigan (1981) with c_Dmax = {:.3}, beyond 90° as in AirfoilPrep",
            self.most_drag
        )
    }
}

/// c_Dmax of a wing of this aspect ratio; of infinite span if it is left out.
pub fn most_drag(aspect_ratio: Option<f64>) -> f64 {
    1.11 + 0.018 * aspect_ratio.unwrap_or(50.0).min(50.0)
}

/// One side of stall: the method from the row at which it begins.
struct Side {
    /// α_s \[rad\], c_Ls.
    stall: f64,
    lift: f64,
    b1: f64,
    b2: f64,
    a2: f64,
    /// Least drag coefficient that comes out: the least of the table. It has friction tail first, too.
    least_drag: f64,
}

impl Side {
    fn new([degrees, lift, drag]: [f64; 3], [least_drag, most_drag]: [f64; 2]) -> Self {
        let stall = degrees.to_radians();
        let (sin, cos) = libm::sincos(stall);
        Self {
            stall,
            lift,
            b1: most_drag,
            b2: (drag - most_drag * sin * sin) / cos,
            a2: (lift - most_drag * sin * cos) * sin / (cos * cos),
            least_drag,
        }
    }

    /// B_2 at `alpha` \[rad\]; of a last row with more drag than that of a plate, what it has.
    fn b2(&self, alpha: f64) -> f64 {
        let begin = self.stall.to_degrees();
        let end = SEPARATED.max(begin + SEPARATES);
        let part = ((alpha.to_degrees() - begin) / (end - begin)).clamp(0.0, 1.0);
        self.b2 + part * (self.a2 - self.b2).max(0.0)
    }

    /// c_L and c_D at `degrees` from the stall to 180°.
    fn at(&self, degrees: f64) -> [f64; 2] {
        let alpha = degrees.to_radians();
        let behind = std::f64::consts::PI - alpha;
        let mirrored = if degrees > 90.0 { behind } else { alpha };
        let (sin, cos) = libm::sincos(mirrored);
        let drag = (self.b1 * sin * sin + self.b2(mirrored) * cos).max(self.least_drag);
        let lift = 0.5 * self.b1 * libm::sin(2.0 * mirrored) + self.a2 * cos * cos / sin;
        let lift = if degrees <= 90.0 {
            lift
        } else if behind >= self.stall {
            -TAIL_FIRST * lift
        } else {
            -TAIL_FIRST * self.lift * behind / self.stall
        };
        [lift, drag]
    }

    /// Rows every [`STEP`] from the stall on to 180°, without the first.
    fn rows(&self) -> Vec<[f64; 3]> {
        let stall = self.stall.to_degrees();
        let first = (stall / STEP).floor() * STEP + STEP;
        // A row close to the last one given would make a corner out of the seam.
        let first = if first - stall < 0.2 * STEP {
            first + STEP
        } else {
            first
        };
        let count = ((180.0 - first) / STEP).round() as usize;
        let mut angles: Vec<f64> = (0..=count).map(|n| first + n as f64 * STEP).collect();
        // Where the straight line begins, if the table does not go as far.
        if 180.0 - stall > first {
            angles.push(180.0 - stall);
        }
        angles.sort_by(f64::total_cmp);
        angles.dedup_by(|b, a| *b - *a < 0.2 * STEP);
        if let Some(last) = angles.last_mut() {
            *last = 180.0;
        }
        let row = |degrees: f64| {
            let [lift, drag] = self.at(degrees);
            let lift = if degrees == 180.0 { 0.0 } else { lift };
            [degrees, lift, drag]
        };
        angles.into_iter().map(row).collect()
    }
}

/// The rows `given` \[°, c_L, c_D\], by increasing angle from 0 (a symmetric section) or below to stall, extended to 180°; from −180° for
/// a section that is not symmetric. The error says what is missing.
pub fn extended(
    given: &[[f64; 3]],
    aspect_ratio: Option<f64>,
) -> Result<(Vec<[f64; 3]>, Seam), String> {
    let (Some(&first), Some(&last)) = (given.first(), given.last()) else {
        return Err("there are no rows".to_owned());
    };
    if last[0] < LEAST_STALL || last[0] > 90.0 || first[0] < -90.0 {
        let radians = match last[0] > 0.0 && last[0] < 0.6 {
            true => ". Are these radians?",
            false => "",
        };
        return Err(format!(
            "goes from {}° to {}°: to be extended it must end between {LEAST_STALL}° and 90°{radians}",
            first[0], last[0]
        ));
    }
    if first[0] > 1e-6 {
        return Err(format!(
            "begins at {}°: a table begins at 0° if the section is symmetric, and below if it is not",
            first[0]
        ));
    }
    if first[0] > -1e-6 && first[1] != 0.0 {
        return Err(format!(
            "c_L is {} at 0°, so the section is not symmetric, and the rows below 0° are missing: give them down to -{LEAST_STALL}° at least, \
             better to where it stalls inverted",
            first[1]
        ));
    }
    let most = given
        .iter()
        .fold(most_drag(aspect_ratio), |most, row| most.max(row[2]));
    let seam = Seam {
        given_deg: [first[0], last[0]],
        upto: Upto::Given,
        most_drag: most,
    };
    let least = given.iter().fold(most, |least, row| least.min(row[2]));
    let between = [least, most];
    let above = Side::new(last, between);
    let mut rows = given.to_vec();
    rows.extend(above.rows());
    if first[0] > -1e-6 {
        return Ok((rows, seam));
    }
    // Below, the table's own stall if it goes there, or else that of above, mirrored, with the lift of AirfoilPrep.
    let below = match -first[0] >= LEAST_STALL {
        true => Side::new([-first[0], -first[1], first[2]], between),
        false => Side::new([last[0], TAIL_FIRST * last[1], last[2]], between),
    };
    let stall = [
        -below.stall.to_degrees(),
        -below.lift,
        below.at(below.stall.to_degrees())[1],
    ];
    let mut left: Vec<[f64; 3]> = below
        .rows()
        .iter()
        .rev()
        .map(|[a, l, d]| [-a, -l, *d])
        .collect();
    if stall[0] < first[0] - 0.5 * STEP {
        left.push(stall);
    }
    // At 180° both sides are one row.
    if let (Some(end), Some(start)) = (rows.last_mut(), left.first_mut()) {
        let drag = 0.5 * (end[2] + start[2]);
        (end[2], start[2]) = (drag, drag);
    }
    left.extend(rows);
    Ok((left, seam))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusals::{begins, says};

    /// Against numbers worked out by hand from the printed equations: α_s = 15°, c_L 1.2, c_D 0.1, AR 10, so B_1 = 1.29.
    #[test]
    fn the_printed_equations() {
        let side = Side::new([15.0, 1.2, 0.1], [0.001, most_drag(Some(10.0))]);
        let near = |got: f64, want: f64| assert!((got - want).abs() < 1e-3, "{got} {want}");
        near(side.b1, 1.29);
        near(side.b2, (0.1 - 1.29 * 0.066_987) / 0.965_926);
        near(side.a2, (1.2 - 1.29 * 0.25) * 0.258_819 / 0.933_013);
        // The last row is met, and at 90° there is drag alone.
        let [lift, drag] = side.at(15.0);
        near(lift, 1.2);
        near(drag, 0.1);
        let [lift, drag] = side.at(90.0);
        near(lift, 0.0);
        near(drag, 1.29);
        // 45°: 0.645 + 0.2434·0.5/0.7071; 135° is its mirror image with 0.7 of the lift.
        near(
            side.at(45.0)[0],
            0.645 + side.a2 * std::f64::consts::FRAC_1_SQRT_2,
        );
        near(side.at(135.0)[0], -0.7 * side.at(45.0)[0]);
        near(side.at(170.0)[0], -0.7 * 1.2 * 10.0 / 15.0);
        // From 20° on the force is normal to the chord.
        for degrees in [20.0_f64, 35.0, 70.0] {
            let [lift, drag] = side.at(degrees);
            near(drag, lift * degrees.to_radians().tan());
        }
    }

    /// The whole table of a section (SAND80-2114) cut at its stall and extended again: the drag of separated flow is that of the table within a tenth, where the
    /// equations as printed lack a quarter of it, as suction.
    #[test]
    fn separated_flow_has_no_suction() {
        let text = include_str!("../../../data/naca-0012-re-160e3.csv");
        let rows: Vec<[f64; 3]> = text
            .lines()
            .filter_map(|line| {
                let numbers: Option<Vec<f64>> = line.split(',').map(|x| x.parse().ok()).collect();
                numbers?.try_into().ok()
            })
            .collect();
        let ratio = |side: &Side, printed: bool| {
            let ratios = [25.0, 30.0, 40.0, 50.0, 60.0].map(|degrees: f64| {
                let row = rows.iter().find(|row| row[0] == degrees).unwrap();
                let [lift, drag] = side.at(degrees);
                let (sin, cos) = degrees.to_radians().sin_cos();
                let drag = if printed {
                    side.b1 * sin * sin + side.b2 * cos
                } else {
                    drag
                };
                (drag / lift) / (row[2] / row[1])
            });
            ratios.into_iter().fold(f64::INFINITY, f64::min)
        };
        let stall = rows.iter().find(|row| row[0] == 9.0).unwrap();
        let side = Side::new(*stall, [0.0103, most_drag(None)]);
        let [printed, plate] = [true, false].map(|printed| ratio(&side, printed));
        assert!(printed < 0.75 && plate > 0.9, "{printed} {plate}");
    }

    #[test]
    fn both_kinds_of_section_become_whole_tables() {
        let symmetric: Vec<[f64; 3]> = (0..=12)
            .map(|a| [f64::from(a), 0.1 * f64::from(a), 0.02])
            .collect();
        let (rows, seam) = extended(&symmetric, None).unwrap();
        assert_eq!((rows[0][0], rows[rows.len() - 1][0]), (0.0, 180.0));
        assert_eq!(seam.given_deg, [0.0, 12.0]);
        assert!((seam.most_drag - 2.01).abs() < 1e-12);
        assert!(super::super::Polar::from_rows("x", &[], &rows).is_ok());

        let cambered: Vec<[f64; 3]> = (-8..=14)
            .map(|a| [f64::from(a), 0.4 + 0.1 * f64::from(a), 0.02])
            .collect();
        for part in [&cambered[..], &cambered[5..]] {
            let (rows, _) = extended(part, Some(6.0)).unwrap();
            assert_eq!((rows[0][0], rows[rows.len() - 1][0]), (-180.0, 180.0));
            assert!(
                rows.windows(2).all(|pair| pair[1][0] - pair[0][0] > 0.2),
                "{rows:?}"
            );
            let polar = super::super::Polar::from_rows("x", &[], &rows);
            assert!(polar.is_ok(), "{:?}", polar.err());
        }
        let short = extended(&cambered[..12], None).unwrap_err();
        assert!(short.contains("to 3°"), "{short}");
    }

    /// A table may end at 90° itself: no row is there twice.
    #[test]
    fn a_table_up_to_90_degrees_is_extended() {
        for (step, cambered) in [(1, false), (2, true), (5, false), (5, true)] {
            let lift = |a: f64| (2.0 * a.to_radians()).sin() + 0.02 * f64::from(u8::from(cambered));
            let from = if cambered { -90 } else { 0 };
            let given: Vec<[f64; 3]> = (from..=90)
                .step_by(step)
                .map(|a| {
                    let a = f64::from(a);
                    [a, lift(a), 0.02 + 1.9 * a.to_radians().sin().powi(2)]
                })
                .collect();
            let (rows, seam) = extended(&given, None).unwrap();
            assert_eq!(seam.given_deg, [f64::from(from), 90.0]);
            let polar = super::super::Polar::from_rows("x", &[], &rows);
            assert!(polar.is_ok(), "{step} {cambered}: {:?}", polar.err());
        }
    }

    /// A section with camber that was run from 0° on looks like half of a symmetric one, and is not.
    #[test]
    fn what_is_missing_below_zero_is_said() {
        let lift = |a: f64| 0.4 + 0.1 * a;
        let rows = |from: i32| -> Vec<[f64; 3]> {
            let angles = (from..=14).map(f64::from);
            angles.map(|a| [a, lift(a), 0.02]).collect()
        };
        let error = extended(&rows(0), None).unwrap_err();
        begins(&error, "c_L is 0.4 at 0°");
        says(&error, &["rows below 0° are missing"]);
        let error = extended(&rows(2), None).unwrap_err();
        assert!(error.starts_with("begins at 2°"), "{error}");
        let radians: Vec<[f64; 3]> = rows(-5)
            .iter()
            .map(|[a, l, d]| [a.to_radians(), *l, *d])
            .collect();
        let error = extended(&radians, None).unwrap_err();
        assert!(error.ends_with("Are these radians?"), "{error}");
    }
}
