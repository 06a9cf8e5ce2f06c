//! Tests of the search for the zeros of F̄_2, with residuals whose zeros are known in closed form.

use core::cell::Cell;

use super::*;
use crate::aero::Coefficients;
use crate::vehicle::VehicleParameters;

/// Coefficients of which F̄_2(α) is a given function: c_L = −f cos α, c_D = −f sin α. With δ = 0, 1 N of pressure and no apparent weight
/// that leaves f itself, with f' and f'' as derivatives.
struct Shaped<F> {
    /// f, f' and f''.
    shape: F,
    evaluations: Cell<usize>,
}

impl<F: Fn(f32) -> [f32; 3]> Aerodynamics for Shaped<F> {
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
        self.evaluations.set(self.evaluations.get() + 1);
        let [f, df, ddf] = (self.shape)(alpha.rad);
        let (sin, cos) = (alpha.sin, alpha.cos);
        Coefficients {
            c_l: -f * cos,
            c_d: -f * sin,
            dc_l: f * sin - df * cos,
            dc_d: -f * cos - df * sin,
            ddc_l: f * cos + 2.0 * df * sin - ddf * cos,
            ddc_d: f * sin - 2.0 * df * cos - ddf * sin,
        }
    }
}

fn shaped<F: Fn(f32) -> [f32; 3]>(shape: F) -> Vehicle<Shaped<F>> {
    let evaluations = Cell::new(0);
    let parameters = VehicleParameters {
        k_a: 1.0,
        ..VehicleParameters::PAPER
    };
    Vehicle::new(parameters, Shaped { shape, evaluations }).unwrap()
}

/// Free fall at 1 m/s.
const FALL: Reference = Reference {
    velocity: Inertial::new(0.0, 1.0),
    acceleration: Inertial::new(VehicleParameters::PAPER.gravity, 0.0),
};

fn with<A: Aerodynamics, R>(vehicle: &Vehicle<A>, look: impl FnOnce(&Balance<A>) -> R) -> R {
    look(&Balance::new(vehicle, &FALL, Inertial::ZERO).unwrap())
}

fn evaluations<F: Fn(f32) -> [f32; 3]>(vehicle: &Vehicle<Shaped<F>>) -> usize {
    vehicle.model().evaluations.take()
}

/// Ends of cell `k` \[rad\].
fn cell(k: usize) -> (f32, f32) {
    let turn = 2.0 * math::PI;
    let to = grid::NODES.get(k + 1);
    let to = to.map_or(grid::NODES[0].rad + turn, |node| node.rad);
    (grid::NODES[k].rad, to)
}

/// Difference of two angles, in [−π, π].
fn difference(a: f32, b: f32) -> f32 {
    let d = f64::from(a) - f64::from(b);
    let turn = core::f64::consts::TAU;
    (d - turn * libm::round(d / turn)) as f32
}

/// size (cos h − cos d), d being the angle from `middle`: zero at h on either side of it.
fn dip(size: f32, middle: f32, h: f32) -> impl Fn(f32) -> [f32; 3] {
    move |alpha| {
        let d = difference(alpha, middle);
        let product = math::sin_cos(0.5 * (d + h)).0 * math::sin_cos(0.5 * (d - h)).0;
        let (sin, cos) = math::sin_cos(d);
        [2.0 * size * product, size * sin, size * cos]
    }
}

#[test]
fn the_residual_is_the_shape() {
    let vehicle = shaped(dip(7.0, 0.4, 0.3));
    with(&vehicle, |balance| {
        for n in -31..31 {
            let alpha = 0.1 * n as f32;
            let at = balance.at(AngleOfAttack::from_radians(alpha));
            let [f, df, ddf] = dip(7.0, 0.4, 0.3)(alpha);
            // Roundings of numbers up to 30.
            assert!((at.force - f).abs() < 2e-6 && (at.slope - df).abs() < 5e-6);
            assert!((at.curvature - ddf).abs() < 2e-5, "{alpha}");
        }
    });
}

