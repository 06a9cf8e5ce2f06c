//! Position hold and integral action, around the velocity law (not in the paper).

use super::reference_limit::ReferenceLimit;
use super::status::Status;
use crate::error::{ParameterError, in_range, positive};
use crate::frame::{Attitude, Body, Inertial};
use crate::math;
use crate::reference::Reference;

/// Parameters of the outer loop, along (down, forward). A gain of zero turns its action off.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OuterLoopParameters {
    /// k_p [1/s]: velocity per position error.
    pub position_gain: Inertial,
    /// Largest velocity [m/s] towards the reference position.
    pub pull: Inertial,
    /// k_i [1/s]: growth of the integral per velocity of the pull.
    pub integral_gain: Inertial,
    /// Largest integral [m/s].
    pub integral: Inertial,
    /// Largest forward velocity error [m/s] that the law is given.
    pub forward_error: f32,
}

/// Position hold and integral action.
///
/// v_cmd = v_s − sat(k_p x̃) − I, İ = k_i sat(k_p x̃), with the derivative of v_cmd fed to a_r. Both act on the velocity
/// asked for. An integral at the level of force would be nearly inert at speed: its slow pole is
/// −k3 h/(4 k2 |F_p|²) for an integral gain h.
///
/// Where no position is measured, İ = k_p (v − v_s): the integral is then the position that would have been held,
/// and does the pull's work inside its bound.
///
/// v_cmd is kept within `forward_error` of the forward velocity. A vehicle that glides with its thrust at the lower
/// limit can only be steered across its nose, and the velocity error across the nose is then v_cmd's own component
/// there: it levels the path off while v_cmd points forward, not at all where v_cmd is zero, and turns the path away
/// where v_cmd points back, as it soon does while the vehicle runs ahead of a reference that brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OuterLoop {
    p: OuterLoopParameters,
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
    /// Limits that the last command met.
    pub met: Status,
}

impl OuterLoop {
    /// The loop with these parameters.
    ///
    /// # Errors
    /// A gain outside [0, 100] 1/s, `pull` or `integral` outside [0, 1000] m/s, `forward_error` outside
    /// [0.001, 1000] m/s, or any not finite.
    pub fn new(p: OuterLoopParameters) -> Result<Self, ParameterError> {
        let check = |name, v: Inertial, max| {
            in_range(name, v.down(), 0.0, max)?;
            in_range(name, v.forward(), 0.0, max)
        };
        check("position_gain", p.position_gain, 100.0)?;
        check("pull", p.pull, 1e3)?;
        check("integral_gain", p.integral_gain, 100.0)?;
        check("integral", p.integral, 1e3)?;
        positive("forward_error", p.forward_error, 1e-3, 1e3)?;
        Ok(Self { p })
    }

    /// The reference for the velocity law; the integral moves on by `dt` \[s\].
    ///
    /// The integral obeys the limits: it does not grow along the thrust line against a thrust that stands at its
    /// limit, nor across it while the angular rate does, nor while the pull it is fed from stands at its own.
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
        let slip = match input.position_error {
            Some(_) => *velocity - asked.velocity,
            None => *velocity - followed.velocity,
        };
        let x = input.position_error.unwrap_or(Inertial::ZERO);
        let holds = input.position_error.is_some();
        let p = &self.p;
        let down = axis(
            holds,
            x.down(),
            slip.down(),
            p.position_gain.down(),
            p.pull.down(),
            p.integral_gain.down(),
        );
        let forward = axis(
            holds,
            x.forward(),
            slip.forward(),
            p.position_gain.forward(),
            p.pull.forward(),
            p.integral_gain.forward(),
        );
        let growth = unwind(
            Inertial::new(down.growth, forward.growth),
            input.attitude,
            input.met,
        );
        let (i_down, fed_down, full_down) =
            grow(state.integral.down(), growth.down(), p.integral.down(), dt);
        let (i_forward, fed_forward, full_forward) = grow(
            state.integral.forward(),
            growth.forward(),
            p.integral.forward(),
            dt,
        );
        state.integral = Inertial::new(i_down, i_forward);
        let (acceleration, cut) = limit.cut(Inertial::new(
            followed.acceleration.down() - down.slope - fed_down,
            followed.acceleration.forward() - forward.slope - fed_forward,
        ));
        let wanted = Inertial::new(
            followed.velocity.down() - down.pull - i_down,
            followed.velocity.forward() - forward.pull - i_forward,
        );
        let near = math::clamp(
            wanted.forward(),
            velocity.forward() - p.forward_error,
            velocity.forward() + p.forward_error,
        );
        let reference = Reference {
            velocity: Inertial::new(wanted.down(), near),
            acceleration,
        };
        let status = Status::POSITION.when(down.cut | forward.cut)
            | Status::INTEGRAL.when(full_down | full_forward)
            | Status::REFERENCE.when(cut)
            | Status::VELOCITY_ERROR.when(near != wanted.forward());
        (reference, status)
    }
}

