//! Which [`Branch`] is flown.
//!
//! The law stabilises θ̃ = 0, where T_p = |F_p|. In a steep descent faster than the fall at which F_p vanishes, F_p
//! points up: on θ̃ = 0 the vehicle would turn nose down and need negative thrust there, while tail first with
//! positive thrust it stands on θ̃ = π. The paper leaves the choice open; this module makes it.

use super::parameters::GuidanceParameters;
use crate::branch::Branch;
use crate::equivalency::ApparentForces;
use crate::math;

/// Chooses the branch, and lets the command pass from one to the other without a jump.
///
/// At hand are F_p, F and thus F·i, the thrust that the present attitude would need in equilibrium. If F_p lies
/// within 90° of the flown branch, that branch's equilibrium is the nearer one, and F·i < 0 there says that it
/// needs negative thrust. If it lies beyond, the nearer equilibrium is the other branch's, and F·i > 0 says that
/// it is that one which has positive thrust: then the branch is switched. Exact for an equivalent sphere; for
/// another vehicle as good as F_p is independent of the attitude between here and the equilibrium, and exact
/// again as the vehicle arrives there.
///
/// T = −|F_p| − λ k_a|v_a|² at θ̃ = π: for that to be positive λ must be negative. The large-α model has that where
/// the air comes from behind, |α| > 90°. Every wing has it in the stall too, between two folds, but there F_p lies
/// against the thrust over some degrees of attitude only: so θ̃ = 0 is left only with the air from behind.
///
/// A switch is thus only made where the vehicle already stands nearer to the other equilibrium. A reference that
/// would have it turn around in the air, such as braking in cruise harder than drag, is reported and not obeyed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BranchSwitch {
    hysteresis: f32,
    inverse_fade: f32,
}

/// The branch flown, and what is left of the last switch's jump.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BranchState {
    /// 1 on θ̃ = π, else 0. Numbers, not `enum` and `bool`: every bit pattern has a meaning.
    opposed: u8,
    /// 1 if the branch is new, and the jump is still to be measured.
    arrived: u8,
    /// Angular rate [rad/s] still to fade out.
    pub(super) offset: f32,
}

impl BranchState {
    /// The branch flown.
    #[inline(always)]
    pub fn branch(&self) -> Branch {
        if self.opposed == 1 {
            Branch::Opposed
        } else {
            Branch::Aligned
        }
    }
}

/// Greatest jump of the angular rate [rad/s] that is faded out.
const MAX_OFFSET: f32 = 1e3;

/// Verdict on the flown branch at one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Its equilibrium has thrust that is not negative.
    Positive,
    /// Its equilibrium needs negative thrust.
    Negative,
    /// It does, and the vehicle stands nearer to the other branch's, which does not.
    Other,
}

impl BranchSwitch {
    /// The switch with these parameters, which have been checked, for a vehicle of this `weight` \[N\].
    pub fn new(p: &GuidanceParameters, weight: f32) -> Self {
        Self {
            hysteresis: p.branch_hysteresis * weight,
            inverse_fade: 1.0 / p.branch_fade,
        }
    }

    /// The verdict on `branch` at `forces`.
    #[inline(always)]
    pub(super) fn judge(&self, branch: Branch, forces: &ApparentForces) -> Verdict {
        let along = branch.sign() * forces.f_p.i();
        let thrust = forces.f.i();
        if along > 0.0 {
            if thrust < 0.0 {
                Verdict::Negative
            } else {
                Verdict::Positive
            }
        } else if along < -self.hysteresis
            && thrust > 0.0
            && (branch == Branch::Opposed || forces.air.cos < 0.0)
        {
            Verdict::Other
        } else {
            Verdict::Positive
        }
    }

    /// Goes to the other branch from the next step on.
    #[inline]
    pub(super) fn leave(&self, state: &mut BranchState) {
        state.opposed = u8::from(state.branch() == Branch::Aligned);
        state.arrived = 1;
    }

    /// Whether what is left to fade out is no more than the greatest jump. NaN is not.
    #[inline(always)]
    pub(super) fn is_sound(&self, state: &BranchState) -> bool {
        state.offset.abs() <= MAX_OFFSET
    }

    /// `rate` [rad/s] of the flown branch plus what is left of the last switch's jump from the rate `last` commanded.
    #[inline(always)]
    pub(super) fn smooth(&self, state: &mut BranchState, rate: f32, last: f32, dt: f32) -> f32 {
        if state.arrived != 0 {
            state.offset = math::clamp(last - rate, -MAX_OFFSET, MAX_OFFSET);
            state.arrived = 0;
        }
        let rate = rate + state.offset;
        // Implicit Euler: never changes sign, whatever dt.
        state.offset /= 1.0 + dt * self.inverse_fade;
        rate
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::control::{Command, GainParameters, Gains, Reference, State, VelocityControl};
    use crate::frame::{Attitude, Inertial};
    use crate::vehicle::{Vehicle, VehicleParameters};

    /// A hysteresis of 5 N and a fade of 0.2 s.
    fn switch() -> BranchSwitch {
        let p = GuidanceParameters {
            branch_hysteresis: 0.05,
            branch_fade: 0.2,
            ..GuidanceParameters::default()
        };
        BranchSwitch::new(&p, 100.0)
    }

    fn law() -> VelocityControl<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
        VelocityControl::new(vehicle, Gains::new(GainParameters::PAPER).unwrap())
    }

