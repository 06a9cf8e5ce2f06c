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

    // What it calls is inlined, so that no index is left to check.
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
