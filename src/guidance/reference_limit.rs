//! Acceleration limit on the reference: the velocity followed never changes faster than the vehicle may.

use super::parameters::GuidanceParameters;
use super::status::Status;
use crate::frame::Inertial;
use crate::math;
use crate::reference::{MAX_SPEED, Reference};

/// Follows a reference with bounded acceleration.
///
/// The velocity followed, v_s, obeys v̇_s = a_r + rate·(v_r − v_s), cut to the largest acceleration. A reference whose
/// a_r is the derivative of its v_r passes unchanged while it keeps inside the limit; a step of v_r becomes a ramp
/// that ends softly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReferenceLimit {
    acceleration: f32,
    rate: f32,
}

/// The velocity followed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReferenceState {
    /// v_s [m/s].
    pub velocity: Inertial,
}

impl ReferenceState {
    /// Whether the velocity is one that a reference may have.
    #[inline(always)]
    pub(super) fn is_sound(&self) -> bool {
        self.velocity.norm_squared() <= MAX_SPEED * MAX_SPEED
    }
}

impl ReferenceLimit {
    /// The limit with these parameters, which have been checked.
    pub fn new(p: &GuidanceParameters) -> Self {
        Self {
            acceleration: p.max_acceleration,
            rate: p.return_rate,
        }
    }

    /// What to follow now; `state` then moves on by `dt` \[s\].
    #[inline(always)]
    pub fn update(
        &self,
        state: &mut ReferenceState,
        reference: &Reference,
        dt: f32,
    ) -> (Reference, Status) {
        // A control step longer than the return takes would overshoot it.
        let rate = math::min(self.rate, 1.0 / dt);
        let velocity = state.velocity;
        let wanted = reference.acceleration + (reference.velocity - velocity) * rate;
        let (acceleration, cut) = self.cut(wanted);
        state.velocity = velocity + acceleration * dt;
        (
            Reference {
                velocity,
                acceleration,
            },
            Status::REFERENCE.when(cut),
        )
    }

    /// `acceleration`, shortened to the largest there may be.
    #[inline(always)]
    pub(super) fn cut(&self, acceleration: Inertial) -> (Inertial, bool) {
        let square = acceleration.norm_squared();
        if square > self.acceleration * self.acceleration {
            let scale = self.acceleration / math::sqrt(square);
            (acceleration * scale, true)
        } else {
            (acceleration, false)
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const DT: f32 = 0.01;

    fn limit() -> ReferenceLimit {
        ReferenceLimit::new(&GuidanceParameters::default())
    }

    #[test]
    fn a_consistent_reference_inside_the_limit_passes() {
        let mut state = ReferenceState::default();
        for n in 0..1000 {
            let reference = Reference {
                velocity: Inertial::new(0.0, 2.0 * (n as f32 * DT)),
                acceleration: Inertial::new(0.0, 2.0),
            };
            let (got, status) = limit().update(&mut state, &reference, DT);
            assert_eq!(status, Status::empty());
            // 1e-4: roundings of a thousand additions, which the return holds down.
            assert!((got.velocity - reference.velocity).norm_squared() < 1e-8);
            assert!((got.acceleration - reference.acceleration).norm_squared() < 1e-8);
        }
    }

    #[test]
    fn a_step_becomes_a_ramp_with_a_soft_end() {
        let mut state = ReferenceState::default();
        let reference = Reference {
            velocity: Inertial::new(-3.0, 4.0),
            acceleration: Inertial::ZERO,
        };
        let mut last = Inertial::ZERO;
        for n in 0..1500 {
            let (got, status) = limit().update(&mut state, &reference, DT);
            let moved = (got.velocity - last).norm_squared().sqrt();
            assert!(moved <= 3.0 * DT * 1.0001);
            // 5 m/s at 0.8/s ask for 4 m/s²: cut until 3.75 m/s are left, after 1.25/3 s.
            assert_eq!(status == Status::REFERENCE, n < 42, "{n}");
            last = got.velocity;
        }
        assert!((last - reference.velocity).norm_squared().sqrt() < 1e-3);
    }

    #[test]
    fn a_long_step_does_not_overshoot() {
        let fast = ReferenceLimit::new(&GuidanceParameters {
            max_acceleration: 1e3,
            return_rate: 100.0,
            ..GuidanceParameters::default()
        });
        let mut state = ReferenceState::default();
        let reference = Reference {
            velocity: Inertial::new(0.0, 1.0),
            acceleration: Inertial::ZERO,
        };
        fast.update(&mut state, &reference, 0.1);
        assert!((state.velocity.forward() - 1.0).abs() < 1e-6);
    }
}
