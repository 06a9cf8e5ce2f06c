//! Paths in space.

use alula_bridges::companion::{End, Kind, Settings, Stage};
use alula_sil::companion::{Craft, Lead, OnPath, settings};
use alula_sim::experiment::{Document, Experiment, V3};
use alula_sim::simulate::{Step, fly};

use super::link::{ARDUPLANE, BAD, Ended, GOOD, Quality, flies, nothing};

/// The path's north is north.
const NORTH: Lead = Lead::Path(Some(0.0));

fn experiment(name: &str, changes: &[&str]) -> Experiment {
    let mut document = Document::load(name).unwrap();
    for change in changes {
        document.assign(change).unwrap();
    }
    document.checked().unwrap()
}

/// How a flight went: of the vehicle itself, less what was to be flown at that time.
struct Flight {
    ended: Ended,
    /// Root mean squares after settling: velocity \[m/s\] and position \[m\].
    velocity: f64,
    position: f64,
    /// Lowest and highest over the path \[m\]: all along, and after settling.
    altitude: [f64; 2],
    settled: [f64; 2],
}

impl Flight {
    fn text(&self) -> String {
        let Self {
            velocity,
            position,
            altitude,
            settled,
            ..
        } = self;
        format!(
            "{velocity:.2} m/s, {position:.2} m, altitude {altitude:.1?}, after settling {settled:.1?} m"
        )
    }

    /// The worse of each.
    fn worse(&self, other: &Self) -> Self {
        let wider = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self {
            ended: self.ended,
            velocity: self.velocity.max(other.velocity),
            position: self.position.max(other.position),
            altitude: wider(self.altitude, other.altitude),
            settled: wider(self.settled, other.settled),
        }
    }
}

fn companion_flies(experiment: &Experiment, kind: Kind, quality: Quality, seed: u64) -> Flight {
    let settings = Settings {
        kind,
        ..settings(experiment, None).unwrap()
    };
    let mut pilot = OnPath::new(experiment, NORTH).unwrap();
    let mut truth: Vec<(f64, V3, V3)> = Vec::new();
    let mut origin = None;
    let ended = flies(
        &mut pilot,
        Craft::new(experiment).unwrap(),
        (settings, experiment.duration_s + 6.0),
        (quality, seed),
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
    let mut settled = [0.0_f64; 2];
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
        if t >= experiment.settle_time_s {
            velocity += (v - speed).norm_squared();
            position += (x - wanted).norm_squared();
            settled = [settled[0].min(above), settled[1].max(above)];
            count += 1;
        }
    }
    let mean = |sum: f64| (sum / f64::from(count)).sqrt();
    Flight {
        ended,
        velocity: mean(velocity),
        position: mean(position),
        altitude,
        settled,
    }
}

