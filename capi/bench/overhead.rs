//! The Rust calls that `alula_step` and `alula_guide` are measured against, behind one signature: a pointer in, a pointer out,
//! nothing checked, nothing converted.
#![no_std]

#[cfg(panic = "unwind")]
extern crate std;

use alula::guidance::{Across, Air, InputAcross};
use alula::ned::{BodyAxes, Ned, Quaternion, VerticalPlane};
use alula::{
    Attitude, BandwidthGains, Combined, CombinedParameters, Command, Fault, GainChoice, Guidance,
    GuidanceInput, GuidanceParameters, GuidanceState, Guided, Inertial, Model, ParameterError,
    Reference, State, Vehicle, VehicleParameters,
};

/// What the calls need.
pub struct Fixture {
    any: Guidance<Model<'static>, GainChoice>,
    combined: Guidance<Combined>,
    state: GuidanceState,
    plane: VerticalPlane,
    across: Across,
}

/// What the calls are given.
pub struct Case {
    state: State,
    reference: Reference,
    input: GuidanceInput,
}

/// Room that the C side keeps for a `Fixture`, a `Case` and a result \[bytes\].
const ROOM: usize = 1024;
const _: () = assert!(size_of::<Fixture>() <= ROOM && size_of::<Case>() <= ROOM);
const _: () = assert!(size_of::<Result<Command, Fault>>() <= ROOM && size_of::<Guided>() <= ROOM);

fn fixture() -> Result<Fixture, ParameterError> {
    let (vehicle, parameters) = (VehicleParameters::PAPER, GuidanceParameters::default());
    let combined = Combined::new(CombinedParameters::NACA_0021_RE_160E3)?;
    let any = Vehicle::new(vehicle, Model::Combined(combined))?;
    let gains = GainChoice::Bandwidth(BandwidthGains::new(&parameters, &any)?);
    Ok(Fixture {
        any: Guidance::with_gains(any, gains, &parameters)?,
        combined: Guidance::new(Vehicle::new(vehicle, combined)?, &parameters)?,
        state: GuidanceState::default(),
        plane: VerticalPlane::from_heading(0.0),
        across: Across::default(),
    })
}

/// Fills in the fixture: the defaults of the C ABI. Returns 0 if it is made.
///
/// # Safety
/// `to` points to room for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn overhead_fixture(to: *mut Fixture) -> i32 {
    match fixture() {
        Ok(value) => {
            // SAFETY: There is room for a fixture, by the condition above.
            unsafe { to.write(value) };
            0
        }
        Err(_) => 1,
    }
}

/// Fills in a case from the ten numbers of an `alula_input` from its velocity on.
///
/// # Safety
/// `case` points to room for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn overhead_case(case: *mut Case, x: &[f32; 10]) {
    let state = State {
        velocity: Inertial::new(x[0], x[1]),
        attitude: Attitude {
            cos: x[2],
            sin: x[3],
        },
        wind: Inertial::new(x[4], x[5]),
    };
    let reference = Reference {
        velocity: Inertial::new(x[6], x[7]),
        acceleration: Inertial::new(x[8], x[9]),
    };
    let value = Case {
        state,
        reference,
        input: GuidanceInput {
            velocity: state.velocity,
            attitude: state.attitude,
            air: Air::Wind(state.wind),
            reference,
            ..GuidanceInput::default()
        },
    };
    // SAFETY: There is room for a case, by the condition above.
    unsafe { case.write(value) };
}

/// The robust law with model and gains chosen at run time, which is what `alula_step` calls.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_any(
    fixture: &Fixture,
    case: &Case,
    _: f32,
    result: &mut Result<Command, Fault>,
) -> i32 {
    let control = fixture.any.control();
    *result = control.robust_in_place(&case.state, &case.reference);
    0
}

