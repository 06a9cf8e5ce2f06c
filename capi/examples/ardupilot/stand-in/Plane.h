// The vehicle, of the stand-in.
#pragma once

#include "mode_qalula.h"

struct RC_Channel {
    float stick;
    float norm_input_dz() const { return stick; }
};
struct ModeAcro {
    void run() {}
};
struct AP_FixedWing {
    float airspeed_cruise;
};

struct Plane {
    AC_AttitudeControl_Multi *attitude_control;
    QuadPlane quadplane;
    AP_AHRS ahrs;
    AP_FixedWing aparm;
    RC_Channel *channel_pitch, *channel_roll, *channel_rudder;
    ModeAcro mode_acro;
    float G_Dt;
    int32_t nav_pitch_cd, nav_roll_cd;
};
extern Plane plane;
