//! What an autopilot's log tells a controller, row by row.

use alula::guidance::Air;
use alula::ned::BodyAxes;
use alula::ned::Frd;
use alula_logs::states::{CEASED, Series, States};
use anyhow::bail;

use super::unknown::Unknown;
use crate::experiment::V3;

/// A row of the states. World vectors are north-east-down.
pub struct Row {
    /// v \[m/s\]; NaN if it is not known.
    pub velocity: [f64; 3],
    /// Its age \[s\].
    pub velocity_age: f64,
    /// Whether the autopilot asks for a velocity, and whether on some axes alone. Where it asks for none, the one flown stands for it, or rest
    /// on an axis on which it asks for a position.
    pub is_followed: bool,
    /// See `is_followed`.
    pub is_partly: bool,
    /// v_r \[m/s\].
    pub reference: [f64; 3],
    /// Its age \[s\].
    pub reference_age: f64,
    /// a_r \[m/s²\].
    pub acceleration: [f64; 3],
    /// x \[m\]; NaN on an axis on which it is not known.
    pub position: Option<V3>,
    /// x_r \[m\]; NaN on an axis on which none is asked for.
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

/// One row of a series, with its age \[s\], if any component of it is known: the others are NaN.
fn any<const N: usize>(series: Option<&Series<N>>, row: usize) -> Option<([f64; N], f64)> {
    let series = series?;
    let value = series.values[row];
    let known = value.iter().any(|x| x.is_finite());
    known.then_some((value, series.overdue(row)))
}

/// The same if every component is known.
fn at<const N: usize>(series: Option<&Series<N>>, row: usize) -> Option<([f64; N], f64)> {
    any(series, row).filter(|(value, _)| value.iter().all(|x| x.is_finite()))
}

/// The same of what is asked for, on any axis.
fn asked<const N: usize>(series: Option<&Series<N>>, row: usize) -> Option<([f64; N], f64)> {
    any(series, row).filter(|(_, age)| *age <= CEASED)
}

impl Row {
    /// The row of this number.
    pub fn of(states: &States, row: usize) -> Self {
        let value = |series| at(series, row).map(|(value, _)| value);
        let unknown = ([f64::NAN; 3], f64::INFINITY);
        let velocity = at(states.velocity.as_ref(), row).unwrap_or(unknown);
        let wanted = asked(states.position_setpoint.as_ref(), row);
        // An autopilot that logs no velocity asked for may ask for one, and one that logs it without a number does not.
        let logged = states.velocity_setpoint.is_some();
        let held = wanted.filter(|_| logged);
        let setpoint = asked(states.velocity_setpoint.as_ref(), row).or_else(|| {
            let (_, age) = held?;
            Some(([f64::NAN; 3], age))
        });
        let asked_on = |i: usize| {
            let own = setpoint.map(|(v, _)| v[i]).filter(|v| v.is_finite());
            let rest = held.filter(|(x, _)| x[i].is_finite()).map(|_| 0.0);
            own.or(rest)
        };
        let reference = std::array::from_fn(|i| asked_on(i).unwrap_or(velocity.0[i]));
        let axes = (0..3).filter(|i| asked_on(*i).is_some()).count();
        let acceleration = asked(states.acceleration_setpoint.as_ref(), row);
        let or_none = |x: f64| if x.is_finite() { x } else { 0.0 };
        Self {
            velocity: velocity.0,
            velocity_age: velocity.1,
            is_followed: axes > 0,
            is_partly: axes > 0 && axes < 3,
            reference,
            reference_age: setpoint.unwrap_or(velocity).1,
            acceleration: acceleration
                .filter(|_| axes > 0)
                .map_or([0.0; 3], |(acceleration, _)| acceleration.map(or_none)),
            position: any(states.position.as_ref(), row).map(|(x, _)| V3::from(x)),
            wanted: wanted.map(|(x, _)| V3::from(x)),
            heading: asked(states.heading_setpoint.as_ref(), row).map(|([heading], _)| heading),
            wind: value(states.wind.as_ref()),
            through: value(states.air_velocity.as_ref()),
            specific_force: value(states.specific_force.as_ref()),
        }
    }

