//! A record as a flight log, for ULog and MCAP: the columns of the trace, the flight under the names that PX4 logs it by, and what the
//! controller was told, so that a replay tells it the same. As CSV it is what a replay needs, on one time base.
//!
//! Time is counted from [`BEGIN`], as viewers take a row at 0 for one that was never filled in.

use std::io::{BufWriter, Seek, Write};

use alula::guidance::Air;
use alula::ned::{BodyAxes, Ned};
use alula_logs::states::{TOLD, find};
use alula_logs::{Column, Log, Topic};

use crate::columns::{self, COLUMNS, Cell};
use crate::experiment::{Experiment, V3};
use crate::plant::tail_sitter::{MISSING_PITCH, TailSitter};
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
    /// CSV.
    Csv,
}

impl Format {
    /// The name of the file.
    pub fn file(self) -> &'static str {
        match self {
            Self::Ulog => "flight.ulg",
            Self::Mcap => "flight.mcap",
            Self::Csv => "flight.csv",
        }
    }

    /// Writes `log` `to` a file.
    pub fn write(self, log: &Log, to: impl Write + Seek) -> anyhow::Result<()> {
        let to = BufWriter::new(to);
        match self {
            Self::Ulog => alula_logs::ulog::write(log, to)?,
            Self::Mcap => alula_logs::mcap::write(log, to)?,
            Self::Csv => alula_logs::csv::write(&find(log)?.topic(), to)?,
        }
        Ok(())
    }
}

/// The record as a log.
pub fn log(experiment: &Experiment, record: &[Step]) -> Result<Log, alula_logs::Error> {
    let time: Vec<f64> = record.iter().map(|step| BEGIN + step.t).collect();
    let is_number = |column: &&columns::Column| {
        let mut cells = record
            .iter()
            .filter_map(|step| (column.read)(experiment, step));
        cells
            .next()
            .is_some_and(|cell| !matches!(cell, Cell::Word(_)))
    };
    let trace = COLUMNS.iter().filter(is_number).map(|column| {
        let number = |step| column.number(experiment, step);
        let unit = column.unit().replace('²', "^2").replace('³', "^3");
        Column::new(column.name, &unit, record.iter().map(number).collect())
    });
    let rows: Vec<Row> = record.iter().map(Row::from).collect();
    let mut log = log_of(&time, trace.collect(), &rows)?;
    log.topics.extend(loops(experiment, &time, record)?);
    Ok(log)
}

/// The set-points of rates and thrust, and the rates that were had, about the axes of hover.
fn loops(
    experiment: &Experiment,
    time: &[f64],
    record: &[Step],
) -> Result<[Topic; 5], alula_logs::Error> {
    let most = match &experiment.tail_sitter {
        Some(plant) => TailSitter::new(plant.true_vehicle(), None).static_thrust(),
        None => experiment.thrust_limits(None, experiment.weight())[1],
    };
    /// Name, unit, and how it is read.
    type Read<'a> = (&'a str, &'a str, &'a dyn Fn(&Step) -> f64);
    let topic = |name: &str, columns: Vec<Read>| {
        let columns = columns
            .into_iter()
            .map(|(name, unit, value)| Column::new(name, unit, record.iter().map(value).collect()));
        Topic::new(name, 0, time.to_vec(), columns.collect())
    };
    let asked = |step: &Step| {
        BodyAxes::NoseUp
            .components(step.answer.rates)
            .map(f64::from)
    };
    let share = |step: &Step| -f64::from(step.answer.thrust) / most;
    // Of a tail-sitter as they are: what its elevons are, where there are any.
    let travel = experiment
        .tail_sitter
        .as_ref()
        .map(|plant| plant.true_vehicle().servo.travel_deg)
        .filter(|travel| *travel > 0.0);
    let torque = |step: &Step| match (travel, &step.readings[..]) {
        (Some(travel), [_, _, _, _, left, right, ..]) => -0.5 * (left + right) / travel,
        _ => f64::NAN,
    };
    let missing = |step: &Step| {
        step.readings
            .get(MISSING_PITCH)
            .copied()
            .unwrap_or(f64::NAN)
    };
    let none = |_: &Step| 0.0;
    Ok([
        topic(
            "vehicle_torque_setpoint",
            vec![("xyz[0]", "", &none), ("xyz[1]", "", &torque)],
        )?,
        topic(
            "control_allocator_status",
            vec![("unallocated_torque[1]", "", &missing)],
        )?,
        topic(
            "vehicle_angular_velocity",
            vec![
                ("xyz[0]", "rad/s", &|step| step.truth.rates.x),
                ("xyz[1]", "rad/s", &|step| step.truth.rates.y),
                ("xyz[2]", "rad/s", &|step| step.truth.rates.z),
            ],
        )?,
        topic(
            "vehicle_rates_setpoint",
            vec![
                ("roll", "rad/s", &|step| asked(step)[0]),
                ("pitch", "rad/s", &|step| asked(step)[1]),
                ("yaw", "rad/s", &|step| asked(step)[2]),
            ],
        )?,
        topic(
            "vehicle_thrust_setpoint",
            vec![
                ("xyz[0]", "", &none),
                ("xyz[1]", "", &none),
                ("xyz[2]", "", &share),
            ],
        )?,
    ])
}

