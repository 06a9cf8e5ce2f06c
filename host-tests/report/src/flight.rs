//! The page about a flight: charts of the record's columns, the figures, the experiment.

use super::chart::{Band, Chart, Level, Mark, ends};
use super::film::with_films;
use super::page::fixed;
use super::panel::{Panel, chart, panels, strip};
use super::picture::picture;
use super::side::side;
use super::svg::{Drawn, Format};
use super::{Figure, Page, Table, viewer};
use alula_design::envelope::Curve;
use alula_sim::columns::declared;
use alula_sim::experiment::{Document, Experiment};
use alula_sim::figures::{Figures, Segment};
use alula_sim::simulate::{Step, shown};

/// Charts of a flight in a vertical plane.
const IN_PLANE: &[Panel] = panels! {
    ["forward velocity [m/s]"]
    "v_north_m_s", "v", BLUE;
    "path_v_north_m_s", "v_r", ORANGE dashed;
    "v_cmd_north_m_s", "v_cmd", GREY dashed;
    ["downward velocity [m/s]"]
    "v_down_m_s", "v", BLUE;
    "path_v_down_m_s", "v_r", ORANGE dashed;
    "v_cmd_down_m_s", "v_cmd", GREY dashed;
    ["velocity error v − v_r [m/s]"]
    "velocity_error_down_m_s", "down", BLUE;
    "velocity_error_north_m_s", "forward", ORANGE;
    "velocity_error_m_s", "magnitude", GREY dashed;
    ["altitude over the reference [m]"]
    "altitude_m", "h", BLUE;
    ["forward of the reference [m]"]
    "forward_m", "x̃", BLUE;
    ["orientation θ and angle of attack α [°]"]
    "theta_rad", "θ", BLUE;
    "wing_alpha_rad", "α", ORANGE;
    ["angular velocity ω [rad/s]"]
    "pitch_rate_rad_s", "ω", BLUE;
    "command_pitch_rad_s", "command", ORANGE dashed;
    ["thrust to weight T/(m g)"]
    "thrust_to_weight", "T/(m g)", GREEN;
    ["apparent force |F_p| of the controller, and the guard's τ [N]" logarithmic]
    "fp_n", "|F_p|", BLUE;
    ["θ̃, from the thrust axis to F_p [°]"]
    "theta_tilde_rad", "θ̃", BLUE;
    ["angle to the nearest fold, first order, within 45° [°]"]
    "margin_fold_rad", "fold", BLUE;
};

/// Charts of any other flight.
const IN_SPACE: &[Panel] = panels! {
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
    "pitch_rate_rad_s", "pitch", BLUE;
    "roll_rate_rad_s", "roll", ORANGE;
    "yaw_rate_rad_s", "yaw", GREEN;
    ["airspeed and wind [m/s]"]
    "airspeed_m_s", "airspeed", BLUE;
    "mission_airspeed_m_s", "asked for", GREEN dashed;
    "wind_north_m_s", "wind north", ORANGE;
    "wind_east_m_s", "wind east", GREEN;
    "wind_down_m_s", "wind down", GREY;
    ["thrust [N]"]
    "true_thrust_n", "thrust", BLUE;
    "thrust_n", "command", ORANGE dashed;
    "mission_steady_thrust_n", "of steady flight", GREEN dashed;
    ["load factor"]
    "load_factor", "load factor", BLUE;
    ["to the right of the mission's path [m]"]
    "mission_right_m", "right", BLUE;
    ["way to the end of the item [m], and its number"]
    "mission_distance_m", "way", BLUE;
    "mission_item", "item", ORANGE;
    ["energy [J]"]
    "mission_energy_j", "energy", BLUE;
};

/// Figures whose extremes are marked, on these columns.
const MARKS: [(&str, &str); 3] = [
    ("max_velocity_error_m_s", "velocity_error_m_s"),
    ("max_rate_command_rad_s", "command_pitch_rad_s"),
    ("min_fp_n", "fp_n"),
];

/// Height of a plot \[px\].
const HIGH: f64 = 210.0;

/// The picture of a flight as a whole.
pub fn overview(experiment: &Experiment, record: &[Step], format: Format) -> Drawn {
    match experiment.in_plane() {
        true => side(experiment, record, format),
        false => picture(record, format),
    }
}

/// The picture of a flight, with its transitions, for a sheet and for a narrow window.
pub fn drawn(experiment: &Experiment, record: &[Step]) -> [Drawn; 2] {
    let record = shown(record);
    [Format::Sheet, Format::Narrow].map(|format| {
        with_films(
            overview(experiment, record, format),
            experiment,
            record,
            format,
        )
    })
}

