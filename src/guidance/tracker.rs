//! The tracker: it brings the vehicle to the reference model.
//!
//! On a sheet of equilibria it is the law in space ([`WingedControl`]) for the reference model's velocity and acceleration:
//! in the plane of symmetry the robust law (`eq:inputsVCeR`), with the model's attitude fed forward, tilt and twist across
//! it. Near a fold that law would turn the vehicle to whichever equilibrium is nearer, so there the pitch gives way to the
//! attitude alone.
//!
//! A force that the belief leaves out makes the vehicle lean otherwise than the model. The law knows of the force, the
//! model's attitude does not. Where in hover they ask for opposite turns the difference is learned as a lean, and what is turned
//! to is the model's attitude and that lean. Without, they take turns, and the vehicle nods.

use super::lateral_guidance::{ReferenceModelOutput, ReferenceModelState};
use super::parameters::GuidanceParameters;
use super::reference_model::limited;
use super::status::Status;
use super::tuning::Tuning;
use super::wrap::wrap;
use crate::aero::Aerodynamics;
use crate::air::{AirData, AngleOfAttack};
use crate::authority::Airflow;
use crate::branch::Branch;
use crate::control::{Fault, GainLaw, Margin};
use crate::equivalency::ApparentForces;
use crate::frame::{Attitude, Inertial};
use crate::math;
use crate::ned::Ned;
use crate::parameters::Parameters;
use crate::reference::MAX_SPEED;
use crate::spatial::{Body, Command, Heading, Orientation, Reference, State, WingedControl};
use crate::vehicle::{Vehicle, VehicleParameters};

/// How far to either side of the model's attitude the slope of F̄_2 is looked at.
const BEFORE: AngleOfAttack = AngleOfAttack::from_radians(-0.087);
const AFTER: AngleOfAttack = AngleOfAttack::from_radians(0.087);
/// Slope of F̄_2 from which on an equilibrium is on a sheet, in multiples of the weight.
const SHEET: f32 = 0.29;
/// Distance from the model's attitude \[rad\] up to which the vehicle is taken to be on the model's sheet, and
/// beyond twice which it is not.
const NEAR: f32 = 0.17;
/// Cosine of the angle between the vehicle's right wing and the model's: below the first the vehicle does not fly in
/// the plane of flight, above the second it does.
const ASIDE: f32 = 0.5;
const ALONG: f32 = 0.8;

/// Part of the greatest rate by which the lag of the rate loop is made up for. Where the servo meets stall the model's rate
/// goes to and fro at its slew limit. All of the lag's lead would then leave nothing of the limits to bring the attitude
/// back: of 30 noisy round trips 6 sank more than 1.5 m, the worst 8 m.
const LAG_SHARE: f32 = 0.4;

/// Part of the greatest integral that is left as F_p grows: with the default gains an angle of 7°.
const STIFF: f32 = 0.25;

/// Greatest change of the pitch rate that thrust is given for [rad/s²].
const MAX_CHANGE: f32 = 15.0;

/// Attitude behind the model's \[rad\] from which on less authority is believed in, and at which none is: the air holds the nose, and
/// it takes thrust to turn it. Without, an elevon wing circled down on its back at the elevons' stop, motors at rest.
const BEHIND: f32 = 0.3;
const HELD: f32 = 0.5;

/// Rate [1/s] at which a lean is learned, times the say of the law and that of the turn to the model's attitude; rate [1/s] at which it is
/// forgotten at a fold and beyond hover; and the greatest one of a vehicle without authority \[rad\].
const LEARNING: f32 = 5.0;
const FORGETTING: f32 = 1.0;
const MAX_LEAN: f32 = 0.5;

/// Least airspeed in the rate at which the air takes a velocity away [m/s]: in hover there is none.
const SLOWEST: f32 = 0.1;

/// What the tracker looks at.
pub(super) struct TrackerInput<'a> {
    pub state: &'a State,
    /// Position less reference position \[m\].
    pub position: Ned,
    pub flight: &'a ReferenceModelState,
    /// Attitude θ of the real vehicle in the plane of flight \[rad\].
    pub theta: f32,
    pub model: &'a ReferenceModelOutput,
    /// What of the last command saturated.
    pub saturated: Status,
    /// The last pitch rate commanded [rad/s] if it stands at its limit, else zero.
    pub rate: f32,
}

