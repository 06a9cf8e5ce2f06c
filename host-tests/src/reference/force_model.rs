//! The forces on a vehicle by their values alone, for the many evaluations of a flight: no derivatives, no magnitudes.
//!
//! The same printed formulas as [`super::Vehicle`] evaluates, with what does not depend on the state computed once; a test holds the
//! two to each other. α is the direction of v_a seen from the body, and its sine and cosine come from the components; the
//! blend `sigma` = (1 + tanh x)/(1 + tanh kᾱ²) is 2/(1 + e^{−2x}) over the same constant.

use super::{Aerodynamics, Table, Vector, Vehicle};

/// c_L and c_D as functions of α, prepared.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Values {
    LargeAngle {
        c0: f64,
        c1: f64,
    },
    SmallAngle {
        c0: f64,
        c2: f64,
        c3: f64,
    },
    Combined {
        c0: f64,
        c1: f64,
        c2: f64,
        c3: f64,
        lift: Blend,
        drag: Blend,
    },
    Table(&'static Table),
}

/// `sigma`, prepared.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Blend {
    k: f64,
    /// k ᾱ².
    knee: f64,
    /// 2/(1 + tanh kᾱ²).
    scale: f64,
}

impl Blend {
    fn new(alpha_bar: f64, k: f64) -> Self {
        let knee = k * alpha_bar * alpha_bar;
        Self {
            k,
            knee,
            scale: 2.0 / (1.0 + knee.tanh()),
        }
    }

    fn at(&self, alpha: f64) -> f64 {
        self.scale / (1.0 + (-2.0 * (self.knee - self.k * alpha * alpha)).exp())
    }
}

/// Lift and drag of the large-α model at an angle with this sine and cosine.
fn large(c0: f64, c1: f64, sin: f64, cos: f64) -> (f64, f64) {
    (2.0 * c1 * sin * cos, c0 + 2.0 * c1 * sin * sin)
}

/// Lift and drag of the small-α model.
fn small(c0: f64, c2: f64, c3: f64, sin: f64, cos: f64) -> (f64, f64) {
    let part = c2 * sin / ((c2 - c3) * cos * cos + c3);
    (c2 * part * cos, c0 + c3 * part * sin)
}

impl Values {
    fn new(model: &Aerodynamics) -> Self {
        match *model {
            Aerodynamics::LargeAngle { c0, c1 } => Self::LargeAngle { c0, c1 },
            Aerodynamics::SmallAngle { c0, c2, c3 } => Self::SmallAngle { c0, c2, c3 },
            Aerodynamics::Combined {
                c0,
                c1,
                c2,
                c3,
                alpha_bar,
                k_l,
                k_d,
            } => Self::Combined {
                c0,
                c1,
                c2,
                c3,
                lift: Blend::new(alpha_bar, k_l),
                drag: Blend::new(alpha_bar, k_d),
            },
            Aerodynamics::Table(table) => Self::Table(table),
        }
    }

    /// c_L and c_D at the angle with this sine and cosine.
    fn at(&self, sin: f64, cos: f64) -> (f64, f64) {
        match *self {
            Self::LargeAngle { c0, c1 } => large(c0, c1, sin, cos),
            Self::SmallAngle { c0, c2, c3 } => small(c0, c2, c3, sin, cos),
            Self::Combined {
                c0,
                c1,
                c2,
                c3,
                lift,
                drag,
            } => {
                let alpha = sin.atan2(cos);
                let (near, far) = (small(c0, c2, c3, sin, cos), large(c0, c1, sin, cos));
                let mix = |near: f64, far: f64, part: f64| far + part * (near - far);
                (
                    mix(near.0, far.0, lift.at(alpha)),
                    mix(near.1, far.1, drag.at(alpha)),
                )
            }
            Self::Table(table) => table.at(sin.atan2(cos)),
        }
    }
}

/// A vehicle, prepared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceModel {
    mass: f64,
    k_a: f64,
    gravity: f64,
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
    use super::*;
    use crate::polar::Polar;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Against the yardstick with its automatic derivatives, at every attitude and thrust line: forces of up to 3 kN, of which the
    /// roundings of α, times c_L′ and k_a v², are some 1e-12.
    #[test]
    fn the_acceleration_is_the_yardsticks() {
        let combined = Aerodynamics::Combined {
            c0: 0.014,
            c1: 0.95,
            c2: 5.5,
            c3: 0.3,
            alpha_bar: 11_f64.to_radians(),
            k_l: 28.0,
            k_d: 167.0,
        };
        let small = Aerodynamics::SmallAngle {
            c0: 0.014,
            c2: 5.5,
            c3: 0.3,
        };
        let polar = |name: &str| Aerodynamics::Table(Polar::load(name).unwrap().reference);
        let random = &mut ChaCha8Rng::seed_from_u64(11);
        for aerodynamics in [
            combined,
            small,
            Aerodynamics::LargeAngle { c0: 0.1, c1: 0.9 },
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
