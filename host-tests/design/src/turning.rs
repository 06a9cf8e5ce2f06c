//! What turns a vehicle in pitch: from what does it and one number that a log shows, the rest by rule.

use super::known::{Actuators, Facts};
use alula_sim::experiment::AuthoritySpec;
use alula_sim::polar::most_drag;

/// Share of an elevon in the slipstream, and speed of the slipstream there over what the propeller gives the air at its disc.
const IN_SLIPSTREAM: f64 = 0.7;
const CONTRACTED: f64 = 1.7;
/// Radius of gyration in pitch over the mean chord, of a wing, and of a vehicle that differences of thrust turn: its motors stand off the wing, or its wings
/// off each other. Distance of the elevons behind the centre of mass. Those of the vehicle files.
const GYRATION: f64 = 0.37;
const STANDING_OFF: f64 = 0.65;
const ARM: f64 = 0.25;
/// How far behind the centre of mass the force of a wing across the flow acts, over the mean chord: from a quarter of it, near which the centre of mass is, to half.
const AFT: f64 = 0.25;
/// Aspect ratio of a wing of which none is known.
const RATIO: f64 = 6.0;
/// Speed \[m/s\] that propellers give the air in hover, where their diameter is not known.
const DOWNWASH: f64 = 8.0;

/// Airspeed at which full throttle gives no thrust, over the speed that full throttle gives the air at rest: 2.2 to 3.2 of the vehicle files; and the least
/// over cruise, that of `heavy`.
const NO_THRUST: f64 = 2.6;
const BEYOND_CRUISE: f64 = 1.2;

/// A number of `[vehicle.authority]` with where it is from.
pub(super) struct Sourced {
    pub value: f64,
    pub source: String,
}

impl Facts {
    /// Speed that the propellers give the air in hover \[m/s\].
    fn downwash(&self) -> Sourced {
        match self.propeller_m {
            Some(diameter) => {
                let (_, number) = self.actuators.words();
                let discs = number * std::f64::consts::FRAC_PI_4 * diameter * diameter;
                Sourced {
                    value: (self.weight() / (2.0 * self.air_kg_m3 * discs)).sqrt(),
                    source: format!("of {number} propellers of {diameter} m"),
                }
            }
            None => Sourced {
                value: DOWNWASH,
                source: "assumed: --propeller-m makes it the vehicle's".to_owned(),
            },
        }
    }

    /// Airspeed from which on full throttle gives no thrust \[m/s\].
    fn zero_thrust(&self) -> Sourced {
        match self.zero_thrust_m_s {
            Some(value) => Sourced {
                value,
                source: "measured".to_owned(),
            },
            None => {
                let usual = NO_THRUST * self.downwash().value * self.thrust_to_weight.sqrt();
                Sourced {
                    value: usual.max(BEYOND_CRUISE * self.cruise_m_s),
                    source:
                        "assumed, of usual propellers: --zero-thrust-m-s makes it the vehicle's"
                            .to_owned(),
                }
            }
        }
    }

    /// Radius of gyration in pitch over the mean chord.
    fn gyration(&self) -> Sourced {
        let (value, source) = match (self.pitch_inertia_kg_m2, self.actuators) {
            (Some(inertia), _) => (
                (inertia / self.mass_kg).sqrt() / self.chord(),
                "a measured moment of inertia",
            ),
            (None, Actuators::Elevons) => (GYRATION, "a usual radius of gyration"),
            (None, Actuators::Motors | Actuators::Both) => {
                (STANDING_OFF, "a usual radius of gyration")
            }
        };
        Sourced {
            value,
            source: format!("{source}, {value:.2} chords"),
        }
    }

