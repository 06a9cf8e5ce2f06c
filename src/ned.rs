//! The axes of the field, beside the paper's: north-east-down world, forward-right-down body, attitude quaternions.
//!
//! The laws live in a vertical plane. [`VerticalPlane`] cuts it through a heading, projects a three-dimensional state
//! on it, and gives back what the projection loses: the components across the plane, and the attitude's tilt and bank.
//! Every attitude is `heading · pitch · tilt · bank`, rotations about down, the plane's normal (to the right), the
//! belly and the nose in this order; pitch covers the whole turn, so nose up and nose down are attitudes like any
//! other. The only one without a pitch has its nose across the plane.
//!
//! Not in the paper.

use crate::frame::{Attitude, Inertial};
use crate::math;

/// Sine of the angle between nose and plane's normal below which an attitude has no pitch.
const MIN_IN_PLANE: f32 = 1e-3;
/// Quaternions whose |q|² is further from 1 than this are refused: they are no attitude.
const MAX_QUATERNION_DEFECT: f32 = 1e-3;

/// A vector by its components along north, east and down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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

/// How a tail-sitter's body axes are fixed to it. Both have y along the right wing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BodyAxes {
    /// Fixed-wing axes: x along the nose, z to the belly. Level cruise is pitch 0, hover is pitch 90°.
    #[default]
    NoseForward,
    /// Multicopter axes: z along the tail, x to the belly. Hover is pitch 0, level cruise is pitch −90°.
    NoseUp,
}

impl BodyAxes {
    /// The attitude with these axes at `pitch` \[rad\] above the horizon, in the plane. A non-finite pitch gives NaN,
    /// which a control step reports.
    pub const fn attitude(self, pitch: f32) -> Attitude {
        let (sin, cos) = math::sin_cos(pitch);
        match self {
            // θ = pitch − 90°.
            Self::NoseForward => Attitude {
                cos: sin,
                sin: -cos,
            },
            Self::NoseUp => Attitude { cos, sin },
        }
    }

    /// Pitch of these axes \[rad\], in (−π, π], at an attitude.
    pub const fn pitch(self, attitude: Attitude) -> f32 {
        match self {
            Self::NoseForward => math::atan2(attitude.cos, -attitude.sin),
            Self::NoseUp => attitude.angle(),
        }
    }
}

/// An attitude projected on a vertical plane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Projection {
    /// Attitude θ of the nose's projection.
    pub attitude: Attitude,
    /// Angle of the nose out of the plane \[rad\], in (−π/2, π/2), positive to the right.
    pub tilt: f32,
    /// Angle about the nose \[rad\], in (−π, π], positive right wing towards the belly side of the plane.
    pub bank: f32,
    /// The plane's normal, to the right, by its forward-right-down body components. θ̇ times it is the body rate that
    /// turns the aircraft in the plane; without tilt and bank it is (0, 1, 0).
    pub normal: [f32; 3],
}

/// The vertical plane through a heading, seen from its left: right is its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct VerticalPlane {
    cos: f32,
    sin: f32,
    cos_half: f32,
    sin_half: f32,
}

impl VerticalPlane {
    /// The plane through `heading` \[rad\], from north towards east. A heading that is not finite, or beyond 16384 rad,
    /// gives NaN, which a control step reports.
    pub const fn from_heading(heading: f32) -> Self {
        let (sin_half, cos_half) = math::sin_cos(0.5 * heading);
        Self {
            cos: cos_half * cos_half - sin_half * sin_half,
            sin: 2.0 * (sin_half * cos_half),
            cos_half,
            sin_half,
        }
    }

    /// Components of `v` in the plane, and the one across it, positive to the right.
    #[inline]
    pub fn project(&self, v: Ned) -> (Inertial, f32) {
        (
            Inertial::new(v.down, v.north * self.cos + v.east * self.sin),
            v.east * self.cos - v.north * self.sin,
        )
    }

