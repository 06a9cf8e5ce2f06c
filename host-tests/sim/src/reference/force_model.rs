//! The forces on a vehicle by their values alone, for the many evaluations of a flight: no derivatives, no magnitudes.
//!
//! The same printed formulas as [`super::Vehicle`] evaluates, with what does not depend on the state computed once; a test holds the
//! two to each other. α is the direction of v_a seen from the body, and its sine and cosine come from the components.

use super::Vehicle;
use super::coefficients::Values;

/// A vehicle, prepared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceModel {
    k_a: f64,
    c_y: f64,
    /// sin δ, cos δ.
    delta: (f64, f64),
    values: Values,
}

impl ForceModel {
    /// The model of `vehicle` with this side force coefficient.
    pub fn new(vehicle: &Vehicle, c_y: f64) -> Self {
        Self {
            k_a: vehicle.k_a,
            c_y,
            delta: libm::sincos(vehicle.delta),
            values: Values::new(&vehicle.aerodynamics),
        }
    }

    /// F_a \[N\] in components along (i, j, w), at the velocity through the air `v` \[m/s\] in the same.
    pub fn force(&self, [along, across, side]: [f64; 3]) -> [f64; 3] {
        let in_symmetry = (along * along + across * across).sqrt();
        // α + δ is π less the angle from the thrust line to v_a. At zero air speed there is no force, whatever the angle.
        let (cos, sin) = match in_symmetry > 0.0 {
            true => (along / in_symmetry, across / in_symmetry),
            false => (-1.0, 0.0),
        };
        let (sin_delta, cos_delta) = self.delta;
        let sin_alpha = sin * cos_delta + cos * sin_delta;
        let cos_alpha = sin * sin_delta - cos * cos_delta;
        let (c_l, c_d) = self.values.at(sin_alpha, cos_alpha);
        let pressure = self.k_a * (in_symmetry.powi(2) + side * side).sqrt();
        [
            -pressure * (c_l * across + c_d * along),
            pressure * (c_l * along - c_d * across),
            -pressure * self.c_y * side,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Aerodynamics, Combined, LargeAngle, rotation};
    use super::*;
    use crate::polar::Polar;
    use crate::reference::Vector;
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
                let to_body = rotation(theta).transpose();
                let air = to_body * (v - wind);
                let [i, j, side] = ForceModel::new(&vehicle, 0.5).force([air.x, air.y, 0.0]);
                assert_eq!(side, 0.0);
                let force = to_body.transpose() * Vector::new(i - thrust, j);
                let got = force / 10.0 + Vector::new(9.81, 0.0);
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
            let model = ForceModel::new(&vehicle, 0.5);
            assert_eq!(model.force([0.0; 3]), [0.0; 3]);
            // Wing first: only the side force acts, k_a c_Y v².
            assert_eq!(model.force([0.0, 0.0, 4.0]), [0.0, 0.0, -4.0]);
        }
    }
}
