//! The parameters: one table, of which the structure, its checks, the header's comments, `docs/parameters.md` and the
//! parameter file of PX4 are made.

use core::f32::consts::{FRAC_PI_2, PI};
use core::ffi::CStr;

use alula::{
    BandwidthParameters, CombinedParameters, GainParameters, ParameterError, Problem,
    VehicleParameters,
};

use crate::boundary::{self, Layout};
use crate::code;

/// The robust law: defined everywhere.
pub const ALULA_LAW_ROBUST: u32 = 0;
/// The full law: the paper's proof holds for it, and it is undefined at |F_p| = 0 and with F_p against the thrust.
pub const ALULA_LAW_FULL: u32 = 1;

/// Constant gains, as in the paper: k1, k2, k3.
pub const ALULA_GAINS_CONSTANT: u32 = 0;
/// Gains that follow |F_p|, so that the loop keeps its bandwidth: natural_frequency, damping, thrust_rate, force_floor.
pub const ALULA_GAINS_BANDWIDTH: u32 = 1;

/// Coefficients by the combined model: c0…c3, alpha_bar, k_l, k_d.
pub const ALULA_MODEL_COMBINED: u32 = 0;
/// Coefficients by the large-angle model: c0, c1.
pub const ALULA_MODEL_LARGE_ANGLE: u32 = 1;
/// Coefficients by the small-angle model: c0, c2, c3.
pub const ALULA_MODEL_SMALL_ANGLE: u32 = 2;
/// Coefficients by the table that `alula_init` is given.
pub const ALULA_MODEL_TABLE: u32 = 3;

/// What a parameter is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number.
    Number,
    /// One of these values, from 0.
    Choice(&'static [&'static str]),
}

/// What is known of a parameter.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Name of its field.
    pub name: &'static str,
    /// Name in PX4's parameter file, at most 16 characters.
    pub px4: &'static str,
    /// Heading it stands under.
    pub group: &'static str,
    /// Number or choice.
    pub kind: Kind,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Least value.
    pub min: f32,
    /// Greatest value.
    pub max: f32,
    /// Default.
    pub default: f32,
    /// Meaning.
    pub meaning: &'static str,
}

