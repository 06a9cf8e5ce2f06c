//! Accuracy of the f32 core against the f64 reference, over 1.2 million random states.
//!
//! Both are given the same inputs and parameters: the reference the core's f32 values. Errors of
//! thrust and angular rate are divided by the sum of the magnitudes of the terms that make them up,
//! as `yardstick::magnitudes` defines it. The figures are printed with `--nocapture`.

use std::f64::consts::PI;

use crate::common::{Point, combined, control, disc, gains, vehicles};
use crate::random_delta;
use crate::yardstick::{Angle, magnitudes};
use alula::planar::{Attitude, GainParameters};
use alula::{CombinedParameters, Fault};
use alula_sim::reference::{self, full, robust, wrap};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// States per cell of (parameter set, thrust line, subset).
const STATES: usize = 100_000;

/// Largest error allowed with [`Angle::Expanded`], everywhere: 34 roundings. Measured: 9.6e-7.
const EXPANDED: f64 = 2e-6;

/// Largest errors allowed away from θ̃ = π with [`Angle::Given`]. That yardstick leaves out that α
/// comes from sums that cancel where the thrust line is tilted; the error of 1e-7 rad is multiplied
/// by c_L′ in thrust and, near stall, by c_D″ (up to 60) in |F_p|, which no f32 computation of α
/// avoids. Measured: 1.2e-6 in thrust, 1.9e-6 in the robust law's rate and 2.5e-6 in the full law's;
/// all below 1.4e-6 at δ = 0.
const GIVEN: [f64; 3] = [2e-6, 3e-6, 3e-6];

/// How close to θ̃ = π \[rad\] a state may be for [`GIVEN`].
const NEAR_OPPOSITE: f64 = 0.1;

#[derive(Clone, Copy, Debug)]
enum Subset {
    /// |v| ≤ 40 m/s, every θ, wind.
    Random,
    /// |v_a| from 3 m/s down to 1e-20 m/s and to 0.
    SlowAir,
    /// θ̃ within 0.35 rad of π, down to 1e-6 rad.
    Opposite,
}

/// Maximum and mean square.
#[derive(Clone, Copy, Default)]
struct Errors {
    max: f64,
    sum: f64,
    n: f64,
}

impl Errors {
    fn add(&mut self, error: f64) {
        // NaN must not pass for small.
        assert!(error.is_finite());
        self.max = self.max.max(error);
        self.sum += error * error;
        self.n += 1.0;
    }

    fn rms(&self) -> f64 {
        (self.sum / self.n).sqrt()
    }
}

/// The errors of thrust, of the robust law's rate (with and without feed-forward) and of the full
/// law's rate (with feed-forward).
type Cell = [Errors; 3];

fn sample(rng: &mut ChaCha8Rng, subset: Subset, vehicle: &reference::Vehicle) -> Option<Point> {
    let mut point = Point::random(rng);
    match subset {
        Subset::Random => Some(point),
        Subset::SlowAir => {
            let speed = 10.0_f32.powf(rng.random_range(-20.0..0.5));
            point.state.wind = point.state.velocity;
            if rng.random_bool(0.99) {
                point.state.wind = point.state.velocity - disc(rng, speed);
            }
            Some(point)
        }
        Subset::Opposite => {
            // F_p depends on θ: turn until θ̃ is what is wanted.
            let away = 10.0_f64.powf(rng.random_range(-6.0..-0.5));
            let wanted = if rng.random_bool(0.5) {
                PI - away
            } else {
                away - PI
            };
            let unit = reference::Gains {
                k1: 1.0,
                k2: 1.0,
                k3: 1.0,
                tau: 1.0,
            };
            let theta_tilde = |point: &Point| {
                let inputs = point.inputs(false);
                robust(vehicle, &unit, &inputs).theta_tilde(inputs.theta)
            };
            for _ in 0..30 {
                let theta =
                    crate::common::theta(point.state.attitude) + theta_tilde(&point) - wanted;
                point.state.attitude = Attitude::from_angle(wrap(theta) as f32);
            }
            (wrap(theta_tilde(&point) - PI).abs() < 0.35).then_some(point)
        }
    }
}

