//! Replies onto a serial port.

use alula_link::{MAX_FRAME, encode};
use embedded_io::Write;

use crate::flight::Reply;

/// Sends `reply`, waiting for the port while it takes nothing. Where a port fails the rest is not sent: the
/// other end drops the incomplete frame.
pub fn send(port: &mut impl Write, reply: &Reply) {
    let mut buffer = [0; MAX_FRAME];
    let mut bytes = encode(reply, &mut buffer).unwrap_or_default();
    while !bytes.is_empty() {
        match port.write(bytes) {
            Ok(taken) => bytes = &bytes[taken..],
            Err(_) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::Flight;
    use alula_link::{Counters, Envelope, FromTarget, Receiver};
    use std::vec::Vec;

    /// Takes three bytes at every second attempt, and fails after `limit` bytes.
    struct Slow {
        taken: Vec<u8>,
        ready: bool,
        limit: usize,
    }

    impl embedded_io::ErrorType for Slow {
        type Error = embedded_io::ErrorKind;
    }

    impl Write for Slow {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
            if self.taken.len() >= self.limit {
                return Err(embedded_io::ErrorKind::Other);
            }
            self.ready = !self.ready;
            let count = if self.ready { bytes.len().min(3) } else { 0 };
            self.taken.extend(&bytes[..count]);
            Ok(count)
        }

        fn flush(&mut self) -> Result<(), Self::Error> {
            Ok(())
        }
    }

    fn sent(limit: usize) -> Vec<u8> {
        let mut port = Slow {
            taken: Vec::new(),
            ready: false,
            limit,
        };
        send(&mut port, &Flight::default().announcement());
        port.taken
    }

    #[test]
    fn a_reply_arrives_whole_through_a_slow_port() {
        let (mut receiver, mut counters) = (Receiver::new(), Counters::default());
        let mut received = 0;
        for byte in sent(usize::MAX) {
            if let Some(reply) = receiver.push::<Envelope<FromTarget>>(byte, &mut counters) {
                assert_eq!(reply, Flight::default().announcement());
                received += 1;
            }
        }
        assert_eq!(received, 1);
    }

    #[test]
    fn a_failing_port_does_not_hold_the_loop() {
        assert_eq!(sent(6).len(), 6);
    }
}
