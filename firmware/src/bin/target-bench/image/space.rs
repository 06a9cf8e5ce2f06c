//! The same cases in space: the planar case's speeds and special places, at any attitude.

use super::sweep::Random;
use alula::GuidanceInput;
use alula::guidance::Air;
use alula::ned::{Frd, Ned, Quaternion};
use alula::spatial::{
    Correction, FeedForward, ForceSample, Heading, Orientation, Reference, State,
};

/// One input for every function in space.
pub struct SpaceCase {
    /// Attitude, as an autopilot gives it.
    pub quaternion: Quaternion,
    /// State of the vehicle.
    pub state: State,
    /// What is asked of it.
    pub reference: Reference,
    /// Feed-forward.
    pub feed_forward: FeedForward,
    /// What the force estimator looks at.
    pub sample: ForceSample,
    /// Air velocity of `state`.
    pub v_a: Frd,
    /// The same for the guidance, with its air velocity measured and a position to hold.
    pub input: GuidanceInput,
}

/// Case `n`: of every eight, three anywhere in the envelope and one each in still air, in reverse flow, with a small
/// apparent weight, without heading and faulted.
pub fn case(n: usize) -> SpaceCase {
    let random = &mut Random(n as u32 + 77);
    let raw = [(); 4].map(|()| random.within(1.0));
    let length = raw.iter().map(|x| x * x).sum::<f32>();
    let quaternion = unit(raw, length);
    // Nose up is no rotation of these axes: never refused.
    let orientation =
        Orientation::from_quaternion(&quaternion, alula::ned::BodyAxes::NoseUp).unwrap_or_default();
    let mut vector = |limit| {
        Ned::new(
            random.within(limit),
            random.within(limit),
            random.within(limit),
        )
    };
    let (velocity, mut acceleration, wind) = (vector(25.0), vector(4.0), vector(6.0));
    let (air_acceleration, jerk, force) = (vector(8.0), vector(8.0), vector(20.0));
    // Drawn along the tail, the belly and the right wing.
    let body = |tail: f32, belly, wing| Frd::new(-tail, wing, belly);
    let v_a = match n % 8 {
        3 if n % 16 == 3 => Frd::default(),
        3 => body(
            random.within(1e-6),
            random.within(1e-6),
            random.within(1e-6),
        ),
        4 => body(
            20.0 + random.within(20.0),
            random.within(2.0),
            random.within(2.0),
        ),
        _ => body(random.within(25.0), random.within(25.0), random.within(5.0)),
    };
    if n % 8 == 5 {
        acceleration = Ned::new(0.0, 0.0, 9.81) + acceleration * (0.1 / (1 + n % 7) as f32);
    }
    let heading = if n % 8 == 6 {
        Heading::FREE
    } else {
        Heading::from_angle(random.within(3.0))
    };
    let mut state = State {
        velocity: orientation.to_world(v_a) + wind,
        orientation,
        wind,
        correction: Correction::new(force, random.within(2.0)),
    };
    if n % 8 == 7 {
        let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30][n / 8 % 4];
        match n / 32 % 2 {
            0 => state.velocity.north = bad,
            _ => acceleration.down = bad,
        }
    }
    let reference = Reference {
        velocity,
        acceleration,
        heading,
    };
    SpaceCase {
        quaternion,
        state,
        reference,
        feed_forward: FeedForward {
            air_acceleration,
            jerk,
        },
        sample: ForceSample {
            specific_force: body(
                -9.0 + random.within(3.0),
                random.within(9.0),
                random.within(2.0),
            ),
            orientation,
            aerodynamic: body(random.within(20.0), random.within(90.0), random.within(9.0)),
            thrust: 60.0 + random.within(60.0),
        },
        v_a,
        input: GuidanceInput::default()
            .velocity(state.velocity)
            .orientation(orientation)
            .state_age(0.0)
            .air(Air::Velocity(state.velocity - state.wind))
            .specific_force(Some(Frd::new(9.0, 0.5, 2.0)))
            .position_error(Some(Ned::new(
                random.within(12.0),
                random.within(12.0),
                random.within(3.0),
            )))
            .reference(reference)
            .reference_age(0.0),
    }
}

/// The quaternion of `raw`, whose square is `square`, by Newton's method: there is no square root to call here.
fn unit(raw: [f32; 4], square: f32) -> Quaternion {
    let mut root = 1.0 + 0.5 * square;
    for _ in 0..12 {
        root = 0.5 * (root + square / root);
    }
    let [w, x, y, z] = raw.map(|c| c / root);
    Quaternion { w, x, y, z }
}
