//! The same random states for the core (f32) and for the reference (f64), where every f64 is the f32 itself.

use alula::ned::{BodyAxes, Quaternion};
use alula::spatial::{
    Correction, FeedForward, Heading, LateralGains, LateralParameters, Ned, Orientation, Reference,
    State,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::yardstick::{self, SpatialInputs};

/// c_Y of the vehicle under test.
pub const C_Y: f32 = 0.5;

/// One set of inputs of a law in space.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub velocity: Ned,
    pub quaternion: Quaternion,
    pub wind: Ned,
    pub reference: Reference,
    pub heading: Ned,
    pub force: Ned,
    pub sideslip: f32,
    pub feed_forward: FeedForward,
}

pub fn triple(v: Ned) -> [f64; 3] {
    [v.north, v.east, v.down].map(f64::from)
}

pub fn ned([n, e, d]: [f64; 3]) -> Ned {
    Ned::new(n as f32, e as f32, d as f32)
}

/// Uniform over a ball.
pub fn ball(rng: &mut ChaCha8Rng, radius: f32) -> Ned {
    let mut normal = || StandardNormal.sample(rng);
    let (a, b, c): (f32, f32, f32) = (normal(), normal(), normal());
    let length = (a * a + b * b + c * c).sqrt();
    Ned::new(a, b, c) * (radius * rng.random_range(0.0_f32..1.0).cbrt() / length)
}

/// Uniform over the rotations.
pub fn rotation(rng: &mut ChaCha8Rng) -> Quaternion {
    let mut normal = || StandardNormal.sample(rng);
    let raw: [f32; 4] = [normal(), normal(), normal(), normal()];
    let length = raw.iter().map(|x| x * x).sum::<f32>().sqrt();
    let [w, x, y, z] = raw.map(|c| c / length);
    Quaternion { w, x, y, z }
}

impl Point {
    /// |v| ≤ 40 m/s, every attitude, |v_w| ≤ 15 m/s, |ṽ| ≤ 10 m/s, |a_r| ≤ 5 m/s², every heading, |d̂| ≤ 20 N,
    /// ≤ 3 m/s of sideslip correction, |a| ≤ 20 m/s², |j_r| ≤ 10 m/s³.
    pub fn random(rng: &mut ChaCha8Rng) -> Self {
        let velocity = ball(rng, 40.0);
        let angle: f32 = rng.random_range(-3.2..3.2);
        Self {
            velocity,
            quaternion: rotation(rng),
            wind: ball(rng, 15.0),
            reference: Reference {
                velocity: velocity - ball(rng, 10.0),
                acceleration: ball(rng, 5.0),
                heading: Heading::from_angle(angle),
            },
            // The core's own sine and cosine are good to 1.2e-7, one rounding.
            heading: ned([f64::from(angle).cos(), f64::from(angle).sin(), 0.0]),
            force: ball(rng, 20.0),
            sideslip: rng.random_range(-3.0..3.0),
            feed_forward: FeedForward {
                air_acceleration: ball(rng, 20.0),
                jerk: ball(rng, 10.0),
            },
        }
    }

    pub fn state(&self) -> State {
        State {
            velocity: self.velocity,
            orientation: Orientation::from_quaternion(&self.quaternion, BodyAxes::NoseUp).unwrap(),
            wind: self.wind,
            correction: Correction::new(self.force, self.sideslip),
        }
    }

    /// The same inputs for the reference.
    pub fn inputs(&self, feed_forward: bool) -> SpatialInputs {
        let q = self.quaternion;
        SpatialInputs {
            velocity: triple(self.velocity),
            quaternion: [q.w, q.x, q.y, q.z].map(f64::from),
            wind: triple(self.wind),
            reference_velocity: triple(self.reference.velocity),
            reference_acceleration: triple(self.reference.acceleration),
            heading: triple(self.heading),
            force: triple(self.force),
            sideslip: self.sideslip.into(),
            feed_forward: feed_forward.then(|| {
                let f = &self.feed_forward;
                (triple(f.air_acceleration), triple(f.jerk))
            }),
        }
    }
}

pub fn lateral() -> (LateralGains, yardstick::LateralGains) {
    let p = LateralParameters::PAPER_VEHICLE;
    let reference = yardstick::LateralGains {
        tilt: p.tilt.into(),
        velocity: p.velocity.into(),
        twist: p.twist.into(),
        acceleration: p.acceleration.into(),
        force: p.force.into(),
        airspeed: p.airspeed.into(),
        heading: p.heading.into(),
    };
    (LateralGains::new(p).unwrap(), reference)
}
