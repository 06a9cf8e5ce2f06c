//! A chart as SVG: what is printed, what is seen without a script, and what the page's script reads the curves from.

use std::fmt::Write as _;

use super::chart::{Chart, Series, Stroke};
use super::ticks;
use super::trace::{Units, thin, tolerance, write};

/// Width of a drawn chart \[px\].
pub const WIDE: f64 = 600.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 14.0;
/// Heights of a line of the title, of the legend, and of what is under the plot \[px\].
const TITLE: f64 = 20.0;
const LEGEND: f64 = 19.0;
const BELOW: f64 = 42.0;
/// Letters of a title that fit in one line.
const LETTERS: usize = 68;

/// For what a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A sheet, or a wide window.
    Sheet,
    /// A narrow window: the parts one below the other.
    Narrow,
    /// One of many: the way flown alone.
    Small,
}

/// Width of what is drawn narrow \[px\].
pub const NARROW: f64 = 440.0;

impl Format {
    /// The width, which is `sheet` \[px\] on a sheet.
    pub fn wide(self, sheet: f64) -> f64 {
        if self == Self::Sheet { sheet } else { NARROW }
    }
}

/// Something drawn, in a frame of its own.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Width and height of the frame \[px\].
    pub size: [f64; 2],
    /// Classes and data of the element.
    pub attributes: String,
    /// The elements inside.
    pub body: String,
}

impl Drawn {
    /// The element, `place`d by attributes.
    pub fn svg(&self, place: &str) -> String {
        let Self {
            size: [wide, high],
            attributes,
            body,
        } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" {place} viewBox=\"0 0 {wide} {high}\" {attributes}>\n{body}</svg>\n"
        )
    }
}

/// Text as it stands in an element or an attribute.
pub fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

/// About the width of a text \[px\] in letters this high.
pub fn width(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}

/// A title at the top of a picture of this width, in as many lines as it takes; the height of them but for the first \[px\].
pub fn title(text: &mut String, words: &str, [x, y]: [f64; 2], wide: f64) -> f64 {
    const LINE: f64 = 19.0;
    let letters = (wide - x) / width(" ", 15.0);
    let all = lines(words, letters as usize);
    for (i, line) in all.iter().enumerate() {
        let _ = writeln!(
            text,
            "<text class=\"title\" x=\"{x}\" y=\"{:.1}\">{}</text>",
            y + LINE * i as f64,
            escape(line)
        );
    }
    LINE * (all.len() - 1) as f64
}

/// The lines of a text of at most so many letters, as far as its words allow.
fn lines(text: &str, letters: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("a line");
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > letters {
            lines.push(word.to_owned());
        } else {
            *line += if line.is_empty() { "" } else { " " };
            *line += word;
        }
    }
    lines
}

/// A rectangle of the plot, and what its axes are.
struct Plot {
    top: f64,
    bottom: f64,
    across: (f64, f64),
    range: (f64, f64),
    x: Units,
    y: Units,
}

impl Plot {
    fn x(&self, value: f64) -> f64 {
        let (begin, end) = self.across;
        LEFT + (WIDE - LEFT - RIGHT) * (value - begin) / (end - begin)
    }

    /// Of a value, or of the logarithm on a logarithmic axis.
    fn y(&self, value: f64) -> f64 {
        let (low, high) = self.range;
        self.bottom - (self.bottom - self.top) * (value - low) / (high - low)
    }
}

