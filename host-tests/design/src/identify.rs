//! A vehicle learned from the log of a flight: by regression of the specific force and of the angular acceleration on what is known of them
//! (equation error; Klein and Morelli, *Aircraft System Identification*, chapter 5).
//!
//! Forces over the mass, with the throttle u behind the lag of the motors, along the nose and along the belly:
//!
//! | | |
//! |---|---|
//! | f_x | T_0/m (u − 0.75 J √u − 1.08 J²) + V² k_a/m (c_L sin α − c_D cos α), J = v_x/V_1 |
//! | f_z | −V² k_a/m (c_L cos α + c_D sin α) + s ω̇_y |
//! | c_L, c_D | short of stall c_L0 + c_Lα α, and one c_D; beyond it constants of each ten degrees |
//!
//! The propeller is one of a family: C_T over advance ratio as small ones have it, V_1 being its tip's advance at full throttle over π. V_1 is
//! searched, and V_1 is in the covariance by its derivative. The lag is that of the force along the nose in hover, by `response_lag`.
//! The attitude is the one that goes with accelerometer and velocity, not the one that was told: `reconstruct`.
//!
//! Short of stall the angle of attack that an estimator tells lacks the gusts, and the vehicle moves with them: a regression on it finds too small a slope.
//! So α there is what the flight has in the mean at its airspeed and climb (two-stage least squares, the instruments 1, 1/V² and the climb angle).
//!
//! Intervals are of 95 %, from the residuals in blocks of seconds: the errors of gusts and of lags last.

use alula_logs::Log;
use alula_logs::states::{CEASED, States};
use nalgebra::{DMatrix, DVector, Vector3};
use serde::Serialize;

use super::drag::{Glide, drag};
use super::known::Actuators;
use super::reconstruct::attitudes;
use super::regression::{Fit, Measured, deviations, least_squares};
use super::response_lag::{Sample, response_lag};

/// What a person knows besides the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// m \[kg\].
    pub mass_kg: f64,
    /// Area of the wing \[m²\].
    pub wing_m2: f64,
    /// Density of the air \[kg/m³\].
    pub air_kg_m3: f64,
}

/// Angular acceleration in pitch in hover [rad/s²].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Turn {
    /// The greatest that was had.
    pub had: f64,
    /// Whether the torque was at its stop meanwhile, where torques are logged: else there may be more.
    pub at_stop: bool,
}

/// Coefficients behind the stall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Beyond {
    /// α \[°\].
    pub alpha_deg: f64,
    /// c_L.
    pub c_l: Measured,
    /// c_D.
    pub c_d: Measured,
}

/// What a flight shows.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Identified {
    /// Time that was looked at, and held out \[s\].
    pub seconds: [f64; 2],
    /// Static thrust of full throttle over the weight.
    pub thrust_to_weight: Option<Measured>,
    /// Airspeed along the nose at which full throttle gives no thrust [m/s].
    pub zero_thrust_speed_m_s: Option<Measured>,
    /// Lag of the thrust \[s\].
    pub thrust_lag_s: Option<Measured>,
    /// Lag of the pitch rate \[s\].
    pub rate_lag_s: Option<Measured>,
    /// Pitch rate that is had, over what is asked.
    pub rate_share: Option<f64>,
    /// Angular acceleration in pitch in hover.
    pub turn_rad_s2: Option<Turn>,
    /// c_L at α = 0 to the nose.
    pub c_l_0: Option<Measured>,
    /// Slope of c_L \[1/rad\].
    pub c_l_alpha: Option<Measured>,
    /// Angle of zero lift to the nose \[°\].
    pub zero_lift_deg: Option<Measured>,
    /// c_D at the c_L of cruise, and that c_L.
    pub c_d_cruise: Option<(Measured, f64)>,
    /// Coefficients behind the stall.
    pub beyond: Vec<Beyond>,
    /// Acceleration towards the belly per angular acceleration \[m\].
    pub surface_reaction_m: Option<Measured>,
    /// Share of the variance of the specific force along nose and belly that is predicted, on data that was not fitted.
    pub predicted: [f64; 2],
    /// Median of the airspeed on the wing [m/s].
    pub flown_m_s: Option<f64>,
    /// Specific force along nose and belly, measured and predicted, of what was held out: time \[s\], and four values.
    #[serde(skip)]
    pub held_out: Vec<[f64; 5]>,
    /// What the flight does not show, and which manoeuvre would.
    pub missing: Vec<String>,
}

/// Angle of attack to the nose \[rad\] up to which c_L is taken for a line; from its negative.
const ATTACHED: f64 = 0.19;
/// Width of what is constant beyond \[rad\].
const BIN: f64 = std::f64::consts::PI / 18.0;
/// Least airspeed [m/s] whose angle of attack says something; least number of rows that make one unknown known.
const SLOW: f64 = 3.0;
const ROWS: usize = 40;
/// Lengths of blocks whose residuals are taken for independent, and of what is fitted and held out in turn \[s\].
const BLOCK: f64 = 10.0;
const TURN: f64 = 10.0;
/// Time \[s\] after which residuals of a lag say something anew.
const ANEW: f64 = 2.0;
/// What the models themselves lack, shares of the value of 95 %: a wing in the slipstream, a battery that sags and a propeller of another family; loops that
/// are no lag of first order; elevons that trim another glide than cruise. Of the size that simulated vehicles of three kinds show.
struct Lacking {
    thrust: f64,
    thrust_lag: f64,
    rate_lag: f64,
    drag: f64,
}

