// The life of a robot: open, start, stop, close.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "hal/bring_up/bring_up.hpp"
#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/c/sized.hpp"
#include "hal/c/text.hpp"
#include "hal/config/config.hpp"
#include "hal/config/settings.hpp"
#include "hal/file/file_place.hpp"
#include "hal/file/output_file.hpp"
#include "hal/file/port_descriptor.hpp"
#include "hal/port/open_port.hpp"
#include "hal/stream/spaced_stream.hpp"
#include "oi/dialect.hpp"

namespace cargobay::c {
namespace {

// How long to wait for cargobay_start() and cargobay_stop() on another thread.
constexpr std::chrono::seconds kOthersEnd{3};
constexpr std::uint32_t kKnownFlags = CARGOBAY_REQUIRE_REALTIME | CARGOBAY_NO_GUARD |
                                      CARGOBAY_HOLD_ON_MODE_LOSS | CARGOBAY_OPEN_LOOP |
                                      CARGOBAY_PIN_CPU | CARGOBAY_NO_CONFIG;

bool has(const cargobay_options& options, cargobay_flag flag) {
  return (options.flags & static_cast<std::uint32_t>(flag)) != 0;
}
struct Setting {
  const char* name = "";
  double value = 0.0;
  hal::Range range{};
};

// Empty if everything is in range.
std::string complaint(const cargobay_options& options) {
  if ((options.flags & ~kKnownFlags) != 0)
    return "`flags` has bits that this library does not know; use a newer library";
  if (options.port != nullptr && options.sim != nullptr)
    return "a robot has a `port` or a `sim`, not both";
  if (options.mode != 0 && options.mode != CARGOBAY_MODE_SAFE && options.mode != CARGOBAY_MODE_FULL)
    return "`mode` must be CARGOBAY_MODE_SAFE or CARGOBAY_MODE_FULL: it drives in no other";
  if (options.remainder < CARGOBAY_REMAINDER_UNKNOWN || options.remainder > CARGOBAY_REMAINDER_LOST)
    return "`remainder` must be one of enum cargobay_remainder";
  if (options.baud != 0 && !oi::kCreate.baud_code(options.baud))
    return "`baud` must be one of the robot's rates: 57600, 19200, ...";
  if (has(options, CARGOBAY_PIN_CPU) && !hal::kCpu.contains(options.cpu))
    return "`cpu` must be " + hal::kCpu.words();
  for (const Setting& setting : std::to_array<Setting>({
           {"priority", static_cast<double>(options.priority), hal::kPriority},
           {"setpoint_lapse_ms", static_cast<double>(options.setpoint_lapse_ms),
            hal::kSetpointLapseMs},
           {"control_budget_us", static_cast<double>(options.control_budget_us),
            hal::kControlBudgetUs},
           {"control_overruns", static_cast<double>(options.control_overruns),
            hal::kControlOverruns},
           {"link_timeout_ms", static_cast<double>(options.link_timeout_ms), hal::kLinkTimeoutMs},
           {"guard_deadline_ms", static_cast<double>(options.guard_deadline_ms),
            hal::kGuardDeadlineMs},
           {"acceleration_mm_s2", options.acceleration_mm_s2, hal::kAccelerationMmS2},
           {"jerk_mm_s3", options.jerk_mm_s3, hal::kJerkMmS3},
           {"wheel_base_mm", options.wheel_base_mm, hal::kWheelBaseMm},
           {"distance_scale", options.distance_scale, hal::kScale},
           {"turn_scale", options.turn_scale, hal::kScale},
       })) {
    if (setting.value != 0.0 && !setting.range.contains(setting.value))
      return "`" + std::string{setting.name} + "` must be " + setting.range.words() +
             ", or 0 for the default";
  }
  return "";
}

// The program's options override the file's.
void lay_over(const cargobay_options& options, hal::Config& config) {
  if (options.port != nullptr) config.port = options.port;
  if (options.baud != 0) config.baud = options.baud;
  if (options.priority != 0) config.priority = options.priority;
  if (has(options, CARGOBAY_PIN_CPU)) config.cpu = options.cpu;
  if (has(options, CARGOBAY_REQUIRE_REALTIME)) config.require_realtime = true;
  if (options.acceleration_mm_s2 != 0.0) config.acceleration_mm_s2 = options.acceleration_mm_s2;
  if (options.jerk_mm_s3 != 0.0) config.jerk_mm_s3 = options.jerk_mm_s3;
  if (options.wheel_base_mm != 0.0) config.wheel_base_mm = options.wheel_base_mm;
  if (options.distance_scale != 0.0) config.distance_scale = options.distance_scale;
  if (options.turn_scale != 0.0) config.turn_scale = options.turn_scale;
  if (options.remainder == CARGOBAY_REMAINDER_CARRIED) config.remainder = rt::Remainder::carried;
  if (options.remainder == CARGOBAY_REMAINDER_LOST) config.remainder = rt::Remainder::lost;
}

hal::RobotOptions robot_options(const cargobay_options& options, const hal::Config& config) {
  using std::chrono::milliseconds;
  hal::RobotOptions robot;
  hal::apply(config, robot.cycle);
  hal::ControlCycle::Parameters& cycle = robot.cycle;
  if (has(options, CARGOBAY_OPEN_LOOP)) cycle.loop.feedback = rt::WheelLoop::Feedback::open;
  if (options.mode == CARGOBAY_MODE_FULL) cycle.drive_mode = oi::Mode::full;
  if (has(options, CARGOBAY_HOLD_ON_MODE_LOSS)) cycle.on_mode_loss = hal::OnModeLoss::hold;
  if (options.setpoint_lapse_ms != 0)
    cycle.setpoint_lapse = milliseconds{options.setpoint_lapse_ms};
  if (options.control_budget_us != 0)
    cycle.control_budget = std::chrono::microseconds{options.control_budget_us};
  if (options.control_overruns != 0)
    cycle.control_overruns_allowed = static_cast<int>(options.control_overruns);
  if (options.link_timeout_ms != 0) cycle.link_timeout = milliseconds{options.link_timeout_ms};
  robot.realtime = {.priority = config.priority.value_or(rt::RealtimeRequest{}.priority),
                    .cpu = config.cpu};
  robot.require_realtime = config.require_realtime;
  if (has(options, CARGOBAY_NO_GUARD)) robot.guard.use = hal::GuardOptions::Use::none;
  if (options.guard_deadline_ms != 0)
    robot.guard.deadline = milliseconds{options.guard_deadline_ms};
  if (options.progress != nullptr) {
    robot.progress = [tell = options.progress,
                      context = options.progress_context](const hal::BringUpEvent& event) {
      tell(context, event.step.c_str(), event.detail.c_str());
    };
  }
  return robot;
}

// The virtual Create's end of the line, or a code.
int take_sim(const cargobay_options& options, std::uint32_t baud, RobotObject& object,
             std::unique_ptr<hal::ByteStream>& stream) {
  object.sim = sims().use(options.sim);
  if (!object.sim) return bad_sim(options.sim);
  if (object.sim->taken.exchange(true)) {
    object.sim = {};  // ownership stays
    return fail(CARGOBAY_E_STATE,
                "another robot already uses this virtual Create; close it, or open a second one");
  }
  object.virtual_time = object.sim->in_virtual_time();
  if (object.virtual_time) {
    hal::sim::VirtualLink& link = *object.sim->link;
    link.discard_input();
    if (link.set_baud(baud)) return bad_argument("`baud` cannot be set");
    if (link.set_wake_threshold(1)) return bad_argument("the link cannot be set up");
    stream = std::make_unique<hal::SpacedStream>(link);  // the virtual Create still owns the link
    return CARGOBAY_OK;
  }
  auto opened = hal::open_port(object.sim->server->path(), baud);
  if (!opened) return fail(CARGOBAY_E_PORT, opened.failure());
  stream = std::move(opened->stream);
  return CARGOBAY_OK;
}

int take_port(const hal::Config& config, std::uint32_t baud, hal::RobotOptions& options,
              RobotObject& object, std::unique_ptr<hal::ByteStream>& stream) {
  auto plant = hal::find_plant(config, {}, hal::below_loop(options.realtime.priority));
  if (!plant)
    return fail(config.port.empty() ? CARGOBAY_E_SYSTEM : CARGOBAY_E_PORT, plant.failure());
  object.plant = std::move(*plant);
  options.pins = object.plant.pins();
  auto opened = hal::open_port(object.plant.port, baud);
  if (!opened) return fail(CARGOBAY_E_PORT, opened.failure());
  stream = std::move(opened->stream);
  return CARGOBAY_OK;
}

// Called before anything is sent to the robot.
int open_record(const cargobay_options& options, RobotObject& object) {
  if (options.record == nullptr) return CARGOBAY_OK;
  auto file = hal::OutputFile::open(options.record);
  if (!file) return fail(CARGOBAY_E_SYSTEM, file.failure());
  if (!has(options, CARGOBAY_NO_CONFIG)) {
    for (const std::string& config :
         hal::config_files(options.config != nullptr ? options.config : "")) {
      if (same_file(file->place(), hal::place_of(config)))
        return bad_argument("`record` is the configuration; name another file");
    }
  }
  object.record_file.emplace(std::move(*file));
  return CARGOBAY_OK;
}

int open_robot(const cargobay_options& options, cargobay_robot** handle) {
  if (const std::string wrong = complaint(options); !wrong.empty())
    return fail(CARGOBAY_E_ARGUMENT, wrong);
  hal::Config config;
  if (!has(options, CARGOBAY_NO_CONFIG)) {
    auto loaded = hal::load_config(options.config != nullptr ? options.config : "");
    if (!loaded) return fail(CARGOBAY_E_CONFIG, loaded.failure());
    config = std::move(*loaded);
  }
  lay_over(options, config);
  const std::uint32_t baud = config.baud.value_or(oi::kCreate.default_baud);
  if (!oi::kCreate.baud_code(baud))
    return fail(CARGOBAY_E_CONFIG, "the robot does not support " + std::to_string(baud) +
                                       " baud, which the configuration asks for; use 57600");
  hal::RobotOptions wanted = robot_options(options, config);
  auto object = std::make_unique<RobotObject>();
  if (const int unopened = open_record(options, *object); unopened != CARGOBAY_OK) return unopened;
  std::unique_ptr<hal::ByteStream> stream;
  const int failed = options.sim != nullptr ? take_sim(options, baud, *object, stream)
                                            : take_port(config, baud, wanted, *object, stream);
  if (failed != CARGOBAY_OK) return failed;
  object->wheel_base_mm = wanted.cycle.loop.estimator.wheel_base_mm;
  auto opened = hal::Robot::open(std::move(stream), wanted);
  if (!opened) return fail(CARGOBAY_E_ROBOT, opened.failure());
  object->robot = std::move(*opened);
  *handle = static_cast<cargobay_robot*>(robots().open(std::move(object)));
  if (*handle == nullptr)
    return fail(CARGOBAY_E_SYSTEM, "64 robots are open; close those that are not used");
  return CARGOBAY_OK;
}

int record(RobotObject& object) {
  if (!object.record_file) return CARGOBAY_OK;
  hal::RecordingHeader header = object.robot->recording_header();
  header.software = "libcargobay " CARGOBAY_VERSION;
  auto writer = hal::RecordingWriter::create(std::move(*object.record_file), header,
                                             object.robot->flight_recorder());
  object.record_file.reset();
  if (!writer) return fail(CARGOBAY_E_SYSTEM, writer.failure());
  object.recording = std::move(*writer);
  return CARGOBAY_OK;
}

// Called once the loop runs: a start that fails leaves an older recording untouched.
int publish_record(RobotObject& object) {
  if (!object.recording) return CARGOBAY_OK;
  object.recording->publish();
  if (object.virtual_time) return CARGOBAY_OK;
  if (const std::error_code error = object.recording->start(); error) {
    return fail(CARGOBAY_E_SYSTEM, "cannot start the thread that records: " + error.message() +
                                       "; raise the limit of threads");
  }
  return CARGOBAY_OK;
}

void end(RobotObject& object) {
  if (!object.farewell) object.farewell = object.robot->stop();
  object.life.store(RobotObject::Life::stopped, std::memory_order_release);
  if (!object.recording) return;
  if (const auto& done = object.recording->finish(); !done)
    object.unrecorded_why = done.failure().message;
}

int start(RobotObject& object) {
  const hal::StandardNumbersTaken taken;
  if (object.life.load() != RobotObject::Life::open) {
    return fail(CARGOBAY_E_STATE,
                "the loop was started before; a robot starts only once: open a new one");
  }
  if (const int failed = record(object); failed != CARGOBAY_OK) {
    end(object);
    return failed;
  }
  const hal::ControlFunction control =
      object.control == nullptr
          ? hal::ControlFunction{}
          : hal::ControlFunction{.function = &call_control, .context = &object};
  if (object.virtual_time) {
    object.robot->start_stepped(control);
    object.grant.emplace();
  } else {
    auto grant = object.robot->start(control);
    if (!grant) {
      end(object);
      const bool refused = grant.failure().code == std::errc::operation_not_permitted;
      return fail(refused ? CARGOBAY_E_RIGHTS : CARGOBAY_E_SYSTEM, grant.failure());
    }
    object.grant = *grant;
  }
  if (const int failed = publish_record(object); failed != CARGOBAY_OK) {
    end(object);
    return failed;
  }
  object.life.store(RobotObject::Life::running, std::memory_order_release);
  return CARGOBAY_OK;
}

int stop(RobotObject& object) {
  if (const int early = object.must_be_started(); early != CARGOBAY_OK) return early;
  end(object);
  const hal::Robot::Farewell& farewell = *object.farewell;
  if (const int code = object.end_of_loop(farewell); code != CARGOBAY_OK) return code;
  if (!farewell.robot.standing()) return fail(CARGOBAY_E_ROBOT, hal::explain(farewell));
  if (!object.unrecorded_why.empty()) return fail(CARGOBAY_E_SYSTEM, object.unrecorded_why);
  return CARGOBAY_OK;
}

// Runs `function` on the robot for the thread that currently owns it.
template <typename Function>
int owned(cargobay_robot* robot, const char* name, const Function& function) {
  if (in_control()) return not_from_control(name);
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    const std::unique_lock lock{use->owner, std::try_to_lock};
    if (!lock) {
      return fail(CARGOBAY_E_STATE,
                  "another thread is in a function that belongs to this robot's owner; let one "
                  "thread own it");
    }
    return function(*use);
  });
}

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below

