//! The way out of a fall, for a vehicle whose surfaces need the slipstream.
//!
//! In a fall the air turns such a vehicle, and no plan that turns it elsewhere is followed. A plan has no thrust, either, while the nose is below the
//! horizon, and with the thrust goes the slipstream. So while it falls it flies by no plan: at full thrust the nose goes to the air velocity, which the air helps,
//! with the wing across the vertical plane of that velocity, belly or back down, whichever is nearer. With airflow along the nose it pulls up,
//! until it climbs steeply or is slow. There the reference model begins anew.
//!
//! It shares no mechanism with the planner. Plans are flown in the plane of flight by a model that obeys, and a fall has neither.

use crate::aero::Aerodynamics;
use crate::math;
use crate::ned::Ned;
use crate::spatial::{Body, Orientation};
use crate::vehicle::Vehicle;

/// What [`GuidanceState::started`](super::GuidanceState) says: the reference model has begun; the vehicle falls.
pub(super) const BEGUN: u8 = 1;
pub(super) const FALLING: u8 = 2;

/// Attitude behind the model's \[rad\] from which on a vehicle that sinks falls.
const BEHIND: f32 = 0.3;
/// Speeds in multiples of that at which the wing carries the weight: a sink beyond the reference's from which on it falls, the airspeed along the nose from
/// which on it pulls up, and the airspeed below which it is slow.
const SINK: f32 = 0.7;
const GATHERED: f32 = 0.5;
const SLOW: f32 = 0.35;
/// Cosine of the angle of attack up to which it pulls up; tangent and cosine of the angle of attack of 25° that is asked for.
const ALONG: f32 = 0.85;
const PULL: f32 = 0.466;
const PULLED: f32 = 0.906;
/// Sine of the climb that is steep.
const STEEP: f32 = 0.9;
/// Rate of the turn per angle [1/s].
const GAIN: f32 = 4.0;
/// Speed that has no direction [m/s].
const SLOWEST: f32 = 1e-3;

/// When a vehicle falls, and what it does then.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Fall {
    /// Speed at which the wing carries [m/s]; infinite for a vehicle whose surfaces do not need the slipstream.
    carried: f32,
}

impl Fall {
    /// The falls of `vehicle`.
    pub fn new<A: Aerodynamics>(vehicle: &Vehicle<A>) -> Self {
        Self {
            carried: if vehicle.authority().slipstream > 0.0 {
                vehicle.stall_speed()
            } else {
                f32::INFINITY
            },
        }
    }

    /// What has begun, after what had `started`, at a `sink` beyond the reference's [m/s], with the model's attitude this far `ahead` \[rad\], and an air
    /// velocity [m/s].
    #[inline(always)]
    pub fn next(&self, started: u8, sink: f32, ahead: f32, air: Ned) -> u8 {
        if started == BEGUN && sink > SINK * self.carried && ahead.abs() > BEHIND {
            FALLING
        } else if started == FALLING && self.is_over(air) {
            BEGUN
        } else {
            started
        }
    }

    #[cold]
    #[inline(never)]
    fn is_over(&self, air: Ned) -> bool {
        let (speed, slow) = (air.norm_squared(), SLOW * self.carried);
        speed < slow * slow || (air.down < 0.0 && air.down * air.down > STEEP * STEEP * speed)
    }

    /// The rates that it turns with [rad/s], at an air velocity [m/s].
    #[cold]
    #[inline(never)]
    pub fn rates(&self, orientation: &Orientation, air: Ned) -> Body {
        let across = Ned::new(-air.east, air.north, 0.0);
        // Falling straight there is no vertical plane, and the nose alone is turned.
        let length = math::sqrt(across.norm_squared()) + SLOWEST;
        let length = if across.dot(orientation.w()) < 0.0 {
            -length
        } else {
            length
        };
        let right = across * (1.0 / length);
        let speed = math::sqrt(air.norm_squared()) + SLOWEST;
        let along = air * (1.0 / speed);
        let nose = -orientation.i().dot(air);
        let nose = if nose > GATHERED * self.carried && nose > ALONG * speed {
            let lift = along.cross(right) * -PULL.copysign(length);
            (along + lift) * PULLED
        } else {
            along
        };
        orientation.rotation_to(-nose, nose.cross(right), right) * GAIN
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::frame::Attitude;
    use crate::vehicle::VehicleParameters;

    fn fall(slipstream: f32) -> Fall {
        let p = VehicleParameters {
            authority: 0.0,
            authority_slipstream: slipstream,
            authority_difference: 20.0,
            ..VehicleParameters::PAPER
        };
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Fall::new(&Vehicle::new(p, model).unwrap())
    }

    /// A sink that nobody asked for begins it, where the attitude does not follow. It ends in a steep climb, or slow; what has not begun does not fall.
    #[test]
    fn a_fall_begins_with_a_sink_and_ends_in_a_climb() {
        let fall = fall(30.0);
        let carried = fall.carried;
        assert!(carried > 5.0 && carried < 20.0);
        let down = |down: f32| Ned::new(0.0, 0.0, down * carried);
        assert_eq!(fall.next(BEGUN, 0.69 * carried, 0.4, down(0.69)), BEGUN);
        assert_eq!(fall.next(BEGUN, 0.71 * carried, -0.4, down(0.71)), FALLING);
        // Who follows a plan flies by it.
        assert_eq!(fall.next(BEGUN, 0.71 * carried, 0.2, down(0.71)), BEGUN);
        assert_eq!(fall.next(0, 0.71 * carried, 0.4, down(0.71)), 0);
        for (air, over) in [
            (down(0.36), false),
            (down(0.34), true),
            (Ned::new(carried, 0.0, -carried), false),
            (Ned::new(0.3 * carried, 0.0, -carried), true),
            (Ned::new(0.3 * carried, 0.0, carried), false),
        ] {
            let expected = if over { BEGUN } else { FALLING };
            assert_eq!(fall.next(FALLING, 0.0, 0.0, air), expected, "{air:?}");
        }
    }

    /// Differences of thrust turn a vehicle in any air, and not at full thrust. Full authority needs neither.
    #[test]
    fn who_needs_no_slipstream_does_not_fall() {
        let fall = fall(0.0);
        assert_eq!(fall.next(BEGUN, 1e6, 1.0, Ned::new(0.0, 0.0, 1e6)), BEGUN);
        assert_eq!(fall.next(FALLING, 0.0, 0.0, Ned::ZERO), BEGUN);
    }

    /// Nose level to the north, belly or back down. Falling straight, the nose goes down by the shorter way; with airflow along it, it is pulled up.
    #[test]
    fn the_nose_goes_to_the_air_and_then_up() {
        let fall = fall(30.0);
        let upright = Orientation::in_plane(Attitude::from_angle(-1.57));
        for (air, sign) in [
            (Ned::new(1.0, 0.0, 15.0), -1.0),
            (Ned::new(20.0, 0.0, 2.0), 1.0),
        ] {
            let turn = fall.rates(&upright, air);
            assert!(
                turn.w * sign > 0.2 && turn.i.abs() + turn.j.abs() < 1e-3,
                "{turn:?}"
            );
            // On its back, flying south with the belly up, the same by the other sign.
            let back = Orientation::in_plane(Attitude::from_angle(1.57));
            let turn = fall.rates(&back, Ned::new(-air.north, 0.0, air.down));
            assert!(
                turn.w * sign < -0.2 && turn.i.abs() + turn.j.abs() < 1e-3,
                "{turn:?}"
            );
        }
    }
}
