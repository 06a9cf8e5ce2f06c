//! What a mission leaves: its trace as CSV, a figure, a page. The columns are listed in this package's README.

use std::io::Write;

use alula::Guided;
use alula::control::{AirUse, Mode};
use anyhow::Context;
use minijinja::context;

use super::figures::Figures;
use super::flight::Row;
use super::{Mission, MissionSource, Report};
use crate::reference::wrap;
use crate::report::chart::{Chart, Series, Stroke, sheet};
use crate::report::figure::{BLUE, GREEN, GREY, ORANGE, angle};
use crate::report::templates;

const COLUMNS: [&str; 27] = [
    "t_s",
    "v_down_m_s",
    "v_forward_m_s",
    "x_down_m",
    "x_forward_m",
    "theta_rad",
    "rate_rad_s",
    "thrust_n",
    "wind_down_m_s",
    "wind_forward_m_s",
    "vr_down_m_s",
    "vr_forward_m_s",
    "xr_down_m",
    "xr_forward_m",
    "command_thrust_n",
    "command_rate_rad_s",
    "v_cmd_down_m_s",
    "v_cmd_forward_m_s",
    "a_cmd_down_m_s2",
    "a_cmd_forward_m_s2",
    "alpha_rad",
    "fp_n",
    "margin_k",
    "margin_fold_rad",
    "mode",
    "air",
    "status",
];

/// The name of a mode in traces.
pub fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Safe => "safe",
        Mode::Holding => "holding",
        Mode::Flying => "flying",
    }
}

/// The name in traces of what of the air is used.
pub fn air_name(air: AirUse) -> &'static str {
    match air {
        AirUse::Velocity => "velocity",
        AirUse::Wind => "wind",
        AirUse::HeldWind => "held-wind",
        AirUse::None => "none",
    }
}

/// Writes the trace of `rows`.
pub fn write_trace(rows: &[Row], to: impl Write) -> csv::Result<()> {
    let mut csv = csv::Writer::from_writer(to);
    csv.write_record(COLUMNS)?;
    for row in rows {
        let truth = &row.truth;
        for value in [
            row.t,
            truth.velocity.x,
            truth.velocity.y,
            truth.position.x,
            truth.position.y,
            wrap(truth.theta),
            truth.rate,
            truth.thrust,
            row.wind.x,
            row.wind.y,
            row.reference_velocity.x,
            row.reference_velocity.y,
            row.reference_position.x,
            row.reference_position.y,
        ] {
            csv.write_field(value.to_string())?;
        }
        for value in [row.answer.thrust, row.answer.rate] {
            csv.write_field((value as f32).to_string())?;
        }
        let (values, words) = match &row.answer.report {
            Report::Guided(guided) => said(guided),
            // Of what only the guidance has there is none.
            Report::Switching(phase) => (
                [f32::NAN; 8],
                [phase.name().into(), String::new(), String::new()],
            ),
        };
        for value in values {
            csv.write_field(value.to_string())?;
        }
        csv.write_record(words)?;
    }
    csv.flush()?;
    Ok(())
}

/// What the guidance says: v_cmd, a_cmd, α, |F_p| and the margins; mode, air and status.
fn said(guided: &Guided) -> ([f32; 8], [String; 3]) {
    (
        [
            guided.reference.velocity.down(),
            guided.reference.velocity.forward(),
            guided.reference.acceleration.down(),
            guided.reference.acceleration.forward(),
            guided.command.diagnostics.alpha,
            guided.command.diagnostics.f_p_norm,
            guided.margin.k,
            guided.margin.fold,
        ],
        [
            mode_name(guided.mode).into(),
            air_name(guided.air).into(),
            guided.status.to_string(),
        ],
    )
}

/// The figure of a mission as SVG text.
pub fn svg(mission: &Mission, rows: &[Row]) -> String {
    sheet(&charts(mission, rows), 310).expect("charts of finite ranges can be drawn")
}

