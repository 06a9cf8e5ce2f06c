//! Theorem 3 at computed equilibria, and Theorem 1's number of them.

use std::f64::consts::PI;

use alula::planar::{Attitude, GainParameters};
use alula_sim::reference::{Inputs, Vehicle, rotation};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::common::{Point, combined, control, gains, vehicles};
use crate::{SETS, random_delta};

/// Orientations with F·j = 0 at v = v_r, by scan and bisection in double precision.
fn equilibria(vehicle: &Vehicle, inputs: &Inputs) -> Vec<f64> {
    let normal = |theta: f64| {
        let air = vehicle.air(inputs.reference_velocity, inputs.wind, theta);
        let f = vehicle.f(&air, inputs.reference_acceleration);
        f.dot(&rotation(theta).column(1))
    };
    let steps = 720;
    let at = |i: i32| -PI + 2.0 * PI * f64::from(i) / f64::from(steps);
    let mut zeros = Vec::new();
    for i in 0..steps {
        let (mut low, mut high) = (at(i), at(i + 1));
        if normal(low) * normal(high) > 0.0 {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if normal(low) * normal(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        zeros.push(0.5 * (low + high));
    }
    zeros
}

/// Theorem 3 i): at an equilibrium with |F_p| > 0 the direction of F_p does not change with θ, so
/// that θ̃ is 0 or π and the core's k is 1 there. Theorem 1: at δ = 0 there are at least two.
#[test]
fn the_direction_of_f_p_is_stationary_at_equilibria() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (core_gains, _) = gains(GainParameters::PAPER);
    let (mut checked, mut elsewhere) = (0, 0.0_f64);
    for n in 0..4_000 {
        let delta = if n % 2 == 0 {
            0.0
        } else {
            random_delta(&mut rng)
        };
        let (core, vehicle) = vehicles(delta, combined(SETS[n / 2 % 2]));
        let core = control(core, core_gains);
        let mut point = Point::random(&mut rng);
        point.state.velocity = point.reference.velocity;
        let inputs = point.inputs(false);
        let zeros = equilibria(&vehicle, &inputs);
        assert!(delta != 0.0 || zeros.len() >= 2, "{point:?}");

        let f_p = |theta: f64| {
            let air = vehicle.air(inputs.velocity, inputs.wind, theta);
            vehicle.f_p(&air, inputs.reference_acceleration)
        };
        // |∂_θ(F_p/|F_p|)|.
        let turn = |theta: f64| {
            let h = 1e-6;
            (f_p(theta + h).normalize() - f_p(theta - h).normalize()).norm() / (2.0 * h)
        };
        elsewhere = elsewhere.max(turn(inputs.theta));
        let q = vehicle.k_a * (inputs.velocity - inputs.wind).norm_squared();
        for theta in zeros {
            let norm = f_p(theta).norm();
            if norm < 5.0 {
                continue;
            }
            // How much larger than F_p the forces are that make it up.
            let ill = 1.0 + 10.0 * q / norm;
            // Roundings of 1e-16 of these over a step of 1e-6, and the truncation.
            let tolerance = ill * (1e-9 + 1e-12 * 60.0_f64.powi(3) / 6.0);
            assert!(turn(theta) < tolerance, "{} {tolerance}", turn(theta));

            point.state.attitude = Attitude::from_angle(theta as f32);
            let Ok(command) = core.full(&point.state, &point.reference, None) else {
                continue; // θ̃ is π to the bit, where the full law is undefined.
            };
            let d = command.diagnostics;
            // In single precision F̄_2 is zero to 1e-6 of the forces. 1/k − 1 is F̄_2/|F_p| times
            // q/|F_p| times derivatives of up to 60 1/rad.
            let off = 1e-6 * ill;
            let sin = f64::from(d.theta_tilde().sin().abs());
            assert!(sin < off, "{sin} {off}");
            let k = f64::from(d.k);
            assert!((1.0 / k - 1.0).abs() < 6.0 * ill * off + 1e-6, "{k} {ill}");
            checked += 1;
        }
    }
    println!("{checked} equilibria; elsewhere F_p turns by up to {elsewhere:.0} rad/rad");
    assert!(checked > 4_000 && elsewhere > 1.0);
}
