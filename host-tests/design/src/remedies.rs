//! What would mend a first flight: changes of the vehicle, each flown.

use super::document::short;
use super::{Actuators, Design, Facts, Outcome};

/// A change of one number of a vehicle.
struct Remedy {
    /// What it is multiplied by, the least change first.
    factors: &'static [f64],
    number: fn(&mut Facts) -> &mut f64,
    /// What it is, of the changed vehicle and of the one there is.
    says: fn(&Facts, &str, &str) -> String,
}

/// The changes that are tried. Factors are what a builder can do: elevons of twice the chord, motors one size up.
const REMEDIES: [Remedy; 6] = [
    Remedy {
        factors: &[1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0],
        number: |facts| &mut facts.turn_rad_s2,
        says: |facts, now, was| {
            let how = match facts.actuators {
                Actuators::Elevons => {
                    "larger elevons, more of them in the slipstream, or motors above and below the wing"
                }
                Actuators::Motors => "motors farther apart, or of more thrust",
                Actuators::Both => "larger elevons, or motors farther apart",
            };
            format!(
                "{now} rad/s² of turning in place of {was} ({how}): behind the stall the wing turns the nose harder than it can be held now"
            )
        },
    },
    Remedy {
        factors: &[0.67, 0.5, 0.3, 0.15],
        number: |facts| &mut facts.rate_lag_s,
        says: |_, now, was| format!("a rate loop with a lag of {now} s in place of {was}"),
    },
    Remedy {
        factors: &[0.67, 0.5, 0.3, 0.15],
        number: |facts| &mut facts.thrust_lag_s,
        says: |_, now, was| format!("motors with a lag of {now} s in place of {was}"),
    },
    Remedy {
        factors: &[1.2, 1.5, 2.0],
        number: |facts| &mut facts.thrust_to_weight,
        says: |_, now, was| format!("thrust of {now} times the weight in place of {was}"),
    },
    Remedy {
        factors: &[0.9, 1.1, 0.8, 1.25, 0.65, 1.5],
        number: |facts| &mut facts.cruise_m_s,
        says: |_, now, was| format!("a cruise at {now} m/s in place of {was}"),
    },
    Remedy {
        factors: &[1.25, 0.8, 1.5],
        number: |facts| &mut facts.wing_m2,
        says: |_, now, was| format!("a wing of {now} m² in place of {was}"),
    },
];

/// More are not told: each is one way out.
const MOST: usize = 3;

/// A number as one would say it: of three digits.
fn rounded(x: f64) -> f64 {
    let step = 10_f64.powi(x.abs().log10().floor() as i32 - 2);
    (x / step).round() * step
}

impl Design {
    /// What would mend a first flight of this outcome, in words: of each number the least change with which it does what was asked, or no longer fails.
    pub(super) fn remedies(&self, outcome: Outcome) -> Vec<String> {
        let better = |remedy: &Remedy| {
            remedy.factors.iter().find_map(|factor| {
                let mut facts = self.facts.clone();
                let number = (remedy.number)(&mut facts);
                let was = *number;
                *number = rounded(was * factor);
                let now = *number;
                let says = (remedy.says)(&facts, &short(now), &short(was));
                // What cannot be made or flown mends nothing.
                let changed = Self::new(facts).ok()?;
                let flown = Self {
                    trip: self.trip,
                    ..changed
                };
                let flown = flown.tried().ok()?;
                (flown.outcome < outcome).then_some(says)
            })
        };
        match outcome {
            Outcome::AsAsked => Vec::new(),
            _ => REMEDIES.iter().filter_map(better).take(MOST).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_said_in_three_digits() {
        for (x, said) in [
            (0.060 * 0.67, "0.0402"),
            (26.999999, "27"),
            (1234.5, "1230"),
        ] {
            assert_eq!(short(rounded(x)), said);
        }
    }
}
