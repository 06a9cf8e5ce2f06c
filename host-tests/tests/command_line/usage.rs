//! The command line as a user meets it.

use std::collections::BTreeSet;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use alula_sim::experiment::BUILT_IN;
use serde_json::Value;

use crate::{alula, text};

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).unwrap();
    entries
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect()
}

/// Fails with one line on standard error that starts and goes on as given, and says nothing else.
fn assert_refused(output: &Output, parts: &[&str]) {
    let message = text(&output.stderr);
    assert!(
        !output.status.success() && output.stdout.is_empty(),
        "{output:?}"
    );
    assert_eq!(message.lines().count(), 1, "{message}");
    for part in parts {
        assert!(message.contains(part), "{message:?} has no {part:?}");
    }
}

/// A bound on what was not flown, here a way back, is no bound kept.
#[test]
fn a_bound_without_a_value_is_not_judged() {
    let folder = tempfile::tempdir().unwrap();
    let flown = |more: &str| {
        let words = format!("fly hover-to-cruise --set bounds.max_loss_back_m=1{more}");
        let words: Vec<&str> = words.split(' ').collect();
        text(&alula(folder.path(), &words).stdout)
    };
    let table = flown("");
    let line = table
        .lines()
        .find(|line| line.contains("loss back"))
        .unwrap();
    assert!(
        line.contains("none") && line.ends_with("at most 1: not judged"),
        "{line}"
    );
    let json: Value = serde_json::from_str(&flown(" --json")).unwrap();
    assert!(json["max_loss_back_m"].is_null() && json["bounds_kept"] == false);
    // Until the way back, and one that is flown.
    let kept = flown(" --set bounds={max_loss_out_m=1e3} --json");
    let json: Value = serde_json::from_str(&kept).unwrap();
    assert!(json["max_loss_out_m"].is_number() && json["bounds_kept"] == true);
}

#[test]
fn without_arguments_the_default_is_flown_and_leaves_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let output = alula(folder.path(), &[]);
    let stdout = text(&output.stdout);
    assert!(output.status.success(), "{output:?}");
    // No progress bar where there is no terminal.
    assert_eq!(text(&output.stderr), "");
    assert!(stdout.contains("velocity error, peak"), "{stdout}");
    // The last line says what to look at: the mission, moving. It is steered where the program has the library for browsers, which those that
    // are not optimised have not; else the line before says how to have it.
    let steered = folder.path().join("out/fly/view.html").exists();
    let last = stdout.lines().last().unwrap();
    let page = if steered { "fly" } else { "mission" };
    assert_eq!(last, format!("open out/{page}/view.html"), "{stdout}");
    let how = "not to be steered: this program was built without the library for browsers: `rustup target add wasm32-unknown-unknown`";
    assert_eq!(stdout.contains(how), !steered, "{stdout}");
    let live = alula(folder.path(), &["view", "--live"]);
    assert_eq!(live.status.success(), steered, "{live:?}");

    let out = folder.path().join("out/hover-to-cruise");
    let expected = ["report.html", "report.svg", "trace.csv", "view.html"].map(String::from);
    assert_eq!(names(&out), BTreeSet::from(expected.clone()));
    assert_eq!(
        names(&folder.path().join("out/mission")),
        BTreeSet::from(expected)
    );

    let trace = fs::read_to_string(out.join("trace.csv")).unwrap();
    assert_eq!(trace.lines().count(), 20_002);
    assert!(
        trace.starts_with("t_s,north_m,east_m,down_m,v_north_m_s,"),
        "{trace:.200}"
    );

    let report = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("<svg") && report.contains("k_a_kg_m = 0.646"));
    // Self-contained: nothing is fetched.
    assert!(!report.contains("src=") && !report.contains("<link") && !report.contains("@import"));
}

#[test]
fn json_is_one_object_with_the_figures() {
    let folder = tempfile::tempdir().unwrap();
    let output = alula(
        folder.path(),
        &["fly", "hover-to-cruise", "--json", "--out", "here"],
    );
    assert!(output.status.success(), "{output:?}");
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in [
        "max_velocity_error_m_s",
        "max_velocity_error_time_s",
        "min_fp_n",
        "max_rate_command_rad_s",
        "final_velocity_error_m_s",
        "final_alpha_deg",
        "final_theta_deg",
        "final_thrust_to_weight",
    ] {
        assert!(object[key].is_f64(), "{key}: {}", object[key]);
    }
    // Of every flight, whatever its controller.
    for key in [
        "altitude_least_m",
        "altitude_most_m",
        "forward_least_m",
        "forward_most_m",
        "max_true_rate_rad_s",
    ] {
        assert!(object[key].is_f64(), "{key}: {}", object[key]);
    }
    assert_eq!(object["lost"], false);
    assert_eq!(object["faults"], 0);
    assert_eq!(object["out"], "here");
    assert!(folder.path().join("here/trace.csv").exists());
}

/// The columns `names` of a CSV text, cell by cell.
fn columns(csv: &str, names: &[&str]) -> Vec<Vec<String>> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let header = reader.headers().unwrap().clone();
    let index = |name: &&str| header.iter().position(|cell| cell == *name).unwrap();
    let wanted: Vec<_> = names.iter().map(index).collect();
    let row = |record: csv::StringRecord| wanted.iter().map(|&i| record[i].to_owned()).collect();
    reader
        .records()
        .map(|record| row(record.unwrap()))
        .collect()
}

