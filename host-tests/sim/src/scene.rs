//! A flight as a viewer shows it: some columns of the record at a rate that the eye can follow, and what the controller says, in words.

use std::f64::consts::PI;
use std::io::Read;

use anyhow::{Context, ensure};
use serde::Serialize;

use crate::columns::{Column, declared, expect_todays};
use crate::experiment::Experiment;
use crate::reference::wrap;
use crate::simulate::{Step, shown};

/// The columns that are shown, by their names in a record.
pub const NUMBERS: [&str; 38] = [
    "t_s",
    "north_m",
    "east_m",
    "down_m",
    "v_north_m_s",
    "v_east_m_s",
    "v_down_m_s",
    "attitude_w",
    "attitude_x",
    "attitude_y",
    "attitude_z",
    "true_thrust_n",
    "thrust_to_weight",
    "wind_north_m_s",
    "wind_east_m_s",
    "wind_down_m_s",
    "path_north_m",
    "path_east_m",
    "path_down_m",
    "path_v_north_m_s",
    "path_v_east_m_s",
    "path_v_down_m_s",
    "velocity_error_m_s",
    "position_error_m",
    "airspeed_m_s",
    "alpha_rad",
    "wing_alpha_rad",
    "sideslip_rad",
    "load_factor",
    "thrust_n",
    "fp_n",
    "theta_tilde_rad",
    "v_cmd_north_m_s",
    "v_cmd_east_m_s",
    "v_cmd_down_m_s",
    "model_theta_rad",
    "margin_k",
    "margin_fold_rad",
];

/// The columns of words that are shown.
const WORDS: [&str; 3] = ["mode", "phase", "status"];

/// What is shown of every candidate of a plan: when it was looked at, the attitude θ that it turns to, the angle of attack there in the
/// air of now (both NaN where all is left to the servo), the push-over before, the cost (NaN where it is above that of the best so far), and
/// 1 for the plan in force, 2 for the one that is chosen, 3 for both.
pub const CANDIDATE: [&str; 6] = [
    "t_s",
    "theta_rad",
    "alpha_rad",
    "push_over_s",
    "cost_s",
    "mark",
];

/// Airspeed below which an angle of attack says nothing [m/s].
const SLOW: f64 = 1.0;

/// Least time between two rows \[s\].
const SPACING: f64 = 0.04;

/// A flight as a viewer shows it.
#[derive(Clone, Debug, Serialize)]
pub struct Scene {
    /// The names of the columns.
    pub names: &'static [&'static str],
    /// The rows, one after the other; NaN where a number is missing.
    #[serde(skip)]
    pub rows: Vec<f64>,
    /// Mode, phase and flags, each from a time \[s\] on.
    pub words: Vec<(f64, [String; 3])>,
    /// The names of what is shown of a candidate.
    pub candidate: &'static [&'static str],
    /// The candidates of every plan, one after the other.
    #[serde(skip)]
    pub plans: Vec<f64>,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            names: &NUMBERS,
            rows: Vec::new(),
            words: Vec::new(),
            candidate: &CANDIDATE,
            plans: Vec::new(),
        }
    }
}

impl Scene {
    /// The scene of a record, up to where it stands for good.
    pub fn of(experiment: &Experiment, record: &[Step]) -> Self {
        let record = shown(record);
        let mut scene = Self::default();
        for step in record {
            scene.push(experiment, step, false);
        }
        if let Some(last) = record.last() {
            scene.push(experiment, last, true);
        }
        scene
    }

    /// Whether a row at `t` \[s\] is far enough from the last one.
    fn is_due(&self, t: f64) -> bool {
        let last = self.rows.len().checked_sub(NUMBERS.len());
        // A rounding error early rather than a step late.
        last.is_none_or(|last| t > self.rows[last] + SPACING - 1e-9)
    }

    /// Adds a step: its words if they are new, its plan if it made one, its numbers if it is time, or `always`.
    pub fn push(&mut self, experiment: &Experiment, step: &Step, always: bool) {
        let word = |name| declared(name).word(experiment, step).unwrap_or_default();
        self.say(step.t, WORDS.map(word));
        let planned = self.plans.len().checked_sub(CANDIDATE.len());
        if planned.is_none_or(|last| step.t > self.plans[last]) {
            self.plan(experiment, step);
        }
        let last = self.rows.len().checked_sub(NUMBERS.len());
        let newer = last.is_none_or(|last| step.t > self.rows[last]);
        if self.is_due(step.t) || (always && newer) {
            let number = |name| declared(name).number(experiment, step);
            self.rows.extend(NUMBERS.map(number));
        }
    }

