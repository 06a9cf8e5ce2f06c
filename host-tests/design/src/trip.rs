//! The round trip of a vehicle's file: hover, cruise, hover.

/// How cruise is begun and ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trip {
    /// Acceleration to cruise \[m/s²\].
    acceleration: f64,
    /// Deceleration to hover \[m/s²\].
    deceleration: f64,
    /// Greatest climb on the way there, over the speed of cruise.
    climb: f64,
}

/// Time \[s\] of hover before, of cruise, and after the end.
const BEFORE: f64 = 5.0;
const CRUISE: f64 = 30.0;
const AFTER: f64 = 60.0;
/// Parts of the braking by which the climb is at its greatest, and from which on it ends.
const CLIMBS: [f64; 2] = [0.3, 0.5];

impl Trip {
    /// Level, as the built-in round trip.
    pub(super) const LEVEL: Self = Self {
        acceleration: 2.0,
        deceleration: 2.0,
        climb: 0.0,
    };

    /// What a vehicle is tried with that does not brake level as was asked. What turns little holds its nose against the wing in a climb, in which speed becomes
    /// height, and the steeper the less it turns; some want to cross the stall slowly.
    pub(super) const OTHERS: [Self; 4] = [
        Self {
            climb: 0.2,
            ..Self::LEVEL
        },
        Self {
            climb: 0.3,
            ..Self::LEVEL
        },
        Self {
            deceleration: 3.0,
            climb: 0.45,
            ..Self::LEVEL
        },
        Self {
            acceleration: 1.0,
            deceleration: 1.0,
            climb: 0.2,
        },
    ];

    /// Time \[s\], velocity down and forward [m/s] of the knots, to and from a `cruise` [m/s].
    pub(super) fn knots(&self, cruise: f64) -> Vec<[f64; 3]> {
        let begin = BEFORE + cruise / self.acceleration;
        let end = begin + CRUISE;
        let braking = cruise / self.deceleration;
        let climb = |part: f64| {
            [
                end + part * braking,
                -self.climb * cruise,
                (1.0 - part) * cruise,
            ]
        };
        let mut knots = vec![[BEFORE, 0.0, 0.0], [begin, 0.0, cruise], [end, 0.0, cruise]];
        if self.climb > 0.0 {
            knots.extend(CLIMBS.map(climb));
        }
        knots.push([end + braking, 0.0, 0.0]);
        knots
    }

    /// How long the flight is \[s\].
    pub(super) fn duration(&self, cruise: f64) -> f64 {
        BEFORE + cruise / self.acceleration + CRUISE + cruise / self.deceleration + AFTER
    }

    /// Height \[m\] of the climb in which it brakes.
    pub(super) fn height(&self, cruise: f64) -> f64 {
        let [full, ends] = CLIMBS;
        0.5 * (1.0 + ends - full) * self.climb * cruise * cruise / self.deceleration
    }

    /// In words.
    pub(super) fn text(&self, cruise: f64) -> String {
        let Self {
            acceleration: out,
            deceleration: back,
            climb,
        } = self;
        let back = match out == back {
            true => format!("and back at {out} m/s²"),
            false => format!("at {out} m/s², and back at {back} m/s²"),
        };
        match *climb > 0.0 {
            true => format!("{back}, braking in a climb of {:.0} m", self.height(cruise)),
            false => back,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The height that is named is the integral of the climb, and level braking has none.
    #[test]
    fn its_height_is_that_of_its_knots() {
        for trip in [Trip::LEVEL].into_iter().chain(Trip::OTHERS) {
            let knots = trip.knots(18.0);
            let pieces = knots.windows(2);
            let climbed: f64 = pieces
                .map(|ends| -0.5 * (ends[0][1] + ends[1][1]) * (ends[1][0] - ends[0][0]))
                .sum();
            assert!((climbed - trip.height(18.0)).abs() < 1e-9, "{trip:?}");
            assert_eq!(
                trip.duration(18.0),
                knots.last().unwrap()[0] + AFTER,
                "{trip:?}"
            );
            assert_eq!(trip.text(18.0).contains("climb"), climbed > 0.0, "{trip:?}");
        }
    }
}
