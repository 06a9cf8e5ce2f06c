// A stand-in for ArduPilot, not ArduPilot: just enough of AHRS, attitude control and parameters for the call site to
// compile and to be called outside of ArduPilot. Names and units follow ArduPilot's; there, the real headers take this
// file's place.
#pragma once

struct Vector3f {
    float x, y, z;
};

struct Quaternion {
    float q1, q2, q3, q4; // w, x, y, z
};

struct AP_AHRS {
    Quaternion quaternion{1, 0, 0, 0}; // of the fixed wing's axes
    Vector3f velocity{}, position{}, wind{};
    bool healthy{true};

    void get_quat_body_to_ned(Quaternion &q) const { q = quaternion; }
    bool get_velocity_NED(Vector3f &v) const
    {
        v = velocity;
        return healthy;
    }
    bool get_relative_position_NED_origin(Vector3f &p) const
    {
        p = position;
        return healthy;
    }
    bool wind_estimate(Vector3f &w) const
    {
        w = wind;
        return true;
    }
};

struct AP_InertialSensor {
    Vector3f accel{}; // [m/s^2], gravity not included, along the fixed wing's axes

    const Vector3f &get_accel() const { return accel; }
};

// Of a tail-sitter it works in the multicopter's axes, those of ahrs_view.
struct AC_AttitudeControl_TS {
    Vector3f rate_cds{};
    float throttle{};

    void input_rate_bf_roll_pitch_yaw(float roll_cds, float pitch_cds, float yaw_cds)
    {
        rate_cds = {roll_cds, pitch_cds, yaw_cds};
    }
    void set_throttle_out(float value, bool apply_angle_boost, float filter_cutoff)
    {
        (void)apply_angle_boost, (void)filter_cutoff;
        throttle = value;
    }
};
