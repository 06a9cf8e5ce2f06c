//! The messages, and what they are in the core's terms.

use alula::{
    Attitude, Body, Combined, CombinedParameters, Command, Diagnostics, Fault, FeedForward,
    GainParameters, Gains, Inertial, LargeAngle, LargeAngleParameters, Model, ParameterError,
    Problem, Reference, SmallAngle, SmallAngleParameters, State, Vehicle, VehicleParameters,
    VelocityControl,
};
use serde::{Deserialize, Serialize};

use crate::Counters;

/// A message with its place in the host's stream, or in an answer the place of what it answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Envelope<M> {
    /// Session of the host.
    pub session: u32,
    /// Number within the session.
    pub sequence: u32,
    /// The message.
    pub message: M,
}

/// What a host says.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToTarget {
    /// What to fly. Answered by [`FromTarget::Configured`] or [`FromTarget::Refused`].
    Configure(Configuration),
    /// State and reference for one control step. Answered by [`FromTarget::Answer`].
    Input(Input),
    /// Answered by [`FromTarget::Status`].
    StatusRequest,
}

/// What the target says.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromTarget<'a> {
    /// The configuration is in force.
    Configured,
    /// The configuration is not, and none is.
    #[serde(borrow)]
    Refused(Refusal<'a>),
    /// Result of one control step.
    Answer(Answer),
    /// How the target is: on request, and unasked.
    Status(Status),
}

/// Which law is flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Law {
    /// [`VelocityControl::robust`].
    Robust,
    /// [`VelocityControl::full`].
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

/// Parameters of an aerodynamic model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ModelParameters {
    /// c0, c1.
    LargeAngle([f32; 2]),
    /// c0, c2, c3.
    SmallAngle([f32; 3]),
    /// c0, c1, c2, c3, ᾱ \[rad\], k_L, k_D \[1/rad²\].
    Combined([f32; 7]),
}

/// All that a controller is made of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Configuration {
    /// m \[kg\], k_a \[kg/m\], δ \[rad\], g \[m/s²\].
    pub vehicle: [f32; 4],
    /// Aerodynamics.
    pub model: ModelParameters,
    /// k1, k2, k3, τ \[N\].
    pub gains: [f32; 4],
    /// The law.
    pub law: Law,
    /// What releases a step.
    pub pacing: Pacing,
}

impl Configuration {
    /// The configuration of a controller in the core's terms.
    pub fn new(
        vehicle: VehicleParameters,
        model: ModelParameters,
        gains: GainParameters,
        law: Law,
        pacing: Pacing,
    ) -> Self {
        Self {
            vehicle: [vehicle.mass, vehicle.k_a, vehicle.delta, vehicle.gravity],
            model,
            gains: [gains.k1, gains.k2, gains.k3, gains.tau],
            law,
            pacing,
        }
    }

    /// The controller.
    ///
    /// # Errors
    /// A parameter that the core refuses.
    pub fn control(&self) -> Result<VelocityControl<Model>, ParameterError> {
        let [mass, k_a, delta, gravity] = self.vehicle;
        let [k1, k2, k3, tau] = self.gains;
        let vehicle = VehicleParameters {
            mass,
            k_a,
            delta,
            gravity,
        };
        let vehicle = Vehicle::new(vehicle, self.model.model()?)?;
        let gains = Gains::new(GainParameters { k1, k2, k3, tau })?;
        Ok(VelocityControl::new(vehicle, gains))
    }
}

impl ModelParameters {
    /// The model.
    ///
    /// # Errors
    /// A parameter that the core refuses.
    pub fn model(&self) -> Result<Model, ParameterError> {
        Ok(match *self {
            Self::LargeAngle([c0, c1]) => {
                Model::LargeAngle(LargeAngle::new(LargeAngleParameters { c0, c1 })?)
            }
            Self::SmallAngle([c0, c2, c3]) => {
                Model::SmallAngle(SmallAngle::new(SmallAngleParameters { c0, c2, c3 })?)
            }
            Self::Combined([c0, c1, c2, c3, alpha_bar, k_l, k_d]) => {
                Model::Combined(Combined::new(CombinedParameters {
                    c0,
                    c1,
                    c2,
                    c3,
                    alpha_bar,
                    k_l,
                    k_d,
                })?)
            }
        })
    }
}

impl From<LargeAngleParameters> for ModelParameters {
    fn from(p: LargeAngleParameters) -> Self {
        Self::LargeAngle([p.c0, p.c1])
    }
}

impl From<SmallAngleParameters> for ModelParameters {
    fn from(p: SmallAngleParameters) -> Self {
        Self::SmallAngle([p.c0, p.c2, p.c3])
    }
}

