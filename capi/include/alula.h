/*
 * alula: flight control from hover to cruise, in three dimensions.
 *
 * Every structure begins with a header word, which the caller sets to ALULA_HEADER(its type) before it is used for the
 * first time. No function allocates, has a global, takes a lock or calls back; on different controllers all may run at
 * once, in threads and in interrupts. All numbers are IEEE 754 single precision. See docs/integrating.md.
 *
 * Made by `cargo run --package alula-capi --example generate`; do not edit.
 */

#ifndef ALULA_H
#define ALULA_H

#include <stdint.h>
/* The header word of a structure: version of the ABI and size. */
#define ALULA_HEADER(type) (((uint32_t)ALULA_ABI_VERSION << 16) | (uint32_t)sizeof(type))

/**
 * Version of this ABI. It changes whenever a structure or the meaning of a field does.
 */
#define ALULA_ABI_VERSION 4

/**
 * Done.
 */
#define ALULA_OK 0

/**
 * A pointer is null.
 */
#define ALULA_ERROR_NULL -1

/**
 * A pointer is not aligned as its type asks.
 */
#define ALULA_ERROR_UNALIGNED -2

/**
 * A header word is not that of this version's structure: caller and library disagree on version or size, or the caller
 * has not set it.
 */
#define ALULA_ERROR_LAYOUT -3

/**
 * The controller has not been initialised, or its last initialisation failed.
 */
#define ALULA_ERROR_NOT_INITIALISED -4

/**
 * The time step is not finite, shorter than 0.1 ms, or longer than 0.2 s.
 */
#define ALULA_ERROR_TIME_STEP -5

/**
 * A selector (body axes, flags, a response) has no such value, or the flags contradict each other.
 */
#define ALULA_ERROR_SELECTOR -6

/**
 * The control rate is not from 5 Hz to 10 kHz.
 */
#define ALULA_ERROR_CONTROL_RATE -7

/**
 * The speed of cruise is not from 1 m/s to 340 m/s.
 */
#define ALULA_ERROR_CRUISE_SPEED -8

/**
 * A goal is none. Its kind has no such value; a number of it or the position is not finite or beyond 1e8 m; or its
 * speed, climb or acceleration is not from 0.01 to 1000.
 */
#define ALULA_ERROR_GOAL -9

/**
 * The velocity is not finite, or faster than 1000 m/s.
 */
#define ALULA_ERROR_VELOCITY -10

/**
 * The wind is not finite, faster than 1000 m/s, or unknown to a law that needs it.
 */
#define ALULA_ERROR_WIND -11

/**
 * The attitude is invalid: the quaternion is not of unit length, or not finite.
 */
#define ALULA_ERROR_ATTITUDE -12

/**
 * The reference velocity is not finite, or faster than 1000 m/s.
 */
#define ALULA_ERROR_REFERENCE_VELOCITY -13

/**
 * The reference acceleration is not finite, or above 1000 m/s².
 */
#define ALULA_ERROR_REFERENCE_ACCELERATION -14

/**
 * The air acceleration of the feed-forward is not finite, or above 1000 m/s².
 */
#define ALULA_ERROR_AIR_ACCELERATION -15

/**
 * The reference jerk of the feed-forward is not finite, or above 1000 m/s³.
 */
#define ALULA_ERROR_JERK -16

/**
 * The law has no finite answer here.
 */
#define ALULA_ERROR_UNDEFINED -17

/**
 * The state is older than `state_age`, or of negative age.
 */
#define ALULA_ERROR_STATE_AGE -19

/**
 * No good reference has come yet.
 */
#define ALULA_ERROR_NO_REFERENCE -20

/**
 * Every orientation is an equilibrium: there is no force to be turned.
 */
#define ALULA_ERROR_EVERY_ORIENTATION -21

/**
 * There are more equilibria than the set has room for.
 */
#define ALULA_ERROR_TOO_MANY_EQUILIBRIA -22

/**
 * The state lies beyond every fold, or too far from the nearest for the map.
 */
#define ALULA_ERROR_NO_FOLD -23

/**
 * It was refused for a reason that this header has no code for.
 */
#define ALULA_ERROR_OTHER -24

/**
 * Table: a number is not finite.
 */
#define ALULA_ERROR_TABLE_NOT_FINITE -30

/**
 * Table: a coefficient is above 1000 in magnitude.
 */
#define ALULA_ERROR_TABLE_OUT_OF_RANGE -31

/**
 * Table: a drag coefficient is not positive.
 */
#define ALULA_ERROR_TABLE_DRAG -32

/**
 * Table: an angle does not exceed that of the row before by at least 0.05°.
 */
#define ALULA_ERROR_TABLE_NOT_INCREASING -33

/**
 * Table: the first row is neither at 0, for a symmetric section, nor at −180°.
 */
#define ALULA_ERROR_TABLE_START -34

/**
 * Table: the last row is not at 180°.
 */
#define ALULA_ERROR_TABLE_END -35

/**
 * Table: a symmetric section has lift at 0 or 180°.
 */
#define ALULA_ERROR_TABLE_LIFT_ON_AXIS -36

/**
 * Table: the rows at −180° and 180° differ.
 */
#define ALULA_ERROR_TABLE_NOT_PERIODIC -37

/**
 * Table: there are fewer than five rows.
 */
#define ALULA_ERROR_TABLE_TOO_FEW -38

/**
 * Table: there are more than `ALULA_TABLE_ROWS` rows.
 */
#define ALULA_ERROR_TABLE_TOO_MANY -39

/**
 * Item: its kind has no such value.
 */
#define ALULA_ERROR_ITEM_KIND -50

/**
 * Item: its place is not finite, or farther than 100 km from where positions are counted from.
 */
#define ALULA_ERROR_ITEM_PLACE -51

/**
 * Item: its radius is not finite, or above 100 km.
 */
#define ALULA_ERROR_ITEM_RADIUS -52

/**
 * Item: its value is not finite, negative, or beyond what the vehicle does.
 */
#define ALULA_ERROR_ITEM_VALUE -53

/**
 * Item: its turn is narrower than the vehicle can fly at its speed.
 */
#define ALULA_ERROR_ITEM_NARROW -54

/**
 * Item: its speed is less than the wing carries.
 */
#define ALULA_ERROR_ITEM_SLOW -55

/**
 * Item: a take-off is the first item, or stands after a landing.
 */
#define ALULA_ERROR_ITEM_NOT_FIRST -56

/**
 * Item: after a landing only a take-off.
 */
#define ALULA_ERROR_ITEM_AFTER_LANDING -57

/**
 * Item: there are more than `ALULA_MISSION_ITEMS`.
 */
#define ALULA_ERROR_ITEM_TOO_MANY -58

/**
 * Codes from here down name a parameter: `ALULA_ERROR_PARAMETER - 4 * index - problem`. The index is the parameter's
 * place in `alula_parameters`, from 0, and behind those in `alula_mission_parameters`. The problem is 0 for a number
 * that is not finite, 1 for one that is not positive, 2 for one out of range. It is 3 for one that contradicts another
 * parameter.
 */
#define ALULA_ERROR_PARAMETER -100

/**
 * The command is the safe one.
 */
#define ALULA_STATUS_SAFE (1 << 16)

/**
 * The command is the last one flown, held while inputs are bad.
 */
#define ALULA_STATUS_HOLDING (1 << 17)

/**
 * The attitude set-point's lead over the attitude is limited to 90°.
 */
#define ALULA_STATUS_LEAD_LIMITED (1 << 18)

/**
 * A plan is due: call `alula_plan`.
 */
#define ALULA_STATUS_PLAN_DUE (1 << 19)

/**
 * Gains that follow |F_p|, so that the loop keeps its bandwidth: the parameters of the guidance.
 */
#define ALULA_GAINS_BANDWIDTH 0

/**
 * Constant gains, as in the paper. They oscillate on a vehicle whose rate loop or thrust lags.
 */
#define ALULA_GAINS_CONSTANT 1

/**
 * Coefficients by the table that `alula_init` is given.
 */
#define ALULA_MODEL_TABLE 3

