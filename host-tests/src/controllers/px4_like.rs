//! A tail-sitter in the manner of PX4.
//!
//! Front transition: the pitch asked for goes from hover to level at 90° per `front_s`, while the multicopter's vertical
//! loop acts on the thrust. It is over at −60° of pitch and an airspeed of `front_airspeed_m_s`. Back transition: the
//! pitch asked for goes from the aeroplane's to nose up at 90° per `back_s`, again with the vertical loop on the thrust,
//! until −15°, or until `back_s` have passed. A switch thrown during the front transition gives hover at once, during the
//! back transition cruise.
//!
//! | field | PX4, stock |
//! |---|---|
//! | `front_s` | `VT_F_TRANS_DUR` 5.0 |
//! | `front_airspeed_m_s` | `VT_ARSP_TRANS` 10.0 |
//! | `back_s` | `VT_B_TRANS_DUR` 10.0 (4.0 before it became the longest duration) |
//!
//! Read in PX4's `vtol_att_control_params.c` and `tailsitter.cpp`/`.h` of release 1.14 and later, where −60° and −15° are
//! constants. Without an airspeed, pitch alone ends the front transition there; here the ground speed stands in.

use super::Kind;
use super::switching::policy::{Parts, SwitchingSpec, Transition};
use super::switching::{Cruise, CruiseSpec, Measured, Phase, Setpoint};
use crate::experiment::table::{Range::Positive, table};
use crate::experiment::{FieldError, read};

/// The row in the list of controllers.
pub const KIND: Kind = Kind {
    name: "px4-like",
    meaning: "switching transitions in the manner of PX4",
    believes: false,
    read: |table| Ok(Box::new(read::<Px4LikeSpec>(table)?)),
};

/// `[controller.px4-like]`.
pub type Px4LikeSpec = SwitchingSpec<Px4Transition>;

table! {
    /// `[controller.px4-like.transition]`.
    pub struct Px4Transition {
        front_s: f64, Positive, "Time in which the front transition would pitch by 90° \\[s\\].";
        front_airspeed_m_s: f64, Positive, "Airspeed that ends the front transition \\[m/s\\].";
        back_s: f64, Positive, "Time in which the back transition would pitch by 90°, and its longest duration \\[s\\].";
    }
}

/// Pitch at which the aeroplane may take over \[rad\].
const TO_CRUISE: f64 = -60.0 * std::f64::consts::PI / 180.0;
/// Pitch at which the multicopter takes over \[rad\].
const TO_HOVER: f64 = -15.0 * std::f64::consts::PI / 180.0;
const QUARTER: f64 = std::f64::consts::FRAC_PI_2;

impl Transition for Px4Transition {
    type Cruise = CruiseSpec;

    fn check(&self) -> Result<(), FieldError> {
        self.in_range("transition")
    }

    fn least_airspeed(&self, _: &CruiseSpec) -> f64 {
        self.front_airspeed_m_s
    }

    fn front_is_over(&self, _: &Parts<Cruise>, measured: &Measured) -> bool {
        measured.theta <= TO_CRUISE && measured.airspeed >= self.front_airspeed_m_s
    }

    fn back_is_over(&self, parts: &Parts<Cruise>, measured: &Measured) -> bool {
        measured.theta >= TO_HOVER || parts.elapsed > self.back_s
    }

    fn enter(&self, parts: &mut Parts<Cruise>, phase: Phase, _: &Measured) -> f64 {
        match phase {
            // The vertical loop has been at work in the transitions.
            Phase::Hover | Phase::FrontTransition => {}
            Phase::Cruise => parts.cruise.reset(),
            Phase::BackTransition => parts.hover.reset(),
        }
        parts.asked
    }

