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
pub struct FoldMargin {
    /// Angle of attack at the fold, less the present one \[rad\].
    pub alpha: f32,
    /// a at the fold over the present a, a = k_a|v_a|²/|W|: the square of the ratio of airspeeds.
    pub a: f32,
}

/// The equivalent coefficients of a vehicle around the circle, from which the margin to the nearest fold follows at
/// every control step in constant time and without the coefficient model. 3 kB, built once.
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
        // Bit k: the numerator's sign, and the denominator's, at node k.
        let (mut negative, mut positive) = (0u32, 0u32);
        for (k, (c_l, c_d)) in window.iter().enumerate() {
            let numerator = c_l * along + c_d * across;
            let denominator = c_d * along - c_l * across;
            negative |= (numerator.to_bits() >> 31) << k;
            positive |= u32::from(denominator > 0.0) << k;
        }
        // Bit k: a fold between nodes k and k + 1.
        let mut folds = (negative ^ (negative >> 1)) & (positive & (positive >> 1));
        folds &= (1 << (WINDOW - 1)) - 1;
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