/// Draws `chart` with a plot `high` pixels high.
pub fn draw(chart: &Chart, high: f64) -> Drawn {
    let mut body = String::new();
    let titles = lines(chart.title, LETTERS);
    for (i, line) in titles.iter().enumerate() {
        let y = 15.0 + TITLE * i as f64;
        let _ = writeln!(
            body,
            "<text class=\"title\" x=\"2\" y=\"{y}\">{}</text>",
            escape(line)
        );
    }
    let below = legend(&mut body, &chart.series, TITLE * titles.len() as f64);
    let range = chart.range();
    let plot = Plot {
        top: below + 8.0,
        bottom: below + 8.0 + high,
        across: chart.across(),
        range,
        x: Units::of(chart.across(), 5000.0),
        y: Units::of(range, 2000.0),
    };
    axes(&mut body, chart, &plot);
    for series in &chart.series {
        curve(&mut body, series, chart.logarithmic, &plot);
    }
    levels(&mut body, chart, &plot);
    marks(&mut body, chart, &plot);
    Drawn {
        size: [WIDE, plot.bottom + BELOW],
        attributes: attributes(chart, &plot),
        body,
    }
}

/// What the script must know besides the elements.
fn attributes(chart: &Chart, plot: &Plot) -> String {
    let mut classes = vec!["chart"];
    let increases = |s: &Series| match s.stroke {
        Stroke::Cells => false,
        Stroke::Fan => true,
        Stroke::Dots => true,
        Stroke::Solid | Stroke::Dashed => s.points.windows(2).all(|p| p[1].0 >= p[0].0),
    };
    if chart.series.iter().all(increases) {
        classes.push("explore");
    }
    if chart.is_over_time() {
        classes.push("time");
    }
    if is_angle(chart) {
        classes.push("angle");
    }
    if chart.logarithmic {
        classes.push("logarithmic");
    }
    let pair = |(a, b): (f64, f64)| format!("{a} {b}");
    format!(
        "class=\"{}\" data-title=\"{}\" data-over=\"{}\" data-x=\"{}\" data-y=\"{}\" data-units=\"{} {} {} {}\"",
        classes.join(" "),
        escape(chart.title),
        escape(chart.horizontal),
        pair(plot.across),
        pair(plot.range),
        short(plot.x.origin),
        plot.x.unit,
        short(plot.y.origin),
        plot.y.unit,
    )
}

/// Without the last digits, which are the rounding's.
fn short(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}

fn is_angle(chart: &Chart) -> bool {
    chart.title.contains("[°]")
}

/// Names of the series above the plot; where the last line ends.
fn legend(body: &mut String, series: &[Series], top: f64) -> f64 {
    if series.len() < 2 {
        return top;
    }
    let (mut x, mut y) = (LEFT, top + 15.0);
    for one in series {
        let wide = 28.0 + width(one.name, 14.0) + 14.0;
        if x + wide > WIDE && x > LEFT {
            (x, y) = (LEFT, y + LEGEND);
        }
        let class = class(one);
        let _ = match one.stroke {
            Stroke::Fan | Stroke::Cells => writeln!(
                body,
                "<rect class=\"{class}\" x=\"{x:.0}\" y=\"{:.0}\" width=\"20\" height=\"10\"/>",
                y - 9.0
            ),
            Stroke::Dots => writeln!(
                body,
                "<path class=\"{class}\" d=\"M{:.0} {:.0}h0\"/>",
                x + 10.0,
                y - 4.0
            ),
            Stroke::Solid | Stroke::Dashed => writeln!(
                body,
                "<path class=\"{class}\" d=\"M{x:.0} {:.0}h20\"/>",
                y - 4.0
            ),
        };
        let _ = writeln!(
            body,
            "<text x=\"{:.0}\" y=\"{y:.0}\">{}</text>",
            x + 25.0,
            escape(one.name)
        );
        x += wide;
    }
    y + 2.0
}

fn class(series: &Series) -> String {
    let kind = match series.stroke {
        Stroke::Solid => "line",
        Stroke::Dashed => "line dash",
        Stroke::Dots => "dots",
        Stroke::Fan => "area fan",
        Stroke::Cells => "area cells",
    };
    format!("{kind} {}", series.color.0)
}

