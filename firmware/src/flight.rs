//! The control loop, supervised: bytes and ticks in, replies and the command in force out.

use alula::guidance::RejectReason;
use alula_link::{
    Admission, Answer, Configuration, Controller, Counters, Envelope, FromTarget, InForce, Input,
    Order, Pacing, Phase, Receiver, Status, ToTarget,
};

use crate::arming::Arming;

/// Rate of the timer \[Hz\]: of the control loop under [`Pacing::Timer`], of the supervision always.
pub const TICK_RATE: u32 = 1000;

/// The link is lost when so many ticks have passed without a valid input: 50 ms.
pub const SILENCE_LIMIT: u32 = 50;

/// While it does not fly, the target announces its status every so many ticks: 500 ms.
pub const ANNOUNCE_PERIOD: u32 = 500;

/// What the target sends.
pub type Reply = Envelope<FromTarget<'static>>;

/// The state of the image. The command in force is the controller's safe one, unless the last valid input is younger than
/// [`SILENCE_LIMIT`] and the controller had an answer to it. Without a controller there is no thrust.
#[derive(Default)]
pub struct Flight {
    receiver: Receiver,
    order: Order,
    counters: Counters,
    configured: Option<Configured>,
    arming: Arming,
    /// An input that waits for the next tick.
    pending: Option<Envelope<Input>>,
    command: InForce,
    reject_reason: Option<RejectReason>,
    /// The last input is younger than the limit.
    fresh: bool,
    /// Ticks since the last input.
    silence: u32,
    ticks: u32,
    losses: u32,
    dropped: u32,
}

/// The controller configured, with its memory.
struct Configured {
    controller: Controller,
    pacing: Pacing,
    /// It has had an input.
    stepped: bool,
}

impl Flight {
    /// Takes one received byte; returns what is to be sent, if anything.
    pub fn receive(&mut self, byte: u8) -> Option<Reply> {
        let envelope: Envelope<ToTarget> = self.receiver.push(byte, &mut self.counters)?;
        let Envelope {
            session, sequence, ..
        } = envelope;
        if self.order.admit(session, sequence, &mut self.counters)? == Admission::NewSession {
            self.reset();
        }
        match envelope.message {
            ToTarget::Configure(configuration) => {
                self.reset();
                let message = match Controller::new(&perturbed(configuration)) {
                    Ok(controller) => {
                        self.configured = Some(Configured {
                            controller,
                            pacing: configuration.pacing,
                            stepped: false,
                        });
                        FromTarget::Configured
                    }
                    Err(error) => FromTarget::Refused(error.into()),
                };
                Some(self.reply(message))
            }
            ToTarget::Input(message) => {
                let input = Envelope {
                    session,
                    sequence,
                    message,
                };
                match &self.configured {
                    None => Some(self.reply(FromTarget::Answer(Answer::NotConfigured))),
                    Some(configured) if !configured.controller.takes(&message) => {
                        Some(self.reply(FromTarget::Answer(Answer::WrongInput)))
                    }
                    Some(configured) if configured.pacing == Pacing::Lockstep => self.fly(input),
                    Some(_) => {
                        self.pending = Some(input);
                        None
                    }
                }
            }
            ToTarget::StatusRequest => Some(self.reply(FromTarget::Status(self.status()))),
        }
    }

    /// One tick of the timer; returns what is to be sent, if anything.
    pub fn tick(&mut self) -> Option<Reply> {
        self.ticks = self.ticks.wrapping_add(1);
        if let Some(input) = self.pending.take() {
            return self.fly(input);
        }
        if self.fresh {
            self.silence += 1;
            if self.silence < SILENCE_LIMIT {
                return None;
            }
            self.fresh = false;
            self.losses += 1;
            self.safe();
        } else if !self.ticks.is_multiple_of(ANNOUNCE_PERIOD) {
            return None;
        }
        Some(self.announcement())
    }

    /// The status, as it is announced at power-on and whenever the target does not fly.
    pub fn announcement(&self) -> Reply {
        self.reply(FromTarget::Status(self.status()))
    }

