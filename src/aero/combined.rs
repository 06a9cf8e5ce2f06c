//! The combined model (`CompleteModel`): small-angle below stall, large-angle above, blended by σ.

use super::{Aerodynamics, Coefficients};
use crate::air::AngleOfAttack;
use crate::error::ParameterError;
use crate::math;
use crate::parameters::Parameters;

crate::parameters! {
    /// Parameters of the combined model. Those of another wing are begun from a set below, and given by name.
    #[non_exhaustive]
    pub struct CombinedParameters, "Combined model" {
        c0: "", 1e-6, 1e3, 0.014, "ALU_C0",
            "Drag coefficient at zero angle of attack.";
        c1: "", 1e-6, 1e3, 0.95, "ALU_C1",
            "Large-angle part: largest lift coefficient beyond stall.";
        c2: "1/rad", 1e-6, 1e3, 5.5, "ALU_C2",
            "Small-angle part: lift slope at zero angle of attack.";
        c3: "1/rad^2", 1e-6, 1e3, 0.3, "ALU_C3",
            "Small-angle part: growth of drag with the squared angle of attack, at zero.";
        alpha_bar: "rad", 1e-3, math::FRAC_PI_2, 11.0_f64.to_radians() as f32, "ALU_ALPHA_BAR",
            "Stall angle, where the blend is half-way.";
        k_l: "1/rad^2", 1e-6, 1e4, 28.0, "ALU_KL",
            "Sharpness of lift's blend; times alpha_bar squared at most 40.";
        k_d: "1/rad^2", 1e-6, 1e4, 167.0, "ALU_KD",
            "Sharpness of drag's blend; times alpha_bar squared at most 40.";
    }
}

impl CombinedParameters {
    /// The paper's NACA 0021 at Re = 160e3 (`coefficientsReL`).
    pub const NACA_0021_RE_160E3: Self = Self::DEFAULT;

    /// The paper's NACA 0021 at Re = 5e6.
    pub const NACA_0021_RE_5E6: Self = Self {
        c0: 0.0078,
        c1: 0.9430,
        c2: 6.3025,
        c3: 0.1378,
        alpha_bar: 18.0_f64.to_radians() as f32,
        k_l: 12.0,
        k_d: 86.0,
    };

    /// What the paper's controller believes of NACA 0021 at Re = 160e3: wrong on purpose (§VII).
    pub const PAPER_BELIEF: Self = Self {
        c0: 0.020,
        c1: 0.9,
        c2: 5.0,
        c3: 0.5,
        alpha_bar: 10.0_f64.to_radians() as f32,
        k_l: 28.0,
        k_d: 167.0,
    };
}

/// `c = c_small σ + c_large (1 − σ)`, with a σ of its own for lift and for drag (`CompleteModel`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Combined {
    c0: f32,
    two_c1: f32,
    c2: f32,
    c3: f32,
    alpha_bar: f32,
    lift: Blend,
    drag: Blend,
}

impl Combined {
    /// The model with these parameters.
    ///
    /// # Errors
    /// A parameter outside its range, or `k_l` or `k_d` with k·ᾱ² above 40: a blend too sharp for single precision.
    pub fn new(p: CombinedParameters) -> Result<Self, ParameterError> {
        p.check()?;
        Ok(Self {
            c0: p.c0,
            two_c1: 2.0 * p.c1,
            c2: p.c2,
            c3: p.c3,
            alpha_bar: p.alpha_bar,
            lift: Blend::new("k_l", p.k_l, p.alpha_bar)?,
            drag: Blend::new("k_d", p.k_d, p.alpha_bar)?,
        })
    }
}

impl Aerodynamics for Combined {
    #[inline(always)]
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
        let (s, c) = (alpha.sin, alpha.cos);
        let (c2, c3, two_c1) = (self.c2, self.c3, self.two_c1);
        let (sc, ss, cc) = (s * c, s * s, c * c);
        let cos_2 = cc - ss;

        // α² − ᾱ² as a product: the difference is what the blend's exponent amplifies.
        let excess = (alpha.rad - self.alpha_bar) * (alpha.rad + self.alpha_bar);
        let (lift, drag) = (self.lift.power(excess), self.drag.power(excess));
        // 1/D, 1/(1 + e_L) and 1/(1 + e_D) by one division: it costs as much as fourteen products.
        let d = c2 * cc + c3 * ss;
        let (u_l, u_d) = (1.0 + lift, 1.0 + drag);
        let product = u_l * u_d;
        let common = 1.0 / (d * product);
        let inverse = common * product;
        let lift = self.lift.at(alpha.rad, lift, common * (d * u_d));
        let drag = self.drag.at(alpha.rad, drag, common * (d * u_l));

