// An ArduPilot-style call site: a QuadPlane tail-sitter mode in which alula flies the vertical plane.
#include "mode_qalula.h"

#include <cmath>

bool ModeQAlula::init(const alula_parameters &parameters, float heading)
{
    _controller.header = ALULA_HEADER(alula_controller);
    _input.header = ALULA_HEADER(alula_ned_input);
    _command.header = ALULA_HEADER(alula_ned_command);
    _report.header = ALULA_HEADER(alula_ned_report);
    alula_ned_input_default(&_input);
    alula_ned_command_default(&_command);
    // The plane keeps the heading at entry, until the pilot or the mission turns it.
    _input.heading = heading;
    // In ArduPilot: if it fails, gcs().send_text(MAV_SEVERITY_ERROR, "%s", alula_strerror(code)).
    return alula_init(&_controller, &parameters, nullptr) == ALULA_OK;
}

void ModeQAlula::run(const AP_AHRS &ahrs, AC_AttitudeControl_TS &attitude_control, const Vector3f &velocity_ned,
                     const Vector3f &acceleration_ned, float dt)
{
    // The AHRS' axes are the fixed wing's, the attitude controller's the multicopter's: the quaternion is turned by 90
    // degrees about the right wing, q * (cos 45, 0, -sin 45, 0), and rates come back in the axes it is given in.
    Quaternion q;
    ahrs.get_quat_body_to_ned(q);
    constexpr float h = 0.70710678f;
    _input.body_axes = ALULA_BODY_NOSE_UP;
    _input.quaternion[0] = h * (q.q1 + q.q3);
    _input.quaternion[1] = h * (q.q2 + q.q4);
    _input.quaternion[2] = h * (q.q3 - q.q1);
    _input.quaternion[3] = h * (q.q4 - q.q2);

    // A velocity that is not healthy is passed on as NaN: alula holds the last command, and then gives the safe one.
    Vector3f v{};
    if (!ahrs.get_velocity_NED(v))
        v = {NAN, NAN, NAN};
    Vector3f wind{};
    _input.flags = ahrs.wind_estimate(wind) ? 0 : ALULA_AIR_UNKNOWN;
    set(_input.velocity, v);
    set(_input.air, wind);
    set(_input.reference_velocity, velocity_ned);
    set(_input.reference_acceleration, acceleration_ned);

    _code = alula_guide(&_controller, &_input, dt, &_command, &_report);

    // The command is flown whatever the code is. alula leaves tilt and bank to the caller: rates that level them are added.
    // Small gains are enough; at 30 degrees of tilt or bank the mode should hand over to another.
    const float level = 2.0f;
    constexpr float centidegrees = 100.0f * 180.0f / 3.14159265f;
    // About the multicopter's z, which is the tail, a positive bank is a negative yaw; its x, the belly, turns the tilt.
    attitude_control.input_rate_bf_roll_pitch_yaw(centidegrees * (_command.body_rate[0] - level * _report.tilt),
                                                  centidegrees * _command.body_rate[1],
                                                  centidegrees * (_command.body_rate[2] + level * _report.bank));
    attitude_control.set_throttle_out(_command.thrust_normalised, false, 0.0f);
}

void ModeQAlula::set(float out[3], const Vector3f &v)
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}
