//! States as a plain table: how a CSV with a column map holds them, and how they are written as one.

use super::in_force::Topics;
use super::source::Source;
use super::{Family, Series, States};
use crate::{Column, Topic};

pub(super) const FAMILY: Family = Family {
    name: "plain",
    attitude: &[
        Source::quaternion(&[("", "qw"), ("", "qx"), ("", "qy"), ("", "qz")]),
        Source::angles(&[("", "roll"), ("", "pitch"), ("", "yaw")]),
    ],
    velocity: &[Source::vector(&[("", "vn"), ("", "ve"), ("", "vd")])],
    position: &[Source::vector(&[("", "pn"), ("", "pe"), ("", "pd")]).partly()],
    wind: &[
        Source::vector(&[("", "wn"), ("", "we"), ("", "wd")]),
        Source::horizontal(&[("", "wn"), ("", "we")]),
    ],
    air_velocity: &[Source::vector(&[("", "van"), ("", "vae"), ("", "vad")])],
    heading_setpoint: &[Source::scalar(&[("", "heading_sp")])],
    airspeed: &[Source::scalar(&[("", "airspeed")])],
    specific_force: &[Source::vector(&[("", "fx"), ("", "fy"), ("", "fz")])],
    attitude_setpoint: &[
        Source::quaternion(&[("", "qw_sp"), ("", "qx_sp"), ("", "qy_sp"), ("", "qz_sp")]),
        Source::angles(&[("", "roll_sp"), ("", "pitch_sp"), ("", "yaw_sp")]),
    ],
    position_setpoint: &[Source::vector(&[("", "pn_sp"), ("", "pe_sp"), ("", "pd_sp")]).partly()],
    velocity_setpoint: &[Source::vector(&[("", "vn_sp"), ("", "ve_sp"), ("", "vd_sp")]).partly()],
    acceleration_setpoint: &[
        Source::vector(&[("", "an_sp"), ("", "ae_sp"), ("", "ad_sp")]).partly(),
    ],
};

/// Units of its quantities, as they may be written: the first is that which is wanted.
const SPEED: &[&str] = &["m/s", "m s-1", "m*s^-1"];
const LENGTH: &[&str] = &["m"];
const ACCELERATION: &[&str] = &["m/s/s", "m/s²", "m/s^2", "m/s2"];
const ANGLE: &[&str] = &["rad", "radians"];
const NUMBER: &[&str] = &["1", "-"];

/// What of its columns is not to be read, if anything.
pub(super) fn doubt(topics: &Topics) -> Option<String> {
    let of = [
        (FAMILY.attitude, NUMBER),
        (FAMILY.velocity, SPEED),
        (FAMILY.position, LENGTH),
        (FAMILY.wind, SPEED),
        (FAMILY.air_velocity, SPEED),
        (FAMILY.airspeed, SPEED),
        (FAMILY.specific_force, ACCELERATION),
        (FAMILY.attitude_setpoint, NUMBER),
        (FAMILY.position_setpoint, LENGTH),
        (FAMILY.velocity_setpoint, SPEED),
        (FAMILY.acceleration_setpoint, ACCELERATION),
        (FAMILY.heading_setpoint, ANGLE),
    ];
    of.iter().find_map(|(sources, units)| {
        let columns = sources.iter().find_map(|source| source.find(topics))?;
        columns.doubt(units)
    })
}

