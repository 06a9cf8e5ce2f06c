//! Goals beside references: to hover somewhere, to stop, to fly at a velocity.
//!
//! A goal is turned into the reference and the position error of a [`GuidanceInput`](super::GuidanceInput), step by step. How
//! it is reached is the guidance's matter: it starts, turns, brakes and crosses the stall by itself.

use super::memory::{Integrity, Memory, ShadowCopy, memory};
use super::planner_options::{LEAST_BAND, MOST_BAND, PlannerOptions};
use super::{MAX_STEP, MIN_STEP};
use crate::error::{ParameterError, in_range};
use crate::math;
use crate::ned::Ned;
use crate::parameters::setters;
use crate::reference::MAX_SPEED;
use crate::spatial::{Heading, Reference};

/// What is to be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Goal {
    /// To hover at this position \[m\].
    Hover(Ned),
    /// To stop as soon as possible at the present altitude, and to hover where that ends.
    Stop,
    /// To fly at this velocity over ground [m/s].
    Velocity(Ned),
}

/// How a goal is to be reached. The default is 20 m/s level, 3 m/s up and down, 2 m/s² and no options.
///
/// ```
/// use alula::prelude::*;
///
/// let slower = Preferences::default().speed(12.0).climb(1.5);
/// assert_eq!((slower.speed, slower.acceleration), (12.0, 2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Preferences {
    /// Horizontal speed on the way to a position [m/s].
    pub speed: f32,
    /// Vertical speed on the way to a position [m/s].
    pub climb: f32,
    /// Greatest acceleration of the reference [m/s²]. A stop does not mind it.
    pub acceleration: f32,
    /// What the plans are to mind, a stop's too.
    pub planner_options: PlannerOptions,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            speed: 20.0,
            climb: 3.0,
            acceleration: 2.0,
            planner_options: PlannerOptions::default(),
        }
    }
}

setters! {
    Preferences {
        speed: f32,
        climb: f32,
        acceleration: f32,
        planner_options: PlannerOptions,
    }
}

/// Makes references of goals. Immutable and validated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Goals {
    preferences: Preferences,
}

/// What is remembered between steps. The default is that of a flight that has no goal yet.
///
/// Any one word of it may change from outside: what the last step left is brought back. Where that is not known, or is none that a
/// step leaves, the goal begins anew where the vehicle is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GoalState {
    set_point: SetPointState,
    shadow: ShadowCopy<{ SetPointState::WORDS }>,
}

/// How far a goal has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct SetPointState {
    /// Which goal it is, by its [`Goal::parts`]; 0 for none.
    kind: u8,
    target: Ned,
    /// Reference position \[m\] and velocity [m/s].
    position: Ned,
    velocity: Ned,
    /// 1 once a stop is over, and its place held.
    stopped: u8,
}

memory!(SetPointState {
    kind: u8,
    target: Ned,
    position: Ned,
    velocity: Ned,
    stopped: u8,
});

/// The part of the braking that leads to a position that is planned: the rest is for what the vehicle does not follow.
const BRAKING: f32 = 0.7;
/// Speed [m/s] at which a vehicle has stopped. With 1 m/s one of eight stops in 5 m/s of tailwind drifted on at 1.4 m/s.
const STOPPED: f32 = 2.0;
/// Places are no farther than this from where positions are counted from \[m\].
const FARTHEST: f32 = 1e8;

impl Goal {
    /// Its kind, a word other than 0, and its place or velocity, zero if it has none.
    fn parts(&self) -> (u8, Ned) {
        match self {
            Self::Hover(place) => (1, *place),
            Self::Stop => (2, Ned::ZERO),
            Self::Velocity(velocity) => (3, *velocity),
        }
    }
}

impl SetPointState {
    /// Whether it is one that a step leaves. NaN is not.
    fn is_sound(&self) -> bool {
        let far = FARTHEST * FARTHEST;
        self.kind <= 3
            && self.target.norm_squared() <= far
            && self.position.norm_squared() <= far
            && self.velocity.norm_squared() <= MAX_SPEED * MAX_SPEED
            && self.stopped <= 1
    }

    /// As [`GoalState::is_reached`].
    pub(crate) fn is_reached(&self) -> bool {
        let near = |a: Ned, b: Ned, by: f32| (a - b).norm_squared() < by * by;
        match self.kind {
            1 => near(self.position, self.target, 0.1) && near(self.velocity, Ned::ZERO, 0.1),
            2 => self.stopped == 1,
            3 => near(self.velocity, self.target, 0.1),
            _ => false,
        }
    }
}

/// What of the guidance's input makes a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GoalOutput {
    /// Where to fly to.
    pub reference: Reference,
    /// Position less that of the reference \[m\].
    pub position_error: Ned,
    /// Those preferred, and what the goal needs.
    pub planner_options: PlannerOptions,
}

