//! A vehicle learned from its log. The flights are of tail-sitters as they are, with an autopilot's sensors.

use alula_design::identify::{Besides, Given, Identified, LACKING, POLAR, identify};
use alula_design::regression::Measured;
use alula_design::{Actuators, Design, Known, Outcome};
use alula_logs::states::{TOLD, find};
use alula_logs::{Column, Log, Topic};
use alula_sim::experiment::tail_sitter::TailSitterSpec;
use alula_sim::experiment::{Document, Experiment};
use alula_sim::figures::Figures;
use alula_sim::flight_log::log;
use alula_sim::plant::Command;
use alula_sim::plant::tail_sitter::{Belief, TailSitter, TailSitterState};
use alula_sim::simulate::fly;
use nalgebra::Vector3;
use rayon::prelude::*;

/// A vehicle as it is flown.
#[derive(Clone, Copy)]
struct Flown {
    vehicle: &'static str,
    /// [m/s].
    cruise: f64,
    /// The slowest level speed on the wing, over cruise.
    slow: f64,
    /// The slope of a glide in which its propellers idle.
    glide: f64,
    /// What turns it.
    actuators: Actuators,
}

const FLOWN: [Flown; 3] = [
    Flown {
        vehicle: "mapping",
        cruise: 18.0,
        slow: 0.75,
        glide: 0.3,
        actuators: Actuators::Elevons,
    },
    Flown {
        vehicle: "small-flying-wing",
        cruise: 10.0,
        slow: 0.7,
        glide: 0.4,
        actuators: Actuators::Elevons,
    },
    Flown {
        vehicle: "biplane",
        cruise: 18.0,
        slow: 0.7,
        glide: 0.4,
        actuators: Actuators::Motors,
    },
];

/// The flight of the page: hover with steps, pulls and pushes, swings of the course, three level speeds, a climb, a glide, and transitions there and back, of the vehicle with this seed.
fn flight(flown: Flown, seed: u64) -> Experiment {
    let Flown {
        vehicle,
        cruise,
        slow,
        glide,
        ..
    } = flown;
    let mut document = Document::load("tail-sitter-hover").unwrap();
    let mut knots: Vec<(f64, [f64; 3])> = vec![(0.0, [0.0; 3])];
    // Duration of a change, of what is held then, and the velocity: down, forward; and east in swings.
    let climbs = [(0.25, 2.0, -1.5, 0.0), (0.25, 2.0, 1.5, 0.0)];
    let hover = [
        &[(1.0, 4.0, 0.0, 0.0)],
        &climbs.repeat(3)[..],
        &[(0.5, 4.0, 0.0, 0.0), (0.5 * cruise, 20.0, 0.0, cruise)],
    ]
    .concat();
    // Pulls and pushes of half the weight, three seconds from one to the next.
    let pulls = [(1.5, 0.0, -3.75, cruise), (1.5, 0.0, 3.75, cruise)];
    let waves = [&pulls.repeat(16)[..], &[(0.75, 2.0, 0.0, cruise)]].concat();
    let round = [
        (3.0, 20.0, 0.0, 1.2 * cruise),
        (5.0, 20.0, 0.0, slow * cruise),
        (3.0, 8.0, -0.12 * cruise, cruise),
        (3.0, 8.0, glide * cruise, cruise),
        (2.0, 6.0, 0.0, cruise),
    ];
    let back = [
        (0.6 * cruise, 8.0, -1.0, 0.0),
        (0.5 * cruise, 10.0, 0.0, cruise),
        (0.6 * cruise, 8.0, -1.0, 0.0),
    ];
    let straight = |&(change, hold, down, forward)| (change, hold, [down, forward, 0.0]);
    let before = hover.iter().chain(&waves).map(straight);
    let after = round.iter().chain(&back).map(straight);
    // Swings of the course of 0.3 of the weight, as often as pulls.
    let swings = [2.25, -2.25].repeat(12);
    let swings = swings
        .into_iter()
        .map(|east| (1.5, 0.0, [0.0, cruise, east]));
    let swings = swings.chain([(0.75, 2.0, [0.0, cruise, 0.0])]);
    for (change, hold, velocity) in before.chain(swings).chain(after) {
        let t = knots.last().unwrap().0;
        knots.push((t + change, velocity));
        if hold > 0.0 {
            knots.push((t + change + hold, velocity));
        }
    }
    let last = knots.last().unwrap().0;
    let knots: Vec<String> = knots
        .iter()
        .map(|(t, [down, forward, east])| {
            format!("{{t_s={t:?},down_m_s={down:?},forward_m_s={forward:?},east_m_s={east:?}}}")
        })
        .collect();
    let all = [
        format!("plant.vehicle={vehicle}"),
        format!("reference.knots=[{}]", knots.join(",")),
        format!("duration_s={last:?}"),
        format!("seed={seed}"),
        "weather.turbulence={wind_at_20_ft_m_s=3.0,height_m=30.0}".to_owned(),
        format!("weather.steady_m_s=[{:?},0.5,0.0]", -0.1 * cruise),
    ];
    for change in &all {
        document.assign(change).unwrap();
    }
    document.checked().unwrap()
}

