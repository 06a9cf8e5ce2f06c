//! A controller beside an autopilot, over MAVLink.
//!
//! [`Companion`] takes what the autopilot says of its state, asks its [`Pilot`], and gives body rates and thrust. PX4 follows them in
//! OFFBOARD, as `SET_ATTITUDE_TARGET` (type mask 128); ArduPlane in QACRO, as sticks of `RC_CHANNELS_OVERRIDE`: [`Kind`].
//! [`Autopilot`] is a simulated one that keeps the rules of either, around any [`Body`]. [`GroundStation`] is the companion as a vehicle to a
//! ground station, with the mission that this uploads. All are state machines that are told the time: whoever owns a connection carries
//! their messages. [`wire`] is messages from and to bytes.
//!
//! Body axes are those of hover, as PX4 has a tail-sitter's: x to the belly, y along the right wing, z along the tail.

mod autopilot;
mod clock;
mod connection;
mod detector;
mod ground;
mod inbox;
mod kind;
mod machine;
mod nudge;
mod offboard;
mod outbox;
mod parameters;
pub mod preflight;
mod qacro;
mod setpoint;
mod stage;
mod sticks;
mod telemetry;
pub mod wire;

pub use autopilot::{Autopilot, Body, BodyState};
pub use clock::Clock;
pub use connection::{Connection, Received};
pub use ground::{Change, GroundStation, MissionItems, Refused, Shown};
pub use inbox::{Counts, Inbox};
pub use kind::{HOLD, Kind, OFFBOARD, QACRO, QLOITER, TERMINATION};
pub use machine::Companion;
pub use nudge::{Loop, Nudge, Turning};
pub use parameters::Parameters;
pub use preflight::{Believed, Finding, Preflight, Weight, is_go};
pub use setpoint::Setpoint;
pub use stage::{Command, End, Pilot, Settings, Stage, Told};
pub use sticks::Sticks;

pub use mavlink::MavHeader;
pub use mavlink::dialects::ardupilotmega as messages;
pub use messages::MavMessage;

/// The system of most autopilots.
const OWN_SYSTEM: u8 = 1;
/// The time stamp \[ms\] of `now` \[s\].
fn milliseconds(now: f64) -> u32 {
    (now * 1e3) as u64 as u32
}
