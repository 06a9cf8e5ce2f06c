//! Figures of merit, each declared once: for the terminal, `--json`, limits of campaigns, columns of comparisons and the README.
//!
//! A figure is a fold over the control steps of a flight, or of a part of it. One rule for missing values and NaN: a value that is
//! missing, such as |F_p| of a controller without one, is left out, and so are steps on the ground with the motors off, but at the end of a flight; a NaN makes the figure NaN, and so does the want of any value, as
//! of a way back that was not flown. A figure that is NaN is `null` in JSON, and outside of every limit.

use alula::guidance::{Mode, Phase, Progress, Status};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::experiment::{Experiment, V3};
use crate::named::hint;
use crate::plant::tail_sitter::ELEVONS;
use crate::reference::wrap;
use crate::simulate::Step;

/// Sinking further below the reference than this is a loss \[m\].
pub const LOST: f64 = 50.0;
/// Length of the end of a flight, of cruise or of a segment that counts as late \[s\].
pub const LATE: f64 = 5.0;
/// Velocity error below which cruise is reached \[m/s\].
pub const REACHED: f64 = 1.0;
/// Velocity error below which a flight counts as settled \[m/s\].
pub const SETTLED: f64 = 0.05;

/// Change of the speed asked for up to which it is steady \[m/s²\]: what single precision leaves of a constant speed is 1e-3.
const STEADY: f64 = 0.01;
/// Speeds asked for that differ by less are the same \[m/s\]: a climb adds as much to a steady speed.
const SAME: f64 = 0.1;

/// A control step, with what several figures need of it.
pub struct Moment<'a> {
    experiment: &'a Experiment,
    step: &'a Step,
    /// x − x_r \[m\].
    offset: V3,
    /// |v − v_r| \[m/s\].
    error: f64,
}

impl<'a> Moment<'a> {
    fn new(experiment: &'a Experiment, step: &'a Step) -> Self {
        Self {
            experiment,
            step,
            offset: step.position_error(),
            error: step.velocity_error().norm(),
        }
    }
}

/// A part of a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    Flight,
    /// All of it, if it stays in the vertical plane to the north.
    Plane,
    /// What comes after settling.
    Settled,
    /// Its last 5 s.
    Late,
    /// Until the path slows down.
    Out,
    /// From then on.
    Back,
    /// The last 5 s of cruise: of the fastest steady part of the path.
    LateCruise,
}

impl Part {
    /// Whether it is known only when the flight has been flown.
    fn is_phase(self) -> bool {
        matches!(self, Self::Out | Self::Back | Self::LateCruise)
    }
}

/// How a figure is made of the steps.
pub enum Fold {
    /// The greatest of values that are not negative.
    Peak(fn(&Moment) -> f64),
    /// The least value.
    Least(fn(&Moment) -> Option<f64>),
    /// The greatest value.
    Most(fn(&Moment) -> Option<f64>),
    /// The last value.
    Last(fn(&Moment) -> f64),
    /// The mean.
    Mean(fn(&Moment) -> f64),
    /// The root mean square.
    Rms(fn(&Moment) -> f64),
    /// The time in which something holds \[s\].
    Time(fn(&Moment) -> bool),
    /// The number of steps in which something holds.
    Count(fn(&Moment) -> bool),
    /// The last time before the end of cruise at which an error \[m/s\] is not below a limit, from the path's first change of speed \[s\]; 0 if it never
    /// is, NaN if it is in the last 5 s of cruise.
    Until(fn(&Phases, &Point) -> f64, f64),
    /// Made of figures declared before it.
    Of(fn(&Figures) -> f64),
}

/// A figure.
pub struct Figure {
    /// Its name, with its unit.
    pub name: &'static str,
    /// Its name in tables.
    pub label: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Digits after the point in tables.
    pub digits: usize,
    /// What it is.
    pub meaning: &'static str,
    /// The part of the flight that it is of.
    pub part: Part,
    /// How it is made.
    pub fold: Fold,
    /// The name of the time at which the extreme lies, if that is a figure, too.
    pub when: Option<&'static str>,
}

macro_rules! figures {
    ($($name:literal, $label:literal, $unit:literal, $digits:literal, $part:ident, $fold:expr, $meaning:literal $(, when $when:literal)?;)*) => {
        /// Every figure.
        pub static FIGURES: &[Figure] = &[$(Figure {
            name: $name,
            label: $label,
            unit: $unit,
            digits: $digits,
            meaning: $meaning,
            part: Part::$part,
            fold: $fold,
            when: figures!(@when $($when)?),
        }),*];
    };
    (@when) => { None };
    (@when $when:literal) => { Some($when) };
}

use Fold::{Count, Last, Least, Mean, Most, Of, Peak, Rms, Time, Until};

