// Starts the module against the stand-in and flies it: from what it is told at the start, to a goal and a set-point, and beside somebody else.
#include "alula_guidance.hpp"

#include <cmath>

ORB_DEFINE(offboard_control_mode, offboard_control_mode_s);
ORB_DEFINE(parameter_update, parameter_update_s);
ORB_DEFINE(trajectory_setpoint, trajectory_setpoint_s);
ORB_DEFINE(vehicle_acceleration, vehicle_acceleration_s);
ORB_DEFINE(vehicle_attitude, vehicle_attitude_s);
ORB_DEFINE(vehicle_attitude_setpoint, vehicle_attitude_setpoint_s);
ORB_DEFINE(mc_virtual_attitude_setpoint, vehicle_attitude_setpoint_s);
ORB_DEFINE(vehicle_land_detected, vehicle_land_detected_s);
ORB_DEFINE(vehicle_local_position, vehicle_local_position_s);
ORB_DEFINE(vehicle_rates_setpoint, vehicle_rates_setpoint_s);
ORB_DEFINE(vehicle_status, vehicle_status_s);
ORB_DEFINE(wind, wind_s);

static hrt_abstime now = 1000000;
hrt_abstime hrt_absolute_time() { return now; }

// Mass 0 is the vehicle of vehicle.h: 3 kg, 47 N. Else it is one of 10 kg with twice its weight of thrust, all else by default.
static float mass;
static const char *asked_for;
param_t param_find(const char *name)
{
	asked_for = name;
	return 0;
}
int param_get(param_t, void *value)
{
	const struct {
		const char *name;
		float value;
	} set[] = {{"ALU_MASS", mass}, {"ALU_KA", 0.646f}, {"ALU_THR_MAX", 196.2f}};
	for (const auto &parameter : set)
		if (std::strcmp(parameter.name, asked_for) == 0)
			std::memcpy(value, &parameter.value, sizeof parameter.value);
	return 0;
}

static int failures;
static void expect(bool good, const char *what)
{
	std::printf("%s: %s\n", what, good ? "yes" : "NO");
	failures += !good;
}

extern "C" int alula_guidance_main(int argc, char *argv[]);
static int call(const char *first, const char *second = nullptr, const char *north = nullptr)
{
	char name[] = "alula_guidance", zero[] = "0";
	char *argv[] = {name, const_cast<char *>(first), const_cast<char *>(second), const_cast<char *>(north), zero, zero};
	if (second != nullptr && north == nullptr)
		return alula_guidance_main(3, argv);
	char *going[] = {name, const_cast<char *>(first), const_cast<char *>(north), zero, zero};
	return north ? alula_guidance_main(5, going) : alula_guidance_main(2, argv);
}

template <typename T> static void tell(const orb_metadata *topic, const T &message) { uORB::Publication<T>(topic).publish(message); }

// A hundredth of a second in hover, nose up, the acceleration that of the last thrust.
static void step(float nose_pitch = 0.0f, float carried = 9.81f)
{
	now += 10000;
	vehicle_attitude_s attitude{};
	attitude.timestamp = now;
	attitude.q[0] = std::cos(0.5f * nose_pitch), attitude.q[2] = std::sin(0.5f * nose_pitch);
	vehicle_local_position_s position{};
	position.timestamp = now;
	position.xy_valid = position.z_valid = position.v_xy_valid = position.v_z_valid = true;
	vehicle_acceleration_s force{};
	force.timestamp = now, force.xyz[2] = -carried;
	wind_s wind{};
	wind.timestamp = now;
	tell(ORB_ID(vehicle_attitude), attitude);
	tell(ORB_ID(vehicle_local_position), position);
	tell(ORB_ID(vehicle_acceleration), force);
	tell(ORB_ID(wind), wind);
	struct Reach : AlulaGuidance {
		static AlulaGuidance *get() { return get_instance(); }
	};
	if (Reach::get())
		px4::Queue::run(*Reach::get());
}

