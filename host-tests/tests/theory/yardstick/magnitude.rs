//! The yardstick of rounding errors: the sums of the magnitudes of the terms that make up thrust
//! and angular rate.
//!
//! Written N(x) below, for every quantity x of the law:
//! - N(x + y) = N(x) + N(y), N(x·y) = N(x)·N(y), down to the inputs' products with cos θ and sin θ;
//! - the inputs, the air velocity v − v_w and the velocity error v − v_r count by their own
//!   magnitude (a difference of two inputs is rounded once);
//! - sin(α+δ) and cos(α+δ) are the body components of v_a over |v_a|;
//! - a coefficient or derivative counts by the terms of the product rule on its blend and, with
//!   [`Angle::Expanded`], by the effect of N(α) on it
//!   (see [`Aerodynamics::at_with_magnitudes`](alula_sim::reference::Aerodynamics::at_with_magnitudes));
//! - N(α) = |cos α| N(sin α) + |sin α| N(cos α), where sin α = sin(α+δ) cos δ − cos(α+δ) sin δ and
//!   so on: the angle is made up of body components of v_a, which may cancel;
//! - F̄_p1 = F̄_1 + λ k_a|v_a|² and F̄_p2 = F̄_2; N(|F_p|) = √(N(F̄_p1)² + N(F̄_p2)²);
//! - a quotient counts by N of its numerator over the magnitude of its denominator; the factors
//!   μ_τ(s)/s² (or 1/s²) count by their value;
//! - k of the full law counts as k²·N(1/k), the first-order effect of an error in 1/k.

use alula_sim::reference::{Evaluation, Gains, Inputs, Vehicle, guarded};

/// Whether N counts the terms that make up the angle of attack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angle {
    /// As if α were an input: a smaller yardstick.
    Given,
    /// With the terms of α.
    Expanded,
}

/// N(T) and N(ω).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnitudes {
    /// N(T) \[N\].
    pub thrust: f64,
    /// N(ω) \[rad/s\].
    pub rate: f64,
}

/// N of the body components of an inertial vector.
struct Body {
    i: f64,
    j: f64,
}

impl Body {
    fn of(down: f64, forward: f64, theta: f64) -> Self {
        let (sin, cos) = libm::sincos(theta);
        Self {
            i: (cos * down).abs() + (sin * forward).abs(),
            j: (sin * down).abs() + (cos * forward).abs(),
        }
    }
}

/// N(T) and N(ω) of the law that gave `evaluation`: the full one if `full`.
pub fn magnitudes(
    vehicle: &Vehicle,
    gains: &Gains,
    inputs: &Inputs,
    evaluation: &Evaluation,
    full: bool,
    angle: Angle,
) -> Magnitudes {
    let theta = inputs.theta;
    let air = vehicle.air(inputs.velocity, inputs.wind, theta);
    let v_a = Body::of(air.velocity.x, air.velocity.y, theta);
    let unit = |x: f64| if air.speed > 0.0 { x / air.speed } else { 0.0 };
    let (cos, sin) = (unit(v_a.i), unit(v_a.j));
    let n_alpha = match angle {
        Angle::Given => 0.0,
        Angle::Expanded => {
            let (sin_delta, cos_delta) = libm::sincos(vehicle.delta);
            let sin_alpha = sin * cos_delta.abs() + cos * sin_delta.abs();
            let cos_alpha = cos * cos_delta.abs() + sin * sin_delta.abs();
            libm::cos(air.alpha).abs() * sin_alpha + libm::sin(air.alpha).abs() * cos_alpha
        }
    };
    let c = vehicle
        .aerodynamics
        .at_with_magnitudes(air.alpha, n_alpha)
        .1;

    let lambda = c.dc_l * cos + c.dc_d * sin;
    let dlambda = c.ddc_l * cos + c.dc_l * sin + c.ddc_d * sin + c.dc_d * cos;
    let c_l_bar = c.c_l + lambda * sin;
    let c_d_bar = c.c_d + lambda * cos;
    let dc_l_bar = c.dc_l + dlambda * sin + lambda * cos;
    let dc_d_bar = c.dc_d + dlambda * cos + lambda * sin;

    let q = vehicle.k_a * air.speed.powi(2);
    let a_r = inputs.reference_acceleration;
    let weight = Body::of(
        vehicle.mass * (vehicle.gravity + a_r.x.abs()),
        vehicle.mass * a_r.y,
        theta,
    );
    let f_1 = weight.i + q * (c.c_l * sin + c.c_d * cos);
    let f_2 = weight.j + q * (c.c_l * cos + c.c_d * sin);
    let f_p1 = f_1 + q * lambda;
    let norm = libm::hypot(f_p1, f_2);

    let error = inputs.velocity - inputs.reference_velocity;
    let error = Body::of(error.x, error.y, theta);

    let f_delta = inputs
        .feed_forward
        .map_or(Body { i: 0.0, j: 0.0 }, |(a, jerk)| {
            let acceleration = Body::of(a.x, a.y, theta);
            let along = cos * acceleration.i + sin * acceleration.j;
            let (x, y) = (acceleration.i + cos * along, acceleration.j + sin * along);
            let kv = vehicle.k_a * air.speed;
            let turn = vehicle.k_a * ((air.velocity.x * a.y).abs() + (air.velocity.y * a.x).abs());
            let jerk = Body::of(vehicle.mass * jerk.x, vehicle.mass * jerk.y, theta);
            Body {
                i: kv * (c_l_bar * y + c_d_bar * x)
                    + turn * (dc_l_bar * sin + dc_d_bar * cos)
                    + jerk.i,
                j: kv * (c_l_bar * x + c_d_bar * y)
                    + turn * (dc_l_bar * cos + dc_d_bar * sin)
                    + jerk.j,
            }
        });

    let true_norm = evaluation.f_p.norm();
    // |F_p| + F̄_p1 = |F_p|(1 + cos θ̃) = 2|F_p| cos²(θ̃/2).
    let sum = 2.0 * true_norm * libm::cos(evaluation.theta_tilde(theta) / 2.0).powi(2);
    let guard = |s: f64| {
        if full {
            1.0 / (s * s)
        } else {
            guarded(gains.tau, s)
        }
    };
    let bracket = gains.k2 * norm * error.j
        + gains.k3 * norm * f_2 * guard(sum)
        + (f_p1 * f_delta.j + f_2 * f_delta.i) * guard(true_norm);
    let k_inverse = if full {
        1.0 + q * f_2 * (cos * dc_d_bar + sin * dc_l_bar) / true_norm.powi(2)
    } else {
        1.0
    };
    Magnitudes {
        thrust: f_1 + gains.k1 * norm * error.i,
        rate: bracket * k_inverse / evaluation.k_inverse.powi(2),
    }
}
