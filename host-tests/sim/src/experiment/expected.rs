//! What a field of a document should hold, in the words of its file: by the schema of the structure that reads it.

use schemars::SchemaGenerator;
use serde_json::Value;

use super::Experiment;
use super::document::FieldError;

/// Fields of a table that are shown; what is chosen by a kind has at most as many.
const SHOWN: usize = 4;

/// An error of the reader about the type of a value, with what is wanted there as one would write it; any other error as it is.
pub(super) fn explained(error: FieldError) -> FieldError {
    let Some((given, wanted_by_reader)) = mismatch(&error.problem) else {
        return error;
    };
    let schema = SchemaGenerator::default()
        .root_schema_for::<Experiment>()
        .to_value();
    let places = places(&schema, &error.field);
    let described = places.first().and_then(|place| schema.pointer(place));
    let wanted = described.and_then(|here| words(&schema, here));
    let wanted = wanted.unwrap_or_else(|| plain(wanted_by_reader));
    let problem = format!("{given}, where {wanted} is wanted");
    FieldError::new(error.field, problem)
}

/// The message of a reader, without its own names where it is about the type of a value.
pub(super) fn plainly(message: &str) -> String {
    match mismatch(message) {
        Some((given, wanted)) => format!("{given}, where {} is wanted", plain(wanted)),
        None => message.to_owned(),
    }
}

/// What was given and what was expected, of the message of a reader about a type.
fn mismatch(problem: &str) -> Option<(String, &str)> {
    let rest = problem
        .strip_prefix("invalid type: ")
        .or_else(|| problem.strip_prefix("invalid value: "))?;
    let (given, wanted) = rest.rsplit_once(", expected ")?;
    // serde: "integer `5`", "string \"light\"", "map", "sequence", and "unit variant" of anything in place of a choice.
    let value = given.split('`').nth(1);
    let given = match (given, value) {
        (_, Some(value)) => value,
        ("map", _) => "a table",
        ("sequence", _) => "a list",
        ("unit variant", _) => "a number or the like",
        (text, _) => text.strip_prefix("string ").unwrap_or(text),
    };
    Some((given.to_owned(), wanted))
}

/// What a reader expects, without its own names.
fn plain(wanted: &str) -> String {
    let numbers = ["f32", "f64"].contains(&wanted);
    let whole = wanted.starts_with(['u', 'i']) && wanted[1..].parse::<u8>().is_ok();
    match wanted {
        _ if numbers => "a number".to_owned(),
        _ if whole => "a whole number".to_owned(),
        _ if wanted.starts_with("struct") || wanted == "a map" => "a table".to_owned(),
        "a sequence" => "a list".to_owned(),
        "a boolean" => "true or false".to_owned(),
        "a string" => "a text".to_owned(),
        other => other.to_owned(),
    }
}

/// Where in the `schema` of a document the field at `path` is: JSON pointers, one for each kind of table that has it.
pub(crate) fn places(schema: &Value, path: &str) -> Vec<String> {
    let mut places = vec![String::new()];
    for part in path.split('.') {
        let (key, index) = part
            .split_once('[')
            .map_or((part, None), |(key, index)| (key, Some(index)));
        let at_top = places == [""];
        let key = match key {
            // Another name of it.
            "reference" if at_top && schema["properties"].get(key).is_none() => "path",
            _ => key,
        };
        places = inside(schema, &places, &format!("properties/{key}"));
        if index.is_some() {
            places = inside(schema, &places, "items");
        }
    }
    let all = places.iter();
    all.flat_map(|place| alternatives(schema, place).into_iter().take(1))
        .collect()
}

/// The places `what` in the alternatives at each of `places`.
fn inside(schema: &Value, places: &[String], what: &str) -> Vec<String> {
    let all = places.iter().flat_map(|place| alternatives(schema, place));
    let all = all.map(|place| format!("{place}/{what}"));
    all.filter(|place| schema.pointer(place).is_some())
        .collect()
}

/// What may stand at `place`, references followed: itself, or what there is to choose from, but for nothing.
fn alternatives(schema: &Value, place: &str) -> Vec<String> {
    let Some(here) = schema.pointer(place) else {
        return Vec::new();
    };
    if let Some(to) = here.get("$ref").and_then(Value::as_str) {
        return alternatives(schema, to.trim_start_matches('#'));
    }
    if here["type"] == "null" {
        return Vec::new();
    }
    let mut all = vec![place.to_owned()];
    for list in ["anyOf", "oneOf"] {
        let count = here[list].as_array().map_or(0, Vec::len);
        let inner = (0..count).flat_map(|i| alternatives(schema, &format!("{place}/{list}/{i}")));
        // What is chosen from says more than that there is a choice.
        match list {
            "anyOf" if count > 0 => all = inner.collect(),
            _ => all.extend(inner),
        }
    }
    all
}

