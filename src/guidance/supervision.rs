//! Supervision: what is commanded when the inputs are not fit to fly on.

use core::ops::Sub;

use super::memory::memory;
use super::parameters::GuidanceParameters;
use crate::aero::Aerodynamics;
use crate::control::Fault;
use crate::math;
use crate::ned::Ned;
use crate::vehicle::Vehicle;

/// Time steps \[s\] shorter than this are refused. It is also what a refused step costs if no time has passed, as with
/// a timestamp that came twice: a clock that stands still ends in the safe command, but not at once.
pub const MIN_STEP: f32 = 1e-4;
/// Time steps \[s\] longer than this are refused.
pub const MAX_STEP: f32 = 0.2;
/// What a step costs \[s\] whose length is unknown: a control period of 100 Hz.
const UNKNOWN_STEP: f32 = 0.01;
/// Longest time \[s\] counted of a run of frames: beyond every `hold` and `recovery`.
const MAX_ELAPSED: f32 = 11.0;
/// Greatest age \[s\] counted.
const MAX_AGE: f32 = 4000.0;
/// How fast the wind may have changed while no air data were accepted [m/s²].
const WIND_DRIFT: f32 = 1.0;

/// The time \[s\] that has passed as far as can be told of a step of `dt` \[s\], and whether the step can be flown.
#[inline(always)]
pub(super) fn time_passed(dt: f32) -> (f32, bool) {
    if (MIN_STEP..=MAX_STEP).contains(&dt) {
        (dt, true)
    } else if dt > MAX_STEP {
        (MAX_STEP, false)
    } else if dt >= 0.0 {
        (MIN_STEP, false)
    } else {
        // Negative or NaN.
        (UNKNOWN_STEP, false)
    }
}

/// What the guidance does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Mode {
    /// Gives the safe command.
    #[default]
    Safe,
    /// Repeats the last command.
    Holding,
    /// Flies the law.
    Flying,
}

impl Mode {
    /// Name for logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Safe => "safe",
            Self::Holding => "holding",
            Self::Flying => "flying",
        }
    }
}

/// What is known of the air.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Air<V = Ned> {
    /// The air velocity v_a = v − v_w [m/s] is measured.
    Velocity(V),
    /// The wind v_w [m/s] is known, from a forecast or an estimator.
    Wind(V),
    /// Nothing.
    #[default]
    Unknown,
    /// A pitot tube, and a wind as of an autopilot's estimator, which follows slowly.
    Pitot {
        /// Airspeed along the nose [m/s]; NaN where the tube tells nothing: too slow, or too far from the nose.
        airspeed: f32,
        /// The wind v_w [m/s].
        wind: V,
    },
}

impl<V: Copy> Air<V> {
    /// Airspeed along the nose [m/s] that a pitot tube tells, if there is one; NaN where it tells nothing.
    pub fn airspeed(&self) -> Option<f32> {
        match *self {
            Self::Pitot { airspeed, .. } => Some(airspeed),
            _ => None,
        }
    }

    /// Name for logs.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Velocity(_) => "velocity",
            Self::Wind(_) => "wind",
            Self::Unknown => "unknown",
            Self::Pitot { .. } => "pitot",
        }
    }

    /// The same with other vectors, as their projections to a plane.
    pub fn map<W>(&self, f: impl Fn(V) -> W) -> Air<W> {
        match *self {
            Self::Velocity(v_a) => Air::Velocity(f(v_a)),
            Self::Wind(wind) => Air::Wind(f(wind)),
            Self::Unknown => Air::Unknown,
            Self::Pitot { airspeed, wind } => Air::Pitot {
                airspeed,
                wind: f(wind),
            },
        }
    }
}

impl<V: Copy + Sub<Output = V>> Air<V> {
    /// The wind v_w [m/s] that this tells at a `velocity` v [m/s] over ground, if it tells one.
    pub fn wind(&self, velocity: V) -> Option<V> {
        match *self {
            Self::Velocity(v_a) => Some(velocity - v_a),
            Self::Wind(wind) | Self::Pitot { wind, .. } => Some(wind),
            Self::Unknown => None,
        }
    }
}

