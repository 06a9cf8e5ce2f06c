//! A model chosen at run time.

use super::{Aerodynamics, Coefficients, Combined, LargeAngle, SmallAngle, Table};
use crate::air::AngleOfAttack;

/// One of the core's models, where the choice is data: a scenario file, a parameter block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Model {
    /// `coeffSmallReynolds1`.
    LargeAngle(LargeAngle),
    /// `coeffLargeReynoldsSamllAlpha1`.
    SmallAngle(SmallAngle),
    /// `CompleteModel`.
    Combined(Combined),
    /// Measured coefficients, interpolated.
    Table(Table),
}

impl Aerodynamics for Model {
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
