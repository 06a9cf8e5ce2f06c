//! The vehicle that is flown: `m v̇ = m g i0 + F_a − T i`, `θ̇ = ω`, in double precision.

use crate::reference::{Vector, Vehicle};

/// State of the plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantState {
    /// v \[m/s\], inertial (down, forward).
    pub velocity: Vector,
    /// θ \[rad\], not wrapped.
    pub theta: f64,
}

/// The true vehicle in a steady wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    /// The true vehicle.
    pub vehicle: Vehicle,
    /// v_w \[m/s\], inertial.
    pub wind: Vector,
}

impl Plant {
    /// v̇ \[m/s²\] under `thrust` \[N\].
    pub fn acceleration(&self, state: &PlantState, thrust: f64) -> Vector {
        self.vehicle
            .acceleration(state.velocity, self.wind, state.theta, thrust)
    }

    /// α in [−π, π) \[rad\]; NaN where there is no air velocity.
    pub fn angle_of_attack(&self, state: &PlantState) -> f64 {
        let air_velocity = state.velocity - self.wind;
        if air_velocity == Vector::zeros() {
            f64::NAN
        } else {
            self.vehicle.angle_of_attack(air_velocity, state.theta)
        }
    }

    /// The state after `dt` \[s\] of constant `thrust` \[N\] and `rate` \[rad/s\]: one step of the
    /// classical Runge–Kutta method of order 4.
    pub fn step(&self, state: &PlantState, thrust: f64, rate: f64, dt: f64) -> PlantState {
        let slope = |after: f64, v_dot: Vector| {
            let moved = PlantState {
                velocity: state.velocity + after * v_dot,
                theta: state.theta + after * rate,
            };
            self.acceleration(&moved, thrust)
        };
        let a = self.acceleration(state, thrust);
        let b = slope(0.5 * dt, a);
        let c = slope(0.5 * dt, b);
        let d = slope(dt, c);
        PlantState {
            velocity: state.velocity + dt / 6.0 * (a + 2.0 * b + 2.0 * c + d),
            theta: state.theta + dt * rate,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::Aerodynamics;

    /// A vertical fall of a body with c_L = 0 and constant c_D has the closed form
    /// v(t) = v_∞ tanh(g t / v_∞), v_∞ = √(m g / (k_a c_D)).
    #[test]
    fn a_fall_with_constant_drag_is_the_textbook_one() {
        let plant = Plant {
            vehicle: Vehicle {
                mass: 2.0,
                k_a: 0.5,
                delta: 0.0,
                gravity: 9.81,
                aerodynamics: Aerodynamics::LargeAngle { c0: 0.4, c1: 0.0 },
            },
            wind: Vector::zeros(),
        };
        let terminal = (2.0_f64 * 9.81 / (0.5 * 0.4)).sqrt();
        let mut state = PlantState {
            velocity: Vector::zeros(),
            theta: 0.3,
        };
        for _ in 0..300 {
            state = plant.step(&state, 0.0, 0.0, 0.01);
        }
        let expected = terminal * (9.81 * 3.0 / terminal).tanh();
        assert!((state.velocity.x - expected).abs() < 1e-8);
        assert!(state.velocity.y.abs() < 1e-12);
    }
}
