//! The JSON Schema of experiment files, by which an editor completes and checks them.
//!
//! Fields and meanings are those of the structures that read the files, parameters those of the core's table. A file may be based on another: nothing
//! must be there but what an item of a list, or a kind that is chosen, has to have.

use std::collections::{BTreeMap, BTreeSet};

use alula::mission::MissionParameters;
use alula::planar::GainParameters;
use alula::{GuidanceParameters, Parameters, ResponseParameters, Tuning};
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value, json};

use crate::controllers::PlanSpec;
use crate::experiment::{
    BUILT_IN, Document, Experiment, MissionSpec, PlantSpec, SensorSpec, TailSitterPlant,
    TailSitterSpec, VehicleSpec, file_name, file_value, places, value_at,
};
use crate::figures::FIGURES;

/// The schema of an experiment's file.
pub fn schema() -> Value {
    let mut generator = SchemaGenerator::default();
    let root = generator.root_schema_for::<Experiment>();
    let mut root = root.to_value();
    // What the structures do not say: what stands in a file, and is gone where they are read.
    let mut others = SchemaGenerator::default();
    let plant = json!({ "anyOf": [table::<PlantSpec>(&mut others), table::<TailSitterPlant>(&mut others)] });
    let sensors = name_or(
        table::<SensorSpec>(&mut others),
        "Built-in sensors, or a file",
    );
    let path = root["properties"]["path"].clone();
    let properties = [
        (
            "base",
            json!({ "type": "string", "description": "A built-in experiment, or a file beside this one, that this is put over" }),
        ),
        (
            "set",
            json!({ "type": "object", "description": "Fields changed by dotted path, last of all" }),
        ),
        ("reference", path),
        ("plant", plant),
        ("sensors", sensors),
        ("controller", controller(&mut others)),
        ("bounds", bounds()),
    ];
    for (name, schema) in properties {
        root["properties"][name] = schema;
    }
    for (name, schema) in others.take_definitions(true) {
        root["$defs"][name] = schema;
    }
    for (name, kind) in [
        (PlantSpec::schema_name(), "ideal"),
        (TailSitterPlant::schema_name(), "tail-sitter"),
    ] {
        root["$defs"][&*name]["properties"]["kind"] = json!({ "const": kind });
    }
    let vehicle = json!({ "$ref": format!("#/$defs/{}", TailSitterSpec::schema_name()) });
    root["$defs"][&*TailSitterPlant::schema_name()]["properties"]["vehicle"] =
        name_or(vehicle, "A built-in tail-sitter, or a file");
    let mission = &mut root["$defs"][&*MissionSpec::schema_name()];
    mission["additionalProperties"] = json!(false);
    mission["properties"]["responses"] = responses();
    for (name, schema) in rows::<MissionParameters>() {
        mission["properties"][name] = schema;
    }
    let items = listed(&root);
    let mut definitions = root["$defs"].take();
    for (name, definition) in definitions.as_object_mut().into_iter().flatten() {
        if !items.contains(name) {
            complete(definition);
        }
    }
    root["$defs"] = definitions;
    complete(&mut root);
    bounded(&mut root);
    root["title"] = json!("An experiment of alula-sil");
    root
}

/// The schema of a table, as a reference to its definition.
fn table<T: JsonSchema>(generator: &mut SchemaGenerator) -> Value {
    generator.subschema_for::<T>().to_value()
}

/// A name, or the table that it stands for.
fn name_or(table: Value, description: &str) -> Value {
    json!({ "anyOf": [{ "type": "string", "description": description }, table] })
}

/// The parameters of a table in the core, by their names in files.
fn rows<P: Parameters>() -> Map<String, Value> {
    let rows = P::ROWS.iter().map(|row| {
        let mut schema = json!({ "type": "number", "description": row.meaning, "minimum": file_value(row, row.min), "maximum": file_value(row, row.max) });
        if !row.default.is_nan() {
            schema["default"] = json!(file_value(row, row.default));
        }
        (file_name(row), schema)
    });
    rows.collect()
}

/// A table of nothing but these properties.
fn closed(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "properties": properties, "additionalProperties": false })
}

