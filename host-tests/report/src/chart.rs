//! What a chart shows, described once: the drawing (SVG) and the chart to explore on the page are both made of it.

/// How a series is drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A line.
    Solid,
    /// A dashed line: bounds and references.
    Dashed,
    /// A dot at every point.
    Dots,
    /// The area between two curves over the same abscissas: the lower one forward, then the upper one back.
    Fan,
    /// The areas inside closed polygons; a value that is not finite is between two of them.
    Cells,
}

/// A colour, by its class in `chart.css`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub(crate) &'static str);

/// Colours of curves.
pub(crate) const BLUE: Color = Color("blue");
pub(crate) const ORANGE: Color = Color("orange");
pub(crate) const GREEN: Color = Color("green");
pub(crate) const GREY: Color = Color("grey");
pub(crate) const PURPLE: Color = Color("purple");
pub(crate) const RED: Color = Color("red");
pub(crate) const BLACK: Color = Color("black");
/// Tints of a fan from the outside in.
pub(crate) const TINTS: [Color; 4] = [
    Color("tint0"),
    Color("tint1"),
    Color("tint2"),
    Color("tint3"),
];
/// Colours of a map, from good to bad.
pub(crate) const HEAT: [Color; 7] = [
    Color("heat0"),
    Color("heat1"),
    Color("heat2"),
    Color("heat3"),
    Color("heat4"),
    Color("heat5"),
    Color("heat6"),
];

/// A curve, dots, or an area. Points of a long curve by increasing abscissa.
pub struct Series<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// Colour.
    pub color: Color,
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

/// A value to be seen across the chart: a limit.
pub struct Level {
    /// The value.
    pub at: f64,
    /// What it is.
    pub label: String,
}

impl Level {
    /// The value `at`, which is what `label` says.
    pub fn new(at: f64, label: impl Into<String>) -> Self {
        let label = label.into();
        Self { at, label }
    }
}

/// A range of values to be seen across the chart: where stall is.
pub struct Band {
    /// Least value.
    pub from: f64,
    /// Greatest value.
    pub to: f64,
    /// What it is.
    pub label: String,
}

/// The least and the greatest of `values`; the wrong way round if there are none.
pub(super) fn ends(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    let wider = |(low, high): (f64, f64), value| (low.min(value), high.max(value));
    values.into_iter().fold(start, wider)
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
    /// Limits. One that is far from every curve is not drawn.
    pub levels: Vec<Level>,
    /// Ranges. Only what lies between the curves' least and greatest values is drawn.
    pub bands: Vec<Band>,
    /// Whether the vertical axis is logarithmic.
    pub logarithmic: bool,
}

impl<'a> Chart<'a> {
    /// A chart without marks over a quantity.
    pub fn over(title: &'a str, horizontal: &'a str, series: Vec<Series<'a>>) -> Self {
        Self {
            title,
            horizontal,
            series,
            marks: Vec::new(),
            levels: Vec::new(),
            bands: Vec::new(),
            logarithmic: false,
        }
    }

    /// A chart without marks over time.
    pub fn over_time(title: &'a str, series: Vec<Series<'a>>) -> Self {
        Self::over(title, "time [s]", series)
    }

    /// Whether the horizontal axis is time.
    pub(super) fn is_over_time(&self) -> bool {
        self.horizontal.starts_with("time")
    }

    /// Least and greatest abscissa.
    pub(super) fn across(&self) -> (f64, f64) {
        let points = self.series.iter().flat_map(|s| &s.points);
        let (begin, end) = ends(points.map(|p| p.0));
        match begin < end {
            true => (begin, end),
            // One point, or none.
            false => (0.0, end.max(1.0)),
        }
    }

    /// Least and greatest value with some room, near limits included. Of a logarithmic chart, of the decimal logarithm.
    pub(super) fn range(&self) -> (f64, f64) {
        let scaled = |y: f64| if self.logarithmic { y.log10() } else { y };
        let points = self.series.iter().flat_map(|s| &s.points);
        let values = points.map(|p| scaled(p.1));
        let (mut low, mut high) = ends(values.filter(|y| y.is_finite()));
        if low > high {
            // Nothing to draw, as when every step was a fault.
            return if self.logarithmic {
                (0.0, 1.0)
            } else {
                (-1.0, 1.0)
            };
        }
        let far = 0.6 * (high - low);
        for level in self.levels.iter().map(|level| scaled(level.at)) {
            if level > low - far && level < high + far {
                (low, high) = (low.min(level), high.max(level));
            }
        }
        // A constant is drawn in the middle, and a rounding error is one.
        let least = if self.logarithmic { 0.2 } else { 1e-3 };
        let room = if high - low < least {
            least
        } else {
            0.07 * (high - low)
        };
        (low - room, high + room)
    }
}

impl<'a> Series<'a> {
    /// A solid curve.
    pub fn line(name: &'a str, color: Color, points: Vec<(f64, f64)>) -> Self {
        Self {
            name,
            color,
            stroke: Stroke::Solid,
            points,
        }
    }

    /// A dashed curve.
    pub fn dashed(name: &'a str, color: Color, points: Vec<(f64, f64)>) -> Self {
        Self {
            stroke: Stroke::Dashed,
            ..Self::line(name, color, points)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_limits_are_in_range_and_far_ones_are_not() {
        let line = Series::line("x", BLUE, vec![(0.0, 0.0), (1.0, 1.0)]);
        let level = |at: f64| Level {
            at,
            label: String::new(),
        };
        let mut chart = Chart::over_time("x", vec![line]);
        let bare = chart.range();
        chart.levels = vec![level(-9.0), level(9.0)];
        assert_eq!(chart.range(), bare);
        chart.levels.push(level(1.5));
        assert!(chart.range().1 > 1.5 && chart.range().0 > -0.2);
    }

    #[test]
    fn a_chart_without_values_has_a_range() {
        for logarithmic in [false, true] {
            let series = vec![Series::line("x", BLUE, vec![(3.0, f64::NAN)])];
            let chart = Chart {
                logarithmic,
                ..Chart::over_time("x", series)
            };
            let ((begin, end), (low, high)) = (chart.across(), chart.range());
            assert!(begin < end && low < high);
        }
    }
}
