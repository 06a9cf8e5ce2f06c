//! An experiment as a TOML document: a text over its base, with fields changed by dotted path.
//!
//! `base = "NAME or FILE"` takes over another document, which may have a base of its own; a file is looked for beside the text that
//! names it. The text's own tables are put over the base's, key by key. Where a table chooses one of several kinds ([`CHOICES`]), another
//! kind replaces the base's. `[set]` then changes single fields by dotted path.

use std::borrow::Cow;
use std::path::Path;

use anyhow::{Context, anyhow, bail, ensure};
use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

use super::expected::{explained, plainly};
use super::sensors::SENSORS;
use super::tail_sitter::{VEHICLE, VEHICLES};
use super::{BUILT_IN, ControllerSpec, VehicleSpec};
use crate::kind::Kind;
use crate::named::{Named, hint, on_one_line};
use crate::polar::{foreign, holds_polar};

/// Most tables that a dotted path goes through: as many as TOML's reader lets a text nest.
const DEEPEST: usize = 80;
/// Tables of which exactly one entry is given.
const CHOICES: [&str; 5] = [
    "controller",
    "aerodynamics",
    "rate_loop",
    "path",
    "reference",
];
/// A table that a name stands for.
struct NamedTable {
    /// Where it is.
    path: &'static str,
    /// What it is.
    noun: &'static str,
    /// Those that are built in: name and text.
    built_in: &'static [(&'static str, &'static str)],
}
const NAMED_TABLES: [NamedTable; 2] = [
    NamedTable {
        path: VEHICLE,
        noun: "vehicle of the plant",
        built_in: VEHICLES,
    },
    NamedTable {
        path: "sensors",
        noun: "sensors",
        built_in: SENSORS,
    },
];
/// Two names of the table of what is to be flown: a text may have either, whatever its base has.
const NAMES_OF_PATH: [&str; 2] = ["path", "reference"];
/// The table that may stand in its place.
const MISSION: &str = "mission";

/// A value that was refused: the field's dotted path, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldError {
    /// Dotted path in the document.
    pub field: String,
    /// What is wrong.
    pub problem: String,
}

impl FieldError {
    /// `problem` is wrong with `field`.
    pub fn new(field: impl Into<String>, problem: impl Into<String>) -> Self {
        Self {
            field: field.into(),
            problem: problem.into(),
        }
    }

    /// The error of a field in the table `table`.
    pub fn inside(self, table: &str) -> Self {
        let dot = if self.field.is_empty() { "" } else { "." };
        Self::new(format!("{table}{dot}{}", self.field), self.problem)
    }
}

impl std::fmt::Display for FieldError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (field, problem) = (on_one_line(&self.field), on_one_line(&self.problem));
        write!(f, "{field}: {problem}")
    }
}

impl std::error::Error for FieldError {}

/// A refusal with the text that it is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Located {
    /// `file:line`, or what stands for the text.
    pub place: String,
    /// Field and problem.
    pub error: FieldError,
}

impl std::fmt::Display for Located {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { place, error } = self;
        match error.field.is_empty() {
            // What is wrong is no field, but the text itself.
            true => write!(f, "{place}: {}", on_one_line(&error.problem)),
            false => write!(f, "{place}: {error}"),
        }
    }
}

impl std::error::Error for Located {}

/// What `holds` must hold, or `problem` is wrong with `field`.
pub fn require(
    holds: bool,
    field: impl Into<String>,
    problem: impl std::fmt::Display,
) -> Result<(), FieldError> {
    match holds {
        true => Ok(()),
        false => Err(FieldError::new(field, problem.to_string())),
    }
}

/// `value` must be finite.
pub fn finite(field: &str, value: f64) -> Result<(), FieldError> {
    require(value.is_finite(), field, "must be a finite number")
}

/// `value` must be finite and greater than 0.
pub(crate) fn positive(field: &str, value: f64) -> Result<(), FieldError> {
    finite(field, value)?;
    require(value > 0.0, field, "must be positive")
}

/// `value` must be at most `most`, which is so many of what `what` says, either way.
fn within(field: &str, value: f64, most: f64, what: &str) -> Result<(), FieldError> {
    finite(field, value)?;
    let problem = format_args!("must be at most {most}{what}, either way");
    require(value.abs() <= most, field, problem)
}

/// `value` must be a component of a velocity that the models can fly: of a reference, a start or a wind. They know of no speed of sound.
pub(crate) fn speed(field: &str, value: f64) -> Result<(), FieldError> {
    within(field, value, 340.0, " m/s, the speed of sound")
}

/// `value` must be an angle of at most ten turns: beyond them it is of another unit, or a slip.
pub fn angle(field: &str, value: f64) -> Result<(), FieldError> {
    within(field, value, 3600.0, "°, ten turns")
}

/// `value` must be a rate of rotation that a vehicle may have.
pub(crate) fn rate(field: &str, value: f64) -> Result<(), FieldError> {
    within(field, value, 100.0, " rad/s")
}

