//! The law of the axisymmetric vehicle in double precision, from its equations.

use super::spatial::{
    SpatialEvaluation, SpatialInputs, alignment, apparent_weight, axes, coefficients, guard,
};
use super::{Number, Triple};
use alula_sim::reference::{Gains, Vehicle};

/// The robust law, ∂_α f_p α̇ left out of F_δ. ω_i is 0: heading is no part of it.
pub fn axisymmetric_robust(
    vehicle: &Vehicle,
    gains: &Gains,
    inputs: &SpatialInputs,
) -> SpatialEvaluation {
    evaluate(vehicle, gains, inputs, false)
}

/// The full law; singular where |F_p| = 0, θ̃ = π, sin α = 0 or 1 = p·g.
pub fn axisymmetric_full(
    vehicle: &Vehicle,
    gains: &Gains,
    inputs: &SpatialInputs,
) -> SpatialEvaluation {
    evaluate(vehicle, gains, inputs, true)
}

fn evaluate(
    vehicle: &Vehicle,
    gains: &Gains,
    inputs: &SpatialInputs,
    full: bool,
) -> SpatialEvaluation {
    let [i, j, w] = axes(inputs.quaternion);
    let v_a = Triple::difference(inputs.velocity, inputs.wind);
    let error = Triple::difference(inputs.velocity, inputs.reference_velocity);
    let one = Number::input(1.0);
    let (mass, k_a) = (Number::input(vehicle.mass), Number::input(vehicle.k_a));
    let speed = v_a.norm();
    let (v_1, v_2, v_3) = (v_a.dot(i), v_a.dot(j), v_a.dot(w));
    let (sin, cos) = if speed.value > 0.0 {
        ((v_2 * v_2 + v_3 * v_3).sqrt() / speed, -v_1 / speed)
    } else {
        (Number::input(0.0), one)
    };
    let n_alpha = cos.value.abs() * sin.size + sin.value.abs() * cos.size;
    let alpha = libm::atan2(sin.value, cos.value);
    let [c_l, c_d, dc_l, dc_d, ..] = coefficients(vehicle, alpha, n_alpha);
    // c_L/sin α, and its limit. c_L and sin α vanish together: what counts is the error of the angle in the quotient,
    // |(c_L/sin α)′| N(α), and one rounding of each.
    let lambda = if sin.value > 1e-9 {
        let value = c_l.value / sin.value;
        let slope = (dc_l.value - value * cos.value) / sin.value;
        Number::with_size(
            value,
            c_l.value.abs().max(dc_l.size * sin.value) / sin.value * 2.0 + slope.abs() * n_alpha,
        )
    } else {
        dc_l * (1.0 / cos.value)
    };
    let b = c_d + lambda * cos;
    let weight = apparent_weight(vehicle, inputs);
    let f_p = weight - v_a.scale(k_a * b * speed);
    let (f_1, f_2, f_3) = (f_p.dot(i), f_p.dot(j), f_p.dot(w));
    let norm = f_p.norm();
    let sum = alignment(norm, f_1, f_2 * f_2 + f_3 * f_3);
    let weigh = |s: Number| {
        if full {
            one / (s * s)
        } else {
            guard(gains.tau, s)
        }
    };
    let [k1, k2, k3] = [gains.k1, gains.k2, gains.k3].map(Number::input);

    let mut m_2 = k2 * norm * error.dot(j) + k3 * norm * f_2 * weigh(sum);
    let mut m_3 = k2 * norm * error.dot(w) + k3 * norm * f_3 * weigh(sum);
    // b′/sin α: b′ = c_D′ + c_L′ cot α − c_L/sin² α.
    let slope = if full {
        (dc_d + dc_l * cos / sin - c_l / (sin * sin)) / sin
    } else {
        Number::default()
    };
    if let Some((a, jerk)) = inputs.feed_forward {
        let (a, jerk) = (Triple::input(a), Triple::input(jerk));
        let mut f_delta = Triple::default() - jerk.scale(mass);
        if speed.value > 0.0 {
            let along = v_a.dot(a) / speed;
            f_delta = f_delta - (a.scale(speed) + v_a.scale(along)).scale(k_a * b);
            // −sin α α̇ = d/dt cos α, so b′ α̇ = −(b′/sin α) d/dt cos α, with cos α = −v_a1/|v_a|.
            let cos_rate = -(a.dot(i)) / speed + v_1 * along / (speed * speed);
            f_delta = f_delta + v_a.scale(k_a * slope * cos_rate * speed);
        }
        let (d_1, d_2, d_3) = (f_delta.dot(i), f_delta.dot(j), f_delta.dot(w));
        m_2 = m_2 + (f_1 * d_2 - f_2 * d_1) * weigh(norm);
        m_3 = m_3 - (f_3 * d_1 - f_1 * d_3) * weigh(norm);
    }
    let mut k_inverse = 1.0;
    if full {
        let scale = -k_a * slope / (norm * norm);
        let g = [
            scale * (f_1 * v_2 - f_2 * v_1),
            scale * (f_1 * v_3 - f_3 * v_1),
        ];
        let left = one - (v_2 * g[0] + v_3 * g[1]);
        let factor = (v_2 * m_2 + v_3 * m_3) / left;
        (m_2, m_3) = (m_2 + g[0] * factor, m_3 + g[1] * factor);
        k_inverse = left.value;
    }
    SpatialEvaluation {
        thrust: f_1 - lambda * k_a * speed * speed + k1 * norm * error.dot(i),
        rates: [Number::default(), -m_3, m_2],
        f_p: [f_1.value, f_2.value, f_3.value],
        k_inverse,
    }
}