/**
 * Most rows of a table.
 */
#define ALULA_TABLE_ROWS 96

/**
 * Body axes of a fixed wing: x along the nose, z to the belly. Hover is pitch 90°.
 */
#define ALULA_BODY_NOSE_FORWARD 0

/**
 * Body axes of a multicopter: z along the tail, x to the belly. Hover is pitch 0, cruise is pitch −90°.
 */
#define ALULA_BODY_NOSE_UP 1

/**
 * Flag of an input, for `alula_step`: `air_acceleration` and `reference_jerk` are to be used.
 */
#define ALULA_FEED_FORWARD 1

/**
 * Flag of an input, for `alula_guide`: `position_error` is to be used.
 */
#define ALULA_POSITION (1 << 1)

/**
 * Flag of an input: `air` is the velocity relative to the air, and not the wind.
 */
#define ALULA_AIR_VELOCITY (1 << 2)

/**
 * Flag of an input: nothing is known of the air, and `air` is not read. `alula_step` needs to know.
 */
#define ALULA_AIR_UNKNOWN (1 << 3)

/**
 * Flag of an input, for `alula_guide`: `specific_force` is to be used.
 */
#define ALULA_SPECIFIC_FORCE (1 << 4)

/**
 * Flag of an input, for `alula_guide`: the nose stays short of the vertical while the vehicle flies forward.
 */
#define ALULA_NOSE_BELOW_VERTICAL (1 << 5)

/**
 * Flag of an input, for `alula_guide`: the place does not matter, as in a stop; `position_error` to the north and east is that
 * of a reference that goes along with the vehicle.
 */
#define ALULA_HOLD_ALTITUDE_ONLY (1 << 6)

/**
 * Flag of an input: `air` is the wind, and `airspeed` is to be used; `alula_step` uses the wind alone.
 */
#define ALULA_AIR_PITOT (1 << 7)

/**
 * The guidance gives the safe command.
 */
#define ALULA_MODE_SAFE 0

/**
 * The guidance repeats the last command.
 */
#define ALULA_MODE_HOLDING 1

/**
 * The law is flown.
 */
#define ALULA_MODE_FLYING 2

/**
 * Flown without air data: with the last wind known, or calm; without a specific force slowly, and by plain thrust vectoring.
 */
#define ALULA_AIR_USE_NONE 0

/**
 * Flown with the measured air velocity.
 */
#define ALULA_AIR_USE_VELOCITY 1

/**
 * Flown with the wind given.
 */
#define ALULA_AIR_USE_WIND 2

/**
 * Flown with the last wind known.
 */
#define ALULA_AIR_USE_HELD_WIND 3

/**
 * Of the air: the airspeed along the nose, beside the wind given.
 */
#define ALULA_AIR_USE_PITOT 4

/**
 * The reference is followed.
 */
#define ALULA_PHASE_TRACKING 0

/**
 * A turn to an attitude far away, as across a fold.
 */
#define ALULA_PHASE_CROSSING 1

/**
 * On the way to the reference with the thrust at a limit.
 */
#define ALULA_PHASE_COASTING 2

/**
 * On the way back from far off the reference.
 */
#define ALULA_PHASE_RECOVERING 3

/**
 * As far as the prediction shows, the reference can be had.
 */
#define ALULA_UNREACHABLE_NOTHING 0

/**
 * The reference sinks more steeply than the vehicle can at that speed.
 */
#define ALULA_UNREACHABLE_SINK 1

/**
 * The reference is slower than the vehicle can fly at that sink rate.
 */
#define ALULA_UNREACHABLE_SPEED 2

/**
 * The reference asks for more thrust than there is.
 */
#define ALULA_UNREACHABLE_THRUST 3

/**
 * Goal: to hover at the position `target` [m].
 */
#define ALULA_GOAL_HOVER 1

/**
 * Goal: to stop as soon as possible at the altitude where this was asked for, or in the climb that is allowed, and to hover where that ends. `target` is not
 * read.
 */
#define ALULA_GOAL_STOP 2

/**
 * Goal: to fly at the velocity `target` [m/s] over ground.
 */
#define ALULA_GOAL_VELOCITY 3

/**
 * Most items of a mission.
 */
#define ALULA_MISSION_ITEMS 128

/**
 * Item: straight up from where it stands, to the height `value` [m] over that. The first item, or the one after a landing.
 */
#define ALULA_ITEM_TAKE_OFF 1

/**
 * Item: past `place` by it: an arc rounds the corner.
 */
#define ALULA_ITEM_BY 2

/**
 * Item: over `place`, on the course of the longer of its two legs.
 */
#define ALULA_ITEM_OVER 3

/**
 * Item: to a stop at `place`, for the time `value` [s].
 */
#define ALULA_ITEM_HOVER 4

/**
 * Item: round `place` with `radius`, for ever.
 */
#define ALULA_ITEM_LOITER 5

/**
 * Item: round `place` with `radius`, `value` turns.
 */
#define ALULA_ITEM_LOITER_TURNS 6

/**
 * Item: round `place` with `radius`, for the time `value` [s].
 */
#define ALULA_ITEM_LOITER_TIME 7

/**
 * Item: the airspeed `value` [m/s] from here on. Below the least of the wing it is a speed over ground, in hover.
 */
#define ALULA_ITEM_SPEED 8

/**
 * Item: to the position down of `place`, where the vehicle is.
 */
#define ALULA_ITEM_ALTITUDE 9

/**
 * Item: a landing where the vehicle is.
 */
#define ALULA_ITEM_LAND 10

/**
 * Item: a landing at `place`, whose position down is the ground's.
 */
#define ALULA_ITEM_LAND_AT 11

/**
 * Item: back to where it took off, and a landing there.
 */
#define ALULA_ITEM_RETURN 12

/**
 * Response: the mission goes on.
 */
#define ALULA_RESPONSE_CONTINUE 0

/**
 * Response: a circle on the wing, a stop in hover, for as long as it lasts.
 */
#define ALULA_RESPONSE_LOITER 1

/**
 * Response: back to where it took off, and a landing there. It is kept to.
 */
#define ALULA_RESPONSE_RETURN 2

/**
 * Response: a landing where the vehicle is. It is kept to.
 */
#define ALULA_RESPONSE_LAND 3

/**
 * Flag of a mission: the link to whoever flies is lost.
 */
#define ALULA_TROUBLE_LINK 1

/**
 * Flag of a mission: nothing is known of the air.
 */
#define ALULA_TROUBLE_AIR (1 << 1)

/**
 * Flag of a mission: nothing is known of the position, and `position` is not read.
 */
#define ALULA_TROUBLE_POSITION (1 << 2)

/**
 * Flag of a mission: the battery is low.
 */
#define ALULA_TROUBLE_BATTERY (1 << 3)

/**
 * In `troubles`: the vehicle has been far from the path for 5 s.
 */
#define ALULA_TROUBLE_FOLLOW (1 << 4)

/**
 * Flag of a mission: stop. On the ground no take-off, in a landing a go-around, else a loiter, until it is taken back.
 */
#define ALULA_TROUBLE_ABORT (1 << 5)

/**
 * Flag of a mission: the vehicle may take off.
 */
#define ALULA_ARMED (1 << 8)

/**
 * Activity: on the ground, without thrust.
 */
#define ALULA_ACTIVITY_GROUNDED 0

/**
 * Activity: the thrust grows until it lifts off.
 */
#define ALULA_ACTIVITY_SPOOLING 1

/**
 * Activity: straight up.
 */
#define ALULA_ACTIVITY_RISING 2

/**
 * Activity: a path at an airspeed.
 */
#define ALULA_ACTIVITY_FLYING 3

/**
 * Activity: to a place and there, by its position.
 */
#define ALULA_ACTIVITY_HOVERING 4

/**
 * Activity: straight down, until it touches the ground.
 */
#define ALULA_ACTIVITY_DESCENDING 5

/**
 * Activity: it has touched the ground: the thrust goes off.
 */
#define ALULA_ACTIVITY_TOUCHED 6

/**
 * Remark: none.
 */
