//! Control in space: one law from hover to cruise, in any direction.
//!
//! World vectors are north-east-down ([`Ned`]). What goes in and comes out is forward-right-down ([`Frd`](crate::Frd),
//! [`BodyRates`](crate::BodyRates)); inside, body vectors are along the paper's axes: i the tail, j the belly, w the
//! right wing. [`WingedControl`] flies a vehicle with a wing: the planar law in the plane of symmetry, and two scalars,
//! tilt and twist. They keep this plane where lateral forces balance and there is no sideslip. [`axisymmetric`] flies a
//! body of revolution. [`Sideslip`] and [`ForceError`] learn from the accelerometer what wind and model leave out. The
//! paper names three dimensions as its next step; the laws here are not in it, and where an identity of the planar
//! theory carries over it is said so.

mod aerodynamic_force;
pub mod axisymmetric;
mod command;
mod force_error;
mod heading;
mod lateral;
mod orientation;
mod sideslip;
mod vector;
mod winged;

/// Time steps \[s\] above this are taken for none by the estimators.
const MAX_STEP: f32 = 0.2;

pub use crate::ned::Ned;
pub(crate) use command::check_velocity;
pub use command::{Command, Correction, Diagnostics, FeedForward, Reference, State};
pub use force_error::{ForceError, ForceErrorParameters, ForceErrorState, ForceSample};
pub use heading::Heading;
pub(crate) use lateral::SLIP;
pub use lateral::{LateralGains, LateralParameters};
pub use orientation::Orientation;
pub use sideslip::{Sideslip, SideslipParameters, SideslipState};
pub(crate) use vector::Body;
pub use winged::WingedControl;
