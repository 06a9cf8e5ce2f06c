//! The transition switch, and the person at it.
//!
//! Both autopilots wait for a command to go to cruise or back. Here it is given by a person who knows the plan: cruise, once
//! the reference moves forward and does not brake, if the planned speed is one that the wing carries; otherwise the flight
//! stays a multicopter's. Hover, once the reference brakes or has stopped, and the airspeed has fallen below what the user
//! wants to begin the back transition at; until then the aeroplane slows down.

use super::Measured;
use crate::experiment::table::{Range::Finite, table};

table! {
    /// `[….switch]`.
    pub struct SwitchSpec {
        cruise_m_s: f64, Finite, "Forward speed of the plan \\[m/s\\].";
        front_above_m_s: f64, Finite, "Forward reference speed above which cruise is commanded \\[m/s\\].";
        back_below_m_s: f64, Finite, "Airspeed below which the back transition is commanded \\[m/s\\].";
    }
}

/// A reference that slows down by more than this \[m/s²\] brakes.
const BRAKING: f64 = 0.05;

/// The switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    spec: SwitchSpec,
    /// Whether the plan is flown as an aeroplane.
    planned: bool,
    cruise: bool,
}

impl Switch {
    /// The switch of a vehicle whose wing is to carry it from `least` \[m/s\] on.
    pub fn new(spec: SwitchSpec, least: f64) -> Self {
        Self {
            spec,
            planned: spec.cruise_m_s >= least,
            cruise: false,
        }
    }

    /// Whether cruise is commanded.
    pub fn update(&mut self, measured: &Measured) -> bool {
        let moving = measured.reference.y > self.spec.front_above_m_s;
        let braking = measured.acceleration.y < -BRAKING;
        if self.cruise {
            let slow = measured.airspeed < self.spec.back_below_m_s;
            self.cruise = !((braking || !moving) && slow);
        } else {
            self.cruise = self.planned && moving && !braking;
        }
        self.cruise
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::measured::tests::steady;
    use super::*;
    use crate::reference::Vector;

    pub(crate) const SPEC: SwitchSpec = SwitchSpec {
        cruise_m_s: 20.0,
        front_above_m_s: 1.0,
        back_below_m_s: 16.0,
    };

    fn at(reference: f64, acceleration: f64, airspeed: f64) -> Measured {
        Measured {
            reference: Vector::new(0.0, reference),
            acceleration: Vector::new(0.0, acceleration),
            airspeed,
            ..steady([0.0, airspeed], 0.0)
        }
    }

    #[test]
    fn cruise_waits_for_the_reference_and_hover_for_the_airspeed() {
        let mut switch = Switch::new(SPEC, 16.5);
        assert!(!switch.update(&at(0.9, 2.0, 0.5)));
        assert!(!switch.update(&at(5.0, -2.0, 5.0)), "braking");
        assert!(switch.update(&at(1.1, 2.0, 0.5)));
        assert!(switch.update(&at(20.0, 0.0, 20.0)));
        assert!(switch.update(&at(18.0, -2.0, 19.0)), "too fast");
        // The reference has stopped; the vehicle still slows down.
        assert!(switch.update(&at(0.0, 0.0, 16.1)));
        assert!(!switch.update(&at(0.0, 0.0, 15.9)));
        assert!(!switch.update(&at(0.0, 0.0, 17.0)), "once commanded");
    }

    #[test]
    fn a_plan_too_slow_for_the_wing_is_flown_in_hover() {
        let spec = SwitchSpec {
            cruise_m_s: 14.5,
            ..SPEC
        };
        let mut switch = Switch::new(spec, 16.5);
        assert!(!switch.update(&at(14.5, 0.0, 14.5)));
    }
}
