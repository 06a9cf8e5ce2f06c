//! The parts of the image that need no target: the supervised control loop and the thrust output.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod arming;
pub mod flight;
pub mod port;
pub mod thrust;
pub mod tick;
