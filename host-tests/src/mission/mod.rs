//! Missions: the core's whole guidance on a vehicle with actuators, sensors, weather and faults.
//!
//! A [scenario](crate::scenario) asks what the law does to an ideal vehicle; a mission, whether a real one flies.

mod controller;
mod draft;
mod figures;
mod flight;
mod guidance;
mod output;
mod plant;
mod sensors;
mod weather;

use anyhow::Context;
use serde::Deserialize;

pub use controller::{Answer, ControllerSpec, Pilot, Report};
pub use draft::Draft;
pub use figures::{Figures, Segment, Steady};
pub use flight::{Row, fly};
pub use guidance::{
    BandwidthSpec, BranchSpec, GainChoiceSpec, GuidanceSpec, LimitSpec, MissionGuidance,
    PositionSpec, ReferenceLimitSpec, SupervisionSpec,
};
pub use output::{air_name, html, mode_name, svg, write_trace};
pub use plant::{ActuatorSpec, Plant, RateLoop, State};
pub use sensors::{AirSensor, ErrorSpec, FaultKind, FaultSpec, SensorSpec};
pub use weather::{GustSpec, TurbulenceSpec, Weather, WeatherSpec};

use crate::named::Named;
use crate::reference::Vector;
use crate::scenario::{
    FieldError, InitialSpec, ReferenceSpec, VehicleSpec, from_toml, steps, validate_steps,
};

/// Name and TOML text of every built-in mission.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("round-trip", include_str!("../../missions/round-trip.toml")),
    (
        "round-trip-weak",
        include_str!("../../missions/round-trip-weak.toml"),
    ),
    (
        "gentle-braking",
        include_str!("../../missions/gentle-braking.toml"),
    ),
    (
        "climbing-braking",
        include_str!("../../missions/climbing-braking.toml"),
    ),
    (
        "steep-descent",
        include_str!("../../missions/steep-descent.toml"),
    ),
    ("rough-day", include_str!("../../missions/rough-day.toml")),
];

/// A mission to fly. The format is described in this package's README.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mission {
    /// One line for reports.
    #[serde(default)]
    pub description: String,
    /// Length of the flight \[s\].
    pub duration_s: f64,
    /// Rate of the control steps \[Hz\]; commands are held in between.
    pub control_rate_hz: f64,
    /// Runge–Kutta steps of the plant per control step.
    pub substeps: u32,
    /// Seed of noise and turbulence.
    #[serde(default)]
    pub seed: u64,
    /// The true vehicle.
    pub vehicle: VehicleSpec,
    /// Its actuators.
    pub plant: ActuatorSpec,
    /// The controller.
    pub controller: ControllerSpec,
    /// What it is told.
    #[serde(default)]
    pub sensors: SensorSpec,
    /// The air.
    #[serde(default)]
    pub weather: WeatherSpec,
    /// The reference velocity; the reference position is its integral.
    pub reference: ReferenceSpec,
    /// Where the flight starts.
    #[serde(default)]
    pub initial: InitialSpec,
}

impl Mission {
    /// Checks every field that the type system does not.
    pub fn validate(&self) -> Result<(), FieldError> {
        validate_steps(self.duration_s, self.control_rate_hz, self.substeps)?;
        self.vehicle.control_vehicle("vehicle")?;
        self.plant.validate()?;
        self.controller.pilot(&self.vehicle)?;
        self.sensors.validate()?;
        self.weather.validate()?;
        self.reference.validate()?;
        self.initial.validate()
    }

    /// Number of control periods flown.
    pub fn steps(&self) -> usize {
        steps(self.duration_s, self.control_rate_hz)
    }

    /// The true vehicle with its actuators.
    pub fn plant(&self) -> Plant {
        Plant {
            vehicle: self.vehicle.plant_vehicle(),
            actuators: self.plant,
        }
    }

    /// The plant's first state.
    pub fn initial_state(&self) -> State {
        State {
            velocity: Vector::new(self.initial.down_m_s, self.initial.forward_m_s),
            position: Vector::zeros(),
            theta: self.initial.theta_deg.to_radians(),
            rate: 0.0,
            thrust: self.initial.thrust_n,
        }
    }
}

/// A mission with where it came from.
#[derive(Clone, Debug)]
pub struct MissionSource {
    /// Built-in name, or the file's name without its extension.
    pub name: String,
    /// Its TOML text.
    pub text: String,
    /// What it says.
    pub mission: Mission,
}

impl MissionSource {
    /// The mission that `argument` names: a built-in, or else a TOML file.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        let found = Named::find("mission", BUILT_IN, argument)?;
        Self::from_text(&found.name, &found.origin, &found.text)
    }

    /// The mission that the text `of` names: a file beside its own, or else what [`Self::load`] finds.
    pub fn named_in(of: &Named, argument: &str) -> anyhow::Result<Self> {
        let beside = of.file.as_ref().map(|file| file.with_file_name(argument));
        match beside.filter(|path| path.is_file()) {
            Some(path) => Self::load(&path.to_string_lossy()),
            None => Self::load(argument),
        }
        .with_context(|| format!("{}: mission", of.origin))
    }

    /// The mission in `text`; `origin` stands for it in errors.
    pub fn from_text(name: &str, origin: &str, text: &str) -> anyhow::Result<Self> {
        Ok(Self {
            name: name.to_owned(),
            text: text.to_owned(),
            mission: from_toml(origin, text, Mission::validate)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_is_valid() {
        for (name, text) in BUILT_IN {
            MissionSource::from_text(name, name, text).unwrap();
        }
    }

    /// A valid text with one line replaced: the message names that line.
    #[test]
    fn errors_name_line_and_field() {
        let (_, good) = BUILT_IN[0];
        let broken = |needle: &str, with: &str| {
            let lines: Vec<_> = good
                .lines()
                .map(|l| if l.contains(needle) { with } else { l })
                .collect();
            MissionSource::from_text("x", "x.toml", &lines.join("\n"))
                .unwrap_err()
                .to_string()
        };
        let line = |needle: &str| 1 + good.lines().position(|l| l.contains(needle)).unwrap();
        let expect = |needle: &str, with: &str, at: &str, message: &str| {
            let actual = broken(needle, with);
            let expected = format!("x.toml:{}: {message}", line(at));
            assert!(actual.starts_with(&expected), "{actual}\n{expected}");
        };
        expect(
            "damping =",
            "damping = 0.0",
            "[controller.guidance.gains.bandwidth]",
            "controller.guidance.gains.bandwidth: damping must be positive",
        );
        expect(
            "thrust_lag_s",
            "thrust_lag_s = -1",
            "thrust_lag_s",
            "plant.thrust_lag_s: must be from 0 to 2 s",
        );
        expect(
            "time_constant_s",
            "rate_loop.lag = { time_constant_s = 0 }",
            "rate_loop",
            "plant.rate_loop.lag.time_constant_s: must be positive",
        );
        expect(
            "fade_s",
            "fade = 1",
            "fade_s",
            "controller.guidance.branch.fade: unknown field",
        );
    }
}
