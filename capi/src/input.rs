//! The input of a step, in the axes of autopilots: north-east-down world and forward-right-down body.

use core::f32::consts::FRAC_1_SQRT_2;

use alula::Fault;
use alula::guidance::Air;
use alula::ned::{BodyAxes, Quaternion};
use alula::spatial::{Correction, FeedForward, Heading, Ned, Orientation, Reference, State};

use crate::boundary::{self, Layout};
use crate::code;

/// Body axes of a fixed wing: x along the nose, z to the belly. Hover is pitch 90°.
pub const ALULA_BODY_NOSE_FORWARD: u32 = 0;
/// Body axes of a multicopter: z along the tail, x to the belly. Hover is pitch 0, cruise is pitch −90°.
pub const ALULA_BODY_NOSE_UP: u32 = 1;

/// Flag of an input, for `alula_step`: `air_acceleration` and `reference_jerk` are to be used.
pub const ALULA_FEED_FORWARD: u32 = 1;
/// Flag of an input, for `alula_guide`: `position_error` is to be used.
pub const ALULA_POSITION: u32 = 1 << 1;
/// Flag of an input: `air` is the velocity relative to the air, and not the wind.
pub const ALULA_AIR_VELOCITY: u32 = 1 << 2;
/// Flag of an input: nothing is known of the air, and `air` is not read. `alula_step` needs to know.
pub const ALULA_AIR_UNKNOWN: u32 = 1 << 3;
/// Flag of an input, for `alula_guide`: `specific_force` is to be used.
pub const ALULA_SPECIFIC_FORCE: u32 = 1 << 4;
/// Flag of an input, for `alula_guide`: the nose stays short of the vertical while the vehicle flies forward.
pub const ALULA_NOSE_BELOW_VERTICAL: u32 = 1 << 5;
/// Flag of an input, for `alula_guide`: the place does not matter, as in a stop; `position_error` to the north and east is that
/// of a reference that goes along with the vehicle.
pub const ALULA_HOLD_ALTITUDE_ONLY: u32 = 1 << 6;

/// Flag of an input: `air` is the wind, and `airspeed` is to be used; `alula_step` uses the wind alone.
pub const ALULA_AIR_PITOT: u32 = 1 << 7;

/// State and reference in north-east-down world and forward-right-down body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Input {
    /// `ALULA_HEADER(alula_input)`.
    pub header: u32,
    /// Sum of `ALULA_FEED_FORWARD`, `ALULA_POSITION`, `ALULA_SPECIFIC_FORCE`, `ALULA_NOSE_BELOW_VERTICAL`, `ALULA_HOLD_ALTITUDE_ONLY` and
    /// one of `ALULA_AIR_VELOCITY`, `ALULA_AIR_UNKNOWN` and `ALULA_AIR_PITOT`, or 0.
    pub flags: u32,
    /// Body axes of this input and of its command: `ALULA_BODY_NOSE_FORWARD` or `ALULA_BODY_NOSE_UP`.
    pub body_axes: u32,
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
    /// Where the belly is to point while there is little air velocity \[rad\], from north towards east: in hover, the heading
    /// of multicopter axes. NaN: free, which leaves it to the course. The faster the flight, the less it counts.
    pub heading: f32,
    /// With `ALULA_POSITION`, for `alula_guide`: position less reference position \[m\]: north, east, down.
    pub position_error: [f32; 3],
    /// With `ALULA_SPECIFIC_FORCE`, for `alula_guide`: what an accelerometer measures [m/s²], acceleration less gravity:
    /// forward, right, down, in the body axes. In hover it is 9.81 towards the nose.
    pub specific_force: [f32; 3],
    /// With `ALULA_FEED_FORWARD`, for `alula_step`: derivative of the air velocity [m/s²]: north, east, down.
    pub air_acceleration: [f32; 3],
    /// With `ALULA_FEED_FORWARD`, for `alula_step`: derivative of the reference acceleration [m/s³]: north, east, down.
    pub reference_jerk: [f32; 3],
    /// For `alula_guide`: age of velocity and attitude \[s\].
    pub state_age: f32,
    /// For `alula_guide`: age of the reference \[s\].
    pub reference_age: f32,
    /// For `alula_guide`: altitude error \[m\] that a plan may cost as much as an error of one velocity band, in place of the
    /// parameter `altitude_band`. Outside 0.001 to 1000, as 0 is: the parameter's.
    pub altitude_band: f32,
    /// With `ALULA_AIR_PITOT`, for `alula_guide`: airspeed along the nose [m/s]. NaN: the tube tells nothing now.
    pub airspeed: f32,
}

