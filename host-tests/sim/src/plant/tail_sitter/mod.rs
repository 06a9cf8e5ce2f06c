//! A tail-sitter as they are: wing in strips, slipstream, propellers, servos, the autopilot's rate loop and mixer.
//!
//! Axes of the vehicle: forward along the nose, right, down towards the belly. World: north, east, down. Nothing here comes from the core.

mod belief;
mod flying;
mod ground;
mod propeller;
mod rate_loop;
mod section;

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Quaternion, UnitQuaternion};

pub use belief::Belief;
pub use flying::{ELEVONS, Flying, MISSING_PITCH};
use ground::Ground;
pub use propeller::{Slipstream, Thrust};
pub use rate_loop::{Allocation, Motor, RateLoopState};
pub use section::{Bent, Coefficients, Profile};

use super::Command;
use crate::experiment::V3;
use crate::experiment::tail_sitter::{MOTORS, Propeller, Section, Strip, TailSitterSpec};

/// Density of the air \[kg/m³\].
const RHO: f64 = 1.225;
/// Shortest step \[s\]: what is shorter is rounding.
const SHORTEST: f64 = 1e-9;
/// No point of a vehicle is farther from its centre of mass \[m\].
const REACH: f64 = 150.0;
/// g \[m/s²\].
const GRAVITY: f64 = 9.81;

/// State of a [`TailSitter`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TailSitterState {
    /// \[m\], north, east, down.
    pub position: V3,
    /// \[m/s\], north, east, down.
    pub velocity: V3,
    /// From (forward, right, down) to (north, east, down).
    pub attitude: UnitQuaternion<f64>,
    /// About (forward, right, down) \[rad/s\].
    pub rates: V3,
    /// Speed of each motor \[rev/s\].
    pub motors: [f64; MOTORS],
    /// Deflection of the left and the right elevon \[rad\], positive trailing edge towards the belly.
    pub elevons: [f64; 2],
    /// Of the inner loop.
    pub rate_loop: RateLoopState,
    /// What the actuators are driven to.
    targets: Targets,
    /// Time until the inner loop's next period \[s\].
    tick: f64,
}

/// Force and torque on the vehicle, in its axes, without gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// \[N\].
    pub force: V3,
    /// About the centre of mass \[N·m\].
    pub torque: V3,
}

/// A vehicle, prepared for flight.
#[derive(Clone, Debug, PartialEq)]
pub struct TailSitter {
    airframe: TailSitterSpec,
    profiles: Vec<Profile>,
    mixer_motors: Vec<Motor>,
    ground: Ground,
    /// Where it lies, down \[m\]; infinitely far if there is none.
    ground_at: f64,
    static_thrust: f64,
    static_power: f64,
}

#[derive(Clone, Copy)]
struct Slope {
    velocity: V3,
    acceleration: V3,
    quaternion: Quaternion<f64>,
    rates: V3,
    motors: [f64; MOTORS],
    elevons: [f64; 2],
}

/// What the actuators are driven to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Targets {
    /// \[rev/s\].
    motors: [f64; MOTORS],
    /// \[rad\].
    elevons: [f64; 2],
}

impl TailSitter {
    /// Prepares a vehicle.
    pub fn new(airframe: TailSitterSpec, ground_m: Option<f64>) -> Self {
        let wing = &airframe.wing;
        let profile = |strip: &Strip| {
            if strip.upright {
                // A fin is symmetrical, and has an aspect ratio of its own.
                let section = Section {
                    c_m_0: 0.0,
                    ..wing.section
                };
                return Profile::new(section, strip.span_m / strip.chord_m, strip.elevon);
            }
            Profile::new(wing.section, wing.aspect_ratio, strip.elevon)
        };
        let profiles = wing.strips.iter().map(profile).collect();
        let most = |axis: usize| {
            let distances = airframe.propellers.iter().map(|p| p.position_m[axis].abs());
            distances.fold(0.0, f64::max).max(1e-6)
        };
        let (right, down) = (most(1), most(2));
        let mixer_motors = airframe.propellers.iter().map(|p| Motor {
            right: p.position_m[1] / right,
            down: p.position_m[2] / down,
            turns: p.turns,
        });
        let mixer_motors = mixer_motors.collect();
        let full = |p: &Propeller| p.at(p.speed_max_rev_s, 0.0, RHO);
        let static_thrust = airframe.propellers.iter().map(|p| full(p).thrust).sum();
        let static_power = airframe.propellers.iter().map(|p| full(p).power).sum();
        let ground = Ground::new(&airframe);
        Self {
            airframe,
            ground,
            ground_at: ground_m.unwrap_or(f64::INFINITY),
            profiles,
            mixer_motors,
            static_thrust,
            static_power,
        }
    }

