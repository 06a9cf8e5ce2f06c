//! Experiments: what is flown, by whom, along which path, in which weather. TOML in, validated values out; plain data.
//!
//! World vectors are [north, east, down]. An experiment of which nothing points to the east, with its path given by knots, is one in the
//! vertical plane to the north ([`Experiment::in_plane`]).

mod controller;
mod document;
mod dryden;
mod estimates;
mod expected;
mod faults;
mod initial;
mod knots;
mod mission;
mod normal;
mod parameters;
mod path;
pub mod plan;
mod plant;
mod route;
mod sensors;
pub mod tail_sitter;
mod variation;
mod vector;
mod vehicle;
mod weather;

use std::collections::BTreeMap;

use alula::guidance::{MAX_STEP, MIN_STEP};
use alula_bridges::sitl::Actuators;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::Deserialize;

pub use controller::ControllerSpec;
use document::positive;
pub(crate) use document::value_at;
pub use document::{Document, FieldError, Located};
pub use document::{angle, assigned, finite, from_toml, read, require};
pub use estimates::{Estimates, EstimatorSpec};
pub(crate) use expected::places;
pub use faults::Faults;
pub use faults::{FaultKind, FaultSpec};
pub use initial::{InitialSpec, Scatter};
pub use knots::{Knot, Knots};
pub use mission::{ItemSpec, MissionSpec, TroubleKind, TroubleSpec};
pub use parameters::{Fields, file_name, file_value, refused};
pub use path::{Path, PathSpec, Target};
pub(crate) use plant::nose_forward;
pub use plant::{PlantSpec, RateLoop, State, attitude_to_frd, from_frd, to_frd};
pub(crate) use sensors::orientation;
pub use sensors::{AirSensor, ErrorSpec, Measured, PitotSpec, Sensor, SensorSpec};
pub use tail_sitter::{TailSitterPlant, TailSitterSpec};
pub use variation::Variation;
pub use vector::V3;
pub use vector::{double, ned};
pub use vehicle::{AerodynamicsSpec, AuthoritySpec, Model, NO_LIMITS, Vehicle, VehicleSpec};
pub use weather::{Gust, Turbulence, TurbulenceSpec, Weather, WeatherSpec};

use crate::named::built_in;

/// What is flown when nothing is asked for.
pub const DEFAULT: &str = "hover-to-cruise";

/// Name and TOML text of every built-in experiment. Those without a path are vehicles, for others to be based on.
pub const BUILT_IN: &[(&str, &str)] = built_in! { "experiments", ".toml";
    "paper",
    "paper-re-5e6",
    "paper-belief",
    "hover-to-cruise",
    "matched",
    "large-angle",
    "cruise-to-hover",
    "steep-climb",
    "round-trip",
    "round-trip-weak",
    "gentle-braking",
    "climbing-braking",
    "steep-descent",
    "rough-day",
    "space",
    "circle-40",
    "circle-40-slow",
    "circle-33",
    "eight",
    "climbing-turn",
    "waypoints",
    "cross-wind",
    "side-gust",
    "unknown-side-wind",
    "hover-cross-wind",
    "heading-steps",
    "transition-turned",
    "reversal",
    "mission",
    "mission-turbulence",
    "start-hover",
    "start-cruise",
    "cruise-in-air",
    "survey",
    "delivery",
    "loiter-watch",
    "inspection",
    "tail-sitter",
    "tail-sitter-hover",
    "tail-sitter-hover-wind",
    "tail-sitter-braking",
    "tail-sitter-climbing-braking",
    "tail-sitter-fall",
    "tail-sitter-circle",
};

