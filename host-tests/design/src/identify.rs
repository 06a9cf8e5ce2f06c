//! A vehicle learned from the log of a flight: by regression of the specific force and of the angular acceleration on what is known of them
//! (equation error; Klein and Morelli, *Aircraft System Identification*, chapter 5).
//!
//! Forces over the mass, with the throttle u behind the lag of the motors, along the nose and along the belly:
//!
//! | | |
//! |---|---|
//! | f_x | T_0/m (u − 0.75 J √u − 1.08 J²) + V² k_a/m (c_L sin α − c_D cos α), J = v_x/V_1 |
//! | f_z | −V² k_a/m (c_L cos α + c_D sin α) + s ω̇_y |
//! | c_L, c_D | short of stall c_L0 + c_Lα α, and one c_D; beyond it constants of each ten degrees, of flight that is not slower than the slipstream |
//!
//! The propeller is one of a family: C_T over advance ratio as small ones have it, V_1 being its tip's advance at full throttle over π. V_1 is
//! searched, and V_1 is in the covariance by its derivative. The lag is that of the force along the nose in hover, by `thrust_lag`.
//! The attitude is the one that goes with accelerometer and velocity, not the one that was told: `reconstruct`.
//!
//! Short of stall the angle of attack that an estimator tells lacks the gusts, and the vehicle moves with them: a regression on it finds too small a slope.
//! So α there is what the flight has in the mean at its airspeed and climb (two-stage least squares, the instruments 1, 1/V² and the climb angle).
//! What a full torque gives in pitch is that of the rates that were asked for: `authority`.
//! The slope is that of pulls and pushes, where a flight has them: `waves`. The velocity is put in time first: `velocity_lag`.
//!
//! Intervals are of 95 %, from the residuals in blocks of seconds: the errors of gusts and of lags last.

use alula_logs::Log;
use alula_logs::states::States;
use nalgebra::{DMatrix, DVector};

use super::authority;
use super::drag::{Glide, drag};
use super::flown::{ATTACHED, Flown, RATE, ROWS, Row, SLOW, around, flown, lagged};
use super::forces::{BIN, FIXED, NO_THRUST, Propeller, Unknowns, propelled};
use super::reconstruct::GRAVITY;
use super::regression::{Fit, Measured, least_squares};
use super::waves::{self, Sample};
use super::{rate_lag, side, thrust_lag};

use super::identified::ASSUMED_LAG;
pub use super::identified::{Besides, Beyond, Given, Identified, POLAR, Turn, WingSeen};

/// Length of blocks whose residuals are taken for independent \[s\]: three times as long as gusts last at the wing.
const BLOCK: f64 = 5.0;
/// Time of which two of three are fitted and the third is held out \[s\]. What is given is then of all.
const TURN: f64 = 10.0;
/// Time \[s\] after which the residuals of a glide say something anew.
const ANEW: f64 = 2.0;
/// What the models themselves lack, shares of the value of 95 %: a battery that sags and a propeller of another family; elevons that trim another glide than
/// cruise.
pub struct Lacking {
    /// Of the static thrust over the weight.
    pub thrust: f64,
    /// Of c_D in cruise.
    pub drag: f64,
    /// Of the slope of c_L in waves.
    pub slope: f64,
    /// Of c_Y: fins in a slipstream, and a side force that grows faster than the sideslip.
    pub side: f64,
    /// Of the lag about the nose: wind along it adds to what elevons turn.
    pub nose_lag: f64,
    /// Of what a full torque gives in pitch: surfaces whose effect falls otherwise with their deflection.
    pub torque: f64,
}

