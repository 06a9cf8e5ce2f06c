//! A stream of genuine, damaged and stray bytes for tests, with what a receiver must make of it.

use std::collections::{HashMap, HashSet};
use std::vec::Vec;

use crate::frame::{MAX_FRAME, VERSION, encode_as};
use crate::{Counters, Envelope, ToTarget};

/// Makes the stream. Genuine messages come from the caller; the damage from a fixed sequence of random numbers.
pub struct Mangler {
    random: u64,
    /// Recent genuine frames, to replay and to splice.
    past: Vec<Vec<u8>>,
    /// Every undamaged stretch between zeros, and its message's place.
    genuine: HashMap<Vec<u8>, (u32, u32)>,
    /// The same for other versions.
    foreign: HashSet<Vec<u8>>,
    /// The end of the stream since its last zero.
    open: Vec<u8>,
    expected: Expected,
    last: Option<(u32, u32)>,
    accepted: HashSet<(u32, u32)>,
}

/// What a receiver must have counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Expected {
    /// Undamaged frames of this version, in order or not.
    pub received: u32,
    /// Of those, from an older session.
    pub stale: u32,
    /// Of those, not newer than the last accepted.
    pub out_of_order: u32,
    /// Undamaged frames of another version.
    pub wrong_version: u32,
    /// Stretches longer than any frame.
    pub overlong: u32,
    /// All other stretches: corrupt or truncated.
    pub damaged: u32,
}

impl Expected {
    /// Whether a receiver that counted this much agrees.
    pub fn agrees(&self, counters: &Counters) -> bool {
        *self
            == Self {
                received: counters.received,
                stale: counters.stale,
                out_of_order: counters.out_of_order,
                wrong_version: counters.wrong_version,
                overlong: counters.overlong,
                damaged: counters.corrupt + counters.truncated,
            }
    }
}

impl Mangler {
    /// A stream fixed by `seed`.
    pub fn new(seed: u64) -> Self {
        Self {
            random: seed | 1,
            past: Vec::new(),
            genuine: HashMap::new(),
            foreign: HashSet::new(),
            open: Vec::new(),
            expected: Expected::default(),
            last: None,
            accepted: HashSet::new(),
        }
    }

    /// The frame of `envelope`, undamaged.
    pub fn genuine(&mut self, envelope: &Envelope<ToTarget>) -> Vec<u8> {
        let frame = self.frame(VERSION, envelope);
        if self.past.len() == 64 {
            let oldest = self.below(64);
            self.past.swap_remove(oldest);
        }
        self.past.push(frame.clone());
        self.sent(&frame);
        frame
    }

    /// A damaged frame of `envelope`, or something else that is no news to a receiver. (Should a damage undo
    /// another, the stream carries `envelope` itself, and it is expected.)
    pub fn damaged(&mut self, envelope: &Envelope<ToTarget>) -> Vec<u8> {
        let mut bytes = self.frame(VERSION, envelope);
        let end = bytes.len() - 1;
        match self.below(10) {
            // Bits flipped, zeros made or unmade.
            0 | 1 => {
                for _ in 0..=self.below(8) {
                    let (place, bit) = (self.below(bytes.len()), self.below(8));
                    bytes[place] ^= 1 << bit;
                }
            }
            // The tail lost, but not the zero.
            2 => drop(bytes.drain(1 + self.below(end - 1)..end)),
            // The tail lost with the zero.
            3 => bytes.truncate(1 + self.below(end)),
            // Bytes lost inside.
            4 => {
                let from = self.below(end - 1);
                let to = from + 1 + self.below(end - 1 - from);
                drop(bytes.drain(from..to));
            }
            // Bytes gained.
            5 => {
                for _ in 0..=self.below(4) {
                    let (place, byte) = (self.below(end), self.byte());
                    bytes.insert(place, byte);
                }
            }
            // The head of one frame and the tail of another.
            6 => {
                let other = self.earlier();
                bytes.truncate(1 + self.below(end));
                bytes.extend(&other[self.below(other.len())..]);
            }
            // Said before.
            7 => bytes = self.earlier(),
            // Noise, sometimes longer than any frame.
            8 => {
                bytes.clear();
                for _ in 0..=self.below(2 * MAX_FRAME) {
                    let byte = self.byte();
                    bytes.push(if self.below(100) == 0 { 0 } else { byte | 1 });
                }
                bytes.push(0);
            }
            // Another version of the protocol.
            _ => {
                let version = VERSION.wrapping_add(1 + self.below(200) as u8);
                bytes = self.frame(version, envelope);
            }
        }
        self.sent(&bytes);
        bytes
    }

    /// The end of the stream: a zero byte, after which the receiver must agree with [`Self::expected`].
    pub fn end(&mut self) -> [u8; 1] {
        self.sent(&[0]);
        [0]
    }

    /// What the receiver must have counted when the stream is at a zero byte.
    pub fn expected(&self) -> Expected {
        self.expected
    }

    /// Session and number of every message that the receiver must have acted on.
    pub fn accepted(&self) -> &HashSet<(u32, u32)> {
        &self.accepted
    }

    fn frame(&mut self, version: u8, envelope: &Envelope<ToTarget>) -> Vec<u8> {
        let mut buffer = [0; MAX_FRAME];
        let Ok(frame) = encode_as(version, envelope, &mut buffer) else {
            panic!("message too long");
        };
        let stretch = frame[..frame.len() - 1].to_vec();
        if version == VERSION {
            let place = (envelope.session, envelope.sequence);
            self.genuine.insert(stretch, place);
        } else {
            self.foreign.insert(stretch);
        }
        frame.to_vec()
    }

    /// Judges what was sent by comparing it with the genuine frames: no checksum, no unstuffing.
    fn sent(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if byte != 0 {
                self.open.push(byte);
                continue;
            }
            let stretch = core::mem::take(&mut self.open);
            if stretch.is_empty() {
                continue;
            }
            let expected = &mut self.expected;
            if let Some(&(session, sequence)) = self.genuine.get(&stretch) {
                expected.received += 1;
                match self.last {
                    Some((current, _)) if session < current => expected.stale += 1,
                    Some(last) if (session, sequence) <= last => expected.out_of_order += 1,
                    _ => {
                        self.last = Some((session, sequence));
                        self.accepted.insert((session, sequence));
                    }
                }
            } else if self.foreign.contains(&stretch) {
                expected.wrong_version += 1;
            } else if stretch.len() >= MAX_FRAME {
                expected.overlong += 1;
            } else {
                expected.damaged += 1;
            }
        }
    }

    fn earlier(&mut self) -> Vec<u8> {
        let place = self.below(self.past.len());
        self.past[place].clone()
    }

    fn byte(&mut self) -> u8 {
        self.below(256) as u8
    }

    /// Steele and Vigna's splitmix64.
    fn below(&mut self, limit: usize) -> usize {
        self.random = self.random.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.random ^ (self.random >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % limit as u64) as usize
    }
}
