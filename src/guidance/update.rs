//! One step of the guidance.
//!
//! supervision → planner → reference model → tracker (the robust law) → actuator limits. What is remembered is in
//! [`GuidanceState`], and nowhere else.

use super::accelerometer::Accelerometer;
use super::air_data_fallback::AirDataFallback;
use super::air_estimate::{AirEstimateState, AirSample};
use super::bandwidth::BandwidthGains;
use super::course::{Axes, Course};
use super::fall::{BEGUN, FALLING, Fall, FallSample, GATHERING};
use super::input::GuidanceInput;
use super::lateral_guidance::{LateralGuidance, LateralGuidanceInput, ReferenceModelState};
use super::limits::Limits;
use super::output::GuidanceOutput;
use super::planner::{Candidate, PlanSearch, Planner};
use super::reference_model::limited;
use super::state::GuidanceState;
use super::status::Status;
use super::supervision::{Air, AirUse, Mode, RejectReason, Supervisor, WindUse, time_passed};
use super::tracker::{Tracker, TrackerInput};
use super::wrap::wrap;
use crate::aero::Aerodynamics;
use crate::control::{Fault, GainLaw};
use crate::math;
use crate::ned::Ned;
use crate::reference::{MAX_ACCELERATION, MAX_SPEED};
use crate::spatial::{Body, Command, Reference, State, WingedControl, check_velocity};
use crate::vehicle::Vehicle;

/// The velocity law with everything around it that a real vehicle asks for. Immutable and validated.
///
/// Every step checks the bounds of its state, and resets a state outside them to power-on. A change of memory that stays
/// inside the bounds is not seen: [`Hardened`](super::Hardened) finds and undoes it.
///
/// ```
/// use alula::prelude::*;
///
/// let model = Combined::new(CombinedParameters::PAPER_BELIEF)?;
/// let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
/// let guidance = Guidance::new(vehicle, &GuidanceParameters::default())?;
///
/// // At 100 Hz. The safe command is left once the inputs have been good for 50 ms.
/// let mut state = GuidanceState::default();
/// let input = GuidanceInput::default().air(Air::Wind(Ned::ZERO));
/// let mut output = GuidanceOutput::default();
/// for _ in 0..10 {
///     output = guidance.update(&mut state, &input, 0.01);
/// }
/// assert_eq!(output.mode, Mode::Flying);
/// assert!((output.command.thrust - 9.0 * 9.81).abs() < 1e-3);
/// # Ok::<(), ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Guidance<A, G = BandwidthGains> {
    /// The velocity law.
    pub(super) control: WingedControl<A, G>,
    /// Which plan the reference model flies by.
    pub(super) planner: Planner,
    /// How the plane turns in which it does.
    pub(super) lateral_guidance: LateralGuidance,
    /// How the real vehicle follows.
    pub(super) tracker: Tracker,
    /// When it falls, and what it does then.
    pub(super) fall: Fall,
    /// What the accelerometer tells.
    pub(super) accelerometer: Accelerometer,
    /// Limits of the actuators.
    pub(super) limits: Limits,
    /// What to do when inputs fail.
    pub(super) supervisor: Supervisor,
}

/// Time constant \[s\] of the wind that is planned with.
const GUSTS: f32 = 0.3;
/// How fast the model's position is resynchronised to the real one where the law has no say, against its velocity.
const RESYNCHRONISATION_POSITION_SHARE: f32 = 0.6;
/// Distance of the model's attitude from the real one \[rad\] beyond which it is drawn to that, and how fast [1/s]. A rate loop of 100 ms stays
/// 0.3 rad behind at the greatest rate.
const ATTITUDE_APART: f32 = 0.45;
const ATTITUDE_RESYNCHRONISATION: f32 = 20.0;
/// Position errors beyond this \[m\] are taken as this.
const MAX_DISTANCE: f32 = 1e4;

/// Whether a reference is finite and not absurd. One sum decides: NaN fails its comparison too.
#[inline(always)]
fn is_sane(reference: &Reference) -> bool {
    reference.velocity.norm_squared() + reference.acceleration.norm_squared()
        < MAX_SPEED * MAX_SPEED
}

impl<A: Aerodynamics, G: GainLaw> Guidance<A, G> {
    /// The vehicle as the guidance believes it to be.
    pub fn vehicle(&self) -> &Vehicle<A> {
        self.control.plane().vehicle()
    }

    /// The velocity law that is flown.
    pub fn control(&self) -> &WingedControl<A, G> {
        &self.control
    }

    /// One step, `dt` \[s\] after the last. Total: whatever comes in and whatever the memory holds, a finite command
    /// within the limits comes out. It is the safe command, or the last one, where there is nothing better.
    #[inline]
    pub fn update(
        &self,
        state: &mut GuidanceState,
        input: &GuidanceInput,
        dt: f32,
    ) -> GuidanceOutput {
        // Before anything else reads the state.
        let sound = self.is_sound(state);
        if !sound {
            self.reset(state);
        }
        let (dt, timed) = time_passed(dt);
        let flown = if timed {
            self.fly(state, input, dt)
        } else {
            Err(RejectReason::TimeStep)
        };
        let mut output = match flown {
            Ok(flown) if self.settle(state, true, dt) == Mode::Flying => {
                state.supervision.upright = math::clamp(input.orientation.i().down, 0.0, 1.0);
                GuidanceOutput {
                    mode: Mode::Flying,
                    ..flown
                }
            }
            Ok(_) => self.substitute(state, None),
            Err(reason) => {
                self.settle(state, false, dt);
                self.substitute(state, Some(reason))
            }
        };
        output.status |= Status::STATE_RESET.when(!sound);
        output
    }

