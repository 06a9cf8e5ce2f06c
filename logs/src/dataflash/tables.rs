//! The rows of each kind of message, and their units.

use super::format::{Field, Format};
use crate::{Column, Log, Topic};
use std::collections::{BTreeMap, HashMap};

/// The type of `FMT` itself.
pub(super) const FMT: u8 = 128;
/// The unit of the column that tells instances apart.
const INSTANCE: char = '#';
/// What that column is called where a log has no units: it stands behind the time.
const INSTANCES: [&str; 4] = ["C", "I", "Inst", "Instance"];

/// A message as its reader sees it.
pub(super) trait Message {
    /// Number `element` of the field at `place`; NaN if it is none.
    fn number(&self, place: usize, field: &Field, element: usize) -> f64;
    /// The text of the field at `place`.
    fn text(&self, place: usize, field: &Field) -> String;
}

/// What was read so far.
#[derive(Default)]
pub(super) struct Tables {
    formats: HashMap<u8, Table>,
    by_name: HashMap<String, u8>,
    /// Types in the order of their first rows.
    order: Vec<u8>,
    /// Letter → unit.
    units: HashMap<char, String>,
    /// Letter → multiplier.
    multipliers: HashMap<char, f64>,
    /// Type → letters of units, letters of multipliers, by field.
    assigned: HashMap<u8, (Vec<char>, Vec<char>)>,
    pub notes: Vec<String>,
}

struct Table {
    format: Format,
    /// By number: all of the first field, then all of the second, …
    values: Vec<Vec<f64>>,
}

impl Tables {
    pub(super) fn is_empty(&self) -> bool {
        self.formats.is_empty()
    }

    pub(super) fn format(&self, kind: u8) -> Option<&Format> {
        Some(&self.formats.get(&kind)?.format)
    }

    pub(super) fn kind(&self, name: &str) -> Option<u8> {
        self.by_name.get(name).copied()
    }

    /// Takes the format of a type. The first that a type or a name is given stands: a later one is damage.
    pub(super) fn define(&mut self, kind: u8, format: Result<Format, String>) {
        let format = match format {
            Ok(format) => format,
            Err(problem) => return self.notes.push(problem),
        };
        match (self.format(kind), self.kind(&format.name)) {
            (None, None) => {
                let values = format.fields.iter().map(Field::numbers).sum();
                self.by_name.insert(format.name.clone(), kind);
                self.formats.insert(
                    kind,
                    Table {
                        format,
                        values: vec![Vec::new(); values],
                    },
                );
            }
            (Some(known), _) if *known == format => {}
            _ => self.notes.push(format!(
                "{}: a second, different format; left out",
                format.name
            )),
        }
    }

    /// Takes a message of the type `kind`.
    pub(super) fn take(&mut self, kind: u8, message: &impl Message) {
        let Some(table) = self.formats.get_mut(&kind) else {
            return;
        };
        let format = &table.format;
        let place = |label: &str| {
            format
                .place(label)
                .and_then(|place| Some((place, format.fields.get(place)?)))
        };
        let number = |label| place(label).map(|(place, field)| message.number(place, field, 0));
        let text = |label| place(label).map(|(place, field)| message.text(place, field));
        let letter = |label| number(label).map(|n| char::from(n as u8));
        match format.name.as_str() {
            "UNIT" => {
                if let (Some(id), Some(unit)) = (letter("Id"), text("Label")) {
                    self.units.insert(id, unit);
                }
            }
            "MULT" => {
                if let (Some(id), Some(multiplier)) = (letter("Id"), number("Mult")) {
                    // Seven digits: logs hold single-precision multipliers, widened.
                    let multiplier = format!("{multiplier:.6e}").parse().unwrap_or(f64::NAN);
                    self.multipliers.insert(id, multiplier);
                }
            }
            "FMTU" => {
                let letters = |label| text(label).map(|letters| letters.chars().collect());
                if let (Some(kind), Some(units), Some(multipliers)) =
                    (number("FmtType"), letters("UnitIds"), letters("MultIds"))
                {
                    self.assigned.insert(kind as u8, (units, multipliers));
                }
            }
            // A parameter's value means nothing without its name, which is text.
            "FMT" | "PARM" => {}
            _ => {
                if table.values.first().is_some_and(Vec::is_empty) {
                    self.order.push(kind);
                }
                let mut columns = table.values.iter_mut();
                for (place, field) in format.fields.iter().enumerate() {
                    for element in 0..field.numbers() {
                        if let Some(column) = columns.next() {
                            column.push(message.number(place, field, element));
                        }
                    }
                }
            }
        }
    }

