//! The set Θ of the equilibrium orientations of a reference.

use core::fmt;

use super::balance::{Balance, Residual};
use super::grid;
use crate::aero::Aerodynamics;
use crate::air::AngleOfAttack;
use crate::branch::Branch;
use crate::equivalency::ApparentForces;
use crate::frame::{Attitude, Inertial};
use crate::math;
use crate::reference::Reference;
use crate::vehicle::Vehicle;

/// Most equilibria that a set can hold. The shipped models and tables had at most 14 at any of 10^5 random references.
pub const CAPACITY: usize = 24;

/// Most evaluations of the coefficient model in one [`Equilibria::find`].
pub const MAX_EVALUATIONS: usize = grid::N + CAPACITY * (DIG_STEPS + REFINE_STEPS + 1);

/// Steps taken to see whether F̄_2 crosses zero at an extremum between two nodes.
const DIG_STEPS: usize = 10;
/// Steps taken to refine an equilibrium: enough by bisections alone to bring 2.5° below 1e-6 rad.
const REFINE_STEPS: usize = 16;
/// A Newton step below this \[rad\] is the last: it halves no more, being roundings.
const RESOLUTION: f32 = 4e-7;
/// F̄_2, relative to the forces that balance in it, below which nothing is said of its zeros: roundings of 3e-7 would
/// move them by 5°.
const ROUNDING: f32 = 4e-6;
/// |F_p|, relative to the same forces, below which an equilibrium is not called isolated.
const ISOLATED: f32 = 1e-5;

/// An orientation at which a thrust holds the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
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
#[non_exhaustive]
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
    /// F̄_2 is sampled on a fixed grid. A change of its sign between two nodes is refined to single precision. Where
    /// only its derivative changes sign, the extremum is looked at. Two equilibria closer than 0.1°, next to a fold,
    /// may be missed; a pair that close may be reported where the fold has just been left. That is what single
    /// precision makes of F̄_2: 0.008° was measured at the folds of the shipped models. Coefficients that bend twice
    /// within a cell of the grid (0.5° up to α = 30°) may hide more. The work is bounded: at most [`MAX_EVALUATIONS`]
    /// evaluations of the model.
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
        let mut set: heapless::Vec<Equilibrium, CAPACITY> = heapless::Vec::new();
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
        sort(&mut set);
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