/// The text of an f32 reads back to the bit, so equal texts are equal bits.
#[test]
fn replaying_a_flown_trace_gives_the_same_commands_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let rates =
        "t_s,thrust_n,command_roll_rad_s,command_pitch_rad_s,command_yaw_rad_s,law_alpha_rad,fp_n";
    let law = &format!("{rates},status");
    let guidance = &format!("{rates},margin_k,margin_fold_rad,mode,phase,unreachable,air,status");
    for (name, header, least) in [
        ("hover-to-cruise", law, 20_000),
        ("large-angle", law, 20_000),
        ("cruise-to-hover", law, 20_000),
        // With memory, noise, faults, and the air and the position as they are told.
        ("rough-day", guidance, 10_000),
        ("steep-descent", guidance, 6_000),
        ("mission-turbulence", guidance, 7_000),
    ] {
        assert!(alula(folder.path(), &["fly", name]).status.success());
        let trace = format!("out/{name}/trace.csv");
        let output = alula(folder.path(), &["replay", &trace, "--experiment", name]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let replayed = text(&output.stdout);
        assert_eq!(replayed.lines().next(), Some(&**header));
        let names: Vec<_> = header.split(',').collect();
        let text = fs::read_to_string(folder.path().join(trace)).unwrap();
        let (logged, replayed) = (columns(&text, &names), columns(&replayed, &names));
        assert!(logged.len() > least);
        let differs = logged.iter().zip(&replayed).find(|(a, b)| a != b);
        assert!(differs.is_none(), "{name}: {differs:?}");
    }
}

const HEADER: &str = "t_s,told_v_north_m_s,told_v_east_m_s,told_v_down_m_s,told_attitude_w,told_attitude_x,told_attitude_y,told_attitude_z,\
                      told_wind_north_m_s,told_wind_east_m_s,told_wind_down_m_s,told_vr_north_m_s,told_vr_east_m_s,\
                      told_vr_down_m_s,told_ar_north_m_s2,told_ar_east_m_s2,told_ar_down_m_s2";

/// A row of a log in hover: the nose up, √½ and √½ about the right wing.
const ROW: &str = "0,0,0,0,0.70710678,0,0.70710678,0,0,0,0,0,0,0,0,0,0";

/// That row at the time `t`, with `value` in place of what is told under `column`.
fn row_with(t: &str, column: &str, value: &str) -> String {
    let mut cells: Vec<&str> = ROW.split(',').collect();
    cells[0] = t;
    let place = HEADER.split(',').position(|name| name == column).unwrap();
    cells[place] = value;
    cells.join(",") + "\n"
}

#[test]
fn a_log_with_values_that_are_not_finite_yields_faults_and_the_safe_command() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("told_v_north_m_s", "NaN", "velocity"),
        ("told_attitude_y", "nan", "attitude"),
        ("told_wind_north_m_s", "inf", "wind"),
        ("told_ar_north_m_s2", "1e9", "reference_acceleration"),
    ];
    let mut log = format!("{HEADER}\n{ROW}\n");
    for (n, (column, value, _)) in cases.iter().enumerate() {
        log += &row_with(&format!("0.{}", n + 1), column, value);
    }
    fs::write(folder.path().join("log.csv"), log).unwrap();
    let output = alula(folder.path(), &["replay", "log.csv"]);
    let lines: Vec<_> = text(&output.stdout).lines().map(str::to_owned).collect();
    assert!(output.status.success());
    // The belief's hover thrust, 9 kg · 9.81 m/s².
    assert!(
        lines[1].starts_with("0.0,88.29,0.0,") && lines[1].ends_with(",ok"),
        "{lines:?}"
    );
    for (n, (.., fault)) in cases.iter().enumerate() {
        assert_eq!(
            lines[n + 2],
            format!("0.{},0.0,0.0,0.0,0.0,0.0,0.0,{fault}", n + 1)
        );
    }
}

#[test]
fn a_bad_log_is_named_with_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |log: &str, arguments: &[&str], parts: &[&str]| {
        fs::write(folder.path().join("log.csv"), log).unwrap();
        let arguments = [&["replay", "log.csv"], arguments].concat();
        let output = alula(folder.path(), &arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1));
        assert_eq!(message.lines().count(), 1, "{message}");
        for part in parts {
            assert!(message.contains(part), "{message:?} has no {part:?}");
        }
    };
    let row = ROW;
    let short = HEADER.replace(",told_wind_down_m_s", "");
    refused(&short, &[], &["log.csv:1:", "told_wind_down_m_s"]);
    refused("", &[], &["log.csv: byte 0: the file is empty"]);
    refused(
        &format!(
            "{HEADER}\n{row}\n{}",
            row_with("0", "told_attitude_y", "up")
        ),
        &[],
        &["log.csv:3:", "told_attitude_y", "\"up\""],
    );
    refused(
        &format!("{HEADER}\n{row}\n{}", row_with("0", "told_v_east_m_s", "")),
        &[],
        &["log.csv:3:", "told_v_east_m_s"],
    );
    refused(
        &format!("{HEADER}\n{row}\n{row}\n0.1,2\n"),
        &[],
        &["log.csv:4:", "2 cells"],
    );
    let bad = |rows: &str, parts: &[&str]| refused(&format!("{HEADER}\n{rows}"), &[], parts);
    bad(
        &row_with("NaN", "told_attitude_w", "1"),
        &["log.csv:2: t_s: NaN is not a finite time"],
    );
    let back = ["1", "0.5"]
        .map(|t| row_with(t, "told_attitude_w", "1"))
        .concat();
    bad(
        &back,
        &["log.csv:3: t_s: 0.5 comes after 1: time must not run"],
    );
    bad("", &["log.csv: no rows under the header"]);
    let twice = format!("{HEADER},told_attitude_w\n{row},0\n");
    refused(&twice, &[], &["log.csv:1: two columns told_attitude_w"]);
    let old = format!("{}\n{row}\n", HEADER.replace("told_attitude_w", "told_q_w"));
    let parts = ["log.csv:1: told_q_w", "told_attitude_w stands for it now"];
    refused(&old, &[], &parts);
    let old = format!("{HEADER},command_wing_rad_s\n{row},0\n");
    let parts = ["log.csv:1: command_wing_rad_s", "command_pitch_rad_s"];
    refused(&old, &[], &parts);
    let semicolons = format!("{HEADER}\n{row}\n").replace(',', ";");
    refused(
        &semicolons,
        &[],
        &["log.csv:1: the cells are separated by semicolons"],
    );
    // A damaged word must not be taken for the wind.
    let told = format!("{HEADER},told_air\n{row},wind\n0.1{},velocitx\n", &row[1..]);
    refused(
        &told,
        &[],
        &["log.csv:3: told_air: \"velocitx\" is neither velocity nor"],
    );
    // A law with feed-forward needs its columns.
    let forward = ["--experiment", "steep-climb"];
    refused(
        &format!("{HEADER}\n{row}\n"),
        &forward,
        &["log.csv:1:", "told_aa_north_m_s2"],
    );
    assert_refused(
        &alula(folder.path(), &["replay", "none.csv"]),
        &["none.csv"],
    );
}

