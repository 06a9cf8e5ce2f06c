//! Reports: a figure, and a page that holds everything and needs no network.

pub(crate) mod chart;
pub mod envelope;
pub mod equilibria;
pub(crate) mod figure;
pub mod fit;
mod margins;
mod page;
pub mod sweep;

use anyhow::Context;
use minijinja::{Environment, context};

use crate::figures::Figures;
use crate::flight::Row;
use crate::scenario::Source;

pub use figure::svg;
pub use margins::margins_svg;
pub use page::{Page, Table, columns};

/// The templates of the pages.
pub(crate) fn templates() -> anyhow::Result<Environment<'static>> {
    let mut environment = Environment::new();
    environment.add_template("style.css", include_str!("style.css"))?;
    environment.add_template("report.html", include_str!("report.html"))?;
    environment.add_template("page.html", include_str!("page.html"))?;
    Ok(environment)
}

/// The page about a flight, with its figure `svg` inside.
pub fn html(source: &Source, rows: &[Row], figures: &Figures, svg: &str) -> anyhow::Result<String> {
    let scenario = &source.scenario;
    templates()?
        .get_template("report.html")?
        .render(context! {
            name => &source.name,
            description => &scenario.description,
            duration => scenario.duration_s,
            rate => scenario.control_rate_hz,
            rows => rows.len(),
            table => figures.table(),
            toml => &source.text,
            svg,
            version => env!("CARGO_PKG_VERSION"),
        })
        .context("the report's template")
}
