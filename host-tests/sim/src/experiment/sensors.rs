//! Sensors: noise, bias and quantisation of what the controller is told.

use alula::guidance::Air;
use alula::{Body, Inertial};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Deserialize;

use super::document::{FieldError, require, sensor_error};
use super::faults::{FaultKind, FaultSpec, Lasting, Told};
use super::plant::State;
use crate::controllers::inertial;
use crate::reference::Vector;

/// Errors of one measured quantity, in its unit: value + bias + noise, rounded to whole steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AirSensor {
    /// The air velocity, as of a probe.
    #[default]
    Velocity,
    /// The steady wind, as of a forecast.
    SteadyWind,
    /// Nothing.
    None,
}

impl AirSensor {
    /// What it tells of an air `velocity`, which is measured where it is told, and of a `steady` wind.
    pub(crate) fn told<V>(self, velocity: impl FnOnce() -> V, steady: V) -> Air<V> {
        match self {
            Self::Velocity => Air::Velocity(velocity()),
            Self::SteadyWind => Air::Wind(steady),
            Self::None => Air::Unknown,
        }
    }
}

/// Whether the position, or the specific force, is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
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

/// `[sensors]`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensorSpec {
    /// Of each component of the velocity \[m/s\].
    pub velocity_m_s: ErrorSpec,
    /// Of each component of the position \[m\].
    pub position_m: ErrorSpec,
    /// Of the attitude \[°\].
    pub theta_deg: ErrorSpec,
    /// Of each component of the air velocity \[m/s\].
    pub air_m_s: ErrorSpec,
    /// Of each component of the specific force \[m/s²\].
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

/// Checks `[sensors]`: its `errors` by their names, and its faults.
pub(crate) fn validate(
    errors: &[(&str, &ErrorSpec)],
    faults: &[FaultSpec],
) -> Result<(), FieldError> {
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

impl SensorSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        let errors = [
            ("velocity_m_s", &self.velocity_m_s),
            ("position_m", &self.position_m),
            ("theta_deg", &self.theta_deg),
            ("air_m_s", &self.air_m_s),
            ("acceleration_m_s2", &self.acceleration_m_s2),
        ];
        validate(&errors, &self.faults)
    }

    /// What is measured of `truth` and its specific force (along i, j) in `wind` \[m/s\], which is `steady` but for gusts and
    /// turbulence.
    pub fn measure(
        &self,
        truth: &State,
        force: [f64; 2],
        wind: Vector,
        steady: Vector,
        random: &mut impl Rng,
    ) -> Measured {
        Measured {
            velocity: self.velocity_m_s.vector(truth.velocity, random),
            position: self.position_m.vector(truth.position, random),
            theta: match self.theta_deg.apply(truth.theta.to_degrees(), random) {
                // Exactly, where nothing is wrong.
                _ if self.theta_deg == ErrorSpec::default() => truth.theta,
                degrees => degrees.to_radians(),
            },
            air: {
                let air = || inertial(self.air_m_s.vector(truth.velocity - wind, random));
                self.air.told(air, inertial(steady))
            },
            specific_force: {
                let f = self.acceleration_m_s2.vector(force.into(), random);
                self.accelerometer.told(Body::new(f.x as f32, f.y as f32))
            },
        }
    }
}

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// v \[m/s\].
    pub velocity: Vector,
    /// x \[m\].
    pub position: Vector,
    /// θ \[rad\], not wrapped.
    pub theta: f64,
    /// What is known of the air.
    pub air: Air<Inertial>,
    /// Specific force along tail and belly \[m/s²\].
    pub specific_force: Option<Body>,
}

impl Told for Measured {
    fn distort(&mut self, fault: &Lasting<Self>) {
        let (first, every) = (fault.first, Vector::from_element);
        match fault.kind {
            FaultKind::VelocityFrozen => self.velocity = first.velocity,
            FaultKind::VelocityDrift => self.velocity += every(fault.drift),
            FaultKind::AttitudeFrozen => self.theta = first.theta,
            FaultKind::AttitudeDrift => self.theta += fault.drift.to_radians(),
            FaultKind::AttitudeOffset => self.theta += fault.size.to_radians(),
            FaultKind::PositionDrift => self.position += every(fault.drift),
            FaultKind::PositionJump => self.position += every(fault.size),
            _ => {}
        }
        let off = inertial(every(fault.drift));
        self.air = fault.air(self.air, first.air, inertial(first.velocity), off);
        let off = Body::new(fault.drift as f32, fault.drift as f32);
        self.specific_force = fault.force(self.specific_force, first.specific_force, off);
    }
}

impl ErrorSpec {
    pub(crate) fn apply(&self, value: f64, random: &mut impl Rng) -> f64 {
        // Drawn in any case: the stream of numbers does not depend on which errors are on.
        let normal: f64 = StandardNormal.sample(random);
        let value = value + self.bias + self.noise * normal;
        if self.quantum > 0.0 {
            (value / self.quantum).round() * self.quantum
        } else {
            value
        }
    }

    fn vector(&self, value: Vector, random: &mut impl Rng) -> Vector {
        value.map(|x| self.apply(x, random))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

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
