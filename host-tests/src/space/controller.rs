//! `[controller.guidance]` in space: the same table as in the plane.

use alula::{GainChoice, Guidance};
use serde::Deserialize;
use toml::{Table, Value};

use super::Experiment;
use crate::controllers::GuidanceSpec;
use crate::experiment::{FieldError, Model, VehicleSpec};

/// `[controller]`: nobody but the guidance flies in space.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Controller {
    /// Its table.
    pub guidance: Value,
}

impl Default for Controller {
    fn default() -> Self {
        Self {
            guidance: Value::Table(Table::new()),
        }
    }
}

impl Controller {
    /// What the guidance believes about the vehicle, if that is not the experiment's.
    pub fn belief(&self) -> Result<Option<VehicleSpec>, FieldError> {
        let spec = GuidanceSpec::read(self.guidance.clone());
        Ok(spec.map_err(|e| e.inside("controller.guidance"))?.vehicle)
    }

    /// The guidance of `experiment`.
    pub fn guidance(
        &self,
        experiment: &Experiment,
    ) -> Result<Guidance<Model, GainChoice>, FieldError> {
        let made = || {
            let spec = GuidanceSpec::read(self.guidance.clone())?;
            let belief = spec.vehicle.as_ref().unwrap_or(&experiment.vehicle);
            let thrust = experiment
                .plant
                .thrust_limits(spec.thrust_n, belief.weight());
            spec.build(belief, thrust, &spec.parameters)
        };
        made().map_err(|e: FieldError| e.inside("controller.guidance"))
    }
}