/// A row under PX4's names. World vectors are north-east-down.
pub struct Row {
    /// w x y z, from the axes of hover, x to the belly and z along the tail.
    pub attitude: [f64; 4],
    /// Position \[m\] and velocity \[m/s\].
    pub motion: [[f64; 3]; 2],
    /// Position \[m\], velocity \[m/s\] and acceleration \[m/s²\] asked for.
    pub wanted: [[f64; 3]; 3],
    /// Wind \[m/s\].
    pub wind: [f64; 3],
    /// Specific force \[m/s²\] along the axes of hover, if it is told.
    pub specific_force: Option<[f64; 3]>,
    /// What the controller was told of the rest.
    pub told: Told,
}

/// What a controller was told; NaN where nothing was.
pub struct Told {
    /// As [`Row::attitude`].
    pub attitude: [f64; 4],
    /// Velocity [m/s].
    pub velocity: [f64; 3],
    /// Position \[m\].
    pub position: [f64; 3],
    /// Wind, or velocity through the air [m/s].
    pub air: Air<[f64; 3]>,
    /// Heading asked for \[rad\].
    pub heading: f64,
}

const NOTHING: [f64; 3] = [f64::NAN; 3];

impl Told {
    fn wind(&self) -> [f64; 3] {
        match self.air {
            Air::Wind(wind) | Air::Pitot { wind, .. } => wind,
            _ => NOTHING,
        }
    }

    fn air_velocity(&self) -> [f64; 3] {
        match self.air {
            Air::Velocity(v) => v,
            _ => NOTHING,
        }
    }
}

impl From<&Step> for Row {
    fn from(step: &Step) -> Self {
        let q = &step.truth.attitude;
        let vector = |v: V3| [v.x, v.y, v.z];
        let (target, input) = (&step.target, &step.input.sample);
        let told = |v: Ned| [v.north, v.east, v.down].map(f64::from);
        let attitude = if input.orientation.down().down.is_nan() {
            [f64::NAN; 4]
        } else {
            let q = &step.measured_attitude;
            [q.w, q.i, q.j, q.k]
        };
        let error = input.position_error.map(|e| V3::from(told(e)));
        Self {
            attitude: [q.w, q.i, q.j, q.k],
            motion: [step.truth.position, step.truth.velocity].map(vector),
            wanted: [target.position, target.velocity, target.acceleration].map(vector),
            wind: vector(step.wind),
            specific_force: input
                .specific_force
                .map(|f| BodyAxes::NoseUp.components(f).map(f64::from)),
            told: Told {
                attitude,
                velocity: told(input.velocity),
                position: error.map_or([f64::NAN; 3], |e| vector(target.position + e)),
                air: input.air.map(told),
                heading: target.heading.unwrap_or(f64::NAN),
            },
        }
    }
}

