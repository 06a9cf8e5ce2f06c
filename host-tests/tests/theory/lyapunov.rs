//! The Lyapunov identity of the full law, and the two identities of the change of variable.

use std::f64::consts::PI;

use alula::planar::equivalency::ApparentForces;
use alula::planar::{Attitude, FeedForward, GainParameters};
use alula_sim::reference::{Gains, Inputs, Vector, Vehicle, full, rotation, wrap};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::common::{Point, combined, control, gains, inertial, vector, vehicles};
use crate::yardstick::{Angle, magnitudes};
use crate::{SETS, random_delta};

/// V = (m/2)|ṽ|² + (1 − F̄_p1/|F_p|)/k2.
fn lyapunov(vehicle: &Vehicle, gains: &Gains, inputs: &Inputs) -> f64 {
    let air = vehicle.air(inputs.velocity, inputs.wind, inputs.theta);
    let f_p = vehicle.f_p(&air, inputs.reference_acceleration);
    let along = f_p.dot(&rotation(inputs.theta).column(0));
    let error = inputs.velocity - inputs.reference_velocity;
    0.5 * vehicle.mass * error.norm_squared() + (1.0 - along / f_p.norm()) / gains.k2
}

/// V̇ along the plant: the derivative of V in the direction of ẋ, by central difference.
fn lyapunov_rate(
    vehicle: &Vehicle,
    gains: &Gains,
    inputs: &Inputs,
    jerk: Vector,
    (thrust, rate): (f64, f64),
) -> f64 {
    let acceleration = vehicle.acceleration(inputs.velocity, inputs.wind, inputs.theta, thrust);
    let at = |h: f64| {
        let displaced = Inputs {
            velocity: inputs.velocity + h * acceleration,
            theta: inputs.theta + h * rate,
            reference_velocity: inputs.reference_velocity + h * inputs.reference_acceleration,
            reference_acceleration: inputs.reference_acceleration + h * jerk,
            ..*inputs
        };
        lyapunov(vehicle, gains, &displaced)
    };
    // The angle turns by less than 1e-6 rad, over which no coefficient changes by more than 6e-5
    // of itself: the truncation error is the square of that.
    let h = 1e-6 / (1.0 + rate.abs());
    (at(h) - at(-h)) / (2.0 * h)
}

