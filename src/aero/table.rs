//! The table model: measured coefficients at nodes, interpolated with continuous second derivatives.

use core::fmt;

use super::interpolant::{Of, Samples};
use super::{Aerodynamics, Coefficients};
use crate::air::AngleOfAttack;
use crate::math;

/// One row of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Node {
    /// Angle of attack \[rad\].
    pub alpha: f32,
    /// Lift coefficient.
    pub c_l: f32,
    /// Drag coefficient.
    pub c_d: f32,
}

impl Node {
    /// The row at `alpha_deg` degrees.
    pub const fn from_degrees(alpha_deg: f32, c_l: f32, c_d: f32) -> Self {
        Self {
            alpha: alpha_deg.to_radians(),
            c_l,
            c_d,
        }
    }
}

/// Why a table was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum TableProblem {
    /// A number is NaN or infinite.
    NotFinite,
    /// A coefficient is above 1000 in magnitude.
    OutOfRange,
    /// The drag coefficient is not positive.
    DragNotPositive,
    /// The angle does not exceed that of the row before by at least 0.05°.
    NotIncreasing,
    /// The first row is neither at 0 (symmetric section) nor at −180°.
    Start,
    /// The last row is not at 180°.
    End,
    /// Symmetric section, but lift at 0 or 180° is not zero.
    LiftOnAxis,
    /// The rows at −180° and 180° differ.
    NotPeriodic,
    /// Fewer than five rows.
    TooFew,
    /// More rows than the table has room for.
    TooMany,
}

/// A table's refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct TableError {
    /// The row, counted from 0.
    pub row: usize,
    /// What is wrong with it.
    pub problem: TableProblem,
}

impl TableProblem {
    /// What is wrong, in words.
    pub const fn text(self) -> &'static str {
        match self {
            Self::NotFinite => "every number must be finite",
            Self::OutOfRange => "coefficients must be within ±1000",
            Self::DragNotPositive => "the drag coefficient must be positive",
            Self::NotIncreasing => "angles must increase by at least 0.05° from row to row",
            Self::Start => "the first angle must be 0 (symmetric section) or −180°",
            Self::End => "the last angle must be 180°",
            Self::LiftOnAxis => "a symmetric section has no lift at 0 and 180°",
            Self::NotPeriodic => "the rows at −180° and 180° must agree",
            Self::TooFew => "at least five rows are needed",
            Self::TooMany => "there are more rows than the table has room for",
        }
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "row {}: {}", self.row, self.problem.text())
    }
}

impl core::error::Error for TableError {}

/// Coefficients greater than this are refused.
const MAX_COEFFICIENT: f32 = 1e3;
/// Coefficients this close are the same: what programs leave for the lift of a symmetric section at 0.
const NOTHING: f32 = 1e-6;
/// Angles this close \[rad\] are the same: 0.0006°, a few roundings of 180°.
const SAME: f32 = 1e-5;
/// Least distance of rows \[rad\]: 0.05°, where second derivatives lose half of their digits.
const CLOSEST: f32 = 0.05 * math::PI / 180.0 - SAME;

/// The polynomials between two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Interval {
    /// Where it begins \[rad\].
    alpha: f32,
    /// One over its width [1/rad].
    inverse: f32,
    c_l: [f32; 6],
    c_d: [f32; 6],
}

/// A table's data: room for `N` intervals, that is `N` + 1 rows. Built in a constant, it costs nothing at start-up
/// and lies in flash.
#[derive(Clone, Debug, PartialEq)]
pub struct Polar<const N: usize> {
    intervals: [Interval; N],
    len: usize,
    symmetric: bool,
}

