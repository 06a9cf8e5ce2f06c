#pragma once

#include <alula.h>

#include "ardupilot.h"

class ModeQAlula
{
public:
    bool init(const alula_parameters &parameters, float heading);
    void run(const AP_AHRS &ahrs, AC_AttitudeControl_TS &attitude_control, const Vector3f &velocity_ned,
             const Vector3f &acceleration_ned, float dt);
    const alula_ned_command &command() const { return _command; }
    const alula_ned_report &report() const { return _report; }
    int32_t code() const { return _code; }

private:
    static void set(float out[3], const Vector3f &v);

    alula_controller _controller{};
    alula_ned_input _input{};
    alula_ned_command _command{};
    alula_ned_report _report{};
    int32_t _code{ALULA_ERROR_NOT_INITIALISED};
};
