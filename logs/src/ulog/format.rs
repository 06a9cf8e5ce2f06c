//! Formats of messages, and where in a message each number lies.

use std::collections::HashMap;

/// A number in a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Signed(u8),
    Unsigned(u8),
    Float,
    Double,
    /// `char`: text, which is left out.
    Character,
}

impl Kind {
    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "int8_t" => Self::Signed(1),
            "int16_t" => Self::Signed(2),
            "int32_t" => Self::Signed(4),
            "int64_t" => Self::Signed(8),
            "uint8_t" | "bool" => Self::Unsigned(1),
            "uint16_t" => Self::Unsigned(2),
            "uint32_t" => Self::Unsigned(4),
            "uint64_t" => Self::Unsigned(8),
            "float" => Self::Float,
            "double" => Self::Double,
            "char" => Self::Character,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Signed(size) | Self::Unsigned(size) => size.into(),
            Self::Float => 4,
            Self::Double => 8,
            Self::Character => 1,
        }
    }

    /// The number at the beginning of `bytes`; None if they are too few.
    pub(super) fn number(self, bytes: &[u8]) -> Option<f64> {
        let mut little = [0; 8];
        let bytes = bytes.get(..self.size())?;
        little.get_mut(..bytes.len())?.copy_from_slice(bytes);
        let unsigned = u64::from_le_bytes(little);
        Some(match self {
            Self::Float => f32::from_le_bytes([little[0], little[1], little[2], little[3]]).into(),
            Self::Double => f64::from_le_bytes(little),
            Self::Unsigned(_) | Self::Character => unsigned as f64,
            // The sign is shifted to the top and back.
            Self::Signed(size) => {
                let shift = 64 - 8 * u32::from(size);
                ((unsigned << shift) as i64 >> shift) as f64
            }
        })
    }
}

/// A field as a format states it: `type[count] name`.
#[derive(Clone, Debug)]
pub(super) struct Field {
    kind: String,
    /// Elements, of an array.
    count: Option<usize>,
    name: String,
}

/// The name and the fields of a format message.
pub(super) fn parse(text: &str) -> Result<(String, Vec<Field>), String> {
    let (name, fields) = text.split_once(':').ok_or("a format without a colon")?;
    let field = |text: &str| {
        let (kind, name) = text.trim().split_once(' ')?;
        let (kind, count) = match kind.split_once('[') {
            Some((kind, count)) => (kind, Some(count.strip_suffix(']')?.parse().ok()?)),
            None => (kind, None),
        };
        Some(Field {
            kind: kind.into(),
            count,
            name: name.trim().into(),
        })
    };
    let fields = fields
        .split(';')
        .filter(|text| !text.trim().is_empty())
        .map(|text| field(text).ok_or_else(|| format!("the format of `{name}` holds `{text}`")));
    Ok((name.into(), fields.collect::<Result<_, _>>()?))
}

/// A number of a message.
#[derive(Debug)]
pub(super) struct Number {
    pub name: String,
    pub kind: Kind,
    /// Bytes before it.
    pub offset: usize,
}

/// Where the numbers of a message lie.
#[derive(Debug, Default)]
pub(super) struct Layout {
    /// Each number but the time.
    pub numbers: Vec<Number>,
    /// Offset of the time, a `uint64_t` in microseconds.
    pub time: Option<usize>,
    /// Bytes up to the last field that is not padding: a message holds at least these.
    pub least: usize,
    /// Bytes with all padding: a message holds at most these.
    pub most: usize,
}

/// Fields and elements that one format may come to, nested ones counted. A message of 65,535 bytes holds no more.
const MOST_FIELDS: usize = 1 << 16;
/// Formats within formats.
const DEEPEST: usize = 8;

impl Layout {
    /// The layout of the format `name`.
    ///
    /// # Errors
    /// In words: a format that is not there, formats nested without end, more than a message can hold.
    pub(super) fn of(name: &str, formats: &HashMap<String, Vec<Field>>) -> Result<Self, String> {
        let mut layout = Self::default();
        let mut visits = 0;
        layout.add(name, "", formats, 0, &mut visits)?;
        Ok(layout)
    }

