//! ArduPilot's `JSON` physics interface, as ArduPlane 4.6.3 speaks it.
//!
//! The simulated autopilot sends its servo outputs ([`Packet`]) by UDP and waits for one [`Sample`] each. It sends a packet again, with
//! the same count, if no answer comes within 1.1 s. [`Lockstep`] answers each count once with a new step of the [`Physics`], and again
//! with the same bytes; [`run`] does so on a socket. [`Actuators`] is what the outputs do to a tail-sitter with two elevons and two
//! motors. [`client`] is the autopilot's side, for tests.

mod actuators;
pub mod client;
mod lockstep;
mod packet;
mod sample;
mod socket;

pub use actuators::{ActuatorState, Actuators, Flow, Refused, Wrench};
pub use lockstep::{Counts, Lockstep, Physics};
pub use packet::{Malformed, Packet};
pub use sample::Sample;
pub use socket::run;

/// The UDP port that ArduPilot sends to.
pub const PORT: u16 = 9002;
