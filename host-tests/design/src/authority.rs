//! How fast a full torque of surfaces in the slipstream turns a vehicle in pitch, in hover: by regression of the angular acceleration.
//!
//! ω̇ = δ (c_T T/m g + c_q max(u² − 1.9 w², 0)) + (1, T, V², V w, u w; ω, V ω; (1, V, V²) θ) · others
//!
//! with the torque δ that was asked for behind the lag of the servos, u along the nose, w across it, and θ what the nose has turned in the last half second and the
//! last seconds. c_T is the answer. c_q is not given: where drag and the propeller's loss are not told apart, it takes what thrust is wrong by.
//!
//! Who flies answers with δ what gusts have turned. So δ is taken as far as it goes with the rates that were asked for in the last rows (two-stage least squares). These
//! answer gusts, too, by the attitude: beside θ what is left of them is what somebody wanted. A full torque need not be flown.

use nalgebra::{DMatrix, DVector};

use super::flown::SLOW;
use super::lag::{Even, GAP, behind};
use super::regression::{Fit, Measured, least_squares};

/// Rows of what was asked for.
const ASKED: usize = 8;
/// Times \[s\] over which what the nose has turned is forgotten.
const LATELY: [f64; 2] = [0.5, 4.0];
/// Lags of the servos that are tried \[s\].
const LAGS: [f64; 6] = [1e-3, 0.02, 0.035, 0.05, 0.07, 0.1];
/// Time over which residuals hang together \[s\].
const BLOCK: f64 = 5.0;
/// Least rows, and least root mean square of a torque that moves.
const ROWS: usize = 1000;
const MOVES: f64 = 0.01;
/// Squared airspeed across the wing that takes the airflow's authority away, over that along the nose: as the core has it.
const STALLED: f64 = 1.9;
/// Part of what a surface's first degrees promise that it does not give at full travel: of a flap of 40° (W. Khan, *Dynamics Modeling of Agile Fixed-Wing Unmanned
/// Aerial Vehicles*, section 3.3).
const LOST: f64 = 0.3;
/// Unknowns of the torque, and of all else.
const OF_TORQUE: usize = 2;
const OTHERS: usize = 7 + 3 * LATELY.len();

/// What turns a vehicle in pitch at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Time \[s\].
    pub(super) t: f64,
    /// ω, asked for and had [rad/s].
    pub(super) asked: f64,
    pub(super) rate: f64,
    /// δ, a share of the full torque.
    pub(super) torque: f64,
    /// Thrust over the weight.
    pub(super) thrust: f64,
    /// Air velocity along the nose, and towards the belly [m/s].
    pub(super) along: f64,
    pub(super) across: f64,
}

/// What surfaces give at a share of their travel, over what they give at full travel.
fn given(torque: f64) -> f64 {
    torque * (1.0 - LOST * torque.abs()) / (1.0 - LOST)
}

impl Sample {
    fn speed(&self) -> f64 {
        self.along.hypot(self.across)
    }

    /// Rows count less the faster they are: gusts turn it as V.
    fn weight(&self) -> f64 {
        1.0 / (SLOW + self.speed())
    }

    /// What this much of a full torque, or of a rate, is multiplied by.
    fn of_torque(&self, much: f64) -> [f64; OF_TORQUE] {
        let blown = self.along.powi(2) - STALLED * self.across.powi(2);
        let blown = if self.along > 0.0 {
            blown.max(0.0)
        } else {
            0.0
        };
        [self.thrust, blown].map(|effect| self.weight() * effect * much)
    }

    /// All else, of a nose that has turned by these `angles` lately \[rad\].
    fn others(&self, angles: [f64; LATELY.len()]) -> [f64; OTHERS] {
        let (v, w, rate) = (self.speed(), self.across, self.rate);
        let mut of = [0.0; OTHERS];
        of[..7].copy_from_slice(&[
            1.0,
            self.thrust,
            v * v,
            v * w,
            self.along * w,
            rate,
            v * rate,
        ]);
        for (of, angle) in of[7..].chunks_exact_mut(3).zip(angles) {
            of.copy_from_slice(&[angle, v * angle, v * v * angle]);
        }
        of.map(|x| self.weight() * x)
    }
}

/// What the nose has turned lately \[rad\], at each row.
fn angles(all: &[Sample]) -> Vec<[f64; LATELY.len()]> {
    let (mut angles, mut last): (_, Option<f64>) = ([0.0; LATELY.len()], None);
    let next = all.iter().map(|sample| {
        let dt = (sample.t - last.replace(sample.t).unwrap_or(sample.t)).min(GAP);
        for (angle, lately) in angles.iter_mut().zip(LATELY) {
            *angle = *angle * (-dt / lately).exp() + dt * sample.rate;
        }
        angles
    });
    next.collect()
}

