//! Vehicles, and what each becomes in the plant and in the core.

use alula::{
    CombinedParameters, LargeAngleParameters, ModelParameters, ParameterError, Parameters,
    SmallAngleParameters, VehicleParameters,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::FieldError;
use super::parameters::{degrees, double, refused};
use crate::polar::Polar;
use crate::reference::{self, Aerodynamics, Combined, LargeAngle, SmallAngle};

/// The core's models, chosen at run time.
pub type Model = alula::Model<'static>;
/// The core's vehicle.
pub type Vehicle = alula::Vehicle<Model>;

/// `[vehicle]`, and `[controller.….vehicle]`: what a controller believes.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
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
    /// What turns it, and thrust over airspeed, as a controller believes; full authority and thrust that never falls if left out.
    #[serde(default)]
    pub authority: AuthoritySpec,
}

/// `[….authority]`: the core's parameters of authority, surfaces and propellers.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct AuthoritySpec {
    /// Angular acceleration in pitch without thrust and airflow \[rad/s²\].
    pub constant_rad_s2: f64,
    /// Per thrust of the weight, of surfaces in the slipstream \[rad/s²\].
    pub slipstream_rad_s2: f64,
    /// Per difference of thrust of the weight \[rad/s²\].
    pub difference_rad_s2: f64,
    /// Per squared airspeed along the nose \[rad/m²\].
    pub airflow_rad_m2: f64,
    /// That of the wing across the flow, per squared airspeed \[rad/m²\].
    pub wing_moment_rad_m2: f64,
    /// Greatest rate about the nose times the airspeed \[rad m/s²\].
    pub roll_rad_m_s2: f64,
    /// Acceleration by the surfaces per angular acceleration \[m\].
    pub surface_reaction_m: f64,
    /// Speed that the propellers give the air in hover \[m/s\].
    pub hover_downwash_m_s: f64,
    /// Airspeed at which full throttle gives no thrust \[m/s\]; 0 if thrust never falls.
    pub zero_thrust_speed_m_s: f64,
}

impl Default for AuthoritySpec {
    fn default() -> Self {
        Self::of(&VehicleParameters::DEFAULT)
    }
}

impl AuthoritySpec {
    /// As `[….authority]`.
    pub fn table(&self) -> toml::Value {
        toml::Value::try_from(self).expect("numbers are values")
    }

    /// Those of the core's parameters.
    pub fn of(p: &VehicleParameters) -> Self {
        Self {
            constant_rad_s2: double(p.authority),
            slipstream_rad_s2: double(p.authority_slipstream),
            difference_rad_s2: double(p.authority_difference),
            airflow_rad_m2: double(p.authority_airflow),
            wing_moment_rad_m2: double(p.wing_moment),
            roll_rad_m_s2: double(p.roll_authority),
            surface_reaction_m: double(p.surface_reaction),
            hover_downwash_m_s: double(p.hover_downwash),
            zero_thrust_speed_m_s: double(p.zero_thrust_speed),
        }
    }
}

/// A refusal of the core's vehicle under the name that the field has in files.
fn vehicle_refused(error: ParameterError) -> FieldError {
    let refused = refused::<VehicleParameters>(error);
    let inside = match refused.field.as_str() {
        "authority_rad_s2" => Some("constant_rad_s2".to_owned()),
        "roll_authority_rad_m_s2" => Some("roll_rad_m_s2".to_owned()),
        "wing_moment_rad_m2"
        | "surface_reaction_m"
        | "hover_downwash_m_s"
        | "zero_thrust_speed_m_s" => Some(refused.field.clone()),
        name => name.strip_prefix("authority_").map(str::to_owned),
    };
    match inside {
        Some(name) => FieldError::new(name, refused.problem).inside("authority"),
        None => refused,
    }
}

fn standard_gravity() -> f64 {
    9.81
}

/// `[….aerodynamics.MODEL]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum AerodynamicsSpec {
    /// Large-angle model.
    LargeAngle(LargeAngle),
    /// Small-angle model.
    SmallAngle(SmallAngle),
    /// Both, blended.
    Combined(Combined),
    /// Measured coefficients, interpolated.
    Table {
        /// A built-in polar, or a CSV file.
        #[schemars(with = "crate::polar::Given")]
        polar: Polar,
    },
}

impl Default for AerodynamicsSpec {
    fn default() -> Self {
        Self::Combined(Combined::NACA_0021_RE_160E3)
    }
}

