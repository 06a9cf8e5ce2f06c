//! The interpolant of tables: C², local, and monotone wherever its data are.
//!
//! Each node takes value, slope and curvature from the parabola through it and its neighbours. They are limited so that
//! the quintic Hermite polynomial of every interval is monotone. It is, since its Bernstein ordinates are in order.
//! Extrema stay at nodes, nothing overshoots, nothing rings.

use super::table::Node;

/// Largest slope at a node, relative to the smaller of the adjacent secants.
const STEEPEST: f32 = 2.0;
/// Largest sum of the slopes at an interval's ends, relative to its secant: leaves room for a curvature of zero.
const STEEPEST_PAIR: f32 = 2.5;

/// Which coefficient of the nodes is interpolated.
#[derive(Clone, Copy)]
pub(super) enum Of {
    Lift,
    Drag,
}

/// One coefficient of a table, continued beyond its ends.
#[derive(Clone, Copy)]
pub(super) struct Samples<'a> {
    nodes: &'a [Node],
    of: Of,
    symmetric: bool,
}

impl<'a> Samples<'a> {
    /// The coefficient `of` at `nodes`, of which there are at least four: over a half turn if `symmetric` (lift is
    /// continued as an odd function, drag as an even one), else over a turn.
    pub(super) const fn new(nodes: &'a [Node], of: Of, symmetric: bool) -> Self {
        Self {
            nodes,
            of,
            symmetric,
        }
    }

    /// Monomials, in u = (α − α_j)/h_j ∈ [0, 1], of the interval from node `j`.
    pub(super) const fn quintic(&self, j: usize) -> [f32; 6] {
        let ends = Window::new(self, j as isize).ends();
        let h = ends.width;
        let (d0, d1) = (h * ends.slopes.0, h * ends.slopes.1);
        let half = 0.5 * h * h;
        let (s0, s1) = (half * ends.curvatures.0, half * ends.curvatures.1);
        // What is left at u = 1, in value, slope and half curvature, for the cubic to quintic terms.
        let (y0, y1) = ends.values;
        let (r, rd, rs) = (y1 - y0 - d0 - s0, d1 - d0 - 2.0 * s0, s1 - s0);
        [
            y0,
            d0,
            s0,
            10.0 * r - 4.0 * rd + rs,
            -15.0 * r + 7.0 * rd - 2.0 * rs,
            6.0 * r - 3.0 * rd + rs,
        ]
    }

    /// Angle and value at node `i`, which may lie beyond the ends by less than the number of nodes.
    pub(super) const fn at(&self, i: isize) -> (f32, f32) {
        const TURN: f32 = 2.0 * core::f32::consts::PI;
        let last = self.nodes.len() as isize - 1;
        // Mirrored at the ends, or moved by a turn.
        let (inside, moved) = if i < 0 {
            (if self.symmetric { -i } else { i + last }, -TURN)
        } else if i > last {
            (
                if self.symmetric {
                    2 * last - i
                } else {
                    i - last
                },
                TURN,
            )
        } else {
            let node = self.node(i);
            return (node.alpha, self.value(&node));
        };
        let node = self.node(inside);
        let y = self.value(&node);
        if !self.symmetric {
            return (node.alpha + moved, y);
        }
        let x = if i < 0 { 0.0 } else { TURN } - node.alpha;
        match self.of {
            Of::Lift => (x, -y),
            Of::Drag => (x, y),
        }
    }

    /// Node `i`, without the panic of an index: there is none to be reported here.
    const fn node(&self, i: isize) -> Node {
        match self.nodes.split_at_checked(i as usize) {
            Some((_, [node, ..])) => *node,
            _ => Node::from_degrees(0.0, 0.0, 0.0),
        }
    }

    const fn value(&self, node: &Node) -> f32 {
        match self.of {
            Of::Lift => node.c_l,
            Of::Drag => node.c_d,
        }
    }
}

/// Nodes around an interval that its polynomial depends on: three before its beginning and three after its end.
const WINDOW: usize = 8;
/// The node of the window at which the interval begins.
const BEGIN: usize = 3;

/// The data around an interval. What belongs to a cell of the window has the index of the node where the cell begins.
struct Window {
    y: [f32; WINDOW],
    widths: [f32; WINDOW],
    secants: [f32; WINDOW],
    slopes: [f32; WINDOW],
}

/// What an interval's quintic is made of, at its beginning and its end.
struct Ends {
    width: f32,
    values: (f32, f32),
    slopes: (f32, f32),
    curvatures: (f32, f32),
}

