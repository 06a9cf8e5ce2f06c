//! What both policies share: the table, the parts, and the order of a step.

use std::fmt::Debug;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::measured::Wind;
use super::{Hover, HoverSpec, LimitSpec, Measured, Output, Phase, Setpoint, Switch, SwitchSpec};
use crate::controllers::{Answer, Controller, Input, Spec};
use crate::experiment::table::ordered;
use crate::experiment::{Experiment, FieldError, require};

/// The table of a policy, whose transitions are those of `T`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, bound = "T: Transition + Deserialize<'de>")]
pub struct SwitchingSpec<T: Transition> {
    /// Limits of the command.
    #[serde(default)]
    pub limits: LimitSpec,
    /// The transition switch.
    pub switch: SwitchSpec,
    /// The multicopter's loops.
    pub hover: HoverSpec,
    /// The transitions.
    pub transition: T,
    /// The aeroplane's loops.
    pub cruise: T::Cruise,
}

/// The table of an aeroplane's loops.
pub trait CruiseTable: Copy + Debug + PartialEq + DeserializeOwned + 'static {
    /// The loops.
    type Loops: Clone + Debug + PartialEq;

    /// Checks the numbers, and those that belong together; `table` is where they stand.
    fn validate(&self, table: &str) -> Result<(), FieldError>;

    /// The loops on a vehicle with `full` thrust \[N\] at full throttle.
    fn loops(self, full: f64) -> Self::Loops;
}

/// Airspeeds, throttles and pitch angles must be [least, greatest], and the `trim` throttle between the throttles.
pub fn in_order(
    table: &str,
    [airspeed, throttle, pitch]: [[f64; 2]; 3],
    trim: f64,
) -> Result<(), FieldError> {
    let field = |name: &str| format!("{table}.{name}");
    ordered(&field("airspeed_m_s"), airspeed)?;
    ordered(&field("throttle"), throttle)?;
    ordered(&field("pitch_deg"), pitch)?;
    let within = (throttle[0]..throttle[1]).contains(&trim);
    require(within, field("trim_throttle"), "must be within throttle")
}

/// The way of an autopilot from hover to cruise and back.
pub trait Transition: Copy + 'static {
    /// How it flies as an aeroplane.
    type Cruise: CruiseTable;

    /// Checks its numbers.
    fn check(&self) -> Result<(), FieldError>;

    /// Airspeed from which on the wing is to carry the vehicle \[m/s\].
    fn least_airspeed(&self, cruise: &Self::Cruise) -> f64;

    /// Whether the front transition may end.
    fn front_is_over(&self, parts: &Parts<Loops<Self>>, measured: &Measured) -> bool;

    /// Whether the back transition may end.
    fn back_is_over(&self, parts: &Parts<Loops<Self>>, measured: &Measured) -> bool;

    /// Prepares the loops of `phase`, and returns θ when it begins \[rad\].
    fn enter(&self, parts: &mut Parts<Loops<Self>>, phase: Phase, measured: &Measured) -> f64;

    /// The setpoint of the present phase, `dt` \[s\] after the last.
    fn setpoint(&self, parts: &mut Parts<Loops<Self>>, measured: &Measured, dt: f64) -> Setpoint;
}

/// The aeroplane's loops of an autopilot.
pub type Loops<T> = <<T as Transition>::Cruise as CruiseTable>::Loops;

/// The loops of either flight, and what a policy remembers.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts<C> {
    wind: Wind,
    switch: Switch,
    /// The multicopter's loops.
    pub hover: Hover,
    /// The aeroplane's loops.
    pub cruise: C,
    /// The last stage.
    pub output: Output,
    /// What the policy is doing.
    pub phase: Phase,
    /// Time in the phase \[s\].
    pub elapsed: f64,
    /// θ when the phase began \[rad\], as the policy counts it.
    pub start: f64,
    /// θ asked for last \[rad\].
    pub asked: f64,
    /// Vertical thrust that is kept in the front transition \[N\].
    pub upwards: f64,
    /// Whether the pitch that the loops ask for is still limited to the rate of the transition before.
    pub limited: bool,
}

/// A policy with its memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Switching<T: Transition> {
    pub(crate) parts: Parts<Loops<T>>,
    transition: T,
}

impl<T: Transition> SwitchingSpec<T> {
    /// The policy at hover, on the vehicle of `experiment`.
    pub fn policy(&self, experiment: &Experiment) -> Result<Switching<T>, FieldError> {
        self.switch.in_range("switch")?;
        self.hover.in_range("hover")?;
        self.transition.check()?;
        self.cruise.validate("cruise")?;
        let thrust = self.limits.thrust(experiment);
        let least = self.transition.least_airspeed(&self.cruise);
        Ok(Switching {
            parts: Parts {
                wind: Wind::default(),
                switch: Switch::new(self.switch, least),
                hover: Hover::new(self.hover, thrust),
                cruise: self.cruise.loops(thrust[1]),
                output: Output::new(&self.limits, thrust)?,
                phase: Phase::Hover,
                elapsed: 0.0,
                start: 0.0,
                asked: 0.0,
                upwards: 0.0,
                limited: false,
            },
            transition: self.transition,
        })
    }
}

