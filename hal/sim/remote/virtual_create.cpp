#include "hal/sim/remote/virtual_create.hpp"

#include <utility>

#include "oi/dialect.hpp"
#include "rt/refusal.hpp"

namespace cargobay::hal::sim {

VirtualCreate::VirtualCreate(std::unique_ptr<Server> server)
    : server_{std::move(server)},
      pins_{[this](const std::function<void(Device&)>& change) { server_->with_device(change); }} {}

Result<std::unique_ptr<VirtualCreate>> VirtualCreate::start(Parameters robot,
                                                            std::uint32_t wanted_baud,
                                                            int priority) {
  const bool wired = wanted_baud == oi::kCreate.brc_baud;
  if (wired) robot.power_on = PowerOn::never;
  auto server = Server::open(robot, {.priority = priority});
  if (!server) return server.failure();
  if (const std::error_code error = (*server)->start(); error) {
    return Failure{"cannot start the virtual Create: " +
                       rt::explain({.right = rt::Refusal::Right::thread, .error = error.value()}),
                   error};
  }
  std::unique_ptr<VirtualCreate> create{new VirtualCreate{std::move(*server)}};
  create->wired_ = wired;
  return create;
}

RobotPins VirtualCreate::pins() {
  if (!wired_) return {};
  return {.brc = &pins_.brc,
          .power_toggle = &pins_.power_toggle,
          .power_sense = &pins_.power_sense,
          .charging = &pins_.charging};
}

}  // namespace cargobay::hal::sim
