//! The ground under a plant that has none of its own: what comes down stands there upright, and lifts off by its thrust.

use nalgebra::UnitQuaternion;

use super::Plant;
use crate::experiment::{State, V3};

/// A plant over ground.
pub struct Standing<P> {
    plant: P,
    /// Height of the ground, as a position down \[m\].
    ground_m: f64,
    /// \[m/s²\].
    gravity: f64,
    /// Puts the plant to a state.
    put: fn(&mut P, State),
    /// Where it stands.
    stands: Option<State>,
}

impl State {
    /// Nose up at rest, `heading` being that of the belly \[rad\].
    pub fn upright(position: V3, heading: f64) -> Self {
        Self {
            position,
            velocity: V3::zeros(),
            attitude: UnitQuaternion::from_axis_angle(&V3::z_axis(), heading),
            rates: V3::zeros(),
            thrust: 0.0,
        }
    }
}

impl<P> Standing<P> {
    /// `plant`, which stands as in `state`.
    pub fn new(plant: P, state: &State, gravity: f64, put: fn(&mut P, State)) -> Self {
        Self {
            plant,
            ground_m: state.position.z,
            gravity,
            put,
            stands: Some(State {
                velocity: V3::zeros(),
                rates: V3::zeros(),
                ..*state
            }),
        }
    }

    /// How a state stands that has come down.
    fn standing(&self, state: &State) -> State {
        let (x, y) = (state.position.x, state.position.y);
        let [_, _, wing] = state.axes();
        State::upright(V3::new(x, y, self.ground_m), libm::atan2(-wing.x, wing.y))
    }
}

impl<C, P: Plant<C>> Plant<C> for Standing<P> {
    fn state(&self) -> &State {
        self.plant.state()
    }

    fn specific_force(&self, wind: V3) -> V3 {
        match self.stands {
            Some(_) => V3::new(-self.gravity, 0.0, 0.0),
            None => self.plant.specific_force(wind),
        }
    }

    fn step(&mut self, command: &C, wind: V3, dt: f64) {
        self.plant.step(command, wind, dt);
        let state = *self.plant.state();
        let below = state.position.z > self.ground_m;
        self.stands = below.then(|| self.stands.unwrap_or_else(|| self.standing(&state)));
        if let Some(standing) = self.stands {
            let thrust = state.thrust;
            (self.put)(&mut self.plant, State { thrust, ..standing });
        }
    }

    fn is_grounded(&self) -> bool {
        self.stands.is_some()
    }
}
