//! Messages from and to bytes.

use mavlink::{MAVLinkMessageRaw, MAVLinkV2MessageRaw, MavHeader, MavlinkReader, Message, consts};

use super::MavMessage;

/// A message with its header; none for bytes that are none of ours: cut off, of a wrong checksum, of an unknown kind.
pub type Came = Option<(MavHeader, MavMessage)>;

/// The messages in a stream of bytes.
///
/// Never panics, whatever the bytes.
#[derive(Default)]
pub struct Stream {
    /// What may still become a message.
    unread: Vec<u8>,
}

impl Stream {
    /// What is in the stream up to these bytes and was not before. A run of bytes between two messages counts as one malformed packet, unless it is of
    /// whole messages of another dialect, of which nothing is said.
    pub fn push(&mut self, bytes: &[u8]) -> Vec<Came> {
        self.unread.extend(bytes);
        let mut came = Vec::new();
        let mut rest = self.unread.as_slice();
        let mut reader = MavlinkReader::new(rest);
        // The reader passes over what has a wrong checksum, and does not say so: it is what stands before the next frame.
        while let Ok(raw) = reader.read_any_raw_message::<MavMessage>() {
            let frame = match &raw {
                MAVLinkMessageRaw::V1(raw) => raw.raw_bytes(),
                MAVLinkMessageRaw::V2(raw) => raw.raw_bytes(),
            };
            let at = rest.windows(frame.len()).position(|x| x == frame);
            let at = at.unwrap_or_default();
            if !is_foreign(rest.get(..at).unwrap_or_default()) {
                came.push(None);
            }
            rest = rest.get(at + frame.len()..).unwrap_or_default();
            let header = MavHeader {
                system_id: raw.system_id(),
                component_id: raw.component_id(),
                sequence: raw.sequence(),
            };
            let message = MavMessage::parse(raw.version(), raw.message_id(), raw.payload());
            came.push(message.ok().map(|message| (header, message)));
        }
        // No frame is longer.
        if rest.len() > consts::MAX_FRAME_SIZE {
            came.push(None);
            rest = rest
                .get(rest.len() - consts::MAX_FRAME_SIZE..)
                .unwrap_or_default();
        }
        self.unread = rest.to_vec();
        came
    }
}

/// The messages in the bytes of a datagram, and whether anything in it was none of ours.
///
/// Never panics, whatever the bytes.
#[must_use]
pub fn parse(bytes: &[u8]) -> (Vec<(MavHeader, MavMessage)>, bool) {
    let mut stream = Stream::default();
    let came = stream.push(bytes);
    let malformed = bytes.is_empty() || !is_foreign(&stream.unread) || came.contains(&None);
    (came.into_iter().flatten().collect(), malformed)
}

/// Whether bytes are nothing but whole frames of messages that are not in our dialect. Their checksums have a part that only their dialect knows.
fn is_foreign(mut bytes: &[u8]) -> bool {
    while !bytes.is_empty() {
        let (length, id) = match *bytes {
            [mavlink::MAV_STX, payload, ..] => (
                8 + usize::from(payload),
                bytes.get(5).map(|id| u32::from(*id)),
            ),
            [mavlink::MAV_STX_V2, payload, flags, ..] => {
                let signature = if flags & SIGNED == 0 { 0 } else { 13 };
                let id = bytes.get(7..10).map(|id| match *id {
                    [a, b, c] => u32::from_le_bytes([a, b, c, 0]),
                    _ => 0,
                });
                (12 + usize::from(payload) + signature, id)
            }
            _ => return false,
        };
        let known = id.is_none_or(|id| MavMessage::default_message_from_id(id).is_some());
        match bytes.get(length..) {
            Some(rest) if !known => bytes = rest,
            _ => return false,
        }
    }
    true
}

/// The flag of a frame that is signed.
const SIGNED: u8 = 1;

