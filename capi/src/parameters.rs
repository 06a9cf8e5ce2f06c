//! The parameters of a controller: the core's tables, and one of the C interface's own.
//!
//! The structures, their defaults and their ranges are the core's. The header's comments, `docs/parameters.md`, the texts of
//! refused parameters and the parameter file of PX4 are made from the same rows.

use core::ffi::CStr;

use alula::planar::GainParameters;
use alula::{
    CombinedParameters, GuidanceParameters, ModelParameters, ParameterError, Parameters as _,
    Problem, Range, Row, VehicleParameters,
};

use crate::boundary::{self, Layout};
use crate::code;

/// Gains that follow |F_p|, so that the loop keeps its bandwidth: the parameters of the guidance.
pub const ALULA_GAINS_BANDWIDTH: u32 = 0;
/// Constant gains, as in the paper. They oscillate on a vehicle whose rate loop or thrust lags.
pub const ALULA_GAINS_CONSTANT: u32 = 1;

/// Coefficients by the table that `alula_init` is given.
pub const ALULA_MODEL_TABLE: u32 = 3;

/// The greatest number of a model: those of [`ModelParameters::LIST`] and the table's.
pub(crate) const LAST_MODEL: f32 = ModelParameters::LIST.len() as f32;

alula::parameters! {
    /// What a controller is made of besides its vehicle, gains and coefficients.
    pub struct ControllerParameters, "Controller" {
        gains: "", 0.0, 1.0, 0.0, "ALU_GAINS",
            "How the gains are chosen.";
        model: "", 0.0, LAST_MODEL, 0.0, "ALU_MODEL",
            "Model of the aerodynamic coefficients.";
        attitude_gain: "1/s", 1e-2, 1e3, 6.5, "ALU_ATT_P",
            "Gain from attitude error to angular rate of the attitude loop that flies the attitude set-point: the set-point is placed where that loop asks for the commanded rate.";
    }
}

/// How many of the first parameters are choices: whole numbers from 0.
/// cbindgen:ignore
pub const CHOICES: usize = 2;

