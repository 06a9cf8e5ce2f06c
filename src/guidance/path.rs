//! Following a path: how fast its parameter may advance.

use super::update::Guidance;
use crate::math;
use crate::ned::Ned;

/// How much of what the position hold takes out of the velocity the path gives back by waiting. Below 1: with more, a
/// vehicle that is ahead would be asked to fly faster still.
const SHARE: f32 = 0.8;
/// Bounds of the time scale.
const SLOWEST: f32 = 0.5;
const FASTEST: f32 = 1.25;
/// Velocities of a path below this [m/s] have no direction to be ahead in.
const LEAST_SPEED: f32 = 0.1;

impl<A, G> Guidance<A, G> {
    /// How fast a path may go on, in multiples of its own speed, between 0.5 and 1.25: slower where the vehicle is behind,
    /// faster where it is ahead.
    ///
    /// `position_error` \[m\] is the position less the path's, `velocity` [m/s] the path's velocity at its own speed. With the
    /// pace p the reference is p times that velocity and p² times its acceleration, and the path's parameter advances at p
    /// times its own rate. What is not finite gives 1.
    pub fn path_time_scale(&self, position_error: Ned, velocity: Ned) -> f32 {
        let square = velocity.norm_squared();
        let ahead = position_error.dot(velocity);
        let least = if square > LEAST_SPEED * LEAST_SPEED {
            square
        } else {
            LEAST_SPEED * LEAST_SPEED
        };
        let scale =
            1.0 + SHARE * self.planner.reference_model.position_gain.forward() * ahead / least;
        if scale.is_finite() {
            math::clamp(scale, SLOWEST, FASTEST)
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::guidance::GuidanceParameters;
    use crate::vehicle::{Vehicle, VehicleParameters};

    #[test]
    fn a_path_waits_for_who_is_behind() {
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model).unwrap();
        let p = GuidanceParameters {
            position_gain_forward: 0.5,
            ..GuidanceParameters::default()
        };
        let guidance = Guidance::new(vehicle, &p).unwrap();
        let v = Ned::new(0.0, 20.0, 0.0);
        let at = |east: f32| guidance.path_time_scale(Ned::new(30.0, east, -5.0), v);
        assert_eq!(at(0.0), 1.0);
        // 10 m behind at a position gain of 0.5 /s: 0.8 · 0.5 · 10 m/s less than 20 m/s.
        assert!((at(-10.0) - 0.8).abs() < 1e-6 && (at(10.0) - 1.2).abs() < 1e-6);
        assert_eq!((at(-1e4), at(1e4)), (0.5, 1.25));
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(at(bad), 1.0);
        }
        assert_eq!(guidance.path_time_scale(v, Ned::ZERO), 1.0);
    }
}