#define ALULA_REMARK_NONE 0

/**
 * Remark: the wind is stronger than the airspeed: the nose is held into it, and it drifts.
 */
#define ALULA_REMARK_DRIFTING 1

/**
 * Remark: the way is steeper than the wing climbs or glides: what is left is flown in a spiral at its end.
 */
#define ALULA_REMARK_STEEP 2

/**
 * Remark: the turn does not fit between the neighbours: the waypoint is passed over.
 */
#define ALULA_REMARK_TIGHT_CORNER 3

/**
 * Remark: it has not lifted off with the most thrust of a take-off, or does not stand on its tail.
 */
#define ALULA_REMARK_NO_LIFT_OFF 4

/**
 * Remark: the vehicle does not follow.
 */
#define ALULA_REMARK_NOT_FOLLOWING 5

/**
 * Remark: it is not armed.
 */
#define ALULA_REMARK_NOT_ARMED 6

/**
 * Remark: the landing waits until the vehicle is over its place.
 */
#define ALULA_REMARK_NOT_OVER_PLACE 7

/**
 * Remark: there is more wind than the vehicle hovers, lands or takes off in: it waits, or circles on the wing.
 */
#define ALULA_REMARK_TOO_WINDY 8

/**
 * Most equilibria of a set.
 */
#define ALULA_EQUILIBRIA 24

/**
 * Thrust stands at its lower limit.
 */
#define ALULA_STATUS_THRUST_LOW 1

/**
 * Thrust stands at its upper limit.
 */
#define ALULA_STATUS_THRUST_HIGH 2

/**
 * A body rate stands at its limit.
 */
#define ALULA_STATUS_RATE 4

/**
 * A body rate changes as fast as it may.
 */
#define ALULA_STATUS_SLEW 8

/**
 * The velocity towards the reference position stands at its limit.
 */
#define ALULA_STATUS_POSITION 16

/**
 * The integral stands at its limit.
 */
#define ALULA_STATUS_INTEGRAL 32

/**
 * The reference is stale or invalid: the last velocity is held.
 */
#define ALULA_STATUS_REFERENCE_HELD 64

/**
 * The position error was invalid and is left out.
 */
#define ALULA_STATUS_POSITION_INVALID 128

/**
 * The air data were invalid and are left out.
 */
#define ALULA_STATUS_AIR_INVALID 256

/**
 * The guidance state was corrupt: it has been reset or, by `Hardened`, restored from its copy.
 */
#define ALULA_STATUS_STATE_RESET 512

/**
 * The specific force was invalid and is left out.
 */
#define ALULA_STATUS_FORCE_INVALID 1024

/**
 * Coefficients by the large-angle model: c0, c1.
 */
#define ALULA_MODEL_LARGE_ANGLE 1

/**
 * Coefficients by the small-angle model: c0, c2, c3.
 */
#define ALULA_MODEL_SMALL_ANGLE 2

/**
 * Coefficients by the combined model: c0, c1, c2, c3, alpha_bar, k_l, k_d.
 */
#define ALULA_MODEL_COMBINED 0

/**
 * Kind of gains, model, attitude loop.
 */
typedef struct alula_controller_parameters {
    /**
     * How the gains are chosen.
     * 0 = by bandwidth (ALULA_GAINS_BANDWIDTH), 1 = constant (ALULA_GAINS_CONSTANT); default 0.0.
     */
    float gains;
    /**
     * Model of the aerodynamic coefficients.
     * 0 = combined (ALULA_MODEL_COMBINED), 1 = large-angle (ALULA_MODEL_LARGE_ANGLE), 2 =
     * small-angle (ALULA_MODEL_SMALL_ANGLE), 3 = table (ALULA_MODEL_TABLE); default 0.0.
     */
    float model;
    /**
     * Gain from attitude error to angular rate of the attitude loop that flies the attitude
     * set-point. It is placed where that loop asks for the commanded rate.
     * Unit: 1/s. From 0.01 to 1000.0, default 6.5.
     */
    float attitude_gain;
} alula_controller_parameters;

/**
 * The vehicle. Mass, k_a and thrust_max have no default and must be set.
 */
typedef struct alula_vehicle_parameters {
    /**
     * Mass m.
     * Unit: kg. From 0.001 to 1.0e6, no default.
     */
    float mass;
    /**
     * Aerodynamic constant k_a: half the air density times the reference area.
     * Unit: kg/m. From 1.0e-9 to 10000.0, no default.
     */
    float k_a;
    /**
     * Angle δ from the zero-lift line to the thrust line.
     * Unit: rad. From -3.1415927 to 3.1415927, default 0.0.
     */
    float delta;
    /**
     * Side force coefficient c_Y, of the same reference area. In a vertical plane it is not used.
     * No unit. From 0.0 to 1000.0, default 0.0.
     */
    float c_y;
    /**
     * Gravity g.
     * Unit: m/s^2. From 0.001 to 1000.0, default 9.81.
     */
    float gravity;
    /**
     * Least thrust. The guidance keeps to it; the laws alone do not.
     * Unit: N. From -1.0e6 to 1.0e6, default 0.0.
     */
    float thrust_min;
    /**
     * Greatest thrust, above the least. The guidance keeps to it; the laws alone do not.
     * Unit: N. From 0.001 to 1.0e6, no default.
     */
    float thrust_max;
    /**
     * Greatest angular acceleration in pitch at no thrust and no airflow. The default is full
     * authority.
     * Unit: rad/s^2. From 0.0 to 1.0e6, default 1.0e6.
     */
    float authority;
    /**
     * What a thrust of the weight adds to it: surfaces in the slipstream, at full deflection, in
     * hover. Flights count on 0.7 of it.
     * Unit: rad/s^2. From 0.0 to 1.0e6, default 0.0.
     */
    float authority_slipstream;
    /**
     * What differences of thrust would add to it that are as large as the weight. They are at
     * most the thrust, and what is left of the greatest thrust. Flights count on 0.8 of it.
     * Unit: rad/s^2. From 0.0 to 1.0e6, default 0.0.
     */
    float authority_difference;
    /**
     * What the airflow along the nose adds to it, per squared speed: surfaces at full deflection
     * without thrust. Flights count on 0.8 of it.
     * Unit: rad/m^2. From 0.0 to 1.0e6, default 0.0.
     */
    float authority_airflow;
    /**
     * Angular acceleration by which the wing across the flow turns the nose to the air velocity,
     * per squared airspeed: its centre of pressure moves aft behind stall.
     * Unit: rad/m^2. From 0.0 to 1.0e6, default 0.0.
     */
    float wing_moment;
    /**
     * Greatest rate about the nose times the airspeed, in cruise: what turns the vehicle about
     * its nose, against the damping of its wing. The default is full authority. Flights count on
     * 0.4 of it.
     * Unit: rad m/s^2. From 0.001 to 1.0e6, default 1.0e6.
     */
    float roll_authority;
    /**
     * Acceleration towards the belly by the surfaces that turn the nose up, per angular
     * acceleration: the squared radius of gyration in pitch over their distance behind the centre
     * of mass.
     * Unit: m. From 0.0 to 10.0, default 0.0.
     */
    float surface_reaction;
    /**
     * Speed that the propellers give the air in hover, at their discs. Tail first at 0.6 of it
     * the surfaces in the slipstream have no effect; at 0 they always have.
     * Unit: m/s. From 0.0 to 1000.0, default 0.0.
     */
    float hover_downwash;
    /**
     * Airspeed along the nose at which full throttle gives no thrust: pitch of the propeller
     * times its speed. At 0 thrust does not fall with speed.
     * Unit: m/s. From 0.0 to 10000.0, default 0.0.
     */
    float zero_thrust_speed;
} alula_vehicle_parameters;

/**
 * Gains by bandwidth and everything that alula_guide adds. Forces are multiples of the weight.
 */
