//! The vehicle of an experiment behind ArduPilot's physics interface: six degrees of freedom, the ground, the experiment's weather and
//! sensors, and the record of the flight.
//!
//! The vehicle stands nose up on the ground, its belly to the north, until the thrust exceeds the weight. The weather is in the
//! north-down plane, forward is north. The record is the flight's projection on that plane, along the experiment's reference from the
//! start of the clock: the mark, or else the lift-off.

use std::collections::VecDeque;

use alula::BodyRates;
use alula_bridges::sitl::{ActuatorState, Flow, Packet, Physics, Sample};
use nalgebra::UnitQuaternion;
use rand_chacha::ChaCha8Rng;

use alula_sim::controllers::{Answer, Input, Report};
use alula_sim::experiment::{
    Estimates, Experiment, Faults, Measured, Path, State, V3, Weather, attitude_to_frd, double,
    stream, to_frd,
};
use alula_sim::plant::{Command, Dynamics, Rotation};
use alula_sim::reference::wrap;
use alula_sim::sensor_hold::SensorHold;
use alula_sim::simulate::{Record, Step};

/// Longest time step \[s\]: ArduPilot takes one of 0.1 s for a break.
const LONGEST_STEP: f64 = 0.02;
/// Pulse width \[µs\] over which the mark is set.
const MARK: u16 = 1700;

/// The vehicle.
pub struct Vehicle<'a> {
    experiment: &'a Experiment,
    mass_and_area: (f64, f64),
    dynamics: Dynamics,
    path: Path,
    random: Random,
    estimates: Estimates,
    /// Time step \[s\].
    dt: f64,
    /// Steps since the last restart.
    steps: u64,
    state: State,
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
}

/// The weather, and the random numbers of gusts and of sensors.
struct Random {
    weather: Weather,
    gusts: ChaCha8Rng,
    noise: ChaCha8Rng,
}

impl Random {
    /// As they begin.
    fn new(experiment: &Experiment) -> Self {
        let [noise, mut gusts] = [0, 1].map(|number| stream(experiment.seed, number));
        Self {
            weather: Weather::new(experiment.weather, experiment.in_plane(), &mut gusts),
            gusts,
            noise,
        }
    }
}

/// What stands on the ground.
fn standing(position: V3, heading: f64) -> State {
    State {
        position: V3::new(position.x, position.y, 0.0),
        velocity: V3::zeros(),
        attitude: UnitQuaternion::from_axis_angle(&V3::z_axis(), heading),
        rates: V3::zeros(),
        thrust: 0.0,
    }
}

