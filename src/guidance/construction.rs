//! The guidance of a vehicle: its parts, made of parameters that are checked.

use super::accelerometer::Accelerometer;
use super::bandwidth::BandwidthGains;
use super::fall::Fall;
use super::lateral_guidance::LateralGuidance;
use super::limits::Limits;
use super::parameters::GuidanceParameters;
use super::planner::Planner;
use super::supervision::{Supervisor, safe_thrust};
use super::tracker::Tracker;
use super::tuning::Tuning;
use super::update::Guidance;
use crate::aero::Aerodynamics;
use crate::control::GainLaw;
use crate::error::ParameterError;
use crate::math;
use crate::parameters::Parameters;
use crate::spatial::{LateralGains, LateralParameters, WingedControl};
use crate::vehicle::Vehicle;

/// Rate of the twist towards air velocity or heading, in multiples of the natural frequency.
const TWIST: f32 = 1.25;
/// |F_y| below which tilt and twist fade, in multiples of the weight.
const LATERAL_FORCE: f32 = 0.31;
/// Most that a lateral velocity error may ask for, in g.
const LATERAL_ACCELERATION: f32 = 0.51;
/// Sine of the angle between heading and F_y below which the heading fades.
const HEADING: f32 = 0.2;

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
        Self::of_checked(vehicle, gains, p, &Tuning::DEFAULT)
    }

    /// The same with other constants of planner and reference model than those that were found, for who searches for them again.
    ///
    /// # Errors
    /// As [`Guidance::new`], and a constant outside the range that is searched.
    pub fn with_tuning(
        vehicle: Vehicle<A>,
        gains: G,
        p: &GuidanceParameters,
        tuning: &Tuning,
    ) -> Result<Self, ParameterError> {
        tuning.check()?;
        Self::of_checked(vehicle, gains, p, tuning)
    }

    /// The same with constants that are in their ranges.
    fn of_checked(
        vehicle: Vehicle<A>,
        gains: G,
        p: &GuidanceParameters,
        tuning: &Tuning,
    ) -> Result<Self, ParameterError> {
        p.check_all()?;
        check_relations(&vehicle, p)?;
        let lateral_guidance = LateralGuidance::new(p, &vehicle);
        // What is made from here on of parameters that have been checked is in its own range: it is not checked again.
        // 2ζω_n and ω_n/(2ζ): tilt and lateral velocity make a loop of this frequency and damping.
        let rate = |x: f32| math::clamp(x, 1e-3, 1e3);
        let lateral = LateralGains::of_checked(LateralParameters {
            tilt: rate(2.0 * p.damping * p.natural_frequency),
            velocity: rate(0.5 * p.natural_frequency / p.damping),
            twist: rate(TWIST * p.natural_frequency),
            acceleration: math::clamp(LATERAL_ACCELERATION * vehicle.gravity(), 1e-3, 1e3),
            force: math::clamp(LATERAL_FORCE * vehicle.weight(), 1e-3, 1e6),
            airspeed: lateral_guidance.takeover(),
            heading: HEADING,
        });
        let planner = Planner::new(p, &vehicle, lateral_guidance.lift_coefficient(), tuning);
        Ok(Self {
            tracker: Tracker::new(p, vehicle.turning_in_hover(), planner.held(), tuning),
            fall: Fall::new(&vehicle),
            planner,
            lateral_guidance,
            accelerometer: Accelerometer::new(p, &vehicle),
            limits: Limits::new(p, &vehicle),
            supervisor: Supervisor::new(p, &vehicle),
            control: WingedControl::new(vehicle, gains, lateral),
        })
    }
}

/// Refuses limits of the thrust \[N\] between which the `weight` \[N\] is not.
pub(super) fn check_thrust(weight: f32, min: f32, max: f32) -> Result<(), ParameterError> {
    if max <= weight {
        let relation = "above the weight, mass times gravity";
        Err(ParameterError::contradiction("thrust_max", relation))
    } else if min >= weight {
        let relation = "below the weight, mass times gravity";
        Err(ParameterError::contradiction("thrust_min", relation))
    } else {
        Ok(())
    }
}

/// Refuses parameters that contradict each other or the vehicle.
fn check_relations<A: Aerodynamics>(
    vehicle: &Vehicle<A>,
    p: &GuidanceParameters,
) -> Result<(), ParameterError> {
    check_thrust(vehicle.weight(), vehicle.thrust_min(), vehicle.thrust_max())?;
    let safe = safe_thrust(p, vehicle);
    let refused = |parameter, relation| Err(ParameterError::contradiction(parameter, relation));
    if !(vehicle.thrust_min()..=vehicle.thrust_max()).contains(&safe) {
        refused(
            "safe_thrust",
            "such that it is from thrust_min to thrust_max",
        )
    } else if p.max_integral_down > p.max_velocity_down {
        refused("max_integral_down", "at most max_velocity_down")
    } else if p.max_integral_forward > p.max_velocity_forward {
        refused("max_integral_forward", "at most max_velocity_forward")
    } else {
        Ok(())
    }
}
