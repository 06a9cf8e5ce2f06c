//! Goals beside references: to hover somewhere, to stop, to fly at a velocity.
//!
//! A goal is turned into the reference and the position error of a [`GuidanceInput`](super::GuidanceInput), step by step. How
//! it is reached is the guidance's matter: it starts, turns, brakes and crosses the stall by itself.
//!
//! Elevon wings cannot brake level from cruise: behind the stall their surfaces saturate, and they climb by V²/2g and more that nobody asked
//! for. Where the caller allows it the reference brakes in a climb: at 3 m/s², and at 0.3 of its speed upwards until 0.15 of it are left, which
//! such a wing follows within a metre or two.

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
    /// To stop as soon as possible at the present altitude, or in the climb that is allowed, and to hover where that ends.
    Stop,
    /// To fly at this velocity over ground [m/s].
    Velocity(Ned),
}

/// How a goal is to be reached. The default is 20 m/s level, 3 m/s up and down, 2 m/s², level braking and no options.
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
    /// Greatest acceleration of the reference [m/s²]. A stop does not mind it, nor a braking in a climb.
    pub acceleration: f32,
    /// Greatest climb that a braking may take \[m\]; 0: it is level. It takes 0.085 s²/m V², 1.67 times V²/2g, V being what it takes off the speed; where
    /// that is more than is allowed, it is level. A stop, and a velocity, ends as much higher; a place to hover at is come down to.
    pub braking_climb: f32,
    /// What the plans are to mind, a stop's too.
    pub planner_options: PlannerOptions,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            speed: 20.0,
            climb: 3.0,
            acceleration: 2.0,
            braking_climb: 0.0,
            planner_options: PlannerOptions::default(),
        }
    }
}

