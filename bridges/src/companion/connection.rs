//! A connection by UDP, TCP or a serial port, in real time.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpStream, ToSocketAddrs, UdpSocket};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use mavlink::MavHeader;

use super::MavMessage;
use super::inbox::is_beat;
use super::wire::{self, Came};

/// What came: when, from whom, and the message; no message if it was malformed.
pub type Received = (Instant, Came);

/// A connection whose messages a thread of its own waits for.
pub struct Connection {
    link: Link,
    received: Receiver<Received>,
    sequence: u8,
}

/// The bytes are looked at here: what in them is no message is counted, and who sends no message is not answered.
enum Link {
    /// A TCP connection or a serial port.
    Stream(Box<dyn Write + Send>),
    /// The socket, and whom to answer.
    Udp(UdpSocket, Arc<Mutex<Peer>>),
}

/// Whom a socket answers: who sent the first heartbeat of an autopilot, or else, while there is none, the last message. Who leads the flight, or listens to it,
/// may send to the same socket, and so may other vehicles.
#[derive(Clone, Copy, Debug, Default)]
struct Peer {
    at: Option<SocketAddr>,
    /// The autopilot's system, and when its last heartbeat came from there.
    autopilot: Option<(u32, Instant)>,
}

/// Time without a heartbeat from its place after which an autopilot may be at another one: it was started anew.
const GONE: Duration = Duration::from_secs(4);

impl Peer {
    fn heard(&mut self, now: Instant, from: SocketAddr, messages: &[(MavHeader, MavMessage)]) {
        let beats = |(header, message): &&(MavHeader, MavMessage)| is_beat(header, message);
        let system = messages
            .iter()
            .find(beats)
            .map(|(header, _)| header.system_id);
        let takes = match (system, self.autopilot) {
            (Some(system), Some((known, last))) => {
                system == known && (self.at == Some(from) || now - last > GONE)
            }
            (Some(_), None) => true,
            (None, Some(_)) => false,
            (None, None) => !messages.is_empty(),
        };
        if takes {
            *self = Self {
                at: Some(from),
                autopilot: system.map(|system| (system, now)),
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
        autopilot: None,
    }));
    let (reads, answers) = (socket.try_clone()?, Arc::clone(&peer));
    let mut buffer = [0; LONGEST];
    keep_reading(move || {
        let (size, from) = reads.recv_from(&mut buffer)?;
        let now = Instant::now();
        let (messages, malformed) = wire::parse(buffer.get(..size).unwrap_or_default());
        let mut peer = answers.lock().unwrap_or_else(|e| e.into_inner());
        peer.heard(now, from, &messages);
        drop(peer);
        let malformed = malformed.then_some(None);
        let mut came = messages.into_iter().map(Some).chain(malformed);
        Ok(came.all(|came| sender.send((now, came)).is_ok()))
    });
    Ok(Link::Udp(socket, peer))
}

