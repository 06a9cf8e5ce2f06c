//! Spherical equivalency: the thrust change of variable that makes the aerodynamic force look like a sphere's.
//!
//! With T_p = T + λ k_a |v_a|² (`eq:Tp`) the force left over, f_p, hardly depends on the attitude. It does not at all
//! where `eq:condition` holds, nor to first order at any equilibrium (Theorem 3).

use crate::aero::{Aerodynamics, Coefficients};
use crate::air::{AirData, AngleOfAttack};
use crate::frame::{Attitude, Body, Inertial};
use crate::vehicle::Vehicle;

/// λ = c_L' cos(α+δ) + c_D' sin(α+δ) (`eq:pGC`).
#[inline(always)]
pub fn lambda(c: &Coefficients, air: &AirData) -> f32 {
    c.dc_l * air.cos + c.dc_d * air.sin
}

/// λ = c_L / sin α (`eq:pPC`), for δ = 0; c_L' / cos α where sin α vanishes.
pub fn lambda_parallel(c: &Coefficients, alpha: AngleOfAttack) -> f32 {
    // Below this sine the quotient has lost more digits than the limit is off.
    if alpha.sin.abs() < 1e-4 {
        c.dc_l / alpha.cos
    } else {
        c.c_l / alpha.sin
    }
}

/// (c̄_L, c̄_D) = (c_L − λ sin(α+δ), c_D + λ cos(α+δ)) (`clBcdB`).
#[inline]
pub fn equivalent_coefficients(c: &Coefficients, air: &AirData, lambda: f32) -> (f32, f32) {
    (c.c_l - lambda * air.sin, c.c_d + lambda * air.cos)
}

/// (c_D'' − 2c_L') sin(α+δ) + (c_L'' + 2c_D') cos(α+δ), zero where the shape is equivalent to a sphere
/// (`eq:condition`).
///
/// With λ of `eq:pGC` it is also all that is left of the derivatives of the equivalent coefficients:
/// c̄_L' = −h sin(α+δ), c̄_D' = h cos(α+δ), ∂_α f_p = h k_a |v_a|² i, h being this residual.
#[inline(always)]
pub fn condition_residual(c: &Coefficients, air: &AirData) -> f32 {
    (c.ddc_d - (c.dc_l + c.dc_l)) * air.sin + (c.ddc_l + (c.dc_d + c.dc_d)) * air.cos
}

/// sin² α times the derivative of c_D + c_L cot α, zero where that sum is constant (`eq:condSimpler`).
pub fn parallel_condition_residual(c: &Coefficients, alpha: AngleOfAttack) -> f32 {
    c.dc_d * alpha.sin * alpha.sin + c.dc_l * alpha.sin * alpha.cos - c.c_l
}

/// Forces on a vehicle that is to accelerate at a_r, in body components.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ApparentForces {
    /// Air data.
    pub air: AirData,
    /// Coefficients at the angle of attack.
    pub coefficients: Coefficients,
    /// λ (`eq:pGC`).
    pub lambda: f32,
    /// k_a |v_a|² \[N\]; in space k_a |v_a| times the length of v_a in the plane of symmetry.
    pub pressure: f32,
    /// F = m g i0 + F_a − m a_r \[N\].
    pub f: Body,
    /// F_p = m g i0 + f_p − m a_r \[N\] (`eq:FpExt`).
    pub f_p: Body,
}

