//! The columns of a record, each declared once: for the trace (CSV), samples of campaigns (Parquet), charts, replay and the README.
//!
//! A column that does not apply to a flight, as the guidance's margins to a bare law, reads `None` in every row, and is left out.

use std::borrow::Cow;
use std::io::Write;

use alula::Inertial;
use alula::control::Diagnostics;
use alula::guidance::Air;

use crate::controllers::Answer;
use crate::decimal;
use crate::experiment::Experiment;
use crate::reference::{Vector, wrap};
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

/// What is flown, in the plane or in space: what its record holds.
pub trait Flight: Sized + 'static {
    /// One control step.
    type Step;

    /// Every column, in the order of the trace.
    fn columns() -> &'static [Column<Self>];

    /// Time of a step \[s\].
    fn time(step: &Self::Step) -> f64;

    /// The column of this name.
    fn column(name: &str) -> Option<&'static Column<Self>> {
        Self::columns().iter().find(|column| column.name == name)
    }

    /// The column of this name, which must be one.
    fn declared(name: &str) -> &'static Column<Self> {
        Self::column(name).expect("a column")
    }
}

/// A column of the record of a flight `F`.
pub struct Column<F: Flight = Experiment> {
    /// Its name, with its unit.
    pub name: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Its cell in a row.
    pub read: fn(&F, &F::Step) -> Option<Cell>,
}

/// Declares the columns of the flight of `$experiment`: name, meaning and how to read each.
macro_rules! columns {
    ($experiment:ty, $step:ty; $($name:literal, $meaning:literal, $read:expr;)*) => {
        /// Every column, in the order of the trace.
        pub static COLUMNS: &[$crate::columns::Column<$experiment>] = &[$($crate::columns::Column {
            name: $name,
            meaning: $meaning,
            read: $read,
        }),*];

        impl $crate::columns::Flight for $experiment {
            type Step = $step;

            fn columns() -> &'static [$crate::columns::Column<Self>] {
                COLUMNS
            }

            fn time(step: &$step) -> f64 {
                step.t
            }
        }
    };
}
pub(crate) use columns;

pub(crate) fn single(value: f32) -> Option<Cell> {
    Some(Cell::Single(value))
}

pub(crate) fn double(value: f64) -> Option<Cell> {
    Some(Cell::Double(value))
}

pub(crate) fn word(name: Option<&'static str>) -> Option<Cell> {
    name.map(|name| Cell::Word(name.into()))
}

/// A component of a vector that may be missing.
fn part(vector: Option<Inertial>, of: fn(&Inertial) -> f32) -> Option<Cell> {
    vector.map(|v| Cell::Single(of(&v)))
}

/// Something of the law's diagnostics.
fn law(answer: &Answer, of: fn(&Diagnostics) -> f32) -> Option<Cell> {
    answer.diagnostics().map(|d| Cell::Single(of(&d)))
}

/// Something that only the guidance reports.
fn guided(answer: &Answer, of: fn(&alula::PlanarGuidanceOutput) -> f32) -> Option<Cell> {
    answer.guided().map(|g| Cell::Single(of(g)))
}

fn told_air(step: &Step) -> Option<Inertial> {
    match step.input.sample.air {
        Air::Velocity(velocity) => Some(velocity),
        _ => None,
    }
}

fn force(step: &Step, of: fn(&alula::Body) -> f32) -> Option<Cell> {
    step.input
        .sample
        .specific_force
        .map(|f| Cell::Single(of(&f)))
}

