//! Return codes, their texts, and the interface's own status bits. The lower status bits are the core's [`Status`], which
//! the header's generator lists.

use core::ffi::{CStr, c_char};

use alula::aero::TableProblem;
use alula::guidance::{RejectReason, Status};
use alula::planar::equilibrium::EquilibriumError;
use alula::{Fault, Problem};

use crate::parameters;

/// Done.
pub const ALULA_OK: i32 = 0;
/// A pointer is null.
pub const ALULA_ERROR_NULL: i32 = -1;
/// A pointer is not aligned as its type asks.
pub const ALULA_ERROR_UNALIGNED: i32 = -2;
/// A header word is not that of this version's structure: caller and library disagree on version or size, or the caller
/// has not set it.
pub const ALULA_ERROR_LAYOUT: i32 = -3;
/// The controller has not been initialised, or its last initialisation failed.
pub const ALULA_ERROR_NOT_INITIALISED: i32 = -4;
/// The time step is not finite, shorter than 0.1 ms, or longer than 0.2 s.
pub const ALULA_ERROR_TIME_STEP: i32 = -5;
/// A selector (body axes, flags, a response) has no such value, or the flags contradict each other.
pub const ALULA_ERROR_SELECTOR: i32 = -6;
/// The control rate is not from 5 Hz to 10 kHz.
pub const ALULA_ERROR_CONTROL_RATE: i32 = -7;
/// The speed of cruise is not from 1 m/s to 340 m/s.
pub const ALULA_ERROR_CRUISE_SPEED: i32 = -8;
/// A goal is none. Its kind has no such value; a number of it or the position is not finite or beyond 1e8 m; or its
/// speed, climb or acceleration is not from 0.01 to 1000.
pub const ALULA_ERROR_GOAL: i32 = -9;
/// The velocity is not finite, or faster than 1000 m/s.
pub const ALULA_ERROR_VELOCITY: i32 = -10;
/// The wind is not finite, faster than 1000 m/s, or unknown to a law that needs it.
pub const ALULA_ERROR_WIND: i32 = -11;
/// The attitude is invalid: the quaternion is not of unit length, or not finite.
pub const ALULA_ERROR_ATTITUDE: i32 = -12;
/// The reference velocity is not finite, or faster than 1000 m/s.
pub const ALULA_ERROR_REFERENCE_VELOCITY: i32 = -13;
/// The reference acceleration is not finite, or above 1000 m/s².
pub const ALULA_ERROR_REFERENCE_ACCELERATION: i32 = -14;
/// The air acceleration of the feed-forward is not finite, or above 1000 m/s².
pub const ALULA_ERROR_AIR_ACCELERATION: i32 = -15;
/// The reference jerk of the feed-forward is not finite, or above 1000 m/s³.
pub const ALULA_ERROR_JERK: i32 = -16;
/// The law has no finite answer here.
pub const ALULA_ERROR_UNDEFINED: i32 = -17;
/// The state is older than `state_age`, or of negative age.
pub const ALULA_ERROR_STATE_AGE: i32 = -19;
/// No good reference has come yet.
pub const ALULA_ERROR_NO_REFERENCE: i32 = -20;
/// Every orientation is an equilibrium: there is no force to be turned.
pub const ALULA_ERROR_EVERY_ORIENTATION: i32 = -21;
/// There are more equilibria than the set has room for.
pub const ALULA_ERROR_TOO_MANY_EQUILIBRIA: i32 = -22;
/// The state lies beyond every fold, or too far from the nearest for the map.
pub const ALULA_ERROR_NO_FOLD: i32 = -23;
/// It was refused for a reason that this header has no code for.
pub const ALULA_ERROR_OTHER: i32 = -24;
/// Table: a number is not finite.
pub const ALULA_ERROR_TABLE_NOT_FINITE: i32 = -30;
/// Table: a coefficient is above 1000 in magnitude.
pub const ALULA_ERROR_TABLE_OUT_OF_RANGE: i32 = -31;
/// Table: a drag coefficient is not positive.
pub const ALULA_ERROR_TABLE_DRAG: i32 = -32;
/// Table: an angle does not exceed that of the row before by at least 0.05°.
pub const ALULA_ERROR_TABLE_NOT_INCREASING: i32 = -33;
/// Table: the first row is neither at 0, for a symmetric section, nor at −180°.
pub const ALULA_ERROR_TABLE_START: i32 = -34;
/// Table: the last row is not at 180°.
pub const ALULA_ERROR_TABLE_END: i32 = -35;
/// Table: a symmetric section has lift at 0 or 180°.
pub const ALULA_ERROR_TABLE_LIFT_ON_AXIS: i32 = -36;
/// Table: the rows at −180° and 180° differ.
pub const ALULA_ERROR_TABLE_NOT_PERIODIC: i32 = -37;
/// Table: there are fewer than five rows.
pub const ALULA_ERROR_TABLE_TOO_FEW: i32 = -38;
/// Table: there are more than `ALULA_TABLE_ROWS` rows.
pub const ALULA_ERROR_TABLE_TOO_MANY: i32 = -39;
/// Item: its kind has no such value.
pub const ALULA_ERROR_ITEM_KIND: i32 = -50;
/// Item: its place is not finite, or farther than 100 km from where positions are counted from.
pub const ALULA_ERROR_ITEM_PLACE: i32 = -51;
/// Item: its radius is not finite, or above 100 km.
pub const ALULA_ERROR_ITEM_RADIUS: i32 = -52;
/// Item: its value is not finite, negative, or beyond what the vehicle does.
pub const ALULA_ERROR_ITEM_VALUE: i32 = -53;
/// Item: its turn is narrower than the vehicle can fly at its speed.
pub const ALULA_ERROR_ITEM_NARROW: i32 = -54;
/// Item: its speed is less than the wing carries.
pub const ALULA_ERROR_ITEM_SLOW: i32 = -55;
/// Item: a take-off is the first item, or stands after a landing.
pub const ALULA_ERROR_ITEM_NOT_FIRST: i32 = -56;
/// Item: after a landing only a take-off.
pub const ALULA_ERROR_ITEM_AFTER_LANDING: i32 = -57;
/// Item: there are more than `ALULA_MISSION_ITEMS`.
pub const ALULA_ERROR_ITEM_TOO_MANY: i32 = -58;
/// Codes from here down name a parameter: `ALULA_ERROR_PARAMETER - 4 * index - problem`. The index is the parameter's
/// place in `alula_parameters`, from 0, and behind those in `alula_mission_parameters`. The problem is 0 for a number
/// that is not finite, 1 for one that is not positive, 2 for one out of range. It is 3 for one that contradicts another
/// parameter.
pub const ALULA_ERROR_PARAMETER: i32 = -100;

