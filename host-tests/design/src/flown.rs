//! What was flown, in rows: of a log that may be of any autopilot, in its units, with its gaps, and on the ground for a part of it.

use alula_logs::Log;
use alula_logs::states::{CEASED, States};
use nalgebra::Vector3;

use super::lag::{GAP, behind};

use super::reconstruct::{GRAVITY, attitudes};
use super::regression::Measured;
use super::velocity_lag::in_time;
use super::wind::{self, wind};

/// Angle of attack to the nose \[rad\] up to which c_L is taken for a line; from its negative.
pub(super) const ATTACHED: f64 = 0.19;
/// Least airspeed [m/s] whose angle of attack says something; least number of rows that make one unknown known.
pub(super) const SLOW: f64 = 3.0;
pub(super) const ROWS: usize = 40;
/// Rate [rad/s] from which on flight short of stall is no steady one.
pub(super) const TURNS: f64 = 0.25;
/// Throttle below which a vehicle that is slow does not fly.
const IDLE_THROTTLE: f64 = 0.02;
/// Share of the full torque that a mixer does not give, from which on it is at its stop.
const UNGIVEN: f64 = 0.01;
/// Rate of the rows \[Hz\].
pub(super) const RATE: f64 = 25.0;
/// Time in which the angle of attack is averaged \[s\].
const HELD: f64 = 4.0;

/// One row of what was flown.
#[derive(Clone, Copy, Default)]
pub(super) struct Row {
    pub(super) t: f64,
    /// Air velocity along the nose, the wing and the belly [m/s].
    pub(super) air: Vector3<f64>,
    /// Angle of attack in the mean of seconds \[rad\], that no gust decides.
    pub(super) held_alpha: f64,
    /// Specific force along nose and belly [m/s²].
    pub(super) force: [f64; 2],
    /// Specific force along the wing, to the right [m/s²].
    pub(super) side: f64,
    pub(super) throttle: f64,
    /// Rates about nose, wing and belly, asked and had [rad/s].
    pub(super) asked: Vector3<f64>,
    pub(super) rate: Vector3<f64>,
    /// The derivative of the pitch rate [rad/s²].
    pub(super) turn: f64,
    /// Sine of the climb angle.
    pub(super) climb: f64,
    /// Torque in pitch that was asked for, a share of the full one.
    pub(super) torque: f64,
    /// Whether the mixer could not give it.
    pub(super) short: bool,
    /// Velocity that was asked for, north, east and down [m/s].
    pub(super) wanted: Vector3<f64>,
}

impl Row {
    pub(super) fn alpha(&self) -> f64 {
        self.air.z.atan2(self.air.x)
    }

    pub(super) fn speed(&self) -> f64 {
        self.air.x.hypot(self.air.z)
    }

    /// Specific force across the path through the air, to the back [m/s²].
    pub(super) fn lift(&self) -> f64 {
        (self.force[0] * self.air.z - self.force[1] * self.air.x) / self.speed()
    }

    /// Whether it is on the wing, short of stall and steadily.
    pub(super) fn glides(&self) -> bool {
        self.speed() > 2.0 * SLOW && self.attached() && self.rate.y.abs() <= TURNS
    }

    /// Whether it turns in pitch or about its nose faster than in steady flight: it pulls, or its wing is not level.
    pub(super) fn turns(&self) -> bool {
        self.rate.x.abs() > TURNS || self.rate.y.abs() > TURNS
    }

    /// Whether it is on the wing, short of stall. Rows that gusts carry beyond are not left out: what is left would be of too small an angle.
    pub(super) fn attached(&self) -> bool {
        let short = self.held_alpha.abs() <= ATTACHED && self.alpha().abs() <= 1.5 * ATTACHED;
        self.speed() > SLOW && short
    }
}

/// Where a log may have a quantity: a column, what its values are multiplied by, and the unit that the log must give it, if any.
struct Source {
    topic: &'static str,
    column: &'static str,
    scale: f64,
    unit: Option<&'static str>,
}

const fn source(topic: &'static str, column: &'static str, scale: f64) -> Source {
    Source {
        topic,
        column,
        scale,
        unit: None,
    }
}

