//! What tests alone need of the yardstick: the laws in space, and how far rounding may take a result.

mod axisymmetric;
mod magnitude;
mod number;
mod spatial;

pub use axisymmetric::{axisymmetric_full, axisymmetric_robust};
pub use magnitude::{Angle, magnitudes};
pub use number::{Number, Triple};
pub use spatial::{
    LateralGains, SpatialEvaluation, SpatialInputs, axes, winged_full, winged_robust,
};
