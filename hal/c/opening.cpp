#include "hal/c/opening.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <span>
#include <utility>

#include "hal/bring_up/bring_up.hpp"
#include "hal/c/errors.hpp"
#include "hal/c/handles.hpp"
#include "hal/config/config.hpp"
#include "hal/config/setting_table.hpp"
#include "hal/config/settings.hpp"
#include "hal/file/file_place.hpp"
#include "hal/learnt/learnt_place.hpp"
#include "hal/port/open_port.hpp"
#include "hal/stream/spaced_stream.hpp"
#include "hal/trouble.hpp"
#include "oi/dialect.hpp"

namespace cargobay::c {
namespace {

constexpr std::uint32_t kKnownFlags =
    CARGOBAY_FLAG_REQUIRE_REALTIME | CARGOBAY_FLAG_NO_REALTIME | CARGOBAY_FLAG_NO_GUARD |
    CARGOBAY_FLAG_HOLD_ON_MODE_LOSS | CARGOBAY_FLAG_OPEN_LOOP | CARGOBAY_FLAG_PIN_CPU |
    CARGOBAY_FLAG_NO_CONFIG | CARGOBAY_FLAG_NO_LEARNT | CARGOBAY_FLAG_FORGET |
    CARGOBAY_FLAG_HOLD_HEADING | CARGOBAY_FLAG_DRIVE_ON | CARGOBAY_FLAG_PUBLISH;
constexpr int kLeastDescriptor = 3;

bool has(const cargobay_options& options, cargobay_flag flag) {
  return (options.flags & static_cast<std::uint32_t>(flag)) != 0;
}
const char* or_empty(const char* text) { return text != nullptr ? text : ""; }

struct Number {
  const char* name = "";
  double value = 0.0;
  hal::Range range{};
  std::span<const hal::Mistake> mistakes{};
  bool negative_is_none = false;
};

// A number that the configuration has too.
Number setting(const char* name, double value, bool negative_is_none = false) {
  const hal::Setting& row = hal::setting_named(name);
  return {name, value, row.range.value_or(hal::Range{}), row.mistakes, negative_is_none};
}
Number time(const char* name, std::int64_t time_ns, const hal::Range& range_ns) {
  return {name, static_cast<double>(time_ns), range_ns, hal::kNotNs};
}

// Empty if everything is in range.
std::string out_of_range(const cargobay_options& options) {
  constexpr double kNsPerMs = 1e6;
  constexpr double kNsPerUs = 1e3;
  for (const Number& number : std::to_array<Number>({
           setting("priority", static_cast<double>(options.priority), true),
           {"control_overruns", static_cast<double>(options.control_overruns),
            hal::kControlOverruns},
           time("setpoint_lapse_ns", options.setpoint_lapse_ns,
                hal::kSetpointLapseMs.times(kNsPerMs)),
           time("control_budget_ns", options.control_budget_ns,
                hal::kControlBudgetUs.times(kNsPerUs)),
           time("link_timeout_ns", options.link_timeout_ns, hal::kLinkTimeoutMs.times(kNsPerMs)),
           time("guard_deadline_ns", options.guard_deadline_ns,
                hal::kGuardDeadlineMs.times(kNsPerMs)),
           setting("acceleration_mm_s2", options.acceleration_mm_s2),
           setting("jerk_mm_s3", options.jerk_mm_s3, true),
           setting("wheel_base_mm", options.wheel_base_mm),
           setting("distance_scale", options.distance_scale),
           setting("turn_scale", options.turn_scale),
       })) {
    if (number.value == 0.0 || (number.negative_is_none && number.value < 0.0)) continue;
    if (!number.range.contains(number.value)) {
      return "`" + std::string{number.name} + "` must be " + number.range.words() +
             (number.negative_is_none ? ", negative for none," : ",") + " or 0 for the default" +
             hal::likely_meaning(number.range, number.mistakes, number.value);
    }
  }
  return "";
}

// Empty if the options make sense.
std::string complaint(const cargobay_options& options) {
  if ((options.flags & ~kKnownFlags) != 0)
    return "`flags` has bits that this library does not know; use a newer library";
  if (has(options, CARGOBAY_FLAG_REQUIRE_REALTIME) && has(options, CARGOBAY_FLAG_NO_REALTIME))
    return "`flags` both requires and refuses real-time rights; leave one out";
  const int ways = (options.port != nullptr ? 1 : 0) + (options.sim != nullptr ? 1 : 0) +
                   (options.port_fd != 0 ? 1 : 0);
  if (ways > 1) return "a robot has one of `port`, `port_fd` and `sim`; set the others to 0";
  if (options.port_fd != 0 && options.port_fd < kLeastDescriptor)
    return "`port_fd` must be an open terminal's descriptor, 3 or more, or 0 for none";
  if (options.mode != 0 && options.mode != CARGOBAY_MODE_SAFE && options.mode != CARGOBAY_MODE_FULL)
    return "`mode` must be CARGOBAY_MODE_SAFE or CARGOBAY_MODE_FULL: it drives in no other";
  if (options.remainder < CARGOBAY_REMAINDER_FIND_OUT ||
      options.remainder > CARGOBAY_REMAINDER_LOST)
    return "`remainder` must be one of enum cargobay_remainder";
  if (options.baud != 0 && !oi::kCreate.baud_code(options.baud))
    return "`baud` must be one of the robot's rates: 57600, 19200, ...";
  if (has(options, CARGOBAY_FLAG_PIN_CPU) && !hal::kCpu.contains(options.cpu))
    return "`cpu` must be " + hal::kCpu.words();
  return out_of_range(options);
}

// The program's options override the file's.
void lay_over(const cargobay_options& options, hal::Config& config) {
  std::string port = or_empty(options.port);
  if (options.port_fd != 0) port = "/proc/self/fd/" + std::to_string(options.port_fd);
  // The pins are wired to the robot at the file's port.
  if ((!port.empty() && port != config.port) || options.sim != nullptr) config.pins = {};
  if (!port.empty()) config.port = port;
  if (options.sim != nullptr) config.port.clear();
  if (options.baud != 0) config.baud = options.baud;
  if (options.priority > 0) config.priority = options.priority;
  if (has(options, CARGOBAY_FLAG_PIN_CPU)) config.cpu = options.cpu;
  if (has(options, CARGOBAY_FLAG_REQUIRE_REALTIME)) config.require_realtime = true;
  if (has(options, CARGOBAY_FLAG_NO_REALTIME)) config.require_realtime = false;
  if (options.acceleration_mm_s2 != 0.0) config.acceleration_mm_s2 = options.acceleration_mm_s2;
  if (options.jerk_mm_s3 > 0.0) config.jerk_mm_s3 = options.jerk_mm_s3;
  if (options.jerk_mm_s3 < 0.0) config.jerk_mm_s3.reset();
  if (options.wheel_base_mm != 0.0) config.wheel_base_mm = options.wheel_base_mm;
  if (options.distance_scale != 0.0) config.distance_scale = options.distance_scale;
  if (options.turn_scale != 0.0) config.turn_scale = options.turn_scale;
  if (options.remainder == CARGOBAY_REMAINDER_CARRIED) config.remainder = rt::Remainder::carried;
  if (options.remainder == CARGOBAY_REMAINDER_LOST) config.remainder = rt::Remainder::lost;
  if (options.remainder == CARGOBAY_REMAINDER_FIND_OUT) config.remainder.reset();
  if (has(options, CARGOBAY_FLAG_NO_LEARNT)) config.learnt = "none";
}

rt::RealtimeRequest realtime_request(const cargobay_options& options, const hal::Config& config) {
  rt::RealtimeRequest request{.cpu = config.cpu};
  request.priority = options.priority < 0 ? 0 : config.priority.value_or(request.priority);
  if (has(options, CARGOBAY_FLAG_NO_REALTIME)) {
    request.priority = 0;
    request.lock_memory = false;
    request.hold_dma_latency = false;
  }
  return request;
}

hal::RobotOptions robot_options(const cargobay_options& options, const hal::Config& config) {
  const auto set = [](rt::Duration& target, std::int64_t time_ns) {
    if (time_ns != 0) target = rt::Duration{time_ns};
  };
  hal::RobotOptions robot;
  hal::apply(config, robot.cycle);
  hal::ControlCycle::Parameters& cycle = robot.cycle;
  if (has(options, CARGOBAY_FLAG_HOLD_HEADING)) cycle.loop.course.hold_heading = true;
  if (has(options, CARGOBAY_FLAG_OPEN_LOOP)) cycle.loop.feedback = rt::WheelLoop::Feedback::open;
  if (options.mode == CARGOBAY_MODE_FULL) cycle.drive_mode = oi::Mode::full;
  if (has(options, CARGOBAY_FLAG_HOLD_ON_MODE_LOSS)) cycle.on_mode_loss = hal::OnModeLoss::hold;
  if (has(options, CARGOBAY_FLAG_DRIVE_ON)) cycle.on_implausible = hal::OnImplausible::report;
  set(cycle.setpoint_lapse, options.setpoint_lapse_ns);
  set(cycle.control_budget, options.control_budget_ns);
  set(cycle.link_timeout, options.link_timeout_ns);
  if (options.control_overruns != 0)
    cycle.control_overruns_allowed = static_cast<int>(options.control_overruns);
  robot.realtime = realtime_request(options, config);
  robot.require_realtime = config.require_realtime;
  if (has(options, CARGOBAY_FLAG_NO_GUARD)) robot.guard.use = hal::GuardOptions::Use::none;
  set(robot.guard.deadline, options.guard_deadline_ns);
  return robot;
}

// Files, then the program's text, then its options.
hal::Result<hal::Config> configuration(const cargobay_options& options) {
  hal::Config config;
  const bool read = options.config != nullptr ||
                    (options.sim == nullptr && !has(options, CARGOBAY_FLAG_NO_CONFIG));
  if (read) {
    auto loaded = hal::load_config(or_empty(options.config));
    if (!loaded) return loaded.failure();
    config = std::move(*loaded);
  }
  if (options.settings != nullptr) {
    if (const auto done = hal::read_config(options.settings, "settings", config); !done)
      return done.failure();
  }
  lay_over(options, config);
  const std::uint32_t baud = config.baud.value_or(oi::kCreate.default_baud);
  if (!oi::kCreate.baud_code(baud)) {
    return hal::Failure{"the robot does not support " + std::to_string(baud) +
                        " baud, which the configuration asks for; use 57600"};
  }
  return config;
}

int open_record(const cargobay_options& options, std::optional<hal::OutputFile>& record) {
  if (options.record == nullptr) return CARGOBAY_OK;
  auto file = hal::OutputFile::open(options.record);
  if (!file) return fail(CARGOBAY_E_FILE, file.failure());
  if (!has(options, CARGOBAY_FLAG_NO_CONFIG)) {
    for (const std::string& config : hal::config_files(or_empty(options.config))) {
      if (same_file(file->place(), hal::place_of(config)))
        return bad_argument("`record` is the configuration; name another file");
    }
  }
  record.emplace(std::move(*file));
  return CARGOBAY_OK;
}

int code_of_port(const std::error_code& error) {
  switch (error.value()) {
    case ENOENT:
    case ENOTDIR:
    case ENXIO:
    case ENODEV:
    case ENOTTY:
    case EISDIR:
    case EINVAL:  // not listed as a serial port
      return CARGOBAY_E_NO_PORT;
    case EBUSY: return CARGOBAY_E_BUSY;
    case EACCES:
    case EPERM: return CARGOBAY_E_ACCESS;
    case EIO: return CARGOBAY_E_UNPLUGGED;
    case EMFILE:
    case ENFILE: return CARGOBAY_E_LIMIT;
    case ENOMEM: return CARGOBAY_E_MEMORY;
    default: return CARGOBAY_E_SYSTEM;
  }
}

}  // namespace

int Opening::prepare(const cargobay_options& options, std::optional<hal::OutputFile>& record) {
  if (const std::string wrong = complaint(options); !wrong.empty())
    return fail(CARGOBAY_E_ARGUMENT, wrong);
  const auto config = configuration(options);
  if (!config) return fail(CARGOBAY_E_CONFIG, config.failure());
  wanted = robot_options(options, *config);
  baud = config->baud.value_or(oi::kCreate.default_baud);
  baud_is_the_programs = options.baud != 0;
  published = has(options, CARGOBAY_FLAG_PUBLISH);
  progress = options.progress;
  progress_context = options.progress_context;
  if (const int failed = open_record(options, record); failed != CARGOBAY_OK) return failed;
  // A virtual Create is another robot each time: it has a file only if one is named.
  wanted.learnt = hal::learnt_place(config->learnt, options.sim != nullptr ? "" : config->port);
  wanted.learnt.forget = has(options, CARGOBAY_FLAG_FORGET);
  return options.sim != nullptr ? take_sim(options) : take_plant(*config);
}

// The virtual Create's end of the line.
int Opening::take_sim(const cargobay_options& options) {
  sim = sims().use(options.sim);
  if (!sim) return bad_sim(options.sim);
  if (sim->taken.exchange(true)) {
    sim = {};  // ownership stays
    return fail(CARGOBAY_E_BUSY,
                "another robot already uses this virtual Create; close it, or open a second one");
  }
  virtual_time = sim->in_virtual_time();
  return CARGOBAY_OK;
}

int Opening::take_plant(const hal::Config& config) {
  auto found = hal::choose_robot(config, {}, hal::below_loop(wanted.realtime.priority));
  if (!found) {
    if (config.port.empty()) return fail(CARGOBAY_E_LIMIT, found.failure());
    const int code = found.failure().code.value();
    return fail(code == EACCES || code == EPERM ? CARGOBAY_E_ACCESS : CARGOBAY_E_PIN,
                found.failure());
  }
  chosen = std::move(*found);
  wanted.pins = chosen.pins();
  return CARGOBAY_OK;
}

int Opening::open_stream(std::unique_ptr<hal::ByteStream>& stream) {
  if (virtual_time) {
    hal::sim::VirtualLink& link = *sim->link;
    link.discard_input();
    if (link.set_baud(baud)) return bad_argument("`baud` cannot be set");
    if (link.set_wake_threshold(1)) return bad_argument("the link cannot be set up");
    stream = std::make_unique<hal::SpacedStream>(link);  // the virtual Create still owns the link
    return CARGOBAY_OK;
  }
  auto opened = hal::open_port(sim ? sim->server->path() : chosen.port, baud);
  if (!opened) return fail(code_of_port(opened.failure().code), opened.failure());
  stream = std::move(opened->stream);
  return CARGOBAY_OK;
}

int code_of(const hal::Failure& failure, const Opening& opening) {
  if (!failure.code)  // the frames do not fit the rate
    return opening.baud_is_the_programs ? CARGOBAY_E_ARGUMENT : CARGOBAY_E_CONFIG;
  if (failure.code.category() != hal::trouble_category()) return code_of_port(failure.code);
  switch (static_cast<hal::Trouble>(failure.code.value())) {
    case hal::Trouble::silent:
    case hal::Trouble::unruly: return CARGOBAY_E_SILENT;
    case hal::Trouble::wrong_mode: return CARGOBAY_E_MODE;
    case hal::Trouble::cancelled: return CARGOBAY_E_CANCELLED;
    case hal::Trouble::pin: return CARGOBAY_E_PIN;
    case hal::Trouble::hung_up: return CARGOBAY_E_UNPLUGGED;
    case hal::Trouble::guard: return CARGOBAY_E_GUARD;
    case hal::Trouble::unconfirmed: return CARGOBAY_E_UNCONFIRMED;
    case hal::Trouble::no_thread: return CARGOBAY_E_LIMIT;
  }
  return CARGOBAY_E_SYSTEM;
}

void ProgressTeller::tell(const hal::BringUpEvent& event) {
  step_ = event.step;
  detail_ = event.detail;
  call();
}

bool ProgressTeller::given_up() {
  constexpr int kPollsACall = 5;  // of 20 ms
  if (++polls_ % kPollsACall == 0) call();
  return given_up_;
}

void ProgressTeller::call() {
  polls_ = 0;
  if (opening_.progress == nullptr || given_up_) return;
  given_up_ = opening_.progress(opening_.progress_context, step_.c_str(), detail_.c_str()) != 0;
}

}  // namespace cargobay::c
