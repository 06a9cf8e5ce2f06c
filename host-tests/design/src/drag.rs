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
