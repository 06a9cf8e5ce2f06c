//! Random references: a chain of velocities, reached by ramps or at once, held for a while, and hover at the end.

use rand::{Rng, RngExt};
use serde::Deserialize;
use toml::{Table, Value};

use super::Distribution;
use alula_sim::experiment::{FieldError, finite, require};

/// The columns of a random reference: its greatest speed, its greatest sink, and when it has stopped.
pub(super) const REFERENCE: [&str; 3] = [
    "reference_speed_m_s",
    "reference_sink_m_s",
    "reference_stops_s",
];

/// `[reference]` of a campaign: how the references of its flights are drawn, in place of the base's.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RandomReference {
    /// Until when it changes to other velocities \[s\]: then it goes to hover, and stays there.
    pub until_s: f64,
    /// Velocities forward [m/s].
    pub forward_m_s: Distribution,
    /// Velocities down [m/s].
    pub down_m_s: Distribution,
    /// Acceleration of the ramps [m/s²].
    pub acceleration_m_s2: Distribution,
    /// How long a velocity is held \[s\].
    pub hold_s: Distribution,
    /// Share of the changes that are at once.
    pub steps: f64,
}

/// What was drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnReference {
    /// The knots: time \[s\], velocity down and forward [m/s].
    knots: Vec<[f64; 3]>,
}

/// How long a change at once takes \[s\]: shorter than any step, and at no control step but by chance.
const AT_ONCE: f64 = 1e-6;
/// Most velocities of a chain: what is held for no time would never end.
const MOST: usize = 1000;

impl RandomReference {
    pub(super) fn validate(&self) -> Result<(), FieldError> {
        finite("reference.until_s", self.until_s)?;
        for (field, distribution) in [
            ("reference.forward_m_s", &self.forward_m_s),
            ("reference.down_m_s", &self.down_m_s),
            ("reference.acceleration_m_s2", &self.acceleration_m_s2),
            ("reference.hold_s", &self.hold_s),
        ] {
            distribution.validate(field)?;
        }
        for (field, distribution) in [
            ("reference.acceleration_m_s2", &self.acceleration_m_s2),
            ("reference.hold_s", &self.hold_s),
        ] {
            if distribution.least() <= 0.0 {
                return Err(FieldError::new(field, "must be positive"));
            }
        }
        let share = (0.0..=1.0).contains(&self.steps);
        require(share, "reference.steps", "must be from 0 to 1")
    }

    pub(super) fn draw(&self, random: &mut impl Rng) -> DrawnReference {
        let mut t = self.hold_s.draw(random);
        let mut velocity = [0.0, 0.0];
        let mut knots = vec![[t, 0.0, 0.0]];
        while knots.len() < 2 * MOST {
            let last = t >= self.until_s;
            let next = match last {
                true => [0.0, 0.0],
                false => [self.down_m_s.draw(random), self.forward_m_s.draw(random)],
            };
            let change = f64::hypot(next[0] - velocity[0], next[1] - velocity[1]);
            let ramp = change / self.acceleration_m_s2.draw(random);
            let at_once = random.random::<f64>() < self.steps;
            t += if at_once { AT_ONCE } else { ramp.max(AT_ONCE) };
            knots.push([t, next[0], next[1]]);
            if last {
                break;
            }
            velocity = next;
            t += self.hold_s.draw(random);
            knots.push([t, next[0], next[1]]);
        }
        DrawnReference { knots }
    }
}

impl DrawnReference {
    /// The reference as a document has it.
    pub(super) fn value(&self) -> Value {
        let table = |[t, down, forward]: &[f64; 3]| {
            let fields = [("t_s", t), ("down_m_s", down), ("forward_m_s", forward)];
            let fields = fields.map(|(key, value)| (key.to_owned(), Value::Float(*value)));
            Value::Table(fields.into_iter().collect::<Table>())
        };
        let knots = Value::Array(self.knots.iter().map(table).collect());
        Value::Table(Table::from_iter([("knots".to_owned(), knots)]))
    }

    /// Greatest speed [m/s].
    pub fn speed(&self) -> f64 {
        let speeds = self.knots.iter().map(|k| f64::hypot(k[1], k[2]));
        speeds.fold(0.0, f64::max)
    }

    /// Greatest sink [m/s].
    pub fn sink(&self) -> f64 {
        self.knots.iter().map(|k| k[1]).fold(0.0, f64::max)
    }

    /// When it has stopped \[s\].
    pub fn stops(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    fn random_reference(steps: f64) -> RandomReference {
        RandomReference {
            until_s: 30.0,
            forward_m_s: Distribution::Uniform([-2.0, 20.0]),
            down_m_s: Distribution::Uniform([-2.0, 8.0]),
            acceleration_m_s2: Distribution::Uniform([1.0, 3.0]),
            hold_s: Distribution::Uniform([1.0, 8.0]),
            steps,
        }
    }

    /// The accelerations of the changes [m/s²].
    fn accelerations(drawn: &DrawnReference) -> Vec<f64> {
        let slope = |pair: &[[f64; 3]]| {
            let change = f64::hypot(pair[1][1] - pair[0][1], pair[1][2] - pair[0][2]);
            change / (pair[1][0] - pair[0][0])
        };
        drawn
            .knots
            .windows(2)
            .map(slope)
            .filter(|&a| a > 0.0)
            .collect()
    }

    #[test]
    fn references_are_chains_that_end_in_hover() {
        let random = &mut ChaCha8Rng::seed_from_u64(1);
        for _ in 0..100 {
            let drawn = random_reference(0.0).draw(random);
            let knots = &drawn.knots;
            assert!(knots.windows(2).all(|pair| pair[1][0] > pair[0][0]));
            assert_eq!(&knots[knots.len() - 1][1..], [0.0, 0.0]);
            // Before 30 s the last change but one begins, of up to 24 m/s at 1 m/s²; then 8 s, and up to 22 m/s to hover.
            assert!((30.0..30.0 + 24.0 + 8.0 + 22.0).contains(&drawn.stops()));
            assert!(drawn.speed() <= f64::hypot(20.0, 8.0) && drawn.sink() <= 8.0);
            assert!(drawn.speed() > 0.0);
            let slopes = accelerations(&drawn);
            assert!(
                slopes.iter().all(|a| (0.99..=3.01).contains(a)),
                "{slopes:?}"
            );
        }
        let drawn = random_reference(1.0).draw(random);
        assert!(accelerations(&drawn).iter().all(|&a| a > 1e4));
    }

    #[test]
    fn what_would_not_end_is_refused() {
        let refused = |change: fn(&mut RandomReference)| {
            let mut reference = random_reference(0.5);
            change(&mut reference);
            reference.validate().map_err(|e| e.field)
        };
        assert!(refused(|_| ()).is_ok());
        let field = |change| refused(change).unwrap_err();
        assert_eq!(field(|r| r.steps = 1.5), "reference.steps");
        let zero = Distribution::Uniform([0.0, 1.0]);
        assert_eq!(
            field(|r| r.hold_s = Distribution::Uniform([0.0, 1.0])),
            "reference.hold_s"
        );
        let mut reference = random_reference(0.5);
        reference.acceleration_m_s2 = zero;
        assert!(reference.validate().is_err());
    }
}
