//! The force of the air on a winged vehicle in space: a longitudinal model in the plane of symmetry, and a side force across
//! it.

use super::vector::Body;
use crate::aero::Aerodynamics;
use crate::air::AirData;
use crate::math;
use crate::ned::Frd;
use crate::vehicle::Vehicle;

impl<A: Aerodynamics> Vehicle<A> {
    /// Aerodynamic force F_a \[N\] at an air velocity [m/s] in space, by strip theory: with v_s the part of v_a in the
    /// plane of symmetry and v_aw the part across,
    ///
    /// `F_a = k_a |v_a| ( c_L(α) w × v_s − c_D(α) v_s − c_Y v_aw w )`, α from v_s, w along the right wing.
    ///
    /// Without sideslip it is the planar force. (Not in the paper, which stays in the plane.)
    pub fn aerodynamic_force_in_space(&self, v_a: Frd) -> Frd {
        let v_a = Body::from(v_a);
        let air = AirData::new(v_a.in_plane(), self.thrust_line());
        let c = self.model().coefficients(air.alpha);
        let scale = self.k_a() * math::sqrt(v_a.norm_squared());
        let pressure = scale * air.speed;
        Body::new(
            pressure * (c.c_d * air.cos - c.c_l * air.sin),
            -pressure * (c.c_l * air.cos + c.c_d * air.sin),
            -scale * self.c_y() * v_a.w,
        )
        .into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{LargeAngle, LargeAngleParameters};
    use crate::error::{ParameterError, Problem};
    use crate::vehicle::VehicleParameters;

    fn vehicle(c_y: f32) -> Result<Vehicle<LargeAngle>, ParameterError> {
        let model = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        let p = VehicleParameters {
            c_y,
            ..VehicleParameters::PAPER
        };
        Vehicle::new(p, model)
    }

    /// φ-theory: with the large-angle model and δ = 0, `F_a = −k_a|v_a| (c0 I + 2 c1 j jᵀ + (c_Y − c0) w wᵀ) v_a`.
    #[test]
    fn the_large_angle_model_is_a_polynomial_of_the_air_velocity() {
        let LargeAngleParameters { c0, c1 } = LargeAngleParameters::NACA_0021_RE_160E3;
        let vehicle = vehicle(0.5).unwrap();
        for n in 0..2000 {
            let x = n as f32;
            let v = Body::new(
                (x * 0.7) % 31.0 - 15.0,
                (x * 1.1) % 29.0 - 14.0,
                x % 17.0 - 8.0,
            );
            let scale = -0.6460 * math::sqrt(v.norm_squared());
            let want = Body::new(c0 * v.i, (c0 + 2.0 * c1) * v.j, 0.5 * v.w) * scale;
            let error = Body::from(vehicle.aerodynamic_force_in_space(v.into())) - want;
            // 1e-3 N: a dozen roundings of forces up to 1000 N.
            assert!(math::sqrt(error.norm_squared()) < 1e-3, "{v:?}");
        }
    }

    #[test]
    fn a_side_force_that_pulls_is_refused() {
        let e = vehicle(-0.1).unwrap_err();
        assert_eq!((e.parameter, e.problem), ("c_y", Problem::OutOfRange));
        assert!(vehicle(f32::NAN).is_err() && vehicle(0.0).is_ok());
    }
}