typedef struct alula_guidance_parameters {
    /**
     * Natural frequency ω_n of the loop across the thrust line.
     * Unit: rad/s. From 0.001 to 1000.0, default 4.0.
     */
    float natural_frequency;
    /**
     * Damping ratio ζ of the loop across the thrust line.
     * No unit. From 0.01 to 100.0, default 0.8.
     */
    float damping;
    /**
     * Rate ω_v of the loop along the thrust line.
     * Unit: 1/s. From 0.001 to 1000.0, default 3.0.
     */
    float thrust_rate;
    /**
     * |F_p| below which the gains grow no further.
     * Unit: the vehicle's weight m g. From 0.001 to 1000.0, default 0.57.
     */
    float gain_schedule_floor;
    /**
     * Force τ below which the guard μ_τ acts.
     * Unit: the vehicle's weight m g. From 0.001 to 1000.0, default 0.91.
     */
    float tau;
    /**
     * Altitude error that a plan may cost as much as an error of one velocity band.
     * Unit: m. From 0.001 to 1000.0, default 0.33.
     */
    float altitude_band;
    /**
     * Velocity error, down, that costs as much as one of velocity_band_forward.
     * Unit: m/s. From 0.001 to 1000.0, default 1.58.
     */
    float velocity_band_down;
    /**
     * Velocity error, forward, that costs as much as one of velocity_band_down.
     * Unit: m/s. From 0.001 to 1000.0, default 3.3.
     */
    float velocity_band_forward;
    /**
     * Lag of the rate loop, for which the fed forward rate is advanced.
     * Unit: s. From 0.0 to 1.0, default 0.1.
     */
    float rate_lag;
    /**
     * Lag of the thrust behind its command. Used with a specific force.
     * Unit: s. From 0.001 to 1.0, default 0.05.
     */
    float thrust_lag;
    /**
     * Velocity per position error, down. Zero turns the hold off.
     * Unit: 1/s. From 0.0 to 100.0, default 1.43.
     */
    float position_gain_down;
    /**
     * Velocity per position error, horizontal. In the plane of flight less where max_rate is low.
     * Zero turns the hold off.
     * Unit: 1/s. From 0.0 to 100.0, default 0.81.
     */
    float position_gain_forward;
    /**
     * Greatest velocity towards the reference position, down.
     * Unit: m/s. From 0.0 to 1000.0, default 4.7.
     */
    float max_velocity_down;
    /**
     * Greatest velocity towards a reference position that is below. Tail first the slipstream
     * does not reach the surfaces.
     * Unit: m/s. From 0.0 to 1000.0, default 4.7.
     */
    float max_sink;
    /**
     * Greatest velocity towards the reference position, horizontal.
     * Unit: m/s. From 0.0 to 1000.0, default 3.9.
     */
    float max_velocity_forward;
    /**
     * Growth of the integral per velocity towards the reference position, down. Zero turns it
     * off.
     * Unit: 1/s. From 0.0 to 100.0, default 0.3.
     */
    float integral_gain_down;
    /**
     * Growth of the integral per velocity towards the reference position, horizontal. Zero turns
     * it off.
     * Unit: 1/s. From 0.0 to 100.0, default 0.1.
     */
    float integral_gain_forward;
    /**
     * Greatest integral, down; at most max_velocity_down.
     * Unit: m/s. From 0.0 to 1000.0, default 2.0.
     */
    float max_integral_down;
    /**
     * Greatest integral, horizontal; at most max_velocity_forward.
     * Unit: m/s. From 0.0 to 1000.0, default 1.0.
     */
    float max_integral_forward;
    /**
     * Greatest acceleration to the side of the plane of flight. Zero: the plane is kept, for
     * flights in one plane.
     * Unit: g. From 0.0 to 100.0, default 2.0.
     */
    float max_lateral_acceleration;
    /**
     * Greatest force of the air that an attitude is asked for; turns take two thirds. Gusts come
     * on top. 1000: none.
     * Unit: g. From 3.0 to 1000.0, default 1000.0.
     */
    float max_load_factor;
    /**
     * Greatest angular rate commanded, about each body axis.
     * Unit: rad/s. From 0.001 to 1000.0, default 2.8.
     */
    float max_rate;
    /**
     * Greatest change of each angular rate commanded.
     * Unit: rad/s^2. From 0.001 to 1.0e6, default 30.0.
     */
    float max_slew;
    /**
     * How long bad frames are bridged by the last command.
     * Unit: s. From 0.0 to 10.0, default 0.1.
     */
    float hold;
    /**
     * How long frames must be good without a break before the safe command is left.
     * Unit: s. From 0.0 to 10.0, default 0.05.
     */
    float recovery;
    /**
     * Age beyond which a measured state is refused.
     * Unit: s. From 0.0 to 10.0, default 0.05.
     */
    float state_age;
    /**
     * Age beyond which a reference is no longer followed.
     * Unit: s. From 0.0 to 3600.0, default 0.5.
     */
    float reference_age;
    /**
     * How long the last known wind counts as known without air data. After that it stands in for
     * what is not known: see the supervision.
     * Unit: s. From 0.0 to 1000.0, default 2.0.
     */
    float air_hold;
    /**
     * Greatest wind that air data may imply; air data that imply more are invalid.
     * Unit: m/s. From 0.0 to 1000.0, default 40.0.
     */
    float max_wind;
    /**
     * Greatest change of the wind from one step to the next; air data that imply a greater one
     * are invalid.
     * Unit: m/s. From 0.0 to 1000.0, default 10.0.
     */
    float max_wind_step;
    /**
     * Thrust of the safe command with the nose up, inside the vehicle's limits: below 1 sinks.
     * Less by as much as the nose leaned when the law flew last; none before. Zero: as near to
     * none as the limits allow.
     * Unit: the vehicle's weight m g. From -1000.0 to 1000.0, default 0.95.
     */
    float safe_thrust;
} alula_guidance_parameters;

/**
 * For ALULA_GAINS_CONSTANT: by default the paper's, for its vehicle of 10 kg.
 */
typedef struct alula_gains_parameters {
    /**
     * Gain k1: thrust per velocity error along the thrust line, relative to |F_p|.
     * Unit: s/m. From 1.0e-9 to 1.0e6, default 0.1529.
     */
    float k1;
    /**
     * Gain k2: angular rate per velocity error across the thrust line and per |F_p|.
     * Unit: rad/(N m). From 1.0e-9 to 1.0e6, default 0.0234.
     */
    float k2;
    /**
     * Gain k3: angular rate per misalignment of thrust and F_p.
     * Unit: rad/s. From 1.0e-9 to 1.0e6, default 6.0.
     */
    float k3;
    /**
     * Force τ below which the guard μ_τ acts.
     * Unit: N. From 0.001 to 1.0e6, default 80.0.
     */
    float tau;
} alula_gains_parameters;

/**
 * Of the aerodynamic models.
 */
typedef struct alula_coefficients_parameters {
    /**
     * Drag coefficient at zero angle of attack.
     * No unit. From 1.0e-6 to 1000.0, default 0.014.
     */
    float c0;
    /**
     * Large-angle part: largest lift coefficient beyond stall.
     * No unit. From 1.0e-6 to 1000.0, default 0.95.
     */
    float c1;
    /**
     * Small-angle part: lift slope at zero angle of attack.
     * Unit: 1/rad. From 1.0e-6 to 1000.0, default 5.5.
     */
    float c2;
    /**
     * Small-angle part: growth of drag with the squared angle of attack, at zero.
     * Unit: 1/rad^2. From 1.0e-6 to 1000.0, default 0.3.
     */
    float c3;
    /**
     * Stall angle, where the blend is half-way.
     * Unit: rad. From 0.001 to 1.5707964, default 0.19198622.
     */
    float alpha_bar;
    /**
     * Sharpness of lift's blend; times alpha_bar squared at most 40.
     * Unit: 1/rad^2. From 1.0e-6 to 10000.0, default 28.0.
     */
    float k_l;
    /**
     * Sharpness of drag's blend; times alpha_bar squared at most 40.
     * Unit: 1/rad^2. From 1.0e-6 to 10000.0, default 167.0.
     */
    float k_d;
} alula_coefficients_parameters;

/**
 * Everything that a controller is made of. `alula_parameters_default` fills in the defaults.
 */