/// Not less than flights of three kinds of simulated vehicles lack: `slow_vehicles_are_learned_from_their_flights` of the tests finds it.
pub const LACKING: Lacking = Lacking {
    thrust: 0.07,
    drag: 0.2,
    slope: 0.1,
    side: 0.2,
    nose_lag: 0.2,
    torque: 0.2,
};
/// Advance ratio, over the one that is without thrust, from which on a propeller idles, whatever is wrong of that one: of another family it is up to a quarter
/// greater.
const IDLE: f64 = 1.5;
/// Area of the wing in the slipstream over that of the propellers' discs, up to twice which is taken for possible: 4/π of chord over diameter, less what the
/// slipstream contracts.
const BLOWN: f64 = 1.1;
/// Share of the square of the specific force that a model predicts, where it is one of the vehicle.
const PREDICTED: f64 = 0.5;
/// Least share of its variance that is predicted. Steady flight hardly varies, and the share is far below zero there by noise alone; logs that are none of a
/// tail-sitter have -10 and less.
const SCATTERED: f64 = -5.0;
/// Time in which the lift is averaged \[s\]. In a glide no more acceleration [m/s²] is asked for in it, and where that is not logged, the propeller idles for
/// this share of it.
const MEAN: f64 = 2.0;
const PULL: f64 = 3.4;
const LASTING: f64 = 0.9;
/// Interval of c_L within which it is known.
const KNOWN_LIFT: f64 = 0.2;

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
        wind,
        notes: mut missing,
    } = flown(log, states)?;
    let hovered = steps.iter().filter(|row| row.speed() < SLOW);
    let hovered: Vec<_> = hovered
        .map(|row| thrust_lag::Sample {
            t: row.t,
            throttle: row.throttle,
            along: row.air.x,
            force: row.force[0],
        })
        .collect();
    let thrust_lag_s = thrust_lag::thrust_lag(&hovered).filter(Measured::is_known);
    let lag = thrust_lag_s.map_or(ASSUMED_LAG, |time| time.value);
    let k = 0.5 * given.air_kg_m3 * given.wing_m2 / given.mass_kg;
    let unknowns = Unknowns::of(&rows, k);
    let begin = rows[0].t;
    let held_out = |row: &Row| ((row.t - begin) / TURN) as u64 % 3 == 2;
    let fitted = |row: &Row| !held_out(row);
    let all = |_: &Row| true;
    let throttle = lagged(&rows, lag);
    let assembled = |propeller: Propeller, which: &dyn Fn(&Row) -> bool| {
        let mut x = [Vec::new(), Vec::new()];
        let (mut y, mut blocks, mut times) = (Vec::new(), Vec::new(), Vec::new());
        for (row, &throttle) in rows.iter().zip(&throttle) {
            if !which(row) {
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
    let solve = |propeller: Propeller, which: &dyn Fn(&Row) -> bool| {
        let of = assembled(propeller, which);
        least_squares(&of.mean, &of.told, &of.y, &of.blocks)
    };
    let speeds = (0..24).map(|n| 12.0 * 1.13_f64.powi(n));
    let tried = speeds.filter_map(|v1| {
        let propeller = Propeller {
            v1,
            static_f: 0.0,
            blown: 0.0,
        };
        let fit = solve(propeller, &fitted)?;
        let static_f = fit.estimate[0];
        let propeller = Propeller {
            static_f,
            blown: BLOWN,
            ..propeller
        };
        (static_f > 0.0).then_some((fit.squares, propeller))
    });
    let (_, propeller) = tried
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .ok_or_else(|| anyhow::anyhow!("the regression has no answer: no thrust is seen"))?;
    let v1 = propeller.v1;
    let none = || anyhow::anyhow!("the regression has no answer");
    let validated = solve(propeller, &fitted).ok_or_else(none)?;
    let fit = solve(propeller, &all).ok_or_else(none)?;
    let [less, more] =
        [0.0, 2.0 * BLOWN].map(|blown| solve(Propeller { blown, ..propeller }, &all));
    let (less, more) = less.zip(more).ok_or_else(none)?;
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
    } = assembled(propeller, &held_out);
    let predicted = &x * &validated.estimate;
    let share = |axis: usize| {
        let of =
            |v: &DVector<f64>| -> Vec<f64> { v.iter().skip(axis).step_by(2).copied().collect() };
        let (had, guess) = (of(&y), of(&predicted));
        let mean = had.iter().sum::<f64>() / had.len().max(1) as f64;
        let total: f64 = had.iter().map(|v| (v - mean).powi(2)).sum();
        let rest: f64 = had.iter().zip(&guess).map(|(a, b)| (a - b).powi(2)).sum();
        1.0 - rest / total.max(1e-12)
    };
    let predicted_of = [share(0), share(1)];
    let whole = 1.0 - (&y - &predicted).norm_squared() / y.norm_squared().max(1e-12);
    anyhow::ensure!(
        whole >= PREDICTED && predicted_of.iter().all(|share| *share >= SCATTERED),
        "of what was not fitted the model predicts the square of the specific force by {:.0} % and its variance by {:.0} and {:.0} %, and no number is given below {:.0} % of the one and {:.0} % of the other: what is logged as velocity or air is not what \
         it flew through, or it is no vehicle with one wing and a thrust along its nose",
        100.0 * whole,
        100.0 * predicted_of[0],
        100.0 * predicted_of[1],
        100.0 * PREDICTED,
        100.0 * SCATTERED
    );
    let shown = (0..y.len() / 2).map(|n| {
        [
            times[2 * n],
            y[2 * n],
            predicted[2 * n],
            y[2 * n + 1],
            predicted[2 * n + 1],
        ]
    });
    let held_out: Vec<[f64; 5]> = shown.collect();

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
    let (mut lift, mut c_l_alpha, mut zero_lift_deg, mut c_d_cruise) = (None, None, None, None);
    if wing {
        // Where errors of the line's height and slope have nothing to do with each other.
        let best = -fit.covariance[(2, 3)] / fit.covariance[(3, 3)].max(1e-12);
        let c_l = washed(&|fit| fit.function(|e| e[2] + e[3] * best));
        lift = (c_l.within < KNOWN_LIFT).then_some((best.to_degrees(), c_l));
        let c_d = fit.estimate[4];
        let asked_down: Vec<f64> = waves::asked(&rows).iter().map(|asked| asked.z).collect();
        let in_waves = [0.0, BLOWN, 2.0 * BLOWN].map(|blown| {
            let propeller = Propeller { blown, ..propeller };
            let samples = on_the_wing(&rows, &throttle, k, propeller, c_d);
            waves::slope(&rows, &asked_down, &samples)
        });
        let [less, in_waves, more] = in_waves;
        let in_waves = less
            .zip(more)
            .zip(in_waves)
            .map(|((less, more), slope)| Measured {
                within: slope.within.hypot(0.5 * (more.value - less.value)),
                ..slope
            });
        let in_waves = in_waves.map(|slope| slope.lacking(LACKING.slope));
        // At level speeds a mean gust counts for an angle, and in waves it does not.
        let slope = in_waves.or_else(|| known(washed(&|fit| fit.measured(3))));
        c_l_alpha = slope.filter(|slope| slope.value > 0.0);
        zero_lift_deg = c_l_alpha.map(|slope| {
            let below = c_l.value / slope.value;
            let within = (c_l.within / slope.value).hypot(below * slope.within / slope.value);
            Measured {
                value: (best - below).to_degrees(),
                within: within.to_degrees(),
            }
        });
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
    let c_y = side::c_y(&rows, k).map(|c_y| c_y.lacking(LACKING.side));
    if c_y.is_none() {
        missing.push(
            "Side force: swings of the course in cruise for 30 s, from 2 m/s to the left to 2 m/s to the right in 1.5 s and back, with the velocity set-point in the log"
                .to_owned(),
        );
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

    let turned = turned(&steps);
    let lag_about = |axis: usize| rate_lag::rate_lag(&turned, axis).filter(Measured::is_known);
    let [nose_lag_s, rate_lag_s, belly_lag_s] = [0, 1, 2].map(lag_about);
    let nose_lag_s = nose_lag_s.map(|lag| lag.lacking(LACKING.nose_lag));
    for (lag, axis) in [
        (rate_lag_s, "pitch rate"),
        (nose_lag_s, "rate about the nose"),
        (belly_lag_s, "rate about the belly"),
    ] {
        if lag.is_none() {
            missing.push(format!(
                "Lag of the {axis}: steps of it in hover, 0.5 rad/s there and back, with its set-point in the log"
            ));
        }
    }
    let turn_rad_s2 = turn(&steps);
    let full_torque_rad_s2 = full_torque(&steps, lag, propeller)
        .map(|full| full.lacking(LACKING.torque))
        .and_then(known)
        .filter(|full| full.value > 0.0);
    match turn_rad_s2 {
        _ if full_torque_rad_s2.is_some() => {}
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
    let mut found = Identified {
        seconds: [rows.len() as f64 / RATE - held_seconds, held_seconds],
        thrust_to_weight,
        zero_thrust_speed_m_s: zero_thrust,
        thrust_lag_s,
        rate_lag_s,
        nose_lag_s,
        belly_lag_s,
        turn_rad_s2,
        full_torque_rad_s2,
        lift,
        c_l_alpha,
        zero_lift_deg,
        c_d_cruise,
        c_y,
        beyond,
        surface_reaction_m: known(fit.measured(5)),
        predicted: predicted_of,
        flown_m_s,
        wind_m_s: wind,
        held_out,
        missing,
    };
    if !found.stall_is_seen() {
        found.missing.push(
            "Coefficients behind the stall: two transitions there and back, of ten seconds and more each"
                .to_owned(),
        );
    }
    Ok(found)
}

/// What is flown on the wing, short of stall, its force less that of a propeller and of a drag `c_d`; `k` is k_a/m.
fn on_the_wing(
    rows: &[Row],
    throttle: &[f64],
    k: f64,
    propeller: Propeller,
    c_d: f64,
) -> Vec<Sample<2>> {
    let attached = rows.iter().zip(throttle).enumerate();
    let attached = attached.filter(|(_, (row, _))| row.attached() && row.speed() > 2.0 * SLOW);
    let samples = attached.map(|(place, (row, &throttle))| {
        let pressure = k * row.speed().powi(2);
        let [thrust, _] = propelled(throttle, row.air.x, propeller.v1);
        let (sin, cos) = row.alpha().sin_cos();
        // Of a part of the wing in the slipstream, as in the forces.
        let [whole, half] = [1.0, 0.5]
            .map(|share| pressure + share * propeller.blown * propeller.static_f * thrust);
        Sample {
            place,
            // Along the belly there is no thrust.
            force: (-row.force[1] - pressure * c_d * sin) / cos,
            by: [whole, half * row.alpha()],
        }
    });
    samples.collect()
}

/// What is flown on the wing, short of stall and steadily, while the propeller idles: `no_thrust` is the airspeed without thrust at full throttle [m/s],
/// `k` is k_a/m.
fn glides(rows: &[Row], lag: f64, no_thrust: f64, k: f64) -> Vec<Glide> {
    let idles = |row: &Row, throttle: f64| {
        let advance = row.air.x / (throttle.max(1e-6).sqrt() * no_thrust);
        row.glides() && advance >= IDLE
    };
    let flown = rows.iter().zip(lagged(rows, lag));
    let idle: Vec<bool> = flown.map(|(row, throttle)| idles(row, throttle)).collect();
    let at = |t: f64| rows.partition_point(|row| row.t < t);
    let asked = waves::asked(rows);
    // In a push the propeller idles for a moment, and the lift is not that of its mean.
    let steady = |row: &Row| {
        let near = at(row.t - 0.5 * MEAN)..at(row.t + 0.5 * MEAN);
        let count = near.len() as f64;
        match row.wanted.z.is_finite() {
            true => asked[near].iter().map(|a| a.z.abs()).sum::<f64>() < PULL * count,
            false => idle[near].iter().filter(|idle| **idle).count() as f64 > LASTING * count,
        }
    };
    let both = rows.iter().zip(&idle);
    let gliding = both.filter(|(row, idle)| **idle && steady(row));
    gliding
        .map(|(row, _)| {
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

/// The rates in hover. What counts is what has the thrust of hover: what turns the vehicle goes with its thrust.
fn turned(rows: &[Row]) -> Vec<rate_lag::Sample> {
    /// Greatest part that the throttle may be off.
    const NEAR: f64 = 0.05;
    let hover = rows.iter().filter(|row| row.speed() < SLOW);
    let mut throttles: Vec<f64> = hover.map(|row| row.throttle).collect();
    throttles.sort_by(f64::total_cmp);
    let usual = throttles.get(throttles.len() / 2).copied().unwrap_or(0.0);
    let known = rows
        .iter()
        .filter(|row| row.speed() < SLOW && row.rate.y.is_finite() && row.asked.y.is_finite());
    let or_none = |x: f64| if x.is_finite() { x } else { 0.0 };
    known
        .map(|row| rate_lag::Sample {
            t: row.t,
            asked: row.asked.map(or_none),
            rate: row.rate.map(or_none),
            counts: (row.throttle - usual).abs() < NEAR * usual,
        })
        .collect()
}

/// What a full torque gives in pitch in hover [rad/s²], at the thrust of a propeller behind the lag \[s\] of the motors.
fn full_torque(steps: &[Row], lag: f64, propeller: Propeller) -> Option<Measured> {
    let known = |row: &&Row| {
        [row.asked.y, row.rate.y, row.torque]
            .iter()
            .all(|x| x.is_finite())
    };
    let known: Vec<Row> = steps.iter().filter(known).copied().collect();
    let samples = known.iter().zip(lagged(&known, lag));
    let samples = samples.map(|(row, throttle)| {
        let [thrust, _] = propelled(throttle, row.air.x, propeller.v1);
        authority::Sample {
            t: row.t,
            asked: row.asked.y,
            rate: row.rate.y,
            torque: row.torque,
            thrust: propeller.static_f * thrust / GRAVITY,
            along: row.air.x,
            across: row.air.z,
        }
    });
    authority::full_torque(&samples.collect::<Vec<_>>())
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
    let stopped = hover().filter(|row| row.torque.abs() >= STOP || row.short);
    let stopped: Vec<f64> = stopped.map(|row| row.turn.abs()).collect();
    let at_stop = stopped.len() >= 5;
    Some(Turn {
        had: most(hover().map(|row| row.turn.abs()).collect())?,
        at_stop,
    })
}
