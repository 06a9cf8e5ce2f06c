//! The step of the bare law.

use alula::guidance::{MAX_STEP, MIN_STEP};

use crate::boundary;
use crate::code;
use crate::command::Command;
use crate::controller::{Controller, initialised};
use crate::input::Input;
use crate::report::Report;

/// One step of the bare law of the winged vehicle, robust: from `input` to `command`, `dt` seconds after the last. The law
/// has no memory and no limits: `dt` is only checked. Whatever is returned but `ALULA_OK`, the command is the safe one, and
/// `report` is not written; if `command` itself is at fault, it is not written either. `report` may be null; of
/// `alula_guide` alone are its margins, phase and use of the air.
///
/// # Safety
/// Each pointer is null or points to memory of the caller's that holds at least the header word; the whole structure
/// if that is right. No other call changes the controller meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_step(
    controller: *const Controller,
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
        // The command is written where it is made: passed on as a value it would be copied twice.
        match step(controller, input, dt, command, report) {
            Ok(()) => code::ALULA_OK,
            Err(code) => {
                command.write(Command::SAFE);
                code
            }
        }
    }
}

/// The step, if nothing is wrong with any argument.
///
/// # Safety
/// As `alula_step`, and `command` has been checked.
#[inline(always)]
unsafe fn step(
    controller: *const Controller,
    input: *const Input,
    dt: f32,
    command: *mut Command,
    report: *mut Report,
) -> Result<(), i32> {
    // SAFETY: As in `alula_step`.
    unsafe {
        boundary::check_optional(report)?;
        let controller = initialised(controller)?;
        let input = boundary::read(input)?;
        let axes = input.axes()?;
        if !(MIN_STEP..=MAX_STEP).contains(&dt) {
            return Err(code::ALULA_ERROR_TIME_STEP);
        }
        let (state, reference) = (input.state(axes)?, input.reference());
        let feed_forward = input.feed_forward();
        let control = controller.guidance.guidance().control();
        let value = control
            .robust(&state, &reference, feed_forward.as_ref())
            .map_err(code::of_fault)?;
        if !report.is_null() {
            report.write(Report::of_law(&reference, &value));
        }
        command.write(controller.of_law(input, axes, &value, 0));
        Ok(())
    }
}
