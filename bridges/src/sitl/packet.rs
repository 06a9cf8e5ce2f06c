//! The servo outputs.

use std::fmt;

/// One packet of servo outputs: 40 bytes with 16 channels, or 72 with 32. Little-endian: u16 magic, u16 frame rate, u32 frame count, the
/// pulse widths as u16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet {
    /// Rate \[Hz\] that the autopilot takes the physics to run at: it follows the time stamps of the answers.
    pub frame_rate: u16,
    /// Counts the packets; the same again if the answer was lost.
    pub frame_count: u32,
    pwm: [u16; 32],
    channels: usize,
}

/// Why bytes are no packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Malformed {
    /// This many bytes.
    Size(usize),
    /// A magic number that does not belong to the size.
    Magic(u16),
}

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size(size) => write!(f, "{size} bytes, where a packet has 40 or 72"),
            Self::Magic(magic) => write!(f, "magic number {magic}"),
        }
    }
}

impl std::error::Error for Malformed {}

/// Magic number and number of channels of each kind.
const KINDS: [(u16, usize); 2] = [(18458, 16), (29569, 32)];
const HEAD: usize = 8;

impl Packet {
    /// A packet with these pulse widths \[µs\]: those after the first 32 are left out; 32 channels if there are more than 16.
    #[must_use]
    pub fn new(frame_rate: u16, frame_count: u32, widths: &[u16]) -> Self {
        let mut pwm = [0; 32];
        pwm.iter_mut()
            .zip(widths)
            .for_each(|(to, from)| *to = *from);
        let channels = if widths.len() > 16 { 32 } else { 16 };
        Self {
            frame_rate,
            frame_count,
            pwm,
            channels,
        }
    }

    /// The packet in `bytes`.
    ///
    /// # Errors
    /// [`Malformed`]: another size, or a magic number that does not belong to it.
    pub fn parse(bytes: &[u8]) -> Result<Self, Malformed> {
        let size = |channels: usize| HEAD + 2 * channels;
        let kind = KINDS.iter().find(|(_, n)| size(*n) == bytes.len());
        let &(magic, channels) = kind.ok_or(Malformed::Size(bytes.len()))?;
        let mut words = bytes.chunks_exact(2).map(|pair| match pair {
            [low, high] => u16::from_le_bytes([*low, *high]),
            _ => 0,
        });
        let mut word = || words.next().unwrap_or(0);
        let first_word = word();
        if first_word != magic {
            return Err(Malformed::Magic(first_word));
        }
        let frame_rate = word();
        let frame_count = u32::from(word()) | u32::from(word()) << 16;
        let mut pwm = [0; 32];
        pwm.iter_mut()
            .take(channels)
            .for_each(|width| *width = word());
        Ok(Self {
            frame_rate,
            frame_count,
            pwm,
            channels,
        })
    }

    /// The packet's bytes.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let kind = KINDS.iter().find(|(_, n)| *n == self.channels);
        let magic = kind.map_or(0, |(magic, _)| *magic);
        let mut bytes = Vec::with_capacity(HEAD + 2 * self.channels);
        bytes.extend(magic.to_le_bytes());
        bytes.extend(self.frame_rate.to_le_bytes());
        bytes.extend(self.frame_count.to_le_bytes());
        for width in self.pwm.iter().take(self.channels) {
            bytes.extend(width.to_le_bytes());
        }
        bytes
    }

    /// The pulse width \[µs\] of a channel, counted from 1; 0, as of an output that is off, for one that is not there.
    #[must_use]
    pub fn channel(&self, number: u8) -> u16 {
        let index = usize::from(number).checked_sub(1);
        let there = index.filter(|&i| i < self.channels);
        there.and_then(|i| self.pwm.get(i)).copied().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bytes_are_those_that_ardupilot_sends() {
        let mut bytes = vec![
            0x1a, 0x48, 0x90, 0x01, 0x04, 0x03, 0x02, 0x01, 0xdc, 0x05, 0xe8, 0x03,
        ];
        bytes.resize(40, 0);
        let packet = Packet::parse(&bytes).unwrap();
        assert_eq!((packet.frame_rate, packet.frame_count), (400, 0x0102_0304));
        assert_eq!(
            [1, 2, 3, 0, 17].map(|n| packet.channel(n)),
            [1500, 1000, 0, 0, 0]
        );
        assert_eq!(packet.bytes(), bytes);
        let widths: Vec<u16> = (1001..1033).collect();
        let wide = Packet::new(50, 7, &widths);
        assert_eq!(wide.bytes().len(), 72);
        assert_eq!(wide.bytes()[..2], [0x81, 0x73]);
        assert_eq!(Packet::parse(&wide.bytes()), Ok(wide));
        assert_eq!((wide.channel(32), wide.channel(33)), (1032, 0));
    }

    #[test]
    fn size_and_magic_are_checked_together() {
        let bytes = Packet::new(50, 7, &[1500; 16]).bytes();
        assert_eq!(Packet::parse(&bytes[..39]), Err(Malformed::Size(39)));
        assert_eq!(Packet::parse(&[]), Err(Malformed::Size(0)));
        let mut wide = Packet::new(50, 7, &[1500; 32]).bytes();
        wide[..2].copy_from_slice(&bytes[..2]);
        assert_eq!(Packet::parse(&wide), Err(Malformed::Magic(18458)));
    }
}
