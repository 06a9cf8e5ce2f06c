//! The page about a flight in space: the picture, charts of the record's columns, the figures, the experiment.

use super::chart::{Chart, Level};
use super::panel::{Panel, chart, panels, strip};
use super::picture::picture;
use super::{Figure, Page, Table};
use alula_sim::experiment::Document;
use alula_sim::space::{Experiment, Figures, Step};

const PANELS: &[Panel] = panels! {
    ["altitude [m]"]
    "down_m", "flown", BLUE;
    "path_down_m", "path", ORANGE dashed;
    ["errors of position [m] and velocity [m/s]"]
    "position_error_m", "position", BLUE;
    "velocity_error_m_s", "velocity", ORANGE;
    ["nose over the horizon and right wing below it [°]"]
    "pitch_rad", "nose", BLUE;
    "bank_rad", "bank", ORANGE;
    ["angle of attack and sideslip [°]"]
    "alpha_rad", "α", BLUE;
    "sideslip_rad", "sideslip", ORANGE;
    ["body rates [rad/s]"]
    "rate_wing_rad_s", "about the wing", BLUE;
    "rate_tail_rad_s", "about the tail", ORANGE;
    "rate_belly_rad_s", "about the belly", GREEN;
    ["airspeed and wind [m/s]"]
    "airspeed_m_s", "airspeed", BLUE;
    "wind_north_m_s", "wind north", ORANGE;
    "wind_east_m_s", "wind east", GREEN;
    "wind_down_m_s", "wind down", GREY;
    ["thrust [N]"]
    "true_thrust_n", "thrust", BLUE;
    "thrust_n", "command", ORANGE dashed;
    ["load factor"]
    "load_factor", "load factor", BLUE;
};

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
        Some(Level::new(*bound, format!("bound: {label}")))
    };
    let [least, most] = experiment.plant.thrust_n;
    let levels = match title {
        "thrust [N]" => [
            Some(Level::new(least, "least")),
            Some(Level::new(most, "greatest")),
        ],
        title if title.starts_with("errors") => [
            bound("max_position_error_m", "position"),
            bound("max_velocity_error_m_s", "velocity"),
        ],
        title if title.contains("sideslip") => [bound("max_sideslip_deg", "sideslip"), None],
        "body rates [rad/s]" => [bound("peak_rate_rad_s", "rate"), None],
        "load factor" => [bound("max_load_factor", "load"), None],
        _ => [None, None],
    };
    levels.into_iter().flatten().collect()
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
        figure: figure(experiment, record),
        tables: vec![Table::new(
            "Figures",
            ["", "value", "bound"],
            figures.table(experiment),
        )],
        text: Some(("The experiment as flown (TOML)".to_owned(), document.text())),
        notes: format!(
            "{entry}{} control steps; the same are in trace.csv. The vehicle is drawn larger than it is.",
            record.len()
        ),
        ..Page::default()
    }
}