macro_rules! tables {
    ($( $(#[doc = $about:literal])* $field:ident: $table:ident, )*) => {
        /// Everything that a controller is made of. `alula_parameters_default` fills in the defaults.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(C)]
        pub struct Parameters {
            /// `ALULA_HEADER(alula_parameters)`.
            pub header: u32,
            $( $(#[doc = $about])* pub $field: $table, )*
        }

        impl Parameters {
            /// The defaults; NaN where there is none.
            pub const DEFAULT: Self = Self {
                header: Self::HEADER,
                $( $field: $table::DEFAULT, )*
            };
        }

        /// The tables in the order of the structure.
        pub const SECTIONS: &[Section] = &[$( Section {
            field: stringify!($field),
            about: concat!($( $about ),*),
            structure: stringify!($table),
            group: $table::GROUP,
            rows: $table::ROWS,
        }, )*];

        /// Their ranges, which are all that an image needs.
        const RANGES: &[&[Range]] = &[$( $table::RANGES, )*];

        /// Fields of [`Parameters`], for the texts.
        const FIELDS: &[&str] = &[$( stringify!($field), )*];
    };
}

tables! {
    /// Kind of gains, model, attitude loop.
    controller: ControllerParameters,
    /// The vehicle. Mass, k_a and thrust_max have no default and must be set.
    vehicle: VehicleParameters,
    /// Gains by bandwidth and everything that alula_guide adds. Forces are multiples of the weight.
    guidance: GuidanceParameters,
    /// For ALULA_GAINS_CONSTANT.
    gains: GainParameters,
    /// Of the aerodynamic models.
    coefficients: CombinedParameters,
}

/// One of the tables of parameters, for generators.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Its field of [`Parameters`].
    pub field: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Its structure in Rust.
    pub structure: &'static str,
    /// Heading.
    pub group: &'static str,
    /// Rows.
    pub rows: &'static [Row],
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for Parameters {}

/// How many parameters there are.
const COUNT: usize = {
    let (mut count, mut n) = (0, 0);
    while n < RANGES.len() {
        count += RANGES[n].len();
        n += 1;
    }
    count
};
const _: () = assert!(size_of::<Parameters>() == (1 + COUNT) * size_of::<u32>());

impl Parameters {
    /// Checks every parameter against its range.
    ///
    /// # Errors
    /// The code that names the first parameter refused.
    pub(crate) fn check(&self) -> Result<(), i32> {
        // SAFETY: `Parameters` is `repr(C)` and consists of a header of four bytes and COUNT numbers `f32`, by the
        // assertion on its size above. Any four bytes are an `f32`.
        let words: &[f32; 1 + COUNT] = unsafe { &*(&raw const *self).cast() };
        let [_, values @ ..] = words;
        for (index, value) in values.iter().enumerate() {
            let whole = *value == (*value as u32) as f32;
            let checked = match range(index).map_or(Ok(()), |range| range.check(*value)) {
                Ok(()) if index < CHOICES && !whole => Err(Problem::OutOfRange),
                checked => checked,
            };
            checked.map_err(|problem| code::of_parameter(index, problem))?;
        }
        Ok(())
    }
}

/// The range of the `index`th parameter. Out of line: compiled into a search, the five tables are searched by five pieces of code.
#[inline(never)]
fn range(mut index: usize) -> Option<&'static Range> {
    for table in RANGES {
        match table.get(index) {
            Some(range) => return Some(range),
            None => index -= table.len(),
        }
    }
    None
}

/// The code of a parameter that the core refuses because of others: each one's own range has been checked before. Out of line:
/// it is called for each constructor of the core.
#[cold]
#[inline(never)]
pub(crate) fn refused(error: ParameterError) -> i32 {
    let named = |index| range(index).is_some_and(|range| range.name == error.parameter);
    let index = (0..COUNT).find(|index| named(*index));
    code::of_parameter(index.unwrap_or(COUNT), error.problem)
}

/// What is said of a refused parameter, by the number of its [`Problem`] in the code.
const PROBLEMS: [&str; 4] = [
    "must be a finite number",
    "must be positive",
    "is out of range",
    "contradicts another parameter",
];

/// Copies `text` to `out` from `at` on, if `out` is long enough, and returns where it ends.
const fn append<const N: usize>(out: &mut [u8; N], at: usize, text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut n = 0;
    while n < bytes.len() {
        if at + n < N {
            out[at + n] = bytes[n];
        }
        n += 1;
    }
    at + n
}

/// "vehicle.mass must be positive" and so on, for each parameter and problem in order, each with a zero behind it; and the
/// length of it all.
const fn texts<const N: usize>() -> ([u8; N], usize) {
    let (mut out, mut at) = ([0; N], 0);
    let mut table = 0;
    while table < RANGES.len() {
        let mut row = 0;
        while row < RANGES[table].len() {
            let mut problem = 0;
            while problem < PROBLEMS.len() {
                at = append(&mut out, at, FIELDS[table]);
                at = append(&mut out, at, ".");
                at = append(&mut out, at, RANGES[table][row].name);
                at = append(&mut out, at, " ");
                at = append(&mut out, at, PROBLEMS[problem]);
                at += 1;
                problem += 1;
            }
            row += 1;
        }
        table += 1;
    }
    (out, at)
}

/// The texts. Only `alula_strerror` reads them: a program that does not call it is linked without.
static TEXTS: [u8; texts::<0>().1] = texts().0;

/// What the code `ALULA_ERROR_PARAMETER - number` means.
pub(crate) fn text(number: usize) -> Option<&'static CStr> {
    let mut rest: &[u8] = &TEXTS;
    for _ in 0..number {
        let text = CStr::from_bytes_until_nul(rest).ok()?;
        rest = rest.get(text.count_bytes() + 1..)?;
    }
    CStr::from_bytes_until_nul(rest).ok()
}

/// Fills in the default of every parameter. Those of the vehicle that have none, mass, k_a and thrust_max, become NaN, which
/// `alula_init` refuses: they must be set.
///
/// # Safety
/// `parameters` is null or points to memory of the caller's that holds at least the header word, already set; the whole
/// structure if that is right.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_parameters_default(parameters: *mut Parameters) -> i32 {
    // SAFETY: `parameters` is null or points to its header word, and to the whole structure if that is right, which is
    // what `write` asks for.
    unsafe { boundary::write(parameters, Parameters::DEFAULT) }
}