/// The robust law on the combined model, chosen by type.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_combined(
    fixture: &Fixture,
    case: &Case,
    _: f32,
    result: &mut Result<Command, Fault>,
) -> i32 {
    let control = fixture.combined.control();
    *result = control.robust_in_place(&case.state, &case.reference);
    0
}

/// The guidance with model and gains chosen at run time, which is what `alula_guide` calls.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_guide_any(
    fixture: &mut Fixture,
    case: &Case,
    dt: f32,
    guided: &mut Guided,
) -> i32 {
    *guided = fixture.any.update(&mut fixture.state, &case.input, dt);
    0
}

/// The guidance on the combined model, chosen by type.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_guide_combined(
    fixture: &mut Fixture,
    case: &Case,
    dt: f32,
    guided: &mut Guided,
) -> i32 {
    *guided = fixture.combined.update(&mut fixture.state, &case.input, dt);
    0
}

/// State and reference in north-east-down, as a Rust autopilot has them.
#[derive(Clone, Copy)]
pub struct NedCase {
    attitude: Quaternion,
    velocity: Ned,
    wind: Ned,
    reference_velocity: Ned,
    reference_acceleration: Ned,
}

/// What such an autopilot flies.
#[repr(C)]
pub struct NedResult {
    /// The guidance's own result, first: `overhead_guided` reads it.
    guided: Guided,
    body_rate: [f32; 3],
    attitude: Option<(Quaternion, f32)>,
}

const _: () = assert!(size_of::<NedCase>() <= ROOM && size_of::<NedResult>() <= ROOM);

/// Fills in a case from quaternion, velocity, wind, reference velocity and acceleration.
///
/// # Safety
/// `case` points to room for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn overhead_ned_case(case: *mut NedCase, x: &[f32; 16]) {
    let ned = |n: usize| Ned::new(x[n], x[n + 1], x[n + 2]);
    let value = NedCase {
        attitude: Quaternion {
            w: x[0],
            x: x[1],
            y: x[2],
            z: x[3],
        },
        velocity: ned(4),
        wind: ned(7),
        reference_velocity: ned(10),
        reference_acceleration: ned(13),
    };
    // SAFETY: There is room for a case, by the condition above.
    unsafe { case.write(value) };
}

/// What `alula_guide` does, by a Rust autopilot with the core: projection on a plane that stays, guidance, body rates and
/// attitude set-point. Without the checks of pointers and selectors, and without a command to be held.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_guide_ned(
    fixture: &mut Fixture,
    case: &NedCase,
    dt: f32,
    result: &mut NedResult,
) -> i32 {
    let (plane, axes) = (&fixture.plane, BodyAxes::NoseUp);
    let Some(projection) = plane.attitude(&case.attitude, axes) else {
        return 1;
    };
    let (velocity, velocity_across) = plane.project(case.velocity);
    let (wind, wind_across) = plane.project(case.wind);
    let (reference_velocity, reference_across) = plane.project(case.reference_velocity);
    let (acceleration, _) = plane.project(case.reference_acceleration);
    let input = GuidanceInput {
        velocity,
        attitude: projection.attitude,
        air: Air::Wind(wind),
        reference: Reference {
            velocity: reference_velocity,
            acceleration,
        },
        ..GuidanceInput::default()
    };
    let guided = fixture.any.update(&mut fixture.state, &input, dt);
    let across = InputAcross {
        velocity: velocity_across,
        air: wind_across,
        reference: reference_across,
    };
    fixture.across.remember(&fixture.state, &input, &across);
    let rate = guided.command.rate;
    *result = NedResult {
        guided,
        body_rate: projection.normal.map(|n| n * rate),
        attitude: Some(plane.set_point(projection.attitude, axes, rate / 6.5)),
    };
    0
}

/// Thrust and rate of a step of the guidance, for comparison.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_guided(guided: &Guided, thrust: &mut f32, rate: &mut f32) {
    (*thrust, *rate) = (guided.command.thrust, guided.command.rate);
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
