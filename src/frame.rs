//! Axes of the vertical plane, and vectors marked with them.
//!
//! - **Inertial** (i0, j0): i0 points down, along gravity; j0 is horizontal, forward.
//! - **Body** (i, j) = R(θ)·(i0, j0). Thrust acts along −i. θ = 0 is hover, nose up; θ = −90° is cruise, nose
//!   forward. The nose's pitch above the horizon is 90° + θ.

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use nalgebra::Vector2;

use crate::math;

/// Makes a vector of two components that is marked with its frame.
///
/// The operators go by components. nalgebra's check dimensions, and that brings a panic into the object.
macro_rules! vector {
    ($(#[$attribute:meta])* $vector:ident, $(#[$first_doc:meta])* $first:ident, $(#[$second_doc:meta])* $second:ident) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct $vector {
            $first: f32,
            $second: f32,
        }

        impl $vector {
            /// The zero vector.
            pub const ZERO: Self = Self::new(0.0, 0.0);

            /// The vector with these components.
            #[inline]
            pub const fn new($first: f32, $second: f32) -> Self {
                Self { $first, $second }
            }

            $(#[$first_doc])*
            #[inline]
            pub const fn $first(&self) -> f32 {
                self.$first
            }

            $(#[$second_doc])*
            #[inline]
            pub const fn $second(&self) -> f32 {
                self.$second
            }

            /// Square of the length.
            #[inline]
            pub const fn norm_squared(&self) -> f32 {
                self.$first * self.$first + self.$second * self.$second
            }

            /// Length.
            #[inline]
            pub fn norm(&self) -> f32 {
                math::sqrt(self.norm_squared())
            }

            /// Scalar product.
            #[inline]
            pub const fn dot(&self, other: &Self) -> f32 {
                self.$first * other.$first + self.$second * other.$second
            }
        }

        impl Add for $vector {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self::new(self.$first + other.$first, self.$second + other.$second)
            }
        }

        impl Sub for $vector {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self::new(self.$first - other.$first, self.$second - other.$second)
            }
        }

        impl Neg for $vector {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::new(-self.$first, -self.$second)
            }
        }

        impl Mul<f32> for $vector {
            type Output = Self;
            #[inline(always)]
            fn mul(self, factor: f32) -> Self {
                Self::new(self.$first * factor, self.$second * factor)
            }
        }

        impl Mul<$vector> for f32 {
            type Output = $vector;
            #[inline(always)]
            fn mul(self, vector: $vector) -> $vector {
                vector * self
            }
        }

        impl Div<f32> for $vector {
            type Output = Self;
            #[inline(always)]
            fn div(self, divisor: f32) -> Self {
                Self::new(self.$first / divisor, self.$second / divisor)
            }
        }

        impl AddAssign for $vector {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl SubAssign for $vector {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }

        impl MulAssign<f32> for $vector {
            #[inline(always)]
            fn mul_assign(&mut self, factor: f32) {
                *self = *self * factor;
            }
        }

        impl From<Vector2<f32>> for $vector {
            fn from(v: Vector2<f32>) -> Self {
                Self::new(v.x, v.y)
            }
        }

        impl From<$vector> for Vector2<f32> {
            fn from(v: $vector) -> Self {
                Self::new(v.$first, v.$second)
            }
        }
    };
}

vector! {
    /// A vector by its inertial components, (down, forward).
    Inertial,
    /// Component along gravity.
    down,
    /// Horizontal component.
    forward
}

vector! {
    /// A vector by its body components, along (i, j).
    Body,
    /// Component along i: positive towards the tail, opposite to thrust.
    i,
    /// Component along j.
    j
}

/// The attitude θ, held as (cos θ, sin θ), so that a control step needs no sine or cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    /// The attitude turned by the angle of this sine and cosine.
    #[inline(always)]
    pub(crate) const fn turned(&self, sin: f32, cos: f32) -> Self {
        Self {
            cos: self.cos * cos - self.sin * sin,
            sin: self.sin * cos + self.cos * sin,
        }
    }

    /// θ \[rad\], in (−π, π].
    pub const fn angle(&self) -> f32 {
        math::atan2(self.sin, self.cos)
    }

    /// Rᵀ(θ)·`v`: the body components of a vector.
    #[inline(always)]
    pub fn to_body(&self, v: Inertial) -> Body {
        Body::new(
            self.cos * v.down + self.sin * v.forward,
            self.cos * v.forward - self.sin * v.down,
        )
    }

    /// R(θ)·`v`: the inertial components of a vector.
    #[inline]
    pub fn to_inertial(&self, v: Body) -> Inertial {
        Inertial::new(
            self.cos * v.i - self.sin * v.j,
            self.sin * v.i + self.cos * v.j,
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

    /// Each operator against nalgebra's.
    #[test]
    fn operators_are_those_of_vectors() {
        let (a, b) = (Inertial::new(3.0, -7.0), Inertial::new(0.25, 2.0));
        let (x, y) = (Vector2::from(a), Vector2::from(b));
        let same = |ours: Inertial, theirs: Vector2<f32>| assert_eq!(ours, theirs.into());
        same(a + b, x + y);
        same(a - b, x - y);
        same(-a, -x);
        same(a * 1.5, x * 1.5);
        same(1.5 * a, 1.5 * x);
        same(a / 4.0, x / 4.0);
        let mut c = a;
        c += b;
        c -= a * 0.5;
        c *= 3.0;
        same(c, ((x + y) - x * 0.5) * 3.0);
        assert_eq!(a.dot(&b), x.dot(&y));
        assert_eq!(a.norm_squared(), 58.0);
        assert_eq!(Body::new(-3.0, 4.0).norm(), 5.0);
    }

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
            assert!((r.transpose() * Vector2::from(v) - Vector2::from(b)).amax() < 1e-5);
            assert!((a.to_inertial(b) - v).norm() < 1e-5);
            assert!((a.angle() - libm::atan2f(s, c)).abs() < 1e-6);
        }
    }
}
