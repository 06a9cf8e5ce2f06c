//! What turning leaves of braking, of wind and of descents.

use serde::Serialize;

use alula_sim::experiment::{FieldError, VehicleSpec};

/// What a vehicle can do by what turns it: of equilibria, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// Distance \[m\] of a level stop from cruise at angles of attack that are held; none if there is none that brakes. A flight may be shorter, which goes
    /// through those that cannot be held.
    pub level_stop_m: Option<f64>,
    /// Distance and height \[m\] of a stop that climbs: a pull-up at the angle of attack that can be held, in which speed becomes height.
    pub climbing_stop_m: [f64; 2],
    /// Greatest wind \[m/s\] to hover in, up to cruise: at more the wing turns the nose away, and it flies.
    pub hover_wind_m_s: f64,
    /// Fastest vertical descent \[m/s\], tail first.
    pub descent_m_s: f64,
}

/// Part of the angular acceleration in hover that must be left to either side where an attitude is held.
const LEFT: f64 = 0.2;
/// Angles of attack to the thrust line \[rad\] that are looked at, and their step.
const MOST_ALPHA: f64 = 2.0;
const STEP: f64 = 0.005;
/// Steps of speed \[m/s\], and the speed that hover begins at.
const SPEED_STEP: f64 = 0.25;
const HOVER: f64 = 1.0;
/// Greatest deceleration that a stop asks for, and least that is one \[m/s²\]; greatest load factor of a pull-up.
const BRAKES: [f64; 2] = [0.1, 5.0];
const LOAD: f64 = 3.0;

/// Level flight at an angle of attack: what it takes, and how it brakes.
struct Level {
    thrust: f64,
    braking: f64,
}

/// A vehicle whose turning is known.
struct Turned<'a> {
    vehicle: &'a VehicleSpec,
    model: alula_sim::reference::Vehicle,
    core: alula::Vehicle<alula_sim::experiment::Model>,
    thrust: [f64; 2],
    /// Angular acceleration in hover \[rad/s²\].
    in_hover: f64,
}

impl<'a> Turned<'a> {
    fn new(vehicle: &'a VehicleSpec, thrust: [f64; 2]) -> Result<Self, FieldError> {
        let core = vehicle.limited(thrust)?;
        let [_, most] = core.pitch_acceleration(0.0, 0.0, vehicle.weight() as f32);
        Ok(Self {
            vehicle,
            model: vehicle.reference(),
            core,
            thrust,
            in_hover: most.into(),
        })
    }

    /// Level flight at `speed` with the nose `alpha` above it.
    fn level(&self, speed: f64, alpha: f64) -> Level {
        let pressure = self.model.k_a * speed * speed;
        let c = self.model.aerodynamics.at(alpha - self.model.delta);
        let (sin, cos) = alpha.sin_cos();
        let weight = self.vehicle.weight();
        let thrust = (weight - pressure * c.c_l) / sin;
        Level {
            thrust,
            braking: (pressure * c.c_d - thrust * cos) / self.vehicle.mass_kg,
        }
    }

    /// Whether there is this thrust, and the attitude can be held with it and turned to either side.
    fn holds(&self, speed: f64, alpha: f64, thrust: f64) -> bool {
        let (sin, cos) = alpha.sin_cos();
        let falls = self.vehicle.authority.zero_thrust_speed_m_s;
        let left = match falls > 0.0 {
            true => (1.0 - (speed * cos).max(0.0) / falls).max(0.0),
            false => 1.0,
        };
        if !(self.thrust[0]..=self.thrust[1] * left).contains(&thrust) {
            return false;
        }
        let [along, across] = [speed * cos, speed * sin].map(|v| v as f32);
        let [least, most] = self.core.pitch_acceleration(along, across, thrust as f32);
        let reserve = LEFT * self.in_hover;
        f64::from(least) <= -reserve && f64::from(most) >= reserve
    }

    /// Angles of attack from where level flight does not brake on, upwards, with what they take.
    fn levels_from_trim(&self, speed: f64) -> impl Iterator<Item = (f64, Level)> {
        let angles = (1..).map(|n| f64::from(n) * STEP);
        let angles = angles.take_while(|alpha| *alpha < MOST_ALPHA);
        let levels = angles.map(move |alpha| (alpha, self.level(speed, alpha)));
        levels.skip_while(|(_, level)| level.braking < 0.0)
    }

    /// The greatest deceleration of level flight at `speed` \[m/s²\]; none if it can be held at no angle of attack. Where the wing lifts more than the
    /// weight there is none: the guidance crosses that on purpose.
    fn brakes(&self, speed: f64) -> Option<f64> {
        let held = self
            .levels_from_trim(speed)
            .filter(|(alpha, level)| self.holds(speed, *alpha, level.thrust));
        held.map(|(_, level)| level.braking).reduce(f64::max)
    }