/// What of the air is used. The numbers are those of the library for C.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum AirUse {
    /// The measured air velocity.
    Velocity = 1,
    /// The wind given.
    Wind = 2,
    /// The last wind known.
    HeldWind = 3,
    /// Nothing for longer than `air_hold`, or never yet: the last wind known, or calm, stands in for it, and what the
    /// accelerometer feels scales the air's force. Without an accelerometer the vehicle slows down, and is then flown by plain
    /// thrust vectoring.
    #[default]
    None = 0,
    /// The air velocity estimated from pitot tube, wind and accelerometer.
    Pitot = 4,
}

impl AirUse {
    /// Name for logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Wind => "wind",
            Self::HeldWind => "held-wind",
            Self::None => "none",
            Self::Pitot => "pitot",
        }
    }
}

/// Why a frame was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum RejectReason {
    /// The time step is not in [[`MIN_STEP`], [`MAX_STEP`]].
    TimeStep,
    /// The state is older than `state_age`.
    StateAge,
    /// No good reference has come yet.
    NoReference,
    /// The law's own reason.
    Law(Fault),
}

impl RejectReason {
    /// Name for logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::TimeStep => "time_step",
            Self::StateAge => "state_age",
            Self::NoReference => "no_reference",
            Self::Law(fault) => fault.name(),
        }
    }
}

/// Decides the mode and what is known of the air.
///
/// | mode | command | entered | left |
/// |---|---|---|---|
/// | [`Mode::Flying`] | the law's | from holding by one good frame; from safe by good frames for `recovery` | by one bad frame |
/// | [`Mode::Holding`] | the last one flown, unchanged | by one bad frame | by one good frame; to safe after `hold`, of which a step of no time counts [`MIN_STEP`] |
/// | [`Mode::Safe`] | `safe_thrust`, as far as the nose pointed up when the law flew last, and none before; no rotation | at power-on; from holding after `hold` | by good frames for `recovery` |
///
/// A frame is bad for any of these reasons:
/// - The velocity or the attitude is not finite, absurd, older than `state_age`, or of negative age.
/// - The time step is not in [[`MIN_STEP`], [`MAX_STEP`]].
/// - There is no reference to fly to, or the law has no answer.
///
/// In holding the integrators stand still. In safe they are reset, and the law sets out from the velocity there is.
///
/// What is missing of the rest degrades the flight, and does not end it:
///
/// | missing | flown instead | until |
/// |---|---|---|
/// | air velocity, but wind known, and perhaps an airspeed along the nose | velocity less wind and gust: [`AirUse::Wind`], [`AirUse::Pitot`] | it is measured again |
/// | air data that imply a wind above `max_wind`, or a change of wind above `max_wind_step` | as if both were missing | they are plausible again; the change allowed grows by 1 m/s per second |
/// | both, for less than `air_hold` | velocity less the last wind: [`AirUse::HeldWind`] | either comes back |
/// | both for longer, or from the beginning, but a specific force | velocity less the last wind, or less none: [`AirUse::None`]; the law scales the air's force by what is felt | either comes back |
/// | all three | at most half of the speed at which the wing carries the weight with a lift coefficient of 1 is flown to, without horizontal position hold; once as slow as that over ground or over the air of the last wind, no air at all, as with k_a = 0: plain thrust vectoring | one comes back |
/// | reference (not finite, absurd, older than `reference_age`, or of negative age) | the last velocity, no acceleration, no position hold | a good one comes |
/// | position error | no position hold; the integral goes on from the velocity | it comes back |
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Supervisor {
    hold: f32,
    recovery: f32,
    state_age: f32,
    reference_age: f32,
    air_hold: f32,
    max_wind: f32,
    max_wind_step: f32,
    /// Thrust of the safe command with the nose up \[N\].
    safe_thrust: f32,
}