    /// What the target is doing.
    pub fn phase(&self) -> Phase {
        match &self.configured {
            None => Phase::NotConfigured,
            Some(_) if self.fresh => Phase::Flying,
            Some(configured) if configured.stepped => Phase::LinkLost,
            Some(_) => Phase::Waiting,
        }
    }

    /// The command in force.
    pub fn command(&self) -> InForce {
        self.command
    }

    /// Why the controller refused the last input, if it did.
    pub fn reject_reason(&self) -> Option<RejectReason> {
        self.reject_reason
    }

    /// Whether the motor may turn, `switch` being whether the arming switch is on; to be called once per tick.
    ///
    /// It may turn once inputs have come, with a safe thrust when they stop, and not in lockstep, where the vehicle that the
    /// thrust is meant for is simulated. [`Arming`] says what the switch must have done.
    pub fn drives_motor(&mut self, switch: bool) -> bool {
        let timed = |c: &Configured| c.pacing == Pacing::Timer;
        let ready = self.fresh && self.configured.as_ref().is_some_and(timed);
        self.arming.update(switch, ready)
    }

    /// Counts a reply that the port did not take.
    pub fn count_dropped(&mut self) {
        self.dropped = self.dropped.saturating_add(1);
    }

    /// How the target is.
    pub fn status(&self) -> Status {
        Status {
            phase: self.phase(),
            thrust: self.command.thrust,
            rates: self.command.rates,
            ticks: self.ticks,
            losses: self.losses,
            dropped: self.dropped,
            counters: self.counters,
        }
    }

    /// One control step.
    fn fly(&mut self, input: Envelope<Input>) -> Option<Reply> {
        let configured = self.configured.as_mut()?;
        let answer = configured.controller.step(&input.message);
        if let Some((command, reject_reason)) = answer.in_force(configured.controller.safe()) {
            configured.stepped = true;
            (self.fresh, self.silence) = (true, 0);
            (self.command, self.reject_reason) = (command, reject_reason);
        }
        Some(Envelope {
            session: input.session,
            sequence: input.sequence,
            message: FromTarget::Answer(answer),
        })
    }

    fn safe(&mut self) {
        let safe = |configured: &Configured| configured.controller.safe();
        self.command = self.configured.as_ref().map(safe).unwrap_or_default();
        self.reject_reason = None;
    }

    fn reset(&mut self) {
        self.configured = None;
        self.arming.disarm();
        self.pending = None;
        self.fresh = false;
        self.safe();
    }

    fn reply(&self, message: FromTarget<'static>) -> Reply {
        let (session, sequence) = self.order.last();
        Envelope {
            session,
            sequence,
            message,
        }
    }
}

