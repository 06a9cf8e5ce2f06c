//! An experiment's vehicle, with its rate loop and its weather, as a body under an autopilot.

use std::collections::VecDeque;

use alula_bridges::companion::{Body, BodyState};
use nalgebra::UnitQuaternion;
use rand_chacha::ChaCha8Rng;

use alula_sim::experiment::{Experiment, Weather, stream, thrust_limits};
use alula_sim::space::{self, Rotation, SpatialPlant, SpatialState, V3};

/// The vehicle, where its experiment begins.
pub struct Craft {
    plant: SpatialPlant,
    state: SpatialState,
    weather: Blows,
    gusts: ChaCha8Rng,
    time: f64,
    delay: f64,
    weight: f64,
    pending: VecDeque<(f64, V3)>,
}

/// The weather of an experiment in a plane, to the north, or in space.
enum Blows {
    InPlane(Weather),
    InSpace(space::Weather),
}

/// Lag \[s\] of what an experiment has no lag of.
const LEAST_LAG: f64 = 0.005;

impl Craft {
    /// The vehicle of an experiment in a vertical plane, which is that to the north.
    pub fn in_plane(experiment: &Experiment) -> Self {
        let most = experiment.thrust_limits(None, experiment.weight())[1];
        let initial = &experiment.initial;
        let theta = initial.theta_deg.to_radians();
        let lag = experiment.plant.thrust_lag_s;
        let mut gusts = stream(experiment.seed, 1);
        Self {
            plant: SpatialPlant {
                vehicle: experiment.vehicle.reference(),
                c_y: experiment.ardupilot.side_force,
                thrust_lag: if lag > 0.0 { lag } else { LEAST_LAG },
                thrust: [experiment.plant.thrust_n[0].max(0.0), most],
                rate: f64::INFINITY,
                rotation: Rotation::of(
                    &experiment.plant.rate_loop,
                    V3::repeat,
                    Rotation::Lag(LEAST_LAG),
                ),
            },
            state: SpatialState {
                position: V3::zeros(),
                velocity: V3::new(initial.forward_m_s, 0.0, initial.down_m_s),
                attitude: UnitQuaternion::from_axis_angle(&V3::y_axis(), theta),
                rates: V3::zeros(),
                thrust: experiment.weight(),
            },
            weather: Blows::InPlane(Weather::new(experiment.weather, &mut gusts)),
            gusts,
            time: 0.0,
            delay: experiment.plant.delay_s,
            weight: experiment.weight(),
            pending: VecDeque::new(),
        }
    }

    /// The vehicle of an experiment in space.
    pub fn in_space(experiment: &space::Experiment) -> anyhow::Result<Self> {
        let weight = experiment.vehicle.weight();
        let mut plant = experiment.plant();
        plant.thrust = thrust_limits(plant.thrust, weight);
        plant.thrust[0] = plant.thrust[0].max(0.0);
        let mut gusts = stream(experiment.seed, 1);
        let start = experiment.path.path()?.start();
        let mut scatter = stream(experiment.seed, 2);
        Ok(Self {
            plant,
            state: experiment.initial.state(&start, &mut scatter),
            weather: Blows::InSpace(space::Weather::new(experiment.weather, &mut gusts)),
            gusts,
            time: 0.0,
            delay: experiment.plant.delay_s,
            weight,
            pending: VecDeque::new(),
        })
    }

    fn wind(&self) -> V3 {
        match &self.weather {
            Blows::InPlane(weather) => {
                let wind = weather.wind(self.time);
                V3::new(wind.y, 0.0, wind.x)
            }
            Blows::InSpace(weather) => weather.wind(self.time),
        }
    }

    /// Its state.
    pub fn spatial(&self) -> &SpatialState {
        &self.state
    }
}

impl Body for Craft {
    fn step(&mut self, thrust: f64, rates: [f64; 3], dt: f64) {
        let delay = (self.delay / dt).round() as usize;
        self.pending
            .push_back((thrust * self.plant.thrust[1], rates.into()));
        let arrived = self.pending.len() > delay;
        let hover = (self.weight, V3::zeros());
        let command = arrived.then(|| self.pending.pop_front()).flatten();
        let (thrust, rates) = command.unwrap_or(hover);
        let wind = self.wind();
        self.state = self.plant.step(&self.state, thrust, rates, wind, dt);
        self.time += dt;
        let airspeed = (self.state.velocity - wind).norm();
        match &mut self.weather {
            Blows::InPlane(weather) => weather.advance(airspeed, dt, &mut self.gusts),
            Blows::InSpace(weather) => weather.advance(airspeed, dt, &mut self.gusts),
        }
    }

    fn state(&self) -> BodyState {
        let q = self.state.attitude.into_inner();
        let [i, j, w] = self.plant.specific_force(&self.state, self.wind());
        BodyState {
            position: self.state.position.into(),
            velocity: self.state.velocity.into(),
            quaternion: [q.w, q.i, q.j, q.k],
            rates: self.state.rates.into(),
            specific_force: [j, w, i],
            wind: self.wind().into(),
        }
    }

    fn hover(&self) -> f64 {
        self.weight / self.plant.thrust[1]
    }
}
