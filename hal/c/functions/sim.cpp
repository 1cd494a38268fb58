// The functions of the virtual Create.
#include <cmath>
#include <string>
#include <string_view>
#include <thread>

#include "hal/c/cargobay.h"
#include "hal/c/durations.hpp"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/c/sim_object.hpp"
#include "hal/c/sized.hpp"
#include "hal/c/text.hpp"
#include "hal/config/settings.hpp"
#include "hal/file/port_descriptor.hpp"
#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/remote/control.hpp"
#include "hal/sim/remote/control_socket.hpp"
#include "oi/dialect.hpp"

namespace cargobay::c {
namespace {

using hal::sim::Device;

constexpr double kNsPerS = 1e9;

void inhabit(Device& device, SimObject& sim) {
  SimWorld& shared = sim.world();
  hal::sim::inhabit(device, shared.world, shared.bodies, *sim.number);
}

// No two robots tick at the same instant: here each 4 ms after the one before.
rt::Duration first_tick(std::size_t number) {
  constexpr rt::Duration kApart = std::chrono::milliseconds{4};
  return oi::kTick + static_cast<std::int64_t>(number) * kApart % oi::kTick;
}

// What is wrong with the wheels; empty if nothing.
std::string complaint_about_wheels(const cargobay_sim_options& options) {
  const hal::Range lag_ns = hal::kLagS.times(kNsPerS);
  const auto asked_ns = static_cast<double>(options.lag_ns);
  if (options.lag_ns != 0 && !lag_ns.contains(asked_ns)) {
    return "`lag_ns` must be " + lag_ns.words() + ", or 0 for the default" +
           hal::likely_meaning(lag_ns, hal::kNotNs, asked_ns);
  }
  for (const double gain : {options.gain_left, options.gain_right}) {
    if (gain != 0.0 && !hal::sim::kGain.contains(gain)) {
      return "`gain_left` and `gain_right` must be " + hal::sim::kGain.words() +
             ", or 0 for the default" + hal::likely_meaning(hal::sim::kGain, hal::kNotPart, gain);
    }
  }
  if (!hal::sim::kNoiseMmS.contains(std::max(options.noise_mm_s, 0.0)) ||
      std::isnan(options.noise_mm_s))
    return "`noise_mm_s` must be " + hal::sim::kNoiseMmS.words() + ", or negative for none";
  hal::sim::WheelParameters wheels;
  if (options.plant != nullptr) {
    if (const std::string wrong = hal::sim::set_plant(options.plant, wheels); !wrong.empty())
      return "`plant`: " + wrong;
  }
  if (options.wheel_base_mm != 0.0 && !hal::kWheelBaseMm.contains(options.wheel_base_mm)) {
    return "`wheel_base_mm` must be " + hal::kWheelBaseMm.words() + ", or 0 for the default" +
           hal::likely_meaning(hal::kWheelBaseMm, hal::kNotMm, options.wheel_base_mm);
  }
  return "";
}

// Empty if everything is in range.
std::string complaint(const cargobay_sim_options& options) {
  if (options.time < CARGOBAY_SIM_TIME_REAL || options.time > CARGOBAY_SIM_TIME_VIRTUAL)
    return "`time` must be CARGOBAY_SIM_TIME_REAL or CARGOBAY_SIM_TIME_VIRTUAL";
  if (options.remainder < CARGOBAY_REMAINDER_UNKNOWN || options.remainder > CARGOBAY_REMAINDER_LOST)
    return "`remainder` must be one of enum cargobay_remainder";
  if (options.boot_baud != 0 && !oi::kCreate.baud_code(options.boot_baud))
    return "`boot_baud` must be one of the robot's rates: 57600, 19200, ...";
  for (const void* reserved : options.reserved)
    if (reserved != nullptr) return "`reserved` must be NULL";
  if (options.beside != nullptr && options.world != nullptr)
    return "it shares the world of `beside`; leave out `world`";
  if (options.beside != nullptr && options.time != 0)
    return "it shares the time of `beside`; leave out `time`";
  if (options.time == CARGOBAY_SIM_TIME_VIRTUAL && options.link != nullptr)
    return "in virtual time there is no pseudo-terminal to `link` to";
  return complaint_about_wheels(options);
}

hal::sim::Parameters parameters(const cargobay_sim_options& options) {
  hal::sim::Parameters robot;
  if (options.seed != 0) robot.seed = options.seed;
  if (options.remainder == CARGOBAY_REMAINDER_LOST) robot.remainder = hal::sim::Remainder::lost;
  if (options.boot_baud != 0) robot.boot_baud = options.boot_baud;
  hal::sim::WheelParameters& wheels = robot.wheels;
  // It was checked before.
  if (options.plant != nullptr) (void)hal::sim::set_plant(options.plant, wheels);
  if (options.lag_ns != 0) wheels.lag_s = static_cast<double>(options.lag_ns) / kNsPerS;
  if (options.gain_left != 0.0) wheels.gain_left = options.gain_left;
  if (options.gain_right != 0.0) wheels.gain_right = options.gain_right;
  if (options.noise_mm_s != 0.0) wheels.noise_mm_s = std::max(options.noise_mm_s, 0.0);
  if (options.wheel_base_mm != 0.0) wheels.wheel_base_mm = options.wheel_base_mm;
  return robot;
}

int start_in_real_time(const cargobay_sim_options& options, SimObject& sim) {
  auto server = hal::sim::Server::open(parameters(options),
                                       {.link = options.link != nullptr ? options.link : ""});
  if (!server) {
    return fail(options.link != nullptr ? CARGOBAY_E_FILE : CARGOBAY_E_LIMIT, server.failure());
  }
  sim.server = std::move(*server);
  sim.server->with_device([&sim](Device& device) { inhabit(device, sim); });
  if (const std::error_code error = sim.server->start(); error) {
    return fail(CARGOBAY_E_LIMIT, "cannot start the thread of the virtual Create: " +
                                      error.message() + "; raise the limit of threads");
  }
  return CARGOBAY_OK;
}

// One that comes later has been there, switched on, since the beginning of the world.
int start_in_virtual_time(const cargobay_sim_options& options, SimObject& sim) {
  SimWorld& world = sim.world();
  const std::unique_lock lock{world.owner, std::try_to_lock};
  if (!lock) return moved_elsewhere();
  hal::sim::Parameters robot = parameters(options);
  robot.first_tick = first_tick(*sim.number);
  sim.device = std::make_unique<Device>(robot);
  sim.link = std::make_unique<hal::sim::VirtualLink>(*sim.device, world.time);
  inhabit(*sim.device, sim);
  return CARGOBAY_OK;
}

int make_world(const cargobay_sim_options& options, SimObject& sim) {
  sim.own = std::make_unique<SimWorld>();
  sim.own->in_virtual_time = options.time == CARGOBAY_SIM_TIME_VIRTUAL;
  if (options.world == nullptr) return CARGOBAY_OK;
  auto loaded = hal::sim::World::load(options.world);
  if (!loaded) return fail(CARGOBAY_E_FILE, loaded.failure());
  sim.own->world = std::move(*loaded);
  return CARGOBAY_OK;
}

int join_world(const cargobay_sim_options& options, SimObject& sim) {
  sim.first_handle = options.beside;
  sim.first = sims().use(options.beside);
  if (sim.first && sim.first->first) {  // a guest too
    sim.first_handle = sim.first->first_handle;
    sim.first = sims().use(sim.first_handle);
  }
  if (!sim.first) return bad_sim(options.beside);
  ++sim.first->own->guests;
  if (!sim.first->own->in_virtual_time || options.link == nullptr) return CARGOBAY_OK;
  return bad_argument("in virtual time there is no pseudo-terminal to `link` to");
}

int open_sim(const cargobay_sim_options& options, cargobay_sim** handle) {
  if (const std::string wrong = complaint(options); !wrong.empty())
    return fail(CARGOBAY_E_ARGUMENT, wrong);
  auto sim = std::make_unique<SimObject>();
  const bool beside = options.beside != nullptr;
  if (const int failed = beside ? join_world(options, *sim) : make_world(options, *sim);
      failed != CARGOBAY_OK)
    return failed;
  sim->number = sim->world().bodies.enter();
  const bool virtual_time = sim->world().in_virtual_time;
  if (const int failed =
          virtual_time ? start_in_virtual_time(options, *sim) : start_in_real_time(options, *sim);
      failed != CARGOBAY_OK)
    return failed;
  *handle = static_cast<cargobay_sim*>(sims().open(std::move(sim)));
  if (*handle == nullptr)
    return fail(CARGOBAY_E_LIMIT, "64 virtual Creates are open; close those that are not used");
  return CARGOBAY_OK;
}

int close_sim(const cargobay_sim* sim) {
  SimUse first;  // of the virtual Creates in its world, if that is another
  {
    const SimUse use = sims().use(sim);
    if (!use) return bad_sim(sim);
    if (use->taken.load()) {
      return fail(CARGOBAY_E_STATE,
                  "an open robot uses this virtual Create; close it first, with cargobay_close()");
    }
    if (use->own && use->own->guests.load() != 0) {
      return fail(CARGOBAY_E_STATE,
                  "other virtual Creates are in the world of this one; close them first");
    }
    first = sims().use(use->first_handle);
  }
  std::unique_lock<std::timed_mutex> time;
  if (first) time = std::unique_lock{first->own->owner, std::try_to_lock};
  if (first && !time) return moved_elsewhere();
  const auto closed = sims().close(sim, [](SimObject& ended) {
    if (ended.server) ended.server->stop();
    return true;
  });
  return closed ? static_cast<int>(CARGOBAY_OK) : bad_sim(sim);
}

// Sleeps without keeping other threads from closing it.
int sleep(const cargobay_sim* sim, rt::Duration duration) {
  constexpr rt::Duration kLookEvery = std::chrono::milliseconds{100};
  const rt::TimePoint until = rt::Clock::now() + duration;
  for (;;) {
    if (!sims().use(sim)) return bad_sim(sim);
    const rt::Duration left = until - rt::Clock::now();
    if (left <= rt::Duration::zero()) return CARGOBAY_OK;
    std::this_thread::sleep_for(std::min(left, kLookEvery));
  }
}

cargobay_truth truth_of(const hal::sim::Cable& cable) {
  const Device& device = cable.device();
  const hal::sim::Truth truth = device.truth();
  cargobay_truth known{};
  known.mode = static_cast<std::int32_t>(device.mode());
  known.sim_time_ns = device.now().count();
  known.left_mm_s = truth.speeds.left_mm_s;
  known.right_mm_s = truth.speeds.right_mm_s;
  known.x_mm = truth.pose.x_mm;
  known.y_mm = truth.pose.y_mm;
  known.heading_rad = truth.pose.heading_rad;
  known.commanded_left_mm_s = static_cast<std::int32_t>(std::lround(device.commanded().left_mm_s));
  known.commanded_right_mm_s =
      static_cast<std::int32_t>(std::lround(device.commanded().right_mm_s));
  return known;
}

}  // namespace

SimObject::~SimObject() {
  server.reset();  // they look at the world
  link.reset();
  device.reset();
  if (number) world().bodies.leave(*number);
  if (first) --first->own->guests;
}

void SimObject::with_cable(const std::function<void(hal::sim::Cable&)>& change) {
  if (in_virtual_time()) {
    change(link->cable());
  } else {
    server->with_cable(change);
  }
}

SimTable& sims() {
  static constinit SimTable table;  // as robots()
  return table;
}

}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below
using cargobay::hal::sim::Cable;

