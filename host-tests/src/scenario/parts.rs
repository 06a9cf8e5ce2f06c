//! A scenario's other tables: controller, reference, wind, initial state.

use serde::Deserialize;

use super::vehicle::{VehicleSpec, refused};
use super::{FieldError, finite};
use crate::reference::{Gains, Vector};

/// Which law is flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// `eq:inputsVCeR`.
    Robust,
    /// `lawsVGen`.
    Full,
}

/// `[controller]`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerSpec {
    /// The law.
    pub law: Law,
    /// Whether the law is given the measured air acceleration and the reference's jerk.
    #[serde(default)]
    pub feed_forward: bool,
    /// What the controller believes about the vehicle; the truth if left out.
    pub vehicle: Option<VehicleSpec>,
    /// The gains.
    pub gains: GainsSpec,
}

/// `[controller.gains]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GainsSpec {
    /// k1 \[s/m\].
    pub k1: f64,
    /// k2 \[rad/(N·m)\].
    pub k2: f64,
    /// k3 \[rad/s\].
    pub k3: f64,
    /// τ \[N\].
    pub tau_n: f64,
}

impl GainsSpec {
    /// The gains as the core takes them; `table` is where they stand in the file.
    pub fn control_gains(&self, table: &str) -> Result<alula::Gains, FieldError> {
        alula::Gains::new(self.parameters()).map_err(|e| refused(table, e))
    }

    pub(super) fn parameters(&self) -> alula::GainParameters {
        alula::GainParameters {
            k1: self.k1 as f32,
            k2: self.k2 as f32,
            k3: self.k3 as f32,
            tau: self.tau_n as f32,
        }
    }

    /// The gains in double precision.
    pub fn reference_gains(&self) -> Gains {
        Gains {
            k1: self.k1,
            k2: self.k2,
            k3: self.k3,
            tau: self.tau_n,
        }
    }
}

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
    pub(crate) fn validate(&self) -> Result<(), FieldError> {
        let error = |problem: String| Err(FieldError::new("reference.knots", problem));
        if self.knots.is_empty() {
            return error("must have at least one knot".into());
        }
        for (i, knot) in self.knots.iter().enumerate() {
            let field = format!("reference.knots[{i}]");
            finite(&field, knot.t_s)?;
            finite(&field, knot.down_m_s)?;
            finite(&field, knot.forward_m_s)?;
            if i > 0 && knot.t_s <= self.knots[i - 1].t_s {
                return Err(FieldError::new(
                    field,
                    "t_s must increase from knot to knot",
                ));
            }
        }
        Ok(())
    }

    /// Reference velocity \[m/s\] and acceleration \[m/s²\] at `t` \[s\]. At a knot the
    /// acceleration is that of the segment that begins there.
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
        let inner = self.knots.iter().map(|k| k.t_s);
        let mut from = 0.0;
        let mut position = Vector::zeros();
        for to in inner.filter(|&k| 0.0 < k && k < t).chain([t]) {
            // Linear in between, up to the end from the left: the mean of both ends.
            let (start, slope) = self.at(from);
            position += (to - from) * (start + 0.5 * (to - from) * slope);
            from = to;
        }
        position
    }

    /// The times of the knots inside (0, `end`), with 0 and `end` \[s\].
    pub fn breaks(&self, end: f64) -> Vec<f64> {
        let inner = self.knots.iter().map(|k| k.t_s);
        let inner = inner.filter(|&k| 0.0 < k && k < end);
        std::iter::once(0.0).chain(inner).chain([end]).collect()
    }
}

/// `[wind]`: a steady wind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WindSpec {
    /// Down \[m/s\].
    pub down_m_s: f64,
    /// Forward \[m/s\]: positive is a tailwind.
    pub forward_m_s: f64,
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
    /// Thrust just before the first control step \[N\]; it enters the first measured acceleration.
    pub thrust_n: f64,
}

impl InitialSpec {
    pub(crate) fn validate(&self) -> Result<(), FieldError> {
        finite("initial.down_m_s", self.down_m_s)?;
        finite("initial.forward_m_s", self.forward_m_s)?;
        finite("initial.theta_deg", self.theta_deg)?;
        finite("initial.thrust_n", self.thrust_n)
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
        assert_eq!(reference.position(0.5), Vector::new(-0.5, 0.0));
        assert_eq!(reference.position(2.0), Vector::new(-2.0, 1.0));
        assert_eq!(reference.position(5.0), Vector::new(-5.0, 4.0 + 8.0));
        assert_eq!(reference.breaks(9.0), [0.0, 1.0, 3.0, 9.0]);
        assert_eq!(reference.breaks(2.0), [0.0, 1.0, 2.0]);
    }
}
