//! The tables of a scenario, and what each becomes in the plant and in the core.

use serde::Deserialize;

use super::{FieldError, finite};
use crate::reference::{Aerodynamics, Gains, Vector, Vehicle};

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
}

impl AerodynamicsSpec {
    fn key(&self) -> &'static str {
        match self {
            Self::LargeAngle { .. } => "large-angle",
            Self::SmallAngle { .. } => "small-angle",
            Self::Combined { .. } => "combined",
        }
    }

    fn control_model(&self) -> Result<alula::Model, alula::ParameterError> {
        Ok(match *self {
            Self::LargeAngle { c0, c1 } => {
                alula::Model::LargeAngle(alula::LargeAngle::new(alula::LargeAngleParameters {
                    c0: c0 as f32,
                    c1: c1 as f32,
                })?)
            }
            Self::SmallAngle { c0, c2, c3 } => {
                alula::Model::SmallAngle(alula::SmallAngle::new(alula::SmallAngleParameters {
                    c0: c0 as f32,
                    c2: c2 as f32,
                    c3: c3 as f32,
                })?)
            }
            Self::Combined {
                c0,
                c1,
                c2,
                c3,
                alpha_bar_deg,
                k_l,
                k_d,
            } => alula::Model::Combined(alula::Combined::new(alula::CombinedParameters {
                c0: c0 as f32,
                c1: c1 as f32,
                c2: c2 as f32,
                c3: c3 as f32,
                alpha_bar: alpha_bar_deg.to_radians() as f32,
                k_l: k_l as f32,
                k_d: k_d as f32,
            })?),
        })
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
        let parameters = alula::VehicleParameters {
            mass: self.mass_kg as f32,
            k_a: self.k_a_kg_m as f32,
            delta: self.delta_deg.to_radians() as f32,
            gravity: self.gravity_m_s2 as f32,
        };
        alula::Vehicle::new(parameters, model).map_err(|e| refused(table, e))
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
fn refused(table: &str, error: alula::ParameterError) -> FieldError {
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

/// Which law is flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// `eq:inputsVCeR`.
    Robust,
    /// `lawsVGen`.
    Full,
}

/// `[controller]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerSpec {
    /// The law.
    pub law: Law,
    /// Whether the law is given the measured air acceleration and the reference's jerk.
    #[serde(default)]
    pub feed_forward: bool,
    /// What the controller believes about the vehicle; the truth if left out.
    pub vehicle: Option<VehicleSpec>,
    /// The gains.
    pub gains: GainsSpec,
}

/// `[controller.gains]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GainsSpec {
    /// k1 \[s/m\].
    pub k1: f64,
    /// k2 \[rad/(N·m)\].
    pub k2: f64,
    /// k3 \[rad/s\].
    pub k3: f64,
    /// τ \[N\].
    pub tau_n: f64,
}

impl GainsSpec {
    /// The gains as the core takes them; `table` is where they stand in the file.
    pub fn control_gains(&self, table: &str) -> Result<alula::Gains, FieldError> {
        alula::Gains::new(alula::GainParameters {
            k1: self.k1 as f32,
            k2: self.k2 as f32,
            k3: self.k3 as f32,
            tau: self.tau_n as f32,
        })
        .map_err(|e| refused(table, e))
    }

    /// The gains in double precision.
    pub fn reference_gains(&self) -> Gains {
        Gains {
            k1: self.k1,
            k2: self.k2,
            k3: self.k3,
            tau: self.tau_n,
        }
    }
}

/// `[reference]`: the reference velocity, linear between knots, constant before and after them.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceSpec {
    /// The knots, by increasing time.
    pub knots: Vec<Knot>,
}

/// One knot of the reference velocity.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Knot {
    /// Time \[s\].
    pub t_s: f64,
    /// Velocity down \[m/s\].
    pub down_m_s: f64,
    /// Velocity forward \[m/s\].
    pub forward_m_s: f64,
}

impl ReferenceSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        let error = |problem: String| Err(FieldError::new("reference.knots", problem));
        if self.knots.is_empty() {
            return error("must have at least one knot".into());
        }
        for (i, knot) in self.knots.iter().enumerate() {
            let field = format!("reference.knots[{i}]");
            finite(&field, knot.t_s)?;
            finite(&field, knot.down_m_s)?;
            finite(&field, knot.forward_m_s)?;
            if i > 0 && knot.t_s <= self.knots[i - 1].t_s {
                return Err(FieldError::new(
                    field,
                    "t_s must increase from knot to knot",
                ));
            }
        }
        Ok(())
    }

    /// Reference velocity \[m/s\] and acceleration \[m/s²\] at `t` \[s\]. At a knot the
    /// acceleration is that of the segment that begins there.
    pub fn at(&self, t: f64) -> (Vector, Vector) {
        let velocity = |k: &Knot| Vector::new(k.down_m_s, k.forward_m_s);
        let next = self.knots.partition_point(|k| k.t_s <= t);
        if next == 0 {
            (velocity(&self.knots[0]), Vector::zeros())
        } else if next == self.knots.len() {
            (velocity(&self.knots[next - 1]), Vector::zeros())
        } else {
            let (from, to) = (&self.knots[next - 1], &self.knots[next]);
            let slope = (velocity(to) - velocity(from)) / (to.t_s - from.t_s);
            (velocity(from) + slope * (t - from.t_s), slope)
        }
    }
}

/// `[wind]`: a steady wind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WindSpec {
    /// Down \[m/s\].
    pub down_m_s: f64,
    /// Forward \[m/s\]: positive is a tailwind.
    pub forward_m_s: f64,
}

/// `[initial]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct InitialSpec {
    /// Velocity down \[m/s\].
    pub down_m_s: f64,
    /// Velocity forward \[m/s\].
    pub forward_m_s: f64,
    /// θ \[°\].
    pub theta_deg: f64,
    /// Thrust just before the first control step \[N\]; it enters the first measured acceleration.
    pub thrust_n: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_is_linear_between_knots_and_held_outside() {
        let knot = |t_s, forward_m_s| Knot {
            t_s,
            down_m_s: -1.0,
            forward_m_s,
        };
        let reference = ReferenceSpec {
            knots: vec![knot(1.0, 0.0), knot(3.0, 4.0)],
        };
        let forward = |t| {
            let (v, a) = reference.at(t);
            assert_eq!(v.x, -1.0);
            (v.y, a.y)
        };
        assert_eq!(forward(0.0), (0.0, 0.0));
        assert_eq!(forward(1.0), (0.0, 2.0));
        assert_eq!(forward(2.5), (3.0, 2.0));
        assert_eq!(forward(3.0), (4.0, 0.0));
        assert_eq!(forward(9.0), (4.0, 0.0));
    }
}