impl<T: Transition> Spec for SwitchingSpec<T> {
    fn controller(&self, experiment: &Experiment) -> Result<Box<dyn Controller>, FieldError> {
        Ok(Box::new(self.policy(experiment)?))
    }
}

impl<T: Transition> Switching<T> {
    /// The phase that follows, if one does, now that the switch is at `cruise` or not.
    fn next(&self, cruise: bool, measured: &Measured) -> Option<Phase> {
        let (parts, transition) = (&self.parts, &self.transition);
        let (front, back) = (
            || transition.front_is_over(parts, measured),
            || transition.back_is_over(parts, measured),
        );
        match (parts.phase, cruise) {
            (Phase::Hover, true) => Some(Phase::FrontTransition),
            (Phase::FrontTransition, false) => Some(Phase::Hover),
            (Phase::FrontTransition, true) => front().then_some(Phase::Cruise),
            (Phase::Cruise, false) => Some(Phase::BackTransition),
            (Phase::BackTransition, true) => Some(Phase::Cruise),
            (Phase::BackTransition, false) => back().then_some(Phase::Hover),
            (Phase::Hover, false) | (Phase::Cruise, true) => None,
        }
    }
}

impl<T: Transition> Controller for Switching<T> {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        let dt = f64::from(dt);
        let Some(measured) = self.parts.wind.read(&input.sample, dt) else {
            return Ok(self.parts.output.again(self.parts.phase));
        };
        let cruise = self.parts.switch.update(&measured);
        if let Some(phase) = self.next(cruise, &measured) {
            let start = self.transition.enter(&mut self.parts, phase, &measured);
            (self.parts.phase, self.parts.elapsed, self.parts.start) = (phase, 0.0, start);
        }
        self.parts.elapsed += dt;
        let setpoint = self.transition.setpoint(&mut self.parts, &measured, dt);
        let Parts { output, phase, .. } = &mut self.parts;
        let answer = output.answer(setpoint, measured.theta, *phase, dt);
        self.parts.asked = setpoint.theta;
        Ok(answer)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::{cruise, hover, switch};
    use super::*;
    use crate::controllers::{Px4LikeSpec, px4_like};
    use crate::experiment::Document;

    /// The table of the tests, with these transitions.
    pub(crate) fn spec<T: Transition>(transition: T, cruise: T::Cruise) -> SwitchingSpec<T> {
        SwitchingSpec {
            limits: LimitSpec {
                thrust_n: Some([0.0, 196.2]),
                ..LimitSpec::default()
            },
            switch: switch::tests::SPEC,
            hover: hover::tests::SPEC,
            transition,
            cruise,
        }
    }

    /// A policy on the vehicle of the round trip.
    pub(crate) fn policy<T: Transition>(transition: T, cruise: T::Cruise) -> Switching<T> {
        let experiment = Document::load("round-trip").unwrap().checked().unwrap();
        spec(transition, cruise).policy(&experiment).unwrap()
    }

    /// The policy's phase after 0.01 s.
    pub(crate) fn phase<T: Transition>(policy: &mut Switching<T>, input: Input) -> Phase {
        policy.answer(&input, 0.01).unwrap();
        policy.parts.phase
    }

    #[test]
    fn errors_name_the_field() {
        let experiment = Document::load("round-trip").unwrap().checked().unwrap();
        let refused = |change: fn(&mut Px4LikeSpec)| {
            let mut spec = spec(px4_like::tests::TRANSITION, cruise::tests::SPEC);
            change(&mut spec);
            spec.policy(&experiment).unwrap_err().field
        };
        assert_eq!(refused(|s| s.hover.tilt_deg = 90.0), "hover.tilt_deg");
        let integral = refused(|s| s.hover.integral_1_s2[1] = -1.0);
        assert_eq!(integral, "hover.integral_1_s2");
        assert_eq!(refused(|s| s.hover.thrust_n = 0.0), "hover.thrust_n");
        let trim = refused(|s| s.cruise.trim_throttle = 1.0);
        assert_eq!(trim, "cruise.trim_throttle");
        let pitch = refused(|s| s.cruise.pitch_deg = [30.0, 30.0]);
        assert_eq!(pitch, "cruise.pitch_deg");
        let weight = refused(|s| s.cruise.speed_weight = 2.1);
        assert_eq!(weight, "cruise.speed_weight");
        let sink = refused(|s| s.cruise.sink_m_s[1] = f64::NAN);
        assert_eq!(sink, "cruise.sink_m_s");
        let airspeed = refused(|s| s.cruise.airspeed_m_s[0] = -1.0);
        assert_eq!(airspeed, "cruise.airspeed_m_s");
        assert_eq!(refused(|s| s.transition.back_s = 0.0), "transition.back_s");
        let slew = refused(|s| s.limits.slew_rad_s2 = -1.0);
        assert_eq!(slew, "limits.slew_rad_s2");
        let switch = refused(|s| s.switch.cruise_m_s = f64::INFINITY);
        assert_eq!(switch, "switch.cruise_m_s");
    }
}