typedef struct alula_parameters {
    /**
     * `ALULA_HEADER(alula_parameters)`.
     */
    uint32_t header;
    /**
     * Kind of gains, model, attitude loop.
     */
    struct alula_controller_parameters controller;
    /**
     * The vehicle. Mass, k_a and thrust_max have no default and must be set.
     */
    struct alula_vehicle_parameters vehicle;
    /**
     * Gains by bandwidth and everything that alula_guide adds. Forces are multiples of the weight.
     */
    struct alula_guidance_parameters guidance;
    /**
     * For ALULA_GAINS_CONSTANT: by default the paper's, for its vehicle of 10 kg.
     */
    struct alula_gains_parameters gains;
    /**
     * Of the aerodynamic models.
     */
    struct alula_coefficients_parameters coefficients;
} alula_parameters;

/**
 * A table: opaque memory of the caller's. Set `header`, then call `alula_table_init`.
 */
typedef struct alula_table {
    /**
     * `ALULA_HEADER(alula_table)` before `alula_table_init`.
     */
    uint32_t header;
    /**
     * Private.
     */
    uint32_t reserved;
    /**
     * Private.
     */
    uint64_t opaque[671];
} alula_table;

/**
 * One row of measured coefficients.
 */
typedef struct alula_table_row {
    /**
     * Angle of attack [rad].
     */
    float alpha;
    /**
     * Lift coefficient.
     */
    float c_l;
    /**
     * Drag coefficient.
     */
    float c_d;
} alula_table_row;

/**
 * A controller: opaque memory of the caller's, where and as long as the caller likes. Set `header`, then call
 * `alula_init`. It holds no pointer into itself: a copy is another controller.
 */
typedef struct alula_controller {
    /**
     * `ALULA_HEADER(alula_controller)` before `alula_init`.
     */
    uint32_t header;
    /**
     * Private.
     */
    uint32_t reserved;
    /**
     * Private.
     */
    uint64_t opaque[236];
} alula_controller;

/**
 * State and reference in north-east-down world and forward-right-down body axes.
 */
typedef struct alula_input {
    /**
     * `ALULA_HEADER(alula_input)`.
     */
    uint32_t header;
    /**
     * Sum of `ALULA_FEED_FORWARD`, `ALULA_POSITION`, `ALULA_SPECIFIC_FORCE`, `ALULA_NOSE_BELOW_VERTICAL`, `ALULA_HOLD_ALTITUDE_ONLY` and
     * one of `ALULA_AIR_VELOCITY`, `ALULA_AIR_UNKNOWN` and `ALULA_AIR_PITOT`, or 0.
     */
    uint32_t flags;
    /**
     * Body axes of this input and of its command: `ALULA_BODY_NOSE_FORWARD` or `ALULA_BODY_NOSE_UP`.
     */
    uint32_t body_axes;
    /**
     * Attitude quaternion (w, x, y, z), from body to world.
     */
    float quaternion[4];
    /**
     * Velocity over ground [m/s]: north, east, down.
     */
    float velocity[3];
    /**
     * Wind [m/s], the velocity of the air over ground: north, east, down. With `ALULA_AIR_VELOCITY`: velocity relative to
     * the air.
     */
    float air[3];
    /**
     * Reference velocity over ground [m/s]: north, east, down.
     */
    float reference_velocity[3];
    /**
     * Derivative of the reference velocity [m/s²]: north, east, down.
     */
    float reference_acceleration[3];
    /**
     * Where the belly is to point while there is little air velocity [rad], from north towards east: in hover, the heading
     * of multicopter axes. NaN: free, which leaves it to the course. The faster the flight, the less it counts.
     */
    float heading;
    /**
     * With `ALULA_POSITION`, for `alula_guide`: position less reference position [m]: north, east, down.
     */
    float position_error[3];
    /**
     * With `ALULA_SPECIFIC_FORCE`, for `alula_guide`: what an accelerometer measures [m/s²], acceleration less gravity:
     * forward, right, down, in the body axes. In hover it is 9.81 towards the nose.
     */
    float specific_force[3];
    /**
     * With `ALULA_FEED_FORWARD`, for `alula_step`: derivative of the air velocity [m/s²]: north, east, down.
     */
    float air_acceleration[3];
    /**
     * With `ALULA_FEED_FORWARD`, for `alula_step`: derivative of the reference acceleration [m/s³]: north, east, down.
     */
    float reference_jerk[3];
    /**
     * For `alula_guide`: age of velocity and attitude [s].
     */
    float state_age;
    /**
     * For `alula_guide`: age of the reference [s].
     */
    float reference_age;
    /**
     * For `alula_guide`: altitude error [m] that a plan may cost as much as an error of one velocity band, in place of the
     * parameter `altitude_band`. Outside 0.001 to 1000, as 0 is: the parameter's.
     */
    float altitude_band;
    /**
     * With `ALULA_AIR_PITOT`, for `alula_guide`: airspeed along the nose [m/s]. NaN: the tube tells nothing now.
     */
    float airspeed;
} alula_input;

/**
 * Command of one step, as rates and thrust and as attitude and thrust. It is the whole of the attitude: nothing is left to
 * be levelled or coordinated.
 */
typedef struct alula_command {
    /**
     * `ALULA_HEADER(alula_command)`.
     */
    uint32_t header;
    /**
     * `ALULA_STATUS_…` bits.
     */
    uint32_t status;
    /**
     * Thrust along the nose [N]. From `alula_step` it is as the law asks for it: it may be negative, or above
     * `thrust_max`.
     */
    float thrust;
    /**
     * Thrust over `thrust_max`, limited to [0, 1].
     */
    float thrust_normalised;
    /**
     * Body rate set-point [rad/s]: forward, right, down, in the input's body axes.
     */
    float body_rate[3];
    /**
     * Attitude set-point: quaternion (w, x, y, z) from the input's body axes to world. It leads the attitude by
     * `body_rate` / `attitude_gain`, 90° at most.
     */
    float quaternion[4];
} alula_command;

/**
 * What is to be reached, and how far that has come. `alula_goal_default` makes it a stop without a past.
 */
typedef struct alula_goal {
    /**
     * `ALULA_HEADER(alula_goal)`.
     */
    uint32_t header;
    /**
     * `ALULA_GOAL_HOVER`, `ALULA_GOAL_STOP` or `ALULA_GOAL_VELOCITY`. It may change at any step, and so may `target`.
     */
    uint32_t kind;
    /**
     * Position [m], in the world of `alula_goal_step`'s position, or velocity [m/s]: north, east, down.
     */
    float target[3];
    /**
     * Horizontal speed on the way to a position [m/s], 0.01 to 1000.
     */
    float speed;
    /**
     * Vertical speed on the way to a position [m/s], 0.01 to 1000.
     */
    float climb;
    /**
     * Greatest acceleration of the reference [m/s²], 0.01 to 1000. A stop does not mind it, nor a braking in a climb.
     */
    float acceleration;
    /**
     * Greatest climb that a braking may take [m], 0 to 1000; 0: it is level. It takes 0.085 s²/m V², V being what it takes off the speed; where that
     * is more than is allowed, it is level. A stop, and a velocity, ends as much higher; a place to hover at is come down to.
     */
    float braking_climb;
    /**
     * Altitude error [m] that a plan may cost as much as an error of one velocity band, 0.001 to 1000. 0: the parameter
     * `altitude_band`.
     */
    float altitude_band;
    /**
     * 1 if the nose is to stay short of the vertical while the vehicle flies forward, else 0.
     */
    uint32_t nose_below_vertical;
    /**
     * Result: 1 if the reference stands at the goal, at rest there or at the velocity, else 0.
     */
    uint32_t reached;
    /**
     * Private: what is remembered, and a copy of it.
     */
    uint32_t opaque[23];
} alula_goal;

/**
 * The quantities that a command is made of. What is not known is zero.
 */
