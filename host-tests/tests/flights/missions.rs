//! Missions: what is flown at a constant airspeed in wind and turbulence, surveys against the wind triangle, take-off to landing.
//!
//! Counts are small by default. `MISSION_FLIGHTS=1000 cargo test --release -p alula-sil --test flights missions:: -- --nocapture` prints the tables of `docs/missions.md`.

use alula::guidance::Phase;
use alula::mission::{Activity, MissionOutput, Response, Troubles};
use alula_sim::experiment::{Document, Experiment, V3};
use alula_sim::simulate::{Step, simulate};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Flights of each cell; seeds of the tables begin elsewhere than those that constants were chosen with.
fn flights(few: u64) -> std::ops::Range<u64> {
    let count = std::env::var("MISSION_FLIGHTS").ok();
    let count = count.and_then(|text| text.parse().ok()).unwrap_or(few);
    10_000..10_000 + count
}

/// The value below which `share` of the values lie.
fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1) as f64;
    sorted
        .get((last * share) as usize)
        .copied()
        .unwrap_or(f64::NAN)
}

/// What one flight was like.
#[derive(Clone, Default)]
struct Flown {
    /// Time in which the stall is crossed at the speed of the items \[s\].
    crossing: f64,
    /// Mean thrust there, and that of steady flight \[N\].
    thrust: [f64; 2],
    /// 95 % of the distances across the path, of those in height \[m\], and of the load factor over that of the turn.
    across: f64,
    height: f64,
    load: f64,
    /// The same that the gusts alone make of it, see [`Frozen`].
    gust_load: f64,
    /// Whether it was ever 50 m below what was asked for.
    lost: bool,
    drifted: bool,
    /// Length of the mission \[s\], once it is over.
    over: Option<f64>,
    energy: f64,
    /// Sink, speed along the ground [m/s], distance from the place \[m\] and tilt \[°\] at touch-down.
    touch: Option<[f64; 4]>,
    /// Whether it says that it is too windy.
    windy: bool,
    /// Whether it hits the ground where it does not land.
    hit: bool,
}

fn set(document: &mut Document, fields: &[String]) {
    for field in fields {
        document.assign(field).unwrap();
    }
}

/// The number of the column that says whether a vehicle touches the ground.
fn grounded(experiment: &Experiment) -> Option<usize> {
    let plant = experiment.plant(experiment.initial.state(
        &experiment.path.path().unwrap().start(),
        &mut ChaCha8Rng::seed_from_u64(0),
    ));
    let named = |column: &(&str, &str)| column.0 == "grounded";
    plant.columns().iter().position(named)
}

/// A wing of fixed attitude in the gusts that a flight meets, which heaves as they lift it: the load that is there before anything turns.
struct Frozen {
    /// k_a dc_L/dα over the mass [1/m].
    slope: f64,
    steady: V3,
    /// How fast it is carried up [m/s].
    rise: f64,
}

impl Frozen {
    fn new(experiment: &Experiment) -> Self {
        let vehicle = experiment.vehicle.reference();
        let lift = |degrees: f64| vehicle.aerodynamics.at(degrees.to_radians()).c_l;
        let slope = (lift(5.0) - lift(2.0)) / 3.0_f64.to_radians();
        Self {
            slope: vehicle.k_a * slope / vehicle.mass,
            steady: experiment.weather.steady,
            rise: 0.0,
        }
    }

    /// Load factor that the gust adds to a turn of `load`, in the step of `dt` \[s\].
    fn added(&mut self, step: &Step, load: f64, dt: f64) -> f64 {
        const G: f64 = 9.81;
        let gust = step.wind - self.steady;
        let air = step.truth.velocity - step.wind;
        let speed = air.norm();
        let [_, belly, _] = step.truth.axes();
        let (up, along) = (-gust.dot(&belly), -gust.dot(&air) / speed);
        let added = self.slope * speed * (up - self.rise) / G + 2.0 * load * along / speed;
        self.rise += G * added * dt;
        added
    }
}

/// How far it is from its path \[m\], level and across its course: along it what is measured is behind.
fn across_course(step: &Step) -> f64 {
    let course = step.target.velocity.xy();
    step.position_error().xy().perp(&course).abs() / course.norm().max(1e-6)
}

fn fly(experiment: &Experiment) -> Flown {
    let mut controller = experiment.controller().unwrap();
    let mut flight = Flown::default();
    let (mut across, mut height) = (Vec::new(), Vec::new());
    let (mut load, mut gust_load) = (Vec::new(), Vec::new());
    let mut frozen = Frozen::new(experiment);
    let (mut last, mut descending) = (Activity::Grounded, false);
    let contact = grounded(experiment);
    let mut settled = 0;
    let mut high = false;
    let visit = |step: &Step| {
        let asked = step.mission.expect("a mission");
        let progress = asked.progress;
        let needed = f64::from(progress.load_factor);
        let gust = match asked.activity {
            Activity::Flying => frozen.added(step, needed, 1.0 / experiment.control_rate_hz),
            _ => 0.0,
        };
        if asked.activity == Activity::Flying && progress.settled {
            settled += 1;
            let guided = step.answer.guided().expect("the guidance");
            if guided.progress.phase == Phase::Crossing {
                flight.crossing += 1.0 / experiment.control_rate_hz;
            }
            flight.thrust[0] += step.truth.thrust;
            flight.thrust[1] += f64::from(progress.steady_thrust);
            across.push(across_course(step));
            height.push(step.altitude().abs());
            load.push(step.load_factor / needed);
            gust_load.push(1.0 + gust / needed);
        }
        flight.windy |= asked.remark == Some(alula::mission::Remark::TooWindy);
        flight.drifted |= asked.remark == Some(alula::mission::Remark::Drifting);
        let airborne = !matches!(
            asked.activity,
            Activity::Grounded | Activity::Spooling | Activity::Touched
        );
        flight.lost |= airborne && step.altitude() < -50.0;
        flight.energy = progress.energy.into();
        if asked.activity == Activity::Descending && last != Activity::Descending {
            descending = true;
        }
        let touches = contact.map_or(asked.activity == Activity::Touched, |n| {
            step.readings[n] > 0.5
        });
        high |= step.truth.position.z < -2.0;
        flight.hit |= high && touches && airborne && asked.activity != Activity::Descending;
        if descending && touches {
            descending = false;
            let off = step.truth.position - step.target.position;
            flight.touch = Some([
                step.truth.velocity.z,
                step.truth.velocity.xy().norm(),
                off.xy().norm(),
                90.0 - step.pitch().to_degrees(),
            ]);
        }
        if asked.activity == Activity::Grounded && last == Activity::Touched {
            flight.over = Some(step.t);
        }
        last = asked.activity;
        flight.over.is_none() && !flight.lost
    };
    let end = simulate(experiment, controller.as_mut(), visit).unwrap();
    end.sound().unwrap();
    flight.thrust = flight.thrust.map(|sum| sum / f64::from(settled.max(1)));
    flight.across = quantile(across, 0.95);
    flight.height = quantile(height, 0.95);
    flight.load = quantile(load, 0.95);
    flight.gust_load = quantile(gust_load, 0.95);
    flight
}

