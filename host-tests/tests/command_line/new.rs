//! `alula-sil new`: from what a person knows to a vehicle that flies.

use std::fs;
use std::path::Path;
use std::process::Command;

use alula_sim::airframe::Airframe;
use alula_sim::experiment::Document;
use alula_study::{CampaignSource, Shard, Store, Summary, run};
use serde_json::Value;

use crate::alula;

/// A tail-sitter of 3 kg, as one would describe it.
const FLAGS: [&str; 20] = [
    "--mass-kg",
    "3",
    "--wing-m2",
    "0.35",
    "--section",
    "naca-0012",
    "--thrust-to-weight",
    "1.6",
    "--thrust-lag-s",
    "0.08",
    "--rate-lag-s",
    "0.06",
    "--cruise-m-s",
    "18",
    "--turn-rad-s2",
    "300",
    "--actuators",
    "both",
    "--drag-area-m2",
    "0.012",
];

/// The JSON of `new` with these arguments, and its folder.
fn made(folder: &Path, arguments: &[&str]) -> Value {
    let output = alula(folder, &[&["new", "--json"], arguments].concat());
    assert!(output.status.success(), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The files fly as they are: the round trip within a metre of altitude, 3 m ahead and 10 m behind, and of a hundred dispersed flights none is
/// lost. The whole campaign has a thousand.
#[test]
fn what_is_described_by_flags_flies() {
    let folder = tempfile::tempdir().unwrap();
    let summary = made(folder.path(), &FLAGS);
    let place = folder.path().join("my-vehicle");
    assert_eq!(summary["verdict"]["outcome"], "as-asked", "{summary}");
    let figure = |name: &str| summary["first_flight"][name].as_f64().unwrap();
    assert!(figure("max_loss_out_m") < 1.0 && figure("max_gain_out_m") < 1.0);
    assert!(figure("max_loss_back_m") < 0.6 && figure("max_gain_back_m") < 0.6);
    assert!(figure("max_ahead_m") < 3.0 && figure("forward_least_m") > -10.0);
    // It cruises on its wing, as level flight at that speed can, and not behind the stall with half of its weight on the thrust.
    let needed = summary["performance"]["cruise"][1].as_f64().unwrap();
    assert!(figure("cruise_mean_thrust_to_weight") < needed + 0.02 && needed < 0.15);
    // Everybody takes the file.
    let file = place.join("my-vehicle.toml");
    let name = file.to_str().unwrap();
    assert_eq!(Airframe::load(name).unwrap().spec.k_a_kg_m, 0.214375);
    for command in ["fly", "margins", "envelope", "sweep"] {
        let out = folder.path().join(command);
        let output = alula(
            folder.path(),
            &[command, name, "--out", out.to_str().unwrap()],
        );
        assert!(output.status.success(), "{command}: {output:?}");
    }

    let campaign = place.join("my-vehicle-campaign.toml");
    let source = CampaignSource::load(campaign.to_str().unwrap(), Some(100)).unwrap();
    let results = tempfile::tempdir().unwrap();
    let store = Store::open(results.path(), &source).unwrap();
    run(&source, &store, Shard::default(), None, || Ok(())).unwrap();
    let summary = Summary::of(&source, &store).unwrap();
    assert_eq!((summary.departed, summary.diverged), (0, 0));
    assert!(summary.verdict());
}

/// Every number has its reason beside it, and the file gives the parameters that the rules gave.
#[test]
fn the_file_says_why() {
    let folder = tempfile::tempdir().unwrap();
    made(folder.path(), &FLAGS);
    let text = fs::read_to_string(folder.path().join("my-vehicle/my-vehicle.toml")).unwrap();
    let (_, text) = text.split_once("[controller.guidance]").unwrap();
    for (name, reason) in alula::guidance::REASONS {
        let line = text
            .lines()
            .find(|line| line.starts_with(name))
            .expect(name);
        assert!(line.ends_with(reason), "{line}");
    }
    // Twice is refused: nothing is overwritten, unless that is said.
    let output = alula(folder.path(), &[&["new"][..], &FLAGS].concat());
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && message.contains("is there already: --force"),
        "{message}"
    );
    let output = alula(folder.path(), &[&["new", "--force"][..], &FLAGS].concat());
    assert!(output.status.success(), "{output:?}");
    // Numbers in other units end before anything is made.
    let mut grams = FLAGS;
    grams[1] = "3000";
    let output = alula(folder.path(), &[&["new", "grams"][..], &grams].concat());
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        !output.status.success() && message.contains("were these g? Then it is 3"),
        "{message}"
    );
    assert!(!folder.path().join("grams").exists());
}

