//! Flight control from hover to cruise, at any angle of attack, through stall.
//!
//! [`Guidance`] turns a velocity or position reference into thrust and body rates, for aircraft that thrust along their
//! body: tail-sitters and other convertibles. A step is bounded in time, needs no heap, and cannot panic.
//!
//! # Quick start
//! ```
//! use alula::prelude::*;
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     // 9 kg, k_a = ρΣ/2 = 0.51 kg/m, thrust to 196 N, a NACA 0021 wing.
//!     let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3)?;
//!     let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
//!     let guidance = Guidance::new(vehicle, &GuidanceParameters::default())?;
//!     let mut state = GuidanceState::default();
//!
//!     // Hovering with the nose up in still air, asked to fly north at 10 m/s.
//!     let reference = Reference {
//!         velocity: Ned::new(10.0, 0.0, 0.0),
//!         ..Reference::default()
//!     };
//!     let input = GuidanceInput::default()
//!         .velocity(Ned::ZERO)
//!         .orientation(Orientation::NOSE_UP)
//!         .air(Air::Wind(Ned::ZERO))
//!         .reference(reference);
//!     for _ in 0..10 {
//!         let output = guidance.update(&mut state, &input, 0.01);
//!         if output.plan_due {
//!             guidance.plan(&mut state);
//!         }
//!         let Command { thrust, rates, .. } = output.command;
//!         let BodyRates { roll, pitch, yaw } = rates;
//!         println!("{thrust} N, {roll} {pitch} {yaw} rad/s");
//!     }
//!     Ok(())
//! }
//! ```
//!
//! # Axes and signs
//! World vectors are north-east-down ([`Ned`]). Body vectors are forward-right-down: x along the nose, which is where thrust
//! points, y along the right wing, z to the belly. In hover the nose points up: pitch is 90°. [`BodyAxes`] converts from and
//! to the axes of a multicopter, whose z points to the tail.
//!
//! # Modules
//! | module | what is in it |
//! |---|---|
//! | [`prelude`] | what a user of the guidance needs |
//! | [`guidance`] | the guidance: planner, tracker, limits, supervision |
//! | [`mission`] | missions: from take-off to landing, at airspeeds, in wind |
//! | [`aero`] | aerodynamic models, and tables of measured coefficients |
//! | [`ned`] | the axes of autopilots |
//! | [`spatial`] | the law in space that the guidance flies, and its estimators |
//! | [`planar`] | the paper's laws in a vertical plane, and the theory of their equilibria |
//!
//! The law is the unified controller of D. Pucci, *Analysis and Control of Aircraft Longitudinal Dynamics with Large Flight
//! Envelopes*. Names in `code font` such as `eq:pGC` are that paper's labels.
//!
//! The core sees no clock, global, allocator or peripheral, and holds no double precision. It gives the same bits on every
//! target: its few elementary functions are its own.
//!
//! # Features
//! `defmt`: `defmt::Format` on the public types. `serde`: serialisation of parameters, inputs and outputs.
#![no_std]
#![deny(unsafe_code)]

pub mod aero;
mod air;
mod authority;
mod branch;
mod control;
mod equilibrium;
mod equivalency;
mod error;
mod frame;
pub mod guidance;
mod hover_wind;
mod math;
pub mod mission;
pub mod ned;
mod parameters;
pub mod planar;
mod propeller;
mod reference;
pub mod spatial;
mod vehicle;

pub use aero::{
    Aerodynamics, Combined, CombinedParameters, LargeAngle, LargeAngleParameters, Model,
    ModelParameters, SmallAngle, SmallAngleParameters, Table,
};
pub use air::AngleOfAttack;
pub use control::Fault;
pub use error::{ParameterError, Problem, Requirement};
pub use guidance::{
    BandwidthGains, GainChoice, Guidance, GuidanceInput, GuidanceOutput, GuidanceParameters,
    GuidanceState, Hardened, HardenedState, ResponseParameters, Tuning,
};
pub use ned::{BodyAxes, BodyRates, Frd, Ned, Quaternion};
pub use parameters::{Parameters, Range, Row};
pub use spatial::{Command, Heading, Orientation, Reference};
pub use vehicle::{Vehicle, VehicleParameters, aerodynamic_constant};

/// What a user of the guidance needs: `use alula::prelude::*`.
pub mod prelude {
    pub use crate::aero::{
        Aerodynamics, Combined, CombinedParameters, LargeAngle, LargeAngleParameters, Table,
    };
    pub use crate::error::ParameterError;
    pub use crate::guidance::{
        Air, AirUse, Goal, GoalState, Goals, Guidance, GuidanceInput, GuidanceOutput,
        GuidanceParameters, GuidanceState, Hardened, HardenedState, Mode, PlannerOptions,
        Preferences, ResponseParameters, Status,
    };
    pub use crate::ned::{BodyAxes, BodyRates, Frd, Ned, Quaternion};
    pub use crate::parameters::Parameters;
    pub use crate::spatial::{Command, Heading, Orientation, Reference};
    pub use crate::vehicle::{Vehicle, VehicleParameters, aerodynamic_constant};
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(doctest)]
#[doc = include_str!("../docs/rust.md")]
struct InRust;