    /// The vector with these components in the plane, and `lateral` across it.
    #[inline]
    pub fn lift(&self, v: Inertial, lateral: f32) -> Ned {
        Ned::new(
            v.forward() * self.cos - lateral * self.sin,
            v.forward() * self.sin + lateral * self.cos,
            v.down(),
        )
    }

    /// Projects the attitude `q` of body axes `axes`.
    ///
    /// `None` if `q` is no attitude (|q|² further than 1e-3 from 1, or not a number), or its nose is across the plane
    /// to 1e-3 rad.
    pub fn attitude(&self, q: &Quaternion, axes: BodyAxes) -> Option<Projection> {
        let Quaternion { w, x, y, z } = *q;
        let square = w * w + x * x + y * y + z * z;
        if !matches!((square - 1.0).abs(), d if d <= MAX_QUATERNION_DEFECT) {
            return None;
        }
        // The body axes by their components (forward, down), (right) of the plane, |q|² long.
        let axis_x = self.project(Ned::new(
            w * w + x * x - y * y - z * z,
            2.0 * (x * y + w * z),
            2.0 * (x * z - w * y),
        ));
        let axis_y = self.project(Ned::new(
            2.0 * (x * y - w * z),
            w * w - x * x + y * y - z * z,
            2.0 * (y * z + w * x),
        ));
        let axis_z = self.project(Ned::new(
            2.0 * (x * z + w * y),
            2.0 * (y * z - w * x),
            w * w - x * x - y * y + z * z,
        ));
        let ((nose, nose_right), belly) = match axes {
            BodyAxes::NoseForward => (axis_x, axis_z.0),
            BodyAxes::NoseUp => ((Inertial::ZERO - axis_z.0, -axis_z.1), axis_x.0),
        };
        let in_plane = math::sqrt(nose.norm_squared());
        // The plane of a heading that is none fails this too.
        if !matches!(in_plane, n if n >= MIN_IN_PLANE) {
            return None;
        }
        let inverse = 1.0 / in_plane;
        // Bank is seen against the belly direction of the unbanked aircraft, (down, forward) ∝ (n_f, −n_d).
        let along_belly = |v: Inertial| nose.forward() * v.down() - nose.down() * v.forward();
        let unit = 1.0 / square;
        Some(Projection {
            // The nose is −i = −(cos θ, sin θ).
            attitude: Attitude {
                cos: -nose.down() * inverse,
                sin: -nose.forward() * inverse,
            },
            tilt: math::atan2(nose_right, in_plane),
            bank: math::atan2(along_belly(axis_y.0), along_belly(belly)),
            normal: [axis_x.1 * unit, axis_y.1 * unit, axis_z.1 * unit],
        })
    }

