//! The state of a flight on one time base, found under the names that autopilots log it by.
//!
//! Which topic and field, in which order of preference, and where that was read: the tables in `states/px4.rs` and
//! `states/ardupilot.rs`. A table of neither, such as a CSV with a column map, has them as
//!
//! | columns | quantity |
//! |---|---|
//! | `qw qx qy qz`, or `roll pitch yaw` in deg or rad, each as its own unit says, pitch to 90.5° | attitude |
//! | `vn ve vd` [m/s], `pn pe pd` \[m\], `wn we wd` [m/s] | velocity, position, wind: north, east, down |
//! | `van vae vad` [m/s] | velocity through the air |
//! | `fx fy fz` [m/s²] | specific force: nose, right wing, belly |
//! | `airspeed` [m/s] | airspeed |
//! | `qw_sp …` or `roll_sp …`, `pn_sp …`, `vn_sp …`, `an_sp …` [m/s²], `heading_sp` \[rad\] | set-points of attitude, position, velocity, acceleration, heading |
//!
//! A unit that is another than these is refused. Roll and yaw may go on beyond a turn.
//!
//! A flight that alula logged holds the topic [`TOLD`]: what its controller was told, which goes before what the vehicle did.

mod ardupilot;
mod attitude;
mod in_force;
mod plain;
mod px4;
mod source;

pub use attitude::{Quaternion, multiply};

use crate::Log;
use in_force::Topics;
use source::Source;
use std::borrow::Cow;
use std::fmt;

/// A quantity of `N` components at each time of the base: the last value logged.
#[derive(Clone, Debug, PartialEq)]
pub struct Series<const N: usize> {
    /// Where it was found: `vehicle_attitude.q[0]` and so on.
    pub source: String,
    /// The components; NaN before the first value.
    pub values: Vec<[f64; N]>,
    /// Time since the value was logged \[s\]; infinite before the first.
    pub age: Vec<f64>,
    /// Usual time between two values in the log \[s\], the median; 0 if there are fewer than two.
    pub interval: f64,
}

/// A set-point that should have come so long ago \[s\] is asked for no longer.
pub const CEASED: f64 = 1.0;

impl<const N: usize> Series<N> {
    /// How long ago a row should have come anew \[s\]. A log that keeps every tenth value makes none old.
    #[must_use]
    pub fn overdue(&self, row: usize) -> f64 {
        (self.age[row] - self.interval).max(0.0)
    }
}

/// The state and the set-points of a flight. All vectors are north, east, down.
#[derive(Clone, Debug, PartialEq)]
pub struct States {
    /// The autopilot whose names were found: `PX4`, `ArduPilot` or `plain`.
    pub family: &'static str,
    /// The time base \[s\]: each row of the topic that holds the attitude.
    pub time: Vec<f64>,
    /// Attitude, a unit quaternion w, x, y, z from the body to north-east-down. The body's x axis points along the nose,
    /// y to the right wing: what PX4 logs of a tail-sitter in its hover frame is turned into this one.
    pub attitude: Series<4>,
    /// Whether the log's rates and torques in hover are about the axes of hover, x to the belly and z to the tail: PX4's of a tail-sitter, and ArduPilot's
    /// (`AP_AHRS_View`). Else they are about those of [`States::attitude`].
    pub axes_of_hover: bool,
    /// Velocity over ground [m/s].
    pub velocity: Option<Series<3>>,
    /// Position from the log's own origin \[m\].
    pub position: Option<Series<3>>,
    /// Velocity of the air over ground [m/s]. Estimators know no vertical wind: down is 0.
    pub wind: Option<Series<3>>,
    /// Velocity through the air [m/s], where it is logged itself: as the controller was told it.
    pub air_velocity: Option<Series<3>>,
    /// Airspeed as a sensor or the autopilot gives it [m/s].
    pub airspeed: Option<Series<1>>,
    /// Specific force [m/s²], along the axes of [`States::attitude`]: nose, right wing, belly.
    pub specific_force: Option<Series<3>>,
    /// Attitude asked for, in the frame of [`States::attitude`].
    pub attitude_setpoint: Option<Series<4>>,
    /// Position asked for \[m\]. NaN where the autopilot asks for none, as in the other set-points.
    pub position_setpoint: Option<Series<3>>,
    /// Velocity asked for [m/s].
    pub velocity_setpoint: Option<Series<3>>,
    /// Acceleration asked for [m/s²].
    pub acceleration_setpoint: Option<Series<3>>,
    /// Heading asked for \[rad\], where alula logged it.
    pub heading_setpoint: Option<Series<1>>,
    /// What was not found, and where it was looked for.
    pub missing: Vec<Missing>,
    /// What the reader of these states must know of them.
    pub notes: Vec<String>,
}

/// A quantity that the log does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// The quantity, or what of it is not known.
    pub what: Cow<'static, str>,
    /// The columns that would have held it, in the order in which they were looked for.
    pub tried: Vec<String>,
}

