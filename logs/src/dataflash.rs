//! ArduPilot's DataFlash logs, binary (`.bin`) and text (`.log`), after ArduPilot's own definition
//! (`libraries/AP_Logger/LogStructure.h` of ArduPilot/ardupilot) and MAVLink's reader (pymavlink's `DFReader.py`).
//!
//! A binary message is 0xA3, 0x95, a type, and the fields that an earlier `FMT` message states for the type. In text it is
//! a line `NAME, value, value, …`. `FMTU`, `UNIT` and `MULT` give units and multipliers. Columns come out in the unit
//! that the log names: the multiplier is applied.

mod binary;
mod format;
mod tables;
mod text;

use crate::{Error, Log};

/// Whether `bytes` begin as a DataFlash log does, binary or text.
#[must_use]
pub fn is_dataflash(bytes: &[u8]) -> bool {
    binary::begins(bytes) || text::begins(bytes)
}

/// Reads the DataFlash log `bytes`, called `file` in errors.
///
/// Each kind of message with a time (`TimeUS`, or `TimeMS` of old logs, and `T` of their `GPS`) becomes a topic. Of a
/// kind with an instance (a column of the unit `#`) each instance becomes one, with that instance's number. Text,
/// parameters and the messages that only describe others are left out. Damaged parts are passed over, and a note left.
///
/// # Errors
/// [`Error::Format`]: nothing in it is a DataFlash message, or no message has a time.
pub fn read(file: &str, bytes: &[u8]) -> Result<Log, Error> {
    let tables = if text::begins(bytes) {
        text::read(bytes)
    } else {
        binary::read(bytes)
    };
    if tables.is_empty() {
        let problem = "no DataFlash message found".into();
        return Err(Error::Format {
            file: file.into(),
            offset: 0,
            problem,
        });
    }
    tables.finish().not_empty(file)
}
