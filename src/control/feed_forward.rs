//! The feed-forward F_δ (`Fdelta`).

use super::command::FeedForward;
use crate::equivalency::{ApparentForces, condition_residual, equivalent_coefficients};
use crate::frame::{Attitude, Body};

/// `F_δ = ∂_{ẋ_a} f_p · ẍ_a − ∂_α f_p · γ̇ − m j_r` [N/s] in body components.
///
/// ∂_{ẋ_a} f_p = k_a (c̄_L S − c̄_D I)(|v_a| I + v_a v_aᵀ/|v_a|); ∂_α f_p = h k_a |v_a|² i, h the residual of
/// `eq:condition`; and |v_a|² γ̇ = v_a × ẍ_a, so nothing divides by the airspeed.
#[inline(always)]
pub(super) fn f_delta(
    forces: &ApparentForces,
    mass: f32,
    k_a: f32,
    attitude: Attitude,
    ff: &FeedForward,
) -> Body {
    let air = &forces.air;
    let (c_l, c_d) = equivalent_coefficients(&forces.coefficients, air, forces.lambda);
    let h = condition_residual(&forces.coefficients, air);
    let a = attitude.to_body(ff.air_acceleration);
    let jerk = attitude.to_body(ff.jerk);
    // The direction of v_a is (−cos(α+δ), sin(α+δ)).
    let along = a.j() * air.sin - a.i() * air.cos;
    let across = -(a.j() * air.cos + a.i() * air.sin);
    let (w_i, w_j) = (a.i() - air.cos * along, a.j() + air.sin * along);
    let scale = k_a * air.speed;
    Body::new(
        -scale * (c_l * w_j + c_d * w_i + h * across) - mass * jerk.i(),
        scale * (c_l * w_i - c_d * w_j) - mass * jerk.j(),
    )
}
