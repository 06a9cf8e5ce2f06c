//! The table of parameters: each one's name, unit, range, default and meaning, written once.
//!
//! The macro [`parameters!`](crate::parameters) makes a structure and its checks from the rows. What else is said of a
//! parameter is read from [`Parameters::ROWS`]: names in experiment files, the C structure with its comments, PX4's
//! parameter file, the page in the documentation.

use crate::error::{ParameterError, Problem, in_range, problem};

/// What is known of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Name of its field.
    pub name: &'static str,
    /// Unit: `"rad"`, `"1/s"`, `"N"`, …; `"mg"` is a multiple of the vehicle's weight m g; empty for a pure number.
    pub unit: &'static str,
    /// Least value accepted.
    pub min: f32,
    /// Greatest value accepted.
    pub max: f32,
    /// Default; NaN if there is none and the value must be given.
    pub default: f32,
    /// Name in PX4's parameter file, at most 16 characters.
    pub px4: &'static str,
    /// Meaning.
    pub meaning: &'static str,
}

/// The part of a row that is needed on board. The rest of the table takes no room in an image that does not read it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Name of the field.
    pub name: &'static str,
    /// Unit, as in [`Row::unit`].
    pub unit: &'static str,
    /// Least value accepted.
    pub min: f32,
    /// Greatest value accepted.
    pub max: f32,
}

impl Range {
    /// Checks one value.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn check(&self, value: f32) -> Result<(), Problem> {
        problem(value, self.min, self.max).map_or(Ok(()), Err)
    }
}

/// A structure made of parameters, all `f32`, in the order of its rows.
pub trait Parameters: Copy + 'static {
    /// Heading that the parameters stand under.
    const GROUP: &'static str;
    /// The rows.
    const ROWS: &'static [Row];
    /// The ranges, in the order of the rows.
    const RANGES: &'static [Range];
    /// Every parameter at its default; NaN where there is none.
    const DEFAULT: Self;

    /// The values, in the order of the rows.
    fn values(&self) -> impl AsRef<[f32]>;

    /// The value in row `row`, counted from 0; NaN beyond the last row.
    fn get(&self, row: usize) -> f32 {
        self.values().as_ref().get(row).copied().unwrap_or(f32::NAN)
    }

    /// Sets the value in row `row`; beyond the last row nothing happens.
    fn set(&mut self, row: usize, value: f32);

    /// Checks every value against its range.
    ///
    /// # Errors
    /// The first parameter that is not finite, not positive where it must be, or out of its range.
    fn check(&self) -> Result<(), ParameterError> {
        check(Self::RANGES, self.values().as_ref())
    }
}

/// Checks each value against its range. The loop is there once, and not once for every table.
#[inline(never)]
fn check(ranges: &[Range], values: &[f32]) -> Result<(), ParameterError> {
    for (range, value) in ranges.iter().zip(values) {
        in_range(range.name, *value, [range.min, range.max], range.unit)?;
    }
    Ok(())
}

/// Makes a structure of parameters from its rows:
/// name: unit, least value, greatest value, default, name for PX4, meaning.
/// Each row is a field, and a method of the same name that gives the structure with another value of it.
#[doc(hidden)]
#[macro_export]
macro_rules! parameters {
    (
        $(#[$attribute:meta])*
        pub struct $structure:ident, $group:literal {
            $( $name:ident: $unit:literal, $min:expr, $max:expr, $default:expr, $px4:literal, $meaning:literal; )*
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[repr(C)]
        pub struct $structure {
            $(
                #[doc = concat!(
                    $meaning, " Unit \\[", $unit, "\\], from `", stringify!($min), "` to `", stringify!($max),
                    "`, default `", stringify!($default), "`."
                )]
                pub $name: f32,
            )*
        }

        impl $structure {
            $(
                #[doc = concat!("The same with another `", stringify!($name), "` \\[", $unit, "\\].")]
                #[must_use]
                pub const fn $name(mut self, $name: f32) -> Self {
                    self.$name = $name;
                    self
                }
            )*
        }

        impl $crate::Parameters for $structure {
            const GROUP: &'static str = $group;
            const ROWS: &'static [$crate::Row] = &[$( $crate::Row {
                name: stringify!($name),
                unit: $unit,
                min: $min,
                max: $max,
                default: $default,
                px4: $px4,
                meaning: $meaning,
            }, )*];
            const RANGES: &'static [$crate::Range] = &[$( $crate::Range {
                name: stringify!($name),
                unit: $unit,
                min: $min,
                max: $max,
            }, )*];
            const DEFAULT: Self = Self { $( $name: $default, )* };

            fn values(&self) -> impl AsRef<[f32]> {
                [$( self.$name, )*]
            }

            fn set(&mut self, row: usize, value: f32) {
                if let Some(place) = [$( &mut self.$name, )*].into_iter().nth(row) {
                    *place = value;
                }
            }
        }
    };
}

