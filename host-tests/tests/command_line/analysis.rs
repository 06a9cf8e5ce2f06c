//! `envelope`, `equilibria`, `sweep`, `plans` and `fit` as a user meets them.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::alula;

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = alula(folder, arguments);
    assert!(output.status.success(), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn refused(folder: &Path, arguments: &[&str], parts: &[&str]) {
    let output = alula(folder, arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && output.stdout.is_empty());
    assert_eq!(message.lines().count(), 1, "{message}");
    for part in parts {
        assert!(message.contains(part), "{message:?} has no {part:?}");
    }
}

/// A sheet and a self-contained page with the same curves, and no more.
fn assert_pictures(folder: &Path, others: &[&str]) {
    let svg = fs::read_to_string(folder.join("report.svg")).unwrap();
    let html = fs::read_to_string(folder.join("report.html")).unwrap();
    assert!(svg.starts_with("<svg"));
    let curves = |text: &str| -> Vec<String> {
        let lines = text.lines().filter(|line| line.contains("data-name="));
        lines.map(str::to_owned).collect()
    };
    assert!(!curves(&svg).is_empty());
    assert_eq!(curves(&svg), curves(&html));
    assert!(!html.contains("src=") && !html.contains("<link") && !html.contains("@import"));
    let left = fs::read_dir(folder).unwrap().count();
    assert_eq!(left, 2 + others.len());
}

fn near(value: &Value, expected: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - expected).abs() < tolerance, "{value} {expected}");
}

#[test]
fn envelope_prints_folds_counts_jumps_and_cusps() {
    let folder = tempfile::tempdir().unwrap();
    let level = json(folder.path(), &["envelope", "paper", "--json"]);
    near(&level["folds"][0]["alpha_deg"], 11.155, 0.01);
    near(&level["folds"][1]["a"], 1.52879, 1e-4);
    // Of the paper's vehicle: sqrt(a m g / k_a).
    near(&level["folds"][1]["speed_m_s"], 15.236, 1e-3);
    let counts = level["counts"].as_array().unwrap();
    let n: Vec<u64> = counts.iter().map(|c| c["n"].as_u64().unwrap()).collect();
    assert_eq!(n, [1, 3, 1]);
    assert!(counts[2]["a_max"].is_null() && counts[0]["a_min"] == 0.0);
    near(&level["jump_up"]["from_alpha_deg"], 16.764, 0.01);
    near(&level["jump_up"]["to_alpha_deg"], 7.52, 0.01);
    near(&level["jump_down"]["a"], 1.30333, 1e-4);
    near(&level["cusps"][0]["epsilon_deg"], 56.87, 0.1);
    assert_pictures(&folder.path().join("out/envelope-paper"), &[]);

    let steep = json(
        folder.path(),
        &["envelope", "paper", "--climb-deg", "60", "--json"],
    );
    assert_eq!(steep["folds"].as_array().unwrap().len(), 0);
    assert!(steep["jump_up"].is_null() && steep["jump_down"].is_null());
    // g tan 30° forward is a climb of 30°, but for the weight.
    let arguments = ["envelope", "paper", "--accel", "5.66381", "--json"];
    let accelerating = json(folder.path(), &arguments);
    near(&accelerating["epsilon_deg"], 30.0, 1e-3);
    near(&accelerating["folds"][0]["a"], 0.998, 1e-3);

    let table = json(folder.path(), &["envelope", "naca-0021-re-160e3", "--json"]);
    assert_eq!(table["counts"].as_array().unwrap().len(), 5);
}

#[test]
fn equilibria_are_those_of_the_envelope() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["equilibria", "paper", "--velocity", "14.6,0,0", "--json"];
    let set = json(folder.path(), &arguments);
    let equilibria = set["equilibria"].as_array().unwrap();
    let branches: Vec<_> = equilibria
        .iter()
        .map(|e| e["branch"].as_str().unwrap())
        .collect();
    assert_eq!(branches, ["pi", "0", "pi", "0"]);
    assert!(equilibria.iter().all(|e| e["isolated"] == true));
    let plus: Vec<_> = equilibria
        .iter()
        .map(|e| e["in_theta_plus"] == true)
        .collect();
    assert_eq!(plus, [false, true, true, true]);
    // 11.155° − 8.61°.
    near(&equilibria[1]["fold_alpha_deg"], 2.54, 0.1);
    let met: Vec<_> = set["existence"]
        .as_array()
        .unwrap()
        .iter()
        .map(|a| a["met"] == true)
        .collect();
    assert_eq!(met, [true, false, false, true, false]);
    assert_pictures(&folder.path().join("out/equilibria-paper"), &[]);

    let arguments = [
        "equilibria",
        "large-angle",
        "--velocity",
        "8,0,-2",
        "--accel",
        "1,0,0",
        "--wind",
        "-3,0,0",
        "--json",
    ];
    assert_eq!(
        json(folder.path(), &arguments)["equilibria"]
            .as_array()
            .unwrap()
            .len(),
        2
    );
}