#[test]
fn replay_is_quiet_when_its_reader_has_seen_enough() {
    let folder = tempfile::tempdir().unwrap();
    assert!(alula(folder.path(), &["fly"]).status.success());
    let mut child = Command::new(env!("CARGO_BIN_EXE_alula-sil"))
        .current_dir(folder.path())
        .args(["replay", "out/hover-to-cruise/trace.csv"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    // Reads a little of 1 MB, then closes.
    BufReader::with_capacity(64, child.stdout.take().unwrap())
        .read_line(&mut line)
        .unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert_eq!(text(&output.stderr), "");
}

#[test]
fn a_bad_experiment_is_named_with_line_and_field_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let good = text(&alula(folder.path(), &["list", "hover-to-cruise"]).stdout);
    let good = good.replace(
        "vehicle = \"paper-belief\"",
        "[controller.law.vehicle]\nmass_kg = 9.0\nk_a_kg_m = 0.51",
    );
    let refused = |from: &str, to: &str, parts: &[&str]| {
        assert!(good.contains(from), "{from}");
        fs::write(folder.path().join("bad.toml"), good.replacen(from, to, 1)).unwrap();
        assert_refused(&alula(folder.path(), &["fly", "bad.toml"]), parts);
        assert_refused(&alula(folder.path(), &["fly", "bad.toml", "--json"]), parts);
        assert_eq!(
            names(folder.path()),
            BTreeSet::from(["bad.toml".to_owned()])
        );
    };
    let line = |part: &str| {
        let index = good.lines().position(|l| l.contains(part)).unwrap();
        format!("bad.toml:{}:", index + 1)
    };
    refused(
        "mass_kg = 9.0",
        "mass_kg = 0.0",
        &[
            &line("mass_kg = 9.0"),
            "controller.law.vehicle.mass_kg: mass must be positive, from 0.001 to 1000000 kg",
        ],
    );
    refused(
        "k3 = 6.0",
        "k3 = inf",
        &[&line("k3 = 6.0"), "controller.law.gains.k3"],
    );
    refused("tau_n = 80.0", "tau_n = ", &[&line("tau_n = 80.0")]);
    refused(
        "form = \"robust\"",
        "form = \"bold\"",
        &[&line("form ="), "controller.law.form", "bold"],
    );
    refused(
        "substeps = 1",
        "substep = 1",
        &[&line("substeps"), "substep"],
    );
    refused("duration_s = 20.0", "", &["bad.toml:1:", "duration_s"]);
    assert_refused(&alula(folder.path(), &["fly", "none.toml"]), &["none.toml"]);
    assert_refused(
        &alula(folder.path(), &["fly", "hover"]),
        &["hover:", "hover-to-cruise"],
    );
}

/// In bash a command's own flags are completed, not its name alone.
#[test]
fn bash_completes_flags() {
    let folder = tempfile::tempdir().unwrap();
    let script = alula(folder.path(), &["completions", "bash"]).stdout;
    fs::write(folder.path().join("script"), script).unwrap();
    let ask = "source ./script; COMP_WORDS=(alula-sil new --mas); COMP_CWORD=2; _alula__sil alula-sil --mas new; echo ${COMPREPLY[@]}";
    let answer = Command::new("bash")
        .args(["-c", ask])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(text(&answer.stdout).trim(), "--mass-kg", "{answer:?}");
}

#[test]
fn bad_arguments_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["fly", "--jsn"][..],
        &["flie"],
        &["replay"],
        &["fly", "hover-to-cruise", "--out"],
        &["fly", "hover-to-cruise", "matched"],
    ] {
        let output = alula(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert_refused(&output, &["error:", "--help"]);
    }
    let key = ["fly", "matched", "--set", "bad\"key\n=1"];
    assert_refused(&alula(folder.path(), &key), &["error:", "bad\"key"]);
}