/// The command is the safe one.
pub const ALULA_STATUS_SAFE: u32 = 1 << 16;
/// The command is the last one flown, held while inputs are bad.
pub const ALULA_STATUS_HOLDING: u32 = 1 << 17;
/// The attitude set-point's lead over the attitude is limited to 90°.
pub const ALULA_STATUS_LEAD_LIMITED: u32 = 1 << 18;
/// A plan is due: call `alula_plan`.
pub const ALULA_STATUS_PLAN_DUE: u32 = 1 << 19;

// They share no bit with the core's.
const _: () = assert!(
    Status::all().bits() as u32
        & (ALULA_STATUS_SAFE
            | ALULA_STATUS_HOLDING
            | ALULA_STATUS_LEAD_LIMITED
            | ALULA_STATUS_PLAN_DUE)
        == 0
);

/// The code of a fault.
pub(crate) const fn of_fault(fault: Fault) -> i32 {
    match fault {
        Fault::Velocity => ALULA_ERROR_VELOCITY,
        Fault::Wind => ALULA_ERROR_WIND,
        Fault::Attitude => ALULA_ERROR_ATTITUDE,
        Fault::ReferenceVelocity => ALULA_ERROR_REFERENCE_VELOCITY,
        Fault::ReferenceAcceleration => ALULA_ERROR_REFERENCE_ACCELERATION,
        Fault::AirAcceleration => ALULA_ERROR_AIR_ACCELERATION,
        Fault::Jerk => ALULA_ERROR_JERK,
        Fault::Undefined => ALULA_ERROR_UNDEFINED,
        _ => ALULA_ERROR_OTHER,
    }
}

