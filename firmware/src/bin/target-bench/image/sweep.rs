//! The cases: a fixed sweep of the envelope, of its special places, and of input outside it.

use super::functions::Fixture;
use super::space::{self, SpaceCase};
use alula::AngleOfAttack;
use alula::planar::equivalency::ApparentForces;
use alula::planar::{Attitude, Body, FeedForward, Inertial, Reference, State};
use core::f32::consts::PI;

/// How many.
pub const CASES: usize = 4000;

/// One input for every function.
pub struct Case {
    /// State of the vehicle.
    pub state: State,
    /// What is asked of it.
    pub reference: Reference,
    /// Feed-forward.
    pub feed_forward: FeedForward,
    /// Air velocity of `state`.
    pub v_a: Body,
    /// Forces at `state` and `reference`.
    pub forces: ApparentForces,
    /// An angle of attack, and any other angle.
    pub alpha: AngleOfAttack,
    /// A length inside or outside the guard's region \[N\].
    pub force: f32,
    /// In space.
    pub space: SpaceCase,
}

/// Case `n`: of every eight, three anywhere in the envelope and one each in still air, in reverse flow, with
/// F_p in the guard's region, with θ̃ near π, and faulted.
pub fn case(fixture: &Fixture, n: usize) -> Case {
    let random = &mut Random(n as u32 + 1);
    let attitude = Attitude::from_angle(random.within(PI));
    let mut vector = |limit| Inertial::new(random.within(limit), random.within(limit));
    let (velocity, acceleration) = (vector(30.0), vector(5.0));
    let (wind, air_acceleration, jerk) = (vector(10.0), vector(10.0), vector(10.0));
    let v_a = match n % 8 {
        3 if n % 16 == 3 => Body::new(0.0, 0.0),
        3 => Body::new(random.within(1e-6), random.within(1e-6)),
        4 => Body::new(20.0 + random.within(20.0), random.within(2.0)),
        _ => Body::new(random.within(28.0), random.within(28.0)),
    };
    let mut state = State {
        velocity: attitude.to_inertial(v_a) + wind,
        attitude,
        wind,
    };
    let mut reference = Reference {
        velocity,
        acceleration,
    };

    let size = [0.0, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0, 80.0][n / 8 % 8];
    let (force, angle) = (size * random.within(1.0), random.within(PI));
    let wanted = match n % 8 {
        5 => Some(polar(force, angle)),
        6 => Some(polar(100.0, PI - 1e-3 * force)),
        _ => None,
    };
    if let Some(f_p) = wanted {
        reference.acceleration = Inertial::ZERO;
        let control = &fixture.combined_control;
        if let Ok(command) = control.robust(&state, &reference, None) {
            let excess = (command.diagnostics.f_p - f_p) / control.vehicle().mass();
            reference.acceleration = attitude.to_inertial(excess);
        }
    }

    if n % 8 == 7 {
        let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30][n / 8 % 4];
        match n / 32 % 5 {
            0 => state.velocity = Inertial::new(bad, 0.0),
            1 => state.wind = Inertial::new(0.0, bad),
            2 => state.attitude.cos = bad,
            3 => reference.velocity = Inertial::new(bad, bad),
            _ => reference.acceleration = Inertial::new(0.0, bad),
        }
    }
    Case {
        state,
        reference,
        feed_forward: FeedForward {
            air_acceleration,
            jerk,
        },
        v_a,
        forces: ApparentForces::new(
            fixture.combined_control.vehicle(),
            state.attitude,
            state.velocity - state.wind,
            reference.acceleration,
        ),
        alpha: AngleOfAttack::from_radians(random.within(PI)),
        force: 2.0 * force.abs(),
        space: space::case(n),
    }
}

fn polar(length: f32, angle: f32) -> Body {
    let direction = Attitude::from_angle(angle);
    Body::new(length * direction.cos, length * direction.sin)
}

/// Marsaglia's xorshift.
pub struct Random(pub u32);

impl Random {
    /// A number in [−`limit`, `limit`].
    pub fn within(&mut self, limit: f32) -> f32 {
        for _ in 0..4 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 17;
            self.0 ^= self.0 << 5;
        }
        limit * (self.0 as i32 as f32 / i32::MAX as f32)
    }
}
