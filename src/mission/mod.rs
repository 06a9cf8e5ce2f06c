//! Missions: what is to be flown from take-off to landing, at airspeeds, in wind.
//!
//! [`Missions::step`] makes of a [`Mission`] the reference that [`Guidance`](crate::Guidance) takes. It needs where the vehicle is and
//! the wind as an autopilot estimates it. Nothing here is called by the guidance.
//!
//! ```
//! use alula::mission::{Gate, Item, MissionInput, MissionParameters, MissionState, Missions, Pass, Responses};
//! use alula::prelude::*;
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let wing = Combined::new(CombinedParameters::NACA_0021_RE_160E3)?;
//!     let vehicle = Vehicle::new(VehicleParameters::PAPER, wing)?;
//!     let guidance = Guidance::new(vehicle, &GuidanceParameters::default())?;
//!     let missions = Missions::new(&vehicle, &MissionParameters::cruising_at(20.0), Responses::default())?;
//!     // Up to 20 m, 400 m north at 20 m/s, a stop of 10 s, back, and down.
//!     let place = Ned::new(400.0, 0.0, -40.0);
//!     let items = [Item::TakeOff { height: 20.0 }, Item::Waypoint { place, pass: Pass::Hover(10.0) }, Item::Return];
//!     let mission = missions.mission(&items)?;
//!     let (mut flight, mut state) = (MissionState::default(), GuidanceState::default());
//!     // Every 10 ms: position, velocity and wind in; the guidance's input out. Off, nobody asks the guidance.
//!     let told = MissionInput::default().position(Ned::ZERO).armed(true);
//!     let asked = missions.step(&mut flight, &mission, &told, 0.01);
//!     let input = asked.asked_of(GuidanceInput::default().air(Air::Wind(Ned::ZERO)));
//!     let output = match asked.gate {
//!         Gate::Off => GuidanceOutput::default(),
//!         _ => guidance.update(&mut state, &input, 0.01),
//!     };
//!     if output.plan_due {
//!         guidance.plan(&mut state);
//!     }
//!     let command = output.command;
//!     let (thrust, _rates) = asked.gate.pass(command.thrust, command.rates);
//!     assert_eq!(thrust, 0.0); // on the ground, and armed: from the next step on it grows
//!     Ok(())
//! }
//! ```
//!
//! | file | what is in it |
//! |---|---|
//! | `parameters` | how missions are flown |
//! | `ability` | what the vehicle can do, from its belief: drag, glide, climb, turns |
//! | `edge_on` | the heading in hover, by the wind |
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
mod edge_on;
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
