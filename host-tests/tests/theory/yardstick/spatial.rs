//! The law of the winged vehicle in space, in double precision, from its equations: an independent yardstick of
//! `alula::spatial`. World vectors are north-east-down; every quantity carries its N (see [`Number`]).

use std::f64::consts::PI;

use alula_sim::reference::{Coefficients, Gains, Vehicle, guarded};

use super::{Number, Triple};

/// Gains across the plane of symmetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateralGains {
    /// k_F \[1/s\].
    pub tilt: f64,
    /// K_y \[1/s\].
    pub velocity: f64,
    /// k_ψ \[1/s\].
    pub twist: f64,
    /// a_y \[m/s²\].
    pub acceleration: f64,
    /// τ_y \[N\].
    pub force: f64,
    /// V \[m/s\].
    pub airspeed: f64,
    /// η.
    pub heading: f64,
}

/// What a law in space is evaluated at. World vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpatialInputs {
    /// v \[m/s\].
    pub velocity: [f64; 3],
    /// The attitude's quaternion (w, x, y, z), of axes x = j, y = w, z = i; not necessarily of unit length.
    pub quaternion: [f64; 4],
    /// v_w \[m/s\].
    pub wind: [f64; 3],
    /// v_r \[m/s\].
    pub reference_velocity: [f64; 3],
    /// a_r \[m/s²\].
    pub reference_acceleration: [f64; 3],
    /// h, a unit vector or zero.
    pub heading: [f64; 3],
    /// d̂ \[N\].
    pub force: [f64; 3],
    /// What is added to v_aw across the plane of symmetry \[m/s\].
    pub sideslip: f64,
    /// (a \[m/s²\], j_r \[m/s³\]).
    pub feed_forward: Option<([f64; 3], [f64; 3])>,
}

/// A law's result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialEvaluation {
    /// T \[N\].
    pub thrust: Number,
    /// (ω_i, ω_j, ω_w) \[rad/s\].
    pub rates: [Number; 3],
    /// F_p in the plane of symmetry, (i, j) \[N\]; all of it for the axisymmetric vehicle.
    pub f_p: [f64; 3],
    /// 1/k; 1 in the robust law.
    pub k_inverse: f64,
}

/// The axes (i, j, w) of a quaternion of any length.
pub fn axes([w, x, y, z]: [f64; 4]) -> [Triple; 3] {
    let [w, x, y, z] = [w, x, y, z].map(Number::input);
    let square = w * w + x * x + y * y + z * z;
    let column = |v: [Number; 3]| Triple(v.map(|c| c / square));
    // The columns of the homogeneous rotation matrix.
    let first = [
        w * w + x * x - y * y - z * z,
        (x * y + w * z) * 2.0,
        (x * z - w * y) * 2.0,
    ];
    let second = [
        (x * y - w * z) * 2.0,
        w * w - x * x + y * y - z * z,
        (y * z + w * x) * 2.0,
    ];
    let third = [
        (x * z + w * y) * 2.0,
        (y * z - w * x) * 2.0,
        w * w - x * x - y * y + z * z,
    ];
    [column(third), column(first), column(second)]
}

/// W + d̂ \[N\].
pub(super) fn apparent_weight(vehicle: &Vehicle, inputs: &SpatialInputs) -> Triple {
    let [n, e, d] = inputs.reference_acceleration;
    let m = Number::input(vehicle.mass);
    let pull = [-n, -e, vehicle.gravity - d].map(|a| m * Number::input(a));
    // The difference g − a_d is rounded once.
    Triple(pull) + Triple::input(inputs.force)
}

/// μ_τ(s)/s².
pub(super) fn guard(tau: f64, s: Number) -> Number {
    let x = s.value;
    let value = guarded(tau, x);
    let slope = if x >= tau {
        -2.0 / x.powi(3)
    } else if x > 1e-3 * tau {
        let z = PI * x * x / (2.0 * tau * tau);
        PI * libm::cos(z) / (tau * tau * x) - 2.0 * libm::sin(z) / x.powi(3)
    } else {
        0.0
    };
    s.map(value, slope)
}

/// |F_p| + F̄_p1, by the form that does not cancel.
pub(super) fn alignment(norm: Number, along: Number, across_squared: Number) -> Number {
    if along.value >= 0.0 {
        norm + along
    } else {
        across_squared / (norm - along)
    }
}

