//! What the guidance is about, and what of the reference cannot be had.

use super::memory::memory;
use super::planner::{Planner, PlannerState};
use super::rollout::{PlanRequest, Rollout};
use crate::aero::Aerodynamics;
use crate::frame::Inertial;
use crate::math;
use crate::vehicle::Vehicle;

/// What the reference model does. The numbers are those of the library for C.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Phase {
    /// Follows the reference.
    #[default]
    Tracking = 0,
    /// Turns to an attitude far away, as across a fold.
    Crossing = 1,
    /// Goes to the reference with its thrust at a limit.
    Coasting = 2,
    /// Comes back from far off the reference: no error is within four of its bands.
    Recovering = 3,
}

impl Phase {
    /// Name for logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tracking => "tracking",
            Self::Crossing => "crossing",
            Self::Coasting => "coasting",
            Self::Recovering => "recovering",
        }
    }
}

/// Why the velocity wanted cannot be had, as far as the prediction shows. The numbers are those of the library for C, where 0 is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Unreachable {
    /// Sink steeper than the vehicle can at that speed.
    Sink = 1,
    /// Lower speed than the vehicle can at that sink rate, with least thrust: a gap between two sheets.
    Speed = 2,
    /// More thrust than there is.
    Thrust = 3,
}

impl Unreachable {
    /// Name for logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sink => "sink",
            Self::Speed => "speed",
            Self::Thrust => "thrust",
        }
    }
}

/// How far the guidance has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Progress {
    /// What it does.
    pub phase: Phase,
    /// Why the reference cannot be had, if it cannot.
    pub unreachable: Option<Unreachable>,
    /// Time \[s\] until the velocity wanted is had, as predicted; at most 22 s.
    pub time: f32,
    /// Forward distance \[m\] flown until then, relative to the reference.
    pub distance: f32,
}

/// Time to go \[s\] from which on an error is taken not to close.
const NEVER: f32 = 10.0;
/// Slope of a descent from which on it is the sink that speed is gained by. Wings glide at less.
const STEEP: f32 = 0.1;

/// What a prediction says of the way to go. It is made with a plan: between plans it does not change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Prospect {
    /// Time \[s\] and distance \[m\] of [`Progress`].
    time: f32,
    distance: f32,
    /// The number of the [`Unreachable`], or 0.
    unreachable: u8,
    /// 1 if the error at its end is within half a band. A number: every bit pattern has a meaning.
    arrives: u8,
}

memory!(Prospect {
    time: f32,
    distance: f32,
    unreachable: u8,
    arrives: u8,
});

/// What a sound rollout cannot come to.
const MAX_NUMBER: f32 = 1e13;

impl Prospect {
    /// What the `rollout` of a `request` says, of what is believed to be `vehicle`.
    pub fn new<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        planner: &Planner,
        request: &PlanRequest,
        rollout: &Rollout,
    ) -> Self {
        let (down, forward) = planner.cost.bands(rollout.error);
        let (to_go, reference) = (rollout.to_go, request.velocity);
        let unreachable = if down > 0.5 && to_go.down() > NEVER {
            Some(if rollout.error.down() < 0.0 {
                Unreachable::Sink
            } else {
                Unreachable::Thrust
            })
        } else if forward > 0.5 && to_go.forward() > NEVER {
            let thrust_max = vehicle.thrust_max() - request.missing_thrust;
            Some(if rollout.thrust >= thrust_max {
                Unreachable::Thrust
            } else if reference.down() > STEEP * reference.forward().abs() {
                Unreachable::Sink
            } else {
                Unreachable::Speed
            })
        } else {
            None
        };
        Self {
            time: planner.span() + math::max(to_go.down(), to_go.forward()),
            distance: rollout.distance + 0.5 * rollout.error.forward() * to_go.forward(),
            unreachable: unreachable.map_or(0, |reason| reason as u8),
            arrives: u8::from(down < 0.5 && forward < 0.5),
        }
    }

    /// Whether every number is one that a sound rollout can have left. NaN is not.
    #[inline(always)]
    pub fn is_sound(&self) -> bool {
        self.time.abs() + self.distance.abs() <= MAX_NUMBER
    }

    #[inline(always)]
    fn unreachable(&self) -> Option<Unreachable> {
        match self.unreachable {
            1 => Some(Unreachable::Sink),
            2 => Some(Unreachable::Speed),
            3 => Some(Unreachable::Thrust),
            _ => None,
        }
    }
}

