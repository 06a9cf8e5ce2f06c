//! Guidance: the velocity law with everything around it that a real vehicle asks for.
//!
//! supervision → reference limit → outer loop → robust law on its branch → actuator limits. The law is pure; what
//! the rest remembers is in [`GuidanceState`], and nothing else is.

use super::branch_switch::{BranchState, BranchSwitch, Verdict};
use super::command::{Command, Diagnostics, State, check_input};
use super::gains::{GainLaw, Gains};
use super::limits::{LimitState, Limits};
use super::margin::Margin;
use super::outer_loop::{OuterInput, OuterLoop, OuterState};
use super::reference_limit::{ReferenceLimit, ReferenceState};
use super::status::Status;
use super::supervision::{Air, AirUse, MAX_STEP, Mode, Refusal, SupervisionState, Supervisor};
use super::velocity::VelocityControl;
use crate::aero::Aerodynamics;
use crate::branch::Branch;
use crate::frame::{Attitude, Inertial};
use crate::reference::{MAX_SPEED, Reference};

/// The parts of the guidance, each validated by its own constructor.
///
/// ```
/// use alula::control::*;
/// use alula::*;
///
/// let model = Combined::new(CombinedParameters::PAPER_BELIEF)?;
/// let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
/// let gains = BandwidthGains::new(BandwidthParameters::PAPER_VEHICLE, &vehicle)?;
/// let guidance = Guidance {
///     control: VelocityControl::new(vehicle, gains),
///     reference_limit: ReferenceLimit::new(ReferenceLimitParameters { acceleration: 3.0, rate: 0.8 })?,
///     outer_loop: OuterLoop::new(OuterLoopParameters {
///         position_gain: Inertial::new(0.8, 0.6),
///         pull: Inertial::new(3.0, 6.0),
///         integral_gain: Inertial::new(0.3, 0.1),
///         integral: Inertial::new(2.0, 1.0),
///         forward_error: 14.0,
///     })?,
///     branch: BranchSwitch::new(BranchParameters { switch: true, hysteresis: 10.0, fade: 0.3 })?,
///     limits: Limits::new(LimitParameters { thrust_min: 0.0, thrust_max: 196.0, rate: 2.8, slew: 30.0 })?,
///     supervisor: Supervisor::new(SupervisionParameters {
///         hold: 0.1,
///         recovery: 0.05,
///         state_age: 0.05,
///         reference_age: 0.5,
///         air_hold: 2.0,
///         safe_thrust: 0.0,
///     })?,
/// };
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
pub struct Guidance<A, G = Gains> {
    /// The velocity law.
    pub control: VelocityControl<A, G>,
    /// Acceleration limit on the reference.
    pub reference_limit: ReferenceLimit,
    /// Position hold and integral action.
    pub outer_loop: OuterLoop,
    /// Choice between θ̃ = 0 and θ̃ = π.
    pub branch: BranchSwitch,
    /// Limits of the actuators.
    pub limits: Limits,
    /// What to do when inputs fail.
    pub supervisor: Supervisor,
}

/// What a guidance step is told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GuidanceInput {
    /// Velocity v over ground [m/s].
    pub velocity: Inertial,
    /// Attitude θ.
    pub attitude: Attitude,
    /// Age \[s\] of velocity and attitude.
    pub state_age: f32,
    /// What is known of the air.
    pub air: Air,
    /// Position less reference position, x̃ \[m\], if position is to be held.
    pub position_error: Option<Inertial>,
    /// Reference.
    pub reference: Reference,
    /// Age \[s\] of the reference.
    pub reference_age: f32,
}

/// What the guidance remembers between steps. The default is power-on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GuidanceState {
    /// Mode, and the air last known.
    pub supervision: SupervisionState,
    /// Velocity followed.
    pub reference: ReferenceState,
    /// Integral.
    pub outer_loop: OuterState,
    /// Branch flown.
    pub branch: BranchState,
    /// Last angular rate.
    pub limits: LimitState,
    /// Last good reference velocity [m/s].
    held: Option<Inertial>,
    /// Limits that the last command met.
    met: Status,
    /// Last thrust flown \[N\].
    thrust: f32,
}

