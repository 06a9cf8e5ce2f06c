//! Folds, where two equilibria meet and vanish, and how far away they are.
//!
//! On the ray of apparent weight (W_v, W_n) the numerator of ∂a/∂α, times |W|, is `c̄_L W_v + c̄_D W_n`, with the
//! equivalent coefficients of `eq:pGC`: a fold is where F_p = 0 at some airspeed, `k_a|v_a|² (c̄_D W_v − c̄_L W_n) = |W|²`.
//! The equivalent coefficients belong to the vehicle alone, and are constant where it is equivalent to a sphere: there
//! are no folds there.

use crate::aero::Aerodynamics;
use crate::air::{AirData, AngleOfAttack};
use crate::equivalency::{ApparentForces, equivalent_coefficients, lambda};
use crate::math;
use crate::vehicle::Vehicle;

/// Cells of the map around the circle, 1° each.
const CELLS: usize = 360;
const WIDTH: f32 = 2.0 * math::PI / CELLS as f32;
/// Nodes looked at by [`FoldMap::margin`]: the two around the state and [`REACH`] beyond them on either side.
const WINDOW: usize = 2 * REACH + 2;
const REACH: usize = 11;

/// How far the nearest fold is on the present ray, the direction of the air velocity and the apparent weight kept.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct FoldMargin {
    /// Angle of attack at the fold, less the present one \[rad\].
    pub alpha: f32,
    /// a at the fold over the present a, a = k_a|v_a|²/|W|: the square of the ratio of airspeeds.
    pub a: f32,
}

/// The equivalent coefficients of a vehicle around the circle. From them the margin to the nearest fold follows at
/// every control step, in constant time and without the coefficient model. 3 kB, built once.
#[derive(Clone, Debug, PartialEq)]
pub struct FoldMap {
    /// (c̄_L, c̄_D) at odd multiples of 0.5°, continued by half a window at both ends.
    nodes: [(f32, f32); CELLS + WINDOW],
}

impl FoldMap {
    /// How far [`margin`](Self::margin) sees, on either side \[rad\].
    pub const HORIZON: f32 = REACH as f32 * WIDTH;

    /// The map of `vehicle`: 384 evaluations of the coefficient model.
    pub fn new<A: Aerodynamics>(vehicle: &Vehicle<A>) -> Self {
        Self {
            nodes: core::array::from_fn(|i| {
                let cell = i as f32 - (CELLS / 2 + WINDOW / 2) as f32;
                let alpha = AngleOfAttack::from_radians((cell + 0.5) * WIDTH);
                let air = AirData::from_angle_of_attack(1.0, alpha, vehicle.thrust_line());
                let c = vehicle.model().coefficients(alpha);
                equivalent_coefficients(&c, &air, lambda(&c, &air))
            }),
        }
    }

    /// The margin to the nearest fold within [`HORIZON`](Self::HORIZON) of the present angle of attack, by linear
    /// interpolation between nodes 1° apart; two folds within a cell cancel out. `None` if there is none, or no air
    /// velocity or no apparent weight.
    pub fn margin(&self, forces: &ApparentForces) -> Option<FoldMargin> {
        let (air, c) = (&forces.air, &forces.coefficients);
        // F = W − k_a|v_a|² (c_D e_v − c_L e_n), e_v = (−cos, sin)(α+δ) and e_n = (−sin, −cos)(α+δ) in the body.
        let along = forces.f.j() * air.sin - forces.f.i() * air.cos + forces.pressure * c.c_d;
        let across = -(forces.f.i() * air.sin + forces.f.j() * air.cos) - forces.pressure * c.c_l;
        // Cells from the first node: never negative.
        let position = (air.alpha.rad + math::PI) / WIDTH + (WINDOW / 2) as f32 - 0.5;
        let center = position as usize;
        let within = position - center as f32;
        let window = self
            .nodes
            .get(center.wrapping_sub(REACH)..)?
            .first_chunk::<WINDOW>()?;
        // Bit k: whether the numerator, and the denominator, is negative at node k.
        let (mut numerators, mut denominators) = (0u32, 0u32);
        for (k, (c_l, c_d)) in window.iter().enumerate() {
            let numerator = c_l * along + c_d * across;
            let denominator = c_d * along - c_l * across;
            numerators |= (numerator.to_bits() >> 31) << k;
            denominators |= (denominator.to_bits() >> 31) << k;
        }
        // Bit k: a fold between nodes k and k + 1.
        let folds = (numerators ^ (numerators >> 1))
            & !(denominators | (denominators >> 1))
            & ((1 << (WINDOW - 1)) - 1);
        let weight_squared = along * along + across * across;
        let at = |cell: usize| {
            let (a, b) = (window.get(cell)?, window.get(cell + 1)?);
            let (na, nb) = (a.0 * along + a.1 * across, b.0 * along + b.1 * across);
            let t = na / (na - nb);
            let (c_l, c_d) = (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1));
            Some(FoldMargin {
                alpha: (cell as f32 - REACH as f32 + t - within) * WIDTH,
                a: weight_squared / (forces.pressure * (c_d * along - c_l * across)),
            })
        };
        let right = (folds >> REACH).trailing_zeros() as usize + REACH;
        let left = (31 - (folds & ((2 << REACH) - 1)).leading_zeros() as i32) as usize;
        match (at(left), at(right)) {
            (Some(l), Some(r)) if l.alpha.abs() < r.alpha.abs() => Some(l),
            (l, r) => r.or(l),
        }
        .filter(|margin| margin.a.is_finite())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{
        Combined, CombinedParameters, LargeAngle, LargeAngleParameters, NACA_0021_RE_160E3, Table,
    };
    use crate::equilibrium::Ratio;
    use crate::frame::{Attitude, Inertial};
    use crate::vehicle::VehicleParameters;
    use std::vec::Vec;

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

