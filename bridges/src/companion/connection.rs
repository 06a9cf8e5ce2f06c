//! A connection by UDP, TCP or a serial port, in real time.

use std::io::{self, ErrorKind};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs, UdpSocket};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use mavlink::error::MessageReadError;
use mavlink::{MavConnection, MavHeader};

use super::messages::MavAutopilot;
use super::{MavMessage, wire};

/// What came: when, from whom, and the message; no message if it was malformed.
pub type Received = (Instant, Option<(MavHeader, MavMessage)>);

/// A connection whose messages a thread of its own waits for.
pub struct Connection {
    link: Link,
    received: Receiver<Received>,
    sequence: u8,
}

/// TCP and serial ports are the crate's own. Of UDP we look at the datagrams ourselves: what in them is no message is counted, and who sends
/// no message is not answered.
enum Link {
    Stream(Arc<mavlink::Connection<MavMessage>>),
    /// The socket, and whom to answer.
    Udp(UdpSocket, Arc<Mutex<Peer>>),
}

/// Whom a socket answers: who sent the last heartbeat of an autopilot, or else, while there is none, the last message. Who leads the flight, or listens to it,
/// may send to the same socket.
#[derive(Clone, Copy, Debug, Default)]
struct Peer {
    at: Option<SocketAddr>,
    is_autopilot: bool,
}

impl Peer {
    fn heard(&mut self, from: SocketAddr, messages: &[(MavHeader, MavMessage)]) {
        let is_autopilot = messages.iter().any(|(_, message)| {
            matches!(message, MavMessage::HEARTBEAT(m) if m.autopilot != MavAutopilot::MAV_AUTOPILOT_INVALID)
        });
        if is_autopilot || (!self.is_autopilot && !messages.is_empty()) {
            *self = Self {
                at: Some(from),
                is_autopilot,
            };
        }
    }
}

/// Failed reads in a row after which a connection is taken for closed, and the time between them.
const FAILURES: u32 = 100;
const PAUSE: Duration = Duration::from_millis(10);
/// Longest datagram that is read.
const LONGEST: usize = 2048;

/// Whether a read that failed so says nothing of the connection: nothing came yet, or nobody is at the other end yet.
fn passes(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::WouldBlock
            | ErrorKind::TimedOut
            | ErrorKind::Interrupted
            | ErrorKind::ConnectionRefused
    )
}

/// Reads with `read`, which says whether anybody still listens, until it fails too often in a row.
fn keep_reading(mut read: impl FnMut() -> io::Result<bool> + Send + 'static) {
    thread::spawn(move || {
        let mut failures = 0;
        while failures < FAILURES {
            match read() {
                Ok(true) => failures = 0,
                Ok(false) => return,
                Err(error) => {
                    failures += u32::from(!passes(error.kind()));
                    thread::sleep(PAUSE);
                }
            }
        }
    });
}

/// A socket that talks to `to`, and to nobody else: what others send to it is not received. For a destination on this machine it is on loopback.
fn outgoing(to: SocketAddr) -> io::Result<UdpSocket> {
    let from = match (to, to.ip().is_loopback()) {
        (SocketAddr::V4(_), true) => Ipv4Addr::LOCALHOST.into(),
        (SocketAddr::V4(_), false) => Ipv4Addr::UNSPECIFIED.into(),
        (SocketAddr::V6(_), true) => Ipv6Addr::LOCALHOST.into(),
        (SocketAddr::V6(_), false) => Ipv6Addr::UNSPECIFIED.into(),
    };
    let socket = UdpSocket::bind(SocketAddr::new(from, 0))?;
    socket.connect(to)?;
    Ok(socket)
}

/// The messages of `socket`, sent `to`.
fn udp(socket: UdpSocket, to: Option<SocketAddr>, sender: Sender<Received>) -> io::Result<Link> {
    let peer = Arc::new(Mutex::new(Peer {
        at: to,
        is_autopilot: false,
    }));
    let (reads, answers) = (socket.try_clone()?, Arc::clone(&peer));
    let mut buffer = [0; LONGEST];
    keep_reading(move || {
        let (size, from) = reads.recv_from(&mut buffer)?;
        let now = Instant::now();
        let (messages, malformed) = wire::parse(buffer.get(..size).unwrap_or_default());
        let mut peer = answers.lock().unwrap_or_else(|e| e.into_inner());
        peer.heard(from, &messages);
        drop(peer);
        let malformed = malformed.then_some(None);
        let mut came = messages.into_iter().map(Some).chain(malformed);
        Ok(came.all(|came| sender.send((now, came)).is_ok()))
    });
    Ok(Link::Udp(socket, peer))
}

