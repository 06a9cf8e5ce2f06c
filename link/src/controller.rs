//! The controller that a configuration describes: the same code on the target and on its host.

use alula::planar::{Body, GainParameters, Gains, VelocityControl};
use alula::{
    BandwidthGains, BodyRates, GainChoice, Guidance, GuidanceParameters, Hardened, HardenedState,
    Model, ParameterError, Parameters, Vehicle,
};

use crate::{Answer, Configuration, ControllerParameters, InForce, Input, Law, LawGains};

/// One of the core's controllers, with its memory.
#[derive(Clone, Debug, PartialEq)]
// There is one, in place: a box would need a heap.
#[allow(clippy::large_enum_variant)]
pub enum Controller {
    /// A law.
    Law {
        /// Which.
        law: Law,
        /// With its vehicle and gains.
        control: VelocityControl<Model<'static>, GainChoice>,
        /// Upward part of the nose's direction when it flew last, 0 to 1; 0 before it has flown.
        upright: f32,
    },
    /// The guidance, and its state.
    Guidance(
        Hardened<Guidance<Model<'static>, GainChoice>>,
        HardenedState,
    ),
}

impl Controller {
    /// The controller that `configuration` describes, at power-on.
    ///
    /// # Errors
    /// A parameter that the core refuses.
    pub fn new(configuration: &Configuration) -> Result<Self, ParameterError> {
        let vehicle = Vehicle::new(configuration.vehicle, configuration.model.model()?)?;
        let constant = |p: GainParameters| Gains::new(p).map(GainChoice::Constant);
        Ok(match &configuration.controller {
            ControllerParameters::Law { law, gains } => {
                let gains = match gains {
                    LawGains::Constant(p) => constant(*p)?,
                    LawGains::Bandwidth(p) => {
                        GainChoice::Bandwidth(BandwidthGains::new(p, &vehicle)?)
                    }
                };
                Self::Law {
                    law: *law,
                    control: VelocityControl::new(vehicle, gains),
                    upright: 0.0,
                }
            }
            ControllerParameters::Guidance { parameters, gains } => {
                let gains = match gains {
                    Some(p) => constant(*p)?,
                    None => GainChoice::Bandwidth(BandwidthGains::new(parameters, &vehicle)?),
                };
                let guidance = Guidance::with_gains(vehicle, gains, parameters)?;
                Self::Guidance(Hardened::new(guidance), HardenedState::default())
            }
        })
    }

    /// Whether it flies inputs of this kind.
    pub fn takes(&self, input: &Input) -> bool {
        matches!(
            (self, input),
            (Self::Law { .. }, Input::Law { .. }) | (Self::Guidance(..), Input::Guidance { .. })
        )
    }

    /// One control step.
    pub fn step(&mut self, input: &Input) -> Answer {
        match (self, input) {
            (
                Self::Law {
                    law,
                    control,
                    upright,
                },
                Input::Law {
                    state,
                    reference,
                    feed_forward,
                },
            ) => {
                let feed_forward = feed_forward.as_ref();
                let command = match law {
                    Law::Robust => control.robust(state, reference, feed_forward),
                    Law::Full => control.full(state, reference, feed_forward),
                };
                if command.is_ok() {
                    let tail = state.attitude.to_inertial(Body::new(1.0, 0.0));
                    *upright = tail.down().clamp(0.0, 1.0);
                }
                Answer::Law(command)
            }
            (Self::Guidance(guidance, state), Input::Guidance { input, dt }) => {
                let output = guidance.update(state, input, *dt);
                if output.plan_due {
                    guidance.plan(state);
                }
                Answer::Guidance(output)
            }
            _ => Answer::WrongInput,
        }
    }

    /// What is flown without inputs: no rotation, and a thrust at which the vehicle sinks slowly in hover and glides in cruise;
    /// none before the first step. The guidance's is [`Guidance::safe_thrust`]; a law's is the same by the default parameters.
    pub fn safe(&self) -> InForce {
        let thrust = match self {
            Self::Law {
                control, upright, ..
            } => {
                let vehicle = control.vehicle();
                let thrust = GuidanceParameters::DEFAULT.safe_thrust * vehicle.weight() * upright;
                thrust.max(vehicle.thrust_min()).min(vehicle.thrust_max())
            }
            Self::Guidance(guidance, state) => guidance.safe_thrust(state),
        };
        let rates = BodyRates::default();
        InForce { thrust, rates }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pacing;
    use alula::guidance::Air;
    use alula::planar::{Attitude, Inertial, PlanarGuidanceInput, Reference, State};
    use alula::{
        Combined, CombinedParameters, GuidanceInput, GuidanceParameters, GuidanceState, LargeAngle,
        LargeAngleParameters, ModelParameters, Parameters, Problem, SmallAngle,
        SmallAngleParameters, VehicleParameters,
    };

    const LAW: ControllerParameters = ControllerParameters::Law {
        law: Law::Full,
        gains: LawGains::Constant(GainParameters::PAPER),
    };

    fn configuration(model: ModelParameters, controller: ControllerParameters) -> Configuration {
        Configuration {
            vehicle: VehicleParameters::PAPER_BELIEF,
            model,
            controller,
            pacing: Pacing::Timer,
        }
    }

    #[test]
    fn every_model_makes_the_law_that_the_core_makes() {
        let combined = CombinedParameters::PAPER_BELIEF;
        let large = LargeAngleParameters { c0: 0.01, c1: 0.9 };
        let small = SmallAngleParameters {
            c0: 0.01,
            c2: 5.0,
            c3: 0.3,
        };
        for (parameters, model) in [
            (
                ModelParameters::Combined(combined),
                Model::Combined(Combined::new(combined).unwrap()),
            ),
            (
                ModelParameters::LargeAngle(large),
                Model::LargeAngle(LargeAngle::new(large).unwrap()),
            ),
            (
                ModelParameters::SmallAngle(small),
                Model::SmallAngle(SmallAngle::new(small).unwrap()),
            ),
        ] {
            let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model).unwrap();
            let gains = GainChoice::Constant(Gains::new(GainParameters::PAPER).unwrap());
            assert_eq!(
                Controller::new(&configuration(parameters, LAW)),
                Ok(Controller::Law {
                    law: Law::Full,
                    control: VelocityControl::new(vehicle, gains),
                    upright: 0.0,
                })
            );
        }
    }

