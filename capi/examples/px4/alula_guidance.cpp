#include "alula_guidance.hpp"

#include <algorithm>
#include <cmath>

namespace
{
constexpr float SQRT_HALF = 0.70710678f;

float age(hrt_abstime now, uint64_t timestamp) { return static_cast<float>(now - timestamp) * 1e-6f; }

// From the multicopter's axes to the fixed wing's: 90 degrees up about the right wing, q * (cos 45, 0, sin 45, 0).
void to_fixed_wing(const float q[4], float out[4])
{
    out[0] = SQRT_HALF * (q[0] - q[2]);
    out[1] = SQRT_HALF * (q[1] - q[3]);
    out[2] = SQRT_HALF * (q[2] + q[0]);
    out[3] = SQRT_HALF * (q[3] + q[1]);
}
} // namespace

AlulaGuidance::AlulaGuidance()
{
    _input.header = ALULA_HEADER(alula_input);
    _command.header = ALULA_HEADER(alula_command);
    alula_input_default(&_input);
    alula_command_default(&_command);
    update_parameters();
}

// The names are those of module.yaml, which is generated from the tables that alula_init checks against.
void AlulaGuidance::update_parameters()
{
    alula_parameters p;
    p.header = ALULA_HEADER(alula_parameters);
    alula_parameters_default(&p);
    param_load("ALU_MASS", &p.vehicle.mass);
    param_load("ALU_KA", &p.vehicle.k_a);
    param_load("ALU_THR_MAX", &p.vehicle.thrust_max);
    param_load("ALU_BW_FREQ", &p.guidance.natural_frequency);
    // ... and so on, one line for each parameter that is to be tuned in the field.
    _controller.header = ALULA_HEADER(alula_controller);
    _code = alula_init(&_controller, &p, nullptr);
    // In PX4: if (_code != ALULA_OK) PX4_ERR("%s", alula_strerror(_code));
}

void AlulaGuidance::run()
{
    const hrt_abstime now = hrt_absolute_time();
    const float dt = std::clamp(age(now, _last_run), 0.0005f, 0.1f);
    _last_run = now;

    vehicle_attitude_s attitude;
    vehicle_acceleration_s acceleration;
    vehicle_local_position_s position;
    wind_s wind;
    trajectory_setpoint_s setpoint;
    vehicle_status_s status;
    vehicle_control_mode_s mode;
    _attitude_sub.copy(&attitude);
    _acceleration_sub.copy(&acceleration);
    _local_position_sub.copy(&position);
    _wind_sub.copy(&wind);
    _trajectory_setpoint_sub.copy(&setpoint);
    _vehicle_status_sub.copy(&status);
    _vehicle_control_mode_sub.copy(&mode);

    // Set-points go out in the axes of whichever controller flies them. The fixed wing's x is the multicopter's -z.
    const bool fixed_wing = status.vehicle_type == vehicle_status_s::VEHICLE_TYPE_FIXED_WING && !status.in_transition_mode;
    if (fixed_wing) {
        _input.body_axes = ALULA_BODY_NOSE_FORWARD;
        to_fixed_wing(attitude.q, _input.quaternion);
        _input.specific_force[0] = -acceleration.xyz[2];
        _input.specific_force[1] = acceleration.xyz[1];
        _input.specific_force[2] = acceleration.xyz[0];
    } else {
        _input.body_axes = ALULA_BODY_NOSE_UP;
        std::copy(attitude.q, attitude.q + 4, _input.quaternion);
        std::copy(acceleration.xyz, acceleration.xyz + 3, _input.specific_force);
    }

    // An invalid velocity is passed on as NaN: alula holds the last command, and then gives the safe one.
    const bool valid = position.v_xy_valid && position.v_z_valid;
    _input.velocity[0] = valid ? position.vx : NAN;
    _input.velocity[1] = valid ? position.vy : NAN;
    _input.velocity[2] = valid ? position.vz : NAN;
    _input.air[0] = wind.windspeed_north;
    _input.air[1] = wind.windspeed_east;
    _input.air[2] = 0.0f;
    _input.flags = age(now, wind.timestamp) < 5.0f ? 0 : ALULA_AIR_UNKNOWN;
    if (age(now, acceleration.timestamp) < 0.1f)
        _input.flags |= ALULA_SPECIFIC_FORCE;

    // Each axis by itself: one with a position is held there, one with a velocity flies at it, and one with neither stops. With
    // nothing at all the velocity stays NaN, and alula keeps the last one. A yaw that is NaN leaves the heading to the course;
    // in cruise the course has it anyway.
    const float at[3] = {position.x, position.y, position.z};
    const auto finite = [](float x) { return std::isfinite(x); };
    const bool held = std::any_of(setpoint.position, setpoint.position + 3, finite);
    const bool asked = held || std::any_of(setpoint.velocity, setpoint.velocity + 3, finite);
    if (held && position.xy_valid && position.z_valid)
        _input.flags |= ALULA_POSITION;
    for (int n = 0; n < 3; n++) {
        _input.position_error[n] = finite(setpoint.position[n]) ? at[n] - setpoint.position[n] : 0.0f;
        _input.reference_velocity[n] = asked && !finite(setpoint.velocity[n]) ? 0.0f : setpoint.velocity[n];
        _input.reference_acceleration[n] = finite(setpoint.acceleration[n]) ? setpoint.acceleration[n] : 0.0f;
    }
    _input.heading = setpoint.yaw;
    _input.state_age = age(now, std::min(attitude.timestamp, position.timestamp));
    _input.reference_age = age(now, setpoint.timestamp);

    // The command is flown whatever the code is: all three rates, or the whole attitude.
    _code = alula_guide(&_controller, &_input, dt, &_command, nullptr);
    publish(_command, fixed_wing, mode.flag_control_attitude_enabled);
}

// | flight mode        | attitude loop flies it              | rate loop flies it              | thrust is      |
// | hover, transition  | mc_virtual_attitude_setpoint        | mc_virtual_rates_setpoint       | thrust_body[2] |
// | fixed wing         | fw_virtual_attitude_setpoint        | fw_virtual_rates_setpoint       | thrust_body[0] |
void AlulaGuidance::publish(const alula_command &command, bool fixed_wing, bool attitude)
{
    float thrust_body[3]{};
    if (fixed_wing)
        thrust_body[0] = command.thrust_normalised;
    else
        thrust_body[2] = -command.thrust_normalised;

    if (attitude) {
        vehicle_attitude_setpoint_s setpoint{};
        setpoint.timestamp = _last_run;
        std::copy(command.quaternion, command.quaternion + 4, setpoint.q_d);
        std::copy(thrust_body, thrust_body + 3, setpoint.thrust_body);
        (fixed_wing ? _fw_virtual_attitude_sp_pub : _mc_virtual_attitude_sp_pub).publish(setpoint);
    } else {
        vehicle_rates_setpoint_s setpoint{};
        setpoint.timestamp = _last_run;
        setpoint.roll = command.body_rate[0];
        setpoint.pitch = command.body_rate[1];
        setpoint.yaw = command.body_rate[2];
        std::copy(thrust_body, thrust_body + 3, setpoint.thrust_body);
        (fixed_wing ? _fw_virtual_rates_sp_pub : _mc_virtual_rates_sp_pub).publish(setpoint);
    }
}