/// The log of a flight, with the columns of its trace and its rows at the times `time` \[s\].
fn log_of(time: &[f64], trace: Vec<Column>, rows: &[Row]) -> Result<Log, alula_logs::Error> {
    let topic = |name, columns: Vec<Column>| Topic::new(name, 0, time.to_vec(), columns);
    let of = |name: &str, unit: &str, value: &dyn Fn(&Row) -> f64| {
        Column::new(name, unit, rows.iter().map(value).collect())
    };
    let vector = |names: [&str; 3], unit: &str, value: &dyn Fn(&Row) -> [f64; 3]| {
        let axes = names.into_iter().enumerate();
        let columns = axes.map(|(axis, name)| of(name, unit, &|row| value(row)[axis]));
        columns.collect::<Vec<_>>()
    };
    let status = [("is_vtol", 1.0), ("is_vtol_tailsitter", 1.0)];
    let status = status.map(|(name, value)| Column::new(name, "", vec![value]));
    let parts = ["q[0]", "q[1]", "q[2]", "q[3]"].into_iter().enumerate();
    let attitude = parts.map(|(part, name)| of(name, "", &|row| row.attitude[part]));
    let place = ["x", "y", "z"];
    let speed = ["vx", "vy", "vz"];
    let asked = ["acceleration[0]", "acceleration[1]", "acceleration[2]"];
    let airspeed = |row: &Row| {
        let [_, v] = row.motion;
        std::iter::zip(v, row.wind)
            .map(|(v, w)| (v - w).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let mut topics = vec![
        topic(TRACE, trace)?,
        topic("vehicle_attitude", attitude.collect())?,
        topic(
            "vehicle_local_position",
            [
                vector(place, "m", &|row| row.motion[0]),
                vector(speed, "m/s", &|row| row.motion[1]),
            ]
            .concat(),
        )?,
        topic(
            "vehicle_local_position_setpoint",
            [
                vector(place, "m", &|row| row.wanted[0]),
                vector(speed, "m/s", &|row| row.wanted[1]),
                vector(asked, "m/s^2", &|row| row.wanted[2]),
            ]
            .concat(),
        )?,
        topic(
            "wind",
            vec![
                of("windspeed_north", "m/s", &|row| row.wind[0]),
                of("windspeed_east", "m/s", &|row| row.wind[1]),
            ],
        )?,
        topic(
            "airspeed_validated",
            vec![of("true_airspeed_m_s", "m/s", &airspeed)],
        )?,
        Topic::new("vehicle_status", 0, vec![BEGIN], status.to_vec())?,
        topic(TOLD, told(rows))?,
    ];
    if rows.iter().any(|row| row.specific_force.is_some()) {
        let force = |row: &Row| row.specific_force.unwrap_or([f64::NAN; 3]);
        let names = ["xyz[0]", "xyz[1]", "xyz[2]"];
        topics.push(topic(
            "vehicle_acceleration",
            vector(names, "m/s^2", &force),
        )?);
    }
    Ok(Log {
        topics,
        notes: Vec::new(),
    })
}

/// The columns of what was told.
fn told(rows: &[Row]) -> Vec<Column> {
    let column = |name: String, unit: &str, value: &dyn Fn(&Told) -> f64| {
        let values = rows.iter().map(|row| value(&row.told)).collect();
        Column::new(&name, unit, values)
    };
    let mut columns: Vec<Column> = (0..4)
        .map(|i| column(format!("q[{i}]"), "", &|told| told.attitude[i]))
        .collect();
    let mut vector = |name: &str, unit: &str, value: fn(&Told) -> [f64; 3]| {
        let axis = |i| column(format!("{name}[{i}]"), unit, &|told| value(told)[i]);
        columns.extend((0..3).map(axis));
    };
    vector("v", "m/s", |told| told.velocity);
    vector("x", "m", |told| told.position);
    vector("wind", "m/s", Told::wind);
    vector("air", "m/s", Told::air_velocity);
    columns.push(column("heading".into(), "rad", &|told| told.heading));
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Document, ned};
    use crate::simulate::fly;

    /// What is written as ULog reads back as the trace's numbers, and the states found in it are the flight's.
    #[test]
    fn a_written_flight_reads_back_as_the_trace_and_as_states() {
        let mut document = Document::load("circle-40").unwrap();
        for change in [
            "duration_s=8",
            "settle_time_s=0",
            "weather.steady_m_s=[1,-2,0]",
        ] {
            document.assign(change).unwrap();
        }
        let experiment = document.checked().unwrap();
        let record = fly(&experiment).unwrap();
        let mut file = std::io::Cursor::new(Vec::new());
        Format::Ulog
            .write(&log(&experiment, &record).unwrap(), &mut file)
            .unwrap();
        let log = alula_logs::ulog::read("x", file.get_ref()).unwrap();
        let trace = log.topic(TRACE).unwrap();
        assert!(trace.column("mode").is_none());
        assert_eq!(trace.column("bank_rad").unwrap().unit, "rad");
        let states = alula_logs::states::find(&log).unwrap();
        for (row, step) in record.iter().enumerate() {
            let bank = trace.column("bank_rad").unwrap().values[row];
            assert_eq!(bank, step.bank());
            // What was told, in single precision, goes before what was.
            let velocity = states.velocity.as_ref().unwrap().values[row];
            assert_eq!(ned(velocity.into()), step.input.sample.velocity);
            let velocity_north = log.column("vehicle_local_position", "vx").unwrap();
            assert_eq!(velocity_north.values[row], step.truth.velocity.x);
            let wind = log.column("wind", "windspeed_east").unwrap();
            assert_eq!(wind.values[row], -2.0);
            let air = states.air_velocity.as_ref().unwrap().values[row];
            assert_eq!(Air::Velocity(ned(air.into())), step.input.sample.air);
            // Nose, wing, belly: against the tail, along the wing, along the belly.
            let force = states.specific_force.as_ref().unwrap().values[row];
            let told = step.input.sample.specific_force.unwrap();
            assert_eq!(force, [told.forward, told.right, told.down].map(f64::from));
            let wanted = states.acceleration_setpoint.as_ref().unwrap().values[row];
            assert_eq!(V3::from(wanted), step.target.acceleration);
        }
    }
}
