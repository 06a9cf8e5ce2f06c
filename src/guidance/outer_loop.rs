//! Position hold and integral action, around the velocity law (not in the paper).

use super::parameters::GuidanceParameters;
use super::reference_limit::ReferenceLimit;
use super::status::Status;
use crate::frame::{Attitude, Body, Inertial};
use crate::math;
use crate::reference::Reference;

/// Position hold and integral action.
///
/// v_cmd = v_s − sat(k_p x̃) − I, İ = k_i sat(k_p x̃), with the derivative of v_cmd fed to a_r. Both act on the velocity
/// asked for. An integral at the level of force would be nearly inert at speed: its slow pole is
/// −k3 h/(4 k2 |F_p|²) for an integral gain h.
///
/// Where no position is measured, İ = k_p (v − v_s): the integral is then the position that would have been held,
/// and does the position hold's work inside its bound.
///
/// v_cmd is kept within `max_velocity_error` of the forward velocity. A vehicle that glides with its thrust at the lower
/// limit can only be steered across its nose, and the velocity error across the nose is then v_cmd's own component
/// there: it levels the path off while v_cmd points forward, not at all where v_cmd is zero, and turns the path away
/// where v_cmd points back, as it soon does while the vehicle runs ahead of a reference that brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OuterLoop {
    position_gain: Inertial,
    max_velocity: Inertial,
    integral_gain: Inertial,
    max_integral: Inertial,
    max_velocity_error: f32,
}

/// The integral.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OuterState {
    /// I [m/s].
    pub integral: Inertial,
}

/// What the outer loop looks at.
pub(super) struct OuterInput<'a> {
    pub velocity: Inertial,
    pub attitude: Attitude,
    /// The reference asked for, whose integral the position error is measured from.
    pub asked: &'a Reference,
    /// The reference followed.
    pub followed: &'a Reference,
    /// x̃ \[m\], position less reference position.
    pub position_error: Option<Inertial>,
    /// What of the last command saturated.
    pub saturated: Status,
    /// The last angular rate commanded [rad/s], whose sign says at which limit it stands.
    pub rate: f32,
    /// 1 on the branch θ̃ = 0, −1 on θ̃ = π: the sign with which the law turns a velocity error into a rate.
    pub branch: f32,
}

impl OuterLoop {
    /// The loop with these parameters, which have been checked.
    pub fn new(p: &GuidanceParameters) -> Self {
        Self {
            position_gain: Inertial::new(p.position_gain_down, p.position_gain_forward),
            max_velocity: Inertial::new(p.max_velocity_down, p.max_velocity_forward),
            integral_gain: Inertial::new(p.integral_gain_down, p.integral_gain_forward),
            max_integral: Inertial::new(p.max_integral_down, p.max_integral_forward),
            max_velocity_error: p.max_velocity_error,
        }
    }

    /// Whether the integral is inside its bounds. NaN is not.
    #[inline(always)]
    pub(super) fn is_sound(&self, state: &OuterState) -> bool {
        state.integral.down().abs() <= self.max_integral.down()
            && state.integral.forward().abs() <= self.max_integral.forward()
    }

    /// `integral` [m/s] inside its limits.
    pub(super) fn limited(&self, integral: Inertial) -> Inertial {
        let limit = |value, limit: f32| math::clamp(value, -limit, limit);
        Inertial::new(
            limit(integral.down(), self.max_integral.down()),
            limit(integral.forward(), self.max_integral.forward()),
        )
    }

