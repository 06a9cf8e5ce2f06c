//! What no wing is known to do: polars that are scaled, mirrored, in other units, or have a row that is wild.

use super::stall::{Attached, stall};

/// A reason to doubt a polar.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// Line of the file.
    pub line: u64,
    /// What is odd about it.
    pub problem: String,
    /// Whether no wing can have it.
    pub impossible: bool,
}

/// Greatest lift coefficient of plain wings, flaps included, with a margin.
const MOST_LIFT: f64 = 3.0;
/// Greatest drag coefficient: that of a flat plate broadside is 2.01.
const MOST_DRAG: f64 = 2.5;
/// Slope of lift per degree from which on a table is warned of: sections of 10 to 20 % thickness have up to 0.115.
const STEEP: f64 = 0.125;
/// Slope of lift per degree: from that of a wing of aspect ratio 0.5, π AR/2, to nearly twice that of thin wing theory, 2π.
const SLOPES: [f64; 2] = [0.012, 0.2];
/// Angles between which the slope is taken \[°\].
const ATTACHED: f64 = 6.0;
/// Angle up to which lift is looked for where it does not grow about 0 \[°\].
const REACH: f64 = 25.0;
/// Least and greatest drag coefficient of the best row: below stands no friction, above no wing.
const BEST_DRAG: [f64; 2] = [0.003, 0.1];
/// How far a row may be from the straight line through its neighbours, besides [`ROUGH`] times how far they are from it themselves: odd,
/// and impossible.
const WILD: [f64; 2] = [0.06, 0.2];
const ROUGH: f64 = 6.0;

/// A straight line by least squares.
struct Line {
    /// Its value where it was asked for.
    value: f64,
    /// The farthest of the points from it.
    farthest: f64,
    slope: f64,
}

/// The straight line through `points`, with its value at `x`.
fn line(points: &[(f64, f64)], x: f64) -> Option<Line> {
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
    let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        points.iter().map(|(x, y)| of(x - x0, y - y0)).sum()
    };
    let spread = sum(&|x, _| x * x);
    if points.len() < 2 || spread <= 0.0 {
        return None;
    }
    let slope = sum(&|x, y| x * y) / spread;
    let at = |x: f64| y0 + slope * (x - x0);
    let off = points.iter().map(|(x, y)| (y - at(*x)).abs());
    Some(Line {
        value: at(x),
        farthest: off.fold(0.0, f64::max),
        slope,
    })
}

/// Angle up to which the slope is taken \[°\]: [`ATTACHED`], or that of the second row from zero where rows are farther apart.
fn attached(rows: &[[f64; 3]]) -> f64 {
    let mut angles: Vec<f64> = rows.iter().map(|row| row[0].abs()).collect();
    angles.sort_by(f64::total_cmp);
    angles
        .get(1)
        .map_or(ATTACHED, |second| second.max(ATTACHED))
}

/// The straight line through the rows up to [`attached`]: slope of lift per degree.
fn slope(rows: &[[f64; 3]]) -> Option<f64> {
    let most = attached(rows);
    let inside = rows.iter().filter(|row| row[0].abs() <= most);
    let points: Vec<(f64, f64)> = inside.map(|row| (row[0], row[1])).collect();
    Some(line(&points, 0.0)?.slope)
}

/// Lift per degree from the least to the greatest lift up to [`REACH`]; negative where the greatest comes first.
fn reach(rows: &[[f64; 3]]) -> f64 {
    let inside = || rows.iter().filter(|row| row[0].abs() <= REACH);
    let lift = |a: &&[f64; 3], b: &&[f64; 3]| a[1].total_cmp(&b[1]);
    match inside().min_by(lift).zip(inside().max_by(lift)) {
        Some((least, most)) => (most[1] - least[1]) / (most[0] - least[0]),
        None => 0.0,
    }
}

