//! What is proved of the laws in space, by finite differences in double precision.

use alula::CombinedParameters;
use alula::planar::GainParameters;
use alula_sim::reference::{ForceModel, Gains, Vehicle};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::support::{C_Y, Point, lateral};
use crate::common::{combined, gains, vehicles};
use crate::yardstick::{
    SpatialEvaluation, SpatialInputs, axes, axisymmetric_full, winged_full, winged_robust,
};

type V3 = Vector3<f64>;

const E3: V3 = V3::new(0.0, 0.0, 1.0);

/// F_a \[N\] of the plant's own model, world components.
fn aerodynamic_force(vehicle: &Vehicle, v_a: V3, attitude: &UnitQuaternion<f64>) -> V3 {
    let v = attitude.inverse_transform_vector(&v_a);
    let [i, j, w] = ForceModel::new(vehicle, C_Y.into()).force([v.z, v.x, v.y]);
    attitude * V3::new(j, w, i)
}

fn attitude([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// (i, j, w).
fn body(inputs: &SpatialInputs) -> [V3; 3] {
    axes(inputs.quaternion).map(|a| V3::from(a.values()))
}

/// The inputs `h` \[s\] later, with this acceleration, jerk and these rates (ω_i, ω_j, ω_w); wind is steady.
fn displaced(inputs: &SpatialInputs, a: V3, jerk: V3, rates: [f64; 3], h: f64) -> SpatialInputs {
    let [w, x, y, z] = inputs.quaternion;
    let q = Quaternion::new(w, x, y, z);
    let [r_i, r_j, r_w] = rates;
    let q = q + q * Quaternion::from_imag(V3::new(r_j, r_w, r_i)) * (0.5 * h);
    let add = |x: [f64; 3], by: V3| (V3::from(x) + h * by).into();
    SpatialInputs {
        velocity: add(inputs.velocity, a),
        quaternion: [q.w, q.i, q.j, q.k],
        reference_velocity: add(
            inputs.reference_velocity,
            inputs.reference_acceleration.into(),
        ),
        reference_acceleration: add(inputs.reference_acceleration, jerk),
        ..*inputs
    }
}

/// V = (m/2)|ṽ|² + (1 − F̄_p1/|F_p|)/k2.
fn lyapunov(vehicle: &Vehicle, gains: &Gains, inputs: &SpatialInputs, f_p: [f64; 3]) -> f64 {
    let error = V3::from(inputs.velocity) - V3::from(inputs.reference_velocity);
    let f_p = V3::from(f_p);
    0.5 * vehicle.mass * error.norm_squared() + (1.0 - f_p.x / f_p.norm()) / gains.k2
}

struct Checked {
    states: usize,
    /// Where the tolerance tells the law from one with k ≡ 1.
    told_apart: usize,
    /// |k − 1| > 0.5.
    far_from_one: usize,
}

/// V̇ under `law` against −k1|F_p|ṽ_1² − (k3/k2) tan²(θ̃/2), for states from `draw` and forces from `force`.
///
/// The difference quotient adds 1e-16 V/h, and 1e-6 of the result by truncation.
fn check(
    vehicle: &Vehicle,
    g: &Gains,
    mut draw: impl FnMut() -> SpatialInputs,
    force: impl Fn(&SpatialInputs) -> V3,
    law: impl Fn(&SpatialInputs) -> SpatialEvaluation,
) -> Checked {
    let (mut states, mut told_apart, mut far_from_one) = (0, 0, 0);
    for _ in 0..40_000 {
        let mut inputs = draw();
        let jerk = V3::from(inputs.feed_forward.unwrap().1);
        // Thrust does not depend on the feed-forward, and gives the true acceleration.
        let thrust = law(&inputs).thrust.value;
        let [i, j, w] = body(&inputs);
        let a = vehicle.gravity * E3 + (force(&inputs) - thrust * i) / vehicle.mass;
        inputs.feed_forward = Some((a.into(), jerk.into()));
        let step = law(&inputs);
        let f_p = V3::from(step.f_p);
        let theta_tilde = f_p.yz().norm().atan2(f_p.x);
        if theta_tilde > 2.6 || f_p.norm() < 1.0 || step.k_inverse.abs() < 0.02 {
            continue;
        }
        let error = V3::from(inputs.velocity) - V3::from(inputs.reference_velocity);
        let printed = -g.k1 * f_p.norm() * error.dot(&i).powi(2)
            - g.k3 / g.k2 * (0.5 * theta_tilde).tan().powi(2);
        let rates = step.rates.map(|r| r.value);
        let speed = rates.iter().map(|r| r * r).sum::<f64>().sqrt();
        let h = 1e-6 / (1.0 + speed);
        let slope = |rates: [f64; 3]| {
            let at = |h: f64| {
                let inputs = displaced(&inputs, a, jerk, rates, h);
                lyapunov(vehicle, g, &inputs, law(&inputs).f_p)
            };
            (at(h) - at(-h)) / (2.0 * h)
        };
        let actual = slope(rates);
        let value = lyapunov(vehicle, g, &inputs, step.f_p);
        let tolerance = 1e-14 * value / h + 1e-6 * (printed.abs() + 1.0 + speed);
        assert!(
            (actual - printed).abs() < tolerance,
            "{actual} is not {printed} within {tolerance}, 1/k = {}: {inputs:?} {j} {w}",
            step.k_inverse
        );
        states += 1;
        if (1.0 / step.k_inverse - 1.0).abs() > 0.5 {
            far_from_one += 1;
            let wrong = slope([rates[0], rates[1], rates[2] * step.k_inverse]);
            told_apart += usize::from((wrong - printed).abs() > tolerance);
        }
    }
    println!("{states} states, {far_from_one} with |k − 1| > 0.5, {told_apart} told apart");
    Checked {
        states,
        told_apart,
        far_from_one,
    }
}

/// Winged, with v_a, W and ṽ normal to the wing: whatever jerk and acceleration are across.
#[test]
fn the_lyapunov_identity_holds_in_every_plane_of_flight() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let (_, g) = gains(GainParameters::PAPER);
    let (_, l) = lateral();
    for delta in [0.0, 0.3] {
        let (_, vehicle) = vehicles(delta, combined(CombinedParameters::NACA_0021_RE_160E3));
        let draw = || {
            let mut inputs = Point::random(&mut rng).inputs(true);
            let [i, j, w] = body(&inputs);
            let flat = |v: [f64; 3]| V3::from(v) - V3::from(v).dot(&w) * w;
            let mut v_a = flat(inputs.velocity) - flat(inputs.wind);
            if rng.random_bool(0.5) {
                // In the stall region: |α| from 8° to 24°.
                let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
                let angle: f64 = sign * rng.random_range(0.14..0.42) + vehicle.delta;
                v_a = v_a.norm() * (angle.sin() * j - angle.cos() * i);
            }
            let error = flat(inputs.velocity) - flat(inputs.reference_velocity);
            let a_r = flat(inputs.reference_acceleration);
            let (force, weight_w) = (flat(inputs.force), vehicle.gravity * E3.dot(&w));
            let velocity = V3::from(inputs.wind) + v_a;
            inputs.velocity = velocity.into();
            inputs.reference_velocity = (velocity - error).into();
            inputs.reference_acceleration = (a_r + weight_w * w).into();
            // A force that the true vehicle has not is no part of the identity.
            inputs.force = (0.0 * force).into();
            inputs.sideslip = 0.0;
            inputs
        };
        let checked = check(
            &vehicle,
            &g,
            draw,
            |i| {
                let v_a = V3::from(i.velocity) - V3::from(i.wind);
                aerodynamic_force(&vehicle, v_a, &attitude(i.quaternion))
            },
            |i| winged_full(&vehicle, C_Y.into(), &g, &l, i),
        );
        assert!(checked.states > 15_000 && checked.far_from_one > 2_000);
        assert!(checked.told_apart > checked.far_from_one * 19 / 20);
    }
}

/// Axisymmetric, in three dimensions, everywhere.
#[test]
fn the_lyapunov_identity_of_the_axisymmetric_law_holds() {
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    let (_, g) = gains(GainParameters::PAPER);
    let (_, vehicle) = vehicles(0.0, combined(CombinedParameters::NACA_0021_RE_160E3));
    let draw = || {
        let mut inputs = Point::random(&mut rng).inputs(true);
        if rng.random_bool(0.5) {
            // In the stall region, in any direction about the axis.
            let [i, j, w] = body(&inputs);
            let speed = (V3::from(inputs.velocity) - V3::from(inputs.wind)).norm();
            let (alpha, roll): (f64, f64) =
                (rng.random_range(0.14..0.42), rng.random_range(-3.1..3.1));
            let out = alpha.sin() * (roll.cos() * j + roll.sin() * w);
            let error = V3::from(inputs.velocity) - V3::from(inputs.reference_velocity);
            let velocity = V3::from(inputs.wind) + speed * (out - alpha.cos() * i);
            inputs.velocity = velocity.into();
            inputs.reference_velocity = (velocity - error).into();
        }
        inputs.force = [0.0; 3];
        inputs
    };
    let force = |inputs: &SpatialInputs| {
        let v_a = V3::from(inputs.velocity) - V3::from(inputs.wind);
        let [i, ..] = body(inputs);
        let speed = v_a.norm();
        let alpha = (-v_a.dot(&i) / speed).acos();
        let c = vehicle.aerodynamics.at(alpha);
        -vehicle.k_a * speed.powi(2) * c.c_l / alpha.sin() * i
            - vehicle.k_a * (c.c_d + c.c_l / alpha.tan()) * speed * v_a
    };
    let checked = check(&vehicle, &g, draw, force, |i| {
        axisymmetric_full(&vehicle, &g, i)
    });
    assert!(checked.states > 20_000 && checked.far_from_one > 1_000);
    assert!(checked.told_apart > checked.far_from_one * 19 / 20);
}

/// Winged, with true a and j_r: x = w·(W − k_a c_Y|v_a|v_a) obeys, at ṽ_w = 0 and |F_y| > τ_y,
/// ẋ = −k_F x (1 − x²/|F_y|²) + Ḟ_w x²/|F_y|²; and where x = 0 and w·v_a = 0, with s = 1, both stay.
#[test]
fn tilt_decays_as_stated_and_coordination_is_invariant() {
    let mut rng = ChaCha8Rng::seed_from_u64(33);
    let (_, g) = gains(GainParameters::PAPER);
    let (_, l) = lateral();
    let (_, vehicle) = vehicles(0.0, combined(CombinedParameters::NACA_0021_RE_160E3));
    let side = vehicle.k_a * f64::from(C_Y);
    let (mut tilted, mut coordinated) = (0, 0);
    for n in 0..60_000 {
        let mut inputs = Point::random(&mut rng).inputs(true);
        inputs.force = [0.0; 3];
        inputs.sideslip = 0.0;
        let [_, _, w] = body(&inputs);
        let flat = |v: [f64; 3]| V3::from(v) - V3::from(v).dot(&w) * w;
        let force_y = |i: &SpatialInputs| {
            let v_a = V3::from(i.velocity) - V3::from(i.wind);
            let a_r = V3::from(i.reference_acceleration);
            vehicle.mass * (vehicle.gravity * E3 - a_r) - side * v_a.norm() * v_a
        };
        if n % 2 == 0 {
            // In the plane of flight.
            let v_a = flat(inputs.velocity) - flat(inputs.wind);
            inputs.velocity = (V3::from(inputs.wind) + v_a).into();
            let a_r = flat(inputs.reference_acceleration) + vehicle.gravity * E3.dot(&w) * w;
            inputs.reference_acceleration = a_r.into();
        }
        // ṽ_w = 0.
        let error = V3::from(inputs.velocity) - V3::from(inputs.reference_velocity);
        inputs.reference_velocity =
            (V3::from(inputs.reference_velocity) + error.dot(&w) * w).into();
        let f_y = force_y(&inputs);
        let v_a = V3::from(inputs.velocity) - V3::from(inputs.wind);
        let u = v_a - v_a.dot(&f_y) * f_y / f_y.norm_squared();
        if f_y.norm() < l.force || u.norm() < l.airspeed {
            continue;
        }
        let law = |i: &SpatialInputs| winged_robust(&vehicle, C_Y.into(), &g, &l, i);
        let thrust = law(&inputs).thrust.value;
        let drag = aerodynamic_force(&vehicle, v_a, &attitude(inputs.quaternion));
        let [i, ..] = body(&inputs);
        let a = vehicle.gravity * E3 + (drag - thrust * i) / vehicle.mass;
        let jerk = V3::from(inputs.feed_forward.unwrap().1);
        inputs.feed_forward = Some((a.into(), jerk.into()));
        let rates = law(&inputs).rates.map(|r| r.value);
        let speed = rates.iter().map(|r| r * r).sum::<f64>().sqrt();
        let h = 1e-6 / (1.0 + speed + a.norm() / v_a.norm());
        let at = |h: f64| {
            let displaced = displaced(&inputs, a, jerk, rates, h);
            let [_, _, w] = body(&displaced);
            let v_a = V3::from(displaced.velocity) - V3::from(displaced.wind);
            (w.dot(&force_y(&displaced)), w.dot(&v_a))
        };
        let ((x_up, y_up), (x_down, y_down)) = (at(h), at(-h));
        let (x_rate, y_rate) = ((x_up - x_down) / (2.0 * h), (y_up - y_down) / (2.0 * h));
        let x = w.dot(&f_y);
        let squared = (x / f_y.norm()).powi(2);
        let f_rate = -vehicle.mass * jerk.dot(&w)
            - side * (v_a.norm() * a.dot(&w) + v_a.dot(&w) * v_a.dot(&a) / v_a.norm());
        let want = -l.tilt * x * (1.0 - squared) + f_rate * squared;
        // Roundings of |F_y| over 2h, and the quotient's truncation.
        let size = f_y.norm() * (1.0 + speed) + f_rate.abs();
        let tolerance = 1e-6 * size + 1e-15 * f_y.norm() / h;
        assert!(
            (x_rate - want).abs() < tolerance,
            "{x_rate} {want} {inputs:?}"
        );
        tilted += 1;
        if n % 2 == 0 {
            assert!(x.abs() < 1e-9 && want.abs() < 1e-6);
            let size = v_a.norm() * (1.0 + speed) + a.norm();
            assert!(y_rate.abs() < 1e-6 * size, "{y_rate} {inputs:?}");
            coordinated += 1;
        }
    }
    println!("{tilted} states, {coordinated} in the plane of flight");
    assert!(tilted > 10_000 && coordinated > 4_000);
}
