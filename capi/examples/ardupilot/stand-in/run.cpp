// Flies the mode against the stand-in: a hover that is entered leaning comes upright with the thrust kept, sticks move it, and a lost velocity ends in the
// safe command.
#include "Plane.h"

static AP_InertialSensor sensor;
static AP_Motors motors;
static Transition transition;
static AC_AttitudeControl_Multi control;
static RC_Channel pitch, roll, rudder;
Plane plane;
Mode::Mode() : attitude_control(plane.attitude_control), quadplane(plane.quadplane), ahrs(plane.ahrs) {}
namespace AP
{
AP_InertialSensor &ins() { return sensor; }
}
namespace AP_HAL
{
uint32_t millis() { return 0; }
}
GCS &gcs()
{
    static GCS station;
    return station;
}

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

// The body's rotation by the commanded rates about its multicopter axes, seen in the fixed wing's: (x, y, z) of the multicopter is (z, y, -x) of the fixed
// wing. The accelerometer measures what the thrust gives 3 kg.
static void step(ModeQAlula &mode)
{
    sensor.accel = {15.696f * control.throttle, 0, 0};
    mode.update();
    mode.run();
    const float k = 0.5f * plane.G_Dt * 3.14159265f / 18000.0f;
    Quaternion &q = plane.ahrs.quaternion;
    q = times(q, {1.0f, -k * control.rate_cds.z, k * control.rate_cds.y, k * control.rate_cds.x});
    const float n = 1.0f / std::sqrt(q.q1 * q.q1 + q.q2 * q.q2 + q.q3 * q.q3 + q.q4 * q.q4);
    q = {n * q.q1, n * q.q2, n * q.q3, n * q.q4};
}

int main()
{
    plane.attitude_control = &control;
    plane.quadplane.motors = &motors, plane.quadplane.transition = &transition, plane.quadplane.tailsitter.is = true;
    plane.channel_pitch = &pitch, plane.channel_roll = &roll, plane.channel_rudder = &rudder;
    plane.aparm.airspeed_cruise = 18.0f;
    plane.G_Dt = 0.0025f;
    plane.ahrs.healthy = true;
    motors.throttle = 0.6f;
    // Nose up with the belly at 0.5 rad, then 0.4 rad about the belly and 0.3 rad about the wing.
    Quaternion &q = plane.ahrs.quaternion;
    q = times({std::cos(0.25f), 0, 0, std::sin(0.25f)}, {0.70710678f, 0, 0.70710678f, 0});
    q = times(q, {std::cos(0.2f), 0, 0, std::sin(0.2f)});
    q = times(q, {std::cos(0.15f), 0, std::sin(0.15f), 0});

    ModeQAlula mode;
    expect(mode.enter(), "the mode is entered");
    float least = 1.0f;
    for (int n = 0; n < 4000; n++) {
        step(mode);
        least = std::fmin(least, control.throttle);
    }
    std::printf("least thrust %.2f\n", static_cast<double>(least));
    expect(least > 0.4f, "from the first step on there is thrust");
    expect(2.0f * (q.q1 * q.q3 - q.q2 * q.q4) > 0.999f, "the nose comes up");
    expect(std::fabs(control.throttle - 0.625f) < 1e-2f, "the thrust holds the weight of 3 kg");
    pitch.stick = -0.5f;
    for (int n = 0; n < 200; n++)
        step(mode);
    expect(control.rate_cds.y < -100.0f || 2.0f * (q.q1 * q.q3 - q.q2 * q.q4) < 0.99f, "stick forward pitches forward");
    pitch.stick = 0.0f;
    for (int n = 0; n < 2000; n++)
        step(mode);
    plane.ahrs.healthy = false;
    for (int n = 0; n < 400; n++)
        step(mode);
    expect(control.throttle > 0.55f && control.throttle < 0.62f, "a lost velocity: it sinks");
    plane.quadplane.tailsitter.is = false;
    ModeQAlula other;
    expect(!other.enter(), "of tail-sitters alone");
    return failures != 0;
}
