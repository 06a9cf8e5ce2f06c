//! Flights as logs, and logs through controllers, by the command line.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::{alula, text};

fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = alula(folder, arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// The numbers of one column of a CSV text.
fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let place = reader.headers().unwrap().iter().position(|h| h == name);
    let place = place.unwrap_or_else(|| panic!("no {name} in {csv:.200}"));
    let number = |record: csv::StringRecord| record[place].parse().unwrap();
    reader.records().map(|r| number(r.unwrap())).collect()
}

/// A flight's own log tells the controller what the flight told it, of whatever kind: in wind that blows upwards, too, and with errors of the
/// sensors.
#[test]
fn a_flights_own_logs_replay_to_the_commands_flown_in_wind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let set = [
        "--set",
        "weather.steady_m_s=[-2.2,0.0,-0.6]",
        "--set",
        "sensors.velocity_m_s.noise=0.05",
        "--set",
        "sensors.attitude_deg.noise=0.2",
    ];
    let fly = [
        "fly",
        "round-trip",
        "--log",
        "ulog,mcap,csv",
        "--out",
        "flown",
    ];
    succeeds(path, &[&fly[..], &set].concat());
    let trace = fs::read_to_string(path.join("flown/trace.csv")).unwrap();
    for log in ["flight.ulg", "flight.mcap", "flight.csv", "trace.csv"] {
        let log = format!("flown/{log}");
        let arguments = ["replay", &log, "--experiment", "round-trip"];
        let replayed = succeeds(path, &arguments);
        for of in ["thrust_n", "command_pitch_rad_s"] {
            let (logged, replayed) = (column(&trace, of), column(&replayed, of));
            assert_eq!(logged.len(), replayed.len());
            let differs = logged.iter().zip(&replayed).map(|(a, b)| (a - b).abs());
            let worst = differs.fold(0.0, f64::max);
            println!("{log} {of}: {worst}");
            // Roundings of attitudes and positions, over 60 s of the memory of the guidance: 1e-5 of 200 N and of 3 rad/s. Found: none.
            let tolerance = if of == "thrust_n" { 2e-3 } else { 3e-5 };
            assert!(worst < tolerance, "{log} {of}: {worst}");
        }
    }
}

/// Without errors of the sensors a flight's own log tells the controller what the flight told it.
#[test]
fn a_flights_own_ulog_replays_to_the_commands_flown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (name, tolerance) in [
        // A law of which nothing is remembered: roundings of the attitude and the wind, 1e-6 of 100 N.
        ("hover-to-cruise", 1e-3),
        // The guidance reckons with velocities, positions and its own memory, over 60 s: 1e-5 of 200 N.
        ("round-trip", 2e-2),
    ] {
        let fly = ["fly", name, "--log", "ulog,mcap", "--out", "flown"];
        let said = succeeds(path, &fly);
        assert!(said.contains("flight.ulg, flight.mcap"), "{said}");
        assert!(
            fs::read(path.join("flown/flight.mcap"))
                .unwrap()
                .starts_with(b"\x89MCAP")
        );
        let arguments = ["replay", "flown/flight.ulg", "--experiment", name];
        let replayed = succeeds(path, &arguments);
        let trace = fs::read_to_string(path.join("flown/trace.csv")).unwrap();
        for of in ["thrust_n", "command_pitch_rad_s"] {
            let (logged, replayed) = (column(&trace, of), column(&replayed, of));
            assert_eq!(logged.len(), replayed.len());
            let differs = logged.iter().zip(&replayed).map(|(a, b)| (a - b).abs());
            let worst = differs.fold(0.0, f64::max);
            assert!(worst < tolerance, "{name} {of}: {worst}");
        }
        let said = succeeds(path, &[&arguments[..], &["--out", "again"]].concat());
        assert_eq!(
            said.contains("gain of the full law, smallest"),
            name == "round-trip",
            "{said}"
        );
        assert_eq!(
            fs::read_to_string(path.join("again/commands.csv")).unwrap(),
            replayed
        );
        let page = fs::read_to_string(path.join("again/report.html")).unwrap();
        assert!(page.contains("<svg") && page.contains("flight.ulg, replayed"));
        assert_eq!(
            page.contains("angle to the nearest fold, first"),
            name == "round-trip"
        );
    }
}

