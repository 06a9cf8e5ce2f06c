//! ArduPilot's messages.
//!
//! Read in ArduPilot/ardupilot: `libraries/AP_NavEKF3/LogStructure.h` (`XKQ`: quaternion; `XKF1`: roll, pitch, yaw,
//! velocity, position; `XKF2`: wind), `libraries/AP_NavEKF2/LogStructure.h` (`NKQ`, `NKF1`, `NKF2`),
//! `libraries/AP_AHRS/LogStructure.h` (`AHR2`, `ATT`, `POS`), `libraries/AP_Logger/LogStructure.h` (`ARSP`),
//! `libraries/AP_InertialSensor/LogStructure.h` (`IMU`),
//! `libraries/AC_AttitudeControl/LogStructure.h` (`PSCN`, `PSCE`, `PSCD`: position, velocity, acceleration asked for by the
//! position controller, per axis). `XKQ1`, `NKQ1`: the quaternions of versions in which each instance had its own message. Until 2016 there was one
//! estimator, `EKF1` (as `NKF1`) and `EKF2` (wind); without any, `GPS` has the velocity: speed, course and velocity down.
//!
//! The quaternions are those of `Quaternion::rotation_matrix` (`libraries/AP_Math/quaternion.cpp`), which `AP_NavEKF3_core.cpp`
//! uses as the rotation from the body to north-east-down: w, x, y, z as PX4's.

use super::Family;
use super::source::Source;

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
        Source::angles(&[("XKF1", "Roll"), ("XKF1", "Pitch"), ("XKF1", "Yaw")]),
        Source::angles(&[("NKF1", "Roll"), ("NKF1", "Pitch"), ("NKF1", "Yaw")]),
        Source::angles(&[("EKF1", "Roll"), ("EKF1", "Pitch"), ("EKF1", "Yaw")]),
        Source::quaternion(&[
            ("AHR2", "Q1"),
            ("AHR2", "Q2"),
            ("AHR2", "Q3"),
            ("AHR2", "Q4"),
        ]),
        Source::angles(&[("ATT", "Roll"), ("ATT", "Pitch"), ("ATT", "Yaw")]),
    ],
    velocity: &[
        Source::vector(&[("XKF1", "VN"), ("XKF1", "VE"), ("XKF1", "VD")]),
        Source::vector(&[("NKF1", "VN"), ("NKF1", "VE"), ("NKF1", "VD")]),
        Source::vector(&[("EKF1", "VN"), ("EKF1", "VE"), ("EKF1", "VD")]),
        Source::vector(&[("PSCN", "VN"), ("PSCE", "VE"), ("PSCD", "VD")]),
        Source::course(&[("GPS", "Spd"), ("GPS", "GCrs"), ("GPS", "VZ")]),
    ],
    position: &[
        Source::vector(&[("XKF1", "PN"), ("XKF1", "PE"), ("XKF1", "PD")]),
        Source::vector(&[("NKF1", "PN"), ("NKF1", "PE"), ("NKF1", "PD")]),
        Source::vector(&[("EKF1", "PN"), ("EKF1", "PE"), ("EKF1", "PD")]),
        Source::geodetic(&[("POS", "Lat"), ("POS", "Lng"), ("POS", "Alt")]),
        Source::geodetic(&[("GPS", "Lat"), ("GPS", "Lng"), ("GPS", "Alt")]),
    ],
    wind: &[
        Source::horizontal(&[("XKF2", "VWN"), ("XKF2", "VWE")]),
        Source::horizontal(&[("NKF2", "VWN"), ("NKF2", "VWE")]),
        Source::horizontal(&[("EKF2", "VWN"), ("EKF2", "VWE")]),
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
    position_setpoint: &[
        Source::vector(&[("PSCN", "TPN"), ("PSCE", "TPE"), ("PSCD", "TPD")]).partly(),
    ],
    velocity_setpoint: &[
        Source::vector(&[("PSCN", "TVN"), ("PSCE", "TVE"), ("PSCD", "TVD")]).partly(),
    ],
    acceleration_setpoint: &[
        Source::vector(&[("PSCN", "TAN"), ("PSCE", "TAE"), ("PSCD", "TAD")]).partly(),
    ],
};

