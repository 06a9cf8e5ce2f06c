//! The guidance in space.

use alula_bridges::companion::{End, Kind, Settings, Stage};
use alula_sil::companion::Craft;
use alula_sil::companion::space::{OnPath, settings};
use alula_sil::experiment::Document;
use alula_sil::space::{Experiment, V3};

use super::link::{ARDUPLANE, BAD, Ended, GOOD, flies, nothing};

fn experiment(name: &str, changes: &[&str]) -> Experiment {
    let mut document = Document::load(name).unwrap();
    for change in changes {
        document.assign(change).unwrap();
    }
    Experiment::of(&document).unwrap()
}

/// How a flight went: of the vehicle itself, less what was to be flown at that time.
struct Flight {
    ended: Ended,
    /// Root mean squares after the entry: velocity \[m/s\] and position \[m\].
    velocity: f64,
    position: f64,
    /// Lowest and highest over the path, all along \[m\].
    altitude: [f64; 2],
}

fn companion_flies(experiment: &Experiment, kind: Kind, seed: u64) -> Flight {
    let settings = Settings {
        kind,
        ..settings(experiment, None).unwrap()
    };
    let mut pilot = OnPath::new(experiment, false).unwrap();
    let mut truth: Vec<(f64, V3, V3)> = Vec::new();
    let mut origin = None;
    let ended = flies(
        &mut pilot,
        Craft::in_space(experiment).unwrap(),
        (settings, experiment.duration_s + 6.0),
        (BAD, seed),
        nothing,
        |t, _, craft| {
            let state = craft.spatial();
            let from = *origin.get_or_insert(state.position);
            truth.push((t, state.position - from, state.velocity));
        },
    );
    // The record is of when the commands act; the path is read between its steps.
    let record = pilot.record();
    let (mut velocity, mut position, mut count) = (0.0, 0.0, 0);
    let mut altitude = [0.0_f64; 2];
    for (t, x, v) in truth {
        let next = record.partition_point(|step| step.t <= t);
        let (Some(a), Some(b)) = (next.checked_sub(1).map(|i| &record[i]), record.get(next)) else {
            continue;
        };
        let share = (t - a.t) / (b.t - a.t);
        let wanted = a.target.position.lerp(&b.target.position, share);
        let speed = a.target.velocity.lerp(&b.target.velocity, share);
        let above = wanted.z - x.z;
        altitude = [altitude[0].min(above), altitude[1].max(above)];
        if t >= experiment.entry_s {
            velocity += (v - speed).norm_squared();
            position += (x - wanted).norm_squared();
            count += 1;
        }
    }
    let mean = |sum: f64| (sum / f64::from(count)).sqrt();
    Flight {
        ended,
        velocity: mean(velocity),
        position: mean(position),
        altitude,
    }
}

/// Links of 20 ms each way and 2 % of loss, of three seeds each. In process at 100 Hz (velocity, position rms) the circle has 0.05 m/s and
/// 0.10 m, the eight 0.25 and 0.21, the mission 0.67 and 0.60; over the links at worst 0.12 and 0.83, 0.36 and 1.00, 1.11 and 1.57. A
/// position is off along the path by the error of the clocks, some 10 ms at 20 m/s, and by what set-points at 50 Hz miss. With one of the
/// links the circle is 3.4 m high for a moment.
#[test]
fn paths_in_space_are_flown_over_bad_links() {
    for (name, [velocity, position], lowest) in [
        ("circle-40", [0.2, 1.2], -1.5),
        ("eight", [0.5, 1.5], -0.5),
        ("mission", [1.4, 2.0], -1.5),
    ] {
        let experiment = experiment(name, &[]);
        for seed in 0..3 {
            let flight = companion_flies(&experiment, Kind::Px4, seed);
            let [low, high] = flight.altitude;
            println!(
                "{name} {seed}: {:.2} m/s, {:.2} m, {low:.2} to {high:.2} m",
                flight.velocity, flight.position
            );
            assert!(
                flight.velocity < velocity,
                "{name} {seed}: {}",
                flight.velocity
            );
            assert!(
                flight.position < position,
                "{name} {seed}: {}",
                flight.position
            );
            assert!(low > lowest && high < 4.5, "{name} {seed}: {low} {high}");
            ended_well(&flight.ended, Kind::Px4);
        }
    }
}

