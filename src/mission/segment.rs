//! A path over ground: up to three lines and arcs, and the place on it nearest to the vehicle.

use crate::math::{self, PI};
use crate::ned::Ned;

/// Greatest length of a segment \[m\]: an arc that does not end.
pub(super) const ENDLESS: f32 = 1e9;

/// `angle` \[rad\] brought into [−π, π).
pub(super) fn wrap(angle: f32) -> f32 {
    const ROUND: f32 = 12_582_912.0;
    let turns = (angle * (0.5 / PI) + ROUND) - ROUND;
    // Of many turns the rounding leaves more than a turn.
    math::clamp(angle - 2.0 * PI * turns, -PI, PI)
}

/// The level unit vector along `course` \[rad\].
pub(super) fn along(course: f32) -> Ned {
    let (sin, cos) = math::sin_cos(course);
    Ned::new(cos, sin, 0.0)
}

/// The vector to the right of a level one.
pub(super) fn right_of(v: Ned) -> Ned {
    Ned::new(-v.east, v.north, 0.0)
}

/// Length of the level part.
pub(super) fn level(v: Ned) -> f32 {
    math::sqrt((v.north * v.north + v.east * v.east).abs())
}

/// A place and a course.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Pose {
    /// Level \[m\].
    pub place: Ned,
    /// From north to the east \[rad\].
    pub course: f32,
}

/// A line or an arc.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Segment {
    /// Where it begins.
    pub from: Pose,
    /// Curvature, positive to the right \[1/m\].
    pub curvature: f32,
    /// \[m\].
    pub length: f32,
}

/// The place on a segment that is nearest to the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nearest {
    /// Way along the segment \[m\].
    pub way: f32,
    /// Unit vector along it there.
    pub along: Ned,
    /// How far the vehicle is to its right \[m\].
    pub right: f32,
}

impl Segment {
    /// The place and the course at `way` \[m\].
    pub fn at(&self, way: f32) -> Pose {
        let Pose { place, course } = self.from;
        let start = along(course);
        if self.curvature == 0.0 {
            let place = place + start * way;
            return Pose { place, course };
        }
        let course = wrap(course + self.curvature * way);
        let place = place + (right_of(start) - right_of(along(course))) * (1.0 / self.curvature);
        Pose { place, course }
    }

    /// Where it ends.
    pub fn end(&self) -> Pose {
        self.at(self.length)
    }

    /// The place nearest to `x`, of those of an arc that goes round more than once the one nearest to the way `last` \[m\].
    /// `start` is the unit vector along it where it begins.
    #[inline]
    fn nearest(&self, start: Ned, x: Ned, last: f32) -> Nearest {
        let offset = x - self.from.place;
        let right = right_of(start);
        if self.curvature == 0.0 {
            return Nearest {
                way: offset.north * start.north + offset.east * start.east,
                along: start,
                right: offset.north * right.north + offset.east * right.east,
            };
        }
        let radius = 1.0 / self.curvature;
        let from_centre = offset - right * radius;
        let distance = math::max(level(from_centre), 1e-3);
        // To the right of the path there.
        let side = -self.curvature.signum() / distance;
        let now = Ned::new(from_centre.north * side, from_centre.east * side, 0.0);
        let turned = math::atan2(
            right.north * now.east - right.east * now.north,
            right.north * now.north + right.east * now.east,
        );
        Nearest {
            way: last + wrap(turned - self.curvature * last) * radius,
            along: Ned::new(now.east, -now.north, 0.0),
            right: radius - distance * self.curvature.signum(),
        }
    }
}

/// Up to three segments, and how far along them the vehicle is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Path {
    segments: [Segment; 3],
    /// The one that is flown, and the unit vector along it where it begins.
    at: u8,
    start: Ned,
    /// Way along it \[m\], and the length of those after it that end.
    way: f32,
    after: f32,
    /// Full turns on an arc that does not end.
    pub turns: f32,
}

impl Default for Path {
    fn default() -> Self {
        Self::new([Segment::default(); 3])
    }
}

impl Path {
    pub fn new(segments: [Segment; 3]) -> Self {
        let [first, second, third] = segments;
        let ending = |segment: Segment| {
            if segment.length < ENDLESS {
                segment.length
            } else {
                0.0
            }
        };
        Self {
            segments,
            at: 0,
            start: along(first.from.course),
            way: 0.0,
            after: ending(second) + ending(third),
            turns: 0.0,
        }
    }

