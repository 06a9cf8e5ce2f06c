#include "alula_guidance.hpp"

#include "parameters.hpp"
#include "vehicle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

namespace
{
// A queue of its own: alula_guide takes 2.6 kB of stack, and vehicle_init with a table of coefficients 11.1 kB, once. The queue of
// PX4's controllers has 2.2 kB. Its place is just behind them.
constexpr px4::wq_config_t QUEUE{"wq:alula", 14336, -15};

// Period [us] of the steps: control_rate_hz of the vehicle's file.
constexpr uint32_t PERIOD = 10000;
// Ages [s] at which a wind and a specific force are not used any more, and at which a trajectory set-point has ceased.
constexpr float OLD_WIND = 5.0f, OLD_FORCE = 0.1f, CEASED = 0.5f;
// For so long [us] nothing is published after somebody else commanded.
constexpr hrt_abstime YIELD = 500000;

float age(hrt_abstime now, hrt_abstime timestamp) { return now > timestamp ? static_cast<float>(now - timestamp) * 1e-6f : 0.0f; }

float limited(float x, float least, float most) { return x < least ? least : x > most ? most : x; }

bool any_finite(const float v[3]) { return isfinite(v[0]) || isfinite(v[1]) || isfinite(v[2]); }
} // namespace

AlulaGuidance::AlulaGuidance(Output output) : px4::WorkItem(MODULE_NAME, QUEUE), _output(output)
{
	_input.header = ALULA_HEADER(alula_input);
	_command.header = ALULA_HEADER(alula_command);
	_report.header = ALULA_HEADER(alula_report);
	_goal.header = ALULA_HEADER(alula_goal);
	_ask.header = ALULA_HEADER(alula_goal);
	alula_input_default(&_input);
	alula_command_default(&_command);
	alula_goal_default(&_goal);
	alula_goal_default(&_ask);
	// As vehicle_attitude of a tail-sitter in the multicopter state.
	_input.body_axes = ALULA_BODY_NOSE_UP;
}

AlulaGuidance::~AlulaGuidance() { perf_free(_loop_perf); }

bool AlulaGuidance::init()
{
	_attitude_sub.set_interval_us(PERIOD);
	return _attitude_sub.registerCallback();
}

// The vehicle is that of vehicle.h, which `alula-sil new` made; with ALU_MASS set it is that of the parameters.
void AlulaGuidance::initialise()
{
	alula_parameters p;
	p.header = ALULA_HEADER(alula_parameters);
	alula_parameters_default(&p);
	const bool set = load(p);
	_controller.header = ALULA_HEADER(alula_controller);
	_made = set ? alula_init(&_controller, &p, nullptr) : vehicle_init(&_controller, &_table);

	if (_made != ALULA_OK) {
		PX4_ERR("%s", alula_strerror(_made));
	}
}

void AlulaGuidance::Run()
{
	if (should_exit()) {
		_attitude_sub.unregisterCallback();
		exit_and_cleanup();
		return;
	}

	perf_begin(_loop_perf);
	const hrt_abstime now = hrt_absolute_time();
	const float dt = limited(age(now, _last_run), 0.001f, 0.1f);
	_last_run = now;

	// Parameters are taken over on the ground and beside another mode, not in flight.
	if (!_flying && (_parameter_update_sub.updated() || _made == ALULA_ERROR_NOT_INITIALISED)) {
		parameter_update_s update;
		_parameter_update_sub.copy(&update);
		initialise();
	}

	if (_asked.load()) {
		_goal.kind = _ask.kind;
		memcpy(_goal.target, _ask.target, sizeof(_goal.target));
		_asked.store(false);
	}

	const bool flew = _flying;
	_flying = _made == ALULA_OK && flies();

	if (_flying && !flew) {
		begin(now);
	}

	const bool yields = somebody_else_commands(now);

	if (_made == ALULA_OK && !yields) {
		// PX4 grants OFFBOARD to a stream, and leaves it when the stream ceases (COM_OF_LOSS_T).
		offboard_control_mode_s mode{};
		mode.timestamp = now;
		mode.body_rate = _output == Output::Rates;
		mode.attitude = _output == Output::Attitude;
		_offboard_control_mode_pub.publish(mode);
	}

	if (_flying && !yields) {
		fill_state(now);
		fill_reference(now, dt);
		// The command is flown whatever the code is: all three rates, or the whole attitude.
		_code = alula_guide(&_controller, &_input, dt, &_command, &_report);
		vehicle_land_detected_s land{};
		publish(now, _land_detected_sub.copy(&land) && land.landed);

		if (_command.status & ALULA_STATUS_PLAN_DUE)
			alula_plan(&_controller);
	}

	perf_end(_loop_perf);
}

