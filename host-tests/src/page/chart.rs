//! One chart: curves, dots or areas, a legend, marked points.

use plotters::coord::Shift;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

/// How a series is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A line.
    Solid,
    /// A dashed line: bounds and references.
    Dashed,
    /// A dot at every point.
    Dots,
    /// The areas inside closed polygons; a value that is not finite is between two of them.
    Fill,
}

/// A curve, dots, or an area. Points of a long curve by increasing abscissa.
pub struct Series<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// Colour.
    pub color: RGBColor,
    /// How it is drawn.
    pub stroke: Stroke,
    /// (horizontal, value). A value that is not finite breaks the curve.
    pub points: Vec<(f64, f64)>,
}

/// A marked point.
pub struct Mark {
    /// Where.
    pub at: (f64, f64),
    /// What to say there.
    pub label: String,
    /// How far down the label is moved, out of the way of others \[px\].
    pub shift: i32,
}

/// A chart over time, or over another quantity.
pub struct Chart<'a> {
    /// What is drawn, with its unit: the title above the chart.
    pub title: &'a str,
    /// What the horizontal axis is, with its unit.
    pub horizontal: &'a str,
    /// The curves.
    pub series: Vec<Series<'a>>,
    /// Marked points.
    pub marks: Vec<Mark>,
    /// Whether the vertical axis is logarithmic.
    pub logarithmic: bool,
}

/// Most points drawn per curve: two per pixel column or so.
const MAX_POINTS: usize = 1200;

/// Colours of curves.
pub(crate) const BLUE: RGBColor = RGBColor(0, 98, 178);
pub(crate) const ORANGE: RGBColor = RGBColor(214, 94, 0);
pub(crate) const GREEN: RGBColor = RGBColor(0, 138, 100);
pub(crate) const GREY: RGBColor = RGBColor(120, 128, 138);
const INK: RGBColor = RGBColor(38, 44, 52);
const GRID: RGBColor = RGBColor(222, 226, 231);
const FAINT_GRID: RGBColor = RGBColor(243, 245, 247);

impl<'a> Chart<'a> {
    /// A chart without marks over a quantity.
    pub fn over(title: &'a str, horizontal: &'a str, series: Vec<Series<'a>>) -> Self {
        Self {
            title,
            horizontal,
            series,
            marks: Vec::new(),
            logarithmic: false,
        }
    }

    /// A chart without marks over time.
    pub fn over_time(title: &'a str, series: Vec<Series<'a>>) -> Self {
        Self::over(title, "time [s]", series)
    }
}

impl<'a> Series<'a> {
    /// A solid curve.
    pub fn line(name: &'a str, color: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self {
            name,
            color,
            stroke: Stroke::Solid,
            points,
        }
    }

    /// A dashed curve.
    pub fn dashed(name: &'a str, color: RGBColor, points: Vec<(f64, f64)>) -> Self {
        Self {
            stroke: Stroke::Dashed,
            ..Self::line(name, color, points)
        }
    }
}

