//! Controllers: whoever closes the loop of an experiment.
//!
//! A controller answers one [`Input`] per control step. What an experiment says of it is a [`Spec`], read from the table
//! `[controller.KIND]`; [`KINDS`] has one row per kind. To add one: its file, and its row.

mod guidance;
mod law;

use std::borrow::Cow;

use alula::control::Diagnostics;
use alula::guidance::{Air, Mode};
use alula::{
    Command, Fault, FeedForward, Inertial, PlanarGuidanceInput, PlanarGuidanceOutput, State,
};
use alula_link::{Configuration, Pacing};
use serde::{Deserialize, de};
use toml::{Table, Value};

pub use guidance::{Flying, GuidanceSpec};
pub use law::{Form, Law, LawSpec};

use crate::experiment::{Experiment, FieldError, VehicleSpec};
use crate::margins::LoopGains;
use crate::reference::Vector;

/// What a controller is told at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// θ \[rad\] in [−π, π) as measured, of which the attitude in `sample` is the cosine and sine.
    pub theta: f32,
    /// State, air and reference, as the core's guidance takes them.
    pub sample: PlanarGuidanceInput,
    /// Air acceleration and the reference's jerk, if the controller is flown with feed-forward.
    pub feed_forward: Option<FeedForward>,
}

impl Input {
    /// The wind \[m/s\] told to the controller, directly or by an air velocity; none if the air is unknown.
    pub fn wind(&self) -> Inertial {
        match self.sample.air {
            Air::Velocity(velocity) => self.sample.velocity - velocity,
            Air::Wind(wind) => wind,
            Air::Unknown => Inertial::ZERO,
        }
    }

    /// The state as the bare laws take it.
    pub fn state(&self) -> State {
        State {
            velocity: self.sample.velocity,
            attitude: self.sample.attitude,
            wind: self.wind(),
        }
    }
}

/// A controller's command, and what it reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Thrust T \[N\].
    pub thrust: f32,
    /// Angular rate ω \[rad/s\].
    pub rate: f32,
    /// What else it says.
    pub report: Report,
}

/// What a controller reports besides its command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Report {
    /// One of the bare laws: a command, or the fault for which the safe command was flown.
    Law(Result<Command, Fault>),
    /// The guidance.
    Guidance(PlanarGuidanceOutput),
    /// Someone who reports nothing.
    Outside,
}

impl From<Result<Command, Fault>> for Answer {
    /// A law's answer; after a fault the safe command of no thrust and no rotation.
    fn from(answer: Result<Command, Fault>) -> Self {
        let command = answer.unwrap_or_default();
        Self {
            thrust: command.thrust,
            rate: command.rate,
            report: Report::Law(answer),
        }
    }
}

impl From<PlanarGuidanceOutput> for Answer {
    fn from(guided: PlanarGuidanceOutput) -> Self {
        Self {
            thrust: guided.command.thrust,
            rate: guided.command.rate,
            report: Report::Guidance(guided),
        }
    }
}

impl Answer {
    /// What the guidance reports, if it flies.
    pub fn guided(&self) -> Option<&PlanarGuidanceOutput> {
        match &self.report {
            Report::Guidance(guided) => Some(guided),
            _ => None,
        }
    }

    /// The fault, if a law ended in one.
    pub fn fault(&self) -> Option<Fault> {
        match self.report {
            Report::Law(answer) => answer.err(),
            _ => None,
        }
    }

    /// The law's diagnostics; zero after a fault, and while the guidance does not fly its law.
    pub fn diagnostics(&self) -> Option<Diagnostics> {
        match self.report {
            Report::Law(answer) => Some(answer.unwrap_or_default().diagnostics),
            Report::Guidance(guided) => Some(guided.command.diagnostics),
            Report::Outside => None,
        }
    }

    /// The law's diagnostics of a step in which it was flown.
    pub fn flown(&self) -> Option<&Diagnostics> {
        match &self.report {
            Report::Law(Ok(command)) => Some(&command.diagnostics),
            Report::Guidance(guided) if guided.mode == Mode::Flying => {
                Some(&guided.command.diagnostics)
            }
            _ => None,
        }
    }

    /// The controller's mode, if it has several.
    pub fn mode(&self) -> Option<&'static str> {
        match &self.report {
            Report::Law(_) | Report::Outside => None,
            Report::Guidance(guided) => Some(guided.mode.name()),
        }
    }

    /// What of the air the guidance uses.
    pub fn air(&self) -> Option<&'static str> {
        Some(self.guided()?.air.name())
    }

    /// `ok` or a law's fault; the guidance's flags.
    pub fn status(&self) -> Option<Cow<'static, str>> {
        match &self.report {
            Report::Law(answer) => Some(answer.map_or_else(Fault::name, |_| "ok").into()),
            Report::Guidance(guided) => Some(guided.status.to_string().into()),
            Report::Outside => None,
        }
    }
}

