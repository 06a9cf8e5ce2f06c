/* tail-sitter, as tail-sitter.toml has it: `alula-sil code tail-sitter.toml` makes it anew. Include it in one source file, link alula (docs/integrating.md), call
   vehicle_init once. */
#ifndef VEHICLE_H
#define VEHICLE_H

#include <alula.h>

/* Angle of attack to the zero-lift line [rad], c_L, c_D. */
static const alula_table_row vehicle_rows[] = {
    {0.0f, 0.0f, 0.044586f},
    {0.017453292f, 0.11f, 0.044686f},
    {0.034906585f, 0.22f, 0.045086f},
    {0.05235988f, 0.33f, 0.045686f},
    {0.06981317f, 0.44f, 0.046686f},
    {0.08726646f, 0.55f, 0.048286f},
    {0.10471976f, 0.66f, 0.049486f},
    {0.12217305f, 0.746f, 0.051286f},
    {0.13962634f, 0.8274f, 0.052786f},
    {0.15707964f, 0.8527f, 0.054586f},
    {0.17453292f, 0.1325f, 0.053086f},
    {0.19198622f, 0.1095f, 0.110286f},
    {0.20943952f, 0.1533f, 0.168286f},
    {0.2268928f, 0.203f, 0.186286f},
    {0.2443461f, 0.2546f, 0.205286f},
    {0.2617994f, 0.3082f, 0.224286f},
    {0.27925268f, 0.362f, 0.244286f},
    {0.29670596f, 0.42f, 0.265286f},
    {0.31415927f, 0.4768f, 0.286286f},
    {0.33161256f, 0.5322f, 0.308286f},
    {0.34906584f, 0.587f, 0.331286f},
    {0.36651915f, 0.6414f, 0.354286f},
    {0.38397244f, 0.6956f, 0.378286f},
    {0.40142572f, 0.7497f, 0.403286f},
    {0.41887903f, 0.8034f, 0.428286f},
    {0.43633232f, 0.8572f, 0.454286f},
    {0.4537856f, 0.9109f, 0.480286f},
    {0.4712389f, 0.9646f, 0.507286f},
    {0.5235988f, 0.915f, 0.604286f},
    {0.61086524f, 1.02f, 0.779286f},
    {0.6981317f, 1.075f, 0.954286f},
    {0.7853982f, 1.085f, 1.109286f},
    {0.87266463f, 1.04f, 1.249286f},
    {0.9599311f, 0.965f, 1.379286f},
    {1.0471976f, 0.875f, 1.504286f},
    {1.134464f, 0.765f, 1.609286f},
    {1.2217305f, 0.65f, 1.699286f},
    {1.3089969f, 0.515f, 1.769286f},
    {1.3962634f, 0.37f, 1.814286f},
    {1.4835298f, 0.22f, 1.834286f},
    {1.5707964f, 0.07f, 1.834286f},
    {1.6580628f, -0.07f, 1.814286f},
    {1.7453293f, -0.22f, 1.784286f},
    {1.8325957f, -0.37f, 1.734286f},
    {1.9198622f, -0.51f, 1.669286f},
    {2.0071287f, -0.625f, 1.589286f},
    {2.0943952f, -0.735f, 1.499286f},
    {2.1816616f, -0.84f, 1.384286f},
    {2.268928f, -0.91f, 1.259286f},
    {2.3561945f, -0.945f, 1.119286f},
    {2.443461f, -0.945f, 0.959286f},
    {2.5307274f, -0.91f, 0.789286f},
    {2.6179938f, -0.85f, 0.609286f},
    {2.7052603f, -0.74f, 0.454286f},
    {2.7925267f, -0.66f, 0.354286f},
    {2.8797932f, -0.675f, 0.264286f},
    {2.9670596f, -0.85f, 0.174286f},
    {3.0543263f, -0.69f, 0.089286f},
    {3.1415927f, 0.0f, 0.059286f},
};

/* Makes `controller`; `table` must stay where it is for as long as that is used. Returns ALULA_OK, or a code for alula_strerror. */
static inline int32_t vehicle_init(alula_controller *controller, alula_table *table)
{
    alula_parameters p;
    int32_t code = ALULA_OK;

    p.header = ALULA_HEADER(alula_parameters);
    controller->header = ALULA_HEADER(alula_controller);
    table->header = ALULA_HEADER(alula_table);
    alula_parameters_default(&p);
    p.vehicle.mass = 3.0f;
    p.vehicle.k_a = 0.214375f;
    p.vehicle.thrust_max = 47.088f;
    p.vehicle.authority = 0.0f;
    p.vehicle.authority_slipstream = 150.0f;
    p.vehicle.authority_difference = 250.0f;
    p.vehicle.authority_airflow = 1.1585517f;
    p.vehicle.wing_moment = 0.21323332f;
    p.vehicle.surface_reaction = 0.20408688f;
    p.vehicle.hover_downwash = 8.0f;
    p.vehicle.zero_thrust_speed = 26.31015f;
    p.guidance.natural_frequency = 4.0f;
    p.guidance.damping = 0.8f;
    p.guidance.thrust_rate = 3.0f;
    p.guidance.gain_schedule_floor = 0.57f;
    p.guidance.tau = 0.91f;
    p.guidance.altitude_band = 0.33f;
    p.guidance.velocity_band_down = 1.58f;
    p.guidance.velocity_band_forward = 3.3f;
    p.guidance.rate_lag = 0.06f;
    p.guidance.thrust_lag = 0.08f;
    p.guidance.position_gain_down = 1.43f;
    p.guidance.position_gain_forward = 0.81f;
    p.guidance.max_velocity_down = 4.7f;
    p.guidance.max_sink = 1.2f;
    p.guidance.max_velocity_forward = 3.6f;
    p.guidance.integral_gain_down = 0.3f;
    p.guidance.integral_gain_forward = 0.1f;
    p.guidance.max_integral_down = 2.0f;
    p.guidance.max_integral_forward = 1.0f;
    p.guidance.max_lateral_acceleration = 2.0f;
    p.guidance.max_load_factor = 1000.0f;
    p.guidance.max_rate = 2.8f;
    p.guidance.max_slew = 50.0f;
    p.guidance.hold = 0.1f;
    p.guidance.recovery = 0.05f;
    p.guidance.state_age = 0.05f;
    p.guidance.reference_age = 0.5f;
    p.guidance.air_hold = 2.0f;
    p.guidance.max_wind = 40.0f;
    p.guidance.max_wind_step = 10.0f;
    p.guidance.safe_thrust = 0.95f;
    code = alula_table_init(table, vehicle_rows, sizeof vehicle_rows / sizeof *vehicle_rows, 0);
    p.controller.model = ALULA_MODEL_TABLE;
    return code == ALULA_OK ? alula_init(controller, &p, table) : code;
}

#endif
