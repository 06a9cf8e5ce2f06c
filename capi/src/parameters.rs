//! The parameters of a controller: the core's tables, and one of the C interface's own.
//!
//! The structures, their defaults and their ranges are the core's. The header's comments, `docs/parameters.md`, the texts of
//! refused parameters and the parameter file of PX4 are made from the same rows.

use core::ffi::CStr;

use alula::mission::MissionParameters;
use alula::planar::GainParameters;
use alula::{
    CombinedParameters, GuidanceParameters, ModelParameters, ParameterError, Parameters as _,
    Problem, Range, Row, VehicleParameters,
};

use crate::boundary::{self, Layout};
use crate::code;
use crate::decimal::Decimal;

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
            "Gain from attitude error to angular rate of the attitude loop that flies the attitude set-point. It is placed where that loop asks for the commanded rate.";
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

        /// What the texts are of: the fields of [`Parameters`] with their ranges, and missions.
        const NAMED: &[(&str, &[Range])] = &[
            $( (stringify!($field), $table::RANGES), )*
            (MISSION.field, MissionParameters::RANGES),
        ];
    };
}

tables! {
    /// Kind of gains, model, attitude loop.
    controller: ControllerParameters,
    /// The vehicle. Mass, k_a and thrust_max have no default and must be set.
    vehicle: VehicleParameters,
    /// Gains by bandwidth and everything that alula_guide adds. Forces are multiples of the weight.
    guidance: GuidanceParameters,
    /// For ALULA_GAINS_CONSTANT: by default the paper's, for its vehicle of 10 kg.
    gains: GainParameters,
    /// Of the aerodynamic models.
    coefficients: CombinedParameters,
}

/// The table of missions, which has a structure of its own.
pub const MISSION: Section = Section {
    field: "mission",
    about: "How missions are flown: parameters of alula_mission_setup.",
    structure: "MissionParameters",
    group: MissionParameters::GROUP,
    rows: MissionParameters::ROWS,
};

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

/// The number of the first parameter of missions: behind those of [`Parameters`], of which there are as many.
pub(crate) const MISSION_FIRST: usize = COUNT;
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

/// What a parameter must be that its range does not say, as the core's constructors ask for it.
const RELATIONS: &[(&str, &str)] = &[
    ("thrust_min", "below the weight, mass times gravity"),
    (
        "thrust_max",
        "above thrust_min, and above the weight, mass times gravity",
    ),
    (
        "safe_thrust",
        "such that it is from thrust_min to thrust_max",
    ),
    ("max_integral_down", "at most max_velocity_down"),
    ("max_integral_forward", "at most max_velocity_forward"),
    (
        "cruise_speed",
        "a speed of the wing, 1.15 times its stall speed and more, that the thrust reaches",
    ),
    ("k_l", "at most 40 over the square of alpha_bar"),
    ("k_d", "at most 40 over the square of alpha_bar"),
];

/// What is said of parameters without one.
const NO_RELATION: &str = "in agreement with the others";

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut n = 0;
    while n < a.len() && n < b.len() && a[n] == b[n] {
        n += 1;
    }
    n == a.len() && n == b.len()
}

const fn relation(name: &str) -> &'static str {
    let mut n = 0;
    while n < RELATIONS.len() {
        if same(RELATIONS[n].0, name) {
            return RELATIONS[n].1;
        }
        n += 1;
    }
    NO_RELATION
}

/// Copies `text` to `out` from `at` on, if `out` is long enough, and returns where it ends.
const fn append<const N: usize>(out: &mut [u8; N], at: usize, text: &[u8]) -> usize {
    let mut n = 0;
    while n < text.len() {
        if at + n < N {
            out[at + n] = text[n];
        }
        n += 1;
    }
    at + n
}

/// "vehicle.mass must be from 0.001 to 1000000 kg", and of thrust_max what it must be besides: for each parameter in order
/// both, each with a zero behind it; and the length of it all.
const fn texts<const N: usize>() -> ([u8; N], usize) {
    let (mut out, mut at) = ([0; N], 0);
    let mut table = 0;
    while table < NAMED.len() {
        let (field, ranges) = NAMED[table];
        let mut row = 0;
        while row < ranges.len() {
            let range = &ranges[row];
            let mut text = 0;
            while text < 2 {
                at = append(&mut out, at, field.as_bytes());
                at = append(&mut out, at, b".");
                at = append(&mut out, at, range.name.as_bytes());
                at = append(&mut out, at, b" must be ");
                if text == 0 {
                    at = append(&mut out, at, b"from ");
                    at = append(&mut out, at, Decimal::new(range.min).digits());
                    at = append(&mut out, at, b" to ");
                    at = append(&mut out, at, Decimal::new(range.max).digits());
                    at = append(&mut out, at, if range.unit.is_empty() { b"" } else { b" " });
                    at = append(&mut out, at, range.unit.as_bytes());
                } else {
                    at = append(&mut out, at, relation(range.name).as_bytes());
                }
                at += 1;
                text += 1;
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
    // A number that is not finite, not positive or out of range is told the range.
    let related = number % 4 == 3;
    let mut rest: &[u8] = &TEXTS;
    for _ in 0..2 * (number / 4) + usize::from(related) {
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
