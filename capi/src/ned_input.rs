//! The input of a step in the axes of autopilots, north-east-down world and forward-right-down body, and its projection on
//! the vertical plane of its heading.

use core::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

use alula::control::{MAX_ACCELERATION, MAX_SPEED};
use alula::ned::{BodyAxes, Ned, Projection, Quaternion, VerticalPlane};
use alula::{Attitude, Inertial, Reference, State};

use crate::boundary::{self, Layout};
use crate::code;
use crate::plane::ALULA_FEED_FORWARD;

/// Body axes of a fixed wing: x along the nose, z to the belly. Hover is pitch 90°.
pub const ALULA_BODY_NOSE_FORWARD: u32 = 0;
/// Body axes of a multicopter: z along the tail, x to the belly. Hover is pitch 0, cruise is pitch −90°.
pub const ALULA_BODY_NOSE_UP: u32 = 1;

/// The attitude is given by `quaternion`.
pub const ALULA_ATTITUDE_QUATERNION: u32 = 0;
/// The attitude is given by `pitch`, without tilt and bank.
pub const ALULA_ATTITUDE_PITCH: u32 = 1;

/// Angles beyond this \[rad\] are refused: their sines would lose digits.
const MAX_ANGLE: f32 = 100.0;
/// Flag of an input: `position_error` is to be used.
pub const ALULA_POSITION: u32 = 1 << 1;
/// Flag of an input: `air` is the velocity relative to the air, and not the wind.
pub const ALULA_AIR_VELOCITY: u32 = 1 << 2;
/// Flag of an input: nothing is known of the air, and `air` is not read.
pub const ALULA_AIR_UNKNOWN: u32 = 1 << 3;

/// State and reference in north-east-down world and forward-right-down body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct NedInput {
    /// `ALULA_HEADER(alula_ned_input)`.
    pub header: u32,
    /// Sum of `ALULA_FEED_FORWARD`, `ALULA_POSITION` and one of `ALULA_AIR_VELOCITY` and `ALULA_AIR_UNKNOWN`, or 0.
    pub flags: u32,
    /// Which body axes `quaternion` and `pitch` are of: `ALULA_BODY_NOSE_FORWARD` or `ALULA_BODY_NOSE_UP`.
    pub body_axes: u32,
    /// `ALULA_ATTITUDE_QUATERNION` or `ALULA_ATTITUDE_PITCH`. The other field is not read.
    pub attitude: u32,
    /// Heading of the vertical plane in which to fly \[rad\], from north towards east.
    pub heading: f32,
    /// Pitch \[rad\] of the body axes' x above the horizon, over the whole turn.
    pub pitch: f32,
    /// Attitude quaternion (w, x, y, z), from body to world.
    pub quaternion: [f32; 4],
    /// Velocity over ground [m/s]: north, east, down.
    pub velocity: [f32; 3],
    /// Wind [m/s], the velocity of the air over ground: north, east, down. With `ALULA_AIR_VELOCITY`: velocity relative to
    /// the air.
    pub air: [f32; 3],
    /// Reference velocity over ground [m/s]: north, east, down.
    pub reference_velocity: [f32; 3],
    /// Derivative of the reference velocity [m/s²]: north, east, down.
    pub reference_acceleration: [f32; 3],
    /// With `ALULA_FEED_FORWARD`, for the pure law: derivative of the air velocity [m/s²]: north, east, down.
    pub air_acceleration: [f32; 3],
    /// With `ALULA_FEED_FORWARD`, for the pure law: derivative of the reference acceleration [m/s³]: north, east, down.
    pub reference_jerk: [f32; 3],
    /// With `ALULA_POSITION`, for `alula_guide`: position less reference position \[m\]: north, east, down.
    pub position_error: [f32; 3],
    /// For `alula_guide`: age of velocity and attitude \[s\].
    pub state_age: f32,
    /// For `alula_guide`: age of the reference \[s\].
    pub reference_age: f32,
}