/// Why the `rows` \[°, c_L, c_D\] from these `lines` of a file are to be doubted; the worst first.
pub fn doubts(lines: &[u64], rows: &[[f64; 3]]) -> Vec<Doubt> {
    let mut doubts = Vec::new();
    let at = |i: usize| lines.get(i).or(lines.last()).copied().unwrap_or(1);
    let mut add = |i: usize, impossible: bool, problem: String| {
        doubts.push(Doubt {
            line: at(i),
            problem,
            impossible,
        });
    };
    // Drag is positive, or the polar would have been refused.
    for (column, name, most) in [(1, "c_L", MOST_LIFT), (2, "c_D", MOST_DRAG)] {
        if let Some(i) = rows.iter().position(|row| row[column].abs() > most) {
            let (degrees, value) = (rows[i][0], rows[i][column]);
            let problem = format!("{name} is {value} at {degrees}°: no wing has more than {most}");
            add(i, true, problem);
        }
    }
    let most_attached = attached(rows);
    let first = rows.iter().position(|row| row[0].abs() <= most_attached);
    if let (Some(slope), Some(i)) = (slope(rows), first) {
        let [least, most] = SLOPES;
        // Lift may stand still about 0, or go against the angle: then it grows beyond.
        let beyond = || (reach(rows) >= least).then_some(least);
        let slope = if slope < least {
            beyond().unwrap_or(slope)
        } else {
            slope
        };
        let grows = format!("from here to {most_attached}° c_L grows by {slope:.3} per degree");
        let so = if slope < 0.0 {
            ", so it falls: α or c_L has the wrong sign".to_owned()
        } else if slope < least {
            format!(": no wing has less than {least}. Are the coefficients scaled?")
        } else if slope > most {
            ": thin wing theory has 0.110. Are the coefficients scaled, or the angles radians?"
                .to_owned()
        } else if slope > STEEP {
            ": thin wing theory has 0.110. Lift that is overstated is what a flight bears worst"
                .to_owned()
        } else {
            String::new()
        };
        if !so.is_empty() {
            add(i, !(least..=most).contains(&slope), grows + &so);
        }
    }
    for (column, name) in [(1, "c_L"), (2, "c_D")] {
        for i in 1..rows.len().saturating_sub(1) {
            let around = (i.saturating_sub(2)..=(i + 2).min(rows.len() - 1)).filter(|&j| j != i);
            let points: Vec<(f64, f64)> = around.map(|j| (rows[j][0], rows[j][column])).collect();
            let Some(line) = line(&points, rows[i][0]) else {
                continue;
            };
            let value = rows[i][column];
            let off = (value - line.value).abs() - ROUGH * line.farthest;
            // Fewer than four neighbours are as good as a straight line of themselves.
            if points.len() >= 3 && off > WILD[0] {
                let problem = format!(
                    "{name} is {value} at {}°, and its neighbours say {:.3}",
                    rows[i][0], line.value
                );
                add(i, off > WILD[1], problem);
            }
        }
    }
    let best = rows
        .iter()
        .enumerate()
        .min_by(|a, b| a.1[2].total_cmp(&b.1[2]));
    if let Some((i, &[degrees, _, drag])) = best {
        let [least, most] = BEST_DRAG;
        let is = format!("c_D is {drag} at {degrees}°");
        if drag < least {
            let problem = "is there friction in it? AVL and panel methods have none unless it is given to them";
            add(i, false, format!("{is}: {problem}"));
        } else if drag > most {
            add(
                i,
                false,
                format!("{is} and nowhere less: wings have 0.006 to 0.03"),
            );
        }
    }
    doubts.sort_by_key(|doubt| !doubt.impossible);
    doubts
}

/// Why the stall is not in the `rows` from these `lines`, by the line that shows it: lift still grows at the last, or is a method's that knows no stall.
pub fn no_stall(lines: &[u64], rows: &[[f64; 3]]) -> Option<(u64, String)> {
    let at = |i: usize| lines.get(i).or(lines.last()).copied().unwrap_or(1);
    if ends_straight(rows) {
        let problem = "lift still grows in a straight line at the last row: that the wing stalls there is not known";
        return Some((at(rows.len()), problem.to_owned()));
    }
    let i = beyond_stall(rows)?;
    let [degrees, lift, _] = rows[i];
    let problem = format!(
        "c_L is {lift} at {degrees}°, and lift does not fall for good from below {LATEST}°: AVL and panel methods know no stall"
    );
    Some((at(i), problem))
}

/// Angle \[°\] short of which every wing stalls.
const LATEST: f64 = 40.0;

/// The first row whose lift no wing without slats or flaps has without a stall behind it: it comes of a method that knows none, though it bends.
fn beyond_stall(rows: &[[f64; 3]]) -> Option<usize> {
    /// Angle \[°\] beyond the stalls of most unslotted sections, and lift that none has there. Sections have 1.2 at most, delta wings 1.3.
    const LATE: f64 = 22.0;
    const LIFT: f64 = 1.5;
    let late = |row: &[f64; 3]| row[0].abs() >= LATE && row[1].abs() > LIFT;
    let nearest = |a: &usize, b: &usize| rows[*a][0].abs().total_cmp(&rows[*b][0].abs());
    [Attached::inverted(rows), Attached::of(rows)]
        .into_iter()
        .flatten()
        .filter(|attached| {
            let top = rows[attached.top][0].abs();
            top >= LATEST || top >= LATE && !attached.stalls
        })
        .find_map(|attached| {
            let side = rows[attached.top][0].signum();
            let side = (0..rows.len()).filter(|i| rows[*i][0].signum() == side);
            side.filter(|i| late(&rows[*i])).min_by(nearest)
        })
}

