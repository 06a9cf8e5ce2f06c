#pragma once

#include "mode.h"

#include <alula.h>

// A QuadPlane mode of tail-sitters in which alula flies the whole attitude, from hover to cruise. Pitch is speed, up to AIRSPEED_CRUISE; roll and
// yaw turn the course; the throttle climbs and sinks. With the sticks centred it brakes and hovers.
class ModeQAlula : public Mode
{
public:

    Number mode_number() const override { return Number::QALULA; }
    const char *name() const override { return "QALULA"; }
    const char *name4() const override { return "QALU"; }

    bool is_vtol_mode() const override { return true; }
    bool is_vtol_man_mode() const override { return true; }

    void update() override;
    void run() override;

protected:

    bool _enter() override;

private:

    bool make();
    void fill_state();
    void fill_reference(float dt);

    alula_controller _controller {};
    alula_table _table {};
    alula_input _input {};
    alula_command _command {};
    alula_search _search {};
    alula_goal _goal {};
    bool _made {false};
    float _since {0};  // time since the last step [s]
    float _course {0}; // where it is to fly [rad]
};