/// A file of ten lines, a polar of XFOIL beside it, an aspect ratio; and the C code is C.
#[test]
fn a_file_and_a_polar_of_ones_own() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (-8..=16)
        .map(|a| {
            // A round stall from 10° on.
            let bend = f64::from(a - 10).max(0.0).powi(2);
            format!(
                "{a:8.3} {:8.4} {:9.5} 0.005 -0.09 1 1\n",
                0.45 + 0.105 * f64::from(a) - 0.0105 * bend,
                0.012
            )
        })
        .collect();
    let header = " Calculated polar for: NACA 4415\n\n   alpha    CL        CD       CDp       CM     Top_Xtr  Bot_Xtr\n  ------ -------- ---------\n";
    fs::write(folder.path().join("4415.txt"), format!("{header}{rows}")).unwrap();
    let known = "mass_kg = 1.2\nwing_m2 = 0.25\nsection = '4415.txt'\naspect_ratio = 6\nthrust_to_weight = 2\n\
                 thrust_lag_s = 0.05\nrate_lag_s = 0.05\ncruise_m_s = 14\nturn_rad_s2 = 300\nactuators = 'both'\n";
    fs::write(folder.path().join("known.toml"), known).unwrap();
    // A flag goes before the file.
    let summary = made(
        folder.path(),
        &["mine", "--from", "known.toml", "--mass-kg", "1.5"],
    );
    assert_eq!(summary["facts"]["mass_kg"], 1.5);
    assert!(
        summary["story"]
            .to_string()
            .contains("Viterna and Corrigan")
    );
    let polar = fs::read_to_string(folder.path().join("mine/polar.csv")).unwrap();
    assert!(polar.starts_with("# ") && polar.contains("\n-180,") && polar.contains("\n180,"));
    let document = Document::load(folder.path().join("mine/mine.toml").to_str().unwrap());
    assert!(document.unwrap().checked().is_ok());

    // The seam is drawn: given and extended have colours of their own.
    let picture = fs::read_to_string(folder.path().join("mine/report.svg")).unwrap();
    assert!(picture.contains("extended") && picture.contains("given"));
    // The combined model is odd in α: `fit` says that this is not, and leaves the table.
    let fit = |polar: &str| {
        let output = alula(folder.path(), &["fit", polar, "--out", "fit", "--json"]);
        assert!(output.status.success(), "{output:?}");
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    assert_eq!(fit("naca-0012-re-160e3")["suits"], true);
    assert_eq!(fit("4415.txt")["suits"], false);
    let page = fs::read_to_string(folder.path().join("fit/report.html")).unwrap();
    assert!(page.contains("DOES NOT SUIT") && page.contains("Viterna and Corrigan"));
    // The section's stall is met to 2°; that of the finite wing, with its gentler slope, is moved by 5°, and that is said.
    let of_section = ["fit", "naca-0012-re-160e3", "--out", "fit"];
    let said = |more: &[&str]| {
        let output = alula(folder.path(), &[&of_section, more].concat());
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(!said(&[]).contains("the model stalls"));
    assert!(
        said(&["--aspect-ratio", "4"]).contains("the model stalls at 17.8°, the table at 13.3°")
    );
    let table = Airframe::load(folder.path().join("fit/polar.csv").to_str().unwrap());
    assert!(table.is_ok(), "{:?}", table.err());

    let include = Path::new(env!("CARGO_MANIFEST_DIR")).join("../capi/include");
    let program = folder.path().join("program.c");
    fs::write(&program, "#include \"mine/vehicle.h\"\nint main(void) { static alula_controller c; static alula_table t; return vehicle_init(&c, &t); }\n").unwrap();
    let compiled = Command::new("cc")
        .args([
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-fsyntax-only",
            "-I",
        ])
        .arg(include)
        .arg(program)
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{compiled:?}");
}

/// A first flight that does not do what was asked: so it says on the page and in JSON, and the exit code is 1. Thrust of 1.1 times the weight
/// does not overcome a drag area of 0.05 m² at 40 m/s: no guidance reaches that.
#[test]
fn a_first_flight_that_fails_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let mut flags = FLAGS;
    (flags[7], flags[13], flags[19]) = ("1.1", "40", "0.05");
    // On a terminal it is said once.
    let short = [&["new", "short"], &flags[..]].concat();
    let output = alula(folder.path(), &short);
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8(said).unwrap();
    assert_eq!(said.matches("FIRST FLIGHT FAILS").count(), 1, "{said}");
    let output = alula(
        folder.path(),
        &[&short[..], &["--force", "--json"]].concat(),
    );
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        message.contains("THE FIRST FLIGHT FAILS: ") && message.contains("does not reach cruise"),
        "{message}"
    );
    assert!(
        message.contains("times the weight of thrust, and there is 1.1")
            && message.lines().count() == 1,
        "{message}"
    );
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["verdict"]["outcome"], "fails");
    assert!(summary["performance"]["stop_m"].is_null());
    let warnings = summary["warnings"].to_string();
    assert!(
        warnings.contains("The thrust is 1.1 times the weight"),
        "{warnings}"
    );
    let page = fs::read_to_string(folder.path().join("short/report.html")).unwrap();
    assert!(
        page.contains("THE FIRST FLIGHT FAILS")
            && page.contains("The thrust is 1.1 times")
            && page.contains("MORE than the 110 %")
    );
    // So does the page of that flight.
    let page = fs::read_to_string(folder.path().join("short/first-flight/report.html")).unwrap();
    assert!(page.contains("THE FIRST FLIGHT FAILS"));
    // Nor do flights like it pass its campaign.
    let campaign = alula(
        folder.path(),
        &["campaign", "short/short-campaign.toml", "--flights", "4"],
    );
    assert_eq!(campaign.status.code(), Some(1), "{campaign:?}");
    let text = String::from_utf8(campaign.stdout).unwrap();
    assert!(text.contains("NOT KEPT"), "{text}");
    // The command to fly one again is one that works from here.
    let line = text.lines().find(|line| line.contains("--refly")).unwrap();
    let (_, command) = line.split_once("alula-sil ").unwrap();
    let arguments: Vec<&str> = command.split_whitespace().collect();
    let again = alula(folder.path(), &arguments);
    assert!(again.status.success(), "{command}: {again:?}");
}

