//! A scenario's vehicles, and what each becomes in the plant and in the core.

use alula_link::ModelParameters;
use serde::Deserialize;

use super::FieldError;
use crate::polar::Polar;
use crate::reference::{Aerodynamics, Vehicle};

/// `[vehicle]`, `[controller.vehicle]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleSpec {
    /// m \[kg\].
    pub mass_kg: f64,
    /// k_a = ρΣ/2 \[kg/m\].
    pub k_a_kg_m: f64,
    /// δ, from the zero-lift line to the thrust line \[°\].
    #[serde(default)]
    pub delta_deg: f64,
    /// g \[m/s²\].
    #[serde(default = "standard_gravity")]
    pub gravity_m_s2: f64,
    /// c_L and c_D.
    pub aerodynamics: AerodynamicsSpec,
}

fn standard_gravity() -> f64 {
    9.81
}

/// `[….aerodynamics.MODEL]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum AerodynamicsSpec {
    /// Large-α model.
    LargeAngle {
        /// c_0.
        c0: f64,
        /// c_1.
        c1: f64,
    },
    /// Small-α model.
    SmallAngle {
        /// c_0.
        c0: f64,
        /// c_2.
        c2: f64,
        /// c_3.
        c3: f64,
    },
    /// Both, blended.
    Combined {
        /// c_0.
        c0: f64,
        /// c_1.
        c1: f64,
        /// c_2.
        c2: f64,
        /// c_3.
        c3: f64,
        /// ᾱ \[°\].
        alpha_bar_deg: f64,
        /// k_L \[1/rad²\].
        k_l: f64,
        /// k_D \[1/rad²\].
        k_d: f64,
    },
    /// Measured coefficients, interpolated.
    Table {
        /// A built-in polar, or a CSV file.
        polar: Polar,
    },
}

impl AerodynamicsSpec {
    fn key(&self) -> &'static str {
        match self {
            Self::LargeAngle { .. } => "large-angle",
            Self::SmallAngle { .. } => "small-angle",
            Self::Combined { .. } => "combined",
            Self::Table { .. } => "table",
        }
    }

    /// The parameters, or the table that has none.
    pub(super) fn parameters(&self) -> Result<ModelParameters, &Polar> {
        Ok(match self {
            Self::LargeAngle { c0, c1 } => alula::LargeAngleParameters {
                c0: *c0 as f32,
                c1: *c1 as f32,
            }
            .into(),
            Self::SmallAngle { c0, c2, c3 } => alula::SmallAngleParameters {
                c0: *c0 as f32,
                c2: *c2 as f32,
                c3: *c3 as f32,
            }
            .into(),
            Self::Combined {
                c0,
                c1,
                c2,
                c3,
                alpha_bar_deg,
                k_l,
                k_d,
            } => alula::CombinedParameters {
                c0: *c0 as f32,
                c1: *c1 as f32,
                c2: *c2 as f32,
                c3: *c3 as f32,
                alpha_bar: alpha_bar_deg.to_radians() as f32,
                k_l: *k_l as f32,
                k_d: *k_d as f32,
            }
            .into(),
            Self::Table { polar } => return Err(polar),
        })
    }

    fn control_model(&self) -> Result<alula::Model, alula::ParameterError> {
        match self.parameters() {
            Ok(parameters) => parameters.model(),
            Err(polar) => Ok(alula::Model::Table(polar.core)),
        }
    }

    fn plant_model(&self) -> Aerodynamics {
        match *self {
            Self::LargeAngle { c0, c1 } => Aerodynamics::LargeAngle { c0, c1 },
            Self::SmallAngle { c0, c2, c3 } => Aerodynamics::SmallAngle { c0, c2, c3 },
            Self::Combined {
                c0,
                c1,
                c2,
                c3,
                alpha_bar_deg,
                k_l,
                k_d,
            } => Aerodynamics::Combined {
                c0,
                c1,
                c2,
                c3,
                alpha_bar: alpha_bar_deg.to_radians(),
                k_l,
                k_d,
            },
            Self::Table { polar } => Aerodynamics::Table(polar.reference),
        }
    }
}

impl VehicleSpec {
    /// The vehicle as the core takes it; `table` is where this one stands in the file.
    pub fn control_vehicle(&self, table: &str) -> Result<alula::Vehicle<alula::Model>, FieldError> {
        let aerodynamics = format!("{table}.aerodynamics.{}", self.aerodynamics.key());
        let model = self
            .aerodynamics
            .control_model()
            .map_err(|e| refused(&aerodynamics, e))?;
        alula::Vehicle::new(self.parameters(), model).map_err(|e| refused(table, e))
    }

    pub(super) fn parameters(&self) -> alula::VehicleParameters {
        alula::VehicleParameters {
            mass: self.mass_kg as f32,
            k_a: self.k_a_kg_m as f32,
            delta: self.delta_deg.to_radians() as f32,
            gravity: self.gravity_m_s2 as f32,
        }
    }

    /// The vehicle as the plant flies it.
    pub fn plant_vehicle(&self) -> Vehicle {
        Vehicle {
            mass: self.mass_kg,
            k_a: self.k_a_kg_m,
            delta: self.delta_deg.to_radians(),
            gravity: self.gravity_m_s2,
            aerodynamics: self.aerodynamics.plant_model(),
        }
    }
}

/// A refusal by the core, under the scenario's name of the field: the core's name and a unit.
pub(super) fn refused(table: &str, error: alula::ParameterError) -> FieldError {
    let unit = match error.parameter {
        "mass" => "_kg",
        "k_a" => "_kg_m",
        "delta" | "alpha_bar" => "_deg",
        "gravity" => "_m_s2",
        "tau" => "_n",
        _ => "",
    };
    FieldError::new(
        format!("{table}.{}{unit}", error.parameter),
        error.to_string(),
    )
}
