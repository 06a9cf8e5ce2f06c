//! The page about a replay: what a controller would have commanded along a logged flight, and its margins.

use std::collections::BTreeMap;

use super::chart::{BLUE, Chart, GREEN, Level, ORANGE};
use super::panel::{Panel, chart, panel, strip};
use super::{Figure, Page, Table, columns};
use crate::columns::Flight;
use crate::experiment::{Document, Experiment};
use crate::{simulate, space};

const PANELS: [Panel; 8] = [
    panel(
        "forward velocity [m/s]",
        &[
            ("flown", "v_forward_m_s", BLUE, false),
            ("asked for", "vr_forward_m_s", ORANGE, false),
        ],
    ),
    panel(
        "downward velocity [m/s]",
        &[
            ("flown", "v_down_m_s", BLUE, false),
            ("asked for", "vr_down_m_s", ORANGE, false),
        ],
    ),
    panel(
        "orientation θ and angle of attack α [°]",
        &[
            ("θ", "theta_rad", BLUE, false),
            ("α", "alpha_rad", ORANGE, false),
        ],
    ),
    panel(
        "angular velocity commanded [rad/s]",
        &[("ω", "rate_rad_s", BLUE, false)],
    ),
    panel("thrust commanded [N]", &[("T", "thrust_n", GREEN, false)]),
    Panel {
        logarithmic: true,
        ..panel(
            "apparent force |F_p| of the controller [N]",
            &[("|F_p|", "fp_n", BLUE, false)],
        )
    },
    panel("margin k", &[("k", "margin_k", BLUE, false)]),
    panel(
        "angle to the nearest fold, first order, within 45° [°]",
        &[("fold", "margin_fold_rad", BLUE, false)],
    ),
];

const PANELS_IN_SPACE: [Panel; 7] = [
    panel(
        "velocity flown [m/s]",
        &[
            ("north", "v_north_m_s", BLUE, false),
            ("east", "v_east_m_s", ORANGE, false),
            ("down", "v_down_m_s", GREEN, false),
        ],
    ),
    panel(
        "|v − v_r| [m/s]",
        &[("to what was asked for", "velocity_error_m_s", BLUE, false)],
    ),
    super::space::SIDESLIP,
    panel(
        "body rates commanded [rad/s]",
        &[
            ("about the wing", "command_wing_rad_s", BLUE, false),
            ("about the tail", "command_tail_rad_s", ORANGE, false),
            ("about the belly", "command_belly_rad_s", GREEN, false),
        ],
    ),
    panel("thrust commanded [N]", &[("T", "thrust_n", GREEN, false)]),
    panel("margin k", &[("k", "margin_k", BLUE, false)]),
    panel(
        "angle to the nearest fold, first order, within 45° [°]",
        &[("fold", "margin_fold_rad", BLUE, false)],
    ),
];

fn figure<F: Flight>(panels: &[Panel], experiment: &F, record: &[F::Step]) -> Figure {
    let chart = |panel: &Panel| {
        let fold = || Level {
            at: 0.0,
            label: "fold".to_owned(),
        };
        let levels = panel.title.contains("fold").then(fold);
        chart(panel, experiment, record).map(|chart| Chart {
            levels: levels.into_iter().collect(),
            ..chart
        })
    };
    let charts: Vec<Chart> = panels.iter().filter_map(chart).collect();
    Figure::new(&charts, 210.0).with_strip(&strip(experiment, record))
}

/// The least finite value of a column and its time \[s\].
fn least<F: Flight>(of: &str, experiment: &F, record: &[F::Step]) -> Option<(f64, f64)> {
    let column = F::column(of)?;
    let value = |step| (column.number(experiment, step).abs(), F::time(step));
    let finite = record
        .iter()
        .map(value)
        .filter(|(value, _)| value.is_finite());
    finite.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// How many steps had each word of a column.
fn counted<F: Flight>(of: &str, experiment: &F, record: &[F::Step]) -> Vec<Vec<String>> {
    let Some(column) = F::column(of) else {
        return Vec::new();
    };
    let mut counts = BTreeMap::new();
    for word in record
        .iter()
        .filter_map(|step| column.word(experiment, step))
    {
        *counts.entry(word).or_insert(0) += 1;
    }
    let row = |(text, count): (String, usize)| {
        let share = 100.0 * count as f64 / record.len() as f64;
        vec![text, count.to_string(), format!("{share:.1}")]
    };
    counts.into_iter().map(row).collect()
}

/// Least margins, counted words, and what had to be assumed.
fn tables<F: Flight>(experiment: &F, record: &[F::Step], said: &[String]) -> Vec<Table> {
    let mut rows = Vec::new();
    let margins = [
        ("least margin k", "margin_k", "", 1.0),
        (
            "least |angle to the nearest fold|",
            "margin_fold_rad",
            "°",
            180.0 / std::f64::consts::PI,
        ),
        ("least |F_p|", "fp_n", "N", 1.0),
    ];
    for (label, of, unit, scale) in margins {
        if let Some((value, t)) = least(of, experiment, record) {
            let value = format!("{:.3} {unit}", scale * value);
            let t = format!("at {t:.3} s");
            rows.push(vec![label.to_owned(), value.trim_end().to_owned(), t]);
        }
    }
    let mut tables = vec![Table {
        title: "Margins".to_owned(),
        header: columns(["", "value", ""]),
        rows,
    }];
    for (of, title) in [
        ("status", "Status"),
        ("mode", "Mode"),
        ("phase", "Phase"),
        ("air", "What of the air was used"),
    ] {
        let rows = counted(of, experiment, record);
        if !rows.is_empty() {
            tables.push(Table {
                title: title.to_owned(),
                header: columns(["", "rows", "%"]),
                rows,
            });
        }
    }
    if !said.is_empty() {
        tables.push(Table {
            title: "What the log holds".to_owned(),
            header: columns([""]),
            rows: said.iter().map(|line| vec![line.clone()]).collect(),
        });
    }
    tables
}

fn page_of(
    name: &str,
    document: &Document,
    (rows, controller): (usize, &str),
    figure: Figure,
    tables: Vec<Table>,
) -> Page {
    Page {
        title: format!("{name}, replayed"),
        lead: format!(
            "{rows} rows of the log through the {controller} of {}, open loop: the log's vehicle did not follow these commands",
            document.name
        ),
        warnings: Vec::new(),
        figure,
        tables,
        text: Some((
            "The experiment whose controller it is (TOML)".to_owned(),
            document.text(),
        )),
        notes: "The commands are in commands.csv.".to_owned(),
    }
}

/// The page about the replay of the log `name` by the controller of `document`. `said` is what had to be assumed.
pub fn page(
    name: &str,
    document: &Document,
    experiment: &Experiment,
    record: &[simulate::Step],
    said: &[String],
) -> Page {
    let controller = format!("controller `{}`", experiment.controller.name());
    let figure = figure(&PANELS, experiment, record);
    let tables = tables(experiment, record, said);
    page_of(name, document, (record.len(), &controller), figure, tables)
}

/// The same by the guidance in space.
pub fn page_in_space(
    name: &str,
    document: &Document,
    experiment: &space::Experiment,
    record: &[space::Step],
    said: &[String],
) -> Page {
    let figure = figure(&PANELS_IN_SPACE, experiment, record);
    let tables = tables(experiment, record, said);
    let controller = (record.len(), "guidance in space");
    page_of(name, document, controller, figure, tables)
}
