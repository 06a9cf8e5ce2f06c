//! The guidance in space run open loop over an autopilot's log.

use std::io::Write;

use alula::guidance::Air;
use alula::ned::{BodyAxes, Quaternion};
use alula::spatial::{Heading, Orientation, Reference};
use alula::{GuidanceInput, GuidanceState};
use alula_logs::states::{Series, States};
use nalgebra::UnitQuaternion;

use super::columns::{Column, column};
use super::{Experiment, Record, SpatialState, Step, Target, V3, ned};

/// What is written.
const OUTPUTS: [&str; 11] = [
    "t_s",
    "thrust_n",
    "command_belly_rad_s",
    "command_wing_rad_s",
    "command_tail_rad_s",
    "margin_k",
    "margin_fold_rad",
    "mode",
    "phase",
    "unreachable",
    "status",
];

/// One row of a series, with its age \[s\]; none if there is no such series, or no number in the row.
fn at<const N: usize>(series: Option<&Series<N>>, row: usize) -> Option<([f64; N], f64)> {
    let series = series?;
    let value = series.values[row];
    let known = value.iter().all(|x| x.is_finite());
    known.then_some((value, series.age[row]))
}

/// Runs the guidance of `experiment` over `states`: each step, with what the log says for the truth, and in words what had to be assumed.
pub fn replay(states: &States, experiment: &Experiment) -> anyhow::Result<(Record, Vec<String>)> {
    if states.velocity.is_none() {
        let missing = states.missing.iter().map(ToString::to_string);
        anyhow::bail!("{}", missing.collect::<Vec<_>>().join("; "));
    }
    let guidance = experiment.controller.guidance(experiment)?;
    let mut memory = GuidanceState::default();
    let mut record = Record::with_capacity(states.time.len());
    let mut followed = 0;
    for (row, &t) in states.time.iter().enumerate() {
        let attitude = states.attitude.values[row];
        let [w, x, y, z] = attitude.map(|c| c as f32);
        let orientation =
            Orientation::from_quaternion(&Quaternion { w, x, y, z }, BodyAxes::NoseForward)
                .unwrap_or(Orientation::UNKNOWN);
        let unknown = ([f64::NAN; 3], f64::INFINITY);
        let (velocity, velocity_age) = at(states.velocity.as_ref(), row).unwrap_or(unknown);
        let setpoint = at(states.velocity_setpoint.as_ref(), row);
        followed += usize::from(setpoint.is_some());
        // Where the autopilot asks for no velocity, the one flown stands for it.
        let (reference, reference_age) = setpoint.unwrap_or((velocity, velocity_age));
        let acceleration = at(states.acceleration_setpoint.as_ref(), row);
        let acceleration = acceleration.filter(|_| setpoint.is_some());
        let position = at(states.position.as_ref(), row).map(|(x, _)| V3::from(x));
        let wanted = at(states.position_setpoint.as_ref(), row).map(|(x, _)| V3::from(x));
        let through = at(states.air_velocity.as_ref(), row).map(|(v, _)| V3::from(v));
        let wind = at(states.wind.as_ref(), row).map(|(w, _)| V3::from(w));
        let heading = at(states.heading_setpoint.as_ref(), row).map(|([heading], _)| heading);
        let force = at(states.specific_force.as_ref(), row).map(|(f, _)| f);
        let target = Target {
            position: wanted.unwrap_or(V3::repeat(f64::NAN)),
            velocity: reference.into(),
            acceleration: acceleration.map_or(V3::zeros(), |(a, _)| a.into()),
            heading,
        };
        let input = GuidanceInput {
            velocity: ned(velocity.into()),
            orientation,
            state_age: velocity_age.max(states.attitude.age[row]) as f32,
            air: match (through, wind) {
                (Some(v), _) => Air::Velocity(ned(v)),
                (None, Some(w)) => Air::Wind(ned(w)),
                (None, None) => Air::Unknown,
            },
            specific_force: force.map(|f| BodyAxes::NoseForward.vector(f.map(|c| c as f32))),
            position_error: position.zip(wanted).map(|(x, r)| ned(x - r)),
            reference: Reference {
                velocity: ned(target.velocity),
                acceleration: ned(target.acceleration),
                heading: heading.map_or(Heading::FREE, |h| Heading::from_angle(h as f32)),
            },
            reference_age: reference_age as f32,
        };
        let period = 1.0 / experiment.control_rate_hz;
        let dt = record.last().map_or(period, |last: &Step| t - last.t);
        let guided = guidance.update(&mut memory, &input, dt as f32);
        record.push(Step {
            t,
            truth: SpatialState {
                position: position.unwrap_or(V3::repeat(f64::NAN)),
                velocity: velocity.into(),
                attitude: hover_axes(&orientation),
                rates: V3::repeat(f64::NAN),
                thrust: f64::NAN,
            },
            wind: through
                .map_or(wind, |v| Some(V3::from(velocity) - v))
                .unwrap_or_default(),
            load_factor: force.map_or(f64::NAN, |f| {
                V3::from(f).norm() / experiment.vehicle.gravity_m_s2
            }),
            target,
            input,
            guided,
        });
    }
    let mut notes = states.notes.clone();
    notes.extend(states.missing.iter().map(ToString::to_string));
    let rows = states.time.len();
    if followed < rows {
        let flown = rows - followed;
        notes.push(format!(
            "no velocity asked for in {flown} of {rows} rows: the velocity flown stands for it there"
        ));
    }
    Ok((record, notes))
}

