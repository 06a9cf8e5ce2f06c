//! The planner: which plan the virtual vehicle flies by.
//!
//! One plan a step is flown ahead: by turns the plan in force and others, and what they cost is compared. It is flown for two
//! seconds, or for 3.7 where a vehicle turns slowly. A plan may be to turn to an attitude far away, past stall for example, and
//! to go on from there: so a fold is crossed where that is worth while, and nothing else decides it. The work is the same at
//! every step.

use super::memory::memory;
use super::parameters::GuidanceParameters;
use super::planner_options::{PlannerOptions, altitude_band};
use super::reference_model::{
    PUSH_OVER, Plan, PlanarModelState, ReferenceModel, StepGains, limited,
};
use crate::aero::Aerodynamics;
use crate::frame::{Attitude, Inertial};
use crate::math;
use crate::reference::{MAX_SPEED, Reference};
use crate::vehicle::Vehicle;

/// Steps of a prediction, the first of the short one \[s\], and the growth from one to the next: 2.09 s in all. With 26 steps one of
/// 4,000 vehicles was lost, and transitions with a heading held aside reached velocity errors of 2.3 m/s in place of 1.5; 27
/// are what there is time for.
const STEPS: usize = 27;
const FIRST_STEP: f32 = 0.045;
const GROWTH: f32 = 1.039;
/// Steps at the end over which it is measured how fast an error closes.
const LATE: usize = 6;
/// How long the reference is taken to accelerate on \[s\]. This, and what follows to [`SWITCHING_HYSTERESIS`], the servo's constants and the
/// tracker's, was searched for together, over short flights in calm air, wind, noise and turbulence with right and wrong
/// beliefs: one changed alone moves every crossing of the stall.
const AHEAD: f32 = 0.74;
/// Errors count by their square, and from this many bands on in proportion.
const LINEAR_FROM: f32 = 4.0;
/// Time to go: weight, greatest \[s\], least closing taken for it, in g.
const TO_GO: f32 = 0.76;
const MAX_TO_GO: f32 = 20.0;
const LEAST_CLOSING: f32 = 0.035;
/// Being too high costs no more from this many altitude bands on, and sinking too slowly for a long time from this many
/// velocity bands on: a reference that sinks more steeply than the vehicle can is not worth a dive.
const HIGH: f32 = 3.0;
const SLOW: f32 = 8.0;
/// Greatest change of the acceleration to the side, in g per second: a roll of 90° takes about as long as the rate allows.
pub(super) const MAX_LATERAL_JERK: f32 = 3.0;
/// Velocity to the side that it takes to level the wing and to bank it again, per squared acceleration to the side [s³/m].
const LEVEL: f32 = 1.0 / (MAX_LATERAL_JERK * 9.81);
/// Length of a step of a turn, in the mean \[s\]: most take 5 to 15.
const TURN_STEP: f32 = 0.055;
/// How long a velocity error to the side counts \[s\], once the wing can close it.
const LATERAL_RECOVERY_TIME: f32 = 0.6;
/// k_a |v_a|/m [1/s] from which on a change of lift may stop a velocity across the air's within a step: with the steepest
/// lift there is, 2π, in two thirds of the longest step.
const STIFF: f32 = 2.0;
/// What thrust of the weight costs a plan at its end where the wing has lift in reserve, if as much is spent at its beginning:
/// with half of it some wings stay behind the stall. Without thrust at the beginning, as where the vehicle brakes or coasts, it
/// costs nothing: plans that brake behind the stall would else come late.
const TERMINAL_THRUST_WEIGHT: f32 = 8.0;
/// Lift from which on thrust costs anything, and how much more it takes until it costs all of that, over the weight. With less
/// in reserve a gust or a slow rate loop throws the wing back behind the stall.
const LIFT_RESERVE_START: f32 = 1.25;
const LIFT_RESERVE_SPAN: f32 = 0.25;
/// By how much another plan must cost less: this part, and this much besides.
const SWITCHING_HYSTERESIS: f32 = 0.161;
/// Time of a push-over before a turn \[s\], per unit of n + [`MORE_LOAD`], where n is the load factor that the wing can carry
/// short of stall: a short push-over and a long one. The faster a wing flies and the more lift it has, the more it climbs on its
/// way through stall, and the more a push-over has to make up for. With 0.225 s whatever n is, a wing of twice the area left
/// its altitude by up to 7.7 m where a level reference slows down, in place of 1.8 m.
const SHORT_PUSH: f32 = 0.022;
const LONG_PUSH: f32 = 0.0885;
const MORE_LOAD: f32 = 0.78;
/// The longest push-over \[s\].
const MAX_PUSH: f32 = 0.5;
/// Part of the sink velocity beyond the one wanted that a push-over need not make: who falls turns the nose up at once.
const SINKING: f32 = 0.4;
/// Plans looked at in a round, the plan in force first.
const ROUND_LENGTH: u8 = 3;
/// A turn that is looked at: to which angle of attack \[rad\], and after which push-over.
type Turn = Option<(f32, f32)>;
/// The turns. From there on the servo finds the way; where there is no turn, from the start. Of three candidates two are of
/// these,
const FREQUENT_CANDIDATES: [Turn; 8] = [
    Some((0.8, 0.0)),
    Some((0.8, LONG_PUSH)),
    Some((0.0, 0.0)),
    Some((0.116, 0.0)),
    Some((1.4, SHORT_PUSH)),
    None,
    Some((-0.116, 0.0)),
    Some((1.75, 0.0)),
];
/// and one is of these.
const RARE_CANDIDATES: [Turn; 9] = [
    Some((-0.8, 0.0)),
    Some((1.75, LONG_PUSH)),
    Some((2.3, 0.0)),
    Some((-1.4, 0.0)),
    Some((math::PI, 0.0)),
    Some((-0.8, LONG_PUSH)),
    Some((-1.75, 0.0)),
    Some((-1.75, LONG_PUSH)),
    Some((-2.3, 0.0)),
];
/// The candidate with which a stop at once is flown, that with [`SHORT_PUSH`]: a reference that jumps is answered by it.
const EMERGENCY_STOP: u8 = 6;
/// Candidates until all have been looked at.
const CANDIDATES: u8 = 3 * RARE_CANDIDATES.len() as u8;

