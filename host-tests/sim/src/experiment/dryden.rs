//! Dryden turbulence at low altitude (MIL-F-8785C): its scales, and its components, each stepped exactly.

use rand::Rng;

use super::TurbulenceSpec;
use super::normal::normal;

const FOOT: f64 = 0.3048;

/// Intensities and lengths at a height: along the wind (u) and vertical (w).
pub(crate) struct Scales {
    /// σ_u \[m/s\].
    pub sigma_u: f64,
    /// σ_w \[m/s\].
    pub sigma_w: f64,
    /// L_u \[m\].
    pub length_u: f64,
    /// L_w \[m\].
    pub length_w: f64,
}

impl Scales {
    pub(crate) fn of(spec: &TurbulenceSpec) -> Self {
        // The specification's formulas are in feet.
        let h = spec.height_m / FOOT;
        let base = 0.177 + 0.000823 * h;
        let sigma_w = 0.1 * spec.wind_at_20_ft_m_s;
        Self {
            sigma_u: sigma_w / libm::pow(base, 0.4),
            sigma_w,
            length_u: h / libm::pow(base, 1.2) * FOOT,
            length_w: h * FOOT,
        }
    }
}

/// The component along the wind, with H_u = σ_u √(2L_u/(πV)) / (1 + L_u s/V), over its σ_u: `u` after a `path` \[m\] through the air.
/// Stepped exactly, as are the others: whatever the step, the samples have the continuous process's covariance.
pub(crate) fn along(u: f64, path: f64, length: f64, random: &mut impl Rng) -> f64 {
    let a = libm::exp(-path / length);
    a * u + (1.0 - a * a).sqrt() * normal(random)
}

/// A component across the wind, with H = σ √(L/(πV)) (1 + √3 L s/V) / (1 + L s/V)², over its σ: the outputs of one and of two
/// first-order filters in a row, of driving noise such that the first has variance ½.
pub(crate) struct Transverse([f64; 2]);

impl Transverse {
    pub(crate) fn new(random: &mut impl Rng) -> Self {
        // The stationary covariance of the two filters: ½, ¼, ¼.
        let (a, b) = (normal(random), normal(random));
        Self([0.5_f64.sqrt() * a, (0.5 * a + 0.5 * b) * 0.5_f64.sqrt()])
    }

    /// Its value, of unit variance.
    pub(crate) fn value(&self) -> f64 {
        let root_3 = 3.0_f64.sqrt();
        root_3 * self.0[0] + (1.0 - root_3) * self.0[1]
    }

    /// Goes on by a `path` \[m\] through the air.
    pub(crate) fn advance(&mut self, path: f64, length: f64, random: &mut impl Rng) {
        let z = path / length;
        let (a, e) = (libm::exp(-z), libm::exp(-2.0 * z));
        // Covariance of what the noise adds over the step: ∫ e^{−2z} (1, z, z²) dz.
        let q11 = 0.5 * (1.0 - e);
        let q12 = 0.25 * (1.0 - e * (1.0 + 2.0 * z));
        let q22 = 0.25 * (1.0 - e * (1.0 + 2.0 * z + 2.0 * z * z));
        let l11 = q11.sqrt();
        let l21 = q12 / l11;
        let l22 = (q22 - l21 * l21).max(0.0).sqrt();
        let (n1, n2) = (normal(random), normal(random));
        let [w1, w2] = self.0;
        self.0 = [a * w1 + l11 * n1, a * (w2 + z * w1) + l21 * n1 + l22 * n2];
    }
}

/// Below this airspeed \[m/s\] the field is taken to pass at this speed: it would stand still in hover.
pub(crate) const LEAST_SPEED: f64 = 2.0;
