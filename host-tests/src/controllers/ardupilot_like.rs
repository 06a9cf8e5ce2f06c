//! A tail-sitter in the manner of ArduPilot.
//!
//! Front transition: the pitch asked for goes down at `front_rate_deg_s` with the hover thrust, or what was asked for upwards before
//! if that is more, over the cosine of the tilt asked for, until the vehicle has pitched by `front_angle_deg`; then the
//! aeroplane's loops fly at once, their pitch no further below the present one than the same rate allows. Back transition:
//! hover thrust, or the trim thrust if that is more, while the aeroplane's attitude loop pitches up at `back_rate_deg_s` until
//! the nose is `back_angle_deg` over the horizon; then the multicopter's loops, whose pitch comes up no faster than that rate,
//! and which stay where they stop: QHOVER and QLOITER know no reference to return to. Either transition is over, too, after
//! 1.5 times the time that the rate needs for the angle. A switch thrown during a transition acts at once. Assistance
//! (`Q_ASSIST_SPEED`) is off, as it is for tail-sitters with control surfaces.
//!
//! | field | ArduPilot, stock |
//! |---|---|
//! | `front_angle_deg` | `Q_TAILSIT_ANGLE` 45 |
//! | `front_rate_deg_s` | `Q_TAILSIT_RAT_FW` 18: the first boot saves `Q_TAILSIT_ANGLE`/(`Q_TRANSITION_MS`/2000), 45°/2.5 s, over the 50 of the table |
//! | `back_angle_deg` | `Q_TAILSIT_ANG_VT` 0, which means `Q_TAILSIT_ANGLE`: 45 |
//! | `back_rate_deg_s` | `Q_TAILSIT_RAT_VT` 50 |
//! | `back_thrust_n` | `Q_TAILSIT_THR_VT` −1: hover thrust, or the trim thrust if that is more; left out here |
//!
//! Behaviour read in ArduPilot's `tailsitter.cpp` and `AC_AttitudeControl_Multi.cpp`, and in the page "Tailsitter Planes" of its
//! documentation.

use super::Kind;
use super::switching::policy::{Parts, SwitchingSpec, Transition};
use super::switching::{Measured, Phase, Setpoint, Tecs, TecsSpec};
use crate::experiment::table::{
    Range::{Finite, Positive, Within},
    table,
};
use crate::experiment::{FieldError, read};

/// The row in the list of controllers.
pub const KIND: Kind = Kind {
    name: "ardupilot-like",
    meaning: "switching transitions in the manner of ArduPilot",
    believes: false,
    read: |table| Ok(Box::new(read::<ArduPilotLikeSpec>(table)?)),
};

/// `[controller.ardupilot-like]`.
pub type ArduPilotLikeSpec = SwitchingSpec<ArduPilotTransition>;

table! {
    /// `[controller.ardupilot-like.transition]`.
    pub struct ArduPilotTransition {
        front_angle_deg: f64, Within(5.0, 80.0), "Angle from nose up at which the aeroplane takes over \\[°\\].";
        front_rate_deg_s: f64, Positive, "Rate of the pitch asked for, down \\[°/s\\].";
        back_angle_deg: f64, Within(5.0, 80.0), "Angle of the nose over the horizon at which the multicopter takes over \\[°\\].";
        back_rate_deg_s: f64, Positive, "Rate of the pitch asked for, up \\[°/s\\].";
        back_thrust_n: Option<f64>, Finite, "Thrust of the back transition \\[N\\]; hover thrust, or the trim thrust if that is more, if left out.";
    }
}

/// A transition that takes this many times longer than it should is over.
const PATIENCE: f64 = 1.5;
const QUARTER: f64 = std::f64::consts::FRAC_PI_2;
/// The pitch ramps end 5° short of a quarter turn.
const STEEPEST: f64 = 85.0 * std::f64::consts::PI / 180.0;
/// The thrust is raised for the tilt by no more than this.
const LEAST_COSINE: f64 = 0.1;