/// Whether lift still grows at the last row as it does at small angles, and no stall stands before: that is the end of a table alone.
fn ends_straight(rows: &[[f64; 3]]) -> bool {
    /// Part of the slope that is left where a stall begins.
    const LEFT: f64 = 0.7;
    /// Length of the end that is looked at \[°\].
    const END: f64 = 2.0;
    let Some(&[last, lift, _]) = rows.last() else {
        return false;
    };
    if stall(rows).is_some() {
        return false;
    }
    let before = rows.iter().rfind(|row| row[0] <= last - END);
    let end = before.map(|row| (lift - row[1]) / (last - row[0]));
    match (end, Attached::of(rows).map(|attached| attached.slope)) {
        (Some(end), Some(slope)) => last < 90.0 && end > LEFT * slope,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polar::{BUILT_IN, Polar};

    fn all(rows: &[[f64; 3]]) -> Vec<Doubt> {
        let lines: Vec<u64> = (10..).take(rows.len()).collect();
        doubts(&lines, rows)
    }

    /// A rough but honest section to 16°: 0.1 per degree, a round stall, a third digit of noise.
    fn section() -> Vec<[f64; 3]> {
        let row = |n: i32| {
            let a = f64::from(n);
            let lift = 1.1 * (a / 11.0 * 1.2).sin() + 0.004 * f64::from((n * 7) % 3 - 1);
            [a, lift, 0.01 + 0.0003 * a * a]
        };
        (-10..=16).map(row).collect()
    }

    #[test]
    fn what_is_measured_is_not_doubted() {
        for (name, _) in BUILT_IN {
            let rows = Polar::load(name).unwrap().degrees();
            assert_eq!(all(&rows), [], "{name}");
            assert!(!ends_straight(&rows[..rows.len().min(15)]) || !name.contains("160e3"));
        }
        assert_eq!(all(&section()), []);
        assert!(!ends_straight(&section()));
    }

    /// A straight table, however far apart its rows are.
    #[test]
    fn a_straight_table_ends_straight() {
        for step in [1.0, 5.0, 8.0, 10.0] {
            let row = |n: i32| {
                let alpha = f64::from(n) * step;
                [alpha, 0.08 * alpha, 0.012 + 3e-4 * alpha * alpha]
            };
            for first in [-1, 0] {
                let rows: Vec<[f64; 3]> = (first..4).map(row).collect();
                assert!(ends_straight(&rows), "{step} {first}");
            }
        }
    }

    /// Ten times, a tenth, mirrored, in radians, without friction: each is told with a line.
    #[test]
    fn other_units_and_signs_are_told() {
        let with = |of: fn([f64; 3]) -> [f64; 3]| {
            let mut rows: Vec<[f64; 3]> = section().into_iter().map(of).collect();
            rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
            all(&rows)
        };
        let first = |of: fn([f64; 3]) -> [f64; 3]| {
            let doubt = with(of).into_iter().next().expect("a doubt");
            assert!(doubt.line >= 10 && doubt.line < 37, "{doubt:?}");
            (doubt.impossible, doubt.problem)
        };
        let (impossible, text) = first(|[a, l, d]| [a, 10.0 * l, 10.0 * d]);
        assert!(
            impossible && text.contains("no wing has more than 3"),
            "{text}"
        );
        let (impossible, text) = first(|[a, l, d]| [a, 0.1 * l, d]);
        assert!(impossible && text.contains("scaled"), "{text}");
        let (impossible, text) = first(|[a, l, d]| [-a, l, d]);
        assert!(impossible && text.contains("wrong sign"), "{text}");
        let (impossible, text) = first(|[a, l, d]| [a.to_radians(), l, d]);
        assert!(impossible && text.contains("radians"), "{text}");
        let (impossible, text) = first(|[a, l, d]| [a, l, 0.05 * d]);
        assert!(!impossible && text.contains("friction"), "{text}");
        let (impossible, text) = first(|[a, l, d]| [a, l, 12.0 * d]);
        assert!(!impossible && text.contains("nowhere less"), "{text}");
    }

    /// A slip of the pen in any row but those at the ends: a sign, a digit, a row of another table. None is silent, and its line is named.
    #[test]
    fn one_wild_row_is_told_with_its_line() {
        let clean = section();
        for i in 1..clean.len() - 1 {
            for (column, wild) in [(1, clean[i][1] + 0.5), (1, clean[i][1] - 0.5), (2, 0.6)] {
                let mut rows = clean.clone();
                rows[i][column] = wild;
                let doubts = all(&rows);
                let line = 10 + i as u64;
                let told = doubts
                    .iter()
                    .find(|doubt| doubt.line == line && doubt.impossible);
                assert!(told.is_some(), "{i} {column} {wild}: {doubts:?}");
            }
        }
    }

    /// A vortex lattice's: 2πA/(A + 2) sin α cos α bends, and knows no stall. Full tables of sections have nothing such.
    #[test]
    fn lift_that_no_wing_has_is_told() {
        let lattice = |aspect: f64, last: i32| -> Vec<[f64; 3]> {
            let slope = std::f64::consts::TAU * aspect / (aspect + 2.0);
            let row = |degrees: i32| {
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                [f64::from(degrees), slope * sin * cos, 0.01]
            };
            (-10..=last).map(row).collect()
        };
        let first = |rows: &[[f64; 3]]| beyond_stall(rows).map(|i| rows[i][0]);
        assert_eq!(first(&lattice(6.0, 30)), Some(22.0));
        // It is named by its own line.
        let lines: Vec<u64> = (10..=50).collect();
        let (line, problem) = no_stall(&lines, &lattice(6.0, 30)).unwrap();
        assert!(line == 42 && problem.contains("at 22°"), "{line} {problem}");
        // At 45° it turns, and that is no stall.
        assert_eq!(first(&lattice(6.0, 70)), Some(22.0));
        assert!(beyond_stall(&lattice(3.0, 30)).is_some());
        assert!(beyond_stall(&lattice(6.0, 20)).is_none() && ends_straight(&lattice(6.0, 20)));
        let steep = |slope: f64| {
            let rows: Vec<[f64; 3]> = (0..13)
                .map(|n| [f64::from(n), slope * f64::from(n), 0.01])
                .collect();
            all(&rows)
                .into_iter()
                .filter(|doubt| doubt.problem.contains("overstated"))
                .count()
        };
        assert_eq!([steep(0.115), steep(0.15), steep(0.21)], [0, 1, 0]);
    }

    /// AVL's lift is a straight line, and so is a sweep that ended before the stall.
    #[test]
    fn a_straight_end_is_no_stall() {
        let straight: Vec<[f64; 3]> = (-4..=12)
            .map(|a| [f64::from(a), 0.08 * f64::from(a), 0.02])
            .collect();
        assert!(ends_straight(&straight));
        assert!(ends_straight(&section()[..16]));
        assert!(!ends_straight(&section()[..20]));
    }

    /// A stall in the table is one, whatever comes behind it: lift that grows at the end, and lift that stays high.
    #[test]
    fn what_comes_behind_a_stall_is_not_doubted() {
        let with = |lift: fn(f64) -> f64| -> Vec<[f64; 3]> {
            let angles = (-10..=30).map(f64::from);
            angles.map(|a| [a, lift(a), 0.02]).collect()
        };
        let grows = with(|a| match a {
            a if a <= 11.0 => 0.1 * a,
            a if a <= 26.0 => 0.62,
            a => 0.62 + 0.1 * (a - 26.0),
        });
        assert!(!ends_straight(&grows) && beyond_stall(&grows).is_none());
        let high = with(|a| match a {
            a if a <= 18.0 => 0.3 + 0.1 * a,
            a => 2.1 - 0.03 * (a - 18.0),
        });
        assert!(!ends_straight(&high) && beyond_stall(&high).is_none());
        // High lift that stalls late: 2.07 at 22°, and 1.65 at 23° of a section.
        for (top, most) in [(22.0, 2.07), (23.0, 1.65)] {
            let rise = |a: f64| most * (1.0 - ((top - a) / (top + 6.0)).powi(2));
            let rows: Vec<[f64; 3]> = (-6..=32)
                .map(f64::from)
                .map(|a| {
                    [
                        a,
                        if a <= top {
                            rise(a)
                        } else {
                            most - 0.08 * (a - top)
                        },
                        0.02,
                    ]
                })
                .collect();
            assert_eq!(no_stall(&[], &rows), None);
            assert_eq!(stall(&rows).map(|at| rows[at][0]), Some(top));
            // Up to its top alone nothing says that it stalls.
            let upto: Vec<[f64; 3]> = rows.iter().copied().filter(|row| row[0] <= top).collect();
            assert!(no_stall(&[], &upto).is_some());
        }
        // The kink of a table that goes on growing is no stall.
        let kink = with(|a| 0.1 * a - if a > 6.0 { 0.09 } else { 0.0 });
        assert!(ends_straight(&kink));
        let mirrored: Vec<[f64; 3]> = (-30..=14)
            .map(f64::from)
            .map(|a: f64| [a, 4.0 * a.to_radians().sin() * a.to_radians().cos(), 0.02])
            .collect();
        assert_eq!(beyond_stall(&mirrored).map(|i| mirrored[i][0]), Some(-25.0));
    }
}