/// Two vehicles in one place have campaigns and flights of their own.
#[test]
fn vehicles_do_not_overwrite_each_other() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["one", "two"] {
        made(folder.path(), &[&[name][..], &FLAGS].concat());
        for command in [
            vec![
                "campaign".to_owned(),
                format!("{name}/{name}-campaign.toml"),
                "--flights".to_owned(),
                "2".to_owned(),
            ],
            vec!["fly".to_owned(), format!("{name}/{name}.toml")],
        ] {
            let arguments: Vec<&str> = command.iter().map(String::as_str).collect();
            let output = alula(folder.path(), &arguments);
            assert!(output.status.success(), "{output:?}");
        }
        assert!(
            folder
                .path()
                .join(format!("out/campaign-{name}-campaign/report.html"))
                .exists()
        );
        assert!(
            folder
                .path()
                .join(format!("out/{name}/report.html"))
                .exists()
        );
    }
}

/// A polar whose name holds what ends a comment, a line or a text: the files are TOML and C all the same. A vehicle of such a name is refused.
#[test]
fn names_do_not_break_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..=16)
        .map(|a| format!("{a} {} 0.012\n", 1.1 * (0.12 * f64::from(a)).sin()))
        .collect();
    // The end of a comment of C lies across a folder's name and the file's.
    let odd = "a\"b\\ */ int x = ;\nmass_kg = 1.txt";
    fs::create_dir(folder.path().join("a\"b\\ *")).unwrap();
    fs::write(folder.path().join(odd), format!("alpha CL CD\n{rows}")).unwrap();
    let mut flags = FLAGS;
    flags[5] = odd;
    made(folder.path(), &[&["odd"][..], &flags].concat());
    let document = Document::load(folder.path().join("odd/odd.toml").to_str().unwrap());
    let experiment = document.unwrap().checked().unwrap();
    assert_eq!(experiment.vehicle.mass_kg, 3.0);
    let include = Path::new(env!("CARGO_MANIFEST_DIR")).join("../capi/include");
    let compiled = Command::new("cc")
        .args([
            "-std=c99",
            "-Wall",
            "-Wno-unused-function",
            "-Werror",
            "-fsyntax-only",
            "-x",
            "c",
            "-I",
        ])
        .arg(include)
        .arg(folder.path().join("odd/vehicle.h"))
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{compiled:?}");
    for name in ["a\"b", "a\\b", "a\nb", "a b"] {
        let output = alula(folder.path(), &[&["new", name][..], &FLAGS].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(
            !output.status.success()
                && message.lines().count() == 1
                && message.contains("a name is of letters"),
            "{message}"
        );
    }
}