columns! { Experiment, Step;
    "t_s", "time", |_, s| double(s.t);
    "v_down_m_s", "velocity as told", |_, s| single(s.input.sample.velocity.down());
    "v_forward_m_s", "velocity as told", |_, s| single(s.input.sample.velocity.forward());
    "theta_rad", "θ as told, in [−π, π)", |_, s| single(s.input.theta);
    "wind_down_m_s", "wind as told, or as it follows from the air velocity", |_, s| single(s.input.wind().down());
    "wind_forward_m_s", "wind as told, or as it follows from the air velocity", |_, s| single(s.input.wind().forward());
    "vr_down_m_s", "reference velocity as told", |_, s| single(s.input.sample.reference.velocity.down());
    "vr_forward_m_s", "reference velocity as told", |_, s| single(s.input.sample.reference.velocity.forward());
    "ar_down_m_s2", "reference acceleration as told", |_, s| single(s.input.sample.reference.acceleration.down());
    "ar_forward_m_s2", "reference acceleration as told", |_, s| single(s.input.sample.reference.acceleration.forward());
    "aa_down_m_s2", "air acceleration as told to a law with feed-forward", |_, s| part(s.input.feed_forward.map(|f| f.air_acceleration), |v| v.down());
    "aa_forward_m_s2", "air acceleration as told to a law with feed-forward", |_, s| part(s.input.feed_forward.map(|f| f.air_acceleration), |v| v.forward());
    "jr_down_m_s3", "jerk of the reference as told to a law with feed-forward", |_, s| part(s.input.feed_forward.map(|f| f.jerk), |v| v.down());
    "jr_forward_m_s3", "jerk of the reference as told to a law with feed-forward", |_, s| part(s.input.feed_forward.map(|f| f.jerk), |v| v.forward());
    "air_told", "`velocity`, `wind` or `unknown`: what is told of the air", |_, s| beyond_laws(s).and_then(|()| word(Some(match s.input.sample.air {
        Air::Velocity(_) => "velocity",
        Air::Wind(_) => "wind",
        Air::Unknown => "unknown",
    })));
    "va_down_m_s", "air velocity as told", |_, s| beyond_laws(s).and_then(|()| part(told_air(s), |v| v.down()));
    "va_forward_m_s", "air velocity as told", |_, s| beyond_laws(s).and_then(|()| part(told_air(s), |v| v.forward()));
    "f_i_m_s2", "specific force along the tail as told", |_, s| beyond_laws(s).and_then(|()| force(s, |f| f.i()));
    "f_j_m_s2", "specific force along the belly as told", |_, s| beyond_laws(s).and_then(|()| force(s, |f| f.j()));
    "xe_down_m", "position less reference position as told", |_, s| beyond_laws(s).and_then(|()| part(s.input.sample.position_error, |v| v.down()));
    "xe_forward_m", "position less reference position as told", |_, s| beyond_laws(s).and_then(|()| part(s.input.sample.position_error, |v| v.forward()));
    "state_age_s", "age of the state as told", |_, s| beyond_laws(s).and_then(|()| single(s.input.sample.state_age));
    "reference_age_s", "age of the reference as told", |_, s| beyond_laws(s).and_then(|()| single(s.input.sample.reference_age));
    "thrust_n", "thrust commanded", |_, s| single(s.answer.thrust);
    "rate_rad_s", "angular rate commanded", |_, s| single(s.answer.rate);
    "alpha_rad", "the law's angle of attack", |_, s| law(&s.answer, |d| d.alpha);
    "fp_n", "the law's \\|F_p\\|", |_, s| law(&s.answer, |d| d.f_p_norm);
    "status", "`ok`, or the fault for which a law's safe command (no thrust, no rotation) was flown; the guidance's flags", |_, s| s.answer.status().map(Cell::Word);
    "mode", "the guidance's mode", |_, s| word(s.answer.mode());
    "phase", "what the guidance does: `tracking`, `crossing`, `coasting` or `recovering`", |_, s| word(s.answer.guided().map(|g| g.progress.phase.name()));
    "unreachable", "why the reference cannot be had: `sink`, `speed` or `thrust`; empty if it can", |_, s| word(s.answer.guided().map(|g| g.progress.unreachable.map_or("", alula::guidance::Unreachable::name)));
    "air", "what of the air the guidance uses", |_, s| word(s.answer.air());
    "theta_tilde_rad", "the law's θ̃, from the thrust axis to F_p", |_, s| law(&s.answer, Diagnostics::theta_tilde);
    "t_p_n", "the law's T_p", |_, s| law(&s.answer, |d| d.t_p);
    "guard_alignment", "the law's guard μ_τ of the alignment", |_, s| law(&s.answer, |d| d.guard_alignment);
    "guard_feed_forward", "the law's guard μ_τ of the feed-forward", |_, s| law(&s.answer, |d| d.guard_feed_forward);
    "k", "the law's k", |_, s| law(&s.answer, |d| d.k);
    "v_cmd_down_m_s", "velocity that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.velocity.down());
    "v_cmd_forward_m_s", "velocity that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.velocity.forward());
    "a_cmd_down_m_s2", "acceleration that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.acceleration.down());
    "a_cmd_forward_m_s2", "acceleration that the guidance gives to its law", |_, s| guided(&s.answer, |g| g.reference.acceleration.forward());
    "margin_k", "the guidance's margin: k", |_, s| guided(&s.answer, |g| g.margin.k);
    "margin_fold_rad", "the guidance's margin: angle to the nearest fold, first order", |_, s| guided(&s.answer, |g| g.margin.fold);
    "true_alpha_rad", "angle of attack; NaN without air velocity", |e, s| double(alpha(e, s));
    "true_v_down_m_s", "velocity", |_, s| double(s.truth.velocity.x);
    "true_v_forward_m_s", "velocity", |_, s| double(s.truth.velocity.y);
    "true_theta_rad", "θ, counted on through full turns", |_, s| double(s.truth.theta);
    "true_rate_rad_s", "angular rate", |_, s| double(s.truth.rate);
    "altitude_m", "altitude over the reference", |_, s| double(-s.position_error().x);
    "forward_m", "forward of the reference", |_, s| double(s.position_error().y);
    "velocity_error_down_m_s", "v − v_r", |_, s| double(s.velocity_error().x);
    "velocity_error_forward_m_s", "v − v_r", |_, s| double(s.velocity_error().y);
    "velocity_error_m_s", "\\|v − v_r\\|", |_, s| double(s.velocity_error().norm());
    "thrust_to_weight", "thrust over the weight", |e, s| double(s.truth.thrust / e.weight());
    "true_wind_down_m_s", "wind", |_, s| beyond_laws(s).and_then(|()| double(s.wind.x));
    "true_wind_forward_m_s", "wind", |_, s| beyond_laws(s).and_then(|()| double(s.wind.y));
}