/// What supervision remembers. Numbers, not `enum` and `Option`: every bit pattern has a meaning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SupervisionState {
    /// Mode of the last step: 2 flying, 1 holding, else safe.
    mode: u8,
    /// Upward part of the nose's direction when the law flew last, 0 to 1: how much of a thrust carries. 0 before it has flown.
    pub(super) upright: f32,
    /// 1 if a wind has been known.
    wind_known: u8,
    /// Time \[s\] of bad frames while holding, of good ones while safe.
    elapsed: f32,
    /// The last wind known [m/s].
    pub(super) wind: Ned,
    /// Its age \[s\].
    pub(super) wind_age: f32,
}

memory!(SupervisionState {
    mode: u8,
    upright: f32,
    wind_known: u8,
    elapsed: f32,
    wind: Ned,
    wind_age: f32,
});

impl SupervisionState {
    /// Mode of the last step.
    #[inline(always)]
    pub fn mode(&self) -> Mode {
        match self.mode {
            2 => Mode::Flying,
            1 => Mode::Holding,
            _ => Mode::Safe,
        }
    }

    /// Power-on, but for the mode and how upright the vehicle flew last.
    pub(super) fn restarted(&self) -> Self {
        let mut state = Self {
            upright: if (0.0..=1.0).contains(&self.upright) {
                self.upright
            } else {
                0.0
            },
            ..Self::default()
        };
        state.set_mode(self.mode());
        state
    }

    /// Holding the command of a vehicle that flies already, with its nose `upright`.
    pub(super) fn holding(upright: f32) -> Self {
        let mut state = Self {
            upright,
            ..Self::default()
        };
        state.set_mode(Mode::Holding);
        state
    }

    /// Power-on, but in `mode`.
    #[cfg(test)]
    pub(super) fn in_mode(mode: Mode) -> Self {
        let mut state = Self::default();
        state.set_mode(mode);
        state
    }

    #[inline(always)]
    fn set_mode(&mut self, mode: Mode) {
        self.mode = match mode {
            Mode::Safe => 0,
            Mode::Holding => 1,
            Mode::Flying => 2,
        };
    }
}

/// The wind that is flown with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WindUse {
    /// v_w [m/s].
    pub wind: Ned,
    /// What it stands on.
    pub air: AirUse,
    /// The air data that were given are not used.
    pub air_invalid: bool,
}

/// Thrust \[N\] of the safe command with the nose up; with none asked for, the thrust nearest to none.
pub(super) fn safe_thrust<A: Aerodynamics>(p: &GuidanceParameters, vehicle: &Vehicle<A>) -> f32 {
    if p.safe_thrust == 0.0 {
        math::clamp(0.0, vehicle.thrust_min(), vehicle.thrust_max())
    } else {
        p.safe_thrust * vehicle.weight()
    }
}

impl Supervisor {
    /// Supervision with these parameters, which have been checked.
    pub fn new<A: Aerodynamics>(p: &GuidanceParameters, vehicle: &Vehicle<A>) -> Self {
        Self {
            hold: p.hold,
            recovery: p.recovery,
            state_age: p.state_age,
            reference_age: p.reference_age,
            air_hold: p.air_hold,
            max_wind: p.max_wind,
            max_wind_step: p.max_wind_step,
            safe_thrust: safe_thrust(p, vehicle),
        }
    }

    /// Thrust of the safe command with the nose up \[N\].
    #[inline(always)]
    pub fn safe_thrust(&self) -> f32 {
        self.safe_thrust
    }

    /// Whether a state of this age \[s\] may be flown on. A negative age is a fault of the clock.
    #[inline(always)]
    pub fn accepts_state(&self, age: f32) -> bool {
        (0.0..=self.state_age).contains(&age)
    }

    /// Whether a reference of this age \[s\] may be followed.
    #[inline(always)]
    pub fn accepts_reference(&self, age: f32) -> bool {
        (0.0..=self.reference_age).contains(&age)
    }

