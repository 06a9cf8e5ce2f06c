//! Replies onto a serial port.

use alula_link::{MAX_FRAME, encode};
use embedded_io::Write;

use crate::flight::Reply;

/// How often, in one reply, a port may take nothing: at 1 Mbit/s a byte leaves every 10 µs, in which a port that does not
/// wait is asked some 20 times.
pub const MAX_IDLE: usize = 20 * MAX_FRAME;

/// The port did not take the whole reply. The other end drops the incomplete frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dropped;

/// Sends `reply`, waiting for the port while it takes nothing, but not for longer than [`MAX_IDLE`] attempts.
///
/// # Errors
/// The port failed, or took nothing for too long: the rest of the reply is dropped.
pub fn send(port: &mut impl Write, reply: &Reply) -> Result<(), Dropped> {
    let mut buffer = [0; MAX_FRAME];
    let mut bytes = encode(reply, &mut buffer).map_err(|_| Dropped)?;
    let mut idle = 0;
    while !bytes.is_empty() {
        match port.write(bytes) {
            Ok(0) if idle == MAX_IDLE => return Err(Dropped),
            Ok(0) => idle += 1,
            Ok(taken) => bytes = bytes.get(taken..).unwrap_or_default(),
            Err(_) => return Err(Dropped),
        }
    }
    Ok(())
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

    fn sent(limit: usize) -> (Vec<u8>, Result<(), Dropped>) {
        let mut port = Slow {
            taken: Vec::new(),
            ready: false,
            limit,
        };
        let result = send(&mut port, &Flight::default().announcement());
        (port.taken, result)
    }

    #[test]
    fn a_reply_arrives_whole_through_a_slow_port() {
        let (mut receiver, mut counters) = (Receiver::new(), Counters::default());
        let mut received = 0;
        let (bytes, result) = sent(usize::MAX);
        assert_eq!(result, Ok(()));
        for byte in bytes {
            if let Some(reply) = receiver.push::<Envelope<FromTarget>>(byte, &mut counters) {
                assert_eq!(reply, Flight::default().announcement());
                received += 1;
            }
        }
        assert_eq!(received, 1);
    }

    #[test]
    fn a_failing_port_does_not_hold_the_loop() {
        let (bytes, result) = sent(6);
        assert_eq!((bytes.len(), result), (6, Err(Dropped)));
    }

    /// Takes `left` bytes, then none for ever.
    struct Stuck {
        left: usize,
        asked: usize,
    }

    impl embedded_io::ErrorType for Stuck {
        type Error = embedded_io::ErrorKind;
    }

    impl Write for Stuck {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
            self.asked += 1;
            // Where this fails, the loop would go on for ever.
            assert!(self.asked < 100_000, "the port is asked without end");
            let taken = bytes.len().min(self.left);
            self.left -= taken;
            Ok(taken)
        }

        fn flush(&mut self) -> Result<(), Self::Error> {
            Ok(())
        }
    }

    #[test]
    fn a_port_that_takes_nothing_does_not_hold_the_loop() {
        for left in [0, 6] {
            let mut port = Stuck { left, asked: 0 };
            let reply = Flight::default().announcement();
            assert_eq!(send(&mut port, &reply), Err(Dropped));
            assert!(port.asked <= MAX_IDLE + 2, "{}", port.asked);
        }
    }
}
