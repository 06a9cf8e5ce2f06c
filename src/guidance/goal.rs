//! Goals beside references: to hover somewhere, to stop, to fly at a velocity.
//!
//! A goal is turned into the reference and the position error of a [`GuidanceInput`](super::GuidanceInput), step by step. How
//! it is reached is the guidance's matter: it starts, turns, brakes and crosses the stall by itself.

use crate::error::{ParameterError, positive};
use crate::math;
use crate::ned::Ned;
use crate::reference::MAX_SPEED;
use crate::spatial::{Heading, Reference};

/// What is to be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Goal {
    /// To hover at this position \[m\].
    Hover(Ned),
    /// To stop as soon as possible at the present altitude, and to hover where that ends.
    Stop,
    /// To fly at this velocity over ground [m/s].
    Velocity(Ned),
}

/// How a goal is to be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Preferences {
    /// Horizontal speed on the way to a position [m/s].
    pub speed: f32,
    /// Vertical speed on the way to a position [m/s].
    pub climb: f32,
    /// Greatest acceleration of the reference [m/s²]. A stop does not mind it.
    pub acceleration: f32,
}

/// Makes references of goals. Immutable and validated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Goals {
    preferences: Preferences,
}

/// What is remembered between steps. The default is that of a flight that has no goal yet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GoalState {
    goal: Option<Goal>,
    /// Reference position \[m\] and velocity [m/s].
    position: Ned,
    velocity: Ned,
    /// Whether a stop is over, and its place held.
    stopped: bool,
}

/// The part of the braking that leads to a position that is planned: the rest is for what the vehicle does not follow.
const BRAKING: f32 = 0.7;
/// Speed [m/s] at which a vehicle has stopped.
const STOPPED: f32 = 1.0;

impl Goals {
    /// Goals that are reached so.
    ///
    /// # Errors
    /// `speed`, `climb` or `acceleration` outside [1e-2, 1e3], or not a number.
    pub fn new(p: Preferences) -> Result<Self, ParameterError> {
        positive("speed", p.speed, 1e-2, 1e3)?;
        positive("climb", p.climb, 1e-2, 1e3)?;
        positive("acceleration", p.acceleration, 1e-2, 1e3)?;
        Ok(Self { preferences: p })
    }

    /// The reference and the position error \[m\] for `goal`, at a `position` \[m\] and a `velocity` [m/s], `dt` \[s\] after
    /// the last. A new goal begins where the vehicle is. What is not finite is handed on, and refused by the guidance.
    pub fn step(
        &self,
        state: &mut GoalState,
        goal: &Goal,
        position: Ned,
        velocity: Ned,
        dt: f32,
    ) -> (Reference, Ned) {
        if state.goal != Some(*goal) {
            let moving = state.goal.is_some() && !matches!(state.goal, Some(Goal::Stop));
            *state = GoalState {
                goal: Some(*goal),
                position,
                // From one goal to the next the reference has no step, unless it is to stop.
                velocity: if moving { state.velocity } else { velocity },
                stopped: false,
            };
        }
        let wanted = match goal {
            Goal::Hover(place) => self.towards(*place - state.position),
            Goal::Stop => {
                state.velocity = Ned::ZERO;
                // Where it stops is where it is held.
                if !state.stopped {
                    (state.position.north, state.position.east) = (position.north, position.east);
                    state.stopped = level(velocity) < STOPPED;
                }
                Ned::ZERO
            }
            Goal::Velocity(velocity) => *velocity,
        };
        let missing = wanted - state.velocity;
        let length = math::sqrt(missing.norm_squared());
        let most = self.preferences.acceleration * dt;
        let change = if length > most {
            missing * (most / length)
        } else {
            missing
        };
        state.velocity += change;
        state.position += state.velocity * dt;
        let reference = Reference {
            velocity: state.velocity,
            acceleration: if dt > 0.0 {
                change * (1.0 / dt)
            } else {
                Ned::ZERO
            },
            heading: Heading::FREE,
        };
        (reference, position - state.position)
    }