impl ArduPilotTransition {
    /// Pitch by which a ramp has turned since the phase began \[rad\].
    fn ramp(rate_deg_s: f64, parts: &Parts<Tecs>) -> f64 {
        rate_deg_s.to_radians() * parts.elapsed
    }

    /// `setpoint` with its pitch limited to what the transition's rate allows since the phase began: down if `sign` is −1.
    fn limit(
        mut setpoint: Setpoint,
        parts: &mut Parts<Tecs>,
        sign: f64,
        rate_deg_s: f64,
    ) -> Setpoint {
        let reached = parts.start + sign * Self::ramp(rate_deg_s, parts);
        parts.limited = parts.limited && sign * (setpoint.theta - reached) > 0.0;
        if parts.limited {
            setpoint.theta = reached;
        }
        setpoint
    }
}

impl Transition for ArduPilotTransition {
    type Cruise = TecsSpec;

    fn check(&self) -> Result<(), FieldError> {
        self.in_range("transition")
    }

    fn least_airspeed(&self, cruise: &TecsSpec) -> f64 {
        cruise.airspeed_m_s[0]
    }

    fn front_is_over(&self, parts: &Parts<Tecs>, measured: &Measured) -> bool {
        let angle = self.front_angle_deg.to_radians();
        let rate = self.front_rate_deg_s.to_radians();
        let late = parts.elapsed > PATIENCE * (angle + parts.start) / rate;
        -measured.theta > angle || late
    }

    fn back_is_over(&self, parts: &Parts<Tecs>, measured: &Measured) -> bool {
        let angle = self.back_angle_deg.to_radians();
        let rate = self.back_rate_deg_s.to_radians();
        let late = parts.elapsed > PATIENCE * (angle - parts.start - QUARTER) / rate;
        // The pitch over the horizon.
        measured.theta + QUARTER > angle || late
    }

    /// θ asked for on the way to a transition, measured on the way out of one.
    fn enter(&self, parts: &mut Parts<Tecs>, phase: Phase, measured: &Measured) -> f64 {
        match (parts.phase, phase) {
            (_, Phase::Hover) => {
                parts.hover.reset();
                parts.hover.stop(measured);
            }
            // The aeroplane's loops have been at work in the front transition.
            (Phase::FrontTransition, Phase::Cruise) | (_, Phase::BackTransition) => {}
            (_, Phase::Cruise) => parts.cruise.reset(),
            (_, Phase::FrontTransition) => {
                let upwards = parts.output.thrust() * measured.theta.cos();
                parts.upwards = upwards.max(parts.hover.thrust());
                parts.cruise.reset();
            }
        }
        parts.limited = matches!(phase, Phase::Hover | Phase::Cruise);
        if parts.limited {
            measured.theta
        } else {
            parts.asked
        }
    }

