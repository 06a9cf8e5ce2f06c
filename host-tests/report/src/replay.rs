//! The page about a replay: what a controller would have commanded along a logged flight, and its margins.

use std::collections::BTreeMap;

use super::chart::{Chart, Level};
use super::panel::{Panel, chart, panels, strip};
use super::{Figure, Page, Table};
use alula_sim::columns::column;
use alula_sim::experiment::{Document, Experiment};
use alula_sim::simulate::Step;

const PANELS: &[Panel] = panels! {
    ["velocity flown [m/s]"]
    "v_north_m_s", "north", BLUE;
    "v_east_m_s", "east", ORANGE;
    "v_down_m_s", "down", GREEN;
    ["|v − v_r| [m/s]"]
    "velocity_error_m_s", "to what was asked for", BLUE;
    ["angle of attack and sideslip [°]"]
    "alpha_rad", "α", BLUE;
    "sideslip_rad", "sideslip", ORANGE;
    ["body rates commanded [rad/s]"]
    "command_pitch_rad_s", "pitch", BLUE;
    "command_roll_rad_s", "roll", ORANGE;
    "command_yaw_rad_s", "yaw", GREEN;
    ["thrust commanded [N]"]
    "thrust_n", "T", GREEN;
    ["apparent force |F_p| of the controller [N]" logarithmic]
    "fp_n", "|F_p|", BLUE;
    ["margin k"]
    "margin_k", "k", BLUE;
    ["angle to the nearest fold, first order, within 45° [°]"]
    "margin_fold_rad", "fold", BLUE;
};

fn figure(experiment: &Experiment, record: &[Step]) -> Figure {
    let chart = |panel: &Panel| {
        let fold = || Level::new(0.0, "fold");
        let levels = panel.title.contains("fold").then(fold);
        chart(panel, experiment, record).map(|chart| Chart {
            levels: levels.into_iter().collect(),
            ..chart
        })
    };
    let charts: Vec<Chart> = PANELS.iter().filter_map(chart).collect();
    Figure::new(&charts, 210.0).with_strip(&strip(experiment, record))
}

/// The least finite value of a column and its time \[s\], of the steps in which the law was flown: elsewhere there is none. Of an angle to
/// either side, without its sign.
fn least(of: &str, experiment: &Experiment, record: &[Step]) -> Option<(f64, f64)> {
    let column = column(of)?;
    let signed = of != "margin_fold_rad";
    let value = |step: &Step| {
        let value = column.number(experiment, step);
        (if signed { value } else { value.abs() }, step.t)
    };
    let finite = record
        .iter()
        .filter(|step| step.answer.diagnostics_flying().is_some())
        .map(value)
        .filter(|(value, _)| value.is_finite());
    finite.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// How many steps had each word of a column.
fn counted(of: &str, experiment: &Experiment, record: &[Step]) -> Vec<[String; 3]> {
    let Some(column) = column(of) else {
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
        // A guidance that says nothing.
        let text = match text.is_empty() {
            true => "none".to_owned(),
            false => text,
        };
        let share = 100.0 * count as f64 / record.len() as f64;
        [text, count.to_string(), format!("{share:.1}")]
    };
    counts.into_iter().map(row).collect()
}

/// Least margins, counted words, and what had to be assumed.
fn tables(experiment: &Experiment, record: &[Step], said: &[String]) -> Vec<Table> {
    let mut rows = Vec::new();
    let margins = [
        ("gain of the full law, smallest", "margin_k", "", 1.0),
        (
            "angle to the nearest fold, smallest",
            "margin_fold_rad",
            "°",
            180.0 / std::f64::consts::PI,
        ),
        ("apparent force, smallest", "fp_n", "N", 1.0),
    ];
    for (label, of, unit, scale) in margins {
        if let Some((value, t)) = least(of, experiment, record) {
            let value = format!("{:.3} {unit}", scale * value);
            let t = format!("at {t:.3} s");
            rows.push([label.to_owned(), value.trim_end().to_owned(), t]);
        }
    }
    let mut tables = vec![Table::new("Margins", ["", "value", ""], rows)];
    for (of, title) in [
        ("status", "Status"),
        ("mode", "Mode"),
        ("phase", "Phase"),
        ("air", "What of the air was used"),
    ] {
        let rows = counted(of, experiment, record);
        if !rows.is_empty() {
            tables.push(Table::new(title, ["", "rows", "%"], rows));
        }
    }
    if !said.is_empty() {
        let lines = said.iter().map(|line| [line.clone()]);
        tables.push(Table::new("What the log holds", [""], lines));
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
        figure,
        tables,
        text: Some((
            "The experiment whose controller it is (TOML)".to_owned(),
            document.text(),
        )),
        notes: "The commands are in commands.csv.".to_owned(),
        ..Page::default()
    }
}

/// The page about the replay of the log `name` by the controller of `document`. `said` is what had to be assumed.
pub fn page(
    name: &str,
    document: &Document,
    experiment: &Experiment,
    record: &[Step],
    said: &[String],
) -> Page {
    let controller = format!("controller `{}`", experiment.controller.kind);
    let figure = figure(experiment, record);
    let tables = tables(experiment, record, said);
    page_of(name, document, (record.len(), &controller), figure, tables)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::simulate::fly;

    /// Of a flight that begins in safe mode and has a negative k on its way, the least k is that, and |F_p| is not the zero of safe mode.
    #[test]
    fn least_values_keep_their_sign_and_are_of_steps_that_the_law_flew() {
        let mut document = Document::load("round-trip").unwrap();
        document
            .assign("controller.guidance.recovery_s=0.05")
            .unwrap();
        let experiment = document.checked().unwrap();
        let mut record = fly(&experiment).unwrap();
        assert!(record[0].answer.diagnostics_flying().is_none());
        let is_law = |step: &Step| step.answer.diagnostics_flying().is_some();
        let numbers = |of: &str| {
            let column = column(of).unwrap();
            let steps = record.iter().filter(|step| is_law(step));
            steps
                .map(|step| column.number(&experiment, step))
                .fold(f64::INFINITY, f64::min)
        };
        let (k, fp) = (numbers("margin_k"), numbers("fp_n"));
        assert!(k < 0.0 && fp > 0.0, "{k} {fp}");
        assert_eq!(least("margin_k", &experiment, &record).unwrap().0, k);
        assert_eq!(least("fp_n", &experiment, &record).unwrap().0, fp);
        record.retain(|step| !is_law(step));
        assert_eq!(least("fp_n", &experiment, &record), None);
    }
}
