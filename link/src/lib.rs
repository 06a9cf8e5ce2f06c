//! The link between the image on the target and its host: messages, the frames that carry them, and the controller that
//! both ends make of a configuration ([`Controller`]).
//!
//! - Every float travels as its 32 bits: what is computed on the target from a received input is what would be
//!   computed on the host.
//! - The host numbers its messages within a session ([`Envelope`]). A session begins with the first message
//!   that carries a newer session number than any before; the target then forgets its configuration. A message
//!   of an older session is stale, one not newer than the last is out of order; both are dropped ([`Order`]).
//! - A frame is checked before anything in it is looked at ([`Receiver`]): damage of any kind is counted
//!   ([`Counters`]) and never acted on.
//! - The target answers every configuration and every input, and announces its [`Status`] unasked at power-on,
//!   whenever the link is lost, and twice a second while it does not fly.
//!
//! Bytes on the wire: see [`frame`].
#![no_std]
#![forbid(unsafe_code)]

#[cfg(any(test, feature = "damage"))]
extern crate std;

mod controller;
#[cfg(any(test, feature = "damage"))]
pub mod damage;
pub mod frame;
mod message;
mod order;

pub use controller::Controller;
pub use frame::{Counters, MAX_FRAME, Receiver, VERSION, encode};
pub use message::{
    Answer, Configuration, ControllerParameters, Envelope, FromTarget, InForce, Input, Law,
    LawGains, Pacing, Phase, RefusedParameter, Status, ToTarget,
};
pub use order::{Admission, Order};
