// A stand-in for PX4, not PX4: what of its platform alula_guidance.cpp calls, with PX4's names and signatures, so that it compiles and is run outside
// of PX4. The messages' headers are made of ../messages by `make`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>

using hrt_abstime = uint64_t;
hrt_abstime hrt_absolute_time(); // [us]

#define __EXPORT
#define MODULE_NAME "alula_guidance"
enum { PX4_OK = 0, PX4_ERROR = -1 };
#define PX4_INFO(...) (std::printf(__VA_ARGS__), std::printf("\n"))
#define PX4_WARN(...) (std::printf(__VA_ARGS__), std::printf("\n"))
#define PX4_ERR(...) (std::printf(__VA_ARGS__), std::printf("\n"))
#define PRINT_MODULE_DESCRIPTION(text) std::printf("%s", text)
#define PRINT_MODULE_USAGE_NAME(name, category) std::printf("%s: %s\n", name, category)
#define PRINT_MODULE_USAGE_COMMAND(name) std::printf("%s\n", name)
#define PRINT_MODULE_USAGE_COMMAND_DESCR(name, text) std::printf("%s: %s\n", name, text)
#define PRINT_MODULE_USAGE_ARG(name, text, optional) std::printf("[%s] %s\n", name, (optional) ? text : "")
#define PRINT_MODULE_USAGE_DEFAULT_COMMANDS() std::printf("stop\nstatus\n")

// uORB. What is published stands in the topic.
struct orb_metadata {
	void *last;
	size_t size;
	unsigned *count;
};
#define ORB_ID(name) (&orb_of_##name)
#define ORB_DECLARE(name, type)                  \
	extern type last_##name;                     \
	extern unsigned count_##name;                \
	extern const orb_metadata orb_of_##name
#define ORB_DEFINE(name, type)                   \
	type last_##name{};                          \
	unsigned count_##name{};                     \
	const orb_metadata orb_of_##name { &last_##name, sizeof(type), &count_##name }

namespace uORB
{
class Subscription
{
public:
	Subscription(const orb_metadata *meta) : _meta(meta) {}
	bool copy(void *to)
	{
		std::memcpy(to, _meta->last, _meta->size);
		_seen = *_meta->count;
		return _seen > 0;
	}
	bool updated() const { return *_meta->count != _seen; }

private:
	const orb_metadata *_meta;
	unsigned _seen{};
};

template <typename T> class Publication
{
public:
	Publication(const orb_metadata *meta) : _meta(meta) {}
	bool publish(const T &message)
	{
		std::memcpy(_meta->last, &message, sizeof(T));
		(*_meta->count)++;
		return true;
	}

private:
	const orb_metadata *_meta;
};
} // namespace uORB

namespace px4
{
struct wq_config_t {
	const char *name;
	uint16_t stacksize;
	int8_t relative_priority;
};

class WorkItem
{
public:
	WorkItem(const char *, const wq_config_t &) {}
	virtual ~WorkItem() = default;

protected:
	virtual void Run() = 0;
	friend struct Queue;
};

// What calls a work item here.
struct Queue {
	static void run(WorkItem &item) { item.Run(); }
};

class atomic_bool
{
public:
	atomic_bool(bool value) : _value(value) {}
	bool load() const { return _value; }
	void store(bool value) { _value = value; }

private:
	bool _value;
};
} // namespace px4

namespace uORB
{
class SubscriptionCallbackWorkItem : public Subscription
{
public:
	SubscriptionCallbackWorkItem(px4::WorkItem *, const orb_metadata *meta) : Subscription(meta) {}
	void set_interval_us(uint32_t) {}
	bool registerCallback() { return true; }
	void unregisterCallback() {}
};
} // namespace uORB

template <class T> class ModuleBase
{
public:
	virtual ~ModuleBase() = default;
	static int main(int argc, char *argv[])
	{
		if (argc < 2)
			return T::print_usage();
		if (std::strcmp(argv[1], "start") == 0)
			return T::task_spawn(argc - 1, argv + 1);
		if (std::strcmp(argv[1], "status") == 0)
			return _object.load()->print_status();
		if (std::strcmp(argv[1], "stop") == 0) {
			_object.load()->_exits = true;
			return 0;
		}
		return T::custom_command(argc - 1, argv + 1);
	}
	virtual int print_status() { return 0; }
	static T *get_instance() { return _object.load(); }
	static bool is_running() { return _task_id != -1; }

protected:
	struct Object {
		T *load() const { return value; }
		void store(T *to) { value = to; }
		T *value;
	};
	bool should_exit() const { return _exits; }
	static void exit_and_cleanup()
	{
		delete _object.load();
		_object.store(nullptr);
		_task_id = -1;
	}
	static Object _object;
	static int _task_id;
	static constexpr int task_id_is_work_queue = -2;

private:
	bool _exits{false};
};
template <class T> typename ModuleBase<T>::Object ModuleBase<T>::_object{};
template <class T> int ModuleBase<T>::_task_id = -1;

// Performance counters count nothing here.
using perf_counter_t = void *;
enum { PC_ELAPSED };
inline perf_counter_t perf_alloc(int, const char *) { return nullptr; }
inline void perf_free(perf_counter_t) {}
inline void perf_begin(perf_counter_t) {}
inline void perf_end(perf_counter_t) {}
inline void perf_print_counter(perf_counter_t) {}

// Parameters. run.cpp has them.
using param_t = uint32_t;
param_t param_find(const char *name);
int param_get(param_t parameter, void *value);