/// What is missing or wrong is named in one line, and nothing is asked where there is no terminal.
#[test]
fn what_is_wrong_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = |arguments: &[&str]| {
        let output = alula(folder.path(), &[&["new"], arguments].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(
            !output.status.success() && message.lines().count() == 1,
            "{message}"
        );
        message
    };
    assert!(error(&FLAGS[2..]).contains("mass_kg: is missing: --mass-kg"));
    assert!(
        error(&[&FLAGS[..], &["--control-rate-hz", "1"]].concat())
            .contains("control_rate_hz: 1 is not")
    );
    fs::write(folder.path().join("bad.toml"), "mass_kg = 3\nspan_m = 2\n").unwrap();
    assert!(error(&["--from", "bad.toml"]).contains("bad.toml:2: span_m: unknown field `span_m`"));
    fs::write(
        folder.path().join("bad.toml"),
        "mass_kg = 3\nwing_m2 = -1\n",
    )
    .unwrap();
    assert!(error(&["--from", "bad.toml"]).contains("bad.toml:2: wing_m2: -1 is not from"));
    let mut flags = FLAGS;
    flags[5] = "naca-9999";
    assert!(error(&flags).contains("naca-9999: neither a file nor a built-in section"));
}

/// Every command of docs/your-vehicle.md does what it says, in the order of the page.
#[test]
fn the_pages_commands_run() {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = fs::read_to_string(root.join("docs/your-vehicle.md")).unwrap();
    let flight = "examples/identification.toml";
    fs::create_dir(folder.path().join("examples")).unwrap();
    fs::copy(root.join(flight), folder.path().join(flight)).unwrap();
    let blocks = page
        .split("```sh\n")
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap());
    let lines: Vec<&str> = blocks.flat_map(str::lines).collect();
    assert!(lines.len() >= 5, "{lines:?}");
    for line in lines {
        let command = line.strip_prefix("cargo run --release -- ").expect(line);
        let arguments: Vec<&str> = command.split_whitespace().collect();
        let output = alula(folder.path(), &arguments);
        assert!(output.status.success(), "{line}: {output:?}");
    }
    // The examples in Rust and C are the vehicle of the page: `cargo run --example own_vehicle` flies what is left here, and so do the modules.
    for (file, example) in [
        ("vehicle.rs", "examples/own_vehicle"),
        ("vehicle.h", "capi/examples/px4/src/modules/alula_guidance"),
    ] {
        let place = root.join(example);
        let left = fs::read_to_string(folder.path().join("tail-sitter").join(file)).unwrap();
        assert_eq!(
            left,
            fs::read_to_string(place.join(file)).unwrap(),
            "{example}"
        );
    }
    // Limits that are edited afterwards are in the code that is made anew, and nothing else changes.
    let header = || fs::read_to_string(folder.path().join("tail-sitter/vehicle.h")).unwrap();
    let before = header();
    let edit = [
        "code",
        "tail-sitter/tail-sitter.toml",
        "--set",
        "controller.guidance.max_rate_rad_s=0.9",
    ];
    assert!(alula(folder.path(), &edit).status.success());
    let after = header();
    let changed: Vec<_> = before
        .lines()
        .zip(after.lines())
        .filter(|(a, b)| a != b)
        .collect();
    assert_eq!(changed.len(), 1, "{changed:?}");
    assert_eq!(changed[0].1.trim(), "p.guidance.max_rate = 0.9f;");
    for file in [
        "tail-sitter.toml",
        "report.html",
        "first-flight/report.html",
        "tail-sitter-campaign.toml",
        "vehicle.h",
        "vehicle.rs",
        "first-flight/view.html",
    ] {
        assert!(
            folder.path().join("tail-sitter").join(file).exists(),
            "{file}"
        );
    }
}

