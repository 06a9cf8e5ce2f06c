//! The winged vehicle: a longitudinal model in the plane of symmetry, and a side force across it.

use super::vector::Body;
use crate::aero::Aerodynamics;
use crate::air::AirData;
use crate::error::{ParameterError, in_range};
use crate::math;
use crate::vehicle::Vehicle;

/// A vehicle with a wing, by strip theory: with v_s the part of v_a in the plane of symmetry and v_aw the part across,
///
/// `F_a = k_a |v_a| ( c_L(α) w × v_s − c_D(α) v_s − c_Y v_aw w )`, α from v_s.
///
/// Without sideslip it is the planar force. (Not in the paper, which stays in the plane.)
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WingedVehicle<A> {
    plane: Vehicle<A>,
    c_y: f32,
}

impl<A: Aerodynamics> WingedVehicle<A> {
    /// The vehicle that is `plane` in its plane of symmetry and has the side force coefficient `c_y` (c_Y ≥ 0, of
    /// the same reference area).
    ///
    /// # Errors
    /// `c_y` outside [0, 1e3] or not finite.
    pub fn new(plane: Vehicle<A>, c_y: f32) -> Result<Self, ParameterError> {
        Ok(Self {
            plane,
            c_y: in_range("c_y", c_y, 0.0, 1e3)?,
        })
    }

    /// The vehicle in its plane of symmetry.
    #[inline]
    pub fn plane(&self) -> &Vehicle<A> {
        &self.plane
    }

    /// Side force coefficient c_Y.
    #[inline]
    pub fn c_y(&self) -> f32 {
        self.c_y
    }

    /// k_a c_Y [kg/m].
    #[inline(always)]
    pub(super) fn side(&self) -> f32 {
        self.plane.k_a() * self.c_y
    }

    /// The vehicle in its plane of symmetry, alone.
    pub(super) fn into_plane(self) -> Vehicle<A> {
        self.plane
    }

    /// Aerodynamic force F_a \[N\] at an air velocity [m/s].
    pub fn aerodynamic_force(&self, v_a: Body) -> Body {
        let air = AirData::new(v_a.in_plane(), self.plane.thrust_line());
        let c = self.plane.model().coefficients(air.alpha);
        let scale = self.plane.k_a() * math::sqrt(v_a.norm_squared());
        let pressure = scale * air.speed;
        Body::new(
            pressure * (c.c_d * air.cos - c.c_l * air.sin),
            -pressure * (c.c_l * air.cos + c.c_d * air.sin),
            -scale * self.c_y * v_a.w,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{LargeAngle, LargeAngleParameters};
    use crate::error::Problem;
    use crate::vehicle::VehicleParameters;

    fn vehicle(c_y: f32) -> Result<WingedVehicle<LargeAngle>, ParameterError> {
        let model = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        WingedVehicle::new(Vehicle::new(VehicleParameters::PAPER, model).unwrap(), c_y)
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
            let error = vehicle.aerodynamic_force(v) - want;
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
