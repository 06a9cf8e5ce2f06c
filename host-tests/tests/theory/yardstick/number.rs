//! Numbers that carry the yardstick of their own rounding error.
//!
//! Beside its value x, each carries N(x): to first order, the error of x in units of one rounding when every input
//! and every operation is rounded once. N(x) = |x| for an input, N(x ± y) = N(x) + N(y),
//! N(x·y) = |x| N(y) + |y| N(x), N(x/y) = (N(x) + |x/y| N(y))/|y|, and N(f(x)) = |f(x)| + |f′(x)| N(x). Always
//! N(x) ≥ |x|.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its N.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Number {
    /// The value.
    pub value: f64,
    /// N of it.
    pub size: f64,
}

impl Number {
    /// An input, or the difference of two inputs: rounded once.
    pub fn input(value: f64) -> Self {
        Self {
            value,
            size: value.abs(),
        }
    }

    /// √x, x ≥ 0. Near zero N is that of the worst case, √N(x).
    pub fn sqrt(self) -> Self {
        let value = self.value.max(0.0).sqrt();
        Self {
            value,
            size: value + (0.5 * self.size / value).min(self.size.sqrt()),
        }
    }

    /// f(x), given its value and derivative.
    pub fn map(self, value: f64, derivative: f64) -> Self {
        Self {
            value,
            size: value.abs() + derivative.abs() * self.size,
        }
    }

    /// The value with a larger N.
    pub fn with_size(value: f64, size: f64) -> Self {
        Self { value, size }
    }
}

impl Add for Number {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::with_size(self.value + o.value, self.size + o.size)
    }
}

impl Sub for Number {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::with_size(self.value - o.value, self.size + o.size)
    }
}

impl Neg for Number {
    type Output = Self;
    fn neg(self) -> Self {
        Self::with_size(-self.value, self.size)
    }
}

impl Mul for Number {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let size = self.value.abs() * o.size + o.value.abs() * self.size;
        Self::with_size(self.value * o.value, size)
    }
}

impl Mul<f64> for Number {
    type Output = Self;
    fn mul(self, o: f64) -> Self {
        Self::with_size(self.value * o, self.size * o.abs())
    }
}

impl Div for Number {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let value = self.value / o.value;
        Self::with_size(value, (self.size + value.abs() * o.size) / o.value.abs())
    }
}

/// A vector of three.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Triple(pub [Number; 3]);

impl Triple {
    /// A vector of inputs.
    pub fn input(v: [f64; 3]) -> Self {
        Self(v.map(Number::input))
    }

    /// The difference of two inputs.
    pub fn difference(a: [f64; 3], b: [f64; 3]) -> Self {
        Self([0, 1, 2].map(|n| Number::input(a[n] - b[n])))
    }

    /// Scalar product.
    pub fn dot(self, o: Self) -> Number {
        let [a, b, c] = self.0;
        let [x, y, z] = o.0;
        a * x + b * y + c * z
    }

    /// Length.
    pub fn norm(self) -> Number {
        self.dot(self).sqrt()
    }

    /// The vector times a number.
    pub fn scale(self, by: Number) -> Self {
        Self(self.0.map(|x| x * by))
    }

    /// The values alone.
    pub fn values(self) -> [f64; 3] {
        self.0.map(|x| x.value)
    }
}

impl Add for Triple {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self([0, 1, 2].map(|n| self.0[n] + o.0[n]))
    }
}

impl Sub for Triple {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self([0, 1, 2].map(|n| self.0[n] - o.0[n]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A difference that cancels keeps the sizes of what cancelled, and hands them on through a quotient and a root.
    #[test]
    fn cancellation_is_remembered() {
        let d = Number::input(1000.0) - Number::input(999.0);
        assert_eq!((d.value, d.size), (1.0, 1999.0));
        let q = Number::input(3.0) / d;
        assert_eq!((q.value, q.size), (3.0, 3.0 + 3.0 * 1999.0));
        assert_eq!(d.sqrt().size, 1.0 + 1999.0_f64.sqrt());
        assert_eq!((Number::input(4.0) * Number::input(-2.0)).size, 8.0 + 8.0);
    }
}