fn given(experiment: &Experiment) -> Given {
    let plant = experiment.tail_sitter.as_ref().unwrap().true_vehicle();
    Given {
        mass_kg: plant.mass_kg,
        wing_m2: Belief::of(&plant).k_a_kg_m / 0.6125,
        air_kg_m3: 1.225,
    }
}

fn identified(experiment: &Experiment) -> Identified {
    let record = fly(experiment).unwrap();
    identify_in(&log(experiment, &record).unwrap(), experiment)
}

fn identify_in(log: &Log, experiment: &Experiment) -> Identified {
    identify(log, &find(log).unwrap(), &given(experiment)).unwrap()
}

/// What is true of the vehicle, in the words of [`Identified`].
struct Truth {
    thrust_to_weight: f64,
    thrust_lag_s: f64,
    rate_lag_s: f64,
    nose_lag_s: f64,
    belly_lag_s: f64,
    c_y: f64,
    full_torque_rad_s2: f64,
    c_l_alpha: f64,
    zero_lift_deg: f64,
    /// α \[°\], c_L, c_D.
    polar: Vec<[f64; 3]>,
}

/// Rows of α \[°\], c_L and c_D as the vehicle flies them: elevons where they trim the pitching moment, motors at rest.
fn trimmed(plant: &TailSitterSpec) -> Vec<[f64; 3]> {
    let vehicle = TailSitter::new(plant.clone(), None);
    let k = Belief::of(plant).k_a_kg_m;
    let elevons = plant.wing.strips.iter().any(|strip| strip.elevon > 0.0);
    let rows = (-6..=14).map(|degrees| {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let wrench = |elevon: f64| {
            let mut state = TailSitterState::at_rest();
            state.velocity = Vector3::new(cos, 0.0, sin);
            state.elevons = [elevon; 2];
            vehicle.wrench(&state, Vector3::zeros())
        };
        let travel = if elevons { 0.5 } else { 0.0 };
        let (mut up, mut down) = (-travel, travel);
        let sign = wrench(up).torque.y.signum();
        for _ in 0..40 {
            let middle = 0.5 * (up + down);
            match wrench(middle).torque.y * sign > 0.0 {
                true => up = middle,
                false => down = middle,
            }
        }
        let force = wrench(up).force / k;
        let (lift, drag) = (
            force.x * sin - force.z * cos,
            -(force.x * cos + force.z * sin),
        );
        [f64::from(degrees), lift, drag]
    });
    rows.collect()
}

impl Truth {
    fn of(experiment: &Experiment) -> Self {
        let plant = experiment.tail_sitter.as_ref().unwrap().true_vehicle();
        let polar = trimmed(&plant);
        let near = polar.iter().filter(|row| (-4.0..=8.0).contains(&row[0]));
        let near: Vec<&[f64; 3]> = near.collect();
        let n = near.len() as f64;
        let mean = |k: usize| near.iter().map(|row| row[k]).sum::<f64>() / n;
        let (a, l) = (mean(0), mean(1));
        let products = near.iter().map(|row| (row[0] - a) * (row[1] - l));
        let squares = near.iter().map(|row| (row[0] - a).powi(2));
        let slope = products.sum::<f64>() / squares.sum::<f64>();
        let vehicle = TailSitter::new(plant.clone(), None);
        // In hover the battery sags by what hover takes, and the wing in the slipstream drags: a scale shows the thrust without.
        let hover = vehicle.hover();
        let net = vehicle.wrench(&hover, Default::default()).force.x
            / vehicle.thrust(&hover, Default::default());
        let static_f = net * vehicle.static_thrust() / (9.81 * plant.mass_kg);
        let battery = 1.0 - plant.motors.sag * (static_f / net).powf(-1.5);
        Self {
            thrust_to_weight: static_f * battery * battery,
            thrust_lag_s: thrust_lag(&vehicle, 9.81 * plant.mass_kg),
            rate_lag_s: Belief::of(&plant).rate_lag_s,
            nose_lag_s: rate_lag(&vehicle, Vector3::x()),
            belly_lag_s: rate_lag(&vehicle, Vector3::z()),
            c_y: Belief::of(&plant).c_y,
            full_torque_rad_s2: Belief::of(&plant).authority.slipstream_rad_s2,
            c_l_alpha: slope.to_degrees(),
            zero_lift_deg: a - l / slope,
            polar,
        }
    }