/// A step of a prediction.
struct AheadStep {
    gains: StepGains,
    /// 1 while the reference is taken to accelerate, then 0, and a part of the step between.
    accelerating: f32,
}

/// How far a prediction looks ahead.
struct Horizon {
    steps: [AheadStep; STEPS],
    /// The time of all of them, and of the last [`LATE`] \[s\].
    span: f32,
    late: f32,
    /// Length over that of the short one.
    scale: f32,
}

/// The horizons: one for vehicles that turn upright within it, and one for those that do not. A pull-up is the way in which an elevon wing
/// stops, and a plan that does not see its end is none. Of 400 random brakings 12 did not end in hover with the short one and the moment of a
/// wing that is not stalled; 9 do not. 1.75 was taken of 1.5, 1.75 and 2, which differ by chance on the flights that were lost.
static HORIZONS: [Horizon; 2] = [Horizon::new(1.0), Horizon::new(1.75)];
/// Greatest pitch rate [rad/s] below which the long one is looked at: that of a quarter of a turn in 1.1 s, half of the short one.
const SLOW_RATE: f32 = 1.4;

impl Horizon {
    const fn new(scale: f32) -> Self {
        let mut steps = [const {
            AheadStep {
                gains: StepGains::new(FIRST_STEP),
                accelerating: 1.0,
            }
        }; STEPS];
        let (mut n, mut h, mut span, mut late) = (0, scale * FIRST_STEP, 0.0, 0.0);
        while n < STEPS {
            steps[n].gains = StepGains::new(h);
            steps[n].accelerating = math::clamp((AHEAD - span) / h, 0.0, 1.0);
            if n + LATE >= STEPS {
                late += h;
            }
            span += h;
            h *= GROWTH;
            n += 1;
        }
        Self {
            steps,
            span,
            late,
            scale,
        }
    }
}

/// What the planner remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlannerState {
    /// The plan in force.
    pub plan: Plan,
    /// The candidate to look at next.
    next: u8,
    /// How many plans of the round have been looked at.
    looked: u8,
    /// From where the plans of the round are flown ahead.
    initial: InitialState,
    /// What the plan in force comes to.
    pub(super) rollout: Rollout,
}

memory!(PlannerState {
    plan: Plan,
    next: u8,
    looked: u8,
    initial: InitialState,
    rollout: Rollout,
});

/// What weighs plans beside the flight and its reference.
pub(super) struct SearchTerms<'a> {
    /// Of the caller.
    pub planner_options: &'a PlannerOptions,
    /// Acceleration to the side [m/s²] that a plan gives up while it turns to an attitude far away.
    pub missed_lateral_acceleration: f32,
    /// Lift coefficient of the wing short of stall.
    pub lift_coefficient: f32,
}

/// From where plans are flown ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct InitialState {
    flight: PlanarModelState,
    wind: Inertial,
    /// Reference velocity [m/s] and acceleration [m/s²].
    velocity: Inertial,
    acceleration: Inertial,
}

memory!(InitialState {
    flight: PlanarModelState,
    wind: Inertial,
    velocity: Inertial,
    acceleration: Inertial,
});

/// What a plan comes to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rollout {
    /// Its cost.
    pub cost: f32,
    /// Velocity error at the end of the prediction [m/s]: velocity less the velocity wanted.
    pub error: Inertial,
    /// How long \[s\] it will take to close, down and forward; at most [`MAX_TO_GO`].
    pub to_go: Inertial,
    /// Forward position at the end of the prediction less that at its beginning \[m\].
    pub distance: f32,
    /// Thrust at the end of the prediction \[N\].
    pub thrust: f32,
}

memory!(Rollout {
    cost: f32,
    error: Inertial,
    to_go: Inertial,
    distance: f32,
    thrust: f32,
});

/// The planner.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Planner {
    pub(super) reference_model: ReferenceModel,
    pub(super) altitude_band: f32,
    pub(super) velocity_band: Inertial,
    /// Which of the [`HORIZONS`].
    horizon: u8,
}

