//! The step in the axes of the paper: a vertical plane, (down, forward).

use core::mem::offset_of;

use alula::control::Law;
use alula::guidance::{MAX_STEP, MIN_STEP};
use alula::{Attitude, FeedForward, Inertial, Reference, State};

use crate::boundary::{self, Layout};
use crate::code;
use crate::controller::{Controller, Initialised, ROBUST, initialised};

/// Flag of an input: `air_acceleration` and `reference_jerk` are to be used.
pub const ALULA_FEED_FORWARD: u32 = 1;

/// State and reference in a vertical plane, by components (down, forward).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Input {
    /// `ALULA_HEADER(alula_input)`.
    pub header: u32,
    /// 0 or `ALULA_FEED_FORWARD`.
    pub flags: u32,
    /// Velocity over ground [m/s]: down, forward.
    pub velocity: [f32; 2],
    /// Attitude: cos θ, sin θ. θ = 0 is nose up; θ = −90° is nose forward; positive rates raise a forward nose.
    pub attitude: [f32; 2],
    /// Wind over ground [m/s]: down, forward.
    pub wind: [f32; 2],
    /// Reference velocity over ground [m/s]: down, forward.
    pub reference_velocity: [f32; 2],
    /// Derivative of the reference velocity [m/s²]: down, forward.
    pub reference_acceleration: [f32; 2],
    /// With `ALULA_FEED_FORWARD`: derivative of the air velocity [m/s²]: down, forward.
    pub air_acceleration: [f32; 2],
    /// With `ALULA_FEED_FORWARD`: derivative of the reference acceleration [m/s³]: down, forward.
    pub reference_jerk: [f32; 2],
}

/// Command of one step, and the quantities that it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Command {
    /// `ALULA_HEADER(alula_command)`.
    pub header: u32,
    /// 0, or `ALULA_STATUS_SAFE`.
    pub status: u32,
    /// Thrust along the nose \[N\], as the law asks for it: it may be negative, or above `thrust_max`.
    pub thrust: f32,
    /// Angular rate θ̇ [rad/s]: pitch rate, positive nose up.
    pub rate: f32,
    /// Angle of attack \[rad\], in [−π, π].
    pub alpha: f32,
    /// Apparent external force F_p \[N\] along the tail and across it. Its angle from the tail, atan2(f_p\[1\],
    /// f_p\[0\]), is the angle by which the attitude still has to turn.
    pub f_p: [f32; 2],
    /// |F_p| \[N\]: how far the law is from losing its equilibrium.
    pub f_p_norm: f32,
    /// Thrust of the equivalent sphere \[N\].
    pub t_p: f32,
    /// Weight of the alignment term, 0 to 1.
    pub guard_alignment: f32,
    /// Weight of the feed-forward, 0 to 1.
    pub guard_feed_forward: f32,
    /// Gain k of the full law; 1 in the robust law.
    pub k: f32,
}

impl Input {
    /// A hover in still air whose reference is to stay.
    pub const DEFAULT: Self = Self {
        header: Self::HEADER,
        flags: 0,
        velocity: [0.0; 2],
        attitude: [1.0, 0.0],
        wind: [0.0; 2],
        reference_velocity: [0.0; 2],
        reference_acceleration: [0.0; 2],
        air_acceleration: [0.0; 2],
        reference_jerk: [0.0; 2],
    };
}

impl Command {
    /// The safe command: no thrust, no rotation.
    pub const SAFE: Self = Self {
        header: Self::HEADER,
        status: code::ALULA_STATUS_SAFE,
        thrust: 0.0,
        rate: 0.0,
        alpha: 0.0,
        f_p: [0.0; 2],
        f_p_norm: 0.0,
        t_p: 0.0,
        guard_alignment: 0.0,
        guard_feed_forward: 0.0,
        k: 0.0,
    };
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for Input {}
// SAFETY: As above.
unsafe impl Layout for Command {}

impl Initialised<'_> {
    /// One step of the law that the controller flies.
    #[inline(never)]
    pub(crate) fn law(
        &self,
        state: &State,
        reference: &Reference,
        feed_forward: Option<&FeedForward>,
        dt: f32,
    ) -> Result<alula::Command, i32> {
        if !(MIN_STEP..=MAX_STEP).contains(&dt) {
            return Err(code::ALULA_ERROR_TIME_STEP);
        }
        let law = if self.is_robust() {
            Law::Robust
        } else {
            Law::Full
        };
        self.guidance
            .control()
            .either(law, state, reference, feed_forward)
            .map_err(code::of_fault)
    }
}

impl Command {
    #[inline(always)]
    fn new(command: &alula::Command) -> Self {
        let d = &command.diagnostics;
        Self {
            header: Self::HEADER,
            status: 0,
            thrust: command.thrust,
            rate: command.rate,
            alpha: d.alpha,
            f_p: [d.f_p.i(), d.f_p.j()],
            f_p_norm: d.f_p_norm,
            t_p: d.t_p,
            guard_alignment: d.guard_alignment,
            guard_feed_forward: d.guard_feed_forward,
            k: d.k,
        }
    }
}

#[inline(always)]
fn inertial(v: [f32; 2]) -> Inertial {
    Inertial::new(v[0], v[1])
}

