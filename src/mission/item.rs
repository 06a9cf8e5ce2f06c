//! The items of a mission, and why one is refused.

use core::fmt;

use super::ability::Ability;
use super::parameters::MissionParameters;
use super::segment::level;
use crate::math;
use crate::ned::Ned;

/// Most items of a mission.
pub const CAPACITY: usize = 128;
/// Places are no farther than this from where positions are counted from \[m\].
const FARTHEST: f32 = 1e5;
/// Longest times \[s\] and most turns.
const LONGEST: f32 = 1e6;

/// How a waypoint is passed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Pass {
    /// By it: an arc rounds the corner. Where it does not fit between the neighbours, over it.
    By,
    /// Over it, on the course of the longer of its two legs: of a line between two such waypoints all is flown.
    Over,
    /// It is stopped at, for a time \[s\].
    Hover(f32),
}

/// How long a loiter lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Until {
    /// So many turns.
    Turns(f32),
    /// For a time \[s\].
    Time(f32),
    /// For ever: until another mission.
    Forever,
}

/// One item of a mission.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Item {
    /// Straight up from where it stands, to a height over that \[m\].
    TakeOff {
        /// \[m\].
        height: f32,
    },
    /// To a place.
    Waypoint {
        /// \[m\].
        place: Ned,
        /// How it is passed.
        pass: Pass,
    },
    /// Round a place, on the wing, and until its height is reached.
    Loiter {
        /// \[m\].
        centre: Ned,
        /// Radius \[m\], to the right; negative to the left.
        radius: f32,
        /// How long.
        until: Until,
    },
    /// Airspeed from here on [m/s]. Below the least of the wing it is a speed over ground, in hover.
    Speed(f32),
    /// Another height, as a position \[m\] down: reached where the vehicle is, on the wing in a spiral.
    Altitude {
        /// \[m\].
        down: f32,
    },
    /// A landing, where the vehicle is or at a place, whose position down is the ground's.
    Land {
        /// \[m\].
        place: Option<Ned>,
    },
    /// Back to where it took off, and a landing there.
    Return,
}

/// What is wrong with a field of an item.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ItemProblem {
    /// More items than a mission holds.
    TooMany,
    /// Not finite, or outside these bounds.
    Range {
        /// Least.
        min: f32,
        /// Most.
        max: f32,
        /// Unit of both; empty for a pure number.
        unit: &'static str,
    },
    /// A place that is farther from home than this \[m\], on the level or in altitude, or not finite.
    Far {
        /// The greatest distance \[m\].
        most: f32,
    },
    /// A turn that is narrower than the vehicle can fly at the speed of the item \[m\].
    Narrow {
        /// The least radius \[m\].
        least: f32,
    },
    /// Slower than the wing carries [m/s].
    Slow {
        /// The least airspeed [m/s].
        least: f32,
    },
    /// Not the first item.
    NotFirst,
    /// No item follows a landing but a take-off.
    AfterLanding,
}

/// Why a mission is refused: which item, counted from 0, and which field of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct MissionError {
    /// Item, counted from 0.
    pub item: usize,
    /// Its field.
    pub field: &'static str,
    /// What is wrong with it.
    pub problem: ItemProblem,
}

impl fmt::Display for MissionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { item, field, .. } = self;
        write!(f, "item {item}: {field}: ")?;
        match self.problem {
            ItemProblem::TooMany => write!(f, "a mission has at most {CAPACITY} items"),
            ItemProblem::Range { min, max, unit } => {
                let space = if unit.is_empty() { "" } else { " " };
                write!(f, "must be from {min} to {max}{space}{unit}")
            }
            ItemProblem::Far { most } => write!(f, "must be within {most} m of home"),
            ItemProblem::Narrow { least } => {
                write!(f, "the vehicle turns on {least:.1} m at this speed")
            }
            ItemProblem::Slow { least } => {
                write!(f, "the wing carries from {least:.1} m/s on")
            }
            ItemProblem::NotFirst => {
                f.write_str("a take-off is the first item, or after a landing")
            }
            ItemProblem::AfterLanding => f.write_str("after a landing only a take-off"),
        }
    }
}

impl core::error::Error for MissionError {}