/// The messages of a stream.
fn stream(address: &str, sender: Sender<Received>) -> io::Result<Link> {
    let mut link = mavlink::connect::<MavMessage>(address)?;
    link.set_allow_recv_any_version(true);
    let link = Arc::new(link);
    let reader = Arc::clone(&link);
    keep_reading(move || {
        let came = match reader.recv() {
            Ok(message) => Some(message),
            Err(MessageReadError::Io(error)) => return Err(error),
            Err(_) => None,
        };
        Ok(sender.send((Instant::now(), came)).is_ok())
    });
    Ok(Link::Stream(link))
}

impl Connection {
    /// Opens `address`: `udpin:127.0.0.1:14540`, `udpout:HOST:PORT`, `tcpout:HOST:PORT`, `serial:DEVICE:BAUD`. A socket that waits is bound to
    /// the address that is given, one that goes out to this machine to loopback.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(address: &str) -> io::Result<Self> {
        let (sender, received) = channel();
        let resolved = |place: &str| {
            let mut all = place.to_socket_addrs()?;
            all.next().ok_or(io::Error::from(ErrorKind::NotFound))
        };
        let link = match address.split_once(':') {
            Some(("udpin", place)) => udp(UdpSocket::bind(resolved(place)?)?, None, sender)?,
            Some(("udpout", place)) => {
                let to = resolved(place)?;
                udp(outgoing(to)?, Some(to), sender)?
            }
            _ => stream(address, sender)?,
        };
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
        match &self.link {
            Link::Stream(link) => {
                let _ = link.send(&header, message);
            }
            Link::Udp(socket, peer) => {
                let bytes = wire::bytes(header, message);
                let peer = peer.lock().unwrap_or_else(|e| e.into_inner()).at;
                // A connected socket takes no address.
                let _ = match (socket.peer_addr(), peer) {
                    (Ok(_), _) => socket.send(&bytes),
                    (Err(_), Some(peer)) => socket.send_to(&bytes, peer),
                    (Err(_), None) => return,
                };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::messages;
    use super::*;

    /// A ground station and somebody who leads send to the same socket: the autopilot is answered.
    #[test]
    fn the_autopilot_is_answered_whoever_else_sends() {
        let [autopilot, other] =
            [1, 2].map(|port| SocketAddr::new(Ipv4Addr::LOCALHOST.into(), port));
        let heartbeat = |autopilot| {
            let data = messages::HEARTBEAT_DATA {
                autopilot,
                ..messages::HEARTBEAT_DATA::default()
            };
            [(MavHeader::default(), MavMessage::HEARTBEAT(data))]
        };
        let station = heartbeat(MavAutopilot::MAV_AUTOPILOT_INVALID);
        let mut peer = Peer::default();
        peer.heard(autopilot, &[]);
        assert_eq!(peer.at, None);
        peer.heard(other, &station);
        assert_eq!(peer.at, Some(other));
        peer.heard(autopilot, &heartbeat(MavAutopilot::MAV_AUTOPILOT_PX4));
        peer.heard(other, &station);
        assert_eq!(peer.at, Some(autopilot));
    }

    /// It goes out from loopback, waits for somebody to be there, and hears him alone.
    #[test]
    fn an_outgoing_connection_is_on_loopback_and_hears_its_peer_alone() {
        let wait = |connection: &Connection| -> Vec<Received> {
            thread::sleep(Duration::from_millis(200));
            connection.received().collect()
        };
        let message = MavMessage::HEARTBEAT(messages::HEARTBEAT_DATA::default());
        let bytes = wire::bytes(MavHeader::default(), &message);
        let bound = || UdpSocket::bind("127.0.0.1:0").unwrap();
        let place = bound().local_addr().unwrap();
        let mut connection = Connection::open(&format!("udpout:{place}")).unwrap();
        // Refused at first.
        connection.send(MavHeader::default(), &message);
        assert!(wait(&connection).is_empty());
        let peer = UdpSocket::bind(place).unwrap();
        connection.send(MavHeader::default(), &message);
        let (_, from) = peer.recv_from(&mut [0; 300]).unwrap();
        assert!(from.ip().is_loopback());
        bound().send_to(&bytes, from).unwrap();
        assert!(wait(&connection).is_empty(), "a stranger");
        peer.send_to(&bytes, from).unwrap();
        peer.send_to(b"no message", from).unwrap();
        let came = wait(&connection);
        assert!(
            came.iter()
                .any(|(_, m)| m.as_ref().is_some_and(|(_, m)| *m == message))
        );
    }
}
