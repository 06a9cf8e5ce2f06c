//! Attacks on the core, on the boundaries around it and on every parser: each target takes any bytes, makes inputs of them, calls what it
//! attacks and checks what must hold.
//!
//! Each target is a plain function that returns the number of calls it made. `cargo fuzz` drives it with inputs chosen
//! by coverage, on nightly Rust; `regress` with the seed corpora and random inputs, on stable Rust. A violation is a panic.

pub mod axes;
pub mod bytes;
#[cfg(feature = "boundaries")]
pub mod capi;
pub mod equilibria;
#[cfg(feature = "files")]
pub mod files;
pub mod guidance;
pub mod laws;
#[cfg(feature = "boundaries")]
pub mod link;
pub mod mission;
pub mod tables;
pub mod vehicle;

/// A target: any bytes in, the number of calls out.
pub type Target = fn(&[u8]) -> u64;

/// Every target by its name.
pub const TARGETS: &[(&str, Target)] = &[
    ("guidance", guidance::run),
    ("mission", mission::run),
    ("laws", laws::run),
    ("equilibria", equilibria::run),
    ("tables", tables::run),
    ("axes", axes::run),
    #[cfg(feature = "boundaries")]
    ("link", link::run),
    #[cfg(feature = "boundaries")]
    ("capi", capi::run),
    #[cfg(feature = "files")]
    ("experiment", files::experiment),
    #[cfg(feature = "files")]
    ("vehicle", files::vehicle),
    #[cfg(feature = "files")]
    ("known", files::known),
    #[cfg(feature = "files")]
    ("comparison", files::comparison),
    #[cfg(feature = "files")]
    ("campaign", files::campaign),
    #[cfg(feature = "files")]
    ("replay", files::replay),
    #[cfg(feature = "files")]
    ("ulog", files::ulog),
    #[cfg(feature = "files")]
    ("mcap", files::mcap),
    #[cfg(feature = "files")]
    ("dataflash", files::dataflash),
    #[cfg(feature = "files")]
    ("csv", files::csv),
    #[cfg(feature = "files")]
    ("map", files::map),
    #[cfg(feature = "files")]
    ("polar", files::polar),
];

/// Panics unless every number is finite.
#[track_caller]
pub fn assert_finite(numbers: &[f32]) {
    assert!(numbers.iter().all(|x| x.is_finite()), "{numbers:?}");
}
