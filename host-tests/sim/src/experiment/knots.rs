//! A reference velocity by its knots; the position is its integral.

use schemars::JsonSchema;
use serde::Deserialize;

use super::V3;
use super::document::{FieldError, finite, require, speed};
use super::path::Target;

/// The knots by increasing time. The reference velocity is linear between them, constant before and after them.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Knots(pub Vec<Knot>);

/// One knot of the reference velocity.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Knot {
    /// Time \[s\].
    pub t_s: f64,
    /// Velocity down \[m/s\].
    pub down_m_s: f64,
    /// Velocity forward, to the north \[m/s\].
    pub forward_m_s: f64,
    /// Velocity to the east, out of the vertical plane \[m/s\].
    #[serde(default)]
    pub east_m_s: f64,
}

impl Knot {
    fn velocity(&self) -> V3 {
        V3::new(self.forward_m_s, self.east_m_s, self.down_m_s)
    }
}

impl Knots {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        let problem = "must have at least one knot";
        require(!self.0.is_empty(), "path.knots", problem)?;
        for (i, knot) in self.0.iter().enumerate() {
            let field = format!("path.knots[{i}]");
            finite(&field, knot.t_s)?;
            speed(&format!("{field}.down_m_s"), knot.down_m_s)?;
            speed(&format!("{field}.forward_m_s"), knot.forward_m_s)?;
            speed(&format!("{field}.east_m_s"), knot.east_m_s)?;
            let later = i == 0 || knot.t_s > self.0[i - 1].t_s;
            require(later, field, "t_s must increase from knot to knot")?;
        }
        Ok(())
    }

    /// Reference velocity \[m/s\] and acceleration \[m/s²\] at `t` \[s\]. At a knot the acceleration is that of the segment that
    /// begins there.
    pub fn at(&self, t: f64) -> (V3, V3) {
        let next = self.0.partition_point(|k| k.t_s <= t);
        if next == 0 {
            (self.0[0].velocity(), V3::zeros())
        } else if next == self.0.len() {
            (self.0[next - 1].velocity(), V3::zeros())
        } else {
            let (from, to) = (&self.0[next - 1], &self.0[next]);
            let slope = (to.velocity() - from.velocity()) / (to.t_s - from.t_s);
            (from.velocity() + slope * (t - from.t_s), slope)
        }
    }

    /// The reference velocity's integral from 0 to `t` ≥ 0 \[s\], \[m\]: exact.
    pub fn position(&self, t: f64) -> V3 {
        let (mut from, mut position) = (0.0, V3::zeros());
        let passed = self.0.iter().map(|k| k.t_s);
        for knot in passed.filter(|&k| 0.0 < k && k < t) {
            position += self.piece(from, knot);
            from = knot;
        }
        position + self.piece(from, t)
    }

    /// The integral over a piece without knots inside: the mean of both ends, up to the end from the left.
    fn piece(&self, from: f64, to: f64) -> V3 {
        let (start, slope) = self.at(from);
        (to - from) * (start + 0.5 * (to - from) * slope)
    }

    /// What is to be flown at `t` ≥ 0 \[s\].
    pub fn target(&self, t: f64) -> Target {
        let (velocity, acceleration) = self.at(t);
        Target {
            position: self.position(t),
            velocity,
            acceleration,
            heading: None,
        }
    }

    /// Whether nothing points out of the vertical plane to the north.
    pub fn in_plane(&self) -> bool {
        self.0.iter().all(|knot| knot.east_m_s == 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_is_linear_between_knots_and_held_outside() {
        let knot = |t_s, forward_m_s| Knot {
            t_s,
            down_m_s: -1.0,
            forward_m_s,
            east_m_s: 0.0,
        };
        let reference = Knots(vec![knot(1.0, 0.0), knot(3.0, 4.0)]);
        let forward = |t| {
            let (v, a) = reference.at(t);
            assert_eq!((v.y, v.z), (0.0, -1.0));
            (v.x, a.x)
        };
        assert_eq!(forward(0.0), (0.0, 0.0));
        assert_eq!(forward(1.0), (0.0, 2.0));
        assert_eq!(forward(2.5), (3.0, 2.0));
        assert_eq!(forward(3.0), (4.0, 0.0));
        assert_eq!(forward(9.0), (4.0, 0.0));
        for (t, [down, forward]) in [(0.5, [-0.5, 0.0]), (2.0, [-2.0, 1.0]), (5.0, [-5.0, 12.0])] {
            assert_eq!(reference.position(t), V3::new(forward, 0.0, down));
        }
    }
}
