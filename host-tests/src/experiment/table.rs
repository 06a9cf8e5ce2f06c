//! Tables of numbers: each number once, with its range and its meaning.

use super::document::{FieldError, require};

/// What a number may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// Finite, and greater than 0.
    Positive,
    /// Finite, and not negative.
    NotNegative,
    /// From the first to the second.
    Within(f64, f64),
}

/// One number or several.
pub trait Numbers {
    /// The numbers.
    fn numbers(&self) -> &[f64];
}

impl Numbers for f64 {
    fn numbers(&self) -> &[f64] {
        std::slice::from_ref(self)
    }
}

impl<const N: usize> Numbers for [f64; N] {
    fn numbers(&self) -> &[f64] {
        self
    }
}

impl<T: Numbers> Numbers for Option<T> {
    fn numbers(&self) -> &[f64] {
        self.as_ref().map_or(&[], T::numbers)
    }
}

impl Range {
    /// Checks every number of a field.
    pub fn check(self, field: &str, value: &impl Numbers) -> Result<(), FieldError> {
        let outside = |x: f64| match self {
            _ if !x.is_finite() => Some("must be a finite number".to_owned()),
            Self::Positive if x <= 0.0 => Some("must be positive".to_owned()),
            Self::NotNegative if x < 0.0 => Some("must not be negative".to_owned()),
            Self::Within(least, most) if !(least..=most).contains(&x) => {
                Some(format!("must be from {least} to {most}"))
            }
            _ => None,
        };
        let problem = value.numbers().iter().find_map(|x| outside(*x));
        problem.map_or(Ok(()), |problem| Err(FieldError::new(field, problem)))
    }
}

/// A pair must be the least and the greatest.
pub fn ordered(field: &str, [least, greatest]: [f64; 2]) -> Result<(), FieldError> {
    require(least < greatest, field, "must be [least, greatest]")
}

/// Makes a structure and its check from the rows: name, type, range, meaning.
macro_rules! table {
    (
        $(#[$attribute:meta])*
        pub struct $structure:ident {
            $($name:ident: $type:ty, $range:expr, $meaning:literal;)*
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $structure {
            $(#[doc = $meaning] pub $name: $type,)*
        }

        impl $structure {
            /// Checks every number against its range. `table` is where they stand.
            pub(crate) fn in_range(&self, table: &str) -> Result<(), $crate::experiment::FieldError> {
                $($range.check(&format!("{table}.{}", stringify!($name)), &self.$name)?;)*
                Ok(())
            }
        }
    };
}
pub(crate) use table;