    /// c_D at a lift coefficient short of stall.
    fn c_d(&self, c_l: f64) -> f64 {
        let above = self
            .polar
            .iter()
            .position(|row| row[0] >= 0.0 && row[1] >= c_l);
        let after = above.unwrap();
        let [a, b] = [self.polar[after - 1], self.polar[after]];
        a[2] + (b[2] - a[2]) * (c_l - a[1]) / (b[1] - a[1])
    }
}

/// Time \[s\] in which the force in hover makes 63 % of a step of a tenth of the weight, held at rest; the battery sags meanwhile.
fn thrust_lag(vehicle: &TailSitter, weight: f64) -> f64 {
    let mut state = vehicle.hover();
    let held = state;
    let mut forces = |share: f64, milliseconds: usize| -> Vec<f64> {
        let command = Command {
            thrust: share * weight,
            rates: Default::default(),
        };
        let steps = (0..milliseconds).map(|_| {
            state = vehicle.step(&state, &command, Default::default(), 1e-3);
            state.velocity = held.velocity;
            state.attitude = held.attitude;
            state.rates = held.rates;
            vehicle.wrench(&state, Default::default()).force.norm()
        });
        steps.collect()
    };
    let before = *forces(1.0, 3000).last().unwrap();
    let after = forces(1.1, 2000);
    let reached = before + 0.632 * (after.last().unwrap() - before);
    1e-3 * after.iter().position(|force| *force >= reached).unwrap() as f64
}

/// Time \[s\] until 63 % of a step of the rate about an axis, of 0.2 rad/s, is there: as [`Belief`] has that of the pitch rate.
fn rate_lag(vehicle: &TailSitter, axis: Vector3<f64>) -> f64 {
    let held = vehicle.hover();
    let mut state = held;
    let mut rate = |asked: f64| {
        let command = Command {
            thrust: vehicle.spec().mass_kg * 9.81,
            rates: asked * axis,
        };
        state = vehicle.step(&state, &command, Vector3::zeros(), 1e-3);
        state.position = held.position;
        state.velocity = held.velocity;
        state.attitude = held.attitude;
        state.rates.dot(&axis)
    };
    for _ in 0..3000 {
        rate(0.0);
    }
    let reached = (1..1000).find(|_| rate(0.2) >= 0.632 * 0.2);
    1e-3 * f64::from(reached.unwrap())
}

/// First seed of the flights: not of those that the shares in `identify` were chosen on.
const FIRST: u64 = 3000;

#[test]
fn a_vehicle_is_learned_from_its_flight() {
    learned(1);
}

/// Draws of a slow test: `IDENTIFY_DRAWS`, or as many as CI has time for.
fn draws(of_ci: u64) -> u64 {
    let asked = std::env::var("IDENTIFY_DRAWS").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(of_ci)
}

#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_vehicles_are_learned_from_their_flights() {
    learned(draws(2));
}

