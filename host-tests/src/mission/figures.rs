//! Figures of merit of a mission: over all of it, and over each segment of its reference.

use alula::Guided;
use alula::control::{Mode, Status};
use serde::Serialize;

use super::Mission;
use super::flight::Row;

/// Length of the end of a steady segment that counts as settled \[s\].
const LATE: f64 = 5.0;
/// Velocity error below which a flight counts as settled \[m/s\].
const SETTLED: f64 = 0.05;

/// Figures of a mission.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Largest of the true and the commanded |ω| \[rad/s\].
    pub peak_rate_rad_s: f64,
    /// Least and greatest altitude over the reference \[m\].
    pub altitude_m: [f64; 2],
    /// Least and greatest forward position over the reference \[m\].
    pub forward_m: [f64; 2],
    /// Largest |v − v_r| \[m/s\].
    pub max_velocity_error_m_s: f64,
    /// |v − v_r| at the end \[m/s\].
    pub final_velocity_error_m_s: f64,
    /// Time in each mode \[s\].
    pub safe_s: f64,
    /// Time of holding \[s\].
    pub holding_s: f64,
    /// Time with thrust at its lower limit \[s\].
    pub thrust_low_s: f64,
    /// Time with thrust at its upper limit \[s\].
    pub thrust_high_s: f64,
    /// Time in which the flown branch needed negative thrust \[s\].
    pub negative_thrust_s: f64,
    /// Time on the branch θ̃ = π \[s\].
    pub opposed_s: f64,
    /// The reference's segments, between its knots.
    pub segments: Vec<Segment>,
}

/// Figures of the flight along one segment of the reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Segment {
    /// Beginning \[s\].
    pub from_s: f64,
    /// End \[s\].
    pub to_s: f64,
    /// Least and greatest altitude over the reference \[m\].
    pub altitude_m: [f64; 2],
    /// Least and greatest forward position over the reference \[m\].
    pub forward_m: [f64; 2],
    /// Largest |v − v_r| \[m/s\].
    pub max_velocity_error_m_s: f64,
    /// If the reference is constant for longer than 5 s.
    pub steady: Option<Steady>,
}

/// Figures of a segment with constant reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Steady {
    /// Time from the beginning until |v − v_r| stays under 0.05 m/s \[s\]; none if it does not.
    pub settling_s: Option<f64>,
    /// Largest |v − v_r| in the last 5 s \[m/s\].
    pub late_velocity_error_m_s: f64,
    /// Root mean square of ω in the last 5 s \[rad/s\].
    pub late_rate_rms_rad_s: f64,
}

fn widen(range: &mut [f64; 2], value: f64) {
    *range = [range[0].min(value), range[1].max(value)];
}

