//! ArduPilot's messages.
//!
//! Read in ArduPilot/ardupilot: `libraries/AP_NavEKF3/LogStructure.h` (`XKQ`: quaternion; `XKF1`: roll, pitch, yaw,
//! velocity, position; `XKF2`: wind), `libraries/AP_NavEKF2/LogStructure.h` (`NKQ`, `NKF1`, `NKF2`),
//! `libraries/AP_AHRS/LogStructure.h` (`AHR2`, `ATT`, `POS`), `libraries/AP_Logger/LogStructure.h` (`ARSP`),
//! `libraries/AP_InertialSensor/LogStructure.h` (`IMU`),
//! `libraries/AC_AttitudeControl/LogStructure.h` (`PSCN`, `PSCE`, `PSCD`: position, velocity, acceleration asked for by the
//! position controller, per axis). `XKQ1`, `NKQ1`: the quaternions of versions in which each instance had its own message.
//!
//! The quaternions are those of `Quaternion::rotation_matrix` (`libraries/AP_Math/quaternion.cpp`), which `AP_NavEKF3_core.cpp`
//! uses as the rotation from the body to north-east-down: w, x, y, z as PX4's.

use super::Family;
use super::source::Source;
use crate::{Log, Topic};

/// Why `ATT` is the last choice: `Plane::Log_Write_Attitude` in `ArduPlane/Log.cpp` writes it through `ahrs_view`, turned by
/// 90°, while a tail-sitter hovers, and unturned in forward flight. The estimators' messages stay in the airframe's axes.
pub(super) const ATT_NOTE: &str = "attitude from ATT, which ArduPlane logs in the hover frame while a tail-sitter hovers, \
     and in the nose frame in forward flight; log XKQ or AHR2 to be sure";

pub(super) const FAMILY: Family = Family {
    name: "ArduPilot",
    attitude: &[
        Source::quaternion(&[("XKQ", "Q1"), ("XKQ", "Q2"), ("XKQ", "Q3"), ("XKQ", "Q4")]),
        Source::quaternion(&[
            ("XKQ1", "Q1"),
            ("XKQ1", "Q2"),
            ("XKQ1", "Q3"),
            ("XKQ1", "Q4"),
        ]),
        Source::quaternion(&[("NKQ", "Q1"), ("NKQ", "Q2"), ("NKQ", "Q3"), ("NKQ", "Q4")]),
        Source::quaternion(&[
            ("NKQ1", "Q1"),
            ("NKQ1", "Q2"),
            ("NKQ1", "Q3"),
            ("NKQ1", "Q4"),
        ]),
        Source::degrees(&[("XKF1", "Roll"), ("XKF1", "Pitch"), ("XKF1", "Yaw")]),
        Source::degrees(&[("NKF1", "Roll"), ("NKF1", "Pitch"), ("NKF1", "Yaw")]),
        Source::quaternion(&[
            ("AHR2", "Q1"),
            ("AHR2", "Q2"),
            ("AHR2", "Q3"),
            ("AHR2", "Q4"),
        ]),
        Source::degrees(&[("ATT", "Roll"), ("ATT", "Pitch"), ("ATT", "Yaw")]),
    ],
    velocity: &[
        Source::vector(&[("XKF1", "VN"), ("XKF1", "VE"), ("XKF1", "VD")]),
        Source::vector(&[("NKF1", "VN"), ("NKF1", "VE"), ("NKF1", "VD")]),
        Source::vector(&[("PSCN", "VN"), ("PSCE", "VE"), ("PSCD", "VD")]),
    ],
    position: &[
        Source::vector(&[("XKF1", "PN"), ("XKF1", "PE"), ("XKF1", "PD")]),
        Source::vector(&[("NKF1", "PN"), ("NKF1", "PE"), ("NKF1", "PD")]),
        Source::geodetic(&[("POS", "Lat"), ("POS", "Lng"), ("POS", "Alt")]),
    ],
    wind: &[
        Source::horizontal(&[("XKF2", "VWN"), ("XKF2", "VWE")]),
        Source::horizontal(&[("NKF2", "VWN"), ("NKF2", "VWE")]),
    ],
    air_velocity: &[],
    heading_setpoint: &[],
    airspeed: &[Source::scalar(&[("ARSP", "Airspeed")])],
    specific_force: &[Source::vector(&[
        ("IMU", "AccX"),
        ("IMU", "AccY"),
        ("IMU", "AccZ"),
    ])],
    // `ATT.DesRoll` and its neighbours change their frame with the mode, so they are not taken.
    attitude_setpoint: &[],
    position_setpoint: &[Source::vector(&[
        ("PSCN", "TPN"),
        ("PSCE", "TPE"),
        ("PSCD", "TPD"),
    ])],
    velocity_setpoint: &[Source::vector(&[
        ("PSCN", "TVN"),
        ("PSCE", "TVE"),
        ("PSCD", "TVD"),
    ])],
    acceleration_setpoint: &[Source::vector(&[
        ("PSCN", "TAN"),
        ("PSCE", "TAE"),
        ("PSCD", "TAD"),
    ])],
};

