//! Accuracy of the core's laws in space against the double-precision reference, over a million random states.
//!
//! Both are given the same inputs and parameters: the reference the core's f32 values, quaternion included. Errors are
//! divided by N of `yardstick::Number`, which counts every rounding to first order. The figures are printed
//! with `--nocapture`.

use alula::BodyRates;
use alula::planar::GainParameters;
use alula::spatial::WingedControl;
use alula::spatial::axisymmetric::AxisymmetricControl;
use alula::{CombinedParameters, Fault};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::support::{C_Y, Point, ball, lateral};
use crate::common::{combined, gains, vehicles};
use crate::random_delta;
use crate::yardstick::{
    Number, SpatialEvaluation, axisymmetric_full, axisymmetric_robust, winged_full, winged_robust,
};

/// States per cell of (parameter set, thrust line, subset).
const STATES: usize = 100_000;

/// Largest errors allowed of thrust, ω_i, ω_j and ω_w, everywhere: about twice what is measured, 2.9e-7, 6.3e-8,
/// 8.3e-8 and 7.8e-7 (RMS 1e-8), where one rounding is 6e-8. Products of three and more count each factor once more in
/// N than they lose, so that the means are far below one rounding.
const BOUND: [f64; 4] = [6e-7, 1.5e-7, 1.5e-7, 1.5e-6];

/// Largest absolute RMS errors allowed of the robust law in random states, of thrust \[N\] and rates \[rad/s\]. Measured
/// 3.4e-4, 8.8e-7, 8.7e-7 and 1.4e-4: at 40 m/s and any angle of attack thrust is thousands of newtons and ω_w, with the
/// paper's gains, hundreds of radians per second.
const ABSOLUTE: [f64; 4] = [1e-3, 3e-6, 3e-6, 5e-4];

#[derive(Clone, Copy, Debug)]
enum Subset {
    /// |v| ≤ 40 m/s, every attitude, wind.
    Random,
    /// |v_a| from 3 m/s down to 1e-20 m/s and to 0.
    SlowAir,
    /// |F_y| from 100 N down to 1e-6 N.
    SmallForce,
}

const SUBSETS: [Subset; 3] = [Subset::Random, Subset::SlowAir, Subset::SmallForce];

/// Maximum and mean square of the errors of thrust, ω_i, ω_j and ω_w.
#[derive(Clone, Copy, Default)]
struct Cell {
    max: [f64; 4],
    sum: [f64; 4],
    absolute: [f64; 4],
    n: f64,
}

impl Cell {
    fn add(&mut self, thrust: f32, rates: BodyRates, want: &SpatialEvaluation) {
        let [i, j, w] = want.rates;
        let pairs = [
            (thrust, want.thrust),
            (-rates.roll, i),
            (rates.yaw, j),
            (rates.pitch, w),
        ];
        for (n, (got, Number { value, size })) in pairs.into_iter().enumerate() {
            let difference = (f64::from(got) - value).abs();
            let error = if difference == 0.0 {
                0.0
            } else {
                difference / size
            };
            // NaN must not pass for small.
            assert!(error.is_finite());
            self.max[n] = self.max[n].max(error);
            self.sum[n] += error * error;
            self.absolute[n] += difference * difference;
        }
        self.n += 1.0;
    }

    /// Prints the cell, and holds it to [`BOUND`].
    fn report(&self, name: &str) {
        print!("{name:44} {:7}", self.n);
        let rms = |sum: f64| (sum / self.n).sqrt();
        for n in 0..4 {
            let (of_n, absolute) = (rms(self.sum[n]), rms(self.absolute[n]));
            print!("  {:.2e} {of_n:.1e} {absolute:.1e}", self.max[n]);
        }
        println!();
        for (max, bound) in self.max.into_iter().zip(BOUND) {
            assert!(max < bound, "{name}");
        }
    }
}

fn sample(rng: &mut ChaCha8Rng, subset: Subset, mass: f64, side: f64, gravity: f64) -> Point {
    let mut point = Point::random(rng);
    match subset {
        Subset::Random => {}
        Subset::SlowAir => {
            let speed = 10.0_f32.powf(rng.random_range(-20.0..0.5));
            point.wind = point.velocity;
            if rng.random_bool(0.99) {
                point.wind = point.velocity - ball(rng, speed);
            }
        }
        Subset::SmallForce => {
            // a_r that leaves a small W − side |v_a| v_a, up to the push and the correction.
            let v_a = point.velocity - point.wind;
            let drag = (side / mass) as f32 * v_a.norm_squared().sqrt();
            let small = 10.0_f32.powf(rng.random_range(-6.0..2.0));
            point.reference.acceleration = v_a * -drag + ball(rng, small * (1.0 / mass) as f32);
            point.reference.acceleration.down += gravity as f32;
            point.force = ball(rng, small);
        }
    }
    point
}