/// What is identified of `draws` flights of each vehicle holds the truth: what is given has it in its interval in nine of ten, and the thrust over the weight
/// is within a tenth, and the slope of c_L in nine of ten. What is not shown is said. With few the shares are coarse. Prints the table of the page.
fn learned(draws: u64) {
    println!(
        "| number | vehicle | given | error, median (5 to 95 % of flights) | within 10 % | held |"
    );
    println!("|---|---|---|---|---|---|");
    let mut all_numbers = Vec::new();
    for flown in FLOWN {
        let vehicle = flown.vehicle;
        let truth = Truth::of(&flight(flown, FIRST));
        let all: Vec<Identified> = (FIRST..FIRST + draws)
            .into_par_iter()
            .map(|seed| identified(&flight(flown, seed)))
            .collect();
        let mut numbers: [(&str, Vec<(Measured, f64)>); 10] = [
            (THRUST, Vec::new()),
            ("lag of the thrust", Vec::new()),
            ("lag of the pitch rate", Vec::new()),
            (NOSE_LAG, Vec::new()),
            ("lag of the rate about the belly", Vec::new()),
            (TORQUE, Vec::new()),
            (SLOPE, Vec::new()),
            (ZERO_LIFT, Vec::new()),
            (DRAG, Vec::new()),
            (SIDE, Vec::new()),
        ];
        for found in &all {
            let thrust = found.thrust_to_weight.unwrap();
            let ratio = thrust.value / truth.thrust_to_weight;
            assert!(
                (0.9..1.12).contains(&ratio),
                "{vehicle}: {thrust:?} of {}",
                truth.thrust_to_weight
            );
            let c_d = found.c_d_cruise.map(|(c_d, at)| (c_d, truth.c_d(at)));
            let pairs = [
                found.thrust_to_weight.map(|m| (m, truth.thrust_to_weight)),
                found.thrust_lag_s.map(|m| (m, truth.thrust_lag_s)),
                found.rate_lag_s.map(|m| (m, truth.rate_lag_s)),
                found.nose_lag_s.map(|m| (m, truth.nose_lag_s)),
                found.belly_lag_s.map(|m| (m, truth.belly_lag_s)),
                found
                    .full_torque_rad_s2
                    .map(|m| (m, truth.full_torque_rad_s2)),
                found.c_l_alpha.map(|m| (m, truth.c_l_alpha)),
                found.zero_lift_deg.map(|m| (m, truth.zero_lift_deg)),
                c_d,
                found.c_y.map(|m| (m, truth.c_y)),
            ];
            for ((_, given), pair) in numbers.iter_mut().zip(pairs) {
                given.extend(pair);
            }
            let shown = [
                (found.c_l_alpha.is_some(), "c_L of the wing"),
                (found.c_d_cruise.is_some(), DRAG),
                (found.nose_lag_s.is_some(), "Lag of the rate about the nose"),
                (found.c_y.is_some(), "Side force"),
            ];
            for (shown, what) in shown {
                let said = found.missing.iter().any(|line| line.starts_with(what));
                assert!(shown != said, "{vehicle}: {what}: {:?}", found.missing);
            }
            // On data that was not fitted the thrust is predicted.
            assert!(found.predicted[0] > 0.0 && !found.held_out.is_empty());
        }
        for (number, given) in &numbers {
            println!("{}", row(number, vehicle, given));
        }
        all_numbers.push((vehicle, numbers));
    }
    println!("| number | vehicle | share that its model lacks |");
    println!("|---|---|---|");
    for (vehicle, numbers) in &all_numbers {
        for (number, share) in [
            (THRUST, LACKING.thrust),
            (DRAG, LACKING.drag),
            (SLOPE, LACKING.slope),
            (TORQUE, LACKING.torque),
            (NOSE_LAG, LACKING.nose_lag),
            (SIDE, LACKING.side),
        ] {
            let (_, given) = numbers.iter().find(|(name, _)| *name == number).unwrap();
            let lacks = lacks(given, share);
            println!("| {number} | {vehicle} | {:.1} % |", 100.0 * lacks);
            assert!(lacks <= share, "{vehicle}: {number}: {lacks} of {share}");
        }
    }
    for (vehicle, numbers) in &all_numbers {
        for (number, given) in numbers {
            let hits = given
                .iter()
                .filter(|(m, truth)| (m.value - truth).abs() <= m.within);
            let (hits, count) = (hits.count(), given.len());
            // Nine in ten, less two deviations of as many draws and half a draw for continuity.
            let count = count as f64;
            assert!(
                hits as f64 + 0.5 >= 0.9 * count - 2.0 * (0.09 * count).sqrt(),
                "{vehicle}: {number}: {hits} of {count}"
            );
        }
        let (_, drags) = numbers.iter().find(|(name, _)| *name == DRAG).unwrap();
        for (c_d, truth) in drags {
            let ratio = c_d.value / truth;
            assert!((0.7..1.3).contains(&ratio), "{vehicle}: {c_d:?} of {truth}");
        }
        // So many are within a tenth, too.
        let (_, slopes) = numbers.iter().find(|(name, _)| *name == SLOPE).unwrap();
        let near = |(m, truth): &&(Measured, f64)| (m.value / truth - 1.0).abs() <= 0.1;
        let (near, count) = (slopes.iter().filter(near).count(), draws as f64);
        assert!(
            near as f64 + 0.5 >= 0.9 * count - 2.0 * (0.09 * count).sqrt(),
            "{vehicle}: {SLOPE}: {near} of {count} within a tenth"
        );
    }
}