/// Bounds of what is remembered, beyond everything that flies.
const MAX_ANGLE: f32 = 20.0;
const MAX_COST: f32 = 1e9;
const MAX_NUMBER: f32 = 1e12;

impl Plan {
    fn is_sound(&self) -> bool {
        self.push.abs() <= 1.0 && self.target.abs() <= MAX_ANGLE
    }
}

impl InitialState {
    fn is_sound(&self) -> bool {
        self.flight.is_sound()
            && self.wind.norm_squared()
                + self.velocity.norm_squared()
                + self.acceleration.norm_squared()
                <= 8.0 * MAX_SPEED * MAX_SPEED
    }
}

impl Rollout {
    fn is_sound(&self) -> bool {
        self.error.norm_squared() <= MAX_NUMBER
            && self.to_go.norm_squared() <= 2.1 * MAX_TO_GO * MAX_TO_GO
            && self.distance.abs() + self.thrust.abs() + self.cost.abs() <= MAX_NUMBER
    }
}

impl PlannerState {
    /// Whether every number is one that a planner can have left. NaN is not.
    pub(super) fn is_sound(&self) -> bool {
        self.plan.is_sound() && self.initial.is_sound() && self.rollout.is_sound()
    }

    /// Counts the attitude of the plans from `by` \[rad\] further on: θ has been wrapped.
    #[inline(always)]
    pub(super) fn shift(&mut self, by: f32) {
        self.plan.target += by;
        self.initial.flight.theta += by;
    }
}

impl Planner {
    /// The planner for `vehicle` with these parameters, which have been checked.
    pub fn new<A: Aerodynamics>(p: &GuidanceParameters, vehicle: &Vehicle<A>) -> Self {
        Self {
            reference_model: ReferenceModel::new(p, vehicle),
            altitude_band: p.altitude_band,
            velocity_band: Inertial::new(p.velocity_band_down, p.velocity_band_forward),
            horizon: u8::from(p.max_rate < SLOW_RATE),
        }
    }

