//! The large-angle model (`coeffSmallReynolds1`): a flat plate, spherical for every δ.

use super::{Aerodynamics, Coefficients};
use crate::air::AngleOfAttack;
use crate::error::ParameterError;
use crate::parameters::Parameters;

crate::parameters! {
    /// Parameters of the large-angle model.
    pub struct LargeAngleParameters, "Large-angle model" {
        c0: "", 1e-6, 1e3, 0.0139, "ALU_C0", "Drag coefficient at zero angle of attack.";
        c1: "", 1e-6, 1e3, 0.9430, "ALU_C1", "Largest lift coefficient; half the lift slope at zero angle of attack.";
    }
}

impl LargeAngleParameters {
    /// The paper's fit of NACA 0021 at Re = 160e3 by this model alone.
    pub const NACA_0021_RE_160E3: Self = Self::DEFAULT;
}

/// `c_L = c1 sin 2α`, `c_D = c0 + 2 c1 sin² α` (`coeffSmallReynolds1`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LargeAngle {
    c0: f32,
    c1: f32,
}

impl LargeAngle {
    /// The model with these parameters.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(p: LargeAngleParameters) -> Result<Self, ParameterError> {
        p.check()?;
        Ok(Self { c0: p.c0, c1: p.c1 })
    }
}

impl Aerodynamics for LargeAngle {
    #[inline(always)]
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
        let (s, c) = (alpha.sin, alpha.cos);
        let two_c1 = self.c1 + self.c1;
        let cl = two_c1 * (s * c);
        let (drag, cos_2) = (two_c1 * (s * s), c * c - s * s);
        let slope = two_c1 * cos_2;
        Coefficients {
            c_l: cl,
            c_d: self.c0 + drag,
            dc_l: slope,
            dc_d: cl + cl,
            ddc_l: -4.0 * cl,
            ddc_d: slope + slope,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::error::Problem;

    #[test]
    fn matches_the_printed_equations() {
        let p = LargeAngleParameters::NACA_0021_RE_160E3;
        let (c0, c1) = (f64::from(p.c0), f64::from(p.c1));
        // Roundings of 4 c1, and 1e-6 of the second differences.
        super::super::tests::check(
            &LargeAngle::new(p).unwrap(),
            |a| (c1 * (2.0 * a).sin(), c0 + 2.0 * c1 * a.sin().powi(2)),
            1.0,
            3e-6,
        );
    }

    #[test]
    fn bad_parameters_are_named() {
        let e = LargeAngle::new(LargeAngleParameters { c0: 0.1, c1: -1.0 }).unwrap_err();
        assert_eq!((e.parameter, e.problem), ("c1", Problem::NotPositive));
        let e = LargeAngle::new(LargeAngleParameters {
            c0: f32::NAN,
            c1: 1.0,
        })
        .unwrap_err();
        assert_eq!((e.parameter, e.problem), ("c0", Problem::NotFinite));
    }
}