/// What no law alone can follow the guidance crosses on purpose, and is not told that it cannot.
#[test]
fn sweep_does_not_forbid_what_the_guidance_flies() {
    let folder = tempfile::tempdir().unwrap();
    for (experiment, expected) in [
        (
            "round-trip",
            "the guidance crosses what is listed on purpose",
        ),
        // One of the paper's law: what of it stands against the law, and who flies it.
        (
            "hover-to-cruise",
            "The guidance crosses such places on purpose: `new` makes it",
        ),
    ] {
        let output = alula(folder.path(), &["sweep", experiment]);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(expected), "{text}");
        // Digits that say something.
        assert!(text.lines().all(|line| !line.contains("99999")), "{text}");
    }
}

#[test]
fn sweep_finds_the_jump_of_the_papers_flight() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = json(folder.path(), &["sweep", "hover-to-cruise", "--json"]);
    assert_eq!(sweep["admissible"], false);
    assert_eq!(sweep["min_fp_n"], 80.0);
    let verdict = sweep["verdict"].as_str().unwrap();
    assert!(
        verdict.contains("crosses such places on purpose"),
        "{verdict}"
    );
    assert!(sweep["jumps"][0]["t_s"].to_string().len() <= 6, "{sweep}");
    near(&sweep["jumps"][0]["t_s"], 7.38, 0.02);
    assert_eq!(sweep["low_fp"].as_array().unwrap().len(), 1);
    assert_pictures(
        &folder.path().join("out/sweep-hover-to-cruise"),
        &["view.html"],
    );
    let climb = json(
        folder.path(),
        &["sweep", "large-angle", "--min-fp", "10", "--json"],
    );
    assert_eq!(climb["admissible"], true);
}

/// The plans of a braking, from and to when is asked; a law makes none.
#[test]
fn plans_says_what_was_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let braking = ["--from-s", "45", "--to-s", "46.2"];
    let plans = json(
        folder.path(),
        &[&["plans", "round-trip", "--json"], &braking[..]].concat(),
    );
    let choices = plans["choices"].as_array().unwrap();
    let number = |one: &Value, name: &str| one[name].as_f64().unwrap();
    for one in choices {
        assert!((45.0..=46.2).contains(&number(one, "t_s")), "{one}");
        assert!(number(one, "cost_s") < number(one, "in_force_s"), "{one}");
    }
    // Past the stall it brakes.
    let alpha = |one: &Value| one["alpha_deg"].as_f64();
    assert!(choices.iter().filter_map(alpha).any(|alpha| alpha > 40.0));
    assert_pictures(&folder.path().join("out/plans-round-trip"), &[]);
    refused(
        folder.path(),
        &["plans", "hover-to-cruise"],
        &["hover-to-cruise: no plan from 0 to 20 s", "a law none"],
    );
}

#[test]
fn fit_leaves_a_vehicle_that_the_others_take() {
    let folder = tempfile::tempdir().unwrap();
    let fitted = json(folder.path(), &["fit", "naca-0021-re-160e3", "--json"]);
    for key in [
        "c0",
        "c1",
        "c2",
        "c3",
        "alpha_bar_deg",
        "k_l",
        "k_d",
        "metric",
    ] {
        assert!(fitted[key].as_f64().unwrap() > 0.0, "{key}");
    }
    for key in ["errors_0_20", "errors_0_180"] {
        assert!(fitted[key]["rms_cl"].as_f64() <= fitted[key]["max_cl"].as_f64());
    }
    assert_eq!(fitted["folds_table"].as_array().unwrap().len(), 4);
    let out = folder.path().join("out/fit-naca-0021-re-160e3");
    assert_pictures(&out, &["vehicle.toml", "polar.csv"]);
    let vehicle = "out/fit-naca-0021-re-160e3/vehicle.toml";
    let envelope = json(folder.path(), &["envelope", vehicle, "--json"]);
    assert_eq!(envelope["folds"][0]["a"], fitted["folds"][0]["a"]);
}

