//! The height of the reference: to a height by a time, within limits of climb, sink and acceleration.

use crate::math;
use crate::ned::Ned;

/// Velocity per height that is left, near the end [1/s].
const GAIN: f32 = 0.4;
/// Vertical acceleration [m/s²], and the part of it that a stop is planned with.
const ACCELERATION: f32 = 1.0;
const SHARE: f32 = 0.7;
/// Farther than this \[m\] the reference does not go ahead of the vehicle.
const AHEAD: f32 = 8.0;

/// The reference in the vertical.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct HeightReference {
    /// Position \[m\], down.
    pub down: f32,
    /// Velocity [m/s], down.
    pub velocity: f32,
}

/// Where to, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Descent {
    /// Position \[m\], down.
    pub to: f32,
    /// Time until then \[s\].
    pub time: f32,
    /// Greatest climb and sink [m/s].
    pub most: [f32; 2],
}

impl HeightReference {
    /// Where the vehicle is.
    pub fn at(position: Ned, velocity: Ned) -> Self {
        Self {
            down: position.down,
            velocity: velocity.down,
        }
    }

    /// A step of a vehicle at `down` \[m\]: the acceleration [m/s²], and whether the way is steeper than the limits.
    #[inline]
    pub fn step(&mut self, way: &Descent, down: f32, dt: f32) -> (f32, bool) {
        let left = way.to - self.down;
        let braked = math::sqrt((2.0 * SHARE * ACCELERATION * left).abs());
        let near = math::min(GAIN * left.abs(), braked);
        let evenly = left.abs() / math::max(way.time, 1.0 / GAIN);
        let wanted = math::min(near, evenly).copysign(left);
        let [climb, sink] = way.most;
        let ahead = self.down - down;
        let climb = if ahead < -AHEAD { 0.0 } else { climb };
        let sink = if ahead > AHEAD { 0.0 } else { sink };
        let held = math::clamp(wanted, -climb, sink);
        let most = ACCELERATION * dt;
        let change = math::clamp(held - self.velocity, -most, most);
        self.velocity += change;
        self.down += self.velocity * dt;
        let steep = evenly > 1.1 * way.most[usize::from(u8::from(left > 0.0))];
        (if dt > 0.0 { change / dt } else { 0.0 }, steep)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 30 m down in 30 s, at its limits and without passing the height.
    #[test]
    fn a_height_is_reached_in_time_and_not_passed() {
        let mut height = HeightReference::default();
        let (mut fastest, mut lowest, mut late) = (0.0f32, 0.0f32, 0.0);
        for n in 0..6000 {
            let way = Descent {
                to: 30.0,
                time: 30.0 - 0.01 * n as f32,
                most: [3.0, 1.5],
            };
            let (acceleration, _) = height.step(&way, height.down, 0.01);
            assert!(acceleration.abs() <= 1.001);
            fastest = fastest.max(height.velocity);
            lowest = lowest.max(height.down);
            if height.down < 29.0 {
                late = 0.01 * n as f32;
            }
        }
        assert!(lowest <= 30.01 && (height.down - 30.0).abs() < 0.05);
        assert!(fastest <= 1.5 && late < 34.0, "{fastest} {late}");
    }

    /// The reference waits for a vehicle that does not climb.
    #[test]
    fn the_reference_does_not_leave_the_vehicle() {
        let mut height = HeightReference::default();
        let way = Descent {
            to: -100.0,
            time: 1.0,
            most: [3.0, 1.0],
        };
        let mut steep = false;
        for _ in 0..6000 {
            steep |= height.step(&way, 0.0, 0.01).1;
        }
        // 3 m/s are stopped within 4.5 m.
        assert!((-13.0..-8.0).contains(&height.down) && steep);
    }
}