impl<const N: usize> Polar<N> {
    /// The table through `nodes`, by increasing angle: over [0, π] for a symmetric section (c_L odd, c_D even in α), or
    /// over [−π, π] for any other. The angle 0 is the table's reference line, such as the chord; a vehicle's δ is
    /// measured from the same line.
    ///
    /// # Errors
    /// The first row that is wrong, and why.
    pub const fn new(nodes: &[Node]) -> Result<Self, TableError> {
        let symmetric = match check(nodes, N + 1) {
            Ok(symmetric) => symmetric,
            Err(error) => return Err(error),
        };
        let lift = Samples::new(nodes, Of::Lift, symmetric);
        let drag = Samples::new(nodes, Of::Drag, symmetric);
        let nothing = Interval {
            alpha: 0.0,
            inverse: 0.0,
            c_l: [0.0; 6],
            c_d: [0.0; 6],
        };
        let mut intervals = [nothing; N];
        let len = nodes.len() - 1;
        let mut rest = intervals.as_mut_slice();
        let mut j = 0;
        while let [interval, after @ ..] = rest {
            if j == len {
                break;
            }
            interval.alpha = lift.at(j as isize).0;
            interval.inverse = 1.0 / (lift.at(j as isize + 1).0 - interval.alpha);
            interval.c_l = lift.quintic(j);
            interval.c_d = drag.quintic(j);
            rest = after;
            j += 1;
        }
        Ok(Self {
            intervals,
            len,
            symmetric,
        })
    }
}

/// Whether `nodes` describe a symmetric section, or what is wrong with them.
const fn check(nodes: &[Node], room: usize) -> Result<bool, TableError> {
    const fn refuse(row: usize, problem: TableProblem) -> Result<bool, TableError> {
        Err(TableError { row, problem })
    }
    if nodes.len() < 5 {
        return refuse(nodes.len(), TableProblem::TooFew);
    }
    if nodes.len() > room {
        return refuse(room, TableProblem::TooMany);
    }
    let [first, ..] = nodes else {
        return refuse(0, TableProblem::TooFew);
    };
    let mut end = first;
    let mut rest = nodes;
    let mut row = 0;
    while let [node, after @ ..] = rest {
        let Node { alpha, c_l, c_d } = *node;
        if !(alpha.is_finite() && c_l.is_finite() && c_d.is_finite()) {
            return refuse(row, TableProblem::NotFinite);
        }
        if c_l.abs() > MAX_COEFFICIENT || c_d.abs() > MAX_COEFFICIENT {
            return refuse(row, TableProblem::OutOfRange);
        }
        if c_d <= 0.0 {
            return refuse(row, TableProblem::DragNotPositive);
        }
        if row > 0 && alpha - end.alpha < CLOSEST {
            return refuse(row, TableProblem::NotIncreasing);
        }
        end = node;
        rest = after;
        row += 1;
    }
    let last = row - 1;
    let symmetric = first.alpha.abs() < SAME;
    if !symmetric && (first.alpha + math::PI).abs() > SAME {
        return refuse(0, TableProblem::Start);
    }
    if (end.alpha - math::PI).abs() > SAME {
        return refuse(last, TableProblem::End);
    }
    if symmetric {
        if first.c_l.abs() > NOTHING {
            return refuse(0, TableProblem::LiftOnAxis);
        }
        if end.c_l.abs() > NOTHING {
            return refuse(last, TableProblem::LiftOnAxis);
        }
    } else if (first.c_l - end.c_l).abs() > NOTHING || (first.c_d - end.c_d).abs() > NOTHING {
        return refuse(last, TableProblem::NotPeriodic);
    }
    Ok(symmetric)
}

/// The coefficients of a [`Polar`], interpolated by quintics: twice continuously differentiable, and monotone
/// between nodes.
///
/// The time of an evaluation depends on the number of rows, not on the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table<'a> {
    intervals: &'a [Interval],
    symmetric: bool,
}