/// Rates of ArduPilot: those of logs without units are in hundredths of a degree, or in others.
const fn degrees(column: &'static str) -> Source {
    Source {
        topic: "RATE",
        column,
        scale: DEGREE,
        unit: Some("deg/s"),
    }
}

/// Of these columns the one that says something at the most rows of a time base, the first of equals; NaN where it says nothing, or has ceased.
fn held(log: &Log, sources: &[Source], base: &[f64]) -> Option<Vec<f64>> {
    let all = sources.iter().filter_map(|source| {
        let topic = log.topic(source.topic)?;
        let column = topic.column(source.column)?;
        if source.unit.is_some_and(|unit| column.unit != unit) {
            return None;
        }
        let held = topic.held_at(base);
        let values = held.values(column).into_iter().zip(&held.age);
        let fresh = values.map(|(value, age)| match *age <= CEASED {
            true => source.scale * value,
            false => f64::NAN,
        });
        Some(fresh.collect())
    });
    let says = |values: &Vec<f64>| values.iter().filter(|x| x.abs() > IDLE_THROTTLE).count();
    all.reduce(|best, next| match says(&next) > says(&best) {
        true => next,
        false => best,
    })
}

/// A throttle as a share of the full one: logs have it as that, per cent or per mille.
fn share_of_full(throttle: &mut [f64]) -> anyhow::Result<()> {
    let most = throttle.iter().copied().fold(0.0, f64::max);
    let full = [1.0, 100.0, 1000.0]
        .into_iter()
        .find(|full| most <= 1.05 * full);
    let full = full.ok_or_else(|| {
        anyhow::anyhow!(
            "a throttle of {most:.0} is no share of the full one, nor per cent or per mille of it"
        )
    })?;
    throttle.iter_mut().for_each(|x| *x /= full);
    Ok(())
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// What was flown, as it was logged and in rows at [`RATE`], and what is said of the log.
pub(super) struct Flown {
    pub(super) steps: Vec<Row>,
    pub(super) rows: Vec<Row>,
    /// Level wind in the mean, towards north and east [m/s], as airspeed and velocity show it.
    pub(super) wind: [Option<Measured>; 2],
    pub(super) notes: Vec<String>,
}

/// Least share of the velocity along the nose where an airspeed sensor says something.
const AHEAD: f64 = 0.85;

/// What was flown; the error says what is not in the log.
pub(super) fn flown(log: &Log, states: &States) -> anyhow::Result<Flown> {
    let mut notes = Vec::new();
    let need =
        |what: &str| anyhow::anyhow!("the log has no {what}: nothing is identified without it");
    let velocity = states.velocity.as_ref().ok_or_else(|| need("velocity"))?;
    let force = states
        .specific_force
        .as_ref()
        .ok_or_else(|| need("specific force"))?;
    let base = &states.time;
    // A tail-sitter's thrust is up in hover, an aeroplane's forward; older logs have it among the controls of the actuators.
    let throttle = [
        source("vehicle_thrust_setpoint", "xyz[2]", -1.0),
        source("vehicle_thrust_setpoint", "xyz[0]", 1.0),
        source("vehicle_rates_setpoint", "thrust_body[2]", -1.0),
        source("vehicle_rates_setpoint", "thrust_body[0]", 1.0),
        source("actuator_controls_0", "control[3]", 1.0),
        source("RATE", "AOut", 1.0),
        source("CTUN", "ThO", 1.0),
        source("CTUN", "ThrOut", 1.0),
    ];
    let mut throttle = held(log, &throttle, base).ok_or_else(|| need("throttle"))?;
    share_of_full(&mut throttle)?;
    let rates = [["xyz[0]", "R"], ["xyz[1]", "P"], ["xyz[2]", "Y"]].map(|[px4, ardupilot]| {
        [
            source("vehicle_angular_velocity", px4, 1.0),
            degrees(ardupilot),
        ]
    });
    let asked = [["roll", "RDes"], ["pitch", "PDes"], ["yaw", "YDes"]].map(|[px4, ardupilot]| {
        [
            source("vehicle_rates_setpoint", px4, 1.0),
            degrees(ardupilot),
        ]
    });
    let torque = [
        source("vehicle_torque_setpoint", "xyz[1]", 1.0),
        source("RATE", "POut", 1.0),
    ];
    let missing = [source(
        "control_allocator_status",
        "unallocated_torque[1]",
        1.0,
    )];
    let flags = [source("PIQP", "Flags", 1.0)];
    // What was asked for goes before what a controller made of where the vehicle was.
    let wanted = [
        ["velocity[0]", "vx", "PSCN", "DVN", "TVN"],
        ["velocity[1]", "vy", "PSCE", "DVE", "TVE"],
        ["velocity[2]", "vz", "PSCD", "DVD", "TVD"],
    ]
    .map(|[trajectory, local, topic, desired, target]| {
        [
            source("trajectory_setpoint", trajectory, 1.0),
            source("vehicle_local_position_setpoint", local, 1.0),
            source(topic, desired, 1.0),
            source(topic, target, 1.0),
        ]
    });
    let nan = || vec![f64::NAN; base.len()];
    // Of three axes, each of its own columns.
    let vectors = |axes: [&[Source]; 3]| -> Vec<Vector3<f64>> {
        let [x, y, z] = axes.map(|sources| held(log, sources, base).unwrap_or_else(nan));
        let rows = x.into_iter().zip(y).zip(z);
        rows.map(|((x, y), z)| Vector3::new(x, y, z)).collect()
    };
    let about = |axes: &[[Source; 2]; 3]| -> Vec<Vector3<f64>> {
        let told = vectors([&axes[0], &axes[1], &axes[2]]);
        let turned = told.into_iter().map(|of| match states.axes_of_hover {
            true => Vector3::new(-of.z, of.y, of.x),
            false => of,
        });
        turned.collect()
    };
    let (rate, asked) = (about(&rates), about(&asked));
    let wanted = vectors([&wanted[0], &wanted[1], &wanted[2]]);
    let torque = held(log, &torque, base).unwrap_or_else(nan);
    let missing = held(log, &missing, base).unwrap_or_else(nan);
    let flags = held(log, &flags, base).unwrap_or_else(nan);
    let mut steps: Vec<Row> = Vec::new();
    let (mut filtered, mut last): (f64, Option<(f64, f64)>) = (0.0, None);
    let attitudes = attitudes(states);
    let turned = attitudes.iter().zip(&force.values);
    let acceleration: Vec<Vector3<f64>> = turned
        .map(|(attitude, f)| attitude * Vector3::from(*f) + GRAVITY * Vector3::z())
        .collect();
    let velocities = in_time(base, &velocity.values, &acceleration);
    let airspeeds = states.airspeed.iter().flat_map(|airspeed| {
        let ahead = |n: &usize| {
            let nose = attitudes[*n] * Vector3::x();
            let moving = velocities[*n];
            moving.norm() > 2.0 * SLOW && moving.dot(&nose) > AHEAD * moving.norm()
        };
        let told = (0..base.len()).filter(|n| airspeed.overdue(*n) <= CEASED);
        let told = told.filter(|n| airspeed.values[*n][0] > 2.0 * SLOW);
        told.filter(ahead).map(|n| wind::Sample {
            t: base[n],
            ground: velocities[n],
            airspeed: airspeed.values[n][0],
        })
    });
    let seen = wind(&airspeeds.collect::<Vec<_>>());
    let blown = seen.map(|of_axis| of_axis.map_or(0.0, |m| m.value));
    if states.wind.is_none() && states.air_velocity.is_none() {
        notes.push(
            match seen {
                [None, None] => "No wind is logged: it is taken for calm, and what is in the air is in the intervals. A circle with the airspeed in the log shows it",
                _ => "No wind is logged: it is taken for what airspeed and velocity show of it in the mean",
            }
            .to_owned(),
        );
    }
    if seen.contains(&None) {
        notes.push("Wind: a circle on the wing, or level flight to and fro across and along it, a minute and more, with the airspeed in the log".to_owned());
    }
    for ((n, &t), attitude) in base.iter().enumerate().zip(attitudes) {
        // The derivative of the rate through a filter of 30 ms.
        if let Some((then, before)) = last {
            let dt = (t - then).max(1e-4);
            let share = 1.0 - (-dt / 0.03).exp();
            filtered += share * ((rate[n].y - before) / dt - filtered);
        }
        if rate[n].y.is_finite() {
            last = Some((t, rate[n].y));
        }
        let moving = velocities[n];
        let through = match (&states.air_velocity, &states.wind) {
            (Some(air), _) if air.values[n][0].is_finite() => Vector3::from(air.values[n]),
            (_, Some(wind)) if wind.values[n][0].is_finite() => {
                moving - Vector3::from(wind.values[n])
            }
            _ => moving - Vector3::new(blown[0], blown[1], 0.0),
        };
        let [nose, side, belly] = force.values[n];
        if velocity.overdue(n) > CEASED || force.overdue(n) > CEASED {
            continue;
        }
        let row = Row {
            t,
            air: attitude.inverse_transform_vector(&through),
            held_alpha: f64::NAN,
            force: [nose, belly],
            side,
            throttle: throttle[n],
            asked: asked[n],
            rate: rate[n],
            turn: filtered,
            climb: -moving.z / moving.norm().max(SLOW),
            torque: torque[n],
            // The first flag of ArduPilot's loops: the output is saturated.
            short: missing[n].abs() > UNGIVEN || flags[n] % 2.0 == 1.0,
            wanted: wanted[n],
        };
        let numbers = [row.air.x, row.air.z, nose, belly, row.throttle];
        if numbers.iter().all(|x| x.is_finite())
            && (row.throttle > IDLE_THROTTLE || row.speed() > SLOW)
        {
            steps.push(row);
        }
    }
    hovers_along_the_nose(&mut steps)?;
    let together = |a: &Row, b: &Row| (RATE * a.t).floor() == (RATE * b.t).floor();
    let mut rows: Vec<Row> = steps.chunk_by(together).map(mean).collect();
    let held: Vec<f64> = rows
        .iter()
        .map(|row| {
            let near = around(&rows, row.t, HELD)
                .iter()
                .filter(|row| row.speed() > SLOW);
            let angles: Vec<f64> = near.map(Row::alpha).collect();
            angles.iter().sum::<f64>() / angles.len() as f64
        })
        .collect();
    for (row, held) in rows.iter_mut().zip(held) {
        row.held_alpha = held;
    }
    let percent = |has: usize| has as f64 / base.len().max(1) as f64 * 100.0;
    let finite =
        |values: &dyn Fn(usize) -> f64| (0..base.len()).filter(|n| values(*n).is_finite()).count();
    anyhow::ensure!(
        rows.len() > 10 * ROWS,
        "{:.0} s of flight with velocity, specific force and throttle: it takes {:.0} s and more. Of the log's {:.0} s velocity is in {:.0} %, specific force in {:.0} %, \
         throttle in {:.0} %, and it flies, not stands, in {:.0} %",
        rows.len() as f64 / RATE,
        10.0 * ROWS as f64 / RATE,
        base.last().unwrap_or(&0.0) - base.first().unwrap_or(&0.0),
        percent(finite(&|n| velocity.values[n][0])),
        percent(finite(&|n| force.values[n][0])),
        percent(finite(&|n| throttle[n])),
        percent(steps.len()),
    );
    Ok(Flown {
        steps,
        rows,
        wind: seen,
        notes,
    })
}

/// Leaves out what is slow while the force on it is not along the nose: it stands on the ground, on its wheels or its belly.
///
/// # Errors
/// It climbs and sinks so: what carries it in hover is no thrust along the nose.
fn hovers_along_the_nose(steps: &mut Vec<Row>) -> anyhow::Result<()> {
    /// Climb rate in the air [m/s], and the time of it that is no touch of the ground \[s\].
    const AIRBORNE: [f64; 2] = [0.5, 2.0];
    let across = |row: &Row| {
        let [nose, belly] = row.force;
        row.speed() < SLOW && nose < 0.5 * nose.hypot(belly)
    };
    let airborne = |row: &&Row| row.speed() < SLOW && row.climb.abs() * SLOW > AIRBORNE[0];
    let time = |of: &dyn Fn(&Row) -> bool| {
        let pairs = steps.iter().zip(steps.iter().skip(1));
        let of = pairs.filter(|(row, _)| airborne(row) && of(row));
        of.map(|(row, next)| (next.t - row.t).min(GAP)).sum::<f64>()
    };
    let (wrong, right) = (time(&across), time(&|row| !across(row)));
    anyhow::ensure!(
        wrong < AIRBORNE[1] || wrong < right,
        "in {wrong:.0} s of slow climbs and sinks the force on it is across the nose: it hovers as a multirotor or a quadplane, or its log is read 90° off. \
         Nothing is identified of a vehicle that does not thrust along its nose"
    );
    steps.retain(|row| !across(row));
    Ok(())
}

/// The rows of a time around `t`.
pub(super) fn around(rows: &[Row], t: f64, time: f64) -> &[Row] {
    let at = |t: f64| rows.partition_point(|row| row.t < t);
    &rows[at(t - 0.5 * time)..at(t + 0.5 * time)]
}

/// The mean of what was flown in one row.
fn mean(of: &[Row]) -> Row {
    let share = 1.0 / of.len() as f64;
    let mean = |value: &dyn Fn(&Row) -> f64| share * of.iter().map(value).sum::<f64>();
    let vector =
        |value: &dyn Fn(&Row) -> Vector3<f64>| share * of.iter().map(value).sum::<Vector3<f64>>();
    Row {
        t: mean(&|row| row.t),
        air: vector(&|row| row.air),
        held_alpha: f64::NAN,
        force: [0, 1].map(|axis| mean(&|row| row.force[axis])),
        side: mean(&|row| row.side),
        throttle: mean(&|row| row.throttle),
        asked: vector(&|row| row.asked),
        rate: vector(&|row| row.rate),
        turn: mean(&|row| row.turn),
        climb: mean(&|row| row.climb),
        torque: mean(&|row| row.torque),
        short: of.iter().any(|row| row.short),
        wanted: vector(&|row| row.wanted),
    }
}

/// The throttle behind the lag \[s\] of the motors' speed, at each row.
pub(super) fn lagged(rows: &[Row], lag: f64) -> Vec<f64> {
    let speeds = behind(
        rows.iter().map(|row| [row.t, row.throttle.max(0.0).sqrt()]),
        lag,
    );
    speeds.iter().map(|speed| speed.value.powi(2)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_logs::{Column, Topic};

    fn log(topic: &str, columns: &[(&str, &str, f64)]) -> Log {
        let time: Vec<f64> = (0..20).map(|n| 0.1 * f64::from(n)).collect();
        let columns = columns
            .iter()
            .map(|(name, unit, value)| Column::new(name, unit, vec![*value; 20]));
        Log {
            topics: vec![Topic::new(topic, 0, time.clone(), columns.collect()).unwrap()],
            notes: Vec::new(),
        }
    }

    /// An aeroplane's thrust is forward, and nothing is up; what has ceased says nothing; a rate of no unit is none.
    #[test]
    fn a_column_that_says_something_is_taken_while_it_does() {
        let sources = [
            source("vehicle_thrust_setpoint", "xyz[2]", -1.0),
            source("vehicle_thrust_setpoint", "xyz[0]", 1.0),
        ];
        let plane = [("xyz[0]", "", 0.6), ("xyz[2]", "", 0.0)];
        let plane = log("vehicle_thrust_setpoint", &plane);
        let values = held(&plane, &sources, &[1.0, 1.9 + CEASED, 2.1 + CEASED]).unwrap();
        assert_eq!(values[..2], [0.6; 2]);
        assert!(values[2].is_nan());
        let rate = |unit| held(&log("RATE", &[("P", unit, 90.0)]), &[degrees("P")], &[1.0]);
        assert_eq!(rate("deg/s"), Some(vec![90.0 * DEGREE]));
        assert_eq!(rate(""), None);
    }

    #[test]
    fn a_throttle_is_a_share_per_cent_or_per_mille() {
        for full in [1.0, 100.0, 1000.0] {
            let mut throttle = [0.2 * full, f64::NAN, 0.9 * full];
            share_of_full(&mut throttle).unwrap();
            assert!((throttle[2] - 0.9).abs() < 1e-12 && throttle[1].is_nan());
        }
        assert!(share_of_full(&mut [1500.0]).is_err());
    }
}
