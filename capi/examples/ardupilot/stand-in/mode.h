// A stand-in for ArduPilot, not ArduPilot: what of ArduPlane and its libraries the mode calls, with ArduPilot's names and signatures, so that it compiles and
// is run outside. STAND_IN_4_6 gives it the names of 4.6, else it has those of 4.7. check-tree holds them against a real tree.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>

#define HAL_QUADPLANE_ENABLED 1
#define MAX(a, b) ((a) > (b) ? (a) : (b))

inline bool is_zero(float x) { return std::fabs(x) < 1e-7f; }
inline float wrap_PI(float x) { return std::remainder(x, 6.28318531f); }

struct Vector3f {
    float x, y, z;
    Vector3f(float x0 = 0, float y0 = 0, float z0 = 0) : x(x0), y(y0), z(z0) {}
    Vector3f operator*(float k) const { return {k * x, k * y, k * z}; }
};

struct Quaternion {
    float q1, q2, q3, q4; // w, x, y, z
};

struct AP_AHRS {
    Quaternion quaternion; // of the fixed wing's axes
    Vector3f velocity, position, wind;
    bool healthy;

    void get_quat_body_to_ned(Quaternion &q) const { q = quaternion; }
    bool get_velocity_NED(Vector3f &v) const
    {
        v = velocity;
        return healthy;
    }
#ifdef STAND_IN_4_6
    bool get_relative_position_NED_origin(Vector3f &p) const
#else
    bool get_relative_position_NED_origin_float(Vector3f &p) const
#endif
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
    Vector3f accel; // [m/s^2], gravity not included, along the fixed wing's axes
    const Vector3f &get_accel() const { return accel; }
};
namespace AP
{
AP_InertialSensor &ins();
}
namespace AP_HAL
{
uint32_t millis();
}

enum MAV_SEVERITY { MAV_SEVERITY_ERROR };
struct GCS {
    void send_text(MAV_SEVERITY, const char *format, const char *text) { std::printf(format, text); }
};
GCS &gcs();

struct AP_Motors {
    enum class DesiredSpoolState { GROUND_IDLE, THROTTLE_UNLIMITED };
    float throttle;
    float get_throttle() const { return throttle; }
};

// Of a tail-sitter it works in the multicopter's axes, those of ahrs_view.
struct AC_AttitudeControl_Multi {
    Vector3f rate_cds;
    float throttle;

#ifdef STAND_IN_4_6
    void input_rate_bf_roll_pitch_yaw_2(float roll, float pitch, float yaw) { rate_cds = {roll, pitch, yaw}; }
#else
    void input_rate_bf_roll_pitch_yaw_2_cds(float roll, float pitch, float yaw) { rate_cds = {roll, pitch, yaw}; }
#endif
    void set_throttle_out(float value, bool, float) { throttle = value; }
    Vector3f rate_bf_targets() const { return rate_cds * (3.14159265f / 18000.0f); }
    Vector3f get_att_target_euler_cd() const { return {}; }
    void relax_attitude_controllers() {}
};

struct Tailsitter {
    bool is;
    bool enabled() const { return is; }
    bool in_vtol_transition(uint32_t) const { return false; }
};
struct Transition {
    void force_transition_complete() {}
};
struct QuadPlane {
    Tailsitter tailsitter;
    Transition *transition;
    AP_Motors *motors;
    bool throttle_wait;
    float climb_cms;

    void init_throttle_wait() {}
    void relax_attitude_control() {}
    void set_desired_spool_state(AP_Motors::DesiredSpoolState) {}
    float get_pilot_desired_climb_rate_cms() const { return climb_cms; }
};

class Mode
{
public:
    enum Number : uint8_t { QACRO = 23, QALULA = 31 };
    Mode();
    virtual ~Mode() = default;
    bool enter() { return _enter(); }
    virtual void run() {}
    virtual Number mode_number() const = 0;
    virtual const char *name() const = 0;
    virtual const char *name4() const = 0;
    virtual bool is_vtol_mode() const { return false; }
    virtual bool is_vtol_man_mode() const { return false; }
    virtual void update() = 0;

protected:
    virtual bool _enter() { return true; }
    AC_AttitudeControl_Multi *&attitude_control;
    QuadPlane &quadplane;
    AP_AHRS &ahrs;
};