fn measure(set: CombinedParameters, tilted: bool, subset: Subset) -> (Cell, Cell) {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let (core_gains, reference_gains) = gains(GainParameters::PAPER);
    let (mut expanded, mut given) = (Cell::default(), Cell::default());
    for _ in 0..STATES {
        let delta = if tilted { random_delta(&mut rng) } else { 0.0 };
        let (core, vehicle) = vehicles(delta, combined(set));
        let core = control(core, core_gains);
        let Some(point) = sample(&mut rng, subset, &vehicle) else {
            continue;
        };

        for (is_full, forward) in [(false, false), (false, true), (true, true)] {
            let inputs = point.inputs(forward);
            let feed_forward = forward.then_some(&point.feed_forward);
            let (got, want) = if is_full {
                (
                    core.full(&point.state, &point.reference, feed_forward),
                    full(&vehicle, &reference_gains, &inputs),
                )
            } else {
                (
                    core.robust(&point.state, &point.reference, feed_forward),
                    robust(&vehicle, &reference_gains, &inputs),
                )
            };
            let got = match got {
                Ok(got) => got,
                // The core refuses rates beyond 1e9 rad/s.
                Err(Fault::Undefined) if is_full && want.rate.abs() > 0.99e9 => continue,
                Err(fault) => panic!("{fault} at {point:?}"),
            };
            let near_opposite = wrap(want.theta_tilde(inputs.theta) - PI).abs() < NEAR_OPPOSITE;
            for (angle, cell) in [(Angle::Expanded, &mut expanded), (Angle::Given, &mut given)] {
                if angle == Angle::Given && near_opposite {
                    continue;
                }
                let size = magnitudes(&vehicle, &reference_gains, &inputs, &want, is_full, angle);
                cell[0].add((f64::from(got.thrust) - want.thrust).abs() / size.thrust);
                cell[1 + usize::from(is_full)]
                    .add((f64::from(got.rate) - want.rate).abs() / size.rate);
            }
        }
    }
    (expanded, given)
}

#[test]
fn thrust_and_rate_are_accurate_everywhere() {
    let sets = [
        ("Re 160e3", CombinedParameters::NACA_0021_RE_160E3),
        ("Re 5e6", CombinedParameters::NACA_0021_RE_5E6),
    ];
    let subsets = [Subset::Random, Subset::SlowAir, Subset::Opposite];
    let cells: Vec<_> = sets
        .into_iter()
        .flat_map(|set| [false, true].map(|tilted| (set, tilted)))
        .flat_map(|(set, tilted)| subsets.map(|subset| (set, tilted, subset)))
        .collect();
    let measured: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = cells
            .iter()
            .map(|&((_, set), tilted, subset)| scope.spawn(move || measure(set, tilted, subset)))
            .collect();
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    });

    // The robust law is evaluated twice per state.
    let states: f64 = measured.iter().map(|(e, _)| e[1].n / 2.0).sum();
    assert!(states > 1e6, "{states}");
    println!(
        "{states} states; maximum and RMS of the scaled error: thrust, rate (robust), rate (full)"
    );
    for (((name, _), tilted, subset), (expanded, given)) in cells.iter().zip(&measured) {
        let delta = if *tilted { "every δ" } else { "δ = 0" };
        for (angle, cell) in [("", expanded), ("α given", given)] {
            print!("{name:8} {delta:8} {:9} {angle:8}", format!("{subset:?}"));
            for errors in cell {
                print!("  {:.2e} {:.1e}", errors.max, errors.rms());
            }
            println!();
        }
        for (i, bound) in GIVEN.into_iter().enumerate() {
            assert!(expanded[i].n.min(given[i].n) > 0.05 * STATES as f64);
            assert!(
                expanded[i].max < EXPANDED,
                "{name} {delta} {subset:?}: column {i}"
            );
            assert!(
                given[i].max < bound,
                "{name} {delta} {subset:?}: column {i}, α given"
            );
        }
    }
}
