//! Attacks on the core: each target takes any bytes, makes inputs of them, calls the core and checks what must hold.
//!
//! Each target is a plain function that returns the number of core calls it made. `cargo fuzz` drives it with inputs chosen
//! by coverage, on nightly Rust; `regress` with the seed corpora and random inputs, on stable Rust. A violation is a panic.

pub mod axes;
pub mod bytes;
pub mod equilibria;
pub mod guidance;
pub mod laws;
pub mod tables;
pub mod vehicle;

/// A target: any bytes in, the number of core calls out.
pub type Target = fn(&[u8]) -> u64;

/// Every target by its name.
pub const TARGETS: [(&str, Target); 5] = [
    ("guidance", guidance::run),
    ("laws", laws::run),
    ("equilibria", equilibria::run),
    ("tables", tables::run),
    ("axes", axes::run),
];

/// Panics unless every number is finite.
#[track_caller]
pub fn assert_finite(numbers: &[f32]) {
    assert!(numbers.iter().all(|x| x.is_finite()), "{numbers:?}");
}