        // Small-angle less large-angle model: c0 cancels, and a factor sin α cos α, or sin² α, is common:
        // Δc_L = sc·(c2²/D − 2c1), Δc_D = s²·(c2 c3/D − 2c1).
        let (a_l, a_d) = (c2 * c2 * inverse, c2 * c3 * inverse);
        let (b_l, b_d) = (a_l - two_c1, a_d - two_c1);
        let (delta_l, delta_d) = (sc * b_l, ss * b_d);
        // (sc/D)' = (c2 c² − c3 s²)/D² and (s²/D)' = 2 c2 sc/D².
        let (p, q) = ((c2 * cc - c3 * ss) * inverse, 2.0 * c2 * (sc * inverse));
        let slope = two_c1 * cos_2;
        let cl = two_c1 * sc;
        let d_delta_l = a_l * p - slope;
        let d_delta_d = a_d * q - (cl + cl);
        // (sc/D)'' and (s²/D)'', as in the small-angle model.
        let square = inverse * inverse;
        let pp = 2.0 * sc * (c2 * (c2 - 3.0 * c3) * cc + c3 * (c3 - 3.0 * c2) * ss) * square;
        let qq =
            2.0 * c2 * (c2 * (cc * cc) + 3.0 * (c2 - c3) * (sc * sc) - c3 * (ss * ss)) * square;
        let dd_delta_l = a_l * pp + 4.0 * cl;
        let dd_delta_d = a_d * qq - (slope + slope);

        Coefficients {
            c_l: cl + lift.value * delta_l,
            c_d: self.c0 + (two_c1 * ss + drag.value * delta_d),
            dc_l: slope + (lift.value * d_delta_l + lift.first * delta_l),
            dc_d: (cl + cl) + (drag.value * d_delta_d + drag.first * delta_d),
            ddc_l: -4.0 * cl
                + (lift.value * dd_delta_l + 2.0 * lift.first * d_delta_l + lift.second * delta_l),
            ddc_d: (slope + slope)
                + (drag.value * dd_delta_d + 2.0 * drag.first * d_delta_d + drag.second * delta_d),
        }
    }
}

/// σ(ᾱ, k, α) = (1 + tanh(kᾱ² − kα²)) / (1 + tanh(kᾱ²)) (`sigma`), computed as the equal
/// (1 + e^{−2kᾱ²}) / (1 + e^{2k(α² − ᾱ²)}).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Blend {
    /// 2k/ln 2: turns α² − ᾱ² into a power of two.
    exponent: f32,
    /// 1 + e^{−2kᾱ²}.
    scale: f32,
    /// −4k (1 + e^{−2kᾱ²}), the factor of σ'.
    slope: f32,
    /// 4k.
    four_k: f32,
}

/// σ and its derivatives with respect to α.
struct Sigma {
    value: f32,
    first: f32,
    second: f32,
}

/// Exponents of two above this are cut off: σ is below 2e-17 there, and the product of both powers and of the largest
/// coefficient must not overflow.
const MAX_EXPONENT: f32 = 56.0;
/// Two to that power.
const MAX_POWER: f32 = (1u64 << 56) as f32;

/// What the steepness of a blend must be.
const STEEPEST: &str = "at most 40 over the square of alpha_bar";

impl Blend {
    fn new(parameter: &'static str, k: f32, alpha_bar: f32) -> Result<Self, ParameterError> {
        if !matches!(k * alpha_bar * alpha_bar, x if x <= 40.0) {
            return Err(ParameterError::contradiction(parameter, STEEPEST));
        }
        let exponent = 2.0 * k * core::f32::consts::LOG2_E;
        let scale = 1.0 + math::exp2(-exponent * alpha_bar * alpha_bar);
        Ok(Self {
            exponent,
            scale,
            slope: -4.0 * k * scale,
            four_k: 4.0 * k,
        })
    }

    /// e = e^{2k(α² − ᾱ²)}, where `excess` = α² − ᾱ².
    #[inline(always)]
    fn power(&self, excess: f32) -> f32 {
        let exponent = self.exponent * excess;
        // A branch and not the smaller of two numbers: far behind the stall, as around hover, there is nothing to compute.
        if exponent < MAX_EXPONENT {
            math::exp2(exponent)
        } else {
            MAX_POWER
        }
    }

