//! The wind in the mean of a flight, from the airspeed and the velocity over ground: V = κ |v − w|, with the scale κ of the sensor.
//!
//! Gusts are in V, and last: what counts is the mean of each few seconds. Where a flight says little, what is known of every flight is left (Bayes): a wind of some
//! metres a second from anywhere, and a sensor that is right to some per cent. A flight in one direction tells the wind along it from the scale by its speeds, and from
//! one across it, which adds to the airspeed whether from the left or from the right; a flight to and fro, or a circle, tells them all. An estimate by steps of
//! Newton's method takes no account of that: so each wind of a grid is looked at.

use nalgebra::Vector3;

use super::regression::Measured;

/// Length of blocks whose means are taken for independent \[s\]: gusts along the wind last as long on a flight of some metres a second.
const BLOCK: f64 = 12.0;
/// Length of their parts, in which the velocity is its mean \[s\], and least parts of a block.
const PART: f64 = 1.0;
const PARTS: usize = 6;
/// Standard deviations of what is known of every flight: wind [m/s], and the scale of an airspeed sensor.
const WIND: f64 = 10.0;
const SCALE: f64 = 0.05;
/// Gusts in the mean of a block [m/s], and the number of blocks that this is worth.
const GUST: f64 = 0.5;
const WORTH: f64 = 4.0;
/// Winds that are looked at, towards north and east [m/s]: up to this one, in these steps.
const MOST: f64 = 25.0;
const STEP: f64 = 0.25;
const WINDS: usize = (2.0 * MOST / STEP) as usize + 1;
/// Interval [m/s] within which a wind is known, and least number of blocks.
const KNOWN: f64 = 1.5;
const BLOCKS: usize = 5;

/// An instant on the wing, the nose ahead.
pub(super) struct Sample {
    /// \[s\].
    pub(super) t: f64,
    /// Velocity over ground, north, east and down [m/s].
    pub(super) ground: Vector3<f64>,
    /// As the sensor tells it [m/s].
    pub(super) airspeed: f64,
}

/// Some seconds of flight: the velocity of each part, and the airspeed in the mean.
struct Block {
    ground: Vec<Vector3<f64>>,
    airspeed: f64,
}

impl Block {
    fn of(samples: &[Sample]) -> Self {
        let part = |sample: &Sample| (sample.t / PART).floor();
        let parts = samples.chunk_by(|a, b| part(a) == part(b));
        let mean = |part: &[Sample]| {
            let sum: Vector3<f64> = part.iter().map(|sample| sample.ground).sum();
            sum / part.len() as f64
        };
        let airspeed: f64 = samples.iter().map(|sample| sample.airspeed).sum();
        Self {
            ground: parts.map(mean).collect(),
            airspeed: airspeed / samples.len() as f64,
        }
    }

    /// Speed through the air in the mean [m/s] in this wind.
    fn through(&self, wind: &Vector3<f64>) -> f64 {
        let speeds = self.ground.iter().map(|ground| (ground - wind).norm());
        speeds.sum::<f64>() / self.ground.len() as f64
    }
}

/// The level wind, towards north and east [m/s], each where the flight shows it.
pub(super) fn wind(samples: &[Sample]) -> [Option<Measured>; 2] {
    let block = |sample: &Sample| (sample.t / BLOCK).floor();
    let blocks = samples.chunk_by(|a, b| block(a) == block(b));
    let blocks: Vec<Block> = blocks
        .map(Block::of)
        .filter(|block| block.ground.len() >= PARTS)
        .collect();
    if blocks.len() < BLOCKS {
        return [None; 2];
    }
    let likely: Vec<f64> = (0..WINDS * WINDS)
        .map(|n| log_likelihood(&blocks, at(n / WINDS), at(n % WINDS)))
        .collect();
    let most = likely.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut along = [vec![0.0; WINDS], vec![0.0; WINDS]];
    for (n, likely) in likely.iter().enumerate() {
        let share = (likely - most).exp();
        along[0][n / WINDS] += share;
        along[1][n % WINDS] += share;
    }
    along.map(|shares| interval(&shares).filter(|found| found.within < KNOWN))
}

/// The wind of a place on the grid [m/s].
fn at(n: usize) -> f64 {
    n as f64 * STEP - MOST
}