    fn level_stop(&self, cruise: f64) -> Option<f64> {
        let steps = ((cruise - HOVER) / SPEED_STEP).ceil() as u32;
        let speeds = (0..steps).map(|n| cruise - f64::from(n) * SPEED_STEP);
        let step = |speed: f64| {
            let brakes = self.brakes(speed)?;
            (brakes >= BRAKES[0]).then(|| speed * SPEED_STEP / brakes.min(BRAKES[1]))
        };
        speeds.map(step).sum()
    }

    /// A pull-up at the greatest load factor that can be held in cruise, with the thrust of the weight.
    fn climbing_stop(&self, cruise: f64) -> [f64; 2] {
        let weight = self.vehicle.weight();
        let pressure = self.model.k_a * cruise * cruise;
        let thrust = weight.min(self.thrust[1]);
        let angles = (1..200).map(|n| f64::from(n) * STEP);
        let held = angles.take_while(|alpha| self.holds(cruise, *alpha, thrust));
        let loads = held.map(|alpha| {
            let c = self.model.aerodynamics.at(alpha - self.model.delta);
            (pressure * c.c_l + thrust * alpha.sin()) / weight
        });
        let load = loads.fold(1.0, f64::max).clamp(1.2, LOAD);
        let square = cruise * cruise / self.vehicle.gravity_m_s2;
        [square / (load - 1.0), 0.5 * square]
    }
}

impl Limits {
    /// Of `vehicle` with `thrust` \[N\] (least, most), whose guidance sinks at `max_sink` [m/s] at most.
    pub fn of(
        vehicle: &VehicleSpec,
        thrust: [f64; 2],
        cruise: f64,
        max_sink: f64,
    ) -> Result<Self, FieldError> {
        let turned = Turned::new(vehicle, thrust)?;
        Ok(Self {
            level_stop_m: turned.level_stop(cruise),
            climbing_stop_m: turned.climbing_stop(cruise),
            hover_wind_m_s: turned.core.hover_wind(cruise as f32).into(),
            descent_m_s: max_sink,
        })
    }

    /// In words: what, and how much.
    pub fn rows(&self, cruise: f64) -> [[String; 2]; 4] {
        let [ahead, up] = self.climbing_stop_m;
        let wind = self.hover_wind_m_s;
        [
            (
                "level braking",
                match self.level_stop_m {
                    Some(stop) => format!("from cruise within about {stop:.0} m"),
                    None => "not at angles of attack that it can hold: behind the stall the wing turns the nose down harder. It turns through them, and climbs meanwhile".to_owned(),
                },
            ),
            (
                "climbing braking",
                format!("from cruise within about {ahead:.0} m, {up:.0} m higher"),
            ),
            (
                "wind to hover in",
                match wind >= cruise {
                    true => format!("{wind:.1} m/s and more"),
                    false => format!("up to {wind:.1} m/s; in more it is driven off, or flies"),
                },
            ),
            (
                "vertical descent",
                format!("at most {:.1} m/s", self.descent_m_s),
            ),
        ]
        .map(|(what, how)| [what.to_owned(), how])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Actuators, Design, Known};

    fn limits(actuators: Actuators, turn: f64) -> Limits {
        let mut known = Known::tail_sitter();
        known.actuators = Some(actuators);
        known.turn_rad_s2 = Some(turn);
        known.propeller_m = Some(0.3);
        Design::new(known.facts().unwrap())
            .unwrap()
            .limits()
            .unwrap()
    }

    /// What turns little holds the nose in little wind. Level, at angles of attack that are held, the drag of a clean wing brakes: from 18 m/s at c_D/c_L g,
    /// some 0.3 m/s² and more, that is half a kilometre at most.
    #[test]
    fn what_turns_little_hovers_in_little_wind() {
        let (little, much) = (
            limits(Actuators::Elevons, 15.0),
            limits(Actuators::Elevons, 60.0),
        );
        assert!(
            little.hover_wind_m_s < much.hover_wind_m_s,
            "{little:?} {much:?}"
        );
        assert!((2.0..14.0).contains(&little.hover_wind_m_s), "{little:?}");
        for stop in [little, much]
            .into_iter()
            .filter_map(|limits| limits.level_stop_m)
        {
            assert!((60.0..600.0).contains(&stop), "{stop}");
        }
        // V²/2g.
        assert!((little.climbing_stop_m[1] - 16.5).abs() < 0.1);
    }
}
