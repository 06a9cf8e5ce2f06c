//! Axes of the vertical plane, and vectors marked with them.
//!
//! - **Inertial** (i0, j0): i0 points down, along gravity; j0 is horizontal, forward.
//! - **Body** (i, j) = R(θ)·(i0, j0). Thrust acts along −i. θ = 0 is hover, nose up; θ = −90° is cruise, nose
//!   forward. The nose's pitch above the horizon is 90° + θ.

use core::ops::{Add, Mul, Sub};

use nalgebra::Vector2;

use crate::math;

/// A vector by its inertial components, (down, forward).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertial(pub Vector2<f32>);

impl Inertial {
    /// The zero vector.
    pub const ZERO: Self = Self::new(0.0, 0.0);

    /// The vector with these components.
    #[inline]
    pub const fn new(down: f32, forward: f32) -> Self {
        Self(Vector2::new(down, forward))
    }

    /// Component along gravity.
    #[inline]
    pub fn down(&self) -> f32 {
        self.0.x
    }

    /// Horizontal component.
    #[inline]
    pub fn forward(&self) -> f32 {
        self.0.y
    }

    /// Square of the length.
    #[inline]
    pub fn norm_squared(&self) -> f32 {
        self.0.x * self.0.x + self.0.y * self.0.y
    }
}

impl Sub for Inertial {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        // By components: the matrix operator brings a check of dimensions, and with it a panic, into the object.
        Self::new(self.0.x - other.0.x, self.0.y - other.0.y)
    }
}

impl Add for Inertial {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.0.x + other.0.x, self.0.y + other.0.y)
    }
}

impl Mul<f32> for Inertial {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self::new(self.0.x * factor, self.0.y * factor)
    }
}

/// A vector by its body components, along (i, j).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body(pub Vector2<f32>);

impl Body {
    /// The vector with these components along i (tailward, opposite to thrust) and j.
    #[inline]
    pub const fn new(i: f32, j: f32) -> Self {
        Self(Vector2::new(i, j))
    }

    /// Component along i: positive towards the tail, opposite to thrust.
    #[inline]
    pub fn i(&self) -> f32 {
        self.0.x
    }

    /// Component along j.
    #[inline]
    pub fn j(&self) -> f32 {
        self.0.y
    }

    /// Length.
    #[inline]
    pub fn norm(&self) -> f32 {
        math::sqrt(self.0.x * self.0.x + self.0.y * self.0.y)
    }
}

/// The attitude θ, held as (cos θ, sin θ), so that a control step needs no sine or cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Attitude {
    /// cos θ.
    pub cos: f32,
    /// sin θ.
    pub sin: f32,
}

impl Attitude {
    /// θ = 0: hover, nose up.
    pub const NOSE_UP: Self = Self { cos: 1.0, sin: 0.0 };

    /// The attitude of angle `theta` \[rad\]. A non-finite angle gives NaN, which a control step reports.
    pub const fn from_angle(theta: f32) -> Self {
        let (sin, cos) = math::sin_cos(theta);
        Self { cos, sin }
    }

    /// θ \[rad\], in (−π, π].
    pub const fn angle(&self) -> f32 {
        math::atan2(self.sin, self.cos)
    }

    /// Rᵀ(θ)·`v`: the body components of a vector.
    #[inline(always)]
    pub fn to_body(&self, v: Inertial) -> Body {
        Body::new(
            self.cos * v.0.x + self.sin * v.0.y,
            self.cos * v.0.y - self.sin * v.0.x,
        )
    }

    /// R(θ)·`v`: the inertial components of a vector.
    #[inline]
    pub fn to_inertial(&self, v: Body) -> Inertial {
        Inertial::new(
            self.cos * v.0.x - self.sin * v.0.y,
            self.sin * v.0.x + self.cos * v.0.y,
        )
    }
}

impl Default for Attitude {
    fn default() -> Self {
        Self::NOSE_UP
    }
}

#[cfg(feature = "defmt")]
mod format {
    use super::{Body, Inertial};

    impl defmt::Format for Inertial {
        fn format(&self, f: defmt::Formatter<'_>) {
            defmt::write!(f, "(down {}, forward {})", self.down(), self.forward());
        }
    }

    impl defmt::Format for Body {
        fn format(&self, f: defmt::Formatter<'_>) {
            defmt::write!(f, "(i {}, j {})", self.i(), self.j());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_cruise_attitude_the_tail_points_backward() {
        let cruise = Attitude::from_angle(-core::f32::consts::FRAC_PI_2);
        let tail = cruise.to_inertial(Body::new(1.0, 0.0));
        assert!((tail.forward() + 1.0).abs() < 1e-6 && tail.down().abs() < 1e-6);
        // j then points down: the right-hand normal of (down, forward) turned by −90°.
        let j = cruise.to_inertial(Body::new(0.0, 1.0));
        assert!((j.down() - 1.0).abs() < 1e-6 && j.forward().abs() < 1e-6);
    }

    #[test]
    fn body_and_inertial_components_are_inverse_and_match_a_rotation_matrix() {
        for n in -20..20 {
            let theta = n as f32 * 0.31;
            let a = Attitude::from_angle(theta);
            let v = Inertial::new(3.0, -7.0);
            let (s, c) = math::sin_cos(theta);
            let r = nalgebra::Matrix2::new(c, -s, s, c);
            let b = a.to_body(v);
            // 1e-5: forty ulps of a length of 7.6.
            assert!((r.transpose() * v.0 - b.0).amax() < 1e-5);
            assert!((a.to_inertial(b).0 - v.0).amax() < 1e-5);
            assert!((a.angle() - math::atan2(s, c)).abs() < 1e-6);
        }
    }
}
