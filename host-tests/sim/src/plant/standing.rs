//! The ground under a plant that has none of its own: it stops there, and lifts off by its thrust.

use super::{Command, Plant};
use crate::experiment::{State, V3};

/// A plant over ground.
pub struct Standing<P> {
    /// The plant.
    pub plant: P,
    /// Height of the ground, as a position down \[m\].
    pub ground_m: f64,
    /// What stands there: position, attitude and velocity of the plant are put to this.
    pub put: fn(&mut P, State),
}

impl<P: Plant> Plant for Standing<P> {
    fn state(&self) -> &State {
        self.plant.state()
    }

    fn specific_force(&self, wind: V3) -> V3 {
        self.plant.specific_force(wind)
    }

    fn step(&mut self, command: &Command, wind: V3, dt: f64) {
        self.plant.step(command, wind, dt);
        let state = *self.plant.state();
        if state.position.z > self.ground_m {
            let position = V3::new(state.position.x, state.position.y, self.ground_m);
            (self.put)(
                &mut self.plant,
                State {
                    position,
                    velocity: V3::zeros(),
                    rates: V3::zeros(),
                    ..state
                },
            );
        }
    }
}
