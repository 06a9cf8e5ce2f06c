//! How a flight is divided into control steps.

use super::{FieldError, positive};

/// Most control steps of one flight: the trace is held in memory.
const MAX_STEPS: f64 = 2e6;

/// Checks the fields `duration_s`, `control_rate_hz` and `substeps`.
pub(crate) fn validate_steps(
    duration_s: f64,
    control_rate_hz: f64,
    substeps: u32,
) -> Result<(), FieldError> {
    positive("duration_s", duration_s)?;
    positive("control_rate_hz", control_rate_hz)?;
    let steps = duration_s * control_rate_hz;
    if !(0.5..=MAX_STEPS).contains(&steps) {
        let problem = format!("{steps} control steps, must be from 1 to {MAX_STEPS}");
        return Err(FieldError::new("duration_s", problem));
    }
    if !(1..=1000).contains(&substeps) {
        return Err(FieldError::new("substeps", "must be from 1 to 1000"));
    }
    Ok(())
}

/// Number of control periods in a flight.
pub(crate) fn steps(duration_s: f64, control_rate_hz: f64) -> usize {
    (duration_s * control_rate_hz).round() as usize
}
