//! The step of the guidance, in the axes of autopilots.

use alula::guidance::{Air, InputAcross, Mode};
use alula::ned::BodyAxes;
use alula::{GuidanceInput, Guided};

use crate::boundary;
use crate::code;
use crate::controller::{Controller, Initialised, initialised_mut};
use crate::ned_command::NedCommand;
use crate::ned_input::{
    AIR, ALULA_AIR_VELOCITY, ALULA_POSITION, NedInput, PlanarInput, axes_of, in_range, ned,
};
use crate::ned_report::NedReport;

impl PlanarInput {
    /// The input of the core's guidance.
    #[inline(always)]
    fn guidance_input(&self, input: &NedInput) -> GuidanceInput {
        GuidanceInput {
            velocity: self.velocity,
            attitude: self.projection.attitude,
            state_age: input.state_age,
            air: match input.flags & AIR {
                0 => Air::Wind(self.air),
                ALULA_AIR_VELOCITY => Air::Velocity(self.air),
                _ => Air::Unknown,
            },
            position_error: (input.flags & ALULA_POSITION != 0)
                .then(|| self.plane.project(ned(input.position_error)).0),
            reference: self.reference,
            reference_age: input.reference_age,
        }
    }

    /// The parts of it that the plane has lost.
    #[inline(always)]
    fn across(&self) -> InputAcross {
        InputAcross {
            velocity: self.lateral_velocity,
            air: self.lateral_air,
            reference: self.lateral_reference_velocity,
        }
    }
}

impl Initialised<'_> {
    /// A step of the guidance in the vertical plane. Out of line: merged with its caller it runs out of registers.
    #[inline(never)]
    fn update(&mut self, input: &GuidanceInput, dt: f32) -> Guided {
        self.guidance.update(&mut self.memory.state, input, dt)
    }

    /// The command of a step of the guidance, which is kept in case that it is to be held.
    #[inline(always)]
    fn guided_command(&mut self, planar: &PlanarInput, guided: &Guided) -> NedCommand {
        if guided.mode == Mode::Flying {
            let command = self.command(planar, &guided.command, u32::from(guided.status.bits()));
            self.memory.keep(command, planar.axes)
        } else {
            self.substitute(planar, guided)
        }
    }

    /// The command where the law is not flown: the last one in full, or the safe one at the attitude that there is. If
    /// that is not known, the last attitude set-point stays.
    #[cold]
    #[inline(never)]
    fn substitute(&mut self, planar: &PlanarInput, guided: &Guided) -> NedCommand {
        self.memory.renew_plane();
        let last = self.memory.last(planar.axes);
        let (status, holds) = match guided.mode {
            Mode::Holding => (code::ALULA_STATUS_HOLDING, true),
            _ => (code::ALULA_STATUS_SAFE, false),
        };
        let status = status | u32::from(guided.status.bits());
        let mut command = match last {
            // What is kept of it here is the same as what the guidance has kept of it, if neither is corrupt.
            Some(last) if holds && last.thrust == guided.command.thrust => last,
            _ => self.command(planar, &guided.command, 0),
        };
        command.status = status;
        if command.is_finite() {
            if !holds {
                self.memory.keep(command, planar.axes);
            }
        } else {
            let NedCommand {
                pitch, quaternion, ..
            } = last.unwrap_or(NedCommand::SAFE);
            (command.pitch, command.quaternion) = (pitch, quaternion);
        }
        command
    }
}

/// One step of the guidance: supervision, reference limit, outer loop, law and actuator limits. It always gives a
/// command. If the return code says that the input was refused, the command is the last one flown, for as long as
/// `hold` (`ALULA_STATUS_HOLDING`), and then the safe one: `safe_thrust`, no rotation (`ALULA_STATUS_SAFE`). If a pointer, a
/// header, the controller or a selector is at fault, there was no step, and the command is that of
/// `alula_ned_command_default`. `report` may be null, which saves time.
///
/// # Safety
/// As `alula_step`, and no other call reads the controller meanwhile either.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_guide(
    controller: *mut Controller,
    input: *const NedInput,
    dt: f32,
    command: *mut NedCommand,
    report: *mut NedReport,
) -> i32 {
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, by the condition above.
    unsafe {
        if let Err(code) = boundary::check(command) {
            return code;
        }
        let (controller, input, axes) = match arguments(controller, input, report) {
            Ok(arguments) => arguments,
            Err(code) => {
                command.write(NedCommand::SAFE);
                return code;
            }
        };
        let plane = controller.memory.enter(&controller.guidance, input.heading);
        let planar = PlanarInput::new(input, axes, plane);
        let planar_input = planar.guidance_input(input);
        let guided = controller.update(&planar_input, dt);
        let memory = &mut controller.memory;
        memory
            .across
            .remember(&memory.state, &planar_input, &planar.across());
        command.write(controller.guided_command(&planar, &guided));
        if !report.is_null() {
            report.write(NedReport::of_guidance(&planar, &guided));
        }
        match guided.refusal {
            None => code::ALULA_OK,
            Some(_) if !in_range(input.heading) => code::ALULA_ERROR_HEADING,
            Some(reason) => code::of_refusal(reason),
        }
    }
}

/// Controller, input and its body axes, if nothing is wrong with any pointer or selector.
///
/// # Safety
/// As `alula_guide`.
#[inline(always)]
unsafe fn arguments<'a>(
    controller: *mut Controller,
    input: *const NedInput,
    report: *mut NedReport,
) -> Result<(&'a mut Initialised<'a>, &'a NedInput, BodyAxes), i32> {
    // SAFETY: As in `alula_guide`.
    unsafe {
        boundary::check_optional(report)?;
        let (controller, input) = (initialised_mut(controller)?, boundary::read(input)?);
        Ok((controller, input, axes_of(input)?))
    }
}
