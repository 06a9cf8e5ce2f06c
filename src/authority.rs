//! Authority in pitch: how fast the rate of the attitude can change.

use crate::math;
use crate::vehicle::VehicleParameters;

/// What surfaces and differences of thrust can do, and what the wing does against them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Authority {
    /// Without thrust and airflow [rad/s²].
    constant: f32,
    /// Of surfaces in the slipstream, per thrust [rad/s² N].
    slipstream: f32,
    /// Of a difference of thrust, per difference [rad/s² N].
    difference: f32,
    /// Of surfaces in the airflow, per squared airspeed along the nose [rad/m²].
    airflow: f32,
    /// Of the wing, per squared airspeed [rad/m²].
    wing: f32,
    /// Thrust \[N\] whose slipstream is gone at 1 m/s tail first, per squared speed [kg/m]; 0 if it never is.
    reversed: f32,
}

/// Squared airspeed across the wing that takes the airflow's authority away, over that along the nose: surfaces stall with the wing, at 36°.
const STALLED: f32 = 1.9;

/// Speed tail first at which surfaces in the slipstream have no effect, over the speed that the propellers give the air.
const GONE: f32 = 0.6;

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

/// Thrust, and the angular accelerations that it allows.
#[derive(Clone, Copy)]
pub(crate) struct Allowed {
    /// Thrust \[N\].
    pub thrust: f32,
    /// Least and greatest angular acceleration in pitch [rad/s²], positive nose up.
    pub least: f32,
    pub most: f32,
}

impl Authority {
    /// That of a vehicle with these parameters, which have been checked.
    pub fn of_checked(p: &VehicleParameters) -> Self {
        let weight = p.mass * p.gravity;
        let gone = GONE * p.hover_downwash;
        Self {
            constant: p.authority,
            slipstream: p.authority_slipstream / weight,
            difference: p.authority_difference / weight,
            airflow: p.authority_airflow,
            wing: p.wing_moment,
            reversed: if gone > 0.0 {
                weight / (gone * gone)
            } else {
                0.0
            },
        }
    }

    /// Raises `thrust` \[N\], up to `available`, until an angular acceleration of `wanted` [rad/s²] is allowed.
    #[inline(always)]
    pub fn with_thrust(&self, wanted: f32, flow: Airflow, thrust: f32, available: f32) -> Allowed {
        let wing = self.wing(flow);
        // Tail first the slipstream does not reach the surfaces: w_h² falls as T, so what counts is T less what is blown back.
        let blown = if flow.along < 0.0 {
            self.reversed * flow.along * flow.along
        } else {
            0.0
        };
        let without = self.unpowered(flow);
        let given = |thrust: f32| {
            without
                + self.slipstream * math::max(thrust - blown, 0.0)
                + self.difference * math::max(math::min(thrust, available - thrust), 0.0)
        };
        let lacking = (wanted - wing).abs() - given(thrust);
        let slope = self.slipstream + self.difference;
        let thrust = if (lacking > 0.0) & (slope > 0.0) {
            let needed = math::max(thrust, blown) + lacking / slope;
            if self.slipstream == 0.0 {
                // Differences are greatest at half of the thrust: from above it is lowered.
                let half = 0.5 * available;
                let towards = if thrust > half {
                    thrust - lacking / self.difference
                } else {
                    needed
                };
                if thrust > half {
                    math::max(towards, half)
                } else {
                    math::min(towards, half)
                }
            } else {
                math::max(thrust, math::min(needed, available))
            }
        } else {
            thrust
        };
        let given = given(thrust);
        Allowed {
            thrust,
            least: wing - given,
            most: wing + given,
        }
    }

    /// What there is in hover, at a thrust of the `weight` \[N\] of at most `most` [rad/s²].
    pub fn in_hover(&self, weight: f32, most: f32) -> f32 {
        self.constant
            + self.slipstream * weight
            + self.difference * math::min(weight, most - weight)
    }

    /// What there is without thrust [rad/s²].
    #[inline(always)]
    fn unpowered(&self, flow: Airflow) -> f32 {
        let flow = if flow.along > 0.0 {
            math::max(
                flow.along * flow.along - STALLED * flow.across * flow.across,
                0.0,
            )
        } else {
            0.0
        };
        self.constant + self.airflow * flow
    }

    /// Angular acceleration that the wing makes [rad/s²]: it turns the nose to the air velocity.
    #[inline(always)]
    fn wing(&self, flow: Airflow) -> f32 {
        // Its centre of pressure is at a quarter of the chord short of stall, at half of it across the flow, and at three quarters tail first.
        let arm = if flow.along < 0.0 {
            flow.speed
        } else {
            flow.across.abs()
        };
        -self.wing * flow.across * arm
    }
}
