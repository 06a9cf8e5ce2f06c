//! The set Θ of the equilibrium orientations of a reference.

use core::fmt;

use super::balance::{Balance, Residual};
use super::grid;
use crate::aero::Aerodynamics;
use crate::air::AngleOfAttack;
use crate::control::Reference;
use crate::equivalency::ApparentForces;
use crate::frame::{Attitude, Inertial};
use crate::math;
use crate::vehicle::Vehicle;

/// Most equilibria that a set can hold. The models and tables shipped have at most 10 at any reference.
pub const CAPACITY: usize = 16;

/// Most evaluations of the coefficient model in one [`Equilibria::find`].
pub const MAX_EVALUATIONS: usize = grid::N + CAPACITY * (DIG_STEPS + REFINE_STEPS + 1);

/// Steps taken to see whether F̄_2 crosses zero at an extremum between two nodes.
const DIG_STEPS: usize = 10;
/// Steps taken to refine an equilibrium: enough by bisections alone to bring 2.5° below 1e-6 rad.
const REFINE_STEPS: usize = 16;
/// Steps of the angle below this \[rad\] are roundings.
const RESOLUTION: f32 = 1.2e-7;
/// F̄_2, relative to the forces that balance in it, below which it is a rounding.
const ROUNDING: f32 = 1e-6;
/// |F_p|, relative to the same forces, below which an equilibrium is not called isolated.
const ISOLATED: f32 = 1e-5;

/// On which side of the thrust axis F_p lies at an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Branch {
    /// θ̃ = 0: T_p = |F_p|. The control laws stabilise this one.
    Aligned,
    /// θ̃ = π: T_p = −|F_p|.
    Opposed,
}

/// An orientation at which a thrust holds the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Equilibrium {
    /// Attitude θ_e.
    pub attitude: Attitude,
    /// Angle of attack α_e \[rad\]; 0 where there is no air velocity.
    pub alpha: f32,
    /// Thrust T = F·i \[N\]. It may be negative.
    pub thrust: f32,
    /// T_p = F_p·i \[N\], ±|F_p|; minus the derivative of F̄_2 with respect to θ.
    pub t_p: f32,
    /// Whether |F_p| > 0, beyond roundings (1e-5 of the forces in balance): then θ_e is isolated, and moves
    /// continuously with the reference (Theorem 3). It is not at a fold.
    pub isolated: bool,
}

impl Equilibrium {
    /// |F_p| \[N\].
    pub fn f_p_norm(&self) -> f32 {
        self.t_p.abs()
    }

    /// The branch it lies on.
    pub fn branch(&self) -> Branch {
        if self.t_p < 0.0 {
            Branch::Opposed
        } else {
            Branch::Aligned
        }
    }

    /// Whether it belongs to Θ⁺: T ≥ 0.
    pub fn is_in_theta_plus(&self) -> bool {
        self.thrust >= 0.0
    }
}

/// Why there is no set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EquilibriumError {
    /// The reference velocity is not finite, or absurdly large.
    ReferenceVelocity,
    /// The reference acceleration is not finite, or absurdly large.
    ReferenceAcceleration,
    /// The wind is not finite, or absurdly large.
    Wind,
    /// Every orientation is an equilibrium, to rounding: the "bad" velocity of Lemma 3, or free fall without air
    /// velocity.
    EveryOrientation,
    /// There are more than [`CAPACITY`] equilibria, or extrema of F̄_2 close to zero.
    Overflow,
}

impl fmt::Display for EquilibriumError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ReferenceVelocity => "reference velocity is not finite or absurdly large",
            Self::ReferenceAcceleration => "reference acceleration is not finite or absurdly large",
            Self::Wind => "wind is not finite or absurdly large",
            Self::EveryOrientation => "every orientation is an equilibrium",
            Self::Overflow => "there are more equilibria than the set can hold",
        })
    }
}

impl core::error::Error for EquilibriumError {}

/// The set Θ, by increasing angle of attack.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Equilibria(heapless::Vec<Equilibrium, CAPACITY>);

impl Equilibria {
    /// Every equilibrium orientation of `vehicle` at the `reference` in this `wind` [m/s].
    ///
    /// F̄_2 is sampled on a fixed grid; a change of its sign between two nodes is refined to single precision, and where
    /// only its derivative changes sign the extremum is looked at. Two equilibria closer than 0.1°, next to a fold, may
    /// be missed, and a pair that close be reported where the fold has just been left: it is what single precision
    /// makes of F̄_2. Coefficients that bend twice within a cell of the grid (0.5° up to α = 30°) may hide more. The
    /// work is bounded: at most [`MAX_EVALUATIONS`] evaluations of the model.
    ///
    /// # Errors
    /// The input that is not finite or absurd; [`EquilibriumError::EveryOrientation`];
    /// [`EquilibriumError::Overflow`]. Nothing is truncated.
    pub fn find<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        reference: &Reference,
        wind: Inertial,
    ) -> Result<Self, EquilibriumError> {
        let balance = Balance::new(vehicle, reference, wind)?;
        let brackets = brackets(&balance)?;
        let air_velocity = reference.velocity - wind;
        let mut set = heapless::Vec::new();
        for bracket in &brackets {
            let alpha = AngleOfAttack::from_radians(refine(&balance, bracket));
            let attitude = balance.attitude(alpha);
            let forces =
                ApparentForces::new(vehicle, attitude, air_velocity, reference.acceleration);
            let equilibrium = Equilibrium {
                attitude,
                alpha: forces.air.alpha.rad,
                thrust: forces.f.i(),
                t_p: forces.f_p.i(),
                isolated: forces.f_p.i().abs() > ISOLATED * balance.at(alpha).scale,
            };
            set.push(equilibrium)
                .map_err(|_| EquilibriumError::Overflow)?;
        }
        set.sort_unstable_by(|a: &Equilibrium, b| a.alpha.total_cmp(&b.alpha));
        Ok(Self(set))
    }

    /// The equilibria.
    pub fn as_slice(&self) -> &[Equilibrium] {
        &self.0
    }

    /// The equilibria with T ≥ 0: the set Θ⁺.
    pub fn theta_plus(&self) -> impl Iterator<Item = &Equilibrium> {
        self.0.iter().filter(|e| e.is_in_theta_plus())
    }
}