/// The topic `name`: of an estimator's messages the instance that was primary for most of the log (`PI` of `XKF4` or
/// `NKF4`), of all others the lowest instance.
pub(super) fn instance<'a>(log: &'a Log, name: &str) -> Option<&'a Topic> {
    let status = match name.get(..2) {
        Some("XK") => "XKF4",
        Some("NK") => "NKF4",
        _ => return log.topic(name),
    };
    let primary = log.column(status, "PI").and_then(|column| {
        let mut counts = [0_usize; 256];
        column
            .values
            .iter()
            .for_each(|&v| counts[usize::from(v as u8)] += 1);
        let most = (0..=255u8).rev().max_by_key(|&i| counts[usize::from(i)])?;
        log.instance(name, most)
    });
    primary.or_else(|| log.topic(name))
}

#[cfg(test)]
mod tests {
    use super::super::find;
    use crate::{Column, Log, Topic};

    fn topic(name: &str, instance: u8, time: &[f64], columns: &[(&str, f64)]) -> Topic {
        let column = |&(name, value): &(&str, f64)| Column::new(name, "", vec![value; time.len()]);
        Topic::new(
            name,
            instance,
            time.to_vec(),
            columns.iter().map(column).collect(),
        )
        .unwrap()
    }

    fn velocity(vn: f64) -> [(&'static str, f64); 3] {
        [("VN", vn), ("VE", 0.0), ("VD", 0.0)]
    }

    #[test]
    fn the_primary_estimator_is_taken() {
        let q = |q1: f64| [("Q1", q1), ("Q2", 0.0), ("Q3", 1.0), ("Q4", 0.0)];
        let mut topics = vec![
            topic("XKQ", 0, &[1.0], &q(0.0)),
            topic("XKQ", 1, &[1.5, 2.0], &q(1.0)),
            topic("XKF1", 0, &[1.0], &velocity(1.0)),
            topic("XKF1", 1, &[1.0], &velocity(2.0)),
            topic(
                "ATT",
                0,
                &[0.0],
                &[("Roll", 0.0), ("Pitch", 0.0), ("Yaw", 0.0)],
            ),
            topic("XKF4", 0, &[0.0, 1.0, 2.0], &[("PI", 1.0)]),
        ];
        let states = find(&Log {
            topics: topics.clone(),
            notes: Vec::new(),
        })
        .unwrap();
        assert_eq!(
            (states.family, states.time.as_slice()),
            ("ArduPilot", &[1.5, 2.0][..])
        );
        assert_eq!(states.velocity.unwrap().values[0][0], 2.0);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!(
            (states.attitude.values[0][0] - half).abs() < 1e-15,
            "normalised"
        );
        topics.pop();
        let states = find(&Log {
            topics,
            notes: Vec::new(),
        })
        .unwrap();
        assert_eq!(states.velocity.unwrap().values[0][0], 1.0);
    }

    #[test]
    fn set_points_of_three_axes_are_as_old_as_the_oldest() {
        let topics = vec![
            topic(
                "ATT",
                0,
                &[3.0],
                &[("Roll", 0.0), ("Pitch", 90.0), ("Yaw", 0.0)],
            ),
            topic("PSCN", 0, &[2.0], &[("TVN", 1.0)]),
            topic("PSCE", 0, &[1.0], &[("TVE", 2.0)]),
            topic("PSCD", 0, &[2.5], &[("TVD", 3.0)]),
        ];
        let states = find(&Log {
            topics,
            notes: Vec::new(),
        })
        .unwrap();
        let setpoint = states.velocity_setpoint.unwrap();
        assert_eq!(
            (setpoint.values[0], setpoint.age[0]),
            ([1.0, 2.0, 3.0], 2.0)
        );
        assert!(states.notes[0].contains("ATT"), "{:?}", states.notes);
    }

    #[test]
    fn latitude_and_longitude_become_metres() {
        let pos = |name: &str, values: [f64; 2]| Column::new(name, "", values.to_vec());
        // A minute of arc north is a nautical mile; east, at 60°, half of one.
        let columns = vec![
            pos("Lat", [60.0, 60.0 + 1.0 / 60.0]),
            pos("Lng", [10.0, 10.0 + 1.0 / 60.0]),
            pos("Alt", [5.0, 7.0]),
        ];
        let topics = vec![
            topic(
                "ATT",
                0,
                &[1.0, 2.0],
                &[("Roll", 0.0), ("Pitch", 0.0), ("Yaw", 0.0)],
            ),
            Topic::new("POS", 0, vec![1.0, 2.0], columns).unwrap(),
        ];
        let states = find(&Log {
            topics,
            notes: Vec::new(),
        })
        .unwrap();
        let [north, east, down] = states.position.unwrap().values[1];
        // The nautical mile, 1852 m, is of the mean meridian; ArduPilot's sphere has the equator's radius, 0.2 % more.
        assert!((north - 1852.0).abs() < 5.0, "{north}");
        assert!((east - 926.0).abs() < 2.5, "{east}");
        assert_eq!(down, -2.0);
    }

    #[test]
    fn without_an_attitude_every_name_tried_is_told() {
        let log = Log {
            topics: vec![topic("XKF1", 0, &[1.0], &velocity(1.0))],
            notes: Vec::new(),
        };
        let missing = find(&log).unwrap_err().to_string();
        for name in ["vehicle_attitude.q[0]", "XKQ.Q1", "ATT.Roll", "qw qx qy qz"] {
            assert!(missing.contains(name), "{missing}");
        }
    }
}