    /// Adds the candidates of a step.
    fn plan(&mut self, experiment: &Experiment, step: &Step) {
        let v_a = step.truth.velocity - step.wind;
        let gamma = libm::atan2(v_a.xy().norm(), v_a.z);
        let turned = PI - gamma - experiment.vehicle.delta_deg.to_radians();
        let chosen = step.candidates.iter().rposition(|one| one.best);
        for (i, one) in step.candidates.iter().enumerate() {
            let theta = one.target.map(f64::from);
            let moves = v_a.norm() > SLOW;
            let alpha = theta.filter(|_| moves).map(|theta| wrap(theta + turned));
            let cost = one.cost.map(f64::from);
            let mark = f64::from(one.in_force) + 2.0 * f64::from(chosen == Some(i));
            let push = one.push_over.into();
            let [theta, alpha, cost] = [theta, alpha, cost].map(|x| x.unwrap_or(f64::NAN));
            self.plans.extend([step.t, theta, alpha, push, cost, mark]);
        }
    }

    fn say(&mut self, t: f64, words: [String; 3]) {
        if self.words.last().is_none_or(|(_, last)| *last != words) {
            self.words.push((t, words));
        }
    }

    /// Leaves out plans, and rows that follow the last one that stays within less than `spacing` \[s\]; the first and the last row stay.
    pub fn thin(&mut self, spacing: f64) {
        self.plans.clear();
        let all: Vec<&[f64]> = self.rows.chunks(NUMBERS.len()).collect();
        let mut kept: Vec<f64> = Vec::new();
        let mut last = f64::NEG_INFINITY;
        for (i, row) in all.iter().enumerate() {
            // A rounding error early rather than a row late.
            if row[0] > last + spacing - 1e-9 || i + 1 == all.len() {
                kept.extend(*row);
                last = row[0];
            }
        }
        self.rows = kept;
    }

    /// The scene of a trace, as `fly` leaves it: a CSV with the record's columns by name.
    ///
    /// # Errors
    /// A row that is none, a number that is none; no position or attitude.
    pub fn read(trace: impl Read) -> anyhow::Result<Self> {
        let mut reader = csv::Reader::from_reader(trace);
        let header = reader.headers()?.clone();
        expect_todays(&header)?;
        let place = |name: &&str| header.iter().position(|column| column == *name);
        let numbers = NUMBERS.each_ref().map(place);
        let words = WORDS.each_ref().map(place);
        for needed in 0..11 {
            let name = NUMBERS[needed];
            ensure!(
                numbers[needed].is_some(),
                "has no column {name}: it is no trace of a flight, whose position and attitude are known"
            );
        }
        let mut scene = Self::default();
        let mut held: Option<Vec<f64>> = None;
        for (i, row) in reader.records().enumerate() {
            let row = row?;
            let mut of_row = Vec::with_capacity(NUMBERS.len());
            for place in numbers {
                let cell = place.and_then(|place| row.get(place)).unwrap_or("NaN");
                let number = cell.parse::<f64>();
                of_row.push(number.with_context(|| format!("row {}: {cell} is no number", i + 1))?);
            }
            let word = |place: Option<usize>| place.and_then(|place| row.get(place)).unwrap_or("");
            scene.say(of_row[0], words.map(|place| word(place).to_owned()));
            held = match scene.is_due(of_row[0]) {
                true => {
                    scene.rows.extend(of_row);
                    None
                }
                false => Some(of_row),
            };
        }
        scene.rows.extend(held.into_iter().flatten());
        Ok(scene)
    }

