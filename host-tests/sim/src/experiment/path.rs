//! Paths: what is to be flown, as a function of a parameter that advances with time.

use schemars::JsonSchema;
use serde::Deserialize;

use super::V3;
use super::document::{FieldError, angle, finite, positive, require, speed};
use super::knots::Knots;
use super::route::{Leg, Route, Waypoint};

/// What is to be flown at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Target {
    /// \[m\].
    pub position: V3,
    /// \[m/s\].
    pub velocity: V3,
    /// \[m/s²\].
    pub acceleration: V3,
    /// Heading to hold \[rad\], if any.
    pub heading: Option<f64>,
}

/// `[path.KIND]`: exactly one. `[reference]` is another name for `[path]`.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum PathSpec {
    /// A velocity by knots, from the origin; the position is its integral.
    Knots(Knots),
    /// Stays at the origin.
    Hover {
        /// Headings to hold, by increasing time; free before the first.
        #[serde(default)]
        headings: Vec<HeadingStep>,
    },
    /// Straight and level, from the origin.
    Track {
        /// Course \[°\].
        #[serde(default)]
        course_deg: f64,
        /// Speed \[m/s\].
        speed_m_s: f64,
    },
    /// A circle to the right, from the origin northward.
    Circle {
        /// Radius \[m\].
        radius_m: f64,
        /// Horizontal speed \[m/s\].
        speed_m_s: f64,
        /// Climb \[m/s\].
        #[serde(default)]
        climb_m_s: f64,
    },
    /// An eight that lies northward, from its crossing.
    Eight {
        /// Length \[m\].
        length_m: f64,
        /// Width \[m\].
        width_m: f64,
        /// Speed \[m/s\].
        speed_m_s: f64,
    },
    /// Legs by time.
    Legs(Vec<Leg>),
    /// Past waypoints.
    Waypoints(Vec<Waypoint>),
}

/// A heading to hold from a time on.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeadingStep {
    /// From when \[s\].
    pub t_s: f64,
    /// Heading of the belly, clockwise from north \[°\].
    pub heading_deg: f64,
}

/// A path that is being flown.
///
/// A path without a wait is a function of time. Where it waits for the vehicle, its parameter advances at the guidance's time scale times its own rate; velocity and
/// acceleration scale with that factor and its square.
pub struct Path {
    shape: Shape,
    phase: f64,
    /// Whether it waits.
    waits: bool,
}

enum Shape {
    Knots(Knots),
    Headings(Vec<HeadingStep>),
    Route(Route),
    /// The curve with its first two derivatives over the parameter, and the speed along it.
    Curve(Box<dyn Fn(f64) -> [V3; 3] + Send>, f64),
}

/// A speed along a path must be positive, and one that can be flown.
fn forward(field: &str, value: f64) -> Result<(), FieldError> {
    positive(field, value)?;
    speed(field, value)
}

impl PathSpec {
    /// The path at its beginning. Fields in errors are whole paths.
    pub fn path(&self) -> Result<Path, FieldError> {
        let (shape, waits) = match self {
            Self::Knots(knots) => {
                knots.validate()?;
                (Shape::Knots(knots.clone()), false)
            }
            Self::Hover { headings } => {
                for (i, step) in headings.iter().enumerate() {
                    let field = format!("path.hover.headings[{i}]");
                    finite(&field, step.t_s)?;
                    angle(&field, step.heading_deg)?;
                    let later = i == 0 || step.t_s > headings[i - 1].t_s;
                    require(later, field, "t_s must increase from step to step")?;
                }
                (Shape::Headings(headings.clone()), false)
            }
            &Self::Track {
                course_deg,
                speed_m_s,
            } => {
                forward("path.track.speed_m_s", speed_m_s)?;
                angle("path.track.course_deg", course_deg)?;
                let (sin, cos) = libm::sincos(course_deg.to_radians());
                let ahead = V3::new(cos, sin, 0.0);
                let line = move |s| [ahead * s, ahead, V3::zeros()];
                (Shape::Curve(Box::new(line), speed_m_s), true)
            }
            &Self::Circle {
                radius_m: r,
                speed_m_s,
                climb_m_s,
            } => {
                positive("path.circle.radius_m", r)?;
                forward("path.circle.speed_m_s", speed_m_s)?;
                speed("path.circle.climb_m_s", climb_m_s)?;
                let climb = r * climb_m_s / speed_m_s;
                let circle = move |phase: f64| {
                    let (s, c) = libm::sincos(phase);
                    [
                        V3::new(r * s, r * (1.0 - c), -climb * phase),
                        V3::new(r * c, r * s, -climb),
                        V3::new(-r * s, r * c, 0.0),
                    ]
                };
                let speed = libm::hypot(speed_m_s, climb_m_s);
                (Shape::Curve(Box::new(circle), speed), true)
            }
            &Self::Eight {
                length_m,
                width_m,
                speed_m_s,
            } => {
                positive("path.eight.length_m", length_m)?;
                positive("path.eight.width_m", width_m)?;
                forward("path.eight.speed_m_s", speed_m_s)?;
                let (a, b) = (0.5 * length_m, 0.5 * width_m);
                let eight = move |phase: f64| {
                    let (s, c) = libm::sincos(phase);
                    let (s2, c2) = libm::sincos(2.0 * phase);
                    [
                        V3::new(a * s, b * s2, 0.0),
                        V3::new(a * c, 2.0 * b * c2, 0.0),
                        V3::new(-a * s, -4.0 * b * s2, 0.0),
                    ]
                };
                (Shape::Curve(Box::new(eight), speed_m_s), true)
            }
            Self::Legs(legs) => (Shape::Route(Route::of_legs(legs)?), false),
            Self::Waypoints(points) => (Shape::Route(Route::of_waypoints(points)?), true),
        };
        Ok(Path {
            shape,
            phase: 0.0,
            waits,
        })
    }
}

