//! The step of the guidance, in the axes of autopilots.

use alula::guidance::{Air, InputAcross, Mode};
use alula::{GuidanceInput, Guided};

use crate::boundary;
use crate::code;
use crate::controller::{Controller, Initialised, initialised_mut};
use crate::ned_command::NedCommand;
use crate::ned_input::{
    AIR, ALULA_AIR_VELOCITY, ALULA_POSITION, NedInput, PlanarInput, in_range, ned,
};
use crate::ned_report::NedReport;

impl Initialised<'_> {
    /// A step of the guidance: its command, and what it comes from.
    #[inline(always)]
    fn guide(
        &mut self,
        input: &NedInput,
        dt: f32,
    ) -> Result<(NedCommand, PlanarInput, Guided), i32> {
        let plane = self.memory.enter(&self.guidance, input.heading);
        let planar = PlanarInput::new(input, plane)?;
        let planar_input = GuidanceInput {
            velocity: planar.velocity,
            attitude: planar.projection.attitude,
            state_age: input.state_age,
            air: match input.flags & AIR {
                0 => Air::Wind(planar.air),
                ALULA_AIR_VELOCITY => Air::Velocity(planar.air),
                _ => Air::Unknown,
            },
            position_error: (input.flags & ALULA_POSITION != 0)
                .then(|| planar.plane.project(ned(input.position_error)).0),
            reference: planar.reference,
            reference_age: input.reference_age,
        };
        let guided = self
            .guidance
            .update(&mut self.memory.state, &planar_input, dt);
        let across = InputAcross {
            velocity: planar.lateral_velocity,
            air: planar.lateral_air,
            reference: planar.lateral_reference_velocity,
        };
        self.memory
            .across
            .remember(&self.memory.state, &planar_input, &across);
        let mut command = if guided.mode == Mode::Flying {
            let command = self.command(&planar, guided.command.thrust, guided.command.rate);
            self.memory.keep(&command, planar.axes);
            command
        } else {
            self.substitute(&planar, &guided)
        };
        command.status |= u32::from(guided.status.bits());
        Ok((command, planar, guided))
    }

    /// The command where the law is not flown: the last one in full, or the safe one at the attitude that there is. If
    /// that is not known, the last attitude set-point stays.
    #[cold]
    #[inline(never)]
    fn substitute(&mut self, planar: &PlanarInput, guided: &Guided) -> NedCommand {
        let last = self.memory.last(planar.axes);
        if guided.mode == Mode::Holding {
            return NedCommand {
                status: code::ALULA_STATUS_HOLDING,
                ..last
            };
        }
        let mut command = self.command(planar, guided.command.thrust, guided.command.rate);
        command.status = code::ALULA_STATUS_SAFE;
        if command.pitch.is_finite() && command.quaternion.iter().all(|c| c.is_finite()) {
            self.memory.keep(&command, planar.axes);
        } else {
            (command.pitch, command.quaternion) = (last.pitch, last.quaternion);
            command.body_rate = [0.0; 3];
        }
        command
    }
}

/// One step of the guidance: supervision, reference limit, outer loop, law and actuator limits. It always gives a
/// command. If the return code says that the input was refused, the command is the last one flown, for as long as
/// `hold` (`ALULA_STATUS_HOLDING`), and then the safe one: `safe_thrust`, no rotation (`ALULA_STATUS_SAFE`). If it is a
/// pointer, a header, the controller or a selector that is at fault, there was no step, and the command is that of
/// `alula_ned_command_default`. `report` may be null, which saves the time that it takes.
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
    let mut refusal = code::ALULA_OK;
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, by the condition above.
    let code = unsafe {
        boundary::answer(command, NedCommand::SAFE, || {
            boundary::check_optional(report)?;
            let controller = initialised_mut(controller)?;
            let input = boundary::read(input)?;
            let (command, planar, guided) = controller.guide(input, dt)?;
            if let Some(reason) = guided.refusal {
                refusal = if in_range(input.heading) {
                    code::of_refusal(reason)
                } else {
                    code::ALULA_ERROR_HEADING
                };
            }
            if !report.is_null() {
                report.write(NedReport::of_guidance(&planar, &guided));
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