figures! {
    "velocity_error_rms_m_s", "velocity error, rms", "m/s", 3, Settled, Rms(|m| m.error), "root mean square of \\|v − v_r\\|";
    "max_velocity_error_m_s", "velocity error, peak", "m/s", 4, Settled, Peak(|m| m.error), "largest \\|v − v_r\\| at a control step", when "max_velocity_error_time_s";
    "position_error_rms_m", "position error, rms", "m", 3, Settled, Rms(|m| m.offset.norm()), "root mean square of \\|x − x_r\\|";
    "max_position_error_m", "position error, peak", "m", 3, Settled, Peak(|m| m.offset.norm()), "largest \\|x − x_r\\|";
    "sideslip_rms_deg", "sideslip, rms", "°", 3, Settled, Rms(|m| m.step.sideslip().to_degrees()), "root mean square of the sideslip";
    "max_sideslip_deg", "sideslip, peak", "°", 2, Settled, Peak(|m| m.step.sideslip().to_degrees().abs()), "largest sideslip, either way";
    "max_bank_deg", "bank, peak", "°", 1, Settled, Peak(|m| m.step.bank().to_degrees().abs()), "largest angle of the right wing from the horizontal, either way";
    "max_load_factor", "load factor, peak", "", 2, Settled, Peak(|m| m.step.load_factor), "largest specific force over g";
    "rate_rms_rad_s", "body rate, rms", "rad/s", 3, Settled, Rms(|m| m.step.truth.rates.norm()), "root mean square of \\|ω\\|";
    "min_fp_n", "apparent force, smallest", "N", 2, Flight, Least(|m| m.step.answer.diagnostics_flying().map(|d| d.f_p_norm.into())), "smallest \\|F_p\\| while the law is flown, as the controller computes it", when "min_fp_time_s";
    "min_k", "gain of the full law, smallest", "", 3, Flight, Least(|m| m.step.answer.guided().filter(|g| g.mode == Mode::Flying).map(|g| g.margin.k.into())), "smallest margin k while the guidance flies its law";
    "max_rate_command_rad_s", "body rate commanded, peak", "rad/s", 3, Flight, Peak(|m| command(m).amax()), "largest body rate commanded about one axis", when "max_rate_command_time_s";
    "max_true_rate_rad_s", "body rate, peak", "rad/s", 2, Flight, Peak(|m| m.step.truth.rates.amax()), "largest true body rate about one axis";
    "altitude_least_m", "least altitude", "m", 2, Flight, Least(|m| Some(-m.offset.z)), "least altitude over the path";
    "altitude_most_m", "greatest altitude", "m", 2, Flight, Most(|m| Some(-m.offset.z)), "greatest altitude over the path";
    "forward_least_m", "farthest behind", "m", 2, Plane, Least(|m| Some(m.offset.x)), "in a vertical plane: least position ahead of the path";
    "forward_most_m", "farthest ahead", "m", 2, Plane, Most(|m| Some(m.offset.x)), "in a vertical plane: greatest position ahead of the path";
    "max_turn_deg", "farthest from nose up", "°", 1, Plane, Most(|m| Some(m.step.theta.to_degrees().abs())), "in a vertical plane: farthest that θ has turned from nose up, either way: over 180° the vehicle has turned over";
    "max_late_velocity_error_m_s", "end error, peak", "m/s", 2, Late, Peak(|m| m.error), "largest \\|v − v_r\\| in the last 5 s";
    "late_velocity_error_rms_m_s", "end error, rms", "m/s", 3, Late, Rms(|m| m.error), "root mean square of \\|v − v_r\\| in the last 5 s";
    "late_mean_velocity_error_m_s", "end error, mean", "m/s", 2, Late, Mean(|m| m.error), "mean \\|v − v_r\\| in the last 5 s";
    "max_late_position_error_m", "end position error, peak", "m", 2, Late, Peak(|m| m.offset.norm()), "largest \\|x − x_r\\| in the last 5 s";
    "late_rate_rms_rad_s", "body rate at the end, rms", "rad/s", 5, Late, Rms(|m| m.step.truth.rates.norm()), "root mean square of \\|ω\\| in the last 5 s";
    "cruise_rate_rms_rad_s", "body rate in cruise, rms", "rad/s", 5, LateCruise, Rms(|m| m.step.truth.rates.norm()), "root mean square of \\|ω\\| in the last 5 s of cruise";
    "cruise_mean_thrust_to_weight", "cruise thrust, mean", "", 3, LateCruise, Mean(|m| m.step.truth.thrust / m.experiment.weight()), "mean thrust over the weight in the last 5 s of cruise: near one half, and it is flown behind the stall";
    "oscillation_rms_rad_s", "oscillation, rms", "rad/s", 2, Flight, Of(|of| greater(of.get("cruise_rate_rms_rad_s"), of.get("late_rate_rms_rad_s"))), "the greater of both root mean squares of \\|ω\\|";
    "thrust_low_s", "thrust at its lower limit", "s", 2, Flight, Time(|m| flag(m, Status::THRUST_LOW)), "time with thrust at its lower limit";
    "thrust_high_s", "thrust at its upper limit", "s", 2, Flight, Time(|m| flag(m, Status::THRUST_HIGH)), "time with thrust at its upper limit";
    "crossing_s", "crossing", "s", 2, Flight, Time(crossing), "time in which the guidance turns to an attitude far away, as across a fold";
    "crossing_on_path_s", "crossing after settling", "s", 2, Settled, Time(crossing), "the same after settling";
    "unreachable_s", "path unreachable", "s", 2, Flight, Time(|m| progress(m, |p| p.unreachable.is_some())), "time in which the guidance says that the path cannot be had";
    "holding_s", "holding the last command", "s", 2, Flight, Time(|m| mode(m, Mode::Holding)), "time in which the guidance holds its last command";
    "safe_s", "safe command", "s", 2, Flight, Time(|m| mode(m, Mode::Safe)), "time in which the guidance gives its safe command";
    "elevons_stopped_s", "elevons at their stop", "s", 2, Flight, Time(|m| elevons_stopped(m) && !progress(m, |p| p.phase == Phase::Recovering)), "of a `tail-sitter`: time in which an elevon is within 1° of its stop, but while the guidance recovers";
    "max_loss_out_m", "loss out, peak", "m", 1, Out, Peak(|m| at_least_zero(m.offset.z)), "greatest altitude below the path until that slows down";
    "max_gain_out_m", "gain out, peak", "m", 1, Out, Peak(|m| at_least_zero(-m.offset.z)), "greatest altitude above the path until that slows down";
    "max_loss_back_m", "loss back, peak", "m", 1, Back, Peak(|m| at_least_zero(m.offset.z)), "greatest altitude below the path from where that slows down";
    "max_gain_back_m", "gain back, peak", "m", 1, Back, Peak(|m| at_least_zero(-m.offset.z)), "greatest altitude above the path from where that slows down";
    "max_ahead_m", "ahead, peak", "m", 0, Back, Peak(|m| at_least_zero(m.offset.x)), "farthest north of the path from where that slows down: ahead, where it goes north";
    "cruise_after_s", "cruise after", "s", 1, Flight, Until(Phases::cruise_error, REACHED), "from the path's first change of speed until \\|v − v_r\\| to the cruise velocity stays under 1 m/s to the end of cruise";
    "settling_s", "settling", "s", 1, Flight, Until(|_, point| point.error(), SETTLED), "from the path's first change of speed until \\|v − v_r\\| stays under 0.05 m/s to the end of cruise";
    "max_cruise_error_m_s", "cruise error, peak", "m/s", 2, LateCruise, Peak(|m| m.error), "largest \\|v − v_r\\| in the last 5 s of cruise";
    "final_velocity_error_m_s", "final velocity error", "m/s", 4, Flight, Last(|m| m.error), "\\|v − v_r\\| at the end";
    "final_altitude_m", "final altitude", "m", 2, Flight, Last(|m| -m.offset.z), "altitude over the path at the end";
    "final_alpha_deg", "final angle of attack", "°", 3, Flight, Last(|m| m.step.wing_alpha(m.experiment).to_degrees()), "true angle of attack of the wing at the end";
    "final_theta_deg", "final orientation", "°", 3, Plane, Last(|m| wrap(m.step.theta).to_degrees()), "in a vertical plane: θ at the end, in [−180°, 180°)";
    "final_nose_deg", "nose from upright, end", "°", 2, Flight, Last(|m| 90.0 - m.step.pitch().to_degrees()), "angle of the nose from upright at the end";
    "final_belly_deg", "belly from down, end", "°", 2, Flight, Last(|m| libm::acos(m.step.truth.axes()[1].z.clamp(-1.0, 1.0)).to_degrees()), "angle of the belly from straight down at the end: in cruise that of attack and bank";
    "final_thrust_to_weight", "final thrust to weight", "", 4, Flight, Last(|m| m.step.truth.thrust / m.experiment.weight()), "thrust over the weight at the end";
    "faults", "steps with a fault", "steps", 0, Flight, Count(|m| m.step.answer.fault().is_some()), "control steps in which a bare law ended in a fault and its safe command was flown";
    "lost", "lost", "flag", 0, Flight, Of(|of| f64::from(of.get("altitude_least_m").is_nan() || of.get("altitude_least_m") < -LOST)), "whether the flight sank more than 50 m below its path, or came to no number";
}