/// What a full torque gives at rest at a thrust of the weight [rad/s²]; none where there are too few samples, or the torque rests.
pub(super) fn full_torque(all: &[Sample]) -> Option<Measured> {
    let times: Vec<f64> = all.iter().map(|sample| sample.t).collect();
    let Even { spacing, mut known } = Even::of(&times, ASKED)?;
    // A row's turn is up to the next.
    known.retain(|n| {
        all.get(n + 1)
            .is_some_and(|next| next.t - all[*n].t < 1.5 * spacing)
    });
    let squares = known.iter().map(|n| all[*n].torque.powi(2)).sum::<f64>();
    if known.len() < ROWS || (squares / known.len() as f64).sqrt() < MOVES {
        return None;
    }
    let angles = angles(all);
    let matrix = |columns: usize, row: &dyn Fn(usize) -> Vec<f64>| {
        DMatrix::from_row_iterator(known.len(), columns, known.iter().flat_map(|n| row(*n)))
    };
    let mut wanted = matrix(OTHERS + ASKED * OF_TORQUE, &|n| {
        let asked = (0..ASKED).flat_map(|i| all[n].of_torque(all[n - i].asked));
        all[n].others(angles[n]).into_iter().chain(asked).collect()
    });
    for mut column in wanted.column_iter_mut() {
        column /= column.norm().max(1e-12);
    }
    let gram = wanted.tr_mul(&wanted).svd(true, true);
    let turns = known.iter().map(|&n| {
        let [this, next] = [&all[n], &all[n + 1]];
        this.weight() * (next.rate - this.rate) / (next.t - this.t)
    });
    let turns = DVector::from_iterator(known.len(), turns);
    let blocks: Vec<usize> = known.iter().map(|n| (all[*n].t / BLOCK) as usize).collect();
    let fit = |lag: f64| -> Option<Fit> {
        let torques = behind(all.iter().map(|of| [of.t, given(of.torque)]), lag);
        let told = matrix(OF_TORQUE + OTHERS, &|n| {
            let of_torque = all[n]
                .of_torque(0.5 * (torques[n].value + torques[n + 1].value))
                .into_iter();
            of_torque.chain(all[n].others(angles[n])).collect()
        });
        let seen = gram.solve(&wanted.tr_mul(&told), 1e-12).ok()?;
        least_squares(&(&wanted * seen), &told, &turns, &blocks)
    };
    let tried = LAGS.iter().filter_map(|lag| fit(*lag));
    let best = tried.min_by(|a, b| a.squares.total_cmp(&b.squares))?;
    Some(best.measured(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::LACKING;

    /// A minute of hover, in gusts that last and that the loop answers: of steps of the rate that ask for a quarter of the torque what a full one gives is found, in the
    /// interval that flights are given, at the thrust of the weight and not at the one that was flown. A torque that rests shows nothing.
    #[test]
    fn what_a_full_torque_gives_is_found_in_gusts() {
        let (full, thrust, servo, dt) = (40.0, 1.3, 0.035, 0.005);
        let flown = |step: f64| -> Vec<Sample> {
            let [mut rate, mut surface, mut attitude, mut gust] = [0.0; 4];
            let mut seed = 1_u32;
            let rows = (0..6000).map(|k| {
                let asked = if k / 80 % 2 == 0 { step } else { -step } - 2.0 * attitude;
                let sample = Sample {
                    t: 2.0 * dt * f64::from(k),
                    asked,
                    rate,
                    torque: surface,
                    thrust,
                    along: 0.0,
                    across: 0.0,
                };
                for _ in 0..2 {
                    seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    let noise = f64::from(seed) / f64::from(u32::MAX) - 0.5;
                    gust += 0.02 * (40.0 * noise - gust);
                    surface += dt / servo * (0.3 * (asked - rate) - surface);
                    rate += dt * (thrust * full * given(surface) + gust);
                    attitude += dt * rate;
                }
                sample
            });
            rows.collect()
        };
        let samples = flown(0.8);
        let found = full_torque(&samples).unwrap().lacking(LACKING.torque);
        assert!((found.value - full).abs() < found.within, "{found:?}");
        assert!(found.within < 0.25 * full, "{found:?}");
        let rests = |sample: &Sample| Sample {
            torque: 0.0,
            ..*sample
        };
        assert_eq!(
            full_torque(&samples.iter().map(rests).collect::<Vec<_>>()),
            None
        );
    }
}
