//! The plot of stability margins against speed.

use super::Figure;
use super::chart::{BLUE, Chart, ORANGE, Series, Stroke};
use alula_sim::margins::{LONGEST, Point};

/// Largest stable lag and delay against speed of one or two named loops: dots, for what stands side by side may be different equilibria.
pub fn margins_figure(loops: &[(&'static str, &[Point])]) -> Figure {
    let chart = |title, value: &dyn Fn(&Point) -> Option<f64>| {
        let point = |p: &Point| (p.speed_m_s, value(p).unwrap_or(LONGEST));
        let series = loops
            .iter()
            .zip([BLUE, ORANGE])
            .map(|(&(name, points), color)| Series {
                stroke: Stroke::Dots,
                ..Series::line(name, color, points.iter().map(point).collect())
            });
        Chart {
            logarithmic: true,
            ..Chart::over(title, "speed [m/s]", series.collect())
        }
    };
    let charts = [
        chart(
            "largest stable lag of the rate loop [s]: 5 is that or more",
            &|p| p.lag_s,
        ),
        chart(
            "largest stable delay of the command [s]: 5 is that or more",
            &|p| p.delay_s,
        ),
    ];
    Figure::new(&charts, 210.0)
}