#[test]
fn a_folder_that_cannot_be_written_is_named_and_holds_nothing() {
    let folder = tempfile::tempdir().unwrap();
    // A file where the folder should be, and a folder where a file should be.
    fs::write(folder.path().join("taken"), "mine").unwrap();
    let output = alula(folder.path(), &["fly", "matched", "--out", "taken"]);
    assert_refused(&output, &["taken"]);
    assert_eq!(
        fs::read_to_string(folder.path().join("taken")).unwrap(),
        "mine"
    );

    fs::create_dir_all(folder.path().join("out/matched/report.html")).unwrap();
    let output = alula(folder.path(), &["fly", "matched"]);
    assert_refused(&output, &["out/matched/report.html"]);
    // No temporary file stays behind, nor anything under the name of the file that failed.
    let left = names(&folder.path().join("out/matched"));
    assert!(left.iter().all(|name| !name.starts_with('.')), "{left:?}");
    assert!(folder.path().join("out/matched/report.html").is_dir());
}

#[test]
fn list_names_every_built_in_and_prints_one() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| text(&alula(folder.path(), arguments).stdout);
    let listed = run(&["list"]);
    assert_eq!(listed.lines().count(), BUILT_IN.len());
    for (name, _) in BUILT_IN {
        assert!(listed.contains(name));
    }
    assert!(run(&["list", "round-trip-weak"]).contains("base = \"round-trip\""));
    // Whole, it needs no base, and flies the same.
    fs::write(
        folder.path().join("whole.toml"),
        run(&["list", "round-trip-weak", "--whole"]),
    )
    .unwrap();
    let short = ["--json", "--set", "duration_s=3", "--out", "o"];
    let fly = |name: &str| {
        let printed = run(&[&["fly", name][..], &short].concat());
        let mut object: Value = serde_json::from_str(&printed).unwrap();
        object["experiment"] = Value::Null;
        object
    };
    assert_eq!(fly("whole.toml"), fly("round-trip-weak"));
}

/// The paths that scripts rely on, by `--set` and in a file with `base` and `[set]`: both fly the same.
#[test]
fn fields_are_set_by_their_paths() {
    let folder = tempfile::tempdir().unwrap();
    let fields = [
        ("duration_s", "4.0"),
        ("vehicle.mass_kg", "11.0"),
        ("vehicle.k_a_kg_m", "0.6"),
        ("plant.thrust_n[1]", "150.0"),
        ("weather.steady_m_s", "[-1.0, 0.0, 0.0]"),
        (
            "reference.knots",
            "[{ t_s = 0.0, down_m_s = 2.0, forward_m_s = 1.0 }]",
        ),
        ("initial.theta_deg", "-10.0"),
        ("initial.velocity_m_s", "[1.5, 0.0, 2.5]"),
        ("initial.thrust_n", "100.0"),
    ];
    let mut file = "base = \"steep-descent\"\n[set]\n".to_owned();
    let mut arguments = vec!["fly".to_owned(), "steep-descent".to_owned()];
    for (path, value) in fields {
        file += &format!("\"{path}\" = {value}\n");
        arguments.extend(["--set".to_owned(), format!("{path}={value}")]);
    }
    fs::write(folder.path().join("own.toml"), file).unwrap();
    let run = |arguments: &[&str]| {
        let output = alula(
            folder.path(),
            &[arguments, &["--json", "--out", "o"]].concat(),
        );
        assert!(output.status.success(), "{output:?}");
        let mut object: Value = serde_json::from_slice(&output.stdout).unwrap();
        object["experiment"] = Value::Null;
        object
    };
    let by_argument = run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(run(&["fly", "own.toml"]), by_argument);
    let trace = fs::read_to_string(folder.path().join("o/trace.csv")).unwrap();
    let first = &columns(&trace, &["v_down_m_s", "v_north_m_s", "path_v_down_m_s"])[0];
    assert_eq!(first, &["2.5", "1.5", "2.0"]);
    assert_refused(
        &alula(folder.path(), &["fly", "--set", "vehicle.mass=1"]),
        &["--set vehicle.mass=1: vehicle.mass: unknown field"],
    );
    for option in [["--set", "seed=1"], ["--shard", "1/2"], ["--refly", "3"]] {
        let arguments = [&["campaign", "attitudes"][..], &option].concat();
        assert_refused(
            &alula(folder.path(), &arguments),
            &["attitudes: has no text"],
        );
    }
    // What contradicts a line of a text that is sound alone is named before it.
    assert_refused(
        &alula(
            folder.path(),
            &["fly", "circle-40", "--set", "duration_s=20"],
        ),
        &["--set duration_s=20: built-in circle-40:4: settle_time_s: must be"],
    );
}

const CAMPAIGN: &str = r#"base = "own.toml"
flights = 60
[set]
duration_s = 2.0
[[disperse]]
field = "vehicle.mass_kg"
scale.uniform = [0.9, 1.1]
[[limits]]
figure = "altitude_most_m"
most = 5.0
"#;

/// A folder with a campaign and, beside it, its base.
fn campaign_folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("c.toml"), CAMPAIGN).unwrap();
    fs::write(folder.path().join("own.toml"), "base = \"round-trip\"\n").unwrap();
    folder
}

