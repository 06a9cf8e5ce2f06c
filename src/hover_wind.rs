//! The greatest wind that a vehicle hovers in with its wing across it.

use crate::aero::Aerodynamics;
use crate::air::AngleOfAttack;
use crate::math;
use crate::vehicle::Vehicle;

/// Winds that are looked at, and angles from the air velocity up to the nose, in degrees.
const WINDS: u8 = 32;
const ANGLES: u8 = 115;
const DEGREE: f32 = 1.745_329_3e-2;
/// Part of the angular acceleration in hover that must be left to either side: for turns and gusts, and for what the belief gets wrong. With a fifth
/// elevon wings on an independent plant, told 3 to 20 % wrong, nodded in the wind that this gave as held, from 0.65 of it on.
const SPARE: f32 = 0.5;

impl<A: Aerodynamics> Vehicle<A> {
    /// Greatest wind [m/s], up to `most`, to hover in with the wing across it: its trim takes a thrust that there is, and what turns it in pitch holds it
    /// there, with half of what there is in hover to spare on either side. In more the wing turns the nose away, and the vehicle is driven off.
    pub fn hover_wind(&self, most: f32) -> f32 {
        let mut held = 0.0;
        for n in 1..=WINDS {
            let wind = most * (f32::from(n) / f32::from(WINDS));
            if !self.hovers_in(wind) {
                break;
            }
            held = wind;
        }
        held
    }

    /// Angular acceleration in pitch in hover [rad/s²].
    pub(crate) fn turning_in_hover(&self) -> f32 {
        (self.authority()).in_hover(self.weight(), self.thrust_max())
    }

    /// Airspeed across the wing [m/s] with which half of what turns the vehicle in hover is to spare.
    pub(crate) fn airspeed_held_in_hover(&self) -> f32 {
        (self.authority()).airspeed_held((1.0 - SPARE) * self.turning_in_hover())
    }

    /// Whether the trim in a `wind` [m/s] is held. It leans into the wind: the first angle at which the air is not outrun, from the air velocity up.
    fn hovers_in(&self, wind: f32) -> bool {
        let (weight, pressure) = (self.weight(), self.k_a() * wind * wind);
        for n in 1..=ANGLES {
            let nose = f32::from(n) * DEGREE;
            let (sin, cos) = math::sin_cos(nose);
            let alpha = AngleOfAttack::from_radians(nose - self.thrust_line().delta());
            let c = self.model().coefficients(alpha);
            let thrust = (weight - pressure * c.c_l) / sin;
            if pressure * c.c_d < thrust * cos {
                continue;
            }
            let (along, across) = (wind * cos, wind * sin);
            let available = self.thrust_max() * self.propeller().available(along);
            let [_, in_hover] = self.pitch_acceleration(0.0, 0.0, weight);
            let [least, most] = self.pitch_acceleration(along, across, thrust);
            let spare = SPARE * in_hover;
            return (self.thrust_min()..=available).contains(&thrust)
                && least <= -spare
                && most >= spare;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::parameters::Parameters;
    use crate::vehicle::VehicleParameters;

    fn wind(p: VehicleParameters) -> f32 {
        let wing = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Vehicle::new(p, wing).unwrap().hover_wind(16.0)
    }

    /// 20 rad/s² in hover, and drag that leans it by a few degrees. The wing takes 0.5 w²: half is left at √(0.5 · 20/0.5) = 4.47 m/s, which lies between two
    /// of the winds that are looked at.
    #[test]
    fn the_wing_takes_what_turns_it() {
        let p = VehicleParameters {
            authority: 20.0,
            wing_moment: 0.5,
            ..VehicleParameters::DEFAULT
                .mass(2.0)
                .k_a(0.02)
                .thrust_max(40.0)
        };
        let held = wind(p);
        assert_eq!(held, 4.0);
        // Twice the wind where there is four times as much to turn it.
        let more = wind(p.authority(80.0));
        assert!((more - 2.0 * 4.47).abs() <= 0.5, "{more}");
        assert_eq!(wind(p.authority(0.0)), 0.0);
    }

    /// Fully actuated, thrust is what ends it: a vehicle that barely lifts itself hovers in no wind in which it leans; with thrust to spare in all.
    #[test]
    fn a_lean_takes_thrust() {
        let p = VehicleParameters::DEFAULT.mass(2.0).k_a(0.1);
        assert!(wind(p.thrust_max(18.0)) < wind(p.thrust_max(40.0)));
        assert_eq!(wind(p.thrust_max(80.0)), 16.0);
    }
}