/// A level flight east at 20 m/s, logged as text by an ArduPilot; nothing is asked for, so that the velocity flown is the reference. Neither
/// wind nor accelerometer is in the log: the guidance slows the vehicle down, with no thrust, as it does in flight.
#[test]
fn an_ardupilot_log_goes_through_the_guidance() {
    let folder = tempfile::tempdir().unwrap();
    let mut log = String::from(
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n\
         FMT, 10, 60, XKF1, QBccCffffff, TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,PN,PE,PD\n",
    );
    for row in 0..200 {
        let time = 1_000_000 + 20_000 * row;
        let east = 0.4 * f64::from(row);
        log += &format!("XKF1, {time}, 0, 0.0, 6.0, 90.0, 0.0, 20.0, 0.0, 0.0, {east}, -50.0\n");
    }
    fs::write(folder.path().join("flight.log"), log).unwrap();
    let arguments = ["replay", "flight.log", "--experiment", "round-trip"];
    let said = succeeds(folder.path(), &[&arguments[..], &["--out", "out"]].concat());
    assert!(said.contains("no wind: none of"), "{said}");
    assert!(
        said.contains("no velocity asked for in 200 of 200 rows"),
        "{said}"
    );
    let commands = succeeds(folder.path(), &arguments);
    let rates = column(&commands, "command_pitch_rad_s");
    let alpha = column(&commands, "law_alpha_rad");
    assert_eq!(rates.len(), 200);
    // θ = −84° and the velocity is level: α is 6° less the belief's δ, which is within 10°.
    assert!(alpha[100].to_degrees().abs() < 16.0, "{}", alpha[100]);
    assert!(rates.iter().all(|r| r.abs() < 3.0));
    assert_eq!(column(&commands, "thrust_n")[150], 0.0);
    assert!(commands.contains(",none,"));
}

#[test]
fn a_foreign_csv_is_read_through_its_map() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "log.csv",
        "ms,q0,q1,q2,q3,climb,east,north\n0,0.70710678,0,0.70710678,0,0,0,0\n10,0.70710678,0,0.70710678,0,0.5,0,0\n",
    );
    write(
        "map.toml",
        "time = { from = 'ms', scale = 0.001 }\n[columns]\nqw.from = 'q0'\nqx.from = 'q1'\nqy.from = 'q2'\nqz.from = 'q3'\n\
         vn.from = 'north'\nve.from = 'east'\nvd = { from = 'climb', scale = -1 }\n",
    );
    let arguments = ["replay", "log.csv", "--map", "map.toml"];
    let commands = succeeds(folder.path(), &arguments);
    // Nose up and at rest: the belief's hover thrust, 9 kg · 9.81 m/s².
    let thrust = column(&commands, "thrust_n");
    assert!((thrust[0] - 88.29).abs() < 1e-3, "{commands}");
    assert_eq!(column(&commands, "t_s"), [0.0, 0.01]);

    let refused = |arguments: &[&str], part: &str| {
        let output = alula(folder.path(), arguments);
        let message = text(&output.stderr);
        assert!(
            !output.status.success() && message.contains(part),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1, "{message}");
    };
    write(
        "short.toml",
        "time = { from = 'ms' }\n[columns]\nvn.from = 'nort'\n",
    );
    refused(
        &["replay", "log.csv", "--map", "short.toml"],
        "column `nort`: not in the header",
    );
    write(
        "bare.toml",
        "time = { from = 'ms' }\n[columns]\nvn.from = 'north'\n",
    );
    refused(
        &["replay", "log.csv", "--map", "bare.toml"],
        "no attitude; it holds csv; none of",
    );
    // This law is told the air's acceleration, which no log holds.
    let forward = [&arguments[..], &["--experiment", "steep-climb"]].concat();
    refused(&forward, "air acceleration");
}

/// Nose up, then over to the north in 4 s, at 20 Hz: as roll, pitch and yaw in degrees, at times `per_second`.
fn pitching(per_second: f64) -> String {
    let row = |n: i32| {
        let t = 2.0 + 0.05 * f64::from(n);
        let pitch = 85.0 - f64::from(n);
        format!(
            "{},0,{pitch},0,{},0,0\n",
            t * per_second,
            0.1 * f64::from(n)
        )
    };
    let rows: String = (0..80).map(row).collect();
    format!("t,r,p,y,vn,ve,vd\n{rows}")
}

const MAP: &str = "time = { from = \"t\" }\n[columns]\nroll.from = \"r\"\npitch.from = \"p\"\nyaw.from = \"y\"\nvn.from = \"vn\"\nve.from = \"ve\"\nvd.from = \"vd\"\n";

