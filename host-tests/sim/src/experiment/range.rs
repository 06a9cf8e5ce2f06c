//! What numbers of a document may be.

use super::document::FieldError;

/// What a number may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite number.
    Finite,
    /// Finite, and greater than 0.
    Positive,
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
            _ if !x.is_finite() => Some("must be a finite number"),
            Self::Positive if x <= 0.0 => Some("must be positive"),
            _ => None,
        };
        let problem = value.numbers().iter().find_map(|x| outside(*x));
        problem.map_or(Ok(()), |problem| Err(FieldError::new(field, problem)))
    }
}
