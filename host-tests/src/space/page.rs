//! The page about a flight in space: the picture, charts of the record's columns, the figures, the experiment.

use plotters::style::RGBColor;

use super::columns::column;
use super::picture::{HIGH, WIDE, picture};
use super::{Experiment, Figures, Step};
use crate::experiment::Document;
use crate::page::chart::{BLUE, Chart, GREEN, GREY, ORANGE, Series, sheet};
use crate::page::{Page, Table, columns};

/// A chart of columns: its title; name in the legend, column, colour and whether dashed of each line.
type Panel = (
    &'static str,
    &'static [(&'static str, &'static str, RGBColor, bool)],
);

const PANELS: &[Panel] = &[
    (
        "altitude [m]",
        &[
            ("flown", "down_m", BLUE, false),
            ("path", "path_down_m", ORANGE, true),
        ],
    ),
    (
        "errors of position [m] and velocity [m/s]",
        &[
            ("position", "position_error_m", BLUE, false),
            ("velocity", "velocity_error_m_s", ORANGE, false),
        ],
    ),
    (
        "nose over the horizon and right wing below it [°]",
        &[
            ("nose", "pitch_rad", BLUE, false),
            ("bank", "bank_rad", ORANGE, false),
        ],
    ),
    (
        "angle of attack and sideslip [°]",
        &[
            ("α", "alpha_rad", BLUE, false),
            ("sideslip", "sideslip_rad", ORANGE, false),
        ],
    ),
    (
        "body rates [rad/s]",
        &[
            ("about the wing", "rate_wing_rad_s", BLUE, false),
            ("about the tail", "rate_tail_rad_s", ORANGE, false),
            ("about the belly", "rate_belly_rad_s", GREEN, false),
        ],
    ),
    (
        "airspeed and wind [m/s]",
        &[
            ("airspeed", "airspeed_m_s", BLUE, false),
            ("wind north", "wind_north_m_s", ORANGE, false),
            ("wind east", "wind_east_m_s", GREEN, false),
            ("wind down", "wind_down_m_s", GREY, false),
        ],
    ),
    (
        "thrust [N]",
        &[
            ("thrust", "true_thrust_n", BLUE, false),
            ("command", "thrust_n", ORANGE, true),
        ],
    ),
    (
        "load factor",
        &[("load factor", "load_factor", BLUE, false)],
    ),
];

/// Height of a chart \[px\].
const CHART: u32 = 300;

/// The points of a column; angles in degrees, broken where they wrap.
fn points(name: &str, record: &[Step]) -> Vec<(f64, f64)> {
    let column = column(name).expect("a column");
    let mut last = f64::NAN;
    let point = |step: &Step| {
        let mut value = column.number(step);
        // Drawn upward.
        if name.ends_with("down_m") {
            value = -value;
        }
        if column.unit == "rad" {
            value = value.to_degrees();
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

/// Picture and charts in one.
fn svg(record: &[Step]) -> String {
    let chart = |(title, lines): &'static Panel| {
        let series = lines.iter().map(|&(name, column, color, dashed)| {
            let points = points(column, record);
            match dashed {
                true => Series::dashed(name, color, points),
                false => Series::line(name, color, points),
            }
        });
        Chart::over_time(title, series.collect())
    };
    let charts: Vec<Chart> = PANELS.iter().map(chart).collect();
    let below = sheet(&charts, CHART).expect("charts that are well formed");
    let below = below.replacen("<svg ", &format!("<svg y=\"{HIGH}\" "), 1);
    let high = HIGH + f64::from(CHART) * charts.len().div_ceil(2) as f64;
    let above = picture(record);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDE}\" height=\"{high}\" viewBox=\"0 0 {WIDE} {high}\">\n\
         {above}{below}</svg>\n"
    )
}

/// The page about a flight in space.
pub fn page(
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
    figures: &Figures,
) -> Page {
    let (duration, rate) = (experiment.duration_s, experiment.control_rate_hz);
    let entry = match experiment.entry_s {
        0.0 => String::new(),
        entry => format!("Root mean squares and peaks are from {entry} s on. "),
    };
    Page {
        title: document.name.clone(),
        lead: format!(
            "{} · {duration} s, control at {rate} Hz",
            experiment.description
        ),
        svg: svg(record),
        tables: vec![Table {
            title: "Figures".to_owned(),
            header: columns(["", "value", "bound"]),
            rows: figures
                .table(experiment)
                .iter()
                .map(|row| row.to_vec())
                .collect(),
        }],
        text: Some(("The experiment as flown (TOML)".to_owned(), document.text())),
        notes: format!(
            "{entry}{} control steps; the same are in trace.csv. The vehicle is drawn larger than it is.",
            record.len()
        ),
    }
}
