//! The page about a flight: charts of the record's columns, the figures, the experiment.

use super::chart::{Band, Chart, Level, Mark, ends};
use super::panel::{Panel, chart, panels, strip};
use super::side::side;
use super::{Figure, Page, Table};
use alula_design::envelope::Curve;
use alula_sim::columns::Flight;
use alula_sim::experiment::{Document, Experiment};
use alula_sim::figures::{Figures, Segment};
use alula_sim::simulate::Step;

const PANELS: &[Panel] = panels! {
    ["forward velocity [m/s]"]
    "true_v_forward_m_s", "v", BLUE;
    "vr_forward_m_s", "v_r", ORANGE dashed;
    "v_cmd_forward_m_s", "v_cmd", GREY dashed;
    ["downward velocity [m/s]"]
    "true_v_down_m_s", "v", BLUE;
    "vr_down_m_s", "v_r", ORANGE dashed;
    "v_cmd_down_m_s", "v_cmd", GREY dashed;
    ["velocity error v − v_r [m/s]"]
    "velocity_error_down_m_s", "down", BLUE;
    "velocity_error_forward_m_s", "forward", ORANGE;
    "velocity_error_m_s", "magnitude", GREY dashed;
    ["altitude over the reference [m]"]
    "altitude_m", "h", BLUE;
    ["forward of the reference [m]"]
    "forward_m", "x̃", BLUE;
    ["orientation θ and angle of attack α [°]"]
    "true_theta_rad", "θ", BLUE;
    "true_alpha_rad", "α", ORANGE;
    ["angular velocity ω [rad/s]"]
    "true_rate_rad_s", "ω", BLUE;
    "rate_rad_s", "command", ORANGE dashed;
    ["thrust to weight T/(m g)"]
    "thrust_to_weight", "T/(m g)", GREEN;
    ["apparent force |F_p| of the controller, and the guard's τ [N]" logarithmic]
    "fp_n", "|F_p|", BLUE;
    ["θ̃, from the thrust axis to F_p [°]"]
    "theta_tilde_rad", "θ̃", BLUE;
    ["angle to the nearest fold, first order, within 45° [°]"]
    "margin_fold_rad", "fold", BLUE;
};

/// Figures whose extremes are marked, on these columns.
const MARKS: [(&str, &str); 3] = [
    ("max_velocity_error_m_s", "velocity_error_m_s"),
    ("max_rate_rad_s", "rate_rad_s"),
    ("min_fp_n", "fp_n"),
];

/// Height of a plot \[px\].
const HIGH: f64 = 210.0;

/// The figure of a flight: seen from the side, its charts, what the controller did.
pub fn figure(experiment: &Experiment, record: &[Step], figures: &Figures) -> Figure {
    let chart = |panel| marked(panel, experiment, record, figures);
    let charts: Vec<Chart> = PANELS.iter().filter_map(chart).collect();
    Figure::new(&charts, HIGH)
        .with_picture(side(experiment, record))
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

/// What is to be seen across the panel that begins with this column.
fn across(column: &str, experiment: &Experiment) -> (Vec<Level>, Vec<Band>) {
    let levels = match column {
        // The speeds between the folds of level flight, where it has more than one equilibrium.
        "true_v_forward_m_s" => {
            let speeds = level_folds(experiment).into_iter().map(|fold| fold.1);
            let wind = experiment.weather.steady_m_s[1];
            let (from, to) = ends(speeds);
            let band = Band {
                from: from + wind,
                to: to + wind,
                label: format!("level flight folds at {from:.1} and {to:.1} m/s of air"),
            };
            return (Vec::new(), vec![band]);
        }
        // The equilibrium jumps over these angles of attack.
        "true_theta_rad" => {
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
        let y = Experiment::declared(of).number(experiment, step);
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

/// The page about a flight.
pub fn page(
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
    figures: &Figures,
    segments: &[Segment],
) -> Page {
    let figures_of_merit = Table::new("Figures of merit", ["", "value", ""], figures.table());
    let mut tables = vec![figures_of_merit];
    if segments.len() > 1 {
        let lines = segments.iter().map(|s| [s.line()]);
        tables.push(Table::new("Segments of the reference [s]", [""], lines));
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
        figure: figure(experiment, record, figures),
        tables,
        text: Some(("The experiment as flown (TOML)".to_owned(), document.text())),
        notes: format!(
            "{} control steps. |F_p| and θ̃ are the controller's own, all else is the simulated vehicle's. The same steps are in \
             trace.csv.",
            record.len()
        ),
        ..Page::default()
    }
}
