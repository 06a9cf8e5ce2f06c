//! What a page shows: a picture, charts, and a strip of words under their time axes.

use super::chart::Chart;
use super::strip::Strip;
use super::svg::{Drawn, WIDE, draw};

/// A figure of several parts.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// A picture above the charts, for a sheet and for a narrow window.
    pub picture: Option<[Drawn; 2]>,
    charts: Vec<Drawn>,
    strip: Option<Drawn>,
    /// What the strip's rows are, and its colours with their classes.
    key: (String, Vec<(String, &'static str)>),
}

/// Between two parts of a sheet \[px\].
const GAP: f64 = 18.0;

impl Figure {
    /// A figure of `charts`, with plots `high` pixels high.
    pub fn new(charts: &[Chart], high: f64) -> Self {
        Self {
            charts: charts.iter().map(|chart| draw(chart, high)).collect(),
            ..Self::default()
        }
    }

    /// The same with a strip.
    pub fn with_strip(mut self, strip: &Strip) -> Self {
        if !strip.rows.is_empty() {
            self.strip = Some(strip.draw());
            self.key = (strip.names(), strip.key());
        }
        self
    }

    /// The same with a picture.
    pub fn with_picture(mut self, picture: [Drawn; 2]) -> Self {
        self.picture = Some(picture);
        self
    }

    /// What the strip's rows are, and its colours with their classes.
    pub fn key(&self) -> &(String, Vec<(String, &'static str)>) {
        &self.key
    }

    /// The parts as elements for a page, each with the class of its frame.
    pub fn parts(&self) -> Vec<(&'static str, String)> {
        let picture = self.picture.iter().flatten();
        let picture = ["picture sheet", "picture narrow"].into_iter().zip(picture);
        let picture = picture.map(|(class, drawn)| (class, drawn.svg("")));
        let charts = self.charts.iter().map(|drawn| ("one", drawn.svg("")));
        let strip = self.strip.iter().map(|drawn| ("wide", drawn.svg("")));
        picture.chain(charts).chain(strip).collect()
    }

    /// Everything on one sheet, as an SVG file: two charts a line, picture and strip over the whole width.
    pub fn svg(&self) -> String {
        let whole = 2.0 * WIDE + GAP;
        let mut body = String::new();
        let mut y = GAP;
        let mut place = |drawn: &Drawn, x: f64, y: f64, wide: f64| {
            let high = drawn.size[1] * wide / drawn.size[0];
            body += &drawn.svg(&format!(
                "x=\"{x}\" y=\"{y:.1}\" width=\"{wide}\" height=\"{high:.1}\""
            ));
            high + GAP
        };
        if let Some([picture, _]) = &self.picture {
            y += place(picture, GAP, y, whole);
        }
        for line in self.charts.chunks(2) {
            let heights = line
                .iter()
                .enumerate()
                .map(|(i, drawn)| place(drawn, GAP + i as f64 * (WIDE + GAP), y, WIDE));
            y += heights.fold(0.0, f64::max);
        }
        if let Some(strip) = &self.strip {
            y += place(strip, GAP, y, whole);
        }
        let wide = whole + 2.0 * GAP;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{wide}\" height=\"{y:.0}\" viewBox=\"0 0 {wide} {y:.0}\">\n\
             <style>\n{}</style>\n<rect width=\"{wide}\" height=\"{y:.0}\" fill=\"#fff\"/>\n{body}</svg>\n",
            include_str!("chart.css")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::chart::{BLUE, Series};
    use super::*;

    #[test]
    fn a_sheet_holds_every_part() {
        let charts = ["one", "two", "three"].map(|title| {
            Chart::over_time(
                title,
                vec![Series::line("x", BLUE, vec![(0.0, 0.0), (1.0, 1.0)])],
            )
        });
        let figure = Figure::new(&charts, 200.0);
        let sheet = figure.svg();
        for part in ["one", "two", "three"] {
            assert!(sheet.contains(&format!(">{part}<")));
        }
        assert_eq!(sheet.matches("<svg").count(), 4);
        assert_eq!(figure.parts().len(), 3);
    }
}