#[test]
fn a_campaign_is_flown_shared_merged_and_flown_again() {
    let folder = campaign_folder();
    let run = |arguments: &[&str]| {
        let output = alula(folder.path(), arguments);
        assert!(output.status.success(), "{output:?}");
        text(&output.stdout)
    };
    let stdout = run(&["campaign", "c.toml"]);
    assert!(
        stdout.contains("60 flights of own.toml, seed 0: passed"),
        "{stdout}"
    );
    let whole = folder.path().join("out/campaign-c");
    let expected = [
        "campaign.json",
        "flights",
        "flights.parquet",
        "report.html",
        "report.svg",
        "samples",
        "summary.json",
        "view.html",
    ];
    assert_eq!(names(&whole), expected.map(str::to_owned).into());

    run(&["campaign", "c.toml", "--shard", "1/2", "--out", "one"]);
    run(&["campaign", "c.toml", "--shard", "2/2", "--out", "two"]);
    run(&["campaign", "merge", "two", "one", "--out", "both"]);
    for file in [
        "flights.parquet",
        "report.html",
        "summary.json",
        "view.html",
    ] {
        let read = |folder: &Path| fs::read(folder.join(file)).unwrap();
        let merged = read(&folder.path().join("both"));
        // Only how a flight is flown again is not the same: the shares may have come without the file.
        let merged = match file {
            "flights.parquet" => merged,
            _ => text(&merged)
                .replace("campaign both", "campaign c.toml")
                .into(),
        };
        assert_eq!(read(&whole), merged, "{file}");
    }

    let summary: Value =
        serde_json::from_slice(&fs::read(whole.join("summary.json")).unwrap()).unwrap();
    let worst = &summary["limits"][0]["worst"][0];
    let command = worst["command"].as_str().unwrap();
    let arguments: Vec<&str> = command.split(' ').skip(1).chain(["--json"]).collect();
    let flight: Value = serde_json::from_str(&run(&arguments)).unwrap();
    assert_eq!(flight["altitude_most_m"], worst["value"], "{flight}");
    let by_results = command.replace("c.toml", "both");
    let arguments: Vec<&str> = by_results.split(' ').skip(1).chain(["--json"]).collect();
    let merged: Value = serde_json::from_str(&run(&arguments)).unwrap();
    assert_eq!(merged["altitude_most_m"], worst["value"], "{merged}");
    let own = format!("{}/experiment.toml", flight["out"].as_str().unwrap());
    let again: Value = serde_json::from_str(&run(&["fly", &own, "--json"])).unwrap();
    assert_eq!(again["altitude_most_m"], flight["altitude_most_m"]);
    // A flight beyond the campaign's own number takes the number that it was flown with.
    run(&["campaign", "c.toml", "--flights", "61", "--refly", "60"]);
    let alone = ["campaign", "c.toml", "--refly", "60"];
    assert_refused(
        &alula(folder.path(), &alone),
        &["--refly: flights are numbered from 0 to 59"],
    );
    let results = ["campaign", "both", "--flights", "61", "--refly", "0"];
    assert_refused(&alula(folder.path(), &results), &["leave out --flights"]);
}

