//! The figure of a fit: table and model, over all angles and near stall.

use super::Figure;
use super::chart::{BLUE, Chart, GREY, Series, Stroke};
use alula_sim::reference::{Aerodynamics, Coefficients, Row};

/// The figure of `rows` and the `model` fitted to them .
pub fn figure(rows: &[Row], model: &Aerodynamics) -> Figure {
    let chart = |title, last: f64, k: usize, of: fn(&Coefficients) -> f64| {
        let table = rows.iter().map(|row| (row[0].to_degrees(), row[k]));
        let table = table.filter(|point| (-1e-6..last + 1e-6).contains(&point.0));
        let angles = (0..1000).map(|n| last * f64::from(n) / 1000.0);
        let fit = angles.map(|degrees| (degrees, of(&model.at(degrees.to_radians()))));
        let series = vec![
            Series {
                stroke: Stroke::Dots,
                ..Series::line("table", GREY, table.collect())
            },
            Series::line("fit", BLUE, fit.collect()),
        ];
        Chart::over(title, "angle of attack α [°]", series)
    };
    Figure::new(
        &[
            chart("c_L", 180.0, 1, |c| c.c_l),
            chart("c_D", 180.0, 2, |c| c.c_d),
            chart("c_L near stall", 30.0, 1, |c| c.c_l),
            chart("c_D near stall", 30.0, 2, |c| c.c_d),
        ],
        250.0,
    )
}
