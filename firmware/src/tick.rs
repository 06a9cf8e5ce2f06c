//! One tick of the control loop: the flight, the motor, the watchdog.

use embedded_hal::pwm::SetDutyCycle;

use crate::flight::{Flight, Reply};
use crate::thrust::ThrustOutput;

/// Resets the chip, and so stops the motor, unless it is fed.
pub trait Watchdog {
    /// Puts the reset off once more.
    fn feed(&mut self);
}

/// One tick of the timer: steps the flight, sets the motor, feeds the watchdog. Returns what is to be sent, if anything.
///
/// Nothing else feeds the watchdog: a loop that no longer sees its timer, or that hangs in a step, in a reply or in an
/// interrupt, ends in a reset. Neither does a tick whose motor could not be set.
///
/// # Errors
/// The channel's.
pub fn tick<P: SetDutyCycle>(
    flight: &mut Flight,
    motor: &mut ThrustOutput<'_, P>,
    switch: bool,
    watchdog: &mut impl Watchdog,
) -> Result<Option<Reply>, P::Error> {
    let reply = flight.tick();
    motor.arm(flight.drives_motor(switch))?;
    motor.set(flight.command().thrust)?;
    watchdog.feed();
    Ok(reply)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thrust::{MotorCurve, Pulse};
    use alula::planar::{GainParameters, Reference, State};
    use alula::{LargeAngleParameters, ModelParameters, VehicleParameters};
    use alula_link::{
        Configuration, ControllerParameters, Envelope, Input, Law, LawGains, MAX_FRAME, Pacing,
        ToTarget, encode,
    };

    /// Counts.
    #[derive(Default)]
    struct Fed(u32);

    impl Watchdog for Fed {
        fn feed(&mut self) {
            self.0 += 1;
        }
    }

    /// A channel of 1000 counts, that fails if it is told to.
    #[derive(Default)]
    struct Channel {
        duty: u16,
        broken: bool,
    }

    impl embedded_hal::pwm::ErrorType for Channel {
        type Error = embedded_hal::pwm::ErrorKind;
    }

    impl SetDutyCycle for Channel {
        fn max_duty_cycle(&self) -> u16 {
            1000
        }

        fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Self::Error> {
            self.duty = duty;
            if self.broken {
                Err(embedded_hal::pwm::ErrorKind::Other)
            } else {
                Ok(())
            }
        }
    }

    fn motor(channel: &mut Channel) -> ThrustOutput<'static, &mut Channel> {
        const CURVE: MotorCurve<'static> = match MotorCurve::new(&[(0.0, 0.0), (200.0, 1.0)]) {
            Ok(curve) => curve,
            Err(_) => panic!(),
        };
        let pulse = Pulse {
            disarmed: 0.4,
            minimum: 0.5,
            maximum: 0.9,
        };
        ThrustOutput::new(channel, CURVE, pulse).unwrap()
    }

    fn send(flight: &mut Flight, sequence: u32, message: ToTarget) {
        let envelope = Envelope {
            session: 1,
            sequence,
            message,
        };
        let mut buffer = [0; MAX_FRAME];
        for &byte in encode(&envelope, &mut buffer).unwrap() {
            flight.receive(byte);
        }
    }

    #[test]
    fn each_tick_feeds_the_watchdog_once_and_nothing_else_does() {
        let (mut flight, mut watchdog) = (Flight::default(), Fed::default());
        let mut channel = Channel::default();
        let mut motor = motor(&mut channel);
        for n in 1..=5 {
            send(&mut flight, n, ToTarget::StatusRequest);
            assert_eq!(watchdog.0, n - 1);
            tick(&mut flight, &mut motor, false, &mut watchdog).unwrap();
            assert_eq!(watchdog.0, n);
        }
    }

    #[test]
    fn a_motor_that_cannot_be_set_ends_in_a_reset() {
        let (mut flight, mut watchdog) = (Flight::default(), Fed::default());
        let mut channel = Channel {
            broken: true,
            ..Channel::default()
        };
        let mut motor = motor(&mut channel);
        assert!(tick(&mut flight, &mut motor, false, &mut watchdog).is_err());
        assert_eq!(watchdog.0, 0);
    }

    #[test]
    fn the_motor_turns_with_the_command_once_it_is_armed() {
        let (mut flight, mut watchdog) = (Flight::default(), Fed::default());
        let configuration = Configuration {
            vehicle: VehicleParameters::PAPER,
            model: ModelParameters::LargeAngle(LargeAngleParameters {
                c0: 0.014,
                c1: 0.95,
            }),
            controller: ControllerParameters::Law {
                law: Law::Robust,
                gains: LawGains::Constant(GainParameters::PAPER),
            },
            pacing: Pacing::Timer,
        };
        send(&mut flight, 1, ToTarget::Configure(configuration));
        let hover = Input::Law {
            state: State::default(),
            reference: Reference::default(),
            feed_forward: None,
        };
        let mut channel = Channel::default();
        let mut duties = [0; 4];
        // The switch is on from the start; then it is put off and on again.
        for (n, switch) in [true, true, false, true].into_iter().enumerate() {
            send(&mut flight, 2 + n as u32, ToTarget::Input(hover));
            let motor = &mut motor(&mut channel);
            assert!(
                tick(&mut flight, motor, switch, &mut watchdog)
                    .unwrap()
                    .is_some()
            );
            duties[n] = channel.duty;
        }
        // 98.1 N of 200 N, between the pulses of 0.5 and 0.9.
        assert_eq!(duties, [400, 400, 400, 696]);
    }
}
