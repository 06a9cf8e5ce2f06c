//! The columns of a record, each declared once: for the trace (CSV), samples of campaigns (Parquet), charts, replay and the README.
//!
//! A column that does not apply to a flight, as the guidance's margins to a bare law, reads `None` in every row, and is left out.

use std::borrow::Cow;
use std::io::Write;

use alula::GuidanceOutput;
use alula::guidance::{Air, Unreachable};
use alula::mission::{MissionOutput, Remark};
use alula::ned::{Frd, Ned};
use alula::planar::Diagnostics;
use nalgebra::Quaternion;

use crate::controllers::Answer;
use crate::experiment::{Experiment, V3, attitude_to_frd, to_frd};
use crate::named::renamed;
use crate::reference::wrap;
use crate::simulate::Step;

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// The controller's numbers.
    Single(f32),
    /// The plant's numbers.
    Double(f64),
    /// Names.
    Word(Cow<'static, str>),
}

/// A column of the record of a flight.
pub struct Column {
    /// Its name, with its unit.
    pub name: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Its cell in a row.
    pub read: fn(&Experiment, &Step) -> Option<Cell>,
}

/// Declares the columns: name, meaning and how to read each.
macro_rules! columns {
    ($($name:literal, $meaning:literal, $read:expr;)*) => {
        /// Every column, in the order of the trace.
        pub static COLUMNS: &[Column] = &[$(Column {
            name: $name,
            meaning: $meaning,
            read: $read,
        }),*];
    };
}

fn single(value: f32) -> Option<Cell> {
    Some(Cell::Single(value))
}

fn double(value: f64) -> Option<Cell> {
    Some(Cell::Double(value))
}

fn word(name: Option<&'static str>) -> Option<Cell> {
    name.map(|name| Cell::Word(name.into()))
}

/// A component of a vector that may be missing.
fn part(vector: Option<Ned>, of: fn(&Ned) -> f32) -> Option<Cell> {
    vector.map(|v| Cell::Single(of(&v)))
}

/// Something of the law's diagnostics.
fn law(answer: &Answer, of: fn(&Diagnostics) -> f32) -> Option<Cell> {
    answer.diagnostics().map(|d| Cell::Single(of(&d)))
}

/// Something that only the guidance reports.
fn guided(answer: &Answer, of: fn(&GuidanceOutput) -> f32) -> Option<Cell> {
    answer.guided().map(|g| Cell::Single(of(g)))
}

/// The velocity through the air as told to the guidance.
fn told_air(step: &Step) -> Option<Ned> {
    match step.input.sample.air {
        Air::Velocity(velocity) => Some(velocity),
        _ => None,
    }
}

/// The airspeed along the nose as told.
fn told_airspeed(step: &Step) -> Option<f32> {
    match step.input.sample.air {
        Air::Pitot { airspeed, .. } => Some(airspeed),
        _ => None,
    }
}

/// The specific force as told.
fn force(step: &Step, of: fn(&Frd) -> f32) -> Option<Cell> {
    let force = step.input.sample.specific_force;
    force.map(|f| Cell::Single(of(&f)))
}

/// A component of the true attitude.
fn attitude(step: &Step, of: fn(&Quaternion<f64>) -> f64) -> Option<Cell> {
    double(of(&attitude_to_frd(&step.truth.attitude)))
}

/// A component of the attitude as told: that measured, or NaN where none was told.
fn told_attitude(step: &Step, of: fn(&Quaternion<f64>) -> f64) -> Option<Cell> {
    let told = !step.input.sample.orientation.down().down.is_nan();
    double(if told {
        of(&attitude_to_frd(&step.measured_attitude))
    } else {
        f64::NAN
    })
}

/// Something of what a mission asks for.
fn mission(step: &Step, of: fn(&MissionOutput) -> f32) -> Option<Cell> {
    step.mission.as_ref().map(|m| Cell::Single(of(m)))
}

/// Something that has a meaning in a vertical plane only.
fn in_plane(experiment: &Experiment, value: f64) -> Option<Cell> {
    experiment.in_plane().then_some(Cell::Double(value))
}

