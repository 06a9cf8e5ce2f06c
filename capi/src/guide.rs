//! The step of the guidance.

use alula::guidance::{Mode, PlannerOptions};
use alula::ned::{BodyAxes, Quaternion};
use alula::spatial::Orientation;
use alula::{GuidanceInput, GuidanceOutput};

use crate::boundary;
use crate::code;
use crate::command::Command;
use crate::controller::{Controller, Initialised, initialised_mut};
use crate::input::{
    ALULA_HOLD_ALTITUDE_ONLY, ALULA_NOSE_BELOW_VERTICAL, ALULA_POSITION, ALULA_SPECIFIC_FORCE,
    Input, ned,
};
use crate::report::Report;

impl Input {
    /// The input of the core's guidance.
    #[inline(always)]
    pub(crate) fn guidance_input(&self, axes: BodyAxes) -> GuidanceInput {
        GuidanceInput::default()
            .velocity(ned(self.velocity))
            .orientation(
                Orientation::from_quaternion(&self.quaternion(), axes)
                    .unwrap_or(Orientation::UNKNOWN),
            )
            .state_age(self.state_age)
            .air(self.air())
            .specific_force(
                (self.flags & ALULA_SPECIFIC_FORCE != 0).then(|| axes.vector(self.specific_force)),
            )
            .position_error((self.flags & ALULA_POSITION != 0).then(|| ned(self.position_error)))
            .reference(self.reference())
            .reference_age(self.reference_age)
            .planner_options(
                PlannerOptions::default()
                    .altitude_band(self.altitude_band)
                    .nose_below_vertical(self.flags & ALULA_NOSE_BELOW_VERTICAL != 0)
                    .hold_altitude_only(self.flags & ALULA_HOLD_ALTITUDE_ONLY != 0),
            )
    }
}

impl Initialised<'_> {
    /// A step of the guidance. Out of line: it is there once.
    #[inline(never)]
    pub(crate) fn update(&mut self, told: &GuidanceInput, dt: f32) -> GuidanceOutput {
        self.guidance.update(&mut self.memory.state, told, dt)
    }

    /// The memory of a vehicle that flies already; an attitude that is none is refused.
    fn take_over(
        &mut self,
        input: &Input,
        axes: BodyAxes,
        thrust_normalised: f32,
        rates: [f32; 3],
    ) -> i32 {
        let Ok(orientation) = Orientation::from_quaternion(&input.quaternion(), axes) else {
            return code::ALULA_ERROR_ATTITUDE;
        };
        let thrust = thrust_normalised / self.inverse_thrust_max;
        let state = self
            .guidance
            .take_over(&orientation, thrust, axes.vector(rates));
        self.memory = state.into();
        code::ALULA_OK
    }

    /// The command of a step of the guidance. Its attitude set-point is kept in case that it is to be held.
    #[inline(always)]
    pub(crate) fn guided_command(
        &mut self,
        input: &Input,
        axes: BodyAxes,
        guided: &GuidanceOutput,
    ) -> Command {
        if guided.mode == Mode::Flying {
            let status = u32::from(guided.status.bits())
                | if guided.plan_due {
                    code::ALULA_STATUS_PLAN_DUE
                } else {
                    0
                };
            let command = self.of_law(input, axes, &guided.command, status);
            self.memory.keep(command.quaternion, axes);
            command
        } else {
            self.substitute(input, axes, guided)
        }
    }

    /// The command where the law is not flown. Thrust and rates are the guidance's: the last ones, or the safe ones. The
    /// attitude set-point is the last one while the command is held; else the present attitude, if it is known, or the last
    /// one.
    #[cold]
    #[inline(never)]
    fn substitute(&mut self, input: &Input, axes: BodyAxes, guided: &GuidanceOutput) -> Command {
        const ALIGNED: Quaternion = Quaternion {
            w: 1.0,
            x: 0.0,
            y: 0.0,
            z: 0.0,
        };
        let holds = guided.mode == Mode::Holding;
        let present = Orientation::from_quaternion(&input.quaternion(), axes)
            .map(|present| present.to_quaternion(axes))
            .ok();
        let last = self.memory.last(axes);
        let set_point = if holds {
            last.or(present)
        } else {
            present.or(last)
        };
        let status = u32::from(guided.status.bits())
            | if holds {
                code::ALULA_STATUS_HOLDING
            } else {
                code::ALULA_STATUS_SAFE
            };
        let command = self.command(axes, &guided.command, &set_point.unwrap_or(ALIGNED), status);
        self.memory.keep(command.quaternion, axes);
        command
    }
}

