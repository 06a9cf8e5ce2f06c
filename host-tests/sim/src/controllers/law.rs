//! `[controller.law]`: one of the paper's laws, bare.
//!
//! The laws work in a vertical plane. [`Planar`] is what they are told: the input in the plane that the right wing is square to.

use alula::ned::Ned;
use alula::planar::{
    Attitude, FeedForward, GainParameters, Inertial, Reference, State, VelocityControl,
};
use alula::{BandwidthGains, GainChoice, GuidanceParameters};
use alula_link::{Configuration, ControllerParameters, LawGains, Pacing};
use serde::Deserialize;
use toml::Value;

use super::{Answer, Controller, Input, Kind, Spec};
use crate::experiment::{
    Experiment, FieldError, Fields, Model, NO_LIMITS, Vehicle, VehicleSpec, refused,
};
use crate::margins::LoopGains;

/// The row in the list of controllers.
pub const KIND: Kind = Kind {
    name: "law",
    meaning: "one of the paper's laws, bare",
    believes: true,
    read: |table| Ok(Box::new(LawSpec::read(table)?)),
};

/// Which law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// `eq:inputsVCeR`.
    #[default]
    Robust,
    /// `lawsVGen`.
    Full,
}

/// `[controller.law]`.
#[derive(Clone, Debug, PartialEq)]
pub struct LawSpec {
    /// Which law.
    pub form: Form,
    /// Whether the law is given the measured air acceleration and the reference's jerk.
    pub feed_forward: bool,
    /// What the controller believes about the vehicle; the experiment's vehicle if left out.
    pub vehicle: Option<VehicleSpec>,
    /// Constant gains.
    pub gains: GainParameters,
    /// Gains by bandwidth in their place, by the guidance's parameters of that name.
    pub bandwidth: Option<GuidanceParameters>,
}

/// A law in this process.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// The law's parameters.
    pub control: VelocityControl<Model, GainChoice>,
    /// Which.
    pub form: Form,
}

impl LawSpec {
    /// What the table says.
    pub fn read(table: Value) -> Result<Self, FieldError> {
        let mut fields = Fields::new(table)?;
        let spec = Self {
            form: fields.take("form")?.unwrap_or_default(),
            feed_forward: fields.take("feed_forward")?.unwrap_or_default(),
            vehicle: fields.belief()?,
            gains: fields.inner("gains")?.unwrap_or(GainParameters::PAPER),
            bandwidth: fields.inner("bandwidth")?,
        };
        fields.end()?;
        Ok(spec)
    }

    /// The law of `experiment`.
    pub fn law(&self, experiment: &Experiment) -> Result<Law, FieldError> {
        let belief = self.vehicle.as_ref().unwrap_or(&experiment.vehicle);
        let vehicle = belief.core().map_err(|e| e.inside("vehicle"))?;
        self.build(vehicle)
    }

    /// The law of what is believed to be `vehicle`.
    pub fn build(&self, vehicle: Vehicle) -> Result<Law, FieldError> {
        let gains = match &self.bandwidth {
            Some(p) => GainChoice::Bandwidth(
                BandwidthGains::new(p, &vehicle)
                    .map_err(|e| refused::<GuidanceParameters>(e).inside("bandwidth"))?,
            ),
            None => GainChoice::Constant(
                alula::planar::Gains::new(self.gains)
                    .map_err(|e| refused::<GainParameters>(e).inside("gains"))?,
            ),
        };
        Ok(Law {
            control: VelocityControl::new(vehicle, gains),
            form: self.form,
        })
    }
}

impl Spec for LawSpec {
    fn controller(&self, experiment: &Experiment) -> Result<Box<dyn Controller>, FieldError> {
        Ok(Box::new(self.law(experiment)?))
    }

    fn belief(&self) -> Option<&VehicleSpec> {
        self.vehicle.as_ref()
    }

    fn gains(&self, belief: &VehicleSpec) -> Option<LoopGains> {
        Some(match &self.bandwidth {
            Some(p) => LoopGains::by_bandwidth(p, belief.weight()),
            None => LoopGains::of(&self.gains),
        })
    }

    fn feed_forward(&self) -> bool {
        self.feed_forward
    }

    fn configuration(
        &self,
        experiment: &Experiment,
        pacing: Pacing,
    ) -> Result<Configuration, FieldError> {
        let belief = self.vehicle.as_ref().unwrap_or(&experiment.vehicle);
        Ok(Configuration {
            vehicle: belief.parameters(NO_LIMITS),
            model: belief.model_parameters().map_err(|e| e.inside("vehicle"))?,
            controller: ControllerParameters::Law {
                law: match self.form {
                    Form::Robust => alula_link::Law::Robust,
                    Form::Full => alula_link::Law::Full,
                },
                gains: match self.bandwidth {
                    Some(p) => LawGains::Bandwidth(p),
                    None => LawGains::Constant(self.gains),
                },
            },
            pacing,
        })
    }
}

/// What a law is told, in one vertical plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planar {
    /// Velocity, attitude and wind.
    pub state: State,
    /// What is to be flown.
    pub reference: Reference,
    /// Air acceleration and jerk, if they are told.
    pub feed_forward: Option<FeedForward>,
}

impl From<&Input> for Planar {
    /// The plane is the vertical one that the right wing is square to: it holds the nose of an unbanked vehicle at any pitch.
    fn from(input: &Input) -> Self {
        let orientation = &input.sample.orientation;
        let (tail, wing) = (-orientation.forward(), orientation.right());
        // Of a wing that is level to the east this is the north, exactly.
        let length = (wing.east * wing.east + wing.north * wing.north).sqrt();
        // The north stands for the plane of a wing that points up or down, or is not known.
        let ahead = match length > 0.1 {
            true => Ned::new(wing.east / length, -wing.north / length, 0.0),
            false => Ned::new(1.0, 0.0, 0.0),
        };
        let within = |v: Ned| Inertial::new(v.down, ahead.north * v.north + ahead.east * v.east);
        let theta = within(tail);
        Self {
            state: State {
                velocity: within(input.sample.velocity),
                attitude: Attitude {
                    cos: theta.down(),
                    sin: theta.forward(),
                },
                wind: within(input.wind()),
            },
            reference: Reference {
                velocity: within(input.sample.reference.velocity),
                acceleration: within(input.sample.reference.acceleration),
            },
            feed_forward: input.feed_forward.map(|f| FeedForward {
                air_acceleration: within(f.air_acceleration),
                jerk: within(f.jerk),
            }),
        }
    }
}

impl Controller for Law {
    fn answer(&mut self, input: &Input, _: f32) -> anyhow::Result<Answer> {
        let Planar {
            state,
            reference,
            feed_forward,
        } = input.into();
        let forward = feed_forward.as_ref();
        Ok(match self.form {
            Form::Robust => self.control.robust(&state, &reference, forward),
            Form::Full => self.control.full(&state, &reference, forward),
        }
        .into())
    }
}
