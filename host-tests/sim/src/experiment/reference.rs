//! The reference velocity, and where a flight starts.

use serde::Deserialize;

use super::document::{FieldError, angle, finite, rate, require, speed};
use crate::reference::Vector;

/// `[reference]`: the reference velocity, linear between knots, constant before and after them.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceSpec {
    /// The knots, by increasing time.
    pub knots: Vec<Knot>,
}

/// One knot of the reference velocity.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Knot {
    /// Time \[s\].
    pub t_s: f64,
    /// Velocity down \[m/s\].
    pub down_m_s: f64,
    /// Velocity forward \[m/s\].
    pub forward_m_s: f64,
}

impl ReferenceSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        let problem = "must have at least one knot";
        require(!self.knots.is_empty(), "reference.knots", problem)?;
        for (i, knot) in self.knots.iter().enumerate() {
            let field = format!("reference.knots[{i}]");
            finite(&field, knot.t_s)?;
            speed(&format!("{field}.down_m_s"), knot.down_m_s)?;
            speed(&format!("{field}.forward_m_s"), knot.forward_m_s)?;
            let later = i == 0 || knot.t_s > self.knots[i - 1].t_s;
            require(later, field, "t_s must increase from knot to knot")?;
        }
        Ok(())
    }

    /// Reference velocity \[m/s\] and acceleration \[m/s²\] at `t` \[s\]. At a knot the acceleration is that of the segment that
    /// begins there.
    pub fn at(&self, t: f64) -> (Vector, Vector) {
        let velocity = |k: &Knot| Vector::new(k.down_m_s, k.forward_m_s);
        let next = self.knots.partition_point(|k| k.t_s <= t);
        if next == 0 {
            (velocity(&self.knots[0]), Vector::zeros())
        } else if next == self.knots.len() {
            (velocity(&self.knots[next - 1]), Vector::zeros())
        } else {
            let (from, to) = (&self.knots[next - 1], &self.knots[next]);
            let slope = (velocity(to) - velocity(from)) / (to.t_s - from.t_s);
            (velocity(from) + slope * (t - from.t_s), slope)
        }
    }

    /// The reference velocity's integral from 0 to `t` ≥ 0 \[s\], \[m\]: exact.
    pub fn position(&self, t: f64) -> Vector {
        let ends = self.breaks(t);
        let piece = |ends: &[f64]| self.piece(ends[0], ends[1]);
        ends.windows(2).map(piece).sum()
    }

    /// The integral over a piece without knots inside: the mean of both ends, up to the end from the left.
    fn piece(&self, from: f64, to: f64) -> Vector {
        let (start, slope) = self.at(from);
        (to - from) * (start + 0.5 * (to - from) * slope)
    }

    /// Positions at times that increase: what [`Self::position`] gives, without adding up every knot each time.
    pub fn positions(&self) -> impl FnMut(f64) -> Vector {
        let mut done = (0.0, Vector::zeros());
        let mut knots = self.knots.iter().map(|k| k.t_s).peekable();
        move |t| {
            while let Some(knot) = knots.next_if(|&knot| knot < t) {
                if knot > 0.0 {
                    done = (knot, done.1 + self.piece(done.0, knot));
                }
            }
            done.1 + self.piece(done.0, t)
        }
    }

    /// The times of the knots inside (0, `end`), with 0 and `end` \[s\].
    pub fn breaks(&self, end: f64) -> Vec<f64> {
        let inner = self.knots.iter().map(|k| k.t_s);
        let inner = inner.filter(|&k| 0.0 < k && k < end);
        std::iter::once(0.0).chain(inner).chain([end]).collect()
    }
}

/// `[initial]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct InitialSpec {
    /// Velocity down \[m/s\].
    pub down_m_s: f64,
    /// Velocity forward \[m/s\].
    pub forward_m_s: f64,
    /// θ \[°\].
    pub theta_deg: f64,
    /// A speed that is added in a direction of its own \[m/s\].
    pub speed_m_s: f64,
    /// That direction \[°\]: 0 down, 90 forward.
    pub path_deg: f64,
    /// ω \[rad/s\]. Without a lag of the rate loop it is what is commanded at once.
    pub rate_rad_s: f64,
    /// Thrust before the first command acts \[N\].
    pub thrust_n: f64,
}

impl InitialSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        speed("initial.down_m_s", self.down_m_s)?;
        speed("initial.forward_m_s", self.forward_m_s)?;
        speed("initial.speed_m_s", self.speed_m_s)?;
        angle("initial.path_deg", self.path_deg)?;
        angle("initial.theta_deg", self.theta_deg)?;
        rate("initial.rate_rad_s", self.rate_rad_s)?;
        finite("initial.thrust_n", self.thrust_n)
    }

    /// The velocity \[m/s\].
    pub fn velocity(&self) -> Vector {
        let (forward, down) = self.path_deg.to_radians().sin_cos();
        Vector::new(self.down_m_s, self.forward_m_s) + self.speed_m_s * Vector::new(down, forward)
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
        };
        let reference = ReferenceSpec {
            knots: vec![knot(1.0, 0.0), knot(3.0, 4.0)],
        };
        let forward = |t| {
            let (v, a) = reference.at(t);
            assert_eq!(v.x, -1.0);
            (v.y, a.y)
        };
        assert_eq!(forward(0.0), (0.0, 0.0));
        assert_eq!(forward(1.0), (0.0, 2.0));
        assert_eq!(forward(2.5), (3.0, 2.0));
        assert_eq!(forward(3.0), (4.0, 0.0));
        assert_eq!(forward(9.0), (4.0, 0.0));
        let mut running = reference.positions();
        for (t, x) in [(0.5, [-0.5, 0.0]), (2.0, [-2.0, 1.0]), (5.0, [-5.0, 12.0])] {
            assert_eq!(reference.position(t), Vector::from(x));
            assert_eq!(running(t), Vector::from(x));
        }
        assert_eq!(reference.breaks(9.0), [0.0, 1.0, 3.0, 9.0]);
        assert_eq!(reference.breaks(2.0), [0.0, 1.0, 2.0]);
    }

    #[test]
    fn a_start_adds_a_speed_in_a_direction() {
        let start = |path_deg| InitialSpec {
            down_m_s: 1.0,
            speed_m_s: 10.0,
            path_deg,
            ..InitialSpec::default()
        };
        let near =
            |path_deg, v: [f64; 2]| (start(path_deg).velocity() - Vector::from(v)).norm() < 1e-9;
        assert!(near(0.0, [11.0, 0.0]) && near(90.0, [1.0, 10.0]) && near(180.0, [-9.0, 0.0]));
    }
}