/// Zero counts as positive, on both sides of a node.
#[test]
fn a_zero_at_a_node_is_found_once() {
    for sign in [1.0, -1.0] {
        for node in &grid::NODES {
            let vehicle = shaped(|alpha| {
                let (sin, cos) = math::sin_cos(difference(alpha, node.rad));
                [sign * sin, sign * cos, -sign * sin]
            });
            let angles = with(&vehicle, |balance| {
                assert_eq!(balance.at(*node).force, 0.0);
                let intervals = brackets(balance).unwrap_or_default();
                intervals
                    .iter()
                    .map(|b| refine(balance, b))
                    .collect::<heapless::Vec<f32, CAPACITY>>()
            });
            assert_eq!(angles.len(), 2, "{node:?}");
            for zero in angles {
                let d = difference(zero, node.rad).abs();
                // 1e-6: what refining promises.
                assert!(d.min(math::PI - d) < 1e-6, "{node:?} {zero}");
            }
        }
    }
}

/// Two zeros inside every cell of the grid, far apart, close, and off the middle. The narrowest are closer than ten bisections come.
#[test]
fn two_zeros_in_one_cell_are_found() {
    for k in 0..grid::N {
        let (from, to) = cell(k);
        let width = to - from;
        for (place, h) in [
            (0.5, 0.3 * width),
            (0.32, 0.1 * width),
            (0.7, 1e-3),
            (0.6, 3e-6),
        ] {
            for size in [7.0, -7.0] {
                let middle = from + place * width;
                let vehicle = shaped(dip(size, middle, h));
                with(&vehicle, |balance| {
                    let intervals = brackets(balance).unwrap_or_default();
                    let steps = evaluations(&vehicle) - grid::N;
                    assert!((1..=4).contains(&steps), "{k} {h}: {steps}");
                    let [a, b] = intervals.as_slice() else {
                        panic!("{k} {place} {h}: {}", intervals.len())
                    };
                    let (a, b) = (refine(balance, a), refine(balance, b));
                    let (a, b) = (difference(a, middle), difference(b, middle));
                    // 1e-6: what refining promises; the narrow ones are told apart by the sign.
                    assert!((a + h).abs() < 1e-6 && (b - h).abs() < 1e-6, "{k} {a} {b}");
                    assert!(a < 0.0 && b > 0.0);
                });
            }
        }
    }
}

/// An extremum too far from zero for the slopes beside it is not looked at: no evaluation but those of the grid.
#[test]
fn extrema_far_from_zero_cost_nothing() {
    for sign in [1.0, -1.0] {
        let vehicle = shaped(|alpha| {
            let (sin, cos) = math::sin_cos(5.0 * alpha);
            [
                sign * (1.0 + 0.9 * sin),
                sign * 4.5 * cos,
                -sign * 22.5 * sin,
            ]
        });
        let intervals = with(&vehicle, brackets);
        assert!(intervals.is_ok_and(|intervals| intervals.is_empty()));
        assert_eq!(evaluations(&vehicle), grid::N);
    }
}

/// As many as there is room for are found, and of two more none.
#[test]
fn the_room_is_used_to_the_last() {
    for (n, fits) in [(CAPACITY / 2, true), (CAPACITY / 2 + 1, false)] {
        let n = n as f32;
        let vehicle = shaped(|alpha| {
            let (sin, cos) = math::sin_cos(n * alpha + 0.1);
            [sin, n * cos, -n * n * sin]
        });
        let count = with(&vehicle, brackets).map(|intervals| intervals.len());
        assert_eq!(count.ok(), fits.then_some(CAPACITY));
        let set = Equilibria::find(&vehicle, &FALL, Inertial::ZERO);
        assert_eq!(set.err(), (!fits).then_some(EquilibriumError::Overflow));
    }
}

/// The number of dips looked at is bounded too: as many as there is room for zeros, with or without zeros in them.
#[test]
fn one_dip_too_many_is_an_overflow() {
    for (n, fits) in [(CAPACITY, true), (CAPACITY + 1, false)] {
        let n = n as f32;
        // Least values of 1e-5, each of which could be below zero as far as the slopes of its cell tell.
        let vehicle = shaped(|alpha| {
            let (sin, cos) = math::sin_cos(0.5 * n * (alpha + 0.013));
            [
                1e-5 + sin * sin,
                n * sin * cos,
                0.5 * n * n * (1.0 - 2.0 * sin * sin),
            ]
        });
        let intervals = with(&vehicle, brackets);
        assert_eq!(
            intervals.is_ok_and(|intervals| intervals.is_empty()),
            fits,
            "{n}"
        );
    }
}