    fn setpoint(&self, parts: &mut Parts<Cruise>, measured: &Measured, dt: f64) -> Setpoint {
        let ramp = |duration: f64| QUARTER / duration * parts.elapsed;
        let theta = match parts.phase {
            Phase::Hover => return parts.hover.setpoint(measured, dt),
            Phase::Cruise => return parts.cruise.setpoint(measured, dt),
            Phase::FrontTransition => (parts.start - ramp(self.front_s)).max(parts.cruise.level()),
            Phase::BackTransition => (parts.start + ramp(self.back_s)).min(0.0),
        };
        Setpoint {
            theta,
            gain: parts.hover.gain(),
            thrust: parts.hover.vertical(measured, dt),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::switching::cruise;
    use super::super::switching::policy::Switching;
    use super::super::switching::policy::tests::{phase, policy};
    use super::super::switching::tests::level as input;
    use super::*;

    pub(crate) const TRANSITION: Px4Transition = Px4Transition {
        front_s: 5.0,
        front_airspeed_m_s: 10.0,
        back_s: 4.0,
    };

    #[test]
    fn the_front_transition_needs_pitch_and_speed() {
        let mut policy = policy(TRANSITION, cruise::tests::SPEC);
        let mut phase = |input| phase(&mut policy, input);
        assert_eq!(phase(input(0.0, 0.0, 0.0, 0.0)), Phase::Hover);
        let front = Phase::FrontTransition;
        assert_eq!(phase(input(0.0, 0.0, 1.5, 2.0)), front);
        assert_eq!(phase(input(12.0, -59.0, 5.0, 2.0)), front);
        assert_eq!(phase(input(9.9, -61.0, 5.0, 2.0)), front);
        let cruise = Phase::Cruise;
        assert_eq!(phase(input(10.1, -61.0, 5.0, 2.0)), cruise);
        // It is not left for a lack of either.
        assert_eq!(phase(input(9.0, -50.0, 5.0, 2.0)), cruise);
    }

    /// On the way to cruise, and on the way back.
    fn stages() -> [Switching<Px4Transition>; 2] {
        let mut policy = policy(TRANSITION, cruise::tests::SPEC);
        phase(&mut policy, input(0.0, 0.0, 1.5, 2.0));
        let front = policy.clone();
        assert_eq!(
            phase(&mut policy, input(15.0, -80.0, 15.0, 0.0)),
            Phase::Cruise
        );
        phase(&mut policy, input(15.0, -80.0, 14.0, -2.0));
        [front, policy]
    }

    #[test]
    fn the_ramps_take_their_durations() {
        let [mut front, mut back] = stages();
        for _ in 0..249 {
            phase(&mut front, input(0.0, 0.0, 1.5, 2.0));
        }
        // Half of 5 s, half of 90°.
        assert!((front.parts.asked + 0.5 * QUARTER).abs() < 1e-6);
        for _ in 0..500 {
            phase(&mut front, input(0.0, 0.0, 1.5, 2.0));
        }
        assert!((front.parts.asked - front.parts.cruise.level()).abs() < 1e-9);
        for _ in 0..99 {
            let phase = phase(&mut back, input(15.0, -80.0, 14.0, -2.0));
            assert_eq!(phase, Phase::BackTransition);
        }
        // A quarter of 4 s.
        assert!((back.parts.asked - back.parts.start - 0.25 * QUARTER).abs() < 1e-6);
    }

    #[test]
    fn the_back_transition_ends_near_vertical_or_in_time() {
        let braking = |theta| input(10.0, theta, 10.0, -2.0);
        let [_, mut back] = stages();
        let mut late = back.clone();
        assert_eq!(phase(&mut back, braking(-16.0)), Phase::BackTransition);
        assert_eq!(phase(&mut back, braking(-14.0)), Phase::Hover);
        for _ in 0..398 {
            assert_eq!(phase(&mut late, braking(-40.0)), Phase::BackTransition);
        }
        for _ in 0..4 {
            phase(&mut late, braking(-40.0));
        }
        assert_eq!(late.parts.phase, Phase::Hover);
    }

    #[test]
    fn a_switch_thrown_in_a_transition_acts_at_once() {
        let [mut front, mut back] = stages();
        assert_eq!(
            phase(&mut front, input(5.0, -30.0, 4.0, -2.0)),
            Phase::Hover
        );
        assert_eq!(
            phase(&mut back, input(14.0, -70.0, 14.0, 2.0)),
            Phase::Cruise
        );
    }
}
