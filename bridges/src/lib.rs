//! alula against real autopilots.
//!
//! [`sitl`]: a plant that takes the place of ArduPilot's own physics, over its `JSON` interface.
//! [`companion`]: a controller that flies an autopilot over MAVLink, and a simulated autopilot to try it on.
//!
//! Everything that comes from the network is read by functions of bytes that never panic, and what is malformed is counted and dropped.
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]
#![forbid(unsafe_code)]

#[cfg(feature = "companion")]
pub mod companion;
pub mod sitl;
