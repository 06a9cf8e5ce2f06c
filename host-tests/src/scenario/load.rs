//! Reading a scenario, with errors of one line: `file:line: field: what is wrong`.

use anyhow::anyhow;
use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use super::{BUILT_IN, FieldError, Scenario};
use crate::named::Named;

/// A scenario with where it came from.
#[derive(Clone, Debug)]
pub struct Source {
    /// Built-in name, or the file's name without its extension.
    pub name: String,
    /// Its TOML text.
    pub text: String,
    /// What it says.
    pub scenario: Scenario,
}

impl Source {
    /// The scenario that `argument` names: a built-in, or else a TOML file.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        let found = Named::find("scenario", BUILT_IN, argument)?;
        Self::from_text(&found.name, &found.origin, &found.text)
    }

    /// The scenario in `text`; `origin` stands for it in errors.
    pub fn from_text(name: &str, origin: &str, text: &str) -> anyhow::Result<Self> {
        let scenario = from_toml(origin, text, Scenario::validate)?;
        Ok(Self {
            name: name.to_owned(),
            text: text.to_owned(),
            scenario,
        })
    }
}

/// What `text` says, validated; `origin` stands for it in errors of one line.
pub(crate) fn from_toml<T: DeserializeOwned>(
    origin: &str,
    text: &str,
    validate: impl Fn(&T) -> Result<(), FieldError>,
) -> anyhow::Result<T> {
    parse(text)
        .and_then(|value: T| match validate(&value) {
            Ok(()) => Ok(value),
            Err(FieldError { field, problem }) => {
                Err((line_of(text, &field), format!("{field}: {problem}")))
            }
        })
        .map_err(|(line, message)| anyhow!("{origin}:{line}: {message}"))
}

/// The value, or the line and a message with the field's name.
fn parse<T: DeserializeOwned>(text: &str) -> Result<T, (usize, String)> {
    let located = |error: &toml::de::Error, field: &str| {
        let line = error.span().map_or(1, |span| line_at(text, span.start));
        let message = error.message().lines().collect::<Vec<_>>().join(", ");
        (line, format!("{field}{message}"))
    };
    let deserializer = toml::Deserializer::parse(text).map_err(|e| located(&e, ""))?;
    serde_path_to_error::deserialize(deserializer).map_err(|e| {
        let path = e.path().to_string();
        let field = match path.trim_end_matches(['.', '?']) {
            "" => String::new(),
            field => format!("{field}: "),
        };
        located(e.inner(), &field)
    })
}

fn line_at(text: &str, offset: usize) -> usize {
    let end = offset.min(text.len());
    1 + text.as_bytes()[..end]
        .iter()
        .filter(|&&byte| byte == b'\n')
        .count()
}

/// The line of the dotted `field`, or of the nearest table around it.
fn line_of(text: &str, field: &str) -> usize {
    let Ok(document) = DeTable::parse(text) else {
        return 1;
    };
    let mut offset = 0;
    let mut table = Some(document.get_ref());
    let mut array = None;
    for part in field.split(['.', '[']) {
        let value = if let Some(index) = part.strip_suffix(']') {
            let items: Option<&toml::de::DeArray> = array;
            index.parse().ok().and_then(|i: usize| items?.get(i))
        } else {
            table.and_then(|t| t.get(part))
        };
        let Some(value) = value else { break };
        offset = value.span().start;
        table = match value.get_ref() {
            DeValue::Table(inner) => Some(inner),
            _ => None,
        };
        array = match value.get_ref() {
            DeValue::Array(inner) => Some(inner),
            _ => None,
        };
    }
    line_at(text, offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_is_valid() {
        for (name, text) in BUILT_IN {
            Source::from_text(name, name, text).unwrap();
        }
    }

    /// A valid text with one line replaced: the message names that line.
    #[test]
    fn errors_name_line_and_field() {
        let (_, good) = BUILT_IN[0];
        let line = |needle: &str| 1 + good.lines().position(|l| l.contains(needle)).unwrap();
        let broken = |needle: &str, with: &str| {
            let lines: Vec<_> = good
                .lines()
                .map(|l| if l.contains(needle) { with } else { l })
                .collect();
            Source::from_text("x", "x.toml", &lines.join("\n"))
                .unwrap_err()
                .to_string()
        };
        let expect = |needle: &str, with: &str, message: &str| {
            let expected = format!("x.toml:{}: {message}", line(needle));
            let actual = broken(needle, with);
            assert!(actual.starts_with(&expected), "{actual}\n{expected}");
            assert!(!actual.contains('\n'), "{actual}");
        };
        expect(
            "mass_kg = 9",
            "mass_kg = -9",
            "controller.vehicle.mass_kg: mass must be positive",
        );
        expect(
            "mass_kg = 10",
            "mass_kg = \"ten\"",
            "vehicle.mass_kg: invalid type: string",
        );
        expect(
            "duration_s",
            "duration_s = nan",
            "duration_s: must be a finite number",
        );
        expect("tau_n", "tau_n = 0", "controller.gains.tau_n: tau must be");
        expect(
            "tau_n",
            "tau = 80",
            "controller.gains.tau: unknown field `tau`",
        );
        expect("substeps", "substeps = 0", "substeps: must be from 1");
        expect(
            "t_s = 10",
            "    { t_s = 0, down_m_s = 0, forward_m_s = 20 },",
            "reference.knots[1]: t_s must increase",
        );
        expect(
            "law =",
            "law = \"robst\"",
            "controller.law: unknown variant",
        );
    }
}
