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
    f_delta_in_plane(
        forces,
        mass,
        k_a * forces.air.speed,
        condition_residual(&forces.coefficients, &forces.air),
        attitude.to_body(ff.air_acceleration),
        attitude.to_body(ff.jerk),
    )
}

/// F_δ from the components of ẍ_a [m/s²] and j_r [m/s³] in the plane of symmetry; `scale` is k_a |v_a| \[kg/s\], and
/// `h` the residual of `eq:condition`, or 0 to leave ∂_α f_p γ̇ out.
#[inline(always)]
pub(crate) fn f_delta_in_plane(
    forces: &ApparentForces,
    mass: f32,
    scale: f32,
    h: f32,
    a: Body,
    jerk: Body,
) -> Body {
    let air = &forces.air;
    let (c_l, c_d) = equivalent_coefficients(&forces.coefficients, air, forces.lambda);
    // The direction of v_a is (−cos(α+δ), sin(α+δ)).
    let along = a.j() * air.sin - a.i() * air.cos;
    let across = -(a.j() * air.cos + a.i() * air.sin);
    let (w_i, w_j) = (a.i() - air.cos * along, a.j() + air.sin * along);
    Body::new(
        -scale * (c_l * w_j + c_d * w_i + h * across) - mass * jerk.i(),
        scale * (c_l * w_i - c_d * w_j) - mass * jerk.j(),
    )
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{
        Aerodynamics, Combined, CombinedParameters, LargeAngle, LargeAngleParameters,
    };
    use crate::frame::Inertial;
    use crate::vehicle::{Vehicle, VehicleParameters};

    /// At a fixed attitude dF_p/dt is F_δ (`FpDot` with ω = 0): central differences along a path of the air velocity
    /// and the reference acceleration.
    fn check(model: impl Aerodynamics, delta: f32, alpha_deg: f32) {
        let vehicle = Vehicle::new(
            VehicleParameters {
                delta,
                ..VehicleParameters::PAPER
            },
            model,
        )
        .unwrap();
        let ff = FeedForward {
            air_acceleration: Inertial::new(1.5, -2.5),
            jerk: Inertial::new(0.3, 0.8),
        };
        // γ = atan2(11, −3), θ = α + γ − π + δ.
        let gamma = 11f32.atan2(-3.0);
        let attitude =
            Attitude::from_angle(alpha_deg.to_radians() + gamma - core::f32::consts::PI + delta);
        let at = |t: f32| {
            ApparentForces::new(
                &vehicle,
                attitude,
                Inertial::new(-3.0 + 1.5 * t, 11.0 - 2.5 * t),
                Inertial::new(0.5 + 0.3 * t, -1.0 + 0.8 * t),
            )
        };
        let forces = at(0.0);
        assert!((forces.air.alpha.rad.to_degrees() - alpha_deg).abs() < 1e-3);
        let got = f_delta(&forces, vehicle.mass(), vehicle.k_a(), attitude, &ff);
        let h = 4e-3;
        let (p, m) = (at(h).f_p, at(-h).f_p);
        let (want_i, want_j) = ((p.i() - m.i()) / (2.0 * h), (p.j() - m.j()) / (2.0 * h));
        // An ulp of F_p (1e-4 N) over 2h is 0.02 N/s; a missing term of F_δ would be 10 to 1000.
        let tolerance = 0.05 + 2e-3 * want_i.hypot(want_j);
        assert!(
            (got.i() - want_i).abs() < tolerance && (got.j() - want_j).abs() < tolerance,
            "{alpha_deg}: {got:?} is not {want_i} {want_j}"
        );
    }

    #[test]
    fn is_the_rate_of_change_of_f_p_at_a_fixed_attitude() {
        let combined = || Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let large = || LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        for alpha in [
            -170.0, -60.0, -12.0, -3.0, 0.0, 5.0, 11.0, 14.0, 20.0, 45.0, 90.0, 140.0,
        ] {
            for delta in [0.0, 0.3, -1.2] {
                check(combined(), delta, alpha);
                check(large(), delta, alpha);
            }
        }
    }
}
