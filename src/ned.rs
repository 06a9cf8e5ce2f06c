//! The axes that autopilots use, beside the paper's: north-east-down world, forward-right-down body, attitude quaternions.
//!
//! The laws work in a vertical plane. A [`VerticalPlane`] contains the vertical and a heading. It projects a
//! three-dimensional state, and returns what the projection loses: the components across the plane, and the attitude's
//! tilt and bank. An attitude is written `heading · pitch · tilt · bank`: rotations about down, the plane's normal (to
//! the right), the belly and the nose, in this order. Pitch covers the whole turn, so that nose up and nose down are not
//! singular. Singular is only an attitude whose nose points across the plane: it has no pitch.
//!
//! Not in the paper.

use crate::frame::{Attitude, Inertial};
use crate::math;

/// Sine of the angle between nose and plane's normal below which an attitude has no pitch.
const MIN_IN_PLANE: f32 = 1e-3;
/// A quaternion whose |q|² is further from 1 than this is refused.
const MAX_QUATERNION_DEFECT: f32 = 1e-3;

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

impl BodyAxes {
    /// The attitude whose x axis of these body axes is at `pitch` \[rad\] above the horizon, in the plane. A non-finite
    /// pitch gives NaN, which a control step reports.
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
    /// The plane's normal, to the right, by its forward-right-down body components. θ̇ times it is the body rate that
    /// turns the aircraft in the plane; without tilt and bank it is (0, 1, 0).
    pub normal: [f32; 3],
}

impl Projection {
    /// A projection without tilt and bank.
    pub const fn upright(attitude: Attitude) -> Self {
        Self {
            attitude,
            normal: [0.0, 1.0, 0.0],
        }
    }

    /// Tilt and bank \[rad\] of an attitude that was given in these body axes.
    ///
    /// Tilt is the angle of the nose out of the plane, in (−π/2, π/2), positive to the right. Bank is the angle about the
    /// nose, in (−π, π], positive right wing towards the belly side of the plane.
    pub fn tilt_and_bank(&self, axes: BodyAxes) -> (f32, f32) {
        let [x, right, z] = self.normal;
        // Along nose, wing and belly the normal is (sin tilt, cos tilt cos bank, −cos tilt sin bank).
        let (nose, belly) = match axes {
            BodyAxes::NoseForward => (x, z),
            BodyAxes::NoseUp => (-z, x),
        };
        let in_plane = math::sqrt(right * right + belly * belly);
        (math::atan2(nose, in_plane), math::atan2(-belly, right))
    }
}

/// The vertical plane through a heading. Its normal points to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct VerticalPlane {
    cos: f32,
    sin: f32,
    cos_half: f32,
    sin_half: f32,
}

impl VerticalPlane {
    /// The plane through `heading` \[rad\], counted from north towards east. A heading that is not finite, or beyond 16384 rad,
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
    /// `None` if `q` is not of unit length (|q|² further than 1e-3 from 1, or NaN), or if the nose points across the plane
    /// to 1e-3 rad.
    // Inlined: passed through memory, quaternion and result cost as much as the half of it.
    #[inline(always)]
    pub fn attitude(&self, q: &Quaternion, axes: BodyAxes) -> Option<Projection> {
        let Quaternion { w, x, y, z } = *q;
        let square = w * w + x * x + y * y + z * z;
        if !matches!((square - 1.0).abs(), d if d <= MAX_QUATERNION_DEFECT) {
            return None;
        }
        // The same attitude from the plane's own axes: the heading is turned back.
        let (c, s) = (self.cos_half, self.sin_half);
        let (w, x, y, z) = (w * c + z * s, x * c + y * s, y * c - x * s, z * c - w * s);
        // Components of the nose forward and down, |q|² long.
        let (forward, down) = match axes {
            BodyAxes::NoseForward => ((w * w + x * x) - (y * y + z * z), 2.0 * (x * z - w * y)),
            BodyAxes::NoseUp => (-2.0 * (x * z + w * y), (x * x + y * y) - (w * w + z * z)),
        };
        let in_plane = math::sqrt(forward * forward + down * down);
        // A heading that is not finite has made everything NaN, and is refused here too.
        if !matches!(in_plane, n if n >= MIN_IN_PLANE) {
            return None;
        }
        let (inverse, unit) = (1.0 / in_plane, 1.0 / square);
        Some(Projection {
            // The nose is −i = −(cos θ, sin θ).
            attitude: Attitude {
                cos: -down * inverse,
                sin: -forward * inverse,
            },
            normal: [
                2.0 * (x * y + w * z) * unit,
                ((w * w + y * y) - (x * x + z * z)) * unit,
                2.0 * (y * z - w * x) * unit,
            ],
        })
    }

