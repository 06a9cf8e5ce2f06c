//! The errors of constructors: which parameter, and what was wrong with it.

use core::fmt;

/// Why a parameter was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Problem {
    /// NaN or infinite.
    NotFinite,
    /// Zero or negative where only a positive value has a meaning.
    NotPositive,
    /// Finite, but outside the documented range.
    OutOfRange,
    /// In its range, but against another parameter.
    Contradiction,
}

/// A constructor's refusal. Only constructors return it: a value that exists is valid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ParameterError {
    /// The parameter, as its constructor's documentation names it.
    pub parameter: &'static str,
    /// What was wrong.
    pub problem: Problem,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.problem {
            Problem::NotFinite => "must be a finite number",
            Problem::NotPositive => "must be positive",
            Problem::OutOfRange => "is out of range",
            Problem::Contradiction => "contradicts another parameter",
        };
        write!(f, "{} {}", self.parameter, what)
    }
}

impl core::error::Error for ParameterError {}

/// `value`, if it is finite and in `[min, max]`.
pub(crate) fn in_range(
    parameter: &'static str,
    value: f32,
    min: f32,
    max: f32,
) -> Result<f32, ParameterError> {
    if !value.is_finite() {
        return Err(ParameterError {
            parameter,
            problem: Problem::NotFinite,
        });
    }
    if value < min || value > max {
        return Err(ParameterError {
            parameter,
            problem: Problem::OutOfRange,
        });
    }
    Ok(value)
}

/// `value`, if it is finite, positive and in `[min, max]`.
pub(crate) fn positive(
    parameter: &'static str,
    value: f32,
    min: f32,
    max: f32,
) -> Result<f32, ParameterError> {
    if value <= 0.0 {
        return Err(ParameterError {
            parameter,
            problem: Problem::NotPositive,
        });
    }
    in_range(parameter, value, min, max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_problem_is_told_apart_and_names_its_parameter() {
        let problem = |r: Result<f32, ParameterError>| r.map_err(|e| (e.parameter, e.problem));
        assert_eq!(problem(positive("m", 1.0, 0.5, 2.0)), Ok(1.0));
        assert_eq!(
            problem(positive("m", 0.0, 0.5, 2.0)),
            Err(("m", Problem::NotPositive))
        );
        assert_eq!(
            problem(positive("m", f32::NEG_INFINITY, 0.5, 2.0)),
            Err(("m", Problem::NotPositive))
        );
        assert_eq!(
            problem(positive("m", f32::NAN, 0.5, 2.0)),
            Err(("m", Problem::NotFinite))
        );
        assert_eq!(
            problem(positive("m", 2.5, 0.5, 2.0)),
            Err(("m", Problem::OutOfRange))
        );
        assert_eq!(
            problem(in_range("d", -3.0, -2.0, 2.0)),
            Err(("d", Problem::OutOfRange))
        );
        assert_eq!(problem(in_range("d", -2.0, -2.0, 2.0)), Ok(-2.0));
    }
}