/// Sorts by angle of attack: by insertion, for the library's sort holds a panic.
fn sort(set: &mut [Equilibrium]) {
    for n in 1..set.len() {
        for k in (1..=n).rev() {
            if let Some([a, b]) = set.get_mut(k - 1..=k)
                && a.alpha > b.alpha
            {
                core::mem::swap(a, b);
            }
        }
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
    let mut brackets = heapless::Vec::new();
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
            overflow |= brackets.push(Bracket { from, to, rising }).is_err();
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
        Ok(brackets)
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
        let newton = at.force / at.slope;
        if newton.abs() <= RESOLUTION {
            return inside(x - newton, from, to);
        }
        // Newton's step, unless it leaves the bracket or gains less than a bisection would.
        let next = if newton.abs() < 0.5 * step.abs() {
            inside(x - newton, from, to)
        } else {
            0.5 * (from + to)
        };
        step = next - x;
        x = next;
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

#[cfg(test)]
mod search;

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{
        Coefficients, Combined, CombinedParameters, LargeAngle, LargeAngleParameters,
        NACA_0021_RE_160E3, Table,
    };
    use crate::control::State;
    use crate::vehicle::VehicleParameters;
    use core::cell::Cell;
    use std::vec::Vec;

    const P: VehicleParameters = VehicleParameters::PAPER;

    fn combined(delta: f32) -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Vehicle::new(VehicleParameters { delta, ..P }, model).unwrap()
    }

    /// Level flight at the airspeed that gives `a`.
    fn level(a: f32) -> Reference {
        let speed = math::sqrt(a * P.mass * P.gravity / P.k_a);
        Reference {
            velocity: Inertial::new(0.0, speed),
            acceleration: Inertial::ZERO,
        }
    }

    fn between_0_and_90<A: Aerodynamics>(vehicle: &Vehicle<A>, a: f32) -> usize {
        let set = Equilibria::find(vehicle, &level(a), Inertial::ZERO).unwrap();
        let positive = |e: &&Equilibrium| e.alpha > 0.0 && e.alpha < math::FRAC_PI_2;
        set.as_slice().iter().filter(positive).count()
    }

    #[test]
    fn level_flight_has_one_then_three_then_one() {
        let vehicle = combined(0.0);
        for (a, n) in [
            (0.5, 1),
            (1.30, 1),
            (1.307, 3),
            (1.4, 3),
            (1.525, 3),
            (1.532, 1),
            (20.0, 1),
        ] {
            assert_eq!(between_0_and_90(&vehicle, a), n, "{a}");
        }
    }

    #[test]
    fn on_the_table_there_are_five_between_the_inner_folds() {
        let vehicle = Vehicle::new(P, Table::new(&NACA_0021_RE_160E3)).unwrap();
        for (a, n) in [
            (1.32, 1),
            (1.338, 3),
            (1.345, 5),
            (1.36, 3),
            (1.45, 3),
            (1.47, 1),
        ] {
            assert_eq!(between_0_and_90(&vehicle, a), n, "{a}");
        }
    }

    /// Air velocities whose squares are below the least number have no direction: α = 0, as in [`AirData`].
    #[test]
    fn the_faintest_air_velocity_leaves_attitudes_of_unit_length() {
        for speed in [1e-24f32, 1e-22, 3e-20, 1e-14, 1e-10] {
            let reference = Reference {
                velocity: Inertial::new(0.6 * speed, 0.8 * speed),
                acceleration: Inertial::new(0.3, -1.0),
            };
            let set = Equilibria::find(&combined(0.3), &reference, Inertial::ZERO).unwrap();
            // Nothing but the weight: nose along the thrust needed, or against it.
            assert_eq!(set.as_slice().len(), 2);
            for e in set.as_slice() {
                let Attitude { cos, sin } = e.attitude;
                assert!(
                    (cos * cos + sin * sin - 1.0).abs() < 1e-6,
                    "{speed:e}: {e:?}"
                );
                // 1e-4 N: roundings of 95 N.
                assert!((e.thrust.abs() - 10.0 * 9.51f32.hypot(1.0)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn each_is_an_equilibrium_with_its_thrust_branch_and_angles() {
        for delta in [0.0, 0.4, -1.1] {
            let vehicle = combined(delta);
            for (down, forward) in [(0.0, 14.6), (-6.0, 9.0), (12.0, 1.0), (3.0, -20.0)] {
                let reference = Reference {
                    velocity: Inertial::new(down, forward),
                    acceleration: Inertial::new(1.0, -0.5),
                };
                let wind = Inertial::new(0.3, -2.0);
                let set = Equilibria::find(&vehicle, &reference, wind).unwrap();
                assert!(!set.as_slice().is_empty());
                for e in set.as_slice() {
                    // The law at the equilibrium: no error, so its rate is its alignment term alone.
                    let state = State {
                        velocity: reference.velocity,
                        attitude: e.attitude,
                        wind,
                    };
                    let forces = ApparentForces::new(
                        &vehicle,
                        state.attitude,
                        reference.velocity - wind,
                        reference.acceleration,
                    );
                    // Roundings of forces up to 600 N.
                    assert!(forces.f.j().abs() < 1e-3, "{}", forces.f.j());
                    assert_eq!((forces.f.i(), forces.f_p.i()), (e.thrust, e.t_p));
                    assert!((forces.air.alpha.rad - e.alpha).abs() < 1e-6);
                    assert!((e.f_p_norm() - forces.f_p.norm()).abs() < 1e-3);
                    assert_eq!(e.branch() == Branch::Aligned, e.t_p >= 0.0);
                    assert!(e.isolated);
                }
                let plus = set.as_slice().iter().filter(|e| e.thrust >= 0.0).count();
                assert_eq!(set.theta_plus().count(), plus);
            }
        }
    }

    /// Theorem 3: ∂_θ(F̄_2) = −F̄_p1, here of the samples, against differences; and the second derivative.
    #[test]
    fn the_residuals_derivatives_are_those_of_the_residual() {
        let vehicle = combined(0.3);
        let reference = Reference {
            velocity: Inertial::new(4.0, 11.0),
            acceleration: Inertial::new(0.0, 2.0),
        };
        let balance = Balance::new(&vehicle, &reference, Inertial::ZERO).unwrap();
        for n in 0..300 {
            let alpha = -3.1 + 0.0207 * n as f32;
            let at = |a| balance.at(AngleOfAttack::from_radians(a));
            let (m, o, p) = (at(alpha - 2e-3), at(alpha), at(alpha + 2e-3));
            let (slope, curvature) = ((p.force - m.force) / 4e-3, (p.slope - m.slope) / 4e-3);
            // 2e-6 × third (fourth) derivatives up to 2e3 (2e5) of 90 N.
            assert!(
                (o.slope - slope).abs() < 0.5 + 1e-3 * o.slope.abs(),
                "{} {slope}",
                o.slope
            );
            assert!((o.curvature - curvature).abs() < 40.0 + 1e-2 * o.curvature.abs());
        }
    }

    #[test]
    fn in_still_air_the_thrust_is_along_the_apparent_weight() {
        let set = Equilibria::find(&combined(0.2), &Reference::default(), Inertial::ZERO).unwrap();
        let [a, b] = set.as_slice() else { panic!() };
        let (up, down) = if a.thrust > 0.0 { (a, b) } else { (b, a) };
        assert!((up.thrust - 98.1).abs() < 1e-4 && (down.thrust + 98.1).abs() < 1e-4);
        assert!(up.attitude.angle().abs() < 1e-6 && up.alpha == 0.0);
        assert_eq!(
            (up.branch(), down.branch()),
            (Branch::Aligned, Branch::Opposed)
        );
        // Accelerating forward at g: nose 45° down from the zenith.
        let reference = Reference {
            acceleration: Inertial::new(0.0, 9.81),
            ..Reference::default()
        };
        let set = Equilibria::find(&combined(0.2), &reference, Inertial::ZERO).unwrap();
        let up = set.theta_plus().next().unwrap();
        assert!((up.attitude.angle() + core::f32::consts::FRAC_PI_4).abs() < 1e-6);
    }

    /// Vertical flight at δ = 0: the equilibria lie on the axis of symmetry, one of them at α = ±π, found once.
    #[test]
    fn equilibria_on_the_axis_are_found_once() {
        let vehicle = combined(0.0);
        for down in [-25.0, -3.0, 2.0, 6.0] {
            let reference = Reference {
                velocity: Inertial::new(down, 0.0),
                acceleration: Inertial::ZERO,
            };
            let set = Equilibria::find(&vehicle, &reference, Inertial::ZERO).unwrap();
            let at = |axis: f32| {
                let near = |e: &&Equilibrium| (e.alpha.abs() - axis).abs() < 1e-5;
                set.as_slice().iter().filter(near).count()
            };
            assert_eq!((at(0.0), at(math::PI)), (1, 1), "{down}: {set:?}");
        }
    }

    #[test]
    fn a_reference_held_by_every_orientation_is_an_error_of_its_own() {
        let free_fall = Reference {
            velocity: Inertial::ZERO,
            acceleration: Inertial::new(9.81, 0.0),
        };
        let find = |r: &Reference| Equilibria::find(&combined(0.0), r, Inertial::ZERO);
        assert_eq!(find(&free_fall), Err(EquilibriumError::EveryOrientation));
        // Lemma 3's bad velocity: a fall at which drag c0 + 2c1 holds the weight.
        let p = LargeAngleParameters::NACA_0021_RE_160E3;
        let vehicle = Vehicle::new(P, LargeAngle::new(p).unwrap()).unwrap();
        let speed = math::sqrt(98.1 / (P.k_a * (p.c0 + 2.0 * p.c1)));
        let fall = |speed| Reference {
            velocity: Inertial::new(speed, 0.0),
            acceleration: Inertial::ZERO,
        };
        let find = |r: &Reference| Equilibria::find(&vehicle, r, Inertial::ZERO);
        assert_eq!(find(&fall(speed)), Err(EquilibriumError::EveryOrientation));
        assert_eq!(find(&fall(speed * 1.001)).unwrap().as_slice().len(), 2);
    }

    #[test]
    fn bad_input_is_named() {
        let find = |velocity, acceleration, wind| {
            let reference = Reference {
                velocity,
                acceleration,
            };
            Equilibria::find(&combined(0.0), &reference, wind).unwrap_err()
        };
        let (o, nan) = (Inertial::ZERO, Inertial::new(f32::NAN, 0.0));
        assert_eq!(find(nan, o, o), EquilibriumError::ReferenceVelocity);
        assert_eq!(find(o, nan, o), EquilibriumError::ReferenceAcceleration);
        assert_eq!(find(o, o, Inertial::new(0.0, 1e9)), EquilibriumError::Wind);
    }

    /// Lift and drag that undulate `n` times around the circle.
    struct Undulating<'a> {
        n: f32,
        lift: f32,
        evaluations: &'a Cell<usize>,
    }

    impl Aerodynamics for Undulating<'_> {
        fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
            self.evaluations.set(self.evaluations.get() + 1);
            let (s, c) = math::sin_cos(self.n * alpha.rad);
            let (l, n) = (self.lift, self.n);
            Coefficients {
                c_l: l * s,
                c_d: 2.0 * l + l * c,
                dc_l: l * n * c,
                dc_d: -l * n * s,
                ddc_l: -l * n * n * s,
                ddc_d: -l * n * n * c,
            }
        }
    }

    #[test]
    fn too_many_are_an_error_and_the_work_is_bounded() {
        let evaluations = Cell::new(0);
        let (mut worst, mut overflows) = (0, 0);
        // From calm to wild, and to undulations that alias with the grid.
        for n in 0..400 {
            for lift in [0.02, 0.3, 3.0] {
                let model = Undulating {
                    n: n as f32,
                    lift,
                    evaluations: &evaluations,
                };
                let vehicle = Vehicle::new(VehicleParameters { delta: 0.5, ..P }, model).unwrap();
                for a in [0.3, 1.0, 30.0] {
                    evaluations.set(0);
                    match Equilibria::find(&vehicle, &level(a), Inertial::ZERO) {
                        Ok(set) => assert!(set.as_slice().len() <= CAPACITY),
                        Err(e) => {
                            assert_eq!(e, EquilibriumError::Overflow);
                            overflows += 1;
                        }
                    }
                    worst = worst.max(evaluations.get());
                }
            }
        }
        std::println!("at most {worst} of {MAX_EVALUATIONS} evaluations, {overflows} overflows");
        assert!(worst <= MAX_EVALUATIONS && overflows > 100);
        // The bound is not idle: the worst case uses more than half of what it adds to the grid.
        assert!(worst > grid::N + CAPACITY * (DIG_STEPS + REFINE_STEPS) / 4);
    }

    /// At a fold two equilibria meet: just beside it they are found although they lie in one cell of the grid, which is 0.5° wide at the finest.
    #[test]
    fn two_that_meet_at_a_fold_are_found_in_one_cell() {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = Vehicle::new(P, model).unwrap();
        let at = |speed: f32| {
            let reference = Reference {
                velocity: Inertial::new(0.0, speed),
                acceleration: Inertial::ZERO,
            };
            Equilibria::find(&vehicle, &reference, Inertial::ZERO).unwrap()
        };
        let count = |speed: f32| at(speed).as_slice().len();
        let mut folds = 0;
        for n in 0..40 {
            let (mut low, mut high) = (10.0 + 0.25 * n as f32, 10.25 + 0.25 * n as f32);
            let (few, many) = (count(low), count(high));
            if few == many {
                continue;
            }
            for _ in 0..12 {
                let middle = 0.5 * (low + high);
                if count(middle) == few {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let set = at(if few > many { low } else { high });
            let pairs = set.as_slice().windows(2);
            let nearest = pairs.map(|e| e[1].alpha - e[0].alpha).fold(1.0, f32::min);
            assert!(nearest < 0.3 * 0.5f32.to_radians(), "{low} {nearest}");
            folds += 1;
        }
        assert_eq!(folds, 2);
    }

    #[test]
    fn the_set_is_ordered_by_angle_of_attack() {
        let vehicle = Vehicle::new(P, Table::new(&NACA_0021_RE_160E3)).unwrap();
        let set = Equilibria::find(&vehicle, &level(1.345), Inertial::ZERO).unwrap();
        let angles: Vec<f32> = set.as_slice().iter().map(|e| e.alpha).collect();
        assert!(angles.is_sorted() && angles.len() >= 6, "{angles:?}");
    }
}
