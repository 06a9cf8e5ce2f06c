//! The parameters of the guidance.

use super::tuning::Tuning;
use crate::error::ParameterError;
use crate::math;
use crate::parameters::Parameters;

crate::parameters! {
    /// Parameters of the guidance. Forces are multiples of the vehicle's weight, so that the defaults suit a vehicle of
    /// any size; what is a fact of the vehicle, its thrust limits among them, is in
    /// [`VehicleParameters`](crate::VehicleParameters).
    #[non_exhaustive]
    pub struct GuidanceParameters, "Guidance" {
        natural_frequency: "rad/s", 1e-3, 1e3, 4.0, "ALU_BW_FREQ",
            "Natural frequency ω_n of the loop across the thrust line.";
        damping: "", 1e-2, 1e2, 0.8, "ALU_BW_DAMP",
            "Damping ratio ζ of the loop across the thrust line.";
        thrust_rate: "1/s", 1e-3, 1e3, 3.0, "ALU_BW_THR",
            "Rate ω_v of the loop along the thrust line.";
        gain_schedule_floor: "mg", 1e-3, 1e3, 0.57, "ALU_BW_FLOOR",
            "|F_p| below which the gains grow no further.";
        tau: "mg", 1e-3, 1e3, 0.91, "ALU_BW_TAU",
            "Force τ below which the guard μ_τ acts.";

        altitude_band: "m", 1e-3, 1e3, 0.33, "ALU_BAND_ALT",
            "Altitude error that a plan may cost as much as an error of one velocity band.";
        velocity_band_down: "m/s", 1e-3, 1e3, 1.58, "ALU_BAND_V_D",
            "Velocity error, down, that costs as much as one of velocity_band_forward.";
        velocity_band_forward: "m/s", 1e-3, 1e3, 3.3, "ALU_BAND_V_F",
            "Velocity error, forward, that costs as much as one of velocity_band_down.";
        rate_lag: "s", 0.0, 1.0, 0.1, "ALU_RATE_LAG",
            "Lag of the rate loop, for which the fed forward rate is advanced.";
        thrust_lag: "s", 1e-3, 1.0, 0.05, "ALU_THR_LAG",
            "Lag of the thrust behind its command. Used with a specific force.";

        position_gain_down: "1/s", 0.0, 100.0, 1.43, "ALU_POS_P_D",
            "Velocity per position error, down. Zero turns the hold off.";
        position_gain_forward: "1/s", 0.0, 100.0, 0.81, "ALU_POS_P_F",
            "Velocity per position error, horizontal. In the plane of flight less where max_rate is low. Zero turns the hold off.";
        max_velocity_down: "m/s", 0.0, 1e3, 4.7, "ALU_POS_V_D",
            "Greatest velocity towards the reference position, down.";
        max_sink: "m/s", 0.0, 1e3, 4.7, "ALU_POS_SINK",
            "Greatest velocity towards a reference position that is below. Tail first the slipstream does not reach the surfaces.";
        max_velocity_forward: "m/s", 0.0, 1e3, 3.9, "ALU_POS_V_F",
            "Greatest velocity towards the reference position, horizontal.";
        integral_gain_down: "1/s", 0.0, 100.0, 0.3, "ALU_INT_D",
            "Growth of the integral per velocity towards the reference position, down. Zero turns it off.";
        integral_gain_forward: "1/s", 0.0, 100.0, 0.1, "ALU_INT_F",
            "Growth of the integral per velocity towards the reference position, horizontal. Zero turns it off.";
        max_integral_down: "m/s", 0.0, 1e3, 2.0, "ALU_INT_MAX_D",
            "Greatest integral, down; at most max_velocity_down.";
        max_integral_forward: "m/s", 0.0, 1e3, 1.0, "ALU_INT_MAX_F",
            "Greatest integral, horizontal; at most max_velocity_forward.";
        max_lateral_acceleration: "g", 0.0, 100.0, 2.0, "ALU_TURN_MAX",
            "Greatest acceleration to the side of the plane of flight. Zero: the plane is kept, for flights in one plane.";
        max_load_factor: "g", 3.0, 1e3, 1e3, "ALU_LOAD_MAX",
            "Greatest force of the air that an attitude is asked for; turns take two thirds. Gusts come on top. 1000: none.";
        max_rate: "rad/s", 1e-3, 1e3, 2.8, "ALU_RATE_MAX",
            "Greatest angular rate commanded, about each body axis.";
        max_slew: "rad/s^2", 1e-3, 1e6, 30.0, "ALU_SLEW_MAX",
            "Greatest change of each angular rate commanded.";

        hold: "s", 0.0, 10.0, 0.1, "ALU_SUP_HOLD",
            "How long bad frames are bridged by the last command.";
        recovery: "s", 0.0, 10.0, 0.05, "ALU_SUP_RECOVER",
            "How long frames must be good without a break before the safe command is left.";
        state_age: "s", 0.0, 10.0, 0.05, "ALU_SUP_STATE",
            "Age beyond which a measured state is refused.";
        reference_age: "s", 0.0, 3600.0, 0.5, "ALU_SUP_REF",
            "Age beyond which a reference is no longer followed.";
        air_hold: "s", 0.0, 1000.0, 2.0, "ALU_SUP_AIR",
            "How long the last known wind counts as known without air data. After that it stands in for what is not known: see the supervision.";
        max_wind: "m/s", 0.0, 1e3, 40.0, "ALU_SUP_WIND",
            "Greatest wind that air data may imply; air data that imply more are invalid.";
        max_wind_step: "m/s", 0.0, 1e3, 10.0, "ALU_SUP_GUST",
            "Greatest change of the wind from one step to the next; air data that imply a greater one are invalid.";
        safe_thrust: "mg", -1e3, 1e3, 0.95, "ALU_SUP_THRUST",
            "Thrust of the safe command with the nose up, inside the vehicle's limits: below 1 sinks. Less by as much as the nose leaned when the law flew last; none before. Zero: as near to none as the limits allow.";
    }
}