/// The winged laws: robust without and with feed-forward, full with it.
fn measure(set: CombinedParameters, tilted: bool, subset: Subset) -> [Cell; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (core_gains, g) = gains(GainParameters::PAPER);
    let (core_lateral, l) = lateral();
    let mut cells = [Cell::default(); 3];
    for _ in 0..STATES {
        let delta = if tilted { random_delta(&mut rng) } else { 0.0 };
        let (core, vehicle) = vehicles(delta, combined(set));
        let core = WingedControl::new(core, core_gains, core_lateral);
        let c_y = f64::from(C_Y);
        let side = vehicle.k_a * c_y;
        let point = sample(&mut rng, subset, vehicle.mass, side, vehicle.gravity);
        let (state, ff) = (point.state(), point.feed_forward);
        for (n, forward) in [(0, None), (1, Some(&ff)), (2, Some(&ff))] {
            let inputs = point.inputs(forward.is_some());
            let (got, want) = if n == 2 {
                (
                    core.full(&state, &point.reference, forward),
                    winged_full(&vehicle, c_y, &g, &l, &inputs),
                )
            } else {
                (
                    core.robust(&state, &point.reference, forward),
                    winged_robust(&vehicle, c_y, &g, &l, &inputs),
                )
            };
            match got {
                Ok(got) => {
                    // First order says nothing where 1/k all but vanishes.
                    if n < 2 || want.k_inverse.abs() > 1e-3 {
                        cells[n].add(got.thrust, got.rates, &want);
                    }
                }
                Err(Fault::Undefined) if n == 2 => {}
                Err(fault) => panic!("{fault} at {point:?}"),
            }
        }
    }
    cells
}

#[test]
fn the_law_of_the_winged_vehicle_is_accurate_everywhere() {
    let sets = [
        ("Re 160e3", CombinedParameters::NACA_0021_RE_160E3),
        ("Re 5e6", CombinedParameters::NACA_0021_RE_5E6),
    ];
    let mut evaluated = 0.0;
    println!("maximum and RMS of error/N, RMS of the error [N, rad/s]: thrust, ω_i, ω_j, ω_w");
    for (name, set) in sets {
        for tilted in [false, true] {
            let cells: Vec<_> = std::thread::scope(|scope| {
                let run = |subset| scope.spawn(move || measure(set, tilted, subset));
                let threads = SUBSETS.map(run);
                threads.into_iter().map(|t| t.join().unwrap()).collect()
            });
            for (subset, cells) in SUBSETS.into_iter().zip(cells) {
                let delta = if tilted { "every δ" } else { "δ = 0" };
                let laws = ["robust", "robust, fed", "full, fed"];
                for (law, cell) in laws.into_iter().zip(cells) {
                    let name = format!("{name} {delta} {subset:?} {law}");
                    cell.report(&name);
                    assert!(cell.n > 0.5 * STATES as f64, "{name}");
                    if matches!(subset, Subset::Random) && law != "full, fed" {
                        for (sum, bound) in cell.absolute.into_iter().zip(ABSOLUTE) {
                            assert!((sum / cell.n).sqrt() < bound, "{name}");
                        }
                    }
                }
                evaluated += cells[1].n;
            }
        }
    }
    assert!(evaluated > 1e6);
}

#[test]
fn the_law_of_the_axisymmetric_vehicle_is_accurate() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let (core_gains, g) = gains(GainParameters::PAPER);
    let set = CombinedParameters::NACA_0021_RE_160E3;
    let (core, vehicle) = vehicles(0.0, combined(set));
    let core = AxisymmetricControl::new(core, core_gains, 5.0, 0.2).unwrap();
    let mut cells = [Cell::default(); 3];
    for n in 0..2 * STATES {
        let subset = SUBSETS[n % 2];
        let mut point = sample(&mut rng, subset, vehicle.mass, 0.0, vehicle.gravity);
        // The heading is no part of the reference, nor is ω_i.
        point.reference.heading = alula::spatial::Heading::FREE;
        point.sideslip = 0.0;
        let (state, ff) = (point.state(), point.feed_forward);
        let alpha_sine = |d: &alula::spatial::Diagnostics| f64::from(d.plane.alpha).sin();
        for (k, forward) in [(0, None), (1, Some(&ff)), (2, Some(&ff))] {
            let inputs = point.inputs(forward.is_some());
            let (got, want) = if k == 2 {
                (
                    core.full(&state, &point.reference, forward),
                    axisymmetric_full(&vehicle, &g, &inputs),
                )
            } else {
                (
                    core.robust(&state, &point.reference, forward),
                    axisymmetric_robust(&vehicle, &g, &inputs),
                )
            };
            match got {
                // The full law needs b′/sin α, which it is documented not to know close to the axis.
                Ok(got)
                    if k < 2
                        || (alpha_sine(&got.diagnostics) > 0.1 && want.k_inverse.abs() > 1e-3) =>
                {
                    cells[k].add(got.thrust, got.rates, &want);
                }
                Ok(_) => {}
                Err(Fault::Undefined) if k == 2 => {}
                Err(fault) => panic!("{fault} at {point:?}"),
            }
        }
    }
    for (law, cell) in ["robust", "robust, fed", "full, fed"]
        .into_iter()
        .zip(cells)
    {
        cell.report(&format!("axisymmetric {law}"));
        assert!(cell.n > 0.5 * STATES as f64);
    }
}
