//! The step of the guidance, in the axes of the field.

use alula::control::{Air, AirUse, Mode};
use alula::ned::{Ned, VerticalPlane};
use alula::{GuidanceInput, Guided};

use crate::boundary::{self, Layout};
use crate::code;
use crate::controller::{Controller, Ready, ready_mut};
use crate::ned_command::{NedCommand, known};
use crate::ned_input::{
    ALULA_AIR_UNKNOWN, ALULA_AIR_VELOCITY, ALULA_POSITION, NedInput, Seen, in_range, ned,
};

/// The guidance gives the safe command.
pub const ALULA_MODE_SAFE: u32 = 0;
/// The guidance repeats the last command.
pub const ALULA_MODE_HOLDING: u32 = 1;
/// The guidance flies the law.
pub const ALULA_MODE_FLYING: u32 = 2;

/// Flown without air data: plain thrust vectoring.
pub const ALULA_AIR_USE_NONE: u32 = 0;
/// Flown with the measured air velocity.
pub const ALULA_AIR_USE_VELOCITY: u32 = 1;
/// Flown with the wind given.
pub const ALULA_AIR_USE_WIND: u32 = 2;
/// Flown with the last wind known.
pub const ALULA_AIR_USE_HELD_WIND: u32 = 3;

/// What a flight log wants to know of a step of the guidance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct GuidanceReport {
    /// `ALULA_HEADER(alula_guidance_report)`.
    pub header: u32,
    /// `ALULA_MODE_…`.
    pub mode: u32,
    /// `ALULA_AIR_USE_…`.
    pub air_use: u32,
    /// Velocity that the law was given to follow [m/s]: north, east, down, in the plane.
    pub velocity: [f32; 3],
    /// Acceleration that the law was given to follow [m/s²]: north, east, down, in the plane.
    pub acceleration: [f32; 3],
    /// |F_p| over tau: below 1 the guard acts, at 0 no attitude is an equilibrium.
    pub margin_force: f32,
    /// Gain k of the full law here: 1 on a sphere, large or negative where F_p turns with the attitude.
    pub margin_k: f32,
    /// Angle from the present attitude to the nearest fold \[rad\], to first order.
    pub margin_fold: f32,
}

impl GuidanceReport {
    fn new(guided: &Guided, plane: &VerticalPlane) -> Self {
        let lift = |v| {
            let Ned { north, east, down } = plane.lift(v, 0.0);
            [north, east, down].map(known)
        };
        Self {
            header: Self::HEADER,
            mode: match guided.mode {
                Mode::Safe => ALULA_MODE_SAFE,
                Mode::Holding => ALULA_MODE_HOLDING,
                Mode::Flying => ALULA_MODE_FLYING,
            },
            air_use: match guided.air {
                AirUse::None => ALULA_AIR_USE_NONE,
                AirUse::Velocity => ALULA_AIR_USE_VELOCITY,
                AirUse::Wind => ALULA_AIR_USE_WIND,
                AirUse::HeldWind => ALULA_AIR_USE_HELD_WIND,
            },
            velocity: lift(guided.reference.velocity),
            acceleration: lift(guided.reference.acceleration),
            margin_force: guided.margin.force,
            margin_k: guided.margin.k,
            margin_fold: guided.margin.fold,
        }
    }
}

// SAFETY: `repr(C)`, header first, numbers only.
unsafe impl Layout for GuidanceReport {}

impl Ready {
    /// A step of the guidance, which always gives a command, and why it refused the input, if it did.
    fn guide(
        &mut self,
        input: &NedInput,
        dt: f32,
    ) -> Result<(NedCommand, GuidanceReport, i32), i32> {
        let seen = Seen::new(input)?;
        let air = match input.flags & (ALULA_AIR_VELOCITY | ALULA_AIR_UNKNOWN) {
            0 => Air::Wind(seen.air),
            ALULA_AIR_VELOCITY => Air::Velocity(seen.air),
            _ => Air::Unknown,
        };
        let position = seen.plane.project(ned(input.position_error)).0;
        let guided = self.guidance.update(
            &mut self.state,
            &GuidanceInput {
                velocity: seen.velocity,
                attitude: seen.projection.attitude,
                state_age: input.state_age,
                air,
                position_error: (input.flags & ALULA_POSITION != 0).then_some(position),
                reference: seen.reference,
                reference_age: input.reference_age,
            },
            dt,
        );
        let code = match guided.refusal {
            None => code::ALULA_OK,
            Some(_) if !in_range(input.heading) => code::ALULA_ERROR_HEADING,
            Some(refusal) => code::of_refusal(refusal),
        };
        let mut command = self.command(&seen, &guided.command);
        // The limits that were met, and not those that would have been.
        command.status &= code::ALULA_STATUS_LEAD_LIMITED;
        command.status |= u32::from(guided.status.bits())
            | match guided.mode {
                Mode::Flying => 0,
                Mode::Holding => code::ALULA_STATUS_HOLDING,
                Mode::Safe => code::ALULA_STATUS_SAFE,
            };
        Ok((command, GuidanceReport::new(&guided, &seen.plane), code))
    }
}

/// One step of the guidance: supervision, reference limit, outer loop, law and actuator limits. It always gives a
/// command. If the return code says that the input was refused, the command is the last one flown, for as long as
/// `hold` (`ALULA_STATUS_HOLDING`), and then the safe one: `safe_thrust`, no rotation (`ALULA_STATUS_SAFE`). If it is a
/// pointer, a header, the controller or a selector that is at fault, there was no step, and the command is that of
/// `alula_ned_command_default`. `report` may be null.
///
/// # Safety
/// As `alula_step`, and no other call reads the controller meanwhile either.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_guide(
    controller: *mut Controller,
    input: *const NedInput,
    dt: f32,
    command: *mut NedCommand,
    report: *mut GuidanceReport,
) -> i32 {
    let mut refusal = code::ALULA_OK;
    // SAFETY: the caller's word.
    let code = unsafe {
        boundary::answer(command, NedCommand::SAFE, || {
            if !report.is_null() {
                boundary::check(report)?;
            }
            let (command, value, code) =
                ready_mut(controller)?.guide(boundary::read(input)?, dt)?;
            refusal = code;
            if !report.is_null() {
                report.write(value);
            }
            Ok(command)
        })
    };
    if code == code::ALULA_OK {
        refusal
    } else {
        code
    }
}
