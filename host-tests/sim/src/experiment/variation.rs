//! How a vehicle of a plant of kind `tail-sitter` differs from its file: random vehicles of a kind are drawn so.

use schemars::JsonSchema;
use serde::Deserialize;

use super::document::{FieldError, finite, require};
use super::tail_sitter::{RateLaw, TailSitterSpec};

/// `[plant.variation]` and `[plant.unknown]`. Factors are 1 and summands 0 if left out.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Variation {
    /// Factor of every length, by Froude's rule: the vehicle flies as before, with times and speeds longer by the root of it.
    pub size: f64,
    /// Factor of mass and moments of inertia.
    pub mass: f64,
    /// Factor of the moment of inertia in pitch, besides.
    pub pitch_inertia: f64,
    /// Factor of the static thrust.
    pub thrust: f64,
    /// Factor of the chords of elevons.
    pub elevon: f64,
    /// Factor of the travel of elevons.
    pub travel: f64,
    /// Factor of the gains of the rate loop.
    pub rate_gain: f64,
    /// Shift of the centre of mass forward, in mean chords.
    pub centre_of_mass_chord: f64,
    /// Added to the angle of stall \[°\].
    pub stall_deg: f64,
}

impl Default for Variation {
    fn default() -> Self {
        Self {
            size: 1.0,
            mass: 1.0,
            pitch_inertia: 1.0,
            thrust: 1.0,
            elevon: 1.0,
            travel: 1.0,
            rate_gain: 1.0,
            centre_of_mass_chord: 0.0,
            stall_deg: 0.0,
        }
    }
}

/// Factors.
const FACTOR: [f64; 2] = [0.1, 10.0];

impl Variation {
    /// Checks every field. Errors name it inside its own table.
    pub(crate) fn validate(&self) -> Result<(), FieldError> {
        let [least, most] = FACTOR;
        for (field, value) in [
            ("size", self.size),
            ("mass", self.mass),
            ("pitch_inertia", self.pitch_inertia),
            ("thrust", self.thrust),
            ("elevon", self.elevon),
            ("travel", self.travel),
            ("rate_gain", self.rate_gain),
        ] {
            finite(field, value)?;
            let problem = format_args!("must be from {least} to {most}");
            require((least..=most).contains(&value), field, problem)?;
        }
        finite("centre_of_mass_chord", self.centre_of_mass_chord)?;
        finite("stall_deg", self.stall_deg)
    }