fn axes(body: &mut String, chart: &Chart, plot: &Plot) {
    let (top, bottom, right) = (plot.top, plot.bottom, WIDE - RIGHT);
    let values: Vec<(f64, f64)> = if chart.logarithmic {
        let all = ticks::logarithmic(plot.range).into_iter();
        all.map(|value| (value, value.log10())).collect()
    } else {
        let all = ticks::linear(plot.range, 7.0, is_angle(chart)).into_iter();
        all.map(|value| (value, value)).collect()
    };
    let mut grid = String::new();
    for (value, at) in values {
        let y = plot.y(at);
        let _ = write!(grid, "M{LEFT} {y:.1}H{right}");
        let _ = writeln!(
            body,
            "<text class=\"tick y\" x=\"{}\" y=\"{:.1}\">{}</text>",
            LEFT - 7.0,
            y + 4.5,
            ticks::label(value)
        );
    }
    for value in ticks::linear(plot.across, 9.0, chart.horizontal.contains("[°]")) {
        let x = plot.x(value);
        let _ = write!(grid, "M{x:.1} {top:.1}V{bottom:.1}");
        let _ = writeln!(
            body,
            "<text class=\"tick x\" x=\"{x:.1}\" y=\"{:.1}\">{}</text>",
            bottom + 17.0,
            ticks::label(value)
        );
    }
    let _ = writeln!(body, "<path class=\"grid\" d=\"{grid}\"/>");
    let _ = writeln!(
        body,
        "<path class=\"axis\" d=\"M{LEFT} {top:.1}V{bottom:.1}H{right}\"/>\n<text class=\"tick x\" x=\"{:.0}\" y=\"{:.1}\">{}</text>",
        0.5 * (LEFT + right),
        bottom + 35.0,
        escape(chart.horizontal)
    );
}

/// One path with all pieces of a series, in whole units of the axes.
fn curve(body: &mut String, series: &Series, logarithmic: bool, plot: &Plot) {
    let scaled = |&(x, y): &(f64, f64)| (x, if logarithmic { y.log10() } else { y });
    let points: Vec<(f64, f64)> = series.points.iter().map(scaled).collect();
    let tolerance = tolerance(plot.range);
    let mut data = String::new();
    for piece in points.split(|p| !p.1.is_finite()) {
        match series.stroke {
            Stroke::Dots => {
                for p in piece {
                    let _ = write!(data, "M{} {}h0", plot.x.count(p.0), plot.y.count(p.1));
                }
            }
            Stroke::Solid | Stroke::Dashed if piece.len() > 1 => {
                write(&mut data, thin(piece, tolerance), plot.x, plot.y);
            }
            Stroke::Fan if piece.len() > 3 => {
                let (lower, upper) = piece.split_at(piece.len() / 2);
                let back: Vec<_> = upper.iter().rev().copied().collect();
                let back = thin(&back, tolerance).into_iter().rev();
                let around = thin(lower, tolerance).into_iter().chain(back);
                write(&mut data, around, plot.x, plot.y);
                data.push('z');
            }
            Stroke::Cells if piece.len() > 2 => {
                write(&mut data, piece.iter().copied(), plot.x, plot.y);
                data.push('z');
            }
            _ => {}
        }
    }
    let origin = (plot.x(plot.x.origin), plot.y(plot.y.origin));
    let scale = (
        plot.x(plot.x.origin + plot.x.unit) - origin.0,
        plot.y(plot.y.origin + plot.y.unit) - origin.1,
    );
    let _ = writeln!(
        body,
        "<path class=\"{}\" data-name=\"{}\" transform=\"translate({:.3} {:.3}) scale({:.6} {:.6})\" d=\"{data}\"/>",
        class(series),
        escape(series.name),
        origin.0,
        origin.1,
        scale.0,
        scale.1,
    );
}

