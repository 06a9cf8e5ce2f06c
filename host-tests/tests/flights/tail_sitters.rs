//! Vehicles as people own them, with limited authority: random flights of the four vehicle files.
//!
//! The draws: a speed of 0.7 to 1.05 of cruise, an acceleration and a braking of 1 to 3 m/s², a mass that is believed wrongly by up to
//! 5 %, any heading; falls at any attitude. Air data are exact: sensors as they are fly in the campaigns.

use alula::guidance::{Goal, GoalState, Goals, Preferences};
use alula::ned::Ned;
use alula_sim::experiment::tail_sitter::TailSitterSpec;
use alula_sim::experiment::{Document, Target, double, ned};
use alula_sim::figures::Figures;
use alula_sim::simulate::{Flight, fly};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

const VEHICLES: [&str; 4] = ["small-flying-wing", "mapping", "biplane", "heavy"];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// To speed and back to hover at one altitude.
    LevelBraking,
    /// The same in a climb of about v²/2g.
    ClimbingBraking,
    /// Any attitude, up to 6 m/s any way: to hover.
    Fall,
    /// Hover in calm air.
    Hover,
}

/// How flights ended.
#[derive(Default)]
struct Outcome {
    /// Those that fell.
    fell: Vec<u64>,
    /// Those that did not fall, and were not at rest at the end.
    unfinished: Vec<u64>,
    /// Altitude under and over the path \[m\], and body rate at the end \[rad/s\].
    low: Vec<f64>,
    high: Vec<f64>,
    rate: Vec<f64>,
}

fn document(vehicle: &str, kind: Kind, seed: u64) -> Document {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = |from: f64, to: f64| random.random_range(from..to);
    let heading = uniform(-180.0, 180.0);
    let scale = uniform(0.95, 1.05);
    let base = if kind == Kind::Fall || kind == Kind::Hover {
        "tail-sitter-fall"
    } else {
        "tail-sitter-braking"
    };
    let mut document = Document::load(base).unwrap();
    let mut set = |text: String| document.assign(&text).unwrap();
    set(format!("plant.vehicle='{vehicle}'"));
    set("sensors='exact'".to_owned());
    set(format!("seed={seed}"));
    match kind {
        Kind::LevelBraking | Kind::ClimbingBraking => {
            let cruise = cruise(vehicle);
            let speed = cruise * uniform(0.7, 1.05);
            let up = speed / uniform(1.0, 3.0);
            let braking = speed / uniform(1.0, 3.0);
            let on = up + 6.0;
            let climb = if kind == Kind::ClimbingBraking {
                uniform(0.8, 1.2) * speed * speed / 19.6
            } else {
                0.0
            };
            // A climb that grows over a third of the braking and falls over another: two thirds of the time at the greatest rate.
            let rate = climb / (braking * 2.0 / 3.0);
            let knot = |t: f64, down: f64, forward: f64| {
                format!("{{t_s={t:.3},down_m_s={down:.4},forward_m_s={forward:.4}}}")
            };
            let third = braking / 3.0;
            let knots = [
                knot(0.0, 0.0, 0.0),
                knot(up, 0.0, speed),
                knot(on, 0.0, speed),
                knot(on + third, -rate, speed * 2.0 / 3.0),
                knot(on + 2.0 * third, -rate, speed / 3.0),
                knot(on + braking, 0.0, 0.0),
            ];
            set(format!("reference.knots=[{}]", knots.join(",")));
            set(format!("duration_s={:.1}", on + braking + 20.0));
            set("initial={}".to_owned());
        }
        Kind::Fall => {
            set(format!(
                "initial={{velocity_m_s=[0,0,2],heading_deg={heading},scatter={{velocity_m_s=6,rate_rad_s=0.5}}}}"
            ));
        }
        Kind::Hover => {
            set(format!(
                "initial={{velocity_m_s=[0.3,0.2,0],heading_deg={heading}}}"
            ));
            set("duration_s=15".to_owned());
            set("settle_time_s=5".to_owned());
        }
    }
    document.pin_belief().unwrap();
    let path = "plant.vehicle.mass_kg";
    let mass = document.number(path).unwrap();
    document
        .assign(&format!("{path}={}", mass * scale))
        .unwrap();
    document
}

