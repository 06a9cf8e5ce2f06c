//! The built-in comparison: its page in docs/ is what is flown, and what the page claims is so.

use std::process::Command;
use std::sync::LazyLock;

use alula_sil::columns::write_trace;
use alula_sil::figures::Figures;
use alula_sil::page::{flight, markdown};
use alula_sil::simulate::fly;
use alula_sil::study::{Cell, Flight, Outcome, Results, Source};

static FLOWN: LazyLock<(Source, Results)> = LazyLock::new(|| {
    let source = Source::load("tail-sitter").unwrap();
    let results = Results::of(&source.plan, None, || Ok(())).unwrap();
    (source, results)
});

fn cell(policy: &str, condition: &str) -> &'static Cell {
    FLOWN.1.named(policy, condition).unwrap()
}

/// The only flight of a cell.
fn only(policy: &str, condition: &str) -> &'static Flight {
    let [flight] = &cell(policy, condition).flights[..] else {
        panic!("{policy}, {condition}: several seeds")
    };
    flight
}

/// The words of a page between its numbers, and the numbers.
fn parts(page: &str) -> (Vec<&str>, Vec<f64>) {
    let separators = |c: char| c.is_whitespace() || "|(),;…".contains(c);
    let (mut words, mut numbers) = (Vec::new(), Vec::new());
    for part in page.split(separators).filter(|p| !p.is_empty()) {
        match part.parse() {
            Ok(number) => numbers.push(number),
            Err(_) => words.push(part),
        }
    }
    (words, numbers)
}

/// Another platform's sines may round otherwise: numbers may differ by 0.2 or 5 %, words may not.
#[test]
fn the_page_is_what_the_command_writes() {
    let (source, results) = &*FLOWN;
    let written = markdown(&source.name, &source.plan.comparison, results).unwrap();
    let committed = include_str!("../../docs/comparison.md");
    let ((words, numbers), (old_words, old_numbers)) = (parts(&written), parts(committed));
    let advice = "run `cargo run --release -- compare --markdown docs/comparison.md`";
    assert_eq!(words, old_words, "{advice}");
    assert_eq!(numbers.len(), old_numbers.len(), "{advice}");
    for (new, old) in numbers.iter().zip(old_numbers) {
        let bound = 0.2_f64.max(0.05 * old.abs());
        assert!((new - old).abs() <= bound, "{new}, was {old}: {advice}");
    }
}

#[test]
fn the_command_leaves_its_page_and_prints_json() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("small.toml");
    let small = r#"
        base = "round-trip"
        charts = ["short"]
        discussion = "It loses {{ v.a.short['loss out'] }} m."
        [[policies]]
        name = "a"
        title = "as it is"
        [[conditions]]
        name = "short"
        title = "10 s"
        set = { duration_s = 10.0 }
    "#;
    std::fs::write(&file, small).unwrap();
    let run = |out: &str| {
        Command::new(env!("CARGO_BIN_EXE_alula-sil"))
            .current_dir(folder.path())
            .args(["compare", "small.toml", "--json", "--out", out])
            .args(["--markdown", "small.md"])
            .output()
            .unwrap()
    };
    let output = run("out");
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{stderr}");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let flight = &json["cells"][0]["flights"][0];
    assert_eq!(json["cells"][0]["policy"], "a");
    let loss = flight["loss_out_m"].as_f64().unwrap();
    let page = std::fs::read_to_string(folder.path().join("small.md")).unwrap();
    assert!(page.contains(&format!("It loses {loss:.1} m.")), "{page}");
    let html = std::fs::read_to_string(folder.path().join("out/compare.html")).unwrap();
    assert!(html.contains("<svg") && html.contains("loss out [m]"));

    std::fs::write(&file, small.replace("v.a.short", "v.b.short")).unwrap();
    let output = run("out");
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && stderr.starts_with("error: discussion"),
        "{stderr}"
    );
}

/// The range of altitude over the reference, out and back, is within `bound` m.
fn holds_altitude(policy: &str, condition: &str, bound: f64) {
    let altitude = only(policy, condition).altitude_m();
    assert!(altitude < bound, "{policy}, {condition}: {altitude}");
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
        let ours = only("bandwidth", condition);
        assert_eq!(ours.outcome, Outcome::Flies);
        assert!(ours.get("cruise_error_m_s") < 0.03);
        assert!(ours.get("loss_out_m") < 1.0 && ours.get("gain_out_m") < 1.3);
        let bound = if condition == "lag-150" { 5.0 } else { 2.0 };
        holds_altitude("bandwidth", condition, bound);
    }
}

/// Tuned switching policies hold altitude as well (measured 2.2 and 1.5 m at the worst lag, to 1.5); they brake far
/// longer (60 and 61 m ahead, to 3). At T/W 1.15 the ArduPilot-like loses 2.1 m, the guidance 0.2 m.
#[test]
fn tuned_switching_policies_hold_altitude_and_brake_longer() {
    for policy in ["px4-tuned", "ardupilot-tuned"] {
        for condition in LAGS {
            assert_eq!(only(policy, condition).outcome, Outcome::Flies);
            holds_altitude(policy, condition, 2.5);
            let ahead = |policy| only(policy, condition).get("ahead_m");
            assert!(ahead(policy) > 40.0 && ahead("bandwidth") < 5.0);
        }
    }
    holds_altitude("ardupilot-tuned", "weak", 3.0);
    holds_altitude("bandwidth", "weak", 1.5);
}

