//! Attitude in space: the body axes by their world components.

use super::vector::Body;
use crate::control::Fault;
use crate::frame::Attitude;
use crate::ned::{BodyAxes, Ned, Quaternion};

/// Quaternions whose |q|² is further from 1 than this are refused: they are no attitude.
const MAX_DEFECT: f32 = 1e-3;

/// The three body axes, unit vectors by their world components. A value that exists is a rotation: only a checked
/// quaternion makes one.
///
/// | body axes of an autopilot | x, y, z | rates (p, q, r) |
/// |---|---|---|
/// | nose up (multicopter) | j, w, i | (ω_j, ω_w, ω_i) |
/// | nose forward (fixed wing) | −i, w, j | (−ω_i, ω_w, ω_j) |
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[Ned; 3]", into = "[Ned; 3]"))]
pub struct Orientation {
    i: Ned,
    j: Ned,
    w: Ned,
}

impl From<Orientation> for [Ned; 3] {
    fn from(o: Orientation) -> Self {
        [o.i, o.j, o.w]
    }
}

impl TryFrom<[Ned; 3]> for Orientation {
    type Error = Fault;

    /// The attitude with the axes i, j, w.
    ///
    /// # Errors
    /// [`Fault::Attitude`] if they are not of unit length, normal to each other and right-handed, to 1e-3.
    fn try_from([i, j, w]: [Ned; 3]) -> Result<Self, Fault> {
        let o = Self { i, j, w };
        if o.is_sound() && (i.cross(j) - w).norm_squared() <= MAX_DEFECT {
            Ok(o)
        } else {
            Err(Fault::Attitude)
        }
    }
}

impl Orientation {
    /// Hover with the nose up and the belly to the north.
    pub const NOSE_UP: Self = Self {
        i: Ned::new(0.0, 0.0, 1.0),
        j: Ned::new(1.0, 0.0, 0.0),
        w: Ned::new(0.0, 1.0, 0.0),
    };

    /// The attitude θ in the vertical plane to the north, to be checked by [`is_sound`](Self::is_sound).
    #[inline(always)]
    pub(crate) const fn in_plane(attitude: Attitude) -> Self {
        let Attitude { cos, sin } = attitude;
        Self {
            i: Ned::new(sin, 0.0, cos),
            j: Ned::new(cos, 0.0, -sin),
            w: Ned::new(0.0, 1.0, 0.0),
        }
    }

    /// The attitude `q` of body axes `axes`. The axes are divided by |q|², so that what is left of a drifted
    /// normalisation is no part of them.
    ///
    /// # Errors
    /// [`Fault::Attitude`] if |q|² is further than 1e-3 from 1, or not a number.
    #[inline]
    pub fn from_quaternion(q: &Quaternion, axes: BodyAxes) -> Result<Self, Fault> {
        let Quaternion { w, x, y, z } = *q;
        let square = (w * w + x * x) + (y * y + z * z);
        if !matches!((square - 1.0).abs(), d if d <= MAX_DEFECT) {
            return Err(Fault::Attitude);
        }
        // 1/|q|² and 2/|q|²: the matrix of a quaternion of any length.
        let s = 1.0 / square;
        let (x2, y2, z2) = ((s + s) * x, (s + s) * y, (s + s) * z);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        let (xx, xy, xz) = (x * x2, x * y2, x * z2);
        let (yy, yz, zz) = (y * y2, y * z2, z * z2);
        let axis_x = Ned::new(1.0 - (yy + zz), xy + wz, xz - wy);
        let axis_y = Ned::new(xy - wz, 1.0 - (xx + zz), yz + wx);
        let axis_z = Ned::new(xz + wy, yz - wx, 1.0 - (xx + yy));
        Ok(match axes {
            BodyAxes::NoseUp => Self {
                i: axis_z,
                j: axis_x,
                w: axis_y,
            },
            BodyAxes::NoseForward => Self {
                i: Ned::ZERO - axis_x,
                j: axis_z,
                w: axis_y,
            },
        })
    }

    /// Whether i and j are of unit length. NaN is not.
    #[inline(always)]
    pub(crate) fn is_sound(&self) -> bool {
        (self.i.norm_squared() - 1.0).abs() + (self.j.norm_squared() - 1.0).abs() <= MAX_DEFECT
    }

    /// i: towards the tail, opposite to thrust.
    #[inline]
    pub fn i(&self) -> Ned {
        self.i
    }

    /// j: towards the belly.
    #[inline]
    pub fn j(&self) -> Ned {
        self.j
    }