/// In cruise to the north with this speed [m/s] and thrust \[N\], in wind from anywhere of 3 m/s to the `most_wind`, none in calm.
fn cruising(
    document: &mut Document,
    random: &mut ChaCha8Rng,
    number: u64,
    turbulence: f64,
    most_wind: f64,
    (speed, thrust): (f64, f64),
) {
    let wind = if turbulence > 1.0 {
        random.random_range(3.0..most_wind)
    } else {
        0.0
    };
    let from: f64 = random.random_range(0.0..std::f64::consts::TAU);
    let (north, east) = (wind * from.cos(), wind * from.sin());
    let turbulence = turbulence.max(1e-3);
    set(
        document,
        &[
            format!("weather.steady_m_s=[{north},{east},0.0]"),
            format!("weather.turbulence={{ wind_at_20_ft_m_s = {turbulence}, height_m = 50.0 }}"),
            format!(
                "initial={{ theta_deg = -86.0, thrust_n = {thrust}, velocity_m_s = [{speed}, 0.0, 0.0], course_deg = 0.0 }}"
            ),
            format!("seed={number}"),
        ],
    );
}

/// Masses of five vehicles by rule \[kg\].
const MASSES: [f64; 5] = [0.5, 2.0, 5.0, 10.0, 25.0];

/// A vehicle as it is, with its speed of cruise [m/s] and its weight \[N\].
fn as_it_is(kind: &str) -> (Document, f64, f64) {
    let mut document = Document::load("tail-sitter").unwrap();
    set(&mut document, &[format!("plant.vehicle=\"{kind}\"")]);
    let speed = document.number("plant.vehicle.cruise_speed_m_s").unwrap();
    let weight = document.number("plant.vehicle.mass_kg").unwrap() * 9.81;
    (document, speed, weight)
}

/// A vehicle by rule, with a belief that is wrong, in wind of 3 to 8 m/s from anywhere; its speed of cruise.
fn by_rule(random: &mut ChaCha8Rng, number: u64, turbulence: f64) -> (Document, f64) {
    let mut document = Document::load("cruise-in-air").unwrap();
    let mass = MASSES[(number % 5) as usize];
    // Wing loading grows with the cube root of the mass; the lift coefficient of cruise is 0.31.
    let speed = 22.0 * (mass / 10.0_f64).powf(1.0 / 6.0);
    let k_a = mass * 9.81 / (0.31 * speed * speed);
    let drag = random.random_range(0.03..0.06);
    let believed = mass * random.random_range(0.93..1.07);
    let area = k_a * random.random_range(0.85..1.15);
    cruising(
        &mut document,
        random,
        number,
        turbulence,
        8.0,
        (speed, 0.12 * mass * 9.81),
    );
    set(
        &mut document,
        &[
            format!("vehicle.mass_kg={mass}"),
            format!("vehicle.k_a_kg_m={k_a}"),
            format!("vehicle.aerodynamics.combined.c0={drag}"),
            format!("controller.guidance.vehicle.mass_kg={believed}"),
            format!("controller.guidance.vehicle.k_a_kg_m={area}"),
            format!("controller.guidance.vehicle.aerodynamics.combined.c0={drag}"),
            format!(
                "controller.guidance.for_vehicle={{ rate_lag_s = 0.1, thrust_lag_s = 0.05, control_rate_hz = 100.0, cruise_speed_m_s = {speed} }}"
            ),
            format!("plant.thrust_n=[0.0,{}]", 2.0 * mass * 9.81),
            "sensors.air=\"wind-estimate\"".to_owned(),
        ],
    );
    (document, speed)
}

/// Most wind over the airspeed: that of the lightest by rule in 8 m/s.
const MOST_WIND: f64 = 0.6;

/// A vehicle of a kind with an autopilot's estimates, in wind of 3 to 8 m/s from anywhere, as far as its airspeed allows; its speed of cruise.
fn of_kind(kind: &str, random: &mut ChaCha8Rng, number: u64, turbulence: f64) -> (Document, f64) {
    let (mut document, speed, weight) = as_it_is(kind);
    let most_wind = f64::min(8.0, MOST_WIND * speed);
    cruising(
        &mut document,
        random,
        number,
        turbulence,
        most_wind,
        (speed, 0.15 * weight),
    );
    (document, speed)
}