fn cruise(vehicle: &str) -> f64 {
    let texts = alula_sim::experiment::tail_sitter::VEHICLES;
    let (_, text) = texts.iter().find(|(name, _)| *name == vehicle).unwrap();
    let spec: TailSitterSpec = toml::from_str(text).unwrap();
    spec.cruise_speed_m_s
}

fn flights(vehicle: &str, kind: Kind, seeds: std::ops::Range<u64>) -> Outcome {
    let mut outcome = Outcome::default();
    for seed in seeds {
        let experiment = document(vehicle, kind, seed).checked().unwrap();
        let figures = Figures::of(&experiment, &fly(&experiment).unwrap());
        let value = |name: &str| figures.get(name);
        let (low, end) = (
            value("altitude_least_m"),
            value("late_velocity_error_rms_m_s"),
        );
        // A fall ends in hover within 100 m; no other flight sinks by 10 m.
        let deepest = if kind == Kind::Fall { -100.0 } else { -10.0 };
        // NaN has fallen.
        if low.is_nan() || low <= deepest {
            outcome.fell.push(seed);
        } else if end > 5.0 {
            outcome.unfinished.push(seed);
        }
        outcome.low.push(low);
        outcome.high.push(value("altitude_most_m"));
        outcome.rate.push(value("late_rate_rms_rad_s"));
    }
    for values in [&mut outcome.low, &mut outcome.high, &mut outcome.rate] {
        values.sort_by(f64::total_cmp);
    }
    outcome
}

fn row(vehicle: &str, kind: Kind, seeds: std::ops::Range<u64>) -> Outcome {
    let count = seeds.end - seeds.start;
    let o = flights(vehicle, kind, seeds);
    let n = o.low.len();
    println!(
        "| {vehicle} | {kind:?} | {} of {count} {:?} | {} {:?} | {:.1} | {:.1} | {:.1} | {:.3} |",
        o.fell.len(),
        o.fell,
        o.unfinished.len(),
        o.unfinished,
        o.low[n / 2],
        o.low[0],
        o.high[n - 1],
        o.rate[n - 1]
    );
    o
}

const KINDS: [Kind; 4] = [
    Kind::LevelBraking,
    Kind::ClimbingBraking,
    Kind::Fall,
    Kind::Hover,
];

/// Falls on their back at the elevons' stop, motors at rest: the attitude that did not follow got no thrust, and they fell for good. They end in hover,
/// 39 and 38 m lower, and 21 and 23 m where a vehicle goes to its place slowly across its plane of flight, too. 50 m is lost, as everywhere.
#[test]
fn falls_that_were_lost_end_in_hover() {
    for (vehicle, seed) in [("mapping", 137), ("mapping", 216)] {
        let o = row(vehicle, Kind::Fall, seed..seed + 1);
        assert!(
            o.low[0] > -50.0 && o.unfinished.is_empty(),
            "{vehicle} {seed}"
        );
    }
}

/// The figures of the experiment `base` with these fields changed.
fn flown(base: &str, changes: &[&str]) -> Figures {
    let mut document = Document::load(base).unwrap();
    for change in changes {
        document.assign(change).unwrap();
    }
    let experiment = document.checked().unwrap();
    Figures::of(&experiment, &fly(&experiment).unwrap())
}

