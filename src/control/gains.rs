//! Gains of the velocity laws: constant, as in the paper.

use super::guard::Guard;
use crate::error::ParameterError;
use crate::parameters::Parameters;

crate::parameters! {
    /// Constant gains, as in the paper. `DEFAULT` is [`PAPER`](Self::PAPER), which suits the paper's vehicle of 10 kg alone: gains of another have each
    /// replaced by name. Nobody flies them unasked: gains are by bandwidth where nothing is said.
    #[non_exhaustive]
    pub struct GainParameters, "Constant gains" {
        k1: "s/m", 1e-9, 1e6, 0.1529, "ALU_K1",
            "Gain k1: thrust per velocity error along the thrust line, relative to |F_p|.";
        k2: "rad/(N m)", 1e-9, 1e6, 0.0234, "ALU_K2",
            "Gain k2: angular rate per velocity error across the thrust line and per |F_p|.";
        k3: "rad/s", 1e-9, 1e6, 6.0, "ALU_K3",
            "Gain k3: angular rate per misalignment of thrust and F_p.";
        tau: "N", 1e-3, 1e6, 80.0, "ALU_TAU",
            "Force τ below which the guard μ_τ acts.";
    }
}

impl GainParameters {
    /// The gains of the paper's simulation (§VII).
    pub const PAPER: Self = Self::DEFAULT;
}

/// The gains that hold at one |F_p|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainValues {
    /// k1 [s/m].
    pub k1: f32,
    /// k2 [rad/(N·m)].
    pub k2: f32,
    /// k3 [rad/s].
    pub k3: f32,
}

/// How the gains follow |F_p|. Chosen by type, so that the constant gains cost a control step nothing.
pub trait GainLaw {
    /// The gains at |F_p| \[N\].
    fn at(&self, f_p_norm: f32) -> GainValues;

    /// The guard μ_τ.
    fn guard(&self) -> &Guard;
}

/// Validated constant gains.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Gains {
    k1: f32,
    k2: f32,
    k3: f32,
    guard: Guard,
}

impl Gains {
    /// The gains with these parameters.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(p: GainParameters) -> Result<Self, ParameterError> {
        p.check()?;
        Ok(Self {
            k1: p.k1,
            k2: p.k2,
            k3: p.k3,
            guard: Guard::of_checked(p.tau),
        })
    }

    /// The guard μ_τ.
    pub fn guard(&self) -> &Guard {
        &self.guard
    }
}

impl GainLaw for Gains {
    #[inline(always)]
    fn at(&self, _: f32) -> GainValues {
        GainValues {
            k1: self.k1,
            k2: self.k2,
            k3: self.k3,
        }
    }

    #[inline(always)]
    fn guard(&self) -> &Guard {
        &self.guard
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_parameters_are_named() {
        let good = GainParameters::PAPER;
        let name = |p| Gains::new(p).unwrap_err().parameter;
        assert_eq!(name(GainParameters { k1: 0.0, ..good }), "k1");
        assert_eq!(
            name(GainParameters {
                k2: f32::NAN,
                ..good
            }),
            "k2"
        );
        assert_eq!(name(GainParameters { k3: -6.0, ..good }), "k3");
        assert_eq!(name(GainParameters { tau: 1e9, ..good }), "tau");
    }

    #[test]
    fn constant_gains_are_constant() {
        let gains = Gains::new(GainParameters::PAPER).unwrap();
        for norm in [0.0, 1.0, 1e5] {
            let GainValues { k1, k2, k3 } = gains.at(norm);
            assert_eq!((k1, k2, k3), (0.1529, 0.0234, 6.0));
        }
    }
}
