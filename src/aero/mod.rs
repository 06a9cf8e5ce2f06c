//! Aerodynamic coefficient models, and the list of them: [`Model`].
//!
//! Lift is along the normal S·v_a of the air velocity, drag against it:
//! `F_a = k_a |v_a| (c_L S − c_D I) v_a` (`aerodynamicForce2D`).

mod combined;
mod interpolant;
mod large_angle;
mod naca_0021;
mod small_angle;
mod stall;
mod table;

pub use combined::{Combined, CombinedParameters};
pub use large_angle::{LargeAngle, LargeAngleParameters};
pub use naca_0021::{NACA_0021_RE_5E6, NACA_0021_RE_160E3};
pub use small_angle::{SmallAngle, SmallAngleParameters};
pub(crate) use stall::Stall;
pub use table::{Interval, Node, Polar, Table, TableError, TableProblem};

use crate::air::AngleOfAttack;
use crate::error::ParameterError;
use crate::parameters::{Parameters, Row};

/// Lift and drag coefficients and their derivatives with respect to the angle of attack.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Coefficients {
    /// Lift coefficient c_L.
    pub c_l: f32,
    /// Drag coefficient c_D.
    pub c_d: f32,
    /// c_L' [1/rad].
    pub dc_l: f32,
    /// c_D' [1/rad].
    pub dc_d: f32,
    /// c_L'' [1/rad²].
    pub ddc_l: f32,
    /// c_D'' [1/rad²].
    pub ddc_d: f32,
}

/// A model of the aerodynamic coefficients at every angle of attack.
///
/// Implementations are total: finite for every angle. They compute everything by code that hardly branches and are
/// marked `#[inline]`, so that a caller that has no use for the second derivatives does not pay for them.
pub trait Aerodynamics {
    /// The coefficients at `alpha`.
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients;
}

impl<A: Aerodynamics> Aerodynamics for &A {
    #[inline(always)]
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
        (**self).coefficients(alpha)
    }
}

/// What a model is called by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ModelName {
    /// Its number: what [`ModelParameters::numbered`] takes.
    pub number: u32,
    /// Its name.
    pub name: &'static str,
    /// The names of its parameters.
    pub parameters: &'static [&'static str],
}

/// Makes the list of models that have parameters. A row: the model, its parameters and which of the combined model's they are,
/// its number in a parameter block, its name. The numbers count on from 0; 3 is the table's.
macro_rules! models {
    ($( $(#[doc = $about:literal])* $model:ident, $parameters:ident { $($field:ident),* }, $number:literal, $name:literal; )*) => {
        /// One of the core's models, where the choice is data: an experiment file, a parameter block.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Model<'a> {
            $( $(#[doc = $about])* $model($model), )*
            /// Measured coefficients, interpolated.
            Table(Table<'a>),
        }

        impl Aerodynamics for Model<'_> {
            #[inline(always)]
            fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
                match self {
                    $( Self::$model(m) => m.coefficients(alpha), )*
                    Self::Table(m) => m.coefficients(alpha),
                }
            }
        }

        /// Parameters of a model that has no table.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum ModelParameters {
            $( #[doc = concat!("Of [`", stringify!($model), "`].")] $model($parameters), )*
        }

        impl ModelParameters {
            /// Every model.
            pub const LIST: &'static [ModelName] = &[$( ModelName {
                number: $number,
                name: $name,
                parameters: &[$( stringify!($field) ),*],
            }, )*];

            /// The parameters of the model with this `number`, from those of the same names in `coefficients`; none if there is no
            /// such model.
            pub fn numbered(number: u32, coefficients: &CombinedParameters) -> Option<Self> {
                match number {
                    $( $number => Some(Self::$model($parameters {
                        $( $field: coefficients.$field, )*
                    })), )*
                    _ => None,
                }
            }

            /// The model with these parameters.
            ///
            /// # Errors
            /// As the model's constructor.
            pub fn model(&self) -> Result<Model<'static>, ParameterError> {
                Ok(match *self {
                    $( Self::$model(p) => Model::$model($model::new(p)?), )*
                })
            }

            /// The rows of the model's table of parameters.
            pub fn rows(&self) -> &'static [Row] {
                match self {
                    $( Self::$model(_) => $parameters::ROWS, )*
                }
            }

            /// The value in row `row` of the model's table of parameters, counted from 0; NaN beyond the last row.
            pub fn get(&self, row: usize) -> f32 {
                match self {
                    $( Self::$model(p) => p.get(row), )*
                }
            }

            /// Sets the value in row `row`; beyond the last row nothing happens.
            pub fn set(&mut self, row: usize, value: f32) {
                match self {
                    $( Self::$model(p) => p.set(row, value), )*
                }
            }
        }
    };
}

