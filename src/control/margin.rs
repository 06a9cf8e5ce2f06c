//! How far a state is from where the velocity problem is no longer well posed.

use crate::equivalency::{ApparentForces, condition_residual};
use crate::math;

/// Margins of one step. All but `fold` refer to the flown state; every one is finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Margin {
    /// |F_p|/τ. Below 1 the guard acts, at 0 there is no equilibrium attitude.
    pub force: f32,
    /// The gain k of the full law (`eq:kv`), which the robust law leaves out. On a sphere it is 1; where F_p turns with
    /// the attitude it is large or negative; where it is undefined it is 0.
    pub k: f32,
    /// Angle \[rad\] from the present attitude to the nearest fold, to first order, in [−π, π]; positive on the side
    /// that thrust can hold.
    ///
    /// Equilibria are the zeros of F̄_2 over θ, and ∂_θ F̄_2 = −F̄_p1: a fold is a zero of F̄_p1. With
    /// ∂_θ F̄_p1 = F̄_p2 + h k_a|v_a|², h the residual of `eq:condition`, the angle is one Newton step long:
    /// −F̄_p1/∂_θ F̄_p1. It is exact in the limit, and far from a fold an indication only.
    pub fold: f32,
}

impl Margin {
    /// The margin at these forces, on the branch of this sign.
    #[inline(always)]
    pub(crate) fn new(forces: &ApparentForces, f_p_norm: f32, tau: f32, sign: f32) -> Self {
        let f_p = forces.f_p;
        let h = forces.pressure * condition_residual(&forces.coefficients, &forces.air);
        let slope = (f_p.j() + h).abs();
        let norm_squared = f_p_norm * f_p_norm;
        let inverse_k = norm_squared + h * f_p.j();
        let along = sign * f_p.i();
        Self {
            force: f_p_norm / tau,
            k: if inverse_k == 0.0 {
                0.0
            } else {
                norm_squared / inverse_k
            },
            fold: if along.abs() < math::PI * slope {
                along / slope
            } else {
                math::PI.copysign(along)
            },
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Aerodynamics, Combined, CombinedParameters};
    use crate::air::AngleOfAttack;
    use crate::frame::{Attitude, Inertial};
    use crate::vehicle::{Vehicle, VehicleParameters};

    fn vehicle() -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Vehicle::new(VehicleParameters::PAPER, model).unwrap()
    }

    fn at(theta: f32, forward: f32) -> (Margin, ApparentForces) {
        let forces = ApparentForces::new(
            &vehicle(),
            Attitude::from_angle(theta),
            Inertial::new(0.0, forward),
            Inertial::ZERO,
        );
        (Margin::new(&forces, forces.f_p.norm(), 80.0, 1.0), forces)
    }

    /// Level flight's folds, (α, a) = (11.155°, 1.30333) and (16.764°, 1.52879): in equilibrium there the margin is
    /// zero, and half a degree before them it is half a degree.
    #[test]
    fn the_angle_vanishes_at_the_folds_of_level_flight() {
        for (alpha, a, side) in [(11.155f64, 1.30333f64, -1.0f32), (16.764, 1.52879, 1.0)] {
            let speed = (a * 98.1 / 0.6460).sqrt() as f32;
            let theta = (alpha - 90.0).to_radians() as f32;
            // 2e-4 rad: the angles above are rounded to 1e-5 rad, and F̄_p1 is a difference of forces of 100 N.
            assert!(at(theta, speed).0.fold.abs() < 2e-4);
            let away = theta + side * 0.5f32.to_radians();
            let fold = at(away, speed).0.fold;
            // A tenth: one Newton step on a curve that bends within degrees.
            assert!(
                (fold.to_degrees() - 0.5).abs() < 0.1,
                "{alpha} {}",
                fold.to_degrees()
            );
        }
    }

    #[test]
    fn the_slope_is_the_derivative_of_f_p1_over_the_attitude() {
        for n in -157..157 {
            let theta = n as f32 * 0.02;
            let i = |theta| f64::from(at(theta, 12.0).1.f_p.i());
            let central = |h: f32| (i(theta + h) - i(theta - h)) / f64::from(2.0 * h);
            // Richardson: what is left is of fourth order in 4 mrad.
            let slope = (4.0 * central(2e-3) - central(4e-3)) / 3.0;
            let (_, forces) = at(theta, 12.0);
            let got = f64::from(
                forces.f_p.j()
                    + forces.pressure * condition_residual(&forces.coefficients, &forces.air),
            );
            // 1 N: 1e-4 N of rounding, and of the angle's, over 4 mrad. 5e-4 of the slope: what is left of the blend's
            // sixth derivative, at the stall angle.
            assert!(
                (got - slope).abs() < 1.0 + 5e-4 * slope.abs(),
                "{theta}: {got} {slope}"
            );
        }
    }

    #[test]
    fn in_hover_there_is_no_fold_and_k_is_one() {
        let (margin, _) = at(0.0, 0.0);
        assert_eq!(margin.k, 1.0);
        assert_eq!(margin.fold, math::PI);
        assert!((margin.force - 98.1 / 80.0).abs() < 1e-6);
    }

    /// `eq:kv` from its own terms, with c̄_L' and c̄_D' by differences.
    #[test]
    fn k_is_that_of_the_printed_equation() {
        let (vehicle, v) = (vehicle(), 13.0f32);
        for n in 0..60 {
            let theta = -1.5 + 0.02 * n as f32;
            let (margin, forces) = at(theta, v);
            let bar = |alpha: f32| {
                let air = crate::air::AirData::from_angle_of_attack(
                    v,
                    AngleOfAttack::from_radians(alpha),
                    vehicle.thrust_line(),
                );
                let c = vehicle.model().coefficients(air.alpha);
                let lambda = crate::equivalency::lambda(&c, &air);
                crate::equivalency::equivalent_coefficients(&c, &air, lambda)
            };
            let (alpha, h) = (forces.air.alpha.rad, 1e-3);
            let ((lp, dp), (lm, dm)) = (bar(alpha + h), bar(alpha - h));
            let (dl, dd) = ((lp - lm) / (2.0 * h), (dp - dm) / (2.0 * h));
            let norm_squared = forces.f_p.i().powi(2) + forces.f_p.j().powi(2);
            let inverse = 1.0
                + forces.pressure * forces.f.j() * (alpha.cos() * dd - alpha.sin() * dl)
                    / norm_squared;
            // 5e-3: differences of coefficients known to 1e-6 over 2e-3.
            assert!(
                (1.0 / margin.k - inverse).abs() < 5e-3 * (1.0 + inverse.abs()),
                "{theta}"
            );
        }
    }
}
