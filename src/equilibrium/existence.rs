//! What holds for every reference: the theorems of existence, as functions that answer with the reason.
//!
//! A model is a function, and a function is sampled: at [`SAMPLES`] equidistant angles around the circle. What is said of
//! symmetry and passivity is said of these angles, to [`TOLERANCE`]; a model could differ in between by as much as it
//! bends within 0.5°.

use core::fmt;

use crate::aero::{Aerodynamics, Coefficients};
use crate::air::AngleOfAttack;
use crate::math;
use crate::vehicle::Vehicle;

/// Samples around the circle, 0.5° apart.
pub const SAMPLES: usize = 720;
/// Differences of coefficients taken for zero: a few roundings.
pub const TOLERANCE: f32 = 1e-5;

/// What the hypotheses of a theorem that are met guarantee for every reference.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Guarantee {
    /// At least two equilibrium orientations (Theorem 1 i).
    Two,
    /// At least one equilibrium orientation with T ≥ 0, whatever δ (Theorem 1 ii).
    OneWithThrust,
    /// At least one equilibrium orientation, whatever δ (Theorem 2).
    One {
        /// Smallest α_s \[rad\].
        from: f32,
        /// Largest α_s of the interval that begins there \[rad\].
        to: f32,
    },
}

/// Why a theorem says nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Unmet {
    /// c_L is not odd, or c_D not even.
    NotSymmetric {
        /// Where \[rad\].
        alpha: f32,
    },
    /// The coefficients do not repeat after half a turn.
    NotBisymmetric {
        /// Where \[rad\].
        alpha: f32,
    },
    /// The thrust is not parallel to the axis of symmetry.
    ThrustNotParallel {
        /// δ \[rad\].
        delta: f32,
    },
    /// c_D(π) > c_D(0) does not hold.
    ReverseDrag {
        /// c_D(0).
        forward: f32,
        /// c_D(π).
        reverse: f32,
    },
    /// No α_s in (0, 90°) has c_L > 0 and tan α_s ≤ (c_D(α_s) − c_D(π))/c_L(α_s).
    NoStallAngle,
    /// The drag is negative: the air would do work.
    NotPassive {
        /// Where \[rad\].
        alpha: f32,
        /// c_D there.
        c_d: f32,
    },
}

impl fmt::Display for Guarantee {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Two => f.write_str("at least two equilibrium orientations at every reference"),
            Self::OneWithThrust => f.write_str(
                "at least one equilibrium orientation with non-negative thrust at every reference, whatever δ",
            ),
            Self::One { from, to } => write!(
                f,
                "at least one equilibrium orientation at every reference, whatever δ (α_s from {:.1}° to {:.1}°)",
                from.to_degrees(),
                to.to_degrees()
            ),
        }
    }
}

impl fmt::Display for Unmet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotSymmetric { alpha } => {
                write!(
                    f,
                    "the section is not symmetric at α = {:.1}°",
                    alpha.to_degrees()
                )
            }
            Self::NotBisymmetric { alpha } => {
                write!(
                    f,
                    "the section is not bisymmetric at α = {:.1}°",
                    alpha.to_degrees()
                )
            }
            Self::ThrustNotParallel { delta } => write!(
                f,
                "the thrust is not parallel to the axis of symmetry (δ = {:.2}°)",
                delta.to_degrees()
            ),
            Self::ReverseDrag { forward, reverse } => {
                write!(f, "c_D(180°) = {reverse} is not above c_D(0) = {forward}")
            }
            Self::NoStallAngle => f.write_str("no α_s in (0, 90°) satisfies eq:conditionMuNe0"),
            Self::NotPassive { alpha, c_d } => {
                write!(
                    f,
                    "c_D = {c_d} is negative at α = {:.1}°",
                    alpha.to_degrees()
                )
            }
        }
    }
}

/// Theorem 1 i: a symmetric section, thrust parallel to its axis.
///
/// # Errors
/// The hypothesis that is not met.
pub fn theorem_1_symmetric<A: Aerodynamics>(vehicle: &Vehicle<A>) -> Result<Guarantee, Unmet> {
    symmetric(vehicle.model())?;
    let delta = vehicle.thrust_line().delta();
    if math::sin_cos(delta).0.abs() > TOLERANCE {
        return Err(Unmet::ThrustNotParallel { delta });
    }
    Ok(Guarantee::Two)
}

