//! The vehicle with its actuators: `m v̇ = m g i0 + F_a − T i`, `θ̇ = ω`, thrust and rate behind lags.

use serde::Deserialize;

use super::document::{FieldError, finite, positive, require};
use super::range::{Numbers, Range};
use crate::reference::{ForceModel, Vector, Vehicle};

/// How the angular rate follows its command. In space `J` is a number for each of belly, right wing and tail.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum RateLoop<J = f64> {
    /// ω = ω_c.
    #[default]
    Ideal,
    /// First order: ω̇ = (ω_c − ω)/T.
    Lag {
        /// T \[s\].
        time_constant_s: f64,
    },
    /// A rotational inertia under a proportional inner loop with limited torque:
    /// J ω̇ = sat(J b (ω_c − ω)). In space about each axis by itself.
    Inertia {
        /// J \[kg·m²\].
        inertia_kg_m2: J,
        /// b \[1/s\].
        bandwidth_1_s: f64,
        /// Largest torque \[N·m\].
        torque_max_n_m: J,
    },
}

/// `[plant]`: the actuators. Ideal if left out: no lag, no delay, any thrust.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, bound = "J: Deserialize<'de>")]
pub struct PlantSpec<J = f64> {
    /// The rate loop.
    pub rate_loop: RateLoop<J>,
    /// First-order lag of thrust \[s\]; 0 for none.
    pub thrust_lag_s: f64,
    /// Transport delay of the command \[s\], in whole steps of the plant.
    pub delay_s: f64,
    /// Least and most thrust that the motors give \[N\], whatever is commanded.
    pub thrust_n: [f64; 2],
}

impl<J> Default for PlantSpec<J> {
    fn default() -> Self {
        Self {
            rate_loop: RateLoop::Ideal,
            thrust_lag_s: 0.0,
            delay_s: 0.0,
            thrust_n: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
}

/// Longest step of the plant, in time constants of an actuator. The Runge–Kutta method is stable to 2.78.
const LONGEST_STEP: f64 = 2.0;

/// A time constant of `tau` \[s\] must be one that steps of `dt` \[s\] can follow.
fn followed(field: &str, tau: f64, dt: f64) -> Result<(), FieldError> {
    let problem = format_args!(
        "a time constant of {tau} s is too short for the plant's steps of {dt} s: raise substeps or control_rate_hz, or leave it out"
    );
    require(dt <= LONGEST_STEP * tau, field, problem)
}

impl<J: Numbers> PlantSpec<J> {
    /// Checks every field, for steps of `dt` \[s\].
    pub(crate) fn validate(&self, dt: f64) -> Result<(), FieldError> {
        match &self.rate_loop {
            RateLoop::Ideal => {}
            RateLoop::Lag { time_constant_s } => {
                let field = "plant.rate_loop.lag.time_constant_s";
                positive(field, *time_constant_s)?;
                followed(field, *time_constant_s, dt)?;
            }
            RateLoop::Inertia {
                inertia_kg_m2,
                bandwidth_1_s,
                torque_max_n_m,
            } => {
                let field = "plant.rate_loop.inertia.bandwidth_1_s";
                positive(field, *bandwidth_1_s)?;
                followed(field, 1.0 / bandwidth_1_s, dt)?;
                let each = |field, of: &J| Range::Positive.check(field, of);
                each("plant.rate_loop.inertia.inertia_kg_m2", inertia_kg_m2)?;
                each("plant.rate_loop.inertia.torque_max_n_m", torque_max_n_m)?;
            }
        }
        for (field, value) in [
            ("plant.thrust_lag_s", self.thrust_lag_s),
            ("plant.delay_s", self.delay_s),
        ] {
            finite(field, value)?;
            let problem = "must be from 0 to 2 s";
            require((0.0..=2.0).contains(&value), field, problem)?;
        }
        if self.thrust_lag_s > 0.0 {
            followed("plant.thrust_lag_s", self.thrust_lag_s, dt)?;
        }
        let [least, most] = self.thrust_n;
        // An infinite limit is none, and a NaN is not less than anything.
        require(least < most, "plant.thrust_n", "must be [least, most]")
    }
}

/// State of the vehicle and its actuators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// v \[m/s\], inertial (down, forward).
    pub velocity: Vector,
    /// x \[m\].
    pub position: Vector,
    /// θ \[rad\], not wrapped.
    pub theta: f64,
    /// ω \[rad/s\].
    pub rate: f64,
    /// T \[N\].
    pub thrust: f64,
}

/// The true vehicle and its actuators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    vehicle: ForceModel,
    actuators: PlantSpec,
}

