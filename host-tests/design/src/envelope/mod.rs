//! The envelope of a vehicle in double precision: its equilibrium curves, their folds, jumps and cusps.
//!
//! A vehicle at a steady climb angle ε, or in a level acceleration a_f = g tan ε, has its apparent weight at β = −90° − ε
//! from its air velocity. There α is an equilibrium at `a(α; β) = k_a|v_a|²/|W|` ([`Curve`]); the curve folds where the
//! equivalent coefficients (c̄_D, −c̄_L) point along β, at `a = 1/|c̄|` ([`FoldCurve`]): one curve, of the vehicle alone, holds
//! the folds of every ε, and its cusps are the zeros of the residual of `eq:condition`.

mod curve;
mod fold_curve;
mod jumps;
mod summary;

pub use curve::{Curve, Fold, Interval};
pub use fold_curve::{Cusp, FoldCurve, FoldPoint};
pub use jumps::{Jump, jump_down, jump_up, jumps_down};
pub use summary::{CuspSummary, Envelope, FoldSummary, JumpSummary, Ray, Refused, Summary};

use alula_sim::reference::{Coefficients, Vehicle};

/// An angle of attack with what the envelope needs there.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// sin(α+δ), cos(α+δ).
    sin: f64,
    cos: f64,
    /// q = c_L cos(α+δ) + c_D sin(α+δ).
    q: f64,
    /// c̄_L and c̄_D by `eq:pGC`.
    c_l_bar: f64,
    c_d_bar: f64,
    /// Residual of `eq:condition`.
    h: f64,
}

impl Point {
    fn at(vehicle: &Vehicle, alpha: f64) -> Self {
        let c: Coefficients = vehicle.aerodynamics.at(alula_sim::reference::wrap(alpha));
        let (sin, cos) = (alpha + vehicle.delta).sin_cos();
        let lambda = c.dc_l * cos + c.dc_d * sin;
        Self {
            sin,
            cos,
            q: c.c_l * cos + c.c_d * sin,
            c_l_bar: c.c_l - lambda * sin,
            c_d_bar: c.c_d + lambda * cos,
            h: (c.ddc_d - 2.0 * c.dc_l) * sin + (c.ddc_l + 2.0 * c.dc_d) * cos,
        }
    }
}

/// A zero of `f` between `low` and `high`, where it has opposite signs, to the last digit.
fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rising = f(low) < 0.0;
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if (f(middle) < 0.0) == rising {
            low = middle;
        } else {
            high = middle;
        }
    }
}
