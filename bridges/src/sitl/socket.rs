//! The conversation on a socket.

use std::io::{self, ErrorKind};
use std::net::UdpSocket;
use std::time::Duration;

use super::{Counts, Lockstep, Physics};

/// How often \[ms\] `go_on` is asked while nothing comes.
const IDLE: u64 = 100;

/// Answers what comes to `socket`, each to its sender, for as long as `go_on`, which is told what came so far.
///
/// # Errors
/// The socket fails.
pub fn run(
    socket: &UdpSocket,
    physics: &mut dyn Physics,
    mut go_on: impl FnMut(&Counts) -> bool,
) -> io::Result<Counts> {
    socket.set_read_timeout(Some(Duration::from_millis(IDLE)))?;
    let mut lockstep = Lockstep::default();
    // Longer than any packet, so that a longer one is seen to be malformed.
    let mut buffer = [0; 128];
    while go_on(&lockstep.counts()) {
        let (size, sender) = match socket.recv_from(&mut buffer) {
            Ok(received) => received,
            // Nothing came; a signal; or word that an answer found nobody.
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock
                | ErrorKind::TimedOut
                | ErrorKind::Interrupted
                | ErrorKind::ConnectionReset
                | ErrorKind::ConnectionRefused => continue,
                _ => return Err(error),
            },
        };
        let received = buffer.get(..size).unwrap_or_default();
        if let Some(answer) = lockstep.receive(received, physics) {
            // An answer that is not sent is asked for again.
            let _ = socket.send_to(answer, sender);
        }
    }
    Ok(lockstep.counts())
}