impl<'a> Table<'a> {
    /// The model of this data, which it borrows.
    pub const fn new<const N: usize>(polar: &'a Polar<N>) -> Self {
        Self {
            // Never longer than there is; told without the panic of a split.
            intervals: match polar.intervals.split_at_checked(polar.len) {
                Some((used, _)) => used,
                None => &polar.intervals,
            },
            symmetric: polar.symmetric,
        }
    }
}

impl Aerodynamics for Table<'_> {
    #[inline]
    fn coefficients(&self, alpha: AngleOfAttack) -> Coefficients {
        let mirrored = self.symmetric && alpha.rad < 0.0;
        let sign = if mirrored { -1.0 } else { 1.0 };
        let a = sign * alpha.rad;
        let mut low = 0;
        let mut size = self.intervals.len();
        // The number of steps depends on the length alone, not on the angle.
        while size > 1 {
            let half = size / 2;
            let above = matches!(self.intervals.get(low + half), Some(i) if i.alpha <= a);
            low = if above { low + half } else { low };
            size -= half;
        }
        let Some(interval) = self.intervals.get(low) else {
            return Coefficients::default();
        };
        let u = (a - interval.alpha) * interval.inverse;
        let [c_l, dc_l, ddc_l] = polynomial(&interval.c_l, u);
        let [c_d, dc_d, ddc_d] = polynomial(&interval.c_d, u);
        let first = interval.inverse;
        let second = first * first;
        Coefficients {
            c_l: sign * c_l,
            c_d,
            dc_l: first * dc_l,
            dc_d: sign * (first * dc_d),
            ddc_l: sign * (second * ddc_l),
            ddc_d: second * ddc_d,
        }
    }
}

/// A quintic, its first and its second derivative at `u`.
#[inline(always)]
fn polynomial(&[a0, a1, a2, a3, a4, a5]: &[f32; 6], u: f32) -> [f32; 3] {
    [
        a0 + u * (a1 + u * (a2 + u * (a3 + u * (a4 + u * a5)))),
        a1 + u * (2.0 * a2 + u * (3.0 * a3 + u * (4.0 * a4 + u * (5.0 * a5)))),
        2.0 * a2 + u * (6.0 * a3 + u * (12.0 * a4 + u * (20.0 * a5))),
    ]
}

