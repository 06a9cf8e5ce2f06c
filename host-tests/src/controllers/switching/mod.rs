//! The parts of the switching transition policies in the manner of PX4's and ArduPilot's tail-sitters.
//!
//! Written anew from their documented behaviour and parameters, with no code of theirs, for the longitudinal plane.
//! Both autopilots fly a tail-sitter as a multicopter ([`Hover`]) or as an aeroplane ([`Cruise`] in PX4's manner, [`Tecs`] in
//! ArduPilot's), and go from one to the
//! other by an open-loop pitch ramp, each in its own way. Each module says which documented parameter a field
//! stands for, and its stock value.
//!
//! They see what the guidance sees, a [`PlanarGuidanceInput`](alula::PlanarGuidanceInput), command the same rate loop under the same
//! limits, and know of the vehicle only what a user sets: the hover thrust, and of the aeroplane its trim throttle, pitch
//! and speeds. Frames are the core's: vectors (down, forward), θ = 0 nose up, −90° nose forward.
//!
//! What a person does in a real flight is made explicit: the transition [`Switch`], and that the reference is flown as a
//! flight plan. In cruise altitude and speed are held, and not the forward position, as an aeroplane follows a line; in
//! hover position is held at once, and made good at no more than the multicopter's speed limit.

pub(super) mod cruise;
mod hover;
mod measured;
mod output;
pub mod policy;
mod switch;
pub(super) mod tecs;

use serde::Serialize;

pub use cruise::{Cruise, CruiseSpec};
pub use hover::{Hover, HoverSpec};
pub use measured::Measured;
pub use output::{LimitSpec, Output};
pub use switch::{Switch, SwitchSpec};
pub use tecs::{Tecs, TecsSpec};

/// What a switching policy is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Flying as a multicopter.
    #[default]
    Hover,
    /// Pitching down to cruise.
    FrontTransition,
    /// Flying as an aeroplane.
    Cruise,
    /// Pitching up to hover.
    BackTransition,
}

impl Phase {
    /// Its name, as in the trace.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hover => "hover",
            Self::FrontTransition => "front-transition",
            Self::Cruise => "cruise",
            Self::BackTransition => "back-transition",
        }
    }
}

/// What a policy asks of attitude and thrust.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    /// θ asked for \[rad\].
    pub theta: f64,
    /// Rate per attitude error \[1/s\].
    pub gain: f64,
    /// Thrust \[N\].
    pub thrust: f64,
}

#[cfg(test)]
pub(crate) mod tests {
    use alula::guidance::Air;
    use alula::{Attitude, Inertial, PlanarGuidanceInput, Reference};

    use crate::controllers::Input;

    /// Level at `speed` and `theta` \[°\], asked for `reference` m/s at `acceleration`.
    pub(crate) fn level(speed: f32, theta: f32, reference: f32, acceleration: f32) -> Input {
        Input {
            theta: theta.to_radians(),
            sample: PlanarGuidanceInput {
                velocity: Inertial::new(0.0, speed),
                attitude: Attitude::from_angle(theta.to_radians()),
                air: Air::Velocity(Inertial::new(0.0, speed)),
                reference: Reference {
                    velocity: Inertial::new(0.0, reference),
                    acceleration: Inertial::new(0.0, acceleration),
                },
                ..PlanarGuidanceInput::default()
            },
            feed_forward: None,
        }
    }
}