impl ApparentForces {
    /// Forces at an `attitude` and `air_velocity` [m/s] of a vehicle that is to accelerate at `a_r` [m/s²].
    #[inline(always)]
    pub fn new<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        attitude: Attitude,
        air_velocity: Inertial,
        a_r: Inertial,
    ) -> Self {
        let weight = attitude.to_body(Inertial::new(
            vehicle.mass() * (vehicle.gravity() - a_r.down()),
            -vehicle.mass() * a_r.forward(),
        ));
        let air = AirData::new(attitude.to_body(air_velocity), vehicle.thrust_line());
        Self::in_plane(vehicle, air, air.speed, weight)
    }

    /// Forces in the plane of symmetry of a body that flies in space. `air` is the air in that plane, `weight` the components of the apparent
    /// weight m (g − a_r) \[N\] there. `airspeed` [m/s] is the length of the whole air velocity, times what the force of the air is of the
    /// believed one.
    #[inline(always)]
    pub(crate) fn in_plane<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        air: AirData,
        airspeed: f32,
        weight: Body,
    ) -> Self {
        let c = vehicle.model().coefficients(air.alpha);
        let lambda = lambda(&c, &air);
        let pressure = vehicle.k_a() * airspeed * air.speed;
        let f_i = weight.i() + pressure * (c.c_d * air.cos - c.c_l * air.sin);
        // F̄_2 = F̄_p2 always: thrust, and its change of variable, act along i.
        let f_j = weight.j() - pressure * (c.c_l * air.cos + c.c_d * air.sin);
        Self {
            air,
            coefficients: c,
            lambda,
            pressure,
            f: Body::new(f_i, f_j),
            f_p: Body::new(f_i + lambda * pressure, f_j),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{
        Combined, CombinedParameters, LargeAngle, LargeAngleParameters, SmallAngle,
        SmallAngleParameters,
    };
    use crate::air::ThrustLine;
    use crate::vehicle::VehicleParameters;

    fn angles() -> impl Iterator<Item = f32> {
        (-157..157).map(|n| n as f32 * 0.02)
    }

    fn air(alpha: f32, delta: f32) -> AirData {
        AirData::from_angle_of_attack(
            1.0,
            AngleOfAttack::from_radians(alpha),
            &ThrustLine::new(delta).unwrap(),
        )
    }

    /// Proposition 1 i: for every δ, λ = 2c1 cos(α − δ), c̄_L = −c1 sin 2δ, c̄_D = c0 + 2c1 cos² δ; and Lemma 4.
    #[test]
    fn the_large_angle_model_is_a_sphere_for_every_thrust_line() {
        let p = LargeAngleParameters::NACA_0021_RE_160E3;
        let model = LargeAngle::new(p).unwrap();
        for delta in [-1.5, -0.3, 0.0, 0.2, 1.0, 1.57f32] {
            for alpha in angles() {
                let air = air(alpha, delta);
                let c = model.coefficients(air.alpha);
                let l = lambda(&c, &air);
                let (cl, cd) = equivalent_coefficients(&c, &air, l);
                // 2e-6: some ten roundings of terms up to 4 c1.
                assert!((l - 2.0 * p.c1 * (alpha - delta).cos()).abs() < 2e-6);
                assert!((cl + p.c1 * (2.0 * delta).sin()).abs() < 2e-6);
                assert!((cd - p.c0 - 2.0 * p.c1 * delta.cos() * delta.cos()).abs() < 2e-6);
                assert!(condition_residual(&c, &air).abs() < 4e-6);
            }
        }
    }

    /// Proposition 1 ii: for δ = 0, by `eq:pPC`, λ = c2² cos α / D, c̄_L = 0, c̄_D = c0 + c2.
    #[test]
    fn the_small_angle_model_is_a_sphere_for_a_parallel_thrust_line() {
        let p = SmallAngleParameters {
            c0: 0.014,
            c2: 5.5,
            c3: 0.3,
        };
        let model = SmallAngle::new(p).unwrap();
        for alpha in angles() {
            let air = air(alpha, 0.0);
            let c = model.coefficients(air.alpha);
            let l = lambda_parallel(&c, air.alpha);
            let d = (p.c2 - p.c3) * alpha.cos().powi(2) + p.c3;
            let (cl, cd) = equivalent_coefficients(&c, &air, l);
            // 1e-5: terms up to 18, and λ loses a digit near sin α = 0.
            assert!((l - p.c2 * p.c2 * alpha.cos() / d).abs() < 1e-5);
            assert!(cl.abs() < 1e-6 && (cd - p.c0 - p.c2).abs() < 1e-5);
            assert!(parallel_condition_residual(&c, air.alpha).abs() < 3e-6);
        }
    }

    /// Lemma 4: no other family is spherical whatever δ.
    #[test]
    fn the_other_models_are_not_spheres() {
        let small = SmallAngle::new(SmallAngleParameters {
            c0: 0.014,
            c2: 5.5,
            c3: 0.3,
        })
        .unwrap();
        let combined = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        for delta in [0.0, 0.3, -0.8, 1.5] {
            let worst = |model: &dyn Aerodynamics| {
                angles()
                    .map(|alpha| {
                        let air = air(alpha, delta);
                        condition_residual(&model.coefficients(air.alpha), &air).abs()
                    })
                    .fold(0.0, f32::max)
            };
            // The small-angle model is one for δ = 0 (Lemma 2 ii implies Lemma 2 i), and only then. 1e-3: roundings
            // of second derivatives up to 4e3.
            assert!(if delta == 0.0 {
                worst(&small) < 1e-3
            } else {
                worst(&small) > 1.0
            });
            assert!(worst(&combined) > 1.0);
        }
        // And the combined model, unlike its small-angle part, is none for δ = 0 either.
        let a = AngleOfAttack::from_radians(0.2);
        assert!(parallel_condition_residual(&combined.coefficients(a), a).abs() > 0.1);
    }

    #[test]
    fn lambda_is_the_papers_derivative_free_form_only_where_it_should_be() {
        // At α = 0 both forms give the lift slope.
        let combined = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let air = air(0.0, 0.0);
        let c = combined.coefficients(air.alpha);
        assert_eq!(lambda(&c, &air), c.dc_l);
        assert_eq!(lambda_parallel(&c, air.alpha), c.dc_l);
    }

    /// `f_p = k_a |v_a| (c̄_L S − c̄_D I) v_a` with `F_p = m g i0 + f_p − m a_r`, in inertial components.
    #[test]
    fn apparent_forces_match_the_vector_equations() {
        let p = VehicleParameters {
            delta: 0.35,
            ..VehicleParameters::PAPER
        };
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = Vehicle::new(p, model).unwrap();
        for alpha in angles() {
            let attitude = Attitude::from_angle(alpha);
            let (v_a, a_r) = (Inertial::new(-3.0, 11.0), Inertial::new(0.7, -1.3));
            let forces = ApparentForces::new(&vehicle, attitude, v_a, a_r);
            let c = forces.coefficients;
            let (cl, cd) = equivalent_coefficients(&c, &forces.air, forces.lambda);
            let s = nalgebra::Matrix2::new(0.0, -1.0, 1.0, 0.0);
            let speed = 130f32.sqrt();
            let apparent = nalgebra::Vector2::new(p.mass * (p.gravity - 0.7), p.mass * 1.3);
            let air = nalgebra::Vector2::from(v_a);
            let f_a = p.k_a * speed * (s * air * c.c_l - air * c.c_d) + apparent;
            let f_p = p.k_a * speed * (s * air * cl - air * cd) + apparent;
            // 2e-4 N: a dozen roundings of forces up to 1500 N.
            assert!(
                (nalgebra::Vector2::from(attitude.to_inertial(forces.f)) - f_a).amax() < 2e-4 * 4.0
            );
            assert!(
                (nalgebra::Vector2::from(attitude.to_inertial(forces.f_p)) - f_p).amax()
                    < 2e-4 * 4.0
            );
        }
    }
}