impl PathSpec {
    /// The knots, if it is given by them.
    pub fn knots(&self) -> Option<&Knots> {
        match self {
            Self::Knots(knots) => Some(knots),
            _ => None,
        }
    }

    /// The times in (0, `end`) at which it has a knot or a leg ends, with 0 and `end` \[s\]: of a path that waits for the vehicle, and of hover, none.
    pub fn breaks(&self, end: f64) -> Vec<f64> {
        let times: Vec<f64> = match self {
            Self::Knots(Knots(knots)) => knots.iter().map(|knot| knot.t_s).collect(),
            Self::Legs(legs) => {
                let ends = legs.iter().scan(0.0, |t, leg| {
                    *t += leg.lasts_s;
                    Some(*t)
                });
                ends.collect()
            }
            _ => Vec::new(),
        };
        let inner = times.into_iter().filter(|&t| 0.0 < t && t < end);
        std::iter::once(0.0).chain(inner).chain([end]).collect()
    }
}

impl Path {
    /// The target at the present parameter, and the parameter's rate \[1/s\].
    fn at(&self, phase: f64) -> (Target, f64) {
        match &self.shape {
            Shape::Headings(steps) => {
                let next = steps.partition_point(|step| step.t_s <= phase);
                let heading = next
                    .checked_sub(1)
                    .map(|i| steps[i].heading_deg.to_radians());
                let target = Target {
                    heading,
                    ..Target::default()
                };
                (target, 1.0)
            }
            Shape::Knots(knots) => (knots.target(phase), 1.0),
            Shape::Route(route) => (route.at(phase), 1.0),
            Shape::Curve(curve, speed) => {
                let [position, d1, d2] = curve(phase);
                let rate = speed / d1.norm();
                // Its change over the parameter, times the rate.
                let change = -speed * d1.dot(&d2) / d1.norm().powi(3) * rate;
                let target = Target {
                    position,
                    velocity: d1 * rate,
                    acceleration: d2 * (rate * rate) + d1 * change,
                    heading: None,
                };
                (target, rate)
            }
        }
    }

    /// The target at the beginning.
    pub fn start(&self) -> Target {
        self.at(0.0).0
    }

    /// Begins anew.
    pub fn restart(&mut self) {
        self.phase = 0.0;
    }