    /// The mode after a step of `dt` \[s\] with a frame that was `good` or not.
    #[inline(always)]
    fn settle(&self, state: &mut GuidanceState, good: bool, dt: f32) -> Mode {
        // An absurd vehicle or reference takes the reference model beyond all bounds: it begins anew from the real vehicle.
        if matches!(state.started, BEGUN..=GATHERING) && !state.flight.is_bounded() {
            self.reset(state);
        }
        self.supervisor.advance(&mut state.supervision, good, dt)
    }

    /// A plan, where [`GuidanceOutput::plan_due`] asks for one: the vehicle is flown ahead by the plan in force and by others, and from the
    /// next step on by the best of them. It takes some thirty times the instructions of a step.
    ///
    /// Without plans the vehicle flies on by the last one: it holds and follows what can be flown without crossing a stall.
    pub fn plan(&self, state: &mut GuidanceState) {
        let mut search = self.search(state);
        while self.look(&mut search).is_some() {}
        self.adopt(state, &search);
    }

    /// Begins a plan apart from the `state`: for a task of lower priority, or to look at one candidate a step. [`plan`](Self::plan) is
    /// this, [`look`](Self::look) until it gives `None`, and [`adopt`](Self::adopt).
    pub fn search(&self, state: &GuidanceState) -> PlanSearch {
        state.planner.search()
    }

    /// Looks at the plan in force, or at one candidate more: at most one rollout. `None` once the search is at its end.
    pub fn look(&self, search: &mut PlanSearch) -> Option<Candidate> {
        self.planner.look(self.control.plane().vehicle(), search)
    }

    /// Takes what `search` found so far. A search older than [`MAX_PLAN_AGE`](super::MAX_PLAN_AGE), or begun before the state was reset, is
    /// dropped: what it found begins where the vehicle no longer is.
    pub fn adopt(&self, state: &mut GuidanceState, search: &PlanSearch) {
        self.planner.adopt(
            self.vehicle(),
            &mut state.planner,
            search,
            state.flight.theta,
        );
    }