/// `value` must be an error that a sensor may have, in the unit of the quantity.
pub(crate) fn sensor_error(field: &str, value: f64) -> Result<(), FieldError> {
    within(field, value, 1e4, "")
}

/// One of the texts that a document is made of.
#[derive(Clone, Debug)]
struct Layer {
    /// What stands for it in errors.
    origin: String,
    text: String,
    /// Whether errors name a line of it.
    lines: bool,
    /// Path of the table that the text is; empty for a whole document.
    inside: &'static str,
}

/// A document with the texts that it is made of.
#[derive(Clone, Debug)]
pub struct Document {
    /// Built-in name, or the file's name without its extension.
    pub name: String,
    root: Value,
    /// What the texts say, if something was changed since.
    texts: Option<Value>,
    /// The document's own text, its base's, and so on.
    layers: Vec<Layer>,
}

/// Where a document comes from is not what it says.
impl PartialEq for Document {
    fn eq(&self, other: &Self) -> bool {
        self.root == other.root
    }
}

/// The other name of the table of what is to be flown, if `key` is one of them.
fn other_name(key: &str) -> Option<&'static str> {
    let [path, reference] = NAMES_OF_PATH;
    match key {
        _ if key == path => Some(reference),
        _ if key == reference => Some(path),
        _ => None,
    }
}

/// The first key of a dotted path, and the rest.
fn begun(path: &str) -> (&str, &str) {
    path.split_at(path.find(['.', '[']).unwrap_or(path.len()))
}

/// A dotted path into the table of what is to be flown, by the other name.
fn renamed(path: &str) -> Option<String> {
    let (key, rest) = begun(path);
    Some(format!("{}{rest}", other_name(key)?))
}

/// The value at `path` in a table.
pub(crate) fn value_at<'a>(table: &'a Value, path: &str) -> Option<&'a Value> {
    parts(path).try_fold(table, |value, (key, index)| {
        let value = value.get(key)?;
        match index {
            Some(index) => value.get(index.parse::<usize>().ok()?),
            None => Some(value),
        }
    })
}

/// The parts of a dotted path: each a key, and perhaps the index of an item.
fn parts(path: &str) -> impl Iterator<Item = (&str, Option<&str>)> {
    path.split('.').map(|part| match part.split_once('[') {
        Some((key, rest)) => (key, Some(rest.trim_end_matches(']'))),
        None => (part, None),
    })
}

