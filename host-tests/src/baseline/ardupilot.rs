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

use super::measured::Wind;
use super::{
    Cruise, CruiseSpec, Hover, HoverSpec, Measured, Output, Phase, Setpoint, Switch, SwitchSpec,
};
use crate::mission::{Answer, LimitSpec, Pilot};
use crate::scenario::{FieldError, finite, positive};
use alula::GuidanceInput;

/// `[controller.ardupilot-like]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArduPilotLikeSpec {
    /// Limits of the command, as the guidance's.
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
    wind: Wind,
    switch: Switch,
    hover: Hover,
    cruise: Cruise,
    output: Output,
    phase: Phase,
    /// Time in the phase \[s\].
    elapsed: f64,
    /// θ when the phase began \[rad\]: asked for on the way to a transition, measured on the way out of one.
    start: f64,
    /// Whether the pitch that the present loops ask for is still limited to the transition's rate.
    limited: bool,
    /// θ asked for last \[rad\].
    asked: f64,
}

impl ArduPilotLike {
    /// The policy at hover; `table` is where `spec` stands.
    pub fn new(spec: &ArduPilotLikeSpec, table: &str) -> Result<Self, FieldError> {
        let field = |name: &str| format!("{table}.{name}");
        spec.hover.validate(&field("hover"))?;
        spec.cruise.validate(&field("cruise"))?;
        let t = spec.transition;
        for (name, angle) in [
            ("transition.front_angle_deg", t.front_angle_deg),
            ("transition.back_angle_deg", t.back_angle_deg),
        ] {
            if !(5.0..=80.0).contains(&angle) {
                return Err(FieldError::new(field(name), "must be from 5 to 80°"));
            }
        }
        positive(&field("transition.front_rate_deg_s"), t.front_rate_deg_s)?;
        positive(&field("transition.back_rate_deg_s"), t.back_rate_deg_s)?;
        if let Some(thrust) = t.back_thrust_n {
            finite(&field("transition.back_thrust_n"), thrust)?;
        }
        let least = spec.cruise.airspeed_m_s[0];
        Ok(Self {
            transition: t,
            wind: Wind::default(),
            switch: Switch::new(spec.switch, least, &field("switch"))?,
            hover: Hover::new(spec.hover, spec.limits.thrust_n),
            cruise: Cruise::new(spec.cruise, spec.limits.thrust_n[1]),
            output: Output::new(&spec.limits, &field("limits"))?,
            phase: Phase::Hover,
            elapsed: 0.0,
            start: 0.0,
            limited: false,
            asked: 0.0,
        })
    }

    fn enter(&mut self, phase: Phase, theta: f64) {
        match phase {
            Phase::Hover => self.hover.reset(),
            Phase::Cruise => self.cruise.reset(),
            Phase::FrontTransition | Phase::BackTransition => {}
        }
        let transition = matches!(phase, Phase::FrontTransition | Phase::BackTransition);
        self.start = if transition { self.asked } else { theta };
        self.limited = !transition;
        self.phase = phase;
        self.elapsed = 0.0;
    }

    /// The phase that follows, if one does.
    fn next(&self, cruise: bool, theta: f64) -> Option<Phase> {
        let t = &self.transition;
        // The pitch over the horizon.
        let pitch = theta + QUARTER;
        match (self.phase, cruise) {
            (Phase::Hover, true) => Some(Phase::FrontTransition),
            (Phase::FrontTransition, false) => Some(Phase::Hover),
            (Phase::FrontTransition, true) => {
                let angle = t.front_angle_deg.to_radians();
                let rate = t.front_rate_deg_s.to_radians();
                let late = self.elapsed > PATIENCE * (angle + self.start) / rate;
                (-theta > angle || late).then_some(Phase::Cruise)
            }
            (Phase::Cruise, false) => Some(Phase::BackTransition),
            (Phase::BackTransition, true) => Some(Phase::Cruise),
            (Phase::BackTransition, false) => {
                let angle = t.back_angle_deg.to_radians();
                let rate = t.back_rate_deg_s.to_radians();
                let late = self.elapsed > PATIENCE * (angle - self.start - QUARTER) / rate;
                (pitch > angle || late).then_some(Phase::Hover)
            }
            (Phase::Hover, false) | (Phase::Cruise, true) => None,
        }
    }

    /// `setpoint` with its pitch limited to what the transition's rate allows since the phase began: down if `sign` is −1.
    fn limit(&mut self, setpoint: &mut Setpoint, sign: f64, rate_deg_s: f64) {
        let reached = self.start + sign * rate_deg_s.to_radians() * self.elapsed;
        if self.limited && sign * (setpoint.theta - reached) > 0.0 {
            setpoint.theta = reached;
        } else {
            self.limited = false;
        }
    }