    /// x − x_r \[m\], if both are known on any axis; 0 on the others, on which no position is held.
    pub fn position_error(&self) -> Option<V3> {
        let error = self.position? - self.wanted?;
        let known = error.iter().any(|e| e.is_finite());
        known.then(|| error.map(|e| if e.is_finite() { e } else { 0.0 }))
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

    /// The specific force \[m/s²\].
    pub fn force(&self) -> Option<Frd> {
        let force = self.specific_force?;
        Some(BodyAxes::NoseForward.vector(force.map(|c| c as f32)))
    }
}

/// Without a velocity there is nothing to replay.
pub fn check(states: &States) -> anyhow::Result<()> {
    if states.velocity.is_none() {
        // What the reader left out may be the cause: it stands before the names that were looked for.
        let missing = states.missing.iter().filter(|m| m.what == "velocity");
        let all = states.notes.iter().cloned();
        let all = all.chain(missing.map(ToString::to_string));
        bail!("{}", all.collect::<Vec<_>>().join("; "));
    }
    Ok(())
}

/// In how many rows the autopilot asked for a velocity, and in how many on some axes alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct Followed {
    any: usize,
    partly: usize,
}

impl Followed {
    /// Counts a row.
    pub fn count(&mut self, row: &Row) {
        self.any += usize::from(row.is_followed);
        self.partly += usize::from(row.is_partly);
    }
}

/// What had to be assumed of the states, where the autopilot asked for a velocity in the rows `followed`.
pub fn notes(states: &States, followed: Followed) -> Vec<String> {
    let mut notes = states.notes.clone();
    notes.extend(states.missing.iter().map(ToString::to_string));
    let rows = states.time.len();
    let (mut velocity, mut attitude) = (Unknown::of("velocity"), Unknown::of("attitude"));
    for (row, t) in states.time.iter().enumerate() {
        let known = states.velocity.as_ref().map(|series| series.values[row]);
        velocity.count(
            *t,
            ["north", "east", "down"],
            known.unwrap_or([f64::NAN; 3]),
        );
        attitude.count(*t, ["w", "x", "y", "z"], states.attitude.values[row]);
    }
    notes.extend(
        [velocity, attitude]
            .iter()
            .filter_map(|unknown| unknown.note(rows)),
    );
    if followed.any < rows {
        let missing = rows - followed.any;
        notes.push(format!(
            "no velocity asked for in {missing} of {rows} rows: the velocity flown stands for it there"
        ));
    }
    if followed.partly > 0 {
        notes.push(format!(
            "a velocity asked for on some axes alone in {} of {rows} rows: on the others the velocity flown stands for it",
            followed.partly
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

    /// PX4's habit: NaN where nothing is asked for. The other axes are asked for all the same, and a position on an axis is rest there.
    #[test]
    fn what_is_asked_for_on_some_axes_is_followed_there() {
        let nan = f64::NAN;
        let topic = |name: &str, columns: &[(&str, f64)]| {
            let column = |&(name, value): &(&str, f64)| Column::new(name, "", vec![value]);
            let columns = columns.iter().map(column).collect();
            Topic::new(name, 0, vec![0.0], columns).unwrap()
        };
        let row = |position: [f64; 3], asked: [f64; 3], wanted: [f64; 3]| {
            let topics = vec![
                topic(
                    "vehicle_attitude",
                    &[("q[0]", 1.0), ("q[1]", 0.0), ("q[2]", 0.0), ("q[3]", 0.0)],
                ),
                topic(
                    "vehicle_local_position",
                    &[
                        ("x", position[0]),
                        ("y", position[1]),
                        ("z", position[2]),
                        ("vx", 1.0),
                        ("vy", 2.0),
                        ("vz", 3.0),
                    ],
                ),
                topic(
                    "trajectory_setpoint",
                    &[
                        ("velocity[0]", asked[0]),
                        ("velocity[1]", asked[1]),
                        ("velocity[2]", asked[2]),
                        ("position[0]", wanted[0]),
                        ("position[1]", wanted[1]),
                        ("position[2]", wanted[2]),
                        ("acceleration[0]", 0.5),
                        ("acceleration[1]", nan),
                        ("acceleration[2]", nan),
                    ],
                ),
            ];
            let log = Log {
                topics,
                notes: Vec::new(),
            };
            Row::of(&states::find(&log).unwrap(), 0)
        };
        let level = row([7.0, 8.0, -20.0], [5.0, 0.0, nan], [nan, nan, -25.0]);
        assert_eq!(level.reference, [5.0, 0.0, 0.0]);
        assert_eq!(level.acceleration, [0.5, 0.0, 0.0]);
        assert_eq!(level.position_error(), Some(V3::new(0.0, 0.0, 5.0)));
        assert!(level.is_followed && !level.is_partly);
        // Nothing at all is asked for downwards.
        let free = row([7.0, 8.0, -20.0], [5.0, 0.0, nan], [nan; 3]);
        assert_eq!(free.reference, [5.0, 0.0, 3.0]);
        assert!(free.is_followed && free.is_partly && free.position_error().is_none());
        // A place to hold, without a velocity; and an altitude, where that alone is known.
        let hold = row([7.0, 8.0, -20.0], [nan; 3], [6.0, 8.0, -20.0]);
        assert_eq!((hold.reference, hold.is_followed), ([0.0; 3], true));
        let baro = row([nan, nan, -20.0], [5.0, 0.0, 0.0], [1.0, 2.0, -25.0]);
        assert_eq!(baro.position_error(), Some(V3::new(0.0, 0.0, 5.0)));
        let none = row([7.0, 8.0, -20.0], [nan; 3], [nan; 3]);
        assert_eq!((none.reference, none.is_followed), ([1.0, 2.0, 3.0], false));
    }

    /// A velocity that lacks one axis is none: which, in how many rows and when, is said.
    #[test]
    fn a_missing_axis_is_said() {
        let column = |name: &str, values: [f64; 3]| Column::new(name, "", values.to_vec());
        let columns = vec![
            column("qw", [1.0; 3]),
            column("qx", [0.0; 3]),
            column("qy", [0.0; 3]),
            column("qz", [0.0; 3]),
            column("vn", [5.0; 3]),
            column("ve", [0.0; 3]),
            column("vd", [0.0, f64::NAN, f64::NAN]),
        ];
        let topic = Topic::new("csv", 0, vec![1.0, 1.1, 1.2], columns).unwrap();
        let log = Log {
            topics: vec![topic],
            notes: Vec::new(),
        };
        let notes = notes(&states::find(&log).unwrap(), Followed::default());
        let wanted = "velocity not known in 2 of 3 rows, from 1.1 to 1.2 s (down)";
        assert!(
            notes.iter().any(|note| note.starts_with(wanted)),
            "{notes:?}"
        );
        assert!(
            !notes
                .iter()
                .any(|note| note.starts_with("attitude not known"))
        );
    }
}
