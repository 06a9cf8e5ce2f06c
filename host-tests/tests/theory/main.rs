//! The core against the yardstick in double precision: the paper's identities and theorems, accuracy, equilibria, margins; and polars.
#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod convergence;
mod envelope;
mod equilibria;
mod finder;
mod lyapunov;
mod margins;
mod models;
mod paper_flight;
mod spatial;
mod stalls;
mod yardstick;

use alula::CombinedParameters;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

const SETS: [CombinedParameters; 2] = [
    CombinedParameters::NACA_0021_RE_160E3,
    CombinedParameters::NACA_0021_RE_5E6,
];

/// δ in [−90°, 90°] \[rad\].
fn random_delta(rng: &mut ChaCha8Rng) -> f32 {
    let half = std::f32::consts::FRAC_PI_2;
    rng.random_range(-half..=half)
}
