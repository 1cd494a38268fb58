#include "hal/cli/live/own_robot.hpp"

#include <system_error>
#include <utility>

#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/sim_options.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/feed/feed_place.hpp"
#include "hal/machine/masked_thread.hpp"

namespace cargobay::cli {
namespace {

constexpr rt::Duration kPortPatience = std::chrono::seconds{10};  // for a port that is lost

}  // namespace

hal::Result<std::unique_ptr<OwnRobot>> OwnRobot::start(const DriveOptions& options,
                                                       const hal::Config& config,
                                                       const std::string& program) {
  std::unique_ptr<OwnRobot> own{new OwnRobot};
  hal::RobotOptions robot = robot_options(options, config);
  leave_cpu_to_loop(robot);
  auto chosen = choose_robot(config, options.pins, parameters(options.sim),
                             hal::below_loop(robot.realtime.priority));
  if (!chosen) return chosen.failure();
  own->chosen_ = std::move(*chosen);
  robot.pins = own->chosen_.pins();
  robot.learnt = learnt_place(options.learnt, config);
  robot.cancelled = [it = own.get()] { return it->cancelled_.load(); };
  auto service = hal::Service::open({.program = program,
                                     .chosen = &own->chosen_,
                                     .baud = *config.baud,
                                     .robot = robot,
                                     .patience = kPortPatience,
                                     .tell = [](const std::string& what) { print_remark(what); }});
  if (!service) return service.failure();
  own->service_ = std::move(*service);
  const auto error =
      hal::start_masked(own->thread_, [it = own.get()] { it->ended_ = it->service_->run({}); });
  if (error) {
    return hal::Failure{.message = "no thread for the robot: " + error.message() +
                                   "; raise the limit of processes (ulimit -u)",
                        .code = error};
  }
  return own;
}

OwnRobot::~OwnRobot() {
  if (thread_.joinable()) (void)end();  // who wants to know calls it first
}

hal::Result<void> OwnRobot::end() {
  cancelled_.store(true);
  if (thread_.joinable()) thread_.join();
  return ended_;
}

hal::Result<Attached> attach(const DriveOptions& options, const std::string& program) {
  const auto config = configuration(options.connection, options.pins);
  if (!config) return config.failure();
  if (!config->port.empty() || !hal::find_feeds().empty()) {
    auto reader = hal::FeedReader::attach(config->port);
    if (reader) return Attached{.own = nullptr, .reader = std::move(*reader)};
    const bool none = reader.failure().code == std::errc::no_such_device;
    if (config->port.empty() || !none) return reader.failure();
  }
  auto own = OwnRobot::start(options, *config, program);
  if (!own) return own.failure();
  auto reader = hal::FeedReader::attach((*own)->socket());
  if (!reader) return reader.failure();
  return Attached{.own = std::move(*own), .reader = std::move(*reader)};
}

}  // namespace cargobay::cli