/// What a guidance step gives: always a command.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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
    /// Back to power-on, but for supervision.
    fn restart(&mut self) {
        *self = Self {
            supervision: self.supervision,
            ..Self::default()
        };
    }

    /// Back to power-on, but for the mode.
    #[cold]
    fn reset(&mut self) {
        let mode = self.supervision.mode;
        *self = Self::default();
        self.supervision.mode = mode;
    }

    /// Whether every number is finite and not absurd.
    #[inline(always)]
    fn is_sound(&self) -> bool {
        let or_zero = |v: Option<Inertial>| v.unwrap_or(Inertial::ZERO).norm_squared();
        let square = |x: f32| x * x;
        let sum = self.reference.velocity.norm_squared()
            + self.outer_loop.integral.norm_squared()
            + or_zero(self.held)
            + or_zero(self.supervision.wind)
            + square(self.supervision.wind_age)
            + square(self.supervision.elapsed)
            + square(self.branch.offset)
            + square(self.limits.rate)
            + square(self.thrust);
        // 1e7 of anything is beyond what the parts let grow.
        sum < 1e14
    }
}

/// Whether a reference is finite and not absurd. One sum decides: NaN fails its comparison too.
#[inline(always)]
fn is_sane(reference: &Reference) -> bool {
    reference.velocity.norm_squared() + reference.acceleration.norm_squared()
        < MAX_SPEED * MAX_SPEED
}

impl<A: Aerodynamics, G: GainLaw> Guidance<A, G> {
    /// One step, `dt` \[s\] after the last. Total: whatever comes in, a finite command within the limits, or the
    /// safe command, comes out.
    #[inline]
    pub fn update(&self, state: &mut GuidanceState, input: &GuidanceInput, dt: f32) -> Guided {
        let timed = dt > 0.0 && dt <= MAX_STEP;
        let dt = if timed { dt } else { MAX_STEP };
        let mut guided = Guided::default();
        let flown = if timed {
            self.fly(state, input, dt, &mut guided)
        } else {
            Err(Refusal::TimeStep)
        };
        let mode = self
            .supervisor
            .advance(&mut state.supervision, flown.is_ok(), dt);
        if mode == Mode::Flying {
            state.thrust = guided.command.thrust;
        } else {
            guided = self.substitute(state, mode);
        }
        guided.mode = mode;
        guided.refusal = flown.err();
        guided
    }

    /// What stands in for the law in any other mode.
    #[cold]
    fn substitute(&self, state: &mut GuidanceState, mode: Mode) -> Guided {
        let (thrust, rate) = if mode == Mode::Holding {
            (state.thrust, state.limits.rate)
        } else {
            state.restart();
            (self.supervisor.parameters().safe_thrust, 0.0)
        };
        Guided {
            command: Command {
                thrust,
                rate,
                diagnostics: Diagnostics::default(),
            },
            ..Guided::default()
        }
    }

