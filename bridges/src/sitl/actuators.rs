//! What the servo outputs do to a tail-sitter with two elevons and two motors.

use std::fmt;

use schemars::JsonSchema;
use serde::Deserialize;

use super::Packet;

/// `[ardupilot]` of an experiment: which output is what, and what it does. Lengths scale with the vehicle: forces come from its thrust,
/// its mass and its k_a. Arrays of two are (roll, pitch), of three (about nose, wing, belly).
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Actuators {
    /// Channels of the left (function 77) and right (78) elevon.
    pub elevons: [u8; 2],
    /// Channels of the left (function 73) and right (74) throttle.
    pub throttles: [u8; 2],
    /// Radii of gyration \[m\]: each moment of inertia is m r².
    pub gyration_m: [f64; 3],
    /// Torque of fully deflected elevons in the slipstream over the thrust \[m\].
    pub elevon_slipstream_m: [f64; 2],
    /// Torque of fully deflected elevons in the airflow along the nose over k_a u² \[m\].
    pub elevon_airflow_m: [f64; 2],
    /// Distance of each motor from the plane of symmetry \[m\].
    pub motor_arm_m: f64,
    /// Damping of rotation over the moment of inertia, at rest [1/s].
    pub damping_1_s: [f64; 3],
    /// The same over the airspeed [1/m].
    pub damping_1_m: [f64; 3],
    /// Torque about the belly that turns the nose into the wind, over moment of inertia, airspeed and its lateral part [1/m²].
    pub weathercock_1_m2: f64,
    /// The channel whose rise over 1700 µs starts the experiment's clock. Without it the lift-off does.
    pub mark_channel: Option<u8>,
}

impl Default for Actuators {
    fn default() -> Self {
        Self {
            elevons: [1, 2],
            throttles: [3, 4],
            gyration_m: [0.2, 0.12, 0.25],
            elevon_slipstream_m: [0.08, 0.06],
            elevon_airflow_m: [0.04, 0.03],
            motor_arm_m: 0.2,
            damping_1_s: [1.0, 1.0, 0.5],
            damping_1_m: [0.2, 0.1, 0.1],
            weathercock_1_m2: 0.01,
            mark_channel: None,
        }
    }
}

/// A field that is refused, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// The field.
    pub field: &'static str,
    /// What is wrong with it.
    pub problem: &'static str,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.problem)
    }
}

impl std::error::Error for Refused {}

/// Thrust along the nose \[N\] and torque \[N·m\] in forward-right-down components.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Thrust.
    pub thrust: f64,
    /// Torque.
    pub torque: [f64; 3],
}

/// The motors' thrust \[N\], left and right: behind a lag.
pub type ActuatorState = [f64; 2];

/// What the air and the rotation do to the actuators.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flow {
    /// Air velocity [m/s], forward-right-down.
    pub air: [f64; 3],
    /// Angular velocity [rad/s], forward-right-down.
    pub rates: [f64; 3],
}

/// Pulse width \[µs\] of a closed throttle, and the range to full; a surface is in the middle of it.
const LEAST: f64 = 1000.0;
const RANGE: f64 = 1000.0;

