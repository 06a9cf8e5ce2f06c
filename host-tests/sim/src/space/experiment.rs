//! An experiment in space: the fields of one in the plane, with a path in place of the reference and vectors of three
//! components.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::controller::Controller;
use super::plant::{Rotation, SpatialPlant};
use super::weather::WeatherSpec;
use super::{FIGURES, InitialSpec, PathSpec, SensorSpec, V3};
use crate::experiment::{
    self, Document, FieldError, VehicleSpec, check_steps, finite, require, thrust_limits,
};

/// A flight in space. The format is described in this package's README.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// One line for reports.
    #[serde(default)]
    pub description: String,
    /// Length of the flight \[s\].
    pub duration_s: f64,
    /// Length of its beginning that root mean squares and peaks leave out \[s\].
    #[serde(default)]
    pub entry_s: f64,
    /// Rate of the control steps \[Hz\]; commands are held in between.
    #[serde(default = "experiment::hundred")]
    pub control_rate_hz: f64,
    /// Runge–Kutta steps of the plant per control step.
    #[serde(default = "experiment::five")]
    pub substeps: u32,
    /// Seed of noise, turbulence and scatter.
    #[serde(default)]
    pub seed: u64,
    /// The true vehicle.
    pub vehicle: VehicleSpec,
    /// Its actuators.
    #[serde(default)]
    pub plant: PlantSpec,
    /// What the guidance is told.
    #[serde(default)]
    pub sensors: SensorSpec,
    /// The air.
    #[serde(default)]
    pub weather: WeatherSpec,
    /// Who closes the loop.
    #[serde(default)]
    pub controller: Controller,
    /// What is to be flown.
    pub path: PathSpec,
    /// Where the flight starts.
    #[serde(default)]
    pub initial: InitialSpec,
    /// Greatest values of figures, by name.
    #[serde(default)]
    pub bounds: BTreeMap<String, f64>,
}

/// `[plant]` in space: inertia and torque about belly, right wing and tail.
pub type PlantSpec = experiment::PlantSpec<[f64; 3]>;

impl Experiment {
    /// The experiment of a document; an error names file and line.
    pub fn of(document: &Document) -> anyhow::Result<Self> {
        Self::checked(document).map_err(|error| document.located(error))
    }

    /// The same; an error names the field alone.
    pub fn checked(document: &Document) -> Result<Self, FieldError> {
        let experiment = document.read::<Self>()?;
        experiment.validate()?;
        Ok(experiment)
    }

    fn validate(&self) -> Result<(), FieldError> {
        check_steps(self.duration_s, self.control_rate_hz, self.substeps)?;
        let within = (0.0..self.duration_s).contains(&self.entry_s);
        require(within, "entry_s", "must be from 0 to before duration_s")?;
        self.vehicle.core().map_err(|e| e.inside("vehicle"))?;
        let dt = 1.0 / self.control_rate_hz / f64::from(self.substeps);
        self.plant.validate(dt)?;
        self.controller.guidance(self)?;
        self.sensors.validate()?;
        self.weather.validate()?;
        self.path.path()?;
        self.initial.validate()?;
        for (name, &bound) in &self.bounds {
            let field = format!("bounds.{name}");
            finite(&field, bound)?;
            let known = FIGURES.iter().any(|figure| figure.name == name);
            require(known, field, "is not the name of a figure")?;
        }
        Ok(())
    }

    /// The true vehicle with its actuators.
    pub fn plant(&self) -> SpatialPlant {
        SpatialPlant {
            vehicle: self.vehicle.reference(),
            c_y: self.vehicle.c_y,
            thrust_lag: self.plant.thrust_lag_s,
            thrust: self.plant.thrust_n,
            rate: f64::INFINITY,
            rotation: Rotation::of(&self.plant.rate_loop, V3::from, Rotation::Ideal),
        }
    }

    /// Least and most thrust \[N\] that the guidance may command.
    pub(super) fn thrust_limits(&self, given: Option<[f64; 2]>, weight: f64) -> [f64; 2] {
        thrust_limits(given.unwrap_or(self.plant.thrust_n), weight)
    }

    /// Number of control periods flown.
    pub fn steps(&self) -> usize {
        (self.duration_s * self.control_rate_hz).round() as usize
    }
}
