//! Fields of an experiment changed on the command line.

use std::path::Path;

use alula_report::viewer::Flight;
use alula_sim::experiment::{self, Document};
use alula_sim::kind::Kind;
use alula_sim::polar;
use alula_sim::simulate::fly;
use alula_study::COMPARISONS;
use alula_study::starts::ATTITUDES;

/// Names and texts of all that is built in, by kind.
const BUILT_IN: [(Kind, &[(&str, &str)]); 5] = [
    (Kind::Experiment, experiment::BUILT_IN),
    (Kind::Campaign, alula_study::BUILT_IN),
    (Kind::Campaign, &[ATTITUDES]),
    (Kind::Comparison, COMPARISONS),
    (Kind::Polar, polar::BUILT_IN),
];

/// Refuses an argument that is no file, and the name of what is built in of other kinds than those `wanted`, which are called `words`.
pub fn expect_name(wanted: &[Kind], words: &str, argument: &str) -> anyhow::Result<()> {
    let is_file = Path::new(argument).exists();
    let of_it = BUILT_IN.iter().filter(|(_, texts)| {
        let mut names = texts.iter().map(|(name, _)| *name);
        names.any(|name| name == argument)
    });
    let kinds: Vec<Kind> = of_it.map(|(kind, _)| *kind).collect();
    match kinds.first() {
        Some(kind) if !is_file && !kinds.iter().any(|kind| wanted.contains(kind)) => {
            Err(kind.refused(words, argument))
        }
        _ => Ok(()),
    }
}

/// The same where an experiment is wanted.
pub fn expect_experiment(argument: &str) -> anyhow::Result<()> {
    expect_name(&[Kind::Experiment], "an experiment or a vehicle", argument)
}

/// The same where a vehicle of any source is.
pub fn expect_airframe(argument: &str) -> anyhow::Result<()> {
    let wanted = [Kind::Experiment, Kind::Polar];
    expect_name(&wanted, "an experiment, a vehicle or a polar", argument)
}

/// `--set`.
#[derive(clap::Args, Default)]
pub struct Settings {
    /// Change a field of the experiment, as in vehicle.mass_kg=11; may be given several times
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<String>,
}

impl Settings {
    /// Whether nothing is changed.
    pub fn is_empty(&self) -> bool {
        self.set.is_empty()
    }

    /// The document that `argument` names, with the fields changed.
    pub fn document(&self, argument: &str) -> anyhow::Result<Document> {
        expect_experiment(argument)?;
        let mut document = Document::load(argument)?;
        self.change(&mut document)?;
        Ok(document)
    }

    /// The flight of what `argument` names, with the fields changed; none of a vehicle or a polar alone, or of one that diverges.
    pub fn flight(&self, argument: &str) -> Option<Flight> {
        let document = self.document(argument).ok()?;
        let experiment = document.checked().ok()?;
        let record = fly(&experiment).ok()?;
        Some(Flight::of(&document.name, &experiment, &record))
    }

    /// Changes the fields of `document`.
    pub fn change(&self, document: &mut Document) -> anyhow::Result<()> {
        self.set
            .iter()
            .try_for_each(|assignment| document.assign(assignment))
    }
}