/// V̇ = −k1|F_p|ṽ_1² − (k3/k2) tan²(θ̃/2) under the core's full law with the true accelerations.
///
/// Tolerance: thrust enters V̇ by ṽ_1 and the rate by sin θ̃/(k2 k); each may be off by 3e-6 of the
/// magnitudes of its terms (see `accuracy.rs`). The difference quotient adds 1e-16·V/h and 1e-6 of
/// the result.
#[test]
fn the_full_law_makes_the_lyapunov_function_decrease_as_printed() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (core_gains, g) = gains(GainParameters::PAPER);
    let (mut checked, mut far_from_one, mut told_apart) = (0, 0, 0);
    for n in 0..40_000 {
        let delta = if n % 2 == 0 {
            0.0
        } else {
            random_delta(&mut rng)
        };
        let (core, vehicle) = vehicles(delta, combined(SETS[n / 2 % 2]));
        let core = control(core, core_gains);
        let mut point = Point::random(&mut rng);
        if rng.random_bool(0.5) {
            // In the stall region: |α| from 8° to 24°.
            let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            let alpha = sign * rng.random_range(0.14..0.42);
            let v_a = vector(point.state.velocity - point.state.wind);
            let theta = alpha + v_a.y.atan2(v_a.x) - PI + vehicle.delta;
            point.state.attitude = Attitude::from_angle(wrap(theta) as f32);
        }
        // Thrust does not depend on the feed-forward, and gives the true acceleration.
        let Ok(command) = core.full(&point.state, &point.reference, None) else {
            continue;
        };
        let i = point.inputs(false);
        let thrust = f64::from(command.thrust);
        let acceleration = vehicle.acceleration(i.velocity, i.wind, i.theta, thrust);
        point.feed_forward = FeedForward {
            air_acceleration: inertial(acceleration),
            ..point.feed_forward
        };
        let inputs = point.inputs(true);
        let evaluation = full(&vehicle, &g, &inputs);
        let theta_tilde = evaluation.theta_tilde(inputs.theta);
        let norm = evaluation.f_p.norm();
        // Where the difference quotient is sound (not at θ̃ = π, F_p = 0 or 1/k = 0), and the core
        // does not refuse the acceleration as absurd.
        if theta_tilde.abs() > 2.6
            || norm < 1.0
            || evaluation.k_inverse.abs() < 0.02
            || acceleration.norm() > 900.0
        {
            continue;
        }
        let command = core
            .full(&point.state, &point.reference, Some(&point.feed_forward))
            .unwrap();
        let error =
            rotation(inputs.theta).transpose() * (inputs.velocity - inputs.reference_velocity);
        let printed =
            -g.k1 * norm * error.x.powi(2) - g.k3 / g.k2 * (theta_tilde / 2.0).tan().powi(2);
        let commanded = (f64::from(command.thrust), f64::from(command.rate));
        let jerk = vector(point.feed_forward.jerk);
        let actual = lyapunov_rate(&vehicle, &g, &inputs, jerk, commanded);
        let size = magnitudes(&vehicle, &g, &inputs, &evaluation, true, Angle::Given);
        let by_rate = theta_tilde.sin().abs() / g.k2 * evaluation.k_inverse.abs();
        let tolerance = 3e-6 * (error.x.abs() * size.thrust + by_rate * size.rate)
            + 1e-7 * (1.0 + commanded.1.abs())
            + 1e-6 * printed.abs();
        assert!(
            (actual - printed).abs() < tolerance,
            "{actual} is not {printed} within {tolerance}: k = {}, {point:?}",
            command.diagnostics.k
        );
        checked += 1;
        let k = f64::from(command.diagnostics.k);
        if (k - 1.0).abs() > 0.5 {
            far_from_one += 1;
            // The tolerance must tell this law from the one without k.
            let without = (commanded.0, commanded.1 / k);
            let wrong = lyapunov_rate(&vehicle, &g, &inputs, jerk, without);
            told_apart += usize::from((wrong - printed).abs() > tolerance);
        }
    }
    println!("{checked} states, {far_from_one} with |k − 1| > 0.5, {told_apart} told apart");
    assert!(checked > 20_000 && far_from_one > 4_000 && told_apart > far_from_one * 19 / 20);
}

/// e2ᵀRᵀ∂_α f_p = 0 and ∂_θ(e2ᵀRᵀF) = −e1ᵀRᵀF_p: derivatives numerically in double precision, F_p
/// by the core. A step of 1e-5 rad truncates at 1e-10·c‴/6, 2e-6 of the forces at most.
#[test]
fn the_identities_of_the_change_of_variable_hold() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for n in 0..20_000 {
        let (core, vehicle) = vehicles(random_delta(&mut rng), combined(SETS[n % 2]));
        let point = Point::random(&mut rng);
        let i = point.inputs(false);
        let h = 1e-5;
        let forces = |theta: f64| {
            let air = vehicle.air(i.velocity, i.wind, theta);
            let a_r = i.reference_acceleration;
            (vehicle.f(&air, a_r), vehicle.f_p(&air, a_r))
        };
        let ((f_up, f_p_up), (f_down, f_p_down)) = (forces(i.theta + h), forces(i.theta - h));
        let q = vehicle.k_a * (i.velocity - i.wind).norm_squared();
        let size = vehicle.mass * vehicle.gravity + 10.0 * q;

        // f_p may vary strongly with α, only not along j.
        let variation = (f_p_up - f_p_down) / (2.0 * h);
        let along = variation.dot(&rotation(i.theta).column(1)).abs();
        assert!(
            along < 1e-5 * (size + variation.norm()),
            "{along} of {variation:?}"
        );

        let core = ApparentForces::new(
            &core,
            point.state.attitude,
            point.state.velocity - point.state.wind,
            point.reference.acceleration,
        );
        let along_j = |f: Vector, theta: f64| f.dot(&rotation(theta).column(1));
        let slope = (along_j(f_up, i.theta + h) - along_j(f_down, i.theta - h)) / (2.0 * h);
        let difference = (slope + f64::from(core.f_p.i())).abs();
        assert!(difference < 1e-5 * size, "{slope} {:?}", core.f_p);
    }
}
