//! What an autopilot's log tells a controller, row by row.

use alula::guidance::Air;
use alula::ned::BodyAxes;
use alula::spatial::Body;
use alula_logs::states::{Series, States};
use anyhow::bail;

use crate::space::V3;

/// A row of the states. World vectors are north-east-down.
pub struct Row {
    /// v \[m/s\]; NaN if it is not known.
    pub velocity: [f64; 3],
    /// Its age \[s\].
    pub velocity_age: f64,
    /// Whether the autopilot asks for a velocity. Where it asks for none, the one flown stands for it.
    pub is_followed: bool,
    /// v_r \[m/s\].
    pub reference: [f64; 3],
    /// Its age \[s\].
    pub reference_age: f64,
    /// a_r \[m/s²\].
    pub acceleration: [f64; 3],
    /// x \[m\].
    pub position: Option<V3>,
    /// x_r \[m\].
    pub wanted: Option<V3>,
    /// Heading asked for \[rad\].
    pub heading: Option<f64>,
    /// Wind \[m/s\].
    wind: Option<[f64; 3]>,
    /// Velocity through the air \[m/s\].
    through: Option<[f64; 3]>,
    /// Specific force along nose, right wing and belly \[m/s²\].
    pub specific_force: Option<[f64; 3]>,
}

/// One row of a series, with its age \[s\]; none if there is no such series, or no number in the row.
fn at<const N: usize>(series: Option<&Series<N>>, row: usize) -> Option<([f64; N], f64)> {
    let series = series?;
    let value = series.values[row];
    let known = value.iter().all(|x| x.is_finite());
    known.then_some((value, series.age[row]))
}

impl Row {
    /// The row of this number.
    pub fn of(states: &States, row: usize) -> Self {
        let value = |series| at(series, row).map(|(value, _)| value);
        let unknown = ([f64::NAN; 3], f64::INFINITY);
        let flown = at(states.velocity.as_ref(), row).unwrap_or(unknown);
        let setpoint = at(states.velocity_setpoint.as_ref(), row);
        let (reference, reference_age) = setpoint.unwrap_or(flown);
        let acceleration = value(states.acceleration_setpoint.as_ref());
        Self {
            velocity: flown.0,
            velocity_age: flown.1,
            is_followed: setpoint.is_some(),
            reference,
            reference_age,
            acceleration: acceleration
                .filter(|_| setpoint.is_some())
                .unwrap_or_default(),
            position: value(states.position.as_ref()).map(V3::from),
            wanted: value(states.position_setpoint.as_ref()).map(V3::from),
            heading: at(states.heading_setpoint.as_ref(), row).map(|([heading], _)| heading),
            wind: value(states.wind.as_ref()),
            through: value(states.air_velocity.as_ref()),
            specific_force: value(states.specific_force.as_ref()),
        }
    }

    /// x − x_r \[m\], if both are known.
    pub fn position_error(&self) -> Option<V3> {
        self.position.zip(self.wanted).map(|(x, r)| x - r)
    }

    /// What is known of the air, in the axes of `within`. The velocity through it goes before the wind.
    pub fn air<V>(&self, within: impl Fn([f64; 3]) -> V) -> Air<V> {
        match (self.through, self.wind) {
            (Some(velocity), _) => Air::Velocity(within(velocity)),
            (None, Some(wind)) => Air::Wind(within(wind)),
            (None, None) => Air::Unknown,
        }
    }

    /// The wind \[m/s\], if it is known.
    pub fn wind(&self) -> Option<[f64; 3]> {
        let through = self.through.map(V3::from);
        let wind = through.map(|v| (V3::from(self.velocity) - v).into());
        wind.or(self.wind)
    }

    /// The specific force along the core's body axes \[m/s²\].
    pub fn force(&self) -> Option<Body> {
        let force = self.specific_force?;
        Some(BodyAxes::NoseForward.vector(force.map(|c| c as f32)))
    }
}

/// Without a velocity there is nothing to replay.
pub fn check(states: &States) -> anyhow::Result<()> {
    if states.velocity.is_none() {
        let missing = states.missing.iter().map(ToString::to_string);
        bail!("{}", missing.collect::<Vec<_>>().join("; "));
    }
    Ok(())
}

/// What had to be assumed of the states, where the autopilot asked for a velocity in `followed` rows.
pub fn notes(states: &States, followed: usize) -> Vec<String> {
    let mut notes = states.notes.clone();
    notes.extend(states.missing.iter().map(ToString::to_string));
    let rows = states.time.len();
    if followed < rows {
        let flown = rows - followed;
        notes.push(format!(
            "no velocity asked for in {flown} of {rows} rows: the velocity flown stands for it there"
        ));
    }
    notes
}
