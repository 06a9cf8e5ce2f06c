//! What is asked of a vehicle's flights: of its first one, and of those of its campaign.
//!
//! Lengths are those of a round trip at 20 m/s and grow with the speed of cruise above that: so does the time that the reference takes, and the
//! way that an error of the same part of the speed makes.

use std::fmt::Write as _;

use serde::Serialize;

use super::{Facts, Performance};
use crate::figures::{Figures, LOST, REACHED};

/// Speed of the round trip that the lengths are those of [m/s].
const SPEED: f64 = 20.0;
/// Velocity [m/s] and position \[m\] within which a vehicle is back on its reference.
const BACK: [f64; 2] = [0.5, 5.0];

/// A length that is asked for.
struct Length {
    /// The figure of the first flight: how far to this side.
    first: &'static str,
    /// What it does who goes farther.
    text: &'static str,
    /// Asked of a calm flight by a controller that knows the vehicle \[m\].
    goal: f64,
    /// The figure of the campaign's flights, and whether its least value is meant.
    flown: (&'static str, bool),
    /// Asked of flights in wind and turbulence by one that does not quite \[m\].
    limit: f64,
}

const LENGTHS: [Length; 6] = [
    Length {
        first: "loss_out_m",
        text: "sinks below its reference on the way out",
        goal: 1.0,
        flown: ("altitude_least_m", true),
        limit: 10.0,
    },
    Length {
        first: "gain_out_m",
        text: "climbs above its reference on the way out",
        goal: 1.0,
        flown: ("altitude_most_m", false),
        limit: 10.0,
    },
    Length {
        first: "loss_back_m",
        text: "sinks below its reference on the way back",
        goal: 0.6,
        flown: ("altitude_least_m", true),
        limit: 10.0,
    },
    Length {
        first: "gain_back_m",
        text: "climbs above its reference on the way back",
        goal: 0.6,
        flown: ("altitude_most_m", false),
        limit: 10.0,
    },
    Length {
        first: "ahead_m",
        text: "runs ahead of its reference where that brakes",
        goal: 3.0,
        flown: ("ahead_m", false),
        limit: 15.0,
    },
    Length {
        first: "forward_least_m",
        text: "falls behind its reference",
        goal: 10.0,
        flown: ("forward_least_m", true),
        limit: 30.0,
    },
];

/// Shares of a campaign's flights: back on the reference, and within the lengths.
const SHARES: [f64; 2] = [0.98, 0.95];
/// Part of the speed of cruise by which it may be missed at its end: the wind drawn is as much.
const MISSED: f64 = 0.25;

/// How the lengths of a vehicle with this speed of cruise grow.
fn scale(facts: &Facts) -> f64 {
    f64::max(1.0, facts.cruise_m_s / SPEED)
}

/// What came of the first flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// It does what was asked.
    AsAsked,
    /// It goes there and comes back, but not as closely as was asked.
    OutsideGoals,
    /// It does not do what was asked.
    Fails,
}

/// The judgement of a first flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// What came of it.
    pub outcome: Outcome,
    /// Why it fails, and what is outside the goals, in words.
    pub findings: Vec<String>,
}

impl Verdict {
    /// Of the first flight of the vehicle of `facts`.
    pub fn of(facts: &Facts, performance: &Performance, flight: &Figures) -> Self {
        let (mut failures, mut outside) = (Vec::new(), Vec::new());
        let get = |name: &str| flight.get(name);
        let scale = scale(facts);
        // NaN fails: it is within nothing.
        let within = |value: f64, most: f64| value <= most;
        if !within(-get("altitude_least_m"), LOST) {
            failures.push(format!(
                "it is lost: more than {LOST} m below its reference"
            ));
        }
        let missed = get("cruise_error_m_s");
        if !within(missed, REACHED) {
            failures.push(format!(
                "it does not reach cruise: off by {missed:.1} m/s at its end, of {} m/s{}",
                facts.cruise_m_s,
                why_no_cruise(facts, performance)
            ));
        }
        let end = ["late_velocity_error_m_s", "late_position_error_m"].map(get);
        if !(within(end[0], BACK[0]) && within(end[1], BACK[1])) {
            failures.push(format!(
                "it does not come back to hover: {:.1} m/s and {:.0} m off its reference at the end",
                end[0], end[1]
            ));
        }
        for length in &LENGTHS {
            let value = get(length.first);
            let far = value.abs();
            let text = |most: f64| format!("it {} by {far:.2} m, of {most:.2} m", length.text);
            if !within(far, scale * length.limit) {
                failures.push(text(scale * length.limit));
            } else if !within(far, scale * length.goal) {
                outside.push(text(scale * length.goal));
            }
        }
        let outcome = match (failures.is_empty(), outside.is_empty()) {
            (false, _) => Outcome::Fails,
            (true, false) => Outcome::OutsideGoals,
            (true, true) => Outcome::AsAsked,
        };
        failures.append(&mut outside);
        Self {
            outcome,
            findings: failures,
        }
    }

