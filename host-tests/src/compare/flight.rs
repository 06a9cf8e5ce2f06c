//! The figures of one flight of a comparison.

use serde::Serialize;

use crate::mission::{Mission, Row, fly};

/// Sinking further below the reference than this is a departure \[m\].
pub const LOST: f64 = 50.0;
/// So is a mean velocity error above this over the last 5 s \[m/s\].
pub const ASTRAY: f64 = 3.0;
/// Ending further than this from the reference altitude, without a departure, is straying \[m\].
pub const FAR: f64 = 10.0;
/// Root mean square of ω above which late steady flight oscillates \[rad/s\].
pub const OSCILLATION: f64 = 0.6;
/// Velocity error below which cruise is reached \[m/s\].
pub const REACHED: f64 = 1.0;
/// Length of the end of a steady phase that counts as late \[s\].
pub const LATE: f64 = 5.0;

/// How a flight went, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Flown to the end.
    Flies,
    /// Oscillates in steady flight: ω above 0.6 rad/s root mean square in the last 5 s of cruise or of the flight.
    Oscillates,
    /// Ends more than 10 m from the reference altitude.
    Strays,
    /// Sinks by more than 50 m below the reference, or ends with a mean velocity error of more than 3 m/s.
    Departs,
}

/// Figures of a flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flight {
    /// Seed of the mission.
    pub seed: u64,
    /// How it went.
    pub outcome: Outcome,
    /// Least and greatest altitude over the reference until the reference slows down \[m\].
    pub out_m: [f64; 2],
    /// The same from then on \[m\].
    pub back_m: [f64; 2],
    /// From the reference's start until |v − v_r| to the cruise velocity stays under 1 m/s to the end of cruise \[s\].
    pub cruise_after_s: Option<f64>,
    /// Largest |v − v_r| in the last 5 s of cruise \[m/s\].
    pub cruise_error_m_s: f64,
    /// Largest |v − v_r| in the last 5 s of the flight \[m/s\].
    pub end_error_m_s: f64,
    /// Root mean square of ω in the last 5 s of cruise or of the flight, the greater \[rad/s\].
    pub late_rate_rms_rad_s: f64,
    /// Largest of the true and the commanded |ω| \[rad/s\].
    pub peak_rate_rad_s: f64,
    /// Farthest ahead of the reference from where it slows down on \[m\].
    pub ahead_m: f64,
}

/// What is drawn of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time \[s\].
    pub t: f64,
    /// Altitude over the reference \[m\].
    pub altitude: f64,
    /// Forward velocity \[m/s\].
    pub speed: f64,
    /// Forward velocity of the reference \[m/s\].
    pub reference: f64,
}

/// Every how many control steps a flight is sampled for the charts.
const SAMPLING: usize = 10;

/// The phases of a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Phases {
    /// When it begins to change \[s\].
    start: f64,
    /// Its fastest steady phase, the first of them \[s\].
    cruise: [f64; 2],
    /// When it slows down for the first time \[s\].
    back: f64,
}

impl Phases {
    fn of(mission: &Mission) -> Self {
        let end = mission.duration_s;
        let breaks = mission.reference.breaks(end);
        let speed = |t: f64| mission.reference.at(t).0.norm();
        let steady = |ends: &&[f64]| mission.reference.at(ends[0]).1.norm() == 0.0;
        let mut cruise = [end, end];
        let mut fastest = 0.0;
        for ends in breaks.windows(2).filter(steady) {
            if speed(ends[0]) > fastest {
                fastest = speed(ends[0]);
                cruise = [ends[0], ends[1]];
            }
        }
        let first = |holds: &dyn Fn(&[f64]) -> bool| {
            breaks.windows(2).find(|ends| holds(ends)).map(|e| e[0])
        };
        Self {
            start: first(&|e| speed(e[1]) != speed(e[0])).unwrap_or(0.0),
            cruise,
            back: first(&|e| speed(e[1]) < speed(e[0]) - 1e-9).unwrap_or(end),
        }
    }
}

impl Flight {
    /// Flies `mission`: its figures, and samples of it.
    pub fn of(mission: &Mission) -> (Self, Vec<Sample>) {
        let mut rows = Vec::with_capacity(mission.steps() + 1);
        fly(mission, |row| {
            rows.push(*row);
            // Beyond a fall of 1 km or a number that is none there is nothing to learn.
            row.position_error().x < 1000.0
        });
        let samples = rows.iter().step_by(SAMPLING).map(|row| Sample {
            t: row.t,
            altitude: -row.position_error().x,
            speed: row.truth.velocity.y,
            reference: row.reference_velocity.y,
        });
        (Self::figures(mission, &rows), samples.collect())
    }