// State and reference are laid out in an input as in the core, so that a step can read them in place.
const _: () = {
    assert!(
        offset_of!(Input, attitude) - offset_of!(Input, velocity) == offset_of!(State, attitude)
    );
    assert!(offset_of!(Input, wind) - offset_of!(Input, velocity) == offset_of!(State, wind));
    assert!(offset_of!(State, velocity) == 0 && size_of::<State>() == 6 * size_of::<f32>());
    assert!(offset_of!(Attitude, cos) == 0 && size_of::<Inertial>() == 2 * size_of::<f32>());
    assert!(offset_of!(Reference, velocity) == 0 && size_of::<Reference>() == 4 * size_of::<f32>());
    assert!(offset_of!(Reference, acceleration) == 2 * size_of::<f32>());
    assert!(align_of::<State>() == 4 && align_of::<Reference>() == 4);
};

impl Input {
    #[inline(always)]
    fn state(&self) -> &State {
        // SAFETY: The six numbers from `velocity` on have the layout of a state, by the assertions above.
        unsafe {
            &*(&raw const *self)
                .byte_add(offset_of!(Self, velocity))
                .cast()
        }
    }

    #[inline(always)]
    fn reference(&self) -> &Reference {
        // SAFETY: The four numbers from `reference_velocity` on have the layout of a reference, by the assertions above.
        unsafe {
            &*(&raw const *self)
                .byte_add(offset_of!(Self, reference_velocity))
                .cast()
        }
    }

    fn feed_forward(&self) -> Result<Option<FeedForward>, i32> {
        match self.flags {
            0 => Ok(None),
            ALULA_FEED_FORWARD => Ok(Some(FeedForward {
                air_acceleration: inertial(self.air_acceleration),
                jerk: inertial(self.reference_jerk),
            })),
            _ => Err(code::ALULA_ERROR_SELECTOR),
        }
    }
}

/// One step of the pure law in a vertical plane: from `input` to `command`, `dt` seconds after the last. The law has no
/// memory and no limits: `dt` is only checked. Whatever is returned but `ALULA_OK`, the command is the safe one; unless
/// `command` itself is at fault: it is then not written.
///
/// # Safety
/// Each pointer is null or points to memory of the caller's that holds at least the header word; the whole structure
/// if that is right. No other call uses the controller meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_step(
    controller: *const Controller,
    input: *const Input,
    dt: f32,
    command: *mut Command,
) -> i32 {
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, by the condition above.
    unsafe {
        // The most frequent call has a path of its own, with as few instructions as possible around the law.
        if let Some((controller, input)) = robust_arguments(controller, input, dt, command)
            && let Ok(value) = controller
                .guidance
                .control()
                .robust_in_place(input.state(), input.reference())
        {
            command.write(Command::new(&value));
            code::ALULA_OK
        } else {
            step(controller, input, dt, command)
        }
    }
}

/// Controller and input, if nothing is wrong with any argument and the law is the robust one without feed-forward.
///
/// # Safety
/// As `alula_step`.
#[inline(always)]
unsafe fn robust_arguments<'a>(
    controller: *const Controller,
    input: *const Input,
    dt: f32,
    command: *mut Command,
) -> Option<(&'a Initialised<'a>, &'a Input)> {
    if controller.is_null() || input.is_null() || command.is_null() {
        return None;
    }
    // A controller is aligned to eight bytes, the others to four.
    let address = controller.addr() | input.addr() << 1 | command.addr() << 1;
    if address & 7 != 0 {
        return None;
    }
    // SAFETY: The pointers are neither null nor unaligned, so each points to a header word; a header word that is right
    // is followed by the rest of its structure.
    unsafe {
        if controller.cast::<u32>().read() != ROBUST
            || input.cast::<u32>().read() != Input::HEADER
            || command.cast::<u32>().read() != Command::HEADER
        {
            return None;
        }
        let controller = &*controller.cast::<Initialised>();
        let input = &*input;
        // The bits of positive floats, as whole numbers, are in the same order.
        let in_time = dt.to_bits().wrapping_sub(MIN_STEP.to_bits())
            <= MAX_STEP.to_bits() - MIN_STEP.to_bits();
        (in_time && input.flags == 0).then_some((controller, input))
    }
}

/// The step, whatever the law and the arguments are.
///
/// # Safety
/// As `alula_step`.
#[cold]
#[inline(never)]
unsafe fn step(
    controller: *const Controller,
    input: *const Input,
    dt: f32,
    command: *mut Command,
) -> i32 {
    // SAFETY: As in `alula_step`.
    unsafe {
        boundary::answer(command, Command::SAFE, || {
            let controller = initialised(controller)?;
            let input = boundary::read(input)?;
            let feed_forward = input.feed_forward()?;
            let value =
                controller.law(input.state(), input.reference(), feed_forward.as_ref(), dt)?;
            Ok(Command::new(&value))
        })
    }
}

/// Fills in a hover in still air whose reference is to stay.
///
/// # Safety
/// `input` is null or points to memory of the caller's that holds at least the header word, already set; the whole
/// structure if that is right.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_input_default(input: *mut Input) -> i32 {
    // SAFETY: `input` is as `write` asks for, by the condition above.
    unsafe { boundary::write(input, Input::DEFAULT) }
}

/// Fills in the safe command.
///
/// # Safety
/// As `alula_input_default`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_command_default(command: *mut Command) -> i32 {
    // SAFETY: `command` is as `write` asks for, by the condition above.
    unsafe { boundary::write(command, Command::SAFE) }
}
