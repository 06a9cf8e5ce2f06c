//! A path over ground at an airspeed, as a reference: along it nothing is held but the airspeed.

use super::parameters::MissionParameters;
use super::segment::{Path, level, right_of};
use super::triangle::Triangle;
use crate::math;
use crate::ned::Ned;

/// Part of the drag that a slower airspeed may ask for.
const DRAG_SHARE: f32 = 0.8;

/// How far ahead a bank is asked for \[s\]: about the time in which it begins.
const LEAD: f32 = 0.13;

/// How a path is being flown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct FollowState {
    pub path: Path,
    /// Airspeed asked for [m/s].
    pub airspeed: f32,
    /// Part of the air velocity along the course that is asked for so far: from hover it grows to 1.
    part: f32,
    /// Half of the time in which the bank of the path goes from one side to the other \[s\]: it begins so long before a bend, and ends so long behind.
    pub banking: f32,
}

/// Where the vehicle is, and the wind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub position: Ned,
    pub velocity: Ned,
    pub wind: Ned,
}

/// What is to be flown in a step, level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Followed {
    pub velocity: Ned,
    pub acceleration: Ned,
    /// How far the vehicle is from the path, across it \[m\].
    pub error: Ned,
    /// The same with its sign: to the right is positive.
    pub right: f32,
    /// Acceleration to the side, without its sign [m/s²].
    pub turn: f32,
    /// Whether the wind is stronger than the airspeed: the nose is held into it.
    pub drifting: bool,
    /// Speed over ground [m/s].
    pub ground: f32,
}

impl FollowState {
    /// Begins its path, which begins at the vehicle, from its present velocity.
    pub fn begin(&mut self, airspeed: f32, seen: &Seen) {
        (self.airspeed, self.part) = (airspeed, 1.0);
        let along = self.path.start;
        if let Some(triangle) = Triangle::new(airspeed, seen.wind, along) {
            let air = seen.velocity - seen.wind;
            let ahead = air.north * along.north + air.east * along.east;
            self.part = math::clamp(ahead / triangle.air, -1.0, 1.0);
        }
    }

    /// Whether it is flown at the `wanted` airspeed [m/s], and not on the way to it.
    pub fn is_settled(&self, wanted: f32) -> bool {
        self.part >= 1.0 && (self.airspeed - wanted).abs() < 0.02 * wanted
    }

    /// Time before its end from which on the path after it is to be known \[s\]: its first turn is banked for.
    pub fn lead(&self) -> f32 {
        LEAD + self.banking
    }

    /// A step at an airspeed of `wanted` [m/s], where drag gives this deceleration [m/s²].
    #[inline]
    pub fn step(
        &mut self,
        p: &MissionParameters,
        slowing: f32,
        seen: &Seen,
        wanted: f32,
        dt: f32,
    ) -> Followed {
        let nearest = self.path.advance(seen.position);
        let missing = wanted - self.airspeed;
        if missing != 0.0 {
            let slower = math::min(DRAG_SHARE * slowing, p.acceleration);
            self.airspeed += math::clamp(missing, -slower * dt, p.acceleration * dt);
        }
        // The wing cannot brake: what is faster than asked for is let slow down by itself.
        let there = level(seen.velocity - seen.wind);
        let airspeed = math::max(self.airspeed, p.yield_share * there);
        let Some(triangle) = Triangle::new(airspeed, seen.wind, nearest.along) else {
            return self.on_the_wind(airspeed, seen.wind);
        };
        let mut gain = 0.0;
        if self.part < 1.0 && dt > 0.0 {
            let growth = math::min(1.0 - self.part, p.acceleration * dt / triangle.air);
            self.part += growth;
            gain = growth / dt * triangle.air;
        }
        let speed = triangle.ground(self.part);
        let rate = speed * self.path.curvature(LEAD * speed, self.banking * speed);
        let across = right_of(nearest.along);
        Followed {
            velocity: nearest.along * speed,
            ground: speed.abs(),
            acceleration: nearest.along * (triangle.change(self.part, rate) + gain)
                + across * (speed * rate),
            error: across * nearest.right,
            right: nearest.right,
            turn: (speed * rate).abs(),
            drifting: false,
        }
    }

    /// The nose into a wind that is stronger than the airspeed.
    fn on_the_wind(&mut self, airspeed: f32, wind: Ned) -> Followed {
        let strength = math::max(level(wind), 1e-3);
        let drift = 1.0 - airspeed / strength;
        self.part = 1.0;
        Followed {
            velocity: Ned::new(wind.north * drift, wind.east * drift, 0.0),
            ground: strength * drift.abs(),
            acceleration: Ned::ZERO,
            error: Ned::ZERO,
            right: 0.0,
            turn: 0.0,
            drifting: true,
        }
    }
}
