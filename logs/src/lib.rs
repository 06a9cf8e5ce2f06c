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

/// Whether a text begins here with Latin letters, digits and signs in UTF-16, with its mark or without: every second byte is zero.
fn is_utf16(head: &[u8]) -> bool {
    let marked = head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff");
    let text = if marked { &head[2..] } else { head };
    let units = || text.as_chunks::<2>().0.iter().take(16);
    let zero = |side: usize| units().all(|unit| unit[side] == 0 && unit[1 - side] != 0);
    units().count() >= 4 && (zero(0) || zero(1))
}

/// Refuses a file, or the head of one, that no reader can read: without a byte, of zeros alone, as a card leaves them that lost its power, or text in
/// UTF-16.
///
/// # Errors
/// [`Error::Format`]: which of these.
pub fn refused(file: &str, bytes: &[u8]) -> Result<(), Error> {
    let problem = match bytes {
        [] => "the file is empty".to_owned(),
        bytes if bytes.iter().all(|byte| *byte == 0) => format!(
            "nothing but zeros in its first {} bytes: the file was made, and never written",
            bytes.len()
        ),
        bytes if is_utf16(bytes) => "text in UTF-16: save it as UTF-8".to_owned(),
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
    refused(&name, &bytes)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Each is refused with its reason, and what a reader may read is not.
    #[test]
    fn what_no_reader_reads_is_refused_with_its_reason() {
        let refusal = |bytes: &[u8]| refused("x.csv", bytes).err().map(|e| e.to_string());
        let text = "t,qw,qx,qy,qz\n0,1,0,0,0\n";
        assert_eq!(refusal(text.as_bytes()), None);
        let units = || text.encode_utf16();
        let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
        for (mark, text) in [(b"\xff\xfe", little), (b"\xfe\xff", big)] {
            for bytes in [&[&mark[..], &text].concat(), &text] {
                let refusal = refusal(bytes).expect("a refusal");
                assert!(refusal.contains("UTF-16: save it as UTF-8"), "{refusal}");
            }
        }
        assert!(refusal(b"").unwrap().contains("the file is empty"));
        assert!(refusal(&[0; 40]).unwrap().contains("nothing but zeros"));
        // A damaged log in binary.
        assert_eq!(refusal(b"\xff\xfe\0\x01\x02\0\0\x03\xa3\x95"), None);
    }
}
