//! Flights in space: what [`experiment`](mod@crate::experiment) to [`figures`](mod@crate::figures) and the page are to a vertical plane.
//!
//! An experiment with a `[path]` is flown here, by the guidance on a vehicle with six degrees of freedom. World vectors are
//! [north, east, down].

pub mod columns;
mod controller;
mod experiment;
mod figures;
mod flight_log;
mod initial;
mod path;
mod plant;
mod route;
mod sensors;
mod simulate;
mod telling;
mod weather;

pub use controller::Pilot;
pub use experiment::{Experiment, PlantSpec};
pub use figures::{FIGURES, Figure, Figures};
pub use initial::{InitialSpec, Scatter};
pub use path::{Path, PathSpec, Target};
pub use plant::{Rotation, SpatialPlant, SpatialState};
pub use sensors::SensorSpec;
pub use simulate::{Record, Step, fly, fly_by};
pub use weather::{Gust, Turbulence, Weather, WeatherSpec};

use serde::{Deserialize, Deserializer};

use crate::experiment::{FieldError, speed};

/// A vector in space.
pub type V3 = nalgebra::Vector3<f64>;

/// A vector in a file.
fn vector<'de, D: Deserializer<'de>>(from: D) -> Result<V3, D::Error> {
    <[f64; 3]>::deserialize(from).map(V3::from)
}

/// Every component must be one of a velocity that can be flown.
fn velocity(field: &str, v: &V3) -> Result<(), FieldError> {
    v.iter().try_for_each(|&x| speed(field, x))
}

/// A vector as the core takes it.
pub fn ned(v: V3) -> alula::spatial::Ned {
    alula::spatial::Ned::new(v.x as f32, v.y as f32, v.z as f32)
}
