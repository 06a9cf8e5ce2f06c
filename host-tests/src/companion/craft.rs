//! An experiment's vehicle, with its rate loop and its weather, as a body under an autopilot.

use std::collections::VecDeque;

use alula_bridges::companion::{Body, BodyState};
use rand_chacha::ChaCha8Rng;

use alula_sim::experiment::{Experiment, State, V3, Weather, stream};
use alula_sim::plant::{Command, Dynamics, Rotation};

/// The vehicle, where its experiment begins.
pub struct Craft {
    dynamics: Dynamics,
    state: State,
    weather: Weather,
    gusts: ChaCha8Rng,
    time: f64,
    delay: f64,
    weight: f64,
    pending: VecDeque<Command>,
}

/// Lag \[s\] of what an experiment has no lag of.
const LEAST_LAG: f64 = 0.005;

impl Craft {
    /// The vehicle of `experiment`, at its start.
    pub fn new(experiment: &Experiment) -> anyhow::Result<Self> {
        let mut dynamics = Dynamics::of(experiment);
        let weight = experiment.weight();
        let [least, most] = experiment.thrust_limits(None, weight);
        dynamics.thrust = [least.max(0.0), most];
        if dynamics.thrust_lag == 0.0 {
            dynamics.thrust_lag = LEAST_LAG;
        }
        if dynamics.rotation == Rotation::Ideal {
            dynamics.rotation = Rotation::Lag(LEAST_LAG);
        }
        let [mut gusts, mut start] = [1, 2].map(|n| stream(experiment.seed, n));
        let path = experiment.path.path()?;
        let in_plane = experiment.in_plane();
        Ok(Self {
            dynamics,
            state: experiment.initial.state(&path.start(), &mut start),
            weather: Weather::new(experiment.weather, in_plane, &mut gusts),
            gusts,
            time: 0.0,
            delay: experiment.plant.delay_s,
            weight,
            pending: VecDeque::new(),
        })
    }

    fn wind(&self) -> V3 {
        self.weather.wind(self.time)
    }

    /// Its state.
    pub fn spatial(&self) -> &State {
        &self.state
    }
}

impl Body for Craft {
    fn step(&mut self, thrust: f64, rates: [f64; 3], dt: f64) {
        let delay = (self.delay / dt).round() as usize;
        self.pending.push_back(Command {
            thrust: thrust * self.dynamics.thrust[1],
            rates: rates.into(),
        });
        let arrived = self.pending.len() > delay;
        let hover = Command {
            thrust: self.weight,
            rates: V3::zeros(),
        };
        let command = arrived.then(|| self.pending.pop_front()).flatten();
        let command = command.unwrap_or(hover);
        let wind = self.wind();
        self.state = self.dynamics.step(&self.state, &command, wind, dt);
        self.time += dt;
        let airspeed = (self.state.velocity - wind).norm();
        self.weather.advance(airspeed, dt, &mut self.gusts);
    }

    fn state(&self) -> BodyState {
        let q = self.state.attitude.into_inner();
        let force = self.dynamics.specific_force(&self.state, self.wind());
        BodyState {
            position: self.state.position.into(),
            velocity: self.state.velocity.into(),
            quaternion: [q.w, q.i, q.j, q.k],
            rates: self.state.rates.into(),
            specific_force: [force.y, force.z, force.x],
            wind: self.wind().into(),
        }
    }

    fn hover(&self) -> f64 {
        self.weight / self.dynamics.thrust[1]
    }
}
