//! What the accelerometer tells: the force that the believed vehicle leaves out, and the lateral air velocity that the known
//! wind leaves out.

use super::memory::memory;
use super::parameters::GuidanceParameters;
use super::supervision::AirUse;
use crate::aero::Aerodynamics;
use crate::error::ParameterError;
use crate::math;
use crate::spatial::{
    Body, Command, Correction, ForceError, ForceErrorParameters, ForceErrorState, ForceSample,
    Orientation, Sideslip, SideslipParameters, SideslipState,
};
use crate::vehicle::Vehicle;

/// Time constant of the force error \[s\].
const TIME: f32 = 0.2;
/// Greatest force error that is believed, in multiples of the weight.
const MOST: f32 = 0.6;
/// Time in which the force of the air takes over what is left of the force error along it \[s\], and the bounds of what is
/// believed of it.
const AIR_TIME: f32 = 0.5;
const LEAST_EXCESS: f32 = -0.4;
const MOST_EXCESS: f32 = 0.6;
/// Force of the air, in multiples of the weight, below which it counts less.
const AIR_FORCE: f32 = 0.3;
/// Side force coefficient below which an accelerometer says nothing of the sideslip.
const LEAST_C_Y: f32 = 1e-3;

/// The estimators.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Accelerometer {
    force: ForceError,
    most: f32,
    air_force: f32,
    sideslip: Option<Sideslip>,
    most_sideslip: f32,
}

/// What they remember.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct AccelerometerState {
    pub force: ForceErrorState,
    pub sideslip: SideslipState,
    /// Force of the air that is measured, as a multiple of the believed one, less 1.
    pub excess: f32,
}

memory!(AccelerometerState {
    force: ForceErrorState,
    sideslip: SideslipState,
    excess: f32,
});
memory!(ForceErrorState {
    force: crate::ned::Ned,
    thrust: f32,
});
memory!(SideslipState { velocity: f32 });

impl Accelerometer {
    /// The estimators for `vehicle`, with parameters that have been checked.
    pub fn new<A: Aerodynamics>(
        p: &GuidanceParameters,
        vehicle: &Vehicle<A>,
    ) -> Result<Self, ParameterError> {
        let most = math::clamp(MOST * vehicle.weight(), 1e-3, 1e6);
        let force = ForceErrorParameters {
            time: TIME,
            thrust_lag: p.thrust_lag,
            most,
        };
        let sideslip = SideslipParameters::DEFAULT;
        Ok(Self {
            force: ForceError::new(force, vehicle.mass())?,
            most,
            air_force: AIR_FORCE * vehicle.weight(),
            sideslip: if vehicle.c_y() >= LEAST_C_Y {
                Some(Sideslip::new(sideslip, vehicle)?)
            } else {
                None
            },
            most_sideslip: 2.0 * sideslip.most,
        })
    }

    /// Whether every number is one that a step can have left. NaN is not.
    #[inline(always)]
    pub fn is_sound(&self, state: &AccelerometerState) -> bool {
        let AccelerometerState {
            force,
            sideslip,
            excess,
        } = state;
        (force.force.norm_squared() <= 1.000_01 * self.most * self.most)
            & (force.thrust.abs() <= 1e7)
            & (sideslip.velocity.abs() <= self.most_sideslip)
            & (LEAST_EXCESS..=MOST_EXCESS).contains(excess)
    }

    /// What the law is to add: what is in proportion to the force of the air follows it at once, the rest by its low-pass.
    #[inline(always)]
    pub fn correction(&self, state: &AccelerometerState) -> Correction {
        Correction::new(state.force.force, state.sideslip.velocity).with_air(state.excess)
    }

    /// One step of `dt` \[s\] after a command of the law in this attitude, with the specific force \[m/s²\] if it is
    /// measured. Where it is not, nothing is added any more.
    #[inline(always)]
    pub fn update(
        &self,
        state: &mut AccelerometerState,
        specific_force: Option<Body>,
        orientation: Orientation,
        command: &Command,
        air: AirUse,
        dt: f32,
    ) {
        let Some(specific_force) = specific_force else {
            *state = AccelerometerState::default();
            state.force.thrust = command.thrust;
            return;
        };
        let sample = ForceSample {
            specific_force,
            orientation,
            aerodynamic: command.diagnostics.aerodynamic,
            thrust: command.thrust,
        };
        self.force.update(&mut state.force, &sample, dt);
        let left = orientation
            .to_body(state.force.force)
            .dot(sample.aerodynamic)
            / (sample.aerodynamic.norm_squared() + self.air_force * self.air_force);
        state.excess = math::clamp(
            state.excess + left * math::min(dt / AIR_TIME, 1.0),
            LEAST_EXCESS,
            MOST_EXCESS,
        );
        // A measured air velocity has its own lateral part.
        match (&self.sideslip, air) {
            (Some(sideslip), AirUse::Wind | AirUse::HeldWind) => sideslip.update(
                &mut state.sideslip,
                command.diagnostics.v_a,
                specific_force.w,
                dt,
            ),
            _ => state.sideslip = SideslipState::default(),
        }
    }
}
