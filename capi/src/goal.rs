//! Goals beside references: the input's reference and position error for a place, a stop or a velocity.

use alula::guidance::{Goal as Core, GoalOutput, GoalState, Goals, PlannerOptions, Preferences};
use alula::spatial::Ned;

use crate::boundary::{self, Layout};
use crate::code;
use crate::input::{
    ALULA_HOLD_ALTITUDE_ONLY, ALULA_NOSE_BELOW_VERTICAL, ALULA_POSITION, Input, PLANNER_OPTIONS,
    ned,
};

/// Goal: to hover at the position `target` \[m\].
pub const ALULA_GOAL_HOVER: u32 = 1;
/// Goal: to stop as soon as possible at the altitude where this was asked for, or in the climb that is allowed, and to hover where that ends. `target` is not
/// read.
pub const ALULA_GOAL_STOP: u32 = 2;
/// Goal: to fly at the velocity `target` [m/s] over ground.
pub const ALULA_GOAL_VELOCITY: u32 = 3;

/// What is to be reached, and how far that has come. `alula_goal_default` makes it a stop without a past.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Goal {
    /// `ALULA_HEADER(alula_goal)`.
    pub header: u32,
    /// `ALULA_GOAL_HOVER`, `ALULA_GOAL_STOP` or `ALULA_GOAL_VELOCITY`. It may change at any step, and so may `target`.
    pub kind: u32,
    /// Position \[m\], in the world of `alula_goal_step`'s position, or velocity [m/s]: north, east, down.
    pub target: [f32; 3],
    /// Horizontal speed on the way to a position [m/s], 0.01 to 1000.
    pub speed: f32,
    /// Vertical speed on the way to a position [m/s], 0.01 to 1000.
    pub climb: f32,
    /// Greatest acceleration of the reference [m/s²], 0.01 to 1000. A stop does not mind it, nor a braking in a climb.
    pub acceleration: f32,
    /// Greatest climb that a braking may take \[m\], 0 to 1000; 0: it is level. It takes 0.085 s²/m V², V being what it takes off the speed; where that
    /// is more than is allowed, it is level. A stop, and a velocity, ends as much higher; a place to hover at is come down to.
    pub braking_climb: f32,
    /// Altitude error \[m\] that a plan may cost as much as an error of one velocity band, 0.001 to 1000. 0: the parameter
    /// `altitude_band`.
    pub altitude_band: f32,
    /// 1 if the nose is to stay short of the vertical while the vehicle flies forward, else 0.
    pub nose_below_vertical: u32,
    /// Result: 1 if the reference stands at the goal, at rest there or at the velocity, else 0.
    pub reached: u32,
    /// Private: what is remembered, and a copy of it.
    pub opaque: [u32; 23],
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for Goal {}

impl Goal {
    /// A stop without a past. On the way to positions 20 m/s, 3 m/s up and down and 2 m/s².
    pub const DEFAULT: Self = Self {
        header: Self::HEADER,
        kind: ALULA_GOAL_STOP,
        target: [0.0; 3],
        speed: 20.0,
        climb: 3.0,
        acceleration: 2.0,
        braking_climb: 0.0,
        altitude_band: 0.0,
        nose_below_vertical: 0,
        reached: 0,
        opaque: [0; 23],
    };

