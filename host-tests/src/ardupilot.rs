//! The vehicle of an experiment behind ArduPilot's physics interface: six degrees of freedom, the ground, the experiment's weather and
//! sensors, and the record of the flight.
//!
//! The vehicle stands nose up on the ground, its belly to the north, until the thrust exceeds the weight. The weather is in the
//! north-down plane, forward is north. The record is the flight's projection on that plane, along the experiment's reference from the
//! start of the clock: the mark, or else the lift-off.

use std::collections::VecDeque;

use alula::{PlanarGuidanceInput, Reference};
use alula_bridges::sitl::{ActuatorState, Flow, Packet, Physics, Sample};
use nalgebra::UnitQuaternion;
use rand_chacha::ChaCha8Rng;

use alula_sim::controllers::{Answer, Input, Report, inertial};
use alula_sim::experiment::{Experiment, State, Weather, stream};
use alula_sim::reference::{Vector, wrap};
use alula_sim::simulate::{Record, Step};
use alula_sim::space::{Rotation, SpatialPlant, SpatialState, V3};

/// Longest time step \[s\]: ArduPilot takes one of 0.1 s for a break.
const LONGEST_STEP: f64 = 0.02;
/// Pulse width \[µs\] over which the mark is set.
const MARK: u16 = 1700;

/// The vehicle.
pub struct Vehicle<'a> {
    experiment: &'a Experiment,
    plant: SpatialPlant,
    weather: Weather,
    gusts: ChaCha8Rng,
    noise: ChaCha8Rng,
    /// Time step \[s\].
    dt: f64,
    /// Steps since the last restart.
    steps: u64,
    state: SpatialState,
    motors: ActuatorState,
    /// Outputs on their way.
    pending: VecDeque<Packet>,
    delay: usize,
    grounded: bool,
    marked: bool,
    /// Step and position at the start of the clock.
    start: Option<(u64, V3)>,
    /// θ counted on \[rad\].
    theta: f64,
    record: Record,
    /// How each landing was: speed [m/s], and angle from upright \[rad\].
    landings: Vec<(f64, f64)>,
    /// Largest distance \[m\] east or west of the plane while the clock runs.
    across: f64,
}

/// The weather, and the random numbers of gusts and of sensors, as they begin.
fn by_seed(experiment: &Experiment) -> (Weather, ChaCha8Rng, ChaCha8Rng) {
    let [noise, mut gusts] = [0, 1].map(|number| stream(experiment.seed, number));
    (Weather::new(experiment.weather, &mut gusts), gusts, noise)
}

/// What stands on the ground.
fn standing(position: V3, heading: f64) -> SpatialState {
    SpatialState {
        position: V3::new(position.x, position.y, 0.0),
        velocity: V3::zeros(),
        attitude: UnitQuaternion::from_axis_angle(&V3::z_axis(), heading),
        rates: V3::zeros(),
        thrust: 0.0,
    }
}

/// Components of forward-right-down axes, from those along (j, w, i).
fn body(v: V3) -> [f64; 3] {
    [-v.z, v.y, v.x]
}

impl<'a> Vehicle<'a> {
    /// The vehicle of `experiment` on the ground. The error is a time step that ArduPilot would not take.
    pub fn new(experiment: &'a Experiment) -> anyhow::Result<Self> {
        let dt = 1.0 / experiment.control_rate_hz / f64::from(experiment.substeps);
        if dt > LONGEST_STEP {
            anyhow::bail!(
                "control_rate_hz and substeps give a time step of {dt} s, must be at most {LONGEST_STEP} s"
            );
        }
        let vehicle = experiment.vehicle.reference();
        let [nose, wing, belly] = experiment.ardupilot.inertia(vehicle.mass);
        let most = experiment.thrust_limits(None, experiment.weight())[1];
        let (weather, gusts, noise) = by_seed(experiment);
        Ok(Self {
            experiment,
            plant: SpatialPlant {
                vehicle,
                c_y: experiment.ardupilot.side_force,
                // The motors lag here, each for itself.
                thrust_lag: 1.0,
                thrust: [0.0, most],
                rate: f64::INFINITY,
                rotation: Rotation::Torque(V3::new(belly, wing, nose)),
            },
            weather,
            gusts,
            noise,
            dt,
            steps: 0,
            state: standing(V3::zeros(), 0.0),
            motors: [0.0; 2],
            pending: VecDeque::new(),
            delay: (experiment.plant.delay_s / dt).round() as usize,
            grounded: true,
            marked: false,
            start: None,
            theta: 0.0,
            record: Record::new(),
            landings: Vec::new(),
            across: 0.0,
        })
    }

