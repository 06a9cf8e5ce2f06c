//! The controller: what a vehicle's parameters become, in memory of the caller's.

use alula::control::{
    BranchParameters, BranchSwitch, GainChoice, LimitParameters, Limits, OuterLoop,
    OuterLoopParameters, ReferenceLimit, ReferenceLimitParameters, SupervisionParameters,
    Supervisor,
};
use alula::{
    BandwidthGains, BandwidthParameters, Combined, CombinedParameters, GainParameters, Gains,
    Guidance, GuidanceState, Inertial, LargeAngle, LargeAngleParameters, Model, ParameterError,
    SmallAngle, SmallAngleParameters, Vehicle, VehicleParameters, VelocityControl,
};

use crate::boundary::{self, Layout};
use crate::code;
use crate::parameters::{
    ALULA_GAINS_CONSTANT, ALULA_LAW_ROBUST, ALULA_MODEL_COMBINED, ALULA_MODEL_LARGE_ANGLE,
    ALULA_MODEL_SMALL_ANGLE, Parameters, refused,
};
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
    pub opaque: [u64; 63],
}

// SAFETY: `repr(C)`, header first, numbers only.
unsafe impl Layout for Controller {}

/// The header word of a controller that flies the robust law: of a size that no structure has.
pub(crate) const PLAIN: u32 = Controller::HEADER + 1;
/// The header word of one that flies another.
const OTHER: u32 = Controller::HEADER + 2;

/// What lies in a [`Controller`] that is initialised.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Ready {
    header: u32,
    pub guidance: Guidance<Model, GainChoice>,
    pub state: GuidanceState,
    /// One over the thrust of normalised thrust 1 [1/N].
    pub inverse_thrust_max: f32,
    /// One over the attitude loop's gain \[s\].
    pub inverse_attitude_gain: f32,
}

const _: () = assert!(size_of::<Ready>() <= size_of::<Controller>());
const _: () = assert!(align_of::<Ready>() <= align_of::<Controller>());

impl Ready {
    /// Whether the law is the robust one.
    pub fn is_robust(&self) -> bool {
        self.header == PLAIN
    }

    /// The controller of these parameters, each of which is in its range; `table` is needed by its model only.
    fn new(p: &Parameters, table: impl FnOnce() -> Result<alula::Table, i32>) -> Result<Self, i32> {
        let model = match p.model {
            ALULA_MODEL_COMBINED => Model::Combined(
                Combined::new(CombinedParameters {
                    c0: p.c0,
                    c1: p.c1,
                    c2: p.c2,
                    c3: p.c3,
                    alpha_bar: p.alpha_bar,
                    k_l: p.k_l,
                    k_d: p.k_d,
                })
                .map_err(refused)?,
            ),
            ALULA_MODEL_LARGE_ANGLE => Model::LargeAngle(
                LargeAngle::new(LargeAngleParameters { c0: p.c0, c1: p.c1 }).map_err(refused)?,
            ),
            ALULA_MODEL_SMALL_ANGLE => Model::SmallAngle(
                SmallAngle::new(SmallAngleParameters {
                    c0: p.c0,
                    c2: p.c2,
                    c3: p.c3,
                })
                .map_err(refused)?,
            ),
            _ => Model::Table(table()?),
        };
        Ok(Self {
            header: if p.law == ALULA_LAW_ROBUST {
                PLAIN
            } else {
                OTHER
            },
            guidance: guidance(p, model).map_err(refused)?,
            state: GuidanceState::default(),
            inverse_thrust_max: 1.0 / p.thrust_max,
            inverse_attitude_gain: 1.0 / p.attitude_gain,
        })
    }
}

/// The guidance of these parameters.
fn guidance(p: &Parameters, model: Model) -> Result<Guidance<Model, GainChoice>, ParameterError> {
    let vehicle = Vehicle::new(
        VehicleParameters {
            mass: p.mass,
            k_a: p.k_a,
            delta: p.delta,
            gravity: p.gravity,
        },
        model,
    )?;
    let gains = if p.gains == ALULA_GAINS_CONSTANT {
        GainChoice::Constant(Gains::new(GainParameters {
            k1: p.k1,
            k2: p.k2,
            k3: p.k3,
            tau: p.tau,
        })?)
    } else {
        GainChoice::Bandwidth(BandwidthGains::new(
            BandwidthParameters {
                natural_frequency: p.natural_frequency,
                damping: p.damping,
                thrust_rate: p.thrust_rate,
                force_floor: p.force_floor,
                tau: p.tau,
            },
            &vehicle,
        )?)
    };
    Ok(Guidance {
        control: VelocityControl::new(vehicle, gains),
        reference_limit: ReferenceLimit::new(ReferenceLimitParameters {
            acceleration: p.reference_acceleration_max,
            rate: p.reference_rate,
        })?,
        outer_loop: OuterLoop::new(OuterLoopParameters {
            position_gain: Inertial::new(p.position_gain_down, p.position_gain_forward),
            pull: Inertial::new(p.pull_down, p.pull_forward),
            integral_gain: Inertial::new(p.integral_gain_down, p.integral_gain_forward),
            integral: Inertial::new(p.integral_down, p.integral_forward),
            forward_error: p.forward_error,
        })?,
        branch: BranchSwitch::new(BranchParameters {
            switch: p.branch_switch != 0,
            hysteresis: p.branch_hysteresis,
            fade: p.branch_fade,
        })?,
        limits: Limits::new(LimitParameters {
            thrust_min: p.thrust_min,
            thrust_max: p.thrust_max,
            rate: p.rate_max,
            slew: p.slew_max,
        })?,
        supervisor: Supervisor::new(SupervisionParameters {
            hold: p.hold,
            recovery: p.recovery,
            state_age: p.state_age,
            reference_age: p.reference_age,
            air_hold: p.air_hold,
            safe_thrust: p.safe_thrust,
        })?,
    })
}

