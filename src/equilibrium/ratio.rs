//! The equilibrium curve a(α; β), explicit on each ray of the apparent weight.

use crate::aero::Aerodynamics;
use crate::air::{AirData, AngleOfAttack};
use crate::math;
use crate::vehicle::Vehicle;

/// `a(α; β) = sin(α+δ−β) / (c_L cos(α+δ) + c_D sin(α+δ))` and its derivative: the ratio `a = k_a|v_a|²/|W|` at which the
/// angle of attack α is an equilibrium, β being the angle from the air velocity to the apparent weight W.
///
/// Level flight at constant speed is β = −90° (`eq:a(ae)`). A fold is a zero of the derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ratio {
    /// a. Where it is negative no airspeed makes this angle an equilibrium.
    pub a: f32,
    /// ∂a/∂α [1/rad].
    pub derivative: f32,
}

impl Ratio {
    /// a and ∂a/∂α at `alpha` on the ray `beta` \[rad\]; infinite or NaN where the aerodynamic force has no component
    /// across the thrust line.
    pub fn at<A: Aerodynamics>(vehicle: &Vehicle<A>, alpha: AngleOfAttack, beta: f32) -> Self {
        let air = AirData::from_angle_of_attack(1.0, alpha, vehicle.thrust_line());
        let c = vehicle.model().coefficients(alpha);
        let q = c.c_l * air.cos + c.c_d * air.sin;
        let dq = (c.dc_l + c.c_d) * air.cos + (c.dc_d - c.c_l) * air.sin;
        let (s, c) = math::sin_cos(beta);
        let (sin, cos) = (air.sin * c - air.cos * s, air.cos * c + air.sin * s);
        Self {
            a: sin / q,
            derivative: (cos * q - sin * dq) / (q * q),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::vehicle::VehicleParameters;

    fn vehicle(delta: f32) -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Vehicle::new(
            VehicleParameters {
                delta,
                ..VehicleParameters::PAPER
            },
            model,
        )
        .unwrap()
    }

    #[test]
    fn level_flight_is_the_papers_curve() {
        let vehicle = vehicle(0.0);
        for n in 1..90 {
            let alpha = AngleOfAttack::from_radians((n as f32).to_radians());
            let c = vehicle.model().coefficients(alpha);
            let cot = alpha.cos / alpha.sin;
            let a = cot / (c.c_d + c.c_l * cot);
            let ratio = Ratio::at(&vehicle, alpha, -math::FRAC_PI_2);
            // A few roundings; near 90° cot cancels.
            assert!(
                (ratio.a - a).abs() < 2e-6 * (1.0 + a),
                "{n}°: {} {a}",
                ratio.a
            );
        }
    }

    #[test]
    fn the_derivative_is_that_of_the_ratio() {
        for (delta, beta) in [(0.0, -1.5), (0.3, -1.0), (-0.7, 2.0), (1.2, 0.4)] {
            let vehicle = vehicle(delta);
            for n in 0..300 {
                let alpha = -3.1 + 0.0207 * n as f32;
                let at = |alpha| Ratio::at(&vehicle, AngleOfAttack::from_radians(alpha), beta);
                let (m, o, p) = (at(alpha - 1e-3), at(alpha), at(alpha + 1e-3));
                let difference = (p.a - m.a) / 2e-3;
                let scale = 1.0 + o.derivative.abs() + o.a * o.a;
                // Where the ratio is not about to diverge. 2e-2: h² of third derivatives up to 1e4 of the ratio.
                if o.a.abs() < 5.0 {
                    assert!(
                        (o.derivative - difference).abs() < 2e-2 * scale,
                        "{delta} {beta} {alpha}"
                    );
                }
            }
        }
    }

    /// The folds of level flight, by the sign of the derivative: the figures, to the step of the scan.
    #[test]
    fn the_folds_of_level_flight_are_where_the_derivative_changes_sign() {
        let vehicle = vehicle(0.0);
        let at = |n: i32| {
            let alpha = AngleOfAttack::from_radians((n as f32 * 0.01).to_radians());
            Ratio::at(&vehicle, alpha, -math::FRAC_PI_2)
        };
        let mut folds = (100..8900).filter(|n| at(*n).derivative * at(n + 1).derivative < 0.0);
        for (alpha, a) in [(1115, 1.30333), (1676, 1.52879)] {
            let n = folds.next().unwrap();
            assert!((n - alpha).abs() <= 1, "{n}");
            assert!((at(n).a - a).abs() < 1e-4);
        }
        assert_eq!(folds.next(), None);
    }
}
