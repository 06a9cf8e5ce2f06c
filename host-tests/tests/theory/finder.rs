//! The on-board finder of equilibria, in f32, against a brute-force scan in f64.
//!
//! Random models, tables among them, random vehicles, thrust lines, references, accelerations and winds. Both are given the
//! same numbers: the scan those of the core.

use std::f64::consts::{PI, TAU};

use alula::planar::equilibrium::Equilibria;
use alula::planar::{Inertial, Reference};
use alula::{
    Aerodynamics as _, CombinedParameters, LargeAngle, LargeAngleParameters, Parameters as _,
    SmallAngle, SmallAngleParameters, Vehicle, VehicleParameters,
};
use alula_design::envelope::Curve;
use alula_sim::experiment::Model;
use alula_sim::polar::{BUILT_IN, Polar};
use alula_sim::reference::{self, Aerodynamics, wrap};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Nodes of the brute-force scan around the circle: 0.05° apart, half of what a pair may be closer than.
const NODES: usize = 7200;
const MODELS: usize = 40;
const CASES: usize = 2600;

/// Pairs at a fold closer than this \[rad\] are rounding's to give or to take: 0.1°, as the finder documents.
const PAIR: f64 = 0.1 * PI / 180.0;

/// F̄_2 in single precision, relative to the forces that balance in it: some roundings.
const NOISE: f64 = 2e-6;

/// Coefficients and directions at every node of the scan.
struct Scan {
    model: Aerodynamics,
    nodes: Vec<[f64; 4]>,
}

impl Scan {
    fn new(model: Aerodynamics) -> Self {
        let node = |i: usize| {
            let alpha = alpha(i);
            let c = model.at(alpha);
            let (sin, cos) = alpha.sin_cos();
            [sin, cos, c.c_l, c.c_d]
        };
        Self {
            nodes: (0..NODES).map(node).collect(),
            model,
        }
    }
}

fn alpha(i: usize) -> f64 {
    // Off every multiple of 0.05°.
    TAU * (i as f64 + 0.317) / NODES as f64 - PI
}

/// F̄_2 as a function of α, from W·e_v, W·e_n, k_a|v_a|² and δ.
struct Balance {
    along: f64,
    across: f64,
    pressure: f64,
    delta: f64,
}

impl Balance {
    fn new(p: &VehicleParameters, reference: &Reference, wind: Inertial) -> Self {
        let v = [
            f64::from(reference.velocity.down()) - f64::from(wind.down()),
            f64::from(reference.velocity.forward()) - f64::from(wind.forward()),
        ];
        let w = [
            f64::from(p.mass) * (f64::from(p.gravity) - f64::from(reference.acceleration.down())),
            -f64::from(p.mass) * f64::from(reference.acceleration.forward()),
        ];
        let speed = v[0].hypot(v[1]);
        let e = [v[0] / speed, v[1] / speed];
        Self {
            along: w[0] * e[0] + w[1] * e[1],
            across: w[1] * e[0] - w[0] * e[1],
            pressure: f64::from(p.k_a) * speed * speed,
            delta: f64::from(p.delta),
        }
    }

    fn at(&self, model: &Aerodynamics, alpha: f64) -> f64 {
        let c = model.at(wrap(alpha));
        let (sin, cos) = (alpha + self.delta).sin_cos();
        self.along * sin - self.across * cos - self.pressure * (c.c_l * cos + c.c_d * sin)
    }

    fn slope(&self, model: &Aerodynamics, alpha: f64) -> f64 {
        let c = model.at(wrap(alpha));
        let (sin, cos) = (alpha + self.delta).sin_cos();
        let dq = (c.dc_l + c.c_d) * cos + (c.dc_d - c.c_l) * sin;
        self.along * cos + self.across * sin - self.pressure * dq
    }

    fn scale(&self, model: &Aerodynamics, alpha: f64) -> f64 {
        let c = model.at(wrap(alpha));
        self.along.hypot(self.across) + self.pressure * (c.c_l.abs() + c.c_d.abs())
    }