impl Goals {
    /// Goals that are reached so.
    ///
    /// # Errors
    /// `speed`, `climb` or `acceleration` outside [1e-2, 1e3], `altitude_band` outside [1e-3, 1e3] and not zero, or not a number.
    pub fn new(p: Preferences) -> Result<Self, ParameterError> {
        in_range("speed", p.speed, [1e-2, 1e3], "m/s")?;
        in_range("climb", p.climb, [1e-2, 1e3], "m/s")?;
        in_range("acceleration", p.acceleration, [1e-2, 1e3], "m/s^2")?;
        let band = p.planner_options.altitude_band;
        if band != 0.0 {
            in_range("altitude_band", band, [LEAST_BAND, MOST_BAND], "m")?;
        }
        Ok(Self { preferences: p })
    }

    /// The same of preferences that are within these bounds.
    pub(crate) const fn of(preferences: Preferences) -> Self {
        Self { preferences }
    }

    /// What the input is given for `goal`, at a `position` \[m\] and a `velocity` [m/s], `dt` \[s\] after
    /// the last. A new goal begins where the vehicle is. What is not finite is handed on, to be refused by the guidance, and not
    /// remembered; in a step of no time, or of one that the guidance refuses, the reference stands still.
    pub fn step(
        &self,
        state: &mut GoalState,
        goal: &Goal,
        position: Ned,
        velocity: Ned,
        dt: f32,
    ) -> GoalOutput {
        let mut set_point = state.left();
        let output = self.advance(&mut set_point, goal, position, velocity, dt);
        let shadow = ShadowCopy::new(&set_point);
        *state = GoalState { set_point, shadow };
        output
    }

    /// The same of what is remembered by someone else.
    pub(crate) fn advance(
        &self,
        state: &mut SetPointState,
        goal: &Goal,
        position: Ned,
        velocity: Ned,
        dt: f32,
    ) -> GoalOutput {
        let dt = if (MIN_STEP..=MAX_STEP).contains(&dt) {
            dt
        } else {
            0.0
        };
        let mut set_point = *state;
        let (kind, target) = goal.parts();
        if (set_point.kind, set_point.target) != (kind, target) {
            set_point = SetPointState {
                kind,
                target,
                position,
                // From one goal to the next the reference has no step, unless it is to stop.
                velocity: match set_point.kind {
                    1 | 3 => set_point.velocity,
                    _ => velocity,
                },
                stopped: 0,
            };
        }
        let wanted = match goal {
            Goal::Hover(place) => self.towards(*place - set_point.position),
            Goal::Stop => {
                set_point.velocity = Ned::ZERO;
                // Where it stops is where it is held.
                if set_point.stopped == 0 {
                    (set_point.position.north, set_point.position.east) =
                        (position.north, position.east);
                    set_point.stopped = (level(velocity) < STOPPED).into();
                }
                Ned::ZERO
            }
            Goal::Velocity(velocity) => *velocity,
        };
        let missing = wanted - set_point.velocity;
        let length = math::sqrt(missing.norm_squared());
        let most = self.preferences.acceleration * dt;
        let change = if length > most {
            missing * (most / length)
        } else {
            missing
        };
        set_point.velocity += change;
        set_point.position += set_point.velocity * dt;
        if set_point.is_sound() {
            *state = set_point;
        }
        let reference = Reference {
            velocity: set_point.velocity,
            acceleration: if dt > 0.0 {
                change * (1.0 / dt)
            } else {
                Ned::ZERO
            },
            heading: Heading::FREE,
        };
        let planner_options = PlannerOptions {
            hold_altitude_only: *goal == Goal::Stop && set_point.stopped == 0,
            ..self.preferences.planner_options
        };
        GoalOutput {
            reference,
            position_error: position - set_point.position,
            planner_options,
        }
    }

    /// The velocity towards a position at this offset \[m\]: as fast as can be braked from.
    fn towards(&self, offset: Ned) -> Ned {
        let p = &self.preferences;
        let speed = |distance: f32, most: f32| {
            let braked = math::sqrt((2.0 * BRAKING * p.acceleration * distance).abs());
            // Near the goal in proportion: the square root has no end.
            math::min(math::min(braked, distance * p.acceleration), most)
        };
        let distance = level(offset);
        let along = if distance > 0.0 {
            speed(distance, p.speed) / distance
        } else {
            0.0
        };
        let down = speed(offset.down.abs(), p.climb).copysign(offset.down);
        Ned::new(offset.north * along, offset.east * along, down)
    }
}

impl GoalState {
    /// Number of [`to_words`](Self::to_words).
    pub const WORDS: usize = SetPointState::WORDS + ShadowCopy::<{ SetPointState::WORDS }>::WORDS;

