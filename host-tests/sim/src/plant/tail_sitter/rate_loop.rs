//! The autopilot's inner loop: body rates by a PID or incrementally, and the mixer.
//!
//! All in the vehicle's axes forward, right, down; a torque is a share of full deflection or full difference of thrust, from −1 to 1,
//! so that the loop gain follows the slipstream and the airspeed, as it does on the real ones.

use crate::experiment::V3;
use crate::experiment::tail_sitter::{Mixer, RateLaw, RateLoop};

/// What is missing of a full torque and is not meant: with the sign of a rounding the integral would wait now and then.
const ROUNDING: f64 = 1e-9;

/// What the inner loop remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateLoopState {
    integral: V3,
    /// Rates measured last; none before the first step.
    rates: Option<V3>,
    /// ω̇, filtered.
    acceleration: V3,
    /// Torque given, filtered alike.
    torque: V3,
    /// What the mixer could not give at the last step.
    missing: V3,
}

impl RateLoop {
    /// Torques from rates asked for and had, one period on.
    pub fn torque(&self, state: &mut RateLoopState, asked: V3, rates: V3) -> V3 {
        let dt = 1.0 / self.rate_hz;
        let share = 1.0 - libm::exp(-2.0 * std::f64::consts::PI * self.cutoff_hz * dt);
        let fresh = state.rates.map_or(V3::zeros(), |last| (rates - last) / dt);
        state.rates = Some(rates);
        state.acceleration += share * (fresh - state.acceleration);
        let error = asked - rates;
        let torque = match self.law {
            RateLaw::Pid {
                p,
                i,
                d,
                feed_forward,
            } => {
                let [p, i, d, feed_forward] = [p, i, d, feed_forward].map(V3::from);
                for axis in 0..3 {
                    // At its stop an axis does not wind up; it unwinds.
                    if state.missing[axis] * error[axis] <= 0.0 {
                        let step = i[axis] * error[axis] * dt;
                        state.integral[axis] = (state.integral[axis] + step).clamp(-0.5, 0.5);
                    }
                }
                p.component_mul(&error) + state.integral - d.component_mul(&state.acceleration)
                    + feed_forward.component_mul(&asked)
            }
            RateLaw::Incremental {
                gain_1_s,
                effectiveness_rad_s2,
            } => {
                let wanted = V3::from(gain_1_s).component_mul(&error);
                let change = wanted - state.acceleration;
                state.torque + change.component_div(&V3::from(effectiveness_rad_s2))
            }
        };
        torque.map(|x| x.clamp(-1.0, 1.0))
    }

    /// Told what the mixer gave of `asked`.
    pub fn given(&self, state: &mut RateLoopState, asked: V3, given: V3) {
        let dt = 1.0 / self.rate_hz;
        let share = 1.0 - libm::exp(-2.0 * std::f64::consts::PI * self.cutoff_hz * dt);
        state.missing = (asked - given).map(|x| if x.abs() > ROUNDING { x } else { 0.0 });
        state.torque += share * (given - state.torque);
    }
}

impl RateLoopState {
    /// What the mixer could not give at the last step, as shares of full torque about (forward, right, down).
    pub fn missing(&self) -> V3 {
        self.missing
    }
}

/// What the mixer sends to the actuators.
#[derive(Clone, Debug, PartialEq)]
pub struct Allocation {
    /// Share of its static thrust that each motor is asked for, 0 to 1.
    pub motors: Vec<f64>,
    /// Share of its travel that the left and the right elevon are asked for, −1 to 1, positive trailing edge towards the belly.
    pub elevons: [f64; 2],
    /// The torque that this is.
    pub given: V3,
}

/// Where a motor stands, as the mixer sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// To the right of the centre of mass, over the rightmost one's distance.
    pub right: f64,
    /// Below it, over the lowest one's.
    pub down: f64,
    /// Sense of rotation.
    pub turns: f64,
}