impl Window {
    const fn new(samples: &Samples, j: isize) -> Self {
        let (mut x, mut y) = ([0.0; WINDOW], [0.0; WINDOW]);
        let mut k = 0;
        while k < WINDOW {
            (x[k], y[k]) = samples.at(j + k as isize - BEGIN as isize);
            k += 1;
        }
        let (mut widths, mut secants) = ([0.0; WINDOW], [0.0; WINDOW]);
        k = 0;
        while k < WINDOW - 1 {
            widths[k] = x[k + 1] - x[k];
            secants[k] = (y[k + 1] - y[k]) / widths[k];
            k += 1;
        }
        let mut slopes = [0.0; WINDOW];
        k = 1;
        while k < WINDOW - 1 {
            slopes[k] = single_slope(&widths, &secants, k);
            k += 1;
        }
        // Both slopes of a cell are brought down to what it can bear; a node obeys both of its cells.
        let mut bearable = [0.0; WINDOW];
        k = 1;
        while k < WINDOW - 2 {
            let sum = slopes[k].abs() + slopes[k + 1].abs();
            let limit = STEEPEST_PAIR * secants[k].abs();
            bearable[k] = if sum > limit { limit / sum } else { 1.0 };
            k += 1;
        }
        k = 2;
        while k < WINDOW - 2 {
            slopes[k] *= min(bearable[k - 1], bearable[k]);
            k += 1;
        }
        Self {
            y,
            widths,
            secants,
            slopes,
        }
    }

    // The functions called here are inlined; then the compiler sees that every index is in range.
    const fn ends(&self) -> Ends {
        Ends {
            width: self.widths[BEGIN],
            values: (self.y[BEGIN], self.y[BEGIN + 1]),
            slopes: (self.slopes[BEGIN], self.slopes[BEGIN + 1]),
            curvatures: (self.curvature(BEGIN), self.curvature(BEGIN + 1)),
        }
    }

    /// Half of what the cell `k` can bear of curvature against its direction.
    #[inline(always)]
    const fn slack(&self, k: usize) -> f32 {
        let sum = self.slopes[k].abs() + self.slopes[k + 1].abs();
        let slack = self.secants[k].abs() - 0.4 * sum;
        10.0 * max(slack, 0.0) / self.widths[k]
    }

    /// Curvature at node `k` [1/rad²]: the parabola's, limited by both cells.
    #[inline(always)]
    const fn curvature(&self, k: usize) -> f32 {
        let (hl, hr) = (self.widths[k - 1], self.widths[k]);
        let (left, right) = (self.secants[k - 1], self.secants[k]);
        let slope = self.slopes[k].abs();
        // On a rising interval −4d₀/h ≤ s₀ ≤ slack and −slack ≤ s₁ ≤ 4d₁/h; on a falling one the mirror image.
        let (l_low, l_high) = mirrored(left, -self.slack(k - 1), 4.0 * slope / hl);
        let (r_low, r_high) = mirrored(right, -4.0 * slope / hr, self.slack(k));
        let parabola = 2.0 * (right - left) / (hl + hr);
        min(max(parabola, max(l_low, r_low)), min(l_high, r_high))
    }
}

/// Slope [1/rad] of the parabola at node `k`, but zero at an extremum of the data and limited beside it.
const fn single_slope(widths: &[f32; WINDOW], secants: &[f32; WINDOW], k: usize) -> f32 {
    let (left, right) = (secants[k - 1], secants[k]);
    if left * right <= 0.0 {
        return 0.0;
    }
    let (hl, hr) = (widths[k - 1], widths[k]);
    let parabola = (left * hr + right * hl) / (hl + hr);
    let limit = STEEPEST * min(left.abs(), right.abs());
    min(parabola.abs(), limit).copysign(left)
}

/// (`low`, `high`) for a positive `direction`, its mirror image for a negative one, and nothing but zero for none.
const fn mirrored(direction: f32, low: f32, high: f32) -> (f32, f32) {
    if direction > 0.0 {
        (low, high)
    } else if direction < 0.0 {
        (-high, -low)
    } else {
        (0.0, 0.0)
    }
}

const fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

const fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use crate::aero::{Aerodynamics, Node, Polar, Table};
    use crate::air::AngleOfAttack;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::vec::Vec;

    const PI: f64 = core::f32::consts::PI as f64;

    /// The nodes of three turns, the given one in the middle: the continuation written out.
    fn continued(nodes: &[(f64, f64)], symmetric: bool, odd: bool) -> Vec<(f64, f64)> {
        let mut turn: Vec<_> = nodes.to_vec();
        if symmetric {
            let sign = if odd { -1.0 } else { 1.0 };
            let left = nodes.iter().skip(1).rev().map(|&(x, y)| (-x, sign * y));
            turn = left.chain(nodes.iter().copied()).collect();
        }
        // The last node of a turn is the first one of the next.
        let whole = |moved: f64| turn.iter().skip(1).map(move |&(x, y)| (x + moved, y));
        let all = whole(-2.0 * PI).chain(whole(0.0)).chain(whole(2.0 * PI));
        all.collect()
    }

    /// The interpolant at `x`, in double precision over the whole line: the parabolas' slopes and curvatures, limited as the module says.
    fn interpolated(line: &[(f64, f64)], x: f64) -> f64 {
        let width = |k: usize| line[k + 1].0 - line[k].0;
        let secant = |k: usize| (line[k + 1].1 - line[k].1) / width(k);
        let parabola = |k: usize| {
            let (l, r) = (secant(k - 1), secant(k));
            if l * r <= 0.0 {
                return 0.0;
            }
            let (hl, hr) = (width(k - 1), width(k));
            let steepest = 2.0 * l.abs().min(r.abs());
            ((l * hr + r * hl) / (hl + hr)).clamp(-steepest, steepest)
        };
        let share = |k: usize| {
            let sum = parabola(k).abs() + parabola(k + 1).abs();
            (2.5 * secant(k).abs() / sum.max(1e-300)).min(1.0)
        };
        let slope = |k: usize| parabola(k) * share(k - 1).min(share(k));
        // In the direction of the cell: the ordinates of a monotone quintic.
        let slack = |k: usize| {
            let room = secant(k).abs() - 0.4 * (slope(k).abs() + slope(k + 1).abs());
            10.0 * room.max(0.0) / width(k)
        };
        let curvature = |k: usize| {
            let (l, r) = (secant(k - 1), secant(k));
            let both = [
                (l, -slack(k - 1), 4.0 * slope(k).abs() / width(k - 1)),
                (r, -4.0 * slope(k).abs() / width(k), slack(k)),
            ];
            let mut free = 2.0 * (r - l) / (width(k - 1) + width(k));
            let (mut low, mut high) = (f64::MIN, f64::MAX);
            for (direction, least, most) in both {
                let (least, most) = match direction {
                    d if d > 0.0 => (least, most),
                    d if d < 0.0 => (-most, -least),
                    _ => (0.0, 0.0),
                };
                (low, high) = (low.max(least), high.min(most));
            }
            free = free.max(low);
            free.min(high)
        };
        let k = line.partition_point(|node| node.0 <= x) - 1;
        let (h, u) = (width(k), (x - line[k].0) / width(k));
        let (u3, u4, u5) = (u.powi(3), u.powi(4), u.powi(5));
        // Hermite's quintics of value, slope and curvature at both ends.
        line[k].1 * (1.0 - 10.0 * u3 + 15.0 * u4 - 6.0 * u5)
            + line[k + 1].1 * (10.0 * u3 - 15.0 * u4 + 6.0 * u5)
            + h * slope(k) * (u - 6.0 * u3 + 8.0 * u4 - 3.0 * u5)
            + h * slope(k + 1) * (-4.0 * u3 + 7.0 * u4 - 3.0 * u5)
            + h * h * curvature(k) * (0.5 * u * u - 1.5 * u3 + 1.5 * u4 - 0.5 * u5)
            + h * h * curvature(k + 1) * (0.5 * u3 - u4 + 0.5 * u5)
    }

    /// A table with random rows; some rows repeat their neighbour's coefficients.
    fn rows(rng: &mut ChaCha8Rng, symmetric: bool) -> Vec<Node> {
        let count = rng.random_range(6..20);
        let start = if symmetric { 0.0 } else { -180.0 };
        let step = (180.0 - start) / (count - 1) as f32;
        let coarse = rng.random_range(0..2) == 0;
        let mut nodes: Vec<_> = (0..count)
            .map(|n| {
                let off = rng.random_range(-0.35..0.35f32);
                let inside = n > 0 && n + 1 < count;
                let degrees = start + step * (n as f32 + if inside { off } else { 0.0 });
                let mut c = [
                    rng.random_range(-1.5..1.5f32),
                    rng.random_range(0.1..2.0f32),
                ];
                if coarse {
                    c = c.map(|c| 0.5 * (2.0 * c).round());
                }
                Node::from_degrees(degrees, c[0], c[1].max(0.25))
            })
            .collect();
        let last = count - 1;
        if symmetric {
            (nodes[0].c_l, nodes[last].c_l) = (0.0, 0.0);
        } else {
            (nodes[last].c_l, nodes[last].c_d) = (nodes[0].c_l, nodes[0].c_d);
        }
        nodes
    }

    #[test]
    fn random_tables_are_interpolated_as_on_the_whole_line() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for round in 0..400 {
            let symmetric = round % 2 == 0;
            let nodes = rows(&mut rng, symmetric);
            let polar = Polar::<24>::new(&nodes).unwrap();
            let table = Table::new(&polar);
            let of = |value: fn(&Node) -> f32, odd| {
                let nodes: Vec<_> = nodes
                    .iter()
                    .map(|node| (f64::from(node.alpha), f64::from(value(node))))
                    .collect();
                continued(&nodes, symmetric, odd)
            };
            let (lift, drag) = (of(|n| n.c_l, true), of(|n| n.c_d, false));
            for _ in 0..200 {
                let alpha = rng.random_range(-3.1..3.1f32);
                let c = table.coefficients(AngleOfAttack::from_radians(alpha));
                let x = f64::from(alpha);
                // 3e-5: roundings of secants and of six monomials, of coefficients up to 2.
                let off = |got: f32, line: &[_]| (f64::from(got) - interpolated(line, x)).abs();
                assert!(off(c.c_l, &lift) < 3e-5, "{alpha} {nodes:?}");
                assert!(off(c.c_d, &drag) < 3e-5, "{alpha} {nodes:?}");
            }
        }
    }
}
