//! What is flown where neither air data nor an accelerometer tell of the air: slow first, then plain thrust vectoring.
//!
//! A wind that is believed wrongly is a wrong force of the air, and it grows with the speed. So the vehicle flies on in the last
//! wind known only as long as it takes to slow down. Once it is slow, the air is left out of the belief, as with k_a = 0, and
//! what the air does is for position hold and integral.

use crate::math;
use crate::ned::Ned;
use crate::spatial::Reference;

/// Flies blind at a `velocity`: brings `reference` down to what can be flown so, and takes the air out of the belief below
/// the speed `slow` over the last `wind` known [m/s], wholly, and from twice that on down in part.
///
/// Gives whether the vehicle is slow. The wind that comes out is then to be the last one known at the next step: it goes with
/// the vehicle, and who was slow once stays without air, wherever the real wind takes him.
#[cold]
#[inline(never)]
pub(super) fn fly_blind(
    reference: &mut Reference,
    wind: &mut Ned,
    velocity: Ned,
    slow: f32,
) -> bool {
    let asked = &mut reference.velocity;
    let speed = math::sqrt(asked.north * asked.north + asked.east * asked.east);
    if speed > slow {
        let share = slow / speed;
        (asked.north, asked.east) = (asked.north * share, asked.east * share);
        let acceleration = &mut reference.acceleration;
        (acceleration.north, acceleration.east) = (0.0, 0.0);
    }
    let air = velocity - *wind;
    let airspeed = math::sqrt(air.norm_squared());
    *wind += air * math::clamp(2.0 - airspeed / slow, 0.0, 1.0);
    airspeed <= slow
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::Heading;

    fn asked(velocity: Ned) -> Reference {
        Reference {
            velocity,
            acceleration: Ned::new(1.0, -0.5, 0.25),
            heading: Heading::FREE,
        }
    }

    #[test]
    fn the_reference_is_no_faster_than_slow_and_keeps_its_course_and_climb() {
        let bounded = |velocity: Ned| {
            let mut reference = asked(velocity);
            let mut calm = Ned::ZERO;
            fly_blind(&mut reference, &mut calm, Ned::ZERO, 6.0);
            reference
        };
        let fast = bounded(Ned::new(12.0, -16.0, -1.5));
        assert!((fast.velocity - Ned::new(3.6, -4.8, -1.5)).norm_squared() < 1e-10);
        assert_eq!(fast.acceleration, Ned::new(0.0, 0.0, 0.25));
        let slow = Ned::new(3.0, 4.0, 2.0);
        assert_eq!(bounded(slow), asked(slow));
    }

    #[test]
    fn the_air_is_left_out_once_the_vehicle_is_slow() {
        let wind = Ned::new(0.0, 4.0, 0.0);
        let with = |airspeed: f32| {
            let velocity = wind + Ned::new(airspeed, 0.0, 0.0);
            let mut flown = wind;
            let slow = fly_blind(&mut asked(velocity), &mut flown, velocity, 6.0);
            ((velocity - flown).north / airspeed, slow)
        };
        let near = |(share, slow): (f32, bool), wanted: f32, is_slow: bool| {
            // 1e-6: roundings.
            assert!((share - wanted).abs() < 1e-6 && slow == is_slow, "{share}");
        };
        near(with(20.0), 1.0, false);
        near(with(12.0), 1.0, false);
        near(with(9.0), 0.5, false);
        near(with(5.9), 0.0, true);
        near(with(2.0), 0.0, true);
    }

    /// A tailwind that nobody knows of blows the vehicle along. Its speed over ground is not taken for airspeed.
    #[test]
    fn who_was_slow_once_stays_without_air() {
        let mut wind = Ned::ZERO;
        for n in 0..2000 {
            let velocity = Ned::new(0.01 * n as f32, 0.0, 0.0);
            assert!(fly_blind(&mut asked(velocity), &mut wind, velocity, 6.0));
            assert!((velocity - wind).norm_squared() < 1e-6);
        }
    }
}
