//! The page of a vehicle learned from its log.

use alula_design::identify::Identified;

use super::chart::{BLUE, Chart, GREY, Series};
use super::{Figure, Page, Table};

/// Rows farther apart than this \[s\] are of two pieces.
const GAP: f64 = 1.0;

/// The page of what the flight `name` shows; `known` is the file that `new` takes.
pub fn page(name: &str, vehicle: &Identified, known: &str, notes: &[String]) -> Page {
    // A curve ends where what was fitted begins.
    let of = |which: usize| -> Vec<(f64, f64)> {
        let pieces = vehicle.held_out.chunk_by(|a, b| b[0] - a[0] < GAP);
        let points = pieces.flat_map(|piece| {
            let end = piece.last().map(|row| (row[0], f64::NAN));
            let drawn = piece.iter().map(|row| (row[0], row[which]));
            drawn.chain(end)
        });
        points.collect()
    };
    let chart = |title, had: usize| {
        let series = vec![
            Series::line("measured", GREY, of(had)),
            Series::line("predicted", BLUE, of(had + 1)),
        ];
        Chart::over(title, "t [s]", series)
    };
    let figure = Figure::new(
        &[
            chart(
                "specific force along the nose [m/s²], of what was not fitted",
                1,
            ),
            chart(
                "specific force along the belly [m/s²], of what was not fitted",
                3,
            ),
        ],
        250.0,
    );
    let [fitted, held] = vehicle.seconds;
    let [nose, belly] = vehicle.predicted.map(|share| 100.0 * share);
    Page {
        title: format!("{name}: the vehicle that it shows"),
        lead: format!(
            "From {:.0} s of flight. Fitted to {fitted:.0} s of them, the model predicts of the other {held:.0} s {nose:.0} % of the variance of the specific force along \
             the nose, and {belly:.0} % along the belly. What is given is fitted to all.",
            fitted + held
        ),
        figure,
        tables: vec![
            Table::new(
                "Measured, with intervals of 95 %",
                ["quantity", "value", "within"],
                vehicle.rows(),
            ),
            Table::new(
                "What the flight does not show, and the manoeuvre that would",
                ["what, and what shows it"],
                vehicle.missing.iter().map(|line| [line.clone()]),
            ),
        ],
        text: Some(("known.toml".to_owned(), known.to_owned())),
        remarks: notes.to_vec(),
        notes: "The pieces of the flight that were held out are ten seconds of each thirty."
            .to_owned(),
        ..Page::default()
    }
}