// Whether alula is to fly: armed, in OFFBOARD, in the multicopter state.
bool AlulaGuidance::flies()
{
	vehicle_status_s status{};
	return _status_sub.copy(&status) && status.arming_state == vehicle_status_s::ARMING_STATE_ARMED
	       && status.nav_state == vehicle_status_s::NAVIGATION_STATE_OFFBOARD
	       && status.vehicle_type == vehicle_status_s::VEHICLE_TYPE_ROTARY_WING && !status.in_transition_mode;
}

// The flight begins from what the vehicle does: with the thrust and the rates that were commanded last.
void AlulaGuidance::begin(hrt_abstime now)
{
	vehicle_rates_setpoint_s last{};
	_rates_setpoint_sub.copy(&last);
	_published = last.timestamp;
	const float rates[3] = {last.roll, last.pitch, last.yaw};
	fill_state(now);
	alula_take_over(&_controller, &_input, -last.thrust_body[2], rates);
	// Until somebody asks for something: a stop.
	_goal.kind = ALULA_GOAL_STOP;
}

// Two that command one vehicle lose it. In attitude output the rates are those of PX4's attitude controller.
bool AlulaGuidance::somebody_else_commands(hrt_abstime now)
{
	vehicle_rates_setpoint_s last{};

	if (_flying && _output == Output::Rates && _rates_setpoint_sub.copy(&last) && last.timestamp > _published) {
		_other_at = now;
		_published = last.timestamp;
	}

	return _other_at != 0 && now - _other_at < YIELD;
}

void AlulaGuidance::fill_state(hrt_abstime now)
{
	vehicle_attitude_s attitude{};
	vehicle_acceleration_s acceleration{};
	vehicle_local_position_s position{};
	wind_s wind{};
	const bool told = _attitude_sub.copy(&attitude) && _local_position_sub.copy(&position);
	memcpy(_input.quaternion, attitude.q, sizeof(_input.quaternion));

	// An invalid velocity is passed on as NaN: alula holds the last command, and then gives the safe one.
	const bool valid = told && position.v_xy_valid && position.v_z_valid;
	_input.velocity[0] = valid ? position.vx : NAN;
	_input.velocity[1] = valid ? position.vy : NAN;
	_input.velocity[2] = valid ? position.vz : NAN;
	_input.state_age = age(now, attitude.timestamp < position.timestamp ? attitude.timestamp : position.timestamp);

	const bool windy = _wind_sub.copy(&wind) && age(now, wind.timestamp) < OLD_WIND;
	_input.flags = windy ? 0 : ALULA_AIR_UNKNOWN;
	_input.air[0] = wind.windspeed_north;
	_input.air[1] = wind.windspeed_east;
	_input.air[2] = 0.0f;

	if (_acceleration_sub.copy(&acceleration) && age(now, acceleration.timestamp) < OLD_FORCE) {
		memcpy(_input.specific_force, acceleration.xyz, sizeof(_input.specific_force));
		_input.flags |= ALULA_SPECIFIC_FORCE;
	}
}

// A trajectory set-point, while it comes; else the goal.
void AlulaGuidance::fill_reference(hrt_abstime now, float dt)
{
	vehicle_local_position_s position{};
	trajectory_setpoint_s setpoint{};
	const bool placed = _local_position_sub.copy(&position) && position.xy_valid && position.z_valid;
	const float at[3] = {position.x, position.y, position.z};
	const bool led = _trajectory_setpoint_sub.copy(&setpoint) && age(now, setpoint.timestamp) < CEASED;
	_input.heading = NAN;

	if (!led) {
		// Without a place the velocity alone is held.
		alula_goal_step(&_goal, at, dt, &_input);

		if (!placed) {
			_input.flags &= ~static_cast<uint32_t>(ALULA_POSITION);
		}

		return;
	}

	// Each axis by itself: one with a position is held there, one with a velocity flies at it, and one with neither stops. A yaw
	// that is NaN leaves the heading to the course; in cruise the course has it anyway.
	const bool held = any_finite(setpoint.position);
	const bool asked = held || any_finite(setpoint.velocity);
	_input.flags &= ~static_cast<uint32_t>(ALULA_HOLD_ALTITUDE_ONLY);

	if (held && placed) {
		_input.flags |= ALULA_POSITION;
	}

	for (int n = 0; n < 3; n++) {
		_input.position_error[n] = isfinite(setpoint.position[n]) ? at[n] - setpoint.position[n] : 0.0f;
		_input.reference_velocity[n] = asked && !isfinite(setpoint.velocity[n]) ? 0.0f : setpoint.velocity[n];
		_input.reference_acceleration[n] = isfinite(setpoint.acceleration[n]) ? setpoint.acceleration[n] : 0.0f;
	}

	_input.heading = setpoint.yaw;
	_input.reference_age = age(now, setpoint.timestamp);
}