/// The controller that C points to.
///
/// # Safety
/// `pointer` is null, unaligned or points to a controller of the caller's that no other call changes meanwhile.
#[inline(always)]
pub(crate) unsafe fn ready<'a>(pointer: *const Controller) -> Result<&'a Ready, i32> {
    boundary::check_pointer(pointer)?;
    // SAFETY: a header is there; PLAIN and OTHER are only ever written together with the rest.
    unsafe {
        match pointer.cast::<u32>().read() {
            PLAIN | OTHER => Ok(&*pointer.cast::<Ready>()),
            Controller::HEADER => Err(code::ALULA_ERROR_NOT_INITIALISED),
            _ => Err(code::ALULA_ERROR_LAYOUT),
        }
    }
}

/// The controller that C points to, to be changed.
///
/// # Safety
/// As [`ready`], and no other call reads it meanwhile either.
#[inline(always)]
pub(crate) unsafe fn ready_mut<'a>(pointer: *mut Controller) -> Result<&'a mut Ready, i32> {
    // SAFETY: the caller's word.
    unsafe {
        ready(pointer)?;
        Ok(&mut *pointer.cast::<Ready>())
    }
}

/// Makes `controller` the one of `parameters`. `table` is read if the model is `ALULA_MODEL_TABLE`, and must then last
/// as long as the controller does; otherwise it may be null. Returns `ALULA_OK`, or the code that names the first
/// parameter refused; the controller is then not initialised.
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
    // SAFETY: the caller's word.
    unsafe {
        match ready(controller) {
            Ok(_) | Err(code::ALULA_ERROR_NOT_INITIALISED) => {}
            Err(code) => return code,
        }
        controller.cast::<u32>().write(Controller::HEADER);
        let made = boundary::read(parameters).and_then(|parameters| {
            parameters.check()?;
            Ready::new(parameters, || table::ready(table))
        });
        match made {
            Ok(ready) => {
                controller.cast::<Ready>().write(ready);
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
    // SAFETY: the caller's word.
    match unsafe { ready_mut(controller) } {
        Ok(ready) => {
            ready.state = GuidanceState::default();
            code::ALULA_OK
        }
        Err(code) => code,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{Kind, PARAMETERS};

    /// The parameters with the `n`th at `value`.
    fn with(n: usize, value: f32) -> Parameters {
        let mut p = Parameters {
            // Room for every other limit.
            thrust_min: -1e6,
            k_l: 1e-6,
            k_d: 1e-6,
            ..Parameters::DEFAULT
        };
        // SAFETY: a word within the structure, of any bits.
        unsafe { (&raw mut p).cast::<f32>().add(1 + n).write(value) };
        p
    }

    /// Whether the core takes these parameters, whatever the table says.
    fn core_takes(p: &Parameters) -> bool {
        let constant = Ready::new(p, || Err(0));
        let bandwidth = Ready::new(&Parameters { gains: 1, ..*p }, || Err(0));
        let small = Ready::new(&Parameters { model: 2, ..*p }, || Err(0));
        constant.is_ok() && bandwidth.is_ok() && small.is_ok()
    }

    /// The table's ranges are the core's: what is in range is taken, what is just outside is refused.
    #[test]
    fn the_tables_ranges_are_those_of_the_core() {
        // Ranges of this crate's own, where the core has none or a wider one.
        let own = |name, low| name == "attitude_gain" || (name == "thrust_max" && low);
        for (n, p) in PARAMETERS.iter().enumerate() {
            if p.kind != Kind::Number {
                continue;
            }
            assert!(core_takes(&with(n, p.min)), "{} at its least", p.name);
            // The greatest sharpness and stall angle exclude each other; each has its greatest in turn.
            if p.name != "k_l" && p.name != "k_d" && p.name != "thrust_min" {
                assert!(core_takes(&with(n, p.max)), "{} at its greatest", p.name);
            }
            let (below, above) = (p.min.next_down(), p.max.next_up());
            if !own(p.name, true) {
                assert!(!core_takes(&with(n, below)), "{} below", p.name);
            }
            if !own(p.name, false) {
                assert!(!core_takes(&with(n, above)), "{} above", p.name);
            }
            assert!(with(n, below).check().is_err() && with(n, above).check().is_err());
            assert!(with(n, p.min).check().is_ok() && with(n, p.max).check().is_ok());
        }
    }
}
