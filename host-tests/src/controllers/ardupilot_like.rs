//! A tail-sitter in the manner of ArduPilot.
//!
//! Front transition: the pitch asked for goes down at `front_rate_deg_s` with the hover thrust, or the present one if that
//! is more, until the vehicle has pitched by `front_angle_deg`; then the aeroplane's loops fly at once, their pitch no
//! further below the present one than the same rate allows. Back transition: hover thrust, or the trim thrust if that is
//! more, while the aeroplane's attitude loop pitches up at `back_rate_deg_s` until the nose is `back_angle_deg` over the
//! horizon; then the multicopter's loops, whose pitch comes up no faster than that rate. Either is over, too, after 1.5
//! times the time that the rate needs for the angle. A switch thrown during a transition acts at once.
//!
//! | field | ArduPilot, stock |
//! |---|---|
//! | `front_angle_deg` | `Q_TAILSIT_ANGLE` 45 |
//! | `front_rate_deg_s` | `Q_TAILSIT_RAT_FW` 50 |
//! | `back_angle_deg` | `Q_TAILSIT_ANG_VT` 0, which means `Q_TAILSIT_ANGLE`: 45 |
//! | `back_rate_deg_s` | `Q_TAILSIT_RAT_VT` 50 |
//! | `back_thrust_n` | `Q_TAILSIT_THR_VT` −1: hover thrust, or the trim thrust if that is more; left out here |
//!
//! Read in ArduPilot's `tailsitter.cpp` (parameter table) and in the page "Tailsitter Planes" of its documentation.

use serde::Deserialize;

use super::switching::policy::{Parts, Policy, answer};
use super::switching::{CruiseSpec, HoverSpec, LimitSpec, Measured, Phase, Setpoint, SwitchSpec};
use super::{Answer, Controller, Input, Kind, Spec};
use crate::experiment::{Experiment, FieldError, finite, positive, read};

/// The row in the list of controllers.
pub const KIND: Kind = Kind {
    name: "ardupilot-like",
    meaning: "switching transitions in the manner of ArduPilot",
    believes: false,
    read: |table| Ok(Box::new(read::<ArduPilotLikeSpec>(table)?)),
};

/// `[controller.ardupilot-like]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArduPilotLikeSpec {
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

/// `[controller.ardupilot-like.transition]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TransitionSpec {
    /// Angle from nose up at which the aeroplane takes over \[°\].
    pub front_angle_deg: f64,
    /// Rate of the pitch asked for, down \[°/s\].
    pub front_rate_deg_s: f64,
    /// Angle of the nose over the horizon at which the multicopter takes over \[°\].
    pub back_angle_deg: f64,
    /// Rate of the pitch asked for, up \[°/s\].
    pub back_rate_deg_s: f64,
    /// Thrust of the back transition \[N\]; hover thrust, or the trim thrust if that is more, if left out.
    pub back_thrust_n: Option<f64>,
}

/// A transition that takes this many times longer than it should is over.
const PATIENCE: f64 = 1.5;
const QUARTER: f64 = std::f64::consts::FRAC_PI_2;
/// The pitch ramps end 5° short of a quarter turn.
const STEEPEST: f64 = 85.0 * std::f64::consts::PI / 180.0;

/// The policy with its memory.
#[derive(Clone, Debug, PartialEq)]
pub struct ArduPilotLike {
    transition: TransitionSpec,
    parts: Parts,
    /// Whether the pitch that the present loops ask for is still limited to the transition's rate.
    limited: bool,
}

