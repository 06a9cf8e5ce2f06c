//! Which column of a CSV file is which of ours.

use crate::Error;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A column map, as a TOML file holds it:
///
/// ```toml
/// topic = "flight"                               # the table's name; "csv" unless given
/// time = { from = "t_ms", scale = 0.001 }        # must come out in seconds
/// [columns]
/// vn = { from = "Vnorth [kt]", scale = 0.514444, unit = "m/s" }
/// vd = { from = "climb", scale = -1.0, offset = 0.0, unit = "m/s" }
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Map {
    /// Name of the table.
    #[serde(default = "topic")]
    pub topic: String,
    /// The time; in seconds after scale and offset.
    pub time: Source,
    /// Our name ← their column.
    pub columns: BTreeMap<String, Source>,
}

/// One of their columns: ours = theirs × scale + offset.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// The header of their column, without surrounding blanks.
    pub from: String,
    /// Factor, 1 unless given.
    #[serde(default = "one")]
    pub scale: f64,
    /// Added after the factor, in our unit; 0 unless given.
    #[serde(default)]
    pub offset: f64,
    /// Our unit.
    #[serde(default)]
    pub unit: String,
}

fn topic() -> String {
    "csv".into()
}

fn one() -> f64 {
    1.0
}

impl Source {
    fn same(from: &str, unit: &str) -> Self {
        Self {
            from: from.into(),
            scale: 1.0,
            offset: 0.0,
            unit: unit.into(),
        }
    }

    pub(super) fn apply(&self, theirs: f64) -> f64 {
        theirs * self.scale + self.offset
    }
}

impl Map {
    /// The map in the TOML text of the file called `file` in errors.
    ///
    /// # Errors
    /// It is not TOML, a key is unknown or missing, it names no columns, a factor is zero or not finite.
    pub fn parse(file: &str, text: &str) -> Result<Self, Error> {
        let fail = |line, problem| Error::Map {
            file: file.into(),
            line,
            problem,
        };
        let map: Self = toml::from_str(text).map_err(|error| {
            let before = error.span().and_then(|span| text.get(..span.start));
            let line = before.map(|before| 1 + before.matches('\n').count());
            let words: Vec<&str> = error.message().lines().collect();
            fail(line, words.join(", "))
        })?;
        map.check().map_err(|problem| fail(None, problem))?;
        Ok(map)
    }

    /// What is wrong with the map, if anything.
    pub(super) fn check(&self) -> Result<(), String> {
        if self.columns.is_empty() {
            return Err("the map names no columns".into());
        }
        let named = self
            .columns
            .iter()
            .map(|(name, source)| (name.as_str(), source));
        for (name, source) in named.chain([("time", &self.time)]) {
            if !source.scale.is_finite() || source.scale == 0.0 {
                return Err(format!("`{name}`: scale is {}", source.scale));
            }
            if !source.offset.is_finite() {
                return Err(format!("`{name}`: offset is {}", source.offset));
            }
        }
        Ok(())
    }
}

/// The time and the other columns where no map is given: each under its own name, in the file's order, the unit taken
/// from `name [unit]` unless two columns would then share a name.
pub(super) fn identity(headers: &[String]) -> (Source, Vec<(String, Source)>) {
    let split = |header: &str| match header.strip_suffix(']').and_then(|h| h.rsplit_once(" [")) {
        Some((name, unit)) => (name.to_owned(), unit.to_owned()),
        None => (header.to_owned(), String::new()),
    };
    let names: Vec<_> = headers.iter().map(|header| split(header)).collect();
    let shared = crate::fields::twice(names.iter().map(|(name, _)| name.as_str())).is_some();
    let column = |(header, (name, unit)): (&String, &(String, String))| {
        let name = if shared { header } else { name };
        (name.clone(), Source::same(header, unit))
    };
    let columns = std::iter::zip(headers, &names)
        .skip(1)
        .map(column)
        .collect();
    let first = headers.first().map_or("", String::as_str);
    let time = Source {
        scale: seconds(first),
        ..Source::same(first, "s")
    };
    (time, columns)
}

/// What one unit of the time under this header is in seconds, by a unit in brackets or at the end of its name.
fn seconds(header: &str) -> f64 {
    let lower = header.to_lowercase();
    let unit = lower
        .trim_end_matches([']', ')'])
        .rsplit(['[', '(', '_', ' '])
        .next();
    match unit {
        Some("ms") => 1e-3,
        Some("us" | "µs" | "μs") => 1e-6,
        Some("ns") => 1e-9,
        Some("min") => 60.0,
        Some("h") => 3600.0,
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_in_a_map_are_named() {
        let refusal = |text: &str| Map::parse("m.toml", text).unwrap_err().to_string();
        assert!(refusal("time = { from = 't' }").contains("missing field `columns`"));
        let unknown = refusal("\ntime = { form = 't' }\ncolumns = {}");
        assert!(
            unknown.starts_with("m.toml: line 2: unknown field `form`, expected one of"),
            "{unknown}"
        );
        // Where TOML's own words are of two lines.
        assert_eq!(refusal("time = 'a\n'").lines().count(), 1);
        assert_eq!(
            refusal("time = { from = 't' }\n[columns]"),
            "m.toml: the map names no columns"
        );
        let zero = refusal("time = { from = 't' }\n[columns]\nx = { from = 'x', scale = 0.0 }");
        assert_eq!(zero, "m.toml: `x`: scale is 0");
    }

    #[test]
    fn units_are_taken_from_the_header_unless_names_would_clash() {
        let names = |headers: &[&str]| -> Vec<String> {
            let headers: Vec<String> = headers.iter().map(|h| (*h).into()).collect();
            identity(&headers)
                .1
                .into_iter()
                .map(|(name, _)| name)
                .collect()
        };
        assert_eq!(names(&["time [s]", "b [m]", "a[0] [m]"]), ["b", "a[0]"]);
        assert_eq!(names(&["t", "h [m]", "h [ft]"]), ["h [m]", "h [ft]"]);
    }

    #[test]
    fn the_unit_of_time_is_taken_from_the_header() {
        for (header, unit) in [
            ("time [s]", 1.0),
            ("time [ms]", 1e-3),
            ("t (us)", 1e-6),
            ("Time [µs]", 1e-6),
            ("timestamp_us", 1e-6),
            ("t_ns", 1e-9),
            ("time [min]", 60.0),
            ("time [h]", 3600.0),
            ("t", 1.0),
            ("items", 1.0),
            ("us", 1e-6),
        ] {
            assert_eq!(identity(&[header.into()]).0.scale, unit, "{header}");
        }
    }
}
