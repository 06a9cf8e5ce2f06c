//! Longitudinal flight control from hover to cruise.
#![no_std]
#![deny(unsafe_code)]

pub mod aero;
pub mod air;
pub mod control;
pub mod equivalency;
mod error;
pub mod frame;
mod math;
mod vehicle;

pub use aero::{
    Aerodynamics, Combined, CombinedParameters, LargeAngle, LargeAngleParameters, Model,
    SmallAngle, SmallAngleParameters,
};
pub use air::{AirData, AngleOfAttack, ThrustLine};
pub use control::{
    Command, Diagnostics, Fault, FeedForward, GainParameters, Gains, Reference, State,
    VelocityControl,
};
pub use error::{ParameterError, Problem};
pub use frame::{Attitude, Body, Inertial};
pub use vehicle::{Vehicle, VehicleParameters, aerodynamic_constant};