#[cfg(feature = "defmt")]
impl defmt::Format for Table<'_> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Table of {} rows", self.intervals.len() + 1);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{NACA_0021_RE_5E6, NACA_0021_RE_160E3};
    use std::vec::Vec;

    static SHIPPED: [(Table, usize); 2] = [
        (Table::new(&NACA_0021_RE_160E3), 51),
        (Table::new(&NACA_0021_RE_5E6), 54),
    ];

    fn at(model: &Table, alpha: f32) -> Coefficients {
        model.coefficients(AngleOfAttack {
            sin: 0.0,
            cos: 0.0,
            rad: alpha,
        })
    }

    /// The interval's quintic in f64 by de Casteljau's construction of its Bernstein form, and all ordinates.
    fn ordinates([a0, a1, a2, a3, a4, a5]: [f32; 6]) -> [f64; 6] {
        let a = [a0, a1, a2, a3, a4, a5].map(f64::from);
        // b_i = Σ_k binomial(i, k) / binomial(5, k) a_k.
        let choose =
            |n: usize, k: usize| (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64);
        core::array::from_fn(|i| (0..=i).map(|k| choose(i, k) / choose(5, k) * a[k]).sum())
    }

    #[test]
    fn the_tables_have_their_sources_rows() {
        for (model, rows) in &SHIPPED {
            assert_eq!(model.intervals.len() + 1, *rows);
        }
        for (alpha, c_l, c_d) in [
            (14.0f32, 0.6993, 0.158),
            (45.0, 1.05, 1.075),
            (140.0, -0.98, 0.925),
        ] {
            let c = at(&SHIPPED[0].0, alpha.to_radians());
            assert!((c.c_l - c_l).abs() < 2e-7 && (c.c_d - c_d).abs() < 2e-7);
        }
        let c = at(&SHIPPED[0].0, math::PI);
        assert!(c.c_l.abs() < 1e-6 && (c.c_d - 0.025).abs() < 1e-6);
    }

    #[test]
    fn derivatives_are_those_of_the_values_and_continuous() {
        for (model, _) in &SHIPPED {
            for (k, pair) in model.intervals.windows(2).enumerate() {
                let end = |i: &Interval, of: fn(&Interval) -> &[f32; 6], u: f32| {
                    let [y, dy, ddy] = polynomial(of(i), u);
                    [y, dy * i.inverse, ddy * i.inverse * i.inverse]
                };
                for of in [(|i| &i.c_l) as fn(&Interval) -> &[f32; 6], |i| &i.c_d] {
                    let (a, b) = (end(&pair[0], of, 1.0), end(&pair[1], of, 0.0));
                    // Roundings of polynomials whose terms are up to 60 times the rise of the cell, in units of it.
                    for (x, y, tolerance) in
                        [(a[0], b[0], 1e-6), (a[1], b[1], 2e-4), (a[2], b[2], 2e-2)]
                    {
                        assert!((x - y).abs() < tolerance, "{x} is not {y} at node {k}");
                    }
                }
            }
            for interval in model.intervals {
                // The Bernstein form in f64, differenced, against the monomials in f32.
                for (of_lift, monomials) in [(true, interval.c_l), (false, interval.c_d)] {
                    let b = ordinates(monomials);
                    let h = 1.0 / f64::from(interval.inverse);
                    let bezier = |u: f64| {
                        let mut b = b;
                        for n in (1..6).rev() {
                            for i in 0..n {
                                b[i] += u * (b[i + 1] - b[i]);
                            }
                        }
                        b[0]
                    };
                    for u in [0.1, 0.37, 0.5, 0.81] {
                        let alpha = (f64::from(interval.alpha) + u * h) as f32;
                        // The angle as rounded.
                        let u = (f64::from(alpha) - f64::from(interval.alpha)) / h;
                        let c = at(model, alpha);
                        let (v, d, dd) = if of_lift {
                            (c.c_l, c.dc_l, c.ddc_l)
                        } else {
                            (c.c_d, c.dc_d, c.ddc_d)
                        };
                        let e = 1e-3;
                        let (p, o, m) = (bezier(u + e), bezier(u), bezier(u - e));
                        let first = (p - m) / (2.0 * e * h);
                        let second = (p - 2.0 * o + m) / (e * e * h * h);
                        // 1e-4 of the largest slope and curvature in the table: differences of quintics over 2e-3.
                        assert!((f64::from(v) - o).abs() < 1e-6);
                        assert!((f64::from(d) - first).abs() < 1e-4 * (1.0 + first.abs()));
                        assert!((f64::from(dd) - second).abs() < 1e-2 + 1e-3 * second.abs());
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_overshoots() {
        for (model, _) in &SHIPPED {
            for interval in model.intervals {
                for monomials in [interval.c_l, interval.c_d] {
                    let b = ordinates(monomials);
                    let (first, last) = (b[0], b[5]);
                    // Ordinates in order make the polynomial monotone; 1e-7 for roundings of f32.
                    for pair in b.windows(2) {
                        assert!(
                            (pair[1] - pair[0]) * (last - first).signum() >= -2e-7,
                            "{b:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_symmetric_section_is_its_own_mirror_image() {
        let (model, _) = &SHIPPED[0];
        for n in 0..3000 {
            let alpha = n as f32 * math::PI / 3000.0;
            let (a, b) = (at(model, alpha), at(model, -alpha));
            let mirrored = Coefficients {
                c_l: -b.c_l,
                dc_d: -b.dc_d,
                ddc_l: -b.ddc_l,
                ..b
            };
            assert_eq!(a, mirrored);
        }
    }

    /// The same section given over a full turn is interpolated alike: mirroring is periodicity here.
    #[test]
    fn a_full_table_of_a_symmetric_section_is_the_symmetric_table() {
        let (model, _) = &SHIPPED[0];
        let half: Vec<Node> = model
            .intervals
            .iter()
            .map(|i| Node {
                alpha: i.alpha,
                c_l: i.c_l[0],
                c_d: i.c_d[0],
            })
            .chain([Node::from_degrees(180.0, 0.0, 0.025)])
            .collect();
        let mirrored = half.iter().rev().map(|n| Node {
            alpha: -n.alpha,
            c_l: -n.c_l,
            c_d: n.c_d,
        });
        let full: Vec<Node> = mirrored.chain(half.iter().skip(1).copied()).collect();
        let polar = Polar::<100>::new(&full).unwrap();
        let table = Table::new(&polar);
        assert!(!table.symmetric && table.intervals.len() == 100);
        for n in -3000..3000 {
            let alpha = (n as f32 + 0.5) * math::PI / 3000.0;
            let (a, b) = (at(model, alpha), at(&table, alpha));
            // Secants are taken in another order: a few roundings, and of the second derivatives, up to 400.
            assert!((a.c_l - b.c_l).abs() < 1e-6 && (a.c_d - b.c_d).abs() < 1e-6);
            assert!((a.dc_l - b.dc_l).abs() < 1e-4 && (a.dc_d - b.dc_d).abs() < 1e-4);
            assert!((a.ddc_l - b.ddc_l).abs() < 2e-2 && (a.ddc_d - b.ddc_d).abs() < 2e-2);
        }
    }

    #[test]
    fn bad_rows_are_named() {
        let good = [0.0f32, 45.0, 90.0, 135.0, 180.0].map(|a| Node::from_degrees(a, 0.0, 0.1));
        let refuse = |change: &dyn Fn(&mut [Node; 5])| {
            let mut nodes = good;
            change(&mut nodes);
            let e = Polar::<8>::new(&nodes).unwrap_err();
            (e.row, e.problem)
        };
        assert!(Polar::<4>::new(&good).is_ok());
        let mut rounded = good;
        (rounded[0].c_l, rounded[4].c_l) = (-9e-17, 2e-16);
        assert!(Polar::<4>::new(&rounded).is_ok());
        use TableProblem::*;
        assert_eq!(refuse(&|n| n[2].c_l = f32::NAN), (2, NotFinite));
        assert_eq!(refuse(&|n| n[1].c_l = 1e4), (1, OutOfRange));
        assert_eq!(refuse(&|n| n[3].c_d = 0.0), (3, DragNotPositive));
        assert_eq!(refuse(&|n| n[2].alpha = n[1].alpha), (2, NotIncreasing));
        assert_eq!(refuse(&|n| n[0].alpha = 0.1), (0, Start));
        assert_eq!(refuse(&|n| n[4].alpha = 3.0), (4, End));
        assert_eq!(refuse(&|n| n[4].c_l = 0.1), (4, LiftOnAxis));
        assert_eq!(refuse(&|n| n[0].c_l = 0.1), (0, LiftOnAxis));
        assert_eq!(refuse(&|n| n[1].c_d = 1e4), (1, OutOfRange));
        assert_eq!(
            refuse(&|n| {
                n[0] = Node::from_degrees(-180.0, 0.1, 0.1);
            }),
            (4, NotPeriodic)
        );
        assert_eq!(
            refuse(&|n| {
                n[0] = Node::from_degrees(-180.0, 0.0, 0.2);
            }),
            (4, NotPeriodic)
        );
        // In words, each in its own.
        assert!(TooFew.text().starts_with("at least five") && End.text().contains("180°"));
        assert_eq!(Polar::<8>::new(&good[..4]).unwrap_err().problem, TooFew);
        assert_eq!(Polar::<3>::new(&good).unwrap_err().problem, TooMany);
    }
}
