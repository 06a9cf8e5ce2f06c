//! Vehicles, and what each becomes in the plant and in the core.

use alula::{
    CombinedParameters, LargeAngleParameters, ModelParameters, SmallAngleParameters,
    VehicleParameters,
};
use serde::Deserialize;

use super::FieldError;
use super::parameters::refused;
use crate::polar::Polar;
use crate::reference::{self, Aerodynamics};

/// The core's models, chosen at run time.
pub type Model = alula::Model<'static>;
/// The core's vehicle.
pub type Vehicle = alula::Vehicle<Model>;

/// `[vehicle]`, and `[controller.….vehicle]`: what a controller believes.
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
    /// Side force coefficient c_Y. In a vertical plane it is not used.
    #[serde(default)]
    pub c_y: f64,
    /// g \[m/s²\].
    #[serde(default = "standard_gravity")]
    pub gravity_m_s2: f64,
    /// c_L and c_D; those of NACA 0021 at Re = 160e3 if left out.
    #[serde(default)]
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

impl Default for AerodynamicsSpec {
    /// NACA 0021 at Re = 160e3 (`coefficientsReL`).
    fn default() -> Self {
        Self::Combined {
            c0: 0.014,
            c1: 0.95,
            c2: 5.5,
            c3: 0.3,
            alpha_bar_deg: 11.0,
            k_l: 28.0,
            k_d: 167.0,
        }
    }
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
    pub fn parameters(&self) -> Result<ModelParameters, &Polar> {
        Ok(match *self {
            Self::LargeAngle { c0, c1 } => ModelParameters::LargeAngle(LargeAngleParameters {
                c0: c0 as f32,
                c1: c1 as f32,
            }),
            Self::SmallAngle { c0, c2, c3 } => ModelParameters::SmallAngle(SmallAngleParameters {
                c0: c0 as f32,
                c2: c2 as f32,
                c3: c3 as f32,
            }),
            Self::Combined {
                c0,
                c1,
                c2,
                c3,
                alpha_bar_deg,
                k_l,
                k_d,
            } => ModelParameters::Combined(CombinedParameters {
                c0: c0 as f32,
                c1: c1 as f32,
                c2: c2 as f32,
                c3: c3 as f32,
                alpha_bar: alpha_bar_deg.to_radians() as f32,
                k_l: k_l as f32,
                k_d: k_d as f32,
            }),
            Self::Table { ref polar } => return Err(polar),
        })
    }

    /// The model as the core takes it.
    fn core(&self) -> Result<Model, FieldError> {
        match self.parameters() {
            Ok(parameters) => parameters.model().map_err(|e| {
                let table = format!("aerodynamics.{}", self.key());
                // The other models' parameters are named as the combined one's.
                refused::<CombinedParameters>(e).inside(&table)
            }),
            Err(polar) => Ok(Model::Table(polar.core)),
        }
    }

    fn reference(&self) -> Aerodynamics {
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

/// Thrust \[N\] (least, most) of a vehicle whose controller knows of no limits.
pub const NO_LIMITS: [f64; 2] = [-1e6, 1e6];

impl VehicleSpec {
    /// The vehicle as the bare laws take it, which know of no thrust limits.
    pub fn core(&self) -> Result<Vehicle, FieldError> {
        self.limited(NO_LIMITS)
    }

    /// The parameters of the model. The error is a table, which has none.
    pub fn model_parameters(&self) -> Result<ModelParameters, FieldError> {
        let table = |_| FieldError::new("aerodynamics.table", "cannot be sent to a target");
        self.aerodynamics.parameters().map_err(table)
    }

    /// The vehicle as the guidance takes it, with `thrust` \[N\] (least, most).
    pub fn limited(&self, thrust: [f64; 2]) -> Result<Vehicle, FieldError> {
        let model = self.aerodynamics.core()?;
        alula::Vehicle::new(self.parameters(thrust), model).map_err(refused::<VehicleParameters>)
    }

    /// The core's parameters, with `thrust` \[N\] (least, most).
    pub fn parameters(&self, thrust: [f64; 2]) -> VehicleParameters {
        VehicleParameters {
            mass: self.mass_kg as f32,
            k_a: self.k_a_kg_m as f32,
            delta: self.delta_deg.to_radians() as f32,
            c_y: self.c_y as f32,
            gravity: self.gravity_m_s2 as f32,
            thrust_min: thrust[0] as f32,
            thrust_max: thrust[1] as f32,
        }
    }

    /// Weight m g \[N\].
    pub fn weight(&self) -> f64 {
        self.mass_kg * self.gravity_m_s2
    }

    /// The vehicle in double precision.
    pub fn reference(&self) -> reference::Vehicle {
        reference::Vehicle {
            mass: self.mass_kg,
            k_a: self.k_a_kg_m,
            delta: self.delta_deg.to_radians(),
            gravity: self.gravity_m_s2,
            aerodynamics: self.aerodynamics.reference(),
        }
    }
}
