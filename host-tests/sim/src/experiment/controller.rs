//! `[controller.KIND]`: which controller, and its own table, which the kind reads itself.

use serde::{Deserialize, Deserializer, de};
use toml::{Table, Value};

/// `[controller]`: exactly one kind; the guidance if it is left out.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerSpec {
    /// The kind's name.
    pub kind: String,
    /// Its table.
    pub table: Value,
}

impl Default for ControllerSpec {
    fn default() -> Self {
        Self {
            kind: "guidance".to_owned(),
            table: Value::Table(Table::new()),
        }
    }
}

impl<'de> Deserialize<'de> for ControllerSpec {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let mut given = Table::deserialize(from)?.into_iter();
        match (given.next(), given.next()) {
            (Some((kind, table)), None) => Ok(Self { kind, table }),
            _ => Err(de::Error::custom("must be exactly one kind of controller")),
        }
    }
}

impl ControllerSpec {
    /// Where the table stands in a document.
    pub fn path(&self) -> String {
        format!("controller.{}", self.kind)
    }
}
