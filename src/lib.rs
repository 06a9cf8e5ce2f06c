//! Longitudinal flight control from hover to cruise, at any angle of attack, through stall.
//!
//! `alula` turns (state, reference) into (thrust, angular rate) for aircraft that thrust along their body: tail-sitters
//! and other convertibles. It implements the unified controller of D. Pucci, *Analysis and Control of Aircraft
//! Longitudinal Dynamics with Large Flight Envelopes*; names in `code font` such as `eq:pGC` are that paper's labels.
//!
//! # A step
//! ```
//! use alula::*;
//!
//! // What the controller believes of the aircraft: NACA 0021 wing, 9 kg, k_a = ρΣ/2 = 0.51 kg/m.
//! let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3)?;
//! let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
//! let control = VelocityControl::new(vehicle, Gains::new(GainParameters::PAPER)?);
//!
//! // Hovering nose up in still air, asked to fly forward at 2 m/s and to gain 2 m/s² on the way.
//! let state = State { attitude: Attitude::from_angle(0.0), ..State::default() };
//! let reference = Reference {
//!     velocity: Inertial::new(0.0, 2.0),
//!     acceleration: Inertial::new(0.0, 2.0),
//! };
//!
//! // A fault never comes with a command; the default command is the safe one, no thrust and no rotation.
//! let command = control.robust(&state, &reference, None).unwrap_or_default();
//! assert!(command.thrust > 80.0); // about the weight [N]
//! assert!(command.rate < 0.0); // nose forward [rad/s]
//! # Ok::<(), ParameterError>(())
//! ```
//!
//! The law alone flies an ideal aircraft. [`Guidance`] puts around it what a real one asks for: position hold and integral
//! action, limits, supervision; and [`BandwidthGains`] bear the lags of real rate loops.
//!
//! # Axes and signs
//! Inertial vectors are (down, forward); θ = 0 is hover with the nose up, θ = −90° cruise with the nose forward;
//! thrust acts along the nose. See [`frame`] and [`air`], and [`ned`] for the axes of autopilots.
//!
//! # Layers
//! [`Parameters`], [`frame`] ← [`air`] ← [`aero`] ← [`Vehicle`] ← [`equivalency`] ← {[`control`] ← [`spatial`] ← [`guidance`], [`equilibrium`]};
//! no arrow points back. The core sees no
//! clock, global, allocator or peripheral, holds no panic and no double precision, and gives the same bits on every
//! target: its few elementary functions are its own.
//!
//! # Features
//! `defmt`: `defmt::Format` on the public types. `serde`: serialisation of parameters, inputs and outputs.
#![no_std]
#![deny(unsafe_code)]

pub mod aero;
pub mod air;
mod branch;
pub mod control;
pub mod equilibrium;
pub mod equivalency;
mod error;
pub mod frame;
pub mod guidance;
mod math;
pub mod ned;
mod parameters;
mod reference;
pub mod spatial;
mod vehicle;

pub use aero::{
    Aerodynamics, Combined, CombinedParameters, LargeAngle, LargeAngleParameters, Model,
    ModelParameters, SmallAngle, SmallAngleParameters, Table,
};
pub use air::{AirData, AngleOfAttack, ThrustLine};
pub use control::{
    Command, Diagnostics, Fault, FeedForward, GainParameters, Gains, State, VelocityControl,
};
pub use equilibrium::{Equilibria, Equilibrium, EquilibriumError, FoldMap, FoldMargin};
pub use error::{ParameterError, Problem};
pub use frame::{Attitude, Body, Inertial};
pub use guidance::{
    BandwidthGains, GainChoice, Guidance, GuidanceInput, GuidanceOutput, GuidanceParameters,
    GuidanceState, PlanarGuidanceInput, PlanarGuidanceOutput, ResponseParameters,
};
pub use parameters::{Parameters, Range, Row};
pub use reference::Reference;
pub use vehicle::{Vehicle, VehicleParameters, aerodynamic_constant};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
