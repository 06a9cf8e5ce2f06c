//! The page about a flight in space: the picture, charts of the record's columns, the figures, the experiment.

use super::chart::{BLUE, Chart, Color, GREEN, GREY, Level, ORANGE, Series};
use super::picture::picture;
use super::{Figure, Page, Row, Strip, Table, columns};
use crate::columns::Cell;
use crate::experiment::Document;
use crate::space::columns::column;
use crate::space::{Experiment, Figures, Step};

/// A chart of columns: its title; name in the legend, column, colour and whether dashed of each line.
type Panel = (
    &'static str,
    &'static [(&'static str, &'static str, Color, bool)],
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

/// The points of a column; angles in degrees, broken where they wrap.
pub(super) fn points(name: &str, record: &[Step]) -> Vec<(f64, f64)> {
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

/// Picture, charts, and what the guidance did.
fn figure(experiment: &Experiment, record: &[Step]) -> Figure {
    let chart = |(title, lines): &'static Panel| {
        let series = lines.iter().map(|&(name, column, color, dashed)| {
            let points = points(column, record);
            match dashed {
                true => Series::dashed(name, color, points),
                false => Series::line(name, color, points),
            }
        });
        Chart {
            levels: levels(title, experiment),
            ..Chart::over_time(title, series.collect())
        }
    };
    let charts: Vec<Chart> = PANELS.iter().map(chart).collect();
    Figure::new(&charts, 200.0)
        .with_picture(picture(record))
        .with_strip(&strip(record))
}

/// Limits and bounds that belong to a chart.
fn levels(title: &str, experiment: &Experiment) -> Vec<Level> {
    let bound = |figure: &str, label: &str| {
        let bound = experiment.bounds.get(figure)?;
        Some(Level {
            at: *bound,
            label: format!("bound: {label}"),
        })
    };
    let motors = || {
        let ends = experiment
            .plant
            .thrust_n
            .into_iter()
            .zip(["least", "greatest"]);
        ends.map(|(at, label)| Level {
            at,
            label: label.to_owned(),
        })
    };
    match title {
        "thrust [N]" => motors().collect(),
        title if title.starts_with("errors") => [
            bound("max_position_error_m", "position"),
            bound("max_velocity_error_m_s", "velocity"),
        ]
        .into_iter()
        .flatten()
        .collect(),
        title if title.contains("sideslip") => {
            bound("max_sideslip_deg", "sideslip").into_iter().collect()
        }
        "body rates [rad/s]" => bound("peak_rate_rad_s", "rate").into_iter().collect(),
        "load factor" => bound("max_load_factor", "load").into_iter().collect(),
        _ => Vec::new(),
    }
}

/// What the guidance did and said.
pub(super) fn strip(record: &[Step]) -> Strip {
    let row = |name: &'static str| {
        let column = column(name).expect("a column");
        let word = |step: &Step| match (column.read)(step) {
            Cell::Word(word) => (step.t, Some(word.into_owned())),
            _ => (step.t, None),
        };
        Row::of(name, record.iter().map(word))
    };
    Strip {
        duration: record.last().map_or(0.0, |step| step.t),
        rows: ["mode", "phase", "status"]
            .into_iter()
            .filter_map(row)
            .collect(),
    }
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
        warnings: Vec::new(),
        figure: figure(experiment, record),
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