/// A large wing that brakes level, with the elevons at their stop at the stall: it flew on at 14 to 21 m/s, to and fro between climb and dive, and three of
/// three were not back (12.5 to 17.7 m/s off at the end). They stop in a climb of 33 to 36 m, and come back at 4.5 to 4.8 m/s; 6 m/s is not back in the campaigns.
#[test]
fn a_braking_that_the_stall_held_ends_in_hover() {
    for seed in 1..4 {
        let figures = flown(
            "tail-sitter",
            &[
                "plant.vehicle='heavy'",
                "plant.variation={size=1.0,mass=1.08,pitch_inertia=1.18,thrust=0.985,travel=0.96,elevon=1.09,centre_of_mass_chord=-0.0035,stall_deg=-1.7}",
                "plant.unknown={mass=0.998,thrust=1.04,travel=1.016,centre_of_mass_chord=-0.004,stall_deg=-1.42}",
                "sensors='autopilot'",
                "initial={}",
                "duration_s=80.0",
                "reference.knots=[{t_s=2.0,down_m_s=0.0,forward_m_s=0.0},{t_s=15.0,down_m_s=0.0,forward_m_s=21.1},{t_s=21.0,down_m_s=0.0,forward_m_s=21.1},{t_s=37.0,down_m_s=0.0,forward_m_s=0.0}]",
                "weather.turbulence={wind_at_20_ft_m_s=3.0,height_m=60.0}",
                "weather.steady_m_s=[2.0,-2.2,0.0]",
                &format!("seed={seed}"),
            ],
        );
        let off = figures.get("late_velocity_error_rms_m_s");
        let low = figures.get("altitude_least_m");
        assert!(off < 6.0 && low > -20.0, "{seed}: {off} m/s, {low} m");
        // The stall has held it for 8 s when it stops.
        let stopped = figures.get("elevons_stopped_s");
        assert!((4.0..40.0).contains(&stopped), "{seed}: {stopped} s");
    }
}

/// Two `mapping` that start past their stall, of `tail-sitters` flights 1906 and 1104, in two turbulences each: elevons at their stop at α of 20°, which the
/// normal force took for 6°, thrust at 0.2 of the weight and the pitch rate at its limit for as long as cruise was asked for. They sank by 63, 121, 28 and 174 m.
/// They gather speed now, and sink by 4 to 7 m; the campaigns call 20 m lost.
#[test]
fn a_start_that_the_stall_held_goes_on() {
    let flights = [
        [
            "plant.variation={size=0.8444,mass=1.0259,pitch_inertia=0.9387,thrust=1.1472,travel=1.1078,elevon=1.0263,centre_of_mass_chord=0.00777,stall_deg=-1.698}",
            "plant.unknown={mass=1.0175,thrust=0.9755,travel=1.0798,centre_of_mass_chord=-0.0052,stall_deg=-1.46}",
            "reference.knots=[{t_s=2.0,down_m_s=0.0,forward_m_s=0.0},{t_s=12.69,down_m_s=0.0,forward_m_s=15.63},{t_s=18.69,down_m_s=0.0,forward_m_s=15.63},{t_s=21.09,down_m_s=-3.125,forward_m_s=10.42},{t_s=23.62,down_m_s=-3.125,forward_m_s=5.21},{t_s=27.07,down_m_s=0.0,forward_m_s=0.0}]",
            "weather.steady_m_s=[-0.79,0.45,0.0]",
        ],
        [
            "plant.variation={size=0.9157,mass=1.0563,pitch_inertia=1.0935,thrust=0.9647,travel=1.132,elevon=0.9426,centre_of_mass_chord=0.01372,stall_deg=-1.695}",
            "plant.unknown={mass=1.039,thrust=0.9384,travel=1.0553,centre_of_mass_chord=-0.0035,stall_deg=-1.012}",
            "reference.knots=[{t_s=2.0,down_m_s=0.0,forward_m_s=0.0},{t_s=16.9,down_m_s=0.0,forward_m_s=16.07},{t_s=22.9,down_m_s=0.0,forward_m_s=16.07},{t_s=25.43,down_m_s=-3.214,forward_m_s=10.71},{t_s=27.67,down_m_s=-3.214,forward_m_s=5.356},{t_s=30.2,down_m_s=0.0,forward_m_s=0.0}]",
            "weather.steady_m_s=[1.01,1.14,0.0]",
        ],
    ];
    let seeds = [["seed=7318774440736122020", "seed=2"], ["seed=5", "seed=6"]];
    for (changes, seeds) in flights.into_iter().zip(seeds) {
        for seed in seeds {
            let common = [
                "plant.vehicle='mapping'",
                "sensors='autopilot'",
                "initial={}",
                "duration_s=60.0",
                "weather.turbulence={wind_at_20_ft_m_s=3.0,height_m=60.0}",
                seed,
            ];
            let figures = flown("tail-sitter", &[&changes[..], &common].concat());
            let low = figures.get("altitude_least_m");
            assert!(low > -20.0, "{} {seed}: {low} m", changes[3]);
        }
    }
}

