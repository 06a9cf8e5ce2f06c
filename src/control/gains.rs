//! Gains of the velocity laws.

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

/// Validated gains.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Gains {
    pub(super) k1: f32,
    pub(super) k2: f32,
    pub(super) k3: f32,
    pub(super) guard: Guard,
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
}