    /// The velocity to have at this way to go \[m\]: as fast as can be braked from.
    fn towards(&self, way: Ned) -> Ned {
        let p = &self.preferences;
        let speed = |distance: f32, most: f32| {
            let braked = math::sqrt((2.0 * BRAKING * p.acceleration * distance).abs());
            // Near the goal in proportion: the square root has no end.
            math::min(math::min(braked, distance * p.acceleration), most)
        };
        let distance = level(way);
        let along = if distance > 0.0 {
            speed(distance, p.speed) / distance
        } else {
            0.0
        };
        let down = speed(way.down.abs(), p.climb).copysign(way.down);
        Ned::new(way.north * along, way.east * along, down)
    }
}

impl GoalState {
    /// What is remembered, as plain values: the goal, the reference's position \[m\] and velocity [m/s], and whether a stop is
    /// over.
    pub fn parts(&self) -> (Option<Goal>, Ned, Ned, bool) {
        (self.goal, self.position, self.velocity, self.stopped)
    }

    /// The state of these [`parts`](Self::parts).
    pub fn from_parts(goal: Option<Goal>, position: Ned, velocity: Ned, stopped: bool) -> Self {
        Self {
            goal,
            position,
            velocity,
            stopped,
        }
    }

    /// Whether the reference stands at the goal: at rest there, or at the velocity asked for.
    pub fn is_reached(&self) -> bool {
        let near = |a: Ned, b: Ned, by: f32| (a - b).norm_squared() < by * by;
        match self.goal {
            Some(Goal::Hover(place)) => {
                near(self.position, place, 0.1) && near(self.velocity, Ned::ZERO, 0.1)
            }
            Some(Goal::Stop) => self.stopped,
            Some(Goal::Velocity(velocity)) => near(self.velocity, velocity, 0.1),
            None => false,
        }
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
        Goals::new(Preferences {
            speed: 20.0,
            climb: 3.0,
            acceleration: 2.0,
        })
        .unwrap()
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
            let (reference, error) = goals().step(state, &goal, x, v, DT);
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
            let (reference, error) = goals().step(&mut state, &Goal::Stop, x, v, DT);
            assert_eq!(reference.velocity, Ned::ZERO);
            assert_eq!(reference.acceleration, Ned::ZERO);
            // The altitude is that of the beginning.
            assert!((error.down - (x.down + 30.0)).abs() < 1e-4);
            if n < 190 {
                assert_eq!((error.north, error.east), (0.0, 0.0));
            }
            v = Ned::new((v.north - 0.1).max(0.0), 0.0, 0.0);
            x += v * DT;
        }
        assert!(state.is_reached());
        // Held from 1 m/s on, 5 cm before the end.
        let (_, error) = goals().step(&mut state, &Goal::Stop, x, v, DT);
        assert!((error.north - 0.05).abs() < 0.02, "{}", error.north);
    }

    /// From one velocity to the next with the acceleration preferred, and no step between two goals.
    #[test]
    fn velocities_are_ramped() {
        let mut state = GoalState::default();
        let v = Ned::new(0.0, 20.0, 0.0);
        let (end, fastest, hardest) =
            follow(&mut state, Goal::Velocity(v), (Ned::ZERO, Ned::ZERO), 11.0);
        assert!(state.is_reached() && fastest < 20.001 && (hardest - 2.0).abs() < 1e-3);
        let (reference, error) =
            goals().step(&mut state, &Goal::Hover(Ned::ZERO), end.0, end.1, DT);
        assert!((reference.velocity - v).norm_squared() < 0.03 * 0.03);
        assert!(error.norm_squared() < 1.0);
    }

    #[test]
    fn bad_preferences_are_named() {
        let good = Preferences {
            speed: 20.0,
            climb: 3.0,
            acceleration: 2.0,
        };
        let name = |p| Goals::new(p).unwrap_err().parameter;
        assert_eq!(name(Preferences { speed: 0.0, ..good }), "speed");
        assert_eq!(
            name(Preferences {
                climb: f32::NAN,
                ..good
            }),
            "climb"
        );
        assert_eq!(
            name(Preferences {
                acceleration: -1.0,
                ..good
            }),
            "acceleration"
        );
    }
}
