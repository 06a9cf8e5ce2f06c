// Calls the mode against the stand-in: a hover that leans and points elsewhere is brought upright and to its heading, and a
// lost velocity ends in the safe command.
#include <cmath>
#include <cstdio>

#include "mode_qalula.h"

static int failures;

static void expect(bool good, const char *what)
{
    std::printf("%s: %s\n", what, good ? "yes" : "NO");
    failures += !good;
}

static Quaternion times(const Quaternion &a, const Quaternion &b)
{
    return {a.q1 * b.q1 - a.q2 * b.q2 - a.q3 * b.q3 - a.q4 * b.q4, a.q1 * b.q2 + a.q2 * b.q1 + a.q3 * b.q4 - a.q4 * b.q3,
            a.q1 * b.q3 - a.q2 * b.q4 + a.q3 * b.q1 + a.q4 * b.q2, a.q1 * b.q4 + a.q2 * b.q3 - a.q3 * b.q2 + a.q4 * b.q1};
}

// Rotation of the body by small rates about its multicopter axes for a step, seen in the fixed wing's: (x, y, z) of the
// multicopter is (z, y, -x) of the fixed wing.
static void turn(Quaternion &q, const Vector3f &rate_cds, float dt)
{
    const float k = 0.5f * dt * 3.14159265f / 18000.0f;
    q = times(q, {1.0f, -k * rate_cds.z, k * rate_cds.y, k * rate_cds.x});
    const float n = 1.0f / std::sqrt(q.q1 * q.q1 + q.q2 * q.q2 + q.q3 * q.q3 + q.q4 * q.q4);
    q = {n * q.q1, n * q.q2, n * q.q3, n * q.q4};
}

int main()
{
    alula_parameters parameters;
    parameters.header = ALULA_HEADER(alula_parameters);
    alula_parameters_default(&parameters);
    parameters.vehicle.mass = 10.0f;
    parameters.vehicle.k_a = 0.646f;
    parameters.vehicle.thrust_max = 196.2f;
    ModeQAlula mode;
    expect(mode.init(parameters), "the mode is entered");

    AP_AHRS ahrs;
    AP_InertialSensor ins;
    AC_AttitudeControl_TS control;
    const QAlulaTarget stay{{}, {}, {}, 0.5f};
    // Nose up, belly to the north, then 0.4 rad about the belly, 0.3 rad about the wing and 1 rad about the nose.
    ahrs.quaternion = {0.70710678f, 0, 0.70710678f, 0};
    ahrs.quaternion = times(ahrs.quaternion, {std::cos(0.2f), 0, 0, std::sin(0.2f)});
    ahrs.quaternion = times(ahrs.quaternion, {std::cos(0.15f), 0, std::sin(0.15f), 0});
    ahrs.quaternion = times(ahrs.quaternion, {std::cos(0.5f), std::sin(0.5f), 0, 0});
    const float dt = 0.01f;
    for (int n = 0; n < 1000; n++) {
        // What the thrust gives 10 kg.
        ins.accel = {19.62f * control.throttle, 0, 0};
        mode.run(ahrs, ins, control, stay, dt);
        turn(ahrs.quaternion, control.rate_cds, dt);
    }
    expect(mode.code() == ALULA_OK, "hover is flown");
    const Quaternion &q = ahrs.quaternion;
    const float nose_up = 2.0f * (q.q1 * q.q3 - q.q2 * q.q4);
    const float belly_north = 2.0f * (q.q2 * q.q4 + q.q1 * q.q3), belly_east = 2.0f * (q.q3 * q.q4 - q.q1 * q.q2);
    expect(nose_up > 0.999f, "the nose is up");
    expect(std::fabs(std::atan2(belly_east, belly_north) - 0.5f) < 1e-2f, "the belly points where it was asked to");
    expect(std::fabs(control.throttle - 0.5f) < 1e-2f, "half of the thrust holds the weight");

    ahrs.healthy = false;
    for (int n = 0; n < 20; n++)
        mode.run(ahrs, ins, control, stay, dt);
    expect(mode.code() == ALULA_ERROR_VELOCITY && mode.command().status & ALULA_STATUS_SAFE && control.throttle > 0.4f && control.throttle < 0.5f,
           "a lost velocity ends in the safe command: it sinks slowly");
    return failures != 0;
}