/// The quaternion of a record.
fn hover_axes(orientation: &Orientation) -> UnitQuaternion<f64> {
    let q = orientation.to_quaternion(BodyAxes::NoseUp);
    let [w, x, y, z] = [q.w, q.x, q.y, q.z].map(f64::from);
    UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z))
}

/// Writes the commands as CSV.
pub fn write(record: &[Step], to: impl Write) -> anyhow::Result<()> {
    let outputs: Vec<&Column> = OUTPUTS.iter().filter_map(|name| column(name)).collect();
    let mut writer = csv::Writer::from_writer(to);
    writer.write_record(outputs.iter().map(|column| column.name))?;
    let mut cell = Vec::new();
    for step in record {
        for column in &outputs {
            cell.clear();
            (column.read)(step).push(&mut cell);
            writer.write_field(&cell)?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    Ok(writer.flush()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Document;
    use crate::flight_log::Format;
    use crate::space::{flight_log, fly};

    #[test]
    fn what_is_written_is_declared() {
        for name in OUTPUTS {
            assert!(column(name).is_some(), "{name} is no column");
        }
    }

    /// A turn in a wind off every axis, with errors of every sensor, the air told as the velocity through it: the same commands from the flight's
    /// log as in flight, of each kind.
    #[test]
    fn a_flights_own_log_replays_to_the_commands_flown() {
        for air in ["velocity", "steady-wind", "none"] {
            let air = format!("sensors.air=\"{air}\"");
            let mut document = Document::load("circle-40").unwrap();
            for change in [
                "duration_s=20",
                "entry_s=0",
                "weather.steady_m_s=[1.5,-1.5,0.5]",
                "sensors.velocity_m_s.noise=0.05",
                "sensors.position_m.noise=0.05",
                "sensors.attitude_deg.noise=0.2",
                "sensors.acceleration_m_s2.noise=0.1",
                &air,
            ] {
                document.assign(change).unwrap();
            }
            let experiment = Experiment::of(&document).unwrap();
            let flown = fly(&experiment).unwrap();
            let log = flight_log::log(&flown).unwrap();
            for format in [Format::Ulog, Format::Mcap, Format::Csv] {
                let mut file = std::io::Cursor::new(Vec::new());
                format.write(&log, &mut file).unwrap();
                let bytes = file.get_ref();
                let log = match format {
                    Format::Ulog => alula_logs::ulog::read("x", bytes),
                    Format::Mcap => alula_logs::mcap::read("x", bytes),
                    Format::Csv => alula_logs::csv::read("x", bytes, None),
                };
                let states = alula_logs::states::find(&log.unwrap()).unwrap();
                same_commands(&flown, &states, &experiment, &format!("{air} {format:?}"));
            }
        }
    }

    fn same_commands(flown: &[Step], states: &States, experiment: &Experiment, what: &str) {
        let (replayed, _) = replay(states, experiment).unwrap();
        assert_eq!(flown.len(), replayed.len());
        let mut most = [0.0_f32; 2];
        for (a, b) in flown.iter().zip(&replayed) {
            let (a, b) = (a.guided.command, b.guided.command);
            let rates = a.rates - b.rates;
            most[0] = most[0].max((a.thrust - b.thrust).abs());
            most[1] = most[1].max(rates.norm_squared().sqrt());
        }
        println!("{what}: {most:?}");
        // Roundings of the attitude's quaternion in single precision, over 20 s of the guidance's memory, under noisy attitudes: 1e-3 of 200 N,
        // and 1e-3 rad/s. Found: 0.05 N and 3e-4 rad/s.
        assert!(most[0] < 0.2 && most[1] < 1e-3, "{what}: {most:?}");
        let mut csv = Vec::new();
        write(&replayed, &mut csv).unwrap();
        let text = String::from_utf8(csv).unwrap();
        assert_eq!(text.lines().count(), replayed.len() + 1);
    }
}
