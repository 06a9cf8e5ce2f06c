//! What a guidance step gives.

use super::progress::Progress;
use super::status::Status;
use super::supervision::{AirUse, Mode, RejectReason};
use crate::control::Margin;
use crate::spatial::{Command, Reference};

/// What a guidance step gives: always a command.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct GuidanceOutput {
    /// The command, inside its limits. Its diagnostics are those of the law, before the limits; in
    /// [`Mode::Holding`] and [`Mode::Safe`] they are zero.
    pub command: Command,
    /// Mode.
    pub mode: Mode,
    /// What of the air was used.
    pub air: AirUse,
    /// What limited the step.
    pub status: Status,
    /// Margins of well-posedness; zero unless the law was flown.
    pub margin: Margin,
    /// The reference that the law was given: the reference model's velocity, pull and integral, and its acceleration.
    pub reference: Reference,
    /// What is being done, and what of the reference cannot be had.
    pub progress: Progress,
    /// Whether a plan is due: [`Guidance::plan`](super::Guidance::plan) is to be called.
    pub plan_due: bool,
    /// Why the frame was refused, if it was.
    pub reject_reason: Option<RejectReason>,
}