extern "C" {

int cargobay_sim_open(const struct cargobay_sim_options* options, struct cargobay_sim** sim) {
  if (sim == nullptr) return bad_argument("`sim` is NULL: give the address of a pointer");
  *sim = nullptr;
  if (in_control()) return not_from_control("cargobay_sim_open");
  cargobay_sim_options known{};
  if (options != nullptr && !take(options, known)) {
    return bad_argument(
        "cargobay_sim_options: set `size` to its sizeof, and unused members to 0; a newer "
        "program's options need a newer library");
  }
  return guarded([&] {
    const cargobay::hal::StandardNumbersTaken taken;
    return open_sim(known, sim);
  });
}

int cargobay_sim_close(struct cargobay_sim* sim) {
  if (sim == nullptr) return CARGOBAY_OK;
  if (in_control()) return not_from_control("cargobay_sim_close");
  return guarded([&] { return close_sim(sim); });
}

int cargobay_sim_get_path(struct cargobay_sim* sim, char* path, size_t path_size) {
  if (path == nullptr) return bad_argument("`path` is NULL: give it room for the path");
  return guarded([&] {
    const auto use = sims().use(sim);
    if (!use) return bad_sim(sim);
    if (use->in_virtual_time()) {
      return fail(CARGOBAY_E_UNSUPPORTED,
                  "in virtual time there is no pseudo-terminal; open it in real time");
    }
    return copy_text(use->server->path(), path, path_size);
  });
}

int cargobay_sim_inject(struct cargobay_sim* sim, const char* line, char* answer,
                        size_t answer_size) {
  if (line == nullptr)
    return bad_argument("`line` is NULL: give it a command, such as \"bump left\"");
  return guarded([&] {
    const auto use = sims().use(sim);
    if (!use) return bad_sim(sim);
    // A served robot can lose its port as well.
    const std::string said = use->in_virtual_time()
                                 ? cargobay::hal::sim::control(line, use->link->cable())
                                 : cargobay::hal::sim::control(line, *use->server);
    constexpr std::string_view kError = "error: ";
    if (said.starts_with(kError)) {
      return fail(CARGOBAY_E_ARGUMENT, said.substr(kError.size()));
    }
    return copy_text(said, answer, answer_size);
  });
}

int cargobay_sim_get_truth(struct cargobay_sim* sim, struct cargobay_truth* truth) {
  return guarded([&] {
    const auto use = sims().use(sim);
    if (!use) return bad_sim(sim);
    cargobay_truth known{};
    use->with_cable([&](Cable& cable) { known = truth_of(cable); });
    if (!give(known, truth)) return bad_argument(kBadOut);
    return static_cast<int>(CARGOBAY_OK);
  });
}

int cargobay_sim_advance(struct cargobay_sim* sim, int64_t duration_ns) {
  if (const int bad = check_duration("duration_ns", duration_ns); bad != CARGOBAY_OK) return bad;
  if (in_control()) return not_from_control("cargobay_sim_advance");
  return guarded([&] {
    const cargobay::rt::Duration duration{duration_ns};
    const bool in_real_time = [sim] {
      const SimUse use = sims().use(sim);
      return use && !use->in_virtual_time();
    }();
    if (in_real_time) return sleep(sim, duration);
    const SimUse use = sims().use(sim);
    if (!use) return bad_sim(sim);
    SimWorld& world = use->world();
    const std::unique_lock lock{world.owner, std::try_to_lock};
    if (!lock) return moved_elsewhere();
    world.time.advance_to(world.time.now() + duration);
    return static_cast<int>(CARGOBAY_OK);
  });
}

}  // extern "C"