/// `[controller]`.
fn controller(generator: &mut SchemaGenerator) -> Value {
    let vehicle = name_or(
        table::<VehicleSpec>(generator),
        "An experiment or vehicle, whose vehicle is believed in",
    );
    let mut guidance = rows::<GuidanceParameters>();
    guidance.insert("vehicle".into(), vehicle.clone());
    guidance.insert(
        "thrust_n".into(),
        <[f64; 2]>::json_schema(generator).to_value(),
    );
    guidance.insert("gains".into(), closed(rows::<GainParameters>()));
    guidance.insert("for_vehicle".into(), closed(rows::<ResponseParameters>()));
    guidance.insert("tuning".into(), closed(rows::<Tuning>()));
    guidance.insert("plans".into(), table::<PlanSpec>(generator));
    let law = json!({
        "form": { "enum": ["robust", "full"] },
        "feed_forward": { "type": "boolean" },
        "vehicle": vehicle,
        "gains": closed(rows::<GainParameters>()),
        "bandwidth": closed(rows::<GuidanceParameters>()),
    });
    let law = law.as_object().cloned().unwrap_or_default();
    json!({
        "type": "object",
        "description": "Who closes the loop: the guidance, or one of the paper's laws",
        "properties": { "guidance": closed(guidance), "law": closed(law) },
        "additionalProperties": false,
        "maxProperties": 1,
    })
}

/// `mission.responses`.
fn responses() -> Value {
    let response = json!({ "enum": ["continue", "loiter", "return", "land"] });
    let failures = ["link", "air", "position", "battery", "follow"];
    let properties = failures.map(|name| (name.to_owned(), response.clone()));
    json!({
        "type": "object",
        "description": "What is done when something fails",
        "properties": Map::from_iter(properties),
        "additionalProperties": false,
    })
}

/// `[bounds]`.
fn bounds() -> Value {
    let figures = FIGURES.iter().map(|figure| {
        (
            figure.name.to_owned(),
            json!({ "type": "number", "description": figure.meaning }),
        )
    });
    json!({
        "type": "object",
        "description": "Greatest values of figures, by name",
        "properties": Map::from_iter(figures),
        "additionalProperties": false,
    })
}

/// Puts down which numbers must not be negative, or must be positive, and what they must not be beyond: what the reader refuses in a built-in experiment. Of the
/// numbers of a list each must be so.
fn bounded(schema: &mut Value) {
    let mut seen = BTreeSet::new();
    // Limits by place, as the first experiment has them; none where another one has another limit: that follows from other fields.
    let mut limits: BTreeMap<(String, Side), Option<f64>> = BTreeMap::new();
    for (name, _) in BUILT_IN {
        let document = Document::load(name).expect("built in");
        // A vehicle alone is read as part of others.
        if document.experiment().is_err() {
            continue;
        }
        let written: toml::Value = document.text().parse::<toml::Table>().expect("TOML").into();
        let mut paths: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for path in numbers(&written, "") {
            let here = places(schema, &path);
            for place in here {
                paths.entry(place).or_default().push(path.clone());
            }
        }
        for (place, paths) in paths {
            let Some(Value::Object(field)) = schema.pointer_mut(&place) else {
                continue;
            };
            let whole = field.get("type") == Some(&json!("integer"));
            let refuses = |value: f64| {
                let value = match whole {
                    true => toml::Value::from(value as i64),
                    false => value.into(),
                };
                paths
                    .iter()
                    .all(|path| refuses(&document, path, value.clone()))
            };
            for side in [Side::Least, Side::Most] {
                let limit = limits.entry((place.clone(), side)).or_insert_with(|| {
                    let value = written_at(&written, &paths[0]);
                    value.and_then(|value| side.limit(value, whole, refuses))
                });
                *limit = limit.filter(|limit| side.is_limit(*limit, whole, refuses));
            }
            if !seen.insert(place) {
                continue;
            }
            let bound = match (field.contains_key("minimum"), refuses(-1.0)) {
                (false, true) if refuses(0.0) => Some("exclusiveMinimum"),
                (false, true) => Some("minimum"),
                _ => None,
            };
            field.extend(bound.map(|bound| (bound.to_owned(), json!(0))));
        }
    }
    // A range of one number is none: that number is one of a few.
    let single = |place: &String| {
        let of = |side| limits.get(&(place.clone(), side)).copied().flatten();
        of(Side::Least).is_some_and(|least| of(Side::Most) == Some(least))
    };
    for ((place, side), limit) in limits.iter().filter(|((place, _), _)| !single(place)) {
        if let (Some(limit), Some(Value::Object(field))) = (limit, schema.pointer_mut(place)) {
            let [bound, exclusive] = side.bounds();
            let known = [bound, exclusive].map(|bound| field.get(bound).and_then(Value::as_f64));
            if known
                .iter()
                .flatten()
                .all(|known| side.is_beyond(*known, *limit))
            {
                field.remove(exclusive);
                field.insert(bound.to_owned(), json!(limit));
            }
        }
    }
}

