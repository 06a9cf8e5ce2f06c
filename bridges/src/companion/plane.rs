//! The vertical plane that a planar controller flies in, in the autopilot's axes.

use alula::ned::Ned;
use alula::planar::{Attitude, Inertial};
use alula::spatial::Orientation;

/// Length of the nose's part in the plane below which an attitude has no pitch.
const LEAST: f32 = 1e-3;

/// An attitude projected on a vertical plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Attitude θ of the nose's projection.
    pub attitude: Attitude,
    /// The plane's normal, to the right, by its components in hover's body axes.
    pub normal: [f32; 3],
}

/// The vertical plane through a heading. Its normal points to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerticalPlane {
    cos: f32,
    sin: f32,
}

impl VerticalPlane {
    /// The plane through `heading` \[rad\], from north towards east.
    #[must_use]
    pub fn from_heading(heading: f32) -> Self {
        let (sin, cos) = heading.sin_cos();
        Self { cos, sin }
    }

    /// Components of `v` in the plane, and the one across it, positive to the right.
    #[must_use]
    pub fn project(&self, v: Ned) -> (Inertial, f32) {
        (
            Inertial::new(v.down, v.north * self.cos + v.east * self.sin),
            v.east * self.cos - v.north * self.sin,
        )
    }

    /// Projects an attitude; none if the nose points across the plane.
    #[must_use]
    pub fn attitude(&self, o: &Orientation) -> Option<Projection> {
        let tail = self.project(o.i()).0;
        let length = tail.norm();
        let right = |axis: Ned| self.project(axis).1;
        (length >= LEAST).then(|| Projection {
            attitude: Attitude {
                cos: tail.down() / length,
                sin: tail.forward() / length,
            },
            normal: [right(o.j()), right(o.w()), right(o.i())],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula::ned::{BodyAxes, Quaternion};

    /// Pitched by −0.4 about the wing of a vehicle that heads east.
    #[test]
    fn a_pitch_in_the_plane_is_theta() {
        let half = std::f32::consts::FRAC_PI_4;
        let (s, c) = (-0.2f32).sin_cos();
        let q = Quaternion {
            w: half.cos() * c,
            x: -half.sin() * s,
            y: half.cos() * s,
            z: half.sin() * c,
        };
        let plane = VerticalPlane::from_heading(2.0 * half);
        let orientation = Orientation::from_quaternion(&q, BodyAxes::NoseUp).unwrap();
        let got = plane.attitude(&orientation).unwrap();
        assert!((got.attitude.angle() + 0.4).abs() < 1e-6);
        assert!((got.normal[1] - 1.0).abs() < 1e-6);
        let (in_plane, across) = plane.project(Ned::new(-2.0, 7.0, 3.0));
        assert!((in_plane - Inertial::new(3.0, 7.0)).norm() < 1e-5 && (across - 2.0).abs() < 1e-5);
    }
}