impl Plant {
    /// `vehicle` with its actuators.
    pub fn new(vehicle: &Vehicle, actuators: PlantSpec) -> Self {
        Self {
            vehicle: ForceModel::new(vehicle),
            actuators,
        }
    }

    /// v̇ \[m/s²\] at `state` in `wind` \[m/s\].
    pub fn acceleration(&self, state: &State, wind: Vector) -> Vector {
        let State {
            velocity,
            theta,
            thrust,
            ..
        } = *state;
        self.vehicle.acceleration(velocity, wind, theta, thrust)
    }

    /// Specific force \[m/s²\] in components along (i, j) in `wind` \[m/s\]: what an accelerometer measures.
    pub fn specific_force(&self, state: &State, wind: Vector) -> [f64; 2] {
        let f = self.acceleration(state, wind) - Vector::new(self.vehicle.gravity, 0.0);
        let (sin, cos) = state.theta.sin_cos();
        [f.x * cos + f.y * sin, f.y * cos - f.x * sin]
    }

    /// The state after `dt` \[s\] under a constant command and `wind` \[m/s\]: one step of the classical
    /// Runge–Kutta method of order 4.
    pub fn step(&self, state: &State, thrust: f64, rate: f64, wind: Vector, dt: f64) -> State {
        let [least, most] = self.actuators.thrust_n;
        let thrust = thrust.clamp(least, most);
        let mut start = *state;
        // Actuators without lag are where they are told to be.
        if self.actuators.rate_loop == RateLoop::Ideal {
            start.rate = rate;
        }
        if self.actuators.thrust_lag_s == 0.0 {
            start.thrust = thrust;
        }
        let slope = |s: &State| self.slope(s, thrust, rate, wind);
        let a = slope(&start);
        let b = slope(&start.moved(&a, 0.5 * dt));
        let c = slope(&start.moved(&b, 0.5 * dt));
        let d = slope(&start.moved(&c, dt));
        start
            .moved(&a, dt / 6.0)
            .moved(&b, dt / 3.0)
            .moved(&c, dt / 3.0)
            .moved(&d, dt / 6.0)
    }

    /// The derivative of the state.
    fn slope(&self, s: &State, thrust: f64, rate: f64, wind: Vector) -> State {
        let lag = self.actuators.thrust_lag_s;
        State {
            velocity: self.acceleration(s, wind),
            position: s.velocity,
            theta: s.rate,
            rate: match self.actuators.rate_loop {
                RateLoop::Ideal => 0.0,
                RateLoop::Lag { time_constant_s } => (rate - s.rate) / time_constant_s,
                RateLoop::Inertia {
                    inertia_kg_m2,
                    bandwidth_1_s,
                    torque_max_n_m,
                } => {
                    let most = torque_max_n_m / inertia_kg_m2;
                    (bandwidth_1_s * (rate - s.rate)).clamp(-most, most)
                }
            },
            thrust: if lag == 0.0 {
                0.0
            } else {
                (thrust - s.thrust) / lag
            },
        }
    }
}

