//! The control laws as printed.

use super::{Matrix, S, Vector, Vehicle, rotation};

/// Gains of the laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// k1 \[s/m\].
    pub k1: f64,
    /// k2 \[rad/(N·m)\].
    pub k2: f64,
    /// k3 \[rad/s\].
    pub k3: f64,
    /// τ \[N\].
    pub tau: f64,
}

/// What a law is evaluated at. Vectors in inertial coordinates (down, forward).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// v \[m/s\].
    pub velocity: Vector,
    /// θ \[rad\].
    pub theta: f64,
    /// v_w \[m/s\].
    pub wind: Vector,
    /// v_r \[m/s\].
    pub reference_velocity: Vector,
    /// a_r \[m/s²\].
    pub reference_acceleration: Vector,
    /// (ẍ_a \[m/s²\], j_r \[m/s³\]); without it F_δ = 0.
    pub feed_forward: Option<(Vector, Vector)>,
}

/// A law's result, with what went into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// T \[N\].
    pub thrust: f64,
    /// ω \[rad/s\].
    pub rate: f64,
    /// α \[rad\].
    pub alpha: f64,
    /// F_p \[N\], inertial.
    pub f_p: Vector,
    /// 1/k; exactly 1 in the robust law.
    pub k_inverse: f64,
}

impl Evaluation {
    /// θ̃, from i to F_p \[rad\], for the orientation `theta`.
    pub fn theta_tilde(&self, theta: f64) -> f64 {
        let f_p = rotation(theta).transpose() * self.f_p;
        libm::atan2(f_p.y, f_p.x)
    }
}

/// μ_τ(s).
pub fn mu(tau: f64, s: f64) -> f64 {
    if s <= tau {
        libm::sin(std::f64::consts::PI * s * s / (2.0 * tau * tau))
    } else {
        1.0
    }
}

/// `eq:inputsVCeR`.
pub fn robust(vehicle: &Vehicle, gains: &Gains, inputs: &Inputs) -> Evaluation {
    evaluate(vehicle, gains, inputs, false)
}

/// `lawsVGen`; singular where |F_p| = 0, θ̃ = π or 1/k = 0.
pub fn full(vehicle: &Vehicle, gains: &Gains, inputs: &Inputs) -> Evaluation {
    evaluate(vehicle, gains, inputs, true)
}

/// `μ_τ(s)/s²`, by its limit where s² underflows.
pub fn guarded(tau: f64, s: f64) -> f64 {
    if s > 1e-9 * tau {
        mu(tau, s) / (s * s)
    } else {
        std::f64::consts::FRAC_PI_2 / (tau * tau)
    }
}

fn evaluate(vehicle: &Vehicle, gains: &Gains, inputs: &Inputs, full: bool) -> Evaluation {
    let air = vehicle.air(inputs.velocity, inputs.wind, inputs.theta);
    let r_t = rotation(inputs.theta).transpose();
    let f = r_t * vehicle.f(&air, inputs.reference_acceleration);
    let f_p_inertial = vehicle.f_p(&air, inputs.reference_acceleration);
    let f_p = r_t * f_p_inertial;
    let norm = f_p.norm();
    let error = r_t * (inputs.velocity - inputs.reference_velocity);

    // |F_p| + F̄_p1, in the form that does not cancel.
    let sum = if f_p.x >= 0.0 {
        norm + f_p.x
    } else {
        f_p.y * f_p.y / (norm - f_p.x)
    };
    let (alignment, forward) = if full {
        (1.0 / (sum * sum), 1.0 / (norm * norm))
    } else {
        (guarded(gains.tau, sum), guarded(gains.tau, norm))
    };
    let f_delta = inputs
        .feed_forward
        .map_or(Vector::zeros(), |(acceleration, jerk)| {
            f_delta(vehicle, &air, acceleration, jerk)
        });
    let rate = gains.k2 * norm * error.y + gains.k3 * norm * f_p.y * alignment
        - f_p.dot(&(S * r_t * f_delta)) * forward;

    let k_inverse = if full {
        let (sin, cos) = libm::sincos(air.alpha + vehicle.delta);
        1.0 + vehicle.k_a * air.speed.powi(2) * f.y * (cos * air.dc_d_bar - sin * air.dc_l_bar)
            / (norm * norm)
    } else {
        1.0
    };
    Evaluation {
        thrust: f.x + gains.k1 * norm * error.x,
        rate: rate / k_inverse,
        alpha: air.alpha,
        f_p: f_p_inertial,
        k_inverse,
    }
}

/// `Fdelta`. At zero air speed its aerodynamic part is zero.
fn f_delta(vehicle: &Vehicle, air: &super::Air, acceleration: Vector, jerk: Vector) -> Vector {
    let v = air.velocity;
    let aerodynamic = if air.speed > 0.0 {
        let by_velocity = vehicle.k_a
            * (air.c_l_bar * S - air.c_d_bar * Matrix::identity())
            * (air.speed * Matrix::identity() + v * v.transpose() / air.speed);
        let by_alpha = vehicle.force(air, air.dc_l_bar, air.dc_d_bar);
        let gamma_rate = (v.x * acceleration.y - v.y * acceleration.x) / air.speed.powi(2);
        by_velocity * acceleration - by_alpha * gamma_rate
    } else {
        Vector::zeros()
    };
    aerodynamic - vehicle.mass * jerk
}