    /// The attitude at `pitch` \[rad\] in the plane, without tilt and bank, of whichever axes the pitch is of.
    pub const fn quaternion(&self, pitch: f32) -> Quaternion {
        let (sin, cos) = math::sin_cos(0.5 * pitch);
        Quaternion {
            w: self.cos_half * cos,
            x: -(self.sin_half * sin),
            y: self.cos_half * sin,
            z: self.sin_half * cos,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use core::f64::consts::PI;
    use nalgebra::Matrix3;
    use rand::{RngExt, SeedableRng};

    /// Rotation by `a` about axis 0, 1 or 2, in f64.
    fn about(axis: usize, a: f64) -> Matrix3<f64> {
        let mut m = Matrix3::identity();
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        (m[(j, j)], m[(j, k)]) = (a.cos(), -a.sin());
        (m[(k, j)], m[(k, k)]) = (a.sin(), a.cos());
        m
    }

    /// The quaternion of a rotation matrix, by its largest component.
    fn quaternion(m: &Matrix3<f64>) -> Quaternion {
        let d = [m[(0, 0)], m[(1, 1)], m[(2, 2)]];
        let squares = [
            1.0 + d[0] + d[1] + d[2],
            1.0 + d[0] - d[1] - d[2],
            1.0 - d[0] + d[1] - d[2],
            1.0 - d[0] - d[1] + d[2],
        ];
        let largest = (0..4).fold(0, |b, n| if squares[n] > squares[b] { n } else { b });
        let r = squares[largest].sqrt();
        let (a, b, c) = (
            m[(2, 1)] - m[(1, 2)],
            m[(0, 2)] - m[(2, 0)],
            m[(1, 0)] - m[(0, 1)],
        );
        let (xy, xz, yz) = (
            m[(1, 0)] + m[(0, 1)],
            m[(2, 0)] + m[(0, 2)],
            m[(2, 1)] + m[(1, 2)],
        );
        let q = match largest {
            0 => [r * r, a, b, c],
            1 => [a, r * r, xy, xz],
            2 => [b, xy, r * r, yz],
            _ => [c, xz, yz, r * r],
        }
        .map(|v| (0.5 * v / r) as f32);
        let [w, x, y, z] = q;
        Quaternion { w, x, y, z }
    }

    fn turns_apart(a: f32, b: f64) -> f64 {
        let d = f64::from(a) - b;
        d.sin().atan2(d.cos()).abs()
    }

    #[test]
    fn known_attitudes() {
        let north = VerticalPlane::from_heading(0.0);
        let level = Quaternion {
            w: 1.0,
            x: 0.0,
            y: 0.0,
            z: 0.0,
        };
        // No rotation is level cruise in fixed-wing axes, θ = −90°, and hover in multicopter axes, θ = 0.
        let cruise = north.attitude(&level, BodyAxes::NoseForward).unwrap();
        assert_eq!((cruise.attitude.cos, cruise.attitude.sin), (0.0, -1.0));
        assert_eq!(cruise.normal, [0.0, 1.0, 0.0]);
        let hover = north.attitude(&level, BodyAxes::NoseUp).unwrap();
        assert_eq!(hover.attitude, Attitude::NOSE_UP);
        // A quarter turn about x is a right bank of 90°, and a quarter turn about z from north puts the nose across.
        let h = core::f32::consts::FRAC_1_SQRT_2;
        let roll = Quaternion {
            w: h,
            x: h,
            ..level
        };
        let banked = north.attitude(&roll, BodyAxes::NoseForward).unwrap();
        assert!((banked.bank - math::FRAC_PI_2).abs() < 1e-6 && banked.tilt == 0.0);
        let yaw = Quaternion {
            w: h,
            z: h,
            ..level
        };
        assert_eq!(north.attitude(&yaw, BodyAxes::NoseForward), None);
        let east = VerticalPlane::from_heading(math::FRAC_PI_2);
        assert!(east.attitude(&yaw, BodyAxes::NoseForward).is_some());
        // The right of north is east.
        assert_eq!(
            north.project(Ned::new(1.0, 2.0, 3.0)),
            (Inertial::new(3.0, 1.0), 2.0)
        );
    }

    #[test]
    fn every_attitude_is_taken_apart_into_what_it_was_built_of() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(6);
        let mut worst = 0f64;
        for n in 0..100_000 {
            let heading = rng.random_range(-PI..PI);
            // Every fourth within a hair of nose up or nose down, where Euler angles lock.
            let pitch = if n % 4 == 0 {
                0.5 * PI * if n % 8 == 0 { 1.0 } else { -1.0 } + rng.random_range(-1e-6..1e-6)
            } else {
                rng.random_range(-PI..PI)
            };
            let tilt = rng.random_range(-1.4..1.4);
            let bank = rng.random_range(-PI..PI);
            let forward = about(2, heading) * about(1, pitch) * about(2, tilt) * about(0, bank);
            let plane = VerticalPlane::from_heading(heading as f32);
            for axes in [BodyAxes::NoseForward, BodyAxes::NoseUp] {
                // Multicopter axes are fixed-wing axes turned by 90° about the wing.
                let (m, offset) = match axes {
                    BodyAxes::NoseForward => (forward, 0.0),
                    BodyAxes::NoseUp => (forward * about(1, -0.5 * PI), 0.5 * PI),
                };
                let p = plane.attitude(&quaternion(&m), axes).unwrap();
                // Near the tilt's end, at 80°, errors of pitch and bank are 1/cos(tilt) times those of the quaternion.
                let scale = tilt.cos();
                let mut note = |e: f64| worst = worst.max(e);
                note(turns_apart(axes.pitch(p.attitude), pitch - offset) * scale);
                note(turns_apart(p.tilt, tilt));
                note(turns_apart(p.bank, bank) * scale);
                let right = nalgebra::Vector3::new(-heading.sin(), heading.cos(), 0.0);
                let normal = m.transpose() * right;
                for k in 0..3 {
                    note((f64::from(p.normal[k]) - normal[k]).abs());
                }
            }
        }
        // Measured 4.4e-7: the quaternion's own rounding, doubled, and a few more.
        assert!(worst < 1e-6, "{worst:e}");
    }

    #[test]
    fn vectors_and_attitudes_return() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        for _ in 0..100_000 {
            let plane = VerticalPlane::from_heading(rng.random_range(-7.0..7.0));
            let v = Ned::new(
                rng.random_range(-50.0..50.0),
                rng.random_range(-50.0..50.0),
                rng.random_range(-50.0..50.0),
            );
            let (inside, across) = plane.project(v);
            let back = plane.lift(inside, across);
            // 3e-5: four roundings of 70 m/s.
            assert!((back.north - v.north).abs() < 3e-5 && (back.east - v.east).abs() < 3e-5);
            assert_eq!(back.down, v.down);
            let pitch = rng.random_range(-math::PI..math::PI);
            for axes in [BodyAxes::NoseForward, BodyAxes::NoseUp] {
                let p = plane.attitude(&plane.quaternion(pitch), axes).unwrap();
                // 1.5e-6: the quaternion's roundings, doubled.
                assert!(turns_apart(axes.pitch(p.attitude), f64::from(pitch)) < 1.5e-6);
                assert!(p.tilt.abs() < 1.5e-6 && p.bank.abs() < 1.5e-6);
                let a = axes.attitude(pitch);
                assert!((a.cos - p.attitude.cos).abs() < 1.5e-6);
                assert!((a.sin - p.attitude.sin).abs() < 1.5e-6);
            }
        }
    }

