//! Sensors: noise, bias and quantisation of what the controller is told.

use alula::guidance::Air;
use alula::ned::{BodyAxes, Frd, Ned, Quaternion};
use alula::spatial::Orientation;
use nalgebra::UnitQuaternion;
use rand::Rng;
use schemars::JsonSchema;
use serde::Deserialize;

use super::document::{FieldError, require, sensor_error};
use super::estimates::{Estimates, EstimatorSpec};
use super::faults::FaultSpec;
use super::normal::normal;
use super::plant::State;
use super::vector::ned;
use super::{V3, attitude_to_frd};
use crate::named::built_in;

/// Name and TOML text of built-in sensors, which `sensors = "NAME"` takes over.
pub const SENSORS: &[(&str, &str)] = built_in! { "sensors", ".toml";
    "exact",
    "autopilot",
};

/// Errors of one measured quantity, in its unit: value + bias + noise, rounded to whole steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ErrorSpec {
    /// Constant.
    pub bias: f64,
    /// Standard deviation of white noise, anew at every control step.
    pub noise: f64,
    /// Quantum; 0 for none.
    pub quantum: f64,
}

/// Which knowledge of the air reaches the controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AirSensor {
    /// The air velocity, as of a probe.
    #[default]
    Velocity,
    /// The steady wind, as of a forecast.
    SteadyWind,
    /// The level wind, as an autopilot estimates it: behind by `estimator.wind_lag_s`.
    WindEstimate,
    /// The airspeed along the nose, as a pitot tube tells it, and the level wind estimated.
    Pitot,
    /// Nothing.
    None,
}

/// `[sensors.pitot]`: where a pitot tube along the nose tells the airspeed. Both numbers are assumed.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PitotSpec {
    /// Airspeed along the nose \[m/s\] below which the pressure is too small.
    pub least_m_s: f64,
    /// Angle between nose and air velocity \[°\] beyond which the tube tells nothing.
    pub cone_deg: f64,
}

impl Default for PitotSpec {
    fn default() -> Self {
        Self {
            least_m_s: 5.0,
            cone_deg: 35.0,
        }
    }
}

impl PitotSpec {
    fn validate(&self) -> Result<(), FieldError> {
        let (least, cone) = ("sensors.pitot.least_m_s", "sensors.pitot.cone_deg");
        sensor_error(least, self.least_m_s)?;
        require(self.least_m_s >= 0.0, least, "must not be negative")?;
        let held = (0.0..=90.0).contains(&self.cone_deg);
        require(held, cone, "must be from 0 to 90 degrees")
    }

    /// The airspeed along the `nose` \[m/s\] in an air velocity `air`; NaN where the tube tells nothing.
    fn told(&self, nose: V3, air: V3) -> f64 {
        let along = nose.dot(&air);
        let inside = along >= air.norm() * libm::cos(self.cone_deg.to_radians());
        if inside && along >= self.least_m_s {
            along
        } else {
            f64::NAN
        }
    }
}

/// Whether the position, or the specific force, is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Sensor {
    /// It is.
    #[default]
    Measured,
    /// Nothing is known of it.
    None,
}

impl Sensor {
    /// What it tells of a `value`.
    pub(crate) fn told<T>(self, value: T) -> Option<T> {
        (self == Self::Measured).then_some(value)
    }
}

/// `[sensors]`: errors of each component.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
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
    /// The pitot tube.
    pub pitot: PitotSpec,
    /// The estimator.
    pub estimator: EstimatorSpec,
    /// What is known of the position.
    pub position: Sensor,
    /// What is known of the specific force.
    pub accelerometer: Sensor,
    /// Faults injected.
    pub faults: Vec<FaultSpec>,
}

impl ErrorSpec {
    pub(crate) fn apply(&self, value: f64, random: &mut impl Rng) -> f64 {
        // Drawn in any case: the stream of numbers does not depend on which errors are on.
        let value = value + self.bias + self.noise * normal(random);
        if self.quantum > 0.0 {
            (value / self.quantum).round() * self.quantum
        } else {
            value
        }
    }
}

/// Checks `[sensors]`: its `errors` by their names, and its faults.
fn validate(errors: &[(&str, &ErrorSpec)], faults: &[FaultSpec]) -> Result<(), FieldError> {
    for (name, error) in errors {
        sensor_error(&format!("sensors.{name}.bias"), error.bias)?;
        for (part, value) in [("noise", error.noise), ("quantum", error.quantum)] {
            let field = format!("sensors.{name}.{part}");
            sensor_error(&field, value)?;
            require(value >= 0.0, field, "must not be negative")?;
        }
    }
    for (i, fault) in faults.iter().enumerate() {
        fault.validate(&format!("sensors.faults[{i}]"))?;
    }
    Ok(())
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
    /// Specific force \[m/s²\].
    pub specific_force: Option<Frd>,
}

