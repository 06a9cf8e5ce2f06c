//! Missions: what is to be flown from take-off to landing, in the core's own items.

use alula::mission::{Item, MissionParameters, Pass, Responses, Until};
use alula::ned::Ned;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::{Table, Value};

use super::document::{FieldError, finite, require};
use super::parameters::Fields;

/// `[mission]`. Heights are over the place of the start.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
pub struct MissionSpec {
    /// Its items.
    pub items: Vec<ItemSpec>,
    /// What is done when something fails.
    #[serde(default)]
    #[schemars(with = "std::collections::BTreeMap<String, String>")]
    pub responses: Responses,
    /// What fails, and when.
    #[serde(default)]
    pub troubles: Vec<TroubleSpec>,
    /// When it is armed \[s\].
    #[serde(default)]
    pub armed_s: f64,
    /// How it is flown: the core's own parameters. What is none of them is refused.
    #[serde(flatten)]
    #[schemars(skip)]
    pub parameters: Table,
}

/// `mission.items`: one item.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum ItemSpec {
    /// Straight up.
    TakeOff {
        /// \[m\].
        height_m: f64,
    },
    /// To a place.
    Waypoint {
        /// \[m\].
        north_m: f64,
        /// \[m\].
        east_m: f64,
        /// \[m\].
        height_m: f64,
        /// Whether it is flown over, and not by.
        #[serde(default)]
        over: bool,
        /// How long it is stopped at \[s\].
        hover_s: Option<f64>,
    },
    /// Round a place; for ever, if neither turns nor a time is given.
    Loiter {
        /// \[m\].
        north_m: f64,
        /// \[m\].
        east_m: f64,
        /// \[m\].
        height_m: f64,
        /// Radius \[m\], to the right; negative to the left.
        radius_m: f64,
        /// How often.
        turns: Option<f64>,
        /// How long \[s\].
        time_s: Option<f64>,
    },
    /// Airspeed from here on.
    Speed {
        /// \[m/s\].
        speed_m_s: f64,
    },
    /// Another height.
    Height {
        /// \[m\].
        height_m: f64,
    },
    /// A landing where it is, or at a place.
    Land {
        /// \[m\].
        north_m: Option<f64>,
        /// \[m\].
        east_m: Option<f64>,
    },
    /// Back to the start, and a landing there.
    Return,
}

/// `mission.troubles`: a failure that the mission is told of.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TroubleSpec {
    /// From when \[s\].
    pub t_s: f64,
    /// How long \[s\].
    pub lasts_s: f64,
    /// Which.
    pub kind: TroubleKind,
}

/// A failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TroubleKind {
    /// The link to whoever flies.
    Link,
    /// Nothing is known of the air. What the controller is told of it is a fault of the sensors.
    Air,
    /// The battery is low.
    Battery,
    /// Whoever flies wants it to stop.
    Abort,
    /// The position is not known.
    Position,
}

fn place(north: f64, east: f64, height: f64) -> Ned {
    Ned::new(north as f32, east as f32, -height as f32)
}

impl ItemSpec {
    /// What it is, in a word.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::TakeOff { .. } => "take-off",
            Self::Waypoint {
                hover_s: Some(_), ..
            } => "hover",
            Self::Waypoint { .. } => "waypoint",
            Self::Loiter { .. } => "loiter",
            Self::Speed { .. } => "speed",
            Self::Height { .. } => "height",
            Self::Land { .. } => "land",
            Self::Return => "return",
        }
    }

    /// The core's item. What the core refuses, it refuses by item and field.
    pub(crate) fn item(&self) -> Result<Item, (&'static str, &'static str)> {
        Ok(match *self {
            Self::TakeOff { height_m } => Item::TakeOff {
                height: height_m as f32,
            },
            Self::Waypoint {
                north_m,
                east_m,
                height_m,
                over,
                hover_s,
            } => Item::Waypoint {
                place: place(north_m, east_m, height_m),
                pass: match (hover_s, over) {
                    (Some(_), true) => {
                        return Err(("over", "a waypoint is stopped at or flown over"));
                    }
                    (Some(time), false) => Pass::Hover(time as f32),
                    (None, true) => Pass::Over,
                    (None, false) => Pass::By,
                },
            },
            Self::Loiter {
                north_m,
                east_m,
                height_m,
                radius_m,
                turns,
                time_s,
            } => Item::Loiter {
                centre: place(north_m, east_m, height_m),
                radius: radius_m as f32,
                until: match (turns, time_s) {
                    (Some(_), Some(_)) => return Err(("turns", "turns or a time, not both")),
                    (Some(turns), None) => Until::Turns(turns as f32),
                    (None, Some(time)) => Until::Time(time as f32),
                    (None, None) => Until::Forever,
                },
            },
            Self::Speed { speed_m_s } => Item::Speed(speed_m_s as f32),
            Self::Height { height_m } => Item::Altitude {
                down: -height_m as f32,
            },
            Self::Land { north_m, east_m } => Item::Land {
                place: match (north_m, east_m) {
                    (Some(north), Some(east)) => Some(place(north, east, 0.0)),
                    (None, None) => None,
                    _ => return Err(("north_m", "a place has north_m and east_m")),
                },
            },
            Self::Return => Item::Return,
        })
    }
}

impl MissionSpec {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        finite("mission.armed_s", self.armed_s)?;
        for (i, trouble) in self.troubles.iter().enumerate() {
            finite(&format!("mission.troubles[{i}].t_s"), trouble.t_s)?;
            finite(&format!("mission.troubles[{i}].lasts_s"), trouble.lasts_s)?;
        }
        self.parameters().map_err(|e| e.inside("mission"))?;
        require(
            !self.items.is_empty(),
            "mission.items",
            "must have an item at least",
        )
    }

    /// How it is flown.
    pub(crate) fn parameters(&self) -> Result<MissionParameters, FieldError> {
        let mut fields = Fields::new(Value::Table(self.parameters.clone()))?;
        let parameters = fields.parameters();
        parameters.and_then(|parameters| fields.end().map(|()| parameters))
    }

    /// Whether a take-off comes first: the flight begins on the ground.
    pub fn takes_off(&self) -> bool {
        matches!(self.items.first(), Some(ItemSpec::TakeOff { .. }))
    }
}
