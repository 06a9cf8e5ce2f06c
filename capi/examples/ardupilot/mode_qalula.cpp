// An ArduPilot-style call site: a QuadPlane tail-sitter mode in which alula flies the whole attitude, from hover to cruise.
#include "mode_qalula.h"

#include <cmath>

bool ModeQAlula::init(const alula_parameters &parameters)
{
    _controller.header = ALULA_HEADER(alula_controller);
    _input.header = ALULA_HEADER(alula_input);
    _command.header = ALULA_HEADER(alula_command);
    alula_input_default(&_input);
    alula_command_default(&_command);
    // In ArduPilot: if it fails, gcs().send_text(MAV_SEVERITY_ERROR, "%s", alula_strerror(code)).
    return alula_init(&_controller, &parameters, nullptr) == ALULA_OK;
}

void ModeQAlula::run(const AP_AHRS &ahrs, const AP_InertialSensor &ins, AC_AttitudeControl_TS &attitude_control,
                     const QAlulaTarget &target, float dt)
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
    const Vector3f &accel = ins.get_accel();
    set(_input.specific_force, accel.z, accel.y, -accel.x);

    // A velocity that is not healthy is passed on as NaN: alula holds the last command, and then gives the safe one.
    Vector3f v{}, p{}, wind{};
    if (!ahrs.get_velocity_NED(v))
        v = {NAN, NAN, NAN};
    _input.flags = ALULA_SPECIFIC_FORCE;
    if (ahrs.get_relative_position_NED_origin(p))
        _input.flags |= ALULA_POSITION;
    if (!ahrs.wind_estimate(wind))
        _input.flags |= ALULA_AIR_UNKNOWN;
    set(_input.velocity, v.x, v.y, v.z);
    set(_input.air, wind.x, wind.y, wind.z);
    set(_input.position_error, p.x - target.position.x, p.y - target.position.y, p.z - target.position.z);
    set(_input.reference_velocity, target.velocity.x, target.velocity.y, target.velocity.z);
    set(_input.reference_acceleration, target.acceleration.x, target.acceleration.y, target.acceleration.z);
    _input.heading = target.heading;

    _code = alula_guide(&_controller, &_input, dt, &_command, nullptr);

    // The command is flown whatever the code is, and as it is.
    constexpr float centidegrees = 100.0f * 180.0f / 3.14159265f;
    const float *rate = _command.body_rate;
    attitude_control.input_rate_bf_roll_pitch_yaw(centidegrees * rate[0], centidegrees * rate[1], centidegrees * rate[2]);
    attitude_control.set_throttle_out(_command.thrust_normalised, false, 0.0f);
}

void ModeQAlula::set(float out[3], float x, float y, float z)
{
    out[0] = x;
    out[1] = y;
    out[2] = z;
}
