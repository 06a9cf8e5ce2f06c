//! What a `FMT` message states: the fields of a kind of message.

/// A field of one letter of the format, and the numbers in it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub label: String,
    /// The letter.
    pub kind: u8,
    /// Where it begins after the three bytes of the header.
    pub offset: usize,
}

/// One kind of message.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Format {
    pub name: String,
    pub fields: Vec<Field>,
    /// Bytes after the header.
    pub size: usize,
}

/// Number of elements of the letter `a`.
const ELEMENTS: usize = 32;

impl Format {
    /// The format of `name`, its letters in `kinds`, its columns in `labels`.
    ///
    /// # Errors
    /// In words: a letter that is not known, another number of labels than of letters.
    pub(super) fn new(name: &str, kinds: &str, labels: &str) -> Result<Self, String> {
        if name.is_empty() || !name.bytes().all(|b| b.is_ascii_graphic()) {
            return Err("a format without a name".into());
        }
        let labels: Vec<&str> = labels
            .split(',')
            .map(str::trim)
            .filter(|label| !label.is_empty())
            .collect();
        if labels.len() != kinds.len() {
            return Err(format!(
                "{name}: {} fields with {} names",
                kinds.len(),
                labels.len()
            ));
        }
        let mut offset = 0;
        let mut fields = Vec::new();
        for (kind, label) in kinds.bytes().zip(labels) {
            let size = size(kind)
                .ok_or_else(|| format!("{name}: no field is `{}`", kind.escape_ascii()))?;
            fields.push(Field {
                label: label.into(),
                kind,
                offset,
            });
            offset += size;
        }
        Ok(Self {
            name: name.into(),
            fields,
            size: offset,
        })
    }

    /// The place of the field `label`.
    pub(super) fn place(&self, label: &str) -> Option<usize> {
        self.fields.iter().position(|field| field.label == label)
    }
}

impl Field {
    /// Numbers in the field: none in text, 32 in an array.
    pub(super) fn numbers(&self) -> usize {
        match self.kind {
            b'n' | b'N' | b'Z' => 0,
            b'a' => ELEMENTS,
            _ => 1,
        }
    }

    /// Whether the letter itself fixes the scale, so that no multiplier applies.
    pub(super) fn is_scaled(&self) -> bool {
        matches!(self.kind, b'c' | b'C' | b'e' | b'E' | b'L')
    }

    /// The bytes of the field in a message without its header.
    pub(super) fn bytes<'a>(&self, message: &'a [u8]) -> Option<&'a [u8]> {
        message.get(self.offset..self.offset + size(self.kind)?)
    }

    /// Number `element` of the field in a message without its header, in the unit that the letter implies.
    pub(super) fn number(&self, message: &[u8], element: usize) -> Option<f64> {
        let bytes = self.bytes(message)?;
        let i16 = |at| Some(i16::from_le_bytes(array(bytes, at)?));
        let u16 = || Some(u16::from_le_bytes(array(bytes, 0)?));
        let i32 = || Some(i32::from_le_bytes(array(bytes, 0)?));
        let u32 = || Some(u32::from_le_bytes(array(bytes, 0)?));
        Some(match self.kind {
            b'b' => i8::from_le_bytes(array(bytes, 0)?).into(),
            b'B' | b'M' => u8::from_le_bytes(array(bytes, 0)?).into(),
            b'h' => i16(0)?.into(),
            b'a' => i16(2 * element)?.into(),
            b'H' => u16()?.into(),
            b'i' => i32()?.into(),
            b'I' => u32()?.into(),
            b'q' => i64::from_le_bytes(array(bytes, 0)?) as f64,
            b'Q' => u64::from_le_bytes(array(bytes, 0)?) as f64,
            b'g' => half(u16()?),
            b'f' => f32::from_le_bytes(array(bytes, 0)?).into(),
            b'd' => f64::from_le_bytes(array(bytes, 0)?),
            b'c' => f64::from(i16(0)?) / 100.0,
            b'C' => f64::from(u16()?) / 100.0,
            b'e' => f64::from(i32()?) / 100.0,
            b'E' => f64::from(u32()?) / 100.0,
            b'L' => f64::from(i32()?) / 1e7,
            _ => return None,
        })
    }

    /// The text of the field in a message without its header, up to the first zero.
    pub(super) fn text(&self, message: &[u8]) -> Option<String> {
        let bytes = self.bytes(message)?.split(|&b| b == 0).next()?;
        Some(String::from_utf8_lossy(bytes).trim().into())
    }
}

fn array<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at + N)?.try_into().ok()
}

/// Bytes of a field.
fn size(kind: u8) -> Option<usize> {
    Some(match kind {
        b'b' | b'B' | b'M' => 1,
        b'h' | b'H' | b'c' | b'C' | b'g' => 2,
        b'i' | b'I' | b'e' | b'E' | b'L' | b'f' | b'n' => 4,
        b'q' | b'Q' | b'd' => 8,
        b'N' => 16,
        b'Z' | b'a' => 64,
        _ => return None,
    })
}

/// A number of half precision (IEEE 754 binary16): sign, 5 bits of exponent, 10 of fraction.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    sign * match i32::from(bits >> 10 & 0x1f) {
        0 => fraction * f64::powi(2.0, -14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        exponent => (1.0 + fraction) * f64::powi(2.0, exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_is_read_at_its_place() {
        let format = Format::new("T", "bhQcLfga", "A,B,C,D,E,F,G,H").unwrap();
        assert_eq!(format.size, 1 + 2 + 8 + 2 + 4 + 4 + 2 + 64);
        let mut message = vec![0xff];
        message.extend((-2i16).to_le_bytes());
        message.extend(3u64.to_le_bytes());
        message.extend((-450i16).to_le_bytes());
        message.extend(473_977_000i32.to_le_bytes());
        message.extend(1.5f32.to_le_bytes());
        message.extend(0xc000u16.to_le_bytes());
        message.extend((0..32i16).flat_map(i16::to_le_bytes));
        let numbers: Vec<f64> = format
            .fields
            .iter()
            .map(|f| f.number(&message, 0).unwrap())
            .collect();
        assert_eq!(numbers, [-1.0, -2.0, 3.0, -4.5, 47.3977, 1.5, -2.0, 0.0]);
        assert_eq!(format.fields[7].number(&message, 31), Some(31.0));
        assert_eq!(format.fields[7].number(&message[..70], 31), None);
    }

    #[test]
    fn half_precision_reaches_all_its_kinds() {
        // 2⁻²⁴, the least; 65504, the greatest: IEEE 754-2019, table 3.5.
        assert_eq!(half(1), 2f64.powi(-24));
        assert_eq!(half(0x7bff), 65504.0);
        assert_eq!(half(0xfc00), f64::NEG_INFINITY);
        assert!(half(0x7c01).is_nan());
    }

    #[test]
    fn formats_that_contradict_themselves_are_refused() {
        let refusal = |name, kinds, labels| Format::new(name, kinds, labels).unwrap_err();
        assert!(refusal("T", "Qf", "TimeUS").contains("2 fields with 1 names"));
        assert!(refusal("T", "Q?", "TimeUS,X").contains("no field is `?`"));
        assert!(refusal("", "Q", "TimeUS").contains("without a name"));
    }
}