/// An end of a range.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Side {
    Least,
    Most,
}

/// What no limit is beyond.
const FARTHEST: f64 = 1e9;
/// Limits are so round.
const ROUND: f64 = 1e-3;

impl Side {
    /// The words of a schema for it.
    fn bounds(self) -> [&'static str; 2] {
        match self {
            Self::Least => ["minimum", "exclusiveMinimum"],
            Self::Most => ["maximum", "exclusiveMaximum"],
        }
    }

    /// Whether `value` is farther out than `limit`.
    fn is_beyond(self, value: f64, limit: f64) -> bool {
        match self {
            Self::Least => value < limit,
            Self::Most => value > limit,
        }
    }

    /// A little farther out than `value`.
    fn beyond(self, value: f64, whole: bool) -> f64 {
        let step = if whole {
            1.0
        } else {
            1e-6 * value.abs().max(ROUND)
        };
        match self {
            Self::Least => value - step,
            Self::Most => value + step,
        }
    }

    /// Whether the reader takes `limit`, and nothing beyond it.
    fn is_limit(self, limit: f64, whole: bool, refuses: impl Fn(f64) -> bool) -> bool {
        !refuses(limit) && refuses(self.beyond(limit, whole))
    }

    /// The last round number that the reader takes from `value` on, if it takes no other one behind.
    fn limit(self, value: f64, whole: bool, refuses: impl Fn(f64) -> bool) -> Option<f64> {
        let step = if whole { 1.0 } else { ROUND };
        let number = |steps: i64| steps as f64 * step;
        let end = match self {
            Self::Least => -FARTHEST,
            Self::Most => FARTHEST,
        };
        let (mut taken, mut refused) = ((value / step).round() as i64, (end / step) as i64);
        if refuses(number(taken)) || !refuses(number(refused)) {
            return None;
        }
        while (refused - taken).abs() > 1 {
            let middle = taken + (refused - taken) / 2;
            if refuses(number(middle)) {
                refused = middle;
            } else {
                taken = middle;
            }
        }
        let limit = rounded(number(taken));
        self.is_limit(limit, whole, refuses).then_some(limit)
    }
}

/// A number in six digits: limits are round, and the core's are in single precision.
fn rounded(x: f64) -> f64 {
    let digits = format!("{x:.5e}");
    digits.parse().expect("a number")
}

/// The number at `path`.
fn written_at(document: &toml::Value, path: &str) -> Option<f64> {
    let value = value_at(document, path)?;
    value
        .as_float()
        .or_else(|| Some(value.as_integer()? as f64))
}

/// Whether the reader refuses `value` at `path` of the document.
fn refuses(document: &Document, path: &str, value: toml::Value) -> bool {
    let whole = |path: &str| {
        path.trim_end_matches(|c| "[0123456789]".contains(c))
            .to_owned()
    };
    let mut changed = document.clone();
    let done = changed.set(path, value);
    let read = done.and_then(|()| changed.experiment().map(drop));
    read.is_err_and(|error| whole(&error.field) == whole(path))
}

/// The paths of all numbers in `value`, which is at `path`.
fn numbers(value: &toml::Value, path: &str) -> Vec<String> {
    let dot = if path.is_empty() { "" } else { "." };
    match value {
        toml::Value::Integer(_) | toml::Value::Float(_) => vec![path.to_owned()],
        toml::Value::Table(table) => table
            .iter()
            .flat_map(|(key, inner)| numbers(inner, &format!("{path}{dot}{key}")))
            .collect(),
        toml::Value::Array(all) => (0..)
            .zip(all)
            .flat_map(|(i, inner)| numbers(inner, &format!("{path}[{i}]")))
            .collect(),
        _ => Vec::new(),
    }
}