    fn combined() -> Combined {
        Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap()
    }

    /// A flight along a path.
    #[derive(Clone, Copy)]
    struct Flight {
        /// Angle below the horizon \[rad\].
        path: f32,
        /// [m/s].
        speed: f32,
        /// Acceleration forward [m/s²].
        forward: f32,
    }

    const fn steady(path: f32, speed: f32) -> Flight {
        Flight {
            path,
            speed,
            forward: 0.0,
        }
    }

    /// Forces in `flight` at `alpha`.
    fn forces<A: Aerodynamics>(vehicle: &Vehicle<A>, flight: Flight, alpha: f32) -> ApparentForces {
        let Flight {
            path,
            speed,
            forward,
        } = flight;
        let (sin, cos) = math::sin_cos(path);
        let v = Inertial::new(speed * sin, speed * cos);
        let gamma = libm::atan2f(v.forward(), v.down());
        let theta = alpha + gamma - math::PI + vehicle.thrust_line().delta();
        ApparentForces::new(
            vehicle,
            Attitude::from_angle(theta),
            v,
            Inertial::new(0.0, forward),
        )
    }

    /// (α, a) of the folds with a > 0 on the ray, by the sign of ∂a/∂α in steps of 0.02°.
    fn scan<A: Aerodynamics>(vehicle: &Vehicle<A>, beta: f32) -> Vec<(f32, f32)> {
        let at = |n: i32| {
            let alpha = AngleOfAttack::from_radians((n as f32 * 0.02 + 0.01).to_radians());
            (alpha.rad, Ratio::at(vehicle, alpha, beta))
        };
        (-9000..9000)
            .map(|n| (at(n), at(n + 1)))
            .filter(|(p, q)| p.1.derivative * q.1.derivative < 0.0 && p.1.a > 0.0 && q.1.a > 0.0)
            .map(|(p, q)| (0.5 * (p.0 + q.0), p.1.a))
            .collect()
    }

    fn check<A: Aerodynamics>(vehicle: &Vehicle<A>, worst: &mut (f32, f32), states: &mut usize) {
        let map = FoldMap::new(vehicle);
        for (path, forward) in [
            (0.0, 0.0),
            (-0.5, 0.0),
            (0.4, 1.0),
            (0.0, 3.0),
            (-1.2, -2.0),
        ] {
            let speed = 12.0;
            let flight = Flight {
                path,
                speed,
                forward,
            };
            let p = VehicleParameters::PAPER;
            let (down, back) = (p.gravity, -forward);
            let (sin, cos) = math::sin_cos(path);
            // β: from the air velocity to the apparent weight, positive towards S e_v.
            let beta = libm::atan2f(back * sin - down * cos, down * sin + back * cos);
            let weight = p.mass * math::sqrt(down * down + back * back);
            let a = p.k_a * speed * speed / weight;
            let folds = scan(vehicle, beta);
            for n in -179..180 {
                let alpha = (n as f32 + 0.3).to_radians();
                let margin = map.margin(&forces(vehicle, flight, alpha));
                let difference = |f: f32| {
                    let d = f - alpha;
                    d - 2.0 * math::PI * (d / (2.0 * math::PI)).round()
                };
                let nearest = folds
                    .iter()
                    .min_by(|x, y| difference(x.0).abs().total_cmp(&difference(y.0).abs()));
                match (margin, nearest) {
                    (Some(margin), Some((f, a_f))) => {
                        *states += 1;
                        let e = (margin.alpha.abs() - difference(*f).abs()).abs();
                        *worst = (
                            worst.0.max(e.to_degrees()),
                            worst.1.max((margin.a * a / a_f - 1.0).abs()),
                        );
                    }
                    // Beyond the horizon, or about to be.
                    (_, nearest) => {
                        let far = nearest.is_none_or(|f| {
                            difference(f.0).abs() > FoldMap::HORIZON - 0.2f32.to_radians()
                        });
                        assert!(far, "{n}° {path}: {margin:?} {nearest:?}");
                    }
                }
            }
        }
    }

