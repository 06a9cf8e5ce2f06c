//! Messages from and to bytes.

use mavlink::error::MessageReadError;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkReader};

use super::MavMessage;

/// The messages in the bytes of a datagram, and whether anything in it was none of ours: cut off, of a wrong checksum, unknown.
///
/// Never panics, whatever the bytes.
#[must_use]
pub fn parse(bytes: &[u8]) -> (Vec<(MavHeader, MavMessage)>, bool) {
    let mut messages = Vec::new();
    let mut malformed = false;
    let mut used = 0;
    let mut reader = MavlinkReader::new(bytes);
    // Each turn takes at least one byte.
    for _ in 0..=bytes.len() {
        match reader.read_any_message::<MavMessage>() {
            Ok((header, message)) => {
                used += 1;
                messages.push((header, message));
            }
            Err(MessageReadError::Io(_)) => break,
            Err(_) => malformed = true,
        }
    }
    malformed |= used == 0;
    (messages, malformed)
}

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
        assert_eq!(parse(&both).0, [(header, heartbeat)]);
        assert_eq!(parse(b"no message"), (Vec::new(), true));
        assert_eq!(parse(b""), (Vec::new(), true));
    }
}