    /// The step from `position` \[m\] and `velocity` [m/s], `dt` \[s\] after the last: this afterwards, and the input's
    /// reference.
    fn stepped(&self, position: Ned, input: &Input, dt: f32) -> Result<(Self, Input), i32> {
        if !(1e-4..=0.2).contains(&dt) {
            return Err(code::ALULA_ERROR_TIME_STEP);
        }
        let target = ned(self.target);
        // By name here: the core hands it on.
        if !is_place(position) || !is_place(target) {
            return Err(code::ALULA_ERROR_GOAL);
        }
        let velocity = ned(input.velocity);
        if !is_place(velocity) {
            return Err(code::ALULA_ERROR_VELOCITY);
        }
        let goal = core(self.kind, target).ok_or(code::ALULA_ERROR_GOAL)?;
        let planner_options = PlannerOptions::default()
            .altitude_band(self.altitude_band)
            .nose_below_vertical(match self.nose_below_vertical {
                0 => false,
                1 => true,
                _ => return Err(code::ALULA_ERROR_GOAL),
            });
        let preferences = Preferences::default()
            .speed(self.speed)
            .climb(self.climb)
            .acceleration(self.acceleration)
            .braking_climb(self.braking_climb)
            .planner_options(planner_options);
        let goals = Goals::new(preferences);
        let goals = goals.map_err(|_| code::ALULA_ERROR_GOAL)?;
        let mut state = GoalState::from_words(&self.opaque);
        let GoalOutput {
            reference,
            position_error,
            planner_options,
            ..
        } = goals.step(&mut state, &goal, position, velocity, dt);
        let after = Self {
            reached: state.is_reached().into(),
            opaque: state.to_words(),
            ..*self
        };
        let input = Input {
            flags: input.flags & !PLANNER_OPTIONS | ALULA_POSITION | flags(&planner_options),
            reference_velocity: components(reference.velocity),
            reference_acceleration: components(reference.acceleration),
            position_error: components(position_error),
            reference_age: 0.0,
            altitude_band: planner_options.altitude_band,
            ..*input
        };
        Ok((after, input))
    }
}

fn core(kind: u32, target: Ned) -> Option<Core> {
    match kind {
        ALULA_GOAL_HOVER => Some(Core::Hover(target)),
        ALULA_GOAL_STOP => Some(Core::Stop),
        ALULA_GOAL_VELOCITY => Some(Core::Velocity(target)),
        _ => None,
    }
}

fn flags(planner_options: &PlannerOptions) -> u32 {
    let flag = |set, flag| if set { flag } else { 0 };
    flag(
        planner_options.nose_below_vertical,
        ALULA_NOSE_BELOW_VERTICAL,
    ) | flag(planner_options.hold_altitude_only, ALULA_HOLD_ALTITUDE_ONLY)
}

fn components(v: Ned) -> [f32; 3] {
    [v.north, v.east, v.down]
}

/// Whether a vector is one, no longer than 1e8 m, the farthest that the core remembers. NaN is not.
fn is_place(v: Ned) -> bool {
    v.norm_squared() <= 1e16
}

/// Fills in a stop without a past, with 20 m/s, 3 m/s up and down and 2 m/s² on the way to positions.
///
/// # Safety
/// `goal` is null or points to memory of the caller's that holds at least the header word, already set; the whole
/// structure if that is right.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_goal_default(goal: *mut Goal) -> i32 {
    // SAFETY: `goal` is as `write` asks for, by the condition above.
    unsafe { boundary::write(goal, Goal::DEFAULT) }
}

/// The reference, the position error and the planner options of `input` for `goal`, before `alula_guide` is called with it: at `position` \[m\],
/// north, east, down, and the velocity that is in `input`, `dt` \[s\] after the last. It sets `reference_velocity`,
/// `reference_acceleration`, `position_error` with `ALULA_POSITION`, `reference_age`, `altitude_band`, `ALULA_NOSE_BELOW_VERTICAL`
/// and `ALULA_HOLD_ALTITUDE_ONLY`. A new goal begins where the vehicle is. With any code but `ALULA_OK` neither `goal` nor `input` has changed.
///
/// # Safety
/// `goal` and `input` are each null or point to memory of the caller's that holds at least the header word; the whole structure
/// if that is right, and not the same memory. `position` is null or points to three numbers. No other call uses them
/// meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_goal_step(
    goal: *mut Goal,
    position: *const f32,
    dt: f32,
    input: *mut Input,
) -> i32 {
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, or to three numbers, by
    // the condition above; what is read is copied before anything is written.
    unsafe {
        let made = boundary::check_pointer(position).and_then(|()| {
            let (goal, input) = (*boundary::read(goal)?, *boundary::read(input)?);
            goal.stepped(ned(position.cast::<[f32; 3]>().read()), &input, dt)
        });
        match made {
            Ok((after, told)) => {
                goal.write(after);
                input.write(told);
                code::ALULA_OK
            }
            Err(code) => code,
        }
    }
}
