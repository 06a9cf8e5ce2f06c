//! One step of the guidance.
//!
//! supervision → reference limit → outer loop → robust law on its branch → actuator limits. The law is pure; what
//! the rest remembers is in [`GuidanceState`], and nothing else is.

use super::bandwidth::BandwidthGains;
use super::branch_switch::{BranchState, BranchSwitch, Verdict};
use super::limits::{LimitState, Limits};
use super::outer_loop::{OuterInput, OuterLoop, OuterState};
use super::parameters::GuidanceParameters;
use super::reference_limit::{ReferenceLimit, ReferenceState};
use super::status::Status;
use super::supervision::{Air, AirUse, Mode, Refusal, SupervisionState, Supervisor, time_passed};
use crate::aero::Aerodynamics;
use crate::branch::Branch;
use crate::control::{Command, Diagnostics, GainLaw, Margin, State, VelocityControl, check_input};
use crate::error::{ParameterError, Problem};
use crate::frame::{Attitude, Inertial};
use crate::parameters::Parameters;
use crate::reference::{MAX_SPEED, Reference};
use crate::vehicle::Vehicle;

/// The velocity law with everything around it that a real vehicle asks for. Immutable and validated.
///
/// ```
/// use alula::guidance::*;
/// use alula::*;
///
/// let model = Combined::new(CombinedParameters::PAPER_BELIEF)?;
/// let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
/// let guidance = Guidance::new(vehicle, &GuidanceParameters::default())?;
///
/// // At 100 Hz. The safe command is left once the inputs have been good for 50 ms.
/// let mut state = GuidanceState::default();
/// let input = GuidanceInput { air: Air::Wind(Inertial::ZERO), ..GuidanceInput::default() };
/// let mut guided = Guided::default();
/// for _ in 0..10 {
///     guided = guidance.update(&mut state, &input, 0.01);
/// }
/// assert_eq!(guided.mode, Mode::Flying);
/// assert!((guided.command.thrust - 9.0 * 9.81).abs() < 1e-3);
/// # Ok::<(), ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Guidance<A, G = BandwidthGains> {
    /// The velocity law.
    control: VelocityControl<A, G>,
    /// Acceleration limit on the reference.
    reference_limit: ReferenceLimit,
    /// Position hold and integral action.
    pub(super) outer_loop: OuterLoop,
    /// Choice between θ̃ = 0 and θ̃ = π.
    branch: BranchSwitch,
    /// Limits of the actuators.
    limits: Limits,
    /// What to do when inputs fail.
    pub(super) supervisor: Supervisor,
}

/// What a guidance step is told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GuidanceInput {
    /// Velocity v over ground [m/s].
    pub velocity: Inertial,
    /// Attitude θ.
    pub attitude: Attitude,
    /// Age \[s\] of velocity and attitude, not negative.
    pub state_age: f32,
    /// What is known of the air.
    pub air: Air,
    /// Position less reference position, x̃ \[m\], if position is to be held.
    pub position_error: Option<Inertial>,
    /// Reference.
    pub reference: Reference,
    /// Age \[s\] of the reference, not negative.
    pub reference_age: f32,
}

/// What the guidance remembers between steps. The default is power-on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GuidanceState {
    pub(super) supervision: SupervisionState,
    pub(super) reference: ReferenceState,
    pub(super) outer_loop: OuterState,
    pub(super) branch: BranchState,
    pub(super) limits: LimitState,
    /// Last good reference velocity [m/s].
    pub(super) held: Inertial,
    /// 1 if there has been a good reference. A number, not `Option`: every bit pattern has a meaning.
    held_known: u8,
    /// What of the last command saturated.
    saturated: Status,
}

/// What a guidance step gives: always a command.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Guided {
    /// The command, inside its limits. Its diagnostics are those of the law, before the limits; in
    /// [`Mode::Holding`] and [`Mode::Safe`] they are zero.
    pub command: Command,
    /// Mode.
    pub mode: Mode,
    /// What of the air was used.
    pub air: AirUse,
    /// What limited the step.
    pub status: Status,
    /// Margins of well-posedness; zero unless the law was flown.
    pub margin: Margin,
    /// The reference that the law was given, v_cmd and a_cmd.
    pub reference: Reference,
    /// Why the frame was refused, if it was.
    pub refusal: Option<Refusal>,
}