/// The bytes of a message in a MAVLink 2 frame.
#[must_use]
pub fn bytes(header: MavHeader, message: &MavMessage) -> Vec<u8> {
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message(header, message);
    raw.raw_bytes().to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavlink::dialects::ardupilotmega::{HEARTBEAT_DATA, VFR_HUD_DATA};

    #[test]
    fn several_messages_of_a_datagram_are_found_and_damage_is_noticed() {
        let header = MavHeader {
            system_id: 1,
            component_id: 1,
            sequence: 7,
        };
        let heartbeat = MavMessage::HEARTBEAT(HEARTBEAT_DATA {
            custom_mode: 6 << 16,
            ..HEARTBEAT_DATA::default()
        });
        let hud = MavMessage::VFR_HUD(VFR_HUD_DATA {
            airspeed: 12.5,
            ..VFR_HUD_DATA::default()
        });
        let mut both = bytes(header, &heartbeat);
        both.extend(bytes(header, &hud));
        let sound = vec![(header, heartbeat.clone()), (header, hud)];
        assert_eq!(parse(&both), (sound, false));
        // A flipped bit of the second one's payload.
        let last = both.len() - 4;
        both[last] ^= 1;
        assert_eq!(parse(&both), (vec![(header, heartbeat)], true));
        assert_eq!(parse(b"no message"), (Vec::new(), true));
        assert_eq!(parse(b""), (Vec::new(), true));
    }

    /// A frame of an id that nobody here knows, signed and not, of either version: nothing of ours, and no damage. One of an id that is known and
    /// has a wrong checksum is damage.
    #[test]
    fn messages_of_other_dialects_are_no_damage() {
        let ours = bytes(
            MavHeader::default(),
            &MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()),
        );
        let second = |id: u32, flags: u8| {
            let [a, b, c, _] = id.to_le_bytes();
            let mut frame = vec![0xfd, 3, flags, 0, 7, 1, 1, a, b, c, 1, 2, 3, 0xaa, 0xbb];
            frame.resize(frame.len() + if flags == 1 { 13 } else { 0 }, 9);
            frame
        };
        let first = vec![0xfe, 2, 7, 1, 1, 223, 1, 2, 0xaa, 0xbb];
        for foreign in [second(60_000, 0), second(60_000, 1), first] {
            assert_eq!(parse(&foreign), (Vec::new(), false));
            let all = [&foreign[..], &ours, &foreign, &foreign, &ours].concat();
            let (messages, malformed) = parse(&all);
            assert_eq!((messages.len(), malformed), (2, false));
            let mut stream = Stream::default();
            let came: Vec<_> = all.chunks(5).flat_map(|x| stream.push(x)).collect();
            assert_eq!(came.len(), 2);
            assert!(parse(&foreign[..foreign.len() - 1]).1, "cut off");
        }
        assert!(parse(&second(0, 0)).1, "a heartbeat with a wrong checksum");
    }

    /// By one byte or by many at a time, with damage between them, which counts.
    #[test]
    fn a_stream_is_read_however_it_is_cut() {
        let frame = |sequence: u8| {
            let header = MavHeader {
                system_id: 1,
                component_id: 1,
                sequence,
            };
            bytes(header, &MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()))
        };
        let mut all = Vec::new();
        for sequence in 0..20 {
            all.extend(frame(sequence));
            let mut damaged = frame(100);
            damaged[12] ^= 4;
            all.extend(damaged);
            all.extend(b"\xfd\xff noise \xfe");
        }
        // What looks like the beginning of a long frame is known to be none once that frame would have ended.
        all.extend([0; 2 * consts::MAX_FRAME_SIZE]);
        for size in [1, 7, 64, all.len()] {
            let mut stream = Stream::default();
            let came: Vec<_> = all.chunks(size).flat_map(|x| stream.push(x)).collect();
            let sequences = came.iter().flatten().map(|(header, _)| header.sequence);
            assert!(sequences.eq(0..20), "{size}");
            assert!(came.iter().filter(|x| x.is_none()).count() >= 20, "{size}");
            assert!(stream.unread.len() <= consts::MAX_FRAME_SIZE);
        }
    }
}
