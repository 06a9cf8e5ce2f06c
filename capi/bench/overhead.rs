//! The Rust calls that `alula_step` and `alula_guide` are measured against, behind one signature: a pointer in, a pointer out,
//! nothing checked.
#![no_std]

#[cfg(panic = "unwind")]
extern crate std;

use alula::guidance::Air;
use alula::ned::{BodyAxes, Frd, Quaternion};
use alula::spatial::{Command, Heading, Ned, Orientation, Reference, State};
use alula::{
    BandwidthGains, Combined, CombinedParameters, Fault, GainChoice, Guidance, GuidanceInput,
    GuidanceOutput, GuidanceParameters, Hardened, HardenedState, Model, ParameterError, Vehicle,
    VehicleParameters,
};

/// What the calls need.
pub struct Fixture {
    any: Hardened<Guidance<Model<'static>, GainChoice>>,
    combined: Hardened<Guidance<Combined>>,
    state: HardenedState,
}

/// What the calls are given.
pub struct Case {
    attitude: Quaternion,
    heading: f32,
    state: State,
    input: GuidanceInput,
}

/// A command as an autopilot flies it.
#[repr(C)]
pub struct SetPoint {
    /// The law's own.
    pub command: Command,
    /// Rates about the body axes [rad/s].
    pub body_rate: [f32; 3],
    /// Attitude set-point, and whether its lead is limited.
    pub set_point: (Quaternion, bool),
}

/// Room that the C side keeps for a `Fixture`, a `Case` and a result \[bytes\].
const ROOM: usize = 3200;
const _: () = assert!(size_of::<Fixture>() <= ROOM && size_of::<Case>() <= ROOM);
const _: () =
    assert!(size_of::<Result<Command, Fault>>() <= ROOM && size_of::<GuidanceOutput>() <= ROOM);
const _: () = assert!(size_of::<Result<SetPoint, Fault>>() <= ROOM);

fn fixture() -> Result<Fixture, ParameterError> {
    let (vehicle, parameters) = (VehicleParameters::PAPER, GuidanceParameters::default());
    let vehicle = vehicle.c_y(0.5);
    let combined = Combined::new(CombinedParameters::NACA_0021_RE_160E3)?;
    let any = Vehicle::new(vehicle, Model::Combined(combined))?;
    let gains = GainChoice::Bandwidth(BandwidthGains::new(&parameters, &any)?);
    Ok(Fixture {
        any: Hardened::new(Guidance::with_gains(any, gains, &parameters)?),
        combined: Hardened::new(Guidance::new(
            Vehicle::new(vehicle, combined)?,
            &parameters,
        )?),
        state: HardenedState::default(),
    })
}

/// Fills in the fixture: the defaults of the C ABI, with side force. Returns 0 if it is made.
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

/// Fills in a case from twenty numbers: quaternion of fixed-wing axes, velocity, wind, reference velocity and acceleration,
/// heading, and specific force.
///
/// # Safety
/// `case` points to room for it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn overhead_case(case: *mut Case, x: &[f32; 20]) {
    let ned = |n: usize| Ned::new(x[n], x[n + 1], x[n + 2]);
    let attitude = Quaternion {
        w: x[0],
        x: x[1],
        y: x[2],
        z: x[3],
    };
    let orientation = Orientation::from_quaternion(&attitude, BodyAxes::NoseForward);
    let orientation = orientation.unwrap_or(Orientation::UNKNOWN);
    let (velocity, wind) = (ned(4), ned(7));
    let reference = Reference {
        velocity: ned(10),
        acceleration: ned(13),
        heading: Heading::from_angle(x[16]),
    };
    let value = Case {
        attitude,
        heading: x[16],
        state: State {
            velocity,
            orientation,
            wind,
            ..State::default()
        },
        input: GuidanceInput::default()
            .velocity(velocity)
            .orientation(orientation)
            .air(Air::Wind(wind))
            .specific_force(Some(Frd::new(x[17], x[18], x[19])))
            .reference(reference),
    };
    // SAFETY: There is room for a case, by the condition above.
    unsafe { case.write(value) };
}

/// The law on the combined model, chosen by type.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_combined(
    fixture: &Fixture,
    case: &Case,
    _: f32,
    result: &mut Result<Command, Fault>,
) -> i32 {
    let control = fixture.combined.guidance().control();
    *result = control.robust(&case.state, &case.input.reference, None);
    0
}

/// The law with model and gains chosen at run time.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_any(
    fixture: &Fixture,
    case: &Case,
    _: f32,
    result: &mut Result<Command, Fault>,
) -> i32 {
    let control = fixture.any.guidance().control();
    *result = control.robust(&case.state, &case.input.reference, None);
    0
}

/// What `alula_step` does, by a Rust autopilot with the core: from a quaternion and the angle of a heading to body rates and
/// an attitude set-point.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_step(
    fixture: &Fixture,
    case: &Case,
    _: f32,
    result: &mut Result<SetPoint, Fault>,
) -> i32 {
    *result = command(fixture, case);
    0
}

#[inline(always)]
fn command(fixture: &Fixture, case: &Case) -> Result<SetPoint, Fault> {
    let axes = BodyAxes::NoseForward;
    let state = State {
        orientation: Orientation::from_quaternion(&case.attitude, axes)?,
        ..case.state
    };
    let reference = Reference {
        heading: Heading::from_angle(case.heading),
        ..case.input.reference
    };
    let control = fixture.any.guidance().control();
    let command = control.robust(&state, &reference, None)?;
    Ok(SetPoint {
        command,
        body_rate: axes.components(command.rates),
        set_point: case.attitude.leading(axes, command.rates, 1.0 / 6.5),
    })
}

/// The guidance on the combined model, chosen by type.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_guide_combined(
    fixture: &mut Fixture,
    case: &Case,
    dt: f32,
    guided: &mut GuidanceOutput,
) -> i32 {
    *guided = fixture.combined.update(&mut fixture.state, &case.input, dt);
    0
}

/// The guidance with model and gains chosen at run time, which is what `alula_guide` calls.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_guide_any(
    fixture: &mut Fixture,
    case: &Case,
    dt: f32,
    guided: &mut GuidanceOutput,
) -> i32 {
    *guided = fixture.any.update(&mut fixture.state, &case.input, dt);
    0
}

/// Thrust and rates of a command, along the fixed wing's axes.
fn numbers(command: &Command) -> [f32; 4] {
    let [p, q, r] = BodyAxes::NoseForward.components(command.rates);
    [command.thrust, p, q, r]
}

/// Thrust and rates of a step of the guidance, for comparison.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_guided(guided: &GuidanceOutput, out: &mut [f32; 4]) {
    *out = numbers(&guided.command);
}

/// Thrust and rates of a result of the law, for comparison. Returns 0 if there is a command.
#[unsafe(no_mangle)]
pub extern "C" fn overhead_result(result: &Result<Command, Fault>, out: &mut [f32; 4]) -> i32 {
    match result {
        Ok(command) => {
            *out = numbers(command);
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
