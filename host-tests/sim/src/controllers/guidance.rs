//! `[controller.guidance]`: the core's whole guidance. Its parameters stand in the core's own table.

use alula::guidance::Candidate;
use alula::ned::{BodyRates, Ned};
use alula::planar::{GainParameters, Gains};
use alula::spatial::Orientation;
use alula::{
    BandwidthGains, GainChoice, Guidance, GuidanceParameters, GuidanceState, Hardened,
    HardenedState, ParameterError, Parameters as _, ResponseParameters, Tuning, VehicleParameters,
};
use alula_link::{Configuration, ControllerParameters, Pacing};
use toml::Value;

use super::plans::{PlanSpec, PlanTask};
use super::{Answer, Controller, Input, Kind, Spec};
use crate::experiment::{
    Experiment, FaultKind, FieldError, Fields, Model, NO_LIMITS, VehicleSpec, refused, require,
};
use crate::margins::LoopGains;

/// The row in the list of controllers.
pub const KIND: Kind = Kind {
    name: "guidance",
    meaning: "the core's whole guidance",
    believes: true,
    read: |table| Ok(Box::new(GuidanceSpec::read(table)?)),
};

/// `[controller.guidance]`.
#[derive(Clone, Debug, PartialEq)]
pub struct GuidanceSpec {
    /// What the controller believes about the vehicle; the experiment's vehicle if left out.
    pub vehicle: Option<VehicleSpec>,
    /// Least and most thrust that it commands \[N\]; what the motors give if left out.
    pub thrust_n: Option<[f64; 2]>,
    /// Constant gains, in place of those by bandwidth.
    pub gains: Option<GainParameters>,
    /// The parameters: those given, and all others at their defaults.
    pub parameters: GuidanceParameters,
    /// From which those that are not given follow by the core's rules, in place of the defaults.
    pub response: Option<ResponseParameters>,
    /// Constants of planner and reference model, those that are not given as they were found.
    pub tuning: Option<Tuning>,
    /// When plans come.
    pub plans: PlanSpec,
    /// Which are given, by their rows.
    given: Vec<usize>,
}

impl GuidanceSpec {
    /// What the table says.
    pub fn read(table: Value) -> Result<Self, FieldError> {
        let mut fields = Fields::new(table)?;
        let spec = Self {
            vehicle: fields.belief()?,
            thrust_n: fields.take("thrust_n")?,
            gains: fields.inner("gains")?,
            response: fields.inner("for_vehicle")?,
            tuning: fields.inner("tuning")?,
            plans: fields.take("plans")?.unwrap_or_default(),
            given: fields.given::<GuidanceParameters>(),
            parameters: fields.parameters()?,
        };
        fields.end()?;
        if let Some([least, most]) = spec.thrust_n {
            require(least < most, "thrust_n", "must be [least, most]")?;
        }
        Ok(spec)
    }

    /// The guidance of `experiment`.
    pub fn of(experiment: &Experiment) -> Result<Self, FieldError> {
        let spec = &experiment.controller;
        match spec.kind == KIND.name {
            true => Self::read(spec.table.clone()),
            false => Err(FieldError::new("controller", "is not the guidance")),
        }
    }

    /// The parameters for `vehicle`, where `unruled` are those without the rules. The rules leave `max_lateral_acceleration` alone.
    pub fn ruled(
        &self,
        vehicle: &VehicleParameters,
        unruled: &GuidanceParameters,
    ) -> Result<GuidanceParameters, FieldError> {
        let Some(response) = &self.response else {
            return Ok(*unruled);
        };
        let ruled = GuidanceParameters::for_vehicle(vehicle, response);
        let mut ruled = ruled.map_err(refused::<ResponseParameters>)?;
        for row in &self.given {
            ruled.set(*row, unruled.get(*row));
        }
        ruled.max_lateral_acceleration = unruled.max_lateral_acceleration;
        Ok(ruled)
    }

    /// The parameters for `experiment`, before the rules: in a vertical plane nothing turns out of it.
    fn for_flight(&self, experiment: &Experiment) -> GuidanceParameters {
        let mut parameters = self.parameters;
        if experiment.in_plane() {
            parameters.max_lateral_acceleration = 0.0;
        }
        parameters
    }

    /// The guidance of `experiment`.
    pub fn guidance(
        &self,
        experiment: &Experiment,
    ) -> Result<Guidance<Model, GainChoice>, FieldError> {
        let belief = self.vehicle.as_ref().unwrap_or(&experiment.vehicle);
        let thrust = experiment.thrust_limits(self.thrust_n, belief.weight());
        self.build(belief, thrust, &self.for_flight(experiment))
    }

