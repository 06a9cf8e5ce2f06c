//! Parameters of the guidance for a vehicle, by rule.

use super::parameters::GuidanceParameters;
use crate::aero::Aerodynamics;
use crate::error::ParameterError;
use crate::math;
use crate::parameters::Parameters;
use crate::vehicle::Vehicle;

crate::parameters! {
    /// How fast a vehicle answers and how fast it is to fly: what the rules of [`GuidanceParameters::for_vehicle`] need
    /// besides the vehicle.
    pub struct ResponseParameters, "Response" {
        rate_lag: "s", 0.0, 1.0, f32::NAN, "ALU_RATE_LAG",
            "Lag of the rate loop: time until 63 % of a step of the rate commanded is there.";
        thrust_lag: "s", 1e-3, 1.0, f32::NAN, "ALU_THR_LAG",
            "Lag of the thrust: time until 63 % of a step of the thrust commanded is there.";
        control_rate: "Hz", 5.0, 1e4, 100.0, "ALU_CTL_RATE",
            "Rate of the guidance's steps.";
        cruise_speed: "m/s", 1.0, 340.0, f32::NAN, "ALU_CRUISE",
            "Speed of cruise.";
    }
}

impl GuidanceParameters {
    /// The parameters for `vehicle`.
    ///
    /// # Errors
    /// A number of `response` that is outside its range.
    pub fn for_vehicle<A: Aerodynamics>(
        _vehicle: &Vehicle<A>,
        response: &ResponseParameters,
    ) -> Result<Self, ParameterError> {
        response.check()?;
        let default = Self::DEFAULT;
        Ok(Self {
            rate_lag: response.rate_lag,
            thrust_lag: response.thrust_lag,
            ..default
        })
    }
}
