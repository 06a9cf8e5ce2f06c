//! The interpolant of tables: C², local, and monotone wherever its data are.
//!
//! Each node takes value, slope and curvature from the parabola through it and its neighbours, limited so that the
//! quintic Hermite polynomial of every interval is monotone: its Bernstein ordinates are then in order, which is
//! sufficient. Extrema stay at nodes, nothing overshoots, nothing rings.

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
        let j = j as isize;
        let h = self.at(j + 1).0 - self.at(j).0;
        let (y0, y1) = (self.at(j).1, self.at(j + 1).1);
        let (d0, d1) = (h * self.slope(j), h * self.slope(j + 1));
        let (s0, s1) = (
            0.5 * h * h * self.curvature(j),
            0.5 * h * h * self.curvature(j + 1),
        );
        // What is left at u = 1, in value, slope and half curvature, for the cubic to quintic terms.
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
    const fn at(&self, i: isize) -> (f32, f32) {
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
            let node = &self.nodes[i as usize];
            return (node.alpha, self.value(node));
        };
        let node = &self.nodes[inside as usize];
        let y = self.value(node);
        if !self.symmetric {
            return (node.alpha + moved, y);
        }
        let x = if i < 0 { 0.0 } else { TURN } - node.alpha;
        match self.of {
            Of::Lift => (x, -y),
            Of::Drag => (x, y),
        }
    }

    const fn value(&self, node: &Node) -> f32 {
        match self.of {
            Of::Lift => node.c_l,
            Of::Drag => node.c_d,
        }
    }

    const fn width(&self, j: isize) -> f32 {
        self.at(j + 1).0 - self.at(j).0
    }

    const fn secant(&self, j: isize) -> f32 {
        (self.at(j + 1).1 - self.at(j).1) / self.width(j)
    }

    /// Slope of the parabola, but zero at an extremum of the data and limited beside it.
    const fn single_slope(&self, i: isize) -> f32 {
        let (left, right) = (self.secant(i - 1), self.secant(i));
        if left * right <= 0.0 {
            return 0.0;
        }
        let (hl, hr) = (self.width(i - 1), self.width(i));
        let parabola = (left * hr + right * hl) / (hl + hr);
        let limit = STEEPEST * min(left.abs(), right.abs());
        min(parabola.abs(), limit).copysign(left)
    }

    /// Factor that the slopes at the ends of interval `j` can bear.
    const fn bearable(&self, j: isize) -> f32 {
        let sum = self.single_slope(j).abs() + self.single_slope(j + 1).abs();
        let limit = STEEPEST_PAIR * self.secant(j).abs();
        if sum > limit { limit / sum } else { 1.0 }
    }

    /// Slope at node `i` [1/rad].
    const fn slope(&self, i: isize) -> f32 {
        self.single_slope(i) * min(self.bearable(i - 1), self.bearable(i))
    }

    /// Half of what the interval `j` can bear of curvature against its direction.
    const fn slack(&self, j: isize) -> f32 {
        let sum = self.slope(j).abs() + self.slope(j + 1).abs();
        let slack = self.secant(j).abs() - 0.4 * sum;
        10.0 * max(slack, 0.0) / self.width(j)
    }

    /// Curvature at node `i` [1/rad²].
    const fn curvature(&self, i: isize) -> f32 {
        let (hl, hr) = (self.width(i - 1), self.width(i));
        let (left, right) = (self.secant(i - 1), self.secant(i));
        let slope = self.slope(i).abs();
        // On a rising interval −4d₀/h ≤ s₀ ≤ slack and −slack ≤ s₁ ≤ 4d₁/h; on a falling one the mirror image.
        let (l_low, l_high) = mirrored(left, -self.slack(i - 1), 4.0 * slope / hl);
        let (r_low, r_high) = mirrored(right, -4.0 * slope / hr, self.slack(i));
        let parabola = 2.0 * (right - left) / (hl + hr);
        min(max(parabola, max(l_low, r_low)), min(l_high, r_high))
    }
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
