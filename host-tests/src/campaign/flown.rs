//! A flown flight, in numbers: its figures, and samples of its course.

use alula::Guided;
use alula::control::{Mode, Status};

use super::{Drawn, Expected, FaultDraw};
use crate::mission::{Mission, Row, air_name, fly, mode_name};

/// The figures of a flight.
pub const FIGURES: [&str; 16] = [
    // Over the reference: least and greatest.
    "altitude_least_m",
    "altitude_most_m",
    "forward_least_m",
    "forward_most_m",
    // |v − v_r|: largest, and largest in the last 5 s.
    "max_velocity_error_m_s",
    "late_velocity_error_m_s",
    // |x − x_r| in the last 5 s: largest.
    "late_position_error_m",
    // Of the true and the commanded |ω|.
    "peak_rate_rad_s",
    // The farthest that θ has turned from nose up, either way: over 180° the vehicle has turned over.
    "turn_deg",
    // The law's own, while it flies.
    "least_fp_n",
    "least_k",
    // Times.
    "thrust_low_s",
    "thrust_high_s",
    "opposed_s",
    "holding_s",
    "safe_s",
];

/// The quantities whose course is sampled.
pub const CHANNELS: [&str; 6] = [
    "altitude_m",
    "forward_m",
    "forward_velocity_m_s",
    "velocity_error_m_s",
    "theta_deg",
    "thrust_to_weight",
];

/// Intervals between the samples of a flight's course.
const SAMPLES: usize = 100;
/// The end of a flight that counts as late \[s\].
const LATE: f64 = 5.0;

/// Time \[s\], and what [`CHANNELS`] names.
pub type Sample = (f32, [f32; CHANNELS.len()]);

/// A flight of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Flown {
    /// What [`FIGURES`] names.
    pub figures: [f64; FIGURES.len()],
    /// Samples, equally spaced.
    pub samples: Vec<Sample>,
    /// Whether the fault ended in its stated states; true without a fault.
    pub fault_as_stated: bool,
}

impl Flown {
    /// Flies what was drawn; `faults` are the campaign's.
    pub fn fly(drawn: &Drawn, faults: &[FaultDraw]) -> Self {
        let mission = &drawn.mission;
        let steps = mission.steps();
        let weight = mission.vehicle.mass_kg * mission.vehicle.gravity_m_s2;
        let spacing = mission.duration_s / SAMPLES as f64;
        let fault_ends = drawn.fault.and_then(|fault| fault.last_step(mission));
        let mut figures = Accumulator::default();
        let mut samples = Vec::with_capacity(SAMPLES + 1);
        let mut fault_as_stated = true;
        let mut step = 0;
        fly(mission, |row| {
            figures.add(mission, row);
            // A rounding error early rather than a step late.
            if row.t >= samples.len() as f64 * spacing - 1e-9 {
                samples.push((row.t as f32, channels(row, weight)));
            }
            if let Some(fault) = drawn.fault {
                let stated = &faults[fault.index];
                if Some(step) == fault_ends {
                    fault_as_stated &= stated.during.holds(row);
                }
                if step == steps {
                    fault_as_stated &= stated.after.holds(row);
                }
            }
            step += 1;
            true
        });
        Self {
            figures: figures.figures(mission),
            samples,
            fault_as_stated,
        }
    }
}

fn channels(row: &Row, weight: f64) -> [f32; CHANNELS.len()] {
    let offset = row.position_error();
    [
        -offset.x,
        offset.y,
        row.truth.velocity.y,
        row.velocity_error().norm(),
        row.truth.theta.to_degrees(),
        row.truth.thrust / weight,
    ]
    .map(|value| value as f32)
}

impl Expected {
    /// Whether the guidance that flew `row` was in this state.
    fn holds(&self, row: &Row) -> bool {
        let Some(guided) = row.answer.guided() else {
            return false;
        };
        let is = |expected: &Option<String>, name: &str| {
            expected.as_ref().is_none_or(|expected| expected == name)
        };
        let flags = guided.status.to_string();
        let set = |flag: &String| flags.split('|').any(|name| name == flag);
        is(&self.mode, mode_name(guided.mode))
            && is(&self.air, air_name(guided.air))
            && self.status.iter().all(set)
            && !self.not_status.iter().any(set)
    }
}

/// The figures of the rows so far.
struct Accumulator {
    altitude: [f64; 2],
    forward: [f64; 2],
    velocity_error: f64,
    late_velocity_error: f64,
    late_position_error: f64,
    rate: f64,
    turn: f64,
    fp: f64,
    k: f64,
    steps: [u32; 5],
}

impl Default for Accumulator {
    fn default() -> Self {
        let nowhere = [f64::INFINITY, f64::NEG_INFINITY];
        Self {
            altitude: nowhere,
            forward: nowhere,
            velocity_error: 0.0,
            late_velocity_error: 0.0,
            late_position_error: 0.0,
            rate: 0.0,
            turn: 0.0,
            fp: f64::INFINITY,
            k: f64::INFINITY,
            steps: [0; 5],
        }
    }
}

/// The greater of both; NaN if either is, and then for good.
fn greater(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

impl Accumulator {
    fn add(&mut self, mission: &Mission, row: &Row) {
        let offset = row.position_error();
        let widen = |range: &mut [f64; 2], value: f64| {
            *range = [-greater(-range[0], -value), greater(range[1], value)];
        };
        widen(&mut self.altitude, -offset.x);
        widen(&mut self.forward, offset.y);
        let error = row.velocity_error().norm();
        self.velocity_error = greater(self.velocity_error, error);
        if row.t >= mission.duration_s - LATE {
            self.late_velocity_error = greater(self.late_velocity_error, error);
            self.late_position_error = greater(self.late_position_error, offset.norm());
        }
        let rate = row.truth.rate.abs().max(row.answer.rate.abs());
        self.rate = greater(self.rate, rate);
        self.turn = greater(self.turn, row.truth.theta.to_degrees().abs());
        if let Some(guided) = row.answer.guided() {
            if guided.mode == Mode::Flying {
                let fp = f64::from(guided.command.diagnostics.f_p_norm);
                self.fp = self.fp.min(fp);
                self.k = self.k.min(f64::from(guided.margin.k));
            }
            let holds = |flag: Status| guided.status.contains(flag);
            let is = |mode: Mode, guided: &Guided| guided.mode == mode;
            let now = [
                holds(Status::THRUST_LOW),
                holds(Status::THRUST_HIGH),
                holds(Status::OPPOSED),
                is(Mode::Holding, guided),
                is(Mode::Safe, guided),
            ];
            for (steps, now) in self.steps.iter_mut().zip(now) {
                *steps += u32::from(now);
            }
        }
    }

    fn figures(&self, mission: &Mission) -> [f64; FIGURES.len()] {
        let [low, high, opposed, holding, safe] =
            self.steps.map(|n| f64::from(n) / mission.control_rate_hz);
        [
            self.altitude[0],
            self.altitude[1],
            self.forward[0],
            self.forward[1],
            self.velocity_error,
            self.late_velocity_error,
            self.late_position_error,
            self.rate,
            self.turn,
            self.fp,
            self.k,
            low,
            high,
            opposed,
            holding,
            safe,
        ]
    }
}