    /// Its data.
    pub fn spec(&self) -> &TailSitterSpec {
        &self.airframe
    }

    /// Thrust of all propellers at rest and full throttle \[N\], on a battery that does not sag.
    pub fn static_thrust(&self) -> f64 {
        self.static_thrust
    }

    /// Force and torque in `state`, in a uniform `wind` \[m/s\], north, east, down.
    pub fn wrench(&self, state: &TailSitterState, wind: V3) -> Wrench {
        let air = state
            .attitude
            .inverse_transform_vector(&(state.velocity - wind));
        let mut force =
            -0.5 * RHO * air.norm() * V3::from(self.airframe.drag_area_m2).component_mul(&air)
                - V3::from(self.airframe.linear_drag_n_s_m).component_mul(&air);
        let mut torque = V3::zeros();
        let mut add = |at: V3, f: V3| {
            force += f;
            torque += at.cross(&f);
        };
        let mut jets = [Slipstream {
            velocity: 0.0,
            radius: 0.0,
        }; MOTORS];
        let mut reaction = 0.0;
        for (k, propeller) in self.airframe.propellers.iter().enumerate() {
            let hub = V3::from(propeller.position_m);
            let u = (air + state.rates.cross(&hub)).x;
            let given = propeller.at(state.motors[k], u, RHO);
            add(hub, V3::new(given.thrust, 0.0, 0.0));
            reaction -= propeller.turns * given.torque;
            jets[k] = propeller.slipstream(given.thrust, u, RHO);
        }
        let damping = V3::from(self.airframe.linear_damping_n_m_s).component_mul(&state.rates);
        let mut moment = V3::new(reaction, 0.0, 0.0) - damping;
        for (strip, profile) in self.airframe.wing.strips.iter().zip(&self.profiles) {
            let at = V3::from(strip.position_m);
            // The flow at three quarters of the chord decides the lift (Pistolesi), which acts at one quarter: so the strip damps.
            let rear = at - V3::new(0.5 * strip.chord_m, 0.0, 0.0);
            let flow = air + state.rates.cross(&rear);
            let side = usize::from(strip.position_m[1] > 0.0);
            let deflection = if strip.elevon > 0.0 {
                state.elevons[side]
            } else {
                0.0
            };
            let bent = profile.bent(deflection);
            let mut free = 1.0;
            for (propeller, jet) in self.airframe.propellers.iter().zip(&jets) {
                let [_, y, z] = propeller.position_m;
                let (along, across) = if strip.upright {
                    (z - at.z, y - at.y)
                } else {
                    (y - at.y, z - at.z)
                };
                let share = jet
                    .covers(-0.5 * strip.span_m, 0.5 * strip.span_m, along, across)
                    .min(free);
                if share > 0.0 {
                    let flow = flow + V3::new(jet.velocity, 0.0, 0.0);
                    let (f, m) = strip.load(profile, flow, &bent);
                    add(at, share * f);
                    moment += share * m;
                    free -= share;
                }
            }
            if free > 0.0 {
                let (f, m) = strip.load(profile, flow, &bent);
                add(at, free * f);
                moment += free * m;
            }
        }
        if state.position.z + REACH > self.ground_at {
            for point in &self.ground.points {
                let depth = state.position.z + (state.attitude * point).z - self.ground_at;
                let velocity = state.velocity + state.attitude * state.rates.cross(point);
                let pushed = self.ground.force(depth, velocity);
                let pushed = state.attitude.inverse_transform_vector(&pushed);
                force += pushed;
                moment += point.cross(&pushed);
            }
        }
        Wrench {
            force,
            torque: torque + moment,
        }
    }