/// The configuration. The build for the test of the tests changes the model's second parameter (c1, or c2 of the small-angle
/// model) by one unit in the last place.
fn perturbed(mut configuration: Configuration) -> Configuration {
    if cfg!(feature = "perturbed") {
        let model = &mut configuration.model;
        model.set(1, model.get(1).next_up());
    }
    configuration
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula::guidance::{Air, Mode};
    use alula::planar::{
        Attitude, GainParameters, Inertial, PlanarGuidanceInput, Reference, State,
    };
    use alula::{
        BodyRates, CombinedParameters, Fault, GuidanceParameters, ModelParameters, Parameters,
        VehicleParameters,
    };
    use alula_link::damage::Mangler;
    use alula_link::{ControllerParameters, Law, LawGains, MAX_FRAME, RefusedParameter, encode};
    use std::vec::Vec;

    fn configuration(pacing: Pacing) -> Configuration {
        Configuration {
            vehicle: VehicleParameters::PAPER_BELIEF,
            model: ModelParameters::Combined(CombinedParameters::PAPER_BELIEF),
            controller: ControllerParameters::Law {
                law: Law::Robust,
                gains: LawGains::Constant(GainParameters::PAPER),
            },
            pacing,
        }
    }

    fn guidance(pacing: Pacing) -> Configuration {
        Configuration {
            controller: ControllerParameters::Guidance {
                parameters: GuidanceParameters::DEFAULT,
                gains: None,
            },
            ..configuration(pacing)
        }
    }

    fn state(n: u32) -> State {
        State {
            velocity: Inertial::new(n as f32 * 1e-4, 5.0),
            attitude: Attitude::from_angle(n as f32 * 1e-3),
            wind: Inertial::ZERO,
        }
    }

    fn law_input(state: State) -> Input {
        Input::Law {
            state,
            reference: Reference::default(),
            feed_forward: None,
        }
    }

    /// An input of its own for every number.
    fn input(n: u32) -> Input {
        law_input(state(n))
    }

    fn guidance_input(n: u32) -> Input {
        let input = PlanarGuidanceInput::default()
            .velocity(state(n).velocity)
            .attitude(state(n).attitude)
            .air(Air::Wind(Inertial::ZERO));
        Input::Guidance {
            input: (&input).into(),
            dt: 0.01,
        }
    }

    /// The answer of the law to an input.
    fn law(input: &Input) -> Answer {
        let mut controller = Controller::new(&configuration(Pacing::Timer)).unwrap();
        controller.step(input)
    }

    fn law_command(input: &Input) -> InForce {
        law(input).in_force(InForce::default()).unwrap().0
    }

    /// Weight [N] that the configurations believe in.
    const WEIGHT: f32 = 9.0 * 9.81;

    /// Nearly upright: 0.95 of the weight, no rotation.
    fn safe_command() -> InForce {
        let thrust = 0.95 * WEIGHT * state(2).attitude.angle().cos();
        InForce {
            thrust,
            rates: BodyRates::default(),
        }
    }

    fn envelope<M>(session: u32, sequence: u32, message: M) -> Envelope<M> {
        Envelope {
            session,
            sequence,
            message,
        }
    }

    /// Sends `message` as number `sequence` of session 1.
    fn send(flight: &mut Flight, sequence: u32, message: ToTarget) -> Option<Reply> {
        send_in(flight, envelope(1, sequence, message))
    }

    fn send_in(flight: &mut Flight, message: Envelope<ToTarget>) -> Option<Reply> {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode(&message, &mut buffer).unwrap();
        let replies: Vec<_> = bytes.iter().filter_map(|&b| flight.receive(b)).collect();
        assert!(replies.len() <= 1);
        replies.first().copied()
    }

    fn configured(pacing: Pacing) -> Flight {
        let mut flight = Flight::default();
        let reply = send(&mut flight, 1, ToTarget::Configure(configuration(pacing)));
        assert_eq!(reply, Some(envelope(1, 1, FromTarget::Configured)));
        assert_eq!(flight.phase(), Phase::Waiting);
        flight
    }

    fn phase_announced(reply: Option<Reply>) -> Option<Phase> {
        match reply?.message {
            FromTarget::Status(status) => Some(status.phase),
            _ => None,
        }
    }

    #[test]
    fn without_a_link_it_stays_safe_and_says_so() {
        let mut flight = Flight::default();
        for tick in 1..=10 * ANNOUNCE_PERIOD {
            let announced = phase_announced(flight.tick());
            let due = tick % ANNOUNCE_PERIOD == 0;
            assert_eq!(announced, due.then_some(Phase::NotConfigured));
            assert_eq!(flight.command(), InForce::default());
            assert!(!flight.drives_motor(true));
        }
        let answer = FromTarget::Answer(Answer::NotConfigured);
        let reply = send(&mut flight, 1, ToTarget::Input(input(1)));
        assert_eq!(reply, Some(envelope(1, 1, answer)));
        assert_eq!(flight.command(), InForce::default());
    }

    #[test]
    fn under_the_timer_a_step_waits_for_its_tick() {
        let mut flight = configured(Pacing::Timer);
        assert_eq!(send(&mut flight, 2, ToTarget::Input(input(2))), None);
        assert_eq!(flight.command(), InForce::default());
        let reply = flight.tick().unwrap();
        let expected = law(&input(2));
        // The arming switch is put on while it flies.
        flight.drives_motor(false);
        assert_eq!(reply, envelope(1, 2, FromTarget::Answer(expected)));
        assert_eq!(flight.command(), law_command(&input(2)));
        assert!(flight.drives_motor(true));
        // The newest of several is flown.
        assert_eq!(send(&mut flight, 3, ToTarget::Input(input(3))), None);
        assert_eq!(send(&mut flight, 4, ToTarget::Input(input(4))), None);
        assert_eq!(flight.tick().unwrap().sequence, 4);
        assert_eq!(flight.command(), law_command(&input(4)));
    }

    #[test]
    fn in_lockstep_an_input_is_flown_on_arrival_and_no_motor_turns() {
        let mut flight = configured(Pacing::Lockstep);
        let reply = send(&mut flight, 2, ToTarget::Input(input(2)));
        let answer = FromTarget::Answer(law(&input(2)));
        assert_eq!(reply, Some(envelope(1, 2, answer)));
        assert_eq!(flight.phase(), Phase::Flying);
        assert!(!flight.drives_motor(true));
    }

    #[test]
    fn silence_makes_it_safe_and_an_input_brings_it_back() {
        for pacing in [Pacing::Timer, Pacing::Lockstep] {
            let mut flight = configured(pacing);
            let fly = |flight: &mut Flight, n| {
                let reply = send(flight, n, ToTarget::Input(input(n)));
                reply.or_else(|| flight.tick()).unwrap()
            };
            fly(&mut flight, 2);
            for _ in 1..SILENCE_LIMIT {
                assert_eq!(flight.tick(), None);
                // The last command is held, and a request for status is no input.
                assert_eq!(flight.command(), law_command(&input(2)));
            }
            assert_eq!(phase_announced(flight.tick()), Some(Phase::LinkLost));
            assert_eq!(flight.command(), safe_command());
            assert_eq!(flight.status().losses, 1);
            let announced = (0..ANNOUNCE_PERIOD).find_map(|_| phase_announced(flight.tick()));
            assert_eq!(announced, Some(Phase::LinkLost));

            let answer = FromTarget::Answer(law(&input(9)));
            assert_eq!(fly(&mut flight, 9), envelope(1, 9, answer));
            assert_eq!(flight.phase(), Phase::Flying);
            assert_eq!(flight.command(), law_command(&input(9)));
        }
    }

    #[test]
    fn the_motor_goes_on_without_a_link_until_the_switch_is_put_off() {
        let mut flight = configured(Pacing::Timer);
        send(&mut flight, 2, ToTarget::Input(input(2)));
        flight.tick();
        flight.drives_motor(false);
        for _ in 0..10 * SILENCE_LIMIT {
            flight.tick();
            assert!(flight.drives_motor(true));
        }
        assert_eq!(flight.phase(), Phase::LinkLost);
        assert_eq!(flight.command(), safe_command());
        assert!(!flight.drives_motor(false));
        // Without a link it is not armed again.
        assert!(!flight.drives_motor(true));
    }

    /// The guidance's own: in hover it sinks, in cruise it glides, and before it has flown there is none.
    #[test]
    fn a_lost_link_leaves_the_thrust_that_the_attitude_can_use() {
        let after = |n: u32, theta: f32| {
            let mut flight = Flight::default();
            send(
                &mut flight,
                1,
                ToTarget::Configure(guidance(Pacing::Lockstep)),
            );
            let air = PlanarGuidanceInput::default()
                .attitude(Attitude::from_angle(theta))
                .air(Air::Wind(Inertial::ZERO));
            for n in 0..n {
                let input = Input::Guidance {
                    input: (&air).into(),
                    dt: 0.01,
                };
                send(&mut flight, 2 + n, ToTarget::Input(input));
            }
            for _ in 0..SILENCE_LIMIT {
                flight.tick();
            }
            assert_eq!(flight.phase(), Phase::LinkLost);
            assert_eq!(flight.command().rates, BodyRates::default());
            flight.command().thrust / WEIGHT
        };
        assert_eq!(after(1, 0.0), 0.0);
        assert!((after(20, 0.0) - 0.95).abs() < 1e-3);
        assert!((after(20, -1.3) - 0.95 * 1.3f32.cos()).abs() < 1e-3);
    }

    #[test]
    fn only_inputs_keep_it_flying() {
        let mut flight = configured(Pacing::Lockstep);
        send(&mut flight, 2, ToTarget::Input(input(2)));
        for n in 1..SILENCE_LIMIT {
            assert_eq!(flight.tick(), None);
            assert!(send(&mut flight, 2 + n, ToTarget::StatusRequest).is_some());
        }
        // Nor does the same input again.
        assert_eq!(send(&mut flight, 2, ToTarget::Input(input(2))), None);
        assert_eq!(phase_announced(flight.tick()), Some(Phase::LinkLost));
        assert_eq!(flight.status().counters.out_of_order, 1);
    }

    #[test]
    fn a_fault_is_reported_with_the_safe_command_in_force() {
        let mut flight = configured(Pacing::Lockstep);
        send(&mut flight, 2, ToTarget::Input(input(2)));
        let bad = law_input(State {
            wind: Inertial::new(f32::NAN, 0.0),
            ..state(3)
        });
        let reply = send(&mut flight, 3, ToTarget::Input(bad));
        let answer = FromTarget::Answer(Answer::Law(Err(Fault::Wind)));
        assert_eq!(reply, Some(envelope(1, 3, answer)));
        assert_eq!(flight.command(), safe_command());
        assert_eq!(flight.reject_reason(), Some(RejectReason::Law(Fault::Wind)));
        send(&mut flight, 4, ToTarget::Input(input(4)));
        assert_eq!(
            (flight.reject_reason(), flight.command()),
            (None, law_command(&input(4)))
        );
    }

    #[test]
    fn the_guidance_keeps_its_memory_until_it_is_configured_again() {
        for pacing in [Pacing::Lockstep, Pacing::Timer] {
            let mut flight = Flight::default();
            let configure = ToTarget::Configure(guidance(pacing));
            let mut fly = |message| {
                let sequence = flight.order.last().1 + 1;
                let reply = send(&mut flight, sequence, message);
                match reply.or_else(|| flight.tick()).unwrap().message {
                    FromTarget::Answer(answer) => Some(answer),
                    _ => None,
                }
            };
            let mut answers = Vec::new();
            for _ in 0..2 {
                assert_eq!(fly(configure), None);
                let mut host = Controller::new(&guidance(pacing)).unwrap();
                for n in 0..20 {
                    let answer = fly(ToTarget::Input(guidance_input(n))).unwrap();
                    assert_eq!(answer, host.step(&guidance_input(n)));
                    answers.push(answer);
                }
            }
            // It needs some frames to leave the safe command, and does so twice.
            let mode = |n: usize| match &answers[n] {
                Answer::Guidance(guided) => guided.mode,
                other => panic!("{other:?}"),
            };
            for start in [0, 20] {
                assert_eq!(mode(start), Mode::Safe);
                assert_eq!(mode(start + 19), Mode::Flying);
            }
            let last = guidance_input(19);
            let (command, _) = answers[39].in_force(InForce::default()).unwrap();
            assert_eq!(flight.command(), command);
            assert!(command.thrust > 50.0, "{last:?}");
        }
    }

    #[test]
    fn an_input_of_the_wrong_kind_is_refused_and_keeps_nothing_flying() {
        for pacing in [Pacing::Lockstep, Pacing::Timer] {
            let mut flight = configured(pacing);
            let reply = send(&mut flight, 2, ToTarget::Input(input(2)));
            reply.or_else(|| flight.tick()).unwrap();
            for n in 1..=SILENCE_LIMIT {
                let wrong = ToTarget::Input(guidance_input(n));
                let reply = send(&mut flight, 2 + n, wrong).unwrap();
                assert_eq!(reply.message, FromTarget::Answer(Answer::WrongInput));
                let announced = phase_announced(flight.tick());
                let lost = (n == SILENCE_LIMIT).then_some(Phase::LinkLost);
                assert_eq!(announced, lost, "{n}");
            }
            assert_eq!(flight.command(), safe_command());
        }
    }

    #[test]
    fn a_new_configuration_disarms_even_between_two_ticks() {
        let mut flight = configured(Pacing::Timer);
        send(&mut flight, 2, ToTarget::Input(input(2)));
        flight.tick();
        flight.drives_motor(false);
        assert!(flight.drives_motor(true));
        send(
            &mut flight,
            3,
            ToTarget::Configure(configuration(Pacing::Timer)),
        );
        send(&mut flight, 4, ToTarget::Input(input(4)));
        flight.tick();
        assert_eq!(flight.phase(), Phase::Flying);
        assert!(!flight.drives_motor(true));
        // The switch off and on again arms it.
        flight.drives_motor(false);
        assert!(flight.drives_motor(true));
    }

    #[test]
    fn a_refused_configuration_leaves_none() {
        let mut flight = configured(Pacing::Lockstep);
        send(&mut flight, 2, ToTarget::Input(input(2)));
        let mut bad = configuration(Pacing::Lockstep);
        bad.controller = ControllerParameters::Law {
            law: Law::Robust,
            gains: LawGains::Constant(GainParameters::PAPER.tau(-80.0)),
        };
        let Some(reply) = send(&mut flight, 3, ToTarget::Configure(bad)) else {
            panic!()
        };
        let reject_reason = RefusedParameter {
            parameter: "tau",
            problem: alula::Problem::NotPositive,
        };
        assert_eq!(reply.message, FromTarget::Refused(reject_reason));
        assert_eq!(flight.phase(), Phase::NotConfigured);
        assert_eq!(flight.command(), InForce::default());
    }

    #[test]
    fn a_new_session_voids_the_old() {
        let mut flight = configured(Pacing::Lockstep);
        let reply = send_in(&mut flight, envelope(2, 0, ToTarget::Input(input(2)))).unwrap();
        assert_eq!(reply.message, FromTarget::Answer(Answer::NotConfigured));
        let configure = ToTarget::Configure(configuration(Pacing::Lockstep));
        assert_eq!(send(&mut flight, 50, configure), None);
        assert_eq!(flight.phase(), Phase::NotConfigured);
        assert_eq!(flight.status().counters.stale, 1);
        assert!(send_in(&mut flight, envelope(2, 1, configure)).is_some());
        assert_eq!(flight.phase(), Phase::Waiting);
    }

    #[test]
    fn no_command_from_a_hundred_thousand_damaged_frames() {
        let mut flight = configured(Pacing::Lockstep);
        let mut mangler = Mangler::new(3);
        mangler.genuine(&envelope(
            1,
            1,
            ToTarget::Configure(configuration(Pacing::Lockstep)),
        ));
        let mut answers = 0;
        for n in 1..=100_000 {
            let good = mangler.genuine(&envelope(1, 2 * n, ToTarget::Input(input(2 * n))));
            let bad = mangler.damaged(&envelope(1, 2 * n + 1, ToTarget::Input(input(2 * n + 1))));
            for byte in [good, bad].concat() {
                let Some(reply) = flight.receive(byte) else {
                    continue;
                };
                // What is answered is the law's answer to what was meant by that number.
                let answer = law(&input(reply.sequence));
                assert_eq!(reply.message, FromTarget::Answer(answer));
                answers += 1;
            }
        }
        mangler
            .end()
            .iter()
            .for_each(|&b| assert!(flight.receive(b).is_none()));
        let counters = flight.status().counters;
        let expected = mangler.expected();
        assert!(expected.agrees(&counters), "{expected:?} {counters:?}");
        // All that was accepted, but for the configuration, was answered once.
        let accepted = expected.received - expected.stale - expected.out_of_order;
        assert_eq!(answers, accepted - 1);
    }
}
