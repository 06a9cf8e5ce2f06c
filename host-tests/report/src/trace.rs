//! A curve in few bytes: points that lie on straight lines between others are left out, and the rest are whole multiples of a unit.

use std::fmt::Write as _;

/// More points of one curve than these are not written: two or three per pixel column.
const MAX_POINTS: usize = 2500;

/// Of how many parts of its range a curve may be off.
const PARTS: f64 = 3000.0;

/// The axis of a chart in whole units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Value at zero units.
    pub origin: f64,
    /// A power of ten: the length of a unit.
    pub unit: f64,
}

impl Units {
    /// Units of at most one part in `parts` of the range.
    pub fn of((low, high): (f64, f64), parts: f64) -> Self {
        let unit = 10.0_f64.powf(((high - low) / parts).log10().floor());
        Self {
            origin: (low / unit).floor() * unit,
            unit,
        }
    }

    /// The nearest number of units.
    pub fn count(&self, value: f64) -> i64 {
        ((value - self.origin) / self.unit).round() as i64
    }
}

/// The points of an unbroken curve that matter: leaving out the others moves it by no more than `tolerance`. Abscissas that do not
/// increase are kept as they are.
pub fn thin(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    if points.len() < 3 || points.windows(2).any(|pair| pair[1].0 <= pair[0].0) {
        return points.to_vec();
    }
    let mut tolerance = tolerance;
    loop {
        let kept = within(points, tolerance);
        if kept.len() <= MAX_POINTS {
            return kept;
        }
        tolerance *= 2.0;
    }
}

/// One pass: a line from the last point kept goes on while it can pass every point left out within the tolerance.
fn within(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let mut kept = vec![points[0]];
    let mut cone = (f64::NEG_INFINITY, f64::INFINITY);
    for pair in points.windows(2) {
        let [last, next] = [pair[0], pair[1]];
        let anchor = kept[kept.len() - 1];
        let slope = |y: f64| (y - anchor.1) / (next.0 - anchor.0);
        let straight = slope(next.1);
        if straight < cone.0 || straight > cone.1 {
            kept.push(last);
            let slope = |y: f64| (y - last.1) / (next.0 - last.0);
            cone = (slope(next.1 - tolerance), slope(next.1 + tolerance));
        } else {
            cone.0 = cone.0.max(slope(next.1 - tolerance));
            cone.1 = cone.1.min(slope(next.1 + tolerance));
        }
    }
    kept.push(points[points.len() - 1]);
    kept
}

/// The tolerance for a curve in this range.
pub fn tolerance((low, high): (f64, f64)) -> f64 {
    (high - low) / PARTS
}

/// Appends an unbroken curve as SVG path data: a move to its first point, then relative lines.
pub fn write(text: &mut String, points: impl IntoIterator<Item = (f64, f64)>, x: Units, y: Units) {
    let mut last: Option<(i64, i64)> = None;
    for point in points {
        let at = (x.count(point.0), y.count(point.1));
        let _ = match last {
            None => write!(text, "M{} {}l", at.0, at.1),
            Some(last) => write!(text, "{} {} ", at.0 - last.0, at.1 - last.1),
        };
        last = Some(at);
    }
    while text.ends_with(' ') {
        text.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(kept: &[(f64, f64)], x: f64) -> f64 {
        let after = kept.partition_point(|p| p.0 < x).max(1);
        let [a, b] = [kept[after - 1], kept[after]];
        a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0)
    }

    #[test]
    fn thinning_stays_within_the_tolerance() {
        let wave = |i: i32| {
            let x = f64::from(i) * 0.01;
            (
                x,
                (x * 0.7).sin() + if i == 777 { 3.0 } else { 0.0 } + (x * 31.0).sin() * 0.02,
            )
        };
        let points: Vec<_> = (0..6001).map(wave).collect();
        let kept = thin(&points, 0.01);
        assert!(kept.len() < 1500, "{}", kept.len());
        for &(x, y) in &points {
            assert!((at(&kept, x) - y).abs() <= 0.01 + 1e-12);
        }
        assert_eq!(kept.first(), points.first());
        assert_eq!(kept.last(), points.last());
    }

    /// Noise has no line in it: the number of points is bounded all the same, and a spike stays.
    #[test]
    fn a_long_noisy_curve_is_bounded() {
        let mut points: Vec<_> = (0..20_001)
            .map(|i| (f64::from(i), f64::from(i * 7919 % 101)))
            .collect();
        points[7777].1 = 5000.0;
        let kept = thin(&points, 0.01);
        assert!(kept.len() <= MAX_POINTS);
        assert!(kept.contains(&(7777.0, 5000.0)));
    }

    #[test]
    fn a_straight_line_is_two_points() {
        let points: Vec<_> = (0..1000)
            .map(|i| (f64::from(i), 2.0 * f64::from(i)))
            .collect();
        assert_eq!(thin(&points, 1e-9).len(), 2);
    }

    #[test]
    fn path_data_reads_back() {
        let (x, y) = (
            Units::of((0.0, 60.0), 5000.0),
            Units::of((-1.0, 3.0), 2000.0),
        );
        assert!((x.unit - 0.01).abs() < 1e-12 && (y.unit - 0.001).abs() < 1e-12);
        let mut text = String::new();
        write(&mut text, [(0.0, -1.0), (0.5, 0.25), (60.0, 3.0)], x, y);
        assert_eq!(text, "M0 0l50 1250 5950 2750");
    }
}