const THRUST: &str = "thrust over weight";
const DRAG: &str = "c_D in cruise";
const SLOPE: &str = "slope of c_L";
const TORQUE: &str = "full torque in pitch";
const NOSE_LAG: &str = "lag of the rate about the nose";
const SIDE: &str = "side force";

/// The share of the value by which intervals have to be widened for 95 % to hold the truth, of intervals that are widened by this `share`.
fn lacks(given: &[(Measured, f64)], share: f64) -> f64 {
    let lacking = |(m, truth): &(Measured, f64)| {
        let own = m.within.powi(2) - (share * m.value).powi(2);
        ((m.value - truth).powi(2) - own).max(0.0).sqrt() / m.value
    };
    let mut all: Vec<f64> = given.iter().map(lacking).collect();
    all.sort_by(f64::total_cmp);
    let last = all.len().saturating_sub(1) as f64;
    all.get((0.95 * last).round() as usize)
        .copied()
        .unwrap_or(0.0)
}

/// The number whose error is in degrees.
const ZERO_LIFT: &str = "angle of zero lift";

/// A row of the page's table.
fn row(number: &str, vehicle: &str, given: &[(Measured, f64)]) -> String {
    let degrees = number == ZERO_LIFT;
    let error = |(m, truth): &(Measured, f64)| match degrees {
        true => m.value - truth,
        false => 100.0 * (m.value / truth - 1.0),
    };
    let mut errors: Vec<f64> = given.iter().map(error).collect();
    errors.sort_by(f64::total_cmp);
    let count = errors.len();
    if count == 0 {
        return format!("| {number} | {vehicle} | 0 | | | |");
    }
    let at = |share: f64| {
        let error = errors[((count - 1) as f64 * share).round() as usize];
        match degrees {
            true => format!("{error:.1}"),
            false => format!("{error:.0}"),
        }
    };
    let (unit, near) = match degrees {
        true => ("°", String::new()),
        false => {
            let near = errors.iter().filter(|error| error.abs() <= 10.0).count();
            (" %", format!("{} %", 100 * near / count))
        }
    };
    let hits = given
        .iter()
        .filter(|(m, truth)| (m.value - truth).abs() <= m.within);
    let hits = 100 * hits.count() / count;
    format!(
        "| {number} | {vehicle} | {count} | {}{unit} ({} to {}) | {near} | {hits} % |",
        at(0.5),
        at(0.05),
        at(0.95)
    )
}

/// How far a vehicle leaves its reference, up, down and at the end \[m\].
type Left = [f64; 3];

/// The round trip of a design that `new` makes of `known`, flown by what is true, in calm air with exact sensors; none where `new` says that its first flight
/// fails.
fn round_trip(
    flown: Flown,
    known: &str,
    polar: Option<&str>,
    draw: u64,
) -> Option<(Experiment, Left)> {
    let plant = flight(flown, draw).tail_sitter.unwrap();
    let authority = Belief::of(&plant.true_vehicle()).authority;
    let folder = std::env::temp_dir().join(format!(
        "alula-{}-{}-{draw}",
        flown.vehicle,
        std::process::id()
    ));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("known.toml");
    std::fs::write(&file, known).unwrap();
    if let Some(polar) = polar {
        std::fs::write(folder.join(POLAR), polar).unwrap();
    }
    // The flight has no steps of the pitch rate: what differences of thrust turn is measured beside.
    let turn = match flown.actuators {
        Actuators::Elevons => String::new(),
        _ => format!("turn_rad_s2 = {:?}", authority.difference_rad_s2),
    };
    let besides = Known::from_text("beside", &turn).unwrap();
    let facts = besides.or(Known::load(&file).unwrap()).facts().unwrap();
    let (design, first) = Design::new(facts).unwrap().as_it_brakes("learned");
    std::fs::remove_dir_all(&folder).unwrap();
    if first.ok()?.outcome() == Outcome::Fails {
        return None;
    }
    let mut trip = design.document("learned").unwrap().checked().unwrap();
    trip.tail_sitter = Some(plant);
    // Of its minute of hover a third: it is at rest by then.
    trip.duration_s -= 40.0;
    let calm = left(&trip);
    Some((trip, calm))
}

fn left(trip: &Experiment) -> Left {
    let figures = Figures::of(trip, &fly(trip).unwrap());
    [
        "altitude_most_m",
        "altitude_least_m",
        "max_late_position_error_m",
    ]
    .map(|name| figures.get(name))
}