impl Chart<'_> {
    /// Draws the chart on `area`.
    fn draw(&self, area: &DrawingArea<SVGBackend, Shift>) -> Drawn {
        let abscissas = || self.series.iter().flat_map(|s| &s.points).map(|p| p.0);
        let begin = abscissas().fold(f64::INFINITY, f64::min);
        let end = abscissas().fold(f64::NEG_INFINITY, f64::max);
        let (begin, end) = match begin < end {
            true => (begin, end),
            // One point, or none.
            false => (0.0, end.max(1.0)),
        };
        let (low, high) = self.range();
        let mut builder = ChartBuilder::on(area);
        builder
            .caption(self.title, ("sans-serif", 19).into_font().color(&INK))
            .margin(8)
            .margin_right(18)
            .x_label_area_size(42)
            .y_label_area_size(64);
        if self.logarithmic {
            let chart = builder.build_cartesian_2d(begin..end, (low..high).log_scale())?;
            self.fill(chart, begin..end, (low.ln(), high.ln()), f64::ln)
        } else {
            let chart = builder.build_cartesian_2d(begin..end, low..high)?;
            self.fill(chart, begin..end, (low, high), |y| y)
        }
    }

    /// The vertical range: the data's with room for the legend and the marks.
    fn range(&self) -> (f64, f64) {
        let values = || {
            let all = self.series.iter().flat_map(|s| &s.points).map(|p| p.1);
            all.filter(|y| y.is_finite() && (!self.logarithmic || *y > 0.0))
        };
        let low = values().fold(f64::INFINITY, f64::min);
        let high = values().fold(f64::NEG_INFINITY, f64::max);
        if low > high {
            // Nothing to draw, as when every step was a fault.
            return if self.logarithmic {
                (1.0, 10.0)
            } else {
                (-1.0, 1.0)
            };
        }
        if self.logarithmic {
            return (low / 3.0, high * 12.0);
        }
        let span = (high - low).max(1e-3);
        let legend = if self.series.len() > 1 { 0.45 } else { 0.2 };
        (low - 0.12 * span, high + legend * span)
    }

    fn fill<'a, 'b: 'a, Y>(
        &self,
        mut chart: ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, Y>>,
        across: std::ops::Range<f64>,
        (bottom, top): (f64, f64),
        height: fn(f64) -> f64,
    ) -> Drawn
    where
        Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let text = || ("sans-serif", 15).into_font().color(&INK);
        chart
            .configure_mesh()
            .bold_line_style(GRID)
            .light_line_style(FAINT_GRID)
            .axis_style(INK)
            .label_style(text())
            .axis_desc_style(text())
            .x_labels(11)
            .y_labels(7)
            .max_light_lines(2)
            .x_desc(self.horizontal)
            .x_label_formatter(&|t| number(*t))
            .y_label_formatter(&|y| number(*y))
            .draw()?;
        for series in &self.series {
            let style = series.color.stroke_width(2);
            if series.stroke == Stroke::Dots {
                let color = series.color.filled();
                let dots = series.points.iter().filter(|p| p.1.is_finite());
                chart
                    .draw_series(dots.map(|p| Circle::new(*p, 2, color)))?
                    .label(series.name)
                    .legend(move |(x, y)| Circle::new((x + 9, y), 3, color));
                continue;
            }
            if series.stroke == Stroke::Fill {
                let color = series.color.filled();
                let pieces = series.points.split(|p| !p.1.is_finite());
                let areas = pieces.filter(|piece| piece.len() > 2);
                chart
                    .draw_series(areas.map(|piece| Polygon::new(piece.to_vec(), color)))?
                    .label(series.name)
                    .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 18, y + 5)], color));
                continue;
            }
            let dashed = series.stroke == Stroke::Dashed;
            let drawable = |p: &(f64, f64)| p.1.is_finite() && (!self.logarithmic || p.1 > 0.0);
            let pieces = series.points.split(|p| !drawable(p)).map(thin);
            // One element per unbroken piece; the legend goes with the first.
            let mut named = false;
            for piece in pieces.filter(|piece| piece.len() > 1) {
                let drawn = if dashed {
                    chart.draw_series(DashedLineSeries::new(piece, 7, 5, style))?
                } else {
                    chart.draw_series(LineSeries::new(piece, style))?
                };
                if !std::mem::replace(&mut named, true) {
                    let line = |x, y| [(x, y), (x + 18, y)];
                    let drawn = drawn.label(series.name);
                    if dashed {
                        drawn.legend(move |(x, y)| DashedPathElement::new(line(x, y), 7, 4, style));
                    } else {
                        drawn.legend(move |(x, y)| PathElement::new(line(x, y), style));
                    }
                }
            }
        }
        for mark in &self.marks {
            // The label goes where there is room: away from the nearer edges.
            let right = mark.at.0 < across.start + 0.6 * (across.end - across.start);
            let above = height(mark.at.1) < 0.5 * (bottom + top);
            let (x, anchor) = if right {
                (9, plotters::style::text_anchor::HPos::Left)
            } else {
                (-9, plotters::style::text_anchor::HPos::Right)
            };
            let vertical = plotters::style::text_anchor::VPos::Center;
            let style = text().pos(plotters::style::text_anchor::Pos::new(anchor, vertical));
            // On a logarithmic axis it would lie on the bound that the mark is close to.
            let y = match (self.logarithmic, above) {
                (true, _) => 16,
                (false, true) => 3,
                (false, false) => -3,
            };
            chart.draw_series(std::iter::once(
                EmptyElement::at(mark.at)
                    + Circle::new((0, 0), 4, INK.stroke_width(2))
                    + Text::new(mark.label.clone(), (x, y + mark.shift), style),
            ))?;
        }
        if self.series.len() > 1 {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.85))
                .border_style(GRID)
                .label_font(text())
                .legend_area_size(24)
                .margin(6)
                .draw()?;
        }
        Ok(())
    }
}

