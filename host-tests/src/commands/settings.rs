//! Fields of an experiment changed on the command line.

use alula_sim::experiment::Document;

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
