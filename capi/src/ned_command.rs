//! What a step gives in the axes of the field, and the step of the pure law in them.

use core::f32::consts::{FRAC_PI_2, PI, TAU};

use alula::FeedForward;
use alula::ned::Quaternion;

use crate::boundary::{self, Layout};
use crate::code;
use crate::controller::{Controller, Ready, ready};
use crate::ned_input::{NedInput, Seen, ned};
use crate::plane::ALULA_FEED_FORWARD;

/// Most that the attitude set-point leads the attitude by \[rad\].
const MAX_LEAD: f32 = FRAC_PI_2;

/// Command of one step as rate and thrust and as attitude and thrust, what the plane has lost, and how the command came
/// about.
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
    /// Attitude set-point \[rad\]: pitch of the input's body axes, in (−π, π], without tilt and bank.
    pub pitch: f32,
    /// The same set-point, with the heading, as a quaternion (w, x, y, z) from body to world.
    pub quaternion: [f32; 4],
    /// Lost by the plane: velocity across it, to the right [m/s].
    pub lateral_velocity: f32,
    /// Lost by the plane: the input's `air` across it, to the right [m/s].
    pub lateral_air: f32,
    /// Lost by the plane: reference velocity across it, to the right [m/s].
    pub lateral_reference_velocity: f32,
    /// Lost by the plane: reference acceleration across it, to the right [m/s²].
    pub lateral_reference_acceleration: f32,
    /// Lost by the plane: angle of the nose out of it \[rad\], to the right.
    pub tilt: f32,
    /// Lost by the plane: angle about the nose \[rad\], right wing towards the belly side.
    pub bank: f32,
    /// Angle of attack \[rad\], in [−π, π].
    pub alpha: f32,
    /// Angle from the tail to the apparent external force \[rad\], in (−π, π]: what the attitude has yet to turn.
    pub theta_tilde: f32,
    /// |F_p| \[N\]: how far the law is from losing its equilibrium.
    pub f_p_norm: f32,
    /// Thrust of the equivalent sphere \[N\].
    pub t_p: f32,
    /// Weight of the alignment term, 0 to 1.
    pub guard_alignment: f32,
    /// Weight of the feed-forward, 0 to 1.
    pub guard_feed_forward: f32,
    /// Gain k of the full law; 1 in the robust law.
    pub k: f32,
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
        lateral_velocity: 0.0,
        lateral_air: 0.0,
        lateral_reference_velocity: 0.0,
        lateral_reference_acceleration: 0.0,
        tilt: 0.0,
        bank: 0.0,
        alpha: 0.0,
        theta_tilde: 0.0,
        f_p_norm: 0.0,
        t_p: 0.0,
        guard_alignment: 0.0,
        guard_feed_forward: 0.0,
        k: 0.0,
    };
}

// SAFETY: `repr(C)`, header first, numbers only.
unsafe impl Layout for NedCommand {}

/// `value`, or 0 if it is not a number.
pub(crate) fn known(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

impl Ready {
    /// One step of the pure law.
    fn step_ned(&self, input: &NedInput, dt: f32) -> Result<NedCommand, i32> {
        let seen = Seen::new(input)?;
        let state = seen.state(input)?;
        let feed_forward = (input.flags & ALULA_FEED_FORWARD != 0).then(|| FeedForward {
            air_acceleration: seen.plane.project(ned(input.air_acceleration)).0,
            jerk: seen.plane.project(ned(input.reference_jerk)).0,
        });
        let command = self.law(&state, &seen.reference, feed_forward.as_ref(), dt)?;
        Ok(self.command(&seen, &command))
    }

    /// Normalised thrust of a command, and the status bit of what is cut off.
    fn normalise(&self, command: &alula::Command) -> (f32, u32) {
        let share = command.thrust * self.inverse_thrust_max;
        if share < 0.0 {
            (0.0, code::ALULA_STATUS_THRUST_LOW)
        } else if share > 1.0 {
            (1.0, code::ALULA_STATUS_THRUST_HIGH)
        } else {
            (share, 0)
        }
    }

    /// A command in the axes of what was seen. What was not a number is given as no angle and no velocity.
    pub(crate) fn command(&self, seen: &Seen, command: &alula::Command) -> NedCommand {
        let (thrust_normalised, status) = self.normalise(command);
        let d = &command.diagnostics;
        let present = known(seen.axes.pitch(seen.projection.attitude));
        let (pitch, limited) = self.lead(present, command.rate);
        let Quaternion { w, x, y, z } = seen.plane.quaternion(pitch);
        let quaternion = if w.is_finite() {
            [w, x, y, z]
        } else {
            NedCommand::SAFE.quaternion
        };
        NedCommand {
            header: NedCommand::HEADER,
            status: status | limited,
            thrust: command.thrust,
            thrust_normalised,
            body_rate: seen.projection.normal.map(|n| n * command.rate),
            pitch_rate: command.rate,
            pitch,
            quaternion,
            lateral_velocity: known(seen.lateral_velocity),
            lateral_air: known(seen.lateral_air),
            lateral_reference_velocity: known(seen.lateral_reference_velocity),
            lateral_reference_acceleration: known(seen.lateral_reference_acceleration),
            tilt: seen.projection.tilt,
            bank: seen.projection.bank,
            alpha: d.alpha,
            theta_tilde: d.theta_tilde(),
            f_p_norm: d.f_p_norm,
            t_p: d.t_p,
            guard_alignment: d.guard_alignment,
            guard_feed_forward: d.guard_feed_forward,
            k: d.k,
        }
    }

    /// The pitch set-point at which an attitude loop at `pitch` asks for `rate`, and its status bit.
    fn lead(&self, pitch: f32, rate: f32) -> (f32, u32) {
        let lead = rate * self.inverse_attitude_gain;
        let (lead, limited) = if lead.abs() > MAX_LEAD {
            (MAX_LEAD.copysign(lead), code::ALULA_STATUS_LEAD_LIMITED)
        } else {
            (lead, 0)
        };
        let pitch = pitch + lead;
        let pitch = if pitch > PI {
            pitch - TAU
        } else if pitch <= -PI {
            pitch + TAU
        } else {
            pitch
        };
        (pitch, limited)
    }
}

/// One step of the pure law in the vertical plane through the input's heading: from `input` to `command`, `dt` seconds
/// after the last. The law has no memory and no limits: `dt` is only checked. Whatever is returned but `ALULA_OK`, the
/// command is the safe one; unless it is `command` itself that is at fault, which is then left alone.
///
/// # Safety
/// As `alula_step`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_step_ned(
    controller: *const Controller,
    input: *const NedInput,
    dt: f32,
    command: *mut NedCommand,
) -> i32 {
    // SAFETY: the caller's word.
    unsafe {
        boundary::answer(command, NedCommand::SAFE, || {
            ready(controller)?.step_ned(boundary::read(input)?, dt)
        })
    }
}

/// Fills in the safe command.
///
/// # Safety
/// As `alula_input_default`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_ned_command_default(command: *mut NedCommand) -> i32 {
    // SAFETY: the caller's word.
    unsafe { boundary::write(command, NedCommand::SAFE) }
}