    #[inline(always)]
    fn fly(
        &self,
        state: &mut GuidanceState,
        input: &GuidanceInput,
        dt: f32,
    ) -> Result<GuidanceOutput, RejectReason> {
        check_velocity(input.velocity).map_err(RejectReason::Law)?;
        if !input.orientation.is_sound() {
            return Err(RejectReason::Law(Fault::Attitude));
        }
        if !self.supervisor.accepts_state(input.state_age) {
            return Err(RejectReason::StateAge);
        }

        // What to fly to.
        let fresh =
            self.supervisor.accepts_reference(input.reference_age) && is_sane(&input.reference);
        let mut asked = if fresh {
            state.held = input.reference.velocity;
            state.held_known = 1;
            input.reference
        } else if state.held_known == 1 {
            Reference {
                velocity: state.held,
                ..Reference::default()
            }
        } else {
            return Err(RejectReason::NoReference);
        };
        let mut position_error = input
            .position_error
            .filter(|x| fresh && x.norm_squared().is_finite());
        let WindUse {
            mut wind,
            air,
            air_invalid,
        } = self
            .supervisor
            .wind(&mut state.supervision, input.velocity, &input.air, dt);
        let specific_force = input
            .specific_force
            .map(Body::from)
            .filter(|f| f.norm_squared() < MAX_ACCELERATION * MAX_ACCELERATION);
        let share = self.accelerometer.share(input.velocity - wind);
        let correction = self.accelerometer.correction(&state.accelerometer, share);
        if air == AirUse::None && specific_force.is_none() {
            core::hint::cold_path();
            let (v, air) = (&mut asked.velocity, input.velocity - wind);
            let level = v.north * v.north + v.east * v.east;
            // Slow over ground or over the air believed in: the wind may have changed since, and the ground is known.
            let speed = math::min(input.velocity.norm_squared(), air.norm_squared());
            let fallback = AirDataFallback::new(level, speed, self.lateral_guidance.slow());
            (v.north, v.east) = (
                v.north * fallback.speed_scale,
                v.east * fallback.speed_scale,
            );
            if fallback.speed_scale < 1.0 {
                let a = &mut asked.acceleration;
                (a.north, a.east) = (0.0, 0.0);
            }
            wind += air * fallback.air_removed;
            if fallback.air_removed == 1.0 {
                self.supervisor.remember(&mut state.supervision, wind);
            }
            position_error = position_error.map(|x| Ned::new(0.0, 0.0, x.down));
        }
        // What the known wind leaves out, where the air's velocity itself is not known.
        let mut gust = 0.0;
        if air == AirUse::Pitot || (air != AirUse::Velocity && specific_force.is_some()) {
            gust = state.air.update(
                self.control.plane().vehicle(),
                &AirSample {
                    air: input.velocity - wind,
                    orientation: input.orientation,
                    airspeed: match input.air {
                        Air::Pitot { airspeed, .. } if air == AirUse::Pitot => airspeed,
                        _ => f32::NAN,
                    },
                    specific_force: specific_force.map(|felt| {
                        let commanded = state.limits.rates.w;
                        self.accelerometer.without_surfaces(
                            &state.accelerometer,
                            felt,
                            commanded,
                            dt,
                        )
                    }),
                    scale: correction.air(),
                    held: self.fall.is_held(state.started, state.flown_on),
                    wind_known: matches!(air, AirUse::Wind | AirUse::Pitot),
                },
                dt,
            );
            wind += state.air.gust;
        } else {
            state.air = AirEstimateState::default();
        }
        let at = State {
            velocity: input.velocity,
            orientation: input.orientation,
            wind,
            correction,
        };

        // Where the vehicle is, from the reference.
        let position = match position_error {
            Some(x) => {
                state.reckoned = Ned::ZERO;
                Ned::new(
                    limited(x.north, MAX_DISTANCE),
                    limited(x.east, MAX_DISTANCE),
                    limited(x.down, MAX_DISTANCE),
                )
            }
            None => {
                let reckoned = state.reckoned + (input.velocity - asked.velocity) * dt;
                state.reckoned = self.tracker.within_reach(reckoned);
                state.reckoned
            }
        };

        // The reference model begins with the vehicle, and begins anew where it has nothing to do with it: after a jump of position or reference,
        // in a fall, or if the memory holds another flight's. It is counted from the same turn as the real attitude.
        let vehicle = self.control.plane().vehicle();
        let air_velocity = input.velocity - wind;
        let falls = matches!(state.started, FALLING | GATHERING);
        let begun = state.started == BEGUN && state.flight.is_near(input.velocity, position);
        if !begun {
            state.flight.course = Course::of(&input.orientation);
            state.flight.lateral_acceleration = 0.0;
        }
        let axes = Axes::new(
            &state.flight.course,
            vehicle.gravity(),
            state.flight.lateral_acceleration,
        );
        let nose = axes.project(input.orientation.i());
        let theta = math::atan2(nose.forward(), nose.down());
        if !begun {
            if !falls {
                if state.started != BEGUN {
                    self.accelerometer
                        .begin(&mut state.accelerometer, specific_force, vehicle);
                }
                state.started = BEGUN;
            }
            state.planner.begin();
            state.flight = ReferenceModelState {
                velocity: input.velocity,
                position,
                theta,
                rate: state.limits.rates.w,
                thrust: state.limits.thrust,
                ..state.flight
            };
            state.wind = wind;
            state.lean = 0.0;
        }
        state.wind += (wind - state.wind) * math::min(dt / GUSTS, 1.0);
        if input.planner_options.hold_altitude_only {
            let model_place = &mut state.flight.position;
            (model_place.north, model_place.east) = (position.north, position.east);
        }
        let turns = theta + wrap(state.flight.theta - theta) - state.flight.theta;
        state.flight.theta += turns;
        state.planner.shift(turns);
        let model = self.lateral_guidance.advance(
            &self.planner,
            vehicle,
            &mut state.flight,
            &mut state.planner,
            &LateralGuidanceInput {
                reference: &asked,
                planner_options: &input.planner_options,
                wind: state.wind,
                air_force_scale: correction.air(),
                missing_thrust: self.accelerometer.missing(
                    &state.accelerometer,
                    axes.down,
                    vehicle,
                ),
                wing_alignment: axes.right.dot(input.orientation.w()),
            },
            dt,
        );

        // The real one after it.
        let mut tracked = self
            .tracker
            .track(
                &self.control,
                &mut state.integral,
                &mut state.lean,
                &TrackerInput {
                    state: &at,
                    position,
                    flight: &state.flight,
                    theta,
                    model: &model,
                    saturated: state.saturated,
                    rate: self.limits.pitch_at_limit(&state.limits),
                },
                dt,
            )
            .map_err(RejectReason::Law)?;
        if falls {
            core::hint::cold_path();
            tracked.command.thrust = model.thrust_max;
            let rates = self
                .fall
                .rates(state.started, &input.orientation, air_velocity);
            tracked.command.rates = rates.into();
        }
        let bounded = self.limits.apply(
            &mut state.limits,
            [tracked.thrust_min, tracked.command.thrust],
            -input.orientation.to_axes(air_velocity).i,
            tracked.command.rates.into(),
            dt,
        );
        state.saturated = bounded.saturated;
        // Where the law has no say the reference model is resynchronised to the vehicle: that is how it is planned anew.
        let flight = &mut state.flight;
        if tracked.law < 1.0 {
            let resynchronisation = self.planner.reference_model.tuning.resynchronisation;
            let resynchronised = math::min((1.0 - tracked.law) * resynchronisation * dt, 1.0);
            flight.velocity += (input.velocity - flight.velocity) * resynchronised;
            flight.position +=
                (position - flight.position) * (RESYNCHRONISATION_POSITION_SHARE * resynchronised);
        }

        // An attitude that does not follow is where plans begin: the air may hold it.
        let ahead = tracked.ahead;
        let sample = FallSample {
            sink: input.velocity.down - asked.velocity.down,
            ahead,
            held: self.limits.pitch_at_limit(&state.limits) != 0.0,
            air: air_velocity,
            asked: asked.velocity - wind,
            nose: -input.orientation.i(),
        };
        (state.started, state.flown_on) =
            self.fall.next((state.started, state.flown_on), &sample, dt);
        let apart = ahead - limited(ahead, ATTITUDE_APART);
        flight.theta -= apart * math::min(ATTITUDE_RESYNCHRONISATION * dt, 1.0);

        let mut command = Command {
            thrust: bounded.thrust,
            rates: bounded.rates.into(),
            ..tracked.command
        };
        self.accelerometer.update(
            &mut state.accelerometer,
            specific_force,
            input.orientation,
            &command,
            gust,
            share,
            dt,
        );
        command.thrust = state.limits.thrust;
        Ok(GuidanceOutput {
            command,
            air,
            status: tracked.status
                | bounded.saturated
                | Status::REFERENCE_HELD.when(!fresh)
                | Status::POSITION_INVALID
                    .when(fresh && position_error.is_none() && input.position_error.is_some())
                | Status::AIR_INVALID.when(air_invalid)
                | Status::FORCE_INVALID
                    .when(specific_force.is_none() && input.specific_force.is_some()),
            margin: tracked.margin,
            reference: tracked.reference,
            progress: model.progress,
            plan_due: model.plan_due && !falls,
            ..GuidanceOutput::default()
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::control::{Command, Margin};
    use crate::error::Problem;
    use crate::frame::{Attitude, Inertial};
    use crate::guidance::MIN_STEP;
    use crate::guidance::Phase;
    use crate::guidance::plane::{PlanarGuidanceInput, PlanarGuidanceOutput};
    use crate::guidance::supervision::SupervisionState;
    use crate::guidance::{GuidanceParameters, PlannerOptions};
    use crate::ned::{BodyRates, Frd};
    use crate::parameters::Parameters;
    use crate::reference::Reference;
    use crate::spatial::Orientation;
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

    const HOVER: PlanarGuidanceInput = PlanarGuidanceInput {
        velocity: Inertial::ZERO,
        attitude: Attitude::NOSE_UP,
        state_age: 0.0,
        air: Air::Wind(Inertial::ZERO),
        specific_force: None,
        position_error: Some(Inertial::ZERO),
        reference: Reference {
            velocity: Inertial::ZERO,
            acceleration: Inertial::ZERO,
        },
        reference_age: 0.0,
        planner_options: PlannerOptions {
            altitude_band: 0.0,
            nose_below_vertical: false,
            hold_altitude_only: false,
        },
    };

    /// Flying in hover for a while.
    fn airborne() -> GuidanceState {
        let mut state = GuidanceState::default();
        for _ in 0..20 {
            guidance().update_in_plane(&mut state, &HOVER, DT);
        }
        assert_eq!(state.mode(), Mode::Flying);
        state
    }

    /// On a sheet, with the reference model at rest, no limit met and nothing to pull or to integrate, the command is the
    /// paper's robust law's.
    #[test]
    fn on_a_sheet_the_command_is_the_laws_to_the_bit() {
        let mut state = airborne();
        let input = PlanarGuidanceInput {
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
            ..parameters()
        });
        // The rate's slew is met at first.
        let mut guided = PlanarGuidanceOutput::default();
        for _ in 0..3 {
            guided = guidance.update_in_plane(&mut state, &input, DT);
        }
        let law = guidance.control.plane().robust(
            &crate::planar::State {
                velocity: input.velocity,
                attitude: input.attitude,
                wind: Inertial::ZERO,
            },
            &input.reference,
            None,
        );
        assert_eq!(Ok(guided.command), law);
        assert_eq!(
            (guided.status, guided.reject_reason),
            (Status::empty(), None)
        );
        assert_eq!(guided.progress.phase, Phase::Tracking);
        assert!(guided.margin.force > 1.0 && guided.margin.fold > 1.0);
    }

    /// Lets the believed vehicle fly in the vertical plane by the guidance, which it obeys at once, and calls `each` with the
    /// velocity after every step.
    fn fly(
        guidance: &Guidance<Combined>,
        state: &mut GuidanceState,
        input: &mut PlanarGuidanceInput,
        seconds: f32,
        mut each: impl FnMut(f32, Inertial),
    ) {
        let vehicle = guidance.control.plane().vehicle();
        let mut theta = math::atan2(input.attitude.sin, input.attitude.cos);
        for n in 1..=(seconds / DT) as usize {
            let guided = guidance.update_in_plane(state, input, DT);
            assert_eq!(guided.reject_reason, None);
            let air = crate::air::AirData::new(
                input.attitude.to_body(input.velocity),
                vehicle.thrust_line(),
            );
            let force = vehicle.aerodynamic_force(&air)
                - crate::frame::Body::new(guided.command.thrust, 0.0);
            let acceleration = input.attitude.to_inertial(force) / vehicle.mass()
                + Inertial::new(vehicle.gravity(), 0.0);
            input.velocity += acceleration * DT;
            theta += guided.command.rate * DT;
            input.attitude = Attitude::from_angle(theta);
            each(n as f32 * DT, input.velocity);
        }
    }

    /// Where the wing carries, the air turns F_p with the velocity: an error across the thrust line would close more slowly
    /// than in hover.
    #[test]
    fn a_velocity_error_closes_at_least_as_fast_in_cruise_as_in_hover() {
        let p = GuidanceParameters {
            position_gain_down: 0.0,
            position_gain_forward: 0.0,
            integral_gain_down: 0.0,
            integral_gain_forward: 0.0,
            ..parameters()
        };
        let guidance = with(&p);
        let time = |speed: f32, theta: f32, across: Inertial| {
            let mut state = GuidanceState::default();
            let cruise = Inertial::new(0.0, speed);
            let mut input = PlanarGuidanceInput {
                velocity: cruise,
                attitude: Attitude::from_angle(theta),
                reference: Reference {
                    velocity: cruise,
                    acceleration: Inertial::ZERO,
                },
                ..HOVER
            };
            fly(&guidance, &mut state, &mut input, 10.0, |_, _| {});
            let before = input.velocity;
            input.velocity += across;
            let mut closed = f32::MAX;
            fly(&guidance, &mut state, &mut input, 3.0, |t, v| {
                let left = (v - before).dot(&across) / across.norm_squared();
                if left < 0.2 && closed > t {
                    closed = t;
                }
            });
            closed
        };
        let hover = time(0.0, 0.0, Inertial::new(0.0, 0.2));
        let carried = time(20.0, -1.5, Inertial::new(0.2, 0.0));
        // 0.37 s against 0.61 s; 0.66 s by the law's own k2.
        assert!(carried < 0.8 * hover, "{hover} {carried}");
    }

    /// On its back at 16 m/s, the nose held by the air whatever is commanded: a vehicle that turns by its slipstream gets thrust, though it
    /// believes that the airflow alone turns it.
    #[test]
    fn an_attitude_that_does_not_follow_gets_thrust() {
        let vehicle = VehicleParameters {
            thrust_max: 1.7 * 98.1,
            authority: 0.0,
            authority_slipstream: 40.0,
            authority_airflow: 0.5,
            wing_moment: 0.5,
            hover_downwash: 8.0,
            ..VehicleParameters::PAPER
        };
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let guidance = Guidance::new(Vehicle::new(vehicle, model).unwrap(), &parameters()).unwrap();
        let input = PlanarGuidanceInput {
            velocity: Inertial::new(5.0, -16.0),
            attitude: Attitude::from_angle(1.6),
            ..HOVER
        };
        let mut state = GuidanceState::default();
        let mut guided = PlanarGuidanceOutput::default();
        for _ in 0..200 {
            guided = guidance.update_in_plane(&mut state, &input, DT);
            assert_eq!(guided.reject_reason, None);
        }
        assert!(guided.command.thrust > 0.5 * 98.1, "{guided:?}");
    }

    /// In a wind whose force is twice the one believed, and without an accelerometer, the vehicle leans farther than the model does. That is no turn
    /// that it is behind with: no thrust is raised for one, and it stays at its altitude.
    #[test]
    fn a_lean_that_the_belief_does_not_know_gets_no_thrust() {
        let vehicle = VehicleParameters {
            authority: 0.0,
            authority_slipstream: 20.0 / 0.7,
            wing_moment: 0.45,
            hover_downwash: 8.0,
            ..VehicleParameters::PAPER
        };
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let guidance = Guidance::new(Vehicle::new(vehicle, model).unwrap(), &parameters()).unwrap();
        let wind = Inertial::new(0.0, -5.0);
        let mut input = PlanarGuidanceInput {
            air: Air::Wind(wind),
            position_error: None,
            ..HOVER
        };
        let (mut state, mut theta, mut most) = (GuidanceState::default(), 0.0, 0.0_f32);
        let believed = guidance.control.plane().vehicle();
        for n in 0..2000 {
            let guided = guidance.update_in_plane(&mut state, &input, DT);
            let air = crate::air::AirData::new(
                input.attitude.to_body(input.velocity - wind),
                believed.thrust_line(),
            );
            let force = believed.aerodynamic_force(&air) * 2.0
                - crate::frame::Body::new(guided.command.thrust, 0.0);
            input.velocity += (input.attitude.to_inertial(force) / believed.mass()
                + Inertial::new(believed.gravity(), 0.0))
                * DT;
            theta += guided.command.rate * DT;
            input.attitude = Attitude::from_angle(theta);
            if n > 300 {
                most = math::max(most, -input.velocity.down());
            }
        }
        assert!(most < 0.3, "climbs at {most} m/s");
    }

    /// A specific force that is no number is left out and told; none at all is only left out.
    #[test]
    fn a_bad_specific_force_is_told() {
        let told = |specific_force| {
            let input = GuidanceInput {
                air: Air::Wind(Ned::ZERO),
                specific_force,
                ..GuidanceInput::default()
            };
            let guided = guidance().update(&mut airborne(), &input, DT);
            assert_eq!((guided.mode, guided.reject_reason), (Mode::Flying, None));
            guided.status.contains(Status::FORCE_INVALID)
        };
        assert!(!told(None) && !told(Some(Frd::new(9.81, 0.0, 0.0))));
        assert!(told(Some(Frd::new(f32::NAN, 0.0, 0.0))));
        assert!(told(Some(Frd::new(0.0, 1e30, 0.0))));
    }

    /// A vehicle that flies is neither dropped at the first step, nor turned away from what it does.
    #[test]
    fn what_flies_already_is_taken_over_with_its_command() {
        let guidance = guidance();
        let up = Orientation::in_plane(Attitude::from_angle(0.0));
        let bad = PlanarGuidanceInput {
            state_age: 1.0,
            ..HOVER
        };
        let rates = BodyRates::new(0.1, -0.2, 0.3);
        let mut state = guidance.take_over(&up, 80.0, rates);
        let held = guidance.update_in_plane(&mut state, &bad, DT);
        assert_eq!((held.mode, held.status), (Mode::Holding, Status::empty()));
        assert_eq!(held.command.thrust, 80.0);
        assert_eq!(state.limits.rates, Body::from(rates));
        let flown = guidance.update_in_plane(&mut state, &HOVER, DT);
        assert_eq!(flown.mode, Mode::Flying);
        // Inputs that never come: held, then the safe thrust, never none.
        let mut state = guidance.take_over(&up, 80.0, BodyRates::default());
        for _ in 0..40 {
            let guided = guidance.update_in_plane(&mut state, &bad, DT);
            let expected = if guided.mode == Mode::Safe {
                SAFE_THRUST
            } else {
                80.0
            };
            assert_eq!(guided.command.thrust, expected);
        }
        // Inside the limits, and finite, whatever is told.
        let nan = BodyRates::new(f32::NAN, 0.0, 0.0);
        for (orientation, thrust, rates, expected) in [
            (up, 1e9, nan, THRUST_MAX),
            (up, -1e9, nan, 0.0),
            (up, f32::NAN, rates, SAFE_THRUST),
            (Orientation::UNKNOWN, f32::NAN, rates, 0.0),
        ] {
            let mut state = guidance.take_over(&orientation, thrust, rates);
            let held = guidance.update_in_plane(&mut state, &bad, DT);
            assert_eq!((held.mode, held.status), (Mode::Holding, Status::empty()));
            assert_eq!(held.command.thrust, expected);
        }
    }

    #[test]
    fn power_on_is_safe_until_frames_are_good_for_a_while() {
        let (guidance, mut state) = (guidance(), GuidanceState::default());
        for n in 0..8 {
            let guided = guidance.update_in_plane(&mut state, &HOVER, DT);
            // 50 ms of good frames; five steps of 10 ms round to just below.
            let flying = n >= 6;
            assert_eq!(guided.mode == Mode::Flying, flying, "{n}");
            if !flying {
                // Nothing has flown yet: no thrust.
                assert_eq!((guided.command.thrust, guided.command.rate), (0.0, 0.0));
            }
        }
        // Inputs that fail for longer than `hold` end in the safe thrust, and after a recovery that was cut short as well.
        let bad = PlanarGuidanceInput {
            state_age: 1.0,
            ..HOVER
        };
        for n in 0..40 {
            let input = if n == 20 { HOVER } else { bad };
            let guided = guidance.update_in_plane(&mut state, &input, DT);
            if n >= 12 {
                assert_eq!(guided.mode, Mode::Safe, "{n}");
                assert_eq!(
                    (guided.command.thrust, guided.command.rate),
                    (SAFE_THRUST, 0.0)
                );
            }
        }
        // Without a reference there is nothing to fly to.
        let mut state = GuidanceState::default();
        let late = PlanarGuidanceInput {
            reference_age: 1.0,
            ..HOVER
        };
        for _ in 0..20 {
            let guided = guidance.update_in_plane(&mut state, &late, DT);
            assert_eq!(guided.mode, Mode::Safe);
            assert_eq!(guided.reject_reason, Some(RejectReason::NoReference));
        }
    }

    #[test]
    fn one_bad_frame_is_bridged_by_the_last_command_and_leaves_no_trace() {
        let guidance = guidance();
        let nan = Inertial::new(f32::NAN, 0.0);
        let bad = [
            (
                PlanarGuidanceInput {
                    velocity: nan,
                    ..HOVER
                },
                DT,
                RejectReason::Law(Fault::Velocity),
            ),
            (
                PlanarGuidanceInput {
                    attitude: Attitude { cos: 0.5, sin: 0.5 },
                    ..HOVER
                },
                DT,
                RejectReason::Law(Fault::Attitude),
            ),
            (
                PlanarGuidanceInput {
                    state_age: 0.06,
                    ..HOVER
                },
                DT,
                RejectReason::StateAge,
            ),
            (
                PlanarGuidanceInput {
                    state_age: f32::NAN,
                    ..HOVER
                },
                DT,
                RejectReason::StateAge,
            ),
            (HOVER, 0.0, RejectReason::TimeStep),
            (HOVER, f32::NAN, RejectReason::TimeStep),
            (HOVER, -DT, RejectReason::TimeStep),
            (
                PlanarGuidanceInput {
                    state_age: -0.01,
                    ..HOVER
                },
                DT,
                RejectReason::StateAge,
            ),
        ];
        for (input, dt, refusal) in bad {
            let mut state = airborne();
            let (before, integral) = (
                guidance.update_in_plane(&mut state, &HOVER, DT),
                state.integral,
            );
            let held = guidance.update_in_plane(&mut state, &input, dt);
            assert_eq!(
                (held.mode, held.reject_reason),
                (Mode::Holding, Some(refusal))
            );
            assert_eq!(held.command.thrust, before.command.thrust);
            assert_eq!(held.command.rate, before.command.rate);
            assert_eq!(state.integral, integral);
            assert_eq!(guidance.update_in_plane(&mut state, &HOVER, DT), before);
        }
    }

    #[test]
    fn sustained_failure_ends_in_the_safe_command_and_recovers_from_where_the_vehicle_is() {
        let (guidance, mut state) = (guidance(), airborne());
        let bad = PlanarGuidanceInput {
            velocity: Inertial::new(f32::INFINITY, 0.0),
            ..HOVER
        };
        for n in 0..30 {
            let guided = guidance.update_in_plane(&mut state, &bad, DT);
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
        let moving = PlanarGuidanceInput {
            velocity: Inertial::new(3.0, 1.0),
            ..HOVER
        };
        let mut guided = PlanarGuidanceOutput::default();
        while guided.mode != Mode::Flying {
            guided = guidance.update_in_plane(&mut state, &moving, DT);
        }
        // The reference model sets out from the velocity there is. 0.1 m/s: one step at 1 g.
        let (velocity, _) = state.reference_model();
        assert!((velocity.to_plane() - moving.velocity).norm() < 0.1);
    }

    #[test]
    fn a_stale_reference_is_held_without_acceleration() {
        let (guidance, mut state) = (guidance(), airborne());
        let fresh = PlanarGuidanceInput {
            velocity: Inertial::new(0.0, 5.0),
            reference: Reference {
                velocity: Inertial::new(0.0, 5.0),
                acceleration: Inertial::new(0.0, 2.0),
            },
            ..HOVER
        };
        for _ in 0..500 {
            guidance.update_in_plane(&mut state, &fresh, DT);
        }
        let nan = Inertial::new(0.0, f32::NAN);
        for stale in [
            PlanarGuidanceInput {
                reference_age: 0.6,
                ..fresh
            },
            PlanarGuidanceInput {
                reference_age: f32::NAN,
                ..fresh
            },
            PlanarGuidanceInput {
                reference: Reference {
                    acceleration: nan,
                    ..fresh.reference
                },
                ..fresh
            },
        ] {
            let mut state = state;
            let mut guided = PlanarGuidanceOutput::default();
            for _ in 0..1000 {
                guided = guidance.update_in_plane(&mut state, &stale, DT);
            }
            assert_eq!(guided.mode, Mode::Flying);
            assert!(guided.status.contains(Status::REFERENCE_HELD));
            // The reference model has settled on the last one. 0.05 m/s: the vehicle itself does not move, so the position
            // reckoned is at its bound, and a little of the model's with it.
            let (velocity, _) = state.reference_model();
            assert!((velocity.to_plane() - fresh.reference.velocity).norm() < 0.05);
            let back = guidance.update_in_plane(&mut state, &fresh, DT);
            assert!(!back.status.contains(Status::REFERENCE_HELD));
        }
    }

    /// With neither air data nor an accelerometer, and slow, the law is that of k_a = 0: the plain thrust vector of a multicopter.
    #[test]
    fn slow_and_blind_is_flown_by_the_plain_thrust_vector() {
        let (guidance, mut state) = (guidance(), GuidanceState::default());
        let input = PlanarGuidanceInput {
            // Half of the speed at which the believed wing carries the weight with a lift coefficient of 1 is 6.6 m/s.
            velocity: Inertial::new(0.5, 6.0),
            attitude: Attitude::from_angle(-0.4),
            air: Air::Unknown,
            position_error: None,
            ..HOVER
        };
        let mut guided = PlanarGuidanceOutput::default();
        while guided.mode != Mode::Flying {
            guided = guidance.update_in_plane(&mut state, &input, DT);
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
        let corrupt: [fn(&mut GuidanceState); 12] = [
            |s| s.lean = f32::NAN,
            // Beyond the bound of a vehicle of full authority.
            |s| s.lean = 0.1,
            |s| s.integral = Ned::new(0.0, f32::NAN, 0.0),
            |s| s.flight.velocity = Ned::new(f32::INFINITY, 0.0, 0.0),
            |s| s.flight.position = Ned::new(0.0, 1e9, 0.0),
            |s| s.flight.theta = f32::NAN,
            |s| s.wind = Ned::new(1e4, 0.0, 0.0),
            |s| s.planner.plan.target = 1e9,
            |s| s.limits.rates.i = f32::NAN,
            |s| s.limits.rates.w = 500.0,
            |s| s.held = Ned::new(0.0, -1e9, 0.0),
            |s| s.supervision.wind = Ned::new(0.0, 0.0, 1e30),
        ];
        for corrupt in corrupt {
            let mut state = airborne();
            corrupt(&mut state);
            let guided = guidance.update_in_plane(&mut state, &HOVER, DT);
            assert_eq!(guided.mode, Mode::Flying);
            assert!(guided.status.contains(Status::STATE_RESET));
            let next = guidance.update_in_plane(&mut state, &HOVER, DT);
            assert_eq!(next.status, Status::empty());
            assert_eq!(next.command.thrust, 9.0 * 9.81);
        }
    }

    /// A reference model that could be one, but of another vehicle: it begins anew from the real one, and nothing is flown to.
    #[test]
    fn a_reference_model_far_from_the_vehicle_begins_anew() {
        let guidance = guidance();
        let corrupt: [fn(&mut GuidanceState); 3] = [
            |s| s.flight.position.down = 9e4,
            |s| s.flight.position.east = -51.0,
            |s| s.flight.velocity.north = 26.0,
        ];
        for corrupt in corrupt {
            let mut state = airborne();
            corrupt(&mut state);
            let guided = guidance.update_in_plane(&mut state, &HOVER, DT);
            assert_eq!(guided.command.thrust, 9.0 * 9.81);
            // One step of the reference model away.
            assert!(state.flight.position.norm_squared() < 1e-4);
            assert!(state.flight.velocity.norm_squared() < 1e-2);
        }
    }

    /// A corrupt last command and a bad frame at once: what is held is inside the limits all the same.
    #[test]
    fn a_corrupt_last_command_is_not_held() {
        let guidance = guidance();
        let bad = PlanarGuidanceInput {
            velocity: Inertial::new(f32::NAN, 0.0),
            ..HOVER
        };
        for value in [f32::NAN, 1e30, 500.0, -1e6] {
            for thrust in [false, true] {
                let mut state = airborne();
                if thrust {
                    state.limits.thrust = value;
                } else {
                    state.limits.rates.w = value;
                }
                let guided = guidance.update_in_plane(&mut state, &bad, DT);
                assert_eq!(guided.mode, Mode::Holding);
                assert!(guided.status.contains(Status::STATE_RESET));
                assert!((0.0..=THRUST_MAX).contains(&guided.command.thrust));
                assert!(guided.command.rate.abs() <= 2.8);
            }
        }
    }

    /// A vehicle whose least thrust is not zero: the memory of power-on, but with another mode, and a bad frame.
    #[test]
    fn no_thrust_below_the_least_is_held() {
        let vehicle = VehicleParameters {
            thrust_min: 5.0,
            ..VehicleParameters::PAPER_BELIEF
        };
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        let guidance = Guidance::new(Vehicle::new(vehicle, model).unwrap(), &parameters()).unwrap();
        let mut state = GuidanceState {
            supervision: SupervisionState::in_mode(Mode::Holding),
            ..GuidanceState::default()
        };
        let bad = PlanarGuidanceInput {
            state_age: 1.0,
            ..HOVER
        };
        let guided = guidance.update_in_plane(&mut state, &bad, DT);
        assert_eq!(guided.mode, Mode::Holding);
        assert_eq!(guided.command.thrust, 5.0);
    }

    #[test]
    fn the_memory_goes_to_bytes_and_back() {
        let state = airborne();
        let bytes = state.to_bytes();
        let mut back = GuidanceState::from_bytes(&bytes);
        assert_eq!((back, back.to_bytes()), (state, bytes));
        let guided = guidance().update_in_plane(&mut back, &HOVER, DT);
        assert_eq!(guided.status, Status::empty());
        let on = [0; GuidanceState::BYTES];
        assert_eq!(GuidanceState::from_bytes(&on), GuidanceState::default());
    }

    /// A reference at the edge of what is accepted is no corruption.
    #[test]
    fn an_extreme_reference_does_not_reset_the_memory() {
        let guidance = guidance();
        let input = PlanarGuidanceInput {
            velocity: Inertial::new(0.0, 700.0),
            reference: Reference {
                velocity: Inertial::new(0.0, 710.0),
                acceleration: Inertial::new(0.0, 700.0),
            },
            air: Air::Unknown,
            ..HOVER
        };
        let mut state = GuidanceState::default();
        for _ in 0..100 {
            let guided = guidance.update_in_plane(&mut state, &input, 0.2);
            assert!(!guided.status.contains(Status::STATE_RESET));
        }
        assert_eq!(state.mode(), Mode::Flying);
    }

    /// The longest time that a wind is held ends also at the shortest step.
    #[test]
    fn no_clock_of_the_memory_stands_still() {
        let longest = GuidanceParameters::ROWS
            .iter()
            .filter(|row| ["hold", "recovery", "air_hold"].contains(&row.name));
        for row in longest {
            let before = row.max - MIN_STEP;
            assert!(before + MIN_STEP > before, "{}", row.name);
        }
    }

    /// Timestamps that come twice, even several times in a row, are bridged; a clock that stands still is not.
    #[test]
    fn repeated_timestamps_do_not_end_the_flight() {
        let (guidance, mut state) = (guidance(), airborne());
        for _ in 0..100 {
            for _ in 0..3 {
                let held = guidance.update_in_plane(&mut state, &HOVER, 0.0);
                assert_eq!(
                    (held.mode, held.reject_reason),
                    (Mode::Holding, Some(RejectReason::TimeStep))
                );
            }
            assert_eq!(
                guidance.update_in_plane(&mut state, &HOVER, DT).mode,
                Mode::Flying
            );
        }
        let stopped = (0..2000).map(|_| guidance.update_in_plane(&mut state, &HOVER, 0.0).mode);
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
        let below = GuidanceParameters {
            safe_thrust: 0.02,
            ..p
        };
        assert_eq!(refused(idle, &below), contradicts("safe_thrust"));
        // None asked for: the least there is.
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        let none = GuidanceParameters {
            safe_thrust: 0.0,
            ..p
        };
        let least = Guidance::new(Vehicle::new(idle, model).unwrap(), &none).unwrap();
        assert_eq!(least.supervisor.safe_thrust(), 3.0);
        let above = GuidanceParameters {
            safe_thrust: 2.1,
            ..p
        };
        assert_eq!(refused(v, &above), contradicts("safe_thrust"));
        let full = GuidanceParameters {
            max_integral_down: p.max_velocity_down + 0.1,
            ..p
        };
        assert_eq!(refused(v, &full), contradicts("max_integral_down"));
        let full = GuidanceParameters {
            max_integral_forward: p.max_velocity_forward + 0.1,
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
            let guided = guidance.update_in_plane(&mut state, &input, dt);
            let Command { thrust, rate, .. } = guided.command;
            assert!((0.0..=THRUST_MAX).contains(&thrust) && rate.abs() <= 2.8);
            let Margin { force, k, fold } = guided.margin;
            assert!(force.is_finite() && k.is_finite() && fold.abs() <= 3.15);
            modes[guided.mode as usize] += 1;
        }
        assert!(modes.iter().all(|&n| n > 1000), "{modes:?}");
    }
}