impl Missing {
    /// The columns that were looked for, in words, if any were.
    #[must_use]
    pub fn looked_for(&self) -> Option<String> {
        (!self.tried.is_empty()).then(|| format!("none of {}", self.tried.join(", ")))
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no {}", self.what)?;
        match self.looked_for() {
            Some(tried) => write!(f, ": {tried}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Missing {}

/// The topic of what a controller of alula was told: `q[0]` to `q[3]` as in `vehicle_attitude`; `v`, `x`, `wind` and `air` of three components,
/// north-east-down: velocity [m/s], position \[m\], wind [m/s] or velocity through the air [m/s], whichever was told; `heading` \[rad\] as asked for.
/// What was not told is NaN.
pub const TOLD: &str = "alula_told";

/// Where a family of logs keeps each quantity, the best source first.
struct Family {
    name: &'static str,
    attitude: &'static [Source],
    velocity: &'static [Source],
    position: &'static [Source],
    wind: &'static [Source],
    air_velocity: &'static [Source],
    airspeed: &'static [Source],
    specific_force: &'static [Source],
    attitude_setpoint: &'static [Source],
    position_setpoint: &'static [Source],
    velocity_setpoint: &'static [Source],
    acceleration_setpoint: &'static [Source],
    heading_setpoint: &'static [Source],
}

/// The families, in the order in which they are looked for.
const FAMILIES: [Family; 3] = [px4::FAMILY, ardupilot::FAMILY, plain::FAMILY];

impl Family {
    /// All of its sources.
    fn sources(&self) -> impl Iterator<Item = &Source> {
        [
            self.attitude,
            self.velocity,
            self.position,
            self.wind,
            self.air_velocity,
            self.airspeed,
            self.specific_force,
            self.attitude_setpoint,
            self.position_setpoint,
            self.velocity_setpoint,
            self.acceleration_setpoint,
            self.heading_setpoint,
        ]
        .into_iter()
        .flatten()
    }
}

/// The columns of the topic `topic` that are looked for; of a topic of no autopilot's, such as a CSV, those of a plain table.
#[must_use]
pub fn names(topic: &str) -> Vec<&'static str> {
    let of = |topic: &str| {
        let sources = FAMILIES.iter().flat_map(Family::sources);
        let mut names: Vec<&str> = Vec::new();
        for name in sources.flat_map(|source| source.names_in(topic)) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    };
    let own = of(topic);
    if own.is_empty() { of("") } else { own }
}

/// Finds the states in `log`.
///
/// # Errors
/// No attitude under any name that is looked for. Every other quantity may be missing and is then named.
pub fn find(log: &Log) -> Result<States, Missing> {
    let families = FAMILIES;
    let topics = &Topics::new(log);
    let Some((family, found)) = families.iter().find_map(|family| {
        Some((
            family,
            family
                .attitude
                .iter()
                .find_map(|source| source.find(topics))?,
        ))
    }) else {
        let sources = || families.iter().flat_map(|family| family.attitude);
        // The one that is nearly there is meant.
        let parts = sources().map(|source| source.parts(topics));
        let nearest = parts
            .filter(|[has, _]| !has.is_empty())
            .min_by_key(|[_, lacks]| lacks.len());
        let what = nearest.map_or("attitude".to_owned(), |[has, lacks]| {
            format!("{} beside {}: no attitude", lacks.join(" "), has.join(" "))
        });
        return Err(Missing {
            what: what.into(),
            tried: sources().map(Source::to_string).collect(),
        });
    };
    if family.name == plain::FAMILY.name
        && let Some(what) = plain::doubt(topics)
    {
        return Err(Missing {
            what: what.into(),
            tried: Vec::new(),
        });
    }
    let time = found.base().to_vec();
    let mut notes = Vec::new();
    if family.name == ardupilot::FAMILY.name {
        notes.clone_from(&topics.notes);
    }
    let mut missing = Vec::new();

    let turn = px4::turn(log);
    if turn.is_some() {
        notes.push("attitude turned from PX4's hover frame of a tail-sitter to the nose".into());
    } else if family.name == px4::FAMILY.name && log.topic(TOLD).is_none() {
        notes.push(px4::NOT_TURNED.into());
    }
    let turned = |mut series: Series<4>| {
        if let Some(turn) = turn {
            series
                .values
                .iter_mut()
                .for_each(|q| *q = multiply(*q, turn));
        }
        series
    };
    let attitude = turned(found.held(&time));
    if family.name == ardupilot::FAMILY.name && attitude.source.starts_with("ATT.") {
        notes.push(ardupilot::ATT_NOTE.into());
    }
    let velocity = source::first(topics, &time, "velocity", family.velocity, &mut missing);
    if velocity
        .as_ref()
        .is_some_and(|v: &Series<3>| v.source.starts_with("GPS."))
    {
        notes.push(ardupilot::GPS_NOTE.into());
    }
    Ok(States {
        family: family.name,
        axes_of_hover: turn.is_some() || family.name == ardupilot::FAMILY.name,
        velocity,
        position: source::first(topics, &time, "position", family.position, &mut missing),
        wind: source::first(topics, &time, "wind", family.wind, &mut missing),
        // No autopilot logs these two: they are not missed.
        air_velocity: source::any(topics, &time, family.air_velocity),
        heading_setpoint: source::any(topics, &time, family.heading_setpoint),
        airspeed: source::first(topics, &time, "airspeed", family.airspeed, &mut missing),
        specific_force: source::first(
            topics,
            &time,
            "specific force",
            family.specific_force,
            &mut missing,
        )
        .map(|mut series| {
            if turn.is_some() {
                // From belly, wing and tail.
                series
                    .values
                    .iter_mut()
                    .for_each(|[x, _, z]| (*x, *z) = (-*z, *x));
            }
            series
        }),
        attitude_setpoint: source::first(
            topics,
            &time,
            "attitude set-point",
            family.attitude_setpoint,
            &mut missing,
        )
        .map(turned),
        position_setpoint: source::each(
            topics,
            &time,
            "position set-point",
            family.position_setpoint,
            &mut missing,
        ),
        velocity_setpoint: source::each(
            topics,
            &time,
            "velocity set-point",
            family.velocity_setpoint,
            &mut missing,
        ),
        acceleration_setpoint: source::each(
            topics,
            &time,
            "acceleration set-point",
            family.acceleration_setpoint,
            &mut missing,
        ),
        attitude,
        time,
        missing,
        notes,
    })
}
