//! The ideal plant: `m v̇ = m g e3 + F_a − T i` and the kinematics of a quaternion, with thrust behind a lag, and body rates behind a lag
//! or behind inertia and bounded torques. Axes are those of [`State`].

use nalgebra::{Quaternion, UnitQuaternion};

use super::{Command, Plant};
use crate::experiment::{Experiment, RateLoop, State, V3};
use crate::reference::ForceModel;

/// The plant of `[plant]` of kind `ideal`.
pub struct IdealPlant {
    /// How it moves.
    pub dynamics: Dynamics,
    /// Where it is.
    pub state: State,
}

impl Plant for IdealPlant {
    fn state(&self) -> &State {
        &self.state
    }

    fn specific_force(&self, wind: V3) -> V3 {
        self.dynamics.specific_force(&self.state, wind)
    }

    fn step(&mut self, command: &Command, wind: V3, dt: f64) {
        self.state = self.dynamics.step(&self.state, command, wind, dt);
    }
}

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

impl From<&RateLoop> for Rotation {
    fn from(rate_loop: &RateLoop) -> Self {
        match *rate_loop {
            RateLoop::Ideal => Self::Ideal,
            RateLoop::Lag { time_constant_s } => Self::Lag(time_constant_s),
            RateLoop::Inertia {
                moment_of_inertia_kg_m2,
                bandwidth_1_s,
                max_torque_n_m,
            } => Self::Inertia {
                lag: 1.0 / bandwidth_1_s,
                inertia: moment_of_inertia_kg_m2,
                torque: max_torque_n_m,
            },
        }
    }
}

/// How a vehicle moves under its actuators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dynamics {
    /// m \[kg\].
    pub mass: f64,
    /// g \[m/s²\].
    pub gravity: f64,
    /// The forces of the air.
    pub air: ForceModel,
    /// Time constant of thrust \[s\]; 0 for none.
    pub thrust_lag: f64,
    /// Least and most thrust at rest \[N\].
    pub thrust: [f64; 2],
    /// Airspeed along the nose at which full throttle gives no thrust \[m/s\]; 0 for thrust that does not fall.
    pub zero_thrust_speed: f64,
    /// How rates follow.
    pub rotation: Rotation,
}

/// Derivative of a state.
struct Slope {
    velocity: V3,
    acceleration: V3,
    quaternion: Quaternion<f64>,
    rates: V3,
    thrust: f64,
}

impl Dynamics {
    /// Those of the true vehicle of `experiment`.
    pub fn of(experiment: &Experiment) -> Self {
        let vehicle = experiment.vehicle.reference();
        Self {
            mass: vehicle.mass,
            gravity: vehicle.gravity,
            air: ForceModel::new(&vehicle, experiment.vehicle.c_y),
            thrust_lag: experiment.plant.thrust_lag_s,
            thrust: experiment.plant.thrust_n,
            rotation: (&experiment.plant.rate_loop).into(),
            zero_thrust_speed: experiment.vehicle.authority.zero_thrust_speed_m_s,
        }
    }

    /// What is there of a `thrust` at rest through the air at `v_a` \[m/s\]: with s² the thrust at rest over the greatest and x the airspeed over that of no
    /// thrust, s² − 0.6 s x − 0.4 x² of the greatest, a propeller of fixed pitch.
    fn thrust_at(&self, thrust: f64, attitude: &UnitQuaternion<f64>, v_a: V3) -> f64 {
        let most = self.thrust[1];
        if self.zero_thrust_speed == 0.0 || !most.is_finite() || thrust <= 0.0 {
            return thrust;
        }
        let along = -attitude.inverse_transform_vector(&v_a).z;
        let x = (along / self.zero_thrust_speed).clamp(0.0, 1.0);
        let share = thrust / most;
        (most * (share - x * (0.6 * share.sqrt() + 0.4 * x))).max(0.0)
    }

    /// Specific force \[m/s²\] along the body's axes x, y, z at an attitude, through the air at `v_a` \[m/s\].
    fn body_force(&self, attitude: &UnitQuaternion<f64>, v_a: V3, thrust: f64) -> V3 {
        let v = attitude.inverse_transform_vector(&v_a);
        let [i, j, w] = self.air.force([v.z, v.x, v.y]);
        V3::new(j, w, i - thrust) / self.mass
    }

    /// Specific force \[m/s²\] in components along (i, j, w): what an accelerometer measures.
    pub fn specific_force(&self, state: &State, wind: V3) -> V3 {
        let f = self.body_force(&state.attitude, state.velocity - wind, state.thrust);
        V3::new(f.z, f.x, f.y)
    }