/// The messages of a stream of bytes, one end of which is read and the other written.
fn stream(
    mut read: impl Read + Send + 'static,
    write: impl Write + Send + 'static,
    sender: Sender<Received>,
) -> Link {
    let mut stream = wire::Stream::default();
    let mut buffer = [0; LONGEST];
    keep_reading(move || {
        let size = read.read(&mut buffer)?;
        if size == 0 {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        let now = Instant::now();
        let mut came = stream
            .push(buffer.get(..size).unwrap_or_default())
            .into_iter();
        Ok(came.all(|came| sender.send((now, came)).is_ok()))
    });
    Link::Stream(Box::new(write))
}

/// The serial port `DEVICE:BAUD`.
fn serial(place: &str) -> io::Result<Box<dyn serialport::SerialPort>> {
    let invalid = || io::Error::new(ErrorKind::InvalidInput, "must be serial:DEVICE:BAUD");
    let (device, baud) = place.rsplit_once(':').ok_or_else(invalid)?;
    let baud = baud.parse().map_err(|_| invalid())?;
    Ok(serialport::new(device, baud).timeout(PAUSE).open()?)
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
            Some(("tcpout", place)) => {
                let write = TcpStream::connect(resolved(place)?)?;
                write.set_nodelay(true)?;
                stream(write.try_clone()?, write, sender)
            }
            Some(("serial", place)) => {
                let write = serial(place)?;
                stream(write.try_clone()?, write, sender)
            }
            _ => {
                let known =
                    "must be udpin:, udpout:, tcpout: with HOST:PORT, or serial:DEVICE:BAUD";
                return Err(io::Error::new(ErrorKind::InvalidInput, known));
            }
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
        let bytes = wire::bytes(header, message);
        match &mut self.link {
            Link::Stream(link) => {
                let _ = link.write_all(&bytes);
            }
            Link::Udp(socket, peer) => {
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
    use super::super::messages::{self, MavAutopilot};
    use super::*;

    /// A ground station and somebody who leads send to the same socket: the autopilot is answered.
    #[test]
    fn the_autopilot_is_answered_whoever_else_sends() {
        let [place, moved, other] =
            [1, 2, 3].map(|port| SocketAddr::new(Ipv4Addr::LOCALHOST.into(), port));
        let heartbeat = |system_id, component_id, autopilot| {
            let data = messages::HEARTBEAT_DATA {
                autopilot,
                ..messages::HEARTBEAT_DATA::default()
            };
            let header = MavHeader {
                system_id,
                component_id,
                sequence: 0,
            };
            [(header, MavMessage::HEARTBEAT(data))]
        };
        let autopilot = heartbeat(1, 1, MavAutopilot::MAV_AUTOPILOT_PX4);
        let station = heartbeat(255, 190, MavAutopilot::MAV_AUTOPILOT_INVALID);
        let begin = Instant::now();
        let at = |seconds| begin + Duration::from_secs(seconds);
        let mut peer = Peer::default();
        peer.heard(begin, place, &[]);
        assert_eq!(peer.at, None);
        peer.heard(begin, other, &station);
        assert_eq!(peer.at, Some(other));
        peer.heard(begin, place, &autopilot);
        // A ground station, a camera that leaves open what it is, another vehicle, and another program that calls itself the autopilot.
        let camera = heartbeat(1, 191, MavAutopilot::MAV_AUTOPILOT_GENERIC);
        let vehicle = heartbeat(2, 1, MavAutopilot::MAV_AUTOPILOT_PX4);
        for beat in [station, camera, vehicle, autopilot.clone()] {
            peer.heard(at(3), other, &beat);
            assert_eq!(peer.at, Some(place));
        }
        // Started anew, from another port: its old place is silent.
        peer.heard(at(3), place, &autopilot);
        peer.heard(at(6), moved, &autopilot);
        assert_eq!(peer.at, Some(place));
        peer.heard(at(8), moved, &autopilot);
        assert_eq!(peer.at, Some(moved));
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

    /// What is no message is counted over TCP too, and what is sent arrives.
    #[test]
    fn damage_of_a_stream_is_counted() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let place = listener.local_addr().unwrap();
        let mut connection = Connection::open(&format!("tcpout:{place}")).unwrap();
        let (mut other, _) = listener.accept().unwrap();
        let message = MavMessage::HEARTBEAT(messages::HEARTBEAT_DATA::default());
        let sound = wire::bytes(MavHeader::default(), &message);
        let mut damaged = sound.clone();
        damaged[11] ^= 1;
        for bytes in [&sound, &damaged, &sound] {
            other.write_all(bytes).unwrap();
        }
        let mut came = Vec::new();
        while came.len() < 3 {
            came.extend(connection.received.recv_timeout(Duration::from_secs(10)));
        }
        let is_message: Vec<_> = came.iter().map(|(_, came)| came.is_some()).collect();
        assert_eq!(is_message, [true, false, true]);
        connection.send(MavHeader::default(), &message);
        let mut answer = vec![0; sound.len()];
        other.read_exact(&mut answer).unwrap();
        assert_eq!(wire::parse(&answer).0[0].1, message);
        // Others are refused, and what they must be is said.
        for wrong in [
            "tcp:x",
            "serial:/dev/null",
            "serial:/dev/null:fast",
            "udpin",
        ] {
            let error = Connection::open(wrong).err().unwrap();
            assert_eq!(error.kind(), ErrorKind::InvalidInput, "{wrong}");
        }
    }
}
