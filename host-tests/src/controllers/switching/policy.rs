//! What both policies share: their parts, and the order of a step.

use super::measured::Wind;
use super::{
    Cruise, CruiseSpec, Hover, HoverSpec, LimitSpec, Measured, Output, Phase, Setpoint, Switch,
    SwitchSpec,
};
use crate::controllers::{Answer, Input};
use crate::experiment::{Experiment, FieldError};

/// The loops of either flight, and what a policy remembers.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    wind: Wind,
    switch: Switch,
    pub hover: Hover,
    pub cruise: Cruise,
    pub output: Output,
    pub phase: Phase,
    /// Time in the phase \[s\].
    pub elapsed: f64,
    /// θ when the phase began \[rad\], as the policy counts it.
    pub start: f64,
    /// θ asked for last \[rad\].
    pub asked: f64,
}

impl Parts {
    /// The parts at hover, on the vehicle of `experiment`, whose wing is to carry it from `least` \[m/s\] on.
    pub fn new(
        hover: HoverSpec,
        cruise: CruiseSpec,
        switch: SwitchSpec,
        limits: &LimitSpec,
        least: f64,
        experiment: &Experiment,
    ) -> Result<Self, FieldError> {
        hover.validate("hover")?;
        cruise.validate("cruise")?;
        let thrust = limits.thrust(experiment);
        Ok(Self {
            wind: Wind::default(),
            switch: Switch::new(switch, least, "switch")?,
            hover: Hover::new(hover, thrust),
            cruise: Cruise::new(cruise, thrust[1]),
            output: Output::new(limits, thrust)?,
            phase: Phase::Hover,
            elapsed: 0.0,
            start: 0.0,
            asked: 0.0,
        })
    }
}

/// What a policy does with its parts.
pub trait Policy {
    /// The parts.
    fn parts(&mut self) -> &mut Parts;

    /// Whether the front transition may end.
    fn front_is_over(&self, measured: &Measured) -> bool;

    /// Whether the back transition may end.
    fn back_is_over(&self, measured: &Measured) -> bool;

    /// Prepares the loops of `phase`, and returns θ when it begins \[rad\].
    fn enter(&mut self, phase: Phase, measured: &Measured) -> f64;

    /// The setpoint of the present phase, `dt` \[s\] after the last.
    fn setpoint(&mut self, measured: &Measured, dt: f64) -> Setpoint;
}

/// The phase that follows, if one does, now that the switch is at `cruise` or not.
fn next(policy: &mut impl Policy, cruise: bool, measured: &Measured) -> Option<Phase> {
    match (policy.parts().phase, cruise) {
        (Phase::Hover, true) => Some(Phase::FrontTransition),
        (Phase::FrontTransition, false) => Some(Phase::Hover),
        (Phase::FrontTransition, true) => policy.front_is_over(measured).then_some(Phase::Cruise),
        (Phase::Cruise, false) => Some(Phase::BackTransition),
        (Phase::BackTransition, true) => Some(Phase::Cruise),
        (Phase::BackTransition, false) => policy.back_is_over(measured).then_some(Phase::Hover),
        (Phase::Hover, false) | (Phase::Cruise, true) => None,
    }
}

/// The answer of `policy` to `input`, `dt` \[s\] after the last.
pub fn answer(policy: &mut impl Policy, input: &Input, dt: f32) -> Answer {
    let dt = f64::from(dt);
    let parts = policy.parts();
    let Some(measured) = parts.wind.read(&input.sample, dt) else {
        return parts.output.again(parts.phase);
    };
    let cruise = parts.switch.update(&measured);
    if let Some(phase) = next(policy, cruise, &measured) {
        let start = policy.enter(phase, &measured);
        let parts = policy.parts();
        parts.phase = phase;
        parts.elapsed = 0.0;
        parts.start = start;
    }
    policy.parts().elapsed += dt;
    let setpoint = policy.setpoint(&measured, dt);
    let parts = policy.parts();
    parts.asked = setpoint.theta;
    parts
        .output
        .answer(setpoint, measured.theta, parts.phase, dt)
}
