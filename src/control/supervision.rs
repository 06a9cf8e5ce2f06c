//! Supervision: what is commanded when the inputs are not fit to fly on.

use super::command::Fault;
use crate::error::{ParameterError, in_range};
use crate::frame::Inertial;
use crate::reference::MAX_SPEED;

/// Time steps \[s\] longer than this are refused.
pub const MAX_STEP: f32 = 0.2;

/// Parameters of supervision. Times in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SupervisionParameters {
    /// How long bad frames are bridged by the last command.
    pub hold: f32,
    /// How long frames must be good without a break before the safe command is left.
    pub recovery: f32,
    /// Age beyond which a measured state is refused.
    pub state_age: f32,
    /// Age beyond which a reference is no longer followed.
    pub reference_age: f32,
    /// How long the last known wind stands in for missing air data.
    pub air_hold: f32,
    /// Thrust \[N\] of the safe command.
    pub safe_thrust: f32,
}

/// What the guidance does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Gives the safe command.
    #[default]
    Safe,
    /// Repeats the last command.
    Holding,
    /// Flies the law.
    Flying,
}

/// What is known of the air.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Air {
    /// The air velocity v_a = v − v_w [m/s] is measured.
    Velocity(Inertial),
    /// The wind v_w [m/s] is known, from a forecast or an estimator.
    Wind(Inertial),
    /// Nothing.
    #[default]
    Unknown,
}

/// What of the air is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AirUse {
    /// The measured air velocity.
    Velocity,
    /// The wind given.
    Wind,
    /// The last wind known.
    HeldWind,
    /// Nothing: plain thrust vectoring.
    #[default]
    None,
}

/// Why a frame was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The time step is not in (0, [`MAX_STEP`]].
    TimeStep,
    /// The state is older than `state_age`.
    StateAge,
    /// No good reference has come yet.
    NoReference,
    /// The law's own reason.
    Law(Fault),
}

/// Decides the mode and what is known of the air.
///
/// | mode | command | entered | left |
/// |---|---|---|---|
/// | [`Mode::Flying`] | the law's | from holding by one good frame; from safe by good frames for `recovery` | by one bad frame |
/// | [`Mode::Holding`] | the last one flown, unchanged | by one bad frame | by one good frame; to safe after `hold` |
/// | [`Mode::Safe`] | `safe_thrust`, no rotation | at power-on; from holding after `hold` | by good frames for `recovery` |
///
/// A frame is bad if the velocity or the attitude is not finite, absurd or older than `state_age`, if the time step
/// is not in (0, [`MAX_STEP`]], if there is no reference to fly to, or if the law has no answer. In holding the
/// integrators stand still; in safe they are reset, and the law sets out from the velocity there is.
///
/// What is missing of the rest degrades the flight, and does not end it:
///
/// | missing | flown instead | until |
/// |---|---|---|
/// | air velocity, but wind known | velocity less wind: [`AirUse::Wind`] | it is measured again |
/// | both, for less than `air_hold` | velocity less the last wind: [`AirUse::HeldWind`] | either comes back |
/// | both | no air at all, as with k_a = 0, plain thrust vectoring: [`AirUse::None`] | either comes back |
/// | reference (not finite, absurd, older than `reference_age`) | the last velocity, no acceleration, no position hold | a good one comes |
/// | position error | no position hold; the integral goes on from the velocity | it comes back |
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Supervisor {
    p: SupervisionParameters,
}

/// What supervision remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SupervisionState {
    /// Mode of the last step.
    pub mode: Mode,
    /// Time \[s\] of bad frames while holding, of good ones while safe.
    pub(super) elapsed: f32,
    /// The last wind known [m/s].
    pub(super) wind: Option<Inertial>,
    /// Its age \[s\].
    pub(super) wind_age: f32,
}

impl Supervisor {
    /// Supervision with these parameters.
    ///
    /// # Errors
    /// A time outside [0, 1e6] s, `safe_thrust` outside [−1e6, 1e6] N, or any not finite.
    pub fn new(p: SupervisionParameters) -> Result<Self, ParameterError> {
        for (name, time) in [
            ("hold", p.hold),
            ("recovery", p.recovery),
            ("state_age", p.state_age),
            ("reference_age", p.reference_age),
            ("air_hold", p.air_hold),
        ] {
            in_range(name, time, 0.0, 1e6)?;
        }
        in_range("safe_thrust", p.safe_thrust, -1e6, 1e6)?;
        Ok(Self { p })
    }

    /// The parameters.
    #[inline(always)]
    pub fn parameters(&self) -> &SupervisionParameters {
        &self.p
    }