/// What a stop from cruise came to \[m\]: how far over and under the reference, and how much higher than it began.
struct Stopped {
    over: f64,
    under: f64,
    climbed: f64,
    /// Speed at the end [m/s].
    speed: f64,
}

/// Cruise at 0.75 to 1 of it, with an autopilot's estimates, in light turbulence and a wind of up to 0.2 of cruise from anywhere, or in calm; and a stop that
/// may climb by so much.
fn stopped(vehicle: &str, seed: u64, wind: f64, braking_climb: f32) -> Stopped {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let speed = cruise(vehicle) * random.random_range(0.75..1.0);
    let (from, share) = (
        random.random_range(0.0..std::f64::consts::TAU),
        wind * random.random_range(0.0..1.0) * cruise(vehicle),
    );
    let mut document = Document::load("tail-sitter-hover").unwrap();
    for change in [
        format!("plant.vehicle='{vehicle}'"),
        format!("seed={seed}"),
        "duration_s=60.0".to_owned(),
        format!("initial={{theta_deg=-86.0,velocity_m_s=[{speed},0.0,0.0],course_deg=0.0}}"),
        format!(
            "weather.steady_m_s=[{},{},0.0]",
            share * from.cos(),
            share * from.sin()
        ),
        format!(
            "weather.turbulence={{wind_at_20_ft_m_s={},height_m=50.0}}",
            if wind > 0.0 { 7.7 } else { 1e-3 }
        ),
    ] {
        document.assign(&change).unwrap();
    }
    let experiment = document.checked().unwrap();
    let mut controller = experiment.controller().unwrap();
    let dt = (1.0 / experiment.control_rate_hz) as f32;
    let preferences = Preferences::default()
        .speed(speed as f32)
        .braking_climb(braking_climb);
    let (goals, mut state) = (Goals::new(preferences).unwrap(), GoalState::default());
    let mut flight = Flight::new(&experiment).unwrap();
    let mut came_to = Stopped {
        over: 0.0,
        under: 0.0,
        climbed: 0.0,
        speed: 0.0,
    };
    let mut began = f64::NAN;
    for n in 0..6000 {
        let braking = n >= 1000;
        let goal = match braking {
            false => Goal::Velocity(Ned::new(speed as f32, 0.0, 0.0)),
            true => Goal::Stop,
        };
        let step = flight.ask_for(controller.as_mut(), |measured| {
            let (position, velocity) = (ned(measured.position), ned(measured.velocity));
            let asked = goals.step(&mut state, &goal, position, velocity, dt);
            let target = Target {
                position: measured.position - double(asked.position_error),
                velocity: double(asked.reference.velocity),
                acceleration: double(asked.reference.acceleration),
                heading: None,
            };
            (target, asked.planner_options)
        });
        let step = step.unwrap();
        if n == 1000 {
            began = step.truth.position.z;
        }
        if braking {
            came_to.over = came_to.over.max(step.altitude());
            came_to.under = came_to.under.max(-step.altitude());
            came_to.climbed = came_to.climbed.max(began - step.truth.position.z);
            came_to.speed = step.truth.velocity.norm();
        }
        flight.advance(&step.answer);
    }
    came_to
}

/// The same of many, printed: the value that so many of ten are below.
fn stops(
    vehicle: &str,
    seeds: std::ops::Range<u64>,
    wind: f64,
    braking_climb: f32,
) -> Vec<Stopped> {
    let all: Vec<_> = seeds
        .into_par_iter()
        .map(|seed| stopped(vehicle, seed, wind, braking_climb))
        .collect();
    let of = |value: &dyn Fn(&Stopped) -> f64| {
        let mut sorted: Vec<f64> = all.iter().map(value).collect();
        sorted.sort_by(f64::total_cmp);
        [0.5, 0.9, 1.0].map(|share| sorted[((sorted.len() - 1) as f64 * share) as usize])
    };
    println!(
        "| {vehicle} | {wind} | {braking_climb} | {} | over {:.1?} | under {:.1?} | climbed {:.1?} | end {:.2?} m/s | within 3 m: {} |",
        all.len(),
        of(&|s| s.over),
        of(&|s| s.under),
        of(&|s| s.climbed),
        of(&|s| s.speed),
        all.iter().filter(|s| s.over < 3.0 && s.under < 3.0).count()
    );
    all
}