extern "C" {

int cargobay_open(const struct cargobay_options* options, struct cargobay_robot** robot) {
  if (robot == nullptr) return bad_argument("`robot` is NULL: give the address of a pointer");
  *robot = nullptr;
  if (in_control()) return not_from_control("cargobay_open");
  cargobay_options known{};
  if (options != nullptr && !take(options, known)) {
    return bad_argument(
        "cargobay_options: set `size` to its sizeof, and unused members to 0; a newer program's "
        "options need a newer library");
  }
  return guarded([&] {
    const cargobay::hal::StandardNumbersTaken taken;
    return open_robot(known, robot);
  });
}

int cargobay_close(struct cargobay_robot* robot) {
  if (in_control()) return not_from_control("cargobay_close");
  return guarded([&] {
    bool lost = false;
    auto closed = robots().close(robot, [&lost](RobotObject& object) {
      object.robot->cycle().request_stop();
      const std::unique_lock lock{object.owner, kOthersEnd};
      if (lock) end(object);
      lost = !lock || object.robot->lost();
      return !lost;
    });
    if (!closed) return bad_robot(robot);
    if (!lost) return static_cast<int>(CARGOBAY_OK);
    keep(std::move(closed));
    return fail(CARGOBAY_E_STALLED,
                "the control function has not returned; the handle is closed, and the robot was "
                "stopped without it, but the thread and what it uses stay: end the program");
  });
}

int cargobay_set_control(struct cargobay_robot* robot, cargobay_control control, void* context) {
  return owned(robot, "cargobay_set_control", [&](RobotObject& object) {
    if (object.life.load() != RobotObject::Life::open) {
      return fail(CARGOBAY_E_STATE,
                  "the loop was already started; set a control function before that");
    }
    object.control = control;
    object.context = context;
    return static_cast<int>(CARGOBAY_OK);
  });
}

int cargobay_start(struct cargobay_robot* robot) {
  return owned(robot, "cargobay_start", [](RobotObject& object) { return start(object); });
}

int cargobay_stop(struct cargobay_robot* robot) {
  return owned(robot, "cargobay_stop", [](RobotObject& object) { return stop(object); });
}

int cargobay_request_stop(struct cargobay_robot* robot) {
  const RobotUse use = robots().use(robot);
  if (!use) return CARGOBAY_E_HANDLE;  // a message is not for signal handlers
  use->robot->cycle().request_stop();
  return CARGOBAY_OK;
}

int cargobay_get_bring_up(struct cargobay_robot* robot, struct cargobay_bring_up* bring_up) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  const cargobay::hal::BringUpReport& report = use->robot->bring_up_report();
  cargobay_bring_up known{};
  known.found_baud = report.found_baud;
  known.baud = use->robot->baud();
  known.rate_change = static_cast<std::int32_t>(report.rate_change);
  known.powered_on = report.powered_on ? 1 : 0;
  known.resynchronised = report.resynchronised ? 1 : 0;
  known.brc_pulses =
      static_cast<std::int32_t>(std::ranges::count_if(report.brc.pulses(), [](const auto& played) {
        return played.wanted.level == cargobay::gpio::Level::low;
      }));
  known.battery_mv = report.battery_mv;
  known.took_ns = report.took.count();
  return give(known, bring_up) ? static_cast<int>(CARGOBAY_OK) : bad_argument(kBadOut);
}

}  // extern "C"
