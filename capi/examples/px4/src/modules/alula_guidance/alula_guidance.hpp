// A PX4 module: alula flies a tail-sitter in OFFBOARD, from hover to cruise, in one law.
#pragma once

#include <alula.h>

#include <drivers/drv_hrt.h>
#include <lib/perf/perf_counter.h>
#include <px4_platform_common/atomic.h>
#include <px4_platform_common/module.h>
#include <px4_platform_common/px4_work_queue/WorkItem.hpp>
#include <uORB/Publication.hpp>
#include <uORB/Subscription.hpp>
#include <uORB/SubscriptionCallback.hpp>
#include <uORB/topics/offboard_control_mode.h>
#include <uORB/topics/parameter_update.h>
#include <uORB/topics/trajectory_setpoint.h>
#include <uORB/topics/vehicle_acceleration.h>
#include <uORB/topics/vehicle_attitude.h>
#include <uORB/topics/vehicle_attitude_setpoint.h>
#include <uORB/topics/vehicle_land_detected.h>
#include <uORB/topics/vehicle_local_position.h>
#include <uORB/topics/vehicle_rates_setpoint.h>
#include <uORB/topics/vehicle_status.h>
#include <uORB/topics/wind.h>

class AlulaGuidance : public ModuleBase<AlulaGuidance>, public px4::WorkItem
{
public:
	// What is published: body rates, or attitudes.
	enum class Output { Rates, Attitude };

	explicit AlulaGuidance(Output output);
	~AlulaGuidance() override;

	static int task_spawn(int argc, char *argv[]);
	static int custom_command(int argc, char *argv[]);
	static int print_usage(const char *reason = nullptr);
	int print_status() override;

	bool init();

private:
	void Run() override;
	void initialise();
	bool flies();
	void fill_state(hrt_abstime now);
	void fill_reference(hrt_abstime now, float dt);
	void begin(hrt_abstime now);
	bool somebody_else_commands(hrt_abstime now);
	void publish(hrt_abstime now, bool landed);

	// What `alula_guidance velocity` and so on ask for, on its way to the work queue: written while `_asked` is false, read while it is true.
	alula_goal _ask{};
	px4::atomic_bool _asked{false};

	const Output _output;
	uORB::SubscriptionCallbackWorkItem _attitude_sub{this, ORB_ID(vehicle_attitude)};
	uORB::Subscription _acceleration_sub{ORB_ID(vehicle_acceleration)};
	uORB::Subscription _land_detected_sub{ORB_ID(vehicle_land_detected)};
	uORB::Subscription _local_position_sub{ORB_ID(vehicle_local_position)};
	uORB::Subscription _parameter_update_sub{ORB_ID(parameter_update)};
	uORB::Subscription _rates_setpoint_sub{ORB_ID(vehicle_rates_setpoint)};
	uORB::Subscription _status_sub{ORB_ID(vehicle_status)};
	uORB::Subscription _trajectory_setpoint_sub{ORB_ID(trajectory_setpoint)};
	uORB::Subscription _wind_sub{ORB_ID(wind)};
	uORB::Publication<offboard_control_mode_s> _offboard_control_mode_pub{ORB_ID(offboard_control_mode)};
	uORB::Publication<vehicle_attitude_setpoint_s> _attitude_setpoint_pub{ORB_ID(mc_virtual_attitude_setpoint)};
	uORB::Publication<vehicle_rates_setpoint_s> _rates_setpoint_pub{ORB_ID(vehicle_rates_setpoint)};

	perf_counter_t _loop_perf{perf_alloc(PC_ELAPSED, MODULE_NAME": cycle")};

	alula_controller _controller{};
	alula_table _table{};
	alula_input _input{};
	alula_command _command{};
	alula_report _report{};
	alula_goal _goal{};
	int32_t _made{ALULA_ERROR_NOT_INITIALISED}; // why there is no controller
	int32_t _code{ALULA_ERROR_NOT_INITIALISED}; // of the last step
	hrt_abstime _last_run{0};
	hrt_abstime _published{0};  // the rates that were published last
	hrt_abstime _other_at{0};   // somebody else's
	bool _flying{false};
};
