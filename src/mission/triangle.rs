//! The wind triangle: speed over ground along a course, of an airspeed in wind.

use crate::math;
use crate::ned::Ned;

/// Part of the airspeed that must be left along the course, and speed over ground [m/s]: with less the vehicle stands on the wind.
const LEAST_SHARE: f32 = 0.2;
const LEAST_SPEED: f32 = 1.0;

/// An airspeed along a course in wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Triangle {
    /// Air velocity along the course [m/s].
    pub air: f32,
    /// Wind along the course and to its right [m/s].
    pub wind: [f32; 2],
}

impl Triangle {
    /// An `airspeed` [m/s] along the level unit vector `along`; none where the wind is stronger.
    pub fn new(airspeed: f32, wind: Ned, along: Ned) -> Option<Self> {
        let (with, right) = (
            wind.north * along.north + wind.east * along.east,
            wind.east * along.north - wind.north * along.east,
        );
        let square = airspeed * airspeed - right * right;
        let least = LEAST_SHARE * airspeed;
        if square.is_nan() || square <= least * least {
            return None;
        }
        let air = math::sqrt(square.abs());
        (air + with >= LEAST_SPEED).then_some(Self {
            air,
            wind: [with, right],
        })
    }

    /// Speed over ground [m/s] with this part of the air velocity along the course.
    pub fn ground(&self, part: f32) -> f32 {
        self.wind[0] + part * self.air
    }

    /// Change of that speed [m/s²] while the course turns to the right at `rate` [rad/s], at this constant airspeed.
    pub fn change(&self, part: f32, rate: f32) -> f32 {
        rate * self.wind[1] * (1.0 + part * self.wind[0] / self.air)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIND: Ned = Ned::new(3.0, -5.0, 0.0);

    /// The air velocity has the airspeed, whatever the course; and its change with the course is the one told.
    #[test]
    fn the_airspeed_is_kept_on_every_course() {
        let at = |course: f32| {
            let (sin, cos) = math::sin_cos(course);
            let along = Ned::new(cos, sin, 0.0);
            (Triangle::new(20.0, WIND, along).unwrap(), along)
        };
        for n in 0..12 {
            let course = 0.5 * n as f32;
            let (triangle, along) = at(course);
            let air = along * triangle.ground(1.0) - WIND;
            assert!((math::sqrt(air.norm_squared()) - 20.0).abs() < 1e-4);
            let difference =
                (at(course + 0.01).0.ground(1.0) - at(course - 0.01).0.ground(1.0)) / 0.02;
            assert!((difference - triangle.change(1.0, 1.0)).abs() < 2e-3);
        }
    }

    #[test]
    fn a_stronger_wind_leaves_no_way() {
        let north = Ned::new(1.0, 0.0, 0.0);
        let against = |wind| Triangle::new(10.0, wind, north);
        assert!(against(Ned::new(-9.5, 0.0, 0.0)).is_none());
        assert!(against(Ned::new(0.0, 9.9, 0.0)).is_none());
        assert!(against(Ned::new(12.0, 0.0, 0.0)).is_some());
        assert!(against(Ned::new(f32::NAN, 0.0, 0.0)).is_none());
    }
}
