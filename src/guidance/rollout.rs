//! What a plan comes to: the believed vehicle flown ahead by it, and its cost.
//!
//! With z the altitude error, e_d and e_f the velocity errors down and forward, each in four bands, ℓ(z) = √(1 + z²) − 1, and τ_d, τ_f the
//! times to go of what is left at the end of the horizon H, the cost of a plan is
//!
//! ```text
//! J = 32 { ∫₀ᴴ [ ℓ(min(z, z_high)) + ℓ(e_d) + ℓ(e_f) ] dt        errors on the way
//!        + w [ τ_d ℓ(max(e_d, −2)) + τ_f ℓ(e_f) ]             errors that are left
//!        + ℓ(e_s) (t_turn/2 + 0.6 s) }                           velocity to the side that a turn of attitude gives up
//!   + 4 w_T · reserve · T(0) T(H)/(m g)²                            thrust that is spent where the wing has lift in reserve
//! ```
//!
//! in seconds, with the weights w = `to_go` and w_T = `terminal_thrust` of [`Tuning`](super::tuning::Tuning).
//! Each term is at least zero.

use super::memory::memory;
use super::reference_model::{Plan, PlanarModelState, ReferenceModel, StepGains};
use crate::aero::Aerodynamics;
use crate::frame::{Attitude, Inertial};
use crate::math;
use crate::vehicle::Vehicle;

/// Steps of a rollout, the first of the short one \[s\], and the growth from one to the next: 2.09 s in all.
pub(super) const STEPS: usize = 27;
const FIRST_STEP: f32 = 0.045;
const GROWTH: f32 = 1.039;
/// Steps at the end over which it is measured how fast an error closes.
const LATE: usize = 6;
/// How long the reference is taken to accelerate on \[s\].
const AHEAD: f32 = 0.75;
/// Errors count by their square, and from this many bands on in proportion.
const LINEAR_FROM: f32 = 4.0;
/// Seconds of the cost per second and square of a band.
const SCALE: f32 = 2.0 * LINEAR_FROM * LINEAR_FROM;
/// Time to go: greatest \[s\], least closing taken for it, in g.
pub(super) const MAX_TO_GO: f32 = 20.0;
const LEAST_CLOSING: f32 = 0.035;
/// The altitude penalty saturates at so many bands above the reference, and the penalty of a sink that is too slow at so many velocity bands.
/// A reference that sinks more steeply than the vehicle can is not worth a dive.
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
/// Lift from which on thrust costs anything, and how much more it takes until it costs all of that, over the weight. With less
/// in reserve a gust or a slow rate loop throws the wing back behind the stall.
const LIFT_RESERVE_START: f32 = 1.25;
const LIFT_RESERVE_SPAN: f32 = 0.25;

/// A step of a rollout.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct AheadStep {
    gains: StepGains,
    /// 1 while the reference is taken to accelerate, then 0, and a part of the step between.
    accelerating: f32,
}

/// How far a rollout looks ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Horizon {
    steps: [AheadStep; STEPS],
    /// The time of all of them, and of the last [`LATE`] \[s\].
    pub span: f32,
    late: f32,
    /// Length over that of the short one.
    scale: f32,
}

/// Greatest pitch rate [rad/s] below which the horizon is a long one: that of a quarter of a turn in 1.1 s, half of the short one.
const SLOW_RATE: f32 = 1.4;
/// Length of the long one over that of the short one. A pull-up is the way in which an elevon wing stops, and a plan that does not see its
/// end is none. Of 400 random brakings 12 did not end in hover with the short one and the moment of a wing that is not stalled; 9 do not. 1.75
/// was taken of 1.5, 1.75 and 2, which differ by chance on the flights that were lost.
const LONG: f32 = 1.75;

impl Horizon {
    /// The horizon of a vehicle that turns by at most `rate` [rad/s], in steps of its `model`.
    pub fn new(rate: f32, model: &ReferenceModel) -> Self {
        let scale = if rate < SLOW_RATE { LONG } else { 1.0 };
        let mut h = scale * FIRST_STEP;
        let mut span = 0.0;
        let steps = core::array::from_fn(|_| {
            let step = AheadStep {
                gains: model.gains(h),
                accelerating: math::clamp((AHEAD - span) / h, 0.0, 1.0),
            };
            span += h;
            h *= GROWTH;
            step
        });
        let late = steps[STEPS - LATE..].iter().map(|s: &AheadStep| s.gains.h);
        Self {
            late: late.sum(),
            steps,
            span,
            scale,
        }
    }
}

/// From where plans are flown ahead, and what they are to mind. The fast step leaves it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct PlanRequest {
    pub flight: PlanarModelState,
    pub wind: Inertial,
    /// Reference velocity [m/s] and acceleration [m/s²].
    pub velocity: Inertial,
    pub acceleration: Inertial,
    /// Gravity in the plane of flight [m/s²].
    pub gravity: f32,
    /// The air's force over the believed one.
    pub air_force_scale: f32,
    /// Part \[N\] of the greatest thrust that is not there.
    pub missing_thrust: f32,
    /// Acceleration to the side [m/s²] that a plan gives up while it turns to an attitude far away.
    pub missed_lateral_acceleration: f32,
    /// Altitude error \[m\] that costs as much as an error of one velocity band.
    pub altitude_band: f32,
}