typedef struct alula_report {
    /**
     * `ALULA_HEADER(alula_report)`.
     */
    uint32_t header;
    /**
     * `ALULA_MODE_…`.
     */
    uint32_t mode;
    /**
     * `ALULA_AIR_USE_…`; of `alula_guide`.
     */
    uint32_t air_use;
    /**
     * `ALULA_PHASE_…`; of `alula_guide`.
     */
    uint32_t phase;
    /**
     * `ALULA_UNREACHABLE_…`; of `alula_guide`.
     */
    uint32_t unreachable;
    /**
     * Angle of attack [rad], in [−π, π].
     */
    float alpha;
    /**
     * Sideslip [rad], in [−π/2, π/2]: positive where the air velocity points to the right wing.
     */
    float sideslip;
    /**
     * Angle by which the wing is off the balance of lateral forces [rad], in (−π/2, π/2): positive where the force asked
     * for leans to the right wing. The commanded rates bring it to zero.
     */
    float tilt;
    /**
     * Angle from the tail to the apparent external force in the plane of symmetry [rad], in (−π, π]: the angle by which
     * the attitude still has to pitch.
     */
    float theta_tilde;
    /**
     * |F_p| [N]: how far the law is from losing its equilibrium.
     */
    float f_p_norm;
    /**
     * Thrust of the equivalent sphere [N].
     */
    float t_p;
    /**
     * Weight of the alignment term, 0 to 1.
     */
    float guard_alignment;
    /**
     * Weight of the feed-forward, 0 to 1.
     */
    float guard_feed_forward;
    /**
     * Velocity that the law was given to follow [m/s]: north, east, down.
     */
    float velocity[3];
    /**
     * Acceleration that the law was given to follow [m/s²]: north, east, down.
     */
    float acceleration[3];
    /**
     * |F_p| over tau: below 1 the guard acts, at 0 no attitude is an equilibrium. Of `alula_guide`.
     */
    float margin_force;
    /**
     * Gain k of the full law here: 1 on a sphere, large or negative where F_p turns with the attitude. Of `alula_guide`.
     */
    float margin_k;
    /**
     * Angle from the present attitude to the nearest fold [rad], to first order. Of `alula_guide`.
     */
    float margin_fold;
} alula_report;

/**
 * How missions are flown: parameters of alula_mission_setup.
 */
typedef struct alula_mission_parameters {
    /**
     * Airspeed of the items before the first that changes the speed.
     * Unit: m/s. From 1.0 to 340.0, no default.
     */
    float cruise_speed;
    /**
     * Bank of turns on the wing. Less where the wing does not carry it.
     * Unit: rad. From 0.05 to 1.2, default 0.5.
     */
    float bank;
    /**
     * Acceleration on the way to a speed. On the wing it slows down by drag alone.
     * Unit: m/s^2. From 0.1 to 10.0, default 2.0.
     */
    float acceleration;
    /**
     * Deceleration on the way to a place of hover.
     * Unit: m/s^2. From 0.1 to 10.0, default 1.5.
     */
    float braking;
    /**
     * Greatest climb in which it brakes from the wing to hover, at 3 m/s². A vehicle that does
     * not hold its wing across the air takes 1.67 V²/2g of it, and brakes level where that is
     * more; the others brake level.
     * Unit: m. From 0.0 to 1000.0, default 100.0.
     */
    float braking_climb;
    /**
     * Greatest climb.
     * Unit: m/s. From 0.1 to 50.0, default 3.0.
     */
    float climb;
    /**
     * Greatest sink in hover.
     * Unit: m/s. From 0.1 to 50.0, default 1.5.
     */
    float sink;
    /**
     * Speed over ground between places that are too near to each other for the wing.
     * Unit: m/s. From 0.1 to 50.0, default 4.0.
     */
    float hover_speed;
    /**
     * Steepest descent on the wing, in multiples of the glide without thrust.
     * No unit. From 0.1 to 1.0, default 0.8.
     */
    float glide_share;
    /**
     * Least airspeed that is asked for on the wing, in multiples of the one there is: the wing
     * cannot brake.
     * No unit. From 0.0 to 1.0, default 0.9.
     */
    float yield_share;
    /**
     * Least height over the take-off to return at, and to go around to.
     * Unit: m. From 1.0 to 10000.0, default 20.0.
     */
    float safe_height;
    /**
     * Height over the place of landing below which it is approached with landing_speed.
     * Unit: m. From 0.5 to 100.0, default 3.0.
     */
    float flare_height;
    /**
     * Sink at touch-down.
     * Unit: m/s. From 0.1 to 2.0, default 0.4.
     */
    float landing_speed;
    /**
     * Time in which the thrust grows to the weight before take-off.
     * Unit: s. From 0.1 to 10.0, default 0.4.
     */
    float spool_time;
    /**
     * Speed that the propellers give the air in hover, at their discs. For the energy.
     * Unit: m/s. From 1.0 to 100.0, default 10.0.
     */
    float hover_downwash;
} alula_mission_parameters;

/**
 * How missions are flown, and what is done when something fails. `alula_mission_default` fills in the defaults.
 */
typedef struct alula_mission_setup {
    /**
     * `ALULA_HEADER(alula_mission_setup)`.
     */
    uint32_t header;
    /**
     * `cruise_speed` has no default and must be set.
     */
    struct alula_mission_parameters parameters;
    /**
     * `ALULA_RESPONSE_…` to a lost link. Of several troubles the gravest response is done.
     */
    uint32_t link;
    /**
     * To unknown air.
     */
    uint32_t air;
    /**
     * To an unknown position: it is reckoned from the velocity.
     */
    uint32_t position;
    /**
     * To a low battery.
     */
    uint32_t battery;
    /**
     * To a vehicle that does not follow.
     */
    uint32_t follow;
} alula_mission_setup;
/**
 * The defaults; NaN where there is none. Whatever fails, the mission goes on.
 */
#define alula_mission_setup_DEFAULT (alula_mission_setup){ .header = alula_mission_setup_HEADER, .parameters = alula_mission_parameters_DEFAULT, .link = ALULA_RESPONSE_CONTINUE, .air = ALULA_RESPONSE_CONTINUE, .position = ALULA_RESPONSE_CONTINUE, .battery = ALULA_RESPONSE_CONTINUE, .follow = ALULA_RESPONSE_CONTINUE }

/**
 * A mission in flight: what it is told, what it says, and opaque memory. Set `header`, then call `alula_mission_init`.
 */
typedef struct alula_mission {
    /**
     * `ALULA_HEADER(alula_mission)` before `alula_mission_init`.
     */
    uint32_t header;
    /**
     * Told: sum of `ALULA_ARMED` and `ALULA_TROUBLE_…`.
     */
    uint32_t flags;
    /**
     * Told: position [m]: north, east, down.
     */
    float position[3];
    /**
     * Result: item, counted from 0; the number of items when all are done.
     */
    uint32_t item;
    /**
     * Result: `ALULA_ACTIVITY_…`.
     */
    uint32_t activity;
    /**
     * Result: `ALULA_REMARK_…`, what cannot be done as asked.
     */
    uint32_t remark;
    /**
     * Result: `ALULA_TROUBLE_…`, of what is told and of what it finds itself.
     */
    uint32_t troubles;
    /**
     * Result: `ALULA_RESPONSE_…` that is done.
     */
    uint32_t response;
    /**
     * Result: time since the item began [s].
     */
    float time;
    /**
     * Result: way to the end of the item [m].
     */
    float distance_to_go;
    /**
     * Result: time to the end of the item [s].
     */
    float time_to_go;
    /**
     * Result: way of the items after it, legs alone [m].
     */
    float distance_after;
    /**
     * Result: time of the items after it [s].
     */
    float time_after;
    /**
     * Result: energy that the propellers have given the air, by momentum theory [J].
     */
    float energy;
    /**
     * Result: how far the vehicle is to the right of its path [m].
     */
    float right;
    /**
     * Result: airspeed asked for [m/s]; 0 in hover.
     */
    float airspeed;
    /**
     * Result: thrust of steady flight at this airspeed, turn and climb [N]; the weight in hover, 0 on the ground.
     */
    float steady_thrust;
    /**
     * Private.
     */
    uint32_t reserved;
    /**
     * Private.
     */
    uint64_t opaque[560];
} alula_mission;