#[test]
fn a_bad_campaign_is_named_with_line_and_field() {
    let folder = campaign_folder();
    let refused = |from: &str, to: &str, parts: &[&str]| {
        assert!(CAMPAIGN.contains(from));
        fs::write(folder.path().join("bad.toml"), CAMPAIGN.replace(from, to)).unwrap();
        let output = alula(folder.path(), &["campaign", "bad.toml"]);
        assert_refused(&output, parts);
    };
    refused(
        "mass_kg",
        "mass",
        &["bad.toml:5: disperse[0]: vehicle.mass: is not in the experiment"],
    );
    refused(
        "[0.9, 1.1]",
        "[1.1, 0.9]",
        &["bad.toml:7: disperse[0].scale: uniform"],
    );
    refused(
        "scale.uniform",
        "scale.unifrm",
        &["bad.toml:7: disperse[0].scale"],
    );
    refused(
        "altitude_most_m",
        "altitude",
        &["bad.toml:9: limits[0].figure: altitude is not the name of a figure"],
    );
    refused(
        "2.0",
        "-2.0",
        &["bad.toml:3: set: duration_s: must be positive"],
    );
    refused(
        "own.toml",
        "other",
        &["bad.toml: base: other: neither a file nor a built-in experiment"],
    );
    for flights in ["0", "1000000000000000000"] {
        let flights = format!("flights = {flights}");
        refused(
            "flights = 60",
            &flights,
            &["bad.toml: flights: must be from 1 to 10"],
        );
    }
    assert!(!folder.path().join("out").exists());
    // What the first draw does not show is found in flight.
    let parts = [
        "bad.toml: flight ",
        ": vehicle.mass_kg: mass must be positive, from 0.001 to 1000000 kg",
    ];
    refused("0.9", "-0.9", &parts);

    // A limit that is not kept fails, with everything written.
    fs::write(
        folder.path().join("strict.toml"),
        CAMPAIGN.replace("5.0", "-5.0"),
    )
    .unwrap();
    let output = alula(folder.path(), &["campaign", "strict.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("strict.toml: a limit is not kept"));
    assert!(text(&output.stdout).contains("FAILED"));
    assert!(
        folder
            .path()
            .join("out/campaign-strict/flights.parquet")
            .exists()
    );
    // Its folder is not another campaign's.
    let output = alula(
        folder.path(),
        &["campaign", "c.toml", "--out", "out/campaign-strict"],
    );
    assert_refused(&output, &["holds the results of another campaign"]);
    let output = alula(folder.path(), &["campaign", "merge", "nowhere"]);
    assert_refused(&output, &["nowhere", "No such file"]);
}

/// What a disk or a hand may do to a folder of results between two runs: each is refused, and the error says what to delete.
#[test]
fn a_campaign_goes_on_from_its_own_sound_parts_alone() {
    let folder = campaign_folder();
    let run = |file: &str, out: &str| alula(folder.path(), &["campaign", file, "--out", out]);
    assert!(run("c.toml", "own").status.success());
    let other = CAMPAIGN.replace("flights", "seed = 9\nflights");
    fs::write(folder.path().join("d.toml"), other).unwrap();
    assert!(run("d.toml", "other").status.success());
    // Either part of a chunk: to delete the one that is named is enough.
    for place in ["own/samples/000001.parquet", "own/flights/000001.parquet"] {
        let part = folder.path().join(place);
        let sound = fs::read(&part).unwrap();
        let mut changed = sound.clone();
        changed[sound.len() / 3] ^= 4;
        fs::write(&part, changed).unwrap();
        assert_refused(
            &run("c.toml", "own"),
            &[place, "has changed since it was written; delete it"],
        );
        fs::remove_file(&part).unwrap();
        assert!(run("c.toml", "own").status.success());
        assert_eq!(fs::read(&part).unwrap(), sound);
    }

    let place = "own/flights/000001.parquet";
    let part = folder.path().join(place);
    let sound = fs::read(&part).unwrap();
    fs::copy(folder.path().join("other/flights/000001.parquet"), &part).unwrap();
    assert_refused(
        &run("c.toml", "own"),
        &[place, "belongs to another campaign", "delete it"],
    );
    fs::write(&part, sound).unwrap();

    let identity = folder.path().join("own/campaign.json");
    for text in ["", "xyz"] {
        fs::write(&identity, text).unwrap();
        let parts = ["own/campaign.json: is no identity", "remove its folder"];
        assert_refused(&run("c.toml", "own"), &parts);
    }
    fs::remove_file(&identity).unwrap();
    let parts = [
        "own: holds parts, but no campaign.json",
        "remove it, or choose another folder",
    ];
    assert_refused(&run("d.toml", "own"), &parts);
}

/// A simulation that comes to no number ends there, says so, and leaves no page of figures.
#[test]
fn a_flight_that_diverges_says_so() {
    let folder = campaign_folder();
    // In a plane and in space.
    for name in ["round-trip", "circle-40"] {
        let arguments = ["fly", name, "--set", "vehicle.mass_kg=0.001"];
        let output = alula(folder.path(), &arguments);
        let diverged = format!("{name}: diverged at ");
        assert_refused(&output, &[&diverged, "trace.csv ends there"]);
        let left = names(&folder.path().join("out").join(name));
        assert_eq!(left, ["trace.csv".to_owned()].into());
    }

    // Body rates that no airframe has, at any speed.
    let whirled = "base = \"round-trip\"\n[controller.law]\nform = \"full\"\n";
    fs::write(folder.path().join("whirled.toml"), whirled).unwrap();
    let output = alula(folder.path(), &["fly", "whirled.toml"]);
    assert_refused(&output, &["whirled: diverged at ", "trace.csv ends there"]);

    // Whatever flies for a page leaves none.
    for command in ["view", "sweep"] {
        let arguments = [command, "round-trip", "--set", "vehicle.mass_kg=0.001"];
        let output = alula(folder.path(), &arguments);
        assert_refused(&output, &["round-trip: diverged at "]);
    }

    // A comparison says which, and no figures of it.
    let arguments = [
        "compare",
        "circle-40",
        "eight",
        "--set",
        "vehicle.mass_kg=0.001",
    ];
    let output = alula(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(self::text(&output.stderr).contains("2 flights diverged"));
    let stdout = self::text(&output.stdout);
    assert_eq!(stdout.matches("diverges").count(), 4, "{stdout}");

    // Of a campaign it is counted, though no limit asks for it.
    let text = CAMPAIGN.split("[[limits]]").next().unwrap();
    let light = text
        .replace("2.0", "7.0")
        .replace("[0.9, 1.1]", "[0.0001, 0.0001]");
    fs::write(folder.path().join("light.toml"), light).unwrap();
    let output = alula(folder.path(), &["campaign", "light.toml", "--flights", "2"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let stdout = self::text(&output.stdout);
    assert!(stdout.contains("FAILED; 2 DIVERGED"), "{stdout}");
}

/// An image that is none ends with one line, not with the registers of the processor.
#[test]
fn an_image_that_does_not_run_is_said_in_one_line() {
    if Command::new("qemu-system-arm")
        .arg("--version")
        .output()
        .is_err()
    {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("none.elf"), [0x5a; 3000]).unwrap();
    let output = alula(folder.path(), &["pil", "round-trip", "--image", "none.elf"]);
    assert_refused(&output, &["the image stopped: qemu", "link"]);
}

/// A mistyped command, option or name is answered with the one that was meant.
#[test]
fn a_slip_of_the_fingers_is_told_what_was_meant() {
    let folder = tempfile::tempdir().unwrap();
    for (given, meant) in [
        (vec!["campain"], "campaign"),
        (vec!["serve"], "is called sitl"),
        (vec!["new", "x", "--mas-kg", "3"], "--mass-kg"),
        (vec!["fly", "round-tripp"], "round-trip?"),
    ] {
        let output = alula(folder.path(), &given);
        assert_refused(
            &output,
            &[
                given
                    .last()
                    .filter(|word| **word != "3")
                    .unwrap_or(&"--mas-kg"),
                meant,
            ],
        );
    }
}

/// What is given in the place of something else is told what is wanted there, and not its whole list where a name is near.
#[test]
fn what_is_of_another_kind_is_told_what_is_wanted() {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        ("notes.md", "# Notes\nof a flight\n"),
        ("trace.csv", "t_s,north_m,east_m,down_m\n0,0,0,0\n"),
        ("mine.toml", "base = 'round-trip'\nduration_s = 1.0\n"),
        ("many.toml", "base = 'round-trip'\nflights = 2\n"),
        ("known.toml", "mass_kg = 3.0\n"),
        ("survey.plan", "{\n \"fileType\": \"Plan\"\n}\n"),
        ("log.ulg", "ULog\x01\x12\x35\x01"),
        ("page.html", "<!DOCTYPE html>\n<html></html>\n"),
        ("flights.parquet", "PAR1\x15\u{0}"),
    ];
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    // What `new plane` leaves.
    fs::create_dir(folder.path().join("plane")).unwrap();
    fs::write(folder.path().join("plane/plane.toml"), "").unwrap();
    let taken = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    for (given, says) in [
        ("fly .", ".: a folder, where a file is wanted"),
        (
            "fly notes.md",
            "notes.md:2: no TOML, which experiments and vehicles are: ",
        ),
        ("replay notes.md", "notes.md:1: no column t_s"),
        (
            "fly trace.csv",
            "trace.csv: the trace of a flight, where an experiment or a vehicle is wanted: `alula-sil replay` and `view` take it",
        ),
        (
            "fit trace.csv",
            "the trace of a flight, where a polar is wanted",
        ),
        (
            "envelope trace.csv",
            "the trace of a flight, where an experiment, a vehicle or a polar is wanted",
        ),
        (
            "replay mine.toml",
            "mine.toml: an experiment or a vehicle, where a trace or a log is wanted: `alula-sil fly` flies an experiment",
        ),
        (
            "identify mine.toml --mass-kg 3 --wing-m2 0.4",
            "where an autopilot's log is wanted",
        ),
        (
            "identify trace.csv --mass-kg 3 --wing-m2 0.4",
            "trace.csv: the trace of a flight, where an autopilot's log is wanted",
        ),
        (
            "fly plane",
            "plane: a folder, where a file is wanted: plane/plane.toml?",
        ),
        (
            "campaign mine.toml",
            "mine.toml: an experiment or a vehicle, where a campaign is wanted",
        ),
        (
            "fly many.toml",
            "many.toml: a campaign, where an experiment or a vehicle is wanted: `alula-sil campaign` flies it",
        ),
        (
            "fly known.toml",
            "known.toml: what is known of a vehicle, where ",
        ),
        (
            "new x --from mine.toml",
            "where what is known of a vehicle is wanted",
        ),
        (
            "fit survey.plan",
            "survey.plan: a mission of a ground station, where a polar is wanted: `alula-sil fly FILE --vehicle EXPERIMENT` flies it",
        ),
        (
            "view survey.plan",
            "a mission of a ground station, where an experiment or a vehicle is wanted",
        ),
        (
            "fly log.ulg",
            "log.ulg: an autopilot's log, where a text is wanted: `alula-sil replay`",
        ),
        (
            "compare page.html",
            "page.html: a page or a picture, where a comparison is wanted",
        ),
        (
            "view flights.parquet",
            "flights.parquet: the flights of a campaign, where ",
        ),
        ("replay .", ".: a folder, where a file is wanted"),
        ("tune .", ".: a folder, where a file is wanted"),
        (
            "fly matched --out mine.toml",
            "mine.toml: a file, where a folder is wanted",
        ),
        (
            "campaign mission",
            "mission: an experiment or a vehicle, where a campaign is wanted: `alula-sil fly` flies an experiment",
        ),
        (
            "fly dispersed",
            "dispersed: a campaign, where an experiment or a vehicle is wanted: `alula-sil campaign` flies it",
        ),
        (
            "fly attitudes",
            "attitudes: a campaign, where an experiment or a vehicle is wanted",
        ),
        (
            "fly missions",
            "missions: a comparison, where an experiment or a vehicle is wanted: `alula-sil compare` flies it",
        ),
        (
            "campaign laws",
            "laws: a comparison, where a campaign is wanted: `alula-sil compare` flies it",
        ),
        (
            "margins laws",
            "laws: a comparison, where an experiment, a vehicle or a polar is wanted",
        ),
        (
            "compare mission",
            "mission: an experiment or a vehicle, where a comparison, or a second experiment, is wanted",
        ),
        (
            "fly naca-0012-re-160e3",
            "naca-0012-re-160e3: a polar, where an experiment or a vehicle is wanted: `alula-sil fit` takes it",
        ),
        (
            "replay mission",
            "mission: an experiment or a vehicle, where a trace or a log is wanted",
        ),
        (
            &format!("preflight round-trip --connect udpin:127.0.0.1:{port}"),
            "another program has it",
        ),
        (
            "fly round-trip --set rate_loop.lag=0.1",
            "did you mean `plant.rate_loop`?",
        ),
        // A vehicle alone, whose tables lie in other files.
        (
            "fly tail-sitter",
            "built-in tail-sitter:1: a vehicle alone, where an experiment is wanted",
        ),
        (
            "fly round-trip --set plant.rate_loop.lag=0.1",
            "0.1, where a table, { time_constant_s = … }, is wanted",
        ),
        (
            "fly mission --set vehicle.mass=3",
            "did you mean `mass_kg`?",
        ),
        (
            &format!("sitl ardupilot round-trip --listen 127.0.0.1:{port}"),
            "another program has it",
        ),
        (
            "compare lws",
            "lws: neither a file nor a built-in comparison; did you mean laws?\n",
        ),
        (
            "campaign qqq",
            "neither a file nor a built-in campaign: dispersed, ",
        ),
    ] {
        let words: Vec<&str> = given.split_whitespace().collect();
        assert_refused(&alula(folder.path(), &words), &[says]);
    }
    let left = files.map(|(name, _)| name);
    let left = left.into_iter().chain(["plane"]).map(str::to_owned);
    assert_eq!(names(folder.path()), left.collect());
}

/// What no wing has every command that takes a polar refuses, with file and line, and what is odd each says.
#[test]
fn every_command_judges_a_polar_alike() {
    let folder = tempfile::tempdir().unwrap();
    let polar = |drag: f64| -> String {
        let rows = (-12..=18).map(f64::from);
        let rows: String = rows
            .map(|a| format!("{a} {:.4} {}\n", (0.12 * a).sin(), drag + 3e-4 * a * a))
            .collect();
        format!("alpha CL CD\n{rows}")
    };
    let vehicle =
        "base = 'hover-to-cruise'\nduration_s = 1\nvehicle.aerodynamics.table.polar = 'x.txt'\n";
    fs::write(folder.path().join("x.toml"), vehicle).unwrap();
    let section: Vec<&str> = "new y --mass-kg 3 --wing-m2 0.35 --section x.txt --thrust-to-weight 1.6 --thrust-lag-s 0.08 --rate-lag-s 0.06 --cruise-m-s 18 --turn-rad-s2 300 --actuators both"
        .split(' ')
        .collect();
    let commands: [&[&str]; 8] = [
        &["fit", "x.txt"],
        &["envelope", "x.txt"],
        &["equilibria", "x.txt", "--velocity", "20,0,0"],
        &["margins", "x.txt", "--speeds", "20"],
        &["envelope", "x.toml"],
        &["sweep", "x.toml"],
        &["fly", "x.toml"],
        &section,
    ];
    fs::write(folder.path().join("x.txt"), polar(12.0)).unwrap();
    for command in commands {
        let output = alula(folder.path(), command);
        assert_refused(&output, &["x.txt:2: c_D is 12.0432 at -12°"]);
    }
    fs::write(folder.path().join("x.txt"), polar(0.001)).unwrap();
    for command in commands {
        let output = alula(folder.path(), command);
        let said = text(&output.stdout) + &text(&output.stderr);
        let told = said.matches("x.txt:14: c_D is 0.001 at 0°: is there friction in it?");
        assert_eq!(told.count(), 1, "{command:?}: {said}");
    }
    // Without a stall `new` has no wing, and the others go by the extension: each says so with the same line. With one, however late, none does.
    let bent = |last: i32, stalls: f64| -> String {
        let lift = |a: f64| match a {
            a if a <= stalls => 2.0 * (2.0 * a.to_radians()).sin(),
            a => 2.0 * (2.0 * stalls.to_radians()).sin() - 0.1 * (a - stalls),
        };
        let rows = (-10..=last).map(f64::from);
        let rows: String = rows
            .map(|a| format!("{a} {:.4} {}\n", lift(a), 0.01 + 3e-4 * a * a))
            .collect();
        format!("alpha CL CD\n{rows}")
    };
    let (refuses, warn) = commands.split_last().unwrap();
    for (stalls, count) in [(90.0, 1), (26.0, 0)] {
        fs::remove_dir_all(folder.path().join("y")).unwrap_or_default();
        fs::write(folder.path().join("x.txt"), bent(34, stalls)).unwrap();
        for command in warn.iter().chain([refuses]) {
            let output = alula(folder.path(), command);
            let said = text(&output.stdout) + &text(&output.stderr);
            let told = said.matches("x.txt:37: c_L is 1.5321 at 25°, and lift does not fall");
            assert_eq!(told.count(), count, "{command:?}: {said}");
            let refused = command == refuses && count == 1;
            assert_eq!(output.status.success(), !refused, "{command:?}: {said}");
        }
    }
    // A polar is no experiment, under whatever name.
    let output = alula(folder.path(), &["sweep", "x.txt"]);
    assert_refused(&output, &["x.txt: a polar, and no experiment"]);
}

/// A file that no command reads is named for what it is by each, and an empty one by its name.
#[test]
fn every_command_names_what_it_cannot_read() {
    let folder = tempfile::tempdir().unwrap();
    let jsbsim = "<?xml version=\"1.0\"?>\n<fdm_config name=\"mine\">\n</fdm_config>\n";
    let facts = "--mass-kg 3 --wing-m2 0.35 --thrust-to-weight 1.6 --thrust-lag-s 0.08 --rate-lag-s 0.06 --cruise-m-s 18 --turn-rad-s2 300 --actuators both";
    let known = |more: &str| format!("new y {more} {facts}");
    let commands = [
        "fit x.xml",
        "envelope x.xml",
        "equilibria x.xml --velocity 20,0,0",
        "margins x.xml",
        "sweep x.xml",
        "fly x.xml",
        "campaign x.xml",
        "compare x.xml",
        "replay x.csv --experiment x.xml",
        &known("--section x.xml"),
        &known("--from x.xml"),
    ];
    fs::write(folder.path().join("x.csv"), "t_s\n0\n").unwrap();
    for (text, says) in [
        (jsbsim, "x.xml:1: JSBSim's XML"),
        ("", "x.xml:1: the file is empty"),
    ] {
        fs::write(folder.path().join("x.xml"), text).unwrap();
        for command in commands {
            let words: Vec<&str> = command.split_whitespace().collect();
            assert_refused(&alula(folder.path(), &words), &[says]);
        }
    }
}
