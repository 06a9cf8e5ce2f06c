//! PX4's topics.
//!
//! Read in PX4/PX4-Autopilot, `msg/` and `msg/versioned/`: `VehicleAttitude.msg` (`q`: w, x, y, z, from the body,
//! forward-right-down, to north-east-down), `VehicleLocalPosition.msg` (`x y z`, `vx vy vz`, north-east-down; `xy_valid z_valid`, `v_xy_valid v_z_valid`),
//! `Wind.msg` and, of older versions, `wind_estimate.msg` (`windspeed_north`, `windspeed_east`), `AirspeedValidated.msg`
//! (`true_airspeed_m_s`, NaN if invalid), `VehicleLocalPositionSetpoint.msg`, `TrajectorySetpoint.msg` (NaN: not
//! controlled), `VehicleAttitudeSetpoint.msg` (`q_d`), `VehicleStatus.msg` (`is_vtol_tailsitter`), `VehicleAcceleration.msg`
//! (`xyz`) and `SensorCombined.msg` (`accelerometer_m_s2`), forward-right-down of the same body.

use super::source::Source;
use super::{Family, Quaternion, TOLD};
use crate::Log;

pub(super) const FAMILY: Family = Family {
    name: "PX4",
    attitude: &[
        Source::quaternion(&[
            (TOLD, "q[0]"),
            (TOLD, "q[1]"),
            (TOLD, "q[2]"),
            (TOLD, "q[3]"),
        ]),
        Source::quaternion(&[
            ("vehicle_attitude", "q[0]"),
            ("vehicle_attitude", "q[1]"),
            ("vehicle_attitude", "q[2]"),
            ("vehicle_attitude", "q[3]"),
        ]),
    ],
    velocity: &[
        Source::vector(&[(TOLD, "v[0]"), (TOLD, "v[1]"), (TOLD, "v[2]")]),
        Source::vector(&[
            ("vehicle_local_position", "vx"),
            ("vehicle_local_position", "vy"),
            ("vehicle_local_position", "vz"),
        ])
        .valid(&["v_xy_valid", "v_xy_valid", "v_z_valid"]),
    ],
    position: &[
        Source::vector(&[(TOLD, "x[0]"), (TOLD, "x[1]"), (TOLD, "x[2]")]),
        Source::vector(&[
            ("vehicle_local_position", "x"),
            ("vehicle_local_position", "y"),
            ("vehicle_local_position", "z"),
        ])
        .valid(&["xy_valid", "xy_valid", "z_valid"]),
    ],
    wind: &[
        Source::vector(&[(TOLD, "wind[0]"), (TOLD, "wind[1]"), (TOLD, "wind[2]")]),
        Source::horizontal(&[("wind", "windspeed_north"), ("wind", "windspeed_east")]),
        Source::horizontal(&[
            ("wind_estimate", "windspeed_north"),
            ("wind_estimate", "windspeed_east"),
        ]),
    ],
    air_velocity: &[Source::vector(&[
        (TOLD, "air[0]"),
        (TOLD, "air[1]"),
        (TOLD, "air[2]"),
    ])],
    heading_setpoint: &[Source::scalar(&[(TOLD, "heading")])],
    airspeed: &[
        Source::scalar(&[("airspeed_validated", "true_airspeed_m_s")]),
        Source::scalar(&[("airspeed", "true_airspeed_m_s")]),
    ],
    specific_force: &[
        Source::vector(&[
            ("vehicle_acceleration", "xyz[0]"),
            ("vehicle_acceleration", "xyz[1]"),
            ("vehicle_acceleration", "xyz[2]"),
        ]),
        Source::vector(&[
            ("sensor_combined", "accelerometer_m_s2[0]"),
            ("sensor_combined", "accelerometer_m_s2[1]"),
            ("sensor_combined", "accelerometer_m_s2[2]"),
        ]),
    ],
    attitude_setpoint: &[Source::quaternion(&[
        ("vehicle_attitude_setpoint", "q_d[0]"),
        ("vehicle_attitude_setpoint", "q_d[1]"),
        ("vehicle_attitude_setpoint", "q_d[2]"),
        ("vehicle_attitude_setpoint", "q_d[3]"),
    ])],
    position_setpoint: &[
        Source::vector(&[
            ("vehicle_local_position_setpoint", "x"),
            ("vehicle_local_position_setpoint", "y"),
            ("vehicle_local_position_setpoint", "z"),
        ])
        .partly(),
        Source::vector(&[
            ("trajectory_setpoint", "position[0]"),
            ("trajectory_setpoint", "position[1]"),
            ("trajectory_setpoint", "position[2]"),
        ])
        .partly(),
    ],
    velocity_setpoint: &[
        Source::vector(&[
            ("vehicle_local_position_setpoint", "vx"),
            ("vehicle_local_position_setpoint", "vy"),
            ("vehicle_local_position_setpoint", "vz"),
        ])
        .partly(),
        Source::vector(&[
            ("trajectory_setpoint", "velocity[0]"),
            ("trajectory_setpoint", "velocity[1]"),
            ("trajectory_setpoint", "velocity[2]"),
        ])
        .partly(),
    ],
    acceleration_setpoint: &[
        Source::vector(&[
            ("vehicle_local_position_setpoint", "acceleration[0]"),
            ("vehicle_local_position_setpoint", "acceleration[1]"),
            ("vehicle_local_position_setpoint", "acceleration[2]"),
        ])
        .partly(),
        Source::vector(&[
            ("trajectory_setpoint", "acceleration[0]"),
            ("trajectory_setpoint", "acceleration[1]"),
            ("trajectory_setpoint", "acceleration[2]"),
        ])
        .partly(),
    ],
};