/// A round trip as it was in calm air, and with the sensors of the identification flight in the turbulence of that, of this seed.
fn calm_and_rough(flown: Flown, (trip, calm): (Experiment, Left), draw: u64) -> [Left; 2] {
    let of = flight(flown, draw);
    let mut rough = trip;
    rough.sensors = of.sensors;
    rough.weather.turbulence = of.weather.turbulence;
    rough.seed = draw;
    [calm, left(&rough)]
}

/// `new` makes of what was identified a guidance that flies the vehicle as the one of what is known of it does. Prints a table.
fn closed(draws: u64) {
    println!(
        "| vehicle | of | air | flights | refused | above [m], median (most) | below [m], median (most) | off at the end [m], median (most) |"
    );
    println!("|---|---|---|---:|---:|---:|---:|---:|");
    for flown in FLOWN {
        let Flown {
            vehicle, cruise, ..
        } = flown;
        let first = flight(flown, FIRST);
        let (truth, given) = (Truth::of(&first), given(&first));
        let plant = first.tail_sitter.as_ref().unwrap().true_vehicle();
        let besides = Besides {
            actuators: flown.actuators,
            cruise_m_s: Some(cruise),
            aspect_ratio: Some(plant.wing.aspect_ratio),
            section: "naca-0012".to_owned(),
        };
        let exactly = |value: f64| Some(Measured { value, within: 0.0 });
        let known = Identified {
            thrust_to_weight: exactly(truth.thrust_to_weight),
            thrust_lag_s: exactly(truth.thrust_lag_s),
            rate_lag_s: exactly(truth.rate_lag_s),
            full_torque_rad_s2: exactly(truth.full_torque_rad_s2),
            ..Identified::default()
        };
        let rows = Belief::of(&plant).polar.into_iter();
        let rows = rows.map(|[alpha, c_l, c_d]| format!("{alpha},{c_l},{c_d}\n"));
        let polar = format!(
            "# For an aspect ratio of {}: the whole wing\nalpha_deg,cl,cd\n{}",
            plant.wing.aspect_ratio,
            rows.collect::<String>()
        );
        let whole = Besides {
            section: POLAR.to_owned(),
            ..besides.clone()
        };
        let text = known.known(&given, &whole, cruise);
        let seeds = || (FIRST..FIRST + draws).into_par_iter();
        // Its design and its calm air are the same whatever the seed.
        let trip = round_trip(flown, &text, Some(&polar), FIRST);
        let known: Vec<Option<[Left; 2]>> = seeds()
            .map(|seed| Some(calm_and_rough(flown, trip.clone()?, seed)))
            .collect();
        let learned: Vec<Option<[Left; 2]>> = seeds()
            .map(|seed| {
                let found = identified(&flight(flown, seed));
                let text = found.known(&given, &besides, cruise);
                let seen = found.polar(&besides).map(|wing| wing.csv);
                let trip = round_trip(flown, &text, seen.as_deref(), seed)?;
                Some(calm_and_rough(flown, trip, seed))
            })
            .collect();
        // In calm air within 5 m of its height, and back within 1 m; in turbulence within what `new`'s campaigns ask of 95 flights of a hundred.
        for (n, (air, [high, off])) in [("calm", [5.0, 1.0]), ("turbulence", [10.0, 2.0])]
            .into_iter()
            .enumerate()
        {
            let medians = [("known", &known), ("identified", &learned)].map(|(of, all)| {
                let refused = all.iter().filter(|one| one.is_none()).count();
                // `new` refuses one in five at most.
                assert!(5 * refused <= all.len(), "{vehicle}: {refused} refused");
                let flies: Vec<Left> = all.iter().flatten().map(|both| both[n]).collect();
                let column = |k: usize| {
                    let mut values: Vec<f64> = flies.iter().map(|row| row[k].abs()).collect();
                    values.sort_by(f64::total_cmp);
                    [values.len() / 2, values.len() - 1].map(|n| values[n])
                };
                let columns = [0, 1, 2].map(column);
                let [above, below, end] =
                    columns.map(|[median, most]| format!("{median:.1} ({most:.1})"));
                println!(
                    "| {vehicle} | {of} | {air} | {} | {refused} | {above} | {below} | {end} |",
                    all.len()
                );
                for [above, below, end] in flies {
                    let most = above.max(-below);
                    assert!(
                        most < high && end < off,
                        "{vehicle}, {of}, {air}: {most} m, {end} m"
                    );
                }
                columns.map(|[median, _]| median)
            });
            // What was identified flies as the known does: in the median within half a metre of it; of its height within the metre, too, that is half of what
            // is wanted of a first attempt.
            let [known, identified] = medians;
            let floors = [1.0, 1.0, 0.0];
            for ((known, identified), floor) in known.into_iter().zip(identified).zip(floors) {
                assert!(
                    identified < f64::max(known + 0.5, floor),
                    "{vehicle}, {air}: {identified} m in place of {known} m"
                );
            }
        }
    }
}