impl GuidanceParameters {
    /// [`check`](Parameters::check), compiled once: two constructors of generic types call it.
    ///
    /// # Errors
    /// As `check`.
    #[inline(never)]
    pub(super) fn check_all(&self) -> Result<(), ParameterError> {
        self.check()
    }

    /// Part of the horizontal gains that is left in the plane of flight, in proportion to `max_rate`: who leans slowly is late to brake before its
    /// place, and plans would put off the way there again and again. At a quarter of the servo's gain the way to a place does not swing.
    pub(super) fn easing(&self, tuning: &Tuning) -> f32 {
        let least = 0.25 * tuning.forward_gain / self.position_gain_forward;
        math::min(
            math::max(self.max_rate / Self::DEFAULT.max_rate, least),
            1.0,
        )
    }
}

impl Default for GuidanceParameters {
    fn default() -> Self {
        Self::DEFAULT
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 1.2 rad/s in place of 2.8; at 0.8 rad/s the servo's gain is what counts.
    #[test]
    fn who_leans_slowly_goes_to_its_place_slowly() {
        let along = |max_rate: f32, position_gain_forward: f32| {
            let p = GuidanceParameters {
                max_rate,
                position_gain_forward,
                ..GuidanceParameters::DEFAULT
            };
            position_gain_forward * p.easing(&Tuning::DEFAULT)
        };
        assert_eq!((along(2.8, 0.81), along(5.0, 0.81)), (0.81, 0.81));
        assert!((along(1.2, 0.81) - 0.81 * 1.2 / 2.8).abs() < 1e-6);
        assert!((along(0.8, 0.81) - 0.25 * 1.11).abs() < 1e-6);
        // What is slower by itself stays, and so does a hold that is off.
        assert_eq!((along(0.8, 0.2), along(0.8, 0.0)), (0.2, 0.0));
    }
}
