//! Random missions in space.

use alula::{
    Combined, CombinedParameters, Guidance, GuidanceParameters, Vehicle, VehicleParameters,
};
use alula_sil::space::Turbulence;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::flown::{PERIOD, Setup, Target, V3, hover};
use crate::guided::Flown;

struct Random {
    position: V3,
    velocity: V3,
    acceleration: V3,
    legs: Vec<(f64, V3, f64)>,
}

impl Random {
    fn target(&mut self, t: f64) -> Target {
        let (_, want, most) = *self.legs.iter().rev().find(|l| l.0 <= t).unwrap();
        let missing = want - self.velocity;
        let step = most * PERIOD;
        let change = if missing.norm() > step {
            missing * (step / missing.norm())
        } else {
            missing
        };
        self.acceleration = change / PERIOD;
        if most > 50.0 {
            self.acceleration = V3::zeros();
        }
        let out = Target {
            position: self.position,
            velocity: self.velocity,
            acceleration: self.acceleration,
            ..Target::default()
        };
        self.velocity += change;
        self.position += self.velocity * PERIOD;
        out
    }
}

#[test]
#[ignore]
fn wander() {
    let n: u64 = std::env::var("N").map_or(100, |n| n.parse().unwrap());
    let first: u64 = std::env::var("FIRST").map_or(0, |n| n.parse().unwrap());
    let only: Option<u64> = std::env::var("SEED").ok().map(|n| n.parse().unwrap());
    let (mut lost, mut away, mut low, mut peak) = (0, 0, Vec::new(), Vec::new());
    for seed in first..first + n {
        if only.is_some_and(|s| s != seed) {
            continue;
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut u = |a: f64, b: f64| rng.random_range(a..b);
        let excess = u(1.25, 2.0);
        let belief = VehicleParameters {
            mass: (10.0 * u(0.85, 1.15)) as f32,
            k_a: (0.646 * u(0.75, 1.3)) as f32,
            c_y: (0.5 * u(0.5, 1.5)) as f32,
            thrust_max: (98.1 * excess) as f32,
            ..VehicleParameters::PAPER
        };
        let wrong = u(0.0, 1.0) < 0.5;
        let model = Combined::new(if wrong {
            CombinedParameters::PAPER_BELIEF
        } else {
            CombinedParameters::NACA_0021_RE_160E3
        })
        .unwrap();
        if belief.thrust_max < 1.02 * belief.mass * 9.81 {
            continue;
        }
        let guidance = Guidance::new(
            Vehicle::new(belief, model).unwrap(),
            &GuidanceParameters {
                max_rate: 3.5,
                ..GuidanceParameters::default()
            },
        )
        .unwrap();
        let mut plant = Setup::new().plant;
        plant.thrust = [0.0, 98.1 * excess];
        let accelerometer = std::env::var_os("NOACC").is_none();
        let f = Flown {
            plant,
            guidance,
            wind_told: None,
            accelerometer,
        };
        let mut legs = vec![(0.0, V3::zeros(), 3.0)];
        let mut t = 3.0;
        for _ in 0..4 {
            let (speed, heading, climb) = (u(-3.0, 22.0_f64).max(0.0), u(-3.2, 3.2), u(-2.0, 3.0));
            let most = if u(0.0, 1.0) < 0.3 {
                100.0
            } else {
                u(1.0, 4.0)
            };
            legs.push((
                t,
                V3::new(
                    speed * heading.cos(),
                    speed * heading.sin(),
                    if speed < 8.0 {
                        climb
                    } else {
                        climb.min(0.05 * speed)
                    },
                ),
                most,
            ));
            t += u(4.0, 14.0);
        }
        let end = t;
        legs.push((t, V3::zeros(), u(1.0, 4.0)));
        let (speed, from) = (u(0.0, 6.0), u(-3.2, 3.2));
        let steady = V3::new(speed * from.cos(), speed * from.sin(), 0.0);
        let strength = [0.0, 3.0, 7.7][u(0.0, 2.999) as usize];
        let mut task = Random {
            position: V3::zeros(),
            velocity: V3::zeros(),
            acceleration: V3::zeros(),
            legs: legs.clone(),
        };
        let start = hover(u(-3.2, 3.2));
        let mut air = Turbulence::new(strength, 50.0, from, &mut rng);
        let mut blow = |_: f64, speed: f64| {
            air.advance(speed, PERIOD, &mut rng);
            steady + air.velocity()
        };
        let samples = f.fly(&mut |t: f64| task.target(t), start, end + 60.0, &mut blow);
        if only.is_some() {
            for s in samples.iter().step_by(50) { println!("| {:.1} below {:.1} v_err {:.1} x_err {:.1} airspeed {:.1} nose_up {:.2} belly_down {:.2} beta {:.2}", s.t, s.below, s.velocity_error, s.position_error, s.airspeed, s.nose_up, s.belly_down, s.sideslip); }
        }
        let lowest = samples.iter().map(|s| s.below).fold(0.0, f64::max);
        let highest = samples.iter().map(|s| -s.below).fold(0.0, f64::max);
        let late = &samples[samples.len() - 300..];
        let worst = |f: fn(&crate::flown::Sample) -> f64| late.iter().map(f).fold(0.0, f64::max);
        let (x, v) = (worst(|s| s.position_error), worst(|s| s.velocity_error));
        let calm = strength == 0.0;
        let gone = lowest > 50.0;
        let off = x > 5.0 || (calm && v > 0.5) || v > 4.0;
        if gone || off || lowest > 8.0 || only.is_some() {
            println!(
                "| seed {seed}: low {lowest:.1} high {highest:.1} late x {x:.1} v {v:.2} T/W {excess:.2} wrong {wrong} m {:.1} ka {:.2} wind {speed:.1} turb {strength} legs {:.1?}",
                belief.mass,
                belief.k_a,
                legs.iter()
                    .map(|l| (l.0, l.1.x, l.1.y, l.1.z, l.2))
                    .collect::<Vec<_>>()
            );
        }
        lost += usize::from(gone);
        away += usize::from(off);
        low.push(lowest);
        peak.push(highest);
    }
    for v in [&mut low, &mut peak] {
        v.sort_by(f64::total_cmp);
    }
    let q = |v: &Vec<f64>, p: usize| v[(v.len() - 1) * p / 100];
    println!(
        "| lost {lost} away {away} of {}; low 50/95/99/100: {:.1} {:.1} {:.1} {:.1}; high {:.1} {:.1} {:.1} {:.1}",
        low.len(),
        q(&low, 50),
        q(&low, 95),
        q(&low, 99),
        q(&low, 100),
        q(&peak, 50),
        q(&peak, 95),
        q(&peak, 99),
        q(&peak, 100)
    );
}