/// The greater of both; `b` if `a` has no value, and NaN if `b` has none.
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// `value`, but 0 if it is negative; NaN stays.
fn at_least_zero(value: f64) -> f64 {
    if value < 0.0 { 0.0 } else { value }
}

/// Body rates commanded.
fn command(m: &Moment) -> V3 {
    let rates = m.step.answer.rates;
    V3::new(rates.yaw.into(), rates.pitch.into(), rates.roll.into())
}

fn crossing(m: &Moment) -> bool {
    progress(m, |p| p.phase == Phase::Crossing)
}

fn elevons_stopped(m: &Moment) -> bool {
    let travel = m
        .experiment
        .tail_sitter
        .as_ref()
        .map(|plant| plant.travel_deg());
    match (travel, m.step.readings.get(ELEVONS..ELEVONS + 2)) {
        (Some(travel), Some(elevons)) if travel > 0.0 => {
            elevons.iter().any(|at| at.abs() > travel - 1.0)
        }
        _ => false,
    }
}

fn flag(m: &Moment, flag: Status) -> bool {
    let guided = m.step.answer.guided();
    guided.is_some_and(|g| g.status.contains(flag))
}

fn progress(m: &Moment, holds: fn(&Progress) -> bool) -> bool {
    let guided = m.step.answer.guided();
    guided.is_some_and(|g| g.mode == Mode::Flying && holds(&g.progress))
}

fn mode(m: &Moment, mode: Mode) -> bool {
    m.step.answer.guided().is_some_and(|g| g.mode == mode)
}

/// What the phases of a flight are found from, at a control step.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    t: f64,
    /// The speed asked for \[m/s\].
    asked: f64,
    /// The velocity asked for, and the true one \[m/s\].
    reference: V3,
    velocity: V3,
}

impl Point {
    /// |v − v_r| \[m/s\].
    fn error(&self) -> f64 {
        (self.velocity - self.reference).norm()
    }
}

/// The phases of a flight, by the speed that is asked for over time: whatever its path is written as.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phases {
    /// Where settling ends \[s\].
    settled: f64,
    /// Where the part ends that is looked at \[s\].
    end: f64,
    /// When the speed changes first \[s\].
    start: f64,
    /// The fastest steady phase, the first of them \[s\]; without one, the end.
    cruise: [f64; 2],
    /// The velocity asked for there \[m/s\].
    cruise_velocity: V3,
    /// Where the speed begins to fall, by more than [`REACHED`], for the first time \[s\].
    back: f64,
}