impl GuidanceState {
    /// Mode of the last step.
    pub fn mode(&self) -> Mode {
        self.supervision.mode()
    }

    /// The integral I of the outer loop [m/s].
    pub fn integral(&self) -> Inertial {
        self.outer_loop.integral
    }
}

/// Whether a reference is finite and not absurd. One sum decides: NaN fails its comparison too.
#[inline(always)]
fn is_sane(reference: &Reference) -> bool {
    reference.velocity.norm_squared() + reference.acceleration.norm_squared()
        < MAX_SPEED * MAX_SPEED
}

impl<A: Aerodynamics> Guidance<A> {
    /// The guidance of `vehicle` with gains by bandwidth.
    ///
    /// # Errors
    /// A parameter outside its range, or one that contradicts another: `thrust_max` not above the weight or `thrust_min`
    /// not below it, `safe_thrust` outside the vehicle's limits, `max_integral_…` above `max_velocity_…`.
    pub fn new(vehicle: Vehicle<A>, p: &GuidanceParameters) -> Result<Self, ParameterError> {
        let gains = BandwidthGains::new(p, &vehicle)?;
        Self::with_gains(vehicle, gains, p)
    }
}

impl<A: Aerodynamics, G: GainLaw> Guidance<A, G> {
    /// The guidance of `vehicle` with gains of one's own, such as the paper's. The parameters of the gains by bandwidth
    /// are checked, and not used.
    ///
    /// # Errors
    /// As [`Guidance::new`].
    pub fn with_gains(
        vehicle: Vehicle<A>,
        gains: G,
        p: &GuidanceParameters,
    ) -> Result<Self, ParameterError> {
        p.check()?;
        check_relations(&vehicle, p)?;
        Ok(Self {
            reference_limit: ReferenceLimit::new(p),
            outer_loop: OuterLoop::new(p),
            branch: BranchSwitch::new(p, vehicle.weight()),
            limits: Limits::new(p, &vehicle),
            supervisor: Supervisor::new(p, &vehicle),
            control: VelocityControl::new(vehicle, gains),
        })
    }

    /// The vehicle as the guidance believes it to be.
    pub fn vehicle(&self) -> &Vehicle<A> {
        self.control.vehicle()
    }

    /// The velocity law that is flown.
    pub fn control(&self) -> &VelocityControl<A, G> {
        &self.control
    }

    /// One step, `dt` \[s\] after the last. Total: whatever comes in and whatever the memory holds, a finite command
    /// within the limits comes out. It is the safe command, or the last one, where there is nothing better.
    #[inline]
    pub fn update(&self, state: &mut GuidanceState, input: &GuidanceInput, dt: f32) -> Guided {
        self.advance::<true>(state, input, dt)
    }

    /// [`update`](Self::update) without the margins, which stay zero: they take the second derivatives of the
    /// coefficients, a sixth of the step.
    #[inline]
    pub fn update_without_margin(
        &self,
        state: &mut GuidanceState,
        input: &GuidanceInput,
        dt: f32,
    ) -> Guided {
        self.advance::<false>(state, input, dt)
    }

    #[inline(always)]
    fn advance<const MARGIN: bool>(
        &self,
        state: &mut GuidanceState,
        input: &GuidanceInput,
        dt: f32,
    ) -> Guided {
        // Before anything else reads the memory.
        let sound = self.is_sound(state);
        if !sound {
            self.reset(state);
        }
        let (dt, timed) = time_passed(dt);
        let mut guided = Guided::default();
        let flown = if timed {
            self.fly::<MARGIN>(state, input, dt, &mut guided)
        } else {
            Err(Refusal::TimeStep)
        };
        let mode = self
            .supervisor
            .advance(&mut state.supervision, flown.is_ok(), dt);
        if mode != Mode::Flying {
            guided = self.substitute(state, mode);
        }
        guided.mode = mode;
        guided.refusal = flown.err();
        guided.status |= Status::STATE_RESET.when(!sound);
        guided
    }

    /// Whether every part's memory is inside that part's own bounds.
    #[inline(always)]
    fn is_sound(&self, state: &GuidanceState) -> bool {
        self.supervisor.is_sound(&state.supervision)
            && state.reference.is_sound()
            && self.outer_loop.is_sound(&state.outer_loop)
            && self.branch.is_sound(&state.branch)
            && (self.limits.is_sound(&state.limits) || (state.limits == LimitState::default()))
            && (state.held.norm_squared() <= MAX_SPEED * MAX_SPEED)
    }

