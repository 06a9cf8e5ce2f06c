//! A connection by UDP, TCP or a serial port, in real time.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use mavlink::error::MessageReadError;
use mavlink::{MavConnection, MavHeader};

use super::MavMessage;

/// What came: when, from whom, and the message; no message if it was malformed.
pub type Received = (Instant, Option<(MavHeader, MavMessage)>);

/// A connection whose messages a thread of its own waits for.
pub struct Connection {
    link: Arc<mavlink::Connection<MavMessage>>,
    received: Receiver<Received>,
    sequence: u8,
}

/// Failed reads in a row after which a connection is taken for closed, and the time between them.
const FAILURES: u32 = 100;
const PAUSE: Duration = Duration::from_millis(10);

impl Connection {
    /// Opens `address`: `udpin:127.0.0.1:14540`, `udpout:HOST:PORT`, `tcpout:HOST:PORT`, `serial:DEVICE:BAUD`.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(address: &str) -> io::Result<Self> {
        let mut link = mavlink::connect::<MavMessage>(address)?;
        link.set_allow_recv_any_version(true);
        let link = Arc::new(link);
        let (sender, received) = channel();
        let reader = Arc::clone(&link);
        thread::spawn(move || {
            let mut failures = 0;
            while failures < FAILURES {
                let came = match reader.recv() {
                    Ok(message) => Some(message),
                    Err(MessageReadError::Io(_)) => {
                        failures += 1;
                        thread::sleep(PAUSE);
                        continue;
                    }
                    Err(_) => None,
                };
                failures = 0;
                // Nobody waits for it any more.
                if sender.send((Instant::now(), came)).is_err() {
                    return;
                }
            }
        });
        Ok(Self {
            link,
            received,
            sequence: 0,
        })
    }

    /// What came since the last call.
    pub fn received(&self) -> impl Iterator<Item = Received> {
        self.received.try_iter()
    }

    /// Sends `message`. One that cannot be sent is lost, as on any link.
    pub fn send(&mut self, header: MavHeader, message: &MavMessage) {
        self.sequence = self.sequence.wrapping_add(1);
        let header = MavHeader {
            sequence: self.sequence,
            ..header
        };
        let _ = self.link.send(&header, message);
    }
}