impl Phases {
    /// The phases of what was flown, up to its `end` \[s\].
    fn of(course: &[Point], settled: f64, end: f64) -> Self {
        let mut phases = Self {
            back: end,
            ..Self::segment(end, end)
        };
        (phases.settled, phases.start) = (settled, 0.0);
        let changes = |ends: &[Point]| (ends[1].asked - ends[0].asked) / (ends[1].t - ends[0].t);
        let steady = |ends: &[Point]| changes(ends).abs() <= STEADY;
        let mut pieces = course.windows(2);
        if let Some(ends) = pieces.find(|ends| !steady(ends)) {
            phases.start = ends[0].t;
        }
        let mut fastest = f64::NEG_INFINITY;
        let runs = course.chunk_by(|&a, &b| steady(&[a, b]));
        for run in runs.filter(|run| run.len() > 1) {
            let (from, to) = (run[0], run[run.len() - 1]);
            if from.asked > fastest + SAME {
                fastest = from.asked;
                phases.cruise = [from.t, to.t];
                phases.cruise_velocity = from.reference;
            }
        }
        let (mut most, mut last) = course.first().map_or((0.0, end), |p| (p.asked, p.t));
        for ends in course.windows(2) {
            let asked = ends[1].asked;
            if asked >= most - SAME && changes(ends) >= -STEADY {
                (most, last) = (most.max(asked), ends[1].t);
            } else if asked < most - REACHED {
                phases.back = last;
                break;
            }
        }
        phases
    }

    /// A segment by itself: it is its own cruise.
    fn segment(from: f64, to: f64) -> Self {
        Self {
            settled: from,
            end: to,
            start: from,
            cruise: [from, to],
            cruise_velocity: V3::zeros(),
            back: to,
        }
    }

    /// The end of cruise that counts as late \[s\].
    fn late_cruise(&self) -> std::ops::Range<f64> {
        let [begin, end] = self.cruise;
        begin.max(end - LATE)..end
    }

    fn has(&self, part: Part, t: f64) -> bool {
        match part {
            Part::Flight | Part::Plane => true,
            Part::Settled => t >= self.settled,
            Part::Late => t >= self.end - LATE,
            Part::Out => t < self.back,
            Part::Back => self.back < self.end && t >= self.back,
            Part::LateCruise => self.late_cruise().contains(&t),
        }
    }

    /// |v − v_r| \[m/s\]; before cruise, that to the velocity of cruise.
    fn cruise_error(&self, point: &Point) -> f64 {
        let before = point.t < self.cruise[0];
        let wanted = if before {
            self.cruise_velocity
        } else {
            point.reference
        };
        (point.velocity - wanted).norm()
    }
}

/// A fold's state.
#[derive(Clone, Copy)]
struct State {
    value: f64,
    /// Where the value was taken \[s\]; NaN before the first one.
    time: f64,
    /// How many values there were.
    count: u32,
}

impl State {
    /// Before the first value.
    const NONE: Self = Self {
        value: 0.0,
        time: f64::NAN,
        count: 0,
    };

    /// Takes a value of a step at `t` \[s\].
    fn add(&mut self, fold: &Fold, value: f64, t: f64) {
        let first = self.count == 0;
        self.count += 1;
        match fold {
            Peak(_) | Most(_) => self.extreme(value, t, first || value > self.value),
            Least(_) => self.extreme(value, t, first || value < self.value),
            Mean(_) | Time(_) | Count(_) => self.value += value,
            Rms(_) => self.value += value.powi(2),
            Last(_) => self.value = value,
            Until(..) | Of(_) => {}
        }
    }

    /// Takes `value` if it is `beyond` the one before, or is NaN. A NaN is never replaced.
    fn extreme(&mut self, value: f64, t: f64, beyond: bool) {
        if beyond || (value.is_nan() && !self.value.is_nan()) {
            (self.value, self.time) = (value, t);
        }
    }
}

impl Fold {
    /// The value of a step; none if it is missing, or not made of single steps.
    fn read(&self, m: &Moment) -> Option<f64> {
        match self {
            Peak(read) | Mean(read) | Rms(read) | Last(read) => Some(read(m)),
            Least(read) | Most(read) => read(m),
            Time(holds) | Count(holds) => Some(f64::from(u8::from(holds(m)))),
            Until(..) | Of(_) => None,
        }
    }
}

/// The figures of the steps so far.
pub struct Tally<'a> {
    experiment: &'a Experiment,
    /// The part that is looked at; the whole flight if none.
    segment: Option<Phases>,
    /// In the order of [`FIGURES`]; `None` for a figure that is not asked for.
    states: Vec<Option<State>>,
    course: Vec<Point>,
    /// The values of the figures of phases, step by step.
    phased: Vec<Option<f64>>,
    in_plane: bool,
}

impl<'a> Tally<'a> {
    /// No steps so far.
    pub fn new(experiment: &'a Experiment) -> Self {
        Self::within(experiment, None, |_| true)
    }