/// Whether more than a bare law's inputs were used.
fn beyond_laws(step: &Step) -> Option<()> {
    match step.answer.report {
        crate::controllers::Report::Law(_) => None,
        _ => Some(()),
    }
}

/// The true angle of attack in [−π, π) \[rad\].
fn alpha(experiment: &Experiment, step: &Step) -> f64 {
    let v: Vector = step.truth.velocity - step.wind;
    if v == Vector::zeros() {
        return f64::NAN;
    }
    let delta = experiment.vehicle.delta_deg.to_radians();
    wrap(step.truth.theta - v.y.atan2(v.x) + std::f64::consts::PI - delta)
}

/// The column of this name of a flight in the plane.
pub fn column(name: &str) -> Option<&'static Column> {
    Experiment::column(name)
}

impl<F: Flight> Column<F> {
    /// The number in a row; NaN where there is none.
    pub fn number(&self, experiment: &F, step: &F::Step) -> f64 {
        match (self.read)(experiment, step) {
            Some(Cell::Single(value)) => value.into(),
            Some(Cell::Double(value)) => value,
            _ => f64::NAN,
        }
    }

    /// The word in a row, if it is one.
    pub fn word(&self, experiment: &F, step: &F::Step) -> Option<String> {
        match (self.read)(experiment, step) {
            Some(Cell::Word(word)) => Some(word.into_owned()),
            _ => None,
        }
    }

    /// Whether the column applies to the flight.
    pub fn applies(&self, experiment: &F, record: &[F::Step]) -> bool {
        let reads = |step| (self.read)(experiment, step).is_some();
        record.iter().any(reads)
    }

    /// The unit that the end of its name says.
    pub fn unit(&self) -> &'static str {
        const ENDS: [(&str, &str); 8] = [
            ("_m_s3", "m/s³"),
            ("_m_s2", "m/s²"),
            ("_m_s", "m/s"),
            ("_rad_s", "rad/s"),
            ("_rad", "rad"),
            ("_m", "m"),
            ("_n", "N"),
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
            Self::Single(value) => decimal::push(text, *value),
            Self::Double(value) => decimal::push(text, *value),
            Self::Word(word) => text.extend_from_slice(word.as_bytes()),
        }
    }
}

/// Writes the trace of a flight: CSV with the columns that apply to it. A number that is missing in a row is `NaN`, a word is empty.
pub fn write_trace<F: Flight>(
    experiment: &F,
    record: &[F::Step],
    to: impl Write,
) -> std::io::Result<()> {
    let columns: Vec<&Column<F>> = F::columns()
        .iter()
        .filter(|column| column.applies(experiment, record))
        .collect();
    write_columns(&columns, experiment, record, to)
}

/// The same with these columns.
pub fn write_columns<F: Flight>(
    columns: &[&Column<F>],
    experiment: &F,
    record: &[F::Step],
    mut to: impl Write,
) -> std::io::Result<()> {
    let missing = |column: &&Column<F>| {
        let mut cells = record
            .iter()
            .filter_map(|step| (column.read)(experiment, step));
        match cells.next() {
            Some(Cell::Single(_) | Cell::Double(_)) => &b"NaN"[..],
            _ => b"",
        }
    };
    let missing: Vec<&[u8]> = columns.iter().map(missing).collect();
    let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
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
        text.push(b'\n');
        if text.len() > 1 << 16 {
            to.write_all(&text)?;
            text.clear();
        }
    }
    to.write_all(&text)
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
            let line = format!("| `{}` | {} |", column.name, column.meaning);
            assert!(readme.contains(&line), "README.md lacks the line {line}");
        }
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
        assert!(!law.contains("aa_down") && !law.contains("margin_k") && law.contains(",k,"));
        assert!(header("large-angle").contains(",aa_down_m_s2,"));
        let guided = header("round-trip");
        assert!(guided.contains(",margin_k,") && guided.contains(",mode,phase,unreachable,air,"));
    }
}