    fn setpoint(&self, parts: &mut Parts<Tecs>, measured: &Measured, dt: f64) -> Setpoint {
        match parts.phase {
            Phase::Hover => {
                let setpoint = parts.hover.setpoint(measured, dt);
                Self::limit(setpoint, parts, 1.0, self.back_rate_deg_s)
            }
            Phase::Cruise => {
                let setpoint = parts.cruise.setpoint(measured, false, dt);
                Self::limit(setpoint, parts, -1.0, self.front_rate_deg_s)
            }
            Phase::FrontTransition => {
                parts.cruise.setpoint(measured, true, dt);
                let ramp = Self::ramp(self.front_rate_deg_s, parts);
                let theta = (parts.start - ramp).max(-STEEPEST);
                Setpoint {
                    theta,
                    gain: parts.hover.gain(),
                    thrust: parts.upwards / theta.cos().max(LEAST_COSINE),
                }
            }
            Phase::BackTransition => Setpoint {
                theta: (parts.start + Self::ramp(self.back_rate_deg_s, parts))
                    .min(STEEPEST - QUARTER),
                gain: parts.cruise.gain(),
                thrust: (self.back_thrust_n)
                    .unwrap_or(parts.hover.thrust().max(parts.cruise.trim())),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::switching::policy::Switching;
    use super::super::switching::policy::tests::policy;
    use super::super::switching::tecs;
    use super::super::switching::tests::level;
    use super::super::{Answer, Controller};
    use super::*;

    const TRANSITION: ArduPilotTransition = ArduPilotTransition {
        front_angle_deg: 45.0,
        front_rate_deg_s: 50.0,
        back_angle_deg: 45.0,
        back_rate_deg_s: 50.0,
        back_thrust_n: None,
    };

    /// The phase and the answer at `theta` \[°\] and 15 m/s, in front if `forward`, else braking.
    fn answer(
        policy: &mut Switching<ArduPilotTransition>,
        theta: f32,
        forward: bool,
    ) -> (Phase, Answer) {
        let acceleration = if forward { 2.0 } else { -2.0 };
        let input = level(15.0, theta, 15.0, acceleration);
        let answer = policy.answer(&input, 0.01).unwrap();
        (policy.parts.phase, answer)
    }

    #[test]
    fn the_front_transition_is_a_ramp_that_carries_the_weight_until_its_angle() {
        let policy = &mut policy(TRANSITION, tecs::tests::SPEC);
        for _ in 0..50 {
            let (phase, answer) = answer(policy, -44.0, true);
            assert_eq!(phase, Phase::FrontTransition);
            let upwards = f64::from(answer.thrust) * policy.parts.asked.cos();
            assert!((upwards - 98.1).abs() < 1e-4);
        }
        // 0.5 s at 50 °/s.
        assert!((policy.parts.asked + 25_f64.to_radians()).abs() < 1e-6);
        assert_eq!(answer(policy, -46.0, true).0, Phase::Cruise);
        // Pitched down from there at no more than 50 °/s.
        assert!((policy.parts.asked + 46.5_f64.to_radians()).abs() < 1e-6);
        for _ in 0..200 {
            answer(policy, -86.0, true);
        }
        assert!(!policy.parts.limited);
    }

    #[test]
    fn a_front_transition_that_does_not_turn_is_over_in_time() {
        let policy = &mut policy(TRANSITION, tecs::tests::SPEC);
        // 1.5 · 45° / 50 °/s.
        for _ in 0..135 {
            assert_eq!(answer(policy, 0.0, true).0, Phase::FrontTransition);
        }
        for _ in 0..3 {
            answer(policy, 0.0, true);
        }
        assert_eq!(policy.parts.phase, Phase::Cruise);
    }

    #[test]
    fn the_back_transition_is_a_ramp_at_hover_thrust_and_its_rate_is_kept_in_hover() {
        let policy = &mut policy(TRANSITION, tecs::tests::SPEC);
        answer(policy, 0.0, true);
        for _ in 0..300 {
            answer(policy, -86.0, true);
        }
        let start = policy.parts.asked;
        for _ in 0..20 {
            let (phase, answer) = answer(policy, -80.0, false);
            assert_eq!(phase, Phase::BackTransition);
            assert!((answer.thrust - 98.1).abs() < 1e-4);
        }
        assert!((policy.parts.asked - start - 10_f64.to_radians()).abs() < 0.01);
        let (phase, _) = answer(policy, -44.0, false);
        assert_eq!(phase, Phase::Hover);
        // Braking asks for the nose backward, which it may approach at 50 °/s.
        assert!((policy.parts.asked + 43.5_f64.to_radians()).abs() < 1e-6);
    }

    #[test]
    fn hover_stays_where_it_was_reached_but_before_the_first_transition() {
        let policy = &mut policy(TRANSITION, tecs::tests::SPEC);
        assert!(!policy.parts.hover.stops());
        answer(policy, 0.0, true);
        for _ in 0..300 {
            answer(policy, -86.0, true);
        }
        answer(policy, -80.0, false);
        answer(policy, -44.0, false);
        assert_eq!(policy.parts.phase, Phase::Hover);
        assert!(policy.parts.hover.stops());
    }
}