    fn setpoint(&mut self, measured: &Measured, dt: f64) -> Setpoint {
        let t = self.transition;
        match self.phase {
            Phase::Hover => {
                let mut setpoint = self.hover.setpoint(measured, dt);
                self.limit(&mut setpoint, 1.0, t.back_rate_deg_s);
                setpoint
            }
            Phase::FrontTransition => {
                let ramp = t.front_rate_deg_s.to_radians() * self.elapsed;
                Setpoint {
                    theta: (self.start - ramp).max(-STEEPEST),
                    gain: self.hover.gain(),
                    thrust: self.output.thrust().max(self.hover.thrust()),
                }
            }
            Phase::Cruise => {
                let mut setpoint = self.cruise.setpoint(measured, dt);
                self.limit(&mut setpoint, -1.0, t.front_rate_deg_s);
                setpoint
            }
            Phase::BackTransition => {
                let ramp = t.back_rate_deg_s.to_radians() * self.elapsed;
                let thrust = self.hover.thrust().max(self.cruise.trim());
                Setpoint {
                    theta: (self.start + ramp).min(STEEPEST - QUARTER),
                    gain: self.cruise.gain(),
                    thrust: t.back_thrust_n.unwrap_or(thrust),
                }
            }
        }
    }
}

impl Pilot for ArduPilotLike {
    fn answer(&mut self, input: &GuidanceInput, dt: f32) -> Answer {
        let dt = f64::from(dt);
        let Some(measured) = self.wind.read(input, dt) else {
            return self.output.again(self.phase);
        };
        let cruise = self.switch.update(&measured);
        if let Some(phase) = self.next(cruise, measured.theta) {
            self.enter(phase, measured.theta);
        }
        self.elapsed += dt;
        let setpoint = self.setpoint(&measured, dt);
        self.asked = setpoint.theta;
        self.output.answer(setpoint, measured.theta, self.phase, dt)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{cruise, hover, output, switch};
    use super::*;
    use crate::mission::Report;
    use alula::control::Air;
    use alula::{Attitude, Inertial, Reference};

    const SPEC: ArduPilotLikeSpec = ArduPilotLikeSpec {
        limits: output::tests::LIMITS,
        switch: switch::tests::SPEC,
        hover: hover::tests::SPEC,
        transition: TransitionSpec {
            front_angle_deg: 45.0,
            front_rate_deg_s: 50.0,
            back_angle_deg: 45.0,
            back_rate_deg_s: 50.0,
            back_thrust_n: None,
        },
        cruise: cruise::tests::SPEC,
    };

    fn policy() -> ArduPilotLike {
        ArduPilotLike::new(&SPEC, "controller.ardupilot-like").unwrap()
    }

    /// The phase and the answer at `theta` \[°\] and 15 m/s, in front if `forward`, else braking.
    fn answer(policy: &mut ArduPilotLike, theta: f32, forward: bool) -> (Phase, Answer) {
        let acceleration = if forward { 2.0 } else { -2.0 };
        let input = GuidanceInput {
            velocity: Inertial::new(0.0, 15.0),
            attitude: Attitude::from_angle(theta.to_radians()),
            state_age: 0.0,
            air: Air::Velocity(Inertial::new(0.0, 15.0)),
            position_error: None,
            reference: Reference {
                velocity: Inertial::new(0.0, 15.0),
                acceleration: Inertial::new(0.0, acceleration),
            },
            reference_age: 0.0,
        };
        let answer = policy.answer(&input, 0.01);
        match answer.report {
            Report::Switching(phase) => (phase, answer),
            Report::Guided(_) => panic!("not the guidance"),
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
        assert!((policy.asked + 25_f64.to_radians()).abs() < 1e-6);
        assert_eq!(answer(&mut policy, -46.0, true).0, Phase::Cruise);
        // Pitched down from there at no more than 50 °/s.
        assert!((policy.asked + 46.5_f64.to_radians()).abs() < 1e-6);
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
        assert_eq!(policy.phase, Phase::Cruise);
    }

    #[test]
    fn the_back_transition_is_a_ramp_at_hover_thrust_and_its_rate_is_kept_in_hover() {
        let mut policy = policy();
        answer(&mut policy, 0.0, true);
        answer(&mut policy, -86.0, true);
        let start = policy.asked;
        for _ in 0..20 {
            let (phase, answer) = answer(&mut policy, -80.0, false);
            assert_eq!(phase, Phase::BackTransition);
            assert!((answer.thrust - 98.1).abs() < 1e-4);
        }
        assert!((policy.asked - start - 10_f64.to_radians()).abs() < 0.01);
        let (phase, _) = answer(&mut policy, -44.0, false);
        assert_eq!(phase, Phase::Hover);
        // Braking asks for the nose backward, which it may approach at 50 °/s.
        assert!((policy.asked + 43.5_f64.to_radians()).abs() < 1e-6);
    }

    #[test]
    fn errors_name_the_field() {
        let mut spec = SPEC;
        spec.transition.front_angle_deg = 85.0;
        let error = ArduPilotLike::new(&spec, "controller.ardupilot-like").unwrap_err();
        assert_eq!(
            error.field,
            "controller.ardupilot-like.transition.front_angle_deg"
        );
    }
}