type Held = (&'static str, [f64; 2], [f64; 2], [f64; 2]);

/// Path, medians of the errors of velocity \[m/s\] and position \[m\] after settling, and the altitudes \[m\] over the path that no flight leaves
/// after settling and at all. What these links had, and 40 % more (of twenty: docs/results.md). The circle begins in full flight
/// with a set-point of hover under way, which lifts it or lets it sink before the first command arrives.
const PATHS: [Held; 3] = [
    ("circle-40", [0.15, 0.8], [-7.7, 8.0], [-18.0, 11.2]),
    ("eight", [0.41, 1.2], [-0.2, 0.2], [-0.2, 0.2]),
    ("mission", [1.14, 1.3], [-13.2, 4.9], [-13.2, 4.9]),
];

/// Links of 20 ms each way and 2 % of loss, of three seeds each, to either autopilot. A position is off along the path by the error of the
/// clocks, some 10 ms at 20 m/s, and by what set-points at 50 Hz miss. One flight in ten crosses the stall where others do not, and is off by 2 m/s.
#[test]
fn paths_in_space_are_flown_over_bad_links() {
    for (name, most, settled, all_along) in PATHS {
        let experiment = experiment(name, &[]);
        let mut errors = [const { Vec::new() }; 2];
        for (kind, seed) in [Kind::Px4, ARDUPLANE]
            .into_iter()
            .flat_map(|kind| [0, 1, 2].map(|seed| (kind, seed)))
        {
            let flight = companion_flies(&experiment, kind, BAD, seed);
            let what = format!("{name} {:?} {seed}: {}", kind.commanded(), flight.text());
            println!("{what}");
            let within =
                |[low, high]: [f64; 2], [least, most]: [f64; 2]| low > least && high < most;
            assert!(within(flight.settled, settled), "{what}");
            assert!(within(flight.altitude, all_along), "{what}");
            ended_well(&flight.ended, kind);
            errors[0].push(flight.velocity);
            errors[1].push(flight.position);
        }
        for (errors, most) in errors.iter_mut().zip(most) {
            errors.sort_by(f64::total_cmp);
            // The upper one of the middle two.
            assert!(errors[errors.len() / 2] < most, "{name} {errors:.2?}");
        }
    }
}

/// From hover to hover with a turn, in 3.6 m/s of wind from ahead and the side. In process 1.45 m/s and 1.59 m; over ten bad links at worst
/// 2.24 and 2.06, from 6.4 m below to 6.8 m above: it crosses the stall in the turn, sooner or later.
#[test]
fn a_wind_from_the_side_is_flown_in() {
    let experiment = experiment("mission", &["weather.steady_m_s=[-3,2,0]"]);
    for seed in 0..3 {
        let flight = companion_flies(&experiment, Kind::Px4, BAD, seed);
        println!(
            "mission in wind {seed}: {:.2} m/s, {:.2} m, {:.2?} m",
            flight.velocity, flight.position, flight.altitude
        );
        assert!(flight.velocity < 3.4 && flight.position < 4.0);
        let [low, high] = flight.altitude;
        assert!(low > -9.0 && high < 9.5, "{low} {high}");
        ended_well(&flight.ended, Kind::Px4);
    }
}

/// What HIGHRES_IMU says reaches the guidance.
#[test]
fn the_accelerometer_is_heard() {
    let experiment = experiment("eight", &["duration_s=40"]);
    let mut pilot = OnPath::new(&experiment, NORTH).unwrap();
    let settings = settings(&experiment, None).unwrap();
    flies(
        &mut pilot,
        Craft::new(&experiment).unwrap(),
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
            .all(|step| step.input.sample.specific_force.is_some())
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
    let end = (ended.mode, ended.losses, ended.after, ended.overridden);
    assert_eq!(end, (kind.hold(), 0, 0, false));
    assert!(ended.dropped > 20, "late messages: {}", ended.dropped);
}

/// What docs/results.md says of flights in space: `--ignored --nocapture paths`.
#[test]
#[ignore = "minutes: measures what the documentation states"]
fn measured_over_ten_links_each() {
    for (name, wind) in [
        ("circle-40", ""),
        ("eight", ""),
        ("mission", ""),
        ("waypoints", ""),
        ("mission", "weather.steady_m_s=[-3,2,0]"),
        ("circle-40", "weather.steady_m_s=[2,0,0]"),
    ] {
        let changes: Vec<&str> = Some(wind).into_iter().filter(|w| !w.is_empty()).collect();
        let experiment = experiment(name, &changes);
        let direct = fly(&experiment).unwrap();
        let settled: Vec<_> = direct
            .iter()
            .filter(|s| s.t >= experiment.settle_time_s)
            .collect();
        let rms = |of: fn(&Step) -> f64| {
            let sum: f64 = settled.iter().map(|step| of(step).powi(2)).sum();
            (sum / settled.len() as f64).sqrt()
        };
        let [v, x] = [
            rms(|s| s.velocity_error().norm()),
            rms(|s| s.position_error().norm()),
        ];
        println!("{name} {wind}: in process {v:.2} m/s, {x:.2} m");
        for kind in [Kind::Px4, ARDUPLANE] {
            let clean = companion_flies(&experiment, kind, GOOD, 0);
            println!("  {:?} clean {}", kind.commanded(), clean.text());
            let flights = (0..10).map(|seed| companion_flies(&experiment, kind, BAD, seed));
            let worst = flights.reduce(|a, b| a.worse(&b)).unwrap();
            println!("  {:?} worst {}", kind.commanded(), worst.text());
        }
    }
}