/**
 * One item of a mission. What an item does not use is not read.
 */
typedef struct alula_mission_item {
    /**
     * `ALULA_ITEM_…`.
     */
    uint32_t kind;
    /**
     * Position [m]: north, east, down, in the world of the mission's `position`.
     */
    float place[3];
    /**
     * Radius of a loiter [m], to the right; negative to the left.
     */
    float radius;
    /**
     * Height of a take-off [m], time of a hover or loiter [s], turns of a loiter, speed [m/s].
     */
    float value;
} alula_mission_item;

/**
 * A plan in the making: memory of the caller's. Set `header`, then call `alula_search_begin`.
 */
typedef struct alula_search {
    /**
     * `ALULA_HEADER(alula_search)`.
     */
    uint32_t header;
    /**
     * Result: 1 while there is a candidate to look at, 0 at the end.
     */
    uint32_t more;
    /**
     * Private.
     */
    uint32_t opaque[34];
} alula_search;

/**
 * An attitude at which a thrust holds the reference.
 */
typedef struct alula_equilibrium {
    /**
     * The attitude: quaternion (w, x, y, z) from the input's body axes to world.
     */
    float quaternion[4];
    /**
     * Angle of attack [rad].
     */
    float alpha;
    /**
     * Thrust [N]; it may be negative.
     */
    float thrust;
    /**
     * Apparent external force along the tail [N]: negative where it is against the thrust.
     */
    float t_p;
    /**
     * 1 if thrust is along the apparent external force, as the laws fly; 0 if it is against it.
     */
    uint32_t aligned;
    /**
     * 1 if it moves continuously with the reference; 0 at a fold.
     */
    uint32_t isolated;
} alula_equilibrium;

/**
 * The attitudes that hold a reference, by increasing angle of attack.
 */
typedef struct alula_equilibria {
    /**
     * `ALULA_HEADER(alula_equilibria)`.
     */
    uint32_t header;
    /**
     * How many there are.
     */
    uint32_t count;
    /**
     * The first `count` are set, the rest are zero.
     */
    struct alula_equilibrium items[ALULA_EQUILIBRIA];
} alula_equilibria;

/**
 * A map of the folds, from which the margin to the nearest is read: opaque memory of the caller's. Set `header`, then call
 * `alula_fold_map_init`.
 */
typedef struct alula_fold_map {
    /**
     * `ALULA_HEADER(alula_fold_map)` before `alula_fold_map_init`.
     */
    uint32_t header;
    /**
     * Private.
     */
    uint32_t reserved;
    /**
     * Private.
     */
    uint64_t opaque[384];
} alula_fold_map;

/**
 * How far the nearest fold is, with the directions of air velocity and apparent weight kept.
 */
typedef struct alula_fold_margin {
    /**
     * `ALULA_HEADER(alula_fold_margin)`.
     */
    uint32_t header;
    /**
     * Angle of attack at the fold, less the present one [rad].
     */
    float alpha;
    /**
     * Airspeed at the fold over the present one, squared.
     */
    float a;
} alula_fold_margin;
/**
 * No margin.
 */
#define alula_fold_margin_EMPTY (alula_fold_margin){ .header = alula_fold_margin_HEADER, .alpha = 0.0, .a = 0.0 }

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The version of the ABI that the library was built with, for a caller of the shared library to compare with
 * `ALULA_ABI_VERSION`.
 */
uint32_t alula_abi_version(void);

/**
 * What a return code means, in one line that needs no freeing. Never null.
 */
const char *alula_strerror(int32_t code);

/**
 * Fills in the default of every parameter. Those of the vehicle that have none, mass, k_a and thrust_max, become NaN, which
 * `alula_init` refuses: they must be set.
 *
 * Pointers:
 * `parameters` is null or points to memory of the caller's that holds at least the header word, already set; the whole
 * structure if that is right.
 */
int32_t alula_parameters_default(struct alula_parameters *parameters);

/**
 * Sets every parameter in `guidance` by the rules for `vehicle`, which must be complete, and for how fast it answers and is to
 * fly: the lag of its rate loop and of its thrust [s], the rate at which alula_guide is called [Hz], the
 * speed of cruise [m/s].
 * docs/your-vehicle.md says how lags are measured. Returns `ALULA_OK`, or a code that names what is refused; then nothing is set.
 *
 * Pointers:
 * `parameters` is null or points to memory of the caller's that holds at least the header word, already set; the whole
 * structure if that is right.
 */
int32_t alula_parameters_for_vehicle(struct alula_parameters *parameters,
                                     float rate_lag,
                                     float thrust_lag,
                                     float control_rate,
                                     float cruise_speed);

/**
 * Makes `table` the one through `count` rows, by increasing angle: from 0 to π for a symmetric section, or from −π to π
 * for any other. The rows are not needed afterwards. If `row` is not null, it is set to the row that is refused, counted
 * from 0. No controller may be using the table: those that do keep a pointer to it.
 *
 * Pointers:
 * `table` is null or points to memory of the caller's that holds at least the header word; the whole structure if that
 * is right. `rows` is null or points to `count` rows. `row` is null or points to a number.
 */
int32_t alula_table_init(struct alula_table *table,
                         const struct alula_table_row *rows,
                         uint32_t count,
                         uint32_t *row);

/**
 * Makes `controller` the one of `parameters`. If the model is `ALULA_MODEL_TABLE`, the controller keeps a pointer to
 * `table`. The table must stay where it is, and as it is, for as long as the controller or a copy of it is used. For
 * any other model `table` is not read and may be null. Returns `ALULA_OK`, or the code that names the first parameter
 * refused; the controller is then not initialised.
 *
 * Pointers:
 * Each pointer is null or points to memory of the caller's that holds at least the header word; the whole structure
 * if that is right. No other call uses the controller meanwhile.
 */
int32_t alula_init(struct alula_controller *controller,
                   const struct alula_parameters *parameters,
                   const struct alula_table *table);

/**
 * Forgets what past calls of `alula_guide` have left in the controller, as at power-on.
 *
 * Pointers:
 * As `alula_init`.
 */
int32_t alula_reset(struct alula_controller *controller);

/**
 * Fills in a hover in still air whose reference is to stay, heading free.
 *
 * Pointers:
 * `input` is null or points to memory of the caller's that holds at least the header word, already set; the whole
 * structure if that is right.
 */
int32_t alula_input_default(struct alula_input *input);

/**
 * Fills in the safe command.
 *
 * Pointers:
 * As `alula_input_default`.
 */
int32_t alula_command_default(struct alula_command *command);

/**
 * Fills in a stop without a past, with 20 m/s, 3 m/s up and down and 2 m/s² on the way to positions.
 *
 * Pointers:
 * `goal` is null or points to memory of the caller's that holds at least the header word, already set; the whole
 * structure if that is right.
 */
int32_t alula_goal_default(struct alula_goal *goal);

/**
 * The reference, the position error and the planner options of `input` for `goal`, before `alula_guide` is called with it: at `position` [m],
 * north, east, down, and the velocity that is in `input`, `dt` [s] after the last. It sets `reference_velocity`,
 * `reference_acceleration`, `position_error` with `ALULA_POSITION`, `reference_age`, `altitude_band`, `ALULA_NOSE_BELOW_VERTICAL`
 * and `ALULA_HOLD_ALTITUDE_ONLY`. A new goal begins where the vehicle is. With any code but `ALULA_OK` neither `goal` nor `input` has changed.
 *
 * Pointers:
 * `goal` and `input` are each null or point to memory of the caller's that holds at least the header word; the whole structure
 * if that is right, and not the same memory. `position` is null or points to three numbers. No other call uses them
 * meanwhile.
 */
int32_t alula_goal_step(struct alula_goal *goal,
                        const float *position,
                        float dt,
                        struct alula_input *input);