    #[inline(always)]
    fn fly(
        &self,
        state: &mut GuidanceState,
        input: &GuidanceInput,
        dt: f32,
        guided: &mut Guided,
    ) -> Result<(), Refusal> {
        let supervision = self.supervisor.parameters();
        let bare = State {
            velocity: input.velocity,
            attitude: input.attitude,
            wind: Inertial::ZERO,
        };
        check_input(&bare, &Reference::default()).map_err(Refusal::Law)?;
        if !matches!(input.state_age, age if age <= supervision.state_age) {
            return Err(Refusal::StateAge);
        }
        let sound = state.is_sound();
        if !sound {
            state.reset();
        }

        // What to fly to.
        let fresh = input.reference_age <= supervision.reference_age && is_sane(&input.reference);
        let asked = if fresh {
            if state.held.is_none() {
                state.reference.velocity = input.velocity;
            }
            state.held = Some(input.reference.velocity);
            input.reference
        } else {
            Reference {
                velocity: state.held.ok_or(Refusal::NoReference)?,
                acceleration: Inertial::ZERO,
            }
        };
        let position_error = input
            .position_error
            .filter(|x| fresh && x.norm_squared().is_finite());
        let (followed, cut) = self
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
                met: state.met,
            },
            dt,
        );

        // The law. What reaches it has been checked above, or is bounded.
        let (wind, air, air_invalid) =
            self.supervisor
                .wind(&mut state.supervision, input.velocity, &input.air, dt);
        let branch = state.branch.branch;
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

        // What the actuators make of it.
        let rate = self
            .branch
            .smooth(&mut state.branch, command.rate, state.limits.rate, dt);
        let (thrust, rate, met) = self
            .limits
            .apply(&mut state.limits, command.thrust, rate, dt);
        state.met = met;

        guided.command = Command {
            thrust,
            rate,
            ..command
        };
        guided.air = air;
        guided.reference = reference;
        guided.margin = Margin::new(
            &step.forces,
            step.norm,
            self.control.gains().guard().tau(),
            branch.sign(),
        );
        guided.status = cut
            | outer
            | met
            | Status::NEGATIVE_THRUST.when(verdict != Verdict::Positive)
            | Status::OPPOSED.when(branch == Branch::Opposed)
            | Status::REFERENCE_HELD.when(!fresh)
            | Status::POSITION_INVALID
                .when(fresh && position_error.is_none() && input.position_error.is_some())
            | Status::AIR_INVALID.when(air_invalid)
            | Status::STATE_RESET.when(!sound);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::control::{
        BandwidthGains, BandwidthParameters, BranchParameters, Fault, LimitParameters,
        OuterLoopParameters, ReferenceLimitParameters, SupervisionParameters,
    };
    use crate::vehicle::{Vehicle, VehicleParameters};
    use rand::{RngExt, SeedableRng};

    const DT: f32 = 0.01;
    const THRUST_MAX: f32 = 1.3 * 98.1;
    const SAFE_THRUST: f32 = 12.5;

    fn guidance() -> Guidance<Combined, BandwidthGains> {
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model).unwrap();
        let gains = BandwidthGains::new(BandwidthParameters::PAPER_VEHICLE, &vehicle).unwrap();
        Guidance {
            control: VelocityControl::new(vehicle, gains),
            reference_limit: ReferenceLimit::new(ReferenceLimitParameters {
                acceleration: 3.0,
                rate: 0.8,
            })
            .unwrap(),
            outer_loop: OuterLoop::new(OuterLoopParameters {
                position_gain: Inertial::new(0.8, 0.6),
                pull: Inertial::new(3.0, 6.0),
                integral_gain: Inertial::new(0.3, 0.1),
                integral: Inertial::new(2.0, 1.0),
                forward_error: 14.0,
            })
            .unwrap(),
            branch: BranchSwitch::new(BranchParameters {
                switch: true,
                hysteresis: 10.0,
                fade: 0.3,
            })
            .unwrap(),
            limits: Limits::new(LimitParameters {
                thrust_min: 0.0,
                thrust_max: THRUST_MAX,
                rate: 2.8,
                slew: 30.0,
            })
            .unwrap(),
            supervisor: Supervisor::new(SupervisionParameters {
                hold: 0.1,
                recovery: 0.05,
                state_age: 0.05,
                reference_age: 0.5,
                air_hold: 1.0,
                safe_thrust: SAFE_THRUST,
            })
            .unwrap(),
        }
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
        assert_eq!(state.supervision.mode, Mode::Flying);
        state
    }

    /// Where no limit is met and there is nothing to pull or to integrate, the command is the pure law's.
    #[test]
    fn undisturbed_the_command_is_the_laws_to_the_bit() {
        let (guidance, mut state) = (guidance(), airborne());
        let input = GuidanceInput {
            velocity: Inertial::new(0.05, -0.1),
            attitude: Attitude::from_angle(0.02),
            ..HOVER
        };
        // Position hold off, and its stand-in with it.
        let guidance = Guidance {
            outer_loop: OuterLoop::new(OuterLoopParameters {
                position_gain: Inertial::ZERO,
                pull: Inertial::ZERO,
                integral_gain: Inertial::ZERO,
                integral: Inertial::ZERO,
                forward_error: 1e3,
            })
            .unwrap(),
            ..guidance
        };
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
        assert_eq!((guided.status, guided.refusal), (Status::NONE, None));
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
            (HOVER, 1.0, Refusal::TimeStep),
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
        let corrupt: [fn(&mut GuidanceState); 5] = [
            |s| s.outer_loop.integral = Inertial::new(f32::NAN, 0.0),
            |s| s.reference.velocity = Inertial::new(0.0, f32::INFINITY),
            |s| s.limits.rate = f32::NAN,
            |s| s.supervision.elapsed = f32::NAN,
            |s| s.supervision.wind = Some(Inertial::new(1e30, 0.0)),
        ];
        for corrupt in corrupt {
            let mut state = airborne();
            corrupt(&mut state);
            let guided = guidance.update(&mut state, &HOVER, DT);
            assert_eq!(guided.mode, Mode::Flying);
            assert!(guided.status.contains(Status::STATE_RESET));
            let next = guidance.update(&mut state, &HOVER, DT);
            assert_eq!(next.status, Status::NONE);
        }
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
                    0 => input.velocity.0.x = poison,
                    1 => input.reference.velocity.0.y = poison,
                    2 => input.reference.acceleration.0.x = poison,
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