    /// Nose at `theta`, moving at `v`, which is the reference; acceleration asked for `a_r`.
    fn at(branch: Branch, theta: f32, v: Inertial, a_r: Inertial) -> (Command, ApparentForces) {
        let state = State {
            velocity: v,
            attitude: Attitude::from_angle(theta),
            wind: Inertial::ZERO,
        };
        let reference = Reference {
            velocity: v,
            acceleration: a_r,
        };
        let step = law().step(branch, &state, &reference);
        let command = law().robust_from(&step, branch, &state, None).unwrap();
        (command, step.forces)
    }

    fn verdict(branch: Branch, theta: f32, v: Inertial, a_r: Inertial) -> Verdict {
        switch().judge(branch, &at(branch, theta, v, a_r).1)
    }

    #[test]
    fn descents_are_told_apart() {
        use Branch::{Aligned, Opposed};
        let fall = |speed| Inertial::new(speed, 0.0);
        let none = Inertial::ZERO;
        // Nose up, tail first, F_p vanishes at √(g m/(k_a (c0 + 2c1))) = 8.9 m/s: before it θ̃ = 0 is right,
        assert_eq!(verdict(Aligned, 0.0, fall(6.0), none), Verdict::Positive);
        // after it θ̃ = π is, and θ̃ = 0 needs negative thrust, nose down.
        assert_eq!(verdict(Aligned, 0.0, fall(11.0), none), Verdict::Other);
        assert_eq!(verdict(Opposed, 0.0, fall(11.0), none), Verdict::Positive);
        assert_eq!(
            verdict(Aligned, core::f32::consts::PI, fall(11.0), none),
            Verdict::Negative
        );
        // On the way back the branch is left again.
        assert_eq!(verdict(Opposed, 0.0, fall(6.0), none), Verdict::Other);
        // Near the zero, within the hysteresis, each stays what it is.
        assert_eq!(verdict(Aligned, 0.0, fall(8.95), none), Verdict::Positive);
        assert_eq!(verdict(Opposed, 0.0, fall(8.85), none), Verdict::Positive);
    }

    #[test]
    fn braking_harder_than_drag_in_cruise_is_reported_and_does_not_switch() {
        let (theta, v) = (-86f32.to_radians(), Inertial::new(0.0, 20.0));
        let brake = Inertial::new(0.0, -2.0);
        assert_eq!(verdict(Branch::Aligned, theta, v, brake), Verdict::Negative);
        assert_eq!(
            verdict(Branch::Aligned, theta, v, Inertial::ZERO),
            Verdict::Positive
        );
    }

    #[test]
    fn between_the_folds_of_level_flight_no_branch_is_left() {
        let v = Inertial::new(0.0, 14.8);
        for tenths in 115..165 {
            let theta = (tenths as f32 * 0.1 - 90.0).to_radians();
            let (command, _) = at(Branch::Aligned, theta, v, Inertial::ZERO);
            assert!(!(120..=160).contains(&tenths) || command.diagnostics.f_p.i() < -5.0);
            assert_eq!(
                verdict(Branch::Aligned, theta, v, Inertial::ZERO),
                Verdict::Positive
            );
        }
    }

    /// The law of θ̃ = π is the law of θ̃ = 0 for −F_p; thrust is the same on both.
    #[test]
    fn the_opposed_law_stabilises_the_opposed_equilibrium() {
        let v = Inertial::new(11.0, 0.0);
        for degrees in [-20f32, -5.0, 5.0, 20.0] {
            let (opposed, _) = at(Branch::Opposed, degrees.to_radians(), v, Inertial::ZERO);
            let (aligned, _) = at(Branch::Aligned, degrees.to_radians(), v, Inertial::ZERO);
            assert_eq!(opposed.thrust, aligned.thrust);
            // Back to nose up on θ̃ = π, away from it on θ̃ = 0.
            assert!(opposed.rate * degrees < 0.0 && aligned.rate * degrees > 0.0);
        }
    }

    #[test]
    fn a_switch_is_bumpless_and_fades() {
        let switch = switch();
        let mut state = BranchState::default();
        switch.leave(&mut state);
        assert_eq!(state.branch(), Branch::Opposed);
        // 0.3 rad/s was commanded, the other branch asks for −0.5.
        assert_eq!(switch.smooth(&mut state, -0.5, 0.3, 0.01), 0.3);
        let mut rate = 0.3;
        for _ in 0..20 {
            let next = switch.smooth(&mut state, -0.5, rate, 0.01);
            assert!(next < rate);
            rate = next;
        }
        // After a time constant 1/e of the jump is left; 0.02: Euler steps of a twentieth of it.
        assert!((rate + 0.5 - 0.8 * (-1f32).exp()).abs() < 0.02, "{rate}");
    }

    /// Whatever bits the memory holds, it is a branch, and an absurd jump is told.
    #[test]
    fn every_bit_pattern_is_a_branch() {
        for opposed in 0..=u8::MAX {
            let state = BranchState {
                opposed,
                ..BranchState::default()
            };
            assert_eq!(state.branch() == Branch::Opposed, opposed == 1);
        }
        for offset in [f32::NAN, f32::INFINITY, 1e30] {
            let state = BranchState {
                offset,
                ..BranchState::default()
            };
            assert!(!switch().is_sound(&state));
        }
    }
}