memory!(PlanRequest {
    flight: PlanarModelState,
    wind: Inertial,
    velocity: Inertial,
    acceleration: Inertial,
    gravity: f32,
    air_force_scale: f32,
    missing_thrust: f32,
    missed_lateral_acceleration: f32,
    altitude_band: f32,
});

/// What a plan comes to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Rollout {
    /// Its cost \[s\].
    pub cost: f32,
    /// Velocity error at the end of the horizon [m/s]: velocity less the velocity wanted.
    pub error: Inertial,
    /// How long \[s\] it will take to close, down and forward; at most [`MAX_TO_GO`].
    pub to_go: Inertial,
    /// Forward position at the end of the horizon less that at its beginning \[m\].
    pub distance: f32,
    /// Thrust at the end of the horizon \[N\].
    pub thrust: f32,
}

memory!(Rollout {
    cost: f32,
    error: Inertial,
    to_go: Inertial,
    distance: f32,
    thrust: f32,
});

const MAX_COST: f32 = 1e9;
const MAX_NUMBER: f32 = 1e12;

impl Rollout {
    /// Whether every number is one that a rollout can have left. NaN is not.
    pub fn is_sound(&self) -> bool {
        self.error.norm_squared() <= MAX_NUMBER
            && self.to_go.norm_squared() <= 2.1 * MAX_TO_GO * MAX_TO_GO
            && self.distance.abs() + self.thrust.abs() + self.cost.abs() <= MAX_NUMBER
    }
}

/// What rollouts of a vehicle have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Cost {
    /// Altitude error \[m\] and velocity errors [m/s] that count as one.
    pub altitude_band: f32,
    pub velocity_band: Inertial,
    /// Lift coefficient of the wing short of stall.
    pub lift_coefficient: f32,
    /// Weights of the time to go, and of thrust that is spent from the beginning to the end \[s\].
    pub to_go: f32,
    pub terminal_thrust: f32,
}

/// How much of a rollout was flown.
pub(super) enum Flown {
    /// All of it.
    ToTheEnd(Rollout),
    /// So many steps: by then it cost more than the bound.
    Dearer(usize),
}

impl Cost {
    /// The parts of an `error` of velocity [m/s], down and forward, in multiples of their bands.
    #[inline(always)]
    pub fn bands(&self, error: Inertial) -> (f32, f32) {
        (
            error.down().abs() / self.velocity_band.down(),
            error.forward().abs() / self.velocity_band.forward(),
        )
    }

    /// What all plans of a `request` cost, whatever they do: the altitude error below the reference beyond which it counts in proportion \[s\].
    #[inline(always)]
    pub fn of_depth(&self, request: &PlanRequest, horizon: &Horizon) -> f32 {
        let below = request.flight.position.down() / (LINEAR_FROM * request.altitude_band);
        SCALE * horizon.span * math::max(below - 1.0, 0.0)
    }

    /// What `plan` comes to if it is flown for the `horizon`, unless it costs `bound` or more. Whether it is `new` or in force decides
    /// whether the wing is yet to be levelled for it.
    #[inline(always)]
    #[expect(clippy::too_many_arguments)]
    pub fn of<A: Aerodynamics>(
        &self,
        reference_model: &ReferenceModel,
        horizon: &Horizon,
        vehicle: &Vehicle<A>,
        request: &PlanRequest,
        plan: &Plan,
        new: bool,
        bound: f32,
    ) -> Flown {
        let air = (request.flight.velocity - request.wind) * (vehicle.k_a() / vehicle.mass());
        let stiff = STIFF / horizon.scale;
        if air.norm_squared() > stiff * stiff {
            self.of_flight::<A, true>(reference_model, horizon, vehicle, request, plan, new, bound)
        } else {
            self.of_flight::<A, false>(reference_model, horizon, vehicle, request, plan, new, bound)
        }
    }

