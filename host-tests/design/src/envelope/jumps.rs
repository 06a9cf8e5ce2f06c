//! What a vehicle that follows its equilibrium does at a fold: it jumps to another, and back elsewhere.

use super::{Curve, Fold};

/// A jump of the equilibrium angle of attack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// α before it \[rad\].
    pub from_alpha: f64,
    /// α after it \[rad\].
    pub to_alpha: f64,
    /// a at which it happens.
    pub a: f64,
}

/// The widest jump on the way from hover to ever higher airspeed.
pub fn jump_up(curve: &Curve, folds: &[Fold]) -> Option<Jump> {
    // From hover α falls: the first fold whose a is the highest so far ends a branch.
    let mut jumps = Vec::new();
    let mut a = 0.0;
    for fold in folds.iter().rev().filter(|f| is_maximum(curve, f)) {
        if fold.a > a {
            a = fold.a;
            let beyond = curve.equilibria(a * (1.0 + 1e-12), folds);
            let next = beyond
                .into_iter()
                .rfind(|alpha| lands(curve, *alpha, fold) && *alpha < fold.alpha);
            jumps.extend(next.map(|alpha| jump(fold, alpha)));
        }
    }
    widest(jumps)
}

/// The widest jump on the way back.
pub fn jump_down(curve: &Curve, folds: &[Fold]) -> Option<Jump> {
    widest(jumps_down(curve, folds))
}

/// Every jump on the way back.
pub fn jumps_down(curve: &Curve, folds: &[Fold]) -> Vec<Jump> {
    let mut jumps = Vec::new();
    let mut a = f64::INFINITY;
    for fold in folds.iter().filter(|f| !is_maximum(curve, f)) {
        if fold.a < a {
            a = fold.a;
            let beyond = curve.equilibria(a * (1.0 - 1e-12), folds);
            let next = beyond
                .into_iter()
                .find(|alpha| lands(curve, *alpha, fold) && *alpha > fold.alpha);
            jumps.extend(next.map(|alpha| jump(fold, alpha)));
        }
    }
    jumps
}

/// Whether a(α) has a maximum at the fold.
fn is_maximum(curve: &Curve, fold: &Fold) -> bool {
    curve.slope(fold.alpha - 1e-6) > 0.0
}

/// Whether a vehicle stays where it lands: on the branch θ̃ = 0, where a falls with α. What is left of the fold itself does
/// not count.
fn lands(curve: &Curve, alpha: f64, fold: &Fold) -> bool {
    curve.slope(alpha) < 0.0 && (alpha - fold.alpha).abs() > 1e-4
}

fn jump(fold: &Fold, to_alpha: f64) -> Jump {
    Jump {
        from_alpha: fold.alpha,
        to_alpha,
        a: fold.a,
    }
}

fn widest(jumps: Vec<Jump>) -> Option<Jump> {
    let width = |j: &Jump| (j.to_alpha - j.from_alpha).abs();
    jumps
        .into_iter()
        .max_by(|a, b| width(a).total_cmp(&width(b)))
}