    #[inline(always)]
    fn horizon(&self) -> &'static Horizon {
        let [short, long] = &HORIZONS;
        if self.horizon == 0 { short } else { long }
    }

    /// How far it looks ahead \[s\].
    #[inline(always)]
    pub(super) fn span(&self) -> f32 {
        self.horizon().span
    }

    /// Looks at one plan. What the plan in force comes to is remembered when that is looked at.
    ///
    /// The first of a round is the plan in force, and then come candidates, flown ahead from where and when the round began:
    /// costs are compared of plans from one start only. A candidate that is better takes over. A reference that jumps begins a
    /// round, and the candidates anew: so a stop at once is flown alike whenever it is asked for.
    ///
    /// Where the wing could carry more than the weight, thrust from the beginning to the end of a plan costs too: what can be
    /// flown on either side of stall is flown on the wing, and not with half of the weight on the thrust.
    #[inline(always)]
    pub(super) fn search<A: Aerodynamics>(
        &self,
        vehicle: &Vehicle<A>,
        state: &mut PlannerState,
        flight: &PlanarModelState,
        reference: &Reference,
        wind: Inertial,
        terms: &SearchTerms,
    ) {
        // More than a band of the velocity in the few steps since a round began.
        let jump = reference.velocity - state.initial.velocity;
        let band = self.velocity_band.forward();
        if jump.norm_squared() > band * band {
            core::hint::cold_path();
            (state.looked, state.next) = (0, EMERGENCY_STOP);
        }
        let first = state.looked == 0 || state.looked >= ROUND_LENGTH;
        let plan = if first {
            state.looked = 0;
            state.initial = InitialState {
                flight: *flight,
                wind,
                velocity: reference.velocity,
                acceleration: reference.acceleration,
            };
            state.plan
        } else {
            let n = state.next;
            // What was remembered may be any number.
            state.next = if n < CANDIDATES - 1 { n + 1 } else { 0 };
            self.candidate(vehicle, &state.initial, terms.lift_coefficient, n)
        };
        let band = altitude_band(terms.planner_options.altitude_band, self.altitude_band);
        let missed = terms.missed_lateral_acceleration;
        let mut rollout = self.predict(vehicle, &state.initial, &plan, band, missed, !first);
        let air = state.initial.flight.velocity - state.initial.wind;
        let weight = vehicle.weight();
        let lift = terms.lift_coefficient * vehicle.k_a() * air.norm_squared();
        let lift_reserve = lift - LIFT_RESERVE_START * weight;
        let lift_reserve = math::clamp(lift_reserve, 0.0, LIFT_RESERVE_SPAN * weight) / weight;
        let (now, then) = (
            state.initial.flight.thrust / weight,
            rollout.thrust / weight,
        );
        rollout.cost += TERMINAL_THRUST_WEIGHT / LIFT_RESERVE_SPAN * lift_reserve * now * then;
        state.looked += 1;
        let cost = state.rollout.cost;
        if first {
            state.rollout = rollout;
        } else if rollout.cost < cost - SWITCHING_HYSTERESIS * (1.0 + cost) {
            state.plan = plan;
            state.looked = 0;
        }
    }

    /// What `plan` comes to if it is flown from `initial`, with an `altitude_band` \[m\].
    ///
    /// The cost is the integral over the prediction of the altitude error and of the velocity errors, each in its band, and
    /// the same for the time after it: an error that closes at the rate of the last steps is there for as long as that
    /// takes. Without that time to go, coasting at a thrust limit for ever would look cheaper than a short crossing. A turn to
    /// an attitude far away costs the velocity to the side that is given up meanwhile.
    #[inline(always)]
    fn predict<A: Aerodynamics>(
        &self,
        vehicle: &Vehicle<A>,
        initial: &InitialState,
        plan: &Plan,
        altitude_band: f32,
        missed: f32,
        new: bool,
    ) -> Rollout {
        let air = (initial.flight.velocity - initial.wind) * (vehicle.k_a() / vehicle.mass());
        let stiff = STIFF / self.horizon().scale;
        if air.norm_squared() > stiff * stiff {
            self.predict_with::<A, true>(vehicle, initial, plan, altitude_band, missed, new)
        } else {
            self.predict_with::<A, false>(vehicle, initial, plan, altitude_band, missed, new)
        }
    }

    /// The same, with or without what steps of `STIFF` flights need, for its time.
    #[inline(never)]
    fn predict_with<A: Aerodynamics, const STIFF: bool>(
        &self,
        vehicle: &Vehicle<A>,
        initial: &InitialState,
        plan: &Plan,
        altitude_band: f32,
        missed: f32,
        new: bool,
    ) -> Rollout {
        let reference_model = &self.reference_model;
        let (mut flight, mut plan, wind) = (initial.flight, *plan, initial.wind);
        let mut attitude = Attitude::from_angle(flight.theta);
        let band = Inertial::new(
            1.0 / (LINEAR_FROM * self.velocity_band.down()),
            1.0 / (LINEAR_FROM * self.velocity_band.forward()),
        );
        // Too high is as many metres as with the parameter's band, or more.
        let high = HIGH / LINEAR_FROM * math::max(self.altitude_band / altitude_band, 1.0);
        let altitude_band = 1.0 / (LINEAR_FROM * altitude_band);

        let mut velocity = initial.velocity;
        let mut error =
            flight.velocity - reference_model.desired_velocity(flight.position, velocity);
        // Of the three penalties of a step what is the same at every step.
        let horizon = self.horizon();
        let (early_steps, late_steps) = horizon.steps.split_at(STEPS - LATE);
        let (mut late, mut cost, mut turning) = (flight.velocity, -3.0 * horizon.span, 0u32);
        for steps in [early_steps, late_steps] {
            late = flight.velocity;
            for step in steps {
                let acceleration = initial.acceleration * step.accelerating;
                turning += u32::from(plan.turn);
                let desired = reference_model.desired_acceleration(
                    error,
                    acceleration,
                    vehicle.gravity(),
                    &step.gains,
                );
                reference_model.step::<A, STIFF>(
                    vehicle,
                    &mut flight,
                    &mut attitude,
                    &mut plan,
                    velocity,
                    desired,
                    wind,
                    f32::INFINITY,
                    &step.gains,
                    false,
                );
                velocity += acceleration * step.gains.h;
                error =
                    flight.velocity - reference_model.desired_velocity(flight.position, velocity);
                let altitude = math::min(-flight.position.down() * altitude_band, high);
                cost += step.gains.h
                    * (length(altitude)
                        + length(error.down() * band.down())
                        + length(error.forward() * band.forward()));
            }
        }
        let mean = (flight.velocity - late) * (1.0 / horizon.late) - initial.acceleration;
        let least = LEAST_CLOSING * vehicle.gravity();
        let to_go = Inertial::new(
            to_go(error.down(), mean.down(), least),
            to_go(error.forward(), mean.forward(), least),
        );
        cost += TO_GO
            * (to_go.down() * sinking(error.down() * band.down())
                + to_go.forward() * penalty(error.forward() * band.forward()));
        if turning > 0 {
            let turning = turning as f32 * (TURN_STEP * horizon.scale);
            // It grows as long as the wing is nearly level, and has then to be closed.
            let begun = if new { missed * missed * LEVEL } else { 0.0 };
            let beside = begun + missed * turning;
            cost += penalty(beside * band.down()) * (0.5 * turning + LATERAL_RECOVERY_TIME);
        }
        Rollout {
            cost: math::min(2.0 * LINEAR_FROM * LINEAR_FROM * cost, MAX_COST),
            error,
            to_go,
            distance: flight.position.forward() - initial.flight.position.forward(),
            thrust: flight.thrust,
        }
    }

    /// Candidate `n`: to turn to an angle of attack, with and without a push-over, or to do nothing but servo. `lift` is the
    /// wing's lift coefficient short of stall.
    #[inline(always)]
    fn candidate<A: Aerodynamics>(
        &self,
        vehicle: &Vehicle<A>,
        initial: &InitialState,
        lift: f32,
        n: u8,
    ) -> Plan {
        let n = usize::from(n);
        let turn = if n % 3 == 2 {
            RARE_CANDIDATES.get(n / 3)
        } else {
            FREQUENT_CANDIDATES.get((n - n / 3) % FREQUENT_CANDIDATES.len())
        };
        let Some(&Some((alpha, push))) = turn else {
            return Plan::default();
        };
        let flight = &initial.flight;
        let v_a = flight.velocity - initial.wind;
        let gamma = math::atan2(v_a.forward(), v_a.down());
        let target = gamma - math::PI + vehicle.thrust_line().delta() + alpha;
        let load = lift * vehicle.k_a() * v_a.norm_squared() / vehicle.weight();
        let wanted = self
            .reference_model
            .desired_velocity(flight.position, initial.velocity);
        let sinking = math::max(flight.velocity.down() - wanted.down(), 0.0);
        let saved = SINKING / PUSH_OVER * sinking / vehicle.gravity();
        Plan {
            push: math::clamp(push * (load + MORE_LOAD) - saved, 0.0, MAX_PUSH),
            target: flight.theta + wrap(target - flight.theta),
            turn: 1,
        }
    }
}

