//! The host's end of the link.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use alula_link::{
    Configuration, Counters, Envelope, FromTarget, MAX_FRAME, Receiver, Refusal, Status, ToTarget,
    encode,
};
use anyhow::{Context, anyhow, bail};

use crate::flight::{Answer, Controller, Input};

/// Longest wait for an answer: of a busy machine's emulator, not of a target.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long one attempt to read waits.
pub(super) const ATTEMPT: Duration = Duration::from_millis(100);

/// A byte stream to a target. Reading gives up after a while, with `WouldBlock` or `TimedOut`.
pub trait Port: Read + Write {}
impl Port for UnixStream {}
impl Port for Box<dyn serialport::SerialPort> {}

/// The serial device `path` at the image's speed.
pub fn open_serial(path: &str) -> anyhow::Result<Box<dyn serialport::SerialPort>> {
    serialport::new(path, 1_000_000)
        .timeout(ATTEMPT)
        .open()
        .with_context(|| path.to_owned())
}

/// What a target says, without the frame it came in.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// The configuration is in force.
    Configured,
    /// The configuration was refused: why.
    Refused(String),
    /// A step's result.
    Answer(alula_link::Answer),
    /// Its status.
    Status(Status),
}

/// A target behind a port.
pub struct Target {
    port: Box<dyn Port>,
    receiver: Receiver,
    counters: Counters,
    /// Bytes read and not yet looked at.
    unread: std::collections::VecDeque<u8>,
    session: u32,
    sequence: u32,
}

impl Target {
    /// The target behind `port`, once it has been heard of: it announces itself when it starts, and as long as
    /// it is not flown.
    pub fn new(port: impl Port + 'static) -> anyhow::Result<Self> {
        // Sessions grow from run to run. (Hundredths of a second; their wrap every 497 days is the link's
        // business.)
        let now = SystemTime::now().duration_since(UNIX_EPOCH)?;
        let mut target = Self {
            port: Box::new(port),
            receiver: Receiver::new(),
            counters: Counters::default(),
            unread: Default::default(),
            session: (now.as_millis() / 10) as u32,
            sequence: 0,
        };
        target.await_status(|_| true)?;
        // Ends whatever an earlier host left half said.
        target.send(&[0])?;
        Ok(target)
    }

    /// Has the target fly `configuration` from now on.
    pub fn configure(&mut self, configuration: Configuration) -> anyhow::Result<()> {
        match self.ask(ToTarget::Configure(configuration))? {
            Said::Configured => Ok(()),
            Said::Refused(reason) => bail!("the target refuses the configuration: {reason}"),
            other => bail!("the target answers a configuration by {other:?}"),
        }
    }

    /// The target's status.
    pub fn status(&mut self) -> anyhow::Result<Status> {
        match self.ask(ToTarget::StatusRequest)? {
            Said::Status(status) => Ok(status),
            other => bail!("the target answers a request for its status by {other:?}"),
        }
    }

    /// Waits for a status announced unasked that `accept` takes.
    pub fn await_status(&mut self, accept: impl Fn(&Status) -> bool) -> anyhow::Result<Status> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            if let (_, Said::Status(status)) = self.hear(deadline)?
                && accept(&status)
            {
                return Ok(status);
            }
        }
    }

    /// Sends `message` and waits for what answers it.
    pub fn ask(&mut self, message: ToTarget) -> anyhow::Result<Said> {
        let envelope = self.envelope(message);
        let place = (envelope.session, envelope.sequence);
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(&envelope, &mut buffer).map_err(|_| anyhow!("message too long"))?;
        self.send(frame)?;
        let unasked = |said: &Said| {
            matches!(said, Said::Status(_)) && !matches!(message, ToTarget::StatusRequest)
        };
        let deadline = Instant::now() + PATIENCE;
        loop {
            let (answered, said) = self.hear(deadline)?;
            if answered == place && !unasked(&said) {
                return Ok(said);
            }
        }
    }

    /// `message` with the next number of this session.
    pub fn envelope(&mut self, message: ToTarget) -> Envelope<ToTarget> {
        self.sequence += 1;
        Envelope {
            session: self.session,
            sequence: self.sequence,
            message,
        }
    }

    /// Sends bytes as they are.
    pub fn send(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.port.write_all(bytes).context("link to the target")
    }

    /// The next thing the target says, with session and number of what it answers.
    pub fn hear(&mut self, deadline: Instant) -> anyhow::Result<((u32, u32), Said)> {
        loop {
            while let Some(byte) = self.unread.pop_front() {
                if let Some(envelope) = self.receiver.push(byte, &mut self.counters) {
                    let Envelope {
                        session,
                        sequence,
                        message,
                    } = envelope;
                    let said = match message {
                        FromTarget::Configured => Said::Configured,
                        FromTarget::Refused(Refusal { parameter, problem }) => {
                            Said::Refused(format!("{parameter}: {problem:?}"))
                        }
                        FromTarget::Answer(answer) => Said::Answer(answer),
                        FromTarget::Status(status) => Said::Status(status),
                    };
                    return Ok(((session, sequence), said));
                }
            }
            if Instant::now() > deadline {
                let Counters {
                    corrupt,
                    truncated,
                    overlong,
                    wrong_version,
                    ..
                } = self.counters;
                let damaged = corrupt + truncated + overlong;
                bail!(
                    "the target does not answer ({damaged} damaged frames, {wrong_version} of another version)"
                );
            }
            let mut buffer = [0; 256];
            match self.port.read(&mut buffer) {
                Ok(0) => bail!("the target has closed the link"),
                Ok(count) => self.unread.extend(&buffer[..count]),
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(error) => return Err(error).context("link to the target"),
            }
        }
    }
}

impl Controller for Target {
    fn answer(&mut self, input: &Input) -> anyhow::Result<Answer> {
        let input =
            alula_link::Input::new(&input.state, &input.reference, input.feed_forward.as_ref());
        match self.ask(ToTarget::Input(input))? {
            Said::Answer(answer) => answer.result().context("the target is not configured"),
            other => bail!("the target answers an input by {other:?}"),
        }
    }
}
