//! The paper's identities and theorems, through the core.
#[path = "../common/mod.rs"]
mod common;

mod convergence;
mod equilibria;
mod lyapunov;
mod models;

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
