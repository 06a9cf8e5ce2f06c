//! The controller: a vehicle's guidance and its memory, in memory of the caller's.

use alula::planar::Gains;
use alula::{
    BandwidthGains, GainChoice, Guidance, Hardened, Model, ModelParameters, ParameterError,
    Problem, Vehicle,
};

use crate::boundary::{self, Layout};
use crate::code;
use crate::memory::Memory;
use crate::parameters::{ALULA_GAINS_CONSTANT, ALULA_MODEL_TABLE, Parameters, refused};
use crate::table::{self, Table};

/// A controller: opaque memory of the caller's, where and as long as the caller likes. Set `header`, then call
/// `alula_init`. It holds no pointer into itself: a copy is another controller.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Controller {
    /// `ALULA_HEADER(alula_controller)` before `alula_init`.
    pub header: u32,
    /// Private.
    pub reserved: u32,
    /// Private.
    pub opaque: [u64; 236],
}

impl Controller {
    /// Memory that is ready for `alula_init`.
    pub const BLANK: Self = Self {
        header: Self::HEADER,
        reserved: 0,
        opaque: [0; 236],
    };
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but unsigned integers.
unsafe impl Layout for Controller {}

/// The header word of a controller that is initialised.
const INITIALISED: u32 = Controller::HEADER | 1 << 31;

/// What is in a [`Controller`] after `alula_init`. `'a` is the life of the table, if the model is one.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Initialised<'a> {
    header: u32,
    pub guidance: Hardened<Guidance<Model<'a>, GainChoice>>,
    pub memory: Memory,
    /// One over the thrust of normalised thrust 1 [1/N].
    pub inverse_thrust_max: f32,
    /// One over the attitude loop's gain \[s\].
    pub inverse_attitude_gain: f32,
}

const _: () = assert!(size_of::<Initialised>() <= size_of::<Controller>());
const _: () = assert!(align_of::<Initialised>() <= align_of::<Controller>());

/// The model of the parameter `model`, by the coefficients in `p` or by `table`.
fn model<'a>(
    p: &Parameters,
    table: impl FnOnce() -> Result<alula::Table<'a>, i32>,
) -> Result<Model<'a>, i32> {
    let number = p.controller.model as u32;
    if number == ALULA_MODEL_TABLE {
        return Ok(Model::Table(table()?));
    }
    let parameters = ModelParameters::numbered(number, &p.coefficients);
    let parameters = parameters.ok_or(refused(ParameterError::range(
        "model",
        Problem::OutOfRange,
        [0.0, ALULA_MODEL_TABLE as f32],
        "",
    )))?;
    parameters.model().map_err(refused)
}

impl<'a> Initialised<'a> {
    /// The controller of these parameters, each of which is in its range; `table` is called if the model is a table.
    fn new(
        p: &Parameters,
        table: impl FnOnce() -> Result<alula::Table<'a>, i32>,
    ) -> Result<Self, i32> {
        let model = model(p, table)?;
        Ok(Self {
            header: INITIALISED,
            guidance: Hardened::new(guidance(p, model).map_err(refused)?),
            memory: Memory::default(),
            inverse_thrust_max: 1.0 / p.vehicle.thrust_max,
            inverse_attitude_gain: 1.0 / p.controller.attitude_gain,
        })
    }
}

/// The guidance of these parameters.
fn guidance<'a>(
    p: &Parameters,
    model: Model<'a>,
) -> Result<Guidance<Model<'a>, GainChoice>, ParameterError> {
    let vehicle = Vehicle::new(p.vehicle, model)?;
    let gains = if p.controller.gains as u32 == ALULA_GAINS_CONSTANT {
        GainChoice::Constant(Gains::new(p.gains)?)
    } else {
        GainChoice::Bandwidth(BandwidthGains::new(&p.guidance, &vehicle)?)
    };
    Guidance::with_gains(vehicle, gains, &p.guidance)
}