    /// Against a scan of ∂a/∂α 50 times finer, which sees a fold 0.01° off at most. What is more is the linear
    /// interpolation between nodes.
    #[test]
    fn the_margin_is_the_distance_to_the_nearest_fold() {
        let (mut worst, mut states) = ((0.0, 0.0), 0);
        for delta in [0.0, 0.2, -0.4] {
            check(&vehicle(delta, combined()), &mut worst, &mut states);
        }
        std::println!("combined: {worst:?} of {states}");
        assert!(states > 100 && worst.0 < 0.2 && worst.1 < 0.01);
    }

    #[test]
    fn on_the_table_too() {
        let (mut worst, mut states) = ((0.0, 0.0), 0);
        check(
            &vehicle(0.0, Table::new(&NACA_0021_RE_160E3)),
            &mut worst,
            &mut states,
        );
        std::println!("table: {worst:?} of {states}");
        assert!(states > 100 && worst.0 < 0.6 && worst.1 < 0.02);
    }

    #[test]
    fn a_sphere_has_no_folds_and_neither_has_still_air() {
        let sphere = vehicle(
            0.3,
            LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap(),
        );
        let map = FoldMap::new(&sphere);
        for n in -179..180 {
            let alpha = (n as f32).to_radians();
            assert_eq!(map.margin(&forces(&sphere, steady(0.2, 12.0), alpha)), None);
        }
        let stalling = vehicle(0.0, combined());
        let map = FoldMap::new(&stalling);
        assert!(
            map.margin(&forces(&stalling, steady(0.0, 12.0), 0.2))
                .is_some()
        );
        assert_eq!(map.margin(&forces(&stalling, steady(0.0, 0.0), 0.2)), None);
        let mut broken = forces(&stalling, steady(0.0, 12.0), 0.2);
        broken.air.alpha.rad = f32::NAN;
        assert_eq!(map.margin(&broken), None);
    }

    /// Where numerator and denominator change sign between the same two nodes the fold may be at no airspeed: none is told. The map here is
    /// made by hand, and the flight is a vertical fall: the weight lies along the air velocity.
    #[test]
    fn a_fold_at_no_airspeed_is_none() {
        let vehicle = vehicle(0.0, combined());
        let forces = forces(&vehicle, steady(math::FRAC_PI_2, 12.0), 0.0087);
        // c_L is the numerator then, c_D the denominator.
        let map = |before: (f32, f32), after: (f32, f32)| FoldMap {
            nodes: core::array::from_fn(|i| {
                let middle = (CELLS + WINDOW) / 2;
                if i < middle + 3 { before } else { after }
            }),
        };
        let fold = map((-0.1, 0.5), (0.1, 0.5)).margin(&forces).unwrap();
        assert!((fold.alpha.to_degrees() - 2.5).abs() < 0.01, "{fold:?}");
        assert!((fold.a - 98.1 / (0.646 * 144.0 * 0.5)).abs() < 1e-4);
        for (before, after) in [
            // Of these the denominator at the zero of the numerator would be positive, but not all around it.
            ((-0.1, 0.5), (0.3, -0.5)),
            ((-0.3, -0.5), (0.1, 0.5)),
            ((-0.1, -0.5), (0.1, -0.5)),
            ((0.1, 0.5), (0.1, 0.5)),
        ] {
            assert_eq!(map(before, after).margin(&forces), None, "{before:?}");
        }
    }
}