/// One axis of the pull.
struct Axis {
    pull: f32,
    /// Derivative of the pull [m/s²].
    slope: f32,
    /// İ before anti-windup [m/s²].
    growth: f32,
    cut: bool,
}

/// The pull of a position error `x` \[m\] that grows with `slip` [m/s]; or only the integral's growth from `slip`.
#[inline(always)]
fn axis(holds: bool, x: f32, slip: f32, k_p: f32, bound: f32, k_i: f32) -> Axis {
    let wanted = k_p * x;
    let pull = math::clamp(wanted, -bound, bound);
    let rate = k_p * slip;
    if !holds {
        Axis {
            pull: 0.0,
            slope: 0.0,
            growth: rate,
            cut: false,
        }
    } else if pull == wanted {
        Axis {
            pull,
            slope: rate,
            growth: k_i * pull,
            cut: false,
        }
    } else {
        Axis {
            pull,
            slope: 0.0,
            growth: 0.0,
            cut: true,
        }
    }
}

/// The integral after `dt`, what of its growth feeds a_r, and whether it is full.
#[inline(always)]
fn grow(integral: f32, growth: f32, bound: f32, dt: f32) -> (f32, f32, bool) {
    let wanted = integral + growth * dt;
    let kept = math::clamp(wanted, -bound, bound);
    // A full integral moves no more, and feeds nothing.
    if kept == wanted {
        (kept, growth, false)
    } else {
        (kept, 0.0, true)
    }
}