models! {
    /// `coeffSmallReynolds1`.
    LargeAngle, LargeAngleParameters { c0, c1 }, 1, "large-angle";
    /// `coeffLargeReynoldsSamllAlpha1`.
    SmallAngle, SmallAngleParameters { c0, c2, c3 }, 2, "small-angle";
    /// `CompleteModel`.
    Combined, CombinedParameters { c0, c1, c2, c3, alpha_bar, k_l, k_d }, 0, "combined";
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    #[test]
    fn a_model_chosen_at_run_time_is_the_one_chosen() {
        let large = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        let combined = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let small = SmallAngle::new(SmallAngleParameters {
            c0: 0.014,
            c2: 5.5,
            c3: 0.3,
        });
        let (small, table) = (small.unwrap(), Table::new(&NACA_0021_RE_160E3));
        let at = |model: &dyn Aerodynamics| model.coefficients(AngleOfAttack::from_radians(0.3));
        let all = [at(&large), at(&small), at(&combined), at(&table)];
        let chosen = [
            at(&Model::LargeAngle(large)),
            at(&Model::SmallAngle(small)),
            at(&Model::Combined(combined)),
            at(&Model::Table(table)),
        ];
        assert_eq!(chosen, all);
        // No two of them agree.
        assert!((0..4).all(|i| (0..i).all(|j| all[i] != all[j])));
    }

    /// Every number leads to the model of its row, with the coefficients of the same names.
    #[test]
    fn a_number_chooses_its_model() {
        let coefficients = CombinedParameters::NACA_0021_RE_160E3;
        for model in ModelParameters::LIST {
            let (name, fields) = (model.name, model.parameters);
            let mut chosen = ModelParameters::numbered(model.number, &coefficients).unwrap();
            assert!(chosen.model().is_ok(), "{name}");
            for (row, field) in fields.iter().enumerate() {
                let of = CombinedParameters::RANGES;
                let place = of.iter().position(|range| range.name == *field).unwrap();
                assert_eq!(chosen.get(row), coefficients.get(place), "{name}: {field}");
                chosen.set(row, -1.0);
                assert_eq!(chosen.get(row), -1.0, "{name}: {field}");
            }
            let names = chosen.rows().iter().map(|row| row.name);
            assert!(names.eq(fields.iter().copied()), "{name}");
            assert!(chosen.get(fields.len()).is_nan(), "{name}");
            assert!(chosen.model().is_err(), "{name}");
        }
        // 3 is the table's, which has no parameters.
        for none in [3, ModelParameters::LIST.len() as u32 + 1] {
            assert_eq!(ModelParameters::numbered(none, &coefficients), None);
        }
    }

    /// Compares `model` with `c`, the same model's (c_L, c_D) in f64 from the printed equations, and its
    /// derivatives with central differences of `c`, over (−π, π).
    ///
    /// Errors are relative to the value plus 1; for the second derivatives plus `curvature`, the size of the
    /// terms that cancel in them.
    pub fn check(
        model: &impl Aerodynamics,
        c: impl Fn(f64) -> (f64, f64),
        curvature: f64,
        tolerance: f64,
    ) {
        for n in -3130..3130 {
            let a = AngleOfAttack::from_radians(n as f32 * 1e-3 + 0.000_31);
            let alpha = f64::from(a.rad);
            let got = model.coefficients(a);
            let h = 3e-5;
            let (p, o, m) = (c(alpha + h), c(alpha), c(alpha - h));
            let first = |p: f64, m: f64| (p - m) / (2.0 * h);
            let second = |p: f64, o: f64, m: f64| (p - 2.0 * o + m) / (h * h);
            for (what, got, want, scale) in [
                ("c_l", got.c_l, o.0, 1.0),
                ("c_d", got.c_d, o.1, 1.0),
                ("dc_l", got.dc_l, first(p.0, m.0), 1.0),
                ("dc_d", got.dc_d, first(p.1, m.1), 1.0),
                ("ddc_l", got.ddc_l, second(p.0, o.0, m.0), curvature),
                ("ddc_d", got.ddc_d, second(p.1, o.1, m.1), curvature),
            ] {
                let error = (f64::from(got) - want).abs() / (scale + want.abs());
                assert!(
                    error < tolerance,
                    "{what} at {alpha}: {got} is not {want}, off by {error:e}"
                );
            }
        }
    }
}