    /// The state after `dt` \[s\] under a constant command in a uniform `wind`: the inner loop at its own rate, and a step of the classical
    /// Runge–Kutta method up to each of its periods.
    pub fn step(
        &self,
        state: &TailSitterState,
        command: &Command,
        wind: V3,
        dt: f64,
    ) -> TailSitterState {
        self.steps(state, wind, dt, |state| self.control(state, command))
    }

    /// The state after `dt` \[s\] with servos and motors driven to constant `outputs`: the inner loop and the mixer have no part.
    pub fn driven(
        &self,
        state: &TailSitterState,
        outputs: &Allocation,
        wind: V3,
        dt: f64,
    ) -> TailSitterState {
        self.steps(state, wind, dt, |state| {
            state.targets = self.targets(state, outputs)
        })
    }

    /// The state after `dt` \[s\], with its targets set by `control` at the rate of the inner loop.
    fn steps(
        &self,
        state: &TailSitterState,
        wind: V3,
        dt: f64,
        control: impl Fn(&mut TailSitterState),
    ) -> TailSitterState {
        let period = 1.0 / self.airframe.rate_loop.rate_hz;
        let mut state = *state;
        let mut left = dt;
        while left > SHORTEST {
            if state.tick < SHORTEST {
                control(&mut state);
                state.tick += period;
            }
            let h = left.min(state.tick);
            state = self.advance(&state, wind, h);
            state.tick -= h;
            left -= h;
        }
        state
    }

    /// One period of the inner loop.
    fn control(&self, state: &mut TailSitterState, command: &Command) {
        let rate_loop = &self.airframe.rate_loop;
        let most = rate_loop.rate_max_rad_s;
        let rates = command.rates.map(|x| x.clamp(-most, most));
        let torque = rate_loop.torque(&mut state.rate_loop, rates, state.rates);
        let collective = command.thrust / self.static_thrust;
        let mixer = self.airframe.mixer;
        let allocation = mixer.allocate(&self.mixer_motors, collective, torque);
        rate_loop.given(&mut state.rate_loop, torque, allocation.given);
        state.targets = self.targets(state, &allocation);
    }

    /// The state with its actuators where a share of the static thrust and torques, shares of full ones, put them.
    fn settled(&self, state: &TailSitterState, collective: f64, torque: V3) -> TailSitterState {
        let mixer = self.airframe.mixer;
        let allocation = mixer.allocate(&self.mixer_motors, collective, torque);
        let Targets { motors, elevons } = self.targets(state, &allocation);
        TailSitterState {
            motors,
            elevons,
            ..*state
        }
    }

    /// Nose up at rest, motors at the weight on a full battery.
    pub fn hover(&self) -> TailSitterState {
        let share = self.airframe.mass_kg * GRAVITY / self.static_thrust;
        let upright = TailSitterState {
            attitude: UnitQuaternion::from_axis_angle(&V3::y_axis(), FRAC_PI_2),
            ..TailSitterState::at_rest()
        };
        self.settled(&upright, share, V3::zeros())
    }

    /// Thrust of all propellers \[N\].
    pub fn thrust(&self, state: &TailSitterState, wind: V3) -> f64 {
        let air = state
            .attitude
            .inverse_transform_vector(&(state.velocity - wind));
        let given = |(propeller, speed): (&Propeller, f64)| {
            let u = (air + state.rates.cross(&V3::from(propeller.position_m))).x;
            propeller.at(speed, u, RHO).thrust
        };
        self.airframe
            .propellers
            .iter()
            .zip(state.motors)
            .map(given)
            .sum()
    }