/// Theorem 1 ii: a bisymmetric section, any thrust line.
///
/// # Errors
/// The hypothesis that is not met.
pub fn theorem_1_bisymmetric<A: Aerodynamics>(model: &A) -> Result<Guarantee, Unmet> {
    symmetric(model)?;
    for n in 0..SAMPLES / 2 {
        let (a, b) = (sample(model, n), sample(model, n + SAMPLES / 2));
        if !same(a.c_l, b.c_l) || !same(a.c_d, b.c_d) {
            return Err(Unmet::NotBisymmetric { alpha: angle(n) });
        }
    }
    Ok(Guarantee::OneWithThrust)
}

/// Theorem 2: a symmetric section that stalls, any thrust line.
///
/// # Errors
/// The hypothesis that is not met.
pub fn theorem_2<A: Aerodynamics>(model: &A) -> Result<Guarantee, Unmet> {
    symmetric(model)?;
    let at = |alpha: f32| model.coefficients(AngleOfAttack::from_radians(alpha));
    let (forward, reverse) = (at(0.0).c_d, at(math::PI).c_d);
    // More than roundings: the models of the paper have c_D(π) = c_D(0).
    if reverse - forward <= TOLERANCE * forward {
        return Err(Unmet::ReverseDrag { forward, reverse });
    }
    // c_L sin α_s ≤ (c_D − c_D(π)) cos α_s, which is eq:conditionMuNe0 times c_L cos α_s > 0.
    let holds = |alpha: f32| {
        let (c, (sin, cos)) = (at(alpha), math::sin_cos(alpha));
        c.c_l > 0.0 && c.c_l * sin <= (c.c_d - reverse) * cos
    };
    let quarter = SAMPLES / 4;
    let angle = |n: usize| math::FRAC_PI_2 * n as f32 / quarter as f32;
    let Some(first) = (1..quarter).find(|n| holds(angle(*n))) else {
        return Err(Unmet::NoStallAngle);
    };
    let last = (first + 1..quarter)
        .find(|n| !holds(angle(*n)))
        .unwrap_or(quarter)
        - 1;
    Ok(Guarantee::One {
        from: edge(angle(first), angle(first - 1), holds),
        to: edge(angle(last), angle(last + 1), holds),
    })
}

/// Passivity of the aerodynamic force (`dissipativity`), which is c_D ≥ 0: true of real wings, and not enough for an
/// equilibrium to exist (Lemma 1).
///
/// # Errors
/// Where it does not hold.
pub fn passive<A: Aerodynamics>(model: &A) -> Result<(), Unmet> {
    for n in 0..SAMPLES {
        let c_d = sample(model, n).c_d;
        if c_d.is_nan() || c_d < 0.0 {
            return Err(Unmet::NotPassive {
                alpha: angle(n),
                c_d,
            });
        }
    }
    Ok(())
}

/// c_L odd and c_D even. By continuity c_L(0) = c_L(π) = 0 then.
fn symmetric<A: Aerodynamics>(model: &A) -> Result<(), Unmet> {
    for n in 0..SAMPLES / 2 {
        let (a, b) = (sample(model, n), sample(model, SAMPLES - 1 - n));
        if !same(a.c_l, -b.c_l) || !same(a.c_d, b.c_d) {
            return Err(Unmet::NotSymmetric { alpha: angle(n) });
        }
    }
    Ok(())
}

fn same(a: f32, b: f32) -> bool {
    (a - b).abs() <= TOLERANCE * (1.0 + a.abs())
}

/// Angle of sample `n` \[rad\]: off the axes, so that each has its mirror image.
fn angle(n: usize) -> f32 {
    2.0 * math::PI * ((n as f32 + 0.5) / SAMPLES as f32 - 0.5)
}

fn sample<A: Aerodynamics>(model: &A, n: usize) -> Coefficients {
    model.coefficients(AngleOfAttack::from_radians(angle(n)))
}

