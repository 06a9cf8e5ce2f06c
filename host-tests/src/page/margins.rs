//! The plot of stability margins against speed.

use super::chart::{BLUE, Chart, DrawingError, ORANGE, Series, sheet};
use crate::margins::Point;

/// Largest stable lag and delay against speed as SVG text, of one or two named loops.
pub fn margins_svg(loops: &[(&'static str, &[Point])]) -> Result<String, DrawingError> {
    let chart = |title, value: &dyn Fn(&Point) -> Option<f64>| {
        let point = |p: &Point| (p.speed_m_s, value(p).unwrap_or(f64::NAN));
        let series = loops
            .iter()
            .zip([BLUE, ORANGE])
            .map(|(&(name, points), color)| {
                Series::line(name, color, points.iter().map(point).collect())
            });
        Chart {
            logarithmic: true,
            ..Chart::over(title, "speed [m/s]", series.collect())
        }
    };
    let charts = [
        chart("largest stable lag of the rate loop [s]", &|p| p.lag_s),
        chart("largest stable delay of the command [s]", &|p| p.delay_s),
    ];
    sheet(&charts, 310)
}
