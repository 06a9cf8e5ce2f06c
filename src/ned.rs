//! The axes that autopilots use: north-east-down world, forward-right-down body, attitude quaternions.
//!
//! [`Orientation`](crate::spatial::Orientation) makes the laws' axes of them, and back.
//!
//! Vectors and quaternions are converted from and to nalgebra's by `From`: components in the order of their names.
//!
//! Not in the paper.

use nalgebra::Vector3;

/// Conversions of a vector of three components from and to nalgebra's.
macro_rules! as_nalgebra {
    ($vector:ident { $x:ident, $y:ident, $z:ident }) => {
        impl From<Vector3<f32>> for $vector {
            fn from(v: Vector3<f32>) -> Self {
                Self::new(v.x, v.y, v.z)
            }
        }

        impl From<$vector> for Vector3<f32> {
            fn from(v: $vector) -> Self {
                Self::new(v.$x, v.$y, v.$z)
            }
        }
    };
}
as_nalgebra!(Ned { north, east, down });
as_nalgebra!(Frd {
    forward,
    right,
    down
});
as_nalgebra!(BodyRates { roll, pitch, yaw });

impl From<nalgebra::Quaternion<f32>> for Quaternion {
    fn from(q: nalgebra::Quaternion<f32>) -> Self {
        let [x, y, z, w] = q.coords.into();
        Self { w, x, y, z }
    }
}

impl From<Quaternion> for nalgebra::Quaternion<f32> {
    fn from(q: Quaternion) -> Self {
        Self::new(q.w, q.x, q.y, q.z)
    }
}

impl From<nalgebra::UnitQuaternion<f32>> for Quaternion {
    fn from(q: nalgebra::UnitQuaternion<f32>) -> Self {
        q.into_inner().into()
    }
}

/// A vector by its components along north, east and down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ned {
    /// Component along north.
    pub north: f32,
    /// Component along east.
    pub east: f32,
    /// Component along gravity.
    pub down: f32,
}

impl Ned {
    /// The vector with these components.
    pub const fn new(north: f32, east: f32, down: f32) -> Self {
        Self { north, east, down }
    }
}

/// A vector by its components along the body axes of a fixed wing: forward, right, down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Frd {
    /// Component along the nose, which is where thrust points.
    pub forward: f32,
    /// Component along the right wing.
    pub right: f32,
    /// Component towards the belly.
    pub down: f32,
}

impl Frd {
    /// The vector with these components.
    #[inline(always)]
    pub const fn new(forward: f32, right: f32, down: f32) -> Self {
        Self {
            forward,
            right,
            down,
        }
    }
}

/// Body rates [rad/s] about the forward, right and down axes, right-handed: p, q, r.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyRates {
    /// Rate p about the nose: positive right wing down in cruise.
    pub roll: f32,
    /// Rate q about the right wing: positive nose towards the back of the vehicle, up in cruise.
    pub pitch: f32,
    /// Rate r about the belly axis: positive nose right in cruise.
    pub yaw: f32,
}

impl BodyRates {
    /// The rates p, q and r.
    #[inline(always)]
    pub const fn new(roll: f32, pitch: f32, yaw: f32) -> Self {
        Self { roll, pitch, yaw }
    }
}

impl From<BodyRates> for Frd {
    #[inline(always)]
    fn from(r: BodyRates) -> Self {
        Self::new(r.roll, r.pitch, r.yaw)
    }
}

impl From<Frd> for BodyRates {
    #[inline(always)]
    fn from(v: Frd) -> Self {
        Self::new(v.forward, v.right, v.down)
    }
}

/// Attitude quaternion: turns forward-right-down body components into north-east-down components.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Quaternion {
    /// Scalar part.
    pub w: f32,
    /// Vector part along x.
    pub x: f32,
    /// Vector part along y.
    pub y: f32,
    /// Vector part along z.
    pub z: f32,
}

/// The two usual choices of a tail-sitter's body axes. Both have y along the right wing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BodyAxes {
    /// Fixed-wing axes: x along the nose, z to the belly. Level cruise is pitch 0, hover is pitch 90°.
    #[default]
    NoseForward,
    /// Multicopter axes: z along the tail, x to the belly. Hover is pitch 0, level cruise is pitch −90°.
    NoseUp,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nalgebra_has_the_same_components() {
        let v = Vector3::new(1.0, 2.0, 3.0);
        assert_eq!(Ned::from(v), Ned::new(1.0, 2.0, 3.0));
        assert_eq!(Frd::from(v), Frd::new(1.0, 2.0, 3.0));
        assert_eq!(BodyRates::from(v), BodyRates::new(1.0, 2.0, 3.0));
        assert_eq!(Vector3::from(Ned::from(v)), v);
        assert_eq!(Vector3::from(Frd::from(v)), v);
        assert_eq!(Vector3::from(BodyRates::from(v)), v);
        let q = nalgebra::Quaternion::new(1.0, 2.0, 3.0, 4.0);
        let ours = Quaternion::from(q);
        assert_eq!((ours.w, ours.x, ours.y, ours.z), (1.0, 2.0, 3.0, 4.0));
        assert_eq!(nalgebra::Quaternion::from(ours), q);
        let unit = nalgebra::Unit::new_unchecked(q);
        assert_eq!(Quaternion::from(unit).w, 1.0);
    }
}
