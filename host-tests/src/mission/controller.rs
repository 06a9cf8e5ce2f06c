//! `[controller]` of a mission: who flies.

use alula::{GuidanceInput, GuidanceState, Guided};
use serde::Deserialize;

use super::guidance::{GuidanceSpec, MissionGuidance};
use crate::baseline::{ArduPilotLike, ArduPilotLikeSpec, Phase, Px4Like, Px4LikeSpec};
use crate::scenario::{FieldError, VehicleSpec};

/// `[controller.…]`: exactly one.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ControllerSpec {
    /// The core's guidance.
    Guidance(Box<GuidanceSpec>),
    /// A baseline: switching transitions in the manner of PX4.
    Px4Like(Box<Px4LikeSpec>),
    /// A baseline: switching transitions in the manner of ArduPilot.
    #[serde(rename = "ardupilot-like")]
    ArduPilotLike(Box<ArduPilotLikeSpec>),
}

/// What a controller answers to one step's input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Thrust T \[N\].
    pub thrust: f64,
    /// Angular rate ω \[rad/s\].
    pub rate: f64,
    /// What else it says.
    pub report: Report,
}

/// What a controller says of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Report {
    /// The core's guidance.
    Guided(Guided),
    /// A baseline.
    Switching(Phase),
}

/// Whoever closes the loop of a mission, with what it remembers between steps.
pub trait Pilot {
    /// The answer to `input`, `dt` \[s\] after the last.
    fn answer(&mut self, input: &GuidanceInput, dt: f32) -> Answer;
}

impl ControllerSpec {
    /// The controller of a vehicle that is `truth`.
    pub fn pilot(&self, truth: &VehicleSpec) -> Result<Box<dyn Pilot>, FieldError> {
        Ok(match self {
            Self::Guidance(spec) => Box::new(Guide {
                guidance: spec.guidance(truth)?,
                holds_position: spec.position.measured,
                memory: GuidanceState::default(),
            }),
            Self::Px4Like(spec) => Box::new(Px4Like::new(spec, "controller.px4-like")?),
            Self::ArduPilotLike(spec) => {
                Box::new(ArduPilotLike::new(spec, "controller.ardupilot-like")?)
            }
        })
    }

    /// The guidance, if it is the guidance that flies.
    pub fn guidance(&self) -> Option<&GuidanceSpec> {
        match self {
            Self::Guidance(spec) => Some(spec),
            Self::Px4Like(_) | Self::ArduPilotLike(_) => None,
        }
    }

    /// The guidance, to be changed.
    pub fn guidance_mut(&mut self) -> Option<&mut GuidanceSpec> {
        match self {
            Self::Guidance(spec) => Some(spec),
            Self::Px4Like(_) | Self::ArduPilotLike(_) => None,
        }
    }
}

/// The core's guidance with its memory.
struct Guide {
    guidance: MissionGuidance,
    holds_position: bool,
    memory: GuidanceState,
}

impl Pilot for Guide {
    fn answer(&mut self, input: &GuidanceInput, dt: f32) -> Answer {
        let position_error = input.position_error.filter(|_| self.holds_position);
        let input = GuidanceInput {
            position_error,
            ..*input
        };
        let guided = self.guidance.update(&mut self.memory, &input, dt);
        Answer {
            thrust: f64::from(guided.command.thrust),
            rate: f64::from(guided.command.rate),
            report: Report::Guided(guided),
        }
    }
}

impl Answer {
    /// What the guidance says, if it flies.
    pub fn guided(&self) -> Option<&Guided> {
        match &self.report {
            Report::Guided(guided) => Some(guided),
            Report::Switching(_) => None,
        }
    }
}
