//! Random vehicles of `new`: what their first flights come to.

use std::collections::BTreeMap;

use alula_design::{Actuators, Design, Known, Outcome, RoundTrip};
use rayon::prelude::*;

/// Angular accelerations of elevons [rad/s²].
const ELEVONS: [f64; 5] = [10.0, 20.0, 40.0, 80.0, 150.0];

/// The vehicle of this number: each of its numbers evenly over a range, or over its logarithm, and no two alike.
fn vehicle(n: u32) -> (Actuators, Known) {
    let part = |prime: f64| (f64::from(n) * prime.sqrt()).fract();
    let even = |prime: f64, [least, most]: [f64; 2]| least + part(prime) * (most - least);
    let log = |prime: f64, [least, most]: [f64; 2]| least * (most / least).powf(part(prime));
    let actuators = [Actuators::Elevons, Actuators::Motors, Actuators::Both][n as usize % 3];
    let turn = match actuators {
        Actuators::Elevons => ELEVONS[n as usize / 3 % ELEVONS.len()],
        Actuators::Motors | Actuators::Both => log(2.0, [60.0, 300.0]),
    };
    let mass = log(3.0, [0.2, 25.0]);
    let cruise = log(5.0, [10.0, 25.0]);
    let wing = mass * 9.81 / (0.6125 * cruise * cruise * even(7.0, [0.25, 0.6]));
    let sections = ["naca-0012", "naca-0015", "naca-0018", "naca-0021"];
    let known = Known {
        mass_kg: Some(mass),
        wing_m2: Some(wing),
        section: Some(sections[n as usize / 5 % sections.len()].to_owned()),
        thrust_to_weight: Some(even(11.0, [1.2, 2.5])),
        thrust_lag_s: Some(even(13.0, [0.04, 0.12])),
        rate_lag_s: Some(even(17.0, [0.04, 0.12])),
        cruise_m_s: Some(cruise),
        turn_rad_s2: Some(turn),
        actuators: Some(actuators),
        aspect_ratio: Some(even(19.0, [3.0, 8.0])),
        drag_area_m2: Some(even(23.0, [0.01, 0.04]) * wing),
        ..Known::default()
    };
    (actuators, known)
}

/// What comes of its round trip; one that comes to no number fails.
fn outcome(design: &Design) -> Outcome {
    let flown = RoundTrip::of(design, "random");
    flown.map_or(Outcome::Fails, |flown| flown.outcome())
}

/// First flights of random vehicles, level and as `new` has them brake: what it chooses is no worse, and of those that have enough to turn with one in ten fails at
/// most. Prints the table of docs/results.md; `RANDOM_VEHICLES` says how many.
#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_random_vehicles_fly_their_first_flight() {
    let count = std::env::var("RANDOM_VEHICLES").ok();
    let count = count.and_then(|n| n.parse().ok()).unwrap_or(30);
    let flown: Vec<_> = (1..=count)
        .into_par_iter()
        .filter_map(|n| {
            let (actuators, known) = vehicle(n);
            // Numbers that do not go together are refused.
            let design = Design::new(known.facts().ok()?).ok()?;
            let kind = match actuators {
                Actuators::Elevons if design.facts.turn_rad_s2 < 30.0 => {
                    "elevons, 10 and 20 rad/s²"
                }
                Actuators::Elevons if design.facts.turn_rad_s2 < 60.0 => "elevons, 40 rad/s²",
                Actuators::Elevons => "elevons, 80 and 150 rad/s²",
                Actuators::Motors => "motors, 60 to 300 rad/s²",
                Actuators::Both => "both, 60 to 300 rad/s²",
            };
            let level = outcome(&design);
            let (_, chosen) = design.as_it_brakes("random");
            let chosen = chosen.map_or(Outcome::Fails, |flown| flown.outcome());
            Some((kind, [level, chosen]))
        })
        .collect();
    let mut table: BTreeMap<&str, [[usize; 3]; 2]> = BTreeMap::new();
    for (kind, outcomes) in &flown {
        let cells = table.entry(*kind).or_default();
        for (cells, outcome) in cells.iter_mut().zip(outcomes) {
            cells[*outcome as usize] += 1;
        }
    }
    println!("{} of {count} are vehicles", flown.len());
    println!("| turned by | braking | as asked | outside the goals | fail |");
    println!("|---|---|---:|---:|---:|");
    for (kind, both) in &table {
        for (braking, [asked, outside, fail]) in ["level", "as `new` chooses"].iter().zip(both) {
            println!("| {kind} | {braking} | {asked} | {outside} | {fail} |");
        }
    }
    for (kind, [[level_asked, _, level_fails], [asked, outside, fails]]) in &table {
        assert!(
            asked >= level_asked && fails <= level_fails,
            "{kind}: {table:?}"
        );
        let all = asked + outside + fails;
        let weak = ["elevons, 10", "elevons, 40"]
            .iter()
            .any(|weak| kind.starts_with(weak));
        assert!(
            weak || 10 * fails <= all + 9,
            "{kind}: {fails} of {all} fail"
        );
    }
    assert!(3 * flown.len() > 2 * count as usize, "{}", flown.len());
}
