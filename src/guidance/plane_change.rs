//! What the guidance remembers, when the vertical plane in which it flies turns about the vertical.
//!
//! The guidance works in one vertical plane. A caller that projects a three-dimensional state on a plane of its choice may
//! turn that plane between two steps. Wind, velocities and the integral are vectors in the world, which does not turn:
//! they are expressed in the new plane. That takes their components across the plane too, which are kept here.
//!
//! Not in the paper.

use super::supervision::Air;
use super::update::{Guidance, GuidanceInput, GuidanceState};
use crate::frame::Inertial;
use crate::reference::MAX_SPEED;

/// Components across the vertical plane [m/s], positive to the right, of what a [`GuidanceState`] remembers in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Across {
    /// Of the velocity followed: across the plane, the vehicle's own velocity.
    followed: f32,
    /// Of the integral.
    integral: f32,
    /// Of the last good reference velocity.
    held: f32,
    /// Of the last known wind.
    wind: f32,
}

/// Components across the plane [m/s], positive to the right, of a [`GuidanceInput`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputAcross {
    /// Of the velocity.
    pub velocity: f32,
    /// Of the wind or of the air velocity, whichever the input has.
    pub air: f32,
    /// Of the reference velocity.
    pub reference: f32,
}

impl Across {
    /// Keeps the part across the plane of what `state` has just taken from `input`; call it after each
    /// [`Guidance::update`].
    #[inline(always)]
    pub fn remember(&mut self, state: &GuidanceState, input: &GuidanceInput, across: &InputAcross) {
        self.followed = across.velocity;
        if state.held == input.reference.velocity {
            self.held = across.reference;
        }
        // The age is zero only if this step has taken the wind from its input.
        if state.supervision.wind_age == 0.0 {
            self.wind = match input.air {
                Air::Velocity(_) => across.velocity - across.air,
                Air::Wind(_) => across.air,
                Air::Unknown => self.wind,
            };
        }
    }
}

/// `speed`, or 0 if it is not finite or absurd.
fn plausible(speed: f32) -> f32 {
    if speed.abs() <= MAX_SPEED { speed } else { 0.0 }
}

impl<A, G> Guidance<A, G> {
    /// Moves `state` and `across` into the vertical plane at the angle of this cosine and sine from the present one,
    /// positive to the right; call it before the first [`Guidance::update`] in that plane.
    ///
    /// The integral stays inside its limits, and a wind that is too strong in the new plane is forgotten.
    pub fn turn_plane(&self, state: &mut GuidanceState, across: &mut Across, cos: f32, sin: f32) {
        let turned = |v: Inertial, across: &mut f32| {
            let (forward, right) = (v.forward(), plausible(*across));
            *across = right * cos - forward * sin;
            Inertial::new(v.down(), forward * cos + right * sin)
        };
        state.reference.velocity = turned(state.reference.velocity, &mut across.followed);
        state.held = turned(state.held, &mut across.held);
        let integral = turned(state.outer_loop.integral, &mut across.integral);
        state.outer_loop.integral = self.outer_loop.limited(integral);
        let wind = turned(state.supervision.wind, &mut across.wind);
        self.supervisor.move_wind(&mut state.supervision, wind);
        // Angular rates are about the plane's normal.
        state.limits.rate *= cos;
        state.branch.offset *= cos;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::guidance::{AirUse, GuidanceParameters, Mode, Status};
    use crate::vehicle::{Vehicle, VehicleParameters};

    const DT: f32 = 0.01;

    fn guidance() -> Guidance<Combined> {
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model).unwrap();
        Guidance::new(vehicle, &GuidanceParameters::default()).unwrap()
    }

    /// The input in the plane of `heading` of a flight whose vectors are (north, east).
    fn input(heading: f32) -> (GuidanceInput, InputAcross) {
        let (velocity, wind, reference) = ((6.0, 2.0), (-3.0, 4.0), (5.0, 1.0));
        let project = |(north, east): (f32, f32)| {
            let (s, c) = (libm::sinf(heading), libm::cosf(heading));
            (
                Inertial::new(0.0, north * c + east * s),
                east * c - north * s,
            )
        };
        let ((v, v_across), (w, w_across), (r, r_across)) =
            (project(velocity), project(wind), project(reference));
        let mut input = GuidanceInput {
            velocity: v,
            air: Air::Wind(w),
            ..GuidanceInput::default()
        };
        input.reference.velocity = r;
        let across = InputAcross {
            velocity: v_across,
            air: w_across,
            reference: r_across,
        };
        (input, across)
    }

    /// A flight north, then a turn of the plane through a full turn in steps: at each heading wind and reference are the
    /// projections of what they were.
    #[test]
    fn wind_and_reference_stay_in_the_world() {
        let (guidance, mut state, mut across) =
            (guidance(), GuidanceState::default(), Across::default());
        for _ in 0..50 {
            let (input, beside) = input(0.0);
            guidance.update(&mut state, &input, DT);
            across.remember(&state, &input, &beside);
        }
        assert_eq!(state.mode(), Mode::Flying);
        let step = 0.01f32;
        for n in 1..629 {
            guidance.turn_plane(&mut state, &mut across, libm::cosf(step), libm::sinf(step));
            let (wanted, beside) = input(n as f32 * step);
            let Air::Wind(wind) = wanted.air else {
                unreachable!()
            };
            // 1e-5: hundreds of roundings of 5 m/s.
            assert!((state.supervision.wind - wind).norm() < 1e-5 * n as f32 + 1e-6);
            assert!((state.held - wanted.reference.velocity).norm() < 1e-5 * n as f32 + 1e-6);
            assert!((across.wind - beside.air).abs() < 1e-5 * n as f32 + 1e-6);
        }
    }

    /// Nothing that a turn leaves is taken for corrupt: the integral is limited, and a wind beyond `max_wind` is forgotten.
    #[test]
    fn a_turned_memory_is_sound() {
        let (guidance, mut state, mut across) =
            (guidance(), GuidanceState::default(), Across::default());
        let (flight, beside) = input(0.0);
        for _ in 0..50 {
            guidance.update(&mut state, &flight, DT);
            across.remember(&state, &flight, &beside);
        }
        // As a long flight in two planes leaves it.
        state.outer_loop.integral = Inertial::new(1.0, 1.0);
        across.integral = 1.0;
        across.wind = 60.0;
        let half = core::f32::consts::FRAC_1_SQRT_2;
        guidance.turn_plane(&mut state, &mut across, half, half);
        let unknown = GuidanceInput {
            air: Air::Unknown,
            ..input(core::f32::consts::FRAC_PI_4).0
        };
        let guided = guidance.update(&mut state, &unknown, DT);
        assert_eq!((guided.mode, guided.air), (Mode::Flying, AirUse::None));
        assert!(!guided.status.contains(Status::STATE_RESET));
        // An implausible component across the plane is not turned into it.
        for bad in [f32::NAN, f32::INFINITY, 1e30] {
            let beside = InputAcross {
                velocity: bad,
                air: bad,
                reference: bad,
            };
            across.remember(&state, &flight, &beside);
            guidance.turn_plane(&mut state, &mut across, half, half);
            let guided = guidance.update(&mut state, &flight, DT);
            assert!(!guided.status.contains(Status::STATE_RESET));
        }
    }
}
