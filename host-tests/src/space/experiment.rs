//! An experiment in space: the fields of one in the plane, with a path in place of the reference and vectors of three
//! components.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::controller::Controller;
use super::plant::{Rotation, SpatialPlant};
use super::weather::WeatherSpec;
use super::{FIGURES, InitialSpec, PathSpec, SensorSpec, V3, vector};
use crate::experiment::{Document, FieldError, VehicleSpec, finite, positive, thrust_limits};

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
    #[serde(default = "hundred")]
    pub control_rate_hz: f64,
    /// Runge–Kutta steps of the plant per control step.
    #[serde(default = "five")]
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

fn hundred() -> f64 {
    100.0
}

fn five() -> u32 {
    5
}

/// How body rates follow their commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum RateLoop {
    /// They are the commands.
    #[default]
    Ideal,
    /// First order.
    Lag {
        /// \[s\].
        time_constant_s: f64,
    },
    /// Moments of inertia under a proportional inner loop with limited torques, each about belly, right wing and tail.
    Inertia {
        /// \[kg·m²\].
        #[serde(deserialize_with = "vector")]
        inertia_kg_m2: V3,
        /// \[1/s\].
        bandwidth_1_s: f64,
        /// \[N·m\].
        #[serde(deserialize_with = "vector")]
        torque_max_n_m: V3,
    },
}

/// `[plant]`: the actuators. Ideal if left out.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlantSpec {
    /// The rate loop.
    pub rate_loop: RateLoop,
    /// First-order lag of thrust \[s\]; 0 for none.
    pub thrust_lag_s: f64,
    /// Transport delay of the command \[s\], in whole steps of the plant.
    pub delay_s: f64,
    /// Least and most thrust that the motors give \[N\], whatever is commanded.
    pub thrust_n: [f64; 2],
}

impl Default for PlantSpec {
    fn default() -> Self {
        Self {
            rate_loop: RateLoop::Ideal,
            thrust_lag_s: 0.0,
            delay_s: 0.0,
            thrust_n: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
}

impl PlantSpec {
    fn validate(&self) -> Result<(), FieldError> {
        match &self.rate_loop {
            RateLoop::Ideal => {}
            RateLoop::Lag { time_constant_s } => {
                positive("plant.rate_loop.lag.time_constant_s", *time_constant_s)?;
            }
            RateLoop::Inertia {
                inertia_kg_m2,
                bandwidth_1_s,
                torque_max_n_m,
            } => {
                positive("plant.rate_loop.inertia.bandwidth_1_s", *bandwidth_1_s)?;
                for (name, v) in [
                    ("inertia_kg_m2", inertia_kg_m2),
                    ("torque_max_n_m", torque_max_n_m),
                ] {
                    let field = format!("plant.rate_loop.inertia.{name}");
                    v.iter().try_for_each(|&x| positive(&field, x))?;
                }
            }
        }
        for (field, value) in [
            ("plant.thrust_lag_s", self.thrust_lag_s),
            ("plant.delay_s", self.delay_s),
        ] {
            if !(0.0..=2.0).contains(&value) {
                return Err(FieldError::new(field, "must be from 0 to 2 s"));
            }
        }
        let [least, most] = self.thrust_n;
        // An infinite limit is none.
        if least.is_nan() || most.is_nan() || least >= most {
            return Err(FieldError::new("plant.thrust_n", "must be [least, most]"));
        }
        Ok(())
    }

    /// Least and most thrust \[N\] that the guidance may command.
    pub(super) fn thrust_limits(&self, given: Option<[f64; 2]>, weight: f64) -> [f64; 2] {
        thrust_limits(given.unwrap_or(self.thrust_n), weight)
    }
}

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
        positive("duration_s", self.duration_s)?;
        positive("control_rate_hz", self.control_rate_hz)?;
        let steps = self.duration_s * self.control_rate_hz;
        if !(0.5..=2e6).contains(&steps) {
            let problem = format!("{steps} control steps, must be from 1 to 2000000");
            return Err(FieldError::new("duration_s", problem));
        }
        if !(0.0..self.duration_s).contains(&self.entry_s) {
            return Err(FieldError::new(
                "entry_s",
                "must be from 0 to before duration_s",
            ));
        }
        if !(1..=1000).contains(&self.substeps) {
            return Err(FieldError::new("substeps", "must be from 1 to 1000"));
        }
        self.vehicle.core().map_err(|e| e.inside("vehicle"))?;
        self.plant.validate()?;
        self.controller.guidance(self)?;
        self.sensors.validate()?;
        self.weather.validate()?;
        self.path.path()?;
        self.initial.validate()?;
        for (name, &bound) in &self.bounds {
            let field = format!("bounds.{name}");
            finite(&field, bound)?;
            if !FIGURES.iter().any(|figure| figure.name == name) {
                return Err(FieldError::new(field, "is no figure"));
            }
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
            rotation: match self.plant.rate_loop {
                RateLoop::Ideal => Rotation::Ideal,
                RateLoop::Lag { time_constant_s } => Rotation::Lag(time_constant_s),
                RateLoop::Inertia {
                    inertia_kg_m2,
                    bandwidth_1_s,
                    torque_max_n_m,
                } => Rotation::Inertia {
                    lag: 1.0 / bandwidth_1_s,
                    inertia: inertia_kg_m2,
                    torque: torque_max_n_m,
                },
            },
        }
    }

    /// Number of control periods flown.
    pub fn steps(&self) -> usize {
        (self.duration_s * self.control_rate_hz).round() as usize
    }
}