/// Takes over a vehicle that flies already: at the attitude in `input`, with `thrust_normalised` and `body_rate` [rad/s] commanded last, by whoever flew
/// it, about the axes of `input`. The first good call of `alula_guide` is flown; until it comes this command is held, for `hold` at most. What was
/// remembered is forgotten. For what is not finite stand the safe thrust and no rotation.
///
/// # Safety
/// As `alula_reset`; `input` and `body_rate` are as `alula_goal_step`'s `input` and `position`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_take_over(
    controller: *mut Controller,
    input: *const Input,
    thrust_normalised: f32,
    body_rate: *const f32,
) -> i32 {
    // SAFETY: The pointers are null, unaligned or as `initialised_mut`, `read` and `check_pointer` ask for, by the condition above.
    unsafe {
        let controller = match initialised_mut(controller) {
            Ok(controller) => controller,
            Err(code) => return code,
        };
        let input = match boundary::read(input) {
            Ok(input) => input,
            Err(code) => return code,
        };
        let axes = match input.axes() {
            Ok(axes) => axes,
            Err(code) => return code,
        };
        if let Err(code) = boundary::check_pointer(body_rate) {
            return code;
        }
        let rates = *body_rate.cast::<[f32; 3]>();
        controller.take_over(input, axes, thrust_normalised, rates)
    }
}

/// One step of the guidance: supervision, reference model, outer loop, law and actuator limits. It always gives a command. If
/// the return code says that the input was refused, the command is the last one flown, for as long as `hold`
/// (`ALULA_STATUS_HOLDING`), and then the safe one: `safe_thrust`, no rotation (`ALULA_STATUS_SAFE`). A plan is due after it where the
/// command's status has `ALULA_STATUS_PLAN_DUE`: then call `alula_plan`. If a pointer, a header,
/// the controller or a selector is at fault, there was no step, and the command is that of `alula_command_default`. `report`
/// may be null.
///
/// # Safety
/// As `alula_step`, and no other call reads the controller meanwhile either.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_guide(
    controller: *mut Controller,
    input: *const Input,
    dt: f32,
    command: *mut Command,
    report: *mut Report,
) -> i32 {
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, by the condition above.
    unsafe {
        if let Err(code) = boundary::check(command) {
            return code;
        }
        let Arguments {
            controller,
            input,
            axes,
        } = match arguments(controller, input, report) {
            Ok(arguments) => arguments,
            Err(code) => {
                command.write(Command::SAFE);
                return code;
            }
        };
        let guided = controller.update(&input.guidance_input(axes), dt);
        let value = controller.guided_command(input, axes, &guided);
        command.write(value);
        if !report.is_null() {
            report.write(Report::of_guidance(&guided));
        }
        of_guidance(&guided)
    }
}

/// The code of a step of the guidance.
pub(crate) fn of_guidance(guided: &GuidanceOutput) -> i32 {
    guided
        .reject_reason
        .map_or(code::ALULA_OK, code::of_reject_reason)
}

/// What a call is of.
struct Arguments<'a> {
    controller: &'a mut Initialised<'a>,
    input: &'a Input,
    axes: BodyAxes,
}

/// What a call is of, if nothing is wrong with any pointer or selector.
///
/// # Safety
/// As `alula_guide`.
#[inline(always)]
unsafe fn arguments<'a>(
    controller: *mut Controller,
    input: *const Input,
    report: *mut Report,
) -> Result<Arguments<'a>, i32> {
    // SAFETY: As in `alula_guide`.
    unsafe {
        boundary::check_optional(report)?;
        let (controller, input) = (initialised_mut(controller)?, boundary::read(input)?);
        Ok(Arguments {
            controller,
            input,
            axes: input.axes()?,
        })
    }
}