impl States {
    /// The states as one plain table, `states`: each quantity that was found, and the age \[s\] of each as `qw_age`, `vn_age`
    /// and so on.
    #[must_use]
    pub fn topic(&self) -> Topic {
        let mut columns = Columns(Vec::new());
        columns.add(&FAMILY.attitude[0], "", Some(&self.attitude));
        columns.add(&FAMILY.velocity[0], "m/s", self.velocity.as_ref());
        columns.add(&FAMILY.position[0], "m", self.position.as_ref());
        columns.add(&FAMILY.wind[0], "m/s", self.wind.as_ref());
        let air = self.air_velocity.as_ref();
        columns.add(&FAMILY.air_velocity[0], "m/s", air);
        columns.add(&FAMILY.airspeed[0], "m/s", self.airspeed.as_ref());
        let force = self.specific_force.as_ref();
        columns.add(&FAMILY.specific_force[0], "m/s/s", force);
        let [attitude, position, velocity, acceleration] = [
            &FAMILY.attitude_setpoint[0],
            &FAMILY.position_setpoint[0],
            &FAMILY.velocity_setpoint[0],
            &FAMILY.acceleration_setpoint[0],
        ];
        columns.add(attitude, "", self.attitude_setpoint.as_ref());
        columns.add(position, "m", self.position_setpoint.as_ref());
        columns.add(velocity, "m/s", self.velocity_setpoint.as_ref());
        columns.add(acceleration, "m/s/s", self.acceleration_setpoint.as_ref());
        let heading = self.heading_setpoint.as_ref();
        columns.add(&FAMILY.heading_setpoint[0], "rad", heading);
        Topic::unchecked("states", self.time.clone(), columns.0)
    }
}

struct Columns(Vec<Column>);

impl Columns {
    /// Adds the components of `series` under the names of `plain`, and its age.
    fn add<const N: usize>(&mut self, plain: &Source, unit: &str, series: Option<&Series<N>>) {
        let Some(series) = series else { return };
        for (i, name) in plain.names().enumerate() {
            let component = |value: &[f64; N]| value.get(i).copied().unwrap_or(f64::NAN);
            let values = series.values.iter().map(component).collect();
            self.0.push(Column::new(name, unit, values));
        }
        let first = plain.names().next().unwrap_or_default();
        let age = series.age.clone();
        self.0.push(Column::new(&format!("{first}_age"), "s", age));
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Series, States, find};
    use crate::{Column, Log, Topic};

    #[test]
    fn a_plain_table_holds_the_states_it_was_made_of() {
        let series = |first: f64| Series {
            source: "somewhere".into(),
            values: vec![[f64::NAN; 3], [first, 0.5, -0.5]],
            age: vec![f64::INFINITY, 0.25],
            interval: 0.5,
        };
        let states = States {
            family: "plain",
            axes_of_hover: false,
            time: vec![1.0, 2.0],
            attitude: Series {
                source: String::new(),
                values: vec![[0.5; 4], [1.0, 0.0, 0.0, 0.0]],
                age: vec![0.0; 2],
                interval: 0.0,
            },
            velocity: Some(series(1.0)),
            position: Some(series(2.0)),
            wind: Some(series(3.0)),
            airspeed: Some(Series {
                source: String::new(),
                values: vec![[7.0], [8.0]],
                age: vec![0.0; 2],
                interval: 0.0,
            }),
            specific_force: Some(series(7.0)),
            air_velocity: Some(series(8.0)),
            heading_setpoint: None,
            attitude_setpoint: None,
            position_setpoint: Some(series(4.0)),
            velocity_setpoint: Some(series(5.0)),
            acceleration_setpoint: Some(series(6.0)),
            missing: Vec::new(),
            notes: Vec::new(),
        };
        let topic = states.topic();
        assert_eq!(
            topic.column("vn_age").unwrap().values,
            [f64::INFINITY, 0.25]
        );
        assert_eq!(topic.column("an_sp").unwrap().unit, "m/s/s");
        let back = find(&Log {
            topics: vec![topic],
            notes: Vec::new(),
        })
        .unwrap();
        assert_eq!(
            (back.family, &back.time, &back.attitude.values),
            ("plain", &states.time, &states.attitude.values)
        );
        let second = |series: &Option<Series<3>>| series.as_ref().unwrap().values[1];
        for (a, b) in [
            (&back.velocity, &states.velocity),
            (&back.position, &states.position),
            (&back.wind, &states.wind),
            (&back.specific_force, &states.specific_force),
            (&back.air_velocity, &states.air_velocity),
            (&back.position_setpoint, &states.position_setpoint),
            (&back.velocity_setpoint, &states.velocity_setpoint),
            (&back.acceleration_setpoint, &states.acceleration_setpoint),
        ] {
            assert_eq!(second(a), second(b));
        }
        assert_eq!(back.airspeed.unwrap().values, [[7.0], [8.0]]);
        assert_eq!(back.missing.len(), 1);
        assert_eq!(
            back.missing[0].to_string(),
            "no attitude set-point: none of qw_sp qx_sp qy_sp qz_sp, roll_sp pitch_sp yaw_sp"
        );
    }

