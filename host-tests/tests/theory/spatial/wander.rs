//! Random missions of the guidance in space: velocities in any direction, as steps and ramps; wind from anywhere, turbulence;
//! beliefs off by 15 % of mass, 30 % of k_a, half of c_Y, and the wrong coefficients; thrust from 1.25 times the weight.

use alula_sim::experiment::{Document, V3};
use alula_sim::simulate::{Record, Step, fly as fly_experiment};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// From a time \[s\] on: a velocity, and the acceleration that leads to it. A step has no acceleration that could be told.
struct Leg {
    from: f64,
    velocity: V3,
    acceleration: f64,
}

/// Accelerations from this on are steps.
const STEP: f64 = 50.0;
/// Time \[s\] at the end in which the vehicle is to come back.
const REST: f64 = 60.0;

struct Mission {
    legs: Vec<Leg>,
}

impl Mission {
    fn random(rng: &mut ChaCha8Rng) -> Self {
        let mut u = |a: f64, b: f64| rng.random_range(a..b);
        let leg = |from, velocity, acceleration| Leg {
            from,
            velocity,
            acceleration,
        };
        let mut legs = vec![leg(0.0, V3::zeros(), 3.0)];
        let mut from = 3.0;
        for _ in 0..4 {
            let (speed, heading) = (u(-3.0, 22.0).max(0.0), u(-3.2, 3.2));
            // Fast, no more sink than a glide has.
            let most = if speed < 8.0 { 3.0 } else { 0.05 * speed };
            let down = u(-2.0, most);
            let steps = u(0.0, 1.0) < 0.3;
            let acceleration = if steps { 2.0 * STEP } else { u(1.0, 4.0) };
            let velocity = V3::new(speed * heading.cos(), speed * heading.sin(), down);
            legs.push(leg(from, velocity, acceleration));
            from += u(4.0, 14.0);
        }
        legs.push(leg(from, V3::zeros(), u(1.0, 4.0)));
        Self { legs }
    }

    fn duration(&self) -> f64 {
        self.legs.last().unwrap().from + REST
    }

    /// The knots of its path.
    fn knots(&self) -> String {
        /// How long a step takes \[s\]: at no control step but by chance.
        const AT_ONCE: f64 = 1e-6;
        let mut knots = Vec::new();
        let mut velocity = V3::zeros();
        for (n, leg) in self.legs.iter().enumerate() {
            let change = leg.velocity - velocity;
            let lasts = match leg.acceleration < STEP {
                true => (change.norm() / leg.acceleration).max(AT_ONCE),
                false => AT_ONCE,
            };
            // The next leg may begin before this one is there.
            let next = self.legs.get(n + 1).map_or(f64::INFINITY, |next| next.from);
            let share = ((next - leg.from - AT_ONCE) / lasts).min(1.0);
            knots.push((leg.from, velocity));
            velocity += share * change;
            knots.push((leg.from + share * lasts, velocity));
        }
        let knot = |(t, v): &(f64, V3)| {
            format!(
                "{{ t_s = {t:?}, forward_m_s = {:?}, east_m_s = {:?}, down_m_s = {:?} }}",
                v.x, v.y, v.z
            )
        };
        let knots: Vec<String> = knots.iter().map(knot).collect();
        format!("path.knots=[{}]", knots.join(", "))
    }
}

/// The flight of this seed; none if its belief cannot hover.
fn fly(seed: u64, accelerometer: bool) -> Option<Record> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut u = |a: f64, b: f64| rng.random_range(a..b);
    let most = 98.1 * u(1.25, 2.0);
    let (mass, k_a, c_y) = (
        10.0 * u(0.85, 1.15),
        0.646 * u(0.75, 1.3),
        0.5 * u(0.5, 1.5),
    );
    let wing = if u(0.0, 1.0) < 0.5 {
        "paper-belief"
    } else {
        "paper"
    };
    if most < 1.02 * mass * 9.81 {
        return None;
    }
    let (speed, from, facing) = (u(0.0, 6.0), u(-3.2, 3.2), u(-3.2, 3.2));
    let strength = [0.0, 3.0, 7.7][u(0.0, 2.999) as usize];
    let mission = Mission::random(&mut rng);
    let mut document = Document::load("space").unwrap();
    let mut set = |setting: String| document.assign(&setting).unwrap();
    set(mission.knots());
    set(format!("duration_s={:?}", mission.duration()));
    set(format!("seed={seed}"));
    set("substeps=1".to_owned());
    set(format!("plant.thrust_n=[0.0, {most:?}]"));
    set("controller.guidance={ max_rate_rad_s = 3.5 }".to_owned());
    set(format!(
        "controller.guidance.vehicle={{ mass_kg = {mass:?}, k_a_kg_m = {k_a:?}, c_y = {c_y:?} }}"
    ));
    set(format!(
        "weather.steady_m_s=[{:?}, {:?}, 0.0]",
        speed * from.cos(),
        speed * from.sin()
    ));
    if strength > 0.0 {
        set(format!(
            "weather.turbulence={{ wind_at_20_ft_m_s = {strength:?}, height_m = 50.0 }}"
        ));
    }
    set(format!("initial.heading_deg={:?}", facing.to_degrees()));
    set("initial.thrust_n=98.1".to_owned());
    if !accelerometer {
        set("sensors.accelerometer=\"none\"".to_owned());
    }
    let wing = Document::load(wing)
        .unwrap()
        .get("vehicle.aerodynamics")
        .cloned();
    let wing = wing.unwrap();
    document
        .set("controller.guidance.vehicle.aerodynamics", wing)
        .unwrap();
    Some(fly_experiment(&document.checked().unwrap()).unwrap())
}

/// Not one is 50 m under its reference, or as far over it, and all but a few are back on it a minute after it has stopped.
#[test]
#[ignore = "slow: cargo test-slow"]
fn slow_random_missions_are_not_lost() {
    for accelerometer in [true, false] {
        let flights: Vec<_> = (50_000..50_060)
            .filter_map(|seed| fly(seed, accelerometer))
            .collect();
        let most =
            |record: &[Step], of: fn(&Step) -> f64| record.iter().map(of).fold(0.0, f64::max);
        let low = flights
            .iter()
            .map(|s| most(s, |s| -s.altitude()))
            .fold(0.0, f64::max);
        let high = flights
            .iter()
            .map(|s| most(s, Step::altitude))
            .fold(0.0, f64::max);
        // Turbulence leaves a metre.
        let back = flights
            .iter()
            .filter(|s| most(&s[s.len() - 300..], |s| s.position_error().norm()) < 5.0)
            .count();
        let n = flights.len();
        println!(
            "accelerometer {accelerometer}: of {n}, {low:.1} m low, {high:.1} m high, {back} back"
        );
        assert!(low < 50.0 && high < 50.0 && back * 100 >= n * 97);
    }
}

/// Without an accelerometer, lift per weight believed up to one and a half times too high: the integral, multiplied by a
/// large |F_p|, once asked for more thrust the faster the vehicle flew. These flights reached 77, 53 and 61 m/s, and 660 m.
#[test]
fn the_integral_asks_for_no_thrust_that_grows_with_the_speed() {
    for seed in [371, 946, 1184] {
        let record = fly(seed, false).unwrap();
        let calm =
            |s: &Step| (s.truth.velocity - s.wind).norm() < 40.0 && s.altitude().abs() < 40.0;
        assert!(record.iter().all(calm), "{seed}");
    }
}