impl From<CombinedParameters> for ModelParameters {
    fn from(p: CombinedParameters) -> Self {
        Self::Combined([p.c0, p.c1, p.c2, p.c3, p.alpha_bar, p.k_l, p.k_d])
    }
}

/// The arguments of one control step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    velocity: [f32; 2],
    attitude: [f32; 2],
    wind: [f32; 2],
    reference: [[f32; 2]; 2],
    feed_forward: Option<[[f32; 2]; 2]>,
}

impl Input {
    /// The arguments of [`VelocityControl::robust`] and [`VelocityControl::full`].
    pub fn new(state: &State, reference: &Reference, feed_forward: Option<&FeedForward>) -> Self {
        Self {
            velocity: state.velocity.0.into(),
            attitude: [state.attitude.cos, state.attitude.sin],
            wind: state.wind.0.into(),
            reference: [reference.velocity.0.into(), reference.acceleration.0.into()],
            feed_forward: feed_forward.map(|ff| [ff.air_acceleration.0.into(), ff.jerk.0.into()]),
        }
    }

    /// State of the vehicle.
    pub fn state(&self) -> State {
        State {
            velocity: Inertial(self.velocity.into()),
            attitude: Attitude {
                cos: self.attitude[0],
                sin: self.attitude[1],
            },
            wind: Inertial(self.wind.into()),
        }
    }

    /// Reference.
    pub fn reference(&self) -> Reference {
        Reference {
            velocity: Inertial(self.reference[0].into()),
            acceleration: Inertial(self.reference[1].into()),
        }
    }

    /// Feed-forward, if there is.
    pub fn feed_forward(&self) -> Option<FeedForward> {
        let [air_acceleration, jerk] = self.feed_forward?;
        Some(FeedForward {
            air_acceleration: Inertial(air_acceleration.into()),
            jerk: Inertial(jerk.into()),
        })
    }
}

/// What one control step gave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// The law's command: thrust \[N\], rate \[rad/s\], then the diagnostics in the order of their fields.
    Command([f32; 10]),
    /// The core's fault. The safe command is in force.
    Fault(#[serde(with = "WireFault")] Fault),
    /// There is no configuration to fly. The safe command is in force.
    NotConfigured,
}

/// The core's faults, as they are numbered on the wire.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Fault")]
enum WireFault {
    Velocity,
    Wind,
    Attitude,
    ReferenceVelocity,
    ReferenceAcceleration,
    AirAcceleration,
    Jerk,
    Undefined,
}

impl From<Result<Command, Fault>> for Answer {
    fn from(result: Result<Command, Fault>) -> Self {
        match result {
            Ok(c) => {
                let d = c.diagnostics;
                let [i, j] = d.f_p.0.into();
                Self::Command([
                    c.thrust,
                    c.rate,
                    d.alpha,
                    i,
                    j,
                    d.f_p_norm,
                    d.t_p,
                    d.guard_alignment,
                    d.guard_feed_forward,
                    d.k,
                ])
            }
            Err(fault) => Self::Fault(fault),
        }
    }
}

impl Answer {
    /// The control step's result in the core's terms; `None` if there was none.
    pub fn result(&self) -> Option<Result<Command, Fault>> {
        match *self {
            Self::Command(
                [
                    thrust,
                    rate,
                    alpha,
                    i,
                    j,
                    f_p_norm,
                    t_p,
                    alignment,
                    forward,
                    k,
                ],
            ) => Some(Ok(Command {
                thrust,
                rate,
                diagnostics: Diagnostics {
                    alpha,
                    f_p: Body::new(i, j),
                    f_p_norm,
                    t_p,
                    guard_alignment: alignment,
                    guard_feed_forward: forward,
                    k,
                },
            })),
            Self::Fault(fault) => Some(Err(fault)),
            Self::NotConfigured => None,
        }
    }
}

/// Why a configuration was refused: the core's [`ParameterError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refusal<'a> {
    /// The parameter.
    pub parameter: &'a str,
    /// What was wrong with it.
    #[serde(with = "WireProblem")]
    pub problem: Problem,
}

/// The core's problems, as they are numbered on the wire.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Problem")]
enum WireProblem {
    NotFinite,
    NotPositive,
    OutOfRange,
}

