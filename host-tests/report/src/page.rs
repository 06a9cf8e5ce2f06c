//! A page about an analysis: a figure and tables, which also print as text.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Context;
use minijinja::{Environment, Value, context};

use super::Figure;
use alula_study::files::leave_all;

/// What every page and its sheet are called, in a folder of their own.
pub const PAGE: &str = "report.html";
/// As [`PAGE`].
pub const SHEET: &str = "report.svg";

/// A table of cells.
#[derive(Clone, Debug)]
pub struct Table {
    /// What it is about.
    pub title: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// Rows of as many cells.
    pub rows: Vec<Vec<String>>,
}

/// Cells from which on a table of more than three columns is closed at first where it would be listed cell by cell.
const LONG: usize = 30;

/// Names of columns.
pub fn columns<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).to_vec()
}

/// A column of a table about `T`: its name, and the cell in a row.
pub type Cells<'a, T> = (&'a str, &'a dyn Fn(&T) -> String);

/// A number with this many digits after the point.
pub fn fixed(value: impl Into<f64>, digits: usize) -> String {
    alula_sim::figures::fixed(value.into(), digits)
}

impl Table {
    /// A table with these `columns` and `rows`.
    pub fn new<const N: usize>(
        title: impl Into<String>,
        columns: [&str; N],
        rows: impl IntoIterator<Item = [String; N]>,
    ) -> Self {
        Self {
            title: title.into(),
            header: columns.map(str::to_owned).to_vec(),
            rows: rows.into_iter().map(Vec::from).collect(),
        }
    }

    /// A table with one row about each of `all`.
    pub fn of<'a, T: 'a>(
        title: impl Into<String>,
        all: impl IntoIterator<Item = &'a T>,
        columns: &[Cells<T>],
    ) -> Self {
        let row = |one: &T| columns.iter().map(|(_, cell)| cell(one)).collect();
        Self {
            title: title.into(),
            header: columns.iter().map(|(name, _)| (*name).to_owned()).collect(),
            rows: all.into_iter().map(row).collect(),
        }
    }

    /// Whether column `i` holds numbers alone.
    fn is_numeric(&self, i: usize) -> bool {
        let number = |cell: &str| cell.parse::<f64>().is_ok() || matches!(cell, "∞" | "–");
        self.rows.iter().all(|row| number(&row[i]))
    }

    fn value(&self) -> Value {
        let numeric = |i| self.is_numeric(i);
        context! {
            title => &self.title,
            header => self.header.clone(),
            rows => self.rows.clone(),
            // Its rows have names, and its columns need none.
            named => self.header.first().is_some_and(String::is_empty),
            // A row of so few cells is a line, under the names of the columns.
            few => self.header.len() <= 3,
            long => self.header.len() > 3 && self.header.len() * self.rows.len() > LONG,
            numeric => (0..self.header.len()).map(numeric).collect::<Vec<_>>(),
        }
    }
}

/// The templates of the pages.
fn templates() -> anyhow::Result<Environment<'static>> {
    let mut environment = Environment::new();
    environment.add_template("style.css", include_str!("style.css"))?;
    environment.add_template("chart.css", include_str!("chart.css"))?;
    environment.add_template("page.js", include_str!("page.js"))?;
    environment.add_template("uPlot.min.css", include_str!("uplot/uPlot.min.css"))?;
    environment.add_template("uPlot.min.js", include_str!("uplot/uPlot.iife.min.js"))?;
    environment.add_template("uPlot-LICENSE", include_str!("uplot/LICENSE"))?;
    environment.add_template("page.html", include_str!("page.html"))?;
    Ok(environment)
}

/// A page.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// One sentence under it.
    pub lead: String,
    /// What is out of the ordinary, in red under the lead.
    pub warnings: Vec<String>,
    /// What is worth knowing at once, and no cause for alarm.
    pub remarks: Vec<String>,
    /// Other pages, by their address from here, and what they are.
    pub links: Vec<(String, String)>,
    /// Picture and charts.
    pub figure: Figure,
    /// The tables.
    pub tables: Vec<Table>,
    /// A text under a heading, to be unfolded.
    pub text: Option<(String, String)>,
    /// What the reader should know of the figures.
    pub notes: String,
}

impl Page {
    /// The page as HTML.
    pub fn html(&self) -> anyhow::Result<String> {
        templates()?
            .get_template("page.html")?
            .render(context! {
                title => &self.title,
                lead => &self.lead,
                warnings => &self.warnings,
                remarks => &self.remarks,
                links => self.links.clone(),
                rows => &self.figure.key().0,
                key => self.figure.key().1.clone(),
                parts => self.figure.parts(),
                tables => self.tables.iter().map(Table::value).collect::<Vec<_>>(),
                text => self.text.as_ref().map(|(title, body)| context! { title, body }),
                notes => &self.notes,
                version => env!("CARGO_PKG_VERSION"),
            })
            .context("the page's template")
    }

    /// Leaves the figure and the page in `folder`.
    pub fn leave(&self, folder: &Path) -> anyhow::Result<()> {
        for (name, content) in [(SHEET, self.figure.svg()), (PAGE, self.html()?)] {
            leave_all(&folder.join(name), content)?;
        }
        Ok(())
    }

    /// Title, lead and tables as text for a terminal.
    pub fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.title, self.lead);
        for line in self.warnings.iter().chain(&self.remarks) {
            let _ = writeln!(text, "{line}");
        }
        for table in &self.tables {
            let _ = writeln!(text, "\n{}", table.title);
            let cell = |row: &[String], i: usize| row[i].chars().count();
            let widths: Vec<usize> = (0..table.header.len())
                .map(|i| {
                    let cells = table.rows.iter().map(|row| cell(row, i));
                    cells.fold(table.header[i].chars().count(), usize::max)
                })
                .collect();
            for row in std::iter::once(&table.header).chain(&table.rows) {
                let cells = row.iter().zip(&widths).enumerate();
                let line: String = cells
                    .map(|(i, (cell, &width))| match table.is_numeric(i) {
                        true => format!("  {cell:>width$}"),
                        false => format!("  {cell:<width$}"),
                    })
                    .collect();
                let _ = writeln!(text, "{}", line.trim_end());
            }
        }
        text
    }
}
