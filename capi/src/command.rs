//! The command of a step, in the axes of autopilots.

use alula::guidance::Status;
use alula::ned::{BodyAxes, Quaternion};
use alula::spatial;

use crate::boundary::{self, Layout};
use crate::code;
use crate::controller::Initialised;
use crate::input::Input;

/// Command of one step, as rates and thrust and as attitude and thrust. It is the whole of the attitude: nothing is left to
/// be levelled or coordinated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Command {
    /// `ALULA_HEADER(alula_command)`.
    pub header: u32,
    /// `ALULA_STATUS_…` bits.
    pub status: u32,
    /// Thrust along the nose \[N\]. From `alula_step` it is as the law asks for it: it may be negative, or above
    /// `thrust_max`.
    pub thrust: f32,
    /// Thrust over `thrust_max`, limited to [0, 1].
    pub thrust_normalised: f32,
    /// Body rate set-point [rad/s]: forward, right, down, in the input's body axes.
    pub body_rate: [f32; 3],
    /// Attitude set-point: quaternion (w, x, y, z) from the input's body axes to world. It leads the attitude by
    /// `body_rate` / `attitude_gain`, 90° at most.
    pub quaternion: [f32; 4],
}

impl Command {
    /// The safe command: no thrust, no rotation, and body axes aligned with north, east and down.
    pub const SAFE: Self = Self {
        header: Self::HEADER,
        status: code::ALULA_STATUS_SAFE,
        thrust: 0.0,
        thrust_normalised: 0.0,
        body_rate: [0.0; 3],
        quaternion: [1.0, 0.0, 0.0, 0.0],
    };
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for Command {}

impl Initialised<'_> {
    /// The command of a law that was flown on `input`, with `status` and the status bits of what is cut off in it.
    #[inline(always)]
    pub(crate) fn of_law(
        &self,
        input: &Input,
        axes: BodyAxes,
        command: &spatial::Command,
        status: u32,
    ) -> Command {
        let time = self.inverse_attitude_gain;
        let (set_point, limited) = input.quaternion().leading(axes, command.rates, time);
        let status = status
            | if limited {
                code::ALULA_STATUS_LEAD_LIMITED
            } else {
                0
            };
        self.command(axes, command, &set_point, status)
    }

    /// A command of the core with the attitude set-point `set_point`.
    #[inline(always)]
    pub(crate) fn command(
        &self,
        axes: BodyAxes,
        command: &spatial::Command,
        set_point: &Quaternion,
        status: u32,
    ) -> Command {
        const LOW: u32 = Status::THRUST_LOW.bits() as u32;
        const HIGH: u32 = Status::THRUST_HIGH.bits() as u32;
        let share = command.thrust * self.inverse_thrust_max;
        let (thrust_normalised, cut) = if share < 0.0 {
            (0.0, LOW)
        } else if share > 1.0 {
            (1.0, HIGH)
        } else {
            (share, 0)
        };
        let Quaternion { w, x, y, z } = *set_point;
        Command {
            header: Command::HEADER,
            status: status | cut,
            thrust: command.thrust,
            thrust_normalised,
            body_rate: axes.components(command.rates),
            quaternion: [w, x, y, z],
        }
    }
}

/// Fills in the safe command.
///
/// # Safety
/// As `alula_input_default`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_command_default(command: *mut Command) -> i32 {
    // SAFETY: `command` is as `write` asks for, by the condition above.
    unsafe { boundary::write(command, Command::SAFE) }
}