    /// Back to power-on, but for the mode, and for the last command if that is sound: it is what a bad frame is bridged
    /// with.
    #[cold]
    fn reset(&self, state: &mut GuidanceState) {
        let limits = if self.limits.is_sound(&state.limits) {
            state.limits
        } else {
            self.limits.at_rest()
        };
        *state = GuidanceState {
            supervision: SupervisionState::in_mode(state.supervision.mode()),
            limits,
            ..GuidanceState::default()
        };
    }

    /// The command in any mode but flying.
    #[cold]
    fn substitute(&self, state: &mut GuidanceState, mode: Mode) -> Guided {
        if mode == Mode::Safe {
            *state = GuidanceState {
                supervision: state.supervision,
                limits: LimitState {
                    rate: 0.0,
                    thrust: self.supervisor.safe_thrust(),
                },
                ..GuidanceState::default()
            };
        }
        Guided {
            command: Command {
                thrust: state.limits.thrust,
                rate: state.limits.rate,
                diagnostics: Diagnostics::default(),
            },
            ..Guided::default()
        }
    }

    #[inline(always)]
    fn fly<const MARGIN: bool>(
        &self,
        state: &mut GuidanceState,
        input: &GuidanceInput,
        dt: f32,
        guided: &mut Guided,
    ) -> Result<(), Refusal> {
        let bare = State {
            velocity: input.velocity,
            attitude: input.attitude,
            wind: Inertial::ZERO,
        };
        check_input(&bare, &Reference::default()).map_err(Refusal::Law)?;
        if !self.supervisor.accepts_state(input.state_age) {
            return Err(Refusal::StateAge);
        }

        // What to fly to.
        let fresh =
            self.supervisor.accepts_reference(input.reference_age) && is_sane(&input.reference);
        let asked = if fresh {
            if state.held_known != 1 {
                state.reference.velocity = input.velocity;
            }
            state.held = input.reference.velocity;
            state.held_known = 1;
            input.reference
        } else if state.held_known == 1 {
            Reference {
                velocity: state.held,
                acceleration: Inertial::ZERO,
            }
        } else {
            return Err(Refusal::NoReference);
        };
        let position_error = input
            .position_error
            .filter(|x| fresh && x.norm_squared().is_finite());
        let branch = state.branch.branch();
        let (followed, limited) = self
            .reference_limit
            .update(&mut state.reference, &asked, dt);
        let (reference, outer) = self.outer_loop.update(
            &mut state.outer_loop,
            &self.reference_limit,
            &OuterInput {
                velocity: input.velocity,
                attitude: input.attitude,
                asked: &asked,
                followed: &followed,
                position_error,
                saturated: state.saturated,
                rate: state.limits.rate,
                branch: branch.sign(),
            },
            dt,
        );

        // The law. What reaches it has been checked above, or is bounded.
        let (wind, air, air_invalid) =
            self.supervisor
                .wind(&mut state.supervision, input.velocity, &input.air, dt);
        let at = State { wind, ..bare };
        let step = self.control.step(branch, &at, &reference);
        let command = self
            .control
            .robust_from(&step, branch, &at, None)
            .map_err(Refusal::Law)?;
        let verdict = self.branch.judge(branch, &step.forces);
        if verdict == Verdict::Other {
            self.branch.leave(&mut state.branch);
        }

        // The command inside the actuators' limits.
        let rate = self
            .branch
            .smooth(&mut state.branch, command.rate, state.limits.rate, dt);
        let (thrust, rate, saturated) =
            self.limits
                .apply(&mut state.limits, command.thrust, rate, dt);
        state.saturated = saturated;

        guided.command = Command {
            thrust,
            rate,
            ..command
        };
        guided.air = air;
        guided.reference = reference;
        if MARGIN {
            guided.margin = Margin::new(
                &step.forces,
                step.norm,
                self.control.gains().guard().tau(),
                branch.sign(),
            );
        }
        guided.status = limited
            | outer
            | saturated
            | Status::NEGATIVE_THRUST.when(verdict != Verdict::Positive)
            | Status::OPPOSED.when(branch == Branch::Opposed)
            | Status::REFERENCE_HELD.when(!fresh)
            | Status::POSITION_INVALID
                .when(fresh && position_error.is_none() && input.position_error.is_some())
            | Status::AIR_INVALID.when(air_invalid);
        Ok(())
    }
}

