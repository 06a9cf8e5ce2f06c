//! `alula-sil identify`: a vehicle learned from its log. The flights are of tail-sitters as they are, with an autopilot's sensors.

use alula_design::identify::{Given, Identified, identify};
use alula_logs::states::find;
use alula_sim::experiment::{Document, Experiment};
use alula_sim::flight_log::log;
use alula_sim::plant::tail_sitter::{Belief, TailSitter};
use alula_sim::simulate::fly;
use rayon::prelude::*;

/// The flight of the page: hover with steps, three level speeds, a climb, a glide, and transitions there and back, of the vehicle with this seed.
fn flight(vehicle: &str, cruise: f64, seed: u64) -> Experiment {
    let mut document = Document::load("tail-sitter-hover").unwrap();
    let mut knots: Vec<(f64, f64, f64)> = vec![(0.0, 0.0, 0.0)];
    // Duration of a change, of what is held then, and the velocity: down, forward.
    let hover = [
        (1.0, 4.0, 0.0, 0.0),
        (0.5, 2.0, -1.5, 0.0),
        (0.5, 2.0, 1.5, 0.0),
        (0.5, 2.0, -1.5, 0.0),
        (0.5, 4.0, 0.0, 0.0),
        (0.5 * cruise, 12.0, 0.0, cruise),
    ];
    let round = [
        (3.0, 10.0, 0.0, 1.2 * cruise),
        (4.0, 10.0, 0.0, 0.8 * cruise),
        (2.0, 8.0, -0.12 * cruise, cruise),
        (3.0, 8.0, 0.1 * cruise, cruise),
        (2.0, 6.0, 0.0, cruise),
    ];
    let back = [
        (0.6 * cruise, 8.0, -1.0, 0.0),
        (0.5 * cruise, 10.0, 0.0, cruise),
        (0.6 * cruise, 8.0, -1.0, 0.0),
    ];
    for &(change, hold, down, forward) in hover.iter().chain(&round).chain(&back) {
        let t = knots.last().unwrap().0;
        knots.push((t + change, down, forward));
        knots.push((t + change + hold, down, forward));
    }
    let last = knots.last().unwrap().0;
    let knots: Vec<String> = knots
        .iter()
        .map(|(t, down, forward)| {
            format!("{{t_s={t:?},down_m_s={down:?},forward_m_s={forward:?}}}")
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

fn identified(experiment: &Experiment) -> Identified {
    let record = fly(experiment).unwrap();
    let log = log(experiment, &record).unwrap();
    let plant = experiment.tail_sitter.as_ref().unwrap().true_vehicle();
    let given = Given {
        mass_kg: plant.mass_kg,
        wing_m2: Belief::of(&plant).k_a_kg_m / 0.6125,
        air_kg_m3: 1.225,
    };
    identify(&log, &find(&log).unwrap(), &given).unwrap()
}

/// What is true of the vehicle, in the words of [`Identified`]: static thrust over weight, slope of c_L, angle of zero lift \[°\], lag of the rates.
struct Truth {
    thrust_to_weight: f64,
    c_l_alpha: f64,
    zero_lift_deg: f64,
    rate_lag_s: f64,
}

fn truth(experiment: &Experiment) -> Truth {
    let plant = experiment.tail_sitter.as_ref().unwrap().true_vehicle();
    let belief = Belief::of(&plant);
    let near: Vec<&[f64; 3]> = belief
        .polar
        .iter()
        .filter(|row| (-4.0..=8.0).contains(&row[0]))
        .collect();
    let n = near.len() as f64;
    let mean = |k: usize| near.iter().map(|row| row[k]).sum::<f64>() / n;
    let (a, l) = (mean(0), mean(1));
    let slope = near
        .iter()
        .map(|row| (row[0] - a) * (row[1] - l))
        .sum::<f64>()
        / near.iter().map(|row| (row[0] - a).powi(2)).sum::<f64>();
    // In hover the battery sags by what hover takes.
    let static_f = TailSitter::new(plant.clone(), None).static_thrust() / (9.81 * plant.mass_kg);
    let battery = 1.0 - plant.motors.sag * static_f.powf(-1.5);
    Truth {
        thrust_to_weight: static_f * battery * battery,
        c_l_alpha: slope.to_degrees(),
        zero_lift_deg: a - l / slope,
        rate_lag_s: belief.rate_lag_s,
    }
}

#[test]
fn a_vehicle_is_learned_from_its_flight() {
    learned(1);
}

#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_vehicles_are_learned_from_their_flights() {
    let draws = std::env::var("IDENTIFY_DRAWS").ok();
    learned(draws.and_then(|n| n.parse().ok()).unwrap_or(2));
}

/// What is identified of `draws` flights of each vehicle holds the truth: what is given has it in its interval, but for one number in ten, and the thrust
/// over the weight is within a tenth. What is not shown is said. With few the shares are coarse.
fn learned(draws: u64) {
    for (vehicle, cruise) in [
        ("mapping", 18.0),
        ("small-flying-wing", 10.0),
        ("biplane", 18.0),
    ] {
        let all: Vec<(Identified, Truth)> = (0..draws)
            .into_par_iter()
            .map(|seed| {
                let experiment = flight(vehicle, cruise, seed);
                (identified(&experiment), truth(&experiment))
            })
            .collect();
        // Static thrust over weight, lag of the rates, slope of c_L, angle of zero lift.
        let mut held = [(0, 0); 4];
        for (found, truth) in &all {
            let thrust = found.thrust_to_weight.unwrap();
            let ratio = thrust.value / truth.thrust_to_weight;
            assert!(
                (0.9..1.12).contains(&ratio),
                "{vehicle}: {thrust:?} of {}",
                truth.thrust_to_weight
            );
            let pairs = [
                (
                    found.thrust_to_weight,
                    truth.thrust_to_weight,
                    0.1 * truth.thrust_to_weight,
                ),
                (found.rate_lag_s, truth.rate_lag_s, 0.04),
                (found.c_l_alpha, truth.c_l_alpha, 0.0),
                (found.zero_lift_deg, truth.zero_lift_deg, 0.0),
            ];
            for ((hits, count), (measured, truth, besides)) in held.iter_mut().zip(pairs) {
                if let Some(m) = measured {
                    *count += 1;
                    *hits += i32::from((m.value - truth).abs() <= m.within + besides);
                }
            }
            let shown = [found.c_l_alpha.is_some(), found.c_d_cruise.is_some()];
            for (shown, what) in shown.into_iter().zip(["c_L of the wing", "c_D in cruise"]) {
                let said = found.missing.iter().any(|line| line.starts_with(what));
                assert!(shown != said, "{vehicle}: {what}: {:?}", found.missing);
            }
            // On data that was not fitted the thrust is predicted.
            assert!(found.predicted[0] > 0.0 && !found.held_out.is_empty());
        }
        println!("{vehicle}: truth in the interval, of those given: {held:?} of {draws} flights");
        for (hits, count) in held {
            assert!(10 * hits >= 8 * count - 10, "{vehicle}: {held:?}");
        }
    }
}

/// A flight that is too short, and one without a throttle, end with the reason.
#[test]
fn what_shows_nothing_is_said() {
    let mut experiment = flight("mapping", 18.0, 0);
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

/// From the log to a vehicle that flies, by the commands of the page; each number of the file says whether it was measured.
#[test]
fn a_log_becomes_a_vehicle() {
    let folder = tempfile::tempdir().unwrap();
    let of_the_page = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../examples/identification.toml"
    );
    let document = Document::load(of_the_page).unwrap();
    let experiment = document.checked().unwrap();
    let record = fly(&experiment).unwrap();
    let log = log(&experiment, &record).unwrap();
    let file = std::fs::File::create(folder.path().join("flight.ulg")).unwrap();
    alula_logs::ulog::write(&log, file).unwrap();
    let run = |arguments: &str| {
        let output = crate::alula(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.success(), said)
    };
    let (good, said) =
        run("identify flight.ulg --mass-kg 2.4 --wing-m2 0.4 --cruise-m-s 18 --out found");
    assert!(good, "{said}");
    let known = std::fs::read_to_string(folder.path().join("found/known.toml")).unwrap();
    for line in known.lines() {
        let source = line.split_once("# ").map_or("", |(_, source)| source);
        let says = ["measured", "assumed", "given", "flown"]
            .iter()
            .any(|word| source.starts_with(word));
        assert!(says, "{line}");
    }
    assert!(folder.path().join("found/report.html").exists());
    // The flight may miss its goals; the files are there.
    let (_, said) = run("new mine --from found/known.toml");
    assert!(folder.path().join("mine/vehicle.h").exists(), "{said}");
}
