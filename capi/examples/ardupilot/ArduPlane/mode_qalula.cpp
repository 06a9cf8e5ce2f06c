#include "mode_qalula.h"
#include "Plane.h"
#include "vehicle.h"

#if HAL_QUADPLANE_ENABLED

namespace
{
// Time between two steps of the guidance [s]: control_rate_hz of the vehicle's file. The loop of ArduPilot is faster.
constexpr float PERIOD = 0.01f;
// Rate [rad/s] at which a full stick turns the course.
constexpr float TURN = 0.5f;
// Groundspeed [m/s] from which the course at the start is that of the flight, not of the belly.
constexpr float FLIES = 5.0f;

void set(float out[3], float x, float y, float z)
{
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

// What 4.6 and 4.7 name differently: of each pair the one that is there is compiled.
template <class AHRS> auto relative_position(const AHRS &ahrs, Vector3f &p, int) -> decltype(ahrs.get_relative_position_NED_origin_float(p))
{
    return ahrs.get_relative_position_NED_origin_float(p);
}
template <class AHRS> auto relative_position(const AHRS &ahrs, Vector3f &p, long) -> decltype(ahrs.get_relative_position_NED_origin(p))
{
    return ahrs.get_relative_position_NED_origin(p);
}
template <class Control> auto rates_cds(Control &control, const Vector3f &r, int) -> decltype(control.input_rate_bf_roll_pitch_yaw_2_cds(r.x, r.y, r.z))
{
    control.input_rate_bf_roll_pitch_yaw_2_cds(r.x, r.y, r.z);
}
template <class Control> auto rates_cds(Control &control, const Vector3f &r, long) -> decltype(control.input_rate_bf_roll_pitch_yaw_2(r.x, r.y, r.z))
{
    control.input_rate_bf_roll_pitch_yaw_2(r.x, r.y, r.z);
}
} // namespace

// Once: the vehicle of vehicle.h, which `alula-sil new` made.
bool ModeQAlula::make()
{
    _input.header = ALULA_HEADER(alula_input);
    _command.header = ALULA_HEADER(alula_command);
    _search.header = ALULA_HEADER(alula_search);
    _goal.header = ALULA_HEADER(alula_goal);
    alula_input_default(&_input);
    alula_command_default(&_command);
    alula_goal_default(&_goal);
    // The attitude controller's axes are the multicopter's.
    _input.body_axes = ALULA_BODY_NOSE_UP;
    const int32_t code = vehicle_init(&_controller, &_table);
    if (code != ALULA_OK) {
        gcs().send_text(MAV_SEVERITY_ERROR, "alula: %s", alula_strerror(code));
    }
    return code == ALULA_OK;
}

bool ModeQAlula::_enter()
{
    if (!quadplane.tailsitter.enabled()) {
        return false;
    }
    _made = _made || make();
    if (!_made) {
        return false;
    }
    quadplane.init_throttle_wait();
    quadplane.transition->force_transition_complete();
    fill_state();
    // It begins with the thrust and the rates that were commanded last.
    const Vector3f rates = attitude_control->rate_bf_targets();
    const float last[3] = {rates.x, rates.y, rates.z};
    alula_take_over(&_controller, &_input, quadplane.motors->get_throttle(), last);
    attitude_control->relax_attitude_controllers();
    _since = PERIOD;
    // The belly's heading, along x of the multicopter's axes, or where it flies.
    const float *q = _input.quaternion;
    const float *v = _input.velocity;
    const bool flies = v[0] * v[0] + v[1] * v[1] > FLIES * FLIES;
    _course = flies ? atan2f(v[1], v[0]) : atan2f(2 * (q[1] * q[2] + q[0] * q[3]), 1 - 2 * (q[2] * q[2] + q[3] * q[3]));
    return true;
}

void ModeQAlula::update()
{
    const Vector3f target = attitude_control->get_att_target_euler_cd();
    plane.nav_pitch_cd = target.y;
    plane.nav_roll_cd = target.x;
}

void ModeQAlula::run()
{
    if (quadplane.tailsitter.in_vtol_transition(AP_HAL::millis())) {
        // ArduPlane's own transition to hover comes first.
        Mode::run();
        return;
    }
    if (quadplane.throttle_wait) {
        quadplane.set_desired_spool_state(AP_Motors::DesiredSpoolState::GROUND_IDLE);
        attitude_control->set_throttle_out(0, true, 0);
        quadplane.relax_attitude_control();
        return;
    }
    quadplane.set_desired_spool_state(AP_Motors::DesiredSpoolState::THROTTLE_UNLIMITED);

    _since += plane.G_Dt;
    if (_since >= PERIOD) {
        fill_state();
        fill_reference(_since);
        // The command is flown whatever the code is, and as it is.
        alula_guide(&_controller, &_input, _since, &_command, nullptr);
        _since = 0;
        if ((_command.status & ALULA_STATUS_PLAN_DUE) && !_search.more)
            alula_search_begin(&_controller, &_search);
    } else if (_search.more) {
        // A plan, one candidate in each turn of the main loop that has time.
        alula_search_look(&_controller, &_search);
        if (!_search.more)
            alula_search_adopt(&_controller, &_search);
    }
    constexpr float centidegrees = 100.0f * 180.0f / 3.14159265f;
    const Vector3f rates(_command.body_rate[0], _command.body_rate[1], _command.body_rate[2]);
    rates_cds(*attitude_control, rates * centidegrees, 0);
    attitude_control->set_throttle_out(_command.thrust_normalised, false, 10.0f);

    // Surfaces as in QACRO.
    plane.mode_acro.run();
}

void ModeQAlula::fill_state()
{
    // The AHRS' axes are the fixed wing's: turned by 90 degrees about the right wing, q * (cos 45, 0, -sin 45, 0).
    Quaternion q;
    ahrs.get_quat_body_to_ned(q);
    constexpr float h = 0.70710678f;
    _input.quaternion[0] = h * (q.q1 + q.q3);
    _input.quaternion[1] = h * (q.q2 + q.q4);
    _input.quaternion[2] = h * (q.q3 - q.q1);
    _input.quaternion[3] = h * (q.q4 - q.q2);
    const Vector3f accel = AP::ins().get_accel();
    set(_input.specific_force, accel.z, accel.y, -accel.x);
    _input.flags = ALULA_SPECIFIC_FORCE;

    // A velocity that is not healthy is passed on as NaN: alula holds the last command, and then gives the safe one.
    Vector3f v, wind;
    if (ahrs.get_velocity_NED(v)) {
        set(_input.velocity, v.x, v.y, v.z);
    } else {
        set(_input.velocity, NAN, NAN, NAN);
    }
    if (!ahrs.wind_estimate(wind)) {
        _input.flags |= ALULA_AIR_UNKNOWN;
    }
    set(_input.air, wind.x, wind.y, wind.z);
}

// What the sticks ask for.
void ModeQAlula::fill_reference(float dt)
{
    const float turn = plane.channel_roll->norm_input_dz() + plane.channel_rudder->norm_input_dz();
    _course = wrap_PI(_course + turn * TURN * dt);
    // Stick forward is a pitch down.
    const float speed = MAX(-plane.channel_pitch->norm_input_dz(), 0.0f) * float(plane.aparm.airspeed_cruise);
    const float climb = 0.01f * quadplane.get_pilot_desired_climb_rate_cms();
    const bool stops = is_zero(speed) && is_zero(climb);
    _goal.kind = stops ? ALULA_GOAL_STOP : ALULA_GOAL_VELOCITY;
    set(_goal.target, speed * cosf(_course), speed * sinf(_course), -climb);

    Vector3f p;
    const bool placed = relative_position(ahrs, p, 0);
    const float position[3] = {p.x, p.y, p.z};
    alula_goal_step(&_goal, position, dt, &_input);
    if (!placed) {
        _input.flags &= ~uint32_t(ALULA_POSITION);
    }
    _input.heading = _course;
}

#endif // HAL_QUADPLANE_ENABLED