    #[test]
    fn what_is_no_attitude_is_refused() {
        let plane = VerticalPlane::from_heading(0.3);
        for bad in [f32::NAN, f32::INFINITY, 1.1, 3e38] {
            for n in 0..4 {
                let mut q = [0.5; 4];
                q[n] = bad;
                let [w, x, y, z] = q;
                let q = Quaternion { w, x, y, z };
                assert_eq!(plane.attitude(&q, BodyAxes::NoseUp), None);
            }
        }
        let none = Quaternion {
            w: 0.0,
            x: 0.0,
            y: 0.0,
            z: 0.0,
        };
        assert_eq!(plane.attitude(&none, BodyAxes::NoseForward), None);
        assert!(BodyAxes::NoseForward.attitude(f32::NAN).cos.is_nan());
        // So far from zero a heading has lost its meaning.
        let far = VerticalPlane::from_heading(1e19);
        assert_eq!(far.attitude(&plane.quaternion(0.0), BodyAxes::NoseUp), None);
        let nowhere = VerticalPlane::from_heading(f32::INFINITY);
        assert_eq!(
            nowhere.attitude(&nowhere.quaternion(0.0), BodyAxes::NoseUp),
            None
        );
        assert_eq!(
            nowhere.attitude(&plane.quaternion(0.0), BodyAxes::NoseUp),
            None
        );
    }
}