/// The same links, by sticks in QACRO.
#[test]
fn paths_in_space_are_flown_in_qacro() {
    for (name, [velocity, position], [lowest, highest]) in [
        ("circle-40", [0.3, 1.5], [-2.0, 4.5]),
        ("eight", [0.6, 1.5], [-0.8, 0.8]),
    ] {
        let experiment = experiment(name, &[]);
        for seed in 0..3 {
            let flight = companion_flies(&experiment, ARDUPLANE, seed);
            let [low, high] = flight.altitude;
            println!(
                "QACRO {name} {seed}: {:.2} m/s, {:.2} m, {low:.2} to {high:.2} m",
                flight.velocity, flight.position
            );
            assert!(flight.velocity < velocity && flight.position < position);
            assert!(low > lowest && high < highest);
            ended_well(&flight.ended, ARDUPLANE);
        }
    }
}

/// From hover to hover with a turn, in 3.6 m/s of wind from ahead and the side. In process 1.05 m/s and 1.54 m; over bad links at worst
/// 1.98 and 3.98, and 5.3 m below: it crosses the stall in the turn, sooner or later.
#[test]
fn a_wind_from_the_side_is_flown_in() {
    let experiment = experiment("mission", &["weather.steady_m_s=[-3,2,0]"]);
    for seed in 0..3 {
        let flight = companion_flies(&experiment, Kind::Px4, seed);
        println!(
            "mission in wind {seed}: {:.2} m/s, {:.2} m, {:.2?} m",
            flight.velocity, flight.position, flight.altitude
        );
        assert!(flight.velocity < 3.0 && flight.position < 6.0);
        assert!(flight.altitude[0] > -8.0, "{:?}", flight.altitude);
        ended_well(&flight.ended, Kind::Px4);
    }
}

/// What HIGHRES_IMU says reaches the guidance.
#[test]
fn the_accelerometer_is_heard() {
    let experiment = experiment("eight", &["duration_s=40"]);
    let mut pilot = OnPath::new(&experiment, false).unwrap();
    let settings = settings(&experiment, None).unwrap();
    flies(
        &mut pilot,
        Craft::in_space(&experiment).unwrap(),
        (settings, 45.0),
        (GOOD, 0),
        nothing,
        |_, _, _| (),
    );
    let record = pilot.record();
    assert!(record.len() > 1900);
    assert!(
        record
            .iter()
            .all(|step| step.input.specific_force.is_some())
    );
    // 20 m/s around an eight of 65 m: it is felt in the turns.
    let most = record
        .iter()
        .map(|step| step.load_factor)
        .fold(0.0, f64::max);
    assert!((1.5..3.0).contains(&most), "{most}");
}

fn ended_well(ended: &Ended, kind: Kind) {
    assert_eq!(ended.stage, Stage::Ended(End::Finished));
    let found = (ended.mode, ended.losses, ended.after, ended.overridden);
    assert_eq!(found, (kind.hold(), 0, 0, false));
    assert!(ended.dropped > 20, "late messages: {}", ended.dropped);
}

#[test]
#[ignore = "measures"]
fn distribution() {
    for name in ["circle-40", "eight", "mission"] {
        let experiment = experiment(name, &[]);
        for seed in 0..20 {
            for kind in [Kind::Px4, ARDUPLANE] {
                let flight = companion_flies(&experiment, kind, seed);
                println!(
                    "S {name} {seed} {} {:.2} {:.2} {:.2?}",
                    kind == Kind::Px4,
                    flight.velocity,
                    flight.position,
                    flight.altitude
                );
            }
        }
    }
}
