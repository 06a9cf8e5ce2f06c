//! A flight of the guidance on the vehicle that it believes in: what a step costs where it does as it is meant to.

use alula::guidance::Air;
use alula::ned::{Frd, Ned};
use alula::planar::{AirData, Body};
use alula::spatial::{Command, Orientation, Reference};
use alula::{Combined, Guidance, GuidanceInput, GuidanceState, Vehicle};

/// Step \[s\].
pub const STEP: f32 = 0.01;
/// Steps between two that are measured, so that the measured ones are of a long flight.
const BETWEEN: usize = 10;
/// Steps to one velocity, and the velocities: hover, cruise, a turn, a climb, a braking, slow flight to the side, a descent.
const LEG: usize = 1000;
const LEGS: [Ned; 8] = [
    Ned::ZERO,
    Ned::new(20.0, 0.0, 0.0),
    Ned::new(0.0, 20.0, 0.0),
    Ned::new(-10.0, 14.0, -3.0),
    Ned::ZERO,
    Ned::new(0.0, -4.0, 0.0),
    Ned::new(25.0, 0.0, 0.0),
    Ned::new(12.0, 0.0, 2.0),
];
/// Acceleration of the reference [m/s²].
const ACCELERATION: f32 = 3.0;
const WIND: Ned = Ned::new(-4.0, 2.0, 0.0);

/// The flight.
pub struct Flown {
    state: GuidanceState,
    pub input: GuidanceInput,
    steps: usize,
}

impl Flown {
    pub fn new() -> Self {
        Self {
            state: GuidanceState::default(),
            input: GuidanceInput::default()
                .position_error(Ned::ZERO)
                .air(Air::Wind(WIND)),
            steps: 0,
        }
    }

    /// Flies on to the next step that is measured, and gives the memory before it.
    pub fn fly(&mut self, guidance: &Guidance<Combined>) -> GuidanceState {
        for _ in 0..BETWEEN {
            let output = guidance.update(&mut self.state, &self.input, STEP);
            if output.plan_due {
                guidance.plan(&mut self.state);
            }
            self.obey(guidance.vehicle(), &output.command);
        }
        self.state
    }

    /// The vehicle does as the `command` says, and the reference goes on.
    fn obey(&mut self, vehicle: &Vehicle<Combined>, command: &Command) {
        let input = &mut self.input;
        let o = input.orientation;
        // Along the nose and the belly, as the law has it: i to the tail, j to the belly.
        let v_a = o.to_body(input.velocity - WIND);
        let air = AirData::new(Body::new(-v_a.forward, v_a.down), vehicle.thrust_line());
        let force = vehicle.aerodynamic_force(&air);
        let side = -vehicle.k_a() * vehicle.c_y() * air.speed * v_a.right;
        let felt = Frd::new(command.thrust - force.i(), side, force.j());
        let per_mass = 1.0 / vehicle.mass();
        let specific_force = Frd::new(
            felt.forward * per_mass,
            felt.right * per_mass,
            felt.down * per_mass,
        );
        let gravity = Ned::new(0.0, 0.0, vehicle.gravity());
        let (p, q, r) = (command.rates.roll, command.rates.pitch, command.rates.yaw);
        let nose = o.forward() + (o.right() * r - o.down() * q) * STEP;
        let belly = o.down() + (o.forward() * q - o.right() * p) * STEP;
        input.velocity += (o.to_world(specific_force) + gravity) * STEP;
        input.orientation = Orientation::from_directions(nose, belly).unwrap_or(o);
        input.specific_force = Some(specific_force);

        self.steps += 1;
        let target = LEGS[self.steps / LEG % LEGS.len()];
        let before = input.reference.velocity;
        let most = ACCELERATION * STEP;
        let towards = |from: f32, to: f32| from + (to - from).clamp(-most, most);
        let velocity = Ned::new(
            towards(before.north, target.north),
            towards(before.east, target.east),
            towards(before.down, target.down),
        );
        input.reference = Reference {
            velocity,
            acceleration: (velocity - before) * (1.0 / STEP),
            ..Reference::default()
        };
        let error = input.position_error.unwrap_or_default();
        input.position_error = Some(error + (input.velocity - velocity) * STEP);
    }
}