/// A loiter, or legs past corners, or a survey over its lines: by number.
fn work(random: &mut ChaCha8Rng, kind: u64, speed: f64) -> String {
    let length = 12.0 * speed;
    match kind % 3 {
        0 => {
            let radius = speed * speed * random.random_range(0.21..0.36);
            let side = if random.random_bool(0.5) { 1.0 } else { -1.0 };
            format!(
                "{{ loiter = {{ north_m = {}, east_m = {}, height_m = 0.0, radius_m = {} }} }}",
                0.7 * length,
                0.3 * length,
                side * radius
            )
        }
        1 => {
            let corner = |n: f64, e: f64, h: f64| {
                format!(
                    "{{ waypoint = {{ north_m = {}, east_m = {}, height_m = {h} }} }}",
                    n * length,
                    e * length
                )
            };
            [
                corner(2.0, 0.0, 0.0),
                corner(2.5, 2.0, 10.0),
                corner(4.5, 2.5, 10.0),
                corner(4.5, 5.0, 0.0),
                corner(9.0, 5.0, 0.0),
            ]
            .join(", ")
        }
        _ => {
            let line = |n: u32| {
                let (from, to) = if n.is_multiple_of(2) {
                    (1.0, 3.0)
                } else {
                    (3.0, 1.0)
                };
                let at = |north: f64| {
                    format!(
                        "{{ waypoint = {{ north_m = {}, east_m = {}, height_m = 0.0, over = true }} }}",
                        north * length,
                        3.0 * speed * f64::from(n)
                    )
                };
                [at(from), at(to)].join(", ")
            };
            (0..5).map(line).collect::<Vec<_>>().join(", ")
        }
    }
}

/// Weather: its name, the wind at 20 ft [m/s], and the bounds of the work in it.
struct Weather {
    name: &'static str,
    turbulence: f64,
    /// Most flights that cross the stall.
    crossing: f64,
    /// Thrust over that of steady flight.
    thrust: f64,
    /// Across, in height \[m\].
    across: f64,
    height: f64,
}

const WEATHERS: [Weather; 3] = [
    Weather {
        name: "calm",
        turbulence: 0.0,
        crossing: 0.0,
        thrust: 1.05,
        across: 0.5,
        height: 0.3,
    },
    Weather {
        name: "light",
        turbulence: 7.7,
        crossing: 0.01,
        thrust: 1.1,
        across: 1.0,
        height: 0.5,
    },
    Weather {
        name: "moderate",
        turbulence: 15.4,
        crossing: 0.10,
        thrust: 1.2,
        across: 2.0,
        height: 1.0,
    },
];

/// Vehicles: what they are called, how many kinds of them take turns, in how many of the weathers they stall no more often than is allowed, and keep
/// to all bounds, and how one is drawn.
struct Fleet<Draw> {
    name: &'static str,
    kinds: u64,
    unstalled: usize,
    kept: usize,
    draw: Draw,
}

/// Flies the work of all numbers in each weather, prints a row of each, and gives those in which somebody is lost or that are beyond their bounds.
fn at_constant_airspeed<Draw>(fleet: &Fleet<Draw>, numbers: std::ops::Range<u64>) -> Vec<String>
where
    Draw: Fn(&mut ChaCha8Rng, u64, f64) -> (Document, f64) + Sync,
{
    let mut broken = Vec::new();
    for (n, weather) in WEATHERS.iter().enumerate() {
        let all: Vec<Flown> = numbers
            .clone()
            .into_par_iter()
            .map(|number| {
                let random = &mut ChaCha8Rng::seed_from_u64(number);
                let (mut document, speed) = (fleet.draw)(random, number, weather.turbulence);
                let items = work(random, number / fleet.kinds, speed);
                set(
                    &mut document,
                    &[
                        "duration_s=120.0".to_owned(),
                        format!("mission={{ cruise_speed_m_s = {speed}, items = [{items}] }}"),
                    ],
                );
                fly(&document.checked().unwrap())
            })
            .collect();
        let count = all.len() as f64;
        let crossing = all.iter().filter(|f| f.crossing > 0.0).count() as f64 / count;
        let lost = all.iter().filter(|f| f.lost).count();
        let thrust = all.iter().map(|f| f.thrust[0] / f.thrust[1]).sum::<f64>() / count;
        let most = |of: &dyn Fn(&Flown) -> f64| quantile(all.iter().map(of), 0.95);
        let (across, height) = (most(&|f| f.across), most(&|f| f.height));
        let (load, gust) = (most(&|f| f.load), most(&|f| f.gust_load));
        let row = format!(
            "{}, {}: {count} flights, {lost} lost, {:.1} % cross the stall, thrust {thrust:.3} of steady, across {across:.2} m, height {height:.2} m, load {load:.2}, of the gusts alone {gust:.2}",
            fleet.name,
            weather.name,
            100.0 * crossing
        );
        println!("{row}");
        let stalled = crossing > weather.crossing + 1.0 / count;
        let kept = thrust <= weather.thrust
            && across <= weather.across
            && height <= weather.height
            // What holds the height adds little to what the gusts do.
            && load <= 1.1 * gust;
        if lost > 0 || (n < fleet.unstalled && stalled) || (n < fleet.kept && !kept) {
            broken.push(row);
        }
    }
    broken
}

/// The work at a constant airspeed, in calm and in turbulence, by five vehicles by rule.
#[test]
fn work_is_flown_at_its_airspeed_without_crossing_the_stall() {
    let fleet = Fleet {
        name: "five by rule",
        kinds: 5,
        unstalled: 3,
        kept: 3,
        draw: by_rule,
    };
    let broken = at_constant_airspeed(&fleet, flights(15));
    assert!(broken.is_empty(), "beyond its bounds: {broken:#?}");
}

/// The same by vehicles that people own. The table of `docs/missions.md` says by how much they are beyond the bounds where they do not keep to them.
#[test]
fn work_is_flown_so_by_vehicles_that_people_own() {
    let mut broken = Vec::new();
    for (name, unstalled, kept) in [
        ("small-flying-wing", 1, 1),
        ("mapping", 3, 3),
        ("biplane", 1, 1),
        ("heavy", 3, 1),
    ] {
        let fleet = Fleet {
            name,
            kinds: 1,
            unstalled,
            kept,
            draw: |random: &mut ChaCha8Rng, number: u64, turbulence: f64| {
                of_kind(name, random, number, turbulence)
            },
        };
        broken.extend(at_constant_airspeed(&fleet, flights(3)));
    }
    assert!(broken.is_empty(), "beyond its bounds: {broken:#?}");
}

