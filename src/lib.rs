//! Longitudinal flight control from hover to cruise.
#![no_std]
#![deny(unsafe_code)]
pub mod aero;
pub mod air;
mod error;
pub mod frame;
mod math;
pub use error::*;
