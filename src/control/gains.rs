//! Gains of the velocity laws: constant, as in the paper.

use super::bandwidth::BandwidthGains;
use super::guard::Guard;
use crate::error::{ParameterError, positive};

/// Constant gains, as in the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GainParameters {
    /// k1 [s/m]: thrust per velocity error along the thrust line, relative to |F_p|.
    pub k1: f32,
    /// k2 [rad/(N·m)]: angular rate per velocity error across the thrust line and per |F_p|.
    pub k2: f32,
    /// k3 [rad/s]: angular rate per misalignment of thrust and F_p.
    pub k3: f32,
    /// τ \[N\]: force below which the guard μ_τ acts.
    pub tau: f32,
}

impl GainParameters {
    /// The gains of the paper's simulation (§VII).
    pub const PAPER: Self = Self {
        k1: 0.1529,
        k2: 0.0234,
        k3: 6.0,
        tau: 80.0,
    };
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
    /// `k1`, `k2` or `k3` not finite, not positive, or outside [1e-9, 1e6]; `tau` as in [`Guard::new`].
    pub fn new(p: GainParameters) -> Result<Self, ParameterError> {
        Ok(Self {
            k1: positive("k1", p.k1, 1e-9, 1e6)?,
            k2: positive("k2", p.k2, 1e-9, 1e6)?,
            k3: positive("k3", p.k3, 1e-9, 1e6)?,
            guard: Guard::new(p.tau)?,
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

/// Gains chosen at run time, where the choice is data: a scenario file, a parameter block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GainChoice {
    /// Constant, as in the paper.
    Constant(Gains),
    /// By bandwidth.
    Bandwidth(BandwidthGains),
}

impl GainLaw for GainChoice {
    #[inline(always)]
    fn at(&self, f_p_norm: f32) -> GainValues {
        match self {
            Self::Constant(g) => g.at(f_p_norm),
            Self::Bandwidth(g) => g.at(f_p_norm),
        }
    }

    #[inline(always)]
    fn guard(&self) -> &Guard {
        match self {
            Self::Constant(g) => GainLaw::guard(g),
            Self::Bandwidth(g) => g.guard(),
        }
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