/// Refuses parameters that contradict each other or the vehicle.
fn check_relations<A: Aerodynamics>(
    vehicle: &Vehicle<A>,
    p: &GuidanceParameters,
) -> Result<(), ParameterError> {
    let weight = vehicle.weight();
    let safe = p.safe_thrust * weight;
    let relations = [
        ("thrust_max", vehicle.thrust_max() > weight),
        ("thrust_min", vehicle.thrust_min() < weight),
        (
            "safe_thrust",
            (vehicle.thrust_min()..=vehicle.thrust_max()).contains(&safe),
        ),
        (
            "max_integral_down",
            p.max_integral_down <= p.max_velocity_down,
        ),
        (
            "max_integral_forward",
            p.max_integral_forward <= p.max_velocity_forward,
        ),
    ];
    for (parameter, kept) in relations {
        if !kept {
            return Err(ParameterError {
                parameter,
                problem: Problem::Contradiction,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::control::Fault;
    use crate::vehicle::VehicleParameters;
    use rand::{RngExt, SeedableRng};

    const DT: f32 = 0.01;
    const THRUST_MAX: f32 = 1.3 * 98.1;
    /// A tenth of the weight \[N\].
    const SAFE_THRUST: f32 = 0.1 * (9.0 * 9.81);

    fn with(p: &GuidanceParameters) -> Guidance<Combined> {
        let vehicle = VehicleParameters {
            thrust_max: THRUST_MAX,
            ..VehicleParameters::PAPER_BELIEF
        };
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        Guidance::new(Vehicle::new(vehicle, model).unwrap(), p).unwrap()
    }

    fn parameters() -> GuidanceParameters {
        GuidanceParameters {
            air_hold: 1.0,
            safe_thrust: 0.1,
            ..GuidanceParameters::default()
        }
    }

    fn guidance() -> Guidance<Combined> {
        with(&parameters())
    }

    const HOVER: GuidanceInput = GuidanceInput {
        velocity: Inertial::ZERO,
        attitude: Attitude::NOSE_UP,
        state_age: 0.0,
        air: Air::Wind(Inertial::ZERO),
        position_error: Some(Inertial::ZERO),
        reference: Reference {
            velocity: Inertial::ZERO,
            acceleration: Inertial::ZERO,
        },
        reference_age: 0.0,
    };

    /// Flying in hover for a while.
    fn airborne() -> GuidanceState {
        let mut state = GuidanceState::default();
        for _ in 0..20 {
            guidance().update(&mut state, &HOVER, DT);
        }
        assert_eq!(state.mode(), Mode::Flying);
        state
    }

    /// Where no limit is met and there is nothing to pull or to integrate, the command is the pure law's.
    #[test]
    fn undisturbed_the_command_is_the_laws_to_the_bit() {
        let mut state = airborne();
        let input = GuidanceInput {
            velocity: Inertial::new(0.05, -0.1),
            attitude: Attitude::from_angle(0.02),
            ..HOVER
        };
        // Position hold off, and the integral that stands in for it.
        let guidance = with(&GuidanceParameters {
            position_gain_down: 0.0,
            position_gain_forward: 0.0,
            integral_gain_down: 0.0,
            integral_gain_forward: 0.0,
            max_velocity_error: 1e3,
            ..parameters()
        });
        // The rate's slew is met at first.
        let mut guided = Guided::default();
        for _ in 0..3 {
            guided = guidance.update(&mut state, &input, DT);
        }
        let law = guidance.control.robust(
            &State {
                velocity: input.velocity,
                attitude: input.attitude,
                wind: Inertial::ZERO,
            },
            &input.reference,
            None,
        );
        assert_eq!(Ok(guided.command), law);
        assert_eq!((guided.status, guided.refusal), (Status::empty(), None));
        assert!(guided.margin.force > 1.0 && guided.margin.fold > 1.0);
    }

    #[test]
    fn power_on_is_safe_until_frames_are_good_for_a_while() {
        let (guidance, mut state) = (guidance(), GuidanceState::default());
        for n in 0..8 {
            let guided = guidance.update(&mut state, &HOVER, DT);
            // 50 ms of good frames; five steps of 10 ms round to just below.
            let flying = n >= 6;
            assert_eq!(guided.mode == Mode::Flying, flying, "{n}");
            if !flying {
                assert_eq!(
                    (guided.command.thrust, guided.command.rate),
                    (SAFE_THRUST, 0.0)
                );
            }
        }
        // Without a reference there is nothing to fly to.
        let mut state = GuidanceState::default();
        let late = GuidanceInput {
            reference_age: 1.0,
            ..HOVER
        };
        for _ in 0..20 {
            let guided = guidance.update(&mut state, &late, DT);
            assert_eq!(guided.mode, Mode::Safe);
            assert_eq!(guided.refusal, Some(Refusal::NoReference));
        }
    }

    #[test]
    fn one_bad_frame_is_bridged_by_the_last_command_and_leaves_no_trace() {
        let guidance = guidance();
        let nan = Inertial::new(f32::NAN, 0.0);
        let bad = [
            (
                GuidanceInput {
                    velocity: nan,
                    ..HOVER
                },
                DT,
                Refusal::Law(Fault::Velocity),
            ),
            (
                GuidanceInput {
                    attitude: Attitude { cos: 0.5, sin: 0.5 },
                    ..HOVER
                },
                DT,
                Refusal::Law(Fault::Attitude),
            ),
            (
                GuidanceInput {
                    state_age: 0.06,
                    ..HOVER
                },
                DT,
                Refusal::StateAge,
            ),
            (
                GuidanceInput {
                    state_age: f32::NAN,
                    ..HOVER
                },
                DT,
                Refusal::StateAge,
            ),
            (HOVER, 0.0, Refusal::TimeStep),
            (HOVER, f32::NAN, Refusal::TimeStep),
            (HOVER, -DT, Refusal::TimeStep),
            (
                GuidanceInput {
                    state_age: -0.01,
                    ..HOVER
                },
                DT,
                Refusal::StateAge,
            ),
        ];
        for (input, dt, refusal) in bad {
            let mut state = airborne();
            let (before, integral) = (guidance.update(&mut state, &HOVER, DT), state.outer_loop);
            let held = guidance.update(&mut state, &input, dt);
            assert_eq!((held.mode, held.refusal), (Mode::Holding, Some(refusal)));
            assert_eq!(held.command.thrust, before.command.thrust);
            assert_eq!(held.command.rate, before.command.rate);
            assert_eq!(state.outer_loop, integral);
            assert_eq!(guidance.update(&mut state, &HOVER, DT), before);
        }
    }

    #[test]
    fn sustained_failure_ends_in_the_safe_command_and_recovers_from_where_the_vehicle_is() {
        let (guidance, mut state) = (guidance(), airborne());
        let bad = GuidanceInput {
            velocity: Inertial::new(f32::INFINITY, 0.0),
            ..HOVER
        };
        for n in 0..30 {
            let guided = guidance.update(&mut state, &bad, DT);
            // Ten frames of 10 ms; whether the eleventh is within 0.1 s is a rounding's matter.
            if n < 10 {
                assert_eq!(guided.mode, Mode::Holding);
            } else if n > 11 {
                assert_eq!(guided.mode, Mode::Safe);
                assert_eq!(
                    (guided.command.thrust, guided.command.rate),
                    (SAFE_THRUST, 0.0)
                );
            }
        }
        let moving = GuidanceInput {
            velocity: Inertial::new(3.0, 1.0),
            ..HOVER
        };
        let mut guided = Guided::default();
        while guided.mode != Mode::Flying {
            guided = guidance.update(&mut state, &moving, DT);
        }
        // It sets out from the velocity there is, less the position's integral of one step, towards the reference.
        assert!((guided.reference.velocity - moving.velocity).norm_squared() < 1e-3);
        assert!(guided.status.contains(Status::REFERENCE));
    }

    #[test]
    fn a_stale_reference_is_held_without_acceleration() {
        let (guidance, mut state) = (guidance(), airborne());
        let fresh = GuidanceInput {
            velocity: Inertial::new(0.0, 5.0),
            reference: Reference {
                velocity: Inertial::new(0.0, 5.0),
                acceleration: Inertial::new(0.0, 2.0),
            },
            ..HOVER
        };
        for _ in 0..500 {
            guidance.update(&mut state, &fresh, DT);
        }
        let nan = Inertial::new(0.0, f32::NAN);
        for stale in [
            GuidanceInput {
                reference_age: 0.6,
                ..fresh
            },
            GuidanceInput {
                reference_age: f32::NAN,
                ..fresh
            },
            GuidanceInput {
                reference: Reference {
                    acceleration: nan,
                    ..fresh.reference
                },
                ..fresh
            },
        ] {
            let mut state = state;
            let mut guided = Guided::default();
            for _ in 0..1000 {
                guided = guidance.update(&mut state, &stale, DT);
            }
            assert_eq!(guided.mode, Mode::Flying);
            assert!(guided.status.contains(Status::REFERENCE_HELD));
            // The velocity followed has settled on the last one; what the integral adds is bounded by 1 m/s.
            let off = guided.reference.velocity - fresh.reference.velocity;
            assert!(off.down().abs() < 1e-3 && off.forward().abs() <= 1.001);
            let back = guidance.update(&mut state, &fresh, DT);
            assert!(!back.status.contains(Status::REFERENCE_HELD));
        }
    }

    /// Without air data the law is that of k_a = 0: the plain thrust vector of a multicopter.
    #[test]
    fn without_air_data_thrust_is_vectored_plainly() {
        let (guidance, mut state) = (guidance(), GuidanceState::default());
        let input = GuidanceInput {
            velocity: Inertial::new(0.5, 9.0),
            attitude: Attitude::from_angle(-0.4),
            air: Air::Unknown,
            position_error: None,
            ..HOVER
        };
        let mut guided = Guided::default();
        while guided.mode != Mode::Flying {
            guided = guidance.update(&mut state, &input, DT);
        }
        assert_eq!(guided.air, AirUse::None);
        let p = VehicleParameters::PAPER_BELIEF;
        let a_r = guided.reference.acceleration;
        let apparent = Inertial::new(p.mass * (p.gravity - a_r.down()), -p.mass * a_r.forward());
        let got = input.attitude.to_inertial(guided.command.diagnostics.f_p);
        // 1e-4 N: two rotations of a force of 90 N.
        assert!((got - apparent).norm_squared().sqrt() < 1e-4);
    }

    #[test]
    fn a_corrupt_state_is_reset_in_flight() {
        let guidance = guidance();
        let corrupt: [fn(&mut GuidanceState); 7] = [
            |s| s.outer_loop.integral = Inertial::new(f32::NAN, 0.0),
            |s| s.reference.velocity = Inertial::new(0.0, f32::INFINITY),
            |s| s.reference.velocity = Inertial::new(0.0, 1e4),
            |s| s.limits.rate = f32::NAN,
            |s| s.limits.rate = 500.0,
            |s| s.held = Inertial::new(0.0, -1e9),
            |s| s.supervision.wind = Inertial::new(1e30, 0.0),
        ];
        for corrupt in corrupt {
            let mut state = airborne();
            corrupt(&mut state);
            let guided = guidance.update(&mut state, &HOVER, DT);
            assert_eq!(guided.mode, Mode::Flying);
            assert!(guided.status.contains(Status::STATE_RESET));
            let next = guidance.update(&mut state, &HOVER, DT);
            assert_eq!(next.status, Status::empty());
        }
    }

    /// A corrupt last command and a bad frame at once: what is held is inside the limits all the same.
    #[test]
    fn a_corrupt_last_command_is_not_held() {
        let guidance = guidance();
        let bad = GuidanceInput {
            velocity: Inertial::new(f32::NAN, 0.0),
            ..HOVER
        };
        for value in [f32::NAN, 1e30, 500.0, -1e6] {
            for thrust in [false, true] {
                let mut state = airborne();
                if thrust {
                    state.limits.thrust = value;
                } else {
                    state.limits.rate = value;
                }
                let guided = guidance.update(&mut state, &bad, DT);
                assert_eq!(guided.mode, Mode::Holding);
                assert!(guided.status.contains(Status::STATE_RESET));
                assert!((0.0..=THRUST_MAX).contains(&guided.command.thrust));
                assert!(guided.command.rate.abs() <= 2.8);
            }
        }
    }

    /// Timestamps that come twice, even several times in a row, are bridged; a clock that stands still is not.
    #[test]
    fn repeated_timestamps_do_not_end_the_flight() {
        let (guidance, mut state) = (guidance(), airborne());
        for _ in 0..100 {
            for _ in 0..3 {
                let held = guidance.update(&mut state, &HOVER, 0.0);
                assert_eq!(
                    (held.mode, held.refusal),
                    (Mode::Holding, Some(Refusal::TimeStep))
                );
            }
            assert_eq!(guidance.update(&mut state, &HOVER, DT).mode, Mode::Flying);
        }
        let stopped = (0..2000).map(|_| guidance.update(&mut state, &HOVER, 0.0).mode);
        assert_eq!(stopped.last(), Some(Mode::Safe));
    }

    #[test]
    fn contradictions_are_named() {
        let refused = |v: VehicleParameters, p: &GuidanceParameters| {
            let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
            let e = Guidance::new(Vehicle::new(v, model).unwrap(), p).unwrap_err();
            (e.parameter, e.problem)
        };
        let (v, p) = (VehicleParameters::PAPER, GuidanceParameters::default());
        let contradicts = |name| (name, Problem::Contradiction);
        let weak = VehicleParameters {
            thrust_max: 98.0,
            ..v
        };
        assert_eq!(refused(weak, &p), contradicts("thrust_max"));
        let strong = VehicleParameters {
            thrust_min: 98.2,
            ..v
        };
        assert_eq!(refused(strong, &p), contradicts("thrust_min"));
        let idle = VehicleParameters {
            thrust_min: 3.0,
            ..v
        };
        assert_eq!(refused(idle, &p), contradicts("safe_thrust"));
        let above = GuidanceParameters {
            safe_thrust: 2.1,
            ..p
        };
        assert_eq!(refused(v, &above), contradicts("safe_thrust"));
        let full = GuidanceParameters {
            max_integral_down: 3.1,
            ..p
        };
        assert_eq!(refused(v, &full), contradicts("max_integral_down"));
        let full = GuidanceParameters {
            max_integral_forward: 6.1,
            ..p
        };
        assert_eq!(refused(v, &full), contradicts("max_integral_forward"));
        let range = GuidanceParameters { hold: -1.0, ..p };
        assert_eq!(refused(v, &range), ("hold", Problem::OutOfRange));
    }

    /// Whatever comes in, what comes out is finite and inside the limits, or is the safe command.
    #[test]
    fn garbage_in_never_gives_garbage_out() {
        let (guidance, mut state) = (guidance(), GuidanceState::default());
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut modes = [0u32; 3];
        for _ in 0..200_000 {
            let mut input = HOVER;
            let speed = 10f32.powi(rng.random_range(-3..=2));
            let mut vector = || {
                Inertial::new(
                    rng.random_range(-speed..speed),
                    rng.random_range(-speed..speed),
                )
            };
            input.velocity = vector();
            input.reference.velocity = vector();
            input.reference.acceleration = vector();
            input.position_error = Some(vector());
            input.air = Air::Velocity(vector());
            input.attitude = Attitude::from_angle(rng.random_range(-3.2..3.2));
            let poison = [f32::NAN, f32::INFINITY, f32::MIN, f32::MIN_POSITIVE / 8.0]
                [rng.random_range(0..4)];
            let mut dt = rng.random_range(1e-4..0.05);
            if rng.random_range(0..3) == 0 {
                match rng.random_range(0..9) {
                    0 => input.velocity = Inertial::new(poison, 0.0),
                    1 => input.reference.velocity = Inertial::new(0.0, poison),
                    2 => input.reference.acceleration = Inertial::new(poison, 0.0),
                    3 => input.position_error = Some(Inertial::new(poison, 0.0)),
                    4 => input.air = Air::Wind(Inertial::new(0.0, poison)),
                    5 => input.attitude.cos = poison,
                    6 => input.state_age = poison,
                    7 => input.reference_age = poison,
                    _ => dt = poison,
                }
            }
            let guided = guidance.update(&mut state, &input, dt);
            let Command { thrust, rate, .. } = guided.command;
            assert!((0.0..=THRUST_MAX).contains(&thrust) && rate.abs() <= 2.8);
            let Margin { force, k, fold } = guided.margin;
            assert!(force.is_finite() && k.is_finite() && fold.abs() <= 3.15);
            modes[guided.mode as usize] += 1;
        }
        assert!(modes.iter().all(|&n| n > 1000), "{modes:?}");
    }
}
