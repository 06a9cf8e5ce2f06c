//! The page about a flight: charts of the record's columns, the figures, the experiment.

use super::chart::{BLUE, Band, Chart, GREEN, GREY, Level, Mark, ORANGE};
use super::panel::{Panel, chart, column, panel, strip};
use super::side::side;
use super::{Figure, Page, Table, columns};
use crate::envelope::Curve;
use crate::experiment::{Document, Experiment};
use crate::figures::{Figures, Segment};
use crate::simulate::Step;

/// A chart, and what is marked in it.
struct Marked {
    panel: Panel,
    /// The figure whose extreme is marked, on a column.
    mark: Option<(&'static str, &'static str)>,
    /// What is to be seen across it.
    across: Across,
}

/// What is to be seen across a chart.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Across {
    Nothing,
    /// The speeds between the folds of level flight, where it has more than one equilibrium.
    FoldSpeeds,
    /// The angles of attack between these folds: the equilibrium jumps over them.
    StallBand,
    /// The motors' limits.
    Thrust,
    /// The law's guard.
    Guard,
    /// Where a fold is.
    Fold,
    /// Right and straight angles.
    HalfTurn,
}

const fn plain(panel: Panel) -> Marked {
    Marked {
        panel,
        mark: None,
        across: Across::Nothing,
    }
}

const PANELS: &[Marked] = &[
    Marked {
        across: Across::FoldSpeeds,
        ..plain(panel(
            "forward velocity [m/s]",
            &[
                ("v", "true_v_forward_m_s", BLUE, false),
                ("v_r", "vr_forward_m_s", ORANGE, true),
                ("v_cmd", "v_cmd_forward_m_s", GREY, true),
            ],
        ))
    },
    plain(panel(
        "downward velocity [m/s]",
        &[
            ("v", "true_v_down_m_s", BLUE, false),
            ("v_r", "vr_down_m_s", ORANGE, true),
            ("v_cmd", "v_cmd_down_m_s", GREY, true),
        ],
    )),
    Marked {
        mark: Some(("max_velocity_error_m_s", "velocity_error_m_s")),
        ..plain(panel(
            "velocity error v − v_r [m/s]",
            &[
                ("down", "velocity_error_down_m_s", BLUE, false),
                ("forward", "velocity_error_forward_m_s", ORANGE, false),
                ("magnitude", "velocity_error_m_s", GREY, true),
            ],
        ))
    },
    plain(panel(
        "altitude over the reference [m]",
        &[("h", "altitude_m", BLUE, false)],
    )),
    plain(panel(
        "forward of the reference [m]",
        &[("x̃", "forward_m", BLUE, false)],
    )),
    Marked {
        across: Across::StallBand,
        ..plain(panel(
            "orientation θ and angle of attack α [°]",
            &[
                ("θ", "true_theta_rad", BLUE, false),
                ("α", "true_alpha_rad", ORANGE, false),
            ],
        ))
    },
    Marked {
        mark: Some(("max_rate_rad_s", "rate_rad_s")),
        ..plain(panel(
            "angular velocity ω [rad/s]",
            &[
                ("ω", "true_rate_rad_s", BLUE, false),
                ("command", "rate_rad_s", ORANGE, true),
            ],
        ))
    },
    Marked {
        across: Across::Thrust,
        ..plain(panel(
            "thrust to weight T/(m g)",
            &[("T/(m g)", "thrust_to_weight", GREEN, false)],
        ))
    },
    Marked {
        mark: Some(("min_fp_n", "fp_n")),
        across: Across::Guard,
        ..plain(Panel {
            logarithmic: true,
            ..panel(
                "apparent force |F_p| of the controller, and the guard's τ [N]",
                &[("|F_p|", "fp_n", BLUE, false)],
            )
        })
    },
    Marked {
        across: Across::HalfTurn,
        ..plain(panel(
            "θ̃, from the thrust axis to F_p [°]",
            &[("θ̃", "theta_tilde_rad", BLUE, false)],
        ))
    },
    Marked {
        across: Across::Fold,
        ..plain(panel(
            "angle to the nearest fold, first order, within 45° [°]",
            &[("fold", "margin_fold_rad", BLUE, false)],
        ))
    },
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

/// What is to be seen across a panel.
fn across(what: Across, experiment: &Experiment) -> (Vec<Level>, Vec<Band>) {
    let level = |at: f64, label: &str| Level {
        at,
        label: label.to_owned(),
    };
    let mut bands = Vec::new();
    let levels = match what {
        Across::Nothing => Vec::new(),
        Across::FoldSpeeds => {
            let speeds = level_folds(experiment).into_iter().map(|fold| fold.1);
            let wind = experiment.weather.steady_m_s[1];
            let (from, to) = speeds.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
                (l.min(v), h.max(v))
            });
            bands.push(Band {
                from: from + wind,
                to: to + wind,
                label: format!("level flight folds at {from:.1} and {to:.1} m/s of air"),
            });
            Vec::new()
        }
        Across::StallBand => {
            let folds = level_folds(experiment);
            let angles = || folds.iter().map(|fold| fold.0);
            bands.push(Band {
                from: angles().fold(f64::INFINITY, f64::min),
                to: angles().fold(f64::NEG_INFINITY, f64::max),
                label: "stall: α between these folds".to_owned(),
            });
            Vec::new()
        }
        Across::Thrust => {
            let [least, most] = experiment.plant.thrust_n.map(|n| n / experiment.weight());
            vec![level(most, "greatest"), level(least, "least")]
        }
        Across::Guard => {
            let tau = experiment.spec().ok().and_then(|spec| {
                let belief = spec.belief().unwrap_or(&experiment.vehicle);
                spec.gains(belief).map(|gains| gains.tau())
            });
            tau.map(|tau| level(tau, "τ")).into_iter().collect()
        }
        Across::Fold => vec![level(0.0, "fold")],
        Across::HalfTurn => vec![level(180.0, "π"), level(-180.0, "−π")],
    };
    (levels, bands)
}

/// The chart of a panel, if any of its columns applies to the flight.
fn marked(
    marked: &Marked,
    experiment: &Experiment,
    record: &[Step],
    figures: &Figures,
) -> Option<Chart<'static>> {
    let chart = chart(&marked.panel, experiment, record)?;
    let (levels, bands) = across(marked.across, experiment);
    let mark = marked.mark.and_then(|(figure, of)| {
        let at = figures.when(figure)?;
        let step = record.iter().find(|step| step.t == at)?;
        let y = column::<Experiment>(of).number(experiment, step);
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
        warnings: Vec::new(),
        figure: figure(experiment, record, figures),
        tables,
        text: Some(("The experiment as flown (TOML)".to_owned(), document.text())),
        notes: format!(
            "{} control steps. |F_p| and θ̃ are the controller's own, all else is the simulated vehicle's. The same steps are in \
             trace.csv.",
            record.len()
        ),
    }
}