    /// The guidance of a vehicle that is believed to be `belief`, with `thrust` \[N\] (least, most).
    pub fn build(
        &self,
        belief: &VehicleSpec,
        thrust: [f64; 2],
        parameters: &GuidanceParameters,
    ) -> Result<Guidance<Model, GainChoice>, FieldError> {
        let vehicle = belief.limited(thrust).map_err(|e| e.inside("vehicle"))?;
        let parameters = &self.ruled(&belief.parameters(thrust), parameters)?;
        let under = |e: ParameterError| refused::<GuidanceParameters>(e);
        let gains = match self.gains {
            Some(p) => GainChoice::Constant(Gains::new(p).map_err(refused::<GainParameters>)?),
            None => {
                let gains = BandwidthGains::new(parameters, &vehicle);
                GainChoice::Bandwidth(gains.map_err(under)?)
            }
        };
        let tuning = self.tuning.unwrap_or_default();
        Guidance::with_tuning(vehicle, gains, parameters, &tuning).map_err(under)
    }
}

impl Spec for GuidanceSpec {
    fn controller(&self, experiment: &Experiment) -> Result<Box<dyn Controller>, FieldError> {
        let guidance = self.guidance(experiment)?;
        let faults = &experiment.sensors.faults;
        Ok(
            if faults
                .iter()
                .any(|fault| fault.kind == FaultKind::MemoryBit)
            {
                Box::new(HardenedFlight {
                    guidance: Hardened::new(guidance),
                    state: HardenedState::default(),
                    plans: PlanTask::new(self.plans),
                })
            } else {
                Box::new(Flight {
                    guidance,
                    state: GuidanceState::default(),
                    plans: PlanTask::new(self.plans),
                })
            },
        )
    }

    fn belief(&self) -> Option<&VehicleSpec> {
        self.vehicle.as_ref()
    }

    fn gains(&self, belief: &VehicleSpec) -> Option<LoopGains> {
        Some(match &self.gains {
            Some(gains) => LoopGains::of(gains),
            None => {
                let parameters = self.ruled(&belief.parameters(NO_LIMITS), &self.parameters);
                let parameters = parameters.ok()?;
                LoopGains::by_bandwidth(&parameters, belief.weight())
            }
        })
    }

    fn configuration(
        &self,
        experiment: &Experiment,
        pacing: Pacing,
    ) -> Result<Configuration, FieldError> {
        let belief = self.vehicle.as_ref().unwrap_or(&experiment.vehicle);
        let thrust = experiment.thrust_limits(self.thrust_n, belief.weight());
        let vehicle = belief.parameters(thrust);
        Ok(Configuration {
            vehicle,
            model: belief.model_parameters().map_err(|e| e.inside("vehicle"))?,
            controller: ControllerParameters::Guidance {
                parameters: self.ruled(&vehicle, &self.for_flight(experiment))?,
                gains: self.gains,
            },
            pacing,
        })
    }
}

/// The guidance with its state.
struct Flight {
    guidance: Guidance<Model, GainChoice>,
    state: GuidanceState,
    plans: PlanTask,
}

impl Controller for Flight {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        let guided = self.guidance.update(&mut self.state, &input.sample, dt);
        let search = || self.guidance.search(&self.state);
        let look = |search: &mut _| self.guidance.look(search);
        if let Some(search) = self.plans.after(&guided, dt, search, look) {
            self.guidance.adopt(&mut self.state, &search);
        }
        Ok(guided.into())
    }

    fn take_over(&mut self, orientation: &Orientation, thrust: f32, rates: BodyRates) {
        self.state = self.guidance.take_over(orientation, thrust, rates);
    }

    fn candidates(&self) -> &[Candidate] {
        self.plans.looked_at()
    }

    fn time_scale(&self, error: Ned, velocity: Ned) -> f32 {
        self.guidance.path_time_scale(error, velocity)
    }

    fn model_theta(&self) -> Option<f32> {
        Some(self.state.reference_model().1)
    }
}

/// The hardened guidance with its state, of which bits flip.
struct HardenedFlight {
    guidance: Hardened<Guidance<Model, GainChoice>>,
    state: HardenedState,
    plans: PlanTask,
}

impl Controller for HardenedFlight {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        let guided = self.guidance.update(&mut self.state, &input.sample, dt);
        let search = || self.guidance.search(&self.state);
        let look = |search: &mut _| self.guidance.look(search);
        if let Some(search) = self.plans.after(&guided, dt, search, look) {
            self.guidance.adopt(&mut self.state, &search);
        }
        Ok(guided.into())
    }

    fn take_over(&mut self, orientation: &Orientation, thrust: f32, rates: BodyRates) {
        self.state = self.guidance.take_over(orientation, thrust, rates);
    }

    fn candidates(&self) -> &[Candidate] {
        self.plans.looked_at()
    }

    fn time_scale(&self, error: Ned, velocity: Ned) -> f32 {
        self.guidance.guidance().path_time_scale(error, velocity)
    }

    fn flip(&mut self, bit: u64) {
        let mut bytes = self.state.to_bytes();
        let bit = bit % (8 * bytes.len() as u64);
        bytes[bit as usize / 8] ^= 1 << (bit % 8);
        self.state = HardenedState::from_bytes(&bytes);
    }
}
