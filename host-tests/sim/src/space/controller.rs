//! `[controller.guidance]` in space: the same table as in the plane. And whoever flies: the guidance here, or on a target.

use alula::{
    GainChoice, Guidance, GuidanceInput, GuidanceOutput, GuidanceParameters, GuidanceState,
};
use alula_link::{Configuration, Pacing};
use serde::Deserialize;
use toml::{Table, Value};

use super::Experiment;
use crate::controllers::{Flying, GuidanceSpec};
use crate::experiment::{FieldError, Model, VehicleSpec};

/// `[controller]`: in space the guidance is the only controller.
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

    /// What `make` makes of belief, thrust limits and parameters.
    fn made<T>(
        &self,
        experiment: &Experiment,
        make: impl Fn(
            &GuidanceSpec,
            &VehicleSpec,
            [f64; 2],
            &GuidanceParameters,
        ) -> Result<T, FieldError>,
    ) -> Result<T, FieldError> {
        let made = || {
            let spec = GuidanceSpec::read(self.guidance.clone())?;
            let belief = spec.vehicle.as_ref().unwrap_or(&experiment.vehicle);
            let thrust = experiment.thrust_limits(spec.thrust_n, belief.weight());
            make(&spec, belief, thrust, &spec.parameters)
        };
        made().map_err(|e: FieldError| e.inside("controller.guidance"))
    }

    /// The guidance of `experiment`.
    pub fn guidance(
        &self,
        experiment: &Experiment,
    ) -> Result<Guidance<Model, GainChoice>, FieldError> {
        self.made(experiment, GuidanceSpec::build)
    }

    /// The same guidance as a target is told of it.
    pub fn configuration(
        &self,
        experiment: &Experiment,
        pacing: Pacing,
    ) -> Result<Configuration, FieldError> {
        self.made(experiment, |spec, belief, thrust, parameters| {
            spec.configured(belief, thrust, parameters, pacing)
        })
    }
}

/// Whoever answers a control step in space.
pub trait Pilot {
    /// The command for `input`, `dt` \[s\] after the last. The error is a pilot that cannot be reached.
    fn guided(&mut self, input: &GuidanceInput, dt: f32) -> anyhow::Result<GuidanceOutput>;

    /// One bit of its memory flips.
    fn flip(&mut self, _bit: u64) {}
}

impl Pilot for Flying {
    fn guided(&mut self, input: &GuidanceInput, dt: f32) -> anyhow::Result<GuidanceOutput> {
        Ok(self.guidance.update(&mut self.state, input, dt))
    }

    fn flip(&mut self, bit: u64) {
        self.flip_bit(bit);
    }
}

impl Experiment {
    /// Its own pilot, at power-on: the guidance.
    pub fn pilot(&self) -> Result<Flying, FieldError> {
        Ok(Flying {
            guidance: self.controller.guidance(self)?,
            state: GuidanceState::default(),
        })
    }
}