/// Power that the propellers give the air \[W\] at a thrust \[N\] and airspeed [m/s] of a vehicle of 10 kg, by momentum theory, with the downwash of 10 m/s in
/// hover that missions count with.
fn power(thrust: f64, airspeed: f64) -> f64 {
    let u = 0.5 * airspeed;
    thrust * (u + (u * u + thrust / 98.1 * 100.0).sqrt())
}

/// Ten lines of a survey in 8 m/s: their time is that of the wind triangle, and nothing is lost of it in corners. Their energy is that of steady flight
/// for that time; that of the whole survey is that of steady flight with its turns.
#[test]
fn lines_take_the_time_and_energy_of_the_wind_triangle() {
    let all: Vec<[f64; 3]> = flights(6)
        .into_par_iter()
        .map(|number| {
            let random = &mut ChaCha8Rng::seed_from_u64(number);
            let mut document = Document::load("cruise-in-air").unwrap();
            let from: f64 = random.random_range(0.0..std::f64::consts::TAU);
            let (north, east) = (8.0 * from.cos(), 8.0 * from.sin());
            let line = |n: u32| {
                let (from, to) = if n.is_multiple_of(2) { (300, 900) } else { (900, 300) };
                let at = |north: i32| format!("{{ waypoint = {{ north_m = {north}, east_m = {}, height_m = 0.0, over = true }} }}", 60 * n);
                [at(from), at(to)].join(", ")
            };
            let items: Vec<String> = (0..10).map(line).collect();
            set(&mut document, &[
                "duration_s=1500.0".to_owned(),
                "sensors.air=\"wind-estimate\"".to_owned(),
                format!("weather.steady_m_s=[{north},{east},0.0]"),
                "weather.turbulence.wind_at_20_ft_m_s=7.7".to_owned(),
                format!("mission={{ cruise_speed_m_s = 22.0, items = [{}] }}", items.join(", ")),
                format!("seed={number}"),
            ]);
            let experiment = document.checked().unwrap();
            // Time in which each item is flown: the way to the second of a pair is a line.
            let mut times = [0.0; 21];
            // Energy on the lines, from their first turn on, and that of steady flight from there on; thrust of steady level flight.
            let (mut lines, mut whole, mut steady, mut level) = (0.0, 0.0, 0.0, 0.0_f64);
            simulate(&experiment, experiment.controller().unwrap().as_mut(), |step| {
                let progress = step.mission.unwrap().progress;
                let item = usize::from(progress.item);
                times[item.min(20)] += 0.01;
                let airspeed = (step.truth.velocity - step.wind).norm();
                let spent = 0.01 * power(step.truth.thrust, airspeed);
                if item % 2 == 1 && item < 20 {
                    lines += spent;
                }
                if item > 0 {
                    whole += spent;
                    steady += 0.01 * power(progress.steady_thrust.into(), progress.airspeed.into());
                }
                if progress.load_factor == 1.0 && progress.settled {
                    level = progress.steady_thrust.into();
                }
                item < 20
            })
            .unwrap()
            .sound()
            .unwrap();
            let flight: f64 = (0..10).map(|n| times[2 * n + 1]).sum();
            let along = (22.0_f64.powi(2) - east * east).sqrt();
            let ideal = 5.0 * (600.0 / (along + north) + 600.0 / (along - north));
            [flight / ideal, lines / (power(level, 22.0) * ideal), whole / steady]
        })
        .collect();
    let names = [
        "time of the lines",
        "energy of the lines",
        "energy of the survey",
    ];
    for (n, (name, bound)) in names.into_iter().zip([0.05, 0.1, 0.1]).enumerate() {
        let of = || all.iter().map(|ratios| ratios[n]);
        let most = |share| quantile(of().map(|ratio| (ratio - 1.0).abs()), share);
        println!(
            "{} surveys of ten lines, {name} over that of wind triangle and steady flight: {:.3}, off by {:.3} in 95 %, {:.3} at most",
            all.len(),
            of().sum::<f64>() / all.len() as f64,
            most(0.95),
            most(1.0)
        );
        assert!(most(0.95) < bound, "{name} {}", most(0.95));
    }
}

/// A front of 1.2 times the airspeed: the nose is held into it, said so, and the work goes on behind it.
#[test]
fn a_wind_stronger_than_the_airspeed_is_said_and_survived() {
    let all: Vec<Flown> = flights(5)
        .into_par_iter()
        .map(|number| {
            let random = &mut ChaCha8Rng::seed_from_u64(number);
            let (mut document, speed) = by_rule(random, number, 7.7);
            let from: f64 = random.random_range(0.0..std::f64::consts::TAU);
            let gust = 1.2 * speed - 3.0;
            set(&mut document, &[
                "duration_s=150.0".to_owned(),
                format!("weather.steady_m_s=[{},{},0.0]", 3.0 * from.cos(), 3.0 * from.sin()),
                format!(
                    "weather.gust={{ start_s = 40.0, duration_s = 40.0, peak_m_s = [{},{},0.0] }}",
                    gust * from.cos(), gust * from.sin()
                ),
                format!("mission={{ cruise_speed_m_s = {speed}, items = [{}] }}", work(random, 0, speed)),
            ]);
            fly(&document.checked().unwrap())
        })
        .collect();
    let lost = all.iter().filter(|f| f.lost).count();
    let said = all.iter().filter(|f| f.drifted).count();
    println!(
        "front of 1.2: {} flights, {lost} lost, {said} say that they drift",
        all.len()
    );
    // The estimate of the wind is 4 s behind: of some fronts it does not see the peak.
    assert!(lost == 0 && said * 10 >= all.len() * 9 - 9, "{lost} {said}");
}