/// A flight to simulate. The format is described in this package's README.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// One line for reports.
    #[serde(default)]
    pub description: String,
    /// Length of the flight \[s\].
    pub duration_s: f64,
    /// Length of its beginning that root mean squares and peaks leave out \[s\].
    #[serde(default)]
    pub settle_time_s: f64,
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
    /// The plant of kind `tail-sitter`, of which `vehicle` and `plant` are then what is believed.
    #[serde(skip)]
    pub tail_sitter: Option<TailSitterPlant>,
    /// What the controller is told.
    #[serde(default)]
    pub sensors: SensorSpec,
    /// The air.
    #[serde(default)]
    pub weather: WeatherSpec,
    /// Who closes the loop.
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, BTreeMap<String, f64>>")]
    pub controller: ControllerSpec,
    /// What is to be flown: `[path]`, or `[reference]`; none where a mission is.
    #[serde(alias = "reference", default = "stays")]
    pub path: PathSpec,
    /// What is to be flown, in the place of a path.
    pub mission: Option<MissionSpec>,
    /// Whether the path goes along with the level wind, as an autopilot estimates it: its speed is then an airspeed.
    #[serde(default)]
    pub path_in_air: bool,
    /// Where the flight starts.
    #[serde(default)]
    pub initial: InitialSpec,
    /// Elevons and motors, for an ArduPilot that flies the vehicle.
    #[serde(default)]
    pub ardupilot: Actuators,
    /// Greatest values of figures, by name.
    #[serde(default)]
    pub bounds: BTreeMap<String, f64>,
}

/// The path of an experiment with a mission.
fn stays() -> PathSpec {
    PathSpec::Hover {
        headings: Vec::new(),
    }
}

fn hundred() -> f64 {
    100.0
}

fn five() -> u32 {
    5
}

/// The random numbers of an experiment's `seed`, of which every part of a flight draws from a stream of its own: a change of one part leaves the others as they were.
pub fn stream(seed: u64, number: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(number);
    random
}

/// Most control steps of one flight: a record is held in memory.
const MAX_STEPS: f64 = 2e6;

/// Checks the number of control steps, and of the plant's steps in each.
fn check_steps(duration: f64, rate: f64, substeps: u32) -> Result<(), FieldError> {
    positive("duration_s", duration)?;
    positive("control_rate_hz", rate)?;
    let steps = duration * rate;
    let problem = format_args!("{steps} control steps, must be from 1 to {MAX_STEPS}");
    require((0.5..=MAX_STEPS).contains(&steps), "duration_s", problem)?;
    let possible = (1..=1000).contains(&substeps);
    require(possible, "substeps", "must be from 1 to 1000")
}

impl Experiment {
    /// Checks every field that the type system does not, but for the controller's.
    pub fn validate(&self) -> Result<(), FieldError> {
        check_steps(self.duration_s, self.control_rate_hz, self.substeps)?;
        let within = (0.0..self.duration_s).contains(&self.settle_time_s);
        require(
            within,
            "settle_time_s",
            "must be from 0 to before duration_s",
        )?;
        // The guidance refuses every frame with a longer or shorter step; the vehicle would fall.
        let step = 1.0 / self.control_rate_hz;
        let steps = f64::from(MIN_STEP)..=f64::from(MAX_STEP);
        let possible = self.controller.kind != "guidance" || steps.contains(&step);
        let problem = format_args!("the guidance flies steps of {MIN_STEP} to {MAX_STEP} s");
        require(possible, "control_rate_hz", problem)?;
        // A vehicle that the core would not control is not worth flying.
        self.vehicle.core().map_err(|e| e.inside("vehicle"))?;
        let dt = 1.0 / self.control_rate_hz / f64::from(self.substeps);
        self.plant.validate(dt)?;
        self.sensors.validate()?;
        self.weather.validate()?;
        self.path.path()?;
        if let Some(mission) = &self.mission {
            mission.validate()?;
        }
        self.initial.validate()?;
        for (name, &bound) in &self.bounds {
            finite(&format!("bounds.{name}"), bound)?;
        }
        let refused = |e: alula_bridges::sitl::Refused| FieldError::new(e.field, e.problem);
        let actuators = self.ardupilot.validate();
        actuators.map_err(|e| refused(e).inside("ardupilot"))
    }

    /// Whether nothing of it points out of the vertical plane to the north: path, steady wind, gust and start. Errors of sensors and
    /// turbulence stay in the plane then, and so does the flight.
    pub fn in_plane(&self) -> bool {
        let path = self.path.knots().is_some_and(Knots::in_plane);
        path && self.weather.in_plane() && self.initial.in_plane()
    }

