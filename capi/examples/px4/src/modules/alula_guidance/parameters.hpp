// The parameters of module.yaml, into alula's.
// Made by `cargo run --package alula-capi --example generate`; do not edit.
#pragma once

#include <alula.h>

#include <parameters/param.h>

#include <stddef.h>
#include <stdint.h>

// Sets every parameter of `p`; false, and none set, if ALU_MASS is 0: then the vehicle is not that of the parameters.
inline bool load(alula_parameters &p)
{
	static const struct {
		const char *name;
		size_t offset;
		bool choice;
	} rows[] = {
		{"ALU_GAINS", offsetof(alula_parameters, controller.gains), true},
		{"ALU_MODEL", offsetof(alula_parameters, controller.model), true},
		{"ALU_ATT_P", offsetof(alula_parameters, controller.attitude_gain), false},
		{"ALU_MASS", offsetof(alula_parameters, vehicle.mass), false},
		{"ALU_KA", offsetof(alula_parameters, vehicle.k_a), false},
		{"ALU_DELTA", offsetof(alula_parameters, vehicle.delta), false},
		{"ALU_CY", offsetof(alula_parameters, vehicle.c_y), false},
		{"ALU_GRAVITY", offsetof(alula_parameters, vehicle.gravity), false},
		{"ALU_THR_MIN", offsetof(alula_parameters, vehicle.thrust_min), false},
		{"ALU_THR_MAX", offsetof(alula_parameters, vehicle.thrust_max), false},
		{"ALU_AUTH", offsetof(alula_parameters, vehicle.authority), false},
		{"ALU_AUTH_SLIP", offsetof(alula_parameters, vehicle.authority_slipstream), false},
		{"ALU_AUTH_DIFF", offsetof(alula_parameters, vehicle.authority_difference), false},
		{"ALU_AUTH_AIR", offsetof(alula_parameters, vehicle.authority_airflow), false},
		{"ALU_WING_MOM", offsetof(alula_parameters, vehicle.wing_moment), false},
		{"ALU_AUTH_ROLL", offsetof(alula_parameters, vehicle.roll_authority), false},
		{"ALU_SURF_REACT", offsetof(alula_parameters, vehicle.surface_reaction), false},
		{"ALU_DOWNWASH", offsetof(alula_parameters, vehicle.hover_downwash), false},
		{"ALU_THR_SPEED", offsetof(alula_parameters, vehicle.zero_thrust_speed), false},
		{"ALU_BW_FREQ", offsetof(alula_parameters, guidance.natural_frequency), false},
		{"ALU_BW_DAMP", offsetof(alula_parameters, guidance.damping), false},
		{"ALU_BW_THR", offsetof(alula_parameters, guidance.thrust_rate), false},
		{"ALU_BW_FLOOR", offsetof(alula_parameters, guidance.gain_schedule_floor), false},
		{"ALU_BW_TAU", offsetof(alula_parameters, guidance.tau), false},
		{"ALU_BAND_ALT", offsetof(alula_parameters, guidance.altitude_band), false},
		{"ALU_BAND_V_D", offsetof(alula_parameters, guidance.velocity_band_down), false},
		{"ALU_BAND_V_F", offsetof(alula_parameters, guidance.velocity_band_forward), false},
		{"ALU_RATE_LAG", offsetof(alula_parameters, guidance.rate_lag), false},
		{"ALU_THR_LAG", offsetof(alula_parameters, guidance.thrust_lag), false},
		{"ALU_POS_P_D", offsetof(alula_parameters, guidance.position_gain_down), false},
		{"ALU_POS_P_F", offsetof(alula_parameters, guidance.position_gain_forward), false},
		{"ALU_POS_V_D", offsetof(alula_parameters, guidance.max_velocity_down), false},
		{"ALU_POS_SINK", offsetof(alula_parameters, guidance.max_sink), false},
		{"ALU_POS_V_F", offsetof(alula_parameters, guidance.max_velocity_forward), false},
		{"ALU_INT_D", offsetof(alula_parameters, guidance.integral_gain_down), false},
		{"ALU_INT_F", offsetof(alula_parameters, guidance.integral_gain_forward), false},
		{"ALU_INT_MAX_D", offsetof(alula_parameters, guidance.max_integral_down), false},
		{"ALU_INT_MAX_F", offsetof(alula_parameters, guidance.max_integral_forward), false},
		{"ALU_TURN_MAX", offsetof(alula_parameters, guidance.max_lateral_acceleration), false},
		{"ALU_LOAD_MAX", offsetof(alula_parameters, guidance.max_load_factor), false},
		{"ALU_RATE_MAX", offsetof(alula_parameters, guidance.max_rate), false},
		{"ALU_SLEW_MAX", offsetof(alula_parameters, guidance.max_slew), false},
		{"ALU_SUP_HOLD", offsetof(alula_parameters, guidance.hold), false},
		{"ALU_SUP_RECOVER", offsetof(alula_parameters, guidance.recovery), false},
		{"ALU_SUP_STATE", offsetof(alula_parameters, guidance.state_age), false},
		{"ALU_SUP_REF", offsetof(alula_parameters, guidance.reference_age), false},
		{"ALU_SUP_AIR", offsetof(alula_parameters, guidance.air_hold), false},
		{"ALU_SUP_WIND", offsetof(alula_parameters, guidance.max_wind), false},
		{"ALU_SUP_GUST", offsetof(alula_parameters, guidance.max_wind_step), false},
		{"ALU_SUP_THRUST", offsetof(alula_parameters, guidance.safe_thrust), false},
		{"ALU_K1", offsetof(alula_parameters, gains.k1), false},
		{"ALU_K2", offsetof(alula_parameters, gains.k2), false},
		{"ALU_K3", offsetof(alula_parameters, gains.k3), false},
		{"ALU_TAU", offsetof(alula_parameters, gains.tau), false},
		{"ALU_C0", offsetof(alula_parameters, coefficients.c0), false},
		{"ALU_C1", offsetof(alula_parameters, coefficients.c1), false},
		{"ALU_C2", offsetof(alula_parameters, coefficients.c2), false},
		{"ALU_C3", offsetof(alula_parameters, coefficients.c3), false},
		{"ALU_ALPHA_BAR", offsetof(alula_parameters, coefficients.alpha_bar), false},
		{"ALU_KL", offsetof(alula_parameters, coefficients.k_l), false},
		{"ALU_KD", offsetof(alula_parameters, coefficients.k_d), false},
	};
	float mass = 0.0f;
	param_get(param_find("ALU_MASS"), &mass);

	if (!(mass > 0.0f)) {
		return false;
	}

	for (const auto &row : rows) {
		float &value = *reinterpret_cast<float *>(reinterpret_cast<char *>(&p) + row.offset);

		if (row.choice) {
			int32_t choice = 0;
			param_get(param_find(row.name), &choice);
			value = static_cast<float>(choice);

		} else {
			param_get(param_find(row.name), &value);
		}
	}

	return true;
}
