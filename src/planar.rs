//! The paper's laws, in a vertical plane, and the theory of their equilibria.
//!
//! D. Pucci, *Analysis and Control of Aircraft Longitudinal Dynamics with Large Flight Envelopes*. [`Guidance`](crate::Guidance)
//! flies these laws in its plane of symmetry; a user of the guidance needs none of this module.
//! [`PlanarGuidanceInput`] is for simulations in one plane.
//!
//! # Axes and signs
//! Inertial vectors are (down, forward). Body axes are i, towards the tail, and j, towards the belly. θ = 0 is hover with
//! the nose up, θ = −90° cruise with the nose forward: pitch less 90°. Thrust acts along −i.
//!
//! # A step
//! ```
//! use alula::planar::*;
//! use alula::{Combined, CombinedParameters, ParameterError, Vehicle, VehicleParameters};
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

pub use crate::air::{AirData, ThrustLine};
pub use crate::control::{
    Command, Diagnostics, FeedForward, GainLaw, GainParameters, GainValues, Gains, Guard, Law,
    MAX_ACCELERATION, MAX_SPEED, Reference, State, VelocityControl,
};
pub use crate::frame::{Attitude, Body, Inertial};
pub use crate::guidance::plane::{PlanarGuidanceInput, PlanarGuidanceOutput};

/// Spherical equivalency: the thrust change of variable that makes the aerodynamic force look like a sphere's.
pub mod equivalency {
    pub use crate::equivalency::*;
}

pub mod equilibrium {
    //! Which orientations hold a reference, with what thrust, and how far the next jump is.
    pub use crate::equilibrium::*;
}
