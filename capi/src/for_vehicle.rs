//! The parameters of the guidance for a vehicle, by the core's rules.

use alula::{GuidanceParameters, ParameterError, Parameters as _, ResponseParameters};

use crate::boundary;
use crate::code;
use crate::parameters::{Parameters, refused};

/// Sets every parameter in `guidance` by the rules for `vehicle`, which must be complete, and for how fast it answers and is to
/// fly: the lag of its rate loop and of its thrust \[s\], the rate at which alula_guide is called \[Hz\], the
/// speed of cruise [m/s].
/// docs/your-vehicle.md says how lags are measured. Returns `ALULA_OK`, or a code that names what is refused; then nothing is set.
///
/// # Safety
/// `parameters` is null or points to memory of the caller's that holds at least the header word, already set; the whole
/// structure if that is right.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_parameters_for_vehicle(
    parameters: *mut Parameters,
    rate_lag: f32,
    thrust_lag: f32,
    control_rate: f32,
    cruise_speed: f32,
) -> i32 {
    let response = ResponseParameters::DEFAULT
        .rate_lag(rate_lag)
        .thrust_lag(thrust_lag)
        .control_rate(control_rate)
        .cruise_speed(cruise_speed);
    // SAFETY: `parameters` is null or points to its header word, and to the whole structure if that is right, which is what
    // `read` and `write` ask for; what is read is copied before anything is written.
    unsafe {
        let old = match boundary::read(parameters) {
            Ok(old) => *old,
            Err(code) => return code,
        };
        match GuidanceParameters::for_vehicle(&old.vehicle, &response) {
            Ok(guidance) => boundary::write(parameters, Parameters { guidance, ..old }),
            Err(error) => of_error(error),
        }
    }
}

/// The code of a refusal: two of the numbers are in no structure.
fn of_error(error: ParameterError) -> i32 {
    match error.parameter {
        "control_rate" => code::ALULA_ERROR_CONTROL_RATE,
        "cruise_speed" => code::ALULA_ERROR_CRUISE_SPEED,
        _ => refused(error),
    }
}
