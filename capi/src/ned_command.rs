//! The command of a step in the axes of autopilots, and the step of the pure law in them.

use core::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

use alula::FeedForward;
use alula::ned::{BodyAxes, Quaternion};

use crate::boundary::{self, Layout};
use crate::code;
use crate::controller::{Controller, Initialised, initialised};
use crate::ned_input::{NedInput, PlanarInput, axes_of, ned, plane_of};
use crate::ned_report::NedReport;
use crate::plane::ALULA_FEED_FORWARD;

/// Most that the attitude set-point leads the attitude by \[rad\].
const MAX_LEAD: f32 = FRAC_PI_2;

/// Command of one step, as rate and thrust and as attitude and thrust.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct NedCommand {
    /// `ALULA_HEADER(alula_ned_command)`.
    pub header: u32,
    /// `ALULA_STATUS_…` bits.
    pub status: u32,
    /// Thrust along the nose \[N\]. From the pure law it is as the law asks for it: it may be negative, or above
    /// `thrust_max`.
    pub thrust: f32,
    /// Thrust over `thrust_max`, limited to [0, 1].
    pub thrust_normalised: f32,
    /// Body rate set-point [rad/s]: forward, right, down, in the input's body axes. It turns the aircraft in the plane;
    /// tilt and bank are the caller's to hold at zero.
    pub body_rate: [f32; 3],
    /// The same rate about the plane's normal, to the right [rad/s]: pitch rate, positive nose up.
    pub pitch_rate: f32,
    /// Attitude set-point \[rad\]: pitch of the input's body axes, in [−π, π], without tilt and bank.
    pub pitch: f32,
    /// The same set-point, with the heading, as a quaternion (w, x, y, z) from body to world.
    pub quaternion: [f32; 4],
}

impl NedCommand {
    /// The safe command: no thrust, no rotation, and body axes aligned with north, east and down.
    pub const SAFE: Self = Self {
        header: Self::HEADER,
        status: code::ALULA_STATUS_SAFE,
        thrust: 0.0,
        thrust_normalised: 0.0,
        body_rate: [0.0; 3],
        pitch_rate: 0.0,
        pitch: 0.0,
        quaternion: [1.0, 0.0, 0.0, 0.0],
    };

    /// Whether every number is finite: one that is not makes their sum so.
    #[inline(never)]
    pub(crate) fn is_finite(&self) -> bool {
        let [p, q, r] = self.body_rate;
        let [w, x, y, z] = self.quaternion;
        let command = self.thrust + self.thrust_normalised + self.pitch_rate + self.pitch;
        (command + (p + q + r) + (w + x + y + z)).is_finite()
    }

    /// This command, which is in the other body axes, in the axes `axes`.
    pub(crate) fn in_axes(&self, axes: BodyAxes) -> Self {
        let [w, x, y, z] = self.quaternion;
        let [p, q, r] = self.body_rate;
        // The axes are a quarter turn about the wing apart: q · (cos 45°, 0, ± sin 45°, 0).
        let (sign, quarter) = match axes {
            BodyAxes::NoseForward => (1.0, FRAC_PI_2),
            BodyAxes::NoseUp => (-1.0, -FRAC_PI_2),
        };
        let h = FRAC_1_SQRT_2;
        Self {
            body_rate: [-sign * r, q, sign * p],
            pitch: within_half_turn(self.pitch + quarter),
            quaternion: [
                h * (w - sign * y),
                h * (x - sign * z),
                h * (y + sign * w),
                h * (z + sign * x),
            ],
            ..*self
        }
    }
}

/// An angle within a turn of [−π, π], in it.
fn within_half_turn(angle: f32) -> f32 {
    use core::f32::consts::{PI, TAU};
    if angle > PI {
        angle - TAU
    } else if angle < -PI {
        angle + TAU
    } else {
        angle
    }
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for NedCommand {}

impl Initialised<'_> {
    /// A command of the core in the axes of `planar`, with `status` and the status bits of what is cut off in it. The
    /// attitude set-point is NaN if the input's attitude or heading is.
    #[inline(always)]
    pub(crate) fn command(
        &self,
        planar: &PlanarInput,
        command: &alula::Command,
        status: u32,
    ) -> NedCommand {
        let (thrust, rate) = (command.thrust, command.rate);
        let share = thrust * self.inverse_thrust_max;
        let (thrust_normalised, thrust_status) = if share < 0.0 {
            (0.0, THRUST_LOW)
        } else if share > 1.0 {
            (1.0, THRUST_HIGH)
        } else {
            (share, 0)
        };
        let lead = rate * self.inverse_attitude_gain;
        let (lead, lead_status) = if lead.abs() > MAX_LEAD {
            (MAX_LEAD.copysign(lead), code::ALULA_STATUS_LEAD_LIMITED)
        } else {
            (lead, 0)
        };
        let (Quaternion { w, x, y, z }, pitch) =
            planar
                .plane
                .set_point(planar.projection.attitude, planar.axes, lead);
        NedCommand {
            header: NedCommand::HEADER,
            status: status | thrust_status | lead_status,
            thrust,
            thrust_normalised,
            body_rate: planar.projection.normal.map(|n| n * rate),
            pitch_rate: rate,
            pitch,
            quaternion: [w, x, y, z],
        }
    }
}

const THRUST_LOW: u32 = alula::guidance::Status::THRUST_LOW.bits() as u32;
const THRUST_HIGH: u32 = alula::guidance::Status::THRUST_HIGH.bits() as u32;

/// One step of the pure law in the vertical plane through the input's heading: from `input` to `command`, `dt` seconds
/// after the last. The law has no memory and no limits: `dt` is only checked. Whatever is returned but `ALULA_OK`, the
/// command is the safe one, and `report` is not written; if `command` itself is at fault, it is not written either. `report`
/// may be null; its margins are zero.
///
/// # Safety
/// As `alula_step`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_step_ned(
    controller: *const Controller,
    input: *const NedInput,
    dt: f32,
    command: *mut NedCommand,
    report: *mut NedReport,
) -> i32 {
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, by the condition above.
    unsafe {
        boundary::answer(command, NedCommand::SAFE, || {
            boundary::check_optional(report)?;
            let controller = initialised(controller)?;
            let input = boundary::read(input)?;
            let axes = axes_of(input)?;
            let planar = PlanarInput::new(input, axes, plane_of(input.heading));
            let state = planar.state(input)?;
            let project = |v| planar.plane.project(ned(v)).0;
            let feed_forward = (input.flags & ALULA_FEED_FORWARD != 0).then(|| FeedForward {
                air_acceleration: project(input.air_acceleration),
                jerk: project(input.reference_jerk),
            });
            let command = controller.law(&state, &planar.reference, feed_forward.as_ref(), dt)?;
            if !report.is_null() {
                report.write(NedReport::of_law(&planar, &command));
            }
            Ok(controller.command(&planar, &command, 0))
        })
    }
}

/// Fills in the safe command.
///
/// # Safety
/// As `alula_input_default`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_ned_command_default(command: *mut NedCommand) -> i32 {
    // SAFETY: `command` is as `write` asks for, by the condition above.
    unsafe { boundary::write(command, NedCommand::SAFE) }
}
