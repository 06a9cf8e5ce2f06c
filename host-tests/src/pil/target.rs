//! The host's end of the link.

use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use alula_link::{
    Configuration, ControllerParameters, Counters, Envelope, FromTarget, MAX_FRAME, Receiver,
    RefusedParameter, Status, ToTarget, encode,
};
use anyhow::{Context, anyhow, bail};

use alula_sim::controllers::{Answer, Controller, Input, Planar};

/// Longest wait for an answer: of a busy machine's emulator, not of a target.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long one attempt to read waits.
pub(super) const ATTEMPT: Duration = Duration::from_millis(100);

/// A byte stream to a target. Reading gives up after a while, with `WouldBlock` or `TimedOut`.
pub trait Port: Read + Write + Send {}
impl Port for UnixStream {}
impl Port for Box<dyn serialport::SerialPort> {}

/// The serial device `path` at the image's speed.
pub fn open_serial(path: &str) -> anyhow::Result<Box<dyn serialport::SerialPort>> {
    serialport::new(path, 1_000_000)
        .timeout(ATTEMPT)
        .open()
        .with_context(|| path.to_owned())
}

/// A message from a target, without the frame it came in.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
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
    /// The controller configured takes the guidance's input, not a law's.
    guided: bool,
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
            guided: false,
        };
        target.await_status(|_| true)?;
        // Ends a frame that an earlier host has left open.
        target.send(&[0])?;
        Ok(target)
    }

    /// Has the target fly `configuration` from now on.
    pub fn configure(&mut self, configuration: Configuration) -> anyhow::Result<()> {
        self.guided = matches!(
            configuration.controller,
            ControllerParameters::Guidance { .. }
        );
        match self.ask(ToTarget::Configure(configuration))? {
            Heard::Configured => Ok(()),
            Heard::Refused(reason) => bail!("the target refuses the configuration: {reason}"),
            other => bail!("the target answers a configuration by {other:?}"),
        }
    }

    /// The target's status.
    pub fn status(&mut self) -> anyhow::Result<Status> {
        match self.ask(ToTarget::StatusRequest)? {
            Heard::Status(status) => Ok(status),
            other => bail!("the target answers a request for its status by {other:?}"),
        }
    }

    /// Waits for a status announced unasked that `accept` takes.
    pub fn await_status(&mut self, accept: impl Fn(&Status) -> bool) -> anyhow::Result<Status> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            if let (_, Heard::Status(status)) = self.hear(deadline)?
                && accept(&status)
            {
                return Ok(status);
            }
        }
    }

    /// Sends `message` and waits for what answers it.
    pub fn ask(&mut self, message: ToTarget) -> anyhow::Result<Heard> {
        let envelope = self.envelope(message);
        let place = (envelope.session, envelope.sequence);
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(&envelope, &mut buffer).map_err(|_| anyhow!("message too long"))?;
        self.send(frame)?;
        let unasked = |said: &Heard| {
            matches!(said, Heard::Status(_)) && !matches!(message, ToTarget::StatusRequest)
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

    /// The next message from the target, with session and number of what it answers.
    pub fn hear(&mut self, deadline: Instant) -> anyhow::Result<((u32, u32), Heard)> {
        loop {
            while let Some(byte) = self.unread.pop_front() {
                if let Some(envelope) = self.receiver.push(byte, &mut self.counters) {
                    let Envelope {
                        session,
                        sequence,
                        message,
                    } = envelope;
                    let said = match message {
                        FromTarget::Configured => Heard::Configured,
                        FromTarget::Refused(RefusedParameter { parameter, problem }) => {
                            Heard::Refused(format!("{parameter}: {problem:?}"))
                        }
                        FromTarget::Answer(answer) => Heard::Answer(answer),
                        FromTarget::Status(status) => Heard::Status(status),
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

/// `input` as the guidance takes it, `dt` \[s\] after the last, or as a law does.
pub fn link_input(guided: bool, input: &Input, dt: f32) -> alula_link::Input {
    if guided {
        alula_link::Input::Guidance {
            input: input.sample,
            dt,
        }
    } else {
        let Planar {
            state,
            reference,
            feed_forward,
        } = input.into();
        alula_link::Input::Law {
            state,
            reference,
            feed_forward,
        }
    }
}

/// What a controller of the core has answered over the link. The error is an input that was not flown.
pub fn core_answer(answer: alula_link::Answer) -> anyhow::Result<Answer> {
    match answer {
        alula_link::Answer::Law(result) => Ok(result.into()),
        alula_link::Answer::Guidance(guided) => Ok(guided.into()),
        alula_link::Answer::NotConfigured => bail!("the target is not configured"),
        alula_link::Answer::WrongInput => bail!("the target flies another kind of controller"),
    }
}

impl Controller for Target {
    fn answer(&mut self, input: &Input, dt: f32) -> anyhow::Result<Answer> {
        match self.ask(ToTarget::Input(link_input(self.guided, input, dt)))? {
            Heard::Answer(answer) => core_answer(answer),
            other => bail!("the target answers an input by {other:?}"),
        }
    }
}
