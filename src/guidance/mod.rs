//! Guidance: the velocity law with everything around it that a real vehicle asks for.

mod accelerometer;
mod air_data_fallback;
mod air_estimate;
mod bandwidth;
mod course;
mod for_vehicle;
mod goal;
mod hardened;
mod lateral_guidance;
mod limits;
mod memory;
mod parameters;
mod path;
pub(crate) mod plane;
mod planner;
mod planner_options;
mod progress;
mod reference_model;
mod setters;
mod status;
mod supervision;
mod tracker;
mod update;

pub use crate::control::{Branch, Margin};
pub use bandwidth::{BandwidthGains, GainChoice};
pub use for_vehicle::{REASONS, ResponseParameters};
pub use goal::{Goal, GoalOutput, GoalState, Goals, Preferences};
pub use hardened::{Hardened, HardenedState};
pub use parameters::GuidanceParameters;
pub use planner_options::PlannerOptions;
pub use progress::{Phase, Progress, Unreachable};
pub use status::Status;
pub use supervision::{Air, AirUse, MAX_STEP, MIN_STEP, Mode, RejectReason};
pub use update::{Guidance, GuidanceInput, GuidanceOutput, GuidanceState};
