//! The built-in comparison: the guidance against the bare law that it flies.

use std::process::Command;
use std::sync::LazyLock;

use alula_study::{Cell, Flight, Outcome, Results, Source};

use crate::alula;

static FLOWN: LazyLock<Results> = LazyLock::new(|| {
    let source = Source::load("laws").unwrap();
    Results::of(&source.plan, None, || Ok(())).unwrap()
});

fn cell(variant: &str, condition: &str) -> &'static Cell {
    FLOWN.named(variant, condition).unwrap()
}

/// The only flight of a cell.
fn only(variant: &str, condition: &str) -> &'static Flight {
    let [flight] = &cell(variant, condition).flights[..] else {
        panic!("{variant}, {condition}: several seeds")
    };
    flight
}

fn command(folder: &std::path::Path, given: &[&str]) -> std::process::Output {
    alula(folder, &[&["compare"], given].concat())
}

#[test]
fn a_comparison_in_a_file_leaves_its_page_and_prints_json() {
    let folder = tempfile::tempdir().unwrap();
    let small = r#"
        base = "round-trip"
        charts = ["short"]
        [[variants]]
        name = "a"
        title = "as it is"
        [[conditions]]
        name = "short"
        title = "10 s"
        set = { duration_s = 10.0 }
    "#;
    std::fs::write(folder.path().join("small.toml"), small).unwrap();
    let run = |more: &[&str]| {
        let given = ["small.toml", "--json", "--out", "out"];
        command(folder.path(), &[&given, more].concat())
    };
    let output = run(&[]);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{stderr}");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["cells"][0]["variant"], "a");
    assert!(json["cells"][0]["flights"][0]["max_loss_out_m"].is_number());
    let html = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(html.contains("<svg") && html.contains("loss out, peak [m]"));

    let output = run(&["--set", "seed=1"]);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && stderr.contains("sets fields in its file"),
        "{stderr}"
    );
}

/// Each flies as it does alone, with the same field changed in both.
#[test]
fn experiments_are_flown_against_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let set = ["--set", "duration_s=12", "--json"];
    let given = [&["hover-to-cruise", "matched"], &set[..]].concat();
    let output = command(folder.path(), &given);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{stderr}");
    let page = folder
        .path()
        .join("out/compare-hover-to-cruise-matched/report.html");
    assert!(page.is_file());
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for (n, name) in ["hover-to-cruise", "matched"].iter().enumerate() {
        let cell = &json["cells"][n];
        assert_eq!(cell["variant"], *name);
        let alone = Command::new(env!("CARGO_BIN_EXE_alula-sil"))
            .current_dir(folder.path())
            .args(["fly", name])
            .args(set)
            .output()
            .unwrap();
        let alone: serde_json::Value = serde_json::from_slice(&alone.stdout).unwrap();
        for figure in [
            "max_loss_out_m",
            "max_cruise_error_m_s",
            "max_true_rate_rad_s",
        ] {
            assert_eq!(
                cell["flights"][0][figure], alone[figure],
                "{name}, {figure}"
            );
        }
    }
}

/// The range of altitude over the reference, out and back, is within `bound` m.
fn holds_altitude(variant: &str, condition: &str, bound: f64) {
    let altitude = only(variant, condition).altitude_m();
    assert!(altitude < bound, "{variant}, {condition}: {altitude}");
}

const LAGS: [&str; 4] = ["lag-0", "lag-50", "no-wind", "lag-150"];

/// Whatever the lag, up to 150 ms, the guidance stays within 1.1 m on the way out, and on the way back within 2 m, or 5 m at 150 ms
/// (measured 1.4 and 3.6 m); the paper's law alone is lost at each. When the vehicle turns to brake is decided by errors too
/// small to see: of 30 flights with 0.1° and 2 cm/s of noise 28 are within 1.5 m, and the worst loses 2.1 m; at 150 ms 23, and
/// the worst loses 3.6 m.
#[test]
fn the_papers_law_alone_is_lost_where_the_guidance_is_not() {
    for condition in LAGS {
        assert_eq!(only("paper", condition).outcome, Outcome::Departs);
        let ours = only("guidance", condition);
        assert_eq!(ours.outcome, Outcome::Flies);
        assert!(ours.get("max_cruise_error_m_s") < 0.03);
        assert!(ours.get("max_loss_out_m") < 1.0 && ours.get("max_gain_out_m") < 1.3);
        let bound = if condition == "lag-150" { 5.0 } else { 2.0 };
        holds_altitude("guidance", condition, bound);
    }
}

/// No seed of turbulence makes the guidance depart.
#[test]
fn turbulence_is_survived() {
    let cell = cell("guidance", "turbulence");
    assert_eq!(cell.flights.len(), 8);
    assert!(cell.outcome() < Outcome::Strays);
    assert!(cell.spread(Flight::altitude_m).1 < 8.0);
}
