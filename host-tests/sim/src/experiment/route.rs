//! A route in stretches of straight lines and arcs, along each of which the speed changes linearly with time.

use schemars::JsonSchema;
use serde::Deserialize;

use super::V3;
use super::document::{FieldError, angle, finite, positive, require};
use super::path::Target;

/// `path.legs`: one leg, flown in a given time.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Leg {
    /// How long it lasts \[s\].
    pub lasts_s: f64,
    /// Speed at its end \[m/s\]; that at its beginning if left out.
    pub speed_m_s: Option<f64>,
    /// Speed at its beginning \[m/s\]; that at the end of the one before if left out.
    pub from_m_s: Option<f64>,
    /// Course at its beginning \[°\]; that at the end of the one before if left out.
    pub course_deg: Option<f64>,
    /// Radius \[m\] of an arc to the right, negative to the left; straight if left out.
    pub radius_m: Option<f64>,
    /// Altitude gained \[m\], smoothly.
    #[serde(default)]
    pub climb_m: f64,
    /// Heading to hold \[°\]; free if left out.
    pub heading_deg: Option<f64>,
}

/// `path.waypoints`: one waypoint.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// Position \[m\].
    pub north_m: f64,
    /// Position \[m\].
    pub east_m: f64,
    /// Position \[m\].
    #[serde(default)]
    pub down_m: f64,
    /// Speed there \[m/s\].
    pub speed_m_s: f64,
    /// Radius \[m\] of the arc that rounds the corner; that of a turn at 6 m/s² if left out.
    pub radius_m: Option<f64>,
}

/// Lateral acceleration \[m/s²\] in corners without a radius.
const TURN: f64 = 6.0;

/// A stretch: its pieces are of constant curvature.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    /// When it begins, and how long it lasts \[s\].
    from: f64,
    lasts: f64,
    /// Speeds at its ends \[m/s\].
    speed: [f64; 2],
    /// Altitude gained \[m\].
    climb: f64,
    pieces: Vec<Piece>,
    start: V3,
    course: f64,
    heading: Option<f64>,
}

/// A route, a function of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Route(Vec<Stretch>);

/// Position and course on a route, at the altitude of its beginning.
#[derive(Clone, Copy, Debug)]
struct Pose {
    position: V3,
    /// Course \[rad\].
    course: f64,
}

/// Of a waypoint: the arc that rounds it.
#[derive(Clone, Copy, Debug, Default)]
struct Corner {
    /// Radius \[m\]; 0 without an arc.
    radius: f64,
    /// The angle it turns \[rad\], positive to the right.
    turn: f64,
    /// How much of both lines it takes \[m\].
    takes: f64,
}

/// A piece of constant curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    /// Length \[m\].
    length: f64,
    /// Curvature \[1/m\], positive to the right.
    curvature: f64,
}

/// Where an arc or a line from `start` is after a length `s`.
fn along(Pose { position, course }: Pose, curvature: f64, s: f64) -> Pose {
    let half = 0.5 * curvature * s;
    // The chord has the mean course.
    let chord = if half.abs() < 1e-9 {
        s
    } else {
        s * libm::sin(half) / half
    };
    let (sin, cos) = libm::sincos(course + half);
    Pose {
        position: position + chord * V3::new(cos, sin, 0.0),
        course: course + curvature * s,
    }
}

impl Stretch {
    /// The place after a length `s` of the way, and the curvature \[1/m\] there; the last piece goes on.
    fn place(&self, mut s: f64) -> (Pose, f64) {
        let mut place = Pose {
            position: self.start,
            course: self.course,
        };
        for (i, &Piece { length, curvature }) in self.pieces.iter().enumerate() {
            if s <= length || i + 1 == self.pieces.len() {
                return (along(place, curvature, s), curvature);
            }
            place = along(place, curvature, length);
            s -= length;
        }
        (place, 0.0)
    }

