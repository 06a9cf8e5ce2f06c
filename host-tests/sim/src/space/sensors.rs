//! What the guidance is told of a flight in space.

use std::f64::consts::FRAC_PI_2;

use alula::guidance::Air;
use alula::ned::{BodyAxes, Quaternion};
use alula::spatial::{Body, Ned, Orientation};
use nalgebra::UnitQuaternion;
use rand::Rng;
use serde::Deserialize;

use super::plant::SpatialState;
use super::{V3, ned};
use crate::experiment::{
    AirSensor, ErrorSpec, FaultSpec, FieldError, Sensor, validate_sensors as validate,
};

/// `[sensors]`: errors of each component.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensorSpec {
    /// Of the velocity \[m/s\].
    pub velocity_m_s: ErrorSpec,
    /// Of the position \[m\].
    pub position_m: ErrorSpec,
    /// Of the attitude, as rotations about the body axes \[°\].
    pub attitude_deg: ErrorSpec,
    /// Of the air velocity \[m/s\].
    pub air_m_s: ErrorSpec,
    /// Of the specific force \[m/s²\].
    pub acceleration_m_s2: ErrorSpec,
    /// What is known of the air.
    pub air: AirSensor,
    /// What is known of the position.
    pub position: Sensor,
    /// What is known of the specific force.
    pub accelerometer: Sensor,
    /// Faults injected.
    pub faults: Vec<FaultSpec>,
}

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// v \[m/s\].
    pub velocity: V3,
    /// x \[m\].
    pub position: V3,
    /// Attitude: from (belly, right wing, tail) to north-east-down.
    pub attitude: UnitQuaternion<f64>,
    /// What is known of the air.
    pub air: Air<Ned>,
    /// Specific force along tail, belly and right wing \[m/s²\].
    pub specific_force: Option<Body>,
}

impl Measured {
    /// The attitude as the core takes it: from a quaternion in single precision of the body whose x axis is the nose's, as logs are
    /// read too, so that a replay sees the same bits.
    pub fn orientation(&self) -> Orientation {
        let q = self.attitude * UnitQuaternion::from_axis_angle(&V3::y_axis(), FRAC_PI_2);
        let [w, x, y, z] = [q.w, q.i, q.j, q.k].map(|x| x as f32);
        let orientation =
            Orientation::from_quaternion(&Quaternion { w, x, y, z }, BodyAxes::NoseForward);
        orientation.expect("a unit quaternion")
    }
}

impl SensorSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        let errors = [
            ("velocity_m_s", &self.velocity_m_s),
            ("position_m", &self.position_m),
            ("attitude_deg", &self.attitude_deg),
            ("air_m_s", &self.air_m_s),
            ("acceleration_m_s2", &self.acceleration_m_s2),
        ];
        validate(&errors, &self.faults)
    }

    /// What is measured of `truth` and its specific force (along i, j, w) in `wind`, which is `steady` but for gusts and
    /// turbulence.
    pub(super) fn measure(
        &self,
        truth: &SpatialState,
        force: V3,
        wind: V3,
        steady: V3,
        random: &mut impl Rng,
    ) -> Measured {
        let mut told = |error: &ErrorSpec, v: V3| v.map(|x| error.apply(x, random));
        let velocity = told(&self.velocity_m_s, truth.velocity);
        let position = told(&self.position_m, truth.position);
        let error = told(&self.attitude_deg, V3::zeros()).map(f64::to_radians);
        let air = told(&self.air_m_s, truth.velocity - wind);
        let f = told(&self.acceleration_m_s2, force);
        let q = truth.attitude * UnitQuaternion::from_scaled_axis(error);
        Measured {
            velocity,
            position,
            attitude: q,
            air: self.air.told(|| ned(air), ned(steady)),
            specific_force: (self.accelerometer)
                .told(Body::new(f.x as f32, f.y as f32, f.z as f32)),
        }
    }
}