/// Time \[s\] in which `error` [m/s] closes at an `acceleration` [m/s²] relative to the reference.
#[inline(always)]
fn to_go(error: f32, acceleration: f32, least: f32) -> f32 {
    let closing = if error > 0.0 {
        -acceleration
    } else {
        acceleration
    };
    let closing = if closing > least { closing } else { least };
    math::min(error.abs() / closing, MAX_TO_GO)
}

/// z²/2, and beyond 1 in proportion to |z|.
#[inline(always)]
fn penalty(z: f32) -> f32 {
    length(z) - 1.0
}

/// The same and 1.
#[inline(always)]
fn length(z: f32) -> f32 {
    math::sqrt(1.0 + z * z)
}

/// The same for a velocity error down, in [`LINEAR_FROM`] bands. Sinking too slowly costs no more beyond [`SLOW`].
#[inline(always)]
fn sinking(z: f32) -> f32 {
    penalty(-math::min(-z, SLOW / LINEAR_FROM))
}

/// `angle` \[rad\] within ±π.
#[inline(always)]
pub(super) fn wrap(angle: f32) -> f32 {
    // 1.5·2²³: adding it leaves the nearest integer in the low bits of the sum.
    const ROUND: f32 = 12_582_912.0;
    let turns = (limited(angle, 1e3) * (0.5 / math::PI) + ROUND) - ROUND;
    angle - turns * (2.0 * math::PI)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters, Node, Polar, Table};
    use crate::vehicle::VehicleParameters;

    const DT: f32 = 0.01;
    const NONE: PlannerOptions = PlannerOptions {
        altitude_band: 0.0,
        nose_below_vertical: false,
        hold_altitude_only: false,
    };

    /// Lift coefficient short of stall, about that of the vehicles below.
    const LIFT: f32 = 0.7;

    fn planner() -> Planner {
        Planner::new(&GuidanceParameters::default(), &vehicle(2.0))
    }

    fn terms(lift_coefficient: f32) -> SearchTerms<'static> {
        SearchTerms {
            planner_options: &NONE,
            missed_lateral_acceleration: 0.0,
            lift_coefficient,
        }
    }

    fn vehicle(excess: f32) -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let p = VehicleParameters {
            thrust_max: excess * 98.1,
            ..VehicleParameters::PAPER
        };
        Vehicle::new(p, model).unwrap()
    }

    /// The next candidate is remembered, and any byte may stand there.
    #[test]
    fn a_candidate_that_is_none_is_followed_by_the_first() {
        let planner = planner();
        for next in 0..=u8::MAX {
            let mut state = PlannerState {
                looked: 1,
                next,
                ..PlannerState::default()
            };
            let (flight, reference) = (PlanarModelState::default(), Reference::default());
            planner.search(
                &vehicle(2.0),
                &mut state,
                &flight,
                &reference,
                Inertial::ZERO,
                &terms(0.0),
            );
            let after = if next < CANDIDATES - 1 { next + 1 } else { 0 };
            assert_eq!(state.next, after);
        }
    }

    /// A virtual flight on its own: what it did at worst.
    struct FlightSummary {
        end: PlanarModelState,
        low: f32,
        high: f32,
        farthest: f32,
        turns: usize,
    }

    fn fly(
        vehicle: &Vehicle<Combined>,
        initial: PlanarModelState,
        reference: impl Fn(f32) -> Reference,
        seconds: f32,
    ) -> FlightSummary {
        fly_on_wing(vehicle, initial, reference, seconds, 0.0)
    }

    /// The same with a wing of this lift coefficient.
    fn fly_on_wing<A: Aerodynamics>(
        vehicle: &Vehicle<A>,
        initial: PlanarModelState,
        reference: impl Fn(f32) -> Reference,
        seconds: f32,
        lift: f32,
    ) -> FlightSummary {
        let planner = planner();
        let (mut state, mut flight) = (PlannerState::default(), initial);
        let mut summary = FlightSummary {
            end: initial,
            low: 0.0,
            high: 0.0,
            farthest: 0.0,
            turns: 0,
        };
        for n in 0..(seconds / DT) as usize {
            let reference = reference(n as f32 * DT);
            let turning = state.plan.turn;
            planner.search(
                vehicle,
                &mut state,
                &flight,
                &reference,
                Inertial::ZERO,
                &terms(lift),
            );
            planner.reference_model.advance(
                vehicle,
                &mut flight,
                &mut state.plan,
                &reference,
                Inertial::ZERO,
                f32::INFINITY,
                DT,
            );
            summary.low = f32::max(summary.low, flight.position.down());
            summary.high = f32::max(summary.high, -flight.position.down());
            summary.farthest = f32::max(summary.farthest, flight.position.forward());
            summary.turns += usize::from(turning == 0 && state.plan.turn == 1);
            assert!(state.is_sound());
        }
        summary.end = flight;
        summary
    }

    fn hover(_: f32) -> Reference {
        Reference::default()
    }

    fn cruise() -> PlanarModelState {
        PlanarModelState {
            velocity: Inertial::new(0.0, 20.0),
            theta: -86f32.to_radians(),
            ..PlanarModelState::default()
        }
    }

    /// From 20 m/s the shortest way to stop is 15.2 m with 1 m of altitude (17.3 m at 1.15 times the weight), through
    /// stall; on the attached side alone the vehicle would go on for hundreds of metres. Measured: 23.1 and 24.1 m, 0.3 m of
    /// altitude; at the end 3e-4 m/s and 3e-4 m.
    #[test]
    fn to_stop_at_once_stall_is_crossed() {
        for (excess, farthest) in [(2.0, 25.0), (1.15, 26.0)] {
            let flight = fly(&vehicle(excess), cruise(), hover, 25.0);
            assert!(flight.turns > 0);
            assert!(flight.farthest < farthest, "{}", flight.farthest);
            assert!(flight.low < 0.5 && flight.high < 0.5);
            let PlanarModelState {
                velocity, position, ..
            } = flight.end;
            assert!(velocity.norm() < 1e-3 && position.norm() < 1e-3);
        }
    }

    #[test]
    fn steady_cruise_and_hover_are_left_alone() {
        let level = |_| Reference {
            velocity: Inertial::new(0.0, 20.0),
            acceleration: Inertial::ZERO,
        };
        let flight = fly(&vehicle(2.0), cruise(), level, 10.0);
        assert_eq!(flight.turns, 0);
        // 1e-3 m: the start is not quite the trim.
        assert!(flight.low < 2e-3 && flight.high < 2e-3);
        assert_eq!(
            fly(&vehicle(2.0), PlanarModelState::default(), hover, 10.0).turns,
            0
        );
    }

    /// Nose down at 20 m/s, and upside down at 3 m/s: the least height in which that can be left is 16.6 m and 7.0 m. Measured:
    /// 22.3 and 9.1 m.
    #[test]
    fn a_fall_is_left_nose_up() {
        for (speed, height) in [(20.0, 24.0), (3.0, 10.0)] {
            let initial = PlanarModelState {
                velocity: Inertial::new(speed, 0.0),
                theta: 3.1,
                ..PlanarModelState::default()
            };
            let flight = fly(&vehicle(2.0), initial, hover, 25.0);
            assert!(flight.low < height, "{}", flight.low);
            // 2e-5 m/s and 1e-5 rad.
            assert!(flight.end.velocity.norm() < 1e-4 && wrap(flight.end.theta).abs() < 1e-4);
        }
    }

    /// A descent of 10 m/s at 23 m/s is steeper than any glide: the vehicle flies too high and not into a dive. Measured: 1 cm
    /// too low, and 25.7 m/s, where 25.1 are asked for.
    #[test]
    fn a_sink_that_cannot_be_had_does_not_end_in_a_dive() {
        let steep = |t: f32| Reference {
            velocity: Inertial::new(10.0, 23.0) * math::min(t / 15.0, 1.0),
            acceleration: if t < 15.0 {
                Inertial::new(10.0, 23.0) / 15.0
            } else {
                Inertial::ZERO
            },
        };
        let flight = fly(&vehicle(2.0), PlanarModelState::default(), steep, 40.0);
        assert!(flight.low < 0.1 && flight.end.velocity.norm() < 27.0);
    }

    #[test]
    fn errors_count_by_their_square_and_then_in_proportion() {
        assert_eq!(penalty(0.0), 0.0);
        // z²/2, to second order in z².
        assert!((penalty(-0.1) - 0.005).abs() < 0.000_02);
        // √(1 + z²) − 1: 49.01/24.02.
        let (far, farther) = (penalty(25.0), penalty(50.0));
        assert!((farther / far - 2.0404).abs() < 1e-4);
    }

    #[test]
    fn sinking_too_slowly_costs_no_more_from_eight_bands_on() {
        assert_eq!(sinking(-1.9), penalty(1.9));
        assert_eq!(sinking(-2.1), penalty(2.0));
        assert_eq!(sinking(5.0), penalty(5.0));
    }

    #[test]
    fn the_time_to_go_is_that_of_the_closing_there_is() {
        assert_eq!(to_go(3.0, -1.5, 0.3), 2.0);
        assert_eq!(to_go(-3.0, 1.5, 0.3), 2.0);
        // Going the wrong way, or hardly closing.
        assert_eq!(to_go(3.0, 1.5, 0.3), 10.0);
        assert_eq!(to_go(300.0, -0.1, 0.3), MAX_TO_GO);
        assert_eq!(to_go(0.0, 0.0, 0.3), 0.0);
    }

    /// 2.09 s, and 3.65 s where a quarter of a turn takes long.
    #[test]
    fn a_prediction_spans_its_horizon_and_its_reference_accelerates_for_a_part_of_it() {
        for (rate, span) in [(2.8, 2.09), (1.1, 3.65)] {
            let p = GuidanceParameters {
                max_rate: rate,
                ..GuidanceParameters::default()
            };
            let planner = Planner::new(&p, &vehicle(2.0));
            let steps = &planner.horizon().steps;
            let sum = |f: &dyn Fn(&AheadStep) -> f32| steps.iter().map(f).sum::<f32>();
            // 1e-5: the rounding of 27 sums of seconds, 4 s · 6e-8 each, three times over.
            assert!((sum(&|s| s.gains.h) - planner.span()).abs() < 1e-5);
            assert!((planner.span() - span).abs() < 0.01);
            assert!((sum(&|s| s.gains.h * s.accelerating) - AHEAD).abs() < 1e-5);
            let late = |s: &[AheadStep]| s.iter().map(|s| s.gains.h).sum::<f32>();
            assert!((late(&steps[STEPS - LATE..]) - planner.horizon().late).abs() < 1e-5);
        }
    }

    /// The plans of a round are compared from where it began, wherever the flight has got to meanwhile.
    #[test]
    fn the_plans_of_a_round_have_one_start() {
        let (vehicle, planner) = (vehicle(2.0), planner());
        let look = |state: &mut PlannerState| {
            let calm = Inertial::ZERO;
            planner.search(&vehicle, state, &cruise(), &hover(0.0), calm, &terms(0.0));
        };
        let mut state = PlannerState::default();
        look(&mut state);
        let first = state.rollout;
        // Elsewhere, and in wind: the plan in force is not looked at, and nothing of this counts.
        let mut elsewhere = state;
        planner.search(
            &vehicle,
            &mut elsewhere,
            &PlanarModelState::default(),
            &hover(0.0),
            Inertial::new(0.0, 9.0),
            &terms(0.0),
        );
        look(&mut state);
        assert_eq!((elsewhere, state.rollout), (state, first));
        // From 20 m/s to a stop the first candidate, a turn past stall, is better: it takes over, and a round begins.
        assert_eq!((state.plan.turn, state.looked), (1, 0));
        look(&mut state);
        assert!(state.rollout.cost < first.cost);
    }

    /// A turn past stall gives up what the wing does for a turn of the course: it costs the velocity to the side that is lost.
    #[test]
    fn crossing_the_stall_costs_more_in_a_turn() {
        let (vehicle, planner) = (vehicle(2.0), planner());
        let initial = InitialState {
            flight: cruise(),
            ..InitialState::default()
        };
        let cost = |plan: &Plan, missed, new| {
            planner
                .predict(&vehicle, &initial, plan, planner.altitude_band, missed, new)
                .cost
        };
        let crossing = planner.candidate(&vehicle, &initial, LIFT, EMERGENCY_STOP);
        let servo = Plan::default();
        let level = cost(&crossing, 0.0, true);
        let on = cost(&crossing, 6.0, false) - level;
        let begun = cost(&crossing, 6.0, true) - level;
        assert!(on > 1.0 && begun > on, "{on} {begun}");
        assert_eq!(cost(&servo, 6.0, true), cost(&servo, 0.0, true));
    }

    /// A wing whose lift falls at once behind the stall can be flown level on either side of it. It is flown on the side that
    /// takes less thrust, if thrust costs anything.
    #[test]
    fn of_two_attitudes_the_one_with_less_thrust_is_flown() {
        let rows = [
            (0.0, 0.0, 0.01),
            (10.0, 0.9, 0.02),
            (12.0, 0.3, 0.15),
            (20.0, 0.55, 0.25),
            (45.0, 1.1, 1.1),
            (90.0, 0.0, 1.8),
            (135.0, -1.0, 1.0),
            (180.0, 0.0, 0.02),
        ];
        let nodes = rows.map(|(alpha, c_l, c_d)| Node::from_degrees(alpha, c_l, c_d));
        let polar = Polar::<7>::new(&nodes).unwrap();
        let p = VehicleParameters {
            mass: 3.0,
            k_a: 0.214,
            thrust_max: 48.0,
            ..VehicleParameters::PAPER
        };
        let vehicle = Vehicle::new(p, Table::new(&polar)).unwrap();
        let weight = vehicle.weight();
        let level = Reference {
            velocity: Inertial::new(0.0, 18.0),
            ..Reference::default()
        };
        let stalled = PlanarModelState {
            velocity: level.velocity,
            theta: (16.0f32 - 90.0).to_radians(),
            thrust: 0.55 * weight,
            ..PlanarModelState::default()
        };
        // Thrust costs nothing: it stays where it is, at 15°, and follows.
        let stays = fly_on_wing(&vehicle, stalled, |_| level, 4.0, 0.0);
        let alpha = |flight: &FlightSummary| flight.end.theta.to_degrees() + 90.0;
        assert!(alpha(&stays) > 12.0 && stays.end.thrust > 0.4 * weight);
        let crosses = fly_on_wing(&vehicle, stalled, |_| level, 4.0, 0.81);
        // A drag coefficient of 0.014 over a lift coefficient of 0.42, at 4.3°; 5 cm too high at most.
        assert!((4.0..4.6).contains(&alpha(&crosses)) && crosses.end.thrust < 0.04 * weight);
        assert!(f32::max(crosses.low, crosses.high) < 0.1);
    }

    /// Every candidate is looked at, and none so seldom that it comes too late: 27 looks take 0.4 s.
    #[test]
    fn all_candidates_are_looked_at() {
        let (vehicle, planner) = (vehicle(2.0), planner());
        let initial = InitialState {
            flight: cruise(),
            ..InitialState::default()
        };
        let plans: std::vec::Vec<_> = (0..CANDIDATES)
            .map(|n| planner.candidate(&vehicle, &initial, LIFT, n))
            .collect();
        let looks = |plan: &Plan| plans.iter().filter(|p| *p == plan).count();
        let different = plans.iter().map(|p| 1.0 / looks(p) as f32).sum::<f32>();
        assert!((different - 17.0).abs() < 1e-3);
        assert!(plans.iter().all(|p| looks(p) <= 3));
        // To an angle of attack of 46° from a course that is level forward: nose 44° from up.
        let braking = plans.first().unwrap();
        assert!((braking.target.to_degrees() + 44.2).abs() < 0.05 && braking.push == 0.0);
    }

    /// The wing climbs on its way through stall, the more so the more lift it has: the push-over is the longer. Who sinks
    /// already pushes over less, and who falls not at all.
    #[test]
    fn a_push_over_is_as_long_as_the_wing_is_strong() {
        let (vehicle, planner) = (vehicle(2.0), planner());
        let push = |sink: f32, lift: f32, n: u8| {
            let mut initial = InitialState {
                flight: cruise(),
                ..InitialState::default()
            };
            initial.flight.velocity += Inertial::new(sink, 0.0);
            planner.candidate(&vehicle, &initial, lift, n).push
        };
        // k_a |v_a|²/(m g) = 0.646·400/98.1: the load factor at a lift coefficient of 1.
        let load = 2.634;
        // The second of the candidates has the long one.
        for (n, factor) in [(EMERGENCY_STOP, SHORT_PUSH), (1, LONG_PUSH)] {
            // 1e-4 s: 2.634 has four digits.
            for lift in [0.7, 1.4] {
                let expected = factor * (lift * load + MORE_LOAD);
                assert!((push(0.0, lift, n) - math::min(expected, MAX_PUSH)).abs() < 1e-4);
            }
            assert!(push(0.0, 1.4, n) > push(0.0, 0.7, n));
        }
        // 2 m/s of sink that nobody asked for is 0.4 of that in a push-over at 1.52 g.
        let less = push(0.0, LIFT, 1) - push(2.0, LIFT, 1);
        assert!((less - 0.053).abs() < 2e-3, "{less}");
        assert_eq!(
            (push(20.0, LIFT, EMERGENCY_STOP), push(20.0, LIFT, 1)),
            (0.0, 0.0)
        );
        // A turn back to the wing begins at once.
        assert_eq!(push(0.0, LIFT, 3), 0.0);
    }

    /// A stop at once is flown alike, whichever candidate is next when it is asked for.
    #[test]
    fn a_reference_that_jumps_begins_the_candidates_anew() {
        let (vehicle, planner) = (vehicle(2.0), planner());
        let level = Reference {
            velocity: cruise().velocity,
            ..Reference::default()
        };
        let look = |state: &mut PlannerState, reference: &Reference| {
            let calm = Inertial::ZERO;
            planner.search(&vehicle, state, &cruise(), reference, calm, &terms(LIFT));
        };
        let mut plans = std::vec![];
        for before in 1..40 {
            let mut state = PlannerState::default();
            for _ in 0..before {
                look(&mut state, &level);
            }
            assert_eq!(state.plan, Plan::default());
            for _ in 0..2 {
                look(&mut state, &hover(0.0));
            }
            plans.push((state.plan, state.next, state.looked));
            // A reference that changes as references do does not: 2 m/s² for a step.
            let (next, mut slower) = (state.next, hover(0.0));
            slower.velocity += Inertial::new(0.0, 0.02);
            look(&mut state, &slower);
            assert_eq!(state.next, next);
        }
        assert!(plans.iter().all(|p| *p == plans[0]));
        assert_eq!(
            plans[0].0,
            planner.candidate(
                &vehicle,
                &InitialState {
                    flight: cruise(),
                    ..InitialState::default()
                },
                LIFT,
                EMERGENCY_STOP
            )
        );
    }

    #[test]
    fn angles_are_wrapped() {
        for turns in -3..=3 {
            let angle = 0.4 + turns as f32 * 2.0 * math::PI;
            // 2e-6: an ulp of 19.
            assert!((wrap(angle) - 0.4).abs() < 2e-6);
        }
        assert!(wrap(f32::NAN).is_nan());
    }
}