/// The coefficients and derivatives as numbers, at an angle with this N.
pub(super) fn coefficients(vehicle: &Vehicle, alpha: f64, n_alpha: f64) -> [Number; 6] {
    let (c, n): (Coefficients, Coefficients) =
        vehicle.aerodynamics.at_with_magnitudes(alpha, n_alpha);
    [
        Number::with_size(c.c_l, n.c_l),
        Number::with_size(c.c_d, n.c_d),
        Number::with_size(c.dc_l, n.dc_l),
        Number::with_size(c.dc_d, n.dc_d),
        Number::with_size(c.ddc_l, n.ddc_l),
        Number::with_size(c.ddc_d, n.ddc_d),
    ]
}

/// The law with the robust planar law, ∂_α f_p γ̇ left out of F_δ.
pub fn winged_robust(
    vehicle: &Vehicle,
    c_y: f64,
    gains: &Gains,
    lateral: &LateralGains,
    inputs: &SpatialInputs,
) -> SpatialEvaluation {
    winged(vehicle, c_y, gains, lateral, inputs, false)
}

/// The law with the full planar law.
pub fn winged_full(
    vehicle: &Vehicle,
    c_y: f64,
    gains: &Gains,
    lateral: &LateralGains,
    inputs: &SpatialInputs,
) -> SpatialEvaluation {
    winged(vehicle, c_y, gains, lateral, inputs, true)
}

fn winged(
    vehicle: &Vehicle,
    c_y: f64,
    gains: &Gains,
    lateral: &LateralGains,
    inputs: &SpatialInputs,
    full: bool,
) -> SpatialEvaluation {
    let [i, j, w] = axes(inputs.quaternion);
    let v_a = Triple::difference(inputs.velocity, inputs.wind);
    let error = Triple::difference(inputs.velocity, inputs.reference_velocity);
    let weight = apparent_weight(vehicle, inputs);
    let one = Number::input(1.0);
    let (mass, k_a) = (Number::input(vehicle.mass), Number::input(vehicle.k_a));

    // In the plane of symmetry.
    let (v_1, v_2) = (v_a.dot(i), v_a.dot(j));
    let airspeed = v_a.norm();
    let in_plane = (v_1 * v_1 + v_2 * v_2).sqrt();
    let (sin_delta, cos_delta) = libm::sincos(vehicle.delta);
    let (sin, cos, alpha, n_alpha) = if in_plane.value > 0.0 {
        let (sin, cos) = (v_2 / in_plane, -v_1 / in_plane);
        let sin_alpha = sin * cos_delta - cos * sin_delta;
        let cos_alpha = cos * cos_delta + sin * sin_delta;
        let n = cos_alpha.value.abs() * sin_alpha.size + sin_alpha.value.abs() * cos_alpha.size;
        (sin, cos, libm::atan2(sin_alpha.value, cos_alpha.value), n)
    } else {
        let (sin, cos) = (Number::input(sin_delta), Number::input(cos_delta));
        (sin, cos, 0.0, 0.0)
    };
    let [c_l, c_d, dc_l, dc_d, ddc_l, ddc_d] = coefficients(vehicle, alpha, n_alpha);
    let lambda = dc_l * cos + dc_d * sin;
    let dlambda = ddc_l * cos - dc_l * sin + ddc_d * sin + dc_d * cos;
    let (bar_l, bar_d) = (c_l - lambda * sin, c_d + lambda * cos);
    let (dbar_l, dbar_d) = (
        dc_l - dlambda * sin - lambda * cos,
        dc_d + dlambda * cos - lambda * sin,
    );
    // k_a |v_a| (l S − d I)(x, y), S = w × .
    let scale = k_a * airspeed;
    let force = |l: Number, d: Number, x: Number, y: Number| {
        (scale * (-(l * y) - d * x), scale * (l * x - d * y))
    };
    let (a_1, a_2) = force(c_l, c_d, v_1, v_2);
    let (f_1, f_2) = (weight.dot(i) + a_1, weight.dot(j) + a_2);
    let f_p1 = weight.dot(i) + force(bar_l, bar_d, v_1, v_2).0;
    let norm = (f_p1 * f_p1 + f_2 * f_2).sqrt();
    let sum = alignment(norm, f_p1, f_2 * f_2);
    let weigh = |s: Number| {
        if full {
            one / (s * s)
        } else {
            guard(gains.tau, s)
        }
    };
    let [k1, k2, k3] = [gains.k1, gains.k2, gains.k3].map(Number::input);
    let mut rate = k2 * norm * error.dot(j) + k3 * norm * f_2 * weigh(sum);
    if let Some((a, jerk)) = inputs.feed_forward {
        let (a, jerk) = (Triple::input(a), Triple::input(jerk));
        let (x, y) = (a.dot(i), a.dot(j));
        // a_s + e (e·a_s), e = (−cos, sin).
        let along = y * sin - x * cos;
        let (d_1, d_2) = force(bar_l, bar_d, x - cos * along, y + sin * along);
        let (mut d_1, mut d_2) = (d_1 - mass * jerk.dot(i), d_2 - mass * jerk.dot(j));
        if full && in_plane.value > 0.0 {
            let turn = (v_1 * y - v_2 * x) / (in_plane * in_plane);
            let (t_1, t_2) = force(dbar_l, dbar_d, v_1, v_2);
            (d_1, d_2) = (d_1 - t_1 * turn, d_2 - t_2 * turn);
        }
        rate = rate + (f_p1 * d_2 - f_2 * d_1) * weigh(norm);
    }
    let k_inverse = if full {
        one + scale * in_plane * f_2 * (cos * dbar_d - sin * dbar_l) / (norm * norm)
    } else {
        one
    };

    let (omega_i, omega_j) = across(vehicle, c_y, lateral, inputs, [i, j, w]);
    SpatialEvaluation {
        thrust: f_1 + k1 * norm * error.dot(i),
        rates: [omega_i, omega_j, rate / k_inverse],
        f_p: [f_p1.value, f_2.value, 0.0],
        k_inverse: k_inverse.value,
    }
}

