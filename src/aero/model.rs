//! A model chosen at run time.

use super::{
    Aerodynamics, Coefficients, Combined, CombinedParameters, LargeAngle, LargeAngleParameters,
    SmallAngle, SmallAngleParameters, Table,
};
use crate::air::AngleOfAttack;
use crate::error::ParameterError;

/// One of the core's models, where the choice is data: an experiment file, a parameter block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Model<'a> {
    /// `coeffSmallReynolds1`.
    LargeAngle(LargeAngle),
    /// `coeffLargeReynoldsSamllAlpha1`.
    SmallAngle(SmallAngle),
    /// `CompleteModel`.
    Combined(Combined),
    /// Measured coefficients, interpolated.
    Table(Table<'a>),
}

impl Aerodynamics for Model<'_> {
    #[inline(always)]
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
        match self {
            Self::LargeAngle(m) => m.coefficients(alpha),
            Self::SmallAngle(m) => m.coefficients(alpha),
            Self::Combined(m) => m.coefficients(alpha),
            Self::Table(m) => m.coefficients(alpha),
        }
    }
}

/// Parameters of a model that has no table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ModelParameters {
    /// Of [`LargeAngle`].
    LargeAngle(LargeAngleParameters),
    /// Of [`SmallAngle`].
    SmallAngle(SmallAngleParameters),
    /// Of [`Combined`].
    Combined(CombinedParameters),
}

impl ModelParameters {
    /// The model with these parameters.
    ///
    /// # Errors
    /// As the model's constructor.
    pub fn model(&self) -> Result<Model<'static>, ParameterError> {
        Ok(match *self {
            Self::LargeAngle(p) => Model::LargeAngle(LargeAngle::new(p)?),
            Self::SmallAngle(p) => Model::SmallAngle(SmallAngle::new(p)?),
            Self::Combined(p) => Model::Combined(Combined::new(p)?),
        })
    }
}