impl Document {
    /// The document that `argument` names: a built-in, or else a TOML file.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        Self::new(&Named::find("experiment", BUILT_IN, argument)?)
    }

    /// The document that the text `of` names: a file beside its own, or else what [`Self::load`] finds.
    pub fn named_in(of: &Named, argument: &str) -> anyhow::Result<Self> {
        Self::new(&of.beside("experiment", BUILT_IN, argument)?)
    }

    /// The document of a text.
    pub fn new(text: &Named) -> anyhow::Result<Self> {
        Self::over_base(text, &mut Vec::new())
    }

    /// The document of a text that `above` are based on.
    fn over_base(text: &Named, above: &mut Vec<String>) -> anyhow::Result<Self> {
        let origin = &text.origin;
        if holds_polar(&text.text) {
            bail!(
                "{}: a polar, and no experiment or vehicle: a vehicle's file names it, `[vehicle.aerodynamics.table] polar = \"…\"`",
                on_one_line(origin)
            );
        }
        Kind::Experiment.expect(origin, text.text.as_bytes())?;
        if let Some((line, what)) = foreign(&text.text) {
            bail!("{origin}:{line}: {what}");
        }
        let mut own: Table = text.text.parse().map_err(|error: toml::de::Error| {
            let line = error.span().map_or(1, |s| line_at(&text.text, s.start));
            let message: Vec<&str> = error.message().lines().collect();
            let named = text.file.as_deref().and_then(Path::extension);
            let kind = match named.is_some_and(|end| end != "toml") {
                true => "no TOML, which experiments and vehicles are: ",
                false => "",
            };
            anyhow!("{origin}:{line}: {kind}{}", message.join(", "))
        })?;
        let place = match &text.file {
            Some(file) => std::fs::canonicalize(file)?.display().to_string(),
            None => origin.clone(),
        };
        ensure!(
            !above.contains(&place),
            "{origin}: base: leads back to itself"
        );
        above.push(place);
        if let Some(folder) = text.file.as_deref().and_then(Path::parent) {
            let fields = own.iter_mut();
            fields.for_each(|(key, value)| find_files(key, value, folder));
        }
        let set = own.remove("set");
        let mut document = match own.remove("base") {
            None => Self {
                name: String::new(),
                root: Value::Table(Table::new()),
                texts: None,
                layers: Vec::new(),
            },
            Some(Value::String(base)) => {
                let named = text.beside("experiment", BUILT_IN, &base);
                let named = named.with_context(|| format!("{origin}: base"))?;
                Self::over_base(&named, above)?
            }
            Some(_) => bail!("{origin}: base: must be a name or a file"),
        };
        document.name.clone_from(&text.name);
        document.layers.insert(
            0,
            Layer {
                origin: origin.clone(),
                text: text.text.clone(),
                lines: true,
                inside: "",
            },
        );
        // A base is described by its own line, which is not true of what is built on it.
        if let Value::Table(root) = &mut document.root {
            root.remove("description");
        }
        own.keys().for_each(|key| document.supersede(key));
        document.supersede_plant(own.get("plant"));
        merge("", &mut document.root, Value::Table(own));
        let done = document.expand_names();
        done.map_err(|e| document.located(e))?;
        match set {
            None => {}
            Some(Value::Table(fields)) => {
                for (path, value) in fields {
                    let done = document.set(&path, value);
                    done.map_err(|e| document.located(e))?;
                }
            }
            Some(_) => bail!("{origin}: set: must be a table"),
        }
        Ok(document)
    }

    /// The value at `path`, as in `plant.thrust_n[1]`.
    pub fn get(&self, path: &str) -> Option<&Value> {
        value_at(&self.root, path)
    }

    /// The number at `path`.
    pub fn number(&self, path: &str) -> Result<f64, FieldError> {
        match self.get(&self.as_named(path)) {
            Some(Value::Integer(n)) => Ok(*n as f64),
            Some(Value::Float(x)) => Ok(*x),
            Some(_) => Err(FieldError::new(path, "is not a number")),
            None => Err(FieldError::new(path, "is not in the experiment")),
        }
    }

    /// Puts `value` at `path`. Tables on the way are made; items of arrays must be there.
    pub fn set(&mut self, path: &str, value: Value) -> Result<(), FieldError> {
        let error = |problem: &str| FieldError::new(path, problem);
        // Tables that lie deeper than what reads them can go would end the program.
        let begin: String = path.chars().take(40).collect();
        let problem = format_args!("goes through more than {DEEPEST} tables");
        require(parts(path).count() <= DEEPEST, begin, problem)?;
        if let Some((key, _)) = parts(path).next() {
            self.supersede(key);
        }
        self.believe(path)?;
        let mut place = &mut self.root;
        let mut around = "";
        for (key, index) in parts(path) {
            // A word stands for a kind without fields.
            if CHOICES.contains(&around) && place.is_str() {
                *place = Value::Table(Table::new());
            }
            let Value::Table(table) = place else {
                return Err(error("goes through a value that is no table"));
            };
            if CHOICES.contains(&around) {
                table.retain(|kind, _| kind == key);
            }
            place = table
                .entry(key)
                .or_insert_with(|| Value::Table(Table::new()));
            if let Some(index) = index {
                let item = index.parse().ok().and_then(|i: usize| place.get_mut(i));
                place = item.ok_or_else(|| error("no such item of an array"))?;
            }
            around = key;
        }
        *place = value;
        self.expand_names()
    }

    /// A field of a belief that is left out, or a name, is one of the belief as it stands.
    fn believe(&mut self, path: &str) -> Result<(), FieldError> {
        let belief = self.path_of_belief();
        let inside = path.strip_prefix(&belief);
        let is_field = inside.is_some_and(|rest| rest.starts_with('.'));
        match is_field && !self.get(&belief).is_some_and(Value::is_table) {
            true => self.write_belief(),
            false => Ok(()),
        }
    }

    /// Where the controller's belief about the vehicle stands.
    fn path_of_belief(&self) -> String {
        format!("controller.{}.vehicle", self.controller())
    }

    /// Puts the vehicle in place of the name of a belief.
    pub(crate) fn write_named_belief(&mut self) -> Result<(), FieldError> {
        let path = self.path_of_belief();
        let Some(Value::String(name)) = self.get(&path) else {
            return Ok(());
        };
        let refused = |problem: String| FieldError::new(&path, problem);
        let named = Self::load(name).map_err(|e| refused(format!("{e:#}")))?;
        let vehicle = named.get("vehicle").cloned();
        let vehicle = vehicle.ok_or_else(|| refused("has no [vehicle]".to_owned()))?;
        self.set(&path, vehicle)
    }

    /// Puts the tables of [`NAMED_TABLES`] in place of their names.
    fn expand_names(&mut self) -> Result<(), FieldError> {
        NAMED_TABLES.iter().try_for_each(|named| self.expand(named))
    }

    fn expand(&mut self, table: &NamedTable) -> Result<(), FieldError> {
        let NamedTable {
            path,
            noun,
            built_in,
        } = table;
        let Some(Value::String(name)) = self.get(path) else {
            return Ok(());
        };
        let refused = |problem: String| FieldError::new(*path, problem);
        let named = Named::find(noun, built_in, name);
        let named = named.map_err(|e| refused(format!("{e:#}")))?;
        let table = named.text.parse::<Table>().map_err(|e| {
            let line = e.span().map_or(1, |s| line_at(&named.text, s.start));
            refused(format!(
                "{}:{line}: {}",
                named.origin,
                in_words(e.message())
            ))
        })?;
        let layer = Layer {
            origin: named.origin,
            text: named.text,
            lines: true,
            inside: path,
        };
        self.layers.insert(0, layer);
        self.set(path, Value::Table(table))
    }

    /// Takes out of the base what another kind of plant, which `own` names, does not have.
    fn supersede_plant(&mut self, own: Option<&Value>) {
        let kind = own.and_then(|plant| plant.get("kind"));
        if kind.is_some()
            && kind != self.get("plant.kind")
            && let Value::Table(root) = &mut self.root
        {
            root.remove("plant");
            root.remove("vehicle");
        }
    }

    /// Does what `PATH=VALUE` says; the value is TOML.
    pub fn assign(&mut self, assignment: &str) -> anyhow::Result<()> {
        let (path, value) = assigned(assignment)?;
        self.change(&format!("--set {assignment}"), path, value)
    }

    /// Puts `value` at `path`, over all texts; `origin` stands for this in errors.
    pub fn change(&mut self, origin: &str, path: &str, value: Value) -> anyhow::Result<()> {
        let located = |error| Located {
            place: origin.to_owned(),
            error,
        };
        let texts = self.root.clone();
        self.set(path, value).map_err(located)?;
        self.texts.get_or_insert(texts);
        let layer = Layer {
            origin: origin.to_owned(),
            text: format!("[set]\n\"{path}\" = 0\n"),
            lines: false,
            inside: "",
        };
        self.layers.insert(0, layer);
        Ok(())
    }

    /// What the document says, without judging it.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, FieldError> {
        read(self.root.clone())
    }

    /// The error with the name that the document has for the path.
    pub(crate) fn as_written(&self, error: FieldError) -> FieldError {
        let field = self.as_named(&error.field).into_owned();
        FieldError { field, ..error }
    }

    /// The path with the document's name for the table of what is to be flown.
    fn as_named<'a>(&self, path: &'a str) -> Cow<'a, str> {
        let (key, rest) = begun(path);
        match other_name(key) {
            Some(other) if self.get(other).is_some() => format!("{other}{rest}").into(),
            _ => path.into(),
        }
    }

    /// Whether it says what is to be flown.
    pub fn is_flight(&self) -> bool {
        let mut names = NAMES_OF_PATH.into_iter().chain([MISSION]);
        names.any(|key| self.get(key).is_some())
    }

    /// Gives the table of what is to be flown the name `key`, if that is one of its names. A path takes the place of a mission, and a mission that
    /// of a path.
    fn supersede(&mut self, key: &str) {
        let Value::Table(root) = &mut self.root else {
            return;
        };
        if let Some(other) = other_name(key) {
            root.remove(MISSION);
            if let Some(path) = root.remove(other) {
                root.insert(key.to_owned(), path);
            }
        } else if key == MISSION {
            root.retain(|key, _| other_name(key).is_none());
        }
    }

    /// The document without what was changed of its texts; none if nothing was.
    pub(crate) fn unchanged(&self) -> Option<Self> {
        let texts = self.layers.iter().filter(|layer| layer.lines);
        Some(Self {
            name: self.name.clone(),
            root: self.texts.clone()?,
            texts: None,
            layers: texts.cloned().collect(),
        })
    }

    /// The error with the text and the line that it is about, behind the changes, which have brought it about.
    pub(crate) fn located_by_changes(&self, error: FieldError) -> anyhow::Error {
        let changes = self.layers.iter().rev().filter(|layer| !layer.lines);
        let mut changes: Vec<&str> = changes.map(|layer| &*layer.origin).collect();
        changes.dedup();
        match self.located(error).downcast::<Located>() {
            Ok(Located { place, error }) if !changes.contains(&&*place) => {
                let place = format!("{}: {place}", changes.join(", "));
                Located { place, error }.into()
            }
            Ok(located) => located.into(),
            Err(other) => other,
        }
    }

    /// The error with the text and the line that it is about: `file:line: field: problem`.
    pub fn located(&self, error: FieldError) -> anyhow::Error {
        let error = explained(self.placed(error));
        let mut places = self.layers.iter().map(|l| (l, l.line_of(&error.field)));
        // What is wrong with the whole is said of the document's own text, and not of a table's that it names.
        let first = places.clone().find(|(layer, _)| layer.inside.is_empty());
        let place = places.find(|(_, (_, complete))| *complete).or(first);
        let place = match place {
            Some((layer, (line, _))) if layer.lines => format!("{}:{line}", layer.origin),
            Some((layer, _)) => layer.origin.clone(),
            None => return error.into(),
        };
        Located { place, error }.into()
    }

    /// The error with the table, if there is one, that has the field which the document has not.
    fn placed(&self, mut error: FieldError) -> FieldError {
        let field = &error.field;
        let unknown = error
            .problem
            .starts_with(&format!("unknown field `{field}`"));
        let mut tables = self.root.as_table().into_iter().flatten();
        let has = |(_, table): &(&String, &Value)| table.get(field).is_some();
        if let (true, Some((table, _))) = (unknown, tables.find(has)) {
            error.problem = format!("unknown field `{field}`; did you mean `{table}.{field}`?");
        }
        error
    }

    /// The kind of controller that the document names, or the default one.
    pub fn controller(&self) -> String {
        let table = self.get("controller").and_then(Value::as_table);
        let named = table.and_then(|table| table.keys().next().cloned());
        named.unwrap_or_else(|| ControllerSpec::default().kind)
    }

    /// The vehicle that the document describes, validated.
    pub fn vehicle(&self) -> Result<VehicleSpec, FieldError> {
        let vehicle = self.get("vehicle").cloned();
        let vehicle = vehicle.ok_or_else(|| FieldError::new("vehicle", "is missing"))?;
        let vehicle: VehicleSpec = read(vehicle).map_err(|e| e.inside("vehicle"))?;
        vehicle.core().map_err(|e| e.inside("vehicle"))?;
        Ok(vehicle)
    }

    /// The whole document as TOML text, without a base, and with the belief that it names written out.
    pub fn text(&self) -> String {
        let mut whole = self.clone();
        // A name that leads nowhere stays: it is refused where it is read.
        let _ = whole.write_named_belief();
        toml::to_string(&whole.root).expect("a TOML document")
    }
}