    /// The reference for the velocity law; the integral moves on by `dt` \[s\].
    ///
    /// The integral obeys the limits: it does not grow along the thrust line against a thrust that stands at its
    /// limit, nor across it against an angular rate that does, nor while the velocity it is fed from stands at its own.
    /// Nothing keeps it from returning to zero.
    #[inline(always)]
    pub(super) fn update(
        &self,
        state: &mut OuterState,
        limit: &ReferenceLimit,
        input: &OuterInput,
        dt: f32,
    ) -> (Reference, Status) {
        let OuterInput {
            velocity,
            asked,
            followed,
            ..
        } = input;
        let velocity_error = match input.position_error {
            Some(_) => *velocity - asked.velocity,
            None => *velocity - followed.velocity,
        };
        let x = input.position_error.unwrap_or(Inertial::ZERO);
        let holds = input.position_error.is_some();
        let down = axis(
            holds,
            x.down(),
            velocity_error.down(),
            self.position_gain.down(),
            self.max_velocity.down(),
            self.integral_gain.down(),
        );
        let forward = axis(
            holds,
            x.forward(),
            velocity_error.forward(),
            self.position_gain.forward(),
            self.max_velocity.forward(),
            self.integral_gain.forward(),
        );
        let wanted = Inertial::new(down.growth, forward.growth);
        let allowed = gate(
            Inertial::new(
                if down.saturated { 0.0 } else { down.growth },
                if forward.saturated {
                    0.0
                } else {
                    forward.growth
                },
            ),
            input,
        );
        let (i_down, fed_down, full_down) = grow(
            state.integral.down(),
            wanted.down(),
            allowed.down(),
            self.max_integral.down(),
            dt,
        );
        let (i_forward, fed_forward, full_forward) = grow(
            state.integral.forward(),
            wanted.forward(),
            allowed.forward(),
            self.max_integral.forward(),
            dt,
        );
        state.integral = Inertial::new(i_down, i_forward);
        let (acceleration, limited) = limit.cut(Inertial::new(
            followed.acceleration.down() - down.slope - fed_down,
            followed.acceleration.forward() - forward.slope - fed_forward,
        ));
        let asked_for = Inertial::new(
            followed.velocity.down() - down.velocity - i_down,
            followed.velocity.forward() - forward.velocity - i_forward,
        );
        let near = math::clamp(
            asked_for.forward(),
            velocity.forward() - self.max_velocity_error,
            velocity.forward() + self.max_velocity_error,
        );
        let reference = Reference {
            velocity: Inertial::new(asked_for.down(), near),
            acceleration,
        };
        let status = Status::POSITION.when(down.saturated | forward.saturated)
            | Status::INTEGRAL.when(full_down | full_forward)
            | Status::REFERENCE.when(limited)
            | Status::VELOCITY_ERROR.when(near != asked_for.forward());
        (reference, status)
    }
}

/// One axis of the velocity towards the reference position.
struct Axis {
    /// sat(k_p x̃) [m/s].
    velocity: f32,
    /// Its derivative [m/s²].
    slope: f32,
    /// İ before anti-windup [m/s²].
    growth: f32,
    saturated: bool,
}

/// The velocity for a position error `x` \[m\] that grows with `velocity_error` [m/s]; where no position `holds`, only
/// the integral's growth from `velocity_error`.
#[inline(always)]
fn axis(holds: bool, x: f32, velocity_error: f32, k_p: f32, max: f32, k_i: f32) -> Axis {
    let wanted = k_p * x;
    let velocity = math::clamp(wanted, -max, max);
    let rate = k_p * velocity_error;
    if !holds {
        Axis {
            velocity: 0.0,
            slope: 0.0,
            growth: rate,
            saturated: false,
        }
    } else {
        let saturated = velocity != wanted;
        Axis {
            velocity,
            slope: if saturated { 0.0 } else { rate },
            growth: k_i * velocity,
            saturated,
        }
    }
}

/// The integral after `dt`, what of its growth feeds a_r, and whether it is full. It grows by what the limits allow;
/// where the growth wanted leads it back to zero, by all of that.
#[inline(always)]
fn grow(integral: f32, wanted: f32, allowed: f32, bound: f32, dt: f32) -> (f32, f32, bool) {
    let growth = if wanted * integral < 0.0 {
        wanted
    } else {
        allowed
    };
    let moved = integral + growth * dt;
    let kept = math::clamp(moved, -bound, bound);
    // A full integral moves no more, and feeds nothing.
    if kept == moved {
        (kept, growth, false)
    } else {
        (kept, 0.0, true)
    }
}