/// What the tracker comes to.
pub(super) struct TrackerOutput {
    pub command: Command,
    pub margin: Margin,
    /// How much the law has a say: 1 on a sheet, 0 at a fold.
    pub law: f32,
    /// How far the model's attitude with the lean is ahead of the vehicle's \[rad\].
    pub ahead: f32,
    /// Least thrust that may be flown \[N\]: the vehicle's, or a negative one that turns it.
    pub thrust_min: f32,
    pub reference: Reference,
    pub status: Status,
}

/// The tracker. Its pairs of numbers are for down and for the horizontal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tracker {
    position_gain: [f32; 2],
    /// Part of the horizontal gains that is left in the plane of flight.
    easing: f32,
    max_velocity: [f32; 2],
    integral_gain: [f32; 2],
    max_integral: [f32; 2],
    /// Position \[m\] that the integral could hold.
    reach: [f32; 2],
    rate_lag: f32,
    /// Greatest rate [rad/s] by which that lag is made up for.
    lead: f32,
    /// Greatest lean \[rad\]: none of a vehicle of full authority, which goes where it is turned to.
    max_lean: f32,
    /// Airspeed [m/s] up to which a lean is learned. In faster air it is the wing's moment that keeps the attitude from the model's.
    held: f32,
    /// Force below which the damping along the thrust line does not fall, in multiples of the weight.
    gain_schedule_floor: f32,
}

/// `v` with its part down within ±`down`, and its horizontal part no longer than `horizontal`; and whether it was.
#[inline(always)]
fn bounded(v: Ned, [down, horizontal]: [f32; 2]) -> (Ned, bool) {
    let square = v.north * v.north + v.east * v.east;
    let kept = limited(v.down, down);
    if square > horizontal * horizontal {
        let scale = horizontal / math::sqrt(square);
        (Ned::new(v.north * scale, v.east * scale, kept), true)
    } else {
        (Ned::new(v.north, v.east, kept), kept != v.down)
    }
}

/// `v` with its part down times the first factor, and its horizontal part times the second.
#[inline(always)]
fn scaled(v: Ned, [down, horizontal]: [f32; 2]) -> Ned {
    Ned::new(v.north * horizontal, v.east * horizontal, v.down * down)
}

impl Tracker {
    /// The tracker with these parameters, which have been checked, of a vehicle with an angular acceleration of `turning` [rad/s²] in hover, which
    /// has half of it to spare up to the airspeed `held` [m/s].
    pub fn new(p: &GuidanceParameters, turning: f32, held: f32, tuning: &Tuning) -> Self {
        let had = turning / VehicleParameters::DEFAULT.authority;
        let reach = |most: f32, gain: f32| {
            if gain > 0.0 {
                math::min(most / gain, MAX_SPEED)
            } else {
                0.0
            }
        };
        Self {
            reach: [
                reach(p.max_integral_down, p.position_gain_down),
                reach(p.max_integral_forward, p.position_gain_forward),
            ],
            position_gain: [p.position_gain_down, p.position_gain_forward],
            easing: p.easing(tuning),
            max_velocity: [p.max_velocity_down, p.max_velocity_forward],
            integral_gain: [p.integral_gain_down, p.integral_gain_forward],
            max_integral: [p.max_integral_down, p.max_integral_forward],
            rate_lag: p.rate_lag,
            lead: LAG_SHARE * p.max_rate,
            max_lean: math::max(1.0 - had, 0.0) * MAX_LEAN,
            held,
            gain_schedule_floor: p.gain_schedule_floor,
        }
    }

    /// `v` with less of its part along the course of the plane of flight, `forward`, which is level.
    #[inline(always)]
    fn eased(&self, v: Ned, forward: Ned) -> Ned {
        if self.easing >= 1.0 {
            return v;
        }
        core::hint::cold_path();
        let less = (1.0 - self.easing) * (forward.north * v.north + forward.east * v.east);
        Ned::new(
            v.north - less * forward.north,
            v.east - less * forward.east,
            v.down,
        )
    }

    /// `position` \[m\] no farther than the integral could hold.
    #[inline(always)]
    pub(super) fn within_reach(&self, position: Ned) -> Ned {
        bounded(position, self.reach).0
    }