const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl Figures {
    /// The figures of `rows`, at least one, flown in `mission`.
    pub fn of(mission: &Mission, rows: &[Row]) -> Self {
        let period = 1.0 / mission.control_rate_hz;
        let time = |holds: &dyn Fn(&Row) -> bool| {
            period * rows.iter().filter(|row| holds(row)).count() as f64
        };
        let guided =
            |holds: &dyn Fn(&Guided) -> bool| time(&|row| row.answer.guided().is_some_and(holds));
        let flag = |flag: Status| guided(&|g| g.status.contains(flag));
        let breaks = mission.reference.breaks(mission.duration_s);
        let whole = Segment::of(mission, rows, 0.0, mission.duration_s);
        let rate = |row: &Row| row.truth.rate.abs().max(row.answer.rate.abs());
        Self {
            peak_rate_rad_s: rows.iter().map(rate).fold(0.0, f64::max),
            altitude_m: whole.altitude_m,
            forward_m: whole.forward_m,
            max_velocity_error_m_s: whole.max_velocity_error_m_s,
            final_velocity_error_m_s: rows[rows.len() - 1].velocity_error().norm(),
            safe_s: guided(&|g| g.mode == Mode::Safe),
            holding_s: guided(&|g| g.mode == Mode::Holding),
            thrust_low_s: flag(Status::THRUST_LOW),
            thrust_high_s: flag(Status::THRUST_HIGH),
            negative_thrust_s: flag(Status::NEGATIVE_THRUST),
            opposed_s: flag(Status::OPPOSED),
            segments: breaks
                .windows(2)
                .map(|ends| Segment::of(mission, rows, ends[0], ends[1]))
                .collect(),
        }
    }

    /// Label and value of the figures of the whole mission.
    pub fn table(&self) -> Vec<[String; 2]> {
        let line = |label: &str, value: String| [label.to_owned(), value];
        let range = |r: [f64; 2]| format!("{:+.2} to {:+.2} m", r[0], r[1]);
        let time = |t: f64| format!("{t:.2} s");
        vec![
            line(
                "largest angular rate",
                format!("{:.3} rad/s", self.peak_rate_rad_s),
            ),
            line("altitude over the reference", range(self.altitude_m)),
            line("forward of the reference", range(self.forward_m)),
            line(
                "largest velocity error",
                format!("{:.3} m/s", self.max_velocity_error_m_s),
            ),
            line(
                "final velocity error",
                format!("{:.4} m/s", self.final_velocity_error_m_s),
            ),
            line("thrust at its lower limit", time(self.thrust_low_s)),
            line("thrust at its upper limit", time(self.thrust_high_s)),
            line("negative thrust needed", time(self.negative_thrust_s)),
            line("on the branch θ̃ = π", time(self.opposed_s)),
            line("holding the last command", time(self.holding_s)),
            line("safe command", time(self.safe_s)),
        ]
    }
}

impl Segment {
    fn of(mission: &Mission, rows: &[Row], from: f64, to: f64) -> Self {
        let (mut altitude, mut forward) = (NOWHERE, NOWHERE);
        let (mut error, mut late_error, mut squares, mut late) = (0.0_f64, 0.0_f64, 0.0, 0_u32);
        let mut unsettled = from;
        for row in rows.iter().filter(|row| (from..to).contains(&row.t)) {
            let offset = row.position_error();
            widen(&mut altitude, -offset.x);
            widen(&mut forward, offset.y);
            let now = row.velocity_error().norm();
            // A NaN is no small error.
            error = if now > error || now.is_nan() {
                now
            } else {
                error
            };
            if now.is_nan() || now >= SETTLED {
                unsettled = row.t;
            }
            if row.t >= to - LATE {
                late_error = late_error.max(now);
                squares += row.truth.rate * row.truth.rate;
                late += 1;
            }
        }
        let (_, slope) = mission.reference.at(from);
        let steady = slope.norm() == 0.0 && to - from > LATE && late > 0;
        Self {
            from_s: from,
            to_s: to,
            altitude_m: altitude,
            forward_m: forward,
            max_velocity_error_m_s: error,
            steady: steady.then(|| Steady {
                settling_s: (unsettled < to - LATE).then_some(unsettled - from),
                late_velocity_error_m_s: late_error,
                late_rate_rms_rad_s: (squares / f64::from(late)).sqrt(),
            }),
        }
    }

    /// One line of the table of segments.
    pub fn line(&self) -> String {
        let mut line = format!(
            "{:6.1}–{:<6.1} altitude {:+6.2} to {:+6.2} m, forward {:+7.2} to {:+7.2} m",
            self.from_s,
            self.to_s,
            self.altitude_m[0],
            self.altitude_m[1],
            self.forward_m[0],
            self.forward_m[1]
        );
        if let Some(steady) = &self.steady {
            let settling = match steady.settling_s {
                Some(t) => format!("{t:.1} s to settle"),
                None => "not settled".to_owned(),
            };
            line += &format!(
                "; last 5 s: {:.4} m/s, {:.5} rad/s; {settling}",
                steady.late_velocity_error_m_s, steady.late_rate_rms_rad_s
            );
        }
        line
    }
}