    /// σ at `alpha` \[rad\], where `e` is [`power`](Self::power) and `r` = 1/(1 + e).
    #[inline(always)]
    fn at(&self, alpha: f32, e: f32, r: f32) -> Sigma {
        // e·r = 1 − r without the cancellation.
        let er = e * r;
        let slope = self.slope * (er * r);
        Sigma {
            value: self.scale * r,
            first: slope * alpha,
            second: slope * (1.0 - self.four_k * alpha * alpha * (er - r)),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// Where the exponent is cut off nothing is computed: the power is the one that would be.
    #[test]
    fn the_greatest_power_is_the_one_of_the_greatest_exponent() {
        assert_eq!(math::exp2(MAX_EXPONENT).to_bits(), MAX_POWER.to_bits());
        let blend = Blend::new("k_l", 28.0, 0.2).unwrap();
        assert!(blend.power(56.0 / blend.exponent - 1e-3) < MAX_POWER);
        for excess in [56.0 / blend.exponent + 1e-3, 9.0, f32::INFINITY, f32::NAN] {
            assert_eq!(blend.power(excess), MAX_POWER);
        }
    }

    /// The printed equations, with tanh.
    fn printed(p: CombinedParameters, a: f64) -> (f64, f64) {
        let [c0, c1, c2, c3] = [p.c0, p.c1, p.c2, p.c3].map(f64::from);
        let [bar, k_l, k_d] = [p.alpha_bar, p.k_l, p.k_d].map(f64::from);
        let sigma =
            |k: f64| (1.0 + (k * bar * bar - k * a * a).tanh()) / (1.0 + (k * bar * bar).tanh());
        let d = (c2 - c3) * a.cos().powi(2) + c3;
        let small = (
            0.5 * c2 * c2 * (2.0 * a).sin() / d,
            c0 + c2 * c3 * a.sin().powi(2) / d,
        );
        let large = (c1 * (2.0 * a).sin(), c0 + 2.0 * c1 * a.sin().powi(2));
        let (l, d) = (sigma(k_l), sigma(k_d));
        (
            small.0 * l + large.0 * (1.0 - l),
            small.1 * d + large.1 * (1.0 - d),
        )
    }

    #[test]
    fn matches_the_printed_equations() {
        for p in [
            CombinedParameters::NACA_0021_RE_160E3,
            CombinedParameters::NACA_0021_RE_5E6,
            CombinedParameters::PAPER_BELIEF,
        ] {
            super::super::tests::check(&Combined::new(p).unwrap(), |a| printed(p, a), 100.0, 5e-6);
        }
    }

    /// Where the small-angle model still counts at 90°, the terms of sin² count too.
    #[test]
    fn a_late_and_gentle_stall_matches_the_printed_equations() {
        let p = CombinedParameters {
            c0: 0.05,
            c1: 0.8,
            c2: 3.0,
            c3: 1.3,
            alpha_bar: 1.4,
            k_l: 1.0,
            k_d: 0.7,
        };
        super::super::tests::check(&Combined::new(p).unwrap(), |a| printed(p, a), 10.0, 5e-6);
    }

    #[test]
    fn far_beyond_stall_only_the_large_angle_model_is_left() {
        let p = CombinedParameters::NACA_0021_RE_160E3;
        let large = super::super::LargeAngle::new(super::super::LargeAngleParameters {
            c0: p.c0,
            c1: p.c1,
        })
        .unwrap();
        let a = AngleOfAttack::from_radians(2.5);
        let (got, want) = (
            Combined::new(p).unwrap().coefficients(a),
            large.coefficients(a),
        );
        assert!((got.c_l - want.c_l).abs() < 1e-7 && (got.c_d - want.c_d).abs() < 3e-7);
    }

    #[test]
    fn bad_parameters_are_named() {
        let good = CombinedParameters::NACA_0021_RE_160E3;
        let error = |p| {
            let e = Combined::new(p).unwrap_err();
            (e.parameter, e.problem)
        };
        use crate::error::Problem::{Contradiction, NotFinite, NotPositive, OutOfRange};
        assert_eq!(
            error(CombinedParameters { c1: 0.0, ..good }),
            ("c1", NotPositive)
        );
        assert_eq!(
            error(CombinedParameters {
                alpha_bar: 2.0,
                ..good
            }),
            ("alpha_bar", OutOfRange)
        );
        assert_eq!(
            error(CombinedParameters {
                k_l: f32::NAN,
                ..good
            }),
            ("k_l", NotFinite)
        );
        assert_eq!(
            error(CombinedParameters { k_d: 5e3, ..good }),
            ("k_d", Contradiction)
        );
    }
}
