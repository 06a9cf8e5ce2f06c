//! The small-angle model (`coeffLargeReynoldsSamllAlpha1`): a lifting wing below stall, spherical for δ = 0.

use super::{Aerodynamics, Coefficients};
use crate::air::AngleOfAttack;
use crate::error::ParameterError;
use crate::parameters::Parameters;

crate::parameters! {
    /// Parameters of the small-angle model.
    pub struct SmallAngleParameters, "Small-angle model" {
        c0: "", 1e-6, 1e3, 0.014, "ALU_C0", "Drag coefficient at zero angle of attack.";
        c2: "1/rad", 1e-6, 1e3, 5.5, "ALU_C2", "Lift slope at zero angle of attack.";
        c3: "1/rad^2", 1e-6, 1e3, 0.3, "ALU_C3", "Growth of drag with the squared angle of attack, at zero.";
    }
}

/// `D = (c2 − c3) cos² α + c3`, `c_L = ½ c2² sin 2α / D`, `c_D = c0 + c2 c3 sin² α / D`
/// (`coeffLargeReynoldsSamllAlpha1`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SmallAngle {
    c0: f32,
    c2: f32,
    c3: f32,
}

impl SmallAngle {
    /// The model with these parameters.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(p: SmallAngleParameters) -> Result<Self, ParameterError> {
        p.check()?;
        Ok(Self {
            c0: p.c0,
            c2: p.c2,
            c3: p.c3,
        })
    }
}

impl Aerodynamics for SmallAngle {
    #[inline(always)]
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
        let (s, c) = (alpha.sin, alpha.cos);
        let (c2, c3) = (self.c2, self.c3);
        let (sc, ss, cc) = (s * c, s * s, c * c);
        // D = c2 cos² + c3 sin² > 0: a sum of positive terms, where the printed form cancels.
        // (sc/D)' = (c2 c² − c3 s²)/D², (sc/D)'' = 2 sc (c2 (c2 − 3c3) c² + c3 (c3 − 3c2) s²)/D³,
        // (s²/D)' = 2 c2 sc/D², (s²/D)'' = 2 c2 (c2 c⁴ + 3 (c2 − c3) s²c² − c3 s⁴)/D³.
        let inverse = 1.0 / (c2 * cc + c3 * ss);
        let (square, cube) = (inverse * inverse, inverse * inverse * inverse);
        let (sc_d, ss_d) = (sc * inverse, ss * inverse);
        let d_sc_d = (c2 * cc - c3 * ss) * square;
        let d_ss_d = 2.0 * c2 * (sc * square);
        let dd_sc_d = 2.0 * sc * (c2 * (c2 - 3.0 * c3) * cc + c3 * (c3 - 3.0 * c2) * ss) * cube;
        let dd_ss_d =
            2.0 * c2 * (c2 * (cc * cc) + 3.0 * (c2 - c3) * (sc * sc) - c3 * (ss * ss)) * cube;
        let (lift, drag) = (c2 * c2, c2 * c3);
        Coefficients {
            c_l: lift * sc_d,
            c_d: self.c0 + drag * ss_d,
            dc_l: lift * d_sc_d,
            dc_d: drag * d_ss_d,
            ddc_l: lift * dd_sc_d,
            ddc_d: drag * dd_ss_d,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn matches_the_printed_equations() {
        let p = SmallAngleParameters {
            c0: 0.014,
            c2: 5.5,
            c3: 0.3,
        };
        let (c0, c2, c3) = (f64::from(p.c0), f64::from(p.c2), f64::from(p.c3));
        // The second derivatives at 90° reach 1e4 (D falls to c3): 3e-6 is their rounding and h² of the differences.
        super::super::tests::check(
            &SmallAngle::new(p).unwrap(),
            |a| {
                let d = (c2 - c3) * a.cos().powi(2) + c3;
                (
                    0.5 * c2 * c2 * (2.0 * a).sin() / d,
                    c0 + c2 * c3 * a.sin().powi(2) / d,
                )
            },
            10.0,
            1e-5,
        );
    }

    #[test]
    fn bad_parameters_are_named() {
        let good = SmallAngleParameters {
            c0: 0.014,
            c2: 5.5,
            c3: 0.3,
        };
        let name = |p| SmallAngle::new(p).unwrap_err().parameter;
        assert_eq!(name(SmallAngleParameters { c0: 0.0, ..good }), "c0");
        assert_eq!(name(SmallAngleParameters { c2: 1e9, ..good }), "c2");
        assert_eq!(
            name(SmallAngleParameters {
                c3: f32::INFINITY,
                ..good
            }),
            "c3"
        );
    }
}
