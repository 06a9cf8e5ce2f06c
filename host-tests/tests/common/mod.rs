//! What several tests share: the same random states and vehicles for the core (f32) and for the
//! reference (f64), where every f64 is the f32 itself.
#![allow(dead_code, reason = "each test uses its part")]

use alula::planar::{
    Attitude, FeedForward, GainParameters, Gains, Inertial, Reference, State, VelocityControl,
};
use alula::{Combined, CombinedParameters, LargeAngle, LargeAngleParameters, VehicleParameters};
use alula_sim::experiment::{Document, Experiment, Model, Vehicle};
use alula_sim::named::Named;
use alula_sim::reference::{self, Aerodynamics, Inputs, Vector};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// The experiment of a text, read as the program reads it: to read it here compiles every reader of its parts again.
pub fn experiment_of(text: String) -> Experiment {
    let named = Named {
        name: "text".to_owned(),
        origin: "text.toml".to_owned(),
        text,
        file: None,
    };
    Document::new(&named).unwrap().experiment().unwrap()
}

pub fn combined(p: CombinedParameters) -> (Model, Aerodynamics) {
    let core = Model::Combined(Combined::new(p).unwrap());
    let reference = Aerodynamics::Combined(reference::Combined {
        c0: p.c0.into(),
        c1: p.c1.into(),
        c2: p.c2.into(),
        c3: p.c3.into(),
        alpha_bar_deg: f64::from(p.alpha_bar).to_degrees(),
        k_l: p.k_l.into(),
        k_d: p.k_d.into(),
    });
    (core, reference)
}

pub fn large_angle(p: LargeAngleParameters) -> (Model, Aerodynamics) {
    let core = Model::LargeAngle(LargeAngle::new(p).unwrap());
    let reference = Aerodynamics::LargeAngle(reference::LargeAngle {
        c0: p.c0.into(),
        c1: p.c1.into(),
    });
    (core, reference)
}

/// The paper's true vehicle at another δ \[rad\] and with this model.
pub fn vehicles(
    delta: f32,
    (core, reference): (Model, Aerodynamics),
) -> (Vehicle, reference::Vehicle) {
    let p = VehicleParameters::PAPER
        .delta(delta)
        // Used in space only.
        .c_y(0.5);
    let reference = reference::Vehicle {
        mass: p.mass.into(),
        k_a: p.k_a.into(),
        delta: p.delta.into(),
        gravity: p.gravity.into(),
        aerodynamics: reference,
    };
    (alula::Vehicle::new(p, core).unwrap(), reference)
}

pub fn gains(p: GainParameters) -> (Gains, reference::Gains) {
    let reference = reference::Gains {
        k1: p.k1.into(),
        k2: p.k2.into(),
        k3: p.k3.into(),
        tau: p.tau.into(),
    };
    (Gains::new(p).unwrap(), reference)
}

/// One set of inputs of the law.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub state: State,
    pub reference: Reference,
    pub feed_forward: FeedForward,
}

impl Point {
    /// The same inputs for the reference; θ is the angle of the attitude's pair.
    pub fn inputs(&self, feed_forward: bool) -> Inputs {
        Inputs {
            velocity: vector(self.state.velocity),
            theta: theta(self.state.attitude),
            wind: vector(self.state.wind),
            reference_velocity: vector(self.reference.velocity),
            reference_acceleration: vector(self.reference.acceleration),
            feed_forward: feed_forward.then(|| {
                let f = &self.feed_forward;
                (vector(f.air_acceleration), vector(f.jerk))
            }),
        }
    }

    /// |v| ≤ 40 m/s, every θ, |v_w| ≤ 15 m/s, |ṽ| ≤ 10 m/s, |a_r| ≤ 5 m/s², |ẍ_a| ≤ 20 m/s²,
    /// |j_r| ≤ 10 m/s³.
    pub fn random(rng: &mut ChaCha8Rng) -> Self {
        let velocity = disc(rng, 40.0);
        Self {
            state: State {
                velocity,
                attitude: Attitude::from_angle(angle(rng)),
                wind: disc(rng, 15.0),
            },
            reference: Reference {
                velocity: velocity - disc(rng, 10.0),
                acceleration: disc(rng, 5.0),
            },
            feed_forward: FeedForward {
                air_acceleration: disc(rng, 20.0),
                jerk: disc(rng, 10.0),
            },
        }
    }
}

pub fn angle(rng: &mut ChaCha8Rng) -> f32 {
    rng.random_range(-core::f32::consts::PI..core::f32::consts::PI)
}

/// Uniform over a disc.
pub fn disc(rng: &mut ChaCha8Rng, radius: f32) -> Inertial {
    let r = radius * rng.random_range(0.0_f32..1.0).sqrt();
    let (sin, cos) = angle(rng).sin_cos();
    Inertial::new(r * cos, r * sin)
}

pub fn vector(v: Inertial) -> Vector {
    Vector::new(v.down().into(), v.forward().into())
}

pub fn inertial(v: Vector) -> Inertial {
    Inertial::new(v.x as f32, v.y as f32)
}

pub fn theta(attitude: Attitude) -> f64 {
    f64::from(attitude.sin).atan2(attitude.cos.into())
}

pub fn control(vehicle: Vehicle, gains: Gains) -> VelocityControl<Model> {
    VelocityControl::new(vehicle, gains)
}

/// The built-in experiment with these fields changed (`PATH=VALUE`).
pub fn experiment(name: &str, settings: &[&str]) -> Experiment {
    let mut document = Document::load(name).unwrap();
    for setting in settings {
        document.assign(setting).unwrap();
    }
    document.checked().unwrap()
}

/// The paper's constant gains in the guidance's place of its own.
pub const PAPER_GAINS: &str =
    "controller.guidance.gains={ k1 = 0.1529, k2 = 0.0234, k3 = 6.0, tau_n = 80.0 }";
