//! What a vehicle leaves: its files by name, and its document for who writes none.

use toml::Value;

use super::Design;
use super::document::{campaign_text, vehicle_text};
use alula_sim::experiment::Document;
use alula_sim::named::Named;

impl Design {
    /// The files of the vehicle `name`: the name of each and what is in it. The vehicle's own is the last.
    pub fn files(&self, name: &str) -> Vec<(String, String)> {
        let own = self.wing.polar.filter(|(_, own)| *own);
        let polar = own.map(|(polar, _)| ("polar.csv".to_owned(), polar.csv(&self.wing.story)));
        let [c, rust] = self.code(name);
        let others = [
            (format!("{name}-campaign.toml"), campaign_text(name, self)),
            ("vehicle.h".to_owned(), c),
            ("vehicle.rs".to_owned(), rust),
            (format!("{name}.toml"), vehicle_text(name, self)),
        ];
        polar.into_iter().chain(others).collect()
    }

    /// The document that the vehicle's file is, for who writes none: its polar stands in it.
    pub fn document(&self, name: &str) -> anyhow::Result<Document> {
        let mut document = Document::new(&Named {
            name: name.to_owned(),
            origin: format!("{name}.toml"),
            text: vehicle_text(name, self),
            file: None,
        })?;
        if let Some((polar, true)) = self.wing.polar {
            let rows = polar.written().into_iter();
            let rows: Vec<Value> = rows.map(|row| row.to_vec().into()).collect();
            document.set("vehicle.aerodynamics.table.polar", rows.into())?;
        }
        Ok(document)
    }
}