/// Take-off of a kind, 13 m away, a hover, return and landing, in a level `wind` over cruise from anywhere with the turbulence of that. A front adds what is
/// missing to `peak`, 50 s after the start, while it hovers for 30 s in place of 3 s.
fn out_and_home(kind: &str, number: u64, wind: f64, peak: Option<f64>) -> Experiment {
    let random = &mut ChaCha8Rng::seed_from_u64(number);
    let (mut document, speed, _) = as_it_is(kind);
    let from: f64 = random.random_range(0.0..std::f64::consts::TAU);
    let vector = |share: f64| {
        let (north, east) = (share * speed * from.cos(), share * speed * from.sin());
        format!("[{north},{east},0.0]")
    };
    let strongest = speed * peak.unwrap_or(wind);
    let (duration, safe, hover) = match peak {
        Some(_) => (300.0, 20.0, 30.0),
        None => (150.0, 8.0, 3.0),
    };
    let items = format!(
        "{{ take-off = {{ height_m = 8.0 }} }}, {{ waypoint = {{ north_m = 12.0, east_m = 5.0, height_m = 10.0, hover_s = {hover:?} }} }}, \"return\""
    );
    set(
        &mut document,
        &[
            format!("duration_s={duration:?}"),
            "plant.standing=true".to_owned(),
            format!("weather.steady_m_s={}", vector(wind)),
            format!(
                "weather.turbulence={{ wind_at_20_ft_m_s = {}, height_m = 60.0 }}",
                strongest.max(2.0)
            ),
            "sensors.air=\"wind-estimate\"".to_owned(),
            "sensors.velocity_m_s={ noise = 0.05 }".to_owned(),
            "sensors.position_m={ noise = 0.1 }".to_owned(),
            "sensors.attitude_deg={ noise = 0.2 }".to_owned(),
            "sensors.air_m_s={ noise = 0.3 }".to_owned(),
            "sensors.acceleration_m_s2={ noise = 0.3 }".to_owned(),
            format!(
                "mission={{ cruise_speed_m_s = {speed}, safe_height_m = {safe:?}, items = [{items}] }}"
            ),
            format!("seed={number}"),
        ],
    );
    if let Some(peak) = peak {
        let front = vector(peak - wind);
        set(
            &mut document,
            &[format!(
                "weather.gust={{ start_s = 5.0, duration_s = 90.0, peak_m_s = {front} }}"
            )],
        );
    }
    document.checked().unwrap()
}

/// From standing on the tail to standing there again.
#[test]
fn missions_end_where_they_are_to_land() {
    // Wind, over cruise; most tilt at touch-down [°]. Of 100 biplanes 95 are within 10°, of the few that are flown here one may be beyond.
    let kinds = [
        ("mapping", 0.2, 10.0),
        ("biplane", 0.1, 12.0),
        ("heavy", 0.2, 10.0),
    ];
    let mut table = String::new();
    for (name, share, lean) in kinds {
        let all: Vec<Flown> = flights(4)
            .into_par_iter()
            .map(|number| {
                let random = &mut ChaCha8Rng::seed_from_u64(number);
                fly(&out_and_home(
                    name,
                    number,
                    share * random.random_range(0.0..1.0),
                    None,
                ))
            })
            .collect();
        let landed = all.iter().filter(|f| f.over.is_some()).count();
        let touch =
            |n: usize, share| quantile(all.iter().filter_map(|f| f.touch).map(|t| t[n]), share);
        table += &format!(
            "{name}, wind to {share} of cruise: {landed} of {} landed; 95 %: down {:.2} m/s, sideways {:.2} m/s, {:.2} m from the place, tilt {:.1}°\n",
            all.len(),
            touch(0, 0.95),
            touch(1, 0.95),
            touch(2, 0.95),
            touch(3, 0.95)
        );
        assert!(all.len() - landed <= all.len() / 100, "{table}");
        assert!(
            touch(0, 0.95) < 0.7 && touch(1, 0.95) < 0.5 && touch(2, 0.95) < 1.0,
            "{table}"
        );
        assert!(touch(3, 0.95) < lean, "{table}");
    }
    println!("{table}");
}

/// A front that comes while it hovers and goes after a minute and a half. Where its wind is too much to land in, it waits, says so, and lands behind it.
#[test]
fn a_front_is_waited_for() {
    let mut table = String::new();
    for kind in ["mapping", "heavy", "biplane"] {
        for peak in [0.1, 0.2, 0.25, 0.3, 0.35] {
            let all: Vec<Flown> = flights(2)
                .into_par_iter()
                .map(|number| fly(&out_and_home(kind, number, 0.05, Some(peak))))
                .collect();
            let count = |of: &dyn Fn(&Flown) -> bool| all.iter().filter(|f| of(f)).count();
            let landed = count(&|f| f.over.is_some());
            let within = count(&|f| {
                let touch = f.touch.filter(|_| f.over.is_some() && !f.hit);
                touch.is_some_and(|[down, sideways, off, tilt]| {
                    down <= 0.7 && sideways <= 0.5 && off <= 1.0 && tilt <= 10.0
                })
            });
            let (windy, hit) = (count(&|f| f.windy), count(&|f| f.hit));
            table += &format!(
                "{kind}, front of {peak} of cruise: {landed} of {} landed, {within} within all bounds, {windy} say that it is too windy, {hit} hit the ground elsewhere\n",
                all.len()
            );
            // In a tenth of cruise nobody waits, in 0.35 everybody.
            assert!(peak > 0.1 || windy == 0, "{table}");
            assert!(peak < 0.35 || windy == all.len(), "{table}");
            // `mapping` is driven off by gusts where it still hovers: measured are 3 of 100.
            assert!(all.len() - landed <= 1 + all.len() / 20, "{table}");
        }
    }
    println!("{table}");
}

