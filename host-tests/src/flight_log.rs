//! A record as a flight log, for ULog and MCAP: the columns of the trace, and the flight under the names that PX4 logs it by.
//!
//! The flight heads north: forward is north. Time is counted from [`BEGIN`], as viewers take a row at 0 for one that was never filled in.

use std::io::{BufWriter, Seek, Write};

use alula_logs::{Column, Log, Topic};

use crate::columns::{COLUMNS, Cell};
use crate::experiment::Experiment;
use crate::simulate::Step;

/// Time in the log at the start of the flight \[s\].
pub const BEGIN: f64 = 1.0;

/// The topic that holds the columns of the trace, but for those of words.
pub const TRACE: &str = "alula";

/// Formats that a flight is left in beside its trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// ULog.
    Ulog,
    /// MCAP.
    Mcap,
}

impl Format {
    /// The name of the file.
    pub fn file(self) -> &'static str {
        match self {
            Self::Ulog => "flight.ulg",
            Self::Mcap => "flight.mcap",
        }
    }

    /// Writes `log` `to` a file.
    pub fn write(self, log: &Log, to: impl Write + Seek) -> anyhow::Result<()> {
        let to = BufWriter::new(to);
        match self {
            Self::Ulog => alula_logs::ulog::write(log, to)?,
            Self::Mcap => alula_logs::mcap::write(log, to)?,
        }
        Ok(())
    }
}

/// The unit that the end of a column's name says.
fn unit(name: &str) -> &'static str {
    const ENDS: [(&str, &str); 8] = [
        ("_m_s3", "m/s^3"),
        ("_m_s2", "m/s^2"),
        ("_m_s", "m/s"),
        ("_rad_s", "rad/s"),
        ("_rad", "rad"),
        ("_m", "m"),
        ("_n", "N"),
        ("_s", "s"),
    ];
    let end = ENDS.iter().find(|(end, _)| name.ends_with(end));
    end.map_or("", |(_, unit)| unit)
}

/// The record as a log.
pub fn log(experiment: &Experiment, record: &[Step]) -> Result<Log, alula_logs::Error> {
    let time: Vec<f64> = record.iter().map(|step| BEGIN + step.t).collect();
    let is_word = |step: &Step, column: &crate::columns::Column| {
        matches!((column.read)(experiment, step), Some(Cell::Word(_)))
    };
    let trace = COLUMNS
        .iter()
        .filter(|column| column.applies(experiment, record))
        .filter(|column| !record.iter().any(|step| is_word(step, column)))
        .map(|column| {
            let number = |step| column.number(experiment, step);
            let values = record.iter().map(number).collect();
            Column::new(column.name, unit(column.name), values)
        });
    let topic = |name, columns: Vec<Column>| Topic::new(name, 0, time.clone(), columns);
    let of = |name: &str, unit: &str, value: fn(&Step) -> f64| {
        Column::new(name, unit, record.iter().map(value).collect())
    };
    let status = [("is_vtol", 1.0), ("is_vtol_tailsitter", 1.0)];
    let status = status.map(|(name, value)| Column::new(name, "", vec![value]));
    let topics = vec![
        topic(TRACE, trace.collect())?,
        topic(
            "vehicle_attitude",
            vec![
                // From the axes of hover, x to the belly and z along the tail: θ is about y.
                of("q[0]", "", |s| (0.5 * s.truth.theta).cos()),
                of("q[1]", "", |_| 0.0),
                of("q[2]", "", |s| (0.5 * s.truth.theta).sin()),
                of("q[3]", "", |_| 0.0),
            ],
        )?,
        topic(
            "vehicle_local_position",
            vec![
                of("x", "m", |s| s.truth.position.y),
                of("y", "m", |_| 0.0),
                of("z", "m", |s| s.truth.position.x),
                of("vx", "m/s", |s| s.truth.velocity.y),
                of("vy", "m/s", |_| 0.0),
                of("vz", "m/s", |s| s.truth.velocity.x),
            ],
        )?,
        topic(
            "vehicle_local_position_setpoint",
            vec![
                of("x", "m", |s| s.reference_position.y),
                of("y", "m", |_| 0.0),
                of("z", "m", |s| s.reference_position.x),
                of("vx", "m/s", |s| s.reference_velocity.y),
                of("vy", "m/s", |_| 0.0),
                of("vz", "m/s", |s| s.reference_velocity.x),
                of("acceleration[0]", "m/s^2", |s| s.reference_acceleration.y),
                of("acceleration[1]", "m/s^2", |_| 0.0),
                of("acceleration[2]", "m/s^2", |s| s.reference_acceleration.x),
            ],
        )?,
        topic(
            "wind",
            vec![
                of("windspeed_north", "m/s", |s| s.wind.y),
                of("windspeed_east", "m/s", |_| 0.0),
            ],
        )?,
        topic(
            "airspeed_validated",
            vec![of("true_airspeed_m_s", "m/s", |s| {
                (s.truth.velocity - s.wind).norm()
            })],
        )?,
        Topic::new("vehicle_status", 0, vec![BEGIN], status.to_vec())?,
    ];
    Ok(Log {
        topics,
        notes: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Document;
    use crate::simulate::fly;
    use alula_logs::states::find;

    /// What is written as ULog reads back as the trace's numbers, and the states found in it are the flight's.
    #[test]
    fn a_written_flight_reads_back_as_the_trace_and_as_states() {
        let mut document = Document::load("round-trip").unwrap();
        document.assign("duration_s=12").unwrap();
        let experiment = document.checked().unwrap();
        let record = fly(&experiment).unwrap();
        let mut file = std::io::Cursor::new(Vec::new());
        let log = log(&experiment, &record).unwrap();
        Format::Ulog.write(&log, &mut file).unwrap();
        let log = alula_logs::ulog::read("x", file.get_ref()).unwrap();
        let trace = log.topic(TRACE).unwrap();
        assert!(trace.column("mode").is_none());
        assert_eq!(trace.column("thrust_n").unwrap().unit, "N");
        assert_eq!(trace.column("xe_down_m").unwrap().unit, "m");
        let states = find(&log).unwrap();
        assert_eq!(states.time.len(), record.len());
        for (row, step) in record.iter().enumerate() {
            let thrust = trace.column("thrust_n").unwrap().values[row];
            assert_eq!(thrust, f64::from(step.answer.thrust));
            let velocity = states.velocity.as_ref().unwrap().values[row];
            assert_eq!(
                velocity,
                [step.truth.velocity.y, 0.0, step.truth.velocity.x]
            );
            let plane = crate::replay::log::Plane::of(states.attitude.values[row]).unwrap();
            // 1e-12: the way over the quaternion.
            assert!((plane.theta(states.attitude.values[row]) - step.truth.theta).abs() < 1e-12);
        }
    }
}
