//! A controller run open loop over an autopilot's log.

use alula::GuidanceInput;
use alula::ned::{BodyAxes, Quaternion};
use alula::spatial::{Heading, Orientation, Reference};
use alula_logs::states::States;
use anyhow::ensure;

use super::states::{self, Row};
use super::{Logged, OpenLoop};
use crate::controllers::Input;
use crate::experiment::{Experiment, Target, V3, ned};
use crate::simulate::Record;

/// Runs the controller of `experiment` over `states`: each step, with what the log says for the truth, and in words what had to be assumed.
pub fn replay(states: &States, experiment: &Experiment) -> anyhow::Result<(Record, Vec<String>)> {
    ensure!(
        !experiment.spec()?.feed_forward(),
        "the controller wants the air acceleration and the reference's jerk, which a log does not hold"
    );
    states::check(states)?;
    let mut open_loop = OpenLoop::new(experiment)?;
    let mut followed = states::Followed::default();
    for (row, &t) in states.time.iter().enumerate() {
        let [w, x, y, z] = states.attitude.values[row].map(|c| c as f32);
        let orientation =
            Orientation::from_quaternion(&Quaternion { w, x, y, z }, BodyAxes::NoseForward)
                .unwrap_or(Orientation::UNKNOWN);
        let told = Row::of(states, row);
        followed.count(&told);
        let target = Target {
            position: told.wanted.unwrap_or(V3::repeat(f64::NAN)),
            velocity: told.reference.into(),
            acceleration: told.acceleration.into(),
            heading: told.heading,
        };
        let sample = GuidanceInput::default()
            .velocity(ned(told.velocity.into()))
            .orientation(orientation)
            .state_age(told.velocity_age.max(states.attitude.overdue(row)) as f32)
            .air(told.air(|v| ned(v.into())))
            .specific_force(told.force())
            .position_error(told.position_error().map(ned))
            .reference(Reference {
                velocity: ned(target.velocity),
                acceleration: ned(target.acceleration),
                heading: told
                    .heading
                    .map_or(Heading::FREE, |h| Heading::from_angle(h as f32)),
            })
            .reference_age(told.reference_age as f32);
        let input = Input {
            sample,
            feed_forward: None,
        };
        let gravity = experiment.vehicle.gravity_m_s2;
        let logged = Logged {
            position: told.position.unwrap_or(V3::repeat(f64::NAN)),
            wind: told.wind().map_or(V3::zeros(), V3::from),
            load_factor: (told.specific_force).map_or(f64::NAN, |f| V3::from(f).norm() / gravity),
            target,
        };
        open_loop.row(t, input, logged)?;
    }
    Ok((open_loop.record, states::notes(states, followed)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Document;
    use crate::flight_log::{self, Format};
    use crate::replay::write;
    use crate::simulate::{Step, fly};

    /// A turn in a wind off every axis, with errors of every sensor, however the air is told: from the flight's log, of each kind, the commands
    /// flown, to the bit. One rounding more, and another plan is chosen somewhere.
    #[test]
    fn a_flights_own_log_replays_to_the_commands_flown() {
        for air in ["velocity", "steady-wind", "none"] {
            let air = format!("sensors.air=\"{air}\"");
            let mut document = Document::load("circle-40").unwrap();
            for change in [
                "duration_s=20",
                "settle_time_s=0",
                "weather.steady_m_s=[1.5,-1.5,0.5]",
                "sensors.velocity_m_s.noise=0.05",
                "sensors.position_m.noise=0.05",
                "sensors.attitude_deg.noise=0.2",
                "sensors.acceleration_m_s2.noise=0.1",
                &air,
            ] {
                document.assign(change).unwrap();
            }
            let experiment = document.checked().unwrap();
            let record = fly(&experiment).unwrap();
            let log = flight_log::log(&experiment, &record).unwrap();
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
                same_commands(&record, &states, &experiment, &format!("{air} {format:?}"));
            }
        }
    }

    fn same_commands(record: &[Step], states: &States, experiment: &Experiment, what: &str) {
        let (replayed, _) = replay(states, experiment).unwrap();
        assert_eq!(record.len(), replayed.len());
        for (a, b) in record.iter().zip(&replayed) {
            assert_eq!(a.answer, b.answer, "{what} {}", a.t);
        }
        let mut csv = Vec::new();
        write(experiment, &replayed, &mut csv).unwrap();
        let text = String::from_utf8(csv).unwrap();
        assert_eq!(text.lines().count(), replayed.len() + 1);
    }
}