columns! {
    "t_s", "time", |_, s| double(s.t);
    "north_m", "position", |_, s| double(s.truth.position.x);
    "east_m", "position", |_, s| double(s.truth.position.y);
    "down_m", "position", |_, s| double(s.truth.position.z);
    "v_north_m_s", "velocity", |_, s| double(s.truth.velocity.x);
    "v_east_m_s", "velocity", |_, s| double(s.truth.velocity.y);
    "v_down_m_s", "velocity", |_, s| double(s.truth.velocity.z);
    "attitude_w", "attitude: quaternion to north-east-down from forward, right, down", |_, s| attitude(s, |q| q.w);
    "attitude_x", "attitude", |_, s| attitude(s, |q| q.i);
    "attitude_y", "attitude", |_, s| attitude(s, |q| q.j);
    "attitude_z", "attitude", |_, s| attitude(s, |q| q.k);
    "theta_rad", "in a vertical plane: θ, counted on through full turns", |e, s| in_plane(e, s.theta);
    "roll_rate_rad_s", "body rate about the nose: positive right wing down in cruise", |_, s| double(to_frd(s.truth.rates)[0]);
    "pitch_rate_rad_s", "body rate about the right wing: positive nose up in cruise", |_, s| double(to_frd(s.truth.rates)[1]);
    "yaw_rate_rad_s", "body rate about the belly axis: positive nose right in cruise", |_, s| double(to_frd(s.truth.rates)[2]);
    "true_thrust_n", "thrust", |_, s| double(s.truth.thrust);
    "thrust_to_weight", "thrust over the weight", |e, s| double(s.truth.thrust / e.weight());
    "wind_north_m_s", "wind", |_, s| double(s.wind.x);
    "wind_east_m_s", "wind", |_, s| double(s.wind.y);
    "wind_down_m_s", "wind", |_, s| double(s.wind.z);
    "path_north_m", "position on the path", |_, s| double(s.target.position.x);
    "path_east_m", "position on the path", |_, s| double(s.target.position.y);
    "path_down_m", "position on the path", |_, s| double(s.target.position.z);
    "path_v_north_m_s", "velocity on the path", |_, s| double(s.target.velocity.x);
    "path_v_east_m_s", "velocity on the path", |_, s| double(s.target.velocity.y);
    "path_v_down_m_s", "velocity on the path", |_, s| double(s.target.velocity.z);
    "heading_rad", "heading asked for; NaN if it is free", |_, s| double(s.target.heading.unwrap_or(f64::NAN));
    "velocity_error_north_m_s", "v − v_r", |_, s| double(s.velocity_error().x);
    "velocity_error_east_m_s", "v − v_r", |_, s| double(s.velocity_error().y);
    "velocity_error_down_m_s", "v − v_r", |_, s| double(s.velocity_error().z);
    "velocity_error_m_s", "\\|v − v_r\\|", |_, s| double(s.velocity_error().norm());
    "position_error_m", "\\|x − x_r\\|", |_, s| double(s.position_error().norm());
    "altitude_m", "altitude over the path", |_, s| double(s.altitude());
    "forward_m", "in a vertical plane: position ahead of the path", |e, s| in_plane(e, s.position_error().x);
    "airspeed_m_s", "\\|v_a\\|", |_, s| double((s.truth.velocity - s.wind).norm());
    "alpha_rad", "angle of attack of the body: from the nose to the air velocity in the plane of symmetry; NaN without air velocity", |_, s| double(s.alpha());
    "wing_alpha_rad", "the same of the wing's zero-lift line", |e, s| double(s.wing_alpha(e));
    "sideslip_rad", "angle of the air velocity from the plane of symmetry; below 1 m/s as at 1 m/s", |_, s| double(s.sideslip());
    "bank_rad", "angle of the right wing below the horizontal", |_, s| double(s.bank());
    "pitch_rad", "angle of the nose over the horizontal", |_, s| double(s.pitch());
    "load_factor", "specific force over g: 1 in hover and in level cruise", |_, s| double(s.load_factor);
    "told_v_north_m_s", "velocity as told", |_, s| single(s.input.sample.velocity.north);
    "told_v_east_m_s", "velocity as told", |_, s| single(s.input.sample.velocity.east);
    "told_v_down_m_s", "velocity as told", |_, s| single(s.input.sample.velocity.down);
    "told_attitude_w", "attitude as told", |_, s| told_attitude(s, |q| q.w);
    "told_attitude_x", "attitude as told", |_, s| told_attitude(s, |q| q.i);
    "told_attitude_y", "attitude as told", |_, s| told_attitude(s, |q| q.j);
    "told_attitude_z", "attitude as told", |_, s| told_attitude(s, |q| q.k);
    "told_air", "`velocity`, `wind`, `pitot` or `unknown`: what is told of the air", |_, s| word(Some(s.input.sample.air.name()));
    "told_va_north_m_s", "air velocity as told", |_, s| part(told_air(s), |v| v.north);
    "told_va_east_m_s", "air velocity as told", |_, s| part(told_air(s), |v| v.east);
    "told_va_down_m_s", "air velocity as told", |_, s| part(told_air(s), |v| v.down);
    "told_airspeed_m_s", "airspeed along the nose as told by a pitot tube", |_, s| told_airspeed(s).map(Cell::Single);
    "told_wind_north_m_s", "wind as told, or as it follows from the air velocity", |_, s| single(s.input.wind().north);
    "told_wind_east_m_s", "wind as told, or as it follows from the air velocity", |_, s| single(s.input.wind().east);
    "told_wind_down_m_s", "wind as told, or as it follows from the air velocity", |_, s| single(s.input.wind().down);
    "told_f_forward_m_s2", "specific force along the nose as told", |_, s| force(s, |f| f.forward);
    "told_f_right_m_s2", "specific force along the right wing as told", |_, s| force(s, |f| f.right);
    "told_f_down_m_s2", "specific force towards the belly as told", |_, s| force(s, |f| f.down);
    "told_x_error_north_m", "position less that on the path as told", |_, s| part(s.input.sample.position_error, |v| v.north);
    "told_x_error_east_m", "position less that on the path as told", |_, s| part(s.input.sample.position_error, |v| v.east);
    "told_x_error_down_m", "position less that on the path as told", |_, s| part(s.input.sample.position_error, |v| v.down);
    "told_vr_north_m_s", "velocity on the path as told", |_, s| single(s.input.sample.reference.velocity.north);
    "told_vr_east_m_s", "velocity on the path as told", |_, s| single(s.input.sample.reference.velocity.east);
    "told_vr_down_m_s", "velocity on the path as told", |_, s| single(s.input.sample.reference.velocity.down);
    "told_ar_north_m_s2", "acceleration on the path as told", |_, s| single(s.input.sample.reference.acceleration.north);
    "told_ar_east_m_s2", "acceleration on the path as told", |_, s| single(s.input.sample.reference.acceleration.east);
    "told_ar_down_m_s2", "acceleration on the path as told", |_, s| single(s.input.sample.reference.acceleration.down);
    "told_aa_north_m_s2", "air acceleration as told to a law with feed-forward", |_, s| part(s.input.feed_forward.map(|f| f.air_acceleration), |v| v.north);
    "told_aa_east_m_s2", "air acceleration as told to a law with feed-forward", |_, s| part(s.input.feed_forward.map(|f| f.air_acceleration), |v| v.east);
    "told_aa_down_m_s2", "air acceleration as told to a law with feed-forward", |_, s| part(s.input.feed_forward.map(|f| f.air_acceleration), |v| v.down);
    "state_age_s", "age of the state as told", |_, s| single(s.input.sample.state_age);
    "reference_age_s", "age of what is to be flown as told", |_, s| single(s.input.sample.reference_age);
    "thrust_n", "thrust commanded", |_, s| single(s.answer.thrust);
    "command_roll_rad_s", "roll rate commanded", |_, s| single(s.answer.rates.roll);
    "command_pitch_rad_s", "pitch rate commanded", |_, s| single(s.answer.rates.pitch);
    "command_yaw_rad_s", "yaw rate commanded", |_, s| single(s.answer.rates.yaw);
    "status", "`ok`, or the fault for which a law's safe command (no thrust, no rotation) was flown; the guidance's flags", |_, s| s.answer.status().map(Cell::Word);
    "mode", "the guidance's mode", |_, s| word(s.answer.mode());
    "phase", "what the guidance does: `tracking`, `crossing`, `coasting` or `recovering`", |_, s| word(s.answer.guided().map(|g| g.progress.phase.name()));
    "unreachable", "why the path cannot be had: `sink`, `speed` or `thrust`; empty if it can", |_, s| word(s.answer.guided().map(|g| g.progress.unreachable.map_or("", Unreachable::name)));
    "air", "what of the air the guidance uses", |_, s| word(s.answer.air());
    "law_alpha_rad", "the law's angle of attack", |_, s| law(&s.answer, |d| d.alpha);
    "fp_n", "the law's \\|F_p\\|", |_, s| law(&s.answer, |d| d.f_p_norm);
    "theta_tilde_rad", "the law's θ̃, from the thrust axis to F_p", |_, s| law(&s.answer, Diagnostics::theta_tilde);
    "t_p_n", "the law's T_p", |_, s| law(&s.answer, |d| d.t_p);
    "guard_alignment", "the law's guard μ_τ of the alignment", |_, s| law(&s.answer, |d| d.guard_alignment);
    "guard_feed_forward", "the law's guard μ_τ of the feed-forward", |_, s| law(&s.answer, |d| d.guard_feed_forward);
    "k", "the law's k", |_, s| law(&s.answer, |d| d.k);
    "v_cmd_north_m_s", "velocity that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.velocity.north);
    "v_cmd_east_m_s", "velocity that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.velocity.east);
    "v_cmd_down_m_s", "velocity that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.velocity.down);
    "a_cmd_north_m_s2", "acceleration that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.acceleration.north);
    "a_cmd_east_m_s2", "acceleration that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.acceleration.east);
    "a_cmd_down_m_s2", "acceleration that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.acceleration.down);
    "model_theta_rad", "attitude θ of the guidance's reference model in its plane of flight: 0 nose up, −π/2 nose forward", |_, s| s.model_theta.map(Cell::Single);
    "margin_k", "the guidance's margin: k", |_, s| guided(&s.answer, |g| g.margin.k);
    "mission_item", "the mission's item, counted from 0", |_, s| mission(s, |m| m.progress.item.into());
    "mission_activity", "what the mission does: `grounded`, `spooling`, `rising`, `flying`, `hovering`, `descending` or `touched`", |_, s| word(s.mission.as_ref().map(|m| m.activity.name()));
    "mission_remark", "what of the item cannot be done as asked: `drifting`, `steep`, `tight_corner`, `no_lift_off`, `not_following`, `not_armed`, `not_over_place` or `too_windy`; empty if all can", |_, s| word(s.mission.as_ref().map(|m| m.remark.map_or("", Remark::name)));
    "mission_response", "what is done about what has failed: `continue`, `loiter`, `return` or `land`", |_, s| word(s.mission.as_ref().map(|m| m.response.name()));
    "mission_airspeed_m_s", "airspeed that the mission asks for; 0 in hover", |_, s| mission(s, |m| m.progress.airspeed);
    "mission_right_m", "how far the vehicle is to the right of the mission's path", |_, s| mission(s, |m| m.progress.right);
    "mission_distance_m", "way to the end of the item", |_, s| mission(s, |m| m.progress.distance_to_go);
    "mission_time_s", "time to the end of the item", |_, s| mission(s, |m| m.progress.time_to_go);
    "mission_energy_j", "energy that the propellers have given the air", |_, s| mission(s, |m| m.progress.energy);
    "mission_steady_thrust_n", "thrust of steady flight at the airspeed, turn and climb that the mission asks for", |_, s| mission(s, |m| m.progress.steady_thrust);
    "margin_fold_rad", "the guidance's margin: angle to the nearest fold, first order", |_, s| guided(&s.answer, |g| g.margin.fold);
}

