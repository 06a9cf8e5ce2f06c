//! Charts of columns of a record over time, and its words.

use super::chart::{Chart, Color, Series};
use super::{Row, Strip};
use alula_sim::columns::{Column, declared};
use alula_sim::experiment::Experiment;
use alula_sim::reference::wrap;
use alula_sim::simulate::Step;

/// Angles to a fold beyond this are not drawn \[°\].
const FOLD: f64 = 45.0;

/// A chart of columns.
#[derive(Clone, Copy)]
pub struct Panel {
    pub title: &'static str,
    pub lines: &'static [Line],
    pub logarithmic: bool,
}

/// A column in a chart.
#[derive(Clone, Copy)]
pub struct Line {
    /// In the legend.
    pub name: &'static str,
    pub column: &'static str,
    pub color: Color,
    pub dashed: bool,
}

/// Panels: above each its title, and whether it is `logarithmic`; then a row for each line: column, name in the legend, colour, and `dashed`
/// of bounds and of what was asked for.
macro_rules! panels {
    ($([$title:literal $($logarithmic:ident)?] $($column:literal, $name:literal, $color:ident $($dashed:ident)?;)+)+) => {
        &[$($crate::panel::Panel {
            title: $title,
            lines: &[$($crate::panel::Line {
                name: $name,
                column: $column,
                color: $crate::chart::$color,
                dashed: panels!(@is $($dashed)?),
            }),+],
            logarithmic: panels!(@is $($logarithmic)?),
        }),+]
    };
    (@is) => { false };
    (@is dashed) => { true };
    (@is logarithmic) => { true };
}
pub(super) use panels;

/// The chart of a panel, if any of its columns applies to the flight.
pub fn chart(panel: &Panel, experiment: &Experiment, record: &[Step]) -> Option<Chart<'static>> {
    let lines = panel.lines.iter().filter_map(|line| {
        let column = declared(line.column);
        column.applies(experiment, record).then(|| {
            let points = points(column, experiment, record);
            match line.dashed {
                true => Series::dashed(line.name, line.color, points),
                false => Series::line(line.name, line.color, points),
            }
        })
    });
    let series: Vec<Series> = lines.collect();
    (!series.is_empty()).then(|| Chart {
        logarithmic: panel.logarithmic,
        ..Chart::over_time(panel.title, series)
    })
}

/// The points of a column; heights upward, angles in degrees and broken where they wrap.
fn points(column: &Column, experiment: &Experiment, record: &[Step]) -> Vec<(f64, f64)> {
    let is_depth = column.name.ends_with("down_m");
    let is_angle = column.name.ends_with("_rad");
    let is_fold = column.name == "margin_fold_rad";
    let mut last = f64::NAN;
    let point = |step: &Step| {
        let mut value = column.number(experiment, step);
        if is_depth {
            value = -value;
        }
        if is_fold && value.to_degrees().abs() > FOLD {
            value = f64::NAN;
        }
        // A NaN stays one: it is not drawn.
        if is_angle && !value.is_nan() {
            value = wrap(value).to_degrees();
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

/// What the controller did and said.
pub fn strip(experiment: &Experiment, record: &[Step]) -> Strip {
    let row = |(name, words): (&'static str, &'static str)| {
        let column = declared(name);
        let word = |step: &Step| (step.t, column.word(experiment, step));
        Row::of(words, record.iter().map(word))
    };
    Strip {
        duration: record.last().map_or(0.0, |step| step.t),
        rows: [
            ("mission_activity", "mission"),
            ("mission_remark", "remark"),
            ("mission_response", "response"),
            ("mode", "mode"),
            ("phase", "phase"),
            ("status", "status"),
        ]
        .into_iter()
        .filter_map(row)
        .collect(),
    }
}