/// What the library itself keeps of the table: the rest is for generators, and takes no room in an image.
pub(crate) struct Range {
    name: &'static str,
    choice: bool,
    min: f32,
    max: f32,
    /// What is said of a value that is not finite, not positive, or out of range.
    pub texts: [&'static CStr; 3],
}

const fn text(bytes: &'static str) -> &'static CStr {
    match CStr::from_bytes_with_nul(bytes.as_bytes()) {
        Ok(text) => text,
        Err(_) => panic!("no NUL at the end"),
    }
}

macro_rules! parameters {
    ($(
        $group:literal: $(
            $name:ident: $type:ident $kind:expr, $px4:literal, $unit:literal,
            $min:expr, $max:expr, $default:expr, $meaning:literal;
        )*
    )*) => {
        /// Everything that a controller is made of. `alula_parameters_default` fills in the defaults.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(C)]
        pub struct Parameters {
            /// `ALULA_HEADER(alula_parameters)`.
            pub header: u32,
            $($( #[doc = $meaning] pub $name: $type, )*)*
        }

        impl Parameters {
            /// The defaults.
            pub const DEFAULT: Self = Self {
                header: Self::HEADER,
                $($( $name: $default as $type, )*)*
            };
        }

        /// The table.
        pub const PARAMETERS: &[Parameter] = &[$($( Parameter {
            name: stringify!($name),
            px4: $px4,
            group: $group,
            kind: $kind,
            unit: $unit,
            min: $min as f32,
            max: $max as f32,
            default: $default as f32,
            meaning: $meaning,
        }, )*)*];

        /// The ranges, in the table's order.
        pub(crate) const RANGES: &[Range] = &[$($( Range {
            name: stringify!($name),
            choice: matches!($kind, Choice(_)),
            min: $min as f32,
            max: $max as f32,
            texts: [
                text(concat!(stringify!($name), " must be a finite number\0")),
                text(concat!(stringify!($name), " must be positive\0")),
                text(concat!(stringify!($name), " is out of range\0")),
            ],
        }, )*)*];
    };
}

use Kind::{Choice, Number};

/// What the defaults are of: the paper's vehicle, section and gains.
const VEHICLE: VehicleParameters = VehicleParameters::PAPER;
const SECTION: CombinedParameters = CombinedParameters::NACA_0021_RE_160E3;
const GAINS: GainParameters = GainParameters::PAPER;
const BANDWIDTH: BandwidthParameters = BandwidthParameters::PAPER_VEHICLE;

parameters! {
    "Law":
        law: u32 Choice(&["robust (ALULA_LAW_ROBUST)", "full (ALULA_LAW_FULL)"]),
            "ALU_LAW", "", 0, 1, ALULA_LAW_ROBUST,
            "Law that alula_step and alula_step_ned fly. alula_guide flies the robust one.";
        gains: u32 Choice(&["constant (ALULA_GAINS_CONSTANT)", "by bandwidth (ALULA_GAINS_BANDWIDTH)"]),
            "ALU_GAINS", "", 0, 1, ALULA_GAINS_CONSTANT,
            "How the gains are chosen.";
        k1: f32 Number, "ALU_K1", "s/m", 1e-9, 1e6, GAINS.k1,
            "Constant gains: thrust per velocity error along the thrust line, relative to |F_p|.";
        k2: f32 Number, "ALU_K2", "rad/(N m)", 1e-9, 1e6, GAINS.k2,
            "Constant gains: angular rate per velocity error across the thrust line and per |F_p|.";
        k3: f32 Number, "ALU_K3", "rad/s", 1e-9, 1e6, GAINS.k3,
            "Constant gains: angular rate per misalignment of thrust and F_p.";
        tau: f32 Number, "ALU_TAU", "N", 1e-3, 1e6, GAINS.tau,
            "Force below which the guard acts.";
        natural_frequency: f32 Number, "ALU_BW_FREQ", "rad/s", 1e-3, 1e3, BANDWIDTH.natural_frequency,
            "Gains by bandwidth: natural frequency of the loop across the thrust line.";
        damping: f32 Number, "ALU_BW_DAMP", "", 1e-2, 1e2, BANDWIDTH.damping,
            "Gains by bandwidth: damping ratio of the loop across the thrust line.";
        thrust_rate: f32 Number, "ALU_BW_THR", "1/s", 1e-3, 1e3, BANDWIDTH.thrust_rate,
            "Gains by bandwidth: rate of the loop along the thrust line.";
        force_floor: f32 Number, "ALU_BW_FLOOR", "N", 1e-3, 1e6, BANDWIDTH.force_floor,
            "Gains by bandwidth: |F_p| below which the gains grow no further.";
    "Vehicle":
        mass: f32 Number, "ALU_MASS", "kg", 1e-3, 1e6, VEHICLE.mass,
            "Mass.";
        k_a: f32 Number, "ALU_KA", "kg/m", 1e-9, 1e4, VEHICLE.k_a,
            "Aerodynamic constant: half the air density times the reference area.";
        delta: f32 Number, "ALU_DELTA", "rad", -PI, PI, VEHICLE.delta,
            "Angle from the zero-lift line to the thrust line.";
        gravity: f32 Number, "ALU_GRAVITY", "m/s^2", 1e-3, 1e3, VEHICLE.gravity,
            "Gravity.";
        attitude_gain: f32 Number, "ALU_ATT_P", "1/s", 1e-2, 1e3, 6.5,
            "Gain from attitude error to angular rate of the attitude loop that flies the attitude set-point: the \
             set-point is placed where that loop asks for the commanded rate.";
    "Limits":
        thrust_min: f32 Number, "ALU_THR_MIN", "N", -1e6, 1e6, 0.0,
            "Least thrust that alula_guide commands.";
        thrust_max: f32 Number, "ALU_THR_MAX", "N", 1e-3, 1e6, 196.2,
            "Greatest thrust that alula_guide commands, and what a normalised thrust of 1 stands for; above thrust_min.";
        rate_max: f32 Number, "ALU_RATE_MAX", "rad/s", 1e-3, 1e3, 2.8,
            "Greatest angular rate that alula_guide commands.";
        slew_max: f32 Number, "ALU_SLEW_MAX", "rad/s^2", 1e-3, 1e6, 30.0,
            "Greatest change of the angular rate that alula_guide commands.";
        reference_acceleration_max: f32 Number, "ALU_REF_ACC", "m/s^2", 1e-3, 1e3, 3.0,
            "Greatest acceleration with which alula_guide follows the reference velocity.";
        reference_rate: f32 Number, "ALU_REF_RATE", "1/s", 1e-3, 1e2, 0.8,
            "Rate with which the velocity followed returns to the reference velocity after that limit.";
    "Outer loop":
        position_gain_down: f32 Number, "ALU_POS_P_D", "1/s", 0.0, 100.0, 0.8,
            "Velocity per position error, down. Zero turns the hold off.";
        position_gain_forward: f32 Number, "ALU_POS_P_F", "1/s", 0.0, 100.0, 0.6,
            "Velocity per position error, forward. Zero turns the hold off.";
        pull_down: f32 Number, "ALU_POS_V_D", "m/s", 0.0, 1e3, 3.0,
            "Greatest velocity towards the reference position, down.";
        pull_forward: f32 Number, "ALU_POS_V_F", "m/s", 0.0, 1e3, 6.0,
            "Greatest velocity towards the reference position, forward.";
        integral_gain_down: f32 Number, "ALU_INT_D", "1/s", 0.0, 100.0, 0.3,
            "Growth of the integral per velocity of the pull, down. Zero turns it off.";
        integral_gain_forward: f32 Number, "ALU_INT_F", "1/s", 0.0, 100.0, 0.1,
            "Growth of the integral per velocity of the pull, forward. Zero turns it off.";
        integral_down: f32 Number, "ALU_INT_MAX_D", "m/s", 0.0, 1e3, 2.0,
            "Greatest integral, down.";
        integral_forward: f32 Number, "ALU_INT_MAX_F", "m/s", 0.0, 1e3, 1.0,
            "Greatest integral, forward.";
        forward_error: f32 Number, "ALU_ERR_MAX_F", "m/s", 1e-3, 1e3, 14.0,
            "Greatest forward velocity error that the law is given. About two thirds of the cruise speed.";
    "Branch":
        branch_switch: u32 Choice(&["report only", "switch"]),
            "ALU_BRANCH", "", 0, 1, 1,
            "Whether alula_guide flies tail first where flying nose first needs negative thrust.";
        branch_hysteresis: f32 Number, "ALU_BRANCH_HYST", "N", 1e-3, 1e6, 10.0,
            "How far F_p must have passed through zero before the branch is left.";
        branch_fade: f32 Number, "ALU_BRANCH_FADE", "s", 1e-3, 1e2, 0.3,
            "Time constant with which the jump of the angular rate at a switch fades out.";
    "Supervision":
        hold: f32 Number, "ALU_SUP_HOLD", "s", 0.0, 1e6, 0.1,
            "How long bad frames are bridged by the last command.";
        recovery: f32 Number, "ALU_SUP_RECOVER", "s", 0.0, 1e6, 0.05,
            "How long frames must be good before the safe command is left.";
        state_age: f32 Number, "ALU_SUP_STATE", "s", 0.0, 1e6, 0.05,
            "Age beyond which a state is refused.";
        reference_age: f32 Number, "ALU_SUP_REF", "s", 0.0, 1e6, 0.5,
            "Age beyond which a reference is no longer followed.";
        air_hold: f32 Number, "ALU_SUP_AIR", "s", 0.0, 1e6, 1.0,
            "How long the last known wind stands in for missing air data.";
        safe_thrust: f32 Number, "ALU_SUP_THRUST", "N", -1e6, 1e6, 0.0,
            "Thrust of alula_guide's safe command.";
    "Coefficients":
        model: u32 Choice(&[
                "combined (ALULA_MODEL_COMBINED)",
                "large-angle (ALULA_MODEL_LARGE_ANGLE)",
                "small-angle (ALULA_MODEL_SMALL_ANGLE)",
                "table (ALULA_MODEL_TABLE)",
            ]),
            "ALU_MODEL", "", 0, 3, ALULA_MODEL_COMBINED,
            "Model of the aerodynamic coefficients.";
        c0: f32 Number, "ALU_C0", "", 1e-6, 1e3, SECTION.c0,
            "Drag coefficient at zero angle of attack. Every model.";
        c1: f32 Number, "ALU_C1", "", 1e-6, 1e3, SECTION.c1,
            "Largest lift coefficient beyond stall. Combined and large-angle model.";
        c2: f32 Number, "ALU_C2", "1/rad", 1e-6, 1e3, SECTION.c2,
            "Lift slope at zero angle of attack. Combined and small-angle model.";
        c3: f32 Number, "ALU_C3", "1/rad^2", 1e-6, 1e3, SECTION.c3,
            "Growth of drag with the squared angle of attack, at zero. Combined and small-angle model.";
        alpha_bar: f32 Number, "ALU_ALPHA_BAR", "rad", 1e-3, FRAC_PI_2,
            SECTION.alpha_bar,
            "Stall angle. Combined model.";
        k_l: f32 Number, "ALU_KL", "1/rad^2", 1e-6, 1e4, SECTION.k_l,
            "Sharpness of lift's stall; times alpha_bar squared at most 40. Combined model.";
        k_d: f32 Number, "ALU_KD", "1/rad^2", 1e-6, 1e4, SECTION.k_d,
            "Sharpness of drag's stall; times alpha_bar squared at most 40. Combined model.";
}

// SAFETY: `repr(C)`, header first, numbers only.
unsafe impl Layout for Parameters {}

/// Words of a [`Parameters`]: its header, and one for each parameter in the table's order.
const WORDS: usize = 1 + RANGES.len();
const _: () = assert!(size_of::<Parameters>() == WORDS * size_of::<u32>());

impl Parameters {
    /// Checks every parameter against the table.
    ///
    /// # Errors
    /// The code that names the first parameter refused.
    pub(crate) fn check(&self) -> Result<(), i32> {
        // SAFETY: the size is asserted above, and any four bytes are a word.
        let words: &[u32; WORDS] = unsafe { &*(&raw const *self).cast() };
        let [_, words @ ..] = words;
        for (index, (range, word)) in RANGES.iter().zip(words).enumerate() {
            let value = if range.choice {
                *word as f32
            } else {
                f32::from_bits(*word)
            };
            range
                .check(value)
                .map_err(|problem| code::of_parameter(index, problem))?;
        }
        Ok(())
    }
}

impl Range {
    /// Checks a value of this parameter, whatever the others are.
    fn check(&self, value: f32) -> Result<(), Problem> {
        if !value.is_finite() {
            Err(Problem::NotFinite)
        } else if value <= 0.0 && self.min > 0.0 {
            Err(Problem::NotPositive)
        } else if value < self.min || value > self.max {
            Err(Problem::OutOfRange)
        } else {
            Ok(())
        }
    }
}

/// The code of a refusal by the core: what the table cannot tell, for it depends on other parameters too.
pub(crate) fn refused(error: ParameterError) -> i32 {
    let index = RANGES.iter().position(|p| p.name == error.parameter);
    code::of_parameter(index.unwrap_or(RANGES.len()), error.problem)
}

/// Fills in the default of every parameter: the paper's vehicle, coefficients and gains.
///
/// # Safety
/// `parameters` is null or points to memory of the caller's that holds at least the header word, already set; the whole
/// structure if that is right.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_parameters_default(parameters: *mut Parameters) -> i32 {
    // SAFETY: the caller's word.
    unsafe { boundary::write(parameters, Parameters::DEFAULT) }
}
