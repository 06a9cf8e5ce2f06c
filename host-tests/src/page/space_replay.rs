//! The page about a log replayed by the guidance in space.

use super::chart::{BLUE, Chart, Color, GREEN, Level, ORANGE, Series as Line};
use super::space::{points, strip};
use super::{Figure, Page, Table, columns};
use crate::columns::Cell;
use crate::experiment::Document;
use crate::space::Step;
use crate::space::columns::column;

/// Angles to a fold beyond this \[°\] are not drawn.
const FOLD: f64 = 45.0;

/// A chart: its title; name in the legend, column and colour of each line.
type Panel = (&'static str, &'static [(&'static str, &'static str, Color)]);

const PANELS: [Panel; 7] = [
    (
        "velocity flown [m/s]",
        &[
            ("north", "v_north_m_s", BLUE),
            ("east", "v_east_m_s", ORANGE),
            ("down", "v_down_m_s", GREEN),
        ],
    ),
    (
        "|v − v_r| [m/s]",
        &[("to what was asked for", "velocity_error_m_s", BLUE)],
    ),
    (
        "angle of attack and sideslip [°]",
        &[
            ("α", "alpha_rad", BLUE),
            ("sideslip", "sideslip_rad", ORANGE),
        ],
    ),
    (
        "body rates commanded [rad/s]",
        &[
            ("about the wing", "command_wing_rad_s", BLUE),
            ("about the tail", "command_tail_rad_s", ORANGE),
            ("about the belly", "command_belly_rad_s", GREEN),
        ],
    ),
    ("thrust commanded [N]", &[("T", "thrust_n", GREEN)]),
    ("margin k", &[("k", "margin_k", BLUE)]),
    (
        "angle to the nearest fold, first order, within 45° [°]",
        &[("fold", "margin_fold_rad", BLUE)],
    ),
];

fn figure(record: &[Step]) -> Figure {
    let near = |(t, x): (f64, f64)| (t, if x.abs() > FOLD { f64::NAN } else { x });
    let chart = |(title, lines): &(&'static str, &[_])| {
        let is_fold = title.contains("fold");
        let lines = lines.iter().map(|&(name, column, color)| {
            let mut points = points(column, record);
            if is_fold {
                points = points.into_iter().map(near).collect();
            }
            Line::line(name, color, points)
        });
        let fold = || Level {
            at: 0.0,
            label: "fold".to_owned(),
        };
        Chart {
            levels: is_fold.then(fold).into_iter().collect(),
            ..Chart::over_time(title, lines.collect())
        }
    };
    let charts: Vec<Chart> = PANELS.iter().map(chart).collect();
    Figure::new(&charts, 210.0).with_strip(&strip(record))
}

/// The page about the replay of the log `name` by the guidance of `document`. `said` is what had to be assumed.
pub fn page(name: &str, document: &Document, record: &[Step], said: &[String]) -> Page {
    let margins = [
        ("least margin k", "margin_k", "", 1.0),
        (
            "least |angle to the nearest fold|",
            "margin_fold_rad",
            " °",
            180.0 / std::f64::consts::PI,
        ),
    ];
    let rows = margins.iter().filter_map(|(label, of, unit, scale)| {
        let column = column(of)?;
        let values = record
            .iter()
            .map(|step| (column.number(step).abs(), step.t));
        let finite = values.filter(|(value, _)| value.is_finite());
        let (value, t) = finite.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(vec![
            (*label).to_owned(),
            format!("{:.3}{unit}", scale * value),
            format!("at {t:.3} s"),
        ])
    });
    let mut tables = vec![Table {
        title: "Margins".to_owned(),
        header: columns(["", "value", ""]),
        rows: rows.collect(),
    }];
    for (of, title) in [("status", "Status"), ("mode", "Mode"), ("phase", "Phase")] {
        let mut counts = std::collections::BTreeMap::new();
        let column = column(of).expect("a column");
        for step in record {
            if let Cell::Word(word) = (column.read)(step) {
                *counts.entry(word.into_owned()).or_insert(0_usize) += 1;
            }
        }
        let row = |(text, count): (String, usize)| {
            let share = 100.0 * count as f64 / record.len() as f64;
            vec![text, count.to_string(), format!("{share:.1}")]
        };
        tables.push(Table {
            title: title.to_owned(),
            header: columns(["", "rows", "%"]),
            rows: counts.into_iter().map(row).collect(),
        });
    }
    tables.push(Table {
        title: "What the log holds".to_owned(),
        header: columns([""]),
        rows: said.iter().map(|line| vec![line.clone()]).collect(),
    });
    Page {
        title: format!("{name}, replayed"),
        lead: format!(
            "{} rows of the log through the guidance in space of {}, open loop: the log's vehicle did not follow these commands",
            record.len(),
            document.name
        ),
        warnings: Vec::new(),
        figure: figure(record),
        tables,
        text: Some((
            "The experiment whose guidance it is (TOML)".to_owned(),
            document.text(),
        )),
        notes: "The commands are in commands.csv.".to_owned(),
    }
}
