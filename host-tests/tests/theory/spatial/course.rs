//! Paths, and their following: how fast the path parameter advances.

use super::scenario::{PERIOD, Target, Task, V3};

/// A closed or open curve p(φ) with its derivatives p′, p″, p‴.
pub type Curve = fn(f64) -> [V3; 4];

/// Flies along a curve at a constant speed.
///
/// The parameter advances at a time scale times its own rate, such as `1 + k e_t/V` in [0.5, 1.6], e_t the error along the track;
/// velocity, acceleration and jerk scale with the first three powers of that scale.
pub struct Course {
    pub curve: Curve,
    pub speed: f64,
    /// The time scale at a position error and a velocity.
    time_scale: Box<dyn Fn(V3, V3) -> f64 + Send>,
    phase: f64,
}

/// k \[1/s\]. Below the outer loop's gain: with more, a vehicle ahead is asked to fly faster still.
const FOLLOW: f64 = 0.4;

impl Course {
    pub fn new(curve: Curve, speed: f64) -> Self {
        Self::scaled(curve, speed, move |error, velocity| {
            (1.0 + FOLLOW * error.dot(&velocity) / speed.powi(2)).clamp(0.5, 1.6)
        })
    }

    /// With a time scale of one's own.
    pub fn scaled(
        curve: Curve,
        speed: f64,
        time_scale: impl Fn(V3, V3) -> f64 + Send + 'static,
    ) -> Self {
        Self {
            curve,
            speed,
            time_scale: Box::new(time_scale),
            phase: 0.0,
        }
    }

    /// dφ/dt and its derivative with respect to φ.
    fn rate(&self, phase: f64) -> (f64, f64) {
        let [_, d1, d2, _] = (self.curve)(phase);
        let length = d1.norm();
        (
            self.speed / length,
            -self.speed * d1.dot(&d2) / length.powi(3),
        )
    }
}

impl Task for Course {
    fn target(&mut self, _: f64, position: V3) -> Target {
        let [p, d1, d2, d3] = (self.curve)(self.phase);
        let (g, slope) = self.rate(self.phase);
        let h = 1e-4;
        let curvature = (self.rate(self.phase + h).1 - self.rate(self.phase - h).1) / (2.0 * h);
        let (second, third) = (slope * g, (curvature * g + slope * slope) * g);
        let velocity = d1 * g;
        let factor = (self.time_scale)(position - p, velocity);
        self.phase += g * factor * PERIOD;
        Target {
            position: p,
            velocity: velocity * factor,
            acceleration: (d2 * (g * g) + d1 * second) * factor.powi(2),
            jerk: (d3 * g.powi(3) + d2 * (3.0 * g * second) + d1 * third) * factor.powi(3),
            heading: None,
        }
    }
}

/// A circle to the right of this radius and climb per radian, starting northward.
fn turn(radius: f64, climb: f64, phase: f64) -> [V3; 4] {
    let (s, c) = phase.sin_cos();
    [
        V3::new(radius * s, radius * (1.0 - c), -climb * phase),
        V3::new(radius * c, radius * s, -climb),
        V3::new(-radius * s, radius * c, 0.0),
        V3::new(-radius * c, -radius * s, 0.0),
    ]
}

pub fn circle_40(phase: f64) -> [V3; 4] {
    turn(40.0, 0.0, phase)
}

pub fn circle_33(phase: f64) -> [V3; 4] {
    turn(33.0, 0.0, phase)
}

/// 4 m/s up at 20 m/s over ground: 4/20 · 40 m a radian.
pub fn climbing_turn(phase: f64) -> [V3; 4] {
    turn(40.0, 8.0, phase)
}

/// An eight 200 m long and 65 m wide, of curvature radii from 42 m.
pub fn eight(phase: f64) -> [V3; 4] {
    let (a, b) = (100.0, 65.0);
    let (s, c) = phase.sin_cos();
    let (s2, c2) = (2.0 * phase).sin_cos();
    [
        V3::new(a * s, 0.5 * b * s2, 0.0),
        V3::new(a * c, b * c2, 0.0),
        V3::new(-a * s, -2.0 * b * s2, 0.0),
        V3::new(-a * c, -4.0 * b * c2, 0.0),
    ]
}

/// The track to the north.
pub fn north(phase: f64) -> [V3; 4] {
    [
        V3::new(phase, 0.0, 0.0),
        V3::new(1.0, 0.0, 0.0),
        V3::zeros(),
        V3::zeros(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The derivatives handed out are those of the velocity and acceleration handed out.
    #[test]
    fn acceleration_and_jerk_are_derivatives() {
        for (curve, speed) in [(eight as Curve, 22.0), (climbing_turn, 20.0)] {
            let at = |phase: f64| {
                let mut course = Course::new(curve, speed);
                course.phase = phase;
                let [p, ..] = curve(phase);
                let g = course.rate(phase).0;
                (course.target(0.0, p), g)
            };
            for n in 0..60 {
                let (phase, h) = (0.1 * f64::from(n), 1e-5);
                let ((now, g), (up, _), (down, _)) = (at(phase), at(phase + h), at(phase - h));
                let rate = |a: V3, b: V3| (a - b) * (g / (2.0 * h));
                assert!((now.velocity - rate(up.position, down.position)).norm() < 1e-4);
                assert!((now.acceleration - rate(up.velocity, down.velocity)).norm() < 1e-4);
                assert!((now.jerk - rate(up.acceleration, down.acceleration)).norm() < 1e-3);
            }
        }
    }
}
