//! A tail-sitter as a [`Plant`].

use super::ground::Ground;
use super::{Allocation, MOTORS, TailSitter, TailSitterState, V3};
use crate::experiment::tail_sitter::TailSitterPlant;
use crate::experiment::{State, from_frd, nose_forward, to_frd};
use crate::plant::{Command, Plant};

/// Columns of its own.
const COLUMNS: &[(&str, &str)] = &[
    ("motor_1_rev_s", "speed of the first propeller [rev/s]"),
    ("motor_2_rev_s", "of the second"),
    ("motor_3_rev_s", "of the third"),
    ("motor_4_rev_s", "of the fourth"),
    (
        "elevon_left_deg",
        "left elevon, trailing edge to the belly positive",
    ),
    ("elevon_right_deg", "right elevon"),
    (
        "battery",
        "speed at full throttle over that on a full battery",
    ),
    (
        "saturated",
        "1 where the mixer could not give what the inner loop asked for",
    ),
    (
        "missing_pitch",
        "torque about the right wing that it could not give, a share of full torque",
    ),
    ("missing_roll", "the same about the nose"),
    ("missing_yaw", "the same about the belly"),
    ("grounded", "1 where the vehicle touches the ground"),
];

/// Where `elevon_left_deg` stands among its readings; the right one is next.
pub const ELEVONS: usize = 4;
/// Where `missing_pitch` stands among them.
pub const MISSING_PITCH: usize = 8;

/// A tail-sitter with where it is.
pub struct Flying {
    vehicle: TailSitter,
    own: TailSitterState,
    /// The state as the trait has it.
    state: State,
}

impl Flying {
    /// The vehicle of `plant` at `state`: motors at the thrust of the state, elevons at rest.
    pub fn new(plant: &TailSitterPlant, state: State) -> Self {
        let spec = plant.true_vehicle();
        let stands = || state.position.z + Ground::new(&spec).stance();
        let ground = plant.ground_m.or_else(|| plant.standing.then(stands));
        let vehicle = TailSitter::new(spec.clone(), ground);
        let share = (state.thrust / vehicle.static_thrust()).clamp(0.0, 1.0);
        let mut motors = [0.0; MOTORS];
        for (speed, propeller) in motors.iter_mut().zip(&spec.propellers) {
            *speed = propeller.speed_max_rev_s * share.sqrt();
        }
        let own = TailSitterState {
            position: state.position,
            velocity: state.velocity,
            attitude: state.attitude * nose_forward(),
            rates: to_frd(state.rates).into(),
            motors,
            ..TailSitterState::at_rest()
        };
        Self {
            vehicle,
            own,
            state,
        }
    }

    /// Goes on by `dt` \[s\] with the motors on the left and on the right at these shares of their static thrust, and the elevons at
    /// these of their travel, positive trailing edge towards the belly. A motor in the middle has the mean.
    pub fn drive(&mut self, throttles: [f64; 2], elevons: [f64; 2], wind: V3, dt: f64) {
        let [left, right] = throttles;
        let propellers = self.vehicle.spec().propellers.iter();
        let motors = propellers.map(|propeller| match propeller.position_m[1] {
            y if y < 0.0 => left,
            y if y > 0.0 => right,
            _ => 0.5 * (left + right),
        });
        let outputs = Allocation {
            motors: motors.collect(),
            elevons,
            given: V3::zeros(),
        };
        self.put(self.vehicle.driven(&self.own, &outputs, wind, dt), wind);
    }

    fn put(&mut self, own: TailSitterState, wind: V3) {
        self.own = own;
        self.state = State {
            position: own.position,
            velocity: own.velocity,
            attitude: own.attitude * nose_forward().inverse(),
            rates: from_frd(own.rates.into()),
            thrust: self.vehicle.thrust(&own, wind),
        };
    }
}

impl Plant for Flying {
    fn state(&self) -> &State {
        &self.state
    }

    fn specific_force(&self, wind: V3) -> V3 {
        let force = self.vehicle.wrench(&self.own, wind).force;
        let body = from_frd(force.into()) / self.vehicle.spec().mass_kg;
        V3::new(body.z, body.x, body.y)
    }

    fn step(&mut self, command: &Command, wind: V3, dt: f64) {
        let own = Command {
            thrust: command.thrust,
            rates: to_frd(command.rates).into(),
        };
        self.put(self.vehicle.step(&self.own, &own, wind, dt), wind);
    }

    fn is_grounded(&self) -> bool {
        self.vehicle.is_grounded(&self.own)
    }

    fn columns(&self) -> &'static [(&'static str, &'static str)] {
        COLUMNS
    }

    fn readings(&self) -> Vec<f64> {
        let own = &self.own;
        let motors = self.vehicle.spec().propellers.len();
        let speeds = (0..MOTORS).map(|k| if k < motors { own.motors[k] } else { f64::NAN });
        let missing = own.rate_loop.missing();
        let is = |condition: bool| f64::from(u8::from(condition));
        let rest = [
            own.elevons[0].to_degrees(),
            own.elevons[1].to_degrees(),
            self.vehicle.battery(own),
            is(missing.norm() > 1e-6),
            missing.y,
            missing.x,
            missing.z,
            is(self.vehicle.is_grounded(own)),
        ];
        speeds.chain(rest).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_stand_where_they_are_looked_for() {
        assert_eq!(COLUMNS[ELEVONS].0, "elevon_left_deg");
        assert_eq!(COLUMNS[ELEVONS + 1].0, "elevon_right_deg");
        assert_eq!(COLUMNS[MISSING_PITCH].0, "missing_pitch");
    }
}