    /// The flight so far, since the clock was started last.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Each landing: speed [m/s], and angle from upright \[rad\].
    pub fn landings(&self) -> &[(f64, f64)] {
        &self.landings
    }

    /// Largest distance \[m\] from the plane of the record.
    pub fn across(&self) -> f64 {
        self.across
    }

    /// Time since the start of the clock \[s\].
    fn clock(&self) -> f64 {
        let since = |(step, _)| (self.steps - step) as f64 * self.dt;
        self.start.map_or(0.0, since)
    }

    fn wind(&self) -> Vector {
        self.weather.wind(self.clock())
    }

    fn start_clock(&mut self) {
        self.start = Some((self.steps, self.state.position));
        self.theta = wrap(self.theta);
        self.record.clear();
        self.across = 0.0;
    }

    /// The vehicle after a time step under these outputs, on the ground or in the air.
    fn advance(&mut self, outputs: &Packet, wind: V3) {
        let actuators = &self.experiment.ardupilot;
        let asked = actuators.thrust(outputs, self.plant.thrust[1]);
        let lag = self.experiment.plant.thrust_lag_s;
        let share = if lag > 0.0 {
            1.0 - (-self.dt / lag).exp()
        } else {
            1.0
        };
        for (thrust, asked) in self.motors.iter_mut().zip(asked) {
            *thrust += share * (asked - *thrust);
        }
        let state = &self.state;
        let flow = Flow {
            air: body(state.attitude.inverse() * (state.velocity - wind)),
            rates: body(state.rates),
        };
        let vehicle = &self.plant.vehicle;
        let wrench = actuators.wrench(outputs, self.motors, (vehicle.mass, vehicle.k_a), &flow);
        if self.grounded && wrench.thrust <= self.experiment.weight() {
            return;
        }
        let lifts_off = std::mem::take(&mut self.grounded);
        if lifts_off && self.start.is_none() && actuators.mark_channel.is_none() {
            self.start_clock();
        }
        self.state.thrust = wrench.thrust;
        let [roll, pitch, yaw] = wrench.torque;
        let torque = V3::new(yaw, pitch, -roll);
        self.state = self
            .plant
            .step(&self.state, wrench.thrust, torque, wind, self.dt);
        if self.state.position.z > 0.0 {
            let [tail, _, wing] = self.state.axes();
            self.landings
                .push((self.state.velocity.norm(), tail.z.acos()));
            self.state = standing(self.state.position, (-wing.x).atan2(wing.y));
            self.grounded = true;
        }
    }

    /// The state in the north-down plane, from the start of the clock.
    fn planar(&self) -> State {
        let origin = self.start.map_or(V3::zeros(), |(_, position)| position);
        let (position, velocity) = (self.state.position - origin, self.state.velocity);
        State {
            velocity: Vector::new(velocity.z, velocity.x),
            position: Vector::new(position.z, position.x),
            theta: self.theta,
            rate: self.state.rates.y,
            thrust: self.motors.iter().sum(),
        }
    }

    fn keep(&mut self, input: Input, truth: State, wind: Vector, asked: f64) {
        let t = self.clock();
        let (velocity, acceleration) = self.experiment.reference.at(t);
        self.across = self.across.max(
            (self.state.position - self.start.map_or(V3::zeros(), |s| s.1))
                .y
                .abs(),
        );
        self.record.push(Step {
            t,
            truth,
            wind,
            reference_velocity: velocity,
            reference_acceleration: acceleration,
            reference_position: self.experiment.reference.position(t),
            input,
            answer: Answer {
                thrust: asked as f32,
                rate: truth.rate as f32,
                report: Report::Outside,
            },
        });
    }
}