    /// Roll, pitch and yaw in degrees, in radians where that is their unit; where nothing says which and one may be either, that is asked.
    #[test]
    fn angles_are_read_in_their_unit() {
        let table = |unit: &str, pitch: f64| {
            let column = |name: &str, value: f64| Column::new(name, unit, vec![value]);
            let columns = vec![
                column("roll", 0.0),
                column("pitch", pitch),
                column("yaw", 0.0),
            ];
            find(&Log {
                topics: vec![Topic::new("csv", 0, vec![1.0], columns).unwrap()],
                notes: Vec::new(),
            })
        };
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let quarter = std::f64::consts::FRAC_PI_2;
        for (unit, pitch) in [("", 90.0), ("deg", 90.0), ("°", 90.0), ("rad", quarter)] {
            let q = table(unit, pitch).unwrap().attitude.values[0];
            // Two roundings.
            assert!(
                (q[0] - half).abs() < 1e-15 && (q[2] - half).abs() < 1e-15,
                "{unit}: {q:?}"
            );
        }
        let asked = table("", quarter).unwrap_err().to_string();
        assert!(
            asked.starts_with("no unit of pitch: degrees or radians?"),
            "{asked}"
        );
        assert!(table("deg", quarter).is_ok());
    }

    /// An attitude asked for on some axes alone is none: no other stands for the angle that is not there. The rows beside it stay, and so does what is flown.
    #[test]
    fn an_attitude_set_point_without_an_axis_is_none() {
        let angles = ["roll", "pitch", "yaw"].map(|n| Column::new(n, "deg", vec![10.0; 5]));
        let rest = [0.0, 0.0, 90.0];
        let all = |columns: Vec<Column>| {
            let columns = angles.iter().cloned().chain(columns).collect();
            let time = vec![1.0, 2.0, 3.0, 4.0, 5.0];
            let log = Log {
                topics: vec![Topic::new("csv", 0, time, columns).unwrap()],
                notes: Vec::new(),
            };
            let states = find(&log).unwrap();
            assert!(
                states
                    .attitude
                    .values
                    .iter()
                    .flatten()
                    .all(|q| q.is_finite())
            );
            states.attitude_setpoint.unwrap().values
        };
        // In each row but the first and the last another angle is not asked for.
        let angle = |i: usize, name: &str| {
            let mut values = vec![rest[i]; 5];
            values[i + 1] = f64::NAN;
            Column::new(name, "deg", values)
        };
        let names = ["roll_sp", "pitch_sp", "yaw_sp"].into_iter().enumerate();
        let euler = all(names.map(|(i, name)| angle(i, name)).collect());
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let quaternion = ["qw_sp", "qx_sp", "qy_sp", "qz_sp"].into_iter().enumerate();
        let quaternion = all(quaternion
            .map(|(i, name)| {
                let mut values = vec![[half, 0.0, 0.0, half][i]; 5];
                if (1..4).contains(&i) {
                    values[i] = f64::NAN;
                }
                Column::new(name, "", values)
            })
            .collect());
        for values in [euler, quaternion] {
            for row in [0, 4] {
                let [w, x, y, z] = values[row];
                assert!((w - half).abs() + x.abs() + y.abs() + (z - half).abs() < 1e-15);
            }
            for row in &values[1..4] {
                assert!(row.iter().all(|q| q.is_nan()), "{values:?}");
            }
        }
    }