/// How far over and under its height \[m\] a kind is while it brakes to a place 12 to 20 s ahead, hovers there and comes down, and when it is done \[s\]; none
/// where it was not in 150 s. With an autopilot's estimates, in light turbulence and a wind of up to a share of cruise.
fn braked(kind: &str, number: u64, wind: f64, braking_climb: Option<f64>) -> Option<[f64; 3]> {
    let random = &mut ChaCha8Rng::seed_from_u64(number);
    let (mut document, cruise, weight) = as_it_is(kind);
    let speed = cruise * random.random_range(0.85..1.0);
    let turbulence = if wind > 0.0 { 7.7 } else { 0.0 };
    cruising(
        &mut document,
        random,
        number,
        turbulence,
        8.0,
        (speed, 0.15 * weight),
    );
    let strength = wind * cruise * random.random_range(0.0..1.0);
    let from: f64 = random.random_range(0.0..std::f64::consts::TAU);
    let (way, to) = (
        speed * random.random_range(12.0..20.0),
        random.random_range(-2.0..2.0_f64),
    );
    let climb = braking_climb.map_or(String::new(), |climb| {
        format!("braking_climb_m = {climb:?}, ")
    });
    set(
        &mut document,
        &[
            "duration_s=150.0".to_owned(),
            format!(
                "weather.steady_m_s=[{},{},0.0]",
                strength * from.cos(),
                strength * from.sin()
            ),
            format!(
                "mission={{ cruise_speed_m_s = {speed}, {climb}items = [{{ waypoint = {{ north_m = {}, east_m = {}, height_m = 0.0, hover_s = 5.0 }} }}] }}",
                way * to.cos(),
                way * to.sin()
            ),
        ],
    );
    let experiment = document.checked().unwrap();
    let (mut over, mut under, mut done) = (0.0_f64, 0.0_f64, None);
    let visit = |step: &Step| {
        let asked = step.mission.expect("a mission");
        if asked.activity == Activity::Hovering {
            over = over.max(step.altitude());
            under = under.max(-step.altitude());
        }
        done = (asked.progress.item > 0).then_some(step.t);
        done.is_none()
    };
    let mut controller = experiment.controller().unwrap();
    simulate(&experiment, controller.as_mut(), visit)
        .unwrap()
        .sound()
        .unwrap();
    done.map(|t| [over, under, t])
}

/// The same of many, printed: how many are done, and of these how many within 3 m.
fn brakings(
    kind: &str,
    numbers: std::ops::Range<u64>,
    wind: f64,
    climb: Option<f64>,
) -> [usize; 2] {
    let all: Vec<_> = numbers
        .into_par_iter()
        .map(|number| braked(kind, number, wind, climb))
        .collect();
    let done: Vec<_> = all.iter().flatten().collect();
    let of = |n: usize| [0.5, 0.9, 1.0].map(|share| quantile(done.iter().map(|d| d[n]), share));
    let within = done.iter().filter(|d| d[0] < 3.0 && d[1] < 3.0).count();
    println!(
        "{kind}, wind to {wind}, climb {climb:?}: {} of {} done, over {:.1?} m, under {:.1?} m, after {:.0?} s, {within} within 3 m",
        done.len(),
        all.len(),
        of(0),
        of(1),
        of(2)
    );
    [done.len(), within]
}

/// A wing that cannot brake level mostly keeps within 3 m of its climb where a mission stops it, by the parameters' own choice; of level brakings by it one of 40 does.
/// The others brake level.
#[test]
fn a_mission_brakes_as_its_vehicle_can() {
    let numbers = flights(6);
    let count = (numbers.end - numbers.start) as usize;
    let [done, within] = brakings("mapping", numbers.clone(), 0.15, None);
    // Of 40 six are beyond 3 m.
    assert!(done + count / 10 >= count && within + count / 4 >= count);
    let [done, within] = brakings("mapping", numbers.clone(), 0.15, Some(0.0));
    assert!(done > 0 && within * 10 <= count);
    for kind in ["small-flying-wing", "biplane"] {
        let [done, within] = brakings(kind, numbers.clone(), 0.0, None);
        assert!(done == count && within == count, "{kind}");
    }
}

/// The missions that are built in, from take-off to landing.
#[test]
fn built_in_missions_are_flown_to_their_end() {
    for name in ["survey", "delivery", "loiter-watch", "inspection"] {
        let experiment = Document::load(name).unwrap().checked().unwrap();
        let flight = fly(&experiment);
        let time = flight.over.unwrap_or_else(|| panic!("{name} is not over"));
        println!(
            "{name}: {time:.0} s, {:.1} kJ, across {:.2} m, height {:.2} m, crossing {:.2} s",
            flight.energy / 1e3,
            flight.across,
            flight.height,
            flight.crossing
        );
        assert!(!flight.lost && flight.crossing == 0.0, "{name}");
        let touch = flight.touch.unwrap();
        assert!(
            touch[0] < 0.7 && touch[1] < 0.5 && touch[2] < 1.0,
            "{name} {touch:?}"
        );
    }
}

/// What is seen of a flight with a failure, every tenth of a second.
struct Seen {
    t: f64,
    place: V3,
    output: MissionOutput,
}

/// Out at 22 m/s in 5 m/s of wind, a hover, back and down, 60 m high, on the ideal vehicle with a ground under it.
fn out_and_back(settings: &[String]) -> Vec<Seen> {
    let mut document = Document::load("survey").unwrap();
    let items = "{ take-off = { height_m = 20.0 } }, { waypoint = { north_m = 500.0, east_m = 0.0, height_m = 60.0 } }, \
        { waypoint = { north_m = 500.0, east_m = 300.0, height_m = 60.0, hover_s = 5.0 } }, \"return\"";
    let fixed = [
        "duration_s=400.0".to_owned(),
        "weather.turbulence.wind_at_20_ft_m_s=0.001".to_owned(),
        format!("mission.items=[{items}]"),
    ];
    set(&mut document, &fixed);
    set(&mut document, settings);
    let experiment = document.checked().unwrap();
    let mut seen = Vec::new();
    let mut touched = false;
    simulate(
        &experiment,
        experiment.controller().unwrap().as_mut(),
        |step| {
            let output = step.mission.unwrap();
            seen.push(Seen {
                t: step.t,
                place: step.truth.position,
                output,
            });
            touched |= output.activity == Activity::Touched;
            !(touched && output.activity == Activity::Grounded)
        },
    )
    .unwrap()
    .sound()
    .unwrap();
    seen
}