const LACKING: Lacking = Lacking {
    thrust: 0.07,
    thrust_lag: 0.2,
    rate_lag: 0.35,
    drag: 0.17,
};
/// Advance ratio, over the one that is without thrust, from which on a propeller idles, whatever is wrong of that one.
const IDLE: f64 = 2.0;
/// Area of the wing in the slipstream over that of the propellers' discs, up to twice which is taken for possible: 4/π of chord over diameter.
const BLOWN: f64 = 0.7;
/// Share of the square of the specific force that a model predicts, where it is one of the vehicle.
const PREDICTED: f64 = 0.5;
/// Times in which the lift and the angle of attack are averaged \[s\].
const MEAN: f64 = 2.0;
const HELD: f64 = 4.0;
/// Lag of the thrust that is assumed where the flight shows none \[s\].
const ASSUMED_LAG: f64 = 0.08;
/// Pitch rate [rad/s] from which on flight short of stall is no steady one.
const TURNS: f64 = 0.25;
/// Throttle below which a vehicle that is slow does not fly.
const IDLE_THROTTLE: f64 = 0.02;
/// A gap \[s\] after which what was before says nothing.
const GAP: f64 = 0.5;
/// Rate of the rows \[Hz\].
const RATE: f64 = 25.0;
/// Standard gravity [m/s²].
const GRAVITY: f64 = 9.81;

/// One row of what was flown.
#[derive(Clone, Copy)]
struct Row {
    t: f64,
    /// Air velocity along the nose, the wing and the belly [m/s].
    air: Vector3<f64>,
    /// Angle of attack in the mean of seconds \[rad\], that no gust decides.
    held_alpha: f64,
    /// Specific force along nose and belly [m/s²].
    force: [f64; 2],
    throttle: f64,
    /// Pitch rate, asked and had [rad/s], and its derivative [rad/s²].
    asked: f64,
    rate: f64,
    turn: f64,
    /// Sine of the climb angle.
    climb: f64,
    /// Torque in pitch that was asked for, a share of the full one.
    torque: f64,
}

impl Row {
    fn alpha(&self) -> f64 {
        self.air.z.atan2(self.air.x)
    }

    fn speed(&self) -> f64 {
        self.air.x.hypot(self.air.z)
    }

    /// Specific force across the path through the air, to the back [m/s²].
    fn lift(&self) -> f64 {
        (self.force[0] * self.air.z - self.force[1] * self.air.x) / self.speed()
    }

    /// Whether it is on the wing, short of stall and steadily.
    fn glides(&self) -> bool {
        self.speed() > 2.0 * SLOW && self.attached() && self.rate.abs() <= TURNS
    }

