//! The velocity laws: a pure function from (state, reference) to (thrust, angular rate).

mod command;
mod feed_forward;
mod gains;
mod guard;
mod velocity;

pub use command::{
    Command, Diagnostics, Fault, FeedForward, MAX_ACCELERATION, MAX_SPEED, Reference, State,
};
pub use gains::{GainParameters, Gains};
pub use guard::Guard;
pub use velocity::VelocityControl;
