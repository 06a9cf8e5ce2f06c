//! Guidance: the velocity law with everything around it that a real vehicle asks for.

mod bandwidth;
mod branch_switch;
mod limits;
mod outer_loop;
mod parameters;
mod plane_change;
mod reference_limit;
mod status;
mod supervision;
mod update;

pub use crate::control::{Branch, Margin};
pub use bandwidth::{BandwidthGains, GainChoice};
pub use parameters::GuidanceParameters;
pub use plane_change::{Across, InputAcross};
pub use status::Status;
pub use supervision::{Air, AirUse, MAX_STEP, MIN_STEP, Mode, Refusal};
pub use update::{Guidance, GuidanceInput, GuidanceState, Guided};