    /// Whether it is on the wing, short of stall. Rows that gusts carry beyond are not left out: what is left would be of too small an angle.
    fn attached(&self) -> bool {
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
struct Flown {
    steps: Vec<Row>,
    rows: Vec<Row>,
    notes: Vec<String>,
}

/// What was flown; the error says what is not in the log.
fn flown(log: &Log, states: &States) -> anyhow::Result<Flown> {
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
    let rate = [
        source("vehicle_angular_velocity", "xyz[1]", 1.0),
        degrees("P"),
    ];
    let asked = [
        source("vehicle_rates_setpoint", "pitch", 1.0),
        degrees("PDes"),
    ];
    let torque = [
        source("vehicle_torque_setpoint", "xyz[1]", 1.0),
        source("RATE", "POut", 1.0),
    ];
    let nan = || vec![f64::NAN; base.len()];
    let rate = held(log, &rate, base).unwrap_or_else(nan);
    let asked = held(log, &asked, base).unwrap_or_else(nan);
    let torque = held(log, &torque, base).unwrap_or_else(nan);
    if states.wind.is_none() && states.air_velocity.is_none() {
        notes.push("No wind is logged: it is taken for calm, and what is in the air is in the intervals. A flight to and fro on a calm day shows it".to_owned());
    }
    let mut steps: Vec<Row> = Vec::new();
    let (mut filtered, mut last): (f64, Option<(f64, f64)>) = (0.0, None);
    for ((n, &t), attitude) in base.iter().enumerate().zip(attitudes(states)) {
        // The derivative of the rate through a filter of 30 ms.
        if let Some((then, before)) = last {
            let dt = (t - then).max(1e-4);
            let share = 1.0 - (-dt / 0.03).exp();
            filtered += share * ((rate[n] - before) / dt - filtered);
        }
        if rate[n].is_finite() {
            last = Some((t, rate[n]));
        }
        let moving = Vector3::from(velocity.values[n]);
        let through = match (&states.air_velocity, &states.wind) {
            (Some(air), _) if air.values[n][0].is_finite() => Vector3::from(air.values[n]),
            (_, Some(wind)) if wind.values[n][0].is_finite() => {
                moving - Vector3::from(wind.values[n])
            }
            _ => moving,
        };
        let [nose, _, belly] = force.values[n];
        if velocity.overdue(n) > CEASED || force.overdue(n) > CEASED {
            continue;
        }
        let row = Row {
            t,
            air: attitude.inverse_transform_vector(&through),
            held_alpha: f64::NAN,
            force: [nose, belly],
            throttle: throttle[n],
            asked: asked[n],
            rate: rate[n],
            turn: filtered,
            climb: -moving.z / moving.norm().max(SLOW),
            torque: torque[n],
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
    Ok(Flown { steps, rows, notes })
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
fn around(rows: &[Row], t: f64, time: f64) -> &[Row] {
    let at = |t: f64| rows.partition_point(|row| row.t < t);
    &rows[at(t - 0.5 * time)..at(t + 0.5 * time)]
}

/// The mean of what was flown in one row.
fn mean(of: &[Row]) -> Row {
    let share = 1.0 / of.len() as f64;
    let mean = |value: &dyn Fn(&Row) -> f64| share * of.iter().map(value).sum::<f64>();
    Row {
        t: mean(&|row| row.t),
        air: share * of.iter().map(|row| row.air).sum::<Vector3<f64>>(),
        held_alpha: f64::NAN,
        force: [0, 1].map(|axis| mean(&|row| row.force[axis])),
        throttle: mean(&|row| row.throttle),
        asked: mean(&|row| row.asked),
        rate: mean(&|row| row.rate),
        turn: mean(&|row| row.turn),
        climb: mean(&|row| row.climb),
        torque: mean(&|row| row.torque),
    }
}

/// The unknowns of the forces: their number, and the regressors of a row.
struct Unknowns {
    /// Bins behind the stall that were visited.
    bins: Vec<i32>,
    /// The angle of attack short of stall, by [`instruments`].
    mean: [f64; 3],
}

const FIXED: usize = 6;

/// C_T over its static value, per advance ratio and its square: c1/c0 and c2/c0 of small propellers.
const PROPELLER: [f64; 2] = [-0.75, -1.08];
/// Advance ratio without thrust of such a propeller.
const NO_THRUST: f64 = 0.676;

/// Thrust over its static value at full throttle, at the throttle `u` and the speed `along` the nose, of a propeller of the speed `v1`, and its
/// derivative by `v1`.
fn propelled(u: f64, along: f64, v1: f64) -> [f64; 2] {
    let [linear, square] = PROPELLER;
    let (root, j) = (u.max(0.0).sqrt(), along / v1);
    let thrust = u + linear * root * j + square * j * j;
    // Slower than that it idles.
    if thrust <= 0.0 {
        return [0.0; 2];
    }
    [thrust, -(linear * root * j + 2.0 * square * j * j) / v1]
}

impl Unknowns {
    fn of(rows: &[Row]) -> Self {
        let mut counts = std::collections::BTreeMap::new();
        for row in rows.iter().filter(|row| row.speed() > SLOW) {
            if !row.attached() {
                *counts
                    .entry((row.alpha() / BIN).floor() as i32)
                    .or_insert(0) += 1;
            }
        }
        let bins = counts.into_iter().filter(|(_, count)| *count >= ROWS);
        let attached = rows
            .iter()
            .filter(|row| row.attached() && row.rate.abs() <= TURNS);
        let attached: Vec<&Row> = attached.collect();
        let mut mean = [0.0; 3];
        if attached.len() > ROWS {
            let z = DMatrix::from_fn(attached.len(), 3, |i, j| instruments(attached[i])[j]);
            let alpha = DVector::from_fn(attached.len(), |i, _| attached[i].alpha());
            if let Some(fit) = least_squares(&z, &z, &alpha, &vec![0; attached.len()]) {
                mean = [0, 1, 2].map(|j| fit.estimate[j]);
            }
        }
        Self {
            bins: bins.map(|(bin, _)| bin).collect(),
            mean,
        }
    }

    fn count(&self) -> usize {
        FIXED + 2 * self.bins.len()
    }

    /// The regressors along nose and belly, at a throttle behind its lag, for a propeller that is known so far; none where the row is in no bin that is known, or turns.
    fn regressors(
        &self,
        row: &Row,
        throttle: f64,
        k: f64,
        Propeller {
            v1,
            static_f,
            blown,
        }: Propeller,
        in_the_mean: bool,
    ) -> Option<[Vec<f64>; 2]> {
        let mut both = [vec![0.0; self.count()], vec![0.0; self.count()]];
        let pressure = k * row.speed().powi(2);
        let attached = row.attached();
        let alpha = if attached && in_the_mean {
            self.mean_alpha(row)
        } else {
            row.alpha()
        };
        let (sin, cos) = alpha.sin_cos();
        let lift = [pressure * sin, -pressure * cos];
        let drag = [-pressure * cos, -pressure * sin];
        if attached && row.rate.abs() > TURNS {
            return None;
        }
        let bin = (row.alpha() / BIN).floor() as i32;
        let place = self.bins.iter().position(|known| *known == bin);
        let [thrust, by_v1] = propelled(throttle, row.air.x, v1);
        for axis in 0..2 {
            let x = &mut both[axis];
            if axis == 0 {
                x[0] = thrust;
                x[1] = static_f * by_v1;
            } else if row.turn.is_finite() {
                x[5] = row.turn;
            }
            if row.speed() <= SLOW {
                continue;
            }
            if attached {
                // Of a part of the wing in the slipstream the pressure is greater by the thrust's, the angle of attack smaller.
                let [whole, half] =
                    [1.0, 0.5].map(|share| 1.0 + share * blown * static_f * thrust / pressure);
                x[2] = lift[axis] * whole;
                x[3] = lift[axis] * half * alpha;
                x[4] = drag[axis];
            } else {
                let place = place?;
                x[FIXED + 2 * place] = lift[axis];
                x[FIXED + 2 * place + 1] = drag[axis];
            }
        }
        Some(both)
    }

    /// The angle of attack that the flight has in the mean at a row's airspeed and climb.
    fn mean_alpha(&self, row: &Row) -> f64 {
        instruments(row)
            .iter()
            .zip(&self.mean)
            .map(|(z, c)| z * c)
            .sum()
    }
}

/// What the angle of attack depends on in the mean, and no gust does.
fn instruments(row: &Row) -> [f64; 3] {
    [1.0, 1.0 / row.speed().powi(2), row.climb]
}

/// The throttle behind a lag \[s\], at each row.
fn lagged(rows: &[Row], lag: f64) -> Vec<f64> {
    let (mut behind, mut then) = (rows[0].throttle, rows[0].t);
    let step = |row: &Row| {
        // Held since the row before, over a gap anew.
        let dt = row.t - then;
        then = row.t;
        behind = match dt < GAP {
            true => behind + (1.0 - (-dt / lag.max(1e-6)).exp()) * (row.throttle - behind),
            false => row.throttle,
        };
        behind
    };
    rows.iter().map(step).collect()
}

/// What is held of the propellers in a fit.
#[derive(Clone, Copy)]
struct Propeller {
    /// Their speed V_1 [m/s].
    v1: f64,
    /// Static thrust at full throttle over the mass [m/s²].
    static_f: f64,
    /// Area of the wing in the slipstream over that of the discs.
    blown: f64,
}

/// The equations of a part of the rows, two to a row: regressors with the mean of the throttle and as it was told, and forces.
struct Equations {
    mean: DMatrix<f64>,
    told: DMatrix<f64>,
    y: DVector<f64>,
    blocks: Vec<usize>,
    times: Vec<f64>,
}

/// What the flight of `log`, whose states are `states`, shows of a vehicle.
pub fn identify(log: &Log, states: &States, given: &Given) -> anyhow::Result<Identified> {
    let Flown {
        steps,
        rows,
        notes: mut missing,
    } = flown(log, states)?;
    let hovered = steps.iter().filter(|row| row.speed() < SLOW);
    let hovered: Vec<Sample> = hovered
        .map(|row| Sample {
            t: row.t,
            asked: row.throttle,
            had: row.force[0],
            besides: row.throttle.max(0.0).sqrt() * row.air.x,
        })
        .collect();
    let thrust_lag_s = response_lag(&hovered)
        .map(|lag| lag.lacking(LACKING.thrust_lag))
        .filter(Measured::is_known);
    let lag = thrust_lag_s.map_or(ASSUMED_LAG, |time| time.value);
    let k = 0.5 * given.air_kg_m3 * given.wing_m2 / given.mass_kg;
    let unknowns = Unknowns::of(&rows);
    let begin = rows[0].t;
    let fitted = |row: &Row| ((row.t - begin) / TURN) as u64 % 3 != 2;
    let assembled = |lag: f64, propeller: Propeller, which: bool| {
        let throttle = lagged(&rows, lag);
        let mut x = [Vec::new(), Vec::new()];
        let (mut y, mut blocks, mut times) = (Vec::new(), Vec::new(), Vec::new());
        for (row, throttle) in rows.iter().zip(throttle) {
            if fitted(row) != which {
                continue;
            }
            let [mean, told] =
                [true, false].map(|mean| unknowns.regressors(row, throttle, k, propeller, mean));
            let Some((mean, told)) = mean.zip(told) else {
                continue;
            };
            for axis in 0..2 {
                x[0].extend(&mean[axis]);
                x[1].extend(&told[axis]);
                y.push(row.force[axis]);
                blocks.push(((row.t - begin) / BLOCK) as usize);
                times.push(row.t);
            }
        }
        let n = y.len();
        let [mean, told] = x.map(|x| DMatrix::from_row_iterator(n, unknowns.count(), x));
        Equations {
            mean,
            told,
            y: DVector::from_vec(y),
            blocks,
            times,
        }
    };
    // Without its derivative, the speed of the propeller is held.
    let fit = |lag: f64, propeller: Propeller| {
        let of = assembled(lag, propeller, true);
        least_squares(&of.mean, &of.told, &of.y, &of.blocks)
    };
    let search = |lag: f64| {
        let speeds = (0..24).map(|n| 12.0 * 1.13_f64.powi(n));
        let tried = speeds.filter_map(|v1| {
            let propeller = Propeller {
                v1,
                static_f: 0.0,
                blown: 0.0,
            };
            let fit = fit(lag, propeller)?;
            let static_f = fit.estimate[0];
            let propeller = Propeller {
                static_f,
                blown: BLOWN,
                ..propeller
            };
            (static_f > 0.0).then_some((fit.squares, propeller))
        });
        let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, propeller)| propeller)
    };
    let propeller = search(lag)
        .ok_or_else(|| anyhow::anyhow!("the regression has no answer: no thrust is seen"))?;
    let v1 = propeller.v1;
    let none = || anyhow::anyhow!("the regression has no answer");
    let mid = fit(lag, propeller).ok_or_else(none)?;
    let [less, more] = [0.0, 2.0 * BLOWN].map(|blown| fit(lag, Propeller { blown, ..propeller }));
    let (less, more) = less.zip(more).ok_or_else(none)?;
    let fit = mid;
    // Nothing in a flight shows how much of the wing is in the slipstream: what that changes is in the interval.
    let washed = |of: &dyn Fn(&Fit) -> Measured| {
        let [measured, less, more] = [&fit, &less, &more].map(of);
        Measured {
            within: measured.within.hypot(0.5 * (more.value - less.value)),
            ..measured
        }
    };
    let Equations {
        mean: x, y, times, ..
    } = assembled(lag, propeller, false);
    let predicted = &x * &fit.estimate;
    let whole = 1.0 - (&y - &predicted).norm_squared() / y.norm_squared().max(1e-12);
    anyhow::ensure!(
        whole >= PREDICTED,
        "of what was not fitted the model predicts the specific force by {:.0} %, and no number is given below {:.0} %: what is logged as velocity or air is not what \
         it flew through, or it is no vehicle with one wing and a thrust along its nose",
        100.0 * whole.max(0.0),
        100.0 * PREDICTED
    );
    let share = |axis: usize| {
        let of =
            |v: &DVector<f64>| -> Vec<f64> { v.iter().skip(axis).step_by(2).copied().collect() };
        let (had, guess) = (of(&y), of(&predicted));
        let mean = had.iter().sum::<f64>() / had.len().max(1) as f64;
        let total: f64 = had.iter().map(|v| (v - mean).powi(2)).sum();
        let rest: f64 = had.iter().zip(&guess).map(|(a, b)| (a - b).powi(2)).sum();
        1.0 - rest / total.max(1e-12)
    };
    let held_out = (0..y.len() / 2).map(|n| {
        [
            times[2 * n],
            y[2 * n],
            predicted[2 * n],
            y[2 * n + 1],
            predicted[2 * n + 1],
        ]
    });
    let held_out: Vec<[f64; 5]> = held_out.collect();

    let attached = rows.iter().filter(|row| row.attached());
    let angles: Vec<f64> = attached.map(|row| row.held_alpha).collect();
    let hover = rows.iter().filter(|row| row.speed() < SLOW).count();
    let known = |measured: Measured| measured.is_known().then_some(measured);
    let thrust_to_weight =
        known(fit.function(|e| e[0] / GRAVITY).lacking(LACKING.thrust)).filter(|m| m.value > 0.0);
    if thrust_to_weight.is_none() {
        missing.push(
            "Thrust over throttle: hover for ten seconds, and climb and sink at 2 m/s in turn"
                .to_owned(),
        );
    }
    // The derivative's estimate is what is still missing of V_1.
    let zero_thrust = known(fit.function(|e| NO_THRUST * (v1 + e[1]))).filter(|m| m.value > 0.0);
    if zero_thrust.is_none() {
        missing.push("How thrust falls with speed: level flight at three speeds, ten seconds each, and a climb at full throttle".to_owned());
    }
    if thrust_lag_s.is_none() {
        missing.push(
            "Lag of the thrust: steps of the climb rate in hover, of 1 m/s and more".to_owned(),
        );
    }
    let mut speeds: Vec<f64> = rows
        .iter()
        .filter(|row| row.speed() > 2.0 * SLOW && row.attached())
        .map(Row::speed)
        .collect();
    speeds.sort_by(f64::total_cmp);
    let flown_m_s = speeds.get(speeds.len() / 2).copied();
    let spread = angles.iter().copied().reduce(f64::max).unwrap_or(0.0)
        - angles.iter().copied().reduce(f64::min).unwrap_or(0.0);
    let wing = angles.len() >= 4 * ROWS && spread > 0.05;
    let (mut c_l_0, mut c_l_alpha, mut zero_lift_deg, mut c_d_cruise) = (None, None, None, None);
    if wing {
        let zero_lift = |fit: &Fit| fit.function(|e| (-e[2] / e[3]).to_degrees());
        c_l_0 = Some(washed(&|fit| fit.measured(2)));
        c_l_alpha = known(washed(&|fit| fit.measured(3))).filter(|slope| slope.value > 0.0);
        zero_lift_deg = c_l_alpha.map(|_| washed(&zero_lift));
        let glided = glides(&rows, lag, NO_THRUST * v1, k);
        let mut lifts: Vec<f64> = rows
            .iter()
            .filter(|row| row.glides())
            .map(|row| row.lift() / (k * row.speed().powi(2)))
            .collect();
        lifts.sort_by(f64::total_cmp);
        let c_l = lifts.get(lifts.len() / 2).copied().unwrap_or(0.0);
        c_d_cruise = (glided.len() >= ROWS)
            .then(|| drag(&glided))
            .flatten()
            .map(|fit| {
                fit.function(|e| e[0] + e[1] * c_l * c_l)
                    .lacking(LACKING.drag)
            })
            .filter(|drag| drag.is_known() && drag.value > 0.0)
            .map(|drag| (drag, c_l));
    }
    if c_l_alpha.is_none() {
        missing.push(format!(
            "c_L of the wing: level flight at three speeds above that of transition, ten seconds each, and a turn of 45° of bank. This flight has {:.0} s below {:.0}° \
             of angle of attack, over {:.0}°",
            angles.len() as f64 / RATE,
            ATTACHED.to_degrees(),
            spread.to_degrees()
        ));
    }
    if c_d_cruise.is_none() {
        missing.push("c_D in cruise: a glide with the throttle at idle for ten seconds, for which thrust and drag are told apart".to_owned());
    }
    let beyond: Vec<_> = unknowns
        .bins
        .iter()
        .enumerate()
        .map(|(n, bin)| {
            let middle = (f64::from(*bin) + 0.5) * BIN;
            Beyond {
                alpha_deg: middle.to_degrees(),
                c_l: fit.measured(FIXED + 2 * n),
                c_d: fit.measured(FIXED + 2 * n + 1),
            }
        })
        .collect();
    if beyond.len() < 4 {
        missing.push("Coefficients behind the stall: two transitions there and back".to_owned());
    }

    let mut pitch: Vec<&Row> = Vec::new();
    for row in &steps {
        let later = pitch
            .last()
            .is_none_or(|last| row.t - last.t > 1.0 / RATE - 1e-6);
        if later && row.rate.is_finite() && row.asked.is_finite() {
            pitch.push(row);
        }
    }
    let (rate_lag_s, rate_share) = rate_loop(&pitch)
        .map(|(lag, share)| (lag.lacking(LACKING.rate_lag), share))
        .unzip();
    if rate_lag_s.is_none() {
        missing.push(
            "The rate loop: steps of the pitch rate in hover, 0.5 rad/s there and back".to_owned(),
        );
    }
    let turn_rad_s2 = turn(&steps);
    match turn_rad_s2 {
        None => missing.push("What turns it: no pitch rate in hover is in the log".to_owned()),
        Some(Turn { at_stop: false, .. }) => missing.push(
            "What turns it at most: steps of the pitch rate in hover, of 2 rad/s there and back, with the torque set-point in the log. What is given is what was had"
                .to_owned(),
        ),
        Some(_) => {}
    }
    if hover < 10 * RATE as usize {
        missing.push("Hover: ten seconds of it".to_owned());
    }
    let held_seconds = held_out.len() as f64 / RATE;
    Ok(Identified {
        seconds: [rows.len() as f64 / RATE - held_seconds, held_seconds],
        thrust_to_weight,
        zero_thrust_speed_m_s: zero_thrust,
        thrust_lag_s,
        rate_lag_s,
        rate_share,
        turn_rad_s2,
        c_l_0,
        c_l_alpha,
        zero_lift_deg,
        c_d_cruise,
        beyond,
        surface_reaction_m: known(fit.measured(5)),
        predicted: [share(0), share(1)],
        flown_m_s,
        held_out,
        missing,
    })
}

/// What is flown on the wing, short of stall and steadily, while the propeller idles: `no_thrust` is the airspeed without thrust at full throttle [m/s],
/// `k` is k_a/m.
fn glides(rows: &[Row], lag: f64, no_thrust: f64, k: f64) -> Vec<Glide> {
    let idles = |row: &Row, throttle: f64| {
        let advance = row.air.x / (throttle.max(1e-6).sqrt() * no_thrust);
        row.glides() && advance >= IDLE
    };
    let flown = rows.iter().zip(lagged(rows, lag));
    let idle = flown.filter(|(row, throttle)| idles(row, *throttle));
    idle.map(|(row, _)| {
        let near = around(rows, row.t, MEAN);
        let lift = near.iter().map(Row::lift).sum::<f64>() / near.len() as f64;
        let pressure = k * row.speed().powi(2);
        Glide {
            block: ((row.t - rows[0].t) / ANEW) as usize,
            pressure,
            along: (row.force[0] * row.air.x + row.force[1] * row.air.z) / row.speed(),
            c_l: lift / pressure,
        }
    })
    .collect()
}

/// Lag of the pitch rate, and what is had of what is asked: of a first-order lag, where enough is asked.
fn rate_loop(rows: &[&Row]) -> Option<(Measured, f64)> {
    let moves = rows.iter().map(|row| row.asked.powi(2)).sum::<f64>() / rows.len().max(1) as f64;
    if rows.len() < 10 * ROWS || moves.sqrt() < 0.03 {
        return None;
    }
    struct Tried {
        lag: f64,
        share: f64,
        squares: f64,
    }
    let tried: Vec<Tried> = (1..60)
        .map(|n| {
            let lag = 0.01 * f64::from(n);
            let (mut behind, mut products, mut squares, mut had) = (0.0, 0.0, 0.0, 0.0);
            for pair in rows.windows(2) {
                let dt = pair[1].t - pair[0].t;
                behind = match dt < GAP {
                    true => behind + (1.0 - (-dt / lag).exp()) * (pair[0].asked - behind),
                    false => pair[1].asked,
                };
                products += behind * pair[1].rate;
                squares += behind * behind;
                had += pair[1].rate * pair[1].rate;
            }
            let share = products / squares;
            Tried {
                lag,
                share,
                squares: had - share * products,
            }
        })
        .collect();
    let best = (0..tried.len()).min_by(|a, b| tried[*a].squares.total_cmp(&tried[*b].squares))?;
    let a = tried.get(best.checked_sub(1)?)?.squares;
    let Tried {
        lag,
        share,
        squares: b,
    } = tried[best];
    let c = tried.get(best + 1)?.squares;
    let bend = (a - 2.0 * b + c).max(1e-12);
    let blocks = (rows.len() as f64 / RATE / ANEW).max(2.0);
    let measured = Measured {
        value: lag + 0.005 * (a - c) / bend,
        within: deviations(blocks as usize) * 0.01 * (2.0 * b / blocks / bend).sqrt(),
    };
    Some((measured, share))
}

/// The greatest angular acceleration in pitch in hover, and whether the torque was at its stop where it was had: else there may be more.
fn turn(rows: &[Row]) -> Option<Turn> {
    /// Share of the full torque that is a stop.
    const STOP: f64 = 0.97;
    let hover = || {
        rows.iter()
            .filter(|row| row.speed() < SLOW && row.turn.is_finite())
    };
    // But for one row of five hundred, which may be noise.
    let most = |of: Vec<f64>| {
        let mut turns = of;
        turns.sort_by(f64::total_cmp);
        turns
            .get(turns.len().checked_sub(1 + turns.len() / 500)?)
            .copied()
    };
    let stopped = hover().filter(|row| row.torque.abs() >= STOP);
    let stopped: Vec<f64> = stopped.map(|row| row.turn.abs()).collect();
    let at_stop = stopped.len() >= 5;
    Some(Turn {
        had: most(hover().map(|row| row.turn.abs()).collect())?,
        at_stop,
    })
}

/// What a person says besides, for the file that `new` takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Besides {
    /// What turns it.
    pub actuators: Actuators,
    /// Speed of cruise; none is that of the flight, on its wing.
    pub cruise_m_s: Option<f64>,
    /// A section for what the flight does not show of the wing.
    pub section: String,
}

/// Name of the polar beside the file.
pub const POLAR: &str = "polar.csv";

impl Identified {
    /// The wing's coefficients as a table: what was seen, and below zero lift its mirror; none where the wing, or its stall, was not seen.
    pub fn polar(&self) -> Option<String> {
        let (zero, slope) = (self.zero_lift_deg?.value, self.c_l_alpha?.value);
        let (drag, cruise) = self.c_d_cruise?;
        // Attached: a line, and a parabola through the drag of cruise, of a wing whose drag at zero lift is a part of it.
        let lift = |degrees: f64| slope * (degrees - zero).to_radians();
        let induced = 0.3 * drag.value / cruise.powi(2).max(1e-3);
        let drag_at = |degrees: f64| 0.7 * drag.value + induced * lift(degrees).powi(2);
        let last = ATTACHED.to_degrees();
        let mut rows: Vec<[f64; 3]> = Vec::new();
        let mut angle = zero.ceil();
        while angle < last {
            rows.push([angle, lift(angle), drag_at(angle)]);
            angle += 1.0;
        }
        let mut next = last;
        for Beyond {
            alpha_deg: alpha,
            c_l,
            c_d,
        } in &self.beyond
        {
            // Without a gap, and where both are known.
            let known = c_l.within < 0.3 && c_d.within < 0.3 && c_d.value > 0.0;
            if *alpha < last || *alpha - next > 15.0 || !known || *alpha > 90.0 {
                continue;
            }
            rows.push([*alpha, c_l.value, c_d.value]);
            next = *alpha;
        }
        // Lift that has not fallen shows no stall.
        let most = rows.iter().map(|row| row[1]).fold(0.0, f64::max);
        if rows.last()?[1] > 0.9 * most {
            return None;
        }
        let mirror = rows.iter().filter(|row| row[0] > zero + 0.5);
        let mirror: Vec<[f64; 3]> = mirror
            .map(|[alpha, c_l, c_d]| [2.0 * zero - alpha, -c_l, *c_d])
            .collect();
        let mut text =
            "# Identified from a flight; below zero lift its mirror: assumed.\nalpha_deg,cl,cd\n"
                .to_owned();
        for [alpha, c_l, c_d] in mirror.iter().rev().chain(&rows) {
            text += &format!("{alpha:.2},{c_l:.4},{:.5}\n", c_d.max(1e-3));
        }
        Some(text)
    }

    /// The file that `new --from` takes: each number with its interval, or the word "assumed".
    pub fn known(&self, given: &Given, besides: &Besides, flown_m_s: f64) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: f64, source: String| {
            text += &format!(
                "{:<28} # {source}\n",
                format!("{name} = {}", rounded(value))
            );
        };
        line("mass_kg", given.mass_kg, "given".to_owned());
        line("wing_m2", given.wing_m2, "given".to_owned());
        line("air_kg_m3", given.air_kg_m3, "given".to_owned());
        let mut either = |name: &str, measured: Option<Measured>, assumed: f64| match measured {
            Some(m) => line(
                name,
                m.value,
                format!("measured: within {}", rounded(m.within)),
            ),
            None => line(
                name,
                assumed,
                "assumed: the flight does not show it".to_owned(),
            ),
        };
        either("thrust_to_weight", self.thrust_to_weight, 1.6);
        either("thrust_lag_s", self.thrust_lag_s, ASSUMED_LAG);
        either("rate_lag_s", self.rate_lag_s, 0.12);
        match self.turn_rad_s2 {
            Some(Turn { had, at_stop }) => line(
                "turn_rad_s2",
                had.max(5.0),
                match at_stop {
                    true => "measured: the torque was at its stop".to_owned(),
                    false => "measured: at least, the torque was not at its stop".to_owned(),
                },
            ),
            None => line(
                "turn_rad_s2",
                15.0,
                "assumed: the flight does not show it".to_owned(),
            ),
        }
        match besides.cruise_m_s {
            Some(cruise) => line("cruise_m_s", cruise, "given".to_owned()),
            None => line("cruise_m_s", flown_m_s, "flown, on its wing".to_owned()),
        }
        let actuators = match besides.actuators {
            Actuators::Elevons => "elevons",
            Actuators::Motors => "motors",
            Actuators::Both => "both",
        };
        text += &format!("{:<28} # given\n", format!("actuators = \"{actuators}\""));
        match self.polar() {
            Some(_) => {
                text += &format!(
                    "{:<28} # measured, as far as it was seen\n",
                    format!("section = \"{POLAR}\"")
                );
            }
            None => {
                text += &format!(
                    "{:<28} # assumed: the flight does not show the wing\n",
                    format!("section = {:?}", besides.section)
                );
            }
        }
        text
    }

    /// The numbers, with their intervals, as rows of a table.
    pub fn rows(&self) -> Vec<[String; 3]> {
        let row = |what: &str, unit: &str, measured: Option<Measured>| {
            let (value, within) = match measured {
                Some(m) => (rounded(m.value), format!("± {}", rounded(m.within))),
                None => ("not shown".to_owned(), String::new()),
            };
            [
                format!(
                    "{what}{}",
                    if unit.is_empty() {
                        String::new()
                    } else {
                        format!(" [{unit}]")
                    }
                ),
                value,
                within,
            ]
        };
        let mut rows = vec![
            row("static thrust over weight", "", self.thrust_to_weight),
            row(
                "airspeed without thrust at full throttle",
                "m/s",
                self.zero_thrust_speed_m_s,
            ),
            row("lag of the thrust", "s", self.thrust_lag_s),
            row("lag of the pitch rate", "s", self.rate_lag_s),
        ];
        let what = "angular acceleration in pitch in hover";
        rows.push(match self.turn_rad_s2 {
            Some(Turn { had, at_stop }) => [
                format!("{what} [rad/s²]"),
                rounded(had),
                if at_stop {
                    "at the stop of the torque"
                } else {
                    "at least"
                }
                .to_owned(),
            ],
            None => row(what, "rad/s²", None),
        });
        rows.push(row("c_L per angle of attack", "1/rad", self.c_l_alpha));
        rows.push(row(
            "angle of zero lift to the nose",
            "°",
            self.zero_lift_deg,
        ));
        let cruise = self
            .c_d_cruise
            .map_or(String::new(), |(_, c_l)| format!(" at c_L = {c_l:.2}"));
        rows.push(row(
            &format!("c_D{cruise}"),
            "",
            self.c_d_cruise.map(|(drag, _)| drag),
        ));
        for Beyond {
            alpha_deg: alpha,
            c_l,
            c_d,
        } in &self.beyond
        {
            rows.push(row(&format!("c_L at {alpha:.0}°"), "", Some(*c_l)));
            rows.push(row(&format!("c_D at {alpha:.0}°"), "", Some(*c_d)));
        }
        rows
    }
}

/// A number in few digits.
fn rounded(x: f64) -> String {
    let digits = match x.abs() {
        x if x >= 100.0 => 0,
        x if x >= 10.0 => 1,
        x if x >= 1.0 => 2,
        _ => 3,
    };
    format!("{x:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::propelled;

    /// A propeller gives its static thrust at rest, less with speed, and none, not less than none, where the air outruns it.
    #[test]
    fn a_propeller_that_idles_gives_no_thrust() {
        assert_eq!(propelled(0.5, 0.0, 40.0)[0], 0.5);
        assert!(propelled(0.5, 10.0, 40.0)[0] < 0.5);
        assert_eq!(propelled(0.01, 18.0, 40.0), [0.0; 2]);
    }
}
