//! Authority in pitch: how fast the rate of the attitude can change.
//!
//! With u the airspeed along the nose, w across it towards the belly, V = |v_a|, T_b the thrust whose slipstream is blown back tail first and
//! α_s the stall, the actuators give
//!
//! `constant + slipstream (T − T_b) + difference min(T, T_max − T) + airflow (u² − 1.9 w²)`, the last for u > 0, each with the share of its
//! parameter that a flight may count on,
//!
//! `T_b = reversed u²` for u < 0, and the wing takes `w wing (0.65 V + 0.35 |w|) w⁴/(w⁴ + (V sin α_s)⁴)`, tail first `w wing V`: it turns the
//! nose to the air velocity.

use crate::math;

/// What surfaces and differences of thrust can do, and what the wing does against them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Authority {
    /// Without thrust and airflow [rad/s²].
    pub constant: f32,
    /// Of surfaces in the slipstream, per thrust [rad/s² N].
    pub slipstream: f32,
    /// Of a difference of thrust, per difference [rad/s² N].
    pub difference: f32,
    /// Of surfaces in the airflow, per squared airspeed along the nose [rad/m²].
    pub airflow: f32,
    /// Of the wing, per squared airspeed [rad/m²].
    pub wing: f32,
    /// Sine of the angle of attack at which the wing stalls.
    pub stall: f32,
    /// Thrust \[N\] whose slipstream is gone at 1 m/s tail first, per squared speed [kg/m]; 0 if it never is.
    pub reversed: f32,
}

/// Squared airspeed across the wing that takes the airflow's authority away, over that along the nose: surfaces stall with the wing, at 36°.
const STALLED: f32 = 1.9;

/// Moment of a stalled wing over the sine of a small angle of attack, in multiples of that across the flow. Fitted to the strips of the vehicle
/// files, which it meets within 0.12.
const PLATE: f32 = 0.65;

/// Speed tail first at which surfaces in the slipstream have no effect, over the speed that the propellers give the air.
pub(crate) const GONE: f32 = 0.6;

/// Part of what is measured at rest that a flight may count on: the air across the nose blows a slipstream aside, and other axes need some of
/// every actuator.
pub(crate) const IN_SLIPSTREAM: f32 = 0.7;
pub(crate) const SHARE: f32 = 0.8;

/// Part of the rate about the nose at the stop that a flight may count on. Motors that turn the vehicle with all that they have do so in pitch, too, as soon
/// as they yaw: in level turns a biplane then was off its height by 0.9 m in place of 0.1.
pub(crate) const IN_ROLL: f32 = 0.4;

/// The motion that authority is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Airflow {
    /// Air velocity along the nose [m/s].
    pub along: f32,
    /// Air velocity across the wing [m/s], positive towards the belly: with it the angle of attack is positive.
    pub across: f32,
    /// Airspeed [m/s].
    pub speed: f32,
}

/// The angular accelerations that a thrust allows: from `wing` − `given` to `wing` + `given`.
#[derive(Clone, Copy)]
pub(crate) struct Allowed {
    /// What the wing makes [rad/s²], positive nose up.
    pub wing: f32,
    /// What the actuators can add to either side [rad/s²].
    pub given: f32,
    /// Thrust that the slipstream loses tail first \[N\].
    blown: f32,
}

impl Authority {
    /// Squared speed that the propellers give the air in hover [m²/s²], of a vehicle of this `weight` \[N\]; 0 where it is not known.
    pub fn squared_downwash(&self, weight: f32) -> f32 {
        if self.reversed > 0.0 {
            weight / (GONE * GONE * self.reversed)
        } else {
            0.0
        }
    }

    /// What a `thrust` \[N\] of at most `available` allows.
    #[inline(always)]
    pub fn at(&self, flow: Airflow, thrust: f32, available: f32) -> Allowed {
        // Tail first the slipstream does not reach the surfaces: w_h² falls as T, so what counts is T less what is blown back.
        let (blown, airflow) = if flow.along < 0.0 {
            (self.reversed * flow.along * flow.along, 0.0)
        } else {
            let flow = flow.along * flow.along - STALLED * flow.across * flow.across;
            (0.0, math::max(flow, 0.0))
        };
        Allowed {
            wing: self.wing(flow),
            given: self.constant
                + self.airflow * airflow
                + self.slipstream * math::max(thrust - blown, 0.0)
                + self.difference * math::max(math::min(thrust, available - thrust), 0.0),
            blown,
        }
    }

