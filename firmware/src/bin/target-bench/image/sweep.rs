//! The cases: a fixed sweep of the envelope and of what lies outside it.

use super::functions::Fixture;
use alula::air::AngleOfAttack;
use alula::frame::{Attitude, Body, Inertial};

/// How many.
pub const CASES: usize = 2000;

/// One input for every function.
pub struct Case {
    /// Air velocity.
    pub v_a: Body,
    /// Angle of attack, and any other angle.
    pub alpha: AngleOfAttack,
}

/// Case `n`.
pub fn case(_: &Fixture, n: usize) -> Case {
    let mut random = Random(n as u32 + 1);
    let attitude = Attitude::from_angle(random.within(3.2));
    // One in eight stands still, or nearly.
    let scale = match n % 16 {
        0 => 0.0,
        1 => 1e-9,
        _ => 40.0,
    };
    let velocity = Inertial::new(random.within(scale), random.within(scale));
    Case {
        v_a: attitude.to_body(velocity),
        alpha: AngleOfAttack::from_radians(random.within(3.2)),
    }
}

/// Marsaglia's xorshift.
struct Random(u32);

impl Random {
    /// A number in [−`limit`, `limit`].
    fn within(&mut self, limit: f32) -> f32 {
        for _ in 0..4 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 17;
            self.0 ^= self.0 << 5;
        }
        limit * (self.0 as i32 as f32 / i32::MAX as f32)
    }
}