/// The part of İ that the actuators can still obey.
///
/// A growing integral lowers the velocity asked for. Along i, against thrust, that asks for more thrust; across it, the
/// law asks for a greater rate on θ̃ = 0, and for a smaller one on θ̃ = π.
#[inline(always)]
fn gate(growth: Inertial, input: &OuterInput) -> Inertial {
    let saturated = input.saturated;
    if !saturated.intersects(Status::THRUST_LOW | Status::THRUST_HIGH | Status::RATE) {
        return growth;
    }
    let g = input.attitude.to_body(growth);
    let (mut along, mut across) = (g.i(), g.j());
    if saturated.contains(Status::THRUST_HIGH) {
        along = math::min(along, 0.0);
    }
    if saturated.contains(Status::THRUST_LOW) {
        along = -math::min(-along, 0.0);
    }
    if saturated.contains(Status::RATE) && across * input.branch * input.rate > 0.0 {
        across = 0.0;
    }
    input.attitude.to_inertial(Body::new(along, across))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f32 = 0.01;
    const STAY: Reference = Reference {
        velocity: Inertial::ZERO,
        acceleration: Inertial::ZERO,
    };

    fn update(
        state: &mut OuterState,
        velocity: Inertial,
        position_error: Option<Inertial>,
        saturated: Status,
    ) -> (Reference, Status) {
        update_at(state, velocity, position_error, saturated, 0.0)
    }

    fn update_at(
        state: &mut OuterState,
        velocity: Inertial,
        position_error: Option<Inertial>,
        saturated: Status,
        rate: f32,
    ) -> (Reference, Status) {
        let p = GuidanceParameters::default();
        let limit = ReferenceLimit::new(&p);
        let input = OuterInput {
            velocity,
            attitude: Attitude::NOSE_UP,
            asked: &STAY,
            followed: &STAY,
            position_error,
            saturated,
            rate,
            branch: 1.0,
        };
        OuterLoop::new(&p).update(state, &limit, &input, DT)
    }

    #[test]
    fn at_rest_in_place_the_reference_passes() {
        let mut state = OuterState::default();
        let out = update(
            &mut state,
            Inertial::ZERO,
            Some(Inertial::ZERO),
            Status::empty(),
        );
        assert_eq!(out, (STAY, Status::empty()));
        assert_eq!(state, OuterState::default());
    }

    /// a_cmd is the derivative of v_cmd, by differences along a motion with ẋ̃ = v − v_r.
    #[test]
    fn the_acceleration_is_the_derivative_of_the_velocity() {
        let (mut state, v) = (OuterState::default(), Inertial::new(0.7, -0.4));
        let x = |n: u8| Some(Inertial::new(0.5, 1.0) + v * (f32::from(n) * DT));
        let (first, _) = update(&mut state, v, x(0), Status::empty());
        let (second, _) = update(&mut state, v, x(1), Status::empty());
        let by_difference = (second.velocity - first.velocity) / DT;
        // 2e-3: one step of 10 ms of an integral that grows with the pull, and roundings over DT.
        assert!((by_difference - second.acceleration).norm() < 2e-3);
    }

    #[test]
    fn the_pull_is_bounded_and_then_neither_feeds_nor_winds_up() {
        let mut state = OuterState::default();
        let (reference, status) = update(
            &mut state,
            Inertial::new(0.0, 2.0),
            Some(Inertial::new(0.0, 50.0)),
            Status::empty(),
        );
        assert_eq!(reference.velocity, Inertial::new(0.0, -6.0));
        assert_eq!(reference.acceleration, Inertial::ZERO);
        assert_eq!(status, Status::POSITION);
        assert_eq!(state, OuterState::default());
    }

    /// Standing still against a pull of 6 m/s v_cmd is the pull's; at 10 m/s it would be 16 m/s off, and is 14 m/s off,
    /// whichever way; downward it is not bounded.
    #[test]
    fn the_forward_velocity_error_is_bounded() {
        let v_cmd = |forward: f32, x: f32| {
            let velocity = Inertial::new(20.0, forward);
            let error = Some(Inertial::new(0.0, x));
            let state = &mut OuterState::default();
            let (reference, status) = update(state, velocity, error, Status::empty());
            assert_eq!(reference.velocity.down(), 0.0);
            let bounded = status.contains(Status::VELOCITY_ERROR);
            (reference.velocity.forward(), bounded)
        };
        assert_eq!(v_cmd(0.0, 100.0), (-6.0, false));
        assert_eq!(v_cmd(10.0, 100.0), (-4.0, true));
        assert_eq!(v_cmd(-10.0, -100.0), (4.0, true));
        assert_eq!(v_cmd(8.0, 100.0), (-6.0, false));
    }

    #[test]
    fn the_integral_is_bounded() {
        let mut state = OuterState::default();
        let mut last = Status::empty();
        for _ in 0..2000 {
            last = update(
                &mut state,
                Inertial::ZERO,
                Some(Inertial::new(2.0, -9.0)),
                Status::empty(),
            )
            .1;
        }
        assert_eq!(state.integral, Inertial::new(2.0, -1.0));
        assert_eq!(last, Status::INTEGRAL);
    }

    #[test]
    fn the_integral_obeys_the_limits() {
        let grown = |x, saturated, rate| {
            let mut state = OuterState::default();
            update_at(&mut state, Inertial::ZERO, Some(x), saturated, rate);
            state.integral
        };
        // Below the reference position: more thrust is asked for.
        let low = Inertial::new(1.0, 1.0);
        let free = grown(low, Status::empty(), 0.0);
        assert!(free.down() > 0.0 && free.forward() > 0.0);
        assert_eq!(grown(low, Status::THRUST_LOW, 0.0), free);
        assert_eq!(grown(low, Status::THRUST_HIGH, 0.0).down(), 0.0);
        assert_eq!(
            grown(low, Status::THRUST_HIGH, 0.0).forward(),
            free.forward()
        );
        // Ahead of it: a greater rate is asked for, against the upper limit of the rate but not against the lower.
        assert_eq!(grown(low, Status::RATE, 2.8).forward(), 0.0);
        assert_eq!(grown(low, Status::RATE, -2.8), free);
        assert_eq!(grown(low, Status::RATE, 2.8).down(), free.down());
        // Above it: less.
        let high = Inertial::new(-1.0, 0.0);
        assert!(grown(high, Status::THRUST_HIGH, 0.0).down() < 0.0);
        assert_eq!(grown(high, Status::THRUST_LOW, 0.0).down(), 0.0);
    }

    /// Whatever saturates, an integral may return to zero.
    #[test]
    fn limits_do_not_stop_unwinding() {
        let all = Status::THRUST_LOW | Status::THRUST_HIGH | Status::RATE;
        for sign in [1.0, -1.0] {
            // Near the reference position, and so far from it that the velocity towards it saturates.
            for far in [1.0, 50.0] {
                let before = Inertial::new(-1.5, -0.5) * sign;
                let mut state = OuterState { integral: before };
                let x = Inertial::new(far, far) * sign;
                for _ in 0..10 {
                    update_at(&mut state, Inertial::ZERO, Some(x), all, 2.8 * sign);
                }
                assert!(state.integral.down().abs() < 1.49, "{sign} {far}");
                assert!(state.integral.forward().abs() < 0.499, "{sign} {far}");
            }
        }
    }

    #[test]
    fn without_a_position_the_integral_holds_the_one_there_was() {
        let (mut state, mut fallen) = (OuterState::default(), 0.0);
        let v = Inertial::new(0.5, 0.0);
        for _ in 0..100 {
            update(&mut state, v, None, Status::empty());
            fallen += 0.5 * DT;
        }
        // 1e-5: roundings of a hundred additions.
        assert!((state.integral.down() - 0.8 * fallen).abs() < 1e-5);
    }

    #[test]
    fn an_integral_beyond_its_bounds_is_not_sound() {
        let outer = OuterLoop::new(&GuidanceParameters::default());
        let sound = |down, forward| {
            outer.is_sound(&OuterState {
                integral: Inertial::new(down, forward),
            })
        };
        assert!(sound(2.0, -1.0));
        assert!(!sound(2.1, 0.0) && !sound(0.0, -1.1) && !sound(f32::NAN, 0.0));
    }
}