    /// Goes on to the next segment.
    fn next(&mut self) {
        self.at += 1;
        let Segment { from, length, .. } = *self.segment();
        self.start = along(from.course);
        if length < ENDLESS {
            self.after -= length;
        }
    }

    /// Whether the last segment is flown.
    pub fn is_last(&self) -> bool {
        self.at >= 2
    }

    /// The segment that is flown.
    pub fn segment(&self) -> &Segment {
        let [first, second, third] = &self.segments;
        match self.at {
            0 => first,
            1 => second,
            _ => third,
        }
    }

    /// The curvature `ahead` \[m\] of the vehicle.
    pub fn curvature(&self, ahead: f32) -> f32 {
        let mut way = self.way + ahead;
        if way < self.segment().length {
            return self.segment().curvature;
        }
        for (n, segment) in self.segments.iter().enumerate() {
            if n >= usize::from(self.at) {
                if way < segment.length {
                    return segment.curvature;
                }
                way -= segment.length;
            }
        }
        self.segment().curvature
    }

    /// Turns on an arc that does not end.
    pub fn turned(&self) -> f32 {
        self.turns + self.way * self.segment().curvature.abs() * (0.5 / PI)
    }

    /// Goes on to where the vehicle at `x` is: the place nearest to it, and whether the path is at its end.
    #[inline]
    pub fn advance(&mut self, x: Ned) -> (Nearest, bool) {
        let mut last = self.way;
        for _ in 0..3 {
            if self.is_last() || last < self.segment().length {
                break;
            }
            // Segments without length, and those behind.
            self.next();
            last = 0.0;
        }
        let mut nearest = self.segment().nearest(self.start, x, last);
        if nearest.way >= self.segment().length && !self.is_last() {
            self.next();
            nearest = self.segment().nearest(self.start, x, 0.0);
        }
        // Of an arc the place may be behind the beginning, by less than a turn.
        self.way = nearest.way;
        let Segment {
            curvature, length, ..
        } = *self.segment();
        if length >= ENDLESS && self.way * curvature.abs() > 2.0 * PI {
            self.way -= 2.0 * PI / curvature.abs();
            self.turns += 1.0;
        }
        (nearest, self.is_last() && nearest.way >= length)
    }

    /// Way to its end \[m\]; of an endless one to the beginning of that.
    pub fn left(&self) -> f32 {
        let length = self.segment().length;
        // Nothing is left of what does not end.
        let left = if length < ENDLESS {
            length - self.way
        } else {
            0.0
        };
        math::max(left + self.after, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The place on a segment has no way to go and no distance, and a vehicle beside it is where it was put.
    #[test]
    fn the_nearest_place_is_the_one_beside_the_vehicle() {
        for curvature in [0.0, 0.02, -0.01] {
            let segment = Segment {
                from: Pose {
                    place: Ned::new(5.0, -20.0, 0.0),
                    course: 2.0,
                },
                curvature,
                length: 400.0,
            };
            for way in [10.0, 100.0, 350.0] {
                let Pose { place, course } = segment.at(way);
                let beside = place + right_of(along(course)) * 7.0;
                let nearest = segment.nearest(along(2.0), beside, way - 30.0);
                assert!((nearest.way - way).abs() < 1e-2, "{nearest:?} {way}");
                assert!((nearest.right - 7.0).abs() < 1e-3);
                assert!((nearest.along - along(course)).norm_squared() < 1e-6);
            }
        }
    }

    /// A loiter counts its turns, and stays on its circle.
    #[test]
    fn turns_are_counted() {
        let circle = Segment {
            from: Pose::default(),
            curvature: -0.02,
            length: ENDLESS,
        };
        let none = Segment::default();
        let mut path = Path::new([none, none, circle]);
        for n in 0..1000 {
            let (nearest, ended) = path.advance(circle.at(n as f32).place);
            assert!(nearest.right.abs() < 1e-3 && !ended);
        }
        // 999 m of circles of 314.2 m.
        assert_eq!(path.turns, 3.0);
        assert_eq!(path.left(), 0.0);
    }
}
