//! The balance across the thrust line, F̄_2, as a function of the angle of attack.

use super::set::EquilibriumError;
use crate::aero::Aerodynamics;
use crate::air::{AirData, AngleOfAttack, STILL};
use crate::equivalency::condition_residual;
use crate::frame::{Attitude, Inertial};
use crate::math;
use crate::reference::{MAX_ACCELERATION, MAX_SPEED, Reference};
use crate::vehicle::Vehicle;

/// A reference as the air sees it.
pub(super) struct Balance<'a, A> {
    vehicle: &'a Vehicle<A>,
    /// Direction e_v of the air velocity; down where there is none.
    direction: Inertial,
    /// W·e_v \[N\].
    along: f32,
    /// W·e_n \[N\].
    across: f32,
    /// k_a |v_a|² \[N\].
    pressure: f32,
    /// |W| \[N\].
    weight: f32,
}

/// F̄_2 at one angle of attack.
#[derive(Clone, Copy)]
pub(super) struct Residual {
    /// F̄_2 \[N\].
    pub force: f32,
    /// Its derivative with respect to θ, −F̄_p1 [N/rad].
    pub slope: f32,
    /// Its second derivative [N/rad²].
    pub curvature: f32,
    /// Sum of the magnitudes of the forces that balance in it \[N\].
    pub scale: f32,
}

impl<'a, A: Aerodynamics> Balance<'a, A> {
    pub fn new(
        vehicle: &'a Vehicle<A>,
        reference: &Reference,
        wind: Inertial,
    ) -> Result<Self, EquilibriumError> {
        let ok = |v: Inertial, max: f32| v.norm_squared() <= max * max;
        if !ok(reference.velocity, MAX_SPEED) {
            return Err(EquilibriumError::ReferenceVelocity);
        }
        if !ok(reference.acceleration, MAX_ACCELERATION) {
            return Err(EquilibriumError::ReferenceAcceleration);
        }
        if !ok(wind, MAX_SPEED) {
            return Err(EquilibriumError::Wind);
        }
        let v_a = reference.velocity - wind;
        let speed = math::sqrt(v_a.norm_squared());
        let direction = if speed > STILL {
            Inertial::new(v_a.down() / speed, v_a.forward() / speed)
        } else {
            Inertial::new(1.0, 0.0)
        };
        let (down, forward) = (
            vehicle.mass() * (vehicle.gravity() - reference.acceleration.down()),
            -vehicle.mass() * reference.acceleration.forward(),
        );
        Ok(Self {
            vehicle,
            direction,
            along: down * direction.down() + forward * direction.forward(),
            across: forward * direction.down() - down * direction.forward(),
            pressure: vehicle.k_a() * speed * speed,
            weight: math::sqrt(down * down + forward * forward),
        })
    }

    // Called from three places: one copy of the model in flash is enough.
    #[inline(never)]
    pub fn at(&self, alpha: AngleOfAttack) -> Residual {
        let air = AirData::from_angle_of_attack(1.0, alpha, self.vehicle.thrust_line());
        let c = self.vehicle.model().coefficients(alpha);
        let q = c.c_l * air.cos + c.c_d * air.sin;
        let dq = (c.dc_l + c.c_d) * air.cos + (c.dc_d - c.c_l) * air.sin;
        let force = self.along * air.sin - self.across * air.cos - self.pressure * q;
        Residual {
            force,
            slope: self.along * air.cos + self.across * air.sin - self.pressure * dq,
            curvature: -force - self.pressure * condition_residual(&c, &air),
            scale: self.weight + self.pressure * (c.c_l.abs() + c.c_d.abs()),
        }
    }

    /// The attitude at an angle of attack: θ = γ − π + α + δ, the one that turns (−cos(α+δ), sin(α+δ)) into e_v.
    pub fn attitude(&self, alpha: AngleOfAttack) -> Attitude {
        let air = AirData::from_angle_of_attack(1.0, alpha, self.vehicle.thrust_line());
        let (down, forward) = (self.direction.down(), self.direction.forward());
        Attitude {
            cos: forward * air.sin - down * air.cos,
            sin: -(down * air.sin + forward * air.cos),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::vehicle::VehicleParameters;

    /// The roundings of a balance are measured by the forces in it: |W| and k_a |v_a|² (|c_L| + |c_D|).
    #[test]
    fn the_scale_is_that_of_the_forces() {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
        let reference = Reference {
            velocity: Inertial::new(-1.0, 14.0),
            acceleration: Inertial::new(0.7, -1.3),
        };
        let balance = Balance::new(&vehicle, &reference, Inertial::new(0.5, 2.0)).unwrap();
        let weight = 10.0 * (9.81f64 - 0.7).hypot(1.3);
        let pressure = 0.646 * (1.5f64 * 1.5 + 12.0 * 12.0);
        for n in -31..31 {
            let alpha = AngleOfAttack::from_radians(0.1 * n as f32);
            let c = model.coefficients(alpha);
            let wanted = weight + pressure * f64::from(c.c_l.abs() + c.c_d.abs());
            let scale = f64::from(balance.at(alpha).scale);
            // 1e-6: a dozen roundings.
            assert!((scale / wanted - 1.0).abs() < 1e-6, "{n}");
        }
    }
}
