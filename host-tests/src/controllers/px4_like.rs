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

use serde::Deserialize;

use super::switching::policy::{Parts, Policy, answer};
use super::switching::{CruiseSpec, HoverSpec, LimitSpec, Measured, Phase, Setpoint, SwitchSpec};
use super::{Answer, Controller, Input, Kind, Spec};
use crate::experiment::{Experiment, FieldError, positive, read};

/// The row in the list of controllers.
pub const KIND: Kind = Kind {
    name: "px4-like",
    meaning: "switching transitions in the manner of PX4",
    believes: false,
    read: |table| Ok(Box::new(read::<Px4LikeSpec>(table)?)),
};

/// `[controller.px4-like]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Px4LikeSpec {
    /// Limits of the command.
    #[serde(default)]
    pub limits: LimitSpec,
    /// The transition switch.
    pub switch: SwitchSpec,
    /// The multicopter's loops.
    pub hover: HoverSpec,
    /// The transitions.
    pub transition: TransitionSpec,
    /// The aeroplane's loops.
    pub cruise: CruiseSpec,
}

/// `[controller.px4-like.transition]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransitionSpec {
    /// Time in which the front transition would pitch by 90° \[s\].
    pub front_s: f64,
    /// Airspeed that ends the front transition \[m/s\].
    pub front_airspeed_m_s: f64,
    /// Time in which the back transition would pitch by 90°, and its longest duration \[s\].
    pub back_s: f64,
}

/// Pitch at which the aeroplane may take over \[rad\].
const TO_CRUISE: f64 = -60.0 * std::f64::consts::PI / 180.0;
/// Pitch at which the multicopter takes over \[rad\].
const TO_HOVER: f64 = -15.0 * std::f64::consts::PI / 180.0;
const QUARTER: f64 = std::f64::consts::FRAC_PI_2;

/// The policy with its memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Px4Like {
    transition: TransitionSpec,
    parts: Parts,
}

impl Px4Like {
    /// The policy at hover, on the vehicle of `experiment`.
    pub fn new(spec: &Px4LikeSpec, experiment: &Experiment) -> Result<Self, FieldError> {
        let t = spec.transition;
        positive("transition.front_s", t.front_s)?;
        positive("transition.front_airspeed_m_s", t.front_airspeed_m_s)?;
        positive("transition.back_s", t.back_s)?;
        Ok(Self {
            transition: t,
            parts: Parts::new(
                spec.hover,
                spec.cruise,
                spec.switch,
                &spec.limits,
                t.front_airspeed_m_s,
                experiment,
            )?,
        })
    }
}

impl Policy for Px4Like {
    fn parts(&mut self) -> &mut Parts {
        &mut self.parts
    }

    fn front_is_over(&self, measured: &Measured) -> bool {
        measured.theta <= TO_CRUISE && measured.airspeed >= self.transition.front_airspeed_m_s
    }

    fn back_is_over(&self, measured: &Measured) -> bool {
        measured.theta >= TO_HOVER || self.parts.elapsed > self.transition.back_s
    }

    fn enter(&mut self, phase: Phase, _: &Measured) -> f64 {
        match phase {
            // The vertical loop has been at work in the transitions.
            Phase::Hover | Phase::FrontTransition => {}
            Phase::Cruise => self.parts.cruise.reset(),
            Phase::BackTransition => self.parts.hover.reset(),
        }
        self.parts.asked
    }

    fn setpoint(&mut self, measured: &Measured, dt: f64) -> Setpoint {
        let parts = &mut self.parts;
        let ramp = |duration: f64| QUARTER / duration * parts.elapsed;
        match parts.phase {
            Phase::Hover => parts.hover.setpoint(measured, dt),
            Phase::FrontTransition => Setpoint {
                theta: (parts.start - ramp(self.transition.front_s)).max(parts.cruise.level()),
                gain: parts.hover.gain(),
                thrust: parts.hover.vertical(measured, dt),
            },
            Phase::Cruise => parts.cruise.setpoint(measured, dt),
            Phase::BackTransition => Setpoint {
                theta: (parts.start + ramp(self.transition.back_s)).min(0.0),
                gain: parts.hover.gain(),
                thrust: parts.hover.vertical(measured, dt),
            },
        }
    }
}

impl Controller for Px4Like {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        Ok(answer(self, input, dt))
    }
}

