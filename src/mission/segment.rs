//! A path over ground: up to four lines and arcs, and the place on it nearest to the vehicle.

use crate::math::{self, PI};
use crate::ned::Ned;

/// What is shorter \[m\] is rounding.
const SHORT: f32 = 1.0;
/// Segments of a path.
const SEGMENTS: usize = 4;
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
#[inline(always)]
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
        self.after(along(self.from.course), way)
    }

    /// The same, where `start` is the unit vector along it where it begins.
    fn after(&self, start: Ned, way: f32) -> Pose {
        let Pose { place, course } = self.from;
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
        let turned = math::angle(
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

/// What is left of the path before it, up to three segments, and how far along them the vehicle is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Path {
    segments: [Segment; SEGMENTS],
    /// The one that is flown: its number, itself, and the unit vector along it where it begins.
    at: u8,
    pub flown: Segment,
    pub start: Ned,
    /// Way along it \[m\], and the length of those before it, and of those after it that end.
    way: f32,
    before: f32,
    after: f32,
    /// Full turns on an arc that does not end.
    pub turns: f32,
}

impl Default for Path {
    fn default() -> Self {
        Self::new(None, [Segment::default(); 3])
    }
}

impl Path {
    /// Up to three segments, behind what is left of the path before it.
    #[inline]
    pub fn new(rest: Option<Segment>, [first, second, third]: [Segment; 3]) -> Self {
        let ending = |segment: Segment| {
            if segment.length < ENDLESS {
                segment.length
            } else {
                0.0
            }
        };
        // If nothing comes before it, what comes first is gone on from.
        let none = Segment {
            length: 0.0,
            ..first
        };
        let rest = rest.unwrap_or(none);
        Self {
            segments: [rest, first, second, third],
            at: 0,
            flown: rest,
            start: along(rest.from.course),
            way: 0.0,
            before: 0.0,
            after: ending(first) + ending(second) + ending(third),
            turns: 0.0,
        }
    }

    /// Whether nothing comes after the segment that is flown, or no more than rounding.
    pub fn is_final(&self) -> bool {
        self.after < SHORT && self.flown.length < ENDLESS
    }

    /// What is left of the segment that is flown `from` a place on it at this `way` \[m\], if nothing comes after it and that is less than
    /// `most` \[m\].
    pub fn rest(&self, from: Pose, way: f32, most: f32) -> Option<Segment> {
        let length = math::max(self.flown.length - way, 0.0);
        (self.is_final() && length < most).then_some(Segment {
            from,
            length,
            ..self.flown
        })
    }

    /// Where the segment that is flown ends.
    pub fn end(&self) -> Pose {
        self.flown.after(self.start, self.flown.length)
    }

    /// The place of the segment that is flown which is nearest to `x`.
    #[inline]
    pub fn nearest(&self, x: Ned) -> Nearest {
        self.flown.nearest(self.start, x, self.way)
    }

    /// Its greatest curvature to either side \[1/m\].
    pub fn tightest(&self) -> f32 {
        let tighter = |most: f32, s: &Segment| math::max(most, s.curvature.abs());
        self.segments.iter().fold(0.0, tighter)
    }

    /// Whether the last segment is flown.
    pub fn is_last(&self) -> bool {
        usize::from(self.at) + 1 >= SEGMENTS
    }

    /// The mean curvature from `half` \[m\] before to as much behind a place `ahead` \[m\] of the vehicle \[1/m\]. Before its beginning the path is as
    /// there, behind its end straight.
    #[inline]
    pub fn curvature(&self, ahead: f32, half: f32) -> f32 {
        let (first, last) = (self.way + ahead - half, self.way + ahead + half);
        let Segment {
            curvature, length, ..
        } = self.flown;
        if (self.at == 0 || first >= 0.0) && last < length {
            return curvature;
        }
        self.mean_curvature(first, last)
    }

    /// The mean curvature between two ways along the segment that is flown \[m\].
    #[cold]
    fn mean_curvature(&self, first: f32, last: f32) -> f32 {
        let share = 1.0 / math::max(last - first, 1e-3);
        let [rest, then @ ..] = &self.segments;
        let (mut mean, mut end) = (rest.curvature, rest.length - self.before);
        let mut at = rest.curvature;
        for &Segment {
            curvature, length, ..
        } in then
        {
            mean += (curvature - at) * math::clamp((last - end) * share, 0.0, 1.0);
            (at, end) = (curvature, end + length);
        }
        // Behind its end it is straight.
        mean - at * math::clamp((last - end) * share, 0.0, 1.0)
    }

    /// Turns on an arc that does not end.
    pub fn turned(&self) -> f32 {
        self.turns + self.way * self.flown.curvature.abs() * (0.5 / PI)
    }

    /// Goes on to where the vehicle at `x` is: the place of the segment that is flown which is nearest to it.
    #[inline]
    pub fn advance(&mut self, x: Ned) -> Nearest {
        let nearest = self.nearest(x);
        // Of an arc the place may be behind the beginning, by less than a turn.
        self.way = nearest.way;
        let Segment {
            curvature, length, ..
        } = self.flown;
        if length >= ENDLESS && self.way * curvature.abs() > 2.0 * PI {
            self.way -= 2.0 * PI / curvature.abs();
            self.turns += 1.0;
        }
        nearest
    }

    /// Whether the vehicle is behind the end of the segment that is flown, and another follows.
    #[inline]
    pub fn is_passed(&self) -> bool {
        self.way >= self.flown.length && !self.is_last()
    }

    /// Goes on to the next segment that has a length.
    #[inline(never)]
    pub fn pass(&mut self) {
        let behind = usize::from(self.at) + 1;
        for segment in self.segments.iter().skip(behind) {
            self.at += 1;
            self.before += self.flown.length;
            self.flown = *segment;
            if segment.length < ENDLESS {
                self.after -= segment.length;
            }
            if segment.length > 0.0 {
                break;
            }
        }
        self.way = 0.0;
        self.start = along(self.flown.from.course);
    }

    /// Way to its end \[m\]; of an endless one to the beginning of that.
    pub fn left(&self) -> f32 {
        let length = self.flown.length;
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

    /// As a mission does: to the place, and past what is behind.
    fn go_on(path: &mut Path, x: Ned) -> Nearest {
        if path.is_passed() {
            path.pass();
        }
        path.advance(x)
    }

    /// What is left from where it is.
    fn rest_of(path: &Path, most: f32) -> Option<Segment> {
        path.rest(path.flown.at(path.way), path.way, most)
    }

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

    /// Over a bend from right to left the curvature asked for goes evenly from one to the other, and what is left of the path before it counts.
    #[test]
    fn a_bend_is_flown_by_its_mean() {
        let from = Pose::default();
        let arc = |from: Pose, curvature: f32| Segment {
            from,
            curvature,
            length: 50.0,
        };
        let first = arc(from, 0.02);
        let second = arc(first.end(), -0.02);
        let third = arc(second.end(), -0.02);
        let mut path = Path::new(None, [first, second, third]);
        for (way, mean) in [(20.0, 0.02), (45.0, 0.01), (50.0, 0.0), (60.0, -0.02)] {
            go_on(&mut path, first.at(f32::min(way, 49.9)).place);
            let ahead = way - path.way;
            assert!((path.curvature(ahead, 10.0) - mean).abs() < 1e-6, "{way}");
        }
        // At its end it goes on straight.
        assert!((path.curvature(150.0 - path.way, 10.0) + 0.01).abs() < 1e-5);
        // A line of 30 m before it.
        let line = Segment {
            from: Pose {
                place: Ned::new(-30.0, 0.0, 0.0),
                course: 0.0,
            },
            curvature: 0.0,
            length: 30.0,
        };
        let path = Path::new(Some(line), [first, second, third]);
        assert_eq!(path.curvature(10.0, 10.0), 0.0);
        assert!((path.curvature(30.0, 10.0) - 0.01).abs() < 1e-6);
        assert_eq!(path.left(), 180.0);
    }

    /// What is left is there near the end, and not where a bend, or no end, comes after it.
    #[test]
    fn the_rest_of_a_path_is_that_of_its_last_segment() {
        let line = |north: f32, length: f32| Segment {
            from: Pose {
                place: Ned::new(north, 0.0, 0.0),
                course: 0.0,
            },
            curvature: 0.0,
            length,
        };
        let mut path = Path::new(None, [line(0.0, 50.0), line(50.0, 100.0), line(150.0, 0.0)]);
        go_on(&mut path, Ned::new(40.0, 0.0, 0.0));
        assert_eq!(rest_of(&path, 200.0), None);
        go_on(&mut path, Ned::new(51.0, 0.0, 0.0));
        go_on(&mut path, Ned::new(130.0, 3.0, 0.0));
        let rest = rest_of(&path, 25.0).unwrap();
        assert!((rest.length - 20.0).abs() < 1e-3);
        assert!((rest.end().place.north - 150.0).abs() < 1e-3);
        assert_eq!(rest_of(&path, 15.0), None);
        let mut endless = Path::new(None, [line(0.0, 0.0), line(0.0, 0.0), line(0.0, ENDLESS)]);
        go_on(&mut endless, Ned::new(10.0, 0.0, 0.0));
        assert_eq!(rest_of(&endless, 2.0 * ENDLESS), None);
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
        let mut path = Path::new(None, [none, none, circle]);
        for n in 0..1000 {
            let nearest = go_on(&mut path, circle.at(n as f32).place);
            assert!(nearest.right.abs() < 1e-3 && nearest.way < ENDLESS);
        }
        // 999 m of circles of 314.2 m.
        assert_eq!(path.turns, 3.0);
        assert_eq!(path.left(), 0.0);
    }
}