    /// The thrust \[N\] of what there is, from least to most, that gives `lacking` [rad/s²] more than `thrust` does, or the nearest to it: more thrust;
    /// less, where differences of it alone turn. [`at`](Self::at) believes in less of it: it does not count on motors that brake.
    #[cold]
    #[inline(never)]
    pub fn thrust_giving(
        self,
        allowed: &Allowed,
        lacking: f32,
        thrust: f32,
        least: f32,
        available: f32,
    ) -> f32 {
        let slope = self.per_thrust();
        if slope <= 0.0 {
            return thrust;
        }
        // Differences are greatest in the middle of the thrust that there is. Beyond it they lose as much as they gained before. A slipstream takes thrust
        // that is positive.
        let least = if self.slipstream == 0.0 { least } else { 0.0 };
        let half = 0.5 * (least + available);
        if thrust > half && self.slipstream == 0.0 {
            // Stopped motors turn nothing: there is no part of the way.
            return if thrust > 0.0 {
                math::max(thrust - lacking / self.difference, half)
            } else {
                half
            };
        }
        let needed = math::max(thrust, allowed.blown) + lacking / slope;
        let needed = if needed <= half || self.difference == 0.0 {
            needed
        } else {
            let beyond = self.slipstream - self.difference;
            if beyond > 0.0 {
                let from = math::max(thrust, half);
                from + (needed - from) * (slope / beyond)
            } else {
                half
            }
        };
        math::max(thrust, math::min(needed, available))
    }

    /// What a thrust gives, per thrust [rad/s² N].
    #[inline(always)]
    fn per_thrust(&self) -> f32 {
        self.slipstream + self.difference
    }

    /// Thrust \[N\] at rest that gives `wanted` [rad/s²]; 0 if none is needed or none helps.
    pub fn thrust_to_turn(&self, wanted: f32) -> f32 {
        let slope = self.per_thrust();
        if slope > 0.0 {
            math::max(wanted - self.constant, 0.0) / slope
        } else {
            0.0
        }
    }

    /// What there is in hover, at a thrust of the `weight` \[N\] of at most `most` [rad/s²].
    pub fn in_hover(&self, weight: f32, most: f32) -> f32 {
        self.constant
            + self.slipstream * weight
            + self.difference * math::min(weight, most - weight)
    }

    /// Airspeed across the wing [m/s] at which it takes as much as this angular acceleration [rad/s²].
    pub fn airspeed_held(&self, by: f32) -> f32 {
        math::sqrt((by / math::max(self.wing, f32::MIN_POSITIVE)).abs())
    }