impl Step {
    /// Angle of the air velocity from the plane of symmetry \[rad\].
    pub fn sideslip(&self) -> f64 {
        let v_a = self.truth.velocity - self.wind;
        let [_, _, right] = self.truth.axes();
        libm::asin(v_a.dot(&right) / v_a.norm().max(1.0))
    }

    /// Angle from the nose to the air velocity in the plane of symmetry \[rad\]; NaN without air velocity.
    pub fn alpha(&self) -> f64 {
        let v_a = self.truth.velocity - self.wind;
        if v_a == V3::zeros() {
            return f64::NAN;
        }
        let [tail, belly, _] = self.truth.axes();
        libm::atan2(v_a.dot(&belly), -v_a.dot(&tail))
    }

    /// The same of the wing's zero-lift line, in [−π, π).
    pub fn wing_alpha(&self, experiment: &Experiment) -> f64 {
        wrap(self.alpha() - experiment.vehicle.delta_deg.to_radians())
    }

    /// Angle of the right wing below the horizontal \[rad\].
    pub fn bank(&self) -> f64 {
        let [_, _, right] = self.truth.axes();
        libm::asin(right.z.clamp(-1.0, 1.0))
    }

    /// Angle of the nose over the horizontal \[rad\].
    pub fn pitch(&self) -> f64 {
        let [tail, ..] = self.truth.axes();
        libm::asin(tail.z.clamp(-1.0, 1.0))
    }
}

