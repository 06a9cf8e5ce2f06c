//! Where a flight begins, or begins anew: power-on, taking over, a state that is reset, and the commands in place of the law's.

use super::fall::{BEGUN, GATHERING};
use super::limits::LimitState;
use super::output::GuidanceOutput;
use super::state::GuidanceState;
use super::supervision::{Mode, RejectReason, SupervisionState};
use super::update::Guidance;
use crate::aero::Aerodynamics;
use crate::control::GainLaw;
use crate::math;
use crate::ned::BodyRates;
use crate::reference::MAX_SPEED;
use crate::spatial::{Body, Command, Diagnostics, Orientation};

impl<A: Aerodynamics, G: GainLaw> Guidance<A, G> {
    /// Thrust \[N\] of the safe command after the step that left `state`, for a program that has to fly on without inputs: with
    /// it go body rates of zero. `safe_thrust`, as far as the nose pointed up when the law flew last; before it has flown, the
    /// thrust nearest to none.
    pub fn safe_thrust(&self, state: &GuidanceState) -> f32 {
        let vehicle = self.control.plane().vehicle();
        math::clamp(
            self.supervisor.safe_thrust() * state.supervision.upright,
            vehicle.thrust_min(),
            vehicle.thrust_max(),
        )
    }

    /// The state with which to take over a vehicle that flies already: at this `orientation`, with this `thrust` \[N\] and these
    /// body `rates` [rad/s] commanded last. The first good frame is flown; until it comes this command is held, for `hold` at most.
    ///
    /// The command is brought inside the limits. For what is not finite stand the safe thrust and no rotation. A
    /// [`GuidanceState::default`] is for a vehicle on the ground: it commands least thrust until inputs have been good for `recovery`.
    ///
    /// ```
    /// use alula::prelude::*;
    ///
    /// let model = Combined::new(CombinedParameters::PAPER_BELIEF)?;
    /// let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
    /// let guidance = Guidance::new(vehicle, &GuidanceParameters::default())?;
    ///
    /// let input = GuidanceInput::default().air(Air::Wind(Ned::ZERO));
    /// let mut state = guidance.take_over(&input.orientation, 85.0, BodyRates::default());
    /// let output = guidance.update(&mut state, &input, 0.01);
    /// assert_eq!(output.mode, Mode::Flying);
    /// assert!((output.command.thrust - 9.0 * 9.81).abs() < 4.0);
    /// # Ok::<(), ParameterError>(())
    /// ```
    pub fn take_over(
        &self,
        orientation: &Orientation,
        thrust: f32,
        rates: BodyRates,
    ) -> GuidanceState {
        let mut state = GuidanceState {
            // The order of the two makes 0 of NaN.
            supervision: SupervisionState::holding(math::min(
                math::max(orientation.i().down, 0.0),
                1.0,
            )),
            ..GuidanceState::default()
        };
        let thrust = if thrust.is_finite() {
            thrust
        } else {
            self.safe_thrust(&state)
        };
        let rates = Body::from(rates);
        state.limits = self.limits.within(if rates.norm_squared().is_finite() {
            LimitState { rates, thrust }
        } else {
            LimitState {
                thrust,
                ..LimitState::default()
            }
        });
        state
    }

    /// Whether every part's memory is inside that part's own bounds.
    #[inline(always)]
    pub(super) fn is_sound(&self, state: &GuidanceState) -> bool {
        self.supervisor.is_sound(&state.supervision)
            && (!matches!(state.started, BEGUN..=GATHERING) || state.flight.is_sound())
            && state.planner.is_sound()
            && self.tracker.is_sound(state.integral, state.lean)
            && self.accelerometer.is_sound(&state.accelerometer)
            && state.air.is_sound()
            && self.fall.is_sound(state.flown_on)
            && state.wind.norm_squared() + state.reckoned.norm_squared() + state.held.norm_squared()
                <= 5.0 * MAX_SPEED * MAX_SPEED
            && (self.limits.is_sound(&state.limits)
                || state.limits == LimitState::default() && state.mode() == Mode::Safe)
    }

    /// Back to power-on, but for the mode, and for the last command if that is inside the limits: it is what a bad frame is
    /// bridged with.
    #[cold]
    pub(super) fn reset(&self, state: &mut GuidanceState) {
        let limits = if self.limits.is_sound(&state.limits) {
            state.limits
        } else {
            self.limits.at_rest()
        };
        *state = GuidanceState {
            supervision: state.supervision.restarted(),
            limits,
            ..GuidanceState::default()
        };
    }

    /// The command in any mode but flying.
    #[cold]
    #[inline(never)]
    pub(super) fn substitute(
        &self,
        state: &mut GuidanceState,
        reject_reason: Option<RejectReason>,
    ) -> GuidanceOutput {
        let mode = state.mode();
        if mode == Mode::Safe {
            // The attitude is kept blindly: of a nose that points forward all thrust would go into speed.
            let limits = LimitState {
                thrust: self.safe_thrust(state),
                ..self.limits.at_rest()
            };
            *state = GuidanceState {
                supervision: state.supervision,
                limits,
                ..GuidanceState::default()
            };
        }
        GuidanceOutput {
            command: Command {
                thrust: state.limits.thrust,
                rates: state.limits.rates.into(),
                diagnostics: Diagnostics::default(),
            },
            mode,
            reject_reason,
            ..GuidanceOutput::default()
        }
    }
}