    /// What is remembered, a copy of that, and a check word.
    pub fn to_words(&self) -> [u32; Self::WORDS] {
        let mut words = [0; Self::WORDS];
        let mut places = words.iter_mut();
        let mut put = |word: u32| {
            if let Some(place) = places.next() {
                *place = word;
            }
        };
        self.set_point.write(&mut put);
        self.shadow.write(&mut put);
        words
    }

    /// The state of these words. Any will do.
    pub fn from_words(words: &[u32; Self::WORDS]) -> Self {
        let mut words = words.iter().copied();
        let mut next = || words.next().unwrap_or(0);
        let set_point = Memory::read(&mut next);
        Self {
            set_point,
            shadow: Memory::read(&mut next),
        }
    }

    /// What the last step left.
    fn left(&self) -> SetPointState {
        let mut set_point = self.set_point;
        let integrity = self.shadow.restore(&mut set_point);
        if integrity != Integrity::Lost && set_point.is_sound() {
            set_point
        } else {
            SetPointState::default()
        }
    }

    /// Whether the reference stands at the goal: at rest there, or at the velocity asked for.
    pub fn is_reached(&self) -> bool {
        self.left().is_reached()
    }
}

/// Length of the horizontal part, at most [`MAX_SPEED`] times a thousand.
fn level(v: Ned) -> f32 {
    math::min(
        math::sqrt(v.north * v.north + v.east * v.east),
        1e3 * MAX_SPEED,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f32 = 0.01;

    fn goals() -> Goals {
        Goals::new(Preferences::default()).unwrap()
    }

    /// A vehicle that follows exactly, for `time` \[s\]: its state at the end, and the most that was asked of it.
    fn follow(
        state: &mut GoalState,
        goal: Goal,
        (mut x, mut v): (Ned, Ned),
        time: f32,
    ) -> ((Ned, Ned), f32, f32) {
        let (mut fastest, mut hardest) = (0.0f32, 0.0f32);
        for _ in 0..(time / DT) as usize {
            let GoalOutput {
                reference,
                position_error: error,
                ..
            } = goals().step(state, &goal, x, v, DT);
            x = x - error;
            v = reference.velocity;
            fastest = fastest.max(level(v));
            hardest = hardest.max(math::sqrt(reference.acceleration.norm_squared()));
        }
        ((x, v), fastest, hardest)
    }

    #[test]
    fn a_place_is_reached_without_passing_it() {
        let (mut state, place) = (GoalState::default(), Ned::new(120.0, -160.0, -15.0));
        let start = (Ned::ZERO, Ned::ZERO);
        let ((x, v), fastest, hardest) = follow(&mut state, Goal::Hover(place), start, 40.0);
        assert!((x - place).norm_squared() < 0.01 && v.norm_squared() < 0.01);
        assert!(state.is_reached());
        // 1e-3: roundings of the steps.
        assert!(fastest < 20.001 && fastest > 15.0 && hardest < 2.001);
    }

    /// The reference stops at once, and the place is where the vehicle is when it has stopped.
    #[test]
    fn a_stop_is_held_where_it_ends() {
        let mut state = GoalState::default();
        let mut x = Ned::new(0.0, 0.0, -30.0);
        let mut v = Ned::new(20.0, 0.0, 1.0);
        for n in 0..1000 {
            let GoalOutput {
                reference,
                position_error: error,
                ..
            } = goals().step(&mut state, &Goal::Stop, x, v, DT);
            assert_eq!(reference.velocity, Ned::ZERO);
            assert_eq!(reference.acceleration, Ned::ZERO);
            // The altitude is that of the beginning.
            assert!((error.down - (x.down + 30.0)).abs() < 1e-4);
            if n < 180 {
                assert_eq!((error.north, error.east), (0.0, 0.0));
            }
            v = Ned::new((v.north - 0.1).max(0.0), 0.0, 0.0);
            x += v * DT;
        }
        assert!(state.is_reached());
        // Held from 2 m/s on, 20 cm before the end.
        let error = goals()
            .step(&mut state, &Goal::Stop, x, v, DT)
            .position_error;
        assert!((error.north - 0.2).abs() < 0.03, "{}", error.north);
    }

    /// From one velocity to the next with the acceleration preferred, and no step between two goals.
    #[test]
    fn velocities_are_ramped() {
        let mut state = GoalState::default();
        let v = Ned::new(0.0, 20.0, 0.0);
        let (end, fastest, hardest) =
            follow(&mut state, Goal::Velocity(v), (Ned::ZERO, Ned::ZERO), 11.0);
        assert!(state.is_reached() && fastest < 20.001 && (hardest - 2.0).abs() < 1e-3);
        let GoalOutput {
            reference,
            position_error: error,
            ..
        } = goals().step(&mut state, &Goal::Hover(Ned::ZERO), end.0, end.1, DT);
        assert!((reference.velocity - v).norm_squared() < 0.03 * 0.03);
        assert!(error.norm_squared() < 1.0);
    }

    /// A frame that is not finite, or of no time, in the middle of a flight or at its beginning: what follows is as without it, but for the one step
    /// that the reference may have gone on.
    #[test]
    fn bad_frames_are_not_remembered() {
        let (good, nan) = (Ned::new(0.5, -0.25, 2.0), Ned::new(0.0, f32::NAN, 0.0));
        let place = Goal::Hover(Ned::new(120.0, -160.0, -15.0));
        for begun in [0, 300] {
            let mut undisturbed = GoalState::default();
            for _ in 0..begun {
                goals().step(&mut undisturbed, &place, good, good, DT);
            }
            let frames = [
                (place, nan, good, DT),
                (place, good, nan, DT),
                (Goal::Hover(nan), good, good, DT),
                (Goal::Velocity(Ned::new(1e30, 0.0, 0.0)), good, good, DT),
                (place, good, good, f32::NAN),
                (place, good, good, f32::INFINITY),
                (place, good, good, -1.0),
                (place, good, good, 1e-45),
            ];
            for (goal, x, v, dt) in frames {
                let mut state = undisturbed;
                goals().step(&mut state, &goal, x, v, dt);
                let mut other = undisturbed;
                for _ in 0..3 {
                    let left = goals().step(&mut state, &place, good, good, DT);
                    let expected = goals().step(&mut other, &place, good, good, DT);
                    // 2 m/s² and 7 m/s for a step, and roundings.
                    let off = (
                        left.reference.velocity - expected.reference.velocity,
                        left.position_error - expected.position_error,
                    );
                    assert!(
                        off.0.norm_squared() <= 0.021 * 0.021,
                        "{goal:?} {dt} {off:?}"
                    );
                    assert!(off.1.norm_squared() <= 0.08 * 0.08, "{goal:?} {dt} {off:?}");
                }
            }
        }
    }

    /// Every bit flipped: the reference goes on as it was. Any other memory: it begins where the vehicle is, or where one may have been.
    #[test]
    fn changed_memory_is_restored_or_begun_anew() {
        let (x, v) = (Ned::new(3.0, 4.0, -20.0), Ned::new(14.0, 0.5, 0.0));
        let goal = Goal::Hover(Ned::new(300.0, 10.0, -40.0));
        let mut left = GoalState::default();
        for _ in 0..200 {
            goals().step(&mut left, &goal, x, v, DT);
        }
        let GoalOutput {
            reference: expected,
            position_error: error,
            ..
        } = goals().step(&mut { left }, &goal, x, v, DT);
        for bit in 0..32 * GoalState::WORDS {
            let mut words = left.to_words();
            words[bit / 32] ^= 1 << (bit % 32);
            let mut state = GoalState::from_words(&words);
            let GoalOutput {
                reference,
                position_error: off,
                ..
            } = goals().step(&mut state, &goal, x, v, DT);
            assert_eq!(
                (reference.velocity, off),
                (expected.velocity, error),
                "{bit}"
            );
        }
        assert_eq!(GoalState::from_words(&left.to_words()), left);
        for any in [u32::MAX, 0x7fc0_0000, 0x4b18_967f] {
            let mut state = GoalState::from_words(&[any; GoalState::WORDS]);
            let GoalOutput {
                reference,
                position_error: off,
                ..
            } = goals().step(&mut state, &goal, x, v, DT);
            // One step from the vehicle's velocity and place.
            assert!((reference.velocity - v).norm_squared() < 1e-3, "{any}");
            assert!(off.norm_squared() < 0.1);
        }
    }

    #[test]
    fn bad_preferences_are_named() {
        let good = Preferences::default();
        let name = |p| Goals::new(p).unwrap_err().parameter;
        assert_eq!(name(good.speed(0.0)), "speed");
        assert_eq!(name(good.climb(f32::NAN)), "climb");
        assert_eq!(name(good.acceleration(-1.0)), "acceleration");
        let band = |band| good.planner_options(PlannerOptions::default().altitude_band(band));
        for bad in [-1.0, 1e-4, 2e3, f32::NAN, f32::INFINITY] {
            assert_eq!(name(band(bad)), "altitude_band");
        }
        for possible in [0.0, 1e-3, 1e3] {
            let planner_options = Goals::new(band(possible))
                .unwrap()
                .preferences
                .planner_options;
            assert_eq!(planner_options.altitude_band, possible);
        }
    }
}
