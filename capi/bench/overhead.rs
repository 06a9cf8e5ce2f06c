//! The Rust calls that `alula_step` is measured against, behind the same signature: a pointer in, a pointer out, nothing
//! checked, nothing converted.
#![no_std]

#[cfg(panic = "unwind")]
extern crate std;

use alula::control::GainChoice;
use alula::{
    Attitude, Combined, CombinedParameters, Command, Fault, GainParameters, Gains, Inertial, Model,
    Reference, State, Vehicle, VehicleParameters, VelocityControl,
};

/// What the calls need.
pub struct Fixture {
    any: VelocityControl<Model, GainChoice>,
    combined: VelocityControl<Combined>,
}

/// What the calls are given.
pub struct Case {
    state: State,
    reference: Reference,
}

/// Room that the C side keeps for a `Fixture`, a `Case` and a result \[bytes\].
const ROOM: usize = 512;
const _: () = assert!(size_of::<Fixture>() <= ROOM && size_of::<Case>() <= ROOM);
const _: () = assert!(size_of::<Result<Command, Fault>>() <= ROOM);

/// Fills in the fixture: the defaults of the C ABI. Returns 0 if it is made.
///
/// # Safety
/// `fixture` points to room for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn overhead_fixture(fixture: *mut Fixture) -> i32 {
    let combined = Combined::new(CombinedParameters::NACA_0021_RE_160E3);
    let gains = Gains::new(GainParameters::PAPER);
    let (Ok(combined), Ok(gains)) = (combined, gains) else {
        return 1;
    };
    let parameters = VehicleParameters::PAPER;
    let any = Vehicle::new(parameters, Model::Combined(combined));
    let (Ok(any), Ok(vehicle)) = (any, Vehicle::new(parameters, combined)) else {
        return 1;
    };
    let value = Fixture {
        any: VelocityControl::new(any, GainChoice::Constant(gains)),
        combined: VelocityControl::new(vehicle, gains),
    };
    // SAFETY: the caller's word.
    unsafe { fixture.write(value) };
    0
}

/// Fills in a case from the ten numbers of an `alula_input` from its velocity on.
///
/// # Safety
/// `case` points to room for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn overhead_case(case: *mut Case, x: &[f32; 10]) {
    let value = Case {
        state: State {
            velocity: Inertial::new(x[0], x[1]),
            attitude: Attitude {
                cos: x[2],
                sin: x[3],
            },
            wind: Inertial::new(x[4], x[5]),
        },
        reference: Reference {
            velocity: Inertial::new(x[6], x[7]),
            acceleration: Inertial::new(x[8], x[9]),
        },
    };
    // SAFETY: the caller's word.
    unsafe { case.write(value) };
}

/// The robust law with model and gains chosen at run time, which is what the C entry calls.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_any(
    fixture: &Fixture,
    case: &Case,
    _: f32,
    result: &mut Result<Command, Fault>,
) -> i32 {
    *result = fixture.any.robust_in_place(&case.state, &case.reference);
    0
}

/// The robust law on the combined model with constant gains, chosen by type.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_combined(
    fixture: &Fixture,
    case: &Case,
    _: f32,
    result: &mut Result<Command, Fault>,
) -> i32 {
    *result = fixture
        .combined
        .robust_in_place(&case.state, &case.reference);
    0
}

/// Thrust and rate of a result, for comparison. Returns 0 if there is a command.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_result(
    result: &Result<Command, Fault>,
    thrust: &mut f32,
    rate: &mut f32,
) -> i32 {
    match result {
        Ok(command) => {
            (*thrust, *rate) = (command.thrust, command.rate);
            0
        }
        Err(_) => 1,
    }
}

#[cfg(panic = "abort")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