impl Physics for Vehicle<'_> {
    fn step(&mut self, packet: &Packet) -> Sample {
        let experiment = self.experiment;
        let wind = self.wind();
        let wind_3 = V3::new(wind.y, 0.0, wind.x);
        let mark = (experiment.ardupilot.mark_channel).is_some_and(|n| packet.channel(n) > MARK);
        if mark && !std::mem::replace(&mut self.marked, mark) {
            self.start_clock();
        }
        self.marked = mark;
        self.pending.push_back(*packet);
        let none = Packet::new(0, 0, &[]);
        let arrived = self.pending.len() > self.delay;
        let outputs = arrived.then(|| self.pending.pop_front()).flatten();
        self.advance(&outputs.unwrap_or(none), wind_3);
        self.steps += 1;

        let tail = self.state.attitude * V3::z();
        let theta = tail.x.atan2(tail.z);
        self.theta += wrap(theta - self.theta);
        let truth = self.planar();
        let steady = Vector::from(experiment.weather.steady_m_s);
        let force = match self.grounded {
            true => [-self.plant.vehicle.gravity, 0.0, 0.0],
            false => self.plant.specific_force(&self.state, wind_3),
        };
        let [i, j, w] = force;
        let measured = experiment
            .sensors
            .measure(&truth, [i, j], wind, steady, &mut self.noise);
        if self.steps.is_multiple_of(experiment.substeps.into()) {
            let airspeed = (self.state.velocity - wind_3).norm();
            let period = 1.0 / experiment.control_rate_hz;
            self.weather.advance(airspeed, period, &mut self.gusts);
            let t = self.clock();
            if self.start.is_some() && t <= experiment.duration_s {
                let (velocity, acceleration) = experiment.reference.at(t);
                let position = measured.position - experiment.reference.position(t);
                let theta = wrap(measured.theta) as f32;
                let input = Input {
                    theta,
                    sample: PlanarGuidanceInput {
                        velocity: inertial(measured.velocity),
                        attitude: alula::Attitude::from_angle(theta),
                        air: measured.air,
                        specific_force: measured.specific_force,
                        position_error: Some(inertial(position)),
                        reference: Reference {
                            velocity: inertial(velocity),
                            acceleration: inertial(acceleration),
                        },
                        ..PlanarGuidanceInput::default()
                    },
                    feed_forward: None,
                };
                let asked = experiment.ardupilot.thrust(packet, self.plant.thrust[1]);
                self.keep(input, truth, wind, asked.iter().sum());
            }
        }

        // Errors of the sensors in the plane; across it nothing is wrong.
        let nose_forward =
            UnitQuaternion::from_axis_angle(&V3::y_axis(), std::f64::consts::FRAC_PI_2);
        let turned = UnitQuaternion::from_axis_angle(&V3::y_axis(), measured.theta - truth.theta);
        let attitude = (self.state.attitude * turned * nose_forward).into_inner();
        let error = measured.velocity - truth.velocity;
        let airspeed = match measured.air {
            alula::guidance::Air::Velocity(air) => {
                let exact = self.state.velocity - wind_3;
                let air = V3::new(air.forward().into(), exact.y, air.down().into());
                Some(body(self.state.attitude.inverse() * air)[0])
            }
            _ => None,
        };
        let error_of_position = measured.position - truth.position;
        Sample {
            timestamp: self.steps as f64 * self.dt,
            gyro: body(self.state.rates),
            accel_body: [-i, w, j],
            position: (self.state.position
                + V3::new(error_of_position.y, 0.0, error_of_position.x))
            .into(),
            velocity: (self.state.velocity + V3::new(error.y, 0.0, error.x)).into(),
            quaternion: [attitude.w, attitude.i, attitude.j, attitude.k],
            airspeed,
            velocity_wind: Some(wind_3.into()),
        }
    }

    fn restart(&mut self) {
        self.steps = 0;
        self.state = standing(V3::zeros(), 0.0);
        self.motors = [0.0; 2];
        self.pending.clear();
        (self.grounded, self.marked, self.start) = (true, false, None);
        self.theta = 0.0;
        // The same outputs make the same flight again.
        (self.weather, self.gusts, self.noise) = by_seed(self.experiment);
        self.landings.clear();
    }
}
