//! A simulated autopilot, with PX4's rules of OFFBOARD or ArduPlane's of QACRO.
//!
//! Until it is first in that mode the vehicle is held where it is. Out of it, later, the vehicle is given its hover thrust and no rotation:
//! nobody flies it.

use mavlink::dialects::ardupilotmega::{COMMAND_ACK_DATA, MavCmd, MavResult, TIMESYNC_DATA};

use super::detector::Detector;
use super::offboard::Offboard;
use super::parameters::Parameters;
use super::qacro::Qacro;
use super::{Kind, MavHeader, MavMessage, TERMINATION, telemetry};

/// State of a body; world vectors north-east-down, body axes those of hover.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyState {
    /// \[m\].
    pub position: [f64; 3],
    /// [m/s].
    pub velocity: [f64; 3],
    /// w x y z, from body to world.
    pub quaternion: [f64; 4],
    /// [rad/s].
    pub rates: [f64; 3],
    /// Specific force [m/s²] along body axes.
    pub specific_force: [f64; 3],
    /// Wind [m/s].
    pub wind: [f64; 3],
}

/// A vehicle with a rate loop.
pub trait Body {
    /// Lets `dt` \[s\] pass under thrust, as a share of the most, and body rates [rad/s].
    fn step(&mut self, thrust: f64, rates: [f64; 3], dt: f64);
    /// Its state.
    fn state(&self) -> BodyState;
    /// The share of the most thrust that holds its weight.
    fn hover(&self) -> f64;
}

/// Period \[s\] of attitude and position, of the air, and of the heartbeat.
const STATE: f64 = 0.02;
const AIR: f64 = 0.2;
const HEARTBEAT: f64 = 1.0;

/// The share of the most thrust that is had of a set-point. Motors and propellers give the square of their output u; the autopilot takes the thrust for
/// f u² + (1 − f) u, with its own f ([`Kind::thrust_model`]), and gives out u by that.
fn modelled(setpoint: f64, factor: f64) -> f64 {
    let (f, rest) = (factor.clamp(0.0, 1.0), 1.0 - factor.clamp(0.0, 1.0));
    let output = if f > 0.0 {
        (-rest + (rest * rest + 4.0 * f * setpoint).sqrt()) / (2.0 * f)
    } else {
        setpoint
    };
    output * output
}

/// The autopilot around a body.
pub struct Autopilot<B> {
    body: B,
    kind: Kind,
    mode: u32,
    was_commanded: bool,
    rules: Rules,
    answers: Vec<MavMessage>,
    next: [f64; 3],
    losses: u32,
    parameters: Parameters,
    /// Of PX4, and whether it has seen a failure.
    detector: Detector,
    failed: bool,
}

/// What is commanded, by the rules of the kind.
enum Rules {
    Px4(Offboard),
    ArduPlane(Qacro),
}

impl<B: Body> Autopilot<B> {
    /// Header of its messages.
    pub const HEADER: MavHeader = MavHeader {
        system_id: 1,
        component_id: 1,
        sequence: 0,
    };

    /// An autopilot of this kind in hold.
    pub fn new(body: B, kind: Kind) -> Self {
        let rules = match kind {
            Kind::Px4 => Rules::Px4(Offboard::default()),
            Kind::ArduPlane(sticks) => Rules::ArduPlane(Qacro::new(sticks, body.hover())),
        };
        Self {
            body,
            kind,
            mode: kind.hold(),
            was_commanded: false,
            rules,
            answers: Vec::new(),
            next: [f64::NEG_INFINITY; 3],
            losses: 0,
            parameters: Parameters::default(),
            detector: Detector::of(&Parameters::default()),
            failed: false,
        }
    }

    /// The autopilot with these parameters: it says them, and follows those of its ramps, its thrust and its failure detector. What follows those of its rate loop
    /// is the body's.
    #[must_use]
    pub fn with_parameters(mut self, parameters: Parameters) -> Self {
        if let Rules::ArduPlane(qacro) = &mut self.rules {
            qacro.ramp(&parameters);
        }
        self.detector = Detector::of(&parameters);
        self.parameters = parameters;
        self
    }

