//! Plants: what a controller flies, in double precision. Nothing here comes from the core.
//!
//! A plant is a body with six degrees of freedom, with its inner loop and its actuators: [`IdealPlant`], or the tail-sitter of
//! [`tail_sitter`]. Axes are those of [`State`].

mod ideal;
mod outputs;
mod standing;
pub mod tail_sitter;

use standing::Standing;

pub use ideal::{Dynamics, IdealPlant, Rotation};

use crate::experiment::{Experiment, State, V3};

/// What a plant is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Thrust \[N\].
    pub thrust: f64,
    /// Body rates (p, q, r) \[rad/s\].
    pub rates: V3,
}

/// A vehicle with its inner loop and its actuators, under commands `C`: thrust and rates, or the outputs of an autopilot.
pub trait Plant<C = Command>: Send {
    /// The state of its body.
    fn state(&self) -> &State;

    /// Specific force \[m/s²\] in components along (i, j, w) in `wind` \[m/s\]: what an accelerometer measures.
    fn specific_force(&self, wind: V3) -> V3;

    /// Goes on by `dt` \[s\] under a constant command and `wind` \[m/s\].
    fn step(&mut self, command: &C, wind: V3, dt: f64);

    /// Columns of its own in a record: name, with its unit, and meaning.
    fn columns(&self) -> &'static [(&'static str, &'static str)] {
        &[]
    }

    /// What these columns read now.
    fn readings(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Whether it touches the ground.
    fn is_grounded(&self) -> bool {
        false
    }
}

impl Experiment {
    /// The true vehicle, at `state`.
    pub fn plant(&self, state: State) -> Box<dyn Plant> {
        match &self.tail_sitter {
            Some(spec) => Box::new(tail_sitter::Flying::new(spec, state)),
            None => {
                let plant = IdealPlant {
                    dynamics: Dynamics::of(self),
                    state,
                };
                match &self.mission {
                    Some(mission) if mission.takes_off() => {
                        let put = |plant: &mut IdealPlant, state| plant.state = state;
                        Box::new(Standing::new(plant, &state, self.vehicle.gravity_m_s2, put))
                    }
                    _ => Box::new(plant),
                }
            }
        }
    }
}
