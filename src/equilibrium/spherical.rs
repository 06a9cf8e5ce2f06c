//! The closed form for vehicles that are equivalent to a sphere (Lemma 3).

use core::fmt;

use super::existence::SAMPLES;
use crate::aero::Aerodynamics;
use crate::air::{AirData, AngleOfAttack};
use crate::control::Reference;
use crate::equivalency::{ApparentForces, condition_residual, equivalent_coefficients, lambda};
use crate::frame::{Attitude, Inertial};
use crate::math;
use crate::vehicle::Vehicle;

/// Residual of `eq:condition` taken for zero, relative to the magnitudes of the derivatives in it: some roundings of
/// second derivatives, which cancel themselves.
const TOLERANCE: f32 = 1e-5;

/// Why a vehicle has no generically-unique equilibrium orientation by Lemma 3.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NotSpherical {
    /// `eq:condition` does not hold.
    Condition {
        /// Where it is violated first \[rad\].
        alpha: f32,
        /// Its residual there.
        residual: f32,
    },
    /// c̄_D is not positive.
    EquivalentDrag {
        /// c̄_D.
        c_d: f32,
    },
}

impl fmt::Display for NotSpherical {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Condition { alpha, residual } => write!(
                f,
                "eq:condition leaves {residual} at an angle of attack of {}°",
                alpha.to_degrees()
            ),
            Self::EquivalentDrag { c_d } => {
                write!(f, "the equivalent drag coefficient, {c_d}, is not positive")
            }
        }
    }
}

impl core::error::Error for NotSpherical {}

/// A vehicle whose F_p does not depend on the attitude: two opposite equilibrium orientations at every reference
/// velocity but one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spherical<'a, A> {
    vehicle: &'a Vehicle<A>,
    c_l: f32,
    c_d: f32,
}

impl<'a, A: Aerodynamics> Spherical<'a, A> {
    /// `vehicle`, if `eq:condition` holds at [`SAMPLES`] angles around the circle and c̄_D > 0.
    ///
    /// # Errors
    /// What does not hold.
    pub fn new(vehicle: &'a Vehicle<A>) -> Result<Self, NotSpherical> {
        let mut mean = (0.0, 0.0);
        for n in 0..SAMPLES {
            let turn = (n as f32 + 0.5) / SAMPLES as f32 - 0.5;
            let alpha = AngleOfAttack::from_radians(2.0 * math::PI * turn);
            let air = AirData::from_angle_of_attack(1.0, alpha, vehicle.thrust_line());
            let c = vehicle.model().coefficients(alpha);
            let residual = condition_residual(&c, &air);
            let size = 1.0
                + c.ddc_l.abs()
                + c.ddc_d.abs()
                + 2.0 * (c.dc_l.abs() + c.dc_d.abs())
                + c.c_l.abs();
            if residual.abs() > TOLERANCE * size || residual.is_nan() {
                return Err(NotSpherical::Condition {
                    alpha: alpha.rad,
                    residual,
                });
            }
            let (c_l, c_d) = equivalent_coefficients(&c, &air, lambda(&c, &air));
            mean = (mean.0 + c_l, mean.1 + c_d);
        }
        let (c_l, c_d) = (mean.0 / SAMPLES as f32, mean.1 / SAMPLES as f32);
        if c_d > 0.0 {
            Ok(Self { vehicle, c_l, c_d })
        } else {
            Err(NotSpherical::EquivalentDrag { c_d })
        }
    }

    /// The equilibrium orientation on the branch θ̃ = 0, `θ_e = angle(i0, F_p)` (`thetaeTran`), and |F_p| \[N\], its T_p.
    /// The other is θ_e + π, with T_p = −|F_p|. `None` where F_p = 0: at the bad velocity.
    pub fn equilibrium(&self, reference: &Reference, wind: Inertial) -> Option<(Attitude, f32)> {
        // F_p is the same at every attitude: in this one body and inertial components agree.
        let forces = ApparentForces::new(
            self.vehicle,
            Attitude::NOSE_UP,
            reference.velocity - wind,
            reference.acceleration,
        );
        let norm = forces.f_p.norm();
        let attitude = Attitude {
            cos: forces.f_p.i() / norm,
            sin: forces.f_p.j() / norm,
        };
        // Below this F_p is what roundings left of its terms.
        let scale = forces.pressure * (forces.coefficients.c_l.abs() + forces.coefficients.c_d)
            + forces.lambda.abs() * forces.pressure
            + self.vehicle.mass() * self.vehicle.gravity();
        (norm > 1e-6 * scale).then_some((attitude, norm))
    }

    /// The bad velocity [m/s] in a `wind` at a reference acceleration [m/s²]: there F_p = 0 and every orientation is an
    /// equilibrium.
    ///
    /// The air velocity balances the apparent weight W by equivalent drag and lift, `|v_a|² = |W|/(k_a |c̄|)`, at the
    /// angle atan(c̄_L/c̄_D) from W: a vertical fall, but only if c̄_L = 0, as for δ = 0.
    pub fn bad_velocity(&self, acceleration: Inertial, wind: Inertial) -> Inertial {
        let (mass, gravity) = (self.vehicle.mass(), self.vehicle.gravity());
        let (down, forward) = (
            mass * (gravity - acceleration.down()),
            -mass * acceleration.forward(),
        );
        let c = math::sqrt(self.c_l * self.c_l + self.c_d * self.c_d);
        let weight = math::sqrt(down * down + forward * forward);
        // |v_a|/(|c̄| |W|): the products below are |c̄| |W| long. No weight, no velocity.
        let scale =
            math::sqrt(weight / (self.vehicle.k_a() * c)) / (c * weight + f32::MIN_POSITIVE);
        wind + Inertial::new(
            scale * (self.c_d * down - self.c_l * forward),
            scale * (self.c_l * down + self.c_d * forward),
        )
    }
}