    /// Whether integral and lean are inside their bounds, but for rounding. NaN is not.
    #[inline(always)]
    pub(super) fn is_sound(&self, integral: Ned, lean: f32) -> bool {
        let square = integral.north * integral.north + integral.east * integral.east;
        lean.abs() <= self.max_lean
            && integral.down.abs() <= self.max_integral[0]
            && square <= 1.000_01 * self.max_integral[1] * self.max_integral[1]
    }

    /// The command, before the limits; integral and lean \[rad\] move on by `dt` \[s\].
    #[inline(always)]
    pub(super) fn track<A: Aerodynamics, G: GainLaw>(
        &self,
        control: &WingedControl<A, G>,
        integral: &mut Ned,
        lean: &mut f32,
        input: &TrackerInput,
        dt: f32,
    ) -> Result<TrackerOutput, Fault> {
        let TrackerInput {
            state,
            flight,
            model,
            ..
        } = input;
        let plane = control.plane();
        let weight = plane.vehicle().weight();
        let (axes, attitude) = (&model.axes, &state.orientation);

        // On which side of F_p the model's attitude lies, and how far from a fold.
        let v_a = axes.project(state.velocity - state.wind);
        let believed = plane
            .vehicle()
            .as_flown(axes.gravity, state.correction.air(), 0.0);
        let [left, right] = falls(&believed, model.attitude, v_a, model.in_plane);
        let (branch, slope) = if left > 0.0 && right > 0.0 {
            (Branch::Aligned, math::min(left, right))
        } else if left < 0.0 && right < 0.0 {
            (Branch::Opposed, math::min(-left, -right))
        } else {
            (Branch::Aligned, 0.0)
        };
        let part = math::min(slope / (SHEET * weight), 1.0);
        let ahead = wrap(flight.theta - input.theta) + *lean;
        let near = math::clamp(2.0 - ahead.abs() / NEAR, 0.0, 1.0);
        let wings = axes.right.dot(attitude.w());
        let aligned = math::clamp((wings - ASIDE) / (ALONG - ASIDE), 0.0, 1.0);
        let on_sheet = part * part * (3.0 - 2.0 * part);
        let law = on_sheet * near * aligned;

        // The velocity asked for.
        let slip = self.eased(input.position - model.position, axes.forward);
        let (pull, _) = bounded(scaled(slip, self.position_gain), self.max_velocity);
        let mut reference = Reference {
            velocity: model.velocity - pull,
            acceleration: model.acceleration,
            heading: Heading::of_unit(axes.forward),
        };
        let seen = control.observe(state, &reference);
        let mut step = plane.step_in_plane(branch, seen.forces, seen.error.in_plane());
        let tau = plane.gains().guard().tau();
        let margin = Margin::new(&step.forces, step.norm, tau, branch.sign());
        // What is not known of the wing is an angle. It takes the more velocity error to hold an angle the larger F_p is.
        let stiffness = step.norm / weight;
        let stiffness = if stiffness > 1.0 { stiffness } else { 1.0 };
        let bound = if stiffness < 1.0 / STIFF {
            1.0 / stiffness
        } else {
            STIFF
        };
        let bound = self.max_integral.map(|most| most * bound);
        let growing = self.eased(pull, axes.forward) * (law / stiffness);
        let full = self.integrate(integral, growing, bound, input, branch, dt);
        // Along the thrust line a velocity error is a force, whatever F_p is.
        let held = attitude.to_axes(*integral);
        let held = Body::new(held.i, held.j * stiffness, held.w * stiffness);
        reference.velocity = reference.velocity - attitude.of_axes(held);
        step.error += held.in_plane();
        // Where the wing carries, the air takes a velocity across itself away, at the rate ν [1/s], and turns F_p with it. A
        // velocity error would then close at the rate k2|F_p|²/m / (k3/4 + ν). With the factor 1 + 4ν/k3 it closes no more slowly than in
        // hover.
        let forces = &step.forces;
        let mass = plane.vehicle().mass();
        let carried = forces.lambda * forces.pressure / (mass * (forces.air.speed + SLOWEST));
        if carried > 0.0 {
            step.gains.k2 *= 1.0 + 4.0 * carried / step.gains.k3;
        }
        let in_plane = plane.robust_in_plane(&step, branch, None)?;
        let fed = (
            attitude.to_axes(model.acceleration),
            attitude.w().dot(model.jerk),
        );
        let error = seen.error.w + held.w;
        let lateral = control.across(&seen, error, state, reference.heading, Some(fed));
        let mut command = control.assemble(&seen, in_plane, &lateral);

        let gains = &step.gains;
        // Along the thrust line the damping does not vanish with F_p.
        let floor = self.gain_schedule_floor * weight;
        if step.norm < floor {
            command.thrust += gains.k1 * (floor - step.norm) * step.error.i();
        }
        let gain = 0.25 * gains.k3;
        let rate = flight.rate + limited(self.rate_lag * model.rate_change, self.lead);
        let attitude_rate = wings * (gain * ahead);
        let body = attitude.to_axes(state.velocity - state.wind);
        let flow = Airflow {
            along: -body.i,
            across: body.j,
            speed: math::sqrt((body.i * body.i + body.j * body.j).abs()),
        };
        if self.max_lean > 0.0 && (law < 1.0 || *lean != 0.0) {
            core::hint::cold_path();
            let (say, sheet) = if flow.speed < self.held {
                (law, on_sheet * aligned)
            } else {
                (0.0, 0.0)
            };
            let learning = LEARNING * say * (1.0 - say);
            let forgetting = FORGETTING * (1.0 - sheet);
            let wish = command.rates.pitch / gain;
            let next = learned(*lean, wish, ahead, learning * dt, forgetting * dt);
            *lean = limited(next, self.max_lean);
        }
        command.rates.pitch = wings * rate
            + attitude.w().dot(model.spin)
            + law * command.rates.pitch
            + (1.0 - law) * attitude_rate;
        // Thrust to turn with, where surfaces have none of it: the attitude goes first.
        let vehicle = plane.vehicle();
        let available = model.thrust_max * vehicle.propeller().available(flow.along);
        let mut least = math::min(vehicle.thrust_min(), available);
        let asked = math::clamp(command.thrust, least, available);
        // The turn that is asked for; of an attitude far behind the way that is left, since the law may ask for another.
        let held = math::clamp((ahead.abs() - BEHIND) / (HELD - BEHIND), 0.0, 1.0);
        let turn = wings * command.rates.pitch;
        let change = limited(gain * (turn + held * (gain * ahead - turn)), MAX_CHANGE);
        let authority = vehicle.authority();
        let allowed = authority.at(flow, asked, available);
        let lacking = (change - allowed.wing).abs() - allowed.given * (1.0 - held);
        if lacking > 0.0 {
            // Where the air leaves the motors no thrust they still turn the vehicle, and brake.
            let brake = model.thrust_max * vehicle.propeller().least(flow.along);
            let raised = authority.thrust_giving(&allowed, lacking, asked, brake, available);
            if raised != asked {
                command.thrust = raised;
                least = math::min(least, raised);
            }
        }
        // The air along the nose damps a roll: it is asked for no faster in the plane of flight.
        if command.rates.roll.abs() * flow.along > vehicle.roll() {
            core::hint::cold_path();
            command.rates.roll = (vehicle.roll() / flow.along).copysign(command.rates.roll);
        }
        // Out of the plane of flight pitch, tilt and twist would each go their own way.
        if aligned < 1.0 {
            let shortest = by_the_shortest_way(*attitude, axes.forward, axes.right, model.attitude);
            let shortest = shortest * gain + attitude.to_axes(axes.right * rate + model.spin);
            let mixed = Body::from(command.rates) * aligned + shortest * (1.0 - aligned);
            command.rates = mixed.into();
        }
        Ok(TrackerOutput {
            command,
            margin,
            law,
            ahead,
            thrust_min: least,
            reference,
            status: Status::INTEGRAL.when(full),
        })
    }

