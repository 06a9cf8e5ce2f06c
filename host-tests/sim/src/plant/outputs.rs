//! Plants under the outputs of an autopilot that turns the vehicle by itself: elevons and motors in the place of thrust and body rates.

use alula_bridges::sitl::{ActuatorState, Actuators, Flow, Packet};

use super::standing::Standing;
use super::tail_sitter::Flying;
use super::{Command, Dynamics, IdealPlant, Plant, Rotation};
use crate::experiment::tail_sitter::TailSitterPlant;
use crate::experiment::{Experiment, State, V3, to_frd};

/// The ideal vehicle, turned by the torques that `[ardupilot]` says of the outputs.
struct Elevons {
    plant: IdealPlant,
    actuators: Actuators,
    /// Mass \[kg\] and k_a \[kg/m\].
    mass_and_area: (f64, f64),
    /// Each motor, behind its lag.
    motors: ActuatorState,
    /// \[s\].
    lag: f64,
    /// Thrust of both at full throttle \[N\].
    most: f64,
}

impl Plant<Packet> for Elevons {
    fn state(&self) -> &State {
        self.plant.state()
    }

    fn specific_force(&self, wind: V3) -> V3 {
        self.plant.specific_force(wind)
    }

    fn step(&mut self, outputs: &Packet, wind: V3, dt: f64) {
        let asked = self.actuators.thrust(outputs, self.most);
        let share = match self.lag > 0.0 {
            true => 1.0 - (-dt / self.lag).exp(),
            false => 1.0,
        };
        for (thrust, asked) in self.motors.iter_mut().zip(asked) {
            *thrust += share * (asked - *thrust);
        }
        let state = self.plant.state;
        let flow = Flow {
            air: to_frd(state.attitude.inverse() * (state.velocity - wind)),
            rates: to_frd(state.rates),
        };
        let wrench = self
            .actuators
            .wrench(outputs, self.motors, self.mass_and_area, &flow);
        let [roll, pitch, yaw] = wrench.torque;
        self.plant.state.thrust = wrench.thrust;
        let command = Command {
            thrust: wrench.thrust,
            rates: V3::new(yaw, pitch, -roll),
        };
        self.plant.step(&command, wind, dt);
    }
}

/// A tail-sitter whose servos and motors are where the outputs drive them: its inner loop and its mixer have no part.
struct Driven {
    plant: Flying,
    actuators: Actuators,
}

impl Plant<Packet> for Driven {
    fn state(&self) -> &State {
        self.plant.state()
    }

    fn specific_force(&self, wind: V3) -> V3 {
        self.plant.specific_force(wind)
    }

    fn step(&mut self, outputs: &Packet, wind: V3, dt: f64) {
        let throttles = self.actuators.throttles(outputs);
        // ArduPilot's are positive where the nose pitches up.
        let elevons = self.actuators.deflections(outputs).map(|share| -share);
        self.plant.drive(throttles, elevons, wind, dt);
    }

    fn columns(&self) -> &'static [(&'static str, &'static str)] {
        self.plant.columns()
    }

    fn readings(&self) -> Vec<f64> {
        self.plant.readings()
    }

    fn is_grounded(&self) -> bool {
        self.plant.is_grounded()
    }
}

impl Experiment {
    /// The true vehicle under outputs, on the ground at `state`.
    pub fn plant_under_outputs(&self, state: State) -> Box<dyn Plant<Packet>> {
        let actuators = self.ardupilot;
        if let Some(spec) = &self.tail_sitter {
            let standing = TailSitterPlant {
                standing: true,
                ground_m: None,
                ..spec.clone()
            };
            let plant = Flying::new(&standing, state);
            return Box::new(Driven { plant, actuators });
        }
        let vehicle = self.vehicle.reference();
        let [nose, wing, belly] = actuators.inertia(vehicle.mass);
        let most = self.thrust_limits(None, self.weight())[1];
        let dynamics = Dynamics {
            // The motors lag, each for itself.
            thrust_lag: 1.0,
            thrust: [0.0, most],
            rotation: Rotation::Torque(V3::new(belly, wing, nose)),
            ..Dynamics::of(self)
        };
        let plant = Elevons {
            plant: IdealPlant { dynamics, state },
            actuators,
            mass_and_area: (vehicle.mass, vehicle.k_a),
            motors: [0.0; 2],
            lag: self.plant.thrust_lag_s,
            most,
        };
        let put = |plant: &mut Elevons, state| plant.plant.state = state;
        Box::new(Standing::new(plant, &state, self.vehicle.gravity_m_s2, put))
    }
}