    /// Least and most thrust \[N\] that a controller may command: `given`, or else what the motors give. Motors without limits are taken for
    /// none at least, and for those of twice the `weight` \[N\] that the controller believes in.
    pub fn thrust_limits(&self, given: Option<[f64; 2]>, weight: f64) -> [f64; 2] {
        self.plant.thrust_limits(given, weight)
    }

    /// Number of control periods flown.
    pub fn steps(&self) -> usize {
        (self.duration_s * self.control_rate_hz).round() as usize
    }

    /// The vehicle's weight m g \[N\].
    pub fn weight(&self) -> f64 {
        self.vehicle.weight()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_is_valid() {
        for (name, _) in BUILT_IN {
            let document = Document::load(name).unwrap();
            if document.is_flight() {
                document.checked().unwrap();
            }
        }
    }

    /// An experiment of one's own takes ten lines.
    #[test]
    fn omitted_fields_have_defaults() {
        let text = "duration_s = 20\n\
            [vehicle]\nmass_kg = 3.0\nk_a_kg_m = 0.2\n\
            [plant]\nthrust_n = [0.0, 47.0]\n\
            [reference]\nknots = [{ t_s = 0, down_m_s = 0, forward_m_s = 0 }]\n";
        assert!(text.lines().count() < 10);
        let experiment: Experiment = from_toml("x", text, Experiment::validate).unwrap();
        assert_eq!(
            (experiment.control_rate_hz, experiment.substeps),
            (100.0, 5)
        );
        assert_eq!(experiment.controller.kind, "guidance");
        assert_eq!(experiment.plant.rate_loop, RateLoop::Ideal);
        assert_eq!(experiment.vehicle.gravity_m_s2, 9.81);
    }

    #[test]
    fn lengths_are_bounded() {
        let refused = |text: &str| {
            let mut document = Document::load("round-trip").unwrap();
            document.assign(text).unwrap();
            document.experiment().unwrap_err().to_string()
        };
        assert!(refused("control_rate_hz=1e9").starts_with("duration_s: 115"));
        assert!(refused("duration_s=-2").starts_with("duration_s: must be positive"));
        assert!(refused("substeps=0").starts_with("substeps: must be from 1"));
    }

    /// A time constant too short for the plant's steps, or a number beyond what a vehicle, its air and its sensors have, is refused by its field: the
    /// simulation would diverge, or say nothing of a vehicle.
    #[test]
    fn fields_with_which_the_plant_would_diverge_are_refused() {
        let refused = |text: &str| {
            let mut document = Document::load("round-trip").unwrap();
            document.assign(text).unwrap();
            document.experiment().unwrap_err().field
        };
        let lag = "plant.rate_loop.lag.time_constant_s";
        assert_eq!(refused(&format!("{lag}=1e-9")), lag);
        assert_eq!(refused("plant.thrust_lag_s=1e-9"), "plant.thrust_lag_s");
        assert_eq!(refused("control_rate_hz=1"), "control_rate_hz");
        let inertia = "plant.rate_loop.inertia";
        let table = "{moment_of_inertia_kg_m2=1.0,bandwidth_1_s=1e6,max_torque_n_m=1.0}";
        let field = format!("{inertia}.bandwidth_1_s");
        assert_eq!(refused(&format!("{inertia}={table}")), field);
        let knots = "reference.knots[2].forward_m_s";
        assert_eq!(refused(&format!("{knots}=1e30")), knots);
        assert_eq!(
            refused("weather.steady_m_s=[-500,0,0]"),
            "weather.steady_m_s"
        );
        assert_eq!(refused("initial.speed_m_s=1e6"), "initial.speed_m_s");
        let velocity = "initial.velocity_m_s";
        assert_eq!(refused(&format!("{velocity}=[0,0,1e6]")), velocity);
        assert_eq!(refused("initial.theta_deg=1e300"), "initial.theta_deg");
        let rates = "initial.body_rates_rad_s";
        assert_eq!(refused(&format!("{rates}=[0,-1e30,0]")), rates);
        let noise = "sensors.velocity_m_s.noise";
        assert_eq!(refused(&format!("{noise}=1e308")), noise);
    }
}
