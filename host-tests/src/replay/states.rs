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

/// A set-point that should have come so long ago \[s\] is asked for no longer.
const CEASED: f64 = 1.0;

/// How old a row of a series is \[s\]: since it should have come anew. A log that keeps every tenth value makes none old.
pub fn age<const N: usize>(series: &Series<N>, row: usize) -> f64 {
    (series.age[row] - series.interval).max(0.0)
}

/// One row of a series, with its age \[s\]; none if there is no such series, or no number in the row.
fn at<const N: usize>(series: Option<&Series<N>>, row: usize) -> Option<([f64; N], f64)> {
    let series = series?;
    let value = series.values[row];
    let known = value.iter().all(|x| x.is_finite());
    known.then_some((value, age(series, row)))
}

/// The same of what is asked for.
fn asked<const N: usize>(series: Option<&Series<N>>, row: usize) -> Option<([f64; N], f64)> {
    at(series, row).filter(|(_, age)| *age <= CEASED)
}

impl Row {
    /// The row of this number.
    pub fn of(states: &States, row: usize) -> Self {
        let value = |series| at(series, row).map(|(value, _)| value);
        let unknown = ([f64::NAN; 3], f64::INFINITY);
        let flown = at(states.velocity.as_ref(), row).unwrap_or(unknown);
        let setpoint = asked(states.velocity_setpoint.as_ref(), row);
        let (reference, reference_age) = setpoint.unwrap_or(flown);
        let acceleration = asked(states.acceleration_setpoint.as_ref(), row);
        Self {
            velocity: flown.0,
            velocity_age: flown.1,
            is_followed: setpoint.is_some(),
            reference,
            reference_age,
            acceleration: acceleration
                .filter(|_| setpoint.is_some())
                .map_or([0.0; 3], |(acceleration, _)| acceleration),
            position: value(states.position.as_ref()).map(V3::from),
            wanted: asked(states.position_setpoint.as_ref(), row).map(|(x, _)| V3::from(x)),
            heading: asked(states.heading_setpoint.as_ref(), row).map(|([heading], _)| heading),
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

#[cfg(test)]
mod tests {
    use super::*;
    use alula_logs::{Column, Log, Topic, states};

    /// As PX4 logs unless told otherwise: attitude every 50 ms, position and velocity every 100 ms; with a gap, and a velocity asked for every 100 ms
    /// until it ceases.
    #[test]
    fn what_the_log_thins_is_not_old_and_what_ceases_is_not_asked_for() {
        let topic = |name: &str, times: Vec<f64>, columns: &[(&str, f64)]| {
            let column =
                |&(name, value): &(&str, f64)| Column::new(name, "", vec![value; times.len()]);
            let columns = columns.iter().map(column).collect();
            Topic::new(name, 0, times, columns).unwrap()
        };
        let times = |every: f64, n: usize| (0..n).map(move |i| i as f64 * every);
        let nose_up = [("q[0]", 1.0), ("q[1]", 0.0), ("q[2]", 0.0), ("q[3]", 0.0)];
        let velocity = [
            ("vx", 1.0),
            ("vy", 0.0),
            ("vz", 0.0),
            ("x", 0.0),
            ("y", 0.0),
            ("z", 0.0),
        ];
        let asked = [
            ("velocity[0]", 1.0),
            ("velocity[1]", 0.0),
            ("velocity[2]", 0.0),
        ];
        let log = Log {
            topics: vec![
                topic("vehicle_attitude", times(0.05, 200).collect(), &nose_up),
                // Nothing from 2 to 3 s.
                topic(
                    "vehicle_local_position",
                    times(0.1, 100)
                        .filter(|t| !(2.05..2.95).contains(t))
                        .collect(),
                    &velocity,
                ),
                topic("trajectory_setpoint", times(0.1, 50).collect(), &asked),
            ],
            notes: Vec::new(),
        };
        let states = states::find(&log).unwrap();
        let row = |t: f64| Row::of(&states, (t / 0.05).round() as usize);
        assert!((0..40).all(|n| row(0.05 * f64::from(n)).velocity_age < 1e-9));
        // The gap is one: 0.9 s after the last, of which 0.1 s are usual.
        assert!((row(2.9).velocity_age - 0.8).abs() < 1e-9);
        // The last velocity asked for at 4.9 s.
        assert!(row(5.9).is_followed && !row(6.1).is_followed);
        assert_eq!(row(6.1).reference, row(6.1).velocity);
    }
}