#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_what_was_identified_flies() {
    // The median of a few is chance: in turbulence a vehicle brakes through its stall, and flights differ by metres.
    closed(draws(8));
}

/// A flight that is too short, and one without a throttle, end with the reason.
#[test]
fn what_shows_nothing_is_said() {
    let mut experiment = flight(FLOWN[0], 0);
    experiment.duration_s = 8.0;
    let record = fly(&experiment).unwrap();
    let mut log = log(&experiment, &record).unwrap();
    let given = Given {
        mass_kg: 2.4,
        wing_m2: 0.4,
        air_kg_m3: 1.225,
    };
    let states = find(&log).unwrap();
    let error = identify(&log, &states, &given).unwrap_err().to_string();
    assert!(error.contains("s of flight with velocity"), "{error}");
    log.topics
        .retain(|topic| topic.name() != "vehicle_thrust_setpoint");
    let error = identify(&log, &states, &given).unwrap_err().to_string();
    assert!(error.contains("no throttle"), "{error}");
}

/// Motors are at their stop where the mixer says that it could not give their torque, and nowhere where it does not say so.
#[test]
fn a_stop_is_what_the_mixer_says() {
    let experiment = flight(FLOWN[2], FIRST);
    let mut log = log(&experiment, &fly(&experiment).unwrap()).unwrap();
    let mixer = "control_allocator_status";
    let time = log.topic(mixer).unwrap().time().to_vec();
    log.topics.retain(|topic| topic.name() != mixer);
    let at_stop = |log: &Log| identify_in(log, &experiment).turn_rad_s2.unwrap().at_stop;
    assert!(!at_stop(&log));
    let missing = Column::new("unallocated_torque[1]", "", vec![-0.2; time.len()]);
    log.topics
        .push(Topic::new(mixer, 0, time, vec![missing]).unwrap());
    assert!(at_stop(&log));
}

/// The log of a circle on the wing in turbulence and a wind towards north and east [m/s], with an airspeed sensor that tells 3 % too much, and without a wind: nothing
/// has to know it.
fn circle(flown: Flown, wind: [f64; 2], seed: u64) -> (Experiment, Log) {
    let Flown {
        vehicle, cruise, ..
    } = flown;
    let mut document = Document::load("tail-sitter-circle").unwrap();
    let [north, east] = wind;
    // A bank of 22°.
    let radius = 0.25 * cruise * cruise;
    for change in [
        format!("plant.vehicle={vehicle}"),
        format!("path.circle={{radius_m={radius:?},speed_m_s={cruise:?}}}"),
        "duration_s=100.0".to_owned(),
        format!("seed={seed}"),
        "weather.turbulence={wind_at_20_ft_m_s=3.0,height_m=30.0}".to_owned(),
        format!("weather.steady_m_s=[{north:?},{east:?},0.0]"),
    ] {
        document.assign(&change).unwrap();
    }
    let experiment = document.checked().unwrap();
    let mut log = log(&experiment, &fly(&experiment).unwrap()).unwrap();
    log.topics
        .retain(|topic| !["wind", TOLD].contains(&topic.name()));
    let of = |topic: &&mut Topic| topic.name() == "airspeed_validated";
    let sensor = log.topics.iter_mut().find(of).unwrap();
    let told = sensor.column("true_airspeed_m_s").unwrap();
    let more = told.values.iter().map(|speed| 1.03 * speed).collect();
    let column = Column::new("true_airspeed_m_s", "m/s", more);
    *sensor = Topic::new(sensor.name(), 0, sensor.time().to_vec(), vec![column]).unwrap();
    (experiment, log)
}