// Thrust is along minus z of the multicopter's axes. On the ground there is none.
void AlulaGuidance::publish(hrt_abstime now, bool landed)
{
	const float thrust = landed ? 0.0f : -_command.thrust_normalised;

	if (_output == Output::Attitude) {
		vehicle_attitude_setpoint_s setpoint{};
		setpoint.timestamp = now;
		memcpy(setpoint.q_d, _command.quaternion, sizeof(setpoint.q_d));
		setpoint.thrust_body[2] = thrust;
		_attitude_setpoint_pub.publish(setpoint);
		return;
	}

	vehicle_rates_setpoint_s setpoint{};
	setpoint.timestamp = now;
	setpoint.roll = _command.body_rate[0];
	setpoint.pitch = _command.body_rate[1];
	setpoint.yaw = _command.body_rate[2];
	setpoint.thrust_body[2] = thrust;
	_rates_setpoint_pub.publish(setpoint);
	_published = now;
}

int AlulaGuidance::task_spawn(int argc, char *argv[])
{
	const bool attitude = argc > 1 && strcmp(argv[1], "attitude") == 0;
	AlulaGuidance *instance = new AlulaGuidance(attitude ? Output::Attitude : Output::Rates);

	if (instance == nullptr) {
		PX4_ERR("alloc failed");
		return PX4_ERROR;
	}

	_object.store(instance);
	_task_id = task_id_is_work_queue;

	if (instance->init()) {
		return PX4_OK;
	}

	PX4_ERR("no vehicle_attitude");
	delete instance;
	_object.store(nullptr);
	_task_id = -1;
	return PX4_ERROR;
}

int AlulaGuidance::custom_command(int argc, char *argv[])
{
	const bool hover = strcmp(argv[0], "hover") == 0, velocity = strcmp(argv[0], "velocity") == 0;

	if (!hover && !velocity && strcmp(argv[0], "stop_here") != 0) {
		return print_usage("unknown command");
	}

	if ((hover || velocity) && argc != 4) {
		return print_usage("north, east and down are needed");
	}

	AlulaGuidance *instance = get_instance();

	if (!is_running() || instance == nullptr) {
		PX4_WARN("not running");
		return PX4_ERROR;
	}

	if (instance->_asked.load()) {
		PX4_WARN("the last one is not taken yet: is there an attitude?");
		return PX4_ERROR;
	}

	instance->_ask.kind = hover ? ALULA_GOAL_HOVER : velocity ? ALULA_GOAL_VELOCITY : ALULA_GOAL_STOP;

	for (int n = 0; n < 3 && n + 1 < argc; n++) {
		instance->_ask.target[n] = strtof(argv[n + 1], nullptr);
	}

	instance->_asked.store(true);
	return PX4_OK;
}

int AlulaGuidance::print_status()
{
	PX4_INFO("%s, %s: %s", _output == Output::Rates ? "rates" : "attitude", _flying ? "flies" : "waits for OFFBOARD",
		 alula_strerror(_flying ? _code : _made));
	PX4_INFO("mode %u, phase %u, thrust %.2f, flags 0x%x", static_cast<unsigned>(_report.mode),
		 static_cast<unsigned>(_report.phase), static_cast<double>(_command.thrust_normalised),
		 static_cast<unsigned>(_command.status));

	if (_other_at != 0) {
		PX4_WARN("somebody else published vehicle_rates_setpoint %.1f s ago: stop it", static_cast<double>(age(hrt_absolute_time(), _other_at)));
	}

	perf_print_counter(_loop_perf);
	return 0;
}

int AlulaGuidance::print_usage(const char *reason)
{
	if (reason) {
		PX4_WARN("%s\n", reason);
	}

	PRINT_MODULE_DESCRIPTION(
		R"DESCR_STR(
### Description
Guidance of a tail-sitter at any angle of attack, in OFFBOARD and the multicopter state. It streams OFFBOARD's set-points itself:
nothing needs to be stopped but other senders of OFFBOARD's set-points. Follows trajectory_setpoint, or what is asked for here.

### Examples
$ alula_guidance start
$ commander mode offboard
$ alula_guidance velocity 12 0 0
$ alula_guidance stop_here
)DESCR_STR");

	PRINT_MODULE_USAGE_NAME("alula_guidance", "controller");
	PRINT_MODULE_USAGE_COMMAND("start");
	PRINT_MODULE_USAGE_ARG("attitude", "Attitudes in place of body rates: FD_FAIL_P ends the flight beyond 60 degrees", true);
	PRINT_MODULE_USAGE_COMMAND_DESCR("hover", "Fly there and hover: north, east, down [m]");
	PRINT_MODULE_USAGE_COMMAND_DESCR("velocity", "Fly at this velocity: north, east, down [m/s]");
	PRINT_MODULE_USAGE_COMMAND_DESCR("stop_here", "Brake and hover");
	PRINT_MODULE_USAGE_DEFAULT_COMMANDS();
	return 0;
}

extern "C" __EXPORT int alula_guidance_main(int argc, char *argv[]) { return AlulaGuidance::main(argc, argv); }
