//! Drag where the propeller idles, by the work that it does: what the specific force takes along the path through the air.
//!
//! f · v/V = −k_a/m V² (c_D0 + K c_L²)
//!
//! The attitude is in it only as far as it goes with the change of the velocity. No thrust is in it, so neither are its scale nor how it falls with speed.
//! A propeller that idles drags: that is in c_D.

use nalgebra::{DMatrix, DVector};

use super::regression::{Fit, least_squares};

/// One instant of a glide, on the wing, short of stall.
#[derive(Clone, Copy)]
pub struct Glide {
    /// Block of time whose residuals hang together.
    pub block: usize,
    /// Pressure over the load of the wing, k_a/m V² [m/s²].
    pub pressure: f64,
    /// Specific force along the path through the air [m/s²].
    pub along: f64,
    /// c_L in the mean of seconds, that gusts are not in it.
    pub c_l: f64,
}

/// c_D0 and K of what was flown.
pub fn drag(flown: &[Glide]) -> Option<Fit> {
    let x = DMatrix::from_fn(flown.len(), 2, |i, j| {
        let Glide { pressure, c_l, .. } = flown[i];
        -pressure * [1.0, c_l * c_l][j]
    });
    let y = DVector::from_fn(flown.len(), |i, _| flown[i].along);
    let blocks: Vec<usize> = flown.iter().map(|glide| glide.block).collect();
    least_squares(&x, &x, &y, &blocks)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A glide with a known polar, the load along its path in ripples that are not of it: the polar is found.
    #[test]
    fn a_glide_shows_its_polar() {
        let (zero, induced) = (0.03, 0.08);
        let flown = (0..200).map(|n| {
            let t = 0.04 * f64::from(n);
            let (pressure, c_l) = (20.0 + t, 0.45 - 0.03 * t);
            Glide {
                block: (t / 2.0) as usize,
                pressure,
                along: -pressure * (zero + induced * c_l * c_l) + 0.02 * (9.0 * t).sin(),
                c_l,
            }
        });
        let flown: Vec<Glide> = flown.collect();
        let fit = drag(&flown).unwrap();
        let c_d = fit.function(|e| e[0] + e[1] * 0.3 * 0.3);
        let truth = zero + induced * 0.09;
        assert!((c_d.value / truth - 1.0).abs() < 0.02, "{c_d:?}");
        assert!(c_d.within < 0.1 * truth, "{c_d:?}");
    }
}
