//! The guard μ_τ (`eq:mu2D`), which keeps the robust law defined where the paper's divides by zero.

use crate::error::{ParameterError, in_range};

/// `μ_τ(s) = sin(π s²/(2τ²))` for s ≤ τ, else 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Guard {
    tau: f32,
    /// 1/τ².
    inverse_square: f32,
}

impl Guard {
    /// The guard that acts on forces below `tau` \[N\].
    ///
    /// # Errors
    /// `tau` not finite, not positive, or outside [1e-3, 1e6].
    pub fn new(tau: f32) -> Result<Self, ParameterError> {
        Ok(Self::of_checked(in_range("tau", tau, [1e-3, 1e6], "N")?))
    }

    /// The guard of a `tau` that [`new`](Self::new) would take.
    pub(crate) fn of_checked(tau: f32) -> Self {
        Self {
            tau,
            inverse_square: 1.0 / (tau * tau),
        }
    }

    /// τ \[N\].
    pub fn tau(&self) -> f32 {
        self.tau
    }

    /// μ_τ(s)/s² \[1/N²\], given s² ≥ 0 \[N²\]: 1/s² beyond τ, π/(2τ²) at s = 0. Relative error below 3e-7.
    #[inline(always)]
    pub fn over_square(&self, s_squared: f32) -> f32 {
        let x = s_squared * self.inverse_square;
        if x >= 1.0 {
            return 1.0 / s_squared;
        }
        // sin(πx/2)/x on [0, 1] as a polynomial of x², minimax to 5e-9.
        let z = x * x;
        let p = 0.000_151_485_13;
        let p = -0.004_673_766_4 + z * p;
        let p = 0.079_689_68 + z * p;
        let p = -0.645_963_7 + z * p;
        let p = core::f32::consts::FRAC_PI_2 + z * p;
        self.inverse_square * p
    }

    /// μ_τ(s) for s ≥ 0 \[N\], in [0, 1]; absolute error below 3e-7.
    pub fn mu(&self, s: f32) -> f32 {
        self.over_square(s * s) * (s * s)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn matches_the_printed_equation_and_its_limit() {
        let guard = Guard::new(80.0).unwrap();
        for n in 1..200_000 {
            let s = n as f32 * 1e-3;
            let x = f64::from(s);
            let mu = if x <= 80.0 {
                (core::f64::consts::FRAC_PI_2 * x * x / 6400.0).sin()
            } else {
                1.0
            };
            assert!((f64::from(guard.mu(s)) - mu).abs() < 3e-7);
            let over = f64::from(guard.over_square(s * s));
            assert!((over * x * x / mu - 1.0).abs() < 3e-7, "{s}");
        }
        assert_eq!(
            guard.over_square(0.0),
            core::f32::consts::FRAC_PI_2 / 6400.0
        );
        assert_eq!(guard.mu(0.0), 0.0);
        assert!(Guard::new(0.0).is_err());
    }
}
