//! What errors say. Shared by the unit tests of the crates.

use std::path::Path;

/// Why `load` refuses the file `path` with this text, which is one line.
pub fn refusal<T: std::fmt::Debug>(
    path: &Path,
    text: &str,
    load: impl FnOnce(&Path) -> anyhow::Result<T>,
) -> String {
    std::fs::write(path, text).unwrap();
    let error = format!("{:#}", load(path).unwrap_err());
    assert_eq!(error.lines().count(), 1, "{error}");
    error
}

/// `text` must hold each of the `parts`.
#[track_caller]
pub fn says(text: &str, parts: &[&str]) {
    assert!(parts.iter().all(|part| text.contains(part)), "{text}");
}

/// `text` must begin so.
#[track_caller]
pub fn begins(text: &str, start: &str) {
    assert!(text.starts_with(start), "{text}");
}