/// ω_i and ω_j: tilt and twist, in world vectors.
fn across(
    vehicle: &Vehicle,
    c_y: f64,
    gains: &LateralGains,
    inputs: &SpatialInputs,
    [i, j, w]: [Triple; 3],
) -> (Number, Number) {
    let one = Number::input(1.0);
    let mass = Number::input(vehicle.mass);
    let side = Number::input(vehicle.k_a) * Number::input(c_y);
    let v_a =
        Triple::difference(inputs.velocity, inputs.wind) + w.scale(Number::input(inputs.sideslip));
    let airspeed = v_a.norm();
    let error = Triple::difference(inputs.velocity, inputs.reference_velocity).dot(w);
    let x = Number::input(gains.velocity) * error;
    let a_y = Number::input(gains.acceleration);
    let sigma = x / (one + x * x / (a_y * a_y)).sqrt();
    let f_y = apparent_weight(vehicle, inputs) - v_a.scale(side * airspeed) + w.scale(mass * sigma);

    let norm = f_y.norm();
    let g = guard(gains.force, norm);
    let across = |z: Triple| z - f_y.scale(g * z.dot(f_y));
    let (u, h) = (across(v_a), across(Triple::input(inputs.heading)));
    let over = guard(gains.airspeed, u.norm());
    let share = u.norm() * over;
    let s = u.dot(u) * over;
    let h_share = (one - s) * h.norm() * guard(gains.heading, h.norm());
    let b = u.scale(share) + h.scale(h_share);
    let y = b.dot(w);
    let c = g * norm * (f_y.dot(i) * b.dot(j) - f_y.dot(j) * b.dot(i));

    let k_f = Number::input(gains.tilt);
    let facing = if c.value > 0.0 { one + c } else { one };
    let mut tilt = k_f * f_y.dot(w);
    let mut twist = y * (2.0 * gains.twist) / facing;
    if let Some((a, jerk)) = inputs.feed_forward {
        let (a, jerk) = (Triple::input(a), Triple::input(jerk));
        let turning = if airspeed.value > 0.0 {
            v_a.dot(w) * v_a.dot(a) / airspeed
        } else {
            Number::default()
        };
        let f_rate = -(mass * jerk.dot(w)) - side * (airspeed * a.dot(w) + turning);
        tilt = tilt + f_rate;
        twist = twist + share * c * (a.dot(w) - g * v_a.dot(f_y) * f_rate);
    }
    let tilt = g * tilt;
    let twist = g * norm * twist;
    (
        tilt * f_y.dot(j) + twist * f_y.dot(i),
        twist * f_y.dot(j) - tilt * f_y.dot(i),
    )
}
