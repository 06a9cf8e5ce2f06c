//! The generated files that are committed are what the sources make.
#![cfg(not(target_os = "none"))]

#[path = "../generate/mod.rs"]
mod generate;

use alula_capi::{Kind, PARAMETERS};

#[test]
fn header_table_and_parameter_file_are_current() {
    for (path, text) in generate::files().unwrap() {
        let committed = std::fs::read_to_string(&path).unwrap();
        assert!(
            committed == text,
            "{} is not current: cargo run --package alula-capi --example generate",
            path.display()
        );
    }
}

/// What PX4 asks of parameters, and a check of the table's own.
#[test]
fn parameters_have_names_that_fit_and_defaults_in_range() {
    for (n, p) in PARAMETERS.iter().enumerate() {
        assert!(p.px4.len() <= 16 && p.px4.starts_with("ALU_"), "{}", p.px4);
        assert!(
            PARAMETERS[..n]
                .iter()
                .all(|q| q.name != p.name && q.px4 != p.px4)
        );
        assert!(p.min <= p.default && p.default <= p.max, "{}", p.name);
        assert!(p.meaning.ends_with('.'), "{}", p.name);
        if let Kind::Choice(choices) = p.kind {
            assert_eq!((p.min, p.max), (0.0, (choices.len() - 1) as f32));
        }
    }
}