fn bracket(from: f32, to: f32, rising: bool) -> Bracket {
    Bracket { from, to, rising }
}

/// Newton's steps: the digits double. Bisections alone would take 15 evaluations.
#[test]
fn zeros_are_refined_within_a_few_evaluations() {
    for k in 0..grid::N {
        let (from, to) = cell(k);
        for place in [0.02f32, 0.3, 0.45, 0.77, 0.99] {
            let zero = from + place * (to - from);
            for size in [1e-2, -1e-2, 3.0, -3.0, 200.0] {
                // sin d + sin² d
                let vehicle = shaped(|alpha| {
                    let (s, c) = math::sin_cos(difference(alpha, zero));
                    [
                        size * (s + s * s),
                        size * (c + 2.0 * s * c),
                        size * (2.0 * c * c - 2.0 * s * s - s),
                    ]
                });
                let angle = with(&vehicle, |b| refine(b, &bracket(from, to, size > 0.0)));
                let error = difference(angle, zero).abs();
                // Two roundings of an angle below 3.2.
                assert!(error < 5e-7, "{k} {place} {size}: {error:e}");
                let steps = evaluations(&vehicle);
                // Next to an end a step leaves the bracket, and is a bisection.
                let most = if place == 0.99 || place == 0.02 { 8 } else { 4 };
                assert!(steps <= most, "{k} {place} {size}: {steps}");
            }
        }
    }
}

/// Where eight derivatives vanish Newton's steps shorten by a ninth only, and fifteen of them would leave 17 % of the way. With the bisections
/// between them less than a hundredth of the cell is left.
#[test]
fn slow_steps_give_way_to_bisections() {
    let mut worst = 0.0f32;
    for k in (0..grid::N).step_by(5) {
        let (from, to) = cell(k);
        for place in [0.1, 0.37, 0.61, 0.93] {
            let zero = from + place * (to - from);
            for size in [1.0, -1.0] {
                let vehicle = shaped(|alpha| {
                    let d = difference(alpha, zero) / (to - from);
                    let d7 = d * d * d * d * d * d * d;
                    let (slope, curvature) = (9.0 / (to - from), 72.0 / (to - from) / (to - from));
                    [
                        size * d7 * d * d,
                        size * slope * d7 * d,
                        size * curvature * d7,
                    ]
                });
                let angle = with(&vehicle, |b| refine(b, &bracket(from, to, size > 0.0)));
                worst = worst.max(difference(angle, zero).abs() / (to - from));
            }
        }
    }
    assert!(worst < 0.005, "{worst}");
}

#[test]
fn what_leaves_the_bracket_is_its_middle() {
    for (x, kept) in [
        (1.0, 1.0),
        (2.5, 2.5),
        (3.0, 3.0),
        (0.9, 2.0),
        (3.1, 2.0),
        (f32::NAN, 2.0),
        (f32::NEG_INFINITY, 2.0),
    ] {
        assert_eq!(inside(x, 1.0, 3.0), kept);
    }
}

/// A curve can come back from zero within a cell if it goes there at one end, comes from there at the other, and the tangent of either
/// end reaches zero within the cell.
#[test]
fn which_cells_could_hold_two_zeros() {
    const WIDTH: f32 = 0.5;
    for (a, b, may) in [
        // Both tangents, only the first and only the second reach zero.
        ((1.0, -3.0), (1.0, 3.0), true),
        ((1.0, -3.0), (1.0, 1.0), true),
        ((1.0, -1.0), (1.0, 3.0), true),
        ((1.0, -1.0), (4.0, 9.0), true),
        // Neither does.
        ((1.0, -1.0), (1.0, 1.0), false),
        ((1.0, -1.9), (1.0, 1.9), false),
        // Away from zero, towards it, or towards it only behind the cell.
        ((1.0, 3.0), (1.0, 3.0), false),
        ((1.0, -3.0), (1.0, -3.0), false),
        ((1.0, 3.0), (1.0, -3.0), false),
        // The extremum is the node.
        ((1.0, 0.0), (1.0, 3.0), false),
        ((1.0, -3.0), (1.0, 0.0), false),
        // Zero counts as positive.
        ((0.0, -1.0), (1.0, 1.0), true),
        ((0.0, 1.0), (1.0, -1.0), false),
    ] {
        let residual = |(force, slope)| Residual {
            force,
            slope,
            curvature: 0.0,
            scale: 1.0,
        };
        let (a, b) = (residual(a), residual(b));
        assert_eq!(may_touch(&a, &b, WIDTH), may, "{} {}", a.slope, b.slope);
        if a.force != 0.0 {
            let negative = |r: Residual| Residual {
                force: -r.force,
                slope: -r.slope,
                ..r
            };
            assert_eq!(may_touch(&negative(a), &negative(b), WIDTH), may);
        }
    }
}

