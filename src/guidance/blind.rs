//! What is flown where neither air data nor an accelerometer tell of the air: slow first, then plain thrust vectoring.
//!
//! A wind that is believed wrongly is a wrong force of the air, and it grows with the speed. So the vehicle flies on in the last
//! wind known only as long as it takes to slow down. Once it is slow, the air is left out of the belief, as with k_a = 0, and
//! what the air does is for position hold and integral.

use crate::math;
use crate::ned::Ned;
use crate::spatial::Reference;

/// What is flown blind.
pub(super) struct Blind {
    /// The reference, no faster than can be flown so.
    pub reference: Reference,
    /// The wind that is flown with [m/s].
    pub wind: Ned,
    /// Whether the vehicle is slow. The wind is then to be the last one known at the next step: it goes with the vehicle, and
    /// who was slow once stays without air, wherever the real wind takes him.
    pub slow: bool,
}

impl Blind {
    /// Flies to `reference` at a `velocity`, the last wind known being `wind` [m/s]. Below the speed `slow` [m/s] over that air
    /// there is none of it, beyond twice that all of it, and in between a part.
    #[cold]
    #[inline(never)]
    pub fn new(reference: &Reference, velocity: Ned, wind: Ned, slow: f32) -> Self {
        let asked = reference.velocity;
        let speed = math::sqrt(asked.north * asked.north + asked.east * asked.east);
        let mut reference = *reference;
        if speed > slow {
            let share = slow / speed;
            reference.velocity = Ned::new(asked.north * share, asked.east * share, asked.down);
            reference.acceleration.north = 0.0;
            reference.acceleration.east = 0.0;
        }
        let air = velocity - wind;
        let airspeed = math::sqrt(air.norm_squared());
        let without = math::clamp(2.0 - airspeed / slow, 0.0, 1.0);
        Self {
            reference,
            wind: wind + air * without,
            slow: airspeed <= slow,
        }
    }
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
        let fast = asked(Ned::new(12.0, -16.0, -1.5));
        let blind = Blind::new(&fast, Ned::ZERO, Ned::ZERO, 6.0);
        let off = blind.reference.velocity - Ned::new(3.6, -4.8, -1.5);
        assert!(off.norm_squared() < 1e-10);
        assert_eq!(blind.reference.acceleration, Ned::new(0.0, 0.0, 0.25));
        let slow = asked(Ned::new(3.0, 4.0, 2.0));
        assert_eq!(Blind::new(&slow, Ned::ZERO, Ned::ZERO, 6.0).reference, slow);
    }

    #[test]
    fn the_air_is_left_out_once_the_vehicle_is_slow() {
        let wind = Ned::new(0.0, 4.0, 0.0);
        let with = |airspeed: f32| {
            let velocity = wind + Ned::new(airspeed, 0.0, 0.0);
            let blind = Blind::new(&asked(velocity), velocity, wind, 6.0);
            (velocity - blind.wind).north / airspeed
        };
        // 1e-6: roundings.
        assert!((with(20.0) - 1.0).abs() < 1e-6 && (with(12.0) - 1.0).abs() < 1e-6);
        assert!((with(9.0) - 0.5).abs() < 1e-6);
        assert!(with(6.0).abs() < 1e-6 && with(2.0).abs() < 1e-6);
    }

    /// A tailwind that nobody knows of blows the vehicle along. Its speed over ground is not taken for airspeed.
    #[test]
    fn who_was_slow_once_stays_without_air() {
        let mut wind = Ned::ZERO;
        for n in 0..2000 {
            let velocity = Ned::new(0.01 * n as f32, 0.0, 0.0);
            let blind = Blind::new(&asked(velocity), velocity, wind, 6.0);
            assert!(blind.slow && (velocity - blind.wind).norm_squared() < 1e-6);
            wind = blind.wind;
        }
    }
}
