//! Control: the paper's laws, pure functions from (state, reference) to (thrust, angular rate).
//!
//! [`VelocityControl`] is stateless. [`Guidance`](crate::Guidance) flies it on a real vehicle.

mod command;
pub(crate) mod feed_forward;
mod gains;
mod guard;
mod margin;
mod velocity;

pub use crate::branch::Branch;
pub use crate::reference::{MAX_ACCELERATION, MAX_SPEED, Reference};
pub use command::{Command, Diagnostics, Fault, FeedForward, State};
pub use gains::{GainLaw, GainParameters, GainValues, Gains};
pub use guard::Guard;
pub use margin::Margin;
pub use velocity::{Law, VelocityControl};