/// The charts on a sheet of two columns, each this many pixels `high`, as SVG text.
pub fn sheet(charts: &[Chart], high: u32) -> Result<String, DrawingError> {
    let mut text = String::new();
    draw(&mut text, charts, high)?;
    Ok(text)
}

fn draw(text: &mut String, charts: &[Chart], high: u32) -> Drawn {
    let lines = charts.len().div_ceil(2);
    let root = SVGBackend::with_string(text, (1280, high * lines as u32)).into_drawing_area();
    root.fill(&WHITE)?;
    for (chart, area) in charts.iter().zip(root.split_evenly((lines, 2))) {
        chart.draw(&area)?;
    }
    root.present()
}

/// Drawing into a string fails only where a chart is malformed.
pub type DrawingError = DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>;
type Drawn = Result<(), DrawingError>;

/// A tick's label: as short as it can be.
fn number(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    // Not "-0".
    (rounded + 0.0).to_string()
}

/// At most about [`MAX_POINTS`] points that keep every bucket's extremes.
fn thin(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MAX_POINTS {
        return points.to_vec();
    }
    let mut kept = Vec::with_capacity(MAX_POINTS + 2);
    for bucket in points.chunks(points.len().div_ceil(MAX_POINTS / 2)) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let low = bucket.iter().min_by(by_value);
        let high = bucket.iter().max_by(by_value);
        let mut both: Vec<_> = low.into_iter().chain(high).copied().collect();
        both.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.extend(both);
    }
    kept.extend(points.last());
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_extremes_and_the_end() {
        let mut points: Vec<_> = (0..20_001).map(|i| (f64::from(i), 0.0)).collect();
        points[7777].1 = 5.0;
        points[7778].1 = -5.0;
        let kept = thin(&points);
        assert!(kept.len() <= MAX_POINTS + 2);
        assert!(kept.contains(&(7777.0, 5.0)) && kept.contains(&(7778.0, -5.0)));
        assert_eq!(kept.last(), points.last());
        assert!(kept.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }

    /// Two cells of a map are two areas, of one colour and one line in the legend.
    #[test]
    fn an_area_ends_where_a_value_is_missing() {
        let cell = |x: f64| {
            let corners = [(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)];
            corners.into_iter().chain([(x, f64::NAN)])
        };
        let series = |x: Vec<f64>| Series {
            name: "cells",
            color: ORANGE,
            stroke: Stroke::Fill,
            points: x.into_iter().flat_map(cell).collect(),
        };
        let polygons = |x: Vec<f64>| {
            let chart = Chart::over("map", "x", vec![series(x), Series::line("l", BLUE, vec![])]);
            let svg = sheet(&[chart], 300).unwrap();
            svg.matches("<polygon").count()
        };
        assert_eq!(polygons(vec![0.0, 3.0]) - polygons(vec![0.0]), 1);
        assert_eq!(polygons(vec![0.0]), 1);
    }
}