/// Zero counts as positive here too, and the steps have an end.
#[test]
fn a_dip_is_dug_to_its_end_and_no_further() {
    // A dip that stays 1e-5 above zero is none, after all the steps.
    let vehicle = shaped(|alpha| {
        let d = difference(alpha, 0.7);
        [1e-5 + 4.0 * d * d, 8.0 * d, 8.0]
    });
    with(&vehicle, |b| assert_eq!(dig(b, 0.69, 0.72, false), None));
    assert_eq!(evaluations(&vehicle), DIG_STEPS);
    // Touching zero from above is being positive; touching it from below is not being negative.
    for (sign, touches) in [(1.0, false), (-1.0, true)] {
        let vehicle = shaped(|alpha| {
            let d = difference(alpha, 0.75);
            [sign * 4.0 * d * d, sign * 8.0 * d, sign * 8.0]
        });
        let angle = with(&vehicle, |b| dig(b, 0.625, 0.875, sign < 0.0));
        assert_eq!(angle, touches.then_some(0.75));
    }
}

/// Against the sort of the standard library, over every order of five angles, two of them equal.
#[test]
fn sorted_by_angle_of_attack() {
    extern crate std;
    let of = |alpha, thrust| Equilibrium {
        attitude: Attitude::NOSE_UP,
        alpha,
        thrust,
        t_p: 1.0,
        isolated: true,
    };
    let angles = [0.3, -2.0, 1.1, 0.3, -0.4];
    for order in 0..5usize.pow(5) {
        let digit = |n: u32| order / 5usize.pow(n) % 5;
        let mut set = std::vec::Vec::new();
        for n in 0..5 {
            set.push(of(angles[digit(n)], digit(n) as f32));
        }
        let mut wanted = set.clone();
        wanted.sort_by(|a, b| a.alpha.total_cmp(&b.alpha));
        sort(&mut set);
        // Equal ones stay in their order.
        assert_eq!(set, wanted);
    }
}

/// Near the bad velocity of a sphere F_p is as small as one likes. Below 1e-5 of the forces no equilibrium is called isolated.
#[test]
fn what_is_not_isolated_is_said() {
    // F̄_2 = size sin α on a scale of 1 N, in all of 200 N.
    for (size, isolated) in [(6e-6f32, false), (1.5e-5, true)] {
        let vehicle = Vehicle::new(
            VehicleParameters {
                k_a: 1.0,
                ..VehicleParameters::PAPER
            },
            Steady { c_d: 100.0 },
        )
        .unwrap();
        // A drag of 100 N, and an apparent weight of that and `size` of both.
        let reference = Reference {
            velocity: Inertial::new(1.0, 0.0),
            acceleration: Inertial::new(VehicleParameters::PAPER.gravity - 10.0 - 20.0 * size, 0.0),
        };
        let set = Equilibria::find(&vehicle, &reference, Inertial::ZERO).unwrap();
        assert_eq!(set.as_slice().len(), 2);
        for e in set.as_slice() {
            assert_eq!(e.isolated, isolated, "{e:?}");
        }
    }
}

/// A sphere.
struct Steady {
    c_d: f32,
}

impl Aerodynamics for Steady {
    fn coefficients(&self, _: AngleOfAttack) -> Coefficients {
        Coefficients {
            c_d: self.c_d,
            ..Coefficients::default()
        }
    }
}

#[test]
fn without_a_force_left_the_branch_is_the_aligned_one() {
    for (t_p, branch) in [
        (-1e-3, Branch::Opposed),
        (0.0, Branch::Aligned),
        (1e-3, Branch::Aligned),
    ] {
        let e = Equilibrium {
            attitude: Attitude::NOSE_UP,
            alpha: 0.0,
            thrust: 1.0,
            t_p,
            isolated: false,
        };
        assert_eq!(e.branch(), branch);
    }
}
