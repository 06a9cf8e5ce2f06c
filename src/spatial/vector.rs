//! Vectors of three components, by world axes ([`Ned`]) and by body axes ([`Body`]).

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use crate::frame;
use crate::ned::{BodyRates, Frd, Ned};

impl Ned {
    /// The zero vector.
    pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);

    /// Scalar product.
    #[inline(always)]
    pub fn dot(&self, other: Self) -> f32 {
        (self.north * other.north + self.east * other.east) + self.down * other.down
    }

    /// Vector product.
    #[inline(always)]
    pub fn cross(&self, other: Self) -> Self {
        Self::new(
            self.east * other.down - self.down * other.east,
            self.down * other.north - self.north * other.down,
            self.north * other.east - self.east * other.north,
        )
    }

    /// Square of the length.
    #[inline(always)]
    pub fn norm_squared(&self) -> f32 {
        self.dot(*self)
    }
}

impl Add for Ned {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(
            self.north + other.north,
            self.east + other.east,
            self.down + other.down,
        )
    }
}

impl AddAssign for Ned {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Neg for Ned {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.north, -self.east, -self.down)
    }
}

impl Sub for Ned {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(
            self.north - other.north,
            self.east - other.east,
            self.down - other.down,
        )
    }
}

impl Mul<f32> for Ned {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f32) -> Self {
        Self::new(self.north * factor, self.east * factor, self.down * factor)
    }
}

/// A vector by its components along the body axes: i towards the tail, opposite to thrust; j towards the belly;
/// w = i × j, the right wing. In the plane of symmetry i and j are those of [`frame::Body`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Body {
    /// Component along i.
    pub i: f32,
    /// Component along j.
    pub j: f32,
    /// Component along w.
    pub w: f32,
}

impl Body {
    /// The vector with these components.
    #[inline(always)]
    pub const fn new(i: f32, j: f32, w: f32) -> Self {
        Self { i, j, w }
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(&self, other: Self) -> f32 {
        (self.i * other.i + self.j * other.j) + self.w * other.w
    }

    /// Square of the length.
    #[inline(always)]
    pub fn norm_squared(&self) -> f32 {
        self.dot(*self)
    }

    /// The part in the plane of symmetry.
    #[inline(always)]
    pub const fn in_plane(&self) -> frame::Body {
        frame::Body::new(self.i, self.j)
    }
}

impl From<Frd> for Body {
    #[inline(always)]
    fn from(v: Frd) -> Self {
        Self::new(-v.forward, v.down, v.right)
    }
}

impl From<Body> for Frd {
    #[inline(always)]
    fn from(v: Body) -> Self {
        Self::new(-v.i, v.w, v.j)
    }
}

impl From<BodyRates> for Body {
    #[inline(always)]
    fn from(rates: BodyRates) -> Self {
        Self::from(Frd::from(rates))
    }
}

impl From<Body> for BodyRates {
    #[inline(always)]
    fn from(rates: Body) -> Self {
        Self::from(Frd::from(rates))
    }
}

impl Add for Body {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.i + other.i, self.j + other.j, self.w + other.w)
    }
}

impl Sub for Body {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.i - other.i, self.j - other.j, self.w - other.w)
    }
}

impl Mul<f32> for Body {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f32) -> Self {
        Self::new(self.i * factor, self.j * factor, self.w * factor)
    }
}
