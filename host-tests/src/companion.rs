//! The controller of an experiment beside an autopilot, and the experiment's vehicle under a simulated one.

use std::collections::VecDeque;

use alula::{FeedForward, Inertial, PlanarInput};
use alula_bridges::companion::{Body, BodyState, Commanded, Pilot, Settings};
use nalgebra::{UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::controllers::{Answer, Controller, Input, inertial};
use crate::experiment::{Experiment, RateLoop, State, Weather};
use crate::reference::Vector;
use crate::simulate::{Record, Step};
use crate::space::{Rotation, SpatialPlant, SpatialState};

type V3 = Vector3<f64>;

/// Settings for flying `experiment`, of whose belief `hover_thrust` is the autopilot's thrust in hover. If it is none, thrust is taken for
/// proportional up to the most that the motors give.
pub fn settings(experiment: &Experiment, hover_thrust: Option<f64>) -> anyhow::Result<Settings> {
    let spec = experiment.spec()?;
    let weight = spec.belief().unwrap_or(&experiment.vehicle).weight();
    let most = experiment.thrust_limits(None, weight)[1];
    let hover_thrust = hover_thrust.unwrap_or(weight / most);
    if !(0.05..=0.95).contains(&hover_thrust) {
        anyhow::bail!("the thrust in hover is {hover_thrust}, must be from 0.05 to 0.95");
    }
    if spec.feed_forward() {
        anyhow::bail!(
            "the controller wants the air acceleration and the reference's jerk, which MAVLink does not tell"
        );
    }
    Ok(Settings {
        weight: weight as f32,
        hover_thrust: hover_thrust as f32,
        engage: false,
        heading: None,
        duration: experiment.duration_s,
        timeout: 0.5,
        hold: Default::default(),
    })
}

/// The plan of an experiment: velocity, acceleration and position at each time \[s\].
pub fn plan(experiment: &Experiment) -> impl Fn(f64) -> [Inertial; 3] {
    |t| {
        let (velocity, acceleration) = experiment.reference.at(t);
        let position = experiment.reference.position(t);
        [velocity, acceleration, position].map(inertial)
    }
}

/// The controller of an experiment, and what it answered last.
pub struct Controlled {
    controller: Box<dyn Controller>,
    last: Option<(Input, Answer)>,
}

impl Controlled {
    /// The controller of `experiment` at power-on.
    pub fn new(experiment: &Experiment) -> anyhow::Result<Self> {
        Ok(Self {
            controller: experiment.controller()?,
            last: None,
        })
    }

    /// The step that was commanded last. Of the truth nothing is known but what the autopilot says.
    pub fn step(&self, experiment: &Experiment, commanded: &Commanded) -> Option<Step> {
        let (input, answer) = self.last?;
        let t = commanded.t;
        let (velocity, acceleration) = experiment.reference.at(t);
        let double = |v: Inertial| Vector::new(v.down().into(), v.forward().into());
        Some(Step {
            t,
            truth: State {
                velocity: double(commanded.input.velocity),
                position: double(commanded.position.0),
                theta: input.theta.into(),
                rate: answer.rate.into(),
                thrust: answer.thrust.into(),
            },
            wind: double(commanded.wind),
            reference_velocity: velocity,
            reference_acceleration: acceleration,
            reference_position: experiment.reference.position(t),
            input,
            answer,
        })
    }
}

impl Pilot for Controlled {
    fn answer(&mut self, sample: &PlanarInput, dt: f32) -> Option<(f32, f32)> {
        let input = Input {
            theta: sample.attitude.angle(),
            sample: *sample,
            feed_forward: None::<FeedForward>,
        };
        let answer = self.controller.answer(&input, dt).ok()?;
        self.last = Some((input, answer));
        Some((answer.thrust, answer.rate))
    }
}

/// The experiment's vehicle in space, with its rate loop and its weather, heading north, where the experiment begins.
pub struct Craft<'a> {
    experiment: &'a Experiment,
    plant: SpatialPlant,
    state: SpatialState,
    weather: Weather,
    gusts: ChaCha8Rng,
    time: f64,
    pending: VecDeque<(f64, V3)>,
}