impl From<ParameterError> for Refusal<'static> {
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
    /// Angular rate in force \[rad/s\].
    pub rate: f32,
    /// Ticks of the timer since power-on.
    pub ticks: u32,
    /// How often the link was lost.
    pub losses: u32,
    /// What was received.
    pub counters: Counters,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Counters, MAX_FRAME, Receiver, encode};

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

    /// Floats that a conversion by value would not bring back: NaNs with a payload, −0, a subnormal.
    const ODD: [u32; 5] = [0x7FA0_1234, 0xFFC0_0001, 0x8000_0000, 1, 0x7F80_0000];

    #[test]
    fn floats_keep_their_bits() {
        for bits in ODD {
            let x = f32::from_bits(bits);
            let Answer::Command(back) = through_the_wire(&Answer::Command([x; 10])) else {
                panic!();
            };
            assert_eq!(back.map(f32::to_bits), [bits; 10]);
        }
    }

    #[test]
    fn a_step_comes_back_as_it_was() {
        let state = State {
            velocity: Inertial::new(1.0, 2.0),
            attitude: Attitude { cos: 0.6, sin: 0.8 },
            wind: Inertial::new(3.0, 4.0),
        };
        let reference = Reference {
            velocity: Inertial::new(5.0, 6.0),
            acceleration: Inertial::new(7.0, 8.0),
        };
        let forward = FeedForward {
            air_acceleration: Inertial::new(9.0, 10.0),
            jerk: Inertial::new(11.0, 12.0),
        };
        for forward in [None, Some(forward)] {
            let input = through_the_wire(&Input::new(&state, &reference, forward.as_ref()));
            assert_eq!(input.state(), state);
            assert_eq!(input.reference(), reference);
            assert_eq!(input.feed_forward(), forward);
        }
        let command = Command {
            thrust: 1.0,
            rate: 2.0,
            diagnostics: Diagnostics {
                alpha: 3.0,
                f_p: Body::new(4.0, 5.0),
                f_p_norm: 6.0,
                t_p: 7.0,
                guard_alignment: 8.0,
                guard_feed_forward: 9.0,
                k: 10.0,
            },
        };
        for result in [Ok(command), Err(Fault::Attitude), Err(Fault::Undefined)] {
            assert_eq!(
                through_the_wire(&Answer::from(result)).result(),
                Some(result)
            );
        }
    }

    #[test]
    fn a_configuration_makes_the_controller_it_was_made_of() {
        let (vehicle, gains) = (VehicleParameters::PAPER_BELIEF, GainParameters::PAPER);
        let combined = CombinedParameters::PAPER_BELIEF;
        let large = LargeAngleParameters { c0: 0.01, c1: 0.9 };
        let small = SmallAngleParameters {
            c0: 0.01,
            c2: 5.0,
            c3: 0.3,
        };
        for (parameters, model) in [
            (
                combined.into(),
                Model::Combined(Combined::new(combined).unwrap()),
            ),
            (
                large.into(),
                Model::LargeAngle(LargeAngle::new(large).unwrap()),
            ),
            (
                small.into(),
                Model::SmallAngle(SmallAngle::new(small).unwrap()),
            ),
        ] {
            let configuration =
                Configuration::new(vehicle, parameters, gains, Law::Full, Pacing::Timer);
            let configuration = through_the_wire(&configuration);
            let expected = VelocityControl::new(
                Vehicle::new(vehicle, model).unwrap(),
                Gains::new(gains).unwrap(),
            );
            assert_eq!(configuration.control(), Ok(expected));
            assert_eq!(configuration.law, Law::Full);
        }
        let heavy = VehicleParameters {
            mass: f32::NAN,
            ..vehicle
        };
        let refused = Configuration::new(heavy, combined.into(), gains, Law::Robust, Pacing::Timer);
        let refusal = Refusal::from(refused.control().unwrap_err());
        assert_eq!(
            (refusal.parameter, refusal.problem),
            ("mass", Problem::NotFinite)
        );
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
            rate: 1.0,
            ticks: u32::MAX,
            losses: u32::MAX,
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
        let refusal = Refusal {
            parameter: "a parameter with the longest name there is",
            problem: Problem::OutOfRange,
        };
        for message in [
            FromTarget::Status(status),
            FromTarget::Refused(refusal),
            FromTarget::Answer(Answer::Command([1.0; 10])),
        ] {
            assert!(encode(&envelope(message), &mut buffer).is_ok());
        }
        let configuration = Configuration {
            vehicle: [1.0; 4],
            model: ModelParameters::Combined([1.0; 7]),
            gains: [1.0; 4],
            law: Law::Full,
            pacing: Pacing::Lockstep,
        };
        let input = Input {
            velocity: [1.0; 2],
            attitude: [1.0; 2],
            wind: [1.0; 2],
            reference: [[1.0; 2]; 2],
            feed_forward: Some([[1.0; 2]; 2]),
        };
        for message in [ToTarget::Configure(configuration), ToTarget::Input(input)] {
            let envelope = Envelope {
                session: u32::MAX,
                sequence: u32::MAX,
                message,
            };
            assert!(encode(&envelope, &mut buffer).is_ok());
        }
    }
}