fn levels(body: &mut String, chart: &Chart, plot: &Plot) {
    let right = WIDE - RIGHT;
    let scaled = |y: f64| if chart.logarithmic { y.log10() } else { y };
    let (low, high) = plot.range;
    // Labels of neighbours do not lie on each other.
    let mut written: Vec<f64> = Vec::new();
    let mut label = |body: &mut String, y: f64, text: &str| {
        // Above what it says, or below where there is no room.
        let y = if y < plot.top + 13.0 { y + 17.0 } else { y };
        if written.iter().all(|other| (other - y).abs() > 14.0) && !text.is_empty() {
            written.push(y);
            let (x, text) = (right - 3.0, escape(text));
            let _ = writeln!(
                body,
                "<text class=\"note\" x=\"{x}\" y=\"{y:.1}\">{text}</text>"
            );
        }
    };
    for band in &chart.bands {
        let (from, to) = (band.from.max(low), band.to.min(high));
        if from >= to {
            continue;
        }
        let (from, to) = (plot.y(from), plot.y(to));
        let _ = writeln!(
            body,
            "<rect class=\"band\" data-from=\"{}\" data-to=\"{}\" data-label=\"{}\" x=\"{LEFT}\" y=\"{to:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
            band.from,
            band.to,
            escape(&band.label),
            right - LEFT,
            from - to
        );
        label(body, to - 3.0, &band.label);
    }
    for level in &chart.levels {
        let at = scaled(level.at);
        if at < low || at > high {
            continue;
        }
        let y = plot.y(at);
        let _ = writeln!(
            body,
            "<path class=\"level\" data-at=\"{}\" data-label=\"{}\" d=\"M{LEFT} {y:.1}H{right}\"/>",
            level.at,
            escape(&level.label)
        );
        label(body, y - 3.0, &level.label);
    }
}

fn marks(body: &mut String, chart: &Chart, plot: &Plot) {
    for mark in &chart.marks {
        let (begin, end) = plot.across;
        let value = if chart.logarithmic {
            mark.at.1.log10()
        } else {
            mark.at.1
        };
        if !value.is_finite() {
            continue;
        }
        let (x, y) = (plot.x(mark.at.0), plot.y(value));
        // The label goes where there is room: away from the nearer edges.
        let left = mark.at.0 > begin + 0.6 * (end - begin);
        let above = y > 0.5 * (plot.top + plot.bottom);
        let (dx, anchor) = if left { (-8.0, "end") } else { (8.0, "start") };
        let dy = if above { -7.0 } else { 16.0 } + f64::from(mark.shift);
        let _ = writeln!(
            body,
            "<g class=\"mark\" data-at=\"{} {}\" data-label=\"{}\"><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text></g>",
            mark.at.0,
            mark.at.1,
            escape(&mark.label),
            x + dx,
            y + dy,
            escape(&mark.label)
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::chart::{BLUE, ORANGE};
    use super::*;

    /// Two cells of a map are two areas, of one colour and one line in the legend.
    #[test]
    fn an_area_ends_where_a_value_is_missing() {
        let cell = |x: f64| {
            let corners = [(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)];
            corners.into_iter().chain([(x, f64::NAN)])
        };
        let series = Series {
            name: "cells",
            color: ORANGE,
            stroke: Stroke::Cells,
            points: [0.0, 3.0].into_iter().flat_map(cell).collect(),
        };
        let chart = Chart::over("map", "x", vec![series, Series::line("l", BLUE, vec![])]);
        let drawn = draw(&chart, 200.0);
        let path = drawn
            .body
            .split("data-name=\"cells\"")
            .nth(1)
            .unwrap()
            .lines()
            .next()
            .unwrap();
        assert_eq!(path.matches('z').count(), 2);
        assert!(!drawn.attributes.contains("explore"));
    }

    #[test]
    fn markup_in_names_is_text() {
        let chart = Chart::over_time("a < b & \"c\"", vec![Series::line("<i>", BLUE, vec![])]);
        let text = draw(&chart, 100.0).svg("");
        assert!(text.contains("a &lt; b &amp; &quot;c&quot;") && !text.contains("<i>"));
    }

    #[test]
    fn long_titles_are_broken_between_words() {
        assert_eq!(lines("one two three", 7), ["one two", "three"]);
        assert_eq!(lines("unbroken", 3), ["unbroken"]);
    }
}