    /// Whether every number is one that this supervision can have left. NaN is not.
    #[inline(always)]
    pub(super) fn is_sound(&self, state: &SupervisionState) -> bool {
        (0.0..=MAX_ELAPSED).contains(&state.elapsed)
            && (0.0..=1.0).contains(&state.upright)
            && (0.0..=MAX_AGE).contains(&state.wind_age)
            && state.wind.norm_squared() <= self.max_wind * self.max_wind
    }

    /// The mode after `dt` \[s\] with a frame that was `good` or not.
    #[inline(always)]
    pub(super) fn advance(&self, state: &mut SupervisionState, good: bool, dt: f32) -> Mode {
        let (mode, elapsed) = match (state.mode(), good) {
            (Mode::Flying | Mode::Holding, true) => (Mode::Flying, 0.0),
            (Mode::Flying, false) => (Mode::Holding, dt),
            (Mode::Holding, false) if state.elapsed < self.hold => {
                (Mode::Holding, state.elapsed + dt)
            }
            (_, false) => (Mode::Safe, 0.0),
            (Mode::Safe, true) if state.elapsed < self.recovery => (Mode::Safe, state.elapsed + dt),
            (Mode::Safe, true) => (Mode::Flying, 0.0),
        };
        state.set_mode(mode);
        state.elapsed = elapsed;
        if !good {
            state.age_wind(dt);
        }
        mode
    }

    /// The wind to fly with at a `velocity` [m/s] over ground.
    #[inline(always)]
    pub(super) fn wind(
        &self,
        state: &mut SupervisionState,
        velocity: Ned,
        air: &Air,
        dt: f32,
    ) -> WindUse {
        let (given, air) = match *air {
            Air::Velocity(v_a) => (velocity - v_a, AirUse::Velocity),
            Air::Wind(wind) => (wind, AirUse::Wind),
            Air::Pitot { wind, .. } => (wind, AirUse::Pitot),
            Air::Unknown => return self.without_air(state, dt, false),
        };
        // A blocked pitot makes the air stand still around a moving vehicle: as if a tailwind had come up at once.
        let allowed = self.max_wind_step + WIND_DRIFT * state.wind_age;
        let steady = (given - state.wind).norm_squared() <= allowed * allowed;
        let moderate = given.norm_squared() <= self.max_wind * self.max_wind;
        if moderate && (steady || state.wind_known != 1) {
            state.wind = given;
            state.wind_known = 1;
            state.wind_age = 0.0;
            WindUse {
                wind: given,
                air,
                air_invalid: false,
            }
        } else {
            self.without_air(state, dt, true)
        }
    }

    /// Takes `wind` [m/s] for the last one known, as far as it may be one.
    pub(super) fn remember(&self, state: &mut SupervisionState, wind: Ned) {
        let square = wind.norm_squared();
        // 0.999: what is rounded stays inside.
        let most = 0.999 * self.max_wind;
        state.wind = if square > most * most {
            wind * (most / math::sqrt(square.abs()))
        } else {
            wind
        };
    }

    fn without_air(&self, state: &mut SupervisionState, dt: f32, air_invalid: bool) -> WindUse {
        state.age_wind(dt);
        WindUse {
            wind: state.wind,
            air: if state.wind_known == 1 && state.wind_age <= self.air_hold {
                AirUse::HeldWind
            } else {
                AirUse::None
            },
            air_invalid,
        }
    }
}

