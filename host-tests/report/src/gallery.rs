//! Experiments at a glance: of each its picture, what it is, and the command that flies it.

use std::fmt::Write as _;

use super::film::with_films;
use super::flight::overview;
use super::svg::{Drawn, Format, escape};
use super::viewer::address;
use alula_sim::experiment::Experiment;
use alula_sim::simulate::{Step, shown};

/// An experiment that was flown.
#[derive(Clone, Debug)]
pub struct Exhibit {
    /// Its name.
    pub name: String,
    /// What it is, in a line.
    pub description: String,
    /// The picture of its flight.
    pub picture: Drawn,
}

impl Exhibit {
    /// The flight of a record.
    pub fn of(name: &str, experiment: &Experiment, record: &[Step]) -> Self {
        let record = shown(record);
        let format = Format::Small;
        let way = overview(experiment, record, format);
        Self {
            name: name.to_owned(),
            description: experiment.description.clone(),
            picture: with_films(way, experiment, record, format),
        }
    }
}

/// The page of these.
pub fn page(exhibits: &[Exhibit]) -> String {
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Gallery</title>\n<style>\n{}{}</style>\n</head>\n<body class=\"page\">\n<main>\n<h1>Gallery</h1>\n\
         <p>The built-in experiments, flown. A picture leads to its flight in three dimensions; the command leaves that and a report with charts.</p>\n<div class=\"gallery\">\n",
        include_str!("style.css"),
        include_str!("chart.css"),
    );
    for Exhibit {
        name,
        description,
        picture,
    } in exhibits
    {
        let _ = writeln!(
            text,
            "<figure id=\"{name}\"><h2>{name}</h2><pre><code>alula-sil fly {name}</code></pre><a href=\"{}\">{}</a><figcaption>{}</figcaption></figure>",
            address(name),
            picture.svg(&format!("role=\"img\" aria-label=\"The flight {name}\"")),
            escape(description),
        );
    }
    text += "</div>\n</main>\n</body>\n</html>\n";
    text
}
