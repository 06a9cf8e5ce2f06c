//! The messages. What they carry are the core's own types.

use alula::guidance::RejectReason;
use alula::ned::BodyRates;
use alula::planar::{Command, FeedForward, GainParameters, Reference, State};
use alula::spatial;
use alula::{
    Fault, GuidanceInput, GuidanceOutput, GuidanceParameters, ModelParameters, ParameterError,
    Problem, VehicleParameters,
};
use serde::{Deserialize, Serialize};

use crate::Counters;

/// A message with its session and number. An answer carries those of the message that it answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Envelope<M> {
    /// Session of the host.
    pub session: u32,
    /// Number within the session.
    pub sequence: u32,
    /// The message.
    pub message: M,
}

/// A message from the host.
// One lives at a time, and there is no heap to put the longest one on.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToTarget {
    /// What to fly. Answered by [`FromTarget::Configured`] or [`FromTarget::Refused`].
    Configure(Configuration),
    /// Input of one control step. Answered by [`FromTarget::Answer`].
    Input(Input),
    /// Answered by [`FromTarget::Status`].
    StatusRequest,
}

/// A message from the target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromTarget<'a> {
    /// The configuration is in force.
    Configured,
    /// The configuration is refused, and none is in force.
    #[serde(borrow)]
    Refused(RefusedParameter<'a>),
    /// Result of one control step.
    Answer(Answer),
    /// How the target is: on request, and unasked.
    Status(Status),
}

/// A law of the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// [`VelocityControl::robust`](alula::planar::VelocityControl::robust).
    Robust,
    /// [`VelocityControl::full`](alula::planar::VelocityControl::full).
    Full,
}

/// What releases a control step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Pacing {
    /// The target's timer: at each tick, the newest input since the last one is flown.
    Timer,
    /// The host, whose simulated time is the only clock that counts: each input is flown when it arrives.
    Lockstep,
}

/// All that a controller is made of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Configuration {
    /// The vehicle as the controller believes it to be.
    pub vehicle: VehicleParameters,
    /// Its aerodynamics as the controller believes them to be.
    pub model: ModelParameters,
    /// What flies it.
    pub controller: ControllerParameters,
    /// What releases a step.
    pub pacing: Pacing,
}

/// One of the core's controllers.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ControllerParameters {
    /// A law without anything around it. Takes [`Input::Law`].
    Law {
        /// Which.
        law: Law,
        /// Its gains.
        gains: LawGains,
    },
    /// The guidance. Takes [`Input::Guidance`].
    Guidance {
        /// Its parameters.
        parameters: GuidanceParameters,
        /// Constant gains, if its law is not to have gains by bandwidth.
        gains: Option<GainParameters>,
    },
}

/// The gains of a law.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum LawGains {
    /// Constant, as in the paper.
    Constant(GainParameters),
    /// By bandwidth: of these parameters those that [`BandwidthGains`](alula::BandwidthGains) uses.
    Bandwidth(GuidanceParameters),
}

/// The input of one control step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Input {
    /// The arguments of a law.
    Law {
        /// State of the vehicle.
        state: State,
        /// Reference.
        reference: Reference,
        /// Feed-forward, if there is.
        feed_forward: Option<FeedForward>,
    },
    /// The arguments of the guidance.
    Guidance {
        /// Measurements and reference.
        input: GuidanceInput,
        /// Time \[s\] since the last step.
        dt: f32,
    },
}

/// The result of one control step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// A law's command, or the fault for which the safe command is in force.
    Law(Result<Command, Fault>),
    /// What the guidance gives.
    Guidance(GuidanceOutput),
    /// There is no configuration to fly. No thrust is in force.
    NotConfigured,
    /// The input is of another kind than the controller takes. It was not flown.
    WrongInput,
}

/// What is in force: thrust \[N\] and body rates [rad/s]. The default is none of either: what is in force before anything has
/// flown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InForce {
    /// Thrust \[N\].
    pub thrust: f32,
    /// Body rates [rad/s].
    pub rates: BodyRates,
}

impl Answer {
    /// What this answer puts in force, and why it is not the law's, if it is not: `safe` where a law has no answer. `None` if
    /// nothing was flown.
    pub fn in_force(&self, safe: InForce) -> Option<(InForce, Option<RejectReason>)> {
        match self {
            Self::Law(Ok(command)) => {
                let rates = BodyRates::new(0.0, command.rate, 0.0);
                let thrust = command.thrust;
                Some((InForce { thrust, rates }, None))
            }
            Self::Law(Err(fault)) => Some((safe, Some(RejectReason::Law(*fault)))),
            Self::Guidance(guided) => {
                let spatial::Command { thrust, rates, .. } = guided.command;
                Some((InForce { thrust, rates }, guided.reject_reason))
            }
            Self::NotConfigured | Self::WrongInput => None,
        }
    }
}

/// Why a configuration was refused: the core's [`ParameterError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RefusedParameter<'a> {
    /// The parameter.
    pub parameter: &'a str,
    /// What was wrong with it.
    pub problem: Problem,
}

