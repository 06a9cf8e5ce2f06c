#pragma once

#include <alula.h>

#include "ardupilot.h"

// What is to be flown, north-east-down. A heading [rad] that is NaN is left to the course.
struct QAlulaTarget {
    Vector3f position, velocity, acceleration;
    float heading;
};

class ModeQAlula
{
public:
    bool init(const alula_parameters &parameters);
    void run(const AP_AHRS &ahrs, const AP_InertialSensor &ins, AC_AttitudeControl_TS &attitude_control,
             const QAlulaTarget &target, float dt);
    const alula_command &command() const { return _command; }
    int32_t code() const { return _code; }

private:
    static void set(float out[3], float x, float y, float z);

    alula_controller _controller{};
    alula_input _input{};
    alula_command _command{};
    int32_t _code{ALULA_ERROR_NOT_INITIALISED};
};
