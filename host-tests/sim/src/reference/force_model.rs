//! The forces on a vehicle by their values alone, for the many evaluations of a flight: no derivatives, no magnitudes.
//!
//! The same printed formulas as [`super::Vehicle`] evaluates, with what does not depend on the state computed once; a test holds the
//! two to each other. α is the direction of v_a seen from the body, and its sine and cosine come from the components.

use super::coefficients::Values;
use super::{Vector, Vehicle};

/// A vehicle, prepared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceModel {
    mass: f64,
    k_a: f64,
    pub(crate) gravity: f64,
    /// sin δ, cos δ.
    delta: (f64, f64),
    values: Values,
}

impl ForceModel {
    /// The model of `vehicle`.
    pub fn new(vehicle: &Vehicle) -> Self {
        Self {
            mass: vehicle.mass,
            k_a: vehicle.k_a,
            gravity: vehicle.gravity,
            delta: vehicle.delta.sin_cos(),
            values: Values::new(&vehicle.aerodynamics),
        }
    }

    /// v̇ = g i0 + (F_a − T i)/m \[m/s²\], inertial coordinates.
    pub fn acceleration(&self, velocity: Vector, wind: Vector, theta: f64, thrust: f64) -> Vector {
        let (sin, cos) = theta.sin_cos();
        let v = velocity - wind;
        let speed = v.norm();
        // At zero air speed there is no force, whatever the angle.
        let unit = if speed > 0.0 {
            v / speed
        } else {
            Vector::new(-1.0, 0.0)
        };
        // α + δ is π less the angle from the thrust line to v_a.
        let (along, across) = (cos * unit.x + sin * unit.y, cos * unit.y - sin * unit.x);
        let (sin_delta, cos_delta) = self.delta;
        let sin_alpha = across * cos_delta + along * sin_delta;
        let cos_alpha = across * sin_delta - along * cos_delta;
        let (c_l, c_d) = self.values.at(sin_alpha, cos_alpha);
        let pressure = self.k_a * speed;
        let force = Vector::new(
            pressure * (-c_l * v.y - c_d * v.x),
            pressure * (c_l * v.x - c_d * v.y),
        );
        Vector::new(
            self.gravity + (force.x - thrust * cos) / self.mass,
            (force.y - thrust * sin) / self.mass,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Aerodynamics, Combined, LargeAngle};
    use super::*;
    use crate::polar::Polar;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Against the yardstick with its automatic derivatives, at every attitude and thrust line: forces of up to 3 kN, of which the
    /// roundings of α, times c_L′ and k_a v², are some 1e-12.
    #[test]
    fn the_acceleration_is_the_yardsticks() {
        let combined = Combined::NACA_0021_RE_160E3;
        let polar = |name: &str| Aerodynamics::Table(Polar::load(name).unwrap().reference);
        let random = &mut ChaCha8Rng::seed_from_u64(11);
        for aerodynamics in [
            Aerodynamics::Combined(combined),
            Aerodynamics::SmallAngle(combined.small()),
            Aerodynamics::LargeAngle(LargeAngle { c0: 0.1, c1: 0.9 }),
            polar("naca-0021-re-160e3"),
            polar("naca-0021-re-5e6"),
        ] {
            for _ in 0..20_000 {
                let mut number = |size: f64| random.random_range(-size..size);
                let vehicle = Vehicle {
                    mass: 10.0,
                    k_a: 0.646,
                    delta: number(1.5),
                    gravity: 9.81,
                    aerodynamics,
                };
                let v = Vector::new(number(30.0), number(30.0));
                let wind = Vector::new(number(5.0), number(5.0));
                let (theta, thrust) = (number(7.0), number(200.0));
                let got = ForceModel::new(&vehicle).acceleration(v, wind, theta, thrust);
                let want = vehicle.acceleration(v, wind, theta, thrust);
                assert!((got - want).norm() < 1e-10, "{vehicle:?} {v} {theta}");
            }
            let vehicle = Vehicle {
                mass: 2.0,
                k_a: 0.5,
                delta: 0.3,
                gravity: 9.81,
                aerodynamics,
            };
            let still = Vector::zeros();
            let got = ForceModel::new(&vehicle).acceleration(still, still, 0.0, 2.0);
            assert_eq!(got, Vector::new(8.81, 0.0));
        }
    }
}