/// Whether it stands on the ground at the end, and where.
fn landed(seen: &[Seen]) -> Option<V3> {
    let last = seen.last().unwrap();
    let stands = last.output.activity == Activity::Grounded && last.place.z.abs() < 0.1;
    stands.then_some(last.place)
}

/// Each failure with each response, in cruise: it goes on; it circles for as long as the failure lasts and goes on then; it returns, or lands where it
/// is, and keeps to that.
#[test]
fn failures_are_answered_as_the_table_says() {
    let failures = [
        (
            "link",
            "mission.troubles=[{ t_s = 28.0, lasts_s = 40.0, kind = \"link\" }]",
            Troubles::LINK,
        ),
        (
            "air",
            "mission.troubles=[{ t_s = 28.0, lasts_s = 40.0, kind = \"air\" }]",
            Troubles::AIR,
        ),
        (
            "position",
            "mission.troubles=[{ t_s = 28.0, lasts_s = 40.0, kind = \"position\" }]",
            Troubles::POSITION,
        ),
        (
            "battery",
            "mission.troubles=[{ t_s = 28.0, lasts_s = 40.0, kind = \"battery\" }]",
            Troubles::BATTERY,
        ),
        (
            "follow",
            "weather.gust={ start_s = 18.0, duration_s = 30.0, peak_m_s = [0.0,0.0,-22.0] }",
            Troubles::FOLLOW,
        ),
    ];
    let responses = ["continue", "loiter", "return", "land"];
    let cases: Vec<_> = failures
        .iter()
        .flat_map(|f| responses.map(|r| (f, r)))
        .collect();
    let flights: Vec<Vec<Seen>> = cases
        .par_iter()
        .map(|((name, failure, _), response)| {
            let mut settings = vec![
                (*failure).to_owned(),
                format!("mission.responses={{ {name} = \"{response}\" }}"),
            ];
            if *name == "air" {
                settings.push(
                    "sensors.faults=[{ kind = \"air\", from_s = 28.0, to_s = 68.0 }]".to_owned(),
                );
            }
            out_and_back(&settings)
        })
        .collect();
    for (((name, _, trouble), response), seen) in cases.iter().zip(&flights) {
        let what = format!("{name}, {response}");
        let failed: Vec<&Seen> = seen
            .iter()
            .filter(|s| s.output.troubles.contains(*trouble))
            .collect();
        assert!(!failed.is_empty(), "{what}: it does not fail");
        let first = failed[0];
        let place = landed(seen)
            .unwrap_or_else(|| panic!("{what}: not landed, {:?}", seen.last().unwrap().output));
        let (home, there) = (place.xy().norm(), (place - first.place).xy().norm());
        let over = seen.last().unwrap().t;
        let farthest = failed.iter().map(|s| (s.place - first.place).xy().norm());
        println!(
            "{what}: from {:.1} s, lands {home:.1} m from home, {there:.1} m from there, at {over:.0} s; farthest meanwhile {:.0} m",
            first.t,
            farthest.clone().fold(0.0, f64::max)
        );
        let kept = |response| failed.iter().all(|s| s.output.response == response);
        match *response {
            // A position that is reckoned for 40 s is off by what the velocity is; it is known again before the landing.
            "continue" => assert!(home < 1.0 && kept(Response::Continue), "{what} {home}"),
            "loiter" => {
                assert!(home < 1.0 && kept(Response::Loiter), "{what} {home}");
                // Two radii of a turn of 29 degrees in the wind, and the way to it.
                assert!(farthest.fold(0.0, f64::max) < 320.0, "{what}");
            }
            "return" => assert!(home < 1.0 && kept(Response::Return), "{what} {home}"),
            _ => {
                // Ahead, by the way in which it brakes from the speed that it has: 290 m in cruise. In the updraft it dives, at up to twice the speed.
                let before = &seen[seen.iter().position(|s| s.t == first.t).unwrap() - 1];
                let speed = (first.place - before.place).xy().norm() / (first.t - before.t);
                let far = 1.1 * speed.powi(2) / (2.0 * 0.7 * 1.5) + 20.0;
                assert!(
                    there < far && home > 50.0 && kept(Response::Land),
                    "{what} {there} {home}"
                );
            }
        }
    }
    // Who goes on after a circle is later by as long as it lasted; who returns is sooner.
    let over = |case: usize| flights[case].last().unwrap().t;
    assert!(
        over(1) > over(0) + 35.0 && over(2) < over(0) - 15.0,
        "{} {} {}",
        over(0),
        over(1),
        over(2)
    );
}