/**
 * Takes over a vehicle that flies already: at the attitude in `input`, with `thrust_normalised` and `body_rate` [rad/s] commanded last, by whoever flew
 * it, about the axes of `input`. The first good call of `alula_guide` is flown; until it comes this command is held, for `hold` at most. What was
 * remembered is forgotten. For what is not finite stand the safe thrust and no rotation.
 *
 * Pointers:
 * As `alula_reset`; `input` and `body_rate` are as `alula_goal_step`'s `input` and `position`.
 */
int32_t alula_take_over(struct alula_controller *controller,
                        const struct alula_input *input,
                        float thrust_normalised,
                        const float *body_rate);

/**
 * One step of the guidance: supervision, reference model, outer loop, law and actuator limits. It always gives a command. If
 * the return code says that the input was refused, the command is the last one flown, for as long as `hold`
 * (`ALULA_STATUS_HOLDING`), and then the safe one: `safe_thrust`, no rotation (`ALULA_STATUS_SAFE`). A plan is due after it where the
 * command's status has `ALULA_STATUS_PLAN_DUE`: then call `alula_plan`. If a pointer, a header,
 * the controller or a selector is at fault, there was no step, and the command is that of `alula_command_default`. `report`
 * may be null.
 *
 * Pointers:
 * As `alula_step`, and no other call reads the controller meanwhile either.
 */
int32_t alula_guide(struct alula_controller *controller,
                    const struct alula_input *input,
                    float dt,
                    struct alula_command *command,
                    struct alula_report *report);

/**
 * Fills in the default of every parameter of missions; whatever fails, the mission goes on. `cruise_speed` has none, becomes NaN
 * and must be set.
 *
 * Pointers:
 * As `alula_input_default`.
 */
int32_t alula_mission_default(struct alula_mission_setup *setup);

/**
 * Makes `mission` one without items, before its flight, for the vehicle of `of`, which is initialised. Returns `ALULA_OK`, or the
 * code that names the parameter refused; the mission is then not initialised.
 *
 * Pointers:
 * Each pointer is null or points to memory of the caller's that holds at least the header word; the whole structure
 * if that is right. No other call uses the mission meanwhile.
 */
int32_t alula_mission_init(struct alula_mission *mission,
                           const struct alula_mission_setup *setup,
                           const struct alula_controller *of);

/**
 * Gives `mission` these `count` items in place of its own, and goes to the one of number `from`, counted from 0: before the flight to 0,
 * in flight to any. The items are not needed afterwards. If `refused` is not null, it is set to the item that is refused, counted from
 * 0; then the mission is as before.
 *
 * Pointers:
 * `mission` as in `alula_mission_init`. `items` is null or points to `count` items, `refused` is null or points to a number.
 */
int32_t alula_mission_items(struct alula_mission *mission,
                            const struct alula_mission_item *items,
                            uint32_t count,
                            uint32_t from,
                            uint32_t *refused);

/**
 * One step of a mission and of the guidance, `dt` [s] after the last: in place of `alula_guide`, with the attitude, velocity and air
 * that are in `input`, and with `flags` and `position` in `mission`. References in `input` are not read. On the ground the command is
 * the safe one, and the controller is as at power-on; during spool-up the thrust is bounded. What the mission says is in its results.
 * Codes and commands are those of `alula_guide`; if the mission or its flags are at fault, there was no step, and the command is that
 * of `alula_command_default`. `report` may be null.
 *
 * Pointers:
 * As `alula_guide`, and no other call uses the mission meanwhile.
 */
int32_t alula_mission_fly(struct alula_mission *mission,
                          struct alula_controller *controller,
                          const struct alula_input *input,
                          float dt,
                          struct alula_command *command,
                          struct alula_report *report);

/**
 * One step of the bare law of the winged vehicle, robust: from `input` to `command`, `dt` seconds after the last. The law
 * has no memory and no limits: `dt` is only checked. Whatever is returned but `ALULA_OK`, the command is the safe one, and
 * `report` is not written; if `command` itself is at fault, it is not written either. `report` may be null; of
 * `alula_guide` alone are its margins, phase and use of the air.
 *
 * Pointers:
 * Each pointer is null or points to memory of the caller's that holds at least the header word; the whole structure
 * if that is right. No other call changes the controller meanwhile.
 */
int32_t alula_step(const struct alula_controller *controller,
                   const struct alula_input *input,
                   float dt,
                   struct alula_command *command,
                   struct alula_report *report);

/**
 * How fast a path may go on, in multiples of its own speed, between 0.5 and 1.25: slower where the vehicle is behind, faster
 * where it is ahead. `position_error` is the position less the path's [m], `velocity` the path's velocity at its own
 * speed [m/s], both north, east, down. With the scale p the reference is p times that velocity and p² times its
 * acceleration, and the path's parameter advances at p times its own rate. What is not finite gives 1, and so does every
 * code but `ALULA_OK`.
 *
 * Pointers:
 * `controller` as in `alula_step`. Each vector is null or points to three numbers, `time_scale` is null or points to one.
 */
int32_t alula_path_time_scale(const struct alula_controller *controller,
                              const float *position_error,
                              const float *velocity,
                              float *time_scale);

/**
 * Makes the plan that `ALULA_STATUS_PLAN_DUE` asks for: the vehicle is flown ahead by the plan in force and by others.
 * The next step goes on by the best of them. It takes some twenty times the instructions of `alula_guide`. Without
 * plans the vehicle flies on by the last one: it follows what it can without crossing a stall.
 *
 * Pointers:
 * As `alula_guide`.
 */
int32_t alula_plan(struct alula_controller *controller);

/**
 * Begins a plan apart from the controller, for a task of lower priority, or for one candidate a step. `alula_plan` is this,
 * `alula_search_look` while `more` is 1, and `alula_search_adopt`.
 *
 * Pointers:
 * `controller` and `search` are null, unaligned, or point to their structures, which no other call changes meanwhile.
 */
int32_t alula_search_begin(const struct alula_controller *controller,
                           struct alula_search *search);

/**
 * Looks at the plan in force, or at one candidate more: at most one flight ahead. Of the controller it reads what
 * `alula_init` has left, and no step changes: `alula_guide` may interrupt it.
 *
 * Pointers:
 * As `alula_search_begin`, but `alula_guide` may change the controller meanwhile.
 */
int32_t alula_search_look(const struct alula_controller *controller,
                          struct alula_search *search);

/**
 * Flies by what a search found from the next step on. A search that began more than 0.3 s ago, or before `alula_reset`, changes
 * nothing.
 *
 * Pointers:
 * As `alula_guide`.
 */
int32_t alula_search_adopt(struct alula_controller *controller,
                           const struct alula_search *search);

/**
 * The attitudes at which the reference of `input` can be held in its wind without sideslip, in a turn banked as its
 * reference acceleration asks. The plane of symmetry is then that of the air velocity asked for and the apparent
 * weight. Where these are parallel, as in hover, the belly stays on the side it has in `input`. Velocity is not read,
 * unless the air is given relative to it. Slower than a step, and of bounded work: for a background task. With any
 * code but `ALULA_OK` the set is empty.
 *
 * Pointers:
 * As `alula_step`.
 */
int32_t alula_equilibria_at(const struct alula_controller *controller,
                            const struct alula_input *input,
                            struct alula_equilibria *equilibria);

/**
 * Makes `map` the one of the controller's vehicle. Slower than a step: once, after `alula_init`.
 *
 * Pointers:
 * Each pointer is null or points to memory of the caller's that holds at least the header word; the whole structure
 * if that is right. No other call uses the map meanwhile.
 */
int32_t alula_fold_map_init(struct alula_fold_map *map,
                            const struct alula_controller *controller);

/**
 * How far the nearest fold is from the state of `input`, if it is to accelerate as the reference does: in a turn of load
 * factor n every fold lies at √n times its airspeed.
 * `ALULA_ERROR_NO_FOLD` says that there is none near; with any code but `ALULA_OK` the margin is zero.
 *
 * Pointers:
 * As `alula_step`.
 */
int32_t alula_fold_margin_at(const struct alula_fold_map *map,
                             const struct alula_controller *controller,
                             const struct alula_input *input,
                             struct alula_fold_margin *margin);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ALULA_H */
