//! Numbers as text, when the library is compiled: for the texts of refused parameters.

/// The decimal of a number, to six digits.
pub(crate) struct Decimal {
    text: [u8; 16],
    length: usize,
}

impl Decimal {
    /// Of `value`, which is finite: from 0.001 up as in "0.25" and "1000000", smaller ones as in "1e-6".
    pub(crate) const fn new(value: f32) -> Self {
        let mut decimal = Self {
            text: [0; 16],
            length: 0,
        };
        let mut x = value as f64;
        if x < 0.0 {
            decimal.put(b'-');
            x = -x;
        }
        if x == 0.0 {
            decimal.put(b'0');
            return decimal;
        }
        // x = d.ddddd · 10^exponent. What is nearly the next power of ten is that.
        let mut exponent = 0;
        while x >= 9.999_995 {
            x /= 10.0;
            exponent += 1;
        }
        while x < 0.999_999_5 {
            x *= 10.0;
            exponent -= 1;
        }
        let (mut digits, mut count) = ((x * 1e5 + 0.5) as u32, 6);
        while digits % 10 == 0 {
            digits /= 10;
            count -= 1;
        }
        let scientific = exponent < -3;
        // Where the point is: behind so many digits.
        let whole = if scientific { 1 } else { exponent + 1 };
        let mut n = if whole < 1 { whole - 1 } else { 0 };
        while n < count || n < whole {
            if n == whole {
                decimal.put(b'.');
            }
            let behind = count - 1 - n;
            let digit = if n < 0 || behind < 0 {
                0
            } else {
                digits / 10u32.pow(behind as u32) % 10
            };
            decimal.put(b'0' + digit as u8);
            n += 1;
        }
        if scientific {
            decimal.put(b'e');
            decimal.put(b'-');
            decimal.put(b'0' + -exponent as u8);
        }
        decimal
    }

    const fn put(&mut self, character: u8) {
        self.text[self.length] = character;
        self.length += 1;
    }

    /// The text.
    pub(crate) const fn digits(&self) -> &[u8] {
        self.text.split_at(self.length).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_one_would() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (-0.5, "-0.5"),
            (0.95, "0.95"),
            (0.001, "0.001"),
            (0.025, "0.025"),
            (1e-6, "1e-6"),
            (2.5e-4, "2.5e-4"),
            (6.5, "6.5"),
            (40.0, "40"),
            (1e3, "1000"),
            (1e6, "1000000"),
            (123.25, "123.25"),
            (core::f32::consts::PI, "3.14159"),
            (-core::f32::consts::PI, "-3.14159"),
            (core::f32::consts::FRAC_PI_2, "1.5708"),
        ] {
            assert_eq!(Decimal::new(value).digits(), text.as_bytes(), "{value}");
        }
    }
}
