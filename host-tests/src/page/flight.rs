//! The page about a flight: charts of the record's columns, the figures, the experiment.

use plotters::style::RGBColor;

use super::chart::{BLUE, Chart, GREEN, GREY, Mark, ORANGE, Series, Stroke, sheet};
use super::{Page, Table, columns};
use crate::columns::{Column, column};
use crate::experiment::{Document, Experiment};
use crate::figures::{Figures, Segment};
use crate::reference::wrap;
use crate::simulate::Step;

/// A chart of columns.
struct Panel {
    title: &'static str,
    /// Name in the legend, column, colour, whether dashed.
    lines: &'static [(&'static str, &'static str, RGBColor, bool)],
    /// The figure whose extreme is marked, on a column.
    mark: Option<(&'static str, &'static str)>,
    logarithmic: bool,
}

const fn panel(
    title: &'static str,
    lines: &'static [(&'static str, &'static str, RGBColor, bool)],
) -> Panel {
    Panel {
        title,
        lines,
        mark: None,
        logarithmic: false,
    }
}

const PANELS: &[Panel] = &[
    panel(
        "forward velocity [m/s]",
        &[
            ("v", "true_v_forward_m_s", BLUE, false),
            ("v_r", "vr_forward_m_s", ORANGE, true),
            ("v_cmd", "v_cmd_forward_m_s", GREY, true),
        ],
    ),
    panel(
        "downward velocity [m/s]",
        &[
            ("v", "true_v_down_m_s", BLUE, false),
            ("v_r", "vr_down_m_s", ORANGE, true),
            ("v_cmd", "v_cmd_down_m_s", GREY, true),
        ],
    ),
    Panel {
        mark: Some(("max_velocity_error_m_s", "velocity_error_m_s")),
        ..panel(
            "velocity error v − v_r [m/s]",
            &[
                ("down", "velocity_error_down_m_s", BLUE, false),
                ("forward", "velocity_error_forward_m_s", ORANGE, false),
                ("magnitude", "velocity_error_m_s", GREY, true),
            ],
        )
    },
    panel(
        "altitude over the reference [m]",
        &[("h", "altitude_m", BLUE, false)],
    ),
    panel(
        "forward of the reference [m]",
        &[("x̃", "forward_m", BLUE, false)],
    ),
    panel(
        "orientation θ and angle of attack α [°]",
        &[
            ("θ", "true_theta_rad", BLUE, false),
            ("α", "true_alpha_rad", ORANGE, false),
        ],
    ),
    Panel {
        mark: Some(("max_rate_rad_s", "rate_rad_s")),
        ..panel(
            "angular velocity ω [rad/s]",
            &[
                ("ω", "true_rate_rad_s", BLUE, false),
                ("command", "rate_rad_s", ORANGE, true),
            ],
        )
    },
    panel(
        "thrust to weight T/(m g)",
        &[("T/(m g)", "thrust_to_weight", GREEN, false)],
    ),
    Panel {
        mark: Some(("min_fp_n", "fp_n")),
        logarithmic: true,
        ..panel(
            "apparent force |F_p| of the controller, and the guard's τ [N]",
            &[("|F_p|", "fp_n", BLUE, false)],
        )
    },
    panel(
        "θ̃, from the thrust axis to F_p [°]",
        &[("θ̃", "theta_tilde_rad", BLUE, false)],
    ),
    panel(
        "angle to the nearest fold, first order, within 45° [°]",
        &[("fold", "margin_fold_rad", BLUE, false)],
    ),
];

/// Angles to a fold beyond this are not drawn \[°\].
const FOLD: f64 = 45.0;

/// The figure of a flight as SVG text.
pub fn svg(experiment: &Experiment, record: &[Step], figures: &Figures) -> String {
    let chart = |panel| chart(panel, experiment, record, figures);
    let charts: Vec<Chart> = PANELS.iter().filter_map(chart).collect();
    sheet(&charts, 310).expect("charts of finite ranges can be drawn")
}