    /// The set-point that leads `attitude` by `lead` \[rad\], |`lead`| ≤ π/2, without tilt and bank: its quaternion, and
    /// its pitch \[rad\], in [−π, π], both of the body axes `axes`.
    #[inline]
    pub fn set_point(&self, attitude: Attitude, axes: BodyAxes, lead: f32) -> (Quaternion, f32) {
        let (cos, sin) = match axes {
            // The pitch of these axes is θ + 90°.
            BodyAxes::NoseForward => (-attitude.sin, attitude.cos),
            BodyAxes::NoseUp => (attitude.cos, attitude.sin),
        };
        // Half of the present pitch, by the larger of its cosine and sine: the other one follows without cancellation.
        let larger = math::sqrt(0.5 + 0.5 * cos.abs());
        let smaller = sin * (0.5 / larger);
        let (c, s) = if cos >= 0.0 {
            (larger, smaller)
        } else {
            (smaller.abs(), larger.copysign(sin))
        };
        let (sin_lead, cos_lead) = math::sin_cos_near_zero(0.5 * lead);
        let (c, s) = (c * cos_lead - s * sin_lead, s * cos_lead + c * sin_lead);
        // Of the two signs of a quaternion the one whose pitch is within a half turn.
        let (c, s) = if c < 0.0 { (-c, -s) } else { (c, s) };
        (self.turned(c, s), 2.0 * math::angle(s, c))
    }

    /// The attitude at `pitch` \[rad\] in the plane, without tilt and bank. It is of the same body axes as the pitch.
    pub const fn quaternion(&self, pitch: f32) -> Quaternion {
        let (sin, cos) = math::sin_cos(0.5 * pitch);
        self.turned(cos, sin)
    }

    /// The heading, and then a pitch of which these are cosine and sine of the half.
    #[inline(always)]
    const fn turned(&self, cos_half: f32, sin_half: f32) -> Quaternion {
        Quaternion {
            w: self.cos_half * cos_half,
            x: -(self.sin_half * sin_half),
            y: self.cos_half * sin_half,
            z: self.sin_half * cos_half,
        }
    }

    /// Cosine and sine of the angle from this plane to `other`, positive to the right.
    pub const fn angle_to(&self, other: &Self) -> (f32, f32) {
        (
            self.cos * other.cos + self.sin * other.sin,
            self.cos * other.sin - self.sin * other.cos,
        )
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
        let (tilt, bank) = banked.tilt_and_bank(BodyAxes::NoseForward);
        assert!((bank - math::FRAC_PI_2).abs() < 1e-6 && tilt == 0.0);
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
    fn pitch_tilt_and_bank_of_random_attitudes_are_found() {
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
                let found = p.tilt_and_bank(axes);
                note(turns_apart(found.0, tilt));
                note(turns_apart(found.1, bank) * scale);
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
    fn projection_and_its_inverse_agree() {
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
                let (tilt, bank) = p.tilt_and_bank(axes);
                assert!(tilt.abs() < 1.5e-6 && bank.abs() < 1.5e-6);
                let a = axes.attitude(pitch);
                assert!((a.cos - p.attitude.cos).abs() < 1.5e-6);
                assert!((a.sin - p.attitude.sin).abs() < 1.5e-6);
            }
        }
    }

    /// The set-point against the quaternion of the same pitch by sine and cosine, over every attitude and lead.
    #[test]
    fn set_points_lead_the_attitude() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(8);
        let mut worst = 0f64;
        for n in 0..100_000 {
            let plane = VerticalPlane::from_heading(rng.random_range(-3.2..3.2));
            let axes = [BodyAxes::NoseForward, BodyAxes::NoseUp][n % 2];
            // Every fourth is upright to 1e-6, or upside down, where half of the pitch is hard to see in its cosine.
            let pitch = if n % 4 < 2 {
                [0.0, math::PI][n / 4 % 2] + rng.random_range(-1e-6..1e-6)
            } else {
                rng.random_range(-math::PI..math::PI)
            };
            let lead = rng.random_range(-math::FRAC_PI_2..math::FRAC_PI_2);
            let (q, angle) = plane.set_point(axes.attitude(pitch), axes, lead);
            let wanted = plane.quaternion(pitch + lead);
            let dot = q.w * wanted.w + q.x * wanted.x + q.y * wanted.y + q.z * wanted.z;
            let sign = dot.signum();
            for (a, b) in [
                (q.w, wanted.w),
                (q.x, wanted.x),
                (q.y, wanted.y),
                (q.z, wanted.z),
            ] {
                worst = worst.max(f64::from(a - sign * b).abs());
            }
            assert!(angle.abs() <= math::PI);
            worst = worst.max(0.5 * turns_apart(angle, f64::from(pitch) + f64::from(lead)));
        }
        // Roundings of the attitude's sine and cosine, of its half and of the sum: measured 4e-7.
        assert!(worst < 6e-7, "{worst:e}");
    }

    #[test]
    fn quaternions_not_of_unit_length_are_refused() {
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
        let no_heading = VerticalPlane::from_heading(f32::INFINITY);
        assert_eq!(
            no_heading.attitude(&no_heading.quaternion(0.0), BodyAxes::NoseUp),
            None
        );
        assert_eq!(
            no_heading.attitude(&plane.quaternion(0.0), BodyAxes::NoseUp),
            None
        );
    }
}