/// Cruise is reached within a second of the reference (measured 10.0 s, to 11.8 and 9.5 s), no more than 7 m ahead where the reference
/// brakes as drag allows (5 m to 28 and 38 m), with less altitude in an aborted transition (0.3 m to 1.6 and 0.8 m), 2 m ahead in a
/// glide that cannot be flown, to 795 and 213 m (3.1 m high, to 3.9 and 12.7 m), and less loss in turbulence on the way out, in the
/// median.
#[test]
fn one_law_follows_the_reference_through_the_transition() {
    let after = |policy| only(policy, "no-wind").get("cruise_after_s");
    let ahead = |policy| only(policy, "gentle").get("ahead_m");
    let loss = |policy| cell(policy, "turbulence").spread(|f| f.get("loss_out_m")).0;
    for policy in ["px4-tuned", "ardupilot-tuned"] {
        assert!((after("bandwidth") - 10.0).abs() < 1.0 && after("bandwidth") < after("px4-tuned"));
        assert!(ahead("bandwidth") < 7.0 && ahead(policy) > 15.0);
        let aborted = only(policy, "aborted").altitude_m();
        assert!(only("bandwidth", "aborted").altitude_m() < 0.5 * aborted);
        let (ours, theirs) = (only("bandwidth", "glide"), only(policy, "glide"));
        assert!(ours.altitude_m() < 10.0);
        assert!(ours.get("ahead_m") < 10.0 && theirs.get("ahead_m") > 100.0);
        assert!(loss("bandwidth") < loss(policy));
    }
}

/// Inside the stall band: measured ±0.3 m and 0.00 m/s for the guidance, ±0.2 m and 0.26 m/s for the PX4-like as a multicopter, ±1.0 m
/// and 0.16 m/s for the ArduPilot-like as an aeroplane.
#[test]
fn the_stall_band_is_flown() {
    for (policy, error, altitude) in [
        ("bandwidth", 0.02, 1.0),
        ("px4-tuned", 0.5, 1.0),
        ("ardupilot-tuned", 0.5, 1.5),
    ] {
        let flight = only(policy, "stall-band");
        assert_eq!(flight.outcome, Outcome::Flies);
        assert!(flight.get("cruise_error_m_s") < error);
        holds_altitude(policy, "stall-band", altitude);
    }
}

/// No seed of turbulence makes the guidance or a tuned policy depart.
#[test]
fn turbulence_is_survived() {
    for policy in ["bandwidth", "px4-tuned", "ardupilot-tuned"] {
        let cell = cell(policy, "turbulence");
        assert_eq!(cell.flights.len(), 8);
        assert!(cell.outcome() < Outcome::Strays);
        assert!(cell.spread(Flight::altitude_m).1 < 8.0);
    }
}

/// Stock back transitions begin at 20 m/s: the wing throws the vehicle up, by 21 and 46 m.
#[test]
fn stock_switching_policies_balloon() {
    assert!(only("px4-stock", "no-wind").get("gain_back_m") > 10.0);
    assert!(only("ardupilot-stock", "no-wind").get("gain_back_m") > 20.0);
}

/// ArduPlane 4.6.3 on this plant: stock it gains 50.6 m in the back transition, loses 0.9 m and gains 12 m on the way out; searched it
/// loses 0.4 and gains 0.7 m out, 0.2 and 2.5 m back. Here 46.5; 1.0 and 4.9; 1.6 and 1.3; 0.1 and 2.6 m.
#[test]
fn the_ardupilot_like_policy_is_like_the_real_program() {
    let stock = |figure| only("ardupilot-stock", "no-wind").get(figure);
    assert!((stock("gain_back_m") - 50.6).abs() < 6.0);
    assert!(stock("loss_out_m") < 2.0 && (3.0..15.0).contains(&stock("gain_out_m")));
    let searched = |figure| only("ardupilot-searched", "no-wind").get(figure);
    assert!((searched("gain_back_m") - 2.5).abs() < 1.0 && searched("loss_back_m") < 0.7);
    assert!(searched("loss_out_m") < 2.0 && searched("gain_out_m") < 2.0);
    // It stays where it comes to rest, and so ends high; with the searched parameters there is little to stay at.
    assert_eq!(only("ardupilot-stock", "no-wind").outcome, Outcome::Strays);
    assert_eq!(
        only("ardupilot-searched", "no-wind").outcome,
        Outcome::Flies
    );
}

#[test]
fn a_switching_policys_trace_names_its_phases() {
    let plan = Source::load("tail-sitter").unwrap().plan;
    for name in ["px4-tuned", "ardupilot-tuned"] {
        let mut policies = plan.comparison.policies.iter();
        let policy = policies.position(|p| p.name == name).unwrap();
        let experiment = &plan.experiments[0][policy][0];
        let record = fly(experiment).unwrap();
        let mut trace = Vec::new();
        write_trace(experiment, &record, &mut trace).unwrap();
        let mut trace = csv::Reader::from_reader(&trace[..]);
        let header = trace.headers().unwrap().clone();
        // Columns that only a law has are left out.
        assert!(header.iter().all(|name| name != "fp_n" && name != "air"));
        let column = |name: &str| header.iter().position(|h| h == name).unwrap();
        let mut modes = Vec::new();
        for record in trace.records() {
            let record = record.unwrap();
            modes.push(record[column("mode")].to_owned());
        }
        modes.dedup();
        let expected = [
            "hover",
            "front-transition",
            "cruise",
            "back-transition",
            "hover",
        ];
        assert_eq!(modes, expected, "{name}");
        let figures = Figures::of(experiment, &record);
        assert!(figures.get("safe_s") == 0.0 && figures.get("min_fp_n").is_nan());
        assert!(
            flight::figure(experiment, &record, &figures)
                .svg()
                .contains("</svg>")
        );
    }
}
