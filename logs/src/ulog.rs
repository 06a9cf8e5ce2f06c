//! PX4's ULog, read and written after the published format
//! (<https://docs.px4.io/main/en/dev_log/ulog_file_format>, read at PX4/PX4-user_guide `en/dev_log/ulog_file_format.md`).
//!
//! A file is a header of 16 bytes and messages: size (`u16`, little endian, without these three bytes), type (a letter),
//! payload. Formats (`F`) name the fields of a message, subscriptions (`A`) give a format and an instance a number, data
//! (`D`) carries that number and the fields. ULog has no place for units. Written files carry them as information
//! messages (`M`) `units` with values `topic.field=unit`, which [`read`] takes back and other readers show or pass over.

mod format;
mod read;
mod write;

pub use read::read;
pub use write::write;

/// What a file begins with.
const MAGIC: [u8; 7] = [0x55, 0x4c, 0x6f, 0x67, 0x01, 0x12, 0x35];
/// What a synchronisation message carries, to be searched for after damage.
const SYNC: [u8; 8] = [0x2f, 0x73, 0x13, 0x20, 0x25, 0x0c, 0xbb, 0x12];
/// Key of the information messages that carry units.
const UNITS: &str = "units";

/// Whether `bytes` begin as a ULog file does.
#[must_use]
pub fn is_ulog(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}
