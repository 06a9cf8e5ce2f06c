// Calls the module against the stand-in: in hover, and in level cruise on the fixed wing's side of the transition.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "alula_guidance.hpp"

static hrt_abstime now = 1000000;
hrt_abstime hrt_absolute_time() { return now; }

static int failures;

static void expect(bool good, const char *what)
{
    std::printf("%s: %s\n", what, good ? "yes" : "NO");
    failures += !good;
}

int main()
{
    AlulaGuidance in_hover, in_cruise;
    auto fly = [](AlulaGuidance &module, float speed, float half_pitch, float north, float yaw) {
        for (int n = 0; n < 200; n++) {
            now += 10000;
            // Of the multicopter's axes: hover is pitch 0, level cruise pitch -90 degrees. Heading north.
            module._attitude_sub.value = {now, {std::cos(half_pitch), 0, std::sin(half_pitch), 0}};
            module._local_position_sub.value = {now, true, true, true, true, 0, 0, 0, speed, 0, 0};
            // In hover, what the thrust gives 10 kg; in cruise, the weight, which the wing carries.
            const float carried = 19.62f * module._mc_virtual_rates_sp_pub.value.thrust_body[2];
            if (speed == 0.0f)
                module._acceleration_sub.value = {now, {0, 0, carried}};
            else
                module._acceleration_sub.value = {now, {9.81f * std::sin(2.0f * half_pitch), 0, -9.81f * std::cos(2.0f * half_pitch)}};
            module._wind_sub.value = {now, 0, 0};
            module._trajectory_setpoint_sub.value = {now, {north, 0, 0}, {speed, 0, 0}, {NAN, NAN, NAN}, yaw};
            module.run();
        }
    };

    in_hover._vehicle_status_sub.value = {vehicle_status_s::VEHICLE_TYPE_ROTARY_WING, false};
    in_hover._vehicle_control_mode_sub.value = {false};
    fly(in_hover, 0.0f, 0.0f, 0.0f, NAN);
    const auto &hover = in_hover._mc_virtual_rates_sp_pub.value;
    expect(in_hover.last_code() == ALULA_OK, "hover is flown");
    // The vehicle has a thrust to weight ratio of 2.
    expect(std::fabs(hover.thrust_body[2] + 0.5f) < 1e-3f, "half of the thrust, along minus z, holds the weight");
    expect(std::fabs(hover.pitch) + std::fabs(hover.roll) + std::fabs(hover.yaw) < 1e-3f, "without rotation");
    fly(in_hover, 0.0f, 0.0f, 0.0f, 0.3f);
    expect(hover.yaw > 0.3f, "a yaw to the right is turned to");
    fly(in_hover, 0.0f, 0.0f, 5.0f, NAN);
    expect(hover.pitch < -0.1f, "to a position ahead it pitches forward");

    // A frame without an attitude: the attitude set-point that is published is the last one.
    in_hover._vehicle_control_mode_sub.value = {true};
    fly(in_hover, 0.0f, 0.0f, 0.0f, NAN);
    const auto flown = in_hover._mc_virtual_attitude_sp_pub.value;
    in_hover._attitude_sub.value = {now, {NAN, NAN, NAN, NAN}};
    in_hover.run();
    const auto &held = in_hover._mc_virtual_attitude_sp_pub.value;
    expect(in_hover.last_code() == ALULA_ERROR_ATTITUDE, "a frame without attitude is refused");
    expect(std::equal(held.q_d, held.q_d + 4, flown.q_d) && held.thrust_body[2] == flown.thrust_body[2],
           "and the last attitude and thrust are held");

    in_cruise._vehicle_status_sub.value = {vehicle_status_s::VEHICLE_TYPE_FIXED_WING, false};
    in_cruise._vehicle_control_mode_sub.value = {true};
    // 20 m/s at 4 degrees of pitch: about the equilibrium.
    fly(in_cruise, 20.0f, 0.5f * (-86.0f * 3.14159265f / 180.0f), NAN, NAN);
    const auto &cruise = in_cruise._fw_virtual_attitude_sp_pub.value;
    expect(in_cruise.last_code() == ALULA_OK, "cruise is flown");
    expect(cruise.thrust_body[0] > 0.01f && cruise.thrust_body[0] < 0.1f, "a little thrust, along x");
    const float pitch = 2.0f * std::atan2(cruise.q_d[2], cruise.q_d[0]) * 180.0f / 3.14159265f;
    expect(pitch > 2.0f && pitch < 6.0f, "and a few degrees of pitch");
    return failures != 0;
}