    /// The target `t` after the beginning.
    fn at(&self, t: f64) -> Target {
        let [begin, end] = self.speed;
        let gain = (end - begin) / self.lasts;
        let speed = begin + gain * t;
        let (level, curvature) = self.place(0.5 * (begin + speed) * t);
        let (sin, cos) = libm::sincos(level.course);
        let (ahead, right) = (V3::new(cos, sin, 0.0), V3::new(-sin, cos, 0.0));
        // Up by 3u² − 2u³: without a vertical velocity at either end.
        let u = t / self.lasts;
        let up = self.climb
            * V3::new(
                u * u * (3.0 - 2.0 * u),
                6.0 * u * (1.0 - u) / self.lasts,
                (6.0 - 12.0 * u) / self.lasts.powi(2),
            );
        Target {
            position: level.position - up.x * V3::z(),
            velocity: speed * ahead - up.y * V3::z(),
            acceleration: gain * ahead + speed * speed * curvature * right - up.z * V3::z(),
            heading: self.heading,
        }
    }

    /// When the next stretch begins \[s\], and where.
    fn end(&self) -> (f64, Pose) {
        let s = 0.5 * (self.speed[0] + self.speed[1]) * self.lasts;
        let (mut place, _) = self.place(s);
        place.position -= self.climb * V3::z();
        (self.from + self.lasts, place)
    }
}

impl Route {
    /// The route of these legs, from the origin.
    pub fn of_legs(legs: &[Leg]) -> Result<Self, FieldError> {
        let mut stretches: Vec<Stretch> = Vec::new();
        for (i, leg) in legs.iter().enumerate() {
            let field = |name: &str| format!("path.legs[{i}].{name}");
            positive(&field("lasts_s"), leg.lasts_s)?;
            finite(&field("climb_m"), leg.climb_m)?;
            let last = stretches.last();
            let origin = Pose {
                position: V3::zeros(),
                course: 0.0,
            };
            let (from, place) = last.map_or((0.0, origin), Stretch::end);
            let begin = leg.from_m_s.unwrap_or(last.map_or(0.0, |l| l.speed[1]));
            let end = leg.speed_m_s.unwrap_or(begin);
            for (name, speed) in [("from_m_s", begin), ("speed_m_s", end)] {
                let possible = (0.0..=200.0).contains(&speed);
                require(possible, field(name), "must be from 0 to 200 m/s")?;
            }
            let radius = leg.radius_m.unwrap_or(f64::INFINITY);
            let wide = radius.abs() >= 1.0;
            require(wide, field("radius_m"), "must be 1 m at least")?;
            for (name, value) in [
                ("course_deg", leg.course_deg),
                ("heading_deg", leg.heading_deg),
            ] {
                angle(&field(name), value.unwrap_or(0.0))?;
            }
            stretches.push(Stretch {
                from,
                lasts: leg.lasts_s,
                speed: [begin, end],
                climb: leg.climb_m,
                pieces: vec![Piece {
                    length: f64::INFINITY,
                    curvature: 1.0 / radius,
                }],
                start: place.position,
                course: leg.course_deg.map_or(place.course, f64::to_radians),
                heading: leg.heading_deg.map(f64::to_radians),
            });
        }
        let problem = "must have at least one leg";
        require(!stretches.is_empty(), "path.legs", problem)?;
        Ok(Self(stretches))
    }

