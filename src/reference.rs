//! What is asked of the vehicle: a velocity and its derivative, within bounds.

use crate::frame::Inertial;

/// Velocities longer than this [m/s] are refused as absurd.
pub const MAX_SPEED: f32 = 1e3;
/// Accelerations longer than this [m/s²], and jerks [m/s³], are refused as absurd.
pub const MAX_ACCELERATION: f32 = 1e3;

/// Reference velocity and its derivative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reference {
    /// Reference velocity v_r over ground [m/s].
    pub velocity: Inertial,
    /// Reference acceleration a_r [m/s²].
    pub acceleration: Inertial,
}
