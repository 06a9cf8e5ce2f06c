//! A mission as a document, whose fields are changed by name before it is read.

use toml::{Table, Value};

use super::Mission;
use crate::scenario::FieldError;

/// A mission's TOML document: a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft(Value);

/// The parts of a dotted path: each a key, and perhaps the index of an item.
fn parts(path: &str) -> impl Iterator<Item = (&str, Option<&str>)> {
    path.split('.').map(|part| match part.split_once('[') {
        Some((key, rest)) => (key, Some(rest.trim_end_matches(']'))),
        None => (part, None),
    })
}

impl Draft {
    /// The document in `text`.
    pub fn new(text: &str) -> Result<Self, toml::de::Error> {
        Ok(Self(Value::Table(text.parse()?)))
    }

    /// The number at `path`, as in `plant.thrust_n[1]`.
    pub fn number(&self, path: &str) -> Result<f64, FieldError> {
        let mut found = Some(&self.0);
        for (key, index) in parts(path) {
            found = found.and_then(|table| table.get(key));
            if let Some(index) = index {
                let item = |i: usize| found.and_then(|array| array.get(i));
                found = index.parse().ok().and_then(item);
            }
        }
        match found {
            Some(Value::Integer(n)) => Ok(*n as f64),
            Some(Value::Float(x)) => Ok(*x),
            Some(_) => Err(FieldError::new(path, "is not a number")),
            None => Err(FieldError::new(path, "is not in the mission")),
        }
    }

    /// Puts `value` at `path`. Tables on the way are made; items of arrays must be there.
    pub fn set(&mut self, path: &str, value: Value) -> Result<(), FieldError> {
        let error = |problem: &str| FieldError::new(path, problem);
        let mut found = &mut self.0;
        for (key, index) in parts(path) {
            let Value::Table(table) = found else {
                return Err(error("goes through a value that is no table"));
            };
            found = table
                .entry(key)
                .or_insert_with(|| Value::Table(Table::new()));
            if let Some(index) = index {
                let item = index.parse().ok().and_then(|i: usize| found.get_mut(i));
                found = item.ok_or_else(|| error("no such item of an array"))?;
            }
        }
        *found = value;
        Ok(())
    }

    /// The mission, validated.
    pub fn mission(&self) -> Result<Mission, FieldError> {
        let mission: Mission = serde_path_to_error::deserialize(self.0.clone())
            .map_err(|e| FieldError::new(e.path().to_string(), e.inner().message()))?;
        mission.validate()?;
        Ok(mission)
    }

    /// The document as TOML text.
    pub fn text(&self) -> String {
        toml::to_string(&self.0).expect("a TOML document")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::{BUILT_IN, MissionSource};

    fn draft() -> Draft {
        Draft::new(BUILT_IN[0].1).unwrap()
    }

    #[test]
    fn unchanged_it_is_the_mission() {
        let mission = MissionSource::load(BUILT_IN[0].0).unwrap().mission;
        assert_eq!(draft().mission().unwrap(), mission);
        assert_eq!(Draft::new(&draft().text()).unwrap(), draft());
    }

    #[test]
    fn fields_are_changed_by_name() {
        let mut draft = draft();
        assert_eq!(draft.number("vehicle.mass_kg").unwrap(), 10.0);
        assert_eq!(draft.number("plant.thrust_n[1]").unwrap(), 196.2);
        draft.set("vehicle.mass_kg", Value::Float(11.0)).unwrap();
        draft.set("plant.thrust_n[1]", Value::Float(120.0)).unwrap();
        draft
            .set("weather.turbulence.height_m", Value::Float(30.0))
            .unwrap();
        draft
            .set("weather.turbulence.wind_at_20_ft_m_s", Value::Integer(8))
            .unwrap();
        let mission = draft.mission().unwrap();
        assert_eq!(mission.vehicle.mass_kg, 11.0);
        assert_eq!(mission.plant.thrust_n, [0.0, 120.0]);
        assert_eq!(mission.weather.turbulence.unwrap().wind_at_20_ft_m_s, 8.0);
    }

    #[test]
    fn errors_name_the_field() {
        let refused = |path: &str, value: Value| {
            let mut draft = draft();
            let set = draft.set(path, value);
            let error = set.and_then(|()| draft.mission().map(|_| ())).unwrap_err();
            format!("{}: {}", error.field, error.problem)
        };
        let one = Value::Integer(1);
        assert!(refused("vehicle.mass", one.clone()).starts_with("vehicle.mass: unknown field"));
        assert!(
            refused("plant.thrust_n[2]", one.clone()).contains("plant.thrust_n[2]: no such item")
        );
        assert!(refused("duration_s.x", one).contains("duration_s.x: goes through"));
        let negative = refused("vehicle.mass_kg", Value::Float(-1.0));
        assert_eq!(negative, "vehicle.mass_kg: mass must be positive");
        assert!(
            draft()
                .number("weather.gust.peak_m_s")
                .unwrap_err()
                .problem
                .contains("not in the mission")
        );
        assert!(
            draft()
                .number("description")
                .unwrap_err()
                .problem
                .contains("not a number")
        );
    }
}
