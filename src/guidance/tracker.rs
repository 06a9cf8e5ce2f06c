//! The tracker: it brings the real vehicle to the virtual one.
//!
//! On a sheet of equilibria it is the robust law (`eq:inputsVCeR`) for the virtual flight's velocity and acceleration, with
//! its attitude fed forward. Near a fold that law would turn the vehicle to whichever equilibrium is nearer, so there it
//! gives way to the attitude alone.

use super::flight::{Flight, across, limited};
use super::parameters::GuidanceParameters;
use super::planner::wrap;
use super::status::Status;
use crate::aero::Aerodynamics;
use crate::branch::Branch;
use crate::control::{Command, Fault, GainLaw, State, Step, VelocityControl};
use crate::frame::{Attitude, Body, Inertial};
use crate::math;
use crate::reference::{MAX_SPEED, Reference};

/// How far to either side of the virtual attitude the slope of F̄_2 is looked at \[rad\].
const REACH: f32 = 0.087;
/// Slope of F̄_2 from which on an equilibrium is on a sheet, in multiples of the weight.
const SHEET: f32 = 0.5;
/// Distance from the virtual attitude \[rad\] up to which the vehicle is taken to be on the virtual vehicle's sheet, and
/// beyond twice which it is not.
const NEAR: f32 = 0.17;

/// Part of the greatest integral that is left as F_p grows: with the default gains an angle of 7°.
const STIFF: f32 = 0.25;

/// What the tracker looks at.
pub(super) struct TrackerInput<'a> {
    pub state: State,
    /// Position less reference position \[m\].
    pub position: Inertial,
    pub flight: &'a Flight,
    /// Acceleration of the virtual flight [m/s²].
    pub acceleration: Inertial,
    /// ω̇ of the virtual flight [rad/s²].
    pub rate_change: f32,
    /// What of the last command saturated.
    pub saturated: Status,
    /// The last angular rate commanded [rad/s], whose sign says at which limit it stands.
    pub rate: f32,
}

/// What the tracker comes to.
pub(super) struct Tracked {
    pub command: Command,
    pub step: Step,
    pub branch: Branch,
    /// How much the law has a say: 1 on a sheet, 0 at a fold.
    pub law: f32,
    pub reference: Reference,
    pub status: Status,
}

/// The tracker.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tracker {
    position_gain: Inertial,
    max_velocity: Inertial,
    integral_gain: Inertial,
    max_integral: Inertial,
    rate_lag: f32,
    /// Force below which the damping along the thrust line does not fall, in multiples of the weight.
    force_floor: f32,
}

impl Tracker {
    /// The tracker with these parameters, which have been checked.
    pub fn new(p: &GuidanceParameters) -> Self {
        Self {
            position_gain: Inertial::new(p.position_gain_down, p.position_gain_forward),
            max_velocity: Inertial::new(p.max_velocity_down, p.max_velocity_forward),
            integral_gain: Inertial::new(p.integral_gain_down, p.integral_gain_forward),
            max_integral: Inertial::new(p.max_integral_down, p.max_integral_forward),
            rate_lag: p.rate_lag,
            force_floor: p.force_floor,
        }
    }

    /// Position errors that the integral could hold \[m\].
    pub(super) fn reach(&self) -> Inertial {
        let reach = |max: f32, gain: f32| {
            if gain > 0.0 {
                math::min(max / gain, MAX_SPEED)
            } else {
                0.0
            }
        };
        Inertial::new(
            reach(self.max_integral.down(), self.position_gain.down()),
            reach(self.max_integral.forward(), self.position_gain.forward()),
        )
    }

    /// Whether the integral is inside its bounds. NaN is not.
    #[inline(always)]
    pub(super) fn is_sound(&self, integral: Inertial) -> bool {
        integral.down().abs() <= self.max_integral.down()
            && integral.forward().abs() <= self.max_integral.forward()
    }

    /// `integral` [m/s] inside its limits.
    pub(super) fn limited(&self, integral: Inertial) -> Inertial {
        Inertial::new(
            limited(integral.down(), self.max_integral.down()),
            limited(integral.forward(), self.max_integral.forward()),
        )
    }

    /// The command, before the limits; the integral moves on by `dt` \[s\].
    #[inline(always)]
    pub(super) fn track<A: Aerodynamics, G: GainLaw>(
        &self,
        control: &VelocityControl<A, G>,
        integral: &mut Inertial,
        input: &TrackerInput,
        dt: f32,
    ) -> Result<Tracked, Fault> {
        let TrackerInput { state, flight, .. } = input;
        let vehicle = control.vehicle();
        let weight = vehicle.weight();

        // On which side of F_p the virtual attitude lies, and how far from a fold.
        let v_a = state.velocity - state.wind;
        let at = |theta| across(vehicle, theta, v_a, input.acceleration);
        let middle = at(flight.theta);
        let left = (at(flight.theta - REACH) - middle) / REACH;
        let right = (middle - at(flight.theta + REACH)) / REACH;
        let (branch, slope) = if left > 0.0 && right > 0.0 {
            (Branch::Aligned, math::min(left, right))
        } else if left < 0.0 && right < 0.0 {
            (Branch::Opposed, math::min(-left, -right))
        } else {
            (Branch::Aligned, 0.0)
        };
        let ahead = wrap(flight.theta - state.attitude.angle());
        let part = math::min(slope / (SHEET * weight), 1.0);
        let near = math::clamp(2.0 - ahead.abs() / NEAR, 0.0, 1.0);
        let law = part * part * (3.0 - 2.0 * part) * near;

        // The velocity asked for.
        let slip = input.position - flight.position;
        let pull = Inertial::new(
            limited(
                self.position_gain.down() * slip.down(),
                self.max_velocity.down(),
            ),
            limited(
                self.position_gain.forward() * slip.forward(),
                self.max_velocity.forward(),
            ),
        );
        let mut reference = Reference {
            velocity: flight.velocity - pull,
            acceleration: input.acceleration,
        };
        let mut step = control.step(branch, state, &reference);
        // What is not known of the wing is an angle. It takes the more velocity error to hold an angle the larger F_p is.
        let stiffness = step.norm / weight;
        let stiffness = if stiffness > 1.0 { stiffness } else { 1.0 };
        let bound = self.max_integral
            * if stiffness < 1.0 / STIFF {
                1.0 / stiffness
            } else {
                STIFF
            };
        let full = self.integrate(integral, pull * (law / stiffness), bound, input, branch, dt);
        let held = *integral * stiffness;
        reference.velocity -= held;
        step.error += state.attitude.to_body(held);
        let command = control.robust_from(&step, branch, state, None)?;
        let gains = &step.gains;
        // Along the thrust line the damping does not vanish with F_p.
        let floor = self.force_floor * weight;
        let missing = if step.norm < floor {
            gains.k1 * (floor - step.norm) * step.error.i()
        } else {
            0.0
        };
        let attitude = 0.25 * gains.k3 * ahead;
        let rate = flight.rate
            + self.rate_lag * input.rate_change
            + law * command.rate
            + (1.0 - law) * attitude;
        Ok(Tracked {
            command: Command {
                thrust: command.thrust + missing,
                rate,
                ..command
            },
            step,
            branch,
            law,
            reference,
            status: Status::INTEGRAL.when(full),
        })
    }

