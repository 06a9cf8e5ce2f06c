//! The closed form for vehicles that are equivalent to a sphere (Lemma 3).

use core::fmt;

use super::existence::SAMPLES;
use crate::aero::Aerodynamics;
use crate::air::{AirData, AngleOfAttack};
use crate::equivalency::{ApparentForces, condition_residual, equivalent_coefficients, lambda};
use crate::frame::{Attitude, Inertial};
use crate::math;
use crate::reference::Reference;
use crate::vehicle::Vehicle;

/// Residual of `eq:condition` taken for zero, relative to the magnitudes of the derivatives in it: some roundings of
/// second derivatives, which cancel themselves.
const TOLERANCE: f32 = 1e-5;

/// Why a vehicle has no generically-unique equilibrium orientation by Lemma 3.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum NotSpherical {
    /// `eq:condition` does not hold.
    Condition {
        /// Where it is violated most \[rad\].
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
                "eq:condition leaves {residual:.3} at α = {:.1}°",
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
        let (mut mean, mut worst) = ((0.0f32, 0.0f32), (0.0f32, 0.0f32, 0.0f32));
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
            let excess = residual.abs() / size;
            if excess > worst.0 || excess.is_nan() {
                worst = (excess, alpha.rad, residual);
            }
            let (c_l, c_d) = equivalent_coefficients(&c, &air, lambda(&c, &air));
            // Step by step: a sum of so many would lose digits.
            let weight = 1.0 / (n + 1) as f32;
            mean.0 += weight * (c_l - mean.0);
            mean.1 += weight * (c_d - mean.1);
        }
        let ((excess, alpha, residual), (c_l, c_d)) = (worst, mean);
        if excess > TOLERANCE || excess.is_nan() {
            return Err(NotSpherical::Condition { alpha, residual });
        }
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

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{
        Coefficients, Combined, CombinedParameters, LargeAngle, LargeAngleParameters, SmallAngle,
        SmallAngleParameters,
    };
    use crate::equilibrium::{Branch, Equilibria, EquilibriumError};
    use crate::vehicle::VehicleParameters;

    fn vehicle<A: Aerodynamics>(delta: f32, model: A) -> Vehicle<A> {
        Vehicle::new(
            VehicleParameters {
                delta,
                ..VehicleParameters::PAPER
            },
            model,
        )
        .unwrap()
    }

    fn large() -> LargeAngle {
        LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap()
    }

    fn small() -> SmallAngle {
        SmallAngle::new(SmallAngleParameters {
            c0: 0.014,
            c2: 5.5,
            c3: 0.3,
        })
        .unwrap()
    }

    /// Lemma 3 against the set; `rounding` \[N\] is that of the largest force, λ k_a|v_a|².
    fn check<A: Aerodynamics>(vehicle: &Vehicle<A>, rounding: f32) {
        let sphere = Spherical::new(vehicle).unwrap();
        for n in 0..500 {
            let x = n as f32;
            let (s, c) = math::sin_cos(1.7 * x);
            let (t, _) = math::sin_cos(0.9 * x);
            let reference = Reference {
                velocity: Inertial::new(25.0 * s * t, 25.0 * c),
                acceleration: Inertial::new(3.0 * t, -2.0 * c),
            };
            let wind = Inertial::new(t, 4.0 * s);
            let (attitude, norm) = sphere.equilibrium(&reference, wind).unwrap();
            let set = Equilibria::find(vehicle, &reference, wind).unwrap();
            let [a, b] = set.as_slice() else {
                panic!("{} equilibria at {n}", set.as_slice().len())
            };
            let (one, other) = if a.t_p > 0.0 { (a, b) } else { (b, a) };
            assert_eq!(
                (one.branch(), other.branch()),
                (Branch::Aligned, Branch::Opposed)
            );
            let near = 1e-6 + rounding / norm;
            let turn = one.attitude.cos * attitude.sin - one.attitude.sin * attitude.cos;
            assert!(turn.abs() < near, "{n}: {turn} {norm}");
            let turn = other.attitude.cos * attitude.sin - other.attitude.sin * attitude.cos;
            assert!(turn.abs() < near && other.attitude.cos * attitude.cos <= near);
            assert!((one.t_p - norm).abs() < rounding && (other.t_p + norm).abs() < rounding);
        }
    }

    #[test]
    fn two_opposite_equilibria_and_the_closed_form_knows_them() {
        for delta in [0.0, 0.5, -1.2, 1.57] {
            check(&vehicle(delta, large()), 1e-3);
        }
        // λ is up to 12 here, and 2 there.
        check(&vehicle(0.0, small()), 1e-2);
    }

    #[test]
    fn at_the_bad_velocity_every_orientation_is_one() {
        for delta in [0.0, 0.5, -1.2] {
            let vehicle = vehicle(delta, large());
            let sphere = Spherical::new(&vehicle).unwrap();
            for (a_r, wind) in [
                (Inertial::ZERO, Inertial::ZERO),
                (Inertial::new(2.0, -5.0), Inertial::new(-1.0, 6.0)),
            ] {
                let velocity = sphere.bad_velocity(a_r, wind);
                let reference = Reference {
                    velocity,
                    acceleration: a_r,
                };
                assert_eq!(
                    Equilibria::find(&vehicle, &reference, wind),
                    Err(EquilibriumError::EveryOrientation)
                );
                assert_eq!(sphere.equilibrium(&reference, wind), None);
            }
            // A vertical fall only where the equivalent lift vanishes.
            let fall = sphere.bad_velocity(Inertial::ZERO, Inertial::ZERO);
            assert!(fall.down() > 0.0);
            assert_eq!(fall.forward().abs() < 1e-5, delta == 0.0, "{fall:?}");
        }
    }

    #[test]
    fn other_vehicles_are_told_why_not() {
        let combined = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let condition = |e| matches!(e, NotSpherical::Condition { .. });
        assert!(condition(
            Spherical::new(&vehicle(0.0, combined)).unwrap_err()
        ));
        assert!(condition(
            Spherical::new(&vehicle(0.1, small())).unwrap_err()
        ));
        /// A shape that the air drives: eq:condition holds, but with c̄_D < 0.
        struct Driven;
        impl Aerodynamics for Driven {
            fn coefficients(&self, _: AngleOfAttack) -> Coefficients {
                Coefficients {
                    c_d: -1.0,
                    ..Coefficients::default()
                }
            }
        }
        assert_eq!(
            Spherical::new(&vehicle(0.0, Driven)).err(),
            Some(NotSpherical::EquivalentDrag { c_d: -1.0 })
        );
    }

    /// F_p counts as zero below 1e-6 of the forces that it is made of: k_a |v_a|² times |c_L|, c_D and |λ|, and the weight. Here in f64, with
    /// each of them the greatest in turn.
    #[test]
    fn what_roundings_leave_is_no_force() {
        const GRAVITY: f32 = 0.5;
        let mut checked = [0, 0];
        for (c0, c1) in [(0.02f32, 0.9f32), (0.02, 0.1), (1.2, 0.1), (0.3, 4.0)] {
            let model = LargeAngle::new(LargeAngleParameters { c0, c1 }).unwrap();
            for mass in [0.05f32, 10.0, 400.0] {
                let p = VehicleParameters {
                    mass,
                    gravity: GRAVITY,
                    ..VehicleParameters::PAPER
                };
                let vehicle = Vehicle::new(p, model).unwrap();
                let sphere = Spherical::new(&vehicle).unwrap();
                for (speed, n) in [0.05f64, 0.7, 6.0, 40.0]
                    .iter()
                    .flat_map(|s| (0..24).map(move |n| (*s, n)))
                {
                    // Nose up, at the angle of attack α: towards (−cos α, sin α).
                    let alpha = f64::from(n) * 0.26 + 0.03;
                    let (down, forward) = (-libm::cos(alpha), libm::sin(alpha));
                    let velocity = Inertial::new((speed * down) as f32, (speed * forward) as f32);
                    let [c0, c1] = [c0, c1].map(f64::from);
                    let c_l = c1 * libm::sin(2.0 * alpha);
                    let c_d = c0 + 2.0 * c1 * libm::sin(alpha) * libm::sin(alpha);
                    let lambda = 2.0 * c1 * libm::cos(alpha);
                    let squared =
                        [velocity.down(), velocity.forward()].map(|v| f64::from(v).powi(2));
                    let pressure = 0.646 * (squared[0] + squared[1]);
                    let weight = f64::from(mass) * f64::from(GRAVITY);
                    let scale = pressure * (c_l.abs() + c_d + lambda.abs()) + weight;
                    // Acceleration at which only `left` of the forces is left: m (g − a) = k_a |v_a|² c̄_D e_v + left.
                    let drag = pressure * (c0 + 2.0 * c1) / f64::from(mass);
                    for left in [0.4e-6, 0.6e-6, 1.6e-6, 2.5e-6] {
                        let a = [
                            f64::from(GRAVITY) - drag * down - left * scale / f64::from(mass),
                            -drag * forward,
                        ];
                        let rounded = a.map(|x| x as f32);
                        let lost = [0, 1].map(|k| f64::from(mass) * (f64::from(rounded[k]) - a[k]));
                        // Where single precision cannot say the acceleration that exactly there is nothing to see.
                        if lost[0].abs() + lost[1].abs() > 0.1e-6 * scale || drag > 990.0 {
                            continue;
                        }
                        let reference = Reference {
                            velocity,
                            acceleration: Inertial::new(rounded[0], rounded[1]),
                        };
                        let equilibrium = sphere.equilibrium(&reference, Inertial::ZERO);
                        assert_eq!(
                            equilibrium.is_some(),
                            left > 1e-6,
                            "{c0} {c1} {mass} {speed} {n} {left}"
                        );
                        checked[usize::from(left > 1e-6)] += 1;
                    }
                }
            }
        }
        assert!(checked[0] > 1000 && checked[1] > 1000, "{checked:?}");
    }
}