    /// Lets the integral grow by what the limits allow, and tells whether it is full. Nothing keeps it from returning to
    /// zero.
    #[inline(always)]
    fn integrate(
        &self,
        integral: &mut Ned,
        pull: Ned,
        bound: [f32; 2],
        input: &TrackerInput,
        branch: Branch,
        dt: f32,
    ) -> bool {
        let wanted = scaled(pull, self.integral_gain);
        let allowed = gate(
            wanted,
            &input.state.orientation,
            input.saturated,
            branch.sign() * input.rate,
        );
        let (kept, full) = grow(*integral, wanted, allowed, bound, dt);
        *integral = kept;
        full
    }
}

/// How F̄_2 falls with the attitude [N/rad], before this one and after it, at an air velocity [m/s] and an acceleration [m/s²].
#[inline(always)]
fn falls<A: Aerodynamics>(
    vehicle: &Vehicle<A>,
    attitude: Attitude,
    air_velocity: Inertial,
    acceleration: Inertial,
) -> [f32; 2] {
    let weight = (Inertial::new(vehicle.gravity(), 0.0) - acceleration) * vehicle.mass();
    // The air velocity is the same: turned by an angle, the angle of attack is larger by it.
    let air = AirData::new(attitude.to_body(air_velocity), vehicle.thrust_line());
    let turned = |by: &AngleOfAttack| (attitude.turned(by.sin, by.cos), air.turned(by));
    let middle = transverse_force(vehicle, (attitude, air), weight);
    let before = transverse_force(vehicle, turned(&BEFORE), weight);
    let after = transverse_force(vehicle, turned(&AFTER), weight);
    [(before - middle) / AFTER.rad, (middle - after) / AFTER.rad]
}