    /// The route past these waypoints, corners rounded by arcs.
    pub fn of_waypoints(points: &[Waypoint]) -> Result<Self, FieldError> {
        let at = |i: usize, name: &str| format!("path.waypoints[{i}]{name}");
        let problem = "must have at least two waypoints";
        require(points.len() > 1, "path.waypoints", problem)?;
        let place = |p: &Waypoint| V3::new(p.north_m, p.east_m, 0.0);
        for (i, p) in points.iter().enumerate() {
            for length in [p.north_m, p.east_m, p.down_m] {
                finite(&at(i, ""), length)?;
            }
            let (speed, radius) = (at(i, ".speed_m_s"), at(i, ".radius_m"));
            let possible = (0.0..=200.0).contains(&p.speed_m_s);
            require(possible, &speed, "must be from 0 to 200 m/s")?;
            let turned = p.radius_m.is_none_or(|r| r >= 0.0);
            require(turned, radius, "must not be negative")?;
            if i > 0 {
                let far = (place(p) - place(&points[i - 1])).norm() >= 1.0;
                require(far, at(i, ""), "must be 1 m from the one before at least")?;
                let moves = p.speed_m_s + points[i - 1].speed_m_s != 0.0;
                require(moves, speed, "one of two neighbours must have a speed")?;
            }
        }
        let lines = points
            .windows(2)
            .map(|ends| place(&ends[1]) - place(&ends[0]));
        let (lengths, courses): (Vec<f64>, Vec<f64>) = lines
            .map(|line| (line.norm(), libm::atan2(line.y, line.x)))
            .unzip();
        let corners: Vec<Corner> = (0..points.len())
            .map(|i| {
                if i == 0 || i + 1 == points.len() {
                    return Corner::default();
                }
                let turn = courses[i] - courses[i - 1];
                let turn = libm::atan2(libm::sin(turn), libm::cos(turn));
                let fast = points[i].speed_m_s.powi(2) / TURN;
                let radius = points[i].radius_m.unwrap_or(fast);
                Corner {
                    radius,
                    turn,
                    takes: radius * libm::tan(0.5 * turn.abs()),
                }
            })
            .collect();
        let mut stretches: Vec<Stretch> = Vec::new();
        for i in 0..lengths.len() {
            let (before, after) = (corners[i], corners[i + 1]);
            let line = lengths[i] - before.takes - after.takes;
            if line < 0.0 {
                let worse = if before.takes > after.takes { i } else { i + 1 };
                let problem = "the turn does not fit between its neighbours";
                return Err(FieldError::new(at(worse, ".radius_m"), problem));
            }
            let half = |corner: Corner| Piece {
                length: 0.5 * corner.radius * corner.turn.abs(),
                curvature: corner.turn.signum() / corner.radius,
            };
            let mut pieces = vec![Piece {
                length: line,
                curvature: 0.0,
            }];
            if before.radius > 0.0 {
                pieces.insert(0, half(before));
            }
            if after.radius > 0.0 {
                pieces.push(half(after));
            }
            let length: f64 = pieces.iter().map(|piece| piece.length).sum();
            let speed = [points[i].speed_m_s, points[i + 1].speed_m_s];
            let first = Pose {
                position: place(&points[0]) + points[0].down_m * V3::z(),
                course: 0.0,
            };
            let (from, start) = stretches.last().map_or((0.0, first), Stretch::end);
            stretches.push(Stretch {
                from,
                lasts: 2.0 * length / (speed[0] + speed[1]),
                speed,
                climb: points[i].down_m - points[i + 1].down_m,
                // Without an arc the course changes at once.
                course: if before.radius > 0.0 {
                    start.course
                } else {
                    courses[i]
                },
                pieces,
                start: start.position,
                heading: None,
            });
        }
        Ok(Self(stretches))
    }

    /// The target at `t` \[s\]; from the end on straight ahead at the last speed.
    pub fn at(&self, t: f64) -> Target {
        let next = self.0.partition_point(|stretch| stretch.from <= t);
        let stretch = &self.0[next.max(1) - 1];
        let late = t - stretch.from - stretch.lasts;
        if late < 0.0 {
            return stretch.at(t - stretch.from);
        }
        let (_, end) = stretch.end();
        let velocity =
            stretch.speed[1] * V3::new(libm::cos(end.course), libm::sin(end.course), 0.0);
        Target {
            position: end.position + late * velocity,
            velocity,
            acceleration: V3::zeros(),
            heading: stretch.heading,
        }
    }
}
