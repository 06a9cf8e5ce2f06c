//! The guidance of an experiment beside an autopilot, and the experiment's vehicle under a simulated one.

mod craft;
mod ground;
mod on_path;

pub use craft::{ARDUPLANE_SHIPPED, Craft, PX4_SHIPPED, px4_rate_law};
pub use ground::Ground;
pub use on_path::{Lead, OnPath, believed, settings};