    /// No steps so far of a flight, or of a segment, of which the figures that are `wanted` are asked for.
    fn within(
        experiment: &'a Experiment,
        segment: Option<Phases>,
        wanted: impl Fn(&'static str) -> bool,
    ) -> Self {
        let start = |figure: &Figure| wanted(figure.name).then_some(State::NONE);
        Self {
            experiment,
            segment,
            states: FIGURES.iter().map(start).collect(),
            course: Vec::new(),
            phased: Vec::new(),
            in_plane: true,
        }
    }

    /// What is known of the phases before the flight has been flown.
    fn known(&self) -> Phases {
        let end = self.experiment.duration_s;
        self.segment.unwrap_or(Phases {
            settled: self.experiment.settle_time_s,
            ..Phases::segment(0.0, end)
        })
    }

    /// One step more.
    pub fn add(&mut self, step: &Step) {
        let m = &Moment::new(self.experiment, step);
        let known = self.known();
        self.in_plane &= step.in_plane();
        self.course.push(Point {
            t: step.t,
            asked: step.asked_speed,
            reference: step.target.velocity,
            velocity: step.truth.velocity,
        });
        for (figure, state) in FIGURES.iter().zip(&mut self.states) {
            let Some(state) = state else { continue };
            // What is parked is not flown. Where it is at the end is looked at all the same.
            let at_end = figure.part == Part::Late || matches!(figure.fold, Last(_));
            if step.stands() && !at_end && !figure.part.is_phase() {
                continue;
            }
            if figure.part.is_phase() {
                self.phased.push(figure.fold.read(m));
            } else if known.has(figure.part, step.t)
                && let Some(value) = figure.fold.read(m)
            {
                state.add(&figure.fold, value, step.t);
            }
        }
    }

    /// The figures; NaN in the place of one that is not asked for.
    pub fn figures(&self) -> Figures {
        let known = self.known();
        let found = || Phases::of(&self.course, known.settled, known.end);
        let phases = self.segment.unwrap_or_else(found);
        let mut states = self.states.clone();
        let wanted = FIGURES.iter().zip(&mut states);
        let mut phased: Vec<(&Figure, &mut State)> = wanted
            .filter(|(figure, _)| figure.part.is_phase())
            .filter_map(|(figure, state)| Some((figure, state.as_mut()?)))
            .collect();
        let width = phased.len().max(1);
        for (point, values) in self.course.iter().zip(self.phased.chunks(width)) {
            for ((figure, state), value) in phased.iter_mut().zip(values) {
                if let Some(value) = value.filter(|_| phases.has(figure.part, point.t)) {
                    state.add(&figure.fold, value, point.t);
                }
            }
        }
        let time = |state: &Option<State>| state.map_or(f64::NAN, |state| state.time);
        let mut figures = Figures {
            values: Vec::with_capacity(FIGURES.len()),
            times: states.iter().map(time).collect(),
        };
        for (figure, state) in FIGURES.iter().zip(&states) {
            let value = match (state, &figure.fold) {
                (None, _) => f64::NAN,
                (Some(_), Of(of)) => of(&figures),
                (Some(_), &Until(error, limit)) => self.until(&phases, error, limit),
                (Some(_), _) if figure.part == Part::Plane && !self.in_plane => f64::NAN,
                // Nothing can be said of no values.
                (Some(state), _) if state.count == 0 => f64::NAN,
                (Some(state), Mean(_)) => state.value / f64::from(state.count),
                (Some(state), Rms(_)) => (state.value / f64::from(state.count)).sqrt(),
                (Some(state), Time(_)) => state.value / self.experiment.control_rate_hz,
                (Some(state), _) => state.value,
            };
            figures.values.push(value);
        }
        figures
    }

    /// What [`Fold::Until`] says.
    fn until(&self, phases: &Phases, error: fn(&Phases, &Point) -> f64, limit: f64) -> f64 {
        let before = self.course.iter().rev();
        let mut before = before.skip_while(|point| point.t >= phases.cruise[1]);
        let last = before.find(|point| {
            let error = error(phases, point);
            error.is_nan() || error >= limit
        });
        match last {
            None => 0.0,
            Some(last) if phases.late_cruise().contains(&last.t) => f64::NAN,
            Some(last) => last.t - phases.start,
        }
    }
}

/// A figure that does not keep its bound, or has no value to be judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond<'a> {
    /// Its name.
    pub figure: &'a str,
    /// What it is; NaN without a value.
    pub value: f64,
    /// The most that it may be.
    pub bound: f64,
}

/// The figures of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// In the order of [`FIGURES`].
    pub values: Vec<f64>,
    /// Where the extremes lie \[s\].
    times: Vec<f64>,
}

impl Serialize for Figures {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.json().serialize(serializer)
    }
}

/// What an error says of a name that no figure has.
pub fn unknown(name: &str) -> String {
    format!("{name} is not the name of a figure{}", named_now(name))
}

/// What an error adds to a name that was perhaps a figure's, or is nearly one.
pub fn named_now(name: &str) -> String {
    let names: Vec<&str> = FIGURES.iter().map(|figure| figure.name).collect();
    hint(name, &names)
}

/// Place of a figure in [`FIGURES`].
pub fn index(name: &str) -> Option<usize> {
    FIGURES.iter().position(|figure| figure.name == name)
}

/// The figure of this name in words, with its unit, as tables have it; the name itself if there is none.
pub fn words(name: &str) -> String {
    match index(name).map(|i| &FIGURES[i]) {
        Some(figure) if matches!(figure.unit, "" | "flag") => figure.label.to_owned(),
        Some(figure) => format!("{} [{}]", figure.label, figure.unit),
        None => name.to_owned(),
    }
}

impl Figures {
    /// The figures of a record.
    pub fn of(experiment: &Experiment, record: &[Step]) -> Self {
        let mut tally = Tally::new(experiment);
        record.iter().for_each(|step| tally.add(step));
        tally.figures()
    }

    /// The figure of this name, which must be one; or the time of an extreme.
    pub fn get(&self, name: &str) -> f64 {
        if let Some(i) = index(name) {
            return self.values[i];
        }
        let timed = FIGURES.iter().position(|f| f.when == Some(name));
        self.times[timed.expect("a figure")]
    }

    /// Where the extreme of a figure lies \[s\], if it has one.
    pub fn when(&self, name: &str) -> Option<f64> {
        let figure = &FIGURES[index(name)?];
        figure
            .when
            .map(|when| self.get(when))
            .filter(|t| t.is_finite())
    }

    /// The figures as a JSON object.
    pub fn json(&self) -> Map<String, Value> {
        let mut map = Map::new();
        for (i, figure) in FIGURES.iter().enumerate() {
            let value = self.values[i];
            let json = match figure.unit {
                "flag" => Value::from(value != 0.0),
                "steps" => Value::from(value as u64),
                _ => Value::from(value),
            };
            map.insert(figure.name.to_owned(), json);
            if let Some(name) = figure.when {
                map.insert(name.to_owned(), Value::from(self.times[i]));
            }
        }
        map
    }

