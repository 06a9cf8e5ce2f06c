//! The figure of an envelope: the paper's bifurcation figure, the fold curves, the coefficients.

use super::Figure;
use super::chart::{BLUE, Chart, GREY, Mark, ORANGE, Series, ends};
use alula_design::envelope::{Curve, Cusp, Fold, FoldPoint};
use alula_sim::reference::{Coefficients, Vehicle};

/// What is drawn.
pub struct Shown<'a> {
    /// The vehicle.
    pub vehicle: &'a Vehicle,
    /// Its curve at the climb angle asked for.
    pub curve: &'a Curve<'a>,
    /// That climb angle \[rad\].
    pub epsilon: f64,
    /// The folds there.
    pub folds: &'a [Fold],
    /// The folds at every climb angle.
    pub fold_curve: &'a [Vec<FoldPoint>],
    /// Their cusps.
    pub cusps: &'a [Cusp],
}

/// The figure .
pub fn figure(shown: &Shown) -> Figure {
    let mut charts = vec![bifurcation(shown, false)];
    // Without folds there is no detail to enlarge.
    if !shown.folds.is_empty() {
        charts.push(bifurcation(shown, true));
    }
    charts.push(fold_curves(shown));
    charts.push(coefficients(shown.vehicle));
    Figure::new(&charts, 280.0)
}

/// a against α: the branch θ̃ = 0 drawn solid, where a falls with α, the branch θ̃ = π dashed.
fn bifurcation(shown: &Shown, close: bool) -> Chart<'static> {
    let (lowest, highest) = ends(shown.folds.iter().map(|fold| fold.a));
    let highest = highest.max(0.0);
    let (floor, ceiling, (first, last)) = if close {
        let (low, high) = ends(shown.folds.iter().map(|fold| fold.alpha.to_degrees()));
        let margin = 0.15 * (highest - lowest) + 0.02;
        let around = (high - low).max(4.0);
        (
            lowest - margin,
            highest + margin,
            (low - around, high + around),
        )
    } else {
        let ceiling = if highest > 0.0 { 2.0 * highest } else { 3.0 };
        let (from, to) = shown.curve.range();
        (0.0, ceiling, (from.to_degrees(), to.to_degrees()))
    };
    let points = shown.curve.points();
    let branch = |aligned: bool| {
        let value = |&(alpha, a): &(f64, f64)| {
            let degrees = alpha.to_degrees();
            let inside = (floor..ceiling).contains(&a) && (first..last).contains(&degrees);
            let drawn = inside && (shown.curve.slope(alpha) < 0.0) == aligned;
            (degrees, if drawn { a } else { f64::NAN })
        };
        let within = |p: &(f64, f64)| (first..last).contains(&p.0);
        points.iter().map(value).filter(within).collect()
    };
    // Labels of minima go below their marks, the left one of two neighbours below the other; those of maxima above.
    let is_minimum = |fold: &Fold| shown.curve.slope(fold.alpha - 1e-6) < 0.0;
    let shift = |fold: &Fold| {
        let neighbours = shown.folds.iter().filter(|other| {
            let ahead = (other.alpha - fold.alpha).to_degrees();
            is_minimum(other) && (0.0..5.0).contains(&ahead)
        });
        if is_minimum(fold) {
            16 * neighbours.count() as i32
        } else {
            -14
        }
    };
    let mark = |fold: &Fold| Mark {
        at: (fold.alpha.to_degrees(), fold.a),
        shift: shift(fold),
        label: if close {
            format!("{:.2}°, {:.4}", fold.alpha.to_degrees(), fold.a)
        } else {
            String::new()
        },
    };
    let mut series = vec![Series::line("θ̃ = 0", BLUE, branch(true))];
    if !shown.folds.is_empty() {
        series.push(Series::dashed("θ̃ = π", ORANGE, branch(false)));
    }
    let title = match close {
        true => "the same, near the folds",
        false => "equilibrium curve: a = k_a|v_a|²/|W|",
    };
    Chart {
        marks: shown.folds.iter().map(mark).collect(),
        ..Chart::over(title, "angle of attack α [°]", series)
    }
}

fn fold_curves(shown: &Shown) -> Chart<'static> {
    let mut points = Vec::new();
    for piece in shown.fold_curve {
        let mut last = (f64::INFINITY, 0.0);
        for (i, p) in piece.iter().enumerate() {
            let point = (p.epsilon.to_degrees(), p.a);
            // The curve runs fast and slow: no point that would fall on the one before.
            let apart = (point.0 - last.0).abs() > 0.3 || (point.1 - last.1).abs() > 0.005;
            if apart || i + 1 == piece.len() {
                points.push(point);
                last = point;
            }
        }
        points.push((0.0, f64::NAN));
    }
    let highest = points.iter().map(|p| p.1).filter(|a| a.is_finite());
    let highest = highest.fold(0.0, f64::max);
    let epsilon = shown.epsilon.to_degrees();
    let mark = |cusp: &Cusp| Mark {
        at: (cusp.epsilon.to_degrees(), cusp.a),
        label: format!("cusp {:.1}°", cusp.epsilon.to_degrees()),
        shift: 14,
    };
    // A table has cusps wherever it bends: only a few can be labelled.
    let labelled = shown.cusps.len() <= 3;
    let cusps = if labelled { shown.cusps } else { &[] };
    let series = vec![
        Series::line("folds", BLUE, points),
        Series::dashed("this ε", GREY, vec![(epsilon, 0.0), (epsilon, highest)]),
    ];
    let title = "folds at every climb angle: a, by ε";
    Chart {
        marks: cusps.iter().map(mark).collect(),
        ..Chart::over(title, "climb angle ε, or atan(a_f/g) [°]", series)
    }
}

fn coefficients(vehicle: &Vehicle) -> Chart<'static> {
    let line = |name, color, of: fn(&Coefficients) -> f64| {
        let angles = (-1799..1800).map(|n| f64::from(n) * 0.1);
        let at = |degrees: f64| of(&vehicle.aerodynamics.at(degrees.to_radians()));
        Series::line(
            name,
            color,
            angles.map(|degrees| (degrees, at(degrees))).collect(),
        )
    };
    let series = vec![line("c_L", BLUE, |c| c.c_l), line("c_D", ORANGE, |c| c.c_d)];
    Chart::over("coefficients", "angle of attack α [°]", series)
}
