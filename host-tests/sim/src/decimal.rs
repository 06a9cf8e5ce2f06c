//! Numbers as text: the shortest decimal form that reads back to the same bits, as `to_string` gives it, and faster.

use std::fmt::Display;

use zmij::{Buffer, Float};

/// A binary number.
pub trait Binary: Float + Display + Copy {
    /// Its odd significand and the number of its binary digits after the point; none if it is an integer, or not finite.
    fn fraction(self) -> Option<(u64, u32)>;
    /// Whether integers of its size are not all representable, or it is not finite.
    fn is_coarse(self) -> bool;
    /// Whether it is so near to zero that its shortest form may have an exponent.
    fn is_small(self) -> bool;
}

macro_rules! binary {
    ($float:ty, $digits:literal) => {
        impl Binary for $float {
            fn fraction(self) -> Option<(u64, u32)> {
                let exponent =
                    (self.to_bits() >> $digits) as u32 & (2 * <$float>::MAX_EXP as u32 - 1);
                let stored = u64::from(self.to_bits() & ((1 << $digits) - 1));
                let (significand, exponent) = match exponent {
                    0 => (stored, 1),
                    e => (stored | 1 << $digits, e),
                };
                // Of the significand's last digit, after the point.
                let place = <$float>::MAX_EXP as u32 + $digits - 1;
                // Zero has none.
                let zeros = significand.trailing_zeros() % u64::BITS;
                let digits = place.checked_sub(exponent)?.checked_sub(zeros)?;
                (digits > 0).then_some((significand >> zeros, digits))
            }

            fn is_coarse(self) -> bool {
                self.is_nan() || self.abs() >= (1_u64 << $digits) as $float
            }

            fn is_small(self) -> bool {
                self.abs() < 1e-3
            }
        }
    };
}

binary!(f32, 23);
binary!(f64, 52);

/// Appends `value` to `text`.
pub fn push(text: &mut Vec<u8>, value: impl Binary) {
    if value.is_coarse() {
        text.extend_from_slice(value.to_string().as_bytes());
        return;
    }
    let start = text.len();
    let mut buffer = Buffer::new();
    let shortest = buffer.format_finite(value);
    match shortest.strip_suffix(".0") {
        Some(integer) => text.extend_from_slice(integer.as_bytes()),
        None if value.is_small() => push_small(text, shortest),
        None => text.extend_from_slice(shortest.as_bytes()),
    }
    // Of two shortest forms that are equally near, the other one rounds up, and zmij to an even digit. They are equally near if there is
    // exactly one digit more, a five; and what is left of the significand tells whether the digit before it was even. Under a power of two the
    // numbers are closer, and the lower form may be another one's: then zmij has rounded up, too.
    if let Some((significand, digits)) = value.fraction()
        && digits <= LONGEST_TIE
        && significand % 4 == 1
    {
        let written = &text[start..];
        let point = written.iter().position(|&byte| byte == b'.');
        let decimals = point.map_or(0, |point| written.len() - point - 1);
        if digits as usize == decimals + 1
            && let Some(last) = text.last_mut()
            && last.is_multiple_of(2)
        {
            *last += 1;
        }
    }
}

/// Most binary digits after the point at which two shortest forms can be equally near: the exact decimal form has as many, at least 5^digits
/// in its significand, and one more than the at most 17 of a shortest form.
const LONGEST_TIE: u32 = 25;

/// Appends a shortest form below 0.001, in which an exponent may stand: without it, as `to_string` writes it.
fn push_small(text: &mut Vec<u8>, shortest: &str) {
    let exponent = |(number, exponent): (_, &str)| Some((number, exponent.parse::<i32>().ok()?));
    let Some((number, exponent)) = shortest.split_once('e').and_then(exponent) else {
        text.extend_from_slice(shortest.as_bytes());
        return;
    };
    if number.starts_with('-') {
        text.push(b'-');
    }
    text.extend_from_slice(b"0.");
    // One digit stands before the point.
    text.resize(text.len() + exponent.unsigned_abs() as usize - 1, b'0');
    text.extend(number.bytes().filter(u8::is_ascii_digit));
}

/// A number with this many digits after the point, and no sign if nothing but zeros is left of it.
pub fn fixed(value: f64, digits: usize) -> String {
    let number = format!("{value:.digits$}");
    match number.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_owned(),
        _ => number,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn text(value: impl Binary) -> String {
        let mut text = Vec::new();
        push(&mut text, value);
        String::from_utf8(text).unwrap()
    }

    /// Bit patterns of every size: NaN, infinities and subnormal numbers among them.
    #[test]
    fn the_text_is_that_of_to_string() {
        let random = &mut ChaCha8Rng::seed_from_u64(1);
        for _ in 0..200_000 {
            // Halves, quarters and so on, where two forms are equally near.
            let ties = f64::from(random.random_range(-9_999_999..9_999_999)) / 64.0;
            assert_eq!(text(ties as f32), (ties as f32).to_string());
            let ties = random.random_range(0..1_u64 << 53) as f64 / (1_u64 << 30) as f64;
            assert_eq!(text(ties), ties.to_string());
            let single = f32::from_bits(random.random());
            assert_eq!(text(single), single.to_string());
            let double = f64::from_bits(random.random());
            assert_eq!(text(double), double.to_string());
            let usual = f64::from(random.random_range(-40_000..40_000)) / 1000.0;
            assert_eq!(text(usual), usual.to_string());
        }
        for exponent in -1080..1024 {
            let power = 2.0_f64.powi(exponent);
            assert_eq!(text(power), power.to_string());
            assert_eq!(text(-power as f32), (-power as f32).to_string());
        }
        for value in [
            0.0,
            -0.0,
            1.0,
            1e16,
            1e15,
            1e-5,
            1e-7,
            5e-324,
            123456.0,
            f64::MAX,
        ] {
            assert_eq!(text(value), value.to_string());
            assert_eq!(text(-value as f32), (-value as f32).to_string());
        }
    }

    #[test]
    fn zero_has_no_sign() {
        for (value, text) in [
            (-0.004, "0.00"),
            (-0.006, "-0.01"),
            (-0.0, "0.00"),
            (2.5, "2.50"),
        ] {
            assert_eq!(fixed(value, 2), text);
        }
        assert_eq!(fixed(f64::NAN, 1), "NaN");
    }
}
