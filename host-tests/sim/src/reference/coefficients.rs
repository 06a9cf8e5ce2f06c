//! The coefficient models as printed: differentiated automatically, and, for the many evaluations of a flight, by their values alone.

use num_dual::{Dual3_64, DualNum};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Table;

/// An aerodynamic model: one of the paper's three families, or a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aerodynamics {
    /// `coeffSmallReynolds1`.
    LargeAngle(LargeAngle),
    /// `coeffLargeReynoldsSamllAlpha1`.
    SmallAngle(SmallAngle),
    /// `CompleteModel`.
    Combined(Combined),
    /// Measured coefficients, interpolated.
    Table(&'static Table),
}

/// Parameters of the large-angle model, as files have them.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LargeAngle {
    /// c_0: drag at zero angle of attack.
    pub c0: f64,
    /// c_1: amplitude.
    pub c1: f64,
}

/// Parameters of the small-angle model, as files have them.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SmallAngle {
    /// c_0: drag at zero angle of attack.
    pub c0: f64,
    /// c_2: lift slope \[1/rad\].
    pub c2: f64,
    /// c_3: growth of the drag \[1/rad²\].
    pub c3: f64,
}

/// Parameters of the combined model, as files have them: the small-angle model below stall, the large-angle model above.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Combined {
    /// c_0 of both.
    pub c0: f64,
    /// c_1 of the large-angle model.
    pub c1: f64,
    /// c_2 of the small-angle model \[1/rad\].
    pub c2: f64,
    /// c_3 of the small-angle model \[1/rad²\].
    pub c3: f64,
    /// ᾱ: where the two cross \[°\].
    pub alpha_bar_deg: f64,
    /// k_L: sharpness of the crossing for lift \[1/rad²\].
    pub k_l: f64,
    /// k_D: sharpness of the crossing for drag \[1/rad²\].
    pub k_d: f64,
}

/// Lift and drag coefficients with two derivatives, \[1/rad\] each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficients {
    /// c_L.
    pub c_l: f64,
    /// c_D.
    pub c_d: f64,
    /// c_L′.
    pub dc_l: f64,
    /// c_D′.
    pub dc_d: f64,
    /// c_L″.
    pub ddc_l: f64,
    /// c_D″.
    pub ddc_d: f64,
}

impl Coefficients {
    fn from_jets(lift: Dual3_64, drag: Dual3_64) -> Self {
        Self {
            c_l: lift.re,
            c_d: drag.re,
            dc_l: lift.v1,
            dc_d: drag.v1,
            ddc_l: lift.v2,
            ddc_d: drag.v2,
        }
    }
}

impl LargeAngle {
    /// c_L and c_D.
    fn at(&self, alpha: Dual3_64) -> [Dual3_64; 2] {
        let lift = (alpha * 2.0).sin() * self.c1;
        let drag = alpha.sin().powi(2) * (2.0 * self.c1) + self.c0;
        [lift, drag]
    }

    /// c_L and c_D at an angle with this sine and cosine.
    fn values(&self, sin: f64, cos: f64) -> (f64, f64) {
        let Self { c0, c1 } = *self;
        (2.0 * c1 * sin * cos, c0 + 2.0 * c1 * sin * sin)
    }
}

impl SmallAngle {
    /// c_L and c_D.
    fn at(&self, alpha: Dual3_64) -> [Dual3_64; 2] {
        let Self { c0, c2, c3 } = *self;
        let divisor = alpha.cos().powi(2) * (c2 - c3) + c3;
        let lift = (alpha * 2.0).sin() * (0.5 * c2 * c2) / divisor;
        let drag = alpha.sin().powi(2) * (c2 * c3) / divisor + c0;
        [lift, drag]
    }

    /// c_L and c_D at an angle with this sine and cosine.
    fn values(&self, sin: f64, cos: f64) -> (f64, f64) {
        let Self { c0, c2, c3 } = *self;
        let part = c2 * sin / ((c2 - c3) * cos * cos + c3);
        (c2 * part * cos, c0 + c3 * part * sin)
    }
}

impl Combined {
    /// NACA 0021 at Re = 160e3 (`coefficientsReL`).
    pub const NACA_0021_RE_160E3: Self = Self {
        c0: 0.014,
        c1: 0.95,
        c2: 5.5,
        c3: 0.3,
        alpha_bar_deg: 11.0,
        k_l: 28.0,
        k_d: 167.0,
    };