/// Cruise so near to the speed of transition that the guidance stays behind the stall is warned of, and the flight says so.
#[test]
fn a_cruise_near_the_stall_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let mut flags = FLAGS;
    flags[13] = "14";
    let summary = made(folder.path(), &flags);
    let warnings = summary["warnings"].to_string();
    assert!(
        warnings.contains("within 30 % of the speed of transition, 12.6 m/s"),
        "{warnings}"
    );
    let verdict = &summary["verdict"];
    assert_eq!(verdict["outcome"], "outside-goals");
    let findings = verdict["findings"].to_string();
    assert!(
        findings.contains("it cruises behind the stall"),
        "{findings}"
    );
}

/// A polar whose lift falls at 6° alone, told to stall at 12°, of infinite span: what the page says of a jump is what `envelope` says of the vehicle's file.
#[test]
fn the_page_and_the_envelope_agree_on_a_jump() {
    let folder = tempfile::tempdir().unwrap();
    let mut flags = FLAGS;
    flags[5] = "x.txt";
    for fall in [0.0, 0.12] {
        let lift = |a: f64| match a {
            a if a <= 6.0 => 0.1 * a,
            a => 0.6 - fall * (a - 6.0).min(1.0) + 0.04 * (a - 6.0),
        };
        let rows = (0..=48).map(|n| 0.25 * f64::from(n));
        let rows: String = rows.map(|a| format!("{a} {:.4} 0.02\n", lift(a))).collect();
        fs::write(folder.path().join("x.txt"), format!("alpha CL CD\n{rows}")).unwrap();
        let name = if fall > 0.0 { "falls" } else { "grows" };
        let told = ["new", name, "--stall-deg", "12"];
        let output = alula(folder.path(), &[&told[..], &flags].concat());
        let page = String::from_utf8(output.stdout).unwrap();
        let file = format!("{name}/{name}.toml");
        let output = alula(folder.path(), &["envelope", &file, "--json"]);
        let envelope: Value = serde_json::from_slice(&output.stdout).unwrap();
        let says = match envelope["jump_down"]["speed_m_s"].as_f64() {
            Some(speed) => format!("slowing down it jumps at {speed:.1} m/s, from α = 6.0°"),
            None => "hover becomes cruise without a jump".to_owned(),
        };
        assert_eq!(
            envelope["folds"].as_array().unwrap().is_empty(),
            fall == 0.0
        );
        assert!(page.contains(&says), "{says}: {page}");
    }
}

