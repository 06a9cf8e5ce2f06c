//! The figure of a flight: the paper's simulation figure, and |F_p| against τ.

use plotters::prelude::*;

use super::chart::{Chart, Mark, Series, Stroke, sheet};
use crate::figures::Figures;
use crate::flight::Row;
use crate::reference::wrap;
use crate::scenario::Scenario;

pub(crate) const BLUE: RGBColor = RGBColor(0, 98, 178);
pub(crate) const ORANGE: RGBColor = RGBColor(214, 94, 0);
pub(crate) const GREEN: RGBColor = RGBColor(0, 138, 100);
pub(crate) const GREY: RGBColor = RGBColor(120, 128, 138);

/// The figure of a flight as SVG text.
pub fn svg(scenario: &Scenario, rows: &[Row], figures: &Figures) -> String {
    sheet(&charts(scenario, rows, figures), 310).expect("charts of finite ranges can be drawn")
}

fn charts(scenario: &Scenario, rows: &[Row], figures: &Figures) -> [Chart<'static>; 8] {
    let series = |name, color, value: &dyn Fn(&Row) -> f64| Series {
        name,
        color,
        stroke: Stroke::Solid,
        points: rows.iter().map(|row| (row.t, value(row))).collect(),
    };
    let chart = |title, series| Chart {
        title,
        horizontal: "time [s]",
        series,
        marks: Vec::new(),
        logarithmic: false,
    };
    let mark = |t: f64, y: f64, unit: &str| Mark {
        at: (t, y),
        label: format!("{y:.3} {unit} at {t:.3} s"),
        shift: 0,
    };

    let mut errors = chart(
        "velocity error v − v_r [m/s]",
        vec![
            series("down", BLUE, &|r| r.velocity_error().x),
            series("forward", ORANGE, &|r| r.velocity_error().y),
            Series {
                stroke: Stroke::Dashed,
                ..series("magnitude", GREY, &|r| r.velocity_error().norm())
            },
        ],
    );
    errors.marks = vec![mark(
        figures.max_velocity_error_time_s,
        figures.max_velocity_error_m_s,
        "m/s",
    )];

    let mut rate = chart(
        "angular velocity ω [rad/s]",
        vec![series("ω", BLUE, &|r| f64::from(r.command().rate))],
    );
    let at_peak = |row: &&Row| row.t == figures.max_rate_time_s;
    rate.marks = rows
        .iter()
        .find(at_peak)
        .map(|row| mark(row.t, f64::from(row.command().rate), "rad/s"))
        .into_iter()
        .collect();

    let mut force = chart(
        "apparent force |F_p| of the controller, and the guard's τ [N]",
        vec![
            series("|F_p|", BLUE, &|r| {
                r.answer
                    .map_or(f64::NAN, |c| f64::from(c.diagnostics.f_p_norm))
            }),
            Series {
                stroke: Stroke::Dashed,
                ..series("τ", ORANGE, &|_| scenario.controller.gains.tau_n)
            },
        ],
    );
    force.logarithmic = true;
    force.marks = figures
        .min_fp_n
        .zip(figures.min_fp_time_s)
        .map(|(y, t)| mark(t, y, "N"))
        .into_iter()
        .collect();

    [
        chart(
            "reference velocity v_r [m/s]",
            vec![
                series("down", BLUE, &|r| r.reference_velocity.x),
                series("forward", ORANGE, &|r| r.reference_velocity.y),
            ],
        ),
        errors,
        chart(
            "angle of attack α [°]",
            vec![angle(series("α", BLUE, &|r| r.alpha.to_degrees()))],
        ),
        rate,
        chart(
            "thrust to weight T/(m g)",
            vec![series("T/(m g)", GREEN, &|r| r.thrust_to_weight)],
        ),
        chart(
            "orientation θ [°]",
            vec![angle(series("θ", BLUE, &|r| {
                wrap(r.truth.theta).to_degrees()
            }))],
        ),
        force,
        chart(
            "θ̃, from the thrust axis to F_p [°]",
            vec![angle(series("θ̃", BLUE, &|r| {
                f64::from(r.command().diagnostics.theta_tilde()).to_degrees()
            }))],
        ),
    ]
}

/// A series of wrapped angles \[°\], broken where they wrap.
pub(crate) fn angle(mut series: Series<'_>) -> Series<'_> {
    let mut last = f64::NAN;
    for (_, value) in &mut series.points {
        let wrapped = (*value - last).abs() > 180.0;
        last = *value;
        if wrapped {
            *value = f64::NAN;
        }
    }
    series
}