impl Input {
    /// A hover in still air whose reference is to stay, heading free. The attitude is nose up, belly to the north, in
    /// fixed-wing axes.
    pub const DEFAULT: Self = Self {
        header: Self::HEADER,
        flags: 0,
        body_axes: ALULA_BODY_NOSE_FORWARD,
        quaternion: [FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2, 0.0],
        velocity: [0.0; 3],
        air: [0.0; 3],
        reference_velocity: [0.0; 3],
        reference_acceleration: [0.0; 3],
        heading: f32::NAN,
        position_error: [0.0; 3],
        specific_force: [0.0; 3],
        air_acceleration: [0.0; 3],
        reference_jerk: [0.0; 3],
        state_age: 0.0,
        reference_age: 0.0,
        altitude_band: 0.0,
        airspeed: f32::NAN,
    };

    /// The body axes.
    ///
    /// # Errors
    /// The code of a selector that has no such value, which may be the flags.
    #[inline(always)]
    pub(crate) fn axes(&self) -> Result<BodyAxes, i32> {
        const FLAGS: u32 =
            ALULA_FEED_FORWARD | ALULA_POSITION | ALULA_SPECIFIC_FORCE | PLANNER_OPTIONS | AIR;
        if self.flags & !FLAGS != 0 || (self.flags & AIR).count_ones() > 1 {
            return Err(code::ALULA_ERROR_SELECTOR);
        }
        match self.body_axes {
            ALULA_BODY_NOSE_FORWARD => Ok(BodyAxes::NoseForward),
            ALULA_BODY_NOSE_UP => Ok(BodyAxes::NoseUp),
            _ => Err(code::ALULA_ERROR_SELECTOR),
        }
    }

    pub(crate) fn quaternion(&self) -> Quaternion {
        let [w, x, y, z] = self.quaternion;
        Quaternion { w, x, y, z }
    }

    /// What is known of the air.
    #[inline(always)]
    pub(crate) fn air(&self) -> Air {
        match self.flags & AIR {
            0 => Air::Wind(ned(self.air)),
            ALULA_AIR_VELOCITY => Air::Velocity(ned(self.air)),
            ALULA_AIR_PITOT => Air::Pitot {
                airspeed: self.airspeed,
                wind: ned(self.air),
            },
            _ => Air::Unknown,
        }
    }

    #[inline(always)]
    pub(crate) fn reference(&self) -> Reference {
        Reference {
            velocity: ned(self.reference_velocity),
            acceleration: ned(self.reference_acceleration),
            heading: Heading::from_angle(self.heading),
        }
    }

    /// The state, for what cannot do without the wind.
    ///
    /// # Errors
    /// The codes of an attitude that is none and of an unknown wind; other numbers are not checked.
    #[inline(always)]
    pub(crate) fn state(&self, axes: BodyAxes) -> Result<State, i32> {
        let velocity = ned(self.velocity);
        Ok(State {
            velocity,
            orientation: Orientation::from_quaternion(&self.quaternion(), axes)
                .map_err(|_: Fault| code::ALULA_ERROR_ATTITUDE)?,
            wind: self.air().wind(velocity).ok_or(code::ALULA_ERROR_WIND)?,
            correction: Correction::default(),
        })
    }

    pub(crate) fn feed_forward(&self) -> Option<FeedForward> {
        (self.flags & ALULA_FEED_FORWARD != 0).then(|| FeedForward {
            air_acceleration: ned(self.air_acceleration),
            jerk: ned(self.reference_jerk),
        })
    }
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for Input {}

/// Flags that say what `air` is.
const AIR: u32 = ALULA_AIR_VELOCITY | ALULA_AIR_UNKNOWN | ALULA_AIR_PITOT;
/// Flags of the planner options.
pub(crate) const PLANNER_OPTIONS: u32 = ALULA_NOSE_BELOW_VERTICAL | ALULA_HOLD_ALTITUDE_ONLY;

#[inline(always)]
pub(crate) const fn ned([north, east, down]: [f32; 3]) -> Ned {
    Ned::new(north, east, down)
}

/// Fills in a hover in still air whose reference is to stay, heading free.
///
/// # Safety
/// `input` is null or points to memory of the caller's that holds at least the header word, already set; the whole
/// structure if that is right.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_input_default(input: *mut Input) -> i32 {
    // SAFETY: `input` is as `write` asks for, by the condition above.
    unsafe { boundary::write(input, Input::DEFAULT) }
}
