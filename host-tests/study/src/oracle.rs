//! What a fall costs one who knows the plant: a search over recoveries flown by hand, of the same vehicle from the same start.
//!
//! A recovery knows the true state and air, and flies by the vehicle's own inner loop at its greatest rate, not at that of the guidance. It is
//!
//! 1. a **dive**: the nose goes to the velocity, which the air helps, at full thrust or none, until there is airflow along the nose,
//! 2. a **pull-up** at full thrust: lift up or, on the back, as it lies, at one angle of attack, and no more than so much of it, and
//! 3. a **hover**: the nose goes up, thrust stops the sink, and the vehicle leans against its velocity.
//!
//! Three numbers and two choices are looked for on a grid, for each fall anew. The least height that any of them loses is an upper bound of what has to be lost:
//! a better recovery may exist.

use alula_sim::experiment::tail_sitter::Mixer;
use alula_sim::experiment::{Experiment, State, V3, from_frd};
use alula_sim::plant::Command;
use alula_sim::plant::tail_sitter::TailSitter;
use alula_sim::simulate::Flight;

/// One recovery.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recovery {
    /// Airspeed along the nose at which the dive ends \[m/s\]; zero leaves it out, and the pull-up with it.
    pub gathered_m_s: f64,
    /// Part of the greatest thrust in the dive.
    pub thrust: f64,
    /// Angle of attack of the pull-up \[°\].
    pub alpha_deg: f64,
    /// Airspeed below which the nose goes up \[m/s\].
    pub slow_m_s: f64,
    /// Whether it rolls upright where it is on its back.
    pub upright: bool,
}

/// What a recovery came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recovered {
    /// Height lost \[m\].
    pub height_lost_m: f64,
    /// By which recovery.
    pub recovery: Recovery,
}

/// Speeds at which a dive ends, angles of attack of a pull-up and speeds below which the nose goes up, for a vehicle with a cruise of 24 m/s: speeds are in
/// proportion to its cruise.
const GATHERED: [f64; 5] = [0.0, 8.0, 12.0, 16.0, 20.0];
const ALPHAS: [f64; 4] = [8.0, 12.0, 16.0, 25.0];
const SLOW: [f64; 2] = [6.0, 10.0];
const CRUISE: f64 = 24.0;

/// How long a recovery may take \[s\], and how long a hover has to last until it is one \[s\].
const LONGEST: f64 = 30.0;
const HELD: f64 = 1.0;
/// Speed \[m/s\] and cosine of the nose from up within which it hovers.
const AT_REST: f64 = 6.0;
const NEARLY_UP: f64 = 0.7;
/// Rate of a turn per angle \[1/s\].
const GAIN: f64 = 4.0;
/// Vertical acceleration per sink, over g [s/m]; and lean per speed [s/m], and the greatest.
const SINK: f64 = 0.15;
const LEAN: f64 = 0.05;
const MOST_LEAN: f64 = 0.3;

const UP: V3 = V3::new(0.0, 0.0, -1.0);

#[derive(Clone, Copy, PartialEq)]
enum Phase {
    Dive,
    Pull,
    Hover,
}

/// The recovery that loses the least height of those on the grid, from the start of `experiment`, whose plant is a tail-sitter in calm air. `None` if
/// none ends in hover within `most_m` \[m\].
pub fn best(experiment: &Experiment, most_m: f64) -> anyhow::Result<Option<Recovered>> {
    let mut best: Option<Recovered> = None;
    for recovery in grid(experiment) {
        let bound = best.map_or(most_m, |best| best.height_lost_m);
        if let Some(height_lost_m) = recovery.height_lost(experiment, bound)? {
            best = Some(Recovered {
                height_lost_m,
                recovery,
            });
        }
    }
    Ok(best)
}

fn grid(experiment: &Experiment) -> Vec<Recovery> {
    let cruise = experiment
        .tail_sitter
        .as_ref()
        .map_or(CRUISE, |plant| plant.true_vehicle().cruise_speed_m_s);
    let scale = cruise / CRUISE;
    let mut all = Vec::new();
    for gathered in GATHERED {
        for slow in SLOW {
            for alpha_deg in ALPHAS {
                for thrust in [1.0, 0.0] {
                    for upright in [true, false] {
                        all.push(Recovery {
                            gathered_m_s: scale * gathered,
                            thrust,
                            alpha_deg,
                            slow_m_s: scale * slow,
                            upright,
                        });
                    }
                }
            }
        }
    }
    // Without a dive the other numbers are of no account.
    let mut seen = false;
    all.retain(|r| r.gathered_m_s > 0.0 || !std::mem::replace(&mut seen, true));
    all
}