    /// Lets the integral grow by what the limits allow, and tells whether it is full. Nothing keeps it from returning to
    /// zero.
    #[inline(always)]
    fn integrate(
        &self,
        integral: &mut Inertial,
        pull: Inertial,
        bound: Inertial,
        input: &TrackerInput,
        branch: Branch,
        dt: f32,
    ) -> bool {
        let wanted = Inertial::new(
            self.integral_gain.down() * pull.down(),
            self.integral_gain.forward() * pull.forward(),
        );
        let allowed = gate(
            wanted,
            input.state.attitude,
            input.saturated,
            branch.sign() * input.rate,
        );
        let (down, full_down) = grow(
            integral.down(),
            wanted.down(),
            allowed.down(),
            bound.down(),
            dt,
        );
        let (forward, full_forward) = grow(
            integral.forward(),
            wanted.forward(),
            allowed.forward(),
            bound.forward(),
            dt,
        );
        *integral = Inertial::new(down, forward);
        full_down | full_forward
    }
}

/// The integral after `dt`, and whether it is full. It grows by what is `allowed`; where the growth `wanted` leads it back
/// to zero, by all of that.
#[inline(always)]
fn grow(integral: f32, wanted: f32, allowed: f32, bound: f32, dt: f32) -> (f32, bool) {
    let growth = if wanted * integral < 0.0 {
        wanted
    } else {
        allowed
    };
    let moved = integral + growth * dt;
    let kept = limited(moved, bound);
    (kept, kept != moved)
}

/// The part of İ that the actuators can still obey.
///
/// A growing integral lowers the velocity asked for. Along i, against thrust, that asks for more thrust; across it, the
/// law asks for a greater rate on θ̃ = 0, and for a smaller one on θ̃ = π: `rate` is the last rate by that sign.
#[inline(always)]
fn gate(growth: Inertial, attitude: Attitude, saturated: Status, rate: f32) -> Inertial {
    if !saturated.intersects(Status::THRUST_LOW | Status::THRUST_HIGH | Status::RATE) {
        return growth;
    }
    let g = attitude.to_body(growth);
    let (mut along, mut across) = (g.i(), g.j());
    if saturated.contains(Status::THRUST_HIGH) {
        along = math::min(along, 0.0);
    }
    if saturated.contains(Status::THRUST_LOW) {
        along = -math::min(-along, 0.0);
    }
    if saturated.contains(Status::RATE) && across * rate > 0.0 {
        across = 0.0;
    }
    attitude.to_inertial(Body::new(along, across))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f32 = 0.01;

    #[test]
    fn the_integral_stops_at_its_bound_and_always_returns() {
        assert_eq!(grow(0.5, 1.0, 1.0, 2.0, DT), (0.51, false));
        assert_eq!(grow(1.999, 1.0, 1.0, 2.0, DT), (2.0, true));
        // Not allowed to grow,
        assert_eq!(grow(0.5, 1.0, 0.0, 2.0, DT), (0.5, false));
        // but back to zero in any case.
        assert_eq!(grow(0.5, -1.0, 0.0, 2.0, DT), (0.49, false));
    }

    #[test]
    fn the_integral_does_not_grow_against_a_limit() {
        let up = Attitude::NOSE_UP;
        // Nose up, i is down: a growing integral, down, asks for more thrust.
        let both = Inertial::new(0.3, 0.2);
        assert_eq!(gate(both, up, Status::empty(), 1.0), both);
        assert_eq!(gate(both, up, Status::SLEW, 1.0), both);
        assert_eq!(gate(both, up, Status::THRUST_LOW, 1.0), both);
        assert_eq!(
            gate(both, up, Status::THRUST_HIGH, 1.0),
            Inertial::new(0.0, 0.2)
        );
        assert_eq!(gate(-both, up, Status::THRUST_HIGH, 1.0), -both);
        assert_eq!(
            gate(-both, up, Status::THRUST_LOW, 1.0),
            Inertial::new(0.0, -0.2)
        );
        // At the limit of the rate that it asks more of, and at the other.
        assert_eq!(gate(both, up, Status::RATE, 2.8), Inertial::new(0.3, 0.0));
        assert_eq!(gate(both, up, Status::RATE, -2.8), both);
    }
}