/// The figure of a flight: its picture, its charts, what the controller did.
pub fn figure(experiment: &Experiment, record: &[Step], figures: &Figures) -> Figure {
    let record = shown(record);
    let panels = match experiment.in_plane() {
        true => IN_PLANE,
        false => IN_SPACE,
    };
    let chart = |panel| marked(panel, experiment, record, figures);
    let charts: Vec<Chart> = panels.iter().filter_map(chart).collect();
    Figure::new(&charts, HIGH)
        .with_picture(drawn(experiment, record))
        .with_strip(&strip(experiment, record))
}

/// Folds of level flight of the true vehicle: α \[°\] and airspeed \[m/s\].
fn level_folds(experiment: &Experiment) -> Vec<(f64, f64)> {
    let vehicle = experiment.vehicle.reference();
    let Some(curve) = Curve::new(&vehicle, 0.0) else {
        return Vec::new();
    };
    let weight = vehicle.mass * vehicle.gravity;
    let folds = curve.folds().into_iter();
    folds
        .map(|fold| {
            (
                fold.alpha.to_degrees(),
                (fold.a * weight / vehicle.k_a).sqrt(),
            )
        })
        .collect()
}

/// What is to be seen across the panel that begins with this column: limits, bounds, folds.
fn across(column: &str, experiment: &Experiment) -> (Vec<Level>, Vec<Band>) {
    let bounds = |bounds: &[(&str, &str)]| {
        let level = |(figure, label): &(&str, &str)| {
            let bound = experiment.bounds.get(*figure)?;
            Some(Level::new(*bound, format!("bound: {label}")))
        };
        bounds.iter().filter_map(level).collect()
    };
    let levels = match column {
        "true_thrust_n" => {
            let [least, most] = experiment.plant.thrust_n;
            vec![Level::new(least, "least"), Level::new(most, "greatest")]
        }
        "position_error_m" => bounds(&[
            ("max_position_error_m", "position"),
            ("max_velocity_error_m_s", "velocity"),
        ]),
        "alpha_rad" => bounds(&[("max_sideslip_deg", "sideslip")]),
        "pitch_rate_rad_s" => bounds(&[("max_true_rate_rad_s", "rate")]),
        "load_factor" => bounds(&[("max_load_factor", "load")]),
        // The speeds between the folds of level flight, where it has more than one equilibrium.
        "v_north_m_s" => {
            let speeds = level_folds(experiment).into_iter().map(|fold| fold.1);
            let wind = experiment.weather.steady.x;
            let (from, to) = ends(speeds);
            let band = Band {
                from: from + wind,
                to: to + wind,
                label: format!("level flight folds at {from:.1} and {to:.1} m/s of air"),
            };
            return (Vec::new(), vec![band]);
        }
        // The equilibrium jumps over these angles of attack.
        "theta_rad" => {
            let (from, to) = ends(level_folds(experiment).into_iter().map(|fold| fold.0));
            let label = "stall: α between these folds".to_owned();
            return (Vec::new(), vec![Band { from, to, label }]);
        }
        "thrust_to_weight" => {
            let [least, most] = experiment.plant.thrust_n.map(|n| n / experiment.weight());
            vec![Level::new(most, "greatest"), Level::new(least, "least")]
        }
        "fp_n" => {
            let tau = experiment.spec().ok().and_then(|spec| {
                let belief = spec.belief().unwrap_or(&experiment.vehicle);
                spec.gains(belief).map(|gains| gains.tau())
            });
            tau.map(|tau| Level::new(tau, "τ")).into_iter().collect()
        }
        "margin_fold_rad" => vec![Level::new(0.0, "fold")],
        "theta_tilde_rad" => vec![Level::new(180.0, "π"), Level::new(-180.0, "−π")],
        _ => Vec::new(),
    };
    (levels, Vec::new())
}

/// The chart of a panel, if any of its columns applies to the flight.
fn marked(
    panel: &Panel,
    experiment: &Experiment,
    record: &[Step],
    figures: &Figures,
) -> Option<Chart<'static>> {
    let chart = chart(panel, experiment, record)?;
    let (levels, bands) = across(panel.lines[0].column, experiment);
    let shown = |(_, of): &&(&str, &str)| panel.lines.iter().any(|line| line.column == *of);
    let mark = MARKS.iter().find(shown).and_then(|(figure, of)| {
        let at = figures.when(figure)?;
        let step = record.iter().find(|step| step.t == at)?;
        let y = declared(of).number(experiment, step);
        let unit = chart.title.rsplit('[').next()?.trim_end_matches(']');
        Some(Mark {
            at: (at, y),
            label: format!("{y:.3} {unit} at {at:.3} s"),
            shift: 0,
        })
    });
    Some(Chart {
        marks: mark.into_iter().collect(),
        levels,
        bands,
        ..chart
    })
}