    /// Every zero, by increasing α.
    fn zeros(&self, scan: &Scan) -> Vec<f64> {
        let (sd, cd) = self.delta.sin_cos();
        let value = |&[s, c, c_l, c_d]: &[f64; 4]| {
            let (sin, cos) = (s * cd + c * sd, c * cd - s * sd);
            self.along * sin - self.across * cos - self.pressure * (c_l * cos + c_d * sin)
        };
        let values: Vec<f64> = scan.nodes.iter().map(value).collect();
        let refine = |mut low: f64, mut high: f64, rising: bool| {
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if (self.at(&scan.model, middle) < 0.0) == rising {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            wrap(0.5 * (low + high))
        };
        let mut zeros: Vec<f64> = (0..NODES)
            .filter(|&i| (values[i] < 0.0) != (values[(i + 1) % NODES] < 0.0))
            .map(|i| refine(alpha(i), alpha(i + 1), values[i] < 0.0))
            .collect();
        zeros.sort_by(f64::total_cmp);
        zeros
    }
}

fn model(rng: &mut ChaCha8Rng, n: usize) -> (Model, Aerodynamics) {
    let mut about = |x: f32| x * rng.random_range(0.7..1.3);
    match n % 5 {
        0 => {
            let p = LargeAngleParameters {
                c0: about(0.02),
                c1: about(0.95),
            };
            let reference = Aerodynamics::LargeAngle(reference::LargeAngle {
                c0: p.c0.into(),
                c1: p.c1.into(),
            });
            (Model::LargeAngle(LargeAngle::new(p).unwrap()), reference)
        }
        1 => {
            let p = SmallAngleParameters {
                c0: about(0.014),
                c2: about(5.5),
                c3: about(0.3),
            };
            let reference = Aerodynamics::SmallAngle(reference::SmallAngle {
                c0: p.c0.into(),
                c2: p.c2.into(),
                c3: p.c3.into(),
            });
            (Model::SmallAngle(SmallAngle::new(p).unwrap()), reference)
        }
        2 | 3 => {
            let sets = [
                CombinedParameters::NACA_0021_RE_160E3,
                CombinedParameters::NACA_0021_RE_5E6,
                CombinedParameters::PAPER_BELIEF,
            ];
            let p = sets[n / 5 % 3];
            // The first of each kind as it is in the paper.
            let mut vary = |x: f32| if n < 15 { x } else { about(x) };
            let mut varied = p;
            for row in 0..CombinedParameters::ROWS.len() {
                varied.set(row, vary(p.get(row)));
            }
            let p = varied;
            crate::common::combined(p)
        }
        _ => {
            let polar = Polar::load(BUILT_IN[n / 5 % 2].0).unwrap();
            (
                Model::Table(polar.core),
                Aerodynamics::Table(polar.reference),
            )
        }
    }
}

fn disc(rng: &mut ChaCha8Rng, radius: f32) -> Inertial {
    let angle = rng.random_range(-PI..PI);
    let r = radius * rng.random_range(0.0f32..1.0).sqrt();
    Inertial::new(r * angle.cos() as f32, r * angle.sin() as f32)
}

/// What became of the cases.
#[derive(Debug, Default)]
struct Tally {
    cases: usize,
    equilibria: usize,
    /// Members of pairs closer than [`PAIR`] that only the scan, or only the finder, has.
    missed_pairs: usize,
    extra_pairs: usize,
    /// The widest such pair \[rad\].
    widest: f64,
    /// Most equilibria at one reference.
    most: usize,
    /// Largest distance between finder and scan, over what roundings allow.
    farthest: f64,
}

fn check(scan: &Scan, core: Model, rng: &mut ChaCha8Rng, tally: &mut Tally) {
    let half = std::f32::consts::FRAC_PI_2;
    let p = VehicleParameters::PAPER
        .mass(rng.random_range(0.5..50.0))
        .k_a(10.0f32.powf(rng.random_range(-2.0..0.5)))
        .delta(if rng.random_bool(0.4) {
            0.0
        } else {
            rng.random_range(-half..half)
        })
        .gravity(9.81);
    // As fast as makes the air's force up to 30 times the weight, or 40 m/s.
    let fast = (30.0 * p.mass * p.gravity / p.k_a).sqrt().min(40.0);
    let reference = Reference {
        velocity: disc(rng, fast),
        acceleration: disc(rng, 12.0),
    };
    let wind = disc(rng, 0.3 * fast);
    let vehicle = Vehicle::new(p, core).unwrap();
    let equilibria = Equilibria::find(&vehicle, &reference, wind).unwrap();
    let balance = Balance::new(&p, &reference, wind);
    let zeros = balance.zeros(scan);

    tally.cases += 1;
    tally.equilibria += zeros.len();
    tally.most = tally.most.max(zeros.len());
    let apart = |a: f64, b: f64| wrap(a - b).abs();
    let tolerance = |alpha: f64| {
        let slope = balance.slope(&scan.model, alpha).abs();
        2e-6 + NOISE * balance.scale(&scan.model, alpha) / slope
    };
    let mut free: Vec<f64> = equilibria
        .as_slice()
        .iter()
        .map(|e| e.alpha.into())
        .collect();
    let mut missed = Vec::new();
    for &zero in &zeros {
        let near = |a: &f64| apart(*a, zero);
        let best = free.iter().copied().enumerate();
        match best.min_by(|a, b| near(&a.1).total_cmp(&near(&b.1))) {
            Some((i, a)) if near(&a) < tolerance(zero) => {
                tally.farthest = tally.farthest.max(near(&a) / tolerance(zero));
                free.swap_remove(i);
            }
            _ => missed.push(zero),
        }
    }
    // What is left belongs to a pair.
    let mut pair = |a: f64, among: &[f64]| {
        let width = among
            .iter()
            .filter(|b| **b != a)
            .map(|b| apart(a, *b))
            .fold(f64::INFINITY, f64::min);
        tally.widest = tally.widest.max(width);
        let at = format!("{p:?} {reference:?} {wind:?}");
        assert!(
            width < PAIR,
            "{:.4}° of {zeros:?} {equilibria:?} {:.4}° {at}",
            a.to_degrees(),
            width.to_degrees()
        );
    };
    for &zero in &missed {
        pair(zero, &zeros);
    }
    let all: Vec<f64> = equilibria
        .as_slice()
        .iter()
        .map(|e| e.alpha.into())
        .collect();
    for &extra in &free {
        pair(extra, &all);
    }
    tally.missed_pairs += missed.len();
    tally.extra_pairs += free.len();
}

#[test]
fn every_equilibrium_is_found_and_no_false_one() {
    let worker = |part: usize| {
        let mut tally = Tally::default();
        for n in (part..MODELS).step_by(2) {
            let mut rng = ChaCha8Rng::seed_from_u64(4000 + n as u64);
            let (core, reference) = model(&mut rng, n);
            let scan = Scan::new(reference);
            for _ in 0..CASES {
                check(&scan, core, &mut rng, &mut tally);
            }
        }
        tally
    };
    let tallies = std::thread::scope(|scope| {
        let threads = [0, 1].map(|part| scope.spawn(move || worker(part)));
        threads.map(|thread| thread.join().unwrap())
    });
    println!("{tallies:#?}");
    assert!(tallies.iter().map(|t| t.cases).sum::<usize>() >= 100_000);
    // The exception is one: rarer than 1 in 10 000.
    for t in tallies {
        assert!((t.missed_pairs + t.extra_pairs) * 10_000 < t.equilibria);
        assert!(t.most <= alula::planar::equilibrium::CAPACITY);
    }
}

/// Next to folds, on either side of them and at every distance: how wide a pair is when the finder misses it, or reports
/// one where there is none.
#[test]
fn only_pairs_closer_than_stated_are_missed_at_a_fold() {
    let p = VehicleParameters::PAPER;
    let (mut missed, mut extra, mut pairs) = (0.0f64, 0.0f64, 0);
    for n in [2, 7, 4, 9] {
        let (core, aerodynamics) = model(&mut ChaCha8Rng::seed_from_u64(1), n);
        let core = Vehicle::new(p, core).unwrap();
        let vehicle = crate::common::vehicles(0.0, (*core.model(), aerodynamics)).1;
        for epsilon in [0.0f64, 0.2, 0.6, 0.95] {
            for fold in Curve::new(&vehicle, epsilon).unwrap().folds() {
                for step in 0..200 {
                    let off = 10f64.powf(-8.0 + 0.05 * f64::from(step / 2));
                    let a = fold.a * (1.0 + off * f64::from(step % 2 * 2 - 1));
                    let speed = (a * vehicle.mass * vehicle.gravity / vehicle.k_a).sqrt();
                    let (sin, cos) = epsilon.sin_cos();
                    let reference = Reference {
                        velocity: Inertial::new((-speed * sin) as f32, (speed * cos) as f32),
                        acceleration: Inertial::ZERO,
                    };
                    // Of the reference as rounded.
                    let balance = Balance::new(&p, &reference, Inertial::ZERO);
                    let width = pair_at(&balance, &aerodynamics, fold.alpha);
                    let equilibria = Equilibria::find(&core, &reference, Inertial::ZERO).unwrap();
                    let near: Vec<f64> = equilibria
                        .as_slice()
                        .iter()
                        .map(|e| f64::from(e.alpha))
                        .filter(|alpha| (alpha - fold.alpha).abs() < WINDOW)
                        .collect();
                    match (width, &near[..]) {
                        (Some(_), [_, _]) => pairs += 1,
                        (Some(width), _) if width < WINDOW => missed = missed.max(width),
                        (None, [low, high]) => extra = extra.max(high - low),
                        _ => {}
                    }
                }
            }
        }
    }
    println!(
        "{pairs} pairs found; missed up to {:.4}°, false up to {:.4}°",
        missed.to_degrees(),
        extra.to_degrees()
    );
    assert!(pairs > 1000 && missed < PAIR && extra < PAIR);
}

/// How far from a fold its pairs are looked for \[rad\]: 0.3°, less than the distance to another fold.
const WINDOW: f64 = 0.3 * PI / 180.0;

/// Distance \[rad\] of the two zeros of F̄_2 about its extremum near `fold`, if they are within [`WINDOW`].
fn pair_at(balance: &Balance, model: &Aerodynamics, fold: f64) -> Option<f64> {
    let zero = |mut low: f64, mut high: f64, f: &dyn Fn(f64) -> f64| {
        let rising = f(low) < 0.0;
        if (f(high) < 0.0) == rising {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if (f(middle) < 0.0) == rising {
                &mut low
            } else {
                &mut high
            }) = middle;
        }
        Some(low)
    };
    let extremum = zero(fold - WINDOW, fold + WINDOW, &|x| balance.slope(model, x))?;
    let value = |x: f64| balance.at(model, x);
    let low = zero(extremum - WINDOW, extremum, &value)?;
    Some(zero(extremum, extremum + WINDOW, &value)? - low)
}

/// The models given to both sides are the same model.
#[test]
fn the_scan_has_the_cores_models() {
    for n in 0..15 {
        let (core, reference) = model(&mut ChaCha8Rng::seed_from_u64(1), n);
        for i in (0..NODES).step_by(97) {
            let a = alula::AngleOfAttack::from_radians(alpha(i) as f32);
            let (c, r) = (core.coefficients(a), reference.at(a.rad.into()));
            assert!((f64::from(c.c_l) - r.c_l).abs() < 5e-6);
            assert!((f64::from(c.c_d) - r.c_d).abs() < 5e-6);
        }
    }
}
