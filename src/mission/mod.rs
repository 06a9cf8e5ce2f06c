//! Missions: what is to be flown from take-off to landing, at airspeeds, in wind.
//!
//! [`Missions::step`] makes of a [`Mission`] the reference that [`Guidance`](crate::Guidance) takes. It needs where the vehicle is and
//! the wind as an autopilot estimates it. Nothing here is called by the guidance.
//!
//! | file | what is in it |
//! |---|---|
//! | `parameters` | how missions are flown |
//! | `ability` | what the vehicle can do, from its belief: drag, glide, climb, turns |
//! | `item` | the items of a mission, and why one is refused |
//! | `segment` | a line or an arc over ground, and the place on it nearest to the vehicle |
//! | `turns` | the shortest way by lines and arcs |
//! | `triangle` | speed over ground of an airspeed in wind |
//! | `follow` | a path at an airspeed, as a reference |
//! | `height` | the height of the reference |
//! | `response` | what is done when something fails |
//! | `output` | what a step says |
//! | `update` | a step |
//!
//! Not in the paper.

mod ability;
mod follow;
mod height;
mod item;
mod output;
mod parameters;
mod response;
mod segment;
mod triangle;
mod turns;
mod update;

pub use item::{CAPACITY, Item, ItemProblem, Mission, MissionError, Pass, Until};
pub use output::{Activity, Gate, MissionOutput, MissionProgress, Remark};
pub use parameters::MissionParameters;
pub use response::{Response, Responses, Troubles};
pub use update::{MissionInput, MissionState, Missions};
