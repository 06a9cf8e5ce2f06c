//! Folds, counts, jumps and cusps of the models and of the tables, in double precision.

use alula_design::envelope::{Curve, Fold, FoldCurve, Interval, jump_down, jump_up};
use alula_sim::polar::Polar;
use alula_sim::reference::{Aerodynamics, Combined, LargeAngle, Table, Vehicle};

fn vehicle(aerodynamics: Aerodynamics) -> Vehicle {
    Vehicle {
        mass: 10.0,
        k_a: 0.646,
        delta: 0.0,
        gravity: 9.81,
        aerodynamics,
    }
}

const COMBINED: Aerodynamics = Aerodynamics::Combined(Combined::NACA_0021_RE_160E3);

fn folds(aerodynamics: Aerodynamics, epsilon_deg: f64) -> Vec<(f64, f64)> {
    let vehicle = vehicle(aerodynamics);
    let curve = Curve::new(&vehicle, epsilon_deg.to_radians()).unwrap();
    let degrees = |fold: &Fold| (fold.alpha.to_degrees(), fold.a);
    curve.folds().iter().map(degrees).collect()
}

/// Equal to the digits given.
fn assert_folds(folds: &[(f64, f64)], expected: &[(f64, f64)], alpha: f64, a: f64) {
    assert_eq!(folds.len(), expected.len(), "{folds:?}");
    for (f, e) in folds.iter().zip(expected) {
        assert!(
            (f.0 - e.0).abs() < alpha && (f.1 - e.1).abs() < a,
            "{folds:?}"
        );
    }
}

#[test]
fn the_combined_model_folds_where_theory_says() {
    let level = [(11.155, 1.30333), (16.764, 1.52879)];
    assert_folds(&folds(COMBINED, 0.0), &level, 0.01, 1e-4);
    let climb = [(11.59, 0.998), (16.13, 1.098)];
    assert_folds(&folds(COMBINED, 30.0), &climb, 0.01, 1e-3);
    let steep = [(12.26, 0.631), (15.10, 0.648)];
    assert_folds(&folds(COMBINED, 50.0), &steep, 0.01, 1e-3);
    assert_eq!(folds(COMBINED, 60.0), []);
}

/// The cusp from the residual of `eq:condition`, against the ε at which a scan stops finding folds.
#[test]
fn the_cusp_is_where_the_folds_vanish() {
    let vehicle = vehicle(COMBINED);
    let cusps = FoldCurve::new(&vehicle).cusps();
    let between =
        |c: &&alula_design::envelope::Cusp| (50.0..60.0).contains(&c.epsilon.to_degrees());
    let cusp = cusps.iter().find(between).expect("a cusp");
    let epsilon = cusp.epsilon.to_degrees();
    println!("{epsilon}° {} {}°", cusp.a, cusp.alpha.to_degrees());
    assert_eq!(folds(COMBINED, epsilon - 0.05).len(), 2);
    assert_eq!(folds(COMBINED, epsilon + 0.05).len(), 0);
    let [low, high] = folds(COMBINED, epsilon - 0.05)[..] else {
        unreachable!()
    };
    assert!(low.0 < cusp.alpha.to_degrees() && cusp.alpha.to_degrees() < high.0);
    assert!(low.1 < high.1 && (low.1 - cusp.a).abs() < 2e-3);
}

fn table(name: &str) -> Aerodynamics {
    Aerodynamics::Table(Polar::load(name).unwrap().reference)
}

fn counts(curve: &Curve) -> Vec<usize> {
    let counts: Vec<Interval> = curve.counts(&curve.folds());
    counts.iter().map(|interval| interval.n).collect()
}

#[test]
fn the_table_folds_near_what_the_paper_reports() {
    let vehicle = vehicle(table("naca-0021-re-160e3"));
    let curve = Curve::new(&vehicle, 0.0).unwrap();
    let folds = curve.folds();
    let a: Vec<f64> = folds.iter().map(|fold| fold.a).collect();
    for (a, expected) in a.iter().zip([1.334, 1.348, 1.342, 1.456]) {
        assert!((a - expected).abs() < 0.005, "{folds:?}");
    }
    assert_eq!(counts(&curve), [1, 3, 5, 3, 1]);
    let up = jump_up(&curve, &folds).unwrap();
    let down = jump_down(&curve, &folds).unwrap();
    println!("{folds:?}\n{up:?}\n{down:?}");
    for (angle, expected) in [
        (up.from_alpha, 18.6),
        (up.to_alpha, 8.2),
        (down.from_alpha, 11.0),
        (down.to_alpha, 22.5),
    ] {
        assert!((angle.to_degrees() - expected).abs() < 0.3, "{angle}");
    }
    assert!((up.a - 1.456).abs() < 0.005 && (down.a - 1.334).abs() < 0.005);
}