impl State {
    fn moved(&self, slope: &Self, dt: f64) -> Self {
        Self {
            velocity: self.velocity + dt * slope.velocity,
            position: self.position + dt * slope.position,
            theta: self.theta + dt * slope.theta,
            rate: self.rate + dt * slope.rate,
            thrust: self.thrust + dt * slope.thrust,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::{Aerodynamics, LargeAngle};

    fn plant(rate_loop: RateLoop, thrust_lag_s: f64) -> Plant {
        let vehicle = Vehicle {
            mass: 2.0,
            k_a: 0.5,
            delta: 0.0,
            gravity: 9.81,
            aerodynamics: Aerodynamics::LargeAngle(LargeAngle { c0: 0.4, c1: 0.0 }),
        };
        let actuators = PlantSpec {
            rate_loop,
            thrust_lag_s,
            delay_s: 0.0,
            thrust_n: [0.0, 100.0],
        };
        Plant::new(&vehicle, actuators)
    }

    const REST: State = State {
        velocity: Vector::new(0.0, 0.0),
        position: Vector::new(0.0, 0.0),
        theta: 0.0,
        rate: 0.0,
        thrust: 0.0,
    };

    fn after(plant: &Plant, thrust: f64, rate: f64, steps: usize) -> State {
        let mut state = REST;
        for _ in 0..steps {
            state = plant.step(&state, thrust, rate, Vector::zeros(), 0.01);
        }
        state
    }

    /// In hover an accelerometer feels gravity towards the nose. Anywhere, turned back into inertial axes and with gravity, it
    /// says how the vehicle accelerates.
    #[test]
    fn an_accelerometer_feels_all_but_gravity() {
        let plant = plant(RateLoop::Ideal, 0.0);
        let hover = State {
            thrust: 2.0 * 9.81,
            ..REST
        };
        let [i, j] = plant.specific_force(&hover, Vector::zeros());
        assert!((i + 9.81).abs() < 1e-12 && j.abs() < 1e-12);
        let (state, wind) = (
            State {
                velocity: Vector::new(-2.0, 12.0),
                theta: -1.1,
                thrust: 7.0,
                ..REST
            },
            Vector::new(1.0, -3.0),
        );
        let [i, j] = plant.specific_force(&state, wind);
        let axes = nalgebra::Rotation2::new(state.theta);
        let felt = axes * Vector::new(i, j) + Vector::new(9.81, 0.0);
        assert!((felt - plant.acceleration(&state, wind)).norm() < 1e-12);
    }

    #[test]
    fn lags_are_first_order() {
        let lag = RateLoop::Lag {
            time_constant_s: 0.1,
        };
        let state = after(&plant(lag, 0.05), 10.0, 2.0, 20);
        // 1e-5: Runge–Kutta with a fifth and a tenth of the lag per step.
        assert!((state.rate - 2.0 * (1.0 - (-2.0_f64).exp())).abs() < 1e-5);
        assert!((state.thrust - 10.0 * (1.0 - (-4.0_f64).exp())).abs() < 1e-4);
        let angle = 2.0 * (0.2 - 0.1 * (1.0 - (-2.0_f64).exp()));
        assert!((state.theta - angle).abs() < 1e-5);
    }

    #[test]
    fn without_lags_the_actuators_are_where_they_are_told() {
        let state = after(&plant(RateLoop::Ideal, 0.0), 150.0, 0.5, 10);
        assert_eq!((state.rate, state.thrust), (0.5, 100.0));
        assert!((state.theta - 0.05).abs() < 1e-12);
    }

    #[test]
    fn torque_limits_the_angular_acceleration() {
        let inertia = RateLoop::Inertia {
            inertia_kg_m2: 0.5,
            bandwidth_1_s: 20.0,
            torque_max_n_m: 2.0,
        };
        // 4 rad/s² until 0.2 rad/s are left.
        let state = after(&plant(inertia, 0.0), 0.0, 3.0, 50);
        assert!((state.rate - 2.0).abs() < 1e-9);
        let settled = after(&plant(inertia, 0.0), 0.0, 3.0, 200);
        assert!((settled.rate - 3.0).abs() < 1e-6);
    }

    /// A vertical fall of a body with c_L = 0 and constant c_D: v(t) = v_∞ tanh(g t / v_∞), and
    /// x(t) = v_∞²/g · ln cosh(g t / v_∞).
    #[test]
    fn a_fall_with_constant_drag_is_the_textbook_one() {
        let state = after(&plant(RateLoop::Ideal, 0.0), 0.0, 0.0, 300);
        let terminal = (2.0_f64 * 9.81 / (0.5 * 0.4)).sqrt();
        let x = 9.81 * 3.0 / terminal;
        assert!((state.velocity.x - terminal * x.tanh()).abs() < 1e-8);
        assert!((state.position.x - terminal * terminal / 9.81 * x.cosh().ln()).abs() < 1e-7);
    }
}
