//! Gains by bandwidth (not in the paper).

use super::parameters::GuidanceParameters;
use crate::aero::Aerodynamics;
use crate::control::{GainLaw, GainValues, Gains, Guard};
use crate::error::ParameterError;
use crate::vehicle::Vehicle;

/// Validated gains by bandwidth: the loop's natural frequency, damping and thrust-axis rate are what is set, and the
/// gains follow |F_p|.
///
/// Across the thrust line the law makes, at small θ̃ and with |F_p| constant, m ṽ̇_2 = |F_p| θ̃ and
/// θ̃̇ = −k2 |F_p| ṽ_2 − (k3/4) θ̃: a natural frequency √(k2/m)·|F_p| and a damping k3/(8 ω_n). Along it
/// m ṽ̇_1 = −k1 |F_p| ṽ_1. With the paper's constant gains the frequency grows with |F_p|, ten-fold from hover to
/// 20 m/s, and the damping ratio falls as fast. Here
///
/// k1 = m ω_v / f, k2 = m ω_n² / f², k3 = 8 ζ ω_n, f = max(|F_p|, floor),
///
/// so that both stay what they are set to wherever |F_p| is above the floor, and fall with |F_p| below it.
///
/// What becomes of the paper's proof:
/// - at any |F_p| the command is that of the constant gains with these values, so the law is defined everywhere and its
///   equilibria are the same; at an equilibrium, where ṽ = 0 and F̄_p2 = 0, the derivatives of the gains are multiplied by
///   zero, so the linearisation is that of the constant gains frozen there: local asymptotic stability carries over;
/// - the Lyapunov identity does not: with V = (m/2)|ṽ|² + (1 − cos θ̃)/k2, V̇ gains the term
///   (1 − cos θ̃) d(1/k2)/dt, whose sign is that of d|F_p|/dt. It is of third order at an equilibrium, so V still
///   decides there, but the paper's domain of attraction is not proved for these gains: it is shown by flights only;
/// - rate-loop lag, thrust lag and limits are in neither proof. With a first-order rate loop of time constant T the
///   transverse loop T s³ + s² + 2ζω_n s + ω_n² is stable iff T ω_n < 2ζ; choose ω_n with that in mind.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BandwidthGains {
    /// m ω_v [kg/s].
    along: f32,
    /// m ω_n² [kg/s²].
    across: f32,
    k3: f32,
    gain_schedule_floor: f32,
    guard: Guard,
}

impl BandwidthGains {
    /// The gains that give `vehicle` the loop of these parameters: `natural_frequency`, `damping`, `thrust_rate`,
    /// `gain_schedule_floor`, `tau`.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new<A: Aerodynamics>(
        p: &GuidanceParameters,
        vehicle: &Vehicle<A>,
    ) -> Result<Self, ParameterError> {
        p.check_all()?;
        Ok(Self {
            along: vehicle.mass() * p.thrust_rate,
            across: vehicle.mass() * p.natural_frequency * p.natural_frequency,
            k3: 8.0 * p.damping * p.natural_frequency,
            gain_schedule_floor: p.gain_schedule_floor * vehicle.weight(),
            guard: Guard::new(p.tau * vehicle.weight())?,
        })
    }
}

impl GainLaw for BandwidthGains {
    #[inline(always)]
    fn at(&self, f_p_norm: f32) -> GainValues {
        let force = if f_p_norm > self.gain_schedule_floor {
            f_p_norm
        } else {
            self.gain_schedule_floor
        };
        let inverse = 1.0 / force;
        GainValues {
            k1: self.along * inverse,
            k2: self.across * inverse * inverse,
            k3: self.k3,
        }
    }

    #[inline(always)]
    fn guard(&self) -> &Guard {
        &self.guard
    }
}

/// Gains chosen at run time, where the choice is data: an experiment file, a parameter block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GainChoice {
    /// Constant, as in the paper.
    Constant(Gains),
    /// By bandwidth.
    Bandwidth(BandwidthGains),
}

impl GainLaw for GainChoice {
    #[inline(always)]
    fn at(&self, f_p_norm: f32) -> GainValues {
        match self {
            Self::Constant(g) => g.at(f_p_norm),
            Self::Bandwidth(g) => g.at(f_p_norm),
        }
    }

