//! Scenarios: what is flown, by whom, along which reference. TOML in, validated values out.

mod builtin;
mod load;
mod parts;
mod steps;
mod vehicle;

use alula_link::{Configuration, Pacing};
use serde::Deserialize;

pub use builtin::{BUILT_IN, DEFAULT};
pub use load::Source;
pub(crate) use load::from_toml;
pub use parts::{ControllerSpec, GainsSpec, InitialSpec, Knot, Law, ReferenceSpec, WindSpec};
pub(crate) use steps::{steps, validate_steps};
pub use vehicle::{AerodynamicsSpec, VehicleSpec};

use crate::plant::{Plant, PlantState};
use crate::reference::Vector;

/// A value of the scenario that was refused: the field's dotted name, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldError {
    /// Dotted path in the TOML file.
    pub field: String,
    /// What is wrong.
    pub problem: String,
}

impl FieldError {
    pub(crate) fn new(field: impl Into<String>, problem: impl Into<String>) -> Self {
        Self {
            field: field.into(),
            problem: problem.into(),
        }
    }
}

/// A flight to simulate. The format is described in this package's README.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// One line for reports.
    #[serde(default)]
    pub description: String,
    /// Length of the flight \[s\].
    pub duration_s: f64,
    /// Rate of the control steps \[Hz\]; commands are held in between.
    pub control_rate_hz: f64,
    /// Runge–Kutta steps of the plant per control step.
    #[serde(default = "one")]
    pub substeps: u32,
    /// The true vehicle.
    pub vehicle: VehicleSpec,
    /// The controller.
    pub controller: ControllerSpec,
    /// The reference velocity.
    pub reference: ReferenceSpec,
    /// The true wind, which the controller is told.
    #[serde(default)]
    pub wind: WindSpec,
    /// Where the flight starts.
    #[serde(default)]
    pub initial: InitialSpec,
}

fn one() -> u32 {
    1
}

impl Scenario {
    /// Checks every field that the type system does not.
    pub fn validate(&self) -> Result<(), FieldError> {
        validate_steps(self.duration_s, self.control_rate_hz, self.substeps)?;
        // A vehicle that the core would not control is not worth flying.
        self.vehicle.control_vehicle("vehicle")?;
        self.control()?;
        self.reference.validate()?;
        finite("wind.down_m_s", self.wind.down_m_s)?;
        finite("wind.forward_m_s", self.wind.forward_m_s)?;
        self.initial.validate()
    }

    /// The control law's core, with the controller's belief about the vehicle.
    pub fn control(&self) -> Result<alula::VelocityControl<alula::Model>, FieldError> {
        let vehicle = match &self.controller.vehicle {
            Some(belief) => belief.control_vehicle("controller.vehicle")?,
            None => self.vehicle.control_vehicle("vehicle")?,
        };
        let gains = self.controller.gains.control_gains("controller.gains")?;
        Ok(alula::VelocityControl::new(vehicle, gains))
    }

    /// The same controller, as a target is told of it. Tables are not sent over the link.
    pub fn configuration(&self, pacing: Pacing) -> Result<Configuration, FieldError> {
        let (table, belief) = match &self.controller.vehicle {
            Some(belief) => ("controller.vehicle", belief),
            None => ("vehicle", &self.vehicle),
        };
        let model = belief.aerodynamics.parameters().map_err(|polar| {
            let problem = format!("{}: a link carries no tables", polar.name);
            FieldError::new(format!("{table}.aerodynamics.table"), problem)
        })?;
        Ok(Configuration::new(
            belief.parameters(),
            model,
            self.controller.gains.parameters(),
            match self.controller.law {
                Law::Robust => alula_link::Law::Robust,
                Law::Full => alula_link::Law::Full,
            },
            pacing,
        ))
    }

    /// The true vehicle in its wind.
    pub fn plant(&self) -> Plant {
        Plant {
            vehicle: self.vehicle.plant_vehicle(),
            wind: Vector::new(self.wind.down_m_s, self.wind.forward_m_s),
        }
    }

    /// The plant's first state.
    pub fn initial_state(&self) -> PlantState {
        PlantState {
            velocity: Vector::new(self.initial.down_m_s, self.initial.forward_m_s),
            theta: self.initial.theta_deg.to_radians(),
        }
    }

    /// Number of control periods flown.
    pub fn steps(&self) -> usize {
        steps(self.duration_s, self.control_rate_hz)
    }
}

pub(crate) fn finite(field: &str, value: f64) -> Result<(), FieldError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(FieldError::new(field, "must be a finite number"))
    }
}

pub(crate) fn positive(field: &str, value: f64) -> Result<(), FieldError> {
    finite(field, value)?;
    if value > 0.0 {
        Ok(())
    } else {
        Err(FieldError::new(field, "must be positive"))
    }
}