impl Progress {
    /// The progress of a flight with `thrust` \[N\] that is off the velocity wanted by `error` [m/s].
    #[inline(always)]
    pub(super) fn new<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        planner: &Planner,
        state: &PlannerState,
        thrust: f32,
        error: Inertial,
    ) -> Self {
        let (down, forward) = planner.cost.bands(error);
        let worst = math::max(down, forward);
        let limited = thrust <= vehicle.thrust_min() || thrust >= vehicle.thrust_max();
        let phase = if state.plan.turn == 1 {
            Phase::Crossing
        } else if worst > 4.0 {
            Phase::Recovering
        } else if limited && worst > 0.5 {
            Phase::Coasting
        } else {
            Phase::Tracking
        };
        let prospect = &state.prospect;
        let (time, distance) = if worst < 0.5 && prospect.arrives == 1 {
            (0.0, 0.0)
        } else {
            (prospect.time, prospect.distance)
        };
        Self {
            phase,
            unreachable: prospect.unreachable(),
            time,
            distance,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use crate::guidance::*;
    use crate::planar::*;
    use crate::{Combined, CombinedParameters, Vehicle, VehicleParameters};
    use std::vec::Vec;

    /// A guidance that is told where the reference model is: what it says over `seconds`.
    fn said(
        (thrust_min, thrust_max): (f32, f32),
        reference: Inertial,
        wind: Inertial,
        seconds: f32,
    ) -> Vec<Progress> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = VehicleParameters {
            thrust_min,
            thrust_max,
            ..VehicleParameters::PAPER
        };
        let p = GuidanceParameters {
            safe_thrust: 0.5,
            ..GuidanceParameters::default()
        };
        let guidance = Guidance::new(Vehicle::new(vehicle, model).unwrap(), &p).unwrap();
        let mut state = GuidanceState::default();
        let mut progress = Vec::new();
        let mut position = Inertial::ZERO;
        for n in 0..(seconds * 100.0) as usize {
            let part = (n as f32 / 1000.0).min(1.0);
            let velocity = reference * part;
            let (v, mut theta) = state.reference_model();
            let mut v = v.to_plane();
            if n < 10 {
                (v, theta) = (Inertial::ZERO, 0.0);
            }
            position += (v - velocity) * 0.01;
            let input = PlanarGuidanceInput {
                velocity: v,
                attitude: Attitude::from_angle(theta),
                air: Air::Wind(wind),
                position_error: Some(position),
                reference: Reference {
                    velocity,
                    acceleration: if part < 1.0 {
                        reference * 0.1
                    } else {
                        Inertial::ZERO
                    },
                },
                ..PlanarGuidanceInput::default()
            };
            let guided = guidance.update_in_plane(&mut state, &input, 0.01);
            if guided.plan_due {
                guidance.plan(&mut state);
            }
            progress.push(guided.progress);
        }
        progress
    }

    #[test]
    fn a_reference_that_is_followed_is_tracked_with_nothing_to_go() {
        let progress = said((0.0, 196.2), Inertial::new(0.0, 8.0), Inertial::ZERO, 25.0);
        assert_eq!(progress.last(), Some(&Progress::default()));
        assert!(progress.iter().all(|p| p.unreachable.is_none()));
    }

    /// Whether this reason is given for a second at least, and any other for a quarter of that time at most.
    fn mostly(progress: &[Progress], reason: Unreachable) -> bool {
        let given = |r| progress.iter().filter(|p| p.unreachable == Some(r)).count();
        let all = progress.iter().filter(|p| p.unreachable.is_some()).count();
        given(reason) > 100 && 5 * given(reason) >= 4 * all
    }

    #[test]
    fn what_cannot_be_had_is_named() {
        // Steeper than any glide at that speed.
        let sink = said((0.0, 196.2), Inertial::new(9.0, 22.0), Inertial::ZERO, 22.0);
        assert!(mostly(&sink, Unreachable::Sink));
        // Slower than a glide on idle thrust in an updraft.
        let updraft = Inertial::new(-1.0, 0.0);
        let slow = said((5.0, 196.2), Inertial::new(0.0, 19.0), updraft, 30.0);
        assert!(mostly(&slow, Unreachable::Speed));
        // A climb that needs more than full thrust: 27 m/s at 1.07 times the weight.
        let climb = said(
            (0.0, 105.0),
            Inertial::new(-40.0, 0.0),
            Inertial::ZERO,
            30.0,
        );
        assert!(mostly(&climb, Unreachable::Thrust));
        assert!(climb.last().unwrap().time > 15.0);
    }
}
