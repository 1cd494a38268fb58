#include "hal/cli/virtual_create.hpp"

#include <utility>

#include "oi/baud.hpp"

namespace cargobay::cli {

VirtualCreate::VirtualCreate(std::unique_ptr<hal::sim::Server> server)
    : server_{std::move(server)},
      pins_{[this](const std::function<void(hal::sim::Device&)>& change) {
        server_->with_device(change);
      }} {}

hal::Result<std::unique_ptr<VirtualCreate>> VirtualCreate::start(hal::sim::Parameters robot,
                                                                 std::uint32_t wanted_baud,
                                                                 int priority) {
  const bool wired = wanted_baud == oi::kBrcBaud;
  if (wired) robot.power_on = hal::sim::PowerOn::never;
  auto server = hal::sim::Server::open(robot, {.priority = priority});
  if (!server) return server.failure();
  if (const std::error_code error = (*server)->start(); error) {
    return hal::Failure{"cannot start the virtual Create: " + error.message(), error};
  }
  std::unique_ptr<VirtualCreate> create{new VirtualCreate{std::move(*server)}};
  create->wired_ = wired;
  return create;
}

hal::RobotPins VirtualCreate::pins() {
  if (!wired_) return {};
  return {.brc = &pins_.brc,
          .power_toggle = &pins_.power_toggle,
          .power_sense = &pins_.power_sense,
          .charging = &pins_.charging};
}

}  // namespace cargobay::cli
