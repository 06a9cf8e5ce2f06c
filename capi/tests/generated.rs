//! The generated files that are committed are what the sources make.
#![cfg(not(target_os = "none"))]

#[path = "../generate/mod.rs"]
mod generate;

use alula::Range;
use alula::guidance::Status;
use alula_capi::{CHOICES, SECTIONS};

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

/// The header has every status flag of the core, with the core's bit.
#[test]
fn the_header_has_every_status_flag() {
    let header = concat!(env!("CARGO_MANIFEST_DIR"), "/include/alula.h");
    let header = std::fs::read_to_string(header).unwrap();
    let names: Vec<_> = Status::all().iter_names().collect();
    assert_eq!(names.len() as u32, Status::all().bits().count_ones());
    for (name, flag) in names {
        let line = format!("#define ALULA_STATUS_{name} {}", flag.bits());
        assert!(header.lines().any(|l| l == line), "{line}");
    }
}

/// PX4's own demands on names, and that no name is given twice.
#[test]
fn parameters_have_names_that_fit_and_meanings() {
    let rows: Vec<_> = SECTIONS.iter().flat_map(|section| section.rows).collect();
    for (n, p) in rows.iter().enumerate() {
        assert!(p.px4.len() <= 16 && p.px4.starts_with("ALU_"), "{}", p.px4);
        assert!(rows[..n].iter().all(|q| q.px4 != p.px4), "{}", p.px4);
        assert!(p.meaning.ends_with('.'), "{}", p.name);
        let range = Range {
            name: p.name,
            unit: p.unit,
            min: p.min,
            max: p.max,
        };
        assert!(p.default.is_nan() || range.check(p.default).is_ok());
    }
    for (n, p) in SECTIONS[0].rows.iter().enumerate().take(CHOICES) {
        let choices = generate::choices(&SECTIONS[0], n).unwrap();
        assert_eq!((p.min, p.max), (0.0, (choices.len() - 1) as f32));
    }
}

/// PX4's build ends at a short description that is longer than it takes.
#[test]
fn px4_takes_every_short_description() {
    let files = generate::files().unwrap();
    let (_, yaml) = files
        .iter()
        .find(|(path, _)| path.ends_with("module.yaml"))
        .unwrap();
    let mut shorts = 0;
    for line in yaml.lines() {
        if let Some(short) = line.trim().strip_prefix("short: ") {
            shorts += 1;
            assert!(
                short.trim_matches('"').chars().count() <= generate::PX4_SHORT,
                "{short}"
            );
        }
    }
    let rows: usize = SECTIONS.iter().map(|section| section.rows.len()).sum();
    assert_eq!(shorts, rows);
}

/// Every code that the header names has a text of its own.
#[test]
fn every_code_has_a_text_of_its_own() {
    let header = concat!(env!("CARGO_MANIFEST_DIR"), "/include/alula.h");
    let header = std::fs::read_to_string(header).unwrap();
    let text = |code: i32| {
        // SAFETY: `alula_strerror` gives a text for every code.
        let text = unsafe { std::ffi::CStr::from_ptr(alula_capi::alula_strerror(code)) };
        text.to_str().unwrap()
    };
    let mut seen = std::collections::HashSet::from(["unknown code", text(0)]);
    assert_eq!((seen.len(), text(1)), (2, "unknown code"));
    let mut named = 0;
    for line in header.lines() {
        let code = line.strip_prefix("#define ALULA_ERROR_");
        if let Some((_, code)) = code.and_then(|rest| rest.split_once(' ')) {
            assert!(seen.insert(text(code.parse().unwrap())), "{line}");
            named += 1;
        }
    }
    assert!(named > 30, "{named}");
}

/// The page gives the sizes of the structures that are large.
#[test]
fn the_page_has_the_sizes_of_structures() {
    use alula_capi::{Controller, EquilibriumSet, Map, Mission, Table};
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/integrating.md");
    let page = std::fs::read_to_string(page).unwrap();
    let line = page.lines().find(|line| line.starts_with("Structures: "));
    let line = line.unwrap();
    for (name, size) in [
        ("alula_controller` ", size_of::<Controller>()),
        ("alula_fold_map` ", size_of::<Map>()),
        ("alula_table` ", size_of::<Table>()),
        ("alula_mission` ", size_of::<Mission>()),
        ("alula_equilibria` ", size_of::<EquilibriumSet>()),
    ] {
        let (_, after) = line.split_once(name).unwrap();
        let said: String = after.chars().take_while(char::is_ascii_digit).collect();
        assert_eq!(said, size.to_string(), "{name}");
    }
}