impl<'a> Craft<'a> {
    /// The vehicle of `experiment`.
    pub fn new(experiment: &'a Experiment) -> Self {
        let most = experiment.thrust_limits(None, experiment.weight())[1];
        let initial = &experiment.initial;
        let theta = initial.theta_deg.to_radians();
        let lag = experiment.plant.thrust_lag_s;
        let mut gusts = ChaCha8Rng::seed_from_u64(experiment.seed);
        gusts.set_stream(1);
        Self {
            experiment,
            plant: SpatialPlant {
                vehicle: experiment.vehicle.reference(),
                c_y: experiment.ardupilot.side_force,
                thrust_lag: if lag > 0.0 { lag } else { LEAST_LAG },
                thrust: [experiment.plant.thrust_n[0].max(0.0), most],
                rate: f64::INFINITY,
                rotation: match experiment.plant.rate_loop {
                    RateLoop::Ideal => Rotation::Lag(LEAST_LAG),
                    RateLoop::Lag { time_constant_s } => Rotation::Lag(time_constant_s),
                    RateLoop::Inertia {
                        inertia_kg_m2,
                        bandwidth_1_s,
                        torque_max_n_m,
                    } => Rotation::Inertia {
                        lag: 1.0 / bandwidth_1_s,
                        inertia: V3::repeat(inertia_kg_m2),
                        torque: V3::repeat(torque_max_n_m),
                    },
                },
            },
            state: SpatialState {
                position: V3::zeros(),
                velocity: V3::new(initial.forward_m_s, 0.0, initial.down_m_s),
                attitude: UnitQuaternion::from_axis_angle(&V3::y_axis(), theta),
                rates: V3::zeros(),
                thrust: experiment.weight(),
            },
            weather: Weather::new(experiment.weather, &mut gusts),
            gusts,
            time: 0.0,
            pending: VecDeque::new(),
        }
    }

    fn wind(&self) -> V3 {
        let wind = self.weather.wind(self.time);
        V3::new(wind.y, 0.0, wind.x)
    }

    /// Its state.
    pub fn spatial(&self) -> &SpatialState {
        &self.state
    }
}

/// Lag \[s\] of what the experiment has no lag of.
const LEAST_LAG: f64 = 0.005;

impl Body for Craft<'_> {
    fn step(&mut self, thrust: f64, rates: [f64; 3], dt: f64) {
        let delay = (self.experiment.plant.delay_s / dt).round() as usize;
        self.pending
            .push_back((thrust * self.plant.thrust[1], rates.into()));
        let arrived = self.pending.len() > delay;
        let hover = (self.experiment.weight(), V3::zeros());
        let command = arrived.then(|| self.pending.pop_front()).flatten();
        let (thrust, rates) = command.unwrap_or(hover);
        let wind = self.wind();
        self.state = self.plant.step(&self.state, thrust, rates, wind, dt);
        self.time += dt;
        let airspeed = (self.state.velocity - wind).norm();
        self.weather.advance(airspeed, dt, &mut self.gusts);
    }

    fn state(&self) -> BodyState {
        let q = self.state.attitude.into_inner();
        BodyState {
            position: self.state.position.into(),
            velocity: self.state.velocity.into(),
            quaternion: [q.w, q.i, q.j, q.k],
            rates: self.state.rates.into(),
            wind: self.wind().into(),
        }
    }

    fn hover(&self) -> f64 {
        self.experiment.weight() / self.plant.thrust[1]
    }
}

/// A record of what was commanded.
pub fn keep(
    record: &mut Record,
    pilot: &Controlled,
    experiment: &Experiment,
    commanded: &Commanded,
) {
    let later = record.last().is_none_or(|last| commanded.t > last.t);
    record.extend(pilot.step(experiment, commanded).filter(|_| later));
}