    fn combined(controller: ControllerParameters) -> Configuration {
        configuration(
            ModelParameters::Combined(CombinedParameters::PAPER_BELIEF),
            controller,
        )
    }

    fn input() -> GuidanceInput {
        (&PlanarGuidanceInput::default()
            .velocity(Inertial::new(0.5, 4.0))
            .attitude(Attitude::from_angle(-0.3))
            .air(Air::Wind(Inertial::new(0.1, -1.0)))
            .position_error(Inertial::new(0.2, 0.3))
            .reference(Reference {
                velocity: Inertial::new(0.0, 5.0),
                acceleration: Inertial::new(0.0, 1.0),
            }))
            .into()
    }

    #[test]
    fn the_guidance_flies_as_in_the_core_and_keeps_its_memory() {
        let parameters = GuidanceParameters::DEFAULT;
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model).unwrap();
        let step_of = |gains: Option<GainParameters>| {
            let mut linked = Controller::new(&combined(ControllerParameters::Guidance {
                parameters,
                gains,
            }))
            .unwrap();
            let (mut own, mut held) = (GuidanceState::default(), GuidanceState::default());
            let bandwidth = Guidance::new(vehicle, &parameters).unwrap();
            let constant = Guidance::with_gains(
                vehicle,
                Gains::new(GainParameters::PAPER).unwrap(),
                &parameters,
            )
            .unwrap();
            for n in 0..40 {
                let input = input();
                let want = match gains {
                    None => bandwidth.update(&mut own, &input, 0.01),
                    Some(_) => constant.update(&mut held, &input, 0.01),
                };
                if want.plan_due {
                    match gains {
                        None => bandwidth.plan(&mut own),
                        Some(_) => constant.plan(&mut held),
                    }
                }
                let got = linked.step(&Input::Guidance { input, dt: 0.01 });
                assert_eq!(got, Answer::Guidance(want), "{n}");
            }
        };
        step_of(None);
        step_of(Some(GainParameters::PAPER));
    }

    #[test]
    fn a_law_may_have_gains_by_bandwidth() {
        let gains = LawGains::Bandwidth(GuidanceParameters::DEFAULT);
        let law = Law::Robust;
        let mut linked =
            Controller::new(&combined(ControllerParameters::Law { law, gains })).unwrap();
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model).unwrap();
        let gains = BandwidthGains::new(&GuidanceParameters::DEFAULT, &vehicle).unwrap();
        let (state, reference) = (
            State {
                velocity: Inertial::new(0.5, 4.0),
                ..State::default()
            },
            Reference::default(),
        );
        let want = VelocityControl::new(vehicle, gains).robust(&state, &reference, None);
        let input = Input::Law {
            state,
            reference,
            feed_forward: None,
        };
        assert_eq!(linked.step(&input), Answer::Law(want));
    }

    #[test]
    fn an_input_of_the_other_kind_is_not_flown() {
        let mut law = Controller::new(&combined(LAW)).unwrap();
        let guidance = Input::Guidance {
            input: input(),
            dt: 0.01,
        };
        assert_eq!(law.step(&guidance), Answer::WrongInput);
        assert!(!law.takes(&guidance));
        assert_eq!(law.safe(), InForce::default());
        let parameters = GuidanceParameters::DEFAULT;
        let configured = combined(ControllerParameters::Guidance {
            parameters,
            gains: None,
        });
        let mut guided = Controller::new(&configured).unwrap();
        let before = guided.clone();
        let law = Input::Law {
            state: State::default(),
            reference: Reference::default(),
            feed_forward: None,
        };
        assert_eq!(guided.step(&law), Answer::WrongInput);
        assert!(!guided.takes(&law) && guided.takes(&guidance));
        assert_eq!(guided, before);
    }

    #[test]
    fn what_the_core_refuses_is_named() {
        let mut heavy = combined(LAW);
        heavy.vehicle.mass = f32::NAN;
        let error = Controller::new(&heavy).unwrap_err();
        assert_eq!(
            (error.parameter, error.problem),
            ("mass", Problem::NotFinite)
        );
        // A contradiction between the vehicle and the guidance.
        let parameters = GuidanceParameters::DEFAULT.safe_thrust(100.0);
        let unsafe_thrust = combined(ControllerParameters::Guidance {
            parameters,
            gains: None,
        });
        let error = Controller::new(&unsafe_thrust).unwrap_err();
        assert_eq!(error.parameter, "safe_thrust");
    }
}