    /// The bounds of `experiment` that are not kept, or not judged.
    pub fn beyond<'a>(&self, experiment: &'a Experiment) -> Vec<Beyond<'a>> {
        let bounds = experiment.bounds.iter();
        let all = bounds.map(|(name, &bound)| Beyond {
            figure: name,
            value: self.get(name),
            bound,
        });
        // A NaN keeps no bound.
        all.filter(|b| b.value.is_nan() || b.value > b.bound)
            .collect()
    }

    /// Label, value with unit, and where an extreme lies its time, or the bound if there is one: one line of the table each. Figures of parts of
    /// the flight, and those that are 0 or have no value, are left out if they have no bound.
    pub fn table(&self, experiment: &Experiment) -> Vec<[String; 3]> {
        let mut lines = Vec::new();
        for (i, figure) in FIGURES.iter().enumerate() {
            let value = self.values[i];
            let bound = experiment.bounds.get(figure.name);
            let whole = matches!(figure.part, Part::Flight | Part::Plane | Part::Settled);
            let alone = matches!(figure.fold, Until(..)) || !whole;
            let optional = !matches!(figure.fold, Last(_));
            let nothing = value.is_nan() || (optional && value == 0.0);
            if bound.is_none() && (alone || nothing) {
                continue;
            }
            let number = match (figure.unit, value) {
                (_, value) if value.is_nan() => "none".to_owned(),
                ("flag", value) => if value == 0.0 { "no" } else { "yes" }.to_owned(),
                _ => format!("{} {}", fixed(value, figure.digits), figure.unit),
            };
            let note = match (bound, figure.when) {
                (Some(bound), _) => {
                    let kept = match value {
                        _ if value.is_nan() => ": not judged",
                        _ if value <= *bound => "",
                        _ => ": not kept",
                    };
                    format!("at most {bound}{kept}")
                }
                (None, Some(_)) if self.times[i].is_finite() => {
                    format!("at {:.3} s", self.times[i])
                }
                _ => String::new(),
            };
            lines.push([
                figure.label.to_owned(),
                number.trim_end().replace(" °", "°"),
                note,
            ]);
        }
        lines
    }
}

/// A number with this many digits after the point, and no sign if nothing but zeros is left of it.
pub fn fixed(value: f64, digits: usize) -> String {
    let number = format!("{value:.digits$}");
    match number.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_owned(),
        _ => number,
    }
}

/// The figures along one segment of the path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Segment {
    /// Beginning \[s\].
    pub from_s: f64,
    /// End \[s\].
    pub to_s: f64,
    /// Least altitude over the reference \[m\].
    pub altitude_least_m: f64,
    /// Greatest altitude over the reference \[m\].
    pub altitude_most_m: f64,
    /// Least forward position over the reference \[m\].
    pub forward_least_m: f64,
    /// Greatest forward position over the reference \[m\].
    pub forward_most_m: f64,
    /// Largest |v − v_r| \[m/s\].
    pub max_velocity_error_m_s: f64,
    /// If the reference is constant for longer than 5 s.
    pub steady: Option<Steady>,
}

/// The figures along a segment of constant reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Steady {
    /// Time from the beginning until |v − v_r| stays under 0.05 m/s \[s\]; none if it does not.
    pub settling_s: Option<f64>,
    /// Largest |v − v_r| in the last 5 s \[m/s\].
    pub max_late_velocity_error_m_s: f64,
    /// Root mean square of ω in the last 5 s \[rad/s\].
    pub late_rate_rms_rad_s: f64,
}

/// The figures of a segment.
const SEGMENT: [&str; 8] = [
    "altitude_least_m",
    "altitude_most_m",
    "forward_least_m",
    "forward_most_m",
    "max_velocity_error_m_s",
    "settling_s",
    "max_late_velocity_error_m_s",
    "late_rate_rms_rad_s",
];

impl Segment {
    /// The segments of a flight that stays in the vertical plane, between the times at which its path has a knot or a leg ends; of any other none.
    pub fn of(experiment: &Experiment, record: &[Step]) -> Vec<Self> {
        if !record.iter().all(Step::in_plane) {
            return Vec::new();
        }
        let breaks = experiment.path.breaks(experiment.duration_s);
        let segment = |ends: &[f64]| {
            let (from, to) = (ends[0], ends[1]);
            let wanted = |name: &str| SEGMENT.contains(&name);
            let part = Some(Phases::segment(from, to));
            let mut tally = Tally::within(experiment, part, wanted);
            let inside = record.iter().filter(|step| (from..to).contains(&step.t));
            let steps = inside.clone().map(|step| tally.add(step)).count();
            let figures = tally.figures();
            let constant = |step: &Step| step.target.acceleration.norm() == 0.0;
            let is_steady = inside.clone().next().is_some_and(constant) && to - from > LATE;
            // A flight that ended before has nothing to say of it.
            (steps > 0).then(|| Self {
                from_s: from,
                to_s: to,
                altitude_least_m: figures.get("altitude_least_m"),
                altitude_most_m: figures.get("altitude_most_m"),
                forward_least_m: figures.get("forward_least_m"),
                forward_most_m: figures.get("forward_most_m"),
                max_velocity_error_m_s: figures.get("max_velocity_error_m_s"),
                steady: is_steady.then(|| Steady {
                    settling_s: Some(figures.get("settling_s")).filter(|t| t.is_finite()),
                    max_late_velocity_error_m_s: figures.get("max_late_velocity_error_m_s"),
                    late_rate_rms_rad_s: figures.get("late_rate_rms_rad_s"),
                }),
            })
        };
        breaks.windows(2).filter_map(segment).collect()
    }