/// What `value` says; an error has the field's path in it.
pub fn read<T: DeserializeOwned>(value: Value) -> Result<T, FieldError> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let path = error.path().to_string();
        FieldError::new(
            path.trim_matches(['.', '?']),
            in_words(error.inner().message()),
        )
    })
}

/// What the reader of a text says, on one line, and which name was probably meant by one that it does not know.
fn in_words(message: &str) -> String {
    let lines: Vec<&str> = message.lines().collect();
    let mut text = lines.join(", ");
    // serde: "unknown field `x`, expected one of `a`, `b`".
    if text.starts_with("unknown ") {
        let mut quoted = text.split('`').skip(1).step_by(2);
        let given = quoted.next().unwrap_or_default();
        let known: Vec<&str> = quoted.collect();
        text += &hint(given, &known);
    }
    text
}

/// What `text` says, validated; `origin` stands for it in errors of one line.
pub fn from_toml<T: DeserializeOwned>(
    origin: &str,
    text: &str,
    validate: impl Fn(&T) -> Result<(), FieldError>,
) -> anyhow::Result<T> {
    let refused = |field: &str, message: &str, line: Option<usize>| {
        let layer = Layer {
            origin: origin.to_owned(),
            text: text.to_owned(),
            lines: true,
            inside: "",
        };
        let line = line.unwrap_or_else(|| layer.line_of(field).0);
        anyhow::Error::new(Located {
            place: format!("{origin}:{line}"),
            error: FieldError::new(field, plainly(&in_words(message))),
        })
    };
    if let Some((line, what)) = foreign(text) {
        return Err(refused("", &what, Some(line)));
    }
    let at = |error: &toml::de::Error| error.span().map_or(1, |s| line_at(text, s.start));
    let deserializer = toml::Deserializer::parse(text)
        .map_err(|error| refused("", error.message(), Some(at(&error))))?;
    let value: T = serde_path_to_error::deserialize(deserializer).map_err(|error| {
        let path = error.path().to_string();
        let inner = error.inner();
        refused(
            path.trim_matches(['.', '?']),
            inner.message(),
            Some(at(inner)),
        )
    })?;
    validate(&value).map_err(|e| refused(&e.field, &e.problem, None))?;
    Ok(value)
}

