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

/// The line from the arc of radius `first` through `from` to the one of radius `second` round `to`, both radii signed: its course and its
/// length.
fn tangent(from: Pose, first: f32, to: Ned, second: f32) -> Option<(f32, f32)> {
    let apart = to - centre(from, first);
    let distance = level(apart);
    let across = second - first;
    let square = distance * distance - across * across;
    if square < 0.0 {
        return None;
    }
    let length = math::sqrt(square.abs());
    Some((course_of(apart) - math::atan2(across, length), length))
}

/// Arc and line of the shortest way from `from` to where the arc of radius `second` round `to` begins; both sides are tried.
fn arc_and_line(
    from: Pose,
    radius: f32,
    to: Ned,
    second: f32,
    rest: impl Fn(f32) -> f32,
) -> Option<(f32, [Segment; 2])> {
    let mut best: Option<(f32, [Segment; 2])> = None;
    for side in [1.0, -1.0] {
        let Some((course, length)) = tangent(from, side * radius, to, second) else {
            continue;
        };
        let first = arc(from, side * radius, sweep(side, from.course, course));
        let place = first.end().place;
        let segments = [first, line(Pose { place, course }, length)];
        let whole = first.length + length + rest(course);
        if best.is_none_or(|(other, _)| whole < other) {
            best = Some((whole, segments));
        }
    }
    best
}

/// The shortest way to a place, with any course.
pub(super) fn to_place(from: Pose, to: Ned, radius: f32) -> Path {
    let to = Ned::new(to.north, to.east, 0.0);
    let way = arc_and_line(from, radius, to, 0.0, |_| 0.0);
    let [first, second] = way.map_or([Segment::default(); 2], |(_, segments)| segments);
    Path::new([first, line(first.end(), 0.0), second])
}

/// The shortest way to a place with a course.
pub(super) fn to_pose(from: Pose, to: Pose, radius: f32) -> Path {
    let mut best = (f32::INFINITY, [Segment::default(); 3]);
    for side in [1.0, -1.0] {
        let second = side * radius;
        let last = |course: f32| radius * sweep(side, course, to.course);
        if let Some((length, [first, middle])) =
            arc_and_line(from, radius, centre(to, second), second, last)
            && length < best.0
        {
            let end = middle.end();
            let third = arc(end, second, sweep(side, end.course, to.course));
            best = (length, [first, middle, third]);
        }
        for fold in [1.0, -1.0] {
            if let Some((length, segments)) = three_arcs(from, to, radius, side, fold)
                && length < best.0
            {
                best = (length, segments);
            }
        }
    }
    Path::new(best.1)
}

/// Three arcs, the outer ones to `side`.
fn three_arcs(
    from: Pose,
    to: Pose,
    radius: f32,
    side: f32,
    fold: f32,
) -> Option<(f32, [Segment; 3])> {
    let (start, end) = (centre(from, side * radius), centre(to, side * radius));
    let apart = end - start;
    let distance = level(apart);
    let square = 4.0 * radius * radius - 0.25 * distance * distance;
    if distance < 1e-3 * radius || square < 0.0 {
        return None;
    }
    let height = fold * math::sqrt(square.abs()) / distance;
    let middle = start + apart * 0.5 + right_of(apart) * height;
    // On a circle the place is the centre less the radius to the right.
    let course_to = |centre: Ned| course_of((centre - middle) * side) - 0.5 * PI;
    let (one, two) = (course_to(start), course_to(end));
    let first = arc(from, side * radius, sweep(side, from.course, one));
    let second = arc(first.end(), -side * radius, sweep(-side, one, two));
    let third = arc(second.end(), side * radius, sweep(side, two, to.course));
    Some((
        first.length + second.length + third.length,
        [first, second, third],
    ))
}

/// The shortest way onto a circle of radius `circle`, positive to the right, round `to`; from then on round it.
pub(super) fn to_circle(from: Pose, radius: f32, to: Ned, circle: f32) -> Path {
    let to = Ned::new(to.north, to.east, 0.0);
    let [first, second] = match arc_and_line(from, radius, to, circle, |_| 0.0) {
        Some((_, segments)) => segments,
        None => from_inside(from, radius, to, circle),
    };
    let entry = second.end();
    Path::new([
        first,
        second,
        Segment {
            from: entry,
            curvature: 1.0 / circle,
            length: ENDLESS,
        },
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

    /// The end of a path, by flying along it.
    fn flown(path: &Path) -> (Pose, f32) {
        let mut path = *path;
        let (mut length, mut last) = (0.0, path.segment().at(0.0));
        for _ in 0..100_000 {
            let (nearest, ended) = path.advance(last.place);
            if ended || (path.segment().length >= ENDLESS) {
                break;
            }
            let next = path.segment().at(nearest.way + 0.5);
            length += level(next.place - last.place);
            // No corners: what is flown past the end of an arc of 40 m and back, half a metre each, turns by no more.
            assert!(super::super::segment::wrap(next.course - last.course).abs() < 0.04);
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
                    let path = to_pose(from, to, radius);
                    let (end, length) = flown(&path);
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
        let path = to_pose(pose(0.0, 0.0, 0.0), pose(0.0, 40.0, 180.0), 60.0);
        let (end, length) = flown(&path);
        assert!(level(end.place - Ned::new(0.0, 40.0, 0.0)) < 1.0);
        assert!(length < 2.0 * PI * 60.0 * 1.1, "{length}");
    }

    #[test]
    fn a_circle_is_met_along_it_from_outside_and_inside() {
        for radius in [80.0, -80.0] {
            for (north, east) in [(-300.0, 0.0), (200.0, 60.0), (10.0, 5.0), (-30.0, 40.0)] {
                for degrees in [0.0, 80.0, 200.0, 310.0] {
                    let path = to_circle(pose(north, east, degrees), 40.0, Ned::ZERO, radius);
                    let (end, _) = flown(&path);
                    let off = level(end.place) - radius.abs();
                    assert!(off.abs() < 1.0, "{radius} {north} {degrees} {off}");
                }
            }
        }
    }

    #[test]
    fn a_place_behind_is_turned_to() {
        let path = to_place(pose(0.0, 0.0, 0.0), Ned::new(-100.0, 10.0, 0.0), 30.0);
        let (end, _) = flown(&path);
        assert!(level(end.place - Ned::new(-100.0, 10.0, 0.0)) < 1.0);
    }
}
