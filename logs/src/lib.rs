//! Flight logs as tables over time.
//!
//! A [`Log`] holds [`Topic`]s; a topic holds named [`Column`]s of numbers over one time base in seconds. The crate
//! knows nothing of controllers or vehicles.
//!
//! - Readers: [`csv`] (any columns, through a map), [`ulog`] (PX4), [`dataflash`] (ArduPilot's `.bin` and `.log`), [`mcap`] (JSON messages).
//!   They take any bytes and never panic. What a reader had to leave out of a damaged file is said in [`Log::notes`].
//! - Writers: [`ulog`], [`mcap`], [`csv`].
//! - [`states`] finds attitude, velocity, position, wind and set-points under the names that PX4 and ArduPilot give them,
//!   on one time base, and names what is missing.
//!
//! ```
//! use alula_logs::{Column, Log, Topic, ulog};
//!
//! let x = Column::new("x", "m", vec![1.0, 2.0]);
//! let position = Topic::new("position", 0, vec![0.5, 1.0], vec![x])?;
//! let log = Log { topics: vec![position], notes: Vec::new() };
//! let mut file = Vec::new();
//! ulog::write(&log, &mut file)?;
//! assert_eq!(ulog::read("file", &file)?, log);
//! # Ok::<(), alula_logs::Error>(())
//! ```
//!
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]
#![forbid(unsafe_code)]

pub mod csv;
pub mod dataflash;
mod error;
mod fields;
mod log;
pub mod mcap;
pub mod states;
pub mod ulog;

pub use error::Error;
pub use log::{Column, Held, Log, Topic};

use std::path::Path;

/// Whether the file `path`, which begins with `head`, is a log of topics: ULog, MCAP, or DataFlash (binary or text; also if the name ends
/// in `.bin`). Else it is taken for CSV.
#[must_use]
pub fn is_autopilots(path: &Path, head: &[u8]) -> bool {
    let bin = path.extension().is_some_and(|e| e == "bin");
    bin || ulog::is_ulog(head) || mcap::is_mcap(head) || dataflash::is_dataflash(head)
}

/// Refuses a file, or the head of one, that holds nothing: no byte, or zeros alone, as a card leaves them that lost its power.
///
/// # Errors
/// [`Error::Format`]: that.
pub fn blank(file: &str, bytes: &[u8]) -> Result<(), Error> {
    let problem = match bytes {
        [] => "the file is empty".to_owned(),
        bytes if bytes.iter().all(|byte| *byte == 0) => format!(
            "nothing but zeros in its first {} bytes: the file was made, and never written",
            bytes.len()
        ),
        _ => return Ok(()),
    };
    Err(Error::Format {
        file: file.into(),
        offset: 0,
        problem,
    })
}

/// The log in the file `path`, of whatever kind its first bytes say that it is: ULog, MCAP, DataFlash, else CSV with every column as it
/// stands.
///
/// # Errors
/// The file cannot be read, or the reader of its kind refuses it.
pub fn read(path: &Path) -> Result<Log, Error> {
    let bytes = error::read_file(path)?;
    let name = path.display().to_string();
    blank(&name, &bytes)?;
    if ulog::is_ulog(&bytes) {
        ulog::read(&name, &bytes)
    } else if mcap::is_mcap(&bytes) {
        mcap::read(&name, &bytes)
    } else if is_autopilots(path, &bytes) {
        dataflash::read(&name, &bytes)
    } else {
        csv::read(&name, &bytes, None)
    }
}