impl Mixer {
    /// Torque and collective thrust, a share of the static thrust, to actuators. The collective is kept, and differences of thrust are
    /// scaled to what there is beside it: without thrust there is none.
    pub fn allocate(self, motors: &[Motor], collective: f64, torque: V3) -> Allocation {
        let collective = collective.clamp(0.0, 1.0);
        // Thrust on the right turns the nose to the left, thrust below turns it up; a propeller's reaction is against its turn.
        let levers = |motor: &Motor| match self {
            Self::Elevons => -torque.z * motor.right,
            Self::Both | Self::DifferentialThrust => {
                -torque.z * motor.right + torque.y * motor.down
            }
        };
        let reaction = |motor: &Motor| match self {
            Self::DifferentialThrust => -torque.x * motor.turns,
            Self::Elevons | Self::Both => 0.0,
        };
        let room = collective.min(1.0 - collective);
        let most =
            |of: &dyn Fn(&Motor) -> f64| motors.iter().map(|m| of(m).abs()).fold(0.0, f64::max);
        // Full torque asks for the whole room. Two axes share it, and the reaction, which is weak, takes what they leave.
        let scale = 1.0 / most(&levers).max(1.0);
        let left = 1.0 - scale * most(&levers);
        let weak = left.min(most(&reaction)) / most(&reaction).max(f64::MIN_POSITIVE);
        let motors = motors
            .iter()
            .map(|m| collective + room * (scale * levers(m) + weak * reaction(m)));
        let motors = motors.collect();
        match self {
            Self::DifferentialThrust => Allocation {
                motors,
                elevons: [0.0; 2],
                given: V3::new(weak * torque.x, scale * torque.y, scale * torque.z),
            },
            Self::Elevons | Self::Both => {
                // Trailing edges up, towards the back, turn the nose up; the right one up rolls to the right.
                let [left, right] = [torque.x - torque.y, -torque.x - torque.y];
                let elevons = [left, right].map(|x: f64| x.clamp(-1.0, 1.0));
                let given = V3::new(
                    0.5 * (elevons[0] - elevons[1]),
                    -0.5 * (elevons[0] + elevons[1]),
                    scale * torque.z,
                );
                Allocation {
                    motors,
                    elevons,
                    given,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAIR: [Motor; 2] = [
        Motor {
            right: -1.0,
            down: 0.0,
            turns: 1.0,
        },
        Motor {
            right: 1.0,
            down: 0.0,
            turns: -1.0,
        },
    ];

    /// What the mixer says that it gave is what its actuators are, and it says what is missing.
    #[test]
    fn a_full_elevon_is_said() {
        let asked = V3::new(0.5, 0.8, 0.3);
        let a = Mixer::Elevons.allocate(&PAIR, 0.5, asked);
        assert!((a.elevons[0] + 0.3).abs() < 1e-12 && a.elevons[1] == -1.0);
        assert!((a.given - V3::new(0.35, 0.65, 0.3)).norm() < 1e-12);
        assert!((a.motors[0] - 0.65).abs() < 1e-12 && (a.motors[1] - 0.35).abs() < 1e-12);
    }

    /// Without thrust there is no difference of it, and at full thrust none either; in between none leaves 0 to 1.
    #[test]
    fn differences_of_thrust_need_thrust() {
        for collective in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let asked = V3::new(0.4, -1.0, 0.7);
            let a = Mixer::DifferentialThrust.allocate(&PAIR, collective, asked);
            assert!(a.motors.iter().all(|m| (0.0..=1.0).contains(m)));
            let sum: f64 = a.motors.iter().sum();
            assert!((sum - 2.0 * collective).abs() < 1e-12);
        }
        let a = Mixer::DifferentialThrust.allocate(&PAIR, 0.0, V3::new(0.0, 1.0, 1.0));
        assert_eq!(a.motors, [0.0, 0.0]);
    }

    fn pid() -> RateLoop {
        RateLoop {
            rate_hz: 250.0,
            rate_max_rad_s: 10.0,
            cutoff_hz: 30.0,
            law: RateLaw::Pid {
                p: [0.1; 3],
                i: [0.5; 3],
                d: [0.0; 3],
                feed_forward: [0.0; 3],
            },
        }
    }

    /// An integral at its stop waits, and unwinds at once when the error turns.
    #[test]
    fn the_integral_does_not_wind_up_against_a_stop() {
        let (law, mut state) = (pid(), RateLoopState::default());
        for _ in 0..1000 {
            let asked = law.torque(&mut state, V3::new(0.0, 9.0, 0.0), V3::zeros());
            law.given(&mut state, asked, 0.5 * asked);
        }
        // One step before the stop was told.
        assert!((state.integral.y - 0.5 * 9.0 / 250.0).abs() < 1e-9);
        law.torque(&mut state, V3::new(0.0, -9.0, 0.0), V3::zeros());
        assert!(state.integral.y.abs() < 1e-9);
    }

    /// On a pure integrator of the believed effectiveness the incremental law is a first-order lag of 1/K.
    #[test]
    fn the_incremental_law_is_a_first_order_lag() {
        let law = RateLoop {
            rate_hz: 1000.0,
            rate_max_rad_s: 10.0,
            cutoff_hz: 50.0,
            law: RateLaw::Incremental {
                gain_1_s: [8.0; 3],
                effectiveness_rad_s2: [40.0; 3],
            },
        };
        let (mut state, mut rates) = (RateLoopState::default(), V3::zeros());
        let asked = V3::new(0.0, 0.5, 0.0);
        for _ in 0..125 {
            let torque = law.torque(&mut state, asked, rates);
            law.given(&mut state, torque, torque);
            rates += 40.0 * torque * 1e-3;
        }
        // 0.03: the filter of 50 Hz delays by 3 ms of the 125 ms.
        assert!(
            (rates.y / 0.5 - (1.0 - (-1.0_f64).exp())).abs() < 0.03,
            "{rates}"
        );
    }
}
