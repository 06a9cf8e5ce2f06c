//! Frames: a message between two zero bytes, with its version, its length and a checksum.
//!
//! `version · length of the payload · payload · CRC-32C (little-endian)`, stuffed by COBS so that the zero byte
//! ends every frame and stands nowhere else. Whatever a receiver has been through, the next zero byte puts it
//! in step again.

use crc::{CRC_32_ISCSI, Crc, Table};
use serde::{Deserialize, Serialize};

/// Version of the protocol: first byte of every frame, at the same place in every version.
pub const VERSION: u8 = 9;

/// Longest frame \[bytes\], stuffed and with its closing zero: one block of COBS.
pub const MAX_FRAME: usize = 255;

const HEADER: usize = 2;
const CHECKSUM: usize = 4;
const FRAMING: usize = 2;
/// Longest payload \[bytes\].
pub const MAX_PAYLOAD: usize = MAX_FRAME - FRAMING - CHECKSUM - HEADER;

/// CRC-32C. It finds every damage of up to 5 bits in what it covers (frames here are shorter than the 655
/// bytes that holds for) and every burst of up to 32; other damage passes with probability 2⁻³².
static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISCSI);

/// The message does not fit in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

/// Writes `message` as a frame into `buffer`; returns the bytes to send.
///
/// # Errors
/// The message is longer than [`MAX_PAYLOAD`].
pub fn encode<'a>(
    message: &impl Serialize,
    buffer: &'a mut [u8; MAX_FRAME],
) -> Result<&'a [u8], TooLong> {
    encode_as(VERSION, message, buffer)
}

pub(crate) fn encode_as<'a>(
    version: u8,
    message: &impl Serialize,
    buffer: &'a mut [u8; MAX_FRAME],
) -> Result<&'a [u8], TooLong> {
    let mut plain = [0; MAX_FRAME - FRAMING];
    let payload = postcard::to_slice(message, &mut plain[HEADER..HEADER + MAX_PAYLOAD]);
    let length = payload.map_err(|_| TooLong)?.len();
    plain[0] = version;
    plain[1] = length as u8;
    let (covered, rest) = plain.split_at_mut(HEADER + length);
    rest[..CHECKSUM].copy_from_slice(&CRC.checksum(covered).to_le_bytes());
    let stuffed = cobs::try_encode(&plain[..HEADER + length + CHECKSUM], buffer);
    let stuffed = stuffed.map_err(|_| TooLong)?;
    buffer[stuffed] = 0;
    Ok(&buffer[..=stuffed])
}

/// What a receiver has seen. Every frame is counted once, and every stretch of bytes between two zeros that is
/// not a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Whole, undamaged frames of this version.
    pub received: u32,
    /// Wrong checksum, stuffing, length or content.
    pub corrupt: u32,
    /// Ended before the length they announce.
    pub truncated: u32,
    /// Longer than any frame.
    pub overlong: u32,
    /// Undamaged frames of another version.
    pub wrong_version: u32,
    /// Received, of a session older than the current one: dropped.
    pub stale: u32,
    /// Received, not newer than the last one accepted: dropped.
    pub out_of_order: u32,
}

/// Why a stretch of bytes is not a frame.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Damage {
    Corrupt,
    Truncated,
    WrongVersion,
}

/// Finds frames in a stream of bytes. Fixed memory; the work per byte is constant, the work at a zero byte
/// bounded by [`MAX_FRAME`].
pub struct Receiver {
    buffer: [u8; MAX_FRAME],
    /// Bytes since the last zero; more than the buffer holds means that they were not kept.
    length: usize,
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}

impl Receiver {
    /// A receiver that has seen nothing.
    pub const fn new() -> Self {
        Self {
            buffer: [0; MAX_FRAME],
            length: 0,
        }
    }