impl Actuators {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field that is refused.
    pub fn validate(&self) -> Result<(), Refused> {
        let refuse = |field, problem| Err(Refused { field, problem });
        let channels = [self.elevons, self.throttles].concat();
        let twice = (1..4).any(|i| channels[..i].contains(&channels[i]));
        let there = |channel: &u8| (1..=32).contains(channel);
        if twice || !channels.iter().all(there) {
            return refuse(
                "elevons",
                "elevons and throttles must be four channels from 1 to 32",
            );
        }
        if !self.mark_channel.iter().all(there) {
            return refuse("mark_channel", "must be from 1 to 32");
        }
        if !self.gyration_m.iter().all(|r| *r > 0.0 && r.is_finite()) {
            return refuse("gyration_m", "must be positive");
        }
        let fields: [(&'static str, &[f64]); 6] = [
            ("elevon_slipstream_m", &self.elevon_slipstream_m),
            ("elevon_airflow_m", &self.elevon_airflow_m),
            ("motor_arm_m", &[self.motor_arm_m]),
            ("damping_1_s", &self.damping_1_s),
            ("damping_1_m", &self.damping_1_m),
            ("weathercock_1_m2", &[self.weathercock_1_m2]),
        ];
        for (field, values) in fields {
            if !values.iter().all(|v| *v >= 0.0 && v.is_finite()) {
                return refuse(field, "must not be negative");
            }
        }
        Ok(())
    }

    /// Moments of inertia \[kg·m²\] of a vehicle of this `mass` \[kg\], about nose, wing and belly.
    #[must_use]
    pub fn inertia(&self, mass: f64) -> [f64; 3] {
        self.gyration_m.map(|r| mass * r * r)
    }

    /// The thrust \[N\] that the outputs ask for, left and right, of motors that give `most` together: proportional to the pulse width.
    #[must_use]
    pub fn thrust(&self, packet: &Packet, most: f64) -> ActuatorState {
        self.throttles(packet).map(|share| 0.5 * most * share)
    }

    /// How far the throttles are open, left and right: from 0 to 1.
    #[must_use]
    pub fn throttles(&self, packet: &Packet) -> [f64; 2] {
        let throttle = |channel| (f64::from(packet.channel(channel)) - LEAST) / RANGE;
        self.throttles
            .map(|channel| throttle(channel).clamp(0.0, 1.0))
    }

    /// How far the elevons are deflected, left and right: from −1 to 1, with both positive the nose pitches up. A channel that is off is neutral.
    #[must_use]
    pub fn deflections(&self, packet: &Packet) -> [f64; 2] {
        self.elevons.map(|channel| match packet.channel(channel) {
            0 => 0.0,
            width => ((f64::from(width) - LEAST) / (0.5 * RANGE) - 1.0).clamp(-1.0, 1.0),
        })
    }

    /// The wrench of the outputs and the air, with `thrust` \[N\] of the motors, on a vehicle of this `mass` \[kg\] and `k_a` \[kg/m\].
    ///
    /// A pulse longer than 1500 µs deflects an elevon such that, with both, the nose pitches up. Pitch is the mean of
    /// both. The vehicle rolls right by half of right less left.
    #[must_use]
    pub fn wrench(
        &self,
        packet: &Packet,
        thrust: ActuatorState,
        (mass, k_a): (f64, f64),
        flow: &Flow,
    ) -> Wrench {
        let [left, right] = self.deflections(packet);
        let total = thrust[0] + thrust[1];
        let [u, v, w] = flow.air;
        let speed = (u * u + v * v + w * w).sqrt();
        // From behind there is no flow over the surfaces but the slipstream's.
        let along = k_a * u.max(0.0).powi(2);
        let power =
            |i: usize| self.elevon_slipstream_m[i] * total + self.elevon_airflow_m[i] * along;
        let inertia = self.inertia(mass);
        let mut torque = [
            0.5 * (right - left) * power(0),
            0.5 * (left + right) * power(1),
            self.motor_arm_m * (thrust[0] - thrust[1])
                + inertia[2] * self.weathercock_1_m2 * speed * v,
        ];
        for (i, torque) in torque.iter_mut().enumerate() {
            let damping = self.damping_1_s[i] + self.damping_1_m[i] * speed;
            *torque -= inertia[i] * damping * flow.rates[i];
        }
        Wrench {
            thrust: total,
            torque,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wrench(widths: [u16; 4], flow: &Flow) -> Wrench {
        let actuators = Actuators::default();
        let packet = Packet::new(400, 0, &widths);
        let thrust = actuators.thrust(&packet, 200.0);
        actuators.wrench(&packet, thrust, (10.0, 0.65), flow)
    }

    /// Signs are ArduPilot's: pitch up is the mean of the elevons, roll right is right less left; more thrust on the left turns the nose
    /// to the right.
    #[test]
    fn outputs_turn_the_vehicle_as_ardupilot_means_them() {
        let still = Flow::default();
        let neutral = wrench([1500, 1500, 1500, 1500], &still);
        assert_eq!((neutral.thrust, neutral.torque), (100.0, [0.0; 3]));
        // 1e-12: roundings.
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(
            wrench([2000, 2000, 1500, 1500], &still).torque,
            [0.0, 6.0, 0.0]
        ));
        assert!(close(
            wrench([1250, 1750, 1500, 1500], &still).torque,
            [4.0, 0.0, 0.0]
        ));
        assert!(close(
            wrench([1500, 1500, 1600, 1400], &still).torque,
            [0.0, 0.0, 4.0]
        ));
        // Off, and beyond the range.
        assert_eq!(wrench([0, 0, 0, 0], &still), Wrench::default());
        assert_eq!(wrench([1500, 1500, 2500, 2500], &still).thrust, 200.0);
    }

    #[test]
    fn the_air_acts_on_the_surfaces_and_against_rotation() {
        let fast = Flow {
            air: [20.0, 0.0, 0.0],
            ..Flow::default()
        };
        let torque = wrench([2000, 2000, 1000, 1000], &fast).torque;
        assert!((torque[1] - 0.03 * 0.65 * 400.0).abs() < 1e-12);
        let backwards = Flow {
            air: [-20.0, 0.0, 0.0],
            ..Flow::default()
        };
        assert_eq!(
            wrench([2000, 2000, 1000, 1000], &backwards).torque,
            [0.0; 3]
        );
        // Air from the right, that is a flight to the right, turns the nose to the right; a rotation is damped.
        let slip = Flow {
            air: [20.0, 1.0, 0.0],
            rates: [0.0, 0.5, 0.0],
        };
        let torque = wrench([1500, 1500, 1000, 1000], &slip).torque;
        assert!(torque[1] < 0.0 && torque[2] > 0.0, "{torque:?}");
    }

    #[test]
    fn fields_are_checked() {
        let good = Actuators::default();
        assert_eq!(good.validate(), Ok(()));
        let refused = |bad: Actuators| bad.validate().unwrap_err().to_string();
        assert!(
            refused(Actuators {
                throttles: [3, 2],
                ..good
            })
            .starts_with("elevons: ")
        );
        assert!(
            refused(Actuators {
                mark_channel: Some(33),
                ..good
            })
            .starts_with("mark_channel")
        );
        assert!(
            refused(Actuators {
                gyration_m: [0.1, 0.0, 0.1],
                ..good
            })
            .contains("positive")
        );
        assert!(
            refused(Actuators {
                motor_arm_m: f64::NAN,
                ..good
            })
            .starts_with("motor_arm_m")
        );
    }
}