/// The paper's flight with the table for the truth and for the belief: it is held, and the wing stalls on the way.
#[test]
fn a_table_flies() {
    let folder = tempfile::tempdir().unwrap();
    let table = "base = 'matched'\n[vehicle.aerodynamics.table]\npolar = 'naca-0021-re-160e3'\n\
                 [set]\n'controller.law.vehicle' = 'table-alone.toml'\n";
    fs::write(folder.path().join("table.toml"), table).unwrap();
    let alone = "base = 'paper'\n[vehicle.aerodynamics.table]\npolar = 'naca-0021-re-160e3'\n";
    fs::write(folder.path().join("table-alone.toml"), alone).unwrap();
    let figures = json(folder.path(), &["fly", "table.toml", "--json"]);
    // The belief is the truth, to single precision: the error left decays.
    near(&figures["final_velocity_error_m_s"], 0.0, 1e-3);
    // c_L cos α + c_D sin α = m g/(k_a v²) at 20 m/s and 4°, near enough the lift: c_L = 0.38, by its row.
    near(&figures["final_alpha_deg"], 4.0, 0.05);
}

/// `margins` counts the experiment's own lags and says so; `--bare` leaves them out. It takes every file that describes a vehicle.
#[test]
fn margins_say_what_they_include() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let arguments = [&["margins", "--json", "--speeds", "0"], arguments].concat();
        json(folder.path(), &arguments)
    };
    let own = run(&["round-trip"]);
    let said = own["included"].as_str().unwrap();
    assert!(said.contains("a rate loop of 0.1 s, a thrust lag of 0.05 s, a delay of 0 s"));
    let bare = run(&["round-trip", "--bare"]);
    assert!(bare["included"].as_str().unwrap().contains("no lag"));
    let delay = |of: &Value| of["loops"][0]["points"][0]["delay_s"].as_f64().unwrap();
    near(&Value::from(delay(&bare)), 0.179, 1e-3);
    assert!(delay(&own) < delay(&bare) - 0.05);
    // More lag bears less delay.
    let slower = run(&[
        "round-trip",
        "--set",
        "plant.rate_loop.lag.time_constant_s=0.2",
    ]);
    assert!(delay(&slower) < delay(&own));
    assert_eq!(run(&["paper"])["vehicle"], "paper");
    let polar = concat!(env!("CARGO_MANIFEST_DIR"), "/data/naca-0021-re-5e6.csv");
    assert_eq!(run(&[polar])["vehicle"], "naca-0021-re-5e6");
}

#[test]
fn bad_files_and_arguments_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("bad.csv"), "alpha_deg,cl,cd\n0,0,0.1\n90,x,1\n").unwrap();
    fs::write(path.join("bad.toml"), "[vehicle]\nmass_kg = 1\n").unwrap();
    refused(path, &["envelope", "nonesuch"], &["nonesuch", "paper"]);
    refused(path, &["envelope", "bad.csv"], &["bad.csv:3", "\"x\""]);
    refused(
        path,
        &["envelope", "bad.toml"],
        &["bad.toml:1: vehicle: missing field `k_a_kg_m`"],
    );
    refused(path, &["envelope", "missing.csv"], &["missing.csv"]);
    refused(
        path,
        &["envelope", "paper", "--climb-deg", "91"],
        &["--climb-deg"],
    );
    refused(path, &["envelope", "paper", "--accel", "nan"], &["--accel"]);
    refused(
        path,
        &["envelope", "paper", "--accel", "1", "--climb-deg", "1"],
        &["--accel", "--climb-deg"],
    );
    refused(path, &["equilibria", "paper"], &["--velocity"]);
    refused(
        path,
        &["equilibria", "paper", "--velocity", "1"],
        &["--velocity", "NORTH,EAST,DOWN"],
    );
    refused(
        path,
        &["equilibria", "paper", "--velocity", "-2,8"],
        &["--velocity", "is now 8,0,-2"],
    );
    refused(
        path,
        &["equilibria", "paper", "--velocity", "8,1,-2"],
        &["--velocity", "EAST must be 0"],
    );
    refused(
        path,
        &["equilibria", "paper", "--velocity", "inf,0,1"],
        &["--velocity", "\"inf\""],
    );
    refused(
        path,
        &["equilibria", "paper", "--velocity", "1e9,0,0"],
        &["reference velocity"],
    );
    refused(
        path,
        &["sweep", "nonesuch"],
        &["nonesuch", "hover-to-cruise"],
    );
    refused(path, &["sweep", "matched", "--min-fp=-1"], &["--min-fp"]);
    refused(path, &["fit", "bad.csv"], &["bad.csv:3"]);
    // What was refused has left no result.
    assert!(!path.join("out/fit-bad").exists());
}