/// Path and value of `PATH=VALUE`; the value is TOML, and a word that is none is a text.
pub fn assigned(assignment: &str) -> anyhow::Result<(&str, Value)> {
    let (path, value) = assignment
        .split_once('=')
        .with_context(|| format!("--set {assignment}: must be PATH=VALUE"))?;
    let parsed = format!("value = {value}").parse::<Table>();
    let is_word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let word = value.trim();
    let word = (word.starts_with(|c: char| c.is_ascii_alphabetic()) && word.chars().all(is_word))
        .then(|| Value::from(word));
    let value = parsed
        .ok()
        .and_then(|mut table| table.remove("value"))
        .or(word);
    let value = value.with_context(|| {
        format!("--set {assignment}: the value is neither a word nor TOML: a number, true, false, \"a text\", [a list]")
    })?;
    Ok((path.trim(), value))
}

/// Puts `over` over `base`, the value of `key`.
fn merge(key: &str, base: &mut Value, over: Value) {
    match (base, over) {
        (Value::Table(base), Value::Table(over)) => {
            if CHOICES.contains(&key) && over.keys().any(|kind| !base.contains_key(kind)) {
                base.clear();
            }
            for (key, value) in over {
                match base.get_mut(&key) {
                    Some(there) => merge(&key, there, value),
                    None => {
                        base.insert(key, value);
                    }
                }
            }
        }
        (base, over) => *base = over,
    }
}

