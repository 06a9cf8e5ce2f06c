//! Control: a pure law from (state, reference) to (thrust, angular rate), and the guidance around it.
//!
//! [`VelocityControl`] is the paper's law: stateless. [`Guidance`] flies it on a real vehicle: it adds what needs
//! memory, and keeps all of that in [`GuidanceState`].

mod bandwidth;
mod branch_switch;
mod command;
pub(crate) mod feed_forward;
mod gains;
mod guard;
mod guidance;
mod limits;
mod margin;
mod outer_loop;
mod reference_limit;
mod status;
mod supervision;
mod velocity;

pub use crate::branch::Branch;
pub use crate::reference::{MAX_ACCELERATION, MAX_SPEED, Reference};
pub use bandwidth::{BandwidthGains, BandwidthParameters};
pub use branch_switch::{BranchParameters, BranchState, BranchSwitch};
pub use command::{Command, Diagnostics, Fault, FeedForward, State};
pub use gains::{GainChoice, GainLaw, GainParameters, GainValues, Gains};
pub use guard::Guard;
pub use guidance::{Guidance, GuidanceInput, GuidanceState, Guided};
pub use limits::{LimitParameters, LimitState, Limits};
pub use margin::Margin;
pub use outer_loop::{OuterLoop, OuterLoopParameters, OuterState};
pub use reference_limit::{ReferenceLimit, ReferenceLimitParameters, ReferenceState};
pub use status::Status;
pub use supervision::{
    Air, AirUse, MAX_STEP, Mode, Refusal, SupervisionParameters, SupervisionState, Supervisor,
};
pub use velocity::VelocityControl;
