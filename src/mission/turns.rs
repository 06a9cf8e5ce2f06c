//! The shortest way by lines and arcs: to a place, to a place with a course, onto a circle.
//!
//! L. E. Dubins, *On curves of minimal length with a constraint on average curvature*, 1957: an arc, a line and an arc, or three arcs.

use super::segment::{ENDLESS, Path, Pose, Segment, along, level, right_of};
use crate::math::{self, PI};
use crate::ned::Ned;

/// Arcs of less than this to a full turn \[rad\] are none: rounding.
const ROUNDING: f32 = 2e-3;

/// How far to turn in the direction of `side` (1 right, −1 left) from one course to another \[rad\], 0 to 2π.
fn sweep(side: f32, from: f32, to: f32) -> f32 {
    const ROUND: f32 = 12_582_912.0;
    let turns = side * (to - from) * (0.5 / PI);
    let part = turns - ((turns + ROUND) - ROUND);
    let angle = 2.0 * PI * if part < 0.0 { part + 1.0 } else { part };
    if angle > 2.0 * PI - ROUNDING {
        0.0
    } else {
        angle
    }
}

/// The course of a level vector.
fn course_of(v: Ned) -> f32 {
    math::atan2(v.east, v.north)
}

fn arc(from: Pose, radius: f32, angle: f32) -> Segment {
    Segment {
        from,
        curvature: 1.0 / radius,
        length: angle * radius.abs(),
    }
}

fn line(from: Pose, length: f32) -> Segment {
    Segment {
        from,
        curvature: 0.0,
        length,
    }
}

/// The centre of the arc of `radius` (positive to the right) through a pose.
fn centre(pose: Pose, radius: f32) -> Ned {
    pose.place + right_of(along(pose.course)) * radius
}

/// An arc of signed radius to a course, and a line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct ArcAndLine {
    radius: f32,
    /// Angle of the arc \[rad\].
    angle: f32,
    /// Course and length \[m\] of the line.
    course: f32,
    line: f32,
}

impl ArcAndLine {
    /// The way from the arc of signed radius `first` round `centre`, on which it begins at course `from`, to the one of signed radius `second`
    /// round `to`.
    fn new(from: f32, centre: Ned, first: f32, to: Ned, second: f32) -> Option<Self> {
        let apart = to - centre;
        let distance = level(apart);
        let across = second - first;
        let square = distance * distance - across * across;
        if square < 0.0 {
            return None;
        }
        let line = math::sqrt(square.abs());
        // On the circle already there is no line, and its course is the present one.
        let straight = if distance < ROUNDING * first.abs() {
            from
        } else {
            course_of(apart)
        };
        let course = if across == 0.0 {
            straight
        } else {
            straight - math::atan2(across, line)
        };
        let angle = sweep(first.signum(), from, course);
        Some(Self {
            radius: first,
            angle,
            course,
            line,
        })
    }

    fn length(&self) -> f32 {
        self.angle * self.radius.abs() + self.line
    }

    fn segments(&self, from: Pose) -> [Segment; 2] {
        let first = arc(from, self.radius, self.angle);
        let &Self { course, .. } = self;
        let place = first.end().place;
        [first, line(Pose { place, course }, self.line)]
    }
}

/// Where a path leads to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) enum Destination {
    /// A place, with any course.
    Place(Ned),
    /// A place with a course.
    Pose(Pose),
    /// A circle of this radius \[m\], positive to the right; from then on round it.
    Circle(Ned, f32),
}

/// A way of arcs and lines, as Dubins found them: the arcs by their angles, and what lies between.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
enum Way {
    /// Arc, line, and an arc of this signed radius and angle.
    Line(ArcAndLine, f32, f32),
    /// Three arcs: radius of the outer ones, signed, and the angles \[rad\].
    Arcs(f32, [f32; 3]),
}

/// The shortest way to a destination, of those that have been compared. The lengths are compared first, and one way is laid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Search {
    from: Pose,
    to: Destination,
    /// The unit vectors to the right where it departs, and where it ends.
    right: [Ned; 2],
    radius: f32,
    /// How many ways have been compared.
    compared: u8,
    shortest: Option<Way>,
    length: f32,
}

/// Ways to a pose: four with a line, four of three arcs.
const TO_POSE: u8 = 8;
/// Other ways: with the first arc to either side.
const OTHERS: u8 = 2;

impl Search {
    /// The most ways that a search compares.
    pub const MOST: u8 = TO_POSE;

    pub fn new(from: Pose, to: Destination, radius: f32) -> Self {
        let end = match to {
            Destination::Pose(to) => along(to.course),
            _ => Ned::ZERO,
        };
        Self {
            from,
            to,
            right: [right_of(along(from.course)), right_of(end)],
            radius,
            compared: 0,
            shortest: None,
            length: f32::INFINITY,
        }
    }

