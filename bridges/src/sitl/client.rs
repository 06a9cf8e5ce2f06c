//! ArduPilot's side of the conversation, for tests: what it sends, and how it reads an answer.

use super::{Packet, Sample};

/// The autopilot's end of the conversation: counts the packets, and reads the answers as ArduPilot's physics backend does.
#[derive(Debug, Default)]
pub struct Client {
    frame_count: u32,
    buffer: Vec<u8>,
}

impl Client {
    /// The bytes of the next packet. They are the same until an answer was taken.
    #[must_use]
    pub fn packet(&self, frame_rate: u16, widths: &[u16]) -> Vec<u8> {
        Packet::new(frame_rate, self.frame_count, widths).bytes()
    }

    /// Takes received bytes, and gives the state in the last line that is complete. A line ends where the next one begins, with a line
    /// feed at either end; what is behind the last line feed waits for its end.
    pub fn receive(&mut self, bytes: &[u8]) -> Option<Sample> {
        self.buffer.extend_from_slice(bytes);
        let end = self.buffer.iter().rposition(|b| *b == b'\n')?;
        let begin = self.buffer.get(..end)?.iter().rposition(|b| *b == b'\n')?;
        let line = self.buffer.get(begin + 1..end)?;
        let sample = parse(line);
        self.buffer.drain(..end);
        if sample.is_some() {
            self.frame_count += 1;
        }
        sample
    }

    /// Begins to count from 0, as an autopilot does that is started anew.
    pub fn restart(&mut self) {
        *self = Self::default();
    }
}

/// The state in a line, found as ArduPilot finds it: the section by its name, the key behind it by its name, the value two characters
/// behind that. None if a key that must be there is not, or is followed by something else.
#[must_use]
pub fn parse(line: &[u8]) -> Option<Sample> {
    let line = str::from_utf8(line).ok()?;
    let after = |section: &str, key: &str| {
        let from = line.find(section)? + section.len() + 1;
        let rest = line.get(from..)?;
        rest.get(rest.find(key)? + key.len() + 2..)
    };
    let number = |text: &str| {
        let end = text.find(|c: char| !matches!(c, '0'..='9' | '-' | '+' | '.' | 'e' | 'E'));
        text.get(..end.unwrap_or(text.len()))?.parse::<f64>().ok()
    };
    fn array<const N: usize>(text: &str) -> Option<[f64; N]> {
        let inside = text.strip_prefix('[')?;
        let mut cells = inside.get(..inside.find(']')?)?.split(',');
        let mut values = [0.0; N];
        for value in &mut values {
            *value = cells.next()?.trim().parse().ok()?;
        }
        cells.next().is_none().then_some(values)
    }
    Some(Sample {
        timestamp: after("", "timestamp").and_then(number)?,
        gyro: after("imu", "gyro").and_then(array)?,
        accel_body: after("imu", "accel_body").and_then(array)?,
        position: after("", "position").and_then(array)?,
        velocity: after("", "velocity").and_then(array)?,
        quaternion: after("", "quaternion").and_then(array)?,
        airspeed: after("", "airspeed").and_then(number),
        velocity_wind: after("", "velocity_wind").and_then(array),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(timestamp: f64) -> Sample {
        Sample {
            timestamp,
            gyro: [0.25, -0.5, 0.125],
            accel_body: [9.5, 0.0, -1.0],
            position: [1.0, 2.0, -3.0],
            velocity: [4.0, 5.0, 6.0],
            quaternion: [1.0, 0.0, 0.0, 0.0],
            airspeed: Some(7.0),
            velocity_wind: Some([8.0, 0.0, 0.0]),
        }
    }

    #[test]
    fn an_answer_is_read_as_it_was_meant_also_in_pieces() {
        let mut client = Client::default();
        assert_eq!(client.packet(400, &[1500; 16])[4..8], [0; 4]);
        let text = sample(1.0).text();
        let (a, b) = text.as_bytes().split_at(60);
        assert_eq!(client.receive(a), None);
        assert_eq!(client.receive(b), Some(sample(1.0)));
        assert_eq!(client.packet(400, &[1500; 16])[4..8], [1, 0, 0, 0]);
        // Of several the last counts.
        let two = sample(2.0).text() + &sample(3.0).text();
        assert_eq!(client.receive(two.as_bytes()), Some(sample(3.0)));
        assert_eq!(parse(b"{\"timestamp\": 1}"), None);
    }
}