    /// w: the right wing.
    #[inline]
    pub fn w(&self) -> Ned {
        self.w
    }

    /// The body components of a world vector.
    #[inline(always)]
    pub fn to_body(&self, v: Ned) -> Body {
        Body::new(self.i.dot(v), self.j.dot(v), self.w.dot(v))
    }

    /// The world components of a body vector.
    #[inline(always)]
    pub fn to_world(&self, v: Body) -> Ned {
        self.i * v.i + self.j * v.j + self.w * v.w
    }
}

impl Default for Orientation {
    fn default() -> Self {
        Self::NOSE_UP
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::ned::VerticalPlane;

    #[test]
    fn known_attitudes() {
        let level = Quaternion {
            w: 1.0,
            x: 0.0,
            y: 0.0,
            z: 0.0,
        };
        // No rotation is hover in multicopter axes, and level cruise to the north in fixed-wing axes.
        let hover = Orientation::from_quaternion(&level, BodyAxes::NoseUp).unwrap();
        assert_eq!(hover, Orientation::NOSE_UP);
        let cruise = Orientation::from_quaternion(&level, BodyAxes::NoseForward).unwrap();
        assert_eq!(cruise.i().north, -1.0);
        assert_eq!(cruise.j(), Ned::new(0.0, 0.0, 1.0));
        assert_eq!(cruise.w(), Ned::new(0.0, 1.0, 0.0));
    }

    /// In a vertical plane the axes are those of the planar attitude, seen through the plane's own projection.
    #[test]
    fn agrees_with_the_planar_attitude() {
        for n in 0..400 {
            let (heading, pitch) = (n as f32 * 0.37, n as f32 * 0.11 - 3.0);
            let plane = VerticalPlane::from_heading(heading);
            for axes in [BodyAxes::NoseUp, BodyAxes::NoseForward] {
                let planar = axes.attitude(pitch);
                let o = Orientation::from_quaternion(&plane.quaternion(pitch), axes).unwrap();
                let (i, across_i) = plane.project(o.i());
                let (j, across_j) = plane.project(o.j());
                let (w, across_w) = plane.project(o.w());
                // 2e-6: the quaternion's roundings, doubled, and those of a heading up to 150 rad, halved.
                let errors = [
                    i.down() - planar.cos,
                    i.forward() - planar.sin,
                    j.down() + planar.sin,
                    j.forward() - planar.cos,
                    across_i,
                    across_j,
                    w.down(),
                    w.forward(),
                    across_w - 1.0,
                ];
                for e in errors {
                    assert!(e.abs() < 2e-6, "{heading} {pitch} {axes:?} {errors:?}");
                }
            }
        }
    }

    /// The axes stay orthonormal for every quaternion that is accepted, however far from a unit.
    #[test]
    fn the_axes_are_a_right_handed_orthonormal_set() {
        let mut accepted = 0;
        for n in 0..20_000 {
            let a = n as f32;
            let raw = [(a * 0.7).sin(), (a * 1.3).cos(), (a * 2.1).sin(), a.cos()];
            let norm = raw.iter().map(|x| x * x).sum::<f32>().sqrt();
            let stretch = (1.0 + 4.9e-4 * (a * 0.01).sin()) / norm;
            let [w, x, y, z] = raw.map(|x| x * stretch);
            let q = Quaternion { w, x, y, z };
            let Ok(o) = Orientation::from_quaternion(&q, BodyAxes::NoseUp) else {
                continue;
            };
            accepted += 1;
            let (i, j) = (o.i(), o.j());
            let cross = i.cross(j);
            // 1e-6: some ten roundings of numbers below 1.
            assert!((cross - o.w()).norm_squared() < 1e-12);
            assert!((i.norm_squared() - 1.0).abs() < 1e-6 && i.dot(j).abs() < 1e-6);
            let v = Ned::new(3.0, -4.0, 12.0);
            assert!((o.to_world(o.to_body(v)) - v).norm_squared() < 1e-9);
        }
        assert!(accepted > 19_000);
    }

    #[test]
    fn what_is_no_attitude_is_refused() {
        for bad in [f32::NAN, f32::INFINITY, 1.1, 0.0, 3e38] {
            let q = Quaternion {
                w: bad,
                x: 0.0,
                y: 0.0,
                z: 0.0,
            };
            let refused = Orientation::from_quaternion(&q, BodyAxes::NoseForward);
            assert_eq!(refused, Err(Fault::Attitude));
        }
    }
}