/// The code of a refused frame.
pub(crate) const fn of_reject_reason(reason: RejectReason) -> i32 {
    match reason {
        RejectReason::TimeStep => ALULA_ERROR_TIME_STEP,
        RejectReason::StateAge => ALULA_ERROR_STATE_AGE,
        RejectReason::NoReference => ALULA_ERROR_NO_REFERENCE,
        RejectReason::Law(fault) => of_fault(fault),
        _ => ALULA_ERROR_OTHER,
    }
}

/// The code of a missing set of equilibria.
pub(crate) const fn of_equilibrium(error: EquilibriumError) -> i32 {
    match error {
        EquilibriumError::ReferenceVelocity => ALULA_ERROR_REFERENCE_VELOCITY,
        EquilibriumError::ReferenceAcceleration => ALULA_ERROR_REFERENCE_ACCELERATION,
        EquilibriumError::Wind => ALULA_ERROR_WIND,
        EquilibriumError::EveryOrientation => ALULA_ERROR_EVERY_ORIENTATION,
        EquilibriumError::Overflow => ALULA_ERROR_TOO_MANY_EQUILIBRIA,
        _ => ALULA_ERROR_OTHER,
    }
}

/// The code of a refused table.
pub(crate) const fn of_table(problem: TableProblem) -> i32 {
    match problem {
        TableProblem::NotFinite => ALULA_ERROR_TABLE_NOT_FINITE,
        TableProblem::OutOfRange => ALULA_ERROR_TABLE_OUT_OF_RANGE,
        TableProblem::DragNotPositive => ALULA_ERROR_TABLE_DRAG,
        TableProblem::NotIncreasing => ALULA_ERROR_TABLE_NOT_INCREASING,
        TableProblem::Start => ALULA_ERROR_TABLE_START,
        TableProblem::End => ALULA_ERROR_TABLE_END,
        TableProblem::LiftOnAxis => ALULA_ERROR_TABLE_LIFT_ON_AXIS,
        TableProblem::NotPeriodic => ALULA_ERROR_TABLE_NOT_PERIODIC,
        TableProblem::TooFew => ALULA_ERROR_TABLE_TOO_FEW,
        TableProblem::TooMany => ALULA_ERROR_TABLE_TOO_MANY,
        _ => ALULA_ERROR_OTHER,
    }
}

/// The code of the `index`th parameter's refusal.
pub(crate) const fn of_parameter(index: usize, problem: Problem) -> i32 {
    let problem = match problem {
        Problem::NotFinite => 0,
        Problem::NotPositive => 1,
        Problem::OutOfRange => 2,
        Problem::Contradiction => 3,
        _ => return ALULA_ERROR_OTHER,
    };
    ALULA_ERROR_PARAMETER - 4 * index as i32 - problem
}

/// What a return code means, in one line that needs no freeing. Never null.
#[unsafe(no_mangle)]
pub extern "C" fn alula_strerror(code: i32) -> *const c_char {
    text(code).as_ptr()
}