/// The column of this name.
pub fn column(name: &str) -> Option<&'static Column> {
    COLUMNS.iter().find(|column| column.name == name)
}

/// Refuses a header with a column of older traces.
pub fn expect_todays<'a>(header: impl IntoIterator<Item = &'a str>) -> anyhow::Result<()> {
    let todays: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
    for name in header.into_iter().filter(|name| !todays.contains(name)) {
        let now = renamed(name, &todays);
        if let Some(new) = now.iter().find(|new| todays.contains(new)) {
            anyhow::bail!(
                "{name}: a column of older traces, whose axes and signs may be others: {new} stands for it now"
            );
        }
    }
    Ok(())
}

/// The column of this name, which must be one.
pub fn declared(name: &str) -> &'static Column {
    column(name).expect("a column")
}

impl Column {
    /// The number in a row; NaN where there is none.
    pub fn number(&self, experiment: &Experiment, step: &Step) -> f64 {
        match (self.read)(experiment, step) {
            Some(Cell::Single(value)) => value.into(),
            Some(Cell::Double(value)) => value,
            _ => f64::NAN,
        }
    }

    /// The word in a row, if it is one.
    pub fn word(&self, experiment: &Experiment, step: &Step) -> Option<String> {
        match (self.read)(experiment, step) {
            Some(Cell::Word(word)) => Some(word.into_owned()),
            _ => None,
        }
    }

