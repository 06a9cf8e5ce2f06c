//! What a companion is told, and what it says of itself.

use alula::{Inertial, PlanarInput};

use super::HoldParameters;

/// Whoever controls the flight in its vertical plane.
pub trait Pilot {
    /// Thrust \[N\] and θ̇ [rad/s], `dt` \[s\] after the last answer; none if it cannot be reached.
    fn answer(&mut self, input: &PlanarInput, dt: f32) -> Option<(f32, f32)>;
}

/// What is to be flown.
pub enum Wanted<'a> {
    /// At each time \[s\] since the start: velocity, acceleration, and position from the start, (down, forward).
    Plan(&'a dyn Fn(f64) -> [Inertial; 3]),
    /// What comes as `SET_POSITION_TARGET_LOCAL_NED`.
    Link,
}

/// Settings of a companion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Weight that the pilot believes in \[N\], and the autopilot's thrust in hover, in (0, 1): thrust is proportional between.
    pub weight: f32,
    /// See `weight`.
    pub hover_thrust: f32,
    /// Whether OFFBOARD is asked for; else the flight begins when somebody else sets it.
    pub engage: bool,
    /// Heading of the plane \[rad\]; that of the vehicle at the start if none.
    pub heading: Option<f32>,
    /// How long \[s\] the reference is flown.
    pub duration: f64,
    /// Age \[s\] of the state at which the link is taken for lost.
    pub timeout: f64,
    /// Out of the plane.
    pub hold: HoldParameters,
}

/// Why a flight ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The reference was flown; the autopilot was asked to hold.
    Finished,
    /// Somebody took the autopilot out of OFFBOARD.
    TakenOver,
    /// Nothing came for too long: nothing is sent any more, and the autopilot acts as on every loss of OFFBOARD.
    LinkLost,
    /// The nose points across the plane, or the attitude is none.
    Attitude,
    /// The pilot does not answer.
    Pilot,
}

/// What the companion does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// Nothing is known of the autopilot's state, and nothing sent.
    Waiting,
    /// Hover is sent, since this time \[s\]: PX4 wants to see set-points before it enters OFFBOARD.
    Streaming(f64),
    /// The reference is flown, since this time \[s\].
    Flying(f64),
    /// The end of the reference is flown until the autopilot holds, since this time \[s\].
    Leaving(f64),
    /// Nothing is sent any more.
    Ended(End),
}

/// What was told and commanded at one step of the flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Commanded {
    /// Time since the start \[s\].
    pub t: f64,
    /// What the pilot was told.
    pub input: PlanarInput,
    /// Position from the start \[m\], (down, forward), and across the plane, to the right.
    pub position: (Inertial, f32),
    /// Wind as used [m/s], zero if it is not known.
    pub wind: Inertial,
    /// Thrust \[N\] and θ̇ [rad/s].
    pub command: (f32, f32),
}