/// A controller with what it remembers between steps.
pub trait Controller {
    /// The answer to `input`, `dt` \[s\] after the last. The error is a controller that cannot be reached.
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer>;

    /// Flips a bit of what it remembers: the one of this number, counted through its memory again and again.
    fn flip(&mut self, _bit: u64) {}
}

/// What an experiment says of its controller. Fields in errors are those of the controller's own table.
pub trait Spec {
    /// The controller of `experiment` at power-on.
    fn controller(&self, experiment: &Experiment) -> Result<Box<dyn Controller>, FieldError>;

    /// What it believes about the vehicle, if that is not the vehicle of the experiment.
    fn belief(&self) -> Option<&VehicleSpec> {
        None
    }

    /// The gains of its law, for the linear analysis.
    fn gains(&self, _belief: &VehicleSpec) -> Option<LoopGains> {
        None
    }

    /// Whether it is told the measured air acceleration and the reference's jerk.
    fn feed_forward(&self) -> bool {
        false
    }

    /// What the controller of `experiment` is made of on a target, if it is one of the core's.
    fn configuration(
        &self,
        _experiment: &Experiment,
        _pacing: Pacing,
    ) -> Result<Configuration, FieldError> {
        let problem = "is not a controller of the core: the image does not hold it";
        Err(FieldError::new("", problem))
    }
}

/// A kind of controller.
#[derive(Debug)]
pub struct Kind {
    /// Its table under `[controller]`.
    pub name: &'static str,
    /// What it is, in one line.
    pub meaning: &'static str,
    /// Whether it has a belief about the vehicle.
    pub believes: bool,
    /// Reads its table.
    pub read: fn(Value) -> Result<Box<dyn Spec>, FieldError>,
}

/// Every kind. The first is flown if an experiment names none.
pub const KINDS: &[Kind] = &[guidance::KIND, law::KIND];

/// `[controller.KIND]`: exactly one.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Index in [`KINDS`].
    kind: usize,
    table: Value,
}

impl Default for Choice {
    fn default() -> Self {
        Self {
            kind: 0,
            table: Value::Table(Table::new()),
        }
    }
}

impl<'de> Deserialize<'de> for Choice {
    fn deserialize<D: de::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut given = Table::deserialize(deserializer)?.into_iter();
        let names = || KINDS.iter().map(|kind| kind.name).collect::<Vec<_>>();
        let (Some((name, table)), None) = (given.next(), given.next()) else {
            let names = names().join(", ");
            return Err(de::Error::custom(format!("must be exactly one of {names}")));
        };
        let kind = KINDS.iter().position(|kind| kind.name == name);
        let unknown = || {
            let names = names().join(", ");
            de::Error::custom(format!("{name} is none of {names}"))
        };
        Ok(Self {
            kind: kind.ok_or_else(unknown)?,
            table,
        })
    }
}

impl Choice {
    /// The kind's name.
    pub fn name(&self) -> &'static str {
        KINDS[self.kind].name
    }

    /// Whether the controller has a belief about the vehicle.
    pub fn believes(&self) -> bool {
        KINDS[self.kind].believes
    }

    /// Where the table stands in the document.
    pub fn path(&self) -> String {
        format!("controller.{}", self.name())
    }

    /// What the table says.
    pub fn spec(&self) -> Result<Box<dyn Spec>, FieldError> {
        (KINDS[self.kind].read)(self.table.clone()).map_err(|e| e.inside(&self.path()))
    }
}

/// `v` as the core takes it.
pub fn inertial(v: Vector) -> Inertial {
    Inertial::new(v.x as f32, v.y as f32)
}

/// `v` as the plant takes it.
pub fn vector(v: Inertial) -> Vector {
    Vector::new(v.down().into(), v.forward().into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exactly_one_known_controller_is_chosen() {
        let read = |text: &str| Choice::deserialize(text.parse::<Table>().unwrap());
        assert_eq!(read("[law]").unwrap().name(), "law");
        let error = |text: &str| read(text).unwrap_err().to_string();
        assert!(error("").contains("exactly one of guidance, law"));
        assert!(error("[law]\n[guidance]").contains("exactly one of"));
        assert!(error("[autopilot]").contains("autopilot is none of guidance, law"));
        assert_eq!(Choice::default().name(), "guidance");
    }

    #[test]
    fn the_wind_follows_from_what_is_told() {
        let mut input = Input {
            theta: 0.0,
            sample: PlanarGuidanceInput::default(),
            feed_forward: None,
        };
        input.sample.velocity = Inertial::new(1.0, 12.0);
        let mut wind = |air| {
            input.sample.air = air;
            input.wind()
        };
        let expected = Inertial::new(1.0, -3.0);
        assert_eq!(wind(Air::Velocity(Inertial::new(0.0, 15.0))), expected);
        assert_eq!(wind(Air::Wind(expected)), expected);
        assert_eq!(wind(Air::Unknown), Inertial::ZERO);
    }
}