impl Spec for Px4LikeSpec {
    fn controller(&self, experiment: &Experiment) -> Result<Box<dyn Controller>, FieldError> {
        Ok(Box::new(Px4Like::new(self, experiment)?))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Report;
    use super::super::switching::tests::{CRUISE, HOVER, SWITCH, experiment, level as input};
    use super::*;

    const SPEC: Px4LikeSpec = Px4LikeSpec {
        limits: LimitSpec {
            thrust_n: Some([0.0, 196.2]),
            rate_rad_s: 2.8,
            slew_rad_s2: 30.0,
        },
        switch: SWITCH,
        hover: HOVER,
        transition: TransitionSpec {
            front_s: 5.0,
            front_airspeed_m_s: 10.0,
            back_s: 4.0,
        },
        cruise: CRUISE,
    };

    fn policy() -> Px4Like {
        Px4Like::new(&SPEC, &experiment()).unwrap()
    }

    fn phase(policy: &mut Px4Like, input: Input) -> Phase {
        match policy.answer(&input, 0.01).unwrap().report {
            Report::Switching(phase) => phase,
            _ => panic!("a switching policy"),
        }
    }

    #[test]
    fn the_front_transition_needs_pitch_and_speed() {
        let mut policy = policy();
        assert_eq!(phase(&mut policy, input(0.0, 0.0, 0.0, 0.0)), Phase::Hover);
        let front = Phase::FrontTransition;
        assert_eq!(phase(&mut policy, input(0.0, 0.0, 1.5, 2.0)), front);
        assert_eq!(phase(&mut policy, input(12.0, -59.0, 5.0, 2.0)), front);
        assert_eq!(phase(&mut policy, input(9.9, -61.0, 5.0, 2.0)), front);
        let cruise = Phase::Cruise;
        assert_eq!(phase(&mut policy, input(10.1, -61.0, 5.0, 2.0)), cruise);
        // It is not left for a lack of either.
        assert_eq!(phase(&mut policy, input(9.0, -50.0, 5.0, 2.0)), cruise);
    }

    #[test]
    fn the_ramps_take_their_durations() {
        let mut policy = policy();
        phase(&mut policy, input(0.0, 0.0, 1.5, 2.0));
        for _ in 0..249 {
            phase(&mut policy, input(0.0, 0.0, 1.5, 2.0));
        }
        // Half of 5 s, half of 90°.
        assert!(
            (policy.parts.asked + 0.5 * QUARTER).abs() < 1e-6,
            "{}",
            policy.parts.asked
        );
        for _ in 0..500 {
            phase(&mut policy, input(0.0, 0.0, 1.5, 2.0));
        }
        assert!((policy.parts.asked - policy.parts.cruise.level()).abs() < 1e-9);

        phase(&mut policy, input(15.0, -80.0, 15.0, 0.0));
        let start = policy.parts.asked;
        for _ in 0..100 {
            assert_eq!(
                phase(&mut policy, input(15.0, -80.0, 14.0, -2.0)),
                Phase::BackTransition
            );
        }
        // A quarter of 4 s.
        assert!((policy.parts.asked - start - 0.25 * QUARTER).abs() < 0.01);
    }

    #[test]
    fn the_back_transition_ends_near_vertical_or_in_time() {
        let back = || {
            let mut policy = policy();
            phase(&mut policy, input(0.0, 0.0, 1.5, 2.0));
            phase(&mut policy, input(15.0, -80.0, 15.0, 0.0));
            assert_eq!(policy.parts.phase, Phase::Cruise);
            phase(&mut policy, input(15.0, -80.0, 14.0, -2.0));
            policy
        };
        let braking = |theta| input(10.0, theta, 10.0, -2.0);
        let mut policy = back();
        assert_eq!(phase(&mut policy, braking(-16.0)), Phase::BackTransition);
        assert_eq!(phase(&mut policy, braking(-14.0)), Phase::Hover);
        let mut policy = back();
        for _ in 0..398 {
            assert_eq!(phase(&mut policy, braking(-40.0)), Phase::BackTransition);
        }
        for _ in 0..4 {
            phase(&mut policy, braking(-40.0));
        }
        assert_eq!(policy.parts.phase, Phase::Hover);
    }

    #[test]
    fn a_switch_thrown_in_a_transition_acts_at_once() {
        let mut policy = policy();
        phase(&mut policy, input(0.0, 0.0, 1.5, 2.0));
        assert_eq!(
            phase(&mut policy, input(5.0, -30.0, 4.0, -2.0)),
            Phase::Hover
        );
        let mut policy = super::tests::policy();
        phase(&mut policy, input(0.0, 0.0, 1.5, 2.0));
        phase(&mut policy, input(15.0, -80.0, 15.0, 0.0));
        phase(&mut policy, input(15.0, -80.0, 14.0, -2.0));
        assert_eq!(
            phase(&mut policy, input(14.0, -70.0, 14.0, 2.0)),
            Phase::Cruise
        );
    }

    #[test]
    fn errors_name_the_field() {
        let mut spec = SPEC;
        spec.transition.back_s = 0.0;
        let error = Px4Like::new(&spec, &experiment()).unwrap_err();
        assert_eq!(error.field, "transition.back_s");
        let mut spec = SPEC;
        spec.limits.slew_rad_s2 = -1.0;
        let error = Px4Like::new(&spec, &experiment()).unwrap_err();
        assert_eq!(error.field, "limits.slew_rad_s2");
    }
}
