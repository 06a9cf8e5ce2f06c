//! Vectors of an experiment: north, east, down.

use alula::ned::Ned;
use serde::{Deserialize, Deserializer, de};

use super::document::{FieldError, speed};

/// A vector in double precision: [north, east, down].
pub type V3 = nalgebra::Vector3<f64>;

/// A vector as the core takes it.
pub fn ned(v: V3) -> Ned {
    Ned::new(v.x as f32, v.y as f32, v.z as f32)
}

/// A vector of the core in double precision.
pub fn double(v: Ned) -> V3 {
    V3::new(v.north.into(), v.east.into(), v.down.into())
}

/// A vector in a file.
pub(crate) fn vector<'de, D: Deserializer<'de>>(from: D) -> Result<V3, D::Error> {
    let numbers = Vec::<f64>::deserialize(from)?;
    let three: Result<[f64; 3], _> = numbers.try_into();
    let length = |numbers: Vec<f64>| {
        let problem = format!("has {} numbers, must be [north, east, down]", numbers.len());
        de::Error::custom(problem)
    };
    three.map(V3::from).map_err(length)
}

/// The same, which may be left out.
pub(crate) fn optional_vector<'de, D: Deserializer<'de>>(from: D) -> Result<Option<V3>, D::Error> {
    vector(from).map(Some)
}

/// Every component must be one of a velocity that can be flown.
pub(crate) fn velocity(field: &str, v: &V3) -> Result<(), FieldError> {
    v.iter().try_for_each(|&x| speed(field, x))
}
