//! What a step of a mission says.

use super::response::{Response, Troubles};
use crate::guidance::{GuidanceInput, PlannerOptions};
use crate::math;
use crate::ned::{BodyRates, Ned};
use crate::spatial::Reference;

/// What is being done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Activity {
    /// On the ground, without thrust.
    #[default]
    Grounded,
    /// The thrust grows until it lifts off.
    Spooling,
    /// Straight up.
    Rising,
    /// A path at an airspeed.
    Flying,
    /// To a place and there, by its position.
    Hovering,
    /// Straight down, until it touches the ground.
    Descending,
    /// It has touched the ground: the thrust goes off.
    Touched,
}

impl Activity {
    /// Name for logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Grounded => "grounded",
            Self::Spooling => "spooling",
            Self::Rising => "rising",
            Self::Flying => "flying",
            Self::Hovering => "hovering",
            Self::Descending => "descending",
            Self::Touched => "touched",
        }
    }
}

/// What of an item cannot be done as asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Remark {
    /// The wind is stronger than the airspeed: the nose is held into it, and it drifts.
    Drifting,
    /// The way is steeper than the wing climbs or glides: what is left is flown in a spiral at its end.
    Steep,
    /// The turn does not fit between the neighbours: the waypoint is passed over.
    TightCorner,
    /// It has not lifted off with the most thrust of a take-off, or does not stand on its tail.
    NoLiftOff,
    /// The vehicle does not follow.
    NotFollowing,
    /// It is not armed.
    NotArmed,
    /// The place of landing waits until the vehicle is over it.
    NotOverPlace,
    /// There is more wind than the vehicle hovers, lands or takes off in: it waits, or circles on the wing.
    TooWindy,
}

impl Remark {
    /// Name for logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Drifting => "drifting",
            Self::Steep => "steep",
            Self::TightCorner => "tight_corner",
            Self::NoLiftOff => "no_lift_off",
            Self::NotFollowing => "not_following",
            Self::NotArmed => "not_armed",
            Self::NotOverPlace => "not_over_place",
            Self::TooWindy => "too_windy",
        }
    }
}

/// What of the guidance's command reaches the motors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Gate {
    /// Nothing: no thrust, no rotation. The guidance is not asked, and its state is that of power-on.
    #[default]
    Off,
    /// At most this thrust \[N\]. It stands on the ground.
    AtMost(f32),
    /// All.
    Open,
}

impl Gate {
    /// What is left of a thrust \[N\] and of body rates.
    pub fn pass(self, thrust: f32, rates: BodyRates) -> (f32, BodyRates) {
        match self {
            Self::Off => (0.0, BodyRates::default()),
            Self::AtMost(most) => {
                // Where there is little thrust, nothing turns it but the ground.
                let share = math::clamp(most / math::max(thrust, 1e-3), 0.0, 1.0);
                let BodyRates { roll, pitch, yaw } = rates;
                let rates = BodyRates::new(share * roll, share * pitch, share * yaw);
                (math::min(thrust, most), rates)
            }
            Self::Open => (thrust, rates),
        }
    }
}

/// How far a mission has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct MissionProgress {
    /// Item, counted from 0; the number of items when all are done.
    pub item: u16,
    /// Time since the item began \[s\].
    pub time: f32,
    /// Way to its end \[m\], and the time that takes \[s\].
    pub distance_to_go: f32,
    /// \[s\].
    pub time_to_go: f32,
    /// Of the items after it, legs alone \[m\]: one item is looked at a step, and until all are it is the last sum.
    pub distance_after: f32,
    /// \[s\].
    pub time_after: f32,
    /// Energy that the propellers have given the air, by momentum theory \[J\].
    pub energy: f32,
    /// How far the vehicle is to the right of its path \[m\].
    pub right: f32,
    /// Airspeed asked for [m/s]; 0 in hover.
    pub airspeed: f32,
    /// Thrust of steady flight at this airspeed, turn and climb \[N\]; the weight in hover, 0 on the ground.
    pub steady_thrust: f32,
    /// Load factor that the turn needs; 1 without.
    pub load_factor: f32,
    /// Whether the path is flown at the speed of its item, and not on the way to it.
    pub settled: bool,
}

/// What a step of a mission gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct MissionOutput {
    /// For the guidance.
    pub reference: Reference,
    /// Position less that of the reference \[m\]: on a path, across it and down alone.
    pub position_error: Ned,
    /// For the guidance.
    pub planner_options: PlannerOptions,
    /// What of the guidance's command reaches the motors.
    pub gate: Gate,
    /// What is done.
    pub activity: Activity,
    /// How far it has come.
    pub progress: MissionProgress,
    /// What cannot be done as asked.
    pub remark: Option<Remark>,
    /// What has failed.
    pub troubles: Troubles,
    /// What is done about it.
    pub response: Response,
}

impl MissionOutput {
    /// Asks for nothing.
    pub(super) fn clear(&mut self) {
        self.gate = Gate::Off;
        self.remark = None;
        self.reference = Reference::default();
        self.position_error = Ned::ZERO;
        self.planner_options = PlannerOptions::default();
        self.progress.distance_to_go = 0.0;
        self.progress.time_to_go = 0.0;
        self.progress.right = 0.0;
        self.progress.airspeed = 0.0;
        self.progress.steady_thrust = 0.0;
        self.progress.load_factor = 0.0;
        self.progress.settled = false;
    }

    /// The same `dt` \[s\] later, with the acceleration asked for, of a vehicle with this velocity [m/s].
    pub(super) fn go_on(&mut self, velocity: Ned, dt: f32) {
        self.position_error += (velocity - self.reference.velocity) * dt;
        self.reference.velocity += self.reference.acceleration * dt;
    }

    /// The guidance's input with what the mission asks for in it. Where the vehicle stands on the ground, the accelerometer feels
    /// the ground, and is left out.
    #[must_use]
    pub fn asked_of(&self, input: GuidanceInput) -> GuidanceInput {
        GuidanceInput {
            position_error: Some(self.position_error),
            reference: self.reference,
            reference_age: 0.0,
            planner_options: self.planner_options,
            specific_force: input.specific_force.filter(|_| self.gate == Gate::Open),
            ..input
        }
    }
}