/// The controller that C points to.
///
/// # Safety
/// `pointer` is null, unaligned, or points to a controller that nothing changes for `'a`; so does the table that it was
/// initialised with, if any.
#[inline(always)]
pub(crate) unsafe fn initialised<'a>(
    pointer: *const Controller,
) -> Result<&'a Initialised<'a>, i32> {
    boundary::check_pointer(pointer)?;
    // SAFETY: The pointer is neither null nor unaligned, so it points to a header word. INITIALISED is written by
    // `alula_init` alone, and only together with the rest of an `Initialised`.
    unsafe {
        match pointer.cast::<u32>().read() {
            INITIALISED => Ok(&*pointer.cast::<Initialised>()),
            Controller::HEADER => Err(code::ALULA_ERROR_NOT_INITIALISED),
            _ => Err(code::ALULA_ERROR_LAYOUT),
        }
    }
}

/// The controller that C points to, to be changed.
///
/// # Safety
/// As [`initialised`], and nothing else reads or changes the controller for `'a`.
#[inline(always)]
pub(crate) unsafe fn initialised_mut<'a>(
    pointer: *mut Controller,
) -> Result<&'a mut Initialised<'a>, i32> {
    // SAFETY: `initialised` has found an `Initialised` behind the pointer, and nothing else uses it.
    unsafe {
        initialised(pointer)?;
        Ok(&mut *pointer.cast::<Initialised>())
    }
}

/// Makes `controller` the one of `parameters`. If the model is `ALULA_MODEL_TABLE`, the controller keeps a pointer to
/// `table`. The table must stay where it is, and as it is, for as long as the controller or a copy of it is used. For
/// any other model `table` is not read and may be null. Returns `ALULA_OK`, or the code that names the first parameter
/// refused; the controller is then not initialised.
///
/// # Safety
/// Each pointer is null or points to memory of the caller's that holds at least the header word; the whole structure
/// if that is right. No other call uses the controller meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_init(
    controller: *mut Controller,
    parameters: *const Parameters,
    table: *const Table,
) -> i32 {
    // SAFETY: A pointer that passes its check points to the structure that its header word says, of that size, by the
    // condition above. The table's borrow ends with the last use of the controller, which the caller has promised to
    // keep within the table's life.
    unsafe {
        match initialised(controller) {
            Ok(_) | Err(code::ALULA_ERROR_NOT_INITIALISED) => {}
            Err(code) => return code,
        }
        controller.cast::<u32>().write(Controller::HEADER);
        let made = boundary::read(parameters).and_then(|parameters| {
            parameters.check()?;
            Initialised::new(parameters, || table::initialised(table))
        });
        match made {
            Ok(made) => {
                controller.cast::<Initialised>().write(made);
                code::ALULA_OK
            }
            Err(code) => code,
        }
    }
}

/// Forgets what past calls of `alula_guide` have left in the controller, as at power-on.
///
/// # Safety
/// As `alula_init`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_reset(controller: *mut Controller) -> i32 {
    // SAFETY: The controller is null, unaligned or the caller's own, and no other call uses it, by the condition above.
    match unsafe { initialised_mut(controller) } {
        Ok(controller) => {
            controller.memory = Memory::default();
            code::ALULA_OK
        }
        Err(code) => code,
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::parameters::LAST_MODEL;

    /// Every number that the range of `model` allows leads to a model of its own, and no other number does.
    #[test]
    fn every_model_can_be_chosen() {
        let mut p = Parameters {
            vehicle: alula::VehicleParameters::PAPER,
            ..Parameters::DEFAULT
        };
        let mut chosen = std::vec::Vec::new();
        for number in 0..=LAST_MODEL as u32 {
            p.controller.model = number as f32;
            match model(&p, || Err(-1)) {
                Ok(model) => chosen.push(core::mem::discriminant(&model)),
                // The table alone is asked for.
                Err(code) => assert_eq!((number, code), (ALULA_MODEL_TABLE, -1)),
            }
        }
        let distinct = |n: usize| !chosen[..n].contains(&chosen[n]);
        assert!((0..chosen.len()).all(distinct));
        assert_eq!(chosen.len(), LAST_MODEL as usize);
        p.controller.model = LAST_MODEL + 1.0;
        assert!(model(&p, || Err(-1)).is_err_and(|code| code != -1));
    }
}