/// A value that `here` describes, in words; none if it does not say.
fn words(schema: &Value, here: &Value) -> Option<String> {
    if let Some(to) = here.get("$ref").and_then(Value::as_str) {
        return words(schema, schema.pointer(to.trim_start_matches('#'))?);
    }
    let field = |(name, of): (&String, &Value)| format!("{name} = {}", example(schema, of));
    let list = |list: &str| here[list].as_array().filter(|all| !all.is_empty());
    if let Some(kinds) = list("oneOf").or(list("anyOf")) {
        let kinds = kinds.iter().filter(|kind| kind["type"] != "null");
        let kinds = kinds.filter_map(|kind| match kind.get("const").or(kind.get("enum")) {
            Some(Value::Array(names)) => Some(
                names
                    .iter()
                    .map(Value::to_string)
                    .collect::<Vec<_>>()
                    .join(", "),
            ),
            Some(name) => Some(name.to_string()),
            None => match kind["properties"].as_object() {
                Some(fields) => fields.iter().next().map(field),
                None => words(schema, kind),
            },
        });
        return Some(kinds.collect::<Vec<_>>().join(" or "));
    }
    match here["type"].as_str()? {
        "object"
            if here["properties"]
                .as_object()
                .is_none_or(|fields| fields.is_empty()) =>
        {
            Some("a table".to_owned())
        }
        "object" => Some(format!("a table, {},", example(schema, here))),
        "array" => Some(format!("a list, {},", example(schema, here))),
        "integer" => Some("a whole number".to_owned()),
        "number" => Some("a number".to_owned()),
        "boolean" => Some("true or false".to_owned()),
        "string" => Some("a text".to_owned()),
        _ => None,
    }
}

/// How a value that `here` describes is written.
fn example(schema: &Value, here: &Value) -> String {
    if let Some(to) = here.get("$ref").and_then(Value::as_str) {
        let to = schema.pointer(to.trim_start_matches('#'));
        return to.map_or("…".to_owned(), |to| example(schema, to));
    }
    match (here["properties"].as_object(), here["minItems"].as_u64()) {
        (Some(fields), _) => {
            let names = fields.keys().take(SHOWN).map(|name| format!("{name} = …"));
            let mut names: Vec<String> = names.collect();
            if fields.len() > SHOWN {
                names.push("…".to_owned());
            }
            format!("{{ {} }}", names.join(", "))
        }
        (None, Some(count)) => format!("[{}]", vec!["…"; count as usize].join(", ")),
        _ if here["type"] == "array" => match example(schema, &here["items"]).as_str() {
            "…" => "[…]".to_owned(),
            item => format!("[{item}, …]"),
        },
        _ => "…".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::plainly;
    use crate::experiment::Document;

    #[test]
    fn readers_names_of_types_are_left_out() {
        for (message, says) in [
            (
                "invalid type: string \"fast\", expected f64",
                "\"fast\", where a number is wanted",
            ),
            (
                "invalid type: floating point `1.5`, expected u64",
                "1.5, where a whole number is wanted",
            ),
            (
                "invalid type: integer `3`, expected a sequence",
                "3, where a list is wanted",
            ),
            ("missing field `x`", "missing field `x`"),
        ] {
            assert_eq!(plainly(message), says);
        }
    }

    /// Whatever stands where a table, a list or a choice is wanted: what is wanted is written as in a file.
    #[test]
    fn what_is_wanted_is_written_as_in_a_file() {
        for (assignment, says) in [
            (
                "plant.rate_loop.lag=0.1",
                "plant.rate_loop.lag: 0.1, where a table, { time_constant_s = … }, is wanted",
            ),
            (
                "plant.rate_loop=0.1",
                "where \"ideal\" or lag = { time_constant_s = … } or inertia = { ",
            ),
            (
                "weather.turbulence=5",
                "weather.turbulence: 5, where a table, { height_m = …, wind_at_20_ft_m_s = … }, is wanted",
            ),
            (
                "weather.turbulence=light",
                "turbulence: \"light\", where a table, { height_m",
            ),
            ("weather=3", "weather: 3, where a table, { gust = …, "),
            (
                "weather.steady_m_s=3",
                "steady_m_s: 3, where a list, […, …, …], is wanted",
            ),
            (
                "plant.thrust_n=40",
                "plant.thrust_n: 40, where a list, […, …], is wanted",
            ),
            (
                "sensors.velocity_m_s=0.1",
                "where a table, { bias = …, noise = …, quantum = … }, is wanted",
            ),
            ("reference=5", "where knots = [{ "),
            (
                "reference.knots=3",
                "reference.knots: 3, where a list, [{ down_m_s = …, east_m_s = …, forward_m_s = …, t_s = … }, …], is wanted",
            ),
            (
                "path.circle=30",
                "path.circle: 30, where a table, { climb_m_s = …, radius_m = …, speed_m_s = … }, is wanted",
            ),
            ("vehicle.aerodynamics=2", "combined = { "),
            (
                "vehicle.authority=40",
                "vehicle.authority: 40, where a table, { ",
            ),
            (
                "vehicle.mass_kg=heavy",
                "vehicle.mass_kg: \"heavy\", where a number is wanted",
            ),
            (
                "substeps=1.5",
                "substeps: 1.5, where a whole number is wanted",
            ),
            ("controller=3", "controller: 3, where a table is wanted"),
            (
                "controller.guidance=2",
                "controller.guidance: 2, where a table is wanted",
            ),
            (
                "path_in_air=1",
                "path_in_air: 1, where true or false is wanted",
            ),
        ] {
            let mut document = Document::load("round-trip").unwrap();
            let done = document.assign(assignment);
            let error = done
                .and_then(|()| document.checked().map(drop))
                .unwrap_err();
            let error = format!("{error:#}");
            assert!(error.contains(says), "{assignment}: {error}\n{says}");
        }
    }
}
