//! Where a wing stalls.

use super::Aerodynamics;
use crate::air::AngleOfAttack;
use crate::math;

/// Steps of half a degree \[rad\], and how many: up to 30°, where every wing has stalled.
const STEP: f32 = 8.726_646e-3;
const STEPS: u8 = 61;
/// Part of the greatest lift that is left where a wing has stalled: what it finds again as a plate is no lift short of stall.
const LEFT: f32 = 0.97;

/// The greatest lift on the way from zero lift to stall.
pub(crate) struct Stall {
    /// Lift coefficient.
    pub c_l: f32,
    /// Sine of the angle of attack.
    pub sin: f32,
}

impl Stall {
    /// The stall of a `model`.
    pub fn of<A: Aerodynamics>(model: &A) -> Self {
        Self::on(&|alpha| model.coefficients(alpha).c_l)
    }

    /// The stall of a wing with the lift coefficient `c_l`. It is given as a function, and not as a model, so that the loop is compiled once
    /// and not once for each model that may be chosen.
    fn on(c_l: &dyn Fn(AngleOfAttack) -> f32) -> Self {
        let mut most = Self { c_l: 0.0, sin: 0.0 };
        for n in 0..STEPS {
            let rad = f32::from(n) * STEP;
            let (sin, cos) = math::sin_cos(rad);
            let c_l = c_l(AngleOfAttack { sin, cos, rad });
            if c_l > most.c_l {
                most = Self { c_l, sin };
            } else if c_l < LEFT * most.c_l {
                break;
            }
        }
        most
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};

    /// The paper's wing: the greatest c_L of a fine search, within what half a degree can miss.
    #[test]
    fn the_stall_is_the_first_maximum() {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let stall = Stall::of(&model);
        let fine = (0..3000).map(|n| AngleOfAttack::from_radians(n as f32 * 1e-4));
        let (at, c_l) = fine
            .map(|alpha| (alpha.sin, model.coefficients(alpha).c_l))
            .fold(
                (0.0, 0.0),
                |most, next| if next.1 > most.1 { next } else { most },
            );
        assert!((stall.sin - at).abs() <= STEP && (stall.c_l - c_l).abs() < 5e-3);
    }

    /// A plate's lift behind the stall is greater than the wing's, and is not meant; a wing that never stalls has what it has at 30°.
    #[test]
    fn the_lift_of_a_plate_is_not_the_wings() {
        let plate = |alpha: AngleOfAttack| {
            let attached = 4.0 * alpha.rad;
            if alpha.rad < 0.2 {
                attached
            } else {
                2.0 * alpha.sin
            }
        };
        let stall = Stall::on(&plate);
        assert!((stall.c_l - 0.8).abs() < 0.04 && (stall.sin - 0.199).abs() < 0.01);
        let stall = Stall::on(&|alpha| alpha.rad);
        assert!((stall.sin - 0.5).abs() < 1e-6);
    }
}
