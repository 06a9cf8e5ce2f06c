//! The errors of constructors: which parameter, and what was wrong with it.

use core::fmt;

/// Why a parameter was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
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

/// What a parameter must be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Requirement {
    /// Finite and within a range.
    Within {
        /// Least value accepted.
        min: f32,
        /// Greatest value accepted.
        max: f32,
        /// Unit of both; empty for a pure number.
        unit: &'static str,
    },
    /// In a relation to other parameters, which the text names: "above thrust_min".
    Relation(&'static str),
}

/// A constructor's refusal. Only constructors return it: a value that exists is valid.
///
/// ```
/// use alula::{Combined, CombinedParameters, Vehicle, VehicleParameters};
///
/// let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3)?;
/// let refused = |p| Vehicle::new(p, model).unwrap_err().to_string();
/// let p = VehicleParameters::PAPER;
/// assert_eq!(refused(p.mass(-1.0)), "mass must be positive, from 0.001 to 1000000 kg");
/// assert_eq!(refused(p.thrust_min(300.0)), "thrust_max must be above thrust_min");
/// # Ok::<(), alula::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct ParameterError {
    /// The parameter, as its constructor's documentation names it.
    pub parameter: &'static str,
    /// What was wrong.
    pub problem: Problem,
    /// What it must be.
    pub requirement: Requirement,
}

impl ParameterError {
    /// A `parameter` that must be in a `relation` to others, as in "above thrust_min", and is not.
    pub const fn contradiction(parameter: &'static str, relation: &'static str) -> Self {
        Self {
            parameter,
            problem: Problem::Contradiction,
            requirement: Requirement::Relation(relation),
        }
    }

    /// A `parameter` that must be from `min` to `max`, in `unit`, and has this `problem`.
    pub const fn range(
        parameter: &'static str,
        problem: Problem,
        [min, max]: [f32; 2],
        unit: &'static str,
    ) -> Self {
        Self {
            parameter,
            problem,
            requirement: Requirement::Within { min, max, unit },
        }
    }
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} must be ", self.parameter)?;
        f.write_str(match self.problem {
            Problem::NotFinite => "a finite number, ",
            Problem::NotPositive => "positive, ",
            Problem::OutOfRange | Problem::Contradiction => "",
        })?;
        match self.requirement {
            Requirement::Within { min, max, unit } => {
                let space = if unit.is_empty() { "" } else { " " };
                write!(f, "from {} to {}{space}{unit}", Short(min), Short(max))
            }
            Requirement::Relation(relation) => f.write_str(relation),
        }
    }
}

impl core::error::Error for ParameterError {}

/// A number without a row of zeros behind the point.
struct Short(f32);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 != 0.0 && self.0.abs() < 1e-3 {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

/// What is wrong with a value that must be from `min` to `max`.
pub(crate) fn problem(value: f32, min: f32, max: f32) -> Option<Problem> {
    if value <= 0.0 && min > 0.0 {
        Some(Problem::NotPositive)
    } else if !value.is_finite() {
        Some(Problem::NotFinite)
    } else if value < min || value > max {
        Some(Problem::OutOfRange)
    } else {
        None
    }
}

/// `value` \[`unit`\], if it is finite and from `min` to `max`.
pub(crate) fn in_range(
    parameter: &'static str,
    value: f32,
    [min, max]: [f32; 2],
    unit: &'static str,
) -> Result<f32, ParameterError> {
    match problem(value, min, max) {
        None => Ok(value),
        Some(problem) => Err(ParameterError::range(parameter, problem, [min, max], unit)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_problem_is_told_apart_and_names_its_parameter() {
        let problem = |r: Result<f32, ParameterError>| r.map_err(|e| (e.parameter, e.problem));
        assert_eq!(problem(in_range("m", 1.0, [0.5, 2.0], "kg")), Ok(1.0));
        assert_eq!(
            problem(in_range("m", 0.0, [0.5, 2.0], "kg")),
            Err(("m", Problem::NotPositive))
        );
        assert_eq!(
            problem(in_range("m", f32::NEG_INFINITY, [0.5, 2.0], "kg")),
            Err(("m", Problem::NotPositive))
        );
        assert_eq!(
            problem(in_range("m", f32::NAN, [0.5, 2.0], "kg")),
            Err(("m", Problem::NotFinite))
        );
        assert_eq!(
            problem(in_range("m", 2.5, [0.5, 2.0], "kg")),
            Err(("m", Problem::OutOfRange))
        );
        assert_eq!(
            problem(in_range("d", -3.0, [-2.0, 2.0], "")),
            Err(("d", Problem::OutOfRange))
        );
        assert_eq!(problem(in_range("d", -2.0, [-2.0, 2.0], "")), Ok(-2.0));
    }

    #[test]
    fn a_refusal_says_what_a_value_must_be() {
        extern crate std;
        use std::string::ToString;
        let text = |value| {
            in_range("delta", value, [-0.5, 0.5], "rad")
                .unwrap_err()
                .to_string()
        };
        assert_eq!(text(0.6), "delta must be from -0.5 to 0.5 rad");
        assert_eq!(
            text(f32::NAN),
            "delta must be a finite number, from -0.5 to 0.5 rad"
        );
        let text = in_range("c", 0.0, [1e-6, 1e4], "").unwrap_err().to_string();
        assert_eq!(text, "c must be positive, from 1e-6 to 10000");
    }
}
