//! An autopilot's parameters: over the link, and as files.

use std::collections::BTreeMap;

use mavlink::dialects::ardupilotmega::{MavParamType, PARAM_REQUEST_READ_DATA, PARAM_VALUE_DATA};
use mavlink::types::CharArray;

use super::{Kind, MavMessage};

/// Parameters by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters(BTreeMap<String, f32>);

impl Parameters {
    /// Those of a text: ArduPilot's (`NAME value` or `NAME,value`) or QGroundControl's (system, component, name, value, type). What is behind a `#` is a comment.
    ///
    /// # Errors
    /// The line that is none.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let mut parameters = Self::default();
        for line in text.lines() {
            let words = line.split('#').next().unwrap_or_default();
            let words: Vec<&str> = words
                .split([' ', '\t', ','])
                .filter(|word| !word.is_empty())
                .collect();
            let (name, value) = match words[..] {
                [] => continue,
                [name, value] => (name, value),
                [_, _, name, value, _] => (name, value),
                _ => return Err(line.to_owned()),
            };
            let value = value.parse().map_err(|_| line.to_owned())?;
            parameters.set(name, value);
        }
        Ok(parameters)
    }

    /// The value of `name`.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.get(name).map(|value| f64::from(*value))
    }

    /// Sets `name`.
    pub fn set(&mut self, name: &str, value: f32) {
        self.0.insert(name.to_owned(), value);
    }

    /// These, and of the rest what `others` have.
    #[must_use]
    pub fn or(mut self, others: Self) -> Self {
        for (name, value) in others.0 {
            self.0.entry(name).or_insert(value);
        }
        self
    }

    /// Names and values.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.0
            .iter()
            .map(|(name, value)| (name.as_str(), f64::from(*value)))
    }

    /// Takes what the autopilot says of a parameter. PX4 puts the bits of an integer where the number is, ArduPilot the number.
    pub fn take(&mut self, kind: Kind, message: &PARAM_VALUE_DATA) {
        let bits = message.param_value.to_bits();
        let value = match (kind, message.param_type) {
            (Kind::Px4, MavParamType::MAV_PARAM_TYPE_INT32) => bits as i32 as f32,
            (Kind::Px4, MavParamType::MAV_PARAM_TYPE_UINT32) => bits as f32,
            _ => message.param_value,
        };
        if let Ok(name) = message.param_id.to_str() {
            self.set(name, value);
        }
    }

    /// What an autopilot answers that is asked for `name`; none if it has no such parameter.
    #[must_use]
    pub fn answer(&self, name: &str) -> Option<MavMessage> {
        self.0.get(name).map(|value| {
            MavMessage::PARAM_VALUE(PARAM_VALUE_DATA {
                param_value: *value,
                param_count: self.0.len() as u16,
                param_index: u16::MAX,
                param_id: identifier(name),
                param_type: MavParamType::MAV_PARAM_TYPE_REAL32,
            })
        })
    }
}

/// A name as messages have it.
fn identifier(name: &str) -> CharArray<16> {
    let mut bytes = [0; 16];
    for (to, from) in bytes.iter_mut().zip(name.bytes()) {
        *to = from;
    }
    CharArray::new(bytes)
}

/// Asks the system `target` for the parameter `name`.
#[must_use]
pub fn request(target: u8, name: &str) -> MavMessage {
    MavMessage::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA {
        param_index: -1,
        target_system: target,
        target_component: 1,
        param_id: identifier(name),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_both_kinds_are_read() {
        let text = "# a comment\nQ_ENABLE 1\nQ_M_SPIN_ARM,0.1 # too\n1\t1\tFW_PR_P\t0.08\t9\n\n";
        let parameters = Parameters::from_text(text).unwrap();
        let get = |name| parameters.get(name);
        assert_eq!(get("Q_ENABLE"), Some(1.0));
        assert!((get("Q_M_SPIN_ARM").unwrap() - 0.1).abs() < 1e-7);
        assert!((get("FW_PR_P").unwrap() - 0.08).abs() < 1e-7);
        assert_eq!((get("FW_PR_I"), parameters.iter().count()), (None, 3));
        assert_eq!(Parameters::from_text("A 1 2").unwrap_err(), "A 1 2");
        assert!(Parameters::from_text("A x").is_err());
    }

    /// PX4's integers are bits of a float.
    #[test]
    fn integers_are_read_as_each_autopilot_sends_them() {
        let message = |value: f32| PARAM_VALUE_DATA {
            param_value: value,
            param_count: 1,
            param_index: 0,
            param_id: identifier("VT_ELEV_MC_LOCK"),
            param_type: MavParamType::MAV_PARAM_TYPE_INT32,
        };
        let read = |kind, value| {
            let mut parameters = Parameters::default();
            parameters.take(kind, &message(value));
            parameters.get("VT_ELEV_MC_LOCK").unwrap()
        };
        assert_eq!(read(Kind::Px4, f32::from_bits(7)), 7.0);
        assert_eq!(read(Kind::ArduPlane(Default::default()), 7.0), 7.0);
    }
}
