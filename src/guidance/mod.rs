//! Guidance: the velocity law with everything around it that a real vehicle asks for.

mod accelerometer;
mod bandwidth;
mod blind;
mod course;
mod flight;
mod for_vehicle;
mod goal;
mod limits;
mod memory;
mod parameters;
mod path;
mod plane;
mod planner;
mod progress;
mod status;
mod supervision;
mod tracker;
mod update;
mod virtual_flight;
mod wishes;

pub use crate::control::{Branch, Margin};
pub use bandwidth::{BandwidthGains, GainChoice};
pub use for_vehicle::{REASONS, ResponseParameters};
pub use goal::{Goal, GoalState, Goals, Preferences};
pub use parameters::GuidanceParameters;
pub use plane::{PlanarGuided, PlanarInput};
pub use progress::{Phase, Progress, Unreachable};
pub use status::Status;
pub use supervision::{Air, AirUse, MAX_STEP, MIN_STEP, Mode, Refusal};
pub use update::{Guidance, GuidanceInput, GuidanceState, Guided};
pub use wishes::Wishes;