/// Angles of attack \[rad\] between which F̄_2 crosses zero once.
struct Bracket {
    from: f32,
    to: f32,
    /// Whether F̄_2 is negative at `from`.
    rising: bool,
}

/// Where F̄_2 crosses zero.
fn brackets<A: Aerodynamics>(
    balance: &Balance<A>,
) -> Result<heapless::Vec<Bracket, CAPACITY>, EquilibriumError> {
    const TURN: f32 = 2.0 * math::PI;
    let mut found = heapless::Vec::new();
    let (mut overflow, mut everywhere, mut digs) = (false, true, 0);
    let start = balance.at(grid::NODES[0]);
    let (mut alpha, mut here) = (grid::NODES[0].rad, start);
    for k in 1..=grid::N {
        // The last cell closes the circle, with the very first sample.
        let (next_alpha, next) = match grid::NODES.get(k) {
            Some(node) => (node.rad, balance.at(*node)),
            None => (grid::NODES[0].rad + TURN, start),
        };
        everywhere &= here.force.abs() <= ROUNDING * here.scale;
        let rising = here.force < 0.0;
        let mut keep = |from, to, rising| {
            overflow |= found.push(Bracket { from, to, rising }).is_err();
        };
        if rising != (next.force < 0.0) {
            keep(alpha, next_alpha, rising);
        } else if may_touch(&here, &next, next_alpha - alpha) {
            digs += 1;
            if digs <= CAPACITY {
                if let Some(middle) = dig(balance, alpha, next_alpha, rising) {
                    keep(alpha, middle, rising);
                    keep(middle, next_alpha, !rising);
                }
            } else {
                overflow = true;
            }
        }
        (alpha, here) = (next_alpha, next);
    }
    if everywhere {
        Err(EquilibriumError::EveryOrientation)
    } else if overflow {
        Err(EquilibriumError::Overflow)
    } else {
        Ok(found)
    }
}

/// Whether F̄_2, of one sign at both ends of a cell of this `width` \[rad\], turns back towards zero in between and
/// starts steeply enough, at either end, to reach it.
fn may_touch(a: &Residual, b: &Residual, width: f32) -> bool {
    let towards = if a.force < 0.0 { 1.0 } else { -1.0 };
    let (down, up) = (towards * a.slope, -towards * b.slope);
    down > 0.0 && up > 0.0 && (a.force.abs() <= width * down || b.force.abs() <= width * up)
}

/// An angle between `from` and `to` where the sign of F̄_2 is not `negative`, as at both ends, if there is one: by
/// Newton's steps, kept inside, to the extremum.
fn dig<A: Aerodynamics>(
    balance: &Balance<A>,
    mut from: f32,
    mut to: f32,
    negative: bool,
) -> Option<f32> {
    let mut x = 0.5 * (from + to);
    for _ in 0..DIG_STEPS {
        let at = balance.at(AngleOfAttack::from_radians(x));
        if (at.force < 0.0) != negative {
            return Some(x);
        }
        if (at.slope > 0.0) == negative {
            from = x;
        } else {
            to = x;
        }
        x = inside(x - at.slope / at.curvature, from, to);
    }
    None
}

/// The angle in the bracket where F̄_2 is zero.
fn refine<A: Aerodynamics>(balance: &Balance<A>, bracket: &Bracket) -> f32 {
    let (mut from, mut to) = (bracket.from, bracket.to);
    let mut step = to - from;
    let mut x = 0.5 * (from + to);
    for _ in 1..REFINE_STEPS {
        let at = balance.at(AngleOfAttack::from_radians(x));
        if (at.force < 0.0) == bracket.rising {
            from = x;
        } else {
            to = x;
        }
        let newton = x - at.force / at.slope;
        // Newton's step, unless it leaves the bracket or gains less than a bisection would.
        let next = if (newton - x).abs() < 0.5 * step.abs() {
            inside(newton, from, to)
        } else {
            0.5 * (from + to)
        };
        step = next - x;
        x = next;
        if step.abs() <= RESOLUTION {
            break;
        }
    }
    x
}

/// `x`, or the middle of [`from`, `to`] if it is not in between.
fn inside(x: f32, from: f32, to: f32) -> f32 {
    if from <= x && x <= to {
        x
    } else {
        0.5 * (from + to)
    }
}