    /// The target at `t` \[s\]; the next call is for `dt` \[s\] later. `time_scale` is asked how fast a path that waits may go on, in multiples of
    /// its own speed.
    pub fn advance(&mut self, t: f64, dt: f64, time_scale: impl FnOnce(&Target) -> f64) -> Target {
        if !self.waits {
            return self.at(t).0;
        }
        let (target, rate) = self.at(self.phase);
        let time_scale = time_scale(&target);
        // The rate in the middle of the step.
        let (_, middle) = self.at(self.phase + 0.5 * rate * time_scale * dt);
        self.phase += middle * time_scale * dt;
        Target {
            velocity: target.velocity * time_scale,
            acceleration: target.acceleration * (time_scale * time_scale),
            ..target
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(text: &str) -> Result<Path, FieldError> {
        let mut table: toml::Table = text.parse().unwrap();
        let spec: PathSpec = crate::experiment::read(table.remove("path").unwrap()).unwrap();
        spec.path()
    }

    /// Targets of a vehicle that is on the path: velocities are differences of positions, accelerations of velocities.
    #[test]
    fn velocity_and_acceleration_are_derivatives() {
        let waypoints = "path.waypoints = [{ north_m = 0, east_m = 0, speed_m_s = 0 }, \
            { north_m = 200, east_m = 10, down_m = -20, speed_m_s = 18 }, \
            { north_m = 150, east_m = 150, speed_m_s = 12 }, { north_m = -50, east_m = 150, speed_m_s = 0 }]";
        let legs = "path.legs = [{ lasts_s = 8, speed_m_s = 16, course_deg = 30, climb_m = 5 }, \
            { lasts_s = 9, radius_m = -40 }, { lasts_s = 3, speed_m_s = 0 }]";
        for text in [
            "path.track = { speed_m_s = 20, course_deg = 70 }",
            "path.circle = { radius_m = 40, speed_m_s = 20, climb_m_s = 4 }",
            "path.eight = { length_m = 200, width_m = 65, speed_m_s = 22 }",
            waypoints,
            legs,
        ] {
            let mut path = path(text).unwrap();
            let dt = 1e-3;
            let (mut last, mut jumps) = (None::<Target>, 0);
            for n in 0..20_000 {
                let target = path.advance(dt * f64::from(n), dt, |_| 1.0);
                if let Some(last) = last {
                    let v = (target.position - last.position) / dt;
                    let mean = 0.5 * (target.velocity + last.velocity);
                    // a/2 · dt where the acceleration jumps; else third derivatives · dt².
                    assert!((v - mean).norm() < 1e-2, "{text}");
                    let a = (target.velocity - last.velocity) / dt;
                    let mean = 0.5 * (target.acceleration + last.acceleration);
                    jumps += usize::from((a - mean).norm() > 2e-2);
                }
                last = Some(target);
            }
            // Where a line meets an arc.
            assert!(jumps < 16, "{text}: {jumps}");
        }
    }

    #[test]
    fn waypoints_are_passed_at_their_altitude_and_speed() {
        let text = "path.waypoints = [{ north_m = 0, east_m = 0, speed_m_s = 10 }, \
            { north_m = 200, east_m = 0, down_m = -30, speed_m_s = 15 }, { north_m = 200, east_m = 300, speed_m_s = 0 }]";
        let path = path(text).unwrap();
        // In the middle of the corner's arc; its radius is 15²/6 m.
        let inward = 37.5 * (2.0_f64.sqrt() - 1.0);
        let corner = V3::new(200.0, 0.0, -30.0) + inward * V3::new(-1.0, 1.0, 0.0) / 2.0_f64.sqrt();
        let times = (0..40_000).map(|n| path.at(1e-3 * f64::from(n)).0);
        let near = times
            .min_by(|a, b| {
                (a.position - corner)
                    .norm()
                    .total_cmp(&(b.position - corner).norm())
            })
            .unwrap();
        assert!((near.position - corner).norm() < 0.02);
        assert!((near.velocity.norm() - 15.0).abs() < 0.01);
        let end = path.at(1e3).0;
        assert!((end.position - V3::new(200.0, 300.0, 0.0)).norm() < 1e-9);
        assert_eq!(end.velocity, V3::zeros());
    }

    #[test]
    fn a_curve_goes_on_at_the_pace_given_and_legs_at_their_own() {
        let circle = "path.circle = { radius_m = 40, speed_m_s = 20 }";
        for (text, time_scale) in [
            (circle, 0.5),
            ("path.legs = [{ lasts_s = 9, from_m_s = 20 }]", 1.0),
        ] {
            let mut path = path(text).unwrap();
            let first = path.advance(0.0, 0.01, |_| 0.5);
            assert!((first.velocity.norm() - 20.0 * time_scale).abs() < 1e-9);
            let next = path.advance(0.01, 0.01, |_| 0.5);
            let way = (next.position - first.position).norm();
            assert!((way - 0.2 * time_scale).abs() < 1e-6, "{text} {way}");
        }
    }

    #[test]
    fn what_cannot_be_flown_is_refused() {
        let error = |text: &str| path(text).err().unwrap().to_string();
        assert!(
            error("path.circle = { radius_m = 0, speed_m_s = 20 }")
                .starts_with("path.circle.radius_m: must")
        );
        assert!(error("path.legs = []").starts_with("path.legs: must have"));
        assert!(
            error("path.legs = [{ lasts_s = 1, radius_m = 0 }]")
                .starts_with("path.legs[0].radius_m")
        );
        let sharp = "path.waypoints = [{ north_m = 0, east_m = 0, speed_m_s = 20 }, \
            { north_m = 50, east_m = 0, speed_m_s = 20 }, { north_m = 0, east_m = 10, speed_m_s = 20 }]";
        assert!(error(sharp).starts_with("path.waypoints[1].radius_m: the turn does not fit"));
        let text =
            "path.hover.headings = [{ t_s = 1, heading_deg = 0 }, { t_s = 1, heading_deg = 9 }]";
        assert!(error(text).starts_with("path.hover.headings[1]: t_s must"));
    }
}