/// The items of a mission: when each begins, how long it lasts, how far it is, and what it takes.
fn items(experiment: &Experiment, record: &[Step]) -> Option<Table> {
    let of = experiment.mission.as_ref()?;
    let number = |step: &Step| step.mission.as_ref().map(|said| said.progress.item);
    let parts = record.chunk_by(|a, b| number(a) == number(b));
    let parts: Vec<&[Step]> = parts.collect();
    // A part lasts until the next one begins.
    let ends = parts
        .iter()
        .skip(1)
        .map(|part| &part[0])
        .chain(record.last());
    let rows = parts.iter().zip(ends).filter_map(|(part, end)| {
        let first = &part[0];
        let item = of.items.get(usize::from(number(first)?))?;
        let energy = |step: &Step| step.mission.map_or(0.0, |said| said.progress.energy);
        let way: f64 = part
            .windows(2)
            .map(|pair| (pair[1].truth.position - pair[0].truth.position).norm())
            .sum();
        let mut remarks: Vec<&str> = Vec::new();
        for remark in part.iter().filter_map(|step| step.mission?.remark) {
            if !remarks.contains(&remark.name()) {
                remarks.push(remark.name());
            }
        }
        Some([
            format!("{}: {}", number(first)?, item.name()),
            fixed(first.t, 1),
            fixed(end.t - first.t, 1),
            fixed(way, 0),
            fixed((energy(end) - energy(first)) / 1e3, 1),
            remarks.join(", "),
        ])
    });
    let header = [
        "item",
        "from [s]",
        "lasts [s]",
        "way [m]",
        "energy [kJ]",
        "remarks",
    ];
    Some(Table::new(
        "Items of the mission",
        header,
        rows.collect::<Vec<_>>(),
    ))
}

/// The page about a flight.
pub fn page(
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
    figures: &Figures,
    segments: &[Segment],
) -> Page {
    let figures_of_merit = Table::new(
        "Figures of merit",
        ["", "value", "bound or time"],
        figures.table(experiment),
    );
    let mut tables = vec![figures_of_merit];
    if segments.len() > 1 {
        let lines = segments.iter().map(|s| [s.line()]);
        tables.push(Table::new("Segments of the reference [s]", [""], lines));
    }
    tables.extend(items(experiment, record));
    let settled = match experiment.settle_time_s {
        0.0 => String::new(),
        from => format!("Root mean squares and peaks are from {from} s on. "),
    };
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
        links: vec![(
            viewer::FILE.to_owned(),
            "the flight in three dimensions".to_owned(),
        )],
        figure: figure(experiment, record, figures),
        tables,
        text: Some(("The experiment as flown (TOML)".to_owned(), document.text())),
        notes: format!(
            "{settled}{} control steps. |F_p| and θ̃ are the controller's own, all else is the simulated vehicle's. The same steps are in \
             trace.csv.",
            record.len()
        ),
        ..Page::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::simulate::fly;

    /// Each item that is flown has a row; they follow each other without a gap, and take all of the energy.
    #[test]
    fn the_items_of_a_mission_have_their_times() {
        let mut document = Document::load("inspection").unwrap();
        document.assign("duration_s=60.0").unwrap();
        let experiment = document.checked().unwrap();
        let record = fly(&experiment).unwrap();
        let table = items(&experiment, &record).unwrap();
        let number = |row: &Vec<String>, n: usize| row[n].parse::<f64>().unwrap();
        assert!(table.rows.len() > 2 && table.rows[0][0] == "0: take-off");
        let mut begins = 0.0;
        for row in &table.rows {
            assert!((number(row, 1) - begins).abs() < 0.11, "{row:?}");
            begins = number(row, 1) + number(row, 2);
        }
        assert!((begins - 60.0).abs() < 0.11, "{begins}");
        let spent: f64 = table.rows.iter().map(|row| number(row, 4)).sum();
        let all = f64::from(record.last().unwrap().mission.unwrap().progress.energy) / 1e3;
        assert!(
            (spent - all).abs() < 0.05 * table.rows.len() as f64,
            "{spent} {all}"
        );
        // A flight without a mission has none.
        let path = Document::load("circle-40").unwrap().checked().unwrap();
        assert!(items(&path, &record).is_none());
    }
}
