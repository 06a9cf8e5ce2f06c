//! A vehicle in space, in double precision, with six degrees of freedom: `m v̇ = m g e3 + F_a − T i` and the kinematics
//! of a quaternion, with thrust behind a lag, and body rates behind a lag or behind inertia and bounded torques.
//!
//! World vectors are north-east-down. The quaternion's axes are x = j (belly), y = w (right wing), z = i (tail), so that
//! (p, q, r) = (ω_j, ω_w, ω_i). Nothing here comes from the core.

use nalgebra::{Quaternion, UnitQuaternion};

use super::V3;
use crate::experiment::RateLoop;
use crate::reference::Vehicle;

/// How body rates follow their commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rotation {
    /// They are the commands.
    Ideal,
    /// First order, \[s\].
    Lag(f64),
    /// A rate loop of this time constant \[s\], by torques within ±`torque` \[N·m\] on the inertia `inertia`
    /// \[kg·m²\], each about (x, y, z).
    Inertia {
        /// Time constant \[s\].
        lag: f64,
        /// Moments of inertia.
        inertia: V3,
        /// Largest torques.
        torque: V3,
    },
    /// Moments of inertia \[kg·m²\] about (x, y, z), turned by the torque \[N·m\] that is given in place of a rate.
    Torque(V3),
}

impl Rotation {
    /// That of a rate loop whose inertia and torque are those of `axes`; `ideal` for one without a lag.
    pub fn of<J: Copy>(rate_loop: &RateLoop<J>, axes: fn(J) -> V3, ideal: Self) -> Self {
        match *rate_loop {
            RateLoop::Ideal => ideal,
            RateLoop::Lag { time_constant_s } => Self::Lag(time_constant_s),
            RateLoop::Inertia {
                inertia_kg_m2,
                bandwidth_1_s,
                torque_max_n_m,
            } => Self::Inertia {
                lag: 1.0 / bandwidth_1_s,
                inertia: axes(inertia_kg_m2),
                torque: axes(torque_max_n_m),
            },
        }
    }
}

/// The true vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialPlant {
    /// In its plane of symmetry.
    pub vehicle: Vehicle,
    /// c_Y.
    pub c_y: f64,
    /// Time constant of thrust \[s\]; 0 for none.
    pub thrust_lag: f64,
    /// Least and most thrust \[N\].
    pub thrust: [f64; 2],
    /// Largest body rate commanded \[rad/s\], or torque \[N·m\].
    pub rate: f64,
    /// How rates follow.
    pub rotation: Rotation,
}

/// State of the plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialState {
    /// \[m\].
    pub position: V3,
    /// v \[m/s\].
    pub velocity: V3,
    /// Attitude.
    pub attitude: UnitQuaternion<f64>,
    /// (p, q, r) \[rad/s\].
    pub rates: V3,
    /// T \[N\].
    pub thrust: f64,
}

/// Derivative of a state.
struct Slope {
    velocity: V3,
    acceleration: V3,
    quaternion: Quaternion<f64>,
    rates: V3,
    thrust: f64,
}

impl SpatialState {
    /// (i, j, w) in world components.
    pub fn axes(&self) -> [V3; 3] {
        [V3::z(), V3::x(), V3::y()].map(|axis| self.attitude * axis)
    }
}

impl SpatialPlant {
    /// F_a \[N\], world components.
    pub fn aerodynamic_force(&self, v_a: V3, attitude: &UnitQuaternion<f64>) -> V3 {
        let [i, j, w] = [V3::z(), V3::x(), V3::y()].map(|axis| attitude * axis);
        let across = v_a.dot(&w);
        let v_s = v_a - across * w;
        let alpha = v_s.dot(&j).atan2(-v_s.dot(&i)) - self.vehicle.delta;
        let c = self.vehicle.aerodynamics.at(crate::reference::wrap(alpha));
        let lift = c.c_l * w.cross(&v_s);
        self.vehicle.k_a * v_a.norm() * (lift - c.c_d * v_s - self.c_y * across * w)
    }

    /// Specific force \[m/s²\] in components along (i, j, w): what an accelerometer measures.
    pub fn specific_force(&self, state: &SpatialState, wind: V3) -> [f64; 3] {
        let [i, j, w] = state.axes();
        let force =
            self.aerodynamic_force(state.velocity - wind, &state.attitude) - state.thrust * i;
        [i, j, w].map(|axis| force.dot(&axis) / self.vehicle.mass)
    }