setters! {
    Preferences {
        speed: f32,
        climb: f32,
        acceleration: f32,
        braking_climb: f32,
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
    /// Climb in which it brakes [m/s]. 0: on the way, or braking level; [`BRAKED`]: that is over, and of a stop its place is held.
    climb: f32,
}

memory!(SetPointState {
    kind: u8,
    target: Ned,
    position: Ned,
    velocity: Ned,
    climb: f32,
});

/// What a climb is once it is over. So is any negative one.
const BRAKED: f32 = -1.0;

/// The part of the braking that leads to a position that is planned: the rest is for what the vehicle does not follow.
const BRAKING: f32 = 0.7;
/// Speed [m/s] at which a vehicle has stopped. With 1 m/s one of eight stops in 5 m/s of tailwind drifted on at 1.4 m/s.
const STOPPED: f32 = 2.0;
/// Deceleration of a braking in a climb, and the vertical acceleration with which the climb begins and ends [m/s²]; its climb over the speed that is
/// braked off, and the part of that at which the climb ends.
/// Of 16 brakings by a wing of 2.4 kg, in light turbulence and a wind of up to 0.2 of cruise, 15 stay within 3 m of it; with a climb of 0.25 11 do, with 4 m/s² and 0.35 14.
const DECELERATION: f32 = 3.0;
const CLIMB_ACCELERATION: f32 = 3.0;
const CLIMB: f32 = 0.3;
const ENDS: f32 = 0.5 * CLIMB;
/// Climb over the square of the speed that is braked off [s²/m].
const RISE: f32 = CLIMB * (1.0 - ENDS) / DECELERATION;
/// Climb [m/s] that is none any more.
const LEVEL: f32 = 0.1;
/// Greatest climb that may be allowed \[m\].
const MOST_CLIMB: f32 = 1e3;
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
            && self.climb.abs() <= MAX_SPEED
    }

    /// Whether it brakes in a climb.
    pub(crate) fn is_climbing(&self) -> bool {
        self.climb > 0.0
    }

    /// Whether that is over.
    fn is_braked(&self) -> bool {
        self.climb < 0.0
    }

    /// The change of velocity by which it brakes in its climb to a `wanted` one. Near the end of the braking it ends the climb.
    #[cold]
    #[inline(never)]
    fn braked(&mut self, goal: &Goal, wanted: Ned, dt: f32) -> Ned {
        let (most, slowest) = match goal {
            Goal::Hover(_) => (DECELERATION / BRAKING, 0.0),
            Goal::Stop => (DECELERATION, 0.0),
            Goal::Velocity(wanted) => (DECELERATION, level(*wanted)),
        };
        let climbing = level(self.velocity) - slowest > ENDS / CLIMB * self.climb;
        let up = if climbing { self.climb } else { 0.0 };
        let missing = -up - self.velocity.down;
        if !climbing && missing < LEVEL {
            self.climb = BRAKED;
        }
        let change = CLIMB_ACCELERATION * dt;
        let level = wanted - self.velocity;
        Ned {
            down: math::clamp(missing, -change, change),
            ..limited(Ned { down: 0.0, ..level }, most * dt)
        }
    }

    /// As [`GoalState::is_reached`].
    pub(crate) fn is_reached(&self) -> bool {
        let near = |a: Ned, b: Ned, by: f32| (a - b).norm_squared() < by * by;
        match self.kind {
            1 => near(self.position, self.target, 0.1) && near(self.velocity, Ned::ZERO, 0.1),
            2 => self.is_braked(),
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
    /// `speed`, `climb` or `acceleration` outside [1e-2, 1e3], `braking_climb` outside [0, 1e3], `altitude_band` outside [1e-3, 1e3] and not
    /// zero, or not a number.
    pub fn new(p: Preferences) -> Result<Self, ParameterError> {
        in_range("speed", p.speed, [1e-2, 1e3], "m/s")?;
        in_range("climb", p.climb, [1e-2, 1e3], "m/s")?;
        in_range("acceleration", p.acceleration, [1e-2, 1e3], "m/s^2")?;
        in_range("braking_climb", p.braking_climb, [0.0, MOST_CLIMB], "m")?;
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
    #[inline(always)]
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
                ..SetPointState::default()
            };
            if self.preferences.braking_climb > 0.0 {
                self.begin(&mut set_point, goal);
            }
        }
        let held = set_point.is_braked();
        let mut most = self.preferences.acceleration;
        let wanted = match goal {
            Goal::Hover(place) => {
                let offset = *place - set_point.position;
                if self.preferences.braking_climb > 0.0 {
                    most = self.approach(&mut set_point, offset);
                }
                self.towards(offset, most)
            }
            Goal::Stop => {
                if !set_point.is_climbing() {
                    set_point.velocity = Ned::ZERO;
                    if level(velocity) < STOPPED {
                        set_point.climb = BRAKED;
                    }
                }
                Ned::ZERO
            }
            Goal::Velocity(wanted) => *wanted,
        };
        let change = if set_point.is_climbing() {
            set_point.braked(goal, wanted, dt)
        } else {
            limited(
                wanted - set_point.velocity,
                self.preferences.acceleration * dt,
            )
        };
        set_point.velocity += change;
        set_point.position += set_point.velocity * dt;
        // Where it stops is where it is held.
        if *goal == Goal::Stop && !held {
            (set_point.position.north, set_point.position.east) = (position.north, position.east);
        }
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
            hold_altitude_only: *goal == Goal::Stop && !set_point.is_braked(),
            ..self.preferences.planner_options
        };
        GoalOutput {
            reference,
            position_error: position - set_point.position,
            planner_options,
        }
    }

    /// Climb in which a velocity is braked to a slower speed [m/s]; 0 where that is level.
    fn climb(&self, from: Ned, to: f32) -> f32 {
        climb(self.preferences.braking_climb, level(from) - to)
    }

    /// Begins the braking of a stop, or to a slower velocity.
    #[cold]
    #[inline(never)]
    fn begin(&self, set_point: &mut SetPointState, goal: &Goal) {
        match goal {
            Goal::Hover(_) => {}
            Goal::Stop => set_point.climb = self.climb(set_point.velocity, 0.0),
            Goal::Velocity(wanted) => {
                set_point.climb = self.climb(set_point.velocity, level(*wanted));
            }
        }
    }

    /// The acceleration [m/s²] that a place at this offset \[m\] is braked to with. Begins that where it is time.
    #[cold]
    #[inline(never)]
    fn approach(&self, set_point: &mut SetPointState, offset: Ned) -> f32 {
        let preferred = self.preferences.acceleration;
        let climb = self.climb(set_point.velocity, 0.0);
        let is_on_the_way = set_point.climb == 0.0;
        let climbs = set_point.is_climbing() || (is_on_the_way && climb > 0.0);
        let most = if climbs {
            DECELERATION / BRAKING
        } else {
            preferred
        };
        let speed = level(set_point.velocity);
        if is_on_the_way && speed * speed > 2.0 * BRAKING * most * level(offset) {
            // In its climb; or level, to its end.
            set_point.climb = if climbs { climb } else { BRAKED };
        }
        most
    }

    /// The velocity towards a position at this offset \[m\]: as fast as can be braked from with this acceleration [m/s²].
    #[inline(always)]
    fn towards(&self, offset: Ned, acceleration: f32) -> Ned {
        let p = &self.preferences;
        let speed = |distance: f32, acceleration: f32, most: f32| {
            let braked = math::sqrt((2.0 * BRAKING * acceleration * distance).abs());
            // Near the goal in proportion: the square root has no end.
            math::min(math::min(braked, distance * acceleration), most)
        };
        let distance = level(offset);
        let along = if distance > 0.0 {
            speed(distance, acceleration, p.speed) / distance
        } else {
            0.0
        };
        let down = speed(offset.down.abs(), p.acceleration, p.climb).copysign(offset.down);
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

/// Whether a squared speed [m²/s²] is braked off in a climb: a height of `most` \[m\] is allowed, and enough.
#[inline(always)]
fn climbs(square: f32, most: f32) -> bool {
    most > 0.0 && RISE * square <= most
}

/// Climb [m/s] in which a `speed` [m/s] is braked off where a height of `most` \[m\] is allowed; 0 where that is too little for it.
#[inline(always)]
fn climb(most: f32, speed: f32) -> f32 {
    if climbs(speed * speed, most) {
        math::max(CLIMB * speed, 0.0)
    } else {
        0.0
    }
}

/// Deceleration [m/s²] in which a squared speed [m²/s²] is braked to a place: a part of this acceleration, or in a climb where a height of `most` \[m\] is
/// allowed and enough.
#[inline(always)]
pub(crate) fn deceleration(square: f32, acceleration: f32, most: f32) -> f32 {
    if climbs(square, most) {
        DECELERATION
    } else {
        BRAKING * acceleration
    }
}

/// A vector of at most this length.
#[inline(always)]
fn limited(v: Ned, most: f32) -> Ned {
    let length = math::sqrt(v.norm_squared());
    if length > most {
        v * (most / length)
    } else {
        v
    }
}

/// Length of the horizontal part, at most [`MAX_SPEED`] times a thousand.
#[inline(always)]
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

    /// A vehicle that follows exactly, in cruise at 18 m/s, 30 m high: its height over that when it has reached the goal, at most and at the end.
    fn climbed(goal: Goal, braking_climb: f32) -> [f32; 2] {
        let goals = Goals::new(
            Preferences::default()
                .speed(18.0)
                .braking_climb(braking_climb),
        )
        .unwrap();
        let (mut state, mut most) = (GoalState::default(), 0.0f32);
        let (mut x, mut v) = (Ned::new(0.0, 0.0, -30.0), Ned::new(18.0, 0.0, 0.0));
        for _ in 0..6000 {
            let asked = goals.step(&mut state, &goal, x, v, DT);
            let a = asked.reference.acceleration;
            // √(4.29² + 3²), and roundings; a level stop is asked for at once.
            assert!(math::sqrt(a.norm_squared()) < 5.3);
            x = x - asked.position_error;
            // The place of a stop is where the vehicle is.
            x += Ned { down: 0.0, ..v } * if goal == Goal::Stop { DT } else { 0.0 };
            let braked = math::max(v.north - 8.0 * DT, 0.0);
            v = match goal {
                Goal::Stop => Ned {
                    north: math::max(braked, asked.reference.velocity.north),
                    ..asked.reference.velocity
                },
                _ => asked.reference.velocity,
            };
            most = most.max(-30.0 - x.down);
        }
        assert!(state.is_reached());
        [most, -30.0 - x.down]
    }

    /// The climb that is said, of what is braked off, to within 0.5 m by which it ends later; a stop ends there, a place is come down to. Where a
    /// metre less is allowed than it takes, and by default, it is level.
    #[test]
    fn a_braking_climbs_as_far_as_it_says_or_not_at_all() {
        let place = Goal::Hover(Ned::new(200.0, 0.0, -30.0));
        let slower = Goal::Velocity(Ned::new(3.0, 0.0, 0.0));
        for (goal, off, ends) in [
            (Goal::Stop, 18.0, 1.0),
            (place, 18.0, 0.0),
            (slower, 15.0, 1.0),
        ] {
            let height = 0.085 * off * off;
            let [most, end] = climbed(goal, height + 0.1);
            assert!(
                (most - height).abs() < 0.5 && (end - ends * height).abs() < 0.5,
                "{goal:?} {most} {end} {height}"
            );
            for less in [0.0, height - 1.0] {
                let level = climbed(goal, less);
                assert!(level[0] < 1e-3, "{goal:?} {level:?}");
            }
        }
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
        let goals = || Goals::new(Preferences::default().braking_climb(30.0)).unwrap();
        let goal = Goal::Hover(Ned::new(60.0, 10.0, -40.0));
        let mut left = GoalState::default();
        for _ in 0..200 {
            goals().step(&mut left, &goal, x, v, DT);
        }
        assert!(left.set_point.is_climbing());
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
        for bad in [-1.0, 2e3, f32::NAN] {
            assert_eq!(name(good.braking_climb(bad)), "braking_climb");
        }
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