/// What is said of an attitude that is not turned.
pub(super) const NOT_TURNED: &str = "attitude taken with x along the nose, as PX4 has it of all but tail-sitters: no vehicle_status.is_vtol_tailsitter says otherwise. The log of a tail-sitter without it is read 90° off";

/// The rotation that turns PX4's attitude of a tail-sitter, whose body z axis points to the tail in hover, into that of a
/// body whose x axis points along the nose: 90° about y, from the right. PX4's fixed-wing code turns it so
/// (`R * Dcmf{Eulerf{0, π/2, 0}}` where `is_vtol_tailsitter`, `src/modules/fw_pos_control/FixedwingPositionControl.cpp`).
/// None if the log is not of a tail-sitter.
pub(super) fn turn(log: &Log) -> Option<Quaternion> {
    let flag = log.column("vehicle_status", "is_vtol_tailsitter")?;
    let half = std::f64::consts::FRAC_1_SQRT_2;
    flag.values.contains(&1.0).then_some([half, 0.0, half, 0.0])
}

#[cfg(test)]
mod tests {
    use super::super::find;
    use crate::{Column, Log, Topic};

    fn topic(name: &str, time: &[f64], columns: &[(&str, f64)]) -> Topic {
        let column = |&(name, value): &(&str, f64)| Column::new(name, "", vec![value; time.len()]);
        Topic::new(name, 0, time.to_vec(), columns.iter().map(column).collect()).unwrap()
    }

    fn log() -> Log {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        // PX4's frame nose up over the north: body z down, which is the identity turned by nothing.
        let q = [("q[0]", 1.0), ("q[1]", 0.0), ("q[2]", 0.0), ("q[3]", 0.0)];
        let q_d = [
            ("q_d[0]", half),
            ("q_d[1]", 0.0),
            ("q_d[2]", -half),
            ("q_d[3]", 0.0),
        ];
        let position = [
            ("x", 1.0),
            ("y", 2.0),
            ("z", -3.0),
            ("vx", 4.0),
            ("vy", 5.0),
            ("vz", 6.0),
        ];
        let trajectory = [
            ("velocity[0]", 7.0),
            ("velocity[1]", 8.0),
            ("velocity[2]", f64::NAN),
        ];
        let force = [("xyz[0]", 1.0), ("xyz[1]", 2.0), ("xyz[2]", -9.5)];
        let topics = vec![
            topic("vehicle_attitude", &[1.0, 2.0, 3.0], &q),
            topic("vehicle_attitude_setpoint", &[1.0], &q_d),
            topic("vehicle_local_position", &[0.5, 1.75], &position),
            topic(
                "wind_estimate",
                &[2.5],
                &[("windspeed_north", 1.5), ("windspeed_east", -1.0)],
            ),
            topic("trajectory_setpoint", &[1.0], &trajectory),
            topic("vehicle_acceleration", &[1.0], &force),
            topic("vehicle_status", &[0.0], &[("is_vtol_tailsitter", 1.0)]),
        ];
        Log {
            topics,
            notes: Vec::new(),
        }
    }

    #[test]
    fn the_usual_topics_are_found_on_the_time_of_the_attitude() {
        let states = find(&log()).unwrap();
        assert_eq!(
            (states.family, states.time.as_slice()),
            ("PX4", &[1.0, 2.0, 3.0][..])
        );
        let velocity = states.velocity.as_ref().unwrap();
        assert_eq!(velocity.values, [[4.0, 5.0, 6.0]; 3]);
        assert_eq!(velocity.age, [0.5, 0.25, 1.25]);
        assert_eq!(velocity.interval, 1.25);
        assert_eq!(
            states.position.as_ref().unwrap().values[0],
            [1.0, 2.0, -3.0]
        );
        let wind = states.wind.as_ref().unwrap();
        assert!(wind.values[1][0].is_nan() && wind.age[1].is_infinite());
        assert_eq!(wind.values[2], [1.5, -1.0, 0.0]);
        assert_eq!(states.air_velocity, None);
        let setpoint = states.velocity_setpoint.unwrap();
        assert!(
            setpoint
                .source
                .starts_with("trajectory_setpoint.velocity[0]"),
            "{}",
            setpoint.source
        );
        assert!(setpoint.values[0][2].is_nan());
        // From belly, wing and tail to nose, wing and belly.
        let force = states.specific_force.as_ref().unwrap();
        assert_eq!(force.values[0], [9.5, 2.0, 1.0]);
        let missing: Vec<&str> = states.missing.iter().map(|m| &*m.what).collect();
        assert_eq!(
            missing,
            ["airspeed", "position set-point", "acceleration set-point"]
        );
        assert_eq!(
            states.missing[0].to_string(),
            "no airspeed: none of airspeed_validated.true_airspeed_m_s, airspeed.true_airspeed_m_s"
        );
    }