    /// Speed at full throttle over that on a full battery.
    pub fn battery(&self, state: &TailSitterState) -> f64 {
        let propellers = self.airframe.propellers.iter().zip(state.motors);
        let power: f64 = propellers.map(|(p, n)| p.at(n, 0.0, RHO).power).sum();
        1.0 - self.airframe.motors.sag * (power / self.static_power).min(1.0)
    }

    /// Whether a point of it is in the ground.
    pub fn is_grounded(&self, state: &TailSitterState) -> bool {
        let mut points = self.ground.points.iter();
        points.any(|point| state.position.z + (state.attitude * point).z > self.ground_at)
    }

    fn targets(&self, state: &TailSitterState, allocation: &Allocation) -> Targets {
        let battery = self.battery(state);
        let mut motors = [0.0; MOTORS];
        let propellers = self.airframe.propellers.iter().zip(&allocation.motors);
        for (target, (propeller, share)) in motors.iter_mut().zip(propellers) {
            // Throttle is linear in static thrust, as autopilots linearise it.
            *target = battery * propeller.speed_max_rev_s * share.max(0.0).sqrt();
        }
        let travel = self.airframe.servo.travel_deg.to_radians();
        Targets {
            motors,
            elevons: allocation.elevons.map(|share| share * travel),
        }
    }

    fn slope(&self, s: &TailSitterState, q: Quaternion<f64>, wind: V3) -> Slope {
        let targets = &s.targets;
        let Wrench { force, torque } = self.wrench(s, wind);
        let inertia = V3::from(self.airframe.inertia_kg_m2);
        let spin = inertia.component_mul(&s.rates);
        let servo = &self.airframe.servo;
        let most = servo.rate_deg_s.to_radians();
        let mut motors = [0.0; MOTORS];
        for (k, slope) in motors.iter_mut().enumerate() {
            *slope = (targets.motors[k] - s.motors[k]) / self.airframe.motors.lag_s;
        }
        let turned =
            |k: usize| ((targets.elevons[k] - s.elevons[k]) / servo.lag_s).clamp(-most, most);
        Slope {
            velocity: s.velocity,
            acceleration: V3::new(0.0, 0.0, GRAVITY) + s.attitude * force / self.airframe.mass_kg,
            quaternion: q * Quaternion::from_imag(s.rates) * 0.5,
            rates: (torque - s.rates.cross(&spin)).component_div(&inertia),
            motors,
            elevons: [turned(0), turned(1)],
        }
    }

    fn advance(&self, state: &TailSitterState, wind: V3, h: f64) -> TailSitterState {
        let start = state.attitude.into_inner();
        let stage = |k: &Slope, h: f64| TailSitterState {
            position: state.position + h * k.velocity,
            velocity: state.velocity + h * k.acceleration,
            attitude: UnitQuaternion::from_quaternion(start + k.quaternion * h),
            rates: state.rates + h * k.rates,
            motors: std::array::from_fn(|i| state.motors[i] + h * k.motors[i]),
            elevons: std::array::from_fn(|i| state.elevons[i] + h * k.elevons[i]),
            rate_loop: state.rate_loop,
            targets: state.targets,
            tick: state.tick,
        };
        let at = |k: &Slope, h: f64| {
            let s = stage(k, h);
            self.slope(&s, s.attitude.into_inner(), wind)
        };
        let a = self.slope(state, start, wind);
        let b = at(&a, 0.5 * h);
        let c = at(&b, 0.5 * h);
        let d = at(&c, h);
        let mean = |f: fn(&Slope) -> V3| (f(&a) + 2.0 * f(&b) + 2.0 * f(&c) + f(&d)) / 6.0;
        let sum = Slope {
            velocity: mean(|k| k.velocity),
            acceleration: mean(|k| k.acceleration),
            quaternion: (a.quaternion + b.quaternion * 2.0 + c.quaternion * 2.0 + d.quaternion)
                / 6.0,
            rates: mean(|k| k.rates),
            motors: std::array::from_fn(|i| {
                (a.motors[i] + 2.0 * b.motors[i] + 2.0 * c.motors[i] + d.motors[i]) / 6.0
            }),
            elevons: std::array::from_fn(|i| {
                (a.elevons[i] + 2.0 * b.elevons[i] + 2.0 * c.elevons[i] + d.elevons[i]) / 6.0
            }),
        };
        stage(&sum, h)
    }
}