    /// Whether all ways have been compared.
    pub fn is_complete(&self) -> bool {
        let ways = match self.to {
            Destination::Pose(_) => TO_POSE,
            _ => OTHERS,
        };
        self.compared >= ways
    }

    /// Compares one more way with the shortest.
    pub fn compare(&mut self) {
        let number = self.compared;
        self.compared += 1;
        let side = |bit: u8| if number & bit == 0 { 1.0 } else { -1.0 };
        let first = side(1) * self.radius;
        let [begin, end] = self.right;
        let way = match self.to {
            Destination::Place(place) => self.line(first, place, 0.0),
            Destination::Circle(centre, radius) => self.line(first, centre, radius),
            Destination::Pose(to) if number < TO_POSE / 2 => {
                let second = side(2) * self.radius;
                let way = self.line(first, to.place + end * second, second);
                let ended = |(way, length): (Way, f32)| match way {
                    Way::Line(line, ..) => {
                        let angle = sweep(second.signum(), line.course, to.course);
                        let length = length + self.radius * angle;
                        (Way::Line(line, second, angle), length)
                    }
                    Way::Arcs(..) => (way, length),
                };
                way.map(ended)
            }
            Destination::Pose(to) => {
                let courses = [self.from.course, to.course];
                let centres = [self.from.place + begin * first, to.place + end * first];
                let way = three_arcs(courses, centres, first, side(2));
                let arcs = |angles: [f32; 3]| {
                    let [a, b, c] = angles;
                    (Way::Arcs(first, angles), self.radius * (a + b + c))
                };
                way.map(arcs)
            }
        };
        if let Some((way, length)) = way
            && length < self.length
        {
            (self.shortest, self.length) = (Some(way), length);
        }
    }

    /// Arc and line from where it departs to where the arc of radius `second` round `to` begins, and their length \[m\].
    fn line(&self, first: f32, to: Ned, second: f32) -> Option<(Way, f32)> {
        let to = Ned { down: 0.0, ..to };
        let Self {
            from,
            right: [begin, _],
            ..
        } = self;
        let centre = from.place + *begin * first;
        let way = ArcAndLine::new(from.course, centre, first, to, second)?;
        Some((Way::Line(way, second, 0.0), way.length()))
    }

    /// Lays the shortest way, behind what is left of the path before it.
    pub fn lay(&self, rest: Option<Segment>, path: &mut Path) {
        let &Self { from, radius, .. } = self;
        let none = Segment::default();
        *path = Path::new(
            rest,
            match (self.shortest, self.to) {
                (Some(Way::Arcs(outer, [a, b, c])), _) => {
                    let first = arc(from, outer, a);
                    let second = arc(first.end(), -outer, b);
                    [first, second, arc(second.end(), outer, c)]
                }
                (Some(Way::Line(way, second, angle)), to) => {
                    let [first, middle] = way.segments(from);
                    match to {
                        Destination::Place(_) => [first, none, middle],
                        Destination::Pose(_) => [first, middle, arc(middle.end(), second, angle)],
                        Destination::Circle(_, circle) => {
                            [first, middle, round(middle.end(), circle)]
                        }
                    }
                }
                (None, Destination::Circle(centre, circle)) => {
                    let centre = Ned {
                        down: 0.0,
                        ..centre
                    };
                    let [first, second] = from_inside(from, radius, centre, circle);
                    [first, second, round(second.end(), circle)]
                }
                (None, _) => [none; 3],
            },
        );
    }
}

/// Round a circle without end.
fn round(from: Pose, circle: f32) -> Segment {
    Segment {
        from,
        curvature: 1.0 / circle,
        length: ENDLESS,
    }
}

/// The angles \[rad\] of three arcs from and to these courses, the outer ones of the signed radius round these centres.
fn three_arcs(
    [from, to]: [f32; 2],
    [start, end]: [Ned; 2],
    radius: f32,
    fold: f32,
) -> Option<[f32; 3]> {
    let apart = end - start;
    let square_apart = apart.north * apart.north + apart.east * apart.east;
    let square = 4.0 * radius * radius - 0.25 * square_apart;
    if square < 0.0 || square_apart < 1e-6 * radius * radius {
        return None;
    }
    let height = fold * math::sqrt(square.abs() / square_apart);
    let middle = start + apart * 0.5 + right_of(apart) * height;
    let side = radius.signum();
    // On a circle the place is the centre less the radius to the right.
    let course_to = |centre: Ned| course_of((centre - middle) * side) - 0.5 * PI;
    let (one, two) = (course_to(start), course_to(end));
    Some([
        sweep(side, from, one),
        sweep(-side, one, two),
        sweep(side, two, to),
    ])
}