impl ArduPilotLike {
    /// The policy at hover, on the vehicle of `experiment`.
    pub fn new(spec: &ArduPilotLikeSpec, experiment: &Experiment) -> Result<Self, FieldError> {
        let t = spec.transition;
        for (name, angle) in [
            ("transition.front_angle_deg", t.front_angle_deg),
            ("transition.back_angle_deg", t.back_angle_deg),
        ] {
            if !(5.0..=80.0).contains(&angle) {
                return Err(FieldError::new(name, "must be from 5 to 80°"));
            }
        }
        positive("transition.front_rate_deg_s", t.front_rate_deg_s)?;
        positive("transition.back_rate_deg_s", t.back_rate_deg_s)?;
        if let Some(thrust) = t.back_thrust_n {
            finite("transition.back_thrust_n", thrust)?;
        }
        let least = spec.cruise.airspeed_m_s[0];
        let (hover, cruise, switch) = (spec.hover, spec.cruise, spec.switch);
        Ok(Self {
            transition: t,
            parts: Parts::new(hover, cruise, switch, &spec.limits, least, experiment)?,
            limited: false,
        })
    }

    /// `setpoint` with its pitch limited to what the transition's rate allows since the phase began: down if `sign` is −1.
    fn limit(&mut self, setpoint: &mut Setpoint, sign: f64, rate_deg_s: f64) {
        let reached = self.parts.start + sign * rate_deg_s.to_radians() * self.parts.elapsed;
        if self.limited && sign * (setpoint.theta - reached) > 0.0 {
            setpoint.theta = reached;
        } else {
            self.limited = false;
        }
    }
}

impl Policy for ArduPilotLike {
    fn parts(&mut self) -> &mut Parts {
        &mut self.parts
    }

    fn front_is_over(&self, measured: &Measured) -> bool {
        let angle = self.transition.front_angle_deg.to_radians();
        let rate = self.transition.front_rate_deg_s.to_radians();
        let late = self.parts.elapsed > PATIENCE * (angle + self.parts.start) / rate;
        -measured.theta > angle || late
    }

    fn back_is_over(&self, measured: &Measured) -> bool {
        let angle = self.transition.back_angle_deg.to_radians();
        let rate = self.transition.back_rate_deg_s.to_radians();
        let late = self.parts.elapsed > PATIENCE * (angle - self.parts.start - QUARTER) / rate;
        // The pitch over the horizon.
        measured.theta + QUARTER > angle || late
    }

    /// θ asked for on the way to a transition, measured on the way out of one.
    fn enter(&mut self, phase: Phase, measured: &Measured) -> f64 {
        match phase {
            Phase::Hover => self.parts.hover.reset(),
            Phase::Cruise => self.parts.cruise.reset(),
            Phase::FrontTransition | Phase::BackTransition => {}
        }
        self.limited = matches!(phase, Phase::Hover | Phase::Cruise);
        if self.limited {
            measured.theta
        } else {
            self.parts.asked
        }
    }

    fn setpoint(&mut self, measured: &Measured, dt: f64) -> Setpoint {
        let t = self.transition;
        match self.parts.phase {
            Phase::Hover => {
                let mut setpoint = self.parts.hover.setpoint(measured, dt);
                self.limit(&mut setpoint, 1.0, t.back_rate_deg_s);
                setpoint
            }
            Phase::FrontTransition => {
                let ramp = t.front_rate_deg_s.to_radians() * self.parts.elapsed;
                Setpoint {
                    theta: (self.parts.start - ramp).max(-STEEPEST),
                    gain: self.parts.hover.gain(),
                    thrust: self.parts.output.thrust().max(self.parts.hover.thrust()),
                }
            }
            Phase::Cruise => {
                let mut setpoint = self.parts.cruise.setpoint(measured, dt);
                self.limit(&mut setpoint, -1.0, t.front_rate_deg_s);
                setpoint
            }
            Phase::BackTransition => {
                let ramp = t.back_rate_deg_s.to_radians() * self.parts.elapsed;
                let thrust = self.parts.hover.thrust().max(self.parts.cruise.trim());
                Setpoint {
                    theta: (self.parts.start + ramp).min(STEEPEST - QUARTER),
                    gain: self.parts.cruise.gain(),
                    thrust: t.back_thrust_n.unwrap_or(thrust),
                }
            }
        }
    }
}

impl Controller for ArduPilotLike {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        Ok(answer(self, input, dt))
    }
}

