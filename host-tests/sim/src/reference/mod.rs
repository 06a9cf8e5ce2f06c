//! Aerodynamics and control laws in double precision, written from the printed equations.
//!
//! Nothing here comes from the core: the models are the printed formulas with σ by `tanh`, their
//! derivatives come from automatic differentiation, α from a subtraction of angles, forces from
//! matrices in inertial coordinates. It is the yardstick of the core's accuracy; it is slow, and singular where
//! the paper's formulas are. [`ForceModel`] evaluates the same formulas by their values alone: the plant's physics.

mod coefficients;
mod force_model;
mod law;
mod table;
mod vehicle;

pub use coefficients::*;
pub use force_model::ForceModel;
pub use law::{Evaluation, Gains, Inputs, full, guarded, mu, robust};
pub use table::{Row, Table};
pub use vehicle::{Air, Vehicle};

/// A plane vector in double precision.
pub type Vector = nalgebra::Vector2<f64>;
/// A plane matrix in double precision.
pub type Matrix = nalgebra::Matrix2<f64>;

/// `S = R(π/2)`.
pub const S: Matrix = Matrix::new(0.0, -1.0, 1.0, 0.0);

/// `R(θ)`: its columns are the body axes (i, j) in inertial coordinates (down, forward).
pub fn rotation(theta: f64) -> Matrix {
    let (sin, cos) = libm::sincos(theta);
    Matrix::new(cos, -sin, sin, cos)
}

/// `angle` \[rad\] brought to [−π, π).
pub fn wrap(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    let wrapped = (angle + PI).rem_euclid(TAU) - PI;
    // `rem_euclid` may round up to the divisor itself.
    if wrapped < PI { wrapped } else { -PI }
}
