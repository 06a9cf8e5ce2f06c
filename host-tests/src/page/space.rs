//! The page about a flight in space: the picture, charts of the record's columns, the figures, the experiment.

use super::chart::{BLUE, Chart, GREEN, GREY, Level, ORANGE};
use super::panel::{Panel, chart, panel, strip};
use super::picture::picture;
use super::{Figure, Page, Table, columns};
use crate::experiment::Document;
use crate::space::{Experiment, Figures, Step};

pub(super) const SIDESLIP: Panel = panel(
    "angle of attack and sideslip [°]",
    &[
        ("α", "alpha_rad", BLUE, false),
        ("sideslip", "sideslip_rad", ORANGE, false),
    ],
);

const PANELS: &[Panel] = &[
    panel(
        "altitude [m]",
        &[
            ("flown", "down_m", BLUE, false),
            ("path", "path_down_m", ORANGE, true),
        ],
    ),
    panel(
        "errors of position [m] and velocity [m/s]",
        &[
            ("position", "position_error_m", BLUE, false),
            ("velocity", "velocity_error_m_s", ORANGE, false),
        ],
    ),
    panel(
        "nose over the horizon and right wing below it [°]",
        &[
            ("nose", "pitch_rad", BLUE, false),
            ("bank", "bank_rad", ORANGE, false),
        ],
    ),
    SIDESLIP,
    panel(
        "body rates [rad/s]",
        &[
            ("about the wing", "rate_wing_rad_s", BLUE, false),
            ("about the tail", "rate_tail_rad_s", ORANGE, false),
            ("about the belly", "rate_belly_rad_s", GREEN, false),
        ],
    ),
    panel(
        "airspeed and wind [m/s]",
        &[
            ("airspeed", "airspeed_m_s", BLUE, false),
            ("wind north", "wind_north_m_s", ORANGE, false),
            ("wind east", "wind_east_m_s", GREEN, false),
            ("wind down", "wind_down_m_s", GREY, false),
        ],
    ),
    panel(
        "thrust [N]",
        &[
            ("thrust", "true_thrust_n", BLUE, false),
            ("command", "thrust_n", ORANGE, true),
        ],
    ),
    panel(
        "load factor",
        &[("load factor", "load_factor", BLUE, false)],
    ),
];

/// Picture, charts, and what the guidance did.
fn figure(experiment: &Experiment, record: &[Step]) -> Figure {
    let chart = |panel: &Panel| {
        let levels = levels(panel.title, experiment);
        chart(panel, experiment, record).map(|chart| Chart { levels, ..chart })
    };
    let charts: Vec<Chart> = PANELS.iter().filter_map(chart).collect();
    Figure::new(&charts, 200.0)
        .with_picture(picture(record))
        .with_strip(&strip(experiment, record))
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