/// Whoever flies stops it: at every height of a take-off it stays there, at every height of a landing it goes around to `safe_height`; taken back after
/// 15 s the mission is flown to its end.
#[test]
fn it_is_stopped_at_any_height_and_goes_around() {
    let undisturbed = out_and_back(&[]);
    let when = |activity: Activity, height: f64| {
        let of = |s: &&Seen| s.output.activity == activity;
        let passes = |s: &&Seen| match activity {
            Activity::Rising => -s.place.z >= height,
            _ => -s.place.z <= height,
        };
        undisturbed.iter().filter(of).find(passes).unwrap().t
    };
    let rising = [1.0, 5.0, 15.0].map(|h| (Activity::Rising, h));
    let descending = [15.0, 5.0, 2.0, 0.7, 0.3].map(|h| (Activity::Descending, h));
    let cases: Vec<_> = rising.into_iter().chain(descending).collect();
    cases.par_iter().for_each(|&(activity, height)| {
        let t = when(activity, height);
        let abort = format!("mission.troubles=[{{ t_s = {t}, lasts_s = 15.0, kind = \"abort\" }}]");
        let seen = out_and_back(&[abort]);
        let what = format!("{activity:?} {height} m");
        let during: Vec<&Seen> = seen.iter().filter(|s| s.t >= t && s.t < t + 15.0).collect();
        let mut heights = during.iter().map(|s| -s.place.z);
        let (lowest, last) = (
            heights.clone().fold(f64::INFINITY, f64::min),
            heights.next_back().unwrap(),
        );
        println!("{what}: lowest {lowest:.2} m, after 15 s {last:.2} m");
        assert!(
            during.iter().all(|s| s.output.response == Response::Loiter),
            "{what}"
        );
        assert!(
            during
                .iter()
                .all(|s| !matches!(s.output.activity, Activity::Touched | Activity::Grounded)),
            "{what}"
        );
        match activity {
            // It stops within the way that 3 m/s take: measured 0.1 m; sinking at 1.5 m/s it takes 0.7 m.
            Activity::Rising => assert!(
                (last - height).abs() < 3.5 && lowest > height - 1.0,
                "{what}"
            ),
            _ => assert!((last - 20.0).abs() < 2.5 && lowest > height - 1.1, "{what}"),
        }
        let place = landed(&seen).unwrap_or_else(|| panic!("{what}"));
        assert!(place.xy().norm() < 1.0, "{what} {place}");
    });
    // On the ground there is no take-off before it is taken back.
    let seen = out_and_back(&[
        "mission.troubles=[{ t_s = 0.0, lasts_s = 9.0, kind = \"abort\" }]".to_owned(),
    ]);
    let lifted = seen.iter().find(|s| s.place.z < -0.5).unwrap().t;
    assert!(
        (9.0..13.0).contains(&lifted) && landed(&seen).is_some(),
        "{lifted}"
    );
}

/// Plans as QGroundControl writes them are flown by the vehicle that is named, from take-off to landing.
#[test]
fn plans_of_a_ground_station_are_flown_to_their_end() {
    let plans = concat!(env!("CARGO_MANIFEST_DIR"), "/data/plans");
    for name in ["delivery", "loiter", "survey"] {
        let out = tempfile::tempdir().unwrap();
        let fly = |vehicle: &[&str]| {
            std::process::Command::new(env!("CARGO_BIN_EXE_alula-sil"))
                .args(["fly", &format!("{plans}/{name}.plan"), "--json", "--out"])
                .arg(out.path())
                .args(vehicle)
                .output()
                .unwrap()
        };
        let refused = String::from_utf8(fly(&[]).stderr).unwrap();
        assert!(refused.contains("--vehicle EXPERIMENT"), "{refused}");
        let sets = [
            "--set",
            "mission.cruise_speed_m_s=22.0",
            "--set",
            "weather.turbulence.wind_at_20_ft_m_s=7.7",
        ];
        let flight = fly(&[&["--vehicle", "cruise-in-air"][..], &sets].concat());
        let said = String::from_utf8(flight.stderr).unwrap();
        assert!(flight.status.success(), "{name}: {said}");
        assert_eq!(
            said.contains("left out: item 1, its item 1: command 206"),
            name == "survey"
        );
        let mut folders = std::fs::read_dir(out.path())
            .unwrap()
            .map(|e| e.unwrap().path());
        let inside = folders
            .find(|p| p.is_dir())
            .unwrap_or_else(|| out.path().into());
        let trace = std::fs::read_to_string(inside.join("trace.csv"))
            .or_else(|_| std::fs::read_to_string(out.path().join("trace.csv")))
            .unwrap();
        let mut rows = csv::Reader::from_reader(trace.as_bytes());
        let column = |rows: &mut csv::Reader<&[u8]>, name: &str| {
            rows.headers()
                .unwrap()
                .iter()
                .position(|head| head == name)
                .unwrap()
        };
        let activity = column(&mut rows, "mission_activity");
        let [north, east, down] =
            ["north_m", "east_m", "down_m"].map(|name| column(&mut rows, name));
        let last = rows.records().last().unwrap().unwrap();
        assert_eq!(&last[activity], "grounded", "{name}");
        for of in [north, east, down] {
            assert!(
                last[of].parse::<f64>().unwrap().abs() < 1.0,
                "{name}: {last:?}"
            );
        }
    }
}

/// What cannot be flown is refused by item and field, with the line of the file.
#[test]
fn a_mission_that_cannot_be_flown_is_refused_by_item_and_field() {
    let refused = |items: &str| {
        let mut document = Document::load("survey").unwrap();
        document
            .assign(&format!("mission.items=[{items}]"))
            .unwrap();
        document.experiment().unwrap_err().to_string()
    };
    let up = "{ take-off = { height_m = 10.0 } }";
    assert_eq!(
        refused(&format!(
            "{up}, {{ loiter = {{ north_m = 0.0, east_m = 0.0, height_m = 50.0, radius_m = 20.0 }} }}"
        )),
        "mission.items[1].radius: the vehicle turns on 90.3 m at this speed"
    );
    assert_eq!(
        refused(&format!("{up}, {{ speed = {{ speed_m_s = 90.0 }} }}"))
            .split(" to ")
            .next(),
        Some("mission.items[1].speed: must be from 0.5")
    );
    assert_eq!(
        refused(&format!("{up}, {up}")),
        "mission.items[1].take-off: a take-off is the first item, or after a landing"
    );
    assert_eq!(
        refused("{ waypoint = { north_m = 2e6, east_m = 0.0, height_m = 50.0 } }"),
        "mission.items[0].place: must be within 100000 m of home"
    );
}
