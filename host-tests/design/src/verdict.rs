//! What came of a vehicle's first flight.

use serde::Serialize;

use super::goals::{BACK, LENGTHS, scale};
use super::{Facts, Performance};
use alula_sim::figures::{Figures, LOST, REACHED};

/// Thrust over weight beyond that of level flight on the wing from which on a cruise is behind the stall.
const BEHIND_STALL: f64 = 0.2;

/// What came of the first flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
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
    /// What mends it, each by itself: as flown.
    pub advice: Vec<String>,
    /// How far it is from what a flight must keep: of its lengths the greatest over what is the most; infinite where it is lost, does not cruise or does not
    /// come back.
    #[serde(skip)]
    pub(super) worst: f64,
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
        let missed = get("max_cruise_error_m_s");
        if !within(missed, REACHED) {
            failures.push(format!(
                "it does not reach cruise: at the end of cruise at {} m/s the velocity is off by {missed:.1} m/s{}",
                facts.cruise_m_s,
                why_no_cruise(facts, performance)
            ));
        }
        let end = ["max_late_velocity_error_m_s", "max_late_position_error_m"].map(get);
        if !(within(end[0], BACK[0]) && within(end[1], BACK[1])) {
            failures.push(format!(
                "it does not come back to hover: {:.1} m/s and {:.0} m off its reference at the end",
                end[0], end[1]
            ));
        }
        let mut worst: f64 = match failures.is_empty() {
            true => 0.0,
            false => f64::INFINITY,
        };
        for length in &LENGTHS {
            let value = get(length.first);
            let far = value.abs();
            worst = worst.max(far / (scale * length.limit));
            let text = |most: f64| {
                format!(
                    "it {} by {far:.2} m (asked: {most:.2} m at most)",
                    length.text
                )
            };
            if !within(far, scale * length.limit) {
                failures.push(text(scale * length.limit));
            } else if !within(far, scale * length.goal) {
                outside.push(text(scale * length.goal));
            }
        }
        if performance.cruise.is_none() {
            outside.push(format!(
                "it cruises on its thrust: at {} m/s the wing carries {:.0} % of the weight at most",
                facts.cruise_m_s,
                100.0 * performance.carried
            ));
        }
        let needed = performance.cruise.map(|[_, thrust]| thrust);
        let thrust = get("cruise_mean_thrust_to_weight");
        if let Some(needed) = needed.filter(|needed| thrust - needed > BEHIND_STALL) {
            outside.push(format!(
                "it cruises behind the stall, with thrust of {thrust:.2} times the weight, where the wing needs {needed:.2}"
            ));
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
            advice: Vec::new(),
            worst,
        }
    }

    /// In one line.
    pub fn text(&self) -> String {
        let what = match self.outcome {
            Outcome::AsAsked => "The first flight does what was asked",
            Outcome::OutsideGoals => {
                "The first flight goes there and back, less closely than was asked: "
            }
            Outcome::Fails => "THE FIRST FLIGHT FAILS: ",
        };
        let advice = self.advice.join("; or with ");
        let advice = match (self.outcome, advice.is_empty()) {
            (Outcome::AsAsked, _) => String::new(),
            (Outcome::OutsideGoals, true) => String::new(),
            (Outcome::Fails, true) => {
                ". No single change was found that mends it: of what turns it, the lags, the thrust, the cruise, the wing".to_owned()
            }
            (Outcome::OutsideGoals, false) => format!(". Flown, it does what was asked with {advice}"),
            (Outcome::Fails, false) => format!(". Flown, it does not fail with {advice}"),
        };
        format!("{what}{}{advice}", self.findings.join("; "))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::goals::tests::facts;
    use crate::refusals::says;
    use alula_sim::experiment::Document;
    use alula_sim::simulate::{Step, fly};

    const PERFORMANCE: Performance = Performance {
        stall: None,
        jump: None,
        cruise: Some([4.0, 0.1]),
        carried: 2.0,
        lift: 2.0,
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
            step.truth.position = step.target.position;
            step.truth.velocity = step.target.velocity;
            change(step);
        }
        Verdict::of(
            &facts(cruise),
            &PERFORMANCE,
            &Figures::of(&experiment, &record),
        )
    }

    /// `value` during this time \[s\], else nothing.
    fn during(time: std::ops::Range<f64>, step: &Step, value: f64) -> f64 {
        if time.contains(&step.t) { value } else { 0.0 }
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
            step.truth.position.z += during(20.0..30.0, step, 1.3);
        });
        says(
            &low,
            &["sinks below its reference on the way out by 1.30 m (asked: 1.00 m at most)"],
        );
        let mut low = judged(20.0, |step| {
            step.truth.position.z += during(20.0..30.0, step, 1.3)
        });
        assert!((low.worst - 0.13).abs() < 1e-9, "{low:?}");
        low.advice = vec!["more thrust".to_owned(), "a larger wing".to_owned()];
        says(
            &low.text(),
            &[
                "less closely than was asked",
                "Flown, it does what was asked with more thrust; or with a larger wing",
            ],
        );
        let high = finding(20.0, Outcome::Fails, |step| {
            step.truth.position.z -= during(50.0..60.0, step, 25.0);
        });
        says(
            &high,
            &["climbs above its reference on the way back by 25.00 m"],
        );
        let behind = finding(20.0, Outcome::Fails, |step| {
            step.truth.position.x -= if step.t > 10.0 { 670.0 } else { 0.0 };
        });
        says(&behind, &["falls behind", "does not come back to hover"]);
        let ahead = finding(20.0, Outcome::OutsideGoals, |step| {
            step.truth.position.x += during(50.0..60.0, step, 5.0);
        });
        assert!(ahead.contains("runs ahead"), "{ahead}");
        let slow = finding(20.0, Outcome::Fails, |step| {
            step.truth.velocity.x -= during(20.0..45.0, step, 2.0);
        });
        assert!(slow.contains("the velocity is off by 2.0 m/s"), "{slow}");
        let nan = finding(20.0, Outcome::Fails, |step| {
            step.truth.position.z = f64::NAN
        });
        assert!(nan.contains("lost"), "{nan}");
        // A faster vehicle may be farther off, a slower one may not.
        let lower = |step: &mut Step| step.truth.position.z += during(20.0..30.0, step, 1.3);
        finding(30.0, Outcome::AsAsked, lower);
        finding(10.0, Outcome::OutsideGoals, lower);
    }

    /// A flight on its reference at a speed at which the wing does not carry the vehicle is not what was asked.
    #[test]
    fn a_cruise_on_the_thrust_is_not_as_asked() {
        let experiment = Document::load("round-trip").unwrap().checked().unwrap();
        let mut record = fly(&experiment).unwrap();
        for step in &mut record {
            step.truth.position = step.target.position;
            step.truth.velocity = step.target.velocity;
        }
        let performance = Performance {
            cruise: None,
            carried: 0.83,
            ..PERFORMANCE
        };
        let figures = Figures::of(&experiment, &record);
        let verdict = Verdict::of(&facts(20.0), &performance, &figures);
        assert_eq!(verdict.outcome, Outcome::OutsideGoals);
        says(
            &verdict.text(),
            &["at 20 m/s the wing carries 83 % of the weight at most"],
        );
    }

    #[test]
    fn thrust_that_is_short_is_named() {
        let performance = Performance {
            cruise: Some([1.0, 2.6]),
            ..PERFORMANCE
        };
        let why = why_no_cruise(&facts(50.0), &performance);
        says(
            &why,
            &["needs 2.60 times the weight of thrust, and there is 1.6"],
        );
        assert_eq!(why_no_cruise(&facts(50.0), &PERFORMANCE), "");
    }
}
