//! Thrust of a propeller of fixed pitch over the airspeed along it.

use crate::math;
use crate::vehicle::VehicleParameters;

/// Thrust over static thrust at full throttle and x = u/u_0 is s² − 0.6 s x − 0.4 x², where s² is the throttle: the static thrust it
/// commands, over the greatest. Propellers of published tables lie within 0.5 to 0.7 and 0.3 to 0.5.
const HALF_LINEAR: f32 = 0.3;
/// 0.3² + 0.4.
const QUADRATIC: f32 = 0.49;
/// Thrust over the greatest below which the command goes to none: a propeller that turns without thrust costs energy.
const IDLE: f32 = 0.02;

/// Thrust over airspeed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Propeller {
    /// 1/u_0 [s/m]; 0 for thrust that does not fall.
    per_speed: f32,
    /// Greatest static thrust \[N\].
    most: f32,
}

impl Propeller {
    /// That of a vehicle with these parameters, which have been checked.
    pub fn of_checked(p: &VehicleParameters) -> Self {
        Self {
            per_speed: if p.zero_thrust_speed > 0.0 {
                1.0 / p.zero_thrust_speed
            } else {
                0.0
            },
            most: p.thrust_max,
        }
    }

    /// Part of the greatest static thrust that is there at an airspeed `along` the nose [m/s].
    #[inline(always)]
    pub fn available(&self, along: f32) -> f32 {
        let x = math::clamp(along * self.per_speed, 0.0, 1.0);
        1.0 - x * (2.0 * HALF_LINEAR + (QUADRATIC - HALF_LINEAR * HALF_LINEAR) * x)
    }

    /// Static thrust \[N\] to command for a `thrust` \[N\] at an airspeed `along` the nose [m/s].
    #[inline(always)]
    pub fn command(&self, thrust: f32, along: f32) -> f32 {
        let x = math::clamp(along * self.per_speed, 0.0, 1.0);
        if (x == 0.0) | (thrust <= 0.0) {
            return thrust;
        }
        let share = thrust / self.most;
        let held = math::max(share, IDLE);
        let s = HALF_LINEAR * x + math::sqrt(QUADRATIC * x * x + held);
        self.most * math::min(s * s, 1.0) * math::min(share / IDLE, 1.0)
    }
}
