//! The page about a replay: what a controller would have commanded along a logged flight, and its margins.

use std::collections::BTreeMap;

use super::chart::{BLUE, Chart, Color, GREEN, Level, ORANGE, Series};
use super::flight::{points, strip};
use super::{Figure, Page, Table, columns};
use crate::columns::column;
use crate::experiment::{Document, Experiment};
use crate::simulate::Step;

/// Title, whether the axis is logarithmic, and the curves: name, column, colour.
type Panel = (
    &'static str,
    bool,
    &'static [(&'static str, &'static str, Color)],
);

const PANELS: [Panel; 8] = [
    (
        "forward velocity [m/s]",
        false,
        &[
            ("flown", "v_forward_m_s", BLUE),
            ("asked for", "vr_forward_m_s", ORANGE),
        ],
    ),
    (
        "downward velocity [m/s]",
        false,
        &[
            ("flown", "v_down_m_s", BLUE),
            ("asked for", "vr_down_m_s", ORANGE),
        ],
    ),
    (
        "orientation θ and angle of attack α [°]",
        false,
        &[("θ", "theta_rad", BLUE), ("α", "alpha_rad", ORANGE)],
    ),
    (
        "angular velocity commanded [rad/s]",
        false,
        &[("ω", "rate_rad_s", BLUE)],
    ),
    ("thrust commanded [N]", false, &[("T", "thrust_n", GREEN)]),
    (
        "apparent force |F_p| of the controller [N]",
        true,
        &[("|F_p|", "fp_n", BLUE)],
    ),
    ("margin k", false, &[("k", "margin_k", BLUE)]),
    (
        "angle to the nearest fold, first order, within 45° [°]",
        false,
        &[("fold", "margin_fold_rad", BLUE)],
    ),
];

fn figure(experiment: &Experiment, record: &[Step]) -> Figure {
    let charts = PANELS.iter().filter_map(|(title, logarithmic, lines)| {
        let lines = lines.iter().filter_map(|(name, of, color)| {
            let column = column(of).expect("a column");
            let applies = column.applies(experiment, record);
            applies.then(|| Series::line(name, *color, points(column, experiment, record)))
        });
        let series: Vec<Series> = lines.collect();
        (!series.is_empty()).then(|| Chart {
            logarithmic: *logarithmic,
            levels: title.contains("fold").then(fold).into_iter().collect(),
            ..Chart::over_time(title, series)
        })
    });
    let charts: Vec<Chart> = charts.collect();
    Figure::new(&charts, 210.0).with_strip(&strip(experiment, record))
}

/// Where a fold is.
fn fold() -> Level {
    Level {
        at: 0.0,
        label: "fold".to_owned(),
    }
}

/// The least finite value of a column and its time \[s\].
fn least(of: &str, experiment: &Experiment, record: &[Step]) -> Option<(f64, f64)> {
    let column = column(of)?;
    let value = |step: &Step| (column.number(experiment, step).abs(), step.t);
    let finite = record
        .iter()
        .map(value)
        .filter(|(value, _)| value.is_finite());
    finite.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// How many steps had each text of a column.
fn counted(of: &str, experiment: &Experiment, record: &[Step]) -> Vec<Vec<String>> {
    let Some(column) = column(of) else {
        return Vec::new();
    };
    let mut counts = BTreeMap::new();
    for cell in record
        .iter()
        .filter_map(|step| (column.read)(experiment, step))
    {
        let mut text = Vec::new();
        cell.push(&mut text);
        *counts
            .entry(String::from_utf8_lossy(&text).into_owned())
            .or_insert(0) += 1;
    }
    let row = |(text, count): (String, usize)| {
        let share = 100.0 * count as f64 / record.len() as f64;
        vec![text, count.to_string(), format!("{share:.1}")]
    };
    counts.into_iter().map(row).collect()
}

/// The page about the replay of the log `name` by the controller of `document`. `said` is what had to be assumed.
pub fn page(
    name: &str,
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
    said: &[String],
) -> Page {
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
            let (value, t) = (
                format!("{:.3} {unit}", scale * value),
                format!("at {t:.3} s"),
            );
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
    Page {
        title: format!("{name}, replayed"),
        lead: format!(
            "{} rows of the log through the controller `{}` of {}, open loop: the log's vehicle did not follow these commands",
            record.len(),
            experiment.controller.name(),
            document.name
        ),
        warnings: Vec::new(),
        figure: figure(experiment, record),
        tables,
        text: Some((
            "The experiment whose controller it is (TOML)".to_owned(),
            document.text(),
        )),
        notes: "The commands are in commands.csv.".to_owned(),
    }
}