impl Strip {
    /// Force \[N\] and moment about its quarter chord \[N·m\] in a flow, both in the vehicle's axes; `flow` is its velocity through the air.
    fn load(&self, profile: &Profile, flow: V3, bent: &Bent) -> (V3, V3) {
        let across = if self.upright { flow.y } else { flow.z };
        let square = flow.x * flow.x + across * across;
        let alpha = libm::atan2(across, flow.x);
        let c = profile.at(alpha, bent);
        let pressure = 0.5 * RHO * square * self.span_m * self.chord_m;
        let (sin, cos) = libm::sincos(alpha);
        let along = pressure * (c.c_l * sin - c.c_d * cos);
        let normal = -pressure * (c.c_l * cos + c.c_d * sin);
        let moment = pressure * self.chord_m * c.c_m;
        if self.upright {
            // Nose up, seen with the belly on the right: towards the left.
            (V3::new(along, normal, 0.0), V3::new(0.0, 0.0, -moment))
        } else {
            (V3::new(along, 0.0, normal), V3::new(0.0, moment, 0.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::tail_sitter::{Mixer, VEHICLES};

    fn vehicles() -> impl Iterator<Item = (&'static str, TailSitter)> {
        let all = VEHICLES.iter();
        all.map(|&(name, text)| (name, TailSitter::new(toml::from_str(text).unwrap(), None)))
    }

    fn hover(vehicle: &TailSitter) -> TailSitterState {
        vehicle.hover()
    }

    fn after(
        vehicle: &TailSitter,
        mut state: TailSitterState,
        command: Command,
        seconds: f64,
    ) -> TailSitterState {
        for _ in 0..(seconds * 100.0).round() as usize {
            state = vehicle.step(&state, &command, V3::zeros(), 0.01);
        }
        state
    }

    /// In hover the thrust carries the weight: motors at the weight's share accelerate by the wing's drag in the slipstream alone, down, and by less than 1.5 m/s².
    #[test]
    fn in_hover_thrust_carries_the_weight() {
        for (name, vehicle) in vehicles() {
            let Wrench { force, torque } = vehicle.wrench(&hover(&vehicle), V3::zeros());
            let lost = 1.0 - force.x / (vehicle.spec().mass_kg * 9.81);
            assert!((0.0..0.15).contains(&lost), "{name}: {lost}");
            assert!(torque.x.abs() + torque.z.abs() < 1e-9, "{name}: {torque}");
        }
    }

    /// Left and right are mirror images: the mirrored state has the mirrored force and torque.
    #[test]
    fn left_and_right_are_alike() {
        for (name, vehicle) in vehicles() {
            let state = TailSitterState {
                velocity: V3::new(7.0, 3.0, 2.0),
                attitude: UnitQuaternion::from_euler_angles(0.3, 0.5, 0.2),
                rates: V3::new(0.4, -0.8, 0.3),
                motors: hover(&vehicle).motors,
                elevons: [0.3, -0.1],
                ..hover(&vehicle)
            };
            let mirrored = TailSitterState {
                velocity: V3::new(7.0, -3.0, 2.0),
                attitude: UnitQuaternion::from_euler_angles(-0.3, 0.5, -0.2),
                rates: V3::new(-0.4, -0.8, -0.3),
                elevons: [-0.1, 0.3],
                ..state
            };
            let [a, b] = [state, mirrored].map(|s| vehicle.wrench(&s, V3::zeros()));
            let force = V3::new(b.force.x, -b.force.y, b.force.z) - a.force;
            let torque = V3::new(-b.torque.x, b.torque.y, -b.torque.z) - a.torque;
            assert!(force.norm() < 1e-9, "{name}: {force}");
            assert!(torque.norm() < 1e-9, "{name}: {torque}");
        }
    }

    /// Pitch and yaw rate follow a small step in hover: the right sign at once, to within a third after 0.4 s. Later the vehicle
    /// moves, and the wing disturbs it.
    #[test]
    fn rates_follow_in_hover() {
        for (name, vehicle) in vehicles() {
            let start = hover(&vehicle);
            let thrust = 1.05 * vehicle.spec().mass_kg * 9.81;
            for axis in [1, 2] {
                let mut rates = V3::zeros();
                rates[axis] = 0.3;
                let command = Command { thrust, rates };
                let early = after(&vehicle, start, command, 0.1);
                let late = after(&vehicle, start, command, 0.4);
                assert!(
                    early.rates[axis] > 0.02,
                    "{name}, axis {axis}: {}",
                    early.rates
                );
                assert!(
                    (late.rates[axis] - 0.3).abs() < 0.1,
                    "{name}, axis {axis}: {}",
                    late.rates
                );
            }
        }
    }

    /// Without thrust and at rest about its axes a vehicle never gains energy from the air: F·v_a ≤ 0 at any attitude and deflection.
    #[test]
    fn the_air_only_takes_energy() {
        for (name, vehicle) in vehicles() {
            for k in 0..2000 {
                let x =
                    |n: u32| (f64::from(k) * (0.618 + 0.113 * f64::from(n))).fract() * 2.0 - 1.0;
                let state = TailSitterState {
                    velocity: 20.0 * V3::new(x(0), x(1), x(2)),
                    attitude: UnitQuaternion::from_euler_angles(3.0 * x(3), 1.5 * x(4), 3.0 * x(5)),
                    motors: [0.0; MOTORS],
                    elevons: [0.5 * x(6), 0.5 * x(7)],
                    ..hover(&vehicle)
                };
                let w = vehicle.wrench(&state, V3::zeros());
                let air = state.attitude.inverse_transform_vector(&state.velocity);
                assert!(w.force.dot(&air) <= 0.0, "{name}: {k}");
            }
        }
    }

    /// Trailing edges up turn the nose up in hover, by the slipstream alone.
    #[test]
    fn elevons_bite_in_the_slipstream() {
        for (name, vehicle) in vehicles() {
            if vehicle.spec().mixer == Mixer::DifferentialThrust {
                continue;
            }
            let turn = |elevon: f64, on: f64| {
                let start = hover(&vehicle);
                let state = TailSitterState {
                    elevons: [elevon; 2],
                    motors: start.motors.map(|n| on * n),
                    ..start
                };
                vehicle.wrench(&state, V3::zeros()).torque.y / vehicle.spec().inertia_kg_m2[1]
            };
            let travel = vehicle.spec().servo.travel_deg.to_radians();
            let up = turn(-travel, 1.0) - turn(0.0, 1.0);
            assert!(up > 5.0, "{name}: {up}");
            assert_eq!(turn(-travel, 0.0), turn(0.0, 0.0), "{name}");
        }
    }

    /// Full deflection in hover turns PX4's simulated tail-sitter at no more than some 2 rad/s: sih.hpp's damping of 0.025 N m s holds it. Without the damping the
    /// small flying wing turns twice as fast.
    #[test]
    fn damping_holds_the_rate_at_the_stop() {
        let rate = |name: &str| {
            let (_, vehicle) = vehicles().find(|(of, _)| *of == name).unwrap();
            let held = hover(&vehicle);
            let mut state = held;
            for _ in 0..250 {
                let full = Allocation {
                    motors: vec![vehicle.spec().mass_kg * GRAVITY / vehicle.static_thrust(); 2],
                    elevons: [-1.0; 2],
                    given: V3::zeros(),
                };
                state = TailSitterState {
                    position: held.position,
                    velocity: held.velocity,
                    attitude: held.attitude,
                    ..vehicle.driven(&state, &full, V3::zeros(), 0.002)
                };
            }
            state.rates.y
        };
        let [damped, free] = ["xvert", "small-flying-wing"].map(rate);
        println!("{damped} {free}");
        assert!((1.0..2.5).contains(&damped), "{damped}");
        assert!(free > 2.0 * damped, "{free}");
    }

    /// Dropped on its tail from 0.3 m it comes to rest on the ground, and no deeper in it than a few times what its points give.
    #[test]
    fn the_ground_holds_it() {
        for (name, text) in VEHICLES {
            let vehicle = TailSitter::new(toml::from_str(text).unwrap(), Some(1.0));
            let start = vehicle.hover();
            let tail = vehicle
                .ground
                .points
                .iter()
                .map(|p| p.x)
                .fold(0.0, f64::min);
            let start = TailSitterState {
                position: V3::new(0.0, 0.0, 0.7 + tail),
                motors: [0.0; MOTORS],
                ..start
            };
            let command = Command {
                thrust: 0.0,
                rates: V3::zeros(),
            };
            let state = after(&vehicle, start, command, 8.0);
            assert!(vehicle.is_grounded(&state), "{name}");
            assert!(state.velocity.norm() < 0.1, "{name}: {}", state.velocity);
            assert!(state.position.z < 1.05, "{name}: {}", state.position.z);
        }
    }

    /// Nose up on its tail, a little aslant and with its motors off, each vehicle stays there.
    #[test]
    fn it_stands_on_its_tail() {
        for (name, text) in VEHICLES {
            let spec: TailSitterSpec = toml::from_str(text).unwrap();
            let stance = Ground::new(&spec).stance();
            let vehicle = TailSitter::new(spec, Some(0.0));
            let upright = vehicle.hover();
            let start = TailSitterState {
                position: V3::new(0.0, 0.0, -stance),
                attitude: upright.attitude * UnitQuaternion::from_euler_angles(0.0, 0.05, 0.0),
                motors: [0.0; MOTORS],
                ..upright
            };
            let command = Command {
                thrust: 0.0,
                rates: V3::zeros(),
            };
            let state = after(&vehicle, start, command, 3.0);
            let nose = state.attitude * V3::new(1.0, 0.0, 0.0);
            assert!(nose.z < -0.99, "{name}: {nose}");
        }
    }

    /// The inner loop keeps its own rate, whatever the steps of the plant.
    #[test]
    fn the_inner_loop_has_its_own_rate() {
        for (name, vehicle) in vehicles() {
            let command = Command {
                thrust: vehicle.spec().mass_kg * GRAVITY,
                rates: V3::zeros(),
            };
            let rate = vehicle.spec().rate_loop.rate_hz;
            let periods: f64 = 0.033 * rate;
            let due = (periods.ceil() - periods) / rate;
            for (dt, steps) in [(0.001, 33), (0.011, 3)] {
                let mut state = vehicle.hover();
                for _ in 0..steps {
                    state = vehicle.step(&state, &command, V3::zeros(), dt);
                }
                assert!((state.tick - due).abs() < 1e-9, "{name}: {}", state.tick);
            }
        }
    }

    /// With full nose-up elevon at 12 m/s without thrust the nose can be raised up to an α behind the stall, and not beyond: short of
    /// 90° the air turns it down with some half of m g c.
    #[test]
    fn the_authority_in_pitch_ends_behind_the_stall() {
        let (_, vehicle) = vehicles().find(|(name, _)| *name == "mapping").unwrap();
        let left = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let state = TailSitterState {
                velocity: 12.0 * V3::new(cos, 0.0, sin),
                elevons: [-vehicle.spec().servo.travel_deg.to_radians(); 2],
                ..TailSitterState::at_rest()
            };
            vehicle.wrench(&state, V3::zeros()).torque.y / (2.4 * GRAVITY * 0.3)
        };
        let all: Vec<f64> = (0..=90).map(|degrees| left(degrees.into())).collect();
        println!("{:?}", all.iter().step_by(10).collect::<Vec<_>>());
        let lost = all.iter().position(|moment| *moment < 0.0).unwrap();
        assert!((15..50).contains(&lost), "{lost}°: {all:?}");
        assert!(all[lost..].iter().all(|moment| *moment < 0.0), "{all:?}");
        assert!((all[90] + 0.55).abs() < 0.2, "{}", all[90]);
    }
}
