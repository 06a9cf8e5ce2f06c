//! What is flown where neither air data nor an accelerometer tell of the air: slow first, then plain thrust vectoring.
//!
//! A wind that is believed wrongly is a wrong force of the air, and it grows with the speed. So the vehicle flies on in the last
//! wind known only as long as it takes to slow down. Once it is slow, the air is left out of the belief, as with k_a = 0, and
//! what the air does is for the integral; the place is not held.

use crate::math;

/// What is flown blind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AirDataFallback {
    /// Part of the horizontal velocity asked for that is flown. Less than 1 where that is too fast to be flown so; then no
    /// horizontal acceleration is.
    pub speed_scale: f32,
    /// Part of the air velocity that is left out of the belief.
    pub air_removed: f32,
}

impl AirDataFallback {
    /// What is flown blind where the square of the horizontal velocity asked for is `asked_squared` [m²/s²].
    ///
    /// No more than `slow` [m/s] is flown. The air is left out below that speed, and in part below twice that speed. The speed
    /// is the lesser of the vehicle's speeds over ground and over the air of the last wind known: `speed_squared` is its square.
    ///
    /// Once `without` is 1 the wind that is flown with is the vehicle's own velocity, and is to be the last one known at the
    /// next step. So a vehicle that was slow once stays without air, wherever the real wind takes it.
    #[cold]
    #[inline(never)]
    pub fn new(asked_squared: f32, speed_squared: f32, slow: f32) -> Self {
        // The absolute values of what is positive: the roots then need no call of the C library.
        let asked = math::sqrt(asked_squared.abs());
        let speed = math::sqrt(speed_squared.abs());
        Self {
            speed_scale: if asked > slow { slow / asked } else { 1.0 },
            air_removed: math::clamp(2.0 - speed / slow, 0.0, 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_is_asked_than_what_is_slow() {
        let speed_scale = |asked: f32| AirDataFallback::new(asked * asked, 0.0, 6.0).speed_scale;
        assert_eq!(
            (speed_scale(20.0), speed_scale(6.0), speed_scale(0.0)),
            (0.3, 1.0, 1.0)
        );
    }

    #[test]
    fn the_air_is_left_out_once_the_vehicle_is_slow() {
        let air_removed = |speed: f32| AirDataFallback::new(0.0, speed * speed, 6.0).air_removed;
        assert_eq!((air_removed(20.0), air_removed(12.0)), (0.0, 0.0));
        assert_eq!(
            (air_removed(9.0), air_removed(6.0), air_removed(2.0)),
            (0.5, 1.0, 1.0)
        );
    }
}