/// PCHIP (Fritsch and Butland), C¹ only: the other interpolant.
fn pchip(x: Vec<f64>, y: Vec<f64>) -> impl Fn(f64) -> f64 {
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let s: Vec<f64> = (0..h.len()).map(|i| (y[i + 1] - y[i]) / h[i]).collect();
    let d: Vec<f64> = (0..x.len())
        .map(|i| {
            if i == 0 || i == h.len() {
                // By the section's symmetry: lift goes straight through the axis, drag is flat there.
                return if y[i] == 0.0 {
                    s[i.min(h.len() - 1)]
                } else {
                    0.0
                };
            }
            if s[i - 1] * s[i] <= 0.0 {
                return 0.0;
            }
            let (w1, w2) = (2.0 * h[i] + h[i - 1], h[i] + 2.0 * h[i - 1]);
            (w1 + w2) / (w1 / s[i - 1] + w2 / s[i])
        })
        .collect();
    move |at: f64| {
        let i = x.partition_point(|node| *node <= at).clamp(1, x.len() - 1) - 1;
        let u = (at - x[i]) / h[i];
        let (v, w) = (1.0 - u, u * u);
        y[i] * (1.0 + 2.0 * u) * v * v + h[i] * d[i] * u * v * v + y[i + 1] * w * (3.0 - 2.0 * u)
            - h[i] * d[i + 1] * w * v
    }
}

/// The outer fold and the jump with another interpolant, from a(α) = cot α/(c_D + c_L cot α) alone.
#[test]
fn the_outer_fold_and_the_jump_do_not_depend_on_the_interpolant() {
    let rows = Polar::load("naca-0021-re-160e3").unwrap().rows;
    let column = |k: usize| rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
    let (lift, drag) = (pchip(column(0), column(1)), pchip(column(0), column(2)));
    let a = |degrees: f64| {
        let alpha = degrees.to_radians();
        let cot = 1.0 / alpha.tan();
        cot / (drag(alpha) + lift(alpha) * cot)
    };
    let scan: Vec<(f64, f64)> = (20..8990)
        .map(|n| f64::from(n) * 0.01)
        .map(|degrees| (degrees, a(degrees)))
        .collect();
    let turns: Vec<(f64, f64)> = scan
        .windows(3)
        .filter(|w| (w[1].1 - w[0].1) * (w[2].1 - w[1].1) < 0.0)
        .map(|w| w[1])
        .collect();
    let [inner, _, _, outer] = turns[..] else {
        panic!("{turns:?}")
    };
    let crossing = |level: f64| {
        let mut crossings = scan
            .windows(2)
            .filter(|w| (w[0].1 - level) * (w[1].1 - level) < 0.0)
            .map(|w| w[0].0);
        crossings.next().unwrap()
    };
    let vehicle = vehicle(table("naca-0021-re-160e3"));
    let curve = Curve::new(&vehicle, 0.0).unwrap();
    let (up, down) = (
        jump_up(&curve, &curve.folds()).unwrap(),
        jump_down(&curve, &curve.folds()).unwrap(),
    );
    let others = [
        (up.from_alpha, outer.0),
        (up.to_alpha, crossing(outer.1 * 1.000_001)),
        (down.from_alpha, inner.0),
        (down.to_alpha, crossing(inner.1 * 0.999_999)),
    ];
    for (ours, other) in others {
        println!("{:.2}° {other:.2}°", ours.to_degrees());
        assert!((ours.to_degrees() - other).abs() < 0.6);
    }
    assert!((up.a - outer.1).abs() < 0.005 && (down.a - inner.1).abs() < 0.005);
}

/// The same section as a full table, nose and tail: the same curve.
#[test]
fn a_full_table_has_the_symmetric_tables_curve() {
    let half = Polar::load("naca-0021-re-160e3").unwrap().rows;
    let mirrored = half.iter().skip(1).rev().map(|r| [-r[0], -r[1], r[2]]);
    let full: Vec<_> = mirrored.chain(half.iter().copied()).collect();
    let full = Aerodynamics::Table(Box::leak(Box::new(Table::new(&full))));
    let (a, b) = (folds(full, 0.0), folds(table("naca-0021-re-160e3"), 0.0));
    assert_folds(&a, &b, 1e-9, 1e-12);
}

/// Where the shape is equivalent to a sphere nothing folds, whatever the climb angle.
#[test]
fn spheres_do_not_fold() {
    let large = Aerodynamics::LargeAngle(LargeAngle {
        c0: 0.0139,
        c1: 0.943,
    });
    for epsilon in [-60.0, -20.0, 0.0, 45.0, 80.0] {
        assert_eq!(folds(large, epsilon), []);
    }
    assert!(FoldCurve::new(&vehicle(large)).pieces().is_empty());
    assert!(FoldCurve::new(&vehicle(large)).cusps().is_empty());
}