impl From<ParameterError> for RefusedParameter<'static> {
    fn from(error: ParameterError) -> Self {
        Self {
            parameter: error.parameter,
            problem: error.problem,
        }
    }
}

/// What the target is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Phase {
    /// Nothing to fly. Safe command.
    NotConfigured,
    /// Configured, no input yet. Safe command.
    Waiting,
    /// Inputs arrive and are flown.
    Flying,
    /// Inputs have stopped. Safe command, until they come back.
    LinkLost,
}

/// How the target is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status {
    /// What it is doing.
    pub phase: Phase,
    /// Thrust in force \[N\].
    pub thrust: f32,
    /// Body rates in force \[rad/s\].
    pub rates: BodyRates,
    /// Ticks of the timer since power-on.
    pub ticks: u32,
    /// How often the link was lost.
    pub losses: u32,
    /// Replies that the port did not take.
    pub dropped: u32,
    /// What was received.
    pub counters: Counters,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Counters, MAX_FRAME, Receiver, VERSION, encode};
    use alula::guidance::{Air, PlannerOptions};
    use alula::ned::{Frd, Ned};
    use alula::planar::{Body, Inertial, PlanarGuidanceInput};
    use alula::{CombinedParameters, Parameters};

    fn through_the_wire<M>(message: &M) -> M
    where
        M: Serialize + for<'a> Deserialize<'a>,
    {
        let mut buffer = [0; MAX_FRAME];
        let mut receiver = Receiver::new();
        let frame = encode(message, &mut buffer).unwrap();
        let (last, rest) = frame.split_last().unwrap();
        let counters = &mut Counters::default();
        for &byte in rest {
            assert!(receiver.push::<M>(byte, counters).is_none());
        }
        receiver.push(*last, counters).unwrap()
    }

    /// Floats that a conversion by value would not bring back: NaNs with a payload, −0, a subnormal, infinity.
    const ODD: [u32; 5] = [0x7FA0_1234, 0xFFC0_0001, 0x8000_0000, 1, 0x7F80_0000];

    #[test]
    fn floats_keep_their_bits() {
        for bits in ODD {
            let x = f32::from_bits(bits);
            let mut parameters = GuidanceParameters::DEFAULT;
            for row in 0..GuidanceParameters::ROWS.len() {
                parameters.set(row, x);
            }
            let sent = ControllerParameters::Guidance {
                parameters,
                gains: None,
            };
            let ControllerParameters::Guidance { parameters, .. } = through_the_wire(&sent) else {
                panic!();
            };
            for row in 0..GuidanceParameters::ROWS.len() {
                assert_eq!(parameters.get(row).to_bits(), bits);
            }
            let mut command = Command::default();
            command.thrust = x;
            command.diagnostics.f_p = Body::new(1.0, x);
            let Answer::Law(Ok(back)) = through_the_wire(&Answer::Law(Ok(command))) else {
                panic!();
            };
            assert_eq!(back.thrust.to_bits(), bits);
            assert_eq!(back.diagnostics.f_p.j().to_bits(), bits);
        }
    }

    #[test]
    fn a_step_comes_back_as_it_was() {
        let numbers = |n: f32| Inertial::new(n, n + 0.5);
        let reference = Reference {
            velocity: numbers(5.0),
            acceleration: numbers(6.0),
        };
        let feed_forward = FeedForward {
            air_acceleration: numbers(7.0),
            jerk: numbers(8.0),
        };
        let state = State {
            velocity: numbers(1.0),
            attitude: alula::planar::Attitude { cos: 0.6, sin: 0.8 },
            wind: numbers(3.0),
        };
        let input = PlanarGuidanceInput::default()
            .velocity(state.velocity)
            .attitude(state.attitude)
            .state_age(0.01)
            .air(Air::Velocity(numbers(2.0)))
            .specific_force(Body::new(7.5, -0.5))
            .position_error(numbers(9.0))
            .reference(reference)
            .reference_age(0.02)
            .planner_options(
                PlannerOptions::default()
                    .altitude_band(0.5)
                    .nose_below_vertical(true)
                    .hold_altitude_only(true),
            );
        let law = |feed_forward| Input::Law {
            state,
            reference,
            feed_forward,
        };
        for input in [
            law(None),
            law(Some(feed_forward)),
            Input::Guidance {
                input: (&input).into(),
                dt: 0.01,
            },
        ] {
            assert_eq!(through_the_wire(&input), input);
        }
        let mut guided = GuidanceOutput::default();
        guided.command.thrust = 1.0;
        guided.command.rates = BodyRates::new(2.0, 3.0, 4.0);
        guided.reject_reason = Some(RejectReason::Law(Fault::Wind));
        for answer in [
            Answer::Law(Err(Fault::Undefined)),
            Answer::Guidance(guided),
            Answer::NotConfigured,
            Answer::WrongInput,
        ] {
            assert_eq!(through_the_wire(&answer), answer);
        }
    }

    #[test]
    fn an_answer_puts_its_command_in_force_or_says_why_not() {
        let mut command = Command::default();
        (command.thrust, command.rate) = (3.0, 2.0);
        let rates = BodyRates::new(0.0, 2.0, 0.0);
        let in_force = InForce { thrust: 3.0, rates };
        let safe = InForce {
            thrust: 2.0,
            ..InForce::default()
        };
        assert_eq!(
            Answer::Law(Ok(command)).in_force(safe),
            Some((in_force, None))
        );
        let fault = Some(RejectReason::Law(Fault::Wind));
        assert_eq!(
            Answer::Law(Err(Fault::Wind)).in_force(safe),
            Some((safe, fault))
        );
        let mut guided = GuidanceOutput::default();
        guided.command.thrust = 3.0;
        guided.command.rates = BodyRates::new(2.0, 3.0, 4.0);
        guided.reject_reason = Some(RejectReason::StateAge);
        assert_eq!(
            Answer::Guidance(guided).in_force(safe),
            Some((
                InForce {
                    thrust: 3.0,
                    rates: guided.command.rates
                },
                Some(RejectReason::StateAge)
            ))
        );
        assert_eq!(Answer::NotConfigured.in_force(safe), None);
        assert_eq!(Answer::WrongInput.in_force(safe), None);
    }

    #[test]
    fn the_longest_messages_fit() {
        let envelope = |message| Envelope {
            session: u32::MAX,
            sequence: u32::MAX,
            message,
        };
        let status = Status {
            phase: Phase::LinkLost,
            thrust: 1.0,
            rates: BodyRates::new(1.0, 1.0, 1.0),
            ticks: u32::MAX,
            losses: u32::MAX,
            dropped: u32::MAX,
            counters: Counters {
                received: u32::MAX,
                corrupt: u32::MAX,
                truncated: u32::MAX,
                overlong: u32::MAX,
                wrong_version: u32::MAX,
                stale: u32::MAX,
                out_of_order: u32::MAX,
            },
        };
        let mut buffer = [0; MAX_FRAME];
        let refused = RefusedParameter {
            parameter: "a parameter with the longest name there is",
            problem: Problem::OutOfRange,
        };
        let mut guided = GuidanceOutput::default();
        guided.reject_reason = Some(RejectReason::Law(Fault::Undefined));
        for message in [
            FromTarget::Status(status),
            FromTarget::Refused(refused),
            FromTarget::Answer(Answer::Law(Ok(Command::default()))),
            FromTarget::Answer(Answer::Guidance(guided)),
        ] {
            assert!(encode(&envelope(message), &mut buffer).is_ok());
        }
        let configuration = Configuration {
            vehicle: VehicleParameters::PAPER,
            model: ModelParameters::Combined(CombinedParameters::PAPER_BELIEF),
            controller: ControllerParameters::Guidance {
                parameters: GuidanceParameters::DEFAULT,
                gains: Some(GainParameters::PAPER),
            },
            pacing: Pacing::Lockstep,
        };
        let law = Input::Law {
            state: State::default(),
            reference: Reference::default(),
            feed_forward: Some(FeedForward::default()),
        };
        let guidance = Input::Guidance {
            input: GuidanceInput::default()
                .air(Air::Wind(Ned::ZERO))
                .position_error(Some(Ned::ZERO)),
            dt: 0.01,
        };
        for message in [
            ToTarget::Configure(configuration),
            ToTarget::Input(law),
            ToTarget::Input(guidance),
        ] {
            let envelope = Envelope {
                session: u32::MAX,
                sequence: u32::MAX,
                message,
            };
            assert!(encode(&envelope, &mut buffer).is_ok(), "{message:?}");
        }
    }

    /// What a receiver of this version reads: the rows of the parameters by name, in order, and examples of the other messages.
    /// Where one changes, [`VERSION`] is to be raised, and the number here with it.
    #[test]
    fn the_layout_is_that_of_the_version() {
        let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI);
        let mut digest = crc.digest();
        for rows in [
            VehicleParameters::ROWS,
            CombinedParameters::ROWS,
            GainParameters::ROWS,
            GuidanceParameters::ROWS,
        ] {
            for row in rows {
                digest.update(row.name.as_bytes());
                digest.update(b";");
            }
        }
        let mut buffer = [0; MAX_FRAME];
        let input = Input::Guidance {
            input: GuidanceInput::default()
                .air(Air::Pitot {
                    airspeed: 4.0,
                    wind: Ned::ZERO,
                })
                .specific_force(Some(Frd::new(1.0, 2.0, 3.0)))
                .position_error(Some(Ned::ZERO)),
            dt: 0.01,
        };
        digest.update(encode(&input, &mut buffer).unwrap());
        let mut output = GuidanceOutput::default();
        output.command.rates = BodyRates::new(1.0, 2.0, 3.0);
        digest.update(encode(&Answer::Guidance(output), &mut buffer).unwrap());
        assert_eq!((VERSION, digest.finalize()), (9, 3_685_901_934));
    }
}
