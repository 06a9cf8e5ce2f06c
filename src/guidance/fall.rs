//! The way out of a fall, and of the stall where plans do not leave it, for a vehicle whose surfaces need the slipstream.
//!
//! In a fall the air turns such a vehicle, and no plan that turns it elsewhere is followed. A plan has no thrust, either, while the nose is below the
//! horizon, and with the thrust goes the slipstream. So while it falls it flies by no plan: at full thrust the nose goes to the air velocity, which the air helps,
//! with the wing across the vertical plane of that velocity, belly or back down, whichever is nearer. With airflow along the nose it pulls up,
//! until it climbs steeply, is slow, or has its nose up. There the reference model begins anew.
//!
//! At the stall the wing's moment takes all that the surfaces give. Who brakes there does not turn up, and each climb of a plan is taken back for the height.
//! Who still flies on its wing, long after it was asked to hover, gathers speed in level flight at full thrust, and pulls up as from a fall.
//! So does who is held there in cruise, the pitch rate at its limit and not had: it flies on once its wing carries again. A nose that goes to and fro is not
//! held.
//!
//! It shares no mechanism with the planner. Plans are flown in the plane of flight by a model that obeys, and neither has one.

use super::MAX_STEP;
use crate::aero::Aerodynamics;
use crate::math;
use crate::ned::Ned;
use crate::spatial::{Body, Orientation};
use crate::vehicle::Vehicle;

/// What [`GuidanceState::started`](super::GuidanceState) says: the reference model has begun; the vehicle falls, or pulls up; it gathers speed for that.
pub(super) const BEGUN: u8 = 1;
pub(super) const FALLING: u8 = 2;
pub(super) const GATHERING: u8 = 3;

/// Attitude behind the model's \[rad\] from which on a vehicle that sinks falls.
const BEHIND: f32 = 0.3;
// Speeds in multiples of that at which the wing carries the weight.
/// Sink beyond the reference's from which on it falls.
const SINK: f32 = 0.7;
/// Airspeed along the nose from which on it pulls up.
const GATHERED: f32 = 0.5;
/// Airspeed below which it is slow.
const SLOW: f32 = 0.35;
/// Airspeed from which on it flies on its wing, and greatest airspeed asked for of a hover.
const ON_WING: f32 = 0.6;
const HOVER: f32 = 0.4;
/// Airspeed along the nose to which it gathers speed.
const FAST: f32 = 1.3;
/// Airspeed below which a nose that is up ends a pull-up.
const LIFTED: f32 = 1.1;
/// Time \[s\] on its wing, asked to hover, after which it gathers speed.
const PATIENCE: f32 = 8.0;
/// How much faster that time runs while the attitude is behind the model's or the pitch rate stands at its limit, whatever is asked for: who is still on
/// its wing then is held by the stall. Where neither is, nor a hover asked for, it begins anew: a nose that goes to and fro is had in between.
const HELD: f32 = 3.0;
/// Such time \[s\] from which on the surfaces are taken to stand at their stop.
const STOPPED: f32 = 3.0;
/// Cosine of the angle of attack at which a wing is no longer stalled, 12°.
const ATTACHED: f32 = 0.978;
/// Cosine of the greatest angle of attack at which it pulls up.
const ALONG: f32 = 0.85;
/// Tangent of the angle of attack of a pull-up, 18°: wings have their greatest lift there.
const PULL: f32 = 0.325;
/// Tangent of the angle of attack of level flight, 8°.
const LEVEL: f32 = 0.14;
/// Sine of the flight path that is steep, and of the nose that is up.
const STEEP: f32 = 0.9;
const UP: f32 = 0.65;
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

