#include "hal/cli/connect/published.hpp"

#include <utility>

#include "hal/cli/terminal/print.hpp"
#include "hal/sim/remote/control_socket.hpp"

namespace cargobay::cli {

Published::Published(const std::string& program, const hal::ChosenRobot& chosen, std::uint32_t baud,
                     const hal::RobotOptions& robot) {
  hal::FeedOptions options{.of = {.program = program,
                                  .port = chosen.port,
                                  .is_virtual = chosen.create != nullptr,
                                  .baud = baud,
                                  .wheel_base_mm = robot.cycle.loop.estimator.wheel_base_mm,
                                  .setpoint_lapse = robot.cycle.setpoint_lapse},
                           .create = chosen.server()};
  if (hal::sim::Server* const server = chosen.server()) {
    options.steering.control = [server](std::string_view line) {
      return hal::sim::control(line, *server);
    };
  }
  auto feed = hal::Feed::open(std::move(options));
  if (feed) {
    feed_ = std::move(*feed);
  } else {
    print_remark("nobody can watch this drive: " + feed.failure().message);
  }
}

void Published::attach_to(hal::RobotOptions& robot) const {
  if (feed_) feed_->attach_to(robot);
}

void Published::follow(hal::Robot& robot) const {
  if (!feed_) return;
  feed_->follow(robot);
  feed_->report("driving", "the loop is closed");
}

void Published::leave(const std::string& why) const {
  if (!feed_) return;
  feed_->leave();
  feed_->report("lost", why);
}

}  // namespace cargobay::cli
