// A stand-in for PX4, not PX4: just enough of its messages, parameters and uORB for alula_guidance.cpp to compile and to be
// called once outside of PX4. Names and units follow PX4's message definitions; in PX4 the real headers take this
// file's place.
#pragma once

#include <cstdint>
#include <cstring>

using hrt_abstime = uint64_t;
hrt_abstime hrt_absolute_time(); // [us]

struct vehicle_attitude_s {
    uint64_t timestamp;
    float q[4]; // FRD body to NED; of a tail-sitter, the multicopter's axes
};

struct vehicle_acceleration_s {
    uint64_t timestamp;
    float xyz[3]; // [m/s^2] FRD body, gravity not included; of a tail-sitter, the multicopter's axes
};

struct vehicle_local_position_s {
    uint64_t timestamp;
    bool xy_valid, z_valid, v_xy_valid, v_z_valid;
    float x, y, z;    // [m] NED
    float vx, vy, vz; // [m/s] NED
};

struct wind_s {
    uint64_t timestamp;
    float windspeed_north, windspeed_east; // [m/s]
};

struct trajectory_setpoint_s {
    uint64_t timestamp;
    float position[3], velocity[3], acceleration[3]; // NED; NaN is "not controlled"
    float yaw;                                       // [rad]; NaN is "not controlled"
};

struct vehicle_status_s {
    static constexpr uint8_t VEHICLE_TYPE_ROTARY_WING = 1, VEHICLE_TYPE_FIXED_WING = 2;
    uint8_t vehicle_type;
    bool in_transition_mode;
};

struct vehicle_control_mode_s {
    bool flag_control_attitude_enabled;
};

struct vehicle_rates_setpoint_s {
    uint64_t timestamp;
    float roll, pitch, yaw; // [rad/s] FRD body
    float thrust_body[3];   // [-1, 1]
};

struct vehicle_attitude_setpoint_s {
    uint64_t timestamp;
    float q_d[4];
    float thrust_body[3];
};

namespace uORB
{
template <typename T> struct Subscription {
    T value{};
    bool copy(T *out) const
    {
        *out = value;
        return true;
    }
};
template <typename T> struct Publication {
    T value{};
    unsigned count{};
    void publish(const T &message)
    {
        value = message;
        count++;
    }
};
} // namespace uORB

// In PX4: param_get(param_find(name), value). Here the parameters that have no default have those of a vehicle of 10 kg, and
// every other one keeps the default that is in `value` already.
inline void param_load(const char *name, float *value)
{
    const struct {
        const char *name;
        float value;
    } set[] = {{"ALU_MASS", 10.0f}, {"ALU_KA", 0.646f}, {"ALU_THR_MAX", 196.2f}};
    for (const auto &parameter : set)
        if (std::strcmp(parameter.name, name) == 0)
            *value = parameter.value;
}