    /// Takes one byte; returns the message that it completes. Counts what is received and what is damaged.
    pub fn push<'a, M: Deserialize<'a>>(
        &'a mut self,
        byte: u8,
        counters: &mut Counters,
    ) -> Option<M> {
        if byte != 0 {
            if let Some(place) = self.buffer.get_mut(self.length) {
                *place = byte;
                self.length += 1;
            }
            return None;
        }
        let length = core::mem::take(&mut self.length);
        if length == 0 {
            return None;
        }
        // The longest frame leaves room for its zero.
        if length == MAX_FRAME {
            counters.overlong += 1;
            return None;
        }
        match open(&mut self.buffer[..length]) {
            Ok(message) => {
                counters.received += 1;
                Some(message)
            }
            Err(damage) => {
                *match damage {
                    Damage::Corrupt => &mut counters.corrupt,
                    Damage::Truncated => &mut counters.truncated,
                    Damage::WrongVersion => &mut counters.wrong_version,
                } += 1;
                None
            }
        }
    }
}

fn open<'a, M: Deserialize<'a>>(stuffed: &'a mut [u8]) -> Result<M, Damage> {
    // A frame is no longer than one block of COBS, so stuffing adds one byte: its first. The length announced is the
    // third, and says what is missing even where the rest cannot be unstuffed.
    let whole = |payload: usize| 1 + HEADER + payload + CHECKSUM;
    let missing = match stuffed.get(HEADER) {
        Some(&payload) => stuffed.len() < whole(usize::from(payload)),
        None => true,
    };
    let damage = if missing {
        Damage::Truncated
    } else {
        Damage::Corrupt
    };
    let length = cobs::decode_in_place(stuffed).map_err(|_| damage)?;
    let (covered, checksum) = stuffed[..length]
        .split_last_chunk::<CHECKSUM>()
        .ok_or(damage)?;
    let &[version, announced, ref payload @ ..] = covered else {
        return Err(damage);
    };
    if usize::from(announced) != payload.len()
        || CRC.checksum(covered) != u32::from_le_bytes(*checksum)
    {
        return Err(damage);
    }
    if version != VERSION {
        return Err(Damage::WrongVersion);
    }
    postcard::from_bytes(payload).map_err(|_| Damage::Corrupt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damage::Mangler;
    use crate::{
        Admission, Configuration, ControllerParameters, Envelope, Law, LawGains, Order, Pacing,
        ToTarget,
    };
    use alula::planar::GainParameters;
    use alula::{LargeAngleParameters, ModelParameters, VehicleParameters};
    use std::vec::Vec;

    fn message(session: u32, sequence: u32) -> Envelope<ToTarget> {
        Envelope {
            session,
            sequence,
            message: ToTarget::Configure(Configuration {
                vehicle: VehicleParameters::PAPER.mass(sequence as f32),
                model: ModelParameters::LargeAngle(LargeAngleParameters {
                    c0: 0.014,
                    c1: 0.95,
                }),
                controller: ControllerParameters::Law {
                    law: Law::Robust,
                    gains: LawGains::Constant(GainParameters::PAPER),
                },
                pacing: Pacing::Timer,
            }),
        }
    }

    fn frame() -> Vec<u8> {
        encode(&message(3, 700), &mut [0; MAX_FRAME])
            .unwrap()
            .to_vec()
    }

    fn receive(bytes: &[u8]) -> (Vec<Envelope<ToTarget>>, Counters) {
        let (mut receiver, mut counters) = (Receiver::new(), Counters::default());
        let messages = bytes
            .iter()
            .filter_map(|&b| receiver.push(b, &mut counters))
            .collect();
        (messages, counters)
    }

    /// Whether `bytes`, then a good frame, give that frame only, and `counters` for the bytes.
    fn gives(bytes: &[u8], counters: Counters) -> bool {
        let (messages, counted) = receive(&[bytes, &frame()].concat());
        messages == [message(3, 700)]
            && counted
                == Counters {
                    received: 1,
                    ..counters
                }
    }

    #[test]
    fn the_checksum_is_the_catalogues() {
        assert_eq!(CRC.checksum(b"123456789"), 0xE306_9283);
        // Laid out as documented: version, length, payload, checksum, with zeros stuffed by the first rule of
        // COBS, by hand for a payload without zeros: one leading code.
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(&(7u8, 9u8), &mut buffer).unwrap();
        let plain = [VERSION, 2, 7, 9];
        let sum = CRC.checksum(&plain).to_le_bytes();
        assert!(sum.iter().all(|&b| b != 0));
        assert_eq!(frame, [&[9][..], &plain, &sum, &[0]].concat());
    }

    #[test]
    fn every_cut_is_counted_as_truncated() {
        let frame = frame();
        for end in 1..frame.len() - 1 {
            let truncated = Counters {
                truncated: 1,
                ..Counters::default()
            };
            assert!(gives(&[&frame[..end], &[0]].concat(), truncated), "{end}");
        }
    }

    #[test]
    fn one_or_two_wrong_bits_are_always_found() {
        let frame = frame();
        let bits = 8 * (frame.len() - 1);
        let flip = |bytes: &mut [u8], bit: usize| bytes[bit / 8] ^= 1 << (bit % 8);
        for a in 0..bits {
            for b in a..bits {
                let mut damaged = frame.clone();
                flip(&mut damaged, a);
                if b > a {
                    flip(&mut damaged, b);
                }
                let (messages, counters) = receive(&damaged);
                assert!(messages.is_empty() && counters.received == 0, "{a} {b}");
            }
        }
    }

    #[test]
    fn what_is_longer_than_a_frame_is_skipped() {
        for length in [MAX_FRAME, MAX_FRAME + 1, 10 * MAX_FRAME] {
            let mut noise = std::vec![0x55; length];
            noise.push(0);
            let overlong = Counters {
                overlong: 1,
                ..Counters::default()
            };
            assert!(gives(&noise, overlong));
        }
        assert!(gives(&[0; 1000], Counters::default()));
    }

    #[test]
    fn another_version_is_counted_and_dropped() {
        let mut buffer = [0; MAX_FRAME];
        let foreign = encode_as(VERSION + 1, &message(3, 701), &mut buffer).unwrap();
        let wrong_version = Counters {
            wrong_version: 1,
            ..Counters::default()
        };
        assert!(gives(foreign, wrong_version));
    }

    #[test]
    fn a_hundred_thousand_damaged_frames() {
        const DAMAGED: usize = 100_000;
        let mut mangler = Mangler::new(20);
        let (mut receiver, mut order) = (Receiver::new(), Order::default());
        let mut counters = Counters::default();
        let (mut accepted, mut sessions) = (0, 0);
        let mut receive = |bytes: &[u8]| {
            for &byte in bytes {
                if let Some(m) = receiver.push::<Envelope<ToTarget>>(byte, &mut counters) {
                    // What passes is what was sent, to the bit: the message repeats its number.
                    assert_eq!(m, message(m.session, m.sequence));
                    match order.admit(m.session, m.sequence, &mut counters) {
                        Some(Admission::NewSession) => sessions += 1,
                        Some(Admission::Next) => accepted += 1,
                        None => {}
                    }
                }
            }
        };
        for n in 0..DAMAGED as u32 {
            let (session, sequence) = (1 + n / 1000, 2 * (n % 1000));
            receive(&mangler.genuine(&message(session, sequence)));
            receive(&mangler.damaged(&message(session, sequence + 1)));
        }
        receive(&mangler.end());
        let expected = mangler.expected();
        assert!(expected.agrees(&counters), "{expected:?} {counters:?}");
        assert_eq!(
            accepted + sessions,
            expected.received - expected.stale - expected.out_of_order
        );
        // The stream had something of everything.
        for count in [
            expected.stale,
            expected.out_of_order,
            expected.wrong_version,
            expected.overlong,
            counters.corrupt,
            counters.truncated,
        ] {
            assert!(count > 500, "{expected:?} {counters:?}");
        }
    }
}