    /// Whether the column applies to the flight.
    pub fn applies(&self, experiment: &Experiment, record: &[Step]) -> bool {
        let reads = |step| (self.read)(experiment, step).is_some();
        record.iter().any(reads)
    }

    /// The unit that the end of its name says.
    pub fn unit(&self) -> &'static str {
        const ENDS: [(&str, &str); 9] = [
            ("_m_s3", "m/s³"),
            ("_m_s2", "m/s²"),
            ("_m_s", "m/s"),
            ("_rad_s", "rad/s"),
            ("_rad", "rad"),
            ("_m", "m"),
            ("_n", "N"),
            ("_j", "J"),
            ("_s", "s"),
        ];
        let end = ENDS.iter().find(|(end, _)| self.name.ends_with(end));
        end.map_or("", |(_, unit)| unit)
    }
}

impl Cell {
    /// Appends the cell's text. Numbers in the shortest decimal form that reads back to the same bits.
    pub fn push(&self, text: &mut Vec<u8>) {
        match self {
            Self::Single(value) => push(text, *value),
            Self::Double(value) => push(text, *value),
            Self::Word(word) => text.extend_from_slice(word.as_bytes()),
        }
    }
}

/// Appends a number.
fn push(text: &mut Vec<u8>, value: impl zmij::Float) {
    text.extend_from_slice(zmij::Buffer::new().format(value).as_bytes());
}

/// Writes the trace of a flight: CSV with the columns that apply to it, and then those of its plant. A number that is missing in a row is
/// `NaN`, a word is empty.
pub fn write_trace(
    experiment: &Experiment,
    record: &[Step],
    to: impl Write,
) -> std::io::Result<()> {
    let columns: Vec<&Column> = COLUMNS.iter().collect();
    write_columns(&columns, experiment, record, to)
}

