//! A record in space as a flight log, under the names that PX4 logs it by.

use alula::guidance::Air;
use alula::ned::Ned;

use super::{Step, V3};
use crate::flight_log::{Row, Told};

impl From<&Step> for Row {
    fn from(step: &Step) -> Self {
        let q = &step.truth.attitude;
        let vector = |v: V3| [v.x, v.y, v.z];
        let (target, input) = (&step.target, &step.input);
        let told = |v: Ned| [v.north, v.east, v.down].map(f64::from);
        let attitude = if input.orientation.i().down.is_nan() {
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
            specific_force: (step.input.specific_force).map(|f| [f.j, f.w, f.i].map(f64::from)),
            told: Told {
                attitude,
                velocity: told(input.velocity),
                position: error.map_or([f64::NAN; 3], |e| vector(target.position + e)),
                air: match input.air {
                    Air::Wind(wind) => Air::Wind(told(wind)),
                    Air::Velocity(v) => Air::Velocity(told(v)),
                    Air::Unknown => Air::Unknown,
                },
                heading: target.heading.unwrap_or(f64::NAN),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Document;
    use crate::flight_log::{Format, TRACE, log};
    use crate::space::{Experiment, fly, ned};

    /// What is written as ULog reads back as the trace's numbers, and the states found in it are the flight's.
    #[test]
    fn a_written_flight_reads_back_as_the_trace_and_as_states() {
        let mut document = Document::load("circle-40").unwrap();
        for change in ["duration_s=8", "entry_s=0", "weather.steady_m_s=[1,-2,0]"] {
            document.assign(change).unwrap();
        }
        let experiment = Experiment::of(&document).unwrap();
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
            assert_eq!(ned(velocity.into()), step.input.velocity);
            let flown = log.column("vehicle_local_position", "vx").unwrap();
            assert_eq!(flown.values[row], step.truth.velocity.x);
            let wind = log.column("wind", "windspeed_east").unwrap();
            assert_eq!(wind.values[row], -2.0);
            let air = states.air_velocity.as_ref().unwrap().values[row];
            assert_eq!(Air::Velocity(ned(air.into())), step.input.air);
            // Nose, wing, belly: against the tail, along the wing, along the belly.
            let force = states.specific_force.as_ref().unwrap().values[row];
            let told = step.input.specific_force.unwrap();
            assert_eq!(force, [-told.i, told.w, told.j].map(f64::from));
            let wanted = states.acceleration_setpoint.as_ref().unwrap().values[row];
            assert_eq!(V3::from(wanted), step.target.acceleration);
        }
    }
}