/// For structures that will grow and are no table: they are begun from their default, and given field by field. Methods named as the fields, that give the structure with another value of one: a program that sets some of them goes on
/// compiling when one is added.
macro_rules! setters {
    ($structure:ident { $( $name:ident: $type:ty, )* }) => {
        impl $structure {
            $(
                #[doc = concat!("The same with another [`", stringify!($name), "`](Self#structfield.", stringify!($name), ").")]
                #[must_use]
                pub fn $name(mut self, $name: $type) -> Self {
                    self.$name = $name.into();
                    self
                }
            )*
        }
    };
}
pub(crate) use setters;

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{CombinedParameters, LargeAngleParameters, SmallAngleParameters};
    use crate::control::GainParameters;
    use crate::guidance::GuidanceParameters;
    use crate::vehicle::VehicleParameters;
    use std::vec::Vec;

    /// What every table must keep, whatever its parameters are.
    fn check<P: Parameters + PartialEq + core::fmt::Debug>(complete: P) -> Vec<&'static str> {
        complete.check().unwrap();
        for (
            row,
            (
                Row {
                    name,
                    min,
                    max,
                    default,
                    ..
                },
                range,
            ),
        ) in P::ROWS.iter().zip(P::RANGES).enumerate()
        {
            assert!((range.name, range.min, range.max) == (*name, *min, *max));
            assert!(min < max, "{name}");
            assert!(default.is_nan() || range.check(*default).is_ok(), "{name}");
            let put = |value| {
                let mut p = complete;
                p.set(row, value);
                // 1 ulp: the value itself.
                assert!(p.get(row) == value || value.is_nan(), "{name}");
                p.check().map_err(|e| (e.parameter, e.problem))
            };
            assert_eq!(put(*min), Ok(()));
            assert_eq!(put(*max), Ok(()));
            assert_eq!(put(f32::NAN), Err((*name, Problem::NotFinite)));
            assert_eq!(put(f32::INFINITY), Err((*name, Problem::NotFinite)));
            assert_eq!(
                put(2.0 * max.abs() + 1.0),
                Err((*name, Problem::OutOfRange))
            );
            if *min > 0.0 {
                assert_eq!(put(0.0), Err((*name, Problem::NotPositive)));
            }
        }
        assert!(complete.get(P::ROWS.len()).is_nan());
        let mut same = complete;
        same.set(P::ROWS.len(), 1.0);
        assert_eq!(same, complete);
        P::ROWS.iter().map(|row| row.px4).collect()
    }

    #[test]
    fn every_table_reads_back_and_names_what_it_refuses() {
        let mut px4 = check(VehicleParameters::PAPER);
        px4.extend(check(CombinedParameters::NACA_0021_RE_160E3));
        px4.extend(check(GainParameters::PAPER));
        px4.extend(check(GuidanceParameters::DEFAULT));
        // The models share names with the combined one.
        check(LargeAngleParameters::NACA_0021_RE_160E3);
        check(SmallAngleParameters::DEFAULT);
        assert!(px4.iter().all(|name| name.len() <= 16), "{px4:?}");
        px4.sort_unstable();
        let all = px4.len();
        px4.dedup();
        assert_eq!(px4.len(), all);
    }
}