/// What a step knows of a fall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FallSample {
    /// Sink beyond the reference's [m/s].
    pub sink: f32,
    /// How far the model's attitude is ahead \[rad\].
    pub ahead: f32,
    /// Whether the pitch rate stands at its limit.
    pub held: bool,
    /// Air velocity, and the one that is asked for [m/s].
    pub air: Ned,
    pub asked: Ned,
    /// The unit vector to the nose.
    pub nose: Ned,
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

    /// Whether a step can have left this time of [`next`](Self::next) \[s\].
    #[inline(always)]
    pub fn is_sound(&self, flown_on: f32) -> bool {
        (0.0..=PATIENCE + HELD * MAX_STEP).contains(&flown_on)
    }

    /// Whether, after what had `started` and so long `flown_on` \[s\], the stall holds the vehicle, with its surfaces at their stop.
    #[inline(always)]
    pub fn is_held(&self, started: u8, flown_on: f32) -> bool {
        started == GATHERING || flown_on > STOPPED
    }

    /// What has begun, after what had `started`, and how long it has `flown_on` \[s\] on its wing, asked to hover.
    #[inline(always)]
    pub fn next(&self, (started, flown_on): (u8, f32), sample: &FallSample, dt: f32) -> (u8, f32) {
        if started == BEGUN {
            if sample.sink > SINK * self.carried && sample.ahead.abs() > BEHIND {
                return (FALLING, 0.0);
            }
            let on_wing = ON_WING * self.carried;
            if sample.air.norm_squared() < on_wing * on_wing {
                return (BEGUN, 0.0);
            }
            if flown_on > PATIENCE {
                return (GATHERING, 0.0);
            }
            let next = if sample.held || sample.ahead.abs() > BEHIND {
                flown_on + HELD * dt
            } else if self.is_hover(sample) {
                flown_on + dt
            } else {
                0.0
            };
            return (BEGUN, next);
        }
        if started >= FALLING {
            return (self.pulled_up(started, sample), 0.0);
        }
        (started, 0.0)
    }

    /// The same of what is no flight by plans.
    #[cold]
    #[inline(never)]
    fn pulled_up(&self, started: u8, sample: &FallSample) -> u8 {
        let FallSample { air, nose, .. } = sample;
        let below = |speed: f32, part: f32| {
            let most = part * self.carried;
            speed < most * most
        };
        let speed = air.norm_squared();
        let steep = air.down < 0.0 && air.down * air.down > STEEP * STEEP * speed;
        if steep || below(speed, SLOW) || (nose.down < -UP && below(speed, LIFTED)) {
            BEGUN
        } else if nose.dot(*air) > FAST * self.carried {
            match (started, self.is_hover(sample)) {
                // Who was asked to fly on does, once the wing carries again.
                (GATHERING, false) if nose.dot(*air) > ATTACHED * math::sqrt(speed) => BEGUN,
                (GATHERING, false) => started,
                _ => FALLING,
            }
        } else {
            started
        }
    }

    /// Whether a hover is asked for.
    #[inline(always)]
    fn is_hover(&self, sample: &FallSample) -> bool {
        let most = HOVER * self.carried;
        sample.asked.norm_squared() <= most * most
    }

    /// The rates that it turns with [rad/s], after what had `started`, at an air velocity [m/s].
    #[cold]
    #[inline(never)]
    pub fn rates(&self, started: u8, orientation: &Orientation, air: Ned) -> Body {
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
            let pull = if started == GATHERING {
                // Who climbs gathers no speed.
                math::clamp(LEVEL + along.down, 0.0, 2.0 * LEVEL)
            } else {
                PULL
            };
            let lift = along.cross(right) * -pull.copysign(length);
            (along + lift) * (1.0 / math::sqrt(1.0 + pull * pull))
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

    const DT: f32 = 0.01;

    /// With the nose along the air, asked for a hover.
    fn sample(sink: f32, ahead: f32, air: Ned) -> FallSample {
        FallSample {
            sink,
            ahead,
            held: false,
            air,
            asked: Ned::ZERO,
            nose: air * (1.0 / (math::sqrt(air.norm_squared()) + SLOWEST)),
        }
    }

    fn next(fall: &Fall, started: u8, sample: &FallSample) -> u8 {
        fall.next((started, 0.0), sample, DT).0
    }

    /// A sink that nobody asked for begins it, where the attitude does not follow. It ends in a steep climb, or slow; what has not begun does not fall.
    #[test]
    fn a_fall_begins_with_a_sink_and_ends_in_a_climb() {
        let fall = fall(30.0);
        let carried = fall.carried;
        assert!(carried > 5.0 && carried < 20.0);
        let falling = |sink: f32, ahead: f32| {
            sample(sink * carried, ahead, Ned::new(0.0, 0.0, sink * carried))
        };
        assert_eq!(next(&fall, BEGUN, &falling(0.69, 0.4)), BEGUN);
        assert_eq!(next(&fall, BEGUN, &falling(0.71, -0.4)), FALLING);
        // Who follows a plan flies by it.
        assert_eq!(next(&fall, BEGUN, &falling(0.71, 0.2)), BEGUN);
        assert_eq!(next(&fall, 0, &falling(0.71, 0.4)), 0);
        for (north, down, over) in [
            (0.0, 0.36, false),
            (0.0, 0.34, true),
            (1.0, -1.0, false),
            (0.3, -1.0, true),
            (0.3, 1.0, false),
            // A nose that is up by 41° ends it where the wing has nothing more to say.
            (0.8, -0.7, true),
            (0.8, -0.66, false),
        ] {
            let air = Ned::new(north, 0.0, down) * carried;
            let expected = if over { BEGUN } else { FALLING };
            assert_eq!(
                next(&fall, FALLING, &sample(0.0, 0.0, air)),
                expected,
                "{air:?}"
            );
        }
    }

    /// Who is asked for a hover and flies on at its stall for longer than a stop takes gathers speed, and then pulls up. So does who is held there, the rate
    /// at its limit, sooner and whatever is asked for; who is asked for speed flies on.
    #[test]
    fn who_does_not_stop_gathers_speed() {
        let fall = fall(30.0);
        let carried = fall.carried;
        let forward = |part: f32| Ned::new(part * carried, 0.0, 0.0);
        let stalled = sample(0.0, 0.0, forward(1.0));
        let fast = FallSample {
            asked: forward(0.41),
            ..stalled
        };
        let fly = |from: (u8, f32), sample: &FallSample, seconds: f32| {
            (0..(seconds / DT) as usize).fold(from, |at, _| {
                let at = fall.next(at, sample, DT);
                assert!(fall.is_sound(at.1));
                at
            })
        };
        let late = fly((BEGUN, 0.0), &stalled, 7.9);
        assert_eq!(late.0, BEGUN);
        assert_eq!(fly(late, &stalled, 0.2).0, GATHERING);
        // Who is slow is not on its wing; who is asked to fly on forgets.
        let slow = sample(0.0, 0.0, forward(0.59));
        assert_eq!(fly(late, &slow, DT), (BEGUN, 0.0));
        assert_eq!(fly(late, &fast, DT), (BEGUN, 0.0));
        // A rate that stands at its limit is not had, nor an attitude that is far ahead, whatever is asked for.
        for other in [stalled, fast] {
            let behind = FallSample {
                ahead: -0.31,
                ..other
            };
            let held = FallSample {
                held: true,
                ..other
            };
            for sample in [behind, held] {
                assert_eq!(fly((BEGUN, 0.0), &sample, 2.6).0, BEGUN);
                assert_eq!(fly((BEGUN, 0.0), &sample, 2.8).0, GATHERING);
            }
        }
        let turns = FallSample {
            ahead: 0.29,
            ..fast
        };
        assert_eq!(fly((BEGUN, 0.0), &turns, 20.0), (BEGUN, 0.0));
        // Nor is a nose that goes to and fro, and is had in between, unless a hover is asked for.
        for (asked, expected) in [(fast, BEGUN), (stalled, GATHERING)] {
            let swung = (0..20).fold((BEGUN, 0.0), |at, n| {
                let ahead = if n % 2 == 0 { 0.5 } else { -0.5 };
                let swings = FallSample { ahead, ..asked };
                fly(fly(at, &asked, DT), &swings, 0.5)
            });
            assert_eq!(swung.0, expected);
        }
        for (speed, expected) in [(1.29, GATHERING), (1.31, FALLING), (0.3, BEGUN)] {
            let gathering = sample(0.0, 0.0, forward(speed));
            assert_eq!(next(&fall, GATHERING, &gathering), expected);
        }
        // Who was asked to fly on does, once its wing is no longer stalled.
        for (alpha_deg, expected) in [(13.0_f32, GATHERING), (11.0, BEGUN)] {
            let (sin, cos) = math::sin_cos(alpha_deg.to_radians());
            let gathering = FallSample {
                nose: Ned::new(cos, 0.0, -sin),
                air: forward(1.5),
                ..fast
            };
            assert_eq!(next(&fall, GATHERING, &gathering), expected);
            assert_eq!(next(&fall, FALLING, &gathering), FALLING);
        }
        for time in [f32::NAN, -0.1, 9.0] {
            assert!(!fall.is_sound(time));
        }
    }

    /// Differences of thrust turn a vehicle in any air, and not at full thrust. Full authority needs neither.
    #[test]
    fn who_needs_no_slipstream_does_not_fall() {
        let fall = fall(0.0);
        let down = Ned::new(0.0, 0.0, 1e6);
        let late = fall.next((BEGUN, PATIENCE), &sample(1e6, 1.0, down), DT);
        assert_eq!(late, (BEGUN, 0.0));
        assert_eq!(next(&fall, FALLING, &sample(0.0, 0.0, Ned::ZERO)), BEGUN);
    }

    /// Nose level to the north, belly or back down. Falling straight, the nose goes down by the shorter way; with airflow along it, it is pulled up, and by a
    /// less than half of that to gather speed. In a climb that has the nose go to the air.
    #[test]
    fn the_nose_goes_to_the_air_and_then_up() {
        let fall = fall(30.0);
        let upright = Orientation::in_plane(Attitude::from_angle(-1.57));
        let back = Orientation::in_plane(Attitude::from_angle(1.57));
        for (started, air, expected) in [
            (FALLING, Ned::new(1.0, 0.0, 15.0), -1.5),
            (FALLING, Ned::new(20.0, 0.0, 0.0), 0.314),
            (GATHERING, Ned::new(20.0, 0.0, 0.0), 0.139),
            (GATHERING, Ned::new(20.0, 0.0, -3.0), 0.149),
            (GATHERING, Ned::new(20.0, 0.0, 2.0), 0.134),
        ] {
            // On its back, flying south with the belly up, the same by the other sign.
            let turns = [
                (upright, air, 1.0),
                (back, Ned::new(-air.north, 0.0, air.down), -1.0),
            ];
            for (orientation, air, sign) in turns {
                let turn = fall.rates(started, &orientation, air);
                assert!(turn.i.abs() + turn.j.abs() < 2e-3, "{turn:?}");
                // 0.01 rad: the nose is not quite level. A large turn is of its sine.
                let angle = math::clamp(expected, -1.0, 1.0);
                assert!(
                    (turn.w * sign / GAIN - angle).abs() < 0.01
                        || (angle == -1.0 && turn.w * sign < -2.0),
                    "{started} {air:?} {turn:?}"
                );
            }
        }
    }
}