    /// Of two topics of set-points each row and axis is of the first that gives it: one may have no number, know some axes alone, or end early.
    #[test]
    fn a_set_point_is_of_the_topic_that_gives_it() {
        let with = |others: Vec<Topic>| {
            let mut log = log();
            log.topics
                .retain(|topic| topic.name() != "trajectory_setpoint");
            let all = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
            let attitude = ["q[0]", "q[1]", "q[2]", "q[3]"].map(|name| (name, 0.5));
            log.topics[0] = topic("vehicle_attitude", &all, &attitude);
            let asked = [
                ("velocity[0]", 5.0),
                ("velocity[1]", f64::NAN),
                ("velocity[2]", -1.0),
            ];
            log.topics.push(topic("trajectory_setpoint", &all, &asked));
            log.topics.extend(others);
            let series = find(&log).unwrap().velocity_setpoint.unwrap();
            // NaN is not equal to itself.
            let values = series
                .values
                .iter()
                .map(|row| row.map(|x| (!x.is_nan()).then_some(x)));
            values.collect::<Vec<_>>()
        };
        let of = |time: &[f64], columns: &[(&str, f64)]| {
            with(vec![topic(
                "vehicle_local_position_setpoint",
                time,
                columns,
            )])
        };
        let all = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let none = [("vx", f64::NAN), ("vy", f64::NAN), ("vz", f64::NAN)];
        assert_eq!(of(&all, &none), [[Some(5.0), None, Some(-1.0)]; 6]);
        let one = [("vx", f64::NAN), ("vy", 3.0), ("vz", -2.0)];
        assert_eq!(of(&all, &one), [[Some(5.0), Some(3.0), Some(-2.0)]; 6]);
        assert_eq!(
            of(&all, &[("vz", -2.0)]),
            [[Some(5.0), None, Some(-2.0)]; 6]
        );
        // It ends at 2 s, and is asked for until it is overdue by a second: two after that.
        let early = of(&[0.0, 1.0, 2.0], &one);
        assert_eq!(early[..5], [[Some(5.0), Some(3.0), Some(-2.0)]; 5]);
        assert_eq!(early[5..], [[Some(5.0), None, Some(-1.0)]]);
        // Where nothing is asked for any longer, that shows in the age.
        let mut log = log();
        log.topics[0] = topic(
            "vehicle_attitude",
            &all,
            &[("q[0]", 1.0), ("q[1]", 0.0), ("q[2]", 0.0), ("q[3]", 0.0)],
        );
        let both = topic("vehicle_local_position_setpoint", &[0.0, 1.5], &one);
        log.topics.push(both);
        let series = find(&log).unwrap().velocity_setpoint.unwrap();
        assert_eq!(series.age[5], 3.5);
    }

    /// Where the estimator says that it knows no velocity there is none, whatever number stands there.
    #[test]
    fn what_is_not_valid_is_no_number() {
        let mut log = log();
        let valid = |name, values: [f64; 2]| Column::new(name, "", values.to_vec());
        let topic = log.topics.remove(2);
        let mut columns = topic.columns().to_vec();
        columns.push(valid("v_xy_valid", [1.0, 0.0]));
        columns.push(valid("v_z_valid", [0.0, 1.0]));
        columns.push(valid("xy_valid", [1.0, 0.0]));
        let topic = Topic::new("vehicle_local_position", 0, vec![0.5, 1.75], columns).unwrap();
        log.topics.push(topic);
        let states = find(&log).unwrap();
        let isnt = |values: [f64; 3]| values.map(f64::is_nan);
        let velocity = states.velocity.unwrap().values;
        assert_eq!(isnt(velocity[0]), [false, false, true]);
        assert_eq!(isnt(velocity[1]), [true, true, false]);
        let position = states.position.unwrap().values;
        assert_eq!(isnt(position[0]), [false; 3]);
        assert_eq!(isnt(position[1]), [true, true, false]);
    }

    #[test]
    fn a_tail_sitters_hover_frame_is_turned_to_the_nose() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let close =
            |a: [f64; 4], b: [f64; 4]| std::iter::zip(a, b).all(|(a, b)| (a - b).abs() < 1e-15);
        let states = find(&log()).unwrap();
        // Upright in hover the nose points up: pitch 90°.
        assert!(
            close(states.attitude.values[0], [half, 0.0, half, 0.0]),
            "{:?}",
            states.attitude.values[0]
        );
        // Pitched down by 90° from there, as in cruise: nose level to the north.
        let setpoint = states.attitude_setpoint.unwrap().values[0];
        assert!(close(setpoint, [1.0, 0.0, 0.0, 0.0]), "{setpoint:?}");
        assert_eq!(states.notes.len(), 1);

        let mut level = log();
        level.topics.pop();
        let states = find(&level).unwrap();
        assert_eq!(states.attitude.values[0], [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(states.notes, [super::NOT_TURNED]);
    }
}