/// F̄_2 \[N\] at an attitude in this air, for an apparent `weight` \[N\]: zero in equilibrium.
#[inline(always)]
fn transverse_force<A: Aerodynamics>(
    vehicle: &Vehicle<A>,
    (attitude, air): (Attitude, AirData),
    weight: Inertial,
) -> f32 {
    ApparentForces::in_plane(vehicle, air, air.speed, attitude.to_body(weight))
        .f
        .j()
}

/// The shortest rotation, in body components \[rad\], from an `attitude` to that of a vehicle at θ in the plane whose course is
/// `forward` and whose right wing is `right`. By pitch, tilt and twist, each on its own, a vehicle on its side nodded for two
/// seconds and fell by more than 30 m.
///
/// It is a function of its own because it is rarely called: within the tracker it takes 16 bytes more of stack.
#[cold]
#[inline(never)]
fn by_the_shortest_way(attitude: Orientation, forward: Ned, right: Ned, theta: Attitude) -> Body {
    let Attitude { cos, sin } = theta;
    let down = forward.cross(right);
    attitude.rotation_to(
        down * cos + forward * sin,
        forward * cos - down * sin,
        right,
    )
}

/// The `lean` \[rad\] after a step that learns and forgets these parts, where the law asks for a turn by `wish` \[rad\] and the model's attitude
/// with the lean is `ahead` \[rad\].
///
/// It is learned where the two are opposed. An attitude that stays behind while both ask for the same is
/// no lean: surfaces at their stop lack authority. Learned of any attitude behind the model's, it kept elevon wings in a
/// dive, and 3 of 25 sank by more than 30 m.
fn learned(lean: f32, wish: f32, ahead: f32, learning: f32, forgetting: f32) -> f32 {
    let against = if wish * ahead < 0.0 {
        limited(wish, ahead.abs())
    } else {
        0.0
    };
    (lean + against * learning) * (1.0 - forgetting)
}

/// The integral after `dt`, and whether it is full. It grows by what is `allowed`; where the growth `wanted` leads it back
/// to zero, by all of that. Down and the horizontal are looked at separately.
#[inline(always)]
fn grow(integral: Ned, wanted: Ned, allowed: Ned, bound: [f32; 2], dt: f32) -> (Ned, bool) {
    let back = wanted.north * integral.north + wanted.east * integral.east < 0.0;
    let level = if back { wanted } else { allowed };
    let upright = if wanted.down * integral.down < 0.0 {
        wanted
    } else {
        allowed
    };
    bounded(
        integral + Ned::new(level.north, level.east, upright.down) * dt,
        bound,
    )
}