    /// Meanings of the columns, in their order.
    pub fn columns() -> impl Iterator<Item = &'static Column> {
        NUMBERS.iter().map(|name| declared(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::write_trace;
    use crate::experiment::Document;
    use crate::simulate::{Record, fly};

    /// A built-in experiment with one assignment, and its record.
    fn record_of(name: &str, assignment: &str) -> (Experiment, Record) {
        let mut document = Document::load(name).unwrap();
        document.assign(assignment).unwrap();
        let experiment = document.checked().unwrap();
        let record = fly(&experiment).unwrap();
        (experiment, record)
    }

    /// A scene has the record's own numbers, 25 rows a second and the last one; read from the trace it is the same.
    #[test]
    fn a_scene_is_the_record_thinned_from_memory_or_trace() {
        let (experiment, record) = record_of("mission", "duration_s=6.01");
        let scene = Scene::of(&experiment, &record);
        let rows: Vec<&[f64]> = scene.rows.chunks(NUMBERS.len()).collect();
        // 100 Hz: every fourth step, and the last one.
        assert_eq!(rows.len(), 6 * 25 + 2);
        for (row, step) in rows.iter().zip(record.iter().step_by(4)) {
            assert_eq!(row[0], step.t);
            assert_eq!(row[3], step.truth.position.z);
        }
        assert_eq!(rows.last().unwrap()[0], record.last().unwrap().t);
        assert!(scene.words.len() > 1 && scene.words[0].0 == 0.0);

        let mut trace = Vec::new();
        write_trace(&experiment, &record, &mut trace).unwrap();
        let read = Scene::read(&trace[..]).unwrap();
        assert_eq!(read.words, scene.words);
        assert_eq!(read.rows.len(), scene.rows.len());
        // The controller's numbers stand in the trace with the digits of single precision.
        for (a, b) in read.rows.iter().zip(&scene.rows) {
            assert!(a.is_nan() && b.is_nan() || (*a as f32) == (*b as f32));
        }
        let mut thin = scene.clone();
        thin.thin(0.12);
        let thinned: Vec<&[f64]> = thin.rows.chunks(NUMBERS.len()).collect();
        let expected = rows.iter().step_by(3).chain(rows.last());
        let expected: Vec<f64> = expected.map(|row| row[0]).collect();
        assert_eq!(
            thinned.iter().map(|row| row[0]).collect::<Vec<_>>(),
            expected
        );
        assert!(thin.plans.is_empty() && !scene.plans.is_empty());
        let error = Scene::read(&b"t_s,north_m\n0,0\n"[..]).unwrap_err();
        assert!(error.to_string().contains("east_m"), "{error}");
        let old = [NUMBERS.join(",").as_bytes(), b",told_q_w\n"].concat();
        let error = Scene::read(&old[..]).unwrap_err().to_string();
        assert!(
            error.contains("told_attitude_w stands for it now"),
            "{error}"
        );
    }

    /// Each plan begins with the one in force, one of its candidates is chosen, the cheapest, and that is in force in the next; its angle of attack
    /// is that of the vehicle, were it turned there.
    #[test]
    fn a_scene_has_the_candidates_of_every_plan() {
        let (experiment, record) = record_of("round-trip", "duration_s=52.0");
        let scene = Scene::of(&experiment, &record);
        let rows: Vec<&[f64]> = scene.plans.chunks(CANDIDATE.len()).collect();
        let plans: Vec<&[&[f64]]> = rows.chunk_by(|a, b| a[0] == b[0]).collect();
        // 16 a second, and some more at the beginning and where the reference jumps.
        assert!((830..880).contains(&plans.len()), "{}", plans.len());
        let chosen = |plan: &[&[f64]]| {
            let mut chosen = plan.iter().filter(|row| row[5] >= 2.0);
            let first = chosen.next().unwrap();
            assert!(chosen.next().is_none());
            first.to_vec()
        };
        let mut turned = 0;
        for (i, plan) in plans.iter().enumerate() {
            let in_force = |row: &&&[f64]| row[5] % 2.0 == 1.0;
            assert!(plan.len() > 1 && in_force(&&plan[0]));
            assert_eq!(plan.iter().filter(in_force).count(), 1);
            let best = chosen(plan);
            assert!(plan.iter().all(|row| row[4].is_nan() || best[4] <= row[4]));
            if let Some(next) = plans.get(i + 1).filter(|next| next[0][1].is_finite()) {
                // Single precision of some radians, through a turn or two.
                assert!(wrap(next[0][1] - best[1]).abs() < 1e-5);
                turned += 1;
            }
            let step = record.iter().find(|step| step.t == plan[0][0]).unwrap();
            for row in plan.iter().filter(|row| row[2].is_finite()) {
                let expected = step.wing_alpha(&experiment) + row[1] - step.theta;
                assert!(wrap(row[2] - expected).abs() < 1e-6, "{row:?}");
            }
        }
        assert!(turned > 0);
        assert!(rows.iter().any(|row| row[2].is_finite()));
    }
}