    fn add(
        &mut self,
        format: &str,
        prefix: &str,
        formats: &HashMap<String, Vec<Field>>,
        depth: usize,
        visits: &mut usize,
    ) -> Result<(), String> {
        if depth == DEEPEST {
            return Err(format!("formats nested more than {DEEPEST} deep"));
        }
        let fields = formats
            .get(format)
            .ok_or_else(|| format!("no format `{format}`"))?;
        for field in fields {
            let padding = field.name.starts_with("_padding");
            for index in 0..field.count.unwrap_or(1) {
                *visits += 1;
                if *visits > MOST_FIELDS {
                    return Err("more fields than a message can hold".into());
                }
                let Some(kind) = Kind::parse(&field.kind) else {
                    let prefix = match field.count {
                        Some(_) => format!("{prefix}{}[{index}].", field.name),
                        None => format!("{prefix}{}.", field.name),
                    };
                    self.add(&field.kind, &prefix, formats, depth + 1, visits)?;
                    continue;
                };
                let offset = self.most;
                self.most += kind.size();
                if padding {
                    continue;
                }
                self.least = self.most;
                if prefix.is_empty() && field.name == "timestamp" && kind == Kind::Unsigned(8) {
                    self.time = Some(offset);
                } else if kind != Kind::Character {
                    let name = match field.count {
                        Some(_) => format!("{prefix}{}[{index}]", field.name),
                        None => format!("{prefix}{}", field.name),
                    };
                    self.numbers.push(Number { name, kind, offset });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(formats: &[&str]) -> Result<Layout, String> {
        let formats = formats
            .iter()
            .map(|text| parse(text))
            .collect::<Result<_, _>>()?;
        Layout::of("top", &formats)
    }

    #[test]
    fn nested_formats_and_padding_are_laid_out() {
        let top = "top:uint64_t timestamp;inner[2] esc;uint8_t[4] _padding0;float[2] q;char[3] id;uint8_t[5] _padding1;";
        let layout = layout(&[top, "inner:int16_t rpm;uint8_t[2] _padding0;"]).unwrap();
        let numbers: Vec<_> = layout
            .numbers
            .iter()
            .map(|number| (number.name.as_str(), number.offset))
            .collect();
        assert_eq!(
            numbers,
            [
                ("esc[0].rpm", 8),
                ("esc[1].rpm", 12),
                ("q[0]", 20),
                ("q[1]", 24)
            ]
        );
        assert_eq!((layout.time, layout.least, layout.most), (Some(0), 31, 36));
    }

    #[test]
    fn what_cannot_be_laid_out_is_refused() {
        let refusal = |formats: &[&str]| layout(formats).unwrap_err();
        assert!(refusal(&["top:top x;"]).contains("nested"));
        assert!(refusal(&["top:gone x;"]).contains("no format `gone`"));
        assert!(refusal(&["top:char[70000] x;"]).contains("more fields"));
        // Formats without bytes, multiplied: must end soon, too.
        assert!(refusal(&["top:a[9999] x;", "a:b[9999] x;", "b:"]).contains("more fields"));
        assert!(refusal(&["top:uint8_t[-1] x;"]).contains("holds `uint8_t[-1] x`"));
    }

    #[test]
    fn numbers_have_their_signs() {
        assert_eq!(Kind::Signed(2).number(&[0xfe, 0xff, 7]), Some(-2.0));
        assert_eq!(Kind::Unsigned(2).number(&[0xfe, 0xff]), Some(65534.0));
        assert_eq!(Kind::Signed(8).number(&[0xff; 8]), Some(-1.0));
        assert_eq!(Kind::Float.number(&1.5f32.to_le_bytes()), Some(1.5));
        assert_eq!(Kind::Double.number(&[0; 7]), None);
    }
}