    /// In one line.
    pub fn text(&self) -> String {
        let what = match self.outcome {
            Outcome::AsAsked => "The first flight does what was asked",
            Outcome::OutsideGoals => {
                "The first flight goes there and back, but is outside its goals: "
            }
            Outcome::Fails => "THE FIRST FLIGHT FAILS: ",
        };
        format!("{what}{}", self.findings.join("; "))
    }
}

/// What is known of why cruise is not reached, as the end of a sentence.
fn why_no_cruise(facts: &Facts, performance: &Performance) -> String {
    match (performance.cruise, performance.stall) {
        (Some([_, thrust]), _) if thrust > facts.thrust_to_weight => format!(
            ". Level flight at that speed needs {thrust:.2} times the weight of thrust, and there is {}",
            facts.thrust_to_weight
        ),
        (Some([_, thrust]), _) if thrust < facts.idle_to_weight => format!(
            ". Level flight at that speed needs {thrust:.2} times the weight of thrust, and idle is {}",
            facts.idle_to_weight
        ),
        (None, Some(stall)) => format!(
            ". It is below the speed of transition, {:.1} m/s",
            stall.slow_m_s
        ),
        _ => String::new(),
    }
}

/// The limits of the vehicle's campaign as TOML, with the rule that they are by.
pub fn limits_text(facts: &Facts) -> String {
    let scale = scale(facts);
    let [back, within] = SHARES;
    let mut text = format!(
        "# Lost: more than {LOST} m below the reference at any time.\n[[limits]]\nfigure = \"altitude_least_m\"\nleast = -{LOST:?}\ndeparture = true\n\n\
         # Of a hundred flights {:.0} never climb {LOST} m and are back on the reference at the end, within {} m and {} m/s. {:.0} come within a quarter\n\
         # of the speed of cruise, which is the most that the wind is, and stay within the lengths below: those of a round trip at {SPEED} m/s, times\n\
         # cruise over that where it is faster (here {scale:.2}).\n",
        100.0 * back,
        BACK[1],
        BACK[0],
        100.0 * within,
    );
    let mut limit = |figure: &str, side: &str, value: f64, share: f64| {
        let _ = write!(
            text,
            "[[limits]]\nfigure = \"{figure}\"\n{side} = {value:?}\nshare = {share}\n"
        );
    };
    limit("altitude_most_m", "most", LOST, back);
    limit("late_position_error_m", "most", BACK[1], back);
    limit("late_mean_velocity_error_m_s", "most", BACK[0], back);
    limit(
        "cruise_error_m_s",
        "most",
        MISSED * facts.cruise_m_s,
        within,
    );
    let mut written: Vec<&str> = Vec::new();
    for length in &LENGTHS {
        let (figure, least) = length.flown;
        if written.contains(&figure) {
            continue;
        }
        written.push(figure);
        let (side, sign) = if least {
            ("least", -1.0)
        } else {
            ("most", 1.0)
        };
        limit(figure, side, sign * scale * length.limit, within);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Known;
    use crate::experiment::Document;
    use crate::simulate::{Step, fly};

    fn facts(cruise: f64) -> Facts {
        let known = Known {
            mass_kg: Some(9.0),
            wing_m2: Some(0.83),
            section: Some("naca-0021".to_owned()),
            thrust_to_weight: Some(2.0),
            thrust_lag_s: Some(0.05),
            rate_lag_s: Some(0.1),
            cruise_m_s: Some(cruise),
            ..Known::default()
        };
        known.facts().unwrap()
    }

    const PERFORMANCE: Performance = Performance {
        stall: None,
        cruise: Some([4.0, 0.1]),
        turn: None,
        glide: None,
        stop_m: None,
    };

    /// The built-in round trip at 20 m/s, put on its reference and changed by hand.
    fn judged(cruise: f64, change: fn(&mut Step)) -> Verdict {
        let experiment = Document::load("round-trip").unwrap().checked().unwrap();
        let mut record = fly(&experiment).unwrap();
        // On the reference, exactly: what is judged is what the test puts there.
        for step in &mut record {
            step.truth.position = step.reference_position;
            step.truth.velocity = step.reference_velocity;
            change(step);
        }
        Verdict::of(
            &facts(cruise),
            &PERFORMANCE,
            &Figures::of(&experiment, &record),
        )
    }

    #[test]
    fn what_is_off_is_said() {
        let clean = judged(20.0, |_| ());
        assert_eq!((clean.outcome, clean.findings.len()), (Outcome::AsAsked, 0));
        let finding = |cruise: f64, outcome: Outcome, change: fn(&mut Step)| {
            let verdict = judged(cruise, change);
            assert_eq!(verdict.outcome, outcome, "{verdict:?}");
            verdict.findings.join("\n")
        };
        // The reference brakes from 45 s on.
        let low = finding(20.0, Outcome::OutsideGoals, |step| {
            step.truth.position.x += if (20.0..30.0).contains(&step.t) {
                1.3
            } else {
                0.0
            };
        });
        assert!(
            low.contains("sinks below its reference on the way out by 1.30 m, of 1.00 m"),
            "{low}"
        );
        let high = finding(20.0, Outcome::Fails, |step| {
            step.truth.position.x -= if (50.0..60.0).contains(&step.t) {
                25.0
            } else {
                0.0
            };
        });
        assert!(
            high.contains("climbs above its reference on the way back by 25.00 m"),
            "{high}"
        );
        let behind = finding(20.0, Outcome::Fails, |step| {
            step.truth.position.y -= if step.t > 10.0 { 670.0 } else { 0.0 };
        });
        assert!(
            behind.contains("falls behind") && behind.contains("does not come back to hover"),
            "{behind}"
        );
        let ahead = finding(20.0, Outcome::OutsideGoals, |step| {
            step.truth.position.y += if (50.0..60.0).contains(&step.t) {
                5.0
            } else {
                0.0
            };
        });
        assert!(ahead.contains("runs ahead"), "{ahead}");
        let slow = finding(20.0, Outcome::Fails, |step| {
            step.truth.velocity.y -= if (20.0..45.0).contains(&step.t) {
                2.0
            } else {
                0.0
            };
        });
        assert!(
            slow.contains("does not reach cruise: off by 2.0 m/s"),
            "{slow}"
        );
        let nan = finding(20.0, Outcome::Fails, |step| {
            step.truth.position.x = f64::NAN
        });
        assert!(nan.contains("lost"), "{nan}");
        // A faster vehicle may be farther off, a slower one may not.
        let lower = |step: &mut Step| {
            step.truth.position.x += if (20.0..30.0).contains(&step.t) {
                1.3
            } else {
                0.0
            }
        };
        finding(30.0, Outcome::AsAsked, lower);
        finding(10.0, Outcome::OutsideGoals, lower);
    }

    #[test]
    fn thrust_that_is_short_is_named() {
        let performance = Performance {
            cruise: Some([1.0, 2.6]),
            ..PERFORMANCE
        };
        let why = why_no_cruise(&facts(60.0), &performance);
        assert!(
            why.contains("needs 2.60 times the weight of thrust, and there is 2"),
            "{why}"
        );
        assert_eq!(why_no_cruise(&facts(60.0), &PERFORMANCE), "");
    }

    /// Where a campaign's limits would not hold the first flight's failures, "passed" would mean nothing.
    #[test]
    fn the_campaign_has_every_limit() {
        let text = limits_text(&facts(30.0));
        let table: toml::Table = text.parse().unwrap();
        let limits = table["limits"].as_array().unwrap();
        let of = |figure: &str, side: &str| {
            let found = limits
                .iter()
                .filter(|limit| limit["figure"].as_str() == Some(figure));
            let values = found.filter_map(|limit| limit.get(side)?.as_float());
            values.collect::<Vec<f64>>()
        };
        assert_eq!(of("altitude_least_m", "least"), [-50.0, -15.0]);
        assert_eq!(of("altitude_most_m", "most"), [50.0, 15.0]);
        assert_eq!(of("forward_least_m", "least"), [-45.0]);
        assert_eq!(of("ahead_m", "most"), [22.5]);
        assert_eq!(of("late_position_error_m", "most"), [5.0]);
        assert_eq!(of("late_mean_velocity_error_m_s", "most"), [0.5]);
        assert_eq!(of("cruise_error_m_s", "most"), [7.5]);
        assert_eq!(limits.len(), 9);
    }
}