    /// The same, with or without what steps of `STIFF` flights need, for its time.
    #[inline(never)]
    #[expect(clippy::too_many_arguments)]
    fn of_flight<A: Aerodynamics, const STIFF: bool>(
        &self,
        reference_model: &ReferenceModel,
        horizon: &Horizon,
        vehicle: &Vehicle<A>,
        request: &PlanRequest,
        plan: &Plan,
        new: bool,
        bound: f32,
    ) -> Flown {
        let (mut flight, mut plan, wind) = (request.flight, *plan, request.wind);
        let mut attitude = Attitude::from_angle(flight.theta);
        let band = Inertial::new(
            1.0 / (LINEAR_FROM * self.velocity_band.down()),
            1.0 / (LINEAR_FROM * self.velocity_band.forward()),
        );
        // Too high is as many metres as with the parameter's band, or more.
        let high = HIGH / LINEAR_FROM * math::max(self.altitude_band / request.altitude_band, 1.0);
        let altitude_band = 1.0 / (LINEAR_FROM * request.altitude_band);

        // A power of two: nothing is rounded.
        let most = bound * (1.0 / SCALE);

        let mut velocity = request.velocity;
        let mut error =
            flight.velocity - reference_model.desired_velocity(flight.position, velocity, wind);
        let (mut late, mut cost, mut turning) = (flight.velocity, 0.0, 0u32);
        for (n, step) in horizon.steps.iter().enumerate() {
            if n == STEPS - LATE {
                late = flight.velocity;
            }
            let gains = &step.gains;
            let acceleration = request.acceleration * step.accelerating;
            turning += u32::from(plan.turn);
            let desired =
                reference_model.desired_acceleration(error, acceleration, vehicle.gravity(), gains);
            reference_model.step::<A, STIFF>(
                vehicle,
                &mut flight,
                &mut attitude,
                &mut plan,
                velocity,
                desired,
                wind,
                f32::INFINITY,
                gains,
                false,
            );
            velocity += acceleration * gains.h;
            error =
                flight.velocity - reference_model.desired_velocity(flight.position, velocity, wind);
            let altitude = math::min(-flight.position.down() * altitude_band, high);
            cost += gains.h
                * (length(altitude)
                    + length(error.down() * band.down())
                    + length(error.forward() * band.forward())
                    - 3.0);
            if cost >= most {
                return Flown::Dearer(n + 1);
            }
        }
        let mean = (flight.velocity - late) * (1.0 / horizon.late) - request.acceleration;
        let least = LEAST_CLOSING * vehicle.gravity();
        let to_go = Inertial::new(
            to_go(error.down(), mean.down(), least),
            to_go(error.forward(), mean.forward(), least),
        );
        cost += self.to_go
            * (to_go.down() * sinking(error.down() * band.down())
                + to_go.forward() * penalty(error.forward() * band.forward()));
        if turning > 0 {
            let turning = turning as f32 * (TURN_STEP * horizon.scale);
            // It grows as long as the wing is nearly level, and has then to be closed.
            let missed = request.missed_lateral_acceleration;
            let begun = if new { missed * missed * LEVEL } else { 0.0 };
            let beside = begun + missed * turning;
            cost += penalty(beside * band.down()) * (0.5 * turning + LATERAL_RECOVERY_TIME);
        }
        Flown::ToTheEnd(Rollout {
            cost: math::min(
                SCALE * cost + self.of_thrust(vehicle, request, flight.thrust),
                MAX_COST,
            ),
            error,
            to_go,
            distance: flight.position.forward() - request.flight.position.forward(),
            thrust: flight.thrust,
        })
    }

    /// What thrust costs from the beginning to the end of a rollout where the wing could carry more than the weight: what can be flown on
    /// either side of stall is flown on the wing, and not with half of the weight on the thrust. Without thrust at the beginning, as where
    /// the vehicle brakes or coasts, it costs nothing: plans that brake behind the stall would else come late.
    #[inline(always)]
    fn of_thrust<A: Aerodynamics>(
        &self,
        vehicle: &Vehicle<A>,
        request: &PlanRequest,
        thrust: f32,
    ) -> f32 {
        let air = request.flight.velocity - request.wind;
        let weight = vehicle.weight();
        let lift = self.lift_coefficient * vehicle.k_a() * air.norm_squared();
        let reserve = lift - LIFT_RESERVE_START * weight;
        let reserve = math::clamp(reserve, 0.0, LIFT_RESERVE_SPAN * weight) / weight;
        let (now, then) = (request.flight.thrust / weight, thrust / weight);
        math::max(
            self.terminal_thrust / LIFT_RESERVE_SPAN * reserve * now * then,
            0.0,
        )
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::guidance::{GuidanceParameters, Tuning};
    use crate::vehicle::VehicleParameters;

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
    fn a_rollout_spans_its_horizon_and_its_reference_accelerates_for_a_part_of_it() {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
        let model =
            ReferenceModel::new(&GuidanceParameters::default(), &vehicle, &Tuning::default());
        for (rate, span) in [(2.8, 2.09), (1.1, 3.65)] {
            let horizon = Horizon::new(rate, &model);
            let steps = &horizon.steps;
            let sum = |f: &dyn Fn(&AheadStep) -> f32| steps.iter().map(f).sum::<f32>();
            // 1e-5: the rounding of 27 sums of seconds, 4 s · 6e-8 each, three times over.
            assert!((sum(&|s| s.gains.h) - horizon.span).abs() < 1e-5);
            assert!((horizon.span - span).abs() < 0.01);
            assert!((sum(&|s| s.gains.h * s.accelerating) - AHEAD).abs() < 1e-5);
            let (first, last) = (&steps[0].gains, &steps[STEPS - 1].gains);
            // 27 - 1 growths.
            assert!((last.h / first.h - 1.039f32.powi(26)).abs() < 1e-4);
            // The last six of a geometric series.
            let late = last.h * (1.0 - 1.039f32.powi(-6)) / (1.0 - 1.0 / 1.039);
            assert!((late - horizon.late).abs() < 1e-5);
        }
    }
}