/// Nine in ten intervals of the wind hold it. Prints the table of the page.
fn winds(draws: u64) {
    println!(
        "| vehicle | circles | given | off [m/s], median, 95 % | interval [m/s], median | held |"
    );
    println!("|---|---:|---:|---:|---:|---:|");
    for flown in [FLOWN[0], FLOWN[1]] {
        let seeds = (FIRST..FIRST + draws).into_par_iter();
        let found: Vec<(Measured, f64)> = seeds
            .flat_map_iter(|seed| {
                // From all around, of up to a quarter of cruise.
                let (strength, (sin, cos)) = ((seed % 5) as f64, (2.4 * seed as f64).sin_cos());
                let wind = [cos, sin].map(|part| flown.cruise / 16.0 * strength * part);
                let (experiment, log) = circle(flown, wind, seed);
                // A circle alone may tell too little of the thrust: then there is a reason, and no number.
                let found = identify(&log, &find(&log).unwrap(), &given(&experiment));
                let found = found.map_or([None; 2], |found| found.wind_m_s);
                let pairs = found.into_iter().zip(wind);
                pairs.filter_map(|(found, truth)| Some((found?, truth)))
            })
            .collect();
        let of = |number: &dyn Fn(&(Measured, f64)) -> f64, share: f64| {
            let mut all: Vec<f64> = found.iter().map(number).collect();
            all.sort_by(f64::total_cmp);
            all[((all.len() - 1) as f64 * share).round() as usize]
        };
        let off = |(m, truth): &(Measured, f64)| (m.value - truth).abs();
        let hits = found.iter().filter(|pair| off(pair) <= pair.0.within);
        let (hits, count) = (hits.count() as f64, found.len() as f64);
        println!(
            "| {} | {draws} | {} of {} | {:.1}, {:.1} | {:.1} | {:.0} % |",
            flown.vehicle,
            found.len(),
            2 * draws,
            of(&off, 0.5),
            of(&off, 0.95),
            of(&|(m, _)| m.within, 0.5),
            100.0 * hits / count
        );
        // The small wing is slow, and its airspeed says less of the wind: half of the numbers.
        assert!(count >= draws as f64, "{count} of {draws} circles");
        assert!(
            hits + 0.5 >= 0.9 * count - 2.0 * (0.09 * count).sqrt(),
            "{hits} of {count}"
        );
    }
}

#[test]
fn a_circle_shows_the_wind() {
    winds(2);
}

#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_circles_show_the_wind() {
    winds(draws(3));
}

/// A log of our own at 50 Hz: a vehicle that is level, under 1 g, with a throttle of 30 %, and the velocity down and north of a time.
fn level(velocity: impl Fn(f64) -> [f64; 2]) -> Log {
    let time: Vec<f64> = (0..3000).map(|n| 0.02 * f64::from(n)).collect();
    let topic = |name: &str, columns: &[(&str, &dyn Fn(f64) -> f64)]| {
        let columns = columns
            .iter()
            .map(|(name, of)| Column::new(name, "", time.iter().map(|t| of(*t)).collect()));
        Topic::new(name, 0, time.clone(), columns.collect()).unwrap()
    };
    let (one, none) = (|_| 1.0, |_| 0.0);
    let north = |t| velocity(t)[1];
    let down = |t| velocity(t)[0];
    Log {
        topics: vec![
            topic(
                "vehicle_attitude",
                &[
                    ("q[0]", &one),
                    ("q[1]", &none),
                    ("q[2]", &none),
                    ("q[3]", &none),
                ],
            ),
            topic(
                "vehicle_local_position",
                &[("vx", &north), ("vy", &none), ("vz", &down)],
            ),
            topic(
                "vehicle_acceleration",
                &[
                    ("xyz[0]", &|_| 0.5),
                    ("xyz[1]", &none),
                    ("xyz[2]", &|_| -9.81),
                ],
            ),
            topic(
                "actuator_controls_0",
                &[("control[3]", &|t: f64| 0.3 + 0.02 * (3.0 * t).sin())],
            ),
        ],
        notes: Vec::new(),
    }
}

/// A multirotor, a vehicle that stands, and an estimate that runs away on the ground: of each the reason, and no number.
#[test]
fn what_is_no_tail_sitter_is_given_no_number() {
    let given = Given {
        mass_kg: 1.5,
        wing_m2: 0.3,
        air_kg_m3: 1.225,
    };
    let reason = |log: &Log| {
        let states = find(log).unwrap();
        identify(log, &states, &given).unwrap_err().to_string()
    };
    let multirotor = reason(&level(|t| [(0.5 * t).sin(), 0.5]));
    assert!(multirotor.contains("across the nose"), "{multirotor}");
    let stands = reason(&level(|_| [0.0, 0.0]));
    assert!(stands.contains("it flies, not stands, in 0 %"), "{stands}");
    let runs_away = reason(&level(|t| {
        let speed = 3.5 * (t / 15.0).exp();
        [0.1 * speed * t.sin(), speed]
    }));
    assert!(runs_away.contains("the model predicts"), "{runs_away}");
}