    #[inline(always)]
    fn guard(&self) -> &Guard {
        match self {
            Self::Constant(g) => GainLaw::guard(g),
            Self::Bandwidth(g) => g.guard(),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::control::{Reference, State, VelocityControl};
    use crate::frame::{Attitude, Inertial};
    use crate::vehicle::VehicleParameters;

    fn vehicle() -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Vehicle::new(VehicleParameters::PAPER, model).unwrap()
    }

    /// ω_n² = k2|F_p|²/m and k3 = 8ζω_n are read off the law itself, by differences of its command around trim.
    #[test]
    fn the_loop_has_the_set_bandwidth_in_hover_and_in_cruise() {
        let p = GuidanceParameters::default();
        let vehicle = vehicle();
        let law = VelocityControl::new(vehicle, BandwidthGains::new(&p, &vehicle).unwrap());
        // θ of trim: hover; and level flight at 20 m/s, found by bisection of F̄_p2.
        let j = |theta: f32, forward: f32| {
            let state = State {
                velocity: Inertial::new(0.0, forward),
                attitude: Attitude::from_angle(theta),
                wind: Inertial::ZERO,
            };
            let reference = Reference {
                velocity: state.velocity,
                acceleration: Inertial::ZERO,
            };
            (state, law.robust(&state, &reference, None).unwrap())
        };
        let (mut low, mut high) = (-1.55f32, -1.45f32);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if j(middle, 20.0).1.diagnostics.f_p.j() > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        for (theta, forward) in [(0.0, 0.0), (low, 20.0)] {
            let (state, command) = j(theta, forward);
            let norm = command.diagnostics.f_p_norm;
            assert!(norm > p.gain_schedule_floor * vehicle.weight());
            // A velocity error of 0.1 m/s along j, then along i.
            let error = |i, j| {
                let offset = state.attitude.to_inertial(crate::frame::Body::new(i, j));
                let reference = Reference {
                    velocity: state.velocity - offset,
                    acceleration: Inertial::ZERO,
                };
                law.robust(&state, &reference, None).unwrap()
            };
            let k2 = (error(0.0, 0.1).rate - command.rate) / (0.1 * norm);
            let frequency = (k2 * norm * norm / vehicle.mass()).sqrt();
            // 1e-3: differences of single-precision commands.
            assert!((frequency / p.natural_frequency - 1.0).abs() < 1e-3);
            let push = (error(0.1, 0.0).thrust - command.thrust) / 0.1;
            assert!((push / vehicle.mass() / p.thrust_rate - 1.0).abs() < 1e-3);
            // A misalignment of 1°: the paper's term k3|F_p|F̄_p2/(|F_p|+F̄_p1)² is (k3/4)θ̃ to second order.
            let (_, turned) = j(theta + 1f32.to_radians(), forward);
            let tilde = turned.diagnostics.theta_tilde();
            let damping = turned.rate / tilde / (2.0 * p.natural_frequency);
            assert!((damping / p.damping - 1.0).abs() < 1e-3, "{damping}");
        }
    }

    #[test]
    fn below_the_floor_the_gains_are_those_at_the_floor() {
        let (p, vehicle) = (GuidanceParameters::default(), vehicle());
        let gains = BandwidthGains::new(&p, &vehicle).unwrap();
        let floor = p.gain_schedule_floor * vehicle.weight();
        assert_eq!(gains.at(0.0), gains.at(floor));
        assert!(gains.at(1.02 * floor).k2 < gains.at(floor).k2);
        assert!(gains.at(f32::NAN).k1.is_finite());
    }

    /// A vehicle a hundred times lighter, at the same multiple of its weight: the same loop.
    #[test]
    fn the_floor_and_the_guard_follow_the_weight() {
        let p = GuidanceParameters::default();
        let light = VehicleParameters {
            mass: 0.1,
            k_a: 0.00646,
            thrust_max: 1.962,
            ..VehicleParameters::PAPER
        };
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let light = Vehicle::new(light, model).unwrap();
        let (small, large) = (
            BandwidthGains::new(&p, &light).unwrap(),
            BandwidthGains::new(&p, &vehicle()).unwrap(),
        );
        for multiple in [0.1, 0.5, 1.0, 3.0] {
            let force = multiple * light.weight();
            let (a, b) = (small.at(force), large.at(100.0 * force));
            // 1e-5: roundings of a dozen products.
            assert!((a.k1 / b.k1 - 1.0).abs() < 1e-5);
            assert!((a.k2 / b.k2 / 100.0 - 1.0).abs() < 1e-5);
        }
        let tau = |gains: &BandwidthGains| gains.guard().tau();
        assert!((tau(&large) / tau(&small) / 100.0 - 1.0).abs() < 1e-5);
    }

    #[test]
    fn bad_parameters_are_named() {
        let bad = GuidanceParameters {
            damping: f32::NAN,
            ..GuidanceParameters::default()
        };
        let error = BandwidthGains::new(&bad, &vehicle()).unwrap_err();
        assert_eq!(error.parameter, "damping");
    }
}
