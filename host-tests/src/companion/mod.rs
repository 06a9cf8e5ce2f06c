//! The guidance of an experiment beside an autopilot, and the experiment's vehicle under a simulated one.

mod craft;
mod ground;
mod on_path;

pub use craft::Craft;
pub use ground::Ground;
pub use on_path::{Lead, OnPath, settings};