/// The part of İ that the actuators can still obey.
#[inline(always)]
fn unwind(growth: Inertial, attitude: Attitude, met: Status) -> Inertial {
    const ANY: u16 = Status::THRUST_LOW.bits() | Status::THRUST_HIGH.bits() | Status::RATE.bits();
    if met.bits() & ANY == 0 {
        return growth;
    }
    // A growing integral lowers the velocity asked for, and along i, against thrust, that asks for more thrust.
    let Body(mut g) = attitude.to_body(growth);
    if met.contains(Status::THRUST_HIGH) {
        g.x = math::min(g.x, 0.0);
    }
    if met.contains(Status::THRUST_LOW) {
        g.x = -math::min(-g.x, 0.0);
    }
    if met.contains(Status::RATE) {
        g.y = 0.0;
    }
    attitude.to_inertial(Body(g))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::reference_limit::ReferenceLimitParameters;

    const DT: f32 = 0.01;
    const P: OuterLoopParameters = OuterLoopParameters {
        position_gain: Inertial::new(0.8, 0.6),
        pull: Inertial::new(3.0, 6.0),
        integral_gain: Inertial::new(0.3, 0.1),
        integral: Inertial::new(2.0, 1.0),
        forward_error: 14.0,
    };
    const STAY: Reference = Reference {
        velocity: Inertial::ZERO,
        acceleration: Inertial::ZERO,
    };

    fn update(
        state: &mut OuterState,
        velocity: Inertial,
        position_error: Option<Inertial>,
        met: Status,
    ) -> (Reference, Status) {
        let limit = ReferenceLimit::new(ReferenceLimitParameters {
            acceleration: 3.0,
            rate: 1.0,
        })
        .unwrap();
        let input = OuterInput {
            velocity,
            attitude: Attitude::NOSE_UP,
            asked: &STAY,
            followed: &STAY,
            position_error,
            met,
        };
        OuterLoop::new(P).unwrap().update(state, &limit, &input, DT)
    }

    #[test]
    fn at_rest_in_place_the_reference_passes() {
        let mut state = OuterState::default();
        let out = update(
            &mut state,
            Inertial::ZERO,
            Some(Inertial::ZERO),
            Status::NONE,
        );
        assert_eq!(out, (STAY, Status::NONE));
        assert_eq!(state, OuterState::default());
    }

    /// a_cmd is the derivative of v_cmd, by differences along a motion with ẋ̃ = v − v_r.
    #[test]
    fn the_acceleration_is_the_derivative_of_the_velocity() {
        let (mut state, v) = (OuterState::default(), Inertial::new(0.7, -0.4));
        let x = |n: u8| {
            Some(Inertial(
                Inertial::new(0.5, 1.0).0 + v.0 * (f32::from(n) * DT),
            ))
        };
        let (first, _) = update(&mut state, v, x(0), Status::NONE);
        let (second, _) = update(&mut state, v, x(1), Status::NONE);
        let by_difference = (second.velocity.0 - first.velocity.0) / DT;
        // 2e-3: one step of 10 ms of an integral that grows with the pull, and roundings over DT.
        assert!((by_difference - second.acceleration.0).amax() < 2e-3);
    }

    #[test]
    fn the_pull_is_bounded_and_then_neither_feeds_nor_winds_up() {
        let mut state = OuterState::default();
        let (reference, status) = update(
            &mut state,
            Inertial::new(0.0, 2.0),
            Some(Inertial::new(0.0, 50.0)),
            Status::NONE,
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
            let (reference, status) = update(state, velocity, error, Status::NONE);
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
        let mut last = Status::NONE;
        for _ in 0..2000 {
            last = update(
                &mut state,
                Inertial::ZERO,
                Some(Inertial::new(2.0, -9.0)),
                Status::NONE,
            )
            .1;
        }
        assert_eq!(state.integral, Inertial::new(2.0, -1.0));
        assert_eq!(last, Status::INTEGRAL);
    }

    #[test]
    fn the_integral_obeys_the_limits() {
        let grown = |x, met| {
            let mut state = OuterState::default();
            update(&mut state, Inertial::ZERO, Some(x), met);
            state.integral
        };
        // Below the reference position: more thrust is asked for.
        let low = Inertial::new(1.0, 1.0);
        let free = grown(low, Status::NONE);
        assert!(free.down() > 0.0 && free.forward() > 0.0);
        assert_eq!(grown(low, Status::THRUST_LOW), free);
        assert_eq!(grown(low, Status::THRUST_HIGH).down(), 0.0);
        assert_eq!(grown(low, Status::THRUST_HIGH).forward(), free.forward());
        assert_eq!(grown(low, Status::RATE).forward(), 0.0);
        assert_eq!(grown(low, Status::RATE).down(), free.down());
        // Above it: less.
        let high = Inertial::new(-1.0, 0.0);
        assert!(grown(high, Status::THRUST_HIGH).down() < 0.0);
        assert_eq!(grown(high, Status::THRUST_LOW).down(), 0.0);
    }

    #[test]
    fn without_a_position_the_integral_holds_the_one_there_was() {
        let (mut state, mut fallen) = (OuterState::default(), 0.0);
        let v = Inertial::new(0.5, 0.0);
        for _ in 0..100 {
            update(&mut state, v, None, Status::NONE);
            fallen += 0.5 * DT;
        }
        // 1e-5: roundings of a hundred additions.
        assert!((state.integral.down() - 0.8 * fallen).abs() < 1e-5);
    }

    #[test]
    fn bad_parameters_are_named() {
        let name = |p| OuterLoop::new(p).unwrap_err().parameter;
        let bad = Inertial::new(0.0, -1.0);
        assert_eq!(
            name(OuterLoopParameters {
                position_gain: bad,
                ..P
            }),
            "position_gain"
        );
        assert_eq!(name(OuterLoopParameters { pull: bad, ..P }), "pull");
        assert_eq!(
            name(OuterLoopParameters {
                integral_gain: Inertial::new(f32::NAN, 0.0),
                ..P
            }),
            "integral_gain"
        );
        assert_eq!(name(OuterLoopParameters { integral: bad, ..P }), "integral");
    }
}