impl<'a> Vehicle<'a> {
    /// The vehicle of `experiment` on the ground. The error is a time step that ArduPilot would not take, or what is not flown here.
    pub fn new(experiment: &'a Experiment) -> anyhow::Result<Self> {
        let dt = 1.0 / experiment.control_rate_hz / f64::from(experiment.substeps);
        if dt > LONGEST_STEP {
            anyhow::bail!(
                "control_rate_hz and substeps give a time step of {dt} s, must be at most {LONGEST_STEP} s"
            );
        }
        if experiment.tail_sitter.is_some() {
            anyhow::bail!(
                "plant.kind must be \"ideal\": ArduPilot's actuators turn the ideal vehicle"
            );
        }
        if !experiment.sensors.faults.is_empty() {
            anyhow::bail!(
                "sensors.faults must be empty: ArduPilot's sensors fail by its own SIM_* parameters"
            );
        }
        let vehicle = experiment.vehicle.reference();
        let [nose, wing, belly] = experiment.ardupilot.inertia(vehicle.mass);
        let most = experiment.thrust_limits(None, experiment.weight())[1];
        Ok(Self {
            experiment,
            mass_and_area: (vehicle.mass, vehicle.k_a),
            dynamics: Dynamics {
                // The motors lag here, each for itself.
                thrust_lag: 1.0,
                thrust: [0.0, most],
                rotation: Rotation::Torque(V3::new(belly, wing, nose)),
                ..Dynamics::of(experiment)
            },
            path: experiment.path.path()?,
            random: Random::new(experiment),
            estimates: Estimates::new(experiment.seed),
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

    /// Time since the start of the clock \[s\].
    fn clock(&self) -> f64 {
        let since = |(step, _)| (self.steps - step) as f64 * self.dt;
        self.start.map_or(0.0, since)
    }

    fn wind(&self) -> V3 {
        self.random.weather.wind(self.clock())
    }

    fn start_clock(&mut self) {
        self.start = Some((self.steps, self.state.position));
        self.theta = wrap(self.theta);
        self.record.clear();
    }

    /// The vehicle after a time step under these outputs, on the ground or in the air.
    fn advance(&mut self, outputs: &Packet, wind: V3) {
        let actuators = &self.experiment.ardupilot;
        let asked = actuators.thrust(outputs, self.dynamics.thrust[1]);
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
            air: to_frd(state.attitude.inverse() * (state.velocity - wind)),
            rates: to_frd(state.rates),
        };
        let wrench = actuators.wrench(outputs, self.motors, self.mass_and_area, &flow);
        if self.grounded && wrench.thrust <= self.experiment.weight() {
            return;
        }
        let lifts_off = std::mem::take(&mut self.grounded);
        if lifts_off && self.start.is_none() && actuators.mark_channel.is_none() {
            self.start_clock();
        }
        self.state.thrust = wrench.thrust;
        let [roll, pitch, yaw] = wrench.torque;
        let command = Command {
            thrust: wrench.thrust,
            rates: V3::new(yaw, pitch, -roll),
        };
        self.state = self.dynamics.step(&self.state, &command, wind, self.dt);
        if self.state.position.z > 0.0 {
            let [tail, _, wing] = self.state.axes();
            self.landings
                .push((self.state.velocity.norm(), tail.z.acos()));
            self.state = standing(self.state.position, (-wing.x).atan2(wing.y));
            self.grounded = true;
        }
    }

    /// The state from where the clock was started, thrust as that of both motors.
    fn since_start(&self) -> State {
        let origin = self.start.map_or(V3::zeros(), |(_, position)| position);
        State {
            position: self.state.position - origin,
            thrust: self.motors.iter().sum(),
            ..self.state
        }
    }

    /// Keeps a step of the record, of which `told` is what the sensors say.
    fn keep(&mut self, truth: State, told: Measured, force: V3, wind: V3, asked: f64) {
        let experiment = self.experiment;
        let t = self.clock();
        let target = self
            .path
            .advance(t, 1.0 / experiment.control_rate_hz, |_| 1.0);
        let mut faults = Faults::new(Vec::new(), experiment.seed, experiment.in_plane());
        let mut hold = SensorHold::default();
        hold.state(&mut faults, t, told);
        self.record.push(Step {
            t,
            truth,
            theta: self.theta,
            wind,
            load_factor: force.norm() / self.dynamics.gravity,
            readings: Vec::new(),
            target,
            asked_speed: target.velocity.norm(),
            measured_attitude: told.attitude,
            input: Input {
                sample: hold.input(&experiment.sensors, &faults, t, &target),
                feed_forward: None,
            },
            mission: None,
            answer: Answer {
                thrust: asked as f32,
                rates: body_rates(truth.rates),
                report: Report::Outside,
            },
            model_theta: None,
            candidates: Vec::new(),
        });
    }
}

/// Rates (p, q, r) as a controller commands them.
fn body_rates(rates: V3) -> BodyRates {
    let [roll, pitch, yaw] = to_frd(rates).map(|x| x as f32);
    BodyRates { roll, pitch, yaw }
}

impl Physics for Vehicle<'_> {
    fn step(&mut self, packet: &Packet) -> Sample {
        let experiment = self.experiment;
        let wind = self.wind();
        let mark = (experiment.ardupilot.mark_channel).is_some_and(|n| packet.channel(n) > MARK);
        if mark && !std::mem::replace(&mut self.marked, mark) {
            self.start_clock();
        }
        self.marked = mark;
        self.pending.push_back(*packet);
        let none = Packet::new(0, 0, &[]);
        let arrived = self.pending.len() > self.delay;
        let outputs = arrived.then(|| self.pending.pop_front()).flatten();
        self.advance(&outputs.unwrap_or(none), wind);
        self.steps += 1;

        self.theta += wrap(self.state.theta() - self.theta);
        let truth = self.since_start();
        let steady = experiment.weather.steady();
        let force = match self.grounded {
            true => V3::new(-self.dynamics.gravity, 0.0, 0.0),
            false => self.dynamics.specific_force(&self.state, wind),
        };
        let in_plane = experiment.in_plane();
        let sensors = &experiment.sensors;
        let told = sensors.measure(
            &truth,
            force,
            wind,
            steady,
            in_plane,
            (&mut self.random.noise, &mut self.estimates),
            self.dt,
        );
        if self.steps.is_multiple_of(experiment.substeps.into()) {
            let airspeed = (self.state.velocity - wind).norm();
            let period = 1.0 / experiment.control_rate_hz;
            let Random { weather, gusts, .. } = &mut self.random;
            weather.advance(airspeed, period, gusts);
            if self.start.is_some() && self.clock() <= experiment.duration_s {
                let asked = experiment.ardupilot.thrust(packet, self.dynamics.thrust[1]);
                self.keep(truth, told, force, wind, asked.iter().sum());
            }
        }

        let attitude = attitude_to_frd(&told.attitude);
        let airspeed = match told.air {
            alula::guidance::Air::Velocity(air) => {
                Some(to_frd(self.state.attitude.inverse() * double(air))[0])
            }
            alula::guidance::Air::Pitot { airspeed, .. } if airspeed.is_finite() => {
                Some(airspeed.into())
            }
            _ => None,
        };
        let position = self.state.position + told.position - truth.position;
        Sample {
            timestamp: self.steps as f64 * self.dt,
            gyro: to_frd(self.state.rates),
            accel_body: [-force.x, force.z, force.y],
            position: position.into(),
            velocity: told.velocity.into(),
            quaternion: [attitude.w, attitude.i, attitude.j, attitude.k],
            airspeed,
            velocity_wind: Some(wind.into()),
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
        self.random = Random::new(self.experiment);
        self.estimates = Estimates::new(self.experiment.seed);
        self.landings.clear();
    }
}