    /// What turns it, and the source of each of its numbers.
    pub(super) fn turning(&self) -> (AuthoritySpec, [(&'static str, String); 9]) {
        let (elevons, motors) = match self.actuators {
            Actuators::Elevons => (1.0, 0.0),
            Actuators::Motors => (0.0, 1.0),
            Actuators::Both => (0.5, 0.5),
        };
        let turn = self.turn_rad_s2;
        let chord = self.chord();
        let downwash = self.downwash();
        let slipstream = elevons * turn;
        let at_elevons = CONTRACTED * downwash.value;
        // Differences are at most the thrust, and what is left of the greatest one.
        let room = 1.0_f64.min(self.thrust_to_weight - 1.0);
        let gyration = self.gyration();
        let inertia = self.mass_kg * (gyration.value * chord).powi(2);
        // Across the flow it is the plate of its polar.
        let across = most_drag(Some(self.aspect_ratio.unwrap_or(RATIO)));
        let zero_thrust = self.zero_thrust();
        let spec = AuthoritySpec {
            constant_rad_s2: 0.0,
            slipstream_rad_s2: slipstream,
            difference_rad_s2: motors * turn / room,
            airflow_rad_m2: slipstream / (IN_SLIPSTREAM * at_elevons * at_elevons),
            wing_moment_rad_m2: self.k_a() * across * AFT * chord / inertia,
            roll_rad_m_s2: AuthoritySpec::default().roll_rad_m_s2,
            surface_reaction_m: elevons * gyration.value.powi(2) / ARM * chord,
            hover_downwash_m_s: downwash.value,
            zero_thrust_speed_m_s: zero_thrust.value,
        };
        let part = match self.actuators {
            Actuators::Both => "half of what was measured: assumed",
            _ => "measured",
        };
        let has = |share: f64, words: &str| match share > 0.0 {
            true => words.to_owned(),
            false => "there are none".to_owned(),
        };
        let sources = [
            (
                "constant_rad_s2",
                "nothing turns it without thrust and air".to_owned(),
            ),
            ("slipstream_rad_s2", has(elevons, part)),
            (
                "difference_rad_s2",
                has(
                    motors,
                    &format!("{part}, over the room that a thrust of the weight leaves"),
                ),
            ),
            (
                "airflow_rad_m2",
                has(elevons, "assumed, of elevons with 0.7 in the slipstream"),
            ),
            (
                "wing_moment_rad_m2",
                format!("assumed, of a plate with {}", gyration.source),
            ),
            (
                "roll_rad_m_s2",
                "not known: full authority about the nose".to_owned(),
            ),
            (
                "surface_reaction_m",
                has(
                    elevons,
                    "assumed, of elevons that act a quarter of the chord behind the centre of mass",
                ),
            ),
            ("hover_downwash_m_s", downwash.source),
            ("zero_thrust_speed_m_s", zero_thrust.source),
        ];
        (spec, sources)
    }

    /// Mean chord \[m\]; of an aspect ratio that is not known, that of 6.
    pub(super) fn chord(&self) -> f64 {
        (self.wing_m2 / self.aspect_ratio.unwrap_or(RATIO)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Known;

    fn facts(change: impl Fn(&mut Known)) -> Facts {
        let mut known = Known::tail_sitter();
        change(&mut known);
        known.facts().unwrap()
    }

    /// Whatever turns it, in hover it is what was measured, before the parts that flights count on.
    #[test]
    fn in_hover_it_turns_as_measured() {
        for actuators in [Actuators::Elevons, Actuators::Motors, Actuators::Both] {
            let facts = facts(|known| known.actuators = Some(actuators));
            let (spec, _) = facts.turning();
            let room = 1.0_f64.min(facts.thrust_to_weight - 1.0);
            let hover = spec.slipstream_rad_s2 + room * spec.difference_rad_s2;
            assert!((hover - facts.turn_rad_s2).abs() < 1e-9, "{actuators:?}");
        }
    }

    /// What the strips of a vehicle file have, and what the rules make of what a person knows of it.
    fn both(vehicle: &str, actuators: Actuators) -> [AuthoritySpec; 2] {
        let (facts, authority) = person_and_strips(vehicle, actuators);
        [facts.turning().0, authority]
    }

    /// What a person knows of a vehicle file, and what its strips and propellers have.
    fn person_and_strips(vehicle: &str, actuators: Actuators) -> (Facts, AuthoritySpec) {
        use alula_sim::experiment::Document;
        use alula_sim::plant::tail_sitter::Belief;
        let mut document = Document::load("tail-sitter-hover").unwrap();
        document
            .assign(&format!("plant.vehicle={vehicle}"))
            .unwrap();
        let experiment = document.checked().unwrap();
        let plant = experiment.tail_sitter.as_ref().unwrap().true_vehicle();
        let belief = Belief::of(&plant);
        let wing_m2 = belief.k_a_kg_m / 0.6125;
        let facts = facts(|known| {
            known.mass_kg = Some(plant.mass_kg);
            known.wing_m2 = Some(wing_m2);
            known.thrust_to_weight = Some(belief.thrust_max_n / (9.81 * plant.mass_kg));
            known.aspect_ratio = Some(plant.wing.aspect_ratio);
            known.cruise_m_s = Some(plant.cruise_speed_m_s);
            known.propeller_m = Some(plant.propellers[0].diameter_m);
            known.pitch_inertia_kg_m2 = Some(plant.inertia_kg_m2[1]);
            known.actuators = Some(actuators);
            known.turn_rad_s2 = Some(belief.authority.slipstream_rad_s2.max(10.0));
        });
        (facts, belief.authority)
    }

    /// Usual propellers are those of the vehicle files, within a quarter.
    #[test]
    fn thrust_ends_where_that_of_usual_propellers_does() {
        for (vehicle, actuators) in [
            ("small-flying-wing", Actuators::Elevons),
            ("mapping", Actuators::Elevons),
            ("biplane", Actuators::Motors),
            ("heavy", Actuators::Both),
        ] {
            let (facts, authority) = person_and_strips(vehicle, actuators);
            let ratio = facts.zero_thrust().value / authority.zero_thrust_speed_m_s;
            assert!((0.75..1.25).contains(&ratio), "{vehicle}: {ratio}");
        }
    }

    /// The rule of the wing's moment meets the strips of the vehicle files within 1.45 where the moment of inertia is measured (a biplane's chord is that of two wings), and within 1.6 where it is assumed. With a force coefficient of 1.8 across the flow, that of infinite span, it was
    /// 1.3 to 1.7 times theirs; with the radius of gyration of a wing alone it was five times that of the biplane.
    #[test]
    fn the_wings_moment_is_that_of_strips() {
        for (vehicle, actuators) in [
            ("small-flying-wing", Actuators::Elevons),
            ("mapping", Actuators::Elevons),
            ("biplane", Actuators::Motors),
            ("heavy", Actuators::Both),
        ] {
            let (mut facts, strips) = person_and_strips(vehicle, actuators);
            for bound in [1.45, 1.6] {
                let ratio = facts.turning().0.wing_moment_rad_m2 / strips.wing_moment_rad_m2;
                assert!((1.0 / bound..bound).contains(&ratio), "{vehicle}: {ratio}");
                facts.pitch_inertia_kg_m2 = None;
            }
        }
    }

    /// The rules meet the strips of `mapping` within a factor of 1.5.
    #[test]
    fn rules_are_near_a_vehicle_in_strips() {
        let [ruled, strips] = both("mapping", Actuators::Elevons);
        for (name, ruled, strips) in [
            ("airflow", ruled.airflow_rad_m2, strips.airflow_rad_m2),
            ("wing", ruled.wing_moment_rad_m2, strips.wing_moment_rad_m2),
            (
                "reaction",
                ruled.surface_reaction_m,
                strips.surface_reaction_m,
            ),
            (
                "downwash",
                ruled.hover_downwash_m_s,
                strips.hover_downwash_m_s,
            ),
        ] {
            let ratio = ruled / strips;
            assert!(
                (1.0 / 1.5..1.5).contains(&ratio),
                "{name}: {ruled} against {strips}"
            );
        }
    }
}