    /// Why it does not arm, as ArduPlane says it; none if it does.
    #[must_use]
    pub fn refuses_to_arm(&self) -> Option<&'static str> {
        let get = |name: &str, default| self.parameters.get(name).unwrap_or(default);
        let arms = get("Q_M_SPIN_ARM", 0.1) <= get("Q_M_SPIN_MIN", 0.15);
        match self.kind {
            Kind::ArduPlane(_) if !arms => Some("Q_M_SPIN_ARM > Q_M_SPIN_MIN"),
            _ => None,
        }
    }

    /// Its vehicle.
    pub fn body(&self) -> &B {
        &self.body
    }

    /// Its mode.
    pub fn mode(&self) -> u32 {
        self.mode
    }

    /// How often OFFBOARD was left because set-points ceased, or overrides ran out.
    pub fn losses(&self) -> u32 {
        self.losses
    }

    /// Whether a channel of the transmitter is overridden.
    pub fn is_overridden(&self) -> bool {
        matches!(&self.rules, Rules::ArduPlane(qacro) if qacro.is_overridden())
    }

    /// Whether PX4's failure detector has seen an attitude that is none to fly in.
    pub fn has_failed(&self) -> bool {
        self.failed
    }

    /// The pilot sets a mode by his transmitter. A flight that PX4 has ended stays so.
    pub fn set_mode(&mut self, mode: u32) {
        if self.is_terminated() {
            return;
        }
        self.mode = mode;
        // The next heartbeat says so at once, as PX4's and ArduPlane's do.
        self.next[2] = f64::NEG_INFINITY;
    }

    /// Takes a message that arrived `now` \[s\].
    pub fn receive(&mut self, now: f64, header: &MavHeader, message: &MavMessage) {
        let terminated = self.is_terminated();
        match (message, &mut self.rules) {
            (MavMessage::SET_ATTITUDE_TARGET(m), Rules::Px4(offboard)) => offboard.take(now, m),
            (MavMessage::RC_CHANNELS_OVERRIDE(m), Rules::ArduPlane(qacro)) => {
                qacro.take(now, header, m);
            }
            (MavMessage::COMMAND_LONG(m), rules) if m.command == MavCmd::MAV_CMD_DO_SET_MODE => {
                let mode = self.kind.asked([m.param2, m.param3]);
                let streams = match rules {
                    Rules::Px4(offboard) => offboard.streams(now),
                    // QACRO is entered at any time.
                    Rules::ArduPlane(_) => true,
                };
                let granted = !self.kind.is_commanded(mode) || streams;
                let accepted = !terminated && m.param1 == 1.0 && granted;
                if accepted {
                    self.set_mode(mode);
                }
                self.answers.push(MavMessage::COMMAND_ACK(COMMAND_ACK_DATA {
                    command: m.command,
                    result: match accepted {
                        true => MavResult::MAV_RESULT_ACCEPTED,
                        false => MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
                    },
                }));
            }
            (MavMessage::PARAM_REQUEST_READ(m), _) => {
                let name = m.param_id.to_str().unwrap_or_default();
                self.answers.extend(self.parameters.answer(name));
            }
            (MavMessage::TIMESYNC(m), _) if m.tc1 == 0 => {
                self.answers.push(MavMessage::TIMESYNC(TIMESYNC_DATA {
                    tc1: (now * 1e9) as i64,
                    ts1: m.ts1,
                }));
            }
            _ => {}
        }
    }

    /// What is commanded; none if what was commanded is too old and the mode is left.
    fn command(&mut self, now: f64, dt: f64) -> Option<(f64, [f64; 3])> {
        let commanded = self.kind.is_commanded(self.mode);
        let factor = self.parameters.get(self.kind.thrust_model());
        let factor = factor.unwrap_or(1.0);
        let command = match &mut self.rules {
            Rules::Px4(offboard) => {
                let attitude = self.body.state().quaternion;
                commanded.then(|| offboard.command(now, attitude)).flatten()
            }
            Rules::ArduPlane(qacro) => {
                // The mode stays: the transmitter's sticks are flown.
                self.losses += u32::from(qacro.advance(now, dt) && commanded);
                commanded.then(|| qacro.command())
            }
        };
        command.map(|(thrust, rates)| (modelled(thrust, factor), rates))
    }

    fn is_terminated(&self) -> bool {
        self.kind == Kind::Px4 && self.mode == TERMINATION
    }

    /// PX4 looks at the attitude where it controls it: in every mode but OFFBOARD by rates.
    fn look_for_failures(&mut self, now: f64) {
        let by_rates = match &self.rules {
            Rules::Px4(offboard) => self.kind.is_commanded(self.mode) && !offboard.is_by_attitude(),
            Rules::ArduPlane(_) => true,
        };
        if !by_rates && self.detector.fails(now, self.body.state().quaternion) {
            self.failed = true;
            if self.detector.terminates {
                self.set_mode(TERMINATION);
            }
        }
    }

    /// Lets `dt` \[s\] pass from `now`.
    pub fn advance(&mut self, now: f64, dt: f64) {
        self.look_for_failures(now);
        if self.is_terminated() {
            // Motors stand, and surfaces turn nothing.
            let rates = self.body.state().rates;
            self.body.step(0.0, rates, dt);
            return;
        }
        let command = self.command(now, dt);
        let commanded = self.kind.is_commanded(self.mode);
        if commanded && command.is_none() {
            self.losses += 1;
            self.set_mode(self.kind.hold());
        }
        self.was_commanded |= commanded;
        let (thrust, rates) = command.unwrap_or((self.body.hover(), [0.0; 3]));
        if self.was_commanded {
            self.body.step(thrust, rates, dt);
        }
    }

    /// What it sends, `now` \[s\].
    pub fn send(&mut self, now: f64) -> Vec<MavMessage> {
        let mut messages = std::mem::take(&mut self.answers);
        let mut due = |which: usize, period: f64| {
            let next = &mut self.next[which];
            // A hair early, so that rounding does not shift it by a step.
            let due = now >= *next - 1e-6;
            if due {
                *next = if next.is_finite() {
                    *next + period
                } else {
                    now + period
                };
            }
            due
        };
        let (state, air, heartbeat) = (due(0, STATE), due(1, AIR), due(2, HEARTBEAT));
        let body = self.body.state();
        if heartbeat {
            messages.push(telemetry::heartbeat(self.kind, self.mode));
        }
        if state {
            messages.extend(telemetry::state(self.kind, now, &body));
        }
        if air {
            messages.extend(telemetry::air(self.kind, now, &body));
        }
        messages
    }
}

#[cfg(test)]
mod tests {
    use super::modelled;

    #[test]
    fn the_thrust_model_is_undone_whole_or_not_at_all() {
        for n in 0..=10 {
            let asked = f64::from(n) / 10.0;
            assert!((modelled(asked, 1.0) - asked).abs() < 1e-12);
            assert!((modelled(asked, 0.0) - asked * asked).abs() < 1e-12);
            // By half, as PX4's formula says of the output: 0.5 u² + 0.5 u is what is asked.
            let output = modelled(asked, 0.5).sqrt();
            assert!((0.5 * output * output + 0.5 * output - asked).abs() < 1e-12);
        }
    }
}
