//! Numbers of the standard normal distribution, the same on every machine.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// From here on the method takes a logarithm, of which the last digit depends on the machine's own library.
const TAIL: f64 = 3.654_152_885_361_009;

/// A number of the standard normal distribution; in single precision from [`TAIL`] on, where the last digit no longer counts.
pub(crate) fn normal(random: &mut impl Rng) -> f64 {
    let drawn: f64 = StandardNormal.sample(random);
    if drawn.abs() < TAIL {
        drawn
    } else {
        f64::from(drawn as f32)
    }
}