impl Measured {
    /// The attitude as the core takes it.
    pub fn orientation(&self) -> Orientation {
        orientation(&attitude_to_frd(&self.attitude))
    }
}

/// An attitude (from forward, right, down to north-east-down) as the core takes it: in single precision, as traces and logs are read too, so
/// that a replay sees the same bits.
pub(crate) fn orientation(q: &nalgebra::Quaternion<f64>) -> Orientation {
    let [w, x, y, z] = [q.w, q.i, q.j, q.k].map(|x| x as f32);
    let q = Quaternion { w, x, y, z };
    Orientation::from_quaternion(&q, BodyAxes::NoseForward).unwrap_or(Orientation::UNKNOWN)
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
        self.pitot.validate()?;
        self.estimator.validate()?;
        validate(&errors, &self.faults)
    }

    /// What is measured of `truth` and its specific force `force` along (i, j, w) in `wind`, which is `steady` but for gusts and
    /// turbulence, `dt` \[s\] after the last. `in_plane` keeps the errors in the vertical plane to the north.
    #[expect(clippy::too_many_arguments)]
    pub fn measure(
        &self,
        truth: &State,
        force: V3,
        wind: V3,
        steady: V3,
        in_plane: bool,
        (random, estimates): (&mut impl Rng, &mut Estimates),
        dt: f64,
    ) -> Measured {
        // The components that have errors, in the order in which these are drawn.
        let [world, turns, along]: [&[usize]; 3] = match in_plane {
            true => [&[2, 0], &[1], &[0, 1]],
            false => [&[0, 1, 2]; 3],
        };
        let mut told = |error: &ErrorSpec, mut v: V3, components: &[usize]| {
            for &i in components {
                v[i] = error.apply(v[i], random);
            }
            v
        };
        let velocity = told(&self.velocity_m_s, truth.velocity, world);
        let position = told(&self.position_m, truth.position, world);
        let turn = told(&self.attitude_deg, V3::zeros(), turns).map(f64::to_radians);
        let air = told(&self.air_m_s, truth.velocity - wind, world);
        let f = told(&self.acceleration_m_s2, force, along);
        let wind = estimates.wind(&self.estimator, truth.velocity - air, steady, dt);
        let [velocity, position] = estimates.motion(&self.estimator, [velocity, position], dt);
        let drift = estimates.turn(&self.estimator, in_plane, dt);
        let [tail, ..] = truth.axes();
        Measured {
            velocity,
            position,
            attitude: truth.attitude * UnitQuaternion::from_scaled_axis(turn) * drift,
            air: match self.air {
                AirSensor::Velocity => Air::Velocity(ned(air)),
                AirSensor::SteadyWind => Air::Wind(ned(steady)),
                AirSensor::WindEstimate => Air::Wind(ned(wind)),
                AirSensor::Pitot => Air::Pitot {
                    airspeed: self.pitot.told(-tail, air) as f32,
                    wind: ned(wind),
                },
                AirSensor::None => Air::Unknown,
            },
            specific_force: (self.accelerometer).told(Frd::new(
                -f.x as f32,
                f.z as f32,
                f.y as f32,
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// The tube tells the part along the nose, from its least speed on and inside its cone.
    #[test]
    fn a_pitot_tube_tells_the_airspeed_along_the_nose() {
        let pitot = PitotSpec::default();
        let told = |along: f64, across: f64| pitot.told(V3::x(), V3::new(along, across, 0.0));
        assert_eq!(told(12.0, 6.0), 12.0);
        // 36° and 34°; too slow; from behind.
        assert!(told(10.0, 7.27).is_nan() && told(10.0, 6.74) == 10.0);
        assert!(told(4.9, 0.0).is_nan() && told(-12.0, 0.0).is_nan());
    }

    #[test]
    fn errors_add_up_and_are_rounded() {
        let random = &mut ChaCha8Rng::seed_from_u64(3);
        let exact = ErrorSpec::default();
        assert_eq!(exact.apply(1.234, random), 1.234);
        let error = ErrorSpec {
            bias: 0.5,
            noise: 0.2,
            quantum: 0.25,
        };
        let n = 20_000;
        let values: Vec<_> = (0..n).map(|_| error.apply(1.0, random)).collect();
        assert!(values.iter().all(|v| (v / 0.25).fract() == 0.0));
        let mean = values.iter().sum::<f64>() / f64::from(n);
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n);
        // Four standard errors. Sheppard's correction adds quantum²/12 to the variance.
        assert!((mean - 1.5).abs() < 6e-3);
        assert!((variance - (0.04 + 0.25 * 0.25 / 12.0)).abs() < 2e-3);
    }
}