/// The definitions that items of lists are of.
fn listed(schema: &Value) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    match schema {
        Value::Object(fields) => {
            let item = fields.get("items").and_then(|items| items.get("$ref"));
            let name = item
                .and_then(Value::as_str)
                .and_then(|path| path.strip_prefix("#/$defs/"));
            names.extend(name.map(str::to_owned));
            names.extend(fields.values().flat_map(listed));
        }
        Value::Array(all) => names.extend(all.iter().flat_map(listed)),
        _ => {}
    }
    names
}

/// Takes out that a field must be there, but where that tells which kind is chosen.
fn complete(schema: &mut Value) {
    let Value::Object(fields) = schema else {
        return;
    };
    fields.remove("required");
    for list in ["anyOf", "allOf"] {
        fields
            .get_mut(list)
            .and_then(Value::as_array_mut)
            .into_iter()
            .flatten()
            .for_each(complete);
    }
    for kind in fields
        .get_mut("oneOf")
        .and_then(Value::as_array_mut)
        .into_iter()
        .flatten()
    {
        let inner = kind.get_mut("properties").and_then(Value::as_object_mut);
        inner
            .into_iter()
            .flat_map(Map::values_mut)
            .for_each(complete);
    }
    let inner = fields.get_mut("properties").and_then(Value::as_object_mut);
    inner
        .into_iter()
        .flat_map(Map::values_mut)
        .for_each(complete);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An editor marks what the reader refuses, and nothing else.
    #[test]
    fn what_the_reader_refuses_is_out_of_range() {
        let schema = schema();
        // Alike in every kind of table that has the field.
        let least = |path: &str| {
            let mut bounds = places(&schema, path).into_iter().map(|place| {
                let field = schema.pointer(&place).unwrap();
                ["exclusiveMinimum", "minimum"]
                    .map(|bound| field.get(bound).and_then(Value::as_f64))
            });
            let first = bounds.next().expect(path);
            assert!(bounds.all(|other| other == first), "{path}");
            first
        };
        for path in [
            "duration_s",
            "vehicle.mass_kg",
            "vehicle.k_a_kg_m",
            "plant.rate_loop.lag.time_constant_s",
            "path.circle.radius_m",
            "path.circle.speed_m_s",
            "plant.vehicle.inertia_kg_m2[0]",
        ] {
            let least = least(path);
            let positive = least[0] == Some(0.0) || least[1].is_some_and(|least| least > 0.0);
            assert!(positive, "{path}: {least:?}");
        }
        for path in [
            "plant.thrust_lag_s",
            "plant.delay_s",
            "sensors.velocity_m_s.noise",
            "settle_time_s",
            "weather.turbulence.wind_at_20_ft_m_s",
        ] {
            assert_eq!(least(path), [None, Some(0.0)], "{path}");
        }
        let most = |path: &str| {
            let place = places(&schema, path).into_iter().next().expect(path);
            let field = schema.pointer(&place).unwrap();
            ["minimum", "maximum"].map(|bound| field.get(bound).and_then(Value::as_f64))
        };
        for (path, limits) in [
            ("plant.thrust_lag_s", [Some(0.0), Some(2.0)]),
            ("substeps", [Some(1.0), Some(1000.0)]),
            ("weather.steady_m_s[0]", [Some(-340.0), Some(340.0)]),
            ("weather.turbulence.height_m", [Some(3.0), Some(305.0)]),
            ("path.waypoints[0].speed_m_s", [Some(0.0), Some(200.0)]),
            ("vehicle.mass_kg", [Some(0.001), Some(1e6)]),
            // These follow from other fields.
            ("settle_time_s", [Some(0.0), None]),
            ("duration_s", [None, None]),
            // It is 1 or -1.
            ("plant.vehicle.propellers[0].turns", [None, None]),
        ] {
            assert_eq!(most(path), limits, "{path}");
        }
        for path in [
            "initial.theta_deg",
            "vehicle.delta_deg",
            "path.knots[0].down_m_s",
        ] {
            // It may be negative.
            let least = least(path);
            assert!(
                least.iter().flatten().all(|least| *least < 0.0),
                "{path}: {least:?}"
            );
        }
    }
}
