//! Controllers: whoever closes the loop of an experiment.
//!
//! A controller answers one [`Input`] per control step. What an experiment says of it is a [`Spec`], read from the table
//! `[controller.KIND]`; [`KINDS`] has one row per kind. To add one: its file, and its row.

mod guidance;
mod law;
mod plans;

use std::borrow::Cow;

use alula::Fault;
use alula::guidance::{Candidate, Mode};
use alula::ned::{BodyRates, Ned};
use alula::planar::{Command, Diagnostics};
use alula::spatial::{FeedForward, Orientation};
use alula::{GuidanceInput, GuidanceOutput};
use alula_link::{Configuration, Pacing};
use toml::Value;

pub use guidance::GuidanceSpec;
pub use law::{Form, Law, LawSpec, Planar};
pub use plans::PlanSpec;

use crate::experiment::{ControllerSpec, Experiment, FieldError, VehicleSpec};
use crate::margins::LoopGains;

/// What a controller is told at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input {
    /// State, air and reference, as the core's guidance takes them.
    pub sample: GuidanceInput,
    /// Air acceleration and the reference's jerk, if the controller is flown with feed-forward.
    pub feed_forward: Option<FeedForward>,
}

impl Input {
    /// The wind \[m/s\] told to the controller, directly or by an air velocity; none if the air is unknown.
    pub fn wind(&self) -> Ned {
        self.sample
            .air
            .wind(self.sample.velocity)
            .unwrap_or_default()
    }
}

/// A controller's command, and what it reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Thrust T \[N\].
    pub thrust: f32,
    /// Body rates \[rad/s\].
    pub rates: BodyRates,
    /// What else it says.
    pub report: Report,
}

/// What a controller reports besides its command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Report {
    /// One of the bare laws: a command, or the fault for which the safe command was flown.
    Law(Result<Command, Fault>),
    /// The guidance.
    Guidance(GuidanceOutput),
    /// Someone who reports nothing.
    Outside,
}

impl From<Result<Command, Fault>> for Answer {
    /// A law's answer; after a fault the safe command of no thrust and no rotation.
    fn from(answer: Result<Command, Fault>) -> Self {
        let command = answer.unwrap_or_default();
        Self {
            thrust: command.thrust,
            rates: BodyRates::new(0.0, command.rate, 0.0),
            report: Report::Law(answer),
        }
    }
}

impl From<GuidanceOutput> for Answer {
    fn from(guided: GuidanceOutput) -> Self {
        Self {
            thrust: guided.command.thrust,
            rates: guided.command.rates,
            report: Report::Guidance(guided),
        }
    }
}

impl Answer {
    /// What the guidance reports, if it flies.
    pub fn guided(&self) -> Option<&GuidanceOutput> {
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
            Report::Guidance(guided) => Some(guided.command.diagnostics.plane),
            Report::Outside => None,
        }
    }

    /// The law's diagnostics of a step in which it was flown.
    pub fn diagnostics_flying(&self) -> Option<&Diagnostics> {
        match &self.report {
            Report::Law(Ok(command)) => Some(&command.diagnostics),
            Report::Guidance(guided) if guided.mode == Mode::Flying => {
                Some(&guided.command.diagnostics.plane)
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
pub trait Controller: Send {
    /// The answer to `input`, `dt` \[s\] after the last. The error is a controller that cannot be reached.
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer>;

    /// Takes over a vehicle that flies already, at this orientation, with this thrust \[N\] and these rates commanded last.
    fn take_over(&mut self, _orientation: &Orientation, _thrust: f32, _rates: BodyRates) {}

    /// How fast a path that waits may go on, in multiples of its own speed, at `error` \[m\] from where it moves at `velocity` \[m/s\].
    fn time_scale(&self, _error: Ned, _velocity: Ned) -> f32 {
        1.0
    }

    /// The attitude θ \[rad\] of the reference model that it flies ahead of the vehicle, in the plane of flight, if it flies one.
    fn model_theta(&self) -> Option<f32> {
        None
    }

    /// The plans that it looked at in the last step, in this order; nothing if it made none.
    fn candidates(&self) -> &[Candidate] {
        &[]
    }

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

impl ControllerSpec {
    /// The row of its kind.
    fn row(&self) -> Result<&'static Kind, FieldError> {
        let row = KINDS.iter().find(|kind| kind.name == self.kind);
        row.ok_or_else(|| {
            let names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
            let problem = format!("{} is none of {}", self.kind, names.join(", "));
            FieldError::new("controller", problem)
        })
    }

    /// What its table says.
    pub fn spec(&self) -> Result<Box<dyn Spec>, FieldError> {
        (self.row()?.read)(self.table.clone()).map_err(|e| e.inside(&self.path()))
    }

    /// Whether the controller has a belief about the vehicle.
    pub fn believes(&self) -> bool {
        self.row().is_ok_and(|kind| kind.believes)
    }
}

impl Experiment {
    /// What the experiment says of its controller.
    pub fn spec(&self) -> Result<Box<dyn Spec>, FieldError> {
        self.controller.spec()
    }

    /// The controller, at power-on.
    pub fn controller(&self) -> Result<Box<dyn Controller>, FieldError> {
        let made = self.spec()?.controller(self);
        made.map_err(|e| e.inside(&self.controller.path()))
    }

    /// What its controller is made of on a target.
    pub fn configuration(&self, pacing: Pacing) -> Result<Configuration, FieldError> {
        let configuration = self.spec()?.configuration(self, pacing);
        configuration.map_err(|e| e.inside(&self.controller.path()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Document;
    use alula::guidance::Air;

    #[test]
    fn exactly_one_known_controller_is_chosen() {
        let error = |text: &str| {
            let mut document = Document::load("round-trip").unwrap();
            let value = text.parse::<toml::Table>().unwrap();
            document.set("controller", Value::Table(value)).unwrap();
            document.experiment().unwrap_err().to_string()
        };
        assert!(error("").starts_with("controller: must be exactly one"));
        assert!(error("[law]\n[guidance]").starts_with("controller: must be exactly one"));
        assert!(error("[autopilot]").contains("autopilot is none of guidance, law"));
        assert_eq!(KINDS[0].name, ControllerSpec::default().kind);
    }

    #[test]
    fn the_wind_follows_from_what_is_told() {
        let mut input = Input {
            sample: GuidanceInput::default(),
            feed_forward: None,
        };
        input.sample.velocity = Ned::new(12.0, 2.0, 1.0);
        let mut wind = |air| {
            input.sample.air = air;
            input.wind()
        };
        let expected = Ned::new(-3.0, 1.0, 1.0);
        assert_eq!(wind(Air::Velocity(Ned::new(15.0, 1.0, 0.0))), expected);
        assert_eq!(wind(Air::Wind(expected)), expected);
        assert_eq!(wind(Air::Unknown), Ned::default());
    }
}
