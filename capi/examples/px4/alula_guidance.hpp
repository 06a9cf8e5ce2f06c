// A PX4-style module: alula flies a tail-sitter, from hover to cruise, in one law.
#pragma once

#include <alula.h>

#include "px4.hpp"

class AlulaGuidance
{
public:
    AlulaGuidance();

    // Called by the work queue on every new attitude.
    void run();

    // The topics, public for the stand-in's sake.
    uORB::Subscription<vehicle_attitude_s> _attitude_sub;
    uORB::Subscription<vehicle_acceleration_s> _acceleration_sub;
    uORB::Subscription<vehicle_local_position_s> _local_position_sub;
    uORB::Subscription<wind_s> _wind_sub;
    uORB::Subscription<trajectory_setpoint_s> _trajectory_setpoint_sub;
    uORB::Subscription<vehicle_status_s> _vehicle_status_sub;
    uORB::Subscription<vehicle_control_mode_s> _vehicle_control_mode_sub;
    uORB::Publication<vehicle_rates_setpoint_s> _mc_virtual_rates_sp_pub, _fw_virtual_rates_sp_pub;
    uORB::Publication<vehicle_attitude_setpoint_s> _mc_virtual_attitude_sp_pub, _fw_virtual_attitude_sp_pub;

    int32_t last_code() const { return _code; }

private:
    void update_parameters();
    void publish(const alula_command &command, bool fixed_wing, bool attitude);

    alula_controller _controller{};
    alula_input _input{};
    alula_command _command{};
    int32_t _code{ALULA_ERROR_NOT_INITIALISED};
    hrt_abstime _last_run{0};
};