static void mode(uint8_t nav_state)
{
	vehicle_status_s status{};
	status.arming_state = vehicle_status_s::ARMING_STATE_ARMED;
	status.nav_state = nav_state;
	status.vehicle_type = vehicle_status_s::VEHICLE_TYPE_ROTARY_WING;
	tell(ORB_ID(vehicle_status), status);
}

int main()
{
	const vehicle_rates_setpoint_s &rates = last_vehicle_rates_setpoint;
	expect(call("start") == PX4_OK, "it starts");
	mode(4);
	// What PX4's own controllers command: 3 kg hover at 0.625 of 47 N.
	vehicle_rates_setpoint_s before{};
	before.timestamp = now, before.thrust_body[2] = -0.6f, before.pitch = 0.1f;
	tell(ORB_ID(vehicle_rates_setpoint), before);
	for (int n = 0; n < 100; n++)
		step();
	expect(count_vehicle_rates_setpoint == 1, "beside another mode nothing is commanded");
	expect(last_offboard_control_mode.body_rate && count_offboard_control_mode == 100, "OFFBOARD has its stream");

	mode(vehicle_status_s::NAVIGATION_STATE_OFFBOARD);
	bool thrust = true;
	for (int n = 0; n < 300; n++) {
		step();
		thrust = thrust && rates.thrust_body[2] < -0.55f && rates.thrust_body[2] > -0.7f;
	}
	expect(thrust, "from the first command on the thrust holds the weight");
	expect(std::fabs(rates.thrust_body[2] + 0.625f) < 1e-2f && std::fabs(rates.pitch) < 1e-2f, "it hovers");
	expect(call("velocity", "x", "5") == PX4_OK, "it takes a velocity");
	for (int n = 0; n < 100; n++)
		step();
	expect(rates.pitch < -0.1f, "to the north it pitches forward");
	expect(call("stop_here") == PX4_OK, "it takes a stop");
	step();
	trajectory_setpoint_s setpoint{};
	for (int n = 0; n < 300; n++) {
		setpoint.timestamp = now, setpoint.yaw = 0.3f;
		setpoint.velocity[0] = setpoint.velocity[1] = setpoint.velocity[2] = NAN;
		tell(ORB_ID(trajectory_setpoint), setpoint);
		step();
	}
	expect(rates.yaw > 0.3f, "a trajectory set-point goes before the goal: its yaw is turned to");

	const unsigned published = count_vehicle_rates_setpoint;
	before.timestamp = now + 1;
	tell(ORB_ID(vehicle_rates_setpoint), before);
	for (int n = 0; n < 30; n++)
		step();
	expect(count_vehicle_rates_setpoint == published + 1, "where somebody else commands it is silent");
	call("status");
	vehicle_land_detected_s land{};
	land.landed = true;
	tell(ORB_ID(vehicle_land_detected), land);
	for (int n = 0; n < 60; n++)
		step();
	expect(rates.thrust_body[2] == 0.0f && rates.timestamp == now, "on the ground there is no thrust");
	land.landed = false;
	tell(ORB_ID(vehicle_land_detected), land);
	call("stop");
	step();

	// The vehicle of the parameters, by attitudes.
	mass = 10.0f;
	expect(call("start", "attitude") == PX4_OK, "it starts anew");
	const vehicle_attitude_setpoint_s &attitude = last_mc_virtual_attitude_setpoint;
	before.timestamp = now, before.thrust_body[2] = -0.5f;
	tell(ORB_ID(vehicle_rates_setpoint), before);
	for (int n = 0; n < 300; n++)
		step();
	expect(last_offboard_control_mode.attitude && !last_offboard_control_mode.body_rate, "by attitudes");
	expect(std::fabs(attitude.thrust_body[2] + 0.5f) < 1e-2f && attitude.q_d[0] > 0.999f, "half of the thrust holds 10 kg, upright");
	const float flown = attitude.thrust_body[2];
	for (int n = 0; n < 5; n++)
		step(NAN);
	expect(attitude.thrust_body[2] == flown, "a frame without an attitude: the last command is held");
	call("stop");
	step();
	return failures != 0;
}