/// The end, between `inside` and `outside`, of the interval where `holds`.
fn edge(mut inside: f32, mut outside: f32, holds: impl Fn(f32) -> bool) -> f32 {
    for _ in 0..16 {
        let middle = 0.5 * (inside + outside);
        if holds(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{
        Combined, CombinedParameters, LargeAngle, LargeAngleParameters, NACA_0021_RE_5E6,
        NACA_0021_RE_160E3, Node, Polar, SmallAngle, SmallAngleParameters, Table,
    };
    use crate::equilibrium::Equilibria;
    use crate::frame::Inertial;
    use crate::reference::Reference;
    use crate::vehicle::VehicleParameters;

    const P: VehicleParameters = VehicleParameters::PAPER;

    fn combined() -> Combined {
        Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap()
    }

    fn large() -> LargeAngle {
        LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap()
    }

    /// The Lemma 1 counter-example (`PcoefficientsPassNoEqui`).
    struct Unholdable {
        c0: f32,
    }

    impl Aerodynamics for Unholdable {
        fn coefficients(&self, a: AngleOfAttack) -> Coefficients {
            Coefficients {
                c_l: a.sin,
                c_d: self.c0 + 1.0 - a.cos,
                dc_l: a.cos,
                dc_d: a.sin,
                ddc_l: -a.sin,
                ddc_d: a.cos,
            }
        }
    }

    /// Random-looking references, winds included.
    fn references() -> impl Iterator<Item = (Reference, Inertial)> {
        (0..4000).map(|n| {
            // At most 8192 rad: 4000 times 2.3 is more.
            let wave = |k: f32| math::sin_cos(0.8 * k * n as f32).0;
            let reference = Reference {
                velocity: Inertial::new(30.0 * wave(1.3), 30.0 * wave(0.71)),
                acceleration: Inertial::new(8.0 * wave(2.3), 8.0 * wave(1.9)),
            };
            (
                reference,
                Inertial::new(5.0 * wave(0.37), 10.0 * wave(0.53)),
            )
        })
    }

    #[test]
    fn theorem_1_i_two_for_symmetric_sections_with_parallel_thrust() {
        fn check<A: Aerodynamics>(model: A) {
            let vehicle = Vehicle::new(P, model).unwrap();
            assert_eq!(theorem_1_symmetric(&vehicle), Ok(Guarantee::Two));
            for (reference, wind) in references() {
                let set = Equilibria::find(&vehicle, &reference, wind).unwrap();
                assert!(set.as_slice().len() >= 2, "{reference:?}");
            }
        }
        check(combined());
        check(large());
        check(Table::new(&NACA_0021_RE_160E3));
        check(Table::new(&NACA_0021_RE_5E6));
        let inclined = Vehicle::new(VehicleParameters { delta: 0.1, ..P }, combined()).unwrap();
        assert_eq!(
            theorem_1_symmetric(&inclined),
            Err(Unmet::ThrustNotParallel { delta: 0.1 })
        );
        // Thrust towards the trailing edge is parallel too.
        let reversed = VehicleParameters {
            delta: math::PI,
            ..P
        };
        let vehicle = Vehicle::new(reversed, combined()).unwrap();
        assert_eq!(theorem_1_symmetric(&vehicle), Ok(Guarantee::Two));
    }

    #[test]
    fn theorem_1_ii_one_with_thrust_for_bisymmetric_sections() {
        let small = SmallAngle::new(SmallAngleParameters {
            c0: 0.014,
            c2: 5.5,
            c3: 0.3,
        })
        .unwrap();
        assert_eq!(
            theorem_1_bisymmetric(&large()),
            Ok(Guarantee::OneWithThrust)
        );
        assert_eq!(theorem_1_bisymmetric(&small), Ok(Guarantee::OneWithThrust));
        for delta in [0.0, 0.3, -0.9, 1.57, 2.5] {
            let p = VehicleParameters { delta, ..P };
            let (l, s) = (
                Vehicle::new(p, large()).unwrap(),
                Vehicle::new(p, small).unwrap(),
            );
            for (reference, wind) in references().take(1000) {
                for set in [
                    Equilibria::find(&l, &reference, wind).unwrap(),
                    Equilibria::find(&s, &reference, wind).unwrap(),
                ] {
                    assert!(set.theta_plus().count() >= 1, "{reference:?} {delta}");
                }
            }
        }
        assert!(matches!(
            theorem_1_bisymmetric(&combined()),
            Err(Unmet::NotBisymmetric { .. })
        ));
    }

    #[test]
    fn theorem_2_one_for_sections_that_stall() {
        let model = Table::new(&NACA_0021_RE_160E3);
        let Ok(Guarantee::One { from, to }) = theorem_2(&model) else {
            panic!("{:?}", theorem_2(&model))
        };
        // 17.0° by linear interpolation between the rows at 16° and 18°, which c_L does not follow; and exactly 45°,
        // a row, where tan α_s = (1.075 − 0.025)/1.05.
        assert!(
            (from.to_degrees() - 17.0).abs() < 0.1,
            "{}",
            from.to_degrees()
        );
        assert!((to.to_degrees() - 45.0).abs() < 0.01, "{}", to.to_degrees());
        for delta in [0.3, -0.9, 1.57] {
            let vehicle = Vehicle::new(VehicleParameters { delta, ..P }, model).unwrap();
            for (reference, wind) in references().take(1000) {
                let set = Equilibria::find(&vehicle, &reference, wind).unwrap();
                assert!(!set.as_slice().is_empty(), "{reference:?} {delta}");
            }
        }
    }

    #[test]
    fn the_fitted_models_do_not_meet_theorem_2() {
        for p in [
            CombinedParameters::NACA_0021_RE_160E3,
            CombinedParameters::NACA_0021_RE_5E6,
        ] {
            let answer = theorem_2(&Combined::new(p).unwrap());
            let Err(Unmet::ReverseDrag { forward, reverse }) = answer else {
                panic!("{answer:?}")
            };
            assert!((forward - reverse).abs() < 1e-6 && (forward - p.c0).abs() < 1e-6);
        }
        assert!(matches!(
            theorem_2(&large()),
            Err(Unmet::ReverseDrag { .. })
        ));
    }

    #[test]
    fn lemma_1_passive_and_yet_no_equilibrium() {
        let model = Unholdable { c0: 0.1 };
        assert_eq!(passive(&model), Ok(()));
        assert!(theorem_1_bisymmetric(&model).is_err() && theorem_2(&model).is_err());
        let p = VehicleParameters {
            mass: 1.0,
            k_a: 0.04,
            delta: math::FRAC_PI_2,
            ..VehicleParameters::PAPER
        };
        let vehicle = Vehicle::new(p, model).unwrap();
        assert!(theorem_1_symmetric(&vehicle).is_err());
        // A1 and A2: γ = 90°, k_a|v_a|² = 1 N, W = (0, c0 + 1) N.
        let reference = Reference {
            velocity: Inertial::new(0.0, 5.0),
            acceleration: Inertial::new(9.81, -1.1),
        };
        let set = Equilibria::find(&vehicle, &reference, Inertial::ZERO).unwrap();
        assert_eq!(set.as_slice(), []);
        // At a lower airspeed there are some.
        let slower = Reference {
            velocity: Inertial::new(0.0, 3.0),
            ..reference
        };
        let set = Equilibria::find(&vehicle, &slower, Inertial::ZERO).unwrap();
        assert!(!set.as_slice().is_empty());
    }

    #[test]
    fn what_is_not_met_is_named() {
        struct Propelled;
        impl Aerodynamics for Propelled {
            fn coefficients(&self, a: AngleOfAttack) -> Coefficients {
                Coefficients {
                    c_d: 0.5 - a.cos,
                    ..Coefficients::default()
                }
            }
        }
        let answer = passive(&Propelled);
        assert!(
            matches!(answer, Err(Unmet::NotPassive { alpha, c_d }) if alpha.abs() < 1.1 && c_d < 0.0)
        );
        // A cambered section: lift at α = 0.
        let rows = [-180.0f32, -90.0, 0.0, 90.0, 180.0];
        let nodes = rows.map(|a| Node::from_degrees(a, if a == 0.0 { 0.2 } else { 0.0 }, 0.1));
        let polar = std::boxed::Box::leak(Polar::<4>::new(&nodes).unwrap().into());
        let vehicle = Vehicle::new(P, Table::new(polar)).unwrap();
        assert!(matches!(
            theorem_1_symmetric(&vehicle),
            Err(Unmet::NotSymmetric { .. })
        ));
        // A flat plate with a dirty trailing edge: no stall that would do.
        let rows = [0.0f32, 45.0, 90.0, 135.0, 180.0];
        let drag = [0.1, 0.2, 0.3, 0.4, 0.5];
        let nodes: [Node; 5] = core::array::from_fn(|i| Node::from_degrees(rows[i], 0.0, drag[i]));
        let polar = std::boxed::Box::leak(Polar::<4>::new(&nodes).unwrap().into());
        assert_eq!(theorem_2(&Table::new(polar)), Err(Unmet::NoStallAngle));
    }

    /// Coefficients as functions of α; the theorems do not look at derivatives.
    struct Section<L, D>(L, D);

    impl<L: Fn(f32) -> f32, D: Fn(f32) -> f32> Aerodynamics for Section<L, D> {
        fn coefficients(&self, a: AngleOfAttack) -> Coefficients {
            Coefficients {
                c_l: (self.0)(a.rad),
                c_d: (self.1)(a.rad),
                ..Coefficients::default()
            }
        }
    }

    fn sin(x: f32) -> f32 {
        math::sin_cos(x).0
    }

    fn cos(x: f32) -> f32 {
        math::sin_cos(x).1
    }

    /// A thrust line that is off by the tolerance is parallel, one that is off by more is not.
    #[test]
    fn parallel_is_meant_to_the_tolerance() {
        for (delta, parallel) in [(TOLERANCE, true), (1.1 * TOLERANCE, false)] {
            let vehicle = Vehicle::new(VehicleParameters { delta, ..P }, large()).unwrap();
            assert_eq!(theorem_1_symmetric(&vehicle).is_ok(), parallel, "{delta:e}");
        }
    }

    /// Bisymmetry is asked of lift and drag, each by itself.
    #[test]
    fn lift_and_drag_each_have_to_repeat() {
        let by_drag = Section(|a| sin(2.0 * a), |a| 2.0 - cos(a));
        let by_lift = Section(sin, |_| 1.0);
        let neither = Section(|a| sin(2.0 * a), |a| 2.0 - cos(2.0 * a));
        let unmet = |answer| matches!(answer, Err(Unmet::NotBisymmetric { .. }));
        assert!(unmet(theorem_1_bisymmetric(&by_drag)));
        assert!(unmet(theorem_1_bisymmetric(&by_lift)));
        assert!(theorem_1_bisymmetric(&neither).is_ok());
    }

    /// The difference of the drags is measured by the drag: 1e-6 is enough where the drag is 0.01, 5e-8 is a rounding of it.
    #[test]
    fn reverse_drag_is_compared_with_the_drag() {
        let drag = |rise: f32| move |a: f32| 0.01 + rise * 0.5 * (1.0 - cos(a));
        for (rise, enough) in [(1e-4, true), (1e-6, true), (5e-8, false)] {
            let answer = theorem_2(&Section(|_| 0.0, drag(rise)));
            let reverse = matches!(answer, Err(Unmet::ReverseDrag { .. }));
            assert_eq!(!reverse, enough, "{rise}: {answer:?}");
        }
    }

    /// A section without lift does not stall, however its drag rises. To know that takes the samples of the circle, two on its axis, and
    /// those between 0 and 90°, half a degree apart.
    #[test]
    fn without_lift_there_is_no_stall() {
        let evaluations = core::cell::Cell::new(0);
        let plate = Section(
            |_| {
                evaluations.set(evaluations.get() + 1);
                0.0
            },
            |a: f32| 1.0 - 0.1 * cos(a) + sin(a) * sin(a),
        );
        assert_eq!(theorem_2(&plate), Err(Unmet::NoStallAngle));
        assert_eq!(evaluations.get(), SAMPLES + 2 + SAMPLES / 4 - 1);
    }

    /// The interval of α_s in closed form. Let c_D − c_D(π) = sin² α − 0.1 (1 + cos α). With c_L = 0.5 sin 2α the condition, over cos α, is
    /// sin² α ≤ sin² α − 0.1 (1 + cos α), which never holds. With half of that lift it is 0.5 (1 − cos α) ≥ 0.1, hence cos α ≤ 0.8.
    #[test]
    fn the_stall_angles_are_those_of_the_closed_form() {
        let drag = |a: f32| 0.3 + 0.1 * (1.0 - cos(a)) + sin(a) * sin(a);
        let all = theorem_2(&Section(|a| 0.5 * sin(2.0 * a), drag));
        assert_eq!(all, Err(Unmet::NoStallAngle));
        let half = theorem_2(&Section(|a| 0.25 * sin(2.0 * a), drag));
        let Ok(Guarantee::One { from, to }) = half else {
            panic!("{half:?}")
        };
        // 1e-5: what 16 bisections leave of half a degree, and roundings of 1e-7 over a slope of 0.3.
        assert!((from - 0.8f32.acos()).abs() < 1e-5, "{from}");
        assert!((to - math::FRAC_PI_2).abs() < 1e-2, "{to}");
        // The same, with lift that is gone from 60.2° on.
        let edge = 60.2f32.to_radians();
        let ends = Section(
            |a: f32| {
                if a.abs() < edge {
                    0.25 * sin(2.0 * a)
                } else {
                    0.0
                }
            },
            drag,
        );
        let Ok(Guarantee::One { from, to }) = theorem_2(&ends) else {
            panic!("{:?}", theorem_2(&ends))
        };
        assert!((from - 0.8f32.acos()).abs() < 1e-5 && (to - edge).abs() < 1e-5);
    }

    /// No drag at all is passive: the air takes nothing, and gives nothing.
    #[test]
    fn no_drag_is_passive() {
        assert_eq!(passive(&Section(sin, |_| 0.0)), Ok(()));
        assert!(passive(&Section(sin, |_| -1e-9)).is_err());
        assert!(passive(&Section(sin, |_| f32::NAN)).is_err());
    }
}