    pub(super) fn finish(mut self) -> Log {
        let mut topics = Vec::new();
        for kind in std::mem::take(&mut self.order) {
            if let Some(table) = self.formats.remove(&kind) {
                self.topics_of(kind, table, &mut topics);
            }
        }
        Log {
            topics,
            notes: self.notes,
        }
    }

    fn topics_of(&mut self, kind: u8, table: Table, topics: &mut Vec<Topic>) {
        let none = (Vec::new(), Vec::new());
        let assigned = self.assigned.get(&kind);
        let (units, multipliers) = assigned.unwrap_or(&none);
        let instance = |place: usize, label: &str| match assigned {
            Some((units, _)) => units.get(place) == Some(&INSTANCE),
            None => place == 1 && INSTANCES.contains(&label),
        };
        let clock = clock(&table.format.fields);
        let mut time = None;
        let mut instances = None;
        let mut columns = Vec::new();
        let mut values = table.values.into_iter();
        for (place, field) in table.format.fields.iter().enumerate() {
            let unit = units.get(place).copied().unwrap_or('-');
            let multiplier = multipliers
                .get(place)
                .and_then(|m| self.multipliers.get(m))
                .copied();
            let multiplier =
                multiplier.filter(|m| m.is_finite() && *m != 0.0 && !field.is_scaled());
            for element in 0..field.numbers() {
                let mut values = values.next().unwrap_or_default();
                let per_second = clock.filter(|(at, _)| *at == place);
                if let (None, Some((_, per_second))) = (&time, per_second) {
                    time = Some(
                        values
                            .into_iter()
                            .map(|t| t / per_second)
                            .collect::<Vec<f64>>(),
                    );
                    continue;
                }
                if instance(place, &field.label) && instances.is_none() {
                    instances = Some(values.clone());
                }
                // 1 / 1e-2 is exactly 100, and a quotient is rounded once.
                match multiplier {
                    Some(m) if m < 1.0 => values.iter_mut().for_each(|v| *v /= 1.0 / m),
                    Some(m) => values.iter_mut().for_each(|v| *v *= m),
                    None => {}
                }
                let name = match field.numbers() {
                    1 => field.label.clone(),
                    _ => format!("{}[{element}]", field.label),
                };
                let unit = self
                    .units
                    .get(&unit)
                    .filter(|_| !['-', '?', INSTANCE].contains(&unit));
                columns.push(Column {
                    name,
                    unit: unit.cloned().unwrap_or_default(),
                    values,
                });
            }
        }
        let Some(time) = time else { return };
        let Some(instances) = instances else {
            topics.extend(Topic::from_rows(
                &table.format.name,
                0,
                time,
                columns,
                &mut self.notes,
            ));
            return;
        };
        let mut rows: BTreeMap<u8, Vec<usize>> = BTreeMap::new();
        for (row, instance) in instances.iter().enumerate() {
            rows.entry(*instance as u8).or_default().push(row);
        }
        for (instance, rows) in rows {
            let select = |values: &[f64]| {
                rows.iter()
                    .filter_map(|&row| values.get(row).copied())
                    .collect()
            };
            let of = |c: &Column| Column::new(&c.name, &c.unit, select(&c.values));
            let columns = columns.iter().map(of).collect();
            topics.extend(Topic::from_rows(
                &table.format.name,
                instance,
                select(&time),
                columns,
                &mut self.notes,
            ));
        }
    }
}

/// Place of the field that holds the time since boot, and its units per second; none if there is no such field. Of the old `GPS`, whose `TimeMS` is the
/// time in the `Week` of the receiver, it is `T`.
fn clock(fields: &[Field]) -> Option<(usize, f64)> {
    let place = |label: &str| fields.iter().position(|field| field.label == label);
    let received = place("Week").and(place("TimeMS")).and(place("T"));
    let clocks = [
        (place("TimeUS"), 1e6),
        (received, 1e3),
        (place("TimeMS"), 1e3),
    ];
    let complete = |(place, per_second): (Option<usize>, f64)| Some((place?, per_second));
    clocks.into_iter().find_map(complete)
}
