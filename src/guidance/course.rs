//! The vertical plane in which the reference model flies, and the axes of that plane when it is banked.

use super::memory::memory;
use super::reference_model::limited;
use crate::frame::Inertial;
use crate::math;
use crate::ned::Ned;
use crate::spatial::Orientation;

/// The course: a horizontal unit vector. With the vertical it spans the plane of flight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Course {
    north: f32,
    east: f32,
}

memory!(Course {
    north: f32,
    east: f32
});

/// Length of the wing's horizontal part below which it says nothing of the course.
const MIN_LENGTH: f32 = 1e-2;

/// π/4, below.
const QUARTER: f32 = 0.785;

impl Course {
    /// The course of a vehicle in this attitude: across its right wing. Where the wing is vertical, along its belly.
    pub fn of(orientation: &Orientation) -> Self {
        let (w, j) = (orientation.w(), orientation.j());
        let across = Self::unit(w.east, -w.north);
        let along = Self::unit(j.north, j.east);
        across.or(along).unwrap_or(Self {
            north: 1.0,
            east: 0.0,
        })
    }

    fn unit(north: f32, east: f32) -> Option<Self> {
        let length = math::sqrt(north * north + east * east);
        (length > MIN_LENGTH).then(|| Self {
            north: north / length,
            east: east / length,
        })
    }

    /// Whether it is of unit length. NaN is not.
    #[inline(always)]
    pub fn is_sound(&self) -> bool {
        (self.north * self.north + self.east * self.east - 1.0).abs() <= 1e-3
    }

    /// Components of `v` in the plane, and the one across it, positive to the right.
    #[inline(always)]
    pub fn project(&self, v: Ned) -> (Inertial, f32) {
        (
            Inertial::new(v.down, v.north * self.north + v.east * self.east),
            v.east * self.north - v.north * self.east,
        )
    }

    /// The vector with these components in the plane, and `right` across it.
    #[inline(always)]
    pub fn lift(&self, v: Inertial, right: f32) -> Ned {
        Ned::new(
            v.forward() * self.north - right * self.east,
            v.forward() * self.east + right * self.north,
            v.down(),
        )
    }

    /// The course turned by `angle` \[rad\] to the right, by at most π/4.
    #[inline(always)]
    pub fn turned(&self, angle: f32) -> Self {
        let (sin, cos) = math::sin_cos_near_zero(limited(angle, QUARTER));
        let (north, east) = (
            self.north * cos - self.east * sin,
            self.north * sin + self.east * cos,
        );
        // One step of Newton's method: the length stays 1 however often this is done.
        let scale = 1.5 - 0.5 * (north * north + east * east);
        Self {
            north: north * scale,
            east: east * scale,
        }
    }
}

/// The axes of the plane of flight, unit vectors. In a turn it is banked, so that apparent gravity lies in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axes {
    /// Along apparent gravity.
    pub down: Ned,
    /// Along the course.
    pub forward: Ned,
    /// Where the right wing of a vehicle in the plane points.
    pub right: Ned,
    /// Apparent gravity [m/s²].
    pub gravity: f32,
}

impl Axes {
    /// The axes of the plane through `course`, banked so that it accelerates to the right by `lateral_acceleration` [m/s²].
    #[inline(always)]
    pub fn new(course: &Course, gravity: f32, lateral_acceleration: f32) -> Self {
        let apparent = math::sqrt(gravity * gravity + lateral_acceleration * lateral_acceleration);
        let (cos, sin) = (gravity / apparent, lateral_acceleration / apparent);
        Self {
            down: course.lift(Inertial::new(cos, 0.0), -sin),
            forward: course.lift(Inertial::new(0.0, 1.0), 0.0),
            right: course.lift(Inertial::new(sin, 0.0), cos),
            gravity: apparent,
        }
    }

    /// Components of `v` in the plane.
    #[inline(always)]
    pub fn project(&self, v: Ned) -> Inertial {
        Inertial::new(self.down.dot(v), self.forward.dot(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Ned, b: Ned) -> bool {
        (a - b).norm_squared() < 1e-12
    }

    #[test]
    fn projecting_and_lifting_are_inverse() {
        let north = Course {
            north: 1.0,
            east: 0.0,
        };
        let v = Ned::new(3.0, -4.0, 12.0);
        for n in 0..20 {
            let course = (0..n).fold(north, |course, _| course.turned(0.7));
            assert!(course.is_sound());
            let (plane, right) = course.project(v);
            assert!((course.lift(plane, right) - v).norm_squared() < 1e-10);
        }
        // North: down and north are in the plane, east is to the right.
        assert_eq!(north.project(v), (Inertial::new(12.0, 3.0), -4.0));
        assert_eq!(north.turned(0.0), north);
    }

    /// A million small turns leave a unit vector.
    #[test]
    fn the_length_does_not_drift() {
        let mut course = Course {
            north: 0.6,
            east: 0.8,
        };
        for _ in 0..1_000_000 {
            course = course.turned(0.013);
        }
        let length = course.north * course.north + course.east * course.east;
        assert!((length - 1.0).abs() < 1e-6);
    }

    /// In a turn to the right the right wing is down, and apparent gravity points to the left of the vertical.
    #[test]
    fn a_turn_to_the_right_is_banked_to_the_right() {
        let course = Course {
            north: 0.6,
            east: 0.8,
        };
        let axes = Axes::new(&course, 9.81, 9.81);
        assert!((axes.gravity - 9.81 * core::f32::consts::SQRT_2).abs() < 1e-5);
        assert!((axes.right.down - core::f32::consts::FRAC_1_SQRT_2).abs() < 1e-6);
        assert!(course.project(axes.down).1 < -0.7);
        assert!(close(axes.down.cross(axes.forward), axes.right));
    }

    /// Nose up with the belly to the east the course is east; lying on its side it is where the belly points.
    #[test]
    fn the_course_is_across_the_wing() {
        use crate::frame::Attitude;
        let upright = Orientation::in_plane(Attitude::from_angle(-0.4));
        assert_eq!(Course::of(&upright).north, 1.0);
        let q = |w, x, y, z| {
            let q = crate::ned::Quaternion { w, x, y, z };
            Orientation::from_quaternion(&q, crate::ned::BodyAxes::NoseUp).unwrap()
        };
        let half = core::f32::consts::FRAC_1_SQRT_2;
        assert!(Course::of(&q(half, 0.0, 0.0, half)).east > 0.999);
        // Rolled by a quarter turn about north: the wing points down, the belly north.
        assert!(Course::of(&q(half, half, 0.0, 0.0)).north > 0.999);
    }
}
