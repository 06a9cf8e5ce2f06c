//! The link's decoder: any bytes, whole frames of any content, and genuine messages, in any order. What is decoded is flown.

use alula::BodyRates;
use alula::{CombinedParameters, GuidanceParameters, ModelParameters, VehicleParameters};
use alula_link::{
    Answer, Configuration, Controller, ControllerParameters, Counters, Envelope, FromTarget, Input,
    MAX_FRAME, Order, Pacing, Receiver, ToTarget, encode,
};
use serde::ser::{Serialize, SerializeTuple, Serializer};

use crate::bytes::Bytes;

/// A payload of any bytes, in a frame whose checksum is right.
struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        self.0
            .iter()
            .try_for_each(|byte| tuple.serialize_element(byte))?;
        tuple.end()
    }
}

/// The target's end, as far as a link without hardware has one.
#[derive(Default)]
struct Target {
    receiver: Receiver,
    counters: Counters,
    order: Order,
    controller: Option<(Controller, Configuration)>,
    /// Zero bytes received.
    zeros: u32,
    /// Messages decoded and inputs flown; a byte is none.
    calls: u64,
}

impl Target {
    fn take(&mut self, byte: u8) {
        self.zeros += u32::from(byte == 0);
        let heard: Option<Envelope<ToTarget>> = self.receiver.push(byte, &mut self.counters);
        if let Some(envelope) = heard {
            assert_eq!(byte, 0, "a message before its end");
            self.calls += 1;
            travels(&envelope);
            self.hear(&envelope);
        }
        let c = &self.counters;
        let stretches = c.received + c.corrupt + c.truncated + c.overlong + c.wrong_version;
        assert!(stretches <= self.zeros, "{c:?} in {} stretches", self.zeros);
    }

    fn hear(&mut self, envelope: &Envelope<ToTarget>) {
        let Envelope {
            session, sequence, ..
        } = *envelope;
        let admitted = self.order.admit(session, sequence, &mut self.counters);
        assert!(admitted.is_none() || self.order.last() == (session, sequence));
        match &envelope.message {
            ToTarget::Configure(configuration) => {
                let made = Controller::new(configuration);
                self.controller = made.ok().map(|made| (made, *configuration));
            }
            ToTarget::Input(input) => self.fly(input),
            ToTarget::StatusRequest => {}
        }
    }

    fn fly(&mut self, input: &Input) {
        let Some((controller, configuration)) = &mut self.controller else {
            return;
        };
        self.calls += 1;
        let answer = controller.step(input);
        let safe = controller.safe();
        let limits = configuration.vehicle.thrust_min..=configuration.vehicle.thrust_max;
        assert!(limits.contains(&safe.thrust), "{safe:?}");
        if let Some((command, _)) = answer.in_force(safe) {
            let BodyRates { roll, pitch, yaw } = command.rates;
            assert!(
                command.thrust.is_finite() && (roll + pitch + yaw).is_finite(),
                "{answer:?}"
            );
        }
        if let Answer::Guidance(guided) = &answer {
            assert!(limits.contains(&guided.command.thrust), "{guided:?}");
        }
        let answer = Envelope {
            session: 1,
            sequence: 1,
            message: FromTarget::Answer(answer),
        };
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(&answer, &mut buffer).expect("every answer has room");
        let (mut receiver, mut counters) = (Receiver::new(), Counters::default());
        let heard = frame.iter().find_map(|&byte| {
            let heard: Option<Envelope<FromTarget>> = receiver.push(byte, &mut counters);
            heard.map(|heard| format!("{heard:?}"))
        });
        assert_eq!(heard, Some(format!("{answer:?}")));
    }
}

/// What was decoded is encoded and decoded again as the same, NaN or not.
fn travels(envelope: &Envelope<ToTarget>) {
    let mut buffer = [0; MAX_FRAME];
    let frame = encode(envelope, &mut buffer).expect("it came in a frame");
    let (mut receiver, mut counters) = (Receiver::new(), Counters::default());
    let again = frame
        .iter()
        .find_map(|&byte| receiver.push(byte, &mut counters));
    let again: Envelope<ToTarget> = again.expect("a whole frame");
    assert_eq!(format!("{again:?}"), format!("{envelope:?}"));
}

fn genuine(bytes: &mut Bytes, sequence: u32) -> Envelope<ToTarget> {
    let message = match bytes.byte() % 8 {
        0 => ToTarget::StatusRequest,
        1 | 2 => ToTarget::Configure(Configuration {
            vehicle: bytes.parameters(VehicleParameters::PAPER),
            model: ModelParameters::Combined(
                bytes.parameters(CombinedParameters::NACA_0021_RE_160E3),
            ),
            controller: ControllerParameters::Guidance {
                parameters: bytes.parameters(GuidanceParameters::default()),
                gains: None,
            },
            pacing: Pacing::Lockstep,
        }),
        _ => ToTarget::Input(Input::Guidance {
            input: crate::guidance::input(bytes),
            dt: bytes.number(0.02),
        }),
    };
    Envelope {
        session: u32::from(bytes.byte() % 4),
        sequence,
        message,
    }
}

pub fn run(data: &[u8]) -> u64 {
    let mut bytes = Bytes::new(data);
    let mut target = Target::default();
    let mut sequence = 0;
    while !bytes.is_empty() {
        let mut buffer = [0; MAX_FRAME];
        let kind = bytes.byte();
        let mut frame = match kind {
            0..=63 => {
                let count = usize::from(bytes.byte());
                (0..count).map(|_| bytes.byte()).collect()
            }
            64..=127 => {
                // Of the lengths around those of real messages, too.
                let payload: Vec<u8> = (0..bytes.byte()).map(|_| bytes.byte()).collect();
                let frame = encode(&Raw(&payload), &mut buffer);
                frame.map(<[u8]>::to_vec).unwrap_or_default()
            }
            _ => {
                sequence += 1;
                let envelope = genuine(&mut bytes, sequence);
                encode(&envelope, &mut buffer)
                    .expect("it has room")
                    .to_vec()
            }
        };
        if kind.is_multiple_of(8) && !frame.is_empty() {
            let at = usize::from(bytes.byte()) % frame.len();
            frame[at] ^= 1 << (bytes.byte() % 8);
        }
        frame.iter().for_each(|&byte| target.take(byte));
    }
    target.calls
}
