//! The results as a page: charts, a summary, a table per condition.

use super::chart::{BLACK, BLUE, Chart, Color, GREEN, GREY, ORANGE, PURPLE, RED, Series};
use super::{Figure, Page, Table, columns};
use alula_sim::figures::{LATE, LOST, REACHED};
use alula_study::{
    ASTRAY, Cell, Comparison, Condition, FAR, OSCILLATION, Results, Variant, header,
};

const PALETTE: [Color; 6] = [RED, BLUE, ORANGE, GREEN, PURPLE, BLACK];

/// What the columns are.
fn definitions() -> String {
    format!(
        "Loss and gain are the greatest altitude below and above the reference, out until the reference slows \
         down and back from then on. Cruise after is the time from the reference's first change until |v − v_r| \
         to the cruise velocity stays under {REACHED} m/s to the end of cruise. Cruise error and end error are the \
         largest |v − v_r| in the last {LATE} s of cruise and of the flight. The peak of the body rate is the largest \
         true one about one axis. Ahead is how far the vehicle runs ahead of the reference from where it slows down on.\n\n\
         A flight departs if it sinks more than {LOST} m below the reference or ends, over its last {LATE} s, with a \
         mean velocity error above {ASTRAY} m/s, and diverges if it comes to no number; its figures are left out. It strays if it ends more than {FAR} m from \
         the reference altitude, and oscillates if its body rate is above {OSCILLATION} rad/s root mean square in the last \
         {LATE} s of cruise or of the flight. Of several seeds the median is given, and the worst in brackets."
    )
}

/// The summary: the greatest distance from the reference altitude, or how the flight ended.
fn summary(comparison: &Comparison, results: &Results) -> Table {
    let mut header = columns(["condition"]);
    header.extend(comparison.variants.iter().map(|p| p.name.clone()));
    let rows = comparison
        .conditions
        .iter()
        .enumerate()
        .map(|(c, condition)| {
            let verdict = |p| Results::verdict(results.cell(comparison, c, p));
            std::iter::once(condition.name.clone())
                .chain((0..comparison.variants.len()).map(verdict))
                .collect()
        });
    Table {
        title: "Greatest distance from the reference altitude [m]".to_owned(),
        header,
        rows: rows.collect(),
    }
}

/// The table of each condition.
fn tables(comparison: &Comparison, results: &Results) -> Vec<Table> {
    let table = |(c, condition): (usize, &Condition)| {
        let row = |(p, variant): (usize, &Variant)| {
            std::iter::once(variant.name.clone())
                .chain(results.cell(comparison, c, p).texts())
                .collect()
        };
        Table {
            title: format!("{}: {}", condition.name, condition.title),
            header: columns(["variant"]).into_iter().chain(header()).collect(),
            rows: comparison.variants.iter().enumerate().map(row).collect(),
        }
    };
    comparison
        .conditions
        .iter()
        .enumerate()
        .map(table)
        .collect()
}

/// Altitudes beyond this \[m\] are not drawn: one departed flight would shrink all the others to a line.
const DRAWN: f64 = 12.0;
/// So are speeds beyond this \[m/s\].
const FASTEST: f64 = 40.0;

fn figure<'a>(comparison: &'a Comparison, results: &Results) -> Figure {
    let titles: Vec<[String; 2]> = comparison
        .charts
        .iter()
        .map(|name| {
            [
                format!("{name}: altitude over the reference, within {DRAWN} m [m]"),
                format!("{name}: forward velocity [m/s]"),
            ]
        })
        .collect();
    let mut charts = Vec::new();
    for (name, [altitude, speed]) in comparison.charts.iter().zip(&titles) {
        let Some(c) = comparison.conditions.iter().position(|x| x.name == *name) else {
            continue;
        };
        // Values beyond what is to be seen are left out.
        let line = |cell: &Cell, of: &str, most: f64| -> Vec<(f64, f64)> {
            let (times, values) = (&cell.samples["t_s"], &cell.samples[of]);
            let drawn = |value: &f64| if value.abs() < most { *value } else { f64::NAN };
            let points = times.iter().zip(values);
            points.map(|(t, value)| (*t, drawn(value))).collect()
        };
        let named = |of: &str, most: f64| -> Vec<Series<'a>> {
            let variants = comparison.variants.iter().enumerate();
            let curve = |(p, variant): (usize, &'a Variant)| {
                let name = variant.name.as_str();
                let points = line(results.cell(comparison, c, p), of, most);
                let color = PALETTE[p % PALETTE.len()];
                match p < PALETTE.len() {
                    true => Series::line(name, color, points),
                    false => Series::dashed(name, color, points),
                }
            };
            variants.map(curve).collect()
        };
        charts.push(Chart::over_time(altitude, named("altitude_m", DRAWN)));
        let reference = line(results.cell(comparison, c, 0), "path_v_north_m_s", FASTEST);
        let mut speeds = vec![Series::dashed("reference", GREY, reference)];
        speeds.extend(named("v_north_m_s", FASTEST));
        charts.push(Chart::over_time(speed, speeds));
    }
    Figure::new(&charts, 280.0)
}

/// The page of a comparison called `name`.
pub fn page(name: &str, comparison: &Comparison, results: &Results) -> Page {
    let mut all = vec![summary(comparison, results)];
    all.extend(tables(comparison, results));
    let variants = comparison.variants.iter();
    let variants = variants.map(|p| [p.name.clone(), p.title.clone()]);
    all.push(Table::new("Variants", ["name", ""], variants));
    Page {
        title: format!("Comparison {name}"),
        lead: comparison.description.clone(),
        figure: figure(comparison, results),
        tables: all,
        notes: definitions(),
        ..Page::default()
    }
}