    /// `vehicle` as it differs.
    pub fn of(&self, vehicle: &TailSitterSpec) -> TailSitterSpec {
        let mut v = vehicle.clone();
        // Speeds and times by Froude's rule; a force grows as the weight.
        let (length, time) = (self.size, self.size.sqrt());
        v.cruise_speed_m_s *= time;
        v.mass_kg *= self.mass * length.powi(3);
        v.inertia_kg_m2 = v.inertia_kg_m2.map(|i| i * self.mass * length.powi(5));
        v.inertia_kg_m2[1] *= self.pitch_inertia;
        v.drag_area_m2 = v.drag_area_m2.map(|a| a * length * length);
        v.linear_drag_n_s_m = v.linear_drag_n_s_m.map(|d| d * length.powi(3) / time);
        v.linear_damping_n_m_s = v.linear_damping_n_m_s.map(|d| d * length.powi(4) * time);
        let ahead = self.centre_of_mass_chord * v.wing.mean_chord();
        let placed =
            |[forward, right, down]: [f64; 3]| [forward - ahead, right, down].map(|x| x * length);
        for strip in &mut v.wing.strips {
            strip.position_m = placed(strip.position_m);
            strip.span_m *= length;
            strip.chord_m *= length;
            strip.elevon *= self.elevon;
        }
        v.wing.section.stall_deg += self.stall_deg;
        for propeller in &mut v.propellers {
            propeller.position_m = placed(propeller.position_m);
            propeller.diameter_m *= length;
            propeller.speed_max_rev_s *= self.thrust.sqrt() / time;
        }
        for foot in &mut v.feet_m {
            *foot = placed(*foot);
        }
        v.motors.lag_s *= time;
        v.servo.lag_s *= time;
        v.servo.rate_deg_s /= time;
        v.servo.travel_deg *= self.travel;
        let rate_loop = &mut v.rate_loop;
        rate_loop.rate_max_rad_s /= time;
        rate_loop.cutoff_hz /= time;
        match &mut rate_loop.law {
            RateLaw::Pid {
                p,
                i,
                d,
                feed_forward,
            } => {
                for (gains, power) in [(p, 1), (i, 0), (d, 2), (feed_forward, 1)] {
                    *gains = gains.map(|gain| gain * self.rate_gain * time.powi(power));
                }
            }
            RateLaw::Incremental {
                gain_1_s,
                effectiveness_rad_s2,
            } => {
                *gain_1_s = gain_1_s.map(|gain| gain * self.rate_gain / time);
                *effectiveness_rad_s2 = effectiveness_rad_s2.map(|g| g / length);
            }
        }
        v
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::V3;
    use crate::experiment::tail_sitter::VEHICLES;
    use crate::plant::Command;
    use crate::plant::tail_sitter::{TailSitter, TailSitterState};

    /// A vehicle of 1.7 times the size flies the same path, 1.7 times as long, in the root of 1.7 times the time.
    #[test]
    fn a_larger_vehicle_flies_by_froudes_rule() {
        let size: f64 = 1.7;
        let time = size.sqrt();
        for (name, text) in VEHICLES {
            let mut small: TailSitterSpec = toml::from_str(text).unwrap();
            small.rate_loop.rate_hz = 500.0;
            let variation = Variation {
                size,
                ..Variation::default()
            };
            let mut large = variation.of(&small);
            // The autopilot's own rate does not follow from the size.
            large.rate_loop.rate_hz = 500.0 / time;
            let end_of = |spec: &TailSitterSpec, length: f64, time: f64| {
                let vehicle = TailSitter::new(spec.clone(), None);
                let weight = spec.mass_kg * 9.81;
                let mut state = vehicle.hover();
                state.velocity = V3::new(2.0, 0.5, -1.0) * (length / time);
                for n in 0..300 {
                    let command = Command {
                        thrust: weight * if n < 100 { 1.2 } else { 0.6 },
                        rates: V3::new(0.3, -0.6, 0.2) / time,
                    };
                    let wind = V3::new(-1.0, 2.0, 0.0) * (length / time);
                    state = vehicle.step(&state, &command, wind, 0.01 * time);
                }
                state
            };
            let a: TailSitterState = end_of(&small, 1.0, 1.0);
            let b = end_of(&large, size, time);
            // 1e-7: roundings of 3 s of flight.
            assert!((b.position / size - a.position).norm() < 1e-7, "{name}");
            assert!((b.velocity / time - a.velocity).norm() < 1e-7, "{name}");
            assert!(a.attitude.angle_to(&b.attitude) < 1e-7, "{name}");
            assert!(a.position.norm() > 1.0, "{name}");
        }
    }

    /// Left out, nothing differs.
    #[test]
    fn the_default_is_the_vehicle_itself() {
        for (_, text) in VEHICLES {
            let spec: TailSitterSpec = toml::from_str(text).unwrap();
            assert_eq!(Variation::default().of(&spec), spec);
        }
    }

    /// Each other number does what it says.
    #[test]
    fn what_is_varied_is_varied() {
        let spec: TailSitterSpec = toml::from_str(VEHICLES[1].1).unwrap();
        let varied = Variation {
            mass: 1.1,
            pitch_inertia: 1.2,
            thrust: 0.9,
            elevon: 0.8,
            travel: 0.7,
            rate_gain: 1.3,
            centre_of_mass_chord: 0.1,
            stall_deg: -2.0,
            ..Variation::default()
        }
        .of(&spec);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} {b}");
        near(varied.mass_kg, 1.1 * spec.mass_kg);
        near(varied.inertia_kg_m2[1], 1.32 * spec.inertia_kg_m2[1]);
        let thrust = |spec: &TailSitterSpec| TailSitter::new(spec.clone(), None).static_thrust();
        near(thrust(&varied), 0.9 * thrust(&spec));
        near(varied.wing.strips[1].elevon, 0.8 * 0.41);
        near(varied.servo.travel_deg, 0.7 * 42.0);
        near(varied.wing.section.stall_deg, 13.0);
        // A chord of 0.3 m: the wing is 30 mm farther back.
        near(varied.wing.strips[0].position_m[0], -0.012 - 0.03);
        near(varied.propellers[0].position_m[0], 0.20 - 0.03);
    }

    #[test]
    fn bad_numbers_are_named() {
        let named = |v: Variation| v.validate().unwrap_err().field;
        let good = Variation::default();
        assert!(good.validate().is_ok());
        assert_eq!(named(Variation { size: 0.0, ..good }), "size");
        let stall_deg = f64::NAN;
        assert_eq!(named(Variation { stall_deg, ..good }), "stall_deg");
    }
}
