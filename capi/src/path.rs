//! Following a path: how fast its parameter may advance.

use crate::boundary;
use crate::code;
use crate::controller::{Controller, initialised};
use crate::input::ned;

/// How fast a path may go on, in multiples of its own speed, between 0.5 and 1.25: slower where the vehicle is behind, faster
/// where it is ahead. `position_error` is the position less the path's \[m\], `velocity` the path's velocity at its own
/// speed [m/s], both north, east, down. With the scale p the reference is p times that velocity and p² times its
/// acceleration, and the path's parameter advances at p times its own rate. What is not finite gives 1, and so does every
/// code but `ALULA_OK`.
///
/// # Safety
/// `controller` as in `alula_step`. Each vector is null or points to three numbers, `time_scale` is null or points to one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_path_time_scale(
    controller: *const Controller,
    position_error: *const f32,
    velocity: *const f32,
    time_scale: *mut f32,
) -> i32 {
    // SAFETY: Every pointer that passes its check points to what it is to point to, by the condition above: the controller
    // to what its header word says, the vectors to three numbers each, `time_scale` to one.
    unsafe {
        if let Err(code) = boundary::check_pointer(time_scale) {
            return code;
        }
        let made = boundary::check_pointer(position_error)
            .and_then(|()| boundary::check_pointer(velocity))
            .and_then(|()| initialised(controller))
            .map(|controller| {
                let position_error = ned(position_error.cast::<[f32; 3]>().read());
                let velocity = ned(velocity.cast::<[f32; 3]>().read());
                controller
                    .guidance
                    .guidance()
                    .path_time_scale(position_error, velocity)
            });
        time_scale.write(made.unwrap_or(1.0));
        made.map_or_else(|code| code, |_| code::ALULA_OK)
    }
}