/// The part of İ that the actuators can still obey.
///
/// A growing integral lowers the velocity asked for. Along i, against thrust, that asks for more thrust; across it, the
/// law asks for a greater rate on θ̃ = 0, and for a smaller one on θ̃ = π: `rate` is the limit at which the pitch rate
/// stands by that sign, or zero.
#[inline(always)]
fn gate(growth: Ned, attitude: &Orientation, saturated: Status, rate: f32) -> Ned {
    if rate == 0.0 && !saturated.intersects(Status::THRUST_LOW | Status::THRUST_HIGH) {
        return growth;
    }
    let Body { i, j, w } = attitude.to_axes(growth);
    let (mut along, mut across) = (i, j);
    if saturated.contains(Status::THRUST_HIGH) {
        along = math::min(along, 0.0);
    }
    if saturated.contains(Status::THRUST_LOW) {
        along = -math::min(-along, 0.0);
    }
    if across * rate > 0.0 {
        across = 0.0;
    }
    attitude.of_axes(Body::new(along, across, w))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};

    const DT: f32 = 0.01;

    #[test]
    fn the_integral_stops_at_its_bound_and_always_returns() {
        let down = |integral, wanted, allowed| {
            let v = |x| Ned::new(0.0, 0.0, x);
            let (kept, full) = grow(v(integral), v(wanted), v(allowed), [2.0, 1.0], DT);
            (kept.down, full)
        };
        assert_eq!(down(0.5, 1.0, 1.0), (0.51, false));
        assert_eq!(down(1.999, 1.0, 1.0), (2.0, true));
        // Not allowed to grow,
        assert_eq!(down(0.5, 1.0, 0.0), (0.5, false));
        // but back to zero in any case.
        assert_eq!(down(0.5, -1.0, 0.0), (0.49, false));
        // In the horizontal it is a vector: its length is bounded.
        let level = |integral, wanted| grow(integral, wanted, wanted, [2.0, 1.0], DT);
        let (kept, full) = level(Ned::new(0.6, 0.8, 0.0), Ned::new(3.0, 4.0, 0.0));
        assert!(full && (kept - Ned::new(0.6, 0.8, 0.0)).norm_squared() < 1e-12);
        let (kept, full) = level(Ned::new(0.6, 0.0, 0.0), Ned::new(0.0, 1.0, 0.0));
        assert_eq!((kept, full), (Ned::new(0.6, 0.01, 0.0), false));
    }

    #[test]
    fn a_lean_is_learned_only_where_law_and_turn_are_opposed() {
        let after = |wish, ahead| learned(0.1, wish, ahead, 0.01, 0.0);
        // The law wants 0.3 rad more, the model 0.2 rad less: no more than that is learned of.
        assert!((after(0.3, -0.2) - 0.102).abs() < 1e-7);
        assert!((after(-0.1, 0.2) - 0.099).abs() < 1e-7);
        // Both want the same.
        assert_eq!((after(0.3, 0.2), after(-0.3, -0.2)), (0.1, 0.1));
        // What is forgotten goes to zero.
        assert!((learned(0.1, 0.3, 0.2, 0.01, 0.2) - 0.08).abs() < 1e-7);
    }

    /// Half of the greatest rate by default: half of what is along the course, all of the rest.
    #[test]
    fn only_in_its_plane_of_flight_does_it_go_slowly() {
        let p = GuidanceParameters {
            max_rate: 1.4,
            ..GuidanceParameters::default()
        };
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model).unwrap();
        let tracker = Tracker::new(&p, vehicle.turning_in_hover(), 3.0, &Tuning::default());
        let (forward, right) = (Ned::new(0.6, 0.8, 0.0), Ned::new(-0.8, 0.6, 0.0));
        let aside = right * 3.0 + Ned::new(0.0, 0.0, 5.0);
        let left = tracker.eased(forward * 2.0 + aside, forward);
        assert!((left - (forward + aside)).norm_squared() < 1e-10);
    }

    #[test]
    fn the_integral_does_not_grow_against_a_limit() {
        let up = &Orientation::NOSE_UP;
        // Nose up, i is down and j is north: a growing integral, down, asks for more thrust.
        let all = Ned::new(0.2, 0.1, 0.3);
        assert_eq!(gate(all, up, Status::empty(), 0.0), all);
        // Roll and yaw at their limits keep nothing from pitch.
        assert_eq!(gate(all, up, Status::SLEW | Status::RATE, 0.0), all);
        assert_eq!(gate(all, up, Status::THRUST_LOW, 0.0), all);
        let level = Ned::new(0.2, 0.1, 0.0);
        assert_eq!(gate(all, up, Status::THRUST_HIGH, 0.0), level);
        assert_eq!(gate(-all, up, Status::THRUST_HIGH, 0.0), -all);
        assert_eq!(gate(-all, up, Status::THRUST_LOW, 0.0), -level);
        // At the limit of the rate that it asks more of, and at the other.
        let kept = Ned::new(0.0, 0.1, 0.3);
        assert_eq!(gate(all, up, Status::RATE, 2.8), kept);
        assert_eq!(gate(all, up, Status::RATE, -2.8), all);
    }
}
