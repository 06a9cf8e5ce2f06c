//! The guidance of an experiment beside an autopilot, and the experiment's vehicle under a simulated one.

mod craft;
mod on_path;

pub use craft::Craft;
pub use on_path::{Lead, OnPath, settings};