/// Angles of a foreign CSV, as its map names them, in degrees or radians, come to the commands of the same quaternions; a name that no quantity has is refused.
#[test]
fn a_map_knows_angles_and_its_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("x.csv"), pitching(1.0)).unwrap();
    fs::write(path.join("map.toml"), MAP).unwrap();
    let replay = |map: &str| {
        fs::write(path.join("map.toml"), map).unwrap();
        alula(path, &["replay", "x.csv", "--map", "map.toml"])
    };
    let degrees = replay(MAP);
    assert!(degrees.status.success(), "{}", text(&degrees.stderr));
    let radians = MAP.replace(
        "roll.from = \"r\"",
        "roll = { from = \"r\", unit = \"rad\", scale = 0.017453292519943295 }",
    );
    let radians = radians.replace(
        "pitch.from = \"p\"",
        "pitch = { from = \"p\", unit = \"rad\", scale = 0.017453292519943295 }",
    );
    let radians = radians.replace(
        "yaw.from = \"y\"",
        "yaw = { from = \"y\", unit = \"rad\", scale = 0.017453292519943295 }",
    );
    let of = |output: &Output, name: &str| column(&text(&output.stdout), name);
    // Roundings of double precision in single.
    for (a, b) in of(&degrees, "command_pitch_rad_s")
        .iter()
        .zip(of(&replay(&radians), "command_pitch_rad_s"))
    {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
    let half = |n: f64| (85.0 - n).to_radians() / 2.0;
    let rows: String = (0..80)
        .map(f64::from)
        .map(|n| {
            format!(
                "{},{},0,{},0,{},0,0\n",
                2.0 + 0.05 * n,
                half(n).cos(),
                half(n).sin(),
                0.1 * n
            )
        })
        .collect();
    fs::write(
        path.join("q.csv"),
        format!("t,qw,qx,qy,qz,vn,ve,vd\n{rows}"),
    )
    .unwrap();
    let quaternions = alula(path, &["replay", "q.csv"]);
    for (a, b) in of(&degrees, "thrust_n")
        .iter()
        .zip(of(&quaternions, "thrust_n"))
    {
        assert!((a - b).abs() < 1e-3, "{a} {b}");
    }
    let unknown = replay(&MAP.replace("pitch.from", "ptich.from"));
    let message = text(&unknown.stderr);
    assert!(
        message.starts_with(
            "error: map.toml:4: columns.ptich: no quantity has this name; did you mean `pitch`?"
        ),
        "{message}"
    );
}

/// A time that is not in seconds has steps that no controller runs on: the unit is asked for, and a header that says it is believed.
#[test]
fn a_time_in_another_unit_is_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("map.toml"), MAP).unwrap();
    for (per_second, name, scale) in [
        (1e3, "milliseconds", "0.001"),
        (1e6, "microseconds", "1e-6"),
    ] {
        fs::write(path.join("x.csv"), pitching(per_second)).unwrap();
        let output = alula(
            path,
            &["replay", "x.csv", "--map", "map.toml", "--out", "out"],
        );
        let message = text(&output.stderr);
        assert!(!output.status.success());
        // The log stands first, and not what was to be written.
        assert!(
            message.starts_with("error: x.csv: the usual step is"),
            "{message}"
        );
        assert!(
            message.contains(name) && message.contains(&format!("scale = {scale}")),
            "{message}"
        );
    }
    let header = "t [us],roll,pitch,yaw,vn,ve,vd";
    let text_of = pitching(1e6).replace("t,r,p,y,vn,ve,vd", header);
    fs::write(path.join("x.csv"), text_of).unwrap();
    let times = column(&succeeds(path, &["replay", "x.csv"]), "t_s");
    assert!(
        (times[0] - 2.0).abs() < 1e-9 && (times[79] - 5.95).abs() < 1e-9,
        "{times:?}"
    );
    // A trace of our own, whose name says seconds.
    succeeds(
        path,
        &[
            "fly",
            "round-trip",
            "--set",
            "duration_s=1",
            "--out",
            "flown",
        ],
    );
    let trace = fs::read_to_string(path.join("flown/trace.csv")).unwrap();
    let rows: String = trace
        .lines()
        .enumerate()
        .map(|(n, line)| match (n, line.split_once(',')) {
            (0, _) | (_, None) => format!("{line}\n"),
            (_, Some((time, rest))) => format!("{},{rest}\n", 1e3 * time.parse::<f64>().unwrap()),
        })
        .collect();
    fs::write(path.join("x.csv"), rows).unwrap();
    let output = alula(path, &["replay", "x.csv"]);
    assert!(
        text(&output.stderr).contains("in milliseconds?"),
        "{}",
        text(&output.stderr)
    );
}

/// What is wrong with a log stands before the names that were looked for.
#[test]
fn the_cause_of_an_empty_log_stands_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in ["x.bin", "x.ulg", "x.mcap", "x.csv"] {
        for (content, cause) in [
            (vec![0; 5000], "nothing but zeros"),
            (Vec::new(), "the file is empty"),
        ] {
            fs::write(path.join(name), content).unwrap();
            let message = text(&alula(path, &["replay", name, "--out", "out"]).stderr);
            assert!(
                message.starts_with(&format!("error: {name}: byte 0: {cause}")),
                "{message}"
            );
        }
    }
    fs::write(
        path.join("x.csv"),
        "t,qw,qx,qy,qz\n0,1,0,0,0\n0.1,1,0,0,0\n",
    )
    .unwrap();
    let message = text(&alula(path, &["replay", "x.csv", "--out", "out"]).stderr);
    assert!(
        message.starts_with("error: x.csv: no velocity: none of vn ve vd"),
        "{message}"
    );
}