/// A wing that cannot brake level rises where it stops by 13 m and more; where it may climb it follows the climb.
#[test]
fn a_stop_that_may_climb_follows_its_climb() {
    for s in stops("mapping", 1..4, 0.0, 0.0) {
        assert!(s.over > 8.0, "{}", s.over);
    }
    for s in stops("mapping", 1..4, 0.0, 40.0) {
        // Of 40 two are beyond 3 m.
        assert!(s.over < 3.0 && s.under < 3.0, "{} {}", s.over, s.under);
        assert!(s.speed < 1.0, "{}", s.speed);
    }
    let light = stops("mapping", 1..9, 0.2, 40.0);
    let off = light.iter().filter(|s| s.over > 3.0 || s.under > 3.0);
    // Of 40 seven are.
    assert!(off.count() <= 3);
}

/// A biplane in 2.5 m/s of wind whose mass and thrust are believed wrongly by 5 and 8 %. The law leans it by 0.2 rad more than the model, and where the
/// two take turns it nods by 1.01 rad/s; with the lean learned by 0.07 rad/s. 0.2 rad/s is well above what turbulence makes, 0.1.
#[test]
fn a_lean_that_nobody_told_of_is_no_nod() {
    let figures = flown(
        "tail-sitter-hover",
        &[
            "plant.vehicle='biplane'",
            "plant.variation={size=1.2,thrust=1.2}",
            "plant.unknown={mass=0.95,thrust=0.92}",
            "weather.steady_m_s=[2.5,0,0]",
        ],
    );
    let rate = figures.get("late_rate_rms_rad_s");
    assert!(rate < 0.2, "{rate}");
    assert_eq!(figures.get("elevons_stopped_s"), 0.0);
}

/// Three draws of each: none falls, all come back, and hover is quiet.
#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_vehicles_with_limited_authority_are_not_lost() {
    for vehicle in VEHICLES {
        for kind in KINDS {
            let o = row(vehicle, kind, 0..3);
            assert!(o.fell.is_empty(), "{vehicle} {kind:?} {:?}", o.fell);
            // From 60 m below, the heavy one is still on its way up. Those of `mapping` are counted below.
            let late = usize::from(kind == Kind::Fall && ["heavy", "mapping"].contains(&vehicle));
            assert!(o.unfinished.len() <= late, "{vehicle} {kind:?}");
            if kind == Kind::Hover {
                // Nods of 1.9 rad/s were seen where the surfaces' force was taken for an error of the belief.
                assert!(o.rate[2] < 0.1, "{vehicle}: {}", o.rate[2]);
            }
        }
    }
}

/// Thirty falls. Which of them are not at rest after 30 s is chance, and a change of a bit makes it others: of 180 there are 2, before and after what the
/// first bound is for. Where plans put off the way to the place again and again, 70 of 180 nod at the end by more than 0.3 rad/s, which is fewer than 5 of 30
/// in one draw of 300; now 4 of 180 do.
#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_falls_end_at_rest() {
    let o = row("mapping", Kind::Fall, 0..30);
    let nods = o.rate.iter().filter(|rate| **rate > 0.3).count();
    println!("{nods} nod");
    assert!(nods <= 4, "{nods} nod");
    assert!(o.fell.is_empty() && o.unfinished.len() <= 3);
}

/// Stops from cruise, level and in a climb, on seeds that nothing was tuned on.
#[test]
#[ignore = "minutes: cargo test -p alula-sil --test flights tail_sitters::stops_in -- --ignored --show-output"]
fn stops_in_distribution() {
    for vehicle in VEHICLES {
        for wind in [0.0, 0.2] {
            for climb in [0.0, 100.0] {
                stops(vehicle, 5000..5040, wind, climb);
            }
        }
    }
}

/// The distribution, on seeds that nothing was tuned on.
#[test]
#[ignore = "minutes: cargo test --release -p alula-sil --test flights tail_sitters:: -- --ignored --show-output"]
fn the_distribution() {
    for vehicle in VEHICLES {
        for kind in KINDS {
            row(vehicle, kind, 1000..1050);
        }
    }
}
