//! The trace of a flight as CSV. The columns are listed in this package's README.

use std::io::Write;

use crate::flight::{Answer, Row, status};

/// Inputs that a replay reads, in the order of [`crate::replay`]'s parser.
pub const INPUTS: [&str; 10] = [
    "t_s",
    "v_down_m_s",
    "v_forward_m_s",
    "theta_rad",
    "wind_down_m_s",
    "wind_forward_m_s",
    "vr_down_m_s",
    "vr_forward_m_s",
    "ar_down_m_s2",
    "ar_forward_m_s2",
];

/// Inputs that a replay reads if the law is flown with feed-forward.
pub const FEED_FORWARD: [&str; 4] = [
    "aa_down_m_s2",
    "aa_forward_m_s2",
    "jr_down_m_s3",
    "jr_forward_m_s3",
];

/// What a replay writes after the time.
pub const OUTPUTS: [&str; 5] = ["thrust_n", "rate_rad_s", "alpha_rad", "fp_n", "status"];

/// The controller's diagnostics beyond [`OUTPUTS`], and the truth.
const EXTRAS: [&str; 9] = [
    "theta_tilde_rad",
    "t_p_n",
    "guard_alignment",
    "guard_feed_forward",
    "k",
    "true_alpha_rad",
    "velocity_error_down_m_s",
    "velocity_error_forward_m_s",
    "thrust_to_weight",
];

/// The cells under [`OUTPUTS`]. Single precision in its shortest form that reads back to the bit.
pub fn outputs(answer: &Answer) -> [String; 5] {
    let command = answer.unwrap_or_default();
    [
        command.thrust.to_string(),
        command.rate.to_string(),
        command.diagnostics.alpha.to_string(),
        command.diagnostics.f_p_norm.to_string(),
        status(answer).to_owned(),
    ]
}

/// Writes the trace of `rows`. The feed-forward columns are there if the law was flown with it.
pub fn write(rows: &[Row], to: impl Write) -> csv::Result<()> {
    let mut csv = csv::Writer::from_writer(to);
    let forward = rows
        .first()
        .is_some_and(|row| row.input.feed_forward.is_some());
    let names = INPUTS
        .iter()
        .chain(FEED_FORWARD.iter().filter(|_| forward))
        .chain(&OUTPUTS)
        .chain(&EXTRAS);
    csv.write_record(names)?;
    for row in rows {
        csv.write_field(row.t.to_string())?;
        let input = &row.input;
        for value in [
            input.state.velocity.down(),
            input.state.velocity.forward(),
            input.theta,
            input.state.wind.down(),
            input.state.wind.forward(),
            input.reference.velocity.down(),
            input.reference.velocity.forward(),
            input.reference.acceleration.down(),
            input.reference.acceleration.forward(),
        ] {
            csv.write_field(value.to_string())?;
        }
        if let Some(forward) = &input.feed_forward {
            for v in [forward.air_acceleration, forward.jerk] {
                csv.write_field(v.down().to_string())?;
                csv.write_field(v.forward().to_string())?;
            }
        }
        for cell in outputs(&row.answer) {
            csv.write_field(cell)?;
        }
        let diagnostics = row.command().diagnostics;
        for value in [
            diagnostics.theta_tilde(),
            diagnostics.t_p,
            diagnostics.guard_alignment,
            diagnostics.guard_feed_forward,
            diagnostics.k,
        ] {
            csv.write_field(value.to_string())?;
        }
        let error = row.velocity_error();
        for value in [row.alpha, error.x, error.y, row.thrust_to_weight] {
            csv.write_field(value.to_string())?;
        }
        csv.write_record(None::<&[u8]>)?;
    }
    csv.flush()?;
    Ok(())
}