    /// The mode after `dt` \[s\] with a frame that was `good` or not.
    #[inline(always)]
    pub(super) fn advance(&self, state: &mut SupervisionState, good: bool, dt: f32) -> Mode {
        let (mode, elapsed) = match (state.mode, good) {
            (Mode::Flying | Mode::Holding, true) => (Mode::Flying, 0.0),
            (Mode::Flying, false) => (Mode::Holding, dt),
            (Mode::Holding, false) if state.elapsed < self.p.hold => {
                (Mode::Holding, state.elapsed + dt)
            }
            (_, false) => (Mode::Safe, 0.0),
            (Mode::Safe, true) if state.elapsed < self.p.recovery => {
                (Mode::Safe, state.elapsed + dt)
            }
            (Mode::Safe, true) => (Mode::Flying, 0.0),
        };
        state.mode = mode;
        state.elapsed = elapsed;
        if !good {
            state.wind_age += dt;
        }
        mode
    }

    /// The wind [m/s] to fly with at a `velocity` over ground, what it stands on, and whether `air` was invalid.
    #[inline(always)]
    pub(super) fn wind(
        &self,
        state: &mut SupervisionState,
        velocity: Inertial,
        air: &Air,
        dt: f32,
    ) -> (Inertial, AirUse, bool) {
        let (given, used) = match *air {
            Air::Velocity(v_a) => (velocity - v_a, AirUse::Velocity),
            Air::Wind(wind) => (wind, AirUse::Wind),
            Air::Unknown => return self.without_air(state, velocity, dt, false),
        };
        if given.norm_squared() < MAX_SPEED * MAX_SPEED {
            state.wind = Some(given);
            state.wind_age = 0.0;
            (given, used, false)
        } else {
            self.without_air(state, velocity, dt, true)
        }
    }

    fn without_air(
        &self,
        state: &mut SupervisionState,
        velocity: Inertial,
        dt: f32,
        invalid: bool,
    ) -> (Inertial, AirUse, bool) {
        state.wind_age += dt;
        match state.wind {
            Some(wind) if state.wind_age <= self.p.air_hold => (wind, AirUse::HeldWind, invalid),
            _ => {
                state.wind = None;
                // Moving with the air there is no aerodynamic force: the law is that of k_a = 0.
                (velocity, AirUse::None, invalid)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const P: SupervisionParameters = SupervisionParameters {
        hold: 0.1,
        recovery: 0.05,
        state_age: 0.05,
        reference_age: 0.5,
        air_hold: 1.0,
        safe_thrust: 0.0,
    };

    /// Modes over frames of 1/64 s (exact in binary): 7 frames of hold, 4 of recovery.
    fn modes(frames: &[(bool, usize)]) -> std::vec::Vec<(Mode, usize)> {
        let supervisor = Supervisor::new(P).unwrap();
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
        let supervisor = Supervisor::new(P).unwrap();
        let mut state = SupervisionState::default();
        let v = Inertial::new(1.0, 12.0);
        let mut wind = |air: Air| supervisor.wind(&mut state, v, &air, 0.125);
        let w = Inertial::new(0.0, -3.0);
        // Nothing known yet: the air moves with the vehicle.
        assert_eq!(wind(Air::Unknown), (v, AirUse::None, false));
        assert_eq!(wind(Air::Velocity(v - w)), (w, AirUse::Velocity, false));
        assert_eq!(wind(Air::Wind(w)), (w, AirUse::Wind, false));
        // Held for 1 s.
        for n in 0..8 {
            let nan = Air::Velocity(Inertial::new(f32::NAN, 0.0));
            let (air, invalid) = if n % 2 == 0 {
                (nan, true)
            } else {
                (Air::Unknown, false)
            };
            assert_eq!(wind(air), (w, AirUse::HeldWind, invalid));
        }
        assert_eq!(wind(Air::Unknown), (v, AirUse::None, false));
        assert_eq!(
            wind(Air::Wind(Inertial::new(f32::INFINITY, 0.0))),
            (v, AirUse::None, true)
        );
        assert_eq!(wind(Air::Wind(w)), (w, AirUse::Wind, false));
    }

    #[test]
    fn bad_parameters_are_named() {
        let name = |p| Supervisor::new(p).unwrap_err().parameter;
        assert_eq!(name(SupervisionParameters { hold: -1.0, ..P }), "hold");
        assert_eq!(
            name(SupervisionParameters {
                air_hold: f32::NAN,
                ..P
            }),
            "air_hold"
        );
        assert_eq!(
            name(SupervisionParameters {
                safe_thrust: f32::INFINITY,
                ..P
            }),
            "safe_thrust"
        );
    }
}
