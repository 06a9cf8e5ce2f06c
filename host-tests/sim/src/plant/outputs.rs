//! Plants under the outputs of an autopilot that turns the vehicle by itself: elevons and motors in the place of thrust and body rates.

use alula_bridges::sitl::{Flow, Packet};

use super::standing::Standing;
use super::tail_sitter::Flying;
use super::{Command, Dynamics, IdealPlant, Plant, Rotation};
use crate::experiment::tail_sitter::TailSitterPlant;
use crate::experiment::{Experiment, State, V3, to_frd};

/// A plant that `drive` takes on by a time step, under outputs in a wind.
struct UnderOutputs<P, F> {
    plant: P,
    drive: F,
}

impl<P: Plant, F: FnMut(&mut P, &Packet, V3, f64) + Send> Plant<Packet> for UnderOutputs<P, F> {
    fn state(&self) -> &State {
        self.plant.state()
    }

    fn specific_force(&self, wind: V3) -> V3 {
        self.plant.specific_force(wind)
    }

    fn step(&mut self, outputs: &Packet, wind: V3, dt: f64) {
        (self.drive)(&mut self.plant, outputs, wind, dt);
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
    /// The true vehicle under outputs, on the ground at `state`: the ideal one is turned by the torques that `[ardupilot]` says of them,
    /// and a tail-sitter by its servos and motors, without its inner loop and its mixer.
    pub fn plant_under_outputs(&self, state: State) -> Box<dyn Plant<Packet>> {
        let actuators = self.ardupilot;
        if let Some(spec) = &self.tail_sitter {
            let standing = TailSitterPlant {
                standing: true,
                ground_m: None,
                ..spec.clone()
            };
            return Box::new(UnderOutputs {
                plant: Flying::new(&standing, state),
                drive: move |plant: &mut Flying, outputs: &Packet, wind, dt| {
                    // ArduPilot's are positive where the nose pitches up.
                    let elevons = actuators.deflections(outputs).map(|share| -share);
                    plant.drive(actuators.throttles(outputs), elevons, wind, dt);
                },
            });
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
        let lag = self.plant.thrust_lag_s;
        let mut motors = [0.0; 2];
        let drive = move |plant: &mut IdealPlant, outputs: &Packet, wind: V3, dt: f64| {
            let share = match lag > 0.0 {
                true => 1.0 - (-dt / lag).exp(),
                false => 1.0,
            };
            for (thrust, asked) in motors.iter_mut().zip(actuators.thrust(outputs, most)) {
                *thrust += share * (asked - *thrust);
            }
            let state = &mut plant.state;
            let flow = Flow {
                air: to_frd(state.attitude.inverse() * (state.velocity - wind)),
                rates: to_frd(state.rates),
            };
            let mass_and_area = (vehicle.mass, vehicle.k_a);
            let wrench = actuators.wrench(outputs, motors, mass_and_area, &flow);
            let [roll, pitch, yaw] = wrench.torque;
            state.thrust = wrench.thrust;
            let command = Command {
                thrust: wrench.thrust,
                rates: V3::new(yaw, pitch, -roll),
            };
            plant.step(&command, wind, dt);
        };
        let plant = IdealPlant { dynamics, state };
        let plant = UnderOutputs { plant, drive };
        let gravity = self.vehicle.gravity_m_s2;
        Box::new(Standing::new(plant, &state, gravity, |p, state| {
            p.plant.state = state
        }))
    }
}