impl Recovery {
    /// The height that it loses from the start of `experiment` \[m\], if it ends in hover before it has lost `most_m`.
    pub fn height_lost(&self, experiment: &Experiment, most_m: f64) -> anyhow::Result<Option<f64>> {
        let Some(plant) = &experiment.tail_sitter else {
            anyhow::bail!("the plant is no tail-sitter");
        };
        let vehicle = plant.true_vehicle();
        let weight = vehicle.mass_kg * experiment.vehicle.gravity_m_s2;
        let full = TailSitter::new(vehicle.clone(), None).static_thrust();
        // Differences of thrust turn the most at half of it, and nothing at full thrust.
        let full = match vehicle.mixer {
            Mixer::DifferentialThrust => (0.5 * full).max(1.1 * weight),
            Mixer::Elevons | Mixer::Both => full,
        };
        let rate = vehicle.rate_loop.rate_max_rad_s;
        let mut flight = Flight::new(experiment)?;
        let start = flight.plant().state().position.z;
        let (mut deepest, mut held, mut phase) = (0.0_f64, 0.0, Phase::Dive);
        if self.gathered_m_s == 0.0 {
            phase = Phase::Hover;
        }
        let period = 1.0 / experiment.control_rate_hz;
        while flight.time() < LONGEST {
            let state = *flight.plant().state();
            deepest = deepest.max(state.position.z - start);
            if !state.is_sound() || deepest >= most_m {
                return Ok(None);
            }
            let [tail, ..] = state.axes();
            let hovers = state.velocity.norm() < AT_REST && -tail.dot(&UP) > NEARLY_UP;
            held = if hovers { held + period } else { 0.0 };
            if held > HELD {
                return Ok(Some(deepest));
            }
            phase = self.next(phase, &state);
            let (thrust, rates) = self.asked(phase, &state, weight, full);
            flight.apply(Command {
                thrust,
                rates: from_frd(rates.map(|x| x.clamp(-rate, rate))),
            });
        }
        Ok(None)
    }

    fn next(&self, phase: Phase, state: &State) -> Phase {
        let [tail, ..] = state.axes();
        let (speed, along) = (state.velocity.norm(), -tail.dot(&state.velocity));
        let climb = -state.velocity.z / speed.max(1e-3);
        match phase {
            Phase::Dive if along >= self.gathered_m_s && along > 0.9 * speed => Phase::Pull,
            Phase::Pull if speed < self.slow_m_s || climb > 0.9 => Phase::Hover,
            Phase::Hover
                if self.gathered_m_s > 0.0 && climb < -0.5 && speed > 1.5 * self.slow_m_s =>
            {
                Phase::Dive
            }
            same => same,
        }
    }

    /// Thrust \[N\], and rates about forward, right and down \[rad/s\].
    fn asked(&self, phase: Phase, state: &State, weight: f64, full: f64) -> (f64, [f64; 3]) {
        let [tail, belly, right] = state.axes();
        let (nose, v) = (-tail, state.velocity);
        let along = v.normalize();
        let (thrust, aim, roll) = match phase {
            Phase::Hover => {
                let level = V3::new(v.x, v.y, 0.0);
                let lean = level * (LEAN).min(MOST_LEAN / level.norm().max(1e-3));
                let stop = weight * (1.0 + SINK * v.z);
                let thrust = stop / nose.dot(&UP).max(0.5);
                (thrust.clamp(0.1 * weight, full), UP - lean, 0.0)
            }
            Phase::Dive | Phase::Pull => {
                // The side that the lift is to point to: up, across the velocity.
                let across = UP - along * along.dot(&UP);
                let lift = if across.norm() > 1e-3 {
                    across.normalize()
                } else {
                    -belly
                };
                let side = if self.upright || belly.dot(&lift) <= 0.0 {
                    1.0
                } else {
                    -1.0
                };
                // Roll turns the right wing to the belly.
                let wanted = lift.cross(&along) * -side;
                let roll = wanted.dot(&belly).atan2(wanted.dot(&right));
                if phase == Phase::Dive {
                    (self.thrust * full, along, roll)
                } else {
                    let alpha = self.alpha_deg.to_radians() * roll.cos().max(0.0);
                    (full, along * alpha.cos() + lift * alpha.sin(), roll)
                }
            }
        };
        let axis = nose.cross(&aim);
        let angle = axis.norm().atan2(nose.dot(&aim));
        let turn = if axis.norm() > 1e-6 {
            axis.normalize() * angle
        } else {
            right * angle
        };
        let rates = [roll, turn.dot(&right), turn.dot(&belly)];
        (thrust, rates.map(|x| GAIN * x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::experiment::Document;

    /// 12 m/s down, nose level, motors at rest: a vehicle of 2.4 kg is back within 20 m. Within a metre it cannot be.
    #[test]
    fn a_fall_is_recovered_from() {
        let experiment = Document::load("tail-sitter-fall")
            .unwrap()
            .checked()
            .unwrap();
        let best = best(&experiment, 60.0).unwrap().unwrap();
        assert!(
            best.height_lost_m > 5.0 && best.height_lost_m < 60.0,
            "{best:?}"
        );
        assert!(super::best(&experiment, 1.0).unwrap().is_none());
    }
}