/// What is said of a velocity that a receiver of satellites gives.
pub(super) const GPS_NOTE: &str =
    "velocity from GPS alone, some 0.1 to 0.2 s late: no estimator's is logged";

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

    /// Firmware before `ATT.AEKF`: of EKF2 and EKF3 the one that is taken is named, and of either alone nothing is said.
    #[test]
    fn an_estimator_that_nothing_says_to_be_in_force_is_noted() {
        let q = [("Roll", 0.0), ("Pitch", 0.0), ("Yaw", 0.0)];
        let of = |name: &str, vn: f64| topic(name, 0, &[1.0], &[&velocity(vn)[..], &q].concat());
        let velocity_of = |topics: &[Topic]| {
            let topics = topics.to_vec();
            let states = find(&Log {
                topics,
                notes: Vec::new(),
            })
            .unwrap();
            let told = states.notes.iter().any(|note| {
                note == "EKF2 and EKF3: no ATT.AEKF says which of them was in force: EKF3 is taken"
            });
            (states.velocity.unwrap().values[0][0], told)
        };
        let (two, three) = (of("NKF1", 5.0), of("XKF1", 50.0));
        assert_eq!(velocity_of(&[two.clone(), three.clone()]), (50.0, true));
        assert_eq!(velocity_of(std::slice::from_ref(&two)), (5.0, false));
        assert_eq!(velocity_of(std::slice::from_ref(&three)), (50.0, false));
        let says = topic("ATT", 0, &[0.0], &[&q[..], &[("AEKF", 2.0)]].concat());
        assert_eq!(velocity_of(&[two, three, says]), (5.0, false));
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

    fn find_in(topics: Vec<Topic>) -> super::super::States {
        find(&Log {
            topics,
            notes: Vec::new(),
        })
        .unwrap()
    }

    /// Rows at 1, 2, 3 and 4 s with these values of one column, the others as given.
    fn rows(name: &str, instance: u8, changing: (&str, [f64; 4]), same: &[(&str, f64)]) -> Topic {
        let own = Column::new(changing.0, "", changing.1.to_vec());
        let rest = same
            .iter()
            .map(|(name, value)| Column::new(name, "", vec![*value; 4]));
        let columns = [own].into_iter().chain(rest).collect();
        Topic::new(name, instance, vec![1.0, 2.0, 3.0, 4.0], columns).unwrap()
    }

    /// The estimator's core in force is taken row by row: in messages with instances, and in those of old versions, where each core had names of
    /// its own, of either estimator; and the accelerometer that goes with it.
    #[test]
    fn a_change_of_the_primary_core_is_followed() {
        const LEVEL: [(&str, f64); 2] = [("Roll", 0.0), ("Yaw", 0.0)];
        let still = [("VE", 0.0), ("VD", 0.0)];
        for (names, instances) in [
            ([["XKF1", "XKF1"], ["XKF4", "XKF4"]], [0, 1]),
            ([["XKF1", "XKF6"], ["XKF4", "XKF9"]], [0, 0]),
            ([["NKF1", "NKF1"], ["NKF4", "NKF4"]], [0, 1]),
            ([["NKF1", "NKF6"], ["NKF4", "NKF9"]], [0, 0]),
        ] {
            let [[first, second], [status, other]] = names;
            let core = |name: &str, instance: u8, speed: f64, pitch: f64| {
                let same: Vec<_> = still.iter().chain(&LEVEL).copied().collect();
                rows(
                    name,
                    instance,
                    ("VN", [speed; 4]),
                    &[&same[..], &[("Pitch", pitch)]].concat(),
                )
            };
            let primary = ("PI", [0.0, 0.0, 1.0, 1.0]);
            let states = find_in(vec![
                core(first, instances[0], 5.0, 80.0),
                core(second, instances[1], 7.0, 90.0),
                rows(status, instances[0], primary, &[]),
                rows(other, instances[1], primary, &[]),
                rows(
                    "IMU",
                    0,
                    ("AccX", [1.0; 4]),
                    &[("AccY", 0.0), ("AccZ", 0.0)],
                ),
                rows(
                    "IMU",
                    1,
                    ("AccX", [2.0; 4]),
                    &[("AccY", 0.0), ("AccZ", 0.0)],
                ),
            ]);
            assert_eq!(states.time, [1.0, 2.0, 3.0, 4.0], "{names:?}");
            let north = |row: usize| states.velocity.as_ref().unwrap().values[row][0];
            assert_eq!([0, 1, 2, 3].map(north), [5.0, 5.0, 7.0, 7.0], "{names:?}");
            let force = |row: usize| states.specific_force.as_ref().unwrap().values[row][0];
            assert_eq!([0, 1, 2, 3].map(force), [1.0, 1.0, 2.0, 2.0], "{names:?}");
            // cos 40° and cos 45° of the quaternion of a pitch.
            let up = |row: usize| states.attitude.values[row][0];
            assert!((up(1) - 40_f64.to_radians().cos()).abs() < 1e-12);
            assert!((up(2) - 45_f64.to_radians().cos()).abs() < 1e-12);
            let note = &states.notes[0];
            assert!(
                note.contains("the primary changed from 0 to 1 at 3 s"),
                "{note}"
            );
        }
    }

    /// Of two estimators the one that flies is taken, and a change between them is followed.
    #[test]
    fn the_estimator_in_force_is_taken() {
        let of = |active: [f64; 4]| {
            let angles = [("Roll", 0.0), ("Pitch", 0.0), ("Yaw", 0.0)];
            let still = [&[("VE", 0.0), ("VD", 0.0)][..], &angles].concat();
            find_in(vec![
                rows("XKF1", 0, ("VN", [3.0; 4]), &still),
                rows("NKF1", 0, ("VN", [2.0; 4]), &still),
                rows("XKF4", 0, ("PI", [0.0; 4]), &[]),
                rows("NKF4", 0, ("PI", [0.0; 4]), &[]),
                rows("ATT", 0, ("AEKF", active), &angles),
            ])
        };
        let north = |states: &super::super::States| {
            let values = states.velocity.as_ref().unwrap().values.iter();
            values.map(|v| v[0]).collect::<Vec<_>>()
        };
        assert_eq!(north(&of([3.0; 4])), [3.0; 4]);
        assert_eq!(north(&of([2.0; 4])), [2.0; 4]);
        let changed = of([3.0, 3.0, 2.0, 2.0]);
        assert_eq!(north(&changed), [3.0, 3.0, 2.0, 2.0]);
        let note = &changed.notes[0];
        assert!(note.contains("from EKF3 0 to EKF2 0 at 3 s"), "{note}");
        // Without the estimators, for a while.
        let fallen = of([3.0, 0.0, 0.0, 3.0]);
        assert_eq!(north(&fallen), [3.0; 4]);
        assert!(fallen.notes[0].contains("in 2 of 4 rows another estimator"));
    }

    /// A log without an estimator has GPS; a receiver that is not in use, or does not know where it is, says nothing.
    #[test]
    fn velocity_from_the_receiver_in_use() {
        let attitude = rows(
            "ATT",
            0,
            ("Roll", [0.0; 4]),
            &[("Pitch", 0.0), ("Yaw", 0.0)],
        );
        let receiver = |instance: u8, used: [f64; 4], status: f64, speed: f64| {
            let same = [
                ("Status", status),
                ("Spd", speed),
                ("GCrs", 90.0),
                ("VZ", 1.0),
                ("Lat", 1.0),
                ("Lng", 2.0),
                ("Alt", 3.0),
            ];
            rows("GPS", instance, ("U", used), &same)
        };
        let states = find_in(vec![
            attitude.clone(),
            receiver(0, [1.0, 1.0, 0.0, 0.0], 3.0, 5.0),
            receiver(1, [0.0, 0.0, 1.0, 1.0], 4.0, 6.0),
        ]);
        let velocity = states.velocity.unwrap();
        let east: Vec<f64> = velocity.values.iter().map(|v| v[1]).collect();
        assert_eq!(east, [5.0, 5.0, 6.0, 6.0]);
        // cos 90° of the course; and down as it is.
        assert!(velocity.values[0][0].abs() < 1e-12 && velocity.values[0][2] == 1.0);
        assert_eq!(states.position.unwrap().values[3], [0.0; 3]);
        for part in [
            "GPS: the primary changed from 0 to 1 at 3 s",
            "velocity from GPS alone",
        ] {
            assert!(
                states.notes.iter().any(|note| note.contains(part)),
                "{:?}",
                states.notes
            );
        }
        let blind = find_in(vec![attitude, receiver(0, [1.0; 4], 1.0, 5.0)]);
        assert!(blind.velocity.is_none() && blind.position.is_none());
    }

    #[test]
    fn the_primary_airspeed_sensor_is_taken() {
        let sensor = |instance: u8, airspeed: f64| {
            rows(
                "ARSP",
                instance,
                ("Pri", [0.0, 0.0, 1.0, 1.0]),
                &[("Airspeed", airspeed)],
            )
        };
        let attitude = rows(
            "ATT",
            0,
            ("Roll", [0.0; 4]),
            &[("Pitch", 0.0), ("Yaw", 0.0)],
        );
        let states = find_in(vec![attitude, sensor(0, 10.0), sensor(1, 12.0)]);
        assert_eq!(
            states.airspeed.unwrap().values,
            [[10.0], [10.0], [12.0], [12.0]]
        );
    }

    /// ArduPilot of before 2016: one estimator, EKF1.
    #[test]
    fn the_first_estimator_is_read() {
        let angles = [("Roll", 0.0), ("Pitch", 90.0), ("Yaw", 0.0)];
        let motion = [
            ("VE", 2.0),
            ("VD", 3.0),
            ("PN", 4.0),
            ("PE", 5.0),
            ("PD", 6.0),
        ];
        let states = find_in(vec![
            rows(
                "EKF1",
                0,
                ("VN", [1.0; 4]),
                &[&angles[..], &motion].concat(),
            ),
            rows("EKF2", 0, ("VWN", [7.0; 4]), &[("VWE", 8.0)]),
        ]);
        assert!(states.attitude.source.starts_with("EKF1.Roll"));
        assert_eq!(states.velocity.unwrap().values[0], [1.0, 2.0, 3.0]);
        assert_eq!(states.position.unwrap().values[0], [4.0, 5.0, 6.0]);
        assert_eq!(states.wind.unwrap().values[0], [7.0, 8.0, 0.0]);
    }

    /// An altitude alone is asked for where the others are not logged.
    #[test]
    fn set_points_of_one_axis_are_read() {
        let states = find_in(vec![
            rows(
                "ATT",
                0,
                ("Roll", [0.0; 4]),
                &[("Pitch", 0.0), ("Yaw", 0.0)],
            ),
            rows("PSCD", 0, ("TPD", [-20.0; 4]), &[("TVD", 1.0)]),
        ]);
        let [north, east, down] = states.position_setpoint.unwrap().values[0];
        assert!(north.is_nan() && east.is_nan() && down == -20.0);
        assert_eq!(states.velocity_setpoint.unwrap().values[0][2], 1.0);
    }

    /// The estimator names a core that the log does not hold: that is said, and no other core stands for it. What ArduPilot flies by is in ATT, too.
    #[test]
    fn a_core_that_is_not_logged_is_said() {
        let still = [("VE", 0.0), ("VD", 0.0), ("Roll", 0.0), ("Yaw", 0.0)];
        let core = |instance: u8, pitch: f64| {
            let same = [&still[..], &[("Pitch", pitch)]].concat();
            rows("XKF1", instance, ("VN", [5.0; 4]), &same)
        };
        let attitude = || rows("ATT", 0, ("Pitch", [70.0; 4]), &still[2..]);
        let of = |primary: [f64; 4]| {
            let status = rows("XKF4", 0, ("PI", primary), &[]);
            find_in(vec![core(0, 80.0), core(1, 90.0), status, attitude()])
        };
        let never = of([2.0; 4]);
        assert!(never.velocity.is_none() && never.attitude.source.starts_with("ATT."));
        let note = "EKF3 core 2, in force from 0 s on, has no XKF1 in the log";
        assert!(never.notes[0].starts_with(note), "{:?}", never.notes);
        // From 3 s on: the rows before are those of core 1.
        let later = of([1.0, 1.0, 2.0, 2.0]);
        assert_eq!(later.time, [1.0, 2.0]);
        assert!(
            later
                .notes
                .iter()
                .any(|note| note.contains("core 2, in force from 3 s on"))
        );
        // Nothing says which is in force: the first, and that is said.
        let unsaid = find_in(vec![core(1, 90.0), core(3, 80.0), attitude()]);
        assert!((unsaid.attitude.values[0][0] - 45_f64.to_radians().cos()).abs() < 1e-12);
        let note = "EKF3: no XKF4.PI says which of its 2 cores was in force: core 1 is taken";
        assert_eq!(unsaid.notes[0], note);
    }
}