/// What the guidance says; NaN, which is not drawn, of another controller.
fn of(row: &Row, value: impl Fn(&Guided) -> f32) -> f64 {
    row.answer
        .guided()
        .map_or(f64::NAN, |g| f64::from(value(g)))
}

fn charts(mission: &Mission, rows: &[Row]) -> [Chart<'static>; 8] {
    let series = |name, color, value: &dyn Fn(&Row) -> f64| Series {
        name,
        color,
        stroke: Stroke::Solid,
        points: rows.iter().map(|row| (row.t, value(row))).collect(),
    };
    let dashed = |name, color, value: &dyn Fn(&Row) -> f64| Series {
        stroke: Stroke::Dashed,
        ..series(name, color, value)
    };
    let chart = |title, series| Chart {
        title,
        horizontal: "time [s]",
        series,
        marks: Vec::new(),
        logarithmic: false,
    };
    let weight = mission.vehicle.mass_kg * mission.vehicle.gravity_m_s2;
    [
        chart(
            "forward velocity [m/s]",
            vec![
                series("v", BLUE, &|r| r.truth.velocity.y),
                dashed("v_r", ORANGE, &|r| r.reference_velocity.y),
                dashed("v_cmd", GREY, &|r| {
                    of(r, |g| g.reference.velocity.forward())
                }),
            ],
        ),
        chart(
            "downward velocity [m/s]",
            vec![
                series("v", BLUE, &|r| r.truth.velocity.x),
                dashed("v_r", ORANGE, &|r| r.reference_velocity.x),
                dashed("v_cmd", GREY, &|r| of(r, |g| g.reference.velocity.down())),
            ],
        ),
        chart(
            "altitude over the reference [m]",
            vec![series("h", BLUE, &|r| -r.position_error().x)],
        ),
        chart(
            "forward of the reference [m]",
            vec![series("x̃", BLUE, &|r| r.position_error().y)],
        ),
        chart(
            "orientation θ and the controller's angle of attack α [°]",
            vec![
                angle(series("θ", BLUE, &|r| wrap(r.truth.theta).to_degrees())),
                angle(series("α", ORANGE, &|r| {
                    of(r, |g| g.command.diagnostics.alpha).to_degrees()
                })),
            ],
        ),
        chart(
            "angular velocity ω [rad/s]",
            vec![
                series("ω", BLUE, &|r| r.truth.rate),
                dashed("command", ORANGE, &|r| r.answer.rate),
            ],
        ),
        chart(
            "thrust to weight T/(m g)",
            vec![
                series("T/(m g)", GREEN, &|r| r.truth.thrust / weight),
                dashed("command", ORANGE, &|r| r.answer.thrust / weight),
            ],
        ),
        chart(
            "angle to the nearest fold, first order, within 45° [°]",
            vec![series("fold", BLUE, &|r| {
                let fold = of(r, |g| g.margin.fold).to_degrees();
                if fold.abs() < 45.0 { fold } else { f64::NAN }
            })],
        ),
    ]
}

/// The page about a mission, with its figure `svg` inside.
pub fn html(
    source: &MissionSource,
    rows: &[Row],
    figures: &Figures,
    svg: &str,
) -> anyhow::Result<String> {
    let mission = &source.mission;
    let mut table: Vec<[String; 3]> = figures
        .table()
        .into_iter()
        .map(|[label, value]| [label, value, String::new()])
        .collect();
    table.extend(
        figures
            .segments
            .iter()
            .map(|s| ["segment".to_owned(), s.line(), String::new()]),
    );
    templates()?
        .get_template("report.html")?
        .render(context! {
            name => &source.name,
            description => &mission.description,
            duration => mission.duration_s,
            rate => mission.control_rate_hz,
            rows => rows.len(),
            table,
            toml => &source.text,
            svg,
            version => env!("CARGO_PKG_VERSION"),
        })
        .context("the report's template")
}