/// A vehicle whose elevons turn it slowly gets limits that they can follow, and is told that level braking is not for it: with the limits of a vehicle of
/// full authority, 2.8 rad/s and 37.5 rad/s², the flying wing of 0.2 kg fell 61 m.
#[test]
fn limits_follow_what_turns_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut flags = FLAGS;
    (flags[15], flags[17]) = ("17", "elevons");
    let output = alula(folder.path(), &[&["new", "--json"][..], &flags].concat());
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    // By the drag of its wing alone.
    assert!(
        summary["limits"]["level_stop_m"]
            .as_f64()
            .is_none_or(|long| long > 80.0)
    );
    assert!(summary["limits"]["hover_wind_m_s"].as_f64().unwrap() < 14.0);
    let file = folder.path().join("my-vehicle/my-vehicle.toml");
    let document = Document::load(file.to_str().unwrap()).unwrap();
    let limit = |name: &str| {
        document
            .number(&format!("controller.guidance.{name}"))
            .unwrap()
    };
    let (rate, slew) = (limit("max_rate_rad_s"), limit("max_slew_rad_s2"));
    assert!(
        (0.7..1.0).contains(&rate) && (7.0..12.5).contains(&slew),
        "{rate} {slew}"
    );
    assert!(
        error_of(folder.path(), &FLAGS[..14]).contains("turn_rad_s2: is missing: --turn-rad-s2")
    );
    assert!(error_of(folder.path(), &FLAGS[..16]).contains("actuators: is missing: --actuators"));
}

/// Where level braking is not for a vehicle, its round trip brakes in a climb: with level braking this one fails, far above its reference. One that turns still
/// less is told what was flown and does not fail, and not what belongs to another fault.
#[test]
fn the_first_flight_is_one_that_the_vehicle_can_fly() {
    let folder = tempfile::tempdir().unwrap();
    let mut flags = FLAGS;
    let mut summary = |turn: &'static str| -> Value {
        (flags[15], flags[17]) = (turn, "elevons");
        let output = alula(
            folder.path(),
            &[&["new", "--json", "--force"][..], &flags].concat(),
        );
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let some = summary("40");
    assert_eq!(some["verdict"]["outcome"], "as-asked", "{some}");
    let gain = some["first_flight"]["max_gain_back_m"].as_f64().unwrap();
    assert!(gain < 8.0, "{gain}");
    let story = some["story"].to_string();
    assert!(story.contains("braking in a climb of "), "{story}");
    let file = fs::read_to_string(folder.path().join("my-vehicle/my-vehicle.toml")).unwrap();
    assert!(file.contains("down_m_s = -"), "{file}");

    let little = summary("20");
    assert_eq!(little["verdict"]["outcome"], "fails", "{little}");
    let advice = little["verdict"]["advice"].to_string();
    assert!(
        advice.contains("30 rad/s² of turning in place of 20 (larger elevons"),
        "{advice}"
    );
    // And it is so.
    assert_ne!(summary("30")["verdict"]["outcome"], "fails");
    // What brakes level as was asked does so.
    (flags[15], flags[17]) = (FLAGS[15], FLAGS[17]);
    let all = made(folder.path(), &[&["--force"][..], &flags].concat());
    assert!(!all["story"].to_string().contains("climb"), "{all}");
}

/// The error of `new` with these arguments.
fn error_of(folder: &Path, arguments: &[&str]) -> String {
    let output = alula(folder, &[&["new"], arguments].concat());
    assert!(!output.status.success());
    String::from_utf8(output.stderr).unwrap()
}