impl NedInput {
    /// A hover in still air, heading north, whose reference is to stay. The attitude is pitch 90° of fixed-wing axes.
    pub const DEFAULT: Self = Self {
        header: Self::HEADER,
        flags: 0,
        body_axes: ALULA_BODY_NOSE_FORWARD,
        attitude: ALULA_ATTITUDE_QUATERNION,
        heading: 0.0,
        pitch: FRAC_PI_2,
        quaternion: [FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2, 0.0],
        velocity: [0.0; 3],
        air: [0.0; 3],
        reference_velocity: [0.0; 3],
        reference_acceleration: [0.0; 3],
        air_acceleration: [0.0; 3],
        reference_jerk: [0.0; 3],
        position_error: [0.0; 3],
        state_age: 0.0,
        reference_age: 0.0,
    };
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for NedInput {}

pub(crate) fn ned(v: [f32; 3]) -> Ned {
    Ned::new(v[0], v[1], v[2])
}

/// Whether `angle` \[rad\] is finite and not absurdly large.
pub(crate) fn in_range(angle: f32) -> bool {
    angle.abs() <= MAX_ANGLE
}

/// The vertical plane of a heading; of NaN if the heading is out of range, which makes every projection NaN.
pub(crate) fn plane_of(heading: f32) -> VerticalPlane {
    VerticalPlane::from_heading(if in_range(heading) { heading } else { f32::NAN })
}

/// An input's state and reference, projected on its vertical plane, and their components across it. What is not finite in
/// the input is NaN here.
pub(crate) struct PlanarInput {
    pub axes: BodyAxes,
    pub plane: VerticalPlane,
    pub projection: Projection,
    pub velocity: Inertial,
    pub air: Inertial,
    pub reference: Reference,
    pub lateral_velocity: f32,
    pub lateral_air: f32,
    pub lateral_reference_velocity: f32,
    pub lateral_reference_acceleration: f32,
}

impl PlanarInput {
    /// Projects `input`, whose body axes are `axes`, on `plane`. Numbers are not checked here.
    #[inline(always)]
    pub fn new(input: &NedInput, axes: BodyAxes, plane: VerticalPlane) -> Self {
        const NO_ATTITUDE: Projection = Projection::upright(Attitude {
            cos: f32::NAN,
            sin: f32::NAN,
        });
        let projection = match input.attitude {
            ALULA_ATTITUDE_QUATERNION => {
                let [w, x, y, z] = input.quaternion;
                plane
                    .attitude(&Quaternion { w, x, y, z }, axes)
                    .unwrap_or(NO_ATTITUDE)
            }
            _ if in_range(input.pitch) => Projection::upright(axes.attitude(input.pitch)),
            _ => NO_ATTITUDE,
        };
        let project = |v| plane.project(ned(v));
        let (velocity, lateral_velocity) = project(input.velocity);
        let (air, lateral_air) = project(input.air);
        let (reference_velocity, lateral_reference_velocity) = project(input.reference_velocity);
        let (acceleration, lateral_reference_acceleration) = project(input.reference_acceleration);
        Self {
            axes,
            plane,
            projection,
            velocity,
            air,
            reference: Reference {
                velocity: reference_velocity,
                acceleration,
            },
            lateral_velocity,
            lateral_air,
            lateral_reference_velocity,
            lateral_reference_acceleration,
        }
    }

    /// The state, if the wind is known.
    ///
    /// # Errors
    /// The codes of what the law cannot check itself, since it is not given it: the heading, components across the plane,
    /// and whether the wind is known.
    pub fn state(&self, input: &NedInput) -> Result<State, i32> {
        if !in_range(input.heading) {
            return Err(code::ALULA_ERROR_HEADING);
        }
        let (wind, lateral_wind) = match input.flags & AIR {
            0 => (self.air, self.lateral_air),
            ALULA_AIR_VELOCITY => (
                self.velocity - self.air,
                self.lateral_velocity - self.lateral_air,
            ),
            _ => return Err(code::ALULA_ERROR_WIND),
        };
        for (lateral, max, code) in [
            (self.lateral_velocity, MAX_SPEED, code::ALULA_ERROR_VELOCITY),
            (lateral_wind, MAX_SPEED, code::ALULA_ERROR_WIND),
            (
                self.lateral_reference_velocity,
                MAX_SPEED,
                code::ALULA_ERROR_REFERENCE_VELOCITY,
            ),
            (
                self.lateral_reference_acceleration,
                MAX_ACCELERATION,
                code::ALULA_ERROR_REFERENCE_ACCELERATION,
            ),
        ] {
            // NaN is not either.
            if !matches!(lateral.abs(), v if v <= max) {
                return Err(code);
            }
        }
        Ok(State {
            velocity: self.velocity,
            attitude: self.projection.attitude,
            wind,
        })
    }
}

/// Flags that say what `air` is.
pub(crate) const AIR: u32 = ALULA_AIR_VELOCITY | ALULA_AIR_UNKNOWN;

/// The body axes of an input.
///
/// # Errors
/// The code of a selector that has no such value, which may be another one than that of the axes.
#[inline(always)]
pub(crate) fn axes_of(input: &NedInput) -> Result<BodyAxes, i32> {
    const FLAGS: u32 = ALULA_FEED_FORWARD | ALULA_POSITION | AIR;
    let axes = match input.body_axes {
        ALULA_BODY_NOSE_FORWARD => BodyAxes::NoseForward,
        ALULA_BODY_NOSE_UP => BodyAxes::NoseUp,
        _ => return Err(code::ALULA_ERROR_SELECTOR),
    };
    if input.flags & !FLAGS != 0
        || input.flags & AIR == AIR
        || input.attitude > ALULA_ATTITUDE_PITCH
    {
        return Err(code::ALULA_ERROR_SELECTOR);
    }
    Ok(axes)
}

/// Fills in a hover in still air, heading north, whose reference is to stay.
///
/// # Safety
/// As `alula_input_default`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_ned_input_default(input: *mut NedInput) -> i32 {
    // SAFETY: `input` is as `write` asks for, by the condition above.
    unsafe { boundary::write(input, NedInput::DEFAULT) }
}
