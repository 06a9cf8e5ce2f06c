//! The companion against the simulated autopilot, over UDP on loopback. Time is simulated: a datagram is sent when the link lets it
//! through, and received before time goes on.

mod first_attempt;
mod link;
mod mission;
mod paths;
mod round_trip;