    /// One line of the table of segments.
    pub fn line(&self) -> String {
        // Rounded, and no zero with a minus.
        let metres = |x: f64| (x * 100.0).round() / 100.0 + 0.0;
        let mut line = format!(
            "{:6.1}–{:<6.1} altitude {:+6.2} to {:+6.2} m, forward {:+7.2} to {:+7.2} m",
            self.from_s,
            self.to_s,
            metres(self.altitude_least_m),
            metres(self.altitude_most_m),
            metres(self.forward_least_m),
            metres(self.forward_most_m)
        );
        if let Some(steady) = &self.steady {
            let settling = match steady.settling_s {
                Some(t) => format!("{t:.1} s to settle"),
                None => "not settled".to_owned(),
            };
            line += &format!(
                "; last 5 s: {:.4} m/s, {:.5} rad/s; {settling}",
                steady.max_late_velocity_error_m_s, steady.late_rate_rms_rad_s
            );
        }
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controllers::Report;
    use crate::experiment::Document;
    use crate::simulate::{fly, shown};

    fn experiment(name: &str) -> Experiment {
        Document::load(name).unwrap().checked().unwrap()
    }

    /// Before a take-off and after a landing nothing is flown: the time there is none of safe commands, and pages leave it out but for 5 s.
    #[test]
    fn time_on_the_ground_is_not_flown() {
        let mut document = Document::load("inspection").unwrap();
        document.assign("mission.armed_s=3.0").unwrap();
        let experiment = document.checked().unwrap();
        let record = fly(&experiment).unwrap();
        let figures = Figures::of(&experiment, &record);
        assert!(figures.get("safe_s") < 1.0, "{figures:?}");
        assert!(figures.get("max_late_position_error_m") < 1.0);
        assert_eq!(figures.get("final_thrust_to_weight"), 0.0);
        let all = shown(&record);
        let landed = record.iter().rposition(|step| !step.stands()).unwrap();
        let after = all[all.len() - 1].t - record[landed].t;
        assert!((after - 5.0).abs() < 0.02, "{after}");
        assert!(record[0].stands() && all.len() < record.len());
        // One that falls with its motors off does not stand.
        let mut falling = record[0].clone();
        falling.truth.velocity.z = 1.0;
        assert!(!falling.stands());
        assert_eq!(shown(&record[..100]).len(), 100);
    }

    #[test]
    fn zero_has_no_sign() {
        for (value, text) in [
            (-0.004, "0.00"),
            (-0.006, "-0.01"),
            (-0.0, "0.00"),
            (2.5, "2.50"),
        ] {
            assert_eq!(fixed(value, 2), text);
        }
        assert_eq!(fixed(f64::NAN, 1), "NaN");
    }

    #[test]
    fn names_are_unique() {
        for (i, figure) in FIGURES.iter().enumerate() {
            assert_eq!(index(figure.name), Some(i));
        }
    }

    /// The README's table of figures is this one.
    #[test]
    fn the_readme_lists_every_figure() {
        let readme = include_str!("../../README.md");
        for figure in FIGURES {
            let line = format!(
                "| `{}` | {} | {} |",
                figure.name, figure.unit, figure.meaning
            );
            assert!(readme.contains(&line), "README.md lacks the line {line}");
        }
    }

    /// Start, cruise and the way back of a speed that is asked for at 100 Hz up to `end` \[s\].
    fn phases(end: f64, speed: impl Fn(f64) -> f64) -> (f64, [f64; 2], f64) {
        let point = |n: u32| {
            let t = f64::from(n) / 100.0;
            Point {
                t,
                asked: speed(t),
                reference: V3::zeros(),
                velocity: V3::zeros(),
            }
        };
        let course: Vec<Point> = (0..=(end * 100.0).round() as u32).map(point).collect();
        let phases = Phases::of(&course, 0.0, end);
        (phases.start, phases.cruise, phases.back)
    }

    /// `f` that goes from `a` to `b`, linearly from the time `from` to `to`.
    fn ramp(t: f64, [from, to]: [f64; 2], [a, b]: [f64; 2]) -> f64 {
        a + (b - a) * ((t - from) / (to - from)).clamp(0.0, 1.0)
    }

    #[test]
    fn phases_are_read_from_the_speed_asked_for() {
        let trip = |t| ramp(t, [5.0, 15.0], [0.0, 20.0]) + ramp(t, [45.0, 55.0], [0.0, -20.0]);
        assert_eq!(phases(60.0, trip), (5.0, [15.0, 45.0], 45.0));
        // What ends in cruise slows down nowhere; what stands still is in cruise where it stands.
        assert_eq!(phases(40.0, trip), (5.0, [15.0, 40.0], 40.0));
        assert_eq!(phases(9.0, |_| 0.0), (0.0, [0.0, 9.0], 9.0));
        assert_eq!(
            phases(9.0, |t| ramp(t, [0.0, 9.0], [1.0, 9.0])).1,
            [9.0, 9.0]
        );
        // A climb on the way, that adds a little to the speed and takes it off again, is neither a faster cruise nor the way back, and neither is a
        // constant speed with the errors of single precision.
        let climb = |t: f64| {
            trip(t) + 0.05 * ramp(t, [20.0, 30.0], [0.0, 1.0])
                - 0.05 * ramp(t, [30.0, 40.0], [0.0, 1.0])
        };
        assert_eq!(phases(60.0, climb), (5.0, [15.0, 45.0], 45.0));
        let rough = |t: f64| trip(t) + 1e-5 * (1e4 * t).sin();
        assert_eq!(phases(60.0, rough), (5.0, [15.0, 45.0], 45.0));
        // Of two cruises the faster, and of two as fast the first.
        let faster = |t| trip(t) + ramp(t, [30.0, 31.0], [0.0, 3.0]);
        assert_eq!(phases(60.0, faster), (5.0, [31.0, 45.0], 45.0));
        let dip =
            |t| trip(t) - ramp(t, [20.0, 21.0], [0.0, 3.0]) + ramp(t, [25.0, 26.0], [0.0, 3.0]);
        assert_eq!(phases(60.0, dip), (5.0, [15.0, 20.0], 20.0));
    }

    /// Figures and segments of the round trip with another path.
    fn round_trip_along(assignments: &[&str]) -> (Figures, Vec<Segment>) {
        let mut document = Document::load("round-trip").unwrap();
        for assignment in assignments {
            document.assign(assignment).unwrap();
        }
        let experiment = document.checked().unwrap();
        let record = fly(&experiment).unwrap();
        (
            Figures::of(&experiment, &record),
            Segment::of(&experiment, &record),
        )
    }

    /// One flight has one set of figures, however it is written: by knots, by legs, and by knots to the east, of which those of phases are the same.
    #[test]
    fn a_flight_has_the_same_figures_however_it_is_written() {
        let (knots, segments) = round_trip_along(&[]);
        let (legs, same) = round_trip_along(&["path = { legs = [{ lasts_s = 5 }, \
            { lasts_s = 10, speed_m_s = 20 }, { lasts_s = 30 }, { lasts_s = 10, speed_m_s = 0 }] }"]);
        for figure in FIGURES {
            let (a, b) = (knots.get(figure.name), legs.get(figure.name));
            assert!((a - b).abs() <= 1e-9 * a.abs(), "{}: {a} {b}", figure.name);
        }
        assert_eq!((segments.len(), same.len()), (5, 5));
        for (a, b) in segments.iter().zip(&same) {
            assert_eq!(a.line(), b.line());
        }
        let (east, none) = round_trip_along(&[
            "reference.knots = [{ t_s = 5, down_m_s = 0, forward_m_s = 0 }, \
            { t_s = 15, down_m_s = 0, forward_m_s = 0, east_m_s = 20 }, \
            { t_s = 45, down_m_s = 0, forward_m_s = 0, east_m_s = 20 }, \
            { t_s = 55, down_m_s = 0, forward_m_s = 0 }]",
            "initial.heading_deg = 90",
        ]);
        assert!(none.is_empty() && east.get("forward_most_m").is_nan());
        for figure in FIGURES.iter().filter(|figure| figure.part.is_phase()) {
            let (a, b) = (knots.get(figure.name), east.get(figure.name));
            // Single precision turned by 90°. What is ahead is so to the north.
            let same = (a - b).abs() < 1e-5;
            assert!(
                same || figure.name == "max_ahead_m",
                "{}: {a} {b}",
                figure.name
            );
        }
        let reached = |figures: &Figures| figures.get("cruise_after_s");
        assert_eq!(reached(&knots), reached(&east));
    }

    /// Figures of the round trip against folds over the record by hand.
    #[test]
    fn figures_are_folds_over_the_record() {
        let experiment = experiment("round-trip");
        let record = fly(&experiment).unwrap();
        let figures = Figures::of(&experiment, &record);
        let most = |of: &dyn Fn(&Step) -> f64, from: f64, to: f64| {
            let inside = record.iter().filter(|s| (from..to).contains(&s.t));
            inside.map(of).fold(f64::NEG_INFINITY, f64::max)
        };
        let altitude = Step::altitude;
        let error = |s: &Step| s.velocity_error().norm();
        assert_eq!(figures.get("max_gain_out_m"), most(&altitude, 0.0, 45.0));
        assert_eq!(figures.get("max_gain_back_m"), most(&altitude, 45.0, 200.0));
        assert_eq!(figures.get("altitude_most_m"), most(&altitude, 0.0, 200.0));
        assert_eq!(
            figures.get("max_cruise_error_m_s"),
            most(&error, 40.0, 45.0)
        );
        assert_eq!(
            figures.get("max_late_velocity_error_m_s"),
            most(&error, 110.0, 200.0)
        );
        let worst = figures.get("max_velocity_error_m_s");
        let at = figures.get("max_velocity_error_time_s");
        assert!(record.iter().any(|s| s.t == at && error(s) == worst));
        // The reference needs 10 s.
        assert!((9.0..14.0).contains(&figures.get("cruise_after_s")));
        assert_eq!(figures.get("lost"), 0.0);
        let low = |s: &&Step| flag_of(s, Status::THRUST_LOW);
        let steps = record.iter().filter(low).count();
        assert!((figures.get("thrust_low_s") - 0.01 * steps as f64).abs() < 1e-9);
        let segments = Segment::of(&experiment, &record);
        assert_eq!(segments.len(), 5);
        assert_eq!(segments[1].altitude_most_m, most(&altitude, 5.0, 15.0));
        assert!(segments[1].steady.is_none() && segments[2].steady.is_some());
    }

    fn flag_of(step: &Step, flag: Status) -> bool {
        step.answer
            .guided()
            .is_some_and(|g| g.status.contains(flag))
    }

    /// One NaN makes every figure of that quantity NaN, and the flight lost. An extreme without any value is NaN, a time without any step 0.
    #[test]
    fn a_nan_stays_and_is_null() {
        let experiment = experiment("round-trip");
        let mut record = fly(&experiment).unwrap();
        record.truncate(200);
        record[100].truth.position.z = f64::NAN;
        let figures = Figures::of(&experiment, &record);
        for name in ["altitude_least_m", "altitude_most_m", "max_gain_out_m"] {
            assert!(figures.get(name).is_nan(), "{name}");
        }
        assert!(figures.get("forward_most_m").is_finite());
        assert_eq!(figures.get("lost"), 1.0);
        let json = figures.json();
        assert!(json["altitude_least_m"].is_null() && json["lost"] == true);
        for step in &mut record {
            step.answer.report = Report::Outside;
        }
        let outside = Figures::of(&experiment, &record);
        assert!(outside.get("min_fp_n").is_nan() && outside.get("safe_s") == 0.0);
    }
}