    /// ᾱ \[rad\].
    pub fn alpha_bar(&self) -> f64 {
        self.alpha_bar_deg.to_radians()
    }

    /// The model below stall.
    pub fn small(&self) -> SmallAngle {
        let Self { c0, c2, c3, .. } = *self;
        SmallAngle { c0, c2, c3 }
    }

    /// The model above stall.
    pub fn large(&self) -> LargeAngle {
        let Self { c0, c1, .. } = *self;
        LargeAngle { c0, c1 }
    }

    /// c_L and c_D, each with the sum of the magnitudes of its terms.
    fn at(&self, alpha: Dual3_64) -> [(Dual3_64, Dual3_64); 2] {
        let ([small_lift, small_drag], [large_lift, large_drag]) =
            (self.small().at(alpha), self.large().at(alpha));
        let sigma = |k| sigma(self.alpha_bar(), k, alpha);
        [
            blend(small_lift, large_lift, sigma(self.k_l)),
            blend(small_drag, large_drag, sigma(self.k_d)),
        ]
    }
}

/// `sigma`, as printed.
fn sigma(alpha_bar: f64, k: f64, alpha: Dual3_64) -> Dual3_64 {
    let knee = k * alpha_bar * alpha_bar;
    (tanh(alpha.powi(2) * -k + knee) + 1.0) / (1.0 + libm::tanh(knee))
}

/// `Dual3_64::tanh` is sinh/cosh, which is NaN for the large arguments that occur here.
fn tanh(x: Dual3_64) -> Dual3_64 {
    let tanh = libm::tanh(x.re);
    let slope = 1.0 - tanh * tanh;
    let curvature = -2.0 * tanh * slope;
    let third = -2.0 * slope * (slope - 2.0 * tanh * tanh);
    Dual3_64::new(
        tanh,
        slope * x.v1,
        curvature * x.v1 * x.v1 + slope * x.v2,
        third * x.v1.powi(3) + 3.0 * curvature * x.v1 * x.v2 + slope * x.v3,
    )
}

/// One coefficient as a blend of two models: its value, and the same with every product of the
/// product rule taken in magnitude.
fn blend(small: Dual3_64, large: Dual3_64, sigma: Dual3_64) -> (Dual3_64, Dual3_64) {
    let value = small * sigma + large * (-sigma + 1.0);
    let magnitude = abs(small) * abs(sigma) + abs(large) * abs(-sigma + 1.0);
    (value, magnitude)
}

/// `size` with the effect of `n_alpha` in the angle added: |c′|·N(α) to N(c), and so on.
fn propagated(c: Dual3_64, size: Dual3_64, n_alpha: f64) -> Dual3_64 {
    Dual3_64::new(
        size.re + c.v1.abs() * n_alpha,
        size.v1 + c.v2.abs() * n_alpha,
        size.v2 + c.v3.abs() * n_alpha,
        f64::NAN,
    )
}

/// Value and derivatives, each in magnitude.
fn abs(jet: Dual3_64) -> Dual3_64 {
    Dual3_64::new(jet.re.abs(), jet.v1.abs(), jet.v2.abs(), jet.v3.abs())
}

impl Aerodynamics {
    /// Coefficients and their derivatives at `alpha` \[rad\] in [−π, π).
    pub fn at(&self, alpha: f64) -> Coefficients {
        self.at_with_magnitudes(alpha, 0.0).0
    }

    /// The coefficients, and the sums of the magnitudes of the terms that make up each: the terms
    /// of the product rule on `small·σ + large·(1−σ)` (for the other models the coefficient
    /// itself), and the effect of `n_alpha`, the same sum for the angle: |c′|·N(α) in N(c), |c″|·N(α)
    /// in N(c′), |c‴|·N(α) in N(c″).
    pub fn at_with_magnitudes(&self, alpha: f64, n_alpha: f64) -> (Coefficients, Coefficients) {
        let x = Dual3_64::from_re(alpha).derivative();
        let sized = |[lift, drag]: [Dual3_64; 2]| [(lift, abs(lift)), (drag, abs(drag))];
        let [(lift, lift_size), (drag, drag_size)] = match self {
            Self::LargeAngle(model) => sized(model.at(x)),
            Self::SmallAngle(model) => sized(model.at(x)),
            Self::Combined(model) => model.at(x),
            Self::Table(table) => sized(table.at(x).into()),
        };
        (
            Coefficients::from_jets(lift, drag),
            Coefficients::from_jets(
                propagated(lift, lift_size, n_alpha),
                propagated(drag, drag_size, n_alpha),
            ),
        )
    }
}