    /// Angular acceleration that the wing makes [rad/s²]: it turns the nose to the air velocity.
    #[inline(always)]
    fn wing(&self, flow: Airflow) -> f32 {
        let across = flow.across.abs();
        if self.wing == 0.0 || across == 0.0 {
            return 0.0;
        }
        // Tail first the centre of pressure is at three quarters of the chord.
        if flow.along < 0.0 {
            return -self.wing * flow.across * flow.speed;
        }
        // Short of stall it is at a quarter of the chord, near the centre of mass; then it goes aft, to half of the chord across the flow.
        let (across_squared, stall) = (across * across, self.stall * flow.speed);
        let stalled = across_squared * across_squared;
        let attached = stall * stall * stall * stall;
        let arm = PLATE * flow.speed + (1.0 - PLATE) * across;
        -self.wing * flow.across * arm * (stalled / (stalled + attached))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Parameters;
    use crate::vehicle::VehicleParameters;

    /// 2 kg with elevons: 30 rad/s² at a thrust of the weight, a wing of 0.5 rad/m², propellers that give the air 10 m/s in hover.
    fn elevons() -> VehicleParameters {
        VehicleParameters {
            mass: 2.0,
            k_a: 0.2,
            gravity: 10.0,
            thrust_max: 40.0,
            authority: 0.0,
            authority_slipstream: 30.0 / IN_SLIPSTREAM,
            authority_airflow: 0.25 / SHARE,
            wing_moment: 0.5,
            hover_downwash: 10.0,
            ..VehicleParameters::DEFAULT
        }
    }

    fn flow(along: f32, across: f32) -> Airflow {
        let speed = math::sqrt(along * along + across * across);
        Airflow {
            along,
            across,
            speed,
        }
    }

    /// The thrust that `wanted` takes, and what it allows.
    struct Taken {
        thrust: f32,
        least: f32,
        most: f32,
    }

    fn at(p: &VehicleParameters, wanted: f32, flow: Airflow, thrust: f32) -> Taken {
        let (authority, available) = (p.pitch_authority(), p.thrust_max);
        let before = authority.at(flow, thrust, available);
        let lacking = (wanted - before.wing).abs() - before.given;
        let thrust = if lacking > 0.0 {
            authority.thrust_giving(&before, lacking, thrust, 0.0, available)
        } else {
            thrust
        };
        let Allowed { wing, given, .. } = authority.at(flow, thrust, available);
        Taken {
            thrust,
            least: wing - given,
            most: wing + given,
        }
    }

    /// By default nothing is bounded and no thrust is raised: the vehicle is the one of the laws.
    #[test]
    fn the_default_is_full_authority() {
        let p = VehicleParameters {
            mass: 2.0,
            k_a: 0.2,
            thrust_max: 40.0,
            ..VehicleParameters::DEFAULT
        };
        let allowed = at(&p, 900.0, flow(-20.0, 30.0), 0.0);
        assert_eq!(
            (allowed.thrust, allowed.least, allowed.most),
            (0.0, -1e6, 1e6)
        );
    }

    /// In hover surfaces have what the thrust gives them, and thrust is raised to what is wanted and not beyond.
    #[test]
    fn thrust_is_raised_for_what_is_wanted() {
        let p = elevons();
        let hover = flow(0.0, 0.0);
        let enough = at(&p, 29.0, hover, 20.0);
        assert!(enough.thrust == 20.0 && (enough.most - 30.0).abs() < 1e-4);
        for wanted in [45.0, -45.0] {
            let raised = at(&p, wanted, hover, 20.0);
            assert!((raised.thrust - 30.0).abs() < 1e-4 && (raised.most - 45.0).abs() < 1e-4);
        }
        assert_eq!(at(&p, 900.0, hover, 20.0).thrust, 40.0);
    }

    /// Across the flow the wing turns the nose to the air velocity, whichever side it comes from. The thrust that holds the nose there grows
    /// as the squared airspeed.
    #[test]
    fn a_stalled_wing_takes_authority() {
        let p = elevons();
        let (up, down) = (
            at(&p, 0.0, flow(0.0, 6.0), 0.0),
            at(&p, 0.0, flow(0.0, -6.0), 0.0),
        );
        // 0.5 · 6² = 18 rad/s² of the wing: 12 N of thrust hold it.
        assert!(
            (up.thrust - 12.0).abs() < 1e-4
                && up.most.abs() < 1e-4
                && (up.least + 36.0).abs() < 1e-3
        );
        assert_eq!(
            (down.thrust, down.least, down.most),
            (up.thrust, -up.most, -up.least)
        );
        let faster = at(&p, 0.0, flow(0.0, 8.0), 0.0);
        assert!((faster.thrust / up.thrust - 64.0 / 36.0).abs() < 1e-4);
    }

    /// Moments of the strips of `mapping` with elevons at rest at 19.8 m/s, over that across the flow. A wing short of stall leaves the nose alone, a
    /// stalled one turns it by more than the sine's square.
    #[test]
    fn a_stalled_wing_turns_the_nose_as_strips_do() {
        let p = elevons();
        let authority = Authority {
            stall: 0.25,
            ..p.pitch_authority()
        };
        for (degrees, strips) in [
            (5.0, 0.01),
            (10.0, 0.05),
            (15.0, 0.15),
            (20.0, 0.30),
            (25.0, 0.38),
            (30.0, 0.44),
            (40.0, 0.56),
            (60.0, 0.77),
            (90.0, 1.0),
        ] {
            let (sin, cos) = math::sin_cos(f32::to_radians(degrees));
            let moment = authority.at(flow(20.0 * cos, 20.0 * sin), 0.0, 40.0).wing;
            // 0.12: strips of other vehicles differ by as much; the sine's square is 0.19 off at 30°.
            assert!(
                (moment / (-p.wing_moment * 400.0) - strips).abs() < 0.12,
                "{degrees} {moment}"
            );
        }
    }

    /// The airflow along the nose gives authority until the surfaces stall with the wing.
    #[test]
    fn surfaces_stall_with_the_wing() {
        let p = VehicleParameters {
            wing_moment: 0.0,
            ..elevons()
        };
        assert!((at(&p, 0.0, flow(12.0, 0.0), 0.0).most - 36.0).abs() < 1e-3);
        let half = |across| {
            let a = at(&p, 0.0, flow(12.0, across), 0.0);
            0.5 * (a.most - a.least)
        };
        assert!(half(5.0) < 0.7 * half(0.0) && half(9.0) == 0.0);
    }

    /// Tail first the slipstream does not reach the surfaces: at 6 m/s, 0.6 of what the propellers give the air, a thrust of the weight gives
    /// nothing.
    #[test]
    fn tail_first_the_slipstream_is_lost() {
        let p = VehicleParameters {
            wing_moment: 0.0,
            ..elevons()
        };
        let given = |along| at(&p, 0.0, flow(along, 0.0), 20.0).most;
        assert!(
            (given(-3.0) - 22.5).abs() < 1e-4 && given(-6.0).abs() < 1e-4 && given(-9.0) == 0.0
        );
        // To have 15 rad/s² there it takes half of the weight more.
        assert!((at(&p, 15.0, flow(-6.0, 0.0), 20.0).thrust - 30.0).abs() < 1e-4);
    }

    /// In air that leaves propellers little thrust or none, stopped motors go to the middle of the thrust that there is; turning ones go as far as is lacking.
    #[test]
    fn motors_that_turn_the_vehicle_do_not_stand_in_a_dive() {
        let authority = Authority {
            constant: 0.0,
            slipstream: 0.0,
            difference: 2.0,
            airflow: 0.0,
            wing: 0.0,
            stall: 0.0,
            reversed: 0.0,
        };
        let giving = |lacking: f32, thrust: f32, available: f32| {
            let allowed = authority.at(flow(25.0, 0.0), thrust, available);
            authority.thrust_giving(&allowed, lacking, thrust, -20.0, available)
        };
        for lacking in [0.1, 3.0, 100.0] {
            assert_eq!(giving(lacking, 0.0, 0.0), -10.0);
            assert_eq!(giving(lacking, 0.0, 4.0), -8.0);
        }
        assert_eq!(giving(3.0, 4.0, 4.0), 2.5);
        assert_eq!(giving(100.0, 4.0, 4.0), -8.0);
    }

    /// Whatever share the slipstream and differences of thrust have, the thrust found gives what is wanted, or the most that any thrust gives; with a
    /// slipstream any that is not less.
    #[test]
    fn no_other_thrust_gives_more() {
        let available = 40.0;
        for (slipstream, difference) in [(0.8, 0.0), (0.0, 0.8), (0.3, 0.5), (0.5, 0.3), (0.4, 0.4)]
        {
            let authority = Authority {
                constant: 0.0,
                slipstream,
                difference,
                airflow: 0.0,
                wing: 0.0,
                stall: 0.0,
                reversed: 0.0,
            };
            let given = |thrust| authority.at(flow(0.0, 0.0), thrust, available).given;
            let most = |from: u16| {
                (from..=400)
                    .map(|n| given(0.1 * f32::from(n)))
                    .fold(0.0, f32::max)
            };
            for n in 0..200_u16 {
                let (thrust, lacking) = (0.2 * f32::from(n), 0.1 + 0.37 * f32::from(n % 53));
                let before = authority.at(flow(0.0, 0.0), thrust, available);
                let found = authority.thrust_giving(&before, lacking, thrust, 0.0, available);
                if slipstream > 0.0 {
                    let braked =
                        authority.thrust_giving(&before, lacking, thrust, -20.0, available);
                    assert_eq!(braked, found);
                }
                let right =
                    (before.given + lacking).min(most(if slipstream > 0.0 { 2 * n } else { 0 }));
                assert!((0.0..=available).contains(&found));
                // Some roundings of 32 rad/s².
                assert!(
                    (given(found) - right).abs() < 2e-5,
                    "{slipstream} {difference}: {thrust} {lacking}: {found} gives {}, not {right}",
                    given(found)
                );
            }
        }
    }

    /// Differences of thrust are greatest at half of it: from below thrust is raised, from above it is lowered.
    #[test]
    fn differences_of_thrust_need_room_on_both_sides() {
        let p = VehicleParameters {
            authority_slipstream: 0.0,
            authority_airflow: 0.0,
            authority_difference: 60.0 / SHARE,
            ..elevons()
        };
        let hover = flow(0.0, 0.0);
        for (thrust, wanted, right) in [
            (0.0, 30.0, 10.0),
            (40.0, 30.0, 30.0),
            (0.0, 900.0, 20.0),
            (40.0, 900.0, 20.0),
            (15.0, 30.0, 15.0),
        ] {
            let a = at(&p, wanted, hover, thrust);
            assert!(
                (a.thrust - right).abs() < 1e-4,
                "{thrust} {wanted}: {}",
                a.thrust
            );
            assert!((a.most - 3.0 * math::min(a.thrust, 40.0 - a.thrust)).abs() < 1e-3);
        }
        // 15 rad/s² of 3 rad/s² N.
        assert!((p.pitch_authority().thrust_to_turn(15.0) - 5.0).abs() < 1e-5);
        assert!((p.pitch_authority().in_hover(20.0, 40.0) - 60.0).abs() < 1e-4);
        assert!((p.pitch_authority().in_hover(30.0, 40.0) - 30.0).abs() < 1e-4);
    }
}