/// From inside a circle: straight ahead, and by an arc onto it from within.
fn from_inside(from: Pose, radius: f32, to: Ned, circle: f32) -> [Segment; 2] {
    let side = circle.signum();
    let room = circle.abs() - radius;
    let turning = side * radius;
    let offset = centre(from, turning) - to;
    let ahead = along(from.course);
    let forward = offset.north * ahead.north + offset.east * ahead.east;
    let offset = level(offset);
    let square = forward * forward - offset * offset + room * room;
    let straight = line(
        from,
        math::max(math::sqrt(math::max(square, 0.0).abs()) - forward, 0.0),
    );
    let outward = centre(straight.end(), turning) - to;
    let course = if level(outward) > 1e-3 * radius {
        course_of(outward * -side) - 0.5 * PI
    } else {
        from.course
    };
    let turn = arc(straight.end(), turning, sweep(side, from.course, course));
    [straight, turn]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(north: f32, east: f32, degrees: f32) -> Pose {
        Pose {
            place: Ned::new(north, east, 0.0),
            course: degrees.to_radians(),
        }
    }

    fn path(from: Pose, to: Destination, radius: f32) -> Path {
        let mut search = Search::new(from, to, radius);
        while !search.is_complete() {
            search.compare();
        }
        assert!(search.compared <= Search::MOST);
        let mut path = Path::default();
        search.lay(None, &mut path);
        path
    }

    /// The end of a path, by flying along it.
    fn end_of(path: &Path) -> (Pose, f32) {
        let mut path = *path;
        let (mut length, mut last) = (0.0, path.flown.at(0.0));
        for _ in 0..100_000 {
            let mut nearest = path.advance(last.place);
            if path.is_passed() {
                path.pass();
                nearest = path.advance(last.place);
            }
            let ended = path.is_last() && nearest.way >= path.flown.length;
            if ended || (path.flown.length >= ENDLESS) {
                break;
            }
            let next = path.flown.at(nearest.way + 0.2);
            length += level(next.place - last.place);
            // No corners: what is flown past the end of an arc of 40 m and back, 0.2 m each, turns by no more.
            assert!(super::super::segment::wrap(next.course - last.course).abs() < 0.02);
            last = next;
        }
        (last, length)
    }

    /// From every course to every course the path ends at the pose, without a corner, and no detour is longer than two turns.
    #[test]
    fn every_pose_is_reached() {
        let radius = 40.0;
        for (north, east) in [(300.0, 50.0), (30.0, 20.0), (0.0, 50.0), (-100.0, 10.0)] {
            for from in 0..8 {
                for to in 0..8 {
                    let from = pose(0.0, 0.0, 45.0 * from as f32);
                    let to = pose(north, east, 45.0 * to as f32);
                    let path = path(from, Destination::Pose(to), radius);
                    let (end, length) = end_of(&path);
                    assert!(level(end.place - to.place) < 1.0, "{from:?} {to:?} {end:?}");
                    assert!(super::super::segment::wrap(end.course - to.course).abs() < 0.03);
                    let straight = level(to.place);
                    assert!(length < straight + 2.0 * 2.0 * PI * radius);
                    assert!((path.left() - length).abs() < 4.0);
                }
            }
        }
    }

    /// Between lines of a survey, nearer than twice the radius: three arcs, and not a way of more than a turn and a half.
    #[test]
    fn the_way_back_beside_the_way_out_is_three_arcs() {
        let to = Destination::Pose(pose(0.0, 40.0, 180.0));
        let path = path(pose(0.0, 0.0, 0.0), to, 60.0);
        let (end, length) = end_of(&path);
        assert!(level(end.place - Ned::new(0.0, 40.0, 0.0)) < 1.0);
        assert!(length < 2.0 * PI * 60.0 * 1.1, "{length}");
    }

    #[test]
    fn a_circle_is_met_along_it_from_outside_and_inside() {
        for radius in [80.0, -80.0] {
            for (north, east) in [(-300.0, 0.0), (200.0, 60.0), (10.0, 5.0), (-30.0, 40.0)] {
                for degrees in [0.0, 80.0, 200.0, 310.0] {
                    let path = path(
                        pose(north, east, degrees),
                        Destination::Circle(Ned::ZERO, radius),
                        40.0,
                    );
                    let (end, _) = end_of(&path);
                    let off = level(end.place) - radius.abs();
                    assert!(off.abs() < 1.0, "{radius} {north} {degrees} {off}");
                }
            }
        }
    }

    /// A spiral begins on its circle, whatever the course: no way leads onto it.
    #[test]
    fn on_a_circle_it_is_flown_at_once() {
        for degrees in [0.0, 53.0, 200.0, 310.0] {
            let from = pose(473.0, 55.0, degrees);
            let path = path(from, Destination::Circle(centre(from, 90.0), 90.0), 90.0);
            assert!(path.left() < 0.5, "{degrees} {}", path.left());
        }
    }

    #[test]
    fn a_place_behind_is_turned_to() {
        let path = path(
            pose(0.0, 0.0, 0.0),
            Destination::Place(Ned::new(-100.0, 10.0, 0.0)),
            30.0,
        );
        let (end, _) = end_of(&path);
        assert!(level(end.place - Ned::new(-100.0, 10.0, 0.0)) < 1.0);
    }
}