/// A model by its values alone, with what does not depend on the angle computed once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Values {
    LargeAngle(LargeAngle),
    SmallAngle(SmallAngle),
    Combined {
        small: SmallAngle,
        large: LargeAngle,
        lift: Blend,
        drag: Blend,
    },
    Table(&'static Table),
}

/// `sigma` = (1 + tanh x)/(1 + tanh kᾱ²) as the equal 2/(1 + e^{−2x}) over the same constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blend {
    k: f64,
    /// k ᾱ².
    knee: f64,
    /// 2/(1 + tanh kᾱ²).
    scale: f64,
}

impl Blend {
    fn new(alpha_bar: f64, k: f64) -> Self {
        let knee = k * alpha_bar * alpha_bar;
        Self {
            k,
            knee,
            scale: 2.0 / (1.0 + libm::tanh(knee)),
        }
    }

    fn at(&self, alpha: f64) -> f64 {
        self.scale / (1.0 + libm::exp(-2.0 * (self.knee - self.k * alpha * alpha)))
    }
}

impl Values {
    pub fn new(model: &Aerodynamics) -> Self {
        match *model {
            Aerodynamics::LargeAngle(model) => Self::LargeAngle(model),
            Aerodynamics::SmallAngle(model) => Self::SmallAngle(model),
            Aerodynamics::Combined(model) => Self::Combined {
                small: model.small(),
                large: model.large(),
                lift: Blend::new(model.alpha_bar(), model.k_l),
                drag: Blend::new(model.alpha_bar(), model.k_d),
            },
            Aerodynamics::Table(table) => Self::Table(table),
        }
    }

    /// c_L and c_D at the angle with this sine and cosine.
    pub fn at(&self, sin: f64, cos: f64) -> (f64, f64) {
        match self {
            Self::LargeAngle(model) => model.values(sin, cos),
            Self::SmallAngle(model) => model.values(sin, cos),
            Self::Combined {
                small,
                large,
                lift,
                drag,
            } => {
                let alpha = libm::atan2(sin, cos);
                let (near, far) = (small.values(sin, cos), large.values(sin, cos));
                let mix = |near: f64, far: f64, part: f64| far + part * (near - far);
                (
                    mix(near.0, far.0, lift.at(alpha)),
                    mix(near.1, far.1, drag.at(alpha)),
                )
            }
            Self::Table(table) => table.at(libm::atan2(sin, cos)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMBINED: Aerodynamics = Aerodynamics::Combined(Combined::NACA_0021_RE_160E3);

    /// The automatic derivatives against central differences. Step 1e-4: the truncation error is
    /// h²/6 times a third (fourth) derivative of up to 2e4 (5e6), hence 1e-4 and 1e-2 at most.
    #[test]
    fn derivatives_are_those_of_the_values() {
        let h = 1e-4;
        for i in -314..314 {
            let alpha = f64::from(i) * 0.01;
            let c = COMBINED.at(alpha);
            let (up, down) = (COMBINED.at(alpha + h), COMBINED.at(alpha - h));
            let close = |a: f64, b: f64, tolerance: f64| {
                assert!((a - b).abs() < tolerance, "{alpha}: {a} {b}");
            };
            close(c.dc_l, (up.c_l - down.c_l) / (2.0 * h), 1e-4);
            close(c.dc_d, (up.c_d - down.c_d) / (2.0 * h), 1e-4);
            close(c.ddc_l, (up.c_l - 2.0 * c.c_l + down.c_l) / (h * h), 1e-2);
            close(c.ddc_d, (up.c_d - 2.0 * c.c_d + down.c_d) / (h * h), 1e-2);
        }
    }

    /// At ᾱ the numerator of σ is 1, so σ = 1/(1 + tanh kᾱ²): worked by hand for lift.
    #[test]
    fn the_blend_at_its_knee_is_the_printed_one() {
        let alpha = 11_f64.to_radians();
        let knee: f64 = 28.0 * alpha * alpha;
        let sigma = 1.0 / (1.0 + knee.tanh());
        let small = 0.5 * 5.5 * 5.5 * (2.0 * alpha).sin() / (5.2 * alpha.cos().powi(2) + 0.3);
        let large = 0.95 * (2.0 * alpha).sin();
        let expected = small * sigma + large * (1.0 - sigma);
        assert!((COMBINED.at(alpha).c_l - expected).abs() < 1e-15);
    }
}