impl Spec for ArduPilotLikeSpec {
    fn controller(&self, experiment: &Experiment) -> Result<Box<dyn Controller>, FieldError> {
        Ok(Box::new(ArduPilotLike::new(self, experiment)?))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Report;
    use super::super::switching::tests::{CRUISE, HOVER, SWITCH, experiment, level};
    use super::*;

    const SPEC: ArduPilotLikeSpec = ArduPilotLikeSpec {
        limits: LimitSpec {
            thrust_n: Some([0.0, 196.2]),
            rate_rad_s: 2.8,
            slew_rad_s2: 30.0,
        },
        switch: SWITCH,
        hover: HOVER,
        transition: TransitionSpec {
            front_angle_deg: 45.0,
            front_rate_deg_s: 50.0,
            back_angle_deg: 45.0,
            back_rate_deg_s: 50.0,
            back_thrust_n: None,
        },
        cruise: CRUISE,
    };

    fn policy() -> ArduPilotLike {
        ArduPilotLike::new(&SPEC, &experiment()).unwrap()
    }

    /// The phase and the answer at `theta` \[°\] and 15 m/s, in front if `forward`, else braking.
    fn answer(policy: &mut ArduPilotLike, theta: f32, forward: bool) -> (Phase, Answer) {
        let acceleration = if forward { 2.0 } else { -2.0 };
        let input = level(15.0, theta, 15.0, acceleration);
        let answer = policy.answer(&input, 0.01).unwrap();
        match answer.report {
            Report::Switching(phase) => (phase, answer),
            _ => panic!("a switching policy"),
        }
    }

    #[test]
    fn the_front_transition_is_a_ramp_at_hover_thrust_until_its_angle() {
        let mut policy = policy();
        for _ in 0..50 {
            let (phase, answer) = answer(&mut policy, -44.0, true);
            assert_eq!(phase, Phase::FrontTransition);
            assert!((answer.thrust - 98.1).abs() < 1e-4);
        }
        // 0.5 s at 50 °/s.
        assert!((policy.parts.asked + 25_f64.to_radians()).abs() < 1e-6);
        assert_eq!(answer(&mut policy, -46.0, true).0, Phase::Cruise);
        // Pitched down from there at no more than 50 °/s.
        assert!((policy.parts.asked + 46.5_f64.to_radians()).abs() < 1e-6);
        for _ in 0..200 {
            answer(&mut policy, -86.0, true);
        }
        assert!(!policy.limited);
    }

    #[test]
    fn a_front_transition_that_does_not_turn_is_over_in_time() {
        let mut policy = policy();
        // 1.5 · 45° / 50 °/s.
        for _ in 0..135 {
            assert_eq!(answer(&mut policy, 0.0, true).0, Phase::FrontTransition);
        }
        for _ in 0..3 {
            answer(&mut policy, 0.0, true);
        }
        assert_eq!(policy.parts.phase, Phase::Cruise);
    }

    #[test]
    fn the_back_transition_is_a_ramp_at_hover_thrust_and_its_rate_is_kept_in_hover() {
        let mut policy = policy();
        answer(&mut policy, 0.0, true);
        answer(&mut policy, -86.0, true);
        let start = policy.parts.asked;
        for _ in 0..20 {
            let (phase, answer) = answer(&mut policy, -80.0, false);
            assert_eq!(phase, Phase::BackTransition);
            assert!((answer.thrust - 98.1).abs() < 1e-4);
        }
        assert!((policy.parts.asked - start - 10_f64.to_radians()).abs() < 0.01);
        let (phase, _) = answer(&mut policy, -44.0, false);
        assert_eq!(phase, Phase::Hover);
        // Braking asks for the nose backward, which it may approach at 50 °/s.
        assert!((policy.parts.asked + 43.5_f64.to_radians()).abs() < 1e-6);
    }

    #[test]
    fn errors_name_the_field() {
        let mut spec = SPEC;
        spec.transition.front_angle_deg = 85.0;
        let error = ArduPilotLike::new(&spec, &experiment()).unwrap_err();
        assert_eq!(error.field, "transition.front_angle_deg");
    }
}