impl SupervisionState {
    #[inline(always)]
    fn age_wind(&mut self, dt: f32) {
        self.wind_age = math::min(self.wind_age + dt, MAX_AGE);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{LargeAngle, LargeAngleParameters};
    use crate::vehicle::VehicleParameters;

    /// Wind, what it stands on, and whether the air data were invalid.
    fn parts(used: WindUse) -> (Ned, AirUse, bool) {
        (used.wind, used.air, used.air_invalid)
    }

    /// 0.1 s of hold, 50 ms of recovery, 1 s of air hold, a wind of 40 m/s that changes by 10 m/s.
    fn supervisor() -> Supervisor {
        let model = LargeAngle::new(LargeAngleParameters::NACA_0021_RE_160E3).unwrap();
        let vehicle = Vehicle::new(VehicleParameters::PAPER, model).unwrap();
        let p = GuidanceParameters {
            air_hold: 1.0,
            ..GuidanceParameters::default()
        };
        Supervisor::new(&p, &vehicle)
    }

    /// Modes over frames of 1/64 s (exact in binary): 7 frames of hold, 4 of recovery.
    fn modes(frames: &[(bool, usize)]) -> std::vec::Vec<(Mode, usize)> {
        let supervisor = supervisor();
        let mut state = SupervisionState::default();
        let mut runs: std::vec::Vec<(Mode, usize)> = std::vec::Vec::new();
        for &(good, n) in frames {
            for _ in 0..n {
                let mode = supervisor.advance(&mut state, good, 1.0 / 64.0);
                match runs.last_mut() {
                    Some(run) if run.0 == mode => run.1 += 1,
                    _ => runs.push((mode, 1)),
                }
            }
        }
        runs
    }

    #[test]
    fn every_transition_happens_when_stated() {
        use Mode::{Flying, Holding, Safe};
        // Power-on, recovery, one bad frame.
        assert_eq!(
            modes(&[(false, 3), (true, 10), (false, 1), (true, 5)]),
            [(Safe, 3 + 4), (Flying, 6), (Holding, 1), (Flying, 5)]
        );
        // A sustained failure: held for 0.1 s, then safe, and back.
        assert_eq!(
            modes(&[(true, 5), (false, 20), (true, 6)]),
            [
                (Safe, 4),
                (Flying, 1),
                (Holding, 7),
                (Safe, 13 + 4),
                (Flying, 2)
            ]
        );
        // A break in the recovery starts it again.
        assert_eq!(
            modes(&[(true, 4), (false, 1), (true, 5)]),
            [(Safe, 9), (Flying, 1)]
        );
    }

    #[test]
    fn air_degrades_step_by_step_and_recovers() {
        let supervisor = supervisor();
        let mut state = SupervisionState::default();
        let v = Ned::new(12.0, -2.0, 1.0);
        let mut wind = |air: Air| parts(supervisor.wind(&mut state, v, &air, 0.125));
        let w = Ned::new(-3.0, 0.0, 0.0);
        // Nothing known yet: calm.
        assert_eq!(wind(Air::Unknown), (Ned::ZERO, AirUse::None, false));
        assert_eq!(wind(Air::Velocity(v - w)), (w, AirUse::Velocity, false));
        assert_eq!(wind(Air::Wind(w)), (w, AirUse::Wind, false));
        // Held for 1 s.
        for n in 0..8 {
            let nan = Air::Velocity(Ned::new(0.0, 0.0, f32::NAN));
            let (air, invalid) = if n % 2 == 0 {
                (nan, true)
            } else {
                (Air::Unknown, false)
            };
            assert_eq!(wind(air), (w, AirUse::HeldWind, invalid));
        }
        // Then it stands in for what is not known.
        assert_eq!(wind(Air::Unknown), (w, AirUse::None, false));
        assert_eq!(
            wind(Air::Wind(Ned::new(0.0, 0.0, f32::INFINITY))),
            (w, AirUse::None, true)
        );
        assert_eq!(wind(Air::Wind(w)), (w, AirUse::Wind, false));
    }

    /// A blocked pitot at 20 m/s reads as a tailwind of 20 m/s; an air velocity 1000 m/s off as a hurricane.
    #[test]
    fn implausible_winds_are_not_flown_on() {
        let supervisor = supervisor();
        let v = Ned::new(20.0, 0.0, 0.0);
        let calm = || {
            let mut state = SupervisionState::default();
            let first = parts(supervisor.wind(&mut state, v, &Air::Velocity(v), 0.01));
            assert_eq!(first, (Ned::ZERO, AirUse::Velocity, false));
            state
        };
        let mut state = calm();
        let blocked = Air::Velocity(Ned::ZERO);
        for _ in 0..90 {
            let blocked = parts(supervisor.wind(&mut state, v, &blocked, 0.01));
            assert_eq!(blocked, (Ned::ZERO, AirUse::HeldWind, true));
        }
        let far = Air::Velocity(v + Ned::new(1000.0, 0.0, 0.0));
        let mut state = calm();
        assert_eq!(
            parts(supervisor.wind(&mut state, v, &far, 0.01)),
            (Ned::ZERO, AirUse::HeldWind, true)
        );
        // At power-on too.
        let mut state = SupervisionState::default();
        assert_eq!(
            parts(supervisor.wind(&mut state, v, &far, 0.01)),
            (Ned::ZERO, AirUse::None, true)
        );
        // A gust front of 8 m/s is one.
        let mut state = calm();
        let gust = Ned::new(8.0, 0.0, 0.0);
        assert_eq!(
            parts(supervisor.wind(&mut state, v, &Air::Wind(gust), 0.01)),
            (gust, AirUse::Wind, false)
        );
        // After 15 s without air data the wind may be another.
        let mut state = calm();
        for _ in 0..1500 {
            supervisor.wind(&mut state, v, &Air::Unknown, 0.01);
        }
        let other = Ned::new(20.0, 0.0, 0.0);
        assert_eq!(
            parts(supervisor.wind(&mut state, v, &Air::Wind(other), 0.01)),
            (other, AirUse::Wind, false)
        );
    }

    #[test]
    fn a_step_costs_the_time_that_has_passed() {
        assert_eq!(time_passed(0.01), (0.01, true));
        assert_eq!(time_passed(MIN_STEP), (MIN_STEP, true));
        assert_eq!(time_passed(MAX_STEP), (MAX_STEP, true));
        // A timestamp that came twice, or a clock that hardly moves.
        assert_eq!(time_passed(0.0), (MIN_STEP, false));
        assert_eq!(time_passed(1e-9), (MIN_STEP, false));
        assert_eq!(time_passed(5.0), (MAX_STEP, false));
        assert_eq!(time_passed(f32::INFINITY), (MAX_STEP, false));
        assert_eq!(time_passed(-0.01), (UNKNOWN_STEP, false));
        assert_eq!(time_passed(f32::NAN), (UNKNOWN_STEP, false));
    }

    #[test]
    fn ages_are_neither_negative_nor_nan() {
        let supervisor = supervisor();
        assert!(supervisor.accepts_state(0.0) && supervisor.accepts_state(0.05));
        assert!(supervisor.accepts_reference(0.5));
        for bad in [-1e-3, f32::NEG_INFINITY, f32::NAN, 0.6, f32::INFINITY] {
            assert!(!supervisor.accepts_state(bad) && !supervisor.accepts_reference(bad));
        }
    }

    #[test]
    fn memory_beyond_its_bounds_is_not_sound() {
        let supervisor = supervisor();
        let sound = |change: fn(&mut SupervisionState)| {
            let mut state = SupervisionState::default();
            change(&mut state);
            supervisor.is_sound(&state)
        };
        assert!(sound(|_| ()));
        assert!(!sound(|s| s.elapsed = f32::NAN) && !sound(|s| s.elapsed = 1e9));
        assert!(!sound(|s| s.wind_age = -1.0) && !sound(|s| s.wind_age = f32::NAN));
        assert!(!sound(|s| s.wind = Ned::new(0.0, 0.0, 41.0)));
        assert!(!sound(|s| s.wind = Ned::new(f32::NAN, 0.0, 0.0)));
        // Every mode byte is a mode.
        for mode in 0..=u8::MAX {
            let state = SupervisionState {
                mode,
                ..SupervisionState::default()
            };
            assert_eq!(state.mode() == Mode::Safe, !(1..=2).contains(&mode));
        }
    }
}