/// A list of items that has been checked against a vehicle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mission {
    items: heapless::Vec<Item, CAPACITY>,
}

/// A place \[m\] that is near enough.
fn near(field: &'static str, place: Ned) -> Result<(), (&'static str, ItemProblem)> {
    let distance = math::max(level(place), place.down.abs());
    // NaN is not near.
    if distance <= FARTHEST && level(place).is_finite() {
        Ok(())
    } else {
        Err((field, ItemProblem::Far { most: FARTHEST }))
    }
}

fn range(
    field: &'static str,
    value: f32,
    [min, max]: [f32; 2],
    unit: &'static str,
) -> Result<(), (&'static str, ItemProblem)> {
    if (min..=max).contains(&value) {
        Ok(())
    } else {
        Err((field, ItemProblem::Range { min, max, unit }))
    }
}

impl Mission {
    /// The items, checked: what a mission asks for can be flown.
    pub(super) fn new(
        items: &[Item],
        p: &MissionParameters,
        ability: &Ability,
    ) -> Result<Self, MissionError> {
        let items = heapless::Vec::from_slice(items).map_err(|_| MissionError {
            item: CAPACITY,
            field: "items",
            problem: ItemProblem::TooMany,
        })?;
        let mission = Self { items };
        let mut speed = p.cruise_speed;
        let mut landed = true;
        for (item, of) in mission.items.iter().enumerate() {
            mission
                .check(of, &mut speed, &mut landed, item, p, ability)
                .map_err(|(field, problem)| MissionError {
                    item,
                    field,
                    problem,
                })?;
        }
        Ok(mission)
    }

    fn check(
        &self,
        item: &Item,
        speed: &mut f32,
        landed: &mut bool,
        number: usize,
        p: &MissionParameters,
        ability: &Ability,
    ) -> Result<(), (&'static str, ItemProblem)> {
        let took_off = matches!(item, Item::TakeOff { .. });
        if took_off && !*landed {
            return Err(("take-off", ItemProblem::NotFirst));
        }
        if !took_off && *landed && number > 0 {
            return Err(("item", ItemProblem::AfterLanding));
        }
        *landed = matches!(item, Item::Land { .. } | Item::Return);
        match *item {
            Item::TakeOff { height } => range("height", height, [1.0, FARTHEST], "m"),
            Item::Waypoint { place, pass } => {
                if let Pass::Hover(time) = pass {
                    range("pass", time, [0.0, LONGEST], "s")?;
                }
                near("place", place)
            }
            Item::Loiter {
                centre,
                radius,
                until,
            } => {
                near("centre", centre)?;
                match until {
                    Until::Turns(x) => range("until", x, [0.0, LONGEST], "turns")?,
                    Until::Time(x) => range("until", x, [0.0, LONGEST], "s")?,
                    Until::Forever => {}
                }
                let least = ability.least_speed();
                if *speed < least {
                    return Err(("centre", ItemProblem::Slow { least }));
                }
                let least = *speed * *speed / ability.turn(*speed, p.tan_bank());
                // NaN is not narrower.
                range("radius", radius.abs(), [0.0, FARTHEST], "m")?;
                if radius.abs() < least {
                    return Err(("radius", ItemProblem::Narrow { least }));
                }
                Ok(())
            }
            Item::Speed(next) => {
                let most = ability.most_speed();
                range("speed", next, [0.5, most], "m/s")?;
                *speed = next;
                Ok(())
            }
            Item::Altitude { down } => range("down", down, [-FARTHEST, FARTHEST], "m"),
            Item::Land { place } => place.map_or(Ok(()), |place| near("place", place)),
            Item::Return => Ok(()),
        }
    }

    /// The items.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// The place of the first item from `from` on that has one.
    pub(super) fn next_place(&self, from: usize) -> Option<Ned> {
        self.items.iter().skip(from).find_map(|item| match item {
            Item::Waypoint { place, .. } => Some(*place),
            Item::Loiter { centre, .. } => Some(*centre),
            Item::Land { place } => *place,
            _ => None,
        })
    }
}

impl MissionParameters {
    /// Tangent of the bank of turns.
    pub(super) fn tan_bank(&self) -> f32 {
        let (sin, cos) = math::sin_cos(self.bank);
        sin / cos
    }
}
