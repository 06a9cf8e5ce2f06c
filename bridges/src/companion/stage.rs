//! What a companion tells its pilot, and what it says of itself.

use alula::guidance::Air;
use alula::ned::{Frd, Ned};
use alula::spatial::Orientation;

use super::{Kind, Setpoint};

/// What is known of the vehicle when a command will act: it is predicted over the age of what came, the latency and the time
/// for which a command is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// Time since the start \[s\].
    pub t: f64,
    /// Position from the start \[m\].
    pub position: Ned,
    /// The start, in the autopilot's own frame \[m\].
    pub start: Ned,
    /// Velocity [m/s].
    pub velocity: Ned,
    /// Attitude.
    pub orientation: Orientation,
    /// Body rates [rad/s] about hover's axes.
    pub rates: [f32; 3],
    /// Time \[s\] of the older of attitude and motion over which nothing is predicted any more.
    pub age: f32,
    /// What is known of the air.
    pub air: Air<Ned>,
    /// Specific force [m/s²], if an accelerometer is told.
    pub specific_force: Option<Frd>,
    /// What is asked for over the link, its position from the start, and its age \[s\].
    pub asked: Option<(Setpoint, f32)>,
}

/// What a pilot answers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Thrust \[N\].
    pub thrust: f32,
    /// Body rates [rad/s] about hover's axes: x to the belly, y along the right wing, z along the tail.
    pub rates: [f32; 3],
}

/// Whoever controls the flight.
pub trait Pilot {
    /// The flight begins here, with the vehicle's `heading` \[rad\] and the `last` command that it has.
    fn begin(&mut self, told: &Told, heading: f32, last: Command);

    /// The command, `dt` \[s\] after the last one.
    ///
    /// # Errors
    /// Why the flight ends here: [`End::Pilot`].
    fn answer(&mut self, told: &Told, dt: f32) -> Result<Command, End>;

    /// Whether the pilot wants the flight to end: the autopilot is then asked to hold, and flown until it does.
    fn is_over(&self) -> bool {
        false
    }
}

/// Settings of a companion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The autopilot.
    pub kind: Kind,
    /// Weight that the pilot believes in \[N\], and the autopilot's thrust in hover, in (0, 1): thrust is proportional between.
    pub weight: f32,
    /// See `weight`.
    pub hover_thrust: f32,
    /// Whether the mode that is flown in, OFFBOARD or QACRO, is asked for; else the flight begins when somebody else sets it.
    pub engage: bool,
    /// Whether the flight is led over the link: it is over where what it is asked for ceases.
    pub led: bool,
    /// How long \[s\] the reference is flown.
    pub duration: f64,
    /// Age \[s\] of the state at which the link is taken for lost.
    pub timeout: f64,
}

/// Why a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The reference was flown, or ceased; the autopilot was asked to hold.
    Finished,
    /// Somebody set another mode.
    TakenOver,
    /// It was disarmed.
    Disarmed,
    /// Nothing came for too long: nothing is sent any more. PX4 acts as on every loss of OFFBOARD; ArduPlane takes the transmitter's sticks after
    /// `RC_OVERRIDE_TIME`.
    LinkLost,
    /// The attitude is none.
    Attitude,
    /// The pilot does not answer.
    Pilot,
    /// It was told to stop.
    Stopped,
}

/// What the companion does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// Nothing is known of the autopilot's state, and nothing sent.
    Waiting,
    /// The autopilot's state is known, since this time \[s\], and its mode awaited. PX4 is sent hover, or on the ground no thrust: it wants to see set-points before it enters
    /// OFFBOARD. ArduPlane is sent nothing: its sticks are the pilot's.
    Streaming(f64),
    /// The reference is flown, since this time \[s\].
    Flying(f64),
    /// The end of the reference is flown until the autopilot holds, since this time \[s\].
    Leaving(f64),
    /// Nothing is sent any more, but that ArduPlane's channels are given back.
    Ended(End),
}