/// How likely a wind towards north and east [m/s] is, by its logarithm: gusts of a size that is not known are those of a t-distribution.
fn log_likelihood(blocks: &[Block], north: f64, east: f64) -> f64 {
    let wind = Vector3::new(north, east, 0.0);
    let tight = (GUST / SCALE).powi(2);
    let (mut products, mut squares, mut all) = (tight, tight, 0.0);
    for block in blocks {
        let speed = block.through(&wind);
        products += speed * block.airspeed;
        squares += speed * speed;
        all += block.airspeed * block.airspeed;
    }
    let scale = products / squares;
    let left = all - 2.0 * scale * (products - tight) + scale * scale * (squares - tight);
    let gusts = (WORTH + blocks.len() as f64) / 2.0 * (1.0 + left / (WORTH * GUST * GUST)).ln();
    let known = ((scale - 1.0) / SCALE).powi(2) + (wind / WIND).norm_squared();
    -gusts - known / 2.0
}

/// The mean of what these `shares` say of each wind of the grid, and the distance from it within which 95 % of them are.
fn interval(shares: &[f64]) -> Option<Measured> {
    let sum: f64 = shares.iter().sum();
    let winds = shares.iter().enumerate().map(|(n, share)| at(n) * share);
    let value = winds.sum::<f64>() / sum;
    let mut off: Vec<(f64, f64)> = shares
        .iter()
        .enumerate()
        .map(|(n, share)| ((at(n) - value).abs() + STEP / 2.0, share / sum))
        .collect();
    off.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut held = 0.0;
    let within = off.iter().find(|(_, share)| {
        held += share;
        held >= 0.95
    });
    within.map(|(within, _)| Measured {
        value,
        within: *within,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flight in a wind of 2 m/s to the south and 1 to the east, with gusts of seconds and a sensor that tells 4 % too much.
    fn flight(heading: impl Fn(f64) -> f64, speed: impl Fn(f64) -> f64) -> Vec<Sample> {
        let wind = Vector3::new(-2.0, 1.0, 0.0);
        let samples = (0..6000).map(|n| {
            let t = 0.02 * f64::from(n);
            let gust = 0.4 * (0.9 * t).sin() + 0.3 * (2.3 * t).sin();
            let (sin, cos) = heading(t).sin_cos();
            let air = (speed(t) + gust) * Vector3::new(cos, sin, 0.0);
            Sample {
                t,
                ground: air - gust * Vector3::new(cos, sin, 0.0) + wind,
                airspeed: 1.04 * (speed(t) + gust),
            }
        });
        samples.collect()
    }

    /// A circle shows the whole wind, whatever the sensor's scale; a flight north at three speeds the wind along it, and says nothing of the one across; one speed
    /// says nothing.
    #[test]
    fn a_wind_is_shown_by_a_circle_and_along_a_line_by_its_speeds() {
        let holds = |m: Option<Measured>, truth: f64| {
            let m = m.unwrap();
            assert!((m.value - truth).abs() <= m.within, "{m:?} of {truth}");
            assert!((m.value - truth).abs() < 0.4, "{m:?} of {truth}");
        };
        let [north, east] = wind(&flight(|t| 0.2 * t, |_| 15.0));
        holds(north, -2.0);
        holds(east, 1.0);
        let speeds = |t: f64| [10.0, 15.0, 20.0][(t / 40.0) as usize % 3];
        let [north, east] = wind(&flight(|_| 0.0, speeds));
        let north = north.unwrap();
        assert!((north.value + 2.0).abs() <= north.within, "{north:?}");
        assert_eq!(east, None);
        assert_eq!(wind(&flight(|_| 0.0, |_| 20.0)), [None; 2]);
        assert_eq!(wind(&flight(|t| t, |_| 20.0)[..1000]), [None; 2]);
    }

    /// A flight north does not tell a wind from the left from one from the right, and what either adds to the airspeed, more at low speeds than at high ones, is in the
    /// interval of the wind along it. An estimate by Newton's method was wrong by 2 to 3 m/s here, and sure of it within 0.4.
    #[test]
    fn a_wind_across_is_in_the_interval_of_the_one_along() {
        for across in [-6.0, 0.0, 6.0] {
            for along in [-3.0, 3.0] {
                let samples = (0..9000).map(|n| {
                    let t = 0.02 * f64::from(n);
                    let ground = Vector3::new([11.0, 18.0, 22.0][(t / 60.0) as usize], 0.0, 0.0);
                    let air = ground - Vector3::new(along, across, 0.0);
                    let gust = 0.4 * (0.37 * t).sin();
                    Sample {
                        t,
                        ground,
                        airspeed: 1.03 * air.norm() + gust,
                    }
                });
                let samples: Vec<Sample> = samples.collect();
                for (found, truth) in wind(&samples).into_iter().zip([along, across]) {
                    if let Some(m) = found {
                        assert!((m.value - truth).abs() <= m.within, "{m:?} of {truth}");
                    }
                }
            }
        }
    }
}