    fn slope(
        &self,
        s: &State,
        q: Quaternion<f64>,
        &Command { thrust, rates }: &Command,
        wind: V3,
    ) -> Slope {
        let attitude = UnitQuaternion::from_quaternion(q);
        let force = self.body_force(&attitude, s.velocity - wind, s.thrust);
        let gravity = V3::new(0.0, 0.0, self.gravity);
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
            acceleration: gravity + attitude * force,
            quaternion: q * Quaternion::from_imag(s.rates) * 0.5,
            rates: rotation,
            thrust: if self.thrust_lag == 0.0 {
                0.0
            } else {
                (self.thrust_at(thrust, &attitude, s.velocity - wind) - s.thrust) / self.thrust_lag
            },
        }
    }

    /// The state after `dt` \[s\] of a constant command, its rates as (p, q, r) or as torques, in a steady `wind`: one step of the
    /// classical Runge–Kutta method of order 4.
    pub fn step(&self, state: &State, command: &Command, wind: V3, dt: f64) -> State {
        let command = &Command {
            thrust: command.thrust.clamp(self.thrust[0], self.thrust[1]),
            rates: command.rates,
        };
        let mut state = *state;
        // Actuators without lag are where they are told to be.
        if self.rotation == Rotation::Ideal {
            state.rates = command.rates;
        }
        if self.thrust_lag == 0.0 {
            let v_a = state.velocity - wind;
            state.thrust = self.thrust_at(command.thrust, &state.attitude, v_a);
        }
        let start = state.attitude.into_inner();
        let at = |k: &Slope, h: f64| {
            let stage = State {
                position: state.position,
                velocity: state.velocity + h * k.acceleration,
                attitude: state.attitude,
                rates: state.rates + h * k.rates,
                thrust: state.thrust + h * k.thrust,
            };
            self.slope(&stage, start + k.quaternion * h, command, wind)
        };
        let a = self.slope(&state, start, command, wind);
        let b = at(&a, 0.5 * dt);
        let c = at(&b, 0.5 * dt);
        let d = at(&c, dt);
        let h = dt / 6.0;
        State {
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
    use crate::reference::{Aerodynamics, LargeAngle, Vehicle};

    fn vehicle(mass: f64, k_a: f64, delta: f64, [c0, c1]: [f64; 2]) -> Vehicle {
        Vehicle {
            mass,
            k_a,
            delta,
            gravity: 9.81,
            aerodynamics: Aerodynamics::LargeAngle(LargeAngle { c0, c1 }),
        }
    }

    fn dynamics(rotation: Rotation) -> Dynamics {
        Dynamics {
            mass: 10.0,
            gravity: 9.81,
            air: ForceModel::new(&vehicle(10.0, 0.646, 0.1, [0.014, 0.95]), 0.5),
            thrust_lag: 0.05,
            thrust: [0.0, 200.0],
            rotation,
            zero_thrust_speed: 0.0,
        }
    }

    fn start() -> State {
        State {
            position: V3::zeros(),
            velocity: V3::new(12.0, 0.0, 2.0),
            // Axes x = j, z = i in the north-down plane: pitch −60° about east is θ = −60°.
            attitude: UnitQuaternion::from_axis_angle(&V3::y_axis(), -60.0_f64.to_radians()),
            rates: V3::zeros(),
            thrust: 80.0,
        }
    }

    /// In the north-down plane: nothing leaves it, to the last bit, and the acceleration is the yardstick's.
    #[test]
    fn in_a_vertical_plane_it_stays_and_is_the_yardstick() {
        let dynamics = dynamics(Rotation::Lag(0.1));
        let vehicle = vehicle(10.0, 0.646, 0.1, [0.014, 0.95]);
        let wind = V3::new(-2.0, 0.0, 0.5);
        let command = Command {
            thrust: 90.0,
            rates: V3::new(0.0, -0.4, 0.0),
        };
        let mut state = start();
        for _ in 0..500 {
            let plane = |v: V3| crate::reference::Vector::new(v.z, v.x);
            let want = vehicle.acceleration(
                plane(state.velocity),
                plane(wind),
                state.theta(),
                state.thrust,
            );
            let felt = dynamics.specific_force(&state, wind);
            let [i, j, _] = state.axes();
            let got = felt.x * i + felt.y * j + V3::new(0.0, 0.0, 9.81);
            // Roundings of 100 m/s².
            assert!((plane(got) - want).norm() < 1e-11);
            state = dynamics.step(&state, &command, wind, 0.01);
            let across = [
                state.position.y,
                state.velocity.y,
                state.rates.x,
                state.rates.z,
            ];
            assert_eq!(across, [0.0; 4]);
            assert_eq!([state.attitude.i, state.attitude.k], [0.0; 2]);
        }
        assert!(state.theta().is_finite() && state.is_sound());
    }

    /// Each quaternion step is good to (ω dt)^5: a turn of 2 rad at 1 rad/s in steps of 10 ms to 1e-10.
    #[test]
    fn lags_are_first_order_and_rates_turn_the_body() {
        let dynamics = dynamics(Rotation::Lag(0.1));
        let command = Command {
            thrust: 10.0,
            rates: V3::new(0.0, 2.0, 0.0),
        };
        let mut state = State {
            attitude: UnitQuaternion::identity(),
            thrust: 0.0,
            ..start()
        };
        for _ in 0..20 {
            state = dynamics.step(&state, &command, V3::zeros(), 0.01);
        }
        // Runge–Kutta with a tenth and a fifth of the lag per step: 1e-7 and 4e-6 of each.
        assert!((state.rates.y - 2.0 * (1.0 - (-2.0_f64).exp())).abs() < 1e-5);
        assert!((state.thrust - 10.0 * (1.0 - (-4.0_f64).exp())).abs() < 1e-4);
        let angle = 2.0 * (0.2 - 0.1 * (1.0 - (-2.0_f64).exp()));
        assert!((state.theta() - angle).abs() < 1e-5);
    }

    /// At rest the thrust is its command, and at the speed of no thrust there is none; tail first it is taken for static.
    #[test]
    fn thrust_falls_as_that_of_a_propeller() {
        let dynamics = Dynamics {
            zero_thrust_speed: 26.0,
            ..dynamics(Rotation::Ideal)
        };
        // Upright: the nose is up.
        let upright = UnitQuaternion::identity();
        let at = |thrust: f64, along: f64| {
            dynamics.thrust_at(thrust, &upright, V3::new(3.0, 0.0, -along))
        };
        assert_eq!([0.0, -8.0].map(|along| at(80.0, along)), [80.0; 2]);
        assert!(at(200.0, 26.0).abs() < 1e-9);
        // Half the speed at full throttle: 1 − 0.3 − 0.1.
        assert!((at(200.0, 13.0) - 120.0).abs() < 1e-9);
    }

    #[test]
    fn without_lags_the_actuators_are_where_they_are_told() {
        let dynamics = Dynamics {
            thrust_lag: 0.0,
            ..dynamics(Rotation::Ideal)
        };
        let command = Command {
            thrust: 250.0,
            rates: V3::new(0.0, 0.5, 0.1),
        };
        let state = dynamics.step(&start(), &command, V3::zeros(), 0.01);
        assert_eq!((state.rates, state.thrust), (command.rates, 200.0));
    }

    /// A vertical fall of a body with c_L = 0 and constant c_D: v(t) = v_∞ tanh(g t / v_∞), and
    /// x(t) = v_∞²/g · ln cosh(g t / v_∞).
    #[test]
    fn a_fall_with_constant_drag_is_the_textbook_one() {
        let dynamics = Dynamics {
            mass: 2.0,
            air: ForceModel::new(&vehicle(2.0, 0.5, 0.0, [0.4, 0.0]), 0.5),
            thrust_lag: 0.0,
            ..dynamics(Rotation::Ideal)
        };
        let command = Command {
            thrust: 0.0,
            rates: V3::zeros(),
        };
        let mut state = State {
            velocity: V3::zeros(),
            ..start()
        };
        for _ in 0..300 {
            state = dynamics.step(&state, &command, V3::zeros(), 0.01);
        }
        let terminal = (2.0_f64 * 9.81 / (0.5 * 0.4)).sqrt();
        let x = 9.81 * 3.0 / terminal;
        // The method's error: (g dt/v)^4 of each.
        assert!((state.velocity.z - terminal * x.tanh()).abs() < 1e-8);
        assert!((state.position.z - terminal * terminal / 9.81 * x.cosh().ln()).abs() < 1e-7);
    }

    /// In hover an accelerometer feels gravity towards the nose.
    #[test]
    fn an_accelerometer_feels_all_but_gravity() {
        let hover = State {
            velocity: V3::zeros(),
            thrust: 98.1,
            ..start()
        };
        let felt = dynamics(Rotation::Ideal).specific_force(&hover, V3::zeros());
        assert!((felt - V3::new(-9.81, 0.0, 0.0)).norm() < 1e-12);
    }

    /// Far from its torque limits the inertia's rate loop is the lag; at them the rate grows by τ/J.
    #[test]
    fn inertia_and_torque_limits_act() {
        let inertia = V3::new(0.3, 0.2, 0.4);
        let turning = |torque: f64, rates: V3, steps: usize| {
            let dynamics = dynamics(Rotation::Inertia {
                lag: 0.1,
                inertia,
                torque: V3::repeat(torque),
            });
            let mut s = start();
            for _ in 0..steps {
                let command = Command {
                    thrust: 80.0,
                    rates,
                };
                s = dynamics.step(&s, &command, V3::zeros(), 0.001);
            }
            s.rates
        };
        let asked = V3::new(0.3, -0.2, 0.1);
        let free = turning(100.0, asked, 100);
        assert!((free - asked * (1.0 - (-1.0_f64).exp())).norm() < 1e-6);
        let bound = turning(0.1, V3::new(3.0, 0.0, 0.0), 100);
        assert!((bound.x - 0.1 * 0.1 / 0.3).abs() < 1e-6);

        let dynamics = dynamics(Rotation::Torque(inertia));
        let spinning = State {
            rates: V3::new(0.0, 2.0, 1.0),
            ..start()
        };
        let command = Command {
            thrust: 80.0,
            rates: V3::new(6.0, 0.0, 0.0),
        };
        let after = dynamics.step(&spinning, &command, V3::zeros(), 1e-4);
        // Euler's equation about x: (6 − (0.4 − 0.2)·2·1)/0.3, for so short that its change does not count, 1e-3 of it.
        assert!(
            ((after.rates.x) / 1e-4 - 5.6 / 0.3).abs() < 2e-2,
            "{}",
            after.rates.x
        );
    }
}
