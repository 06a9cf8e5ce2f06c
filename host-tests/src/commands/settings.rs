//! Fields of an experiment changed on the command line.

use std::path::Path;

use alula_sim::experiment::{self, Document};
use alula_sim::kind::Kind;

/// Name and TOML text of what is built in of one kind.
pub type BuiltIn<'a> = &'a [(&'a str, &'a str)];

/// The text that `argument` names in `built_in`, where it is no file.
pub fn named<'a>(built_in: BuiltIn<'a>, argument: &str) -> Option<&'a str> {
    let named = built_in.iter().find(|(name, _)| *name == argument);
    named
        .map(|(_, text)| *text)
        .filter(|_| !Path::new(argument).exists())
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
        let own = named(experiment::BUILT_IN, argument);
        if let (None, Some(text)) = (own, named(alula_study::BUILT_IN, argument)) {
            Kind::Experiment.expect(argument, text.as_bytes())?;
        }
        let mut document = Document::load(argument)?;
        self.change(&mut document)?;
        Ok(document)
    }

    /// Changes the fields of `document`.
    pub fn change(&self, document: &mut Document) -> anyhow::Result<()> {
        self.set
            .iter()
            .try_for_each(|assignment| document.assign(assignment))
    }
}