/// The same with these columns alone, and those of the plant.
pub fn write_columns(
    columns: &[&Column],
    experiment: &Experiment,
    record: &[Step],
    mut to: impl Write,
) -> std::io::Result<()> {
    let applies = |column: &&&Column| column.applies(experiment, record);
    let columns: Vec<&Column> = columns.iter().filter(applies).copied().collect();
    let missing = |column: &&Column| {
        let mut cells = record
            .iter()
            .filter_map(|step| (column.read)(experiment, step));
        match cells.next() {
            Some(Cell::Single(_) | Cell::Double(_)) => &b"NaN"[..],
            _ => b"",
        }
    };
    let missing: Vec<&[u8]> = columns.iter().map(missing).collect();
    let names = columns.iter().map(|column| column.name);
    let of_plant = own(experiment, record).iter().map(|(name, _)| *name);
    let names: Vec<&str> = names.chain(of_plant).collect();
    let mut text = names.join(",").into_bytes();
    text.push(b'\n');
    for step in record {
        for (i, column) in columns.iter().enumerate() {
            if i > 0 {
                text.push(b',');
            }
            match (column.read)(experiment, step) {
                Some(cell) => cell.push(&mut text),
                None => text.extend_from_slice(missing[i]),
            }
        }
        for reading in &step.readings {
            text.push(b',');
            push(&mut text, *reading);
        }
        text.push(b'\n');
        if text.len() > 1 << 16 {
            to.write_all(&text)?;
            text.clear();
        }
    }
    to.write_all(&text)
}

/// Name and meaning of the columns that the plant of a flight has of its own; of a record without them none.
pub fn own(experiment: &Experiment, record: &[Step]) -> &'static [(&'static str, &'static str)] {
    match record.first().filter(|step| !step.readings.is_empty()) {
        Some(first) => experiment.plant(first.truth).columns(),
        None => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Document;
    use crate::simulate::fly;

    #[test]
    fn names_are_unique_and_carry_their_units() {
        for (i, column) in COLUMNS.iter().enumerate() {
            assert!(COLUMNS[..i].iter().all(|c| c.name != column.name));
            assert!(std::ptr::eq(super::column(column.name).unwrap(), column));
        }
        assert!(super::column("nonesuch").is_none());
    }

    /// The README's table of columns is this one.
    #[test]
    fn the_readme_lists_every_column() {
        let readme = include_str!("../../README.md");
        for column in COLUMNS {
            let line = format!(
                "| `{}` | {} | {} |",
                column.name,
                column.unit(),
                column.meaning
            );
            assert!(readme.contains(&line), "README.md lacks the line {line}");
        }
    }

    #[test]
    fn columns_of_older_traces_are_refused_with_those_of_today() {
        for (old, new) in [
            ("true_v_forward_m_s", "v_north_m_s"),
            ("true_rate_rad_s", "pitch_rate_rad_s"),
            ("rate_rad_s", "command_pitch_rad_s"),
            ("true_alpha_rad", "wing_alpha_rad"),
            ("told_q_w", "told_attitude_w"),
        ] {
            let error = expect_todays(["t_s", old]).unwrap_err().to_string();
            let wanted = format!(
                "{old}: a column of older traces, whose axes and signs may be others: {new} stands for it now"
            );
            assert_eq!(error, wanted);
        }
        // Those of today, and of other programs.
        let todays = COLUMNS.iter().map(|column| column.name);
        expect_todays(todays.chain(["side_force", "max_turn_g", "roll"])).unwrap();
    }

    #[test]
    fn a_trace_has_the_columns_that_apply() {
        let header = |name: &str| {
            let mut document = Document::load(name).unwrap();
            document.assign("duration_s=0.2").unwrap();
            let experiment = document.checked().unwrap();
            let record = fly(&experiment).unwrap();
            let mut text = Vec::new();
            write_trace(&experiment, &record, &mut text).unwrap();
            let text = String::from_utf8(text).unwrap();
            assert_eq!(text.lines().count(), 1 + record.len());
            let cells = |line: &str| line.matches(',').count();
            assert!(
                text.lines()
                    .all(|l| cells(l) == cells(text.lines().next().unwrap()))
            );
            text.lines().next().unwrap().to_owned()
        };
        let law = header("hover-to-cruise");
        assert!(!law.contains("aa_down") && !law.contains("margin_k") && law.contains(",k"));
        assert!(header("large-angle").contains(",told_aa_down_m_s2,"));
        let guided = header("round-trip");
        assert!(
            guided.contains(",margin_k,") && guided.contains(",status,mode,phase,unreachable,air,")
        );
    }
}
