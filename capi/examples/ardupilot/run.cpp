// Calls the mode against the stand-in: a hover that is tilted and banked a little is held up and levelled, and a lost velocity
// ends in the safe command.
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
    expect(mode.init(parameters, 0.5f), "the mode is entered");

    AP_AHRS ahrs;
    AC_AttitudeControl_TS control;
    // Nose up, heading 0.5 rad, then 0.1 rad of tilt about the belly and 0.2 rad of bank about the nose.
    ahrs.quaternion = {std::cos(0.25f), 0, 0, std::sin(0.25f)};
    ahrs.quaternion = times(ahrs.quaternion, {0.70710678f, 0, 0.70710678f, 0});
    ahrs.quaternion = times(ahrs.quaternion, {std::cos(0.05f), 0, 0, std::sin(0.05f)});
    ahrs.quaternion = times(ahrs.quaternion, {std::cos(0.1f), std::sin(0.1f), 0, 0});
    const float dt = 0.01f;
    mode.run(ahrs, control, {}, {}, dt);
    expect(std::fabs(mode.report().tilt - 0.1f) < 1e-3f && std::fabs(mode.report().bank - 0.2f) < 1e-3f,
           "tilt and bank are told");
    for (int n = 0; n < 500; n++) {
        mode.run(ahrs, control, {}, {}, dt);
        turn(ahrs.quaternion, control.rate_cds, dt);
    }
    expect(mode.code() == ALULA_OK, "hover is flown");
    expect(std::fabs(mode.report().tilt) < 1e-2f && std::fabs(mode.report().bank) < 1e-2f, "tilt and bank are levelled");
    expect(std::fabs(control.throttle - 0.5f) < 1e-2f, "half of the thrust holds the weight");

    ahrs.healthy = false;
    for (int n = 0; n < 20; n++)
        mode.run(ahrs, control, {}, {}, dt);
    expect(mode.code() == ALULA_ERROR_VELOCITY && mode.command().status & ALULA_STATUS_SAFE && control.throttle == 0.0f,
           "a lost velocity ends in the safe command");
    return failures != 0;
}