/// A file that a polar, a belief or sensors are in, beside the text that names it, is named by its whole path.
fn find_files(key: &str, value: &mut Value, folder: &Path) {
    let last = key.rsplit('.').next();
    match value {
        Value::String(name) if matches!(last, Some("polar" | "vehicle" | "sensors")) => {
            let beside = folder.join(&*name);
            if beside.is_file() {
                *name = beside.display().to_string();
            }
        }
        Value::Table(table) => {
            let inner = table.iter_mut();
            inner.for_each(|(key, value)| find_files(key, value, folder));
        }
        _ => {}
    }
}

fn line_at(text: &str, offset: usize) -> usize {
    let end = offset.min(text.len());
    let before = &text.as_bytes()[..end];
    1 + before.iter().filter(|&&byte| byte == b'\n').count()
}

impl Layer {
    /// The line of the dotted `field`, or of the nearest table around it, and whether the text has the field.
    fn line_of(&self, field: &str) -> (usize, bool) {
        let dotted = self.inside.is_empty() || field.starts_with(self.inside);
        if !dotted {
            return (1, false);
        }
        let field = field[self.inside.len()..].trim_start_matches('.');
        let Ok(document) = DeTable::parse(&self.text) else {
            return (1, false);
        };
        let root = document.get_ref();
        let begins = |long: &str, short: &str| {
            let rest = long.strip_prefix(short);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        if let Some(DeValue::Table(set)) = root.get("set").map(|set| set.get_ref()) {
            let either = |one: &str, other: &str| begins(one, other) || begins(other, one);
            let renamed = renamed(field);
            let assignment = set.iter().find(|(key, _)| {
                let key = key.get_ref();
                either(field, key) || renamed.as_deref().is_some_and(|field| either(field, key))
            });
            if let Some((key, _)) = assignment {
                return (line_at(&self.text, key.span().start), true);
            }
        }
        let mut offset = 0;
        let mut table = Some(root);
        let mut array = None;
        let mut complete = true;
        for part in field.split(['.', '[']) {
            let value = if let Some(index) = part.strip_suffix(']') {
                let items: Option<&toml::de::DeArray> = array;
                index.parse().ok().and_then(|i: usize| items?.get(i))
            } else {
                table.and_then(|t| t.get(part).or_else(|| t.get(other_name(part)?)))
            };
            let Some(value) = value else {
                // The value is not a table: the rest of the path cannot be followed into it.
                complete = table.is_none() && array.is_none();
                break;
            };
            offset = value.span().start;
            (table, array) = match value.get_ref() {
                DeValue::Table(inner) => (Some(inner), None),
                DeValue::Array(inner) => (None, Some(inner)),
                _ => (None, None),
            };
        }
        (line_at(&self.text, offset), complete)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Experiment;
    use crate::refusals::begins;

    fn over(text: &str) -> anyhow::Result<Document> {
        Document::new(&Named::new("x", "x.toml", text))
    }

    #[test]
    fn a_text_goes_over_its_base_and_set_over_both() {
        let text =
            "base = 'steep-descent'\n[vehicle]\nmass_kg = 11\n[set]\n'plant.thrust_n[1]' = 150\n";
        let document = over(text).unwrap();
        assert_eq!(document.number("vehicle.mass_kg").unwrap(), 11.0);
        assert_eq!(document.number("vehicle.k_a_kg_m").unwrap(), 0.646);
        assert_eq!(document.number("plant.thrust_n[0]").unwrap(), 0.0);
        assert_eq!(document.number("plant.thrust_n[1]").unwrap(), 150.0);
        let experiment = document.checked().unwrap();
        assert_eq!(experiment.vehicle.mass_kg, 11.0);
        assert_eq!(experiment.description, "");
        // The whole text says the same without a base.
        let whole = over(&document.text()).unwrap().checked().unwrap();
        let belief = |experiment: &Experiment| experiment.spec().unwrap().belief().cloned();
        assert_eq!(belief(&whole), belief(&experiment));
        assert_eq!(whole.vehicle, experiment.vehicle);
        assert!(!document.text().contains("paper-belief"));
    }

    #[test]
    fn another_kind_replaces_the_bases() {
        let document = over("base = 'round-trip'\n[controller.law.gains]\nk1 = 1\n").unwrap();
        assert!(document.get("controller.guidance").is_none());
        let table = "[vehicle.aerodynamics.table]\npolar = 'naca-0021-re-5e6'\n";
        let mut document = over(&format!("base = 'round-trip'\n{table}")).unwrap();
        assert!(document.get("vehicle.aerodynamics.combined").is_none());
        document.set("plant.rate_loop", "ideal".into()).unwrap();
        let path = "plant.rate_loop.lag.time_constant_s";
        document.set(path, 0.2.into()).unwrap();
        assert!(document.checked().is_ok());
        // More of the same kind is added to the base's.
        let more = over("base = 'round-trip'\n[controller.guidance]\ndamping = 0.7\n").unwrap();
        assert!(more.number("controller.guidance.tau_mg").is_ok());
    }

    #[test]
    fn a_file_is_found_beside_the_one_that_names_it_and_a_circle_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let polar = include_str!("../../../data/naca-0021-re-5e6.csv");
        std::fs::write(at("mine.csv"), polar).unwrap();
        std::fs::write(
            at("a.toml"),
            "base = 'round-trip'\nvehicle.aerodynamics.table.polar = 'mine.csv'\n",
        )
        .unwrap();
        std::fs::write(at("b.toml"), "base = 'a.toml'\nduration_s = 3\n").unwrap();
        let load = |name: &str| Document::load(at(name).to_str().unwrap());
        assert_eq!(load("b.toml").unwrap().checked().unwrap().duration_s, 3.0);
        std::fs::write(at("a.toml"), "base = 'b.toml'\n").unwrap();
        let error = load("b.toml").unwrap_err().to_string();
        assert!(error.ends_with("base: leads back to itself"), "{error}");
        std::fs::write(at("a.toml"), "base = 'c.toml'\n").unwrap();
        let error = format!("{:#}", load("a.toml").unwrap_err());
        assert!(error.contains("a.toml: base: c.toml"), "{error}");
    }

    /// `[path]` and `[reference]` are two names of one table, whichever the base has: another kind stands in place of the base's, more of the same kind
    /// is added to it, and errors have the name that is written.
    #[test]
    fn a_path_is_the_reference_of_the_base() {
        let mut document = Document::load("round-trip").unwrap();
        let field = "path.knots[1].forward_m_s";
        let before = document.number(field).unwrap();
        document.set(field, 15.0.into()).unwrap();
        assert!(before != 15.0 && document.number("reference.knots[1].forward_m_s") == Ok(15.0));
        assert!(document.checked().unwrap().in_plane());
        let wider = over("base = 'climbing-turn'\n[reference.circle]\nradius_m = 55\n").unwrap();
        let alone = Document::load("climbing-turn").unwrap();
        let speed = |document: &Document| document.number("path.circle.speed_m_s").unwrap();
        assert_eq!(speed(&wider), speed(&alone));
        assert!(wider.number("path.circle.radius_m") == Ok(55.0) && wider.checked().is_ok());

        let path = over("base = 'round-trip'\n[path.circle]\nradius_m = 40\nspeed_m_s = 20\n");
        let mut document = path.unwrap();
        assert!(document.get("reference").is_none() && !document.checked().unwrap().in_plane());
        document.set("reference.circle.radius_m", 0.into()).unwrap();
        let error = document.experiment().unwrap_err();
        assert_eq!(error.field, "reference.circle.radius_m");
        // A line of the text is found by either name.
        let text = "base = 'round-trip'\n[path.circle]\nradius_m = 0\nspeed_m_s = 20\n";
        for set in ["", "set.'reference.circle.speed_m_s' = 21"] {
            let refused = over(&format!("{set}\n{text}")).unwrap();
            let error = refused.experiment().map_err(|error| refused.located(error));
            let error = error.err().unwrap().to_string();
            assert!(
                error.contains(":4: ") && error.contains("circle.radius_m"),
                "{error}"
            );
        }
        let knots = "knots = [{ t_s = 0, down_m_s = 0, forward_m_s = 5 }]";
        let mut document = over(&format!("base = 'eight'\n[reference]\n{knots}\n")).unwrap();
        assert!(document.checked().unwrap().in_plane());
        let east = "reference.knots[0].east_m_s";
        document.set(east, 1.0.into()).unwrap();
        assert!(!document.checked().unwrap().in_plane());
        document.set(east, 1e9.into()).unwrap();
        assert_eq!(document.experiment().unwrap_err().field, east);
    }

    #[test]
    fn fields_are_assigned_by_path() {
        let mut document = Document::load("round-trip").unwrap();
        document.assign("plant.thrust_n[1]=112.8").unwrap();
        document
            .assign("weather.steady_m_s = [-1.0, 0.0, 0.0]")
            .unwrap();
        document.assign("weather.turbulence.height_m=30").unwrap();
        document
            .assign("weather.turbulence.wind_at_20_ft_m_s=8")
            .unwrap();
        let experiment = document.checked().unwrap();
        assert_eq!(experiment.plant.thrust_n, [0.0, 112.8]);
        assert_eq!(
            experiment.weather.steady,
            super::super::V3::new(-1.0, 0.0, 0.0)
        );
        document.assign("vehicle.mass_kg=-1").unwrap();
        assert_eq!(
            document.checked().unwrap_err().to_string(),
            "--set vehicle.mass_kg=-1: vehicle.mass_kg: mass must be positive, from 0.001 to 1000000 kg"
        );
        document.assign("vehicle.mass_kg=3").unwrap();
        let untouched = document.clone();
        let refused = |text: &str| format!("{:#}", untouched.clone().assign(text).unwrap_err());
        assert!(refused("seed").contains("must be PATH=VALUE"));
        assert!(refused("seed={1").contains("neither a word nor TOML"));
        document.assign("sensors.accelerometer=none").unwrap();
        let told = document.checked().unwrap().sensors.accelerometer;
        assert_eq!(told, super::super::sensors::Sensor::None);
        document.assign("seed=one").unwrap();
        let error = document.checked().unwrap_err().to_string();
        assert!(error.contains("--set seed=one: seed"), "{error}");
        assert!(refused("plant.thrust_n[2]=1").contains("plant.thrust_n[2]: no such item"));
        assert!(refused("duration_s.x=1").contains("duration_s.x: goes through"));
        let deep = format!("{}=1", ["a"; 60_000].join("."));
        assert!(refused(&deep).contains("goes through more than 80 tables"));
        let number = |path: &str| document.number(path).unwrap_err().problem;
        assert!(number("weather.gust.peak_m_s").contains("not in the experiment"));
        assert!(number("description").contains("not a number"));
    }

    /// A valid text with one line replaced: the message names that line.
    #[test]
    fn errors_name_line_and_field() {
        let named = |name: &str| BUILT_IN.iter().find(|b| b.0 == name).unwrap().1;
        // In one text, with the belief spelled out.
        let (_, vehicle) = named("paper").split_once("[vehicle]").unwrap();
        let text = named("hover-to-cruise").replace("base = \"paper\"", "");
        let belief = "[controller.law.vehicle]\nmass_kg = 9.0\nk_a_kg_m = 0.51\n";
        let text = text.replace("vehicle = \"paper-belief\"", "") + belief + "[vehicle]" + vehicle;
        let expect = |needle: &str, with: &str, message: &str| {
            let swap = |l| if str::contains(l, needle) { with } else { l };
            let lines: Vec<_> = text.lines().map(swap).collect();
            let document = over(&lines.join("\n"));
            let actual = document.and_then(|d| d.checked()).unwrap_err().to_string();
            let line = 1 + text.lines().position(|l| l.contains(needle)).unwrap();
            let expected = format!("x.toml:{line}: {message}");
            assert!(actual.starts_with(&expected), "{actual}\n{expected}");
            assert!(!actual.contains('\n'), "{actual}");
        };
        expect(
            "mass_kg = 9",
            "mass_kg = -9",
            "controller.law.vehicle.mass_kg: mass must be positive, from 0.001 to 1000000 kg",
        );
        expect(
            "mass_kg = 10",
            "mass_kg = \"ten\"",
            "vehicle.mass_kg: \"ten\", where a number is wanted",
        );
        expect(
            "duration_s",
            "duration_s = nan",
            "duration_s: must be a finite number",
        );
        expect(
            "tau_n",
            "tau_n = 0",
            "controller.law.gains.tau_n: tau must be",
        );
        expect(
            "tau_n",
            "tau = 80",
            "controller.law.gains.tau: unknown field `tau`",
        );
        expect("substeps", "substeps = 0", "substeps: must be from 1");
        expect(
            "t_s = 10",
            "    { t_s = 0, down_m_s = 0, forward_m_s = 20 },",
            "reference.knots[1]: t_s must increase",
        );
        expect(
            "form =",
            "form = \"robst\"",
            "controller.law.form: unknown variant",
        );
        // What was probably meant stands behind what there is.
        let meant = |line: &str| {
            let error =
                over(&format!("base = 'hover-to-cruise'\n{line}")).and_then(|d| d.checked());
            let error = error.unwrap_err().to_string();
            error
                .split_once("; did you mean ")
                .map(|(_, name)| name.to_owned())
        };
        assert_eq!(meant("vehicle.mass = 1").as_deref(), Some("`mass_kg`?"));
        assert_eq!(meant("vehicel.mass_kg = 1").as_deref(), Some("`vehicle`?"));
        assert_eq!(
            meant("controller.law.form = 'robst'").as_deref(),
            Some("`robust`?")
        );
        assert_eq!(meant("vehicle.colour = 1"), None);
        // In the base.
        let error = over("base = 'paper'\n[vehicle]\nmass = 1\n").and_then(|d| d.checked());
        let error = error.unwrap_err().to_string();
        begins(&error, "x.toml:3: vehicle.mass: unknown field");
    }
}