    fn slope(
        &self,
        s: &SpatialState,
        q: Quaternion<f64>,
        thrust: f64,
        rates: V3,
        wind: V3,
    ) -> Slope {
        let attitude = UnitQuaternion::from_quaternion(q);
        let i = attitude * V3::z();
        let force = self.aerodynamic_force(s.velocity - wind, &attitude) - s.thrust * i;
        let gravity = V3::new(0.0, 0.0, self.vehicle.gravity);
        let rotation = match self.rotation {
            Rotation::Ideal => V3::zeros(),
            Rotation::Lag(lag) => (rates - s.rates) / lag,
            Rotation::Inertia {
                lag,
                inertia,
                torque,
            } => {
                let spin = inertia.component_mul(&s.rates);
                let asked = inertia.component_mul(&(rates - s.rates)) / lag + s.rates.cross(&spin);
                let given = asked.zip_map(&torque, |x, most| x.clamp(-most, most));
                (given - s.rates.cross(&spin)).component_div(&inertia)
            }
            Rotation::Torque(inertia) => {
                let spin = inertia.component_mul(&s.rates);
                (rates - s.rates.cross(&spin)).component_div(&inertia)
            }
        };
        Slope {
            velocity: s.velocity,
            acceleration: gravity + force / self.vehicle.mass,
            quaternion: q * Quaternion::from_imag(s.rates) * 0.5,
            rates: rotation,
            thrust: if self.thrust_lag == 0.0 {
                0.0
            } else {
                (thrust - s.thrust) / self.thrust_lag
            },
        }
    }