impl AerodynamicsSpec {
    /// Its name in documents.
    pub fn key(&self) -> &'static str {
        match self {
            Self::LargeAngle(_) => "large-angle",
            Self::SmallAngle(_) => "small-angle",
            Self::Combined(_) => "combined",
            Self::Table { .. } => "table",
        }
    }

    /// The model with the core's `parameters`.
    pub fn of(parameters: ModelParameters) -> Self {
        match parameters {
            ModelParameters::LargeAngle(p) => Self::LargeAngle(LargeAngle {
                c0: double(p.c0),
                c1: double(p.c1),
            }),
            ModelParameters::SmallAngle(p) => Self::SmallAngle(SmallAngle {
                c0: double(p.c0),
                c2: double(p.c2),
                c3: double(p.c3),
            }),
            ModelParameters::Combined(p) => Self::Combined(Combined {
                c0: double(p.c0),
                c1: double(p.c1),
                c2: double(p.c2),
                c3: double(p.c3),
                alpha_bar_deg: degrees(p.alpha_bar),
                k_l: double(p.k_l),
                k_d: double(p.k_d),
            }),
        }
    }

    /// The core's parameters. The error is a table, which has none.
    pub fn parameters(&self) -> Result<ModelParameters, &Polar> {
        Ok(match self {
            Self::LargeAngle(m) => ModelParameters::LargeAngle(LargeAngleParameters {
                c0: m.c0 as f32,
                c1: m.c1 as f32,
            }),
            Self::SmallAngle(m) => ModelParameters::SmallAngle(SmallAngleParameters {
                c0: m.c0 as f32,
                c2: m.c2 as f32,
                c3: m.c3 as f32,
            }),
            Self::Combined(m) => ModelParameters::Combined(
                CombinedParameters::DEFAULT
                    .c0(m.c0 as f32)
                    .c1(m.c1 as f32)
                    .c2(m.c2 as f32)
                    .c3(m.c3 as f32)
                    .alpha_bar(m.alpha_bar() as f32)
                    .k_l(m.k_l as f32)
                    .k_d(m.k_d as f32),
            ),
            Self::Table { polar } => return Err(polar),
        })
    }

    /// The model as the core takes it.
    pub fn core(&self) -> Result<Model, FieldError> {
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
            Self::LargeAngle(model) => Aerodynamics::LargeAngle(model),
            Self::SmallAngle(model) => Aerodynamics::SmallAngle(model),
            Self::Combined(model) => Aerodynamics::Combined(model),
            Self::Table { polar } => Aerodynamics::Table(polar.reference),
        }
    }
}

/// Thrust \[N\] (least, most) of a vehicle whose controller knows of no limits.
pub const NO_LIMITS: [f64; 2] = [-1e6, 1e6];

impl VehicleSpec {
    /// The vehicle with the core's parameters `p`; its thrust limits are not in it.
    pub fn of(p: &VehicleParameters, aerodynamics: AerodynamicsSpec) -> Self {
        Self {
            mass_kg: double(p.mass),
            k_a_kg_m: double(p.k_a),
            delta_deg: degrees(p.delta),
            c_y: double(p.c_y),
            gravity_m_s2: double(p.gravity),
            aerodynamics,
            authority: AuthoritySpec::of(p),
        }
    }

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
        alula::Vehicle::new(self.parameters(thrust), model).map_err(vehicle_refused)
    }

    /// The core's parameters, with `thrust` \[N\] (least, most).
    pub fn parameters(&self, thrust: [f64; 2]) -> VehicleParameters {
        VehicleParameters::DEFAULT
            .mass(self.mass_kg as f32)
            .k_a(self.k_a_kg_m as f32)
            .delta(self.delta_deg.to_radians() as f32)
            .c_y(self.c_y as f32)
            .gravity(self.gravity_m_s2 as f32)
            .thrust_min(thrust[0] as f32)
            .thrust_max(thrust[1] as f32)
            .authority(self.authority.constant_rad_s2 as f32)
            .authority_slipstream(self.authority.slipstream_rad_s2 as f32)
            .authority_difference(self.authority.difference_rad_s2 as f32)
            .authority_airflow(self.authority.airflow_rad_m2 as f32)
            .wing_moment(self.authority.wing_moment_rad_m2 as f32)
            .roll_authority(self.authority.roll_rad_m_s2 as f32)
            .surface_reaction(self.authority.surface_reaction_m as f32)
            .hover_downwash(self.authority.hover_downwash_m_s as f32)
            .zero_thrust_speed(self.authority.zero_thrust_speed_m_s as f32)
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

#[cfg(test)]
mod tests {
    use super::*;
    use alula::Parameters;

    /// There and back again, to the bit, every one with a value of its own.
    #[test]
    fn every_parameter_of_the_core_comes_back() {
        let mut p = VehicleParameters::PAPER;
        for (row, range) in VehicleParameters::RANGES.iter().enumerate() {
            // Halves and quarters: degrees and radians of the one angle aside, nothing is rounded.
            p.set(
                row,
                if range.unit == "rad" {
                    -0.3
                } else {
                    1.0 + 0.25 * row as f32
                },
            );
        }
        let spec = VehicleSpec::of(&p, AerodynamicsSpec::default());
        let thrust = [p.thrust_min, p.thrust_max].map(f64::from);
        assert_eq!(spec.parameters(thrust), p);
    }

    #[test]
    fn the_cores_parameters_come_back() {
        let models = [
            ModelParameters::LargeAngle(LargeAngleParameters::DEFAULT),
            ModelParameters::SmallAngle(SmallAngleParameters::DEFAULT),
            ModelParameters::Combined(CombinedParameters::PAPER_BELIEF),
        ];
        for (model, delta) in models.into_iter().zip([0.0, -0.3, 2.1]) {
            let p = VehicleParameters::PAPER_BELIEF.delta(delta);
            let spec = VehicleSpec::of(&p, AerodynamicsSpec::of(model));
            let thrust = [p.thrust_min, p.thrust_max].map(f64::from);
            assert_eq!(spec.parameters(thrust), p);
            assert_eq!(spec.model_parameters().unwrap(), model);
        }
        // As they stand in files, where these have a decimal of single precision.
        let paper = ModelParameters::Combined(CombinedParameters::NACA_0021_RE_160E3);
        assert_eq!(AerodynamicsSpec::of(paper), AerodynamicsSpec::default());
    }
}