/// What a return code means.
fn text(code: i32) -> &'static CStr {
    match code {
        ALULA_OK => c"done",
        ALULA_ERROR_NULL => c"a pointer is null",
        ALULA_ERROR_UNALIGNED => c"a pointer is not aligned",
        ALULA_ERROR_LAYOUT => c"a header is not that of this version's structure",
        ALULA_ERROR_NOT_INITIALISED => c"the controller is not initialised",
        ALULA_ERROR_TIME_STEP => c"the time step is not in [0.0001, 0.2] s",
        ALULA_ERROR_SELECTOR => c"a selector has no such value",
        ALULA_ERROR_CONTROL_RATE => c"the control rate is not in [5, 10000] Hz",
        ALULA_ERROR_CRUISE_SPEED => c"the speed of cruise is not in [1, 340] m/s",
        ALULA_ERROR_GOAL => c"the goal has no such kind, or a number of it is not in its range",
        ALULA_ERROR_VELOCITY => c"velocity is not finite or absurdly large",
        ALULA_ERROR_WIND => c"wind is not finite, absurdly large, or unknown",
        ALULA_ERROR_ATTITUDE => c"attitude is not a quaternion of unit length",
        ALULA_ERROR_REFERENCE_VELOCITY => c"reference velocity is not finite or absurdly large",
        ALULA_ERROR_REFERENCE_ACCELERATION => {
            c"reference acceleration is not finite or absurdly large"
        }
        ALULA_ERROR_AIR_ACCELERATION => c"air acceleration is not finite or absurdly large",
        ALULA_ERROR_JERK => c"reference jerk is not finite or absurdly large",
        ALULA_ERROR_UNDEFINED => c"the law is undefined here",
        ALULA_ERROR_STATE_AGE => c"the state is too old",
        ALULA_ERROR_NO_REFERENCE => c"no good reference has come yet",
        ALULA_ERROR_EVERY_ORIENTATION => c"every orientation is an equilibrium",
        ALULA_ERROR_TOO_MANY_EQUILIBRIA => c"there are more equilibria than the set can hold",
        ALULA_ERROR_NO_FOLD => c"there is no fold near this state",
        ALULA_ERROR_OTHER => c"refused for a reason that this header has no code for",
        ALULA_ERROR_TABLE_NOT_FINITE => c"table: every number must be finite",
        ALULA_ERROR_TABLE_OUT_OF_RANGE => c"table: coefficients must be within +-1000",
        ALULA_ERROR_TABLE_DRAG => c"table: the drag coefficient must be positive",
        ALULA_ERROR_TABLE_NOT_INCREASING => {
            c"table: angles must increase by at least 0.05 degrees from row to row"
        }
        ALULA_ERROR_TABLE_START => {
            c"table: the first angle must be 0 (symmetric section) or -180 degrees"
        }
        ALULA_ERROR_TABLE_END => c"table: the last angle must be 180 degrees",
        ALULA_ERROR_TABLE_LIFT_ON_AXIS => {
            c"table: a symmetric section has no lift at 0 and 180 degrees"
        }
        ALULA_ERROR_TABLE_NOT_PERIODIC => c"table: the rows at -180 and 180 degrees must agree",
        ALULA_ERROR_TABLE_TOO_FEW => c"table: at least five rows are needed",
        ALULA_ERROR_TABLE_TOO_MANY => c"table: there are more rows than it has room for",
        ALULA_ERROR_ITEM_KIND => c"item: its kind has no such value",
        ALULA_ERROR_ITEM_PLACE => c"item: the place must be within 100 km",
        ALULA_ERROR_ITEM_RADIUS => c"item: the radius must be within 100 km",
        ALULA_ERROR_ITEM_VALUE => c"item: the value is not in its range",
        ALULA_ERROR_ITEM_NARROW => c"item: the vehicle cannot turn so narrowly at this speed",
        ALULA_ERROR_ITEM_SLOW => c"item: the wing does not carry at this speed",
        ALULA_ERROR_ITEM_NOT_FIRST => c"item: a take-off is the first item, or after a landing",
        ALULA_ERROR_ITEM_AFTER_LANDING => c"item: after a landing only a take-off",
        ALULA_ERROR_ITEM_TOO_MANY => c"item: a mission has at most 128 items",
        _ => parameter_text(code).unwrap_or(c"unknown code"),
    }
}

fn parameter_text(code: i32) -> Option<&'static CStr> {
    parameters::text(usize::try_from(ALULA_ERROR_PARAMETER.checked_sub(code)?).ok()?)
}
