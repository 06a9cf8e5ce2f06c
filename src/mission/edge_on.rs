//! The heading in hover, by the wind: its wing along it. Across the wind a wing leans into it.

use super::ability::Ability;
use super::segment::{level, right_of};
use crate::math;
use crate::ned::Ned;
use crate::spatial::{Heading, Orientation};

/// Wind from which on a vehicle in hover turns its wing along it [m/s].
const LEAST: f32 = 0.5;
/// Sine of the angle by which the air may turn the wing: there the heading makes up for all that the air has to say. With a half and a quarter of it
/// as many land in wind, but they yaw in a light one, too.
const TURNED: f32 = 0.02;

/// The heading with the wing along the `wind`, of both the one that is nearer.
pub(super) fn edge_on(wind: Ned, orientation: &Orientation, ability: &Ability) -> Heading {
    let strength = level(wind);
    if strength < LEAST {
        return Heading::FREE;
    }
    let (with, across) = (wind * (1.0 / strength), right_of(wind) * (1.0 / strength));
    let belly = Ned {
        down: 0.0,
        ..orientation.j()
    };
    let (side, turned) = (across.dot(belly), with.dot(belly));
    // The air turns the belly into the wind: against that the heading is asked for beyond. A right angle from the belly it turns it most.
    let against = ability.air_over_heading(strength) * (turned / TURNED);
    let beyond = across * 1f32.copysign(side) - with * against;
    let behind = math::min(belly.dot(beyond), 0.0);
    let square = math::max(belly.norm_squared(), 1e-3);
    Heading::along(beyond - belly * (behind / square))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::vehicle::{Vehicle, VehicleParameters};

    /// The heading of a vehicle in hover whose belly is this far from north to the east \[rad\], less that, in a wind from the north [m/s].
    fn asked(belly: f32, wind: f32) -> f32 {
        let wing = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let ability = Ability::new(&Vehicle::new(VehicleParameters::PAPER, wing).unwrap());
        let (sin, cos) = math::sin_cos(belly);
        let nose_up =
            Orientation::from_directions(Ned::new(0.0, 0.0, -1.0), Ned::new(cos, sin, 0.0));
        let wind = Ned::new(-wind, 0.0, 0.0);
        let heading = edge_on(wind, &nose_up.unwrap(), &ability);
        super::super::segment::wrap(heading.angle().unwrap() - belly)
    }

    /// A belly across the wind stays there, on either side. One that the wind has turned is turned back: harder in more wind, and by no more than a
    /// right angle.
    #[test]
    fn a_wing_is_turned_back_along_the_wind() {
        let right_angle = 0.5 * math::PI;
        assert!(asked(right_angle, 3.0).abs() < 1e-3 && asked(-right_angle, 3.0).abs() < 1e-3);
        let (light, fresh) = (
            asked(right_angle - 0.05, 1.0),
            asked(right_angle - 0.05, 4.0),
        );
        assert!(light > 0.04 && fresh > 4.0 * light, "{light} {fresh}");
        let far = asked(0.6, 5.0);
        assert!((far - right_angle).abs() < 1e-3, "{far}");
        assert!(asked(-0.6, 5.0) < -1.5);
    }
}