    fn figures(mission: &Mission, rows: &[Row]) -> Self {
        let phases = Phases::of(mission);
        let error = |row: &Row| row.velocity_error().norm();
        let within = |from: f64, to: f64| rows.iter().filter(move |r| (from..to).contains(&r.t));
        let altitude = |from: f64, to: f64| {
            within(from, to).fold([0.0_f64; 2], |[low, high], row| {
                let h = -row.position_error().x;
                [low.min(h), high.max(h)]
            })
        };
        let end = mission.duration_s + 1.0;
        let worst = |from, to| within(from, to).map(error).fold(0.0, f64::max);
        let swing = |from, to| {
            let (sum, n) = within(from, to).fold((0.0, 0_u32), |(sum, n), row| {
                (sum + row.truth.rate.powi(2), n + 1)
            });
            (sum / f64::from(n.max(1))).sqrt()
        };
        let late_cruise = (
            phases.cruise[0].max(phases.cruise[1] - LATE),
            phases.cruise[1],
        );
        let late = (mission.duration_s - LATE, end);
        let reached = {
            let off = |row: &&Row| error(row) >= REACHED;
            let last = within(phases.cruise[0], phases.cruise[1]).rfind(off);
            let last = last.map(|row| row.t);
            match last {
                Some(t) if t >= late_cruise.0 => None,
                Some(t) => Some(t - phases.start),
                // Before the reference itself has got there: since the error to the cruise velocity is small.
                None => {
                    let target = mission.reference.at(phases.cruise[0]).0;
                    let off = |r: &&Row| (r.truth.velocity - target).norm() >= REACHED;
                    let last = within(0.0, phases.cruise[0]).rfind(off);
                    Some(last.map_or(0.0, |row| row.t - phases.start))
                }
            }
        };
        let lowest = altitude(0.0, end)[0];
        let n = within(late.0, late.1).count().max(1) as f64;
        let mean = within(late.0, late.1).map(error).sum::<f64>() / n;
        let last = rows.last().expect("a flight has a row");
        let whole = last.t >= mission.duration_s - 1e-6;
        let swings = swing(late_cruise.0, late_cruise.1).max(swing(late.0, late.1));
        let outcome = if !whole || lowest < -LOST || !mean.is_finite() || mean > ASTRAY {
            Outcome::Departs
        } else if last.position_error().x.abs() > FAR {
            Outcome::Strays
        } else if swings > OSCILLATION {
            Outcome::Oscillates
        } else {
            Outcome::Flies
        };
        let rate = |row: &Row| row.truth.rate.abs().max(row.answer.rate.abs());
        let ahead = within(phases.back, end).map(|row| row.position_error().y);
        Self {
            seed: mission.seed,
            outcome,
            out_m: altitude(0.0, phases.back),
            back_m: altitude(phases.back, end),
            cruise_after_s: reached.filter(|_| outcome != Outcome::Departs),
            cruise_error_m_s: worst(late_cruise.0, late_cruise.1),
            end_error_m_s: worst(late.0, late.1),
            late_rate_rms_rad_s: swings,
            peak_rate_rad_s: rows.iter().map(rate).fold(0.0, f64::max),
            ahead_m: ahead.fold(0.0, f64::max),
        }
    }

    /// Greatest distance from the reference altitude \[m\].
    pub fn altitude_m(&self) -> f64 {
        let [a, b] = self.out_m;
        let [c, d] = self.back_m;
        a.abs().max(b.abs()).max(c.abs()).max(d.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::MissionSource;

    #[test]
    fn phases_are_read_from_the_reference() {
        let mission = MissionSource::load("round-trip").unwrap().mission;
        let expected = Phases {
            start: 5.0,
            cruise: [15.0, 45.0],
            back: 45.0,
        };
        assert_eq!(Phases::of(&mission), expected);
        let descent = MissionSource::load("steep-descent").unwrap().mission;
        let phases = Phases::of(&descent);
        assert_eq!((phases.start, phases.back), (5.0, 31.0));
        assert_eq!(phases.cruise, [11.0, 31.0]);
    }

    /// The guidance's round trip, whose figures `Figures` gives independently.
    #[test]
    fn figures_are_those_of_the_mission() {
        let mission = MissionSource::load("round-trip").unwrap().mission;
        let (flight, samples) = Flight::of(&mission);
        let mut rows = Vec::new();
        fly(&mission, |row| {
            rows.push(*row);
            true
        });
        let figures = crate::mission::Figures::of(&mission, &rows);
        assert_eq!(flight.outcome, Outcome::Flies);
        let out = figures.segments[..3].iter().map(|s| s.altitude_m[1]);
        assert_eq!(flight.out_m[1], out.fold(0.0, f64::max));
        let steady = figures.segments[2].steady.as_ref().unwrap();
        assert_eq!(flight.cruise_error_m_s, steady.late_velocity_error_m_s);
        assert_eq!(flight.peak_rate_rad_s, figures.peak_rate_rad_s);
        assert!((flight.ahead_m - figures.forward_m[1]).abs() < 1e-9);
        // The reference needs 10 s.
        let after = flight.cruise_after_s.unwrap();
        assert!(after > 9.0 && after < 14.0, "{after}");
        assert_eq!(samples.len(), 1151);
    }

    #[test]
    fn a_fall_departs() {
        let mut mission = MissionSource::load("steep-descent").unwrap().mission;
        mission.controller.guidance_mut().unwrap().branch.switch = false;
        let (flight, _) = Flight::of(&mission);
        assert_eq!(
            (flight.outcome, flight.cruise_after_s),
            (Outcome::Departs, None)
        );
    }
}