    /// The state after `dt` \[s\] of constant commands, `rates` as (p, q, r) or as torques, in a steady `wind`: one step of the
    /// classical Runge–Kutta method of order 4.
    pub fn step(
        &self,
        state: &SpatialState,
        thrust: f64,
        rates: V3,
        wind: V3,
        dt: f64,
    ) -> SpatialState {
        let thrust = thrust.clamp(self.thrust[0], self.thrust[1]);
        let rates = rates.map(|x| x.clamp(-self.rate, self.rate));
        let mut state = *state;
        // Actuators without lag are where they are told to be.
        if self.rotation == Rotation::Ideal {
            state.rates = rates;
        }
        if self.thrust_lag == 0.0 {
            state.thrust = thrust;
        }
        let start = state.attitude.into_inner();
        let at = |k: &Slope, h: f64| {
            let moved = SpatialState {
                position: state.position,
                velocity: state.velocity + h * k.acceleration,
                attitude: state.attitude,
                rates: state.rates + h * k.rates,
                thrust: state.thrust + h * k.thrust,
            };
            self.slope(&moved, start + k.quaternion * h, thrust, rates, wind)
        };
        let a = self.slope(&state, start, thrust, rates, wind);
        let b = at(&a, 0.5 * dt);
        let c = at(&b, 0.5 * dt);
        let d = at(&c, dt);
        let h = dt / 6.0;
        SpatialState {
            position: state.position
                + h * (a.velocity + 2.0 * b.velocity + 2.0 * c.velocity + d.velocity),
            velocity: state.velocity
                + h * (a.acceleration
                    + 2.0 * b.acceleration
                    + 2.0 * c.acceleration
                    + d.acceleration),
            attitude: UnitQuaternion::from_quaternion(
                start + (a.quaternion + b.quaternion * 2.0 + c.quaternion * 2.0 + d.quaternion) * h,
            ),
            rates: state.rates + h * (a.rates + 2.0 * b.rates + 2.0 * c.rates + d.rates),
            thrust: state.thrust + h * (a.thrust + 2.0 * b.thrust + 2.0 * c.thrust + d.thrust),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Plant, PlantSpec, State};
    use crate::reference::{Aerodynamics, LargeAngle, Vector};

    fn plant(rotation: Rotation) -> SpatialPlant {
        SpatialPlant {
            vehicle: Vehicle {
                mass: 10.0,
                k_a: 0.646,
                delta: 0.1,
                gravity: 9.81,
                aerodynamics: Aerodynamics::LargeAngle(LargeAngle {
                    c0: 0.014,
                    c1: 0.95,
                }),
            },
            c_y: 0.5,
            thrust_lag: 0.05,
            thrust: [0.0, 200.0],
            rate: 3.5,
            rotation,
        }
    }

    fn start() -> SpatialState {
        SpatialState {
            position: V3::zeros(),
            velocity: V3::new(12.0, 0.0, 2.0),
            // Axes x = j, z = i in the north-down plane: pitch −60° about east is θ = −60°.
            attitude: UnitQuaternion::from_axis_angle(&V3::y_axis(), -60.0_f64.to_radians()),
            rates: V3::zeros(),
            thrust: 80.0,
        }
    }

    /// In the north-down plane it is the planar plant: with rates and thrust at their commands the lags do nothing.
    #[test]
    fn in_a_vertical_plane_it_is_the_planar_plant() {
        let spatial = plant(Rotation::Lag(0.1));
        let planar = Plant::new(&spatial.vehicle, PlantSpec::default());
        let wind = Vector::new(0.5, -2.0);
        let (thrust, rate, dt) = (80.0, -0.4, 0.01);
        let mut a = SpatialState {
            rates: V3::new(0.0, rate, 0.0),
            ..start()
        };
        let mut b = State {
            velocity: Vector::new(2.0, 12.0),
            position: Vector::zeros(),
            theta: -60.0_f64.to_radians(),
            rate,
            thrust,
        };
        for _ in 0..200 {
            let rates = V3::new(0.0, rate, 0.0);
            a = spatial.step(&a, thrust, rates, V3::new(-2.0, 0.0, 0.5), dt);
            b = planar.step(&b, thrust, rate, wind, dt);
        }
        let [i, ..] = a.axes();
        // 1e-7: the quaternion is integrated to (q dt)^5, the planar angle exactly.
        assert!((a.velocity - V3::new(b.velocity.y, 0.0, b.velocity.x)).norm() < 1e-7);
        assert!((i - V3::new(b.theta.sin(), 0.0, b.theta.cos())).norm() < 1e-9);
    }

    /// A side wind on a vehicle that falls wing first: only the side force acts, k_a c_Y v².
    #[test]
    fn the_side_force_is_against_the_lateral_air_velocity() {
        let plant = plant(Rotation::Lag(0.1));
        let hover = UnitQuaternion::identity();
        let force = plant.aerodynamic_force(V3::new(0.0, 4.0, 0.0), &hover);
        assert!((force - V3::new(0.0, -0.646 * 0.5 * 16.0, 0.0)).norm() < 1e-12);
    }

    /// Far from its torque limits the inertia's rate loop is the lag; at them the rate grows by τ/J.
    #[test]
    fn inertia_and_torque_limits_act() {
        let inertia = V3::new(0.3, 0.2, 0.4);
        let turning = |torque: f64, rates: V3, steps: usize| {
            let plant = plant(Rotation::Inertia {
                lag: 0.1,
                inertia,
                torque: V3::repeat(torque),
            });
            let mut s = start();
            for _ in 0..steps {
                s = plant.step(&s, 80.0, rates, V3::zeros(), 0.001);
            }
            s.rates
        };
        let asked = V3::new(0.3, -0.2, 0.1);
        let free = turning(100.0, asked, 100);
        assert!((free - asked * (1.0 - (-1.0_f64).exp())).norm() < 1e-6);
        let bound = turning(0.1, V3::new(3.0, 0.0, 0.0), 100);
        assert!((bound.x - 0.1 * 0.1 / 0.3).abs() < 1e-6);

        let mut plant = plant(Rotation::Torque(inertia));
        plant.rate = f64::INFINITY;
        let spinning = SpatialState {
            rates: V3::new(0.0, 2.0, 1.0),
            ..start()
        };
        let torque = V3::new(6.0, 0.0, 0.0);
        let after = plant.step(&spinning, 80.0, torque, V3::zeros(), 1e-4);
        // Euler's equation about x: (6 − (0.4 − 0.2)·2·1)/0.3, for so short that its change does not count, 1e-3 of it.
        assert!(
            ((after.rates.x) / 1e-4 - 5.6 / 0.3).abs() < 2e-2,
            "{}",
            after.rates.x
        );
    }
}
