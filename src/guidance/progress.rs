//! What the guidance is about, and what of the reference cannot be had.

use super::flight::Flight;
use super::planner::{Planner, PlannerState, Prospect};
use crate::aero::Aerodynamics;
use crate::frame::Inertial;
use crate::vehicle::Vehicle;

/// What the virtual flight does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Phase {
    /// Follows the reference.
    #[default]
    Tracking,
    /// Turns to an attitude far away, as across a fold.
    Crossing,
    /// Goes to the reference with its thrust at a limit.
    Coasting,
    /// Comes back from far off the reference: no error is within four of its bands.
    Recovering,
}

/// Why the velocity wanted cannot be had, as far as the prediction shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Unreachable {
    /// Sink steeper than the vehicle can at that speed.
    Sink,
    /// Lower speed than the vehicle can at that sink rate, with least thrust: a gap between two sheets.
    Speed,
    /// More thrust than there is.
    Thrust,
}

/// How far the guidance has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// Time \[s\] that a prediction spans.
const SPAN: f32 = 2.05;
/// Time to go \[s\] from which on an error is taken not to close.
const NEVER: f32 = 19.0;

impl Progress {
    /// The progress of a flight that is off the velocity wanted by `error` [m/s], with this prospect.
    pub(super) fn new<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        planner: &Planner,
        state: &PlannerState,
        flight: &Flight,
        prospect: &Prospect,
        error: Inertial,
    ) -> Self {
        let bands = |v: Inertial| {
            let down = v.down().abs() / planner.velocity_band.down();
            let forward = v.forward().abs() / planner.velocity_band.forward();
            (down, forward)
        };
        let (down, forward) = bands(error);
        let low = flight.thrust <= vehicle.thrust_min();
        let high = flight.thrust >= vehicle.thrust_max();
        let phase = if state.plan.turn == 1 {
            Phase::Crossing
        } else if down > 4.0 || forward > 4.0 {
            Phase::Recovering
        } else if (low || high) && (down > 0.5 || forward > 0.5) {
            Phase::Coasting
        } else {
            Phase::Tracking
        };
        let (end_down, end_forward) = bands(prospect.error);
        let to_go = prospect.to_go;
        let unreachable = if end_down > 1.0 && to_go.down() > NEVER {
            Some(if prospect.error.down() < 0.0 {
                Unreachable::Sink
            } else {
                Unreachable::Thrust
            })
        } else if end_forward > 1.0 && to_go.forward() > NEVER {
            Some(if prospect.thrust >= vehicle.thrust_max() {
                Unreachable::Thrust
            } else {
                Unreachable::Speed
            })
        } else {
            None
        };
        let longest = if to_go.down() > to_go.forward() {
            to_go.down()
        } else {
            to_go.forward()
        };
        let there = down < 0.5 && forward < 0.5 && end_down < 0.5 && end_forward < 0.5;
        Self {
            phase,
            unreachable,
            time: if there { 0.0 } else { SPAN + longest },
            distance: if there {
                0.0
            } else {
                prospect.distance + 0.5 * prospect.error.forward() * to_go.forward()
            },
        }
    }
}