/// The chart of a panel, if any of its columns applies to the flight.
fn chart(
    panel: &Panel,
    experiment: &Experiment,
    record: &[Step],
    figures: &Figures,
) -> Option<Chart<'static>> {
    let mut series: Vec<Series> = Vec::new();
    for (name, of, color, dashed) in panel.lines {
        let column = column(of).expect("a column");
        if column.applies(experiment, record) {
            let stroke = if *dashed {
                Stroke::Dashed
            } else {
                Stroke::Solid
            };
            let points = points(column, experiment, record);
            series.push(Series {
                name,
                color: *color,
                stroke,
                points,
            });
        }
    }
    let gains = experiment.spec().ok()?;
    let belief = gains.belief().unwrap_or(&experiment.vehicle);
    let tau = gains.gains(belief).map(|gains| gains.tau());
    if let (true, false, Some(tau)) = (panel.logarithmic, series.is_empty(), tau) {
        let ends = [0.0, experiment.duration_s];
        series.push(Series {
            name: "τ",
            color: ORANGE,
            stroke: Stroke::Dashed,
            points: ends.map(|t| (t, tau)).to_vec(),
        });
    }
    let mark = panel.mark.and_then(|(figure, of)| {
        let at = figures.when(figure)?;
        let step = record.iter().find(|step| step.t == at)?;
        let y = column(of)?.number(experiment, step);
        let unit = panel.title.rsplit('[').next()?.trim_end_matches(']');
        Some(Mark {
            at: (at, y),
            label: format!("{y:.3} {unit} at {at:.3} s"),
            shift: 0,
        })
    });
    (!series.is_empty()).then(|| Chart {
        marks: mark.into_iter().collect(),
        logarithmic: panel.logarithmic,
        ..Chart::over_time(panel.title, series)
    })
}

/// The points of a column; angles in degrees, broken where they wrap.
pub(super) fn points(column: &Column, experiment: &Experiment, record: &[Step]) -> Vec<(f64, f64)> {
    let is_angle = column.name.ends_with("_rad");
    let is_fold = column.name == "margin_fold_rad";
    let mut last = f64::NAN;
    let point = |step: &Step| {
        let mut value = column.number(experiment, step);
        if is_fold && value.to_degrees().abs() > FOLD {
            value = f64::NAN;
        }
        // What is no number stays so: it is not drawn.
        if is_angle && !value.is_nan() {
            value = wrap(value).to_degrees();
            let wrapped = (value - last).abs() > 180.0;
            last = value;
            if wrapped {
                value = f64::NAN;
            }
        }
        (step.t, value)
    };
    record.iter().map(point).collect()
}

/// The page about a flight.
pub fn page(
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
    figures: &Figures,
    segments: &[Segment],
) -> Page {
    let mut tables = vec![Table {
        title: "Figures of merit".to_owned(),
        header: columns(["", "value", ""]),
        rows: figures.table().iter().map(|row| row.to_vec()).collect(),
    }];
    if segments.len() > 1 {
        tables.push(Table {
            title: "Segments of the reference [s]".to_owned(),
            header: columns([""]),
            rows: segments.iter().map(|s| vec![s.line()]).collect(),
        });
    }
    let (duration, rate) = (experiment.duration_s, experiment.control_rate_hz);
    Page {
        title: document.name.clone(),
        lead: format!(
            "{}{}{duration} s, control at {rate} Hz",
            experiment.description,
            if experiment.description.is_empty() {
                ""
            } else {
                " · "
            },
        ),
        svg: svg(experiment, record, figures),
        tables,
        text: Some(("The experiment as flown (TOML)".to_owned(), document.text())),
        notes: format!(
            "{} control steps. |F_p| and θ̃ are the controller's own, all else is the simulated vehicle's. The same steps are in \
             trace.csv.",
            record.len()
        ),
    }
}
