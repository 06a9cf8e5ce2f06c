//! The plot of stability margins against speed.

use super::chart::{BLUE, Chart, DrawingError, ORANGE, Series, Stroke, sheet};
use crate::margins::Point;

/// Largest stable lag and delay against speed as SVG text, of one or two named loops.
pub fn margins_svg(loops: &[(&'static str, &[Point])]) -> Result<String, DrawingError> {
    let chart = |title, value: &dyn Fn(&Point) -> Option<f64>| Chart {
        title,
        horizontal: "speed [m/s]",
        series: loops
            .iter()
            .zip([BLUE, ORANGE])
            .map(|((name, points), color)| Series {
                name,
                color,
                stroke: Stroke::Solid,
                points: points
                    .iter()
                    .map(|p| (p.speed_m_s, value(p).unwrap_or(f64::NAN)))
                    .collect(),
            })
            .collect(),
        marks: Vec::new(),
        logarithmic: true,
    };
    let charts = [
        chart("largest stable lag of the rate loop [s]", &|p| p.lag_s),
        chart("largest stable delay of the command [s]", &|p| p.delay_s),
    ];
    sheet(&charts, 310)
}