    /// Each axis has its own unit; words that are none are refused, and a pitch beyond 90°. Yaw and roll may go on beyond a turn.
    #[test]
    fn each_axis_has_its_own_unit() {
        let table = |units: [&str; 3], angles: [f64; 3], speed: &str| {
            let names = ["roll", "pitch", "yaw"].into_iter().zip(units);
            let angles = names.zip(angles);
            let columns = angles.map(|((name, unit), value)| Column::new(name, unit, vec![value]));
            let speeds = ["vn", "ve", "vd"].map(|name| Column::new(name, speed, vec![0.0]));
            find(&Log {
                topics: vec![
                    Topic::new("csv", 0, vec![1.0], columns.chain(speeds).collect()).unwrap(),
                ],
                notes: Vec::new(),
            })
        };
        let want = table(["deg"; 3], [20.0, 60.0, 30.0], "m/s")
            .unwrap()
            .attitude
            .values[0];
        let radians = [20.0, 60.0, 30.0_f64].map(f64::to_radians);
        for bits in 0..8 {
            let in_radians = |i: usize| bits >> i & 1 == 1;
            let units = [0, 1, 2].map(|i| if in_radians(i) { "rad" } else { "Degrees" });
            let angles = [0, 1, 2].map(|i| match in_radians(i) {
                true => radians[i],
                false => [20.0, 60.0, 30.0][i],
            });
            let got = table(units, angles, "").unwrap().attitude.values[0];
            // A few roundings.
            let close = std::iter::zip(got, want).all(|(a, b)| (a - b).abs() < 1e-14);
            assert!(close, "{units:?} {got:?} {want:?}");
        }
        let refusal = |units: [&str; 3], angles: [f64; 3], speed: &str| {
            table(units, angles, speed).unwrap_err().to_string()
        };
        for (units, angles, speed, says) in [
            (
                ["deg", "grad", "deg"],
                [0.0; 3],
                "m/s",
                "no unit `grad` known for pitch",
            ),
            (
                ["deg/s", "deg", "deg"],
                [0.0; 3],
                "m/s",
                "no unit `deg/s` known for roll",
            ),
            (
                ["deg"; 3],
                [0.0; 3],
                "km/h",
                "no unit `km/h` known for vn, which is read in m/s",
            ),
            (
                ["deg", "deg", ""],
                [0.0, 0.0, 6.2],
                "m/s",
                "no unit of yaw: degrees or radians? It may be either with yaw within 6.3",
            ),
            // In radians, with the nose at 80°, and a yaw that goes on beyond a turn or is in degrees.
            (
                [""; 3],
                [0.09, 1.396, 7.0],
                "m/s",
                "no unit of roll, pitch: degrees or radians?",
            ),
            (
                ["", "", "deg"],
                [-3.1, -1.57, 30.0],
                "m/s",
                "no unit of roll, pitch: degrees or radians?",
            ),
            (
                [""; 3],
                [0.0, 0.0, 7.0],
                "m/s",
                "no unit of pitch: degrees or radians?",
            ),
            // Each by itself.
            (
                [""; 3],
                [0.09, 20.0, 30.0],
                "m/s",
                "no unit of roll: degrees or radians?",
            ),
            (
                ["deg"; 3],
                [0.0, 800.0, 0.0],
                "m/s",
                "no attitude: the pitch in pitch is 800.0°",
            ),
            (
                ["rad"; 3],
                [0.0, 1.7, 0.0],
                "m/s",
                "no attitude: the pitch in pitch is 97.4°",
            ),
            (
                [""; 3],
                [0.0, 120.0, 0.0],
                "m/s",
                "no attitude: the pitch in pitch is 120.0°",
            ),
        ] {
            let message = refusal(units, angles, speed);
            assert!(message.starts_with(says), "{message}");
        }
        assert!(table(["deg"; 3], [-400.0, 90.4, 4000.0], "m/s").is_ok());
        assert!(table(["deg", "deg", ""], [0.0, 0.0, 350.0], "m/s").is_ok());
        // Each says by itself that it is in degrees.
        let unsaid = table([""; 3], [20.0, 60.0, 30.0], "m/s").unwrap();
        assert_eq!(unsaid.attitude.values[0], want);
    }

    /// What a map may name: of a plain table, or of an autopilot's topic.
    #[test]
    fn the_names_that_are_known_are_those_looked_for() {
        let plain = super::super::names("csv");
        for name in [
            "qw",
            "roll",
            "yaw",
            "vn",
            "wn",
            "airspeed",
            "pn_sp",
            "roll_sp",
            "heading_sp",
        ] {
            assert!(plain.contains(&name), "{name}");
        }
        assert!(!plain.contains(&"Q1") && plain.iter().filter(|name| **name == "wn").count() == 1);
        assert_eq!(super::super::names("XKQ"), ["Q1", "Q2", "Q3", "Q4"]);
    }
}
